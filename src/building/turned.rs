//! Boxes turned about the vertical axis: where they are, whether they overlap or touch.

use super::model::Member;
use super::partition::COORDINATE_TOLERANCE_M;
use crate::base::geom::Aabb;

/// Two directions whose sine differs by less than this are parallel.
const PARALLEL: f64 = 1e-9;

/// A box turned about the vertical axis through its centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnedBox {
    /// Centre \[m\].
    pub center_m: [f64; 3],
    /// Half the edges along its own axes \[m\].
    pub half_m: [f64; 3],
    /// Cosine and sine of the angle from the global x axis to its own, about z.
    pub turn: [f64; 2],
}

impl TurnedBox {
    /// The true shape of a member.
    pub fn of(member: &Member) -> Self {
        Self { turn: cosine_and_sine(member.rotation_deg), ..Self::of_box(&member.solid) }
    }

    /// A box that is not turned.
    pub fn of_box(solid: &Aabb) -> Self {
        Self { center_m: solid.center(), half_m: solid.size().map(|s| 0.5 * s), turn: [1.0, 0.0] }
    }

    /// Its own two horizontal axes, in the global x and y.
    fn axes(&self) -> [[f64; 2]; 2] {
        let [c, s] = self.turn;
        [[c, s], [-s, c]]
    }

    /// A global point from the centre, along its own axes \[m\].
    pub fn to_local(&self, point_m: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|i| point_m[i] - self.center_m[i]);
        let [a, b] = self.axes().map(|e| e[0] * from[0] + e[1] * from[1]);
        [a, b, from[2]]
    }

    /// The way back of [`Self::to_local`].
    pub fn to_global(&self, local_m: [f64; 3]) -> [f64; 3] {
        let [a, b] = self.axes();
        let turned =
            [local_m[0] * a[0] + local_m[1] * b[0], local_m[0] * a[1] + local_m[1] * b[1], local_m[2]];
        std::array::from_fn(|i| self.center_m[i] + turned[i])
    }

    /// Direction of one of its own axes in global coordinates.
    pub fn direction(&self, axis: usize) -> [f64; 3] {
        let [a, b] = self.axes();
        [[a[0], a[1], 0.0], [b[0], b[1], 0.0], [0.0, 0.0, 1.0]][axis]
    }

    /// The four corners in plan \[m\].
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|s| {
            let p = self.to_global([s[0] * self.half_m[0], s[1] * self.half_m[1], 0.0]);
            [p[0], p[1]]
        })
    }

    /// The smallest axis-aligned box around it.
    pub fn bounds(&self) -> Aabb {
        let [c, s] = self.turn.map(f64::abs);
        let reach = [
            c * self.half_m[0] + s * self.half_m[1],
            s * self.half_m[0] + c * self.half_m[1],
            self.half_m[2],
        ];
        Aabb {
            min: std::array::from_fn(|i| self.center_m[i] - reach[i]),
            max: std::array::from_fn(|i| self.center_m[i] + reach[i]),
        }
    }

    /// Gap between two boxes along a horizontal unit vector; negative: overlap \[m\].
    fn gap_along(&self, other: &Self, e: [f64; 2]) -> f64 {
        let reach = |b: &Self| {
            b.axes().iter().zip(b.half_m).map(|(a, h)| h * (a[0] * e[0] + a[1] * e[1]).abs()).sum::<f64>()
        };
        let between: f64 = (0..2).map(|i| (other.center_m[i] - self.center_m[i]) * e[i]).sum();
        between.abs() - reach(self) - reach(other)
    }

    /// Gaps along z and along the own axes of both, the candidates for a separating axis (Gottschalk, Lin, Manocha 1996): for boxes with a common
    /// vertical axis there are no others.
    fn gaps_m(&self, other: &Self) -> [f64; 5] {
        let z = (other.center_m[2] - self.center_m[2]).abs() - self.half_m[2] - other.half_m[2];
        let ([a, b], [c, d]) = (self.axes(), other.axes());
        [
            z,
            self.gap_along(other, a),
            self.gap_along(other, b),
            self.gap_along(other, c),
            self.gap_along(other, d),
        ]
    }

    /// The largest gap along a separating axis \[m\]: positive if the boxes are apart (a lower bound of their distance), negative if they overlap.
    pub fn separation_m(&self, other: &Self) -> f64 {
        self.gaps_m(other).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether they have a common volume.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.separation_m(other) < -COORDINATE_TOLERANCE_M
    }

    /// Whether they overlap or share a face with an area. A corner or an edge on a face is no contact.
    pub fn touches(&self, other: &Self) -> bool {
        let tolerance = COORDINATE_TOLERANCE_M;
        let [z, a, b, c, d] = self.gaps_m(other);
        let plan = a.max(b).max(c).max(d);
        if z.max(plan) > tolerance {
            return false;
        }
        let [p, q] = [self.turn, other.turn];
        let (cosine, sine) = (p[0] * q[0] + p[1] * q[1], p[0] * q[1] - p[1] * q[0]);
        let parallel = sine.abs().min(cosine.abs()) < PARALLEL;
        plan < -tolerance || z < -tolerance && parallel && a.min(b) < -tolerance
    }

    /// Whether a point lies inside or within `tolerance` of it \[m\].
    pub fn contains(&self, point_m: [f64; 3], tolerance: f64) -> bool {
        self.to_local(point_m).iter().zip(self.half_m).all(|(c, h)| c.abs() <= h + tolerance)
    }
}

