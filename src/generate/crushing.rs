//! Ends of columns that may be crushed by what they strike, with the resistance of their library entries.
//!
//! Rules about contacts put a contact subsystem in ([`super::event_rules::puts_contact_in`]). A face without contact costs nothing and one that bears what it is asked for changes nothing, so that the subsystem is there from the
//! begin for the columns that such rules are about: those of buildings that fall.

use super::GenerateError;
use super::bodies::Bodies;
use super::decide::Decision;
use super::entries::{Entries, Known};
use super::rates;
use crate::building::Building;
use crate::building::ends::{End, MemberEnd};
use crate::library::Entry;
use crate::library::derive_contact::WantedContact;
use crate::library::thin::thinned;
use crate::mbs::model::{CrushedFace, Face, Shape};
use std::collections::{BTreeMap, BTreeSet};

/// Plastic shortening over the elastic one at which a curve has left its elastic line.
const YIELDS: f64 = 0.1;
/// Points of a curve in a model.
const POINTS: usize = 16;

/// Columns whose ends may be crushed, with the places at which their entries are asked for: one for all that are alike.
#[derive(Debug, Default)]
pub struct Struck {
    /// Place of each column.
    place_of: BTreeMap<usize, String>,
    /// What is asked for at each place.
    pub wanted: BTreeMap<String, WantedContact>,
}

impl Struck {
    /// The columns that may break once something has happened to them, and those of which charges leave stumps.
    pub fn of(building: &Building, ends: &[MemberEnd], decision: &Decision, bodies: &Bodies) -> Self {
        let mut struck = Self::default();
        let mut alike = BTreeMap::<(String, [u64; 3]), String>::new();
        let may: BTreeSet<usize> =
            decision.sections().map(|(member, _)| member).chain(bodies.stumps().map(|s| s.member)).collect();
        for end in ends.iter().filter(|e| e.end == End::Lower && e.clear_m > 0.0 && may.contains(&e.member)) {
            let member = &building.members[end.member];
            let size = member.solid.size();
            let numbers = [end.clear_m, size[(end.axis + 1) % 3], size[(end.axis + 2) % 3]];
            let numbers = numbers.map(|m| (m * 1e6).round() as u64);
            let weakened = building.strength_factor(&member.id);
            let key = (format!("{}/{weakened}", member.section), numbers);
            let place = alike.entry(key).or_insert_with(|| format!("{}.crushing", member.id)).clone();
            struck.wanted.entry(place.clone()).or_insert_with(|| WantedContact::of(building, end));
            struck.place_of.insert(end.member, place);
        }
        struck
    }

    /// Those for which the library has an entry, or one is to be made; a note of the others.
    ///
    /// # Errors
    /// If the inputs of an entry cannot be written as JSON.
    pub fn known_to(mut self, library: &Known, notes: &mut Vec<String>) -> Result<Self, GenerateError> {
        let mut lacking = Vec::new();
        for (place, wanted) in &self.wanted {
            if library.lacks_crushing(wanted)? {
                lacking.push(place.clone());
            }
        }
        for place in &lacking {
            self.wanted.remove(place);
            notes.push(format!("{place}: the library has no contact_crushing entry for it, nor one like it: its ends are rigid in contact"));
        }
        Ok(self)
    }

    /// The faces at both ends of the columns and of their stumps, as far as there are entries and each is one box.
    pub fn faces(&self, building: &Building, bodies: &Bodies, found: &Entries) -> Vec<CrushedFace> {
        let mut faces = Vec::new();
        for (member, place) in &self.place_of {
            let Some((key, entry)) = found.of_end.get(place).and_then(|k| Some((k, found.entries.get(k)?)))
            else {
                continue;
            };
            let (force_n, axis) = (resistance(entry), building.members[*member].axis);
            let own = bodies.all_of(*member);
            let stumps = bodies.stumps_of(*member);
            let faces_of = match (stumps, own.first(), own.last()) {
                (Some(stumps), ..) => stumps
                    .faces(low(axis), high(axis))
                    .map(|(k, face, share)| (own[k], face, share))
                    .collect(),
                (None, Some(first), Some(last)) => vec![(*first, low(axis), 1.0), (*last, high(axis), 1.0)],
                _ => Vec::new(),
            };
            for (index, face, share) in faces_of {
                let body = &bodies.list[index];
                if !matches!(body.shapes[..], [Shape::Box { .. }]) {
                    continue;
                }
                if !force_n.is_empty() && body.origin.members == [building.members[*member].id.clone()] {
                    faces.push(CrushedFace {
                        body: body.id.clone(),
                        shape: 0,
                        face,
                        rate_factor: rates::of_face(building.law_of(&building.members[*member]), entry),
                        force_n: force_n.iter().map(|[way, force]| [share * way, *force]).collect(),
                        subsystem: Some(key.clone()),
                    });
                }
            }
        }
        faces
    }
}

fn low(axis: usize) -> Face {
    [Face::LowX, Face::LowY, Face::LowZ][axis]
}

fn high(axis: usize) -> Face {
    [Face::HighX, Face::HighY, Face::HighZ][axis]
}

/// Force over plastic shortening, from its beginning: boxes are rigid until they flow.
fn resistance(entry: &Entry) -> Vec<[f64; 2]> {
    let Some((spring, level)) = entry.springs.first().and_then(|s| Some((s, s.levels.first()?))) else {
        return Vec::new();
    };
    let mut line: Vec<[f64; 2]> = Vec::new();
    for [way, force] in &level.points {
        let elastic = force / spring.stiffness_n_m;
        let plastic = way - elastic;
        let last = line.last().map_or(YIELDS * elastic, |p| p[0]);
        if plastic > last {
            line.push([plastic, *force]);
        }
    }
    let Some(first) = line.first().copied() else { return Vec::new() };
    line.insert(0, [0.0, first[1]]);
    thinned(&line, POINTS)
}
