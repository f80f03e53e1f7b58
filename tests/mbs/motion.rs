//! Motion without contact: pendulums, free bodies, falling rod, order of convergence.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::system::System;
use fallwerk::mbs::{RunResult, math, simulate, step};

/// The pendulum of MSC Adams' joint tests (projectchrono/chrono): 1 kg, centre of mass at 2 m, from rest
/// horizontal, hinge about y.
fn pendulum(spring: f64, end_s: f64, step_s: Option<f64>) -> RunResult {
    let mut m = model("pendulum", end_s, 0.1);
    m.gravity_m_s2 = [0.0, 0.0, -9.80665];
    let mut bob = solid("bob", [2.0, 0.0, 0.0], [1.0; 3]);
    bob.mass_kg = 1.0;
    bob.inertia_kg_m2 = [[0.04, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]];
    m.bodies.push(bob);
    m.bushings.push(joint("pivot", None, "bob", [0.0; 3], 1e7, 0.0, [elastic(0.0), elastic(spring)]));
    m.settings.time_step_s = step_s;
    simulate(&m).unwrap()
}

fn height(result: &RunResult, time_s: f64) -> f64 {
    let i = (time_s / 0.1_f64).round() as usize;
    result.frames[i].position_m[0][2]
}

#[test]
fn revolute_pendulum_agrees_with_adams() {
    let result = pendulum(0.0, 5.0, None);
    let reference = [
        (0.5, -1.114320),
        (1.0, -1.789880),
        (1.5, -0.182356),
        (2.0, -0.439479),
        (3.0, -0.711481),
        (5.0, -0.0355587),
    ];
    let worst = reference.iter().map(|(t, z)| (height(&result, *t) - z).abs()).fold(0.0, f64::max);
    println!("revolute pendulum: largest error {worst:.2e} m, step {:.4} ms", 1e3 * result.time_step_s);
    assert!(worst < 1e-4);
}

#[test]
fn spring_pendulum_agrees_with_its_equation_of_motion() {
    // I θ'' = m g 2 cos θ - 200 θ, z = -2 sin θ; Runge-Kutta with a thousandth of a second.
    let result = pendulum(200.0, 5.0, None);
    let accel = |a: f64| (9.80665 * 2.0 * a.cos() - 200.0 * a) / 4.1;
    let (mut a, mut w) = (0.0_f64, 0.0_f64);
    let h = 1e-3;
    let mut worst = 0.0_f64;
    for i in 1..=5000 {
        let (k1a, k1w) = (w, accel(a));
        let (k2a, k2w) = (w + 0.5 * h * k1w, accel(a + 0.5 * h * k1a));
        let (k3a, k3w) = (w + 0.5 * h * k2w, accel(a + 0.5 * h * k2a));
        let (k4a, k4w) = (w + h * k3w, accel(a + h * k3a));
        a += h / 6.0 * (k1a + 2.0 * k2a + 2.0 * k3a + k4a);
        w += h / 6.0 * (k1w + 2.0 * k2w + 2.0 * k3w + k4w);
        if i % 100 == 0 {
            worst = worst.max((height(&result, f64::from(i) * h) + 2.0 * a.sin()).abs());
        }
    }
    println!("spring pendulum: largest error {worst:.2e} m");
    assert!(worst < 2e-5);
}

#[test]
fn error_falls_with_the_square_of_the_step() {
    // A double pendulum on soft joints: every part of the force law moves smoothly.
    let position = |h: f64| {
        let mut m = model("order", 0.5, 0.5);
        for i in 0..2 {
            let mut rod = solid(&format!("rod{i}"), [0.5 + f64::from(i), 0.1, 0.0], [1.0, 0.2, 0.1]);
            rod.angular_velocity_rad_s = [1.0, 0.5, 3.0];
            m.bodies.push(rod);
        }
        let bend = [elastic(800.0), elastic(500.0)];
        m.bushings.push(joint("a", None, "rod0", [0.0; 3], 3e4, 300.0, bend.clone()));
        m.bushings.push(joint("b", Some("rod0"), "rod1", [1.0, 0.1, 0.0], 3e4, 300.0, bend));
        m.settings.time_step_s = Some(h);
        simulate(&m).unwrap().frames.pop().unwrap().position_m[1]
    };
    let h = 1e-3;
    let [a, b, c] = [h, h / 2.0, h / 4.0].map(position);
    let ratio = math::norm(math::sub(a, b)) / math::norm(math::sub(b, c));
    println!("order of convergence: {:.4} (difference {:.1e} m)", ratio.log2(), math::norm(math::sub(b, c)));
    assert!((ratio.log2() - 2.0).abs() < 0.05);
}

