//! Force and energy of a compliant joint.
//!
//! With the gap `d` and the rotation vector `θ` along its axes ([`super::stance`]) its energy is
//! `U = ½ Σ k_i d_i² + ½ Σ K_i (θ_i - θ_pi)²`. In compression
//! the axial spring may flow at a constant force (crushing); its work is booked by the trapezoidal rule like the hinge's.

mod law;
mod rows;
mod shear;

pub(super) use law::ElasticRange;
pub use rows::Row;
use shear::Shear;

use super::math::{self, Q, V3};
use super::mid_beam::MidBeam;
use super::model::{Bushing, RateFactor};
use super::stance::{Chord, Stance, bend, loads, stance, torque};
use super::system::BodyState;
use crate::curve::onset::Course;
use crate::curve::{CapacityTable, Hinge2, Rate};

/// Sine of the angle to a plane across axis 0 up to which a direction lies in it.
const ACROSS: f64 = 1e-9;
/// Marks an axis without a curve.
const NO_TABLE: u32 = u32::MAX;

/// The step to the next evaluation.
#[derive(Debug, Clone, Copy, Default)]
pub struct Stride {
    /// How long it is against the one before; zero: rates have jumped in between, or nothing is known.
    pub pace: f64,
    /// Its length \[s\]; zero: it is none in time.
    pub length_s: f64,
}

/// A compiled joint and its history.
#[derive(Debug, Clone)]
pub struct JointData {
    /// First body (the ground has the last index).
    pub a: usize,
    /// Second body.
    pub b: usize,
    /// Whether the joint is intact.
    pub alive: bool,
    /// The joint point in the frame of either body.
    pub(in crate::mbs) points: [V3; 2],
    /// The joint axes in the frame of either body.
    pub(in crate::mbs) frames: [Q; 2],
    /// Relative quaternion of the last evaluation: keeps the branch of the logarithm.
    pub(in crate::mbs) relative: Q,
    /// Translational stiffness along the joint axes \[N/m\].
    pub translation: V3,
    /// Rotational stiffness about the joint axes (elastic part) \[N m/rad\].
    pub rotation: V3,
    table: [u32; 2],
    /// 1 if axis 0 points from A's side to B's, else -1: a gap along it is then tension.
    pub(in crate::mbs) outward: f64,
    /// Share of its strength that events have left it.
    strength: f64,
    /// Tension at which the joint separates \[N\].
    pub tensile_capacity: f64,
    /// Plastic elongation at which it separates; zero: it separates at the tensile capacity \[m\].
    tensile_elongation: f64,
    /// Its shear springs along axes 1 and 2.
    pub(in crate::mbs) shear: Shear,
    /// Plastic elongation so far, and shortening at the compressive capacity \[m\].
    elongated: f64,
    pressed: f64,
    /// Such shortening at which it is crushed \[m\].
    crushing_shortening: f64,
    /// Compression at which the axial spring flows now, if the hinge has not turned \[N\].
    pub(in crate::mbs) compressive_capacity: f64,
    /// The same over plastic shortening \[m\] as it hardens; none: it does not.
    hardening: Option<Box<[[f64; 2]]>>,
    /// Share of it that is left over the plastic rotation of the hinge \[rad\], and now.
    fading: Option<Box<[[f64; 2]]>>,
    left: f64,
    /// Plastic shortening less elongation, in the sense of the gap along axis 0 \[m\].
    pub crushed: f64,
    /// Energy dissipated by crushing and stretching \[J\].
    pub crush_j: f64,
    /// Whether its hinge shortens it as it turns, and by how much it did in the last evaluation \[m\].
    is_associated: bool,
    shortened: f64,
    /// How its strength grows with the rate at which it flows, and for the elongation of the step to the next evaluation.
    rate_factor: Option<RateFactor>,
    rate: Option<Rate>,
    /// Lean: rotation carried over from the other end of its member ([`super::carry`]) \[rad\].
    pub(in crate::mbs) lean: [f64; 2],
    /// Hinge about the axes 1 and 2.
    pub hinge: Hinge2,
    /// Rotation vector in the joint frame \[rad\].
    pub theta: V3,
    /// Axial force of the last evaluation, compression positive \[N\].
    pub axial_force: f64,
    /// Elastic energy of the last evaluation \[J\].
    pub elastic_j: f64,
    /// Whether the hinge flowed in the last evaluation.
    pub flowing: bool,
    /// Whether an ideal joint holds its point: [`Self::axial_force`] is given from outside.
    pub(in crate::mbs) is_held: bool,
    /// Gap and rotation that it had when its bodies parted ([`Self::strain`]).
    strained: [V3; 2],
    /// Whether evaluations are a step apart.
    pub(in crate::mbs) pace: Pace,
    /// What force and moment along its axes have done in the last step beyond the mean of its start and end ([`crate::curve::onset`]) \[N, N m\], and their work in it \[J\].
    onset: [V3; 2],
    onset_j: f64,
    /// How its axial force (compression positive) went in the last step in which its axial spring flowed \[N, m\].
    pub(in crate::mbs) course: Course,
    /// The beam in whose middle it stands.
    pub(in crate::mbs) beam: Option<Box<MidBeam>>,
}

