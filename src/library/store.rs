//! The store: text records as the truth, a checked working copy beside them.

use super::cache::{self, Cache};
use super::entry::{Deprecation, Entry, EntryKind, Features, Origin, REASON_LIMIT, RECORD_LIMIT_BYTES};
use super::error::StoreError;
use super::journal::{Happening, Journal};
use super::key;
use super::lock::Lock;
use super::succession::{self, Successors};
use super::text::{Manifest, TextFile, TextFolder};
use crate::base::hash::ContentHash;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// How the store was opened.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Opened {
    /// The working copy agrees with the text.
    Checked,
    /// The working copy was built from the text.
    Rebuilt {
        /// Why.
        why: String,
        /// Whether an older copy was set aside (as `db.bad`).
        set_aside: bool,
    },
    /// No working copy: records are read from their files.
    TextOnly {
        /// Why.
        why: String,
        /// Whether records can be written.
        writable: bool,
    },
    /// To be read only: records are read from their files, and nothing is locked or built.
    ToRead,
}

/// What a put did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Put {
    /// A new record.
    Added,
    /// The same record was there.
    Unchanged,
    /// A record of the same inputs with other results was replaced.
    Replaced,
}

/// What queries need of each usable record.
pub(super) struct Indexed {
    pub(super) kind: EntryKind,
    pub(super) origin: Origin,
    pub(super) features: Features,
    pub(super) submodel_version: u32,
    pub(super) deprecated: bool,
    /// Key of its successor, if it is deprecated.
    pub(super) successor: Option<String>,
    /// Hash of the record's content.
    pub(super) content: Option<ContentHash>,
}

/// The library of subsystems.
pub struct Store {
    text: TextFolder,
    cache_folder: PathBuf,
    cache: Option<Cache>,
    pub(super) journal: Journal,
    /// Whether the journal has been brought up to what lies in the folder.
    pub(super) journal_is_current: bool,
    /// Held as long as this process may write.
    lock: Option<Lock>,
    manifest: Manifest,
    /// Records refused at opening, with the reason; key -> words.
    damaged: BTreeMap<String, String>,
    pub(super) index: BTreeMap<String, Indexed>,
    opened: Opened,
}

impl Store {
    /// Opens the library in a folder, with the working copy in its `.cache`.
    ///
    /// A damaged record does not keep the store from opening; it is listed by [`Store::damaged`] and refused
    /// by [`Store::get`]. If another process has the library open, the text is read and nothing can be written.
    ///
    /// # Errors
    /// If the folder of the text records cannot be listed.
    pub fn open(library: &Path) -> Result<Self, StoreError> {
        Self::open_with_cache(library, &library.join(".cache"))
    }

    /// As [`Store::open`], with the working copy elsewhere.
    ///
    /// # Errors
    /// If the folder of the text records cannot be listed.
    pub fn open_with_cache(library: &Path, cache_folder: &Path) -> Result<Self, StoreError> {
        let (lock, why_not) = match Lock::take(library) {
            Ok(lock) => (Some(lock), String::new()),
            Err(why) => (None, why),
        };
        if lock.is_some() {
            TextFolder::new(library).clear_temporaries();
        }
        let opened = Opened::TextOnly { why: why_not, writable: false };
        let (mut store, files) = Self::of_text(library, cache_folder, lock, opened)?;
        if store.lock.is_some() {
            store.open_cache(&files);
        }
        Ok(store)
    }

    /// As [`Store::open`] for whoever only reads: others may write meanwhile, and a record that they replace is seen as it was
    /// or as it is, never in between. Records are read from their files, and nothing can be written.
    ///
    /// # Errors
    /// If the folder of the text records cannot be listed.
    pub fn open_to_read(library: &Path) -> Result<Self, StoreError> {
        Self::of_text(library, &library.join(".cache"), None, Opened::ToRead).map(|(store, _)| store)
    }

