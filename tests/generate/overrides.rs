//! What the analyst decides in the building file: the model that comes of it, and who is named as its reason.

use super::{folding, generated, knowledge, moved_m, reference, standing};
use fallwerk::base::hash::ContentHash;
use fallwerk::base::tree::Format;
use fallwerk::building::{Building, Override, OverrideAction, parse};
use fallwerk::generate::{ANALYST, Accuracy, Derive, GenerateError, Generated, Wishes, generate};
use fallwerk::mbs::model::{Bending, Model};
use fallwerk::study::plan::Scene;

fn with(building: Building, overrides: &[(&str, OverrideAction)]) -> Building {
    let decided = |(target, action): &(&str, OverrideAction)| Override {
        target: target.to_string(),
        action: *action,
        reason: format!("reason of {target}"),
    };
    Building { overrides: overrides.iter().map(decided).collect(), ..building }
}

fn decided(overrides: &[(&str, OverrideAction)]) -> Generated {
    let generated = generated(&with(reference(|t| t), overrides)).expect("the library holds all entries");
    generated.model.check().expect("a sound model");
    generated
}

/// With floors in one piece.
fn whole_floors(building: &Building) -> Generated {
    let (rules, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Never, accuracy: Accuracy::Fast };
    generate(building, &rules, &mut store, wishes, &|_| {}).expect("the library holds all entries")
}

fn body_of<'a>(model: &'a Model, member: &str) -> &'a str {
    let body = model.bodies.iter().find(|b| b.origin.members.iter().any(|m| m == member));
    &body.expect("every member is part of a body").id
}

fn mass(model: &Model) -> f64 {
    model.bodies.iter().map(|b| b.mass_kg).sum()
}

/// Bodies of a floor.
fn pieces(model: &Model, slab: &str) -> usize {
    model.bodies.iter().filter(|b| b.id.split('/').next() == Some(slab)).count()
}

#[test]
fn a_file_with_overrides_makes_the_model_that_it_asks_for() {
    let chapter = "[[overrides]]\ntargets = [\"C1-*2.bottom\"]\naction = \"elastic_connection\"\nreason = \" cased \"\n\n[settings]";
    let building = reference(|text| text.replace("[settings]", chapter));
    let targets: Vec<&str> = building.overrides.iter().map(|o| o.target.as_str()).collect();
    assert_eq!(targets, ["C1-A2.bottom", "C1-B2.bottom"]);
    let model = generated(&building).unwrap();
    for end in &model.model.bushings {
        let chosen = targets.contains(&end.id.as_str());
        let elastic = end.bending.iter().all(|b| matches!(b, Bending::Elastic { .. }));
        assert_eq!((elastic, end.tensile_capacity_n.is_none()), (chosen, chosen), "{}", end.id);
        assert_eq!(end.origin.rules.iter().any(|r| r == ANALYST), chosen, "{}", end.id);
    }
    let reason = model.trace.iter().find(|r| r.subject == targets[0] && r.is_of_analyst()).unwrap();
    assert_eq!((reason.part.as_str(), reason.words.as_str()), (targets[0], "cased"));
    assert!(reason.instead_of.iter().any(|s| s.action == "hinge" && s.rule == "seed/clamped-foot-hinge"));
    let told = model.overrides();
    assert_eq!(told.len(), 1, "{told:?}");
    assert!(
        told[0].starts_with("C1-A2.bottom, C1-B2.bottom -> elastic_connection: cased (the rules"),
        "{told:?}"
    );
    // the rules that no longer count are not named as reasons
    let mut rules = model.trace.iter().filter(|r| r.subject == targets[0]).map(|r| r.action.as_str());
    assert!(rules.all(|action| action != "hinge"));
}

#[test]
fn without_overrides_nothing_changes() {
    let plain = generated(&reference(|t| t)).unwrap();
    // a decision for what the rules say as well: the same model, but for the reason
    let mut same = decided(&[("C1-A2.top", OverrideAction::Hinge)]);
    let own = |model: &Model| serde_json::to_string(model).unwrap();
    assert!(!own(&plain.model).contains(ANALYST) && plain.overrides().is_empty());
    assert_ne!(own(&plain.model), own(&same.model));
    let rules = |model: &Model| {
        let joint = model.bushings.iter().find(|b| b.id == "C1-A2.top").unwrap();
        joint.origin.rules.clone()
    };
    let before = rules(&plain.model);
    same.model
        .bushings
        .iter_mut()
        .filter(|b| b.id == "C1-A2.top")
        .for_each(|b| b.origin.rules = before.clone());
    assert_eq!(own(&plain.model), own(&same.model));
}

#[test]
fn records_of_fe_runs_are_those_of_the_building_with_and_without_overrides() {
    let plain = reference(|t| t);
    let other = with(reference(|t| t), &[("S1", OverrideAction::MergeElastic)]);
    assert_ne!(plain, other);
    assert_eq!(ContentHash::of_value(&plain).unwrap(), ContentHash::of_value(&other).unwrap());
}

