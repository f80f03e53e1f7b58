//! Library entries of the places of a model: found, scaled from similar ones, or computed.

use super::withdrawn::Withdrawn;
use super::{Derive, GenerateError};
use crate::base::hash::ContentHash;
use crate::building::Homogenised;
use crate::curve::ResistanceCurve;
use crate::library::derive::{DeriveError, Wanted};
use crate::library::derive_contact::WantedContact;
use crate::library::derive_strip::WantedStrip;
use crate::library::entry::AxisRecord;
use crate::library::similar::{Candidates, FARTHEST, Similar};
use crate::library::{Entry, EntryKind, Store, StoreError};
use crate::material::j2::HardeningTable;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::Instant;

/// Entries of a kind made without a run of which notes speak, the farthest ones.
const NOTED: usize = 3;

/// What an entry is asked for.
#[derive(Debug, Clone)]
pub enum Query {
    /// A column end.
    End(Wanted),
    /// A line of a floor.
    Strip(WantedStrip),
    /// An end that strikes something.
    Contact(WantedContact),
}

impl Query {
    fn key(&self) -> Result<String, DeriveError> {
        Ok(match self {
            Self::End(query) => query.key()?,
            Self::Strip(query) => query.key()?,
            Self::Contact(query) => query.key()?,
        })
    }

    fn derive(&self, place: &str, progress: &(dyn Fn(usize, usize) + Sync)) -> Result<Entry, DeriveError> {
        match self {
            Self::End(query) => query.derive(place, progress),
            Self::Strip(query) => query.derive(place, progress),
            Self::Contact(query) => query.derive(),
        }
    }
}

/// Entries for member ends.
#[derive(Debug, Default)]
pub struct Entries {
    pub entries: BTreeMap<String, Entry>,
    /// Key of each member end's entry.
    pub of_end: BTreeMap<String, String>,
    pub derived: Vec<String>,
    /// Those that are scaled from others.
    pub scaled: Vec<Scaled>,
    /// What is to be told of entries that are deprecated.
    pub withdrawn: Vec<String>,
    /// Time for entries that the library lacks \[s\].
    pub curves_s: f64,
}

/// An entry made without a run: scaled from a similar one, or from its section.
#[derive(Debug, Clone)]
pub struct Scaled {
    /// The first of its ends.
    pub end: String,
    /// Its key.
    pub key: String,
    /// Where its curves are from, in words.
    pub words: String,
    /// How far that is, see [`Similar`].
    pub distance: f64,
}

impl Scaled {
    /// What an analyst should know of all of them.
    pub fn notes(all: &[Self]) -> Vec<String> {
        let mut kinds: BTreeMap<&str, Vec<&Self>> = BTreeMap::new();
        for own in all {
            kinds.entry(own.key.split('/').next().unwrap_or_default()).or_default().push(own);
        }
        let mut notes = Vec::new();
        for (kind, mut own) in kinds {
            own.sort_by(|a, b| b.distance.total_cmp(&a.distance));
            let note = |s: &&Self| format!("{}: no entry of its own, curves {}", s.end, s.words);
            notes.extend(own.iter().take(NOTED).map(note));
            let more = own.len().saturating_sub(NOTED);
            if more > 0 {
                let of_section = own[NOTED..].iter().filter(|s| s.distance > FARTHEST).count();
                let from = match of_section {
                    0 => "their curves are scaled from nearer ones".to_string(),
                    all if all == more => {
                        "nor is any similar enough: their curves are those of their sections".into()
                    }
                    some => format!(
                        "the curves of {some} are those of their sections, as none is similar, the others' scaled from nearer ones"
                    ),
                };
                let words = format!("{more} more of {kind} have no entries of their own; {from}");
                notes.push(format!("{words}: `fallwerk explain` tells of each"));
            }
        }
        notes
    }
}

impl Entries {
    /// Gives the ends with one entry another one.
    fn use_instead(&mut self, key: &str, other: &str) {
        self.of_end.values_mut().filter(|k| *k == key).for_each(|k| *k = other.to_string());
    }

