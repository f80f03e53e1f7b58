//! Impacts of bodies on ideal joints, and what contacts have left at rest; cases with closed forms are in `fallwerk verify mbs` (`impact-slider-crank`, `impact-rod`, `contact-support`).

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::{RunResult, math, simulate};

const Y: [f64; 3] = [0.0, 1.0, 0.0];

fn pin(id: &str, a: Option<&str>, b: &str, point_m: [f64; 3]) -> Joint {
    Joint { axis: Some(Y), ..ideal(id, JointKind::Revolute, a, b, point_m) }
}

/// The tip of a double pendulum strikes the ground, again and again, without loss.
#[test]
fn a_double_pendulum_rebounds_without_loss() {
    let mut m = model("double pendulum", 2.0, 0.05);
    m.bodies.push(solid("upper", [0.5, 0.0, 1.5], [1.0, 0.1, 0.1]));
    m.bodies.push(solid("lower", [1.5, 0.0, 1.5], [1.0, 0.1, 0.1]));
    m.bodies[0].shapes.clear();
    m.bodies[1].shapes = vec![Shape::Sphere { center_m: [0.5, 0.0, 0.0], radius_m: 0.1 }];
    m.joints.push(pin("top", None, "upper", [0.0, 0.0, 1.5]));
    m.joints.push(pin("middle", Some("upper"), "lower", [1.0, 0.0, 1.5]));
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.0, restitution: 1.0 });
    let result = simulate(&m).unwrap();
    let turned = result.energies.kinetic_j.iter().copied().fold(0.0, f64::max);
    assert!(result.first_ground_contact_s.is_some());
    let taken = result.energies.contact_damping_j.last().unwrap() / turned;
    assert!(taken.abs() < 1e-9 && result.energy_error < 2e-5, "{taken} {}", result.energy_error);
}

/// A double pendulum that strikes a rough floor with its tip and slips back (Kane and Levinson, Dynamics: Theory and Applications, 1985): Newton's coefficient of restitution gives it 0.7 of what it has.
fn kane() -> Model {
    let mut m = model("Kane", 0.02, 1e-3);
    let (angles, spins) = ([0.44_f64, 0.27], [1.7, 3.8]);
    let steps = angles.map(|a| [a.sin(), 0.0, -a.cos()]);
    let pivot = [0.0, 0.0, 0.021 - steps[0][2] - steps[1][2]];
    let along = |from: [f64; 3], link: usize, share: f64| [0, 1, 2].map(|i| from[i] + share * steps[link][i]);
    let moves = |of: [f64; 3], link: usize, share: f64| {
        let [x, _, z] = steps[link];
        [of[0] + share * spins[link] * z, 0.0, of[2] - share * spins[link] * x]
    };
    let knee = (along(pivot, 0, 1.0), moves([0.0; 3], 0, 1.0));
    for (link, (at, velocity)) in [(pivot, [0.0; 3]), knee].into_iter().enumerate() {
        let mut body = solid(["upper", "lower"][link], along(at, link, 0.5), [0.1, 0.1, 1.0]);
        body.velocity_m_s = moves(velocity, link, 0.5);
        body.angular_velocity_rad_s = [0.0, spins[link], 0.0];
        body.shapes.clear();
        m.bodies.push(body);
    }
    m.bodies[1].shapes = vec![Shape::Sphere { center_m: along([0.0; 3], 1, 0.5), radius_m: 0.02 }];
    m.joints.push(pin("top", None, "upper", pivot));
    m.joints.push(pin("knee", Some("upper"), "lower", knee.0));
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.9 });
    m
}

#[test]
fn rebound_with_friction_makes_no_energy() {
    let mut m = kane();
    let alone = simulate(&m).unwrap();
    let e = &alone.energies;
    let taken = |i: usize| (e.contact_damping_j[i] + e.friction_j[i]) / e.kinetic_j[0];
    assert!(alone.first_ground_contact_s.is_some());
    assert!((1..e.kinetic_j.len()).all(|i| taken(i) > -1e-6), "{:?}", e.contact_damping_j);
    // it does leave the floor again
    let z = |r: &RunResult| r.frames.last().unwrap().position_m[1];
    assert!(z(&alone)[2] > m.bodies[1].position_m[2]);
    assert!(alone.energy_error < 1e-5, "{}", alone.energy_error);
    // what friction takes elsewhere is no energy to be had here
    let mut block = solid("block", [20.0, 0.0, 0.5], [1.0; 3]);
    block.velocity_m_s = [5.0, 0.0, 0.0];
    m.bodies.push(block);
    let beside = simulate(&m).unwrap();
    let apart = (0..3).map(|i| (z(&alone)[i] - z(&beside)[i]).abs()).fold(0.0, f64::max);
    assert!(apart < 1e-4, "{apart}");
}

