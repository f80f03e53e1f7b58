//! The MBS model file: rigid bodies, joints, forces, contact, events. Versioned JSON, SI units.
//!
//! | file | owns |
//! |---|---|
//! | this one | bodies, events, settings |
//! | `connection` | joints, bushings, forces |
//! | `contact` | shapes, ground, obstacles, who may touch |
//! | `mass` | inertial coupling of bodies |
//! | `event_rule` | what contacts and fractures change |

mod connection;
mod contact;
mod event_rule;
mod mass;

pub use connection::{Beam, Bending, Bushing, CarryOver, Force, Joint, JointKind, OBLIQUE, RateFactor, Span};
pub use contact::{
    BodyContact, Contact, CrushedFace, Face, FaceRate, GROUND, GroundPlane, ObstacleBox, ObstaclePlane,
    PairRule, RESTITUTION, Shape,
};

pub use event_rule::{Broken, EventRule, Met, Range, Trigger};
pub use mass::{MassBlock, SharedMass};

use crate::curve::ResistanceCurve;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Version of the model file written by this program.
pub const MODEL_SCHEMA: &str = "fallwerk-mbs/2";

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
    /// Inertial coupling of bodies, as long as they move as parts of one elastic body.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shared_masses: Vec<SharedMass>,
    /// Resistance curves by id.
    #[serde(default)]
    pub curves: BTreeMap<String, ResistanceCurve>,
    /// Ideal joints between two bodies or between a body and the ground: no work, no compliance.
    #[serde(default)]
    pub joints: Vec<Joint>,
    /// Compliant connections between two bodies or between a body and the ground.
    #[serde(default)]
    pub bushings: Vec<Bushing>,
    /// Springs, dampers, hinges, applied forces and torques.
    #[serde(default)]
    pub forces: Vec<Force>,
    /// Contact with ground, obstacles and between bodies.
    #[serde(default)]
    pub contact: Contact,
    /// Events in time.
    #[serde(default)]
    pub events: Vec<Event>,
    /// What contacts and fractures change.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub event_rules: Vec<EventRule>,
    /// Points whose displacement is recorded.
    #[serde(default)]
    pub tracked: Vec<TrackedPoint>,
    /// Run settings.
    #[serde(default)]
    pub settings: RunSettings,
}

impl Model {
    /// Ids of the bushings and forces that are hinges on an ideal joint.
    pub fn hinges_on<'a>(&'a self, joint: &'a str) -> impl Iterator<Item = &'a str> {
        let bushings = self.bushings.iter().filter(move |b| b.joint.as_deref() == Some(joint));
        let forces = self.forces.iter().filter(move |f| f.joint() == Some(joint));
        bushings.map(|b| b.id.as_str()).chain(forces.map(Force::id))
    }

    /// Joints and bushings with the ground: id, body and point \[m\] of each.
    pub fn joined_to_ground(&self) -> impl Iterator<Item = (&str, &str, [f64; 3])> {
        let joints = self.joints.iter().map(|j| (&j.id, &j.body_a, &j.body_b, j.point_m));
        let bushings = self.bushings.iter().map(|j| (&j.id, &j.body_a, &j.body_b, j.point_m));
        joints.chain(bushings).filter_map(|(id, a, b, point_m)| match a {
            None => Some((id.as_str(), b.as_str(), point_m)),
            Some(a) if b == GROUND => Some((id.as_str(), a.as_str(), point_m)),
            Some(_) => None,
        })
    }

    /// Whether it has ideal joints or forces, with which it is one of smooth motion ([`crate::mbs::ideal`]).
    pub fn is_ideal(&self) -> bool {
        !self.joints.is_empty() || !self.forces.is_empty()
    }

    /// Whether nothing acts on its bodies but gravity and contact, in steps that nothing prescribes, and it asks for none of what the leapfrog of bushings has alone.
    pub fn is_unconnected(&self) -> bool {
        let s = &self.settings;
        let is_left_to_itself = s.time_step_s.is_none() && !s.preload && s.sleep_speed_m_s.is_none();
        let has_no_connection = !self.is_ideal() && self.bushings.is_empty() && self.shared_masses.is_empty();
        let is_hard = self.contact.crushing.is_empty() && !self.contact.resists_rolling();
        let is_soft = s.relative_inertia_rad_s.is_some() || s.soft_after_m.is_some();
        is_left_to_itself && has_no_connection && is_hard && !is_soft && self.event_rules.is_empty()
    }

