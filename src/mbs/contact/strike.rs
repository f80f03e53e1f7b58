//! Impacts of bodies that ideal joints hold together, and what friction and joints jam.
//!
//! Impacts are at the start of a step, up to which the step before ends, and which is next to nothing: within a step what forces and joints do to a velocity changes with it, and what is hit then may hit another one.

use super::groups::Groups;
use super::links::ALONE;
use super::pair::Pair;
use super::rows::{Block, Motion, Row, Rows};
use super::solve::REBOUND_FROM;
use super::{ContactSet, Moving};
use crate::mbs::math::{self, V3};

/// Least speed of an impact \[m/s\].
const LEAST_M_S: f64 = 1e-9;
/// Work of the impulses of a pair along the normal and against it across, over the kinetic energy of all bodies of its group, from which they are jammed.
const JAMMED: f64 = 0.5;
/// Speed at which a point may approach that bore in the last step, over what that impulse stops.
const HELD: f64 = 0.1;
/// Share of a step at its start in which an impact is one at the start, and in which points of a pair are hit with one that is.
const AT_ONCE: f64 = 1e-3;
const TOGETHER: f64 = 0.1;

/// Velocity of a point along the normal at the start of a step, what forces add to it in half of the step, and the sum of what they add to either body, without signs \[m/s\].
fn approach(block: &Block, row: &Row, bodies: &[Moving]) -> [f64; 3] {
    let [a, b] = [0, 1].map(|side| {
        let along = |v: V3, w: V3| math::dot(math::add(v, math::cross(w, row.arms[side])), block.normal);
        let body = bodies.get(block.bodies[side] as usize);
        body.map_or([0.0; 2], |b| [along(b.v, b.w), along(b.kick_v, b.kick_w)])
    });
    let kick = b[1] - a[1];
    [b[0] - a[0] - kick, kick, a[1].abs() + b[1].abs()]
}

/// Velocity of a point along the normal at the start of a step \[m/s\], and its acceleration \[m/s²\]; none if it approaches too slowly for an impact, for which a step counts with the length that it had before it was shortened.
fn strike(
    block: &Block,
    row: &Row,
    bodies: &[Moving],
    pairs: &[Pair],
    [h, whole_s]: [f64; 2],
) -> Option<[f64; 2]> {
    let [speed, kick, kicks] = approach(block, row, bodies);
    // bodies that rest on each other have no more than what sweeps leave of the latter, those that are pressed together of what held them apart in the last step
    let bore = h * pairs[block.slot as usize].points[row.point as usize].normal;
    let held = if bore > 0.0 { HELD * bore / row.mass[0] } else { 0.0 };
    let slow = (REBOUND_FROM * kick.abs()).max(kicks).max(held) * whole_s / h;
    (-speed > slow + LEAST_M_S).then_some([speed, 2.0 * kick / h])
}

/// When a point at a speed and an acceleration along the normal closes \[s\]; none if it turns round before.
fn hit_s(row: &Row, [speed, pull]: [f64; 2]) -> Option<f64> {
    let gap = row.gap.max(0.0);
    let square = speed * speed - 2.0 * pull * gap;
    (square >= 0.0).then(|| 2.0 * gap / (square.sqrt() - speed))
}

impl ContactSet {
    /// Whether an impulse of the last step is that of an impact, by group. Resting points move by what forces add to either body.
    pub(super) fn strikes(&self, bodies: &[Moving], groups: &Groups) -> Vec<bool> {
        let mut strikes = vec![false; groups.count()];
        for block in &self.rows.blocks {
            for row in self.rows.rows[block.range()].iter().filter(|row| row.normal > 0.0) {
                let [speed, _, kicks] = approach(block, row, bodies);
                strikes[groups.of_block(block)] |= -speed > REBOUND_FROM * kicks + LEAST_M_S;
            }
        }
        strikes
    }

    /// How long a step of `h` \[s\] is up to its first impact, or with one at its start, after which velocities are others: next to nothing \[s\]; none if there is no impact.
    pub(super) fn first_hit_s(&self, bodies: &[Moving], h: f64) -> Option<f64> {
        let blocks = self.rows.blocks.iter();
        let hits = blocks.flat_map(|block| self.rows.rows[block.range()].iter().map(move |row| (block, row)));
        let times =
            hits.filter_map(|(block, row)| hit_s(row, strike(block, row, bodies, &self.pairs, [h; 2])?));
        times.filter(|t| *t < h).reduce(f64::min).map(|t| t.max(AT_ONCE * h))
    }

