//! The building as a frame.
//!
//! * Columns, walls (as wide columns) and clear beams are Timoshenko beams on the centre lines of their gross
//!   sections, uncracked, of the homogenised law's modulus. A beam carries the slab as a flange of the
//!   effective width of plane stress (`flange`).
//! * Joint blocks are rigid: a node at the column's axis in the middle of the beams' depth, with rigid
//!   offsets to the end sections. Two columns or walls meet in a joint if only solid lies between them.
//! * Slabs that meet at their edges are one plate, wherever the plan is cut into rectangles (`plates`). It is rigid in its plane (diaphragm), in which all axes of its floor
//!   lie (`level`). Out of plane it acts through the flanges; between aligned columns that no beam joins it is a strip as wide as half the distance to the neighbours. A column without a beam and without
//!   one in line with it has strips to its neighbours all round.
//! * Dead load: each member's own cells. Columns, walls and beams carry theirs as a line load, joint blocks at their
//!   node; each point of a slab loads the nearest beam or strip (45° envelope of a panel), in bins of
//!   [`LOAD_BIN_M`]. What lies beyond all carriers takes its moment about the nearest one along (`hull`); the torsion that a panel between
//!   carriers gives a beam is left out.
//! * Beams that only a slab holds go along with a strip, or the slab bears them (`floating`).
//! * Supported ends are clamped, also through a supported footing.

mod flange;
mod floating;
mod hull;
mod joints;
mod level;
mod loads;
mod plates;
mod strips;

use super::ends::{End, MemberEnd, is_upright};
use super::frame::{BeamSection, Diaphragm, Element, Flange, Frame, FrameNode};
use super::structure::Structure;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::base::sets::groups;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, Member, MemberKind};
use joints::Joint;
use petgraph::unionfind::UnionFind;
use plates::Plate;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Length of the stretches over which a slab's load on a beam is taken as uniform \[m\].
pub const LOAD_BIN_M: f64 = 0.25;
/// Distance of the sample points of a slab's load \[m\].
pub const LOAD_SAMPLE_M: f64 = 0.1;

/// A frame with the way back to the building.
#[derive(Debug, Clone, PartialEq)]
pub struct Idealised {
    /// The frame.
    pub frame: Frame,
    /// For each of `Structure::ends`: its element and which end of it; `None` if the member is gone.
    pub ends: Vec<Option<(usize, usize)>>,
    /// Weight of the members that are left, but for footings that bear nothing and lie on supports of their own \[N\].
    pub weight_n: f64,
    /// Its centre in plan \[m\].
    pub center_m: [f64; 2],
    /// Members whose weight found nothing to rest on; it is not in the frame.
    pub unplaced: Vec<String>,
    /// Columns and walls that touch a slab above them and bear nothing of it.
    pub left_out: Vec<String>,
    /// Beams that only a slab holds and that are no bars of the frame; the slab bears their weight.
    pub by_slab: Vec<String>,
}

/// A straight bar between joints, before it is cut into elements.
struct Span {
    /// Member index (of the slab, for a strip).
    member: usize,
    /// Name for messages.
    name: String,
    /// Axis along which it runs.
    axis: usize,
    /// A point on its centre line; the coordinate along `axis` is free unless it is skew \[m\].
    line: [f64; 3],
    /// How far its centre line runs across `axis` in plan over a metre along it: zero but for strips between columns out of line.
    skew: f64,
    /// Clear range along the axis \[m\].
    range: [f64; 2],
    /// Direction of the section's width.
    axis1: [f64; 3],
    section: BeamSection,
    /// Indices into `Structure::ends`; `None` for a strip.
    ends: Option<[usize; 2]>,
    /// `(coordinate, node)` of the nodes on it.
    nodes: Vec<(f64, usize)>,
    /// Vertical loads: stretch \[m\], force \[N/m\], positive downwards, and torque about the way along it \[N m/m\].
    loads: Vec<([f64; 2], [f64; 2])>,
}

impl Span {
    fn point(&self, coordinate: f64) -> [f64; 3] {
        let mut point = self.line;
        point[self.axis] = coordinate;
        if self.skew != 0.0 {
            point[1 - self.axis] += self.skew * (coordinate - self.line[self.axis]);
        }
        point
    }

    /// Length of its centre line over a metre along `axis`.
    fn stretch(&self) -> f64 {
        if self.skew == 0.0 { 1.0 } else { libm::hypot(self.skew, 1.0) }
    }
}

/// The slab beside a beam \[m\].
#[derive(Clone, Copy)]
struct SlabBeside {
    /// Width beyond the web that bends with it, the same under moments of one sense, and all of it up to half of the span.
    width_m: f64,
    long_m: f64,
    outstand_m: f64,
    thickness_m: f64,
    /// Height of its middle.
    level_m: f64,
}

