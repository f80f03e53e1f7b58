//! The ends of the beams and strips of a floor that bends: what they bear before they yield, and how they are called.

use super::cells::Piece;
use super::webs::share_of_curve;
use crate::base::geom::Aabb;
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Beam, Bending, Span};
use crate::rc::around::{SAME_PLANE_M, edges_between};
use crate::rc::layers::{Held, Layer, Layers, POLE, Pushes, Rows};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// How the names of curves of beams begin.
pub const BEAM_CURVES: &str = "beam/";
/// How far the end of a beam may be from the face of the columns on its axis \[m\].
const AT_FACE_M: f64 = 0.4;

/// A cut through a floor between two rows of columns.
pub struct BeamCut<'a> {
    /// Direction of the span.
    pub axis: usize,
    /// Faces of the columns on both sides \[m\].
    pub faces_m: [f64; 2],
    /// What bends between them, with its weight.
    pub span: Span,
    /// Edges across the span \[m\].
    pub across_m: [f64; 2],
    /// What holds the rows of elements at its ends.
    pub held: Held,
    /// The pieces of the floor on both sides.
    pub pieces: [&'a Piece; 2],
}

/// What the springs in the middle of a cut have of the ends of its beams.
pub struct Ends {
    /// Bending in the vertical plane.
    pub bending: Bending,
    /// The beam, unless it stays elastic.
    pub beam: Option<Beam>,
    /// Force at which the section flows along the span \[N\], and the elongation that it bears then \[m\].
    pub squash_n: Option<f64>,
    /// See `squash_n`.
    pub elongation_m: Option<f64>,
}

impl Ends {
    /// Of beams that do not yield, for the stiffness against rotation of their middle \[N m/rad\].
    pub fn elastic(stiffness_nm_rad: f64) -> Self {
        Self {
            bending: Bending::Elastic { stiffness_nm_rad },
            beam: None,
            squash_n: None,
            elongation_m: None,
        }
    }
}

/// Numbers to 30 bits each, as nine decimal digits have: what differs by round-off is the same but at the edge of two of them.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct Numbers(Vec<u64>);

impl Numbers {
    fn of(numbers: impl IntoIterator<Item = f64>) -> Self {
        const DROPPED: u32 = f64::MANTISSA_DIGITS - 1 - 30;
        let kept = |x: f64| x.to_bits().wrapping_add(1 << (DROPPED - 1)) >> DROPPED;
        Self(numbers.into_iter().map(kept).collect())
    }

    fn with(&self, numbers: impl IntoIterator<Item = f64>) -> Self {
        Self(self.0.iter().copied().chain(Self::of(numbers).0).collect())
    }
}

/// The beams of all floors that bend, and their curves.
pub struct YieldingEnds<'a> {
    /// Planes of the mesh along x, y and z \[m\].
    planes: &'a [Vec<f64>; 3],
    /// Ends by member.
    ends: BTreeMap<usize, Vec<&'a MemberEnd>>,
    /// Curves by id, and their ids by the numbers that they follow from.
    curves: BTreeMap<String, ResistanceCurve>,
    known: HashMap<Numbers, String>,
    /// The same of shares that springs across panels have, by curve and numbers.
    across: HashMap<(String, Numbers), String>,
    /// Pushes of the sections, by the numbers that they follow from.
    pushes: HashMap<Numbers, Pushes>,
    names: BTreeSet<String>,
    /// Moments of the slab and of all of a cut, by curve.
    moments: BTreeMap<String, Option<[f64; 2]>>,
}

impl<'a> YieldingEnds<'a> {
    /// For the planes of a mesh and the ends of its members.
    pub fn new(planes: &'a [Vec<f64>; 3], ends: &'a [MemberEnd]) -> Self {
        let mut of_member: BTreeMap<usize, Vec<&MemberEnd>> = BTreeMap::new();
        ends.iter().for_each(|e| of_member.entry(e.member).or_default().push(e));
        let (curves, known, across, pushes, names, moments) = Default::default();
        Self { planes, ends: of_member, curves, known, across, pushes, names, moments }
    }