    /// Lets the points of a pair that would be hit right after one of its points be hit with it: corners of a face that come down level, but for rounding.
    pub(super) fn tie(&mut self, bodies: &[Moving], [h, whole_s]: [f64; 2]) {
        let Self { pairs, rows: Rows { blocks, rows, .. }, .. } = self;
        for block in blocks.iter() {
            let time = |row: &Row| hit_s(row, strike(block, row, bodies, pairs, [h, whole_s])?);
            let rows = &mut rows[block.range()];
            if rows.iter().any(|row| time(row).is_some_and(|t| t <= AT_ONCE * whole_s)) {
                for row in rows.iter_mut().filter(|row| time(row).is_some_and(|t| t <= TOGETHER * whole_s)) {
                    (row.target, row.gap) = (0.0, row.gap.min(0.0));
                }
            }
        }
    }

    /// Takes friction from pairs that are jammed between it and joints in this step, and begins the impulses anew: where a push along the normal and friction across it lead to hardly any motion, they hold each other up at whatever size,
    /// and do more work against each other than half of the kinetic energy of their group.
    pub(super) fn unjam(&mut self, bodies: &[Moving], groups: &Groups) {
        if !self.rows.are_linked() {
            return;
        }
        let mut most_j = vec![0.0; groups.count()];
        for (i, body) in bodies.iter().enumerate().filter(|(_, body)| body.alive) {
            most_j[groups.of(i)] += JAMMED * kinetic_j(body);
        }
        let Rows { blocks, rows, motion, .. } = &self.rows;
        let is_opposed = |block: &Block| {
            let [a, b] = block.bodies.map(|i| mean(bodies, motion, i));
            let (mut along_j, mut across_j) = (0.0, 0.0);
            for row in &rows[block.range()] {
                let u = row.relative(&a, &b);
                along_j += row.normal * math::dot(u, block.normal);
                across_j += math::dot(u, row.tangent);
            }
            let opposed_j = along_j.abs().min(across_j.abs());
            along_j * across_j < 0.0 && opposed_j > most_j[groups.of_block(block)]
        };
        // what Coulomb's law says of a single point is no jam
        let is_jammed = |block: &Block| {
            let may_jam = block.linked != ALONE && block.friction > 0.0;
            may_jam && is_opposed(block) && !self.rows.is_single(block)
        };
        let jammed: Vec<usize> = (0..blocks.len()).filter(|k| is_jammed(&blocks[*k])).collect();
        if jammed.is_empty() {
            return;
        }
        self.work.jammed += 1;
        jammed.into_iter().for_each(|k| self.rows.blocks[k].friction = 0.0);
        for row in &mut self.rows.rows {
            (row.normal, row.tangent) = (0.0, [0.0; 3]);
        }
        self.rows.restart(bodies);
        self.sweeps(bodies);
    }

    /// Gives impacts at the start of a step their rebound by Newton's coefficient of restitution; false if there are none.
    pub(super) fn rebound_linked(
        &mut self,
        bodies: &[Moving],
        groups: &Groups,
        [h, whole_s]: [f64; 2],
    ) -> bool {
        let mut any = false;
        let Self { pairs, rows: Rows { blocks, rows, .. }, .. } = self;
        for block in blocks.iter().filter(|b| b.restitution > 0.0 && !b.idle) {
            for row in &mut rows[block.range()] {
                let Some([speed, pull]) = strike(block, row, bodies, pairs, [h, whole_s]) else { continue };
                // not yet there
                if row.normal <= 0.0 || row.gap > -AT_ONCE * whole_s * speed {
                    continue;
                }
                // what forces add in half of the step is in all velocities of it
                let target = -block.restitution * speed + 0.5 * h * pull;
                if target > row.target {
                    row.target = target;
                    any = true;
                }
            }
        }
        if any {
            let (rows, motion) = (self.rows.rows.clone(), self.rows.motion.clone());
            self.sweeps(bodies);
            self.bound(bodies, groups, &rows, &motion);
        }
        any
    }

