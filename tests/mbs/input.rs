//! Complaints about wrong models name their place.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::simulate;

fn good() -> Model {
    let mut m = model("input", 0.1, 0.01);
    m.bodies.push(solid("a", [0.0, 0.0, 1.0], [1.0; 3]));
    m.curves.insert("c".into(), frame_curve());
    m.bushings.push(joint("j", None, "a", [0.0; 3], 1e8, 1e7, [hinge("c"), elastic(1e7)]));
    m
}

#[test]
fn every_wrong_value_is_named() {
    type Change = fn(&mut Model);
    let cases: [(Change, &str); 22] = [
        (|m| m.schema = "x".into(), "schema: "),
        (|m| m.bodies[0].mass_kg = 0.0, "bodies[0].mass_kg: "),
        (|m| m.bodies[0].inertia_kg_m2[1][1] = -1.0, "bodies[0].inertia_kg_m2: is not positive definite"),
        (
            |m| m.bodies[0].inertia_kg_m2[1][1] *= 3.0,
            "bodies[0].inertia_kg_m2: violates the triangle inequality",
        ),
        (|m| m.bodies[0].position_m[2] = f64::NAN, "bodies[0].position_m: "),
        (|m| m.bodies[0].orientation[0] = 0.5, "bodies[0].orientation: "),
        (|m| m.bodies.push(solid("a", [0.0; 3], [1.0; 3])), "bodies[1].id: \"a\" is used twice"),
        (
            |m| m.bushings[0].body_b = "aa".into(),
            "bushings[0].body_b: \"aa\" is not the id of a body (did you mean \"a\"?)",
        ),
        (|m| m.bushings[0].axes[0] = [0.0, 0.1, 1.0], "bushings[0].axes: "),
        (|m| m.bushings[0].bending[0] = hinge("d"), "bushings[0].bending[0].curve: \"d\" is not in curves"),
        (
            |m| m.curves.get_mut("c").unwrap().levels[0].capacity[1][0] = -1.0,
            "curves.c: levels[0].capacity[1]",
        ),
        (|m| m.settings.end_time_s = -1.0, "settings.end_time_s: "),
        (
            |m| (m.settings.end_time_s, m.settings.output_interval_s) = (1e300, 1e299),
            "settings.end_time_s: is 1e300, expected at most 1e9 s",
        ),
        (|m| m.bodies[0].mass_kg = 1e-300, "bodies[0].mass_kg: is 1e-300, expected at least 1e-12 kg"),
        (
            |m| m.bodies[0].velocity_m_s[1] = -1e200,
            "bodies[0].velocity_m_s: is 1e200, expected at most 1e8 m/s",
        ),
        (|m| m.bodies[0].id.clear(), "bodies[0].id: is \"\", expected a name"),
        (|m| m.bushings[0].id.clear(), "bushings[0].id: is \"\", expected a name"),
        (
            |m| {
                m.bodies.push(solid("b", [3.0, 0.0, 1.0], [1.0; 3]));
                m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
                m.contact.pairs.push(PairRule {
                    a: "a".into(),
                    b: "b".into(),
                    ignore: false,
                    friction: None,
                    restitution: None,
                    rolling_m: None,
                });
            },
            "contact.pairs[0]: changes nothing",
        ),
        (
            |m| {
                m.forces.push(Force::Spring {
                    id: "s".into(),
                    body_a: None,
                    body_b: "a".into(),
                    point_a_m: [0.0, 0.0, 1.0],
                    point_b_m: [0.0, 1e-16, 1.0],
                    length_m: Some(0.5),
                    stiffness_n_m: 1e3,
                    damping_n_s_m: 0.0,
                });
            },
            "forces[0].point_b_m: is at point_a_m",
        ),
        (
            |m| m.settings.time_step_s = Some(1e-300),
            "settings.time_step_s: is 1e-300, with which settings.end_time_s = 0.1 takes 1.0e299 steps, at most 2e9",
        ),
        (|m| m.settings.time_step_s = Some(1e-15), "settings.time_step_s: is 1e-15, with which"),
        (
            |m| m.tracked.push(TrackedPoint { id: "t".into(), body: "b".into(), point_m: [0.0; 3] }),
            "tracked[0].body: ",
        ),
    ];
    assert!(good().check().is_ok());
    for (change, expected) in cases {
        let mut m = good();
        change(&mut m);
        let text = m.check().unwrap_err().to_string();
        assert!(text.contains(expected), "expected {expected:?} in {text:?}");
    }
}

