//! The plastic hinges at both ends of a beam, as the springs in its middle see them.
//!
//! A beam of length `2 l` between rigid bodies that meet in its middle has there a rotation spring `K` and a shear spring `k`. With the rotations `α_0` and `α_1` of hinges at `-l` and `+l` along its axis, what
//! is plastic of the rotation and of the displacement across in the middle is `α_0 + α_1` and `s (α_1 - α_0)`, where `s = ±l` by the sense of the axes; the elastic energy of the rest has the derivatives
//! `M_1 = M + s V` and `M_0 = M - s V`: the moments at the ends, each bounded by a capacity. This is the one-component model of a beam (Giberson, Bull. Seismol. Soc. Am. 59 (1969) 1885), with hinges that soften and break.
//!
//! Both ends depend on each other by `∂M_i/∂α_i = -(K + l² k)` and `∂M_i/∂α_j = -(K - l² k)`; where both flow, their returns are repeated in turn, which converges with the square of the ratio of these (1/4 in a
//! slender beam).
//!
//! A load `p` along a span of length `L` between clamped faces leaves there the moments `-p L²/12`, and `p L²/24` in its middle (positive where the span sags), which halves that bear it rigidly do not have: the parabola from
//! `p L²/24` in the middle to `p l²/2` less at the hinges is added to the moments. What sags between the faces takes the work `p L²/24` times the elastic rotation in the middle and `p l²/2` times `α_0 + α_1`.
//!
//! Energy: as in [`super::hinge`], what the trapezoidal work leaves beside the change of elastic energy is `½ (M_old + M_new) Δα` at each end, exactly.

use super::capacity::{AxialLevel, CapacityHint, CapacityTable, Nearby};
use super::hinge::FAR_INSIDE;
use super::onset::{self, Course, Search, added, leaves};
use super::rate::{Rate, is_same};

/// Relative accuracy of a return, in terms of the moment.
const TOLERANCE: f64 = 1e-13;
/// Most repetitions of the returns of both ends.
const SWEEPS: usize = 200;

/// The springs in the middle of a beam.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MiddleSprings {
    /// Stiffness against rotation \[N m/rad\].
    pub turn_nm_rad: f64,
    /// Stiffness against displacement across \[N/m\].
    pub shear_n_m: f64,
    /// Half the length of the beam, negative where a rotation moves the far end against the displacement across \[m\].
    pub lever_m: f64,
    /// What a load on the span adds.
    pub load: SpanLoad,
}

/// Moments of a load on a span whose faces are clamped \[N m\].
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SpanLoad {
    /// In its middle.
    pub middle_nm: f64,
    /// How much less it is at the hinges.
    pub drop_nm: f64,
}

impl SpanLoad {
    /// Those of a share of the load.
    pub fn times(self, share: f64) -> Self {
        Self { middle_nm: share * self.middle_nm, drop_nm: share * self.drop_nm }
    }

    /// For a load \[N/m\] in the sense of the displacement across, on a length between faces \[m\], with the lever of [`MiddleSprings`].
    pub fn uniform(load_n_m: f64, length_m: f64, lever_m: f64) -> Self {
        let load_n_m = load_n_m.copysign(load_n_m * lever_m);
        Self { middle_nm: load_n_m * length_m.powi(2) / 24.0, drop_nm: load_n_m * lever_m.powi(2) / 2.0 }
    }
}

/// A hinge at an end.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BeamEnd {
    /// Plastic rotation \[rad\].
    pub plastic_rad: f64,
    /// Its sum without regard to the sense \[rad\].
    pub alpha_rad: f64,
    /// Share of the rotation to fracture that is used up ([`super::Hinge2::damage`]).
    pub damage: f64,
    /// Moment of the last step \[N m\].
    pub moment_nm: f64,
    /// How its moment went in the last [`BeamEnds::step`] \[N m, rad\], and the share of its flow that was beyond fracture.
    pub course: Course,
    beyond: f64,
    hint: CapacityHint,
}

/// State of both hinges: at `-l` and `+l`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BeamEnds {
    /// The ends.
    pub ends: [BeamEnd; 2],
    /// Axial force at the start of the step to the next evaluation, as of [`super::Hinge2::axial_before_n`].
    pub axial_before_n: Option<f64>,
    /// What the rate of their flow in the step to the next evaluation does to their strength; `None`: nothing.
    pub rate: Option<Rate>,
    /// Elastic rotation in the middle in the last step \[rad\], and the load then.
    last: (f64, SpanLoad),
}

