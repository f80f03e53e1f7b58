//! The working copy of the text records in sled. The only file that names sled.
//!
//! sled 0.34 can open a damaged database cleanly with records missing, can fail, and can panic
//! inside `open`. So the copy is never believed: each value carries the hash of its bytes, the database
//! carries the hash of the text folder it was built from, and every call is guarded against
//! panics. Whatever differs makes the caller set the copy aside and build a new one from the text.
//!
//! Layout: tree `records`: key -> blake3(bytes), bytes of the text file. Tree `meta`: `schema`, `manifest`.

use super::text::{Manifest, manifest_hash};
use crate::base::hash::ContentHash;
use std::cell::Cell;
use std::fs;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::Once;

const CACHE_SCHEMA: &[u8] = b"fallwerk-library-cache/1";

/// An open working copy.
pub struct Cache {
    /// `None` only while dropping.
    db: Option<sled::Db>,
    records: sled::Tree,
    meta: sled::Tree,
    /// Whether it could not be written: what waits in it is given up, since sled may wait for ever to write it.
    has_failed: Cell<bool>,
}

/// Why the working copy cannot be used, in words.
pub type Fault = String;

impl Cache {
    /// Where the database lies in a cache folder.
    fn database(folder: &Path) -> PathBuf {
        folder.join("db")
    }

    /// Whether a cache folder holds a database.
    pub fn exists(folder: &Path) -> bool {
        Self::database(folder).exists()
    }

    /// Opens the database of a cache folder without looking at its content.
    ///
    /// # Errors
    /// If sled refuses or panics.
    pub fn open(folder: &Path) -> Result<Self, Fault> {
        let path = Self::database(folder);
        guarded("opening", || {
            let db = once_unlocked(
                &sled::Config::new().path(&path).flush_every_ms(None).cache_capacity(64 << 20),
            )?;
            let trees = db.open_tree("records").and_then(|records| Ok((records, db.open_tree("meta")?)));
            let (records, meta) = trees.inspect_err(|_| std::mem::forget(db.clone()))?;
            Ok(Self { records, meta, db: Some(db), has_failed: Cell::new(false) })
        })
    }

    /// Compares the whole copy with the text: schema, manifest, every record's checksum, and that record's
    /// place in the manifest.
    ///
    /// # Errors
    /// The first difference.
    pub fn compare(&self, manifest: &Manifest, usable: impl Fn(&str) -> bool) -> Result<(), Fault> {
        let (schema, stored) =
            guarded("reading", || Ok((self.meta.get("schema")?, self.meta.get("manifest")?)))?;
        if schema.as_deref() != Some(CACHE_SCHEMA) {
            return Err("it has another format".to_string());
        }
        if stored.as_deref() != Some(manifest_hash(manifest).as_bytes().as_slice()) {
            return Err("it was built from other text records".to_string());
        }
        let faults = self.faults(manifest, usable)?;
        faults.into_iter().next().map_or(Ok(()), Err)
    }

    /// Every record that is damaged, missing, unexpected, or not equal to the text.
    ///
    /// # Errors
    /// If the copy cannot be read through.
    pub fn faults(&self, manifest: &Manifest, usable: impl Fn(&str) -> bool) -> Result<Vec<Fault>, Fault> {
        let mut faults = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        guarded("reading", || {
            for item in self.records.iter() {
                let (key, value) = item?;
                let key = String::from_utf8_lossy(&key).into_owned();
                match (checked(&value), manifest.get(&key)) {
                    (None, _) => faults.push(format!("record `{key}` does not match its checksum")),
                    (Some(bytes), Some(hash)) if ContentHash::of_bytes(bytes) == *hash => {}
                    (Some(_), Some(_)) => faults.push(format!("record `{key}` differs from its text")),
                    (Some(_), None) => faults.push(format!("record `{key}` has no text")),
                }
                seen.insert(key);
            }
            Ok(())
        })?;
        let missing = manifest.keys().filter(|key| usable(key) && !seen.contains(*key));
        faults.extend(missing.map(|key| format!("record `{key}` is missing")));
        Ok(faults)
    }

