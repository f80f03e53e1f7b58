//! How far an entry is from what is wanted.
//!
//! Words (end, adjoining member) must agree. The distance of the numbers is
//! `sqrt( Σ_i (w_i ln(a_i / b_i))² )`: with the weights of [`NUMBERS`](super::features::NUMBERS) it estimates the relative
//! change of the moment capacity `~ f b h²` and of the rotation capacity. It orders candidates and bounds what may be
//! used; it is no correction.

use super::features::{Adjoining, ColumnEnd, EntryKind, Features};
use super::parts::Origin;
use std::collections::{BTreeMap, BTreeSet};

/// How far an entry is from what is wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct Match {
    /// All features agree, the law to the last digit.
    pub exact: bool,
    /// Distance as above; zero for an exact match, infinite if words differ or a number is not known.
    pub distance: f64,
    /// What differs, largest share first; "exact match" if nothing.
    pub reason: String,
}

impl Match {
    /// Whether it may be used: exact, or at a distance within the tolerance. An infinite distance is within none.
    pub fn is_within(&self, tolerance: f64) -> bool {
        self.exact || self.distance.is_finite() && self.distance <= tolerance
    }
}

/// What a curator asks for: a kind and the features that matter. What is not named may be anything.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Query {
    /// Kind of the entry.
    pub kind: Option<EntryKind>,
    /// How its curves were obtained.
    pub origin: Option<Origin>,
    /// Which end.
    pub end: Option<ColumnEnd>,
    /// What it is joined to.
    pub adjoining: Option<Adjoining>,
    /// Numbers by the names of [`Features::numbers`], SI.
    pub numbers: BTreeMap<String, f64>,
}

impl Query {
    /// Compares an entry with what is asked for; `None` if kind or origin is another.
    pub fn compare(&self, kind: EntryKind, origin: Origin, features: &Features) -> Option<Match> {
        if self.kind.is_some_and(|k| k != kind) || self.origin.is_some_and(|o| o != origin) {
            return None;
        }
        let end = self.end.or(features.end);
        let adjoining = self.adjoining.or(features.adjoining);
        if let Some(other) = other_place(features, end, adjoining) {
            return Some(other);
        }
        let held = features.numbers();
        let parts = self.numbers.iter().map(|(name, wanted)| match held.get(name) {
            Some((value, weight)) => part(name, *weight, *value, *wanted),
            None => (f64::INFINITY, format!("`{name}` is not known of it")),
        });
        Some(sum(parts.collect(), true))
    }
}

/// Compares an entry's features with all those wanted.
pub fn compare(entry: &Features, wanted: &Features) -> Match {
    if let Some(other) = other_place(entry, wanted.end, wanted.adjoining) {
        return other;
    }
    let (held, asked) = (entry.numbers(), wanted.numbers());
    let names: BTreeSet<&String> = held.keys().chain(asked.keys()).collect();
    let parts = names.into_iter().map(|name| match (held.get(name), asked.get(name)) {
        (Some((a, weight)), Some((b, _))) => part(name, *weight, *a, *b),
        _ => (f64::INFINITY, format!("`{name}` is known of one side only")),
    });
    let hash = |f: &Features| f.law.as_ref().map(|law| law.hash.clone());
    sum(parts.collect(), hash(entry) == hash(wanted))
}

/// The names of the numbers in which two sets of features differ, and whether all else is the same.
pub(super) fn differing(a: &Features, b: &Features) -> (Vec<String>, bool) {
    let (x, y) = (a.numbers(), b.numbers());
    let names: BTreeSet<&String> = x.keys().chain(y.keys()).collect();
    let same = |name: &String| matches!((x.get(name), y.get(name)), (Some(p), Some(q)) if log_ratio(p.0, q.0) == 0.0);
    let hash = |f: &Features| f.law.as_ref().map(|law| law.hash.clone());
    let words = (a.end, a.adjoining, hash(a)) == (b.end, b.adjoining, hash(b));
    (names.into_iter().filter(|name| !same(name)).cloned().collect(), words)
}

/// The names of all in which two sets of features differ, words too.
pub(super) fn names_of_differing(a: &Features, b: &Features) -> BTreeSet<String> {
    let hash = |f: &Features| f.law.as_ref().map(|law| law.hash.clone());
    let words =
        [("end", a.end != b.end), ("adjoining", a.adjoining != b.adjoining), ("law", hash(a) != hash(b))];
    let words = words.into_iter().filter(|(_, differ)| *differ).map(|(name, _)| name.to_string());
    differing(a, b).0.into_iter().chain(words).collect()
}

fn part(name: &str, weight: f64, entry: f64, wanted: f64) -> (f64, String) {
    (weight * log_ratio(entry, wanted), format!("{name} is {entry} instead of {wanted}"))
}

fn sum(mut parts: Vec<(f64, String)>, same_law: bool) -> Match {
    let distance = parts.iter().map(|(d, _)| d * d).fold(0.0, |a, b| a + b).sqrt();
    parts.retain(|(d, _)| *d != 0.0);
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let exact = parts.is_empty() && same_law;
    let reason = if exact {
        "exact match".to_string()
    } else if parts.is_empty() {
        "same features, but the laws differ in other numbers".to_string()
    } else {
        parts.into_iter().map(|(_, words)| words).collect::<Vec<_>>().join("; ")
    };
    Match { exact, distance, reason }
}

/// No match, if the words differ.
fn other_place(entry: &Features, end: Option<ColumnEnd>, adjoining: Option<Adjoining>) -> Option<Match> {
    let words = |end: Option<ColumnEnd>, beside: Option<Adjoining>| {
        let end = end.map_or("an unknown", ColumnEnd::name);
        beside.map_or(format!("{end} end"), |b| format!("{end} end at a {}", b.name()))
    };
    ((entry.end, entry.adjoining) != (end, adjoining)).then(|| Match {
        exact: false,
        distance: f64::INFINITY,
        reason: format!("{} instead of {}", words(entry.end, entry.adjoining), words(end, adjoining)),
    })
}

/// `|ln(a / b)|`; numbers that differ only by rounding (10⁻⁹ relative) count as equal.
pub(super) fn log_ratio(a: f64, b: f64) -> f64 {
    if (a - b).abs() <= 1e-9 * a.abs().max(b.abs()) {
        0.0
    } else if a / b > 0.0 {
        libm::log(a / b).abs()
    } else {
        f64::INFINITY
    }
}
