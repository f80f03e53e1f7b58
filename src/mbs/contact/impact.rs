//! Impacts with rebound: rounds of Moreau's law within a step.
//!
//! A round takes the points that the velocities before it close within the step, each at its own time `t`, and those that rest. Closing ones with a coefficient of
//! restitution `e` get `u⁺ >= -e u⁻`, with equality where there is an impulse, all of them in one problem (Moreau, in: Nonsmooth Mechanics and Applications, CISM 302,
//! 1988); resting ones `u⁺ >= 0`. Points that move apart, or are still some way off, have no part in it: if the round makes them close, they are hit in the next one, with the velocities
//! that this one left. So a chain of bodies with gaps is hit one after the other, one without gaps at once.
//!
//! The step keeps one velocity from its start to its end. Bodies that impulses of a round connect change their velocities together, at the time of the first impact among them:
//! what forces add until then is taken off the velocity after it, and the displacement `-t Δv` that a body has not made by then is taken back. With that the energy of the step changes by
//! `p (u⁻ + u⁺) / 2` with the velocities at `t`: for `e = 1` by nothing, however many points there are. Impulses that make energy all the same (sweeps that have not
//! converged, friction with rebound) are scaled down, group by group of the bodies that contacts connect.

use super::rows::{Block, Motion, Row};
use super::solve::REBOUND_FROM;
use super::{ContactSet, Moving};
use crate::mbs::math;

/// Speed below which touching points rest, over the velocities that forces add to both in half a step.
const REST: f64 = 2.0;
/// Speed at which a point must close for a further round, over the same.
const ONCE_MORE: f64 = 1.0;
/// Most rounds; the last one is without rebound and takes all points.
const MOST_ROUNDS: usize = 24;
/// Share of its way in the step by which a point may miss the other one and be hit with those that do not: corners of a face that meet at the end of a step, but for rounding.
const TIE: f64 = 1e-4;
/// Least of these speeds \[m/s\].
const LEAST_M_S: f64 = 1e-9;

/// Memory of the rounds.
#[derive(Debug, Clone, Default)]
pub(super) struct Impacts {
    /// Velocities before the round.
    before: Vec<Motion>,
    /// Impulses of the rounds before, and the time at which this one hits a point; infinite: it rests.
    total: Vec<(f64, math::V3)>,
    time: Vec<f64>,
    /// Bodies that impulses of the round connect: another one of each, and the time at which they are hit.
    leader: Vec<u32>,
    hit: Vec<f64>,
}

impl Impacts {
    /// The body that stands for those connected with one.
    fn leader(&mut self, mut body: u32) -> u32 {
        while self.leader[body as usize] != body {
            self.leader[body as usize] = self.leader[self.leader[body as usize] as usize];
            body = self.leader[body as usize];
        }
        body
    }

    fn connect(&mut self, a: u32, b: u32) {
        let [a, b] = [a, b].map(|body| self.leader(body));
        self.leader[a.max(b) as usize] = a.min(b);
    }
}

/// How a point approaches in a step.
struct Approach {
    /// Velocity along the normal at the start of the step, without forces of the step; what forces add in half of it, and to either body \[m/s\].
    speed: f64,
    kick: f64,
    kicks: f64,
    /// Distances on the way that leads to the end of the step, at its start and at its end \[m\].
    gap: f64,
    end: f64,
}

impl Approach {
    /// Speed below which it rests \[m/s\].
    fn rest(&self) -> f64 {
        REST * self.kicks + LEAST_M_S
    }

    /// Least velocity in the step without rebound \[m/s\].
    fn plain(&self, h: f64) -> f64 {
        -self.gap.max(0.0) / h
    }

    /// Time of an impact with rebound \[s\] and the velocity in the step after it \[m/s\]; none if it is too slow, or over within the step.
    fn rebound(&self, restitution: f64, h: f64) -> Option<(f64, f64)> {
        // a rebound slower than what forces add to the bodies is none
        let slow = (REBOUND_FROM * self.kick.abs()).max((1.0 / restitution - 1.0) * self.kicks);
        if restitution == 0.0 || -self.speed <= slow + LEAST_M_S {
            return None;
        }
        let pull = 2.0 * self.kick / h;
        let gap = self.gap.max(0.0);
        let root = (self.speed * self.speed - 2.0 * pull * gap).max(0.0).sqrt();
        let time = (2.0 * gap / (root - self.speed)).min(h);
        let target = self.after(restitution, time, h);
        // the velocity in the step has the half of the forces that comes after its middle
        let end = (target - pull * (0.5 * h - time)) * (h - time) + 0.5 * pull * (h - time) * (h - time);
        (end >= 0.0 && target > self.plain(h)).then_some((time, target))
    }

