//! Floors in pieces: cells between the lines at which a floor may fold, and the hinges on these lines.
//!
//! The lines run through a whole floor, at the ends of its beams for which a rule asks for latent hinges. What lies in a cell between them is one
//! body; neighbouring cells are joined by a hinge with the resistance of the strip of floor that crosses the line there. A hinge is as long as a beam is deep, so that the bodies
//! meet that far from the line: bodies of the size of a joint block would be so light beside the stiffness of their columns that steps had to be six times shorter.

use super::GenerateError;
use super::cells::{Cells, Piece, neighbours};
use super::decide::Decision;
use super::joints::{Place, axes};
use crate::building::ends::{MemberEnd, SAME_LINE_M};
use crate::building::{Building, MemberKind};
use crate::graph::Structure;
use crate::library::Entry;
use crate::library::derive_strip::WantedStrip;
use crate::mbs::model::{Bending, Body, Bushing, Origin};
use crate::rc::StripPlace;
use std::collections::BTreeSet;

/// Most pieces of a floor: what latent hinges bear is found with a dense matrix.
const MOST_PIECES: usize = 64;
/// Largest distance from a line at which its pieces meet, of the clear span of the beam.
const MOST_OF_SPAN: f64 = 0.2;
/// How far a strip is kept on the side that holds it, in depths of the beams: as far as the submodel of a column end.
const REACH_DEPTHS: f64 = 2.5;

/// The grid of a floor.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Members of the floor.
    pub members: Vec<usize>,
    /// Lines along x and y, without the edges.
    lines: [Vec<Fold>; 2],
    /// Edges of the floor \[m\].
    edges: [[f64; 2]; 2],
    /// Deepest beam \[m\].
    depth_m: f64,
}

/// A line at which a floor may fold.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Fold {
    /// Where the beams end \[m\].
    at_m: f64,
    /// +1 if they extend towards larger coordinates.
    outward: f64,
    /// Where the pieces meet \[m\].
    parts_m: f64,
}

/// A hinge on a line of a floor.
#[derive(Debug, Clone)]
pub struct Line {
    /// Name of the hinge: that of the beam end at which it stands, else of the pieces.
    pub id: String,
    /// Pieces on its held and its bent side.
    pieces: [usize; 2],
    /// The line, across the whole floor.
    section: String,
    /// The rules that asked for hinges on it.
    rules: Vec<String>,
    /// What its entry is computed from.
    pub wanted: WantedStrip,
    outward: f64,
}

impl Grid {
    /// The grid of a floor; none if no rule asks for lines in it, or there would be too many pieces (the number is told).
    pub fn of(
        building: &Building,
        structure: &Structure,
        members: &[usize],
        ends: &[MemberEnd],
        decision: &Decision,
    ) -> Result<Option<Self>, usize> {
        let mut lines = [Vec::new(), Vec::new()];
        let mut depth_m = 0.0_f64;
        for end in ends.iter().filter(|e| e.axis < 2 && members.contains(&e.member)) {
            if decision.latent.contains_key(&end.id) {
                let deep = building.members[end.member].solid.size()[2];
                let (at_m, length) = (end.point_m[end.axis], deep.min(MOST_OF_SPAN * end.clear_m));
                lines[end.axis].push(Fold {
                    at_m,
                    outward: end.outward,
                    parts_m: at_m + end.outward * length,
                });
                depth_m = depth_m.max(deep);
            }
        }
        if lines.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        for own in &mut lines {
            own.sort_by(|a, b| a.at_m.total_cmp(&b.at_m).then(a.parts_m.total_cmp(&b.parts_m)));
            own.dedup_by(|b, a| b.at_m - a.at_m < SAME_LINE_M && a.outward == b.outward);
        }
        let pieces = (lines[0].len() + 1) * (lines[1].len() + 1);
        if pieces > MOST_PIECES {
            return Err(pieces);
        }
        let edges = Cells::edges(structure, members);
        Ok(Some(Self { members: members.to_vec(), lines, edges, depth_m }))
    }

    /// Lower and upper bound of a cell along x or y \[m\].
    fn bounds(&self, axis: usize, k: usize) -> [f64; 2] {
        let lines = &self.lines[axis];
        let low = if k == 0 { self.edges[axis][0] } else { lines[k - 1].parts_m };
        [low, lines.get(k).map_or(self.edges[axis][1], |line| line.parts_m)]
    }

    /// Its cells.
    pub fn cells(&self) -> Cells {
        let bounds = [0, 1].map(|axis| (0..=self.lines[axis].len()).map(|k| self.bounds(axis, k)).collect());
        Cells { members: self.members.clone(), bounds }
    }

