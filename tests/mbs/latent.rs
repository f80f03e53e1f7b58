//! Latent bushings: what they bear, when bodies part, what is conserved.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::latent::Latent;
use fallwerk::mbs::math;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::{EventKind, FractureCause};
use fallwerk::mbs::system::System;
use fallwerk::mbs::{RunResult, simulate};

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

fn momenta(system: &System) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for body in &system.bodies[..system.count()] {
        let turn = math::add(math::cross(body.x, body.p), body.l);
        for k in 0..3 {
            sum[k] += body.p[k];
            sum[3 + k] += turn[k];
        }
    }
    sum
}

#[test]
fn a_body_that_parts_keeps_its_momenta() {
    let mut m = rod(5, 1e9);
    m.bodies[2].position_m[1] += 0.7;
    m.bodies[3].inertia_kg_m2[0][1] = 20.0;
    m.bodies[3].inertia_kg_m2[1][0] = 20.0;
    spin(&mut m, [3.0, -2.0, 7.0], [10.0, -20.0, 5.0], [2.0, 1.0, 0.0]);
    let (mut latent, merged) = Latent::new(&m).unwrap();
    let mut system = System::new(&merged.unwrap()).unwrap();
    // somewhere else, turned
    system.bodies[0].x = [100.0, -50.0, 20.0];
    system.bodies[0].rotate([0.3, 1.2, -0.7]);
    for cause in [2, 0, 3] {
        let before = momenta(&system);
        let parting = latent.parting(&system, cause);
        assert_eq!(parting.live.len(), 1);
        let pieces = system.count();
        (system, _) = latent.part(&m, &system, &parting).unwrap();
        assert_eq!(system.count(), pieces + 1);
        let after = momenta(&system);
        let size = before.iter().fold(0.0_f64, |s, v| s.max(v.abs()));
        for k in 0..6 {
            assert!((after[k] - before[k]).abs() < 1e-12 * size, "{k}: {before:?} {after:?}");
        }
    }
}

