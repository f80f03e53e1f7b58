//! Contact: friction, restitution, stacks, no tunnelling.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::{SolverOptions, simulate, simulate_with};
use fallwerk::verify::mbs::pile;

fn on_ground(name: &str, end_s: f64, friction: f64) -> Model {
    let mut m = model(name, end_s, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction, restitution: RESTITUTION });
    m
}

#[test]
fn sliding_box_stops_where_coulomb_says() {
    let mut m = on_ground("slide", 1.5, 0.5);
    let mut body = solid("box", [0.0, 0.0, 0.2], [1.0, 1.0, 0.4]);
    body.velocity_m_s = [3.0, 4.0, 0.0];
    m.bodies.push(body);
    let result = simulate(&m).unwrap();
    let x = result.frames.last().unwrap().position_m[0];
    let distance = x[0].hypot(x[1]);
    println!("sliding box: {distance:.6} m (2.548420), energy error {:.1e}", result.energy_error);
    assert!((distance - 2.548419980).abs() < 1e-5);
    assert!((x[1] / x[0] - 4.0 / 3.0).abs() < 1e-6);
    assert!(result.energy_error < 1e-9);
    let friction = result.energies.friction_j.last().unwrap();
    assert!((friction / (0.5 * 1000.0 * 25.0) - 1.0).abs() < 1e-5, "{friction}");
}

#[test]
fn box_on_an_incline_slides_or_stays() {
    let tilt = 30.0_f64.to_radians();
    for (friction, expected) in [(0.3, G * (tilt.sin() - 0.3 * tilt.cos())), (0.6, 0.0)] {
        let mut m = on_ground("incline", 1.0, friction);
        m.gravity_m_s2 = [G * tilt.sin(), 0.0, -G * tilt.cos()];
        m.bodies.push(solid("box", [0.0, 0.0, 0.2], [1.0, 1.0, 0.4]));
        let result = simulate(&m).unwrap();
        let travelled = result.frames.last().unwrap().position_m[0][0];
        println!("incline, friction {friction}: {travelled:.6} m ({:.6})", 0.5 * expected);
        assert!((travelled - 0.5 * expected).abs() < 5e-5);
    }
}

/// Two blocks on a stiff spring bounce: within a step the ground turns the lower one back, whose displacement strains the spring. A leapfrog conserves the energy less what forces add in half a step, which is positive: so no sum of energies
/// is below that at the start, and without that part none is above it.
#[test]
fn an_impact_within_a_step_strains_springs_for_what_it_books() {
    let mut m = model("bounce", 1.0, 1e-3);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.0, restitution: 1.0 });
    m.bodies.push(solid("lower", [0.0, 0.0, 0.7], [0.4; 3]));
    m.bodies.push(solid("upper", [0.0, 0.0, 1.7], [1.0; 3]));
    let ends = [elastic(1e9), elastic(1e9)];
    let spring = joint("spring", Some("lower"), "upper", [0.0, 0.0, 1.0], 2e8, 1e9, ends);
    m.bushings.push(Bushing { shear_stiffness_n_m: [1e9; 2], ..spring });
    let result = simulate(&m).unwrap();
    println!("error {:.1e}, growth {:.1e}", result.energy_error, result.energy_growth);
    assert!(result.first_ground_contact_s.is_some());
    assert!(result.energies.joints_elastic_j.iter().cloned().fold(0.0, f64::max) > 1e2);
    assert!(result.energy_growth < 1e-6, "{}", result.energy_growth);
    let e = &result.energies;
    let least = (0..result.times_s.len()).map(|i| e.total_j(i) - e.total_j(0)).fold(0.0, f64::min);
    let turned = e.kinetic_j.iter().cloned().fold(0.0, f64::max);
    println!("{least} J of {turned}");
    assert!(least > -1e-6 * turned, "{least} J of {turned}");
}

#[test]
fn dropped_box_rebounds_with_its_restitution() {
    for (restitution, tolerance) in [(1.0, 2e-4), (0.5, 2e-4), (0.1, 1e-3)] {
        let mut m = on_ground("bounce", 1.2, 0.5);
        m.bodies.push(solid("box", [0.0, 0.0, 1.2], [0.4, 0.4, 0.4]));
        m.contact.ground.as_mut().unwrap().restitution = restitution;
        let result = simulate(&m).unwrap();
        let heights: Vec<f64> = result.frames.iter().map(|f| f.position_m[0][2] - 0.2).collect();
        let hit = heights.iter().position(|h| *h < 0.02).unwrap();
        let rebound = heights[hit + 5..].iter().copied().fold(0.0, f64::max);
        println!(
            "restitution {restitution}: rebound {rebound:.4} m, energy error {:.1e}",
            result.energy_error
        );
        assert!((rebound.sqrt() - restitution).abs() < tolerance);
    }
}

