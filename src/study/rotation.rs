//! How far a member has turned against what its end is joined to, out of the kept frames of a run.
//!
//! Both sides of the zone at the end move nearly as rigid bodies: the member from the middle of the zone on, and the parts around the end. The rotation of each is the one that brings the positions of its
//! nodes at the start nearest to those of a frame (Kabsch, Acta Cryst. A32 (1976) 922).

use super::{END_DEPTHS, EndZone, short};
use crate::building::ends::MemberEnd;
use crate::fe::result::FeRun;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;

/// Fewest nodes whose rotation is known.
const FEWEST: usize = 4;
/// Reach of the parts around an end, in section depths.
const AROUND_DEPTHS: f64 = 1.5;

/// Largest rotations of an end \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Up to a time.
    pub until_rad: f64,
    /// Over the whole run.
    pub rad: f64,
}

/// Largest rotations up to `until_s` and over the whole run; `None` without frames, or where too little is left of a side at the end of the run.
pub fn turned(run: &FeRun, dead: &[bool], end: &MemberEnd, until_s: f64) -> Option<Turned> {
    let (mesh, first) = (&run.mesh, run.frames.first()?);
    let lives = |e: &usize| !dead[*e];
    let along = |e: usize| (mesh.center(e)[end.axis] - end.point_m[end.axis]) * end.outward;
    let zone = (END_DEPTHS * end.depth_m).min(0.5 * end.clear_m);
    let own =
        (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part == end.member && along(*e) >= 0.5 * zone);
    let own = nodes(run, own.filter(|e| along(*e) <= 2.0 * zone).filter(lives));
    let near = |e: &usize| {
        let center = mesh.center(*e);
        (0..3).all(|i| (center[i] - end.point_m[i]).abs() <= AROUND_DEPTHS * end.depth_m)
    };
    let others = (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part != end.member);
    let around: Vec<usize> = others.filter(near).collect();
    let is_held = around.is_empty();
    let around = nodes(run, around.into_iter().filter(lives));
    if own.len() < FEWEST || (!is_held && around.len() < FEWEST) {
        return None;
    }
    let mut turned = Turned { until_rad: 0.0, rad: 0.0 };
    for frame in &run.frames {
        let point = |p: [f32; 3]| Vector3::from(p.map(f64::from));
        let of = |set: &[usize]| {
            rotation(set.iter().map(|n| (point(first.nodes_m[*n]), point(frame.nodes_m[*n]))))
        };
        let against = if is_held { Matrix3::identity() } else { of(&around) };
        let relative = of(&own) * against.transpose();
        let angle = (0.5 * (relative.trace() - 1.0)).clamp(-1.0, 1.0).acos();
        turned.rad = turned.rad.max(angle);
        if run.times_s[frame.output] <= until_s {
            turned.until_rad = turned.until_rad.max(angle);
        }
    }
    Some(turned)
}

impl EndZone {
    /// With the rotations.
    pub(super) fn turned(self, turned: Option<Turned>) -> Self {
        Self {
            rotation_before_contact_rad: turned.map(|t| short(t.until_rad)),
            rotation_rad: turned.map(|t| short(t.rad)),
            ..self
        }
    }
}

/// Nodes of elements.
fn nodes(run: &FeRun, elements: impl Iterator<Item = usize>) -> Vec<usize> {
    let all: BTreeSet<usize> = elements.flat_map(|e| run.mesh.elements[e].nodes).collect();
    all.into_iter().collect()
}

/// The rotation that brings the first of each pair of points nearest to the second.
pub(super) fn rotation(pairs: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + Clone) -> Matrix3<f64> {
    let count = pairs.clone().count() as f64;
    let (a, b) = pairs.clone().fold((Vector3::zeros(), Vector3::zeros()), |(a, b), (p, q)| (a + p, b + q));
    let (a, b) = (a / count, b / count);
    let covariance = pairs.fold(Matrix3::zeros(), |sum, (p, q)| sum + (q - b) * (p - a).transpose());
    let svd = covariance.svd(true, true);
    let (Some(u), Some(v)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
    u * mirror * v
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn the_rotation_of_moved_points_is_found() {
        let points = [[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.4, 0.1], [0.4, 0.4, 0.9], [0.1, 0.7, 0.9]];
        let points = points.map(Vector3::from);
        let turn = Rotation3::from_scaled_axis(Vector3::new(0.3, -0.5, 0.8));
        let moved = points.map(|p| turn * p + Vector3::new(2.0, -1.0, 3.0));
        let found = rotation(points.into_iter().zip(moved));
        assert!((found - turn.matrix()).norm() < 1e-12);
    }
}
