//! What `fallwerk fe` refuses: with place, value and remedy, exit code 2, and nothing left behind.

use super::commands::{fallwerk, names, room};
use std::fs;
use std::path::Path;

/// The cantilever's deck with another text in place of one of its.
fn deck(folder: &Path, from: &str, to: &str) {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("decks/cantilever.k")).unwrap();
    assert!(text.contains(from));
    fs::write(folder.join("deck.k"), text.replacen(from, to, 1)).unwrap();
}

/// Runs `fe` with these arguments; the error must be one of the input that holds these words.
fn refused(folder: &Path, arguments: &[&str], words: &[&str]) {
    let before = names(folder);
    let (code, out, err) = fallwerk(folder, &[&["fe"], arguments].concat());
    assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {err}");
    for word in words {
        assert!(err.contains(word), "{arguments:?}: {word} in {err}");
    }
    assert_eq!(names(folder), before);
}

#[test]
fn values_of_a_deck_that_do_not_fit_its_elements() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let step = "       0.0       0.9";
    for (from, to, words) in [
        (
            step,
            "       0.0       0.9       0.0       0.0      -1.0",
            &["deck.k:14", "DT2MS = -", "up to 100 %", "% more mass"][..],
        ),
        ("      &end", "      1e30", &["deck.k:11", "1000000000", "units"]),
        ("      &end", "      1e-9", &["deck.k:11", "within its first step", "longer time"]),
        ("    3.0e10", "   1.7e308", &["deck.k:11", "more than 1e9 steps", "units"]),
        ("Rend           0.5", "Rend          -0.5", &["deck.k:11", "`&end` = -0.5", "positive"]),
        ("*PART\n", "*PART_TITLE\n", &["deck.k:25", "*PART_TITLE", "not known"]),
        ("*TITLE\n", "*NODE_TITLE\n", &["deck.k:4", "*NODE_TITLE", "not known"]),
    ] {
        deck(at, from, to);
        refused(at, &["deck.k", "-o", "run"], words);
    }
    deck(at, step, step);
    refused(at, &["deck.k", "-o", "run", "--end-time", "1e-9"], &["--end-time", "within its first step"]);
}

/// Also where a run without generated parts asks for neither rules nor library.
#[test]
fn folders_of_knowledge_that_are_not_there() {
    let folder = room(str::to_string);
    let at = folder.path();
    for option in ["--rules", "--library"] {
        let given = [option, "typo"];
        let words = [option, "typo is not a folder"];
        refused(at, &[&["building.toml", "-o", "run"], &given[..]].concat(), &words);
        refused(at, &[&["building.toml", "-o", "run", "--hybrid=auto"], &given[..]].concat(), &words);
        let generate = ["generate-mbs", "building.toml", "-o", "run", "--validate", "--hybrid=auto"];
        let (code, _, err) = fallwerk(at, &[&generate[..], &given].concat());
        assert_eq!(code, 2, "{err}");
        assert!(words.iter().all(|w| err.contains(w)), "{err}");
    }
    assert_eq!(names(at), ["building.toml"]);
}

/// The step named in the message is accepted.
#[test]
fn the_allowed_step_of_mass_scaling_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let scaled = |dt2ms: &str| {
        let card = format!("       0.0       0.9       0.0       0.0{dt2ms:>10}");
        deck(folder.path(), "       0.0       0.9", &card);
        fallwerk(folder.path(), &["fe", "deck.k", "-o", "run", "--end-time", "0.01"])
    };
    let (code, _, err) = scaled("-0.1");
    assert_eq!(code, 2, "{err}");
    let named = err.split("DT2MS = ").nth(1).unwrap().split(' ').next().unwrap();
    let (code, out, err) = scaled(named);
    assert_eq!(code, 0, "{named}: {err}");
    let added: f64 = out.split("added mass: ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((90.0..=100.0).contains(&added), "{out}");
}

