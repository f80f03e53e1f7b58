//! Histories, frames and the energy balance.

use super::Run;
use super::setup::joints_of;
use crate::mbs::balance::Balance;
use crate::mbs::contact::{ContactSet, Overlap};
use crate::mbs::error::SolveError;
use crate::mbs::model::Model;
use crate::mbs::result::{Energies, Frame};
use crate::mbs::system::BodyState;
use crate::mbs::{math, step};

/// Overlap at the start that is worth a warning, as a share of the thinner solid: members of buildings that are cut to each other overlap by less.
const OVERLAP_WORTH_TELLING: f64 = 0.1;
/// Pairs named in a remark.
const NAMED: usize = 3;

/// One remark on all solids that begin inside others, however many, with bodies in these positions \[m\] and orientations.
pub(in crate::mbs) fn remark_on_overlaps(
    model: &Model,
    contacts: &ContactSet,
    poses: &[(math::V3, math::Q)],
) -> Option<String> {
    let list = contacts.overlaps(OVERLAP_WORTH_TELLING, poses);
    let id = |o: &Overlap| (model.bodies[o.a].id.as_str(), o.b.id(model));
    let words = |o: &Overlap| format!("\"{}\" is {:.4} m inside \"{}\"", id(o).0, o.depth_m, id(o).1);
    let mut named: Vec<String> = list.iter().take(NAMED).map(words).collect();
    match list.len().saturating_sub(NAMED) {
        0 => {}
        1 => named.push("1 more pair overlaps".into()),
        more => named.push(format!("{more} more pairs overlap")),
    }
    let last = named.pop()?;
    let all = if named.is_empty() { last } else { format!("{} and {last}", named.join(", ")) };
    Some(format!(
        "at the start {all}, more than a tenth of the thinner solid: contacts keep such an overlap and do not push the solids apart; move them apart, or have them pass through each other (ignore in contact.pairs)"
    ))
}

