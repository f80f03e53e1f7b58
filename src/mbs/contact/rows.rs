//! The impulses of all contact points of a step: projected Gauss-Seidel sweeps over rows in one flat array.
//!
//! A row asks `v_n >= target` along the normal and Coulomb's law across it. In a visit the normal impulse is corrected by its own inverse
//! mass and cut off at zero; the tangential one by the largest tangential inverse mass, then taken back radially to the disc
//! `|p_t| <= μ p_n`: an exact projection, so that at convergence sliding and friction are opposite (Moreau; Jean, CMAME 177 (1999) 235).
//! Sweeps go forwards and backwards in turn.
//!
//! Gaps are corrected by displacements found in sweeps of their own, which leave the velocities alone (split impulses).

use super::Moving;
use super::links::{ALONE, Links};
use super::roll::Roll;
use super::search::Search;
use crate::mbs::math::{self, V3};

/// Depth from which more of a gap is opened at once \[m\], and that share.
pub(super) const DEEP_M: f64 = 5e-4;
const DEEP_RATE: f64 = 0.8;
/// Way in a step from which a point closes \[m\].
const SINKS_M: f64 = 1e-5;

/// Velocity and angular velocity of a body, or displacement and turn.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Motion {
    pub v: V3,
    pub w: V3,
}

impl Motion {
    /// That of a body through the step without contact; beyond the last one stands what does not move.
    pub fn before(bodies: &[Moving], i: usize) -> Self {
        bodies.get(i).map_or_else(Self::default, |body| Self { v: body.v, w: body.w })
    }
}

/// Inverse mass and inverse inertia in the global frame (xx, yy, zz, xy, xz, yz).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Inverse {
    pub mass: f64,
    pub inertia: [f64; 6],
}

impl Inverse {
    #[inline(always)]
    pub fn turn(&self, l: V3) -> V3 {
        let [xx, yy, zz, xy, xz, yz] = self.inertia;
        [
            xx * l[0] + xy * l[1] + xz * l[2],
            xy * l[0] + yy * l[1] + yz * l[2],
            xz * l[0] + yz * l[1] + zz * l[2],
        ]
    }

    /// What a unit impulse along `n` at `arm` adds to the velocity of its point along `m`.
    #[inline(always)]
    pub fn response(&self, arm: V3, n: V3, m: V3) -> f64 {
        self.mass * math::dot(n, m) + math::dot(math::cross(arm, m), self.turn(math::cross(arm, n)))
    }
}

/// Rows of one pair of solids.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Block {
    /// Bodies; the ground is the last one.
    pub bodies: [u32; 2],
    /// First row, number of rows.
    pub first: u32,
    pub count: u32,
    /// Where the pair is.
    pub slot: u32,
    pub friction: f64,
    pub restitution: f64,
    /// Rolling-resistance arm \[m\].
    pub rolling: f64,
    /// Largest impulse along the normal of each point \[N s\], and the face that is crushed there; [`super::crush::NONE`]: none.
    pub cap: f64,
    pub face: u32,
    /// From the first body to the second.
    pub normal: V3,
    /// Its first row among those that ideal joints link to others; [`ALONE`]: none.
    pub linked: u32,
    /// Whether its points had no impulses in the last visit.
    pub idle: bool,
    /// Whether sweeps leave it as it is.
    pub left: bool,
}

impl Block {
    /// Its rows.
    #[inline(always)]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// One contact point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    /// From the centres of mass \[m\]: at the start of the step, where impulses act; and in the middle of it, whose velocities are its ways. (A point that sticks to a turning body would otherwise go along its tangent, and outwards by
    /// `½ h² ω² r` in a step. With impulses there as well work is not that of a constraint: Ryckaert, Ciccotti, Berendsen, J. Comput. Phys. 23 (1977) 327.)
    pub arms: [V3; 2],
    pub halfway: [V3; 2],
    /// Inverse of the inverse effective masses along and across the normal.
    pub mass: [f64; 2],
    /// Smallest velocity along the normal \[m/s\].
    pub target: f64,
    /// Distance; after the velocities are known that at the end of the step, displacements of bodies left aside \[m\].
    pub gap: f64,
    /// Impulses \[N s\].
    pub normal: f64,
    pub tangent: V3,
    /// Which point of its pair.
    pub point: u32,
    /// When in the step its first impact with rebound is; infinite: there is none \[s\].
    pub hit_s: f64,
}

