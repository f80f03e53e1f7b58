//! Entries of the library for all column ends of a building, hinges and ends that are crushed by what they strike, whatever the rules make of them.

use super::rc::Bending;
use crate::building::ends::member_ends;
use crate::building::partition::Partition;
use crate::building::{Building, MemberKind};
use crate::fe::mesh::Mesh;
use crate::fe::weld::{self, Welds};
use crate::library::derive::{DeriveError, Wanted};
use crate::library::derive_contact::WantedContact;
use crate::library::rc::{RC_UNTIL_RAD, RcDeriveError, RcWanted};
use crate::library::rc_kinds;
use crate::library::rc_springs::RcSpringError;
use crate::library::{Store, StoreError};
use crate::rc::anchorage::Anchorage;
use crate::rc::member::Joint;
use crate::rc::{RcSection, SeriesOptions};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// What to derive.
#[derive(Debug, Clone, clap::Args)]
pub struct Arguments {
    /// The building file
    #[arg(required_unless_present_any = ["section", "grid"], conflicts_with_all = ["section", "grid"])]
    pub building: Option<PathBuf>,
    /// Entries of sections in concrete and steel, from section files (`fallwerk rc --example`)
    #[arg(long, value_name = "SECTION", num_args = 1..)]
    pub section: Vec<PathBuf>,
    /// Entries of all sections of a grid file (`fallwerk rc --example-grid`)
    #[arg(long, value_name = "GRID", num_args = 1..)]
    pub grid: Vec<PathBuf>,
    /// Bend sections in elements of twice the size as well, and state in the quality of their entries how much that changes
    #[arg(long)]
    pub check_mesh: bool,
    /// What to make of a section: its hinge (of a slab: the yield line), springs, crushing in contact [default: hinge]
    #[arg(long, value_name = "WHAT", num_args = 1.., value_delimiter = ',', value_parser = clap::builder::PossibleValuesParser::new(super::library_springs::MAKES))]
    pub make: Vec<String>,
    /// Compute entries that are there anew
    #[arg(long)]
    pub again: bool,
    /// How sections are meshed and bent
    #[command(flatten)]
    pub bending: super::rc::Bending,
}

/// What became of the entries of a building, by key.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Derived {
    /// Computed and put into the library.
    pub added: Vec<String>,
    /// Already there.
    pub present: Vec<String>,
    /// Levels of axial force that entries lack, in words.
    pub left_out: Vec<String>,
}

/// Why entries could not be derived. Those computed before are in the library.
#[derive(Debug, thiserror::Error)]
pub enum LibraryDeriveError {
    /// The submodel failed.
    #[error("{end}: {source}")]
    Derive {
        /// Member end id.
        end: String,
        /// Why.
        source: DeriveError,
    },
    /// The RC submodel failed.
    #[error("{section}: {source}")]
    Rc {
        /// Name of the section.
        section: String,
        /// Why.
        source: RcDeriveError,
    },
    /// A spring of a section failed.
    #[error("{section}: {source}")]
    Spring {
        /// Name of the section.
        section: String,
        /// Why.
        source: RcSpringError,
    },
    /// A member is turned out of the axes.
    #[error("{0}")]
    Skew(String),
    /// The mesh joins members that stand apart.
    #[error(transparent)]
    Welded(#[from] Welds),
    /// The library refused.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// Who hears of it.
pub struct Watch<'a> {
    /// Share done (0 to 1) and what is being computed.
    pub progress: &'a (dyn Fn(f64, &str) + Sync),
    /// Key of an entry that is in the library now.
    pub added: &'a dyn Fn(&str),
}

/// Computes what the library lacks for the column ends of a building and stores each entry as soon as it is done, so that a
/// run that was interrupted goes on behind the last one.
///
/// With `again` entries that are there are computed anew. Ends that are mirror images share an entry; columns cut away in
/// preparation have none.
///
/// # Errors
/// If a submodel fails or the library cannot be written.
pub fn derive_for(
    building: &Building,
    store: &mut Store,
    again: bool,
    watch: &Watch,
) -> Result<Derived, LibraryDeriveError> {
    building.without_skew("no curves can be derived").map_err(LibraryDeriveError::Skew)?;
    store.writable()?;
    let mut derived = Derived::default();
    let mut missing = Vec::new();
    let known = store.usable_keys();
    for (key, (end, wanted)) in wanted(building)? {
        if again || known.binary_search(&key).is_err() {
            missing.push((key, end, wanted));
        } else {
            derived.present.push(key);
        }
    }
    let count = missing.len();
    for (number, (key, end, wanted)) in missing.into_iter().enumerate() {
        let tell = |done: usize, all: usize| {
            let share = (number as f64 + done as f64 / all.max(1) as f64) / count as f64;
            (watch.progress)(share, &format!("of {end} ({} of {count}): push {done} of {all}", number + 1));
        };
        let entry = match wanted {
            Asked::Hinge(hinge) => hinge.derive(&end, &tell),
            Asked::Crushing(end) => end.derive(),
        }
        .map_err(failed(&end))?;
        store.put(&entry)?;
        (watch.added)(&key);
        derived.added.push(key);
    }
    Ok(derived)
}

/// What a column end asks for.
enum Asked {
    Hinge(Box<Wanted>),
    Crushing(Box<WantedContact>),
}

/// The entries that the column ends ask for, by key, each with the first end that does.
fn wanted(building: &Building) -> Result<BTreeMap<String, (String, Asked)>, LibraryDeriveError> {
    let partition = Partition::of(building);
    let (mesh, _) = Mesh::of(building, building.settings.mesh_size_m);
    weld::check(building, &mesh, building.settings.mesh_size_m)?;
    let mut wanted = BTreeMap::new();
    for end in member_ends(building, &partition) {
        let member = &building.members[end.member];
        if member.kind != MemberKind::Column || building.is_cut(&member.id) {
            continue;
        }
        let key =
            |key: Result<String, serde_json::Error>| key.map_err(DeriveError::from).map_err(failed(&end.id));
        if let Some(query) = Wanted::of(building, &partition, &mesh, &end) {
            let asked = || (end.id.clone(), Asked::Hinge(Box::new(query.clone())));
            wanted.entry(key(query.key())?).or_insert_with(asked);
        }
        if end.clear_m > 0.0 {
            let query = WantedContact::of(building, &end);
            let key = key(query.key())?;
            wanted.entry(key).or_insert_with(|| (end.id.clone(), Asked::Crushing(Box::new(query))));
        }
    }
    Ok(wanted)
}

fn failed(end: &str) -> impl FnOnce(DeriveError) -> LibraryDeriveError + '_ {
    move |source| LibraryDeriveError::Derive { end: end.to_string(), source }
}

