//! Hinges that do not stand in the section at which the axial force of a push acts.

use super::entries::Entries;
use crate::curve::ResistanceCurve;
use crate::library::Entry;
use crate::library::entry::Origin;
use crate::mbs::model::{Bending, Bushing};
use std::collections::BTreeMap;

/// Puts the moment of the axial force about the hinges ([`ResistanceCurve::at_distance`]) into the curves of all ends that come from pushes. Hinges between the ends of a member stand in the section that bends, and take their curves before.
pub fn put_in(hinges: &[Bushing], found: &Entries, curves: &mut BTreeMap<String, ResistanceCurve>) {
    let mut levers: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    for hinge in hinges {
        let entry = found.of_end.get(&hinge.id).and_then(|key| found.entries.get(key));
        let Some(lever) = entry.and_then(lever) else { continue };
        levers.extend(hinge.bending.iter().filter_map(Bending::curve).map(|id| (id.as_str(), lever)));
    }
    for (id, [offset_m, length_m]) in levers {
        if let Some(curve) = curves.get_mut(id) {
            *curve = curve.at_distance(offset_m, length_m);
        }
    }
}

/// Distances of hinge and far section from the end section of a push \[m\].
fn lever(entry: &Entry) -> Option<[f64; 2]> {
    let pushed = entry.origin == Origin::Submodel;
    Some([entry.hinge_offset_m?, entry.features.length_to_inflection_m?]).filter(|_| pushed)
}
