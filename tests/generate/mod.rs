//! The generated model of the reference building: what is in it, and that every part says why.

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, parse};
use fallwerk::generate::{Derive, GenerateError, Generated, generate};
use fallwerk::library::Store;
use fallwerk::rules::RuleBase;
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