/// What one step did.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BeamStep {
    /// Whether a plastic rotation grew.
    pub flowing: bool,
    /// Energy dissipated in it \[J\].
    pub dissipated_j: f64,
    /// Work against the load \[J\].
    pub against_load_j: f64,
    /// Whether an end flowed under an axial force outside the levels of the curve.
    pub out_of_range: bool,
    /// By how much both ends turned \[rad\].
    pub flow_rad: [f64; 2],
    /// What the moments at the ends have done in the step beyond the mean of its start and end, where they began to flow ([`super::onset`]) \[N m\].
    pub onset_nm: [f64; 2],
}

impl BeamEnds {
    /// What is plastic of the rotation \[rad\] and of the displacement across \[m\] in the middle.
    pub fn plastic(&self, lever_m: f64) -> [f64; 2] {
        let [start, end] = self.ends.map(|e| e.plastic_rad);
        [start + end, lever_m * (end - start)]
    }

    /// The share of the last step after which the first of the ends broke; 1 if none did.
    pub fn broke_at(&self) -> f64 {
        let broken = self.ends.iter().filter(|e| e.damage >= 1.0);
        broken.map(|e| e.course.after_flow(1.0 - e.beyond)).fold(1.0, f64::min)
    }

    /// Takes back the flow after a share of the last step.
    pub fn take_back(&mut self, share: f64) {
        for end in &mut self.ends {
            let flow = end.course.flow_after(share);
            end.plastic_rad -= flow;
            end.alpha_rad -= flow.abs();
        }
    }

    /// Whether an end has broken.
    pub fn is_broken(&self) -> bool {
        self.ends.iter().any(|e| e.damage >= 1.0)
    }

    /// Advances to a rotation and a displacement across in the middle, under an axial force (compression positive).
    pub fn step(
        &mut self,
        table: &CapacityTable,
        springs: &MiddleSprings,
        [turn_rad, across_m]: [f64; 2],
        axial_force_n: f64,
    ) -> BeamStep {
        let old = self.ends;
        let trial = self.moments(springs, [turn_rad, across_m]);
        let mut step = BeamStep::default();
        let levels: [AxialLevel; 2] =
            std::array::from_fn(|i| table.level(axial_force_n, &mut self.ends[i].hint));
        let (is_rated, mut capacities) = (self.rate.is_some(), [0.0; 2]);
        let bears: [bool; 2] = std::array::from_fn(|i| {
            let end = &mut self.ends[i];
            let capacity = table.capacity_at(end.alpha_rad, levels[i], &mut end.hint);
            step.out_of_range |= capacity.out_of_range && trial[i].abs() > capacity.moment_nm;
            capacities[i] = capacity.moment_nm.copysign(trial[i]);
            trial[i].abs() <= capacity.moment_nm || (is_rated && is_same(old[i].moment_nm, trial[i]))
        });
        let mut moments = trial;
        let mean_n = 0.5 * (self.axial_before_n.unwrap_or(axial_force_n) + axial_force_n);
        if bears != [true; 2] {
            step.flow_rad = self.settle(table, springs, trial, levels);
            for (end, flow) in self.ends.iter_mut().zip(step.flow_rad).filter(|(_, flow)| *flow != 0.0) {
                end.plastic_rad += flow;
                end.alpha_rad += flow.abs();
                let used = flow.abs() / table.fracture_rotation_rad(mean_n, &mut end.hint);
                end.damage += used;
                end.beyond = ((end.damage - 1.0) / used).clamp(0.0, 1.0);
                step.flowing = true;
            }
            moments = self.moments(springs, [turn_rad, across_m]);
        }
        for (i, flow) in step.flow_rad.into_iter().enumerate() {
            let reached = if is_rated { moments[i] } else { capacities[i] };
            let begin = old[i].moment_nm;
            self.ends[i].course = if flow == 0.0 {
                Course::elastic(begin, moments[i])
            } else {
                // what follows a capacity that grows with the axial force flows all the time
                let from = if old[i].course.flows() { None } else { leaves(begin, reached, trial[i]) };
                step.onset_nm[i] = from.map_or(0.0, |share| added(begin, reached, moments[i], share));
                Course::flowing(begin, moments[i], flow, from.map(|share| [share, reached]))
            };
        }
        let (_, before) = self.last;
        step.against_load_j = self.stay(turn_rad - self.plastic_rad(), moments, springs.load);
        for i in 0..2 {
            let flow = self.ends[i].plastic_rad - old[i].plastic_rad;
            step.dissipated_j += 0.5 * (old[i].moment_nm + moments[i]) * flow;
            step.against_load_j += 0.5 * (before.drop_nm + springs.load.drop_nm) * flow;
        }
        step
    }

