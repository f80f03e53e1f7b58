//! Solids against solids: bounds that may meet, and the points where two solids do. The only file that knows `parry3d`.

use super::faces::{Face, meetings};
use super::links::axes_about;
use crate::mbs::math::{self, M3, Q, V3};
use crate::mbs::model::Shape;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::partitioning::{Bvh, BvhWorkspace};
use parry3d_f64::query::ContactManifold;
use parry3d_f64::query::details::{
    contact_manifold_convex_ball, contact_manifold_cuboid_cuboid, contact_manifold_pfm_pfm,
};
use parry3d_f64::shape::{Ball, ConvexPolyhedron, Cuboid, PolygonalFeatureMap};

/// A convex solid in a frame of its own.
#[derive(Clone)]
pub enum Solid {
    /// Half edge lengths \[m\].
    Box(V3),
    /// Radius \[m\].
    Ball(f64),
    /// Corners \[m\].
    Hull(Box<ConvexPolyhedron>, Vec<V3>),
}

impl std::fmt::Debug for Solid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Box(half) => write!(f, "Box({half:?})"),
            Self::Ball(radius) => write!(f, "Ball({radius})"),
            Self::Hull(_, corners) => write!(f, "Hull({} corners)", corners.len()),
        }
    }
}

/// Where a frame is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed {
    /// Its origin \[m\].
    pub x: V3,
    /// Its orientation.
    pub q: Q,
    /// The same as a matrix.
    pub r: M3,
}

impl Placed {
    /// At the origin, not turned.
    pub const HERE: Self =
        Self { x: [0.0; 3], q: [1.0, 0.0, 0.0, 0.0], r: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] };

    /// A frame in this one, where this one is.
    #[inline]
    pub fn of(&self, inner: &Self) -> Self {
        Self {
            x: math::add(self.x, math::mul(&self.r, inner.x)),
            q: math::qmul(self.q, inner.q),
            r: math::matmul(&self.r, &inner.r),
        }
    }
}

/// A point where two solids meet or nearly so.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    /// On the first solid, in its frame \[m\].
    pub on_a: V3,
    /// On the second, in its frame \[m\].
    pub on_b: V3,
    /// Distance along the normal, negative in each other \[m\].
    pub gap: f64,
    /// The features that make it.
    pub id: u64,
}

impl Solid {
    /// Half edge lengths of a box \[m\].
    pub fn half(&self) -> Option<V3> {
        match self {
            Self::Box(half) => Some(*half),
            _ => None,
        }
    }

    /// The solid of a shape, and its frame in the body.
    pub fn of(shape: &Shape) -> (Self, Placed) {
        match shape {
            Shape::Box { center_m, half_extents_m, orientation } => {
                let q = math::qunit(orientation.unwrap_or(Placed::HERE.q));
                (Self::Box(*half_extents_m), Placed { x: *center_m, q, r: math::qmat(q) })
            }
            Shape::Sphere { center_m, radius_m } => {
                (Self::Ball(*radius_m), Placed { x: *center_m, ..Placed::HERE })
            }
            Shape::Hull { points_m } => {
                let points: Vec<Vector> = points_m.iter().map(|p| vector(*p)).collect();
                match ConvexPolyhedron::from_convex_hull(&points) {
                    Some(hull) => {
                        let corners = hull.points().iter().map(|p| array(*p)).collect();
                        (Self::Hull(Box::new(hull), corners), Placed::HERE)
                    }
                    None => {
                        let [x, half] = shape.bounds();
                        (Self::Box(half), Placed { x, ..Placed::HERE })
                    }
                }
            }
        }
    }

    /// Largest distance of its points from `from`, a point of its frame \[m\].
    pub fn radius(&self, from: V3) -> f64 {
        match self {
            Self::Box(half) => math::norm(std::array::from_fn(|i| from[i].abs() + half[i])),
            Self::Ball(radius) => math::norm(from) + radius,
            Self::Hull(_, corners) => {
                corners.iter().map(|c| math::norm(math::sub(*c, from))).fold(0.0, f64::max)
            }
        }
    }