/// Boxes in a row, equal and a tenth of a metre apart, the first one on its way: each one hits the next with all corners at once, also where a step ends just then. Newton's
/// law gives the velocities, impact by impact.
#[test]
fn faces_in_a_row_hand_on_what_newton_says() {
    for (count, restitution) in [(3, 0.5), (4, 1.0), (5, 0.8), (4, 0.5)] {
        let mut m = model("row", 2.0, 0.01);
        m.gravity_m_s2 = [0.0; 3];
        m.contact.bodies = Some(BodyContact { friction: 0.3, restitution });
        for k in 0..count {
            m.bodies.push(solid(&format!("b{k}"), [1.1 * f64::from(k), 0.0, 0.5], [1.0; 3]));
        }
        m.bodies[0].velocity_m_s = [2.0, 0.0, 0.0];
        let expected = row_of_impacts(count as usize, restitution, 2.0);
        let result = simulate(&m).unwrap();
        let [before, after] = [2, 1].map(|back| &result.frames[result.frames.len() - back]);
        for (b, expected) in expected.iter().enumerate() {
            let speed = (after.position_m[b][0] - before.position_m[b][0]) / 0.01;
            println!("{count} boxes, restitution {restitution}: {speed:.6} ({expected:.6})");
            assert!((speed - expected).abs() < 1e-5, "{count}, {restitution}: {speed} {expected}");
            assert!((after.orientation[b][0] - 1.0).abs() < 1e-12, "{:?}", after.orientation[b]);
        }
        assert!(result.energies.total_j(200) / result.energies.total_j(0) - 1.0 < 1e-9);
    }
}

/// Velocities of equal boxes a tenth of a metre apart after some seconds, the first at 2 m/s.
fn row_of_impacts(count: usize, restitution: f64, end_s: f64) -> Vec<f64> {
    let (mut v, mut gap) = (vec![0.0_f64; count], vec![0.1_f64; count - 1]);
    v[0] = 2.0;
    let mut left_s = end_s;
    loop {
        let closing = (0..count - 1).filter(|i| v[*i] - v[i + 1] > 1e-12);
        let Some((time, i)) =
            closing.map(|i| (gap[i] / (v[i] - v[i + 1]), i)).min_by(|a, b| a.0.total_cmp(&b.0))
        else {
            return v;
        };
        if time > left_s {
            return v;
        }
        left_s -= time;
        (0..count - 1).for_each(|k| gap[k] -= time * (v[k] - v[k + 1]));
        gap[i] = 0.0;
        let [mean, half] = [0.5 * (v[i] + v[i + 1]), 0.5 * restitution * (v[i] - v[i + 1])];
        (v[i], v[i + 1]) = (mean - half, mean + half);
    }
}

#[test]
fn a_stack_of_three_stays_at_rest() {
    let mut m = on_ground("stack", 3.0, 0.5);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: RESTITUTION });
    for i in 0..3 {
        m.bodies.push(solid(
            &format!("box{i}"),
            [0.02 * f64::from(i), 0.0, 0.2 + 0.4 * f64::from(i)],
            [0.6, 0.5, 0.4],
        ));
    }
    let result = simulate(&m).unwrap();
    let (first, last) = (&result.frames[0], result.frames.last().unwrap());
    for i in 0..3 {
        for k in 0..3 {
            let moved = (last.position_m[i][k] - first.position_m[i][k]).abs();
            assert!(moved < 1e-4, "box {i}, axis {k}: {moved}");
        }
    }
    // Velocities at outputs are those before the impulses of the step: half a step of gravity.
    let kinetic = result.energies.kinetic_j.last().unwrap();
    println!("stack: kinetic energy {kinetic:.1e} J at the end");
    assert!(*kinetic < 0.5 * 900.0 * (0.6e-3 * G).powi(2));
}

