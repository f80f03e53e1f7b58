//! Verification of records, working copy and journal, and the exchange of whole libraries as one JSON file.

use super::entry::Entry;
use super::error::StoreError;
use super::journal::Happening;
use super::store::{Put, Store};
use super::succession;
use super::text::Manifest;
use crate::base::hash::{ContentHash, readable_json};
use crate::base::output::{is_within, write_atomic};
use serde::Serialize;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Format of an exchange file.
pub const EXCHANGE_SCHEMA: &str = "fallwerk-library/1";

/// What [`verify`] found.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct VerifyReport {
    /// Number of text records.
    pub records: usize,
    /// Text records with a fault: file and what is wrong.
    pub text: Vec<(PathBuf, String)>,
    /// Differences of the working copy.
    pub cache: Vec<String>,
    /// Damage of the journal.
    pub journal: Vec<String>,
    /// Number of records that came or changed without the journal; the next command that writes notes them.
    pub untold: usize,
    /// Keys whose records went without the journal; the next command that writes notes them.
    pub gone: Vec<String>,
    /// Keys that the journal has noted as missing.
    pub missing: Vec<String>,
}

impl VerifyReport {
    /// Whether nothing was found.
    pub fn is_clean(&self) -> bool {
        self.faults() == 0
    }

    /// Number of faults. A record that is gone is one until the journal has noted it.
    pub fn faults(&self) -> usize {
        self.text.len() + self.cache.len() + self.journal.len() + self.gone.len()
    }
}

/// What [`import`] did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct ImportReport {
    /// New records.
    pub added: usize,
    /// Records that were there already.
    pub unchanged: usize,
    /// Damaged records that were mended.
    pub mended: usize,
    /// Entries that are deprecated there, and now here.
    pub deprecated: usize,
}

/// Reads every text record from the disk and compares each record of the working copy with it.
///
/// # Errors
/// If the library folder cannot be read.
pub fn verify(store: &Store) -> Result<VerifyReport, StoreError> {
    let files = store.text().read_all()?;
    let mut report = VerifyReport { records: files.len(), ..VerifyReport::default() };
    let mut manifest = Manifest::new();
    let mut good = BTreeMap::new();
    for file in &files {
        manifest.insert(file.key.clone(), ContentHash::of_bytes(&file.bytes));
        match store.text().entry_in(file) {
            Ok(entry) => {
                good.insert(file.key.clone(), entry);
            }
            Err(what) => report.text.push((store.text().path_of(&file.key), what)),
        }
    }
    let successors = good.iter().map(|(key, entry)| (key.clone(), successor(entry))).collect();
    let faults = succession::faults(&successors).into_iter();
    report.text.extend(faults.map(|(key, what)| (store.text().path_of(&key), what)));
    let history = store.history()?;
    let lines = history.damaged_lines.iter();
    report.journal = lines.map(|line| format!("line {line} does not match its checksum")).collect();
    for event in store.untold()? {
        match event.what {
            Happening::Missing => report.gone.push(event.key),
            _ => report.untold += 1,
        }
    }
    report.missing = history.missing();
    if let Some(cache) = store.cache() {
        match cache.faults(&manifest, |key| good.contains_key(key)) {
            Ok(faults) => report.cache = faults,
            Err(fault) => report.cache.push(fault),
        }
    }
    Ok(report)
}

/// Writes all entries into one file outside the library; returns their number. An older export is replaced, another file is not;
/// where the path is a link, the file that it leads to is written.
///
/// # Errors
/// If a record is damaged (an export is whole or not at all), or the file cannot be written.
pub fn export(store: &Store, path: &Path) -> Result<usize, StoreError> {
    let path = &linked(path);
    if is_within(path, store.folder()) {
        return Err(StoreError::Inside { path: path.to_path_buf() });
    }
    if path.is_file() && !is_export(path) {
        return Err(StoreError::Foreign { path: path.to_path_buf() });
    }
    if let Some((path, what)) = store.damaged().into_iter().next() {
        return Err(StoreError::Damaged { path, what });
    }
    let mut entries = Vec::new();
    for entry in store.list()? {
        let invalid =
            |e: serde_json::Error| StoreError::Invalid { key: entry.key.clone(), what: e.to_string() };
        let text = entry.to_text().map_err(invalid)?;
        entries.push(serde_json::from_str::<Value>(&text).map_err(invalid)?);
    }
    let count = entries.len();
    let text = readable_json(&json!({ "schema": EXCHANGE_SCHEMA, "entries": entries }))
        .map_err(|e| StoreError::Invalid { key: String::new(), what: e.to_string() })?;
    write_atomic(path, text.as_bytes()).map_err(StoreError::io(path))?;
    Ok(count)
}

/// What a path leads to if it is a link, also where nothing is there yet; else the path.
fn linked(path: &Path) -> PathBuf {
    let target = fs::read_link(path).ok().map(|to| path.parent().unwrap_or(Path::new("")).join(to));
    path.canonicalize().ok().or(target).filter(|_| path.is_symlink()).unwrap_or_else(|| path.to_path_buf())
}

