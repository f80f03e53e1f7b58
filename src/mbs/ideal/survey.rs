//! What is asked of a mechanism beside its motion: energies and hinges, reactions, the highest frequency.

use super::bushing::{BushingState, Held};
use super::force::{Acting, HingeState};
use super::joint::{Pose, is_ground, pose_of};
use super::motion::{Motion, STATE, WORKS, read};
use crate::mbs::math::{M3, V3, axpy, cross, dot, mul, mul_t, norm, scale, sub};

/// Steps of the power iteration for the highest frequency, and the margin on what it finds.
const ITERATIONS: usize = 60;
const MARGIN: f64 = 1.05;

/// Energies and hinges of a mechanism at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// Kinetic energy \[J\].
    pub kinetic_j: f64,
    /// Potential energy of gravity, zero at the origin \[J\].
    pub gravity_j: f64,
    /// Elastic energy of springs and hinges \[J\].
    pub elastic_j: f64,
    /// Plastic work of all hinges, also those that fractured \[J\].
    pub plastic_j: f64,
    /// Elastic energy that fractured hinges had \[J\].
    pub lost_j: f64,
    /// Work of all applied forces, springs and hinges included, gravity not \[J\].
    pub work_j: f64,
    /// The part of it that applied forces and dampers do \[J\].
    pub given_j: f64,
    /// Hinges and torsion springs by their place among the forces of the mechanism.
    pub hinges: Vec<(usize, HingeState)>,
    /// Bushings with curves by their place behind the forces of the mechanism.
    pub bushings: Vec<(usize, BushingState)>,
}

impl Observed {
    /// All energies but the potential one of gravity and what fractured hinges had \[J\].
    fn own_j(&self) -> f64 {
        self.kinetic_j + self.elastic_j + self.plastic_j
    }

    /// All energies, less the work of dampers and applied forces \[J\].
    fn total_j(&self) -> f64 {
        self.kinetic_j + self.gravity_j + self.elastic_j + self.plastic_j + self.lost_j - self.given_j
    }
}

impl Motion {
    /// Energies and hinges at a state that follows on what was committed, at a share of the step that was evaluated last.
    pub fn observe(&self, state: &[f64], share: f64) -> Observed {
        let poses: Vec<Pose> = state.chunks_exact(STATE).map(read).collect();
        let [mut kinetic_j, mut gravity_j] = [0.0; 2];
        for (b, pose) in poses.iter().enumerate().filter(|(b, _)| !self.gone[*b]) {
            let own = mul_t(&pose.r, pose.w);
            kinetic_j += 0.5 * (self.mass[b] * dot(pose.v, pose.v) + dot(own, mul(&self.inertia[b], own)));
            gravity_j -= self.mass[b] * dot(self.gravity, pose.x);
        }
        let hinges: Vec<(usize, HingeState)> = self
            .forces
            .iter()
            .zip(&self.force_ids)
            .filter_map(|(f, id)| Some((*id, f.turn(&poses, &self.laws)?)))
            .collect();
        let others =
            self.forces.iter().filter(|f| !matches!(f, Acting::Hinge { .. } | Acting::Torsion { .. }));
        let springs_j: f64 = others.map(|f| f.elastic_j(&poses, &self.laws)).sum();
        let bushings: Vec<(usize, (_, Option<BushingState>))> =
            self.bushing_ids.iter().copied().zip(self.bushings.iter().map(|b| b.at(&poses, share))).collect();
        Observed {
            kinetic_j,
            gravity_j,
            elastic_j: springs_j
                + hinges.iter().map(|(_, h)| h.elastic_j).sum::<f64>()
                + bushings.iter().map(|(_, (j, _))| j[0]).sum::<f64>(),
            plastic_j: self.spent_j
                + hinges.iter().map(|(_, h)| h.dissipated_j).sum::<f64>()
                + bushings.iter().map(|(_, (j, _))| j[1]).sum::<f64>(),
            lost_j: self.lost_j,
            work_j: state[state.len() - WORKS],
            given_j: state[state.len() - 1],
            hinges,
            bushings: bushings.into_iter().filter_map(|(id, (_, state))| Some((id, state?))).collect(),
        }
    }

