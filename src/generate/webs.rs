//! Beams that may break away from their slab once something has happened to them.
//!
//! What rules say of a beam after the first contact is asked beforehand. The web of such a beam, which is what lies below its slab, is a body of its own in each piece of a floor that bends, between joint blocks over columns. It is one with the piece by latent
//! bushings: two along its upper face, each in the middle of one half, and one at each end that meets a joint block. Nobody looks at them until a rule about contacts or fractures fires for the beam ([`super::event_rules`]).
//!
//! The web of a beam with a charge is such a body as well, which the charge takes away ([`super::charges`]).
//!
//! A face of area `A` bears `σ_y A` along its normal, `σ_y A / √3` across (von Mises) and the plastic moment `σ_y b h² / 4` about either of its axes; it separates where the outer fibre of the row of elements beside it, of length `l`, reaches the critical plastic strain
//! `ε`: after an elongation `ε l` or a rotation `2 ε l / h`. It is as stiff as twice the way from the middle of the web to that of the slab, or to the joint block.
//!
//! The springs in the middle of a span are shared out: so much of all of them joins the webs as the section would lose of its resistance without them, the rest the pieces of the floor. Both parts have the same history as long as the webs are one with their slabs, and are one spring together; a web that has broken
//! away keeps its share, and the slab bends alone.

use super::GenerateError;
use super::bodies::{Bodies, of_boxes};
use super::cells::Piece;
use super::decide::Decision;
use super::joints::axes;
use super::sections::{SOFTER, shear_capacity};
use crate::base::geom::Aabb;
use crate::building::gaps::JUST_BEYOND_M;
use crate::building::{Building, MemberKind};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::graph::Structure;
use crate::mbs::model::{Bending, Body, Bushing, Origin};
use crate::rc::around::edges_between;
use crate::rc::pushover::torsion_constant;
use crate::rules::{Action, RuleBase};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// Planes nearer to each other than this are one \[m\].
const MEETS_M: f64 = 1e-6;

/// Id of the question whether a beam may break away from its slab, in traces.
pub fn web_of(member: &str) -> String {
    format!("{member}.web")
}

/// The web of a beam in a piece of a floor.
#[derive(Debug, Clone)]
pub struct Web {
    /// Name of its body.
    pub id: String,
    /// The beam.
    pub member: usize,
    /// Its piece, by the place among those of the floor.
    pub piece: usize,
    /// Its boxes, by their places among those of the piece.
    boxes: Vec<usize>,
    /// All of them.
    solid: Aabb,
    /// What lies at a slab of each half of its upper face.
    seams: Vec<Seam>,
    /// Whether it meets a joint block at its ends.
    at_joint: [bool; 2],
}

/// Part of the upper face of a web.
#[derive(Debug, Clone, Copy)]
struct Seam {
    area_m2: f64,
    /// Thickness of the slab above it \[m\].
    slab_m: f64,
    point_m: [f64; 3],
}

/// The webs of some beams of a floor, and those of them that have none.
pub fn of_floor(building: &Building, beams: &[usize], pieces: &[Piece]) -> (Vec<Web>, Vec<usize>) {
    let (mut webs, mut without) = (Vec::new(), Vec::new());
    for member in beams.iter().copied() {
        let of_piece = |(p, piece): (usize, &Piece)| in_piece(building, member, p, piece);
        let mut own: Vec<Web> = pieces.iter().enumerate().flat_map(of_piece).collect();
        let axis = building.members[member].axis;
        own.sort_by(|a, b| a.solid.min[axis].total_cmp(&b.solid.min[axis]));
        for (k, web) in own.iter_mut().enumerate() {
            web.id = format!("{}/{}", building.members[member].id, k + 1);
        }
        if own.is_empty() {
            without.push(member);
        }
        webs.extend(own);
    }
    // a web that ends at another one hangs on the slab alone: the other may break away as well
    for i in 0..webs.len() {
        let at_web = [0, 1].map(|side| {
            let probe = webs[i].beyond(building, side);
            let other =
                |(k, w): (usize, &Web)| k != i && w.piece == webs[i].piece && w.solid.contains(probe, 0.0);
            webs.iter().enumerate().any(other)
        });
        let alone = webs[i].at_joint;
        webs[i].at_joint = [0, 1].map(|side| alone[side] && !at_web[side]);
    }
    (webs, without)
}

