//! Bodies in free motion and a rod on a pivot.

use super::body::{Crossings, add_motion, center, change, missing_j, momenta, stored_j};
use crate::base::random::Random;
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::shapes::{bilinear, distort, elastic, grid, ground, nearest};
use crate::verify::rotation::rotation;
use crate::verify::{Case, Figure};
use nalgebra::{Matrix3, Vector3};

const GRAVITY_M_S2: f64 = 9.81;
const CONSERVED: &str = "conservation";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        Case::short("free-fall", "A block falls 5 m to the ground.", free_fall),
        Case::short(
            "spinning-block",
            "A distorted block of 36 elements spins at 180 rad/s about a skew axis for more than a turn, vibrating strongly.",
            spinning_block,
        ),
        Case::short(
            "free-flight",
            "A block thrown with random velocities of its nodes, under gravity.",
            free_flight,
        ),
        Case::short(
            "tumbling",
            "A free box 1.2 x 0.8 x 0.4 m turns at 30 rad/s near its middle axis and flips over: direction of its long edge after \
             1 s beside the rigid body with the same nodal masses.",
            tumbling,
        ),
    ];
    for (degrees, factor) in [(1.0, 4.284), (10.0, 2.405)] {
        cases.push(Case::short(
            format!("falling-rod-{degrees}"),
            "A slender stiff rod of 1 m on a frictionless pivot falls from rest at 1 or 10 degrees: time to the horizontal, tip \
             speed there.",
            move || falling_rod(degrees, factor),
        ));
    }
    cases
}

fn free_fall() -> Result<Vec<Figure>, String> {
    let mesh = grid([2; 3], [0.4; 3], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, ground(-5.0, 0.5), false);
    let mut speed = 0.0;
    while body.surfaces.new_touches.is_empty() && body.time_s < 2.0 {
        speed = -body.v[0][2];
        body.step(false);
    }
    let exact = [(2.0_f64 * 5.0 / GRAVITY_M_S2).sqrt(), (2.0_f64 * 5.0 * GRAVITY_M_S2).sqrt()];
    Ok(vec![
        Figure::relative("time to the ground", "s", [exact[0], body.time_s], 1e-3, "sqrt(2 h / g)"),
        Figure::relative("speed there", "m/s", [exact[1], speed], 1e-3, "sqrt(2 g h)"),
    ])
}

fn spinning_block() -> Result<Vec<Figure>, String> {
    let mut mesh = grid([3, 3, 4], [0.6, 0.6, 1.2], elastic(), |_| false);
    distort(&mut mesh.nodes, 0.03, 5, |_| true);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    add_motion(&mut body, [1.0, 2.0, -3.0], [90.0, -120.0, 100.0]);
    let (start, kinetic) = (momenta(&body), body.kinetic_j());
    let energy = (0..1500).fold(0.0, |_, _| body.step(true) + stored_j(&body));
    let end = momenta(&body);
    Ok(vec![
        Figure::relative("energy", "J", [kinetic, energy], 1e-4, CONSERVED),
        Figure::absolute("change of momentum", "-", [0.0, change(start[0], end[0])], 1e-10, CONSERVED),
        Figure::absolute(
            "change of angular momentum",
            "-",
            [0.0, change(start[1], end[1])],
            1e-10,
            CONSERVED,
        ),
    ])
}