    /// Takes over the elastic rotation in the middle \[rad\], the moments at the ends \[N m\] and the load of a step; the work that the rotation did against the load \[J\].
    #[inline]
    pub fn stay(&mut self, elastic_rad: f64, moments_nm: [f64; 2], load: SpanLoad) -> f64 {
        let (before_rad, before) = std::mem::replace(&mut self.last, (elastic_rad, load));
        for (end, moment_nm) in self.ends.iter_mut().zip(moments_nm) {
            end.moment_nm = moment_nm;
        }
        0.5 * (before.middle_nm + load.middle_nm) * (elastic_rad - before_rad)
    }

    /// About which axial forces \[N\] no end flows whose moment is below a bound \[N m\]: all of them if the present moments are well below that of all, else those near the present one. None if an
    /// end has broken, or nothing is known.
    pub fn elastic_range(&self, table: &CapacityTable, axial_force_n: f64) -> Option<([f64; 2], [f64; 2])> {
        let all = self.bounds(|end| table.anywhere(end.alpha_rad, &end.hint));
        let used = |end: &BeamEnd, least: f64| (end.moment_nm / least).powi(2);
        let is_far_inside =
            |least: [f64; 2]| self.ends.iter().zip(least).all(|(end, c)| used(end, c) < FAR_INSIDE);
        match all {
            Some((_, least)) if is_far_inside(least) => all,
            _ => self.bounds(|end| table.nearby(end.alpha_rad, axial_force_n, &end.hint)),
        }
    }

    fn bounds(&self, bound: impl Fn(&BeamEnd) -> Option<Nearby>) -> Option<([f64; 2], [f64; 2])> {
        let [start, end] = [bound(&self.ends[0])?, bound(&self.ends[1])?];
        let force_n = [start.force_n[0].max(end.force_n[0]), start.force_n[1].min(end.force_n[1])];
        (!self.is_broken()).then_some((force_n, [start.least_nm, end.least_nm]))
    }

    /// How much shorter the flow of its last step made the beam by normality ([`CapacityTable::shortening_m`]) \[m\].
    pub fn shortened_m(&mut self, table: &CapacityTable, flow_rad: [f64; 2], axial_force_n: f64) -> f64 {
        let of_end = |(end, flow): (&mut BeamEnd, f64)| {
            let level = table.level(axial_force_n, &mut end.hint);
            let capacity = table.capacity_at(end.alpha_rad, level, &mut end.hint);
            flow.abs() * table.shortening_m(level, capacity.moment_nm, axial_force_n)
        };
        self.ends.iter_mut().zip(flow_rad).map(of_end).sum()
    }

    /// Elastic rotation in the middle \[rad\], and moment there \[N m\].
    pub fn in_the_middle(&self, springs: &MiddleSprings, turn_rad: f64) -> [f64; 2] {
        let elastic_rad = turn_rad - self.plastic_rad();
        [elastic_rad, springs.turn_nm_rad * elastic_rad + springs.load.middle_nm]
    }

    /// What is plastic of the rotation in the middle \[rad\].
    pub fn plastic_rad(&self) -> f64 {
        self.ends.iter().map(|e| e.plastic_rad).sum()
    }

    /// Moments at the ends \[N m\].
    fn moments(&self, springs: &MiddleSprings, [turn_rad, across_m]: [f64; 2]) -> [f64; 2] {
        let [_, across] = self.plastic(springs.lever_m);
        let moment = self.in_the_middle(springs, turn_rad)[1] - springs.load.drop_nm;
        let of_shear = springs.lever_m * springs.shear_n_m * (across_m - across);
        [moment - of_shear, moment + of_shear]
    }

    /// The plastic rotations of a step, from the moments without them.
    fn settle(
        &mut self,
        table: &CapacityTable,
        springs: &MiddleSprings,
        trial: [f64; 2],
        levels: [AxialLevel; 2],
    ) -> [f64; 2] {
        let of_shear = springs.lever_m * springs.lever_m * springs.shear_n_m;
        let (own, other) = (springs.turn_nm_rad + of_shear, springs.turn_nm_rad - of_shear);
        let mut flow = [0.0; 2];
        for _ in 0..SWEEPS {
            let mut change = 0.0_f64;
            for i in 0..2 {
                let moment = trial[i] - other * flow[1 - i];
                let new = self.ends[i].back(table, own, moment, levels[i], self.rate);
                change = change.max(own * (new - flow[i]).abs());
                flow[i] = new;
            }
            if change <= TOLERANCE * table.peak_nm() {
                break;
            }
        }
        flow
    }
}

