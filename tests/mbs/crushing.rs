//! Faces that are crushed by what they strike, against the work and the impulse of their resistance.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::RunResult;
use fallwerk::mbs::simulate;

const SPEED_M_S: f64 = 8.0;
/// A column of 400 mm by 400 mm, 3 m long, and what its concrete bears at 10.5 MPa.
const SIZE: [f64; 3] = [0.4, 0.4, 3.0];
const FORCE_N: f64 = 10.5e6 * 0.16;

fn face(body: &str, face: Face, force_n: &[[f64; 2]]) -> CrushedFace {
    CrushedFace {
        body: body.into(),
        shape: 0,
        face,
        force_n: force_n.to_vec(),
        rate_factor: None,
        subsystem: None,
    }
}

/// A column of so many tonnes more than its own above flat ground that its foot strikes at `t = 0` at a speed.
fn falling(mass_kg: f64, force_n: &[[f64; 2]], step_s: Option<f64>) -> Model {
    let mut m = model("crushing", 0.6, 0.005);
    m.settings.time_step_s = step_s;
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: RESTITUTION });
    let mut column = solid("column", [0.0, 0.0, 1.5], SIZE);
    column.mass_kg = mass_kg;
    column.inertia_kg_m2 = box_inertia(mass_kg, SIZE);
    column.velocity_m_s = [0.0, 0.0, -SPEED_M_S];
    m.bodies.push(column);
    m.contact.crushing.push(face("column", Face::LowZ, force_n));
    m
}

fn depth(result: &RunResult) -> f64 {
    *result.crushed[0].depth_m.last().unwrap()
}

#[test]
fn a_foot_is_crushed_as_deep_as_its_resistance_takes_up_the_fall() {
    // F s = m v²/2 + m g s, over in v / (F/m - g)
    let mass = 20e3;
    let expected = SPEED_M_S * SPEED_M_S / (2.0 * (FORCE_N / mass - G));
    let time = SPEED_M_S / (FORCE_N / mass - G);
    for step_s in [4e-3, 2e-3, 1e-3, 0.5e-3] {
        let result = simulate(&falling(mass, &[[0.0, FORCE_N]], Some(step_s))).unwrap();
        println!("step {step_s}: {:.6} m ({expected:.6})", depth(&result));
        // what is left of the last step: the speed that the force takes in a step, for half of one
        assert!((depth(&result) - expected).abs() < 0.5 * (FORCE_N / mass - G) * step_s * step_s);
        let work = result.crushed[0].energy_j.last().unwrap();
        assert!((work / (FORCE_N * depth(&result)) - 1.0).abs() < 3e-3, "{work}");
        assert!(result.energy_error < 1e-9);
        let height = result.frames.last().unwrap().position_m[0][2];
        assert!((height - (1.5 - depth(&result))).abs() < 2e-4, "{height}: it stands on what is left of it");
        let still = result.times_s.iter().position(|t| *t > time + 2.0 * step_s + 0.005).unwrap();
        assert_eq!(result.crushed[0].depth_m[still], depth(&result), "nothing is crushed once it stands");
    }
}

/// What looks at results sees boxes as short as they are: nothing is in the ground.
#[test]
fn boxes_of_results_are_as_short_as_they_were_crushed() {
    let mut m = falling(20e3, &[[0.0, FORCE_N]], None);
    // the same with its axis along x of the box, against it
    let Shape::Box { half_extents_m, orientation, .. } = &mut m.bodies[0].shapes[0] else { panic!() };
    (half_extents_m[0], half_extents_m[2]) = (1.5, 0.2);
    *orientation = Some([0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt(), 0.0]);
    m.contact.crushing[0].face = Face::HighX;
    let result = simulate(&m).unwrap();
    assert!(depth(&result) > 0.3, "{}", depth(&result));
    for (output, frame) in result.frames.iter().enumerate() {
        let mut shape = m.bodies[0].shapes[0].clone();
        result.crushed[0].shorten(&mut shape, output);
        let foot =
            shape.corners().iter().map(|c| c[2]).fold(f64::INFINITY, f64::min) + frame.position_m[0][2];
        assert!(foot.abs() < 1e-3 || foot > 0.0, "{output}: {foot}");
    }
    let seen = fallwerk::bench::passing::passing(&m, &result);
    println!("{:?}", seen.ground);
    assert!(seen.ground.depth_m < 1e-3);
}

