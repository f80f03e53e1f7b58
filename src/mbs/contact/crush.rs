//! Crushing: faces of boxes that bear no more than a force, and get shorter under more.
//!
//! A face with the resistance `F(s)` at the shortening `s` so far bears at most `F h` of impulse in a step of length `h`, each of its contact points an equal share, at least a
//! quarter: a box that stands on an edge has half of the resistance, on a corner a quarter, and of what lies behind the face as much is worn as it gets shorter there. Points that bear all of their share go on closing; by what they are in the other solid
//! after the step, along the axis of the box, the box is shorter from then on. So the impulse of an impact is spread over the time that crushing takes, its work is
//! `∫ F ds`, and nothing comes back: points that may crush have no rebound. Where two faces meet that crush, the weaker one does.
//!
//! In a leapfrog the velocity of a step is that of its middle. A pair that touches after a share `θ` of a step has a resistance of `(1 - θ)² / 2` of a whole step's in it and `3/2 - θ` less that in the next
//! one: so the way and the velocity at the end of both are those of a force that sets in at `θ`, and the depth is of second order in the step.
//!
//! The shortening of a step holds from the next one on, so that a step that is taken back leaves no trace.

use super::rows::{Block, Motion, Row};
use super::{ContactEnergy, ContactSet, Moving};
use crate::base::piecewise::interpolate;
use crate::curve::Rate;
use crate::mbs::math::{self, V3};
use crate::mbs::model::Model;

/// Least cosine between a contact normal and a face for the face to be what is crushed.
const LEAST_COSINE: f64 = 0.5;
/// Points that share the resistance of a face at least.
const CORNERS: f64 = 4.0;
/// Share of a box's length that is not crushed any more: what is left is rubble that bears everything.
const RUBBLE: f64 = 0.1;
/// Share of the largest impulse from which a point bears all it can.
const ALL: f64 = 1.0 - 1e-9;
/// A block without a face that crushes.
pub(super) const NONE: u32 = u32::MAX;

/// Shortening of a face so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Crushed {
    /// Shortening \[m\].
    pub depth_m: f64,
    /// Way along the line of its resistance \[m\]: of an edge half of the shortening, of a corner a quarter.
    pub worn_m: f64,
    /// Work that it took \[J\].
    pub energy_j: f64,
}

/// A face that may be crushed.
#[derive(Debug, Clone)]
struct Face {
    collider: usize,
    axis: usize,
    sign: f64,
    force: Vec<[f64; 2]>,
    /// What a speed \[m/s\] does to it.
    rate: Option<Rate>,
    /// Half of the length at which nothing more is crushed \[m\].
    least_m: f64,
    so_far: Crushed,
    /// What the last step adds.
    pending: Crushed,
    /// Contact points in this step.
    points: f64,
}

/// All faces that may be crushed, in the order of the model; and those of each collider.
#[derive(Debug, Clone, Default)]
pub(super) struct Faces {
    all: Vec<Face>,
    of: Vec<Vec<u32>>,
    any_pending: bool,
}

impl Faces {
    /// Those of a model whose solids are in the order of its bodies and their shapes.
    pub fn new(model: &Model, colliders: usize) -> Self {
        let mut first = vec![0; model.bodies.len() + 1];
        for (i, body) in model.bodies.iter().enumerate() {
            first[i + 1] = first[i] + body.shapes.len();
        }
        let mut faces = Self { all: Vec::new(), of: vec![Vec::new(); colliders], any_pending: false };
        for entry in &model.contact.crushing {
            let Some(body) = model.bodies.iter().position(|b| b.id == entry.body) else { continue };
            let Some(half) = model.bodies[body].shapes.get(entry.shape).and_then(|s| s.half_extents_m())
            else {
                continue;
            };
            let (axis, sign) = entry.face.axis();
            let collider = first[body] + entry.shape;
            faces.of[collider].push(faces.all.len() as u32);
            faces.all.push(Face {
                collider,
                axis,
                sign,
                force: entry.force_n.clone(),
                rate: entry.rate_factor.map(|rate| Rate { doubled: rate.speed_m_s, exponent: rate.exponent }),
                least_m: RUBBLE * half[axis],
                so_far: Crushed::default(),
                pending: Crushed::default(),
                points: 0.0,
            });
        }
        faces
    }