    /// The curves of all cuts that were asked for.
    pub fn into_curves(self) -> BTreeMap<String, ResistanceCurve> {
        self.curves
    }

    /// The ends of the beams in a cut, for the stiffness against rotation of its middle \[N m/rad\].
    pub fn of(&mut self, building: &Building, id: &str, cut: &BeamCut, stiffness_nm_rad: f64) -> Ends {
        let elastic = Ends::elastic(stiffness_nm_rad);
        let row_m = self.row_m(cut);
        let Some((section, _)) = self.weaker(building, cut) else { return elastic };
        let half_length_m = 0.5 * (cut.faces_m[1] - cut.faces_m[0]) - POLE * row_m;
        if half_length_m <= 0.0 {
            return elastic;
        }
        let of_section = Numbers::of(section.numbers().chain([row_m, f64::from(cut.held as u8)]));
        let own = of_section.with([half_length_m, stiffness_nm_rad]);
        let curve = self.known.entry(own).or_insert_with(|| {
            let name = format!("{BEAM_CURVES}{id}");
            let pushes = self.pushes.entry(of_section).or_insert_with(|| section.pushes(row_m, cut.held));
            // the moment is zero in the middle of the span, where the cut is
            self.curves.insert(name.clone(), pushes.curve(half_length_m, stiffness_nm_rad));
            name
        });
        let bending = Bending::Curve { curve: curve.clone(), strength_factor: 1.0 };
        let critical = section.critical_strain();
        Ends {
            bending,
            beam: Some(Beam {
                half_length_m,
                ends: [0, 1].map(|side| self.name(id, cut, side)),
                span: Some(cut.span),
            }),
            squash_n: Some(section.squash_n),
            elongation_m: Some(critical * row_m),
        }
    }

