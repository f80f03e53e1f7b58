//! Fast evaluation of a capacity: all levels on one common grid of plastic rotations.
//!
//! Each level is piecewise linear in the plastic rotation; on the union of all break points the
//! interpolation in both directions stays exact and one segment search serves every level. What the interpolation
//! may and may not do is said in [`super::between`].

use super::{CurveError, ResistanceCurve};
use crate::base::piecewise::interpolate;

/// A capacity ready for the time loop.
#[derive(Debug, Clone, PartialEq)]
pub struct CapacityTable {
    stiffness_nm_rad: f64,
    alpha: Vec<f64>,
    force: Vec<f64>,
    /// Capacity at `[alpha * levels + level]` \[N m\].
    value: Vec<f64>,
    fracture: Vec<f64>,
    peak: f64,
    /// `-dC/dN` \[m\] and the capacity \[N m\] at the levels, means over [`EARLY_RAD`].
    early: Vec<[f64; 2]>,
}

/// Plastic rotation over whose mean the resistance of a hinge depends on its axial force, for [`CapacityTable::shortening_m`] \[rad\]: further on, the points of single pushes say more of their ends than of that.
const EARLY_RAD: f64 = 0.05;

/// The segments used last; a search starts there.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CapacityHint {
    alpha: u32,
    force: u32,
}

/// Where an axial force lies among the levels.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxialLevel {
    below: usize,
    weight: f64,
    out_of_range: bool,
}

impl AxialLevel {
    /// Between the values of something at the levels about it.
    #[inline]
    fn between(self, of: impl Fn(usize) -> f64) -> f64 {
        let low = of(self.below);
        if self.weight > 0.0 { low + self.weight * (of(self.below + 1) - low) } else { low }
    }
}

/// A bound of the capacity between two levels of axial force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearby {
    /// From and below which axial force it holds \[N\].
    pub force_n: [f64; 2],
    /// The capacity is at least this \[N m\].
    pub least_nm: f64,
}

/// Result of one evaluation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Capacity {
    /// Capacity `C` \[N m\].
    pub moment_nm: f64,
    /// Slope `dC/dα` \[N m/rad\], that of the segment to the right.
    pub slope_nm_rad: f64,
    /// Whether the axial force lies outside the levels (the nearest one is used).
    pub out_of_range: bool,
}

impl CapacityTable {
    /// Compiles a curve; `factor` scales the capacity (not the stiffness).
    pub fn new(curve: &ResistanceCurve, factor: f64) -> Result<Self, CurveError> {
        curve.check()?;
        let lines: Vec<Vec<[f64; 2]>> = (0..curve.levels.len()).map(|level| curve.lasting(level)).collect();
        let mut alpha: Vec<f64> = lines.iter().flatten().map(|p| p[0]).collect();
        alpha.sort_by(f64::total_cmp);
        alpha.dedup_by(|a, b| *a - *b <= 1e-12);
        let mut value = Vec::with_capacity(alpha.len() * curve.levels.len());
        for &a in &alpha {
            value.extend(lines.iter().map(|line| factor * interpolate(line, a)));
        }
        let means: Vec<f64> = lines.iter().map(|line| factor * mean(line, EARLY_RAD)).collect();
        let force: Vec<f64> = curve.levels.iter().map(|l| l.axial_force_n).collect();
        Ok(Self {
            early: slopes(&force, &means).iter().zip(&means).map(|(slope, mean)| [-slope, *mean]).collect(),
            stiffness_nm_rad: curve.stiffness_nm_rad,
            alpha,
            force,
            value,
            fracture: curve.levels.iter().map(|l| l.fracture_rotation_rad).collect(),
            peak: factor * curve.peak_nm(),
        })
    }

    /// Elastic stiffness \[N m/rad\].
    pub fn stiffness_nm_rad(&self) -> f64 {
        self.stiffness_nm_rad
    }

    /// Largest capacity of any level \[N m\].
    pub fn peak_nm(&self) -> f64 {
        self.peak
    }

    /// Largest change of the capacity without plastic rotation over that of the axial force, in either sense \[m\].
    pub fn steepest_m(&self) -> f64 {
        let of = |i: usize| (self.value[i] - self.value[i - 1]) / (self.force[i] - self.force[i - 1]);
        (1..self.force.len()).map(of).fold(0.0, |most, slope| slope.abs().max(most))
    }

