//! Model files with ideal joints: events, applied forces, reactions, energies, what is refused.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::{RunResult, simulate};

/// A cube of one metre and 2500 kg that hangs on a ball one metre above its centre.
fn bob() -> Model {
    let mut m = model("bob", 1.0, 0.1);
    m.bodies.push(solid("bob", [0.0; 3], [1.0; 3]));
    m.joints.push(ideal("ball", JointKind::Spherical, None, "bob", [0.0, 0.0, 1.0]));
    track(&mut m, "bob", [0.0; 3]);
    m
}

fn fall(result: &RunResult, i: usize) -> f64 {
    result.tracked[0].displacement_m[i][2]
}

#[test]
fn what_hangs_stays_and_its_joint_carries_the_weight() {
    let mut m = bob();
    m.settings.reactions = true;
    let result = simulate(&m).unwrap();
    assert_eq!(result.times_s.len(), 11);
    assert!(result.tracked[0].displacement_m.iter().flatten().all(|u| u.abs() < 1e-12));
    for force in &result.reactions[0].force_n {
        assert!((force[2] - 2500.0 * G).abs() < 1e-6 && force[0].abs() + force[1].abs() < 1e-9, "{force:?}");
    }
}

#[test]
fn a_joint_carries_what_rests_on_its_body() {
    let mut m = model("table", 1.0, 0.1);
    m.settings.reactions = true;
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m.bodies.push(solid("table", [0.0; 3], [1.0, 1.0, 0.2]));
    m.bodies.push(solid("block", [0.2, 0.0, 0.3], [0.4; 3]));
    m.joints.push(ideal("wall", JointKind::Fixed, None, "table", [0.0; 3]));
    let result = simulate(&m).unwrap();
    let [table, block] = [0, 1].map(|b| m.bodies[b].mass_kg * G);
    let last = &result.reactions[0];
    let (force, torque) = (last.force_n.last().unwrap(), last.torque_nm.last().unwrap());
    assert!((force[2] / (table + block) - 1.0).abs() < 1e-3, "{force:?} {}", table + block);
    // upwards at the point, against the weight 0.2 m beside it along x
    assert!((torque[1] / (0.2 * block) + 1.0).abs() < 2e-3 && torque[0].abs() < 1e-3 * block, "{torque:?}");
    // nothing is borne of what has gone
    m.events.push(Event { remove_bodies: vec!["block".into()], ..Event::at("gone", 0.5) });
    let force = simulate(&m).unwrap().reactions[0].force_n.last().copied().unwrap();
    assert!((force[2] / table - 1.0).abs() < 1e-9, "{force:?}");
}

#[test]
fn a_released_joint_lets_go_at_its_time() {
    let mut m = bob();
    m.events.push(Event { release: vec!["ball".into()], ..Event::at("cut", 0.35) });
    let result = simulate(&m).unwrap();
    assert!(fall(&result, 3).abs() < 1e-12);
    for i in 4..=10 {
        let free = result.times_s[i] - 0.35;
        assert!((fall(&result, i) + 0.5 * G * free * free).abs() < 1e-9, "{}", fall(&result, i));
    }
    assert!(matches!(&result.events[0].kind, EventKind::Removal { event } if event == "cut"));
}

/// A body that has fallen freely has the energy that it had: nothing is released with it, wherever zero is.
#[test]
fn what_goes_takes_what_it_has_gained_with_it() {
    for height_m in [0.0, 10.0, -300.0] {
        let mut m = bob();
        m.bodies.push(solid("stone", [5.0, 0.0, height_m], [0.4; 3]));
        m.events.push(Event { remove_bodies: vec!["stone".into()], ..Event::at("gone", 0.35) });
        let result = simulate(&m).unwrap();
        let released_j = result.energies.released_j.last().unwrap();
        let scale_j = m.bodies[1].mass_kg * G;
        assert!(released_j.abs() < 1e-6 * scale_j, "{height_m}: {released_j}");
        // what is left: a pendulum that hangs still
        let gravity_j = result.energies.gravity_j.last().unwrap();
        assert!(gravity_j.abs() < 1e-6 * scale_j, "{height_m}: {gravity_j}");
        assert!(result.energy_error < 1e-9, "{height_m}: {}", result.energy_error);
    }
}

#[test]
fn a_force_acts_while_it_is_on_and_its_work_is_in_the_books() {
    let mut m = model("push", 1.0, 0.1);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies.push(solid("block", [0.0; 3], [1.0; 3]));
    m.forces.push(Force::Force {
        id: "push".into(),
        body: "block".into(),
        point_m: [0.0; 3],
        force_n: [5000.0, 0.0, 0.0],
        from_to_s: Some([0.2, 0.5]),
    });
    track(&mut m, "block", [0.0; 3]);
    let result = simulate(&m).unwrap();
    // 2 m/s² for 0.3 s, then 0.6 m/s
    let at_end = 0.5 * 2.0 * 0.09 + 0.6 * 0.5;
    assert!((result.tracked[0].displacement_m[10][0] - at_end).abs() < 1e-10);
    let e = &result.energies;
    assert!(
        (e.kinetic_j[10] - 0.5 * 2500.0 * 0.36).abs() < 1e-6
            && (e.applied_j[10] + e.kinetic_j[10]).abs() < 1e-6
    );
}

