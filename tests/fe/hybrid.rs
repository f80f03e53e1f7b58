//! Rigid sets in the FE dynamics: momenta, free flight, hand-over, release.

use super::mesh::{bilinear, elastic, grid, ground};
use fallwerk::base::random::Random;
use fallwerk::base::tree::Format;
use fallwerk::building::{EXAMPLE, parse};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::erosion::Fate;
use fallwerk::fe::hybrid::{Hybrid, HybridSettings, Reason, Refused};
use fallwerk::fe::law::ElementForm;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::result::FeRun;
use fallwerk::fe::run::{Attached, Checkpoints, FeError, FeOptions, run_with};
use fallwerk::fe::watch::Books;
use fallwerk::verify::fe::body::momenta;

/// Sets that switch when they are told to.
fn by_hand() -> HybridSettings {
    HybridSettings { automatic: false, least_elements: 4, ..HybridSettings::default() }
}

fn give_sets(mesh: &Mesh, body: &mut Dynamics, settings: HybridSettings) {
    let none = vec![false; mesh.elements.len()];
    body.hybrid = Some(Box::new(Hybrid::new(mesh, body, &none, settings).unwrap()));
}

/// Plans to make elements rigid in the next step.
fn plan(body: &mut Dynamics, elements: impl Iterator<Item = usize>) {
    let mut hybrid = body.hybrid.take().unwrap();
    hybrid.plan(body, elements, Reason::Asked);
    body.hybrid = Some(hybrid);
}

fn release(body: &mut Dynamics, elements: &[usize]) {
    let mut hybrid = body.hybrid.take().unwrap();
    hybrid.release(body, elements, Reason::Asked);
    body.hybrid = Some(hybrid);
}

fn rigid(body: &Dynamics) -> usize {
    body.hybrid.as_ref().unwrap().rigid()
}

fn assert_kept(before: [[f64; 3]; 2], after: [[f64; 3]; 2], within: f64) {
    for (before, after) in before.iter().zip(&after) {
        let size = before.iter().map(|c| c * c).sum::<f64>().sqrt();
        for i in 0..3 {
            assert!((after[i] - before[i]).abs() <= within * size, "{before:?} {after:?}");
        }
    }
}

/// A block that flies, tumbles and, by `shiver_m_s`, vibrates.
fn tumbling(gravity: f64, shiver_m_s: f64) -> (Mesh, Dynamics) {
    let mesh = grid([8, 3, 4], [2.4, 0.6, 1.6], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, gravity, RigidSurfaces::default(), false);
    let mut random = Random::after(5);
    for n in 0..mesh.nodes.len() {
        let [x, y, z] = mesh.nodes[n];
        let turning = [2.0 * z - 0.7 * y, 0.7 * x - 1.0 * z, 1.0 * y - 2.0 * x];
        body.v[n] =
            std::array::from_fn(|i| [1.0, -2.0, 3.0][i] + turning[i] + shiver_m_s * random.symmetric());
    }
    give_sets(&mesh, &mut body, by_hand());
    (mesh, body)
}

/// The whole block as one rigid body: its centre falls on the parabola, nothing strains, momenta stay.
#[test]
fn rigid_block_flies_freely() {
    let (mesh, mut body) = tumbling(9.81, 0.0);
    let centre = |b: &Dynamics, i: usize| {
        let mass: f64 = b.mass_kg.iter().sum();
        b.x.iter().zip(&b.mass_kg).map(|(x, m)| m * x[i]).sum::<f64>() / mass
    };
    let start: Vec<f64> = (0..3).map(|i| centre(&body, i)).collect();
    let [p, _] = momenta(&body);
    let mass: f64 = body.mass_kg.iter().sum();
    plan(&mut body, 0..mesh.elements.len());
    let first_j = body.kinetic_j();
    let mut kinetic_j = 0.0;
    while body.time_s < 0.5 {
        kinetic_j = body.step(true);
    }
    assert_eq!(rigid(&body), mesh.elements.len());
    let t = body.time_s;
    for i in 0..3 {
        let fall = if i == 2 { 0.5 * 9.81 * t * t } else { 0.0 };
        let expected = start[i] + p[i] / mass * t - fall;
        assert!((centre(&body, i) - expected).abs() < 1e-9, "{i}: {} {expected}", centre(&body, i));
    }
    assert!(body.blocks.energies_j().iter().all(|e| e.abs() < 1e-9), "{:?}", body.blocks.energies_j());
    let books = Books::of(&body, kinetic_j, first_j, 0.0);
    assert!(books.residual_j().abs() < 1e-6 * first_j, "{} of {first_j} J", books.residual_j());
    assert!(books.switched_j.abs() < 1e-9 * first_j, "{}", books.switched_j);
}

