//! One subsystem of the library: what is stored of a member end.
//!
//! SI units; axial force is positive in compression. The text form is JSON with sorted keys; its
//! `checksum` is the hash of the record without that field, so that a flipped digit is noticed.

use crate::base::hash::{ContentHash, readable_json};
use crate::building::{HardeningPoint, Homogenised, Section};
use crate::curve::ResistanceCurve;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// Version of the record format.
pub const ENTRY_SCHEMA: u32 = 1;

/// Largest size of a record \[bytes\]: larger values make the working copy (sled) keep blobs that it
/// never gives back.
pub const RECORD_LIMIT_BYTES: usize = 16_000;

/// What kind of subsystem an entry is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum EntryKind {
    /// The hinge at a column end: rotational resistance about two axes and the stiffnesses beside it.
    ColumnHinge,
}

impl EntryKind {
    /// The name in files and the folder of the records.
    pub fn name(self) -> &'static str {
        match self {
            Self::ColumnHinge => "column_hinge",
        }
    }
}

/// Which end of the column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColumnEnd {
    /// The head.
    Top,
    /// The foot.
    Bottom,
}

/// What the end is joined to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Adjoining {
    /// A slab without a beam at this place.
    Slab,
    /// A beam (with or without a slab).
    Beam,
    /// The ground or a footing: clamped.
    Ground,
}

/// The law of the column, as far as entries are compared by it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LawFeatures {
    /// Id of the law in the building file; a name for people, not compared.
    pub id: String,
    /// Hash of the whole law: equal hashes mean the same law.
    pub hash: String,
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// First yield stress \[Pa\].
    pub yield_stress_pa: f64,
    /// Largest yield stress of the hardening table \[Pa\].
    pub peak_stress_pa: f64,
    /// Plastic strain at which an element erodes.
    pub critical_plastic_strain: f64,
}

impl LawFeatures {
    /// The features of a homogenised law known under `id`.
    pub fn of(id: &str, law: &Homogenised) -> Self {
        let stress = |point: &HardeningPoint| point.stress_pa;
        Self {
            id: id.to_string(),
            hash: ContentHash::of_value(law).map(|h| h.short()).unwrap_or_default(),
            youngs_modulus_pa: law.youngs_modulus_pa,
            yield_stress_pa: law.hardening.first().map_or(0.0, stress),
            peak_stress_pa: law.hardening.iter().map(stress).fold(0.0, f64::max),
            critical_plastic_strain: law.critical_plastic_strain,
        }
    }
}

/// By what an entry is found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Features {
    /// Width of the section, along x for a column \[m\].
    pub width_m: f64,
    /// Depth of the section, along y for a column \[m\].
    pub depth_m: f64,
    /// Distance from the end to the point of zero moment \[m\].
    pub length_to_inflection_m: f64,
    /// Which end.
    pub end: ColumnEnd,
    /// What it is joined to.
    pub adjoining: Adjoining,
    /// The law of the column.
    pub law: LawFeatures,
    /// Edge length of the elements of the submodel \[m\].
    pub mesh_size_m: f64,
    /// Further numbers, compared by name (for instance `reinforcement_ratio`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub further: BTreeMap<String, f64>,
}

/// All that an entry was computed from. Its hash ends the key.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Inputs {
    /// The reinforced section.
    pub section: Section,
    /// The law of the submodel.
    pub law: Homogenised,
    /// Geometry of the submodel, names with units (`length_m`, `plate_thickness_m`).
    pub geometry: BTreeMap<String, f64>,
    /// Settings of the submodel's runs (load levels, speed of loading, hourglass control).
    pub settings: BTreeMap<String, Value>,
    /// Version of the submodel's procedure: a change that changes results counts it up.
    pub submodel_version: u32,
}

/// Moment over rotation at one constant axial force, as computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvelopeLevel {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[rotation (rad), moment (N m)]`, rotations increasing.
    pub points: Vec<[f64; 2]>,
    /// Rotation at which the section separates \[rad\]; `None`: not reached in the run.
    pub fracture_rotation_rad: Option<f64>,
}

/// Resistance about one bending axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisRecord {
    /// The envelopes at increasing axial force.
    pub envelopes: Vec<EnvelopeLevel>,
    /// What a hinge uses, derived from the envelopes.
    pub curve: ResistanceCurve,
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

/// How good the computation was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Quality {
    /// Largest ratio of kinetic to internal energy during loading (small: quasi-static).
    pub kinetic_energy_ratio: f64,
    /// Number of elements of the submodel.
    pub elements: u64,
    /// Largest relative difference of the moment between the two senses of rotation.
    pub asymmetry: f64,
}

/// Where the record comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// What it was computed from.
    pub inputs: Inputs,
    /// Hash of `inputs`, all 64 digits; the key ends with the first 16.
    pub inputs_hash: String,
    /// Version of the program that computed it.
    pub program_version: String,
}

