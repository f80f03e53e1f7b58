//! The explicit integrator: leapfrog in position and momentum, orientation and angular momentum.
//!
//! Positions live at full steps, momenta half a step behind:
//! `p += ½(h₋+h) f`, `x += h p/m`; `L += ½(h₋+h) τ`, `q := q ⊗ exp(h ω_b)` with the midpoint angular velocity
//! `ω_b = I⁻¹ exp(-½h ω_b) (Rᵀ L)` in the body frame, found by fixed-point iteration from the last step's value (a
//! contraction with factor of order `hω`). One force evaluation per step, second order, time-reversible but for the
//! fixed-point residual; the angular momentum changes by torques only (Hairer, Lubich, Wanner, Geometric Numerical
//! Integration, 2nd ed., VII.5; Krysl and Endres, IJNME 62 (2005) 2154).

use super::contact::{ContactSet, Moving, TooDeep};
use super::lanes::{LANES, Lane, ZERO, get, get_matrix, put};
use super::math::{self, V3};
use super::system::{BodyData, BodyState, System};
use crate::base::isa::for_each_isa;

/// Fixed-point iterations for the midpoint angular velocity, and the most of them where a body turns fast.
const ITERATIONS: usize = 2;
const MOST_ITERATIONS: usize = 40;
/// Square of the angle of half a step from which iterations go on until the velocity holds: what they leave takes energy, about 0.05 of the third power of that angle in a step.
const FAST: f64 = 1e-5;
/// Change of an angular velocity in an iteration, over itself, with which it holds.
const HOLDS: f64 = 1e-15;

/// Inverse masses and inertias of eight bodies.
#[derive(Debug, Clone)]
pub(super) struct InverseBlock {
    mass: Lane,
    inertia: [[Lane; 3]; 3],
}

impl InverseBlock {
    /// Those of all bodies.
    pub fn all(data: &[BodyData]) -> Vec<Self> {
        let of = |own: &[BodyData]| {
            let mut block = Self { mass: ZERO, inertia: [[ZERO; 3]; 3] };
            for (l, data) in own.iter().enumerate() {
                block.mass[l] = data.inverse_mass;
                for i in 0..3 {
                    put(&mut block.inertia[i], l, data.inverse_inertia[i]);
                }
            }
            block
        };
        data.chunks(LANES).map(of).collect()
    }
}

/// Kicks all momenta by `kick_s`: velocities become those of a coming step of `h_s` \[s\].
#[inline]
pub fn kick(system: &mut System, kick_s: f64, h_s: f64) {
    let n = system.count();
    let System { isa, bodies, data, inverses, moved, .. } = system;
    kick_all(*isa, &mut bodies[..n], data, inverses, &mut moved.kick, kick_s, h_s);
}

for_each_isa! {
    fn kick_all = kick_any(
        bodies: &mut [BodyState],
        data: &[BodyData],
        inverses: &[InverseBlock],
        at: &mut Kick,
        kick_s: f64,
        h_s: f64,
    )
}

#[inline(always)]
fn kick_any(
    bodies: &mut [BodyState],
    data: &[BodyData],
    inverses: &[InverseBlock],
    at: &mut Kick,
    kick_s: f64,
    h_s: f64,
) {
    for ((bodies, data), inverse) in bodies.chunks_mut(LANES).zip(data.chunks(LANES)).zip(inverses) {
        for (l, body) in bodies.iter().enumerate() {
            put(&mut at.p, l, body.p);
            put(&mut at.l, l, body.l);
            put(&mut at.force, l, body.force);
            put(&mut at.torque, l, body.torque);
            put(&mut at.w_body, l, body.w_body);
            put(&mut at.q, l, body.q);
        }
        at.go(inverse, kick_s, h_s);
        for (l, (body, data)) in bodies.iter_mut().zip(data).enumerate() {
            if data.alive && !data.asleep {
                (body.p, body.l) = (get(&at.p, l), get(&at.l, l));
                if at.turn2[l] < FAST {
                    (body.v, body.w, body.w_body) = (get(&at.v, l), get(&at.w, l), get(&at.w_body, l));
                } else {
                    find_velocities(body, data, h_s);
                }
            }
        }
    }
}

/// Working memory of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Moved {
    kick: Kick,
    drift: Drift,
    see: See,
}

/// Eight bodies that are kicked.
#[derive(Debug, Clone, Default)]
struct Kick {
    p: [Lane; 3],
    l: [Lane; 3],
    force: [Lane; 3],
    torque: [Lane; 3],
    q: [Lane; 4],
    v: [Lane; 3],
    w: [Lane; 3],
    w_body: [Lane; 3],
    /// Square of the largest angle of half the step.
    turn2: Lane,
}

