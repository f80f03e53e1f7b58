//! Runs of decks.

use super::super::mesh::{bilinear, elastic, grid, nearest, round_bar};
use super::{CUBE, good, with};
use fallwerk::fe::deck::{DeckOptions, read, write};
use fallwerk::fe::mesh::Element;
use fallwerk::fe::model::{BodyLoad, ContactSettings, Curve, Model, RigidPlane};
use fallwerk::fe::model_run::{ModelError, ModelOptions, ModelRun, run_model};
use fallwerk::fe::run::FeError;
use fallwerk::fe::watch::{Diagnosis, Place, Trouble};
use std::path::Path;

fn run(model: &Model) -> ModelRun {
    run_model(model, &ModelOptions::default(), None, &mut |_| {}).unwrap_or_else(|e| panic!("{e}"))
}

fn example(name: &str) -> Model {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("decks").join(name);
    read(&path, DeckOptions::default()).unwrap_or_else(|e| panic!("{e}")).model
}

/// OpenRadioss, the same mesh: -24.918 mm at 0.08956 s.
#[test]
fn cantilever() {
    let run = run(&example("cantilever.k"));
    let down = run.histories[0].displacement_m.iter().zip(&run.times_s).filter(|(_, t)| **t < 0.12);
    let (peak, time) = down.map(|(u, t)| (1e3 * u[2], *t)).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
    assert!((peak / -24.918 - 1.0).abs() < 0.002, "peak {peak} mm");
    assert!((time / 0.08956 - 1.0).abs() < 0.007, "at {time} s");
    assert!(run.summary.energy_error < 1e-3, "energy {}", run.summary.energy_error);
}

#[test]
fn falling_bar() {
    let model = example("falling-bar.k");
    let run = run(&model);
    let top: Vec<f64> = run.histories[0].displacement_m.iter().map(|u| u[2]).collect();
    // free fall until the foot has gone 0.5 m
    let free = run.times_s.iter().position(|t| *t > 0.05).unwrap();
    let t = run.times_s[free];
    assert!((top[free] / -(8.0 * t + 0.5 * 9.81 * t * t) - 1.0).abs() < 1e-3, "{}", top[free]);
    assert!(run.end_m.iter().all(|x| x[2] > -1e-9));
    let strain = run.plastic_strain.iter().copied().fold(0.0, f64::max);
    assert!((0.005..0.2).contains(&strain), "{strain}");
    let last = run.energies.last().unwrap();
    assert!(last.contact_j < 0.0 && run.summary.energy_error < 0.005, "{last:?}");
}

/// Taylor's copper bar, written as a deck and read again: 21.47 to 21.67 mm (OpenRadioss, published codes 21.4 to 21.5).
#[test]
fn taylor_bar_from_a_deck() {
    let mesh = round_bar(32.4e-3, 3.2e-3, [24, 1], bilinear(117e9, 0.35, 8930.0, 400e6, 100e6));
    let top = nearest(&mesh, [0.0, 0.0, 32.4e-3]);
    let ground = RigidPlane { point_m: [0.0; 3], normal: [0.0, 0.0, 1.0], friction: 0.0, nodes: None };
    let mut model = Model {
        initial_velocity_m_s: (0..mesh.nodes.len()).map(|n| (n, [0.0, 0.0, -227.0])).collect(),
        mesh,
        walls: vec![ground],
        ..Model::default()
    };
    model.control.end_time_s = 80e-6;
    model.control.state_interval_s = 80e-6;
    model.control.history_interval_s = 1e-6;
    model.control.history_nodes = vec![top];
    let deck = good(&write(&model, &[]).text);
    let run = run(&deck.model);
    let length = run.end_m[top][2];
    let foot = run.end_m.iter().map(|x| x[0].hypot(x[1])).fold(0.0, f64::max);
    assert!((21.3e-3..21.75e-3).contains(&length), "length {length}");
    assert!((6.7e-3..7.3e-3).contains(&foot), "foot radius {foot}");
    assert!(run.end_m.iter().all(|x| x[2] > -1e-12), "no node is below the wall");
    assert!(run.summary.energy_error < 0.01, "energy {}", run.summary.energy_error);
}

