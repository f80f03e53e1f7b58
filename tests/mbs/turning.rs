//! Hinges and torsion springs between bodies on ideal joints that turn far or about several axes: revolutions, energies, what they take and what is told.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::{RunResult, simulate};

const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// A body without weight that a joint holds in the middle.
fn spinning(inertia: [f64; 3], omega: [f64; 3], kind: JointKind, end_time_s: f64) -> Model {
    let mut m = model("spinning", end_time_s, 0.05);
    m.gravity_m_s2 = [0.0; 3];
    let [a, b, c] = inertia;
    m.bodies.push(Body {
        inertia_kg_m2: [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]],
        angular_velocity_rad_s: omega,
        shapes: Vec::new(),
        ..solid("b", [0.0; 3], [1.0; 3])
    });
    m.joints.push(Joint {
        id: "j".into(),
        kind,
        body_a: None,
        body_b: "b".into(),
        point_m: [0.0; 3],
        point_b_m: None,
        axis: (kind != JointKind::Spherical).then_some(Z),
        axis_b: (kind == JointKind::Universal).then_some([1.0, 0.0, 0.0]),
        origin: Origin::default(),
    });
    m
}

fn hinge(stiffness_nm_rad: f64, capacity_nm: f64) -> Force {
    Force::Hinge {
        id: "t".into(),
        body_a: None,
        body_b: "b".into(),
        stiffness_nm_rad,
        capacity: vec![[0.0, capacity_nm]],
        fracture_rad: None,
        joint: None,
    }
}

fn torsion(stiffness_nm_rad: f64, damping_nm_s_rad: f64) -> Force {
    Force::Torsion {
        id: "t".into(),
        body_a: None,
        body_b: "b".into(),
        axis: Z,
        stiffness_nm_rad,
        damping_nm_s_rad,
    }
}

/// Largest distance of a history from what is expected.
fn off(result: &RunResult, found: impl Fn(usize) -> f64, expected: impl Fn(f64) -> f64) -> f64 {
    result.times_s.iter().enumerate().map(|(i, t)| (found(i) - expected(*t)).abs()).fold(0.0, f64::max)
}

/// Elastic to its capacity, then slowed down evenly by it: over almost two revolutions, with large and with small steps.
#[test]
fn a_hinge_that_flows_over_two_revolutions_takes_what_its_capacity_does() {
    let (k, capacity, omega) = (100.0f64, 1.0, 5.0f64);
    let (yield_rad, frequency) = (capacity / k, k.sqrt());
    let yield_s = (yield_rad * frequency / omega).asin() / frequency;
    let speed = (omega * omega - k * yield_rad * yield_rad).sqrt();
    let angle = |t: f64| match t - yield_s {
        s if s < 0.0 => omega / frequency * (frequency * t).sin(),
        s => yield_rad + speed * s - 0.5 * capacity * s * s,
    };
    for kind in [JointKind::Revolute, JointKind::Spherical] {
        for (tolerance, near) in [(1e-6, 1e-3), (1e-9, 1e-5)] {
            let mut m = spinning([1.0; 3], [0.0, 0.0, omega], kind, 4.9);
            m.settings.tolerance = tolerance;
            m.forces.push(hinge(k, capacity));
            let result = simulate(&m).unwrap();
            let turn = &result.turns[0];
            let far = off(&result, |i| turn.rotation_rad[i][2], angle);
            assert!(far < near, "{kind:?} {tolerance}: {far}");
            let flow = |t: f64| capacity * (angle(t) - yield_rad).max(0.0);
            let far = off(&result, |i| result.energies.plastic_j[i], flow);
            assert!(far < near, "{kind:?} {tolerance}: {far}");
            assert!(result.energies.applied_j.iter().all(|a| *a == 0.0) && result.warnings.is_empty());
            assert!(result.energy_error < near, "{}", result.energy_error);
        }
    }
}

#[test]
fn a_torsion_spring_swings_back_after_most_of_a_revolution_and_after_several() {
    for (omega, step) in [(5.0, None), (40.0, None), (5.0, Some(0.01))] {
        let mut m = spinning([1.0; 3], [0.0, 0.0, omega], JointKind::Revolute, 10.0);
        m.settings.time_step_s = step;
        m.forces.push(torsion(1.0, 0.0));
        let result = simulate(&m).unwrap();
        let far = off(&result, |i| result.turns[0].rotation_rad[i][0], |t| omega * t.sin());
        assert!(far < 1e-4 * omega, "{omega}: {far}");
        assert!(result.energy_error < 1e-5, "{}", result.energy_error);
    }
}

