//! Entries of the library that are no longer to be used, and what is used in their place.

use crate::library::{Deprecation, Store, StoreError};
use std::collections::BTreeMap;

/// The deprecated entries of a library, by their keys.
#[derive(Debug, Default)]
pub struct Withdrawn(BTreeMap<String, Deprecation>);

impl Withdrawn {
    /// Of a library.
    ///
    /// # Errors
    /// If the record of one cannot be read.
    pub fn of(store: &Store) -> Result<Self, StoreError> {
        store.deprecations().map(Self)
    }

    /// Why an entry is no longer to be used; none if it is.
    pub fn reason(&self, key: &str) -> Option<&str> {
        self.0.get(key).map(|d| d.reason.as_str())
    }

    /// The key of the entry to use in the place of one: itself if it is not deprecated, else the last of its successors; none if that is deprecated.
    pub fn instead<'a>(&'a self, key: &'a str) -> Option<&'a str> {
        let mut key = key;
        // a successor is no predecessor of its own, but records can be edited
        for _ in 0..=self.0.len() {
            match self.0.get(key) {
                None => return Some(key),
                Some(Deprecation { successor, .. }) => key = successor.as_deref()?,
            }
        }
        None
    }

    /// What an analyst should know of an entry that a place has asked for and of which another one is used.
    pub fn note(&self, place: &str, key: &str) -> String {
        let reason = self.reason(key).unwrap_or_default();
        match self.instead(key) {
            Some(other) => {
                format!("{place}: entry {key} is deprecated ({reason}); {other} is used in its place")
            }
            None => format!(
                "{place}: entry {key} is deprecated ({reason}) and has no successor; its curves are scaled from others"
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_successor_is_used_and_circles_end() {
        let why = |successor: Option<&str>| Deprecation {
            reason: "too stiff".into(),
            successor: successor.map(String::from),
        };
        let of = [
            ("a", Some("b")),
            ("b", Some("c")),
            ("d", None),
            ("e", Some("d")),
            ("f", Some("g")),
            ("g", Some("f")),
        ];
        let withdrawn = Withdrawn(of.map(|(key, successor)| (key.to_string(), why(successor))).into());
        let instead = |key| withdrawn.instead(key);
        assert_eq!((instead("a"), instead("c"), instead("x")), (Some("c"), Some("c"), Some("x")));
        assert_eq!((instead("d"), instead("e"), instead("f")), (None, None, None));
        assert_eq!(
            withdrawn.note("C1.top", "a"),
            "C1.top: entry a is deprecated (too stiff); c is used in its place"
        );
    }
}
