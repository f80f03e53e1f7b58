//! Kinematics of a compliant joint: gap, rotation vector, and what force and moment do to its bodies.
//!
//! Let `J` be the joint frame carried by body B, the member, `g = p_B - p_A` the gap of the joint point and
//! `θ = log(R)`, `R = R_Aᵀ R_B`, the rotation vector, which has the same components in the axes of either body. With `d = Jᵀ g` and an energy `U(d, θ)` the force is `F = J ∂U/∂d` and the torque
//! `τ = J T⁻¹ m`, `m = ∂U/∂θ`, where `T⁻¹ m = m - ½ θ×m + c θ×(θ×m)` is the inverse
//! of the tangent map of the rotation vector (e.g. Cardona and Géradin, IJNME 26 (1988) 2403). Both bodies feel the
//! force at the *same* point `p_A`, so momentum and angular momentum are conserved to round-off.
//!
//! A beam of length `2 l` with hinges at its ends has its axial spring between these, in `p_A - l Rᵀ e` and `p_B + l e` (`e`: along axis 0, towards B): what that is stretched by is `|c| - 2 l`, `c = l (e + Rᵀ e) + d`, and its force acts along `c`
//! in `p_A - l Rᵀ e`. So ends that move across by `v` pull on each other with `N v / 2 l` (catenary action), and a body that turns about a hinge neither stretches nor presses its beam.

use super::math::{self, M3, Q, V3};

/// A joint in space.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stance {
    /// The joint axes carried by the second body (joint to global).
    pub frame: M3,
    /// From the centres of mass to the joint point of the first body \[m\].
    pub arms: [V3; 2],
    /// From the first body's joint point to the second's, along the joint axes \[m\].
    pub gap: V3,
    /// Rotation of the second body's joint axes against the first's, on the branch of the last evaluation.
    pub turn: Q,
}

/// Where a joint is, for positions and orientations (twice) of its bodies, its points and axes in them, and the rotation of the last evaluation.
#[inline(always)]
pub(super) fn stance([a, b]: [(V3, Q, &M3); 2], points: [V3; 2], frames: [Q; 2], last: Q) -> Stance {
    let frame_q = math::qmul(b.1, frames[1]);
    let frame = math::qmat(frame_q);
    let arm_a = math::mul(a.2, points[0]);
    let arm_b = math::add(math::sub(a.0, b.0), arm_a);
    let gap = math::mul_t(&frame, math::sub(math::mul(b.2, points[1]), arm_b));
    let q = math::qmul(math::qconj(math::qmul(a.1, frames[0])), frame_q);
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

/// Where the axial force of a joint acts, along its axes: axis 0 through the joint point of the first body, or the line between the hinges of a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Chord {
    /// What its spring is stretched by, in the sense of the gap along axis 0 \[m\].
    pub stretch: f64,
    /// Direction, in the sense of axis 0.
    pub axis: V3,
    /// From the joint point of the first body to a point of it \[m\].
    pub arm: V3,
}

impl Chord {
    /// Of a joint that is no beam: what a gap tells.
    pub const fn along_axis(gap: V3) -> Self {
        Self { stretch: gap[0], axis: [1.0, 0.0, 0.0], arm: [0.0; 3] }
    }

    /// For the gap and rotation of a joint, and half the length of a beam with the sense from A to B along axis 0 and the length at which it is free of force; zero: it is no beam.
    #[inline(always)]
    pub fn new(gap: V3, turn: Q, reach_m: f64, free_m: f64) -> Self {
        let [w, x, y, z] = turn;
        let turned = [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)];
        let arm = math::scale(-reach_m, turned);
        let line = math::sub([reach_m + gap[0], gap[1], gap[2]], arm);
        let length = math::norm(line);
        let is_beam = reach_m != 0.0;
        let sense = 1.0_f64.copysign(reach_m);
        let (along, inverse) = (sense * (length - free_m), sense / length);
        Self {
            stretch: if is_beam { along } else { gap[0] },
            axis: if is_beam { math::scale(inverse, line) } else { [1.0, 0.0, 0.0] },
            arm,
        }
    }

    /// Force and couple along the joint axes, of an axial force and forces across \[N\].
    #[inline(always)]
    pub fn force(&self, local: V3) -> [V3; 2] {
        let axial = math::scale(local[0], self.axis);
        [[axial[0], axial[1] + local[1], axial[2] + local[2]], math::cross(self.arm, axial)]
    }
}

/// Force on the first body and torques on both about their centres of mass (the second one feels the opposite), from force, moment and couple along the joint axes; `c` is
/// [`math::tangent_coefficient`] of the rotation vector, to which the moment is conjugate.
#[inline(always)]
pub(super) fn loads(
    frame: &M3,
    arms: [V3; 2],
    theta: V3,
    [local, couple]: [V3; 2],
    moment: V3,
    c: f64,
) -> [V3; 3] {
    let torque = math::add(torque(frame, theta, moment, c), math::mul(frame, couple));
    let force = math::mul(frame, local);
    let (turn_a, turn_b) = (math::cross(arms[0], force), math::cross(arms[1], force));
    [force, math::add(turn_a, torque), math::add(turn_b, torque)]
}

/// The torque of a moment along the joint axes that is conjugate to the rotation vector.
#[inline(always)]
pub(super) fn torque(frame: &M3, theta: V3, moment: V3, c: f64) -> V3 {
    let once = math::cross(theta, moment);
    let twice = math::cross(theta, once);
    math::mul(frame, math::axpy(math::axpy(moment, -0.5, once), c, twice))
}
