//! The commands as a user runs them: what they refuse, what they leave behind.

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

pub(super) fn fallwerk(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_fallwerk")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

pub(super) fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A folder with the reference building in it, `building.toml`, changed by `edit`.
pub(super) fn room(edit: impl Fn(&str) -> String) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("building.toml"), edit(fallwerk::building::EXAMPLE)).unwrap();
    folder
}

#[test]
fn bad_input_ends_with_2_and_leaves_nothing() {
    let room = room(|text| text.replacen("= \"", "= \"nonsense ", 400));
    fs::create_dir(room.path().join("empty")).unwrap();
    let before = names(room.path());
    for verb in ["generate-mbs", "fe"] {
        let (code, out, err) = fallwerk(room.path(), &[verb, "missing.toml", "-o", "out/x"]);
        assert_eq!((code, out.as_str()), (2, ""), "{verb}");
        assert!(err.contains("missing.toml"), "{err}");
        let (code, out, err) = fallwerk(room.path(), &[verb, "building.toml", "--json"]);
        assert_eq!(code, 2, "{verb}: {err}");
        assert!(err.contains("building.toml:"), "the place is named: {err}");
        let json: Value = serde_json::from_str(&out).unwrap();
        assert_eq!(json["ok"], false);
        assert!(!json["diagnostics"].as_array().unwrap().is_empty());
        assert_eq!(fallwerk(room.path(), &[verb, "building.toml", "--threads", "0"]).0, 2);
    }
    assert_eq!(names(room.path()), before);
}

#[test]
fn a_missing_library_or_an_empty_one_is_named() {
    let room = room(str::to_string);
    fs::create_dir(room.path().join("empty")).unwrap();
    let (code, _, err) =
        fallwerk(room.path(), &["generate-mbs", "building.toml", "--library", "typo", "-o", "run"]);
    assert_eq!(code, 2);
    assert!(err.contains("--library") && err.contains("typo"), "{err}");
    let (code, _, err) =
        fallwerk(room.path(), &["generate-mbs", "building.toml", "--library", "empty", "-o", "run"]);
    assert_eq!(code, 2);
    assert!(err.contains("no entry") && err.contains("--derive") && err.contains("C1-A1.bottom"), "{err}");
    let (code, _, err) =
        fallwerk(room.path(), &["generate-mbs", "building.toml", "--rules", "typo", "-o", "run"]);
    assert_eq!(code, 2);
    assert!(err.contains("--rules") && err.contains("typo"), "{err}");
    assert_eq!(names(room.path()), ["building.toml", "empty"]);
}

#[test]
fn a_foreign_folder_is_refused_before_any_work() {
    let room = room(str::to_string);
    let thesis = room.path().join("thesis");
    fs::create_dir(&thesis).unwrap();
    fs::write(thesis.join("chapter.txt"), "years of work").unwrap();
    for verb in ["generate-mbs", "fe"] {
        let (code, _, err) = fallwerk(room.path(), &[verb, "building.toml", "-o", "thesis"]);
        assert_eq!(code, 2);
        assert!(err.contains("thesis") && err.contains("not a result folder"), "{err}");
        assert_eq!(fallwerk(room.path(), &[verb, "building.toml", "-o", "building.toml"]).0, 2);
    }
    let (code, _, _) = fallwerk(room.path(), &["generate-mbs", "building.toml", "-o", "thesis", "--force"]);
    assert_eq!(code, 2, "--force is no licence to delete what is not ours");
    assert_eq!(names(&thesis), ["chapter.txt"]);
    assert_eq!(names(room.path()), ["building.toml", "thesis"]);
}