fn free_flight() -> Result<Vec<Figure>, String> {
    let mesh = grid([3, 3, 4], [0.6, 0.6, 1.2], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    let mut random = Random::after(3);
    add_motion(&mut body, [3.0, 0.0, 6.0], [2.0, 5.0, -1.0]);
    for v in &mut body.v {
        *v = v.map(|c| c + 0.5 * random.symmetric());
    }
    let (start, kinetic_start) = (momenta(&body)[0], body.kinetic_j());
    let mass: f64 = body.mass_kg.iter().sum();
    let mut kinetic = 0.0;
    for _ in 0..3000 {
        kinetic = body.step(true);
    }
    let end = momenta(&body)[0];
    // velocities are those half a step before the positions
    let fallen = start[2] - mass * GRAVITY_M_S2 * (body.time_s - 0.5 * body.dt_s);
    let missing = missing_j(&body, kinetic, kinetic_start) / kinetic_start;
    Ok(vec![
        Figure::relative("momentum along x", "kg m/s", [start[0], end[0]], 1e-10, CONSERVED),
        Figure::relative("momentum along z", "kg m/s", [fallen, end[2]], 1e-10, "p0 - m g t"),
        Figure::absolute("energy residual over kinetic energy", "-", [0.0, missing], 1e-4, CONSERVED),
    ])
}

/// Rotation of a free rigid body with principal inertia `inertia` \[kg m²\] after `end_s`, from `spin` \[rad/s\] in its own axes: Euler's
/// equations and the turning frame by the classical fourth-order Runge-Kutta method.
fn rigid_rotation(inertia: Vector3<f64>, spin: Vector3<f64>, end_s: f64) -> Matrix3<f64> {
    let rate = |w: Vector3<f64>, r: Matrix3<f64>| {
        let momentum = inertia.component_mul(&w);
        (momentum.cross(&w).component_div(&inertia), r * w.cross_matrix())
    };
    let steps = 20_000;
    let h = end_s / f64::from(steps);
    let (mut w, mut r) = (spin, Matrix3::identity());
    for _ in 0..steps {
        let a = rate(w, r);
        let b = rate(w + 0.5 * h * a.0, r + 0.5 * h * a.1);
        let c = rate(w + 0.5 * h * b.0, r + 0.5 * h * b.1);
        let d = rate(w + h * c.0, r + h * c.1);
        w += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
        r += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
    }
    r
}

fn tumbling() -> Result<Vec<Figure>, String> {
    let size = [1.2, 0.8, 0.4];
    let mut mesh = grid([6, 4, 2], size, elastic(), |_| false);
    mesh.nodes.iter_mut().for_each(|p| (0..3).for_each(|i| p[i] -= 0.5 * size[i]));
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let spin = [0.3, 30.0, 0.3];
    add_motion(&mut body, [0.0; 3], spin);
    let square = |i: usize| body.x.iter().zip(&body.mass_kg).map(|(x, m)| m * x[i] * x[i]).sum::<f64>();
    let [x2, y2, z2] = [square(0), square(1), square(2)];
    let inertia = Vector3::new(y2 + z2, z2 + x2, x2 + y2);
    let (mut turned, mut last) = (0.0_f64, 1.0);
    let ends = [nearest(&mesh, [-0.6, 0.0, 0.0]), nearest(&mesh, [0.6, 0.0, 0.0])];
    let sides = [nearest(&mesh, [0.0, -0.4, 0.0]), nearest(&mesh, [0.0, 0.4, 0.0])];
    let edge = |body: &Dynamics, n: [usize; 2]| {
        (Vector3::from(body.x[n[1]]) - Vector3::from(body.x[n[0]])).normalize()
    };
    while body.time_s < 1.0 {
        body.step(false);
        last = edge(&body, sides).y;
        turned = turned.max(libm::acos(last).to_degrees());
    }
    let exact = rigid_rotation(inertia, Vector3::from(spin), body.time_s);
    let angle = |a: Vector3<f64>, b: Vector3<f64>| libm::atan2(a.cross(&b).norm(), a.dot(&b)).to_degrees();
    let off = angle(edge(&body, ends), exact.column(0).into());
    let middle = libm::acos(exact.column(1).y).to_degrees();
    Ok(vec![
        Figure::absolute(
            "tilt of the middle axis",
            "deg",
            [middle, libm::acos(last).to_degrees()],
            0.5,
            "Euler's equations",
        ),
        Figure::absolute("largest tilt (it flips over)", "deg", [180.0, turned], 10.0, "Euler's equations"),
        Figure::absolute("angle between the long edges", "deg", [0.0, off], 0.5, "Euler's equations"),
        Figure::absolute(
            "drift of the mass centre",
            "m",
            [0.0, center(&body).iter().map(|c| c.abs()).sum()],
            1e-9,
            CONSERVED,
        ),
    ])
}

/// `θ'' = 3 g / (2 H) sin θ`: `t = sqrt(H / 3g) ∫ dθ / sqrt(cos θ0 - cos θ)` and `v = sqrt(3 g H cos θ0)`.
fn falling_rod(degrees: f64, factor: f64) -> Result<Vec<Figure>, String> {
    let (height, width) = (1.0, 0.05);
    let law = bilinear(1e9, 0.0, 2500.0, 1e15, 0.0);
    let pivot = |p: [f64; 3]| p[2] == 0.0 && (p[0] - 0.5 * width).abs() < 1e-9;
    let mut mesh = grid([2, 1, 20], [width, width, height], law, pivot);
    let tip = nearest(&mesh, [0.5 * width, 0.0, height]);
    let tilt = rotation(f64::to_radians(degrees) * Vector3::y());
    for p in &mut mesh.nodes {
        *p = (tilt * Vector3::new(p[0] - 0.5 * width, p[1], p[2])).into();
    }
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    let (mut down, mut speed) = (Crossings::default(), 0.0);
    while down.times_s.is_empty() && body.time_s < 3.0 {
        body.step(false);
        down.see(body.time_s, body.x[tip][2]);
        speed = body.v[tip].iter().map(|c| c * c).sum::<f64>().sqrt();
    }
    let time = *down.times_s.first().ok_or("the rod did not fall")?;
    let exact = factor * (height / GRAVITY_M_S2).sqrt();
    let fastest = (3.0 * GRAVITY_M_S2 * height * libm::cos(f64::to_radians(degrees))).sqrt();
    Ok(vec![
        Figure::relative("time to the horizontal", "s", [exact, time], 0.005, "rigid rod, elliptic integral"),
        Figure::relative("tip speed", "m/s", [fastest, speed], 0.005, "sqrt(3 g H cos θ0)"),
    ])
}
