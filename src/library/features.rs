//! By what an entry is found: kind, place, and numbers with a name each.

use super::parts::Origin;
use crate::base::hash::ContentHash;
use crate::base::units::Dimension;
use crate::building::{Bar, Concrete, HardeningPoint, Homogenised, Section, SectionShape, Steel};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What kind of subsystem an entry is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EntryKind {
    /// The hinge at a column end: rotational resistance about two axes and the stiffnesses beside it.
    ColumnHinge,
    /// The hinge at a beam end; axis 1 is bending in the vertical plane.
    BeamHinge,
    /// The hinge at a wall's foot or head.
    WallHinge,
    /// A yield line of a slab; moments are those of a strip of `width_m`, its thickness is `depth_m`.
    SlabYieldLine,
    /// A spring along a member.
    AxialSpring,
    /// A spring across a member.
    ShearSpring,
    /// A spring about a member's axis; displacements are rotations, forces torques.
    TorsionSpring,
    /// Crushing of a member's end or edge in contact.
    ContactCrushing,
}

impl EntryKind {
    /// All kinds.
    pub const ALL: [Self; 8] = [
        Self::ColumnHinge,
        Self::BeamHinge,
        Self::WallHinge,
        Self::SlabYieldLine,
        Self::AxialSpring,
        Self::ShearSpring,
        Self::TorsionSpring,
        Self::ContactCrushing,
    ];

    /// The name in files and the folder of the records.
    pub fn name(self) -> &'static str {
        match self {
            Self::ColumnHinge => "column_hinge",
            Self::BeamHinge => "beam_hinge",
            Self::WallHinge => "wall_hinge",
            Self::SlabYieldLine => "slab_yield_line",
            Self::AxialSpring => "axial_spring",
            Self::ShearSpring => "shear_spring",
            Self::TorsionSpring => "torsion_spring",
            Self::ContactCrushing => "contact_crushing",
        }
    }

    /// The kind with this name.
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The name in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::ColumnHinge => "column",
            Self::BeamHinge => "beam",
            Self::WallHinge => "wall",
            Self::SlabYieldLine => "yield line",
            Self::AxialSpring => "axial spring",
            Self::ShearSpring => "shear spring",
            Self::TorsionSpring => "torsion spring",
            Self::ContactCrushing => "contact",
        }
    }

    /// The two ends that a member with such a hinge has; none if it is no matter of kinds.
    pub fn ends(self) -> Option<[ColumnEnd; 2]> {
        match self {
            Self::ColumnHinge | Self::WallHinge => Some([ColumnEnd::Bottom, ColumnEnd::Top]),
            Self::BeamHinge => Some([ColumnEnd::Lower, ColumnEnd::Upper]),
            _ => None,
        }
    }

    /// Whether its resistance is a moment over a rotation (else a force over a displacement).
    pub fn is_bending(self) -> bool {
        matches!(self, Self::ColumnHinge | Self::BeamHinge | Self::WallHinge | Self::SlabYieldLine)
    }
}

/// Which end of the member.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ColumnEnd {
    /// The head of a column or wall.
    Top,
    /// Its foot.
    Bottom,
    /// The end of a beam at its smaller coordinate.
    Lower,
    /// The end of a beam at its larger coordinate.
    Upper,
}

impl ColumnEnd {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Top => "top",
            Self::Bottom => "bottom",
            Self::Lower => "lower",
            Self::Upper => "upper",
        }
    }

    /// The end with this name.
    pub fn of_name(name: &str) -> Option<Self> {
        [Self::Top, Self::Bottom, Self::Lower, Self::Upper].into_iter().find(|end| end.name() == name)
    }
}

/// What the end is joined to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Adjoining {
    /// A slab without a beam at this place.
    Slab,
    /// A beam (with or without a slab).
    Beam,
    /// A column.
    Column,
    /// A wall.
    Wall,
    /// The ground, a footing or a rigid block: clamped.
    Ground,
}

impl Adjoining {
    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Slab => "slab",
            Self::Beam => "beam",
            Self::Column => "column",
            Self::Wall => "wall",
            Self::Ground => "ground",
        }
    }

    /// What has this name.
    pub fn of_name(name: &str) -> Option<Self> {
        [Self::Slab, Self::Beam, Self::Column, Self::Wall, Self::Ground]
            .into_iter()
            .find(|adjoining| adjoining.name() == name)
    }

    /// With its article.
    pub fn words(self) -> &'static str {
        match self {
            Self::Slab => "a slab",
            Self::Beam => "a beam",
            Self::Column => "a column",
            Self::Wall => "a wall",
            Self::Ground => "the ground",
        }
    }
}

