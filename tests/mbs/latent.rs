//! Latent bushings: what they bear, when bodies part, what is conserved.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::latent::{Latent, compounds};
use fallwerk::mbs::math;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::{EventKind, FractureCause};
use fallwerk::mbs::{RunResult, SolverOptions, simulate, simulate_with};

const LENGTH: f64 = 9.0;
/// Thin: theory leaves the rotary inertia of the section out, `WIDTH²/LENGTH²`.
const WIDTH: f64 = 0.06;

/// A bushing of a rod along `axis 0`, with the stiffness of a length of concrete, that breaks in bending or tension.
fn section(id: &str, a: &str, b: &str, point: [f64; 3], axes: [[f64; 3]; 3], curve: &str) -> Bushing {
    let mut bushing = joint(id, Some(a), b, point, 1e9, 1e7, [hinge(curve), hinge(curve)]);
    bushing.axes = axes;
    bushing.latent = Some(id.into());
    bushing
}

fn capacity(model: &mut Model, id: &str, moment_nm: f64) {
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, moment_nm], [0.1, moment_nm]],
        fracture_rotation_rad: 0.5,
    };
    let curve = ResistanceCurve { stiffness_nm_rad: 2e7, levels: vec![level], cyclic: None };
    model.curves.insert(id.into(), curve);
}

/// A rod of `n` pieces on the x axis, from the origin.
fn rod(n: usize, moment_nm: f64) -> Model {
    let mut m = model("rod", 0.1, 0.01);
    capacity(&mut m, "c", moment_nm);
    let piece = LENGTH / n as f64;
    for i in 0..n {
        let middle = (i as f64 + 0.5) * piece;
        m.bodies.push(solid(&format!("p{i}"), [middle, 0.0, 0.0], [piece, WIDTH, WIDTH]));
        if i > 0 {
            let along = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let (a, b) = (format!("p{}", i - 1), format!("p{i}"));
            let at = [i as f64 * piece, 0.0, 0.0];
            m.bushings.push(section(&format!("s{i}"), &a, &b, at, along, "c"));
        }
    }
    m
}

fn spin(m: &mut Model, about: [f64; 3], velocity: [f64; 3], center: [f64; 3]) {
    for body in &mut m.bodies {
        let arm = math::sub(body.position_m, center);
        body.velocity_m_s = math::add(velocity, math::cross(about, arm));
        body.angular_velocity_rad_s = about;
    }
}

fn live(result: &RunResult) -> Vec<&str> {
    let ids = result.events.iter().filter_map(|e| match &e.kind {
        EventKind::Live { joint, .. } => Some(joint.as_str()),
        _ => None,
    });
    ids.collect()
}

/// A spinning rod is pulled by `m ω² / (2 L) (L²/4 - x²)`; its pieces bear that exactly.
#[test]
fn a_spinning_rod_is_pulled_as_theory_says() {
    let mut m = rod(6, 1e9);
    let rate = 5.0;
    spin(&mut m, [0.0, 0.0, rate], [1.0, 2.0, 3.0], [0.5 * LENGTH, 0.0, 0.0]);
    m.gravity_m_s2 = [0.0; 3];
    let result = simulate(&m).unwrap();
    let mass: f64 = m.bodies.iter().map(|b| b.mass_kg).sum();
    for (i, history) in result.hinges.iter().enumerate() {
        let x = (i + 1) as f64 * LENGTH / 6.0 - 0.5 * LENGTH;
        let pull = mass * rate * rate / (2.0 * LENGTH) * (0.25 * LENGTH * LENGTH - x * x);
        for axial in &history.axial_force_n {
            assert!((axial + pull).abs() < 1e-9 * pull, "{i}: {axial} {pull}");
        }
    }
    assert_eq!(live(&result), Vec::<&str>::new());
}

/// A rod that falls about its end has its largest moment at a third of its length, `x (1 - x/L)²` of the transverse force at the end (Madsen, Am. J. Phys. 45 (1977) 182: chimneys).
fn falling(moment_nm: f64, step_s: Option<f64>) -> RunResult {
    let mut m = rod(30, moment_nm);
    m.settings.time_step_s = step_s;
    m.bushings.push(joint("foot", None, "p0", [0.0; 3], 1e9, 1e7, [elastic(0.0), elastic(0.0)]));
    track(&mut m, "p0", [0.0; 3]);
    simulate(&m).unwrap()
}

