//! What ideal joints add to accelerations, impulses, displacements: the solution of `S λ = G l + shift`, for one right-hand side or for those of a whole step at once.
//!
//! The solution waits for its own numbers more than for arithmetic, so that four right-hand sides cost little more than one. A step of the leapfrog ends with three: accelerations of
//! the next state, and the displacements and velocities that lead back onto the joints.

use super::factor::SIDES;
use super::joint::{Row, is_ground};
use super::motion::{Motion, SENSE, STATE};
use crate::base::isa::for_each_isa;
use crate::mbs::math::{M3, V3, add, axpy, cross, dot, mul, qexp, qmul, qrenormalise};

/// A number for each right-hand side.
pub(super) type Sides = [f64; SIDES];
/// A force and a torque, or what they make of a body, for each right-hand side.
pub(super) type Loads = [[Sides; 3]; 2];

/// Right-hand sides: accelerations, displacements onto the joints, velocities.
const RATE: usize = 0;
const SHIFT: usize = 1;
const SPEED: usize = 2;

impl Motion {
    /// Solves `S λ = G l + shift` and takes `M⁻¹ Gᵀ λ` off the loads `l`.
    pub(super) fn accept(&mut self, shift: impl Fn(&Row) -> f64) {
        for (j, joint) in self.joints.iter().enumerate() {
            let range = self.first[j]..self.first[j + 1];
            let (rows, wanted) = (&self.rows[range.clone()], &mut self.multipliers[range]);
            for (row, wanted) in rows.iter().zip(wanted.iter_mut()) {
                *wanted = shift(row);
            }
            for side in (0..2).filter(|side| !is_ground(joint.bodies[*side])) {
                let [a, w] = self.loads[joint.bodies[side]];
                if let Some(arms) = self.arms[j] {
                    let at_point = add(a, cross(w, arms[side]));
                    wanted.iter_mut().zip(at_point).for_each(|(l, v)| *l += SENSE[side] * v);
                    continue;
                }
                for (row, wanted) in rows.iter().zip(wanted.iter_mut()) {
                    *wanted += dot(row.of[side][0], a) + dot(row.of[side][1], w);
                }
            }
        }
        self.factor.solve(&mut self.multipliers);
        for (j, joint) in self.joints.iter().enumerate() {
            let range = self.first[j]..self.first[j + 1];
            for side in (0..2).filter(|side| !is_ground(joint.bodies[*side])) {
                let body = joint.bodies[side];
                let [a, w] = &mut self.loads[body];
                if let Some(arms) = self.arms[j] {
                    let force: V3 = std::array::from_fn(|i| -SENSE[side] * self.multipliers[range.start + i]);
                    *a = axpy(*a, 1.0 / self.mass[body], force);
                    *w = add(*w, mul(&self.inverse[body], cross(arms[side], force)));
                    continue;
                }
                for r in range.clone() {
                    let [linear, angular] = self.moved[r][side];
                    *a = axpy(*a, -self.multipliers[r], linear);
                    *w = axpy(*w, -self.multipliers[r], angular);
                }
            }
        }
    }

    /// The rate of the state that was taken at the end of a step of the leapfrog from `state` with the rate `before`; and what [`Motion::close`] does to that state.
    pub fn rate_and_close(&mut self, state: &[f64], before: &[f64], step: f64, rate: &mut [f64]) {
        let power = self.load();
        let bodies = state.chunks_exact(STATE).zip(before.chunks_exact(STATE));
        for ((sides, load), (s, k)) in self.sides.iter_mut().zip(&self.loads).zip(bodies) {
            for (part, i) in
                [(0, 7), (1, 10)].into_iter().flat_map(|(p, f)| (0..3).map(move |i| ((p, i), f + i)))
            {
                let rate = load[part.0][part.1];
                // the end's own share of joint forces is found with the projection
                sides[part.0][part.1] = [rate, 0.0, s[i] + 0.5 * step * (k[i] + rate), 0.0];
            }
        }
        for (wanted, row) in self.wanted.iter_mut().zip(&self.rows) {
            *wanted = [-row.gamma, row.residual, 0.0, 0.0];
        }
        accept_sides(self.factor.isa(), self);
        for (load, sides) in self.loads.iter_mut().zip(&self.sides) {
            *load = side(sides, RATE);
        }
        for (multiplier, wanted) in self.multipliers.iter_mut().zip(&self.wanted) {
            *multiplier = wanted[RATE];
        }
        self.write_rate(power, rate);
    }

