//! Columns that may break between their ends once something has happened to them.
//!
//! What rules say of a member after the first contact is asked beforehand: into how many pieces it is divided, and whether a section between two of them may break. The pieces are one body,
//! joined by latent hinges, which nobody looks at until a rule about contacts or fractures fires for the member ([`super::event_rules`]).

use super::bodies::Bodies;
use super::cells::Piece;
use super::decide::Decision;
use super::joints::{Prism, axes};
use crate::base::geom::Aabb;
use crate::base::piecewise::interpolate;
use crate::building::Building;
use crate::building::tracked::clear_range;
use crate::curve::ResistanceCurve;
use crate::graph::Structure;
use crate::mbs::model::{Bending, Bushing, Origin};
use crate::rc::layers::AT_JOINT;
use crate::rules::{Subject, SubjectKind, features};
use std::collections::BTreeMap;

/// Sections of a member between its pieces.
#[derive(Debug, Clone, PartialEq)]
pub struct Sections {
    /// Number of pieces.
    pub pieces: usize,
    /// Ids of the sections, from the lower end on.
    pub ids: Vec<String>,
}

impl Sections {
    /// Between some pieces of a member.
    pub fn of(member: &str, pieces: usize) -> Self {
        Self { pieces, ids: (1..pieces).map(|k| format!("{member}.section-{k}")).collect() }
    }

    /// What is known of the sections, for rules.
    pub fn subjects(&self, member: &Subject) -> Vec<Subject> {
        let of_section =
            |name: &str| features::find(name).is_some_and(|f| f.subjects.contains(&SubjectKind::Section));
        let mut section = member.clone();
        section.kind = SubjectKind::Section;
        section.features.retain(|name, _| of_section(name));
        let one = |(k, id): (usize, &String)| {
            let own = Subject { id: id.clone(), ..section.clone() };
            own.with("section.position", (k + 1) as f64 / self.pieces as f64)
        };
        self.ids.iter().enumerate().map(one).collect()
    }

    /// The pieces of a member, from its lower end on.
    pub fn cut(&self, building: &Building, structure: &Structure, member: usize) -> Vec<Piece> {
        slice(structure, member, building.members[member].axis, &self.edges(building, structure, member))
    }

    /// Where the pieces begin and end along the member \[m\].
    fn edges(&self, building: &Building, structure: &Structure, member: usize) -> Vec<f64> {
        let clear = clear_range(&structure.partition, member, building.members[member].axis);
        let [from, to] = clear.unwrap_or([f64::INFINITY, f64::NEG_INFINITY]);
        (0..=self.pieces).map(|k| from + (to - from) * k as f64 / self.pieces as f64).collect()
    }
}

