//! Export and import of whole libraries.

use super::{computed, entry, entry_of};
use fallwerk::library::{Deprecation, Entry, EntryKind, Origin, Put, Store, exchange};
use std::fs;
use std::path::Path;

#[test]
fn export_and_import_carry_everything() {
    let room = tempfile::tempdir().unwrap();
    let (from, to, file) = (room.path().join("from"), room.path().join("to"), room.path().join("all.json"));
    let entries: Vec<Entry> = (0..8).map(entry).collect();
    let mut store = Store::open(&from).unwrap();
    store.put_all(&entries).unwrap();
    store.deprecate(&entries[1].key, Some(&entries[0].key), Some("coarse")).unwrap();
    assert_eq!(exchange::export(&store, &file).unwrap(), 8);

    let mut target = Store::open(&to).unwrap();
    target.put(&entries[5]).unwrap();
    let report = exchange::import(&mut target, &file).unwrap();
    assert_eq!((report.added, report.unchanged, report.mended), (7, 1, 0));
    assert_eq!(target.list().unwrap(), store.list().unwrap());
    let again = room.path().join("again.json");
    exchange::export(&target, &again).unwrap();
    assert_eq!(fs::read(&file).unwrap(), fs::read(&again).unwrap(), "the same library gives the same file");
    // A damaged record is mended by an import.
    drop(target);
    fs::write(to.join(format!("{}.json", entries[3].key)), "").unwrap();
    let mut target = Store::open(&to).unwrap();
    assert!(exchange::export(&target, &again).is_err(), "an export is whole or not at all");
    assert_eq!(exchange::import(&mut target, &file).unwrap().mended, 1);
    assert_eq!(target.get(&entries[3].key).unwrap(), entries[3]);
    assert!(target.damaged().is_empty());
}

/// An exchange file of these entries.
fn write_export(file: &Path, entries: &[&Entry]) {
    let values: Vec<serde_json::Value> =
        entries.iter().map(|e| serde_json::from_str(&e.to_text().unwrap()).unwrap()).collect();
    let all = serde_json::json!({ "schema": exchange::EXCHANGE_SCHEMA, "entries": values });
    fs::write(file, all.to_string()).unwrap();
}

/// What an import leaves is sound: successors are there and lead somewhere.
#[test]
fn an_import_brings_no_successor_that_is_absent_or_in_a_circle() {
    let room = tempfile::tempdir().unwrap();
    let file = room.path().join("all.json");
    let [a, b, c] = [entry(1), entry(2), entry(3)];
    let to = |entry: &Entry, successor: &Entry| {
        let successor = Some(successor.key.clone());
        Entry { deprecated: Some(Deprecation { reason: "old".into(), successor }), ..entry.clone() }
    };
    let mut store = Store::open(&room.path().join("library")).unwrap();
    store.put_all(&[a.clone(), b.clone()]).unwrap();
    store.deprecate(&a.key, Some(&b.key), None).unwrap();
    let mut refused = |entries: &[&Entry], words: &str| {
        write_export(&file, entries);
        let message = exchange::import(&mut store, &file).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("nothing was imported"), "{message}");
        assert_eq!(store.keys().len(), 2);
    };
    refused(&[&a, &to(&b, &c)], &format!("entry 2 (`{}`): its successor `{}` is not in", b.key, c.key));
    refused(&[&to(&b, &a)], "its successors lead back to it through");
    refused(&[&c, &to(&b, &b)], "its successors lead back to it;");
    write_export(&file, &[&c, &to(&b, &c)]);
    assert_eq!(exchange::import(&mut store, &file).unwrap().deprecated, 1);
    assert!(exchange::verify(&store).unwrap().is_clean());

    // nor is a beam's hinge put in the place of a column's
    let beam = Entry::new(
        EntryKind::BeamHinge,
        Origin::Submodel,
        c.features.clone(),
        c.provenance.inputs.clone(),
        computed(3, 5, 20),
    )
    .unwrap();
    store.put(&beam).unwrap();
    let message = store.deprecate(&c.key, Some(&beam.key), None).unwrap_err().to_string();
    assert!(message.contains("is of another kind; name one of the same kind"), "{message}");

    // version control can bring what an import does not
    fs::write(store.folder().join(format!("{}.json", b.key)), to(&b, &a).to_text().unwrap()).unwrap();
    let report = exchange::verify(&store).unwrap();
    assert!(report.text.len() == 1 && report.text[0].1.contains("lead back to it"), "{report:?}");
}

#[test]
fn a_bad_import_changes_nothing() {
    let room = tempfile::tempdir().unwrap();
    let file = room.path().join("all.json");
    let mut store = Store::open(&room.path().join("from")).unwrap();
    store.put_all(&[entry(1), entry(2), entry(3)]).unwrap();
    exchange::export(&store, &file).unwrap();
    let text = fs::read_to_string(&file).unwrap();

    let mut target = Store::open(&room.path().join("to")).unwrap();
    let mut expect = |content: &str, words: &str| {
        fs::write(&file, content).unwrap();
        let message = exchange::import(&mut target, &file).unwrap_err().to_string();
        assert!(message.contains(words) && message.contains("nothing was imported"), "{message}");
        assert!(target.keys().is_empty());
    };
    expect(&text[..text.len() - 40], "not JSON");
    expect(&text.replace("fallwerk-library/1", "fallwerk-library/9"), "expected \"fallwerk-library/1\"");
    let last = text.rfind("\"elements\": 5000").unwrap();
    expect(&format!("{}\"elements\": 5001{}", &text[..last], &text[last + 16..]), "entry 3");
    // The same key with another result is a matter for people, not for an import.
    let other = entry_of(entry(2).features, entry(2).provenance.inputs.law.unwrap(), 1, 8);
    target.put(&other).unwrap();
    fs::write(&file, &text).unwrap();
    let message = exchange::import(&mut target, &file).unwrap_err().to_string();
    assert!(message.contains("differs from the one in the library in `axes`"), "{message}");
    assert_eq!(target.keys().len(), 1);
}