#[test]
fn a_quick_run_does_not_replace_a_validation_unasked() {
    let room = room(str::to_string);
    let results = room.path().join("results");
    fs::create_dir(&results).unwrap();
    fs::write(results.join(fallwerk::base::output::MARKER), "").unwrap();
    fs::write(results.join("validation.json"), "{}").unwrap();
    fs::create_dir(room.path().join("empty")).unwrap();
    let quick = ["generate-mbs", "building.toml", "-o", "results", "--library", "empty"];
    let (code, _, err) = fallwerk(room.path(), &quick);
    assert_eq!(code, 2);
    assert!(err.contains("--validate") && err.contains("--force"), "{err}");
    let (_, _, err) = fallwerk(room.path(), &[&quick[..], &["--force"]].concat());
    assert!(err.contains("no entry"), "with --force the next obstacle is met: {err}");
    assert!(results.join("validation.json").exists(), "a run that fails replaces nothing");
    // nor do commands that compute something else
    fs::write(room.path().join("section.toml"), fallwerk::rc::section_file::EXAMPLE).unwrap();
    for other in [
        &["verify", "mbs", "--models", "results"][..],
        &["rc", "section.toml", "-o", "results"],
        &["rc", "section.toml", "--load", "crush", "-o", "results"],
        &["fe", "building.toml", "-o", "results"],
    ] {
        let (code, _, err) = fallwerk(room.path(), other);
        assert_eq!(code, 2, "{other:?}: {err}");
        assert!(err.contains("results: holds the results of a run with --validate"), "{err}");
    }
    assert_eq!(names(&results), [fallwerk::base::output::MARKER, "validation.json"]);
    let models = ["verify", "mbs", "--models", "models"];
    assert_eq!([0; 2].map(|_| fallwerk(room.path(), &models).0), [0; 2], "its own are replaced");
    let (code, _, err) = fallwerk(room.path(), &[&quick[..3], &["models", "--force"]].concat());
    assert!(code == 2 && err.contains("models: holds the models of verify mbs"), "{err}");
}

#[test]
fn a_step_above_the_stability_limit_is_bad_input() {
    let room = room(str::to_string);
    let (code, _, err) = fallwerk(
        room.path(),
        &["generate-mbs", "building.toml", "--accuracy", "fast", "--step", "1", "-o", "run"],
    );
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("--step") && err.contains("stability limit"), "{err}");
    assert_eq!(names(room.path()), ["building.toml"]);
}

