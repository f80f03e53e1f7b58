//! Entries for the member ends of a building, computed by the submodel.

use super::entry::{
    Adjoining, AxisRecord, ColumnEnd, Computed, Entry, EntryKind, EnvelopeLevel, Features, Inputs,
    LawFeatures, Origin, Quality, Stiffness, Validity,
};
use super::error::StoreError;
use super::key::key_of;
use super::thin::thinned;
use crate::base::hash::ContentHash;
use crate::building::ends::{End, MemberEnd};
use crate::building::partition::Partition;
use crate::building::{Building, Homogenised, Section};
use crate::curve::{CurveError, Envelope, ResistanceCurve};
use crate::fe::mesh::Mesh;
use crate::rc::pushover::Push;
use crate::rc::{EndCurves, EndModel, PushoverError};
use std::collections::BTreeMap;

/// Version of the submodel procedure; part of every key, so that a change of procedure never reuses old curves.
pub const SUBMODEL_VERSION: u32 = 1;
/// Points that a stored envelope keeps.
const ENVELOPE_POINTS: usize = 48;

/// A member end, described so that an entry for it can be looked up or computed.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// Features for the query.
    pub features: Features,
    /// Everything the entry would be computed from.
    pub inputs: Inputs,
    /// The submodel.
    pub model: EndModel,
}