#[test]
fn a_column_that_is_rigid_at_an_end_is_one_body_with_what_is_beside_it() {
    let plain = whole_floors(&reference(|t| t)).model;
    let decided = |overrides: &[(&str, OverrideAction)]| whole_floors(&with(reference(|t| t), overrides));
    let generated = decided(&[("C2-A1.top", OverrideAction::RigidConnection)]);
    let model = &generated.model;
    assert!(model.bushings.iter().all(|b| b.id != "C2-A1.top"));
    assert_eq!(model.bushings.len(), plain.bushings.len() - 1);
    assert_eq!(body_of(model, "C2-A1"), "S2");
    assert!((mass(model) / mass(&plain) - 1.0).abs() < 1e-12);
    let foot = model.bushings.iter().find(|b| b.id == "C2-A1.bottom").unwrap();
    assert_eq!((foot.body_a.as_deref(), foot.body_b.as_str()), (Some("S1"), "S2"));
    let reason = generated.trace.iter().find(|r| r.subject == "C2-A1.top").unwrap();
    assert_eq!((reason.part.as_str(), reason.rule.as_str()), ("S2", ANALYST));
    // at both ends: the two floors are one body, and it runs
    let both =
        [("C2-A1.top", OverrideAction::RigidConnection), ("C2-A1.bottom", OverrideAction::RigidConnection)];
    let mut joined = decided(&both).model;
    assert_eq!(body_of(&joined, "S1"), body_of(&joined, "S2"));
    joined.settings.end_time_s = 0.1;
    fallwerk::mbs::simulate(&joined).expect("it runs");
}

/// Beam ends of a floor that the analyst has in one piece are rigid by that decision, though the rules have each of them rigid anyway.
#[test]
fn rigid_ends_of_a_floor_that_the_analyst_has_whole_are_not_laid_on_rules() {
    let made = decided(&[("S1", OverrideAction::MergeRigid)]);
    let about = |note: &&String| note.starts_with("B1-") && note.contains("stays rigid by");
    let notes: Vec<&String> = made.notes.iter().filter(about).collect();
    assert!(!notes.is_empty() && notes.iter().all(|n| n.contains("by the analyst's decision")), "{notes:?}");
}

#[test]
fn floors_bend_or_are_whole_as_the_analyst_says() {
    let falling = whole_floors(&with(reference(|t| t), &[("B1-A1-B1", OverrideAction::MergeElastic)])).model;
    assert_eq!([pieces(&falling, "S1"), pieces(&falling, "S2")], [4, 1]);
    let whole = generated(&with(standing(), &[("S1", OverrideAction::MergeRigid)])).unwrap();
    assert_eq!([pieces(&whole.model, "S1"), pieces(&whole.model, "S2")], [1, 4]);
    // a column that is rigid in a floor that bends goes with its piece
    let column = ("C1-A2.top", OverrideAction::RigidConnection);
    let generated = generated(&with(standing(), &[column])).unwrap();
    let model = &generated.model;
    assert_eq!(pieces(model, "S1"), 4);
    assert_eq!(body_of(model, "C1-A2"), "S1/1-2");
    assert!((mass(model) / mass(&whole.model) - 1.0).abs() < 1e-12);
    let piece = model.bodies.iter().find(|b| b.id == "S1/1-2").unwrap();
    let other = model.bodies.iter().find(|b| b.id == "S1/2-2").unwrap();
    assert!((piece.mass_kg - other.mass_kg - 2500.0 * 0.16 * 3.0).abs() < 1e-6, "a column heavier");
    let mut still = model.clone();
    still.settings.end_time_s = 0.1;
    let moved = moved_m(&still);
    assert!(moved < 1e-5, "{moved}");
}

#[test]
fn a_line_is_there_or_not_for_all_beam_ends_on_it() {
    // the rules ask for lines for which there are no curves: S1 stays in one piece, and says so
    let scene = |overrides: &[(&str, OverrideAction)]| {
        let building = parse(&Scene::of(1, 26).toml(), Format::Toml, "scene").expect("a sound building");
        let (rules, (_, mut store, _cache)) = (folding(), knowledge());
        let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Fine };
        generate(&with(building, overrides), &rules, &mut store, wishes, &|_| {})
    };
    let told = |notes: &[String]| notes.iter().filter(|n| n.contains("stays in one piece")).count();
    assert_eq!(told(&scene(&[]).unwrap().notes), 1);
    let whole = scene(&[("S1", OverrideAction::MergeRigid)]).unwrap();
    assert_eq!(told(&whole.notes), 0, "{:?}", whole.notes);
    let follows = whole.trace.iter().find(|r| r.action == "rigid_connection" && r.is_of_analyst());
    assert!(follows.is_some_and(|r| r.words.contains("follows from `merge_rigid` of S1")), "{follows:?}");
    // who asks for such a line himself is told that it cannot be had
    match scene(&[("B1-A1-B1.start", OverrideAction::LatentHinge)]) {
        Err(GenerateError::Override(target, why)) => {
            assert_eq!(target, "B1-A1-B1.start");
            assert!(why.contains("no curves") && why.contains("`--derive` computes them"), "{why}");
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_wall_is_one_body_with_its_floors_if_the_analyst_says_so() {
    let building = parse(&Scene::of(1, 1).toml(), Format::Toml, "scene").expect("a sound building");
    let (rules, mut store, _cache) = knowledge();
    let mut of = |overrides: &[(&str, OverrideAction)]| {
        generate(&with(building.clone(), overrides), &rules, &mut store, Derive::Similar, &|_| {}).unwrap()
    };
    let (plain, merged) = (of(&[]), of(&[("W1", OverrideAction::MergeRigid)]));
    assert!(pieces(&plain.model, "S1") > 1);
    assert_eq!(body_of(&merged.model, "W1"), body_of(&merged.model, "S1"));
    let springs: Vec<&str> =
        merged.model.bushings.iter().map(|b| b.id.as_str()).filter(|id| id.starts_with("W1.")).collect();
    assert_eq!(springs, ["W1.bottom-1", "W1.bottom-2"]);
    assert!((mass(&merged.model) / mass(&plain.model) - 1.0).abs() < 1e-12);
    assert!(
        merged.notes.iter().any(|n| n.contains("it is one body with more than its floor")),
        "{:?}",
        merged.notes
    );
}
