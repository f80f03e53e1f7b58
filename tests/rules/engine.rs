//! Evaluation: order, unknown features, ranges, precedence, determinism.

use super::{base, rule};
use fallwerk::rules::{Action, Aspect, Subject, SubjectKind};

fn column() -> Subject {
    Subject::new(SubjectKind::Member, "C1").with("member.kind", "column")
}

const DIVIDE: [&str; 2] = ["action = \"subdivide\"", "parameters = { pieces = 3 }"];

#[test]
fn priority_decides_and_the_rest_is_kept_in_order() {
    let rules = base(&[
        rule("low", &["priority = 1"]),
        rule("high", &["priority = 9", DIVIDE[0], DIVIDE[1]]),
        rule("also-low", &["priority = 1"]),
        rule("charge", &["priority = 5", "action = \"remove_body\"", "when = \"member.charged\""]),
    ])
    .unwrap();
    let trace = rules.trace(&column().with("member.charged", true)).unwrap();
    let fired: Vec<(&str, Option<&str>)> =
        trace.firings.iter().map(|f| (f.rule.as_str(), f.overruled_by.as_deref())).collect();
    assert_eq!(fired, [("high", None), ("charge", None), ("also-low", Some("high")), ("low", Some("high"))]);
    let decision = trace.decision(Aspect::Body).unwrap();
    assert_eq!((decision.action, decision.parameters["pieces"].clone()), (Action::Subdivide, 3.0.into()));
    assert_eq!(trace.decision(Aspect::Charge).unwrap().action, Action::RemoveBody);
}

#[test]
fn what_is_not_known_makes_a_rule_silent_with_a_reason() {
    let rules = base(&[
        rule("rate", &["when = \"member.strain_rate <= 2 * critical_strain_rate\""]),
        rule("either", &["when = \"member.charged or member.kind == 'column'\""]),
        rule("neither", &["when = \"member.charged and member.kind == 'beam'\""]),
        rule("not", &["when = \"not member.charged\""]),
    ])
    .unwrap();
    let trace = rules.trace(&column()).unwrap();
    assert_eq!(trace.firings.iter().map(|f| f.rule.as_str()).collect::<Vec<_>>(), ["either"]);
    let silent = rules.silent(&column());
    let silent: Vec<(&str, Vec<&str>)> =
        silent.iter().map(|s| (s.rule.as_str(), s.missing.iter().map(String::as_str).collect())).collect();
    assert_eq!(
        silent,
        [
            ("neither", vec![]),
            ("not", vec!["member.charged"]),
            ("rate", vec!["critical_strain_rate", "member.strain_rate"]),
        ]
    );
    let beam = Subject::new(SubjectKind::Member, "B1").with("member.kind", "beam");
    assert_eq!(rules.trace(&beam).unwrap().undecided, [Aspect::Body]);
    // The factor is applied: 0.5 <= 2 * 0.25.
    let at = |rate: f64| column().with("member.strain_rate", rate).with("critical_strain_rate", 0.25);
    let fires = |rate: f64| rules.evaluate(&at(rate)).unwrap().iter().any(|f| f.rule == "rate");
    assert!(fires(0.5) && !fires(0.500_001));
}

#[test]
fn firings_outside_the_range_of_evidence_say_so() {
    let rules =
        base(&[rule("a", &["range = { storeys = [1, 4], \"member.length\" = [2.0, 4.0] }"])]).unwrap();
    let fire = |storeys: f64, length: f64| {
        rules.evaluate(&column().with("storeys", storeys).with("member.length", length)).unwrap().remove(0)
    };
    assert!(fire(4.0, 2.0).in_range);
    let outside = fire(6.0, 5.0);
    assert!(!outside.in_range);
    assert_eq!(
        outside.outside,
        ["member.length is 5 m, evidence from 2 to 4 m", "storeys is 6, evidence from 1 to 4"]
    );
    let unknown = rules.evaluate(&column()).unwrap().remove(0);
    assert!(!unknown.in_range && unknown.missing == ["member.length", "storeys"]);
}

#[test]
fn a_rule_supersedes_another_only_within_its_range() {
    let rules = base(&[
        rule("old", &["priority = 9"]),
        rule(
            "new",
            &["priority = 1", DIVIDE[0], DIVIDE[1], "supersedes = [\"old\"]", "range = { storeys = [1, 4] }"],
        ),
    ])
    .unwrap();
    let decides = |storeys: f64| {
        rules.trace(&column().with("storeys", storeys)).unwrap().decision(Aspect::Body).unwrap().rule.clone()
    };
    assert_eq!(decides(3.0), "new");
    assert_eq!(decides(5.0), "old");
    let circle =
        base(&[rule("a", &["supersedes = [\"b\"]"]), rule("b", &["supersedes = [\"a\"]"])]).unwrap_err();
    assert!(circle.contains("`a` supersedes itself through `b`"), "{circle}");
}

#[test]
fn subjects_are_checked_against_the_catalogue() {
    let rules = base(&[rule("a", &[])]).unwrap();
    let error = |subject: Subject| rules.evaluate(&subject).unwrap_err().to_string();
    assert_eq!(
        error(column().with("memberkind", "column")),
        "subject `C1`: unknown feature `memberkind`; did you mean `member.kind`?"
    );
    assert!(error(column().with("member.length", "long")).contains("is a number in m, not 'long'"));
    assert!(error(column().with("end.clamped", true)).contains("a member has no feature `end.clamped`"));
    assert!(error(column().with("member.length", f64::NAN)).contains("is a number in m, not NaN"));
}

#[test]
fn neither_the_order_of_files_nor_of_rules_changes_the_answer() {
    use fallwerk::rules::{RuleBase, Source};
    let texts: Vec<String> =
        (0..9).map(|i| rule(&format!("r{i}"), &[&format!("priority = {}", i % 3)])).collect();
    let load = |order: &[usize]| {
        let source =
            |i: &usize| Source { name: format!("{i}.toml"), text: format!("schema = 1\n{}", texts[*i]) };
        let rules = RuleBase::from_sources(order.iter().map(source).collect()).unwrap();
        serde_json::to_string(&rules.trace(&column()).unwrap()).unwrap()
    };
    assert_eq!(load(&[0, 1, 2, 3, 4, 5, 6, 7, 8]), load(&[8, 3, 5, 0, 7, 1, 6, 2, 4]));
}
