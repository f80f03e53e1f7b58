//! Box against box. The only file that knows `parry3d`.
//!
//! [`separation`] is a cheap lower bound of the distance; [`Manifold`] holds the contact points of a
//! touching pair, matched over time by the features that make them, each with its own history.

use super::contact_law::PointState;
use super::math::{self, M3, Q, V3};
use parry3d_f64::math::{Pose, Rotation, Vector};
use parry3d_f64::query::ContactManifold;
use parry3d_f64::query::details::contact_manifold_cuboid_cuboid;
use parry3d_f64::shape::Cuboid;

/// A box in space.
#[derive(Debug, Clone, Copy)]
pub struct OrientedBox {
    /// Centre \[m\].
    pub center: V3,
    /// Orientation.
    pub q: Q,
    /// The same as a matrix.
    pub r: M3,
    /// Half edge lengths \[m\].
    pub half: V3,
}

/// Largest gap along the six face normals: a lower bound of the distance \[m\], negative if the boxes
/// overlap along all of them.
pub fn separation(a: &OrientedBox, b: &OrientedBox) -> f64 {
    let d = math::sub(b.center, a.center);
    let in_a = math::mul_t(&a.r, d);
    let in_b = math::mul_t(&b.r, d);
    let c = math::matmul(&math::transpose(&a.r), &b.r);
    let mut gap = f64::NEG_INFINITY;
    for i in 0..3 {
        let reach_b = (0..3).map(|j| c[i][j].abs() * b.half[j]).sum::<f64>();
        let reach_a = (0..3).map(|j| c[j][i].abs() * a.half[j]).sum::<f64>();
        gap = gap.max(in_a[i].abs() - a.half[i] - reach_b).max(in_b[i].abs() - b.half[i] - reach_a);
    }
    gap
}

/// Contact points between two boxes.
#[derive(Default)]
pub struct Manifold(ContactManifold<(), PointState>);

impl Clone for Manifold {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl std::fmt::Debug for Manifold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Manifold({} points)", self.0.points.len())
    }
}

/// One contact point.
#[derive(Debug)]
pub struct ContactPoint<'a> {
    /// Half-way between the two surfaces \[m\].
    pub position: V3,
    /// Penetration, positive when the boxes overlap \[m\].
    pub depth: f64,
    /// History of the point.
    pub state: &'a mut PointState,
}

impl Manifold {
    /// Finds the contact points; points with the same features keep their history.
    pub fn update(&mut self, a: &OrientedBox, b: &OrientedBox) {
        let relative = pose(a).inv_mul(&pose(b));
        let [ca, cb] = [a, b].map(|o| Cuboid::new(vector(o.half)));
        contact_manifold_cuboid_cuboid(&relative, &ca, &cb, 0.0, &mut self.0);
    }

    /// Forgets all points.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Whether there is no point.
    pub fn is_empty(&self) -> bool {
        self.0.points.is_empty()
    }

    /// Normal from `a` to `b` in the global frame.
    pub fn normal(&self, a: &OrientedBox) -> V3 {
        let n = self.0.local_n1;
        math::mul(&a.r, [n.x, n.y, n.z])
    }

    /// The points in the global frame.
    pub fn points<'a>(
        &'a mut self,
        a: &'a OrientedBox,
        b: &'a OrientedBox,
    ) -> impl Iterator<Item = ContactPoint<'a>> {
        self.0.points.iter_mut().map(|point| {
            let (p1, p2) = (point.local_p1, point.local_p2);
            let p1 = math::add(a.center, math::mul(&a.r, [p1.x, p1.y, p1.z]));
            let p2 = math::add(b.center, math::mul(&b.r, [p2.x, p2.y, p2.z]));
            ContactPoint {
                position: math::scale(0.5, math::add(p1, p2)),
                depth: -point.dist,
                state: &mut point.data,
            }
        })
    }
}

fn vector(v: V3) -> Vector {
    Vector::new(v[0], v[1], v[2])
}

fn pose(o: &OrientedBox) -> Pose {
    let [w, x, y, z] = o.q;
    Pose::from_parts(vector(o.center), Rotation::from_xyzw(x, y, z, w))
}
