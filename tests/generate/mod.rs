//! The generated model of the reference building: what is in it, and that every part says why.

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, parse};
use fallwerk::generate::{Derive, GenerateError, Generated, generate};
use fallwerk::library::Store;
use fallwerk::rules::{RuleBase, Source};
use std::path::Path;

fn reference(change: impl Fn(String) -> String) -> Building {
    parse(&change(EXAMPLE.to_string()), Format::Toml, "reference").expect("the reference is sound")
}

fn knowledge() -> (RuleBase, Store, tempfile::TempDir) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let cache = tempfile::tempdir().unwrap();
    let rules = RuleBase::load(&root.join("rules")).expect("the shipped rules are sound");
    let store =
        Store::open_with_cache(&root.join("library"), cache.path()).expect("the shipped library is sound");
    (rules, store, cache)
}

fn generated(building: &Building) -> Result<Generated, GenerateError> {
    let (rules, mut store, _cache) = knowledge();
    generate(building, &rules, &mut store, Derive::Never, &|_| {})
}

#[test]
fn the_reference_needs_no_curve_that_is_not_shipped() {
    let model = generated(&reference(|t| t)).expect("the library holds all entries").model;
    assert_eq!(model.bodies.len(), 15, "three floors and twelve columns");
    assert_eq!(model.bushings.len(), 24, "both ends of twelve columns: these yield before the beams");
    assert_eq!(model.events.len(), 2);
    model.check().expect("a sound model");
}

#[test]
fn bodies_carry_the_mass_and_inertia_of_the_solids() {
    let building = reference(|t| t);
    let model = generated(&building).unwrap().model;
    let volume: f64 = Partition::of(&building).volumes(building.members.len()).iter().sum();
    let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
    assert!((mass / (2500.0 * volume) - 1.0).abs() < 1e-12);
    // a column: 0.4 x 0.4 x 3.0 m between slab and beam, the first storey's alike
    let column = model.bodies.iter().find(|b| b.id == "C1-A2").unwrap();
    let m: f64 = 2500.0 * 0.16 * 3.0;
    assert!((column.mass_kg - m).abs() < 1e-6);
    assert!((column.inertia_kg_m2[0][0] / (m * (0.16 + 9.0) / 12.0) - 1.0).abs() < 1e-9);
    assert!((column.inertia_kg_m2[2][2] / (m * 0.32 / 12.0) - 1.0).abs() < 1e-9);
    assert!((column.position_m[2] - 1.5).abs() < 1e-9);
}

#[test]
fn every_part_names_members_rules_and_entries() {
    let generated = generated(&reference(|t| t)).unwrap();
    let (rules, ..) = knowledge();
    for body in &generated.model.bodies {
        assert!(!body.origin.members.is_empty() && !body.origin.rules.is_empty(), "{}", body.id);
    }
    for joint in &generated.model.bushings {
        assert!(!joint.origin.entries.is_empty() && joint.origin.rules.len() >= 2, "{}", joint.id);
        assert!(joint.origin.rules.iter().all(|r| rules.rule(r).is_some()));
    }
    for part in
        generated.model.bodies.iter().map(|b| &b.id).chain(generated.model.bushings.iter().map(|j| &j.id))
    {
        assert!(generated.trace.iter().any(|r| r.part == *part && !r.words.is_empty()), "{part}");
    }
}

fn folding() -> Building {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings/folding-floor.toml");
    parse(&std::fs::read_to_string(path).unwrap(), Format::Toml, "folding-floor").expect("a sound building")
}