struct Builder<'a> {
    structure: &'a Structure,
    building: &'a Building,
    removed: &'a BTreeSet<usize>,
    spans: Vec<Span>,
    joints: Vec<Joint>,
    nodes: Vec<FrameNode>,
    unplaced: Vec<String>,
    /// Weight of footings on supports of their own that nothing stands on \[N\].
    aside_n: f64,
    /// Its moments about the origin along x and y \[N m\].
    aside_moment_nm: [f64; 2],
    /// Beams without spans since only a slab holds them.
    by_slab: BTreeSet<usize>,
    /// Solids of the beams.
    beams: Boxes,
}

/// The building without the `removed` members as a frame.
pub fn idealise(structure: &Structure, building: &Building, removed: &BTreeSet<usize>) -> Idealised {
    let beams = building.members.iter().enumerate().filter(|(_, m)| m.kind == MemberKind::Beam);
    let mut builder = Builder {
        beams: Boxes::numbered(beams.map(|(index, m)| (index, m.solid))),
        structure,
        building,
        removed,
        spans: Vec::new(),
        joints: joints::find(structure, building),
        nodes: Vec::new(),
        unplaced: Vec::new(),
        aside_n: 0.0,
        aside_moment_nm: [0.0; 2],
        by_slab: BTreeSet::new(),
    };
    let plates = builder.plates();
    builder.add_bars(&plates);
    builder.place_joints();
    builder.tie_bars();
    builder.add_strips(&plates);
    builder.clamp_slabs();
    builder.hold_floating_beams(&plates);
    builder.place_loads(&plates);
    let diaphragms = builder.diaphragms(&plates);
    builder.level(&diaphragms);
    let left_out = builder.left_out(&plates);
    Idealised { left_out, ..builder.finish(diaphragms) }
}

/// Whether two solids overlap in plan and meet in height.
fn meet(a: &Aabb, b: &Aabb) -> bool {
    let gap = |i: usize| (a.min[i] - b.max[i]).max(b.min[i] - a.max[i]);
    gap(0) < -COORDINATE_TOLERANCE_M && gap(1) < -COORDINATE_TOLERANCE_M && gap(2) < COORDINATE_TOLERANCE_M
}

/// Whether two solids share a part of a vertical face.
fn abut(a: &Aabb, b: &Aabb) -> bool {
    let gap = |i: usize| (a.min[i] - b.max[i]).max(b.min[i] - a.max[i]);
    let touch = |i: usize| gap(i).abs() < COORDINATE_TOLERANCE_M;
    let overlap = |i: usize| gap(i) <= -COORDINATE_TOLERANCE_M;
    overlap(2) && (touch(0) && overlap(1) || touch(1) && overlap(0))
}

