//! The planes of a conforming block mesh: faces of the solids, near ones merged, then subdivided.

use super::merge::{kept_planes, moved};
use crate::base::geom::Aabb;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, Member, MemberKind};

/// Faces closer together than this share of the target size become one mesh plane; what moves is the face of the
/// member that carries less (column faces stay first). Not where a member would be lost by it ([`super::merge`]).
pub const SNAP_SHARE: f64 = 0.25;
/// Elements across a column, beam or plate, at least.
pub const ELEMENTS_ACROSS: usize = 2;

/// Mesh planes and where the faces of the solids went.
#[derive(Debug, Clone)]
pub struct MeshGrid {
    /// All mesh planes in x, y and z \[m\].
    pub planes: [Vec<f64>; 3],
    /// Solids of the members on the mesh planes \[m\], like `Building::members`.
    pub solids: Vec<Aabb>,
    /// Their openings on the mesh planes \[m\].
    pub openings: Vec<Vec<Aabb>>,
    /// Members that have a mesh of their own and are not on the planes.
    pub apart: Vec<bool>,
}

impl MeshGrid {
    /// Planes for a target element size \[m\].
    pub fn of(building: &Building, size_m: f64) -> Self {
        let apart = apart(building, SNAP_SHARE * size_m);
        let kept = kept_planes(building, &apart, size_m);
        let moved = moved(building, &apart, &kept).members;
        let placed = building.members.iter().zip(&moved).zip(&apart);
        let solids: Vec<Aabb> =
            placed.map(|((m, moved), apart)| if *apart { m.solid } else { moved.solid }).collect();
        let cut = with_stretches(building, kept, SNAP_SHARE * size_m);
        let planes =
            std::array::from_fn(|axis| subdivided(building, &solids, &apart, &cut[axis], axis, size_m));
        Self { planes, solids, openings: moved.into_iter().map(|m| m.openings).collect(), apart }
    }
}

/// The planes with those at which stretches of charges begin and end, where none is nearer than `snap_m`: what a charge takes is then what its stretch says.
fn with_stretches(building: &Building, mut planes: [Vec<f64>; 3], snap_m: f64) -> [Vec<f64>; 3] {
    for charge in &building.events {
        let Some(member) = building.members.iter().find(|m| m.id == charge.member && !m.is_skew()) else {
            continue;
        };
        for at in charge.stretch_m.into_iter().flatten().map(|at| member.solid.min[member.axis] + at) {
            let own = &mut planes[member.axis];
            if own.iter().all(|plane| (plane - at).abs() > snap_m) {
                own.insert(own.partition_point(|plane| *plane < at), at);
            }
        }
    }
    planes
}

/// Members that are to have a mesh of their own: those turned out of the axes, and columns of which a side face would come nearer to a face of another member than the building
/// allows, though too far to be merged with it, and nothing but the column's ends touches other members.
fn apart(building: &Building, snap_m: f64) -> Vec<bool> {
    let least = building.settings.meshing.tie_below_m;
    let mut apart: Vec<bool> = building.members.iter().map(Member::is_skew).collect();
    if least <= snap_m {
        return apart;
    }
    let column = |m: &Member| m.kind == MemberKind::Column;
    let mut faces: [Vec<f64>; 2] = std::array::from_fn(|axis| {
        building
            .members
            .iter()
            .filter(|m| !column(m) && !m.is_skew())
            .flat_map(|m| [m.solid.min[axis], m.solid.max[axis]])
            .collect()
    });
    for (index, member) in building.members.iter().enumerate().filter(|(_, m)| column(m) && !m.is_skew()) {
        let near = |axis: usize, face: f64| {
            let merges = |f: &f64| (f - face).abs() <= snap_m.max(COORDINATE_TOLERANCE_M);
            faces[axis].iter().any(|f| (f - face).abs() < least) && !faces[axis].iter().any(merges)
        };
        let own = [0, 1].map(|axis| [member.solid.min[axis], member.solid.max[axis]]);
        let slivers = (0..2).any(|axis| own[axis].iter().any(|face| near(axis, *face)));
        if slivers && stands_free(building, index, &apart) {
            apart[index] = true;
        } else {
            (0..2).for_each(|axis| faces[axis].extend(own[axis]));
        }
    }
    apart
}

