//! Steps of Runge and Kutta, or of the leapfrog, and a projection onto the joints at the end of each.
//!
//! The last of a step's evaluations is the first of the next one; its factorisation serves the projection as well. The evaluation belongs to the state before
//! the projection, which moves it by less than the error of the step.

use super::Mechanism;
use super::control::{LEAST, error, first_step};
use super::method::{LEAPFROG, Method, method_for};
use super::motion::{Motion, STATE, WORKS, quaternion_rate};
use super::touch::Touching;
use crate::curve::CurveError;
use crate::mbs::contact::TooDeep;
use crate::mbs::math::{qexp, qmul, qrenormalise};
use std::collections::BTreeMap;

/// Steps that it takes to forget that joints stopped a motion, how many such times lead to steps of the leapfrog where there are hinges, and how many are remembered.
const SHAKEN: [u32; 3] = [50, 2, 4];

/// What a run is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March {
    /// Simulated time \[s\].
    pub end_s: f64,
    /// Error of a step: share of the size of each number, and at least this of 1 m, rad, m/s, rad/s.
    pub tolerance: f64,
    /// Interval of outputs \[s\].
    pub output_s: f64,
    /// Keep all rows of joints, also those across the plane of a plane motion.
    pub in_space: bool,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// States at the outputs, the start first; 13 numbers a body.
    pub states: Vec<Vec<f64>>,
    /// Steps taken, and steps that were tried and repeated.
    pub steps: [u64; 2],
    /// Constraint rows, and the most that were found dependent.
    pub rows: [usize; 2],
    /// Largest residual of a joint at the end of a step, before the projection.
    pub residual: f64,
    /// Largest change of kinetic and potential energy less the work of applied forces \[J\].
    pub energy_change_j: f64,
    /// Times at which hinges fractured \[s\], one for each.
    pub fractures_s: Vec<f64>,
}

/// Why a run stopped.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MarchError {
    /// A curve cannot be compiled.
    #[error(transparent)]
    Curve(#[from] CurveError),
    /// The step would have to be too small.
    #[error(
        "at {time_s:.6} s the step would have to be smaller than {step_s:.1e} s: a singular pose, or a force that jumps; use a larger tolerance"
    )]
    Step {
        /// Time \[s\].
        time_s: f64,
        /// Step \[s\].
        step_s: f64,
    },
    /// Bodies are in each other further than they may.
    #[error("bodies {0} and {1:?} are {2:.3} m in each other at {time_s:.6} s", deep.a, deep.b, deep.depth_m)]
    Penetration {
        /// Time \[s\].
        time_s: f64,
        /// Which, and how far.
        deep: TooDeep,
        /// Step \[s\].
        step_s: f64,
    },
    /// Hardly any progress.
    #[error(
        "hardly any progress at {time_s:.6} s: {steps} steps for the last {span_s:.1e} s; a singular pose, or loops that fight each other; use a larger tolerance, or leave a joint out"
    )]
    Stuck {
        /// Time \[s\].
        time_s: f64,
        /// Steps that were looked at.
        steps: u64,
        /// Time that they took \[s\].
        span_s: f64,
    },
    /// Numbers that are not finite.
    #[error("not finite at {time_s:.6} s")]
    NotFinite {
        /// Time \[s\].
        time_s: f64,
    },
}

/// What became of a run so far.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Tally {
    /// Steps taken, and steps that were tried and repeated.
    pub steps: [u64; 2],
    /// Constraint rows, and the most that were found dependent.
    pub rows: [usize; 2],
    /// Largest residual of a joint at the end of a step, before the projection.
    pub residual: f64,
    /// Largest change of kinetic and potential energy less the work of applied forces since the last [`Marcher::restart`] \[J\].
    pub energy_change_j: f64,
    /// Longest step \[s\].
    pub longest_s: f64,
}

/// Motions that joints allow at first order only, in a singular pose, and stop as it is left.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Locked {
    /// How often.
    pub times: usize,
    /// When last \[s\].
    pub last_s: f64,
    /// Their kinetic energy \[J\].
    pub energy_j: f64,
}

