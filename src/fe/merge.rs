//! Which faces of members become mesh planes, and which are merged with a near one.
//!
//! Faces closer together than [`SNAP_SHARE`] of the target size become one plane, in order of [`hold`], and of equals the outer one. In a coarse mesh that alone would merge the two
//! faces of a member with each other, or its face with that of the member it lies under: the member would be without elements. So a face is kept after all, one
//! at a time, where a member is left with less than half or more than twice its volume or one of its lengths ([`MOST_CHANGE`]). Kept faces are never given up again, and
//! with all of them the planes are those of the building itself, so that every member has elements at any target size. Faces of a gap are kept as well, if one of the members beside
//! it is to have finer elements (`[[mesh.refine]]`) and the gap is wider than that share of their size; without it the mesh is refused ([`super::weld`]).

use super::grid::SNAP_SHARE;
use super::weld::are_apart;
use crate::base::geom::Aabb;
use crate::building::gaps::{gap, solids};
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::{Building, Member, MemberKind};
use std::collections::BTreeMap;

/// Factor by which the mesh may change the volume of a member, or the length of its solid along an axis, at most.
pub const MOST_CHANGE: f64 = 2.0;

/// The solid of a member that is not on the planes: it contains no cell.
pub(super) const EMPTY: Aabb = Aabb { min: [f64::INFINITY; 3], max: [f64::INFINITY; 3] };

/// The faces along x, y and z that become mesh planes at a target size \[m\], sorted; `apart`: members that are not on the planes.
pub(super) fn kept_planes(building: &Building, apart: &[bool], size_m: f64) -> [Vec<f64>; 3] {
    let mut kept = std::array::from_fn(|axis| kept_faces(building, apart, axis, SNAP_SHARE * size_m));
    let real_m3 = Partition::of(building).volumes(building.members.len());
    let gaps = refined_gaps(building, apart, size_m);
    loop {
        let lost = most_lost(building, apart, &kept, &real_m3);
        let face = lost.and_then(|member| face_to_keep(building, apart, &kept, member));
        let Some((axis, face)) = face.or_else(|| gaps.iter().find_map(|gap| gap.face_to_keep(&kept))) else {
            break;
        };
        let at = kept[axis].partition_point(|k| *k < face);
        kept[axis].insert(at, face);
    }
    kept
}

/// A gap that the mesh is to keep open.
struct Gap {
    axis: usize,
    /// The faces on both sides \[m\].
    faces: [f64; 2],
}

impl Gap {
    /// The face that is farther from its plane, with its axis, if both go to the same one.
    fn face_to_keep(&self, kept: &[Vec<f64>; 3]) -> Option<(usize, f64)> {
        let kept = &kept[self.axis];
        let [below, above] = self.faces;
        let (a, b) = (placed(kept, [below; 2])[1], placed(kept, [above; 2])[0]);
        let off = self.faces.map(|face| (face - a).abs());
        let farther = self.faces[usize::from(off[1] > off[0])];
        ((a - b).abs() < COORDINATE_TOLERANCE_M).then_some((self.axis, farther))
    }
}

/// The gaps beside members that are to have finer elements, wider than the share of their size that is merged.
fn refined_gaps(building: &Building, apart: &[bool], size_m: f64) -> Vec<Gap> {
    let on_planes = |m: &usize| !apart[*m] && !building.is_cut(&building.members[*m].id);
    let mut finest: BTreeMap<usize, f64> = BTreeMap::new();
    for refinement in &building.settings.meshing.refine {
        if let Some(member) = building.members.iter().position(|m| m.id == refinement.member) {
            let size = finest.entry(member).or_insert(size_m);
            *size = size.min(refinement.size_m);
        }
    }
    let mut gaps = Vec::new();
    for (member, finer_m) in finest.into_iter().filter(|(m, _)| on_planes(m)) {
        let own = solids(&building.members[member]);
        for other in (0..building.members.len()).filter(|m| *m != member && on_planes(m)) {
            let [a, b] = [member, other].map(|m| &building.members[m].solid);
            if !a.is_nearer(b, 2.0 * SNAP_SHARE * size_m) {
                continue;
            }
            let others = solids(&building.members[other]);
            if !are_apart(&own, &others) {
                continue;
            }
            for (p, q) in own.iter().flat_map(|p| others.iter().map(move |q| (p, q))) {
                let (axis, gap_m) = gap(p, q);
                if gap_m > SNAP_SHARE * finer_m {
                    let above = p.min[axis] > q.min[axis];
                    let faces = if above { [q.max[axis], p.min[axis]] } else { [p.max[axis], q.min[axis]] };
                    gaps.push(Gap { axis, faces });
                }
            }
        }
    }
    gaps
}