    /// Moves the state that was taken to the nearest one, in the norm of kinetic energy, that the joints allow: one Newton step of positions, and velocities.
    pub fn project(&mut self, state: &mut [f64]) {
        for (sides, s) in self.sides.iter_mut().zip(state.chunks_exact(STATE)) {
            for i in 0..3 {
                (sides[0][i], sides[1][i]) = ([0.0, 0.0, s[7 + i], 0.0], [0.0, 0.0, s[10 + i], 0.0]);
            }
        }
        for (wanted, row) in self.wanted.iter_mut().zip(&self.rows) {
            *wanted = [0.0, row.residual, 0.0, 0.0];
        }
        accept_sides(self.factor.isa(), self);
        self.close(state);
    }

    /// Takes off an error of a state what [`Motion::project`] does, to first order, at the state that was taken.
    pub fn project_error(&mut self, error: &mut [f64]) {
        for (load, e) in self.loads.iter_mut().zip(error.chunks_exact(STATE)) {
            *load = [[e[7], e[8], e[9]], [e[10], e[11], e[12]]];
        }
        self.accept(|_| 0.0);
        for (b, e) in error.chunks_exact_mut(STATE).enumerate() {
            let ([v, w], pose) = (self.loads[b], &self.poses[b]);
            e[7..10].copy_from_slice(&v);
            e[10..13].copy_from_slice(&w);
            // twice the change of the orientation over itself
            let [_, turn @ ..] =
                qmul([e[3], e[4], e[5], e[6]], [pose.q[0], -pose.q[1], -pose.q[2], -pose.q[3]]);
            self.loads[b] = [[e[0], e[1], e[2]], turn.map(|t| 2.0 * t)];
        }
        self.accept(|_| 0.0);
        for (b, e) in error.chunks_exact_mut(STATE).enumerate() {
            let ([x, turn], pose) = (self.loads[b], &self.poses[b]);
            e[..3].copy_from_slice(&x);
            let [a, b, c] = turn.map(|t| 0.5 * t);
            e[3..7].copy_from_slice(&qmul([0.0, a, b, c], pose.q));
        }
    }

    /// The same after [`Motion::rate_and_close`], which has found where to.
    pub fn close(&self, state: &mut [f64]) {
        for (s, sides) in state.chunks_exact_mut(STATE).zip(&self.sides) {
            let ([shift, turn], [v, w]) = (side(sides, SHIFT), side(sides, SPEED));
            (0..3).for_each(|i| s[i] += shift[i]);
            let q = qrenormalise(qmul(qexp(turn), [s[3], s[4], s[5], s[6]]));
            s[3..7].copy_from_slice(&q);
            s[7..10].copy_from_slice(&v);
            s[10..].copy_from_slice(&w);
        }
    }
}

/// One right-hand side.
fn side(of: &Loads, side: usize) -> [V3; 2] {
    of.map(|part| part.map(|i| i[side]))
}

for_each_isa! {
    /// [`Motion::accept`] for all right-hand sides: of the loads `sides`, with the shifts in `wanted`.
    fn accept_sides = accept_any(motion: &mut Motion)
}