/// Time integrator of a mechanism.
#[derive(Debug)]
pub struct Marcher {
    /// The mechanism; after a change of it or of the state comes a [`Marcher::restart`].
    pub motion: Motion,
    /// The state; 13 numbers a body, then the works of forces.
    pub state: Vec<f64>,
    /// Time \[s\].
    pub time_s: f64,
    /// Counts.
    pub tally: Tally,
    /// What can touch.
    pub touching: Option<Touching>,
    /// Forces that flowed for the first time, with their times; for the caller to fetch.
    pub yields: Vec<(f64, usize)>,
    /// Hinges and torsion springs that turned in a way that they have no measure of ([`Motion::confused`]), with the times when they first did.
    pub confused: BTreeMap<usize, f64>,
    /// Each stage's state in turn, the last of which is the next state.
    pub(super) next: Vec<f64>,
    pub(super) rates: Vec<Vec<f64>>,
    pub(super) method: &'static Method,
    pub(super) tolerance: f64,
    pub(super) least_s: f64,
    /// The step that the last one would follow with; zero before the first \[s\].
    pub(super) step: f64,
    pub(super) before: f64,
    pub(super) repeated: bool,
    /// Step that was too long a while ago; rises slowly, so that a bound of stability is not tried again and again \[s\].
    pub(super) ceiling: f64,
    /// Steps that were accepted since.
    pub(super) accepted: u32,
    /// Highest frequency of springs and hinges \[rad/s\], and the bound of stability \[s\].
    pub(super) frequency: f64,
    limit_s: f64,
    /// Steps and time when progress was looked at last.
    pub(super) watched: (u64, f64),
    /// Steps of this length at most, whatever their error \[s\].
    pub(super) fixed_s: Option<f64>,
    start_j: f64,
    /// Dependent rows at the end of the last step, and steps until all times at which joints stopped a motion are forgotten.
    dependent: usize,
    shaken: u32,
    /// What joints stopped as they left singular poses.
    pub locked: Locked,
}

/// An accepted step: states in between.
#[derive(Debug, Clone, Copy)]
pub struct Span<'a> {
    /// Its start \[s\].
    pub from_s: f64,
    /// Its length \[s\].
    pub length_s: f64,
    ends: [&'a [f64]; 2],
    rates: &'a [Vec<f64>],
    method: &'static Method,
}

impl Span<'_> {
    /// Its end \[s\].
    pub fn to_s(&self) -> f64 {
        self.from_s + self.length_s
    }

    /// Half of it if it is one of the leapfrog, else nothing: what forces add in that time to velocities rises and falls with every vibration \[s\].
    pub fn kick_s(&self) -> f64 {
        if self.method.is_leapfrog() { 0.5 * self.length_s } else { 0.0 }
    }

    /// Writes the state at a time within.
    pub fn at(&self, time_s: f64, out: &mut [f64]) {
        let s = ((time_s - self.from_s) / self.length_s).clamp(0.0, 1.0);
        let [state, next] = self.ends;
        let last = &self.rates[self.rates.len() - 1];
        for (i, out) in out.iter_mut().enumerate() {
            let whole = next[i] - state[i];
            let early = self.length_s * self.rates[0][i] - whole;
            let late = whole - self.length_s * last[i] - early;
            let dense: f64 = self.rates.iter().zip(self.method.dense).map(|(k, d)| d * k[i]).sum();
            *out =
                state[i] + s * (whole + (1.0 - s) * (early + s * (late + (1.0 - s) * self.length_s * dense)));
        }
    }
}