#[test]
fn the_time_of_the_touch_within_a_step_counts() {
    // from 3 cm above the ground: the speed at the touch by free fall, the depth as before
    let mass = 20e3;
    for gap in [0.0301, 0.0317, 0.0333] {
        let mut m = falling(mass, &[[0.0, FORCE_N]], Some(2e-3));
        m.bodies[0].position_m[2] += gap;
        let result = simulate(&m).unwrap();
        let square = SPEED_M_S * SPEED_M_S + 2.0 * G * gap;
        let expected = square / (2.0 * (FORCE_N / mass - G));
        println!("gap {gap}: {:.6} m ({expected:.6})", depth(&result));
        assert!((depth(&result) / expected - 1.0).abs() < 5e-4);
    }
}

#[test]
fn a_resistance_that_grows_or_falls_takes_up_its_work() {
    // m v²/2 + m g s = F0 s + k s²/2
    let mass = 10e3;
    for k in [20e6, -3e6] {
        let curve = [[0.0, FORCE_N], [0.3, FORCE_N + 0.3 * k]];
        let at = |step_s: f64| depth(&simulate(&falling(mass, &curve, Some(step_s))).unwrap());
        let [a, b, c] = [0.5 * k, FORCE_N - mass * G, -0.5 * mass * SPEED_M_S * SPEED_M_S];
        let expected = 2.0 * -c / (b + (b * b - 4.0 * a * c).sqrt());
        let errors = [1e-3, 0.5e-3, 0.25e-3].map(|step_s| at(step_s) / expected - 1.0);
        println!("slope {k:.0e}: {expected:.6} m, errors {errors:?}");
        assert!(expected < 0.3);
        assert!(errors[2].abs() < 5e-5);
    }
}

#[test]
fn an_edge_bears_half_and_a_corner_a_quarter() {
    // bodies that hardly turn, tilted by 10 degrees
    let mass = 2e3;
    let half = 5.0_f64.to_radians();
    let [c, s] = [half.cos(), half.sin()];
    for (turn, share) in [([c, s, 0.0, 0.0], 0.5), ([c, s * 0.5_f64.sqrt(), s * 0.5_f64.sqrt(), 0.0], 0.25)] {
        let mut m = falling(mass, &[[0.0, FORCE_N]], Some(0.5e-3));
        m.bodies[0].orientation = turn;
        m.bodies[0].inertia_kg_m2 = [[1e9, 0.0, 0.0], [0.0, 1e9, 0.0], [0.0, 0.0, 1e9]];
        let result = simulate(&m).unwrap();
        let expected = SPEED_M_S * SPEED_M_S / (2.0 * (share * FORCE_N / mass - G));
        let fall = 1.5 - result.frames.last().unwrap().position_m[0][2];
        println!("share {share}: {fall:.6} m ({expected:.6})");
        assert!((fall / expected - 1.0).abs() < 5e-4);
        // along the axis of the column
        assert!((depth(&result) * (2.0 * half).cos() / expected - 1.0).abs() < 2e-3);
    }
}

#[test]
fn of_two_that_meet_the_weaker_one_is_crushed() {
    // ends against each other in space: they go on together, and F s is the kinetic energy of the relative motion
    let mut m = model("two", 0.3, 0.005);
    m.gravity_m_s2 = [0.0; 3];
    m.settings.time_step_s = Some(1e-4);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: RESTITUTION });
    for (id, z, v) in [("low", 0.0, 2.0), ("high", 3.01, -6.0)] {
        let mut body = solid(id, [0.0, 0.0, z], SIZE);
        body.velocity_m_s = [0.0, 0.0, v];
        m.bodies.push(body);
    }
    m.contact.crushing.push(face("low", Face::HighZ, &[[0.0, 1.1 * FORCE_N]]));
    m.contact.crushing.push(face("high", Face::LowZ, &[[0.0, FORCE_N]]));
    let result = simulate(&m).unwrap();
    let mass = m.bodies[0].mass_kg;
    let expected = 0.5 * (0.5 * mass) * 64.0 / FORCE_N;
    let last = result.frames.last().unwrap();
    let crushed: Vec<f64> = result.crushed.iter().map(|c| *c.depth_m.last().unwrap()).collect();
    println!("crushed {crushed:?} ({expected:.6})");
    assert_eq!(crushed[0], 0.0);
    assert!((crushed[1] / expected - 1.0).abs() < 1e-3);
    assert!((last.position_m[1][2] - last.position_m[0][2] - (3.0 - crushed[1])).abs() < 2e-4);
    let sum = last.position_m[0][2] + last.position_m[1][2];
    assert!((sum - (3.01 - 4.0 * m.settings.end_time_s)).abs() < 1e-9, "momentum");
}