/// The webs of a beam in a piece: what of it lies below slabs and beside columns.
fn in_piece(building: &Building, beam: usize, place: usize, piece: &Piece) -> Vec<Web> {
    let member = &building.members[beam];
    let axis = member.axis;
    let is_slab = |m: usize| building.members[m].kind == MemberKind::Slab;
    let slabs: Vec<&Aabb> = piece.boxes.iter().filter(|(m, _)| is_slab(*m)).map(|(_, b)| b).collect();
    let above = |b: &Aabb| slabs.iter().any(|s| s.min[2] > b.max[2] - MEETS_M && overlap(s, b).is_some());
    let own: Vec<(usize, &Aabb)> = piece
        .boxes
        .iter()
        .enumerate()
        .filter(|(_, (m, b))| *m == beam && above(b))
        .map(|(i, (_, b))| (i, b))
        .collect();
    let edges = |f: fn(f64, f64) -> f64, start: f64, of: fn(&Aabb) -> [f64; 3]| {
        own.iter().map(|(_, b)| of(b)[axis]).fold(start, f)
    };
    let (low, high) =
        (edges(f64::min, f64::INFINITY, |b| b.min), edges(f64::max, f64::NEG_INFINITY, |b| b.max));
    let mut webs = Vec::new();
    for [start, end] in between_columns(building, beam, [low, high]) {
        let inside = |b: &Aabb| b.min[axis] > start - MEETS_M && b.max[axis] < end + MEETS_M;
        let within: Vec<(usize, &Aabb)> = own.iter().filter(|(_, b)| inside(b)).copied().collect();
        let Some(solid) = within.iter().map(|(_, b)| **b).reduce(Aabb::around) else { continue };
        let halves = [0.0, 0.5].map(|share| seam(&slabs, &solid, axis, share));
        let seams: Vec<Seam> = halves.into_iter().flatten().collect();
        // what is shorter than wide is part of the joint
        if seams.is_empty() || solid.size()[axis] < solid.size()[1 - axis] {
            continue;
        }
        let boxes: Vec<usize> = within.iter().map(|(i, _)| *i).collect();
        let mut web =
            Web { id: String::new(), member: beam, piece: place, boxes, solid, seams, at_joint: [false; 2] };
        web.at_joint = [0, 1].map(|side| {
            let probe = web.beyond(building, side);
            let mut others = piece.boxes.iter().enumerate().filter(|(i, _)| !web.boxes.contains(i));
            others.any(|(_, (_, b))| b.contains(probe, 0.0))
        });
        webs.push(web);
    }
    webs
}

/// Lower and upper ends of what a beam has between two places and beside the columns that it rests on \[m\].
fn between_columns(building: &Building, beam: usize, [low, high]: [f64; 2]) -> Vec<[f64; 2]> {
    let member = &building.members[beam];
    let columns = building.members.iter().filter(|m| m.kind == MemberKind::Column);
    let mut joints: Vec<[f64; 2]> = columns
        .filter(|c| c.solid.intersection(&member.solid, 1e-9).is_some())
        .map(|c| [c.solid.min[member.axis], c.solid.max[member.axis]])
        .collect();
    joints.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut list, mut from) = (Vec::new(), low);
    for [start, end] in joints {
        list.push([from, start.min(high)]);
        from = from.max(end);
    }
    list.push([from, high]);
    list.retain(|[start, end]| end - start > MEETS_M);
    list
}

/// Common part in plan, with the heights of the first.
fn overlap(a: &Aabb, b: &Aabb) -> Option<Aabb> {
    let flat = Aabb { min: [b.min[0], b.min[1], a.min[2]], max: [b.max[0], b.max[1], a.max[2]] };
    a.intersection(&flat, MEETS_M)
}

/// Where slabs lie on a half of a web, which begins at a share of its length.
fn seam(slabs: &[&Aabb], web: &Aabb, axis: usize, share: f64) -> Option<Seam> {
    let mut half = *web;
    half.min[axis] += share * web.size()[axis];
    half.max[axis] = half.min[axis] + 0.5 * web.size()[axis];
    let on = |s: &&&Aabb| (s.min[2] - web.max[2]).abs() < MEETS_M;
    let (mut area_m2, mut slab_m, mut point_m) = (0.0, 0.0_f64, [0.0; 3]);
    for own in slabs.iter().filter(on).filter_map(|s| overlap(s, &half)) {
        let area = own.size()[0] * own.size()[1];
        area_m2 += area;
        slab_m = slab_m.max(own.size()[2]);
        (0..2).for_each(|i| point_m[i] += area * own.center()[i]);
    }
    (0..2).for_each(|i| point_m[i] /= area_m2);
    point_m[2] = web.max[2];
    (area_m2 > 0.0).then_some(Seam { area_m2, slab_m, point_m })
}