impl Builder<'_> {
    fn left(&self, member: usize) -> bool {
        !self.removed.contains(&member)
    }

    fn member(&self, index: usize) -> &Member {
        &self.building.members[index]
    }

    /// A span for each clear length of a bar that is left. Its ends stand side by side in `ends`.
    fn add_bars(&mut self, plates: &[Plate]) {
        let span = |(pair, ends): (usize, &[MemberEnd])| {
            let low: &MemberEnd = &ends[0];
            self.left(low.member).then(|| Span {
                member: low.member,
                name: low.member_id.clone(),
                axis: low.axis,
                line: low.point_m,
                skew: 0.0,
                range: [low.point_m[low.axis], ends[1].point_m[low.axis]],
                axis1: low.axes[1],
                section: self.section_of(low, plates),
                ends: Some([2 * pair, 2 * pair + 1]),
                nodes: Vec::new(),
                loads: Vec::new(),
            })
        };
        self.spans = self.structure.ends.par_chunks_exact(2).enumerate().filter_map(span).collect();
    }

    /// Elastic section of a bar, by its lower end; a beam with the slab as its flange.
    fn section_of(&self, end: &MemberEnd, plates: &[Plate]) -> BeamSection {
        let law = self.building.law_of(self.member(end.member));
        let mut section = BeamSection::rectangle(law.youngs_modulus_pa, law.poisson_ratio, end.size_m);
        let Some(slab) = self.flange(end, plates) else { return section };
        let web = section.area_m2;
        let own = section.inertia_m4[0];
        let arm = slab.level_m - end.point_m[2];
        let apart = |width: f64| own + width * slab.thickness_m.powi(3) / 12.0;
        let together = |width: f64| {
            let area = width * slab.thickness_m;
            apart(width) + web * area / (web + area) * arm * arm
        };
        section.inertia_m4[0] = together(slab.width_m);
        section.area_m2 = web + slab.width_m * slab.thickness_m;
        section.flange = Some(Flange {
            apart_m4: apart(slab.width_m),
            whole_m4: together(slab.outstand_m),
            long_m4: together(slab.long_m),
        });
        section
    }

    /// The flange that plates give a beam, by its lower end.
    fn flange(&self, end: &MemberEnd, plates: &[Plate]) -> Option<SlabBeside> {
        let beam = self.member(end.member);
        if beam.kind != MemberKind::Beam {
            return None;
        }
        let span_m = end.clear_length_m;
        let poisson = self.building.law_of(beam).poisson_ratio;
        let acting =
            |outstand: f64, wave_m: f64| flange::effective_width_m(outstand, wave_m, poisson).min(outstand);
        let mut found: Option<SlabBeside> = None;
        for plate in plates.iter().filter(|p| p.meets(&beam.solid)) {
            let level = plate.solids[0];
            let (low, high) = (level.min[2].max(beam.solid.min[2]), level.max[2].min(beam.solid.max[2]));
            let [mut width_m, mut long_m, mut outstand_m] = [0.0; 3];
            // from half of the span on the outstand counts for a few per cent only
            let wave_m = flange::ONE_SENSE * span_m;
            for (share, near) in self.outstands_m(end, plate, 0.5 * span_m) {
                width_m += share * near.iter().map(|o| acting(*o, span_m)).sum::<f64>();
                outstand_m += share * near.iter().map(|o| o.min(0.5 * span_m)).sum::<f64>();
            }
            for (share, far) in self.outstands_m(end, plate, 0.5 * wave_m) {
                long_m += share * far.iter().map(|o| acting(*o, wave_m)).sum::<f64>();
            }
            if high - low > COORDINATE_TOLERANCE_M && width_m > 0.0 {
                let before = found.map_or([0.0; 3], |f| [f.width_m, f.outstand_m, f.long_m]);
                found = Some(SlabBeside {
                    width_m: before[0] + width_m,
                    long_m: before[2] + long_m.max(width_m),
                    outstand_m: before[1] + outstand_m.max(width_m),
                    thickness_m: high - low,
                    level_m: 0.5 * (low + high),
                });
            }
        }
        found
    }

    /// Plate on either side of a beam, to its edge or to halfway to the next parallel beam \[m\], on stretches of the clear length with their shares;
    /// what is beyond `most_m` may be left out.
    fn outstands_m(&self, low: &MemberEnd, plate: &Plate, most_m: f64) -> Vec<(f64, [f64; 2])> {
        let (beam, axis) = (self.member(low.member), low.axis);
        let across = 1 - axis;
        let own = [beam.solid.min[across], beam.solid.max[across]];
        let range = [low.point_m[axis], low.point_m[axis] + low.clear_length_m];
        let outstands = |stretch: &plates::Stretch| {
            let Some(edges) = stretch.edges_m else { return [0.0; 2] };
            // the plate over which a beam may be as far away as it can matter
            let mut beside = plate.solids[0];
            (beside.min[axis], beside.max[axis]) = (stretch.range_m[0], stretch.range_m[1]);
            beside.min[across] = edges[0].max(own[0] - 2.0 * most_m);
            beside.max[across] = edges[1].min(own[1] + 2.0 * most_m);
            let near = self.beams.near(&beside, COORDINATE_TOLERANCE_M).into_iter().map(|b| self.member(b));
            let mut least = [own[0] - edges[0], edges[1] - own[1]].map(|outstand| outstand.max(0.0));
            for other in near.filter(|o| o.axis == axis && plate.meets(&o.solid)) {
                let gaps = [own[0] - other.solid.max[across], other.solid.min[across] - own[1]];
                for (least, gap) in
                    least.iter_mut().zip(gaps).filter(|(_, gap)| *gap > COORDINATE_TOLERANCE_M)
                {
                    *least = least.min(0.5 * gap);
                }
            }
            least
        };
        plate.stretches(axis, range, own).iter().map(|s| (s.share, outstands(s))).collect()
    }

    /// One diaphragm for each set of plates that share a node.
    fn diaphragms(&self, plates: &[Plate]) -> Vec<Diaphragm> {
        let mut sets = UnionFind::new(self.nodes.len());
        let mut in_plate = BTreeSet::new();
        for plate in plates {
            let nodes = self.nodes_of(plate);
            nodes.windows(2).for_each(|pair| {
                sets.union(pair[0], pair[1]);
            });
            in_plate.extend(nodes);
        }
        let shared = groups(&sets, in_plate).into_iter().filter(|nodes| nodes.len() > 1);
        shared.map(|nodes| Diaphragm { nodes }).collect()
    }

    /// Nodes of the beams, strips and joints that a plate meets, without repetition.
    fn nodes_of(&self, plate: &Plate) -> Vec<usize> {
        let mut nodes: Vec<usize> = self.joints_at(plate).iter().map(|j| self.joints[*j].node).collect();
        for span in self.carriers(plate) {
            nodes.extend(self.spans[span].nodes.iter().map(|(_, node)| *node));
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Spans that carry a plate: beams that it meets and its own strips.
    fn carriers(&self, plate: &Plate) -> Vec<usize> {
        let carries = |span: &Span| {
            plate.slabs.contains(&span.member)
                || (self.member(span.member).kind == MemberKind::Beam
                    && plate.meets(&self.member(span.member).solid))
        };
        (0..self.spans.len()).filter(|s| carries(&self.spans[*s])).collect()
    }

    /// Joints whose columns and walls overlap a plate in plan or bear it at an edge, where it ends at their faces, and whose block meets it in height.
    fn joints_at(&self, plate: &Plate) -> Vec<usize> {
        let meets = |joint: &Joint| {
            joint.uprights.iter().any(|u| {
                let mut block = self.member(*u).solid;
                block.min[2] = joint.range_m[0];
                block.max[2] = joint.range_m[1];
                plate.meets(&block) || plate.abuts(&block)
            })
        };
        (0..self.joints.len()).filter(|j| meets(&self.joints[*j])).collect()
    }

    /// Columns and walls under plates that rest on beams or strips, none of which comes to their joints.
    fn left_out(&self, plates: &[Plate]) -> Vec<String> {
        let mut found = BTreeSet::new();
        for plate in plates {
            let borne_at = self.seats(&self.carriers(plate));
            let joints = self.joints_at(plate);
            let lone = joints
                .iter()
                .map(|j| &self.joints[*j])
                .filter(|joint| !borne_at.is_empty() && !borne_at.contains(&joint.node));
            let tops = lone.flat_map(|joint| &joint.ends).map(|e| &self.structure.ends[*e]);
            found.extend(tops.filter(|e| e.end == End::High && self.left(e.member)).map(|e| e.member));
        }
        found.into_iter().map(|m| self.member(m).id.clone()).collect()
    }

    /// Nodes of some spans.
    fn seats(&self, spans: &[usize]) -> BTreeSet<usize> {
        spans.iter().flat_map(|s| &self.spans[*s].nodes).map(|(_, node)| *node).collect()
    }

    /// A support named for a slab clamps the joints in it.
    fn clamp_slabs(&mut self) {
        let held = self.structure.supports().map(|s| s.member);
        let slabs: Vec<usize> = held.filter(|m| self.member(*m).kind == MemberKind::Slab).collect();
        for slab in slabs {
            let alone = Plate { slabs: vec![slab], solids: vec![self.member(slab).solid] };
            for joint in self.joints_at(&alone) {
                self.nodes[self.joints[joint].node].fixed = [true; 6];
            }
        }
    }

    /// Cuts the spans into elements.
    fn finish(self, diaphragms: Vec<Diaphragm>) -> Idealised {
        let mut elements = Vec::new();
        let mut ends = vec![None; self.structure.ends.len()];
        for span in &self.spans {
            let first = elements.len();
            for pair in span.nodes.windows(2) {
                let [(from, a), (to, b)] = [pair[0], pair[1]];
                elements.push(Element {
                    member: span.name.clone(),
                    nodes: [a, b],
                    ends_m: [span.point(from), span.point(to)],
                    axis1: span.axis1,
                    section: span.section,
                    loads: loads::on_stretch(&span.loads, from, to),
                });
            }
            if let Some([low, high]) = span.ends {
                ends[low] = Some((first, 0));
                ends[high] = Some((elements.len() - 1, 1));
            }
        }
        let left: Vec<_> = self.structure.members().filter(|m| self.left(m.index)).map(|m| &m.mass).collect();
        let gravity = self.building.settings.gravity_m_s2;
        let weight_n = left.iter().map(|m| m.mass_kg).sum::<f64>() * gravity - self.aside_n;
        let moment_nm = |k: usize| {
            left.iter().map(|m| m.mass_kg * m.center_m[k]).sum::<f64>() * gravity - self.aside_moment_nm[k]
        };
        let center_m = [0, 1].map(|k| moment_nm(k) / weight_n);
        let frame = Frame { nodes: self.nodes, elements, diaphragms };
        let by_slab = self.by_slab.iter().map(|m| self.building.members[*m].id.clone()).collect();
        Idealised { frame, ends, weight_n, center_m, unplaced: self.unplaced, left_out: Vec::new(), by_slab }
    }

    fn upright(&self, member: usize) -> bool {
        is_upright(self.member(member))
    }
}
