//! Floors that bend: a piece about each column, and springs between neighbouring pieces in the middle of the span between their columns.
//!
//! A beam of length `L` that is cut in the middle has there, for a moment `M` and a shear force `V`, the rotation `M L / (E I)` and the displacement `V (L³ / (12 E I) + L / (G A_s))`, which is all that its ends
//! can do to each other in a plane (Przemieniecki, Theory of Matrix Structural Analysis, 1968, eq. 5.116, written for the middle): springs of these stiffnesses between rigid halves
//! are the beam, under its weight as well. Its ends yield ([`crate::curve::beam`]) with the resistance of the row of elements beside the column ([`crate::rc::layers`]). The beams are those of the frame of [`crate::graph::idealise`]: beams with their flanges, strips of slab between columns that no beam joins; and what of the slab is in none of them, a plate. Where beams run across its ends the slab bends between their faces, and yields there. A
//! panel whose corner gives way is twisted, and nearly all that holds it is the slab: the springs are on the axes, so that pieces on the axes of a twisted floor meet without a gap. In its own plane a floor is as stiff as its whole section.
//!
//! Where columns are neighbours without a beam between them, the slab bends both ways: then there are pieces in the middle of the spans as well ([`super::axes`]), all of the slab is a plate that bends both ways at once ([`super::panels`]), and the springs are at its height: the flanges of beams at the edges
//! are in their stiffness already. At the finest level of detail all floors have such pieces, those with beams in all spans with springs in the centres of their sections. Left out: yield in the plane of a floor and by torsion.

use super::axes::{FloorAxes, Gap, Kind};
use super::beam_ends::{BeamCut, Ends, YieldingEnds};
use super::beam_joints::BeamJoints;
use super::bodies::Bodies;
use super::cells::{Cells, Piece, by_cell, diagonals, neighbours};
use super::crossing::{Crossing, Cut, InPlane, in_the_middle};
use super::joints::axes;
use super::lines::Lines;
use super::panels::{Given, Panel};
use super::twist;
use super::webs::{Web, share_of};
use super::wish::Accuracy;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, MemberKind};
use crate::graph::Structure;
use crate::graph::frame::{Element, Frame};
use crate::graph::shear_lag::Stretch;
use crate::mbs::model::{Bending, Body, Bushing, Origin, PairRule, Span};
use crate::rc::layers::Held;
use std::collections::{BTreeMap, BTreeSet};

/// A floor in pieces about its columns.
#[derive(Debug, Clone)]
pub struct Grillage {
    axes: FloorAxes,
    /// Its lowest and highest level \[m\].
    levels_m: [f64; 2],
    /// The cells about them.
    pub cells: Cells,
}

impl Grillage {
    /// The pieces of a floor about its columns, removed ones included; none if they are fewer than two.
    pub fn of(
        building: &Building,
        structure: &Structure,
        members: &[usize],
        accuracy: Accuracy,
    ) -> Option<Self> {
        let solids = || members.iter().map(|m| &building.members[*m].solid);
        let low = solids().map(|s| s.min[2]).fold(f64::INFINITY, f64::min);
        let high = solids().map(|s| s.max[2]).fold(f64::NEG_INFINITY, f64::max);
        let edges = Cells::edges(structure, members);
        let axes = FloorAxes::of(building, &edges, [low, high], accuracy == Accuracy::Fine);
        if axes.list[0].len() * axes.list[1].len() < 2 {
            return None;
        }
        let bounds = [0, 1].map(|i| {
            let middles = axes.list[i].windows(2).map(|w| 0.5 * (w[0].at_m + w[1].at_m));
            let mut lines = vec![edges[i][0]];
            lines.extend(middles);
            lines.push(edges[i][1]);
            lines.windows(2).map(|w| [w[0], w[1]]).collect()
        });
        Some(Self { axes, levels_m: [low, high], cells: Cells { members: members.to_vec(), bounds } })
    }

    /// The axes of its columns, and of the middles of its spans.
    pub fn axes(&self) -> &FloorAxes {
        &self.axes
    }

    /// What is clear of a stretch between two axes where beams run along these: over a beam the slab does not bend.
    fn between_beams(&self, building: &Building, axis: usize, across_m: f64, axes_m: [f64; 2]) -> [f64; 2] {
        let members = self.cells.members.iter().map(|m| &building.members[*m]);
        let along = members.filter(|m| m.kind == MemberKind::Beam && m.axis == 1 - axis).map(|m| &m.solid);
        let mut clear_m = axes_m;
        for beam in along.filter(|b| b.min[1 - axis] < across_m && across_m < b.max[1 - axis]) {
            let [low, high] = axes_m.map(|at| beam.min[axis] < at && at < beam.max[axis]);
            clear_m[0] = if low { clear_m[0].max(beam.max[axis]) } else { clear_m[0] };
            clear_m[1] = if high { clear_m[1].min(beam.min[axis]) } else { clear_m[1] };
        }
        if clear_m[0] < clear_m[1] { clear_m } else { axes_m }
    }

