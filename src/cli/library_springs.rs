//! Entries of springs for sections in concrete and steel.

use super::library_derive::{Derived, LibraryDeriveError, Watch};
use crate::library::rc_springs::{RcSpringError, RcSpringWanted};
use crate::library::{EntryKind, Store, StoreError};
use crate::rc::RcSection;
use std::collections::BTreeMap;

/// Names of what `library derive --make` makes of a section.
pub const MAKES: [&str; 6] = ["hinge", "axial", "shear", "torsion", "contact", "all"];

/// Kinds of springs that these names ask for.
fn kinds(makes: &[String]) -> Vec<EntryKind> {
    let named = [
        ("axial", EntryKind::AxialSpring),
        ("shear", EntryKind::ShearSpring),
        ("torsion", EntryKind::TorsionSpring),
        ("contact", EntryKind::ContactCrushing),
    ];
    let asked = |name: &str| makes.iter().any(|m| m == name || m == "all");
    named.into_iter().filter(|(name, _)| asked(name)).map(|(_, kind)| kind).collect()
}

/// Whether these names ask for hinges, as none at all does.
pub fn makes_hinges(makes: &[String]) -> bool {
    makes.is_empty() || makes.iter().any(|m| m == "hinge" || m == "all")
}

/// Computes the springs that the library lacks for sections, and stores each entry as soon as it is done; adds to `derived` what became of them.
///
/// # Errors
/// If a run fails that an entry cannot do without, or the library cannot be written; entries computed before are in the library.
pub fn derive(
    sections: &[RcSection],
    what: &super::library_derive::Arguments,
    store: &mut Store,
    watch: &Watch,
    mut derived: Derived,
) -> Result<Derived, LibraryDeriveError> {
    let options = what.bending.options(&[], 0.0);
    let shares = (!what.bending.axial.is_empty()).then_some(what.bending.axial.as_slice());
    let mut missing: BTreeMap<String, RcSpringWanted> = BTreeMap::new();
    let known = store.usable_keys();
    for section in sections {
        let section = what.bending.section(section.clone());
        let failed = |e: serde_json::Error| spring_failed(&section)(RcSpringError::from(e));
        for kind in kinds(&what.make) {
            let Some(wanted) = RcSpringWanted::of(&section, kind, &options, shares).map_err(failed)? else {
                derived.left_out.push(format!("{}: a slab has no {}", section.name, kind.words()));
                continue;
            };
            let key = wanted.key().map_err(failed)?;
            if what.again || known.binary_search(&key).is_err() {
                missing.insert(key, wanted);
            } else if !derived.present.contains(&key) {
                derived.present.push(key);
            }
        }
    }
    let count = missing.len();
    for (number, (key, wanted)) in missing.into_iter().enumerate() {
        let name = format!("{} of {}", wanted.kind.words(), wanted.section.name);
        let tell = |share: f64, text: &str| {
            let share = (number as f64 + share) / count as f64;
            (watch.progress)(share, &format!("{name} ({} of {count}): {text}", number + 1));
        };
        let (entry, left_out) = wanted.derive(&tell).map_err(spring_failed(&wanted.section))?;
        store.put(&entry).map_err(|e: StoreError| LibraryDeriveError::Store(e))?;
        (watch.added)(&key);
        derived.left_out.extend(left_out.iter().map(|what| format!("{name}: {what}")));
        derived.added.push(key);
    }
    Ok(derived)
}

fn spring_failed(section: &RcSection) -> impl FnOnce(RcSpringError) -> LibraryDeriveError + '_ {
    move |source| LibraryDeriveError::Spring { section: section.name.clone(), source }
}
