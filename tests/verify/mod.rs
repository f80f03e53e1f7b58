//! The short form of the verification manual, as CI runs it.

use serde_json::Value;
use std::process::{Command, Output};

fn fallwerk(arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_fallwerk")).args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

#[test]
fn short_form_passes_and_has_its_fields() {
    short_form("fe", 60);
}

#[test]
fn short_form_of_reinforced_concrete_passes() {
    short_form("rc", 150);
}

#[test]
fn short_form_of_multibody_systems_passes() {
    short_form("mbs", 30);
}

fn short_form(solver: &str, least: usize) {
    let (code, out, err) = fallwerk(&["verify", solver, "--short", "--json"]);
    let list: Vec<Value> = serde_json::from_str(&out).unwrap();
    let failed: Vec<&Value> = list.iter().filter(|f| f["pass"] != true).collect();
    assert!(code == 0 && failed.is_empty(), "{failed:#?}\n{err}");
    assert!(list.len() > least, "{} figures", list.len());
    for figure in &list {
        for text in ["case", "quantity", "unit", "tolerance_kind", "source"] {
            assert!(figure[text].as_str().is_some_and(|t| !t.is_empty()), "{text}: {figure}");
        }
        for number in ["reference", "ours", "tolerance"] {
            assert!(figure[number].is_number(), "{number}: {figure}");
        }
        assert!(["relative", "absolute"].contains(&figure["tolerance_kind"].as_str().unwrap()));
    }
}

#[test]
fn unknown_cases_are_bad_usage() {
    let (code, out, err) = fallwerk(&["verify", "fe", "--case", "nonsense"]);
    assert!(code == 2 && out.is_empty() && err.contains("patch-test"), "{err}");
}

/// The checked-in manuals have every case.
#[test]
fn manuals_name_every_case() {
    let pages = [
        ("fe", include_str!("../../docs/verification-fe.md")),
        ("rc", include_str!("../../docs/verification-rc.md")),
        ("mbs", include_str!("../../docs/verification-mbs.md")),
    ];
    for (solver, page) in pages {
        let (_, list, _) = fallwerk(&["verify", solver, "--list"]);
        for name in list.lines().filter_map(|l| l.split_whitespace().next()) {
            assert!(page.contains(&format!("\n## {name}")), "docs/verification-{solver}.md lacks {name}");
        }
    }
}