    /// All energies of a state that follows on what was committed, less the work of dampers and applied forces \[J\]: constant, but for errors and what contacts and joints take.
    pub fn total_j(&self, state: &[f64]) -> f64 {
        self.observe(state, 0.0).total_j()
    }

    /// Kinetic energy of what accelerations, in the rates of a state, add to velocities in a time \[s, J\].
    pub fn kick_j(&self, rates: &[f64], time_s: f64) -> f64 {
        let of = |b: usize| {
            let at = |i: usize| time_s * rates[STATE * b + i];
            let w = mul_t(&self.poses[b].r, [at(10), at(11), at(12)]);
            let v = [at(7), at(8), at(9)];
            0.5 * (self.mass[b] * dot(v, v) + dot(w, mul(&self.inertia[b], w)))
        };
        (0..self.mass.len()).filter(|b| !self.is_gone(*b)).map(of).sum()
    }

    /// What a step from one state to another, in which no joint opens and nothing touches, changes of all energies, as a share of those that are not potential energy of gravity, and of that in `rest_m` of
    /// fall at least.
    pub fn energy_error(&self, [from, to]: [&[f64]; 2], rest_m: f64) -> f64 {
        let [before, after] = [(from, 0.0), (to, 1.0)].map(|(state, share)| self.observe(state, share));
        (after.total_j() - before.total_j()).abs() / self.compared_j(&[before, after], rest_m)
    }

    /// Share of the same energies that flow in a step \[s\] would have that turns back in it.
    pub fn turned_back(&self, [from, to]: [&[f64]; 2], rest_m: f64, step: f64) -> f64 {
        let lost_j = self.turned_back_j(step);
        if lost_j == 0.0 {
            return 0.0;
        }
        let both = [(from, 0.0), (to, 1.0)].map(|(state, share)| self.observe(state, share));
        lost_j / self.compared_j(&both, rest_m)
    }

    /// What errors of the energy are compared with \[J\].
    fn compared_j(&self, states: &[Observed; 2], rest_m: f64) -> f64 {
        let rest_j = rest_m * norm(self.gravity) * self.mass.iter().sum::<f64>();
        states.iter().map(Observed::own_j).fold(rest_j, f64::max)
    }

    /// What the balance of a run keeps constant of a state that follows on what was committed: [`Motion::total_j`], with bushings the work of all forces in place of what
    /// they store and take \[J\].
    pub fn kept_j(&self, state: &[f64]) -> f64 {
        if self.bushings.is_empty() {
            self.total_j(state)
        } else {
            self.energy_j(state) - state[state.len() - WORKS]
        }
    }

    /// A bound on the highest angular frequency of springs and hinges \[rad/s\]. With the mass of each body shared among the springs that pull at it, in the ratio of
    /// what each would make of it alone, no mode is faster than the fastest spring on its shares: `ω² <= max (W_a + W_b)` over springs, `W` the sum of `k / m` of a
    /// body's springs. Joints only lower it.
    pub fn frequency_bound(&self) -> f64 {
        let smallest = |m: &M3| nalgebra::Matrix3::from_fn(|i, j| m[i][j]).symmetric_eigenvalues().min();
        let turning: Vec<f64> = self.inertia.iter().map(|i| 1.0 / smallest(i)).collect();
        let springs: Vec<(Vec<usize>, f64, [Option<f64>; 2])> = self
            .forces
            .iter()
            .filter_map(|f| f.stiffness(&self.poses, &self.laws).map(|(k, arms)| (f.bodies(), k, arms)))
            .collect();
        let of_bushing = |b: &Held| {
            b.springs(&self.poses).map(|(k, arms)| (b.bodies.to_vec(), k, arms)).collect::<Vec<_>>()
        };
        let springs: Vec<_> = springs.into_iter().chain(self.bushings.iter().flat_map(of_bushing)).collect();
        let mut own = vec![0.0; self.mass.len()];
        for (bodies, stiffness, arms) in &springs {
            for (body, arm) in bodies.iter().zip(arms).filter(|(b, _)| !is_ground(**b)) {
                let soft = arm.map_or(turning[*body], |r2| 1.0 / self.mass[*body] + r2 * turning[*body]);
                own[*body] += stiffness * soft;
            }
        }
        let of = |bodies: &[usize]| bodies.iter().filter(|b| !is_ground(**b)).map(|b| own[*b]).sum::<f64>();
        springs.iter().map(|(bodies, ..)| of(bodies)).fold(0.0, f64::max).sqrt()
    }