/// Heavy blocks on light ones, and long steps: what sweeps leave unsettled lets them creep by a millimetre a second, and is small beside what the blocks weigh.
#[test]
fn stacks_of_uneven_blocks_are_no_reason_to_stop() {
    for (masses, step_s) in
        [(&[1.0, 2.0, 4.0, 8.0][..], 2e-3), (&[100.0; 10], 2e-3), (&[1.0, 10.0, 1.0, 10.0], 2e-3)]
    {
        let mut m = on_ground("stack", 3.0, 0.5);
        m.contact.ground.as_mut().unwrap().restitution = 0.0;
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
        m.settings.time_step_s = Some(step_s);
        for (k, mass_kg) in masses.iter().enumerate() {
            let block = solid(&format!("b{k}"), [0.0, 0.0, 0.2 + 0.4 * k as f64], [0.4; 3]);
            m.bodies.push(Body {
                mass_kg: *mass_kg,
                inertia_kg_m2: box_inertia(*mass_kg, [0.4; 3]),
                ..block
            });
        }
        let result = simulate(&m).unwrap();
        let [from, to] = [&result.frames[0], result.frames.last().unwrap()];
        let moved = |i: usize| {
            (0..3).map(|k| (to.position_m[i][k] - from.position_m[i][k]).powi(2)).sum::<f64>().sqrt()
        };
        let most = (0..masses.len()).map(moved).fold(0.0, f64::max);
        println!("{masses:?}: {:.2} mm", 1e3 * most);
        assert!(most < 5e-3, "{masses:?}: {most}");
    }
}

#[test]
fn slabs_at_ten_metres_per_second_do_not_pass_through() {
    let mut m = on_ground("slabs", 0.6, 0.5);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: RESTITUTION });
    m.contact.obstacles.push(ObstacleBox {
        id: "plinth".into(),
        min_m: [-1.0, -1.0, 0.0],
        max_m: [1.0, 1.0, 0.5],
        friction: 0.5,
        restitution: RESTITUTION,
    });
    m.settings.output_interval_s = 5e-4;
    m.settings.time_step_s = Some(5e-4);
    for (i, z) in [0.7, 1.2].into_iter().enumerate() {
        let mut slab = solid(&format!("slab{i}"), [0.0, 0.0, z], [6.4, 5.4, 0.25]);
        slab.velocity_m_s = [0.0, 0.0, -10.0];
        m.bodies.push(slab);
    }
    let result = simulate(&m).unwrap();
    let lowest = |i: usize| result.frames.iter().map(|f| f.position_m[i][2]).fold(f64::INFINITY, f64::min);
    let gap =
        result.frames.iter().map(|f| f.position_m[1][2] - f.position_m[0][2]).fold(f64::INFINITY, f64::min);
    println!("slabs: deepest {:.4} m below contact, {:.4} m into each other", 0.625 - lowest(0), 0.25 - gap);
    assert!(0.625 - lowest(0) < 1e-3 && 0.25 - gap < 1e-3);
    assert_eq!(result.events.len(), 2, "{:?}", result.events);
}

#[test]
fn box_tumbling_off_an_edge_keeps_its_energy_balance() {
    let mut m = on_ground("tumble", 3.0, 0.4);
    m.contact.obstacles.push(ObstacleBox {
        id: "step".into(),
        min_m: [-2.0, -2.0, 0.0],
        max_m: [0.0, 2.0, 1.0],
        friction: 0.4,
        restitution: RESTITUTION,
    });
    let mut body = solid("box", [-0.3, 0.1, 1.45], [0.8, 0.6, 0.9]);
    body.velocity_m_s = [1.5, 0.3, 0.0];
    body.angular_velocity_rad_s = [0.3, 1.0, 0.2];
    m.bodies.push(body);
    let result = simulate(&m).unwrap();
    let z = result.frames.last().unwrap().position_m[0][2];
    println!("tumbling box: rests at z = {z:.4} m, energy error {:.2e}", result.energy_error);
    assert!(z > 0.29 && z < 0.46);
    assert!(result.energy_error < 1e-4);
    assert!(result.first_ground_contact_s.is_some());
}

#[test]
fn falling_far_from_everything_costs_no_contact() {
    let mut m = on_ground("far", 0.5, 0.4);
    m.bodies.push(solid("box", [0.0, 0.0, 10.0], [1.0; 3]));
    let result = simulate(&m).unwrap();
    let exact = 10.0 - 0.5 * G * 0.25;
    assert!((result.frames.last().unwrap().position_m[0][2] - exact).abs() < 1e-9);
    assert!(result.first_ground_contact_s.is_none() && result.energy_error < 1e-9);
}