    /// Smallest half width, roughly: the length by which motion is small or not \[m\].
    pub fn thickness(&self) -> f64 {
        match self {
            Self::Box(half) => half.iter().copied().fold(f64::INFINITY, f64::min),
            Self::Ball(radius) => *radius,
            Self::Hull(_, corners) => {
                let width = |i: usize| {
                    let (low, high) = corners
                        .iter()
                        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| (l.min(c[i]), h.max(c[i])));
                    0.5 * (high - low)
                };
                width(0).min(width(1)).min(width(2))
            }
        }
    }

    /// Bounds in space \[m\].
    pub fn bounds(&self, at: &Placed) -> [V3; 2] {
        let around = |reach: V3| [math::sub(at.x, reach), math::add(at.x, reach)];
        match self {
            Self::Box(half) => {
                around(std::array::from_fn(|i| (0..3).map(|j| at.r[i][j].abs() * half[j]).sum()))
            }
            Self::Ball(radius) => around([*radius; 3]),
            Self::Hull(_, corners) => {
                let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
                for corner in corners {
                    let p = math::add(at.x, math::mul(&at.r, *corner));
                    for i in 0..3 {
                        bounds[0][i] = bounds[0][i].min(p[i]);
                        bounds[1][i] = bounds[1][i].max(p[i]);
                    }
                }
                bounds
            }
        }
    }

    /// How far it reaches along a direction of unit length from the origin of its frame \[m\].
    pub fn reach(&self, at: &Placed, along: V3) -> f64 {
        let local = math::mul_t(&at.r, along);
        match self {
            Self::Box(half) => (0..3).map(|i| local[i].abs() * half[i]).sum(),
            Self::Ball(radius) => *radius,
            Self::Hull(_, corners) => {
                corners.iter().map(|c| math::dot(*c, local)).fold(f64::NEG_INFINITY, f64::max)
            }
        }
    }

    /// Its points that may lie on a plane with the given normal, in its frame: corners, of a box only those no farther than `within` \[m\] above the
    /// lowest one; the nearest point of a ball.
    pub fn feet(&self, at: &Placed, normal: V3, within: f64, found: &mut Vec<(V3, u64)>) {
        found.clear();
        match self {
            Self::Box(half) => {
                let up = math::mul_t(&at.r, normal);
                let rise: V3 = std::array::from_fn(|i| up[i] * half[i]);
                let lowest: f64 = rise.iter().map(|v| v.abs()).sum();
                let slack = 1e-9 * (half[0] + half[1] + half[2]);
                for c in 0..8_usize {
                    let sign = |i: usize, v: f64| if c >> i & 1 == 0 { -v } else { v };
                    let above = lowest + (sign(0, rise[0]) + sign(1, rise[1]) + sign(2, rise[2]));
                    if above <= within + slack {
                        found.push((std::array::from_fn(|i| sign(i, half[i])), c as u64));
                    }
                }
            }
            Self::Ball(radius) => found.push((math::scale(-radius, math::mul_t(&at.r, normal)), 0)),
            Self::Hull(_, corners) => found.extend(corners.iter().enumerate().map(|(i, c)| (*c, i as u64))),
        }
    }

    fn is_hull(&self) -> bool {
        matches!(self, Self::Hull(..))
    }

    /// Calls `face` with the normal of each face, and how far that is from the origin of the frame \[m\]; a ball has none.
    fn each_face(&self, mut face: impl FnMut(Vector, f64)) {
        match self {
            Self::Box(half) => (0..6).for_each(|k| {
                let mut n = [0.0; 3];
                n[k / 2] = if k % 2 == 0 { 1.0 } else { -1.0 };
                face(vector(n), half[k / 2]);
            }),
            Self::Ball(_) => {}
            Self::Hull(hull, _) => {
                hull.faces().iter().for_each(|f| face(f.normal, self.reach_along(f.normal)));
            }
        }
    }

    /// Calls `visit` with the normal of each face in its frame; a ball has none.
    pub fn each_normal(&self, mut visit: impl FnMut(V3)) {
        self.each_face(|n, _| visit(array(n)));
    }

    /// The face with a corner that reaches farthest along a direction of its frame, and of these the one that looks most along it; a ball has none.
    fn face_towards(&self, along: Vector) -> Option<Face> {
        match self {
            Self::Box(half) => {
                let along = array(along);
                let axis = (0..3).max_by(|i, j| along[*i].abs().total_cmp(&along[*j].abs()))?;
                let (sign, [u, v]) = (along[axis].signum(), [(axis + 1) % 3, (axis + 2) % 3]);
                let corner = |[p, q]: [f64; 2]| {
                    let mut at = [0.0; 3];
                    (at[axis], at[u], at[v]) = (sign * half[axis], p * half[u], q * half[v]);
                    at
                };
                let mut normal = [0.0; 3];
                normal[axis] = sign;
                let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(corner).to_vec();
                Some(Face { corners, normal, id: 2 * axis as u32 + u32::from(sign < 0.0) })
            }
            Self::Ball(_) => None,
            Self::Hull(hull, corners) => {
                let all = hull.vertices_adj_to_face();
                let own = |first: u32, count: u32| &all[first as usize..(first + count) as usize];
                let far = |k: &u32| math::dot(corners[*k as usize], array(along));
                // of faces with a corner that reaches farthest, or next to that
                let farthest = self.reach_along(along) - HIDDEN * self.thickness();
                let faces = hull.faces().iter().enumerate().filter(|(_, f)| {
                    own(f.first_vertex_or_edge, f.num_vertices_or_edges).iter().any(|k| far(k) >= farthest)
                });
                let (id, face) =
                    faces.max_by(|p, q| p.1.normal.dot(along).total_cmp(&q.1.normal.dot(along)))?;
                let own = own(face.first_vertex_or_edge, face.num_vertices_or_edges);
                let corners = own.iter().map(|k| corners[*k as usize]).collect();
                Some(Face { corners, normal: array(face.normal), id: id as u32 })
            }
        }
    }

    /// How far it reaches along a direction of its frame from the origin \[m\].
    fn reach_along(&self, n: Vector) -> f64 {
        self.reach(&Placed::HERE, array(n))
    }

    /// Whether its contact points move over its surface as it turns, so that they are found anew in every step.
    pub fn is_round(&self) -> bool {
        matches!(self, Self::Ball(_))
    }
}