impl JointData {
    /// Compiles a joint between two bodies; it is stress-free in their poses, but for what gravity \[m/s²\] does to a beam.
    pub fn new(joint: &Bushing, [a, b]: [usize; 2], bodies: &[BodyState], gravity: V3) -> Self {
        let frame = math::mat_to_q(&math::transpose(&joint.axes));
        let local = |i: usize| {
            let body = &bodies[i];
            (math::mul_t(&body.r, math::sub(joint.point_m, body.x)), math::qmul(math::qconj(body.q), frame))
        };
        let ((point_a, frame_a), (point_b, frame_b)) = (local(a), local(b));
        let [s1, s2] = joint.shear_stiffness_n_m;
        let center_a = if a + 1 == bodies.len() { joint.point_m } else { bodies[a].x };
        let to_b = math::sub(bodies[b].x, center_a);
        // across axis 0 neither sense points to the other body: no rounding may choose one
        let outward = if math::dot(joint.axes[0], to_b) < -ACROSS * math::norm(to_b) { -1.0 } else { 1.0 };
        let compressive_most = joint.compressive_capacity_n.unwrap_or(f64::INFINITY);
        Self {
            a,
            b,
            alive: true,
            points: [point_a, point_b],
            frames: [frame_a, frame_b],
            relative: [1.0, 0.0, 0.0, 0.0],
            translation: [joint.axial_stiffness_n_m, s1, s2],
            rotation: [joint.torsional_stiffness_nm_rad, 0.0, 0.0],
            table: [NO_TABLE; 2],
            outward,
            strength: 1.0,
            tensile_capacity: joint.tensile_capacity_n.unwrap_or(f64::INFINITY),
            tensile_elongation: joint.tensile_elongation_m.unwrap_or(0.0),
            shear: Shear::new(joint.shear_capacity_n, joint.shear_slip_m),
            elongated: 0.0,
            pressed: 0.0,
            crushing_shortening: joint.crushing_shortening_m.unwrap_or(f64::INFINITY),
            compressive_capacity: compressive_most
                * joint.compressive_hardening.first().map_or(1.0, |p| p[1]),
            hardening: (!joint.compressive_hardening.is_empty()).then(|| {
                joint.compressive_hardening.iter().map(|[x, f]| [*x, f * compressive_most]).collect()
            }),
            fading: (!joint.compressive_fading.is_empty()).then(|| joint.compressive_fading.clone().into()),
            left: 1.0,
            crushed: 0.0,
            crush_j: 0.0,
            is_associated: joint.associated_flow,
            shortened: 0.0,
            rate_factor: joint.rate_factor,
            rate: None,
            lean: [0.0; 2],
            hinge: Hinge2::default(),
            theta: [0.0; 3],
            axial_force: 0.0,
            elastic_j: 0.0,
            flowing: false,
            is_held: joint.joint.is_some(),
            strained: [[0.0; 3]; 2],
            pace: Pace::First,
            onset: [[0.0; 3]; 2],
            onset_j: 0.0,
            course: Course::default(),
            beam: MidBeam::of(joint, outward, gravity),
        }
    }

    /// Tells its laws how long the step to the next evaluation is.
    #[inline]
    pub(in crate::mbs) fn expect(&mut self, stride: Stride) {
        self.hinge.pace = stride.pace;
        let Some(factor) = self.rate_factor.filter(|_| stride.length_s > 0.0) else { return };
        let rate = |c: f64| Rate { doubled: c * stride.length_s, exponent: factor.exponent };
        self.rate = factor.elongation_m_s.map(rate);
        match &mut self.beam {
            Some(beam) => beam.ends.rate = Some(rate(factor.rotation_rad_s[beam.axis - 1])),
            None => self.hinge.rates = Some(factor.rotation_rad_s.map(rate)),
        }
    }

    /// Whether its strength grows with the rate at which it flows.
    pub(in crate::mbs) fn is_rated(&self) -> bool {
        self.rate_factor.is_some()
    }

