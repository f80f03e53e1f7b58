//! The points in which two faces lie on each other.
//!
//! Faces are convex polygons. Seen along the normal of the contact, the corners of the area that both cover are corners of the one within the other, and places where edges cross.

use super::links::axes_about;
use crate::mbs::math::{self, V3};

/// A face of a solid.
#[derive(Debug, Clone, Default)]
pub(super) struct Face {
    /// Corners, in order around it, in a frame that both solids are seen from \[m\].
    pub corners: Vec<V3>,
    /// Normal of unit length.
    pub normal: V3,
    /// Which one it is of its solid.
    pub id: u32,
}

/// A point on either face, how far it is from the one to the other along the normal \[m\], and the features that make it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meeting {
    pub on: [V3; 2],
    pub gap: f64,
    pub id: u64,
}

/// Cosine of the angle between the normal of a face and that of the contact below which it is seen too much from the side.
const STEEP: f64 = 0.1;
/// Distance from an edge up to which a point is on it, over its length.
const ON_EDGE: f64 = 1e-9;
/// Marks of corners and edges in names of features.
const CORNER: u32 = 1 << 28;
const EDGE: u32 = 2 << 28;

/// The points of two faces no farther apart than `reach` along a normal from the first to the second \[m\]; none if a face is steep.
pub(super) fn meetings(a: &Face, b: &Face, normal: V3, reach: f64) -> Vec<Meeting> {
    let [along_a, along_b] = [a, b].map(|face| math::dot(face.normal, normal));
    if along_a.abs() < STEEP || along_b.abs() < STEEP {
        return Vec::new();
    }
    let [_, one, other] = axes_about(normal);
    let flat = |face: &Face| -> Vec<[f64; 2]> {
        face.corners.iter().map(|c| [math::dot(*c, one), math::dot(*c, other)]).collect()
    };
    let (flat_a, flat_b) = (flat(a), flat(b));
    let name = |of_a: u32, of_b: u32| u64::from(of_a) << 32 | u64::from(of_b);
    let mut found = Vec::new();
    let mut enter = |on_a: V3, on_b: V3, id: u64| {
        let gap = math::dot(math::sub(on_b, on_a), normal);
        if gap <= reach {
            found.push(Meeting { on: [on_a, on_b], gap, id });
        }
    };
    for (i, corner) in a.corners.iter().enumerate().filter(|(i, _)| is_within(flat_a[*i], &flat_b)) {
        let to_plane = math::dot(math::sub(b.corners[0], *corner), b.normal) / along_b;
        enter(*corner, math::axpy(*corner, to_plane, normal), name(CORNER | i as u32, b.id));
    }
    for (j, corner) in b.corners.iter().enumerate().filter(|(j, _)| is_within(flat_b[*j], &flat_a)) {
        let to_plane = math::dot(math::sub(a.corners[0], *corner), a.normal) / along_a;
        enter(math::axpy(*corner, to_plane, normal), *corner, name(a.id, CORNER | j as u32));
    }
    for i in 0..flat_a.len() {
        for j in 0..flat_b.len() {
            let (next_i, next_j) = ((i + 1) % flat_a.len(), (j + 1) % flat_b.len());
            if let Some([s, t]) = crossing([flat_a[i], flat_a[next_i]], [flat_b[j], flat_b[next_j]]) {
                let place = |from: V3, to: V3, share: f64| math::axpy(from, share, math::sub(to, from));
                let on_a = place(a.corners[i], a.corners[next_i], s);
                let on_b = place(b.corners[j], b.corners[next_j], t);
                enter(on_a, on_b, name(EDGE | i as u32, EDGE | j as u32));
            }
        }
    }
    found
}

