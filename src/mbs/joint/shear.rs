//! Shear of a compliant joint: elastic up to an ellipse of forces along axes 1 and 2, where it separates, or slips as far as it may.
//!
//! The force returns to the ellipse `(V_1/C_1)² + (V_2/C_2)² = 1` in its own direction, so that slip has never negative work;
//! that work is the mean of the forces at the start and the end of the step times the slip, which with the elastic energy is the
//! work of the trapezoidal rule exactly, as for the axial spring. What a force that begins to slip within the step does beyond that
//! mean is added to it ([`crate::curve::onset`]).

use crate::curve::onset::{Course, added};

/// Share of the ellipse from which a force counts as on it.
const ON_IT: f64 = 1.0 - 1e-9;

/// Shear springs with a capacity, and their history; vectors are along axes 1 and 2 of the joint.
#[derive(Debug, Clone, Default)]
pub(in crate::mbs) struct Shear {
    /// `1/C²` of the forces along the axes \[1/N²\]; zero: no limit.
    pub inverse2: [f64; 2],
    /// Slip after which it separates; zero: at once \[m\].
    most_m: f64,
    /// Force of the last evaluation \[N\], and square of its share of the capacity.
    pub force: [f64; 2],
    used2: f64,
    /// Plastic part of the gap, and the length of its path \[m\].
    pub slid: [f64; 2],
    path_m: f64,
    /// How the force went in the last evaluation, if it slipped, and how far \[m\].
    slip: Option<([Course; 2], f64)>,
}

/// What slipping has done in an evaluation.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Slipped {
    /// Dissipated energy \[J\].
    pub work_j: f64,
    /// What is added to the force for the step to come \[N\].
    pub onset: [f64; 2],
}

impl Shear {
    /// With capacities along both axes \[N\] and a slip \[m\].
    pub fn new(capacity_n: Option<[f64; 2]>, slip_m: Option<f64>) -> Self {
        Self {
            inverse2: capacity_n.map_or([0.0; 2], |c| c.map(|c| 1.0 / (c * c))),
            most_m: slip_m.unwrap_or(0.0),
            ..Self::default()
        }
    }

    /// Multiplies the capacities.
    pub fn strengthen(&mut self, ratio: f64) {
        self.inverse2 = self.inverse2.map(|inverse| inverse / (ratio * ratio));
    }

    /// Product of two forces \[N\] as shares of the capacities.
    pub fn product(&self, f: [f64; 2], g: [f64; 2]) -> f64 {
        f[0] * g[0] * self.inverse2[0] + f[1] * g[1] * self.inverse2[1]
    }

    /// Whether it slips at its capacity before it separates.
    pub fn slips(&self) -> bool {
        self.most_m > 0.0
    }

    /// Whether it has separated.
    pub fn is_off(&self) -> bool {
        if self.slips() { self.path_m >= self.most_m } else { self.used2 >= 1.0 }
    }

    /// How it slipped in the last evaluation, and the share of the step after which it had slipped as far as it may; none if it did not.
    pub fn course(&self) -> Option<([Course; 2], f64)> {
        let (courses, way_m) = self.slip.filter(|_| self.product(self.force, self.force) >= ON_IT)?;
        let beyond = ((self.path_m - self.most_m) / way_m).clamp(0.0, 1.0);
        Some((courses, courses[0].after_flow(1.0 - beyond)))
    }

    /// Takes the force that springs with stiffnesses \[N/m\] have at elastic gaps \[m\], which lose what slips.
    #[inline]
    pub(super) fn load(&mut self, stiffness: [f64; 2], gap: [&mut f64; 2]) -> Slipped {
        let trial = [stiffness[0] * *gap[0], stiffness[1] * *gap[1]];
        let old = std::mem::replace(&mut self.force, trial);
        self.used2 = self.product(trial, trial);
        self.slip = None;
        if self.used2 <= 1.0 || !self.slips() {
            return Slipped::default();
        }
        self.slide(stiffness, gap, old)
    }

    #[cold]
    fn slide(&mut self, stiffness: [f64; 2], gap: [&mut f64; 2], old: [f64; 2]) -> Slipped {
        let trial = self.force;
        let left = 1.0 / self.used2.sqrt();
        let end = trial.map(|v| left * v);
        let from = self.reaches(old, trial);
        let mut slipped = Slipped::default();
        let (mut courses, mut way2) = ([Course::default(); 2], 0.0);
        for (k, gap) in gap.into_iter().enumerate() {
            let flow = if stiffness[k] > 0.0 { (trial[k] - end[k]) / stiffness[k] } else { 0.0 };
            *gap -= flow;
            self.slid[k] += flow;
            way2 += flow * flow;
            slipped.work_j += 0.5 * (old[k] + end[k]) * flow;
            let onset = from.map(|share| [share, old[k] + share * (trial[k] - old[k])]);
            slipped.onset[k] = onset.map_or(0.0, |[share, capacity]| added(old[k], capacity, end[k], share));
            courses[k] = Course::flowing(old[k], end[k], flow, onset);
        }
        (self.force, self.used2) = (end, 1.0);
        self.path_m += way2.sqrt();
        self.slip = Some((courses, way2.sqrt()));
        slipped
    }

    /// The share of the step at which a force that grows in proportion reaches the ellipse; none if it was on it.
    fn reaches(&self, begin: [f64; 2], end: [f64; 2]) -> Option<f64> {
        let change = [end[0] - begin[0], end[1] - begin[1]];
        let (a, b, c) =
            (self.product(change, change), self.product(begin, change), 1.0 - self.product(begin, begin));
        // a s² + 2 b s = c
        (c > 1.0 - ON_IT).then(|| c / (b + (b * b + a * c).sqrt()))
    }

    /// The same for courses of forces that stay elastic, infinite where they do not reach it or may slip.
    pub fn parts_at(&self, along: [Course; 2]) -> f64 {
        let (begin, end) = (along.map(|f| f.at(0.0)), along.map(|f| f.at(1.0)));
        if self.slips() || self.product(end, end) < 1.0 {
            return f64::INFINITY;
        }
        self.reaches(begin, end).unwrap_or(0.0)
    }
}
