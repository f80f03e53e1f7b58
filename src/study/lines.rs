//! What an FE run shows at lines of slabs and at bases and tops of walls.
//!
//! A strip of slab between two columns may fold at either of them or in its middle: its halves and what lies over the columns are taken as bodies that turn against each other. A wall turns against what is below or above it, or against
//! the ground.

use super::rotation::folded;
use super::zone::{ElementHistory, EndZone, Place, zone};
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::lines::{Line, lines};
use crate::building::partition::Partition;
use crate::building::{Building, MemberKind};
use crate::fe::mesh::Mesh;
use crate::fe::result::FeRun;

/// Centres of elements of one layer are level to this \[m\].
const SAME_LAYER_M: f64 = 1e-6;

/// Of all elements of a run: whether a charge took it, whether it is gone at the end.
pub(super) struct Elements<'a> {
    pub removed: &'a [bool],
    pub dead: &'a [bool],
}

/// The zones, in the order of the lines.
pub(super) fn zones(
    building: &Building,
    partition: &Partition,
    run: &FeRun,
    history: &ElementHistory<'_>,
    elements: &Elements<'_>,
    until_s: f64,
) -> Vec<EndZone> {
    let mesh = Plates::of(building, &run.mesh);
    let of = |line: &Line| {
        let mut own = mesh.inside(line, &line.clear);
        own.retain(|e| !elements.removed[*e]);
        if own.is_empty() {
            return None;
        }
        let place =
            Place { id: &line.id, member: line.member, axis: line.axis, point_m: line.clear.center() };
        let is_slab = line.columns.is_some();
        let sets = if is_slab { mesh.of_slab(line, &own) } else { mesh.of_wall(line, &own) };
        let turned = folded(run, elements.dead, &sets, line.axis, until_s);
        let near = if is_slab { own } else { mesh.layer(line, &own) };
        Some(zone(building, run, history, &place, &near).turned(turned))
    };
    lines(building, partition).iter().filter_map(of).collect()
}

/// A mesh, with the centres of its elements to look them up by.
struct Plates<'a> {
    mesh: &'a Mesh,
    building: &'a Building,
    centres: Boxes,
}

impl<'a> Plates<'a> {
    fn of(building: &'a Building, mesh: &'a Mesh) -> Self {
        let point = |e| Aabb { min: mesh.center(e), max: mesh.center(e) };
        Self { mesh, building, centres: Boxes::of((0..mesh.elements.len()).map(point)) }
    }

    fn kind(&self, element: usize) -> MemberKind {
        self.building.members[self.mesh.elements[element].part].kind
    }

    /// Elements with their centre in a box, ascending.
    fn within(&self, part: &Aabb) -> Vec<usize> {
        let mut found = self.centres.near(part, 0.0);
        found.retain(|e| part.contains(self.mesh.center(*e), 0.0));
        found.sort_unstable();
        found
    }

    /// Elements of a wall, or of the slabs of a floor, in a box.
    fn inside(&self, line: &Line, part: &Aabb) -> Vec<usize> {
        let mut found = self.within(part);
        match line.columns {
            Some(_) => found.retain(|e| self.kind(*e) == MemberKind::Slab),
            None => found.retain(|e| self.mesh.elements[*e].part == line.member),
        }
        found
    }

    /// What turns against each other of a slab: what lies over its columns, as far as there is any, and its halves.
    fn of_slab(&self, line: &Line, own: &[usize]) -> Vec<Option<Vec<usize>>> {
        let over = |part: &Option<Aabb>| {
            let set = part.as_ref().map_or(Vec::new(), |part| self.inside(line, part));
            (!set.is_empty()).then_some(set)
        };
        let middle_m = line.clear.center()[line.axis];
        let (lower, upper): (Vec<usize>, Vec<usize>) =
            own.iter().partition(|e| self.mesh.center(**e)[line.axis] < middle_m);
        let [first, last] = line.behind.each_ref().map(over);
        // what is not there holds nothing
        [first, Some(lower), Some(upper), last].into_iter().flatten().map(Some).collect()
    }

    /// What turns against each other of a wall: its half and what it stands on, or the ground, or what stands on it.
    fn of_wall(&self, line: &Line, own: &[usize]) -> Vec<Option<Vec<usize>>> {
        let half = Some(own.to_vec());
        match &line.behind {
            [Some(below), _] => vec![self.beside_wall(line.member, below), half],
            [None, Some(above)] => {
                [half, self.beside_wall(line.member, above)].into_iter().flatten().map(Some).collect()
            }
            [None, None] => vec![half],
        }
    }

    /// The layer of elements of other members below or above a wall that is nearest to it.
    fn beside_wall(&self, wall: usize, part: &Aabb) -> Option<Vec<usize>> {
        let mut inside = self.within(part);
        inside.retain(|e| self.mesh.elements[*e].part != wall);
        let nearest = |e: &usize| {
            let at_m = self.mesh.center(*e)[2];
            (at_m - part.min[2]).min(part.max[2] - at_m)
        };
        let least_m = inside.iter().map(nearest).fold(f64::INFINITY, f64::min);
        inside.retain(|e| nearest(e) < least_m + SAME_LAYER_M);
        (!inside.is_empty()).then_some(inside)
    }

    /// Of the elements of half a wall the layer at its end.
    fn layer(&self, line: &Line, own: &[usize]) -> Vec<usize> {
        let level =
            |e: &usize| if line.is_foot() { self.mesh.center(*e)[2] } else { -self.mesh.center(*e)[2] };
        let least_m = own.iter().map(level).fold(f64::INFINITY, f64::min);
        own.iter().copied().filter(|e| level(e) < least_m + SAME_LAYER_M).collect()
    }
}