/// Member ends of buildings are those of tests: on a block out of which their bars slip, unless the command line asks for a plane of symmetry
/// (`docs/rc-columns.md` has the comparison).
fn joint(bending: &Bending) -> Joint {
    bending.joint.unwrap_or(Joint::Block)
}

/// The section, with slip of its bars out of a block if it does not say how they are anchored.
fn as_tested(section: RcSection, bending: &Bending) -> RcSection {
    let slip = joint(bending) == Joint::Block;
    RcSection { anchorage: section.anchorage.or(slip.then_some(Anchorage::LONG)), ..section }
}

/// Computes what the library lacks for sections in concrete and steel, and stores each entry as soon as it is done. Axial forces, rotation and
/// mesh are those of `bending`; with `check_mesh` the bends are run in coarser elements as well.
///
/// # Errors
/// If a submodel fails or the library cannot be written; entries computed before are in the library.
pub fn derive_sections(
    sections: &[RcSection],
    what: &Arguments,
    store: &mut Store,
    watch: &Watch,
) -> Result<Derived, LibraryDeriveError> {
    store.writable()?;
    let (bending, again) = (&what.bending, what.again);
    let mut derived = Derived::default();
    let mut missing: BTreeMap<String, RcWanted> = BTreeMap::new();
    let known = store.usable_keys();
    for section in sections {
        let section = as_tested(bending.section(section.clone()), bending);
        let failed = |e: serde_json::Error| rc_failed(&section)(RcDeriveError::from(e));
        let options = bending.options(rc_kinds::axial_shares(&section), RC_UNTIL_RAD);
        let options = SeriesOptions { joint: joint(bending), ..bending.meshed(&options, &section) };
        let mut wanted = RcWanted::of(&section, &options).map_err(failed)?;
        wanted.check_mesh = what.check_mesh;
        let key = wanted.key().map_err(failed)?;
        if again || known.binary_search(&key).is_err() {
            missing.insert(key, wanted);
        } else if !derived.present.contains(&key) {
            derived.present.push(key);
        }
    }
    let count = missing.len();
    for (number, (key, wanted)) in missing.into_iter().enumerate() {
        let name = &wanted.section.name;
        let tell = |share: f64, text: &str| {
            let share = (number as f64 + share) / count as f64;
            (watch.progress)(share, &format!("of {name} ({} of {count}): {text}", number + 1));
        };
        let done = wanted.derive(&tell).map_err(rc_failed(&wanted.section))?;
        store.put(&done.entry)?;
        (watch.added)(&key);
        derived.left_out.extend(done.left_out.iter().map(|what| format!("{name}: {what}")));
        derived.added.push(key);
    }
    Ok(derived)
}

fn rc_failed(section: &RcSection) -> impl FnOnce(RcDeriveError) -> LibraryDeriveError + '_ {
    move |source| LibraryDeriveError::Rc { section: section.name.clone(), source }
}
