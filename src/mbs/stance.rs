//! Where a compliant joint is, and what its force and moment do to its bodies.
//!
//! Let `J` be the joint frame carried by body A, `g = p_B - p_A` the gap of the joint point and
//! `θ = log(R_Aᵀ R_B)` the rotation vector in that frame. With `d = Jᵀ g` and an energy `U(d, θ)` the force is `F = J ∂U/∂d` and the torque
//! `τ = J T⁻ᵀ m`, `m = ∂U/∂θ`, where `T⁻ᵀ m = m + ½ θ×m + c θ×(θ×m)` is the transposed inverse
//! of the tangent map of the rotation vector (e.g. Cardona and Géradin, IJNME 26 (1988) 2403). Both bodies feel the
//! force at the *same* point `p_B`, so momentum and angular momentum are conserved to round-off.

use super::math::{self, M3, Q, V3};

/// A joint in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stance {
    /// The joint axes carried by the first body (joint to global).
    pub frame: M3,
    /// From the centres of mass to the joint point of the second body \[m\].
    pub arms: [V3; 2],
    /// From the first body's joint point to the second's, along the joint axes \[m\].
    pub gap: V3,
    /// Rotation of the second body's joint axes against the first's, on the branch of the last evaluation.
    pub turn: Q,
}

/// Where a joint is, for positions and orientations (twice) of its bodies, its points and axes in them, and the rotation of the last evaluation.
#[inline(always)]
pub(super) fn stance([a, b]: [(V3, Q, &M3); 2], points: [V3; 2], frames: [Q; 2], last: Q) -> Stance {
    let frame_q = math::qmul(a.1, frames[0]);
    let frame = math::qmat(frame_q);
    let arm_b = math::mul(b.2, points[1]);
    let arm_a = math::add(math::sub(b.0, a.0), arm_b);
    let gap = math::mul_t(&frame, math::sub(arm_a, math::mul(a.2, points[0])));
    let q = math::qmul(math::qconj(frame_q), math::qmul(b.1, frames[1]));
    let same = q[0] * last[0] + q[1] * last[1] + q[2] * last[2] + q[3] * last[3];
    let sign = if same < 0.0 { -1.0 } else { 1.0 };
    let turn = [sign * q[0], sign * q[1], sign * q[2], sign * q[3]];
    Stance { frame, arms: [arm_a, arm_b], gap, turn }
}

/// Rotation vector of the joint and [`math::tangent_coefficient`], for any angle.
#[inline(always)]
pub(super) fn bend(turn: Q) -> (V3, f64) {
    bend_by(math::qlog_factor(turn), turn)
}

/// The same with [`math::qlog_factor`].
#[inline(always)]
pub(super) fn bend_by(factor: f64, turn: Q) -> (V3, f64) {
    let theta = math::scale(factor, [turn[1], turn[2], turn[3]]);
    (theta, math::tangent_coefficient(math::dot(theta, theta), factor, turn[0]))
}

/// Force on the first body and torques on both about their centres of mass (the second one feels the opposite), from force and moment along the joint axes; `c` is
/// [`math::tangent_coefficient`] of the rotation vector.
#[inline(always)]
pub(super) fn loads(frame: &M3, arms: [V3; 2], theta: V3, local: V3, moment: V3, c: f64) -> [V3; 3] {
    let torque = torque(frame, theta, moment, c);
    let force = math::mul(frame, local);
    let (turn_a, turn_b) = (math::cross(arms[0], force), math::cross(arms[1], force));
    [force, math::add(turn_a, torque), math::add(turn_b, torque)]
}

/// The torque of a moment along the joint axes that is conjugate to the rotation vector.
#[inline(always)]
pub(super) fn torque(frame: &M3, theta: V3, moment: V3, c: f64) -> V3 {
    let once = math::cross(theta, moment);
    let twice = math::cross(theta, once);
    math::mul(frame, math::axpy(math::axpy(moment, 0.5, once), c, twice))
}