impl Row {
    /// Velocity of the second body's point against the first one's.
    #[inline(always)]
    pub fn relative(&self, a: &Motion, b: &Motion) -> V3 {
        between(a, b, &self.arms)
    }

    /// The same on the way through the step.
    #[inline(always)]
    pub fn passing(&self, a: &Motion, b: &Motion) -> V3 {
        between(a, b, &self.halfway)
    }
}

/// Velocity of a point of the second of two bodies against that of the first one.
#[inline(always)]
fn between(a: &Motion, b: &Motion, arms: &[V3; 2]) -> V3 {
    let of_b = math::add(b.v, math::cross(b.w, arms[1]));
    math::sub(of_b, math::add(a.v, math::cross(a.w, arms[0])))
}

impl Row {
    /// When in the step it first touches \[s\], given the speed at which it closed before the impulses \[m/s\]: that is what its gap takes, not the rest of the step in which the impulses let it close.
    pub fn touch_s(&self, closing_m_s: f64) -> f64 {
        let speed = closing_m_s.max(-self.target);
        if speed > 0.0 { self.hit_s.min(self.gap.max(0.0) / speed) } else { 0.0 }
    }

    /// Whether there was no impulse and a relative velocity asks for none.
    #[inline(always)]
    fn stays_open(&self, u: V3, n: V3) -> bool {
        self.normal == 0.0 && self.tangent == [0.0; 3] && self.target <= math::dot(u, n)
    }

    /// Corrects the impulses by a relative velocity; what is added to them, and the square of the change of velocity.
    #[inline(always)]
    pub fn correct(&mut self, u: V3, n: V3, friction: f64, cap: f64) -> (V3, f64) {
        let un = math::dot(u, n);
        let normal = (self.normal + (self.target - un) * self.mass[0]).max(0.0).min(cap);
        let mut tangent = math::axpy(self.tangent, -self.mass[1], math::axpy(u, -un, n));
        let limit = friction * normal;
        let square = math::dot(tangent, tangent);
        if square > limit * limit {
            tangent = math::scale(limit / square.sqrt(), tangent);
        }
        let across = math::sub(tangent, self.tangent);
        let along = normal - self.normal;
        let p = math::axpy(across, along, n);
        let [m, mt] = [self.mass[0] * self.mass[0], self.mass[1] * self.mass[1]];
        let change = (along * along / m).max(math::dot(across, across) / mt);
        (self.normal, self.tangent) = (normal, tangent);
        (p, change)
    }
}

/// All rows of a step; the memory is kept from step to step.
#[derive(Debug, Clone, Default)]
pub(super) struct Rows {
    pub blocks: Vec<Block>,
    pub rows: Vec<Row>,
    /// The bodies that points act on, in the order in which they came to them: of all others nothing below holds anything of this step. The ground is none of them.
    pub acting: Vec<u32>,
    acts: Vec<bool>,
    /// Velocities, the ground last, which never moves.
    pub motion: Vec<Motion>,
    pub inverse: Vec<Inverse>,
    /// What forces add to velocities in half a step.
    pub kick: Vec<Motion>,
    /// Displacements that correct gaps.
    pub shift: Vec<Motion>,
    push: Vec<f64>,
    /// Moments of the blocks, if any of them resists rolling.
    pub rolls: Vec<Roll>,
    pub links: Links,
    pub(super) search: Search,
}

impl Rows {
    /// Forgets the points.
    pub fn clear(&mut self) {
        self.blocks.clear();
        self.rows.clear();
    }

    /// Begins a step of so many bodies, without any points.
    pub fn begin(&mut self, bodies: usize) {
        self.clear();
        for i in self.acting.drain(..) {
            self.acts[i as usize] = false;
        }
        if self.acts.len() != bodies {
            self.acts.resize(bodies, false);
            for of_each in [&mut self.motion, &mut self.kick, &mut self.shift] {
                of_each.clear();
                of_each.resize(bodies + 1, Motion::default());
            }
            self.inverse.clear();
            self.inverse.resize(bodies + 1, Inverse::default());
        }
    }

    /// Takes the velocities back to those without contact.
    pub fn restart(&mut self, bodies: &[Moving]) {
        for i in self.acting.iter().map(|i| *i as usize) {
            self.motion[i] = Motion { v: bodies[i].v, w: bodies[i].w };
        }
    }

