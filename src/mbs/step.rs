//! The explicit integrator: leapfrog in position and momentum, orientation and angular momentum.
//!
//! Positions live at full steps, momenta half a step behind:
//! `p += ½(h₋+h) f`, `x += h p/m`; `L += ½(h₋+h) τ`, `q := q ⊗ exp(h ω_b)` with the midpoint angular velocity
//! `ω_b = I⁻¹ exp(-½h ω_b) (Rᵀ L)` in the body frame, found by fixed-point iteration from the last step's value (a
//! contraction with factor of order `hω`). One force evaluation per step, second order, time-reversible but for the
//! fixed-point residual; the angular momentum changes by torques only (Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, 2nd ed., VII.5; Krysl and Endres, IJNME 62 (2005) 2154).

use super::math::{self, V3};
use super::system::{BodyData, BodyState, System};

/// Fixed-point iterations for the midpoint angular velocity.
const ITERATIONS: usize = 2;

/// Kicks all momenta by `kick_s`: velocities become those of a coming step of `h_s` \[s\].
#[inline]
pub fn kick(system: &mut System, kick_s: f64, h_s: f64) {
    let n = system.count();
    for (body, data) in system.bodies[..n].iter_mut().zip(&system.data) {
        if data.alive {
            body.p = math::axpy(body.p, kick_s, body.force);
            body.l = math::axpy(body.l, kick_s, body.torque);
            find_velocities(body, data, h_s);
        }
    }
}

/// Velocities of a step of `h` from the momenta in the middle of it.
#[inline]
pub fn find_velocities(body: &mut BodyState, data: &BodyData, h: f64) {
    body.v = math::scale(data.inverse_mass, body.p);
    let l_body = math::mul_t(&body.r, body.l);
    let mut w = body.w_body;
    for _ in 0..ITERATIONS {
        w = math::mul(&data.inverse_inertia, turn(math::scale(-0.5 * h, w), l_body));
    }
    body.w_body = w;
    // The angular velocity of the step is the same vector in the old, middle and new body frame.
    body.w = math::mul(&body.r, w);
}

/// Drifts all positions by `h_s` \[s\].
#[inline]
pub fn drift(system: &mut System, h_s: f64) {
    let n = system.count();
    for (body, data) in system.bodies[..n].iter_mut().zip(&system.data) {
        if data.alive {
            body.x = math::axpy(body.x, h_s, body.v);
            body.q = math::qrenormalise(math::qmul(body.q, math::qexp(math::scale(h_s, body.w_body))));
            body.r = math::qmat(body.q);
        }
    }
}

/// `exp([r]×) v` for a small rotation vector.
#[inline(always)]
fn turn(r: V3, v: V3) -> V3 {
    let r2 = math::dot(r, r);
    let (a, b) = if r2 < 0.01 {
        (
            1.0 - r2 / 6.0 * (1.0 - r2 / 20.0 * (1.0 - r2 / 42.0 * (1.0 - r2 / 72.0))),
            0.5 - r2 / 24.0 * (1.0 - r2 / 30.0 * (1.0 - r2 / 56.0 * (1.0 - r2 / 90.0))),
        )
    } else {
        let s = r2.sqrt();
        (s.sin() / s, (1.0 - s.cos()) / r2)
    };
    let once = math::cross(r, v);
    math::axpy(math::axpy(v, a, once), b, math::cross(r, once))
}

/// Momentum and angular momentum at the full step, half a step after the stored ones.
pub fn synchronised(body: &BodyState, half_s: f64) -> (V3, V3) {
    (math::axpy(body.p, half_s, body.force), math::axpy(body.l, half_s, body.torque))
}

/// Kinetic energy at the full step \[J\].
pub fn kinetic_j(body: &BodyState, data: &BodyData, half_s: f64) -> f64 {
    let (p, l) = synchronised(body, half_s);
    let l_body = math::mul_t(&body.r, l);
    0.5 * data.inverse_mass * math::dot(p, p)
        + 0.5 * math::dot(l_body, math::mul(&data.inverse_inertia, l_body))
}
