//! The parts of a record: curves, stiffness, quality, and where all of it comes from.

use crate::building::{Homogenised, Section};
use crate::curve::ResistanceCurve;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// How the curves of an entry were obtained.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The FE submodel with the homogenised law of the global model.
    #[default]
    Submodel,
    /// The FE submodel with concrete and bars of their own.
    RcSubmodel,
    /// A test in a laboratory.
    Test,
    /// Another program.
    Program,
}

impl Origin {
    /// All origins.
    pub const ALL: [Self; 4] = [Self::Submodel, Self::RcSubmodel, Self::Test, Self::Program];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Submodel => "submodel",
            Self::RcSubmodel => "rc_submodel",
            Self::Test => "test",
            Self::Program => "program",
        }
    }

    /// The origin with this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|origin| origin.name() == name)
    }

    /// The name in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::Submodel => "homogenised submodel",
            Self::RcSubmodel => "RC submodel",
            Self::Test => "test",
            Self::Program => "another program",
        }
    }

    /// Whether Fallwerk computed it.
    pub fn is_own(self) -> bool {
        matches!(self, Self::Submodel | Self::RcSubmodel)
    }
}

/// Moment over rotation at one constant axial force, as computed or measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvelopeLevel {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[rotation (rad), moment (N m)]`, rotations increasing.
    pub points: Vec<[f64; 2]>,
    /// Rotation at which the section separates \[rad\]; `None`: not reached.
    pub fracture_rotation_rad: Option<f64>,
}

/// Resistance about one bending axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisRecord {
    /// The envelopes at increasing axial force; none in an entry interpolated between two.
    pub envelopes: Vec<EnvelopeLevel>,
    /// What a hinge uses, derived from the envelopes.
    pub curve: ResistanceCurve,
    /// The other sense of rotation, rotations and moments counted positive there; absent: as this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reverse: Option<Branch>,
}

/// Resistance in the other sense of rotation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Branch {
    /// As [`AxisRecord::envelopes`].
    pub envelopes: Vec<EnvelopeLevel>,
    /// As [`AxisRecord::curve`].
    pub curve: ResistanceCurve,
}

/// The direction of a spring.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// Along the member; shortening and compression are positive.
    Axial,
    /// Across it along axis 1.
    Shear1,
    /// Across it along axis 2.
    Shear2,
    /// About its axis: rotations \[rad\] and torques \[N m\] in the place of displacements and forces.
    Torsion,
    /// Normal to a contact; approach and pressure are positive.
    Normal,
}

/// Force over displacement in one direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpringRecord {
    /// The direction.
    pub direction: Direction,
    /// Elastic stiffness: the secant to half of the peak \[N/m\].
    pub stiffness_n_m: f64,
    /// Curves at increasing axial force; a single one where it does not matter.
    pub levels: Vec<SpringLevel>,
}

/// Force over displacement at one axial force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpringLevel {
    /// Axial force of the member, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[displacement (m), force (N)]`, displacements increasing.
    pub points: Vec<[f64; 2]>,
    /// Displacement at which it separates \[m\]; absent: not reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fracture_displacement_m: Option<f64>,
    /// Energy taken up to the last point \[J\]; absent: not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dissipated_j: Option<f64>,
}

/// Elastic stiffness beside the bending stiffness (which the curves hold).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stiffness {
    /// Axial \[N/m\].
    pub axial_n_m: f64,
    /// Shear along axes 1 and 2 \[N/m\].
    pub shear_n_m: [f64; 2],
    /// Torsion \[N m/rad\].
    pub torsion_nm_rad: f64,
}

/// How good the curves are; what an origin does not give is absent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quality {
    /// Largest ratio of kinetic to internal energy during loading (small: quasi-static).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kinetic_energy_ratio: Option<f64>,
    /// Number of elements of the submodel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elements: Option<u64>,
    /// Largest relative difference of the moment between the two senses of rotation.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub asymmetry: Option<f64>,
    /// Relative change of the peak moment from a mesh of another element size, the largest of all curves.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_sensitivity: Option<f64>,
    /// As before, of the rotation at 80 % of the peak; absent also if no curve falls to it in both meshes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_sensitivity_rotation: Option<f64>,
    /// Element size of that mesh \[m\]; absent: half of the entry's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_compared_m: Option<f64>,
    /// Largest shear force of the curves over the shear strength of the undamaged member (ASCE 41-17, eq. 10-3); above 0.8 cycles take strength that these curves,
    /// of one push, still have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shear_share: Option<f64>,
}

/// How a test or a run of another program loaded the member.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Loading {
    /// Once, in one sense.
    Monotonic,
    /// Back and forth; the curve is the envelope of the cycles.
    CyclicEnvelope,
}

/// Where a curve of a test or another program comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Publication, report or data set, with the name of the specimen.
    pub citation: String,
    /// Who measured or computed it.
    pub by: String,
    /// Name and version of the program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<String>,
    /// How it was loaded.
    pub loading: Loading,
    /// Whether the moment contains that of the axial force on the displaced member (P-Δ).
    pub second_order_included: bool,
    /// Name of the file the curve was read from.
    pub file: String,
    /// blake3 hash of that file.
    pub file_hash: String,
}

/// How an entry lies between two others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interpolation {
    /// Keys of the two entries.
    pub entries: [String; 2],
    /// Hashes of their records.
    pub records: [String; 2],
    /// The feature in which they differ.
    pub feature: String,
    /// Its value in this entry, SI.
    pub value: f64,
    /// Share of the second entry, 0 to 1.
    pub share: f64,
}

/// All that an entry was made from. Its hash ends the key.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inputs {
    /// The reinforced section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub section: Option<Section>,
    /// The homogenised law of the submodel.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<Homogenised>,
    /// Laws of other submodels by name (`concrete`, `bars`, `ties`), all their constants.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub materials: BTreeMap<String, Value>,
    /// Geometry, names with units (`length_m`, `plate_thickness_m`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub geometry: BTreeMap<String, f64>,
    /// Settings of the submodel's runs (load levels, speed of loading, hourglass control).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub settings: BTreeMap<String, Value>,
    /// Version of the submodel's procedure: a change that changes results counts it up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub submodel_version: Option<u32>,
    /// The test, or the other program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source: Option<Source>,
    /// The entries between which this one lies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interpolation: Option<Interpolation>,
}

/// Where the record comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// What it was made from.
    pub inputs: Inputs,
    /// Hash of `inputs`, all 64 digits; the key ends with the first 16.
    pub inputs_hash: String,
    /// Version of the program that computed or added it.
    pub program_version: String,
}

/// Where the record holds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Validity {
    /// Lowest and highest axial force \[N\].
    pub axial_force_n: [f64; 2],
    /// Range of the rotation \[rad\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_rad: Option<[f64; 2]>,
    /// Range of the displacement \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement_m: Option<[f64; 2]>,
}

/// An entry that is no longer to be used.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Deprecation {
    /// Why.
    pub reason: String,
    /// Key of the entry to use instead.
    pub successor: Option<String>,
}
