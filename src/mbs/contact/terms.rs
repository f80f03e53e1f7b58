//! What goes into the contacts and comes out of them: bodies, partners, first contacts, energies, work done, settings.

use crate::mbs::math::{self, M3, Q, V3};
use crate::mbs::model::{GROUND, Model};

/// A body as the contacts see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moving {
    /// Centre of mass \[m\].
    pub x: V3,
    /// Orientation (body to global).
    pub q: Q,
    /// The same as a matrix.
    pub r: M3,
    /// In: velocity over the coming step without contact; out: with it \[m/s\].
    pub v: V3,
    /// Angular velocity, global frame, likewise \[rad/s\].
    pub w: V3,
    /// The share of `v` that forces add after the instant of contact (half a step of them in a leapfrog): `v - kick_v` is the velocity just before it.
    pub kick_v: V3,
    /// The same of `w`.
    pub kick_w: V3,
    /// `1/mass` \[1/kg\].
    pub inverse_mass: f64,
    /// Inverse inertia, global frame \[1/(kg m²)\].
    pub inverse_inertia: M3,
    /// Whether the body is still there.
    pub alive: bool,
    /// Out: displacement that opens gaps, to be added to that of the step \[m\].
    pub shift: V3,
    /// Out: the same as a rotation vector, global frame \[rad\].
    pub turn: V3,
}

impl Moving {
    /// By how much an arm is turned in the mean over a step of `h` \[s\], to third order \[m\].
    #[inline]
    pub fn mean_turn(&self, h: f64, arm: V3) -> V3 {
        let first = math::scale(0.5 * h, math::cross(self.w, arm));
        math::axpy(first, h / 3.0, math::cross(self.w, first))
    }
}

/// What a body met.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Partner {
    /// Another body.
    Body(usize),
    /// The ground plane.
    Ground,
    /// A plane by index.
    Plane(usize),
    /// An obstacle by index.
    Obstacle(usize),
}

impl Partner {
    /// Its id in a model.
    pub fn id(self, model: &Model) -> &str {
        match self {
            Self::Body(i) => &model.bodies[i].id,
            Self::Ground => GROUND,
            Self::Plane(i) => &model.contact.planes[i].id,
            Self::Obstacle(i) => &model.contact.obstacles[i].id,
        }
    }
}

/// A point with an impulse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Bodies; the ground is the number of bodies.
    pub bodies: [usize; 2],
    /// What the first one meets.
    pub partner: Partner,
    /// From the centres of mass \[m\].
    pub arms: [V3; 2],
    /// From the first body to the second.
    pub normal: V3,
}

/// First contact between two bodies, or of a body with something that does not move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// First body.
    pub a: usize,
    /// What it met.
    pub b: Partner,
    /// When, from the start of the step \[s\].
    pub after_s: f64,
}

/// Energies taken by contacts \[J\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactEnergy {
    /// Along the normals.
    pub normal_j: f64,
    /// By friction.
    pub friction_j: f64,
}

/// What the solver did so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Work {
    /// Steps with contact points.
    pub steps: u64,
    /// Sweeps in them.
    pub sweeps: u64,
    /// Points visited in these.
    pub visits: u64,
    /// Most points in a step.
    pub most_points: usize,
    /// Steps in which nothing could touch.
    pub quiet_steps: u64,
    /// Pairs looked at.
    pub looks: u64,
    /// Pairs left alone in all steps.
    pub left_alone: u64,
    /// Searches for the points of a pair.
    pub searches: u64,
    /// Steps with sweeps that ended before the tolerance was met.
    pub unfinished: u64,
    /// The last of them.
    pub last_unfinished: u64,
    /// Steps in which friction was left out where it jammed bodies on ideal joints.
    pub jammed: u64,
    /// Deepest penetration seen at the start of a step \[m\].
    pub deepest_m: f64,
}

/// How contacts are searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Whether pairs that cannot meet in a step are left alone, and steps in which none can. Without it every pair is looked at in every step.
    pub skip: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { skip: true }
    }
}

/// Two bodies are in each other further than they may.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TooDeep {
    /// First body.
    pub a: usize,
    /// What it is in.
    pub b: Partner,
    /// How far \[m\].
    pub depth_m: f64,
}
