//! Floors that bend: a piece about each column, and springs between neighbouring pieces in the middle of the span between their columns.
//!
//! A beam of length `L` that is cut in the middle has there, for a moment `M` and a shear force `V`, the rotation `M L / (E I)` and the displacement `V (L³ / (12 E I) + L / (G A_s))`, which is all that its ends
//! can do to each other in a plane (Przemieniecki, Theory of Matrix Structural Analysis, 1968, eq. 5.116, written for the middle): springs of these stiffnesses between rigid halves
//! are the beam, under its weight as well. Its ends yield ([`crate::curve::beam`]) with the resistance of the row of elements beside the column ([`crate::rc::layers`]). The beams are those of the frame of [`crate::graph::idealise`]: beams with their flanges, strips of slab between columns that no beam joins; and what of the slab is in none of them, a plate. Where beams run across its ends the slab bends between their faces, and yields there. A
//! panel whose corner gives way is twisted, and nearly all that holds it is the slab: the springs are on the axes, so that pieces on the axes of a twisted floor meet without a gap. In its own plane a floor is as stiff as its whole section.
//!
//! Where columns are neighbours without a beam between them, the slab bends both ways: then there are pieces in the middle of the spans as well ([`super::axes`]), all of the slab is a plate, and the springs are at its height: the flanges of beams at the edges
//! are in their stiffness already. At the finest level of detail all floors have such pieces, those with beams in all spans with springs in the centres of their sections. Left out: yield in the plane of a floor and by torsion.

use super::axes::{FloorAxes, Gap, Kind, MEETS_M};
use super::beam_ends::{BeamCut, YieldingEnds};
use super::bodies::Bodies;
use super::cells::{Cells, Piece, by_cell, diagonals, neighbours};
use super::joints::axes;
use super::webs::{Web, share_of};
use super::wish::Accuracy;
use crate::building::{Building, MemberKind};
use crate::graph::Structure;
use crate::graph::frame::{Element, Frame};
use crate::graph::shear_lag::{Stretch, bending_n_m2};
use crate::mbs::model::{Bending, Bushing, Origin, PairRule, Span};
use crate::rc::layers::Held;
use std::collections::BTreeMap;

/// Share of the torsion constant of a rectangle that a strip of a plate has in either direction (Hambly, Bridge Deck Behaviour, 1976, section 3.4).
const PLATE_TORSION: f64 = 0.5;

/// A floor in pieces about its columns.
#[derive(Debug, Clone)]
pub struct Grillage {
    axes: FloorAxes,
    /// The cells about them.
    pub cells: Cells,
}

/// Sums over the beams that cross a cut.
#[derive(Debug, Clone, Copy, Default)]
struct Crossing {
    /// Bending stiffness about the horizontal axis \[N m²\] against rotation and against displacement across ([`crate::graph::shear_lag`]).
    bending: f64,
    across: f64,
    /// Torsional stiffness \[N m²\].
    torsion: f64,
    /// Shear stiffness in vertical direction \[N\].
    shear: f64,
    /// Heights of the beams, times their bending stiffness \[N m³\].
    level: f64,
    /// Whether a beam crosses it.
    has_beam: bool,
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
        Some(Self { axes, cells: Cells { members: members.to_vec(), bounds } })
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