#[test]
fn spheres_hulls_planes_and_pair_rules_do_what_the_file_says() {
    let mut m = on_ground("shapes", 2.0, 0.5);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m.contact.planes.push(ObstaclePlane {
        id: "wall".into(),
        point_m: [3.0, 0.0, 0.0],
        normal: [-2.0, 0.0, 0.0],
        friction: 0.0,
        restitution: 0.0,
    });
    let mut ball = solid("ball", [0.0, 0.0, 0.5], [1.0; 3]);
    ball.shapes = vec![Shape::Sphere { center_m: [0.0; 3], radius_m: 0.5 }];
    ball.velocity_m_s = [8.0, 0.0, 0.0];
    let mut hull = solid("hull", [0.0, 5.0, 0.6], [1.0; 3]);
    hull.shapes = vec![Shape::Hull { points_m: Shape::cuboid([0.0; 3], [0.5; 3]).corners() }];
    let turned = Shape::Box {
        center_m: [0.0; 3],
        half_extents_m: [0.5, 0.5, 0.3],
        orientation: Some([0.5_f64.sqrt(), 0.5_f64.sqrt(), 0.0, 0.0]),
    };
    let mut plank = solid("plank", [0.0, 5.0, 1.7], [1.0; 3]);
    plank.shapes = vec![turned];
    m.bodies.extend([ball, hull, plank, solid("ghost", [0.0, -5.0, 0.4], [1.0, 1.0, 0.4])]);
    m.contact.pairs.push(PairRule {
        a: "ghost".into(),
        b: "ground".into(),
        ignore: true,
        friction: None,
        restitution: None,
        rolling_m: None,
    });
    m.contact.pairs.push(PairRule {
        a: "ball".into(),
        b: "wall".into(),
        ignore: false,
        friction: None,
        restitution: Some(1.0),
        rolling_m: None,
    });
    let result = simulate(&m).unwrap();
    let highest = result.frames.iter().map(|f| f.position_m[0][0]).fold(0.0, f64::max);
    let end = &result.frames.last().unwrap().position_m;
    assert!(highest <= 2.5 + 1e-9 && end[0][0] < 1.0, "{highest}, {:?}", end[0]);
    assert!((end[0][2] - 0.5).abs() < 1e-4, "the ball rolls on the ground: {:?}", end[0]);
    assert!((end[1][2] - 0.5).abs() < 2e-4, "the hull lies on its face: {:?}", end[1]);
    assert!((end[2][2] - 1.5).abs() < 4e-4, "the turned box stands on its edge, 0.5 m high: {:?}", end[2]);
    assert!(end[3][2] < -15.0, "the ghost falls through: {:?}", end[3]);
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

#[test]
fn a_heavy_block_comes_to_rest_on_a_light_one() {
    for ratio in [1e2, 1e3] {
        let mut m = on_ground("heavy on light", 1.0, 0.5);
        m.bodies.push(solid("light", [0.0, 0.0, 0.26], [0.5; 3]));
        m.bodies.push(solid("heavy", [0.01, 0.0, 0.78], [0.5; 3]));
        let light = &mut m.bodies[0];
        light.mass_kg /= ratio;
        light.inertia_kg_m2.iter_mut().flatten().for_each(|i| *i /= ratio);
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
        let result = simulate(&m).unwrap();
        assert!(result.warnings.is_empty(), "{ratio}: {:?}", result.warnings);
        let end = result.frames.last().unwrap();
        // two centimetres of fall for the light one, four for the heavy one; impulses are plastic
        let places = [end.position_m[0][2] - 0.25, end.position_m[1][2] - 0.75];
        println!("mass ratio {ratio}: gaps {places:.6?} m");
        assert!(places.iter().all(|z| z.abs() < 2e-4), "{ratio}: {places:?}");
        // what contacts have taken they keep
        let e = &result.energies;
        let taken: Vec<f64> = e.contact_damping_j.iter().zip(&e.friction_j).map(|(a, b)| a + b).collect();
        let mut most = 0.0_f64;
        for taken in taken {
            most = most.max(taken);
            assert!(most - taken < 1e-3 * m.bodies[1].mass_kg * G * 0.04, "{ratio}: {most} {taken}");
        }
    }
}

/// A ball with unequal moments of inertia that rolls and spins: friction turns its angular momentum and does no work.
#[test]
fn friction_does_no_work_on_a_ball_that_rolls() {
    let mut m = on_ground("roll", 3.0, 1.0);
    let mut ball = solid("ball", [0.0, 0.0, 0.2], [0.4; 3]);
    (ball.mass_kg, ball.shapes) = (3.0, vec![Shape::Sphere { center_m: [0.0; 3], radius_m: 0.2 }]);
    ball.inertia_kg_m2 = [[0.04, 0.0, 0.0], [0.0, 0.04, 0.0], [0.0, 0.0, 0.02]];
    (ball.velocity_m_s, ball.angular_velocity_rad_s) = ([0.0, -0.6, 0.0], [3.0, 0.0, 10.0]);
    m.bodies.push(ball);
    m.settings.time_step_s = Some(1e-3);
    let result = simulate(&m).unwrap();
    let done_j = result.energies.friction_j.last().unwrap();
    assert!(done_j.abs() < 1e-5, "{done_j}");
    assert!(result.energy_error < 1e-6, "{}", result.energy_error);
}

/// What sweeps leave to the next step rocks a stack, the more so the longer the step: of 16 runs whose gravity differs by 1e-6 the topmost cube moves by up to 0.4, 2.2 and 4.6 mm.
#[test]
fn a_stack_stands_at_long_steps() {
    for step_s in [2e-3, 5e-3, 1e-2] {
        let mut m = on_ground("stack", 5.0, 0.5);
        for i in 0..10 {
            m.bodies.push(solid(&format!("cube{i}"), [0.0, 0.0, 0.2 + 0.4 * f64::from(i)], [0.4; 3]));
        }
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
        m.settings.time_step_s = Some(step_s);
        let result = simulate(&m).unwrap();
        assert!(result.warnings.is_empty(), "{step_s}: {:?}", result.warnings);
        let off = |p: [f64; 3]| (p[0] * p[0] + p[1] * p[1] + (p[2] - 3.8).powi(2)).sqrt();
        let most = result.frames.iter().map(|f| off(f.position_m[9])).fold(0.0, f64::max);
        println!("step {:.0} ms: the topmost of ten cubes moves by {:.2} mm", 1e3 * step_s, 1e3 * most);
        assert!(most < 0.6 * step_s, "{step_s}: {most}");
    }
}

/// Bodies of which ideal joints link points are solved without conjugate directions, those beside them are not.
#[test]
fn a_block_on_joints_leaves_a_heavy_one_on_a_light_one_alone() {
    let mut m = on_ground("heavy on light", 0.5, 0.5);
    m.bodies.push(solid("light", [0.0, 0.0, 0.25], [0.5; 3]));
    m.bodies.push(solid("heavy", [0.0, 0.0, 0.75], [0.5; 3]));
    let light = &mut m.bodies[0];
    light.mass_kg /= 1e4;
    light.inertia_kg_m2.iter_mut().flatten().for_each(|i| *i /= 1e4);
    m.bodies.push(solid("flap", [5.0, 0.0, 0.25], [1.0, 0.5, 0.5]));
    let mut pin = ideal("pin", JointKind::Revolute, None, "flap", [4.5, 0.0, 0.25]);
    pin.axis = Some([0.0, 1.0, 0.0]);
    m.joints.push(pin);
    m.contact.obstacles.push(ObstacleBox {
        id: "step".into(),
        min_m: [5.0, -1.0, -1.0],
        max_m: [6.0, 1.0, 0.0],
        friction: 0.5,
        restitution: 0.0,
    });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    let result = simulate(&m).unwrap();
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
    let end = &result.frames.last().unwrap().position_m;
    let places = [end[0][2] - 0.25, end[1][2] - 0.75, end[2][2] - 0.25];
    println!("{places:.6?} m, {} steps", result.steps);
    assert!(places.iter().all(|z| z.abs() < 1e-4), "{places:?}");
}

#[test]
fn what_is_skipped_changes_nothing() {
    // blocks that fall from different heights, some of them fast and turning, onto a tower and the ground
    let mut m = on_ground("skip", 1.2, 0.5);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: RESTITUTION });
    for k in 0..4 {
        m.bodies.push(solid(&format!("tower{k}"), [0.0, 0.0, 0.5 + 0.42 * f64::from(k)], [0.6, 0.6, 0.4]));
    }
    for k in 0..12 {
        let f = f64::from(k);
        let mut body = solid(
            &format!("b{k}"),
            [0.9 * (f % 4.0) - 1.3, 0.7 * (f % 3.0) - 0.7, 2.2 + 0.6 * f],
            [0.5, 0.3, 0.2],
        );
        body.angular_velocity_rad_s = [f % 5.0, 2.0 - f % 3.0, 0.3 * f];
        body.velocity_m_s = [0.0, 0.1 * f, -0.5 * f];
        m.bodies.push(body);
    }
    let run = |skip: bool| {
        let mut options = SolverOptions::default();
        options.contact.skip = skip;
        simulate_with(&m, &options).unwrap()
    };
    let (skipping, all) = (run(true), run(false));
    assert_eq!(skipping.frames, all.frames);
    assert_eq!(skipping.energies, all.energies);
    assert_eq!(skipping.events, all.events);
    let [some, every] = [&skipping, &all].map(|r| r.contact_work);
    println!("{some:?}\n{every:?}");
    assert_eq!((every.quiet_steps, every.pairs_left_alone), (0, 0));
    assert_eq!(some.point_visits, every.point_visits);
    assert!(some.pairs_left_alone > some.pairs_looked_at && some.quiet_steps > 0);
}

