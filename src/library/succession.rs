//! What stands in the place of deprecated entries: each successor is there, of the same kind, and no circle leads back.
//!
//! A chain (`a` to `b`, `b` to `c`) is in order: who asks for `a` gets `c`.

use super::error::StoreError;
use super::parts::Deprecation;
use super::store::Store;
use std::collections::{BTreeMap, BTreeSet};

/// The keys of entries with those of their successors.
pub type Successors = BTreeMap<String, Option<String>>;

/// The deprecated entries, by their keys.
pub type Deprecations = BTreeMap<String, Deprecation>;

impl Store {
    /// Those of these keys that no model uses, with the reason: deprecated, and the last of their successors too.
    ///
    /// # Errors
    /// If the record of a deprecated entry cannot be read.
    pub fn out_of_use(&self, keys: &[String]) -> Result<Vec<(String, String)>, StoreError> {
        let deprecated = self.deprecations()?;
        let reason = |key: &String| last_reason(key, &deprecated).map(|why| (key.clone(), why.to_string()));
        Ok(keys.iter().filter_map(reason).collect())
    }
}

/// Why the last of the successors of an entry is deprecated; none if it is not.
fn last_reason<'a>(key: &'a str, deprecated: &'a Deprecations) -> Option<&'a str> {
    deprecated.get(along(key, deprecated).last()?).map(|why| why.reason.as_str())
}

/// A key and its successors, one after the other: as many as there are deprecated entries at most, since records can be edited so that a circle leads back.
pub fn along<'a>(key: &'a str, deprecated: &'a Deprecations) -> impl Iterator<Item = &'a str> {
    walk(key, deprecated.len(), |key| deprecated.get(key)?.successor.as_deref())
}

fn walk<'a>(
    key: &'a str,
    most: usize,
    next: impl Fn(&str) -> Option<&'a str>,
) -> impl Iterator<Item = &'a str> {
    std::iter::successors(Some(key), move |key| next(key)).take(most + 1)
}

/// What is wrong with the successors: the key, and what it is. A circle is told once, at the first of its keys.
pub fn faults(successors: &Successors) -> BTreeSet<(String, String)> {
    let mut found = BTreeSet::new();
    for (key, successor) in successors {
        let Some(successor) = successor else { continue };
        let what = if !successors.contains_key(successor) {
            Some(format!(
                "its successor `{successor}` is not in the library; add that, or name another one {HOW}"
            ))
        } else if kind(successor) != kind(key) {
            Some(other_kind(successor))
        } else {
            circle(key, successors).map(|others| {
                let others: Vec<String> = others.iter().map(|other| format!("`{other}`")).collect();
                let through =
                    if others.is_empty() { String::new() } else { format!(" through {}", others.join(", ")) };
                format!("its successors lead back to it{through}; name another one {HOW}")
            })
        };
        found.extend(what.map(|what| (key.clone(), what)));
    }
    found
}

/// How many successors follow on a key, at most as many as there are entries.
pub fn following(key: &str, successors: &Successors) -> usize {
    walk(key, successors.len(), |key| successors.get(key)?.as_deref()).count() - 1
}

/// Why an entry of another kind is no successor, in words.
pub fn other_kind(successor: &str) -> String {
    format!("its successor `{successor}` is of another kind; name one of the same kind {HOW}")
}

/// How a successor is named.
const HOW: &str = "by `library deprecate --successor`";

/// The kind of the entry with this key.
pub fn kind(key: &str) -> &str {
    key.split('/').next().unwrap_or_default()
}

/// The successors on the way from a key back to it, where it is the first of them by its name.
fn circle<'a>(key: &str, successors: &'a Successors) -> Option<Vec<&'a str>> {
    let next = |key: &str| successors.get(key).and_then(Option::as_deref);
    let mut way: Vec<&str> = Vec::new();
    let mut at = next(key)?;
    while at != key {
        // a way that comes by smaller keys, or into a circle without this key, is told elsewhere
        if at < key || way.contains(&at) {
            return None;
        }
        way.push(at);
        at = next(at)?;
    }
    Some(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(pairs: &[(&str, Option<&str>)]) -> Vec<(String, String)> {
        let successors = pairs.iter().map(|(key, to)| (key.to_string(), to.map(str::to_string))).collect();
        faults(&successors).into_iter().collect()
    }

    #[test]
    fn chains_are_sound_and_circles_are_told_once() {
        assert!(found(&[("k/a", Some("k/b")), ("k/b", Some("k/c")), ("k/c", None)]).is_empty());
        let circle =
            found(&[("k/d", Some("k/a")), ("k/a", Some("k/b")), ("k/b", Some("k/c")), ("k/c", Some("k/a"))]);
        assert_eq!(circle.len(), 1, "{circle:?}");
        assert!(circle[0].0 == "k/a" && circle[0].1.contains("lead back to it through `k/b`, `k/c`"));
        let itself = found(&[("k/a", Some("k/a"))]);
        assert!(itself.len() == 1 && itself[0].1.contains("lead back to it"), "{itself:?}");
    }

    #[test]
    fn successors_are_counted_along_their_chain() {
        let pairs = [("k/a", Some("k/b")), ("k/b", Some("k/c")), ("k/c", None), ("k/d", Some("k/d"))];
        let successors = pairs.iter().map(|(key, to)| (key.to_string(), to.map(str::to_string))).collect();
        let count = |key: &str| following(key, &successors);
        assert_eq!(["k/a", "k/b", "k/c", "k/e"].map(count), [2, 1, 0, 0]);
        assert_eq!(count("k/d"), successors.len());
    }

    #[test]
    fn successors_are_there_and_of_the_same_kind() {
        let absent = found(&[("k/a", Some("k/b"))]);
        assert!(absent[0].1.contains("`k/b` is not in the library"), "{absent:?}");
        let other = found(&[("k/a", Some("l/b")), ("l/b", None)]);
        assert!(other[0].1.contains("`l/b` is of another kind"), "{other:?}");
    }
}