    /// The section at the weaker end, which stands for both, and its side.
    fn weaker<'b>(&self, building: &'b Building, cut: &BeamCut) -> Option<(Layers<'b>, usize)> {
        let row_m = self.row_m(cut);
        let sections = [0, 1].map(|side| Layers::of(self.layers(building, cut, side, row_m)));
        let [Some(one), Some(other)] = sections else { return None };
        Some(if other.squash_n < one.squash_n { (other, 1) } else { (one, 0) })
    }

    /// Share of the moment that the ends of a cut bear which the slab there would bear by itself; none if they stay elastic.
    pub fn share_of_slab(&self, building: &Building, cut: &BeamCut) -> Option<f64> {
        self.slab_and_whole_nm(building, cut).map(|[slab_nm, whole_nm]| slab_nm / whole_nm)
    }

    /// Moments that the slab at the ends of a cut would bear by itself, and that all of it bears \[N m\]; none if they stay elastic.
    pub fn slab_and_whole_nm(&self, building: &Building, cut: &BeamCut) -> Option<[f64; 2]> {
        let row_m = self.row_m(cut);
        let half_length_m = 0.5 * (cut.faces_m[1] - cut.faces_m[0]) - POLE * row_m;
        let (whole, side) = self.weaker(building, cut).filter(|_| half_length_m > 0.0)?;
        let mut layers = self.layers(building, cut, side, row_m);
        layers.retain(|l| l.is_plate);
        let rows = Rows { row_m, shear_span_m: half_length_m, held: cut.held };
        let slab_nm = Layers::of(layers).map_or(0.0, |slab| slab.weaker(&rows, 0.0).peak_nm());
        Some([slab_nm, whole.weaker(&rows, 0.0).peak_nm()])
    }

    /// [`Self::slab_and_whole_nm`] of a cut, which is the same for all cuts of a curve.
    pub fn moments_of(&mut self, building: &Building, curve: &str, cut: &BeamCut) -> Option<[f64; 2]> {
        if let Some(known) = self.moments.get(curve) {
            return *known;
        }
        let moments = self.slab_and_whole_nm(building, cut);
        self.moments.insert(curve.to_string(), moments);
        moments
    }

    /// Enters what springs across panels have of a curve: a share of its resistance without axial force, and a stiffness of their own \[N m/rad\]; its id.
    pub fn across(&mut self, curve: &str, share: f64, stiffness_nm_rad: f64) -> String {
        let key = (curve.to_string(), Numbers::of([share, stiffness_nm_rad]));
        let count = self.known.len() + self.across.len();
        let id = self.across.entry(key).or_insert_with(|| format!("{curve}/across-{count}"));
        if let Some(of) = self.curves.get(curve).filter(|_| !self.curves.contains_key(id)) {
            let force = |l: &&CapacityLevel| l.axial_force_n.abs();
            let mut level = of.levels.iter().min_by(|l, m| force(l).total_cmp(&force(m))).cloned();
            level.iter_mut().for_each(|l| l.scale(share));
            let levels = level.into_iter().collect();
            self.curves.insert(id.clone(), ResistanceCurve { stiffness_nm_rad, levels, cyclic: None });
        }
        id.clone()
    }

    /// Enters a share of a curve, for a part of a cut; its id.
    pub fn share_of(&mut self, curve: &str, share: f64, cut: &str, part: &str) -> String {
        let id = format!("{BEAM_CURVES}{cut}/{part}");
        if let Some(own) = self.curves.get(curve).map(|c| share_of_curve(c, share)) {
            self.curves.insert(id.clone(), own);
        }
        id
    }

    /// Length of the row of elements beside the columns, the longer one of both sides \[m\].
    fn row_m(&self, cut: &BeamCut) -> f64 {
        let planes = &self.planes[cut.axis];
        let [low, high] = cut.faces_m;
        let after = planes.iter().find(|p| **p > low + SAME_PLANE_M).map_or(0.0, |p| p - low);
        let before = planes.iter().rev().find(|p| **p < high - SAME_PLANE_M).map_or(0.0, |p| high - p);
        after.max(before)
    }

    /// The section in the middle of the row of elements beside the columns of a side, in layers of elements.
    fn layers<'b>(&self, building: &'b Building, cut: &BeamCut, side: usize, row_m: f64) -> Vec<Layer<'b>> {
        let mut list = Vec::new();
        // what is divided just there counts with what is farther in the span
        let at_m = cut.faces_m[side] + [1.0, -1.0][side] * (0.5 * row_m + SAME_PLANE_M);
        let crosses = |b: &&(usize, Aabb)| b.1.min[cut.axis] < at_m && at_m < b.1.max[cut.axis];
        for (member, solid) in cut.pieces[side].boxes.iter().filter(crosses) {
            let member = &building.members[*member];
            let strength = building.strength_factor(&member.id);
            let edges = edges_between(&self.planes[2], [solid.min[2], solid.max[2]]);
            let (width_m, is_plate) = (solid.size()[1 - cut.axis], member.kind == MemberKind::Slab);
            list.extend(Layer::between(&edges, width_m, strength, is_plate, building.law_of(member)));
        }
        list
    }

    /// Name of the hinge on one side of a cut: that of the beam end there, else one of its own.
    fn name(&mut self, id: &str, cut: &BeamCut, side: usize) -> String {
        let here = |e: &&&MemberEnd| {
            let across = e.point_m[1 - cut.axis];
            e.axis == cut.axis
                && (e.outward > 0.0) == (side == 0)
                && (e.point_m[cut.axis] - cut.faces_m[side]).abs() <= AT_FACE_M
                && across >= cut.across_m[0]
                && across <= cut.across_m[1]
        };
        let ends = cut.pieces[side].boxes.iter().filter_map(|(member, _)| self.ends.get(member)).flatten();
        let found = ends.filter(here).find(|e| !self.names.contains(&e.id)).map(|e| e.id.clone());
        let name = found.unwrap_or_else(|| format!("{id}.{}", ["start", "end"][side]));
        self.names.insert(name.clone());
        name
    }
}