/// A ball of 0.5 m on flat ground under a tilted gravity, with rolling resistance.
fn ball(tilt_rad: f64, rolling_m: f64, end_s: f64) -> Model {
    let mut m = on_ground("ball", end_s, 0.8);
    m.gravity_m_s2 = [G * tilt_rad.sin(), 0.0, -G * tilt_rad.cos()];
    m.contact.rolling_m = rolling_m;
    let mut body = solid("ball", [0.0, 0.0, 0.5], [1.0; 3]);
    body.shapes = vec![Shape::Sphere { center_m: [0.0; 3], radius_m: 0.5 }];
    body.inertia_kg_m2 = [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { 0.1 * body.mass_kg } else { 0.0 }));
    m.bodies.push(body);
    m
}

#[test]
fn a_rolling_ball_stops_where_its_resistance_says() {
    // rolling without slip: (m + I/r²) a = m g ρ / r, so a = 5/7 g ρ / r and the way is v²/2a (Johnson, Contact Mechanics, 1985, section 9.4)
    let (speed, rolling) = (2.0, 0.05);
    let mut m = ball(0.0, rolling, 4.0);
    m.bodies[0].velocity_m_s = [speed, 0.0, 0.0];
    m.bodies[0].angular_velocity_rad_s = [0.0, speed / 0.5, 0.0];
    let result = simulate(&m).unwrap();
    let expected = speed * speed / (2.0 * 5.0 / 7.0 * G * rolling / 0.5);
    let way = result.frames.last().unwrap().position_m[0][0];
    let friction = result.energies.friction_j.last().unwrap();
    println!("rolls {way:.6} m ({expected:.6}), energy error {:.1e}", result.energy_error);
    assert!((way / expected - 1.0).abs() < 1e-3);
    assert!((friction / (0.7 * 2500.0 * speed * speed) - 1.0).abs() < 1e-6, "all of it is taken: {friction}");
    assert!(result.energy_error < 1e-9);
}

