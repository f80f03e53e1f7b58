//! Detaching an element instead of deleting it.
//!
//! The element gets its own copy of every node that it shares with an acting neighbour. The copy starts with the position and velocity of
//! the node and takes the element's share of its mass and of its applied force (an eighth of the element's mass), so that mass, momentum
//! and kinetic energy stay what they were; a copy of a held node is held. The element keeps its bulk stiffness and
//! [`DEBRIS_STRENGTH`] of its yield stress: rubble that bears the pressure of a heap and holds its shape under its own weight, but no bending of the
//! structure. It no longer erodes by strain, only when its time step collapses.
//!
//! Limits: an element once detached exerts forces on others only through contact of the body with itself; without that, debris and
//! structure pass through each other. Bars and ties stay with the old nodes.

use super::dynamics::Dynamics;
use super::mesh::Mesh;
use serde::{Deserialize, Serialize};

/// Share of the yield stress that a block of debris keeps: some 0.5 MPa for concrete, fifty times the pressure of an element's own weight.
pub const DEBRIS_STRENGTH: f64 = 0.05;

/// An element that was detached.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Split {
    /// Element index.
    pub element: usize,
    /// `[old, new]` of each node that was copied.
    pub copies: Vec<[usize; 2]>,
}

/// Detaches an element. The scatter map is to be rebuilt afterwards ([`super::blocks::Blocks::connect`]).
pub(super) fn split(body: &mut Dynamics, element: usize) -> Split {
    let share_kg = body.blocks.mass_kg(element) / 8.0;
    let mut copies = Vec::new();
    for n in body.blocks.nodes_of(element) {
        // the list still shows the elements before the splits of this step: ask their own nodes
        let shared = body
            .blocks
            .elements_at(n)
            .any(|e| e != element && body.blocks.share(e) > 0.0 && body.blocks.nodes_of(e).contains(&n));
        if shared {
            copies.push([n, copy_node(body, n, share_kg)]);
        }
    }
    body.blocks.detach(element, &copies, DEBRIS_STRENGTH);
    Split { element, copies }
}

/// Appends a copy of a node that takes over a part of its mass.
fn copy_node(body: &mut Dynamics, n: usize, mass_kg: f64) -> usize {
    let part = mass_kg / body.mass_kg[n];
    let applied = body.applied_n[n].map(|f| part * f);
    body.x.push(body.x[n]);
    body.v.push(body.v[n]);
    body.mass_kg[n] -= mass_kg;
    body.mass_kg.push(mass_kg);
    body.applied_n.push_copy(n);
    let new = body.x.len() - 1;
    if body.applied_n.is_set(n) {
        body.applied_n[new] = applied;
        for i in 0..3 {
            body.applied_n[n][i] -= applied[i];
        }
    }
    body.prescribed_m_s.push_copy(n);
    if !body.other_n.is_empty() {
        body.other_n.push([0.0; 3]);
    }
    body.surfaces.add_copy_of(n);
    body.x.len() - 1
}

/// Follows splits in the mesh: new nodes with the reference positions of the old ones, and the elements' own nodes.
pub fn follow(mesh: &mut Mesh, splits: &[Split]) {
    for split in splits {
        for [old, new] in &split.copies {
            debug_assert_eq!(*new, mesh.nodes.len(), "splits are followed in their order");
            mesh.nodes.push(mesh.nodes[*old]);
            for n in &mut mesh.elements[split.element].nodes {
                if n == old {
                    *n = *new;
                }
            }
        }
    }
}
