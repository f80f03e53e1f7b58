//! What the loads on a rigid set would do to its elements: an elastic solve with the forces out of balance, element by element.
//!
//! A set is in balance with its inertia by construction, but what its elements would have to bear for that changes. With `F_i` the
//! force of the elements around the set and the weight on its node `i`, `a_i` the node's acceleration with the set, and `f_i` the force of the frozen stresses,
//! the elements would have to bear `r_i = F_i - m_i a_i - f_i` more than they did when they became rigid (d'Alembert). These forces are in balance with themselves; `K u = r` with
//! the elastic stiffness of the set gives the displacements, statically, and the kernel itself tells what they would do: an element with more
//! plastic strain than [`super::HybridSettings::overload_strain`] afterwards is overloaded. No section has to be named, loops and plates need no special care, the
//! stress that an element had counts, and so does bending within it (its hourglass stresses are in the yield condition).
//!
//! `K` is factorised once a set, in the positions at which it became rigid; a check costs a substitution and one pass over the set's elements. A weak spring at each component
//! ([`GROUNDING`] of the mean diagonal) makes `K` definite; as `r` is in balance the springs bear nothing.

use super::sets::RigidSet;
use crate::base::vector::{V3, add, cross, scale};
use crate::fe::dynamics::Dynamics;
use crate::fe::kernel::{BlockForce, BlockMaterial, BlockState, KernelStep, LANES, update_block};
use crate::fe::preload::Factor;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Spring at each component over the mean diagonal of the stiffness: the factor is one of single precision.
const GROUNDING: f64 = 1e-6;

/// The elements of a set in the positions at which it became rigid.
#[derive(Debug, Clone)]
pub struct Demand {
    factor: Factor,
    /// Blocks with rigid elements of the set: lanes with their elements and the places of their nodes in the set.
    blocks: Vec<Vec<(u32, [u32; 8])>>,
    /// Forces of the frozen stresses on the nodes, in body coordinates \[N\].
    frozen_n: Vec<V3>,
}

const STILL: KernelStep = KernelStep { dt_s: 1.0, viscous: false };

/// Eight elements as a block: the kernel's constants and state, and the places of their nodes.
struct Group {
    at: BlockForce,
    material: BlockMaterial,
    state: BlockState,
}

/// Gathers up to eight elements of one law.
fn gather(set: &RigidSet, body: &Dynamics, elements: &[(u32, [u32; 8])]) -> Group {
    let mut material = body.blocks.of_element(elements[0].0 as usize).0.material.lanes();
    let mut state = BlockState::default();
    let mut at = [[0.0; LANES]; 24];
    for l in 0..LANES {
        let (element, nodes) = elements[l.min(elements.len() - 1)];
        let (block, from) = body.blocks.of_element(element as usize);
        material.copy_lane(l, &block.material.lanes(), from);
        state.copy_lane(l, &block.state, from);
        for (k, n) in nodes.iter().enumerate() {
            for i in 0..3 {
                at[3 * k + i][l] = set.places[*n as usize][i];
            }
        }
    }
    Group { at, material, state }
}

impl Demand {
    /// Factorises the stiffness of a set; `None` if it is not positive definite.
    pub fn of(set: &RigidSet, body: &Dynamics) -> Option<Self> {
        let place = |n: usize| set.nodes.binary_search(&(n as u32)).unwrap_or(0) as u32;
        let mut by_law: BTreeMap<usize, Vec<(u32, [u32; 8])>> = BTreeMap::new();
        for e in &set.elements {
            let (block, _) = body.blocks.of_element(*e as usize);
            by_law
                .entry(block.material.table)
                .or_default()
                .push((*e, body.blocks.nodes_of(*e as usize).map(place)));
        }
        let blocks: Vec<Vec<(u32, [u32; 8])>> =
            by_law.values().flat_map(|list| list.chunks(LANES).map(<[_]>::to_vec)).collect();
        let mut matrix = NodeColumns::of(set.nodes.len(), &blocks);
        let mut frozen_n = vec![[0.0; 3]; set.nodes.len()];
        for elements in &blocks {
            let group = gather(set, body, elements);
            matrix.add(&group, body, elements);
            for ((_, nodes), force) in elements.iter().zip(forces(&group, body)) {
                for (n, force) in nodes.iter().zip(force) {
                    frozen_n[*n as usize] = add(frozen_n[*n as usize], force);
                }
            }
        }
        Some(Self { factor: matrix.factor()?, blocks, frozen_n })
    }

    /// Elements of the set that its loads would make flow by more than `strain`: those since the last check in the mean.
    pub fn overloaded(&self, set: &RigidSet, body: &Dynamics, strain: f64) -> Vec<usize> {
        let rhs = self.out_of_balance(set, body);
        let u = self.factor.solve(&rhs);
        let mut found = Vec::new();
        for elements in &self.blocks {
            let Group { mut at, material, mut state } = gather(set, body, elements);
            let mut moved = [[0.0; LANES]; 24];
            for l in 0..LANES {
                let (_, nodes) = elements[l.min(elements.len() - 1)];
                for (k, n) in nodes.iter().enumerate() {
                    for i in 0..3 {
                        moved[3 * k + i][l] = u[3 * *n as usize + i];
                        at[3 * k + i][l] += u[3 * *n as usize + i];
                    }
                }
            }
            let (before, mut force) = (state.plastic_strain, [[0.0; LANES]; 24]);
            let table = &body.blocks.tables[material.table];
            update_block(&at, &moved, &material, table, &mut state, &mut force, STILL);
            for (l, (element, _)) in elements.iter().enumerate() {
                let flow = state.plastic_strain[l] - before[l];
                if flow.is_nan() || flow > strain {
                    found.push(*element as usize);
                }
            }
        }
        found
    }