#[test]
fn free_body_keeps_angular_momentum_exactly_and_energy_to_second_order() {
    let mut m = model("free", 1.0, 1.0);
    let mut body = solid("body", [0.0; 3], [0.4, 1.0, 2.0]);
    body.angular_velocity_rad_s = [0.1, 5.0, 0.2]; // about the unstable middle axis
    m.bodies.push(body);
    m.gravity_m_s2 = [0.0; 3];
    let drift = |h: f64| {
        let mut system = System::new(&m).unwrap();
        let start = system.bodies[0].l;
        let e0 = step::kinetic_j(&system.bodies[0], &system.data[0], 0.0);
        let mut worst = 0.0_f64;
        for _ in 0..(10.0 / h) as usize {
            system.reset_forces();
            step::kick(&mut system, h, h);
            step::drift(&mut system, h);
            worst = worst.max((step::kinetic_j(&system.bodies[0], &system.data[0], 0.0) / e0 - 1.0).abs());
        }
        assert_eq!(system.bodies[0].l, start);
        worst
    };
    let (coarse, fine) = (drift(1e-3), drift(5e-4));
    println!("free body: energy error {coarse:.1e} at 1 ms, {fine:.1e} at 0.5 ms");
    assert!(coarse < 1e-5 && fine < 0.3 * coarse);
}

#[test]
fn joint_forces_conserve_momentum_and_angular_momentum() {
    let mut m = model("pair", 1.0, 1.0);
    m.gravity_m_s2 = [0.0; 3];
    let (mut a, mut b) =
        (solid("a", [0.0; 3], [0.4, 1.0, 2.0]), solid("b", [0.0, 0.3, 2.0], [0.5, 0.7, 1.0]));
    (a.velocity_m_s, a.angular_velocity_rad_s) = ([1.0, 0.0, 2.0], [2.0, 1.0, 0.0]);
    b.angular_velocity_rad_s = [0.0, -2.0, 3.0];
    m.bodies = vec![a, b];
    m.bushings.push(joint("j", Some("a"), "b", [0.0, 0.1, 1.0], 1e7, 1e5, [elastic(2e5), elastic(1e5)]));
    let mut system = System::new(&m).unwrap();
    let total = |s: &System| {
        let mut sum = [[0.0; 3]; 2];
        for body in &s.bodies[..2] {
            sum[0] = math::add(sum[0], body.p);
            // x is half a step ahead of p; p × v vanishes, so the position may be taken anywhere along v.
            sum[1] = math::add(sum[1], math::add(body.l, math::cross(body.x, body.p)));
        }
        sum
    };
    let start = total(&system);
    for _ in 0..20000 {
        system.reset_forces();
        system.add_joint_forces();
        step::kick(&mut system, 1e-4, 1e-4);
        step::drift(&mut system, 1e-4);
    }
    let end = total(&system);
    let scale = math::norm(start[1]);
    for k in 0..2 {
        let off = math::norm(math::sub(start[k], end[k]));
        assert!(off < 1e-10 * scale, "{k}: {off} of {scale}");
    }
}

#[test]
fn falling_rod_hits_at_the_closed_form_time_and_speed() {
    let (length, tilt) = (10.0, 10.0_f64.to_radians());
    let mut m = model("rod", 2.6, 1e-3);
    let mut rod =
        solid("rod", [0.5 * length * tilt.sin(), 0.0, 0.5 * length * tilt.cos()], [0.1, 0.1, length]);
    rod.orientation = [(0.5 * tilt).cos(), 0.0, (0.5 * tilt).sin(), 0.0];
    let slender = rod.mass_kg * length * length / 12.0;
    rod.inertia_kg_m2 = [[slender, 0.0, 0.0], [0.0, slender, 0.0], [0.0, 0.0, 1e-3 * slender]];
    m.bodies.push(rod);
    m.bushings.push(joint("pivot", None, "rod", [0.0; 3], 1e9, 0.0, [elastic(0.0), elastic(0.0)]));
    let result = simulate(&m).unwrap();
    let falling: Vec<f64> = result.frames.iter().map(|f| -f.position_m[0][2]).collect();
    let (time, speed) = crossing(&result.times_s, &falling, 0.0);
    let exact_speed = (3.0 * G * length * tilt.cos()).sqrt();
    println!("falling rod: time {time:.5} s (2.4281), tip speed {:.5} m/s ({exact_speed:.5})", 2.0 * speed);
    assert!((time - 2.405 * (length / G).sqrt()).abs() < 1e-3);
    assert!((2.0 * speed / exact_speed - 1.0).abs() < 1e-4);
}

