//! Contact points of bodies that ideal joints hold together: an impulse at one of them moves them all.
//!
//! What a unit impulse at a point adds to the velocities of all bodies of the mechanism is found once a step, along the normal and two directions across it. With it the
//! sweeps act on the mechanism as on one body, however light the part that is hit.

use super::coulomb::Single;
use super::groups::Groups;
use super::rows::{Block, Motion, Rows};
use crate::mbs::math::{self, M3, V3};
use std::collections::BTreeMap;

/// A mechanism as contacts see it.
pub trait Linked {
    /// The mechanism that a body is in; none if no joint holds it.
    fn part(&self, body: usize) -> Option<usize>;

    /// Mass of all bodies that joints connect with a body, itself included \[kg\].
    fn mass_kg(&self, body: usize) -> f64;

    /// What an impulse on a body (linear \[N s\], angular about its centre of mass \[N m s\]) adds to the velocities of the bodies that its joints connect it with, itself included: `[velocity, angular velocity]` by
    /// body.
    fn respond(&mut self, body: usize, impulse: [V3; 2], out: &mut Vec<(usize, [V3; 2])>);
}

/// Inverse mass of a point that joints hold, over that without joints and over that of all bodies that they connect, below both of which it does not move.
const HELD: [f64; 2] = [1e-6, 1e-2];

/// Marks a block without links.
pub(super) const ALONE: u32 = u32::MAX;

/// Responses of the linked rows of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Links {
    /// Of each linked row the directions and where their responses are: `list[ends[d]..ends[d + 1]]`.
    rows: Vec<([V3; 3], [usize; 4])>,
    list: Vec<(u32, Motion)>,
    /// Of each linked row what unit impulses along its directions add to its velocity, if it is the only one of its group and has friction.
    single: Vec<Option<M3>>,
    /// Pairs of bodies that joints connect, so many that all of a mechanism are.
    pub joined: Vec<[u32; 2]>,
    scratch: Vec<(usize, [V3; 2])>,
}

impl Links {
    pub fn clear(&mut self) {
        self.rows.clear();
        self.list.clear();
        self.joined.clear();
        self.single.clear();
    }

    /// Notes who is in one mechanism with whom, of so many bodies.
    pub fn join(&mut self, bodies: usize, mechanism: &dyn Linked) {
        let mut first = BTreeMap::new();
        for body in 0..bodies {
            if let Some(part) = mechanism.part(body) {
                let with = *first.entry(part).or_insert(body);
                self.joined.push([with as u32, body as u32]);
            }
        }
    }

    /// Applies an impulse to the second body of a linked row, and its opposite to the first.
    pub fn kick(&self, row: usize, p: V3, motion: &mut [Motion]) {
        let (axes, ends) = &self.rows[row];
        for (d, axis) in axes.iter().enumerate() {
            let part = math::dot(p, *axis);
            if part != 0.0 {
                for (body, response) in &self.list[ends[d]..ends[d + 1]] {
                    let of = &mut motion[*body as usize];
                    of.v = math::axpy(of.v, part, response.v);
                    of.w = math::axpy(of.w, part, response.w);
                }
            }
        }
    }

    /// What a unit impulse along direction `d` adds to a body.
    fn response(&self, row: usize, d: usize, body: u32) -> Motion {
        let (_, ends) = &self.rows[row];
        let mut sum = Motion::default();
        for (_, m) in self.list[ends[d]..ends[d + 1]].iter().filter(|(b, _)| *b == body) {
            sum = Motion { v: math::add(sum.v, m.v), w: math::add(sum.w, m.w) };
        }
        sum
    }
}

impl Rows {
    /// Whether ideal joints link points.
    pub fn are_linked(&self) -> bool {
        !self.links.rows.is_empty()
    }

    /// Finds the responses of the rows of the blocks from `first` on that joints link, and of those that are the only ones of their `groups` with friction; and their effective masses with them.
    pub fn link(&mut self, first: usize, groups: &Groups, mechanism: &mut dyn Linked) {
        let ground = self.motion.len() - 1;
        let counts = self.counts(groups);
        for k in first..self.blocks.len() {
            let block = self.blocks[k];
            let held = |b: u32| (b as usize) < ground && mechanism.part(b as usize).is_some();
            let is_single = block.friction > 0.0 && counts[groups.of_block(&block)] == 1;
            if !is_single && !block.bodies.iter().any(|b| held(*b)) {
                continue;
            }
            self.blocks[k].linked = self.links.rows.len() as u32;
            for i in block.range() {
                self.link_row(&block, i, mechanism);
            }
        }
        self.single_out(groups, &counts);
    }

    /// Points of each group.
    fn counts(&self, groups: &Groups) -> Vec<u32> {
        let mut counts = vec![0; groups.count()];
        for block in &self.blocks {
            counts[groups.of_block(block)] += block.count;
        }
        counts
    }

