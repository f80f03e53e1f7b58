//! What of a mechanism changes from step to step and by events: the history of its hinges, and what is taken away or weakened.

use super::{Motion, STATE};
use crate::mbs::ideal::bushing::Held;
use crate::mbs::ideal::force::Acting;

impl Motion {
    /// Tells bushings on ideal joints the forces of these.
    pub(super) fn feel(&mut self) {
        for i in 0..self.bushings.len() {
            if let Some(id) = self.bushings[i].joint() {
                let place = self.ids.iter().position(|j| *j == id);
                let [force, _] = place.map_or([[0.0; 3]; 2], |j| self.reaction(j));
                self.bushings[i].feel(force, &self.poses);
            }
        }
    }

    /// Lets bushings on ideal joints resist under the forces that these have in the rate that was taken last; whether there are any.
    pub fn settle(&mut self) -> bool {
        self.bushings.iter_mut().for_each(Held::settle);
        self.bushings.iter().any(|b| b.joint().is_some())
    }

    /// What is evaluated next is `span_s` after the last step's end.
    pub fn pace(&mut self, span_s: f64) {
        self.bushings.iter_mut().for_each(|b| b.pace(span_s));
    }

    /// Takes the state whose rate was taken last into the history of hinges. Those that are beyond their fracture open, with their joints; their places in
    /// the mechanism.
    pub fn commit(&mut self) -> Vec<usize> {
        let (mut broken, mut opened) = (Vec::new(), Vec::new());
        for (force, id) in self.forces.iter_mut().zip(&self.force_ids) {
            let flowed = force.has_flowed();
            let committed = force.commit(&self.poses, &self.laws);
            if !flowed && force.has_flowed() {
                self.yielded.push(*id);
            }
            if committed.anew || committed.lost {
                self.confused.push(*id);
            }
            if committed.beyond.is_some_and(|beyond| beyond >= 0.0) {
                broken.push(*id);
                self.lost_j += force.elastic_j(&self.poses, &self.laws);
                if let Acting::Hinge { joint: Some(joint), .. } = force {
                    opened.push(*joint);
                }
            }
        }
        for (bushing, id) in self.bushings.iter_mut().zip(&self.bushing_ids) {
            let flowed = bushing.has_flowed();
            let breaks = bushing.commit(&self.poses);
            if !flowed && bushing.has_flowed() {
                self.yielded.push(*id);
            }
            if let Some(by_tension) = breaks {
                broken.push(*id);
                self.lost_j += bushing.at(&self.poses, 0.0).0[0];
                self.torn.extend(by_tension.then_some(*id));
                opened.extend(bushing.joint());
            }
        }
        if !broken.is_empty() {
            self.release(&opened, &broken);
        }
        broken
    }

    /// Whether a hinge began or ceased to flow on the way from what was committed to the state whose rate was taken last.
    pub fn has_turned_over(&self) -> bool {
        self.forces.iter().any(Acting::has_turned_over)
    }

    /// Work of flow that a step \[s\] to the state whose rate was taken last leaves out, as hinges and bushings turn back in it \[J\].
    pub fn turned_back_j(&self, step: f64) -> f64 {
        let forces = self.forces.iter().map(|f| f.turned_back_j(&self.poses, step));
        let bushings = self.bushings.iter().map(|b| b.turned_back_j(&self.poses, step));
        forces.chain(bushings).sum()
    }

    /// Takes joints and forces away, by their places in the mechanism.
    pub fn release(&mut self, joints: &[usize], forces: &[usize]) {
        let of = |list: &[usize], id: &usize| !list.contains(id);
        self.end(forces);
        let ending = self.forces.iter().zip(&self.force_ids).filter(|(_, id)| !of(forces, id));
        self.spent_j += ending.map(|(f, _)| f.dissipated_j()).sum::<f64>();
        let ending = self.bushings.iter().zip(&self.bushing_ids).filter(|(_, id)| !of(forces, id));
        self.spent_j += ending.map(|(b, _)| b.at(&self.poses, 0.0).0[1]).sum::<f64>();
        let both = std::mem::take(&mut self.bushings).into_iter().zip(std::mem::take(&mut self.bushing_ids));
        (self.bushings, self.bushing_ids) = both.filter(|(_, id)| of(forces, id)).unzip();
        let both = std::mem::take(&mut self.forces).into_iter().zip(std::mem::take(&mut self.force_ids));
        (self.forces, self.force_ids) = both.filter(|(_, id)| of(forces, id)).unzip();
        if !joints.is_empty() {
            let both = std::mem::take(&mut self.joints).into_iter().zip(std::mem::take(&mut self.ids));
            (self.joints, self.ids) = both.filter(|(_, id)| of(joints, id)).unzip();
            self.link();
        }
    }

