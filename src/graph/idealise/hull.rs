//! What of a slab reaches beyond all that carries it.
//!
//! The load of a slab goes to the nearest carrier. Between carriers that leaves out a moment about each of them, which
//! its neighbours have the other way round. Beyond all of them nothing stands against it: there the slab is a cantilever, and
//! the moment of its weight about the carrier goes along, as torsion of a span or as a moment on a node. Beyond is what lies outside of the convex
//! hull in plan of the beams and the columns and walls that carry the plate.

use super::Builder;
use super::plates::Plate;
use super::strips::corners;
use crate::base::geom::Aabb;
use crate::building::partition::COORDINATE_TOLERANCE_M;

/// A convex hull in plan.
pub(super) struct Hull {
    /// Its corners, counterclockwise \[m\].
    corners: Vec<[f64; 2]>,
}

impl Hull {
    /// Of solids (monotone chain: Andrew, Inf. Process. Lett. 9, 1979).
    pub fn of(solids: impl Iterator<Item = Aabb>) -> Self {
        // corners that are one to round-off would be an edge of any direction
        let clean = |p: [f64; 2]| p.map(|x| (x / COORDINATE_TOLERANCE_M).round() * COORDINATE_TOLERANCE_M);
        let mut points: Vec<[f64; 2]> = solids.flat_map(|s| corners(&s)).map(clean).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        points.dedup();
        let mut lower = chain(points.iter().copied());
        lower.extend(chain(points.iter().rev().copied()));
        Self { corners: lower }
    }

    /// Whether a point is in it; any is if there are no corners.
    pub fn holds(&self, point: [f64; 2]) -> bool {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).all(|(a, b)| aside_m(*a, *b, point) > -COORDINATE_TOLERANCE_M)
    }

    /// Whether all of a box is in it.
    pub fn contains(&self, cell: &Aabb) -> bool {
        corners(cell).into_iter().all(|corner| self.holds(corner))
    }
}

/// The corners on the right of the way along sorted points, without the last one.
fn chain(points: impl Iterator<Item = [f64; 2]>) -> Vec<[f64; 2]> {
    let mut found: Vec<[f64; 2]> = Vec::new();
    for point in points {
        while let [.., a, b] = found[..]
            && aside_m(a, b, point) <= 0.0
        {
            found.pop();
        }
        found.push(point);
    }
    found.pop();
    found
}

/// How far a point is to the left of the way from one place to another \[m\].
fn aside_m(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> f64 {
    let ([u, v], [x, y]) = ([to[0] - from[0], to[1] - from[1]], [point[0] - from[0], point[1] - from[1]]);
    (u * y - v * x) / libm::hypot(u, v)
}

impl Builder<'_> {
    /// The hull of what carries a plate, and of columns and walls under or on it.
    pub(super) fn hull(&self, plate: &Plate, carriers: &[usize]) -> Hull {
        let seats = self.seats(carriers);
        let joints = self.joints_at(plate).into_iter().map(|j| &self.joints[j]);
        let bears = joints.filter(|j| seats.contains(&j.node) || j.uprights.iter().any(|u| self.left(*u)));
        let uprights = bears.flat_map(|j| &j.uprights).copied();
        let beams = carriers.iter().map(|c| &self.spans[*c]).filter(|s| s.ends.is_some()).map(|s| s.member);
        Hull::of(uprights.chain(beams).map(|m| self.member(m).solid))
    }

    /// The moment about a node of a weight \[N\] that goes to it from a point in plan \[m\].
    pub(super) fn turn(&mut self, node: usize, point: [f64; 2], force: f64) {
        let [x, y, _] = self.nodes[node].point_m;
        self.nodes[node].load[3] -= force * (point[1] - y);
        self.nodes[node].load[4] += force * (point[0] - x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_holds_what_lies_between_and_nothing_beyond() {
        let column = |x: f64, y: f64| Aabb::from_corners([x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, 3.0]);
        // one corner is another one to round-off
        let hull = Hull::of([column(0.0, 0.0), column(6.0, 0.0), column(6.0 + 1e-12, 4.0)].into_iter());
        for inside in [[0.0, 0.0], [-0.2, -0.2], [6.2, 4.2], [6.2, 2.0], [3.0, 2.0], [5.8, 4.2]] {
            assert!(hull.holds(inside), "{inside:?}");
        }
        for beyond in [[-0.3, 0.0], [6.21, 2.0], [0.0, 4.0], [3.0, -0.21]] {
            assert!(!hull.holds(beyond), "{beyond:?}");
        }
        assert!(hull.contains(&column(6.0, 2.0)) && !hull.contains(&column(0.5, 0.5)));
        assert!(Hull::of(std::iter::empty()).holds([1.0, 2.0]));
    }
}