    /// Makes bending axis `k` (0 or 1) linear elastic.
    pub fn set_elastic(&mut self, k: usize, stiffness_nm_rad: f64) {
        self.rotation[k + 1] = stiffness_nm_rad;
        self.table[k] = NO_TABLE;
    }

    /// Gives bending axis `k` (0 or 1) a capacity.
    pub fn set_curve(&mut self, k: usize, table: u32, tables: &[CapacityTable]) {
        self.rotation[k + 1] = tables[table as usize].stiffness_nm_rad();
        self.table[k] = table;
    }

    /// Multiplies its capacities in tension, compression and shear so that this share of what they are in the file is left; its curves are given by [`Self::set_curve`].
    pub fn set_strength(&mut self, share: f64) {
        let ratio = share / std::mem::replace(&mut self.strength, share);
        self.tensile_capacity *= ratio;
        self.compressive_capacity *= ratio;
        self.hardening.iter_mut().flat_map(|h| h.iter_mut()).for_each(|[_, force]| *force *= ratio);
        self.shear.strengthen(ratio);
    }

    /// Its hinges: accumulated plastic rotation \[rad\], and whether it broke; both ends of a beam, else its own first.
    pub(in crate::mbs) fn flowed(&self) -> [(f64, bool); 2] {
        match &self.beam {
            Some(beam) => beam.ends.ends.map(|e| (e.alpha_rad, e.damage >= 1.0)),
            None => [(self.hinge.alpha_rad, self.hinge.fractured), (0.0, false)],
        }
    }

    /// Takes the joint away; returns the elastic energy that it had \[J\].
    pub fn open(&mut self) -> f64 {
        (self.alive, self.flowing) = (false, false);
        self.hinge.dissipated_j += 0.5 * std::mem::take(&mut self.onset_j);
        self.onset = [[0.0; 3]; 2];
        std::mem::take(&mut self.elastic_j)
    }

    /// Whether tension has separated the joint.
    pub fn is_pulled_apart(&self) -> bool {
        if self.tensile_elongation > 0.0 {
            self.elongated >= self.tensile_elongation
        } else {
            -self.axial_force > self.tensile_capacity
        }
    }

    /// Whether compression has crushed the joint.
    pub fn is_crushed(&self) -> bool {
        self.pressed >= self.crushing_shortening
    }

    /// Whether shear has separated the joint.
    pub fn is_sheared_off(&self) -> bool {
        self.shear.is_off()
    }

    /// Whether its axial spring is at its capacity.
    pub(in crate::mbs) fn is_stretching(&self) -> bool {
        let is_at_most = self.tensile_elongation > 0.0 && -self.axial_force >= self.tensile_capacity;
        is_at_most || self.axial_force >= self.left * self.compressive_capacity
    }

    /// How much farther it was stretched or crushed than it bears \[m\].
    pub(in crate::mbs) fn overrun_m(&self) -> f64 {
        if self.is_crushed() {
            self.pressed - self.crushing_shortening
        } else if self.tensile_elongation > 0.0 {
            (self.elongated - self.tensile_elongation).max(0.0)
        } else {
            0.0
        }
    }

    /// Whether it separates now.
    pub fn breaks(&self) -> bool {
        self.alive
            && (self.hinge.fractured || self.is_pulled_apart() || self.is_crushed() || self.is_sheared_off())
    }

    /// Whether any axis has a curve.
    pub fn has_curve(&self) -> bool {
        self.table != [NO_TABLE; 2]
    }

    /// Adds the joint's forces to its two bodies and advances its history.
    #[inline]
    pub fn apply(&mut self, bodies: &mut [BodyState], tables: &[CapacityTable]) {
        let at = self.stance(bodies);
        let (theta, c) = bend(at.turn);
        let chord = self.chord(&at);
        let [local, moment] = self.resist(&at, &chord, theta, tables);
        let [force, on_a, on_b] = loads(&at.frame, at.arms, theta, chord.force(local), moment, c);
        let a = &mut bodies[self.a];
        a.force = math::add(a.force, force);
        a.torque = math::add(a.torque, on_a);
        let b = &mut bodies[self.b];
        b.force = math::sub(b.force, force);
        b.torque = math::sub(b.torque, on_b);
    }

    /// Adds elastic moments about its bending axes \[N m\] to those of the last evaluation, which was in the present poses, and to its bodies.
    #[inline]
    pub(in crate::mbs) fn bend_more(&mut self, more: [f64; 2], bodies: &mut [BodyState]) {
        for k in (0..2).filter(|k| more[*k] != 0.0) {
            let before = self.hinge.moment_nm[k];
            self.elastic_j += (before + 0.5 * more[k]) * more[k] / self.rotation[k + 1];
            self.hinge.moment_nm[k] += more[k];
        }
        let frame = math::qmat(math::qmul(bodies[self.b].q, self.frames[1]));
        let (theta, c) = bend(self.relative);
        let torque = torque(&frame, theta, [0.0, more[0], more[1]], c);
        bodies[self.a].torque = math::add(bodies[self.a].torque, torque);
        bodies[self.b].torque = math::sub(bodies[self.b].torque, torque);
    }

