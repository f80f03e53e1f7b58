//! Compliant connections among ideal joints: the law of [`crate::mbs::joint`], whose history moves on at the end of each step only.

use super::force::{Exerted, turned_back};
use super::joint::{Pose, is_ground, pose_of};
use super::turn::follow;
use crate::curve::{CapacityTable, CurveError, ResistanceCurve};
use crate::mbs::joint::{JointData, MOST_TURN_RAD, Pace};
use crate::mbs::math::{V3, axpy, dot, qmat, qmul};
use crate::mbs::model::{Bending, Bushing};
use crate::mbs::system::BodyState;

/// A bushing, given in the pose in which it is free of stress.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// Its entry in the model file.
    pub bushing: Bushing,
    /// The bodies; the ground may be one of them.
    pub bodies: [usize; 2],
    /// Ideal joint that holds its point, by its place in the mechanism.
    pub joint: Option<usize>,
    /// Curves of its bending axes.
    pub curves: [Option<ResistanceCurve>; 2],
}

/// A bushing in motion.
#[derive(Debug, Clone)]
pub struct Held {
    /// The bodies.
    pub bodies: [usize; 2],
    given: Given,
    tables: Vec<CapacityTable>,
    /// As the last step left it, and as the pose that was evaluated last would.
    committed: JointData,
    trial: JointData,
    factor: f64,
    /// Rotation vector along its axes at the end of the last step, revolutions counted \[rad\].
    turned: V3,
    /// Axial force of its joint at the pose that was evaluated last, and at the end of the last step, compression positive; by how much that step changed it \[N\].
    axial_force: f64,
    borne: f64,
    risen: f64,
    /// Rates of its stretch and of its rotations about its bending axes at the end of the last step \[m/s, rad/s\].
    rate: V3,
    /// Time from the end of the last step to what is evaluated, and the length of that step, zero if rates have jumped since \[s\].
    span_s: f64,
    last_s: f64,
}

/// A bushing with a curve at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BushingState {
    /// Rotations (revolutions counted) and moments about its bending axes \[rad, N m\].
    pub rotation_rad: [f64; 2],
    /// Moments.
    pub moment_nm: [f64; 2],
    /// Accumulated plastic rotation \[rad\].
    pub plastic_rad: f64,
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
}

