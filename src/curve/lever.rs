//! The moment of an axial force about a hinge that stands away from the section in whose centre the force acts.

use super::ResistanceCurve;
use crate::base::piecewise::{interpolate, places};

/// Distance of the rotations at which the lever is looked at beside those of the curve \[rad\]: chords between are off by `1 - cos` of half of it.
const EVERY_RAD: f64 = 0.1;
/// Share of its capacity that a hinge keeps under tension, whose moment about it helps to turn it.
const LEFT: f64 = 1e-3;

impl ResistanceCurve {
    /// The curve of a push as a hinge at some distance from the end section needs it \[m\], for the distance of the far section \[m\].
    ///
    /// A push tells the moment `M` of its end section, as `M (1 - c / l)` where the hinge stands. Its axial force is in the chord, from the centre of the far section to that of the end section, so that it does no work on `M`. It
    /// does on a hinge at a distance `c`: a rigid member that turns there brings the far section nearer, and stands still only if the hinge bears the moment of the force about it as well, `N c sin θ` for a chord rotation `θ`.
    /// That is `-N dr/dφ` with the chord `r² = c² + d² + 2 c d cos φ`, `d = l - c`, as virtual work has it.
    #[must_use]
    pub fn at_distance(&self, offset_m: f64, length_m: f64) -> Self {
        let arm_m = length_m - offset_m;
        if offset_m <= 0.0 || arm_m <= 0.0 {
            return self.clone();
        }
        let lever_m = |turn_rad: f64| {
            let (sin, cos) = libm::sincos(turn_rad);
            let chord_m = (offset_m * offset_m + arm_m * arm_m + 2.0 * offset_m * arm_m * cos).sqrt();
            offset_m * arm_m * sin / chord_m
        };
        let mut curve = self.clone();
        for level in &mut curve.levels {
            let end = level.fracture_rotation_rad;
            let between: Vec<[f64; 2]> =
                (1..).map(|i| [f64::from(i) * EVERY_RAD, 0.0]).take_while(|p| p[0] < end).collect();
            let with_lever = |plastic_rad: f64| {
                let moment_nm = interpolate(&level.capacity, plastic_rad);
                let turn_rad = plastic_rad + moment_nm / self.stiffness_nm_rad;
                let lever_nm = level.axial_force_n * lever_m(turn_rad.min(std::f64::consts::PI));
                [plastic_rad, (moment_nm + lever_nm).max(LEFT * moment_nm)]
            };
            level.capacity = places(level.capacity.iter().chain(&between).chain(&[[end, 0.0]]))
                .into_iter()
                .map(with_lever)
                .collect();
        }
        curve
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CapacityLevel;

    const OFFSET_M: f64 = 0.4;
    const LENGTH_M: f64 = 1.3;

    fn curve(axial_force_n: f64, capacity: Vec<[f64; 2]>) -> ResistanceCurve {
        let levels = vec![CapacityLevel { axial_force_n, capacity, fracture_rotation_rad: 1.2 }];
        ResistanceCurve { stiffness_nm_rad: 4e7, levels, cyclic: None }
    }

    /// The far section of a rigid member that has turned at the hinge, from the centre of the end section along and across the member \[m\].
    fn far(turn_rad: f64) -> [f64; 2] {
        let arm_m = LENGTH_M - OFFSET_M;
        [OFFSET_M + arm_m * turn_rad.cos(), arm_m * turn_rad.sin()]
    }

    #[test]
    fn a_hinge_bears_what_the_forces_of_a_push_have_about_it() {
        let (moment_nm, axial_n) = (90e3, 1.2e6);
        let whole = curve(axial_n, vec![[0.0, moment_nm]]).at_distance(OFFSET_M, LENGTH_M);
        assert!(whole.check().is_ok());
        for plastic_rad in [0.0, 0.05, 0.13, 0.4, 0.97] {
            // the force in the chord acts on the far section, and turns about the hinge
            let [along, across] = far(plastic_rad + moment_nm / whole.stiffness_nm_rad);
            let chord = along.hypot(across);
            let force = [-axial_n * along / chord, -axial_n * across / chord];
            let wanted = moment_nm + (along - OFFSET_M) * force[1] - across * force[0];
            let found = whole.capacity_nm(plastic_rad, axial_n);
            // chords between tenths
            assert!((found / wanted - 1.0).abs() < 1e-3, "{plastic_rad}: {found} {wanted}");
        }
    }

    #[test]
    fn its_work_is_that_of_the_force_on_the_chord() {
        let axial_n = 5e5;
        let plain = curve(axial_n, vec![[0.0, 80e3], [0.3, 60e3], [0.5, 1e3], [1.2, 1e3]]);
        let whole = plain.at_distance(OFFSET_M, LENGTH_M);
        let [from, to] = [[0.0, 80e3], [1.2, 1e3]].map(|[rad, nm]| {
            let [along, across] = far(rad + nm / plain.stiffness_nm_rad);
            along.hypot(across)
        });
        let more = whole.levels[0].energy_j() - plain.levels[0].energy_j();
        assert!((more / (axial_n * (from - to)) - 1.0).abs() < 0.01, "{more} {}", axial_n * (from - to));
    }

    #[test]
    fn nothing_changes_without_a_distance_or_a_force_and_tension_leaves_something() {
        let plain = curve(3e5, vec![[0.0, 80e3], [1.2, 80e3]]);
        assert_eq!(plain.at_distance(0.0, LENGTH_M), plain);
        let unloaded = curve(0.0, vec![[0.0, 80e3], [1.2, 80e3]]).at_distance(OFFSET_M, LENGTH_M);
        assert!(unloaded.levels[0].capacity.iter().all(|p| p[1] == 80e3));
        let pulled = curve(-3e5, vec![[0.0, 80e3], [0.6, 1e3], [1.2, 1e3]]).at_distance(OFFSET_M, LENGTH_M);
        assert!(pulled.check().is_ok());
        assert!(pulled.capacity_nm(0.1, -3e5) < 68e3 && pulled.capacity_nm(1.0, -3e5) == 1.0);
    }
}