/// A force of zero, which makes a model one with joints and forces.
fn no_force(body: &str) -> Force {
    force("none", body, [0.0; 3], [0.0; 3])
}

/// A force that always acts.
fn force(id: &str, body: &str, point_m: [f64; 3], force_n: [f64; 3]) -> Force {
    Force::Force { id: id.into(), body: body.into(), point_m, force_n, from_to_s: None }
}

/// Three balls 0.3 mm apart: the second impact falls into the step of the first one.
#[test]
fn what_is_struck_strikes_the_next_one() {
    let mut m = model("line", 0.2, 0.01);
    m.gravity_m_s2 = [0.0; 3];
    m.contact.bodies = Some(BodyContact { friction: 0.0, restitution: 1.0 });
    for i in 0..3 {
        let mut ball = solid(&format!("b{i}"), [0.2003 * f64::from(i), 0.0, 0.0], [0.2; 3]);
        ball.shapes = vec![Shape::Sphere { center_m: [0.0; 3], radius_m: 0.1 }];
        m.bodies.push(ball);
    }
    m.bodies[0].position_m[0] -= 0.1;
    m.bodies[0].velocity_m_s[0] = 1.0;
    m.forces.push(no_force("b1"));
    let result = simulate(&m).unwrap();
    let [last, before] = [1, 2].map(|k| &result.frames[result.frames.len() - k].position_m);
    let speeds: Vec<f64> = (0..3).map(|i| (last[i][0] - before[i][0]) / 0.01).collect();
    for (speed, known) in speeds.iter().zip([0.0, 0.0, 1.0]) {
        assert!((speed - known).abs() < 1e-9, "{speeds:?}");
    }
}

/// A box that comes down level rebounds level, as in a model of loose bodies.
#[test]
fn a_face_is_struck_with_all_its_corners() {
    let mut m = model("level", 1.5, 0.05);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.8 });
    m.bodies.push(solid("box", [0.0, 0.0, 0.9], [0.5, 0.4, 0.3]));
    let loose = simulate(&m).unwrap();
    m.forces.push(no_force("box"));
    let result = simulate(&m).unwrap();
    for (a, b) in loose.frames.iter().zip(&result.frames) {
        let off = (a.position_m[0][2] - b.position_m[0][2]).abs();
        let tilt = 2.0 * math::norm([b.orientation[0][1], b.orientation[0][2], b.orientation[0][3]]);
        assert!(off < 1e-3 && tilt < 1e-3, "{off} m, {tilt} rad");
    }
}

/// Three blocks on each other, of which the lowest vanishes: sweeps leave a little of the velocities between them.
#[test]
fn a_stack_that_loses_its_foot_falls_from_rest() {
    for is_forced in [true, false] {
        let mut m = model("stack", 0.6, 0.1);
        m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.1 });
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.1 });
        for i in 0..4 {
            m.bodies.push(solid(&format!("k{i}"), [0.0, 0.0, 0.5 + f64::from(i)], [1.0; 3]));
        }
        if is_forced {
            m.forces.push(no_force("k3"));
        }
        m.events.push(Event { remove_bodies: vec!["k0".into()], ..Event::at("cut", 0.3) });
        let result = simulate(&m).unwrap();
        let at = |i: usize| result.frames[i].position_m[1][2];
        let fallen = at(3) - at(6);
        assert!((fallen - 0.5 * G * 0.09).abs() < 1e-4, "forced: {is_forced}, {fallen}");
    }
}

/// A block at rest that a force lifts from some time on.
#[test]
fn what_is_lifted_rises_from_rest() {
    let mut m = model("lift", 0.5, 0.1);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.bodies.push(solid("block", [0.0, 0.0, 0.5], [1.0; 3]));
    let force_n = [0.0, 0.0, 2.0 * G * m.bodies[0].mass_kg];
    m.forces.push(Force::Force {
        id: "lift".into(),
        body: "block".into(),
        point_m: [0.0, 0.0, 0.5],
        force_n,
        from_to_s: Some([0.2, 1.0]),
    });
    let result = simulate(&m).unwrap();
    for (t, frame) in result.times_s.iter().zip(&result.frames) {
        let known = 0.5 * G * (t - 0.2).max(0.0).powi(2);
        let risen = frame.position_m[0][2] - 0.5;
        assert!((risen - known).abs() < 1e-6, "{t} s: {risen} {known}");
    }
}

