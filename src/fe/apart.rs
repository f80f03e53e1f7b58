//! Members with a mesh of their own, tied to the faces of their neighbours.
//!
//! A conforming block mesh runs all planes through the whole building. A column that stands off the lines of the others brings
//! planes close to theirs: thin elements in every slab, and a small time step. Such a column is meshed by itself, and the
//! nodes of its end faces are tied to the faces of the elements they lie on ([`super::tie`]).

use super::grid::{ELEMENTS_ACROSS, clear_height};
use super::mesh::{Element, Mesh, Tie, strength_factor};
use crate::base::geom::Aabb;
use crate::building::{Building, MemberKind};
use std::collections::BTreeMap;

/// Farthest that a node may lie from the face it is tied to, as a share of the target size.
const REACH_SHARE: f64 = 0.25;
/// How far outside a face, in its own coordinates from -1 to 1, a node may lie.
const OUTSIDE: f64 = 1e-6;

/// A member with a mesh of its own.
pub(super) struct Block {
    /// Index of the member.
    pub member: usize,
    /// What is meshed: the member between its neighbours \[m\].
    pub solid: Aabb,
    counts: [usize; 3],
    reach_m: f64,
}

/// The blocks of the members that stand apart (those cut in preparation left out).
pub(super) fn blocks(building: &Building, apart: &[bool], size_m: f64) -> Vec<Block> {
    let meshing = &building.settings.meshing;
    let block = |member: usize| {
        let own = &building.members[member];
        let finer = meshing.refine.iter().filter(|r| r.member == own.id).map(|r| r.size_m);
        let size = finer.fold(size_m, f64::min);
        let mut solid = own.solid;
        [solid.min[2], solid.max[2]] = clear_height(building, member);
        let counts = std::array::from_fn(|i| {
            let least = if i == own.axis { 1 } else { ELEMENTS_ACROSS };
            ((solid.size()[i] / size - 0.01).round() as usize).max(least)
        });
        Block { member, solid, counts, reach_m: REACH_SHARE * size }
    };
    let members = (0..apart.len()).filter(|m| apart[*m] && !building.is_cut(&building.members[*m].id));
    members.map(block).collect()
}

/// Adds the blocks to a mesh and ties their ends to it.
pub(super) fn join(mesh: &mut Mesh, building: &Building, blocks: &[Block], real_m3: &[f64]) {
    if blocks.is_empty() {
        return;
    }
    let faces = outer_faces(mesh);
    let (_, law_of) = Mesh::law_indices(building);
    let mut ties = Vec::new();
    for block in blocks {
        let id = &building.members[block.member].id;
        let first = mesh.nodes.len();
        let template = Element {
            nodes: [0; 8],
            part: block.member,
            law: law_of[block.member],
            smear: real_m3[block.member] / block.solid.volume(),
            strength: strength_factor(building, id),
        };
        fill(mesh, block, template);
        let held = |z: f64| {
            building.supports.iter().any(|s| {
                let face = match s.face {
                    crate::building::Face::Bottom => block.solid.min[2],
                    crate::building::Face::Top => block.solid.max[2],
                };
                s.member == *id && (face - z).abs() < 1e-9
            })
        };
        for node in first..mesh.nodes.len() {
            let z = mesh.nodes[node][2];
            let end = [block.solid.min[2], block.solid.max[2]].iter().any(|e| (e - z).abs() < 1e-9);
            if end && !held(z) {
                ties.extend(tie_to(mesh, &faces, node, block.reach_m));
            }
        }
    }
    // Elements are sorted by law; the ties name elements by their new places.
    let mut order: Vec<usize> = (0..mesh.elements.len()).collect();
    order.sort_by_key(|e| mesh.elements[*e].law);
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(new, old)| place[*old] = new);
    mesh.elements = order.iter().map(|e| mesh.elements[*e]).collect();
    ties.iter_mut().for_each(|t: &mut Tie| t.element = place[t.element]);
    mesh.ties.extend(ties);
}

/// The hexahedra of a block.
fn fill(mesh: &mut Mesh, block: &Block, template: Element) {
    let [nx, ny, nz] = block.counts;
    let first = mesh.nodes.len();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let at = [i, j, k];
                mesh.nodes.push(std::array::from_fn(|a| {
                    let (low, high) = (block.solid.min[a], block.solid.max[a]);
                    low + (high - low) * at[a] as f64 / block.counts[a] as f64
                }));
            }
        }
    }
    let id = |i: usize, j: usize, k: usize| first + (k * (ny + 1) + j) * (nx + 1) + i;
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let ring = |k: usize| [id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k)];
                let (low, top) = (ring(k), ring(k + 1));
                let nodes = [low[0], low[1], low[2], low[3], top[0], top[1], top[2], top[3]];
                mesh.elements.push(Element { nodes, ..template });
            }
        }
    }
}