#[test]
fn a_falling_rod_bears_most_at_a_third() {
    let result = falling(1e12, None);
    let mut largest = vec![0.0_f64; 29];
    for t in 1..result.times_s.len() {
        // the foot is elastic: its displacement tells the force there, which has the moments of the whole rod behind it
        let q = result.frames[t].orientation[0];
        let normal = math::mul(&math::qmat(q), [0.0, 0.0, 1.0]);
        let force = -1e9 * math::dot(result.tracked[0].displacement_m[t], normal);
        for (i, history) in result.hinges.iter().enumerate() {
            let x = (i + 1) as f64 * LENGTH / 30.0;
            let theory = force * x * (1.0 - x / LENGTH).powi(2);
            let moment = history.moment_nm[t][0].hypot(history.moment_nm[t][1]);
            assert!((moment - theory.abs()).abs() < 1e-3 * theory.abs() + 1e-6, "{t} {i}: {moment} {theory}");
            largest[i] = largest[i].max(moment);
        }
    }
    let most = (0..29).max_by(|a, b| largest[*a].total_cmp(&largest[*b])).unwrap();
    assert_eq!(most, 9, "{largest:?}");
}

#[test]
fn a_falling_rod_breaks_at_a_third() {
    // below the limit of the rod in pieces, so that both runs take the same steps
    let step = Some(1e-5);
    let (result, whole) = (falling(200.0, step), falling(1e12, step));
    assert_eq!(live(&result)[0], "s10");
    // what parting adds is small beside what the vibration of the foot makes
    assert!(result.energy_error < 1.2 * whole.energy_error, "{} {}", result.energy_error, whole.energy_error);
}

/// A cantilever at rest bears the weight beyond a section in shear; it parts where that is more than the section bears, and is sheared off there.
#[test]
fn a_cantilever_is_sheared_off_beside_its_clamp() {
    let cantilever = |share: f64| {
        let mut m = rod(6, 1e9);
        m.settings.preload = true;
        let weight: f64 = m.bodies.iter().map(|b| b.mass_kg * G).sum();
        m.bushings.iter_mut().for_each(|b| b.shear_capacity_n = Some([share * weight * 5.0 / 6.0; 2]));
        m.bushings.push(joint("clamp", None, "p0", [0.0; 3], 1e9, 1e9, [elastic(1e9), elastic(1e9)]));
        simulate(&m).unwrap()
    };
    assert_eq!(live(&cantilever(1.0 + 1e-6)), Vec::<&str>::new());
    let result = cantilever(1.0 - 1e-6);
    assert_eq!(live(&result), ["s1"]);
    let sheared = result.events.iter().find_map(|e| match &e.kind {
        EventKind::Fracture { joint, cause: FractureCause::Shear } => Some((joint.as_str(), e.time_s)),
        _ => None,
    });
    let (joint, time_s) = sheared.expect("sheared off");
    assert!(joint == "s1" && time_s < 1e-3, "{joint} {time_s}");
}

/// The figures of cases of the manual whose names begin so.
fn holds(case: &str) {
    let all = fallwerk::verify::mbs::cases().into_iter().filter(|c| c.name.starts_with(case));
    let figures: Vec<_> = all.flat_map(|c| c.figures().unwrap()).collect();
    assert!(!figures.is_empty());
    for figure in &figures {
        assert!(figure.passes(), "{figure:?}");
    }
}

#[test]
fn a_body_that_parts_keeps_its_momenta() {
    holds("split-momentum");
}

/// A bushing goes live with the force that it had to bear: accelerations do not jump.
#[test]
fn nothing_jumps_when_a_body_parts() {
    let mut m = rod(4, 1e9);
    let about = [0.0, 1.0, 3.0];
    spin(&mut m, about, [0.0; 3], [0.5 * LENGTH, 0.0, 0.0]);
    m.gravity_m_s2 = [0.0; 3];
    let (mut latent, merged) = Latent::new(&m).unwrap();
    let system = latent.compile(&merged.unwrap()).unwrap();
    let parting = latent.parting(&system, 1);
    let (mut parted, _) = latent.part(&m, &system, &parting).unwrap();
    parted.reset_forces();
    parted.add_joint_forces();
    // both transverse inertias are the same, so that the rotation does not change and each piece is pulled to the middle
    for (body, data) in parted.bodies.iter().zip(&parted.data).take(2) {
        let arm = math::sub(body.x, [0.5 * LENGTH, 0.0, 0.0]);
        let expected = math::scale(data.mass, math::cross(about, math::cross(about, arm)));
        let off = math::norm(math::sub(body.force, expected));
        assert!(off < 1e-6 * math::norm(expected), "{:?} {expected:?}", body.force);
    }
}

/// The step that is told where one is refused holds once bodies have parted.
#[test]
fn the_step_told_for_one_refused_holds_after_bodies_part() {
    let mut m = rod(6, 100.0);
    m.bushings.push(joint("foot", None, "p0", [0.0; 3], 1e8, 1e7, [elastic(0.0), elastic(0.0)]));
    m.settings.end_time_s = 0.05;
    m.settings.time_step_s = Some(1.0);
    let said = simulate(&m).unwrap_err().to_string();
    m.settings.time_step_s = Some(step_told(&said));
    let result = simulate(&m).unwrap_or_else(|e| panic!("{said}: {e}"));
    assert!(!live(&result).is_empty());
}

