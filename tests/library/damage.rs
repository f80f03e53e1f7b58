//! Damage: the working copy may be anything, the text may not.

use super::entry;
use fallwerk::library::{Entry, Opened, Put, Store, StoreError, exchange};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn filled(folder: &Path, count: u32) -> Vec<Entry> {
    let entries: Vec<Entry> = (0..count).map(entry).collect();
    Store::open(folder).unwrap().put_all(&entries).unwrap();
    entries
}

pub fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let mut items: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|i| i.unwrap().path()).collect();
    items.sort();
    for path in items {
        if path.is_dir() { files_below(&path, found) } else { found.push(path) }
    }
}

/// The next number of the generator `splitmix64` (Steele, Lea and Flood 2014).
pub fn splitmix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

pub fn copy_folder(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for item in fs::read_dir(from).unwrap() {
        let path = item.unwrap().path();
        let target = to.join(path.file_name().unwrap());
        if path.is_dir() {
            copy_folder(&path, &target)
        } else {
            fs::copy(&path, &target).map(|_| ()).unwrap()
        }
    }
}

#[test]
fn sixty_random_damages_of_the_working_copy_cost_no_record() {
    let room = tempfile::tempdir().unwrap();
    let master = room.path().join("master");
    let entries = filled(&master, 40);
    let mut state = 7u64;
    let mut below = move |n: usize| (splitmix(&mut state) % n as u64) as usize;
    let mut rebuilt = 0;
    for trial in 0..60 {
        let folder = room.path().join(format!("trial-{trial}"));
        copy_folder(&master, &folder);
        let mut files = Vec::new();
        files_below(&folder.join(".cache/db"), &mut files);
        let victim = &files[below(files.len())];
        let mut bytes = fs::read(victim).unwrap();
        match trial % 3 {
            0 if !bytes.is_empty() => {
                // Damage where data lie: sled's file is mostly zeros behind its end.
                let used = bytes.iter().rposition(|b| *b != 0).map_or(1, |i| i + 1);
                for _ in 0..16 {
                    let at = below(used);
                    bytes[at] ^= 1 << below(8);
                }
                fs::write(victim, &bytes).unwrap();
            }
            1 if !bytes.is_empty() => {
                bytes.truncate(below(bytes.len()));
                fs::write(victim, &bytes).unwrap();
            }
            _ => fs::remove_file(victim).unwrap(),
        }
        let store = Store::open(&folder).unwrap();
        match store.opened() {
            Opened::Rebuilt { set_aside, .. } => {
                rebuilt += 1;
                assert!(*set_aside);
            }
            Opened::Checked => {}
            other => panic!("trial {trial}: {other:?}"),
        }
        for entry in &entries {
            assert_eq!(store.get(&entry.key).unwrap(), *entry, "trial {trial}");
        }
        assert_eq!(store.keys().len(), entries.len());
        assert!(exchange::verify(&store).unwrap().is_clean(), "trial {trial}");
        drop(store);
        assert_eq!(
            *Store::open(&folder).unwrap().opened(),
            Opened::Checked,
            "trial {trial}: mended for good"
        );
        fs::remove_dir_all(&folder).unwrap();
    }
    println!("{rebuilt} of 60 copies were built anew");
    assert!(rebuilt >= 30, "the damage of this test must matter: {rebuilt}");
}

#[test]
fn a_flipped_digit_of_a_text_record_is_named_and_refused() {
    let room = tempfile::tempdir().unwrap();
    let entries = filled(room.path(), 6);
    let path = room.path().join(format!("{}.json", entries[2].key));
    let text = fs::read_to_string(&path).unwrap();
    let at = text.find("\"axial_n_m\": 3").unwrap() + "\"axial_n_m\": ".len();
    let damaged = format!("{}4{}", &text[..at], &text[at + 1..]);
    fs::write(&path, &damaged).unwrap();

    let store = Store::open(room.path()).unwrap();
    let error = store.get(&entries[2].key).unwrap_err();
    assert!(matches!(&error, StoreError::Damaged { path: named, .. } if *named == path), "{error}");
    assert!(error.to_string().contains("checksum"), "{error}");
    assert_eq!(store.damaged().len(), 1);
    assert_eq!(store.list().unwrap().len(), 5, "the others stay in use");
    let report = exchange::verify(&store).unwrap();
    assert_eq!((report.records, report.text.len(), report.cache.len()), (6, 1, 0));
    assert_eq!(report.text[0].0, path);
    assert_eq!((store.keys().len(), store.usable_keys().len()), (6, 5));
    drop(store);
    // whoever computes it anew mends it
    let mut store = Store::open(room.path()).unwrap();
    assert_eq!(store.put(&entries[2]).unwrap(), Put::Replaced);
    assert_eq!(store.usable_keys(), store.keys());
    drop(store);

    fs::write(&path, text).unwrap();
    let store = Store::open(room.path()).unwrap();
    assert_eq!(store.get(&entries[2].key).unwrap(), entries[2]);
}

