//! Charges of a building: which elements they remove, when, and what leaves with them.

use super::dynamics::{Death, Dynamics};
use super::mesh::Mesh;
use super::recorder::Recorder;
use super::result::ElementDeath;
use crate::building::{Building, Charge, Member, MemberKind};
use serde::{Deserialize, Serialize};

/// Elements that a charge removes: those of its member, of a stretch those with their centre on it. The joint blocks over columns, which belong to a beam in the mesh, stay unless a stretch
/// takes them in: what stands on them does not lose its support by a beam.
pub fn hit(building: &Building, mesh: &Mesh, charge: &Charge) -> Vec<usize> {
    let Some(part) = building.members.iter().position(|m| m.id == charge.member) else { return Vec::new() };
    let member = &building.members[part];
    let columns: Vec<&Member> = match member.kind {
        MemberKind::Beam => building.members.iter().filter(|m| m.kind == MemberKind::Column).collect(),
        _ => Vec::new(),
    };
    let on_stretch = |e: &usize| {
        let center = mesh.center(*e);
        match charge.stretch_m {
            Some([from, to]) => (from..=to).contains(&member.along_m(center)),
            None => !columns.iter().any(|c| c.solid.contains(center, 0.0)),
        }
    };
    (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part == part).filter(on_stretch).collect()
}

/// Charges: which elements go when.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Removal {
    /// `(time, elements)` not yet finished.
    pending: Vec<(f64, Vec<usize>)>,
    /// Elements whose removal has begun.
    begun: Vec<bool>,
}

impl Removal {
    pub(super) fn new(building: &Building, mesh: &Mesh) -> Self {
        let pending = building.events.iter().map(|c| (c.time_s, hit(building, mesh, c))).collect();
        Self { pending, begun: vec![false; mesh.elements.len()] }
    }

    /// Whether each of so many elements is to be removed.
    pub(super) fn removes(&self, elements: usize) -> Vec<bool> {
        let mut removes = vec![false; elements];
        self.pending.iter().flat_map(|(_, hit)| hit).for_each(|e| removes[*e] = true);
        removes
    }

    /// Lowers the acting share of elements under removal; at the end takes their mass away. Their stress is frozen first: a column that kept
    /// its stiffness would be pressed harder as its share falls, and shed its load within a small part of the duration at the very end.
    pub(super) fn apply(
        &mut self,
        mesh: &Mesh,
        body: &mut Dynamics,
        duration_s: f64,
        recorder: &mut Recorder,
    ) {
        let now = body.time_s;
        let mut finished = Vec::new();
        self.pending.retain(|(start, elements)| {
            if now < *start {
                return true;
            }
            let share = if duration_s > 0.0 { 1.0 - (now - start) / duration_s } else { 0.0 };
            for e in elements {
                if body.blocks.share(*e) == 0.0 {
                    continue;
                }
                if !std::mem::replace(&mut self.begun[*e], true) {
                    body.blocks.soften(*e);
                }
                body.blocks.set_share(*e, share.max(0.0));
                if share <= 0.0 {
                    if let Some(contact) = &mut body.body_contact {
                        contact.end_element(*e);
                    }
                    finished.push(*e);
                }
            }
            share > 0.0
        });
        if finished.is_empty() {
            return;
        }
        for e in &finished {
            recorder.deaths.push(ElementDeath { element: *e, time_s: now, cause: Death::Removed });
            recorder.removed[*e] = true;
        }
        let before = body.kinetic_j();
        body.assemble_mass(mesh, |e| !recorder.removed[e]);
        recorder.removed_j += body.kinetic_j() - before;
        if let Some(mut hybrid) = body.hybrid.take() {
            hybrid.renew(body);
            body.hybrid = Some(hybrid);
        }
    }
}
