//! One subsystem of the library: the record and its text form.
//!
//! SI units; axial force is positive in compression. The text form is JSON with sorted keys; its
//! `checksum` is the hash of the record without that field, so that a flipped digit is noticed.
//!
//! Schema 2 has kinds beside the column hinge, an `origin`, and parts that may be absent. A record of schema 1 (column
//! hinges of the homogenised submodel) is one of schema 2 without `origin`; it keeps its key and its schema number.

use super::error::StoreError;
pub use super::features::{Adjoining, ColumnEnd, EntryKind, Features, LawFeatures, RcFeatures};
pub use super::parts::{
    AxisRecord, Branch, Deprecation, Direction, EnvelopeLevel, Inputs, Interpolation, Loading, Origin,
    Provenance, Quality, Source, SpringLevel, SpringRecord, Stiffness, Validity,
};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::json;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Version of the record format that is written.
pub const ENTRY_SCHEMA: u32 = 2;
/// Oldest version that is read.
pub const OLDEST_SCHEMA: u32 = 1;

/// Largest size of a record \[bytes\] without what is said of its deprecation, which any record has room for: much larger
/// values make the working copy (sled) keep blobs that it never gives back.
pub const RECORD_LIMIT_BYTES: usize = 16_000;
/// Most characters of the reason of a deprecation.
pub const REASON_LIMIT: usize = 500;

/// One subsystem of the library.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// [`OLDEST_SCHEMA`] to [`ENTRY_SCHEMA`].
    pub schema: u32,
    /// Readable path, `@`, and the first 16 digits of the hash of the inputs.
    pub key: String,
    /// Kind.
    pub kind: EntryKind,
    /// How the curves were obtained; not written in schema 1.
    #[serde(default)]
    pub origin: Origin,
    /// By what it is found.
    pub features: Features,
    /// Bending about axes 1 and 2; a test often has axis 1 only.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<AxisRecord>,
    /// Springs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<SpringRecord>,
    /// Elastic stiffnesses.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<Stiffness>,
    /// Tension at which the end separates \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation of the end at that tension before it separates \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tensile_elongation_m: Option<f64>,
    /// Axial force at which the section crushes \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub compressive_capacity_n: Option<f64>,
    /// Axial force that the floor at the end does not bear where no column goes on beyond it \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bearing_capacity_n: Option<f64>,
    /// Distance of the hinge from the end section, along the member \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hinge_offset_m: Option<f64>,
    /// How good the curves are.
    pub quality: Quality,
    /// Where it comes from.
    pub provenance: Provenance,
    /// Where it holds.
    pub validity: Validity,
    /// Set when it is no longer to be used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deprecated: Option<Deprecation>,
}

/// The result of a submodel or a test for one entry; [`Entry::new`] adds the key and the bookkeeping. The fields are
/// those of [`Entry`]; what is not known stays at its default.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Computed {
    /// Bending about axes 1 and 2.
    pub axes: Vec<AxisRecord>,
    /// Springs.
    pub springs: Vec<SpringRecord>,
    /// Elastic stiffnesses.
    pub stiffness: Option<Stiffness>,
    /// Tension at which the end separates \[N\].
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation of the end at that tension before it separates \[m\].
    pub tensile_elongation_m: Option<f64>,
    /// Axial force at which the section crushes \[N\].
    pub compressive_capacity_n: Option<f64>,
    /// Axial force that the floor at the end does not bear where no column goes on beyond it \[N\].
    pub bearing_capacity_n: Option<f64>,
    /// Distance of the hinge from the end section, along the member \[m\].
    pub hinge_offset_m: Option<f64>,
    /// How good the curves are.
    pub quality: Quality,
    /// Where they hold.
    pub validity: Validity,
}

/// What a hinge of the multibody model needs of an entry.
#[derive(Debug, Clone, Copy)]
pub struct HingeParts<'a> {
    /// Bending about axes 1 and 2.
    pub axes: [&'a AxisRecord; 2],
    /// Elastic stiffnesses.
    pub stiffness: Stiffness,
    /// Distance of the hinge from the end section \[m\].
    pub offset_m: f64,
}

impl Entry {
    /// A new entry. Numbers of curves are rounded to 9 significant digits and the curves are thinned
    /// ([`super::thin`]) as far as the size limit of a record asks.
    ///
    /// # Errors
    /// If the inputs or the result cannot be written as JSON.
    pub fn new(
        kind: EntryKind,
        origin: Origin,
        features: Features,
        inputs: Inputs,
        computed: Computed,
    ) -> Result<Self, serde_json::Error> {
        let mut entry = Self::unthinned(kind, origin, features, inputs, computed)?;
        super::thin::fit(&mut entry)?;
        Ok(entry)
    }

