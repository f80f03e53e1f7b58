//! How far the floors of a building move as rigid bodies, out of the record of a study.
//!
//! A floor is known by the tracked points at the tops of its columns and the corners of its slabs. What of their motion no rigid
//! body could do is the error that a model with a rigid floor has at least.

use super::Study;
use super::rotation::rotation;
use crate::building::Building;
use crate::building::partition::Partition;
use crate::building::tracked::tracked_points;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Fewest points by which bending can be told: three always lie in one plane.
const FEWEST: usize = 4;

/// A place and its displacements over time \[m\].
type Point<'a> = ([f64; 3], &'a [[f64; 3]]);
/// A place and its displacement at one time \[m\].
type Moved = (Vector3<f64>, Vector3<f64>);

/// The motion of one floor up to the first ground contact, or to the end if there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FloorMotion {
    /// Storey whose ceiling it is, from 1.
    pub storey: u32,
    /// Root of the sum of squares of the distances to the best rigid motion over that of all displacements.
    pub not_rigid: f64,
}

/// The floors of which enough points are tracked, from below. Points that have become debris by then do not count.
pub fn floors(study: &Study, building: &Building) -> Vec<FloorMotion> {
    let storey_of: BTreeMap<&str, u32> =
        building.members.iter().filter_map(|m| Some((m.id.as_str(), m.storey?))).collect();
    let until = study.facts.first_contact_s.unwrap_or(f64::INFINITY);
    let histories = study.motion.histories();
    let whole = histories.iter().filter(|h| h.debris_s.is_none_or(|time| time > until));
    let history: BTreeMap<&str, _> = whole.map(|h| (h.id.as_str(), h)).collect();
    let mut points = BTreeMap::<u32, Vec<Point>>::new();
    for tracked in tracked_points(building, &Partition::of(building)) {
        let known = storey_of.get(tracked.member.as_str()).zip(history.get(tracked.id.as_str()));
        if let Some((storey, history)) = known {
            points.entry(*storey).or_default().push((tracked.point_m, &history.displacement_m));
        }
    }
    let count = study.motion.times_s().iter().filter(|t| **t <= until).count();
    let motion = |(storey, points): (u32, Vec<Point>)| {
        let not_rigid = (points.len() >= FEWEST).then(|| beside_rigid(&points, count)).flatten()?;
        Some(FloorMotion { storey, not_rigid })
    };
    points.into_iter().filter_map(motion).collect()
}

/// The share of the motion that is none of a rigid body; `None` if nothing moves.
fn beside_rigid(points: &[Point], count: usize) -> Option<f64> {
    let (mut beside, mut all) = (0.0, 0.0);
    for time in 0..count {
        let moved: Vec<Moved> = points
            .iter()
            .filter_map(|(p, u)| u.get(time).map(|u| (Vector3::from(*p), Vector3::from(*u))))
            .collect();
        let middle = |of: &dyn Fn(&Moved) -> Vector3<f64>| {
            moved.iter().map(of).sum::<Vector3<f64>>() / moved.len().max(1) as f64
        };
        let (before, after) = (middle(&|m| m.0), middle(&|m| m.0 + m.1));
        let turn = rotation(moved.iter().map(|(p, u)| (*p, p + u)));
        for (p, u) in &moved {
            beside += (p + u - after - turn * (p - before)).norm_squared();
            all += u.norm_squared();
        }
    }
    (all > 0.0).then(|| (beside / all).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn a_rigid_motion_leaves_nothing_and_a_bent_floor_its_bending() {
        let places = [[0.0, 0.0, 3.0], [6.0, 0.0, 3.0], [0.0, 5.0, 3.0], [6.0, 5.0, 3.0]];
        let turn = Rotation3::from_scaled_axis(Vector3::new(0.2, -0.4, 0.1));
        let rigid = places.map(|p| {
            let q = turn * Vector3::from(p) + Vector3::new(0.3, 0.0, -1.0) - Vector3::from(p);
            [[q.x, q.y, q.z]]
        });
        let points: Vec<Point> = places.iter().zip(&rigid).map(|(p, u)| (*p, &u[..])).collect();
        assert!(beside_rigid(&points, 1).unwrap() < 1e-9);
        // opposite corners up and down by as much: a twist, of which no rigid motion has any part
        let twist = [[[0.0, 0.0, 0.01]], [[0.0, 0.0, -0.01]], [[0.0, 0.0, -0.01]], [[0.0, 0.0, 0.01]]];
        let points: Vec<Point> = places.iter().zip(&twist).map(|(p, u)| (*p, &u[..])).collect();
        assert!((beside_rigid(&points, 1).unwrap() - 1.0).abs() < 1e-3);
    }
}
