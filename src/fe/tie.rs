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
//! Limits: a node is tied, not a face. Rigid motion, linear fields, force and moment are exact always; a uniform stress where the tied side's nodes
//! include the masters' (1:2, 1:3). Elsewhere the masters' shares of a uniform traction are not those of their own shape functions. What that disturbs at a 2:3
//! interface, measured on a bar in tension (`tests/fe/ties.rs`) in units of the elongation of one element of the masters' side:
//!
//! | | at the interface | one element away | two | three |
//! |---|---|---|---|---|
//! | displacement, masters' side | 0.19 to 0.20 | 0.020 to 0.023 | 0.007 to 0.009 | 0.002 to 0.005 |
//!
//! All of the tied side stays displaced by 0.020, what the interface gives. The mean stress of an element is off by at most 0.7 % on the masters' side, and on the tied side by
//! 11 % in the first layer of elements, 1.6 to 1.7 % in the second, 0.4 to 0.5 % in the third. These figures are the same for 2, 4 and 6 elements across: the disturbance belongs to the
//! elements. So that of the stress stays, in a zone that shrinks with them, and that of displacements falls with their size: of the elongation of a bar of eight elements, 2.4 % at the interface
//! and 0.26 % behind it; of sixteen 1.2 % and 0.12 %, of twenty-four 0.84 % and 0.08 %.
//!
//! No choice of weights that are not negative mends that. On an edge of length 1 with masters at 0, 1/2, 1 and tied nodes at 0, 1/3, 2/3, 1 a uniform traction puts 1/6,
//! 1/3, 1/3, 1/6 on the tied nodes and should put 1/4, 1/2, 1/4 on the masters. The node at 0 must follow the master at 0 alone (`Σ w x_m = x_s`, without which moments
//! and rigid rotations are lost) and gives it 1/6. The node at 1/3 has, by the same condition, a weight of at least 1/3 there, and gives it at least 1/9: together 0.278 or more,
//! not 0.25. Weights by the overlap of tributary areas give 1/4, 1/2, 1/4 exactly, but place the node at 0 at x = 1/12 and that at 1 at 11/12: the interface would
//! turn with 5/6 of the rotation at its edge and bear a moment that is in no element. Weights of both signs would do: 7/24, 3/4 and -1/24 at
//! 1/3 and the mirror image at 2/3 are exact to round-off. They are not used. In a building meshes overlap at random, and such weights have to be found from the areas of overlap of all faces of an interface together; a
//! tied node then hangs on nodes of several elements, of which one may erode while its tie goes on; and row sums no longer bound `Tᵀ M T`, so that the frequency bound of the time step is lost. So the nodes are tied
//! where they are.

use super::blocks::Blocks;
use super::incidence::starts_of;
use super::mesh::{Mesh, Tie};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

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

/// Why a tie of a mesh does not act.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, thiserror::Error)]
pub enum LeftOut {
    /// The node cannot move.
    #[error("held by a support")]
    Held,
    /// The node carries tied nodes itself.
    #[error("carrying other tied nodes")]
    Master,
    /// The node has a tie already.
    #[error("tied already")]
    Twice,
    /// There is nothing to follow.
    #[error("without masters")]
    Empty,
}

/// Why each tie of a mesh does not act; `None`: it does.
pub fn left_out(mesh: &Mesh) -> Vec<Option<LeftOut>> {
    let [mut held, mut carries, mut tied] = [(); 3].map(|()| vec![false; mesh.nodes.len()]);
    mesh.fixed.iter().for_each(|n| held[*n] = true);
    mesh.ties.iter().flat_map(|t| &t.masters).for_each(|(m, _)| carries[*m] = true);
    let why = |tie: &Tie| {
        let reason = if held[tie.node] {
            LeftOut::Held
        } else if carries[tie.node] {
            LeftOut::Master
        } else if tied[tie.node] {
            LeftOut::Twice
        } else if tie.masters.is_empty() {
            LeftOut::Empty
        } else {
            tied[tie.node] = true;
            return None;
        };
        Some(reason)
    };
    mesh.ties.iter().map(why).collect()
}

/// One line for each reason for which ties do not act, with their number and the first node.
pub fn left_out_notes(mesh: &Mesh) -> Vec<String> {
    let mut groups: BTreeMap<LeftOut, Vec<usize>> = BTreeMap::new();
    for (tie, reason) in mesh.ties.iter().zip(left_out(mesh)) {
        groups
            .entry(match reason {
                Some(r) => r,
                None => continue,
            })
            .or_default()
            .push(tie.node);
    }
    let line = |(reason, nodes): (LeftOut, Vec<usize>)| {
        let [x, y, z] = mesh.nodes[nodes[0]];
        format!(
            "{} {} not tied: {reason}; the first is node {} at ({x:.3}, {y:.3}, {z:.3}) m",
            nodes.len(),
            if nodes.len() == 1 { "node is" } else { "nodes are" },
            nodes[0]
        )
    };
    groups.into_iter().map(line).collect()
}

impl Ties {
    /// The ties of a mesh that can act, see [`left_out`].
    pub fn of(mesh: &Mesh) -> Self {
        if mesh.ties.is_empty() {
            return Self::default();
        }
        let n = mesh.nodes.len();
        let mut this = Self { of_node: vec![FREE; n], ..Self::default() };
        for (tie, _) in mesh.ties.iter().zip(left_out(mesh)).filter(|(_, reason)| reason.is_none()) {
            this.of_node[tie.node] = this.list.len() as u32;
            this.list.push(tie.clone());
        }
        this.given_kg = vec![Some(0.0); this.list.len()];
        let mut by_master: Vec<(u32, u32, f64)> = Vec::new();
        for tie in &this.list {
            by_master.extend(tie.masters.iter().map(|(m, w)| (*m as u32, tie.node as u32, *w)));
        }
        by_master.sort_by_key(|(m, s, _)| (*m, *s));
        this.starts = starts_of(n, by_master.iter().map(|m| m.0 as usize));
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