    /// `F - m a - f` on each component of the nodes, in body coordinates \[N\].
    fn out_of_balance(&self, set: &RigidSet, body: &Dynamics) -> Vec<f64> {
        let back = set.motion.rotation().transpose();
        let mean = 1.0 / f64::from(set.pulls.max(1));
        let (mut force, mut moment) = (scale(set.motion.mass_kg, body.acceleration_m_s2), [0.0; 3]);
        for (i, sum) in set.boundary.iter().zip(&set.pull_n) {
            let n = set.nodes[*i as usize] as usize;
            let arm = std::array::from_fn(|k| body.x[n][k] - set.motion.centre_m[k]);
            let pull = scale(mean, *sum);
            force = add(force, pull);
            moment = add(moment, cross(arm, pull));
        }
        let acceleration = set.motion.accelerations(force, moment);
        let turned = |f: V3| -> V3 { (back * Vector3::from(f)).into() };
        let mut rhs = vec![0.0; 3 * set.nodes.len()];
        let mut add_to = |i: usize, f: V3| (0..3).for_each(|k| rhs[3 * i + k] += f[k]);
        for (i, (n, place)) in set.nodes.iter().zip(&set.places).enumerate() {
            let (m, a) = (body.mass_kg[*n as usize], acceleration(place));
            add_to(i, turned(std::array::from_fn(|k| m * (body.acceleration_m_s2[k] - a[k]))));
            add_to(i, scale(-1.0, self.frozen_n[i]));
        }
        for (i, sum) in set.boundary.iter().zip(&set.pull_n) {
            add_to(*i as usize, turned(scale(mean, *sum)));
        }
        rhs
    }
}

/// Forces of the stresses of a group on its nodes \[N\].
fn forces(group: &Group, body: &Dynamics) -> [[V3; 8]; LANES] {
    let mut elastic = group.material;
    elastic.yield_scale = [f64::INFINITY; LANES];
    let (mut state, mut force) = (group.state, [[0.0; LANES]; 24]);
    let table = &body.blocks.tables[elastic.table];
    update_block(&group.at, &[[0.0; LANES]; 24], &elastic, table, &mut state, &mut force, STILL);
    std::array::from_fn(|l| std::array::from_fn(|k| std::array::from_fn(|i| force[3 * k + i][l])))
}

/// The lower triangle of a stiffness by columns of 3 x 3 blocks, one for each pair of nodes that share an element.
struct NodeColumns {
    /// Column and row node of each block, sorted.
    pairs: Vec<(u32, u32)>,
    /// Where the blocks of each node's column start, one more than nodes.
    starts: Vec<usize>,
    /// `[row][column]` \[N/m\].
    blocks: Vec<[[f64; 3]; 3]>,
}

impl NodeColumns {
    /// Zeros with room for these elements.
    fn of(nodes: usize, groups: &[Vec<(u32, [u32; 8])>]) -> Self {
        let mut pairs = Vec::new();
        for (_, nodes) in groups.iter().flatten() {
            for a in nodes {
                pairs.extend(nodes.iter().filter(|b| *b >= a).map(|b| (*a, *b)));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        let starts = (0..=nodes).map(|n| pairs.partition_point(|p| (p.0 as usize) < n)).collect();
        let blocks = vec![[[0.0; 3]; 3]; pairs.len()];
        Self { pairs, starts, blocks }
    }

    /// Adds the elastic stiffness of a group, from the forces of unit displacements.
    fn add(&mut self, group: &Group, body: &Dynamics, elements: &[(u32, [u32; 8])]) {
        const UNIT_M: f64 = 1e-9;
        let mut elastic = group.material;
        elastic.yield_scale = [1e12; LANES];
        let table = &body.blocks.tables[elastic.table];
        for column in 0..24 {
            let mut moved = [[0.0; LANES]; 24];
            moved[column] = [UNIT_M; LANES];
            let mut state = BlockState { share: [1.0; LANES], ..BlockState::default() };
            let mut force = [[0.0; LANES]; 24];
            update_block(&group.at, &moved, &elastic, table, &mut state, &mut force, STILL);
            for (l, (_, nodes)) in elements.iter().enumerate() {
                let (a, j) = (nodes[column / 3], column % 3);
                let of_node = self.starts[a as usize]..self.starts[a as usize + 1];
                for (k, b) in nodes.iter().enumerate().filter(|(_, b)| **b >= a) {
                    if let Ok(at) = self.pairs[of_node.clone()].binary_search(&(a, *b)) {
                        let block = &mut self.blocks[of_node.start + at];
                        (0..3).for_each(|i| block[i][j] += force[3 * k + i][l] / UNIT_M);
                    }
                }
            }
        }
    }

    /// The factor of the matrix with its springs.
    fn factor(self) -> Option<Factor> {
        let diagonal = self.pairs.iter().zip(&self.blocks).filter(|((a, b), _)| a == b);
        let sum: f64 = diagonal.map(|(_, k)| k[0][0] + k[1][1] + k[2][2]).sum();
        let nodes = self.starts.len() - 1;
        let spring = GROUNDING * sum / (3 * nodes) as f64;
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for node in 0..nodes {
            for j in 0..3 {
                for at in self.starts[node]..self.starts[node + 1] {
                    let ((a, b), block) = (self.pairs[at], &self.blocks[at]);
                    for i in (0..3).filter(|i| a != b || *i >= j) {
                        rows.push(3 * b + i as u32);
                        values.push((block[i][j] + if a == b && i == j { spring } else { 0.0 }) as f32);
                    }
                }
                starts.push(rows.len() as u32);
            }
        }
        Factor::of(&starts, &rows, &values)
    }
}
