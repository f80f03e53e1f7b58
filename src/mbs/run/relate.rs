//! When inertia that bodies have together begins and ends: that against relative motion, and that of floors where contacts touch them.

use super::{LARGEST_RELATED_STEP_S, Run, step};
use crate::mbs::contact::ContactEnergy;
use crate::mbs::relative_mass::spins;
use crate::mbs::system::BodyState;
use crate::mbs::{frequency, math};

/// Changes of a velocity \[m/s\] and an angular velocity \[rad/s\] in a step up to which a contact is none to bodies with inertia against relative motion: a wall that stands beside a column.
const LIGHT_TOUCH: [f64; 2] = [0.02, 0.02];
/// Energy that inertia against relative motion may have in springs that flow, as a share of what is turned over: beyond that it ends for good, as these ask for none and it holds back what they let go. Generated models have 3e-4 at most.
const MOST_IN_FLOW: f64 = 2e-3;
/// Energy that inertia against relative motion may have at the start, as a share of what is turned over: as much as an error that is told.
const MOST_AT_BEGIN: f64 = 1e-3;
/// Share of the energy turned over that the forces of half a step may have in them, which falls with the square of the step: by as much a full step may seem to lose after a charge. By what share of a step it is shortened at most.
const VIBRATION: f64 = 7e-3;
const FINEST: f64 = 0.5;
/// Share of the stability limit that steps have once something has turned. Vibrations of the springs have `1 / sqrt(1 - (ωh/2)²)` of their amplitude in a leapfrog, 1.3 times here and 1.7 times with 0.8 of the limit, and hinges that flow all the time would flow and break by it: the first contact of s1-003, 1.5265 s with steps of
/// 0.05 ms, is at 1.529 s with this and at 1.502 s with that.
const FALLING: f64 = 0.64;
/// By how much longer steps have to be for inertia against relative motion.
const WORTH_IT: f64 = 1.2;

impl Run<'_> {
    /// Gives the bodies inertia against relative motion in their present poses, if the model asks for it, it has not ended for good, and it makes steps longer. Forces are known but for inertia that bodies have together.
    pub(super) fn relate(&mut self) {
        let Some(most) = self.file.settings.relative_inertia_rad_s else { return };
        let fraction = if self.is_falling { FALLING } else { frequency::STEP_FRACTION };
        let step = self.share * (fraction * 2.0 / most).min(LARGEST_RELATED_STEP_S);
        let is_worth_it = step > WORTH_IT * self.plain_limit();
        let spins = spins(step, &self.system.bodies[..self.system.count()], &self.system.data);
        if self.is_loose || self.file.settings.time_step_s.is_some() || !is_worth_it || spins {
            return;
        }
        self.released += self.system.relate(Some(most), self.last_step);
        if self.system.relative.is_some() {
            self.step_limit = step;
        }
    }

    /// The same at `t = 0`, unless the velocities of the file strain stiff springs: inertia that moves with them at once would have made energy, and vibrate with it faster than steps resolve.
    pub(super) fn begin_relating(&mut self) {
        let released_j = self.released;
        self.relate();
        let (made_j, whole_j) = (released_j - self.released, self.books.turned_j());
        if self.system.relative.is_none() || made_j <= MOST_AT_BEGIN * whole_j {
            return;
        }
        self.is_loose = true;
        self.system.relate(None, self.last_step);
        (self.released, self.step_limit) = (released_j, self.plain_limit());
        self.result.warnings.push(format!(
            "settings.relative_inertia_rad_s is not used: the velocities at t = 0 strain the bushings, and inertia against that would have {:.1e} of the energy; steps are as short as without",
            made_j / whole_j
        ));
    }

    /// Ends that for good once springs that flow have much of it. Forces are known.
    pub(super) fn look_at_flow(&mut self) {
        let Some(most) = self.file.settings.relative_inertia_rad_s else { return };
        if self.system.relative.is_some() {
            let flowing_j = self.system.flowing_j(most, 0.5 * self.last_step);
            self.is_loose |= flowing_j > MOST_IN_FLOW * self.books.turned_j();
        }
    }

    /// Ends that, until [`Self::relate`]. The last step is brought to its end before: half a step as long of the forces alone would set stiff springs vibrating.
    pub(super) fn end_relating(&mut self) {
        if self.system.relative.is_some() {
            self.system.share_forces();
            self.synchronise();
            self.system.give_back_forces();
            self.released += self.system.relate(None, self.last_step);
            self.step_limit = self.plain_limit();
        }
    }

    /// Ends all sharing of inertia, in the present poses; inertia against relative motion too once it may not begin again.
    pub(super) fn end_all_sharing(&mut self) {
        if self.system.relative.is_some() || !self.system.shared.is_empty() {
            self.forces_with(|_, _| true);
        }
    }

    /// Chooses the step up to the next output or event by what the forces add to the kinetic energy in half of it: shorter while that is much of what is turned over. Forces are known.
    pub(super) fn resolve(&mut self) {
        self.finer_step = f64::INFINITY;
        if self.system.relative.is_some() {
            let kick_j = self.system.kick_j(0.5 * self.step_limit);
            let share = (VIBRATION * self.books.turned_j() / kick_j).sqrt();
            self.finer_step = share.max(FINEST) * self.step_limit;
        }
    }

    /// The step without inertia against relative motion \[s\].
    fn plain_limit(&self) -> f64 {
        if self.system.shared.is_empty() {
            self.shared_limit.max(self.alone_limit)
        } else {
            self.shared_limit
        }
    }

    /// Takes a step of `h` \[s\] back in which contacts touch bodies that have inertia against relative motion, which ends. Whether there were any.
    pub(super) fn let_loose(&mut self, h: f64, books: (ContactEnergy, f64)) -> bool {
        let changed = |(now, before): (&BodyState, &BodyState)| {
            math::norm(math::sub(now.v, before.v)) > LIGHT_TOUCH[0]
                || math::norm(math::sub(now.w, before.w)) > LIGHT_TOUCH[1]
        };
        if !self.system.bodies.iter().zip(&self.untouched).any(changed) {
            return false;
        }
        let touched = self.take_back(h, books);
        self.is_loose = true;
        self.forces_with(|s, all| s.is_touched(&touched, &all.bodies));
        true
    }

    /// Takes a step of `h` \[s\] back in which contacts touch bodies that share their inertia, and kicks all bodies anew without that. Whether there were any.
    pub(super) fn part_touched(&mut self, h: f64, books: (ContactEnergy, f64)) -> bool {
        let now = &self.system.bodies;
        if !self.system.shared.iter().any(|s| s.is_touched(now, &self.untouched)) {
            return false;
        }
        let touched = self.take_back(h, books);
        let kick = 0.5 * (self.last_step + h);
        self.forces_with(|s, all| s.is_touched(&touched, &all.bodies));
        step::kick(&mut self.system, kick, h);
        true
    }

    /// Takes back the kick and the contacts of a step of `h` \[s\]; returns the bodies after them.
    fn take_back(&mut self, h: f64, (energy, opened): (ContactEnergy, f64)) -> Vec<BodyState> {
        let mut touched = std::mem::take(&mut self.untouched);
        std::mem::swap(&mut self.system.bodies, &mut touched);
        self.contacts.take_back(energy);
        self.opened = opened;
        self.displaced.clear();
        let kick = 0.5 * (self.last_step + h);
        for (body, data) in self.system.bodies.iter_mut().zip(&self.system.data) {
            if data.alive && !data.asleep {
                step::push(body, -kick);
            }
        }
        touched
    }
}
