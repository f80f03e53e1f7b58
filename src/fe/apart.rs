//! Members with a mesh of their own, tied to the faces of their neighbours.
//!
//! A conforming block mesh runs all planes through the whole building. A column that stands off the lines of the others brings
//! planes close to theirs: thin elements in every slab, and a small time step. Such a column is meshed by itself, and the
//! nodes of its end faces are tied to the faces of the elements they lie on ([`super::tie`]). A member turned about the vertical axis, or a brace in any
//! direction, has a mesh of its own in any case: it butts against its neighbours ([`Clear`]), and all its nodes that lie on their faces are tied.
//! What the mesh leaves out of its volume, such as the corners of a column beside a narrower beam, is made up for by the factor on
//! density, stiffness and strength, and reported as a volume ratio.

use super::grid::{ELEMENTS_ACROSS, clear_height};
use super::hexahedron::volume_m3;
use super::mesh::{Element, Mesh, Tie};
use crate::building::clear::Clear;
use crate::building::{Building, Face, Member, MemberKind};
use std::collections::BTreeMap;

/// Farthest that a node may lie from the face it is tied to, as a share of the target size.
const REACH_SHARE: f64 = 0.25;
/// The same for turned members: faces of their neighbours may have been moved by as much as [`super::grid::SNAP_SHARE`].
const TURNED_REACH_SHARE: f64 = 0.3;
/// How far outside a face, in its own coordinates from -1 to 1, a node may lie.
const OUTSIDE: f64 = 1e-6;

/// A member with a mesh of its own.
pub(super) struct Block {
    /// Index of the member.
    pub member: usize,
    /// Nodes along the three directions, x fastest \[m\].
    nodes: Vec<[f64; 3]>,
    counts: [usize; 3],
    reach_m: f64,
    /// Which of the nodes are tied: those at the ends; of a turned member those on faces of its neighbours.
    tied: Vec<bool>,
}

/// The blocks of the members that stand apart (those cut in preparation left out).
pub(super) fn blocks(building: &Building, apart: &[bool], size_m: f64) -> Vec<Block> {
    let all: Vec<&Member> = building.members.iter().collect();
    let meshing = &building.settings.meshing;
    let block = |member: usize| {
        let own = &building.members[member];
        let finer = meshing.refine.iter().filter(|r| r.member == own.id).map(|r| r.size_m);
        let size = finer.fold(size_m, f64::min);
        if own.is_skew() {
            turned(&all, member, size, TURNED_REACH_SHARE * size_m)
        } else {
            upright(building, member, size)
        }
    };
    let members = (0..apart.len()).filter(|m| apart[*m] && !building.is_cut(&building.members[*m].id));
    members.map(block).collect()
}

/// Elements along each direction of a member: [`ELEMENTS_ACROSS`] at least across a bar and through a plate.
fn counts(member: &Member, lengths_m: [f64; 3], size_m: f64) -> [usize; 3] {
    let bar = matches!(member.kind, MemberKind::Column | MemberKind::Beam | MemberKind::Brace);
    std::array::from_fn(|i| {
        let least = if bar == (i == member.axis) { 1 } else { ELEMENTS_ACROSS };
        ((lengths_m[i] / size_m - 0.01).round() as usize).max(least)
    })
}

/// Places of the nodes of a block by their number along each direction.
fn numbered(counts: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    let [nx, ny, nz] = counts;
    (0..=nz).flat_map(move |k| (0..=ny).flat_map(move |j| (0..=nx).map(move |i| [i, j, k])))
}

/// A column along the axes, off the lines of the others.
fn upright(building: &Building, member: usize, size_m: f64) -> Block {
    let own = &building.members[member];
    let mut solid = own.solid;
    [solid.min[2], solid.max[2]] = clear_height(building, member);
    let counts = counts(own, solid.size(), size_m);
    let at = |place: [usize; 3]| -> [f64; 3] {
        std::array::from_fn(|a| {
            let (low, high) = (solid.min[a], solid.max[a]);
            low + (high - low) * place[a] as f64 / counts[a] as f64
        })
    };
    let held = |z: f64| {
        building.supports.iter().any(|s| {
            let face = match s.face {
                Face::Bottom => solid.min[2],
                Face::Top => solid.max[2],
            };
            s.member == own.id && (face - z).abs() < 1e-9
        })
    };
    let nodes: Vec<[f64; 3]> = numbered(counts).map(at).collect();
    let end = |z: f64| [solid.min[2], solid.max[2]].iter().any(|e| (e - z).abs() < 1e-9);
    let tied = nodes.iter().map(|p| end(p[2]) && !held(p[2])).collect();
    Block { member, nodes, counts, reach_m: REACH_SHARE * size_m, tied }
}

