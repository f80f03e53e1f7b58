//! The MBS model file: rigid bodies, joints, curves, contact, events. Versioned JSON, SI units.

use crate::curve::ResistanceCurve;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the model file written by this program.
pub const MODEL_SCHEMA: &str = "fallwerk-mbs/1";

/// A multibody model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Always [`MODEL_SCHEMA`].
    pub schema: String,
    /// Name of the scene.
    pub name: String,
    /// Gravity vector \[m/s²\].
    pub gravity_m_s2: [f64; 3],
    /// Rigid bodies.
    pub bodies: Vec<Body>,
    /// Resistance curves by id.
    #[serde(default)]
    pub curves: BTreeMap<String, ResistanceCurve>,
    /// Joints between two bodies or between a body and the ground.
    #[serde(default)]
    pub joints: Vec<Joint>,
    /// Contact with ground, obstacles and between bodies.
    #[serde(default)]
    pub contact: Contact,
    /// Events in time.
    #[serde(default)]
    pub events: Vec<Event>,
    /// Points whose displacement is recorded.
    #[serde(default)]
    pub tracked: Vec<TrackedPoint>,
    /// Run settings.
    #[serde(default)]
    pub settings: RunSettings,
}

/// Why a part of the model is there.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Origin {
    /// Building members (or connection ids) that the part stands for.
    #[serde(default)]
    pub members: Vec<String>,
    /// Ids of the rules that fired for it.
    #[serde(default)]
    pub rules: Vec<String>,
    /// Keys of the library entries used.
    #[serde(default)]
    pub entries: Vec<String>,
}

/// A rigid body. The body frame has its origin at the centre of mass.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Body {
    /// Unique id.
    pub id: String,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Inertia tensor about the centre of mass in the body frame \[kg m²\].
    pub inertia_kg_m2: [[f64; 3]; 3],
    /// Centre of mass \[m\].
    pub position_m: [f64; 3],
    /// Orientation quaternion `[w, x, y, z]`.
    #[serde(default = "identity_quaternion")]
    pub orientation: [f64; 4],
    /// Velocity of the centre of mass \[m/s\].
    #[serde(default)]
    pub velocity_m_s: [f64; 3],
    /// Angular velocity in the global frame \[rad/s\].
    #[serde(default)]
    pub angular_velocity_rad_s: [f64; 3],
    /// Contact shapes in the body frame.
    #[serde(default)]
    pub shapes: Vec<Shape>,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

fn identity_quaternion() -> [f64; 4] {
    [1.0, 0.0, 0.0, 0.0]
}

/// A contact shape: a box in the body frame, edges along the body axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// Centre in the body frame \[m\].
    pub center_m: [f64; 3],
    /// Half edge lengths \[m\].
    pub half_extents_m: [f64; 3],
}

/// A compliant joint with six stiffnesses between body `a` (or the ground) and body `b`.
///
/// In the joint frame, carried by `a`, axis 0 is the member axis: translation 0 is axial, 1 and 2
/// are shear; rotation 0 is torsion, 1 and 2 are bending about the axes 1 and 2. The joint is stress-free
/// in the initial poses of the file. Bodies moving apart along axis 0 are in tension: apart means along the
/// sense of axis 0 that points from the centre of mass of `a` (from the joint point, if `a` is the ground) to that of `b`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Unique id.
    pub id: String,
    /// First body; `None` is the ground.
    pub body_a: Option<String>,
    /// Second body.
    pub body_b: String,
    /// The joint point in the global frame, initial pose \[m\].
    pub point_m: [f64; 3],
    /// Rows are the joint axes in the global frame, initial pose: orthonormal, right-handed.
    pub axes: [[f64; 3]; 3],
    /// Axial stiffness \[N/m\].
    pub axial_stiffness_n_m: f64,
    /// Shear stiffness along axes 1 and 2 \[N/m\].
    pub shear_stiffness_n_m: [f64; 2],
    /// Torsional stiffness \[N m/rad\].
    pub torsional_stiffness_nm_rad: f64,
    /// Bending about axes 1 and 2.
    pub bending: [Bending; 2],
    /// Tension \[N\] at which the joint separates; `None`: never.
    #[serde(default)]
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation \[m\] that the member bears at its tensile capacity before it separates; `None`: none, it
    /// separates as soon as the capacity is reached.
    #[serde(default)]
    pub tensile_elongation_m: Option<f64>,
    /// Compression \[N\] at which the member crushes: the axial spring is elastic-perfectly plastic there;
    /// `None`: never. Without it a storey that lands on its columns rebounds elastically.
    #[serde(default)]
    pub compressive_capacity_n: Option<f64>,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

/// Rotational resistance about one bending axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Bending {
    /// Linear elastic.
    Elastic {
        /// Stiffness \[N m/rad\].
        stiffness_nm_rad: f64,
    },
    /// Elastic-plastic with a capacity curve that depends on axial force, and fracture.
    Curve {
        /// Id in [`Model::curves`].
        curve: String,
        /// Factor on the capacity (preparatory weakening).
        #[serde(default = "one")]
        strength_factor: f64,
    },
}

fn one() -> f64 {
    1.0
}

/// What can touch.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// Rigid horizontal ground.
    #[serde(default)]
    pub ground: Option<GroundPlane>,
    /// Rigid immovable boxes.
    #[serde(default)]
    pub obstacles: Vec<ObstacleBox>,
    /// Contact between bodies; `None` switches it off.
    #[serde(default)]
    pub bodies: Option<BodyContact>,
}

/// Rigid ground plane `z = level`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundPlane {
    /// Height \[m\].
    pub level_m: f64,
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Rigid box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleBox {
    /// Unique id.
    pub id: String,
    /// Lower corner \[m\].
    pub min_m: [f64; 3],
    /// Upper corner \[m\].
    pub max_m: [f64; 3],
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Contact between bodies. Bodies joined by an intact joint do not touch each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyContact {
    /// Coulomb friction coefficient.
    pub friction: f64,
}

/// Something that happens at a given time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Unique id (of the charge).
    pub id: String,
    /// Time \[s\].
    pub time_s: f64,
    /// Bodies that vanish with their joints.
    pub remove_bodies: Vec<String>,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

/// A recorded point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackedPoint {
    /// Unique id, the same as in the FE run it is compared with.
    pub id: String,
    /// Body that carries it.
    pub body: String,
    /// Global position in the initial pose \[m\].
    pub point_m: [f64; 3],
}

/// Run settings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct RunSettings {
    /// Simulated time \[s\].
    pub end_time_s: f64,
    /// Interval of histories and frames \[s\].
    pub output_interval_s: f64,
    /// Whether the static equilibrium under gravity is found before `t = 0`.
    pub preload: bool,
    /// Time step \[s\]; `None`: chosen from the highest frequency of the model.
    pub time_step_s: Option<f64>,
}

impl Default for RunSettings {
    fn default() -> Self {
        Self { end_time_s: 1.0, output_interval_s: 0.01, preload: false, time_step_s: None }
    }
}