#[test]
fn ends_steps_and_options_of_a_building() {
    let folder = room(str::to_string);
    let at = folder.path();
    let common = ["building.toml", "-o", "run"];
    let with = |more: &[&'static str]| [&common[..], more].concat();
    refused(at, &with(&["--end-time", "1e-9"]), &["0.000000001 s", "0.01 s", "output_interval"]);
    // what is refused is not first said to end elsewhere
    let (code, _, err) = fallwerk(at, &[&["fe"], &with(&["--end-time", "0.004"])[..]].concat());
    assert!(code == 2 && err.contains("before its first output") && !err.contains("nearest"), "{err}");
    refused(at, &with(&["--skip-unknown"]), &["--skip-unknown", "decks"]);
    refused(at, &with(&["--mass-scaling-step", "0.005"]), &["% more mass", "--force-mass-scaling"]);
    refused(
        at,
        &with(&["--mass-scaling-step", "1", "--force-mass-scaling"]),
        &["% to the mass", "1.000e0 s", "output interval"],
    );
}

/// With --json standard output tells what is wrong, be it found in options, in the model, or by the run.
#[test]
fn failures_are_told_as_json() {
    const HEAD: &str = "*KEYWORD\n*CONTROL_TERMINATION\n0.001\n*PART\npart\n1,1,1,0,1\n*HOURGLASS\n1,6,1.0\n\
        *MAT_ELASTIC\n1,2500.,3e10,0.2\n*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n7,1,1,1\n8,0,1,1\n";
    const BAR: &str = "*SECTION_BEAM\n1,3\n1e-4\n*ELEMENT_BEAM\n1,1,1,2\n*END\n";
    const CUBE: &str = "*SECTION_SOLID\n1,1\n*DEFINE_CURVE\n1\n0,1\n1,1\n*LOAD_BODY_Z\n1,1e200\n\
        *ELEMENT_SOLID\n1,1,1,2,3,4,5,6,7,8\n*END\n";
    let folder = room(str::to_string);
    let at = folder.path();
    fs::write(at.join("bar.k"), format!("{HEAD}{BAR}")).unwrap();
    fs::write(at.join("hard.k"), format!("{HEAD}{CUBE}")).unwrap();
    for (arguments, expected, word) in [
        (&["building.toml", "--end-time", "-1"][..], 2, "--end-time is -1"),
        (&["bar.k"], 2, "no solid elements"),
        (&["bar.k", "--mesh-size", "0.1"], 2, "--mesh-size"),
        (&["hard.k"], 1, "not finite"),
    ] {
        let (code, out, err) = fallwerk(at, &[&["fe"][..], arguments, &["--json", "-o", "run"]].concat());
        assert_eq!(code, expected, "{arguments:?}: {err}");
        let json: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|e| panic!("{e}: {out}"));
        assert_eq!(json["ok"], false);
        let message = json["diagnostics"][0]["message"].as_str().unwrap();
        assert!(message.contains(word) && err.contains(word), "{arguments:?}: {out}");
    }
}

/// A charge after the end does nothing, and an end between two outputs is moved: both are said.
#[test]
fn late_charges_are_noted() {
    let folder = room(|text| text.replacen("time = \"0 ms\"", "time = \"500 ms\"", 1));
    let run = |end: &str| {
        let (code, out, err) =
            fallwerk(folder.path(), &["fe", "building.toml", "-o", "run", "--end-time", end, "--json"]);
        assert_eq!(code, 0, "{err}");
        let json: serde_json::Value = serde_json::from_str(&out).unwrap();
        (json["notes"].as_array().unwrap().len(), err)
    };
    let (notes, err) = run("0.02");
    assert_eq!(notes, 1);
    for word in ["warning", "front-left", "0.5 s", "0.02 s", "C1-A1", "--end-time"] {
        assert!(err.contains(word), "{word}: {err}");
    }
    let (notes, err) = run("0.024");
    assert!(notes == 2 && err.contains("nearest to 0.024 s"), "{err}");
}

/// Places that cannot be written are found before anything is computed, and have one exit code.
#[cfg(unix)]
#[test]
fn places_that_cannot_be_written() {
    let folder = room(str::to_string);
    let at = folder.path();
    deck(at, "*PART\n", "*PART\n");
    for input in ["building.toml", "deck.k"] {
        refused(at, &[input, "-o", "/proc/fallwerk/run"], &["/proc/fallwerk", "-o", "make room"]);
        refused(at, &[input, "--write-deck", "/proc/fallwerk.k"], &["/proc/fallwerk.k", "make room"]);
    }
    let checkpoint =
        |file: &'static str| ["building.toml", "-o", "run", "--checkpoint-every", "1", "--checkpoint", file];
    for (file, words) in [
        ("/proc/x", &["--checkpoint /proc/x", "can be written"][..]),
        ("/dev/null", &["--checkpoint /dev/null", "no regular file"]),
        ("no/where", &["--checkpoint no/where", "there is no folder no"]),
    ] {
        refused(at, &checkpoint(file), words);
    }
    assert!(!Path::new("/proc/x").exists() && !Path::new("/dev/null").is_file());
}