    /// Enters the bodies of the blocks from `first` on, with their velocities without contact; those that are `still` do not move.
    pub fn enter(&mut self, first: usize, bodies: &[Moving], still: &[bool]) {
        for k in first..self.blocks.len() {
            for i in self.blocks[k].bodies {
                self.enter_body(i as usize, bodies, still);
            }
        }
    }

    /// Enters a body, unless it is the ground or there already.
    pub fn enter_body(&mut self, i: usize, bodies: &[Moving], still: &[bool]) {
        if i == bodies.len() || std::mem::replace(&mut self.acts[i], true) {
            return;
        }
        let body = &bodies[i];
        self.acting.push(i as u32);
        self.motion[i] = Motion { v: body.v, w: body.w };
        self.kick[i] = Motion { v: body.kick_v, w: body.kick_w };
        self.inverse[i] = if body.alive && !still[i] { Inverse::of(body) } else { Inverse::default() };
        self.shift[i] = Motion::default();
    }

    /// Whether points act on a body.
    pub fn acts_on(&self, i: usize) -> bool {
        self.acts[i]
    }

    /// Applies the impulses that the rows from `first` on have from the last step.
    pub fn warm_start(&mut self, first: usize) {
        for block in &self.blocks[first..] {
            if block.linked != ALONE {
                for k in 0..block.count as usize {
                    let row = &self.rows[block.first as usize + k];
                    let p = math::axpy(row.tangent, row.normal, block.normal);
                    self.links.kick(block.linked as usize + k, p, &mut self.motion);
                }
                continue;
            }
            let [a, b] = block.bodies.map(|i| i as usize);
            let (mut of_a, mut of_b) = (self.motion[a], self.motion[b]);
            for row in &self.rows[block.range()] {
                let p = math::axpy(row.tangent, row.normal, block.normal);
                kick(&mut of_a, &self.inverse[a], row.arms[0], p, -1.0);
                kick(&mut of_b, &self.inverse[b], row.arms[1], p, 1.0);
            }
            self.motion[a] = of_a;
            self.motion[b] = of_b;
        }
    }

    /// Says which blocks sweeps are to leave as they are; how many points the others have.
    pub fn leave(&mut self, is_left: impl Fn(&Block) -> bool) -> usize {
        let mut count = 0;
        for block in &mut self.blocks {
            block.left = is_left(block);
            count += if block.left { 0 } else { block.count as usize };
        }
        count
    }

    /// One sweep, which passes over blocks without impulses if it is not a whole one; the largest change of a velocity \[m/s\].
    pub fn sweep(&mut self, backwards: bool, whole: bool) -> f64 {
        let mut largest = 0.0_f64;
        let count = self.blocks.len();
        for k in 0..count {
            let k = if backwards { count - 1 - k } else { k };
            let block = self.blocks[k];
            if block.left || block.idle && !whole {
                continue;
            }
            let change = if block.linked == ALONE { self.visit(&block) } else { self.visit_linked(&block) };
            largest = largest.max(change);
            if block.rolling > 0.0 {
                largest = largest.max(self.roll(k));
            }
            let rows = &self.rows[block.range()];
            self.blocks[k].idle = rows.iter().all(|r| r.normal == 0.0);
        }
        largest.sqrt()
    }

    /// Visits the rows of a block; the largest square of a change of a velocity.
    #[inline(always)]
    fn visit(&mut self, block: &Block) -> f64 {
        if block.bodies[1] as usize + 1 == self.motion.len() {
            return self.visit_fixed(block);
        }
        let [a, b] = block.bodies.map(|i| i as usize);
        let (inverse_a, inverse_b) = (self.inverse[a], self.inverse[b]);
        let (mut of_a, mut of_b) = (self.motion[a], self.motion[b]);
        let n = block.normal;
        let mut largest = 0.0_f64;
        for row in &mut self.rows[block.range()] {
            let u = row.passing(&of_a, &of_b);
            if row.stays_open(u, n) {
                continue;
            }
            let (p, change) = row.correct(u, n, block.friction, block.cap);
            largest = largest.max(change);
            kick(&mut of_a, &inverse_a, row.arms[0], p, -1.0);
            kick(&mut of_b, &inverse_b, row.arms[1], p, 1.0);
        }
        self.motion[a] = of_a;
        self.motion[b] = of_b;
        largest
    }

