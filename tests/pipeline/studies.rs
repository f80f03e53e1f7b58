//! Plans of studies and their runs.

use super::commands::{fallwerk, names, room};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// The first scenes of a plan, of one storey and a short run, in the folder `plan`.
fn short_plan(folder: &Path, count: usize) {
    let (code, _, err) = fallwerk(folder, &["study", "plan", "--count", "40", "-o", "all"]);
    assert_eq!(code, 0, "{err}");
    fs::create_dir(folder.join("plan")).unwrap();
    let texts = names(&folder.join("all")).into_iter().map(|name| {
        let text = fs::read_to_string(folder.join("all").join(&name)).unwrap();
        (name, text)
    });
    let is_small = |text: &str| {
        let of = |key: &str| text.lines().find(|l| l.starts_with(key)).unwrap().matches(',').count();
        of("x = ") + of("y = ") + of("storey_heights = ") <= 2
    };
    for (name, text) in texts.filter(|(_, text)| is_small(text)).take(count) {
        let end = text.lines().find(|l| l.starts_with("end_time = ")).unwrap().to_string();
        fs::write(folder.join("plan").join(name), text.replace(&end, "end_time = 0.3")).unwrap();
    }
    assert_eq!(names(&folder.join("plan")).len(), count);
}

#[test]
fn a_plan_is_the_same_every_time_and_a_longer_one_begins_with_it() {
    let room = tempfile::tempdir().unwrap();
    for (count, folder) in [("3", "a"), ("3", "b"), ("5", "c")] {
        let (code, _, err) =
            fallwerk(room.path(), &["study", "plan", "--seed", "7", "--count", count, "-o", folder]);
        assert_eq!(code, 0, "{err}");
    }
    let text = |folder: &str, name: &str| fs::read_to_string(room.path().join(folder).join(name)).unwrap();
    for name in names(&room.path().join("a")) {
        assert_eq!(text("a", &name), text("b", &name));
        assert_eq!(text("a", &name), text("c", &name));
        assert_eq!(fallwerk(room.path(), &["check", &format!("a/{name}")]).0, 0);
    }
    let (code, _, err) = fallwerk(room.path(), &["study", "plan", "--count", "0", "-o", "d"]);
    assert!(code == 2 && err.contains("--count"), "{err}");
}

#[test]
fn studies_are_run_once_and_the_same_on_any_number_of_threads() {
    let room = tempfile::tempdir().unwrap();
    short_plan(room.path(), 2);
    let run = |more: &[&str]| {
        let (code, out, err) = fallwerk(room.path(), &[&["study", "run", "plan"], more].concat());
        assert_eq!(code, 0, "{out}{err}");
        (out, err)
    };
    let (out, _) = run(&["--kb", "kb", "--threads", "2"]);
    assert!(out.contains("wrote 2 records"), "{out}");
    let records = names(&room.path().join("kb"));
    let text = |folder: &str, name: &str| fs::read_to_string(room.path().join(folder).join(name)).unwrap();
    // one is lost: only that is run again
    fs::remove_file(room.path().join("kb").join(&records[0])).unwrap();
    let (out, err) = run(&["--kb", "kb", "--threads", "1"]);
    assert!(out.contains("wrote 1 record to") && err.contains("1 of 2 buildings"), "{out}{err}");
    run(&["--kb", "other", "--threads", "1"]);
    let mut turned = 0;
    for name in &records {
        assert_eq!(text("kb", name), text("other", name));
        let study: Value = serde_json::from_str(&text("kb", name)).unwrap();
        let ends = study["facts"]["ends"].as_array().unwrap();
        let known = |key: &str| ends.iter().filter(|e| e[key].is_number()).count();
        assert_eq!(known("rotation_rad"), known("rotation_before_contact_rad"));
        turned += known("rotation_rad");
        let energies = &study["energies"];
        assert!(energies["end"]["gravity_j"].as_f64().unwrap() > 0.0, "{energies}");
        // the strips between the columns of a floor, where some are left
        let lines = study["facts"]["lines"].as_array().unwrap();
        let slabs = lines.iter().filter(|l| l["id"].as_str().unwrap().contains(":C"));
        assert!(slabs.clone().count() >= 1 && slabs.clone().all(|l| l["peak_rate_1_s"].is_number()));
        let points = study["motion"]["points"].as_array().unwrap();
        assert!(
            points.iter().all(|p| p["displacement_mm"].as_array().unwrap().len() == 3 * 4),
            "every 0.1 s up to 0.3 s"
        );
    }
    // a scene may have all its columns removed, not all of them
    assert!(turned > 0);
}

