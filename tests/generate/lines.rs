//! Lines of slabs and ends of walls: what rules and the analyst decide about them, and the model that comes of it.

use super::{knowledge, reference};
use fallwerk::base::tree::Format;
use fallwerk::building::{Building, EXAMPLE, Override, OverrideAction, parse};
use fallwerk::generate::known::Known;
use fallwerk::generate::{ANALYST, Accuracy, Derive, Generated, Wishes, generate};
use fallwerk::mbs::model::{Bending, Bushing};
use fallwerk::rules::{RuleBase, Source, Subject, SubjectKind, Value};

fn made(building: &Building, rules: &RuleBase, accuracy: Accuracy) -> Generated {
    let (_, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Never, accuracy };
    let generated =
        generate(building, rules, &mut store, wishes, &|_| {}).expect("the library holds all entries");
    generated.model.check().expect("a sound model");
    generated
}

/// The rules without those learned from studies, which may have an opinion of their own.
fn seed() -> RuleBase {
    knowledge().0.without("learned/")
}

/// Rules with one more, which has some lines stay elastic.
fn with_rule(kind: &str, condition: &str) -> RuleBase {
    let text = format!(
        "schema = 1\n[[rule]]\nid = \"test/elastic\"\nwords = \"It stays elastic.\"\napplies_to = \"{kind}\"\nwhen = \"{condition}\"\naction = \"elastic_connection\"\npriority = 60\nsource = \"assumption: a test\"\n"
    );
    seed().with(vec![Source { name: "test.toml".into(), text }]).unwrap()
}

fn is_elastic(joint: &Bushing) -> bool {
    let elastic = joint.bending.iter().all(|b| matches!(b, Bending::Elastic { .. }));
    assert!(elastic == joint.tensile_capacity_n.is_none() || joint.beam.is_none(), "{}", joint.id);
    elastic
}

/// Springs on a line.
fn on<'a>(generated: &'a Generated, line: &'a str) -> impl Iterator<Item = &'a Bushing> {
    generated.model.bushings.iter().filter(move |j| j.origin.members.iter().any(|m| m == line))
}

#[test]
fn a_rule_keeps_strips_of_slabs_elastic_and_all_else_as_it_is() {
    let building = reference(|t| t);
    let before = made(&building, &seed(), Accuracy::Balanced);
    let after = made(&building, &with_rule("slab_line", "member.storey == 3"), Accuracy::Balanced);
    assert_eq!(before.model.bushings.len(), after.model.bushings.len());
    let mut kept = 0;
    for (a, b) in before.model.bushings.iter().zip(&after.model.bushings) {
        let is_kept = a.origin.members.iter().any(|m| m.starts_with("S3:"));
        kept += usize::from(is_kept);
        if is_kept {
            assert!(!is_elastic(a) && is_elastic(b), "{}", a.id);
            assert_eq!(a.shear_stiffness_n_m, b.shear_stiffness_n_m);
        } else {
            assert_eq!(a, b);
        }
    }
    assert_eq!(kept, 4, "a floor of four columns has four strips");
    let reason = after.trace.iter().find(|r| r.subject == "S3:C3-A1|C3-B1").unwrap();
    assert_eq!((reason.rule.as_str(), reason.action.as_str()), ("test/elastic", "elastic_connection"));
}

#[test]
fn an_analyst_decides_about_one_strip() {
    let id = "S2:C2-A1|C2-B1";
    let decided =
        Override { target: id.into(), action: OverrideAction::ElasticConnection, reason: "propped".into() };
    let building = Building { overrides: vec![decided], ..reference(|t| t) };
    let generated = made(&building, &seed(), Accuracy::Balanced);
    assert!(on(&generated, id).count() > 0 && on(&generated, id).all(is_elastic));
    assert!(!on(&generated, "S2:C2-A2|C2-B2").any(is_elastic));
    let reason = generated.trace.iter().find(|r| r.subject == id).unwrap();
    assert_eq!((reason.rule.as_str(), reason.words.as_str()), (ANALYST, "propped"));
}

#[test]
fn what_is_decided_about_a_strip_of_a_rigid_floor_is_refused() {
    let id = "S2:C2-A1|C2-B1";
    let decided = Override { target: id.into(), action: OverrideAction::LatentHinge, reason: "worn".into() };
    let building = Building { overrides: vec![decided], ..reference(|t| t) };
    let (_, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Never, accuracy: Accuracy::Fast };
    let Err(refused) = generate(&building, &seed(), &mut store, wishes, &|_| {}) else {
        panic!("fast floors are one body")
    };
    let words = refused.to_string();
    assert!(words.contains(id) && words.contains("does not bend"), "{words}");
}

