//! Rules about contacts and fractures: what they have watched, when, and what that changes.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::math;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::{RunResult, SolverOptions, simulate, simulate_with};

const FALL_M: f64 = 1.0;
const ALONG: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A bar along x of two pieces that falls flat, and strikes a block with one end. Its section in the middle bears `moment_nm`, and would give way in flight if it were weaker than its own inertia asks for, which is nothing.
fn falling_bar(moment_nm: f64) -> Model {
    let mut m = model("bar", 0.7, 0.005);
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, moment_nm], [0.1, moment_nm]],
        fracture_rotation_rad: 0.5,
    };
    m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 2e7, levels: vec![level], cyclic: None });
    for (id, x) in [("left", 1.0), ("right", 3.0)] {
        m.bodies.push(solid(id, [x, 0.0, FALL_M + 0.5], [2.0, 0.2, 0.2]));
    }
    m.bushings.push(section("middle", "left", "right", [2.0, 0.0, FALL_M + 0.5]));
    m.contact.obstacles.push(ObstacleBox {
        id: "kerb".into(),
        min_m: [-0.5, -1.0, 0.0],
        max_m: [0.5, 1.0, 0.4],
        friction: 0.5,
        restitution: 0.0,
    });
    m
}

fn section(id: &str, a: &str, b: &str, point: [f64; 3]) -> Bushing {
    let mut bushing = joint(id, Some(a), b, point, 1e9, 1e7, [hinge("c"), hinge("c")]);
    bushing.axes = ALONG;
    bushing.latent = Some(id.into());
    bushing
}

fn contact_rule(id: &str, partners: &[Met], speed: Range, watch: &[&str]) -> EventRule {
    EventRule {
        id: id.into(),
        question: "change".into(),
        on: Trigger::Contact {
            partners: partners.to_vec(),
            approach_speed_m_s: speed,
            time_s: Range::default(),
        },
        bodies: vec!["left".into(), "right".into()],
        watch: watch.iter().map(|w| w.to_string()).collect(),
        nearest: false,
        origin: Origin::default(),
    }
}

fn at_least(least: f64) -> Range {
    Range { least: Some(least), most: None }
}

/// Rules that fired, with what they had watched, and latent bushings that gave way; with the times.
fn told(result: &RunResult) -> Vec<(f64, String)> {
    let words = |kind: &EventKind| match kind {
        EventKind::Rule { rule, watched, .. } => Some(format!("{rule}: {}", watched.join(" "))),
        EventKind::Live { joint, .. } => Some(format!("live {joint}")),
        _ => None,
    };
    result.events.iter().filter_map(|e| Some((e.time_s, words(&e.kind)?))).collect()
}

fn words(result: &RunResult) -> Vec<String> {
    told(result).into_iter().map(|(_, w)| w).collect()
}

/// The speed of free fall through a height, at the time of it.
#[test]
fn a_bar_may_break_from_the_blow_on_that_a_rule_asks_for() {
    let mut m = falling_bar(100.0);
    m.event_rules = vec![contact_rule("blow", &[Met::Obstacle], at_least(4.3), &["middle"])];
    let result = simulate(&m).unwrap();
    let told = told(&result);
    assert_eq!(words(&result), ["blow: middle", "live middle"]);
    // nobody asks before the blow, and there is nothing left to ask after it
    let work = result.body_work;
    assert!(work.latent_steps > 100 && work.unwatched_steps + 1 >= work.latent_steps, "{work:?}");
    let time = (2.0 * FALL_M / G).sqrt();
    assert!(told.iter().all(|(t, _)| (t - time).abs() < 2e-3), "{told:?} {time}");
    let speed = result.events.iter().find_map(|e| match &e.kind {
        EventKind::Rule { approach_speed_m_s, with, .. } => Some((approach_speed_m_s.unwrap(), with.clone())),
        _ => None,
    });
    let (speed, with) = speed.unwrap();
    assert_eq!(with, "kerb");
    assert!((speed - (2.0 * G * FALL_M).sqrt()).abs() < 0.01, "{speed}");
    // from the blow on it is as if it had been watched from the start
    let mut watched = m.clone();
    watched.event_rules.clear();
    let watched = simulate(&watched).unwrap();
    assert_eq!((&result.frames, &result.energies), (&watched.frames, &watched.energies));
    // free fall ends at 4.43 m/s: a rule that asks for more is never true
    m.event_rules = vec![contact_rule("blow", &[Met::Obstacle], at_least(4.5), &["middle"])];
    let whole = simulate(&m).unwrap();
    assert_eq!(words(&whole), Vec::<String>::new());
    assert_eq!(whole.latent[0].live_s, None);
    assert_eq!(whole.latent[0].largest_share, 0.0);
    // nor is one about something else
    m.event_rules = vec![contact_rule("blow", &[Met::Ground, Met::Part], Range::default(), &["middle"])];
    assert_eq!(simulate(&m).unwrap().frames, whole.frames);
}