/// The building with solids and openings moved to the planes; members that stand apart have no cells in it.
pub(super) fn moved(building: &Building, apart: &[bool], kept: &[Vec<f64>; 3]) -> Building {
    let mut moved = building.clone();
    for (member, apart) in moved.members.iter_mut().zip(apart) {
        if *apart {
            member.solid = EMPTY;
            continue;
        }
        for solid in member.openings.iter_mut().chain([&mut member.solid]) {
            for (axis, kept) in kept.iter().enumerate() {
                [solid.min[axis], solid.max[axis]] = placed(kept, [solid.min[axis], solid.max[axis]]);
            }
        }
    }
    moved
}

/// Which member's face stays where it is when two are merged; higher stays.
fn hold(kind: MemberKind) -> u8 {
    match kind {
        MemberKind::Column => 5,
        MemberKind::Wall => 4,
        MemberKind::Footing => 3,
        MemberKind::Slab => 2,
        MemberKind::Beam => 1,
        MemberKind::Brace => 0,
    }
}

/// The faces along an axis after merging: in order of hold, and of equals from the outside to the middle of the building, a face is kept if no kept face is near. So a building and its mirror image have
/// the same planes.
fn kept_faces(building: &Building, apart: &[bool], axis: usize, snap_m: f64) -> Vec<f64> {
    let on_planes = || building.members.iter().zip(apart).filter(|(_, apart)| !**apart).map(|(m, _)| m);
    let mut faces: Vec<(u8, f64)> = on_planes()
        .flat_map(|m| [(hold(m.kind), m.solid.min[axis]), (hold(m.kind), m.solid.max[axis])])
        .collect();
    for opening in on_planes().flat_map(|m| &m.openings) {
        faces.extend([(0, opening.min[axis]), (0, opening.max[axis])]);
    }
    for refinement in &building.settings.meshing.refine {
        let Some(member) = on_planes().find(|m| m.id == refinement.member && m.axis == axis) else {
            continue;
        };
        let (low, high) = (member.solid.min[axis], member.solid.max[axis]);
        if let Some(ends) = refinement.ends_m.filter(|ends| 2.0 * ends < high - low) {
            faces.extend([(0, low + ends), (0, high - ends)]);
        }
    }
    let ends = faces.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |e, f| [e[0].min(f.1), e[1].max(f.1)]);
    let from_middle = |face: f64| (face - 0.5 * (ends[0] + ends[1])).abs();
    faces.sort_by(|a, b| b.0.cmp(&a.0).then(from_middle(b.1).total_cmp(&from_middle(a.1))));
    let near_m = (snap_m - COORDINATE_TOLERANCE_M).max(COORDINATE_TOLERANCE_M);
    let mut kept: Vec<f64> = Vec::new();
    for (_, face) in faces {
        if kept.iter().all(|k| (k - face).abs() > near_m) {
            kept.push(face);
        }
    }
    kept.sort_by(f64::total_cmp);
    kept
}

/// The kept face nearest to a coordinate.
fn nearest(kept: &[f64], value: f64) -> f64 {
    kept.iter().copied().min_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs())).unwrap_or(value)
}

