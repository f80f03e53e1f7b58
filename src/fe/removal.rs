//! Charges of a building: which elements they remove, when, and what leaves with them.
//!
//! A removal over time leaves the forces that the elements exerted on the rest of the structure, which fall linearly to zero, as in alternate path analyses that replace a column by its end forces. The elements themselves are gone
//! from the start: with their stiffness a column would be pressed harder as its share falls and shed its load at the very end, and without it, under a stress that is kept, it buckles within itself, its nodes gathering speed by
//! `exp(t √(σ/ρ) / L)` with half the length of an element: a factor of 1e20 in 0.3 s under 3 MPa.

use super::dynamics::{Death, Dynamics};
use super::mesh::Mesh;
use super::recorder::Recorder;
use super::result::ElementDeath;
use super::split::Split;
use crate::building::{Building, Charge, Member, MemberKind};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

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
    /// `(time, elements)` not yet begun.
    pending: Vec<(f64, Vec<usize>)>,
    fading: Vec<Fading>,
}

/// Forces that removed elements leave for a while.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Fading {
    /// When they began to fall \[s\].
    start_s: f64,
    /// Nodes of what stays, and the forces on them at that time \[N\].
    forces_n: Vec<(usize, [f64; 3])>,
}

impl Removal {
    pub(super) fn new(building: &Building, mesh: &Mesh) -> Self {
        let pending = building.events.iter().map(|c| (c.time_s, hit(building, mesh, c))).collect();
        Self { pending, fading: Vec::new() }
    }

    /// Whether each of so many elements is to be removed.
    pub(super) fn removes(&self, elements: usize) -> Vec<bool> {
        let mut removes = vec![false; elements];
        self.pending.iter().flat_map(|(_, hit)| hit).for_each(|e| removes[*e] = true);
        removes
    }

    /// Takes away the elements whose time has come, and sets the forces that those leave which went less than `duration_s` ago.
    pub(super) fn apply(
        &mut self,
        mesh: &Mesh,
        body: &mut Dynamics,
        duration_s: f64,
        recorder: &mut Recorder,
    ) {
        let now = body.time_s;
        let due: Vec<(f64, Vec<usize>)> = self.pending.extract_if(.., |charge| now >= charge.0).collect();
        let mut gone = Vec::new();
        for (start_s, elements) in due {
            let own: Vec<usize> = elements.into_iter().filter(|e| body.blocks.share(*e) > 0.0).collect();
            if duration_s > 0.0 {
                self.fading.push(Fading { start_s, forces_n: forces_of(body, &own) });
            }
            own.iter().for_each(|e| body.blocks.set_share(*e, 0.0));
            gone.extend(own);
        }
        if !gone.is_empty() {
            take_away(mesh, body, recorder, &gone, duration_s);
        }
        self.fade(body, duration_s);
    }

    /// Sets the forces of the present time.
    fn fade(&mut self, body: &mut Dynamics, duration_s: f64) {
        for (n, _) in self.fading.iter().flat_map(|f| &f.forces_n) {
            body.applied_n[*n] = [0.0; 3];
        }
        let now = body.time_s;
        self.fading.retain(|f| now < f.start_s + duration_s);
        for fading in &self.fading {
            let share = 1.0 - (now - fading.start_s) / duration_s;
            for (n, force_n) in &fading.forces_n {
                // nothing pushes debris
                if body.blocks.elements_at(*n).any(|e| body.blocks.share(e) > 0.0) {
                    for i in 0..3 {
                        body.applied_n[*n][i] += share * force_n[i];
                    }
                }
            }
        }
    }

    /// Shares forces out among nodes that were copied, by their masses.
    pub(super) fn follow(&mut self, splits: &[Split], body: &Dynamics) {
        for [old, new] in splits.iter().flat_map(|s| &s.copies) {
            let part = body.mass_kg[*new] / (body.mass_kg[*old] + body.mass_kg[*new]);
            for fading in &mut self.fading {
                let Some(own) = fading.forces_n.iter_mut().find(|(n, _)| n == old) else { continue };
                let copied = own.1.map(|f| part * f);
                own.1 = own.1.map(|f| (1.0 - part) * f);
                fading.forces_n.push((*new, copied));
            }
        }
    }
}

/// Forces of elements on the nodes that others share, and on the masters of those that are tied, less what they bore of the weight of their own mass there, which goes with them \[N\].
fn forces_of(body: &Dynamics, elements: &[usize]) -> Vec<(usize, [f64; 3])> {
    let own: BTreeSet<usize> = elements.iter().copied().collect();
    let mut sums = BTreeMap::<usize, [f64; 3]>::new();
    for (e, internal_n) in body.blocks.element_forces(elements, &body.x) {
        let weight_n = body.acceleration_m_s2.map(|a| body.blocks.mass_kg(e) / 8.0 * a);
        for (n, force_n) in body.blocks.nodes_of(e).into_iter().zip(internal_n) {
            for (carrier, share) in body.ties.carriers(n) {
                let sum = sums.entry(carrier).or_default();
                (0..3).for_each(|i| sum[i] += share * (weight_n[i] - force_n[i]));
            }
        }
    }
    let stays =
        |n: &usize| body.blocks.elements_at(*n).any(|e| body.blocks.share(e) > 0.0 && !own.contains(&e));
    sums.into_iter().filter(|(n, _)| stays(n)).collect()
}

/// Takes elements that no longer act out of contact and masses.
fn take_away(mesh: &Mesh, body: &mut Dynamics, recorder: &mut Recorder, elements: &[usize], duration_s: f64) {
    let time_s = body.time_s;
    for e in elements {
        if let Some(contact) = &mut body.body_contact {
            contact.end_element(*e);
        }
        recorder.deaths.push(ElementDeath { element: *e, time_s, cause: Death::Removed });
        recorder.removed[*e] = true;
    }
    let before = body.kinetic_j();
    body.assemble_mass(mesh, |e| !recorder.removed[e]);
    recorder.removed_j += body.kinetic_j() - before;
    if let Some(mut hybrid) = body.hybrid.take() {
        hybrid.fire(body, duration_s);
        body.hybrid = Some(hybrid);
    }
}
