//! What pushes under a constant axial force leave open of a curve that works in a structure.

use super::{CapacityLevel, ResistanceCurve};
use crate::base::piecewise::{interpolate, places};

/// Share of its capacity that the level at crushing keeps: a level must have some.
const LEFT: f64 = 1e-3;
/// Places of the levels between the last one and crushing, as shares of the way.
const BETWEEN: [f64; 2] = [1.0 / 3.0, 2.0 / 3.0];
/// Share of the rotation at the end of a push from which on it is falling to its end.
const FALLING: f64 = 0.98;
/// Share of the force at which the section flows by which levels must differ.
const SAME: f64 = 1e-6;

impl ResistanceCurve {
    /// The curve of pushes past the loss of an axial force, and up to the force at which the section flows as a whole \[N\], over plastic rotation \[rad\] as it hardens; empty if that is not known.
    #[must_use]
    pub fn in_a_structure(&self, crushing: &[[f64; 2]]) -> Self {
        self.past_compression().up_to_crushing(crushing)
    }

    /// As [`Self::in_a_structure`] of a curve that was measured, or that another program gave: all its points stand as they are, also a fall under compression and the rotation at which the end breaks.
    #[must_use]
    pub fn measured_in_a_structure(&self, crushing: &[[f64; 2]]) -> Self {
        self.clone().up_to_crushing(crushing)
    }

    /// The level under the smallest axial force.
    pub fn free_level(&self) -> Option<&CapacityLevel> {
        self.levels.iter().min_by(|a, b| a.axial_force_n.abs().total_cmp(&b.axial_force_n.abs()))
    }

    /// A push under a compressive force ends when what is left of the section no longer bears that force, which goes on pressing. In a structure the force goes elsewhere then, and the parts hang together
    /// as long as without it: behind its end, a compressed level is that without axial force, as much larger or smaller as its peak is.
    fn past_compression(&self) -> Self {
        let mut curve = self.clone();
        let Some(free) = self.free_level() else { return curve };
        for level in &mut curve.levels {
            let end = level.fracture_rotation_rad;
            if level.axial_force_n <= free.axial_force_n || end >= free.fracture_rotation_rad {
                continue;
            }
            let factor = level.peak_nm() / free.peak_nm();
            level.capacity.retain(|p| p[0] < FALLING * end);
            level.capacity.push([end, factor * interpolate(&free.capacity, end)]);
            level.capacity.extend(free.capacity.iter().filter(|p| p[0] > end).map(|[x, y]| [*x, factor * y]));
            level.fracture_rotation_rad = free.fracture_rotation_rad;
        }
        curve
    }

