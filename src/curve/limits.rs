//! A curve up to the axial force that crushes the section.

use super::{CapacityLevel, ResistanceCurve};

/// Share of its capacity that the level at crushing keeps: a level must have some.
const LEFT: f64 = 1e-3;

impl ResistanceCurve {
    /// The curve with a level at the compressive capacity of the section \[N\], at which nothing is left for a moment: beyond the last level computed the capacity falls on a straight line to there, which
    /// is on the safe side of the concave interaction; without that level it would not fall at all. A capacity within the levels adds nothing.
    #[must_use]
    pub fn up_to_crushing(&self, compressive_capacity_n: Option<f64>) -> Self {
        let mut curve = self.clone();
        let bare = |level: &CapacityLevel, axial_force_n: f64| CapacityLevel {
            axial_force_n,
            capacity: level.capacity.iter().map(|[rotation, moment]| [*rotation, LEFT * moment]).collect(),
            fracture_rotation_rad: level.fracture_rotation_rad,
        };
        let last = self.levels.last().zip(compressive_capacity_n);
        let beyond = last.filter(|(level, n)| level.axial_force_n < *n);
        curve.levels.extend(beyond.map(|(level, n)| bare(level, n)));
        curve
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capacity_falls_to_nothing_at_crushing() {
        let level = |axial_force_n: f64, moment: f64| CapacityLevel {
            axial_force_n,
            capacity: vec![[0.0, moment], [0.1, 0.5 * moment]],
            fracture_rotation_rad: 0.2,
        };
        let curve = ResistanceCurve {
            stiffness_nm_rad: 1e8,
            levels: vec![level(-1e5, 80e3), level(6e5, 50e3)],
            cyclic: None,
        };
        let whole = curve.up_to_crushing(Some(1e6));
        assert!(whole.check().is_ok());
        for n in [-1e6, -1e5, 2e5, 6e5] {
            assert_eq!(whole.capacity_nm(0.05, n), curve.capacity_nm(0.05, n));
        }
        assert!((whole.capacity_nm(0.0, 8e5) / (0.5 * 1.001 * 50e3) - 1.0).abs() < 1e-12);
        assert!(whole.capacity_nm(0.0, 1e6) < 51.0);
        assert_eq!(curve.up_to_crushing(Some(5e5)), curve);
        assert_eq!(curve.up_to_crushing(None), curve);
    }
}
