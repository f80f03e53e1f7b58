//! Rules learned from studies: the tree on data of which the true rule is known, and the rules of the repository from its records.

use fallwerk::base::random::Random;
use fallwerk::cli::rules_learn::{LearnArgs, cases, difference, learned};
use fallwerk::learn::prune::{decided, validated};
use fallwerk::learn::tree::{Column, Count, Kind, Node, Row, Table};
use fallwerk::learn::{file_names, learn};
use fallwerk::rules::{Action, Aspect, RuleBase, Source, Subject, SubjectKind};
use std::fs;
use std::path::{Path, PathBuf};

/// Places of some buildings with three features, of which the first two matter: what is true of a place is told.
fn table(buildings: usize, places: usize, noise: f64, truth: impl Fn([f64; 3]) -> bool) -> Table {
    let column = |feature, more| Column { feature, kind: Kind::Number, more };
    let columns = vec![column("demand", Some(true)), column("share", None), column("chaff", None)];
    let mut dice = Random::of(3);
    let mut rows = Vec::new();
    for building in 0..buildings {
        for place in 0..places {
            let values = [4.0 * dice.share(), dice.share(), dice.share()];
            let yes = truth(values) != (dice.share() < noise);
            let values = values.map(|x| Some((1e3 * x).round() / 1e3)).to_vec();
            rows.push(Row { building, place: format!("P{place}"), values, yes, held: false });
        }
    }
    Table { columns, rows }
}

fn splits(node: &Node) -> Vec<(usize, f64)> {
    node.split
        .as_ref()
        .map_or(Vec::new(), |s| [vec![(s.column, s.threshold)], splits(&s.low), splits(&s.high)].concat())
}

#[test]
fn a_true_rule_is_found_with_its_thresholds() {
    let learned = validated(&table(12, 80, 0.0, |[demand, share, _]| demand > 2.0 && share > 0.5));
    let found = splits(&learned.tree);
    let near = |column: usize, at: f64| found.iter().any(|(c, t)| *c == column && (t - at).abs() < 0.05);
    assert!(found.len() == 2 && near(0, 2.0) && near(1, 0.5), "{found:?}");
    assert!(learned.cost() < 0.03 && learned.brier() < 0.03, "{} {}", learned.cost(), learned.brier());
    assert!(learned.held_cost() > 0.8, "a yes in four, all missed by the rules in place");
}

#[test]
fn noise_is_pruned_away_and_its_share_is_told() {
    let learned = validated(&table(16, 40, 0.1, |[demand, ..]| demand > 2.0));
    let found = splits(&learned.tree);
    assert!(found.len() == 1 && found[0].0 == 0 && (found[0].1 - 2.0).abs() < 0.1, "{found:?}");
    let leaves: Vec<f64> = learned.tree.leaves().iter().map(|leaf| leaf.count.probability()).collect();
    assert!((0.1..0.2).contains(&leaves[0]) && (0.8..0.9).contains(&leaves[1]), "{leaves:?}");
    // no feature matters: one leaf
    let learned = validated(&table(16, 40, 0.1, |_| false));
    assert_eq!(splits(&learned.tree), []);
}

#[test]
fn a_miss_costs_more_than_a_false_alarm() {
    // three in ten are a yes above the threshold: still worth a yes
    let mut dice = Random::of(5);
    let mut table = table(20, 40, 0.0, |_| false);
    for row in &mut table.rows {
        row.yes = row.values[0] > Some(2.0) && dice.share() < 0.3;
    }
    let learned = validated(&table);
    let answers: Vec<Option<bool>> = learned.tree.leaves().iter().map(|l| l.count.answer()).collect();
    assert_eq!(answers, [Some(false), Some(true)]);
    assert!(learned.cost() < learned.held_cost());
}

#[test]
fn many_places_of_few_buildings_are_thin() {
    let learned = validated(&table(4, 500, 0.0, |[demand, ..]| demand > 2.0));
    assert!(learned.tree.leaves().iter().all(|leaf| leaf.count.answer().is_none()));
    assert_eq!((learned.open, learned.predictions.len()), (2000, 0));
    // the same in six buildings, of which but two have a yes
    let mut table = table(6, 100, 0.0, |[demand, ..]| demand > 2.0);
    table.rows.iter_mut().filter(|row| row.building > 1).for_each(|row| row.yes = false);
    let leaves = validated(&table).tree.leaves().into_iter().map(|l| l.count.answer()).collect::<Vec<_>>();
    assert!(!leaves.contains(&Some(true)), "{leaves:?}");
}

