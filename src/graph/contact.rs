//! Contact faces between the cells of two members, and gaps that look like a slip of the pen.

use crate::base::geom::Aabb;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use serde::Serialize;
use std::collections::BTreeMap;

/// Gaps below this are reported as near misses \[m\]: wider than a formwork tolerance, narrower than
/// any joint that is meant to be one.
pub const NEAR_MISS_M: f64 = 0.020;

/// A plane contact face, normal to a coordinate axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ContactFace {
    /// Normal axis: 0 = x, 1 = y, 2 = z.
    pub axis: usize,
    /// Direction of the outward normal of the connection's first member along `axis`: 1 or -1.
    pub outward: f64,
    /// Area \[m²\].
    pub area_m2: f64,
    /// Centroid \[m\].
    pub centroid_m: [f64; 3],
    /// Bounding rectangle (flat along `axis`) \[m\].
    pub bounds: Aabb,
    /// Second moments about the centroid with `u = axis + 1`, `v = axis + 2` (cyclic):
    /// `[∫ v² dA, ∫ u² dA, ∫ u v dA]` \[m⁴\].
    pub second_moments_m4: [f64; 3],
}

impl ContactFace {
    /// From disjoint rectangles, given as boxes flat along `axis`.
    pub fn of_rectangles(axis: usize, outward: f64, rectangles: &[Aabb]) -> Self {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let area_of = |r: &Aabb| (r.max[u] - r.min[u]) * (r.max[v] - r.min[v]);
        let mut bounds = rectangles[0];
        let (mut area_m2, mut first) = (0.0, [0.0; 3]);
        for r in rectangles {
            area_m2 += area_of(r);
            for (i, sum) in first.iter_mut().enumerate() {
                *sum += area_of(r) * r.center()[i];
                bounds.min[i] = bounds.min[i].min(r.min[i]);
                bounds.max[i] = bounds.max[i].max(r.max[i]);
            }
        }
        let centroid_m = first.map(|s| s / area_m2);
        let mut second_moments_m4 = [0.0; 3];
        for r in rectangles {
            let (size, at, area) = (r.size(), r.center(), area_of(r));
            let [du, dv] = [at[u] - centroid_m[u], at[v] - centroid_m[v]];
            second_moments_m4[0] += area * (size[v] * size[v] / 12.0 + dv * dv);
            second_moments_m4[1] += area * (size[u] * size[u] / 12.0 + du * du);
            second_moments_m4[2] += area * du * dv;
        }
        Self { axis, outward, area_m2, centroid_m, bounds, second_moments_m4 }
    }
}

/// The rectangles in which two members touch, by `(axis, plane, first member is on the low side)`.
pub type Touching = BTreeMap<(usize, usize, bool), Vec<Aabb>>;

/// All touching pairs `(lower index, higher index)` of a partition.
pub fn touching_pairs(partition: &Partition) -> BTreeMap<(usize, usize), Touching> {
    let count = partition.count();
    let mut pairs: BTreeMap<(usize, usize), Touching> = BTreeMap::new();
    for (cell, owner) in partition.cells() {
        for axis in 0..3 {
            let mut next = cell;
            next[axis] += 1;
            if next[axis] >= count[axis] {
                continue;
            }
            let Some(other) = partition.owner_at(next).filter(|other| *other != owner) else { continue };
            let mut rectangle = partition.cell_box(cell);
            rectangle.min[axis] = rectangle.max[axis];
            let key = (axis, next[axis], owner < other);
            let pair = (owner.min(other), owner.max(other));
            pairs.entry(pair).or_default().entry(key).or_default().push(rectangle);
        }
    }
    pairs
}

/// Two members that do not touch but almost do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NearMiss {
    /// The two member ids.
    pub members: [String; 2],
    /// Axis of the gap: 0 = x, 1 = y, 2 = z.
    pub axis: usize,
    /// Width of the gap \[m\].
    pub gap_m: f64,
    /// Area over which the members face each other \[m²\].
    pub facing_area_m2: f64,
}

/// The near miss of two members that do not touch, from their own boxes: axis, gap \[m\] and facing
/// area \[m²\] of the narrowest gap. What lies inside another member (a column's head under a slab) does not
/// count, which is why gross solids will not do.
pub fn near_miss(a: &[Aabb], b: &[Aabb]) -> Option<(usize, f64, f64)> {
    // of the one with fewer boxes first: a slab has hundreds of times as many as a column
    let around = |boxes: &mut dyn Iterator<Item = &Aabb>| boxes.copied().reduce(Aabb::around);
    let (a, b) = if a.len() <= b.len() {
        let of_a = around(&mut a.iter())?;
        (a.iter().collect::<Vec<_>>(), b.iter().filter(|y| are_near(y, &of_a)).collect::<Vec<_>>())
    } else {
        let of_b = around(&mut b.iter())?;
        (a.iter().filter(|x| are_near(x, &of_b)).collect(), b.iter().collect())
    };
    let mut found: Option<(usize, f64, f64)> = None;
    for (axis, gap, area) in a.iter().flat_map(|x| b.iter().filter_map(|y| facing(x, y))) {
        found = match found {
            Some((old, least, sum)) if axis == old && (gap - least).abs() < COORDINATE_TOLERANCE_M => {
                Some((axis, least, sum + area))
            }
            Some((_, least, _)) if gap > least - COORDINATE_TOLERANCE_M => found,
            _ => Some((axis, gap, area)),
        };
    }
    found
}

/// Two boxes that face each other across a narrow gap: axis, gap \[m\], facing area \[m²\].
fn facing(a: &Aabb, b: &Aabb) -> Option<(usize, f64, f64)> {
    let gap = |i: usize| (a.min[i] - b.max[i]).max(b.min[i] - a.max[i]);
    let axis = (0..3).find(|&i| gap(i) > COORDINATE_TOLERANCE_M)?;
    let others = [(axis + 1) % 3, (axis + 2) % 3];
    let faces = others.iter().all(|&i| gap(i) < -COORDINATE_TOLERANCE_M);
    (faces && gap(axis) < NEAR_MISS_M).then(|| {
        let area = others.map(|i| a.max[i].min(b.max[i]) - a.min[i].max(b.min[i]));
        (axis, gap(axis), area[0] * area[1])
    })
}

/// Whether two gross solids are within the near-miss distance of each other in all directions.
pub fn are_near(a: &Aabb, b: &Aabb) -> bool {
    a.is_nearer(b, NEAR_MISS_M)
}
