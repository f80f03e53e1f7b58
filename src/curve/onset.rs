//! What a force that begins to flow within a step does beyond the mean of its begin and end.
//!
//! The leapfrog gives half of the force at the begin of a step and half of that at its end: the trapezoidal rule, which is right for forces that change in proportion. One that rises from `F_0` to its capacity `F_y` at a share `s` of
//! the step, and flows from there to `F_1`, has done `h [s (F_0 + F_y) + (1 - s) (F_y + F_1)] / 2`. What is missing, `h [F_y - F_0 - s (F_1 - F_0)] / 2`, is added to the force at the end of the step, which acts for about `h`. It is
//! naught for what flows already and for what stays elastic. Without it a spring whose elastic range is crossed in a fraction of a step loses half of what it dissipates in that step.

/// What is added to the force at the end of a step, for the force at its begin, at its capacity, as it would be without flow, and as it is.
pub fn onset(begin: f64, capacity: f64, trial: f64, end: f64) -> f64 {
    let (rise, whole) = (capacity - begin, trial - begin);
    if rise * whole <= 0.0 || rise.abs() >= whole.abs() {
        return 0.0; // flows already, or not at all
    }
    added(begin, capacity, end, rise / whole)
}

/// The same, if the capacity is reached at a share of the step.
pub fn added(begin: f64, capacity: f64, end: f64, share: f64) -> f64 {
    0.5 * (capacity - begin - share * (end - begin))
}