    /// The store of the text records, without a working copy, and these.
    fn of_text(
        library: &Path,
        cache_folder: &Path,
        lock: Option<Lock>,
        opened: Opened,
    ) -> Result<(Self, Vec<TextFile>), StoreError> {
        let text = TextFolder::new(library);
        let files = text.read_all()?;
        let mut store = Self {
            manifest: files.iter().map(|f| (f.key.clone(), ContentHash::of_bytes(&f.bytes))).collect(),
            text,
            cache_folder: cache_folder.to_path_buf(),
            journal: Journal::of(library),
            journal_is_current: false,
            cache: None,
            damaged: BTreeMap::new(),
            index: BTreeMap::new(),
            opened,
            lock,
        };
        store.check_text(&files);
        Ok((store, files))
    }

    /// Checks all text records; notes the damaged ones and fills the index.
    fn check_text(&mut self, files: &[TextFile]) {
        self.index.clear();
        for file in files {
            match self.text.entry_in(file) {
                Ok(entry) => {
                    self.index.insert(file.key.clone(), Indexed::of(&entry));
                }
                Err(what) => {
                    self.damaged.insert(file.key.clone(), what);
                }
            }
        }
    }

    /// Opens the working copy, or builds it anew if anything about it differs from the text.
    fn open_cache(&mut self, files: &[TextFile]) {
        let why = if Cache::exists(&self.cache_folder) {
            let usable = |key: &str| !self.damaged.contains_key(key);
            let opened = Cache::open(&self.cache_folder)
                .and_then(|cache| cache.compare(&self.manifest, usable).map(|()| cache));
            match opened {
                Ok(cache) => {
                    self.cache = Some(cache);
                    self.opened = Opened::Checked;
                    return;
                }
                Err(fault) => fault,
            }
        } else {
            "there was none".to_string()
        };
        self.build_cache(files, why);
    }

    /// Sets the working copy aside and builds a new one.
    fn build_cache(&mut self, files: &[TextFile], why: String) {
        self.cache = None;
        let set_aside = Cache::exists(&self.cache_folder);
        let built = cache::set_aside(&self.cache_folder)
            .and_then(|()| fs::create_dir_all(&self.cache_folder))
            .map_err(|e| e.to_string())
            .and_then(|()| Cache::open(&self.cache_folder))
            .and_then(|cache| {
                let good = files.iter().filter(|f| !self.damaged.contains_key(&f.key));
                cache.put(good.map(|f| (f.key.as_str(), f.bytes.as_slice())), &self.manifest)?;
                Ok(cache)
            });
        self.opened = match built {
            Ok(cache) => {
                self.cache = Some(cache);
                Opened::Rebuilt { why, set_aside }
            }
            Err(fault) => {
                Opened::TextOnly { why: format!("the working copy cannot be built: {fault}"), writable: true }
            }
        };
    }

    /// How it was opened.
    pub fn opened(&self) -> &Opened {
        &self.opened
    }

    /// The library folder.
    pub fn folder(&self) -> &Path {
        self.text.root()
    }

    /// Damaged text records: file and what is wrong.
    pub fn damaged(&self) -> Vec<(PathBuf, String)> {
        self.damaged.iter().map(|(key, what)| (self.text.path_of(key), what.clone())).collect()
    }

    /// Keys of all records, damaged ones too, sorted.
    pub fn keys(&self) -> Vec<String> {
        self.manifest.keys().cloned().collect()
    }

    /// Keys of the usable records, sorted: those that need not be computed.
    pub fn usable_keys(&self) -> Vec<String> {
        self.manifest.keys().filter(|key| !self.damaged.contains_key(*key)).cloned().collect()
    }

    /// The entry with this key.
    ///
    /// # Errors
    /// [`StoreError::NotFound`], or [`StoreError::Damaged`] naming the file.
    pub fn get(&self, key: &str) -> Result<Entry, StoreError> {
        if let Some(what) = self.damaged.get(key) {
            return Err(StoreError::Damaged { path: self.text.path_of(key), what: what.clone() });
        }
        if !self.manifest.contains_key(key) {
            return Err(self.not_found(key));
        }
        let copy = self.cache.as_ref().and_then(|cache| cache.get(key));
        match copy.and_then(|bytes| self.text.parse(key, &bytes).ok()) {
            Some(entry) => Ok(entry),
            None => self.text.read(key),
        }
    }

