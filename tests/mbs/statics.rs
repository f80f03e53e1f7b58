//! Preload, removal of supports, mechanisms.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::{EventKind, FractureCause};
use fallwerk::mbs::{SolveError, simulate};

#[test]
fn preloaded_cantilever_hangs_at_the_closed_form_and_stays_there() {
    let (arm, bending, axial, shear) = (2.0, 4e7, 1e9, 3e8);
    let mut m = model("cantilever", 1.0, 0.1);
    m.bodies.push(solid("beam", [arm, 0.0, 0.0], [4.0, 0.4, 0.4]));
    m.settings.preload = true;
    m.bushings.push(Bushing {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        shear_stiffness_n_m: [shear; 2],
        ..joint("clamp", None, "beam", [0.0; 3], axial, 1e7, [elastic(bending), elastic(bending)])
    });
    track(&mut m, "beam", [4.0, 0.0, 0.0]);
    let result = simulate(&m).unwrap();
    let weight = 1600.0 * G;
    // Moment about the clamp in the deformed state: K θ = W (a cos θ + g); the gap is that of the springs along and across the beam under W.
    let mut angle: f64 = 0.0;
    for _ in 0..50 {
        let gap = weight * angle.sin() * angle.cos() * (1.0 / axial - 1.0 / shear);
        angle = weight * (arm * angle.cos() + gap) / bending;
    }
    let (along, across) = (angle.sin().powi(2), angle.cos().powi(2));
    let sag = 2.0 * arm * angle.sin() + weight * (along / axial + across / shear);
    let found = -result.tracked[0].origin_m[2];
    println!("cantilever: {found:.9} m ({sag:.9}), {:?} iterations", result.preload_iterations);
    assert!((found / sag - 1.0).abs() < 1e-9);
    let drift = result.tracked[0].displacement_m.iter().flatten().fold(0.0_f64, |a, u| a.max(u.abs()));
    println!("cantilever: drift {drift:.1e} m");
    assert!(drift < 1e-10);
}

/// A slab on four columns, hinges at both ends.
fn table_frame() -> Model {
    let mut m = model("table", 1.0, 0.01);
    m.curves.insert("hinge".into(), frame_curve());
    m.bodies.push(solid("slab", [3.0, 2.5, 3.5], [6.4, 5.4, 0.25]));
    for (i, (x, y)) in [(0.0, 0.0), (6.0, 0.0), (0.0, 5.0), (6.0, 5.0)].into_iter().enumerate() {
        let id = format!("column{i}");
        m.bodies.push(solid(&id, [x, y, 1.75], [0.4, 0.4, 3.1]));
        let ends = [hinge("hinge"), hinge("hinge")];
        m.bushings.push(joint(&format!("foot{i}"), None, &id, [x, y, 0.0], 1e9, 1e7, ends.clone()));
        m.bushings.push(joint(&format!("head{i}"), Some(&id), "slab", [x, y, 3.5], 1e9, 1e7, ends));
    }
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: RESTITUTION });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: RESTITUTION });
    m.settings.preload = true;
    track(&mut m, "slab", [-0.2, -0.2, 3.5]);
    m
}

#[test]
fn a_preloaded_frame_stands_still() {
    let result = simulate(&table_frame()).unwrap();
    let drift = result.tracked[0].displacement_m.iter().flatten().fold(0.0_f64, |a, u| a.max(u.abs()));
    assert!(drift < 1e-9, "{drift}");
    assert!(result.events.is_empty(), "{:?}", result.events);
    let axial: f64 = (0..4).map(|i| result.hinges[2 * i].axial_force_n[0]).sum();
    let weight = G * (21600.0 + 4.0 * 1240.0);
    assert!((axial / weight - 1.0).abs() < 1e-4, "{axial} {weight}");
}

