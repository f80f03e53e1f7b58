//! Kills, damage, a full disk and a second process, with the real program: every entry that a command acknowledged is there
//! and exact afterwards, or the damage is named and `rebuild` mends it.
//!
//! The short form runs always; the full size with
//! `cargo test --release library::torture -- --ignored --nocapture`.

use super::damage::{copy_folder, files_below, splitmix};
use super::entry;
use fallwerk::library::add::entry_of_files;
use fallwerk::library::journal::Journal;
use fallwerk::library::meta::EXAMPLE;
use fallwerk::library::{Entry, Opened, Store, exchange};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_fallwerk");

fn fallwerk(library: &Path, words: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.args(["library", "--library"]).arg(library).args(words);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn told(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// A generator of random numbers below a limit.
fn random(seed: u64) -> impl FnMut(usize) -> usize {
    let mut state = seed;
    move |n| (splitmix(&mut state) % n as u64) as usize
}

/// Curves to add, export files to import, and the entries that they make.
struct Supplies {
    curves: Vec<(PathBuf, PathBuf, Entry)>,
    exports: Vec<(PathBuf, Vec<Entry>)>,
}

impl Supplies {
    fn make(room: &Path, count: u32) -> Self {
        let curves = (0..count).map(|i| {
            let (curve, meta) = (room.join(format!("{i}.csv")), room.join(format!("{i}.toml")));
            let rows: String =
                (0..12).map(|k| format!("{},{}\n", 4 * k, (k * (200 + i)) / (4 + k))).collect();
            fs::write(&curve, format!("rotation [mrad], moment [kN m]\n{rows}")).unwrap();
            let force = format!("axial_force = \"{} kN\"", 10 * i);
            fs::write(&meta, EXAMPLE.replace("# axial_force = \"600 kN\"", &force)).unwrap();
            let made = entry_of_files(&curve, &meta).unwrap_or_else(|e| panic!("{}", e[0]));
            (curve, meta, made)
        });
        let curves = curves.collect();
        let exports = (0..count).map(|i| {
            let entries: Vec<Entry> = (0..6).map(|k| entry(1000 + 6 * i + k)).collect();
            let (folder, file) = (room.join(format!("store-{i}")), room.join(format!("{i}.json")));
            let mut store = Store::open(&folder).unwrap();
            store.put_all(&entries).unwrap();
            exchange::export(&store, &file).unwrap();
            (file, entries)
        });
        Self { curves, exports: exports.collect() }
    }
}

/// What must be there, and what may be.
#[derive(Default)]
struct Known {
    acknowledged: BTreeMap<String, Entry>,
    begun: BTreeMap<String, Entry>,
}

impl Known {
    /// Checks the library after something happened to it; returns whether the working copy had to be built anew.
    fn check(&self, library: &Path, what: &str) -> bool {
        let store = Store::open(library).unwrap();
        let rebuilt = matches!(store.opened(), Opened::Rebuilt { set_aside: true, .. });
        assert!(!matches!(store.opened(), Opened::TextOnly { .. }), "{what}: {:?}", store.opened());
        let report = exchange::verify(&store).unwrap();
        assert!(report.is_clean(), "{what}: {report:?}");
        for (key, entry) in &self.acknowledged {
            assert_eq!(store.get(key).unwrap(), *entry, "{what}");
        }
        for key in store.keys() {
            let entry = self.acknowledged.get(&key).or(self.begun.get(&key));
            assert_eq!(Some(&store.get(&key).unwrap()), entry, "{what}: an entry from nowhere");
        }
        let history = store.history().unwrap();
        assert!(history.damaged_lines.is_empty(), "{what}: {history:?}");
        let noted = |key: &String| history.events.iter().any(|e| e.key == *key);
        assert!(self.acknowledged.keys().all(noted), "{what}: an acknowledged entry without an event");
        rebuilt
    }
}

/// Figures of a run.
#[derive(Debug, Default)]
struct Figures {
    kills_before_the_end: usize,
    unacknowledged_but_there: usize,
    torn_lines: usize,
    rebuilt: usize,
    entries: usize,
}

fn kills(count: usize, seed: u64) -> Figures {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    let supplies = Supplies::make(room.path(), count.div_ceil(2) as u32 + 1);
    let mut below = random(seed);
    let mut known = Known::default();
    let mut figures = Figures::default();
    // How long a command takes here and now.
    let start = Instant::now();
    assert!(
        fallwerk(&room.path().join("probe"), &["import", supplies.exports[0].0.to_str().unwrap()])
            .output()
            .unwrap()
            .status
            .success()
    );
    let usual_us = start.elapsed().as_micros().max(2000) as usize;
    for kill in 0..count {
        let (mut command, entries) = if kill % 2 == 0 {
            let (curve, meta, entry) = &supplies.curves[kill / 2];
            let words = ["add", curve.to_str().unwrap(), "--meta", meta.to_str().unwrap()];
            (fallwerk(&library, &words), vec![entry.clone()])
        } else {
            let (file, entries) = &supplies.exports[kill / 2];
            (fallwerk(&library, &["import", file.to_str().unwrap()]), entries.clone())
        };
        known.begun.extend(entries.iter().map(|e| (e.key.clone(), e.clone())));
        let mut child = command.spawn().unwrap();
        std::thread::sleep(Duration::from_micros(below(2 * usual_us) as u64));
        let _ = child.kill();
        let output = child.wait_with_output().unwrap();
        if output.status.success() {
            known.acknowledged.extend(entries.into_iter().map(|e| (e.key.clone(), e)));
        } else {
            figures.kills_before_the_end += 1;
            assert_eq!(output.status.code(), None, "{}", told(&output));
            let there = |e: &Entry| library.join(format!("{}.json", e.key)).exists();
            figures.unacknowledged_but_there += usize::from(entries.iter().any(there));
        }
        if !library.is_dir() {
            continue;
        }
        figures.torn_lines += usize::from(Journal::of(&library).read().unwrap().torn_bytes > 0);
        figures.rebuilt += usize::from(known.check(&library, &format!("kill {kill}")));
    }
    figures.entries = known.acknowledged.len();
    figures
}

/// Damage to the files of sled: bit flips, truncation, deletion. Returns how many copies were built anew and what was said.
fn corruptions(count: usize, seed: u64) -> (usize, BTreeMap<String, usize>) {
    let room = tempfile::tempdir().unwrap();
    let master = room.path().join("master");
    let entries: Vec<Entry> = (0..40).map(entry).collect();
    let mut known = Known::default();
    let mut store = Store::open(&master).unwrap();
    store.put_all(&entries).unwrap();
    drop(store);
    known.acknowledged.extend(entries.into_iter().map(|e| (e.key.clone(), e)));
    let mut below = random(seed);
    let mut reasons: BTreeMap<String, usize> = BTreeMap::new();
    let mut rebuilt = 0;
    for trial in 0..count {
        let library = room.path().join(format!("trial-{trial}"));
        copy_folder(&master, &library);
        let mut files = Vec::new();
        files_below(&library.join(".cache/db"), &mut files);
        for _ in 0..=below(3) {
            let victim = &files[below(files.len())];
            let Ok(mut bytes) = fs::read(victim) else { continue };
            let used = bytes.iter().rposition(|b| *b != 0).map_or(0, |i| i + 1);
            match below(3) {
                0 if used > 0 => {
                    (0..=below(16)).for_each(|_| bytes[below(used)] ^= 1 << below(8));
                    fs::write(victim, &bytes).unwrap();
                }
                1 if !bytes.is_empty() => {
                    bytes.truncate(below(bytes.len()));
                    fs::write(victim, &bytes).unwrap();
                }
                _ => fs::remove_file(victim).unwrap(),
            }
        }
        // A command that looks, which does without the copy, then one that checks.
        let output = fallwerk(&library, &["list"]).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "trial {trial}: {}", told(&output));
        assert!(output.stderr.is_empty(), "trial {trial}: {}", told(&output));
        let output = fallwerk(&library, &["verify"]).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "trial {trial}: {}", told(&output));
        let notes = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!notes.contains("panicked"), "trial {trial}: {notes}");
        if let Some((_, why)) = notes.trim().split_once("text records: ") {
            rebuilt += 1;
            let class = why.split(['(', '`']).next().unwrap_or(why).trim().to_string();
            *reasons.entry(class).or_default() += 1;
        }
        let again = known.check(&library, &format!("trial {trial}"));
        assert!(!again, "trial {trial}: mended for good");
        fs::remove_dir_all(&library).unwrap();
    }
    (rebuilt, reasons)
}