    /// The cuts between the pieces on the lines of slabs, and the panels of a slab that bends both ways, which have what they couple of the cuts.
    pub fn layout(
        &self,
        building: &Building,
        frame: &Frame,
        pieces: &[Piece],
        places: &Lines,
    ) -> (Vec<Cut>, Vec<Panel>) {
        let mut cuts = self.cuts(building, frame, pieces);
        cuts.iter_mut().for_each(|cut| places.of_cut(&self.cells.members, cut));
        let panels = if self.axes.kind == Kind::OpenSpans { Panel::all(&cuts) } else { Vec::new() };
        panels.iter().for_each(|p| p.take(&mut cuts));
        if self.axes.kind == Kind::Columns {
            twist::without_joints(&mut cuts);
        }
        (cuts, panels)
    }

    /// The cuts between the pieces, and what bends there.
    fn cuts(&self, building: &Building, frame: &Frame, pieces: &[Piece]) -> Vec<Cut> {
        let kinds: BTreeMap<&str, MemberKind> = self
            .cells
            .members
            .iter()
            .map(|m| &building.members[*m])
            .map(|m| (m.id.as_str(), m.kind))
            .collect();
        let is_plate = |kind: MemberKind| self.axes.kind == Kind::OpenSpans && kind == MemberKind::Slab;
        let beams: Vec<(&Element, MemberKind)> = frame
            .elements
            .iter()
            .filter_map(|e| Some((e, *kinds.get(e.member.as_str())?)))
            .filter(|(_, kind)| !is_plate(*kind))
            .collect();
        let places = by_cell(pieces);
        let joints = BeamJoints::of(building, self.levels_m);
        let between = |(axis, a, b): (usize, usize, usize)| {
            let at_m = self.cells.bounds[axis][pieces[a].cell[axis]][1];
            let Gap { axes_m, faces_m, span_m, has_columns } = self.axes.gap(pieces[a].cell, axis);
            let axis_m = self.axes.list[1 - axis][pieces[a].cell[1 - axis]].at_m;
            let clear_m = self.between_beams(building, axis, axis_m, axes_m);
            let faces_m = if has_columns { faces_m } else { clear_m };
            let plane = InPlane::of(building, &pieces[a], axis);
            let beyond_m = beyond(&places, [&pieces[a], &pieces[b]], axis, faces_m);
            let stretch = Stretch { span_m, ends_m: faces_m, beyond_m };
            let sum = Crossing::of(&beams, (axis, at_m), &plane, &stretch)?;
            let bends_at_m = sum.level / sum.bending;
            let (level_m, held) = match self.axes.kind {
                Kind::Columns => (bends_at_m, Held::AtJoint),
                Kind::Middles => (plane.level_m, Held::AtJoint),
                Kind::OpenSpans => (plane.slab_level_m().unwrap_or(bends_at_m), sum.held(has_columns)),
            };
            // columns may be wider than their span
            let ends_m = match held {
                Held::AtJoint => Some(faces_m),
                Held::OverColumns => Some(between_columns(clear_m, faces_m, plane.edges)),
                Held::Free | Held::OneWay => None,
            };
            let [start, end] = ends_m.filter(|[start, end]| start < end).unwrap_or(clear_m);
            let mut point_m = [at_m, at_m, level_m];
            // on the axis, also where the edge of the floor is: pieces turn about the axes, and only there a twisted floor has no gaps
            point_m[1 - axis] = axis_m;
            let length_m = end - start;
            let mut bends_m = length_m;
            if self.axes.kind == Kind::Columns && sum.has_beam {
                let half_m = |side: usize| {
                    let width_m = (faces_m[side] - axes_m[side]).abs();
                    joints.half_m(&self.axes, pieces[[a, b][side]].cell, width_m)
                };
                bends_m += half_m(0) + half_m(1);
            }
            Some(Cut {
                axis,
                pieces: [a, b],
                point_m,
                faces_m,
                held,
                axes_m,
                length_m,
                bends_m,
                plane,
                sum,
                given: Given::default(),
                lines: Vec::new(),
                yields: true,
            })
        };
        neighbours(pieces).into_iter().filter_map(between).collect()
    }
}