/// Whether a file is an export, so far as its last bytes tell: keys are sorted, and `schema` is the last.
fn is_export(path: &Path) -> bool {
    let text = fs::read(path).unwrap_or_default();
    let tail = String::from_utf8_lossy(&text[text.len().saturating_sub(100)..]).into_owned();
    text.is_empty() || tail.contains(EXCHANGE_SCHEMA)
}

/// Takes over the entries of an exchange file. All are checked first: if one is damaged, or a key
/// is held here or stands twice with other content, or a successor would be absent, of another kind or in a circle, nothing
/// is imported. What is deprecated on either side stays so; where
/// both are, the words of this library hold, and in the file those that come first.
///
/// # Errors
/// [`StoreError::Import`] with the first fault, or what [`Store::put_all`] reports.
pub fn import(store: &mut Store, path: &Path) -> Result<ImportReport, StoreError> {
    let refuse = |what: String| StoreError::Import { path: path.to_path_buf(), what };
    let text = fs::read_to_string(path).map_err(StoreError::io(path))?;
    let mut report = ImportReport::default();
    let mut entries: Vec<Entry> = Vec::new();
    let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
    for (number, mut entry) in entries_of(&text).map_err(refuse)? {
        match store.get(&entry.key) {
            Ok(held) => {
                if let Some(parts) = differing_parts(&held, &entry) {
                    return Err(refuse(format!(
                        "entry {number} (`{}`) differs from the one in the library in {parts}; take it out of the file, or import into another \
                         folder (--library) and compare",
                        entry.key
                    )));
                }
                if held.deprecated.is_some() {
                    entry = held;
                } else if entry.deprecated.is_some() {
                    report.deprecated += 1;
                }
            }
            Err(StoreError::Damaged { .. }) => report.mended += 1,
            Err(_) => {}
        }
        numbers.insert(entry.key.clone(), number);
        entries.push(entry);
    }
    if let Some((key, what)) = new_fault(store, &entries) {
        let place = numbers.get(&key).map_or("of the library".to_string(), usize::to_string);
        return Err(refuse(format!("entry {place} (`{key}`): {what}")));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let done = store.put_as(&entries, Some(Happening::Imported), &format!("from {name}"))?;
    report.added = done.iter().filter(|d| **d == Put::Added).count();
    report.unchanged = done.iter().filter(|d| **d == Put::Unchanged).count();
    Ok(report)
}

/// The entries of an exchange file, each key once, with their numbers in it from 1.
fn entries_of(text: &str) -> Result<Vec<(usize, Entry)>, String> {
    let mut value: Value = serde_json::from_str(text).map_err(|e| format!("not JSON: {e}"))?;
    if value["schema"] != EXCHANGE_SCHEMA {
        return Err(format!("schema is {}, expected \"{EXCHANGE_SCHEMA}\"", value["schema"]));
    }
    let Value::Array(items) = value["entries"].take() else {
        return Err("has no list `entries`".to_string());
    };
    let mut entries: Vec<(usize, Entry)> = Vec::with_capacity(items.len());
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    for (number, item) in (1..).zip(items) {
        let name = item["key"].as_str().unwrap_or("?").to_string();
        let entry = Entry::from_value(item).map_err(|e| format!("entry {number} (`{name}`): {e}"))?;
        let Some(&place) = places.get(&name) else {
            places.insert(name, entries.len());
            entries.push((number, entry));
            continue;
        };
        let (first, held) = &mut entries[place];
        if let Some(parts) = differing_parts(held, &entry) {
            return Err(format!(
                "entry {number} (`{name}`) differs from entry {first}, which has the same key, in {parts}; take one of the two out of the file"
            ));
        }
        held.deprecated = held.deprecated.take().or(entry.deprecated);
    }
    Ok(entries)
}

/// The key of the successor of a deprecated entry.
fn successor(entry: &Entry) -> Option<String> {
    entry.deprecated.as_ref().and_then(|d| d.successor.clone())
}

/// The first fault that the successors have with these entries, and not without them.
fn new_fault(store: &Store, entries: &[Entry]) -> Option<(String, String)> {
    let before = store.successors();
    let mut after = before.clone();
    after.extend(entries.iter().map(|entry| (entry.key.clone(), successor(entry))));
    let held = succession::faults(&before);
    succession::faults(&after).into_iter().find(|fault| !held.contains(fault))
}

/// The names of the parts in which two entries of one key differ, apart from what is said of their use; `None`: nowhere.
fn differing_parts(a: &Entry, b: &Entry) -> Option<String> {
    let plain = |entry: &Entry| {
        let entry = Entry { deprecated: None, ..entry.clone() };
        serde_json::to_value(entry).unwrap_or_default()
    };
    let (a, b) = (plain(a), plain(b));
    let names: BTreeSet<&String> =
        [&a, &b].into_iter().filter_map(Value::as_object).flat_map(|o| o.keys()).collect();
    let differing: Vec<String> =
        names.into_iter().filter(|name| a[*name] != b[*name]).map(|name| format!("`{name}`")).collect();
    (!differing.is_empty()).then(|| differing.join(", "))
}