    /// The hinges between neighbouring pieces.
    pub fn lines(
        &self,
        place: &Place,
        pieces: &[Piece],
        ends: &[MemberEnd],
        names: &[String],
        decision: &Decision,
    ) -> Vec<Line> {
        let mut list = Vec::new();
        for (axis, a, b) in neighbours(pieces) {
            let cell = pieces[a].cell;
            let k = cell[axis];
            let Fold { at_m, outward, .. } = self.lines[axis][k];
            let lengths = [at_m - self.bounds(axis, k)[0], self.bounds(axis, k + 1)[1] - at_m];
            let (held, bent) = if outward > 0.0 { (a, b) } else { (b, a) };
            let [near, far] = if outward > 0.0 { lengths } else { [lengths[1], lengths[0]] };
            let across_m = self.bounds(1 - axis, cell[1 - axis]);
            let strip = StripPlace {
                axis,
                at_m,
                outward,
                near_m: near.min(REACH_DEPTHS * self.depth_m),
                far_m: 0.5 * far,
                across_m,
            };
            let Some(wanted) = WantedStrip::of(place.building, place.mesh, &self.members, &strip) else {
                continue;
            };
            let on_line = |e: &&MemberEnd| {
                let near = (e.point_m[axis] - at_m).abs() < SAME_LINE_M;
                e.axis == axis && self.members.contains(&e.member) && near
            };
            let inside = |e: &&MemberEnd| {
                let p = e.point_m[1 - axis];
                p > across_m[0] && p < across_m[1]
            };
            let beam = ends.iter().filter(on_line).find(inside);
            let asked = ends.iter().filter(on_line).filter_map(|e| decision.latent.get(&e.id));
            let rules: BTreeSet<&String> = asked.flatten().collect();
            let rules = rules.into_iter().cloned().collect();
            let id = beam.map_or_else(|| format!("{}|{}", names[held], names[bent]), |e| e.id.clone());
            let floor = names[a].split('/').next().unwrap_or_default();
            let section = format!("{floor}/{}{}", ["x", "y"][axis], k + 1);
            list.push(Line { id, pieces: [held, bent], section, rules, wanted, outward });
        }
        list
    }
}

impl Line {
    /// The latent hinge on the line, between bodies of which the pieces of its floor begin at some place in the list.
    pub fn bushing(
        &self,
        bodies: &[Body],
        first: usize,
        entry: &Entry,
        curve: String,
        building: &Building,
    ) -> Result<Bushing, GenerateError> {
        let model = &self.wanted.model;
        let (stiffness, offset_m) = entry.line()?;
        let axis = model.axis;
        let [held, bent] = self.pieces.map(|p| bodies[first + p].id.clone());
        let mut point_m = model.point_m;
        point_m[axis] += self.outward * offset_m;
        // in its plane a floor is a deep beam: elastic
        let width = if axis == 0 { model.section_m[0] } else { model.section_m[1] };
        let law = &model.mesh.laws[model.mesh.elements[model.section_elements[0]].law];
        let in_plane = 3.0 * law.youngs_modulus_pa * model.area_m2 * width * width / 12.0 / model.length_m;
        let folds = Bending::Curve { curve, strength_factor: 1.0 };
        let stiff = Bending::Elastic { stiffness_nm_rad: in_plane };
        Ok(Bushing {
            axial_stiffness_n_m: stiffness.axial_n_m,
            shear_stiffness_n_m: stiffness.shear_n_m,
            torsional_stiffness_nm_rad: stiffness.torsion_nm_rad,
            bending: if axis == 0 { [folds, stiff] } else { [stiff, folds] },
            latent: Some(self.section.clone()),
            tensile_capacity_n: entry.tensile_capacity_n,
            tensile_elongation_m: entry.tensile_elongation_m,
            compressive_capacity_n: entry.compressive_capacity_n,
            origin: Origin {
                members: model_members(building, model, &self.id),
                rules: self.rules.clone(),
                entries: vec![entry.key.clone()],
            },
            ..Bushing::free(self.id.clone(), Some(held), bent, point_m, axes(axis, self.outward))
        })
    }
}

/// The beam end that a hinge stands at, or the slabs in its section.
fn model_members(building: &Building, model: &crate::rc::EndModel, id: &str) -> Vec<String> {
    if id.contains('.') {
        return vec![id.to_string()];
    }
    let mut parts: Vec<usize> = model.section_elements.iter().map(|e| model.mesh.elements[*e].part).collect();
    parts.sort_unstable();
    parts.dedup();
    let slab = |m: &usize| building.members[*m].kind == MemberKind::Slab;
    let slabs: Vec<usize> = parts.iter().copied().filter(slab).collect();
    let shown = if slabs.is_empty() { parts } else { slabs };
    shown.into_iter().map(|m| building.members[m].id.clone()).collect()
}
