//! Rigid bodies from sets of members.

use super::cells::Piece;
use crate::base::geom::Aabb;
use crate::building::partition::merged;
use crate::building::{Building, MemberKind};
use crate::graph::{MassProperties, Structure};
use crate::mbs::model::{Body, Origin, Shape};
use std::collections::BTreeSet;

/// The bodies of a model, and which of them a place belongs to.
#[derive(Debug, Default)]
pub struct Bodies {
    /// The bodies.
    pub list: Vec<Body>,
    /// For each member its body, or the first piece of its floor.
    owner: Vec<Option<usize>>,
    /// Floors in pieces: their first body, and the pieces in the order of the bodies.
    floors: Vec<(usize, Vec<Piece>)>,
    /// Which bodies are pieces of floors that bend.
    bending: BTreeSet<usize>,
}

impl Bodies {
    /// For a number of members.
    pub fn new(members: usize) -> Self {
        Self { owner: vec![None; members], ..Self::default() }
    }

    /// Enters the body of some members.
    pub fn add(&mut self, members: &[usize], body: Body) {
        members.iter().for_each(|m| self.owner[*m] = Some(self.list.len()));
        self.list.push(body);
    }

    /// Enters the pieces of a floor; the number of bodies before.
    pub fn add_floor(&mut self, members: &[usize], pieces: Vec<Piece>, bodies: Vec<Body>) -> usize {
        let first = self.list.len();
        members.iter().for_each(|m| self.owner[*m] = Some(first));
        self.list.extend(bodies);
        self.floors.push((first, pieces));
        first
    }

    /// Says that a floor in pieces bends.
    pub fn bends(&mut self, first: usize, pieces: usize) {
        self.bending.extend(first..first + pieces);
    }

    /// Whether a body is a piece of a floor that bends.
    pub fn is_bending(&self, body: usize) -> bool {
        self.bending.contains(&body)
    }

    /// The body of a member at a place.
    pub fn of(&self, member: usize, point_m: [f64; 3]) -> Option<usize> {
        let first = self.owner[member]?;
        let Some((_, pieces)) = self.floors.iter().find(|(floor, _)| *floor == first) else {
            return Some(first);
        };
        let distance = |i: &usize| pieces[*i].distance2(point_m);
        let nearest = (0..pieces.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.map(|i| first + i)
    }

    /// All bodies of a member.
    pub fn all_of(&self, member: usize) -> Vec<usize> {
        let Some(first) = self.owner[member] else { return Vec::new() };
        let floor = self.floors.iter().find(|(floor, _)| *floor == first);
        (first..first + floor.map_or(1, |(_, pieces)| pieces.len())).collect()
    }
}

/// The body of some members.
pub fn body(building: &Building, structure: &Structure, members: &[usize], rules: Vec<String>) -> Body {
    let own = |m: &usize| structure.boxes(*m).iter().map(|b| (*m, *b)).collect::<Vec<_>>();
    let boxes: Vec<(usize, Aabb)> = members.iter().flat_map(own).collect();
    of_boxes(building, structure, &boxes, name(building, members), rules)
}

/// The body of some boxes, given with their members, one member after the other: mass, centre, inertia from these volumes, and contact boxes.
pub fn of_boxes(
    building: &Building,
    structure: &Structure,
    boxes: &[(usize, Aabb)],
    id: String,
    rules: Vec<String>,
) -> Body {
    let mass = MassProperties::of_boxes(boxes.iter().map(|(m, b)| (b, structure.density_kg_m3(*m))));
    let mut members: Vec<usize> = boxes.iter().map(|(m, _)| *m).collect();
    members.dedup();
    let merged_of = |m: &usize| {
        let own: Vec<Aabb> = boxes.iter().filter(|(o, _)| o == m).map(|(_, b)| *b).collect();
        merged(&own)
    };
    let shape = |solid: Aabb| {
        let center_m = std::array::from_fn(|i| solid.center()[i] - mass.center_m[i]);
        Shape::cuboid(center_m, solid.size().map(|s| 0.5 * s))
    };
    Body {
        id,
        mass_kg: mass.mass_kg,
        inertia_kg_m2: mass.inertia_kg_m2,
        position_m: mass.center_m,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes: members.iter().flat_map(merged_of).map(shape).collect(),
        origin: Origin {
            members: members.iter().map(|m| building.members[*m].id.clone()).collect(),
            rules,
            entries: Vec::new(),
        },
    }
}

/// A body is called after its plate, or after its first member.
pub fn name(building: &Building, members: &[usize]) -> String {
    let plate = |m: &&usize| !matches!(building.members[**m].kind, MemberKind::Beam | MemberKind::Column);
    let index = members.iter().find(plate).unwrap_or(&members[0]);
    building.members[*index].id.clone()
}
