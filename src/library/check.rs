//! Whether an entry makes sense: the same checks when it is written and when it is read.

use super::entry::{AxisRecord, ENTRY_SCHEMA, Entry};
use super::key;
use crate::base::hash::ContentHash;

/// Checks key, inputs and numbers.
///
/// # Errors
/// The first fault, in words.
pub fn entry(entry: &Entry) -> Result<(), String> {
    if entry.schema != ENTRY_SCHEMA {
        return Err(format!("schema {}, expected {ENTRY_SCHEMA}", entry.schema));
    }
    let inputs = ContentHash::of_value(&entry.provenance.inputs).map_err(|e| e.to_string())?;
    if entry.provenance.inputs_hash != inputs.to_string() {
        return Err("`provenance.inputs_hash` is not the hash of `provenance.inputs`".to_string());
    }
    if !key::is_key(&entry.key) || entry.key != key::key_of(entry.kind, &entry.features, &inputs) {
        return Err(format!(
            "key `{}` is not that of its features and inputs, `{}`",
            entry.key,
            key::key_of(entry.kind, &entry.features, &inputs)
        ));
    }
    let f = &entry.features;
    for (name, value) in [
        ("features.width_m", f.width_m),
        ("features.depth_m", f.depth_m),
        ("features.length_to_inflection_m", f.length_to_inflection_m),
        ("features.mesh_size_m", f.mesh_size_m),
        ("features.law.youngs_modulus_pa", f.law.youngs_modulus_pa),
        ("stiffness.axial_n_m", entry.stiffness.axial_n_m),
        ("stiffness.shear_n_m[0]", entry.stiffness.shear_n_m[0]),
        ("stiffness.shear_n_m[1]", entry.stiffness.shear_n_m[1]),
        ("stiffness.torsion_nm_rad", entry.stiffness.torsion_nm_rad),
        ("tensile_capacity_n", entry.tensile_capacity_n.unwrap_or(1.0)),
    ] {
        positive(name, value)?;
    }
    let q = &entry.quality;
    if !(q.kinetic_energy_ratio.is_finite() && q.asymmetry.is_finite()) {
        return Err("a figure of `quality` is not a number".to_string());
    }
    for (name, [low, high]) in
        [("axial_force_n", entry.validity.axial_force_n), ("rotation_rad", entry.validity.rotation_rad)]
    {
        if !(low.is_finite() && high.is_finite() && low <= high) {
            return Err(format!("`validity.{name}` is no range: {low} to {high}"));
        }
    }
    entry.axes.iter().enumerate().try_for_each(|(i, a)| axis(a).map_err(|e| format!("axes[{i}]: {e}")))
}

fn axis(axis: &AxisRecord) -> Result<(), String> {
    positive("curve.stiffness_nm_rad", axis.curve.stiffness_nm_rad)?;
    if axis.curve.levels.is_empty() || axis.envelopes.is_empty() {
        return Err("has no level".to_string());
    }
    increasing("envelopes", axis.envelopes.iter().map(|l| l.axial_force_n))?;
    increasing("curve.levels", axis.curve.levels.iter().map(|l| l.axial_force_n))?;
    for (i, level) in axis.envelopes.iter().enumerate() {
        points(&format!("envelopes[{i}]"), &level.points)?;
        positive(
            &format!("envelopes[{i}].fracture_rotation_rad"),
            level.fracture_rotation_rad.unwrap_or(1.0),
        )?;
    }
    for (i, level) in axis.curve.levels.iter().enumerate() {
        let name = format!("curve.levels[{i}]");
        points(&name, &level.capacity)?;
        if level.capacity[0][0] != 0.0 || level.capacity.iter().any(|p| p[1] < 0.0) {
            return Err(format!(
                "{name}: capacity must start at zero plastic rotation and never be negative"
            ));
        }
        positive(&format!("{name}.fracture_rotation_rad"), level.fracture_rotation_rad)?;
    }
    Ok(())
}

fn points(name: &str, points: &[[f64; 2]]) -> Result<(), String> {
    if points.is_empty() || points.iter().flatten().any(|x| !x.is_finite()) {
        return Err(format!("{name}: no points, or a point that is not a number"));
    }
    increasing(name, points.iter().map(|p| p[0]))
}

fn increasing(name: &str, values: impl Iterator<Item = f64>) -> Result<(), String> {
    let values: Vec<f64> = values.collect();
    if values.iter().all(|v| v.is_finite()) && values.windows(2).all(|w| w[0] < w[1]) {
        Ok(())
    } else {
        Err(format!("{name}: values must increase"))
    }
}

fn positive(name: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(format!("`{name}` must be positive, is {value}"))
    }
}
