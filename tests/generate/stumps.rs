//! Charges that take a stretch of a column: the pieces, what is taken when, and what is left.

use super::*;
use fallwerk::building::Charge;
use fallwerk::building::tracked::tracked_points;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::removal::hit;
use fallwerk::mbs::model::Event;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::simulate;

/// The reference building with charges on stretches of its columns, which are clear from 0 to 3 m: id, member, stretch \[m\] and time \[s\].
fn with(charges: &[(&str, Option<[f64; 2]>, f64)]) -> Building {
    let charge = |(k, (member, stretch_m, time_s)): (usize, &(&str, Option<[f64; 2]>, f64))| Charge {
        id: format!("c{}", k + 1),
        member: (*member).into(),
        stretch_m: *stretch_m,
        time_s: *time_s,
    };
    Building { events: charges.iter().enumerate().map(charge).collect(), ..reference(|t| t) }
}

fn of(building: &Building) -> Generated {
    let (rules, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Balanced };
    let generated = generate(building, &rules, &mut store, wishes, &|_| {}).unwrap();
    generated.model.check().expect("a sound model");
    generated
}

fn taken(events: &[Event]) -> Vec<(&str, Vec<&str>)> {
    events.iter().map(|e| (e.id.as_str(), e.remove_bodies.iter().map(String::as_str).collect())).collect()
}

/// A piece is taken out of the middle: three pieces with the mass of the column, of which one goes; until then the building stands as it does without charges.
#[test]
fn a_stretch_is_taken_out_of_a_column() {
    let generated = of(&with(&[("C1-A1", Some([0.8, 2.0]), 0.0)]));
    let model = &generated.model;
    let pieces: Vec<_> = model.bodies.iter().filter(|b| b.id.starts_with("C1-A1")).collect();
    let masses: Vec<f64> = pieces.iter().map(|b| b.mass_kg / (2500.0 * 0.16)).collect();
    for (mass, length_m) in masses.iter().zip([0.8, 1.2, 1.0]) {
        assert!((mass - length_m).abs() < 1e-9, "{masses:?}");
    }
    assert_eq!(taken(&model.events), [("c1", vec!["C1-A1/2"])]);
    let springs: Vec<&str> =
        model.bushings.iter().filter(|b| b.id.starts_with("C1-A1")).map(|b| b.id.as_str()).collect();
    assert_eq!(springs, ["C1-A1.bottom", "C1-A1.top", "C1-A1.cut-1", "C1-A1.cut-2"]);
    let mut still = model.clone();
    (still.events, still.settings.end_time_s) = (Vec::new(), 0.1);
    assert!(moved_m(&still) < 1e-5);
    for piece in pieces {
        assert!(
            generated.trace.iter().any(|r| piece.id.starts_with(&r.subject)),
            "{} has no reason",
            piece.id
        );
    }
}

/// The front columns lose 1.2 m: what is left of them above lands on what is left below, and the building bears on both.
#[test]
fn stumps_land_on_each_other() {
    let stretch = Some([0.8, 2.0]);
    let mut model = of(&with(&[("C1-A1", stretch, 0.0), ("C1-B1", stretch, 0.0)])).model;
    model.settings.end_time_s = 1.0;
    let run = simulate(&model).unwrap();
    let met = |e: &&fallwerk::mbs::result::RunEvent| matches!(&e.kind, EventKind::Contact { a, b } if a == "C1-A1/1" && b == "C1-A1/3");
    let first = run.events.iter().find(met).expect("they meet").time_s;
    // a floor that turns about its rear columns falls a little slower than freely: 0.49 s for 1.2 m
    assert!(first > 0.6 && first < 1.0, "{first}");
    assert!(run.energy_error < 0.02, "{}", run.energy_error);
}

/// Charges on one column at different times take what is theirs; rests shorter than half of the section go with them.
#[test]
fn every_charge_takes_its_own() {
    let building = with(&[
        ("C1-A1", Some([0.1, 1.0]), 0.0),
        ("C1-A1", Some([1.5, 2.9]), 0.2),
        ("C1-B1", Some([0.0, 1.5]), 0.0),
        ("C1-B1", None, 0.3),
        ("C1-A2", Some([0.05, 2.95]), 0.0),
    ]);
    let generated = of(&building);
    let expected = [
        ("c1", vec!["C1-A1/1"]),
        ("c2", vec!["C1-A1/3"]),
        ("c3", vec!["C1-B1/1"]),
        ("c4", vec!["C1-B1/2"]),
        ("c5", vec!["C1-A2"]),
    ];
    assert_eq!(taken(&generated.model.events), expected);
    let lengths = |id: &str| {
        let own = generated.model.bodies.iter().filter(|b| b.id.starts_with(id));
        own.map(|b| (b.mass_kg / (2500.0 * 0.16) * 1e6).round() / 1e6).collect::<Vec<f64>>()
    };
    assert_eq!(lengths("C1-A1"), [1.0, 0.5, 1.5]);
    assert_eq!(lengths("C1-B1"), [1.5, 1.5]);
    let words = "what charges leave of `C1-A1` between 0.00 and 0.10 m along it";
    assert!(generated.notes.iter().any(|n| n.starts_with(words)), "{:?}", generated.notes);
    // a column that keeps its top is tracked there, one that loses it is not
    let points = tracked_points(&building, &Partition::of(&building));
    let tracked = |id: &str| points.iter().any(|p| p.id == id);
    assert!(!tracked("C1-A1.top") && !tracked("C1-B1.top") && !tracked("C1-A2.top") && tracked("C1-B2.top"));
}