    /// Whether its bodies may touch anything.
    pub fn may_touch(&self) -> bool {
        let Contact { ground, planes, obstacles, bodies, .. } = &self.contact;
        let surfaces = ground.is_some() || !planes.is_empty() || !obstacles.is_empty() || bodies.is_some();
        surfaces && self.bodies.iter().any(|b| !b.shapes.is_empty())
    }

    /// A model without parts, with default settings but for its end and its outputs \[m/s², s\].
    pub fn empty(name: &str, gravity_m_s2: [f64; 3], end_time_s: f64, output_interval_s: f64) -> Self {
        Self {
            schema: MODEL_SCHEMA.into(),
            name: name.into(),
            gravity_m_s2,
            bodies: Vec::new(),
            shared_masses: Vec::new(),
            curves: BTreeMap::new(),
            joints: Vec::new(),
            bushings: Vec::new(),
            forces: Vec::new(),
            contact: Contact::default(),
            events: Vec::new(),
            event_rules: Vec::new(),
            tracked: Vec::new(),
            settings: RunSettings { end_time_s, output_interval_s, ..RunSettings::default() },
        }
    }
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

/// Something that happens at a given time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Unique id (of the charge).
    pub id: String,
    /// Time \[s\].
    pub time_s: f64,
    /// Bodies that vanish with all that is attached to them.
    #[serde(default)]
    pub remove_bodies: Vec<String>,
    /// Joints, bushings and forces that vanish.
    #[serde(default)]
    pub release: Vec<String>,
    /// Bushings and hinges whose strength changes.
    #[serde(default)]
    pub weaken: Vec<Weakening>,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

impl Event {
    /// One in which nothing happens yet.
    pub fn at(id: impl Into<String>, time_s: f64) -> Self {
        Self {
            id: id.into(),
            time_s,
            remove_bodies: Vec::new(),
            release: Vec::new(),
            weaken: Vec::new(),
            origin: Origin::default(),
        }
    }
}

/// A change of strength.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weakening {
    /// Id of a bushing or of a hinge among the forces.
    pub id: String,
    /// Factor on its capacity from now on, above 0 and at most 1 (a second one counts on top).
    pub factor: f64,
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
    /// Time step \[s\]; `None`: chosen from the highest frequency of the model, or by `tolerance`.
    pub time_step_s: Option<f64>,
    /// Largest error of a step of smooth motion, as a share of each number and at least of 1 m, rad, m/s, rad/s. Models with ideal joints only.
    pub tolerance: f64,
    /// Whether reactions of ideal joints are recorded; steps end at outputs then.
    pub reactions: bool,
    /// Islands of bodies in contact fall asleep when the kinetic energy of each of their bodies has been below that at this speed for half a second, and
    /// wake when something touches them, with events and joints that separate \[m/s\]; `None`: nothing sleeps. Models without ideal joints and forces only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sleep_speed_m_s: Option<f64>,
    /// Frequency that inertia against relative motion keeps all others below until something touches or parts \[rad/s\]; `None`: there is none. Nor is there any where velocities at `t = 0` strain bushings. Models without ideal joints and forces only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub relative_inertia_rad_s: Option<f64>,
    /// Displacement of nine tenths of the mass from which springs along the axes of bushings are made softer where they are in the way of long steps, with their forces kept \[m\]; `None`: they never are. Models without ideal joints and forces only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub soft_after_m: Option<f64>,
}

/// The tolerance unless a model says otherwise.
pub const TOLERANCE: f64 = 1e-6;

impl Default for RunSettings {
    fn default() -> Self {
        Self {
            end_time_s: 1.0,
            output_interval_s: 0.01,
            preload: false,
            time_step_s: None,
            tolerance: TOLERANCE,
            reactions: false,
            sleep_speed_m_s: None,
            relative_inertia_rad_s: None,
            soft_after_m: None,
        }
    }
}