#[test]
fn folders_without_buildings_and_buildings_of_one_name_are_refused() {
    let room = tempfile::tempdir().unwrap();
    fs::create_dir(room.path().join("plan")).unwrap();
    let (code, _, err) = fallwerk(room.path(), &["study", "run", "plan"]);
    assert!(code == 2 && err.contains("no building files"), "{err}");
    for name in ["a.toml", "b.toml"] {
        fs::write(room.path().join("plan").join(name), fallwerk::building::EXAMPLE).unwrap();
    }
    let (code, _, err) = fallwerk(room.path(), &["study", "run", "plan"]);
    assert!(code == 2 && err.contains("a.toml") && err.contains("b.toml"), "{err}");
    assert_eq!(fallwerk(room.path(), &["study", "run", "plan/a.toml", "--threads", "0"]).0, 2);
    assert_eq!(names(room.path()), ["plan"]);
}

#[test]
fn buildings_without_a_record_are_named_together() {
    let room = tempfile::tempdir().unwrap();
    short_plan(room.path(), 2);
    let (code, out, err) = fallwerk(room.path(), &["study", "compare", "plan", "--kb", "none"]);
    assert_eq!(code, 1, "{err}");
    let plan: Vec<String> = names(&room.path().join("plan")).iter().map(|n| n.replace(".toml", "")).collect();
    let wanted =
        format!("no comparison of {}: no record in none; `fallwerk study run` makes it\n", plan.join(", "));
    assert_eq!(out, wanted);
    // the sets of rules have none of them either
    let ablation = ["study", "compare", "plan", "--kb", "none", "--ablation"];
    let (code, out, err) = fallwerk(room.path(), &ablation);
    assert!(code == 1 && out.ends_with(&wanted) && !out.contains("NaN"), "{out}{err}");
    assert!(out.contains("| 0 | none | none | none | none | none | 0 | 0 |"), "{out}");
    let (_, out, _) = fallwerk(room.path(), &[&ablation[..], &["--json"]].concat());
    let value: Value = serde_json::from_str(&out).unwrap();
    let missed = value["missed"].as_array().unwrap();
    assert!(missed.len() == 2 && missed.iter().all(|m| m["why"].as_str().unwrap().starts_with("no record")));
    assert!(value["together"].as_array().unwrap().len() > 3, "{out}");
    let (code, out, _) = fallwerk(room.path(), &["study", "compare", "nofile.toml"]);
    let told =
        "no comparison of nofile: nofile.toml is no building that can be read; `fallwerk check` says why\n";
    assert_eq!((code, out.as_str()), (1, told));
    for words in [
        &["study", "list", "--kb", "none", "--json"][..],
        &["study", "compare", "kb", "--rules", "none", "--json"],
    ] {
        let (code, out, err) = fallwerk(room.path(), words);
        let value: Value = serde_json::from_str(&out).unwrap();
        let told = value["diagnostics"][0]["message"].as_str().unwrap();
        assert!(code == 2 && told.contains("none") && err == format!("error: {told}\n"), "{out}{err}");
    }
}

/// A record has the name of its building, which another building may have too.
#[test]
fn a_record_of_another_input_is_not_replaced_unasked() {
    let room = room(str::to_string);
    let name = fallwerk::building::inspect_file(&room.path().join("building.toml")).building.unwrap().name;
    fs::create_dir(room.path().join("kb")).unwrap();
    let record = room.path().join("kb").join(format!("{name}.json"));
    let other = Path::new(env!("CARGO_MANIFEST_DIR")).join("kb/studies/s1-001.json");
    fs::copy(&other, &record).unwrap();
    let (code, out, err) = fallwerk(room.path(), &["study", "run", "building.toml", "--kb", "kb"]);
    let told = format!("{name}.json is of another input than building.toml; --again runs");
    assert!(code == 2 && out.is_empty() && err.contains(&told), "{out}{err}");
    assert_eq!(fs::read(record).unwrap(), fs::read(other).unwrap());
}
