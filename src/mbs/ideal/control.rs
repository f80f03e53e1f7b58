//! Lengths of steps: by their errors, by events within them, in contact.

use super::march::{MarchError, Marcher};
use super::method::Method;
use super::touch::{STEP_S, Touching};

/// Limits of the change of a step, and the share of the step that the error would allow.
const CHANGE: [f64; 2] = [0.2, 5.0];
const CAUTION: f64 = 0.9;
/// Share of a step that was too long which the next ones may have, and how that rises with each of them: a bound of stability is met again within so many steps, one that is left behind, as
/// the pose of a loop in line, is forgotten the faster the longer none is met.
const CEILING: [f64; 2] = [0.95, 1.01];
const SOON: u32 = 30;
/// Steps over which progress is looked at, tried ones included, and the least share of the whole time that they have to take.
const WATCHED: u64 = 50_000;
const PROGRESS: f64 = 1e-3;
/// Least tolerance of steps in contact, which are of second order.
const TOUCH_TOLERANCE: f64 = 1e-6;
/// Step within which a fracture is met, or a hinge that begins or ceases to flow \[s\].
const EVENT_S: f64 = 1e-5;
/// Fall whose energy is the least that errors of the energy are compared with \[m\].
const REST_M: f64 = 1e-3;
/// Powers of the errors of a step and of the one before it (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.2).
const PROPORTIONAL: f64 = 0.7;
const INTEGRAL: f64 = 0.4;
/// Smallest step over the whole time.
pub(super) const LEAST: f64 = 1e-12;

impl Marcher {
    /// Stops a march that gets nowhere.
    pub(super) fn watch(&mut self) -> Result<(), MarchError> {
        let steps = self.tally.steps[0] + self.tally.steps[1];
        let (since, from_s) = self.watched;
        if self.fixed_s.is_some() || steps < since + WATCHED {
            return Ok(());
        }
        self.watched = (steps, self.time_s);
        let span_s = self.time_s - from_s;
        if span_s < PROGRESS * self.least_s / LEAST {
            return Err(MarchError::Stuck { time_s: self.time_s, steps: steps - since, span_s });
        }
        Ok(())
    }

    /// Length of a step in contact, or of such a one where nothing can touch, that is at most `step`, and divides the time until the stop evenly.
    pub(super) fn contact_step(&self, step: f64, until_s: f64) -> f64 {
        let longest = self.touching.as_ref().map_or(STEP_S[0], Touching::step_s);
        let span = until_s - self.time_s;
        span / (span / step.min(longest).min(self.leap_limit_s()) * (1.0 - 1e-9)).ceil().max(1.0)
    }

    /// A step of the leapfrog after a jump, halved until it passes no event and its error is that of a contact step; its length. One that is `short` for an impact at its end says nothing about
    /// the next one.
    pub(super) fn leap_to_event(&mut self, mut step: f64, short: bool) -> Result<f64, MarchError> {
        let tolerance = self.tolerance.max(TOUCH_TOLERANCE);
        loop {
            let error = self.leap(step) * self.tolerance / tolerance;
            if !error.is_finite() {
                return Err(MarchError::NotFinite { time_s: self.time_s });
            }
            let exact = self.fixed_s.is_some() || error <= 1.0 || step <= EVENT_S;
            if let Some(touching) = self.touching.as_mut().filter(|_| !(short && exact)) {
                touching.advise(if exact {
                    step * libm::pow(error.max(1e-3), -1.0 / 3.0)
                } else {
                    0.5 * step
                });
            }
            if exact && !self.breaks(step) && !self.turns_over(step, tolerance) {
                if let Some(touching) = &mut self.touching {
                    touching.last_s = step;
                }
                return Ok(step);
            }
            step *= 0.5;
            self.tally.steps[1] += 1;
        }
    }

    /// The error of a step, over what is allowed, that is left once its end is projected onto the joints. Beside a pose in which loops are in line accelerations across them are what is left
    /// of terms larger by one over the square of the distance, and their rounding is most of the error; at the end of a step that passes the pose joints hold those motions well.
    pub(super) fn error_on_joints(&mut self, step: f64) -> f64 {
        let mut off = vec![0.0; self.state.len()];
        for (rate, weight) in self.rates.iter().zip(self.method.error) {
            off.iter_mut().zip(rate).for_each(|(off, rate)| *off += step * weight * rate);
        }
        self.motion.project_error(&mut off);
        let ends = self.state.iter().zip(&self.next);
        let shares = off.iter().zip(ends).map(|(off, (a, b))| off.abs() / allowed(self.tolerance, [*a, *b]));
        shares.fold(0.0, f64::max)
    }

