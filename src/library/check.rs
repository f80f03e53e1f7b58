//! Whether an entry makes sense: the same checks when it is written and when it is read.

use super::entry::{
    AxisRecord, Branch, ENTRY_SCHEMA, Entry, EntryKind, EnvelopeLevel, OLDEST_SCHEMA, Origin,
};
use super::key;
use super::parts::SpringRecord;
use crate::base::hash::ContentHash;
use crate::curve::ResistanceCurve;

/// Checks key, inputs and numbers.
///
/// # Errors
/// The first fault, in words.
pub fn entry(entry: &Entry) -> Result<(), String> {
    if !(OLDEST_SCHEMA..=ENTRY_SCHEMA).contains(&entry.schema) {
        return Err(format!("schema {}, expected {OLDEST_SCHEMA} to {ENTRY_SCHEMA}", entry.schema));
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
    parts(entry)?;
    numbers(entry)?;
    let interpolated = entry.provenance.inputs.interpolation.is_some();
    for (i, axis) in entry.axes.iter().enumerate() {
        self::axis(axis, interpolated).map_err(|e| format!("axes[{i}]: {e}"))?;
    }
    entry
        .springs
        .iter()
        .enumerate()
        .try_for_each(|(i, s)| spring(s).map_err(|e| format!("springs[{i}]: {e}")))
}

/// Whether the parts are there that the kind and the origin ask for.
fn parts(entry: &Entry) -> Result<(), String> {
    let kind = entry.kind.name();
    if entry.schema == OLDEST_SCHEMA
        && (entry.kind, entry.origin) != (EntryKind::ColumnHinge, Origin::Submodel)
    {
        return Err("schema 1 knows column hinges of the submodel only".to_string());
    }
    match (entry.kind.is_bending(), entry.axes.len(), entry.springs.len()) {
        (true, 1..=2, 0) | (false, 0, 1..) => {}
        (true, ..) => return Err(format!("a `{kind}` has one or two `axes` and no `springs`")),
        (false, ..) => return Err(format!("a `{kind}` has `springs` and no `axes`")),
    }
    let inputs = &entry.provenance.inputs;
    if entry.origin.is_own() && inputs.interpolation.is_none() {
        if entry.kind == EntryKind::ColumnHinge {
            entry.hinge().map_err(|e| e.to_string())?;
        }
        if inputs.submodel_version.is_none() {
            return Err("`provenance.inputs.submodel_version` is missing".to_string());
        }
    }
    if !entry.origin.is_own() && inputs.source.is_none() && inputs.interpolation.is_none() {
        return Err(format!("a record of a {} names its `source`", entry.origin.words()));
    }
    Ok(())
}

fn numbers(entry: &Entry) -> Result<(), String> {
    for (name, (value, _)) in entry.features.numbers() {
        if entry.features.further.contains_key(&name) {
            finite(&format!("features.further.{name}"), value)?;
        } else {
            positive(&format!("features.{name}"), value)?;
        }
    }
    if let Some(s) = &entry.stiffness {
        positive("stiffness.axial_n_m", s.axial_n_m)?;
        positive("stiffness.shear_n_m[0]", s.shear_n_m[0])?;
        positive("stiffness.shear_n_m[1]", s.shear_n_m[1])?;
        positive("stiffness.torsion_nm_rad", s.torsion_nm_rad)?;
    }
    for (name, figure) in [
        ("tensile_capacity_n", entry.tensile_capacity_n),
        ("tensile_elongation_m", entry.tensile_elongation_m),
        ("compressive_capacity_n", entry.compressive_capacity_n),
        ("bearing_capacity_n", entry.bearing_capacity_n),
    ] {
        positive(name, figure.unwrap_or(1.0))?;
    }
    if let Some(offset_m) = entry.hinge_offset_m
        && !(offset_m.is_finite() && offset_m >= 0.0)
    {
        return Err(format!("`hinge_offset_m` must not be negative, is {offset_m}"));
    }
    let q = &entry.quality;
    for (name, figure) in [
        ("kinetic_energy_ratio", q.kinetic_energy_ratio),
        ("asymmetry", q.asymmetry),
        ("mesh_sensitivity", q.mesh_sensitivity),
        ("mesh_sensitivity_rotation", q.mesh_sensitivity_rotation),
        ("mesh_compared_m", q.mesh_compared_m),
        ("shear_share", q.shear_share),
    ] {
        finite(&format!("quality.{name}"), figure.unwrap_or(0.0))?;
    }
    let v = &entry.validity;
    for (name, range) in [
        ("axial_force_n", Some(v.axial_force_n)),
        ("rotation_rad", v.rotation_rad),
        ("displacement_m", v.displacement_m),
    ] {
        if let Some([low, high]) = range
            && !(low.is_finite() && high.is_finite() && low <= high)
        {
            return Err(format!("`validity.{name}` is no range: {low} to {high}"));
        }
    }
    Ok(())
}

fn axis(axis: &AxisRecord, interpolated: bool) -> Result<(), String> {
    branch(&axis.envelopes, &axis.curve, interpolated)?;
    match &axis.reverse {
        Some(Branch { envelopes, curve }) => {
            branch(envelopes, curve, interpolated).map_err(|e| format!("reverse: {e}"))
        }
        None => Ok(()),
    }
}

fn branch(envelopes: &[EnvelopeLevel], curve: &ResistanceCurve, interpolated: bool) -> Result<(), String> {
    positive("curve.stiffness_nm_rad", curve.stiffness_nm_rad)?;
    if curve.levels.is_empty() || envelopes.is_empty() != interpolated {
        return Err("has no level".to_string());
    }
    curve.cyclic.as_ref().map_or(Ok(()), |rule| rule.check().map_err(|e| format!("curve: {e}")))?;
    increasing("envelopes", envelopes.iter().map(|l| l.axial_force_n))?;
    increasing("curve.levels", curve.levels.iter().map(|l| l.axial_force_n))?;
    for (i, level) in envelopes.iter().enumerate() {
        points(&format!("envelopes[{i}]"), &level.points)?;
        positive(
            &format!("envelopes[{i}].fracture_rotation_rad"),
            level.fracture_rotation_rad.unwrap_or(1.0),
        )?;
    }
    for (i, level) in curve.levels.iter().enumerate() {
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

fn spring(spring: &SpringRecord) -> Result<(), String> {
    positive("stiffness_n_m", spring.stiffness_n_m)?;
    if spring.levels.is_empty() {
        return Err("has no level".to_string());
    }
    increasing("levels", spring.levels.iter().map(|l| l.axial_force_n))?;
    for (i, level) in spring.levels.iter().enumerate() {
        points(&format!("levels[{i}]"), &level.points)?;
        positive(
            &format!("levels[{i}].fracture_displacement_m"),
            level.fracture_displacement_m.unwrap_or(1.0),
        )?;
    }
    Ok(())
}

fn finite(name: &str, value: f64) -> Result<(), String> {
    if value.is_finite() { Ok(()) } else { Err(format!("`{name}` is not a number")) }
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