/// Where the record holds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Validity {
    /// Lowest and highest axial force computed \[N\].
    pub axial_force_n: [f64; 2],
    /// Range of the rotation computed \[rad\].
    pub rotation_rad: [f64; 2],
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

/// One subsystem of the library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Always [`ENTRY_SCHEMA`].
    pub schema: u32,
    /// Readable path, `@`, and the first 16 digits of the hash of the inputs.
    pub key: String,
    /// Kind.
    pub kind: EntryKind,
    /// By what it is found.
    pub features: Features,
    /// Bending about axes 1 and 2.
    pub axes: [AxisRecord; 2],
    /// Elastic stiffnesses.
    pub stiffness: Stiffness,
    /// Tension at which the end separates \[N\].
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation of the end at that tension before it separates \[m\].
    pub tensile_elongation_m: Option<f64>,
    /// Axial force at which the section crushes \[N\].
    pub compressive_capacity_n: Option<f64>,
    /// Distance of the hinge from the end section, along the member \[m\].
    pub hinge_offset_m: f64,
    /// How good the computation was.
    pub quality: Quality,
    /// Where it comes from.
    pub provenance: Provenance,
    /// Where it holds.
    pub validity: Validity,
    /// Set when it is no longer to be used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deprecated: Option<Deprecation>,
}

/// What a submodel computes for one entry; [`Entry::new`] adds the key and the bookkeeping.
#[derive(Debug, Clone, PartialEq)]
pub struct Computed {
    /// Bending about axes 1 and 2.
    pub axes: [AxisRecord; 2],
    /// Elastic stiffnesses.
    pub stiffness: Stiffness,
    /// Tension at which the end separates \[N\].
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation of the end at that tension before it separates \[m\].
    pub tensile_elongation_m: Option<f64>,
    /// Axial force at which the section crushes \[N\].
    pub compressive_capacity_n: Option<f64>,
    /// Distance of the hinge from the end section, along the member \[m\].
    pub hinge_offset_m: f64,
    /// How good the computation was.
    pub quality: Quality,
    /// Where it holds.
    pub validity: Validity,
}

impl Entry {
    /// A new entry. Numbers of curves are rounded to 9 significant digits and the curves are thinned
    /// ([`super::thin`]) as far as the size limit of a record asks.
    ///
    /// # Errors
    /// If the inputs or the result cannot be written as JSON.
    pub fn new(
        kind: EntryKind,
        features: Features,
        inputs: Inputs,
        computed: Computed,
    ) -> Result<Self, serde_json::Error> {
        let hash = ContentHash::of_value(&inputs)?;
        let mut entry = Self {
            schema: ENTRY_SCHEMA,
            key: super::key::key_of(kind, &features, &hash),
            kind,
            features,
            axes: computed.axes,
            stiffness: computed.stiffness,
            tensile_capacity_n: computed.tensile_capacity_n,
            tensile_elongation_m: computed.tensile_elongation_m,
            compressive_capacity_n: computed.compressive_capacity_n,
            hinge_offset_m: computed.hinge_offset_m,
            quality: computed.quality,
            provenance: Provenance {
                inputs,
                inputs_hash: hash.to_string(),
                program_version: env!("CARGO_PKG_VERSION").to_string(),
            },
            validity: computed.validity,
            deprecated: None,
        };
        super::thin::fit(&mut entry)?;
        Ok(entry)
    }

    /// The text of the record with its checksum.
    ///
    /// # Errors
    /// If the entry cannot be written as JSON.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        let mut value = serde_json::to_value(self)?;
        let checksum = ContentHash::of_value(&value)?.to_string();
        if let Value::Object(members) = &mut value {
            members.insert("checksum".to_string(), Value::String(checksum));
        }
        readable_json(&value)
    }

    /// Reads a record and checks it: schema, checksum, key against inputs, and sense of the numbers.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let value: Value = serde_json::from_str(text).map_err(|e| format!("not JSON: {e}"))?;
        Self::from_value(value)
    }

    /// As [`Entry::from_text`], for JSON already read.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn from_value(mut value: Value) -> Result<Self, String> {
        match value.get("schema").and_then(Value::as_u64) {
            Some(schema) if schema == u64::from(ENTRY_SCHEMA) => {}
            Some(newer) => return Err(format!("schema {newer}; this program reads schema {ENTRY_SCHEMA}")),
            None => return Err("no schema number".to_string()),
        }
        let stated = value.as_object_mut().and_then(|members| members.remove("checksum"));
        let stated = stated.as_ref().and_then(Value::as_str).ok_or("no checksum")?;
        let found = ContentHash::of_value(&value).map_err(|e| e.to_string())?.to_string();
        if stated != found {
            return Err(format!("checksum is {}…, the content gives {}…", head(stated), head(&found)));
        }
        let entry: Self = serde_json::from_value(value).map_err(|e| e.to_string())?;
        super::check::entry(&entry)?;
        Ok(entry)
    }
}

fn head(text: &str) -> String {
    text.chars().take(12).collect()
}
