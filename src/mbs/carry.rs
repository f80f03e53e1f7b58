//! Carry-over of moments between the ends of a member that bends between two bushings.
//!
//! A rigid member with a rotation spring `6 E I / L` at either end is the beam in sway, where both ends bear the same moment. In pure bending it is three times too stiff, since
//! the ends of a beam carry over half of their moment to each other. With a flexibility `d` between the ends
//!
//! ```text
//! θ₁ = M₁ / k₁ + d (M₁ - M₂),    θ₂ = M₂ / k₂ - d (M₁ - M₂)
//! ```
//!
//! (rotations against the chord and moments in the same sense) sway is as it was, and with `d = L / (6 E I)` the matrix is that of the beam, `L / (6 E I) [2 -1; -1 2]`
//! (Przemieniecki, Theory of Matrix Structural Analysis, 1968, eq. 5.116). The hinges at the ends follow their law for what is left of their rotation after the
//! lean `q = d (M₁ - M₂)`, the rotation that the other end has carried over.
//!
//! When an end opens, the other one keeps the lean that it has: a kink of the size of elastic rotations.
//!
//! Each end is evaluated for itself, eight at a time, under a lean that is extrapolated from those that fitted the moments of the two steps before. Where both ends turn out to be elastic, the lean that fits their moments is known in closed form, and they are corrected to it
//! ([`CarryOver::go_on`]): the forces of the step are those of the beam. Where one of them flows, both keep the extrapolated lean: second order in the step for moments that are smooth in time, with a little energy taken from vibrations near the limit of stability. It shows in the energy balance.

use super::joint::JointData;
use super::math;
use super::model::Bushing;
use super::system::{BodyData, BodyState};
use std::collections::BTreeMap;

/// Two joints at the ends of a member.
#[derive(Debug, Clone)]
pub struct CarryOver {
    /// The joints, whose second body is the member.
    pub joints: [usize; 2],
    /// Flexibility about the bending axes \[rad/(N m)\].
    flexibility: [f64; 2],
    /// Whether the bending axes of the second joint have the sense of those of the first, 1, or the opposite one, -1.
    sense: [f64; 2],
    /// The leans that fitted the last moments \[rad\].
    fitted: [f64; 2],
    /// The leans under which the present forces were found \[rad\].
    present: [f64; 2],
}

impl CarryOver {
    /// Those of some bushings and of their joints. Where the member is no longer one body, its ends keep the leans that they have.
    pub fn all(bushings: &[Bushing], joints: &[JointData]) -> Vec<Self> {
        if bushings.iter().all(|b| b.carry_over.is_none()) {
            return Vec::new();
        }
        let index: BTreeMap<&str, usize> =
            bushings.iter().enumerate().map(|(i, b)| (b.id.as_str(), i)).collect();
        let of = |(second, bushing): (usize, &Bushing)| {
            let carry = bushing.carry_over.as_ref()?;
            let first = *index.get(carry.bushing.as_str())?;
            let sense = [1, 2].map(|k| math::dot(bushing.axes[k], bushings[first].axes[k]).signum());
            let is_one = joints[first].b == joints[second].b;
            is_one.then_some(Self {
                joints: [first, second],
                flexibility: carry.flexibility_rad_nm,
                sense,
                fitted: [0.0; 2],
                present: [0.0; 2],
            })
        };
        bushings.iter().enumerate().filter_map(of).collect()
    }

    /// Whether both joints are intact and the member is not at rest.
    fn is_live(&self, joints: &[JointData], data: &[BodyData]) -> bool {
        let [first, second] = self.joints.map(|i| &joints[i]);
        first.alive && second.alive && !data[first.b].asleep
    }

    /// The leans that fit the present moments, by the elastic stiffness of both ends.
    fn fit(&self, joints: &[JointData]) -> [f64; 2] {
        let [first, second] = self.joints.map(|i| &joints[i]);
        std::array::from_fn(|k| {
            let d = self.flexibility[k];
            let moments = first.hinge.moment_nm[k] - self.sense[k] * second.hinge.moment_nm[k];
            let stiffness = first.rotation[k + 1] + second.rotation[k + 1];
            first.lean[k] + (d * moments - first.lean[k]) / (1.0 + d * stiffness)
        })
    }