/// A disk that takes files of `limit_kib` only: everything larger fails to be written.
fn with_limit(limit_kib: u32, library: &Path, words: &[&str]) -> Output {
    let script = format!("trap '' XFSZ; ulimit -f {limit_kib}; exec \"$@\"");
    let mut command = Command::new("timeout");
    command
        .args(["60", "bash", "-c", &script, "bash", PROGRAM, "library", "--library"])
        .arg(library)
        .args(words);
    command.stdin(Stdio::null()).output().unwrap()
}

fn full_disk(limits_kib: &[u32]) -> BTreeMap<&'static str, usize> {
    let room = tempfile::tempdir().unwrap();
    let supplies = Supplies::make(room.path(), 1 + limits_kib.len() as u32);
    let mut outcomes: BTreeMap<&'static str, usize> = BTreeMap::new();
    for (i, limit) in limits_kib.iter().enumerate() {
        let library = room.path().join(format!("library-{limit}"));
        let mut known = Known::default();
        let (curve, meta, first) = &supplies.curves[0];
        let add = |c: &Path, m: &Path| {
            ["add".to_string(), c.display().to_string(), "--meta".to_string(), m.display().to_string()]
        };
        let words = add(curve, meta);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        assert!(fallwerk(&library, &words).output().unwrap().status.success());
        known.acknowledged.insert(first.key.clone(), first.clone());
        let (file, entries) = &supplies.exports[i];
        known.begun.extend(entries.iter().map(|e| (e.key.clone(), e.clone())));
        let output = with_limit(*limit, &library, &["import", file.to_str().unwrap()]);
        let words = told(&output);
        let outcome = match output.status.code() {
            Some(0) => {
                known.acknowledged.extend(entries.iter().map(|e| (e.key.clone(), e.clone())));
                "done, with or without a working copy"
            }
            Some(2) => {
                assert!(words.contains("error: "), "{words}");
                "refused with a message"
            }
            other => panic!("limit {limit} KiB: exit code {other:?}: {words}"),
        };
        *outcomes.entry(outcome).or_default() += 1;
        known.check(&library, &format!("limit {limit} KiB"));
        // With room again the same command does what it did not.
        assert!(fallwerk(&library, &["import", file.to_str().unwrap()]).output().unwrap().status.success());
        known.acknowledged.extend(entries.iter().map(|e| (e.key.clone(), e.clone())));
        known.check(&library, &format!("after limit {limit} KiB"));
    }
    outcomes
}

