//! Impacts of bodies that ideal joints hold together, and what friction and joints jam.
//!
//! Impacts are at the begin of a step, up to which the step before ends: within a step what forces and joints do to a velocity changes with it.

use super::links::ALONE;
use super::rows::{Block, Motion, Row, Rows};
use super::solve::REBOUND_FROM;
use super::{ContactSet, Moving};
use crate::mbs::math::{self, V3};

/// Least speed of an impact \[m/s\].
const LEAST_M_S: f64 = 1e-9;
/// Work of the impulses of a pair along the normal and against it across, over the kinetic energy of all bodies, from which they are jammed.
const JAMMED: f64 = 1.0;
/// Share of a step at its begin and end in which an impact is one at that time.
const AT_ONCE: f64 = 1e-3;

/// Velocity of a point along the normal at the begin of a step \[m/s\], and its acceleration \[m/s²\]; none if it approaches too slowly for an impact, for which a step counts with the length that it had before it was shortened.
fn strike(block: &Block, row: &Row, bodies: &[Moving], [h, whole_s]: [f64; 2]) -> Option<[f64; 2]> {
    let along = |of: fn(&Moving) -> Motion| {
        let [a, b] = block.bodies.map(|i| bodies.get(i as usize).map_or(Motion::default(), of));
        math::dot(row.relative(&a, &b), block.normal)
    };
    let kick = along(|b| Motion { v: b.kick_v, w: b.kick_w });
    let speed = along(|b| Motion { v: b.v, w: b.w }) - kick;
    (-speed > REBOUND_FROM * (kick * whole_s / h).abs() + LEAST_M_S).then_some([speed, 2.0 * kick / h])
}

impl ContactSet {
    /// Whether an impulse of the last step is that of an impact.
    pub(super) fn strikes(&self, bodies: &[Moving], h: f64) -> bool {
        self.rows.blocks.iter().any(|block| {
            let rows = &self.rows.rows[block.first as usize..(block.first + block.count) as usize];
            rows.iter().any(|row| row.normal > 0.0 && strike(block, row, bodies, [h; 2]).is_some())
        })
    }

    /// When in a step the first impact is \[s\], unless it is at its begin or end.
    pub(super) fn first_hit_s(&self, bodies: &[Moving], h: f64) -> Option<f64> {
        let inside = AT_ONCE * h..(1.0 - AT_ONCE) * h;
        let mut first = None;
        for block in &self.rows.blocks {
            for row in &self.rows.rows[block.first as usize..(block.first + block.count) as usize] {
                let Some([speed, pull]) = strike(block, row, bodies, [h; 2]) else { continue };
                let gap = row.gap.max(0.0);
                let square = speed * speed - 2.0 * pull * gap;
                let time_s = 2.0 * gap / (square.max(0.0).sqrt() - speed);
                if square >= 0.0 && inside.contains(&time_s) && first.is_none_or(|t| time_s < t) {
                    first = Some(time_s);
                }
            }
        }
        first
    }

    /// Takes friction from pairs that are jammed between it and joints in this step, and begins the impulses anew: where a push along the normal and friction across it lead to hardly any motion, they hold each other up at whatever size,
    /// and do more work against each other than all bodies have kinetic energy.
    pub(super) fn unjam(&mut self, bodies: &[Moving]) {
        if !self.rows.are_linked() {
            return;
        }
        let most_j = JAMMED * kinetic_j(bodies);
        let Rows { blocks, rows, motion, .. } = &mut self.rows;
        let mut any = false;
        for block in blocks.iter_mut().filter(|b| b.linked != ALONE && b.friction > 0.0) {
            let [a, b] = block.bodies.map(|i| mean(bodies, motion, i));
            let (mut along_j, mut across_j) = (0.0, 0.0);
            for row in &rows[block.first as usize..(block.first + block.count) as usize] {
                let u = row.relative(&a, &b);
                along_j += row.normal * math::dot(u, block.normal);
                across_j += math::dot(u, row.tangent);
            }
            if along_j * across_j < 0.0 && along_j.abs().min(across_j.abs()) > most_j {
                block.friction = 0.0;
                any = true;
            }
        }
        if !any {
            return;
        }
        self.work.jammed += 1;
        for row in rows {
            (row.normal, row.tangent) = (0.0, [0.0; 3]);
        }
        for i in self.rows.acting.iter().map(|i| *i as usize) {
            self.rows.motion[i] = Motion { v: bodies[i].v, w: bodies[i].w };
        }
        self.sweeps(bodies);
    }