/// Two blocks that overlap by 2 mm come apart in the same way in metres, kilograms, seconds and in centimetres, grams, microseconds.
#[test]
fn overlaps_go_in_all_units() {
    let risen = |metre: f64, kilogram: f64, second: f64| {
        let pascal = kilogram / (metre * second * second);
        let law = bilinear(30e9 * pascal, 0.2, 2500.0 * kilogram / metre.powi(3), 1e15 * pascal, 0.0);
        let mut mesh = grid([2; 3], [0.2 * metre; 3], law, |_| false);
        let lower = mesh.clone();
        let first = lower.nodes.len();
        let moved = [0.003, 0.005, 0.198].map(|u| u * metre);
        mesh.nodes.extend(lower.nodes.iter().map(|x| std::array::from_fn::<_, 3, _>(|i| x[i] + moved[i])));
        mesh.elements
            .extend(lower.elements.iter().map(|e| Element { nodes: e.nodes.map(|n| n + first), ..*e }));
        let mut model =
            Model { mesh, body_contact: Some(ContactSettings { friction: 0.0 }), ..Model::default() };
        model.control.end_time_s = 0.01 * second;
        model.control.history_interval_s = 0.01 * second;
        model.control.state_interval_s = 0.01 * second;
        let top = first + nearest(&lower, [0.2 * metre; 3]);
        (run(&model).end_m[top][2] / metre - 0.398, model.mesh.nodes.len())
    };
    let (si, nodes) = risen(1.0, 1.0, 1.0);
    let (other, _) = risen(100.0, 1000.0, 1e6);
    assert_eq!(nodes, 54);
    assert!(si > 1e-5 && si < 1e-3, "{si}");
    assert!((other / si - 1.0).abs() < 1e-3, "{si} {other}");
}

/// A node that is held across the fall still meets the wall.
#[test]
fn held_nodes_meet_the_wall() {
    let text = with(CUBE, "*NODE\n", "*NODE\n$ one metre higher\n")
        .replace("             0.0\n", "             0.2\n")
        .replace("             1.0\n", "             1.2\n");
    let held = good(&text).model;
    assert_eq!(held.constraints.len(), 4);
    let run = run(&Model {
        control: fallwerk::fe::model::Control { end_time_s: 0.2, ..held.control.clone() },
        ..held
    });
    let lowest = run.end_m.iter().map(|x| x[2]).fold(f64::INFINITY, f64::min);
    assert!(lowest > -1e-9, "{lowest}");
    assert!(run.energies.last().unwrap().contact_j < 0.0);
}

/// A given velocity moves its node; a nodal force does the work that the energies show.
#[test]
fn given_motion_and_forces() {
    let cards = "*BOUNDARY_PRESCRIBED_MOTION_NODE\n5,3,0,8,1.0\n*DEFINE_CURVE\n8\n0,0\n1,2\n*LOAD_NODE_POINT\n7,1,9,1000.\n*DEFINE_CURVE\n9\n0,1\n1,1\n*NODE\n";
    let begin = CUBE.find("*RIGIDWALL").unwrap();
    let end = CUBE.find("*NODE\n").unwrap();
    let text = with(&format!("{}{}", &CUBE[..begin], &CUBE[end..]), "*NODE\n", cards)
        .replace("       0.0       0.0      -2.0", "       0.0       0.0       0.0");
    let model = good(&text).model;
    let run = run(&model);
    let t = run.times_s.last().unwrap();
    assert!((run.end_m[4][2] - 1.0 - t * t).abs() < 1e-4, "{}", run.end_m[4][2]);
    let last = run.energies.last().unwrap();
    assert!(last.driven_j != 0.0 && run.summary.energy_error < 0.01, "{last:?} {}", run.summary.energy_error);
}

/// A clamped node starts at rest, whatever velocity it is given: its kinetic energy would have to be taken away by nothing.
#[test]
fn clamped_nodes_start_at_rest() {
    let mesh = grid([2, 1, 1], [1.0, 0.5, 0.5], elastic(), |p| p[0] == 0.0);
    let mut model = Model {
        initial_velocity_m_s: (0..mesh.nodes.len()).map(|n| (n, [1.0, 0.0, 0.0])).collect(),
        mesh,
        ..Model::default()
    };
    model.control.end_time_s = 1e-3;
    (model.control.state_interval_s, model.control.history_interval_s) = (1e-3, 1e-4);
    let run = run(&model);
    // 625 kg, of which a quarter is at the clamped face
    assert!((run.energies[0].kinetic_j / (0.5 * 625.0 * 0.75) - 1.0).abs() < 1e-12, "{:?}", run.energies[0]);
    assert_eq!(run.energies.last().unwrap().driven_j, 0.0);
    // nothing has eroded: 0 in the tables, not -0
    assert!(run.energies.iter().all(|e| e.eroded_j.to_bits() == 0), "{:?}", run.energies[0]);
}