    /// Velocity in the step after an impact at a time \[m/s\].
    fn after(&self, restitution: f64, time: f64, h: f64) -> f64 {
        let pull = 2.0 * self.kick / h;
        -restitution * (self.speed + pull * time) + pull * (0.5 * h - time)
    }

    /// Least velocity in the step \[m/s\], and the time of an impact with rebound, infinite if there is none; nothing: it has no part in the round.
    fn aim(&self, restitution: f64, h: f64) -> Option<(f64, f64)> {
        if self.end < TIE * (self.gap - self.end).max(0.0) {
            let rebound = self.rebound(restitution, h);
            return Some(rebound.map_or((self.plain(h), f64::INFINITY), |(time, target)| (target, time)));
        }
        let rests = self.speed.abs() <= self.rest() && self.gap <= self.rest() * h;
        rests.then(|| (self.plain(h), f64::INFINITY))
    }
}

impl ContactSet {
    /// Gives impacts their rebound.
    pub(super) fn rebound(&mut self, bodies: &[Moving], h: f64) {
        if !self.is_hit(bodies, h) {
            return;
        }
        self.rows.restart(bodies);
        self.impacts.total.clear();
        self.start_rolls(0, h, false);
        for round in 0..MOST_ROUNDS {
            let last = round + 1 == MOST_ROUNDS;
            if !self.aim(h, round, last) {
                break;
            }
            self.impacts.before.clone_from(&self.rows.motion);
            if round == 0 {
                self.rows.warm_start(0);
            }
            self.sweeps(bodies);
            if self.gather(h) {
                self.sweeps(bodies);
            }
            self.damp(h);
            self.displace();
            if !last {
                self.extend(bodies, h);
                self.start_rolls(self.rows.rolls.len(), h, false);
            }
        }
        for (row, (normal, tangent)) in self.rows.rows.iter_mut().zip(&self.impacts.total) {
            (row.normal, row.tangent, row.target) = (*normal, *tangent, -row.gap.max(0.0) / h);
        }
        for roll in &mut self.rows.rolls {
            roll.moment = roll.total;
        }
    }

    /// Whether a point has an impact with rebound.
    fn is_hit(&self, bodies: &[Moving], h: f64) -> bool {
        let start = |i: u32| bodies.get(i as usize).map_or(Motion::default(), |b| Motion { v: b.v, w: b.w });
        self.rows.blocks.iter().filter(|b| b.restitution > 0.0 && !b.idle).any(|block| {
            let motion = block.bodies.map(start);
            self.rows.rows[block.range()].iter().any(|row| {
                row.normal > 0.0
                    && self.approach(block, row, &motion, h).rebound(block.restitution, h).is_some()
            })
        })
    }

    fn approach(&self, block: &Block, row: &Row, motion: &[Motion; 2], h: f64) -> Approach {
        let n = block.normal;
        let still = Motion::default();
        let [kick_a, kick_b] = block.bodies.map(|i| &self.rows.kick[i as usize]);
        let of_a = math::dot(row.relative(kick_a, &still), n);
        let of_b = math::dot(row.relative(&still, kick_b), n);
        let [shift_a, shift_b] = block.bodies.map(|i| &self.rows.shift[i as usize]);
        let gap = row.gap + math::dot(row.relative(shift_a, shift_b), n);
        let u = math::dot(row.relative(&motion[0], &motion[1]), n);
        let kick = of_a + of_b;
        Approach { speed: u - kick, kick, kicks: of_a.abs() + of_b.abs(), gap, end: gap + h * u }
    }

    /// Gives each point its least velocity in a round; false if no round is needed. The first one starts from the impulses found without rebound.
    fn aim(&mut self, h: f64, round: usize, last: bool) -> bool {
        self.impacts.time.resize(self.rows.rows.len(), f64::INFINITY);
        self.impacts.total.resize(self.rows.rows.len(), (0.0, [0.0; 3]));
        let mut needed = round == 0;
        for k in 0..self.rows.blocks.len() {
            let block = self.rows.blocks[k];
            let motion = block.bodies.map(|i| self.rows.motion[i as usize]);
            for i in block.range() {
                let approach = self.approach(&block, &self.rows.rows[i], &motion, h);
                needed |= approach.gap.min(0.0) - approach.end > ONCE_MORE * (approach.kicks + LEAST_M_S) * h;
                let aim = if last {
                    Some((approach.plain(h), f64::INFINITY))
                } else {
                    approach.aim(block.restitution, h)
                };
                let row = &mut self.rows.rows[i];
                if round > 0 || aim.is_none() {
                    (row.normal, row.tangent) = (0.0, [0.0; 3]);
                }
                (row.target, self.impacts.time[i]) = aim.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                row.hit_s = row.hit_s.min(self.impacts.time[i]);
            }
        }
        needed
    }