/// Of the rules of a question the first that is true decides; another question has its own answer.
#[test]
fn the_first_rule_of_a_question_decides() {
    let mut m = falling_bar(100.0);
    let keep = contact_rule("keep", &[Met::Obstacle], Range::default(), &[]);
    let blow = contact_rule("blow", &[Met::Obstacle], Range::default(), &["middle"]);
    m.event_rules = vec![keep.clone(), blow.clone()];
    assert_eq!(words(&simulate(&m).unwrap()), Vec::<String>::new());
    m.event_rules = vec![blow.clone(), keep.clone()];
    assert_eq!(words(&simulate(&m).unwrap())[0], "blow: middle");
    let other = EventRule { id: "other".into(), question: "rigidity".into(), ..blow };
    m.event_rules = vec![keep, other];
    assert_eq!(words(&simulate(&m).unwrap())[0], "other: middle");
    // and a rule about other bodies says nothing
    m.event_rules[1].bodies = vec!["far".into()];
    m.bodies.push(solid("far", [50.0, 0.0, 20.0], [1.0; 3]));
    assert_eq!(words(&simulate(&m).unwrap()), Vec::<String>::new());
}

/// What is latent and waits is rigid at no cost: the same as the bar in one piece, and as one that is watched and strong enough.
#[test]
fn what_waits_moves_as_what_is_watched_and_holds() {
    let mut waits = falling_bar(100.0);
    waits.event_rules = vec![contact_rule("blow", &[Met::Part], Range::default(), &["middle"])];
    let strong = falling_bar(1e9);
    let (a, b) = (simulate(&waits).unwrap(), simulate(&strong).unwrap());
    assert_eq!(a.frames, b.frames);
    assert_eq!(a.energies, b.energies);
}

/// With latent bushings switched off a bar that would break stays whole, watched or not, and the run says what it is for.
#[test]
fn switched_off_nothing_gives_way() {
    let off = SolverOptions { hold_latent: true, ..SolverOptions::default() };
    let strong = simulate(&falling_bar(1e9)).unwrap();
    let mut m = falling_bar(100.0);
    for rules in [Vec::new(), vec![contact_rule("blow", &[Met::Obstacle], Range::default(), &["middle"])]] {
        m.event_rules = rules;
        assert!(words(&simulate(&m).unwrap()).contains(&"live middle".into()));
        let held = simulate_with(&m, &off).unwrap();
        assert_eq!(words(&held), Vec::<String>::new());
        assert_eq!((&held.frames, &held.energies), (&strong.frames, &strong.energies));
        assert_eq!(held.latent[0].live_s, None);
        assert!(held.warnings[0].contains("bushings: 1") && held.warnings[0].contains("for comparison only"));
    }
    assert!(simulate_with(&falling_bar(1e9), &SolverOptions::default()).unwrap().warnings.is_empty());
    // a charge that takes a piece still parts it from the rest
    m.events = vec![Event { remove_bodies: vec!["left".into()], ..Event::at("charge", 0.2) }];
    let held = simulate_with(&m, &off).unwrap();
    assert_eq!(words(&held), ["live middle"]);
}

