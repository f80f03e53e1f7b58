//! Queries: the entry that fits best, one between two, or none.

use super::entry::{Entry, Features};
use super::error::StoreError;
use super::find::{self, Match, Query};
use super::interpolate;
use super::store::{Indexed, Store};
use std::cmp::Reverse;
use std::collections::BTreeSet;

/// The entry that fits best.
#[derive(Debug, Clone, PartialEq)]
pub struct Found {
    /// The entry.
    pub entry: Entry,
    /// How well it fits.
    pub fit: Match,
}

/// The nearest entry by key, for a message when none fits.
#[derive(Debug, Clone, PartialEq)]
pub struct Nearest {
    /// Its key.
    pub key: String,
    /// How well it fits.
    pub fit: Match,
}

/// The answer to a [`Query`].
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// An entry of the library.
    Entry(Box<Found>),
    /// One between two entries; it is not in the library.
    Between(Box<Entry>),
    /// None within the tolerance; the nearest of the kind, if there is any.
    None(Option<Nearest>),
}

/// Entries that fit a [`Query`] as well as its answer, because it leaves open in what they differ.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Rivals {
    /// Their number; of an answer between two entries the number of other such pairs.
    pub count: usize,
    /// Names of the numbers in which they differ from the answer; `end`, `adjoining`, `law`, `origin` of words.
    pub differ: BTreeSet<String>,
}

impl Store {
    /// The usable, not deprecated entry that fits best: an exact match first (of several the newest
    /// submodel version, then the first key), else the nearest within `tolerance`
    /// ([`find`] says what the distance means), else none.
    ///
    /// # Errors
    /// If its record cannot be read.
    pub fn find(&self, wanted: &Features, tolerance: f64) -> Result<Option<Found>, StoreError> {
        match self.nearest(wanted) {
            Some(near) if near.fit.is_within(tolerance) => {
                Ok(Some(Found { entry: self.get(&near.key)?, fit: near.fit }))
            }
            _ => Ok(None),
        }
    }

    /// The best candidate without regard to a tolerance (its distance may be infinite); none only in a
    /// library without usable entries. For messages, not for use.
    pub fn nearest(&self, wanted: &Features) -> Option<Nearest> {
        self.best(|item| Some(find::compare(&item.features, wanted)))
    }

    /// Answers a curator: an exact match; else, with `interpolate`, an entry between the two nearest that
    /// differ in one of the numbers asked for and have it between them; else the nearest within `tolerance`; else none.
    ///
    /// # Errors
    /// If a record cannot be read, or the interpolated entry cannot be written as JSON.
    pub fn answer(&self, query: &Query, tolerance: f64, interpolate: bool) -> Result<Answer, StoreError> {
        let near = self.best(|item| query.compare(item.kind, item.origin, &item.features));
        let exact = near.as_ref().is_some_and(|n| n.fit.exact);
        if interpolate
            && !exact
            && let Some(between) = self.between(query)?
        {
            return Ok(Answer::Between(Box::new(between)));
        }
        match near {
            Some(near) if near.fit.is_within(tolerance) => {
                Ok(Answer::Entry(Box::new(Found { entry: self.get(&near.key)?, fit: near.fit })))
            }
            near => Ok(Answer::None(near)),
        }
    }