/// Whether other members touch a column at its ends only, and none of them has a mesh of its own.
fn stands_free(building: &Building, column: usize, apart: &[bool]) -> bool {
    let solid = &building.members[column].solid;
    let clear = clear_height(building, column);
    building.members.iter().enumerate().filter(|(i, _)| *i != column).all(|(i, other)| {
        let around = other.bounds();
        let gap = |k: usize| (around.min[k] - solid.max[k]).max(solid.min[k] - around.max[k]);
        let beside = (0..2).all(|k| gap(k) < COORDINATE_TOLERANCE_M);
        let along = around.min[2] < clear[1] - COORDINATE_TOLERANCE_M
            && around.max[2] > clear[0] + COORDINATE_TOLERANCE_M;
        let meets = beside && gap(2) < COORDINATE_TOLERANCE_M;
        !(beside && along || meets && apart[i])
    })
}

/// The stretch of a column between what overlaps its ends \[m\].
pub(super) fn clear_height(building: &Building, column: usize) -> [f64; 2] {
    let solid = &building.members[column].solid;
    let mut clear = [solid.min[2], solid.max[2]];
    for (_, other) in building.members.iter().enumerate().filter(|(i, m)| *i != column && !m.is_skew()) {
        let Some(common) = solid.intersection(&other.solid, COORDINATE_TOLERANCE_M) else { continue };
        if common.max[2] > solid.max[2] - COORDINATE_TOLERANCE_M {
            clear[1] = clear[1].min(common.min[2]);
        } else if common.min[2] < solid.min[2] + COORDINATE_TOLERANCE_M {
            clear[0] = clear[0].max(common.max[2]);
        }
    }
    clear
}

/// The finest size asked for between two planes \[m\].
fn demanded(building: &Building, solids: &[Aabb], axis: usize, between: [f64; 2], size_m: f64) -> f64 {
    let middle = 0.5 * (between[0] + between[1]);
    let mut finest = size_m;
    for refinement in &building.settings.meshing.refine {
        let Some(index) = building.members.iter().position(|m| m.id == refinement.member) else { continue };
        if building.members[index].is_skew() {
            continue; // it has a mesh of its own
        }
        let (low, high) = (solids[index].min[axis], solids[index].max[axis]);
        let along = building.members[index].axis == axis;
        let from_end = (middle - low).min(high - middle);
        let reach = refinement.ends_m.filter(|_| along).unwrap_or(f64::INFINITY);
        if from_end > 0.0 && from_end < reach {
            finest = finest.min(refinement.size_m);
        }
    }
    finest
}

/// Subdivides the intervals between kept faces to the target size, with at least [`ELEMENTS_ACROSS`] elements
/// across each member's thin directions.
fn subdivided(
    building: &Building,
    solids: &[Aabb],
    apart: &[bool],
    kept: &[f64],
    axis: usize,
    size_m: f64,
) -> Vec<f64> {
    let mut count: Vec<usize> = kept
        .windows(2)
        .map(|w| {
            let size = demanded(building, solids, axis, [w[0], w[1]], size_m);
            (((w[1] - w[0]) / size - 0.01).round() as usize).max(1)
        })
        .collect();
    for ((member, solid), _) in building.members.iter().zip(solids).zip(apart).filter(|(_, apart)| !**apart) {
        let bar = matches!(member.kind, MemberKind::Column | MemberKind::Beam);
        if bar == (member.axis == axis) {
            continue; // along a bar, or in the plane of a plate
        }
        let covers = |i: usize| {
            kept[i] > solid.min[axis] - COORDINATE_TOLERANCE_M
                && kept[i + 1] < solid.max[axis] + COORDINATE_TOLERANCE_M
        };
        let inside: Vec<usize> = (0..count.len()).filter(|i| covers(*i)).collect();
        let total: usize = inside.iter().map(|i| count[*i]).sum();
        let widest = inside.iter().copied().max_by(|a, b| {
            let width = |i: &usize| (kept[*i + 1] - kept[*i]) / count[*i] as f64;
            width(a).total_cmp(&width(b)).then(b.cmp(a))
        });
        if let Some(widest) = widest {
            count[widest] += ELEMENTS_ACROSS.saturating_sub(total);
        }
    }
    let mut planes: Vec<f64> = kept.first().copied().into_iter().collect();
    for (i, n) in count.iter().enumerate() {
        for step in 1..=*n {
            planes.push(kept[i] + (kept[i + 1] - kept[i]) * step as f64 / *n as f64);
        }
    }
    planes
}
