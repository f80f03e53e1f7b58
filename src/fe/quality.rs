//! How good a mesh is, and which elements decide the time step.
//!
//! Measures of a hexahedron after Knupp et al., The Verdict Geometric Quality Library, SAND2007-1751: edge ratio and scaled Jacobian;
//! warpage is the largest angle between the normals of the two triangles of a face, over both ways to divide it.

use super::blocks::Blocks;
use super::dynamics::{STEP_SAFETY, allowed_step_s};
use super::grid::{MeshGrid, SNAP_SHARE};
use super::mesh::{Mesh, Snapped};
use crate::base::vector::{cross, dot, norm, sub};
use crate::building::Building;
use serde::Serialize;

/// A step that would grow by more than this factor if two mesh planes were one is worth a note.
const WORTH_A_NOTE: f64 = 1.2;

/// Quality of some elements.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Measures {
    /// Number of elements.
    pub elements: usize,
    /// Shortest and longest edge \[m\].
    pub edge_m: [f64; 2],
    /// Largest ratio of the longest to the shortest edge of an element.
    pub aspect: f64,
    /// Smallest scaled Jacobian: 1 for a box, not positive for an element that is turned inside out at a corner.
    pub scaled_jacobian: f64,
    /// Largest warpage of a face \[deg\].
    pub warpage_deg: f64,
    /// Time step that the elements allow, with the safety factor of a run \[s\].
    pub step_s: f64,
}

/// Quality of a mesh.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Quality {
    /// Of all elements.
    pub all: Measures,
    /// Of each part that has elements, in part order.
    pub parts: Vec<(String, Measures)>,
    /// Smallest and largest ratio of real to meshed volume over the members.
    pub volume_ratio: [f64; 2],
    /// The element that decides the step.
    pub worst: Worst,
    /// Nodes that are tied to faces.
    pub tied_nodes: usize,
}

/// The element with the smallest time step.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worst {
    /// Its index.
    pub element: usize,
    /// Its part.
    pub part: String,
    /// Its centre \[m\].
    pub center_m: [f64; 3],
    /// Its mean edges along its three directions \[m\].
    pub edges_m: [f64; 3],
}

impl Quality {
    /// Of a mesh; `None` if it has no hexahedra.
    pub fn of(mesh: &Mesh, snapped: &[Snapped]) -> Option<Self> {
        let steps = steps_s(mesh);
        let worst = (0..steps.len()).min_by(|a, b| steps[*a].total_cmp(&steps[*b]))?;
        let single: Vec<Measures> = mesh
            .elements
            .iter()
            .zip(&steps)
            .map(|(e, step)| measure(&e.nodes.map(|n| mesh.nodes[n]), *step))
            .collect();
        let mut parts: Vec<Option<Measures>> = vec![None; mesh.parts.len()];
        let mut all: Option<Measures> = None;
        for (element, one) in mesh.elements.iter().zip(&single) {
            join(&mut parts[element.part], one);
            join(&mut all, one);
        }
        let ratios = snapped.iter().map(|s| s.volume_ratio);
        Some(Self {
            all: all?,
            parts: mesh.parts.iter().cloned().zip(parts).filter_map(|(id, m)| Some((id, m?))).collect(),
            volume_ratio: ratios.fold([1.0, 1.0], |[low, high], r| [r.min(low), r.max(high)]),
            worst: Worst {
                element: worst,
                part: mesh.parts[mesh.elements[worst].part].clone(),
                center_m: mesh.center(worst),
                edges_m: edges(&mesh.elements[worst].nodes.map(|n| mesh.nodes[n])),
            },
            tied_nodes: mesh.ties.len(),
        })
    }

