//! The resolved product model: everything in SI units, every reference checked.
//!
//! A [`Building`] is what the file reader makes of a TOML or JSON description after all checks
//! have passed. Later modules take it as given: ids are unique, references resolve, solids have
//! volume, and `members` are sorted by id order of the file (grid members first, in storey order).

use super::inclined::Inclined;
use super::partition::COORDINATE_TOLERANCE_M;
use super::turned::TurnedBox;
use crate::base::geom::Aabb;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A building with its surroundings and its demolition plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Building {
    /// Short name, used in titles and file names.
    pub name: String,
    /// One paragraph for the reader of the report.
    pub description: String,
    /// Materials by id.
    pub materials: BTreeMap<String, Material>,
    /// Reinforced sections by id.
    pub sections: BTreeMap<String, Section>,
    /// Structural members.
    pub members: Vec<Member>,
    /// Supports of members.
    pub supports: Vec<Support>,
    /// The rigid ground.
    pub ground: Ground,
    /// Rigid obstacles.
    pub obstacles: Vec<Obstacle>,
    /// Work done before ignition (the dead-load state is found after it).
    pub preparation: Vec<Preparation>,
    /// Charges in order of ignition time.
    pub events: Vec<Charge>,
    /// Simulation settings.
    pub settings: Settings,
    /// What the analyst decides in place of the rules. Not part of a building as it is written and hashed: FE runs know nothing of it, so that their
    /// records are still those of this building.
    #[serde(skip)]
    pub overrides: Vec<Override>,
}

/// Time after the last charge that tells whether a building stands \[s\]: it has fallen freely by 1.2 m then.
const TELLING_S: f64 = 0.5;

impl Building {
    /// The member with this id.
    pub fn member(&self, id: &str) -> Option<&Member> {
        self.members.iter().find(|m| m.id == id)
    }

    /// Refuses members out of the axes for what knows boxes along the axes only; `what` begins the sentence.
    ///
    /// # Errors
    /// If there is such a member, with its id, the key and the remedy.
    pub fn without_skew(&self, what: &str) -> Result<(), String> {
        let Some(m) = self.members.iter().find(|m| m.is_skew()) else { return Ok(()) };
        let (is, remedy) = match m.inclined {
            Some(_) => (
                "has an axis of its own direction".to_string(),
                "leave it out of the file, if the building stands without it",
            ),
            None => (format!("has `rotation_deg = {}`", m.rotation_deg), "leave `rotation_deg` out of it"),
        };
        Err(format!(
            "{what}: skew members run in FE only, and the {} `{}` {is}\n  = help: run `fallwerk fe`, or {remedy}",
            m.kind.name(),
            m.id
        ))
    }

    /// That a run of the building ends soon after the last charge, with what helps.
    pub fn ends_soon(&self) -> Option<String> {
        let last = self.events.iter().max_by(|a, b| a.time_s.total_cmp(&b.time_s))?;
        let end_s = self.settings.end_time_s;
        let is_soon = last.time_s <= end_s && end_s - last.time_s < TELLING_S;
        is_soon.then(|| {
            format!(
                "charge `{}` is fired at {} s and the run ends at settings.end_time = {end_s} s: too soon to tell whether the building stands",
                last.id, last.time_s
            )
        })
    }

    /// Whether preparatory work cuts a member away.
    pub fn is_cut(&self, member: &str) -> bool {
        self.preparation.iter().any(|p| matches!(p, Preparation::Cut { member: m } if m == member))
    }

    /// The share of its strength that preparatory weakening leaves a member: the product of its weakenings.
    pub fn strength_factor(&self, member: &str) -> f64 {
        let factors = self.preparation.iter().filter_map(|p| match p {
            Preparation::Weaken { member: m, strength_factor } if m == member => Some(*strength_factor),
            _ => None,
        });
        factors.product()
    }

    /// The homogenised law a member is made of.
    ///
    /// # Panics
    /// Never for a checked building: each section names a homogenised material that exists.
    pub fn law_of(&self, member: &Member) -> &Homogenised {
        match &self.materials[&self.sections[&member.section].law] {
            Material::Homogenised(law) => law,
            _ => unreachable!("checked: section.law names a homogenised material"),
        }
    }
}