/// The body of a piece without its webs; it stands for all members of the piece.
pub fn rest(
    building: &Building,
    structure: &Structure,
    (place, piece): (usize, &Piece),
    webs: &[Web],
    (id, rules): (String, Vec<String>),
) -> Body {
    let whole = piece.body(building, structure, id.clone(), rules.clone());
    let away: BTreeSet<usize> =
        webs.iter().filter(|w| w.piece == place).flat_map(|w| w.boxes.clone()).collect();
    if away.is_empty() {
        return whole;
    }
    let stays = piece.boxes.iter().enumerate().filter(|(i, _)| !away.contains(i)).map(|(_, b)| *b);
    let boxes: Vec<(usize, Aabb)> = stays.collect();
    Body { origin: whole.origin, ..of_boxes(building, structure, &boxes, id, rules) }
}

impl Web {
    /// Its body.
    pub fn body(
        &self,
        building: &Building,
        structure: &Structure,
        pieces: &[Piece],
        rules: Vec<String>,
    ) -> Body {
        let of_piece = &pieces[self.piece].boxes;
        let boxes: Vec<(usize, Aabb)> = self.boxes.iter().map(|i| of_piece[*i]).collect();
        of_boxes(building, structure, &boxes, self.id.clone(), rules)
    }

    /// The subject of the rules for which it is a body of its own: that its beam may break away, or the beam, which has a charge.
    pub fn question(&self, building: &Building, decision: &Decision) -> String {
        let beam = &building.members[self.member].id;
        if decision.breaks_away(self.member) { web_of(beam) } else { beam.clone() }
    }

    /// A place just beyond one of its ends \[m\].
    fn beyond(&self, building: &Building, side: usize) -> [f64; 3] {
        let (axis, mut at) = (building.members[self.member].axis, self.solid.center());
        at[axis] = [self.solid.min, self.solid.max][side][axis] + [-JUST_BEYOND_M, JUST_BEYOND_M][side];
        at
    }

    /// Whether it ends at a cut across an axis, on its lower side or its upper one, and lies on an axis of the floor there \[m\].
    pub fn meets(&self, building: &Building, (axis, at_m): (usize, f64), side: usize, across_m: f64) -> bool {
        let Aabb { min, max } = self.solid;
        building.members[self.member].axis == axis
            && ([max, min][side][axis] - at_m).abs() < MEETS_M
            && min[1 - axis] <= across_m
            && across_m <= max[1 - axis]
    }

    /// The latent bushings between it and its piece, with their curves.
    fn bushings(
        &self,
        building: &Building,
        planes: &[Vec<f64>; 3],
        piece: &Body,
        (origin, curves): (&Origin, &mut BTreeMap<String, ResistanceCurve>),
    ) -> Vec<Bushing> {
        let axis = building.members[self.member].axis;
        let size = self.solid.size();
        let row_m = |axis: usize| {
            let edges = edges_between(&planes[axis], [self.solid.min[axis], self.solid.max[axis]]);
            edges.windows(2).map(|e| e[1] - e[0]).fold(0.0, f64::max)
        };
        let mut list = Vec::new();
        for (k, seam) in self.seams.iter().enumerate() {
            let mut sides_m = [size[0], size[1]];
            sides_m[axis] = seam.area_m2 / size[1 - axis];
            let face = Face {
                axis: 2,
                sides_m,
                depth_m: 0.5 * SOFTER * (size[2] + seam.slab_m),
                row_m: row_m(2),
                web: self,
            };
            list.push(face.bushing(
                building,
                format!("{}.slab-{}", self.id, k + 1),
                seam.point_m,
                piece,
                curves,
            ));
        }
        for side in (0..2).filter(|side| self.at_joint[*side]) {
            let mut point_m = self.solid.center();
            point_m[axis] = [self.solid.min, self.solid.max][side][axis];
            let sides_m = [1, 2].map(|i| size[(axis + i) % 3]);
            let face =
                Face { axis, sides_m, depth_m: 0.5 * SOFTER * size[axis], row_m: row_m(axis), web: self };
            let id = format!("{}.{}", self.id, ["start", "end"][side]);
            list.push(face.bushing(building, id, point_m, piece, curves));
        }
        list.iter_mut().for_each(|bushing| bushing.origin = origin.clone());
        list
    }
}