impl Kick {
    #[inline(always)]
    fn go(&mut self, inverse: &InverseBlock, kick_s: f64, h_s: f64) {
        for l in 0..LANES {
            let p = math::axpy(get(&self.p, l), kick_s, get(&self.force, l));
            let spin = math::axpy(get(&self.l, l), kick_s, get(&self.torque, l));
            let r = math::qmat(get(&self.q, l));
            let inertia = get_matrix(&inverse.inertia, l);
            let l_body = math::mul_t(&r, spin);
            let mut w = get(&self.w_body, l);
            let mut largest = 0.0_f64;
            for _ in 0..ITERATIONS {
                let half = math::scale(-0.5 * h_s, w);
                let r2 = math::dot(half, half);
                largest = if r2 > largest { r2 } else { largest };
                w = math::mul(&inertia, turn_by(half, l_body, turn_series(r2)));
            }
            self.turn2[l] = largest;
            put(&mut self.p, l, p);
            put(&mut self.l, l, spin);
            put(&mut self.v, l, math::scale(inverse.mass[l], p));
            put(&mut self.w_body, l, w);
            put(&mut self.w, l, math::mul(&r, w));
        }
    }
}

/// Velocities of a step of `h` from the momenta in the middle of it.
#[inline]
pub fn find_velocities(body: &mut BodyState, data: &BodyData, h: f64) {
    body.v = math::scale(data.inverse_mass, body.p);
    let l_body = math::mul_t(&body.r, body.l);
    let mut w = body.w_body;
    for i in 0..MOST_ITERATIONS {
        let half = math::scale(-0.5 * h, w);
        let next = math::mul(&data.inverse_inertia, turn(half, l_body));
        let change = math::sub(next, std::mem::replace(&mut w, next));
        let holds = math::dot(change, change) <= HOLDS * HOLDS * math::dot(w, w);
        if i + 1 >= ITERATIONS && (holds || math::dot(half, half) < FAST) {
            break;
        }
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

/// A body that contacts displaced, by how much \[m\], and its turn as a rotation vector \[rad\].
pub type Displaced = (usize, V3, V3);

/// Half of the work of the present forces on displacements \[J\]. The leapfrog balances `½ (f_n + f_n+1)` on the way of a velocity; a displacement without one has the same work, half of it by the forces before and half by those after the step.
pub fn half_work_j(system: &System, displaced: &[Displaced]) -> f64 {
    let of = |(i, shift, turn): &Displaced| {
        let body = &system.bodies[*i];
        math::dot(body.force, *shift) + math::dot(body.torque, *turn)
    };
    0.5 * displaced.iter().map(of).sum::<f64>()
}

/// Contact impulses between kick and drift, for a step of `h` \[s\]; `moving` is working memory. `displaced` are afterwards the bodies that contacts displaced. Returns [`half_work_j`] for them \[J\].
///
/// # Errors
/// If bodies are in each other.
pub fn meet(
    system: &mut System,
    contacts: &mut ContactSet,
    moving: &mut Vec<Moving>,
    displaced: &mut Vec<Displaced>,
    h: f64,
) -> Result<f64, TooDeep> {
    displaced.clear();
    see(system, 0.5 * h, moving);
    contacts.solve(moving, h)?;
    if !contacts.touched.is_empty() {
        return Ok(0.0);
    }
    for (i, moving) in moving.iter().enumerate() {
        let (body, data) = (&mut system.bodies[i], &system.data[i]);
        if moving.v != body.v || moving.w != body.w {
            let change = math::mul_t(&body.r, math::sub(moving.w, body.w));
            body.p = math::axpy(body.p, data.mass, math::sub(moving.v, body.v));
            body.l = math::add(body.l, math::mul(&body.r, math::mul(&data.inertia, change)));
            find_velocities(body, data, h);
        }
        if moving.shift != [0.0; 3] || moving.turn != [0.0; 3] {
            displaced.push((i, moving.shift, moving.turn));
            body.x = math::add(body.x, moving.shift);
            body.rotate(moving.turn);
        }
    }
    Ok(half_work_j(system, displaced))
}

/// What contacts that go on bearing add in half a step of `h` \[s\], at the full step, to bodies that were not `resting`; `moving` is working memory. Returns the kinetic energy that they take \[J\].
pub fn bear_half(
    system: &mut System,
    contacts: &ContactSet,
    moving: &mut Vec<Moving>,
    resting: &[bool],
    h: f64,
) -> f64 {
    let mut bodies = system.bodies.clone();
    kick(system, 0.5 * h, h);
    see(system, 0.5 * h, moving);
    let mut taken_j = 0.0;
    for (i, [v, w]) in contacts.half_borne(moving, h, None).into_iter().flatten().enumerate() {
        if resting[i] {
            continue;
        }
        let (body, data) = (&mut bodies[i], &system.data[i]);
        taken_j += kinetic_j(body, data, 0.0);
        body.p = math::axpy(body.p, data.mass, v);
        let turn = math::mul(&data.inertia, math::mul_t(&body.r, w));
        body.l = math::add(body.l, math::mul(&body.r, turn));
        taken_j -= kinetic_j(body, data, 0.0);
    }
    system.bodies = bodies;
    taken_j
}

/// The bodies as contacts see them, half a step \[s\] of forces in their velocities.
fn see(system: &mut System, half_s: f64, moving: &mut Vec<Moving>) {
    let n = system.count();
    let System { isa, bodies, data, inverses, moved, .. } = system;
    see_all(*isa, &bodies[..n], data, inverses, &mut moved.see, half_s, moving);
}

for_each_isa! {
    fn see_all = see_any(
        bodies: &[BodyState],
        data: &[BodyData],
        inverses: &[InverseBlock],
        at: &mut See,
        half_s: f64,
        moving: &mut Vec<Moving>,
    )
}

/// The bodies as the contacts see them, half a step of forces in their velocities.
#[inline(always)]
fn see_any(
    bodies: &[BodyState],
    data: &[BodyData],
    inverses: &[InverseBlock],
    at: &mut See,
    half_s: f64,
    moving: &mut Vec<Moving>,
) {
    moving.clear();
    for ((bodies, data), inverse) in bodies.chunks(LANES).zip(data.chunks(LANES)).zip(inverses) {
        for (l, body) in bodies.iter().enumerate() {
            for i in 0..3 {
                put(&mut at.r[i], l, body.r[i]);
            }
            // a body turns on with its angular momentum as it is: without the torque of that its velocity at the contact would be one of half a step later
            put(&mut at.torque, l, math::sub(body.torque, math::cross(body.w, body.l)));
        }
        at.go(inverse, half_s);
        for (l, (body, data)) in bodies.iter().zip(data).enumerate() {
            moving.push(Moving {
                x: body.x,
                q: body.q,
                r: body.r,
                v: body.v,
                w: body.w,
                kick_v: math::scale(half_s * data.inverse_mass, body.force),
                kick_w: get(&at.kick, l),
                inverse_mass: data.inverse_mass,
                inverse_inertia: get_matrix(&at.inverse, l),
                alive: data.alive,
                shift: [0.0; 3],
                turn: [0.0; 3],
            });
        }
    }
}

/// Eight bodies that contacts see.
#[derive(Debug, Clone, Default)]
struct See {
    r: [[Lane; 3]; 3],
    torque: [Lane; 3],
    /// Inverse inertia, global frame, and what torques add to angular velocities in half a step.
    inverse: [[Lane; 3]; 3],
    kick: [Lane; 3],
}

impl See {
    #[inline(always)]
    fn go(&mut self, inverse: &InverseBlock, half_s: f64) {
        for l in 0..LANES {
            let r = get_matrix(&self.r, l);
            let own = get_matrix(&inverse.inertia, l);
            let all = math::turned(&r, &own);
            put(&mut self.kick, l, math::scale(half_s, math::mul(&all, get(&self.torque, l))));
            for i in 0..3 {
                put(&mut self.inverse[i], l, all[i]);
            }
        }
    }
}

/// Drifts all positions by `h_s` \[s\].
#[inline]
pub fn drift(system: &mut System, h_s: f64) {
    let n = system.count();
    let before_s = std::mem::replace(&mut system.drifted_s, h_s);
    system.pace = if before_s > 0.0 { h_s / before_s } else { 0.0 };
    let System { isa, bodies, data, moved, .. } = system;
    drift_all(*isa, &mut bodies[..n], data, &mut moved.drift, h_s);
}

for_each_isa! {
    fn drift_all = drift_any(bodies: &mut [BodyState], data: &[BodyData], at: &mut Drift, h_s: f64)
}

#[inline(always)]
fn drift_any(bodies: &mut [BodyState], data: &[BodyData], at: &mut Drift, h_s: f64) {
    for (bodies, data) in bodies.chunks_mut(LANES).zip(data.chunks(LANES)) {
        for (l, body) in bodies.iter().enumerate() {
            put(&mut at.x, l, body.x);
            put(&mut at.v, l, body.v);
            put(&mut at.q, l, body.q);
            put(&mut at.w_body, l, body.w_body);
        }
        at.go(h_s);
        for (l, (body, data)) in bodies.iter_mut().zip(data).enumerate() {
            if data.alive && !data.asleep {
                body.x = get(&at.x, l);
                if at.half2[l] < math::EXP_NEAR {
                    (body.q, body.r) = (get(&at.q, l), get_matrix(&at.r, l));
                } else {
                    let turn = math::qexp(math::scale(h_s, body.w_body));
                    body.q = math::qrenormalise(math::qmul(body.q, turn));
                    body.r = math::qmat(body.q);
                }
            }
        }
    }
}

/// Eight bodies that drift.
#[derive(Debug, Clone, Default)]
struct Drift {
    x: [Lane; 3],
    v: [Lane; 3],
    q: [Lane; 4],
    w_body: [Lane; 3],
    r: [[Lane; 3]; 3],
    /// Square of half the angle of the step.
    half2: Lane,
}

impl Drift {
    #[inline(always)]
    fn go(&mut self, h_s: f64) {
        for l in 0..LANES {
            let turn = math::scale(h_s, get(&self.w_body, l));
            let half2 = 0.25 * math::dot(turn, turn);
            let (half_sinc, c) = math::exp_series(half2);
            let by = [c, half_sinc * turn[0], half_sinc * turn[1], half_sinc * turn[2]];
            let q = math::qrenormalise(math::qmul(get(&self.q, l), by));
            let r = math::qmat(q);
            self.half2[l] = half2;
            let x = math::axpy(get(&self.x, l), h_s, get(&self.v, l));
            put(&mut self.x, l, x);
            put(&mut self.q, l, q);
            put(&mut self.r[0], l, r[0]);
            put(&mut self.r[1], l, r[1]);
            put(&mut self.r[2], l, r[2]);
        }
    }
}

/// Square of an angle below which [`turn_series`] holds.
const TURN_NEAR: f64 = 0.01;

/// `sin(r)/r` and `(1 - cos(r))/r²` from `r²`.
#[inline(always)]
fn turn_series(r2: f64) -> (f64, f64) {
    (
        1.0 - r2 * (1.0 / 6.0 - r2 * (1.0 / 120.0 - r2 * (1.0 / 5040.0 - r2 * (1.0 / 362_880.0)))),
        0.5 - r2 * (1.0 / 24.0 - r2 * (1.0 / 720.0 - r2 * (1.0 / 40320.0 - r2 * (1.0 / 3_628_800.0)))),
    )
}

/// `exp([r]×) v` for a small rotation vector.
#[inline(always)]
fn turn(r: V3, v: V3) -> V3 {
    let r2 = math::dot(r, r);
    let factors = if r2 < TURN_NEAR {
        turn_series(r2)
    } else {
        let s = r2.sqrt();
        (libm::sin(s) / s, (1.0 - libm::cos(s)) / r2)
    };
    turn_by(r, v, factors)
}

/// `exp([r]×) v` with the two factors of `r`.
#[inline(always)]
fn turn_by(r: V3, v: V3, (a, b): (f64, f64)) -> V3 {
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

/// Velocity and angular velocity at the full step.
pub fn velocities(body: &BodyState, data: &BodyData, half_s: f64) -> [V3; 2] {
    let (p, l) = synchronised(body, half_s);
    let w = math::mul(&body.r, math::mul(&data.inverse_inertia, math::mul_t(&body.r, l)));
    [math::scale(data.inverse_mass, p), w]
}

/// Kinetic energy at the full step \[J\].
pub fn kinetic_j(body: &BodyState, data: &BodyData, half_s: f64) -> f64 {
    let (p, l) = synchronised(body, half_s);
    energy_j(body, data, p, l)
}

/// Kinetic energy of what the forces add in a time \[s, J\].
pub fn kick_j(body: &BodyState, data: &BodyData, time_s: f64) -> f64 {
    energy_j(body, data, math::scale(time_s, body.force), math::scale(time_s, body.torque))
}

fn energy_j(body: &BodyState, data: &BodyData, p: V3, l: V3) -> f64 {
    let l_body = math::mul_t(&body.r, l);
    0.5 * data.inverse_mass * math::dot(p, p)
        + 0.5 * math::dot(l_body, math::mul(&data.inverse_inertia, l_body))
}

/// What the forces add to velocity and angular velocity in a time \[s\].
pub fn gains(body: &BodyState, data: &BodyData, time_s: f64) -> [V3; 2] {
    let l = math::scale(time_s, body.torque);
    let w = math::mul(&body.r, math::mul(&data.inverse_inertia, math::mul_t(&body.r, l)));
    [math::scale(data.inverse_mass * time_s, body.force), w]
}
