//! Bars inside hexahedra: finds for each node the element that holds it and where in it, and ties it there.
//!
//! The trilinear map `x(ξ)` of the element is inverted by Newton's method; the weights are the shape functions `N_I(ξ)`. A node on the face between
//! two elements belongs to the one with the lower index.

use super::mesh::{Mesh, Tie};
use crate::base::vector::{V3, cross, dot, scale};

/// How far outside an element in its natural coordinates a node still counts as inside; it is then tied to the nearest point of the
/// surface.
const TOLERANCE: f64 = 1e-6;
/// Newton iterations, at most.
const ITERATIONS: usize = 30;

/// A node that no element holds.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "bar node {node} at ({x:.4}, {y:.4}, {z:.4}) m lies in no hexahedron; move it into the concrete or give it elements of its own",
    x = .at_m[0], y = .at_m[1], z = .at_m[2]
)]
pub struct EmbedError {
    /// Node index.
    pub node: usize,
    /// Its position \[m\].
    pub at_m: [f64; 3],
}

/// Ties the given nodes to the hexahedra that hold them, in the given order. Nodes of hexahedra are left as they are: they move with
/// them anyway.
pub fn embed(mesh: &Mesh, nodes: &[usize]) -> Result<Vec<Tie>, EmbedError> {
    let mut own = vec![false; mesh.nodes.len()];
    mesh.elements.iter().flat_map(|e| e.nodes).for_each(|n| own[n] = true);
    let boxes = Boxes::of(mesh);
    let mut ties = Vec::new();
    for &node in nodes.iter().filter(|n| !own[**n]) {
        let at_m = mesh.nodes[node];
        let found = boxes.holding(at_m).into_iter().find_map(|element| {
            let corners = mesh.elements[element].nodes;
            natural_coordinates(&corners.map(|n| mesh.nodes[n]), at_m).map(|xi| (element, corners, xi))
        });
        let (element, corners, xi) = found.ok_or(EmbedError { node, at_m })?;
        let weights = shape(xi.map(|c| c.clamp(-1.0, 1.0)));
        let masters = corners.into_iter().zip(weights).filter(|(_, w)| *w > 0.0).collect();
        ties.push(Tie { node, masters, element });
    }
    Ok(ties)
}

/// Natural coordinates of a point in a hexahedron, `None` if it is outside.
pub(super) fn natural_coordinates(corners: &[V3; 8], at_m: V3) -> Option<V3> {
    let mut xi = [0.0; 3];
    for _ in 0..ITERATIONS {
        let (place, tangent) = map(corners, xi);
        let gap: V3 = std::array::from_fn(|i| at_m[i] - place[i]);
        let normal =
            [cross(tangent[1], tangent[2]), cross(tangent[2], tangent[0]), cross(tangent[0], tangent[1])];
        let volume = dot(tangent[0], normal[0]);
        let step = normal.map(|n| dot(n, gap) / volume);
        for a in 0..3 {
            xi[a] = (xi[a] + step[a]).clamp(-3.0, 3.0);
        }
        if !xi.iter().all(|c| c.is_finite()) {
            return None;
        }
        if step.iter().all(|s| s.abs() < 1e-12) {
            return xi.iter().all(|c| c.abs() <= 1.0 + TOLERANCE).then_some(xi);
        }
    }
    None
}

/// Signs of the corners in natural coordinates.
const SIGNS: [V3; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Trilinear shape functions.
fn shape(xi: V3) -> [f64; 8] {
    SIGNS.map(|s| 0.125 * (1.0 + s[0] * xi[0]) * (1.0 + s[1] * xi[1]) * (1.0 + s[2] * xi[2]))
}

/// Position and tangents `∂x/∂ξ_a` at natural coordinates.
fn map(corners: &[V3; 8], xi: V3) -> (V3, [V3; 3]) {
    let (mut place, mut tangent) = ([0.0; 3], [[0.0; 3]; 3]);
    for ((corner, s), weight) in corners.iter().zip(SIGNS).zip(shape(xi)) {
        for i in 0..3 {
            place[i] += weight * corner[i];
        }
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let slope = 0.125 * s[a] * (1.0 + s[b] * xi[b]) * (1.0 + s[c] * xi[c]);
            let part = scale(slope, *corner);
            for i in 0..3 {
                tangent[a][i] += part[i];
            }
        }
    }
    (place, tangent)
}

/// Boxes around the elements, sorted by their lower end along x.
pub(super) struct Boxes {
    /// `(low, high, element)`.
    sorted: Vec<(V3, V3, usize)>,
    /// Largest extent along x \[m\].
    widest_m: f64,
}

impl Boxes {
    pub(super) fn of(mesh: &Mesh) -> Self {
        let around = |(index, element): (usize, &super::mesh::Element)| {
            let corners = element.nodes.map(|n| mesh.nodes[n]);
            let low: V3 = std::array::from_fn(|i| corners.iter().map(|c| c[i]).fold(f64::INFINITY, f64::min));
            let high: V3 =
                std::array::from_fn(|i| corners.iter().map(|c| c[i]).fold(f64::NEG_INFINITY, f64::max));
            let slack: V3 = std::array::from_fn(|i| TOLERANCE * (high[i] - low[i]));
            (std::array::from_fn(|i| low[i] - slack[i]), std::array::from_fn(|i| high[i] + slack[i]), index)
        };
        let mut sorted: Vec<(V3, V3, usize)> = mesh.elements.iter().enumerate().map(around).collect();
        sorted.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then(a.2.cmp(&b.2)));
        let widest_m = sorted.iter().map(|(low, high, _)| high[0] - low[0]).fold(0.0, f64::max);
        Self { sorted, widest_m }
    }

    /// Elements whose box holds a point, in the order of their index.
    pub(super) fn holding(&self, at: V3) -> Vec<usize> {
        let from = self.sorted.partition_point(|b| b.0[0] < at[0] - self.widest_m);
        let to = self.sorted.partition_point(|b| b.0[0] <= at[0]);
        let inside = |(low, high, _): &&(V3, V3, usize)| (0..3).all(|i| low[i] <= at[i] && at[i] <= high[i]);
        let mut found: Vec<usize> = self.sorted[from..to].iter().filter(inside).map(|b| b.2).collect();
        found.sort_unstable();
        found
    }
}
