//! Hinges at member ends with the curves of their library entries.

use super::bodies::Bodies;
use super::decide::Decision;
use super::through::half_joint_m;
use super::withdrawn::Withdrawn;
use super::{Derive, GenerateError};
use crate::base::hash::ContentHash;
use crate::building::ends::MemberEnd;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::{Building, Face, Homogenised, MemberKind};
use crate::curve::ResistanceCurve;
use crate::fe::mesh::Mesh;
use crate::library::derive::{DeriveError, Wanted};
use crate::library::derive_contact::WantedContact;
use crate::library::derive_strip::WantedStrip;
use crate::library::entry::AxisRecord;
use crate::library::similar::{Candidates, Similar};
use crate::library::{Entry, EntryKind, Store, StoreError};
use crate::material::j2::HardeningTable;
use crate::mbs::model::{Bending, Bushing, CarryOver, Origin};
use crate::rc::pushover::torsion_constant;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::time::Instant;

/// What the joints are placed in.
pub struct Place<'a> {
    pub building: &'a Building,
    pub partition: &'a Partition,
    pub mesh: &'a Mesh,
    pub bodies: &'a Bodies,
}

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

/// Entries of a kind made without a run of which notes speak, the farthest ones.
const NOTED: usize = 3;

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
                notes.push(format!(
                    "{more} more of {kind} have no entries of their own, and nearer ones to scale: `fallwerk explain` tells of each"
                ));
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

    /// The curves of all entries as they work in a structure, `KEY/axis-1` and `KEY/axis-2`.
    pub fn curves(&self) -> BTreeMap<String, ResistanceCurve> {
        self.entries
            .iter()
            .flat_map(|(key, e)| {
                let crushing = crushing(e);
                let whole = move |axis: &AxisRecord| axis.curve.in_a_structure(&crushing);
                e.axes.iter().enumerate().map(move |(i, a)| (curve_id(key, i), whole(a)))
            })
            .collect()
    }
}