impl Marcher {
    /// At the start of a mechanism, whose joints it projects velocities onto; `span_s` is the time of the whole run.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn of(
        mechanism: &Mechanism,
        tolerance: f64,
        span_s: f64,
        in_space: bool,
    ) -> Result<Self, CurveError> {
        let method = method_for(mechanism, tolerance);
        let state = Motion::state(mechanism);
        let mut marcher = Self {
            motion: Motion::of(mechanism, in_space)?,
            next: vec![0.0; state.len()],
            rates: vec![vec![0.0; state.len()]; method.stages.len() + 1],
            state,
            time_s: 0.0,
            tally: Tally::default(),
            touching: None,
            yields: Vec::new(),
            confused: BTreeMap::new(),
            method,
            tolerance,
            least_s: LEAST * span_s,
            step: 0.0,
            before: 1.0,
            repeated: false,
            ceiling: f64::INFINITY,
            accepted: 0,
            frequency: 0.0,
            limit_s: f64::INFINITY,
            watched: (0, 0.0),
            fixed_s: None,
            start_j: 0.0,
            dependent: 0,
            shaken: 0,
            locked: Locked::default(),
        };
        marcher.motion.take(&marcher.state);
        marcher.motion.project(&mut marcher.state);
        marcher.tally.rows = [marcher.motion.constraints(), marcher.motion.dependent()];
        marcher.restart();
        Ok(marcher)
    }

    /// From now on steps of one length, as many as fill the time until the next stop evenly, without control of their error.
    pub fn fix(&mut self, step_s: f64) {
        self.fixed_s = Some(step_s);
    }

    /// Kinetic energy of what forces add to velocities in a time \[s, J\].
    pub fn kick_j(&self, time_s: f64) -> f64 {
        if time_s == 0.0 { 0.0 } else { self.motion.kick_j(&self.rates[0], time_s) }
    }

    /// Highest angular frequency of springs and hinges under the joints, with margin \[rad/s\].
    pub fn frequency_rad_s(&self) -> f64 {
        self.frequency
    }

    /// Largest stable step \[s\].
    pub fn limit_s(&self) -> f64 {
        self.limit_s
    }

    /// Takes up a state or mechanism that was changed from outside; the energies are counted from here.
    pub fn restart(&mut self) {
        self.refresh();
        self.frequency = self.motion.frequency();
        self.limit_s = if self.method.is_leapfrog() {
            self.leap_limit_s()
        } else {
            self.method.reach / self.frequency.max(f64::MIN_POSITIVE)
        };
        self.start_j =
            self.motion.balance_j(&self.state) + self.touching.as_ref().map_or(0.0, Touching::spent_j);
        (self.before, self.repeated) = (1.0, false);
    }

    /// Sets the rates of the orientations to the angular velocities of the state.
    pub(super) fn turn_rates(&mut self) {
        for (r, s) in self.rates[0].chunks_exact_mut(STATE).zip(self.state.chunks_exact(STATE)) {
            r[3..7].copy_from_slice(&quaternion_rate([s[3], s[4], s[5], s[6]], [s[10], s[11], s[12]]));
        }
    }

    /// Evaluates the state anew, as projected: afterwards the reactions are those of it.
    pub fn refresh(&mut self) {
        self.motion.take(&self.state);
        self.dependent = self.motion.dependent();
        rate(&mut self.motion, &self.state, &mut self.rates[0]);
        if self.motion.settle() {
            rate(&mut self.motion, &self.state, &mut self.rates[0]);
        }
    }

    /// Steps until a time. `seen` is shown each step and may cut it short at a time within, where the march ends then (true). Ids of forces
    /// that fractured come with their time.
    ///
    /// # Errors
    /// If no step meets the tolerance.
    pub fn advance(
        &mut self,
        until_s: f64,
        seen: &mut dyn FnMut(&Span<'_>, &Self) -> Option<f64>,
        fractured: &mut Vec<(f64, usize)>,
    ) -> Result<bool, MarchError> {
        if self.step == 0.0 {
            self.step = first_step(&self.state, &self.rates[0], self.tolerance).min(until_s - self.time_s);
        }
        let even = self.fixed_s.map(|h| {
            let span = until_s - self.time_s;
            span / (span / h * (1.0 - 1e-9)).ceil().max(1.0)
        });
        while until_s - self.time_s > self.least_s {
            let wanted = even.unwrap_or(self.step.min(self.limit_s));
            let Some((step, leaps)) = self.try_step(wanted, until_s)? else { continue };
            self.count(step);
            let two = 2.min(self.rates.len());
            let span = Span {
                from_s: self.time_s,
                length_s: step,
                ends: [&self.state, &self.next],
                rates: if leaps { &self.rates[..two] } else { &self.rates },
                method: if leaps { &LEAPFROG } else { self.method },
            };
            let cut = seen(&span, self);
            if let Some(at_s) = cut {
                let mut state = self.next.clone();
                span.at(at_s, &mut state);
                self.motion.take(&state);
                self.motion.project(&mut state);
                (self.state, self.time_s) = (state, at_s);
            } else {
                self.keep_step(step, leaps);
            }
            self.commit(cut.is_some(), fractured);
            if cut.is_some() {
                return Ok(true);
            }
        }
        self.time_s = until_s;
        Ok(false)
    }

    /// Finds the next state with a step of at most `wanted` \[s\]; returns the step, and whether it is one of the leapfrog; none: a shorter one must be tried.
    fn try_step(&mut self, wanted: f64, until_s: f64) -> Result<Option<(f64, bool)>, MarchError> {
        let step = wanted.min(until_s - self.time_s);
        if step < self.least_s {
            return Err(MarchError::Step { time_s: self.time_s, step_s: step });
        }
        self.watch()?;
        // joints that stop motions again and again leave no smooth motion for error estimates
        let shaken = self.method.is_of_stiff() && self.shaken > SHAKEN[0] * SHAKEN[1];
        let leaps = self.is_near(step) || shaken;
        let step = if leaps { self.contact_step(step, until_s) } else { step };
        self.motion.bear_nothing();
        if leaps {
            let length = self.jump(step)?;
            let short = length < step;
            let step = self.leap_to_event(length, short)?;
            self.step = if shaken && !short { 1.5 * step } else { self.step };
            return Ok(Some((step, leaps)));
        }
        let Some(change) = self.attempt(step)? else { return Ok(None) };
        if !self.counted(step) {
            return Ok(None);
        }
        // a step shortened to meet the end says little about the next one
        self.step = if step < 0.5 * wanted { self.step } else { step * change };
        Ok(Some((step, leaps)))
    }

    /// Goes on from the end of a step, projected onto the joints.
    fn keep_step(&mut self, step: f64, leaps: bool) {
        let locked = self.project_step(leaps || self.method.is_leapfrog());
        let [memory, _, most] = SHAKEN;
        self.shaken =
            if locked { (self.shaken + memory).min(most * memory) } else { self.shaken.saturating_sub(1) };
        self.state.copy_from_slice(&self.next);
        let last = if leaps { 1 } else { self.rates.len() - 1 };
        self.rates.swap(0, last);
        self.time_s += step;
        if locked {
            self.refresh();
            self.before = 1.0;
        }
    }

    /// Makes what flowed in a step last, and starts anew where forces have changed with it.
    fn commit(&mut self, cut: bool, fractured: &mut Vec<(f64, usize)>) {
        let opened = self.motion.commit();
        self.yields.extend(self.motion.yielded.drain(..).map(|id| (self.time_s, id)));
        let confused = std::mem::take(&mut self.motion.confused);
        for id in &confused {
            self.confused.entry(*id).or_insert(self.time_s);
        }
        // the torques of a hinge that counts anew are others
        if !opened.is_empty() || !confused.is_empty() || cut {
            fractured.extend(opened.into_iter().map(|id| (self.time_s, id)));
            self.refresh();
            self.connect();
            self.before = 1.0;
        }
    }

    /// Projects the end of a step; true if joint conditions that depended on others no longer do: a pose was left in which the joints allowed a motion at first order
    /// only. What the step took of the energies is booked: it is the motion that the joints stop, as an impact without rebound.
    fn project_step(&mut self, leaped: bool) -> bool {
        let dependent = self.motion.dependent();
        let locked = dependent < std::mem::replace(&mut self.dependent, dependent);
        if leaped {
            self.motion.close(&mut self.next);
        } else {
            self.motion.project(&mut self.next);
        }
        if locked {
            self.locked.times += 1;
            self.locked.energy_j += self.motion.kept_j(&self.state) - self.motion.kept_j(&self.next);
            self.locked.last_s = self.time_s;
        }
        locked
    }

    /// Tries a step: what the next one may change by, or nothing if it has to be tried again with a smaller one.
    fn attempt(&mut self, step: f64) -> Result<Option<f64>, MarchError> {
        let error = if self.method.is_leapfrog() { self.leap(step) } else { self.stages(step) };
        self.judge(step, error)
    }

    /// A step of the leapfrog; its error over what is allowed. Forces that depend on velocities see those that the rate at the start leads to.
    pub(super) fn leap(&mut self, step: f64) -> f64 {
        let (first, rest) = self.rates.split_at_mut(1);
        let (before, after) = (&first[0], &mut rest[0]);
        leap_positions(&self.state, before, step, &mut self.next);
        self.motion.pace(step);
        self.motion.take(&self.next);
        self.motion.rate_and_close(&self.state, before, step, after);
        let (mut largest, works) = (0.0_f64, self.state.len() - WORKS);
        for b in (0..works).step_by(STATE) {
            for i in b + 7..b + STATE {
                self.next[i] = self.state[i] + 0.5 * step * (before[i] + after[i]);
                // the place of the number that this is the rate of: the rotation is of the size of 1
                let size = if i < b + 10 { 1.0 + self.next[i - 7].abs() } else { 1.0 };
                let off = step * step / 6.0 * (after[i] - before[i]).abs() / (self.tolerance * size);
                largest = if off.is_nan() { f64::NAN } else { largest.max(off) };
            }
            after[b..b + 3].copy_from_slice(&self.next[b + 7..b + 10]);
            let s = &self.next[b..b + STATE];
            let q = quaternion_rate([s[3], s[4], s[5], s[6]], [s[10], s[11], s[12]]);
            after[b + 3..b + 7].copy_from_slice(&q);
        }
        // with the velocities of the end, not those that the rate at the start leads to
        after[works..].copy_from_slice(&self.motion.power(&self.next));
        for i in works..self.state.len() {
            self.next[i] = self.state[i] + 0.5 * step * (before[i] + after[i]);
        }
        largest
    }

    /// The stages of a step; its error over what is allowed.
    fn stages(&mut self, step: f64) -> f64 {
        for (s, weights) in self.method.stages.iter().enumerate() {
            combine(&self.state, &self.rates, weights, step, &mut self.next);
            self.motion.pace(step * weights.iter().sum::<f64>());
            self.motion.take(&self.next);
            rate(&mut self.motion, &self.next, &mut self.rates[s + 1]);
        }
        let ends = [self.state.as_slice(), self.next.as_slice()];
        let found = error(ends, &self.rates, step, self.tolerance, self.method);
        // joints that stop a motion in the step leave no error of it either
        let goes_on = self.motion.dependent() == self.dependent;
        if goes_on && found > 1.0 { self.error_on_joints(step).min(found) } else { found }
    }

    /// Counts the step that was accepted.
    fn count(&mut self, step: f64) {
        let tally = &mut self.tally;
        tally.steps[0] += 1;
        tally.longest_s = tally.longest_s.max(step);
        tally.residual = tally.residual.max(self.motion.residual());
        tally.rows[1] = tally.rows[1].max(self.motion.dependent());
        let spent_j = self.touching.as_ref().map_or(0.0, Touching::spent_j);
        let change = (self.motion.balance_j(&self.next) + spent_j - self.start_j).abs();
        tally.energy_change_j = tally.energy_change_j.max(change);
    }
}

