//! Strips of plates between aligned columns that no beam joins: the flat slab as a grillage. Columns which neither a beam nor such a
//! strip comes to have skew strips to their neighbours, in the sense of Gabriel and Sokal (Systematic Zoology 18, 1969): no third column stands in the circle
//! over the line between the two. Strips that cross each other or a beam bear each other.

use super::plates::Plate;
use super::{Builder, Span};
use crate::base::geom::Aabb;
use crate::building::MemberKind;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::graph::frame::BeamSection;
use std::collections::{BTreeMap, BTreeSet};

impl Builder<'_> {
    /// Adds the strips of all plates.
    pub(super) fn add_strips(&mut self, plates: &[Plate]) {
        for plate in plates {
            let joints = self.joints_at(plate);
            let mut bars_at: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
            for (index, span) in self.spans.iter().enumerate() {
                if !self.upright(span.member) && !plate.slabs.contains(&span.member) {
                    span.nodes.iter().for_each(|(_, node)| bars_at.entry(*node).or_default().push(index));
                }
            }
            for axis in [0, 1] {
                for &from in &joints {
                    if let Some(to) = self.next_aligned(&joints, from, axis) {
                        let strip = self.strip(plate, &joints, [from, to], (axis, &bars_at));
                        self.spans.extend(strip);
                    }
                }
            }
            self.add_skew_strips(plate, &joints);
            self.cross(plate);
        }
        self.drop_loose_strips();
    }

    /// Makes one node where a strip crosses another one or a beam on its way: they bear each other there.
    fn cross(&mut self, plate: &Plate) {
        let carriers = self.carriers(plate);
        // all strips come after the beams
        let strips: Vec<usize> = carriers.iter().copied().filter(|c| self.spans[*c].ends.is_none()).collect();
        for &a in &strips {
            for &b in carriers.iter().take_while(|b| **b < a) {
                if let Some([at_a, at_b]) = crossing(&self.spans[a], &self.spans[b]) {
                    let node = self.node_on(a, at_a);
                    self.seat(b, at_b, node);
                }
            }
        }
        for span in carriers {
            self.spans[span].nodes.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    /// Takes strips away that hang together with nothing that is held, such as those between two walls that are gone: the plate rests on what else carries it.
    fn drop_loose_strips(&mut self) {
        let parts = self.connected();
        let bars = self.spans.iter().filter(|s| s.ends.is_some());
        let mut kept: BTreeSet<usize> =
            bars.flat_map(|s| &s.nodes).map(|(_, node)| parts.find(*node)).collect();
        kept.extend(
            (0..self.nodes.len()).filter(|n| self.nodes[*n].fixed.contains(&true)).map(|n| parts.find(n)),
        );
        self.spans.retain(|s| {
            s.ends.is_some() || s.nodes.iter().any(|(_, node)| kept.contains(&parts.find(*node)))
        });
    }

    /// Strips from the joints of columns in a plate that are on none of its carriers. Walls have none: what rules learned of demands they learned without.
    fn add_skew_strips(&mut self, plate: &Plate, joints: &[usize]) {
        let seats = self.seats(&self.carriers(plate));
        let (mut lone, mut strips) = (BTreeSet::new(), Vec::new());
        let of_column =
            |j: usize| self.joints[j].uprights.iter().any(|u| self.member(*u).kind == MemberKind::Column);
        let is_lone = |j: &&usize| of_column(**j) && !seats.contains(&self.joints[**j].node);
        for &joint in joints.iter().filter(is_lone) {
            lone.insert(joint);
            let others = joints.iter().filter(|j| !lone.contains(*j));
            let found = others.filter(|j| self.are_neighbours(joints, [joint, **j]));
            strips.extend(found.filter_map(|j| self.skew_strip(plate, joints, [joint, *j])));
        }
        self.spans.extend(strips);
    }

    /// A joint in plan \[m\].
    fn plan(&self, joint: usize) -> [f64; 2] {
        let [x, y, _] = self.nodes[self.joints[joint].node].point_m;
        [x, y]
    }

    /// Whether no third joint is in the circle over the line between two.
    fn are_neighbours(&self, joints: &[usize], [from, to]: [usize; 2]) -> bool {
        let [a, b] = [from, to].map(|j| self.plan(j));
        let inside = |j: &usize| {
            let c = self.plan(*j);
            (0..2).map(|i| (c[i] - a[i]) * (c[i] - b[i])).sum::<f64>() < -COORDINATE_TOLERANCE_M
        };
        !joints.iter().any(inside)
    }

    /// A strip between any two joints; none where there is no slab between their columns and walls.
    fn skew_strip(&self, plate: &Plate, joints: &[usize], pair: [usize; 2]) -> Option<Span> {
        if !plate.joins(pair.map(|j| self.plan(j))) {
            return None;
        }
        let away = |i: usize| (self.plan(pair[1])[i] - self.plan(pair[0])[i]).abs();
        let long = usize::from(away(1) > away(0));
        let clear = |axis: usize| {
            let [a, b] = pair.map(|j| self.footprint(j));
            let (ends, range) = if a.max[axis] < b.min[axis] {
                (pair, [a.max[axis], b.min[axis]])
            } else {
                ([pair[1], pair[0]], [b.max[axis], a.min[axis]])
            };
            (range[1] > range[0] + COORDINATE_TOLERANCE_M).then_some((axis, ends, range))
        };
        let (axis, ends, range) = clear(long).or_else(|| clear(1 - long))?;
        let [from, to] = ends.map(|j| self.plan(j));
        let across = 1 - axis;
        let skew = (to[across] - from[across]) / (to[axis] - from[axis]);
        let slab = plate.most_of(&area(from, to));
        let mut line = self.member(slab).solid.center();
        (line[0], line[1]) = (from[0], from[1]);
        let stretch = libm::hypot(skew, 1.0);
        let aside = |p: [f64; 2]| (p[across] - from[across] - skew * (p[axis] - from[axis])) / stretch;
        let corners: Vec<f64> = plate.solids.iter().flat_map(corners).map(aside).collect();
        let edges =
            [f64::min as fn(f64, f64) -> f64, f64::max].map(|pick| corners.iter().copied().fold(0.0, pick));
        let width_m = width_m(edges, joints.iter().map(|j| aside(self.plan(*j))));
        let place = Place { axis, line, skew, range, width_m };
        Some(self.strip_at(slab, &place, ends.map(|j| self.joints[j].node)))
    }

    /// Bounding box of a joint's columns and walls.
    fn footprint(&self, joint: usize) -> Aabb {
        let solids = self.joints[joint].uprights.iter().map(|u| self.member(*u).solid);
        solids.reduce(Aabb::around).unwrap_or(Aabb { min: [0.0; 3], max: [0.0; 3] })
    }

    /// The nearest joint further along an axis whose footprint overlaps across it.
    fn next_aligned(&self, joints: &[usize], from: usize, axis: usize) -> Option<usize> {
        let (across, here) = (1 - axis, self.footprint(from));
        joints
            .iter()
            .copied()
            .filter(|&j| {
                let there = self.footprint(j);
                there.min[axis] > here.max[axis] + COORDINATE_TOLERANCE_M
                    && there.min[across] < here.max[across] - COORDINATE_TOLERANCE_M
                    && there.max[across] > here.min[across] + COORDINATE_TOLERANCE_M
            })
            .min_by(|a, b| self.footprint(*a).min[axis].total_cmp(&self.footprint(*b).min[axis]))
    }

    /// A strip between two joints unless a beam joins them, or no plate does.
    fn strip(
        &self,
        plate: &Plate,
        joints: &[usize],
        [from, to]: [usize; 2],
        (axis, bars_at): (usize, &BTreeMap<usize, Vec<usize>>),
    ) -> Option<Span> {
        let nodes = [from, to].map(|j| self.joints[j].node);
        let [at_from, at_to] = nodes.map(|n| bars_at.get(&n));
        let joined = at_from.zip(at_to).is_some_and(|(a, b)| a.iter().any(|span| b.contains(span)));
        if joined {
            return None;
        }
        let across = 1 - axis;
        let place = |j: usize| self.nodes[self.joints[j].node].point_m[across];
        let at = 0.5 * (place(from) + place(to));
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for other in joints.iter().map(|j| place(*j)) {
            let half = 0.5 * (at + other);
            if other < at - COORDINATE_TOLERANCE_M {
                low = low.max(half);
            } else if other > at + COORDINATE_TOLERANCE_M {
                high = high.min(half);
            }
        }
        let feet = [from, to].map(|j| self.footprint(j));
        let range = [feet[0].max[axis], feet[1].min[axis]];
        let low_side = feet[0].min[across].max(feet[1].min[across]);
        let common = [low_side, feet[0].max[across].min(feet[1].max[across])];
        let mut width_m = 0.0;
        for stretch in plate.stretches(axis, range, common) {
            let edges = stretch.edges_m?;
            width_m += stretch.share * (edges[1].min(high) - edges[0].max(low)).max(0.0);
        }
        let corner =
            |end: usize| if axis == 0 { [range[end], common[end]] } else { [common[end], range[end]] };
        let slab = plate.most_of(&area(corner(0), corner(1)));
        let mut line = self.member(slab).solid.center();
        line[across] = at;
        let place = Place { axis, line, skew: 0.0, range, width_m };
        Some(self.strip_at(slab, &place, nodes))
    }

    /// A strip of a slab between two nodes.
    fn strip_at(&self, slab: usize, place: &Place, nodes: [usize; 2]) -> Span {
        let (member, range) = (self.member(slab), place.range);
        let law = self.building.law_of(member);
        let size = [place.width_m, member.solid.size()[2]];
        Span {
            member: slab,
            name: member.id.clone(),
            axis: place.axis,
            line: place.line,
            skew: place.skew,
            range,
            axis1: if place.axis == 0 { [0.0, 1.0, 0.0] } else { [-1.0, 0.0, 0.0] },
            section: BeamSection::rectangle(law.youngs_modulus_pa, law.poisson_ratio, size),
            ends: None,
            nodes: vec![(range[0], nodes[0]), (range[1], nodes[1])],
            loads: Vec::new(),
        }
    }
}

/// Where a strip lies; see [`Span`].
struct Place {
    axis: usize,
    line: [f64; 3],
    skew: f64,
    range: [f64; 2],
    width_m: f64,
}

/// Where two spans cross in plan within both of them: the coordinates along their axes; none if they are parallel.
fn crossing(a: &Span, b: &Span) -> Option<[f64; 2]> {
    let [a_m, b_m] = [a, b].map(|s| s.range.map(|at| s.point(at)));
    let way = |m: &[[f64; 3]; 2]| [m[1][0] - m[0][0], m[1][1] - m[0][1]];
    let (u, v) = (way(&a_m), way(&b_m));
    let cross = |p: [f64; 2], q: [f64; 2]| p[0] * q[1] - p[1] * q[0];
    let off = [b_m[0][0] - a_m[0][0], b_m[0][1] - a_m[0][1]];
    let area = cross(u, v);
    if area.abs() < COORDINATE_TOLERANCE_M * COORDINATE_TOLERANCE_M {
        return None;
    }
    let shares = [cross(off, v) / area, cross(off, u) / area];
    let at = [a, b].map(|s| s.range);
    let inside = |i: usize| {
        let length = at[i][1] - at[i][0];
        shares[i] * length > COORDINATE_TOLERANCE_M && (1.0 - shares[i]) * length > COORDINATE_TOLERANCE_M
    };
    (inside(0) && inside(1)).then(|| [0, 1].map(|i| at[i][0] + shares[i] * (at[i][1] - at[i][0])))
}

/// The rectangle between two points in plan.
fn area(a: [f64; 2], b: [f64; 2]) -> Aabb {
    Aabb::from_corners([a[0], a[1], 0.0], [b[0], b[1], 0.0])
}

/// Corners of a box in plan \[m\].
pub(super) fn corners(solid: &Aabb) -> [[f64; 2]; 4] {
    let [low, high] = [solid.min, solid.max];
    [[low[0], low[1]], [low[0], high[1]], [high[0], low[1]], [high[0], high[1]]]
}

/// Width about a line of a strip from edge to edge, or as far as halfway to what stands beside it \[m\].
fn width_m([mut low, mut high]: [f64; 2], beside: impl Iterator<Item = f64>) -> f64 {
    for other in beside {
        if other < -COORDINATE_TOLERANCE_M {
            low = low.max(0.5 * other);
        } else if other > COORDINATE_TOLERANCE_M {
            high = high.min(0.5 * other);
        }
    }
    high - low
}