/// A bar of three pieces hangs from both ends; when the bushing at one of them breaks, the section next to it is watched, the other one when that breaks.
#[test]
fn a_fracture_wakes_the_section_next_to_it() {
    let mut m = falling_bar(100.0);
    m.contact.obstacles.clear();
    m.bodies.push(solid("third", [5.0, 0.0, FALL_M + 0.5], [2.0, 0.2, 0.2]));
    m.bushings.push(section("second", "right", "third", [4.0, 0.0, FALL_M + 0.5]));
    for (id, body, x) in [("hold-left", "left", 0.0), ("hold-right", "third", 6.0)] {
        let held = joint(id, None, body, [x, 0.0, FALL_M + 0.5], 1e7, 1e6, [elastic(1e5), elastic(1e5)]);
        m.bushings.push(Bushing { axes: ALONG, ..held });
    }
    // half of the weight, 2943 N, comes on at once and overshoots
    m.bushings[3].shear_capacity_n = Some([4000.0; 2]);
    let fracture = |id: &str, places: Vec<Broken>, after_contact: Option<bool>| EventRule {
        id: id.into(),
        on: Trigger::Fracture { places, after_contact, time_s: Range::default() },
        watch: vec!["middle".into(), "second".into()],
        nearest: true,
        ..contact_rule(id, &[], Range::default(), &[])
    };
    m.event_rules = vec![
        fracture("span", vec![Broken::Span], None),
        fracture("late", vec![Broken::End], Some(true)),
        fracture("end", vec![Broken::End], Some(false)),
    ];
    m.event_rules.iter_mut().for_each(|r| r.bodies.push("third".into()));
    let result = simulate(&m).unwrap();
    let broken = result.events.iter().find(|e| matches!(e.kind, EventKind::Fracture { .. })).unwrap();
    let told = told(&result);
    assert_eq!(told[0].1, "end: second", "{told:?}");
    assert_eq!(told[0].0, broken.time_s);
    assert_eq!(told[1].1, "live second");
    // which breaks later on, between the ends of the bar: that is for the rule about spans
    assert_eq!(told[2].1, "span: middle");
    let second = result.events.iter().find(|e| {
        matches!(&e.kind, EventKind::Fracture { joint, .. } if joint == "second") && e.time_s == told[2].0
    });
    assert!(second.is_some(), "{told:?}");
}

/// Bodies may share inertia beside others with latent bushings, which wait; once one parts nothing is shared, and no energy is lost.
#[test]
fn a_body_parts_beside_bodies_that_share_inertia() {
    let mut m = falling_bar(100.0);
    m.event_rules = vec![contact_rule("blow", &[Met::Obstacle], Range::default(), &["middle"])];
    // a beam of two halves far away, which swings while it falls
    let far = |p: [f64; 3]| [p[0], p[1] + 20.0, p[2] + 50.0];
    let beam = super::shared_mass::halves();
    m.bodies.extend(beam.bodies.into_iter().map(|b| Body { position_m: far(b.position_m), ..b }));
    m.bushings.extend(beam.bushings.into_iter().map(|b| Bushing {
        id: format!("far {}", b.id),
        point_m: far(b.point_m),
        ..b
    }));
    m.bodies.iter_mut().filter(|b| b.id == "a").for_each(|b| b.velocity_m_s = [0.0, 0.0, 0.2]);
    m.shared_masses = vec![super::shared_mass::shared()];
    // the blow loads a stiff bar within a step
    m.settings.time_step_s = Some(1e-5);
    let result = simulate(&m).unwrap();
    assert_eq!(words(&result), ["blow: middle", "live middle"]);
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
    let alone = {
        let mut m = m.clone();
        m.shared_masses.clear();
        simulate(&m).unwrap()
    };
    let moved = math::norm(math::sub(alone.frames[20].position_m[2], result.frames[20].position_m[2]));
    assert!(moved > 1e-4, "the inertia is not shared: {moved}");
}