/// A material.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Material {
    /// Concrete of a strength class.
    Concrete(Concrete),
    /// Reinforcing steel.
    Steel(Steel),
    /// Reinforced concrete smeared into one law, as the global FE model uses it.
    Homogenised(Homogenised),
}

/// Concrete.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Concrete {
    /// Density including reinforcement \[kg/m³\].
    pub density_kg_m3: f64,
    /// Characteristic cylinder strength f_ck \[Pa\].
    pub strength_pa: f64,
    /// Secant modulus E_cm \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
}

/// Reinforcing steel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Steel {
    /// Yield strength f_yk \[Pa\].
    pub yield_strength_pa: f64,
    /// Ultimate strength f_tk \[Pa\].
    pub ultimate_strength_pa: f64,
    /// Strain at maximum force ε_uk.
    pub ultimate_strain: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
}

/// Homogenised reinforced concrete: J2 plasticity with piecewise linear isotropic hardening and
/// erosion at a critical plastic strain (seed paper, section 3.2 and equation 1).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Homogenised {
    /// Density \[kg/m³\].
    pub density_kg_m3: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Yield stress \[Pa\] over equivalent plastic strain, first strain zero, strains increasing;
    /// constant beyond the last point.
    pub hardening: Vec<HardeningPoint>,
    /// Equivalent plastic strain at which an element erodes (equation 1).
    pub critical_plastic_strain: f64,
    /// Rate factor on the yield stress; `None`: the law knows no rate.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate_factor: Option<CowperSymonds>,
    /// Largest principal strain (tension) at which an element erodes, if that comes first; `None`: not by this.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub critical_principal_strain: Option<f64>,
}

impl Homogenised {
    /// Shear modulus \[Pa\].
    pub fn shear_modulus_pa(&self) -> f64 {
        self.youngs_modulus_pa / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// Without its rate factor: what slow pushes are made with.
    #[must_use]
    pub fn in_slow_motion(&self) -> Self {
        Self { rate_factor: None, ..self.clone() }
    }

    /// Strain at which it breaks when it is pulled or pressed along one axis: the smaller one of both criteria.
    pub fn rupture_strain(&self) -> f64 {
        self.critical_plastic_strain.min(self.critical_principal_strain.unwrap_or(f64::INFINITY))
    }
}

/// Rate factor `1 + (ε̇ / C)^(1/P)` on the yield stress (Cowper and Symonds 1957), with the equivalent plastic strain rate.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CowperSymonds {
    /// C \[1/s\].
    pub c_1_s: f64,
    /// P.
    pub p: f64,
}

/// One point of a hardening table.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HardeningPoint {
    /// Equivalent plastic strain.
    pub plastic_strain: f64,
    /// Yield stress \[Pa\].
    pub stress_pa: f64,
}

/// A reinforced rectangular section (columns, beams) or a reinforced plate (slabs, walls, footings).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Section {
    /// Section id.
    pub id: String,
    /// Shape and size.
    pub shape: SectionShape,
    /// Id of the concrete.
    pub concrete: String,
    /// Id of the steel of bars and ties.
    pub steel: String,
    /// Id of the homogenised material used by the global FE model.
    pub law: String,
}

/// The shape of a section with its reinforcement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum SectionShape {
    /// Rectangle of a column (width along x, depth along y) or of a beam (width horizontal,
    /// depth vertical, measured to the top of the slab).
    Rectangle {
        /// Width \[m\].
        width_m: f64,
        /// Depth \[m\].
        depth_m: f64,
        /// Longitudinal bars.
        bars: Vec<Bar>,
        /// Ties or stirrups.
        ties: Option<Ties>,
    },
    /// Plate with the same orthogonal mesh at both faces.
    Plate {
        /// Thickness \[m\].
        thickness_m: f64,
        /// Bar diameter \[m\].
        bar_diameter_m: f64,
        /// Bar spacing \[m\].
        bar_spacing_m: f64,
        /// Distance from the face to the bar centre \[m\].
        bar_cover_m: f64,
    },
}

/// One longitudinal bar; the origin is the section's centre.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Bar {
    /// Position along the width \[m\].
    pub x_m: f64,
    /// Position along the depth \[m\].
    pub y_m: f64,
    /// Diameter \[m\].
    pub diameter_m: f64,
}