#[test]
fn ten_kills_lose_nothing_that_was_acknowledged() {
    println!("{:?}", kills(10, 11));
}

#[test]
fn twenty_corruptions_of_the_working_copy_are_named_and_mended() {
    let (rebuilt, reasons) = corruptions(20, 5);
    println!("{rebuilt} of 20 built anew: {reasons:?}");
    assert!(rebuilt >= 10, "the damage of this test must matter: {rebuilt}");
}

#[test]
fn a_full_disk_is_said_and_costs_nothing_that_was_there() {
    let outcomes = full_disk(&[4, 64, 600]);
    println!("{outcomes:?}");
    assert!(outcomes.contains_key("refused with a message"), "{outcomes:?}");
}

#[test]
fn a_second_process_is_told_who_holds_the_library_before_it_computes() {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    let mut store = Store::open(&library).unwrap();
    store.put(&entry(1)).unwrap();
    let building = concat!(env!("CARGO_MANIFEST_DIR"), "/buildings/three-storey-frame.toml");
    for words in [&["derive", building][..], &["deprecate", &entry(1).key]] {
        let output = fallwerk(&library, words).output().unwrap();
        let said = told(&output);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("process {}, `", std::process::id())), "{said}");
        assert!(said.contains("can only be read: another process has it open"), "{said}");
        assert!(!said.contains("push "), "nothing is computed: {said}");
    }
    let output = fallwerk(&library, &["list"]).output().unwrap();
    assert!(output.status.success() && told(&output).contains(&entry(1).key), "others may look");
    assert!(output.stderr.is_empty(), "and nothing is the matter: {}", told(&output));
}

/// Kills of `derive`, which computes for a while between its writes. Returns how many runs came to their end first, and how
/// many entries were acknowledged.
fn derive_kills(count: usize, seed: u64) -> (usize, usize) {
    let room = tempfile::tempdir().unwrap();
    let library = room.path().join("library");
    fs::create_dir(&library).unwrap();
    let building = concat!(env!("CARGO_MANIFEST_DIR"), "/buildings/three-storey-frame.toml");
    let mut below = random(seed);
    let mut acknowledged: BTreeMap<String, Entry> = BTreeMap::new();
    let (mut runs_done, mut entries) = (0, 0);
    for kill in 0..count {
        let mut child = fallwerk(&library, &["derive", building]).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(below(25_000) as u64));
        let _ = child.kill();
        let said = told(&child.wait_with_output().unwrap());
        let store = Store::open(&library).unwrap();
        assert!(exchange::verify(&store).unwrap().is_clean(), "kill {kill}");
        for line in said.lines().filter_map(|l| l.strip_prefix("added ")) {
            acknowledged.insert(line.to_string(), store.get(line).unwrap());
        }
        for (key, entry) in &acknowledged {
            assert_eq!(store.get(key).unwrap(), *entry, "kill {kill}");
        }
        runs_done += usize::from(said.contains("were there already"));
        entries += said.lines().filter(|l| l.starts_with("added ")).count();
        if acknowledged.len() == 3 {
            // All that the building needs: begin again with an empty library.
            acknowledged.clear();
            drop(store);
            fs::remove_dir_all(&library).unwrap();
            fs::create_dir(&library).unwrap();
        }
    }
    (runs_done, entries)
}

#[test]
#[ignore = "minutes; the figures stand in docs/library.md"]
fn full_size() {
    println!("kills: {:?}", kills(200, 2026));
    let (rebuilt, reasons) = corruptions(200, 2027);
    println!("corruptions: {rebuilt} of 200 built anew: {reasons:#?}");
    let limits: Vec<u32> = (0..40).map(|i| 1 + i * i).collect();
    println!("full disk, {} limits: {:?}", limits.len(), full_disk(&limits));
}

#[test]
#[ignore = "minutes; the figures stand in docs/library.md"]
fn full_size_derive() {
    println!("derive, 12 kills: (runs done, entries) {:?}", derive_kills(12, 2028));
}