#[test]
fn removing_two_columns_brings_the_slab_down_on_their_side() {
    let mut m = table_frame();
    m.settings.end_time_s = 2.5;
    m.events.push(Event {
        remove_bodies: vec!["column0".into(), "column1".into()],
        ..Event::at("charge", 0.1234)
    });
    let result = simulate(&m).unwrap();
    let u = &result.tracked[0].displacement_m;
    assert!(u[12].iter().all(|v| v.abs() < 1e-9), "moves before the charge: {:?}", u[12]);
    let last = u.last().unwrap();
    println!(
        "two columns removed: corner at {last:?}, ground contact {:?} s, energy error {:.1e}, {} events",
        result.first_ground_contact_s,
        result.energy_error,
        result.events.len()
    );
    assert!(last[2] < -3.0);
    // symmetric until the first contact; what impacts make of round-off afterwards is another matter
    let contact = result.times_s.partition_point(|t| Some(*t) < result.first_ground_contact_s);
    let aside = u[..contact].iter().fold(0.0_f64, |most, u| most.max(u[0].abs()));
    assert!(contact > 50 && aside < 1e-4, "{aside} m aside before the contact");
    let removal = result.events.iter().find(|e| matches!(e.kind, EventKind::Removal { .. })).unwrap();
    assert!((removal.time_s - 0.1234).abs() < 1e-12);
    assert!(result.energy_error < 0.03);
}

#[test]
fn a_mechanism_names_its_loosest_body() {
    let mut m = table_frame();
    m.bushings.retain(|j| j.id != "foot2" && j.id != "head2");
    match simulate(&m) {
        Err(SolveError::Mechanism { body, .. }) => assert_eq!(body, "column2"),
        other => panic!("{other:?}"),
    }
    // A column between two ball joints still turns about its own axis.
    let mut m = table_frame();
    for joint in m.bushings.iter_mut().filter(|j| j.id.ends_with('1')) {
        joint.torsional_stiffness_nm_rad = 0.0;
        joint.bending = [elastic(0.0), elastic(0.0)];
    }
    match simulate(&m) {
        Err(SolveError::Mechanism { body, .. }) => assert_eq!(body, "column1"),
        other => panic!("{other:?}"),
    }
}