/// What no latent bushing parts moves as the bodies made one by hand.
#[test]
fn latent_bodies_move_as_one() {
    let mut pieces = rod(4, 1e12);
    let middle = [0.5 * LENGTH, 0.0, 0.0];
    let mut whole = model("rod", 0.1, 0.01);
    whole.bodies.push(solid("p0", middle, [LENGTH, WIDTH, WIDTH]));
    for m in [&mut pieces, &mut whole] {
        m.settings.end_time_s = 1.0;
        m.settings.time_step_s = Some(1e-3);
        m.contact.ground = Some(GroundPlane { level_m: -1.0, friction: 0.5, restitution: 0.1 });
        spin(m, [0.1, 2.0, 0.5], [0.3, 0.0, 0.0], middle);
        m.tracked.push(TrackedPoint { id: "end".into(), body: "p0".into(), point_m: [0.0, 0.1, 0.1] });
    }
    // the ground strikes the end, so that only a share of the strokes tells that it is latent
    let (a, b) = (simulate(&pieces).unwrap(), simulate(&whole).unwrap());
    assert!(live(&a).is_empty() && a.first_ground_contact_s.is_some());
    let first = a.times_s.iter().position(|t| *t > a.first_ground_contact_s.unwrap()).unwrap();
    for t in 0..first {
        for k in 0..3 {
            let off = a.tracked[0].displacement_m[t][k] - b.tracked[0].displacement_m[t][k];
            assert!(off.abs() < 1e-9, "{t}: {off}");
        }
    }
    assert!(a.latent.iter().all(|l| l.live_s.is_none() && l.largest_share < 1.0));
}

/// Looks are left out only where they would find nothing: the same bytes, down to the largest share of each bushing.
#[test]
fn looks_that_a_bound_leaves_out_change_nothing() {
    let run = |moment_nm: f64, turned: bool, always: bool| {
        let mut m = rod(6, moment_nm);
        m.settings.end_time_s = 2.5;
        m.settings.time_step_s = Some(2e-5);
        m.contact.ground = Some(GroundPlane { level_m: -2.0, friction: 0.5, restitution: 0.1 });
        spin(&mut m, [0.1, 0.3, 0.5], [0.5, 0.0, 0.0], [0.5 * LENGTH, 0.0, 0.0]);
        // a heavy block hangs on its end, by a joint of which the rod is the second or the first body
        m.bodies.push(solid("block", [LENGTH + 0.5, 0.0, 0.0], [1.0, 0.5, 0.5]));
        let block = m.bodies.last_mut().unwrap();
        let arm = [0.5 * LENGTH + 0.5, 0.0, 0.0];
        block.velocity_m_s = math::add([0.5, 0.0, 0.0], math::cross([0.1, 0.3, 0.5], arm));
        block.angular_velocity_rad_s = [0.1, 0.3, 0.5];
        let (a, b) = if turned { ("block", "p5") } else { ("p5", "block") };
        let hung = joint("hung", Some(a), b, [LENGTH, 0.0, 0.0], 1e6, 1e4, [elastic(1e3), elastic(2e3)]);
        m.bushings.push(hung);
        let options = SolverOptions { look_always: always, ..SolverOptions::default() };
        simulate_with(&m, &options).unwrap()
    };
    for (moment_nm, turned) in [(1e6, false), (1e6, true), (3e4, false), (3e4, true)] {
        let [some, every] = [false, true].map(|always| run(moment_nm, turned, always));
        assert_eq!((&some.frames, &some.events), (&every.frames, &every.events));
        assert_eq!((&some.latent, &some.hinges), (&every.latent, &every.hinges));
        assert_eq!((&some.energies, some.steps), (&every.energies, every.steps));
        let [a, b] = [some.body_work, every.body_work];
        println!("{moment_nm} {turned}: {} of {} looks left out", a.bounded_looks, b.looks);
        assert_eq!((a.looks + a.bounded_looks, b.bounded_looks), (b.looks, 0));
        assert!(a.bounded_looks > a.looks, "{a:?}");
    }
}