/// Hand-overs of a body that tumbles and vibrates, to one rigid body, to two, and back.
#[test]
fn hand_over_and_split_under_rotation_keep_both_momenta() {
    let (mesh, mut body) = tumbling(0.0, 0.05);
    let before = momenta(&body);
    let first_j = body.kinetic_j();
    let steps = |body: &mut Dynamics, n: usize| (0..n).map(|_| body.step(true)).last().unwrap();
    steps(&mut body, 20);
    assert_kept(before, momenta(&body), 1e-12);
    plan(&mut body, 0..mesh.elements.len());
    steps(&mut body, 40);
    assert_eq!(rigid(&body), mesh.elements.len());
    let lost_j = body.hybrid.as_ref().unwrap().books.switched_j;
    assert!(lost_j < -1.0, "the vibration is lost and booked: {lost_j} J");
    assert_kept(before, momenta(&body), 1e-12);
    // a layer across the block deforms again: two rigid ends
    let layer: Vec<usize> = (0..mesh.elements.len()).filter(|e| [3, 4].contains(&(e % 8))).collect();
    release(&mut body, &layer);
    assert_kept(before, momenta(&body), 1e-12);
    steps(&mut body, 60);
    assert_eq!(body.hybrid.as_ref().unwrap().sets.len(), 2);
    assert_eq!(rigid(&body), mesh.elements.len() - layer.len());
    assert_kept(before, momenta(&body), 1e-12);
    // all of it, and back to one set of two halves that move against each other
    let all: Vec<usize> = (0..mesh.elements.len()).collect();
    release(&mut body, &all);
    steps(&mut body, 60);
    plan(&mut body, 0..mesh.elements.len());
    let kinetic_j = steps(&mut body, 60);
    assert_kept(before, momenta(&body), 1e-12);
    let books = Books::of(&body, kinetic_j, first_j, 0.0);
    // what is left is of bulk viscosity, whose pressure of the last increment ends with the hand-over
    assert!(
        books.residual_j().abs() < 0.01 * books.switched_j.abs(),
        "{} {}",
        books.residual_j(),
        books.switched_j
    );
}

