//! Assembly, solution, section forces, reactions, and the search for mechanisms.
//!
//! A frame moves freely if a part has no fixed node, or if its scaled stiffness has an eigenvalue below
//! [`crate::base::sparse::MECHANISM_EIGENVALUE`].

use super::element::{Matrix12, Vector12};
use super::{Frame, SectionForces};
use crate::base::sparse::{Positive, Unsolvable};
use petgraph::unionfind::UnionFind;
use serde::Serialize;
use std::collections::BTreeSet;

/// A node takes part in a mechanism if it moves by more than this share of the largest motion.
const PARTICIPATION: f64 = 1e-4;

/// Members that can move without straining anything.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, thiserror::Error)]
#[error("not held: {}", if members.is_empty() { "what no column, wall, beam or strip of slab connects".to_string() } else { members.join(", ") })]
pub struct Mechanism {
    /// Ids of the members, in the order of the elements.
    pub members: Vec<String>,
}

/// Why a frame has no solution.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// Part of it is a mechanism.
    #[error("the frame is a mechanism; {0}")]
    Mechanism(Mechanism),
    /// The factorisation failed for another reason.
    #[error("the stiffness matrix could not be factored: {0}")]
    Factorisation(String),
}

/// The static solution.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameSolution {
    /// Displacement \[m\] and rotation \[rad\] of each node.
    pub displacement: Vec<[f64; 6]>,
    /// Section forces at the first and second end of each element.
    pub forces: Vec<[SectionForces; 2]>,
    /// `(node, force [N] and moment [N m] of the support on the frame)` for each fixed node.
    pub reactions: Vec<(usize, [f64; 6])>,
    /// Number of unknowns.
    pub unknowns: usize,
}

impl FrameSolution {
    /// Sum of the support forces \[N\].
    pub fn reaction_sum_n(&self) -> [f64; 3] {
        std::array::from_fn(|i| self.reactions.iter().map(|(_, r)| r[i]).sum())
    }
}

impl Frame {
    /// Where in plan the supports bear what they bear: the centre of the loads, if these are vertical \[m\].
    pub fn center_of_reactions_m(&self, solution: &FrameSolution) -> [f64; 2] {
        let mut moment_nm = [0.0; 2];
        for (node, [along_x, along_y, up, about_x, about_y, _]) in &solution.reactions {
            let [x, y, z] = self.nodes[*node].point_m;
            moment_nm[0] += up * x - along_x * z - about_y;
            moment_nm[1] += up * y - along_y * z + about_x;
        }
        moment_nm.map(|moment| moment / solution.reaction_sum_n()[2])
    }
}

/// Each degree of freedom of a node as a combination of unknowns; empty if it is held.
type Ties = Vec<[Vec<(usize, f64)>; 6]>;

impl Frame {
    /// Solves for the static equilibrium under the loads.
    pub fn solve(&self) -> Result<FrameSolution, FrameError> {
        let loose = self.without_support();
        if !loose.is_empty() {
            return Err(FrameError::Mechanism(Mechanism { members: loose }));
        }
        let (ties, unknowns) = self.ties();
        let (triplets, load) = self.assemble(&ties, unknowns);
        match Positive::of(triplets, unknowns) {
            Ok(factor) => Ok(self.results(&ties, &factor.solve(&load), unknowns)),
            Err(Unsolvable::Singular(mode)) => Err(FrameError::Mechanism(self.moving(&expand(&ties, &mode)))),
            Err(Unsolvable::Failed(reason)) => Err(FrameError::Factorisation(reason)),
        }
    }

    /// Members in parts of the frame that no support holds.
    fn without_support(&self) -> Vec<String> {
        let mut parts = UnionFind::new(self.nodes.len());
        for element in &self.elements {
            parts.union(element.nodes[0], element.nodes[1]);
        }
        let held: BTreeSet<usize> = (0..self.nodes.len())
            .filter(|n| self.nodes[*n].fixed.contains(&true))
            .map(|n| parts.find(n))
            .collect();
        let loose = self.elements.iter().filter(|e| !held.contains(&parts.find(e.nodes[0])));
        unique(loose.map(|e| e.member.clone()))
    }

    /// Numbers the unknowns: three for each diaphragm, the rest node by node. Degrees of freedom of nodes without an
    /// element are held.
    fn ties(&self) -> (Ties, usize) {
        let mut used = vec![false; self.nodes.len()];
        self.elements.iter().flat_map(|e| e.nodes).for_each(|n| used[n] = true);
        let mut ties: Ties = vec![Default::default(); self.nodes.len()];
        let mut in_diaphragm = vec![false; self.nodes.len()];
        let mut unknowns = 0;
        for diaphragm in &self.diaphragms {
            let nodes: Vec<usize> = diaphragm.nodes.iter().copied().filter(|n| used[*n]).collect();
            nodes.iter().for_each(|&n| in_diaphragm[n] = true);
            let held = nodes.iter().any(|&n| [0, 1, 5].iter().any(|&i| self.nodes[n].fixed[i]));
            if held || nodes.is_empty() {
                continue;
            }
            let count = nodes.len() as f64;
            let center: [f64; 2] =
                std::array::from_fn(|i| nodes.iter().map(|&n| self.nodes[n].point_m[i]).sum::<f64>() / count);
            for &n in &nodes {
                let [x, y] = [0, 1].map(|i| self.nodes[n].point_m[i] - center[i]);
                ties[n][0] = vec![(unknowns, 1.0), (unknowns + 2, -y)];
                ties[n][1] = vec![(unknowns + 1, 1.0), (unknowns + 2, x)];
                ties[n][5] = vec![(unknowns + 2, 1.0)];
            }
            unknowns += 3;
        }
        for (n, node) in self.nodes.iter().enumerate().filter(|(n, _)| used[*n]) {
            for (i, tie) in ties[n].iter_mut().enumerate() {
                let settled = node.fixed[i] || in_diaphragm[n] && matches!(i, 0 | 1 | 5);
                if !settled {
                    *tie = vec![(unknowns, 1.0)];
                    unknowns += 1;
                }
            }
        }
        (ties, unknowns)
    }

