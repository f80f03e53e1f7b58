//! The compiled model: what the time loop needs, in compact arrays, and nothing else.
//!
//! Index `bodies.len() - 1` is the ground, a body that never moves; so joints and contacts need no
//! special case for it.

use super::carry::CarryOver;
use super::frequency;
use super::joint::{JointData, Row, Stride};
use super::joint_lanes::{self, Act, JointBlock};
use super::math::{self, M3, Q, V3};
use super::model::{Bending, Body, Bushing, Model};
use super::relative_mass::Relative;
use super::shared_mass::{Shared, Start};
use super::step::{self, InverseBlock, Moved};
use super::tables::Tables;
use super::weight::Weight;
use crate::base::isa::Isa;
use crate::curve::{CurveError, ResistanceCurve};
use std::collections::BTreeMap;

/// Moving state of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyState {
    /// Centre of mass \[m\].
    pub x: V3,
    /// Orientation (body to global).
    pub q: Q,
    /// Rotation matrix of `q`.
    pub r: M3,
    /// Momentum, half a step behind the position \[kg m/s\].
    pub p: V3,
    /// Angular momentum about the centre of mass in the global frame, half a step behind \[kg m²/s\].
    pub l: V3,
    /// Velocity over the last step \[m/s\].
    pub v: V3,
    /// Angular velocity over the last step, global frame \[rad/s\].
    pub w: V3,
    /// The same in the body frame (starting guess of the next step) \[rad/s\].
    pub w_body: V3,
    /// Force at the current position \[N\].
    pub force: V3,
    /// Torque about the centre of mass at the current position \[N m\].
    pub torque: V3,
}

/// Constants of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyData {
    /// Mass \[kg\]; zero for the ground.
    pub mass: f64,
    /// `1/mass`; zero for the ground.
    pub inverse_mass: f64,
    /// Inertia in the body frame \[kg m²\].
    pub inertia: M3,
    /// Its inverse; zero for the ground.
    pub inverse_inertia: M3,
    /// Whether the body is still there.
    pub alive: bool,
    /// Whether it sleeps.
    pub asleep: bool,
}

/// A compiled model.
#[derive(Debug, Clone)]
pub struct System {
    /// Gravity \[m/s²\].
    pub gravity: V3,
    /// State of the bodies, the ground last.
    pub bodies: Vec<BodyState>,
    /// Constants of the bodies, the ground last.
    pub data: Vec<BodyData>,
    /// Joints.
    pub joints: Vec<JointData>,
    /// Capacities used by the joints.
    pub tables: Tables,
    /// The instruction set of the time loop; the bytes are the same with each.
    pub isa: Isa,
    pub(super) blocks: Vec<JointBlock>,
    pub(super) inverses: Vec<InverseBlock>,
    pub(super) moved: Moved,
    act: Act,
    /// Length of the last step \[s\], and how long it was against the one before (zero: there was none).
    pub(super) drifted_s: f64,
    pub(super) pace: f64,
    weight: Weight,
    /// Members that bend between two joints, and the blocks and lanes of these.
    pub(super) carries: Vec<CarryOver>,
    /// Inertial coupling of bodies.
    pub(super) shared: Vec<Shared>,
    /// Inertia against relative motion; none: not now.
    pub(super) relative: Option<Relative>,
    lanes: Vec<[usize; 2]>,
}

