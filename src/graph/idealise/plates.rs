//! Floor plates: slabs that meet at their edges at one level bend as one, wherever the plan is cut into rectangles.

use super::{Builder, abut, meet};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::base::sets::groups;
use crate::building::MemberKind;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use petgraph::unionfind::UnionFind;

/// Slabs that bend as one.
pub(super) struct Plate {
    /// Member indices, ascending.
    pub slabs: Vec<usize>,
    /// Their solids \[m\].
    pub solids: Vec<Aabb>,
}

/// A part of a range along an axis over which a plate is as wide everywhere.
pub(super) struct Stretch {
    /// From where to where \[m\].
    pub range_m: [f64; 2],
    /// Its part of the whole range.
    pub share: f64,
    /// Edges of the plate across the axis; none where there is no plate \[m\].
    pub edges_m: Option<[f64; 2]>,
}

impl Builder<'_> {
    /// The plates of the slabs that are left.
    pub(super) fn plates(&self) -> Vec<Plate> {
        let slabs = |m: &usize| self.member(*m).kind == MemberKind::Slab && self.left(*m);
        let slabs: Vec<usize> = (0..self.building.members.len()).filter(slabs).collect();
        let solid = |m: usize| self.member(m).solid;
        let boxes = Boxes::numbered(slabs.iter().map(|m| (*m, solid(*m))));
        let mut sets = UnionFind::new(self.building.members.len());
        for &slab in &slabs {
            let near = boxes.near(&solid(slab), COORDINATE_TOLERANCE_M).into_iter();
            near.filter(|other| is_one(&solid(slab), &solid(*other))).for_each(|other| {
                sets.union(slab, other);
            });
        }
        let plate = |slabs: Vec<usize>| Plate { solids: slabs.iter().map(|m| solid(*m)).collect(), slabs };
        groups(&sets, slabs).into_iter().map(plate).collect()
    }
}

/// Whether two slabs are parts of one plate: as high and as thick, and without a gap between them.
fn is_one(a: &Aabb, b: &Aabb) -> bool {
    let level = |x: f64, y: f64| (x - y).abs() < COORDINATE_TOLERANCE_M;
    level(a.min[2], b.min[2]) && level(a.max[2], b.max[2]) && (abut(a, b) || meet(a, b))
}

impl Plate {
    /// Whether a solid lies on or in it and overlaps it in plan.
    pub fn meets(&self, solid: &Aabb) -> bool {
        self.solids.iter().any(|slab| meet(solid, slab))
    }

    /// Whether it ends at a vertical face of a solid.
    pub fn abuts(&self, solid: &Aabb) -> bool {
        self.solids.iter().any(|slab| abut(solid, slab))
    }

    /// The slab that has most of an area in plan; that with the lowest number of those that have as much.
    pub fn most_of(&self, area: &Aabb) -> usize {
        let common = |slab: &Aabb| -> f64 {
            (0..2).map(|i| (slab.max[i].min(area.max[i]) - slab.min[i].max(area.min[i])).max(0.0)).product()
        };
        let mut best = (0, f64::NEG_INFINITY);
        for (place, own) in self.solids.iter().map(common).enumerate() {
            if own > best.1 + COORDINATE_TOLERANCE_M {
                best = (place, own);
            }
        }
        self.slabs[best.0]
    }

    /// How it lies beside a range along an axis, from the solid part across the axis that a column or a beam takes up \[m\].
    pub fn stretches(&self, axis: usize, range: [f64; 2], from: [f64; 2]) -> Vec<Stretch> {
        let inside =
            |at: &f64| (range[0] + COORDINATE_TOLERANCE_M..range[1] - COORDINATE_TOLERANCE_M).contains(at);
        let mut cuts = vec![range[0], range[1]];
        cuts.extend(self.solids.iter().flat_map(|s| [s.min[axis], s.max[axis]]).filter(inside));
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() < COORDINATE_TOLERANCE_M);
        let length = range[1] - range[0];
        let stretch = |pair: &[f64]| {
            let (range_m, share) = ([pair[0], pair[1]], (pair[1] - pair[0]) / length);
            Stretch { range_m, share, edges_m: self.edges_m(axis, 0.5 * (pair[0] + pair[1]), from) }
        };
        cuts.windows(2).map(stretch).collect()
    }

    /// Its edges across an axis to both sides of what takes up a range there \[m\].
    fn edges_m(&self, axis: usize, at: f64, from: [f64; 2]) -> Option<[f64; 2]> {
        let across = 1 - axis;
        let here = self.solids.iter().filter(|s| s.min[axis] < at && at < s.max[axis]);
        let mut parts: Vec<[f64; 2]> = here.map(|s| [s.min[across], s.max[across]]).collect();
        parts.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut whole: Vec<[f64; 2]> = Vec::new();
        for part in parts {
            match whole.last_mut().filter(|last| part[0] < last[1] + COORDINATE_TOLERANCE_M) {
                Some(last) => last[1] = last[1].max(part[1]),
                None => whole.push(part),
            }
        }
        let touches = |p: &&[f64; 2]| {
            p[0] < from[1] + COORDINATE_TOLERANCE_M && from[0] < p[1] + COORDINATE_TOLERANCE_M
        };
        whole.iter().find(touches).copied()
    }

    /// Whether it reaches without a gap from one point in plan to another, or from the places nearest to them \[m\].
    pub fn joins(&self, ends: [[f64; 2]; 2]) -> bool {
        let [a, b] = ends.map(|p| self.nearest(p));
        let covered: f64 = self.solids.iter().map(|slab| part_inside(slab, a, b)).sum();
        covered > 1.0 - COORDINATE_TOLERANCE_M
    }

    /// The place of it that is nearest to a point in plan \[m\].
    fn nearest(&self, point: [f64; 2]) -> [f64; 2] {
        let within = |s: &Aabb| [0, 1].map(|i| point[i].clamp(s.min[i], s.max[i]));
        let away = |p: &[f64; 2]| libm::hypot(p[0] - point[0], p[1] - point[1]);
        let nearest = self.solids.iter().map(within).min_by(|a, b| away(a).total_cmp(&away(b)));
        nearest.unwrap_or(point)
    }
}

/// Part of a line in plan that lies over a box (Liang and Barsky, ACM Trans. Graph. 3, 1984).
fn part_inside(slab: &Aabb, a: [f64; 2], b: [f64; 2]) -> f64 {
    let (mut from, mut to) = (0.0_f64, 1.0_f64);
    for i in 0..2 {
        let way = b[i] - a[i];
        let sides = [slab.min[i] - a[i], slab.max[i] - a[i]];
        if way == 0.0 {
            if sides[0] > COORDINATE_TOLERANCE_M || sides[1] < -COORDINATE_TOLERANCE_M {
                return 0.0;
            }
            continue;
        }
        let [one, other] = sides.map(|s| s / way);
        from = from.max(one.min(other));
        to = to.min(one.max(other));
    }
    (to - from).max(0.0)
}
