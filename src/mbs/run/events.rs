//! Yield, fracture, contacts, and the events of a model.

use super::Run;
use super::setup::connect;
use crate::mbs::contact::Partner;
use crate::mbs::error::SolveError;
use crate::mbs::math::axpy;
use crate::mbs::result::{EventKind, FractureCause, RunEvent};
use crate::mbs::run::{LARGEST_STEP_S, SAME};
use crate::mbs::snap::Snap;
use crate::mbs::system::System;
use crate::mbs::{math, step};

impl Run<'_> {
    #[cold]
    pub(super) fn note_yield(&mut self, i: usize) {
        let id = &self.model.bushings[i].id;
        let joint = &self.system.joints[i];
        for (k, hinge) in self.model.bushings[i].hinges().into_iter().enumerate() {
            if joint.flowed()[k].0 > 0.0 && !std::mem::replace(&mut self.yielded[i][k], true) {
                let kind = EventKind::Yield { joint: hinge.to_string() };
                let time_s = self.time - (1.0 - joint.begins_at(k)) * self.last_step;
                self.result.events.push(RunEvent { time_s, kind });
            }
        }
        if joint.hinge.out_of_range && !std::mem::replace(&mut self.range_warned[i], true) {
            self.beyond_levels.push((id.clone(), self.time, joint.axial_force));
        }
    }

    pub(super) fn note_preload_yield(&mut self) {
        for i in 0..self.system.joints.len() {
            let flows = |(k, _): &(usize, &str)| self.preloading && self.yielded[i][*k];
            for (_, hinge) in self.model.bushings[i].hinges().into_iter().enumerate().filter(flows) {
                self.result.warnings.push(format!("joint \"{hinge}\" flows under dead load already"));
                let kind = EventKind::Yield { joint: hinge.to_string() };
                self.result.events.push(RunEvent { time_s: 0.0, kind });
            }
        }
    }

    /// Takes a joint away that breaks, and its force; how long before the end of the step it did \[s\]. Where momenta are those of the end already that is the end.
    fn separate(&mut self, i: usize) -> f64 {
        let System { bodies, joints, .. } = &mut self.system;
        let joint = &mut joints[i];
        let snap = (self.last_step > 0.0).then(|| Snap::of(joint, bodies, self.last_step));
        let onset = joint.take_back_onset(bodies);
        let pull = joint.pull(bodies);
        let [force, on_a, on_b]: [math::V3; 3] = std::array::from_fn(|k| math::add(pull[k], onset[k]));
        let [impulse, turn_a, turn_b] = snap.map_or([[0.0; 3]; 3], |s| s.impulse);
        let ground = bodies.len() - 1;
        let sides = [(joint.a, 1.0, on_a, turn_a), (joint.b, -1.0, on_b, turn_b)];
        for (i, sign, torque, turn) in sides.into_iter().filter(|side| side.0 != ground) {
            let body = &mut bodies[i];
            (body.force, body.torque) = (axpy(body.force, -sign, force), axpy(body.torque, -sign, torque));
            (body.p, body.l) = (axpy(body.p, sign, impulse), axpy(body.l, sign, turn));
        }
        let elastic_j = joint.open();
        let Some(snap) = snap else {
            self.released += elastic_j;
            return 0.0;
        };
        joint.take_back_flow(1.0 - snap.early_s / self.last_step);
        joint.hinge.dissipated_j -= snap.beyond_j[0];
        joint.crush_j -= snap.beyond_j[1];
        joint.beam.iter_mut().for_each(|beam| beam.against_load_j -= snap.against_load_j);
        self.released += snap.elastic_j;
        snap.early_s
    }

    /// Opens the joints that break; their bodies.
    #[cold]
    pub(super) fn fracture(&mut self) -> Vec<[usize; 2]> {
        self.bring_to_the_end();
        let (mut parted, mut broken) = (Vec::new(), Vec::new());
        for i in 0..self.system.joints.len() {
            let joint = &mut self.system.joints[i];
            if joint.breaks() {
                parted.push([joint.a, joint.b]);
                let end = joint.flowed().iter().position(|(_, broken)| *broken).unwrap_or(0);
                let time_s = self.time - self.separate(i);
                broken.push((i, time_s));
                let joint = &self.system.joints[i];
                // what is crushed touches nothing from now on, also where it breaks by rotation in the same step or parts later
                let cause = if joint.is_crushed() {
                    self.latent.pieces[joint.b].iter().for_each(|piece| self.crushed[*piece] = true);
                    FractureCause::Compression
                } else if joint.hinge.fractured {
                    FractureCause::Rotation
                } else if joint.is_sheared_off() {
                    FractureCause::Shear
                } else {
                    FractureCause::Tension
                };
                let bushing = &self.model.bushings[i];
                let name = bushing.hinges().get(end).map_or(bushing.id.as_str(), |name| name).to_string();
                let kind = EventKind::Fracture { joint: name, cause };
                self.result.events.push(RunEvent { time_s, kind });
            }
        }
        broken.into_iter().for_each(|(joint, time_s)| self.ask_about_fracture(joint, time_s));
        self.system.pack();
        self.sleep.rouse_all(&mut self.system, &mut self.contacts, 0.5 * self.last_step);
        connect(&mut self.contacts, &self.system, &self.latent, &self.crushed);
        if self.model.settings.time_step_s.is_none() && self.system.joints.iter().all(|j| !j.alive) {
            self.step_limit = LARGEST_STEP_S;
        }
        parted
    }

    #[cold]
    pub(super) fn record_touches(&mut self) {
        let mut touches = std::mem::take(&mut self.contacts.touches);
        touches.sort_by(|a, b| a.after_s.total_cmp(&b.after_s));
        for touch in touches {
            let time_s = self.time + touch.after_s;
            if touch.b == Partner::Ground {
                self.result.first_ground_contact_s.get_or_insert(time_s);
            }
            let kind = EventKind::Contact {
                a: self.model.bodies[touch.a].id.clone(),
                b: touch.b.id(&self.model).into(),
            };
            // pieces of a body are told of what it has met before
            if self.latent.has_parted() && self.result.events.iter().any(|e| e.kind == kind) {
                continue;
            }
            self.result.events.push(RunEvent { time_s, kind });
        }
    }

    /// Carries out the events of a time: momenta are brought to the full step, bodies and joints vanish or weaken, forces are evaluated again.
    pub(super) fn events_at(&mut self, time: f64) -> Result<(), SolveError> {
        let file = self.file;
        let tolerance = SAME * file.settings.end_time_s;
        let (mut any, was_related) = (false, self.system.relative.is_some());
        for event in file.events.iter().filter(|e| (e.time_s - time).abs() <= tolerance) {
            if !std::mem::replace(&mut any, true) {
                self.note_resting();
                self.sleep.rouse_all(&mut self.system, &mut self.contacts, 0.5 * self.last_step);
                self.synchronise_held();
                self.end_relating();
            }
            for id in &event.remove_bodies {
                if let Some(i) = file.bodies.iter().position(|b| b.id == *id) {
                    self.part_from_others(i)?;
                    self.remove_body(self.latent.places[i].body);
                }
            }
            for id in &event.release {
                if let Some(b) = file.bushings.iter().position(|b| b.id == *id) {
                    self.part_at(b)?;
                    self.release(b);
                }
            }
            for w in &event.weaken {
                if let Some(b) = file.bushings.iter().position(|b| b.id == w.id) {
                    self.weaken(b, w.factor)?;
                }
            }
            self.result
                .events
                .push(RunEvent { time_s: self.time, kind: EventKind::Removal { event: event.id.clone() } });
        }
        if any {
            self.system.pack();
            connect(&mut self.contacts, &self.system, &self.latent, &self.crushed);
            if was_related {
                self.relate();
            }
            self.forces();
        }
        Ok(())
    }

    /// Takes a bushing of the file away.
    fn release(&mut self, bushing: usize) {
        if let Some(joint) = self.latent.bushings[bushing].map(|i| &mut self.system.joints[i])
            && joint.alive
        {
            self.released += joint.open();
        }
    }

    /// Multiplies the capacities of the curves of a bushing of the file.
    pub(super) fn weaken(&mut self, bushing: usize, factor: f64) -> Result<(), SolveError> {
        self.strength[bushing] *= factor;
        let (share, given, curves) =
            (self.strength[bushing], &self.file.bushings[bushing], &self.file.curves);
        match self.latent.bushings[bushing] {
            None => self.latent.weaken(given, bushing, share, curves)?,
            Some(running) => self.system.set_strength(running, given, share, curves)?,
        }
        Ok(())
    }

    /// Brings momenta of bodies that have inertia together to the end of the step, with what breaks there: until then it has pulled at them. Forces are known but for what they share.
    fn bring_to_the_end(&mut self) {
        if self.system.relative.is_some() {
            self.end_relating();
        } else if !self.system.shared.is_empty() {
            let plain: Vec<[math::V3; 2]> = self.system.bodies.iter().map(|b| [b.force, b.torque]).collect();
            self.system.share_forces();
            self.synchronise();
            for (body, [force, torque]) in self.system.bodies.iter_mut().zip(plain) {
                (body.force, body.torque) = (force, torque);
            }
        }
    }

    pub(super) fn synchronise(&mut self) {
        let n = self.system.count();
        for body in &mut self.system.bodies[..n] {
            (body.p, body.l) = step::synchronised(body, 0.5 * self.last_step);
        }
        self.last_step = 0.0;
    }

    /// The same with what contacts do in that half of a step where they go on bearing and bodies were not `resting`, as long as bodies have no inertia together: contacts act on their masses alone.
    fn synchronise_held(&mut self) {
        let h = self.last_step;
        self.synchronise();
        if h > 0.0 && self.system.shared.is_empty() && self.system.relative.is_none() {
            let Self { system, contacts, moving, resting, .. } = self;
            contacts.energy.normal_j += step::bear_half(system, contacts, moving, resting, h);
        }
    }

    fn remove_body(&mut self, i: usize) {
        if !self.system.data[i].alive {
            return;
        }
        self.released += step::kinetic_j(&self.system.bodies[i], &self.system.data[i], 0.5 * self.last_step)
            + self.gravity_energy(i);
        self.system.data[i].alive = false;
        let body = &mut self.system.bodies[i];
        (body.p, body.l, body.v, body.w, body.w_body) = ([0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]);
        for joint in self.system.joints.iter_mut().filter(|j| j.alive && (j.a == i || j.b == i)) {
            self.released += joint.open();
        }
    }

    pub(super) fn gravity_energy(&self, i: usize) -> f64 {
        let rise = math::sub(self.system.bodies[i].x, self.origin[i]);
        -self.system.data[i].mass * math::dot(self.system.gravity, rise)
    }
}