impl System {
    /// Compiles a checked model.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn new(model: &Model) -> Result<Self, CurveError> {
        Self::with_tables(model, Tables::default())
    }

    /// Compiles a checked model of which capacities are known: those of the same curves.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn with_tables(model: &Model, mut tables: Tables) -> Result<Self, CurveError> {
        let mut bodies: Vec<BodyState> = model.bodies.iter().map(BodyState::new).collect();
        let mut data: Vec<BodyData> = model.bodies.iter().map(BodyData::new).collect();
        bodies.push(BodyState::ground());
        data.push(BodyData::ground());
        let index: BTreeMap<&str, usize> =
            model.bodies.iter().enumerate().map(|(i, b)| (b.id.as_str(), i)).collect();
        let ground = model.bodies.len();
        let mut joints = Vec::with_capacity(model.bushings.len());
        for joint in &model.bushings {
            let a = joint.body_a.as_deref().and_then(|id| index.get(id).copied()).unwrap_or(ground);
            let b = index.get(joint.body_b.as_str()).copied().unwrap_or(ground);
            let mut compiled = JointData::new(joint, [a, b], &bodies, model.gravity_m_s2);
            for k in 0..2 {
                match &joint.bending[k] {
                    Bending::Elastic { stiffness_nm_rad } => compiled.set_elastic(k, *stiffness_nm_rad),
                    Bending::Curve { curve, strength_factor } => {
                        let table = tables.place(&model.curves, curve, *strength_factor)?;
                        compiled.set_curve(k, table, &tables);
                    }
                }
            }
            joints.push(compiled);
        }
        let blocks = JointBlock::all(&joints, &tables);
        let inverses = InverseBlock::all(&data);
        let (gravity, isa) = (model.gravity_m_s2, Isa::best());
        let (moved, act) = (Moved::default(), Act::default());
        let weight = Weight::new(&joints, ground);
        let carries = CarryOver::all(&model.bushings, &joints);
        let lanes = lanes(&blocks, joints.len());
        Ok(Self {
            gravity,
            bodies,
            data,
            joints,
            tables,
            isa,
            blocks,
            inverses,
            moved,
            act,
            drifted_s: 0.0,
            pace: 0.0,
            weight,
            carries,
            shared: Vec::new(),
            relative: None,
            lanes,
        })
    }

    /// Finds the inertia that bodies have together in their present poses, for the highest frequency of the bodies alone \[rad/s\].
    pub(super) fn share_masses(&mut self, model: &Model, highest_rad_s: f64) {
        let rows = frequency::rows(self);
        let Self { bodies: states, data, joints, .. } = &*self;
        self.shared = Shared::all(model, &Start { states, data, joints, rows: &rows, highest_rad_s });
    }

    /// Gives all bodies inertia against relative motion in their present poses, so that no frequency is above a bound \[rad/s\], or none, where forces are known but for inertia that bodies have together, after a step of
    /// `last_step_s`. Returns the kinetic energy that is released \[J\].
    pub(super) fn relate(&mut self, most_rad_s: Option<f64>, last_step_s: f64) -> f64 {
        let before = self.kinetic_together_j(0.5 * last_step_s);
        self.relative = most_rad_s.and_then(|most| {
            let rows = frequency::rows(self);
            Relative::new(&rows, &self.joints, (&self.bodies, &self.data), &self.shared, most)
        });
        before - self.kinetic_together_j(0.5 * last_step_s)
    }

    /// Kinetic energy of bodies and of the inertia that they have together, under forces that are known but for that, half a step before the momenta \[J\].
    fn kinetic_together_j(&mut self, half_s: f64) -> f64 {
        let plain: Vec<[V3; 2]> = self.bodies.iter().map(|b| [b.force, b.torque]).collect();
        self.share_forces();
        let moving = |i: &usize| self.data[*i].alive && !self.data[*i].asleep;
        let alone = |i: usize| step::kinetic_j(&self.bodies[i], &self.data[i], half_s);
        let own: f64 = (0..self.count()).filter(moving).map(alone).sum();
        let all = own + self.shared_j(|_, body, data| step::velocities(body, data, half_s));
        for (body, [force, torque]) in self.bodies.iter_mut().zip(&plain) {
            (body.force, body.torque) = (*force, *torque);
        }
        all
    }

    /// Kinetic energy that inertia against relative motion \[rad/s\] has in springs that flow and ask for none \[J\].
    pub(super) fn flowing_j(&self, most_rad_s: f64, half_s: f64) -> f64 {
        let motion = |i: usize| step::velocities(&self.bodies[i], &self.data[i], half_s);
        let of = |joint: &JointData| -> f64 {
            let flows = joint.flowing_rows();
            if !flows.contains(&true) {
                return 0.0;
            }
            let rows = joint.rows(&self.bodies).into_iter().zip(flows).filter(|(_, flows)| *flows);
            let square = |(row, _): (Row, bool)| {
                let rate = row.stretch([row.a, row.b].map(motion));
                row.stiffness * rate * rate
            };
            rows.map(square).sum()
        };
        let alive = self.joints.iter().filter(|j| j.alive);
        0.5 * alive.map(of).sum::<f64>() / (most_rad_s * most_rad_s)
    }

    /// Gives the bodies back the forces without their inertia against relative motion.
    pub(super) fn give_back_forces(&mut self) {
        if let Some(relative) = &self.relative {
            relative.undo(&mut self.bodies);
        }
    }

    /// Changes forces to those with which bodies that have inertia together are accelerated by their own.
    #[inline]
    pub(super) fn share_forces(&mut self) {
        if let Some(relative) = &mut self.relative {
            relative.act(self.isa, &mut self.bodies, &self.data);
            return;
        }
        self.shared.iter_mut().for_each(|s| s.act(self.isa, &mut self.bodies));
    }

    /// Kinetic energy of what bodies have together, for velocities \[J\].
    pub(super) fn shared_j(&mut self, velocity: impl Fn(usize, &BodyState, &BodyData) -> [V3; 2]) -> f64 {
        let Self { isa, shared, relative, bodies, data, .. } = self;
        if let Some(relative) = relative {
            return relative.energy_j(*isa, bodies, |i| velocity(i, &bodies[i], &data[i]));
        }
        shared.iter_mut().map(|s| s.energy_j(bodies, |i| velocity(i, &bodies[i], &data[i]))).sum()
    }

    /// What the forces of a step add to the kinetic energy by themselves until the full step, half a step after the momenta \[J\]: that of the mean velocity less half the product of the velocities half a step before and after, with which leapfrog conserves
    /// the energy of linear vibrations exactly (Allen and Tildesley, Computer Simulation of Liquids, 1987, ch. 3).
    pub(super) fn kick_j(&mut self, half_s: f64) -> f64 {
        let moving = |i: &usize| self.data[*i].alive && !self.data[*i].asleep;
        if let Some(relative) = &self.relative {
            let of = |i: usize| relative.kick_j(i, &self.bodies[i], &self.data[i], half_s);
            return (0..self.count()).filter(moving).map(of).sum();
        }
        let of = |i: usize| step::kick_j(&self.bodies[i], &self.data[i], half_s);
        let own: f64 = (0..self.count()).filter(moving).map(of).sum();
        own + self.shared_j(|_, body, data| step::gains(body, data, half_s))
    }

    /// Ends the sharing of those of which this is true, where forces are known but for what they share, after a step of `last_step_s`. Returns the kinetic energy that is released \[J\].
    pub(super) fn end_sharing(
        &mut self,
        last_step_s: f64,
        mut is_over: impl FnMut(&Shared, &Self) -> bool,
    ) -> f64 {
        let mut lists = std::mem::take(&mut self.shared);
        let mut released = 0.0;
        lists.retain_mut(|s| {
            let ends = is_over(s, self);
            if ends {
                released += self.let_go(s, last_step_s);
            }
            !ends
        });
        self.shared = lists;
        released
    }

    /// Lets the bodies of a list go, where forces are known but for what they share, at the full step.
    fn let_go(&mut self, shared: &mut Shared, last_step_s: f64) -> f64 {
        let half = 0.5 * last_step_s;
        let Self { bodies, data, isa, .. } = self;
        let alone = |shared: &Shared, bodies: &[BodyState]| -> f64 {
            shared.bodies().iter().map(|i| step::kinetic_j(&bodies[*i], &data[*i], half)).sum()
        };
        let plain: Vec<[V3; 2]> =
            shared.bodies().iter().map(|i| [bodies[*i].force, bodies[*i].torque]).collect();
        shared.act(*isa, bodies);
        let at: Vec<[V3; 2]> =
            (0..bodies.len()).map(|i| step::velocities(&bodies[i], &data[i], half)).collect();
        let before = alone(shared, bodies) + shared.energy_j(bodies, |i| at[i]);
        shared.let_go(bodies, |i| at[i]);
        for (i, [force, torque]) in shared.bodies().iter().zip(plain) {
            let body = &mut bodies[*i];
            // the momenta at the full step stay
            step::push(body, half);
            (body.force, body.torque) = (force, torque);
            step::push(body, -half);
            step::find_velocities(body, &data[*i], last_step_s);
        }
        before - alone(shared, bodies)
    }

    /// Finds out how much of their weight the spans of beams bear, after a step \[s\].
    pub fn weigh(&mut self, h_s: f64) {
        let Self { weight, joints, bodies, data, gravity, blocks, lanes, shared, .. } = self;
        let is_consistent = |ends| shared.iter().any(|s| s.joins(ends));
        weight.follow(joints, bodies, data, (*gravity, h_s), is_consistent, |i, joint| {
            if joint.alive {
                let [block, lane] = lanes[i];
                blocks[block].bear(lane, joint);
            }
        });
    }

    /// Sets the strength of the curves of a joint to a share of that which its bushing gives.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn set_strength(
        &mut self,
        joint: usize,
        given: &Bushing,
        share: f64,
        curves: &BTreeMap<String, ResistanceCurve>,
    ) -> Result<(), CurveError> {
        for (k, bending) in given.bending.iter().enumerate() {
            if let Bending::Curve { curve, strength_factor } = bending {
                let table = self.tables.place(curves, curve, strength_factor * share)?;
                self.joints[joint].set_curve(k, table, &self.tables);
            }
        }
        self.joints[joint].set_strength(share);
        Ok(())
    }

    /// Takes over the leans that fit the present moments, in equilibrium. Returns the largest moment that they change \[N m\].
    pub(super) fn settle_carries(&mut self) -> f64 {
        let Self { carries, joints, .. } = self;
        let largest = carries.iter_mut().map(|c| c.settle(joints)).fold(0.0, f64::max);
        self.pack();
        largest
    }

    /// After joints have taken over histories: their leans go on from there.
    pub(super) fn resume_carries(&mut self) {
        let Self { carries, joints, .. } = self;
        carries.iter_mut().for_each(|c| c.resume(joints));
    }

    /// Elastic energy between the ends of members that something holds, and what others had when they were let go \[J\].
    pub(super) fn carried_j(&self) -> [f64; 2] {
        let of = |held: bool| {
            self.carries.iter().filter(|c| c.is_held(&self.joints) == held).map(CarryOver::elastic_j).sum()
        };
        [of(true), of(false)]
    }

    /// To be called when joints were changed, or joints or bodies taken away.
    pub fn pack(&mut self) {
        self.blocks = JointBlock::all(&self.joints, &self.tables);
        self.lanes = lanes(&self.blocks, self.joints.len());
    }

    /// The step to the next evaluation of the joints.
    pub(super) fn stride(&self) -> Stride {
        Stride { pace: self.pace, length_s: self.drifted_s }
    }

    /// Number of moving bodies.
    pub fn count(&self) -> usize {
        self.bodies.len() - 1
    }

    /// Sets gravity as the only force.
    #[inline]
    pub fn reset_forces(&mut self) {
        for (body, data) in self.bodies.iter_mut().zip(&self.data) {
            if !data.asleep {
                body.force = math::scale(data.mass, self.gravity);
                body.torque = [0.0; 3];
            }
        }
    }

    /// Adds the forces of all intact joints; hinge histories advance. Whether any of them may have flowed or broken.
    #[inline]
    pub fn add_joint_forces(&mut self) -> bool {
        let stride = self.stride();
        joint_lanes::apply_all(
            self.isa,
            &mut self.blocks,
            &mut self.joints,
            &mut self.bodies,
            &self.data,
            &self.tables,
            stride,
            &mut self.act,
        )
    }

    /// After the forces of a step: what the ends of members carry over to each other, in it and in the next one.
    #[inline]
    pub fn carry_over(&mut self) {
        let Self { carries, joints, blocks, bodies, data, lanes, .. } = self;
        for carry in carries {
            let is_elastic = |i: usize, joint: &JointData, moment_nm| {
                let [block, lane] = lanes[i];
                blocks[block].is_elastic(lane, joint.axial_force, moment_nm)
            };
            if carry.go_on(joints, bodies, data, is_elastic) {
                for i in carry.joints {
                    let [block, lane] = lanes[i];
                    blocks[block].lean(lane, &joints[i]);
                }
            }
        }
    }
}