/// Finds the points of two solids; the manifolds are kept as working memory.
#[derive(Default)]
pub struct Finder {
    manifold: ContactManifold<(), ()>,
    aside: ContactManifold<(), ()>,
}

/// Fewest points of two faces on each other.
const FACE_CORNERS: usize = 4;
/// By how much solids with fewer points are moved along the contact, over the thickness of the thinner one, and the same across: where edges of two faces lie on each other to rounding a corner
/// is neither within the other face nor on its edge for parry, and missing.
const ASIDE: [f64; 2] = [1e-6, 0.618];

impl Clone for Finder {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl std::fmt::Debug for Finder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Finder")
    }
}

impl Finder {
    /// Points of two solids that are not farther apart than `reach`, and the normal from the first to the second in both frames
    /// (the second one towards the first). None if they are.
    pub fn find(
        &mut self,
        a: (&Solid, &Placed),
        b: (&Solid, &Placed),
        reach: f64,
        found: &mut Vec<Found>,
    ) -> Option<[V3; 2]> {
        found.clear();
        if let (Solid::Ball(ra), Solid::Ball(rb)) = (a.0, b.0) {
            return balls((*ra, a.1), (*rb, b.1), reach, found);
        }
        let between = pose(a.1).inv_mul(&pose(b.1));
        touch(a.0, b.0, &between, reach, &mut self.manifold);
        let count = self.manifold.points.len();
        if (1..FACE_CORNERS).contains(&count) && !a.0.is_round() && !b.0.is_round() {
            let [_, one, other] = axes_about(array(self.manifold.local_n1));
            let aside = math::axpy(one, ASIDE[1], other);
            let mut near = between;
            near.translation += vector(math::scale(ASIDE[0] * a.0.thickness().min(b.0.thickness()), aside));
            touch(a.0, b.0, &near, reach, &mut self.aside);
            if self.aside.points.len() > count {
                std::mem::swap(&mut self.manifold, &mut self.aside);
            }
        }
        let has_hull = a.0.is_hull() || b.0.is_hull();
        let shift = if has_hull { self.look_from_apart(a.0, b.0, &between, reach) } else { 0.0 };
        let m = &self.manifold;
        let deepest = m.points.iter().map(|p| p.dist - shift).reduce(f64::min);
        if let Some(deepest) = deepest.filter(|_| has_hull) {
            on_faces(a.0, b.0, &between, m.local_n1, reach, found);
            // of what is deeper elsewhere these faces know nothing
            let slack = HIDDEN * a.0.thickness().min(b.0.thickness());
            if found.iter().any(|p| p.gap <= deepest + slack) {
                return Some([array(m.local_n1), array(m.local_n2)]);
            }
            found.clear();
        }
        found.extend(m.points.iter().map(|p| Found {
            on_a: array(p.local_p1),
            on_b: array(p.local_p2),
            gap: p.dist - shift,
            id: u64::from(p.fid1.0) << 32 | u64::from(p.fid2.0),
        }));
        (!found.is_empty()).then(|| [array(m.local_n1), array(m.local_n2)])
    }

