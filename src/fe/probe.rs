//! Where a material point of a member is: a rigid fit to the member's nodes that still belong to it.
//!
//! A node at a member's end follows whatever element survives there. The fit (Kabsch 1976: the rotation that
//! minimises the squared distances, from a singular value decomposition) follows the member itself, also after its end
//! elements have eroded, and is what a rigid body of the MBS model shows.

use super::blocks::Blocks;
use super::mesh::Mesh;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Nodes that a rigid fit needs.
const LEAST_CARRIERS: usize = 3;

/// A tracked point with the nodes that carry it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Probe {
    /// Tracked point id.
    pub id: String,
    /// Its position in the undeformed mesh \[m\].
    pub point_m: [f64; 3],
    /// Carrier nodes and, for each, whether any element of the member at it still acts is asked at run time.
    nodes: Vec<usize>,
    part: usize,
}

impl Probe {
    /// A point carried by all nodes of a part above a level \[m\] (`rigid_fit`) or by the nearest one.
    pub fn new(
        mesh: &Mesh,
        id: &str,
        part: usize,
        point_m: [f64; 3],
        (rigid_fit, above_m): (bool, f64),
    ) -> Option<Self> {
        let own = |e: &usize| mesh.elements[*e].part == part && mesh.center(*e)[2] > above_m;
        let mut nodes: Vec<usize> =
            (0..mesh.elements.len()).filter(own).flat_map(|e| mesh.elements[e].nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        if !rigid_fit {
            let distance = |n: &usize| (0..3).map(|i| (mesh.nodes[*n][i] - point_m[i]).powi(2)).sum::<f64>();
            nodes = vec![nodes.into_iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?];
        }
        (!nodes.is_empty()).then(|| Self { id: id.to_string(), point_m, nodes, part })
    }

    /// Current position \[m\]; `None` when nothing of the part is left.
    pub fn position(&self, mesh: &Mesh, blocks: &Blocks, x: &[[f64; 3]]) -> Option<[f64; 3]> {
        if let [only] = self.nodes[..] {
            return Some(std::array::from_fn(|i| x[only][i] + self.point_m[i] - mesh.nodes[only][i]));
        }
        let carriers = self.carriers(mesh, blocks);
        if carriers.len() < LEAST_CARRIERS {
            return None;
        }
        let mean = |at: &[[f64; 3]]| -> Vector3<f64> {
            carriers.iter().map(|n| Vector3::from(at[*n])).sum::<Vector3<f64>>() / carriers.len() as f64
        };
        let (from, to) = (mean(&mesh.nodes), mean(x));
        let mut covariance = Matrix3::zeros();
        for n in &carriers {
            covariance += (Vector3::from(x[*n]) - to) * (Vector3::from(mesh.nodes[*n]) - from).transpose();
        }
        let svd = covariance.svd(true, true);
        let (u, vt) = (svd.u?, svd.v_t?);
        let sign = if (u * vt).determinant() < 0.0 { -1.0 } else { 1.0 };
        let rotation = u * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * vt;
        let point = to + rotation * (Vector3::from(self.point_m) - from);
        Some([point.x, point.y, point.z])
    }

    /// Nodes at which an element of the part still acts.
    fn carriers(&self, mesh: &Mesh, blocks: &Blocks) -> Vec<usize> {
        let own =
            |e: usize| mesh.elements[e].part == self.part && blocks.share(e) == 1.0 && !blocks.is_detached(e);
        self.nodes.iter().copied().filter(|n| blocks.elements_at(*n).any(own)).collect()
    }

    /// Whether the point is no longer part of the structure: no element acts at its only node, which is then a point mass of debris, or too little
    /// of its member is left to carry it.
    pub fn is_debris(&self, mesh: &Mesh, blocks: &Blocks) -> bool {
        match self.nodes[..] {
            [only] => !blocks.elements_at(only).any(|e| blocks.share(e) > 0.0 && !blocks.is_detached(e)),
            _ => self.carriers(mesh, blocks).len() < LEAST_CARRIERS,
        }
    }
}
