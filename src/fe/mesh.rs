//! The hexahedral mesh of a building, and meshes cut out of it.

use super::apart;
use super::grid::MeshGrid;
use super::law::Law;
use super::merge;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::{Building, Face};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// A mesh of eight-node hexahedra. Node order of an element: bottom face counter-clockwise seen from +z, then top face.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Node positions \[m\].
    pub nodes: Vec<[f64; 3]>,
    /// Elements, sorted by law, each owned by one part.
    pub elements: Vec<Element>,
    /// Laws that the elements refer to.
    pub laws: Vec<Law>,
    /// Two-node bars.
    pub trusses: Vec<Truss>,
    /// Nodes that follow others.
    pub ties: Vec<Tie>,
    /// Nodes that cannot move.
    pub fixed: Vec<usize>,
    /// Part names; for a building these are the member ids in file order.
    pub parts: Vec<String>,
}

/// One hexahedron.
#[derive(Debug, Clone, Copy)]
pub struct Element {
    /// Node indices.
    pub nodes: [usize; 8],
    /// Index into [`Mesh::parts`].
    pub part: usize,
    /// Index into [`Mesh::laws`].
    pub law: usize,
    /// Factor on density, stiffness and strength: real over meshed volume of the member. A face moved to a mesh plane
    /// then changes neither mass nor axial or bending resistance of the member.
    pub smear: f64,
    /// Further factor on strength (preparatory weakening).
    pub strength: f64,
}

/// A two-node bar (rebar): axial force only.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truss {
    /// Node indices.
    pub nodes: [usize; 2],
    /// Cross-section \[m²\].
    pub area_m2: f64,
    /// Index into [`Mesh::parts`].
    pub part: usize,
    /// Index into [`Mesh::laws`].
    pub law: usize,
}

/// A node without inertia of its own that moves as the weighted mean of others: a node tied to a face (four masters) or
/// embedded in an element (eight masters). Its mass and the forces on it go to its masters by the same weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tie {
    /// The node that follows.
    pub node: usize,
    /// Masters with weights that sum to one. A master is never itself tied.
    pub masters: Vec<(usize, f64)>,
    /// Element that carries the tie: when it dies the node is free.
    pub element: usize,
}

/// How a member's volume changed when its faces were moved to mesh planes.
#[derive(Debug, Clone, PartialEq)]
pub struct Snapped {
    /// Member id.
    pub member: String,
    /// Real over meshed volume.
    pub volume_ratio: f64,
}

impl Mesh {
    /// Meshes a building (members cut in preparation left out) at a target element size \[m\]; also returns the
    /// members whose volume the mesh does not reproduce exactly.
    pub fn of(building: &Building, size_m: f64) -> (Self, Vec<Snapped>) {
        let grid = MeshGrid::of(building, size_m);
        let mut moved = building.clone();
        for (i, member) in moved.members.iter_mut().enumerate() {
            member.solid = if grid.apart[i] { merge::EMPTY } else { grid.solids[i] };
            member.openings = grid.openings[i].clone();
        }
        let cells = Partition::on_planes(&moved, grid.planes);
        let real = Partition::of(building).volumes(building.members.len());
        let mut meshed = cells.volumes(building.members.len());
        let blocks = apart::blocks(building, &grid.apart, size_m);
        for block in &blocks {
            meshed[block.member] = block.volume_m3();
        }
        let snapped = building
            .members
            .iter()
            .enumerate()
            .filter(|(i, _)| meshed[*i] > 0.0 && (real[*i] / meshed[*i] - 1.0).abs() > 1e-9)
            .map(|(i, m)| Snapped { member: m.id.clone(), volume_ratio: real[i] / meshed[i] })
            .collect();
        let mut mesh = Self::from_cells(building, &cells, &real, &meshed);
        apart::join(&mut mesh, building, &blocks, &real);
        mesh.fixed = supported_nodes(building, &grid.solids, &mesh.nodes);
        mesh.fixed.extend(apart::held_nodes(building, &mesh));
        mesh.fixed.sort_unstable();
        (mesh, snapped)
    }

