//! By how much one body is turned against another, by continuity: revolutions are counted from where the last step left them.
//!
//! A spring or hinge stores energy over a measure of the turn, and its torque has to be conjugate to that measure, or it makes energy of turns about several axes. Of the
//! rotation vector `θ` the torque of moments `m` along it is `T⁻ᵀ m = m + ½ θ×m + c θ×(θ×m)` (`mbs/stance.rs`); of the turn about one axis `n` it is along
//! the gradient of that turn, `(n_a + n_b) / (1 + n_a · n_b)` for the axis as either body carries it.

use super::joint::Pose;
use crate::mbs::math::{
    LOG_NEAR, Q, V3, axpy, cross, dot, mul_t, norm, qlog_factor, scale, sub, tangent_coefficient,
};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Length of a rotation vector up to which the shortest one is the nearest to any that a step may lead to \[rad\].
const NEAR: f64 = 0.8;
/// Turn across the axis of the last step, half of its angle, below which a turn is about that axis alone: joints are kept to the error of a step \[rad\].
const ALONE: f64 = 1e-5;
/// What torque and moment may differ by where a turn is about one axis, as a share of the moment.
const SKEW: f64 = 0.01;
/// Square of the cosine of half the angle between the axes of both bodies from which a turn about them means little: 160°.
const OPPOSED: f64 = 0.03;

/// A turn about any axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    /// Rotation vector \[rad\].
    pub theta: V3,
    /// `c` of the torque.
    coefficient: f64,
}

impl Turn {
    /// Of a rotation, whose vector is the one nearest to `last`. The vector is smooth but for turns of full revolutions from which it was led about several axes.
    #[inline]
    pub fn near(q: Q, last: V3) -> Self {
        let q = if q[0] < 0.0 { q.map(|v| -v) } else { q };
        let v = [q[1], q[2], q[3]];
        if q[0] > LOG_NEAR && dot(last, last) < NEAR * NEAR {
            let factor = qlog_factor(q);
            let theta = scale(factor, v);
            return Self { theta, coefficient: tangent_coefficient(dot(theta, theta), factor, q[0]) };
        }
        Self::counted(q[0], v, last)
    }

    /// The same with any number of revolutions.
    #[cold]
    fn counted(w: f64, v: V3, last: V3) -> Self {
        let (sine, before) = (norm(v), norm(last));
        if sine < ALONE && before > PI {
            // no axis of its own
            let axis = scale(1.0 / before, last);
            let angle = nearest(2.0 * libm::atan2(dot(v, axis), w), before);
            return Self { theta: scale(angle, axis), coefficient: 0.0 };
        }
        if sine < f64::MIN_POSITIVE {
            return Self { theta: [0.0; 3], coefficient: 1.0 / 12.0 };
        }
        let axis = scale(1.0 / sine, v);
        let angle = nearest(2.0 * libm::atan2(sine, w), dot(last, axis));
        // of the quaternion that belongs to this number of revolutions
        let factor = angle / sine;
        Self { theta: scale(angle, axis), coefficient: tangent_coefficient(angle * angle, factor, w) }
    }

    /// The torque that is conjugate to the rotation vector, of moments along it \[N m\].
    #[inline]
    pub fn torque(&self, moment: V3) -> V3 {
        axpy(moment, 1.0, self.excess(moment))
    }

    /// Rate of the rotation vector of the second of two bodies against the first, `T⁻¹ ω` \[rad/s\]; `T` of the opposite turn is its transpose.
    pub fn rate(&self, [first, second]: [&Pose; 2]) -> V3 {
        let w = mul_t(&first.r, sub(second.w, first.w));
        Self { theta: scale(-1.0, self.theta), ..*self }.torque(w)
    }

    /// What the torque has beyond the moments.
    #[inline]
    fn excess(&self, moment: V3) -> V3 {
        let once = cross(self.theta, moment);
        axpy(scale(0.5, once), self.coefficient, cross(self.theta, once))
    }

    /// The vector of the same rotation that is to be gone on with after a step from `last`, where this one cannot: within a quarter turn of full revolutions that it comes to
    /// about several axes, near which the torque of moments across it grows without bound.
    pub fn anew(&self, last: V3, moment: V3) -> Option<V3> {
        let length = norm(self.theta);
        let full = TAU * (length / TAU).round();
        let off = length - full;
        if full == 0.0 || off.abs() >= FRAC_PI_2 {
            return None;
        }
        let across = norm(cross(self.theta, last)) / (length * norm(last)).max(f64::MIN_POSITIVE);
        let skew = norm(self.excess(moment)) > SKEW * norm(moment);
        (skew && across * off.abs() > 2.0 * ALONE).then(|| scale(off / length, self.theta))
    }
}

/// A turn about one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Twist {
    /// Angle \[rad\].
    pub angle: f64,
    /// Its gradient: what a unit of its moment is as a torque.
    pub gradient: V3,
    /// Square of the cosine of half the angle between the axes of both bodies.
    cosine2: f64,
}

impl Twist {
    /// Of a rotation about a unit axis: that which is left of the rotation after the shortest one that turns the axis to where it is; the angle nearest to `last`.
    pub fn near(q: Q, axis: V3, last: f64) -> Self {
        let (w, v) = (q[0], [q[1], q[2], q[3]]);
        let along = dot(v, axis);
        let cosine2 = (w * w + along * along).max(f64::MIN_POSITIVE);
        let both = axpy(axpy(scale(w * w, axis), w, cross(v, axis)), along, v);
        let angle = nearest(2.0 * libm::atan2(along, w), last);
        Self { angle, gradient: scale(1.0 / cosine2, both), cosine2 }
    }

