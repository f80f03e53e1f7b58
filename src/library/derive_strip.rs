//! Entries for lines at which a floor may fold, computed by the submodel of a strip.

use super::derive::{DeriveError, described, envelope_levels};
use super::entry::{
    AxisRecord, Computed, Entry, EntryKind, Features, Inputs, Origin, Quality, Stiffness, Validity,
};
use super::key::key_of;
use crate::base::hash::ContentHash;
use crate::building::{Building, MemberKind};
use crate::curve::{Envelope, ResistanceCurve};
use crate::fe::mesh::Mesh;
use crate::rc::strip::AXIAL_SHARES;
use crate::rc::{EndModel, StripPlace, derive_strip};

/// A strip of a floor across a line, described so that an entry for it can be looked up or computed: a beam hinge if a beam crosses the line in it, else a slab's yield line.
#[derive(Debug, Clone)]
pub struct WantedStrip {
    /// Beam hinge or yield line.
    pub kind: EntryKind,
    /// Features for the query.
    pub features: Features,
    /// Everything the entry would be computed from.
    pub inputs: Inputs,
    /// The submodel.
    pub model: EndModel,
}

impl WantedStrip {
    /// Describes a strip of some members; `None` where they have nothing on both sides of the line.
    pub fn of(building: &Building, mesh: &Mesh, members: &[usize], place: &StripPlace) -> Option<Self> {
        let model = EndModel::strip(mesh, members, place)?;
        let parts = || model.section_elements.iter().map(|e| &model.mesh.elements[*e]);
        let is_beam = |part: usize| building.members[part].kind == MemberKind::Beam;
        let along = |part: usize| building.members[part].axis == place.axis;
        let crossing = parts().find(|e| is_beam(e.part) && along(e.part));
        let (kind, sample) = match crossing {
            Some(element) => (EntryKind::BeamHinge, element),
            None => (EntryKind::SlabYieldLine, parts().next()?),
        };
        let member = &building.members[sample.part];
        let section = building.sections[&member.section].clone();
        let law = building.law_of(member).in_slow_motion();
        let [first, second] = model.section_m;
        let size = if place.axis == 0 { [first, second] } else { [second, first] };
        let (features, inputs) =
            described(building, section, law, sample.strength, &model, size, &AXIAL_SHARES)?;
        Some(Self { kind, features, inputs, model })
    }

    /// The key that an entry computed from these inputs has.
    ///
    /// # Errors
    /// If the inputs cannot be written as JSON.
    pub fn key(&self) -> Result<String, serde_json::Error> {
        Ok(key_of(self.kind, &self.features, &ContentHash::of_value(&self.inputs)?))
    }

    /// Computes the entry; `progress` is told after each push (done, all).
    ///
    /// # Errors
    /// If a push fails or makes no curve.
    pub fn derive(&self, line: &str, progress: &(dyn Fn(usize, usize) + Sync)) -> Result<Entry, DeriveError> {
        let curves = derive_strip(&self.model, progress)?;
        let measured = curves
            .pushes
            .iter()
            .map(|p| Envelope { axial_force_n: p.axial_force_n, points: p.points.clone() });
        let curve = ResistanceCurve::from_envelopes(&measured.collect::<Vec<_>>())
            .map_err(|source| DeriveError::Curve { end: line.to_string(), source })?;
        let forces = curves.pushes.iter().map(|p| p.axial_force_n);
        let ends = curves.pushes.iter().filter_map(|p| p.points.last()).map(|p| p[0]);
        let computed = Computed {
            axes: vec![AxisRecord { envelopes: envelope_levels(&curves.pushes), curve, reverse: None }],
            stiffness: Some(Stiffness {
                axial_n_m: curves.axial_stiffness_n_m,
                shear_n_m: [curves.shear_stiffness_n_m; 2],
                torsion_nm_rad: curves.torsional_stiffness_nm_rad,
            }),
            tensile_capacity_n: Some(curves.tensile[0]),
            tensile_elongation_m: Some(curves.tensile[1]),
            compressive_capacity_n: Some(curves.tensile[0]),
            hinge_offset_m: Some(curves.hinge_offset_m),
            quality: Quality {
                kinetic_energy_ratio: Some(curves.pushes.iter().map(|p| p.kinetic_share).fold(0.0, f64::max)),
                elements: Some(self.model.mesh.elements.len() as u64),
                asymmetry: Some(curves.asymmetry),
                ..Quality::default()
            },
            validity: Validity {
                axial_force_n: [
                    forces.clone().fold(f64::INFINITY, f64::min),
                    forces.fold(f64::NEG_INFINITY, f64::max),
                ],
                rotation_rad: Some([0.0, ends.fold(f64::INFINITY, f64::min)]),
                displacement_m: None,
            },
            ..Computed::default()
        };
        let (features, inputs) = (self.features.clone(), self.inputs.clone());
        Ok(Entry::new(self.kind, Origin::Submodel, features, inputs, computed)?)
    }
}
