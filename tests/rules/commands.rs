//! `fallwerk rules …`: output and exit codes.

use super::rule;
use clap::Parser;
use fallwerk::cli::rules::{RulesArgs, execute};
use std::fs;
use std::path::Path;

#[derive(Parser)]
struct Program {
    #[command(flatten)]
    args: RulesArgs,
}

fn fallwerk(rules: &Path, words: &[&str]) -> (u8, String, String) {
    let all = ["rules", "--rules", rules.to_str().unwrap()].into_iter().chain(words.iter().copied());
    let program = Program::try_parse_from(all).unwrap();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = execute(&program.args, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

#[test]
fn the_rules_of_the_repository_pass_their_check() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("rules");
    let (code, out, err) = fallwerk(&folder, &["check"]);
    assert!(code == 0 && out.contains("no conflict, no gap"), "{out}{err}");
    let (code, out, _) = fallwerk(&folder, &["list", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(code == 0 && value["rules"].as_array().unwrap().len() > 15);
    let (code, out, _) = fallwerk(&folder, &["show", "seed/column-end-hinge"]);
    assert!(code == 0 && out.contains("hinges.toml:5") && out.contains("section 3.4"), "{out}");
    let (code, _, err) = fallwerk(&folder, &["show", "seed/colum-end-hinge"]);
    assert!(code == 2 && err.contains("did you mean `seed/column-end-hinge`?"), "{err}");
    let (code, out, _) = fallwerk(&folder, &["show", "seed/colum-end-hinge", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    let told = value["diagnostics"][0]["message"].as_str().unwrap();
    assert!(code == 2 && told.starts_with("no rule `seed/colum-end-hinge`"), "{out}");
    let (code, out, _) = fallwerk(&folder, &["features"]);
    assert!(code == 0 && out.contains("critical_strain_rate"));
}

/// A comparison that its feature decides is told, though the rule can fire.
#[test]
fn comparisons_that_decide_nothing_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("rules/seed");
    for file in ["bodies.toml", "events.toml", "hinges.toml", "lines.toml", "springs.toml"] {
        fs::copy(seed.join(file), folder.path().join(file)).unwrap();
    }
    let when = "when = \"member.kind == 'wall' and (member.length >= 0 or member.storey_share > 2)\"";
    let priority = "priority = 1000";
    fs::write(folder.path().join("own.toml"), format!("schema = 1\n{}", rule("own", &[when, priority])))
        .unwrap();
    let (code, out, err) = fallwerk(folder.path(), &["check"]);
    let said = [
        "own.toml:3:6: the comparison `member.length >= 0` of `own` holds wherever it is known: `member.length` is at least 0",
        "the comparison `member.storey_share > 2` of `own` never holds: `member.storey_share` is from 0 to 1",
        "2 comparisons that decide nothing",
    ];
    assert!(code == 1 && said.iter().all(|words| out.contains(words)), "{out}{err}");
    let (code, out, _) = fallwerk(folder.path(), &["check", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(code == 1 && value["remarks"].as_array().unwrap().len() == 2, "{out}");
}

#[test]
fn problems_and_gaps_have_their_exit_codes() {
    let room = tempfile::tempdir().unwrap();
    fs::create_dir(room.path().join("sub")).unwrap();
    let file = room.path().join("sub/one.toml");
    fs::write(&file, format!("schema = 1\n{}", rule("a", &[]))).unwrap();
    let (code, out, _) = fallwerk(room.path(), &["check"]);
    assert!(
        code == 1 && out.contains("gap: no rule says how the member becomes bodies for a member of a beam"),
        "{out}"
    );
    fs::write(&file, format!("schema = 1\n{}", rule("a", &["action = \"fly\""]))).unwrap();
    let (code, _, err) = fallwerk(room.path(), &["check"]);
    assert!(
        code == 1 && err.contains("sub/one.toml:7:10: unknown action `fly`") && err.ends_with("1 problem\n"),
        "{err}"
    );
    assert_eq!(fallwerk(room.path(), &["list"]).0, 2);
    let (code, out, _) = fallwerk(room.path(), &["check", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(code == 1 && value["problems"][0].as_str().unwrap().contains("unknown action"));
    // what cannot be read at all is no check that failed
    fs::write(&file, "schema = ").unwrap();
    let (code, _, err) = fallwerk(room.path(), &["check"]);
    assert!(code == 2 && err.contains("sub/one.toml:1:"), "{err}");
    let absent = room.path().join("absent");
    let (code, _, err) = fallwerk(&absent, &["check"]);
    assert!(code == 2 && err.contains(absent.to_str().unwrap()), "{err}");
    assert_eq!(fallwerk(&absent, &["check", "--json"]).0, 2);
    let folder = absent.to_str().unwrap();
    for words in [&["list", "--json"][..], &["show", "a", "--json"], &["diff", folder, folder, "--json"]] {
        let (code, out, err) = fallwerk(&absent, words);
        let value: serde_json::Value = serde_json::from_str(&out).unwrap();
        let told = value["diagnostics"][0]["message"].as_str().unwrap();
        assert!(code == 2 && value["ok"] == false && told.contains(folder), "{words:?}: {out}");
        assert!(err.starts_with("error: ") && err.contains(told), "{words:?}: {err}");
    }
}

/// Without a folder the rules are those of the program, learned ones among them, as for `generate-mbs`.
#[test]
fn without_a_folder_the_rules_are_those_of_the_program() {
    let room = tempfile::tempdir().unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_fallwerk"));
    let done = command.args(["rules", "list"]).current_dir(room.path()).output().unwrap();
    let out = String::from_utf8(done.stdout).unwrap();
    assert!(out.contains("learned/") && out.contains("seed/"), "{out}");
}

/// A rule that no generated model carries out passes when it is loaded, and not the check.
#[test]
fn rules_that_cannot_be_carried_out_do_not_pass_the_check() {
    let folder = tempfile::tempdir().unwrap();
    let seed = Path::new(env!("CARGO_MANIFEST_DIR")).join("rules/seed");
    for file in ["bodies.toml", "events.toml", "hinges.toml", "lines.toml", "springs.toml"] {
        fs::copy(seed.join(file), folder.path().join(file)).unwrap();
    }
    let check = |lines: &[&str]| {
        let own = format!("schema = 1\n{}", rule("own", &[lines, &["priority = 1000"]].concat()));
        fs::write(folder.path().join("own.toml"), own).unwrap();
        let (code, out, err) = fallwerk(folder.path(), &["check"]);
        let (json_code, json, _) = fallwerk(folder.path(), &["check", "--json"]);
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((code, json_code), (code, code), "{err}");
        assert_eq!(json["problems"].as_array().unwrap().len(), usize::from(code), "{json}");
        (code, out)
    };
    let end = ["applies_to = \"member_end\"", "action = \"rigid_connection\""];
    let (code, out) = check(&end);
    let told = "own.toml:3:6: `own` may decide `rigid_connection` for a member_end of a column, which no generated model carries out; write `hinge` or `elastic_connection`";
    assert!(code == 1 && out.contains(told), "{out}");
    assert!(
        out.contains("an override in the building file") && out.contains(": 1 rule that cannot be"),
        "{out}"
    );
    let parts = ["action = \"subdivide\"", "parameters = { pieces = 3 }"];
    let (code, out) = check(&parts);
    assert!(code == 1 && out.contains("ask for `collapse.phase == 'after_contact'`"), "{out}");
    let later = "when = \"member.kind == 'column' and collapse.phase == 'after_contact'\"";
    assert_eq!(check(&[parts[0], parts[1], later]).0, 0);
    // no generated model knows it, so that the rule does not fire there
    let rate = "when = \"member.kind == 'column' and member.strain_rate > 0.5\"";
    assert_eq!(check(&[parts[0], parts[1], rate]).0, 0);
    let removes = "action = \"remove_body\"";
    let (code, out) = check(&[removes, "when = \"member.storey == 2\""]);
    assert!(code == 1 && out.contains("for a member of a column without a charge"), "{out}");
    assert_eq!(check(&[removes, "when = \"member.storey == 2 and member.charged\""]).0, 0);
    let (code, out) = check(&["when = \"member.kind in ['wall', 'beam']\""]);
    assert!(code == 1 && out.contains("`rigid_body` for a member of a beam"), "{out}");
    assert_eq!(check(&["when = \"member.kind in ['wall', 'footing']\""]).0, 0);
}

/// What is learned goes beside the rules that are named, and is told as JSON where that is asked for.
#[test]
fn learning_writes_into_the_folder_of_rules_that_is_named() {
    let room = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (kb, rules) = (room.path().join("kb"), room.path().join("rules"));
    fs::create_dir(&kb).unwrap();
    fs::copy(root.join("kb/studies/s1-001.json"), kb.join("s1-001.json")).unwrap();
    let plan = root.join("kb/plan");
    let [kb, plan] = [&kb, &plan].map(|path| path.to_str().unwrap());
    let learn = ["learn", "--kb", kb, "--plan", plan, "--json"];
    let (code, out, err) = fallwerk(&rules, &learn);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    let told = value["diagnostics"][0]["message"].as_str().unwrap();
    assert!(code == 2 && told.contains("rules is not a folder") && err.starts_with("error: "), "{out}{err}");
    assert!(!rules.exists());
    fs::create_dir(&rules).unwrap();
    let (code, out, err) = fallwerk(&rules, &learn);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &value["studies"]), (0, &1.into()), "{out}{err}");
    assert_eq!(value["output"], rules.join("learned").to_str().unwrap());
    assert!(rules.join("learned/report.md").is_file(), "{out}");
}