    /// Why entries are deprecated, by their keys.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub fn deprecations(&self) -> Result<BTreeMap<String, Deprecation>, StoreError> {
        let deprecated = self.index.iter().filter(|(_, item)| item.deprecated).map(|(key, _)| key);
        let of = |key: &String| Ok(self.get(key)?.deprecated.map(|why| (key.clone(), why)));
        deprecated.filter_map(|key| of(key).transpose()).collect()
    }

    /// Why an entry is deprecated; none if it is not, or not there.
    ///
    /// # Errors
    /// As [`Self::get`].
    pub fn deprecation(&self, key: &str) -> Result<Option<Deprecation>, StoreError> {
        let is_deprecated = self.index.get(key).is_some_and(|item| item.deprecated);
        if is_deprecated { Ok(self.get(key)?.deprecated) } else { Ok(None) }
    }

    /// The one key that is meant by a key, its name without the kind, its hash, or the beginning of any of these.
    ///
    /// # Errors
    /// [`StoreError::NotFound`] if none or several are.
    pub fn resolve(&self, text: &str) -> Result<String, StoreError> {
        match key::meant(self.manifest.keys(), text)? {
            Some(key) => Ok(key.clone()),
            None => Err(self.not_found(text)),
        }
    }

    fn not_found(&self, key: &str) -> StoreError {
        let near = self
            .manifest
            .keys()
            .map(|k| (strsim::jaro_winkler(k, key), k))
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let hint =
            near.filter(|(likeness, _)| *likeness > 0.85).map(|(_, k)| format!("; did you mean `{k}`?"));
        StoreError::NotFound { key: key.to_string(), hint: hint.unwrap_or_default() }
    }

    /// All usable entries, in order of their keys.
    ///
    /// # Errors
    /// If a record that was whole at opening cannot be read any more.
    pub fn list(&self) -> Result<Vec<Entry>, StoreError> {
        self.manifest.keys().filter(|key| !self.damaged.contains_key(*key)).map(|key| self.get(key)).collect()
    }

    /// Whether an entry may be stored, so far as that depends on the entry.
    ///
    /// # Errors
    /// If it is not sound or too large.
    pub fn check(entry: &Entry) -> Result<(), StoreError> {
        sound_text(entry).map(|_| ())
    }

    /// Stores an entry. One that was deprecated stays so.
    ///
    /// # Errors
    /// If the entry is not sound or too large, a key is given twice with different content, or the store cannot be written.
    pub fn put(&mut self, entry: &Entry) -> Result<Put, StoreError> {
        self.put_all(std::slice::from_ref(entry)).map(|done| done[0])
    }

    /// Whether this process may write.
    ///
    /// # Errors
    /// [`StoreError::ReadOnly`] with the reason: another process has the library open, the folder is read-only, or it was opened to be read.
    pub fn writable(&self) -> Result<(), StoreError> {
        match (&self.lock, &self.opened) {
            (Some(_), _) => Ok(()),
            (None, Opened::TextOnly { why, .. }) => Err(StoreError::ReadOnly { why: why.clone() }),
            (None, _) => Err(StoreError::ReadOnly { why: "it was opened to be read".to_string() }),
        }
    }

    /// Stores entries, of which those stay deprecated that were: all are checked before the first is written; text first, successors before those that they replace, then the working copy,
    /// then the journal.
    ///
    /// # Errors
    /// As [`Store::put`].
    pub fn put_all(&mut self, entries: &[Entry]) -> Result<Vec<Put>, StoreError> {
        self.put_as(entries, None, "")
    }

    /// As [`Store::put_all`]; the journal tells that this `happened` (of itself: added, replaced or mended) with a note.
    ///
    /// # Errors
    /// As [`Store::put`]. If only the journal could not be written the records are stored, and the next writer notes them.
    pub fn put_as(
        &mut self,
        entries: &[Entry],
        happened: Option<Happening>,
        note: &str,
    ) -> Result<Vec<Put>, StoreError> {
        self.writable()?;
        let mut changed: Vec<(String, String)> = Vec::new();
        let mut events = Vec::new();
        let mut done = Vec::with_capacity(entries.len());
        let mut given: BTreeMap<&str, ContentHash> = BTreeMap::new();
        let entries = entries.iter().map(|e| self.still_deprecated(e)).collect::<Result<Vec<_>, _>>()?;
        for entry in &entries {
            let text = sound_text(entry)?;
            let hash = ContentHash::of_bytes(text.as_bytes());
            let earlier = given.insert(&entry.key, hash);
            if earlier.is_some_and(|earlier| earlier != hash) {
                let what = "is given twice with different content; give one of the two".to_string();
                return Err(StoreError::Invalid { key: entry.key.clone(), what });
            }
            let (put, own) = match self.manifest.get(&entry.key) {
                _ if earlier.is_some() => (Put::Unchanged, Happening::Added),
                Some(held) if *held == hash => (Put::Unchanged, Happening::Added),
                Some(_) if self.damaged.contains_key(&entry.key) => (Put::Replaced, Happening::Mended),
                Some(_) => (Put::Replaced, Happening::Replaced),
                None => (Put::Added, Happening::Added),
            };
            if put != Put::Unchanged {
                events.push((happened.unwrap_or(own), entry.key.clone()));
                changed.push((entry.key.clone(), text));
            }
            done.push(put);
        }
        if changed.is_empty() {
            return Ok(done);
        }
        self.bring_journal_up()?;
        // a writer that is killed leaves no entry behind whose successor is still to come
        let successor = |e: &Entry| e.deprecated.as_ref().and_then(|d| d.successor.clone());
        let successors = entries.iter().map(|e| (e.key.clone(), successor(e))).collect();
        changed.sort_by_cached_key(|(key, _)| succession::following(key, &successors));
        self.text.write(&changed)?;
        for (key, text) in &changed {
            self.manifest.insert(key.clone(), ContentHash::of_bytes(text.as_bytes()));
            self.damaged.remove(key);
        }
        for entry in &entries {
            self.index.insert(entry.key.clone(), Indexed::of(entry));
        }
        if let Some(cache) = &self.cache {
            let records = changed.iter().map(|(key, text)| (key.as_str(), text.as_bytes()));
            if let Err(fault) = cache.put(records, &self.manifest) {
                // The text is written; the next opening builds the copy again.
                self.cache = None;
                self.opened =
                    Opened::TextOnly { why: format!("the working copy failed: {fault}"), writable: true };
            }
        }
        self.tell(events, note)?;
        Ok(done)
    }

    /// An entry with the deprecation of the record that is there.
    fn still_deprecated<'e>(&self, entry: &'e Entry) -> Result<Cow<'e, Entry>, StoreError> {
        let held = if entry.deprecated.is_none() { self.deprecation(&entry.key)? } else { None };
        Ok(held
            .map_or(Cow::Borrowed(entry), |why| Cow::Owned(Entry { deprecated: Some(why), ..entry.clone() })))
    }

    /// Marks an entry as no longer to be used; of one that is marked already, what is not given anew is kept.
    ///
    /// # Errors
    /// If either entry is absent or damaged, the successor is the entry itself, of another kind or deprecated, the entry is deprecated and neither
    /// reason nor successor are new, or the store cannot be written.
    pub fn deprecate(
        &mut self,
        key: &str,
        successor: Option<&str>,
        reason: Option<&str>,
    ) -> Result<Deprecation, StoreError> {
        let mut entry = self.get(key)?;
        let invalid = |what: &str| StoreError::Invalid { key: key.to_string(), what: what.to_string() };
        if reason.is_some_and(|reason| reason.trim().is_empty()) {
            return Err(invalid("cannot be deprecated for an empty reason; say why, or leave --reason out"));
        }
        if let Some(successor) = successor {
            if successor == key {
                return Err(invalid("cannot be its own successor"));
            }
            if succession::kind(successor) != succession::kind(key) {
                return Err(invalid(&succession::other_kind(successor)));
            }
            if self.get(successor)?.deprecated.is_some() {
                return Err(invalid(&format!("its successor `{successor}` is itself deprecated")));
            }
        }
        let held = entry.deprecated.take();
        let told = |d: &Deprecation| match &d.successor {
            Some(successor) => format!("{}; successor {successor}", d.reason),
            None => d.reason.clone(),
        };
        let mut marked =
            held.clone().unwrap_or_else(|| Deprecation { reason: "replaced".to_string(), successor: None });
        marked.reason = reason.map_or(marked.reason, str::to_string);
        marked.successor = successor.map(str::to_string).or(marked.successor);
        if held.as_ref() == Some(&marked) {
            return Err(invalid(&format!(
                "is deprecated already ({}); give another `--reason` or `--successor` to change that",
                told(&marked)
            )));
        }
        let note = told(&marked);
        entry.deprecated = Some(marked.clone());
        self.put_as(&[entry], Some(Happening::Deprecated), &note)?;
        Ok(marked)
    }

    /// Reads all text again, builds the working copy anew and mends the journal; returns the number of usable records.
    ///
    /// # Errors
    /// If the text cannot be read, the journal cannot be written, or another process holds the library.
    pub fn rebuild(&mut self) -> Result<usize, StoreError> {
        self.writable()?;
        let files = self.text.read_all()?;
        self.manifest = files.iter().map(|f| (f.key.clone(), ContentHash::of_bytes(&f.bytes))).collect();
        self.damaged.clear();
        self.check_text(&files);
        self.build_cache(&files, "it was asked for".to_string());
        self.journal.mend(&self.cache_folder.join("history.bad"))?;
        self.journal_is_current = false;
        self.bring_journal_up()?;
        Ok(files.len() - self.damaged.len())
    }

    /// The keys of usable entries with those of their successors.
    pub(super) fn successors(&self) -> Successors {
        self.index.iter().map(|(key, item)| (key.clone(), item.successor.clone())).collect()
    }

    pub(super) fn text(&self) -> &TextFolder {
        &self.text
    }

    pub(super) fn cache(&self) -> Option<&Cache> {
        self.cache.as_ref()
    }
}