/// The kept faces for the lower and the upper face of a solid: the nearest ones, and of two that are as near as each other the outer one.
fn placed(kept: &[f64], faces: [f64; 2]) -> [f64; 2] {
    let near = faces.map(|face| nearest(kept, face));
    let across = [0, 1].map(|i| nearest(kept, 2.0 * faces[i] - near[i]));
    let is_tie =
        |i: usize| ((across[i] - faces[i]).abs() - (near[i] - faces[i]).abs()).abs() < COORDINATE_TOLERANCE_M;
    [
        if is_tie(0) { near[0].min(across[0]) } else { near[0] },
        if is_tie(1) { near[1].max(across[1]) } else { near[1] },
    ]
}

/// By how much, as the absolute value of a logarithm, a length or volume changes; infinite if nothing is left of it.
fn change(real: f64, meshed: f64) -> f64 {
    if meshed > 0.0 { libm::log(real / meshed).abs() } else { f64::INFINITY }
}

/// Change of the length of a member along an axis.
fn length_change(member: &Member, kept: &[f64], axis: usize) -> f64 {
    let (low, high) = (member.solid.min[axis], member.solid.max[axis]);
    let [below, above] = placed(kept, [low, high]);
    change(high - low, above - below)
}

/// Of the members that the planes change too much the first of those whose faces come first.
fn most_lost(building: &Building, apart: &[bool], kept: &[Vec<f64>; 3], real_m3: &[f64]) -> Option<usize> {
    let meshed_m3 =
        Partition::on_planes(&moved(building, apart, kept), kept.clone()).volumes(building.members.len());
    let most = libm::log(MOST_CHANGE) + 1e-9;
    let lost = |index: &usize| {
        let member = &building.members[*index];
        !apart[*index]
            && !building.is_cut(&member.id)
            && (change(real_m3[*index], meshed_m3[*index]) > most
                || (0..3).any(|axis| length_change(member, &kept[axis], axis) > most))
    };
    let lost = (0..building.members.len()).filter(lost);
    lost.min_by_key(|index| (u8::MAX - hold(building.members[*index].kind), *index))
}

/// The face that does most for a member, with its axis: of its own faces one across the direction in which it changes most, where that is more than by `sqrt 2`; otherwise others
/// are to blame: one of its openings, then of itself and the members that it touches, then any. `None` if all are planes already.
fn face_to_keep(
    building: &Building,
    apart: &[bool],
    kept: &[Vec<f64>; 3],
    member: usize,
) -> Option<(usize, f64)> {
    let own = &building.members[member];
    let off = |axis: usize, face: f64| (nearest(&kept[axis], face) - face).abs();
    let farthest = |solids: &[Aabb], axes: &[usize]| -> Option<(usize, f64)> {
        let faces = axes.iter().flat_map(|a| solids.iter().flat_map(|s| [(*a, s.min[*a]), (*a, s.max[*a])]));
        let moved = faces.filter(|(axis, face)| off(*axis, *face) > COORDINATE_TOLERANCE_M);
        moved.fold(None, |best, at| match best {
            Some((axis, face)) if off(axis, face) >= off(at.0, at.1) => best,
            _ => Some(at),
        })
    };
    let mut axes = [0, 1, 2];
    let by = |axis: usize| length_change(own, &kept[axis], axis);
    axes.sort_by(|a, b| by(*b).total_cmp(&by(*a)));
    let around = |touching: bool| -> Vec<Aabb> {
        let meets = |other: &Member| {
            (0..3).all(|i| {
                other.solid.min[i] < own.solid.max[i] + COORDINATE_TOLERANCE_M
                    && other.solid.max[i] > own.solid.min[i] - COORDINATE_TOLERANCE_M
            })
        };
        let others =
            building.members.iter().zip(apart).filter(|(m, apart)| !**apart && (!touching || meets(m)));
        others.flat_map(|(m, _)| m.openings.iter().chain([&m.solid]).copied()).collect()
    };
    let mut changed = axes.iter().filter(|axis| by(**axis) > 0.5 * libm::log(MOST_CHANGE));
    changed
        .find_map(|axis| farthest(&[own.solid], &[*axis]))
        .or_else(|| farthest(&own.openings, &[0, 1, 2]))
        .or_else(|| farthest(&around(true), &[0, 1, 2]))
        .or_else(|| farthest(&around(false), &[0, 1, 2]))
}