    /// Whether the axes point against each other, or nearly: there is no turn about them then.
    pub fn is_lost(&self) -> bool {
        self.cosine2 < OPPOSED
    }
}

/// A rotation vector with the full revolutions that lead it nearest to another one.
pub fn follow(theta: V3, last: V3) -> V3 {
    let (length, before) = (norm(theta), norm(last));
    if length < ALONE && before > PI {
        let axis = scale(1.0 / before, last);
        return scale(nearest(dot(theta, axis), before), axis);
    }
    let axis = scale(1.0 / length.max(f64::MIN_POSITIVE), theta);
    scale(nearest(length, dot(last, axis)), axis)
}

/// An angle plus the full revolutions that lead it nearest to another one.
fn nearest(angle: f64, last: f64) -> f64 {
    angle + TAU * ((last - angle) / TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::math::{qexp, qmul};

    /// What a small turn `by` of a body makes of the numbers of a rotation, per its length.
    fn slope(q: Q, by: V3, of: impl Fn(Q) -> f64) -> f64 {
        let step = 1e-5;
        let at = |s: f64| of(qmul(qexp(scale(s, by)), q));
        (at(step) - at(-step)) / (2.0 * step)
    }

    const BY: V3 = [0.3, -0.7, 0.5];

    #[test]
    fn torques_are_conjugate_to_the_rotation_vector_at_any_number_of_revolutions() {
        let moment = [0.8, -0.2, 1.1];
        for angle in [1e-9, 0.1, 0.5, 2.0, 3.0, 3.3, 5.0, 8.0, 11.0, 14.0] {
            for sense in [1.0, -1.0] {
                let theta = scale(sense * angle / 7.0, [2.0, -3.0, 6.0]);
                let (q, near) = (qexp(theta), scale(0.98, theta));
                let turn = Turn::near(q, near);
                assert!(norm(sub(turn.theta, theta)) < 1e-13 * (1.0 + angle), "{angle} {:?}", turn.theta);
                let power = dot(turn.torque(moment), BY);
                let slope = slope(q, BY, |q| dot(moment, Turn::near(q, near).theta));
                assert!((power - slope).abs() < 1e-7 * (1.0 + slope.abs()), "{angle}: {power} {slope}");
            }
        }
    }

    #[test]
    fn revolutions_about_one_axis_are_counted_both_ways() {
        let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0];
        let (mut held, mut twist) = ([0.0; 3], 0.0);
        // also through full revolutions themselves, where the quaternion has no axis
        let way = (0..400).map(|i| 0.125 * PI * f64::from(if i < 250 { i } else { 500 - i }));
        for angle in way {
            let q = qexp(scale(angle % TAU, axis));
            let moment = scale(3.0, axis);
            let turn = Turn::near(q, held);
            assert!(norm(sub(turn.theta, scale(angle, axis))) < 1e-8, "{angle}: {:?}", turn.theta);
            assert!(norm(sub(turn.torque(moment), moment)) < 1e-6 && turn.anew(held, moment).is_none());
            let found = Twist::near(q, axis, twist);
            assert!((found.angle - angle).abs() < 1e-12 && norm(sub(found.gradient, axis)) < 1e-14);
            (held, twist) = (turn.theta, found.angle);
        }
    }

    #[test]
    fn near_full_revolutions_a_turn_about_several_axes_is_taken_anew() {
        let (held, theta) = ([0.1, 5.0, 0.2], [0.1, 5.2, 0.25]);
        let turn = Turn::near(qexp(theta), held);
        assert!(norm(sub(turn.theta, theta)) < 1e-13);
        let anew = turn.anew(held, [0.5, 1.0, 0.0]).unwrap();
        let same = Turn::near(qexp(theta), anew);
        assert!(norm(anew) < FRAC_PI_2 && norm(sub(same.theta, anew)) < 1e-13);
        // without moments nothing is lost, and far from full revolutions there is no need to
        assert_eq!(turn.anew(held, [0.0; 3]), None);
        let far = Turn::near(qexp([0.1, 4.0, 0.3]), [0.1, 3.9, 0.2]);
        assert_eq!(far.anew([0.1, 3.9, 0.2], [0.5, 1.0, 0.0]), None);
    }

    #[test]
    fn a_twist_is_the_turn_about_the_first_axis_of_a_universal_joint() {
        let axis = [0.0, 0.0, 1.0];
        for (first, second) in [(0.7, 0.4), (-2.0, 1.3), (9.0, -2.0)] {
            let q = qmul(qexp([0.0, 0.0, first]), qexp([second, 0.0, 0.0]));
            let twist = Twist::near(q, axis, first + 0.1);
            assert!((twist.angle - first).abs() < 1e-14 * 10.0 && !twist.is_lost());
            let slope = slope(q, BY, |q| Twist::near(q, axis, first).angle);
            assert!((dot(twist.gradient, BY) - slope).abs() < 1e-8, "{slope}");
        }
        let opposed = qmul(qexp([0.0, 0.0, 0.3]), qexp([3.0, 0.0, 0.0]));
        assert!(Twist::near(opposed, axis, 0.0).is_lost());
    }
}