    /// Notes the work \[J\] of an impulse at a point of a block, if it is all that the point bears.
    pub fn book(&mut self, block: &Block, normal_ns: f64, work_j: f64) {
        if block.face != NONE && normal_ns >= ALL * block.cap {
            self.all[block.face as usize].pending.energy_j += work_j;
        }
    }
}

impl ContactSet {
    /// Shortening of each face of the model that may be crushed, that of the last step included.
    pub fn crushed(&self) -> impl ExactSizeIterator<Item = Crushed> + '_ {
        self.faces.all.iter().map(|f| Crushed {
            depth_m: f.so_far.depth_m + f.pending.depth_m,
            worn_m: f.so_far.worn_m + f.pending.worn_m,
            energy_j: f.so_far.energy_j + f.pending.energy_j,
        })
    }

    /// Goes on with faces that were crushed before.
    pub fn resume_crushed(&mut self, before: impl Iterator<Item = Crushed>) {
        for (i, crushed) in before.enumerate() {
            self.faces.all[i].pending = crushed;
            self.faces.any_pending = true;
        }
        self.shorten();
    }

    /// Takes the last step's contacts back, whose energies are those again that they were.
    pub fn take_back(&mut self, energy: ContactEnergy) {
        self.energy = energy;
        self.faces.any_pending = false;
        for face in &mut self.faces.all {
            face.pending = Crushed::default();
        }
        self.forget_touches();
    }

    /// Shortens the boxes by what the last step crushed.
    pub(super) fn shorten(&mut self) {
        if !std::mem::take(&mut self.faces.any_pending) {
            return;
        }
        let mut any = vec![false; self.colliders.len()];
        for face in &mut self.faces.all {
            let more = std::mem::take(&mut face.pending);
            if more.depth_m == 0.0 {
                continue;
            }
            face.so_far.depth_m += more.depth_m;
            face.so_far.worn_m += more.worn_m;
            face.so_far.energy_j += more.energy_j;
            self.colliders[face.collider].shorten(face.axis, face.sign, more.depth_m);
            any[face.collider] = true;
        }
        for entry in &mut self.order {
            let pair = &mut self.pairs[entry.slot as usize];
            if any[pair.a as usize] || !pair.plane && any[pair.b as usize] {
                pair.outdated = true;
            }
        }
    }

    /// Finds the face that each block would crush, and what its points bear at most in a step of `h` \[s\].
    pub(super) fn cap(&mut self, bodies: &[Moving], h: f64) {
        if self.faces.all.is_empty() {
            return;
        }
        for face in &mut self.faces.all {
            face.points = 0.0;
        }
        let before = |i: u32| bodies.get(i as usize).map_or(Motion::default(), |b| Motion { v: b.v, w: b.w });
        let nears_by = |block: &Block, rows: &[Row]| {
            let [a, b] = block.bodies.map(before);
            let nears = |r: &Row| -math::dot(r.relative(&a, &b), block.normal);
            rows.iter().map(nears).fold(0.0, f64::max)
        };
        for k in 0..self.rows.blocks.len() {
            let block = self.rows.blocks[k];
            let pair = &self.pairs[block.slot as usize];
            let of_a = self.weakest(pair.a as usize, block.normal);
            let of_b = if pair.plane {
                None
            } else {
                self.weakest(pair.b as usize, math::scale(-1.0, block.normal))
            };
            let face = match (of_a, of_b) {
                (Some(a), Some(b)) => {
                    let speed_m_s = || nears_by(&block, &self.rows.rows[block.range()]);
                    let [at_a, at_b] = [a, b].map(|f| self.faces.all[f].bears_at(speed_m_s));
                    Some(if at_b < at_a { b } else { a })
                }
                (a, b) => a.or(b),
            };
            let block = &mut self.rows.blocks[k];
            block.face = face.map_or(NONE, |f| f as u32);
            if let Some(face) = face {
                self.faces.all[face].points += f64::from(block.count);
                block.restitution = 0.0;
            }
        }
        for block in self.rows.blocks.iter_mut().filter(|b| b.face != NONE) {
            let face = &self.faces.all[block.face as usize];
            let pair = &mut self.pairs[block.slot as usize];
            let [a, b] = block.bodies.map(before);
            let rows = &self.rows.rows[block.range()];
            let nears = |r: &Row| -math::dot(r.relative(&a, &b), block.normal);
            if !pair.bore {
                let touch = |r: &Row| r.gap.max(0.0) / (h * nears(r)).max(r.gap);
                let left = 1.0 - rows.iter().map(touch).fold(1.0, f64::min);
                pair.resistance = [0.5 * left * left, 0.5 + left - 0.5 * left * left];
            }
            let bears_n = face.bears_at(|| nears_by(block, rows));
            block.cap = pair.resistance[0] * h * bears_n / face.points.max(CORNERS);
        }
    }

    /// The face of a solid that looks along a direction.
    fn weakest(&self, collider: usize, along: V3) -> Option<usize> {
        let r = &self.placed[collider].r;
        let cosine = |f: &u32| {
            let face = &self.faces.all[*f as usize];
            face.sign * (0..3).map(|i| r[i][face.axis] * along[i]).sum::<f64>()
        };
        let half = self.colliders[collider].solid.half()?;
        let open = |f: &&u32| {
            let face = &self.faces.all[**f as usize];
            half[face.axis] > face.least_m
        };
        let faces = self.faces.of[collider].iter().filter(open).map(|f| (*f as usize, cosine(f)));
        faces.filter(|(_, c)| *c > LEAST_COSINE).max_by(|p, q| p.1.total_cmp(&q.1)).map(|(f, _)| f)
    }

    /// Notes by how much the points that bear all they can shorten their faces, with the gaps at the end of the step, and lets them touch there.
    pub(super) fn crush(&mut self) {
        if self.faces.all.is_empty() {
            return;
        }
        for k in 0..self.rows.blocks.len() {
            let block = self.rows.blocks[k];
            if block.face == NONE {
                continue;
            }
            let face = &self.faces.all[block.face as usize];
            let r = &self.placed[face.collider].r;
            let cosine = (0..3).map(|i| r[i][face.axis] * block.normal[i]).sum::<f64>().abs();
            let rows = &mut self.rows.rows[block.range()];
            let bearing = rows.iter().filter(|r| r.normal >= ALL * block.cap);
            let (depth, count) = bearing.fold((0.0_f64, 0.0), |(most, n), r| (most.max(-r.gap), n + 1.0));
            if depth > 0.0 {
                rows.iter_mut().for_each(|row| row.gap += depth);
                let face = &mut self.faces.all[block.face as usize];
                face.pending.depth_m = face.pending.depth_m.max(depth / cosine);
                face.pending.worn_m += depth / cosine * count / face.points.max(CORNERS);
                self.faces.any_pending = true;
            }
        }
    }
}

impl Face {
    /// Force that it bears now \[N\].
    fn bears(&self) -> f64 {
        interpolate(&self.force, self.so_far.worn_m)
    }

    /// The same at a speed at which it is shortened \[m/s\], which is asked for if it matters.
    fn bears_at(&self, speed_m_s: impl FnOnce() -> f64) -> f64 {
        self.rate.map_or(1.0, |rate| rate.at(speed_m_s())[0]) * self.bears()
    }
}
