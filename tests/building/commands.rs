//! The commands `check`, `init` and `schema` as a user runs them.

use std::path::Path;
use std::process::{Command, Output};

fn fallwerk(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let Output { status, stdout, stderr } =
        Command::new(env!("CARGO_BIN_EXE_fallwerk")).args(arguments).current_dir(folder).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code().unwrap(), text(stdout), text(stderr))
}

#[test]
fn init_then_check() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| fallwerk(folder.path(), arguments);
    assert_eq!(run(&["init"]).0, 0);
    let written = std::fs::read_to_string(folder.path().join("building.toml")).unwrap();
    let (renamed, example): (Vec<&str>, Vec<&str>) = written
        .lines()
        .zip(fallwerk::building::EXAMPLE.lines())
        .filter(|(written, example)| written != example)
        .unzip();
    assert_eq!(renamed, ["name = \"building\"               # used in titles and file names"]);
    assert_eq!(example, ["name = \"three-storey-frame\"     # used in titles and file names"]);
    let (code, out, err) = run(&["check", "building.toml"]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("12 columns") && out.contains("36.750 m3") && out.contains("91.88 t"), "{out}");

    std::fs::write(folder.path().join("building.toml"), "mine").unwrap();
    let (code, _, err) = run(&["init"]);
    assert_eq!(code, 2);
    assert!(err.contains("--force"), "{err}");
    assert_eq!(std::fs::read_to_string(folder.path().join("building.toml")).unwrap(), "mine");
    assert_eq!(run(&["init", "--force"]).0, 0);
    assert_eq!(run(&["check", "building.toml"]).0, 0);
    assert_eq!(run(&["init", "house.json"]).0, 2);
    // results lie in out/NAME: those of another file are not in the way
    for (file, name) in
        [("my-house.toml", "my-house"), ("a \"b\" \\c.toml", "a \"b\" -c"), (" .toml", "building")]
    {
        assert_eq!(run(&["init", file]).0, 0);
        assert_eq!(fallwerk::building::read(&folder.path().join(file)).unwrap().name, name);
    }
    assert_eq!(run(&["init", "nowhere/house.toml"]).0, 2);
}

#[test]
fn check_reports_and_exits() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/building/bad");
    let (code, out, err) = fallwerk(&folder, &["check", "wrong-unit.toml"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(err.contains("wrong-unit.toml:31:9") && err.ends_with("3 errors in wrong-unit.toml\n"), "{err}");
    let (code, out, err) = fallwerk(&folder, &["check", "--json", "wrong-unit.toml"]);
    assert_eq!((code, err.as_str()), (1, ""));
    let json: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(json["diagnostics"][1]["line"], 31);
    assert_eq!(json["diagnostics"][1]["column"], 9);
    assert_eq!(json["ok"], false);
    assert_eq!(fallwerk(&folder, &["check", "missing.toml"]).0, 2);
    assert_eq!(fallwerk(&folder, &["check", "."]).0, 2);
    assert_eq!(fallwerk(&folder, &["chekc"]).0, 2);
}

#[test]
fn schema_is_json() {
    let (code, out, _) = fallwerk(Path::new("."), &["schema"]);
    assert_eq!(code, 0);
    let schema: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(schema, fallwerk::building::schema::json_schema());
}

/// So is a brace.
#[test]
fn braces_run_in_fe_only() {
    let folder = tempfile::tempdir().unwrap();
    let member = "[[members]]\nid = \"X1\"\nkind = \"brace\"\nsection = \"beam\"\nfrom = [0, 5, 0.7]\nto = [6, 5, 2.6]\n\n[[supports]]";
    let text = fallwerk::building::EXAMPLE.replacen("[[supports]]", member, 1);
    let file = folder.path().join("braced.toml");
    std::fs::write(&file, text).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = file.to_str().unwrap();
    let (code, out, err) = fallwerk(root, &["check", "--mesh", file]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("1 brace ") && out.contains("tied with a mesh of their own: X1"), "{out}");
    let target = folder.path().join("out");
    let to = target.to_str().unwrap();
    let refused = [&["graph", file][..], &["generate-mbs", file, "-o", to], &["library", "derive", file]];
    for arguments in refused {
        let (code, _, err) = fallwerk(root, arguments);
        assert_eq!(code, 2, "{arguments:?}");
        assert!(
            err.contains("skew members run in FE only, and the brace `X1` has an axis of its own direction"),
            "{err}"
        );
        assert!(err.contains("help: run `fallwerk fe`, or leave it out of the file"), "{err}");
    }
    assert!(!target.exists());
}

/// A turned member is fine for FE; what knows boxes along the axes only refuses it by name.
#[test]
fn turned_members_run_in_fe_only() {
    let folder = tempfile::tempdir().unwrap();
    let member = "[[members]]\nid = \"C1-X\"\nkind = \"column\"\nsection = \"column\"\nfrom = [3, 2.5, 0]\nto = [3, 2.5, 3.5]\nrotation_deg = 30\n\n[[supports]]";
    let text = fallwerk::building::EXAMPLE.replacen("[[supports]]", member, 1);
    let file = folder.path().join("turned.toml");
    std::fs::write(&file, text).unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let file = file.to_str().unwrap();
    let (code, out, err) = fallwerk(root, &["check", "--mesh", file]);
    assert_eq!((code, err.as_str()), (0, ""));
    assert!(out.contains("13 columns") && out.contains("tied with a mesh of their own: C1-X"), "{out}");
    let target = folder.path().join("out");
    for arguments in [&["graph", file][..], &["generate-mbs", file, "-o", target.to_str().unwrap()]] {
        let (code, _, err) = fallwerk(root, arguments);
        assert_eq!(code, 2, "{arguments:?}");
        assert!(err.contains("skew members run in FE only"), "{err}");
        assert!(
            err.contains("the column `C1-X` has `rotation_deg = 30`") && err.contains("fallwerk fe"),
            "{err}"
        );
    }
    assert!(!target.exists());
}
