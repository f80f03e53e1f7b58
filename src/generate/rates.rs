//! Strength that grows with the rate at which joints flow, of members whose law has a rate factor.
//!
//! The law has it with the rate of plastic strain ([`CowperSymonds`]); a joint with that of its rotation and elongation. A section that has turned by `θ_b` when its first layer breaks has the rupture strain `ε_r` there, so a rotation at
//! `θ'` strains it at `θ' ε_r / θ_b`; what is pulled apart after an elongation `u_b` at `u' ε_r / u_b`. Curves are those of slow pushes, and no history of the building says anything here.

use crate::building::{Building, CowperSymonds, Homogenised};
use crate::curve::ResistanceCurve;
use crate::library::Entry;
use crate::mbs::model::{Bushing, FaceRate, RateFactor};
use std::collections::BTreeMap;

/// Gives the bushings of such members their factor, by the curves that they follow.
pub fn put_in(building: &Building, bushings: &mut [Bushing], curves: &BTreeMap<String, ResistanceCurve>) {
    let laws: BTreeMap<&str, &Homogenised> =
        building.members.iter().map(|m| (m.id.as_str(), building.law_of(m))).collect();
    if laws.values().all(|law| law.rate_factor.is_none()) {
        return;
    }
    for bushing in bushings.iter_mut().filter(|b| b.flows()) {
        // `C1-A1.top` is an end of `C1-A1`
        let of_member =
            |id: &String| laws.get(id.as_str()).or_else(|| laws.get(id.rsplit_once('.')?.0)).copied();
        let Some(law) = bushing.origin.members.iter().find_map(of_member) else { continue };
        bushing.rate_factor = law.rate_factor.map(|factor| of(bushing, law, factor, curves));
    }
}

/// That of a bushing. Axes that do not yield have the one of the other.
fn of(
    bushing: &Bushing,
    law: &Homogenised,
    CowperSymonds { c_1_s, p }: CowperSymonds,
    curves: &BTreeMap<String, ResistanceCurve>,
) -> RateFactor {
    let rupture = law.rupture_strain();
    let breaks_rad = |axis: usize| Some(curves.get(bushing.bending[axis].curve()?)?.first_break_rad());
    let of_axis = |axis: usize| breaks_rad(axis).or_else(|| breaks_rad(1 - axis)).unwrap_or(rupture);
    RateFactor {
        rotation_rad_s: [0, 1].map(|axis| c_1_s * of_axis(axis) / rupture),
        elongation_m_s: bushing
            .tensile_elongation_m
            .filter(|u| *u > 0.0 && bushing.flows_along())
            .map(|u| c_1_s * u / rupture),
        exponent: p,
    }
}

/// That of the face of a member that is crushed, by its entry: up to its point of inflection all of it flows before the first layer breaks.
pub fn of_face(law: &Homogenised, entry: &Entry) -> Option<FaceRate> {
    let (factor, length_m) = (law.rate_factor?, entry.features.length_to_inflection_m?);
    Some(FaceRate { speed_m_s: factor.c_1_s * length_m, exponent: factor.p })
}