/// Ties (columns) or stirrups (beams).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ties {
    /// Diameter \[m\].
    pub diameter_m: f64,
    /// Spacing along the member \[m\].
    pub spacing_m: f64,
}

/// What kind of member it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MemberKind {
    /// Vertical bar.
    Column,
    /// Horizontal bar.
    Beam,
    /// Horizontal plate.
    Slab,
    /// Vertical plate.
    Wall,
    /// Footing on the ground.
    Footing,
    /// Bar in any direction.
    Brace,
}

impl MemberKind {
    /// What it is called, in files and messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Column => "column",
            Self::Beam => "beam",
            Self::Slab => "slab",
            Self::Wall => "wall",
            Self::Footing => "footing",
            Self::Brace => "brace",
        }
    }
}

/// A structural member: an axis-aligned solid, one turned about the vertical axis, or a bar in any direction.
///
/// Solids are given gross, as a formwork drawing names them: a column reaches from floor to floor,
/// a beam's depth includes the slab. Where solids of different kinds overlap, the stiffer plate owns the
/// common volume: footing over slab over wall over beam over column ([`super::partition`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    /// Unique id.
    pub id: String,
    /// Kind.
    pub kind: MemberKind,
    /// Section id.
    pub section: String,
    /// Gross solid \[m\], before it is turned; of a bar in any direction the box around it.
    pub solid: Aabb,
    /// Long axis of a column or beam, normal of a slab, wall or footing: 0 = x, 1 = y, 2 = z; 0 of a bar in any direction, whose own first axis is the long one.
    pub axis: usize,
    /// Storey number from 1, of the grid that the member comes from; in a building without a grid by the levels of its floors.
    pub storey: Option<u32>,
    /// Openings of a plate, as boxes that cut through the solid along `axis` \[m\].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub openings: Vec<Aabb>,
    /// Angle by which the solid is turned about the vertical axis through its centre, anticlockwise seen from above \[deg\].
    #[serde(default, skip_serializing_if = "is_zero")]
    pub rotation_deg: f64,
    /// Axis and section of a bar in any direction.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inclined: Option<Inclined>,
}

/// Whether a number is zero.
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Member {
    /// Whether it is turned out of the axes. Such a member is no part of the partition and runs in FE only ([`super::clear`]).
    pub fn is_skew(&self) -> bool {
        self.rotation_deg != 0.0 || self.inclined.is_some()
    }

    /// The box along the axes around its gross shape.
    pub fn bounds(&self) -> Aabb {
        if self.is_skew() { TurnedBox::of(self).bounds() } else { self.solid }
    }

    /// Edges of the gross shape along its own axes \[m\].
    pub fn size_m(&self) -> [f64; 3] {
        if self.is_skew() { TurnedBox::of(self).half_m.map(|h| 2.0 * h) } else { self.solid.size() }
    }

    /// Whether its foot rests on a footing, or in it.
    pub fn stands_on(&self, footing: &Self) -> bool {
        let foot = Aabb { max: [self.solid.max[0], self.solid.max[1], self.solid.min[2]], ..self.solid };
        footing.kind == MemberKind::Footing && footing.solid.is_nearer(&foot, COORDINATE_TOLERANCE_M)
    }

    /// Distance of a point along the member's axis from its lower or first end \[m\].
    pub fn along_m(&self, point_m: [f64; 3]) -> f64 {
        if !self.is_skew() {
            return point_m[self.axis] - self.solid.min[self.axis];
        }
        let shape = TurnedBox::of(self);
        shape.half_m[self.axis] + shape.to_local(point_m)[self.axis]
    }
}

/// A support: the named face of a member cannot move.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Support {
    /// Member id.
    pub member: String,
    /// Which face is held.
    pub face: Face,
}

/// A face of an axis-aligned solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Face {
    /// Smallest z.
    Bottom,
    /// Largest z.
    Top,
}