    pub(super) fn law_indices(building: &Building) -> (Vec<Law>, Vec<usize>) {
        let mut laws: Vec<Law> = Vec::new();
        let mut law_of = Vec::new();
        for member in &building.members {
            let law = Law::from(building.law_of(member));
            let index = laws.iter().position(|l| *l == law).unwrap_or_else(|| {
                laws.push(law);
                laws.len() - 1
            });
            law_of.push(index);
        }
        (laws, law_of)
    }

    fn from_cells(building: &Building, cells: &Partition, real: &[f64], meshed: &[f64]) -> Self {
        let count = cells.count();
        let stride = [1, count[0] + 1, (count[0] + 1) * (count[1] + 1)];
        let (laws, law_of) = Self::law_indices(building);
        const NONE: u32 = u32::MAX;
        let mut numbers = vec![NONE; stride[2] * (count[2] + 1)];
        let mut nodes = Vec::new();
        let mut elements = Vec::new();
        let is_cut: Vec<bool> = building.members.iter().map(|m| building.is_cut(&m.id)).collect();
        let strength: Vec<f64> = building.members.iter().map(|m| building.strength_factor(&m.id)).collect();
        for (cell, owner) in cells.cells().filter(|(_, owner)| !is_cut[*owner]) {
            const CORNERS: [[usize; 3]; 8] =
                [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
            let ids = CORNERS.map(|c| {
                let at: [usize; 3] = std::array::from_fn(|i| cell[i] + c[i]);
                let key = at[0] * stride[0] + at[1] * stride[1] + at[2] * stride[2];
                if numbers[key] == NONE {
                    numbers[key] = nodes.len() as u32;
                    nodes.push(std::array::from_fn(|i| cells.planes[i][at[i]]));
                }
                numbers[key] as usize
            });
            elements.push(Element {
                nodes: ids,
                part: owner,
                law: law_of[owner],
                smear: real[owner] / meshed[owner],
                strength: strength[owner],
            });
        }
        elements.sort_by_key(|e| e.law);
        let parts = building.members.iter().map(|m| m.id.clone()).collect();
        Self { nodes, elements, laws, parts, ..Self::default() }
    }

    /// The mesh of the hexahedra to keep; see [`Self::piece`].
    pub fn cut_out(&self, keep: impl Fn(usize) -> bool) -> (Self, Vec<usize>) {
        let kept: Vec<usize> = (0..self.elements.len()).filter(|i| keep(*i)).collect();
        self.piece(&kept)
    }

    /// The mesh of some of the hexahedra, ascending, with nodes renumbered; also returns the old index of each new node. Ties stay between hexahedra that
    /// are kept, bars where both their nodes belong to such hexahedra or are tied into them.
    pub fn piece(&self, kept: &[usize]) -> (Self, Vec<usize>) {
        let mut numbers = Numbers { new_of: BTreeMap::new(), old: Vec::new() };
        let renumbered = |index: &usize| {
            let element = &self.elements[*index];
            Element { nodes: element.nodes.map(|n| numbers.of(n)), ..*element }
        };
        let elements: Vec<Element> = kept.iter().map(renumbered).collect();
        let tie_of = |tie: &Tie| {
            let held = tie.masters.iter().all(|(m, _)| numbers.new_of.contains_key(m));
            Some((tie.node, kept.binary_search(&tie.element).ok().filter(|_| held)?))
        };
        let tied: BTreeMap<usize, (&Tie, usize)> = self
            .ties
            .iter()
            .filter_map(|tie| tie_of(tie).map(|(node, element)| (node, (tie, element))))
            .collect();
        let mut trusses = Vec::new();
        for truss in &self.trusses {
            if truss.nodes.iter().all(|n| numbers.new_of.contains_key(n) || tied.contains_key(n)) {
                trusses.push(Truss { nodes: truss.nodes.map(|n| numbers.of(n)), ..*truss });
            }
        }
        let Numbers { new_of, old } = numbers;
        let ties = tied
            .values()
            .filter_map(|(tie, element)| {
                let masters = tie.masters.iter().map(|(m, w)| (new_of[m], *w)).collect();
                Some(Tie { node: *new_of.get(&tie.node)?, masters, element: *element })
            })
            .collect();
        let fixed = self.fixed.iter().filter_map(|n| new_of.get(n).copied()).collect();
        let nodes = old.iter().map(|n| self.nodes[*n]).collect();
        let (laws, parts) = (self.laws.clone(), self.parts.clone());
        (Self { nodes, elements, laws, trusses, ties, fixed, parts }, old)
    }

    /// Members of a building that should have elements and have none; at most those that could not be meshed at all ([`merge`]).
    pub fn unmeshed(&self, building: &Building) -> Vec<String> {
        let mut meshed = vec![false; building.members.len()];
        self.elements.iter().for_each(|e| meshed[e.part] = true);
        let lost =
            building.members.iter().zip(&meshed).filter(|(m, meshed)| !**meshed && !building.is_cut(&m.id));
        lost.map(|(m, _)| m.id.clone()).collect()
    }

    /// The box around an element of it in the undeformed mesh \[m\].
    pub fn bounds(&self, element: &Element) -> Aabb {
        let corners = element.nodes.map(|n| Aabb { min: self.nodes[n], max: self.nodes[n] });
        corners[1..].iter().fold(corners[0], |all, corner| all.around(*corner))
    }

    /// Centre of an element in the undeformed mesh \[m\].
    pub fn center(&self, element: usize) -> [f64; 3] {
        let nodes = self.elements[element].nodes;
        std::array::from_fn(|i| nodes.iter().map(|n| self.nodes[*n][i]).sum::<f64>() / 8.0)
    }
}

/// New numbers of nodes in the order in which they are asked for.
struct Numbers {
    new_of: BTreeMap<usize, usize>,
    old: Vec<usize>,
}

impl Numbers {
    fn of(&mut self, node: usize) -> usize {
        *self.new_of.entry(node).or_insert_with(|| {
            self.old.push(node);
            self.old.len() - 1
        })
    }
}

/// Nodes on the supported faces.
fn supported_nodes(building: &Building, solids: &[Aabb], nodes: &[[f64; 3]]) -> Vec<usize> {
    let numbers: BTreeMap<&str, usize> =
        building.members.iter().enumerate().map(|(i, m)| (m.id.as_str(), i)).collect();
    let faces: Vec<Aabb> = building
        .supports
        .iter()
        .filter_map(|s| {
            let member = *numbers.get(s.member.as_str())?;
            let solid = solids[member];
            if building.members[member].is_skew() {
                return None; // [`apart::held_nodes`]
            }
            let z = match s.face {
                Face::Bottom => solid.min[2],
                Face::Top => solid.max[2],
            };
            Some(Aabb { min: [solid.min[0], solid.min[1], z], max: [solid.max[0], solid.max[1], z] })
        })
        .collect();
    let levels: BTreeSet<u64> = faces.iter().map(|f| f.min[2].to_bits()).collect();
    let levels: Vec<f64> = levels.into_iter().map(f64::from_bits).collect();
    let faces = Boxes::of(faces.into_iter());
    let on_face = |p: &[f64; 3]| {
        levels.iter().any(|z| (p[2] - z).abs() < COORDINATE_TOLERANCE_M)
            && !faces.near(&Aabb { min: *p, max: *p }, COORDINATE_TOLERANCE_M).is_empty()
    };
    (0..nodes.len()).filter(|n| on_face(&nodes[*n])).collect()
}
