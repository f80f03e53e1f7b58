//! What a run returns: histories, frames, energies, events.

use super::contact::Work;
use super::math;
use super::model::{Face, Model, Shape};
use serde::{Deserialize, Serialize};

/// Version of the result file.
pub const RESULT_SCHEMA: &str = "fallwerk-mbs-result/1";

/// Result of a run. All histories have one entry per element of [`RunResult::times_s`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunResult {
    /// Always [`RESULT_SCHEMA`].
    pub schema: String,
    /// Name of the scene.
    pub name: String,
    /// Output times \[s\].
    pub times_s: Vec<f64>,
    /// Displacements of the tracked points from the state at `t = 0` (after the preload).
    pub tracked: Vec<TrackedHistory>,
    /// Ids of the bodies in the order of the frames.
    pub bodies: Vec<String>,
    /// Poses of all bodies, one frame per output time. A removed body keeps its last pose.
    pub frames: Vec<Frame>,
    /// Energy balance.
    pub energies: EnergyHistory,
    /// Histories of the joints that have a curve.
    pub hinges: Vec<HingeHistory>,
    /// Bushings that were latent at the start.
    #[serde(default)]
    pub latent: Vec<LatentRecord>,
    /// Faces that may be crushed.
    #[serde(default)]
    pub crushed: Vec<CrushedHistory>,
    /// Histories of the hinges and torsion springs among the forces.
    #[serde(default)]
    pub turns: Vec<TurnHistory>,
    /// Reactions of the ideal joints.
    #[serde(default)]
    pub reactions: Vec<ReactionHistory>,
    /// What happened, in order of time.
    pub events: Vec<RunEvent>,
    /// Time of the first contact of a body with the ground \[s\], but for points that stand on it at the start and are joined to it.
    pub first_ground_contact_s: Option<f64>,
    /// Number of steps.
    pub steps: usize,
    /// Largest step \[s\].
    pub time_step_s: f64,
    /// Highest angular frequency of the model, with margin \[rad/s\]; the stability limit is `2/ω`.
    pub highest_frequency_rad_s: f64,
    /// Newton iterations of the preload.
    pub preload_iterations: Option<usize>,
    /// Processor time of set-up, preload and run \[s\].
    pub cpu_s: f64,
    /// Largest error of the energy balance relative to the energy turned over.
    pub energy_error: f64,
    /// By how much the sum of all energies grows at most relative to the energy turned over, but for what forces add to the kinetic energy in half a step: that part of it rises and falls with every vibration, and what is left is what a leapfrog conserves.
    #[serde(default)]
    pub energy_growth: f64,
    /// Work of contacts done and left out.
    #[serde(default)]
    pub contact_work: ContactWork,
    /// Work of bodies and latent bushings done and left out; not in result files.
    #[serde(skip)]
    pub body_work: BodyWork,
    /// Remarks, such as an axial force outside the levels of a curve.
    pub warnings: Vec<String>,
}

impl RunResult {
    /// Of a model before its first output, without histories but those of its tracked points; room for so many outputs.
    pub(super) fn empty(model: &Model, outputs: usize) -> Self {
        let tracked = model.tracked.iter().map(|point| TrackedHistory {
            id: point.id.clone(),
            origin_m: point.point_m,
            displacement_m: Vec::with_capacity(outputs),
        });
        Self {
            schema: RESULT_SCHEMA.into(),
            name: model.name.clone(),
            times_s: Vec::new(),
            tracked: tracked.collect(),
            bodies: model.bodies.iter().map(|b| b.id.clone()).collect(),
            frames: Vec::with_capacity(outputs),
            energies: Default::default(),
            hinges: Vec::new(),
            latent: Vec::new(),
            crushed: Vec::new(),
            turns: Vec::new(),
            reactions: Vec::new(),
            events: Vec::new(),
            first_ground_contact_s: None,
            steps: 0,
            time_step_s: 0.0,
            highest_frequency_rad_s: 0.0,
            preload_iterations: None,
            cpu_s: 0.0,
            energy_error: 0.0,
            energy_growth: 0.0,
            contact_work: Default::default(),
            body_work: Default::default(),
            warnings: Vec::new(),
        }
    }
}

/// Displacement history of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrackedHistory {
    /// Id of the point.
    pub id: String,
    /// Position at `t = 0` \[m\].
    pub origin_m: [f64; 3],
    /// Displacement from there \[m\].
    pub displacement_m: Vec<[f64; 3]>,
}

/// Poses at one time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Centres of mass \[m\].
    pub position_m: Vec<[f64; 3]>,
    /// Quaternions `[w, x, y, z]`.
    pub orientation: Vec<[f64; 4]>,
}

