//! An entry between two others of the same kind and origin that differ in one number.
//!
//! Capacities are those of [`ResistanceCurve::between`](crate::curve::ResistanceCurve::between): linear in the feature, never above it,
//! within the axial forces that both entries cover. Stiffnesses and the axial capacities are linear as well; figures of
//! quality are the worse of both; the validity is the range that both share. Envelopes are those of neither and
//! are left out. The provenance names both entries.

use super::entry::{
    AxisRecord, Branch, Computed, Entry, Features, Inputs, Interpolation, Quality, Stiffness, Validity,
};
use super::find::{Query, differing, log_ratio};
use crate::curve::ResistanceCurve;

/// The one number in which two sets of features differ and which has the value asked for between them, with the
/// logarithm of its ratio; `None` if they differ in anything else, or from what is asked for.
pub(super) fn bracket(a: &Features, b: &Features, query: &Query) -> Option<(String, f64)> {
    let (names, same_words) = differing(a, b);
    let [name] = names.as_slice() else { return None };
    let wanted = *query.numbers.get(name)?;
    let (x, y) = (a.numbers(), b.numbers());
    let agrees = |(other, value): (&String, &f64)| {
        other == name || x.get(other).is_some_and(|held| log_ratio(held.0, *value) == 0.0)
    };
    let (low, high) = (x.get(name)?.0, y.get(name)?.0);
    let inside = (wanted - low) * (wanted - high) < 0.0;
    (same_words && inside && query.numbers.iter().all(agrees)).then(|| (name.clone(), log_ratio(low, high)))
}

/// The entry between `a` and `b` at the value of a feature \[SI\]; `None` if it is no hinge, or the two have not the same
/// parts or no axial force in common.
///
/// # Errors
/// If it cannot be written as JSON.
pub(super) fn between(
    a: &Entry,
    b: &Entry,
    feature: &str,
    value: f64,
) -> Result<Option<Entry>, serde_json::Error> {
    let number = |e: &Entry| e.features.numbers().get(feature).map(|n| n.0);
    let (Some(low), Some(high)) = (number(a), number(b)) else { return Ok(None) };
    let share = (value - low) / (high - low);
    let Some(computed) = computed(a, b, share) else { return Ok(None) };
    let mut features = a.features.clone();
    features.set_number(feature, value);
    let inputs = Inputs {
        interpolation: Some(Interpolation {
            entries: [a.key.clone(), b.key.clone()],
            records: [a.checksum()?.to_string(), b.checksum()?.to_string()],
            feature: feature.to_string(),
            value,
            share,
        }),
        ..Inputs::default()
    };
    Entry::unthinned(a.kind, a.origin, features, inputs, computed).map(Some)
}

fn computed(a: &Entry, b: &Entry, share: f64) -> Option<Computed> {
    if a.axes.is_empty() || a.axes.len() != b.axes.len() {
        return None;
    }
    let mix = |x: f64, y: f64| x + share * (y - x);
    let both = |x: Option<f64>, y: Option<f64>| Some(mix(x?, y?));
    let axes = a.axes.iter().zip(&b.axes).map(|(x, y)| axis(x, y, share)).collect::<Option<Vec<_>>>()?;
    let stiffness = a.stiffness.zip(b.stiffness).map(|(x, y)| Stiffness {
        axial_n_m: mix(x.axial_n_m, y.axial_n_m),
        shear_n_m: [0, 1].map(|i: usize| mix(x.shear_n_m[i], y.shear_n_m[i])),
        torsion_nm_rad: mix(x.torsion_nm_rad, y.torsion_nm_rad),
    });
    Some(Computed {
        validity: validity(&a.validity, &b.validity, &axes),
        axes,
        springs: Vec::new(),
        stiffness,
        tensile_capacity_n: both(a.tensile_capacity_n, b.tensile_capacity_n),
        tensile_elongation_m: both(a.tensile_elongation_m, b.tensile_elongation_m),
        compressive_capacity_n: both(a.compressive_capacity_n, b.compressive_capacity_n),
        bearing_capacity_n: both(a.bearing_capacity_n, b.bearing_capacity_n)
            .or(a.bearing_capacity_n)
            .or(b.bearing_capacity_n),
        hinge_offset_m: both(a.hinge_offset_m, b.hinge_offset_m),
        quality: worse(&a.quality, &b.quality),
    })
}

pub(super) fn axis(a: &AxisRecord, b: &AxisRecord, share: f64) -> Option<AxisRecord> {
    let reverse = match (&a.reverse, &b.reverse) {
        (None, None) => None,
        (x, y) => {
            let own = |branch: &Option<Branch>, same: &ResistanceCurve| {
                branch.as_ref().map_or_else(|| same.clone(), |branch| branch.curve.clone())
            };
            let curve = own(x, &a.curve).between(&own(y, &b.curve), share)?;
            Some(Branch { envelopes: Vec::new(), curve })
        }
    };
    Some(AxisRecord { envelopes: Vec::new(), curve: a.curve.between(&b.curve, share)?, reverse })
}

/// The range that both share, within the axial forces of the curves.
fn validity(a: &Validity, b: &Validity, axes: &[AxisRecord]) -> Validity {
    let common = |x: [f64; 2], y: [f64; 2]| [x[0].max(y[0]), x[1].min(y[1])];
    let forces = axes.iter().map(|axis| axis.curve.axial_range_n()).reduce(common);
    let rotation = a.rotation_rad.zip(b.rotation_rad).map(|(x, y)| common(x, y));
    Validity {
        axial_force_n: forces.unwrap_or_else(|| common(a.axial_force_n, b.axial_force_n)),
        rotation_rad: rotation,
        displacement_m: None,
    }
}

fn worse(a: &Quality, b: &Quality) -> Quality {
    let larger = |x: Option<f64>, y: Option<f64>| Some(x?.max(y?));
    Quality {
        kinetic_energy_ratio: larger(a.kinetic_energy_ratio, b.kinetic_energy_ratio),
        elements: None,
        asymmetry: larger(a.asymmetry, b.asymmetry),
        mesh_sensitivity: larger(a.mesh_sensitivity, b.mesh_sensitivity),
        mesh_sensitivity_rotation: larger(a.mesh_sensitivity_rotation, b.mesh_sensitivity_rotation),
        mesh_compared_m: larger(a.mesh_compared_m, b.mesh_compared_m),
        shear_share: larger(a.shear_share, b.shear_share),
    }
}