/// A ball with backspin bounces until it rolls. All that acts does so at its foot, about which angular momentum stays: it rolls at `5/7 (v + 2/5 r ω)` in the end, whatever the bounces do.
#[test]
fn a_bouncing_ball_with_spin_rolls_in_the_end_as_its_angular_momentum_says() {
    for (jointed, step_s) in [(false, 1e-3), (false, 2e-3), (true, 1e-3)] {
        let mut m = on_ground("spin", 8.0, 0.3);
        m.contact.ground.as_mut().unwrap().restitution = 0.6;
        let radius = 0.05;
        let mut body = Body {
            shapes: vec![Shape::Sphere { center_m: [0.0; 3], radius_m: radius }],
            ..solid("ball", [0.0, 0.0, 5.05], [0.1; 3])
        };
        (body.mass_kg, body.inertia_kg_m2) = (2.0, [[2e-3, 0.0, 0.0], [0.0, 2e-3, 0.0], [0.0, 0.0, 2e-3]]);
        (body.velocity_m_s, body.angular_velocity_rad_s) = ([3.0, 0.0, 0.0], [0.0, -40.0, 0.0]);
        m.bodies.push(body);
        if jointed {
            // a torque of nothing has the other solver run it
            m.forces.push(Force::Torque {
                id: "none".into(),
                body: "ball".into(),
                torque_nm: [0.0; 3],
                from_to_s: None,
            });
        } else {
            m.settings.time_step_s = Some(step_s);
        }
        let result = simulate(&m).unwrap();
        let [before, after] = [2, 1].map(|back| result.frames[result.frames.len() - back].position_m[0][0]);
        let (speed, expected) = ((after - before) / 0.01, 5.0 / 7.0 * (3.0 - 0.4 * 40.0 * radius));
        println!("jointed {jointed}, {step_s} s: {speed:.5} ({expected:.5})");
        assert!((speed / expected - 1.0).abs() < 1e-3, "{speed} {expected}");
    }
}

#[test]
fn a_ball_stands_on_slopes_up_to_its_resistance() {
    // ρ / r = 0.1
    for (slope, rolls) in [(0.095_f64, false), (0.105, true)] {
        let tilt = slope.atan();
        let result = simulate(&ball(tilt, 0.05, 2.0)).unwrap();
        let way = result.frames.last().unwrap().position_m[0][0];
        let expected = 0.5 * 5.0 / 7.0 * G * (tilt.sin() - 0.1 * tilt.cos()) * 4.0;
        println!("slope {slope}: {way:.6} m");
        assert!(if rolls { (way / expected - 1.0).abs() < 5e-3 } else { way.abs() < 1e-6 }, "{expected}");
    }
}