/// The pieces of a member between edges along an axis \[m\], from its lower end on.
pub fn slice(structure: &Structure, member: usize, axis: usize, edges: &[f64]) -> Vec<Piece> {
    let piece = |(k, edge): (usize, &[f64])| {
        let mut slice = Aabb { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
        // what the member has beyond its clear length belongs to the pieces at its ends
        if k > 0 {
            slice.min[axis] = edge[0];
        }
        if k + 2 < edges.len() {
            slice.max[axis] = edge[1];
        }
        let boxes = structure.boxes(member).iter().filter_map(|b| b.intersection(&slice, 1e-9));
        Piece { cell: [k, 0], boxes: boxes.map(|b| (member, b)).collect() }
    };
    edges.windows(2).enumerate().map(piece).collect()
}

/// The latent hinges between the pieces of all columns that have such, with their curves. They bear what the lower end of the column bears, less what the joint there lends to it.
pub fn hinges(
    building: &Building,
    structure: &Structure,
    bodies: &Bodies,
    decision: &Decision,
    (ends, curves): (&[Bushing], &mut BTreeMap<String, ResistanceCurve>),
) -> Vec<Bushing> {
    let lower: BTreeMap<&str, &Bushing> = ends.iter().map(|b| (b.id.as_str(), b)).collect();
    let mut list = Vec::new();
    for (member, sections) in decision.sections() {
        let own = bodies.all_of(member);
        let Some(end) = lower.get(format!("{}.bottom", building.members[member].id).as_str()) else {
            continue;
        };
        let stretch = Stretch::of(building, structure, member, sections);
        for (k, id) in sections.ids.iter().enumerate() {
            let [below, above] = [own[k], own[k + 1]].map(|i| bodies.list[i].id.clone());
            let bending = [0, 1].map(|axis| stretch.bending(axis, end, curves));
            let mut point_m = stretch.middle_m;
            point_m[stretch.axis] = stretch.edges[k + 1];
            list.push(stretch.prism.springs(Bushing {
                id: id.clone(),
                body_a: Some(below),
                body_b: above,
                point_m,
                axes: axes(stretch.axis, 1.0),
                bending,
                latent: Some(id.clone()),
                shear_capacity_n: end.tensile_capacity_n.map(shear_capacity),
                shear_slip_m: None,
                carry_over: None,
                origin: Origin {
                    members: vec![id.clone()],
                    rules: decision.fired(id),
                    entries: end.origin.entries.clone(),
                },
                ..(*end).clone()
            }));
        }
    }
    list
}

/// Shear force at which a section tears along an axis, of the force at which it tears in tension \[N\]: a J2 material bears `1/√3` of its tensile stress in pure shear (von Mises 1913), the law of the FE model that the curves come from.
pub fn shear_capacity(tensile_capacity_n: f64) -> [f64; 2] {
    [tensile_capacity_n / 3.0_f64.sqrt(); 2]
}

/// Shear forces at which a section slips that stretches under a tensile capacity \[N\] by an elongation before it tears \[m\], and the slip after which it does: the equivalent plastic strain of a shear `γ` is `γ/√3` (von Mises).
pub fn slip(tensile_capacity_n: Option<f64>, elongation_m: Option<f64>) -> Option<([f64; 2], f64)> {
    Some((shear_capacity(tensile_capacity_n?), 3.0_f64.sqrt() * elongation_m?))
}

/// How many times longer than from the middle of a piece to that of the next one the stretch is that bends at a section: with one time, pieces on springs at both ends need steps 1.3 times as short as the whole column.
pub const SOFTER: f64 = 2.0;

/// The part of a member that a section stands for.
struct Stretch {
    axis: usize,
    edges: Vec<f64>,
    middle_m: [f64; 3],
    prism: Prism,
}

impl Stretch {
    fn of(building: &Building, structure: &Structure, index: usize, sections: &Sections) -> Self {
        let member = &building.members[index];
        let edges = sections.edges(building, structure, index);
        let length_m = SOFTER * (edges[1] - edges[0]);
        Self {
            axis: member.axis,
            middle_m: member.solid.center(),
            prism: Prism::along(building, index, member.axis, length_m),
            edges,
        }
    }

    /// About an axis: the curves of an end, at each axial force over what a joint lends to them.
    fn bending(&self, axis: usize, end: &Bushing, curves: &mut BTreeMap<String, ResistanceCurve>) -> Bending {
        let stiffness_nm_rad = self.prism.bending_nm2(axis) / self.prism.length_m;
        let of_end = end.bending[axis].curve().and_then(|id| Some((id, curves.get(id)?.clone())));
        let Some((id, mut curve)) = of_end else { return Bending::Elastic { stiffness_nm_rad } };
        let id = format!("{id}/free/{stiffness_nm_rad:.6e}");
        curve.stiffness_nm_rad = stiffness_nm_rad;
        let squash_n = end.compressive_capacity_n;
        for level in &mut curve.levels {
            let share = squash_n.map_or(0.0, |squash| level.axial_force_n / squash);
            level.scale(1.0 / interpolate(&AT_JOINT, share));
        }
        curves.insert(id.clone(), curve);
        let strength_factor = match &end.bending[axis] {
            Bending::Curve { strength_factor, .. } => *strength_factor,
            Bending::Elastic { .. } => 1.0,
        };
        Bending::Curve { curve: id, strength_factor }
    }
}