/// Stretches that end and begin at one place, but for the last digit, have nothing between them.
#[test]
fn stretches_that_meet_leave_nothing_between_them() {
    let stretches = [Some([0.0, 0.1 + 0.2]), Some([0.3, 0.6])];
    let generated = of(&with(&[("C1-A1", stretches[0], 0.0), ("C1-A1", stretches[1], 0.1)]));
    let expected = [("c1", vec!["C1-A1/1"]), ("c2", vec!["C1-A1/2"])];
    assert_eq!(taken(&generated.model.events), expected);
    assert_eq!(generated.model.bodies.iter().filter(|b| b.id.starts_with("C1-A1")).count(), 3);
    assert!(!generated.notes.iter().any(|n| n.starts_with("what charges leave")), "{:?}", generated.notes);
}

/// The hinge of a stump stands in it, and what it may be shortened by goes with its length.
#[test]
fn a_stump_has_the_hinge_of_its_end() {
    let whole = of(&with(&[("C1-A1", None, 0.0)])).model;
    let short = of(&with(&[("C1-A1", Some([0.5, 2.0]), 0.0)])).model;
    let of = |model: &fallwerk::mbs::model::Model, id: &str| {
        model.bushings.iter().find(|b| b.id == id).unwrap().clone()
    };
    let [a, b] = [&whole, &short].map(|model| of(model, "C1-A1.bottom"));
    let ratio = b.crushing_shortening_m.unwrap() / a.crushing_shortening_m.unwrap();
    assert!((ratio - 0.5 / 1.5).abs() < 1e-9, "{ratio}");
    assert!(b.point_m[2] > 0.0 && b.point_m[2] <= 0.25, "{:?}", b.point_m);
    assert_eq!((a.compressive_capacity_n, a.bending), (b.compressive_capacity_n, b.bending));
    let faces: Vec<_> = short.contact.crushing.iter().filter(|f| f.body.starts_with("C1-A1")).collect();
    let named: Vec<_> = faces.iter().map(|f| (f.body.as_str(), f.face)).collect();
    let expected = [
        ("C1-A1/1", Face::LowZ),
        ("C1-A1/1", Face::HighZ),
        ("C1-A1/3", Face::LowZ),
        ("C1-A1/3", Face::HighZ),
    ];
    assert_eq!(named, expected);
}

/// In the FE model a charge takes the elements of its stretch and no more: planes of the mesh stand at its ends, but for those nearer than a quarter of the mesh size to another one.
#[test]
fn the_mesh_has_planes_at_the_ends_of_a_stretch() {
    let length_m = |stretch: [f64; 2]| {
        let building = with(&[("C1-A1", Some(stretch), 0.0)]);
        let (mesh, _) = Mesh::of(&building, building.settings.mesh_size_m);
        let volume = |e: &usize| -> f64 {
            let corners = mesh.elements[*e].nodes.map(|n| mesh.nodes[n]);
            let along = |i: usize| corners.iter().map(move |c| c[i]);
            let size = |i: usize| along(i).fold(f64::MIN, f64::max) - along(i).fold(f64::MAX, f64::min);
            size(0) * size(1) * size(2)
        };
        hit(&building, &mesh, &building.events[0]).iter().map(volume).sum::<f64>() / 0.16
    };
    for (stretch, expected) in [([0.8, 2.0], 1.2), ([0.0, 1.3], 1.3), ([0.45, 0.95], 0.5), ([1.1, 3.0], 1.9)]
    {
        assert!((length_m(stretch) - expected).abs() < 1e-9, "{stretch:?}: {}", length_m(stretch));
    }
}

/// Stretches of beams are refused, with a remedy; one of a column that is one body with others too.
#[test]
fn a_stretch_of_a_beam_is_refused() {
    let (rules, mut store, _cache) = knowledge();
    let building = with(&[("B1-A1-B1", Some([2.0, 3.0]), 0.0)]);
    let message = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap_err().to_string();
    assert!(message.contains("`c1`") && message.contains("`B1-A1-B1`") && message.contains("columns only"));
}