/// A block in free fall: a row has the place at its time, the velocity half a step before and the energy one step before.
#[test]
fn rows_have_energies_of_the_step_before() {
    let mesh = grid([1; 3], [1.0; 3], elastic(), |_| false);
    let gravity = BodyLoad { axis: 2, acceleration_m_s2: Curve::constant(-9.81) };
    let mut model = Model { mesh, body_loads: vec![gravity], ..Model::default() };
    (model.control.end_time_s, model.control.history_interval_s) = (1e-3, 1e-6);
    model.control.history_nodes = vec![0];
    let run = run(&model);
    let step_s = run.summary.time_step_s;
    assert!(run.times_s.len() > 4 && run.times_s.len() == run.summary.steps as usize + 1);
    for (row, time_s) in run.times_s.iter().enumerate().skip(2) {
        let [moved, speed] = [run.histories[0].displacement_m[row][2], run.histories[0].velocity_m_s[row][2]];
        assert!((moved / (-0.5 * 9.81 * time_s * time_s) - 1.0).abs() < 0.01, "{row}: {moved}");
        assert!((speed / -9.81 - (time_s - 0.5 * step_s)).abs() < 0.05 * step_s, "{row}: {speed}");
        let fallen_s = (2.0 * run.energies[row].kinetic_j / run.summary.mass_kg).sqrt() / 9.81;
        assert!((fallen_s - (time_s - step_s)).abs() < 0.2 * step_s, "{row}: {fallen_s} {time_s}");
    }
}

#[test]
fn mass_scaling_keeps_the_step() {
    let mut model = example("cantilever.k");
    model.control.end_time_s = 0.01;
    let plain = run(&model).summary.time_step_s;
    model.control.mass_scaling_step_s = Some(1.4 * plain);
    let scaled = run(&model);
    assert!(
        (scaled.summary.time_step_s / (1.4 * plain) - 1.0).abs() < 1e-9,
        "{}",
        scaled.summary.time_step_s
    );
    assert!((scaled.added_mass_kg / 25_000.0 / 0.96 - 1.0).abs() < 1e-6, "{}", scaled.added_mass_kg);
}

/// What is told of a run that stopped has the identifiers of the deck, and remedies that a deck has.
#[test]
fn a_run_that_stops_speaks_of_the_deck() {
    let ids = good(
        &CUBE
            .replace("       8             0.0", "    4711             0.0")
            .replace("       7       8\n*END", "       7    4711\n*END")
            .replace("*DATABASE_HISTORY_NODE\n         8", "*DATABASE_HISTORY_NODE\n      4711"),
    )
    .ids;
    let place =
        |index: usize| Some(Place { index, part: "cube".into(), at_m: [0.0; 3], value: 1.0, is_bar: false });
    let diagnosis = Diagnosis {
        time_s: 0.1,
        trouble: Trouble::NotFinite(Some(7)),
        sound_s: 0.0,
        grown: ("kinetic energy", 1.0),
        step_s: 1e-3,
        smallest: place(0),
        fastest: place(7),
    };
    let bar = Place { is_bar: true, ..place(0).unwrap() };
    let of_bar = Diagnosis { smallest: Some(bar), ..diagnosis.clone() }.by_ids(&[], &[1], &[77]).to_string();
    assert!(of_bar.contains("by bar 77 of part"), "{of_bar}");
    let words = ids.words(&FeError::Unsound(Box::new(diagnosis))).unwrap();
    for part in ["node 4711 has no finite", "by element 1 of part", "fastest node is 4711 of"] {
        assert!(words.contains(part), "{part}: {words}");
    }
    let lost =
        FeError::Contact { time_s: 0.1, part: "a".into(), other: "b".into(), depth_m: 0.2, at_m: [0.0; 3] };
    let words = ids.words(&lost).unwrap();
    assert!(words.contains("*CONTACT") && !words.contains("--"), "{words}");
    assert_eq!(ids.words(&FeError::Empty), None);
}

#[test]
fn models_that_do_not_run_say_why() {
    let stop = |model: &Model| run_model(model, &ModelOptions::default(), None, &mut |_| {}).unwrap_err();
    let mut model = good(CUBE).model;
    model.control.end_time_s = 1e9;
    model.control.state_interval_s = 1e8;
    assert!(matches!(stop(&model), ModelError::TooLong { .. }));
    assert!(matches!(stop(&Model::default()), ModelError::Empty));
}