/// Exact at multiples of 90 degrees.
fn cosine_and_sine(degrees: f64) -> [f64; 2] {
    let whole = degrees.rem_euclid(360.0);
    for (angle, turn) in [(0.0, [1.0, 0.0]), (90.0, [0.0, 1.0]), (180.0, [-1.0, 0.0]), (270.0, [0.0, -1.0])] {
        if whole == angle {
            return turn;
        }
    }
    let (sine, cosine) = degrees.to_radians().sin_cos();
    [cosine, sine]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turned(center_m: [f64; 3], half_m: [f64; 3], degrees: f64) -> TurnedBox {
        TurnedBox { center_m, half_m, turn: cosine_and_sine(degrees) }
    }

    #[test]
    fn a_turned_square_reaches_by_its_diagonal() {
        let square = turned([0.0; 3], [1.0, 1.0, 1.0], 45.0);
        assert!((square.bounds().max[0] - 2.0_f64.sqrt()).abs() < 1e-12);
        // The bounds of both overlap; the boxes do not: the corner of the second is cut off by the face of the first.
        let other = turned([1.9, 1.9, 0.0], [1.0, 1.0, 1.0], 0.0);
        let corner = 2.0_f64.sqrt() * 0.9 - 1.0;
        assert!((square.separation_m(&other) - corner).abs() < 1e-12);
        assert!(square.bounds().intersection(&other.bounds(), 1e-9).is_some() && !square.touches(&other));
    }

    #[test]
    fn contact_needs_an_area() {
        let base = turned([0.0; 3], [1.0, 1.0, 1.0], 0.0);
        let beside = |angle: f64, x: f64| turned([x, 0.0, 0.0], [1.0, 1.0, 1.0], angle);
        assert!(base.touches(&beside(0.0, 2.0)) && base.touches(&beside(90.0, 2.0)));
        assert!(!base.touches(&beside(45.0, 1.0 + 2.0_f64.sqrt())), "an edge on a face");
        assert!(base.touches(&beside(45.0, 2.3)) && base.overlaps(&beside(45.0, 2.3)));
        assert!(base.touches(&turned([0.0, 0.0, 2.0], [1.0, 1.0, 1.0], 30.0)), "on top");
        assert!(!base.overlaps(&turned([0.0, 0.0, 2.0], [1.0, 1.0, 1.0], 30.0)));
        assert!(!base.touches(&turned([2.0, 0.0, 2.0], [1.0, 1.0, 1.0], 0.0)), "an edge on an edge");
    }

    #[test]
    fn local_and_global() {
        let b = turned([3.0, -1.0, 2.0], [1.0, 2.0, 3.0], 33.0);
        let local = b.to_local([0.4, 0.2, 5.0]);
        let back = b.to_global(local);
        assert!((0..3).all(|i| (back[i] - [0.4, 0.2, 5.0][i]).abs() < 1e-14));
        assert_eq!(cosine_and_sine(-90.0), [0.0, -1.0]);
    }
}
