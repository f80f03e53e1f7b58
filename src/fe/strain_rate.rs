//! Strain rates of elements over the output intervals, from the nodes' positions at both ends of an interval.
//!
//! The net strain over the interval averages elastic vibration out, as a strain-rate study wants it, and costs the
//! time loop nothing.

use super::hexahedron::{gradient, to_patterns};
use super::mesh::Mesh;
use super::split::Split;
use crate::base::vector::{V3, add, cross, dot, scale};
use serde::{Deserialize, Serialize};

/// The interval that is under way.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct StrainWindow {
    /// Node positions at its start \[m\].
    start_m: Vec<V3>,
    /// Elements that ended within it, with the strain they had reached.
    ended: Vec<(usize, f64)>,
}

impl StrainWindow {
    /// An interval that starts with the nodes at `x`.
    pub fn new(x: &[V3]) -> Self {
        Self { start_m: x.to_vec(), ended: Vec::new() }
    }

    /// Keeps the strain of an element that ends now: afterwards its nodes go their own ways.
    pub fn note_end(&mut self, mesh: &Mesh, element: usize, x: &[V3]) {
        self.ended.push((element, self.strain(mesh, element, x)));
    }

    /// Takes in the nodes of elements that were detached.
    pub fn follow(&mut self, splits: &[Split]) {
        for [old, _] in splits.iter().flat_map(|s| &s.copies) {
            self.start_m.push(self.start_m[*old]);
        }
    }

    /// Equivalent strain rates `sqrt(2/3 e:e) / interval` of the interval that ends with the nodes at `x`, `e` being the net deviatoric
    /// strain \[1/s\]; 0 for elements that do not act. Starts the next interval.
    pub fn finish(
        &mut self,
        mesh: &Mesh,
        acts: impl Fn(usize) -> bool,
        x: &[V3],
        interval_s: f64,
    ) -> Vec<f32> {
        let mut strains: Vec<f64> =
            (0..mesh.elements.len()).map(|e| if acts(e) { self.strain(mesh, e, x) } else { 0.0 }).collect();
        for (element, strain) in self.ended.drain(..) {
            strains[element] = strain;
        }
        self.start_m.copy_from_slice(x);
        strains.iter().map(|s| (s / interval_s) as f32).collect()
    }

    fn strain(&self, mesh: &Mesh, element: usize, x: &[V3]) -> f64 {
        let nodes = mesh.elements[element].nodes;
        net_strain(&nodes.map(|n| self.start_m[n]), &nodes.map(|n| x[n]))
    }
}

/// Equivalent deviatoric strain `sqrt(2/3 e:e)` between two positions of the nodes of a hexahedron, from the mean displacement
/// gradient at mid-way (Hughes and Winget 1980): a rotation strains nothing. 0 if the volume is lost.
pub fn net_strain(from: &[V3; 8], to: &[V3; 8]) -> f64 {
    let (mut at, mut moved) = ([[0.0; 3]; 7], [[0.0; 3]; 7]);
    for i in 0..3 {
        let (p, u) =
            (to_patterns(to.map(|n| n[i])), to_patterns(std::array::from_fn(|n| to[n][i] - from[n][i])));
        for k in 0..7 {
            at[k][i] = p[k];
            moved[k][i] = u[k];
        }
    }
    let (e, volume) = gradient(&at);
    if volume.is_nan() || volume <= 0.0 {
        return 0.0;
    }
    let mut g = [[0.0; 3]; 3];
    for k in 0..6 {
        let b = scale(1.0 / (64.0 * volume), e[k]);
        for i in 0..3 {
            g[i] = add(g[i], scale(moved[k][i], b));
        }
    }
    let d = mid_strain(&g);
    let mean = (d[0] + d[1] + d[2]) / 3.0;
    let normal: f64 = d[..3].iter().map(|v| (v - mean) * (v - mean)).sum();
    let shear: f64 = d[3..].iter().map(|v| v * v).sum();
    let strain = (2.0 / 3.0 * (normal + 2.0 * shear)).sqrt();
    if strain.is_finite() { strain } else { 0.0 }
}

/// Symmetric part of `L (I - L/2)^-1`: xx, yy, zz, xy, yz, zx.
fn mid_strain(g: &[V3; 3]) -> [f64; 6] {
    let m: [V3; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j)) - 0.5 * g[i][j]));
    let columns = [cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1])];
    let inverse = 1.0 / dot(m[0], columns[0]);
    let mid = |i: usize, j: usize| inverse * dot(g[i], columns[j]);
    let shear = |i: usize, j: usize| 0.5 * (mid(i, j) + mid(j, i));
    [mid(0, 0), mid(1, 1), mid(2, 2), shear(0, 1), shear(1, 2), shear(2, 0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::hexahedron::UNIT_CUBE;

    #[test]
    fn rotation_strains_nothing_and_shear_is_measured() {
        let (s, c) = 0.7f64.sin_cos();
        let turned = UNIT_CUBE.map(|p| [c * p[0] - s * p[1], s * p[0] + c * p[1], p[2] + 3.0]);
        assert!(net_strain(&UNIT_CUBE, &turned) < 1e-14);
        let sheared = UNIT_CUBE.map(|p| [p[0] + 1e-6 * p[2], p[1], p[2]]);
        assert!((net_strain(&UNIT_CUBE, &sheared) - 1e-6 / 3f64.sqrt()).abs() < 1e-12);
    }
}