    /// What of its force only a step asks for that has been gone through to its end ([`crate::curve::onset`]), taken back out of its energies: force and torques as of [`Self::pull`].
    pub(in crate::mbs) fn take_back_onset(&mut self, bodies: &[BodyState]) -> [V3; 3] {
        let at = self.stance(bodies);
        let (theta, c) = bend(at.turn);
        let [local, moment] = std::mem::take(&mut self.onset);
        self.hinge.dissipated_j -= 0.5 * std::mem::take(&mut self.onset_j);
        loads(&at.frame, at.arms, theta, self.chord(&at).force(local), moment, c)
    }

    /// The share of the last step after which a hinge of [`Self::flowed`] began to flow; 1 where that is not known.
    pub(in crate::mbs) fn begins_at(&self, hinge: usize) -> f64 {
        let from = match &self.beam {
            Some(beam) => beam.ends.ends[hinge].course.after_flow(0.0),
            None => self.hinge.begins,
        };
        if from > 0.0 { from } else { 1.0 }
    }

    /// Takes back the rotation with which its hinges have flowed after a share of the last step.
    pub(in crate::mbs) fn take_back_flow(&mut self, share: f64) {
        match &mut self.beam {
            Some(beam) => beam.ends.take_back(share),
            None => self.hinge.take_back(share),
        }
    }

    /// The share of the last step after which it broke by rotation; 1 if it did not.
    pub(in crate::mbs) fn broke_at(&self) -> f64 {
        self.beam.as_ref().map_or_else(|| self.hinge.broke_at(), |beam| beam.ends.broke_at())
    }

    /// Force on the first body and torques about the centres of mass of both \[N, N m\] (the second one feels the opposite), as of the last evaluation, which was in the present poses.
    pub fn pull(&self, bodies: &[BodyState]) -> [V3; 3] {
        let at = self.stance(bodies);
        let (theta, c) = bend(at.turn);
        let k = self.translation;
        let (mut gap, chord) = (at.gap, self.chord(&at));
        gap[0] = chord.stretch - self.crushed;
        if let Some(beam) = &self.beam {
            gap[beam.across()] -= beam.plastic()[1];
        }
        let [s1, s2] = self.shear.slid;
        let local = [k[0] * gap[0], k[1] * (gap[1] - s1), k[2] * (gap[2] - s2)];
        let [m1, m2] = self.hinge.moment_nm;
        loads(&at.frame, at.arms, theta, chord.force(local), [self.rotation[0] * theta[0], m1, m2], c)
    }

    /// Where its axial force acts.
    #[inline]
    pub(in crate::mbs) fn chord(&self, at: &Stance) -> Chord {
        match &self.beam {
            Some(beam) => Chord::new(at.gap, at.turn, beam.reach_m, beam.free_m),
            None => Chord::along_axis(at.gap),
        }
    }

    pub(in crate::mbs) fn stance(&self, bodies: &[BodyState]) -> Stance {
        let (a, b) = (&bodies[self.a], &bodies[self.b]);
        stance([(a.x, a.q, &a.r), (b.x, b.q, &b.r)], self.points, self.frames, self.relative)
    }

    /// Moves its points and axes in its bodies so that poses that were free of stress strain it by a gap \[m\] and a rotation \[rad\] along its axes.
    pub fn strain(&mut self, gap: V3, theta: V3) {
        self.strained = [[0.0; 3], theta];
        self.relative = math::qexp(theta);
        self.frames[1] = math::qmul(self.frames[1], self.relative);
        self.stretch(gap);
    }

    /// Moves its point in the second body so that it has a gap \[m\] along its axes more.
    fn stretch(&mut self, gap: V3) {
        self.strained[0] = math::add(self.strained[0], gap);
        self.points[1] = math::add(self.points[1], math::mul(&math::qmat(self.frames[1]), gap));
    }