/// A column of 1400 kg that leans by 0.2 rad on a hinge of 20 MN m/rad.
fn leaning(capacity: Vec<[f64; 2]>, fracture_rad: Option<f64>) -> Model {
    let mut m = model("column", 1.5, 0.01);
    let mut column = solid("column", [1.75 * 0.2f64.sin(), 0.0, 1.75 * 0.2f64.cos()], [0.4, 0.4, 3.5]);
    column.orientation = [0.1f64.cos(), 0.0, 0.1f64.sin(), 0.0];
    m.bodies.push(column);
    m.joints.push(Joint {
        axis: Some([0.0, 1.0, 0.0]),
        ..ideal("pin", JointKind::Revolute, None, "column", [0.0; 3])
    });
    m.forces.push(Force::Hinge {
        id: "hinge".into(),
        body_a: None,
        body_b: "column".into(),
        stiffness_nm_rad: 2e7,
        capacity,
        fracture_rad,
        joint: Some("pin".into()),
    });
    m
}

#[test]
fn plastic_work_of_a_softening_hinge_closes_the_balance_to_the_tolerance() {
    let mut m = leaning(vec![[0.0, 3e3], [0.1, 3e3], [0.4, 500.0]], None);
    // its points are bends in which steps are less exact
    m.settings.tolerance = 1e-10;
    let result = simulate(&m).unwrap();
    assert!(result.energy_error < 1e-7, "{}", result.energy_error);
    let (turn, last) = (&result.turns[0], result.times_s.len() - 1);
    assert!(turn.rotation_rad[last][1] > 0.4 && (turn.moment_nm[last][1] - 500.0).abs() < 1e-6);
    // along the plateau, the softening line and the rest, less the elastic line at the start and what comes back elastically
    let (k, rotation) = (2e7, turn.rotation_rad[last][1]);
    let area = 3e3 * 0.1 + 0.5 * (3e3 + 500.0) * 0.3 + 500.0 * (rotation - 0.4);
    let dissipated = area - 0.5 * (3e3 * 3e3 + 500.0 * 500.0) / k;
    let e = &result.energies;
    assert!((e.plastic_j[last] / dissipated - 1.0).abs() < 1e-6, "{} {dissipated}", e.plastic_j[last]);
    assert!(e.applied_j[last].abs() < 1e-5 * dissipated, "{}", e.applied_j[last]);
}

#[test]
fn a_hinge_breaks_with_its_joint_and_says_so() {
    let result = simulate(&leaning(vec![[0.0, 3e3]], Some(0.3))).unwrap();
    let broken = result.events.iter().find(|e| matches!(e.kind, EventKind::Fracture { .. })).unwrap();
    let turn = &result.turns[0];
    let after = result.times_s.iter().position(|t| *t >= broken.time_s).unwrap();
    assert!((turn.rotation_rad[after - 1][1] - 0.3).abs() < 0.01 && turn.moment_nm[after + 1] == [0.0; 3]);
    let plastic = |i: usize| turn.plastic_rotation_rad[i][1];
    assert!((plastic(after) - (0.3 - 3e3 / 2e7)).abs() < 1e-4, "{}", plastic(after));
    assert_eq!(plastic(after), plastic(result.times_s.len() - 1));
    // free flight: the centre falls with g
    let z = |i: usize| result.frames[i].position_m[0][2];
    assert!((z(after + 3) - 2.0 * z(after + 2) + z(after + 1) + G * 1e-4).abs() < 1e-9);
}

#[test]
fn a_weakened_hinge_gives_way() {
    let mut m = leaning(vec![[0.0, 60e3]], None);
    let held = simulate(&m).unwrap();
    assert!(held.turns[0].rotation_rad.iter().all(|r| r[1] < 1e-3));
    m.events.push(Event {
        weaken: vec![Weakening { id: "hinge".into(), factor: 0.05 }],
        ..Event::at("saw", 0.5)
    });
    let result = simulate(&m).unwrap();
    assert!(result.turns[0].rotation_rad.last().unwrap()[1] > 0.1 && result.energy_error < 1e-4);
}