impl Indexed {
    fn of(entry: &Entry) -> Self {
        Self {
            kind: entry.kind,
            origin: entry.origin,
            features: entry.features.clone(),
            submodel_version: entry.provenance.inputs.submodel_version.unwrap_or(0),
            deprecated: entry.deprecated.is_some(),
            successor: entry.deprecated.as_ref().and_then(|d| d.successor.clone()),
            content: entry.checksum().ok(),
        }
    }
}

/// The text of an entry that may be stored.
fn sound_text(entry: &Entry) -> Result<String, StoreError> {
    let invalid = |what: String| StoreError::Invalid { key: entry.key.clone(), what };
    super::check::entry(entry).map_err(invalid)?;
    debug_assert!(key::is_key(&entry.key));
    let text = entry.to_text().map_err(|e| invalid(e.to_string()))?;
    // Written and read must be the same thing; this also refuses numbers that JSON cannot hold.
    if Entry::from_text(&text).map_err(invalid)? != *entry {
        return Err(invalid("does not read back as it was written".to_string()));
    }
    let Some(deprecated) = &entry.deprecated else {
        return within_limit(text.len()).map(|()| text).map_err(invalid);
    };
    let length = deprecated.reason.chars().count();
    if length > REASON_LIMIT {
        return Err(invalid(format!(
            "its reason for the deprecation has {length} characters; use at most {REASON_LIMIT}"
        )));
    }
    let plain = Entry { deprecated: None, ..entry.clone() }.to_text().map_err(|e| invalid(e.to_string()))?;
    within_limit(plain.len()).map(|()| text).map_err(invalid)
}

/// Whether a record may have so many bytes, apart from those of its deprecation.
fn within_limit(bytes: usize) -> Result<(), String> {
    if bytes < RECORD_LIMIT_BYTES {
        return Ok(());
    }
    Err(format!(
        "its record has {bytes} bytes, the limit is {RECORD_LIMIT_BYTES}; give fewer axial forces or points"
    ))
}