/// A bar turns about its end, half of it rigid: the elements between and the rigid half exchange momentum, the energy balance closes.
#[test]
fn rigid_half_of_a_vibrating_bar_closes_the_energy_balance() {
    let mesh = grid([16, 2, 2], [6.4, 0.8, 0.8], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    for n in 0..mesh.nodes.len() {
        body.v[n] = [0.0, 0.3 * mesh.nodes[n][0], -2.0 * mesh.nodes[n][0] + 0.4 * mesh.nodes[n][0].powi(2)];
    }
    give_sets(&mesh, &mut body, by_hand());
    let first_j = body.kinetic_j();
    plan(&mut body, (0..mesh.elements.len()).filter(|e| e % 16 >= 8));
    let mut worst = 0.0_f64;
    for _ in 0..3000 {
        let kinetic_j = body.step(true);
        worst = worst.max(Books::of(&body, kinetic_j, first_j, 0.0).residual_j().abs());
    }
    assert_eq!(rigid(&body), 32);
    assert!(worst < 1e-4 * first_j, "{worst} of {first_j} J");
    assert!(body.hybrid.as_ref().unwrap().books.switched_j < 0.0);
}

/// A rigid node that strikes the ground passes the impulse of its mass on to its set; the balance knows it.
#[test]
fn impact_on_a_rigid_node_is_an_impulse_on_its_set() {
    let mesh = grid([4, 2, 2], [1.6, 0.8, 0.8], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, ground(-0.01, 0.3), false);
    body.v.iter_mut().for_each(|v| *v = [1.0, 0.0, -3.0]);
    give_sets(&mesh, &mut body, by_hand());
    plan(&mut body, 0..mesh.elements.len());
    let (first_j, before) = (body.kinetic_j(), momenta(&body));
    let mut kinetic_j = 0.0;
    while body.contact_j[0] == 0.0 {
        kinetic_j = body.step(true);
    }
    let after = momenta(&body);
    assert!(after[0][2] > before[0][2] + 1.0 && after[0][0] < before[0][0], "{before:?} {after:?}");
    kinetic_j = (0..5).map(|_| body.step(true)).last().unwrap_or(kinetic_j);
    let residual_j = Books::of(&body, kinetic_j, first_j, 0.0).residual_j();
    assert!(residual_j.abs() < 1e-6 * first_j, "{residual_j} of {first_j} J");
}

/// A bar turns about its end and strikes the ground with its tip: the tip deforms again before it strikes, and flows as it does without sets.
#[test]
fn cantilever_that_meets_the_ground_is_released_in_time() {
    let law = bilinear(30e9, 0.2, 2500.0, 30e6, 1e9);
    let mesh = grid([24, 2, 2], [9.6, 0.8, 0.8], law, |_| false);
    let run = |hybrid: bool| {
        let mut body = Dynamics::new(&mesh, 9.81, ground(-0.3, 0.5), false);
        for n in 0..mesh.nodes.len() {
            body.v[n] = [0.0, 0.0, -0.3 * mesh.nodes[n][0]];
        }
        if hybrid {
            let all = Some(vec![true; mesh.elements.len()]);
            let settings = HybridSettings { rigid_from_start: all, ..HybridSettings::default() };
            give_sets(&mesh, &mut body, settings);
        }
        let (mut kinetic_j, first_j) = (0.0, body.kinetic_j());
        let mut last = (0.0_f64, false);
        while body.time_s < 0.15 {
            kinetic_j = body.step(true);
            if body.contact_j[0] == 0.0 && hybrid {
                let tip_is_rigid = body.hybrid.as_ref().unwrap().is_rigid(23);
                last = (last.0.max(rigid(&body) as f64 / mesh.elements.len() as f64), tip_is_rigid);
            }
        }
        let books = Books::of(&body, kinetic_j, first_j, 0.0);
        assert!(books.residual_j().abs() < 0.01 * books.largest_j(), "{hybrid}: {books:?}");
        (body, last)
    };
    let (full, _) = run(false);
    let (hybrid, (share, tip_is_rigid)) = run(true);
    let switches = &hybrid.hybrid.as_ref().unwrap().books.switches;
    assert!(share > 0.7 && !tip_is_rigid, "rigid before the impact: {share} {tip_is_rigid}");
    assert!(switches.iter().any(|s| s.reason == Reason::Contact), "{switches:?}");
    let lowest = |b: &Dynamics| b.x.iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
    assert!(lowest(&hybrid) > -0.3 - 1e-6, "{}", lowest(&hybrid));
    // all of the bar deforms again, or its tip would get a blow that is harder (six times the flow: docs/hybrid.md)
    let flowed = |b: &Dynamics| (0..mesh.elements.len()).map(|e| b.blocks.plastic_strain(e)).sum::<f64>();
    let ratio = flowed(&hybrid) / flowed(&full);
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}: {} {}", flowed(&hybrid), flowed(&full));
}