#[test]
fn redundant_joints_are_told_and_change_nothing() {
    let mut m = bob();
    m.bodies[0].velocity_m_s = [1.0, 0.0, 0.0];
    let once = simulate(&m).unwrap();
    m.joints.push(ideal("again", JointKind::Spherical, None, "bob", [0.0, 0.0, 1.0]));
    let twice = simulate(&m).unwrap();
    assert!(once.warnings.iter().any(|w| w.contains("velocities do not fit")), "{:?}", once.warnings);
    assert!(twice.warnings.iter().any(|w| w.contains("3 of 6 joint conditions")), "{:?}", twice.warnings);
    let [a, b] = [&once, &twice].map(|r| r.tracked[0].displacement_m.as_flattened());
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-8));
}

/// Two bars in one line between two pins: they can move across it at first order only.
#[test]
fn a_motion_that_joints_allow_at_first_order_only_is_stopped_booked_and_told() {
    let mut m = model("line", 0.1, 0.001);
    m.gravity_m_s2 = [0.0; 3];
    for (i, id) in ["left", "right"].into_iter().enumerate() {
        let mut bar = solid(id, [0.5 + i as f64, 0.0, 0.0], [1.0, 0.1, 0.1]);
        bar.velocity_m_s = [0.0, 0.0, 0.05];
        bar.angular_velocity_rad_s = [0.0, if i == 0 { -0.1 } else { 0.1 }, 0.0];
        m.bodies.push(bar);
    }
    for (i, (a, b)) in [(None, "left"), (Some("left"), "right"), (None, "right")].into_iter().enumerate() {
        let pin = ideal(&format!("pin{i}"), JointKind::Revolute, a, b, [i as f64, 0.0, 0.0]);
        m.joints.push(Joint { axis: Some([0.0, 1.0, 0.0]), ..pin });
    }
    let result = simulate(&m).unwrap();
    let e = &result.energies;
    let last = e.kinetic_j.len() - 1;
    assert!(result.warnings.iter().any(|w| w.contains("at first order only")), "{:?}", result.warnings);
    assert!(e.kinetic_j[last] < 1e-3 * e.kinetic_j[0], "{:?}", e.kinetic_j);
    assert!(e.released_j[last] > 0.999 * e.kinetic_j[0] && result.energy_error < 1e-3, "{:?}", e.released_j);
    assert!(result.frames[last].position_m[0][2].abs() < 1e-3, "{:?}", result.frames[last]);
}

/// Five bars in one line between two ball joints, under their weight: the joints stop each motion across the line, hundreds of times, and no step resolves that.
#[test]
fn an_energy_error_in_a_singular_pose_is_told_as_such() {
    use fallwerk::mbs::{SolverOptions, simulate_with};
    let mut m = model("line", 0.2, 0.01);
    let ids: Vec<String> = (0..5).map(|i| format!("b{i}")).collect();
    for (i, id) in ids.iter().enumerate() {
        m.bodies.push(Body {
            mass_kg: 1.0,
            inertia_kg_m2: [[0.01, 0.0, 0.0], [0.0, 0.0833, 0.0], [0.0, 0.0, 0.0833]],
            shapes: Vec::new(),
            ..solid(id, [i as f64 + 0.5, 0.0, 0.0], [1.0, 0.1, 0.1])
        });
    }
    for i in 0..=5 {
        let before = (1..5).contains(&i).then(|| ids[i - 1].as_str());
        m.joints.push(ideal(
            &format!("j{i}"),
            JointKind::Spherical,
            before,
            &ids[i.min(4)],
            [i as f64, 0.0, 0.0],
        ));
    }
    let options = SolverOptions { energy_limit: 0.01, ..SolverOptions::default() };
    let said = simulate_with(&m, &options).unwrap_err().to_string();
    assert!(said.contains("joints have stopped a motion") && said.contains("singular pose"), "{said}");
    assert!(!said.contains("smaller settings.time_step_s"), "{said}");
}