    /// As [`Entry::new`], with all points as they are.
    pub(super) fn unthinned(
        kind: EntryKind,
        origin: Origin,
        features: Features,
        inputs: Inputs,
        computed: Computed,
    ) -> Result<Self, serde_json::Error> {
        let hash = ContentHash::of_value(&inputs)?;
        Ok(Self {
            schema: ENTRY_SCHEMA,
            key: super::key::key_of(kind, &features, &hash),
            kind,
            origin,
            features,
            axes: computed.axes,
            springs: computed.springs,
            stiffness: computed.stiffness,
            tensile_capacity_n: computed.tensile_capacity_n,
            tensile_elongation_m: computed.tensile_elongation_m,
            compressive_capacity_n: computed.compressive_capacity_n,
            bearing_capacity_n: computed.bearing_capacity_n,
            hinge_offset_m: computed.hinge_offset_m,
            quality: computed.quality,
            provenance: Provenance {
                inputs,
                inputs_hash: hash.to_string(),
                program_version: env!("CARGO_PKG_VERSION").to_string(),
            },
            validity: computed.validity,
            deprecated: None,
        })
    }

    /// All that a hinge needs.
    ///
    /// # Errors
    /// Which part the entry lacks: a test about one axis does not make a joint in space.
    pub fn hinge(&self) -> Result<HingeParts<'_>, StoreError> {
        let lacks = |what: &str| StoreError::Invalid {
            key: self.key.clone(),
            what: format!("has no {what}, which a hinge of the multibody model needs"),
        };
        match (self.axes.as_slice(), self.stiffness, self.hinge_offset_m) {
            ([first, second], Some(stiffness), Some(offset_m)) => {
                Ok(HingeParts { axes: [first, second], stiffness, offset_m })
            }
            ([_, _], None, _) => Err(lacks("elastic stiffness beside bending")),
            ([_, _], _, None) => Err(lacks("place of the hinge (`hinge_offset_m`)")),
            _ => Err(lacks("curves about both axes")),
        }
    }

    /// The parts of a hinge on a line of a floor: its stiffnesses and the distance of the hinge from the line \[m\]; its curve is the first one.
    ///
    /// # Errors
    /// If it lacks one of them.
    pub fn line(&self) -> Result<(Stiffness, f64), StoreError> {
        let lacks = |what: &str| StoreError::Invalid {
            key: self.key.clone(),
            what: format!("has no {what}, which a hinge on a line of a floor needs"),
        };
        match (self.axes.is_empty(), self.stiffness, self.hinge_offset_m) {
            (false, Some(stiffness), Some(offset_m)) => Ok((stiffness, offset_m)),
            (true, ..) => Err(lacks("curve")),
            (_, None, _) => Err(lacks("elastic stiffness beside bending")),
            (_, _, None) => Err(lacks("place of the hinge (`hinge_offset_m`)")),
        }
    }

    /// The entry in words.
    pub fn words(&self) -> String {
        self.features.words(self.kind, self.origin)
    }

    /// Largest moment of any envelope or curve \[N m\], or force of any spring \[N\].
    pub fn peak(&self) -> f64 {
        let envelopes = self.axes.iter().flat_map(|a| &a.envelopes).flat_map(|l| &l.points);
        let springs = self.springs.iter().flat_map(|s| &s.levels).flat_map(|l| &l.points);
        let curves = self.axes.iter().filter(|a| a.envelopes.is_empty()).map(|a| a.curve.peak_nm());
        envelopes.chain(springs).map(|p| p[1].abs()).chain(curves).fold(0.0, f64::max)
    }

    /// The record as JSON, without its checksum.
    fn to_value(&self) -> Result<Value, serde_json::Error> {
        let mut value = serde_json::to_value(self)?;
        if self.schema == OLDEST_SCHEMA
            && let Value::Object(members) = &mut value
        {
            members.remove("origin");
        }
        Ok(value)
    }

    /// The hash of the record's content, as its `checksum` states it.
    ///
    /// # Errors
    /// If the entry cannot be written as JSON.
    pub fn checksum(&self) -> Result<ContentHash, serde_json::Error> {
        ContentHash::of_value(&self.to_value()?)
    }

    /// The text of the record with its checksum.
    ///
    /// # Errors
    /// If the entry cannot be written as JSON.
    pub fn to_text(&self) -> Result<String, serde_json::Error> {
        let mut value = self.to_value()?;
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
            Some(schema) if (u64::from(OLDEST_SCHEMA)..=u64::from(ENTRY_SCHEMA)).contains(&schema) => {}
            Some(other) => {
                return Err(format!(
                    "schema {other}; this program reads schema {OLDEST_SCHEMA} to {ENTRY_SCHEMA}"
                ));
            }
            None => return Err("no schema number".to_string()),
        }
        let stated = value.as_object_mut().and_then(|members| members.remove("checksum"));
        let stated = stated.as_ref().and_then(Value::as_str).ok_or("no checksum")?;
        let found = ContentHash::of_value(&value).map_err(|e| e.to_string())?.to_string();
        if stated != found {
            return Err(format!(
                "checksum is {}…, the content gives {}…: take the file from version control, or remove it and import or derive the entry again",
                head(stated),
                head(&found)
            ));
        }
        let entry: Self = json::from_value(value).map_err(|e| e.to_string())?;
        super::check::entry(&entry)?;
        Ok(entry)
    }
}

fn head(text: &str) -> String {
    text.chars().take(12).collect()
}