    /// The levels about an axial force \[N\] (compression positive), the same for all rotations of a step.
    #[inline]
    pub fn level(&self, axial_force_n: f64, hint: &mut CapacityHint) -> AxialLevel {
        let force = axial_force_n;
        let last = self.force.len() - 1;
        if force <= self.force[0] {
            return AxialLevel { below: 0, weight: 0.0, out_of_range: force < self.force[0] };
        }
        // also if it is no number, which whoever looks at the moments finds out
        if force >= self.force[last] || force.is_nan() {
            return AxialLevel {
                below: last.saturating_sub(1),
                weight: if last == 0 { 0.0 } else { 1.0 },
                out_of_range: force > self.force[last],
            };
        }
        let mut i = (hint.force as usize).min(last - 1);
        while force < self.force[i] {
            i -= 1;
        }
        while force >= self.force[i + 1] {
            i += 1;
        }
        hint.force = i as u32;
        AxialLevel {
            below: i,
            weight: (force - self.force[i]) / (self.force[i + 1] - self.force[i]),
            out_of_range: false,
        }
    }

    /// A lower bound of the capacity at a rotation between the levels about an axial force; none if either is outside the segments used last.
    #[inline]
    pub fn nearby(&self, alpha: f64, axial_force_n: f64, hint: &CapacityHint) -> Option<Nearby> {
        let last = self.force.len() - 1;
        let (levels, force_n) = if axial_force_n < self.force[0] {
            ([0, 0], [f64::NEG_INFINITY, self.force[0]])
        } else if axial_force_n >= self.force[last] || axial_force_n.is_nan() {
            ([last, last], [self.force[last], f64::INFINITY])
        } else {
            let i = hint.force as usize;
            ([i, i + 1], [self.force[i], self.force[i + 1]])
        };
        let inside = force_n[0] <= axial_force_n && axial_force_n < force_n[1];
        let least_nm = self.least_nm(alpha, levels, hint)?;
        inside.then_some(Nearby { force_n, least_nm })
    }

    /// The same for all axial forces.
    pub fn anywhere(&self, alpha: f64, hint: &CapacityHint) -> Option<Nearby> {
        let least_nm = self.least_nm(alpha, [0, self.force.len() - 1], hint)?;
        Some(Nearby { force_n: [f64::NEG_INFINITY, f64::INFINITY], least_nm })
    }

    #[inline]
    fn least_nm(&self, alpha: f64, [low, high]: [usize; 2], hint: &CapacityHint) -> Option<f64> {
        let (i, last) = (hint.alpha as usize, self.alpha.len() - 1);
        let rows = if alpha >= self.alpha[last] {
            last..=last
        } else if self.alpha[i] <= alpha && alpha < self.alpha[i + 1] {
            i..=i + 1
        } else {
            return None;
        };
        let levels = self.force.len();
        let values = rows.flat_map(|row| &self.value[row * levels + low..=row * levels + high]);
        Some(values.fold(f64::INFINITY, |least, v| least.min(*v)))
    }

    /// Capacity at accumulated plastic rotation `alpha` \[rad\] and axial force `axial_force_n`
    /// (compression positive).
    #[inline]
    pub fn capacity(&self, alpha: f64, axial_force_n: f64, hint: &mut CapacityHint) -> Capacity {
        self.capacity_at(alpha, self.level(axial_force_n, hint), hint)
    }

    /// The same between known levels.
    #[inline]
    pub fn capacity_at(&self, alpha: f64, at: AxialLevel, hint: &mut CapacityHint) -> Capacity {
        let out_of_range = at.out_of_range;
        let levels = self.force.len();
        let last = self.alpha.len() - 1;
        let at = |i: usize| at.between(|level| self.value[i * levels + level]);
        if alpha >= self.alpha[last] {
            return Capacity { moment_nm: at(last), slope_nm_rad: 0.0, out_of_range };
        }
        let mut i = (hint.alpha as usize).min(last - 1);
        while i > 0 && alpha < self.alpha[i] {
            i -= 1;
        }
        while alpha >= self.alpha[i + 1] {
            i += 1;
        }
        hint.alpha = i as u32;
        let (c0, c1) = (at(i), at(i + 1));
        let slope = (c1 - c0) / (self.alpha[i + 1] - self.alpha[i]);
        Capacity { moment_nm: c0 + slope * (alpha - self.alpha[i]), slope_nm_rad: slope, out_of_range }
    }