/// Pairs and events tell what bodies meet by its name alone.
#[test]
fn whatever_may_be_met_has_a_name_of_its_own() {
    let plane = |id: &str| ObstaclePlane {
        id: id.into(),
        point_m: [0.0; 3],
        normal: [0.0, 0.0, 1.0],
        friction: 0.5,
        restitution: 0.0,
    };
    let obstacle = |id: &str| ObstacleBox {
        id: id.into(),
        min_m: [5.0; 3],
        max_m: [6.0; 3],
        friction: 0.5,
        restitution: 0.0,
    };
    let complaints = |planes: &[&str], obstacles: &[&str]| {
        let mut m = good();
        m.contact.planes = planes.iter().map(|id| plane(id)).collect();
        m.contact.obstacles = obstacles.iter().map(|id| obstacle(id)).collect();
        m.check().map_or_else(|e| e.to_string(), |()| String::new())
    };
    assert_eq!(complaints(&["slope"], &["wall"]), "");
    for (planes, obstacles, expected) in [
        (&["a"][..], &[][..], "contact.planes[0].id: \"a\" is also the id of bodies[0]"),
        (&[], &["a"], "contact.obstacles[0].id: \"a\" is also the id of bodies[0]"),
        (&["p"], &["p"], "contact.obstacles[0].id: \"p\" is also the id of contact.planes[0]"),
        (&["p", "p"], &[], "contact.planes[1].id: \"p\" is also the id of contact.planes[0]"),
        (&[], &["w", "w"], "contact.obstacles[1].id: \"w\" is also the id of contact.obstacles[0]"),
    ] {
        assert_eq!(complaints(planes, obstacles), format!("{expected}: give one of them another id"));
    }
    let mut m = good();
    m.bodies.push(solid("ground", [5.0; 3], [1.0; 3]));
    m.contact.planes.push(plane("ground"));
    let text = m.check().unwrap_err().to_string();
    for place in ["bodies[1].id", "contact.planes[0].id"] {
        let expected = format!("{place}: \"ground\" is also the name of the ground: give it another id");
        assert!(text.contains(&expected), "{text}");
    }
}

fn ideal_joint(id: &str, body_a: Option<&str>, body_b: &str) -> Joint {
    Joint {
        id: id.into(),
        kind: JointKind::Spherical,
        body_a: body_a.map(Into::into),
        body_b: body_b.into(),
        point_m: [0.0; 3],
        axis: None,
        axis_b: None,
        point_b_m: None,
        origin: Origin::default(),
    }
}

fn spring(id: &str) -> Force {
    Force::Spring {
        id: id.into(),
        body_a: None,
        body_b: "a".into(),
        point_a_m: [0.0; 3],
        point_b_m: [0.0, 0.0, 1.0],
        length_m: None,
        stiffness_n_m: 1e4,
        damping_n_s_m: 0.0,
    }
}

/// Events release and weaken joints, bushings and forces by their name alone.
#[test]
fn whatever_may_be_released_has_a_name_of_its_own() {
    let said = |joints: &[&str], bushing: &str, forces: &[&str]| {
        let mut m = good();
        m.bushings[0].id = bushing.into();
        m.joints = joints.iter().map(|id| ideal_joint(id, None, "a")).collect();
        m.forces = forces.iter().map(|id| spring(id)).collect();
        m.check().map_or_else(|e| e.to_string(), |()| String::new())
    };
    assert_eq!(said(&["h"], "j", &["f", "a"]), "");
    for (joints, bushing, forces, expected) in [
        (&["j"][..], "j", &[][..], "bushings[0].id: \"j\" is also the id of joints[0]"),
        (&[], "j", &["f", "j"], "forces[1].id: \"j\" is also the id of bushings[0]"),
        (&["h"], "j", &["h"], "forces[0].id: \"h\" is also the id of joints[0]"),
        (&["h", "h"], "j", &[], "joints[1].id: \"h\" is also the id of joints[0]"),
        (&[], "j", &["f", "f"], "forces[1].id: \"f\" is also the id of forces[0]"),
    ] {
        assert_eq!(said(joints, bushing, forces), format!("{expected}: give one of them another id"));
    }
}

#[test]
fn a_hinge_opens_a_joint_between_its_own_bodies() {
    let said = |body_a: Option<&str>, body_b: &str| {
        let mut m = good();
        m.bushings.clear();
        m.bodies.extend(["b", "c"].map(|id| solid(id, [5.0, 0.0, 1.0], [1.0; 3])));
        m.joints.push(ideal_joint("pin", Some("a"), "b"));
        m.forces.push(Force::Hinge {
            id: "h".into(),
            body_a: body_a.map(Into::into),
            body_b: body_b.into(),
            stiffness_nm_rad: 1e6,
            capacity: vec![[0.0, 1e3]],
            fracture_rad: Some(0.1),
            joint: Some("pin".into()),
        });
        m.check().map_or_else(|e| e.to_string(), |()| String::new())
    };
    assert_eq!(said(Some("a"), "b"), "");
    assert_eq!(said(Some("b"), "a"), "");
    let expected =
        "forces[0].joint: \"pin\" joins other bodies, expected one between the two bodies of the hinge";
    for (body_a, body_b) in [(Some("a"), "c"), (Some("c"), "b"), (None, "b")] {
        assert_eq!(said(body_a, body_b), expected);
    }
}