    /// Where the faces of two solids that are in each other, or nearly touch, part them better than the normal that parry has found, or it has not seen that they touch, as happens to hulls at next to no distance: finds their points with the
    /// second one moved away until there is one. By how much its gaps are too large \[m\].
    fn look_from_apart(&mut self, a: &Solid, b: &Solid, between: &Pose, reach: f64) -> f64 {
        if a.is_round() || b.is_round() {
            return 0.0;
        }
        let size = a.thickness().min(b.thickness());
        let found = self.manifold.points.iter().map(|p| p.dist).reduce(f64::min);
        if found.is_some_and(|least| least > TOUCHING * size) {
            return 0.0;
        }
        let (n, gap) = widest_of_faces(a, b, between);
        let is_wrong = match found {
            Some(_) => gap_of(a, b, between, self.manifold.local_n1) < gap - HIDDEN * size,
            None => gap <= reach && gap.abs() <= TOUCHING * size,
        };
        if !is_wrong {
            return 0.0;
        }
        let away = TOUCHING * size - gap;
        let mut apart = *between;
        apart.translation += n * away;
        touch(a, b, &apart, reach + away + HIDDEN * size, &mut self.aside);
        if self.aside.points.is_empty() {
            return 0.0;
        }
        std::mem::swap(&mut self.manifold, &mut self.aside);
        away * self.manifold.local_n1.dot(n)
    }
}

/// The points of two faces on each other, for the normal that parry found in the frame of the first, no farther apart than `reach` \[m\]: it takes no more than four corners of a face, and may lose those that lie on edges.
fn on_faces(a: &Solid, b: &Solid, between: &Pose, normal: Vector, reach: f64, found: &mut Vec<Found>) {
    let (of_a, of_b) = (a.face_towards(normal), b.face_towards(between.rotation.inverse() * -normal));
    let (Some(of_a), Some(mut of_b)) = (of_a, of_b) else { return };
    of_b.corners.iter_mut().for_each(|c| *c = array(*between * vector(*c)));
    of_b.normal = array(between.rotation * vector(of_b.normal));
    let back = between.inverse();
    let meetings = meetings(&of_a, &of_b, array(normal), reach);
    found.extend(meetings.iter().map(|m| Found {
        on_a: m.on[0],
        on_b: array(back * vector(m.on[1])),
        gap: m.gap,
        id: m.id,
    }));
}