#[test]
fn places_of_one_building_are_judged_without_it() {
    // a feature that names the building tells its places apart, and is worth nothing in others
    let mut table = table(12, 30, 0.0, |_| false);
    for row in &mut table.rows {
        row.yes = row.building % 2 == 0;
        row.values[2] = Some((row.building * 7 % 12) as f64);
    }
    let learned = validated(&table);
    assert!(learned.cost() > 0.3, "{}", learned.cost());
}

#[test]
fn what_contradicts_mechanics_is_not_learned_but_kept_for_review() {
    let learned = validated(&table(12, 40, 0.0, |[demand, ..]| demand < 2.0));
    assert_eq!(splits(&learned.tree).iter().filter(|(column, _)| *column == 0).count(), 0);
    let refused = learned.tree.refused.as_ref().unwrap();
    assert!(
        refused.column == 0 && (refused.threshold - 2.0).abs() < 0.05 && refused.saves(&learned.tree) > 1.0
    );
}

#[test]
fn about_places_that_know_too_little_or_lie_outside_the_rules_in_place_decide() {
    let table = table(12, 40, 0.0, |[demand, ..]| demand > 2.0);
    let learned = validated(&table);
    let row =
        |demand: Option<f64>| Row { values: vec![demand, Some(0.5), Some(0.5)], ..table.rows[0].clone() };
    let answer = |demand| decided(&table, &learned.tree, &row(demand)).map(|(_, answer)| answer);
    assert_eq!([answer(Some(1.0)), answer(Some(3.0))], [Some(false), Some(true)]);
    assert_eq!([answer(None), answer(Some(9.0))], [None, None]);
}

#[test]
fn probabilities_are_means_over_buildings_after_laplace() {
    let row = |building, yes| Row { building, place: String::new(), values: Vec::new(), yes, held: false };
    let rows: Vec<Row> = (0..100).map(|_| row(0, true)).chain((1..5).map(|b| row(b, false))).collect();
    assert_eq!(Count::of(rows.iter()).probability(), 2.0 / 7.0);
}

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn arguments(kb: PathBuf, output: &Path) -> LearnArgs {
    LearnArgs {
        kb,
        plan: vec![root("kb/plan"), root("kb/irregular"), root("buildings")],
        output: Some(output.to_path_buf()),
    }
}

fn read(folder: &Path) -> Vec<(String, String)> {
    let text = |name: String| Some((fs::read_to_string(folder.join(&name)).ok()?, name)).map(|(t, n)| (n, t));
    file_names().into_iter().filter_map(text).collect()
}

#[test]
fn the_rules_of_the_repository_come_out_of_its_studies_to_the_byte() {
    let room = tempfile::tempdir().unwrap();
    learned(&arguments(root("kb/studies"), room.path()), None).unwrap();
    let again = read(room.path());
    assert!(again.len() > 3);
    assert_eq!(again, read(&root("rules/learned")));
    let listed = fs::read_dir(root("rules/learned")).unwrap().count();
    assert_eq!(listed, again.len(), "files in rules/learned that learning does not write");
    // with one thread as well
    let studies =
        cases(&root("kb/studies"), &[root("kb/plan"), root("kb/irregular"), root("buildings")]).unwrap();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = pool.install(|| learn(&studies, &RuleBase::seed().unwrap())).unwrap();
    let mut files = alone.files;
    files.sort();
    let mut again = again;
    again.sort();
    assert_eq!(files, again);
}

#[test]
fn a_study_that_is_gone_changes_only_what_rested_on_it() {
    let room = tempfile::tempdir().unwrap();
    let (kb, out) = (room.path().join("kb"), room.path().join("out"));
    fs::create_dir(&kb).unwrap();
    // a flat slab: it has no beams
    let gone = "s1-004.json";
    for entry in fs::read_dir(root("kb/studies")).unwrap() {
        let entry = entry.unwrap();
        if entry.file_name() != gone {
            fs::copy(entry.path(), kb.join(entry.file_name())).unwrap();
        }
    }
    learned(&arguments(kb, &out), None).unwrap();
    let rules = |folder: &Path| {
        let sources: Vec<Source> = RuleBase::sources(folder).unwrap();
        RuleBase::seed().unwrap().with(sources).unwrap()
    };
    let (old, new) = (rules(&root("rules/learned")), rules(&out));
    let (changes, text) = difference(&old, &new);
    assert!(!changes.is_empty() && text.contains("evidence without s1-004"), "{text}");
    assert!(!text.contains("learned/beam-ends"), "{text}");
    for file in ["beam-ends.toml", "beam-ends-late.toml"] {
        let text = |folder: &Path| fs::read_to_string(folder.join(file)).ok();
        assert_eq!(text(&out), text(&root("rules/learned")), "{file}");
    }
}