#[test]
fn strips_and_wall_ends_are_targets_by_name_and_by_pattern() {
    let chapter = |targets: &str, action: &str| {
        format!(
            "[[overrides]]\ntargets = [{targets}]\naction = \"{action}\"\nreason = \"a test\"\n\n[settings]"
        )
    };
    let building = reference(|t| t.replace("[settings]", &chapter("\"S1:*\"", "elastic_connection")));
    assert_eq!(building.overrides.len(), 4);
    let text = include_str!("../../buildings/six-storey.toml");
    let with = |targets: &str, action: &str| {
        parse(&text.replace("[settings]", &chapter(targets, action)), Format::Toml, "six.toml")
    };
    let walls = with("\"W1-a.*\"", "elastic_connection").unwrap();
    let names: Vec<&str> = walls.overrides.iter().map(|o| o.target.as_str()).collect();
    assert_eq!(names, ["W1-a.bottom", "W1-a.top"]);
    // a pattern about hinges means columns, whatever else has a foot
    assert!(with("\"*2-*.bottom\"", "hinge").unwrap().overrides.iter().all(|o| o.target.starts_with('C')));
    let error = with("\"W1-a.bottom\"", "hinge").unwrap_err();
    assert!(format!("{error:?}").contains("latent_hinge"), "{error:?}");
}

#[test]
fn walls_yield_at_foot_and_head_or_not() {
    let text = include_str!("../../buildings/six-storey.toml");
    let building = parse(text, Format::Toml, "six-storey.toml").unwrap();
    let (_, mut store, _cache) = knowledge();
    let wishes = Wishes { derive: Derive::Similar, accuracy: Accuracy::Fast };
    let rules = with_rule("wall_end", "line.position == 'top'");
    let generated = generate(&building, &rules, &mut store, wishes, &|_| {}).unwrap();
    generated.model.check().expect("a sound model");
    let wall = building.members.iter().find(|m| m.kind.name() == "wall").unwrap();
    let [foot, head] = ["bottom", "top"].map(|end| format!("{}.{end}", wall.id));
    assert_eq!((on(&generated, &foot).count(), on(&generated, &head).count()), (2, 2));
    assert!(!on(&generated, &foot).any(is_elastic) && on(&generated, &head).all(is_elastic));
}

#[test]
fn features_of_strips_tell_beams_charges_and_what_the_slab_bridges() {
    let known = Known::of_building(&reference(|t| t));
    let line = |id: &str| known.lines.iter().find(|s| s.id == id).unwrap();
    let [front, side, rear] = ["S1:C1-A1|C1-B1", "S1:C1-A1|C1-A2", "S1:C1-A2|C1-B2"].map(line);
    let flag = |s: &Subject, name: &str| s.features.get(name) == Some(&Value::Flag(true));
    for strip in [front, side, rear] {
        assert_eq!(strip.kind, SubjectKind::SlabLine);
        assert!(flag(strip, "line.has_beam"), "{}", strip.id);
    }
    assert!(
        flag(front, "line.over_charge") && flag(side, "line.over_charge") && !flag(rear, "line.over_charge")
    );
    // both columns of the front are taken away: nothing in the row holds it
    assert_eq!(front.number("line.demand_ratio"), None);
    // w l² / 8 over σ t² / 4 of the rear strip, by hand from the file: 2,500 kg/m³, 0.25 m, 5.4 m clear, 10.5 MPa
    let clear_m = rear.number("line.length").unwrap();
    let by_hand =
        |span_m: f64, t_m: f64| 2500.0 * 9.81 * t_m * span_m.powi(2) / 8.0 / (10.5e6 * t_m.powi(2) / 4.0);
    let t_m = clear_m / rear.number("line.slenderness").unwrap();
    let ratio = rear.number("line.demand_ratio").unwrap();
    assert!((ratio / by_hand(clear_m, t_m) - 1.0).abs() < 0.05, "{ratio} {}", by_hand(clear_m, t_m));
    // the side hangs over the rear column: as a span of twice its length, and what is beyond it
    assert!(side.number("line.demand_ratio").unwrap() > 2.0 * ratio);
}

#[test]
fn beams_belong_to_the_strips_of_their_own_floor() {
    let mut building = reference(|t| t);
    building.members.retain(|m| !m.id.starts_with("B2-"));
    let known = Known::of_building(&building);
    for (floor, has_beam) in [("S1:", true), ("S2:", false), ("S3:", true)] {
        let strips: Vec<&Subject> = known.lines.iter().filter(|s| s.id.starts_with(floor)).collect();
        assert_eq!(strips.len(), 4);
        for strip in strips {
            assert_eq!(strip.features.get("line.has_beam"), Some(&Value::Flag(has_beam)), "{}", strip.id);
            assert_eq!(strip.number("line.beam_demand_ratio").is_some(), has_beam, "{}", strip.id);
        }
    }
}

#[test]
fn what_a_floor_is_and_what_its_strips_do_may_exclude_each_other() {
    let chapter = "[[overrides]]\ntargets = [\"S1\"]\naction = \"merge_rigid\"\nreason = \"stiff\"\n\n[[overrides]]\ntargets = [\"S1:*\"]\naction = \"latent_hinge\"\nreason = \"worn\"\n\n[settings]";
    let text = EXAMPLE.replace("[settings]", chapter);
    let error = parse(&text, Format::Toml, "reference").unwrap_err();
    let words = error.render(false);
    assert!(words.contains("contradiction") && words.contains("does not bend in strips"), "{words}");
    assert!(parse(&text.replace("\"S1\"", "\"S2\""), Format::Toml, "reference").is_ok());
}