    /// Takes smaller stiffnesses along its axes \[N/m\] and keeps its forces; returns by how much its elastic energy grows \[J\].
    pub(in crate::mbs) fn soften(&mut self, translation: V3, bodies: &[BodyState]) -> f64 {
        let at = self.stance(bodies);
        let mut stretch = at.gap;
        stretch[0] = self.chord(&at).stretch - self.crushed;
        stretch = math::sub(stretch, [0.0, self.shear.slid[0], self.shear.slid[1]]);
        let ratio = |k: usize| if translation[k] > 0.0 { self.translation[k] / translation[k] } else { 1.0 };
        let more: V3 = std::array::from_fn(|k| (ratio(k) - 1.0) * stretch[k]);
        let energy_j: f64 = (0..3).map(|k| 0.5 * self.translation[k] * stretch[k] * more[k]).sum();
        self.elastic_j += energy_j;
        match &mut self.beam {
            // only the spring along it is made softer
            Some(beam) => beam.free_m -= self.outward * more[0],
            None => self.stretch(more),
        }
        self.translation = translation;
        energy_j
    }

    /// Takes over the history of a joint between the same points of other bodies.
    pub fn adopt(&mut self, old: &Self) {
        let (a, b, points, frames) = (self.a, self.b, self.points, self.frames);
        *self = Self { a, b, points, frames, ..old.clone() };
        if old.strained != [[0.0; 3]; 2] {
            self.strain(old.strained[0], old.strained[1]);
            self.relative = old.relative;
        }
    }

    /// The table of a bending axis (0 or 1); none if it is elastic.
    pub fn table_of(&self, k: usize) -> Option<usize> {
        (self.table[k] != NO_TABLE).then_some(self.table[k] as usize)
    }

    /// Share of the capacity of the virgin joint that a force \[N\] and a moment \[N m\] along its axes take: the largest of bending, shear, tension and compression.
    pub fn share_used(&self, force: V3, moment: V3, tables: &[CapacityTable]) -> f64 {
        let axial = -self.outward * force[0];
        let mut bending = 0.0;
        for k in 0..2 {
            if let Some(table) = self.table_of(k) {
                let capacity = tables[table].capacity(0.0, axial, &mut Default::default()).moment_nm;
                bending += (moment[k + 1] / capacity).powi(2);
            }
        }
        let shear2 = self.shear_used2(force);
        bending.max(shear2).sqrt().max(axial / self.compressive_capacity).max(-axial / self.tensile_capacity)
    }

    /// What its last evaluation found, as [`Self::pull`] finds it in the same poses.
    pub(in crate::mbs) fn latest(&self) -> Latest {
        let [m1, m2] = self.hinge.moment_nm;
        let ([v1, v2], [s1, s2]) = (self.shear.force, self.shear.slid);
        let along = [-self.outward * self.axial_force, v1, v2];
        let ([local, couple], gap) = match &self.beam {
            Some(beam) => (beam.chord.force(along), beam.gap),
            None => {
                let stretch = |k: usize| if along[k] == 0.0 { 0.0 } else { along[k] / self.translation[k] };
                ([along, [0.0; 3]], [self.crushed + stretch(0), s1 + stretch(1), s2 + stretch(2)])
            }
        };
        let moment = [self.rotation[0] * self.theta[0], m1, m2];
        Latest { along, local, couple, moment, theta: self.theta, gap }
    }

    /// Square of the share of the capacity that a force \[N\] along its axes takes in shear.
    pub(in crate::mbs) fn shear_used2(&self, force: V3) -> f64 {
        let across = [force[1], force[2]];
        self.shear.product(across, across)
    }

    /// Whether it resists turns, and has turned by more than [`MOST_TURN_RAD`].
    pub(in crate::mbs) fn has_overturned(&self) -> bool {
        let resists = self.rotation.iter().any(|k| *k > 0.0);
        resists && math::dot(self.theta, self.theta) > MOST_TURN_RAD * MOST_TURN_RAD
    }
}

/// Length of the rotation vector from which a run warns: at a full revolution it turns round, and moments and plastic rotations are wrong from there \[rad\].
pub(in crate::mbs) const MOST_TURN_RAD: f64 = 5.0;

/// Which evaluations follow each other in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::mbs) enum Pace {
    /// None: those of a search, or of an integrator that follows the flow itself.
    Free,
    /// The next one is the first.
    First,
    /// Each is a step after the last one.
    Steps,
}

/// What the last evaluation of a joint found, along its axes.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::mbs) struct Latest {
    /// Forces of its springs \[N\]: of a beam the first one is not along axis 0.
    pub along: V3,
    /// Force on the first body \[N\].
    pub local: V3,
    /// Couple of the axial force about the joint point of the second body \[N m\].
    pub couple: V3,
    /// Moment on it \[N m\].
    pub moment: V3,
    /// Rotation vector \[rad\].
    pub theta: V3,
    /// Its gap \[m\].
    pub gap: V3,
}
