//! Entries of column ends whose capacity is that of their section, layer of elements by layer ([`crate::rc::layers`]): for ends that the library has no entry for, nor one that could be scaled to them.
//!
//! The plastic rotation is in the row of elements at the joint, to which the joint lends strength; the elastic stiffness is computed for the end itself ([`elastic`]), shear and torsion are those of the prism.
//! Where a joint gives way before its column, that is not seen. When the section breaks, and what is left of it then, is as pushes show it ([`super::after_break`]).

use super::after_break::as_pushed;
use super::derive::Wanted;
use super::entry::{AxisRecord, Computed, Entry, EntryKind, Origin, Stiffness, Validity};
use crate::base::geom::Aabb;
use crate::building::Homogenised;
use crate::curve::ResistanceCurve;
use crate::material::j2::HardeningTable;
use crate::rc::EndModel;
use crate::rc::elastic::elastic;
use crate::rc::layers::{Held, Layer, Layers, POLE, Rows};

/// Shear area of a rectangle over its area.
const SHEAR_SHARE: f64 = 5.0 / 6.0;

/// The entry of a column end from its section; `None` where the end has none, or its submodel is a mechanism.
///
/// # Errors
/// If it cannot be written as JSON.
pub fn layered(wanted: &Wanted) -> Result<Option<Entry>, serde_json::Error> {
    let (model, Some(law)) = (&wanted.model, &wanted.inputs.law) else { return Ok(None) };
    let elements: Vec<(Aabb, f64, f64)> = model.section_elements.iter().map(|e| element(model, *e)).collect();
    let row_m = elements.iter().map(|(solid, ..)| solid.size()[model.axis]).fold(0.0, f64::max);
    let offset_m = POLE * row_m;
    let Ok(stiffness) = elastic(model, offset_m) else { return Ok(None) };
    // a rotation about the first axis of the section bends across the second one, and the other way round
    let sections =
        [2, 1].map(|depth| section(&elements, [3 - depth, depth].map(|i| (model.axis + i) % 3), law));
    let [Some(first), Some(second)] = sections else { return Ok(None) };
    let [k, l] = stiffness.bending_nm_rad;
    // the moment is zero at the far end of the submodel
    let shear_span_m = model.length_m - offset_m;
    let rows = Rows { row_m, shear_span_m, held: Held::AtJoint };
    let curves = [(&first, k, 2), (&second, l, 1)].map(|(section, stiffness, depth)| {
        let curve = section.curve(&rows, stiffness);
        let farthest_m = farthest_centre_m(&elements, (model.axis + depth) % 3);
        if farthest_m <= 0.0 {
            return curve; // a single layer: its centre is not strained
        }
        as_pushed(&curve, section.squash_n, law.rupture_strain() * row_m / farthest_m)
    });
    // as the submodel has it: what the law bears when it breaks
    let table = HardeningTable::new(&law.hardening);
    let rupture = law.rupture_strain();
    let force_n = first.squash_n * table.at(rupture).0 / table.at(0.0).0;
    let prism = law.shear_modulus_pa() / model.length_m;
    let mut inputs = wanted.inputs.clone();
    inputs.settings.insert("capacity".into(), "layers of the section".into());
    let computed = Computed {
        stiffness: Some(Stiffness {
            axial_n_m: stiffness.axial_n_m,
            shear_n_m: [SHEAR_SHARE * prism * model.area_m2; 2],
            torsion_nm_rad: prism * model.torsion_m4,
        }),
        tensile_capacity_n: Some(force_n),
        tensile_elongation_m: Some(rupture * model.length_m),
        compressive_capacity_n: Some(force_n),
        hinge_offset_m: Some(offset_m),
        validity: validity(&curves),
        axes: curves.map(|curve| AxisRecord { envelopes: Vec::new(), curve, reverse: None }).to_vec(),
        ..Computed::default()
    };
    let features = wanted.features.clone();
    Entry::unthinned(EntryKind::ColumnHinge, Origin::Submodel, features, inputs, computed).map(Some)
}

/// How far the centre of an element is from the middle of the section at most, along an axis \[m\].
fn farthest_centre_m(elements: &[(Aabb, f64, f64)], axis: usize) -> f64 {
    let at = |(solid, ..): &(Aabb, f64, f64)| solid.center()[axis];
    let low = elements.iter().map(at).fold(f64::INFINITY, f64::min);
    let high = elements.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
    0.5 * (high - low)
}

/// An element at the end section: its box, and its factors on area and on strength.
fn element(model: &EndModel, index: usize) -> (Aabb, f64, f64) {
    let element = &model.mesh.elements[index];
    (model.mesh.bounds(element), element.smear, element.strength)
}

/// The elements of a row as layers across the member, in the directions of its width and its depth.
fn section<'a>(
    rows: &[(Aabb, f64, f64)],
    [width, depth]: [usize; 2],
    law: &'a Homogenised,
) -> Option<Layers<'a>> {
    let layer = |(solid, smear, strength): &(Aabb, f64, f64)| {
        let size = solid.size();
        Layer {
            area_m2: smear * size[width] * size[depth],
            at_m: solid.center()[depth],
            depth_m: size[depth],
            strength: *strength,
            is_plate: false,
            law,
        }
    };
    Layers::of(rows.iter().map(layer).collect())
}

/// Range of axial forces and of rotations that the curves were computed for.
fn validity(curves: &[ResistanceCurve; 2]) -> Validity {
    let levels = || curves.iter().flat_map(|c| &c.levels);
    let forces = || levels().map(|l| l.axial_force_n);
    let rotation = levels().map(|l| l.fracture_rotation_rad).fold(f64::INFINITY, f64::min);
    Validity {
        axial_force_n: [forces().fold(f64::INFINITY, f64::min), forces().fold(f64::NEG_INFINITY, f64::max)],
        rotation_rad: Some([0.0, rotation]),
        displacement_m: None,
    }
}
