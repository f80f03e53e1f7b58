//! Values of features and of parameters, and the kinds of subjects.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A value: a number in the SI unit of its feature, a name out of a fixed set, or true/false.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// True or false.
    Flag(bool),
    /// A number.
    Number(f64),
    /// A name.
    Name(String),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => write!(f, "'{name}'"),
        }
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Value {
    fn from(name: &str) -> Self {
        Self::Name(name.to_string())
    }
}

/// What a rule decides about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SubjectKind {
    /// A structural member.
    Member,
    /// One end of a column or beam.
    MemberEnd,
    /// A section along a member where it may break.
    Section,
    /// A strip of a slab between two neighbouring columns, across which it may yield.
    SlabLine,
    /// The foot or the head of a wall.
    WallEnd,
    /// Something has met something.
    ContactEvent,
    /// A part has broken.
    FractureEvent,
}

impl SubjectKind {
    /// All kinds.
    pub const ALL: [Self; 7] = [
        Self::Member,
        Self::MemberEnd,
        Self::Section,
        Self::SlabLine,
        Self::WallEnd,
        Self::ContactEvent,
        Self::FractureEvent,
    ];

    /// The name in rule files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Member => "member",
            Self::MemberEnd => "member_end",
            Self::Section => "section",
            Self::SlabLine => "slab_line",
            Self::WallEnd => "wall_end",
            Self::ContactEvent => "contact_event",
            Self::FractureEvent => "fracture_event",
        }
    }

    /// The kind with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

impl fmt::Display for SubjectKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Something to decide about, with what is known of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Subject {
    /// Id of the member, end (`C1.bottom`), section, line (`S1:C1-A1|C1-B1`) or event.
    pub id: String,
    /// Kind.
    pub kind: SubjectKind,
    /// What is known: names of [`super::features`]; what is not known is left out.
    pub features: BTreeMap<String, Value>,
}

impl Subject {
    /// A subject of which nothing is known yet.
    pub fn new(kind: SubjectKind, id: &str) -> Self {
        Self { id: id.to_string(), kind, features: BTreeMap::new() }
    }

    /// Adds what is known of one feature.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.features.insert(name.to_string(), value.into());
        self
    }

    /// The value of a number, if it is known.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.features.get(name) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// Adds a number, if it is known.
    #[must_use]
    pub fn with_known(self, name: &str, value: Option<f64>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }
}
