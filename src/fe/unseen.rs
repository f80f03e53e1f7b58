//! What contact of a mesh with itself does not see, told before a run: bodies that overlap at the start, and elements that are too long.
//!
//! Contact is of nodes with outer faces. Two bodies that cross each other meet if a node of one comes down on a face of the other; where the elements of both are longer
//! than the other body is wide, edges can cross edges with no node near.

use super::embed::{Boxes, natural_coordinates};
use super::hexahedron::to_patterns;
use super::mesh::Mesh;
use crate::base::units::round_to_digits;
use crate::base::vector::{V3, cross, dot, sub, unit};
use petgraph::unionfind::UnionFind;

/// Share of the half length of an element up to which a node counts as on its face: bodies that stand flush do not overlap.
const ON_FACE: f64 = 1e-3;
/// Elements of a body, spread over it, across whose faces its width is measured at most.
const ELEMENTS_ASKED: usize = 16;
/// Corners of a hexahedron that its edges join.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// Elements that hang together by their nodes.
struct Body {
    low: V3,
    high: V3,
    longest_edge_m: f64,
    elements: Vec<usize>,
}

impl Body {
    /// The least extent along the axes and across the faces of its elements \[m\]: of a body out of the axes the box around it tells nothing.
    fn width_m(&self, mesh: &Mesh) -> f64 {
        let along_axes = (0..3).map(|i| self.high[i] - self.low[i]);
        let across = self.directions(mesh).into_iter().map(|along| {
            let corners = self.elements.iter().flat_map(|e| mesh.elements[*e].nodes);
            let places = corners.map(|n| dot(along, mesh.nodes[n]));
            let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
                [low.min(place), high.max(place)]
            });
            high - low
        });
        along_axes.chain(across).fold(f64::INFINITY, f64::min)
    }

    /// Unit normals of the middle planes of some elements, each once.
    fn directions(&self, mesh: &Mesh) -> Vec<V3> {
        let mut found: Vec<V3> = Vec::new();
        for element in self.elements.iter().step_by(self.elements.len().div_ceil(ELEMENTS_ASKED).max(1)) {
            let x = mesh.elements[*element].nodes.map(|n| mesh.nodes[n]);
            let coordinates: [[f64; 7]; 3] = std::array::from_fn(|i| to_patterns(x.map(|x| x[i])));
            let [xi, eta, zeta] = [0, 1, 2].map(|pattern| coordinates.map(|c| c[pattern]));
            for normal in [cross(eta, zeta), cross(zeta, xi), cross(xi, eta)] {
                let normal = unit(normal);
                if found.iter().all(|known| dot(*known, normal).abs() < 1.0 - 1e-14) {
                    found.push(normal);
                }
            }
        }
        found
    }
}

/// Notes about the contact of a mesh with itself.
pub(super) fn notes(mesh: &Mesh) -> Vec<String> {
    let (bodies, of_node) = bodies(mesh);
    if bodies.len() < 2 {
        return Vec::new();
    }
    crossing(mesh, &bodies).into_iter().chain(overlap(mesh, &bodies, &of_node)).collect()
}

/// The bodies, and that of each node; `None`: of no element.
fn bodies(mesh: &Mesh) -> (Vec<Body>, Vec<Option<usize>>) {
    let mut sets = UnionFind::new(mesh.nodes.len());
    for element in &mesh.elements {
        for n in &element.nodes[1..] {
            sets.union(element.nodes[0], *n);
        }
    }
    let (mut bodies, mut of_node) = (Vec::new(), vec![None; mesh.nodes.len()]);
    let mut of_root = vec![None; mesh.nodes.len()];
    for (number, element) in mesh.elements.iter().enumerate() {
        let root = sets.find(element.nodes[0]);
        let index = *of_root[root].get_or_insert_with(|| {
            let [low, high] = [f64::INFINITY, f64::NEG_INFINITY].map(|far| [far; 3]);
            bodies.push(Body { low, high, longest_edge_m: 0.0, elements: Vec::new() });
            bodies.len() - 1
        });
        let body: &mut Body = &mut bodies[index];
        body.elements.push(number);
        let x = element.nodes.map(|n| mesh.nodes[n]);
        for (node, x) in element.nodes.iter().zip(x) {
            of_node[*node] = Some(index);
            body.low = std::array::from_fn(|i| body.low[i].min(x[i]));
            body.high = std::array::from_fn(|i| body.high[i].max(x[i]));
        }
        let edges = EDGES.map(|[a, b]| sub(x[b], x[a])).map(|along| dot(along, along).sqrt());
        body.longest_edge_m = edges.into_iter().fold(body.longest_edge_m, f64::max);
    }
    (bodies, of_node)
}