#[test]
fn what_does_not_fit_is_refused_with_a_remedy() {
    type Change = fn(&mut Model);
    let cases: [(Change, &str); 12] = [
        (
            |m| m.joints[0].kind = JointKind::Revolute,
            "joints[0].axis: is missing: a revolute joint needs a vector here",
        ),
        (
            |m| m.joints[0].axis = Some([1.0, 0.0, 0.0]),
            "joints[0].axis: has no meaning for a spherical joint; leave it out",
        ),
        (|m| m.joints[0].body_b = "bop".into(), "\"bop\" is not the id of a body (did you mean \"bob\"?)"),
        (
            |m| m.events.push(Event { release: vec!["bal".into()], ..Event::at("e", 0.1) }),
            "did you mean \"ball\"?",
        ),
        (
            |m| {
                m.events.push(Event {
                    weaken: vec![Weakening { id: "ball".into(), factor: 0.5 }],
                    ..Event::at("e", 0.1)
                })
            },
            "\"ball\" is not the id of a bushing or a hinge",
        ),
        (
            |m| m.settings.preload = true,
            "settings.preload: is true, which is for models without ideal joints and forces",
        ),
        (|m| m.settings.tolerance = 0.0, "settings.tolerance: is 0, expected a positive number"),
        (|m| m.settings.tolerance = 1e-18, "settings.tolerance: is 1e-18, expected at least 1e-14"),
        (
            |m| m.joints[0].point_m[1] = 1e12,
            "joints[0].point_m: is 1e12, expected at most 1e9 m: a slip of the exponent or the unit?",
        ),
        (|m| track(m, "bob", [0.0, -1e30, 0.0]), "point_m: is 1e30, expected at most 1e9 m"),
        (|m| m.settings.tolerance = 100.0, "settings.tolerance: is 100, expected at most 0.1"),
        (
            |m| {
                m.bodies[0].shapes.push(Shape::Hull {
                    points_m: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
                })
            },
            "has 4 points that span no volume",
        ),
    ];
    for (change, expected) in cases {
        let mut m = bob();
        change(&mut m);
        let text = simulate(&m).unwrap_err().to_string();
        assert!(text.contains(expected), "expected {expected:?} in {text:?}");
    }
    let mut stiff = leaning(vec![[0.0, 60e3]], None);
    stiff.settings.time_step_s = Some(0.1);
    let said = simulate(&stiff).unwrap_err().to_string();
    assert!(said.contains("above the stability limit"), "{said}");
    stiff.settings.time_step_s = Some(step_told(&said));
    // such long steps may end for their energy
    let again = simulate(&stiff).map_or_else(|e| e.to_string(), |_| String::new());
    assert!(!again.contains("above the stability limit"), "{said}: {again}");
}

#[test]
fn given_steps_show_their_order() {
    let error = |step: f64| {
        let mut m = leaning(vec![[0.0, 3e3]], None);
        m.settings =
            RunSettings { time_step_s: Some(step), output_interval_s: 1.5, tolerance: 1e-3, ..m.settings };
        let end = simulate(&m).unwrap().turns[0].rotation_rad[1][1];
        m.settings = RunSettings { time_step_s: None, tolerance: 1e-11, ..m.settings };
        (end - simulate(&m).unwrap().turns[0].rotation_rad[1][1]).abs()
    };
    let [coarse, fine] = [4e-3, 1e-3].map(error);
    assert!(coarse < 1e-3 && fine < 0.12 * coarse, "{coarse} {fine}");
}

fn ground(friction: f64, restitution: f64) -> Option<GroundPlane> {
    Some(GroundPlane { level_m: 0.0, friction, restitution })
}

/// A cube of 0.1 m below one of a metre, fixed to it, a metre above the ground.
fn drop_on_small_foot(ratio: f64) -> Model {
    let mut m = model("foot", 1.2, 0.001);
    let mut foot = solid("foot", [0.0, 0.0, 1.05], [0.1; 3]);
    let mut load = solid("load", [0.0, 0.0, 1.6], [1.0; 3]);
    let scale = 1000.0 / load.mass_kg;
    load.mass_kg *= scale;
    load.inertia_kg_m2.iter_mut().flatten().for_each(|i| *i *= scale);
    let scale = 1000.0 / ratio / foot.mass_kg;
    foot.mass_kg *= scale;
    foot.inertia_kg_m2.iter_mut().flatten().for_each(|i| *i *= scale);
    m.bodies.extend([foot, load]);
    m.joints.push(ideal("weld", JointKind::Fixed, Some("foot"), "load", [0.0, 0.0, 1.1]));
    m.contact.ground = ground(0.5, 0.5);
    m
}

#[test]
fn what_a_joint_holds_hits_the_ground_as_one_body() {
    for ratio in [1.0, 1e3, 1e6] {
        let result = simulate(&drop_on_small_foot(ratio)).unwrap();
        let z: Vec<f64> = result.frames.iter().map(|f| f.position_m[0][2] - 0.05).collect();
        let hit = result.first_ground_contact_s.unwrap();
        assert!((hit - (2.0 / G).sqrt()).abs() < 5e-4, "{hit}");
        let after = result.times_s.iter().position(|t| *t > hit + 1e-3).unwrap();
        let rebound = z[after..].iter().copied().fold(0.0, f64::max);
        assert!((rebound - 0.25).abs() < 2e-3, "mass ratio {ratio}: {rebound}");
        assert!(z.iter().all(|z| *z > -1e-4), "mass ratio {ratio}");
        assert!(result.energy_error < 1e-3, "{}", result.energy_error);
    }
}

/// Structures whose joints nearly hold a body in the direction in which it meets another one, of which impulses once made energy or numbers that are not finite.
#[test]
fn contact_in_a_direction_that_joints_hold_makes_no_energy() {
    for seed in [219, 815, 912, 1082, 1308, 3015, 3388, 4877] {
        let result = simulate(&fallwerk::bench::mbs_trials::random(seed)).unwrap();
        assert!(result.energy_error < 1e-3, "{seed}: {}", result.energy_error);
    }
}