#[test]
fn what_bears_all_of_it_is_not_crushed() {
    // a resistance that is never reached changes nothing but the rebound
    let mut stiff = falling(2e3, &[[0.0, 1e12]], None);
    stiff.contact.ground.as_mut().unwrap().restitution = 0.0;
    // a step that is given: without one, impacts of few rigid bodies are located in time
    stiff.settings.time_step_s = Some(1e-3);
    let mut rigid = stiff.clone();
    rigid.contact.crushing.clear();
    let [stiff, rigid] = [stiff, rigid].map(|m| simulate(&m).unwrap());
    assert_eq!(stiff.frames, rigid.frames);
    assert_eq!(stiff.energies, rigid.energies);
    assert_eq!(depth(&stiff), 0.0);
}

#[test]
fn a_body_that_parts_keeps_what_was_crushed() {
    // two halves of a column, one behind the other, that an event parts while the lower one is being crushed
    let mut m = falling(20e3, &[[0.0, FORCE_N]], Some(1e-3));
    let whole = m.bodies.remove(0);
    for (id, z) in [("low", 0.75), ("high", 2.25)] {
        let size = [0.4, 0.4, 1.5];
        let mut half = solid(id, [0.0, 0.0, z], size);
        (half.mass_kg, half.inertia_kg_m2) = (10e3, box_inertia(10e3, size));
        half.velocity_m_s = whole.velocity_m_s;
        m.bodies.push(half);
    }
    m.contact.crushing[0].body = "low".into();
    let mut section =
        joint("section", Some("low"), "high", [0.0, 0.0, 1.5], 1e9, 1e8, [elastic(1e8), elastic(1e8)]);
    section.latent = Some("middle".into());
    m.bushings.push(section);
    let expected = SPEED_M_S * SPEED_M_S / (2.0 * (FORCE_N / 20e3 - G));
    let held = simulate(&m).unwrap();
    println!("held: {:.6} m ({expected:.6})", depth(&held));
    assert!((depth(&held) / expected - 1.0).abs() < 1e-4);
    m.events.push(Event { release: vec!["section".into()], ..Event::at("cut", 0.05) });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    let cut = simulate(&m).unwrap();
    let at = |result: &RunResult, time_s: f64| {
        let k = result.times_s.iter().position(|t| (t - time_s).abs() < 1e-9).unwrap();
        result.crushed[0].depth_m[k]
    };
    println!("cut: {:.6} m at 50 ms, {:.6} m at the end", at(&cut, 0.05), depth(&cut));
    assert_eq!(at(&cut, 0.05), at(&held, 0.05));
    assert!(at(&cut, 0.055) > at(&cut, 0.05) && depth(&cut) > at(&cut, 0.055));
    assert!(cut.energy_error < 1e-4, "{}", cut.energy_error);
}

#[test]
fn no_more_is_crushed_than_there_is() {
    // a resistance that cannot take the fall up: a tenth of the box is left as rubble that bears
    let result = simulate(&falling(20e3, &[[0.0, 1e4]], Some(1e-3))).unwrap();
    println!("depth {}", depth(&result));
    assert!((depth(&result) - 2.7).abs() < 0.05);
    assert!(result.energy_error < 1e-9);
}

#[test]
fn wrong_curves_are_refused_with_their_place() {
    let refused = |change: fn(&mut CrushedFace), what: &str| {
        let mut m = falling(2e3, &[[0.0, FORCE_N]], None);
        change(&mut m.contact.crushing[0]);
        let error = simulate(&m).unwrap_err().to_string();
        assert!(error.contains(what), "{error}");
    };
    refused(
        |f| f.force_n.clear(),
        "contact.crushing[0].force_n: is empty, expected [0, a positive force] first",
    );
    refused(|f| f.force_n[0][0] = 0.1, "contact.crushing[0].force_n: starts with [0.1, ");
    refused(|f| f.force_n.push([0.0, 1.0]), "contact.crushing[0].force_n[1][0]: is 0, expected more");
    refused(|f| f.force_n.push([0.1, -1.0]), "contact.crushing[0].force_n[1][1]");
    refused(|f| f.shape = 1, "contact.crushing[0].shape: is 1, which is not there");
    refused(|f| f.body = "colum".into(), "column");
    let mut m = falling(2e3, &[[0.0, FORCE_N]], None);
    m.contact.crushing.push(m.contact.crushing[0].clone());
    let error = simulate(&m).unwrap_err().to_string();
    assert!(error.contains("contact.crushing[1]: names the same face as contact.crushing[0]"), "{error}");
}