    /// What fits a query as well as its answer.
    pub fn rivals(&self, query: &Query, answer: &Answer) -> Rivals {
        match answer {
            Answer::Entry(found) => {
                let fits = |item: &Indexed| {
                    let fit = query.compare(item.kind, item.origin, &item.features);
                    fit.is_some_and(|fit| (fit.exact, fit.distance) == (found.fit.exact, found.fit.distance))
                };
                let others = self
                    .index
                    .iter()
                    .filter(|(key, item)| **key != found.entry.key && !item.deprecated && fits(item));
                let version = found.entry.provenance.inputs.submodel_version.unwrap_or(0);
                let differ = others.filter_map(|(_, item)| {
                    let mut names = find::names_of_differing(&item.features, &found.entry.features);
                    names.extend((item.origin != found.entry.origin).then(|| "origin".to_string()));
                    // of entries with the same features those of an older procedure have no say
                    (!names.is_empty() || item.submodel_version >= version).then_some(names)
                });
                Rivals::of(differ)
            }
            Answer::Between(entry) => {
                let Some(between) = &entry.provenance.inputs.interpolation else { return Rivals::default() };
                let pairs = self.brackets(query);
                let own = pairs.iter().find(|p| [p.2, p.3] == [&between.entries[0], &between.entries[1]]);
                let Some((width, feature, key, _)) = own else { return Rivals::default() };
                let features = |key: &String| self.index.get(key).map(|item| &item.features);
                let alike = pairs.iter().filter(|p| (p.0, &p.1) == (*width, feature) && p.2 != *key);
                let differ = alike.filter_map(|p| features(p.2).zip(features(key)));
                Rivals::of(differ.map(|(a, b)| find::names_of_differing(a, b)))
            }
            Answer::None(_) => Rivals::default(),
        }
    }

    /// The entry between the two that enclose what is asked for most closely.
    fn between(&self, query: &Query) -> Result<Option<Entry>, StoreError> {
        let mut best: Option<(f64, String, &String, &String)> = None;
        for pair in self.brackets(query) {
            if best.as_ref().is_none_or(|(least, ..)| pair.0 < *least) {
                best = Some(pair);
            }
        }
        let Some((_, feature, key_a, key_b)) = best else { return Ok(None) };
        let (a, b) = (self.get(key_a)?, self.get(key_b)?);
        let invalid = |what: String| StoreError::Invalid { key: format!("{key_a} and {key_b}"), what };
        interpolate::between(&a, &b, &feature, query.numbers[&feature])
            .map_err(|e| invalid(e.to_string()))
            .map(|entry| entry.filter(|e| super::check::entry(e).is_ok()))
    }

    /// The pairs of entries that enclose what is asked for in one number: logarithm of their ratio in it, its name, keys.
    fn brackets(&self, query: &Query) -> Vec<(f64, String, &String, &String)> {
        let usable: Vec<(&String, &Indexed)> = self
            .index
            .iter()
            .filter(|(_, item)| !item.deprecated)
            .filter(|(_, item)| {
                query.compare(item.kind, item.origin, &item.features).is_some_and(|m| m.distance.is_finite())
            })
            .collect();
        let mut pairs = Vec::new();
        for (i, (key_a, a)) in usable.iter().enumerate() {
            for (key_b, b) in &usable[i + 1..] {
                if (a.kind, a.origin, a.submodel_version) != (b.kind, b.origin, b.submodel_version) {
                    continue;
                }
                if let Some((feature, width)) = interpolate::bracket(&a.features, &b.features, query) {
                    pairs.push((width, feature, *key_a, *key_b));
                }
            }
        }
        pairs
    }

    /// The best of all usable, not deprecated entries.
    fn best(&self, compare: impl Fn(&Indexed) -> Option<Match>) -> Option<Nearest> {
        let mut best: Option<(Nearest, u32)> = None;
        for (key, item) in self.index.iter().filter(|(_, item)| !item.deprecated) {
            let Some(fit) = compare(item) else { continue };
            let rank = |fit: &Match, version: u32| (!fit.exact, fit.distance, Reverse(version));
            let better = best.as_ref().is_none_or(|(held, version)| {
                let (a, b) = (rank(&fit, item.submodel_version), rank(&held.fit, *version));
                a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)).is_lt()
            });
            if better {
                best = Some((Nearest { key: key.clone(), fit }, item.submodel_version));
            }
        }
        best.map(|(near, _)| near)
    }
}

impl Rivals {
    /// From the names in which each of the others differs from the answer: none if just their origin or their curves are others.
    fn of(differ: impl Iterator<Item = BTreeSet<String>>) -> Self {
        differ.fold(Self::default(), |mut all, names| {
            all.count += 1;
            all.differ.extend(names);
            all
        })
    }
}