#[test]
fn fe_limits_what_the_command_line_may_ask() {
    let room = room(str::to_string);
    for bad in [
        ["--mesh-size", "0"],
        ["--mesh-size", "nan"],
        ["--mesh-size", "0.001"],
        ["--mesh-size", "50"],
        ["--end-time", "-1"],
        ["--end-time", "1e9"],
    ] {
        let (code, out, err) =
            fallwerk(room.path(), &[&["fe", "building.toml", "-o", "run"], &bad[..]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{bad:?}: {err}");
        assert!(err.contains(bad[0]), "{bad:?}: {err}");
    }
    assert_eq!(names(room.path()), ["building.toml"]);
}

#[test]
fn fe_leaves_whole_results_that_do_not_depend_on_threads() {
    let room = room(str::to_string);
    let run = |threads: &str, folder: &str| {
        let arguments =
            ["fe", "building.toml", "--end-time", "0.02", "--threads", threads, "-o", folder, "--json"];
        let (code, out, err) = fallwerk(room.path(), &arguments);
        assert_eq!(code, 0, "{err}");
        serde_json::from_str::<Value>(&out).unwrap()
    };
    let summary = run("1", "one");
    run("2", "two");
    assert_eq!(summary["collapsed"], false, "nothing falls a metre in 20 ms");
    assert!(summary["elements"].as_u64().unwrap() > 100);
    let (one, two) = (room.path().join("one"), room.path().join("two"));
    assert_eq!(
        names(&one),
        [
            fallwerk::base::output::MARKER,
            "fe-displacements.csv",
            "fe-energies.csv",
            "fe-events.csv",
            "fe.json"
        ]
    );
    for file in names(&one) {
        assert!(fs::read(one.join(&file)).unwrap() == fs::read(two.join(&file)).unwrap(), "{file} differs");
    }
    let record: Value = serde_json::from_str(&fs::read_to_string(one.join("fe.json")).unwrap()).unwrap();
    let times = record["times_s"].as_array().unwrap().len();
    assert_eq!(times, 3);
    for point in record["tracked"].as_array().unwrap() {
        assert_eq!(point["displacement_m"].as_array().unwrap().len(), times);
    }
    assert_eq!(record["energies"].as_array().unwrap().len(), times);
    let csv = fs::read_to_string(one.join("fe-displacements.csv")).unwrap();
    let columns: Vec<usize> = csv.lines().map(|line| line.split(',').count()).collect();
    assert_eq!(columns, vec![1 + 3 * record["tracked"].as_array().unwrap().len(); 1 + times]);
    assert!(!record.to_string().contains("cpu_s") && !record.to_string().contains("wall_s"));
}

/// A model of a slab on a column with the reasons beside it.
fn write_model(folder: &Path, with_trace: bool) {
    let body = |id: &str, height: f64, members: &[&str]| {
        serde_json::json!({
            "id": id, "mass_kg": 1000.0, "position_m": [0.0, 0.0, height],
            "inertia_kg_m2": [[100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]],
            "origin": { "members": members, "rules": ["some-rule"], "entries": [] },
        })
    };
    let elastic = serde_json::json!({ "kind": "elastic", "stiffness_nm_rad": 1e8 });
    let model = serde_json::json!({
        "schema": "fallwerk-mbs/2", "name": "table", "gravity_m_s2": [0.0, 0.0, -9.81],
        "bodies": [body("C1", 1.5, &["C1"]), body("S1", 3.1, &["S1", "B1-x"])],
        "bushings": [{
            "id": "C1.top", "body_a": "S1", "body_b": "C1", "point_m": [0.0, 0.0, 3.0],
            "axes": [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]],
            "axial_stiffness_n_m": 1e9, "shear_stiffness_n_m": [1e9, 1e9], "torsional_stiffness_nm_rad": 1e8,
            "bending": [elastic, elastic],
            "origin": { "members": ["C1.top"], "rules": ["hinge-rule"], "entries": [] },
        }],
    });
    fs::write(folder.join("model.json"), model.to_string()).unwrap();
    let trace = serde_json::json!({
        "schema": 1, "building": "table", "building_hash": "", "program_version": "0", "entries": {}, "notes": [],
        "reasons": [{
            "part": "C1.top", "subject": "C1.top", "rule": "hinge-rule", "action": "hinge",
            "words": "columns turn at their ends", "in_range": false, "entries": [],
        }],
    });
    if with_trace {
        fs::write(folder.join("trace.json"), trace.to_string()).unwrap();
    }
}

#[test]
fn simulate_replaces_its_own_results_only() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_model(folder.path(), false);
    let run = |target: &str| fallwerk(folder.path(), &["simulate", "model.json", "-o", target]);
    for _ in 0..2 {
        let (code, _, err) = run("out/run");
        assert_eq!((code, err.as_str()), (0, ""));
    }
    let files = [".fallwerk-output", "displacements.csv", "energies.csv", "hinges.csv", "result.json"];
    assert_eq!(names(&path("out/run")), files);
    assert_eq!(names(&path("out")), ["run"]);

    fs::create_dir(path("thesis")).unwrap();
    fs::write(path("thesis/chapter.txt"), "years of work").unwrap();
    // folders of this program that hold what a run of a model must not take away
    let kept =
        [("validated", "validation.json"), ("computed", "fe-displacements.csv"), ("generated", "model.json")];
    for (name, file) in kept {
        fs::create_dir(path(name)).unwrap();
        fs::write(path(name).join(fallwerk::base::output::MARKER), "").unwrap();
        fs::copy(path("model.json"), path(name).join(file)).unwrap();
    }
    for (target, model, words) in [
        ("thesis", "model.json", "not a result folder"),
        ("validated", "model.json", "--validate"),
        ("computed", "model.json", "results of fe"),
        ("generated", "generated/model.json", "holds the model"),
        ("model.json", "model.json", "not a folder"),
    ] {
        let (code, _, err) = fallwerk(folder.path(), &["simulate", model, "-o", target]);
        assert_eq!(code, 2, "{err}");
        assert!(err.contains(target) && err.contains(words), "{err}");
    }
    assert_eq!(names(&path("thesis")), ["chapter.txt"]);
    assert_eq!(names(folder.path()), ["computed", "generated", "model.json", "out", "thesis", "validated"]);
}

/// What is wrong with a model file is bad input to all that read one, and a building file is told from a model.
#[test]
fn a_building_file_is_no_model() {
    let room = room(str::to_string);
    for command in [
        &["simulate", "building.toml"][..],
        &["explain", "building.toml", "C1-A1.top"],
        &["export", "building.toml", "--to", "json"],
    ] {
        let (code, out, err) = fallwerk(room.path(), command);
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(err.contains("building.toml: is TOML, as building files are"), "{err}");
    }
    write_model(room.path(), false);
    let model = fs::read_to_string(room.path().join("model.json")).unwrap();
    let mut model: Value = serde_json::from_str(&model).unwrap();
    model["settings"] = serde_json::json!({ "preload": true });
    model["joints"] = serde_json::json!([
        { "id": "pin", "kind": "fixed", "body_b": "C1", "point_m": [0.0, 0.0, 0.0] }
    ]);
    fs::write(room.path().join("model.json"), model.to_string()).unwrap();
    let (code, _, err) = fallwerk(room.path(), &["simulate", "model.json"]);
    assert_eq!(code, 2, "{err}");
    assert!(err.contains("settings.preload: is true"), "{err}");
}