    /// The curves of all entries as they work in a structure, `KEY/axis-1` and `KEY/axis-2`. Pushes end where an axial force is borne no longer, which is made up for; points of tests and other programs are kept.
    pub fn curves(&self) -> BTreeMap<String, ResistanceCurve> {
        self.entries
            .iter()
            .flat_map(|(key, e)| {
                let crushing = crushing(e);
                let whole = move |axis: &AxisRecord| match e.origin.is_own() {
                    true => axis.curve.in_a_structure(&crushing),
                    false => axis.curve.measured_in_a_structure(&crushing),
                };
                e.axes.iter().enumerate().map(move |(i, a)| (curve_id(key, i), whole(a)))
            })
            .collect()
    }
}

pub fn curve_id(key: &str, axis: usize) -> String {
    format!("{key}/axis-{}", axis + 1)
}

/// A place whose entry is asked for.
pub struct Asked {
    id: String,
    key: String,
    /// Left out where the entry is at hand.
    query: Option<Query>,
}

/// What the library knows, and what is done about the rest.
#[derive(Debug)]
pub struct Known {
    derive: Derive,
    keys: Vec<String>,
    withdrawn: Withdrawn,
    candidates: Candidates,
    /// Entries of ends that are crushed.
    crushed: Candidates,
    /// Entries that are not in the library.
    further: BTreeMap<String, Entry>,
    /// Keys of the entries of places asked for before.
    keys_of: RefCell<BTreeMap<String, String>>,
    /// Keys of the entries of ends with the same surroundings.
    keys_by: RefCell<BTreeMap<ContentHash, String>>,
    /// Entries scaled before, by the keys asked for.
    scaled: RefCell<BTreeMap<String, Option<Similar>>>,
}

impl Known {
    /// Of a library.
    ///
    /// # Errors
    /// If the record of a deprecated entry cannot be read.
    pub fn of(store: &Store, derive: Derive) -> Result<Self, StoreError> {
        let like = |kind| match derive {
            Derive::Similar => Candidates::of(store, kind),
            _ => Candidates::default(),
        };
        Ok(Self {
            derive,
            keys: store.usable_keys(),
            withdrawn: Withdrawn::of(store)?,
            candidates: like(EntryKind::ColumnHinge),
            crushed: like(EntryKind::ContactCrushing),
            further: BTreeMap::new(),
            keys_of: RefCell::default(),
            keys_by: RefCell::default(),
            scaled: RefCell::default(),
        })
    }

    /// From now on nothing is computed, but some entries are at hand.
    pub fn compute_no_more(&mut self, entries: &BTreeMap<String, Entry>) {
        self.derive = if self.derive == Derive::Similar { Derive::Similar } else { Derive::Never };
        self.further.extend(entries.iter().map(|(key, entry)| (key.clone(), entry.clone())));
    }

    /// Forgets which places have the same surroundings: the first of them is asked anew, so that its curves can be computed.
    pub fn begin(&self) {
        self.keys_by.borrow_mut().clear();
    }

    /// Whether there is an entry of this key, or a successor of it.
    fn has(&self, key: &str) -> bool {
        self.further.contains_key(key) || self.is_in_library(key)
    }

    fn is_in_library(&self, key: &str) -> bool {
        let is_held = self.keys.binary_search_by(|k| k.as_str().cmp(key)).is_ok();
        is_held && self.withdrawn.instead(key).is_some()
    }

    /// Whether the entry of a place was asked for before and is there.
    pub fn is_at_hand(&self, id: &str) -> bool {
        self.keys_of.borrow().get(id).is_some_and(|key| self.has_or_scaled(key))
    }

    fn has_or_scaled(&self, key: &str) -> bool {
        self.has(key) || self.scaled.borrow().get(key).is_some_and(Option::is_some)
    }

    /// What is asked of the library about a place; the query is made only where its answer is not known.
    pub fn asked(
        &self,
        id: &str,
        signature: Option<ContentHash>,
        query: impl FnOnce() -> Result<Query, GenerateError>,
    ) -> Result<Asked, GenerateError> {
        let known = self.keys_of.borrow().get(id).cloned();
        if let Some(key) = known.filter(|key| self.has_or_scaled(key)) {
            return Ok(Asked { id: id.to_string(), key, query: None });
        }
        let alike = signature.and_then(|s| self.keys_by.borrow().get(&s).cloned());
        if let Some(key) = alike {
            self.keys_of.borrow_mut().insert(id.to_string(), key.clone());
            return Ok(Asked { id: id.to_string(), key, query: None });
        }
        let query = query()?;
        let key = query.key()?;
        self.keys_of.borrow_mut().insert(id.to_string(), key.clone());
        signature.map(|s| self.keys_by.borrow_mut().insert(s, key.clone()));
        Ok(Asked { id: id.to_string(), query: Some(query).filter(|_| !self.has_or_scaled(&key)), key })
    }