#[test]
fn resistance_against_rolling_does_not_hold_a_box_that_slides() {
    let slide = |rolling_m: f64| {
        let mut m = on_ground("slide", 1.5, 0.5);
        m.contact.rolling_m = rolling_m;
        let mut body = solid("box", [0.0, 0.0, 0.2], [1.0, 1.0, 0.4]);
        body.velocity_m_s = [5.0, 0.0, 0.0];
        m.bodies.push(body);
        simulate(&m).unwrap().frames.last().unwrap().position_m[0][0]
    };
    let [without, with] = [0.0, 0.05].map(slide);
    println!("slides {without:.6} m, with resistance against rolling {with:.6} m");
    assert!((with / without - 1.0).abs() < 1e-6);
}

#[test]
fn impacts_keep_their_energy_with_rolling_resistance() {
    // balls that bounce off the ground and each other, turning
    let mut m = ball(0.0, 0.02, 3.0);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.6 });
    m.contact.ground.as_mut().unwrap().restitution = 0.6;
    let first = m.bodies[0].clone();
    for k in 1..6 {
        let mut body = first.clone();
        body.id = format!("ball{k}");
        body.position_m = [0.3 * f64::from(k % 2), 0.2 * f64::from(k % 3), 0.6 + 1.1 * f64::from(k)];
        body.angular_velocity_rad_s = [3.0, -f64::from(k), 1.0];
        m.bodies.push(body);
    }
    let result = simulate(&m).unwrap();
    println!("energy error {:.1e}, warnings {:?}", result.energy_error, result.warnings);
    assert!(result.energy_error < 1e-6);
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
}

/// A cube on an eccentric hinge above another one: the hinge flows, breaks, and the cube comes to lie on the one below.
#[test]
fn faces_meet_after_the_hinge_between_them_broke() {
    const EDGE: f64 = pile::EDGE_M;
    let mut m = model("broken hinge", 1.5, 1e-3);
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    // half of what the weight asks for, 50 mm beside the hinge; breaks before the gap of 20 mm is closed
    let weight = DENSITY * EDGE.powi(3) * G;
    let strength = 0.5 * weight * 0.05;
    m.curves.insert("flow".into(), curve(&[[0.0, strength], [0.1, strength]], 0.02));
    m.bodies.push(solid("below", [0.0; 3], [EDGE; 3]));
    m.bodies.push(solid("above", [0.05, 0.0, EDGE + 0.02], [EDGE; 3]));
    let (foot, middle) = ([0.0, 0.0, -0.5 * EDGE], [0.0, 0.0, 0.5 * EDGE + 0.01]);
    m.bushings.push(joint("clamp", None, "below", foot, 1e9, 1e8, [elastic(1e8), elastic(1e8)]));
    m.bushings.push(joint("hinge", Some("below"), "above", middle, 1e8, 1e6, [hinge("flow"), hinge("flow")]));
    let result = simulate(&m).unwrap();
    let broken = result
        .events
        .iter()
        .find(|e| matches!(&e.kind, EventKind::Fracture { joint, .. } if joint == "hinge"));
    let broken_s = broken.expect("the hinge breaks").time_s;
    let met: Vec<(f64, [&str; 2])> = result
        .events
        .iter()
        .filter_map(|e| match &e.kind {
            EventKind::Contact { a, b } => Some((e.time_s, [a.as_str(), b.as_str()])),
            _ => None,
        })
        .collect();
    let [(met_s, mut who)] = met[..] else { panic!("{met:?}") };
    who.sort_unstable();
    assert!(who == ["above", "below"] && met_s > broken_s, "{who:?} {met_s} {broken_s}");
    let deepest = result.frames.iter().map(|f| pile::depths(f).largest_m).fold(0.0, f64::max);
    println!("broken hinge: breaks at {broken_s:.4} s, contact at {met_s:.4} s, deepest {deepest:.1e} m");
    assert!(deepest < 1e-4, "{deepest}");
    let end = result.frames.last().unwrap();
    let apart = end.position_m[1][2] - end.position_m[0][2];
    assert!((apart - EDGE).abs() < 1e-4, "face on face: {apart}");
}

#[test]
fn what_passes_an_edge_is_not_struck() {
    for height_m in [2.0, 2.3, 2.6, 2.9, 3.2, 3.5] {
        let mut m = model("past an edge", 1.2, 0.05);
        m.bodies.push(solid("slab", [-1.002, 0.0, 0.1 + height_m], [2.0, 2.0, 0.2]));
        m.contact.obstacles.push(ObstacleBox {
            id: "wall".into(),
            min_m: [0.0, -5.0, -20.0],
            max_m: [0.3, 5.0, 0.0],
            friction: 0.5,
            restitution: 0.1,
        });
        track(&mut m, "slab", [0.0, 0.0, 0.1 + height_m]);
        let run = simulate(&m).unwrap();
        let [x, y, z] = *run.tracked[0].displacement_m.last().unwrap();
        assert!(x.abs() + y.abs() < 1e-12 && (z + 0.5 * G * 1.44).abs() < 1e-9, "{height_m} m: {x} {y} {z}");
        // a wall that reaches a centimetre farther is struck
        m.contact.obstacles[0].min_m[0] = -0.012;
        let run = simulate(&m).unwrap();
        assert!(run.tracked[0].displacement_m.last().unwrap()[2] > -0.45 * G * 1.44, "{height_m} m");
    }
}