/// A bushing goes live with the force that it had to bear: accelerations do not jump.
#[test]
fn nothing_jumps_when_a_body_parts() {
    let mut m = rod(4, 1e9);
    let about = [0.0, 1.0, 3.0];
    spin(&mut m, about, [0.0; 3], [0.5 * LENGTH, 0.0, 0.0]);
    m.gravity_m_s2 = [0.0; 3];
    let (mut latent, merged) = Latent::new(&m).unwrap();
    let system = System::new(&merged.unwrap()).unwrap();
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

/// What no latent bushing parts moves as the bodies made one by hand.
#[test]
fn latent_bodies_move_as_one() {
    let mut pieces = rod(4, 1e12);
    let middle = [0.5 * LENGTH, 0.0, 0.0];
    let mut whole = model("rod", 0.1, 0.01);
    whole.bodies.push(solid("p0", middle, [LENGTH, WIDTH, WIDTH]));
    for m in [&mut pieces, &mut whole] {
        m.settings.end_time_s = 1.0;
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

/// A rod that strikes the ground with one end parts; the energy balance holds through that, and every piece comes to the ground.
#[test]
fn a_struck_rod_parts() {
    let mut m = rod(6, 3e4);
    m.settings.end_time_s = 1.5;
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
    let weak = simulate(&m).unwrap();
    assert!(tip(&weak) < -0.5 && weak.energy_error < 1e-3, "{} {}", tip(&weak), weak.energy_error);
}

const HEIGHT: f64 = 6.0;
const SIDE: f64 = 0.4;
const BLOCKS: usize = 24;
/// Bending that a joint bears without axial force \[N m\].
const BOND: f64 = 2000.0;

/// A chimney of blocks that topples over its edge; joints bear `BOND + N SIDE / 2`.
fn chimney(spin: f64) -> Model {
    let mut m = model("chimney", 5.0, 1e-3);
    let most = 1e5;
    let level = |axial_force_n: f64| {
        let peak = BOND + 0.5 * SIDE * axial_force_n;
        CapacityLevel { axial_force_n, capacity: vec![[0.0, peak], [0.1, peak]], fracture_rotation_rad: 0.5 }
    };
    let levels = vec![level(0.0), level(most)];
    m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 1e8, levels, cyclic: None });
    m.contact.ground = Some(GroundPlane { level_m: 0.0, friction: 2.0, restitution: 0.0 });
    let block = HEIGHT / BLOCKS as f64;
    for i in 0..BLOCKS {
        let z = (i as f64 + 0.5) * block;
        let mut body = solid(&format!("b{i}"), [0.0, 0.0, z], [SIDE, SIDE, block]);
        body.angular_velocity_rad_s = [0.0, spin, 0.0];
        body.velocity_m_s = math::cross(body.angular_velocity_rad_s, [-0.5 * SIDE, 0.0, z]);
        m.bodies.push(body);
        if i > 0 {
            let (a, b) = (format!("b{}", i - 1), format!("b{i}"));
            m.bushings.push(section(&format!("s{i}"), &a, &b, [0.0, 0.0, i as f64 * block], UP, "c"));
        }
    }
    m
}

/// Angle \[rad\] and joint at which a rigid prism that turns about its edge first bears as much as it can: equations of motion of the part above each joint.
fn chimney_breaks(spin: f64) -> (f64, usize) {
    let mass = DENSITY * SIDE * SIDE * HEIGHT;
    let (half, lever) = (0.5 * SIDE, (0.25 * (HEIGHT * HEIGHT + SIDE * SIDE)).sqrt());
    let about_edge = mass * (HEIGHT * HEIGHT + SIDE * SIDE) / 3.0;
    let lean = SIDE.atan2(HEIGHT);
    let mut angle = 0.0_f64;
    loop {
        let fallen = lever * (lean.cos() - (angle - lean).cos());
        let rate2 = spin * spin + 2.0 * mass * G * fallen / about_edge;
        let acceleration = mass * G * lever * (angle - lean).sin() / about_edge;
        for i in 1..BLOCKS {
            let r = HEIGHT * i as f64 / BLOCKS as f64;
            let (above, up) = (mass * (1.0 - r / HEIGHT), 0.5 * (HEIGHT + r));
            // across (towards the fall) and along the axis, from the edge: the centre of the part above lies at (-half, up)
            let a = [
                acceleration * up + rate2 * half - G * angle.sin(),
                acceleration * half - rate2 * up + G * angle.cos(),
            ];
            let own = above * (SIDE * SIDE + (HEIGHT - r).powi(2)) / 12.0;
            let moment = own * acceleration + above * a[0] * (up - r);
            let axial = above * a[1];
            if moment.abs() >= BOND + half * axial.max(0.0) {
                return (angle, i);
            }
        }
        angle += 1e-5;
    }
}

/// Toppling towers of blocks break between a third and half of their height, the higher the weaker their joints (Varieschi and Kamiya, Am. J. Phys. 71 (2003) 1025).
#[test]
fn a_chimney_of_blocks_breaks_where_theory_says() {
    let spin = 0.14;
    let (angle, joint) = chimney_breaks(spin);
    assert!((BLOCKS / 3..=BLOCKS / 2).contains(&joint), "{joint}");
    let result = simulate(&chimney(spin)).unwrap();
    let (time, first) = result
        .events
        .iter()
        .find_map(|e| match &e.kind {
            EventKind::Live { joint, with: None } => Some((e.time_s, joint.clone())),
            _ => None,
        })
        .unwrap();
    let frame = &result.frames[(time / 1e-3).round() as usize];
    let turned = 2.0 * frame.orientation[0][2].asin();
    assert_eq!(first, format!("s{joint}"), "at {turned} for {angle}");
    assert!((turned - angle).abs() < 0.01 * angle, "{turned} {angle}");
}