#[test]
fn every_kind_of_text_damage_is_found() {
    let room = tempfile::tempdir().unwrap();
    let entries = filled(room.path(), 2);
    let path = room.path().join(format!("{}.json", entries[0].key));
    let text = fs::read_to_string(&path).unwrap();
    let other = entries[1].to_text().unwrap();
    let damages: [(&str, Vec<u8>, &str); 6] = [
        ("empty", vec![], "not JSON"),
        ("half", text.as_bytes()[..text.len() / 2].to_vec(), "not JSON"),
        ("no text", vec![0xff; 100], "not UTF-8"),
        ("another record", other.into_bytes(), "it holds the record of"),
        (
            "newer",
            text.replace("\"schema\": 2", "\"schema\": 3").into_bytes(),
            "this program reads schema 1 to 2",
        ),
        ("no checksum", text.replace("\"checksum\"", "\"check\"").into_bytes(), "no checksum"),
    ];
    for (name, bytes, expected) in damages {
        fs::write(&path, bytes).unwrap();
        let store = Store::open(room.path()).unwrap();
        let message = store.get(&entries[0].key).unwrap_err().to_string();
        assert!(message.contains(expected) && message.contains(path.to_str().unwrap()), "{name}: {message}");
        assert_eq!(store.get(&entries[1].key).unwrap(), entries[1], "{name}");
    }
    // Layout is not content: a record that git or an editor has re-indented is whole.
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    fs::write(&path, serde_json::to_string(&value).unwrap()).unwrap();
    assert_eq!(Store::open(room.path()).unwrap().get(&entries[0].key).unwrap(), entries[0]);
}

#[test]
fn a_missing_or_foreign_working_copy_is_built_anew() {
    let room = tempfile::tempdir().unwrap();
    let entries = filled(room.path(), 5);
    fs::remove_dir_all(room.path().join(".cache")).unwrap();
    let store = Store::open(room.path()).unwrap();
    assert_eq!(*store.opened(), Opened::Rebuilt { why: "there was none".into(), set_aside: false });
    drop(store);
    // The copy is a file, not a database.
    fs::remove_dir_all(room.path().join(".cache/db")).unwrap();
    fs::write(room.path().join(".cache/db"), "no database").unwrap();
    let store = Store::open(room.path()).unwrap();
    assert!(matches!(store.opened(), Opened::Rebuilt { set_aside: true, .. }), "{:?}", store.opened());
    assert!(entries.iter().all(|e| store.get(&e.key).unwrap() == *e));
    drop(store);
    // Text that came or went behind our back (version control) is seen.
    fs::remove_file(room.path().join(format!("{}.json", entries[0].key))).unwrap();
    let store = Store::open(room.path()).unwrap();
    assert!(matches!(store.get(&entries[0].key), Err(StoreError::NotFound { .. })));
    assert_eq!(store.list().unwrap().len(), 4);
    drop(store);
    // The working copy may lie elsewhere.
    let elsewhere = tempfile::tempdir().unwrap();
    let store = Store::open_with_cache(room.path(), elsewhere.path()).unwrap();
    assert!(elsewhere.path().join("db").exists() && store.list().unwrap().len() == 4);
}

#[test]
fn the_second_to_open_reads_text_and_cannot_write() {
    let room = tempfile::tempdir().unwrap();
    let entries = filled(room.path(), 3);
    let mut first = Store::open(room.path()).unwrap();
    let mut second = Store::open(room.path()).unwrap();
    assert!(matches!(second.opened(), Opened::TextOnly { writable: false, .. }), "{:?}", second.opened());
    assert!(entries.iter().all(|e| second.get(&e.key).unwrap() == *e));
    let refused = second.put(&entry(50)).unwrap_err();
    assert!(refused.to_string().contains("another process has it open"), "{refused}");
    assert!(matches!(second.rebuild(), Err(StoreError::ReadOnly { .. })));
    first.put(&entry(50)).unwrap();
    drop((first, second));
    assert_eq!(*Store::open(room.path()).unwrap().opened(), Opened::Checked, "the lock is given back");
}

/// Whoever only reads, for however long, takes no lock: others write, and what they replace is read old or new.
#[test]
fn who_reads_does_not_keep_others_from_writing() {
    let room = tempfile::tempdir().unwrap();
    let entries = filled(room.path(), 3);
    fs::remove_dir_all(room.path().join(".cache")).unwrap();
    let mut reader = Store::open_to_read(room.path()).unwrap();
    assert!(*reader.opened() == Opened::ToRead && !room.path().join(".cache").exists());
    let [first, second] = two_results(1);
    let mut writer = Store::open(room.path()).unwrap();
    assert_eq!(reader.get(&first.key).unwrap(), first);
    assert_eq!(writer.put_all(&[second.clone(), entry(50)]).unwrap(), [Put::Replaced, Put::Added]);
    assert_eq!(reader.get(&first.key).unwrap(), second);
    assert_eq!(reader.list().unwrap().len(), entries.len(), "what came later is not seen");
    let refused = reader.put(&entry(51)).unwrap_err().to_string();
    assert!(refused.contains("can only be read: it was opened to be read"), "{refused}");
}