    /// Keeps the rotations of hinges and bushings that are about to go, by their places in the mechanism.
    fn end(&mut self, forces: &[usize]) {
        let goes = |id: &usize| forces.contains(id);
        for (force, id) in self.forces.iter().zip(&self.force_ids).filter(|(_, id)| goes(id)) {
            if let Some(turn) = force.turn(&self.poses, &self.laws) {
                self.ended.insert(*id, [turn.rotation_rad, force.plastic_rad()]);
            }
        }
        for (bushing, id) in self.bushings.iter().zip(&self.bushing_ids).filter(|(_, id)| goes(id)) {
            if let Some(turn) = bushing.at(&self.poses, 0.0).1 {
                let [first, second] = turn.rotation_rad;
                self.ended.insert(*id, [[first, second, 0.0], [bushing.plastic_rad(), 0.0, 0.0]]);
            }
        }
    }

    /// Takes a body away with all that is attached to it: it stops where it is in the state. The places in the mechanism of the joints and forces that go with it.
    pub fn remove(&mut self, body: usize, state: &mut [f64]) -> [Vec<usize>; 2] {
        self.gone[body] = true;
        state[STATE * body + 7..STATE * (body + 1)].fill(0.0);
        let joints = self.joints.iter().zip(&self.ids);
        let joints: Vec<usize> =
            joints.filter(|(j, _)| j.bodies.contains(&body)).map(|(_, id)| *id).collect();
        let forces = self.forces.iter().zip(&self.force_ids);
        let forces: Vec<usize> =
            forces.filter(|(f, _)| f.bodies().contains(&body)).map(|(_, id)| *id).collect();
        let bushings = self.bushings.iter().zip(&self.bushing_ids);
        let bushings = bushings.filter(|(b, _)| b.bodies.contains(&body)).map(|(_, id)| *id);
        let forces: Vec<usize> = forces.into_iter().chain(bushings).collect();
        self.release(&joints, &forces);
        [joints, forces]
    }

    /// Whether a body was taken away.
    pub fn is_gone(&self, body: usize) -> bool {
        self.gone[body]
    }

    /// A force by its place in the mechanism, if it still acts.
    pub fn force_mut(&mut self, id: usize) -> Option<&mut Acting> {
        let at = self.force_ids.iter().position(|f| *f == id)?;
        Some(&mut self.forces[at])
    }

    /// Multiplies the strength of a hinge or bushing by its place, if it is there.
    pub fn weaken(&mut self, id: usize, by: f64) {
        if let Some(at) = self.bushing_ids.iter().position(|b| *b == id) {
            let flowed = self.bushings[at].has_flowed();
            self.bushings[at].weaken(by, &self.poses);
            if !flowed && self.bushings[at].has_flowed() {
                self.yielded.push(id);
            }
        } else if let Some(force) = self.force_mut(id) {
            force.weaken(by);
        }
    }

    /// Places in the mechanism of the joints that are there.
    pub fn joint_ids(&self) -> &[usize] {
        &self.ids
    }

    /// How far a hinge is beyond its fracture at the state that was taken, at most \[rad\]; `None` without hinges.
    pub fn beyond(&self) -> Option<f64> {
        let of_bushing = |b: &Held| if b.is_broken() { 0.0 } else { -1.0 };
        let bushings = self.bushings.iter().map(of_bushing);
        self.forces.iter().filter_map(|f| f.beyond(&self.laws)).chain(bushings).reduce(f64::max)
    }
}