/// Runs a mechanism with outputs at even intervals.
///
/// # Errors
/// If no step meets the tolerance.
pub fn march(mechanism: &Mechanism, wanted: &March) -> Result<Course, MarchError> {
    let mut marcher = Marcher::of(mechanism, wanted.tolerance, wanted.end_s, wanted.in_space)?;
    let mut states = vec![marcher.state.clone()];
    let last = wanted.end_s * (1.0 + 1e-12);
    let mut outputs = |span: &Span<'_>, _: &Marcher| {
        loop {
            let at = states.len() as f64 * wanted.output_s;
            if at > span.to_s() + 1e-12 * wanted.end_s || at > last {
                return None;
            }
            let mut state = vec![0.0; states[0].len()];
            span.at(at, &mut state);
            states.push(state);
        }
    };
    let mut fractured = Vec::new();
    marcher.advance(wanted.end_s, &mut outputs, &mut fractured)?;
    let Tally { steps, rows, residual, energy_change_j, .. } = marcher.tally;
    let fractures_s = fractured.into_iter().map(|(time, _)| time).collect();
    Ok(Course { states, steps, rows, residual, energy_change_j, fractures_s })
}

/// The rate of a state that was taken; orientations are those of the state itself, which a stage leaves without unit length.
fn rate(motion: &mut Motion, state: &[f64], rate: &mut [f64]) {
    motion.rate(rate);
    for (r, s) in rate.chunks_exact_mut(STATE).zip(state.chunks_exact(STATE)) {
        let q = quaternion_rate([s[3], s[4], s[5], s[6]], [s[10], s[11], s[12]]);
        r[3..7].copy_from_slice(&q);
    }
}

