//! The outer faces of hexahedra, kept up to date while elements end.

use crate::base::vector::{V3, add, dot, scale};
use crate::fe::incidence::elements_of_nodes;
use crate::fe::mesh::Mesh;
use crate::fe::tie::Ties;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// No neighbour.
const NONE: u32 = u32::MAX;
/// Local nodes of the faces of a hexahedron, counter-clockwise from outside; faces `2k` and `2k + 1` are opposite.
const CORNERS: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [2, 3, 7, 6], [0, 4, 7, 3], [1, 2, 6, 5]];

/// Cosine between the normals of a node and a face above which they do not look at each other. A node amid a flat side has 0 against
/// the side of a block that slides over it, a corner has -0.58 against each face that it can run into.
const FACING: f64 = -0.25;

/// All faces of a mesh; face `6 e + k` is face `k` of element `e`. A face is outer if its element acts and no acting element
/// lies behind it.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Faces {
    /// Nodes of the elements.
    nodes: Vec<[u32; 8]>,
    /// Face on the other side of each face.
    behind: Vec<u32>,
    /// Whether each element still acts.
    acts: Vec<bool>,
    /// Distance of each pair of opposite faces in the undeformed mesh \[m\].
    thickness_m: Vec<[f32; 3]>,
    /// Start of each node's elements in `around`, one more than nodes.
    starts: Vec<u32>,
    /// Elements at each node.
    around: Vec<u32>,
    /// Narrow sides of the undeformed mesh, by face: none of their nodes looks where they look ([`Self::looks_by_a_narrow_side`]); empty if there are none.
    narrow: Vec<bool>,
    /// Nodes that a node hangs together with by acting ties: its masters, or what it carries.
    linked: BTreeMap<u32, Vec<u32>>,
}

impl Faces {
    /// Faces of a mesh all of whose elements act.
    pub fn of(mesh: &Mesh) -> Self {
        let nodes: Vec<[u32; 8]> = mesh.elements.iter().map(|e| e.nodes.map(|n| n as u32)).collect();
        let thickness_m =
            mesh.elements.iter().map(|e| thicknesses(&e.nodes.map(|n| mesh.nodes[n]))).collect();
        let (starts, around) = elements_of_nodes(&nodes, mesh.nodes.len());
        let (behind, acts) = (neighbours(&nodes), vec![true; nodes.len()]);
        let (narrow, linked) = (Vec::new(), BTreeMap::new());
        let mut faces = Self { behind, acts, nodes, thickness_m, starts, around, narrow, linked };
        let narrow: Vec<u32> = faces.outer().filter(|f| faces.is_narrow(*f, &mesh.nodes)).collect();
        if !narrow.is_empty() {
            faces.narrow = vec![false; faces.behind.len()];
            narrow.into_iter().for_each(|f| faces.narrow[f as usize] = true);
        }
        faces
    }

    /// Whether an outer face belongs to the side of a plate of one layer that is so thin that what comes upon it is looked at by none of its nodes: their faces above and below outweigh it.
    fn is_narrow(&self, face: u32, x: &[V3]) -> bool {
        let area = super::narrow::area_normal(&self.corners(face).map(|c| x[c as usize]));
        let opposite = scale(-1.0 / dot(area, area).sqrt(), area);
        let away = |c: u32| self.normal_at(c, x).is_some_and(|own| looks_away(&own, &opposite));
        self.corners(face).into_iter().all(away)
    }

    /// Whether a node that does not look against a face as a whole does so by a narrow side of its own.
    pub fn looks_by_a_narrow_side(&self, node: u32, x: &[V3], against: &V3) -> bool {
        if self.narrow.is_empty() {
            return false;
        }
        let own = self.elements_at(node).flat_map(|e| 6 * e..6 * e + 6);
        let narrow = own.filter(|f| self.narrow[*f as usize] && self.is_outer(*f));
        narrow
            .map(|f| self.corners(f))
            .filter(|corners| corners.contains(&node))
            .any(|corners| !looks_away(&super::narrow::area_normal(&corners.map(|c| x[c as usize])), against))
    }

    /// Takes in which ties act.
    pub fn link(&mut self, ties: &Ties) {
        self.linked.clear();
        for (node, masters) in ties.tied() {
            for (master, _) in masters {
                self.linked.entry(node as u32).or_default().push(*master as u32);
                self.linked.entry(*master as u32).or_default().push(node as u32);
            }
        }
    }

    /// A node and those it is linked with.
    fn with_linked(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        std::iter::once(node).chain(self.linked.get(&node).into_iter().flatten().copied())
    }

    /// Gives elements other nodes; which of them act stays.
    pub fn reconnect(&mut self, elements: &[[u32; 8]], nodes: usize) {
        self.nodes.copy_from_slice(elements);
        self.behind = neighbours(&self.nodes);
        (self.starts, self.around) = elements_of_nodes(&self.nodes, nodes);
    }