/// Block and lane of each joint.
fn lanes(blocks: &[JointBlock], joints: usize) -> Vec<[usize; 2]> {
    let mut lanes = vec![[0; 2]; joints];
    for (b, block) in blocks.iter().enumerate() {
        block.joints().iter().enumerate().for_each(|(l, i)| lanes[*i as usize] = [b, l]);
    }
    lanes
}

impl BodyState {
    /// That of a body of the file.
    pub fn new(body: &Body) -> Self {
        let q = math::qunit(body.orientation);
        let r = math::qmat(q);
        let w_body = math::mul_t(&r, body.angular_velocity_rad_s);
        Self {
            x: body.position_m,
            q,
            r,
            p: math::scale(body.mass_kg, body.velocity_m_s),
            l: math::mul(&r, math::mul(&body.inertia_kg_m2, w_body)),
            v: body.velocity_m_s,
            w: body.angular_velocity_rad_s,
            w_body,
            force: [0.0; 3],
            torque: [0.0; 3],
        }
    }

    /// A body that does not move.
    pub fn ground() -> Self {
        let zero = [0.0; 3];
        let q = [1.0, 0.0, 0.0, 0.0];
        let r = math::qmat(q);
        Self { x: zero, q, r, p: zero, l: zero, v: zero, w: zero, w_body: zero, force: zero, torque: zero }
    }

    /// Turns the body by a rotation vector in the global frame.
    pub fn rotate(&mut self, rotation: V3) {
        self.q = math::qrenormalise(math::qmul(math::qexp(rotation), self.q));
        self.r = math::qmat(self.q);
    }
}

impl BodyData {
    fn new(body: &Body) -> Self {
        let m = &body.inertia_kg_m2;
        let inertia: M3 = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (m[i][j] + m[j][i])));
        Self {
            mass: body.mass_kg,
            inverse_mass: 1.0 / body.mass_kg,
            inertia,
            inverse_inertia: math::inverse(&inertia),
            alive: true,
            asleep: false,
        }
    }

    fn ground() -> Self {
        let zero = [[0.0; 3]; 3];
        Self {
            mass: 0.0,
            inverse_mass: 0.0,
            inertia: zero,
            inverse_inertia: zero,
            alive: true,
            asleep: false,
        }
    }
}