    /// Gives impacts at the begin of a step their rebound by Newton's coefficient of restitution; false if there are none.
    pub(super) fn rebound_linked(&mut self, bodies: &[Moving], [h, whole_s]: [f64; 2]) -> bool {
        let mut any = false;
        let rows = &mut self.rows;
        for block in rows.blocks.iter().filter(|b| b.restitution > 0.0 && !b.idle) {
            for row in &mut rows.rows[block.first as usize..(block.first + block.count) as usize] {
                let Some([speed, pull]) = strike(block, row, bodies, [h, whole_s]) else { continue };
                // not yet there at the end of the step
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
            self.bound(bodies, &rows, &motion);
        }
        any
    }

    /// Takes rebound back to the largest share of it with which impulses make no energy. Newton's coefficient does not see to that where there is friction and joints lead a part of a blow aside (Kane and Levinson, Dynamics: Theory and Applications, 1985; Stronge,
    /// Proc. R. Soc. A 431 (1990) 169).
    fn bound(&mut self, bodies: &[Moving], plain: &[Row], without: &[Motion]) {
        // energy with a share s of the rebound: e[0] + e[1] s + e[2] s²
        let mut e = [0.0; 3];
        for block in &self.rows.blocks {
            let [a, b] = block.bodies.map(|i| mean(bodies, without, i));
            let [from, to] = [without, &self.rows.motion].map(|m| block.bodies.map(|i| m[i as usize]));
            for i in block.first as usize..(block.first + block.count) as usize {
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
        if e[1] + e[2] <= (-e[0]).max(0.0) {
            return;
        }
        let share = largest_share(e);
        for (row, plain) in self.rows.rows.iter_mut().zip(plain) {
            row.normal = plain.normal + share * (row.normal - plain.normal);
            row.tangent = math::axpy(plain.tangent, share, math::sub(row.tangent, plain.tangent));
        }
        for (now, was) in self.rows.motion.iter_mut().zip(without) {
            now.v = math::axpy(was.v, share, math::sub(now.v, was.v));
            now.w = math::axpy(was.w, share, math::sub(now.w, was.w));
        }
    }
}

/// Mean of the velocities of a body before and after the instant of contact, on which impulses do their work.
fn mean(bodies: &[Moving], after: &[Motion], i: u32) -> Motion {
    let half = |a: V3, b: V3, kick: V3| math::sub(math::scale(0.5, math::add(a, b)), kick);
    let now = &after[i as usize];
    let of = |b: &Moving| Motion { v: half(b.v, now.v, b.kick_v), w: half(b.w, now.w, b.kick_w) };
    bodies.get(i as usize).map_or(Motion::default(), of)
}

/// Kinetic energy of all bodies with the velocities of the step \[J\].
fn kinetic_j(bodies: &[Moving]) -> f64 {
    let of = |b: &Moving| {
        let l = math::mul(&math::inverse(&b.inverse_inertia), b.w);
        0.5 * (math::dot(b.v, b.v) / b.inverse_mass + math::dot(b.w, l))
    };
    bodies.iter().filter(|b| b.alive).map(of).sum()
}

/// The largest `s` up to one with which `e[0] + e[1] s + e[2] s²` is not above zero, nor above its value without any.
fn largest_share([none, linear, square]: [f64; 3]) -> f64 {
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
    }
}