    /// All outer faces, in order.
    pub fn outer(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.behind.len() as u32).filter(|f| self.is_outer(*f))
    }

    /// Whether a face is outer.
    #[inline]
    pub fn is_outer(&self, face: u32) -> bool {
        let behind = self.behind[face as usize];
        self.acts[face as usize / 6] && (behind == NONE || !self.acts[behind as usize / 6])
    }

    /// Nodes of a face, counter-clockwise from outside.
    #[inline]
    pub fn corners(&self, face: u32) -> [u32; 4] {
        let nodes = &self.nodes[face as usize / 6];
        CORNERS[face as usize % 6].map(|c| nodes[c])
    }

    /// Depth below a face up to which a node counts as penetrating: half of its element's thickness \[m\].
    #[inline]
    pub fn depth_m(&self, face: u32) -> f64 {
        0.5 * f64::from(self.thickness_m[face as usize / 6][face as usize % 6 / 2])
    }

    /// Median thickness of the elements \[m\].
    pub fn median_thickness_m(&self) -> f64 {
        let mut all: Vec<f32> = self.thickness_m.iter().flatten().copied().collect();
        all.sort_by(f32::total_cmp);
        all.get(all.len() / 2).map_or(0.0, |t| f64::from(*t))
    }

    /// Acting elements at a node.
    pub fn elements_at(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        self.around_node(node).filter(|e| self.acts[*e as usize])
    }

    fn around_node(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        let range = self.starts[node as usize] as usize..self.starts[node as usize + 1] as usize;
        self.around[range].iter().copied()
    }

    /// Ends an element. The outer faces at its nodes are added to `changed`: some have just been opened, and the others lose
    /// what kept the nodes of this element from meeting them.
    pub fn end(&mut self, element: usize, changed: &mut Vec<u32>) {
        self.acts[element] = false;
        for node in self.nodes[element] {
            for e in self.elements_at(node) {
                changed.extend((6 * e..6 * e + 6).filter(|f| self.is_outer(*f)));
            }
        }
    }

    /// Marks the nodes that hang together with a face: an acting element holds them and a corner of the face, tied nodes and their masters
    /// being as one. Their `marks` get the number of the face.
    pub fn mark_joined(&self, face: u32, marks: &mut [u32]) {
        let corners = self.corners(face);
        if self.linked.is_empty() {
            for e in corners.into_iter().flat_map(|c| self.elements_at(c)) {
                self.nodes[e as usize].iter().for_each(|n| marks[*n as usize] = face);
            }
            return;
        }
        let held = corners.into_iter().flat_map(|c| self.with_linked(c)).flat_map(|c| self.elements_at(c));
        for n in held.flat_map(|e| self.nodes[e as usize]).flat_map(|n| self.with_linked(n)) {
            marks[n as usize] = face;
        }
    }

    /// Sum of the area normals of the outer faces at a node, to compare directions; `None` for a node without faces: debris, or
    /// inside.
    pub fn normal_at(&self, node: u32, x: &[V3]) -> Option<V3> {
        let mut sum = [0.0; 3];
        let mut any = false;
        for e in self.elements_at(node) {
            for f in (6 * e..6 * e + 6).filter(|f| self.is_outer(*f)) {
                let corners = self.corners(f);
                if corners.contains(&node) {
                    sum = add(sum, super::narrow::area_normal(&corners.map(|c| x[c as usize])));
                    any = true;
                }
            }
        }
        any.then_some(sum)
    }
}

/// Whether a surface with a normal of any length does not look at one with a unit normal.
pub fn looks_away(own: &V3, from: &V3) -> bool {
    dot(*own, *from) > FACING * dot(*own, *own).sqrt()
}

fn center(points: &[V3; 8], face: usize) -> V3 {
    scale(0.25, CORNERS[face].iter().fold([0.0; 3], |sum, c| add(sum, points[*c])))
}

fn thicknesses(points: &[V3; 8]) -> [f32; 3] {
    std::array::from_fn(|k| {
        let between = add(center(points, 2 * k + 1), scale(-1.0, center(points, 2 * k)));
        dot(between, between).sqrt() as f32
    })
}

/// The face on the other side of each face: the one with the same nodes.
fn neighbours(nodes: &[[u32; 8]]) -> Vec<u32> {
    let mut keyed: Vec<([u32; 4], u32)> = Vec::with_capacity(6 * nodes.len());
    for (e, nodes) in nodes.iter().enumerate() {
        for (k, corners) in CORNERS.iter().enumerate() {
            let mut key = corners.map(|c| nodes[c]);
            key.sort_unstable();
            keyed.push((key, (6 * e + k) as u32));
        }
    }
    keyed.sort_unstable();
    let mut behind = vec![NONE; keyed.len()];
    for pair in keyed.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        behind[pair[0].1 as usize] = pair[1].1;
        behind[pair[1].1 as usize] = pair[0].1;
    }
    behind
}