#[test]
fn explain_names_members_rules_and_the_likely_meaning() {
    let folder = tempfile::tempdir().unwrap();
    write_model(folder.path(), true);
    let explain = |part: &str| fallwerk(folder.path(), &["explain", "model.json", part]);
    let (code, out, err) = explain("C1.top");
    assert_eq!((code, err.as_str()), (0, ""));
    for words in ["between S1 and C1", "hinge-rule -> hinge", "columns turn at their ends", "outside"] {
        assert!(out.contains(words), "{words}: {out}");
    }
    let (code, out, _) = explain("B1-x");
    assert_eq!(code, 0);
    assert!(out.starts_with("B1-x is part of S1\n") && out.contains("S1, B1-x"), "{out}");
    let (code, out, err) = explain("C1.topp");
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(err.contains("did you mean `C1.top`?"), "{err}");
    let (code, _, err) = explain("zzzzzzzzzz");
    assert_eq!(code, 2);
    assert!(!err.contains("did you mean") && err.contains("C1.top"), "{err}");

    write_model(folder.path(), false);
    fs::remove_file(folder.path().join("trace.json")).unwrap();
    let (code, out, _) = explain("C1.top");
    assert_eq!(code, 0);
    assert!(out.contains("hinge-rule") && out.contains("not in the rule base"), "{out}");
    fs::write(folder.path().join("trace.json"), "{\"schema\": 9").unwrap();
    let (code, _, err) = explain("C1.top");
    assert_eq!(code, 2);
    assert!(err.contains("trace.json"), "{err}");
}