    /// The bytes of a record if it is there and whole.
    pub fn get(&self, key: &str) -> Option<Vec<u8>> {
        let value = guarded("reading", || self.records.get(key)).ok()??;
        checked(&value).map(<[u8]>::to_vec)
    }

    /// Stores records and the manifest of the text they come from, and brings both to the disk.
    ///
    /// # Errors
    /// If sled refuses or panics.
    pub fn put<'a>(
        &self,
        records: impl Iterator<Item = (&'a str, &'a [u8])>,
        manifest: &Manifest,
    ) -> Result<(), Fault> {
        let written = guarded("writing", || {
            for (key, bytes) in records {
                let mut value = blake3::hash(bytes).as_bytes().to_vec();
                value.extend_from_slice(bytes);
                self.records.insert(key, value)?;
            }
            self.meta.insert("schema", CACHE_SCHEMA)?;
            self.meta.insert("manifest", manifest_hash(manifest).as_bytes().as_slice())?;
            self.meta.flush()?;
            self.records.flush().map(|_| ())
        });
        self.has_failed.set(self.has_failed.get() || written.is_err());
        written
    }
}

impl Drop for Cache {
    fn drop(&mut self) {
        let Some(db) = self.db.take() else { return };
        if self.has_failed.get() {
            abandon((&db, &self.records, &self.meta));
        } else {
            let _ = guarded("closing", || db.flush().map(|_| ()));
        }
    }
}

/// Keeps handles of a database for ever: the last one flushes as it goes, which on a full disk does not return.
fn abandon((db, records, meta): (&sled::Db, &sled::Tree, &sled::Tree)) {
    std::mem::forget((db.clone(), records.clone(), meta.clone()));
}

/// Moves a database out of the way, over the one set aside before; removes it if it cannot be moved.
///
/// # Errors
/// If it can be neither moved nor removed.
pub fn set_aside(folder: &Path) -> std::io::Result<()> {
    let (path, aside) = (Cache::database(folder), folder.join("db.bad"));
    let clear = |path: &Path| if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    if fs::symlink_metadata(&path).is_err() {
        return Ok(());
    }
    if fs::symlink_metadata(&aside).is_ok() {
        clear(&aside)?;
    }
    fs::rename(&path, &aside).or_else(|_| clear(&path))
}

/// The bytes of a value if its checksum is right.
fn checked(value: &[u8]) -> Option<&[u8]> {
    let (stated, bytes) = value.split_at_checked(32)?;
    (blake3::hash(bytes).as_bytes().as_slice() == stated).then_some(bytes)
}

thread_local! {
    static QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Longest wait for sled to give its own lock back \[s\].
const LOCKED_S: f64 = 5.0;

/// Opens a database. Whoever asks holds the lock of the store, so that a lock of sled is one that is being given back: its threads, and children between fork and exec, keep the file a little longer than the store that had it.
fn once_unlocked(config: &sled::Config) -> sled::Result<sled::Db> {
    let since = std::time::Instant::now();
    loop {
        match config.open() {
            Err(sled::Error::Io(why))
                if why.to_string().contains("could not acquire lock")
                    && since.elapsed().as_secs_f64() < LOCKED_S =>
            {
                std::thread::sleep(std::time::Duration::from_millis(10));
            }
            outcome => return outcome,
        }
    }
}

/// Runs something of sled's; an error or a panic becomes words. Panics are not printed.
fn guarded<T>(doing: &str, action: impl FnOnce() -> Result<T, sled::Error>) -> Result<T, Fault> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let earlier = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !QUIET.get() {
                earlier(info);
            }
        }));
    });
    let before = QUIET.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(action));
    QUIET.set(before);
    match result {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(error)) => Err(format!("{doing} it failed ({error})")),
        Err(_) => Err(format!("{doing} it broke off")),
    }
}
