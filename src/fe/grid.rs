//! The planes of a conforming block mesh: faces of the solids, near ones merged, then subdivided.

use crate::base::geom::Aabb;
use crate::building::partition::COORDINATE_TOLERANCE_M;
use crate::building::{Building, MemberKind};

/// Faces closer together than this share of the target size become one mesh plane; what moves is the face of the
/// member that carries less (column faces stay first).
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
}

impl MeshGrid {
    /// Planes for a target element size \[m\].
    pub fn of(building: &Building, size_m: f64) -> Self {
        let mut solids: Vec<Aabb> = building.members.iter().map(|m| m.solid).collect();
        let mut planes: [Vec<f64>; 3] = Default::default();
        for axis in 0..3 {
            let kept = kept_faces(building, axis, SNAP_SHARE * size_m);
            for solid in &mut solids {
                solid.min[axis] = nearest(&kept, solid.min[axis]);
                solid.max[axis] = nearest(&kept, solid.max[axis]);
            }
            planes[axis] = subdivided(building, &solids, &kept, axis, size_m);
        }
        Self { planes, solids }
    }
}

/// Which member's face stays where it is when two are merged; higher stays.
fn hold(kind: MemberKind) -> u8 {
    match kind {
        MemberKind::Column => 4,
        MemberKind::Wall => 3,
        MemberKind::Footing => 2,
        MemberKind::Slab => 1,
        MemberKind::Beam => 0,
    }
}

/// The faces along an axis after merging: in order of hold, a face is kept if no kept face is near.
fn kept_faces(building: &Building, axis: usize, snap_m: f64) -> Vec<f64> {
    let mut faces: Vec<(u8, f64)> = building
        .members
        .iter()
        .flat_map(|m| [(hold(m.kind), m.solid.min[axis]), (hold(m.kind), m.solid.max[axis])])
        .collect();
    faces.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.total_cmp(&b.1)));
    let mut kept: Vec<f64> = Vec::new();
    for (_, face) in faces {
        if kept.iter().all(|k| (k - face).abs() > snap_m.max(COORDINATE_TOLERANCE_M)) {
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

/// Subdivides the intervals between kept faces to the target size, with at least [`ELEMENTS_ACROSS`] elements
/// across each member's thin directions.
fn subdivided(building: &Building, solids: &[Aabb], kept: &[f64], axis: usize, size_m: f64) -> Vec<f64> {
    let mut count: Vec<usize> =
        kept.windows(2).map(|w| (((w[1] - w[0]) / size_m - 0.01).round() as usize).max(1)).collect();
    for (member, solid) in building.members.iter().zip(solids) {
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
    let mut planes = vec![kept[0]];
    for (i, n) in count.iter().enumerate() {
        for step in 1..=*n {
            planes.push(kept[i] + (kept[i + 1] - kept[i]) * step as f64 / *n as f64);
        }
    }
    planes
}
