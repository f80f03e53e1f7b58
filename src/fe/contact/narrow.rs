//! Where a node stands over a quadrilateral face.

use crate::base::vector::{V3, add, cross, dot, scale, sub};
use serde::{Deserialize, Serialize};

/// How far beyond its edge a face still holds a node, in its own coordinates -1..1: round-off only.
const EDGE: f64 = 1e-6;
/// Newton iterations for the position within a face; a parallelogram takes one.
const ITERATIONS: usize = 8;

/// A node over a face.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Over {
    /// Height above the face along its normal \[m\], negative behind it.
    pub gap_m: f64,
    /// Weights of the corners at the foot of the perpendicular; they sum to one.
    pub weights: [f64; 4],
    /// Unit normal of the face: of its two diagonals.
    pub normal: V3,
}

/// Area times unit normal of a face \[m²\]: half the cross product of its diagonals.
pub fn area_normal(p: &[V3; 4]) -> V3 {
    scale(0.5, cross(sub(p[2], p[0]), sub(p[3], p[1])))
}

/// Foot of the perpendicular from `x` on a bilinear face, along the normal of its diagonals, so that the force along the
/// normal and its reaction at the corners lie on one line: angular momentum is kept. `None` if the foot
/// lies beyond the edges, or the gap outside `-depth_m..=reach_m`.
pub fn over(p: &[V3; 4], x: V3, depth_m: f64, reach_m: f64) -> Option<Over> {
    let area = area_normal(p);
    let size = dot(area, area).sqrt();
    if size.is_nan() || size <= 0.0 {
        return None;
    }
    let normal = scale(1.0 / size, area);
    let middle = scale(0.25, add(add(p[0], p[1]), add(p[2], p[3])));
    let from = sub(x, middle);
    // patterns of the corner coordinates: along ξ, along η, twist
    let a = scale(0.25, sub(add(p[1], p[2]), add(p[0], p[3])));
    let b = scale(0.25, sub(add(p[2], p[3]), add(p[0], p[1])));
    let c = scale(0.25, sub(add(p[0], p[2]), add(p[1], p[3])));
    let (height, warp) = (dot(from, normal), dot(c, normal));
    if height > reach_m + warp.abs() || height < -depth_m - warp.abs() {
        return None;
    }
    let e1 = scale(1.0 / dot(a, a).sqrt(), sub(a, scale(dot(a, normal), normal)));
    let e2 = cross(normal, e1);
    let plane = |v: V3| [dot(v, e1), dot(v, e2)];
    let (from, a, b, c) = (plane(from), plane(a), plane(b), plane(c));
    let (mut s, mut t) = (0.0, 0.0);
    for _ in 0..ITERATIONS {
        let rest: [f64; 2] = std::array::from_fn(|i| from[i] - s * a[i] - t * b[i] - s * t * c[i]);
        let (ds, dt): ([f64; 2], [f64; 2]) =
            (std::array::from_fn(|i| a[i] + t * c[i]), std::array::from_fn(|i| b[i] + s * c[i]));
        let det = ds[0] * dt[1] - ds[1] * dt[0];
        let (step_s, step_t) =
            ((rest[0] * dt[1] - rest[1] * dt[0]) / det, (ds[0] * rest[1] - ds[1] * rest[0]) / det);
        if !(step_s.is_finite() && step_t.is_finite()) || step_s.abs() + step_t.abs() > 1e3 {
            return None;
        }
        s += step_s;
        t += step_t;
        if step_s.abs() + step_t.abs() < 1e-10 {
            break;
        }
    }
    if s.abs().max(t.abs()) > 1.0 + EDGE {
        return None;
    }
    let gap_m = height - s * t * warp;
    let weights = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[i, j]: [f64; 2]| 0.25 * (1.0 + i * s) * (1.0 + j * t));
    (gap_m <= reach_m && gap_m >= -depth_m).then_some(Over { gap_m, weights, normal })
}

/// Lower bound of the distance of a point from a face \[m\]: to the box around it, or to the slab along its normal.
pub fn clearance_m(p: &[V3; 4], x: V3) -> f64 {
    let area = area_normal(p);
    let normal = scale(1.0 / dot(area, area).sqrt().max(f64::MIN_POSITIVE), area);
    let beyond = |at: &dyn Fn(V3) -> f64| {
        let along = p.map(at);
        let low = along.iter().copied().fold(f64::INFINITY, f64::min);
        let high = along.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        (low - at(x)).max(at(x) - high)
    };
    let axes = (0..3).map(|i| beyond(&|q: V3| q[i])).fold(0.0, f64::max);
    axes.max(beyond(&|q: V3| dot(normal, q)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WARPED: [V3; 4] = [[0.0, 0.0, 0.1], [2.0, 0.0, -0.1], [2.5, 1.0, 0.1], [0.0, 1.0, -0.1]];

    #[test]
    fn foot_and_gap_give_the_node_back() {
        for x in [[0.4, 0.3, 0.05], [1.9, 0.8, -0.2], [0.1, 0.9, 0.3]] {
            let found = over(&WARPED, x, 1.0, 1.0).unwrap();
            let foot = (0..4).fold([0.0; 3], |sum, i| add(sum, scale(found.weights[i], WARPED[i])));
            let back = add(foot, scale(found.gap_m, found.normal));
            assert!((0..3).all(|i| (back[i] - x[i]).abs() < 1e-12), "{x:?}: {found:?}");
            assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn clearance_is_no_more_than_the_distance() {
        for x in [[3.0, 2.0, 1.0], [-1.0, 0.5, 0.0], [1.0, 0.5, -0.7], [1.0, 0.5, 0.02]] {
            let mut nearest = f64::INFINITY;
            for (s, t) in (0..=400).map(|i| (f64::from(i % 20) / 20.0, f64::from(i / 20) / 20.0)) {
                let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
                let at = (0..4).fold([0.0; 3], |sum, i| add(sum, scale(weights[i], WARPED[i])));
                nearest = f64::min(nearest, dot(sub(x, at), sub(x, at)).sqrt());
            }
            let bound = clearance_m(&WARPED, x);
            assert!(bound <= nearest + 1e-12 && bound > 0.5 * nearest - 0.11, "{bound} of {nearest}");
        }
    }

    #[test]
    fn beyond_edge_reach_or_depth_there_is_no_contact() {
        let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        assert!(over(&square, [0.5, 0.5, 0.09], 0.2, 0.1).is_some());
        assert_eq!(over(&square, [0.5, 0.5, 0.11], 0.2, 0.1), None);
        assert_eq!(over(&square, [0.5, 0.5, -0.21], 0.2, 0.1), None);
        assert_eq!(over(&square, [1.01, 0.5, 0.0], 0.2, 0.1), None);
        assert!(over(&square, [1.0, 1.0, 0.0], 0.2, 0.1).is_some(), "a node on a corner is held");
    }
}
