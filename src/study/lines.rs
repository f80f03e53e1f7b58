//! What an FE run shows at lines of slabs and at feet and heads of walls.
//!
//! A strip of slab between two columns may fold at either of them or in its middle: its halves and what lies over the columns are taken as bodies that turn against each other. A wall turns against what is below or above it, or against
//! the ground.

use super::rotation::folded;
use super::zone::{ElementHistory, EndZone, Place, zone};
use crate::base::geom::Aabb;
use crate::building::Building;
use crate::building::lines::{Line, lines};
use crate::building::partition::Partition;
use crate::fe::result::FeRun;

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
    let of = |line: &Line| {
        let own: Vec<usize> =
            of_member(run, line.member, &line.clear).filter(|e| !elements.removed[*e]).collect();
        if own.is_empty() {
            return None;
        }
        let place =
            Place { id: &line.id, member: line.member, axis: line.axis, point_m: line.clear.center() };
        let is_slab = line.columns.is_some();
        let sets = if is_slab { of_slab(run, line, &own) } else { of_wall(run, line, &own) };
        let turned = folded(run, elements.dead, &sets, line.axis, until_s);
        let near = if is_slab { own } else { layer(run, line, &own) };
        Some(zone(building, run, history, &place, &near).turned(turned))
    };
    lines(building, partition).iter().filter_map(of).collect()
}

/// What turns against each other of a slab: what lies over its columns, as far as there is any, and its halves.
fn of_slab(run: &FeRun, line: &Line, own: &[usize]) -> Vec<Option<Vec<usize>>> {
    let over = |part: &Option<Aabb>| -> Option<Vec<usize>> {
        let set: Vec<usize> = part.iter().flat_map(|part| of_member(run, line.member, part)).collect();
        (!set.is_empty()).then_some(set)
    };
    let middle_m = line.clear.center()[line.axis];
    let (lower, upper): (Vec<usize>, Vec<usize>) =
        own.iter().partition(|e| run.mesh.center(**e)[line.axis] < middle_m);
    let [first, last] = line.behind.each_ref().map(over);
    // what is not there holds nothing
    [first, Some(lower), Some(upper), last].into_iter().flatten().map(Some).collect()
}

/// What turns against each other of a wall: its half and what it stands on, or the ground, or what stands on it.
fn of_wall(run: &FeRun, line: &Line, own: &[usize]) -> Vec<Option<Vec<usize>>> {
    let half = Some(own.to_vec());
    match &line.behind {
        [Some(below), _] => vec![beside_wall(run, line.member, below), half],
        [None, Some(above)] => {
            [half, beside_wall(run, line.member, above)].into_iter().flatten().map(Some).collect()
        }
        [None, None] => vec![half],
    }
}

/// Elements of a member with their centre in a box.
fn of_member<'a>(run: &'a FeRun, member: usize, part: &'a Aabb) -> impl Iterator<Item = usize> + 'a {
    let mesh = &run.mesh;
    (0..mesh.elements.len())
        .filter(move |e| mesh.elements[*e].part == member && part.contains(mesh.center(*e), 0.0))
}

/// The layer of elements of other members below or above a wall that is nearest to it.
fn beside_wall(run: &FeRun, wall: usize, part: &Aabb) -> Option<Vec<usize>> {
    let mesh = &run.mesh;
    let others = (0..mesh.elements.len()).filter(|e| mesh.elements[*e].part != wall);
    let inside: Vec<usize> = others.filter(|e| part.contains(mesh.center(*e), 0.0)).collect();
    let nearest = |e: &usize| {
        let at = mesh.center(*e)[2];
        (at - part.min[2]).min(part.max[2] - at)
    };
    let least = inside.iter().map(nearest).fold(f64::INFINITY, f64::min);
    let set: Vec<usize> = inside.into_iter().filter(|e| nearest(e) < least + 1e-6).collect();
    (!set.is_empty()).then_some(set)
}

/// Of the elements of half a wall the layer at its end.
fn layer(run: &FeRun, line: &Line, own: &[usize]) -> Vec<usize> {
    let level = |e: &usize| if line.is_foot() { run.mesh.center(*e)[2] } else { -run.mesh.center(*e)[2] };
    let least = own.iter().map(level).fold(f64::INFINITY, f64::min);
    own.iter().copied().filter(|e| level(e) < least + 1e-6).collect()
}
