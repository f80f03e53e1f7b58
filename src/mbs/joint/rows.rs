//! The linearised kinematics of a compliant joint.

use super::JointData;
use crate::mbs::math::{self, M3, V3};
use crate::mbs::system::BodyState;

impl JointData {
    /// The six rows of the joint's linearised kinematics in the current pose (see [`Row`]).
    pub fn rows(&self, bodies: &[BodyState]) -> [Row; 6] {
        let at = self.stance(bodies);
        let axes: M3 = math::transpose(&at.frame);
        let [force, couple] = self.chord(&at).force([1.0, 0.0, 0.0]).map(|v| math::mul(&at.frame, v));
        std::array::from_fn(|i| {
            let (axis, couple) = if i == 0 { (force, couple) } else { (axes[i % 3], [0.0; 3]) };
            if i < 3 {
                let [turn_a, turn_b] = at.arms.map(|arm| math::add(math::cross(arm, axis), couple));
                Row { stiffness: self.translation[i], a: self.a, b: self.b, force: axis, turn_a, turn_b }
            } else {
                Row {
                    stiffness: self.rotation[i - 3],
                    a: self.a,
                    b: self.b,
                    force: [0.0; 3],
                    turn_a: axis,
                    turn_b: axis,
                }
            }
        })
    }

    /// Which of the springs of [`Self::rows`] flow: at their capacity a stretch changes their force no more.
    pub(in crate::mbs) fn flowing_rows(&self) -> [bool; 6] {
        let (stretches, slips, bends) = (self.is_stretching(), self.shear.course().is_some(), self.flowing);
        [stretches, slips, slips, false, bends, bends]
    }

    /// Whether its springs hold its point in height, in the present poses.
    pub(in crate::mbs) fn bears_weight(&self, bodies: &[BodyState]) -> bool {
        const LEVEL: f64 = 1e-9;
        self.rows(bodies)[..3].iter().any(|row| row.stiffness > 0.0 && row.force[2].abs() > LEVEL)
    }
}

/// One spring of a joint: its stretch is `force·(δx_b - δx_a) + turn_b·δφ_b - turn_a·δφ_a`.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Stiffness \[N/m\] or \[N m/rad\].
    pub stiffness: f64,
    /// First body.
    pub a: usize,
    /// Second body.
    pub b: usize,
    /// Direction of the force, zero for a rotational spring.
    pub force: V3,
    /// Moment arm on the first body.
    pub turn_a: V3,
    /// Moment arm on the second body.
    pub turn_b: V3,
}

impl Row {
    /// Its stretch by small motions of both bodies: displacement and rotation, or their rates.
    pub fn stretch(&self, [[va, wa], [vb, wb]]: [[V3; 2]; 2]) -> f64 {
        let force = math::dot(self.force, vb) - math::dot(self.force, va);
        force + math::dot(self.turn_b, wb) - math::dot(self.turn_a, wa)
    }
}