impl Held {
    /// In the poses in which it is free of stress.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn of(given: &Given, poses: &[Pose]) -> Result<Self, CurveError> {
        let states = states(given.bodies, poses);
        let place = |side: usize| if is_ground(given.bodies[side]) { 2 } else { side };
        let mut committed = JointData::new(&given.bushing, [place(0), place(1)], &states, [0.0; 3]);
        committed.pace = Pace::Free;
        let trial = committed.clone();
        let mut held = Self {
            bodies: given.bodies,
            given: given.clone(),
            tables: Vec::new(),
            committed,
            trial,
            factor: 1.0,
            turned: [0.0; 3],
            axial_force: 0.0,
            borne: 0.0,
            risen: 0.0,
            rate: [0.0; 3],
            span_s: 0.0,
            last_s: 0.0,
        };
        held.tables = held.compiled()?;
        let mut next = 0;
        for k in 0..2 {
            match &held.given.bushing.bending[k] {
                Bending::Elastic { stiffness_nm_rad } => held.committed.set_elastic(k, *stiffness_nm_rad),
                Bending::Curve { .. } => {
                    held.committed.set_curve(k, next, &held.tables);
                    next += 1;
                }
            }
        }
        held.trial = held.committed.clone();
        Ok(held)
    }

    /// Capacities of its bending axes, weakened as far as events have.
    fn compiled(&self) -> Result<Vec<CapacityTable>, CurveError> {
        let of = |(bending, curve): (&Bending, &Option<ResistanceCurve>)| match (bending, curve) {
            (Bending::Curve { strength_factor, .. }, Some(curve)) => {
                Some(CapacityTable::new(curve, strength_factor * self.factor))
            }
            _ => None,
        };
        self.given.bushing.bending.iter().zip(&self.given.curves).filter_map(of).collect()
    }

    /// Multiplies its strength; what it bears above that flows off at once, at poses that it was applied in last.
    pub fn weaken(&mut self, by: f64, poses: &[Pose]) {
        self.factor *= by;
        // a curve that was compiled once is compiled again
        self.tables = self.compiled().unwrap_or_else(|_| std::mem::take(&mut self.tables));
        self.committed.set_strength(self.factor);
        self.attempt(poses);
        self.committed.clone_from(&self.trial);
    }

    /// Evaluates its law at poses, from what it remembers; the bodies with its loads.
    fn attempt(&mut self, poses: &[Pose]) -> [BodyState; 3] {
        let mut states = states(self.bodies, poses);
        self.trial.clone_from(&self.committed);
        let pace = self.pace_of(self.span_s);
        self.trial.hinge.pace = pace;
        if self.given.joint.is_some() {
            // as it went on in the last step: of second order
            self.trial.axial_force = self.borne + pace * self.risen;
        }
        self.trial.apply(&mut states, &self.tables);
        states
    }

    /// What is evaluated next is `span_s` after the last step's end.
    pub fn pace(&mut self, span_s: f64) {
        self.span_s = span_s;
    }

    /// A time from the end of the last step over that step; zero if rates have jumped since.
    fn pace_of(&self, span_s: f64) -> f64 {
        if self.last_s > 0.0 { span_s / self.last_s } else { 0.0 }
    }

    /// Adds its forces to the bodies' loads.
    pub fn apply(&mut self, poses: &[Pose], loads: &mut Exerted<'_>) {
        let states = self.attempt(poses);
        for (body, state) in self.bodies.into_iter().zip(&states) {
            loads.add(body, [state.force, state.torque]);
        }
    }

    /// The ideal joint that holds its point, by its place in the mechanism.
    pub fn joint(&self) -> Option<usize> {
        self.given.joint
    }

    /// Takes note of the force of its joint on its second body \[N\], at the pose that was applied last.
    pub fn feel(&mut self, force: V3, poses: &[Pose]) {
        let frame = qmat(qmul(pose_of(poses, self.bodies[1]).q, self.committed.frames[1]));
        self.axial_force = self.committed.outward * dot(force, [frame[0][0], frame[1][0], frame[2][0]]);
    }

    /// Takes the axial force that was felt last as the one under which it resists: what was before it tells nothing.
    pub fn settle(&mut self) {
        (self.last_s, self.risen) = (0.0, 0.0);
        self.borne = self.axial_force;
        if self.given.joint.is_some() {
            self.committed.axial_force = self.axial_force;
        }
    }

    /// Takes the pose in which it was applied last into its history; whether it breaks, and whether by tension.
    pub fn commit(&mut self, poses: &[Pose]) -> Option<bool> {
        if self.may_flow() {
            self.rate = self.rates(poses);
        }
        self.committed.clone_from(&self.trial);
        self.turned = follow(self.trial.theta, self.turned);
        (self.risen, self.borne) = (self.axial_force - self.borne, self.axial_force);
        self.last_s = std::mem::take(&mut self.span_s);
        self.is_broken().then_some(!self.trial.hinge.fractured)
    }

    /// Whether anything of it may be plastic.
    fn may_flow(&self) -> bool {
        let own = &self.given.bushing;
        let stretches = own.tensile_elongation_m.is_some() || own.compressive_capacity_n.is_some();
        stretches || self.committed.has_curve()
    }

    /// Rates of its stretch and of its rotations about its bending axes \[m/s, rad/s\].
    fn rates(&self, poses: &[Pose]) -> V3 {
        let of = |side: usize| {
            let pose = pose_of(poses, self.bodies[side]);
            [pose.v, pose.w]
        };
        let rows = self.committed.rows(&states(self.bodies, poses));
        [0, 4, 5].map(|k: usize| rows[k].stretch([of(0), of(1)]))
    }

    /// Work of flow that a step \[s\] leaves out, as it turns back in it ([`turned_back`]) \[J\].
    pub fn turned_back_j(&self, poses: &[Pose], step: f64) -> f64 {
        let [old, new] = [&self.committed, &self.trial];
        let bent = |k: usize| new.hinge.plastic_rad[k] - old.hinge.plastic_rad[k];
        let flow = [new.crushed - old.crushed, bent(0), bent(1)];
        let flowed = [old.is_stretching(), old.flowing, old.flowing];
        if flow == [0.0; 3] && flowed == [false; 3] {
            return 0.0;
        }
        let (now, [first, second]) = (self.rates(poses), new.hinge.moment_nm);
        let force = [new.axial_force, first, second];
        (0..3).map(|k| force[k].abs() * turned_back(flow[k], flowed[k], [self.rate[k], now[k]], step)).sum()
    }

    /// Whether it broke when it was applied last: by tension of a joint, at the end of the last step.
    pub fn is_broken(&self) -> bool {
        let torn = match self.given.joint {
            Some(_) => -self.borne > self.trial.tensile_capacity,
            None => self.trial.is_pulled_apart(),
        };
        self.trial.hinge.fractured || torn
    }

    /// Plastic rotation of its hinge \[rad\].
    pub fn plastic_rad(&self) -> f64 {
        self.committed.hinge.alpha_rad
    }

    /// Whether its hinge has flowed.
    pub fn has_flowed(&self) -> bool {
        self.committed.hinge.alpha_rad > 0.0
    }

    /// As it would be at poses that follow on its history, at a share of the step that was evaluated last: elastic and dissipated energy \[J\], and its hinge if it has a curve.
    pub fn at(&self, poses: &[Pose], share: f64) -> ([f64; 2], Option<BushingState>) {
        let mut there = self.committed.clone();
        there.hinge.pace = self.pace_of(share * self.span_s);
        let axial_force_n = self.borne + share * (self.axial_force - self.borne);
        if self.given.joint.is_some() && share > 0.0 {
            there.axial_force = axial_force_n;
        }
        there.apply(&mut states(self.bodies, poses), &self.tables);
        let [_, first, second] = follow(there.theta, self.turned);
        let state = BushingState {
            rotation_rad: [first, second],
            moment_nm: there.hinge.moment_nm,
            plastic_rad: there.hinge.alpha_rad,
            axial_force_n: if self.given.joint.is_some() { axial_force_n } else { there.axial_force },
        };
        let energies = [there.elastic_j, there.hinge.dissipated_j + there.crush_j];
        (energies, there.has_curve().then_some(state))
    }

    /// Its springs: stiffness, and what a unit of its force or moment does to a body's mobility: the square of the arm of a force \[m²\], nothing for a moment.
    pub fn springs(&self, poses: &[Pose]) -> impl Iterator<Item = (f64, [Option<f64>; 2])> {
        let rows = self.committed.rows(&states(self.bodies, poses));
        rows.into_iter().map(|row| {
            let arm = |turn: V3| (row.force != [0.0; 3]).then(|| dot(turn, turn));
            (row.stiffness, [arm(row.turn_a), arm(row.turn_b)])
        })
    }

    /// Whether it has turned farther than it can tell ([`MOST_TURN_RAD`]).
    pub fn has_overturned(&self) -> bool {
        dot(self.turned, self.turned) > MOST_TURN_RAD * MOST_TURN_RAD
    }

    /// Its id.
    pub fn id(&self) -> &str {
        &self.given.bushing.id
    }

    /// [`JointData::bears_weight`].
    pub fn bears_weight(&self, poses: &[Pose]) -> bool {
        self.committed.bears_weight(&states(self.bodies, poses))
    }

    /// Adds the elastic loads that follow a small motion of the bodies.
    pub fn respond(&self, poses: &[Pose], motion: &[[V3; 2]], loads: &mut [[V3; 2]]) {
        let of = |side: usize| {
            let body = self.bodies[side];
            if is_ground(body) { [[0.0; 3]; 2] } else { motion[body] }
        };
        for row in self.committed.rows(&states(self.bodies, poses)) {
            let stretch = row.stretch([of(0), of(1)]);
            for (side, sign, turn) in [(0, 1.0, row.turn_a), (1, -1.0, row.turn_b)] {
                if !is_ground(self.bodies[side]) {
                    let [f, t] = &mut loads[self.bodies[side]];
                    *f = axpy(*f, sign * row.stiffness * stretch, row.force);
                    *t = axpy(*t, sign * row.stiffness * stretch, turn);
                }
            }
        }
    }
}

/// States of the two bodies and of the ground as the law of the bushing reads them.
fn states(bodies: [usize; 2], poses: &[Pose]) -> [BodyState; 3] {
    let of = |pose: &Pose| BodyState { x: pose.x, q: pose.q, r: pose.r, ..BodyState::ground() };
    [of(pose_of(poses, bodies[0])), of(pose_of(poses, bodies[1])), BodyState::ground()]
}
