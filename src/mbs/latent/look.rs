//! Which bodies part under what their latent bushings bear.

use super::bound::{Attached, Bound};
use super::demand::{self, Demand};
use super::{Latent, Parting};
use crate::mbs::math::V3;
use crate::mbs::system::System;

/// A body of several pieces.
#[derive(Debug, Clone)]
pub(super) struct Compound {
    /// The body in the running model.
    pub body: usize,
    /// Its latent bushings in the model file.
    pub bushings: Vec<usize>,
    /// Whether any of them is watched, and whether any is not yet.
    pub is_watched: bool,
    pub waits: bool,
    pub demand: Demand,
    /// Joints that are attached to it.
    pub attached: Vec<Attached>,
    /// Filtered loads of contacts on each piece, and those of the present step.
    pub contact: Vec<[V3; 2]>,
    pub now: Vec<[V3; 2]>,
    /// By how much what its bushings bear can have changed; none before the first look.
    pub bound: Option<Bound>,
}

impl Compound {
    /// Finds what its bushings bear in the present poses, with the contacts so far or those of the step.
    pub fn load(&mut self, system: &System, with_step: bool) {
        self.demand.start(system.bodies[self.body].w_body);
        for a in &self.attached {
            if system.joints[a.joint].alive {
                self.demand.add(a.piece, demand::pull(system, a.joint, a.is_second));
            }
        }
        let contact = if with_step { &self.now } else { &self.contact };
        for (piece, load) in contact.iter().enumerate() {
            self.demand.add(piece, *load);
        }
        self.demand.solve();
    }
}

impl Latent {
    /// The body that parts under the forces of the present poses and the contacts so far; none if all holds.
    pub fn overloaded(&mut self, system: &System) -> Option<Parting> {
        self.look(system, false)
    }

    /// The same with the contacts of the step after these poses.
    pub fn struck(&mut self, system: &System) -> Option<Parting> {
        self.look(system, true)
    }

    fn look(&mut self, system: &System, with_step: bool) -> Option<Parting> {
        let whole = self.whole.as_ref()?;
        let mut worst: Option<(f64, usize)> = None;
        for compound in &mut self.compounds {
            let data = &system.data[compound.body];
            if !compound.is_watched || !data.alive || data.asleep {
                continue;
            }
            if with_step && compound.now == compound.contact {
                continue;
            }
            let spin = system.bodies[compound.body].w_body;
            let is_asked = |l: usize| self.watched[compound.bushings[l]];
            let count = (0..compound.bushings.len()).filter(|l| is_asked(*l)).count() as u64;
            if !self.looks_always
                && let Some(bound) = &mut compound.bound
            {
                let contact = if with_step { &compound.now } else { &compound.contact };
                if bound.allows(system, &compound.attached, (contact, spin), is_asked) {
                    self.looks[1] += count;
                    continue;
                }
            }
            self.looks[0] += count;
            compound.load(system, with_step);
            let Compound { bushings, demand, attached, contact, now, bound, .. } = compound;
            let bound = bound.get_or_insert_with(|| Bound::new(system, demand, attached, (whole, bushings)));
            for (l, bushing) in bushings.iter().enumerate().filter(|(_, b)| self.watched[**b]) {
                let [force, moment] = demand.of(l);
                let joint = &whole.joints[*bushing];
                let used = joint.share_used(force, moment, &whole.tables);
                let peak = &mut self.peak[*bushing];
                *peak = peak.max(used);
                if used >= 1.0 && worst.is_none_or(|(most, _)| used > most) {
                    worst = Some((used, *bushing));
                }
                bound.note(l, -joint.outward * force[0], used, *peak, &whole.tables);
            }
            bound.keep(system, attached, if with_step { now } else { contact }, spin);
        }
        worst.map(|(_, cause)| self.parting(system, cause))
    }
}
