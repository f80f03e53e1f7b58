//! How far a member has turned against what its end is joined to, out of the kept frames of a run.
//!
//! Both sides of the zone at the end move nearly as rigid bodies: the member from the middle of the zone on, and the joint behind the end. The rotation of each is the one that brings the positions of its
//! nodes at the start nearest to those of a frame (Kabsch, Acta Cryst. A32 (1976) 922).
//!
//! The joint is what lies behind the end face within the section, and of that the floor if there is one: columns above and below a floor turn against it at ends of their own, and where they break and fall away, a
//! rotation nearest to the positions of both would be one of neither.

use super::{END_DEPTHS, EndZone, short};
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind};
use crate::fe::mesh::Mesh;
use crate::fe::result::FeRun;
use nalgebra::{Matrix3, Vector3};
use std::collections::BTreeSet;

/// Fewest nodes whose rotation is known.
const FEWEST: usize = 4;
/// Reach of the joint behind an end and to its sides, in section depths.
const JOINT_DEPTHS: f64 = 0.5;
/// Differences that are none between coordinates \[m\].
const SAME_M: f64 = 1e-6;

/// Largest rotations of an end \[rad\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turned {
    /// Up to a time.
    pub until_rad: f64,
    /// Over the whole run.
    pub rad: f64,
}

/// Largest rotations of a member end up to `until_s` and over the whole run; `None` without frames, or where too little is left of a side at the end of the run.
pub fn turned(
    building: &Building,
    run: &FeRun,
    dead: &[bool],
    end: &MemberEnd,
    until_s: f64,
) -> Option<Turned> {
    let mesh = &run.mesh;
    let along = |e: usize| (mesh.center(e)[end.axis] - end.point_m[end.axis]) * end.outward;
    let zone = (END_DEPTHS * end.depth_m).min(0.5 * end.clear_m);
    let own =
        (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part == end.member && along(*e) >= 0.5 * zone);
    let own: Vec<usize> = own.filter(|e| along(*e) <= 2.0 * zone).collect();
    let around = joint(building, mesh, end);
    let around = Some(around).filter(|joint| !joint.is_empty());
    folded(run, dead, &[around, Some(own)], end.axis, until_s)
}

/// Largest angles by which bending takes the axis of one of some sets of elements off that of the next one, up to `until_s` and over the whole run; a set that is `None` is held. `None` as for [`turned`].
pub fn folded(
    run: &FeRun,
    dead: &[bool],
    sets: &[Option<Vec<usize>>],
    axis: usize,
    until_s: f64,
) -> Option<Turned> {
    let first = run.frames.first()?;
    let alive = |set: &Vec<usize>| nodes(run, set.iter().copied().filter(|e| !dead[*e]));
    let sets: Vec<Option<Vec<usize>>> = sets.iter().map(|set| set.as_ref().map(alive)).collect();
    if sets.iter().flatten().any(|set| set.len() < FEWEST) {
        return None;
    }
    let mut turned = Turned { until_rad: 0.0, rad: 0.0 };
    for frame in &run.frames {
        let point = |p: [f32; 3]| Vector3::from(p.map(f64::from));
        let of = |set: &Option<Vec<usize>>| match set {
            Some(set) => rotation(set.iter().map(|n| (point(first.nodes_m[*n]), point(frame.nodes_m[*n])))),
            None => Matrix3::identity(),
        };
        let turns: Vec<Matrix3<f64>> = sets.iter().map(of).collect();
        let angle = turns.windows(2).map(|pair| bending(&pair[1], &pair[0], axis)).fold(0.0, f64::max);
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

/// The angle by which bending takes the axis of a member off that of its joint \[rad\]; twist about the axis, which no hinge describes, is left out.
fn bending(member: &Matrix3<f64>, joint: &Matrix3<f64>, axis: usize) -> f64 {
    let (member, joint) = (member.column(axis), joint.column(axis));
    libm::atan2(member.cross(&joint).norm(), member.dot(&joint))
}

/// Elements of the joint behind an end; of a free end those of other members beside it; none if the end is held.
fn joint(building: &Building, mesh: &Mesh, end: &MemberEnd) -> Vec<usize> {
    let reach = JOINT_DEPTHS * end.depth_m + SAME_M;
    let all = || 0..mesh.elements.len();
    let behind = |at: [f64; 3]| (end.point_m[end.axis] - at[end.axis]) * end.outward;
    let is_beside = |e: &usize| {
        let center = mesh.center(*e);
        (0..3).filter(|i| *i != end.axis).all(|i| (center[i] - end.point_m[i]).abs() <= reach)
    };
    let is_behind = |e: &usize| {
        let nearest =
            mesh.elements[*e].nodes.iter().map(|n| behind(mesh.nodes[*n])).fold(f64::INFINITY, f64::min);
        let center = behind(mesh.center(*e));
        center > 0.0 && (center <= reach || nearest <= SAME_M)
    };
    let mut near: Vec<usize> = all().filter(|e| is_beside(e) && is_behind(e)).collect();
    if near.is_empty() {
        let is_other = |e: &usize| mesh.elements[*e].part != end.member;
        near =
            all().filter(|e| is_other(e) && is_beside(e) && behind(mesh.center(*e)).abs() <= reach).collect();
    }
    let is_upright = |e: &usize| {
        matches!(building.members[mesh.elements[*e].part].kind, MemberKind::Column | MemberKind::Wall)
    };
    let floor: Vec<usize> = near.iter().copied().filter(|e| !is_upright(e)).collect();
    if floor.is_empty() { near } else { floor }
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
    use crate::base::tree::Format;
    use crate::building::partition::Partition;
    use crate::building::{self, ends::member_ends};
    use nalgebra::Rotation3;

    #[test]
    fn twist_is_not_bending() {
        let turn = |v: [f64; 3]| *Rotation3::from_scaled_axis(Vector3::from(v)).matrix();
        let joint = turn([0.4, -0.3, 0.2]);
        assert!(bending(&(joint * turn([0.7, 0.0, 0.0])), &joint, 0) < 1e-12);
        let bent = joint * turn([0.0, 0.03, -0.04]) * turn([0.5, 0.0, 0.0]);
        assert!((bending(&bent, &joint, 0) - 0.05).abs() < 1e-12);
    }

    #[test]
    fn the_joint_of_a_beam_is_floor_and_no_column() {
        let building = building::parse(building::EXAMPLE, Format::Toml, "example.toml").unwrap();
        let (mesh, _) = Mesh::of(&building, building.settings.mesh_size_m);
        for end in member_ends(&building, &Partition::of(&building)) {
            let joint = joint(&building, &mesh, &end);
            let is_base = end.axis == 2 && end.point_m[2] < 0.1;
            assert_eq!(joint.is_empty(), is_base, "{}", end.id);
            for e in joint {
                let kind = building.members[mesh.elements[e].part].kind;
                assert!(matches!(kind, MemberKind::Beam | MemberKind::Slab), "{}: {kind:?}", end.id);
            }
        }
    }

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
