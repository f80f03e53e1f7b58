//! FE, hybrid and MBS in one validation: what is compared, what is left behind.

use super::commands::{fallwerk, names, room};
use fallwerk::base::tree::Format;
use fallwerk::building::{EXAMPLE, parse};
use fallwerk::fe::result::FeRun;
use fallwerk::fe::run::{Attached, FeOptions, run_with};
use fallwerk::validate::HybridValidation;
use fallwerk::validate::points::{PointErrors, debris};
use serde_json::Value;
use std::fs;

/// The example building for 0.14 s: it becomes rigid in that time where it has no longer to settle, and nothing falls far.
fn short(text: &str) -> String {
    let mut short = String::new();
    for line in text.lines() {
        let is_end = line.trim_start().starts_with("end_time ") || line.trim_start().starts_with("end_time=");
        short += if is_end { "end_time = 0.14" } else { line };
        short.push('\n');
    }
    short
}

#[test]
fn hybrid_is_for_a_validation() {
    let room = room(str::to_string);
    let (code, out, err) = fallwerk(room.path(), &["generate-mbs", "building.toml", "--hybrid", "-o", "run"]);
    assert_eq!((code, out.as_str()), (2, ""));
    assert!(err.contains("--hybrid") && err.contains("--validate"), "{err}");
    assert_eq!(names(room.path()), ["building.toml"]);
}

#[test]
fn one_validation_compares_three_runs() {
    let room = room(short);
    let root = env!("CARGO_MANIFEST_DIR");
    let (library, rules) = (format!("{root}/library"), format!("{root}/rules"));
    let arguments = [
        "generate-mbs",
        "building.toml",
        "--validate",
        "--hybrid",
        "--rigid-settle",
        "0.08",
        "--library",
        &library,
        "--rules",
        &rules,
        "-o",
        "run",
    ];
    let (code, out, err) = fallwerk(room.path(), &arguments);
    assert!(code < 2, "{err}");
    let rows = ["    FE  ", "    hybrid  ", "    MBS  "];
    assert!(rows.iter().all(|row| out.contains(row)), "{out}");
    assert!(out.contains("No tracked point becomes debris"), "{out}");

    let run = room.path().join("run");
    let read = |name: &str| fs::read_to_string(run.join(name)).unwrap();
    let json = |name: &str| serde_json::from_str::<Value>(&read(name)).unwrap();
    let (fe, hybrid, validation) = (json("fe.json"), json("hybrid.json"), json("validation.json"));
    assert!(
        fe.get("hybrid").is_none() && hybrid["hybrid"]["switches"].as_array().is_some_and(|s| !s.is_empty())
    );
    for file in ["hybrid.csv", "hybrid-switches.csv", "hybrid-displacements.csv", "hybrid-events.csv"] {
        assert!(run.join(file).exists(), "{file}");
    }
    assert_eq!(fe["times_s"], hybrid["times_s"]);
    let compared = &validation["hybrid"];
    for figure in ["e_to_contact", "e_total", "e_total_without_debris", "cpu_s", "cpu_share", "skipped_share"]
    {
        assert!(compared[figure].as_f64().is_some_and(|x| x > 0.0), "{figure}: {compared}");
    }
    assert_eq!(compared["e_total"], compared["e_total_without_debris"]);
    assert_eq!(validation["debris"], Value::Array(Vec::new()));
    assert_eq!(compared["footprint_overlap"], 1.0, "nothing has moved by a cell of the raster");
    let count = validation["times_s"].as_array().unwrap().len();
    for curve in ["e_curve", "e_curve_without_debris", "rigid_share"] {
        assert_eq!(compared[curve].as_array().unwrap().len(), count, "{curve}");
    }

    let left = validation["left_out"].as_array().unwrap();
    let of = |run: &str, what: &str| {
        let found = left.iter().find(|l| l["run"] == run && l["what"] == what);
        found.unwrap_or_else(|| panic!("{run} {what}: {left:?}"))
    };
    for l in left {
        let number = |key: &str| l[key].as_f64().unwrap();
        assert!((number("share") - number("left_out") / number("of")).abs() < 1e-12, "{l}");
        assert!((0.0..=1.0).contains(&number("share")), "{l}");
    }
    let rigid = of("hybrid", "rigid_elements");
    assert!((rigid["share"].as_f64().unwrap() - compared["skipped_share"].as_f64().unwrap()).abs() < 1e-6);
    assert_eq!(of("fe", "resting_elements")["switched_off_by"], "fe --compute-all");
    assert_eq!(of("mbs", "contact_pairs")["switched_off_by"], "simulate --compute-all");
    let [held, unwatched] = ["held_bodies", "unwatched_hinges"].map(|what| of("mbs", what));
    assert_eq!(held["share"], 10.0 / 32.0, "ten columns in two pieces that are one");
    assert_eq!(unwatched["share"], 1.0, "nothing has met or broken");
    assert_eq!(of("mbs", "sleeping_bodies")["left_out"], 0);

    let page = read("report.html");
    assert!(page.contains("Rules about contacts and fractures") && page.contains("if it breaks</td>"));
    assert!(page.contains("Not asked: rules learned"), "told in the notes");
    assert!(page.contains("What was left out") && page.contains("elements of rigid parts"));
    assert!(page.contains("<h1>FE, hybrid and MBS</h1>") && page.contains("The runs against FE"));
    assert_eq!(page.matches("<figure class=\"picture\">").count(), 6, "three runs, under way and at the end");
    assert!(page.contains("rigid part"), "the hybrid run has some by then");
    assert_eq!(
        page.matches("22 rigid compounds of 32 bodies; hinges: ").count(),
        4,
        "ten columns are held together"
    );
}