/// A structure that contact keeps in leapfrog steps throughout: the work of its hinges, booked with the velocities at the start of a step led on, once fell behind by a thousandth.
#[test]
fn hinges_in_contact_steps_do_the_work_that_is_booked() {
    let result = simulate(&fallwerk::bench::mbs_trials::random(3074)).unwrap();
    assert!(result.energy_error < 5e-4, "{}", result.energy_error);
}

#[test]
fn a_pendulum_that_meets_a_wall_rebounds_with_its_restitution() {
    let mut m = model("wall", 2.0, 0.001);
    // a cube on a rod of two metres, released level, meets a wall below the pivot
    m.bodies.push(solid("bob", [-2.0, 0.0, 2.0], [0.2; 3]));
    let hinge = ideal("pin", JointKind::Revolute, None, "bob", [0.0, 0.0, 2.0]);
    m.joints.push(Joint { axis: Some([0.0, 1.0, 0.0]), ..hinge });
    m.contact.planes.push(ObstaclePlane {
        id: "wall".into(),
        point_m: [0.1, 0.0, 0.0],
        normal: [-1.0, 0.0, 0.0],
        friction: 0.0,
        restitution: 0.6,
    });
    let result = simulate(&m).unwrap();
    let angle: Vec<f64> = result
        .frames
        .iter()
        .map(|f| {
            let p = f.position_m[0];
            p[0].atan2(2.0 - p[2])
        })
        .collect();
    let EventKind::Contact { b, .. } = &result.events[0].kind else { panic!("{:?}", result.events) };
    let hit = result.events[0].time_s;
    let i = result.times_s.iter().position(|t| *t > hit).unwrap() + 1;
    let speed = |i: usize| (angle[i + 1] - angle[i]) / 0.001;
    let ratio = -speed(i + 1) / speed(i - 4);
    assert!(b == "wall" && (ratio - 0.6).abs() < 0.01, "{b} {ratio} at {hit}");
    assert!(angle.iter().all(|a| *a < 1e-3) && result.energy_error < 1e-3, "{}", result.energy_error);
}

