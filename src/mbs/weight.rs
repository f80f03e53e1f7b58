//! How much of its weight a span bears: all of it where it is held up, none in free fall.
//!
//! A piece of a floor that falls freely has no weight for its beams to bear ([`crate::curve::beam`]). The share follows from how fast its floor gains speed along gravity where the span is, smoothed over
//! [`SMOOTHED_S`] so that impacts do not count, and is one up to half of free fall: what stands and swings bears its weight in every step, with a potential.
//!
//! Bodies that share the inertia of their span ([`super::shared_mass`]) resist a uniform acceleration with the same moments that its weight has, so that nothing bends in free fall: the span bears all of its weight there as
//! well. Less of it would leave these moments without a counterpart.
//!
//! A floor is what spans connect, and what counts of it is the acceleration of the rigid body that has its momentum and angular momentum. Vibrations of its pieces against each other change neither. With the
//! accelerations of the pieces themselves a floor in free fall drives its own vibrations, since the share follows them with a delay.

use super::joint::JointData;
use super::math::{self, M3, V3};
use super::system::{BodyData, BodyState};
use petgraph::unionfind::UnionFind;
use std::collections::BTreeMap;

/// Time over which accelerations are smoothed \[s\].
const SMOOTHED_S: f64 = 0.05;
/// Acceleration over gravity up to which all of the weight is borne.
const HELD: f64 = 0.5;

/// The floors whose spans have a weight.
#[derive(Debug, Clone, Default)]
pub(super) struct Weight {
    floors: Vec<Floor>,
}

/// Bodies that spans with a weight connect.
#[derive(Debug, Clone, Default)]
struct Floor {
    bodies: Vec<usize>,
    joints: Vec<usize>,
    /// Mass \[kg\], momentum \[kg m/s\] and angular momentum about the centre \[kg m²/s\] of the last step; none: it begins.
    last: Option<(f64, V3, V3)>,
}

impl Weight {
    /// Of all joints; what they bear is in them.
    pub fn new(joints: &[JointData], bodies: usize) -> Self {
        let is_loaded = |j: &JointData| j.alive && j.beam.as_ref().is_some_and(|b| b.is_loaded());
        let loaded: Vec<usize> = (0..joints.len()).filter(|i| is_loaded(&joints[*i])).collect();
        let mut together = UnionFind::new(bodies);
        let own = |i: usize| [joints[i].a, joints[i].b].into_iter().filter(move |b| *b < bodies);
        for i in &loaded {
            own(*i).reduce(|a, b| {
                together.union(a, b);
                b
            });
        }
        let mut floors: BTreeMap<usize, Floor> = BTreeMap::new();
        for i in loaded {
            let Some(any) = own(i).next() else { continue };
            let floor = floors.entry(together.find(any)).or_default();
            floor.joints.push(i);
            floor.bodies.extend(own(i));
        }
        for floor in floors.values_mut() {
            floor.bodies.sort_unstable();
            floor.bodies.dedup();
        }
        let floors = floors.into_values().collect();
        Self { floors }
    }

    /// After a step of `h` \[s\]: spans between bodies with consistent inertia bear all of their weight, others what their floor's acceleration leaves. `tell` hears of the joints whose share has changed.
    pub fn follow(
        &mut self,
        joints: &mut [JointData],
        bodies: &[BodyState],
        data: &[BodyData],
        (gravity, h): (V3, f64),
        is_consistent: impl Fn([usize; 2]) -> bool,
        mut tell: impl FnMut(usize, &JointData),
    ) {
        let g2 = math::dot(gravity, gravity);
        if self.floors.is_empty() || g2 == 0.0 {
            return;
        }
        let weight = (h / SMOOTHED_S).min(1.0);
        for floor in &mut self.floors {
            let Some(fall) = floor.fall(bodies, data, h) else { continue };
            for i in &floor.joints {
                let joint = &mut joints[*i];
                let place = math::scale(0.5, math::add(bodies[joint.a].x, bodies[joint.b].x));
                let Some(beam) = &mut joint.beam else { continue };
                beam.falls += weight * (math::dot(fall.at(place), gravity) / g2 - beam.falls);
                let held = ((1.0 - beam.falls) / (1.0 - HELD)).clamp(0.0, 1.0);
                let borne = if is_consistent([joint.a, joint.b]) { 1.0 } else { held };
                if borne != std::mem::replace(&mut beam.borne, borne) {
                    tell(*i, joint);
                }
            }
        }
    }
}

/// The acceleration of a rigid body.
struct Fall {
    centre: V3,
    acceleration: V3,
    turning: V3,
}

impl Fall {
    /// At a place \[m/s²\].
    fn at(&self, place: V3) -> V3 {
        math::add(self.acceleration, math::cross(self.turning, math::sub(place, self.centre)))
    }
}

impl Floor {
    /// How it fell in the last step of `h` \[s\]; nothing in its first.
    fn fall(&mut self, bodies: &[BodyState], data: &[BodyData], h: f64) -> Option<Fall> {
        let own = || self.bodies.iter().map(|i| (&bodies[*i], &data[*i])).filter(|(_, d)| d.alive);
        let (mut mass, mut moment, mut momentum) = (0.0, [0.0; 3], [0.0; 3]);
        for (body, data) in own() {
            mass += data.mass;
            moment = math::axpy(moment, data.mass, body.x);
            momentum = math::add(momentum, body.p);
        }
        let centre = math::scale(1.0 / mass, moment);
        let (mut inertia, mut spin): (M3, V3) = ([[0.0; 3]; 3], [0.0; 3]);
        for (body, data) in own() {
            let arm = math::sub(body.x, centre);
            spin = math::add(spin, math::add(body.l, math::cross(arm, body.p)));
            let own = math::turned(&body.r, &data.inertia);
            inertia = math::matadd(&inertia, &math::matadd(&own, &math::point_inertia(data.mass, arm)));
        }
        // where a body went, so did its momentum
        let (_, p, l) = self.last.replace((mass, momentum, spin)).filter(|(was, ..)| *was == mass)?;
        let rate = |now: V3, before: V3| math::scale(1.0 / h, math::sub(now, before));
        Some(Fall {
            centre,
            acceleration: math::scale(1.0 / mass, rate(momentum, p)),
            turning: math::mul(&math::inverse(&inertia), rate(spin, l)),
        })
    }
}