    /// Stiffness as triplets (lower triangle) and the load vector.
    fn assemble(&self, ties: &Ties, unknowns: usize) -> (Vec<(usize, usize, f64)>, Vec<f64>) {
        let mut triplets = Vec::new();
        let mut load = vec![0.0; unknowns];
        let mut apply = |n: usize, i: usize, value: f64| {
            ties[n][i].iter().for_each(|(unknown, share)| load[*unknown] += share * value);
        };
        for (n, node) in self.nodes.iter().enumerate() {
            (0..6).for_each(|i| apply(n, i, node.load[i]));
        }
        for element in &self.elements {
            let b = element.from_nodes(element.nodes.map(|n| self.nodes[n].point_m));
            let p = transposed_times(&b, &element.equivalent_load());
            let k = congruent(&b, &element.stiffness());
            let slot = |i: usize| (element.nodes[i / 6], i % 6);
            for i in 0..12 {
                let (node_i, freedom_i) = slot(i);
                apply(node_i, freedom_i, p[i]);
                for (j, &stiffness) in k[i].iter().enumerate() {
                    let (node_j, freedom_j) = slot(j);
                    for (row, row_share) in &ties[node_i][freedom_i] {
                        for (column, column_share) in &ties[node_j][freedom_j] {
                            if row >= column && stiffness != 0.0 {
                                triplets.push((*row, *column, row_share * column_share * stiffness));
                            }
                        }
                    }
                }
            }
        }
        (triplets, load)
    }

    /// Section forces and reactions from the unknowns.
    fn results(&self, ties: &Ties, values: &[f64], unknowns: usize) -> FrameSolution {
        let displacement = expand(ties, values);
        let mut forces = Vec::new();
        let mut on_nodes: Vec<[f64; 6]> = self.nodes.iter().map(|n| n.load.map(|l| -l)).collect();
        for element in &self.elements {
            let b = element.from_nodes(element.nodes.map(|n| self.nodes[n].point_m));
            let at_nodes: Vector12 = std::array::from_fn(|i| displacement[element.nodes[i / 6]][i % 6]);
            let local = times(&b, &at_nodes);
            let (elastic, p) = (times(&element.stiffness(), &local), element.equivalent_load());
            let end: Vector12 = std::array::from_fn(|i| elastic[i] - p[i]);
            for (i, value) in transposed_times(&b, &end).into_iter().enumerate() {
                on_nodes[element.nodes[i / 6]][i % 6] += value;
            }
            // The end forces act on the element; at its first end the section's normal points inward.
            forces.push([section_forces(&end[..6], -1.0), section_forces(&end[6..], 1.0)]);
        }
        let fixed = |n: &usize| self.nodes[*n].fixed.contains(&true);
        let reactions = (0..self.nodes.len())
            .filter(fixed)
            .map(|n| (n, std::array::from_fn(|i| if self.nodes[n].fixed[i] { on_nodes[n][i] } else { 0.0 })))
            .collect();
        FrameSolution { displacement, forces, reactions, unknowns }
    }

    /// Members of which an end moves in a given motion.
    fn moving(&self, motion: &[[f64; 6]]) -> Mechanism {
        let amplitude = |n: usize| motion[n].iter().fold(0.0f64, |a, c| a.max(c.abs()));
        let largest = (0..motion.len()).map(amplitude).fold(0.0, f64::max);
        let moves = |n: &usize| amplitude(*n) > PARTICIPATION * largest;
        let moving = self.elements.iter().filter(|e| e.nodes.iter().any(moves));
        Mechanism { members: unique(moving.map(|e| e.member.clone())) }
    }
}

/// Degrees of freedom of the nodes from the unknowns.
fn expand(ties: &Ties, values: &[f64]) -> Vec<[f64; 6]> {
    let one = |tie: &Vec<(usize, f64)>| tie.iter().map(|(unknown, share)| share * values[*unknown]).sum();
    ties.iter().map(|node| std::array::from_fn(|i| one(&node[i]))).collect()
}

fn section_forces(end: &[f64], side: f64) -> SectionForces {
    SectionForces {
        axial_n: -side * end[0],
        shear_n: [side * end[1], side * end[2]],
        torsion_nm: side * end[3],
        moment_nm: [side * end[4], side * end[5]],
    }
}

fn times(a: &Matrix12, x: &Vector12) -> Vector12 {
    std::array::from_fn(|i| (0..12).map(|j| a[i][j] * x[j]).sum())
}

fn transposed_times(a: &Matrix12, x: &Vector12) -> Vector12 {
    std::array::from_fn(|i| (0..12).map(|j| a[j][i] * x[j]).sum())
}

/// `bᵀ k b`.
fn congruent(b: &Matrix12, k: &Matrix12) -> Matrix12 {
    let kb: Matrix12 =
        std::array::from_fn(|i| std::array::from_fn(|j| (0..12).map(|m| k[i][m] * b[m][j]).sum()));
    std::array::from_fn(|i| std::array::from_fn(|j| (0..12).map(|m| b[m][i] * kb[m][j]).sum()))
}

/// Names without repetition, in their order.
fn unique(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut seen = BTreeSet::new();
    names.filter(|name| seen.insert(name.clone())).collect()
}