/// The springs between the pieces of a floor, whose bodies begin at some place in the list, between their webs, and across its panels.
pub fn springs(
    building: &Building,
    (mut cuts, panels): (Vec<Cut>, Vec<Panel>),
    (pieces, webs): (&[Piece], &[Web]),
    (bodies, first): (&Bodies, usize),
    yielding: &mut YieldingEnds,
) -> Vec<Bushing> {
    let own = &bodies.list[first..first + pieces.len()];
    let mut springs = Vec::new();
    for cut in &mut cuts {
        let spring = spring(building, (cut, pieces), own, yielding);
        springs.extend(cut.with_webs(building, (spring, pieces), webs, yielding));
    }
    let first_across = springs.len();
    springs.extend(panels.iter().flat_map(|p| p.springs(&cuts, own, yielding)));
    // across a panel only its slab bends, also where beams end in the pieces beside it
    let slabs: BTreeSet<&str> =
        building.members.iter().filter(|m| m.kind == MemberKind::Slab).map(|m| m.id.as_str()).collect();
    for spring in &mut springs[first_across..] {
        spring.origin.members.retain(|id| slabs.contains(id.as_str()));
    }
    springs
}

/// The spring of a cut between two of the bodies of a floor.
fn spring(
    building: &Building,
    (cut, pieces): (&mut Cut, &[Piece]),
    bodies: &[Body],
    yielding: &mut YieldingEnds,
) -> Bushing {
    let (axis, length_m) = (cut.axis, cut.length_m);
    let plane = &cut.plane;
    let [turn, shear] = cut.in_the_middle();
    let [turn_in_plane, sideways] = in_the_middle([plane.bending; 2], plane.shear, length_m);
    let [of_a, of_b] = cut.pieces.map(|p| &bodies[p]);
    let id = format!("{}|{}", of_a.id, of_b.id);
    let ends =
        if cut.yields { yielding.of(building, &id, &cut.beam(pieces), turn) } else { Ends::elastic(turn) };
    let vertical = cut.give(building, pieces, ends.bending, yielding);
    let level_one = Bending::Elastic { stiffness_nm_rad: turn_in_plane };
    let mut members = through(building, cut, pieces);
    members.append(&mut cut.lines);
    Bushing {
        axial_stiffness_n_m: cut.plane.axial / length_m,
        shear_stiffness_n_m: if axis == 0 { [sideways, shear] } else { [shear, sideways] },
        torsional_stiffness_nm_rad: cut.sum.torsion / length_m,
        bending: if axis == 0 { [vertical, level_one] } else { [level_one, vertical] },
        beam: ends.beam,
        tensile_capacity_n: ends.squash_n,
        tensile_elongation_m: ends.elongation_m,
        compressive_capacity_n: ends.squash_n,
        associated_flow: true,
        origin: Origin { entries: Vec::new(), members, ..of_a.origin.clone() },
        ..Bushing::free(id, Some(of_a.id.clone()), of_b.id.clone(), cut.point_m, axes(axis, 1.0))
    }
}

/// The members that go through a cut: slabs and the beams across it, but not beams along it in the same pieces.
fn through(building: &Building, cut: &Cut, pieces: &[Piece]) -> Vec<String> {
    let (axis, at_m) = (cut.axis, cut.point_m[cut.axis]);
    let mut found: Vec<String> = Vec::new();
    for (index, own) in cut.pieces.iter().flat_map(|p| &pieces[*p].boxes) {
        let member = &building.members[*index];
        let is_across = member.kind != MemberKind::Beam || member.axis == axis;
        let reaches =
            own.min[axis] < at_m + COORDINATE_TOLERANCE_M && own.max[axis] > at_m - COORDINATE_TOLERANCE_M;
        if is_across && reaches && !found.contains(&member.id) {
            found.push(member.id.clone());
        }
    }
    found
}

