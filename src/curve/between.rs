//! Interpolation: of a curve over the axial force, and between two curves.
//!
//! **Over the axial force** the capacity at one plastic rotation is linear between neighbouring levels. It lies between
//! those of its two neighbours, so it never exceeds what was computed, and it rises or falls with the axial force
//! wherever the levels do. The true interaction of moment and axial force is concave (the strength domain of a section
//! is convex, being an intersection of half-planes: Save and Massonnet, *Plastic Analysis and Design of Plates, Shells
//! and Disks*, 1972), so the chord is on the safe side. A level that was computed up to a fracture rotation, and still had
//! resistance there, has none beyond: it contributes zero to its neighbourhood instead of its last value. Outside
//! the levels the nearest one is used and [`Capacity::out_of_range`](super::Capacity::out_of_range) is set: there the
//! curve knows nothing, and a large axial force has to be met by the crushing and tensile capacities of the joint.
//!
//! **Between two curves** ([`ResistanceCurve::between`]) capacity, stiffness and fracture rotation are linear in the share
//! of the second one, within the axial forces that both know. Values are rounded down.

use super::{CapacityLevel, ResistanceCurve};
use crate::base::piecewise::interpolate;

/// Rotation over which the resistance falls to zero at a fracture \[rad\], at least and relative to the rotation there.
const DROP_RAD: f64 = 1e-6;
const DROP_SHARE: f64 = 1e-3;

impl ResistanceCurve {
    /// Capacity at a plastic rotation \[rad\] and an axial force \[N\], compression positive: the plain form of
    /// [`CapacityTable`](super::CapacityTable).
    pub fn capacity_nm(&self, plastic_rotation_rad: f64, axial_force_n: f64) -> f64 {
        let (low, high, share) = self.neighbours(axial_force_n);
        let at = |i: usize| interpolate(&self.lasting(i), plastic_rotation_rad);
        if share > 0.0 { mixed(at(low), at(high), share) } else { at(low) }
    }

    /// Fracture rotation at an axial force \[rad\].
    pub fn fracture_rotation_rad(&self, axial_force_n: f64) -> f64 {
        let (low, high, share) = self.neighbours(axial_force_n);
        mixed(self.levels[low].fracture_rotation_rad, self.levels[high].fracture_rotation_rad, share)
    }

    /// Lowest and highest axial force of the levels \[N\].
    pub fn axial_range_n(&self) -> [f64; 2] {
        let force = |level: Option<&CapacityLevel>| level.map_or(0.0, |l| l.axial_force_n);
        [force(self.levels.first()), force(self.levels.last())]
    }

    /// The curve between `self` (share 0) and `other` (share 1); `None` if they know no axial force in common.
    ///
    /// At each plastic rotation and axial force its capacity does not exceed the linear interpolation of both (but for
    /// the last digit: values are rounded down to 9), and it is monotone in the axial force where both are.
    pub fn between(&self, other: &Self, share: f64) -> Option<Self> {
        let (a, b) = (self.axial_range_n(), other.axial_range_n());
        let (low, high) = (a[0].max(b[0]), a[1].min(b[1]));
        if low > high {
            return None;
        }
        let mut forces: Vec<f64> = self.levels.iter().chain(&other.levels).map(|l| l.axial_force_n).collect();
        forces.retain(|n| (low..=high).contains(n));
        forces.sort_by(f64::total_cmp);
        forces.dedup();
        let levels = forces.into_iter().map(|force| {
            let mut rotations = self.rotations(force);
            rotations.extend(other.rotations(force));
            rotations.sort_by(f64::total_cmp);
            rotations.dedup();
            let at = |x: f64| mixed(self.capacity_nm(x, force), other.capacity_nm(x, force), share);
            CapacityLevel {
                axial_force_n: force,
                capacity: rotations.into_iter().map(|x| [x, rounded_down(at(x))]).collect(),
                fracture_rotation_rad: rounded_down(mixed(
                    self.fracture_rotation_rad(force),
                    other.fracture_rotation_rad(force),
                    share,
                )),
            }
        });
        Some(Self {
            stiffness_nm_rad: mixed(self.stiffness_nm_rad, other.stiffness_nm_rad, share),
            levels: levels.collect(),
            cyclic: self.cyclic.zip(other.cyclic).map(|(a, b)| a.between(&b, share)),
        })
    }

