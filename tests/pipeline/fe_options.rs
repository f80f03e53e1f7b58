//! Options that choose how the FE run is computed: what was asked for is what runs, and what there is not is refused by name.

use super::commands::{fallwerk, names, room};
use fallwerk::base::isa::Isa;
use fallwerk::base::tree::Format;
use fallwerk::building::{EXAMPLE, parse};
use fallwerk::cli::fe::displacements_csv;
use fallwerk::fe::deck::{DeckOptions, read};
use fallwerk::fe::law::ElementForm;
use fallwerk::fe::run::{FeOptions, run};
use fallwerk::verify::fe::forms::{FORMS, form};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Runs the building in a folder for 20 ms; returns what is printed as JSON, `fe.json` and the displacements.
fn short_run(room: &Path, folder: &str, options: &[&str]) -> (Value, Value, String) {
    let common = ["fe", "building.toml", "--end-time", "0.02", "-o", folder, "--json"];
    let (code, out, err) = fallwerk(room, &[&common[..], options].concat());
    assert_eq!(code, 0, "{err}");
    let read = |file: &str| fs::read_to_string(room.join(folder).join(file)).unwrap();
    let json = |text: &str| serde_json::from_str(text).unwrap();
    (json(&out), json(&read("fe.json")), read("fe-displacements.csv"))
}

#[test]
fn the_form_asked_for_is_the_one_that_runs() {
    let room = room(str::to_string);
    let building = parse(EXAMPLE, Format::Toml, "building.toml").unwrap();
    let (_, record, by_default) = short_run(room.path(), "default", &[]);
    assert_eq!(record["form"], "asqbi");
    let mut seen: Vec<String> = Vec::new();
    for name in ["asqbi", "ads", "fb-stiffness"] {
        let (printed, record, displacements) = short_run(room.path(), name, &["--form", name]);
        assert_eq!((&record["form"], &printed["form"]), (&Value::from(name), &Value::from(name)));
        let options = FeOptions {
            end_time_s: Some(0.02),
            form: Some(form(name).unwrap().form),
            ..FeOptions::default()
        };
        let direct = run(&building, &options, &mut |_| {}).unwrap();
        assert!(displacements == displacements_csv(&direct), "{name}: the run is not that of the form");
        assert_eq!(displacements == by_default, name == "asqbi", "{name}");
        assert!(!seen.contains(&displacements), "{name} gives what another form gives");
        seen.push(displacements);
    }
}