/// Stiff springs beside a force, with a tolerance that lets the leapfrog run past their vibrations, which are all the energy that there is.
#[test]
fn vibrations_that_a_coarse_tolerance_does_not_resolve_are_run_anew() {
    use fallwerk::mbs::run::{REPEATED, simulate_carefully};
    let mut m = model("anchor", 0.2, 0.02);
    m.gravity_m_s2 = [0.0; 3];
    m.settings.tolerance = 1e-3;
    m.bodies.push(solid("mass", [0.0; 3], [0.7; 3]));
    let elastic = elastic(1e8);
    m.bushings.push(joint("anchor", None, "mass", [0.0; 3], 1e9, 1e8, [elastic.clone(), elastic]));
    m.forces.push(Force::Force {
        id: "pull".into(),
        body: "mass".into(),
        point_m: [0.0; 3],
        force_n: [0.0, 0.0, 1e5],
        from_to_s: None,
    });
    assert!(simulate(&m).is_err());
    let result = simulate_carefully(&m).unwrap();
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
    assert!(result.warnings.iter().any(|w| w.starts_with(REPEATED)), "{:?}", result.warnings);
}

/// A box between a wall and a plate that a force presses on it, the force being carried through: neither is an impact, and the wall's joint bears all of it at every output. Friction holds it up.
#[test]
fn what_is_pressed_together_is_not_struck() {
    for friction in [0.0, 0.5] {
        let mut m = model("pressed", 0.1, 0.01);
        m.gravity_m_s2 = [0.0, 0.0, if friction > 0.0 { -G } else { 0.0 }];
        let light = |b: Body, mass_kg: f64| {
            let share = mass_kg / b.mass_kg;
            Body { mass_kg, inertia_kg_m2: b.inertia_kg_m2.map(|r| r.map(|v| v * share)), ..b }
        };
        m.bodies.push(light(solid("wall", [-0.1, 0.0, 0.0], [0.2, 3.0, 3.0]), 50.0));
        m.bodies.push(light(solid("box", [0.2, 0.0, 0.0], [0.4; 3]), 9.0));
        m.bodies.push(light(solid("plate", [0.5, 0.0, 0.0], [0.2, 0.2, 3.0]), 5.0));
        m.joints.push(ideal("wall", JointKind::Fixed, None, "wall", [0.0; 3]));
        let mut guide = ideal("guide", JointKind::Prismatic, None, "plate", [0.5, 0.0, 0.0]);
        guide.axis = Some([1.0, 0.0, 0.0]);
        m.joints.push(guide);
        m.forces.push(force("press", "plate", [0.5, 0.0, 0.0], [-100.0, 0.0, 0.0]));
        m.contact.bodies = Some(BodyContact { friction, restitution: 0.0 });
        m.settings.reactions = true;
        let result = simulate(&m).unwrap();
        assert!(result.warnings.is_empty() && result.steps < 700, "{}: {:?}", result.steps, result.warnings);
        let forces = &result.reactions[0].force_n[2..];
        println!(
            "friction {friction}: {} steps, the wall bears {:.2?} N",
            result.steps,
            forces.last().unwrap()
        );
        for force in forces {
            assert!((force[0].abs() - 100.0).abs() < 1.0, "{friction}: {forces:?}");
        }
        let weight: f64 = m.bodies.iter().map(|b| b.mass_kg).sum::<f64>() * G;
        for i in 2..result.times_s.len() {
            let up: f64 = result.reactions.iter().map(|r| r.force_n[i][2]).sum();
            let due = if friction > 0.0 { weight } else { 0.0 };
            assert!((up.abs() - due).abs() < 0.01 * weight, "{friction}: {up} N of {due} N");
        }
    }
}

/// The only energy of a block that a force presses on the ground is what the force adds to it in half a step.
#[test]
fn reactions_of_a_block_at_rest_do_not_stop_the_run() {
    let mut m = model("pressed", 0.1, 0.01);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies.push(solid("block", [0.0, 0.0, 0.1], [0.2; 3]));
    let mut guide = ideal("guide", JointKind::Prismatic, None, "block", [0.0, 0.0, 0.1]);
    guide.axis = Some([0.0, 0.0, 1.0]);
    m.joints.push(guide);
    m.forces.push(force("press", "block", [0.0, 0.0, 0.1], [0.0, 0.0, -100.0]));
    m.contact.planes.push(ObstaclePlane {
        id: "floor".into(),
        point_m: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        friction: 0.5,
        restitution: 0.0,
    });
    m.settings.reactions = true;
    let result = simulate(&m).unwrap();
    assert!(result.warnings.is_empty() && result.energy_growth < 1e-9, "{:?}", result.warnings);
}