/// By how much less than the gap along a face, over the thickness of the thinner one, that along the normal of two solids may be; and the distance from which on they are taken as they are found, to which others are moved apart, over the same.
const HIDDEN: f64 = 1e-6;
const TOUCHING: f64 = 1e-4;

/// The gap between two solids along a direction of the frame of the first \[m\].
fn gap_of(a: &Solid, b: &Solid, between: &Pose, n: Vector) -> f64 {
    between.translation.dot(n) - a.reach_along(n) - b.reach_along(between.rotation.inverse() * -n)
}

/// Of the normals of faces of two solids, in the frame of the first and away from it, the one along which they are farthest apart, and how far \[m\].
fn widest_of_faces(a: &Solid, b: &Solid, between: &Pose) -> (Vector, f64) {
    let mut best = (Vector::ZERO, f64::NEG_INFINITY);
    a.each_face(|n, reach| {
        let gap = between.translation.dot(n) - b.reach_along(between.rotation.inverse() * -n) - reach;
        best = if gap > best.1 { (n, gap) } else { best };
    });
    b.each_face(|n, reach| {
        let n = between.rotation * n;
        let gap = -between.translation.dot(n) - a.reach_along(-n) - reach;
        best = if gap > best.1 { (-n, gap) } else { best };
    });
    best
}

/// The manifold of two solids, of which one is no ball.
fn touch(a: &Solid, b: &Solid, between: &Pose, reach: f64, m: &mut ContactManifold<(), ()>) {
    m.clear();
    m.local_n1 = Vector::ZERO;
    match (a, b) {
        (Solid::Ball(_), Solid::Ball(_)) => {}
        (Solid::Box(ha), Solid::Box(hb)) => {
            let [ca, cb] = [ha, hb].map(|h| Cuboid::new(vector(*h)));
            contact_manifold_cuboid_cuboid(between, &ca, &cb, reach, m);
        }
        (Solid::Ball(r), other) => with_ball(&between.inverse(), other, *r, reach, m, true),
        (other, Solid::Ball(r)) => with_ball(between, other, *r, reach, m, false),
        (Solid::Box(h), Solid::Hull(hull, _)) => {
            with_faces(between, &Cuboid::new(vector(*h)), hull.as_ref(), reach, m);
        }
        (Solid::Hull(hull, _), Solid::Box(h)) => {
            with_faces(between, hull.as_ref(), &Cuboid::new(vector(*h)), reach, m);
        }
        (Solid::Hull(first, _), Solid::Hull(second, _)) => {
            with_faces(between, first.as_ref(), second.as_ref(), reach, m);
        }
    }
}

fn with_faces(
    between: &Pose,
    a: &impl PolygonalFeatureMap,
    b: &impl PolygonalFeatureMap,
    reach: f64,
    m: &mut ContactManifold<(), ()>,
) {
    contact_manifold_pfm_pfm(between, a, 0.0, None, b, 0.0, None, reach, m);
}

fn with_ball(
    between: &Pose,
    other: &Solid,
    radius: f64,
    reach: f64,
    m: &mut ContactManifold<(), ()>,
    flipped: bool,
) {
    let ball = Ball::new(radius);
    match other {
        Solid::Box(half) => {
            let cuboid = Cuboid::new(vector(*half));
            contact_manifold_convex_ball(between, &cuboid, &ball, None, None, reach, m, flipped);
        }
        Solid::Hull(hull, _) => {
            contact_manifold_convex_ball(between, hull.as_ref(), &ball, None, None, reach, m, flipped);
        }
        Solid::Ball(_) => {}
    }
}

