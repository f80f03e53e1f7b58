//! What is around a member end in the mesh of a building: two ends with the same surroundings have the same submodel.

use super::cut::REACH_DEPTHS;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::base::hash::ContentHash;
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind};
use crate::fe::mesh::Mesh;

/// Planes of a mesh nearer to each other than this are one \[m\].
pub const SAME_PLANE_M: f64 = 1e-6;

/// The edges of the elements between two planes, these included, for the planes of a mesh along the same axis \[m\].
pub fn edges_between(planes: &[f64], [low, high]: [f64; 2]) -> Vec<f64> {
    let inside = planes.iter().filter(|p| **p > low + SAME_PLANE_M && **p < high - SAME_PLANE_M);
    [low].into_iter().chain(inside.copied()).chain([high]).collect()
}

/// Where the elements of a mesh lie.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    /// Centres of the elements.
    centres: Boxes,
    /// Bounds of each member's elements.
    bounds: Vec<Option<Aabb>>,
    /// Longest edge of an element \[m\].
    edge_m: f64,
    /// Planes along x, y and z in which nodes lie \[m\].
    pub planes: [Vec<f64>; 3],
}

impl Surroundings {
    /// Of a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let mut this = Self { bounds: vec![None; mesh.parts.len()], ..Self::default() };
        for element in &mesh.elements {
            let own = mesh.bounds(element);
            this.edge_m = own.size().into_iter().fold(this.edge_m, f64::max);
            let held = this.bounds[element.part].get_or_insert(own);
            *held = held.around(own);
        }
        let centre = |e: usize| Aabb { min: mesh.center(e), max: mesh.center(e) };
        this.planes = [0, 1, 2].map(|i| {
            let mut list: Vec<f64> = mesh.nodes.iter().map(|n| n[i]).collect();
            list.sort_by(f64::total_cmp);
            list.dedup_by(|a, b| *a - *b < SAME_PLANE_M);
            list
        });
        this.centres = Boxes::of((0..mesh.elements.len()).map(centre));
        this
    }

    /// Elements on which the submodel of a column end depends: those of the member and those within reach, one element farther than they are kept. `None`: the mesh has parts of its own whose
    /// elements it does not hold in place by their nodes.
    pub fn near(&self, mesh: &Mesh, end: &MemberEnd) -> Option<Vec<usize>> {
        if !mesh.ties.is_empty() || !mesh.trusses.is_empty() {
            return None;
        }
        let (reach, own) = (REACH_DEPTHS * end.depth_m, self.bounds[end.member]?);
        let region = Aabb {
            min: std::array::from_fn(|i| own.min[i].min(end.point_m[i] - reach)),
            max: std::array::from_fn(|i| own.max[i].max(end.point_m[i] + reach)),
        };
        Some(self.centres.near(&region, 1.01 * self.edge_m))
    }
}

/// A hash of all on which the submodel of a column end depends: the elements near it, relative to the end, with their strength and whether they are the member's own or another column's; and section,
/// end and what adjoins.
pub fn signature(
    building: &Building,
    mesh: &Mesh,
    end: &MemberEnd,
    adjoining: Option<MemberKind>,
    near: &[usize],
) -> ContentHash {
    let section = &building.members[end.member].section;
    let clear = micrometres(end.clear_m);
    let mut bytes = format!("{section} {:?} {} {clear} {adjoining:?}", end.end, end.axis).into_bytes();
    for index in near {
        let element = &mesh.elements[*index];
        let solid = mesh.bounds(element);
        let kind = match building.members[element.part].kind {
            _ if element.part == end.member => 0,
            MemberKind::Column => 1,
            _ => 2,
        };
        let relative = |of: &[f64; 3], i: usize| micrometres(of[i] - end.point_m[i]);
        let places = (0..3).flat_map(|i| [relative(&solid.min, i), relative(&solid.max, i)]);
        let more = [kind, element.law as i64, micrometres(element.smear), micrometres(element.strength)];
        places.chain(more).for_each(|number| bytes.extend(number.to_le_bytes()));
    }
    ContentHash::of_bytes(&bytes)
}

fn micrometres(value: f64) -> i64 {
    (1e6 * value).round() as i64
}