/// The example building's FE run of 20 ms with its frames.
fn fe_run() -> FeRun {
    let building = parse(EXAMPLE, Format::Toml, "building.toml").unwrap();
    let options = FeOptions { end_time_s: Some(0.02), keep_frames: true, ..FeOptions::default() };
    run_with(&building, &options, Attached::default(), &mut |_| {}).unwrap()
}

/// Nothing in the preloaded state, what the run ends with in the last frame.
#[test]
fn plastic_strain_of_a_frame_is_that_of_its_time() {
    let building = parse(EXAMPLE, Format::Toml, "building.toml").unwrap();
    let options = FeOptions { end_time_s: Some(0.15), keep_frames: true, ..FeOptions::default() };
    let fe = run_with(&building, &options, Attached::default(), &mut |_| {}).unwrap();
    let (first, last) = (&fe.frames[0], fe.frames.last().unwrap());
    assert!(first.plastic_strain.iter().all(|s| *s == 0.0));
    assert!(fe.plastic_strain.iter().zip(&last.plastic_strain).all(|(end, frame)| *end as f32 == *frame));
    assert!(fe.plastic_strain.iter().any(|s| *s > 0.0));
}

#[test]
fn points_that_become_debris_count_and_are_named() {
    let mut fe = fe_run();
    assert!(debris(&fe).is_empty() && fe.frames.iter().all(|f| f.rigid.is_empty()));
    assert!(fe.frames.iter().all(|f| f.fast.len() == fe.mesh.elements.len()));
    let mut other = fe.clone();
    let point = other.tracked.iter().position(|p| p.id.starts_with("S2.")).unwrap();
    other.tracked[point].displacement_m.iter_mut().for_each(|u| u[2] -= 1.0);
    let apart = HybridValidation::of(&fe, &other);
    assert!(apart.e_total > Some(10.0) && apart.e_total_without_debris == apart.e_total, "{apart:?}");

    fe.tracked[point].debris_s = Some(0.01);
    let apart = HybridValidation::of(&fe, &other);
    assert!(apart.e_total > Some(10.0) && apart.e_total_without_debris == Some(0.0), "{apart:?}");
    assert!(apart.debris.is_empty(), "it is debris in FE, not in the other run");
    let named = debris(&fe);
    assert_eq!(
        (named.len(), named[0].point.as_str(), named[0].from_s),
        (1, fe.tracked[point].id.as_str(), 0.01)
    );
    let errors = PointErrors::of(&fe.times_s, &fe.tracked, other.times_s.len(), |_| None);
    assert_eq!((errors.until(None), errors.pairs.len()), (None, 0), "no point, no error");
}