/// Rigid horizontal ground.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Ground {
    /// Height of the surface \[m\].
    pub level_m: f64,
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// A rigid, immovable box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Obstacle {
    /// Unique id.
    pub id: String,
    /// Its solid \[m\].
    pub solid: Aabb,
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Preparatory work on a member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Preparation {
    /// The member's strength is multiplied by `strength_factor` (0 < factor < 1).
    Weaken {
        /// Member id.
        member: String,
        /// Remaining share of the strength.
        strength_factor: f64,
    },
    /// The member is cut away before the dead-load state.
    Cut {
        /// Member id.
        member: String,
    },
}

/// A charge: at `time_s` it removes a member or a stretch of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Charge {
    /// Unique id.
    pub id: String,
    /// Member id.
    pub member: String,
    /// Stretch of the member that is removed, along its axis from its lower end \[m\];
    /// `None` removes the whole member.
    pub stretch_m: Option<[f64; 2]>,
    /// Ignition time from the start of the run \[s\]; before [`Settings::end_time_s`].
    pub time_s: f64,
}

/// A decision of the analyst in place of the rules.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Override {
    /// Member end (`C1-A1.top`), wall, or a slab or beam that stands for its floor.
    pub target: String,
    /// What is decided.
    pub action: OverrideAction,
    /// Why.
    pub reason: String,
}

/// What an analyst may decide; the names are those of the actions of rules.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OverrideAction {
    /// A column end is a hinge.
    Hinge,
    /// A column end does not yield.
    ElasticConnection,
    /// A column end does not turn in its joint; no line at which a floor may fold runs through a beam end.
    RigidConnection,
    /// The floor may fold at the line through a beam end.
    LatentHinge,
    /// A floor is one rigid body; a wall is one with the floors that it touches.
    MergeRigid,
    /// A floor bends.
    MergeElastic,
    /// A wall is a body of its own.
    RigidBody,
    /// A beam may break away from its slab.
    BreakAway,
}

impl OverrideAction {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Hinge,
        Self::ElasticConnection,
        Self::RigidConnection,
        Self::LatentHinge,
        Self::MergeRigid,
        Self::MergeElastic,
        Self::RigidBody,
        Self::BreakAway,
    ];

    /// Its name in building files, and that of the same action in rule files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hinge => "hinge",
            Self::ElasticConnection => "elastic_connection",
            Self::RigidConnection => "rigid_connection",
            Self::LatentHinge => "latent_hinge",
            Self::MergeRigid => "merge_rigid",
            Self::MergeElastic => "merge_elastic",
            Self::RigidBody => "rigid_body",
            Self::BreakAway => "break_away",
        }
    }
}

/// Simulation settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Time at which the run ends \[s\]; it starts in equilibrium at zero, from which the times of charges count as well.
    pub end_time_s: f64,
    /// Interval of histories and frames \[s\].
    pub output_interval_s: f64,
    /// Time over which removed members lose their stress \[s\]; zero is allowed.
    pub removal_duration_s: f64,
    /// Gravity, positive downwards \[m/s²\].
    pub gravity_m_s2: f64,
    /// Target edge length of the FE mesh \[m\].
    pub mesh_size_m: f64,
    /// Strain rate above which a part does not count as rigid \[1/s\] (seed paper, equation 2).
    pub critical_strain_rate_1_s: f64,
    /// What the FE mesh does other than to fill all members with elements of the target size.
    #[serde(default, skip_serializing_if = "Meshing::is_default")]
    pub meshing: Meshing,
}

/// Exceptions of the FE mesh.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Meshing {
    /// Smaller elements in or near some members.
    pub refine: Vec<Refinement>,
    /// Mesh planes nearer to each other than this \[m\] are avoided: the column that would bring them has a mesh of its own,
    /// tied to its neighbours. Zero: never.
    pub tie_below_m: f64,
}

impl Meshing {
    /// Whether there are no exceptions.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// A smaller element size in a member.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Refinement {
    /// Member id.
    pub member: String,
    /// Target edge length there \[m\].
    pub size_m: f64,
    /// Only within this distance of the member's ends \[m\]; `None`: all of it.
    pub ends_m: Option<f64>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            end_time_s: 2.5,
            output_interval_s: 0.01,
            removal_duration_s: 0.0,
            gravity_m_s2: 9.81,
            mesh_size_m: 0.4,
            critical_strain_rate_1_s: 0.25,
            meshing: Meshing::default(),
        }
    }
}