#[test]
fn a_record_of_another_building_is_refused_by_name() {
    let room = tempfile::tempdir().unwrap();
    fs::copy(root("kb/studies/s1-001.json"), room.path().join("s1-001.json")).unwrap();
    let told = |plan: PathBuf| {
        let arguments =
            LearnArgs { plan: vec![plan], ..arguments(room.path().into(), &room.path().join("out")) };
        learned(&arguments, None).unwrap_err().message
    };
    let absent = told(root("buildings"));
    assert!(absent.contains("no s1-001.toml"), "{absent}");
    // the folders named take the place of those by default, which the advice keeps
    let advice = format!("--plan {} --plan DIR", root("buildings").display());
    assert!(absent.contains(&advice), "{absent}");
    let text = fs::read_to_string(root("kb/plan/s1-001.toml")).unwrap();
    fs::write(room.path().join("s1-001.toml"), text.replace("end_time = ", "end_time = 1")).unwrap();
    assert!(told(room.path().into()).contains("is of another input"), "{}", told(room.path().into()));
}

const SEED: &str = r#"
schema = 1
[[rule]]
id = "seed/whole"
words = "A slab is rigid."
applies_to = "member"
when = "member.kind == 'slab'"
action = "merge_rigid"
parameters = { with = "storey_floor" }
priority = 10
source = "a test"
"#;
const LEARNED: &str = r#"
schema = 1
[[rule]]
id = "learned/bends"
words = "A slab bends."
applies_to = "member"
when = "member.kind == 'slab' and building.demand_ratio <= 2"
action = "merge_elastic"
parameters = { with = "storey_floor" }
priority = 5
source = "a test"
supersedes = ["seed/whole"]
statistics = { buildings = 9, places = 30, right = 29, coverage = 0.5, confidence = 0.9 }
range = { "building.demand_ratio" = [0.2, 1.5] }
evidence = ["a", "b"]
counter_examples = ["a:S1"]
"#;

fn base(learned: &str) -> Result<RuleBase, String> {
    let source = |name: &str, text: &str| Source { name: name.into(), text: text.into() };
    RuleBase::from_sources(vec![source("seed.toml", SEED), source("learned.toml", learned)])
        .map_err(|problems| problems.to_string())
}

#[test]
fn a_learned_rule_decides_within_its_range_only_and_tells_how_sure_it_is() {
    let rules = base(LEARNED).unwrap();
    let decision = |ratio: f64| {
        let slab = Subject::new(SubjectKind::Member, "S").with("member.kind", "slab");
        let trace = rules.trace(&slab.with("building.demand_ratio", ratio)).unwrap();
        assert!(trace.standing().all(|f| f.overruled_by.is_none()));
        trace.decision(Aspect::Body).map(|f| (f.action, f.confidence)).unwrap()
    };
    assert_eq!(decision(1.0), (Action::MergeElastic, Some(0.9)));
    assert_eq!(decision(1.9), (Action::MergeRigid, None));
    let wrong = base(&LEARNED.replace("right = 29", "right = 31")).unwrap_err();
    assert!(wrong.contains("right at 31 of 30 places"), "{wrong}");
    let wrong = base(&LEARNED.replace("confidence = 0.9", "confidence = 1.9")).unwrap_err();
    assert!(wrong.contains("lie between 0 and 1"), "{wrong}");
}

#[test]
fn differences_name_rules_thresholds_and_evidence() {
    let old = base(LEARNED).unwrap();
    let new = LEARNED.replace("<= 2", "<= 1.8").replace("[\"a\", \"b\"]", "[\"b\", \"c\"]");
    let (_, text) = difference(&old, &base(&new).unwrap());
    for part in [
        "~ learned/bends",
        "- member.kind == 'slab' and building.demand_ratio <= 2\n",
        "+ member.kind == 'slab' and building.demand_ratio <= 1.8\n",
        "evidence without a with c",
        "0 added, 0 removed, 1 changed",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    let (_, text) = difference(&old, &old.without("learned/"));
    assert!(text.contains("- learned/bends: merge_elastic") && text.contains("1 removed"), "{text}");
    assert_eq!(difference(&old, &old).0, []);
}