#[test]
fn decisions_of_the_analyst_are_told_with_their_reasons() {
    let chapter = "[[overrides]]\ntargets = [\"S3\"]\naction = \"merge_rigid\"\nreason = \"roof truss\"\n\n\
                   [[overrides]]\ntargets = [\"C1-A2.bottom\"]\naction = \"elastic_connection\"\nreason = \"cased feet\"\n\n\
                   [[overrides]]\ntargets = [\"C2-A1.top\"]\naction = \"rigid_connection\"\nreason = \"haunched\"\n\n\
                   [settings]\nend_time = 0.1";
    let room = room(|text| text.replace("[settings]\nend_time = \"2.5 s\"", chapter));
    let (code, out, err) =
        fallwerk(room.path(), &["generate-mbs", "building.toml", "--accuracy", "fast", "-o", "run"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("override   C1-A2.bottom -> elastic_connection: cased feet (the rules would have said hinge (seed/clamped-foot-hinge)"), "{out}");
    let explain = |part: &str| {
        let (code, out, err) = fallwerk(room.path(), &["explain", "run/model.json", part]);
        assert_eq!(code, 0, "{err}");
        out
    };
    let foot = explain("C1-A2.bottom");
    assert!(
        foot.contains("analyst's override -> elastic_connection (the rules would have said")
            && foot.contains("cased feet"),
        "{foot}"
    );
    assert!(foot.contains("review: number"), "{foot}");
    let review: Value =
        serde_json::from_str(&fs::read_to_string(room.path().join("run/review.json")).unwrap()).unwrap();
    assert!(
        out.contains(&format!("review     {} decisions", review["items"].as_array().unwrap().len())),
        "{out}"
    );
    let top = explain("C2-A1.top");
    assert!(top.starts_with("C2-A1.top has no joint; it lies in S2\n"), "{top}");
    assert!(
        top.contains("C2-A1.top: analyst's override -> rigid_connection") && top.contains("haunched"),
        "{top}"
    );
    let strip = explain("S2:C2-A2|C2-B2");
    assert!(strip.starts_with("S2:C2-A2|C2-B2 has no joint; it lies in S2\n"), "{strip}");
    let strip = explain("S3:C3-A2|C3-B2");
    assert!(strip.contains("analyst's override -> merge_rigid") && strip.contains("roof truss"), "{strip}");
    let (code, _, err) = fallwerk(room.path(), &["explain", "run/model.json", "S2:C2-A2|C9-B2"]);
    assert!(code == 2 && err.contains("S2:C2-A2|C9-B2"), "{err}");
}

/// What rules about contacts and fractures say of a column, what is never asked of a floor, and what fired.
#[test]
fn explain_tells_the_rules_about_events_and_what_fired() {
    let room = room(str::to_string);
    let (code, out, err) = fallwerk(room.path(), &["generate-mbs", "building.toml", "-o", "run"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("rules about events that are not asked"), "{out}");
    let explain = |part: &str| {
        let (code, out, err) = fallwerk(room.path(), &["explain", "run/model.json", part]);
        assert_eq!(code, 0, "{err}");
        out
    };
    let rule = "in the run, if it meets the ground or an obstacle: rule seed/ground-contact-subsystem -> insert_subsystem";
    let column = explain("C2-A1");
    for words in [
        "C2-A1 is cut into C2-A1/1, C2-A1/2",
        "rule seed/subdivide-columns-late",
        "C2-A1.section-1 is latent",
        rule,
        "of the rules that answer one question the first",
        "rule seed/ground-contact-subsystem fires, and C2-A1.section-1 may give way from now on",
        "C2-A1.section-1 gives way",
    ] {
        assert!(column.contains(words), "{words}: {column}");
    }
    let tail =
        |text: &str| text.lines().filter(|l| l.starts_with("  run:")).map(str::to_string).collect::<Vec<_>>();
    assert_eq!(tail(&column), tail(&explain("C2-A1.section-1")), "of the section as of the column");
    assert!(explain("C1-A2").contains("C1-A2.section-1 stayed latent"));
    assert!(explain("C1-A1.top").contains("on C1-A1 takes away at 0 s: C1-A1"));
    let foot = explain("C1-A2.bottom");
    assert!(foot.contains("beyond the forces of the entry they are extended"), "{foot}");
    let model: Value =
        serde_json::from_str(&fs::read_to_string(room.path().join("run/model.json")).unwrap()).unwrap();
    let joint = model["bushings"].as_array().unwrap().iter().find(|b| b["id"] == "C1-A2.bottom").unwrap();
    let levels = &model["curves"][joint["bending"][0]["curve"].as_str().unwrap()]["levels"];
    let points = levels.as_array().unwrap().iter().flat_map(|l| l["capacity"].as_array().unwrap());
    let peak_nm = points.map(|p| p[1].as_f64().unwrap()).fold(0.0, f64::max);
    let (_, told) = foot.split_once("bears up to ").unwrap();
    let told_nm = 1e3 * told.split_once(' ').unwrap().0.parse::<f64>().unwrap();
    assert!(
        told_nm > 0.0 && told_nm < 0.99 * peak_nm,
        "not under forces that it bears no more: {told_nm}, {peak_nm}"
    );
    let floor = explain("S2");
    let not_asked = "seed/subdivide-floors-late are about the time after the first contact and are not asked for beams and slabs";
    assert!(floor.contains(not_asked) && !floor.contains("in the run, if"), "{floor}");

    let run = room.path().join("run");
    let trace = fs::read_to_string(run.join("trace.json")).unwrap();
    let trace: serde_json::Value = serde_json::from_str(&trace).unwrap();
    assert_eq!(trace["event_rules"].as_array().unwrap().len(), 5);
    assert!(trace["unasked"].as_array().is_some_and(|u| u.len() > 3));
    // without the trace the model and the rule base of today tell; a run of another model tells nothing
    fs::remove_file(run.join("trace.json")).unwrap();
    let model = fs::read_to_string(run.join("mbs.json")).unwrap().replace("\"C2-A1/1\"", "\"C2-A9/1\"");
    fs::write(run.join("mbs.json"), model).unwrap();
    let column = explain("C2-A1");
    assert!(column.contains(rule) && column.contains("the run of another model"), "{column}");
    assert!(!column.contains("subsystem fires"), "{column}");
    fs::write(run.join("mbs.json"), "{").unwrap();
    let (code, _, err) = fallwerk(room.path(), &["explain", "run/model.json", "C2-A1"]);
    assert!(code == 2 && err.contains("mbs.json"), "{err}");
}

/// A result folder that cannot be made is told by the name that was asked for.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_made_is_named() {
    let room = room(str::to_string);
    let (code, _, err) = fallwerk(room.path(), &["generate-mbs", "building.toml", "-o", "/proc/xx"]);
    assert!(code == 2 && err.contains("/proc/xx") && !err.contains("part-"), "{err}");
}

/// A program that asked for JSON is told of a failure in JSON.
#[test]
fn failures_are_told_in_json_where_json_is_asked_for() {
    let room = room(str::to_string);
    for words in [
        &["generate-mbs", "building.toml", "--json", "--rules", "absent"][..],
        &["explain", "model.json", "C1-A1", "--json"],
    ] {
        let (code, out, err) = fallwerk(room.path(), words);
        let value: Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{words:?}: {e}: {out}"));
        assert!(code == 2 && value["ok"] == false, "{out}");
        let message = value["diagnostics"][0]["message"].as_str().unwrap();
        assert!(err.contains(message) && !message.is_empty(), "{message}\n{err}");
    }
    let (code, out, _) = fallwerk(room.path(), &["study", "list", "--kb", ".", "--json"]);
    assert_eq!(
        (code, serde_json::from_str::<Value>(&out).unwrap()),
        (0, serde_json::json!({ "records": [] }))
    );
}
