//! Bodies that part at a latent bushing while the model runs.

use super::setup::{choose_step, connect, usable_step};
use super::{Run, step};
use crate::mbs::contact::{ContactEnergy, ContactSet};
use crate::mbs::error::SolveError;
use crate::mbs::frequency;
use crate::mbs::latent::Parting;
use crate::mbs::math;
use crate::mbs::result::{EventKind, RunEvent};
use crate::mbs::sleep::Sleep;
use std::borrow::Cow;

impl Run<'_> {
    /// Parts the bodies whose latent bushings bear as much as they can in the present poses; whether there were any. Forces are known before and after.
    pub(super) fn part_under_load(&mut self) -> Result<bool, SolveError> {
        let mut any = false;
        while let Some(parting) = self.latent.overloaded(&self.system) {
            self.part(&parting)?;
            any = true;
        }
        Ok(any)
    }

    /// Keeps the bodies as they are before the contacts of a step whose kick is done, and who is asleep.
    pub(super) fn remember(&mut self) {
        self.untouched.clone_from(&self.system.bodies);
        self.note_resting();
    }

    /// Notes who is asleep.
    pub(super) fn note_resting(&mut self) {
        self.resting.clear();
        self.resting.extend(self.system.data.iter().map(|d| d.asleep));
    }

    /// The bodies before a step of `h` \[s\], from those before its contacts.
    fn before_kick(&mut self, h: f64) {
        self.before.clone_from(&self.untouched);
        let kick = 0.5 * (self.last_step + h);
        for ((body, data), resting) in self.before.iter_mut().zip(&self.system.data).zip(&self.resting) {
            if data.alive && !resting {
                step::push(body, -kick);
            }
        }
    }

    /// Parts a body that the contacts of a step of `h` \[s\] would overload, and takes the step back; whether there was one.
    pub(super) fn part_under_contact(
        &mut self,
        h: f64,
        (energy, opened): (ContactEnergy, f64),
    ) -> Result<bool, SolveError> {
        self.latent.feel(&self.system, Some(&self.contacts), h);
        self.before_kick(h);
        // the loads are those of the poses before gaps were opened
        std::mem::swap(&mut self.before, &mut self.system.bodies);
        let Some(parting) = self.latent.struck(&self.system) else {
            std::mem::swap(&mut self.before, &mut self.system.bodies);
            self.latent.keep();
            return Ok(false);
        };
        // who was woken for this step goes on from rest
        for (i, resting) in self.resting.iter().enumerate() {
            if *resting && !self.system.data[i].asleep {
                step::push(&mut self.system.bodies[i], -0.5 * self.last_step);
            }
        }
        self.latent.drop_step();
        self.contacts.take_back(energy);
        self.opened = opened;
        self.displaced.clear();
        self.part(&parting)?;
        Ok(true)
    }

    /// Parts the body of a latent bushing of the file there, by an event.
    pub(super) fn part_at(&mut self, bushing: usize) -> Result<(), SolveError> {
        if self.latent.is_held(bushing) {
            let parting = self.latent.parting(&self.system, bushing);
            self.part(&parting)?;
        }
        Ok(())
    }

    /// Makes a body of the file one of its own, by an event.
    pub(super) fn part_from_others(&mut self, body: usize) -> Result<(), SolveError> {
        let id = &self.file.bodies[body].id;
        for (b, bushing) in self.file.bushings.iter().enumerate() {
            if bushing.body_b == *id || bushing.body_a.as_ref() == Some(id) {
                self.part_at(b)?;
            }
        }
        Ok(())
    }

    #[cold]
    fn part(&mut self, parting: &Parting) -> Result<(), SolveError> {
        self.sleep.rouse_all(&mut self.system, &mut self.contacts, 0.5 * self.last_step);
        (self.is_loose, self.is_soft) = (true, false);
        self.end_all_sharing();
        self.synchronise();
        let was: Vec<Option<usize>> = self.latent.bushings.clone();
        let (system, model) = self.latent.part(self.file, &self.system, parting)?;
        self.keep_marks(&was, system.joints.len());
        // a member that parts between its ends
        let [before, after] = [&self.system, &system].map(|s| s.carried_j().iter().sum::<f64>());
        self.released += before - after;
        (self.system, self.model) = (system, Cow::Owned(model));
        let taken_j = self.sleep.taken_j;
        self.sleep = Sleep::new(self.file.settings.sleep_speed_m_s, self.system.count());
        self.sleep.taken_j = taken_j;
        let (energy, work) = (self.contacts.energy, self.contacts.work);
        let crushed: Vec<_> = self.contacts.crushed().collect();
        self.contacts = ContactSet::new(&self.model, self.options.contact);
        (self.contacts.energy, self.contacts.work) = (energy, work);
        self.contacts.resume_crushed(crushed.into_iter());
        connect(&mut self.contacts, &self.system, &self.latent, &self.crushed);
        self.origin = self.centers();
        self.choose_step()?;
        for (bushing, _) in &parting.live {
            if self.strength[*bushing] != 1.0 {
                self.weaken(*bushing, 1.0)?;
            }
        }
        self.system.pack();
        self.note_parting(parting);
        self.forces();
        for (bushing, _) in &parting.live {
            if let Some(joint) = self.latent.bushings[*bushing].map(|i| &self.system.joints[i]) {
                self.released -= joint.elastic_j + joint.hinge.dissipated_j + joint.crush_j;
            }
        }
        self.soften();
        Ok(())
    }

    /// The step with what has parted.
    fn choose_step(&mut self) -> Result<(), SolveError> {
        let highest = frequency::highest_rad_s(&mut self.system);
        self.step_limit =
            choose_step(&self.model, highest, self.share).map_err(|e| usable_step(e, self.file, highest))?;
        Ok(())
    }

    /// Which hinges have yielded, in the order of the joints that run now.
    fn keep_marks(&mut self, was: &[Option<usize>], count: usize) {
        let (mut yielded, mut warned) = (vec![[false; 2]; count], vec![false; count]);
        for (old, new) in was.iter().zip(&self.latent.bushings) {
            if let (Some(old), Some(new)) = (old, new) {
                (yielded[*new], warned[*new]) = (self.yielded[*old], self.range_warned[*old]);
            }
        }
        (self.yielded, self.range_warned) = (yielded, warned);
    }

    /// Where the bodies that run were at `t = 0` \[m\].
    fn centers(&self) -> Vec<math::V3> {
        let of = |own: &Vec<usize>| {
            let mass = |i: &usize| self.file.bodies[*i].mass_kg;
            let whole: f64 = own.iter().map(mass).sum();
            own.iter().fold([0.0; 3], |sum, i| math::axpy(sum, mass(i) / whole, self.start[*i]))
        };
        self.latent.pieces.iter().map(of).collect()
    }

    /// That latent bushings could not give way in this run, if there are any.
    pub(super) fn remark_on_held(&self) -> Option<String> {
        let latent = self.file.bushings.iter().filter(|b| b.latent.is_some()).count();
        (self.options.hold_latent && latent > 0).then(|| {
            format!(
                "latent hinges are switched off: what could give way (bushings: {latent}) holds whatever it would have to bear, which is for comparison only"
            )
        })
    }

    /// Writes down how near to their resistance the latent bushings came, and how often they were looked at.
    pub(super) fn close_latent(&mut self) {
        [self.result.body_work.looks, self.result.body_work.bounded_looks] = self.latent.looks();
        let latent = self.file.bushings.iter().enumerate().filter(|(_, b)| b.latent.is_some());
        for (record, (b, _)) in self.result.latent.iter_mut().zip(latent) {
            record.largest_share = self.latent.peak(b);
        }
    }

    fn note_parting(&mut self, parting: &Parting) {
        for (bushing, _) in &parting.live {
            let joint = self.file.bushings[*bushing].id.clone();
            if let Some(record) = self.result.latent.iter_mut().find(|r| r.joint == joint) {
                record.live_s = Some(self.time);
            }
            let with = (*bushing != parting.cause).then(|| self.file.bushings[parting.cause].id.clone());
            self.result.events.push(RunEvent { time_s: self.time, kind: EventKind::Live { joint, with } });
        }
    }
}