#[test]
fn an_unknown_form_is_refused_with_those_there_are() {
    let room = room(str::to_string);
    for command in [&["fe", "building.toml", "-o", "run"][..], &["bench", "fe"]] {
        let (code, out, err) = fallwerk(room.path(), &[command, &["--form", "hexa"]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{command:?}: {err}");
        assert!(err.contains("--form") && err.contains("`hexa`"), "{err}");
        for known in FORMS {
            assert!(err.contains(known.name), "{}: {err}", known.name);
        }
    }
    assert_eq!(names(room.path()), ["building.toml"]);
}

#[test]
fn the_instruction_set_is_that_asked_for_and_changes_no_result() {
    let room = room(str::to_string);
    let (_, record, by_default) = short_run(room.path(), "default", &[]);
    let bench = ["bench", "fe", "--elements", "216", "--cycles", "2", "--json"];
    let measured = |options: &[&str]| {
        let (code, out, err) = fallwerk(room.path(), &[&bench[..], options].concat());
        assert_eq!(code, 0, "{err}");
        serde_json::from_str::<Value>(&out).unwrap()["isa"].as_str().unwrap().to_string()
    };
    assert_eq!(measured(&[]), Isa::best().name());
    for isa in Isa::ALL {
        let option = ["--isa", isa.name()];
        if isa.is_available() {
            assert_eq!(measured(&option), isa.name());
            let (_, same, displacements) = short_run(room.path(), isa.name(), &option);
            assert!(same == record && displacements == by_default, "{isa:?}");
        } else {
            let (code, _, err) = fallwerk(room.path(), &[&bench[..], &option].concat());
            assert_eq!(code, 2, "{err}");
            assert!(err.contains("--isa") && err.contains(isa.name()) && err.contains("portable"), "{err}");
        }
    }
    for command in [&["fe", "building.toml", "-o", "run"][..], &["bench", "fe"]] {
        let (code, out, err) = fallwerk(room.path(), &[command, &["--isa", "mmx"]].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{err}");
        assert!(Isa::ALL.iter().all(|isa| err.contains(isa.name())) && err.contains("`mmx`"), "{err}");
    }
}

/// What is switched off for comparison is told wherever the run is.
#[test]
fn switching_of_rigid_parts_can_be_left_out_and_says_so() {
    let room = room(str::to_string);
    let (code, _, err) = fallwerk(room.path(), &["fe", "building.toml", "--rigid-switching", "off"]);
    assert!(code == 2 && err.contains("--hybrid"), "{err}");
    let run = |switching: &str| {
        let arguments = ["fe", "building.toml", "--hybrid", "--rigid-switching", switching];
        let short = ["--end-time", "0.04", "--rigid-settle", "0", "-o", switching];
        let (code, _, err) = fallwerk(room.path(), &[&arguments[..], &short].concat());
        assert_eq!(code, 0, "{err}");
        let text = fs::read_to_string(room.path().join(switching).join("fe.json")).unwrap();
        let fe: Value = serde_json::from_str(&text).unwrap();
        (err, fe["hybrid"]["switching"].as_bool(), fe["hybrid"]["checks"].as_u64().unwrap())
    };
    let (err, switching, checks) = run("off");
    assert!(err.contains("for comparison only"), "{err}");
    assert_eq!((switching, checks), (Some(false), 0));
    let (err, switching, checks) = run("on");
    assert!(!err.contains("for comparison only") && switching == Some(true) && checks > 0, "{err}");
}

/// A building that stands at the end of a run has not shown yet what the charges do that come later.
#[test]
fn there_is_no_verdict_before_all_charges_were_fired() {
    let late = "[[events]]\nid = \"front-right\"\nmember = \"C1-B1\"\ntime = \"1 s\"";
    let room = room(|text| {
        let at_once = "[[events]]\nid = \"front-right\"\nmember = \"C1-B1\"\ntime = \"0 ms\"";
        assert!(text.contains(at_once));
        text.replace(at_once, late)
    });
    let (printed, ..) = short_run(room.path(), "short", &[]);
    assert_eq!(
        (&printed["collapsed"], &printed["unfired"]),
        (&Value::Null, &Value::from(vec!["front-right"]))
    );
    let (code, out, err) =
        fallwerk(room.path(), &["fe", "building.toml", "--end-time", "0.02", "-o", "again"]);
    assert_eq!(code, 0, "{err}");
    assert!(out.contains("no verdict (the run ends before front-right) in the FE run"), "{out}");
}

/// What belongs to the model goes into a written deck; what belongs to a run is refused by name.
#[test]
fn options_beside_a_deck_that_is_written() {
    let room = room(str::to_string);
    let at = room.path();
    let model_options = ["--end-time", "0.05", "--form", "full", "--mass-scaling-step", "0.001"];
    let write = ["fe", "building.toml", "--write-deck", "a.k", "--no-body-contact", "--json"];
    let (code, out, err) = fallwerk(at, &[&write[..], &model_options].concat());
    assert_eq!(code, 0, "{err}");
    let printed: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&printed["output"], printed["notes"].is_array()), (&Value::from("a.k"), true));
    let model = |file: &str| read(&at.join(file), DeckOptions::default()).unwrap().model;
    let written = model("a.k");
    assert_eq!((written.control.end_time_s, written.body_contact), (0.05, None));
    assert!((written.control.mass_scaling_step_s.unwrap() / 0.001 - 1.0).abs() < 1e-12);
    assert!(written.mesh.laws.iter().all(|l| l.form == ElementForm::FullyIntegrated));
    let (code, out, err) = fallwerk(at, &["fe", "a.k", "--write-deck", "b.k", "--end-time", "0.02"]);
    assert_eq!((code, out.trim()), (0, "b.k"), "{err}");
    assert_eq!(model("b.k").control.end_time_s, 0.02);
    for option in [
        &["--hybrid"][..],
        &["--on-failure", "split"],
        &["--resume", "x"],
        &["--checkpoint-every", "1"],
        &["--compute-all"],
        &["--vtu"],
        &["--vtu-every", "2"],
        &["--output", "run"],
        &["--mass-scaling-step", "0.001", "--force-mass-scaling"],
    ] {
        let name = option.iter().rfind(|word| word.starts_with("--")).unwrap();
        let (code, out, err) =
            fallwerk(at, &[&["fe", "building.toml", "--write-deck", "c.k"][..], option].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{name}: {err}");
        assert!(err.contains(name) && err.contains("--write-deck"), "{name}: {err}");
    }
    for option in [&["--vtu"][..], &["-o", "run"]] {
        let (code, _, err) = fallwerk(at, &[&["fe", "a.k", "--write-deck", "c.k"][..], option].concat());
        assert!(code == 2 && err.contains("--write-deck"), "{option:?}: {err}");
    }
    assert_eq!(names(at), ["a.k", "b.k", "building.toml"]);
}
