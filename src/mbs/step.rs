//! The explicit integrator: leapfrog in position and momentum, orientation and angular momentum.
//!
//! Positions live at full steps, momenta half a step behind:
//! `p += ½(h₋+h) f`, `x += h p/m`; `L += ½(h₋+h) τ`, `q := q ⊗ exp(h ω_b)` with the midpoint angular velocity
//! `ω_b = I⁻¹ exp(-½h ω_b) (Rᵀ L)` in the body frame, found by fixed-point iteration from the last step's value (a
//! contraction with factor of order `hω`). One force evaluation per step, second order, time-reversible but for the
//! fixed-point residual; the angular momentum changes by torques only (Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, 2nd ed., VII.5; Krysl and Endres, IJNME 62 (2005) 2154).

use super::contact::{ContactSet, Moving, TooDeep};
use super::math::{self, V3};
use super::system::{BodyData, BodyState, System};

/// Fixed-point iterations for the midpoint angular velocity.
const ITERATIONS: usize = 2;

/// Kicks all momenta by `kick_s`: velocities become those of a coming step of `h_s` \[s\].
#[inline]
pub fn kick(system: &mut System, kick_s: f64, h_s: f64) {
    let n = system.count();
    for (body, data) in system.bodies[..n].iter_mut().zip(&system.data) {
        if data.alive && !data.asleep {
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

/// Whether nothing can touch in a drift of `h` \[s\].
#[inline]
pub fn is_quiet(system: &System, contacts: &mut ContactSet, h: f64) -> bool {
    contacts.quiet(h, system.bodies[..system.count()].iter().map(|b| (b.v, b.w)))
}

/// Contact impulses between kick and drift, for a step of `h` \[s\]; `moving` is working memory. Returns the work of the forces on the displacements that
/// open gaps \[J\].
///
/// # Errors
/// If bodies are in each other.
pub fn meet(
    system: &mut System,
    contacts: &mut ContactSet,
    moving: &mut Vec<Moving>,
    h: f64,
) -> Result<f64, TooDeep> {
    let n = system.count();
    let half = 0.5 * h;
    moving.clear();
    moving.extend(system.bodies[..n].iter().zip(&system.data).map(|(body, data)| {
        let inverse = math::matmul(&math::matmul(&body.r, &data.inverse_inertia), &math::transpose(&body.r));
        Moving {
            x: body.x,
            q: body.q,
            r: body.r,
            v: body.v,
            w: body.w,
            kick_v: math::scale(half * data.inverse_mass, body.force),
            kick_w: math::scale(half, math::mul(&inverse, body.torque)),
            inverse_mass: data.inverse_mass,
            inverse_inertia: inverse,
            alive: data.alive,
            shift: [0.0; 3],
            turn: [0.0; 3],
        }
    }));
    contacts.solve(moving, h)?;
    if !contacts.touched.is_empty() {
        return Ok(0.0);
    }
    let mut work = 0.0;
    for ((body, data), moving) in system.bodies.iter_mut().zip(&system.data).zip(moving.iter()) {
        if moving.v != body.v || moving.w != body.w {
            let change = math::mul_t(&body.r, math::sub(moving.w, body.w));
            body.p = math::axpy(body.p, data.mass, math::sub(moving.v, body.v));
            body.l = math::add(body.l, math::mul(&body.r, math::mul(&data.inertia, change)));
            find_velocities(body, data, h);
        }
        if moving.shift != [0.0; 3] || moving.turn != [0.0; 3] {
            work += math::dot(body.force, moving.shift) + math::dot(body.torque, moving.turn);
            body.x = math::add(body.x, moving.shift);
            body.rotate(moving.turn);
        }
    }
    Ok(work)
}

/// Drifts all positions by `h_s` \[s\].
#[inline]
pub fn drift(system: &mut System, h_s: f64) {
    let n = system.count();
    for (body, data) in system.bodies[..n].iter_mut().zip(&system.data) {
        if data.alive && !data.asleep {
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
            1.0 - r2 * (1.0 / 6.0 - r2 * (1.0 / 120.0 - r2 * (1.0 / 5040.0 - r2 * (1.0 / 362_880.0)))),
            0.5 - r2 * (1.0 / 24.0 - r2 * (1.0 / 720.0 - r2 * (1.0 / 40320.0 - r2 * (1.0 / 3_628_800.0)))),
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

/// Kinetic energy with the velocities of the step \[J\].
pub fn step_energy_j(body: &BodyState, data: &BodyData) -> f64 {
    0.5 * data.mass * math::dot(body.v, body.v)
        + 0.5 * math::dot(body.w_body, math::mul(&data.inertia, body.w_body))
}

/// Stops a body and puts it to sleep; its forces stay.
pub fn lay_down(system: &mut System, i: usize) {
    let body = &mut system.bodies[i];
    (body.p, body.l, body.v, body.w, body.w_body) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
    system.data[i].asleep = true;
}

/// Gives a body the momenta of its forces over a time \[s\].
pub fn push(body: &mut BodyState, time_s: f64) {
    body.p = math::axpy(body.p, time_s, body.force);
    body.l = math::axpy(body.l, time_s, body.torque);
}

/// Kinetic energy at the full step \[J\].
pub fn kinetic_j(body: &BodyState, data: &BodyData, half_s: f64) -> f64 {
    let (p, l) = synchronised(body, half_s);
    let l_body = math::mul_t(&body.r, l);
    0.5 * data.inverse_mass * math::dot(p, p)
        + 0.5 * math::dot(l_body, math::mul(&data.inverse_inertia, l_body))
}
