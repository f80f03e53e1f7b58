//! How much of its weight a span bears: all of it where it is held up, none in free fall.
//!
//! A piece of a floor that falls freely has no weight for its beams to bear ([`crate::curve::beam`]). The share follows from how fast both bodies of a beam gain speed along gravity, smoothed over
//! [`SMOOTHED_S`] so that impacts and vibrations do not count, and is one up to half of free fall: what stands and swings bears its weight in every step, with a potential.

use super::joint::JointData;
use super::math::{self, V3};
use super::system::{BodyData, BodyState};

/// Time over which accelerations are smoothed \[s\].
const SMOOTHED_S: f64 = 0.05;
/// Acceleration over gravity up to which all of the weight is borne.
const HELD: f64 = 0.5;

/// What is known of the accelerations of all bodies.
#[derive(Debug, Clone, Default)]
pub(super) struct Weight {
    /// Joints with beams that their weight bends.
    joints: Vec<usize>,
    /// Momentum after the last step \[kg m/s\], and smoothed acceleration along gravity over it, of each body.
    bodies: Vec<(V3, f64)>,
}

impl Weight {
    /// Of bodies at rest, or that have moved steadily.
    pub fn new(joints: &[JointData], bodies: &[BodyState]) -> Self {
        let is_loaded = |j: &JointData| j.beam.as_ref().is_some_and(|b| b.is_loaded());
        Self {
            joints: (0..joints.len()).filter(|i| is_loaded(&joints[*i])).collect(),
            bodies: bodies.iter().map(|b| (b.p, 0.0)).collect(),
        }
    }

    /// After a step of `h` \[s\]; `tell` hears of the joints whose share has changed.
    pub fn follow(
        &mut self,
        joints: &mut [JointData],
        bodies: &[BodyState],
        data: &[BodyData],
        (gravity, h): (V3, f64),
        mut tell: impl FnMut(usize, &JointData),
    ) {
        let g2 = math::dot(gravity, gravity);
        if self.joints.is_empty() || g2 == 0.0 {
            return;
        }
        let weight = (h / SMOOTHED_S).min(1.0);
        for ((last, falls), (body, data)) in self.bodies.iter_mut().zip(bodies.iter().zip(data)) {
            let gained = math::dot(math::sub(body.p, *last), gravity) * data.inverse_mass / (h * g2);
            *falls += weight * (gained - *falls);
            *last = body.p;
        }
        for i in &self.joints {
            let joint = &mut joints[*i];
            let falls = 0.5 * (self.bodies[joint.a].1 + self.bodies[joint.b].1);
            let Some(beam) = &mut joint.beam else { continue };
            let borne = ((1.0 - falls) / (1.0 - HELD)).clamp(0.0, 1.0);
            if borne != std::mem::replace(&mut beam.borne, borne) {
                tell(*i, joint);
            }
        }
    }
}
