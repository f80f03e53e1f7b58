//! The text records: the source of truth. One record a file, `library/<kind>/<name>@<hash>.json`.

use super::entry::Entry;
use super::error::StoreError;
use super::key;
use crate::base::hash::ContentHash;
use crate::base::output::{TEMPORARY_PREFIX, sync_folder, write_renamed};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The folder of text records.
#[derive(Debug, Clone)]
pub struct TextFolder {
    root: PathBuf,
}

/// One file as found.
#[derive(Debug)]
pub struct TextFile {
    /// The key by its place.
    pub key: String,
    /// Its bytes; none if it cannot be read.
    pub bytes: Vec<u8>,
    /// Why it cannot be read, if so.
    fault: Option<String>,
}

impl TextFolder {
    /// The folder `root`; it need not exist yet.
    pub fn new(root: &Path) -> Self {
        Self { root: root.to_path_buf() }
    }

    /// The library folder.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Where the record of a key lies. The caller has checked the key ([`key::is_key`]).
    pub fn path_of(&self, key: &str) -> PathBuf {
        self.root.join(format!("{key}.json"))
    }

    /// The names of all record files, sorted, with paths; a file whose name is no key is included.
    ///
    /// # Errors
    /// As the file system reports them. A library folder that does not exist is empty.
    pub fn scan(&self) -> Result<Vec<(String, PathBuf)>, StoreError> {
        let mut found = Vec::new();
        for (folder, path) in list(&self.root)? {
            if !path.is_dir() {
                continue;
            }
            for (name, path) in list(&path)? {
                if let Some(stem) = name.strip_suffix(".json") {
                    found.push((format!("{folder}/{stem}"), path));
                }
            }
        }
        found.sort();
        Ok(found)
    }

    /// All record files with their bytes, sorted by key. What cannot be read, a folder with the name of a record say, is
    /// damaged, and keeps nobody from the others.
    ///
    /// # Errors
    /// If the file system does not list the folders.
    pub fn read_all(&self) -> Result<Vec<TextFile>, StoreError> {
        let read = |(key, path): (String, PathBuf)| match bytes_of(&path) {
            Ok(bytes) => TextFile { key, bytes, fault: None },
            Err(fault) => TextFile { key, bytes: Vec::new(), fault: Some(what(fault)) },
        };
        Ok(self.scan()?.into_iter().map(read).collect())
    }

    /// The record in a file as found.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn entry_in(&self, file: &TextFile) -> Result<Entry, String> {
        match &file.fault {
            Some(fault) => Err(fault.clone()),
            None => self.parse(&file.key, &file.bytes).map_err(what),
        }
    }

    /// Reads and checks one record.
    ///
    /// # Errors
    /// [`StoreError::Damaged`] naming the file, or the file system's error.
    pub fn read(&self, key: &str) -> Result<Entry, StoreError> {
        let path = self.path_of(key);
        let bytes = bytes_of(&path)?;
        self.parse(key, &bytes)
    }

    /// Checks the bytes of the record of `key`.
    ///
    /// # Errors
    /// [`StoreError::Damaged`] naming the file.
    pub fn parse(&self, key: &str, bytes: &[u8]) -> Result<Entry, StoreError> {
        let damaged = |what: String| StoreError::Damaged { path: self.path_of(key), what };
        if !key::is_key(key) {
            return Err(damaged("the file's name is not a key".to_string()));
        }
        let text = std::str::from_utf8(bytes).map_err(|e| damaged(format!("not UTF-8: {e}")))?;
        let entry = Entry::from_text(text).map_err(damaged)?;
        if entry.key != key {
            return Err(StoreError::Damaged {
                path: self.path_of(key),
                what: format!("it holds the record of `{}`", entry.key),
            });
        }
        Ok(entry)
    }

    /// Writes records; each file is replaced as a whole, and all are on the disk at return.
    ///
    /// # Errors
    /// As the file system reports them; records before the failing one are written.
    pub fn write(&self, records: &[(String, String)]) -> Result<(), StoreError> {
        let mut folders = BTreeSet::new();
        for (key, text) in records {
            let path = self.path_of(key);
            let folder = path.parent().unwrap_or(&self.root).to_path_buf();
            if folders.insert(folder.clone()) {
                fs::create_dir_all(&folder).map_err(StoreError::io(&folder))?;
            }
            write_renamed(&path, text.as_bytes()).map_err(StoreError::io(&path))?;
        }
        folders
            .iter()
            .chain((!folders.is_empty()).then_some(&self.root))
            .try_for_each(|folder| sync_folder(folder).map_err(StoreError::io(folder)))
    }

    /// Removes temporary files of writers that were killed. Only the one writer may call this.
    pub fn clear_temporaries(&self) {
        let Ok(folders) = fs::read_dir(&self.root) else { return };
        for folder in folders.flatten().map(|item| item.path()).filter(|p| p.is_dir()) {
            for item in fs::read_dir(&folder).into_iter().flatten().flatten() {
                if item.file_name().to_string_lossy().starts_with(TEMPORARY_PREFIX) {
                    let _ = fs::remove_file(item.path());
                }
            }
        }
    }
}

/// What is wrong with a record, in words that do not name its file.
fn what(fault: StoreError) -> String {
    match fault {
        StoreError::Damaged { what, .. } => what,
        StoreError::Io { source, .. } => format!("it cannot be read: {source}"),
        other => other.to_string(),
    }
}

/// The bytes of a record's file; a pipe or device of that name would be waited for without end.
fn bytes_of(path: &Path) -> Result<Vec<u8>, StoreError> {
    let about = fs::metadata(path).map_err(StoreError::io(path))?;
    if !about.is_file() {
        return Err(StoreError::Damaged {
            path: path.to_path_buf(),
            what: "it is no ordinary file; move it out of the library".to_string(),
        });
    }
    fs::read(path).map_err(StoreError::io(path))
}

/// The visible items of a folder, unsorted; an absent folder has none.
fn list(folder: &Path) -> Result<Vec<(String, PathBuf)>, StoreError> {
    let items = match fs::read_dir(folder) {
        Ok(items) => items,
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        Err(e) => return Err(StoreError::io(folder)(e)),
    };
    let mut found = Vec::new();
    for item in items {
        let item = item.map_err(StoreError::io(folder))?;
        let name = item.file_name().to_string_lossy().into_owned();
        if !name.starts_with('.') {
            found.push((name, item.path()));
        }
    }
    Ok(found)
}

/// Key and hash of each text file, in order of the keys.
pub type Manifest = BTreeMap<String, ContentHash>;

/// One hash over a manifest.
pub fn manifest_hash(manifest: &Manifest) -> ContentHash {
    let mut bytes = Vec::new();
    for (key, hash) in manifest {
        bytes.extend_from_slice(key.as_bytes());
        bytes.push(0);
        bytes.extend_from_slice(hash.as_bytes());
    }
    ContentHash::of_bytes(&bytes)
}
