//! Mass properties of sets of boxes: exact sums, no sampling.

use crate::base::geom::Aabb;
use serde::Serialize;

/// Mass, centre and inertia of a rigid set of boxes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MassProperties {
    /// Volume \[m³\].
    pub volume_m3: f64,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass \[m\]; the origin if there is no mass.
    pub center_m: [f64; 3],
    /// Inertia tensor about the centre of mass, global axes \[kg m²\].
    pub inertia_kg_m2: [[f64; 3]; 3],
}

impl MassProperties {
    /// Of disjoint boxes, each with its density \[kg/m³\], summed in the given order.
    ///
    /// A box of mass `m` and edges `a, b, c` has `m/12 (b² + c²)` about its own centre; the parallel axis
    /// theorem carries it to the common centre.
    pub fn of_boxes<'a>(boxes: impl Iterator<Item = (&'a Aabb, f64)> + Clone) -> Self {
        let (mut volume_m3, mut mass_kg, mut first) = (0.0, 0.0, [0.0; 3]);
        for (cell, density) in boxes.clone() {
            let mass = density * cell.volume();
            volume_m3 += cell.volume();
            mass_kg += mass;
            for (sum, x) in first.iter_mut().zip(cell.center()) {
                *sum += mass * x;
            }
        }
        let center_m = if mass_kg > 0.0 { first.map(|s| s / mass_kg) } else { [0.0; 3] };
        let mut inertia_kg_m2 = [[0.0; 3]; 3];
        for (cell, density) in boxes {
            let mass = density * cell.volume();
            let (size, at) = (cell.size(), cell.center());
            let arm: [f64; 3] = std::array::from_fn(|i| at[i] - center_m[i]);
            let own: [f64; 3] = std::array::from_fn(|i| size[i] * size[i] / 12.0 + arm[i] * arm[i]);
            for i in 0..3 {
                for j in 0..3 {
                    inertia_kg_m2[i][j] += if i == j {
                        mass * (own[(i + 1) % 3] + own[(i + 2) % 3])
                    } else {
                        -mass * arm[i] * arm[j]
                    };
                }
            }
        }
        Self { volume_m3, mass_kg, center_m, inertia_kg_m2 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_box_has_the_inertia_of_the_whole() {
        let whole = [Aabb { min: [1.0, 2.0, 3.0], max: [3.0, 2.5, 6.0] }];
        let cut = [
            Aabb { min: [1.0, 2.0, 3.0], max: [1.7, 2.5, 6.0] },
            Aabb { min: [1.7, 2.0, 3.0], max: [3.0, 2.5, 3.4] },
            Aabb { min: [1.7, 2.0, 3.4], max: [3.0, 2.5, 6.0] },
        ];
        let [a, b] = [&whole[..], &cut[..]].map(|s| MassProperties::of_boxes(s.iter().map(|b| (b, 2500.0))));
        assert!((a.mass_kg - b.mass_kg).abs() < 1e-9 * a.mass_kg);
        for i in 0..3 {
            assert!((a.center_m[i] - b.center_m[i]).abs() < 1e-12);
            for j in 0..3 {
                assert!((a.inertia_kg_m2[i][j] - b.inertia_kg_m2[i][j]).abs() < 1e-9 * a.inertia_kg_m2[0][0]);
            }
        }
        // m/12 (b² + c²)
        assert!((a.inertia_kg_m2[0][0] - 7500.0 / 12.0 * (0.25 + 9.0)).abs() < 1e-9);
    }
}
