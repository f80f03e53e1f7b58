//! Which points of a contact count, of more than a pair can have.
//!
//! A face with many corners rests on those that reach farthest, in as many directions as there may be points, all round alike and always the same ones: a choice by depth changes with every rounding, and one by their order leaves a side without any.

use super::links::axes_about;
use super::pair::MOST_POINTS;
use crate::mbs::math::{self, V3};

/// Drops from a list what does not count: points `of` its items with their heights over the deepest one \[m\], across a normal.
pub(super) fn thin<T>(list: &mut Vec<T>, of: impl Fn(&T) -> (V3, f64), normal: V3, band: f64) {
    let mut kept = kept(list.iter().map(of), normal, band).into_iter();
    list.retain(|_| kept.next() == Some(true));
}

/// Of points with their heights over the deepest one \[m\] which to keep, across a normal: those in a `band` above it, then those that reach farthest in any direction.
fn kept(points: impl Iterator<Item = (V3, f64)>, normal: V3, band: f64) -> Vec<bool> {
    let [_, one, other] = axes_about(normal);
    let points: Vec<([f64; 2], bool)> =
        points.map(|(p, height)| ([math::dot(p, one), math::dot(p, other)], height <= band)).collect();
    let deep = points.iter().filter(|(_, is_deep)| *is_deep).count();
    let mut kept: Vec<bool> = points.iter().map(|(_, is_deep)| *is_deep && deep <= MOST_POINTS).collect();
    let left = MOST_POINTS - if deep <= MOST_POINTS { deep } else { 0 };
    for k in 0..left {
        // from no axis, so that corners of regular polygons do not reach equally far
        let angle = (k as f64 + 0.137) * std::f64::consts::TAU / left as f64;
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let reach = |i: usize| points[i].0[0] * cosine + points[i].0[1] * sine;
        let open = (0..points.len()).filter(|i| !kept[*i] && (points[*i].1 || deep <= MOST_POINTS));
        if let Some(farthest) = open.max_by(|i, j| reach(*i).total_cmp(&reach(*j))) {
            kept[farthest] = true;
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The corners of a regular polygon.
    fn polygon(n: usize) -> Vec<V3> {
        let at = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
        (0..n).map(|k| [at(k).cos(), at(k).sin(), 0.0]).collect()
    }

    /// What is kept of a polygon of 24 corners reaches 0.92 of its radius in all directions, with whatever noise in its depth.
    #[test]
    fn a_round_face_rests_on_points_all_round() {
        let corners = polygon(24);
        let choose = |noise: f64| {
            let heights = (0..24).map(|k| noise * ((7 * k % 24) as f64));
            kept(corners.iter().copied().zip(heights), [0.0, 0.0, 1.0], 1e-6)
        };
        let quiet = choose(0.0);
        assert_eq!(quiet.iter().filter(|k| **k).count(), MOST_POINTS);
        assert_eq!(quiet, choose(1e-9));
        for direction in polygon(360) {
            let reach = |i: &usize| math::dot(corners[*i], direction);
            let farthest = (0..24).filter(|i| quiet[*i]).map(|i| reach(&i)).fold(0.0, f64::max);
            assert!(farthest > 0.92, "{direction:?}: {farthest}");
        }
    }

    /// Of a face that has tilted, its deepest corners are kept.
    #[test]
    fn the_deepest_points_come_first() {
        let corners = polygon(24);
        let heights = corners.iter().map(|c| 0.01 * (1.0 - c[0]));
        let found = kept(corners.iter().copied().zip(heights), [0.0, 0.0, 1.0], 1e-3);
        assert!([23, 0, 1].iter().all(|k| found[*k]), "{found:?}");
        assert_eq!(found.iter().filter(|k| **k).count(), MOST_POINTS);
    }
}