/// The homogenised law of a member, as far as entries are compared by it.
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

/// Reinforced concrete, as far as entries are compared by it. What is not known is absent.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RcFeatures {
    /// Cylinder strength of the concrete (of a test: measured; of a design: characteristic) \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub concrete_strength_pa: Option<f64>,
    /// Area of all longitudinal bars over the gross area of the section.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reinforcement_ratio: Option<f64>,
    /// Yield strength of the longitudinal bars \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bar_yield_strength_pa: Option<f64>,
    /// Spacing of the ties along the member \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tie_spacing_m: Option<f64>,
    /// Diameter of the ties \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tie_diameter_m: Option<f64>,
    /// Yield strength of the ties \[Pa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tie_yield_strength_pa: Option<f64>,
}

impl RcFeatures {
    /// The features of a section of a building: its bars, ties, concrete and steel.
    pub fn of(section: &Section, concrete: &Concrete, steel: &Steel) -> Self {
        let (area_m2, gross_m2, ties) = match &section.shape {
            SectionShape::Rectangle { width_m, depth_m, bars, ties } => {
                let bar = |b: &Bar| 0.25 * std::f64::consts::PI * b.diameter_m * b.diameter_m;
                (bars.iter().map(bar).sum(), width_m * depth_m, ties.as_ref())
            }
            SectionShape::Plate { thickness_m, bar_diameter_m, bar_spacing_m, .. } => {
                let bar = 0.25 * std::f64::consts::PI * bar_diameter_m * bar_diameter_m;
                (2.0 * bar / bar_spacing_m, *thickness_m, None)
            }
        };
        let ratio: f64 = area_m2 / gross_m2;
        Self {
            concrete_strength_pa: Some(concrete.strength_pa),
            reinforcement_ratio: (ratio > 0.0).then_some(ratio),
            bar_yield_strength_pa: Some(steel.yield_strength_pa),
            tie_spacing_m: ties.map(|t| t.spacing_m),
            tie_diameter_m: ties.map(|t| t.diameter_m),
            tie_yield_strength_pa: ties.map(|_| steel.yield_strength_pa),
        }
    }
}

/// By what an entry is found. What does not apply to a kind, or is not known, is absent.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Features {
    /// Width of the section, along x for a column \[m\].
    pub width_m: f64,
    /// Depth of the section, along y for a column; thickness of a slab \[m\].
    pub depth_m: f64,
    /// Distance from the end to the point of zero moment; length of a spring's member \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length_to_inflection_m: Option<f64>,
    /// Which end.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<ColumnEnd>,
    /// What it is joined to.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub adjoining: Option<Adjoining>,
    /// The homogenised law of the member.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub law: Option<LawFeatures>,
    /// Edge length of the elements of the submodel \[m\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_size_m: Option<f64>,
    /// Reinforced concrete.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rc: Option<RcFeatures>,
    /// Further numbers, compared by name (for instance `strength_factor`).
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub further: BTreeMap<String, f64>,
}

/// A numeric feature.
pub struct NumberFeature {
    /// Its path in the record.
    pub name: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Weight of its logarithmic ratio in the distance ([`super::find`]).
    pub weight: f64,
    slot: fn(&mut Features) -> Option<&mut f64>,
}

const fn number(
    name: &'static str,
    dimension: Dimension,
    weight: f64,
    slot: fn(&mut Features) -> Option<&mut f64>,
) -> NumberFeature {
    NumberFeature { name, dimension, weight, slot }
}

