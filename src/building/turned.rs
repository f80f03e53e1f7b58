//! Boxes turned out of the axes: where they are, whether they overlap or touch.

use super::inclined::cosine_and_sine;
use super::model::Member;
use super::partition::COORDINATE_TOLERANCE_M;
use crate::base::geom::Aabb;
use crate::base::vector::{cross, dot, norm, unit};

/// Two directions whose sine differs by less than this are parallel.
const PARALLEL: f64 = 1e-9;

/// A box in any direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurnedBox {
    /// Centre \[m\].
    pub center_m: [f64; 3],
    /// Half the edges along its own axes \[m\].
    pub half_m: [f64; 3],
    /// Unit vectors of its own axes, right-handed.
    axes: [[f64; 3]; 3],
}

impl TurnedBox {
    /// The true shape of a member.
    pub fn of(member: &Member) -> Self {
        if let Some(inclined) = &member.inclined {
            let (from, to) = (inclined.from_m, inclined.to_m);
            return Self {
                center_m: std::array::from_fn(|i| 0.5 * (from[i] + to[i])),
                half_m: [inclined.length_m(), inclined.width_m, inclined.depth_m].map(|s| 0.5 * s),
                axes: inclined.axes(),
            };
        }
        Self { axes: about_vertical(member.rotation_deg), ..Self::of_box(&member.solid) }
    }

    /// A box that is not turned.
    pub fn of_box(solid: &Aabb) -> Self {
        Self { center_m: solid.center(), half_m: solid.size().map(|s| 0.5 * s), axes: about_vertical(0.0) }
    }

    /// The same box, longer at both ends along one of its own axes \[m\].
    pub fn longer(mut self, axis: usize, by_m: f64) -> Self {
        self.half_m[axis] += by_m;
        self
    }

    /// A global point from the centre, along its own axes \[m\].
    pub fn to_local(&self, point_m: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|i| point_m[i] - self.center_m[i]);
        self.axes.map(|e| dot(e, from))
    }

    /// The way back of [`Self::to_local`].
    pub fn to_global(&self, local_m: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.axes;
        std::array::from_fn(|i| {
            self.center_m[i] + (local_m[0] * a[i] + local_m[1] * b[i] + local_m[2] * c[i])
        })
    }

    /// Direction of one of its own axes in global coordinates.
    pub fn direction(&self, axis: usize) -> [f64; 3] {
        self.axes[axis]
    }

    /// The four corners in plan of a box that is turned about the vertical axis only \[m\].
    pub fn corners(&self) -> [[f64; 2]; 4] {
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|s| {
            let p = self.to_global([s[0] * self.half_m[0], s[1] * self.half_m[1], 0.0]);
            [p[0], p[1]]
        })
    }

    /// The smallest axis-aligned box around it.
    pub fn bounds(&self) -> Aabb {
        let reach: [f64; 3] =
            std::array::from_fn(|i| self.axes.iter().zip(self.half_m).map(|(e, h)| e[i].abs() * h).sum());
        Aabb {
            min: std::array::from_fn(|i| self.center_m[i] - reach[i]),
            max: std::array::from_fn(|i| self.center_m[i] + reach[i]),
        }
    }

    /// Gap between two boxes along a unit vector; negative: overlap \[m\].
    fn gap_along(&self, other: &Self, e: [f64; 3]) -> f64 {
        let reach = |b: &Self| b.axes.iter().zip(b.half_m).map(|(a, h)| h * dot(*a, e).abs()).sum::<f64>();
        let between: [f64; 3] = std::array::from_fn(|i| other.center_m[i] - self.center_m[i]);
        dot(between, e).abs() - reach(self) - reach(other)
    }

    /// Candidates for a separating axis with the gaps along them \[m\]: the face normals of both and the normals of pairs of edges (Gottschalk,
    /// Lin, Manocha 1996).
    fn gaps(&self, other: &Self) -> Vec<([f64; 3], f64)> {
        let edges = self.axes.iter().flat_map(|a| other.axes.map(|b| cross(*a, b)));
        let normals = edges.filter(|n| norm(*n) > PARALLEL).map(unit);
        let all = self.axes.into_iter().chain(other.axes).chain(normals);
        all.map(|e| (e, self.gap_along(other, e))).collect()
    }

    /// The largest gap along a separating axis \[m\]: positive if the boxes are apart (a lower bound of their distance), negative if they overlap.
    pub fn separation_m(&self, other: &Self) -> f64 {
        self.gaps(other).into_iter().map(|(_, gap)| gap).fold(f64::NEG_INFINITY, f64::max)
    }

    /// Whether they have a common volume.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.separation_m(other) < -COORDINATE_TOLERANCE_M
    }

    /// Whether they overlap or share a face with an area. A corner or an edge on a face is no contact.
    pub fn touches(&self, other: &Self) -> bool {
        let gaps = self.gaps(other);
        if gaps.iter().any(|(_, gap)| *gap > COORDINATE_TOLERANCE_M) {
            return false;
        }
        let meeting = || gaps.iter().filter(|(_, gap)| *gap >= -COORDINATE_TOLERANCE_M).map(|(e, _)| *e);
        let Some(normal) = meeting().next() else { return true };
        let along = |e: [f64; 3]| norm(cross(e, normal)) < PARALLEL;
        meeting().all(along) && [self, other].iter().all(|b| b.axes.iter().any(|e| along(*e)))
    }

    /// Whether a point lies inside or within `tolerance` of it \[m\].
    pub fn contains(&self, point_m: [f64; 3], tolerance: f64) -> bool {
        self.to_local(point_m).iter().zip(self.half_m).all(|(c, h)| c.abs() <= h + tolerance)
    }
}