    /// Plastic shortening for each radian of plastic rotation \[m\] by normality to the surface `|M| = C(N)`, `-dC/dN`, where the capacity is `capacity_nm`, under an axial force (compression positive); at most as much
    /// as keeps the dissipation `C + N s` positive. A section that turns under compression turns about an axis beside its centre (Jirásek and Bažant, Inelastic Analysis of Structures, 2002, chapter 7).
    #[inline]
    pub fn shortening_m(&self, at: AxialLevel, capacity_nm: f64, axial_force_n: f64) -> f64 {
        let [axis_m, mean_nm] = [0, 1].map(|k| at.between(|level| self.early[level][k]));
        if mean_nm <= 0.0 {
            return 0.0;
        }
        let axis_m = axis_m * capacity_nm / mean_nm;
        if axis_m * axial_force_n < -capacity_nm { -capacity_nm / axial_force_n } else { axis_m }
    }

    /// Accumulated plastic rotation at which the section separates \[rad\].
    #[inline]
    pub fn fracture_rotation_rad(&self, axial_force_n: f64, hint: &mut CapacityHint) -> f64 {
        self.level(axial_force_n, hint).between(|level| self.fracture[level])
    }
}

/// Mean of a piecewise linear function from zero to some place.
fn mean(line: &[[f64; 2]], end: f64) -> f64 {
    let inside = line.iter().copied().filter(|p| p[0] > 0.0 && p[0] < end);
    let all: Vec<[f64; 2]> = std::iter::once([0.0, interpolate(line, 0.0)])
        .chain(inside)
        .chain([[end, interpolate(line, end)]])
        .collect();
    all.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum::<f64>() / end
}

/// Slopes at points: of the parabola through each and its neighbours, of the line at both ends; none of a single one.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let of: Vec<f64> = (1..x.len()).map(|i| (y[i] - y[i - 1]) / (x[i] - x[i - 1])).collect();
    (0..x.len())
        .map(|i| match (i.checked_sub(1).and_then(|k| of.get(k)), of.get(i)) {
            (Some(before), Some(after)) => {
                (before * (x[i + 1] - x[i]) + after * (x[i] - x[i - 1])) / (x[i + 1] - x[i - 1])
            }
            (Some(slope), None) | (None, Some(slope)) => *slope,
            (None, None) => 0.0,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CapacityLevel;

    /// A rectangle of one strength: `M = M_p (1 - n²)`, which turns about an axis `2 n M_p / N_p = n h / 2` beside its centre.
    #[test]
    fn a_plastic_rectangle_turns_about_its_neutral_axis() {
        let (squash_n, depth_m) = (1e6, 0.4);
        let plastic_nm = 0.25 * squash_n * depth_m;
        let level = |k: i32| {
            let share = f64::from(k) / 10.0;
            let moment = plastic_nm * (1.0 - share * share);
            let capacity = vec![[0.0, moment], [0.02, moment], [1.0, 0.5 * moment]];
            CapacityLevel { axial_force_n: share * squash_n, capacity, fracture_rotation_rad: 1.0 }
        };
        let levels: Vec<CapacityLevel> = (-8..=8).map(level).collect();
        let curve = ResistanceCurve { stiffness_nm_rad: 1e7, levels, cyclic: None };
        let table = CapacityTable::new(&curve, 1.0).unwrap();
        for share in [-0.7, -0.3, 0.0, 0.3, 0.5] {
            let at = table.level(share * squash_n, &mut CapacityHint::default());
            let capacity_nm = plastic_nm * (1.0 - share * share);
            let axis_m = table.shortening_m(at, capacity_nm, share * squash_n);
            assert!((axis_m - 0.5 * share * depth_m).abs() < 1e-9, "{share}: {axis_m}");
        }
        let single = ResistanceCurve { levels: curve.levels[..1].to_vec(), ..curve };
        let table = CapacityTable::new(&single, 1.0).unwrap();
        assert_eq!(table.shortening_m(table.level(1e5, &mut CapacityHint::default()), plastic_nm, 1e5), 0.0);
    }

    /// A run that goes wrong is told by whoever looks at its residuals; its curves do not panic before.
    #[test]
    fn a_force_that_is_no_number_has_a_level() {
        let level = |n: f64| {
            let capacity = vec![[0.0, 1.0], [0.1, 0.5]];
            CapacityLevel { axial_force_n: n, capacity, fracture_rotation_rad: 0.1 }
        };
        for levels in [vec![level(0.0)], vec![level(0.0), level(1e3)]] {
            let curve = ResistanceCurve { stiffness_nm_rad: 1e3, levels, cyclic: None };
            let table = CapacityTable::new(&curve, 1.0).unwrap();
            let hint = &mut CapacityHint::default();
            assert_eq!(table.level(f64::NAN, hint).below, curve.levels.len().saturating_sub(2));
            assert!(table.nearby(0.01, f64::NAN, hint).is_none());
        }
    }
}