    fn link_row(&mut self, block: &Block, i: usize, mechanism: &mut dyn Linked) {
        let axes = axes_about(block.normal);
        let row = self.rows[i];
        let mut ends = [self.links.list.len(); 4];
        for (d, axis) in axes.iter().enumerate() {
            for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                self.respond(block.bodies[side], math::scale(sign, *axis), row.arms[side], mechanism);
            }
            ends[d + 1] = self.links.list.len();
        }
        let at = self.links.rows.len();
        self.links.rows.push((axes, ends));
        let moved = |d: usize| {
            let [a, b] = block.bodies.map(|body| self.links.response(at, d, body));
            row.relative(&a, &b)
        };
        let normal = math::dot(moved(0), axes[0]);
        let (first, second) = (moved(1), moved(2));
        let across = 0.5 * (math::dot(first, axes[2]) + math::dot(second, axes[1]));
        let [p, q] = [math::dot(first, axes[1]), math::dot(second, axes[2])];
        // the larger eigenvalue of the tangential inverse mass
        let largest = 0.5 * (p + q) + (0.25 * (p - q) * (p - q) + across * across).sqrt();
        // what joints hold in this direction cannot be moved by an impulse: what is left is round-off
        let free: f64 = (0..2)
            .map(|side| self.inverse[block.bodies[side] as usize].response(row.arms[side], axes[0], axes[0]))
            .sum();
        let own = [0, 1].map(|side| self.loosest(block.bodies[side], mechanism));
        let least = (HELD[0] * free).min(HELD[1] * own[0].max(own[1]));
        let invert = |m: f64| if m > least { 1.0 / m } else { 0.0 };
        let row = &mut self.rows[i];
        row.mass = [invert(normal), invert(largest)];
        if row.mass[0] == 0.0 {
            (row.normal, row.tangent) = (0.0, [0.0; 3]);
        }
    }

    /// Notes which linked rows are the only ones of their groups: their impulses are found at once ([`Single`]).
    fn single_out(&mut self, groups: &Groups, counts: &[u32]) {
        self.links.single = vec![None; self.links.rows.len()];
        for block in &self.blocks {
            let is_free = block.friction > 0.0 && block.cap == f64::INFINITY && block.rolling == 0.0;
            let row = &self.rows[block.first as usize];
            if block.linked == ALONE || !is_free || counts[groups.of_block(block)] > 1 || row.mass[0] == 0.0 {
                continue;
            }
            let at = block.linked as usize;
            let axes = self.links.rows[at].0;
            let columns = [0, 1, 2].map(|d| {
                let [a, b] = block.bodies.map(|body| self.links.response(at, d, body));
                row.passing(&a, &b)
            });
            let k = axes.map(|axis| columns.map(|column| math::dot(axis, column)));
            self.links.single[at] = Some(k);
        }
    }

    /// The impulse of a point that is the only one of its group, along the directions of its row; none if there are others, or if Coulomb's law has no solution.
    fn single(&self, block: &Block) -> Option<V3> {
        let k = (*self.links.single.get(block.linked as usize)?)?;
        let row = &self.rows[block.first as usize];
        let axes = &self.links.rows[block.linked as usize].0;
        let along = |v: V3| axes.map(|axis| math::dot(axis, v));
        let [a, b] = block.bodies.map(|b| &self.motion[b as usize]);
        let had = along(math::axpy(row.tangent, row.normal, block.normal));
        let free = math::sub(along(row.passing(a, b)), math::mul(&k, had));
        Single { k, free, target: row.target, friction: block.friction }.impulse()
    }

    /// Whether the impulse of a block is that of Coulomb's law for a single point.
    pub fn is_single(&self, block: &Block) -> bool {
        block.linked != ALONE && self.single(block).is_some()
    }

    /// One over the mass that moves with a body \[1/kg\].
    fn loosest(&self, body: u32, mechanism: &dyn Linked) -> f64 {
        let i = body as usize;
        let linked = i + 1 < self.motion.len() && mechanism.part(i).is_some();
        if linked { 1.0 / mechanism.mass_kg(i) } else { self.inverse[i].mass }
    }

    fn respond(&mut self, body: u32, p: V3, arm: V3, mechanism: &mut dyn Linked) {
        let i = body as usize;
        let turn = math::cross(arm, p);
        if i + 1 == self.motion.len() {
        } else if mechanism.part(i).is_some() {
            self.links.scratch.clear();
            mechanism.respond(i, [p, turn], &mut self.links.scratch);
            let moved = self.links.scratch.iter().map(|(b, [v, w])| (*b as u32, Motion { v: *v, w: *w }));
            self.links.list.extend(moved);
        } else {
            let own = &self.inverse[i];
            let moved = Motion { v: math::scale(own.mass, p), w: own.turn(turn) };
            self.links.list.push((body, moved));
        }
    }

    /// A visit of a linked block.
    pub fn visit_linked(&mut self, block: &Block) -> f64 {
        if let Some([normal, s, t]) = self.single(block) {
            return self.set_single(block, normal, [s, t]);
        }
        let n = block.normal;
        let mut largest = 0.0_f64;
        for (k, i) in block.range().enumerate() {
            let [a, b] = block.bodies.map(|b| &self.motion[b as usize]);
            let row = &mut self.rows[i];
            let (p, change) = row.correct(row.passing(a, b), n, block.friction, block.cap);
            largest = largest.max(change);
            self.links.kick(block.linked as usize + k, p, &mut self.motion);
        }
        largest
    }
}

impl Rows {
    /// Gives the only point of a block its impulse; the square of the change of velocity.
    fn set_single(&mut self, block: &Block, normal: f64, [s, t]: [f64; 2]) -> f64 {
        let axes = self.links.rows[block.linked as usize].0;
        let row = &mut self.rows[block.first as usize];
        let tangent = math::axpy(math::scale(s, axes[1]), t, axes[2]);
        let (along, across) = (normal - row.normal, math::sub(tangent, row.tangent));
        (row.normal, row.tangent) = (normal, tangent);
        let [m, mt] = [row.mass[0] * row.mass[0], row.mass[1] * row.mass[1]];
        self.links.kick(block.linked as usize, math::axpy(across, along, block.normal), &mut self.motion);
        (along * along / m).max(math::dot(across, across) / mt)
    }
}

/// A normal and two directions across it.
pub(super) fn axes_about(n: V3) -> [V3; 3] {
    let least = (0..3).min_by(|i, j| n[*i].abs().total_cmp(&n[*j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let first = math::cross(n, axis);
    let first = math::scale(1.0 / math::norm(first), first);
    [n, first, math::cross(n, first)]
}