    /// The mesh in one line.
    pub fn line(&self) -> String {
        let a = &self.all;
        let [x, y, z] = self.worst.center_m;
        format!(
            "mesh: edges {:.3} to {:.3} m, aspect up to {:.1}, scaled Jacobian from {:.2}; the step of {:.4} ms is that of {} at ({x:.2}, {y:.2}, {z:.2}) m",
            a.edge_m[0],
            a.edge_m[1],
            a.aspect,
            a.scaled_jacobian,
            1e3 * a.step_s,
            self.worst.part
        )
    }
}

/// Time step of each element with the safety of a run \[s\].
fn steps_s(mesh: &Mesh) -> Vec<f64> {
    let bounds = Blocks::of(mesh).element_bounds_1_s2(&mesh.nodes);
    bounds.iter().map(|bound| allowed_step_s(*bound, STEP_SAFETY)).collect()
}

fn join(sum: &mut Option<Measures>, one: &Measures) {
    match sum {
        None => *sum = Some(one.clone()),
        Some(sum) => {
            sum.elements += one.elements;
            sum.edge_m = [sum.edge_m[0].min(one.edge_m[0]), sum.edge_m[1].max(one.edge_m[1])];
            sum.aspect = sum.aspect.max(one.aspect);
            sum.scaled_jacobian = sum.scaled_jacobian.min(one.scaled_jacobian);
            sum.warpage_deg = sum.warpage_deg.max(one.warpage_deg);
            sum.step_s = sum.step_s.min(one.step_s);
        }
    }
}

type Point = [f64; 3];

/// Corners with their neighbours along the element's three directions, right-handed.
const CORNERS: [[usize; 4]; 8] = [
    [0, 1, 3, 4],
    [1, 2, 0, 5],
    [2, 3, 1, 6],
    [3, 0, 2, 7],
    [4, 7, 5, 0],
    [5, 4, 6, 1],
    [6, 5, 7, 2],
    [7, 6, 4, 3],
];
/// The edges by direction.
const EDGES: [[[usize; 2]; 4]; 3] =
    [[[0, 1], [3, 2], [4, 5], [7, 6]], [[0, 3], [1, 2], [4, 7], [5, 6]], [[0, 4], [1, 5], [2, 6], [3, 7]]];
/// The faces, in order around each.
const FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// Mean edges along the three directions \[m\].
fn edges(nodes: &[Point; 8]) -> [f64; 3] {
    EDGES.map(|four| four.iter().map(|[a, b]| norm(sub(nodes[*b], nodes[*a]))).sum::<f64>() / 4.0)
}

/// The measures of one element.
fn measure(nodes: &[Point; 8], step_s: f64) -> Measures {
    let lengths = EDGES.as_flattened().iter().map(|[a, b]| norm(sub(nodes[*b], nodes[*a])));
    let edge_m = lengths.fold([f64::INFINITY, 0.0_f64], |[low, high], l| [low.min(l), high.max(l)]);
    let scaled = CORNERS.map(|[at, a, b, c]| {
        let [a, b, c] = [a, b, c].map(|n| sub(nodes[n], nodes[at]));
        let size = norm(a) * norm(b) * norm(c);
        if size > 0.0 { dot(cross(a, b), c) / size } else { 0.0 }
    });
    let warpage = FACES.map(|f| {
        let p = f.map(|n| nodes[n]);
        let angle = |a: usize, b: usize, c: usize, d: usize| {
            let one = cross(sub(p[b], p[a]), sub(p[c], p[a]));
            let other = cross(sub(p[c], p[a]), sub(p[d], p[a]));
            libm::atan2(norm(cross(one, other)), dot(one, other)).to_degrees()
        };
        angle(0, 1, 2, 3).max(angle(1, 2, 3, 0))
    });
    Measures {
        elements: 1,
        edge_m,
        aspect: edge_m[1] / edge_m[0],
        scaled_jacobian: scaled.into_iter().fold(f64::INFINITY, f64::min),
        warpage_deg: warpage.into_iter().fold(0.0, f64::max),
        step_s,
    }
}

