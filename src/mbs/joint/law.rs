//! The law of a compliant joint: force and moment along its axes, history and energies.

use super::{JointData, NO_TABLE, Pace};
use crate::base::piecewise::interpolate;
use crate::curve::CapacityTable;
use crate::curve::hinge::AxisLaw;
use crate::curve::onset::{Course, Search, added, flow, leaves};
use crate::curve::rate::{Rate, is_same};
use crate::mbs::math::{self, V3};
use crate::mbs::stance::{Chord, Stance};

/// Relative accuracy of an axial force that flows at a rate.
const TOLERANCE: f64 = 1e-13;

impl JointData {
    /// The law: force and moment along the joint axes, for a rotation vector in that frame; the history advances.
    #[inline]
    pub(in crate::mbs) fn resist(
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
        let lowest = if self.tensile_elongation > 0.0 { -self.tensile_capacity } else { f64::NEG_INFINITY };
        let admissible = match self.rate {
            Some(rate) => self.rated_force(rate, old, lowest),
            None => {
                self.harden(k[0]);
                self.axial_force.clamp(lowest, self.left * self.compressive_capacity)
            }
        };
        if admissible != self.axial_force {
            let flow = (self.axial_force - admissible) / k[0];
            self.axial_force = admissible;
            shortened += flow;
            self.crushed -= self.outward * flow;
            self.elongated += (-flow).max(0.0);
            self.pressed += flow.max(0.0);
            gap[0] += self.outward * flow;
            // at a rate it is at what that lets it bear as soon as it flows, stiff as it is
            let at_rest = if flow > 0.0 { bears } else { lowest };
            let capacity = if self.rate.is_some() { admissible } else { at_rest };
            let from = leaves(old, capacity, trial);
            let onset = from.map_or(0.0, |share| added(old, capacity, admissible, share));
            self.onset[0][0] = -self.outward * onset;
            self.course = Course::flowing(old, admissible, flow, from.map(|share| [share, capacity]));
        }
        self.crush_j += 0.5 * (old + self.axial_force) * shortened;
        let mut shifted = [-self.outward * closed, 0.0, 0.0];
        let known = (self.pace == Pace::Steps).then_some(old);
        self.hinge.axial_before_n = known;
        if let Some(beam) = &mut self.beam {
            beam.ends.axial_before_n = known;
            let across = beam.across();
            shifted[across] = at.gap[across] - beam.gap[across];
            (beam.chord, beam.gap) = (*chord, at.gap);
        }
        let bent = self.bend_beam(theta, &mut gap, tables);
        self.slip(&mut gap, &mut shifted);
        let [v1, v2] = self.shear.force;
        let local = [k[0] * gap[0], v1, v2];
        let moment = bent.unwrap_or_else(|| self.moments(theta, tables));
        self.elastic_j += 0.5 * (math::dot(local, gap) + moment[0] * theta[0]);
        self.begin_to_flow(before, [shifted, turned]);
        [math::add(local, self.onset[0]), math::add(moment, self.onset[1])]
    }

    /// Shear forces of the gap, which loses what is plastic of it; of joints that may slip also how they moved across in the step.
    #[inline]
    fn slip(&mut self, gap: &mut V3, shifted: &mut V3) {
        let [_, k1, k2] = self.translation;
        if self.shear.slips() {
            let was = |k: usize, stiffness: f64| {
                self.shear.slid[k] + if stiffness > 0.0 { self.shear.force[k] / stiffness } else { 0.0 }
            };
            (shifted[1], shifted[2]) = (gap[1] - was(0, k1), gap[2] - was(1, k2));
            (gap[1], gap[2]) = (gap[1] - self.shear.slid[0], gap[2] - self.shear.slid[1]);
        }
        let [_, gap1, gap2] = gap;
        let slipped = self.shear.load([k1, k2], [gap1, gap2]);
        self.crush_j += slipped.work_j;
        self.onset[0][1] += slipped.onset[0];
        self.onset[0][2] += slipped.onset[1];
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
    pub(in crate::mbs) fn begins_to_flow(&self) -> bool {
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

    /// The axial force at the end of a step, with what the rate of flow adds to the capacities; `old` is that at its start, `lowest` that at which it stretches \[N\].
    #[inline(never)]
    fn rated_force(&mut self, rate: Rate, old: f64, lowest: f64) -> f64 {
        let (trial, stiffness) = (self.axial_force, self.translation[0]);
        let from = |trial: f64| Search { start: f64::INFINITY, tolerance: TOLERANCE * trial };
        let bears = |pressed: f64| self.compression(pressed).map(|c| self.left * c);
        if is_same(old, trial) || stiffness <= 0.0 {
            trial
        } else if trial > bears(self.pressed)[0] {
            let flow = flow(trial, stiffness, from(trial), |x| rate.on(x, bears(self.pressed + x)));
            self.compressive_capacity = self.compression(self.pressed + flow)[0];
            trial - stiffness * flow
        } else if trial < lowest {
            trial + stiffness * flow(-trial, stiffness, from(-trial), |x| rate.on(x, [-lowest, 0.0]))
        } else {
            trial
        }
    }

    /// Compression at which the axial spring flows after a plastic shortening, if the hinge has not turned \[N\], and its slope \[N/m\].
    fn compression(&self, pressed: f64) -> [f64; 2] {
        let Some(hardening) = &self.hardening else { return [self.compressive_capacity, 0.0] };
        let upper = hardening.partition_point(|[x, _]| *x <= pressed);
        let Some([x0, n0]) = upper.checked_sub(1).map(|i| hardening[i]) else {
            return [self.compressive_capacity, 0.0];
        };
        hardening.get(upper).map_or([n0, 0.0], |[x1, n1]| {
            let slope = (n1 - n0) / (x1 - x0);
            [n0 + slope * (pressed - x0), slope]
        })
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
    pub(in crate::mbs) fn elastic_range(&self, tables: &[CapacityTable]) -> Option<ElasticRange> {
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
            self.shortened = self.hinge.shortened_m(laws, self.axial_force);
        }
        self.elastic_j = step.elastic_j;
        [torsion, self.hinge.moment_nm[0], self.hinge.moment_nm[1]]
    }
}

/// Within what a joint is elastic.
#[derive(Debug, Clone, Copy)]
pub(in crate::mbs) struct ElasticRange {
    /// From and below which axial force \[N\].
    pub force: [f64; 2],
    /// `1/C²` about both bending axes \[1/(N m)²\] ([`crate::curve::Hinge2::elastic_range`]).
    pub ease: [f64; 2],
    /// Below which moments at both ends of a beam \[N m\] ([`crate::curve::BeamEnds::elastic_range`]).
    pub ends: [f64; 2],
}

impl ElasticRange {
    /// No number lies between infinity and infinity.
    pub const NONE: Self = Self { force: [f64::INFINITY; 2], ease: [0.0; 2], ends: [0.0; 2] };
}