/// A face at which a web may break away.
struct Face<'a> {
    /// Axis of its normal.
    axis: usize,
    /// Its sides along axes 1 and 2 of its bushing \[m\].
    sides_m: [f64; 2],
    /// How far behind it the web bends \[m\].
    depth_m: f64,
    /// Length of the row of elements beside it \[m\].
    row_m: f64,
    web: &'a Web,
}

impl Face<'_> {
    fn bushing(
        &self,
        building: &Building,
        id: String,
        point_m: [f64; 3],
        piece: &Body,
        curves: &mut BTreeMap<String, ResistanceCurve>,
    ) -> Bushing {
        let Self { axis, sides_m, depth_m, row_m, web } = *self;
        let member = &building.members[web.member];
        let law = building.law_of(member);
        let first = law.hardening.first().map_or(0.0, |p| p.stress_pa);
        let flows_pa = building.strength_factor(&member.id) * first;
        let [e, g] = [law.youngs_modulus_pa, law.shear_modulus_pa()];
        let area = sides_m[0] * sides_m[1];
        let squash_n = flows_pa * area;
        let mut bending = |k: usize| {
            let [width, depth] = [sides_m[k], sides_m[1 - k]];
            let stiffness_nm_rad = e * width * depth.powi(3) / 12.0 / depth_m;
            let moment_nm = flows_pa * width * depth * depth / 4.0;
            let fracture_rotation_rad = 2.0 * law.critical_plastic_strain * row_m / depth;
            let id = format!("web/{stiffness_nm_rad:.8e}/{moment_nm:.8e}/{fracture_rotation_rad:.8e}");
            let level =
                CapacityLevel { axial_force_n: 0.0, capacity: vec![[0.0, moment_nm]], fracture_rotation_rad };
            let curve = ResistanceCurve { stiffness_nm_rad, levels: vec![level], cyclic: None };
            curves.entry(id.clone()).or_insert(curve);
            Bending::Curve { curve: id, strength_factor: 1.0 }
        };
        Bushing {
            axial_stiffness_n_m: e * area / depth_m,
            shear_stiffness_n_m: [5.0 / 6.0 * g * area / depth_m; 2],
            torsional_stiffness_nm_rad: g * torsion_constant(sides_m) / depth_m,
            bending: [bending(0), bending(1)],
            latent: Some(web.id.clone()),
            tensile_capacity_n: Some(squash_n),
            tensile_elongation_m: Some(law.critical_plastic_strain * row_m),
            shear_capacity_n: Some(shear_capacity(squash_n)),
            compressive_capacity_n: Some(squash_n),
            ..Bushing::free(id, Some(piece.id.clone()), web.id.clone(), point_m, axes(axis, 1.0))
        }
    }
}

/// What hangs together with the webs of all floors.
#[derive(Debug, Default)]
pub struct Webs {
    /// Their bodies, each with that of its piece.
    pub bodies: Vec<String>,
    /// The latent bushings between them.
    pub bushings: Vec<Bushing>,
    /// Bodies and latent bushings of those that may break away.
    pub parting: [Vec<String>; 2],
}

impl Webs {
    /// Adds those of a floor whose pieces are the bodies from some place on.
    pub fn add(
        &mut self,
        building: &Building,
        planes: &[Vec<f64>; 3],
        (webs, first): (&[Web], usize),
        (bodies, decision): (&Bodies, &Decision),
        curves: &mut BTreeMap<String, ResistanceCurve>,
    ) {
        for web in webs {
            let question = web.question(building, decision);
            let (rules, members) = (decision.fired(&question), vec![question]);
            let origin = Origin { members, rules, entries: Vec::new() };
            let piece = &bodies.list[first + web.piece];
            let own = web.bushings(building, planes, piece, (&origin, curves));
            if decision.breaks_away(web.member) {
                self.parting[0].push(web.id.clone());
                self.parting[1].extend(own.iter().map(|b| b.id.clone()));
            }
            self.bodies.push(web.id.clone());
            self.bushings.extend(own);
        }
    }
}