/// A rule about a pair that cannot meet says nothing, so that it is a mistake.
#[test]
fn pairs_that_cannot_meet_are_told() {
    let said = |b: &str, ignore: bool, change: fn(&mut Model)| {
        let mut m = good();
        m.bodies.push(solid("b", [5.0, 0.0, 1.0], [1.0; 3]));
        m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 0.5, restitution: 0.0 });
        m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
        let (friction, restitution, rolling_m) = (Some(0.3), None, None);
        m.contact.pairs.push(PairRule {
            a: "a".into(),
            b: b.into(),
            ignore,
            friction,
            restitution,
            rolling_m,
        });
        change(&mut m);
        m.check().map_or_else(|e| e.to_string(), |()| String::new())
    };
    for b in ["b", "ground"] {
        assert_eq!(said(b, false, |_| ()), "");
    }
    assert_eq!(
        said("a", false, |_| ()),
        "contact.pairs[0].b: is \"a\", the same as a; expected two that can meet"
    );
    assert_eq!(
        said("ground", false, |m| m.contact.ground = None),
        "contact.pairs[0].b: is \"ground\", but there is none: give contact.ground, or leave the rule out"
    );
    assert_eq!(
        said("b", false, |m| m.contact.bodies = None),
        "contact.pairs[0].b: is the body \"b\", but bodies do not touch each other: give contact.bodies, or leave the rule out"
    );
    // who has bodies pass through each other may still have all of them do so
    assert_eq!(said("b", true, |m| m.contact.bodies = None), "");
}

fn event(id: &str, time_s: f64, remove_bodies: &[&str], release: &[&str]) -> Event {
    let list = |ids: &[&str]| ids.iter().map(|id| id.to_string()).collect();
    Event {
        id: id.into(),
        time_s,
        remove_bodies: list(remove_bodies),
        release: list(release),
        weaken: Vec::new(),
        origin: Origin::default(),
    }
}

#[test]
fn what_is_gone_cannot_go_again() {
    let complaints = |events: Vec<Event>| {
        let mut m = good();
        m.events = events;
        m.check().map_or_else(|e| e.to_string(), |()| String::new())
    };
    // a joint that is released may belong to a body that vanishes later
    assert_eq!(complaints(vec![event("cut", 0.02, &[], &["j"]), event("charge", 0.05, &["a"], &[])]), "");
    let text = complaints(vec![event("late", 0.05, &["a"], &[]), event("early", 0.02, &["a"], &[])]);
    let said =
        "events[0].remove_bodies[0]: \"a\" is gone since event \"early\" at 0.02 s: leave one of both out";
    assert_eq!(text, said);
    let text = complaints(vec![event("one", 0.0, &[], &["j"]), event("two", 0.0, &[], &["j", "j"])]);
    let said = |place: usize| {
        format!("events[1].release[{place}]: \"j\" is gone since event \"one\" at 0 s: leave one of both out")
    };
    assert_eq!(text, format!("{}\n{}", said(0), said(1)));
    // what holds a body goes with it
    let text = complaints(vec![event("one", 0.0, &["a"], &[]), event("two", 0.01, &[], &["j"])]);
    let said =
        "events[1].release[0]: \"j\" is gone with \"a\" since event \"one\" at 0 s: leave one of both out";
    assert_eq!(text, said);
    let mut late = event("late", 0.02, &[], &[]);
    late.weaken = vec![Weakening { id: "j".into(), factor: 0.5 }];
    let text = complaints(vec![event("cut", 0.0, &[], &["j"]), late]);
    assert!(text.starts_with("events[1].weaken[0].id: \"j\" is gone since event \"cut\" at 0 s"), "{text}");
}

#[test]
fn events_after_the_end_are_told() {
    let mut bushings = good();
    bushings.events = vec![event("soon", 0.05, &[], &["j"]), event("at the end", 0.1, &["a"], &[])];
    let mut ideal = good();
    ideal.bushings.clear();
    ideal.joints.push(ideal_joint("j", None, "a"));
    for mut m in [bushings, ideal] {
        let late = |m: &Model| {
            let warnings = simulate(m).unwrap().warnings;
            warnings.into_iter().filter(|w| w.contains("not happen")).collect::<Vec<_>>()
        };
        assert!(late(&m).is_empty());
        m.events.push(event("never", 3.0, &[], &[]));
        m.events.push(event("charge", 0.2, &[], &[]));
        let [said] = &late(&m)[..] else { panic!("{:?}", late(&m)) };
        assert_eq!(
            said,
            "event \"charge\" at 0.2 s and 1 more do not happen: the run ends before, at settings.end_time_s = 0.1"
        );
    }
}

