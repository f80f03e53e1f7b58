//! What is around a member end in the mesh of a building: two ends with the same surroundings have the same submodel.

use super::cut::REACH_DEPTHS;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::base::hash::ContentHash;
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind};
use crate::fe::mesh::Mesh;
use std::ops::Range;

/// Planes of a mesh nearer to each other than this are one \[m\].
pub const SAME_PLANE_M: f64 = 1e-6;

/// The edges of the elements between two planes, these included, for the planes of a mesh along the same axis \[m\].
pub fn edges_between(planes: &[f64], [low, high]: [f64; 2]) -> Vec<f64> {
    let inside = planes.iter().filter(|p| **p > low + SAME_PLANE_M && **p < high - SAME_PLANE_M);
    [low].into_iter().chain(inside.copied()).chain([high]).collect()
}

/// Most elements of a row.
const ROW: usize = 16;

/// Where the elements of a mesh lie.
#[derive(Debug, Clone, Default)]
pub struct Surroundings {
    /// Bounds of the centres of each row: elements of a member that follow each other.
    rows: Boxes,
    /// Elements of each row.
    elements: Vec<Range<usize>>,
    /// Centres of the elements \[m\].
    centres: Vec<[f64; 3]>,
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
        let mut rows: Vec<Aabb> = Vec::new();
        for (number, element) in mesh.elements.iter().enumerate() {
            let own = mesh.bounds(element);
            this.edge_m = own.size().into_iter().fold(this.edge_m, f64::max);
            let held = this.bounds[element.part].get_or_insert(own);
            *held = held.around(own);
            let centre = mesh.center(number);
            this.centres.push(centre);
            let centre = Aabb { min: centre, max: centre };
            match (this.elements.last_mut(), rows.last_mut()) {
                (Some(row), Some(solid))
                    if row.len() < ROW && mesh.elements[row.start].part == element.part =>
                {
                    row.end += 1;
                    *solid = solid.around(centre);
                }
                _ => {
                    this.elements.push(number..number + 1);
                    rows.push(centre);
                }
            }
        }
        this.rows = Boxes::of(rows.into_iter());
        this.planes = [0, 1, 2].map(|axis| planes(mesh, axis));
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
        let distance_m = 1.01 * self.edge_m;
        let rows = self.rows.near(&region, distance_m);
        let all = rows.into_iter().flat_map(|row| self.elements[row].clone());
        let is_near = |e: &usize| {
            let centre = self.centres[*e];
            region.is_nearer(&Aabb { min: centre, max: centre }, distance_m)
        };
        Some(all.filter(is_near).collect())
    }
}

/// Places along an axis at which nodes of a mesh lie, ascending \[m\].
fn planes(mesh: &Mesh, axis: usize) -> Vec<f64> {
    // many nodes, few planes: what is the same goes in small portions, before all that is left is sorted
    let mut list: Vec<f64> = Vec::new();
    for nodes in mesh.nodes.chunks(1024) {
        let mut some: Vec<f64> = nodes.iter().map(|n| n[axis]).collect();
        some.sort_unstable_by(f64::total_cmp);
        some.dedup();
        list.append(&mut some);
    }
    list.sort_by(f64::total_cmp);
    list.dedup_by(|a, b| *a - *b < SAME_PLANE_M);
    list
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