    /// Highest angular frequency of springs and elastic hinges under the joints at the state that was taken \[rad/s\]: by power iteration with a margin of 5 %, and at most
    /// the bound.
    pub fn frequency(&mut self) -> f64 {
        let bound = self.frequency_bound();
        if bound == 0.0 {
            return 0.0;
        }
        // a start without symmetry, and the same in every run
        let mut motion: Vec<[V3; 2]> = (0..self.mass.len())
            .map(|b| {
                let at = |i: usize| (libm::sin(12.9898 * (6 * b + i + 1) as f64) * 43_758.545).fract();
                [[at(0), at(1), at(2)], [at(3), at(4), at(5)]]
            })
            .collect();
        let mut square = 0.0;
        for _ in 0..ITERATIONS {
            self.loads.fill([[0.0; 3]; 2]);
            for force in &self.forces {
                force.respond(&self.poses, &self.laws, &motion, &mut self.loads);
            }
            for bushing in &self.bushings {
                bushing.respond(&self.poses, &motion, &mut self.loads);
            }
            for (b, load) in self.loads.iter_mut().enumerate() {
                *load = [scale(-1.0 / self.mass[b], load[0]), scale(-1.0, mul(&self.inverse[b], load[1]))];
            }
            self.accept(|_| 0.0);
            let size = |m: &[[V3; 2]], mass: &[f64], r: &[Pose], inertia: &[M3]| {
                let of = |(b, [v, w]): (usize, &[V3; 2])| {
                    let own = mul_t(&r[b].r, *w);
                    mass[b] * dot(*v, *v) + dot(own, mul(&inertia[b], own))
                };
                m.iter().enumerate().map(of).sum::<f64>().sqrt()
            };
            let [before, after] =
                [&motion, &self.loads].map(|m| size(m, &self.mass, &self.poses, &self.inertia));
            if after == 0.0 {
                return 0.0;
            }
            square = after / before;
            for (to, [v, w]) in motion.iter_mut().zip(&self.loads) {
                *to = [scale(1.0 / after, *v), scale(1.0 / after, *w)];
            }
        }
        bound.min(MARGIN * square.sqrt())
    }

    /// Force and torque about its point of each joint that is there on its second body, global \[N, N m\], at the state whose rate was taken last, with what contacts asked for in the mean of the last step.
    pub fn reactions(&self) -> Vec<[V3; 2]> {
        (0..self.joints.len()).map(|j| self.reaction_to(j, |row| self.borne(row).iter().sum())).collect()
    }

    /// The same of one joint without contacts.
    pub(super) fn reaction(&self, j: usize) -> [V3; 2] {
        self.reaction_to(j, |row| self.borne(row)[0])
    }

    fn reaction_to(&self, j: usize, multiplier: impl Fn(usize) -> f64) -> [V3; 2] {
        let joint = &self.joints[j];
        let (mut force, mut torque) = ([0.0; 3], [0.0; 3]);
        let side = usize::from(!is_ground(joint.bodies[1]));
        for r in self.first[j]..self.first[j + 1] {
            let [linear, angular] = self.rows[r].of[side];
            let factor = if side == 1 { -multiplier(r) } else { multiplier(r) };
            (force, torque) = (axpy(force, factor, linear), axpy(torque, factor, angular));
        }
        let arm = joint.arm(side, pose_of(&self.poses, joint.bodies[side]));
        [force, sub(torque, cross(arm, force))]
    }
}