    /// A similar entry, if such are asked for and one is near enough.
    fn similar(
        &self,
        store: &Store,
        key: &str,
        query: Option<&Query>,
    ) -> Result<Option<Similar>, DeriveError> {
        if let Some(known) = self.scaled.borrow().get(key) {
            return Ok(known.clone());
        }
        let found = match query {
            Some(Query::End(wanted)) if self.derive == Derive::Similar => {
                self.candidates.scaled(store, wanted)?
            }
            Some(Query::Contact(wanted)) if self.derive == Derive::Similar => {
                self.crushed.crushing(store, wanted)?
            }
            _ => None,
        };
        self.scaled.borrow_mut().insert(key.to_string(), found.clone());
        Ok(found)
    }

    /// Whether there is no entry of an end that is crushed, nor one like it, and none is to be computed: the model does without.
    ///
    /// # Errors
    /// If the inputs cannot be written as JSON.
    pub fn lacks_crushing(&self, wanted: &WantedContact) -> Result<bool, DeriveError> {
        Ok(match self.derive {
            Derive::Similar => self.crushed.is_empty() && !self.has(&wanted.key()?),
            Derive::Never => !self.has(&wanted.key()?),
            _ => false,
        })
    }

    /// Whether there is no entry of a line, and none is to be computed, and the model can do without. Lines have no laws of similarity.
    pub fn lacks(&self, line: &WantedStrip) -> Result<bool, DeriveError> {
        Ok(self.derive == Derive::Similar && !self.has(&line.key()?))
    }
}