/// Terms of the energy balance \[J\]. Their sum is constant but for the error of the integration.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyHistory {
    /// Kinetic energy.
    pub kinetic_j: Vec<f64>,
    /// Potential energy of gravity of the present bodies, relative to `t = 0`; and of what spans of beams sag by themselves, relative to the model before the preload.
    pub gravity_j: Vec<f64>,
    /// Elastic energy of the joints.
    pub joints_elastic_j: Vec<f64>,
    /// Dissipated in the joints: plastic rotation and crushing.
    pub plastic_j: Vec<f64>,
    /// Stored in contacts.
    pub contact_elastic_j: Vec<f64>,
    /// Dissipated in contacts along the normal, exchange of contact points included.
    pub contact_damping_j: Vec<f64>,
    /// Dissipated by friction.
    pub friction_j: Vec<f64>,
    /// Released by fracture of joints and removal of bodies, less the elastic energy that latent bushings go live with: rigid pieces have stored none.
    pub released_j: Vec<f64>,
    /// Taken by dampers, less the work of applied forces and torques.
    #[serde(default)]
    pub applied_j: Vec<f64>,
}

impl EnergyHistory {
    /// Adds an output.
    pub(super) fn push(&mut self, e: &Energies) {
        self.kinetic_j.push(e.kinetic_j);
        self.gravity_j.push(e.gravity_j);
        self.joints_elastic_j.push(e.joints_elastic_j);
        self.plastic_j.push(e.plastic_j);
        self.contact_elastic_j.push(0.0);
        self.contact_damping_j.push(e.contact_damping_j);
        self.friction_j.push(e.friction_j);
        self.released_j.push(e.released_j);
        self.applied_j.push(e.applied_j);
    }

    /// The sum of all terms at an output \[J\].
    pub fn total_j(&self, i: usize) -> f64 {
        self.at(i).total_j() + self.contact_elastic_j[i]
    }

    /// The energies at an output.
    fn at(&self, i: usize) -> Energies {
        Energies {
            kinetic_j: self.kinetic_j[i],
            gravity_j: self.gravity_j[i],
            joints_elastic_j: self.joints_elastic_j[i],
            plastic_j: self.plastic_j[i],
            contact_damping_j: self.contact_damping_j[i],
            friction_j: self.friction_j[i],
            released_j: self.released_j[i],
            applied_j: self.applied_j.get(i).copied().unwrap_or(0.0),
        }
    }
}

/// The energies of [`EnergyHistory`] at one time \[J\]; contacts store none.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Energies {
    pub kinetic_j: f64,
    pub gravity_j: f64,
    pub joints_elastic_j: f64,
    pub plastic_j: f64,
    pub contact_damping_j: f64,
    pub friction_j: f64,
    pub released_j: f64,
    pub applied_j: f64,
}

impl Energies {
    /// Their sum \[J\].
    pub fn total_j(&self) -> f64 {
        self.kinetic_j
            + self.gravity_j
            + self.joints_elastic_j
            + self.plastic_j
            + self.contact_damping_j
            + self.friction_j
            + self.released_j
            + self.applied_j
    }
}

/// History of a face that may be crushed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CrushedHistory {
    /// Id of the body.
    pub body: String,
    /// Which of its shapes.
    pub shape: usize,
    /// Which face.
    pub face: Face,
    /// By how much the box is shorter there \[m\].
    pub depth_m: Vec<f64>,
    /// Work that it took \[J\], part of [`EnergyHistory::contact_damping_j`].
    pub energy_j: Vec<f64>,
}

impl CrushedHistory {
    /// Makes its box as short as it is at an output; other shapes stay as they are.
    pub fn shorten(&self, shape: &mut Shape, output: usize) {
        let depth = self.depth_m.get(output).copied().unwrap_or(0.0);
        if let Shape::Box { center_m, half_extents_m, orientation } = shape {
            let (axis, sign) = self.face.axis();
            let mut shift = [0.0; 3];
            shift[axis] = -0.5 * sign * depth;
            half_extents_m[axis] -= 0.5 * depth;
            let turned = orientation.map_or(shift, |q| math::mul(&math::qmat(q), shift));
            *center_m = math::add(*center_m, turned);
        }
    }
}

/// Work of contacts done and left out. What is left out cannot change the result ([`crate::mbs::contact::Settings::skip`]).
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactWork {
    /// Steps with points that may touch.
    pub contact_steps: u64,
    /// Steps in which a bound of the paths of all bodies told that nothing could touch.
    pub quiet_steps: u64,
    /// Pairs of solids looked at in the steps between.
    pub pairs_looked_at: u64,
    /// Pairs left alone in all steps, as their bodies had not travelled their distance.
    pub pairs_left_alone: u64,
    /// Visits of contact points.
    pub point_visits: u64,
}