    /// The same of a block whose second body does not move.
    #[inline(always)]
    fn visit_fixed(&mut self, block: &Block) -> f64 {
        let a = block.bodies[0] as usize;
        let inverse = self.inverse[a];
        let mut of_a = self.motion[a];
        let n = block.normal;
        let mut largest = 0.0_f64;
        for row in &mut self.rows[block.range()] {
            let u = math::scale(-1.0, math::add(of_a.v, math::cross(of_a.w, row.halfway[0])));
            if row.stays_open(u, n) {
                continue;
            }
            let (p, change) = row.correct(u, n, block.friction, block.cap);
            largest = largest.max(change);
            kick(&mut of_a, &inverse, row.arms[0], p, -1.0);
        }
        self.motion[a] = of_a;
        largest
    }

    /// The smallest gap after a step of `h` \[s\] of points that close in it, but for those that bear all that their face can \[m\].
    pub fn sinks_to(&self, h: f64) -> f64 {
        let mut least = 0.0_f64;
        for block in &self.blocks {
            let [a, b] = block.bodies.map(|i| &self.motion[i as usize]);
            for row in &self.rows[block.range()] {
                let way = h * math::dot(row.passing(a, b), block.normal);
                if way < -SINKS_M && row.normal < block.cap {
                    least = least.min(row.gap + way);
                }
            }
        }
        least
    }

    /// Sets the gaps to those after a step of `h` \[s\], displacements left out.
    pub fn look_ahead(&mut self, h: f64) {
        for block in &self.blocks {
            let [a, b] = block.bodies.map(|i| &self.motion[i as usize]);
            for row in &mut self.rows[block.range()] {
                row.gap += h * math::dot(row.passing(a, b), block.normal);
            }
        }
    }

    /// The smallest gap that is too small after [`Self::look_ahead`], what was crushed, and the displacements so far \[m\].
    pub fn worst(&self) -> f64 {
        let mut worst = 0.0_f64;
        for block in &self.blocks {
            let [a, b] = block.bodies.map(|i| &self.shift[i as usize]);
            for row in &self.rows[block.range()] {
                let open = row.gap + math::dot(row.relative(a, b), block.normal);
                worst = worst.min(open);
            }
        }
        worst
    }

    /// Displacements that open what [`Self::look_ahead`] found closed, by a share `rate` a visit.
    pub fn separate(&mut self, sweeps: usize, rate: f64) {
        self.push.clear();
        self.push.resize(self.rows.len(), 0.0);
        let count = self.blocks.len();
        for sweep in 0..sweeps {
            for k in 0..count {
                let block = &self.blocks[if sweep % 2 == 0 { k } else { count - 1 - k }];
                let [a, b] = block.bodies.map(|i| i as usize);
                let (mut of_a, mut of_b) = (self.shift[a], self.shift[b]);
                let n = block.normal;
                for i in block.range() {
                    let row = &self.rows[i];
                    let gap = row.gap + math::dot(row.relative(&of_a, &of_b), n);
                    let share = if row.gap < -DEEP_M { DEEP_RATE } else { rate };
                    let push = (self.push[i] - share * gap * row.mass[0]).max(0.0);
                    let change = push - self.push[i];
                    if change != 0.0 {
                        self.push[i] = push;
                        let p = math::scale(change, n);
                        if block.linked != ALONE {
                            let at = block.linked as usize + i - block.first as usize;
                            self.links.kick(at, p, &mut self.shift);
                            (of_a, of_b) = (self.shift[a], self.shift[b]);
                            continue;
                        }
                        kick(&mut of_a, &self.inverse[a], row.arms[0], p, -1.0);
                        kick(&mut of_b, &self.inverse[b], row.arms[1], p, 1.0);
                    }
                }
                self.shift[a] = of_a;
                self.shift[b] = of_b;
            }
        }
    }
}

#[inline(always)]
fn kick(motion: &mut Motion, inverse: &Inverse, arm: V3, p: V3, sign: f64) {
    motion.v = math::axpy(motion.v, sign * inverse.mass, p);
    motion.w = math::axpy(motion.w, sign, inverse.turn(math::cross(arm, p)));
}