/// Why an entry cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum DeriveError {
    /// The push failed.
    #[error(transparent)]
    Push(#[from] PushoverError),
    /// The end of a member cannot be crushed.
    #[error(transparent)]
    Crushing(#[from] crate::rc::crushing::CrushingError),
    /// The envelopes do not make a curve.
    #[error("the envelopes of {end} make no resistance curve: {source}")]
    Curve {
        /// Member end id.
        end: String,
        /// Why.
        source: CurveError,
    },
    /// An entry that is to be scaled cannot be read.
    #[error(transparent)]
    Store(#[from] StoreError),
    /// The entry cannot be written as text.
    #[error("the entry cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl Wanted {
    /// Describes a column end; `None` for one without own volume, or of which nothing is in the mesh.
    pub fn of(building: &Building, partition: &Partition, mesh: &Mesh, end: &MemberEnd) -> Option<Self> {
        let member = &building.members[end.member];
        let model = EndModel::cut_from(building, partition, mesh, end.member, end.end)?;
        let section = building.sections[&member.section].clone();
        let law = building.law_of(member).in_slow_motion();
        let strength = model.mesh.elements[*model.section_elements.first()?].strength;
        let shares = &crate::rc::pushover::AXIAL_SHARES;
        let (features, inputs) =
            described(building, section, law, strength, &model, model.section_m, shares)?;
        let features = Features {
            end: Some(match end.end {
                End::Lower => ColumnEnd::Bottom,
                End::Upper => ColumnEnd::Top,
            }),
            adjoining: Some(adjoining(building, partition, end)),
            ..features
        };
        Some(Self { features, inputs, model })
    }

    /// The key that an entry computed from these inputs has.
    pub fn key(&self) -> Result<String, serde_json::Error> {
        Ok(key_of(EntryKind::ColumnHinge, &self.features, &ContentHash::of_value(&self.inputs)?))
    }

    /// Computes the entry; `progress` is told after each push (done, all).
    pub fn derive(&self, end: &str, progress: &(dyn Fn(usize, usize) + Sync)) -> Result<Entry, DeriveError> {
        let curves = crate::rc::derive(&self.model, progress)?;
        let record = |axis: usize| axis_record(&curves, axis, end);
        let computed = Computed {
            axes: vec![record(0)?, record(1)?],
            stiffness: Some(Stiffness {
                axial_n_m: curves.axial_stiffness_n_m,
                shear_n_m: curves.shear_stiffness_n_m,
                torsion_nm_rad: curves.torsional_stiffness_nm_rad,
            }),
            tensile_capacity_n: Some(curves.tensile_capacity_n),
            tensile_elongation_m: Some(curves.tensile_elongation_m),
            compressive_capacity_n: Some(curves.compressive_capacity_n),
            bearing_capacity_n: curves.bearing_capacity_n,
            hinge_offset_m: Some(curves.hinge_offset_m),
            quality: Quality {
                kinetic_energy_ratio: Some(
                    curves.axes.iter().flatten().map(|p| p.kinetic_share).fold(0.0, f64::max),
                ),
                elements: Some(curves.elements as u64),
                asymmetry: Some(curves.asymmetry),
                ..Quality::default()
            },
            validity: validity(&curves),
            ..Computed::default()
        };
        let (features, inputs) = (self.features.clone(), self.inputs.clone());
        Ok(Entry::new(EntryKind::ColumnHinge, Origin::Submodel, features, inputs, computed)?)
    }
}

/// Features and inputs of an entry of the homogenised submodel, for the width and depth of its section and the axial forces of its pushes.
pub(super) fn described(
    building: &Building,
    section: Section,
    law: Homogenised,
    strength: f64,
    model: &EndModel,
    [width_m, depth_m]: [f64; 2],
    axial_shares: &[f64],
) -> Option<(Features, Inputs)> {
    let mut further = BTreeMap::new();
    if strength != 1.0 {
        further.insert("strength_factor".to_string(), strength);
    }
    let geometry = BTreeMap::from([
        ("width_m".to_string(), micrometres(width_m)),
        ("depth_m".to_string(), micrometres(depth_m)),
        ("length_m".to_string(), micrometres(model.length_m)),
        ("elements".to_string(), model.mesh.elements.len() as f64),
    ]);
    let shape = ContentHash::of_value(&model.canonical_geometry()).ok()?;
    let settings = BTreeMap::from([
        ("geometry_hash".to_string(), shape.to_string().into()),
        ("mesh_size_m".to_string(), building.settings.mesh_size_m.into()),
        ("axial_shares".to_string(), axial_shares.to_vec().into()),
    ]);
    let features = Features {
        width_m: micrometres(width_m),
        depth_m: micrometres(depth_m),
        length_to_inflection_m: Some(micrometres(model.length_m)),
        end: None,
        adjoining: None,
        law: Some(LawFeatures::of(&section.law, &law)),
        mesh_size_m: Some(building.settings.mesh_size_m),
        rc: None,
        further,
    };
    let inputs = Inputs {
        section: Some(section),
        law: Some(law),
        geometry,
        settings,
        submodel_version: Some(SUBMODEL_VERSION),
        ..Inputs::default()
    };
    Some((features, inputs))
}

/// Rounds a length to micrometres, so that ends that differ by round-off share an entry \[m\].
pub(super) fn micrometres(length_m: f64) -> f64 {
    (length_m * 1e6).round() / 1e6
}

/// What lies beyond an end.
fn adjoining(building: &Building, partition: &Partition, end: &MemberEnd) -> Adjoining {
    use crate::building::MemberKind;
    match end.beyond(partition).map(|m| building.members[m].kind) {
        Some(MemberKind::Beam) => Adjoining::Beam,
        Some(_) => Adjoining::Slab,
        None => Adjoining::Ground,
    }
}

fn axis_record(curves: &EndCurves, axis: usize, end: &str) -> Result<AxisRecord, DeriveError> {
    let pushes = &curves.axes[axis];
    let measured: Vec<Envelope> = pushes
        .iter()
        .map(|p| Envelope { axial_force_n: p.axial_force_n, points: p.points.clone() })
        .collect();
    let curve = ResistanceCurve::from_envelopes(&measured)
        .map_err(|source| DeriveError::Curve { end: end.to_string(), source })?;
    Ok(AxisRecord { envelopes: envelope_levels(pushes), curve, reverse: None })
}

/// What is kept of envelopes.
pub(super) fn envelope_levels(pushes: &[Push]) -> Vec<EnvelopeLevel> {
    let level = |p: &Push| EnvelopeLevel {
        axial_force_n: p.axial_force_n,
        points: thinned(&p.points, ENVELOPE_POINTS),
        fracture_rotation_rad: p.failed.then(|| p.points.last().map_or(0.0, |q| q[0])),
    };
    pushes.iter().map(level).collect()
}

fn validity(curves: &EndCurves) -> Validity {
    let forces = curves.axes[0].iter().map(|p| p.axial_force_n);
    let rotation = curves
        .axes
        .iter()
        .flatten()
        .filter_map(|p| p.points.last())
        .map(|p| p[0])
        .fold(f64::INFINITY, f64::min);
    Validity {
        axial_force_n: [
            forces.clone().fold(f64::INFINITY, f64::min),
            forces.fold(f64::NEG_INFINITY, f64::max),
        ],
        rotation_rad: Some([0.0, rotation]),
        displacement_m: None,
    }
}
