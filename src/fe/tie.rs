//! Nodes that follow others: tied faces of meshes that do not match, and bars embedded in elements.
//!
//! A tied node moves as the weighted mean of its masters, `v_s = Σ w v_m` with `w >= 0`, `Σ w = 1` (the node-to-segment constraint of
//! Hallquist, Goudreau and Benson, Comput. Methods Appl. Mech. Engng 51 (1985) 107-137). The force on it goes to them by the same
//! weights, so its power is that of the forces passed on, and so does its mass. The mass matrix stays diagonal: `Tᵀ M T` is
//! lumped by its row sums, which keeps mass and momentum and lowers no frequency bound, since for weights that are not negative the
//! row sums bound `Tᵀ M T` from above. The distance that a node may have from its place on the face at the start is kept.
//!
//! A tie ends when the element that carries it no longer acts. The node then has its own mass again and the velocity it had:
//! momentum is kept; the kinetic energy of the masters' relative motion, `Σ w m (v_m - v_s)² / 2`, which the lumping had counted, is
//! booked as released.
//!
//! Limits: a node is tied, not a face. What crosses the tie is exact if the stress is constant and the face of the masters matches that of the
//! tied nodes in shape: the work of a linear field is passed on in full. The forces on the masters are those of the tied side's own
//! nodes, so that on the side with the wider elements a constant traction is not distributed by its own shape functions and a
//! disturbance remains within one element of the interface (see `tests/fe/ties.rs`).

use super::blocks::Blocks;
use super::mesh::{Mesh, Tie};
use serde::{Deserialize, Serialize};

/// Not a tied node.
const FREE: u32 = u32::MAX;

/// The ties of a mesh that act.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Ties {
    /// All ties, acting or not.
    list: Vec<Tie>,
    /// Mass that each has given to its masters \[kg\]; `None`: no longer acts.
    given_kg: Vec<Option<f64>>,
    /// Tie of each node, or `FREE`; empty without ties.
    of_node: Vec<u32>,
    /// Start of each node's share in `carried`, one more than nodes; empty without ties.
    starts: Vec<u32>,
    /// Tied nodes with weights, by master; a tie that has ended has the weight 0.
    carried: Vec<(u32, f64)>,
    /// Kinetic energy booked when ties ended \[J\], not positive.
    pub released_j: f64,
}

impl Ties {
    /// The ties of a mesh. Nodes that are held, tied twice or that carry others are not tied.
    pub fn of(mesh: &Mesh) -> Self {
        if mesh.ties.is_empty() {
            return Self::default();
        }
        let n = mesh.nodes.len();
        let mut barred = vec![false; n];
        mesh.fixed.iter().for_each(|n| barred[*n] = true);
        mesh.ties.iter().flat_map(|t| &t.masters).for_each(|(m, _)| barred[*m] = true);
        let mut this = Self { of_node: vec![FREE; n], starts: vec![0; n + 1], ..Self::default() };
        for tie in &mesh.ties {
            if barred[tie.node] || this.of_node[tie.node] != FREE || tie.masters.is_empty() {
                continue;
            }
            this.of_node[tie.node] = this.list.len() as u32;
            this.list.push(tie.clone());
        }
        this.given_kg = vec![Some(0.0); this.list.len()];
        let mut by_master: Vec<(u32, u32, f64)> = Vec::new();
        for tie in &this.list {
            by_master.extend(tie.masters.iter().map(|(m, w)| (*m as u32, tie.node as u32, *w)));
        }
        by_master.sort_by_key(|(m, s, _)| (*m, *s));
        for (m, ..) in &by_master {
            this.starts[*m as usize + 1] += 1;
        }
        for i in 1..this.starts.len() {
            this.starts[i] += this.starts[i - 1];
        }
        this.carried = by_master.into_iter().map(|(_, s, w)| (s, w)).collect();
        this
    }