/// Positions after a step, and the velocities that the rate at the start leads to.
fn leap_positions(state: &[f64], rate: &[f64], step: f64, next: &mut [f64]) {
    next.copy_from_slice(state);
    let bodies = next.chunks_exact_mut(STATE).zip(state.chunks_exact(STATE)).zip(rate.chunks_exact(STATE));
    for ((next, s), rate) in bodies {
        let middle = |i: usize| s[i] + 0.5 * step * rate[i];
        (0..3).for_each(|i| next[i] = s[i] + step * middle(7 + i));
        let turn = [10, 11, 12].map(|i| step * middle(i));
        let q = qrenormalise(qmul(qexp(turn), [s[3], s[4], s[5], s[6]]));
        next[3..7].copy_from_slice(&q);
        (7..STATE).for_each(|i| next[i] = s[i] + step * rate[i]);
    }
}

/// `state + step Σ a_i k_i`.
fn combine(state: &[f64], k: &[Vec<f64>], a: &[f64], step: f64, out: &mut [f64]) {
    out.copy_from_slice(state);
    for (k, a) in k.iter().zip(a).filter(|(_, a)| **a != 0.0) {
        for (o, k) in out.iter_mut().zip(k) {
            *o += step * a * k;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::joint::{Joint, Kind};
    use super::super::{Body, GROUND};
    use super::*;
    use crate::mbs::math::V3;

    /// A double pendulum about an axis across gravity, each joint `twice` or once.
    fn pendulum(axis: V3, twice: bool) -> Mechanism {
        let mut joints = Vec::new();
        for _ in 0..=usize::from(twice) {
            joints.push(Joint::at(Kind::Revolute, [GROUND, 0], [0.0; 3], axis));
            joints.push(Joint::at(Kind::Revolute, [0, 1], [1.0, 0.0, 0.0], axis));
        }
        Mechanism {
            bodies: vec![
                Body::at_rest(2.0, [0.1, 0.2, 0.3], [0.5, 0.0, 0.0]),
                Body::at_rest(1.0, [0.1, 0.2, 0.3], [1.3, 0.0, 0.0]),
            ],
            joints,
            gravity_m_s2: [0.0, 0.0, -9.81],
            ..Mechanism::default()
        }
    }

    fn run(mechanism: &Mechanism, tolerance: f64, in_space: bool) -> Course {
        march(mechanism, &March { end_s: 2.0, tolerance, output_s: 0.5, in_space }).unwrap()
    }

    /// Largest distance of the bodies' centres at the end.
    fn apart(a: &Course, b: &Course) -> f64 {
        let (a, b) = (&a.states[4], &b.states[4]);
        let body =
            |i: usize| (0..3).map(|k| (a[STATE * i + k] - b[STATE * i + k]).powi(2)).sum::<f64>().sqrt();
        body(0).max(body(1))
    }

    #[test]
    fn neither_rows_across_the_plane_nor_joints_twice_change_the_motion() {
        let y = [0.0, 1.0, 0.0];
        let plane = run(&pendulum(y, false), 1e-10, false);
        let space = run(&pendulum(y, false), 1e-10, true);
        let twice = run(&pendulum(y, true), 1e-10, true);
        assert_eq!((plane.rows, space.rows, twice.rows), ([4, 0], [10, 0], [20, 10]));
        assert!(apart(&plane, &space) < 1e-8 && apart(&plane, &twice) < 1e-8);
        assert!(plane.energy_change_j < 1e-7, "{}", plane.energy_change_j);
    }

    /// A swing of two rods and a bar, turned about the vertical: its joints hold it across its plane twice, by a combination of rows that lies a little beside an axis.
    fn swing(turn: f64) -> Mechanism {
        let (sin, cos) = turn.sin_cos();
        let about = |[x, y, z]: V3| [cos * x - sin * y, sin * x + cos * y, z];
        let at_angle = |x: f64| about([x + 0.3_f64.sin(), 0.0, -0.3_f64.cos()]);
        let middle = |x: f64| about([x + 0.5 * 0.3_f64.sin(), 0.0, -0.5 * 0.3_f64.cos()]);
        let turned = |body: Body| {
            let r = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
            Body { inertia_kg_m2: crate::mbs::math::turned(&r, &body.inertia_kg_m2), ..body }
        };
        let rod = |x: f64| turned(Body::at_rest(1.0, [0.08, 0.08, 0.08], middle(x)));
        let bar = turned(Body::at_rest(2.0, [0.01, 0.2, 0.2], at_angle(0.5)));
        let axis = about([0.0, 1.0, 0.0]);
        let pin = |bodies, point_m| Joint::at(Kind::Revolute, bodies, point_m, axis);
        Mechanism {
            bodies: vec![rod(0.0), rod(1.0), bar],
            joints: vec![
                pin([GROUND, 0], [0.0; 3]),
                pin([GROUND, 1], about([1.0, 0.0, 0.0])),
                pin([0, 2], at_angle(0.0)),
                pin([1, 2], at_angle(1.0)),
            ],
            gravity_m_s2: [0.0, 0.0, -9.81],
            ..Mechanism::default()
        }
    }

    #[test]
    fn a_swing_swings_in_any_plane_as_in_its_own() {
        let best = run(&swing(0.0), 1e-10, true);
        let height = |course: &Course, b: usize| course.states[4][STATE * b + 2];
        for turn in [1e-4, 3e-4, 1e-3, 0.1, 0.7, std::f64::consts::FRAC_PI_2] {
            let turned = run(&swing(turn), 1e-10, true);
            assert_eq!(turned.rows, [20, 3], "{turn}");
            for b in 0..3 {
                assert!((height(&turned, b) - height(&best, b)).abs() < 1e-8, "{turn}");
            }
        }
    }

    /// Parallelograms side by side (IFToMM A02), turned in their plane: upright bars of 1 m on the ground, bars between their tips that move at 1 m/s.
    fn ladder(loops: usize) -> Mechanism {
        let (sin, cos) = 0.5_f64.sin_cos();
        let at = |x: f64, y: f64| [cos * x - sin * y, sin * x + cos * y, 0.0];
        let bar = |x: f64, y: f64| Body::at_rest(1.0, [1.0 / 12.0; 3], at(x, y));
        let upright = (0..=loops).map(|i| Body {
            velocity_m_s: at(0.5, 0.0),
            angular_velocity_rad_s: [0.0, 0.0, -1.0],
            ..bar(i as f64, 0.5)
        });
        let across = (0..loops).map(|i| Body { velocity_m_s: at(1.0, 0.0), ..bar(i as f64 + 0.5, 1.0) });
        let pin =
            |bodies, x: usize, y: f64| Joint::at(Kind::Revolute, bodies, at(x as f64, y), [0.0, 0.0, 1.0]);
        let feet = (0..=loops).map(|i| pin([GROUND, i], i, 0.0));
        let tips = (0..loops).flat_map(|i| [0, 1].map(|side| pin([i + side, loops + 1 + i], i + side, 1.0)));
        Mechanism {
            bodies: upright.chain(across).collect(),
            joints: feet.chain(tips).collect(),
            gravity_m_s2: at(0.0, -9.81),
            ..Mechanism::default()
        }
    }

    /// Twice all bars come to lie in line, where each loop allows a motion of its own: that costs no more steps with many loops than with one.
    #[test]
    fn many_loops_pass_the_pose_in_which_they_are_in_line() {
        let wanted = March { end_s: 4.0, tolerance: 1e-8, output_s: 4.0, in_space: false };
        let [one, many] = [1, 20].map(|loops| march(&ladder(loops), &wanted).unwrap());
        let steps = |course: &Course| course.steps[0] + course.steps[1];
        println!("{:?} {:?} {:e}", one.steps, many.steps, many.energy_change_j);
        assert!(2 * steps(&many) < 3 * steps(&one), "{:?} {:?}", many.steps, one.steps);
        // 40 bars fall by up to 2 m
        assert!(many.energy_change_j < 1e-3, "{:e}", many.energy_change_j);
    }

    #[test]
    fn the_error_follows_the_tolerance() {
        let y = [0.0, 1.0, 0.0];
        let best = run(&pendulum(y, false), 1e-12, false);
        let [coarse, fine] = [1e-5, 1e-8].map(|tolerance| run(&pendulum(y, false), tolerance, false));
        let (far, near) = (apart(&coarse, &best), apart(&fine, &best));
        assert!(far < 1e-2 && near < 1e-5 && near < 0.01 * far, "{far} {near}");
        // fifth order: a thousandth of the error for four times the steps
        let ratio = fine.steps[0] as f64 / coarse.steps[0] as f64;
        assert!((3.0..6.0).contains(&ratio), "{:?} {:?}", coarse.steps, fine.steps);
    }

    #[test]
    fn a_force_that_is_not_finite_stops_the_run() {
        let mut mad = pendulum([0.0, 1.0, 0.0], false);
        mad.gravity_m_s2[2] = f64::NAN;
        let wanted = March { end_s: 1.0, tolerance: 1e-6, output_s: 0.5, in_space: true };
        assert!(matches!(march(&mad, &wanted), Err(MarchError::NotFinite { .. })));
    }
}