/// Finds, or computes, the entry for each of some places. Places that are mirror images of each other share one.
pub fn entries(
    places: impl Iterator<Item = Result<Asked, GenerateError>>,
    store: &mut Store,
    at_hand: &Known,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Entries, GenerateError> {
    let mut found = Entries::default();
    let mut wanted: BTreeMap<String, (String, Option<Query>)> = BTreeMap::new();
    for place in places {
        let Asked { id, key, query } = place?;
        found.of_end.insert(id.clone(), key.clone());
        wanted.entry(key).or_insert((id, query));
    }
    let derive = at_hand.derive;
    let began = Instant::now();
    let mut missing = Vec::new();
    for (key, (end, query)) in wanted {
        if at_hand.withdrawn.why(&key).is_some() {
            found.withdrawn.push(at_hand.withdrawn.note(&end, &key));
        }
        if at_hand.is_in_library(&key) {
            let used = at_hand.withdrawn.instead(&key).unwrap_or(&key);
            if used != key {
                found.use_instead(&key, used);
            }
            found.entries.insert(used.to_string(), store.get(used)?);
            continue;
        }
        if let Some(entry) = at_hand.further.get(&key) {
            found.entries.insert(key, entry.clone());
            continue;
        }
        if let Some(similar) = at_hand.similar(store, &key, query.as_ref())? {
            let Similar { words, distance, .. } = similar;
            found.scaled.push(Scaled { end, key: similar.entry.key.clone(), words, distance });
            found.use_instead(&key, &similar.entry.key);
            found.entries.insert(similar.entry.key.clone(), similar.entry);
            continue;
        }
        if let Some(why) = at_hand.withdrawn.why(&key) {
            return Err(GenerateError::Withdrawn { end, key, why });
        }
        missing.extend(query.map(|query| (key, end, query)));
    }
    if matches!(derive, Derive::Never | Derive::Similar) && !missing.is_empty() {
        let ends = missing.into_iter().map(|(_, end, _)| end).collect();
        return Err(GenerateError::Missing { ends, similar: derive == Derive::Similar });
    }
    let count = missing.len();
    for (number, (key, end, query)) in missing.into_iter().enumerate() {
        let entry = query.derive(&end, &|done, all| {
            progress(&format!("curves of {end} ({} of {count}): push {done} of {all}", number + 1));
        })?;
        if derive == Derive::Keep {
            store.put(&entry)?;
        }
        found.derived.push(key.clone());
        found.entries.insert(key, entry);
    }
    found.curves_s = began.elapsed().as_secs_f64();
    Ok(found)
}

/// Share of the compressive capacity \[N\] of an entry that is left over the plastic rotation \[rad\], about the axis that bears it for longer.
pub fn left_under_compression(entry: &Entry, capacity_n: f64) -> Vec<[f64; 2]> {
    let lists = entry.axes.iter().map(|axis| axis.curve.left_under_compression(capacity_n));
    let first_break = |list: &Vec<[f64; 2]>| list.get(1).map_or(0.0, |p| p[0]);
    lists.max_by(|a, b| first_break(a).total_cmp(&first_break(b))).unwrap_or_default()
}

/// Force at which the section of an entry flows as a whole \[N\] over plastic rotation \[rad\]: its law hardens with the strain of the outer fibres of a row of elements, `θ h / (2 s)`.
fn crushing(entry: &Entry) -> Vec<[f64; 2]> {
    let Some(most_n) = entry.compressive_capacity_n else { return Vec::new() };
    let Some(law) = &entry.provenance.inputs.law else { return vec![[0.0, most_n]] };
    let depths = entry.features.mesh_size_m.map_or(1.0, |size| entry.features.depth_m / size);
    flow(law).into_iter().map(|[strain, share]| [2.0 * strain / depths, share * most_n]).collect()
}

/// Stress at which a law flows over that at which it breaks, against plastic strain up to there. A law that softens flows at the stress at which it breaks.
fn flow(law: &Homogenised) -> Vec<[f64; 2]> {
    let table = HardeningTable::new(&law.hardening);
    let rupture = law.rupture_strain();
    let before = law.hardening.iter().map(|p| p.plastic_strain).filter(|strain| *strain < rupture);
    let share = |strain: f64| table.at(strain).0 / table.at(rupture).0;
    let points: Vec<[f64; 2]> = before.chain([rupture]).map(|strain| [strain, share(strain)]).collect();
    let hardens = points.windows(2).all(|p| p[1][1] >= p[0][1]);
    if hardens { points } else { vec![[0.0, 1.0]] }
}

/// The same against plastic shortening \[m\] of a length \[m\]; empty if it does not harden.
pub fn hardening(law: &Homogenised, length_m: f64) -> Vec<[f64; 2]> {
    let points = flow(law);
    if points.len() > 1 {
        points.into_iter().map(|[x, share]| [x * length_m, share]).collect()
    } else {
        Vec::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::library::Origin;

    /// A push under a compressive force goes on behind its end as that without it; a measured fall is the end.
    #[test]
    fn measured_points_are_kept_and_pushes_are_gone_on_with() {
        let record =
            include_str!("../../library/column_hinge/400x400-l1286-bottom-ground-m400@dc3a09f4c564b7b6.json");
        let pushed = Entry::from_text(record).unwrap();
        let curve_of = |entry: &Entry| {
            let entries = BTreeMap::from([(entry.key.clone(), entry.clone())]);
            Entries { entries, ..Entries::default() }.curves().remove(&curve_id(&entry.key, 0)).unwrap()
        };
        let given = &pushed.axes[0].curve.levels;
        let [free, last] = [&given[1], &given[4]];
        assert!(free.axial_force_n == 0.0 && last.fracture_rotation_rad < free.fracture_rotation_rad);
        let own = curve_of(&pushed);
        assert_eq!(own.levels[4].fracture_rotation_rad, free.fracture_rotation_rad);
        for origin in [Origin::Test, Origin::Program] {
            let measured = curve_of(&Entry { origin, ..pushed.clone() });
            assert_eq!(&measured.levels[..given.len()], &given[..]);
            // up to crushing none of the levels beyond bears more, or for longer, than the last one
            assert!(measured.levels.len() > given.len() && measured.check().is_ok());
            for level in &measured.levels[given.len()..] {
                assert_eq!(level.fracture_rotation_rad, last.fracture_rotation_rad);
                assert!(level.peak_nm() < last.peak_nm());
            }
        }
        assert_eq!(curve_of(&Entry { origin: Origin::RcSubmodel, ..pushed.clone() }), own);
    }
}
