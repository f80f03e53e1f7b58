//! What the store tells the journal.

use super::error::StoreError;
use super::journal::{Event, Happening, History};
use super::key;
use super::store::Store;
use std::collections::{BTreeMap, BTreeSet};

impl Store {
    /// The journal of the library.
    ///
    /// # Errors
    /// As the file system reports them.
    pub fn history(&self) -> Result<History, StoreError> {
        self.journal.read()
    }

    /// As [`Store::resolve`], where no record is meant among the keys of the journal: an entry that is gone is still told of there.
    ///
    /// # Errors
    /// As [`Store::resolve`], or if the journal cannot be read.
    pub fn resolve_told(&self, text: &str) -> Result<String, StoreError> {
        if let Some(key) = key::meant(self.keys().iter(), text)? {
            return Ok(key.clone());
        }
        let history = self.history()?;
        let told: BTreeSet<&String> = history.events.iter().map(|e| &e.key).filter(|k| *k != "-").collect();
        match key::meant(told.into_iter(), text)? {
            Some(key) => Ok(key.clone()),
            None => self.resolve(text),
        }
    }

    /// What the journal does not know yet: records that came (`found`) or went (`missing`) without it.
    ///
    /// # Errors
    /// If the journal cannot be read.
    pub fn untold(&self) -> Result<Vec<Event>, StoreError> {
        let history = self.journal.read()?;
        let mut known: BTreeMap<&str, &str> = BTreeMap::new();
        for event in history.events.iter().filter(|e| e.key != "-") {
            if event.what == Happening::Missing {
                known.remove(event.key.as_str());
            } else {
                known.insert(&event.key, &event.record);
            }
        }
        let mut events = Vec::new();
        for key in self.index.keys() {
            let record = self.record_of(key);
            if known.get(key.as_str()) != Some(&record.as_str()) {
                events.push(Event::now(Happening::Found, key, &record, ""));
            }
        }
        let held = self.keys();
        let gone = known.keys().filter(|key| held.binary_search_by(|h| h.as_str().cmp(key)).is_err());
        events.extend(gone.map(|key| Event::now(Happening::Missing, key, "-", "")));
        Ok(events)
    }

    /// Notes what the journal does not know, once for this store.
    pub(super) fn bring_journal_up(&mut self) -> Result<(), StoreError> {
        if !self.journal_is_current {
            let untold = self.untold()?;
            self.journal.append(&untold)?;
            self.journal_is_current = true;
        }
        Ok(())
    }

    /// Notes what happened to records that are stored now.
    ///
    /// # Errors
    /// [`StoreError::Untold`]: whoever sees it must not think that nothing was stored.
    pub(super) fn tell(&self, events: Vec<(Happening, String)>, note: &str) -> Result<(), StoreError> {
        let events: Vec<Event> =
            events.iter().map(|(what, key)| Event::now(*what, key, &self.record_of(key), note)).collect();
        self.journal.append(&events).map_err(|error| match error {
            StoreError::Io { path, source } => StoreError::Untold { path, source },
            other => other,
        })
    }

    fn record_of(&self, key: &str) -> String {
        let content = self.index.get(key).and_then(|item| item.content);
        content.map_or_else(|| "-".to_string(), |hash| hash.short())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_journal_that_cannot_be_written_says_that_the_records_are_stored() {
        let room = tempfile::tempdir().unwrap();
        let store = Store::open(room.path()).unwrap();
        // no file can be written there
        std::fs::create_dir(room.path().join(super::super::journal::JOURNAL_FILE)).unwrap();
        let key = "axial_spring/1x1@0123456789abcdef".to_string();
        let error = store.tell(vec![(Happening::Added, key)], "").unwrap_err();
        assert!(matches!(error, StoreError::Untold { .. }));
        let words = error.to_string();
        assert!(words.contains("history.txt: ") && words.contains("the records are stored"), "{words}");
    }
}