/// Two exports put together have entries twice: the same ones count once, and contradictory ones are refused.
#[test]
fn a_key_that_stands_twice_is_taken_once_or_refused() {
    let room = tempfile::tempdir().unwrap();
    let file = room.path().join("all.json");
    let first = entry(2);
    let other = entry_of(first.features.clone(), first.provenance.inputs.law.clone().unwrap(), 1, 8);
    let marked = |reason: &str| {
        let why = Deprecation { reason: reason.to_string(), successor: None };
        Entry { deprecated: Some(why), ..first.clone() }
    };
    let write = |entries: &[&Entry]| write_export(&file, entries);
    let mut store = Store::open(&room.path().join("library")).unwrap();
    write(&[&entry(1), &first, &other]);
    let message = exchange::import(&mut store, &file).unwrap_err().to_string();
    let said = format!("entry 3 (`{}`) differs from entry 2, which has the same key, in `axes`", first.key);
    assert!(message.contains(&said) && message.contains("take one of the two out"), "{message}");
    assert!(store.keys().is_empty());
    write(&[&first, &marked("coarse"), &marked("old"), &first]);
    let report = exchange::import(&mut store, &file).unwrap();
    assert_eq!((report.added, report.unchanged, report.deprecated), (1, 0, 0));
    assert_eq!(store.get(&first.key).unwrap(), marked("coarse"));
    assert_eq!(store.history().unwrap().events.len(), 1);

    let message = store.put_all(&[entry(3), other, first.clone()]).unwrap_err().to_string();
    assert!(message.contains("is given twice with different content"), "{message}");
    assert_eq!(store.keys().len(), 1);
    assert_eq!(store.put_all(&[entry(3), entry(3)]).unwrap(), [Put::Added, Put::Unchanged]);
}

#[test]
fn an_export_replaces_exports_only() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(&room.path().join("library")).unwrap();
    let (file, other) = (room.path().join("all.json"), room.path().join("notes.txt"));
    store.put(&entry(1)).unwrap();
    exchange::export(&store, &file).unwrap();
    store.put(&entry(2)).unwrap();
    assert_eq!(exchange::export(&store, &file).unwrap(), 2);
    fs::write(&other, "not to be lost").unwrap();
    let message = exchange::export(&store, &other).unwrap_err().to_string();
    assert!(message.contains("no export of a library"), "{message}");
    assert_eq!(fs::read_to_string(&other).unwrap(), "not to be lost");
}

/// Among the records an export would be a damaged one; through a link the file that it leads to is written.
#[cfg(unix)]
#[test]
fn an_export_lies_outside_the_library_and_keeps_links() {
    let room = tempfile::tempdir().unwrap();
    let mut store = Store::open(&room.path().join("library")).unwrap();
    store.put(&entry(1)).unwrap();
    let (file, link) = (room.path().join("all.json"), room.path().join("link.json"));
    let inside = store.folder().join("column_hinge/all.json");
    for path in [&inside, &store.folder().join("all.json")] {
        let message = exchange::export(&store, path).unwrap_err().to_string();
        assert!(message.contains("lies in the library") && !path.exists(), "{message}");
    }
    for _ in 0..2 {
        let _ = fs::remove_file(&link);
        std::os::unix::fs::symlink("all.json", &link).unwrap();
        assert_eq!(exchange::export(&store, &link).unwrap(), 1);
        assert!(link.is_symlink() && file.is_file());
    }
    fs::remove_file(&link).unwrap();
    std::os::unix::fs::symlink(&inside, &link).unwrap();
    assert!(exchange::export(&store, &link).is_err(), "nor by way of a link");
    assert!(exchange::verify(&store).unwrap().is_clean());
}

/// Of two libraries with the same entries one has deprecated some: the other learns it, and an older file does not undo it.
#[test]
fn deprecations_travel_and_are_not_undone() {
    let room = tempfile::tempdir().unwrap();
    let (old, new) = (room.path().join("old.json"), room.path().join("new.json"));
    let entries = [entry(1), entry(2), entry(3)];
    let mut here = Store::open(&room.path().join("here")).unwrap();
    let mut there = Store::open(&room.path().join("there")).unwrap();
    here.put_all(&entries).unwrap();
    there.put_all(&entries).unwrap();
    exchange::export(&here, &old).unwrap();
    here.deprecate(&entries[0].key, Some(&entries[1].key), Some("coarse")).unwrap();
    exchange::export(&here, &new).unwrap();

    let report = exchange::import(&mut there, &new).unwrap();
    assert_eq!((report.added, report.unchanged, report.deprecated), (0, 2, 1));
    assert_eq!(there.list().unwrap(), here.list().unwrap());
    let report = exchange::import(&mut there, &old).unwrap();
    assert_eq!((report.added, report.unchanged, report.deprecated), (0, 3, 0));
    assert_eq!(there.get(&entries[0].key).unwrap().deprecated.unwrap().reason, "coarse");
    assert!(exchange::verify(&there).unwrap().is_clean());
}