/// On a universal joint a body with one moment of inertia about all axes turns about both independently: about the first as a torsion spring makes it, about the second evenly.
#[test]
fn a_torsion_spring_on_a_universal_joint_knows_the_turn_about_its_axis_alone() {
    let mut m = spinning([1.0; 3], [0.8, 0.0, 3.0], JointKind::Universal, 2.5);
    m.settings.tolerance = 1e-9;
    m.forces.push(torsion(4.0, 0.0));
    let result = simulate(&m).unwrap();
    let far = off(&result, |i| result.turns[0].rotation_rad[i][0], |t| 1.5 * (2.0 * t).sin());
    assert!(far < 1e-6, "{far}");
    assert!(result.energy_error < 1e-7 && result.warnings.is_empty(), "{:?}", result.warnings);
}

/// Two bodies that tumble with a torsion spring between them, to which nothing is applied: their energy stays, and so does their angular momentum.
#[test]
fn a_torsion_spring_between_tumbling_bodies_keeps_their_energy() {
    let mut m = model("free", 10.0, 0.05);
    m.gravity_m_s2 = [0.0; 3];
    for (id, inertia, x, omega) in
        [("a", [1.0, 1.2, 1.4], 0.0, [0.5, 0.2, 0.3]), ("b", [1.0, 0.8, 1.1], 3.0, [-0.6, 0.4, 2.0])]
    {
        let [a, b, c] = inertia;
        m.bodies.push(Body {
            inertia_kg_m2: [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]],
            angular_velocity_rad_s: omega,
            shapes: Vec::new(),
            ..solid(id, [x, 0.0, 0.0], [1.0; 3])
        });
    }
    let Force::Torsion { id, body_b, axis, damping_nm_s_rad, .. } = torsion(6.0, 0.0) else { unreachable!() };
    let body_a = Some("a".into());
    m.forces.push(Force::Torsion { id, body_a, body_b, axis, stiffness_nm_rad: 6.0, damping_nm_s_rad });
    let result = simulate(&m).unwrap();
    let e = &result.energies;
    let held = |i: usize| e.kinetic_j[i] + e.joints_elastic_j[i];
    let far = off(&result, held, |_| held(0));
    assert!(far < 1e-4 * held(0), "{far} of {}", held(0));
    assert!(e.applied_j.iter().all(|a| *a == 0.0));
}