/// A share of a spring, with the curve of that.
pub fn share_of(spring: &Bushing, share: f64, curve: Option<String>) -> Bushing {
    let scaled = |bending: &Bending| match bending {
        Bending::Elastic { stiffness_nm_rad } => {
            Bending::Elastic { stiffness_nm_rad: share * stiffness_nm_rad }
        }
        Bending::Curve { curve: own, strength_factor } => Bending::Curve {
            curve: curve.clone().unwrap_or_else(|| own.clone()),
            strength_factor: *strength_factor,
        },
    };
    let mut own = spring.clone();
    own.bending = [0, 1].map(|k| scaled(&spring.bending[k]));
    own.axial_stiffness_n_m *= share;
    own.shear_stiffness_n_m = own.shear_stiffness_n_m.map(|k| share * k);
    own.torsional_stiffness_nm_rad *= share;
    own.tensile_capacity_n = own.tensile_capacity_n.map(|n| share * n);
    own.compressive_capacity_n = own.compressive_capacity_n.map(|n| share * n);
    if let Some(span) = own.beam.as_mut().and_then(|b| b.span.as_mut()) {
        span.mass_kg_m *= share;
    }
    own
}

/// The same of a curve.
pub fn share_of_curve(curve: &ResistanceCurve, share: f64) -> ResistanceCurve {
    let mut own = curve.clone();
    own.stiffness_nm_rad *= share;
    for level in &mut own.levels {
        level.axial_force_n *= share;
        level.scale(share);
    }
    own
}

/// Beams that rules or the analyst have break away, and that cannot.
#[derive(Debug, Default)]
pub struct Stays {
    /// By the reason, with their ids.
    by_reason: BTreeMap<String, Vec<String>>,
}

impl Stays {
    /// Of some beams, for a reason.
    ///
    /// # Errors
    /// If the analyst asks for one of them.
    pub fn add(
        &mut self,
        building: &Building,
        beams: &[usize],
        why: &str,
        decision: &Decision,
    ) -> Result<(), GenerateError> {
        for id in beams.iter().map(|m| &building.members[*m].id) {
            if decision.is_of_analyst(&web_of(id)) {
                return Err(GenerateError::Override(id.clone(), why.to_string()));
            }
            self.by_reason.entry(why.to_string()).or_default().push(id.clone());
        }
        Ok(())
    }

    /// Notes about them.
    pub fn notes(&self) -> impl Iterator<Item = String> {
        self.by_reason.iter().map(|(why, beams)| format!("{} cannot break away: {why}", beams.join(", ")))
    }

    /// Why a beam stays.
    fn why(&self, beam: &str) -> Option<&String> {
        self.by_reason.iter().find(|(_, beams)| beams.iter().any(|b| b == beam)).map(|(why, _)| why)
    }
}

/// Beams that stay one with their slabs, whatever happens.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StaysWhole {
    /// Their ids.
    pub beams: Vec<String>,
    /// Why.
    pub why: String,
}

impl StaysWhole {
    /// Those of a building, with the bodies of the webs that its model has.
    pub fn all(
        building: &Building,
        rules: &RuleBase,
        (decision, stays): (&Decision, &Stays),
        webs: &[String],
    ) -> Vec<Self> {
        let parting: BTreeSet<&str> =
            webs.iter().filter_map(|w| w.rsplit_once('/')).map(|(beam, _)| beam).collect();
        let conditions: Vec<String> = rules
            .rules()
            .iter()
            .filter(|r| r.action == Action::BreakAway)
            .map(|r| format!("`{}` ({})", r.id, r.when))
            .collect();
        let unasked = match conditions.as_slice() {
            [] => "no rule has beams break away (`break_away`)".to_string(),
            [one] => format!("the condition of rule {one} does not hold"),
            _ => format!("the conditions of rules {} do not hold", conditions.join(", ")),
        };
        let mut by_reason: BTreeMap<String, Vec<String>> = BTreeMap::new();
        let beams = building.members.iter().enumerate().filter(|(_, m)| m.kind == MemberKind::Beam);
        for (index, beam) in beams.filter(|(_, m)| !parting.contains(m.id.as_str())) {
            let why = match stays.why(&beam.id) {
                Some(why) => why.clone(),
                None if decision.breaks_away(index) => "it is no part of the model".to_string(),
                None => unasked.clone(),
            };
            by_reason.entry(why).or_default().push(beam.id.clone());
        }
        by_reason.into_iter().map(|(why, beams)| Self { beams, why }).collect()
    }
}