/// What costs most of the time step and how to avoid it: two faces of different members so close together that the layer
/// of elements between them makes the step much smaller than it would be without. `None` if there is nothing of the kind.
pub fn sliver_note(building: &Building, quality: &Quality, size_m: f64) -> Option<String> {
    let grid = MeshGrid::of(building, size_m);
    let (worst, edges) = (&quality.worst, quality.worst.edges_m);
    let axis = (0..3).min_by(|a, b| edges[*a].total_cmp(&edges[*b]))?;
    let others: f64 = (0..3).filter(|i| *i != axis).map(|i| edges[i].powi(-2)).sum();
    // The bound of a box goes with the sum of the inverse squares of its edges.
    let merged = size_m.max(edges[axis]).powi(-2) + others;
    let gain = ((edges[axis].powi(-2) + others) / merged).sqrt();
    let planes = &grid.planes[axis];
    let above = planes.partition_point(|p| *p < worst.center_m[axis]);
    let (low, high) = (*planes.get(above.checked_sub(1)?)?, *planes.get(above)?);
    let faces_at = |at: f64| -> Vec<usize> {
        let on =
            |s: &crate::base::geom::Aabb| (s.min[axis] - at).abs() < 1e-9 || (s.max[axis] - at).abs() < 1e-9;
        (0..grid.solids.len()).filter(|i| !grid.apart[*i] && on(&grid.solids[*i])).collect()
    };
    let (below, beyond) = (faces_at(low), faces_at(high));
    let one_member = below.iter().any(|m| beyond.contains(m));
    if one_member || below.is_empty() || beyond.is_empty() || gain < WORTH_A_NOTE {
        return None;
    }
    let id = |list: &[usize]| building.members[list[0]].id.clone();
    let (axis_name, apart) = (["x", "y", "z"][axis], high - low);
    Some(format!(
        "the mesh planes {axis_name} = {low:.3} m (`{}`) and {axis_name} = {high:.3} m (`{}`) are {apart:.3} m apart and make the time step {gain:.1} times smaller; \
         move one face onto the other, or by more than {:.3} m away{}",
        id(&below),
        id(&beyond),
        (0.5 * size_m).max(SNAP_SHARE * size_m),
        if axis < 2 { ", or set `mesh.tie_below` if it is a column's" } else { "" }
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::hexahedron::UNIT_CUBE;

    #[test]
    fn a_cube_is_perfect() {
        let m = measure(&UNIT_CUBE, 1.0);
        assert_eq!((m.edge_m, m.aspect, m.scaled_jacobian, m.warpage_deg), ([1.0, 1.0], 1.0, 1.0, 0.0));
    }

    /// A shear by 45 degrees: the angle between two edges gives sin 45°; faces stay plane.
    #[test]
    fn a_sheared_cube_has_the_sine_of_its_angle() {
        let m = measure(&UNIT_CUBE.map(|[x, y, z]| [x + z, y, z]), 1.0);
        assert!((m.scaled_jacobian - 0.5_f64.sqrt()).abs() < 1e-12);
        assert!(m.warpage_deg < 1e-9 && (m.aspect - 2.0_f64.sqrt()).abs() < 1e-12);
    }

    /// One corner lifted out of the top face by 1: divided through this corner, the triangles of the face meet at 60°, the other way at `acos(1 / sqrt 3)`.
    #[test]
    fn a_lifted_corner_warps_its_faces() {
        let mut nodes = UNIT_CUBE;
        nodes[6][2] = 2.0;
        let m = measure(&nodes, 1.0);
        assert!((m.warpage_deg - 60.0).abs() < 1e-9, "{}", m.warpage_deg);
    }

    #[test]
    fn a_corner_pushed_through_has_no_positive_jacobian() {
        let mut nodes = UNIT_CUBE;
        nodes[6] = [-0.5, -0.5, 0.5];
        assert!(measure(&nodes, 1.0).scaled_jacobian < 0.0);
    }
}