impl Cut {
    /// Its beams and strips, whose ends may yield.
    pub fn beam<'a>(&self, pieces: &'a [Piece]) -> BeamCut<'a> {
        BeamCut {
            axis: self.axis,
            faces_m: self.faces_m,
            span: Span { length_m: self.length_m, mass_kg_m: self.plane.mass_kg_m },
            across_m: self.plane.edges,
            held: self.held,
            pieces: self.pieces.map(|p| &pieces[p]),
        }
    }

    /// Its spring, or two where webs meet there as well.
    fn with_webs(
        &self,
        building: &Building,
        (spring, pieces): (Bushing, &[Piece]),
        webs: &[Web],
        yielding: &mut YieldingEnds,
    ) -> Vec<Bushing> {
        let [at_m, across_m] = [self.axis, 1 - self.axis].map(|i| self.point_m[i]);
        let meeting = |side: usize| {
            let meets = |w: &&Web| {
                w.piece == self.pieces[side] && w.meets(building, (self.axis, at_m), side, across_m)
            };
            webs.iter().filter(meets).collect::<Vec<_>>()
        };
        let (before, after) = (meeting(0), meeting(1));
        let both = before.iter().find_map(|w| {
            after.iter().find(|other| other.member == w.member).map(|other| [w.id.clone(), other.id.clone()])
        });
        let Some(of_webs) = both else { return vec![spring] };
        let alone = self.sum.slab_share(&self.plane);
        let rest = yielding.share_of_slab(building, &self.beam(pieces)).unwrap_or(alone).clamp(0.0, 1.0);
        shared_out(spring, of_webs, rest, yielding)
    }
}

/// A spring in two parts, one of which joins the webs that meet there: the ends of the beam are theirs.
fn shared_out(spring: Bushing, [a, b]: [String; 2], rest: f64, yielding: &mut YieldingEnds) -> Vec<Bushing> {
    let [of_slab, of_webs] = [("slab", rest), ("web", 1.0 - rest)].map(|(part, share)| {
        let own = spring.bending.iter().find_map(Bending::curve);
        share_of(&spring, share, own.map(|curve| yielding.share_of(curve, share, &spring.id, part)))
    });
    let mut slab = Bushing { id: spring.id.clone(), ..of_slab };
    let id = format!("{a}|{b}");
    let origin = Origin { members: spring.origin.members.clone(), ..spring.origin };
    let mut web = Bushing { body_a: Some(a), body_b: b, origin, id, ..of_webs };
    let names = |id: &str| ["start", "end"].map(|end| format!("{id}.{end}"));
    if let (Some(slab_beam), Some(web_beam)) = (&mut slab.beam, &mut web.beam) {
        let own = names(&slab.id);
        // an end that has no beam is called after the cut, and stays with the slab
        for (k, end) in web_beam.ends.iter_mut().enumerate().filter(|(k, end)| **end == own[*k]) {
            *end = names(&web.id)[k].clone();
        }
        slab_beam.ends = own;
    }
    vec![slab, web]
}

/// What bends of a strip of slab between columns: where they stand the rest of its width is all that bends, and its moments are least beside it; so the column counts by `1 - (1 - c / b)²` of its width (as the beams of an equivalent frame do, ACI 318-14, R8.11.3, with the width `b` of the strip) \[m\].
fn between_columns(axes_m: [f64; 2], faces_m: [f64; 2], edges_m: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|side| {
        let half_m = faces_m[side] - axes_m[side];
        let beside = 1.0 - 2.0 * half_m.abs() / (edges_m[1] - edges_m[0]);
        axes_m[side] + half_m * (1.0 - beside.max(0.0).powi(2))
    })
}

/// How far the floor goes on beyond the faces on either side of two pieces, where no piece follows \[m\].
fn beyond(
    places: &BTreeMap<[usize; 2], usize>,
    [a, b]: [&Piece; 2],
    axis: usize,
    faces_m: [f64; 2],
) -> [Option<f64>; 2] {
    let follows = |piece: &Piece, step: isize| {
        let mut cell = piece.cell;
        let next = cell[axis].checked_add_signed(step);
        next.is_some_and(|next| {
            cell[axis] = next;
            places.contains_key(&cell)
        })
    };
    let low = a.boxes.iter().map(|(_, b)| b.min[axis]).fold(f64::INFINITY, f64::min);
    let high = b.boxes.iter().map(|(_, b)| b.max[axis]).fold(f64::NEG_INFINITY, f64::max);
    [(!follows(a, -1)).then_some(faces_m[0] - low), (!follows(b, 1)).then_some(high - faces_m[1])]
}

/// Pieces that touch at a corner only pass through each other: as the floor bends they would be pressed together there.
pub fn corners(pieces: &[Piece], bodies: &Bodies, first: usize) -> Vec<PairRule> {
    let id = |p: usize| bodies.list[first + p].id.clone();
    diagonals(pieces)
        .into_iter()
        .map(|[a, b]| PairRule {
            a: id(a),
            b: id(b),
            ignore: true,
            friction: None,
            restitution: None,
            rolling_m: None,
        })
        .collect()
}