fn cross(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn away([px, py]: [f64; 2], [qx, qy]: [f64; 2]) -> [f64; 2] {
    [qx - px, qy - py]
}

/// Whether a point is within a convex polygon, or on its edge to rounding.
fn is_within(point: [f64; 2], polygon: &[[f64; 2]]) -> bool {
    let mut sides = [false; 2];
    for (i, from) in polygon.iter().enumerate() {
        let (edge, to) = (away(*from, polygon[(i + 1) % polygon.len()]), away(*from, point));
        let side = cross(edge, to);
        let square = edge[0] * edge[0] + edge[1] * edge[1];
        sides[usize::from(side > 0.0)] |= side.abs() > ON_EDGE * square;
    }
    sides != [true; 2]
}

/// The shares of two stretches at which they cross within both; none if they are parallel.
fn crossing([p, p_end]: [[f64; 2]; 2], [q, q_end]: [[f64; 2]; 2]) -> Option<[f64; 2]> {
    let (u, v, apart) = (away(p, p_end), away(q, q_end), away(p, q));
    let turn = cross(u, v);
    let shares = [cross(apart, v) / turn, cross(apart, u) / turn];
    (turn != 0.0 && shares.iter().all(|s| (0.0..=1.0).contains(s))).then_some(shares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn polygon(n: usize, radius: f64, turn: f64, height: f64, up: f64) -> Face {
        let at = |k: usize| TAU * k as f64 / n as f64 + turn;
        let corners = (0..n).map(|k| [radius * at(k).cos(), radius * at(k).sin(), height]).collect();
        Face { corners, normal: [0.0, 0.0, up], id: 7 }
    }

    /// Faces with all their corners in common, to rounding, meet in each of them.
    #[test]
    fn equal_faces_meet_in_all_corners() {
        for k in 0..200 {
            let turn = 0.037 * f64::from(k);
            let off = 1e-16 * f64::from(k % 5);
            let below = polygon(4, 1.0, turn, 0.0, 1.0);
            let mut above = polygon(4, 1.0, turn, 0.0, -1.0);
            above.corners.iter_mut().for_each(|c| (c[0], c[1]) = (c[0] + off, c[1] - off));
            let found = meetings(&below, &above, [0.0, 0.0, 1.0], 0.01);
            for corner in &below.corners {
                let is_there = |m: &Meeting| (m.on[0][0] - corner[0]).hypot(m.on[0][1] - corner[1]) < 1e-12;
                assert!(found.iter().any(is_there), "{k}: {corner:?} of {found:?}");
            }
        }
    }

    /// A hexagon on a larger one has its own corners; turned by half a side on one of its size, twelve crossings.
    #[test]
    fn hexagons_meet_in_all_their_corners() {
        let table = polygon(6, 1.0, 0.0, 0.0, 1.0);
        let small = meetings(&table, &polygon(6, 0.5, 0.3, 0.01, -1.0), [0.0, 0.0, 1.0], 0.02);
        assert_eq!(small.len(), 6);
        assert!(small.iter().all(|m| (m.gap - 0.01).abs() < 1e-15 && m.on[0][2] == 0.0), "{small:?}");
        let turned = meetings(&table, &polygon(6, 1.0, TAU / 12.0, 0.0, -1.0), [0.0, 0.0, 1.0], 0.02);
        assert_eq!(turned.len(), 12);
        // on a circle between that of the sides and that of the corners
        let radius = |m: &Meeting| m.on[0][0].hypot(m.on[0][1]);
        let expected = (TAU / 12.0).cos() / (TAU / 24.0).cos();
        assert!(turned.iter().all(|m| (radius(m) - expected).abs() < 1e-12), "{turned:?}");
    }

    #[test]
    fn what_is_farther_than_the_reach_or_seen_from_the_side_has_no_points() {
        let table = polygon(6, 1.0, 0.0, 0.0, 1.0);
        assert!(meetings(&table, &polygon(5, 0.5, 0.0, 0.03, -1.0), [0.0, 0.0, 1.0], 0.02).is_empty());
        let upright = Face { normal: [1.0, 0.0, 0.0], ..polygon(5, 0.5, 0.0, 0.0, -1.0) };
        assert!(meetings(&table, &upright, [0.0, 0.0, 1.0], 0.02).is_empty());
    }
}