/// Pieces of a floor move as one until a line gives way; the lines of the beam ends carry their names, and what stands on a floor stands on the piece below it.
#[test]
fn floors_may_fold_where_beams_yield_before_columns() {
    let model = generated(&folding()).expect("the library holds all entries").model;
    let line = |id: &str| model.bushings.iter().find(|b| b.id == id).unwrap_or_else(|| panic!("{id}"));
    let start = line("B1-A1-B1.start");
    let section: Vec<&str> =
        model.bushings.iter().filter(|b| b.latent == start.latent).map(|b| b.id.as_str()).collect();
    assert!(start.latent.is_some() && section.contains(&"B1-A2-B2.start"), "{section:?}");
    let (held, bent) = (start.body_a.as_deref().unwrap(), &start.body_b);
    assert_eq!(line("C2-A1.bottom").body_a.as_deref(), Some(held));
    assert_ne!(held, bent);
    // pieces have the mass of the floor
    let of =
        |floor: &str| model.bodies.iter().filter(|b| b.id.starts_with(floor)).map(|b| b.mass_kg).sum::<f64>();
    let building = folding();
    let volumes = Partition::of(&building).volumes(building.members.len());
    let floor = building.members.iter().zip(&volumes).filter(|(m, _)| m.storey == Some(1));
    let floor = floor.filter(|(m, _)| m.id.starts_with('B') || m.id.starts_with('S'));
    let mass: f64 = floor.map(|(_, v)| 2500.0 * v).sum();
    assert!((of("S1") / mass - 1.0).abs() < 1e-9, "{} {mass}", of("S1"));
    model.check().expect("a sound model");
}

/// Without a rule for them the floors are one body each, as in the seed paper.
#[test]
fn without_lines_floors_are_one_body() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("rules/seed");
    let read = |name: &str| std::fs::read_to_string(root.join(name)).unwrap();
    let hinges = read("hinges.toml");
    let begin = hinges.find("[[rule]]\nid = \"seed/floor-may-fold\"").unwrap();
    let end = begin + 2 + hinges[begin + 2..].find("[[rule]]").unwrap();
    let without = format!("{}{}", &hinges[..begin], &hinges[end..]);
    let source = |name: &str, text: String| Source { name: name.into(), text };
    let others = ["bodies.toml", "springs.toml"].map(|n| source(n, read(n)));
    let sources = others.into_iter().chain([source("hinges.toml", without)]);
    let rules = RuleBase::from_sources(sources.collect()).unwrap();
    let (_, mut store, _cache) = knowledge();
    let model = generate(&folding(), &rules, &mut store, Derive::Never, &|_| {}).unwrap().model;
    assert!(model.bushings.iter().all(|b| b.latent.is_none()) && model.bodies.iter().any(|b| b.id == "S1"));
}

#[test]
fn a_missing_curve_is_named_and_not_replaced() {
    let other = reference(|t| t.replace("[0, \"10.5 MPa\"]", "[0, \"11 MPa\"]"));
    match generated(&other) {
        Err(GenerateError::Missing(ends)) => assert!(ends.iter().any(|e| e.starts_with("C1")), "{ends:?}"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_stretch_of_a_column_is_refused_with_a_remedy() {
    let building = {
        let mut b = reference(|t| t);
        b.events[0].stretch_m = Some([0.5, 1.0]);
        b
    };
    let message = generated(&building).unwrap_err().to_string();
    assert!(message.contains("whole members") && message.contains(&building.events[0].member), "{message}");
}

#[test]
fn a_slow_removal_is_named_as_a_difference_between_the_models() {
    let building = {
        let mut b = reference(|t| t);
        b.settings.removal_duration_s = 0.02;
        b
    };
    let notes = generated(&building).unwrap().notes;
    assert!(notes.iter().any(|n| n.contains("0.02 s to remove")), "{notes:?}");
}

#[test]
fn without_rules_there_is_no_model() {
    let (_, mut store, _cache) = knowledge();
    let none = RuleBase::from_sources(Vec::new()).expect("no rules are no error");
    let error = generate(&reference(|t| t), &none, &mut store, Derive::Never, &|_| {}).unwrap_err();
    assert!(matches!(error, GenerateError::Gap(_)), "{error}");
}
