//! How much the curves of the RC submodel depend on the mesh: the same bends in elements of twice the size.

use crate::rc::Series;
use crate::rc::series::Case;

/// Size of the elements compared with, in sizes of the entry's own.
pub const COARSER: f64 = 2.0;

/// Change from one mesh to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshChange {
    /// Size of the other mesh's elements \[m\].
    pub other_size_m: f64,
    /// Largest relative change of a peak moment.
    pub peak: f64,
    /// Largest relative change of a rotation at 80 % of the peak; `None`: no pair of bends reached it.
    pub rotation_80: Option<f64>,
}

impl MeshChange {
    /// Change from a series to one in other elements, over the bends that both have.
    ///
    /// # Errors
    /// In words, if the meshes are the same or no bend of one has its counterpart.
    pub fn between(own: &Series, other: &Series) -> Result<Self, String> {
        if own.elements == other.elements {
            return Err(format!("the mesh is the same with elements of {} m", other.options.mesh_size_m));
        }
        let pairs: Vec<(&Case, &Case)> = own
            .cases
            .iter()
            .filter_map(|c| {
                let same = |o: &&Case| o.axial_share == c.axial_share && o.direction_deg == c.direction_deg;
                Some((c, other.cases.iter().find(same)?))
            })
            .collect();
        let change = |a: f64, b: f64| (b / a - 1.0).abs();
        let figures = || pairs.iter().filter_map(|(a, b)| Some((a.figures?, b.figures?)));
        let largest = |changes: &mut dyn Iterator<Item = f64>| changes.reduce(f64::max);
        let peak = largest(&mut figures().map(|(a, b)| change(a.peak_nm, b.peak_nm)));
        let rotation_80 =
            largest(&mut figures().filter_map(|(a, b)| Some(change(a.rotation_80_rad?, b.rotation_80_rad?))));
        Ok(Self {
            other_size_m: other.options.mesh_size_m,
            peak: peak.ok_or("no bend runs in both meshes")?,
            rotation_80,
        })
    }
}

/// Largest relative difference of the peak moment between two opposite directions of a series; `None` if there are no such two.
pub fn asymmetry(series: &Series) -> Option<f64> {
    let opposite = |a: &Case| {
        let turned = |b: &&Case| b.axial_share == a.axial_share && b.direction_deg == a.direction_deg + 180.0;
        series.cases.iter().find(turned).and_then(|b| b.figures)
    };
    let difference = |a: &Case| {
        let (a, b) = (a.figures?.peak_nm, opposite(a)?.peak_nm);
        Some((a - b).abs() / a.max(b))
    };
    series.cases.iter().filter_map(difference).reduce(f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rc::SeriesOptions;
    use crate::rc::series::Figures;

    fn series(elements: usize, cases: &[(f64, f64, f64, Option<f64>)]) -> Series {
        let case =
            |&(axial_share, direction_deg, peak_nm, rotation_80_rad): &(f64, f64, f64, Option<f64>)| Case {
                pace: 1.0,
                axial_share,
                axial_n: 0.0,
                direction_deg,
                bent: Err(crate::rc::bend::BendError::NotFinite { rotation_rad: 0.0 }),
                figures: Some(Figures {
                    peak_nm,
                    peak_rotation_rad: 0.01,
                    yield_rotation_rad: 0.005,
                    rotation_80_rad,
                    rotation_20_rad: None,
                }),
                hysteresis: None,
                curve: None,
                fibre_peak_nm: None,
                shear: None,
                seconds: 0.0,
            };
        Series {
            options: SeriesOptions::default(),
            elements: [elements, 0],
            length_m: 1.0,
            cases: cases.iter().map(case).collect(),
        }
    }

    #[test]
    fn the_largest_change_of_bends_that_both_have() {
        let own =
            series(800, &[(0.0, 90.0, 100.0, None), (0.3, 90.0, 200.0, Some(0.02)), (0.6, 90.0, 1.0, None)]);
        let other = series(100, &[(0.3, 90.0, 190.0, Some(0.03)), (0.0, 90.0, 102.0, Some(0.04))]);
        let change = MeshChange::between(&own, &other).unwrap();
        assert!((change.peak - 0.05).abs() < 1e-12);
        assert!((change.rotation_80.unwrap() - 0.5).abs() < 1e-12);
        assert!(MeshChange::between(&own, &series(800, &[])).unwrap_err().contains("the same"));
        assert!(MeshChange::between(&own, &series(100, &[])).is_err());
    }

    #[test]
    fn asymmetry_is_between_opposite_directions_only() {
        let both = series(1, &[(0.0, 90.0, 80.0, None), (0.0, 270.0, 100.0, None), (0.0, 0.0, 10.0, None)]);
        assert!((asymmetry(&both).unwrap() - 0.2).abs() < 1e-12);
        assert_eq!(asymmetry(&series(1, &[(0.0, 90.0, 80.0, None), (0.1, 270.0, 90.0, None)])), None);
    }
}