    /// Finds the bodies that impulses of the round connect and the time at which they are hit; true if that changes the velocities that points are to have.
    fn gather(&mut self, h: f64) -> bool {
        let (rows, impacts) = (&self.rows, &mut self.impacts);
        let ground = self.ground as u32;
        impacts.leader.clear();
        impacts.leader.extend(0..=ground);
        impacts.hit.clear();
        impacts.hit.resize(self.ground + 1, f64::INFINITY);
        for block in &rows.blocks {
            let [a, b] = block.bodies;
            let acting = block.range().filter(|i| rows.rows[*i].normal > 0.0);
            let Some(time) = acting.map(|i| impacts.time[i]).reduce(f64::min) else { continue };
            let moving = if a == ground { b } else { a };
            if a != ground && b != ground {
                impacts.connect(a, b);
            }
            let leader = impacts.leader(moving) as usize;
            impacts.hit[leader] = impacts.hit[leader].min(time);
        }
        // a time that was noted before its body got another leader
        for body in 0..self.ground {
            let leader = impacts.leader(body as u32) as usize;
            impacts.hit[leader] = impacts.hit[leader].min(impacts.hit[body]);
        }
        for body in 0..self.ground {
            let leader = impacts.leader(body as u32) as usize;
            impacts.hit[body] = impacts.hit[leader];
        }
        self.agree(h)
    }

    /// Lets impacts of bodies that are hit together have one time; true if that changes a velocity.
    fn agree(&mut self, h: f64) -> bool {
        let mut changed = false;
        for k in 0..self.rows.blocks.len() {
            let block = self.rows.blocks[k];
            let motion = block.bodies.map(|i| self.impacts.before[i as usize]);
            for i in block.range() {
                let [a, b] = block.bodies.map(|body| self.impacts.hit[body as usize]);
                let together = a.min(b);
                let own = self.impacts.time[i];
                if self.rows.rows[i].normal > 0.0 && own.is_finite() && own != together {
                    let approach = self.approach(&block, &self.rows.rows[i], &motion, h);
                    self.rows.rows[i].target = approach.after(block.restitution, together, h);
                    self.impacts.time[i] = together;
                    changed = true;
                }
            }
        }
        changed
    }

    /// Scales the impulses of a round down to those that make no energy, group by group.
    fn damp(&mut self, h: f64) {
        let groups = self.groups();
        let mut works = vec![[0.0; 2]; groups.count()];
        for (k, block) in self.rows.blocks.iter().enumerate() {
            let [linear, square] = &mut works[groups.of_block(block)];
            let [rolled, rolls] = self.roll_work(k, |i| self.impacts.before[i as usize]);
            (*linear, *square) = (*linear + rolled, *square + (rolls - rolled));
            let [kick_a, kick_b] = block.bodies.map(|i| &self.rows.kick[i as usize]);
            let [first_a, first_b] = block.bodies.map(|i| &self.impacts.before[i as usize]);
            let [now_a, now_b] = block.bodies.map(|i| &self.rows.motion[i as usize]);
            let [a, b] = block.bodies.map(|body| self.impacts.hit[body as usize]);
            let time = if a.min(b).is_finite() { a.min(b) } else { 0.0 };
            for row in self.rows.rows[block.range()].iter().filter(|row| row.normal != 0.0) {
                let p = math::axpy(row.tangent, row.normal, block.normal);
                let forces = row.relative(kick_a, kick_b);
                let start = row.relative(first_a, first_b);
                let pull = 2.0 / h * math::dot(forces, block.normal);
                *linear += math::dot(p, math::sub(start, forces)) + row.normal * time * pull;
                *square += math::dot(p, math::sub(row.relative(now_a, now_b), start));
            }
        }
        let Self { rows, impacts, .. } = self;
        rows.scale_down(&groups, &works, 2.0, |i| impacts.before[i]);
    }

    /// Takes back the displacements that the velocities after a round would make before its time, and adds its impulses to those of the rounds before.
    fn displace(&mut self) {
        for (row, total) in self.rows.rows.iter().zip(&mut self.impacts.total) {
            *total = (total.0 + row.normal, math::add(total.1, row.tangent));
        }
        for roll in &mut self.rows.rolls {
            (roll.total, roll.moment) = (math::add(roll.total, roll.moment), [0.0; 3]);
        }
        for i in self.rows.acting.iter().map(|i| *i as usize) {
            let (now, before, time) = (&self.rows.motion[i], &self.impacts.before[i], self.impacts.hit[i]);
            let shift = &mut self.rows.shift[i];
            if time.is_finite() {
                shift.v = math::axpy(shift.v, -time, math::sub(now.v, before.v));
                shift.w = math::axpy(shift.w, -time, math::sub(now.w, before.w));
            }
        }
    }
}
