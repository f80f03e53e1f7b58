//! Entries of the library that are no longer to be used, and what is used in their place.

use crate::library::succession::{self, Deprecations};
use crate::library::{Store, StoreError};

/// The deprecated entries of a library, by their keys.
#[derive(Debug, Default)]
pub struct Withdrawn(Deprecations);

impl Withdrawn {
    /// Of a library.
    ///
    /// # Errors
    /// If the record of one cannot be read.
    pub fn of(store: &Store) -> Result<Self, StoreError> {
        store.deprecations().map(Self)
    }

    /// Why an entry is no longer to be used and nothing is in its place, in words; none if it is to be used.
    pub fn why(&self, key: &str) -> Option<String> {
        let own = self.0.get(key)?;
        let last = succession::along(key, &self.0).skip(1).last();
        let none = "has no successor";
        Some(match last {
            None => format!("is deprecated ({}) and {none}", own.reason),
            Some(last) => {
                let reason = self.0.get(last).map_or("", |d| d.reason.as_str());
                format!(
                    "is deprecated ({}); its successor {last} is so too ({reason}) and {none}",
                    own.reason
                )
            }
        })
    }

    /// The key of the entry to use in the place of one: itself if it is not deprecated, else the last of its successors; none if that is deprecated.
    pub fn instead<'a>(&'a self, key: &'a str) -> Option<&'a str> {
        succession::along(key, &self.0).last().filter(|last| !self.0.contains_key(*last))
    }

    /// What an analyst should know of an entry that a place has asked for and of which another one is used.
    pub fn note(&self, place: &str, key: &str) -> String {
        match self.instead(key) {
            Some(other) => {
                let reason = self.0.get(key).map_or("", |d| d.reason.as_str());
                format!("{place}: entry {key} is deprecated ({reason}); {other} is used in its place")
            }
            None => format!("{place}: entry {key} {}; it is not used", self.why(key).unwrap_or_default()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::Deprecation;

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
        assert_eq!(
            withdrawn.note("C1.top", "d"),
            "C1.top: entry d is deprecated (too stiff) and has no successor; it is not used"
        );
        let why = withdrawn.why("e").unwrap();
        assert!(why.contains("(too stiff); its successor d is so too (too stiff)"), "{why}");
        assert!(withdrawn.why("f").is_some() && withdrawn.why("x").is_none());
    }
}