/// Node numbers of the six faces of a hexahedron, within the element.
const FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// The faces that only one element has, with that element, in a fixed order.
pub fn outer_faces(mesh: &Mesh) -> Vec<(usize, [usize; 4])> {
    let mut seen: BTreeMap<[usize; 4], (usize, [usize; 4], usize)> = BTreeMap::new();
    for (e, element) in mesh.elements.iter().enumerate() {
        for face in FACES.map(|f| f.map(|i| element.nodes[i])) {
            let mut key = face;
            key.sort_unstable();
            seen.entry(key).or_insert((e, face, 0)).2 += 1;
        }
    }
    let mut faces: Vec<_> = seen.into_values().filter(|f| f.2 == 1).map(|(e, face, _)| (e, face)).collect();
    faces.sort_unstable();
    faces
}

/// Ties a node to the nearest of some faces that lies within reach \[m\]; `None` if there is none.
pub fn tie_to(mesh: &Mesh, faces: &[(usize, [usize; 4])], node: usize, reach_m: f64) -> Option<Tie> {
    let point = mesh.nodes[node];
    let mut best: Option<(f64, Tie)> = None;
    for (element, face) in faces {
        let corners = face.map(|n| mesh.nodes[n]);
        let near = (0..3).all(|i| {
            let low = corners.iter().map(|c| c[i]).fold(f64::INFINITY, f64::min);
            let high = corners.iter().map(|c| c[i]).fold(f64::NEG_INFINITY, f64::max);
            point[i] > low - reach_m && point[i] < high + reach_m
        });
        if !near || face.contains(&node) {
            continue;
        }
        let Some((weights, distance)) = project(&corners, point) else { continue };
        if distance <= reach_m && best.as_ref().is_none_or(|(d, _)| distance < d - 1e-9) {
            let masters = face.iter().copied().zip(weights).filter(|(_, w)| *w > 0.0).collect();
            best = Some((distance, Tie { node, masters, element: *element }));
        }
    }
    best.map(|(_, tie)| tie)
}

/// Bilinear weights of the point of a face nearest to `point`, and the distance \[m\]; `None` if its foot lies outside the face.
fn project(corners: &[[f64; 3]; 4], point: [f64; 3]) -> Option<([f64; 4], f64)> {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let weights = |s: f64, t: f64| {
        [(1.0 - s) * (1.0 - t), (1.0 + s) * (1.0 - t), (1.0 + s) * (1.0 + t), (1.0 - s) * (1.0 + t)]
            .map(|w| 0.25 * w)
    };
    let mean =
        |w: [f64; 4]| -> [f64; 3] { std::array::from_fn(|i| (0..4).map(|n| w[n] * corners[n][i]).sum()) };
    let off = |w| -> [f64; 3] {
        let foot = mean(w);
        std::array::from_fn(|i| point[i] - foot[i])
    };
    let (mut s, mut t) = (0.0_f64, 0.0_f64);
    for _ in 0..20 {
        let gap = off(weights(s, t));
        let along = mean([t - 1.0, 1.0 - t, 1.0 + t, -1.0 - t].map(|w| 0.25 * w));
        let across = mean([s - 1.0, -1.0 - s, 1.0 + s, 1.0 - s].map(|w| 0.25 * w));
        let (aa, ab, bb) = (dot(along, along), dot(along, across), dot(across, across));
        let det = aa * bb - ab * ab;
        if det <= 1e-12 * aa * bb {
            return None;
        }
        let (p, q) = (dot(gap, along), dot(gap, across));
        let change = [(p * bb - q * ab) / det, (q * aa - p * ab) / det];
        s = (s + change[0]).clamp(-2.0, 2.0);
        t = (t + change[1]).clamp(-2.0, 2.0);
        if change[0].abs() + change[1].abs() < 1e-12 {
            break;
        }
    }
    if s.abs() > 1.0 + OUTSIDE || t.abs() > 1.0 + OUTSIDE {
        return None;
    }
    let inside = weights(s.clamp(-1.0, 1.0), t.clamp(-1.0, 1.0)).map(|w| if w < 1e-9 { 0.0 } else { w });
    let sum: f64 = inside.iter().sum();
    let inside = inside.map(|w| w / sum);
    let gap = off(inside);
    Some((inside, dot(gap, gap).sqrt()))
}

/// Members of a building that the mesh ties instead of joining them node by node.
pub fn tied_members(building: &Building, mesh: &Mesh) -> Vec<String> {
    let mut parts = vec![false; building.members.len()];
    let mut tied = vec![false; mesh.nodes.len()];
    mesh.ties.iter().for_each(|t| tied[t.node] = true);
    for element in &mesh.elements {
        parts[element.part] |= element.nodes.iter().any(|n| tied[*n]);
    }
    let columns = building.members.iter().zip(&parts);
    columns.filter(|(m, tied)| **tied && m.kind == MemberKind::Column).map(|(m, _)| m.id.clone()).collect()
}