impl Run<'_> {
    /// What is worth saying of the poses that the run begins in.
    pub(super) fn remark_on_start(&self) -> Option<String> {
        let bodies = &self.system.bodies[..self.system.count()];
        let poses: Vec<_> = bodies.iter().map(|b| (b.x, b.q)).collect();
        remark_on_overlaps(&self.model, &self.contacts, &poses)
    }

    pub(super) fn output(&mut self) -> Result<(), SolveError> {
        let energies = self.balance()?;
        self.result.energies.push(&energies);
        self.result.times_s.push(self.time);
        for k in 0..self.tracked.len() {
            let point = self.place_of(self.tracked[k]);
            let history = &mut self.result.tracked[k];
            history.displacement_m.push(math::sub(point, history.origin_m));
        }
        if !self.options.brief {
            self.histories();
        }
        Ok(())
    }

    /// Records poses, hinges and crushed ends.
    fn histories(&mut self) {
        let poses: Vec<_> = (0..self.file.bodies.len()).map(|i| self.piece(i)).collect();
        self.result.frames.push(Frame {
            position_m: poses.iter().map(|(x, _)| *x).collect(),
            orientation: poses.iter().map(|(_, q)| *q).collect(),
        });
        for (history, crushed) in self.result.crushed.iter_mut().zip(self.contacts.crushed()) {
            history.depth_m.push(crushed.depth_m);
            history.energy_j.push(crushed.energy_j);
        }
        // for what is recorded here alone: no step may rely on it, runs may leave histories out
        self.latent.weigh(&self.system);
        for (history, (bushing, hinge)) in self.result.hinges.iter_mut().zip(&self.hinges) {
            let Some(running) = self.latent.bushings[*bushing] else {
                let [_, moment] = self.latent.borne(*bushing).unwrap_or_default();
                history.rotation_rad.push([0.0; 2]);
                history.moment_nm.push([moment[1], moment[2]]);
                history.plastic_rotation_rad.push(0.0);
                history.axial_force_n.push(self.latent.axial_n(*bushing));
                continue;
            };
            let joint = &self.system.joints[running];
            if let Some(beam) = &joint.beam {
                let end = &beam.ends.ends[*hinge];
                let about = |value: f64| if beam.axis == 1 { [value, 0.0] } else { [0.0, value] };
                history.rotation_rad.push(about(end.plastic_rad));
                history.moment_nm.push(about(if joint.alive { end.moment_nm } else { 0.0 }));
                history.plastic_rotation_rad.push(end.alpha_rad);
                history.axial_force_n.push(if joint.alive { joint.axial_force } else { 0.0 });
                continue;
            }
            let moment = if joint.alive { joint.hinge.moment_nm } else { [0.0; 2] };
            history.rotation_rad.push([joint.theta[1], joint.theta[2]]);
            history.moment_nm.push(moment);
            history.plastic_rotation_rad.push(joint.hinge.alpha_rad);
            history.axial_force_n.push(if joint.alive { joint.axial_force } else { 0.0 });
        }
    }

    /// Looks at the sum of all energies, where forces are known.
    pub(super) fn balance(&mut self) -> Result<Energies, SolveError> {
        let n = self.system.count();
        if let Some(i) = (0..n).find(|i| !finite(&self.system.bodies[*i])) {
            return Err(SolveError::NotANumber {
                time_s: self.time,
                body: self.model.bodies[i].id.clone(),
                joints: joints_of(&self.model, i),
            });
        }
        self.note_turns();
        let energies = self.energies();
        let kick_j = self.system.kick_j(0.5 * self.last_step);
        if self.balanced_s.replace(self.time).is_none() {
            self.books = self.first_books(&energies);
        }
        let turned_j = energies.kinetic_j + energies.gravity_j.abs() + energies.plastic_j.abs();
        let error = self.books.note(&energies, kick_j, turned_j);
        (self.result.energy_error, self.result.energy_growth) = (self.books.error, self.books.growth);
        if error.is_nan() || error > self.options.energy_limit {
            return Err(self.energy_error(error));
        }
        self.look_at_flow();
        self.books.check_contacts(self.time, self.options.energy_limit, self.step_limit)?;
        Ok(energies)
    }

    fn note_turns(&mut self) {
        for (i, joint) in self.system.joints.iter().enumerate() {
            if joint.alive && joint.has_overturned() {
                self.overturned.note(&self.model.bushings[i].id, self.time);
            }
        }
    }

    fn energies(&mut self) -> Energies {
        let alive = (0..self.system.count()).filter(|i| self.system.data[*i].alive);
        let (mut kinetic_j, mut gravity_j) = (0.0, 0.0);
        let half = 0.5 * self.last_step;
        for i in alive {
            if !self.system.data[i].asleep {
                kinetic_j += step::kinetic_j(&self.system.bodies[i], &self.system.data[i], half);
            }
            gravity_j += self.gravity_energy(i);
        }
        kinetic_j += self.system.shared_j(|_, body, data| step::velocities(body, data, half));
        let joints = &self.system.joints;
        // what the spans of beams sag by themselves
        gravity_j += joints.iter().filter_map(|j| j.beam.as_ref()).map(|b| b.against_load_j).sum::<f64>();
        let [carried, let_go] = self.system.carried_j();
        let contact = self.contacts.energy;
        Energies {
            kinetic_j,
            gravity_j,
            joints_elastic_j: carried + joints.iter().filter(|j| j.alive).map(|j| j.elastic_j).sum::<f64>(),
            plastic_j: joints.iter().map(|j| j.hinge.dissipated_j + j.crush_j).sum::<f64>()
                - self.plastic_start,
            contact_damping_j: contact.normal_j + self.opened + self.sleep.taken_j,
            friction_j: contact.friction_j,
            released_j: self.released + let_go,
            applied_j: 0.0,
        }
    }

    /// The scales of a model in which nothing happens: one millimetre of fall.
    fn first_books(&self, energies: &Energies) -> Balance {
        let gravity = math::norm(self.system.gravity);
        let mass: f64 = self.system.data.iter().map(|d| d.mass).sum();
        let scale_j = 1e-3 * mass * gravity + energies.kinetic_j + energies.joints_elastic_j;
        let weights = self.system.data.iter().take(self.system.count()).enumerate();
        let contacts_j =
            Balance::of_contacts(weights.map(|(i, d)| (d.mass * gravity, self.contacts.radius_m(i))));
        Balance::new(scale_j, contacts_j)
    }

    fn energy_error(&self, error: f64) -> SolveError {
        let speed = |i: usize| math::norm(self.system.bodies[i].v);
        let body = (0..self.system.count()).max_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap_or(0);
        let energy = |i: usize| self.system.joints[i].elastic_j;
        let joint = (0..self.system.joints.len()).max_by(|a, b| energy(*a).total_cmp(&energy(*b)));
        SolveError::Energy {
            time_s: self.time,
            error,
            limit: self.options.energy_limit,
            body: self.model.bodies[body].id.clone(),
            speed_m_s: speed(body),
            joint: joint.map_or_else(|| "none".into(), |i| self.model.bushings[i].id.clone()),
            step_s: self.step_limit,
        }
    }
}

fn finite(body: &BodyState) -> bool {
    let sum: f64 = body.x.iter().chain(&body.q).chain(&body.p).chain(&body.l).map(|v| v * 0.0).sum();
    sum == 0.0
}