#[test]
fn a_write_that_was_cut_off_leaves_the_old_record() {
    let room = tempfile::tempdir().unwrap();
    let entries = filled(room.path(), 3);
    // What a kill between writing and renaming leaves: a temporary file; and between text and copy: new text.
    let folder = room.path().join("column_hinge");
    let leftover = folder.join(".fallwerk-tmp-1-0");
    fs::write(&leftover, "{\"half\": ").unwrap();
    let newer = entry(9);
    fs::write(room.path().join(format!("{}.json", newer.key)), newer.to_text().unwrap()).unwrap();
    let store = Store::open(room.path()).unwrap();
    assert!(!leftover.exists());
    assert!(matches!(store.opened(), Opened::Rebuilt { .. }));
    assert_eq!(store.get(&newer.key).unwrap(), newer);
    assert!(entries.iter().all(|e| store.get(&e.key).unwrap() == *e));
}

/// Names the folder in which the test below, run as a child process, writes until it is killed.
const CHILD_FOLDER: &str = "FALLWERK_TEST_WRITER_FOLDER";

fn two_results(seed: u32) -> [Entry; 2] {
    let first = entry(seed);
    let second =
        super::entry_of(first.features.clone(), first.provenance.inputs.law.clone().unwrap(), 1, seed + 1);
    [first, second]
}

#[test]
fn a_killed_writer_leaves_each_record_old_or_new() {
    if let Some(folder) = std::env::var_os(CHILD_FOLDER) {
        let mut store = Store::open(Path::new(&folder)).unwrap();
        for round in 0.. {
            for seed in 0..3 {
                store.put(&two_results(seed)[(round + 1) % 2]).unwrap();
                fs::write(Path::new(&folder).join(".rounds"), round.to_string()).unwrap();
            }
        }
    }
    let room = tempfile::tempdir().unwrap();
    for seed in 0..3 {
        Store::open(room.path()).unwrap().put(&two_results(seed)[0]).unwrap();
    }
    for kill in 0..8u64 {
        let progress = room.path().join(".rounds");
        let _ = fs::remove_file(&progress);
        let mut child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "library::damage::a_killed_writer_leaves_each_record_old_or_new"])
            .env(CHILD_FOLDER, room.path())
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let start = std::time::Instant::now();
        while !progress.exists() {
            assert!(start.elapsed().as_secs() < 60, "the writer never wrote");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        std::thread::sleep(std::time::Duration::from_millis(20 + 13 * kill));
        child.kill().unwrap();
        child.wait().unwrap();
        let store = Store::open(room.path()).unwrap();
        assert!(!matches!(store.opened(), Opened::TextOnly { .. }), "the lock of a dead process is free");
        assert!(exchange::verify(&store).unwrap().is_clean());
        for seed in 0..3 {
            let results = two_results(seed);
            assert!(results.contains(&store.get(&results[0].key).unwrap()), "kill {kill}, record {seed}");
        }
    }
}

/// A named pipe in the place of a record would be read without end; a folder, or a link to nothing, cannot be read at all.
/// Each is named, and the other records stay in use.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_named_and_the_others_stay_in_use() {
    let room = tempfile::tempdir().unwrap();
    let folder = room.path().join("library");
    let entries = filled(&folder, 4);
    let paths: Vec<PathBuf> = entries.iter().map(|e| folder.join(format!("{}.json", e.key))).collect();
    paths[..3].iter().for_each(|path| fs::remove_file(path).unwrap());
    assert!(std::process::Command::new("mkfifo").arg(&paths[0]).status().unwrap().success());
    fs::create_dir(&paths[1]).unwrap();
    std::os::unix::fs::symlink(room.path().join("absent"), &paths[2]).unwrap();
    let mut store = Store::open(&folder).unwrap();
    let damaged: BTreeMap<PathBuf, String> = store.damaged().into_iter().collect();
    assert_eq!(damaged.len(), 3);
    for (path, words) in paths.iter().zip(["no ordinary file", "no ordinary file", "it cannot be read: "]) {
        assert!(damaged[path].contains(words), "{damaged:?}");
    }
    assert_eq!(store.list().unwrap(), entries[3..]);
    let error = store.get(&entries[0].key).unwrap_err().to_string();
    assert!(error.contains("it is no ordinary file") && error.contains(&entries[0].key), "{error}");
    assert_eq!(exchange::verify(&store).unwrap().text.len(), 3);
    // a pipe and a link are replaced by the record, a folder is not, and stays what it is
    store.put(&entries[0]).unwrap();
    store.put(&entries[2]).unwrap();
    assert!(matches!(store.put(&entries[1]), Err(StoreError::Io { .. })) && paths[1].is_dir());
    drop(store);
    fs::remove_dir(&paths[1]).unwrap();
    let mut store = Store::open(&folder).unwrap();
    store.put(&entries[1]).unwrap();
    assert_eq!(store.list().unwrap().len(), 4);
    assert!(exchange::verify(&store).unwrap().is_clean());
}
