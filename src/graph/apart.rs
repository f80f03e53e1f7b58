//! Buildings that stand beside each other: one without an equilibrium takes nothing from the others.
//!
//! What belongs together is told by the contacts of all members, those too that charges take: a storey below charged
//! columns bears what falls on it, so that forces without that would mean nothing.

use super::frame::{Frame, FrameError, FrameSolution, SectionForces};
use super::structure::Structure;
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// The static solution of those buildings of a frame that are in equilibrium.
pub(super) struct Apart {
    /// Forces and motions, zero where there is no equilibrium.
    pub solution: FrameSolution,
    /// For each element whether its building is in equilibrium.
    pub held: Vec<bool>,
    /// Members of the other buildings that can move freely.
    pub free: Vec<String>,
}

/// The equilibrium of all buildings together, or of each by itself if they have none together. An error if none has one.
pub(super) fn solve(structure: &Structure, frame: &Frame) -> Result<Apart, FrameError> {
    let count = frame.elements.len();
    let together = match frame.solve() {
        Err(FrameError::Mechanism(mechanism)) => mechanism,
        other => {
            return other.map(|solution| Apart { solution, held: vec![true; count], free: Vec::new() });
        }
    };
    let solution = FrameSolution {
        displacement: vec![[0.0; 6]; frame.nodes.len()],
        forces: vec![[SectionForces::default(); 2]; count],
        reactions: Vec::new(),
        unknowns: 0,
    };
    let mut found = Apart { solution, held: vec![false; count], free: Vec::new() };
    let buildings = buildings(structure, frame);
    // one alone has been tried
    for elements in buildings.iter().filter(|_| buildings.len() > 1) {
        match frame.part(elements).solve() {
            Ok(own) => found.add(frame, elements, own),
            Err(FrameError::Mechanism(mechanism)) => found.free.extend(mechanism.members),
            Err(failed) => return Err(failed),
        }
    }
    if found.held.contains(&true) { Ok(found) } else { Err(FrameError::Mechanism(together)) }
}

/// Elements of each building.
fn buildings(structure: &Structure, frame: &Frame) -> Vec<Vec<usize>> {
    let mut sets = UnionFind::new(structure.members().count());
    for connection in structure.connections() {
        sets.union(connection.members[0], connection.members[1]);
    }
    let of: BTreeMap<&str, usize> =
        structure.members().map(|m| (m.id.as_str(), sets.find(m.index))).collect();
    let mut found: BTreeMap<Option<usize>, Vec<usize>> = BTreeMap::new();
    for (index, element) in frame.elements.iter().enumerate() {
        found.entry(of.get(element.member.as_str()).copied()).or_default().push(index);
    }
    found.into_values().collect()
}

impl Apart {
    /// Adds the solution of a building.
    fn add(&mut self, frame: &Frame, elements: &[usize], own: FrameSolution) {
        let nodes: BTreeSet<usize> = elements.iter().flat_map(|e| frame.elements[*e].nodes).collect();
        let all = &mut self.solution;
        nodes.iter().for_each(|n| all.displacement[*n] = own.displacement[*n]);
        for (element, forces) in elements.iter().zip(own.forces) {
            all.forces[*element] = forces;
            self.held[*element] = true;
        }
        all.reactions.extend(own.reactions.into_iter().filter(|(n, _)| nodes.contains(n)));
        all.unknowns += own.unknowns;
    }

    /// Weight on buildings without an equilibrium \[N\].
    pub fn free_weight_n(&self, frame: &Frame) -> f64 {
        let free = || frame.elements.iter().zip(&self.held).filter(|(_, held)| !**held).map(|(e, _)| e);
        let nodes: BTreeSet<usize> = free().flat_map(|e| e.nodes).collect();
        let on_nodes: f64 = nodes.iter().map(|n| frame.nodes[*n].load[2]).sum();
        let on_elements: f64 = free()
            .flat_map(|e| {
                e.loads.iter().map(|l| (l.stretch[1] - l.stretch[0]) * l.force_n_m[2] * e.length_m())
            })
            .sum();
        -on_nodes - on_elements
    }
}
