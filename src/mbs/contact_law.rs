//! The contact law of one point.
//!
//! **Normal**: a spring whose force rises above or falls below its elastic part with the sign of the
//! approach speed `v`: `f = k δ (a + b sat(v/v₀))`, `a = (1+e²)/2`, `b = (1-e²)/2`. Well above `v₀` loading
//! follows `kδ` and unloading `e²kδ`, so that the energy returned is `e²` of that received, whatever the speed; below
//! `v₀` it is a Hunt-Crossley damper (J. Appl. Mech. 42 (1975) 440) and bodies come to rest. `v₀` grows with the
//! penetration where the lagged velocity would make the damper unstable. The force never pulls. An impact is
//! resolved by about seven steps whatever their length, so the restitution met is somewhat above the one asked for when
//! that is low: a dropped cube returns with 0.26 for 0.1, 0.52 for 0.5 (`tests/mbs/contact.rs`).
//!
//! **Tangential**: an elastic slider `s` with `|k_t s| <= μ f` (Cundall and Strack, Géotechnique 29 (1979) 47)
//! and a small damper inside the same cone.
//!
//! **Stiffness**: `k = KAPPA / (h² w)` per point, `w` the inverse effective mass of the worst corner, so that the
//! step limit holds whatever the step; four points stop a body from 10 m/s within one to two centimetres
//! at steps of half a millisecond.

use super::math::{self, V3};

/// `k h² w` of one contact point.
const KAPPA: f64 = 0.2;
/// Tangential stiffness relative to the normal one.
const TANGENTIAL: f64 = 0.5;
/// `c_t h w` of the tangential damper.
const TANGENTIAL_DAMPING: f64 = 0.1;
/// Approach speed from which restitution is full \[m/s\].
const SATURATION_SPEED_M_S: f64 = 0.02;
/// Largest `c h w` of the normal damper. The lagged velocity makes a single contact unstable above 2, and a
/// body between two contacts (a stack) above 1.
const DAMPER_LIMIT: f64 = 0.7;

/// History of one contact point.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PointState {
    pub(super) slip: V3,
    pub(super) friction: V3,
    pub(super) depth: f64,
    pub(super) damping_force: f64,
    pub(super) elastic: f64,
    pub(super) offset: f64,
    pub(super) active: bool,
}

/// Energies of all contacts \[J\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactEnergy {
    /// Stored in normal springs and sliders.
    pub elastic_j: f64,
    /// Dissipated along the normals.
    pub damping_j: f64,
    /// Dissipated by friction.
    pub friction_j: f64,
    /// Booked when contact points of a pair are exchanged for others (numerical, either sign).
    pub exchange_j: f64,
}

/// Parameters of one contact point's law.
#[derive(Debug, Clone, Copy)]
pub(super) struct Law {
    k: f64,
    friction: f64,
    inverse_mass: f64,
    restitution: f64,
}

impl Law {
    /// The law of points whose two bodies have the given inverse effective mass \[1/kg\], for steps up to `step` \[s\].
    pub(super) fn new(inverse_mass: f64, friction: f64, restitution: f64, step: f64) -> Self {
        Self { k: KAPPA / (step * step * inverse_mass), friction, inverse_mass, restitution }
    }

    fn shares(&self) -> (f64, f64) {
        let e2 = self.restitution * self.restitution;
        (0.5 * (1.0 + e2), 0.5 * (1.0 - e2))
    }

    /// Energy of the normal spring \[J\].
    pub(super) fn elastic(&self, depth: f64) -> f64 {
        0.5 * self.k * self.shares().0 * depth * depth
    }

    /// Force on the body whose surface moves with `velocity` relative to the other one; `normal` points
    /// towards it. Trapezoidal bookkeeping of the energies.
    #[expect(clippy::too_many_arguments, reason = "a law of plain numbers in the hot loop")]
    #[inline]
    pub(super) fn force(
        &self,
        state: &mut PointState,
        depth: f64,
        normal: V3,
        velocity: V3,
        h: f64,
        step: f64,
        energy: &mut ContactEnergy,
    ) -> V3 {
        let depth = depth.max(0.0);
        let (a, b) = self.shares();
        let outward = math::dot(velocity, normal);
        let room = self.k * depth * b * step * self.inverse_mass / DAMPER_LIMIT;
        let damping = self.k * depth * b * (-outward / (SATURATION_SPEED_M_S + room)).clamp(-1.0, 1.0);
        let normal_force = self.k * depth * a + damping;
        energy.damping_j += 0.5 * (damping + state.damping_force) * (depth - state.depth);

        let kt = TANGENTIAL * self.k;
        let sliding = math::axpy(velocity, -outward, normal);
        let travelled = math::scale(h, sliding);
        let before = 0.5 * kt * math::dot(state.slip, state.slip);
        let mut slip = math::add(state.slip, travelled);
        slip = math::axpy(slip, -math::dot(slip, normal), normal);
        let limit = self.friction * normal_force;
        let trial = kt * math::norm(slip);
        if trial > limit {
            slip = math::scale(limit / trial, slip);
        }
        let ct = TANGENTIAL_DAMPING / (step * self.inverse_mass);
        let mut friction = math::axpy(math::scale(-kt, slip), -ct, sliding);
        let size = math::norm(friction);
        if size > limit {
            friction = math::scale(limit / size, friction);
        }
        let stored = 0.5 * kt * math::dot(slip, slip);
        let mean = math::scale(0.5, math::add(friction, state.friction));
        energy.friction_j += -math::dot(mean, travelled) - (stored - before);

        let elastic = self.elastic(depth) + stored;
        energy.elastic_j += elastic;
        *state = PointState {
            slip,
            friction,
            depth,
            damping_force: damping,
            elastic,
            offset: state.offset,
            active: depth > 0.0,
        };
        math::axpy(friction, normal_force, normal)
    }
}