#[inline(always)]
fn accept_any(motion: &mut Motion) {
    let Motion { joints, first, rows, arms, moved, mass, inverse, factor, sides, wanted, .. } = motion;
    for (j, joint) in joints.iter().enumerate() {
        let range = first[j]..first[j + 1];
        for side in (0..2).filter(|side| !is_ground(joint.bodies[*side])) {
            let [a, w] = &sides[joint.bodies[side]];
            let wanted = &mut wanted[range.clone()];
            if let Some(arms) = arms[j] {
                let turned = cross_sides(w, arms[side]);
                for i in 0..3 {
                    (0..SIDES).for_each(|r| wanted[i][r] += SENSE[side] * (a[i][r] + turned[i][r]));
                }
                continue;
            }
            for (row, wanted) in rows[range.clone()].iter().zip(wanted) {
                let [linear, angular] = row.of[side];
                for r in 0..SIDES {
                    let dot = |g: V3, l: &[Sides; 3]| g[0] * l[0][r] + g[1] * l[1][r] + g[2] * l[2][r];
                    wanted[r] += dot(linear, a) + dot(angular, w);
                }
            }
        }
    }
    factor.solve_sides(wanted);
    for (j, joint) in joints.iter().enumerate() {
        for side in (0..2).filter(|side| !is_ground(joint.bodies[*side])) {
            let body = joint.bodies[side];
            let [a, w] = &mut sides[body];
            if let Some(arms) = arms[j] {
                let force: [Sides; 3] =
                    std::array::from_fn(|i| wanted[first[j] + i].map(|l| SENSE[side] * l));
                push(a, w, &force, arms[side], 1.0 / mass[body], &inverse[body]);
                continue;
            }
            for r in first[j]..first[j + 1] {
                let [linear, angular] = moved[r][side];
                for i in 0..3 {
                    (0..SIDES).for_each(|s| a[i][s] -= wanted[r][s] * linear[i]);
                    (0..SIDES).for_each(|s| w[i][s] -= wanted[r][s] * angular[i]);
                }
            }
        }
    }
}

/// `l × arm`.
#[inline(always)]
fn cross_sides(l: &[Sides; 3], arm: V3) -> [Sides; 3] {
    let mut out = [[0.0; SIDES]; 3];
    for r in 0..SIDES {
        out[0][r] = l[1][r] * arm[2] - l[2][r] * arm[1];
        out[1][r] = l[2][r] * arm[0] - l[0][r] * arm[2];
        out[2][r] = l[0][r] * arm[1] - l[1][r] * arm[0];
    }
    out
}

/// Takes what forces at the end of an arm make of a body off its motion.
#[inline(always)]
fn push(
    a: &mut [Sides; 3],
    w: &mut [Sides; 3],
    force: &[Sides; 3],
    arm: V3,
    inverse_mass: f64,
    inverse: &M3,
) {
    let torque = cross_sides(force, arm);
    for i in 0..3 {
        for r in 0..SIDES {
            a[i][r] -= inverse_mass * force[i][r];
            // the torque is that of `force × arm`, of the other sense
            w[i][r] +=
                inverse[i][0] * torque[0][r] + inverse[i][1] * torque[1][r] + inverse[i][2] * torque[2][r];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::joint::{Joint, Kind};
    use super::super::motion::WORKS;
    use super::super::{Body, GROUND, Mechanism};
    use super::*;

    #[test]
    fn one_solution_does_what_three_do() {
        let body = |x: f64| Body::at_rest(2.0, [0.1, 0.2, 0.3], [x, 0.0, 0.0]);
        let mechanism = Mechanism {
            bodies: vec![body(0.5), body(1.5), body(2.5)],
            joints: vec![
                Joint::at(Kind::Spherical, [GROUND, 0], [0.0; 3], [0.0, 1.0, 0.0]),
                Joint::at(Kind::Spherical, [0, 1], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
                Joint::at(Kind::Revolute, [1, 2], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
            ],
            gravity_m_s2: [0.0, 0.0, -9.81],
            ..Mechanism::default()
        };
        let mut motion = Motion::of(&mechanism, true).unwrap();
        let mut state = Motion::state(&mechanism);
        // moving, and off the joints by millimetres
        for (i, s) in state.iter_mut().enumerate() {
            *s += 1e-3 * (12.9898 * i as f64).sin() + if i % STATE > 9 { 1.0 } else { 0.0 };
        }
        motion.take(&state);
        let mut before = vec![0.0; state.len()];
        motion.rate(&mut before);
        let (h, mut after) = (1e-2, vec![0.0; state.len()]);
        motion.take(&state);
        motion.rate_and_close(&state, &before, h, &mut after);
        assert!(before.iter().zip(&after).all(|(a, b)| (a - b).abs() < 1e-11 * (1.0 + a.abs())));
        let mut closed = state.clone();
        for b in (0..state.len() - WORKS).step_by(STATE) {
            (b + 7..b + STATE).for_each(|i| closed[i] += 0.5 * h * (before[i] + after[i]));
        }
        let mut projected = closed.clone();
        motion.close(&mut closed);
        motion.project(&mut projected);
        let far = closed.iter().zip(&projected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(far < 1e-11, "{far}");
        motion.take(&closed);
        assert!(motion.residual() < 1e-4, "{}", motion.residual());
    }
}