/// Share of the compressive capacity \[N\] of an entry that is left over the plastic rotation \[rad\], about the axis that bears it for longer.
fn left_under_compression(entry: &Entry, capacity_n: f64) -> Vec<[f64; 2]> {
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

/// The same against plastic shortening \[m\], up to that at which a member is crushed; empty if it does not harden.
fn hardening(law: &Homogenised, crushed_m: f64) -> Vec<[f64; 2]> {
    let points = flow(law);
    let scale = crushed_m / law.rupture_strain();
    if points.len() > 1 {
        points.into_iter().map(|[x, share]| [x * scale, share]).collect()
    } else {
        Vec::new()
    }
}

pub fn curve_id(key: &str, axis: usize) -> String {
    format!("{key}/axis-{}", axis + 1)
}

/// What the entry of a column end is asked for, from a mesh around it.
///
/// # Errors
/// If it touches nothing, or lies elsewhere in the mesh.
pub fn query(place: &Place, mesh: &Mesh, end: &MemberEnd) -> Result<Query, GenerateError> {
    let wanted = Wanted::of(place.building, place.partition, mesh, end);
    wanted.map(Query::End).ok_or_else(|| without_section(mesh, end))
}

/// Why there is no section at a member end in the mesh.
fn without_section(mesh: &Mesh, end: &MemberEnd) -> GenerateError {
    let (id, at_m) = (end.id.clone(), end.point_m[end.axis]);
    let own = mesh.elements.iter().filter(|e| e.part == end.member).flat_map(|e| e.nodes);
    let off = |z: &f64| (z - at_m).abs();
    match own.map(|n| mesh.nodes[n][end.axis]).min_by(|a, b| off(a).total_cmp(&off(b))) {
        Some(mesh_m) if off(&mesh_m) > COORDINATE_TOLERANCE_M => {
            GenerateError::Moved { end: id, axis: ['x', 'y', 'z'][end.axis], at_m, mesh_m }
        }
        _ => GenerateError::Loose(id),
    }
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
            keys: store.keys(),
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
        if at_hand.withdrawn.reason(&key).is_some() {
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
        if let Some(reason) = at_hand.withdrawn.reason(&key) {
            let (key, reason) = (key.clone(), reason.to_string());
            return Err(GenerateError::Withdrawn { end, key, reason });
        }
        missing.extend(query.map(|query| (key, end, query)));
    }
    if matches!(derive, Derive::Never | Derive::Similar) && !missing.is_empty() {
        return Err(GenerateError::Missing(missing.into_iter().map(|(_, end, _)| end).collect()));
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

/// Whether there is something that an end may be joined to: a body, or the ground.
pub fn is_joined(place: &Place, end: &MemberEnd) -> bool {
    let beyond = end.beyond(place.partition);
    let stands = || stands(place.building, end.member, (end.axis, end.point_m), beyond);
    beyond.and_then(|m| place.bodies.of(m, end.point_m)).is_some() || stands()
}

/// One joint for each hinged end.
pub fn hinges(
    place: &Place,
    ends: &[&MemberEnd],
    found: &Entries,
    decision: &Decision,
) -> Result<Vec<Bushing>, GenerateError> {
    let mut joints = Vec::new();
    for end in ends {
        let Some(own) = place.bodies.of(end.member, end.point_m) else { continue };
        let other = end.beyond(place.partition).and_then(|m| place.bodies.of(m, end.point_m));
        let key = &found.of_end[&end.id];
        let entry = found
            .entries
            .get(key)
            .ok_or_else(|| StoreError::NotFound { key: key.clone(), hint: String::new() })?;
        let hinge = entry.hinge()?;
        let is_elastic = decision.elastic.contains(&end.id);
        let bending = [0, 1].map(|axis| match entry.axes[axis].curve.stiffness_nm_rad {
            stiffness_nm_rad if is_elastic => Bending::Elastic { stiffness_nm_rad },
            _ => Bending::Curve { curve: curve_id(key, axis), strength_factor: 1.0 },
        });
        let half = Prism::of(place.building, end);
        let with_joint = Prism { length_m: half.length_m + half_joint_m(place, end), ..half };
        let law = place.building.law_of(&place.building.members[end.member]);
        // what does not yield neither breaks nor crushes
        let capacity = |capacity: Option<f64>| capacity.filter(|_| !is_elastic);
        joints.push(Bushing {
            axial_stiffness_n_m: with_joint.axial_n_m(),
            shear_stiffness_n_m: hinge.stiffness.shear_n_m,
            torsional_stiffness_nm_rad: hinge.stiffness.torsion_nm_rad,
            bending,
            tensile_capacity_n: capacity(entry.tensile_capacity_n),
            tensile_elongation_m: capacity(entry.tensile_elongation_m),
            compressive_capacity_n: capacity(entry.compressive_capacity_n),
            compressive_hardening: capacity(entry.tensile_elongation_m)
                .map_or_else(Vec::new, |crushed_m| hardening(law, crushed_m)),
            compressive_fading: capacity(entry.compressive_capacity_n)
                .map_or_else(Vec::new, |most_n| left_under_compression(entry, most_n)),
            crushing_shortening_m: capacity(entry.tensile_elongation_m),
            associated_flow: true,
            origin: Origin {
                members: vec![end.id.clone()],
                rules: decision.hinges[&end.id].clone(),
                entries: vec![key.clone()],
            },
            ..Bushing::free(
                end.id.clone(),
                other.map(|o| place.bodies.list[o].id.clone()),
                place.bodies.list[own].id.clone(),
                hinge_point(end, hinge.offset_m),
                axes(end.axis, end.outward),
            )
        });
    }
    Ok(joints)
}

/// A stretch of a member, that from an end up to the middle of its clear length for instance.
pub struct Prism {
    pub length_m: f64,
    /// Across axes 1 and 2 of its joints \[m\].
    section_m: [f64; 2],
    /// Young's and shear modulus \[Pa\].
    moduli_pa: [f64; 2],
}

impl Prism {
    /// That at an end.
    fn of(building: &Building, end: &MemberEnd) -> Self {
        Self::along(building, end.member, end.axis, 0.5 * end.clear_m)
    }

    /// A length of a member along an axis \[m\].
    pub fn along(building: &Building, member: usize, axis: usize, length_m: f64) -> Self {
        let member = &building.members[member];
        let law = building.law_of(member);
        Self {
            length_m,
            section_m: [1, 2].map(|i| member.solid.size()[(axis + i) % 3]),
            moduli_pa: [law.youngs_modulus_pa, law.shear_modulus_pa()],
        }
    }

    /// Axial stiffness `E A / l` \[N/m\]. The submodel of an end has less, since its force goes into the floor around it: in a building it goes on to the next column, and what bends is the floor.
    pub fn axial_n_m(&self) -> f64 {
        self.moduli_pa[0] * self.section_m[0] * self.section_m[1] / self.length_m
    }

    /// Stiffness against rotation \[N m/rad\] about joint axis `k` under a force across in the middle, at a hinge so far from there \[m\]: `k = a² / (l³ / (3 E I) + l / (G A_s))`.
    fn turn_nm_rad(&self, k: usize, arm_m: f64) -> f64 {
        let bent = self.length_m.powi(3) / (3.0 * self.bending_nm2(k));
        arm_m * arm_m / (bent + self.length_m / self.shear_n())
    }

    /// Shear stiffness `G A_s` \[N\].
    pub fn shear_n(&self) -> f64 {
        5.0 / 6.0 * self.moduli_pa[1] * self.section_m[0] * self.section_m[1]
    }

    /// Torsional stiffness `G J` \[N m²\].
    pub fn torsion_nm2(&self) -> f64 {
        self.moduli_pa[1] * torsion_constant(self.section_m)
    }

    /// Bending stiffness about joint axis `k` \[N m²\].
    pub fn bending_nm2(&self, k: usize) -> f64 {
        self.moduli_pa[0] * self.section_m[k] * self.section_m[1 - k].powi(3) / 12.0
    }

    /// From a hinge to the middle \[m\].
    fn arm_m(&self, hinge: &Bushing, end: &MemberEnd) -> f64 {
        self.length_m - (hinge.point_m[end.axis] - end.point_m[end.axis]).abs()
    }
}

/// Takes the flexibility of a floor that bends out of the hinges of the columns at it: its own springs have that already. What is left is the column up to the middle of its clear length.
pub fn without_joint(
    place: &Place,
    ends: &[&MemberEnd],
    hinges: &mut [Bushing],
    curves: &mut BTreeMap<String, ResistanceCurve>,
) {
    let ends: BTreeMap<&str, &MemberEnd> = ends.iter().map(|e| (e.id.as_str(), *e)).collect();
    for hinge in hinges {
        let Some(end) = ends.get(hinge.id.as_str()) else { continue };
        let other = end.beyond(place.partition).and_then(|m| place.bodies.of(m, end.point_m));
        if !other.is_some_and(|o| place.bodies.is_bending(o)) {
            continue;
        }
        let half = Prism::of(place.building, end);
        let arm_m = half.arm_m(hinge, end);
        for k in 0..2 {
            let alone = half.turn_nm_rad(k, arm_m);
            match &mut hinge.bending[k] {
                Bending::Elastic { stiffness_nm_rad } => *stiffness_nm_rad = alone,
                Bending::Curve { curve, .. } => {
                    let id = format!("{curve}/{alone:.6e}");
                    if let Some(own) = curves.get(curve) {
                        let own = ResistanceCurve { stiffness_nm_rad: alone, ..own.clone() };
                        curves.insert(id.clone(), own);
                        *curve = id;
                    }
                }
            }
        }
    }
}

/// Lets columns bend between hinges at both of their ends: `d = (L / (2 E I) - 1 / k) / 2`, with which both ends turn by `M L / (2 E I)` in pure bending, and by `M / k` in sway as they did.
pub fn carry_over(place: &Place, ends: &[&MemberEnd], hinges: &mut [Bushing]) {
    let mut first: BTreeMap<usize, usize> = BTreeMap::new();
    let ends: BTreeMap<&str, &MemberEnd> = ends.iter().map(|e| (e.id.as_str(), *e)).collect();
    for i in 0..hinges.len() {
        let Some(end) = ends.get(hinges[i].id.as_str()) else { continue };
        let Some(other) = first.insert(end.member, i) else { continue };
        let own = place.bodies.all_of(end.member);
        let is_own = |h: &Bushing| own.iter().any(|b| place.bodies.list[*b].id == h.body_b);
        if ![other, i].iter().all(|k| is_own(&hinges[*k])) {
            continue;
        }
        let half = Prism::of(place.building, end);
        let arms_m = [(&hinges[i], *end), (&hinges[other], ends[hinges[other].id.as_str()])]
            .map(|(hinge, end)| half.arm_m(hinge, end));
        let flexibility_rad_nm = [0, 1].map(|k| {
            let turns = |arm_m: f64| 1.0 / half.turn_nm_rad(k, arm_m);
            let bent = half.length_m / half.bending_nm2(k) - 0.5 * (turns(arms_m[0]) + turns(arms_m[1]));
            // a member so short that it shears more than it bends carries nothing over
            (0.5 * bent).max(0.0)
        });
        let bushing = hinges[other].id.clone();
        hinges[i].carry_over = Some(CarryOver { bushing, flexibility_rad_nm });
    }
}

/// The hinge stands inside the member, where the library found its pole \[m\].
fn hinge_point(end: &MemberEnd, offset_m: f64) -> [f64; 3] {
    let mut point = end.point_m;
    point[end.axis] += end.outward * offset_m;
    point
}

/// Joint axes of a member along `axis` that extends to larger coordinates (`outward` +1) or smaller ones: axis 0 points from the other body into the member, so that a positive axial
/// displacement is tension; axes 1 and 2 follow the section's directions, turned to stay right-handed.
pub fn axes(axis: usize, outward: f64) -> [[f64; 3]; 3] {
    let unit = |i: usize, sign: f64| {
        let mut e = [0.0; 3];
        e[i] = sign;
        e
    };
    [unit(axis, outward), unit((axis + 1) % 3, 1.0), unit((axis + 2) % 3, outward)]
}

/// Whether a member is a footing that is held: it does not move, and what stands on it stands on the ground.
pub fn is_ground(building: &Building, member: usize) -> bool {
    let member = &building.members[member];
    member.kind == MemberKind::Footing && building.supports.iter().any(|s| s.member == member.id)
}

/// Whether a member stands at its end, along an axis at a place, on the ground: on a support of its own, or on a footing that is held.
pub fn stands(
    building: &Building,
    member: usize,
    (axis, point_m): (usize, [f64; 3]),
    beyond: Option<usize>,
) -> bool {
    axis == 2 && on_support(building, member, point_m[2]) || beyond.is_some_and(|m| is_ground(building, m))
}

/// Whether a member stands on, or hangs from, a supported face at a level.
fn on_support(building: &Building, member: usize, level_m: f64) -> bool {
    let member = &building.members[member];
    building.supports.iter().filter(|s| s.member == member.id).any(|s| {
        let z = match s.face {
            Face::Bottom => member.solid.min[2],
            Face::Top => member.solid.max[2],
        };
        (level_m - z).abs() < 1e-6
    })
}