fn balls(a: (f64, &Placed), b: (f64, &Placed), reach: f64, found: &mut Vec<Found>) -> Option<[V3; 2]> {
    let d = math::sub(b.1.x, a.1.x);
    let distance = math::norm(d);
    let gap = distance - a.0 - b.0;
    if gap > reach {
        return None;
    }
    let normal = if distance > 0.0 { math::scale(1.0 / distance, d) } else { [0.0, 0.0, 1.0] };
    let n = [math::mul_t(&a.1.r, normal), math::scale(-1.0, math::mul_t(&b.1.r, normal))];
    found.push(Found { on_a: math::scale(a.0, n[0]), on_b: math::scale(b.0, n[1]), gap, id: 0 });
    Some(n)
}

/// Up to so many solids all are compared with each other, which takes a third of what a tree does.
const FEW: usize = 128;

/// Bounds of all solids; tells which pairs of them came to overlap.
#[derive(Clone)]
pub enum Broad {
    /// Bounds of few, and which of them were set since the last call.
    Few(Vec<[V3; 2]>, Vec<bool>),
    /// A tree of many.
    Many(Box<(Bvh, BvhWorkspace)>),
}

impl std::fmt::Debug for Broad {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Broad")
    }
}

impl Broad {
    /// Of so many solids.
    pub fn new(count: usize) -> Self {
        if count <= FEW {
            let nowhere = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
            Self::Few(vec![nowhere; count], vec![false; count])
        } else {
            Self::Many(Box::default())
        }
    }

    /// Sets the bounds of a solid; they must not lie within the old ones.
    pub fn set(&mut self, index: usize, bounds: [V3; 2]) {
        match self {
            Self::Few(all, changed) => (all[index], changed[index]) = (bounds, true),
            Self::Many(tree) => {
                let [low, high] = bounds.map(vector);
                tree.0.insert_or_update_partially(Aabb::new(low, high), index as u32, 1e-9);
            }
        }
    }

    /// Calls `meet` for each pair that overlaps and has at least one solid whose bounds were set since the last call.
    pub fn changed_pairs(&mut self, mut meet: impl FnMut(usize, usize)) {
        match self {
            Self::Few(all, changed) => {
                for (a, of_a) in all.iter().enumerate().filter(|(a, _)| changed[*a]) {
                    for (b, of_b) in all.iter().enumerate() {
                        let is_new = b > a || b < a && !changed[b];
                        if is_new && overlap(of_a, of_b) {
                            meet(a, b);
                        }
                    }
                }
                changed.fill(false);
            }
            Self::Many(tree) => {
                let (tree, work) = &mut **tree;
                tree.refit(work);
                tree.traverse_bvtt_single_tree::<true>(work, &mut |a, b| meet(a as usize, b as usize));
                tree.optimize_incremental(work);
            }
        }
    }
}

/// Whether bounds overlap.
pub fn overlap([low_a, high_a]: &[V3; 2], [low_b, high_b]: &[V3; 2]) -> bool {
    // all comparisons are made: none of them can be foretold
    let along = |k: usize| (low_a[k] <= high_b[k]) & (low_b[k] <= high_a[k]);
    along(0) & along(1) & along(2)
}

fn vector(v: V3) -> Vector {
    Vector::new(v[0], v[1], v[2])
}

fn array(v: Vector) -> V3 {
    [v.x, v.y, v.z]
}