    fn set(&self, joints: &mut [JointData], leans: [f64; 2]) {
        for k in 0..2 {
            joints[self.joints[0]].lean[k] = leans[k];
            joints[self.joints[1]].lean[k] = -self.sense[k] * leans[k];
        }
    }

    /// Takes over the leans that fit the present moments, in equilibrium. Returns the largest moment that they change \[N m\].
    pub fn settle(&mut self, joints: &mut [JointData]) -> f64 {
        let leans = self.fit(joints);
        let [first, second] = self.joints.map(|i| joints[i].rotation);
        let change =
            |k: usize| (leans[k] - joints[self.joints[0]].lean[k]).abs() * first[k + 1].max(second[k + 1]);
        let largest = change(0).max(change(1));
        (self.fitted, self.present) = (leans, leans);
        self.set(joints, leans);
        largest
    }

    /// Goes on from the leans that its joints have.
    pub fn resume(&mut self, joints: &[JointData]) {
        let lean = joints[self.joints[0]].lean;
        (self.fitted, self.present) = (lean, lean);
    }

    /// After the forces of a step: corrects them to the leans that fit the moments if both ends are elastic with these, and finds the leans of the next step. `is_elastic` tells this of a joint with moments about its bending axes \[N m\]. Returns whether
    /// there are new leans.
    #[inline]
    pub fn go_on(
        &mut self,
        joints: &mut [JointData],
        bodies: &mut [BodyState],
        data: &[BodyData],
        is_elastic: impl Fn(usize, &JointData, [f64; 2]) -> bool,
    ) -> bool {
        self.present = joints[self.joints[0]].lean;
        if !self.is_live(joints, data) {
            return false;
        }
        let leans = self.fit(joints);
        let change: [f64; 2] = std::array::from_fn(|k| self.present[k] - leans[k]);
        let more = |joint: &JointData, sign: [f64; 2]| -> [f64; 2] {
            std::array::from_fn(|k| joint.rotation[k + 1] * sign[k] * change[k])
        };
        let of = |i: usize, sign| {
            let (joint, more) = (&joints[i], more(&joints[i], sign));
            let moments = std::array::from_fn(|k| joint.hinge.moment_nm[k] + more[k]);
            is_elastic(i, joint, moments).then_some((i, more))
        };
        let [first, second] = self.joints;
        if let (Some(first), Some(second)) = (of(first, [1.0; 2]), of(second, self.sense.map(|s| -s))) {
            for (i, more) in [first, second] {
                joints[i].bend_more(more, bodies);
            }
            self.present = leans;
        }
        let next = std::array::from_fn(|k| 2.0 * leans[k] - self.fitted[k]);
        self.fitted = leans;
        self.set(joints, next);
        true
    }

    /// Whether either end still holds the member.
    pub fn is_held(&self, joints: &[JointData]) -> bool {
        self.joints.iter().any(|i| joints[*i].alive)
    }

    /// Elastic energy between the ends \[J\].
    pub fn elastic_j(&self) -> f64 {
        let of = |k: usize| 0.5 * self.present[k] * self.present[k] / self.flexibility[k];
        (0..2).filter(|k| self.flexibility[*k] != 0.0).map(of).sum()
    }

    /// What the flexibility about a bending axis changes in the elastic stiffness of both ends, for rotations about the axes of either joint \[N m/rad\].
    pub fn stiffness_change(&self, joints: &[JointData], k: usize) -> [[f64; 2]; 2] {
        let [k1, k2] = self.joints.map(|i| joints[i].rotation[k + 1]);
        let (d, s) = (self.flexibility[k], self.sense[k]);
        if k1 <= 0.0 || k2 <= 0.0 {
            return [[0.0; 2]; 2];
        }
        // inverse of [[1/k1 + d, -d], [-d, 1/k2 + d]], less diag(k1, k2)
        let f = d / (1.0 + d * (k1 + k2));
        [[-f * k1 * k1, s * f * k1 * k2], [s * f * k1 * k2, -f * k2 * k2]]
    }
}