/// A member turned out of the axes, between its neighbours. The ends of a beam, wall or brace are mitred to the faces they meet.
fn turned(all: &[&Member], member: usize, size_m: f64, reach_m: f64) -> Block {
    let own = all[member];
    let clear = Clear::of(all, member);
    let counts = counts(own, clear.range_m.map(|[low, high]| high - low), size_m);
    let across = clear.across();
    let at = |place: [usize; 3]| -> [f64; 3] {
        let share = |a: usize, [low, high]: [f64; 2]| low + (high - low) * place[a] as f64 / counts[a] as f64;
        let mut local = [0.0; 3];
        across.iter().for_each(|a| local[*a] = share(*a, clear.range_m[*a]));
        local[clear.axis] = share(clear.axis, clear.range_at(across.map(|a| local[a])));
        clear.gross.to_global(local)
    };
    let outer = |place: [usize; 3]| (0..3).any(|a| place[a] == 0 || place[a] == counts[a]);
    let nodes: Vec<[f64; 3]> = numbered(counts).map(at).collect();
    let tied = numbered(counts).zip(&nodes).map(|(place, p)| outer(place) && clear.meets(*p)).collect();
    Block { member, nodes, counts, reach_m, tied }
}

impl Block {
    /// Node numbers of the elements within the block.
    fn elements(&self) -> Vec<[usize; 8]> {
        let [nx, ny, nz] = self.counts;
        let id = |i: usize, j: usize, k: usize| (k * (ny + 1) + j) * (nx + 1) + i;
        let mut elements = Vec::new();
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let ring =
                        |k: usize| [id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k)];
                    let (low, top) = (ring(k), ring(k + 1));
                    elements.push([low[0], low[1], low[2], low[3], top[0], top[1], top[2], top[3]]);
                }
            }
        }
        elements
    }

    /// Meshed volume \[m³\].
    pub fn volume_m3(&self) -> f64 {
        self.elements().iter().map(|e| volume_m3(&e.map(|n| self.nodes[n]))).sum()
    }
}

/// Nodes on the held faces of turned members.
pub(super) fn held_nodes(building: &Building, mesh: &Mesh) -> Vec<usize> {
    let mut held = vec![false; mesh.nodes.len()];
    for (part, member) in building.members.iter().enumerate().filter(|(_, m)| m.is_skew()) {
        let faces = building.supports.iter().filter(|s| s.member == member.id).map(|s| match s.face {
            Face::Bottom => member.solid.min[2],
            Face::Top => member.solid.max[2],
        });
        let faces: Vec<f64> = faces.collect();
        for node in mesh.elements.iter().filter(|e| e.part == part).flat_map(|e| e.nodes) {
            held[node] |= faces.iter().any(|z| (z - mesh.nodes[node][2]).abs() < 1e-9);
        }
    }
    (0..held.len()).filter(|n| held[*n]).collect()
}