/// All numeric features with a name of their own. A section depth enters the capacity about its own axis squared; both
/// depths are depths about one of the axes. Concrete matters little to the moment and more to the rotation
/// capacity; ties matter to the latter by their area over their spacing.
pub const NUMBERS: [NumberFeature; 14] = [
    number("width_m", Dimension::Length, 2.0, |f| Some(&mut f.width_m)),
    number("depth_m", Dimension::Length, 2.0, |f| Some(&mut f.depth_m)),
    number("length_to_inflection_m", Dimension::Length, 1.0, |f| f.length_to_inflection_m.as_mut()),
    number("law.yield_stress_pa", Dimension::Stress, 1.0, |f| f.law.as_mut().map(|l| &mut l.yield_stress_pa)),
    number("law.peak_stress_pa", Dimension::Stress, 1.0, |f| f.law.as_mut().map(|l| &mut l.peak_stress_pa)),
    number("law.critical_plastic_strain", Dimension::Number, 1.0, |f| {
        f.law.as_mut().map(|l| &mut l.critical_plastic_strain)
    }),
    number("law.youngs_modulus_pa", Dimension::Stress, 0.5, |f| {
        f.law.as_mut().map(|l| &mut l.youngs_modulus_pa)
    }),
    number("mesh_size_m", Dimension::Length, 0.5, |f| f.mesh_size_m.as_mut()),
    number("rc.concrete_strength_pa", Dimension::Stress, 0.5, |f| {
        f.rc.as_mut().and_then(|r| r.concrete_strength_pa.as_mut())
    }),
    number("rc.reinforcement_ratio", Dimension::Number, 1.0, |f| {
        f.rc.as_mut().and_then(|r| r.reinforcement_ratio.as_mut())
    }),
    number("rc.bar_yield_strength_pa", Dimension::Stress, 1.0, |f| {
        f.rc.as_mut().and_then(|r| r.bar_yield_strength_pa.as_mut())
    }),
    number("rc.tie_spacing_m", Dimension::Length, 0.5, |f| {
        f.rc.as_mut().and_then(|r| r.tie_spacing_m.as_mut())
    }),
    number("rc.tie_diameter_m", Dimension::Length, 1.0, |f| {
        f.rc.as_mut().and_then(|r| r.tie_diameter_m.as_mut())
    }),
    number("rc.tie_yield_strength_pa", Dimension::Stress, 0.5, |f| {
        f.rc.as_mut().and_then(|r| r.tie_yield_strength_pa.as_mut())
    }),
];

impl NumberFeature {
    /// The feature that a curator means by a name: its path, its last part, or that without the unit.
    pub fn meant_by(name: &str) -> Option<&'static Self> {
        let last = |feature: &Self| feature.name.rsplit('.').next().unwrap_or_default();
        NUMBERS.iter().find(|feature| {
            let short = last(feature);
            let bare = short.strip_suffix("_m").or(short.strip_suffix("_pa")).unwrap_or(short);
            [feature.name, short, bare].contains(&name)
        })
    }

    /// Its value, if it is stated.
    pub fn of(&self, features: &Features) -> Option<f64> {
        (self.slot)(&mut features.clone()).copied()
    }

    /// Sets it, where it is stated.
    pub fn set(&self, features: &mut Features, value: f64) {
        if let Some(slot) = (self.slot)(features) {
            *slot = value;
        }
    }
}

impl Features {
    /// All numbers by name, with the weight of each; those of `further` count once.
    pub fn numbers(&self) -> BTreeMap<String, (f64, f64)> {
        let mut own = self.clone();
        let mut all: BTreeMap<String, (f64, f64)> = NUMBERS
            .iter()
            .filter_map(|f| Some((f.name.to_string(), (*(f.slot)(&mut own)?, f.weight))))
            .collect();
        all.extend(self.further.iter().map(|(name, value)| (name.clone(), (*value, 1.0))));
        all
    }

    /// Sets a number by the name that [`Features::numbers`] gives it.
    pub fn set_number(&mut self, name: &str, value: f64) {
        match NUMBERS.iter().find(|f| f.name == name) {
            Some(feature) => feature.set(self, value),
            None => {
                self.further.insert(name.to_string(), value);
            }
        }
    }

    /// An entry of this kind in words, such as `column 0.40 x 0.40 m, top at a beam, 1.71 m to the point of zero moment`.
    pub fn words(&self, kind: EntryKind, origin: Origin) -> String {
        let mut words = format!("{} {:.2} x {:.2} m", kind.words(), self.width_m, self.depth_m);
        match (self.end, self.adjoining) {
            (Some(end), Some(beside)) => words += &format!(", {} at {}", end.name(), beside.words()),
            (Some(end), None) => words += &format!(", {}", end.name()),
            (None, Some(beside)) => words += &format!(", at {}", beside.words()),
            (None, None) => {}
        }
        if let Some(length) = self.length_to_inflection_m {
            let what = if kind.is_bending() { "to the point of zero moment" } else { "long" };
            words += &format!(", {length:.2} m {what}");
        }
        if let Some(factor) = self.further.get("strength_factor") {
            words += &format!(", strength × {factor}");
        }
        if origin != Origin::Submodel {
            words += &format!(" ({})", origin.words());
        }
        words
    }
}
