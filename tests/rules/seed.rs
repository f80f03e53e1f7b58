//! The seed rules: complete, without conflict, and what they say of the reference frame.

use fallwerk::rules::{Action, Aspect, RuleBase, Subject, SubjectKind, Trace};
use std::path::Path;

fn seed() -> RuleBase {
    RuleBase::seed().unwrap_or_else(|problems| panic!("{problems}"))
}

fn member(kind: &str) -> Subject {
    Subject::new(SubjectKind::Member, "M").with("member.kind", kind).with("critical_strain_rate", 0.25)
}

fn body(subject: Subject) -> Action {
    seed().trace(&subject).unwrap().decision(Aspect::Body).unwrap().action
}

#[test]
fn they_have_no_gap_and_each_has_a_source() {
    let rules = seed();
    let gaps: Vec<String> = rules.gaps().iter().map(ToString::to_string).collect();
    assert!(gaps.is_empty(), "{gaps:#?}");
    for rule in rules.rules() {
        let sources =
            ["seed paper, section", "assumption: ", "GSA, ", "Johansen, ", "Paulay and Priestley, "];
        let known = sources.iter().any(|s| rule.source.starts_with(s));
        assert!(known, "{}: {}", rule.id, rule.source);
        assert!(rule.id.starts_with("seed/"));
    }
}

#[test]
fn the_rules_in_the_program_are_those_in_the_folder() {
    let folder = RuleBase::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("rules/seed")).unwrap();
    let text = |base: &RuleBase| serde_json::to_string(base.rules()).unwrap();
    assert_eq!(text(&folder), text(&seed()));
}

#[test]
fn columns_are_one_body_with_hinges_and_springs_at_both_ends() {
    assert_eq!(body(member("column")), Action::RigidBody);
    let rules = seed();
    for (position, clamped) in [("bottom", true), ("bottom", false), ("top", false)] {
        let end = Subject::new(SubjectKind::MemberEnd, "C1/end")
            .with("member.kind", "column")
            .with("end.position", position)
            .with("end.clamped", clamped);
        let trace = rules.trace(&end).unwrap();
        let hinge = trace.decision(Aspect::Rotation).unwrap();
        assert_eq!((hinge.action, hinge.parameters["curve"].clone()), (Action::Hinge, "library".into()));
        let reason = if clamped { "seed/clamped-foot-hinge" } else { "seed/column-end-hinge" };
        assert_eq!(hinge.rule, reason);
        let spring = trace.decision(Aspect::Translation).unwrap();
        assert_eq!(
            (spring.action, spring.parameters["directions"].clone()),
            (Action::TranslationalSpring, "axial_and_shear".into())
        );
        assert!(trace.undecided.is_empty());
    }
}

#[test]
fn floors_are_one_body_until_the_strain_rate_or_contact_says_otherwise() {
    for kind in ["slab", "beam"] {
        assert_eq!(body(member(kind)), Action::MergeRigid);
        assert_eq!(body(member(kind).with("member.strain_rate", 0.25)), Action::MergeRigid);
        assert_eq!(body(member(kind).with("member.strain_rate", 0.26)), Action::Subdivide);
        assert_eq!(body(member(kind).with("collapse.phase", "after_contact")), Action::Subdivide);
    }
    // With a strain rate, the rule of the strain rate is the reason, and it knows its range.
    let trace = |critical: f64| -> Trace {
        let slab = Subject::new(SubjectKind::Member, "S1")
            .with("member.kind", "slab")
            .with("member.strain_rate", 0.1);
        seed().trace(&slab.with("critical_strain_rate", critical)).unwrap()
    };
    let decision = |t: &Trace| t.decision(Aspect::Body).map(|f| (f.rule.clone(), f.in_range)).unwrap();
    assert_eq!(decision(&trace(0.25)), ("seed/floor-rigid-below-critical-rate".into(), true));
    assert_eq!(decision(&trace(0.5)), ("seed/floor-rigid-below-critical-rate".into(), false));
}

#[test]
fn events_change_the_model_and_ask_for_a_new_look_at_rigidity() {
    let rules = seed();
    let contact = Subject::new(SubjectKind::ContactEvent, "E1").with("contact.partner", "obstacle");
    let fracture = Subject::new(SubjectKind::FractureEvent, "E2");
    for (event, subsystem) in [(contact, "contact_and_hinge"), (fracture, "hinge")] {
        let trace = rules.trace(&event).unwrap();
        assert_eq!(trace.decision(Aspect::Change).unwrap().parameters["subsystem"], subsystem.into());
        assert_eq!(trace.decision(Aspect::Rigidity).unwrap().action, Action::RecheckRigidity);
    }
    let charged = member("column").with("member.charged", true);
    assert_eq!(rules.trace(&charged).unwrap().decision(Aspect::Charge).unwrap().action, Action::RemoveBody);
    assert!(
        rules
            .trace(&member("column").with("member.charged", false))
            .unwrap()
            .decision(Aspect::Charge)
            .is_none()
    );
}
