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

fn fallwerk(library: &Path, words: &[&str]) -> (u8, String, String) {
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

    let path = library.join(format!("{}.json", entries[0].key));
    fs::write(&path, "{}").unwrap();
    let (code, out, _) = fallwerk(&library, &["verify"]);
    assert!(code == 1 && out.contains(path.to_str().unwrap()) && out.contains("1 faults"), "{out}");
    let (code, _, err) = fallwerk(&library, &["show", &entries[0].key]);
    assert!(code == 1 && err.contains("damaged record"), "{err}");
    let (code, out, _) = fallwerk(&library, &["rebuild"]);
    assert!(code == 1 && out.contains("1 records, 1 damaged left out"), "{out}");
    let (code, _, err) = fallwerk(&room.path().join("absent"), &["list"]);
    assert!(code == 2 && err.contains("no such folder") && !room.path().join("absent").exists());
}
