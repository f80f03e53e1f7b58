//! Residual compressive capacity of a section over its plastic rotation.
//!
//! Under a compressive force `n` (over that at which the section flows as a whole) the neutral axis of a rectangle lies `n h / 2` off its middle, so a layer at `h / 4` from there, the centre of half of the section, has the
//! strain `κ h (n / 2 + 1/4)`. At the strain at which that layer breaks the section has turned by `C / (n / 2 + 1/4)`. Half a section does not bear a large force: its end is the break. A small one it bears until it is
//! gone too, which is where a push under such a force ends.

use super::{CapacityLevel, ResistanceCurve};

/// Points of the line between the force at which the section flows and that of the last push.
const POINTS: u32 = 8;
/// Share of the largest moment so far below which a layer has broken.
const BROKEN: f64 = 0.5;
/// The same of a section of layers of which the first is a small part.
const BREAKS: f64 = 0.8;

impl ResistanceCurve {
    /// Share of the compressive capacity \[N\] that is left over the plastic rotation \[rad\], from `[0, 1]` on, falling; constant behind the last point. `C` is that of the push under the largest force, which is borne up to the end
    /// of that push, and smaller forces up to the ends of theirs. Empty if no push was made under compression.
    #[must_use]
    pub fn left_under_compression(&self, capacity_n: f64) -> Vec<[f64; 2]> {
        let share = |level: &CapacityLevel| level.axial_force_n / capacity_n;
        let mut pushes = self.levels.iter().rev().filter(|l| share(l) > 0.0 && share(l) < 1.0);
        let Some(last) = pushes.next() else { return Vec::new() };
        let (least, breaks_rad) = (share(last), last.breaks_rad());
        let of_share = |n: f64| breaks_rad * (least + 0.5) / (n + 0.5);
        let shares = (0..=POINTS).rev().map(|i| least + f64::from(i) / f64::from(POINTS) * (1.0 - least));
        let mut left = vec![[0.0, 1.0]];
        left.extend(shares.map(|n| [of_share(n), n]));
        for level in std::iter::once(last).chain(pushes) {
            let end = level.fracture_rotation_rad;
            if end > left[left.len() - 1][0] {
                left.push([end, share(level)]);
            }
        }
        left
    }

    /// Plastic rotation at which the first layer breaks under the smallest axial force, or the end of the curve \[rad\]: that layer has the rupture strain of its law then, so strains are to rotations as that is to this.
    pub fn first_break_rad(&self) -> f64 {
        self.free_level().map_or(f64::INFINITY, |level| level.falls_to_rad(BREAKS))
    }
}

impl CapacityLevel {
    /// Plastic rotation at which the first layer has broken: where the capacity has fallen to half of what it was, or its end \[rad\].
    fn breaks_rad(&self) -> f64 {
        self.falls_to_rad(BROKEN)
    }

    /// Plastic rotation at which the capacity has fallen to a share of what it was, or its end \[rad\].
    fn falls_to_rad(&self, share: f64) -> f64 {
        let mut most = 0.0_f64;
        let has_broken = |p: &&[f64; 2]| {
            most = most.max(p[1]);
            p[1] < share * most
        };
        self.capacity.iter().find(has_broken).map_or(self.fracture_rotation_rad, |p| p[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::piecewise::interpolate;

    fn level(axial_force_n: f64, broken_rad: f64, end_rad: f64) -> CapacityLevel {
        let capacity = vec![[0.0, 50e3], [broken_rad - 0.01, 60e3], [broken_rad, 20e3], [end_rad, 10e3]];
        CapacityLevel { axial_force_n, capacity, fracture_rotation_rad: end_rad }
    }

    fn curve(levels: Vec<CapacityLevel>) -> ResistanceCurve {
        ResistanceCurve { stiffness_nm_rad: 1e8, levels, cyclic: None }
    }

    #[test]
    fn large_forces_are_borne_up_to_the_break_of_a_layer_and_small_ones_up_to_the_end() {
        let levels = vec![level(0.0, 0.5, 1.4), level(2e5, 0.45, 0.9), level(4e5, 0.3, 0.6)];
        let left = curve(levels).left_under_compression(1e6);
        assert_eq!(left[..1], [[0.0, 1.0]]);
        assert!(left.windows(2).all(|p| p[1][0] > p[0][0] && p[1][1] <= p[0][1]), "{left:?}");
        // strain of the layer in the middle of the half: κ h (n/2 + 1/4), the same at each break
        for n in [1.0, 0.7, 0.4] {
            let at = 0.3 * (0.2 + 0.25) / (0.5 * n + 0.25);
            assert!((interpolate(&left, at) - n).abs() < 1e-9, "{n}");
        }
        for (rotation, wanted) in [(0.1, 1.0), (0.5, 0.4), (0.6, 0.4), (0.75, 0.3), (0.9, 0.2), (2.0, 0.2)] {
            assert!((interpolate(&left, rotation) - wanted).abs() < 1e-9, "{rotation}");
        }
    }

    #[test]
    fn pushes_that_say_nothing_are_left_out() {
        assert!(
            curve(vec![level(-1e5, 0.5, 0.7), level(0.0, 0.5, 1.4)]).left_under_compression(1e6).is_empty()
        );
        // the smaller force ends before the larger one
        let left = curve(vec![level(2e5, 0.3, 0.5), level(4e5, 0.3, 0.6)]).left_under_compression(1e6);
        assert_eq!(left[left.len() - 1], [0.6, 0.4]);
        // a push whose moment never halves
        let whole = CapacityLevel { capacity: vec![[0.0, 5e4], [0.08, 5e4]], ..level(4e5, 0.05, 0.08) };
        let left = curve(vec![whole]).left_under_compression(1e6);
        assert_eq!(left[left.len() - 1], [0.08, 0.4]);
    }
}