#[test]
fn debris_of_a_broken_hinge_comes_to_rest() {
    let mut m = leaning(vec![[0.0, 3e3], [0.2, 0.0]], Some(0.4));
    // short of the ground at its foot, which the leaning column would else be in when the joint opens
    m.bodies[0].shapes = vec![Shape::cuboid([0.0; 3], [0.2, 0.2, 1.55])];
    m.contact.ground = ground(0.5, 0.0);
    m.settings.end_time_s = 4.0;
    let result = simulate(&m).unwrap();
    let last = result.frames.last().unwrap().position_m[0];
    let moved = (0..3).map(|k| (last[k] - result.frames[result.frames.len() - 20].position_m[0][k]).abs());
    assert!((last[2] - 0.2).abs() < 1e-3 && moved.fold(0.0, f64::max) < 1e-4, "{last:?}");
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

#[test]
fn both_solvers_run_bushings_alike() {
    let mut m = model("bushings", 0.6, 0.05);
    m.bodies.push(solid("low", [0.0, 0.0, 1.0], [0.4, 0.4, 2.0]));
    m.bodies.push(solid("top", [0.0, 0.0, 3.0], [0.4, 0.4, 2.0]));
    m.bodies[1].velocity_m_s = [1.0, 0.0, 0.0];
    m.curves.insert("c".into(), frame_curve());
    m.bushings.push(joint("foot", None, "low", [0.0; 3], 1e8, 1e8, [elastic(1e7), hinge("c")]));
    m.bushings.push(joint("knee", Some("low"), "top", [0.0, 0.0, 2.0], 1e8, 1e8, [elastic(1e7), hinge("c")]));
    track(&mut m, "top", [0.0, 0.0, 4.0]);
    // small steps: those chosen shift the phase of the elastic vibration, a few per cent of the way in this stiff pair
    m.settings.time_step_s = Some(1e-5);
    let explicit = simulate(&m).unwrap();
    m.settings.time_step_s = None;
    // a torque of nothing brings the other solver
    m.forces.push(Force::Torque {
        id: "none".into(),
        body: "low".into(),
        torque_nm: [0.0; 3],
        from_to_s: None,
    });
    m.settings.tolerance = 1e-8;
    let implicit = simulate(&m).unwrap();
    assert!(implicit.energy_error < 1e-6, "{}", implicit.energy_error);
    let [a, b] = [&explicit, &implicit].map(|r| r.tracked[0].displacement_m.as_flattened());
    let far = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(far > 0.02 && off < 1e-2 * far, "{off} of {far}");
    let [a, b] = [&explicit, &implicit].map(|r| r.hinges[0].plastic_rotation_rad.last().copied().unwrap());
    assert!(b > 5e-5 && (a - b).abs() < 0.01 * b, "{a} {b}");
}

#[test]
fn a_bushing_and_a_ball_carry_one_body() {
    // half of the weight each
    let mut m = model("both", 2.0, 0.1);
    m.bodies.push(solid("bar", [0.0; 3], [2.0, 0.2, 0.2]));
    m.joints.push(ideal("ball", JointKind::Spherical, None, "bar", [-1.0, 0.0, 0.0]));
    m.bushings.push(joint("pad", None, "bar", [1.0, 0.0, 0.0], 1e7, 1e7, [elastic(0.0), elastic(0.0)]));
    m.settings.reactions = true;
    track(&mut m, "bar", [1.0, 0.0, 0.0]);
    let result = simulate(&m).unwrap();
    let weight = 200.0 * G;
    let lift = result.reactions[0].force_n.iter().map(|f| f[2]).sum::<f64>() / result.times_s.len() as f64;
    let sag = result.tracked[0].displacement_m.iter().map(|u| u[2]).fold(0.0, f64::min);
    // it swings between nothing and twice the static sag of half its weight
    assert!(
        (lift / (0.5 * weight) - 1.0).abs() < 0.5 && sag < -0.5 * weight / 1e7 && sag > -1.01 * weight / 1e7,
        "{lift} {sag}"
    );
}

#[test]
fn a_hinge_on_an_ideal_joint_knows_its_axial_force() {
    // a leaning column under a slab that is pushed: the axial force of its foot rises and falls as the slab turns down
    let model_of = |held: bool| {
        let mut m = model("foot", 0.8, 0.05);
        m.bodies.push(solid("column", [0.0, 0.0, 1.5], [0.4, 0.4, 3.0]));
        m.bodies[0].mass_kg *= 20.0;
        m.bodies[0].inertia_kg_m2.iter_mut().flatten().for_each(|i| *i *= 20.0);
        m.bodies[0].velocity_m_s = [1.5, 0.3, 0.0];
        m.bodies[0].angular_velocity_rad_s = [-0.2, 1.0, 0.0];
        let level = |axial_force_n: f64, capacity: f64| CapacityLevel {
            axial_force_n,
            capacity: vec![[0.0, capacity], [0.1, 0.8 * capacity], [2.0, 0.5 * capacity]],
            fracture_rotation_rad: 5.0,
        };
        let curve = ResistanceCurve {
            stiffness_nm_rad: 2e7,
            levels: vec![level(-2e5, 20e3), level(3e5, 160e3)],
            cyclic: None,
        };
        m.curves.insert("c".into(), curve);
        let stiff = if held { 0.0 } else { 1e10 };
        let mut foot = joint("foot", None, "column", [0.0; 3], stiff, 1e8, [hinge("c"), hinge("c")]);
        if held {
            foot.joint = Some("pin".into());
            m.joints.push(ideal("pin", JointKind::Spherical, None, "column", [0.0; 3]));
        }
        // without the static state a bushing swings between no axial force and twice the weight
        m.settings.preload = !held;
        m.bushings.push(foot);
        track(&mut m, "column", [0.0, 0.0, 3.0]);
        m
    };
    let [bushing, held] = [false, true].map(|held| simulate(&model_of(held)).unwrap());
    assert!(
        bushing.energy_error < 1e-4 && held.energy_error < 1e-5,
        "{} {}",
        bushing.energy_error,
        held.energy_error
    );
    let [a, b] = [&bushing, &held].map(|r| r.tracked[0].displacement_m.as_flattened());
    let far = b.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let [n, m] = [&bushing, &held].map(|r| &r.hinges[0].axial_force_n);
    println!(
        "tip moves {far:.3} m, off by {off:.2e} m; axial forces {n:?} {m:?}; energy {:.1e} {:.1e}",
        bushing.energy_error, held.energy_error
    );
    assert!(far > 1.0 && off < 2e-3 * far, "{off} of {far}");
    let [p, q] = [&bushing, &held].map(|r| *r.hinges[0].plastic_rotation_rad.last().unwrap());
    assert!(q > 0.3 && (p - q).abs() < 2e-3 * q, "{p} {q}");
    // the motion without the interaction is another one
    let mut dull = model_of(true);
    dull.curves.get_mut("c").unwrap().levels.remove(0);
    let dull = simulate(&dull).unwrap();
    assert!((dull.hinges[0].plastic_rotation_rad.last().unwrap() - q).abs() > 0.02 * q);
}

#[test]
fn a_hinge_on_an_ideal_joint_opens_it_and_is_checked() {
    let mut m = model("foot", 1.0, 0.05);
    m.bodies.push(solid("column", [0.0, 0.0, 1.5], [0.4, 0.4, 3.0]));
    m.bodies[0].velocity_m_s = [1.5, 0.0, 0.0];
    m.bodies[0].angular_velocity_rad_s = [0.0, 1.0, 0.0];
    m.curves.insert("c".into(), curve(&[[0.0, 5e3], [0.4, 5e3]], 0.2));
    m.joints.push(ideal("pin", JointKind::Spherical, None, "column", [0.0; 3]));
    m.bushings.push(Bushing {
        joint: Some("pin".into()),
        ..joint("foot", None, "column", [0.0; 3], 0.0, 1e8, [hinge("c"), hinge("c")])
    });
    let result = simulate(&m).unwrap();
    let fracture = result.events.iter().find(|e| matches!(e.kind, EventKind::Fracture { .. })).unwrap();
    // it falls freely from there on
    let fall = |i: usize| result.frames[i].position_m[0][2];
    let second = (fall(20) - 2.0 * fall(18) + fall(16)) / 0.01;
    assert!(fracture.time_s < 0.8 && (second + G).abs() < 1e-3 * G, "{} {second}", fracture.time_s);
    assert!(result.energy_error < 1e-5, "{}", result.energy_error);
    m.bushings[0].axial_stiffness_n_m = 1e8;
    m.bushings[0].joint = Some("pine".into());
    let complaint = simulate(&m).unwrap_err().to_string();
    for part in ["bushings[0].joint", "\"pin\"", "axial_stiffness_n_m", "expected 0"] {
        assert!(complaint.contains(part), "{complaint}");
    }
}

/// What it bears above what an event leaves it flows off at the event, not a step later.
#[test]
fn a_hinge_on_an_ideal_joint_yields_when_it_is_weakened() {
    let mut m = model("arm", 0.5, 0.01);
    m.bodies.push(solid("arm", [2.0, 0.0, 0.0], [4.0, 0.4, 0.4]));
    m.curves.insert("c".into(), curve(&[[0.0, 100e3], [1.0, 100e3]], 2.0));
    m.joints.push(ideal("pin", JointKind::Spherical, None, "arm", [0.0; 3]));
    m.bushings.push(Bushing {
        joint: Some("pin".into()),
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ..joint("root", None, "arm", [0.0; 3], 0.0, 1e8, [hinge("c"), elastic(1e7)])
    });
    let held = simulate(&m).unwrap();
    assert!(!held.events.iter().any(|e| matches!(e.kind, EventKind::Yield { .. })));
    let moments = held.hinges[0].moment_nm.iter().map(|m| m[0].abs());
    let (at, most) = moments.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    assert!(most > 40e3 && at + 1 < held.times_s.len(), "{most} at {at}");
    m.events.push(Event {
        weaken: vec![Weakening { id: "root".into(), factor: 0.2 }],
        ..Event::at("saw", held.times_s[at])
    });
    let result = simulate(&m).unwrap();
    let yields = result.events.iter().filter(|e| matches!(e.kind, EventKind::Yield { .. }));
    assert_eq!(yields.map(|e| e.time_s).collect::<Vec<_>>(), [held.times_s[at]]);
}

#[test]
fn a_blow_across_the_plane_of_a_mechanism_is_borne_by_its_joints() {
    let ball = |id: &str, y: f64, speed_m_s: f64| Body {
        inertia_kg_m2: [[0.004, 0.0, 0.0], [0.0, 0.004, 0.0], [0.0, 0.0, 0.004]],
        mass_kg: 1.0,
        velocity_m_s: [0.0, speed_m_s, 0.0],
        shapes: vec![Shape::Sphere { center_m: [0.0; 3], radius_m: 0.1 }],
        ..solid(id, [0.0, y, -1.0], [1.0; 3])
    };
    let mut m = model("blow", 1.0, 0.1);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies = vec![ball("bob", 0.0, 0.0), ball("ball", -2.0, 5.0)];
    let hinge = ideal("hinge", JointKind::Revolute, None, "bob", [0.0; 3]);
    m.joints.push(Joint { axis: Some([0.0, 1.0, 0.0]), ..hinge });
    m.contact.bodies = Some(BodyContact { friction: 0.0, restitution: 0.5 });
    track(&mut m, "bob", [0.0, 0.0, -1.0]);
    track(&mut m, "ball", [0.0, -2.0, -1.0]);
    let result = simulate(&m).unwrap();
    let [bob, ball] = [0, 1].map(|i| result.tracked[i].displacement_m[10]);
    assert!(bob.iter().map(|u| u.abs()).fold(0.0, f64::max) < 1e-6, "the bearing holds: {bob:?}");
    // 1.8 m towards it, and back at half of the speed
    let back = 1.8 - 2.5 * (1.0 - 1.8 / 5.0);
    assert!((ball[1] - back).abs() < 1e-3, "{ball:?} {back}");
}

/// A guide that leaves a body free to fall leaves it to the ground; one that holds it in height does not.
#[test]
fn what_a_guide_leaves_free_to_fall_stands_on_the_ground() {
    let cube = |kind: JointKind, axis: [f64; 3], height: f64| {
        let mut m = model("guided", 1.0, 0.1);
        m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
        m.bodies.push(solid("cube", [0.0, 0.0, height], [1.0; 3]));
        m.bodies[0].velocity_m_s[0] = 1.0;
        let guide = ideal("guide", kind, None, "cube", [0.0, 0.0, height]);
        m.joints.push(Joint { axis: Some(axis), ..guide });
        track(&mut m, "cube", [0.0, 0.0, height]);
        *simulate(&m).unwrap().tracked[0].displacement_m.last().unwrap()
    };
    // slides v²/2μg in a plane across y, which a 2D model is made of
    let way = 1.0 / (2.0 * 0.5 * G);
    let [x, y, z] = cube(JointKind::Planar, [0.0, 1.0, 0.0], 0.5);
    assert!((x / way - 1.0).abs() < 1e-3 && y.abs() < 1e-9 && z.abs() < 1e-6, "{x} {y} {z}");
    let [x, _, z] = cube(JointKind::Prismatic, [0.0, 0.0, 1.0], 0.5);
    assert!(x.abs() < 1e-9 && z.abs() < 1e-6, "{x} {z}");
    // its weight is the rail's, and no friction brakes it
    let [x, _, z] = cube(JointKind::Prismatic, [1.0, 0.0, 0.0], 0.5);
    assert!((x - 1.0).abs() < 1e-9 && z.abs() < 1e-9, "{x} {z}");
}

/// The rotation vector of a bushing turns round at a full revolution: a run says so, alone and on an ideal joint.
#[test]
fn a_bushing_that_turns_round_is_told() {
    for (held, rate, told) in
        [(false, 1.0, false), (false, 20.0, true), (true, 1.0, false), (true, 20.0, true)]
    {
        let mut m = model("turned", 0.4, 0.1);
        m.gravity_m_s2 = [0.0; 3];
        m.bodies.push(solid("b", [0.0; 3], [0.5; 3]));
        m.bodies[0].angular_velocity_rad_s = [0.0, rate, 0.0];
        let mut spring = joint("spring", None, "b", [0.0; 3], 0.0, 0.0, [elastic(1.0), elastic(1.0)]);
        spring.torsional_stiffness_nm_rad = 1.0;
        if held {
            let pin = ideal("pin", JointKind::Revolute, None, "b", [0.0; 3]);
            m.joints.push(Joint { axis: Some([0.0, 1.0, 0.0]), ..pin });
            spring.joint = Some("pin".into());
        }
        m.bushings.push(spring);
        let result = simulate(&m).unwrap();
        let says = result.warnings.iter().any(|w| w.contains("\"spring\" has turned by more than 5 rad"));
        assert_eq!(says, told, "{held} {rate}: {:?}", result.warnings);
    }
}

/// A hinge that a release takes between two outputs keeps the rotations that it had then: `θ = ω t - M t² / 2 I`, of which `M / K` is elastic.
#[test]
fn a_released_hinge_keeps_its_rotations() {
    let (plastic_nm, spin, at_s) = (2e3, 1.5, 0.0833);
    let mut m = model("let go", 0.3, 0.05);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies.push(solid("block", [1.0, 0.0, 0.0], [1.0; 3]));
    let inertia = m.bodies[0].inertia_kg_m2[1][1] + m.bodies[0].mass_kg;
    (m.bodies[0].velocity_m_s, m.bodies[0].angular_velocity_rad_s) = ([0.0, 0.0, -spin], [0.0, spin, 0.0]);
    m.joints.push(ideal("pin", JointKind::Spherical, None, "block", [0.0; 3]));
    m.curves.insert("c".into(), curve(&[[0.0, plastic_nm], [1.0, plastic_nm]], 5.0));
    let stiffness = m.curves["c"].stiffness_nm_rad;
    let mut hinged = joint("k", None, "block", [0.0; 3], 0.0, 0.0, [hinge("c"), elastic(0.0)]);
    hinged.axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    hinged.joint = Some("pin".into());
    m.bushings.push(hinged);
    m.settings.preload = false;
    m.events.push(Event { release: vec!["k".into()], ..Event::at("e", at_s) });
    let result = simulate(&m).unwrap();
    let history = &result.hinges[0];
    let turned = spin * at_s - 0.5 * plastic_nm / inertia * at_s * at_s;
    for i in 2..result.times_s.len() {
        let (rotation, plastic) = (history.rotation_rad[i][0].abs(), history.plastic_rotation_rad[i]);
        assert!((rotation - turned).abs() < 1e-4, "{rotation} {turned}");
        assert!((plastic - (turned - plastic_nm / stiffness)).abs() < 1e-4, "{plastic} {turned}");
        assert_eq!(history.moment_nm[i], [0.0; 2]);
    }
}
