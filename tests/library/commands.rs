//! `fallwerk library …`: output and exit codes.

use super::entry;
use clap::Parser;
use fallwerk::cli::library::{LibraryArgs, execute};
use fallwerk::library::Store;
use std::fs;
use std::path::Path;

#[derive(Parser)]
struct Program {
    #[command(flatten)]
    args: LibraryArgs,
}

pub(super) fn fallwerk(library: &Path, words: &[&str]) -> (u8, String, String) {
    let library = library.to_str().unwrap();
    let all = ["library", "--library", library].into_iter().chain(words.iter().copied());
    let program = Program::try_parse_from(all).unwrap();
    let (mut out, mut err) = (Vec::new(), Vec::new());
    let code = execute(&program.args, &mut out, &mut err);
    (code, String::from_utf8(out).unwrap(), String::from_utf8(err).unwrap())
}

#[test]
fn commands_answer_in_words_json_and_exit_codes() {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    let entries = [entry(0), entry(1)];
    Store::open(&library).unwrap().put_all(&entries).unwrap();

    let (code, out, err) = fallwerk(&library, &["list"]);
    assert_eq!((code, out.lines().count(), err.as_str()), (0, 2, ""));
    let (code, out, _) = fallwerk(&library, &["list", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, value["entries"].as_array().unwrap().len()), (0, 2));

    let (code, out, _) = fallwerk(&library, &["show", &entries[0].key]);
    assert!(code == 0 && out.contains("5000 elements"), "{out}");
    let (code, out, _) = fallwerk(&library, &["show", "--json", &entries[0].key]);
    assert_eq!((code, out), (0, entries[0].to_text().unwrap()));
    let (code, _, err) = fallwerk(&library, &["show", "nothing"]);
    assert!(code == 2 && err.contains("no entry `nothing`"), "{err}");

    let (code, out, _) = fallwerk(&library, &["show", "nothing", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    let told = value["diagnostics"][0]["message"].as_str().unwrap();
    assert!(code == 2 && value["ok"] == false && told.starts_with("no entry `nothing`"), "{out}");

    let (code, out, _) = fallwerk(&library, &["verify"]);
    assert_eq!((code, out.as_str()), (0, "2 records: all sound\n"));
    let file = room.path().join("all.json");
    assert_eq!(fallwerk(&library, &["export", file.to_str().unwrap()]).0, 0);
    let copy = room.path().join("copy");
    let (code, out, _) = fallwerk(&copy, &["import", file.to_str().unwrap()]);
    assert_eq!((code, out.as_str()), (0, "2 added, 0 mended, 0 were there already\n"));
    let (code, ..) = fallwerk(&copy, &["deprecate", &entries[0].key, "--successor", &entries[1].key]);
    assert_eq!(code, 0);
    let (_, out, _) = fallwerk(&copy, &["list"]);
    assert!(out.contains(&format!("use {}", entries[1].key)), "{out}");
    let (code, _, err) = fallwerk(&copy, &["deprecate", &entries[0].key]);
    assert!(code == 2 && err.contains("is deprecated already (replaced; successor column_hinge/"), "{err}");
    let (code, out, _) = fallwerk(&copy, &["deprecate", &entries[0].key, "--reason", "too coarse", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (code, &value["reason"], &value["successor"]),
        (0, &"too coarse".into(), &entries[1].key.as_str().into())
    );

    let path = library.join(format!("{}.json", entries[0].key));
    fs::write(&path, "{}").unwrap();
    let (code, out, _) = fallwerk(&library, &["verify"]);
    assert!(code == 1 && out.contains(path.to_str().unwrap()) && out.contains("1 fault\n"), "{out}");
    let (code, _, err) = fallwerk(&library, &["show", &entries[0].key]);
    assert!(code == 1 && err.contains("damaged record"), "{err}");
    let (code, out, _) = fallwerk(&library, &["rebuild"]);
    assert!(code == 1 && out.contains("1 records, 1 damaged left out"), "{out}");
    let (code, _, err) = fallwerk(&room.path().join("absent"), &["list"]);
    assert!(code == 2 && err.contains("no such folder") && !room.path().join("absent").exists());
}

/// A lost record is named until the loss is noted; whoever notes it says so.
#[test]
fn a_record_that_is_gone_is_named() {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    let entries = [entry(0), entry(1), entry(2)];
    Store::open(&library).unwrap().put_all(&entries).unwrap();
    let [first, second] = [0, 1].map(|i: usize| library.join(format!("{}.json", entries[i].key)));
    fs::remove_file(&first).unwrap();
    let (code, out, _) = fallwerk(&library, &["verify"]);
    assert!(code == 1 && out.contains(&format!("{}: its record is gone", entries[0].key)), "{out}");
    assert!(out.ends_with("2 records: 1 fault\n"), "{out}");
    let (code, _, err) = fallwerk(&library, &["rebuild"]);
    assert!(code == 0 && err.contains(&format!("{}: its record is gone", entries[0].key)), "{err}");
    let (code, out, _) = fallwerk(&library, &["verify"]);
    assert!(code == 0 && out.ends_with("2 records: all sound; 1 missing\n"), "{out}");
    fs::remove_file(&second).unwrap();
    let (_, _, err) = fallwerk(&library, &["deprecate", &entries[2].key]);
    assert!(err.contains(&entries[1].key) && !err.contains(&entries[0].key), "{err}");
}

/// The journal is asked for one entry, which may be gone, and never for one of several.
#[test]
fn histories_are_those_of_one_entry() {
    let library = tempfile::tempdir().unwrap();
    let entries = [entry(0), entry(1)];
    Store::open(library.path()).unwrap().put_all(&entries).unwrap();
    let history = |key: &str| fallwerk(library.path(), &["history", key]);
    let (code, out, err) = history("column_hinge");
    assert!(code == 2 && out.is_empty() && err.contains("it could mean 2 entries"), "{out}{err}");
    for entry in &entries {
        fs::remove_file(library.path().join(format!("{}.json", entry.key))).unwrap();
    }
    assert_eq!(fallwerk(library.path(), &["rebuild"]).0, 0);
    let key = entries[0].key.as_str();
    let name = key.split('/').nth(1).unwrap();
    for text in [key, name, name.split('@').nth(1).unwrap()] {
        let (code, out, err) = history(text);
        assert!(code == 0 && out.lines().count() == 2 && out.contains("  missing  "), "{text}: {out}{err}");
        assert!(out.lines().all(|line| line.contains(key)), "{out}");
    }
    let (code, out, err) = history("column_hinge");
    assert!(code == 2 && out.is_empty() && err.contains("it could mean 2 entries"), "{out}{err}");
    assert!(history("nothing").2.contains("no entry `nothing`"));
}

/// Options of sections are no options of buildings.
#[test]
fn options_that_a_building_has_no_use_for_are_refused() {
    let library = tempfile::tempdir().unwrap();
    for option in [&["--make", "shear"][..], &["--make=hinge"], &["--whole"], &["--axial=0.1"]] {
        let (code, out, err) = fallwerk(library.path(), &[&["derive", "building.toml"], option].concat());
        let name = option[0].split('=').next().unwrap();
        assert!(code == 2 && out.is_empty() && err.contains(name), "{option:?}: {out}{err}");
        assert!(err.contains("are of --section and --grid"), "{err}");
    }
}

/// What is there and not to be used is told, unless another entry stands in its place.
#[test]
fn derive_tells_which_of_the_entries_are_deprecated() {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let all = Store::open_to_read(&root.join("library")).unwrap().list().unwrap();
    let of_the_mesh = all.into_iter().filter(|entry| entry.features.mesh_size_m == Some(0.4));
    Store::open(&library).unwrap().put_all(&of_the_mesh.collect::<Vec<_>>()).unwrap();
    let building = root.join("buildings/three-storey-frame.toml");
    let derive = || {
        let (code, out, err) = fallwerk(&library, &["derive", building.to_str().unwrap(), "--json"]);
        assert_eq!(code, 0, "{err}");
        let value: serde_json::Value = serde_json::from_str(&out).unwrap();
        assert_eq!(value["added"].as_array().unwrap().len(), 0, "{out}");
        value
    };
    let value = derive();
    let keys: Vec<&str> =
        value["present"].as_array().unwrap().iter().map(|key| key.as_str().unwrap()).collect();
    assert_eq!(value["deprecated"], serde_json::json!([]));
    assert_eq!(fallwerk(&library, &["deprecate", keys[0], "--reason", "wrong law"]).0, 0);
    let told = serde_json::json!([{ "key": keys[0], "reason": "wrong law" }]);
    assert_eq!(derive()["deprecated"], told);
    let (_, out, _) = fallwerk(&library, &["derive", building.to_str().unwrap()]);
    assert!(out.contains("were there already; 1 of them deprecated, with no successor to use"), "{out}");
    assert_eq!(fallwerk(&library, &["deprecate", keys[0], "--successor", keys[1]]).0, 0);
    assert_eq!(derive()["deprecated"], serde_json::json!([]));
}

/// A library with the example of the documentation, and its files.
fn with_example(room: &Path) -> (std::path::PathBuf, String, String) {
    let (library, curve, meta) = (room.join("library"), room.join("c.csv"), room.join("m.toml"));
    fs::write(&curve, fallwerk(room, &["add", "--example-curve"]).1).unwrap();
    fs::write(&meta, fallwerk(room, &["add", "--example"]).1).unwrap();
    (library, curve.display().to_string(), meta.display().to_string())
}

#[test]
fn a_curve_is_checked_added_found_and_drawn() {
    let room = tempfile::tempdir().unwrap();
    let (library, curve, meta) = with_example(room.path());
    let run = |words: &[&str]| fallwerk(&library, words);
    let (code, out, _) = run(&["add", &curve, "--meta", &meta, "--check"]);
    assert!(code == 0 && out.starts_with("sound column_hinge/350x350"), "{out}");
    assert!(!library.exists(), "a check makes no library");
    assert!(run(&["add", &curve, "--meta", &meta]).1.starts_with("added column_hinge/350x350"));
    assert!(run(&["add", &curve, "--meta", &meta]).1.ends_with("was there already\n"));
    let (_, out, _) = run(&["history"]);
    assert!(out.lines().count() == 1 && out.contains("  added  ") && out.contains("Z  "), "{out}");

    // Twice the ties, half the moments: an entry between the two.
    let text = fs::read_to_string(&meta).unwrap().replace("75 mm", "150 mm");
    fs::write(&meta, text).unwrap();
    assert_eq!(run(&["add", &curve, "--meta", &meta]).0, 0);
    let (code, out, _) = run(&["find", "--kind", "column_hinge", "width=350mm", "tie_spacing=100mm"]);
    assert!(code == 0 && out.starts_with("between ") && out.contains("share of the second"), "{out}");
    let record = room.path().join("between.json");
    let words = ["find", "--kind", "column_hinge", "tie_spacing=0.1", "-o", record.to_str().unwrap()];
    assert_eq!(run(&words).0, 0);
    let between = fallwerk::library::Entry::from_text(&fs::read_to_string(record).unwrap()).unwrap();
    assert_eq!(between.features.rc.unwrap().tie_spacing_m, Some(0.1));
    let (code, out, _) = run(&["find", "--kind", "column_hinge", "tie_spacing=76mm", "--no-interpolation"]);
    assert!(code == 0 && out.contains("rc.tie_spacing_m is 0.075 instead of 0.076"), "{out}");
    let (code, out, _) = run(&["find", "--kind", "column_hinge", "width=900mm"]);
    assert!(code == 1 && out.starts_with("none; the nearest is"), "{out}");

    let (code, out, _) = run(&[
        "diff",
        "column_hinge/350x350-l1000-bottom-ground-fc35-r320-s75",
        "column_hinge/350x350-l1000-bottom-ground-fc35-r320-s150",
    ]);
    assert!(code == 0 && out.contains("features.rc.tie_spacing_m") && out.contains("(+100.00 %)"), "{out}");
    let (code, svg, _) = run(&[
        "plot",
        "column_hinge/350x350-l1000-bottom-ground-fc35-r320-s75",
        "--reference",
        &curve,
        "--to",
        "50mrad",
    ]);
    assert!(code == 0 && svg.starts_with("<svg xmlns") && svg.contains("reference, N = 600 kN"), "{svg}");
    // JSON tells of the file; without one there is nothing to tell
    let entry = "column_hinge/350x350-l1000-bottom-ground-fc35-r320-s75";
    let file = room.path().join("plot.svg");
    let (code, out, err) = run(&["plot", entry, "--json", "-o", file.to_str().unwrap()]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &value["file"]), (0, &file.to_str().unwrap().into()), "{err}");
    assert!(value["key"].as_str().unwrap().starts_with(entry) && file.is_file(), "{out}");
    let (code, out, err) = run(&["plot", entry, "--json"]);
    assert!(code == 2 && err.contains("name a file for it with -o") && !out.contains("<svg"), "{out}{err}");
    // a plot of what is not to be used says so
    let entry = "column_hinge/350x350-l1000-bottom-ground-fc35-r320-s150";
    assert_eq!(run(&["deprecate", entry, "--reason", "wrong ties"]).0, 0);
    let (code, svg, _) = run(&["plot", entry]);
    assert!(code == 0 && svg.contains("(deprecated: wrong ties)</text>"), "{svg}");
    for to in ["0", "-5mrad"] {
        let (code, _, err) = run(&["plot", "350x350-l1000-bottom-ground-fc35-r320-s75", "--to", to]);
        assert!(code == 2 && err.contains("give a positive number"), "{err}");
    }
}

/// Axial forces of which neither axis knows are not told.
#[test]
fn the_axial_forces_of_both_axes_are_told() {
    let room = tempfile::tempdir().unwrap();
    let (library, curve, meta) = with_example(room.path());
    let level = |axis: u8, force: u32| {
        format!("{axis},0,0,{force}\n{axis},4,98,{force}\n{axis},10,176,{force}\n{axis},60,80,{force}\n")
    };
    let rows = level(1, 0) + &level(2, 100);
    fs::write(&curve, format!("axis, rotation [mrad], moment [kN m], axial force [kN]\n{rows}")).unwrap();
    let (code, _, err) = fallwerk(&library, &["add", &curve, "--meta", &meta]);
    assert!(code == 0 && err.contains("no axial force is known about both"), "{err}");
    let (_, out, _) = fallwerk(&library, &["show", "350x350"]);
    assert!(out.contains("N 0.0 to 0.0 kN about axis 1, 100.0 to 100.0 kN about axis 2"), "{out}");
}

/// Of entries that fit alike the answer names the number, and what was not asked for; what is no question is refused.
#[test]
fn find_tells_of_rivals_and_refuses_what_is_no_question() {
    let room = tempfile::tempdir().unwrap();
    let (library, curve, meta) = with_example(room.path());
    let run = |words: &[&str]| fallwerk(&library, &[&["find", "--kind", "column_hinge"], words].concat());
    let text = fs::read_to_string(&meta).unwrap();
    for (ties, concrete) in
        [("75 mm", "35 MPa"), ("75 mm", "45 MPa"), ("150 mm", "35 MPa"), ("150 mm", "45 MPa")]
    {
        fs::write(&meta, text.replace("75 mm", ties).replace("35 MPa", concrete)).unwrap();
        assert_eq!(fallwerk(&library, &["add", &curve, "--meta", &meta]).0, 0);
    }
    let (code, out, _) = run(&["width=350mm"]);
    assert!(
        code == 0 && out.contains("distance 0.0000: exact match\n  3 other entries fit it as well"),
        "{out}"
    );
    assert!(out.contains("they differ in rc.concrete_strength_pa, rc.tie_spacing_m: ask"), "{out}");
    let (_, out, _) = run(&["width=350mm", "tie_spacing=75mm", "concrete_strength=45MPa"]);
    assert!(!out.contains("as well"), "{out}");
    let (_, out, _) = run(&["width=350mm", "concrete_strength=40MPa", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&value["answer"], &value["rivals"]["count"]), (&"between".into(), &1.into()), "{out}");
    assert_eq!(value["rivals"]["differ"], serde_json::json!(["rc.tie_spacing_m"]));
    let (_, out, _) = run(&[]);
    assert!(out.contains("one of 4 entries of this kind, as nothing was asked for"), "{out}");
    assert!(!out.contains("exact match"), "{out}");
    // a second curve of the same section is no less an answer
    let other = fs::read_to_string(&curve).unwrap().replace("201", "205");
    fs::write(&curve, other).unwrap();
    assert_eq!(fallwerk(&library, &["add", &curve, "--meta", &meta]).0, 0);
    let (_, out, _) = run(&["width=350mm", "tie_spacing=150mm", "concrete_strength=45MPa"]);
    assert!(
        out.contains("another entry fits it as well; their features are the same: `library diff`"),
        "{out}"
    );

    let refused = |words: &[&str], why: &str| {
        let (code, out, err) = run(words);
        assert!(code == 2 && out.is_empty() && err.contains(why), "{words:?}: {out}{err}");
    };
    // however far it may be, another end is no answer
    let (code, out, _) = run(&["--end", "top", "--tolerance", "inf", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert!(code == 1 && value["answer"] == "none" && value["nearest"]["key"].is_string(), "{out}");
    let (code, out, _) = run(&["width=900mm", "--tolerance", "inf"]);
    assert!(code == 0 && out.contains("width_m is 0.35 instead of 0.9"), "{out}");
    refused(&["width=350mm", "width=0.4"], "`width_m` is asked for twice");
    refused(&["colour=4"], "there is no feature `colour`; the features are width, depth,");
    let parsed = |words: &[&str]| {
        let all = [&["library", "find", "--kind", "column_hinge"], words].concat();
        Program::try_parse_from(all).err().map(|e| e.to_string()).unwrap_or_default()
    };
    assert!(parsed(&["widht=400mm"]).contains("did you mean `width`?"));
    assert!(parsed(&["colour=4kN"]).contains("there is no feature `colour`"));
    assert!(parsed(&["width=0"]).contains("`width_m` is a positive number"));
    assert!(parsed(&["--tolerance", "nan"]).contains("a number from 0"));
    assert!(parsed(&["--tolerance", "-1"]).contains("a number from 0"));
}

#[test]
fn lists_are_filtered_and_errors_of_files_are_shown_with_their_places() {
    let room = tempfile::tempdir().unwrap();
    let (library, curve, meta) = with_example(room.path());
    let run = |words: &[&str]| fallwerk(&library, words);
    assert_eq!(run(&["add", &curve, "--meta", &meta]).0, 0);
    Store::open(&library).unwrap().put_all(&[entry(0), entry(20)]).unwrap();
    let count = |words: &[&str]| run(words).1.lines().filter(|l| l.contains('@')).count();
    assert_eq!(count(&["list"]), 3);
    assert_eq!(count(&["list", "--origin", "test"]), 1);
    assert_eq!(count(&["list", "--kind", "beam_hinge"]), 0);
    assert_eq!(count(&["list", "--width", "300mm..0.5"]), 2);
    assert_eq!(count(&["list", "--width", "200mm", "--depth", "0.2"]), 1);
    fs::write(&curve, "rotation, moment [kN m]\n0,0\n").unwrap();
    let (code, _, err) = run(&["add", &curve, "--meta", &meta]);
    assert!(code == 2 && err.contains("c.csv:1:1") && err.contains("write `rotation [deg]`"), "{err}");
}

/// Without a folder the library is that of the program, which is read and not written.
#[test]
fn without_a_folder_the_library_of_the_program_is_only_read() {
    let room = tempfile::tempdir().unwrap();
    let run = |words: &[&str]| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_fallwerk"));
        let done = command.arg("library").args(words).current_dir(room.path()).output().unwrap();
        let [out, err] = [done.stdout, done.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (done.status.code().unwrap(), out, err)
    };
    let (code, out, err) = run(&["list"]);
    assert!(code == 0 && out.contains("column_hinge/"), "{err}");
    for words in [&["import", "all.json"][..], &["add", "a.csv", "--meta", "a.toml"], &["rebuild"]] {
        let (code, _, err) = run(words);
        assert!(code == 2 && err.contains("name the library to write to with --library"), "{words:?}: {err}");
    }
    // nor locked, nor is there a working copy built
    let lock = Path::new(env!("CARGO_MANIFEST_DIR")).join("library/.cache/lock");
    let before = fs::read(&lock).ok();
    let (code, out, err) = run(&["verify"]);
    assert!(code == 0 && out.contains("all sound"), "{out}{err}");
    assert_eq!(fs::read(&lock).ok(), before);
    let (code, _, err) = run(&["add", "a.csv", "--meta", "a.toml", "--check"]);
    assert!(code == 2 && err.contains("a.csv") && !err.contains("--library"), "{err}");
    let (code, _, err) = run(&["--library", "absent", "list"]);
    assert!(code == 2 && err.contains("absent: no such folder"), "{err}");
    // a command that adds makes the folder that is named
    let (code, _, err) = run(&["--library", "new", "derive", "absent.toml"]);
    assert!(code == 2 && err.contains("absent.toml") && !err.contains("no such folder;"), "{err}");
}