    /// The levels beside an axial force and the share of the second; the nearest one twice outside.
    fn neighbours(&self, axial_force_n: f64) -> (usize, usize, f64) {
        let above = self.levels.partition_point(|l| l.axial_force_n <= axial_force_n);
        let last = self.levels.len() - 1;
        if above == 0 || above > last {
            let nearest = above.saturating_sub(1).min(last);
            return (nearest, nearest, 0.0);
        }
        let (low, high) = (self.levels[above - 1].axial_force_n, self.levels[above].axial_force_n);
        (above - 1, above, (axial_force_n - low) / (high - low))
    }

    /// The plastic rotations at which the capacity at an axial force has a kink \[rad\].
    pub(super) fn rotations(&self, axial_force_n: f64) -> Vec<f64> {
        let (low, high, share) = self.neighbours(axial_force_n);
        let own = if share > 0.0 { low..=high } else { low..=low };
        own.flat_map(|i| self.lasting(i)).map(|p| p[0]).collect()
    }

    /// The capacity of a level, led to zero behind its fracture if it ends there with resistance and another level lasts
    /// longer.
    pub(super) fn lasting(&self, level: usize) -> Vec<[f64; 2]> {
        let own = &self.levels[level];
        let longest = self.levels.iter().map(|l| l.fracture_rotation_rad).fold(0.0, f64::max);
        let end = own.fracture_rotation_rad;
        let resists = own.capacity.last().is_some_and(|p| p[1] > 0.0);
        if !resists || end >= longest {
            return own.capacity.clone();
        }
        let mut points: Vec<[f64; 2]> = own.capacity.iter().copied().filter(|p| p[0] < end).collect();
        points.push([end, interpolate(&own.capacity, end)]);
        points.push([end + DROP_RAD.max(DROP_SHARE * end), 0.0]);
        points
    }
}

/// `a` (share 0) to `b` (share 1), within both.
fn mixed(a: f64, b: f64, share: f64) -> f64 {
    (a + share * (b - a)).clamp(a.min(b), a.max(b))
}