/// Over the joint of two slabs that lie flush nothing is struck, by boxes and hulls, turned or not; a step up of a millimetre is.
#[test]
fn seams_of_slabs_are_no_steps() {
    let over = |step_up_m: f64, yaw: f64, is_hull: bool, speed: f64| {
        let mut m = model("seam", 0.5, 0.05);
        let mut body = solid("box", [-0.8, 0.0, 0.1], [0.4, 0.3, 0.2]);
        if is_hull {
            body.shapes = vec![Shape::Hull { points_m: body.shapes[0].corners() }];
        }
        body.orientation = [(0.5 * yaw).cos(), 0.0, 0.0, (0.5 * yaw).sin()];
        body.velocity_m_s = [speed, 0.0, 0.0];
        m.bodies.push(body);
        let slab = |id: &str, x: [f64; 2], top: f64| ObstacleBox {
            id: id.into(),
            min_m: [x[0], -2.0, -1.0],
            max_m: [x[1], 2.0, top],
            friction: 0.0,
            restitution: 0.0,
        };
        m.contact.obstacles = vec![slab("a", [-3.0, 0.0], 0.0), slab("b", [0.0, 3.0], step_up_m)];
        track(&mut m, "box", [-0.8, 0.0, 0.1]);
        simulate(&m).unwrap().tracked[0].displacement_m.last().unwrap()[0] / (0.5 * speed)
    };
    for (yaw, is_hull, speed) in
        [(0.0, false, 2.0), (0.0, true, 2.0), (0.5, false, 2.0), (0.5, true, 4.0), (0.0, false, 20.0)]
    {
        let went = over(0.0, yaw, is_hull, speed);
        assert!((went - 1.0).abs() < 1e-3, "{yaw} {is_hull} {speed}: {went}");
    }
    assert!((over(1e-5, 0.0, false, 2.0) - 1.0).abs() < 1e-3, "less than contacts leave unopened");
    assert!(over(1e-3, 0.0, false, 2.0) < 0.7, "a step up is struck");
}

#[test]
fn what_hangs_above_the_ground_on_a_joint_strikes_it() {
    let mut m = model("pendulum over the ground", 1.0, 0.05);
    m.bodies.push(solid("bob", [1.0, 0.0, 1.5], [0.2; 3]));
    let free = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    m.bushings.push(Bushing {
        axial_stiffness_n_m: 1e6,
        ..Bushing::free("rod".into(), None, "bob".into(), [1.0, 0.0, 1.5], free)
    });
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    track(&mut m, "bob", [1.0, 0.0, 1.5]);
    let run = simulate(&m).unwrap();
    let end = run.tracked[0].displacement_m.last().unwrap();
    assert!((end[2] + 1.4).abs() < 1e-3, "{end:?}");
    assert!(run.first_ground_contact_s.is_some_and(|t| (t - (2.0 * 1.4 / G).sqrt()).abs() < 1e-4));
}

/// Boxes that come down within one step are told in the order in which they do, whatever their place in the file: `t = √(2 h / g)`.
#[test]
fn contacts_of_a_step_are_told_in_their_order() {
    let heights_m = [0.5006, 0.5003, 0.5];
    let mut m = on_ground("order", 0.4, 0.0);
    m.settings.time_step_s = Some(5e-3);
    for (i, height_m) in heights_m.iter().enumerate() {
        m.bodies.push(solid(&format!("box {i}"), [2.0 * i as f64, 0.0, height_m + 0.2], [0.4; 3]));
    }
    let result = simulate(&m).unwrap();
    let times_s: Vec<f64> = result.events.iter().map(|e| e.time_s).collect();
    assert_eq!(times_s.len(), 3, "{:?}", result.events);
    assert!(times_s[0] < times_s[1] && times_s[1] < times_s[2], "{times_s:?}");
    assert!((times_s[0] - (2.0 * 0.5 / G).sqrt()).abs() < 1e-4, "{times_s:?}");
    assert_eq!(result.first_ground_contact_s, Some(times_s[0]));
}