/// The passes run away from what the hinges cannot carry; the error tells of the nearest of them, not of numbers that overflowed.
#[test]
fn an_overload_names_the_nearest_state() {
    let mut m = table_frame();
    m.bushings.retain(|j| !j.id.ends_with('2') && !j.id.ends_with('3'));
    m.bodies.retain(|b| b.id != "column2" && b.id != "column3");
    match simulate(&m) {
        Err(error @ SolveError::Preload { residual, .. }) => {
            assert!(residual > 0.0 && residual < 1.0, "{error}");
            assert!(error.to_string().contains("the dead load exceeds what the hinges carry"), "{error}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn tension_separates_a_joint() {
    let mut m = model("tension", 0.3, 0.01);
    m.bodies.push(solid("weight", [0.0, 0.0, -1.0], [1.0; 3]));
    let mut rope = joint("rope", None, "weight", [0.0; 3], 1e8, 1e7, [elastic(1e7), elastic(1e7)]);
    rope.tensile_capacity_n = Some(1.5 * 2500.0 * G);
    m.bushings.push(rope);
    // From rest the spring swings to twice the weight, so it breaks at half as much again.
    let result = simulate(&m).unwrap();
    assert!(
        matches!(&result.events[..], [e] if matches!(e.kind, EventKind::Fracture { .. })),
        "{:?}",
        result.events
    );
    assert!(result.frames.last().unwrap().position_m[0][2] < -1.2);
    // The joint breaks at full load within one step; the scale is that of half a millimetre of motion.
    assert!(result.energy_error < 0.05, "{}", result.energy_error);
}

/// Weakening takes what a joint bears in tension, compression and shear, as it does what it bears in bending.
#[test]
fn a_weakened_joint_bears_less_in_every_way() {
    let weight = DENSITY * G;
    for (direction, what) in [(-1.0, "tension"), (1.0, "compression"), (0.0, "shear")] {
        for factor in [0.7, 0.5] {
            let mut m = model(what, 0.5, 0.01);
            m.settings.preload = true;
            let at = [if direction == 0.0 { 0.5 } else { 0.0 }, 0.0, 0.5 * direction];
            m.bodies.push(solid("block", at, [1.0; 3]));
            let mut j = joint("j", None, "block", [0.0; 3], 1e8, 1e8, [elastic(1e8), elastic(1e8)]);
            if direction == 0.0 {
                j.axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            }
            // bears its weight up to a share of 0.6
            let capacity = Some(weight / 0.6);
            match what {
                "tension" => j.tensile_capacity_n = capacity,
                "compression" => (j.compressive_capacity_n, j.crushing_shortening_m) = (capacity, Some(1e-3)),
                _ => j.shear_capacity_n = capacity.map(|c| [c; 2]),
            }
            m.bushings.push(j);
            let weaken = vec![Weakening { id: "j".into(), factor }];
            m.events.push(Event { weaken, ..Event::at("e", 0.2) });
            let result = simulate(&m).unwrap();
            let broke = result.events.iter().any(|e| matches!(e.kind, EventKind::Fracture { .. }));
            assert_eq!(broke, factor < 0.6, "{what} {factor}: {:?}", result.events);
        }
    }
}

#[test]
fn a_bushing_that_is_too_stiff_is_named() {
    let mut m = model("stiff", 0.1, 0.01);
    m.bodies.push(solid("block", [0.0, 0.0, -0.5], [1.0; 3]));
    m.bodies.push(solid("other", [0.0, 0.0, -1.5], [1.0; 3]));
    let ends = || [elastic(1e8), elastic(1e8)];
    m.bushings.push(joint("soft", None, "block", [0.0; 3], 1e8, 1e8, ends()));
    m.bushings.push(joint("steel", Some("block"), "other", [0.0, 0.0, -1.0], 1e28, 1e8, ends()));
    let said = simulate(&m).unwrap_err().to_string();
    assert!(said.contains("\"steel\"") && said.contains("rad/s") && said.contains("ideal joint"), "{said}");
}

#[test]
fn what_has_no_capacity_cannot_be_weakened() {
    let mut m = model("endless", 0.1, 0.01);
    m.bodies.push(solid("block", [0.0, 0.0, -0.5], [1.0; 3]));
    m.bushings.push(joint("j", None, "block", [0.0; 3], 1e8, 1e8, [elastic(1e8), elastic(1e8)]));
    let weaken = vec![Weakening { id: "j".into(), factor: 0.5 }];
    m.events.push(Event { weaken, ..Event::at("e", 0.05) });
    let said = simulate(&m).unwrap_err().to_string();
    assert!(said.contains("events[0].weaken[0].id") && said.contains("neither curve nor capacity"), "{said}");
}

/// From rest a weight on a spring swings as `W (1 - cos ωt)`; across the axes of the joint it is an ellipse that says when it is sheared off. From then on it falls.
#[test]
fn shear_separates_a_joint() {
    let mut m = model("shear", 0.2, 0.01);
    m.bodies.push(solid("weight", [0.0; 3], [1.0; 3]));
    let (mass, stiffness) = (m.bodies[0].mass_kg, 1e8);
    let (sine, cosine) = 0.5_f64.sin_cos();
    let weight = mass * G;
    let capacity = [1.5 * weight, 1.2 * weight];
    m.bushings.push(Bushing {
        axes: [[0.0, 1.0, 0.0], [cosine, 0.0, -sine], [-sine, 0.0, -cosine]],
        shear_capacity_n: Some(capacity),
        ..joint("bracket", None, "weight", [0.0; 3], stiffness, 1e7, [elastic(1e7), elastic(1e7)])
    });
    m.settings.time_step_s = Some(2e-5);
    let result = simulate(&m).unwrap();
    let most = 1.0 / (sine / capacity[0]).hypot(cosine / capacity[1]);
    let rate = (stiffness / mass).sqrt();
    let time = (1.0 - most / weight).acos() / rate;
    let [event] = &result.events[..] else { panic!("{:?}", result.events) };
    assert!(matches!(event.kind, EventKind::Fracture { cause: FractureCause::Shear, .. }), "{event:?}");
    assert!((event.time_s - time).abs() < 3e-5, "{} {time}", event.time_s);
    let falls = 0.2 - time;
    let fallen = most / stiffness + G / rate * (rate * time).sin() * falls + 0.5 * G * falls * falls;
    let found = -result.frames.last().unwrap().position_m[0][2];
    assert!((found / fallen - 1.0).abs() < 1e-3, "{found} {fallen}");
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

/// A column that bears four fifths of what stands on it is pressed down by a fifth of gravity: `s = ½ (g - N/m) t²` until it is crushed.
#[test]
fn a_column_is_crushed_by_as_much_shortening_as_it_bears() {
    let mut m = model("crushing", 1.0, 0.01);
    let weight = solid("weight", [0.0, 0.0, 2.0], [1.0, 1.0, 4.0]);
    let load_n = weight.mass_kg * G;
    m.bodies.push(weight);
    let mut foot = joint("foot", None, "weight", [0.0; 3], 1e12, 1e8, [elastic(1e8), elastic(1e8)]);
    foot.axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    foot.compressive_capacity_n = Some(0.8 * load_n);
    foot.crushing_shortening_m = Some(0.1);
    m.bushings.push(foot);
    track(&mut m, "weight", [0.0; 3]);
    let result = simulate(&m).unwrap();
    let [event] = &result.events[..] else { panic!("{:?}", result.events) };
    assert!(matches!(event.kind, EventKind::Fracture { cause: FractureCause::Compression, .. }));
    let wanted = (2.0 * 0.1 / (0.2 * G)).sqrt();
    assert!((event.time_s / wanted - 1.0).abs() < 0.01, "{} {wanted}", event.time_s);
    // free fall after that
    let at = |i: usize| result.tracked[0].displacement_m[i][2];
    let acceleration = (at(90) - 2.0 * at(80) + at(70)) / 0.01;
    assert!((acceleration + G).abs() < 1e-6, "{acceleration}");
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

/// When a body first touches something.
fn touched_s(result: &fallwerk::mbs::result::RunResult, body: &str) -> Option<f64> {
    let met = |kind: &EventKind| matches!(kind, EventKind::Contact { a, .. } if a == body);
    result.events.iter().find(|e| met(&e.kind)).map(|e| e.time_s)
}

/// A column that stands on the ground, joined to it, goes on standing on it as its foot gives way: the first contact is that of a block that falls by 1 m, `√(2 h / g)`. The same of a
/// column in two bodies that are one while a latent bushing holds them together, and part before the foot gives way.
#[test]
fn what_stands_on_the_ground_does_not_come_down_on_it() {
    let mut m = model("first contact", 0.6, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.bodies.push(solid("column", [0.0, 0.0, 1.5], [0.4, 0.4, 3.0]));
    m.bodies.push(solid("block", [3.0, 0.0, 1.2], [0.4; 3]));
    let foot = joint("foot", None, "column", [0.0; 3], 1e9, 1e7, [elastic(1e7), elastic(1e7)]);
    m.bushings.push(foot);
    m.events.push(Event { release: vec!["foot".into()], ..Event::at("foot", 0.1) });
    let fallen_s = (2.0 / G).sqrt();
    for parts in [1, 2] {
        if parts == 2 {
            m.bodies[0] = solid("column", [0.0, 0.0, 0.75], [0.4, 0.4, 1.5]);
            m.bodies.push(solid("upper", [0.0, 0.0, 2.25], [0.4, 0.4, 1.5]));
            let at = [0.0, 0.0, 1.5];
            let middle = joint("middle", Some("column"), "upper", at, 1e9, 1e7, [elastic(1e7), elastic(1e7)]);
            m.bushings.push(Bushing { latent: Some("middle".into()), ..middle });
            m.events.push(Event { release: vec!["middle".into()], ..Event::at("middle", 0.05) });
        }
        let result = simulate(&m).unwrap();
        let [column_s, block_s] = ["column", "block"].map(|body| touched_s(&result, body));
        assert_eq!([column_s, result.first_ground_contact_s], [None, block_s]);
        assert!(block_s.is_some_and(|t| (t - fallen_s).abs() < 1e-3), "{block_s:?} {fallen_s}");
    }
    // what nothing holds comes down, if by little
    (m.bushings, m.events) = Default::default();
    let result = simulate(&m).unwrap();
    assert_eq!(result.first_ground_contact_s, touched_s(&result, "column"));
    assert!(result.first_ground_contact_s.is_some_and(|t| t < 0.2));
}

/// A column that topples over the edge of its foot comes down with its top: a block of half diagonal `r` turns with `3 g / (4 r) sin φ` until its side lies on the ground.
#[test]
fn the_top_of_a_column_that_topples_comes_down() {
    let mut m = model("toppling", 3.0, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 1.5, restitution: 0.0 });
    let mut column = solid("column", [0.0, 0.0, 2.0], [0.4, 0.4, 4.0]);
    (column.angular_velocity_rad_s, column.velocity_m_s) = ([0.0, 1.0, 0.0], [2.0, 0.0, 0.2]);
    m.bodies.push(column);
    m.bushings.push(joint("foot", None, "column", [0.0; 3], 1e9, 1e7, [elastic(1e7), elastic(1e7)]));
    m.events.push(Event { release: vec!["foot".into()], ..Event::at("foot", 0.0) });
    let result = simulate(&m).unwrap();
    let down_s = result.first_ground_contact_s.unwrap();
    assert_eq!(touched_s(&result, "column"), Some(down_s));
    let (h, edge) = (1e-4, 0.1_f64.atan());
    let (mut angle, mut speed, mut time_s) = (-edge, 1.0, 0.0);
    while angle < std::f64::consts::FRAC_PI_2 - edge {
        speed += h * 3.0 * G / (4.0 * 2.0_f64.hypot(0.2)) * angle.sin();
        (angle, time_s) = (angle + h * speed, time_s + h);
    }
    assert!((down_s - time_s).abs() < 0.02, "{down_s} {time_s}");
}

/// A floor whose column is crushed goes down to the ground through it, the column stands there.
#[test]
fn what_is_crushed_props_nothing_up() {
    let mut m = model("prop", 2.0, 0.01);
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    let shapes = |half: [f64; 3]| vec![Shape::cuboid([0.0; 3], half)];
    let column = solid("column", [0.0, 0.0, 1.5], [0.4, 0.4, 3.0]);
    m.bodies.push(Body { shapes: shapes([0.2, 0.2, 1.5]), ..column });
    let floor = solid("floor", [0.0, 0.0, 3.2], [4.0, 4.0, 0.2]);
    let load_n = floor.mass_kg * G;
    m.bodies.push(Body { shapes: shapes([2.0, 2.0, 0.1]), ..floor });
    let mut head =
        joint("head", Some("floor"), "column", [0.0, 0.0, 3.0], 1e9, 1e8, [elastic(1e8), elastic(1e8)]);
    head.axes = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    head.compressive_capacity_n = Some(0.5 * load_n);
    m.bushings.push(head);
    track(&mut m, "floor", [0.0, 0.0, 3.2]);
    let end = |m: &Model| simulate(m).unwrap().tracked[0].displacement_m.last().unwrap()[2];
    m.bushings[0].crushing_shortening_m = Some(0.1);
    let crushed = end(&m);
    assert!((crushed + 3.1).abs() < 0.01, "{crushed}");
    // nor do its halves, when it parts as the floor is on its way down
    let whole = m.bodies.remove(0);
    for (id, z) in [("low", 0.75), ("high", 2.25)] {
        let half = solid(id, [0.0, 0.0, z], [0.4, 0.4, 1.5]);
        m.bodies.push(Body { shapes: shapes([0.2, 0.2, 0.75]), ..half });
    }
    assert_eq!(whole.mass_kg, m.bodies[1].mass_kg + m.bodies[2].mass_kg);
    m.bushings[0].body_b = "high".into();
    let middle =
        joint("middle", Some("low"), "high", [0.0, 0.0, 1.5], 1e9, 1e8, [elastic(1e8), elastic(1e8)]);
    m.bushings.push(Bushing { latent: Some("middle".into()), ..middle });
    for parts_s in [0.4, 0.6, 0.8] {
        m.events = vec![Event { release: vec!["middle".into()], ..Event::at("parts", parts_s) }];
        let parted = end(&m);
        assert!((parted + 3.1).abs() < 0.01, "{parts_s}: {parted}");
    }
}

#[test]
fn crushing_and_ideal_joints_do_not_go_together() {
    let mut m = model("crushing", 1.0, 0.01);
    m.bodies.push(solid("weight", [0.0, 0.0, 2.0], [1.0, 1.0, 4.0]));
    let mut foot = joint("foot", None, "weight", [0.0; 3], 1e9, 1e8, [elastic(1e8), elastic(1e8)]);
    foot.crushing_shortening_m = Some(0.1);
    m.bushings.push(foot);
    assert!(m.check().is_ok());
    m.joints.push(Joint {
        id: "guide".into(),
        kind: JointKind::Spherical,
        body_a: None,
        body_b: "weight".into(),
        point_m: [0.0; 3],
        point_b_m: None,
        axis: None,
        axis_b: None,
        origin: Origin::default(),
    });
    let said = m.check().unwrap_err().to_string();
    assert!(said.contains("bushings[0].crushing_shortening_m: needs a model without ideal joints"), "{said}");
}

/// A sudden load `W` on a spring that flows from `N_0` on and hardens: it stops where `W u = ∫ N du`.
#[test]
fn a_member_that_hardens_stops_a_sudden_load() {
    let (mass, elastic_n_m, last_m) = (40_000.0, 1e9, 0.1);
    let weight = mass * G;
    let (first, most) = (0.7 * weight, 1.4 * weight);
    let mut m = model("hardening", 0.4, 0.0005);
    m.settings.time_step_s = Some(5e-5);
    let block = solid("block", [0.0, 0.0, 1.0], [1.0; 3]);
    m.bodies.push(Body { mass_kg: mass, inertia_kg_m2: box_inertia(mass, [1.0; 3]), ..block });
    let bending = [elastic(1e9), elastic(1e9)];
    m.bushings.push(Bushing {
        compressive_capacity_n: Some(most),
        compressive_hardening: vec![[0.0, 0.5], [0.5 * last_m, 0.75], [last_m, 1.0]],
        ..joint("column", None, "block", [0.0; 3], elastic_n_m, 1e9, bending)
    });
    track(&mut m, "block", [0.0, 0.0, 1.0]);
    let result = simulate(&m).unwrap();
    let down: Vec<f64> = result.tracked[0].displacement_m.iter().map(|u| -u[2]).collect();
    let deepest = down.iter().copied().fold(0.0, f64::max);
    // elastic up to u_0, then the slope of both in a row
    let slope = 1.0 / (1.0 / elastic_n_m + last_m / (most - first));
    let begins = first / elastic_n_m;
    // W (u_0 + x) = N_0 u_0 / 2 + N_0 x + s x² / 2
    let (p, q) = (weight - first, weight * begins - 0.5 * first * begins);
    let beyond = (p + (p * p + 2.0 * slope * q).sqrt()) / slope;
    println!("{deepest:.6} m, {:.6}", begins + beyond);
    assert!((deepest / (begins + beyond) - 1.0).abs() < 1e-3, "{deepest} {}", begins + beyond);
    assert!(result.energy_error < 1e-4, "{}", result.energy_error);
    // from there on it is elastic
    let after: Vec<f64> = down.iter().copied().skip_while(|u| *u < deepest).collect();
    let middle = 0.5 * (after.iter().copied().fold(f64::INFINITY, f64::min) + deepest);
    let unloads = first + slope * beyond - weight;
    assert!((deepest - middle - unloads / elastic_n_m).abs() < 0.02 * deepest, "{middle} {deepest}");

    type Change = fn(&mut Bushing);
    let wrong: [Change; 4] = [
        |b| b.compressive_hardening[0][0] = 0.01,
        |b| b.compressive_hardening[1][1] = 0.4,
        |b| b.compressive_hardening[2][1] = 1.1,
        |b| b.compressive_capacity_n = None,
    ];
    for change in wrong {
        let mut m = m.clone();
        change(&mut m.bushings[0]);
        let said = m.check().unwrap_err().to_string();
        assert!(said.starts_with("bushings[0].compressive_hardening: "), "{said}");
    }
}

/// Site grids and heights above the sea: the same state anywhere within a kilometre.
#[test]
fn the_static_state_does_not_depend_on_the_origin() {
    let here = simulate(&table_frame()).unwrap();
    let mut m = table_frame();
    let off = [900.0, -700.0, 450.0];
    let moved = |x: [f64; 3]| [0, 1, 2].map(|k| x[k] + off[k]);
    m.bodies.iter_mut().for_each(|b| b.position_m = moved(b.position_m));
    m.bushings.iter_mut().for_each(|b| b.point_m = moved(b.point_m));
    m.tracked.iter_mut().for_each(|t| t.point_m = moved(t.point_m));
    m.contact.ground.as_mut().unwrap().level_m = off[2];
    let there = simulate(&m).unwrap();
    let drift = there.tracked[0].displacement_m.iter().flatten().fold(0.0_f64, |a, u| a.max(u.abs()));
    assert!(drift < 1e-8, "{drift}");
    for (a, b) in here.hinges.iter().zip(&there.hinges) {
        assert!((a.axial_force_n[0] / b.axial_force_n[0] - 1.0).abs() < 1e-6, "{}", a.joint);
    }
}

/// Hinges that flow and harden by a small part of their elastic stiffness under dead load: `M = M_0 + s (θ - M/K)`, `M = m g a cos θ`.
#[test]
fn hinges_that_harden_find_their_static_state() {
    let (stiffness_nm_rad, mass, arm) = (1e6, 100.0, 1.0);
    for (first, slope) in [(500.0, 15e3), (500.0, 1e5), (900.0, 1e5), (500.0, 3e5)] {
        let mut m = model("cantilever", 0.1, 0.1);
        let capacity = [[0.0, first], [0.1, first + 0.1 * slope]];
        m.curves.insert(
            "c".into(),
            fallwerk::curve::ResistanceCurve { stiffness_nm_rad, ..curve(&capacity, 1.0) },
        );
        m.bodies.push(Body { mass_kg: mass, ..solid("beam", [arm, 0.0, 0.0], [2.0, 0.2, 0.2]) });
        m.bushings.push(Bushing {
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            ..joint("clamp", None, "beam", [0.0; 3], 1e9, 1e7, [hinge("c"), elastic(1e7)])
        });
        m.settings.preload = true;
        let result = simulate(&m).unwrap();
        let mut angle: f64 = 0.0;
        for _ in 0..2000 {
            let moment = mass * G * arm * angle.cos();
            angle += 0.1 * (moment / stiffness_nm_rad + (moment - first) / slope - angle);
        }
        let found = result.hinges[0].rotation_rad[0][0].abs();
        println!("{found:.8} {angle:.8}, {:?} iterations", result.preload_iterations);
        assert!((found / angle - 1.0).abs() < 1e-6, "{first} {slope}: {found} {angle}");
    }
}

/// A body whose centre of mass lies across axis 0 of its bracket: what is tension there does not depend on how the scene lies in space.
#[test]
fn a_bracket_tears_by_the_sense_of_its_axis() {
    for (up, tears) in [(1.0, false), (-1.0, true)] {
        for i in 0..8 {
            let (s, c) = (0.3 * f64::from(i)).sin_cos();
            let turned = |[x, y, z]: [f64; 3]| [c * x + s * z, y, c * z - s * x];
            let mut m = model("bracket", 0.2, 0.1);
            m.gravity_m_s2 = turned([0.0, 0.0, -10.0]);
            let half = 0.15 * f64::from(i);
            m.bodies.push(Body {
                mass_kg: 100.0,
                orientation: [half.cos(), 0.0, half.sin(), 0.0],
                ..solid("door", turned([1.0, 0.0, 0.0]), [2.0, 0.1, 1.0])
            });
            m.bushings.push(Bushing {
                axes: [[0.0, 0.0, up], [up, 0.0, 0.0], [0.0, 1.0, 0.0]].map(turned),
                tensile_capacity_n: Some(500.0),
                ..joint("bracket", None, "door", [0.0; 3], 1e7, 1e7, [elastic(1e7), elastic(1e7)])
            });
            let result = simulate(&m).unwrap();
            let torn = result.events.iter().any(|e| matches!(e.kind, EventKind::Fracture { .. }));
            assert_eq!(torn, tears, "{i}");
        }
    }
}