/// The same with switching off: what strikes stays rigid, nothing flows, and the balance knows the blow.
#[test]
fn with_switching_off_a_rigid_part_stays_rigid_whatever_it_meets() {
    let law = bilinear(30e9, 0.2, 2500.0, 30e6, 1e9);
    let mesh = grid([24, 2, 2], [9.6, 0.8, 0.8], law, |_| false);
    let mut body = Dynamics::new(&mesh, 9.81, ground(-0.3, 0.5), false);
    for n in 0..mesh.nodes.len() {
        body.v[n] = [0.0, 0.0, -0.3 * mesh.nodes[n][0]];
    }
    let all = Some(vec![true; mesh.elements.len()]);
    give_sets(
        &mesh,
        &mut body,
        HybridSettings { rigid_from_start: all, softens: false, ..HybridSettings::default() },
    );
    let (mut kinetic_j, first_j) = (0.0, body.kinetic_j());
    while body.time_s < 0.15 {
        kinetic_j = body.step(true);
    }
    assert!(body.contact_j[0] < 0.0, "it has struck the ground");
    assert_eq!(rigid(&body), mesh.elements.len());
    let switches = &body.hybrid.as_ref().unwrap().books.switches;
    assert!(switches.iter().all(|s| s.reason == Reason::Quiet), "{switches:?}");
    assert!((0..mesh.elements.len()).all(|e| body.blocks.plastic_strain(e) == 0.0));
    let books = Books::of(&body, kinetic_j, first_j, 0.0);
    assert!(books.residual_j().abs() < 0.01 * books.largest_j(), "{books:?}");
}

#[test]
fn sets_share_no_node_and_small_parts_stay_deformable() {
    let (mesh, mut body) = tumbling(0.0, 0.0);
    // two quarters of the block that meet at an edge, and one element by itself
    let at = |e: usize| [e % 8, e / 8 % 3, e / 24];
    let quarter = |e: &usize| (at(*e)[0] < 3) == (at(*e)[2] < 2) && at(*e)[0] < 6 || at(*e) == [7, 0, 0];
    plan(&mut body, (0..mesh.elements.len()).filter(quarter));
    body.step(false);
    let hybrid = body.hybrid.as_ref().unwrap();
    assert_eq!(hybrid.sets.len(), 2);
    assert!(!hybrid.is_rigid(7));
    let shared = hybrid.sets[0].nodes.iter().filter(|n| hybrid.sets[1].nodes.contains(n)).count();
    assert_eq!(shared, 0);
}

#[test]
fn what_cannot_become_rigid_is_refused_or_stays_deformable() {
    let mut mesh = grid([4, 2, 2], [1.6, 0.8, 0.8], elastic(), |p| p[0] == 0.0);
    let none = vec![false; mesh.elements.len()];
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    body.applied_n[44] = [1e3, 0.0, 0.0];
    give_sets(&mesh, &mut body, by_hand());
    plan(&mut body, 0..mesh.elements.len());
    body.step(false);
    for (e, element) in mesh.elements.iter().enumerate() {
        let busy = element.nodes.iter().any(|n| mesh.fixed.contains(n) || *n == 44);
        assert!(!(busy && body.hybrid.as_ref().unwrap().is_rigid(e)), "{e}");
    }
    let settings = HybridSettings { quiet_s: -1.0, ..by_hand() };
    let refused = Hybrid::new(&mesh, &body, &none, settings).unwrap_err();
    assert!(matches!(refused, Refused::Setting { value: -1.0, .. }), "{refused}");
    mesh.laws[0].form = ElementForm::FullyIntegrated;
    let refused = Hybrid::new(&mesh, &body, &none, by_hand()).unwrap_err();
    assert!(refused.to_string().contains("leave --hybrid out"), "{refused}");
}

/// The example building for 60 ms.
fn short_run(hybrid: Option<HybridSettings>, threads: usize) -> FeRun {
    let building = parse(EXAMPLE, Format::Toml, "building.toml").unwrap();
    let options = FeOptions { end_time_s: Some(0.06), hybrid, ..FeOptions::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| run_with(&building, &options, Attached::default(), &mut |_| {})).unwrap()
}