    /// The curve with levels between the last one computed and the force at which the section flows as a whole, at which nothing is left for a moment: `1 - n²` of the plastic moment, that of a rectangle of an ideally plastic
    /// material. Without them the capacity would not fall at all. As the section hardens it bears more force, and at a force within the levels something for longer.
    fn up_to_crushing(mut self, crushing: &[[f64; 2]]) -> Self {
        let (Some(last), Some([_, first_n]), Some([_, most_n])) =
            (self.levels.last().cloned(), crushing.first(), crushing.last())
        else {
            return self;
        };
        let from_n = last.axial_force_n.max(0.0);
        let left = |axial_n: f64, rotation: f64| {
            let share = |n: f64| 1.0 - (n / interpolate(crushing, rotation)).powi(2);
            // the level that was computed bears something, whatever is said of crushing
            (share(axial_n) / share(from_n).max(LEFT)).max(LEFT)
        };
        // levels that differ by round-off only are one
        let beyond = |n: f64, other: f64| n > other + SAME * first_n.abs();
        let mut forces: Vec<f64> = BETWEEN.iter().map(|way| from_n + way * (first_n - from_n)).collect();
        forces.push(*first_n);
        forces.extend(beyond(*most_n, *first_n).then_some(*most_n));
        forces.retain(|n| beyond(*n, last.axial_force_n));
        let end = last.fracture_rotation_rad;
        let mut rotations = places(last.capacity.iter().chain(crushing));
        rotations.retain(|x| *x < end);
        rotations.push(end);
        self.levels.extend(forces.into_iter().map(|axial_force_n| {
            CapacityLevel {
                axial_force_n,
                capacity: rotations
                    .iter()
                    .map(|x| [*x, left(axial_force_n, *x) * interpolate(&last.capacity, *x)])
                    .collect(),
                ..last.clone()
            }
        }));
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(axial_force_n: f64, capacity: Vec<[f64; 2]>, fracture_rotation_rad: f64) -> CapacityLevel {
        CapacityLevel { axial_force_n, capacity, fracture_rotation_rad }
    }

    fn curve(levels: Vec<CapacityLevel>) -> ResistanceCurve {
        ResistanceCurve { stiffness_nm_rad: 1e8, levels, cyclic: None }
    }

    #[test]
    fn capacity_falls_to_nothing_at_crushing() {
        let at = |n: f64, moment: f64| level(n, vec![[0.0, moment], [0.1, 0.5 * moment]], 0.2);
        let curve = curve(vec![at(-1e5, 80e3), at(6e5, 50e3)]);
        let whole = curve.in_a_structure(&[[0.0, 1e6]]);
        assert!(whole.check().is_ok());
        for n in [-1e6, -1e5, 2e5, 6e5] {
            assert_eq!(whole.capacity_nm(0.05, n), curve.capacity_nm(0.05, n));
        }
        // 1 - n² at a third and two thirds of the way, chords between
        for way in BETWEEN {
            let n = 0.6 + 0.4 * way;
            let wanted = 50e3 * (1.0 - n * n) / (1.0 - 0.36);
            assert!((whole.capacity_nm(0.0, n * 1e6) / wanted - 1.0).abs() < 1e-12);
        }
        assert!(whole.capacity_nm(0.0, 1e6) < 51.0);
        assert_eq!(curve.in_a_structure(&[[0.0, 5e5]]), curve);
        assert_eq!(curve.in_a_structure(&[]), curve);
    }

    #[test]
    fn a_section_that_hardens_bears_more_force() {
        let at = |n: f64, moment: f64| level(n, vec![[0.0, moment], [0.4, moment]], 0.5);
        let whole = curve(vec![at(0.0, 80e3)]).in_a_structure(&[[0.0, 1e6], [0.2, 1.2e6]]);
        assert!(whole.check().is_ok());
        for (rotation, n, crushing) in [(0.0, 1e6, 1e6), (0.2, 1e6, 1.2e6), (0.4, 1e6, 1.2e6_f64)] {
            let wanted = (80e3 * (1.0 - (n / crushing).powi(2))).max(LEFT * 80e3);
            assert!((whole.capacity_nm(rotation, n) / wanted - 1.0).abs() < 1e-12, "{rotation}");
        }
        assert!(whole.capacity_nm(0.4, 1.2e6) < 81.0);
    }

    #[test]
    fn levels_differ_by_more_than_round_off_and_fall_to_their_ends() {
        // thirds of such a force do not add up to it
        for crushing_n in [1_892_802.216_666_667, 2_434_210.123_456_7, 1.0 / 3.0] {
            let at = |share: f64| level(share * crushing_n, vec![[0.0, 5e4], [0.1, 5e4], [0.4, 1e3]], 0.4);
            for last in [0.37, 1.0 - 1e-16] {
                let whole =
                    curve(vec![at(0.0), at(last)]).in_a_structure(&[[0.0, crushing_n], [0.1, crushing_n]]);
                assert!(whole.check().is_ok(), "{crushing_n}: {:?}", whole.check());
                let forces: Vec<f64> = whole.levels.iter().map(|l| l.axial_force_n).collect();
                assert!(forces.windows(2).all(|n| n[1] - n[0] > 1e-7 * crushing_n), "{forces:?}");
                assert!(whole.levels.iter().all(|l| l.capacity[l.capacity.len() - 1][1] <= 1e3));
            }
        }
    }

    #[test]
    fn a_compressed_end_goes_on_as_without_its_force() {
        let free = level(0.0, vec![[0.0, 60e3], [0.5, 60e3], [0.6, 20e3], [1.5, 10e3]], 1.5);
        let pressed = level(2e5, vec![[0.0, 80e3], [0.3, 90e3], [0.39, 30e3], [0.3999, 1e3]], 0.4);
        let pulled = level(-1e5, vec![[0.0, 40e3], [0.7, 30e3]], 0.7);
        let whole = curve(vec![pulled.clone(), free.clone(), pressed]).in_a_structure(&[]);
        assert!(whole.check().is_ok());
        assert_eq!(whole.levels[..2], [pulled, free]);
        assert_eq!(whole.levels[2].fracture_rotation_rad, 1.5);
        let at = |x: f64| whole.capacity_nm(x, 2e5);
        assert_eq!(at(0.39), 30e3);
        for (x, wanted) in [(0.45, 90e3), (0.6, 30e3), (1.5, 15e3)] {
            assert!((at(x) / wanted - 1.0).abs() < 1e-12, "{x}: {}", at(x));
        }
    }
}