impl BeamEnd {
    /// The plastic rotation that brings a moment back to the capacity, for a stiffness: the zero of `|M| - k x - C(α + x) r(x)` ([`onset::flow`]); nothing if the moment is inside.
    fn back(
        &mut self,
        table: &CapacityTable,
        stiffness: f64,
        moment: f64,
        level: AxialLevel,
        rate: Option<Rate>,
    ) -> f64 {
        let from = Search {
            start: rate.map_or(0.0, |_| self.course.flow_after(0.0).abs()),
            tolerance: TOLERANCE * table.peak_nm(),
        };
        let bears = |x: f64| {
            let capacity = table.capacity_at(self.alpha_rad + x, level, &mut self.hint);
            let at_rest = [capacity.moment_nm, capacity.slope_nm_rad];
            rate.map_or(at_rest, |rate| rate.on(x, at_rest))
        };
        onset::flow(moment.abs(), stiffness, from, bears).copysign(moment)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{CapacityLevel, ResistanceCurve};

    const LENGTH_M: f64 = 5.0;
    const BENDING_NM2: f64 = 4e7;

    fn springs() -> MiddleSprings {
        MiddleSprings {
            turn_nm_rad: BENDING_NM2 / LENGTH_M,
            shear_n_m: 12.0 * BENDING_NM2 / LENGTH_M.powi(3),
            lever_m: 0.5 * LENGTH_M,
            load: SpanLoad::default(),
        }
    }

    fn table(capacity: Vec<[f64; 2]>, fracture_rotation_rad: f64) -> CapacityTable {
        let levels = vec![CapacityLevel { axial_force_n: 0.0, capacity, fracture_rotation_rad }];
        let curve = ResistanceCurve { stiffness_nm_rad: BENDING_NM2 / LENGTH_M, levels, cyclic: None };
        CapacityTable::new(&curve, 1.0).unwrap()
    }

    /// In the middle of a beam that is clamped at its start and moved across at its end, which does not turn.
    fn sway(end_m: f64) -> [f64; 2] {
        [0.0, end_m]
    }

    #[test]
    fn a_clamped_beam_yields_at_both_ends_and_bears_their_shear() {
        let table = table(vec![[0.0, 1e5], [1.0, 1e5]], 2.0);
        let mut beam = BeamEnds::default();
        // elastic: 6 E I w / L² at both ends
        let w = 0.005;
        beam.step(&table, &springs(), sway(w), 0.0);
        let elastic = 6.0 * BENDING_NM2 * w / LENGTH_M.powi(2);
        assert!((beam.ends[1].moment_nm / elastic - 1.0).abs() < 1e-12);
        assert!((beam.ends[0].moment_nm / elastic + 1.0).abs() < 1e-12);
        // plastic: a mechanism, turned by w / L less the elastic part at both ends
        let w = 0.2;
        beam.step(&table, &springs(), sway(w), 0.0);
        assert!((beam.ends[1].moment_nm - 1e5).abs() < 1e-6 && (beam.ends[0].moment_nm + 1e5).abs() < 1e-6);
        let flow = w / LENGTH_M - 1e5 * LENGTH_M / (6.0 * BENDING_NM2);
        assert!((beam.ends[1].plastic_rad - flow).abs() < 1e-12, "{} {flow}", beam.ends[1].plastic_rad);
        assert!((beam.ends[0].plastic_rad + flow).abs() < 1e-12);
    }

    #[test]
    fn a_propped_beam_has_a_hinge_at_its_clamped_end_only() {
        // the far end turns by -1.5 w / L, and in the middle that is a displacement as well; the near end bears 3 E I w / L²
        let table = table(vec![[0.0, 1e5], [1.0, 1e5]], 2.0);
        let at = |w: f64| {
            let turn = -1.5 * w / LENGTH_M;
            [turn, w + 0.5 * LENGTH_M * turn]
        };
        let mut beam = BeamEnds::default();
        beam.step(&table, &springs(), at(0.01), 0.0);
        let clamped = 3.0 * BENDING_NM2 * 0.01 / LENGTH_M.powi(2);
        let [start, end] = beam.ends.map(|e| e.moment_nm);
        assert!((start / clamped + 1.0).abs() < 1e-12 && end.abs() < 1e-9 * clamped, "{start} {end}");
        // past yield of the near end the far one bears what that turns: 2 E I / L α
        beam.step(&table, &springs(), at(0.03), 0.0);
        let [near, far] = beam.ends;
        assert!((near.moment_nm + 1e5).abs() < 1e-6 && near.plastic_rad < 0.0 && far.plastic_rad == 0.0);
        let turned = (1e5 - 3.0 * clamped) * LENGTH_M / (4.0 * BENDING_NM2);
        assert!((near.plastic_rad / turned - 1.0).abs() < 1e-9, "{} {turned}", near.plastic_rad);
        let carried = 2.0 * BENDING_NM2 / LENGTH_M * turned;
        assert!((far.moment_nm / carried - 1.0).abs() < 1e-9, "{} {carried}", far.moment_nm);
    }

    #[test]
    fn a_clamped_beam_under_a_load_has_its_moments_and_yields_at_its_ends_first() {
        let table = table(vec![[0.0, 1e5], [1.0, 1e5]], 2.0);
        let load = |p: f64| SpanLoad::uniform(p, LENGTH_M, springs().lever_m);
        let mut beam = BeamEnds::default();
        // clamped: p L² / 12 at the ends, p L² / 24 in the middle
        let p = 4e4;
        let springs_under = MiddleSprings { load: load(p), ..springs() };
        beam.step(&table, &springs_under, [0.0; 2], 0.0);
        let [_, middle] = beam.in_the_middle(&springs_under, 0.0);
        assert!((24.0 * middle / (p * LENGTH_M.powi(2)) - 1.0).abs() < 1e-12);
        for end in beam.ends {
            assert!((-12.0 * end.moment_nm / (p * LENGTH_M.powi(2)) - 1.0).abs() < 1e-12);
        }
        // past 12 M_p / L² the ends turn, as far as a beam with M_p at its ends does: (p L² / 12 - M_p) L / (2 E I)
        let p = 6e4;
        let springs_over = MiddleSprings { load: load(p), ..springs() };
        beam.step(&table, &springs_over, [0.0; 2], 0.0);
        let turned = (p * LENGTH_M.powi(2) / 12.0 - 1e5) * LENGTH_M / (2.0 * BENDING_NM2);
        for end in beam.ends {
            assert!((end.moment_nm + 1e5).abs() < 1e-6, "{}", end.moment_nm);
            assert!((end.plastic_rad / turned + 1.0).abs() < 1e-9, "{} {turned}", end.plastic_rad);
        }
        // the same beam seen from the other side
        let other = SpanLoad::uniform(-p, LENGTH_M, -springs().lever_m);
        assert_eq!(other, load(p));
    }

    #[test]
    fn work_is_elastic_energy_and_dissipation() {
        let table = table(vec![[0.0, 1e5], [0.01, 1.2e5], [0.05, 2e4], [0.2, 1e3]], 0.5);
        let springs =
            MiddleSprings { load: SpanLoad::uniform(1e4, 1.1 * LENGTH_M, 0.5 * LENGTH_M), ..springs() };
        let mut beam = BeamEnds::default();
        beam.step(&table, &springs, [0.0; 2], 0.0);
        let (mut work, mut dissipated, mut sagged, mut least) = (0.0, 0.0, 0.0, f64::INFINITY);
        let (mut last, mut forces) = ([0.0_f64; 2], [springs.load.middle_nm, 0.0]);
        let energy = |beam: &BeamEnds, at: [f64; 2]| {
            let [_, across] = beam.plastic(springs.lever_m);
            let [elastic_rad, _] = beam.in_the_middle(&springs, at[0]);
            0.5 * springs.turn_nm_rad * elastic_rad.powi(2)
                + 0.5 * springs.shear_n_m * (at[1] - across).powi(2)
        };
        for i in 1..=4000 {
            let t = f64::from(i) * 1e-3;
            let at = [0.02 * (3.0 * t).sin() * t, 0.06 * (1.0 - (5.0 * t).cos())];
            let step = beam.step(&table, &springs, at, 0.0);
            let [_, across] = beam.plastic(springs.lever_m);
            let now = [beam.in_the_middle(&springs, at[0])[1], springs.shear_n_m * (at[1] - across)];
            for k in 0..2 {
                work += 0.5 * (forces[k] + now[k]) * (at[k] - last[k]);
            }
            dissipated += step.dissipated_j;
            sagged += step.against_load_j;
            least = least.min(step.dissipated_j);
            (last, forces) = (at, now);
        }
        let sum = energy(&beam, last) + dissipated + sagged;
        assert!((sum - work).abs() < 1e-9 * work, "{sum} {work}");
        assert!(dissipated > 0.1 * work && least > -1e-6 * dissipated, "{least} {dissipated}");
        assert!(beam.ends.iter().all(|e| e.alpha_rad > 0.05));
    }
}