/// Adds the blocks to a mesh and ties them to it.
pub(super) fn join(mesh: &mut Mesh, building: &Building, blocks: &[Block], real_m3: &[f64]) {
    if blocks.is_empty() {
        return;
    }
    let faces = Faces::of(mesh, outer_faces(mesh));
    let (_, law_of) = Mesh::law_indices(building);
    let mut tied = Vec::new();
    for block in blocks {
        let member = &building.members[block.member];
        let first = mesh.nodes.len();
        let template = Element {
            nodes: [0; 8],
            part: block.member,
            law: law_of[block.member],
            smear: real_m3[block.member] / block.volume_m3(),
            strength: building.strength_factor(&member.id),
        };
        mesh.nodes.extend(&block.nodes);
        let elements = block.elements();
        mesh.elements.extend(elements.iter().map(|e| Element { nodes: e.map(|n| first + n), ..template }));
        let nodes = (0..block.nodes.len()).filter(|n| block.tied[*n]);
        tied.extend(nodes.map(|n| (first + n, block.reach_m, member.is_skew())));
    }
    let held = held_nodes(building, mesh);
    let mut ties = Vec::new();
    for (node, reach_m, skew) in tied.into_iter().filter(|(n, ..)| held.binary_search(n).is_err()) {
        let beside = || faces.nearest(mesh, node, reach_m, true).filter(|_| skew);
        ties.extend(faces.nearest(mesh, node, reach_m, false).or_else(beside));
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

/// Node numbers of the six faces of a hexahedron, within the element.
pub(super) const FACES: [[usize; 4]; 6] =
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

/// Lowest and highest corner of a face \[m\], its element and its nodes.
type PlacedFace = ([f64; 3], [f64; 3], usize, [usize; 4]);

/// Outer faces, found by place: sorted by their lower end along x.
pub struct Faces {
    sorted: Vec<PlacedFace>,
    /// Largest extent along x \[m\].
    widest_m: f64,
}

impl Faces {
    /// Of the faces of a mesh, as from [`outer_faces`].
    pub fn of(mesh: &Mesh, faces: Vec<(usize, [usize; 4])>) -> Self {
        let extent = |face: &[usize; 4], pick: fn(f64, f64) -> f64| -> [f64; 3] {
            std::array::from_fn(|i| {
                face[1..].iter().fold(mesh.nodes[face[0]][i], |a, n| pick(a, mesh.nodes[*n][i]))
            })
        };
        let mut sorted: Vec<_> = faces
            .into_iter()
            .map(|(e, face)| (extent(&face, f64::min), extent(&face, f64::max), e, face))
            .collect();
        sorted.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]).then((a.2, a.3).cmp(&(b.2, b.3))));
        let widest_m = sorted.iter().map(|f| f.1[0] - f.0[0]).fold(0.0, f64::max);
        Self { sorted, widest_m }
    }

    /// Ties a node to the nearest face within reach \[m\]; `None` if there is none. The foot of the perpendicular must lie on the face, or with `beside`
    /// a point of the face within reach; of faces equally near the one of the lowest element counts.
    pub fn nearest(&self, mesh: &Mesh, node: usize, reach_m: f64, beside: bool) -> Option<Tie> {
        let point = mesh.nodes[node];
        let from = self.sorted.partition_point(|f| f.0[0] <= point[0] - self.widest_m - reach_m);
        let to = self.sorted.partition_point(|f| f.0[0] < point[0] + reach_m);
        let near = |f: &&PlacedFace| {
            (0..3).all(|i| point[i] > f.0[i] - reach_m && point[i] < f.1[i] + reach_m) && !f.3.contains(&node)
        };
        let mut faces: Vec<_> = self.sorted[from..to].iter().filter(near).map(|f| (f.2, f.3)).collect();
        faces.sort_unstable();
        let mut best: Option<(f64, Tie)> = None;
        for (element, face) in faces {
            let corners = face.map(|n| mesh.nodes[n]);
            let Some((weights, distance)) = project(&corners, point, beside) else { continue };
            if distance <= reach_m && best.as_ref().is_none_or(|(d, _)| distance < d - 1e-9) {
                let masters = face.into_iter().zip(weights).filter(|(_, w)| *w > 0.0).collect();
                best = Some((distance, Tie { node, masters, element }));
            }
        }
        best.map(|(_, tie)| tie)
    }
}

/// Bilinear weights of the point of a face nearest to `point`, and the distance \[m\]; `None` if its foot lies outside the face,
/// unless `beside` allows for a point of its edge.
fn project(corners: &[[f64; 3]; 4], point: [f64; 3], beside: bool) -> Option<([f64; 4], f64)> {
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
    if !beside && (s.abs() > 1.0 + OUTSIDE || t.abs() > 1.0 + OUTSIDE) {
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
    columns
        .filter(|(m, tied)| **tied && (m.kind == MemberKind::Column || m.is_skew()))
        .map(|(m, _)| m.id.clone())
        .collect()
}