fn pose(at: &Placed) -> Pose {
    let [w, x, y, z] = at.q;
    Pose::from_parts(vector(at.x), Rotation::from_xyzw(x, y, z, w))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;
    use std::collections::BTreeSet;

    #[test]
    fn few_solids_and_a_tree_find_the_same_pairs() {
        let count = 60;
        let mut random = Random::of(7);
        let mut both = [Broad::new(count), Broad::Many(Box::default())];
        let mut at: Vec<[V3; 2]> = vec![[[0.0; 3]; 2]; count];
        let mut found = 0;
        for round in 0..40 {
            let moved: Vec<usize> = (0..count).filter(|_| round == 0 || random.share() < 0.3).collect();
            for i in &moved {
                let low: V3 = std::array::from_fn(|_| 10.0 * random.share());
                at[*i] = [low, low.map(|v| v + 0.2 + 2.0 * random.share())];
                both.iter_mut().for_each(|broad| broad.set(*i, at[*i]));
            }
            let [few, many] = both.each_mut().map(|broad| {
                let mut pairs = BTreeSet::new();
                broad.changed_pairs(|a, b| assert!(pairs.insert((a.min(b), a.max(b)))));
                pairs
            });
            let overlaps = |(a, b): &(usize, usize)| overlap(&at[*a], &at[*b]);
            let is_new = |(a, b): &(usize, usize)| moved.contains(a) || moved.contains(b);
            let all = (0..count).flat_map(|b| (0..b).map(move |a| (a, b)));
            let expected: BTreeSet<_> = all.filter(is_new).filter(overlaps).collect();
            assert_eq!(few, expected);
            assert_eq!(many, expected);
            found += few.len();
        }
        assert!(found > 200, "{found}");
    }

    /// Edges of the two faces lie on each other but for less than rounding, and a corner of the lower box on one of them.
    #[test]
    fn faces_with_edges_on_each_other_have_all_their_corners() {
        let half = [0.2; 3];
        let turn = math::qexp([0.0, 0.039, 0.0]);
        for shift in [-3.7e-19, 0.0, 1e-17, 1e-12] {
            let above = Placed { x: [0.058, shift, 0.408], q: turn, r: math::qmat(turn) };
            let mut found = Vec::new();
            let boxes = [(&Solid::Box(half), &Placed::HERE), (&Solid::Box(half), &above)];
            Finder::default().find(boxes[0], boxes[1], 0.02, &mut found).unwrap();
            assert_eq!(found.len(), 4, "{shift}: {found:?}");
        }
    }

    /// Hulls reach as far as the points that they are given by, whatever lies in planes, twice, or inside.
    #[test]
    fn hulls_reach_as_far_as_their_points() {
        let mut random = Random::of(11);
        for round in 0..400 {
            let mut points_m: Vec<V3> = match round % 4 {
                0 => Shape::cuboid([0.0; 3], [0.5, 0.3, 0.2]).corners(),
                1 => (0..24)
                    .flat_map(|k| {
                        let at = std::f64::consts::TAU * f64::from(k) / 24.0;
                        [-0.1, 0.1].map(|z| [0.5 * at.cos(), 0.5 * at.sin(), z])
                    })
                    .collect(),
                2 => (0..12).map(|_| std::array::from_fn(|_| random.share() - 0.5)).collect(),
                _ => (0..6).map(|_| [random.share(), random.share(), 1e-3 * random.share()]).collect(),
            };
            for _ in 0..round % 9 {
                let [p, q] = [0, 1].map(|_| points_m[(random.share() * points_m.len() as f64) as usize]);
                let share = random.share();
                points_m.push(math::axpy(p, share, math::sub(q, p)));
                points_m.push(p);
            }
            let turn = math::qexp(std::array::from_fn(|_| 2.0 * random.share()));
            let turned: Vec<V3> = points_m.iter().map(|p| math::mul(&math::qmat(turn), *p)).collect();
            let (solid, _) = Solid::of(&Shape::Hull { points_m: turned.clone() });
            assert!(matches!(solid, Solid::Hull(..)), "{round}");
            for _ in 0..50 {
                let along: V3 = std::array::from_fn(|_| random.share() - 0.5);
                let along = math::scale(1.0 / math::norm(along), along);
                let most = turned.iter().map(|p| math::dot(*p, along)).fold(f64::NEG_INFINITY, f64::max);
                let found = solid.reach(&Placed::HERE, along);
                assert!((found - most).abs() < 1e-9, "{round}: {found} {most}");
            }
        }
    }
}
