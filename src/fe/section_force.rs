//! What the sections of columns, beams and walls bear just before they break.
//!
//! A section is a layer of elements across a member. What it bears is the sum of the internal forces `∫ Bᵀ σ dV` of its elements at the nodes of their upper faces; the
//! lower faces have the same with the other sign. The moment is taken about the middle of the layer, along its own axis as it is then. Discrete bars are not in it: buildings have none.

use super::blocks::Blocks;
use super::mesh::Mesh;
use crate::base::vector::V3;
use crate::building::{Building, MemberKind};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Nodes of an element on its face towards larger coordinates along each axis ([`Mesh::of`]).
const UPPER: [[usize; 4]; 3] = [[1, 2, 5, 6], [2, 3, 6, 7], [4, 5, 6, 7]];

/// Force and moment in a section, in its own axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SectionForce {
    /// Along the member, tension positive \[N\].
    pub axial_n: f64,
    /// Across it \[N\].
    pub shear_n: f64,
    /// Bending moment \[N m\].
    pub bending_nm: f64,
    /// Twisting moment \[N m\].
    pub twisting_nm: f64,
}

impl SectionForce {
    /// In whole N and N m.
    pub fn rounded(self) -> Self {
        Self {
            axial_n: self.axial_n.round(),
            shear_n: self.shear_n.round(),
            bending_nm: self.bending_nm.round(),
            twisting_nm: self.twisting_nm.round(),
        }
    }
}

/// A section of which elements have failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BrokenSection {
    /// All its elements.
    pub elements: Vec<usize>,
    /// What it bore at the last output before the first of them failed.
    pub force: SectionForce,
    /// That output \[s\].
    pub time_s: f64,
}

/// The sections of a model, until they break.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Sections {
    whole: Vec<Section>,
    pub broken: Vec<BrokenSection>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
struct Section {
    axis: usize,
    elements: Vec<usize>,
    /// What it bore at the last output, and when.
    last: Option<(SectionForce, f64)>,
}

impl Sections {
    pub fn of(building: &Building, mesh: &Mesh) -> Self {
        let mut layers = BTreeMap::<(usize, i64), Vec<usize>>::new();
        for (element, part) in mesh.elements.iter().map(|e| e.part).enumerate() {
            if let Some(axis) = axis_of(building, part) {
                let micrometres = (1e6 * mesh.center(element)[axis]).round() as i64;
                layers.entry((part, micrometres)).or_default().push(element);
            }
        }
        let section =
            |((part, _), elements)| Some(Section { axis: axis_of(building, part)?, elements, last: None });
        Self { whole: layers.into_iter().filter_map(section).collect(), broken: Vec::new() }
    }

    /// What the sections bear at an output; those of which an element has failed since the one before have broken, those of which charges took one are no longer looked at.
    pub fn look(&mut self, blocks: &Blocks, removed: &[bool], x: &[V3], time_s: f64) {
        let broken = &mut self.broken;
        self.whole.retain_mut(|section| {
            let lives = |e: &usize| blocks.share(*e) > 0.0 && !blocks.is_detached(*e);
            if section.elements.iter().all(lives) {
                return true;
            }
            let is_taken = section.elements.iter().any(|e| removed[*e]);
            if let Some((force, time_s)) = section.last.filter(|_| !is_taken) {
                broken.push(BrokenSection { elements: std::mem::take(&mut section.elements), force, time_s });
            }
            false
        });
        let mut forces = vec![None; blocks.elements()];
        let wanted: Vec<usize> = self.whole.iter().flat_map(|s| &s.elements).copied().collect();
        for (element, force_n) in blocks.element_forces(&wanted, x) {
            forces[element] = Some(force_n);
        }
        for section in &mut self.whole {
            let of = |e: &usize| Some((blocks.nodes_of(*e), forces[*e]?));
            let parts: Vec<_> = section.elements.iter().filter_map(of).collect();
            section.last = resultant(&parts, section.axis, x).map(|force| (force, time_s));
        }
    }
}

/// Axis of a member whose sections are looked at.
fn axis_of(building: &Building, part: usize) -> Option<usize> {
    let member = &building.members[part];
    match member.kind {
        _ if member.is_skew() => None,
        MemberKind::Column | MemberKind::Beam => Some(member.axis),
        MemberKind::Wall => Some(2),
        MemberKind::Slab | MemberKind::Footing | MemberKind::Brace => None,
    }
}