/// The axes turned about the vertical one.
fn about_vertical(degrees: f64) -> [[f64; 3]; 3] {
    let [c, s] = cosine_and_sine(degrees);
    [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::inclined::Inclined;

    fn turned(center_m: [f64; 3], half_m: [f64; 3], degrees: f64) -> TurnedBox {
        TurnedBox { center_m, half_m, axes: about_vertical(degrees) }
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

    /// Two bars at right angles, each at 45 degrees to the axes, cross at a distance: no face normal tells them apart, the normal of their edges does.
    #[test]
    fn crossing_bars_are_told_apart_by_their_edges() {
        let bar = |to: [f64; 3], roll_deg: f64, z: f64| {
            let inclined =
                Inclined { from_m: to.map(|c| -c), to_m: to, roll_deg, width_m: 0.2, depth_m: 0.2 };
            TurnedBox {
                center_m: [0.0, 0.0, z],
                half_m: [inclined.length_m(), 0.1, 0.1],
                axes: inclined.axes(),
            }
        };
        // rolled by 45 degrees they face each other edge to edge: 0.2 / sqrt 2 from axis to edge each
        let (a, b) = (bar([1.0, 1.0, 0.0], 45.0, 0.0), |z| bar([1.0, -1.0, 0.0], 45.0, z));
        let reach = 0.2 * 2.0_f64.sqrt();
        assert!((a.separation_m(&b(reach + 0.01)) - 0.01).abs() < 1e-12);
        assert!(a.overlaps(&b(reach - 0.01)) && !a.touches(&b(reach)), "an edge on an edge");
        assert!(bar([1.0, 1.0, 0.0], 0.0, 0.0).touches(&bar([1.0, -1.0, 0.0], 0.0, 0.2)), "face on face");
        assert!(a.contains([0.9, 0.9, 0.0], 0.0) && !a.contains([0.9, 0.9, 0.15], 0.0));
        assert!((a.bounds().max[2] - 0.1 * 2.0_f64.sqrt()).abs() < 1e-12);
    }
}
