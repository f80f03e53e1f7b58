//! Force and energy of a compliant joint.
//!
//! With the gap `d` and the rotation vector `θ` along its axes ([`super::stance`]) its energy is
//! `U = ½ Σ k_i d_i² + ½ Σ K_i (θ_i - θ_pi)²`. In compression
//! the axial spring may flow at a constant force (crushing); its work is booked by the trapezoidal rule like the hinge's.

use super::math::{self, M3, Q, V3};
use super::mid_beam::MidBeam;
use super::model::Bushing;
use super::stance::{Chord, Stance, bend, loads, stance, torque};
use super::system::BodyState;
use crate::base::piecewise::interpolate;
use crate::curve::hinge::AxisLaw;
use crate::curve::onset::onset;
use crate::curve::{CapacityTable, Hinge2};

/// Sine of the angle to a plane across axis 0 up to which a direction lies in it.
const ACROSS: f64 = 1e-9;
/// Marks an axis without a curve.
const NO_TABLE: u32 = u32::MAX;

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
    pub(super) points: [V3; 2],
    /// The joint axes in the frame of either body.
    pub(super) frames: [Q; 2],
    /// Relative quaternion of the last evaluation: keeps the branch of the logarithm.
    pub(super) relative: Q,
    /// Translational stiffness along the joint axes \[N/m\].
    pub translation: V3,
    /// Rotational stiffness about the joint axes (elastic part) \[N m/rad\].
    pub rotation: V3,
    table: [u32; 2],
    /// 1 if axis 0 points from A's side to B's, else -1: a gap along it is then tension.
    pub(super) outward: f64,
    /// Share of its strength that events have left it.
    strength: f64,
    /// Tension at which the joint separates \[N\].
    pub tensile_capacity: f64,
    /// Plastic elongation at which it separates; zero: it separates at the tensile capacity \[m\].
    tensile_elongation: f64,
    /// `1/C²` of the shear forces along axes 1 and 2 at which it separates \[1/N²\], and the square of the share of that of the last evaluation.
    pub(super) shear_ease: [f64; 2],
    sheared2: f64,
    /// Forces along axes 1 and 2 of the last evaluation \[N\].
    pub(super) shear: [f64; 2],
    /// Plastic elongation so far, and shortening at the compressive capacity \[m\].
    elongated: f64,
    pressed: f64,
    /// Such shortening at which it is crushed \[m\].
    crushing_shortening: f64,
    /// Compression at which the axial spring flows now, if the hinge has not turned \[N\].
    pub(super) compressive_capacity: f64,
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
    /// What the other end of its member turns it by ([`super::carry`]) \[rad\].
    pub(super) lean: [f64; 2],
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
    pub(super) is_held: bool,
    /// Gap and rotation that it had when its bodies parted ([`Self::strain`]).
    strained: [V3; 2],
    /// Whether evaluations are a step apart.
    pub(super) pace: Pace,
    /// What force and moment along its axes have done in the last step beyond the mean of its begin and end ([`crate::curve::onset`]) \[N, N m\], and their work in it \[J\].
    onset: [V3; 2],
    onset_j: f64,
    /// The beam in whose middle it stands.
    pub(super) beam: Option<Box<MidBeam>>,
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
            shear_ease: joint.shear_capacity_n.map_or([0.0; 2], |c| c.map(|c| 1.0 / (c * c))),
            sheared2: 0.0,
            shear: [0.0; 2],
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
            beam: MidBeam::of(joint, outward, gravity),
        }
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
        self.shear_ease = self.shear_ease.map(|ease| ease / (ratio * ratio));
    }

    /// Its hinges: accumulated plastic rotation \[rad\], and whether it broke; both ends of a beam, else its own first.
    pub(super) fn flowed(&self) -> [(f64, bool); 2] {
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

    /// Whether a shear force has separated the joint.
    pub fn is_sheared_off(&self) -> bool {
        self.sheared2 >= 1.0
    }

    /// Whether its axial spring is at its capacity.
    pub(super) fn is_stretching(&self) -> bool {
        let is_at_most = self.tensile_elongation > 0.0 && -self.axial_force >= self.tensile_capacity;
        is_at_most || self.axial_force >= self.left * self.compressive_capacity
    }

    /// How much farther it was stretched or crushed than it bears \[m\].
    pub(super) fn overrun_m(&self) -> f64 {
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
    pub(super) fn bend_more(&mut self, more: [f64; 2], bodies: &mut [BodyState]) {
        for k in (0..2).filter(|k| more[*k] != 0.0) {
            let before = self.hinge.moment_nm[k];
            self.elastic_j += (before + 0.5 * more[k]) * more[k] / self.rotation[k + 1];
            self.hinge.moment_nm[k] += more[k];
        }
        let frame = math::qmat(math::qmul(bodies[self.a].q, self.frames[0]));
        let (theta, c) = bend(self.relative);
        let torque = torque(&frame, theta, [0.0, more[0], more[1]], c);
        bodies[self.a].torque = math::add(bodies[self.a].torque, torque);
        bodies[self.b].torque = math::sub(bodies[self.b].torque, torque);
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
        let local = [k[0] * gap[0], k[1] * gap[1], k[2] * gap[2]];
        let [m1, m2] = self.hinge.moment_nm;
        loads(&at.frame, at.arms, theta, chord.force(local), [self.rotation[0] * theta[0], m1, m2], c)
    }

    /// Where its axial force acts.
    #[inline]
    pub(super) fn chord(&self, at: &Stance) -> Chord {
        match &self.beam {
            Some(beam) => Chord::new(at.gap, at.turn, beam.reach_m, beam.free_m),
            None => Chord::along_axis(at.gap),
        }
    }

    pub(super) fn stance(&self, bodies: &[BodyState]) -> Stance {
        let (a, b) = (&bodies[self.a], &bodies[self.b]);
        stance([(a.x, a.q, &a.r), (b.x, b.q, &b.r)], self.points, self.frames, self.relative)
    }

    /// Moves its points and axes in its bodies so that poses that were free of stress strain it by a gap \[m\] and a rotation \[rad\] along its axes.
    pub fn strain(&mut self, gap: V3, theta: V3) {
        self.strained = [[0.0; 3], theta];
        self.stretch(gap);
        self.relative = math::qexp(theta);
        self.frames[1] = math::qmul(self.frames[1], self.relative);
    }

    /// Moves its point in the first body so that it has a gap \[m\] along its axes more.
    fn stretch(&mut self, gap: V3) {
        self.strained[0] = math::add(self.strained[0], gap);
        self.points[0] = math::sub(self.points[0], math::mul(&math::qmat(self.frames[0]), gap));
    }

    /// Takes smaller stiffnesses along its axes \[N/m\] and keeps its forces; returns by how much its elastic energy grows \[J\].
    pub(super) fn soften(&mut self, translation: V3, bodies: &[BodyState]) -> f64 {
        let at = self.stance(bodies);
        let mut stretch = at.gap;
        stretch[0] = self.chord(&at).stretch - self.crushed;
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
    pub(super) fn latest(&self) -> Latest {
        let [m1, m2] = self.hinge.moment_nm;
        let along = [-self.outward * self.axial_force, self.shear[0], self.shear[1]];
        let ([local, couple], gap) = match &self.beam {
            Some(beam) => (beam.chord.force(along), beam.gap),
            None => {
                let stretch = |k: usize| if along[k] == 0.0 { 0.0 } else { along[k] / self.translation[k] };
                ([along, [0.0; 3]], [self.crushed + stretch(0), stretch(1), stretch(2)])
            }
        };
        let moment = [self.rotation[0] * self.theta[0], m1, m2];
        Latest { along, local, couple, moment, theta: self.theta, gap }
    }

    /// Square of the share of the capacity that a force \[N\] along its axes takes in shear.
    pub(super) fn shear_used2(&self, force: V3) -> f64 {
        force[1] * force[1] * self.shear_ease[0] + force[2] * force[2] * self.shear_ease[1]
    }

    /// The law: force and moment along the joint axes, for a rotation vector in that frame; the history advances.
    #[inline]
    pub(super) fn resist(
        &mut self,
        at: &Stance,
        chord: &Chord,
        theta: V3,
        tables: &[CapacityTable],
    ) -> [V3; 2] {
        self.relative = at.turn;
        let turned = math::sub(theta, std::mem::replace(&mut self.theta, theta));
        let before = std::mem::take(&mut self.onset);
        if self.is_held {
            let moment = self.moments(theta, tables);
            self.elastic_j += 0.5 * moment[0] * theta[0];
            return [[0.0; 3], moment];
        }
        let mut gap = at.gap;
        let k = self.translation;
        let old = self.axial_force;
        // by the flow of the last evaluation: the axial force is known before the moments
        let mut shortened = std::mem::take(&mut self.shortened);
        self.crushed -= self.outward * shortened;
        gap[0] = chord.stretch - self.crushed;
        self.axial_force = -self.outward * k[0] * gap[0];
        let (trial, bears) = (self.axial_force, self.left * self.compressive_capacity);
        let closed = if k[0] > 0.0 { (trial - old) / k[0] + shortened } else { 0.0 };
        self.harden(k[0]);
        let lowest = if self.tensile_elongation > 0.0 { -self.tensile_capacity } else { f64::NEG_INFINITY };
        let admissible = self.axial_force.clamp(lowest, self.left * self.compressive_capacity);
        if admissible != self.axial_force {
            let flow = (self.axial_force - admissible) / k[0];
            self.axial_force = admissible;
            shortened += flow;
            self.crushed -= self.outward * flow;
            self.elongated += (-flow).max(0.0);
            self.pressed += flow.max(0.0);
            gap[0] += self.outward * flow;
            let capacity = if flow > 0.0 { bears } else { lowest };
            self.onset[0][0] = -self.outward * onset(old, capacity, trial, admissible);
        }
        self.crush_j += 0.5 * (old + self.axial_force) * shortened;
        let mut shifted = [-self.outward * closed, 0.0, 0.0];
        if let Some(beam) = &mut self.beam {
            let across = beam.across();
            shifted[across] = at.gap[across] - beam.gap[across];
            (beam.chord, beam.gap) = (*chord, at.gap);
        }
        let bent = self.bend_beam(theta, &mut gap, tables);
        let local = [k[0] * gap[0], k[1] * gap[1], k[2] * gap[2]];
        self.sheared2 = self.shear_used2(local);
        self.shear = [local[1], local[2]];
        let moment = bent.unwrap_or_else(|| self.moments(theta, tables));
        self.elastic_j += 0.5 * (math::dot(local, gap) + moment[0] * theta[0]);
        self.begin_to_flow(before, [shifted, turned]);
        [math::add(local, self.onset[0]), math::add(moment, self.onset[1])]
    }

    /// Books the work on a displacement and a rotation of a step along its axes \[m, rad\] of what was added to its force for the step before, and for this one.
    #[inline]
    fn begin_to_flow(&mut self, before: [V3; 2], moved: [V3; 2]) {
        if self.pace != Pace::Steps {
            self.onset = [[0.0; 3]; 2];
            if self.pace == Pace::First {
                self.pace = Pace::Steps;
            }
            return;
        }
        let work = |added: &[V3; 2]| math::dot(added[0], moved[0]) + math::dot(added[1], moved[1]);
        if moved == [[0.0; 3]; 2] {
            self.onset = before; // the same pose once more
            return;
        }
        self.onset_j = work(&self.onset);
        self.hinge.dissipated_j += 0.5 * (work(&before) + self.onset_j);
    }

    /// Whether more than the law's force acts after the last evaluation.
    pub(super) fn begins_to_flow(&self) -> bool {
        self.onset != [[0.0; 3]; 2]
    }

    /// Finds the compression at which the axial spring flows in this step, for its stiffness \[N/m\]: where its elastic unloading meets the hardening curve.
    #[inline]
    fn harden(&mut self, stiffness: f64) {
        let left = self.left;
        if self.axial_force <= left * self.compressive_capacity {
            return;
        }
        let Some(hardening) = &self.hardening else { return };
        // capacity plus elastic unloading grows along the curve: the first point beyond the trial force ends the segment in which they meet
        let trial = self.axial_force + stiffness * self.pressed;
        let upper = hardening.partition_point(|[x, n]| left * n + stiffness * x <= trial);
        let Some([x0, n0]) = upper.checked_sub(1).map(|i| hardening[i]) else { return };
        self.compressive_capacity = hardening.get(upper).map_or(n0, |[x1, n1]| {
            let share = (trial - left * n0 - stiffness * x0) / (left * (n1 - n0) + stiffness * (x1 - x0));
            n0 + share * (n1 - n0)
        });
    }

    /// Moments about the joint axes of a beam with hinges at its ends; takes what is plastic off the gap and sets the bending part of the elastic energy.
    fn bend_beam(&mut self, theta: V3, gap: &mut V3, tables: &[CapacityTable]) -> Option<V3> {
        let beam = self.beam.as_mut()?;
        let (axis, across) = (beam.axis, beam.across());
        let springs = beam.springs(self.rotation, self.translation);
        let table = &tables[self.table[axis - 1] as usize];
        let step = beam.ends.step(table, &springs, [theta[axis], gap[across]], self.axial_force);
        beam.against_load_j += step.against_load_j;
        gap[across] -= beam.plastic()[1];
        self.flowing = step.flowing;
        [self.onset[1][axis], self.onset[0][across]] = beam.of_ends(step.onset_nm);
        self.hinge.dissipated_j += step.dissipated_j;
        self.hinge.alpha_rad = beam.ends.ends.iter().map(|e| e.alpha_rad).fold(0.0, f64::max);
        self.hinge.fractured |= beam.ends.is_broken();
        self.hinge.out_of_range |= step.out_of_range;
        if self.is_associated && step.flowing {
            self.shortened = beam.ends.shortened_m(table, step.flow_rad, self.axial_force);
        }
        let mut elastic = theta;
        let mut moment: V3 = std::array::from_fn(|i| self.rotation[i] * theta[i]);
        [elastic[axis], moment[axis]] = beam.ends.in_the_middle(&springs, theta[axis]);
        let bent = [1, 2].map(|i| self.rotation[i] * elastic[i]);
        self.elastic_j = 0.5 * (bent[0] * elastic[1] + bent[1] * elastic[2]);
        self.hinge.moment_nm = [moment[1], moment[2]];
        Some(moment)
    }

    /// The laws of the bending axes.
    fn laws<'a>(&self, tables: &'a [CapacityTable]) -> [AxisLaw<'a>; 2] {
        let law = |k: usize| match self.table[k] {
            NO_TABLE => AxisLaw::Elastic(self.rotation[k + 1]),
            t => AxisLaw::Plastic(&tables[t as usize]),
        };
        [law(0), law(1)]
    }

    /// Within what nothing flows or breaks; none if it is not known.
    pub(super) fn elastic_range(&self, tables: &[CapacityTable]) -> Option<ElasticRange> {
        let (force, ease, ends) = match &self.beam {
            Some(beam) => {
                let table = &tables[self.table[beam.axis - 1] as usize];
                let (force, ends) = beam.ends.elastic_range(table, self.axial_force)?;
                (force, [0.0; 2], ends)
            }
            None => {
                let (force, ease) = self.hinge.elastic_range(self.laws(tables), self.axial_force)?;
                (force, ease, [f64::INFINITY; 2])
            }
        };
        let force =
            [force[0].max(-self.tensile_capacity), force[1].min(self.left * self.compressive_capacity)];
        (!self.is_pulled_apart() && !self.is_crushed()).then_some(ElasticRange { force, ease, ends })
    }

    /// Moments about the joint axes; sets the bending part of the elastic energy.
    #[inline]
    fn moments(&mut self, theta: V3, tables: &[CapacityTable]) -> V3 {
        let torsion = self.rotation[0] * theta[0];
        let own = [theta[1] - self.lean[0], theta[2] - self.lean[1]];
        if !self.has_curve() {
            let m = [self.rotation[1] * own[0], self.rotation[2] * own[1]];
            self.elastic_j = 0.5 * (m[0] * own[0] + m[1] * own[1]);
            self.hinge.moment_nm = m;
            return [torsion, m[0], m[1]];
        }
        let laws = self.laws(tables);
        let step = self.hinge.step(laws, own, self.axial_force);
        self.flowing = step.flowing;
        self.onset[1] = [0.0, step.onset_nm[0], step.onset_nm[1]];
        if let Some(fading) = self.fading.as_ref().filter(|_| step.flowing) {
            self.left = interpolate(fading, self.hinge.alpha_rad);
        }
        if self.is_associated && step.flowing {
            self.shortened = self.hinge.shortened_m(laws, step.flow_rad, self.axial_force);
        }
        self.elastic_j = step.elastic_j;
        [torsion, self.hinge.moment_nm[0], self.hinge.moment_nm[1]]
    }

    /// The six rows of the joint's linearised kinematics in the current pose (see [`Row`]).
    pub fn rows(&self, bodies: &[BodyState]) -> [Row; 6] {
        let at = self.stance(bodies);
        let axes: M3 = math::transpose(&at.frame);
        let [force, couple] = self.chord(&at).force([1.0, 0.0, 0.0]).map(|v| math::mul(&at.frame, v));
        std::array::from_fn(|i| {
            let (axis, couple) = if i == 0 { (force, couple) } else { (axes[i % 3], [0.0; 3]) };
            if i < 3 {
                let [turn_a, turn_b] = at.arms.map(|arm| math::add(math::cross(arm, axis), couple));
                Row { stiffness: self.translation[i], a: self.a, b: self.b, force: axis, turn_a, turn_b }
            } else {
                Row {
                    stiffness: self.rotation[i - 3],
                    a: self.a,
                    b: self.b,
                    force: [0.0; 3],
                    turn_a: axis,
                    turn_b: axis,
                }
            }
        })
    }

    /// Whether it resists turns, and has turned by more than [`MOST_TURN_RAD`].
    pub(super) fn has_overturned(&self) -> bool {
        let resists = self.rotation.iter().any(|k| *k > 0.0);
        resists && math::dot(self.theta, self.theta) > MOST_TURN_RAD * MOST_TURN_RAD
    }

    /// Whether its springs hold its point in height, in the present poses.
    pub(super) fn bears_weight(&self, bodies: &[BodyState]) -> bool {
        const LEVEL: f64 = 1e-9;
        self.rows(bodies)[..3].iter().any(|row| row.stiffness > 0.0 && row.force[2].abs() > LEVEL)
    }
}

/// Length of the rotation vector from which a run warns: at a full revolution it turns round, and moments and plastic rotations are wrong from there \[rad\].
pub(super) const MOST_TURN_RAD: f64 = 5.0;

/// Which evaluations follow each other in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// None: those of a search, or of an integrator that follows the flow itself.
    Free,
    /// The next one is the first.
    First,
    /// Each is a step after the last one.
    Steps,
}

/// Within what a joint is elastic.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElasticRange {
    /// From and below which axial force \[N\].
    pub force: [f64; 2],
    /// `1/C²` about both bending axes \[1/(N m)²\] ([`Hinge2::elastic_range`]).
    pub ease: [f64; 2],
    /// Below which moments at both ends of a beam \[N m\] ([`crate::curve::BeamEnds::elastic_range`]).
    pub ends: [f64; 2],
}

impl ElasticRange {
    /// No number lies between infinity and infinity.
    pub const NONE: Self = Self { force: [f64::INFINITY; 2], ease: [0.0; 2], ends: [0.0; 2] };
}

/// What the last evaluation of a joint found, along its axes.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Latest {
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

/// One spring of a joint: its stretch is `force·(δx_b - δx_a) + turn_b·δφ_b - turn_a·δφ_a`.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Stiffness \[N/m\] or \[N m/rad\].
    pub stiffness: f64,
    /// First body.
    pub a: usize,
    /// Second body.
    pub b: usize,
    /// Direction of the force, zero for a rotational spring.
    pub force: V3,
    /// Moment arm on the first body.
    pub turn_a: V3,
    /// Moment arm on the second body.
    pub turn_b: V3,
}
