//! Impulse correction for yielding within a step: what a force that begins to flow there does beyond the mean of its start and end.
//!
//! The leapfrog gives half of the force at the start of a step and half of that at its end: the trapezoidal rule, which is right for forces that change in proportion. One that rises from `F_0` to its capacity `F_y` at a share `s` of
//! the step, and flows from there to `F_1`, has done `h [s (F_0 + F_y) + (1 - s) (F_y + F_1)] / 2`. What is missing, `h [F_y - F_0 - s (F_1 - F_0)] / 2`, is added to the force at the end of the step, which acts for about `h`. It is
//! zero for what flows already and for what stays elastic. Without it a spring whose elastic range is crossed in a fraction of a step loses half of what it dissipates in that step.
//!
//! What breaks within a step has done only a part of that: its [`Course`] tells how much.

/// Share of the step at which a force reaches its capacity, for the force at its start, at its capacity, and as it would be without flow; none if it flows already, or not at all.
pub fn leaves(begin: f64, capacity: f64, trial: f64) -> Option<f64> {
    let (rise, whole) = (capacity - begin, trial - begin);
    (rise * whole > 0.0 && rise.abs() < whole.abs()).then(|| rise / whole)
}

/// What is added to the force at the end of a step that reaches its capacity at a share of it, for the force at the start, at its capacity, and at the end.
pub fn added(begin: f64, capacity: f64, end: f64, share: f64) -> f64 {
    0.5 * (capacity - begin - share * (end - begin))
}

/// How a [`flow`] is searched for.
#[derive(Debug, Clone, Copy)]
pub struct Search {
    /// A flow to begin with, if the force is outside; it is not taken if it is far too large.
    pub start: f64,
    /// Accuracy of the force.
    pub tolerance: f64,
}

/// Most steps of the search for a flow.
const SEARCHES: usize = 100;

/// The flow `x` at which a force that would be at `trial` is back at what is borne, `trial - k x = F(x)`, by Newton inside a shrinking bracket; nothing if it is inside. `bears` gives `F` and its slope.
pub fn flow(trial: f64, stiffness: f64, from: Search, mut bears: impl FnMut(f64) -> [f64; 2]) -> f64 {
    let (mut low, mut high) = (0.0, trial / stiffness);
    let mut x = if from.start > 0.0 && trial > bears(0.0)[0] { from.start.min(0.5 * high) } else { 0.0 };
    for _ in 0..SEARCHES {
        let [borne, slope] = bears(x);
        let (excess, slope) = (trial - stiffness * x - borne, -stiffness - slope);
        if x == 0.0 && excess <= 0.0 {
            return 0.0;
        }
        if excess.abs() <= from.tolerance || high - low <= 1e-15 * high {
            break;
        }
        if excess > 0.0 {
            low = x;
        } else {
            high = x;
        }
        let newton = x - excess / slope;
        x = if slope < 0.0 && newton > low && newton < high { newton } else { 0.5 * (low + high) };
    }
    x
}

/// How a force goes within a step: in proportion from its start to what it reaches, where it flows, and from there to its end.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Course {
    begin: f64,
    reached: f64,
    end: f64,
    /// Share of the step after which it flows.
    from: f64,
    /// By how much it flows.
    flow: f64,
}

impl Course {
    /// Of what stays elastic.
    pub fn elastic(begin: f64, end: f64) -> Self {
        Self { begin, reached: end, end, from: 1.0, flow: 0.0 }
    }

    /// Of what flows, from a share of the step on at which it `reached` its capacity, or all the time.
    pub fn flowing(begin: f64, end: f64, flow: f64, onset: Option<[f64; 2]>) -> Self {
        let [from, reached] = onset.unwrap_or([0.0, begin]);
        Self { begin, reached, end, from, flow }
    }

    /// Whether anything flows.
    pub fn flows(&self) -> bool {
        self.flow != 0.0
    }

    /// With the opposite sense, or the same.
    pub fn times(&self, sign: f64) -> Self {
        let Self { begin, reached, end, from, flow } = *self;
        Self { begin: sign * begin, reached: sign * reached, end: sign * end, from, flow: sign * flow }
    }

    /// The share of the step after which a part of the flow is done.
    pub fn after_flow(&self, part: f64) -> f64 {
        self.from + (1.0 - self.from) * part
    }

    /// The force at a share of the step.
    pub fn at(&self, share: f64) -> f64 {
        if share < self.from {
            self.begin + (self.reached - self.begin) * (share / self.from)
        } else if share < 1.0 {
            self.reached + (self.end - self.reached) * ((share - self.from) / (1.0 - self.from))
        } else {
            self.end
        }
    }

    /// Its impulse up to a share of the step, over the length of the step, less the half of its start that the step before has given. What flows all the time may have fallen at once (snap-back): it acts as at the end.
    pub fn left(&self, share: f64) -> f64 {
        if self.from == 0.0 {
            return (share - 0.5) * self.end;
        }
        let rises = share.min(self.from);
        let rest = (share - rises) * (self.reached + self.at(share));
        0.5 * (rises * (self.begin + self.at(rises)) + rest - self.begin)
    }

    /// Of the work that the mean of start and end does on the way of a whole step, what is left undone.
    pub fn undone_j(&self, share: f64, way: f64) -> f64 {
        way * (0.5 * self.end - self.left(share))
    }

    /// The flow that is still to come after a share of the step.
    pub fn flow_after(&self, share: f64) -> f64 {
        if share <= self.from { self.flow } else { self.flow * (1.0 - share) / (1.0 - self.from) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From 0 to 4 in proportion within a quarter of the step, from there to 2: what it does up to shares of the step, by areas under it.
    #[test]
    fn a_course_is_the_area_under_a_force() {
        let course = Course::flowing(0.0, 2.0, 8.0, Some([0.25, 4.0]));
        let areas = [(0.125, 0.125), (0.25, 0.5), (0.625, 0.5 + 0.375 * 3.5), (1.0, 0.5 + 0.75 * 3.0)];
        for (share, area) in areas {
            assert!((course.left(share) - area).abs() < 1e-15, "{share}: {}", course.left(share));
            assert!((course.undone_j(share, 10.0) - 10.0 * (1.0 - area)).abs() < 1e-14, "{share}");
        }
        assert_eq!([0.125, 0.25, 0.625, 1.0].map(|s| course.at(s)), [2.0, 4.0, 3.0, 2.0]);
        assert_eq!([0.125, 0.625, 1.0].map(|s| course.flow_after(s)), [8.0, 4.0, 0.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|part| course.after_flow(part)), [0.25, 0.625, 1.0]);
    }

    /// The leapfrog gives half of the force at the end, so nothing is undone at the end of a step but what was added for an onset.
    #[test]
    fn at_its_end_nothing_is_left_but_the_onset() {
        let (begin, end) = (3.0, 7.0);
        assert!((Course::elastic(begin, end).left(1.0) - 0.5 * end).abs() < 1e-15);
        assert!((Course::flowing(begin, end, 1.0, None).left(1.0) - 0.5 * end).abs() < 1e-15);
        let [share, reached] = [0.4, 9.0];
        let risen = Course::flowing(begin, end, 1.0, Some([share, reached]));
        let more = added(begin, reached, end, share);
        assert!((risen.left(1.0) - 0.5 * end - more).abs() < 1e-15);
        assert_eq!(leaves(begin, reached, begin + (reached - begin) / share), Some(share));
        assert_eq!(leaves(begin, 2.0, 5.0), None);
    }
}