impl ContactWork {
    /// In words, for the end of a run of so many steps; nothing if no pair was known.
    pub fn words(&self, steps: usize) -> Option<String> {
        let pairs = self.pairs_looked_at + self.pairs_left_alone;
        (pairs > 0).then(|| {
            format!(
                "contact: no search in {:.1} % of the steps, {:.1} % of the pairs left alone (--compute-all looks at all, with the same result)",
                100.0 * self.quiet_steps as f64 / steps.max(1) as f64,
                100.0 * self.pairs_left_alone as f64 / pairs as f64,
            )
        })
    }
}

/// Work of bodies and latent bushings done and left out, summed over the steps.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BodyWork {
    /// Bodies of the model file that had not vanished.
    pub body_steps: u64,
    /// Those of them that moved as a part of another one, since latent bushings held them together.
    pub held_steps: u64,
    /// Bodies that slept.
    pub asleep_steps: u64,
    /// Bushings that were latent.
    pub latent_steps: u64,
    /// Those of them whose forces nobody asked for, as no rule about events had fired for them.
    pub unwatched_steps: u64,
    /// Looks at single latent bushings, up to two a step for those that a rule has asked for.
    pub looks: u64,
    /// Looks left out, as a bound of the loads told that the bushing bears less than its resistance and than it has borne.
    pub bounded_looks: u64,
}

impl From<Work> for ContactWork {
    fn from(work: Work) -> Self {
        Self {
            contact_steps: work.steps,
            quiet_steps: work.quiet_steps,
            pairs_looked_at: work.looks,
            pairs_left_alone: work.left_alone,
            point_visits: work.visits,
        }
    }
}

/// What became of a latent bushing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LatentRecord {
    /// Id of the bushing.
    pub joint: String,
    /// Largest share of its resistance that it bore while it was latent.
    pub largest_share: f64,
    /// When it went live \[s\]; none: it stayed latent.
    pub live_s: Option<f64>,
}

/// History of a hinge, about the bending axes 1 and 2 of its joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HingeHistory {
    /// Id of the joint.
    pub joint: String,
    /// Rotation \[rad\].
    pub rotation_rad: Vec<[f64; 2]>,
    /// Moment \[N m\].
    pub moment_nm: Vec<[f64; 2]>,
    /// Accumulated plastic rotation \[rad\].
    pub plastic_rotation_rad: Vec<f64>,
    /// Axial force, compression positive \[N\].
    pub axial_force_n: Vec<f64>,
}

/// History of a hinge about three axes of its first body, or of a torsion spring about its own (the first number). After its end all is zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TurnHistory {
    /// Id of the hinge.
    pub id: String,
    /// Rotations \[rad\].
    pub rotation_rad: Vec<[f64; 3]>,
    /// Moments that the second body exerts on the first \[N m\].
    pub moment_nm: Vec<[f64; 3]>,
    /// Plastic rotations \[rad\].
    pub plastic_rotation_rad: Vec<[f64; 3]>,
}

/// History of what an ideal joint does to its second body, at its point, in the global frame. After its end all is zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReactionHistory {
    /// Id of the joint.
    pub joint: String,
    /// Force \[N\].
    pub force_n: Vec<[f64; 3]>,
    /// Torque \[N m\].
    pub torque_nm: Vec<[f64; 3]>,
}

/// Something that happened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RunEvent {
    /// When \[s\].
    pub time_s: f64,
    /// What.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// Kinds of events.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum EventKind {
    /// A hinge flows for the first time.
    Yield {
        /// Id of the joint.
        joint: String,
    },
    /// A joint separates.
    Fracture {
        /// Id of the joint.
        joint: String,
        /// Why.
        cause: FractureCause,
    },
    /// Two bodies, or a body and the ground (`"ground"`) or an obstacle, meet for the first time.
    Contact {
        /// First body.
        a: String,
        /// What it met.
        b: String,
    },
    /// A latent bushing goes live: a body parts there.
    Live {
        /// Id of the bushing.
        joint: String,
        /// The latent bushing that had reached its resistance, which took this one along; left out: itself.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        with: Option<String>,
    },
    /// A rule about contacts or fractures has latent bushings watched.
    Rule {
        /// Id of the rule in the model.
        rule: String,
        /// The body that it happened to.
        body: String,
        /// What it met, or the bushing that broke.
        with: String,
        /// How fast they approached each other, if they met \[m/s\].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        approach_speed_m_s: Option<f64>,
        /// The latent bushings that may give way from now on.
        watched: Vec<String>,
    },
    /// An event of the model was carried out: bodies vanish, connections are released or weakened.
    Removal {
        /// Id of the event in the model.
        event: String,
    },
}

/// Why a joint separated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FractureCause {
    /// The plastic rotation passed the fracture rotation of the curve.
    Rotation,
    /// The axial force passed the tensile capacity.
    Tension,
    /// It was shortened at its compressive capacity by as much as it bears.
    Compression,
    /// The shear force passed the shear capacity.
    Shear,
}