    /// What the next step may change by after an error, or nothing if this one has to be tried again with a smaller step.
    pub(super) fn judge(&mut self, step: f64, error: f64) -> Result<Option<f64>, MarchError> {
        if self.fixed_s.is_some() {
            let time_s = self.time_s;
            return if error.is_finite() { Ok(Some(1.0)) } else { Err(MarchError::NotFinite { time_s }) };
        }
        let order = self.method.order;
        if !error.is_finite() {
            // a step too far into a singular pose; a smaller one stays before it
            self.tally.steps[1] += 1;
            self.step = CHANGE[0] * step;
            if self.step < self.least_s {
                return Err(MarchError::NotFinite { time_s: self.time_s });
            }
            return Ok(None);
        }
        let sized = error.max(1e-10);
        if error > 1.0 {
            self.tally.steps[1] += 1;
            (self.ceiling, self.accepted) = (step * CEILING[0], 0);
            self.step = step * (CAUTION * libm::pow(sized, -1.0 / order)).clamp(CHANGE[0], 1.0);
            self.repeated = true;
            return Ok(None);
        }
        // events are met by halving the step that passes them
        if self.breaks(step) || self.turns_over(step, self.tolerance) {
            self.tally.steps[1] += 1;
            self.step = 0.5 * step;
            return Ok(None);
        }
        // with the error of the step before, so that steps settle at a bound of stability instead of trying it again and again
        let by_both = libm::pow(sized, -PROPORTIONAL / order) * libm::pow(self.before, INTEGRAL / order);
        let most = if self.repeated { 1.0 } else { CHANGE[1] };
        (self.before, self.repeated) = (sized, false);
        self.accepted += 1;
        self.ceiling *= 1.0 + (CEILING[1] - 1.0) * f64::from(self.accepted.max(SOON)) / f64::from(SOON);
        let change = (CAUTION * by_both).clamp(CHANGE[0], most);
        Ok(Some(change.min((self.ceiling / step).max(CHANGE[0]))))
    }

    /// Whether a hinge begins or ceases to flow in a step, at the cost of more energy than is allowed: the estimate of the error does not see a force that changes its slope early in the
    /// step. Nor does the energy see one that flows, turns back and still flows at the end.
    fn turns_over(&self, step: f64, tolerance: f64) -> bool {
        let both = [self.state.as_slice(), self.next.as_slice()];
        self.fixed_s.is_none()
            && step > EVENT_S
            && (self.motion.has_turned_over() && self.motion.energy_error(both, REST_M) > tolerance
                || self.motion.turned_back(both, REST_M, step) > tolerance)
    }

    /// Whether a hinge fractures in a step that can be shorter.
    fn breaks(&self, step: f64) -> bool {
        step > EVENT_S && self.motion.beyond().is_some_and(|beyond| beyond >= 0.0)
    }
}

/// Error of a number of a state that a tolerance allows, by its size at both ends of the step.
#[inline]
fn allowed(tolerance: f64, [a, b]: [f64; 2]) -> f64 {
    tolerance * (1.0 + a.abs().max(b.abs()))
}

/// Largest estimated error of a step over what is allowed.
pub(super) fn error(
    [state, next]: [&[f64]; 2],
    k: &[Vec<f64>],
    step: f64,
    tolerance: f64,
    method: &Method,
) -> f64 {
    let mut largest: f64 = 0.0;
    for (i, (a, b)) in state.iter().zip(next).enumerate() {
        let sum: f64 = k.iter().zip(method.error).map(|(k, e)| e * k[i]).sum();
        let share = (step * sum).abs() / allowed(tolerance, [*a, *b]);
        if share.is_nan() {
            return f64::NAN;
        }
        largest = largest.max(share);
    }
    largest
}

/// A first step from the size of the rates.
pub(super) fn first_step(state: &[f64], rate: &[f64], tolerance: f64) -> f64 {
    let size = |v: &f64| 1.0 + v.abs();
    let fastest = state.iter().zip(rate).map(|(s, r)| r.abs() / size(s)).fold(0.0, f64::max);
    0.1 * libm::pow(tolerance, 0.2) / fastest.max(1e-3)
}