#[test]
fn wrong_rules_are_told_with_their_place() {
    let mut m = falling_bar(100.0);
    let rule = contact_rule("r", &[Met::Obstacle], Range { least: Some(3.0), most: Some(2.0) }, &["midle"]);
    m.event_rules = vec![rule.clone(), EventRule { bodies: Vec::new(), ..rule }];
    let error = simulate(&m).unwrap_err().to_string();
    for part in [
        "event_rules[1].id: \"r\" is used twice",
        "event_rules[0].watch[0]: \"midle\" is not the id of a latent bushing (did you mean \"middle\"?)",
        "event_rules[0].on.approach_speed_m_s: is from 3 to 2, which holds no number",
        "event_rules[1].bodies: is empty",
    ] {
        assert!(error.contains(part), "{error}");
    }
    m.event_rules = vec![contact_rule("r", &[], Range::default(), &["middle"])];
    let error = simulate(&m).unwrap_err().to_string();
    assert!(error.contains("event_rules[0].on.partners: is empty, so that the rule never fires"), "{error}");
}

/// A rule about slow approaches is not true of what is left of a blow in the next step, nor of bodies that lie on each other.
#[test]
fn what_lies_or_is_being_struck_does_not_meet_anew() {
    let slow = Range { least: None, most: Some(3.0) };
    for fall_m in [0.9, 1.0, 1.1, 1.2, 1.3, 1.5] {
        let mut m = falling_bar(1e9);
        m.settings.end_time_s = 1.0;
        for piece in &mut m.bodies {
            piece.position_m[2] += fall_m - FALL_M;
        }
        m.bushings[0].point_m[2] += fall_m - FALL_M;
        m.contact.obstacles[0].max_m[0] = 5.0;
        m.event_rules = vec![contact_rule("slow", &[Met::Obstacle], slow, &["middle"])];
        assert_eq!(words(&simulate(&m).unwrap()), Vec::<String>::new(), "{fall_m} m");
        // slow ones are told: the free fall of 0.4 m ends at 2.8 m/s
        for piece in &mut m.bodies {
            piece.position_m[2] -= fall_m - 0.4;
        }
        m.bushings[0].point_m[2] -= fall_m - 0.4;
        assert_eq!(words(&simulate(&m).unwrap()), ["slow: middle"]);
    }
}

/// Who lies on the kerb from the start has not met it; a blow from above makes it meet what strikes, and the kerb harder.
#[test]
fn contact_at_rest_is_no_meeting_until_a_blow_comes_through() {
    let mut m = falling_bar(1e9);
    m.settings.end_time_s = 0.5;
    for piece in &mut m.bodies {
        piece.position_m[2] = 0.5;
    }
    m.bushings[0].point_m[2] = 0.5;
    m.contact.obstacles[0].max_m[0] = 5.0;
    m.event_rules = vec![contact_rule("kerb", &[Met::Obstacle], Range::default(), &["middle"])];
    assert_eq!(words(&simulate(&m).unwrap()), Vec::<String>::new());
    let mut upper = solid("upper", [2.0, 0.0, 1.2], [0.4, 0.2, 0.2]);
    upper.velocity_m_s = [0.0, 0.0, -2.0];
    m.bodies.push(upper);
    m.contact.bodies = Some(BodyContact { friction: 0.3, restitution: 0.0 });
    m.event_rules.push(EventRule {
        question: "part".into(),
        ..contact_rule("part", &[Met::Part], at_least(2.5), &["middle"])
    });
    assert_eq!(words(&simulate(&m).unwrap()), ["part: middle"]);
}