#[test]
fn a_torsion_spring_whose_axis_tips_over_is_told_by_name_and_time() {
    let mut m = spinning([1.0; 3], [1.0, 0.0, 0.1], JointKind::Universal, 2.9);
    m.forces.push(torsion(0.01, 0.0));
    let result = simulate(&m).unwrap();
    let told = result.warnings.iter().find(|w| w.contains("torsion spring \"t\"")).unwrap();
    let at: f64 = told.split("at ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((2.79..2.91).contains(&at) && told.contains("universal joint"), "{told}");
    assert!(result.energy_error < 1e-4, "{}", result.energy_error);
}

/// A hinge that flows about three axes at once, up to its first way back: what is missing of the kinetic energy is `C (|θ| - C/2k)` of each.
#[test]
fn a_hinge_that_flows_about_three_axes_takes_the_work_of_each() {
    let (k, capacity) = (50.0, 2.0);
    let mut m = spinning([1.0, 1.5, 2.0], [1.0, 2.0, 1.5], JointKind::Spherical, 0.6);
    m.settings.tolerance = 1e-9;
    m.forces.push(hinge(k, capacity));
    let result = simulate(&m).unwrap();
    let (e, turn) = (&result.energies, &result.turns[0]);
    let mut flowed = 0;
    for i in 0..result.times_s.len() {
        let [rotation, moment] = [turn.rotation_rad[i], turn.moment_nm[i]];
        if moment.iter().any(|m| *m < capacity) {
            continue;
        }
        flowed += 1;
        let work: f64 = rotation.iter().map(|r| capacity * (r - 0.5 * capacity / k)).sum();
        assert!((e.kinetic_j[0] - e.kinetic_j[i] - work).abs() < 1e-5, "{} {work}", e.kinetic_j[i]);
    }
    assert!(flowed > 5 && result.energy_error < 1e-5, "{flowed} {}", result.energy_error);
}

/// The same at large, back and forth: plastic work and elastic energy are all that is missing.
#[test]
fn a_hinge_that_flows_about_three_axes_far_and_back_makes_no_energy() {
    for (omega, tolerance) in [([1.0, 2.0, 1.5], 1e-6), ([1.0, 2.0, 1.5], 1e-4), ([2.0, 3.0, -1.0], 1e-6)] {
        let mut m = spinning([1.0, 1.5, 2.0], omega, JointKind::Spherical, 5.0);
        m.settings.tolerance = tolerance;
        m.forces.push(hinge(5.0, 2.0));
        let result = simulate(&m).unwrap();
        let e = &result.energies;
        assert!(result.energy_error < 100.0 * tolerance, "{}", result.energy_error);
        assert!(e.plastic_j.windows(2).all(|w| w[1] >= w[0] - 1e3 * tolerance));
        assert!(*e.plastic_j.last().unwrap() < e.kinetic_j[0] && e.applied_j.iter().all(|a| *a == 0.0));
    }
}

#[test]
fn a_hinge_near_a_revolution_about_several_axes_is_told_and_makes_no_energy() {
    let mut m = spinning([1.0, 1.5, 2.0], [1.0, 6.0, 1.5], JointKind::Spherical, 5.0);
    m.forces.push(hinge(5.0, 0.7));
    let result = simulate(&m).unwrap();
    let told = result.warnings.iter().find(|w| w.contains("hinge \"t\": at ")).unwrap();
    assert!(told.contains("fracture_rad") && told.contains("revolute"), "{told}");
    let e = &result.energies;
    assert!(result.energy_error < 1e-4, "{}", result.energy_error);
    assert!(e.plastic_j.windows(2).all(|w| w[1] >= w[0] - 1e-4));
}

/// A damped swing: what the damper takes is what is missing, and is computed from the damper.
#[test]
fn dampers_take_what_the_closed_form_says() {
    let (k, d) = (4.0, 0.4);
    let mut m = spinning([1.0; 3], [0.0, 0.0, 3.0], JointKind::Revolute, 3.0);
    m.settings.tolerance = 1e-9;
    m.forces.push(torsion(k, d));
    let result = simulate(&m).unwrap();
    let (decay, frequency) = (0.5 * d, (k - 0.25 * d * d).sqrt());
    let taken = |t: f64| {
        let (sin, cos) = (frequency * t).sin_cos();
        let fade = 3.0 * (-decay * t).exp();
        let (angle, rate) = (fade * sin / frequency, fade * (cos - decay / frequency * sin));
        4.5 - 0.5 * rate * rate - 0.5 * k * angle * angle
    };
    let far = off(&result, |i| result.energies.applied_j[i], taken);
    assert!(far < 1e-7 && result.energy_error < 1e-7, "{far} {}", result.energy_error);
}

#[test]
fn the_rotation_of_a_bushing_on_an_ideal_joint_is_told_with_its_revolutions() {
    let mut m = spinning([1.0; 3], [0.0, 0.0, 5.0], JointKind::Revolute, 4.0);
    m.curves.insert("c".into(), curve(&[[0.0, 1.0]], 1000.0));
    m.curves.get_mut("c").unwrap().stiffness_nm_rad = 1000.0;
    let axes = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]];
    let bushing = joint("k", None, "b", [0.0; 3], 0.0, 0.0, [super::support::hinge("c"), elastic(0.0)]);
    m.bushings.push(Bushing { axes, ..bushing });
    let result = simulate(&m).unwrap();
    let far = off(&result, |i| result.hinges[0].rotation_rad[i][0], |t| 5.0 * t - 0.5 * t * t);
    assert!(far < 0.05, "{far}");
}

/// A joint that is released takes the hinge on it along: nothing turns the body any more.
#[test]
fn a_hinge_goes_with_its_joint() {
    let mut m = spinning([1.0, 1.0, 1.0], [0.0, 0.0, 2.0], JointKind::Revolute, 1.0);
    let Force::Hinge { id, body_a, body_b, stiffness_nm_rad, capacity, fracture_rad, .. } = hinge(40.0, 1e9)
    else {
        unreachable!()
    };
    let joint = Some("j".to_string());
    m.forces.push(Force::Hinge { id, body_a, body_b, stiffness_nm_rad, capacity, fracture_rad, joint });
    m.events.push(Event { release: vec!["j".into()], ..Event::at("cut", 0.2) });
    let result = simulate(&m).unwrap();
    assert!(result.energies.joints_elastic_j[3] > 0.1, "{:?}", result.energies.joints_elastic_j);
    let kinetic = &result.energies.kinetic_j[5..];
    assert!(kinetic.iter().all(|k| (k / kinetic[0] - 1.0).abs() < 1e-9), "{kinetic:?}");
    assert!(result.energies.joints_elastic_j[5..].iter().all(|e| *e == 0.0));
    assert!(result.energy_error < 1e-6, "{}", result.energy_error);
}