/// The largest number with 9 significant digits that is not above `x`, a positive number or zero.
fn rounded_down(x: f64) -> f64 {
    if x <= 0.0 || !x.is_finite() {
        return x;
    }
    let digits = |value: f64| format!("{value:.8e}").parse().unwrap_or(value);
    let near: f64 = digits(x);
    if near <= x { near } else { digits(near - 10f64.powi(libm::log10(near).floor() as i32 - 8)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{CapacityHint, CapacityTable};
    use proptest::prelude::*;

    /// A random curve: up to five levels, each rising or falling, some ending with resistance.
    fn curves() -> impl Strategy<Value = ResistanceCurve> {
        let level = (
            prop::collection::vec((1e-4..0.05f64, 0.0..3e5f64), 1..7),
            1e3..3e5f64,
            0.3..1.5f64,
            -6e5..6e5f64,
            any::<bool>(),
        );
        (prop::collection::vec(level, 1..6), 1e6..1e8f64).prop_map(|(levels, stiffness_nm_rad)| {
            let mut force = -1e6;
            let levels = levels.into_iter().map(|(steps, first, reach, gap, drop)| {
                force += 1e4 + gap.abs();
                let mut capacity = vec![[0.0, first]];
                for (step, moment) in steps {
                    let x: f64 = capacity[capacity.len() - 1][0];
                    capacity.push([x + step, moment]);
                }
                let end = capacity[capacity.len() - 1][0];
                if drop {
                    capacity.push([end + 0.01, 0.0]);
                }
                CapacityLevel { axial_force_n: force, capacity, fracture_rotation_rad: end * reach }
            });
            ResistanceCurve { stiffness_nm_rad, levels: levels.collect(), cyclic: None }
        })
    }

    /// Levels sorted so that the capacity at each rotation falls with the axial force.
    fn falling(curve: &ResistanceCurve) -> ResistanceCurve {
        let mut factor = 1.0;
        let first = curve.levels[0].clone();
        let levels = curve.levels.iter().map(|l| {
            factor *= 0.83;
            let capacity = first.capacity.iter().map(|p| [p[0], factor * p[1]]).collect();
            CapacityLevel { axial_force_n: l.axial_force_n, capacity, ..first.clone() }
        });
        ResistanceCurve { levels: levels.collect(), ..curve.clone() }
    }

    fn at_share(range: [f64; 2], share: f64) -> f64 {
        range[0] + share * (range[1] - range[0])
    }

    proptest! {
        #[test]
        fn a_capacity_lies_between_those_of_its_neighbours(
            curve in curves(), x in 0.0..0.4f64, share in 0.0..=1.0f64
        ) {
            let force = at_share(curve.axial_range_n(), share);
            let (low, high, _) = curve.neighbours(force);
            let [a, b] = [low, high].map(|i| interpolate(&curve.lasting(i), x));
            let c = curve.capacity_nm(x, force);
            prop_assert!(c >= a.min(b) && c <= a.max(b), "{a} {c} {b}");
            // What a level has lost by fracture does not come back from its neighbour.
            for i in [low, high] {
                let l = &curve.levels[i];
                if x > 1.0011 * l.fracture_rotation_rad + 1e-5 && interpolate(&l.capacity, f64::MAX) > 0.0
                    && l.fracture_rotation_rad < curve.levels.iter().map(|l| l.fracture_rotation_rad).fold(0.0, f64::max) {
                    prop_assert_eq!(interpolate(&curve.lasting(i), x), 0.0);
                }
            }
        }

        #[test]
        fn the_table_of_the_time_loop_agrees_and_says_when_it_is_out_of_range(
            curve in curves(), x in 0.0..0.4f64, share in -0.5..1.5f64
        ) {
            let range = curve.axial_range_n();
            let force = at_share([range[0] - 1.0, range[1] + 1.0], share);
            let table = CapacityTable::new(&curve, 1.0).unwrap();
            let found = table.capacity(x, force, &mut CapacityHint::default());
            prop_assert_eq!(found.out_of_range, force < range[0] || force > range[1]);
            prop_assert!((found.moment_nm - curve.capacity_nm(x, force)).abs() <= 1e-9 * curve.peak_nm());
            let nearest = force.clamp(range[0], range[1]);
            prop_assert_eq!(found.moment_nm, table.capacity(x, nearest, &mut CapacityHint::default()).moment_nm);
        }

        #[test]
        fn falling_levels_give_a_falling_capacity(
            curve in curves(), x in 0.0..0.4f64, s in 0.0..=1.0f64, t in 0.0..=1.0f64
        ) {
            let curve = falling(&curve);
            let range = curve.axial_range_n();
            let at = |share| curve.capacity_nm(x, at_share(range, share));
            prop_assert!(at(s.min(t)) >= at(s.max(t)) * (1.0 - 1e-15));
        }

        #[test]
        fn a_curve_between_two_never_exceeds_their_mixture(
            a in curves(), b in curves(), share in 0.0..=1.0f64, x in 0.0..0.4f64, s in 0.0..=1.0f64
        ) {
            let Some(between) = a.between(&b, share) else { return Ok(()) };
            between.check().ok();
            let force = at_share(between.axial_range_n(), s);
            let mixture = mixed(a.capacity_nm(x, force), b.capacity_nm(x, force), share);
            let found = between.capacity_nm(x, force);
            prop_assert!(found <= mixture + 1e-12 * a.peak_nm().max(b.peak_nm()), "{found} {mixture}");
            if between.levels.len() > 1 || a.levels.len() == 1 {
                let fracture = mixed(a.fracture_rotation_rad(force), b.fracture_rotation_rad(force), share);
                prop_assert!(between.fracture_rotation_rad(force) <= fracture * (1.0 + 1e-12));
            }
        }

        #[test]
        fn between_two_falling_curves_lies_a_falling_one(
            a in curves(), b in curves(), share in 0.0..=1.0f64, x in 0.0..0.4f64, s in 0.0..=1.0f64, t in 0.0..=1.0f64
        ) {
            let Some(between) = falling(&a).between(&falling(&b), share) else { return Ok(()) };
            let at = |share| between.capacity_nm(x, at_share(between.axial_range_n(), share));
            prop_assert!(at(s.min(t)) >= at(s.max(t)) * (1.0 - 1e-15));
        }

        #[test]
        fn rounding_down_never_rounds_up(x in 1e-9..1e9f64) {
            let y = rounded_down(x);
            prop_assert!(y <= x && y >= x * (1.0 - 1.01e-8), "{x} {y}");
        }
    }
}