    /// The springs between the pieces, whose bodies begin at some place in the list, and between their webs.
    pub fn springs(
        &self,
        building: &Building,
        frame: &Frame,
        (pieces, webs): (&[Piece], &[Web]),
        (bodies, first): (&Bodies, usize),
        yielding: &mut YieldingEnds,
    ) -> Vec<Bushing> {
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
        let mut between = |(axis, a, b): (usize, usize, usize)| {
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
            let (level, held) = match self.axes.kind {
                Kind::Columns => (bends_at_m, Held::AtJoint),
                Kind::Middles => (plane.level_m, Held::AtJoint),
                Kind::OpenSpans => (plane.slab_level_m().unwrap_or(bends_at_m), sum.held(has_columns)),
            };
            // a plate is far wider than the columns that it ends at, and columns may be wider than their span
            let at_faces = held == Held::AtJoint && faces_m[0] < faces_m[1];
            let [start, end] = if at_faces { faces_m } else { clear_m };
            let length_m = end - start;
            let [turn, shear] = in_the_middle([sum.bending, sum.across], sum.shear, length_m);
            let [turn_in_plane, sideways] = in_the_middle([plane.bending; 2], plane.shear, length_m);
            let [of_a, of_b] = [a, b].map(|p| &bodies.list[first + p]);
            let id = format!("{}|{}", of_a.id, of_b.id);
            let [piece_a, piece_b] = [a, b].map(|p| &pieces[p]);
            let pieces = [piece_a, piece_b];
            let span = Span { length_m, mass_kg_m: plane.mass_kg_m };
            let cut = BeamCut { axis, faces_m, span, across_m: plane.edges, held, pieces };
            let ends = yielding.of(building, &id, &cut, turn);
            let vertical = ends.bending;
            let level_one = Bending::Elastic { stiffness_nm_rad: turn_in_plane };
            let mut point_m = [at_m, at_m, level];
            // on the axis, also where the edge of the floor is: pieces turn about the axes, and only there a twisted floor has no gaps
            point_m[1 - axis] = axis_m;
            let spring = Bushing {
                id,
                body_a: Some(of_a.id.clone()),
                body_b: of_b.id.clone(),
                point_m,
                axes: axes(axis, 1.0),
                axial_stiffness_n_m: plane.axial / length_m,
                shear_stiffness_n_m: if axis == 0 { [sideways, shear] } else { [shear, sideways] },
                torsional_stiffness_nm_rad: sum.torsion / length_m,
                bending: if axis == 0 { [vertical, level_one] } else { [level_one, vertical] },
                beam: ends.beam,
                joint: None,
                latent: None,
                tensile_capacity_n: ends.squash_n,
                tensile_elongation_m: ends.elongation_m,
                shear_capacity_n: None,
                compressive_capacity_n: ends.squash_n,
                compressive_hardening: Vec::new(),
                crushing_shortening_m: None,
                associated_flow: true,
                carry_over: None,
                origin: Origin { entries: Vec::new(), ..of_a.origin.clone() },
            };
            let meeting = |p: usize, side: usize| {
                let across_m = spring.point_m[1 - axis];
                let meets = |w: &&Web| w.piece == p && w.meets(building, (axis, at_m), side, across_m);
                webs.iter().filter(meets).collect::<Vec<_>>()
            };
            let (before, after) = (meeting(a, 0), meeting(b, 1));
            let both = before.iter().find_map(|w| {
                after
                    .iter()
                    .find(|other| other.member == w.member)
                    .map(|other| [w.id.clone(), other.id.clone()])
            });
            let Some(of_webs) = both else { return Some(vec![spring]) };
            let alone = sum.slab_share(&plane);
            let rest = yielding.share_of_slab(building, &cut).unwrap_or(alone).clamp(0.0, 1.0);
            Some(shared_out(spring, of_webs, rest, yielding))
        };
        neighbours(pieces).into_iter().filter_map(&mut between).flatten().collect()
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

impl Crossing {
    /// Of those beams and strips of a floor that cross a cut in the section of a piece, and of the slab beside them; none if there are none.
    fn of(
        beams: &[(&Element, MemberKind)],
        (axis, at_m): (usize, f64),
        section: &InPlane,
        stretch: &Stretch,
    ) -> Option<Self> {
        let mut sum = Self::default();
        // widths of slab that bend, and that twist, in beams and strips
        let (mut bent_m, mut twisted_m) = (0.0, 0.0);
        for (element, kind) in beams {
            let [p, q] = element.ends_m;
            let crosses = (p[axis] - at_m) * (q[axis] - at_m) < 0.0;
            if !crosses || p[1 - axis] < section.edges[0] || p[1 - axis] > section.edges[1] {
                continue;
            }
            let g = element.section.shear_modulus_pa;
            // along axis 1 a beam is as wide as its web, also where a slab is its flange
            let shear_m2 = 1.2 * element.section.shear_area_m2[1];
            let web_m = (12.0 * element.section.inertia_m4[1] / shear_m2).sqrt();
            let in_slab_m = (element.section.area_m2 - shear_m2) / section.thickness_m.max(MEETS_M);
            let is_strip = *kind == MemberKind::Slab;
            bent_m += web_m + in_slab_m;
            twisted_m += web_m;
            let share = if is_strip { PLATE_TORSION } else { 1.0 };
            let torsion = share * g * element.section.torsion_m4;
            let bending = bending_n_m2(&element.section, stretch);
            sum.add(bending, torsion, g * element.section.shear_area_m2[1], p[2]);
            sum.has_beam = true;
        }
        for plate in &section.plates {
            let share = plate.width_m / section.slab_m;
            let left = |used_m: f64| (section.slab_m - used_m).max(0.0) * share;
            let [e, g] = plate.moduli_pa;
            let cubed = plate.thickness_m.powi(3);
            sum.add(
                [e * left(bent_m) * cubed / 12.0; 2],
                PLATE_TORSION * g * left(twisted_m) * cubed / 3.0,
                5.0 / 6.0 * g * left(bent_m) * plate.thickness_m,
                plate.level_m,
            );
        }
        (sum.bending > 0.0).then_some(sum)
    }

    /// Share of its bending stiffness that the slabs of a section have by themselves.
    fn slab_share(&self, section: &InPlane) -> f64 {
        let own = |p: &Plate| p.moduli_pa[0] * p.width_m * p.thickness_m.powi(3) / 12.0;
        section.plates.iter().map(own).sum::<f64>() / self.bending
    }

    /// What holds the rows of elements at the ends of a cut through a floor with spans that a slab bridges by itself.
    fn held(&self, has_columns: bool) -> Held {
        match (self.has_beam, has_columns) {
            (true, _) => Held::AtJoint,
            (false, true) => Held::OverColumns,
            (false, false) => Held::OneWay,
        }
    }

    /// Adds a beam or a plate at a height.
    fn add(&mut self, [bending, across]: [f64; 2], torsion: f64, shear: f64, level_m: f64) {
        self.bending += bending;
        self.across += across;
        self.torsion += torsion;
        self.shear += shear;
        self.level += bending * level_m;
    }
}

/// Stiffnesses against rotation \[N m/rad\] and against displacement across \[N/m\] of the springs in the middle of a beam of bending stiffness `E I`, which may differ for both, and shear stiffness `G A_s`.
fn in_the_middle([bending, across]: [f64; 2], shear: f64, length_m: f64) -> [f64; 2] {
    [bending / length_m, 1.0 / (length_m.powi(3) / (12.0 * across) + length_m / shear)]
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

/// The section of a piece where it meets the next one, in the plane of the floor.
struct InPlane {
    /// Its edges across the span \[m\].
    edges: [f64; 2],
    /// Axial stiffness, shear stiffness \[N\] and bending stiffness about the vertical \[N m²\].
    axial: f64,
    shear: f64,
    bending: f64,
    /// Height of its centre, by axial stiffness \[m\].
    level_m: f64,
    /// Mass per length along the span \[kg/m\].
    mass_kg_m: f64,
    /// Its slabs, their width together and the greatest thickness \[m\].
    plates: Vec<Plate>,
    slab_m: f64,
    thickness_m: f64,
}

/// A slab in a section.
struct Plate {
    width_m: f64,
    thickness_m: f64,
    /// Height of its middle \[m\].
    level_m: f64,
    /// Young's and shear modulus \[Pa\].
    moduli_pa: [f64; 2],
}

impl InPlane {
    fn of(building: &Building, piece: &Piece, axis: usize) -> Self {
        let across = 1 - axis;
        let end = piece.boxes.iter().map(|(_, b)| b.max[axis]).fold(f64::NEG_INFINITY, f64::max);
        let mut this = Self {
            edges: [f64::INFINITY, f64::NEG_INFINITY],
            axial: 0.0,
            shear: 0.0,
            bending: 0.0,
            level_m: 0.0,
            mass_kg_m: 0.0,
            plates: Vec::new(),
            slab_m: 0.0,
            thickness_m: 0.0,
        };
        for (member, solid) in piece.boxes.iter().filter(|(_, b)| b.max[axis] > end - MEETS_M) {
            let law = building.law_of(&building.members[*member]);
            let size = solid.size();
            let area = size[across] * size[2];
            this.edges[0] = this.edges[0].min(solid.min[across]);
            this.edges[1] = this.edges[1].max(solid.max[across]);
            this.mass_kg_m += law.density_kg_m3 * area;
            this.axial += law.youngs_modulus_pa * area;
            this.level_m += law.youngs_modulus_pa * area * solid.center()[2];
            this.shear += 5.0 / 6.0 * area * law.shear_modulus_pa();
            if building.members[*member].kind == MemberKind::Slab {
                this.slab_m += size[across];
                this.thickness_m = this.thickness_m.max(size[2]);
                this.plates.push(Plate {
                    width_m: size[across],
                    thickness_m: size[2],
                    level_m: solid.center()[2],
                    moduli_pa: [law.youngs_modulus_pa, law.shear_modulus_pa()],
                });
            }
        }
        this.level_m /= this.axial;
        let width = (this.edges[1] - this.edges[0]).max(0.0);
        this.bending = this.axial * width * width / 12.0;
        this
    }

    /// Mean height of the middle of its slabs \[m\]; none without slabs.
    fn slab_level_m(&self) -> Option<f64> {
        let sum: f64 = self.plates.iter().map(|p| p.width_m * p.level_m).sum();
        (self.slab_m > 0.0).then_some(sum / self.slab_m)
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::frame::BeamSection;

    #[test]
    fn rigid_halves_with_springs_in_the_middle_are_the_beam() {
        let section = BeamSection::rectangle(16.5e9, 0.2, [0.4, 0.6]);
        let length = 5.2;
        let beam = Element {
            member: "B".into(),
            nodes: [0, 1],
            ends_m: [[0.0; 3], [length, 0.0, 0.0]],
            axis1: [0.0, 1.0, 0.0],
            section,
            loads: Vec::new(),
        };
        let exact = beam.stiffness();
        let bending = section.youngs_modulus_pa * section.inertia_m4[0];
        let [turn, shear] =
            in_the_middle([bending; 2], section.shear_modulus_pa * section.shear_area_m2[1], length);
        // displacement across and rotation about axis 1 of both ends; what they do to the springs
        let freedoms = [2, 4, 8, 10];
        let half = 0.5 * length;
        let rotation = [0.0, -1.0, 0.0, 1.0];
        let gap = [-1.0, half, 1.0, half];
        for i in 0..4 {
            for j in 0..4 {
                let k = turn * rotation[i] * rotation[j] + shear * gap[i] * gap[j];
                let wanted = exact[freedoms[i]][freedoms[j]];
                let scale = (exact[freedoms[i]][freedoms[i]] * exact[freedoms[j]][freedoms[j]]).sqrt();
                assert!((k - wanted).abs() < 1e-12 * scale, "{i} {j}: {k} {wanted}");
            }
        }
    }

    #[test]
    fn a_slab_twists_as_a_plate_also_beside_beams() {
        let [width, thickness] = [3.0, 0.2];
        let plate = Plate { width_m: width, thickness_m: thickness, level_m: 3.0, moduli_pa: [16.5e9, 7e9] };
        let section = InPlane {
            edges: [0.0, width],
            axial: 0.0,
            shear: 0.0,
            bending: 0.0,
            level_m: 3.0,
            mass_kg_m: 0.0,
            plates: vec![plate],
            slab_m: width,
            thickness_m: thickness,
        };
        let stretch = Stretch { span_m: 4.6, ends_m: [0.2, 4.8], beyond_m: [None; 2] };
        let per_width = 7e9 * thickness.powi(3) / 6.0;
        let alone = Crossing::of(&[], (0, 2.5), &section, &stretch).unwrap();
        assert!((alone.torsion / (width * per_width) - 1.0).abs() < 1e-12);
        assert!((alone.bending / (16.5e9 * width * thickness.powi(3) / 12.0) - 1.0).abs() < 1e-12);
        assert_eq!(alone.level / alone.bending, 3.0);
        // a beam of 0.4 m with a flange of 1 m: 2.6 m of slab twist, 1.6 m bend for themselves
        let mut own = BeamSection::rectangle(16.5e9, 0.2, [0.4, 0.6]);
        own.area_m2 += thickness;
        let beam = Element {
            member: "B".into(),
            nodes: [0, 1],
            ends_m: [[0.0, 0.2, 2.9], [5.0, 0.2, 2.9]],
            axis1: [0.0, 1.0, 0.0],
            section: own,
            loads: Vec::new(),
        };
        let both = Crossing::of(&[(&beam, MemberKind::Beam)], (0, 2.5), &section, &stretch).unwrap();
        let torsion = own.shear_modulus_pa * own.torsion_m4 + 2.6 * per_width;
        assert!((both.torsion / torsion - 1.0).abs() < 1e-9, "{} {torsion}", both.torsion);
        let bending = 16.5e9 * (own.inertia_m4[0] + 1.6 * thickness.powi(3) / 12.0);
        assert!((both.bending / bending - 1.0).abs() < 1e-9, "{} {bending}", both.bending);
    }
}