/// Two bodies whose edges can cross with no node near.
fn crossing(mesh: &Mesh, bodies: &[Body]) -> Option<String> {
    let sizes: Vec<[f64; 2]> = bodies.iter().map(|b| [b.longest_edge_m, b.width_m(mesh)]).collect();
    let longer = |[long, _]: &[f64; 2], [_, wide]: &[f64; 2]| *long > (1.0 + 1e-6) * wide;
    let mut pairs = sizes.iter().enumerate().flat_map(|(i, a)| sizes[i + 1..].iter().map(move |b| (a, b)));
    let (a, b) = pairs.find(|(a, b)| longer(a, b) && longer(b, a))?;
    let [long, wide] = [a[0], b[1]].map(|m| round_to_digits(m, 3));
    Some(format!(
        "contact is of nodes with faces, not of edges with edges: a body with elements {long} long and one that is {wide} wide may pass through each other between nodes; make elements no longer than the other body is wide"
    ))
}

/// Nodes inside elements of other bodies.
fn overlap(mesh: &Mesh, bodies: &[Body], of_node: &[Option<usize>]) -> Option<String> {
    let inside_box = |x: &V3, body: &Body| (0..3).all(|i| body.low[i] < x[i] && x[i] < body.high[i]);
    let is_near = |n: &usize| {
        let (x, own) = (&mesh.nodes[*n], of_node[*n]);
        own.is_some() && bodies.iter().enumerate().any(|(b, body)| Some(b) != own && inside_box(x, body))
    };
    let near: Vec<usize> = (0..mesh.nodes.len()).filter(is_near).collect();
    if near.is_empty() {
        return None;
    }
    let boxes = Boxes::of(mesh);
    // the share of a node's surroundings that elements of other bodies fill: all within one of them or between two, half on an outer face
    let filled = |node: usize| -> f64 {
        let others = boxes.holding(mesh.nodes[node]).into_iter().map(|e| mesh.elements[e].nodes);
        let others = others.filter(|corners| of_node[corners[0]] != of_node[node]);
        let places = others.filter_map(|c| natural_coordinates(&c.map(|n| mesh.nodes[n]), mesh.nodes[node]));
        places
            .map(|xi| xi.map(|c| if c.abs() < 1.0 - ON_FACE { 1.0 } else { 0.5 }).iter().product::<f64>())
            .sum()
    };
    let count = near.iter().filter(|n| filled(**n) > 0.9).count();
    (count > 0).then(|| {
        format!(
            "{count} nodes lie inside elements of other bodies at the start: up to half an element deep they are brought back slowly, deeper there is no contact; move the bodies apart"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::notes;
    use crate::fe::mesh::{Element, Mesh};
    use crate::fe::shapes::{elastic, grid};

    /// A block of elements, and a second one with its corner at a point.
    fn two(first: ([usize; 3], [f64; 3]), second: ([usize; 3], [f64; 3]), corner: [f64; 3]) -> Mesh {
        let mut mesh = grid(first.0, first.1, elastic(), |_| false);
        let other = grid(second.0, second.1, elastic(), |_| false);
        let shift = mesh.nodes.len();
        mesh.nodes.extend(other.nodes.iter().map(|x| [x[0] + corner[0], x[1] + corner[1], x[2] + corner[2]]));
        let moved = |e: &Element| Element { nodes: e.nodes.map(|n| n + shift), ..*e };
        mesh.elements.extend(other.elements.iter().map(moved));
        mesh
    }

    #[test]
    fn bodies_that_overlap_are_noted_with_their_nodes() {
        let block = ([2; 3], [0.4; 3]);
        assert!(notes(&grid([2; 3], [0.4; 3], elastic(), |_| false)).is_empty());
        assert!(notes(&two(block, block, [0.0, 0.0, 0.4])).is_empty(), "flush");
        assert!(notes(&two(block, block, [0.1, 0.1, 0.41])).is_empty(), "apart");
        let found = notes(&two(block, ([2; 3], [0.3; 3]), [0.25, 0.03, 0.02]));
        // a layer of nine nodes of the second, and one of the first between two of its elements; the next layer lies on the face
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("10 nodes lie inside"), "{found:?}");
    }

    #[test]
    fn bodies_whose_edges_can_cross_are_noted() {
        let bars = |count: usize| {
            let along = [count, 1, 1];
            two((along, [2.0, 0.1, 0.1]), ([1, count, 1], [0.1, 2.0, 0.1]), [0.9, -1.0, 0.15])
        };
        assert!(notes(&bars(20)).is_empty());
        let found = notes(&bars(5));
        assert!(
            found.len() == 1 && found[0].contains("elements 0.4 long and one that is 0.1 wide"),
            "{found:?}"
        );
        // out of the axes a bar is as wide as along them
        for count in [20, 5] {
            let (along, mut turned) = (bars(count), bars(count));
            for [x, y, z] in &mut turned.nodes {
                [*x, *y] = [0.6 * *x - 0.8 * *y, 0.8 * *x + 0.6 * *y];
                [*y, *z] = [0.8 * *y - 0.6 * *z, 0.6 * *y + 0.8 * *z];
            }
            assert_eq!(notes(&turned), notes(&along), "{count}");
        }
        // the nodes of a fine bar meet the faces of a coarse one
        let mixed = two(([5, 1, 1], [2.0, 0.1, 0.1]), ([1, 20, 1], [0.1, 2.0, 0.1]), [0.9, -1.0, 0.15]);
        assert!(notes(&mixed).is_empty());
    }
}