    /// Whether there are none.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Number of ties that act.
    pub fn acting(&self) -> usize {
        self.given_kg.iter().flatten().count()
    }

    /// Whether a node is tied.
    pub fn is_tied(&self, node: usize) -> bool {
        self.acting_tie(node).is_some()
    }

    fn acting_tie(&self, node: usize) -> Option<&Tie> {
        let tie = *self.of_node.get(node)?;
        (tie != FREE && self.given_kg[tie as usize].is_some()).then(|| &self.list[tie as usize])
    }

    /// The nodes by which a node moves, with their shares: its masters, or itself.
    pub fn carriers(&self, node: usize) -> Vec<(usize, f64)> {
        self.acting_tie(node).map_or_else(|| vec![(node, 1.0)], |tie| tie.masters.clone())
    }

    /// Tied nodes whose ties act, with their masters and weights, in the order of the mesh.
    pub fn tied(&self) -> impl Iterator<Item = (usize, &[(usize, f64)])> {
        let acting = self.list.iter().zip(&self.given_kg).filter(|(_, given)| given.is_some());
        acting.map(|(tie, _)| (tie.node, &tie.masters[..]))
    }

    /// Tied nodes that a node carries, with its share of each, in a fixed order.
    #[inline]
    pub fn carried_by(&self, node: usize) -> &[(u32, f64)] {
        match self.starts.get(node..node + 2) {
            Some(range) => &self.carried[range[0] as usize..range[1] as usize],
            None => &[],
        }
    }

    /// Moves the mass of tied nodes to their masters; to be called once whenever masses were assembled from the elements.
    pub(super) fn carry_mass(&mut self, mass_kg: &mut [f64]) {
        for (tie, given) in self.list.iter().zip(&mut self.given_kg) {
            let Some(given) = given else { continue };
            *given = std::mem::take(&mut mass_kg[tie.node]);
            for (m, w) in &tie.masters {
                mass_kg[*m] += w * *given;
            }
        }
    }

    /// Gives tied nodes the velocity of their place.
    pub(super) fn follow(&self, v: &mut [[f64; 3]]) {
        for (tie, given) in self.list.iter().zip(&self.given_kg) {
            if given.is_some() {
                v[tie.node] = mean(tie, v);
            }
        }
    }

    /// Moves tied nodes with their velocity.
    pub(super) fn drift(&self, dt_s: f64, v: &[[f64; 3]], x: &mut [[f64; 3]]) {
        for (tie, _) in self.list.iter().zip(&self.given_kg).filter(|(_, given)| given.is_some()) {
            for i in 0..3 {
                x[tie.node][i] += dt_s * v[tie.node][i];
            }
        }
    }

    /// Ends the ties whose element no longer acts. `v` are the velocities from before.
    pub(super) fn release(&mut self, blocks: &Blocks, mass_kg: &mut [f64], v: &mut [[f64; 3]]) {
        for t in 0..self.list.len() {
            let tie = &self.list[t];
            let Some(given) = self.given_kg[t].filter(|_| blocks.share(tie.element) == 0.0) else { continue };
            self.given_kg[t] = None;
            let place = mean(tie, v);
            v[tie.node] = place;
            mass_kg[tie.node] += given;
            for (m, w) in &tie.masters {
                mass_kg[*m] -= w * given;
                let apart: f64 = (0..3).map(|i| (v[*m][i] - place[i]).powi(2)).sum();
                self.released_j -= 0.5 * w * given * apart;
                let range = self.starts[*m] as usize..self.starts[*m + 1] as usize;
                let node = tie.node as u32;
                self.carried[range].iter_mut().filter(|c| c.0 == node).for_each(|c| c.1 = 0.0);
            }
        }
    }
}

/// Weighted mean of the masters.
fn mean(tie: &Tie, v: &[[f64; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (m, w) in &tie.masters {
        for i in 0..3 {
            sum[i] += w * v[*m][i];
        }
    }
    sum
}