fn assert_same_bytes(a: &FeRun, b: &FeRun) {
    for (p, q) in a.tracked.iter().zip(&b.tracked) {
        let bits = |h: &[[f64; 3]]| h.iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
        assert!(bits(&p.displacement_m) == bits(&q.displacement_m), "{}", p.id);
    }
    assert_eq!(a.energies, b.energies);
    assert_eq!(a.summary.steps, b.summary.steps);
    assert_eq!(a.plastic_strain, b.plastic_strain);
}

#[test]
fn switching_gives_the_same_bytes_with_any_number_of_threads() {
    // it ends before a charge has settled
    let settings = HybridSettings { settle_s: 0.0, ..HybridSettings::default() };
    let one = short_run(Some(settings.clone()), 1);
    let record = one.hybrid.as_ref().unwrap();
    assert!(record.switches.iter().any(|s| s.reason == Reason::Quiet && s.elements > 500), "{record:?}");
    let two = short_run(Some(settings), 2);
    assert_same_bytes(&one, &two);
    assert_eq!(one.hybrid, two.hybrid);
}

/// What is rigid when a charge goes off deforms from then on, also while its forces fall: held parts would not follow.
#[test]
fn late_charges_release_what_is_rigid() {
    for duration in ["0 ms", "80 ms"] {
        let text = EXAMPLE
            .replace("time = \"0 ms\"", "time = \"150 ms\"")
            .replace("removal_duration = \"0 ms\"", &format!("removal_duration = \"{duration}\""));
        let building = parse(&text, Format::Toml, "building.toml").unwrap();
        let run = |hybrid: Option<HybridSettings>| {
            let options =
                FeOptions { end_time_s: Some(0.3), mesh_size_m: Some(0.5), hybrid, ..FeOptions::default() };
            run_with(&building, &options, Attached::default(), &mut |_| {}).unwrap()
        };
        let (full, parts) = (run(None), run(Some(HybridSettings::default())));
        let record = parts.hybrid.as_ref().unwrap();
        let fired = record.switches.iter().find(|s| s.reason == Reason::Charge).expect("parts were rigid");
        assert!((0.15..0.151).contains(&fired.time_s) && fired.rigid == 0, "{fired:?}");
        let sag =
            |run: &FeRun| run.tracked.iter().map(|h| h.displacement_m.last().unwrap()[2]).fold(0.0, f64::min);
        let (exact, found) = (sag(&full), sag(&parts));
        assert!(exact < -0.04 && (found / exact - 1.0).abs() < 2e-3, "{duration}: {found} m for {exact} m");
    }
}

#[test]
fn a_run_without_rigid_parts_is_the_ordinary_run() {
    let ordinary = short_run(None, 1);
    let run = short_run(Some(HybridSettings { rate_1_s: 1e-300, ..HybridSettings::default() }), 1);
    assert_same_bytes(&ordinary, &run);
    assert!(run.hybrid.unwrap().switches.is_empty());
}

#[test]
fn debris_blocks_and_checkpoints_are_refused() {
    let building = parse(EXAMPLE, Format::Toml, "building.toml").unwrap();
    let hybrid = Some(HybridSettings::default());
    let split = FeOptions { on_failure: Fate::Split, hybrid: hybrid.clone(), ..FeOptions::default() };
    let refused = run_with(&building, &split, Attached::default(), &mut |_| {}).unwrap_err();
    assert_eq!(refused, FeError::Hybrid(Refused::Split));
    let checkpoints = Some(Checkpoints { path: "nowhere".into(), every_s: 0.1 });
    let options = FeOptions { hybrid, ..FeOptions::default() };
    let attached = Attached { checkpoints, ..Attached::default() };
    let refused = run_with(&building, &options, attached, &mut |_| {}).unwrap_err();
    assert!(refused.is_input() && refused.to_string().contains("checkpoints"), "{refused}");
}
