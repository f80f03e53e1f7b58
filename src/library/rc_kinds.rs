//! What the entry of a section in concrete and steel is, by the member it belongs to: columns and walls bend about both axes, beams and strips of slabs
//! in the vertical plane, and the numbers of a slab are those of a strip of one metre.

use super::entry::{Computed, EntryKind, EnvelopeLevel, Features};
use super::parts::AxisRecord;
use super::rc::RC_AXIAL_SHARES;
use crate::building::MemberKind;
use crate::curve::ResistanceCurve;
use crate::rc::RcSection;

/// Axial forces of entries of beams and slabs over `f_c A`, compression positive.
pub const RC_FLAT_AXIAL_SHARES: [f64; 3] = [-0.05, 0.0, 0.1];
/// Width of the strip whose moments a yield line has \[m\].
pub const STRIP_M: f64 = 1.0;

/// Kind of the entry of a section's bending.
pub fn kind(section: &RcSection) -> EntryKind {
    match section.member {
        MemberKind::Beam => EntryKind::BeamHinge,
        MemberKind::Slab => EntryKind::SlabYieldLine,
        MemberKind::Wall => EntryKind::WallHinge,
        _ => EntryKind::ColumnHinge,
    }
}

/// Whether it bends in the vertical plane only.
pub fn is_flat(section: &RcSection) -> bool {
    matches!(section.member, MemberKind::Beam | MemberKind::Slab)
}

/// Axial forces of its entry over `f_c A`.
pub fn axial_shares(section: &RcSection) -> &'static [f64] {
    if is_flat(section) { &RC_FLAT_AXIAL_SHARES } else { &RC_AXIAL_SHARES }
}

/// Of the directions that symmetry leaves, those in which it bends \[deg\].
pub fn directions_deg(section: &RcSection, of_symmetry: Vec<f64>) -> Vec<f64> {
    let vertical = |d: &f64| *d == 90.0 || *d == 270.0;
    if is_flat(section) { of_symmetry.into_iter().filter(vertical).collect() } else { of_symmetry }
}

/// By how much numbers of the section grow in its entry: a strip of a slab to one metre.
pub fn factor(section: &RcSection) -> f64 {
    if section.member == MemberKind::Slab { STRIP_M / section.input.size_m[0] } else { 1.0 }
}

/// Features with the width of the strip that the numbers stand for.
pub fn features(section: &RcSection, features: Features) -> Features {
    Features { width_m: features.width_m * factor(section), ..features }
}

/// A result with all its forces and moments times the factor of the section.
pub fn scaled(section: &RcSection, mut computed: Computed) -> Computed {
    let factor = factor(section);
    if factor == 1.0 {
        return computed;
    }
    for axis in &mut computed.axes {
        let AxisRecord { envelopes, curve, reverse } = axis;
        scale(envelopes, curve, factor);
        if let Some(branch) = reverse {
            scale(&mut branch.envelopes, &mut branch.curve, factor);
        }
    }
    if let Some(stiffness) = &mut computed.stiffness {
        stiffness.axial_n_m *= factor;
        stiffness.shear_n_m = stiffness.shear_n_m.map(|s| s * factor);
        stiffness.torsion_nm_rad *= factor;
    }
    for capacity in [
        &mut computed.tensile_capacity_n,
        &mut computed.compressive_capacity_n,
        &mut computed.bearing_capacity_n,
    ] {
        *capacity = capacity.map(|c| c * factor);
    }
    computed.validity.axial_force_n = computed.validity.axial_force_n.map(|n| n * factor);
    computed
}

fn scale(envelopes: &mut [EnvelopeLevel], curve: &mut ResistanceCurve, factor: f64) {
    for level in envelopes {
        level.axial_force_n *= factor;
        level.points.iter_mut().for_each(|p| p[1] *= factor);
    }
    curve.stiffness_nm_rad *= factor;
    for level in &mut curve.levels {
        level.axial_force_n *= factor;
        level.scale(factor);
    }
}