/// What has the wrong type is told with its path.
#[test]
fn wrong_types_are_told_with_their_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.json");
    let said = |from: &str, to: &str| {
        let text = serde_json::to_string_pretty(&good()).unwrap();
        assert!(text.contains(from), "{text}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        Model::read(&path).unwrap_err().to_string()
    };
    for (from, to, expected) in [
        (
            "\"mass_kg\": 2500.0",
            "\"mass_kg\": \"heavy\"",
            "model.json: bodies[0].mass_kg: invalid type: string \"heavy\", expected f64 at line",
        ),
        ("\"mass_kg\"", "\"mass\"", "model.json: bodies[0].mass: unknown field `mass`"),
        (
            "\"end_time_s\": 0.1",
            "\"end_time_s\": [0.1]",
            "model.json: settings.end_time_s: invalid type: sequence",
        ),
        ("\"gravity_m_s2\"", "\"gravity\"", "model.json: gravity: unknown field `gravity`"),
        (
            "\"strength_factor\"",
            "\"strenght_factor\"",
            "bushings[0].bending[0]: unknown field `strenght_factor`, expected `curve` or `strength_factor`",
        ),
        ("\"stiffness_nm_rad\"", "\"stiffness\"", "curves.c.stiffness: unknown field `stiffness`"),
        ("\"capacity\"", "\"capacities\"", "curves.c.levels[0].capacities: unknown field `capacities`"),
        ("\"mass_kg\": 2500.0", "\"mass_kg\": NaN", "model.json: bodies[0].mass_kg: is NaN at line"),
        ("\"end_time_s\": 0.1", "\"end_time_s\": 1e999", "model.json: settings.end_time_s: is 1e999 at line"),
    ] {
        let said = said(from, to);
        assert!(said.contains(expected), "{said}");
    }
}

/// Files that are no models say what they are.
#[test]
fn what_is_no_model_is_told_as_what_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.json");
    let building = "# A building.\n\nschema = 1\nname = \"house\"\n";
    for (text, expected) in [
        ("", "model.json: is empty, expected JSON"),
        ("[]", "model.json: is a list, expected the keys of a model, {\"schema\": ...}"),
        ("[1, 2]", "model.json: is a list,"),
        (
            building,
            "model.json: is TOML, as building files are, expected a model in JSON: `fallwerk generate-mbs`",
        ),
        ("[[members]]\n", "model.json: is TOML,"),
        ("\u{feff}{}", "model.json: begins with a byte order mark"),
        ("{\"schema\": \"fallwerk-mbs/1\", \"bodys\": NaN}", "model.json: bodys: unknown field `bodys`"),
        (
            "{\"schema\": \"fallwerk-mbs/1\", \"bodys\": 1}",
            "schema: is \"fallwerk-mbs/1\", expected \"fallwerk-mbs/2\"",
        ),
    ] {
        std::fs::write(&path, text).unwrap();
        let said = Model::read(&path).unwrap_err().to_string();
        assert!(said.contains(expected), "expected {expected:?} in {said:?}");
    }
}

#[test]
fn a_model_survives_its_file_and_the_command_writes_the_histories() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.json");
    std::fs::write(&path, serde_json::to_string(&good()).unwrap()).unwrap();
    assert_eq!(Model::read(&path).unwrap(), good());
    let output = folder.path().join("out");
    let args = fallwerk::cli::simulate::SimulateArgs {
        model: path,
        output: Some(output.clone()),
        latent: Default::default(),
        step: Default::default(),
        json: true,
        compute_all: false,
    };
    fallwerk::cli::simulate::run(args).unwrap();
    for name in ["result.json", "displacements.csv", "hinges.csv", "energies.csv"] {
        assert!(output.join(name).exists(), "{name}");
    }
    let text = std::fs::read_to_string(output.join("result.json")).unwrap();
    let lists: serde_json::Value = serde_json::from_str(&text).unwrap();
    for name in ["latent", "crushed", "turns", "reactions"] {
        assert!(lists[name].as_array().is_some_and(Vec::is_empty), "{name}: {}", lists[name]);
    }
    let result: fallwerk::mbs::RunResult = serde_json::from_str(&text).unwrap();
    assert_eq!(result.times_s.len(), 11);
}
