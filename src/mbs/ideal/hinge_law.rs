//! The law of a hinge of smooth motion about one of its axes: elastic up to a capacity that the largest rotation so far has left, and the work of its flow.

use crate::base::piecewise::interpolate;

/// Law of a hinge about each of its axes.
#[derive(Debug, Clone, PartialEq)]
pub struct HingeLaw {
    /// Elastic stiffness \[N m/rad\].
    pub stiffness_nm_rad: f64,
    /// `[largest rotation (rad), capacity (N m)]` from zero, straight in between; the last capacity beyond.
    pub capacity: Vec<[f64; 2]>,
    /// Length of the rotation vector at which it fractures \[rad\].
    pub fracture_rad: f64,
}

impl HingeLaw {
    /// Moment at a rotation, and the history with it; capacities are `factor` times those of the law.
    #[inline]
    pub(super) fn moment(&self, mut history: History, rotation: f64, factor: f64) -> (f64, History) {
        history.largest = history.largest.max(rotation.abs());
        let capacity = factor * interpolate(&self.capacity, history.largest);
        let elastic = self.stiffness_nm_rad * (rotation - history.plastic);
        let moment = elastic.clamp(-capacity, capacity);
        if moment != elastic {
            history.plastic = rotation - moment / self.stiffness_nm_rad;
        }
        (moment, history)
    }

    /// The history that [`HingeLaw::moment`] leads to, dissipation included.
    #[inline]
    pub(super) fn with_work(&self, before: History, mut after: History, factor: f64) -> History {
        if after.plastic != before.plastic {
            after.dissipated_j = before.dissipated_j + self.flow_j(before, after, factor);
        }
        after
    }

    /// Work of plastic flow `∫ M dp`: at the capacity of the largest rotation so far up to it, along the capacities beyond, where `p = θ - M/k`. Exact where
    /// the rotation between goes one way.
    fn flow_j(&self, before: History, after: History, factor: f64) -> f64 {
        let capacity_at = |largest: f64| factor * interpolate(&self.capacity, largest);
        let sense = (after.plastic - before.plastic).signum();
        let whole = sense * (after.plastic - before.plastic);
        let (from, to) = (self.onset(before, sense, after.largest, factor), after.largest);
        if to <= from {
            return capacity_at(before.largest) * whole;
        }
        let (first, last) = (capacity_at(from), capacity_at(to));
        let along = (to - from) - (last - first) / self.stiffness_nm_rad;
        let area = factor * integral(&self.capacity, from, to);
        let beyond = area - 0.5 * (last * last - first * first) / self.stiffness_nm_rad;
        first * (whole - along).max(0.0) + beyond
    }

    /// Rotation of a sense, from the largest one so far up to another one, at which flow goes on along the capacities: where the elastic moment is above them.
    fn onset(&self, before: History, sense: f64, to: f64, factor: f64) -> f64 {
        // what the elastic moment has above the capacity
        let above = |x: f64| {
            self.stiffness_nm_rad * (x - sense * before.plastic) - factor * interpolate(&self.capacity, x)
        };
        let mut place = before.largest;
        let mut lack = above(place);
        if lack >= 0.0 {
            return place;
        }
        for end in self.capacity.iter().map(|p| p[0]).filter(|x| *x > before.largest && *x < to).chain([to]) {
            let next = above(end);
            if next >= 0.0 {
                return place - lack * (end - place) / (next - lack);
            }
            (place, lack) = (end, next);
        }
        to
    }
}

/// Integral of a line through points, constant beyond its ends.
fn integral(points: &[[f64; 2]], from: f64, to: f64) -> f64 {
    let mut sum = 0.0;
    let mut place = from;
    for end in points.iter().map(|p| p[0]).filter(|x| *x > from && *x < to).chain([to]) {
        sum += 0.5 * (end - place) * (interpolate(points, place) + interpolate(points, end));
        place = end;
    }
    sum
}

/// What a hinge remembers about an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct History {
    /// Plastic rotation \[rad\].
    pub(super) plastic: f64,
    /// Largest rotation \[rad\].
    pub(super) largest: f64,
    /// Work of plastic flow \[J\].
    pub(super) dissipated_j: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hinge_flows_softens_and_unloads_elastically() {
        let law = HingeLaw {
            stiffness_nm_rad: 2e7,
            capacity: vec![[0.0, 120e3], [0.03, 120e3], [0.15, 0.0]],
            fracture_rad: 0.5,
        };
        let start = History::default();
        let (elastic, history) = law.moment(start, 0.004, 1.0);
        assert_eq!((elastic, history.plastic), (80e3, 0.0));
        let (flowing, history) = law.moment(history, 0.02, 1.0);
        assert!((flowing - 120e3).abs() < 1e-9 && (history.plastic - 0.014).abs() < 1e-15);
        let (back, history) = law.moment(history, 0.016, 1.0);
        assert!((back - 40e3).abs() < 1e-6 && (history.plastic - 0.014).abs() < 1e-15);
        let (soft, history) = law.moment(history, 0.09, 1.0);
        assert!((soft - 60e3).abs() < 1e-6 && history.largest == 0.09);
        // the other sense has the capacity that the largest rotation left
        let (reversed, _) = law.moment(history, 0.0, 1.0);
        assert!((reversed + 60e3).abs() < 1e-6, "{reversed}");
        assert_eq!(law.moment(history, 0.4, 1.0).0, 0.0);
    }

    /// The elastic line meets the capacities where they fall: in one step and in many, forth and back.
    #[test]
    fn the_work_of_flow_does_not_depend_on_the_steps() {
        let law = HingeLaw {
            stiffness_nm_rad: 1e6,
            capacity: vec![[0.0, 40e3], [0.03, 40e3], [0.032, 10e3], [0.5, 10e3]],
            fracture_rad: 5.0,
        };
        let taken = |steps: u32| {
            let mut history = History::default();
            for [from, to] in [[0.0, 0.1], [0.1, -0.2]] {
                for i in 1..=steps {
                    let rotation = from + (to - from) * f64::from(i) / f64::from(steps);
                    let next = law.moment(history, rotation, 1.0).1;
                    history = law.with_work(history, next, 1.0);
                }
            }
            history.dissipated_j
        };
        // elastic up to where the falling line is met, all of it lost but for what 10 kN m hold; then at 10 kN m to the other side
        let met = (40e3 + 15e6 * 0.03) / (1e6 + 15e6);
        let fall = 0.5 * (1e6 * met + 10e3) * (0.032 - met);
        let known =
            0.5 * 1e6 * met * met + fall + 10e3 * (0.1 - 0.032) - 0.5 * 10e3 * 0.01 + 10e3 * (0.3 - 0.02);
        for steps in [1, 2, 7, 1000] {
            let found = taken(steps);
            assert!((found - known).abs() < 1e-9 * known, "{steps}: {found} {known}");
        }
    }
}