    /// Takes rebound back to the largest share of it with which impulses make no energy. Newton's coefficient does not see to that where there is friction and joints lead a part of a blow aside (Kane and Levinson, Dynamics: Theory and Applications, 1985; Stronge,
    /// Proc. R. Soc. A 431 (1990) 169).
    fn bound(&mut self, bodies: &[Moving], groups: &Groups, plain: &[Row], without: &[Motion]) {
        // energy of each group with a share s of its rebound: e[0] + e[1] s + e[2] s²
        let mut energies = vec![[0.0; 3]; groups.count()];
        for block in &self.rows.blocks {
            let e = &mut energies[groups.of_block(block)];
            let [a, b] = block.bodies.map(|i| mean(bodies, without, i));
            let [from, to] = [without, &self.rows.motion].map(|m| block.bodies.map(|i| m[i as usize]));
            for i in block.range() {
                let (row, plain) = (&self.rows.rows[i], &plain[i]);
                let p = math::axpy(plain.tangent, plain.normal, block.normal);
                let more = math::sub(math::axpy(row.tangent, row.normal, block.normal), p);
                let mean = row.relative(&a, &b);
                let [u, with] = [from, to].map(|[a, b]| row.relative(&a, &b));
                let change = math::scale(0.5, math::sub(with, u));
                e[0] += math::dot(p, mean);
                e[1] += math::dot(p, change) + math::dot(more, mean);
                e[2] += math::dot(more, change);
            }
        }
        let shares: Vec<f64> = energies.into_iter().map(largest_share).collect();
        for block in &self.rows.blocks {
            let share = shares[groups.of_block(block)];
            for i in block.range() {
                let (row, plain) = (&mut self.rows.rows[i], &plain[i]);
                row.normal = between(plain.normal, row.normal, share);
                row.tangent = std::array::from_fn(|k| between(plain.tangent[k], row.tangent[k], share));
            }
        }
        for i in self.rows.acting.iter().map(|i| *i as usize) {
            let (share, now, was) = (shares[groups.of(i)], &mut self.rows.motion[i], &without[i]);
            now.v = std::array::from_fn(|k| between(was.v[k], now.v[k], share));
            now.w = std::array::from_fn(|k| between(was.w[k], now.w[k], share));
        }
    }
}

/// From one number at a share of zero to another one at a share of one, which it is to the last digit.
fn between(from: f64, to: f64, share: f64) -> f64 {
    if share == 1.0 { to } else { from + share * (to - from) }
}

/// Mean of the velocities of a body before and after the instant of contact, on which impulses do their work.
fn mean(bodies: &[Moving], after: &[Motion], i: u32) -> Motion {
    let half = |a: V3, b: V3, kick: V3| math::sub(math::scale(0.5, math::add(a, b)), kick);
    let now = &after[i as usize];
    let of = |b: &Moving| Motion { v: half(b.v, now.v, b.kick_v), w: half(b.w, now.w, b.kick_w) };
    bodies.get(i as usize).map_or(Motion::default(), of)
}

/// Kinetic energy of a body with the velocities of the step \[J\].
fn kinetic_j(body: &Moving) -> f64 {
    let l = math::mul(&math::inverse(&body.inverse_inertia), body.w);
    0.5 * (math::dot(body.v, body.v) / body.inverse_mass + math::dot(body.w, l))
}

/// The largest `s` up to one with which `e[0] + e[1] s + e[2] s²` is not above zero, nor above its value without any.
fn largest_share([none, linear, square]: [f64; 3]) -> f64 {
    if linear + square <= (-none).max(0.0) {
        return 1.0;
    }
    let least = none.min(0.0);
    let root = (linear * linear - 4.0 * square * least).max(0.0).sqrt();
    // of the two forms of the root the one that does not cancel
    let share = if linear > 0.0 { -2.0 * least / (linear + root) } else { (root - linear) / (2.0 * square) };
    share.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::largest_share;

    #[test]
    fn the_largest_share_makes_no_energy() {
        for e in [[-1.0, 0.5, 2.0], [-1.0, -0.5, 2.0], [0.5, -1.0, 2.0], [-1.0, 3.0, -1.0], [-1e-9, 1.0, 1.0]]
        {
            let s = largest_share(e);
            let energy = e[0] + e[1] * s + e[2] * s * s;
            let most = e[0].max(0.0);
            assert!(s > 0.0 && s < 1.0 && (energy - most).abs() < 1e-12, "{e:?}: {s} {energy}");
        }
        assert_eq!(largest_share([0.5, 1.0, 2.0]), 0.0);
        assert_eq!(largest_share([-1.0, 0.2, 0.3]), 1.0);
    }
}