#[test]
fn segments_yield_where_the_falling_chimney_breaks() {
    // Two segments of a uniform rod joined at a third of the height: the moment there is m g L sin θ / 27. The
    // sudden start makes the joint vibrate by as much as its first moment, sin θ = 0.01.
    let (length, tilt) = (30.0, 0.01_f64);
    let mass_per_length = DENSITY * 0.25;
    let mut m = model("chimney", 9.0, 1e-3);
    let direction = [tilt.sin(), 0.0, tilt.cos()];
    for (id, from, to) in [("low", 0.0, length / 3.0), ("high", length / 3.0, length)] {
        let mut part = solid(id, math::scale(0.5 * (from + to), direction), [0.5, 0.5, to - from]);
        part.orientation = [(0.5 * tilt).cos(), 0.0, (0.5 * tilt).sin(), 0.0];
        part.shapes.clear();
        m.bodies.push(part);
    }
    let weight = mass_per_length * length * G;
    let capacity = weight * length / 27.0 * 0.5; // reached at sin θ = 0.5
    let mut law = curve(&[[0.0, capacity], [1.0, capacity]], 2.0);
    law.stiffness_nm_rad = 2e9;
    m.curves.insert("joint".into(), law);
    m.bushings.push(joint("pivot", None, "low", [0.0; 3], 1e10, 0.0, [elastic(0.0), elastic(0.0)]));
    m.bushings.push(joint(
        "joint",
        Some("low"),
        "high",
        math::scale(length / 3.0, direction),
        1e10,
        1e9,
        [elastic(2e9), hinge("joint")],
    ));
    let result = simulate(&m).unwrap();
    let event = &result.events[0];
    let i = (event.time_s / 1e-3).round() as usize;
    let x = result.frames[i].position_m[0];
    let sine = x[0] / x[0].hypot(x[2]);
    println!("chimney: yields at sin θ = {sine:.4} (0.5)");
    assert!((sine - 0.5).abs() < 0.012);
    assert!(matches!(event.kind, fallwerk::mbs::result::EventKind::Yield { .. }));
}

#[test]
fn the_same_model_gives_the_same_bytes() {
    let run = || {
        let mut result = simulate(&super::frame::frame4(1e9, 1.2)).unwrap();
        result.cpu_s = 0.0;
        serde_json::to_string(&result).unwrap()
    };
    assert_eq!(run(), run());
}

#[test]
fn a_diverging_step_is_refused() {
    let mut m = model("step", 0.1, 0.1);
    m.bodies.push(solid("a", [0.0, 0.0, 1.0], [1.0; 3]));
    m.bushings.push(joint("j", None, "a", [0.0; 3], 1e9, 1e8, [elastic(1e8), elastic(1e8)]));
    m.settings = RunSettings { time_step_s: Some(0.05), ..m.settings };
    let error = simulate(&m).unwrap_err().to_string();
    assert!(error.contains("stability limit"), "{error}");
    m.settings.time_step_s = Some(step_told(&error));
    assert!(simulate(&m).is_ok(), "{error}");
}

/// Without torques the energy is kept: iterations for the angular velocity that end too soon take some of it in every step.
#[test]
fn a_body_that_tumbles_fast_keeps_its_energy() {
    for spin in [20.0, 100.0, 400.0] {
        let mut m = model("tumbling", 2.0, 0.05);
        m.gravity_m_s2 = [0.0; 3];
        let mut body = solid("body", [0.0; 3], [1.0; 3]);
        body.inertia_kg_m2 = [[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.8]];
        body.angular_velocity_rad_s = [0.3 * spin, 0.9 * spin, 0.2 * spin];
        m.bodies.push(body);
        m.settings.time_step_s = Some(1e-3);
        let result = simulate(&m).unwrap();
        let e = &result.energies.kinetic_j;
        // what swings with the step about the energy of exact motion
        let bound = 0.2 * (0.5e-3 * spin) * (0.5e-3 * spin);
        let off = e.iter().map(|k| (k / e[0] - 1.0).abs()).fold(0.0, f64::max);
        println!("{spin} rad/s: energy off by {off:.1e} (bound {bound:.1e})");
        assert!(off < bound, "{spin}: {off}");
    }
}