/// Resultant of elements with their nodes and the forces on these \[N\].
fn resultant(parts: &[([usize; 8], [V3; 8])], axis: usize, x: &[V3]) -> Option<SectionForce> {
    use nalgebra::Vector3;
    let at = |n: usize| Vector3::from(x[n]);
    let mean = |of: &dyn Fn(usize) -> bool| {
        let nodes = parts.iter().flat_map(|(nodes, _)| (0..8).filter(|i| of(*i)).map(|i| at(nodes[i])));
        nodes.sum::<Vector3<f64>>() / (4 * parts.len()) as f64
    };
    let is_upper = |i: usize| UPPER[axis].contains(&i);
    let (upper, lower) = (mean(&is_upper), mean(&|i| !is_upper(i)));
    let along = (upper - lower).try_normalize(0.0)?;
    let middle = 0.5 * (upper + lower);
    let (mut force, mut moment) = (Vector3::zeros(), Vector3::zeros());
    for (nodes, forces) in parts {
        for i in UPPER[axis] {
            let own = Vector3::from(forces[i]);
            force += own;
            moment += (at(nodes[i]) - middle).cross(&own);
        }
    }
    let (axial_n, twisting_nm) = (force.dot(&along), moment.dot(&along));
    Some(SectionForce {
        axial_n,
        shear_n: (force - axial_n * along).norm(),
        bending_nm: (moment - twisting_nm * along).norm(),
        twisting_nm: twisting_nm.abs(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::tree::Format;
    use crate::building;
    use crate::fe::contact::RigidSurfaces;
    use crate::fe::dynamics::Dynamics;
    use crate::fe::hexahedron::UNIT_CUBE;
    use crate::fe::relaxation::static_state;

    /// What a cube along an axis bears, with forces on the nodes of its upper face and the opposite ones on those of its lower face.
    fn bears(axis: usize, force: impl Fn(V3) -> V3) -> SectionForce {
        let mut forces = [[0.0; 3]; 8];
        for (i, at) in UNIT_CUBE.iter().enumerate() {
            let sign = if UPPER[axis].contains(&i) { 1.0 } else { -1.0 };
            forces[i] = force(*at).map(|f| sign * f);
        }
        resultant(&[(std::array::from_fn(|i| i), forces)], axis, &UNIT_CUBE).unwrap()
    }

    #[test]
    fn feet_of_columns_bear_the_weight_above_them() {
        let building = building::parse(building::EXAMPLE, Format::Toml, "example.toml").unwrap();
        let (mesh, _) = Mesh::of(&building, building.settings.mesh_size_m);
        let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
        static_state(&mesh, &mut body).unwrap();
        let mut sections = Sections::of(&building, &mesh);
        let removed = vec![false; mesh.elements.len()];
        sections.look(&body.blocks, &removed, &body.x, 0.0);
        let lowest =
            |s: &&Section| mesh.nodes[mesh.elements[s.elements[0]].nodes[0]][2] < 1e-6 && s.axis == 2;
        let feet: Vec<&Section> = sections.whole.iter().filter(lowest).collect();
        assert_eq!(feet.len(), 4);
        let top_m = mesh.nodes[mesh.elements[feet[0].elements[0]].nodes[4]][2];
        let above = (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][2] > top_m - 1e-6);
        let weight_n = 9.81 * above.map(|n| body.mass_kg[n]).sum::<f64>();
        let borne_n: f64 = feet.iter().map(|s| s.last.unwrap().0.axial_n).sum();
        assert!((borne_n / -weight_n - 1.0).abs() < 1e-4, "{borne_n} {weight_n}");
    }

    #[test]
    fn sections_bear_tension_moments_and_shear() {
        for axis in 0..3 {
            let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
            let along = |f: f64, i: usize| {
                let mut force = [0.0; 3];
                force[i] = f;
                force
            };
            let tension = bears(axis, |_| along(2.0, axis));
            let pull = SectionForce { axial_n: 8.0, shear_n: 0.0, bending_nm: 0.0, twisting_nm: 0.0 };
            assert_eq!(tension, pull);
            // a couple of 4 N at both edges, half a metre off the axis
            let bent = bears(axis, |at| along(4.0 * (at[b] - 0.5), axis));
            assert!((bent.bending_nm - 4.0).abs() < 1e-12 && bent.axial_n.abs() < 1e-12, "{bent:?}");
            // shear alone has no moment about the middle but that of half its lever
            let sheared = bears(axis, |_| along(1.0, c));
            assert!((sheared.shear_n - 4.0).abs() < 1e-12 && (sheared.bending_nm - 2.0).abs() < 1e-12);
            let twisted = bears(axis, |at| along(at[b] - 0.5, c));
            assert!((twisted.twisting_nm - 1.0).abs() < 1e-12 && twisted.shear_n.abs() < 1e-12);
        }
    }
}