/// A rod that strikes the ground with one end parts; the energy balance holds through that, and every piece comes to the ground.
#[test]
fn a_struck_rod_parts() {
    let mut m = rod(6, 3e4);
    m.settings.end_time_s = 2.5;
    m.contact.ground = Some(GroundPlane { level_m: -2.0, friction: 0.5, restitution: 0.1 });
    spin(&mut m, [0.0, 0.3, 0.0], [0.0; 3], [0.5 * LENGTH, 0.0, 0.0]);
    let result = simulate(&m).unwrap();
    assert!(!live(&result).is_empty());
    assert!(result.energy_error < 5e-3, "{}", result.energy_error);
    for x in &result.frames.last().unwrap().position_m {
        assert!(x[2] > -2.0 && x[2] < -1.5, "{x:?}");
    }
}

#[test]
fn pieces_that_do_not_move_as_one_are_refused() {
    let mut m = rod(3, 1e6);
    m.bodies[1].velocity_m_s = [1.0, 0.0, 0.0];
    let error = simulate(&m).unwrap_err().to_string();
    assert!(error.contains("bodies[") && error.contains("latent"), "{error}");
    let mut m = rod(3, 1e6);
    m.bushings[0].torsional_stiffness_nm_rad = 0.0;
    let error = simulate(&m).unwrap_err().to_string();
    assert!(error.contains("bushings[0].torsional_stiffness_nm_rad"), "{error}");
}

/// Events of bushings count in models without ideal joints as well.
#[test]
fn an_event_releases_and_weakens_bushings() {
    let mut m = model("hung", 1.0, 0.1);
    capacity(&mut m, "c", 5e4);
    m.bodies.push(solid("b", [1.0, 0.0, 5.0], [2.0, 0.2, 0.2]));
    let mut hung = joint("h", None, "b", [0.0, 0.0, 5.0], 1e7, 1e6, [hinge("c"), hinge("c")]);
    hung.axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    m.bushings.push(hung);
    m.settings.preload = true;
    track(&mut m, "b", [2.0, 0.0, 5.0]);
    let event = |release: Vec<String>, weaken: Vec<Weakening>| Event {
        id: "e".into(),
        time_s: 0.5,
        remove_bodies: Vec::new(),
        release,
        weaken,
        origin: Origin::default(),
    };
    let tip = |r: &RunResult| r.tracked[0].displacement_m.last().unwrap()[2];
    let held = simulate(&m).unwrap();
    assert!(tip(&held).abs() < 1e-6);
    m.events = vec![event(vec!["h".into()], Vec::new())];
    let fallen = simulate(&m).unwrap();
    assert!((tip(&fallen) + 0.5 * G * 0.25).abs() < 1e-3, "{}", tip(&fallen));
    m.events = vec![event(Vec::new(), vec![Weakening { id: "h".into(), factor: 0.01 }])];
    // little energy is turned over just after the event
    m.settings.time_step_s = Some(5e-4);
    let weak = simulate(&m).unwrap();
    assert!(tip(&weak) < -0.5 && weak.energy_error < 1e-3, "{} {}", tip(&weak), weak.energy_error);
}

/// Toppling towers of blocks break between a third and half of their height, the higher the weaker their joints (Varieschi and Kamiya, Am. J. Phys. 71 (2003) 1025).
#[test]
fn a_chimney_of_blocks_breaks_where_theory_says() {
    holds("chimney-edge");
}

/// A rod is one until a section goes live, two pieces from then on, and what has vanished is none.
#[test]
fn what_moves_as_one_is_told_by_the_run() {
    let mut m = rod(3, 1e12);
    let event = |id: &str, time_s: f64, gone: &[&str], released: &[&str]| Event {
        id: id.into(),
        time_s,
        remove_bodies: gone.iter().map(|s| s.to_string()).collect(),
        release: released.iter().map(|s| s.to_string()).collect(),
        weaken: Vec::new(),
        origin: Origin::default(),
    };
    m.settings.time_step_s = Some(1e-5);
    m.events = vec![event("cut", 0.035, &[], &["s1"]), event("blast", 0.065, &["p2"], &[])];
    let result = simulate(&m).unwrap();
    assert_eq!(live(&result), ["s1", "s2"]);
    // three pieces on two latent bushings up to 35 ms, on one up to 65 ms, then two on none
    let work = result.body_work;
    assert_eq!(result.steps, 10_000);
    assert_eq!(work.body_steps, 3 * 6_500 + 2 * 3_500);
    assert_eq!((work.held_steps, work.latent_steps), (2 * 3_500 + 3_000, 2 * 3_500 + 3_000));
    assert_eq!((work.unwatched_steps, work.asleep_steps), (0, 0));
    let at = |time_s: f64| compounds(&m, &result, time_s);
    let [first, second, third] = [at(0.03), at(0.04), at(0.07)];
    assert!(first.iter().all(|c| c.is_some() && *c == first[0]), "{first:?}");
    assert!(second[0] != second[1] && second[1] == second[2] && second[2].is_some(), "{second:?}");
    assert!(third[0] != third[1] && third[2].is_none(), "{third:?}");
}
