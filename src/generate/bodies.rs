//! Rigid bodies from sets of members.

use super::cells::Piece;
use super::stumps::Stumps;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::partition::merged;
use crate::building::{Building, MemberKind};
use crate::graph::{MassProperties, Structure};
use crate::mbs::model::{Body, Origin, Shape};
use std::collections::{BTreeMap, BTreeSet};

/// Distance within which the piece of a floor at a place is looked for first, and beyond which no building reaches \[m\].
const NEAR_M: f64 = 0.5;
/// See [`NEAR_M`].
const FAR_M: f64 = 1e5;

/// The pieces of a floor in the order of their bodies, and where they are.
#[derive(Debug)]
struct Floor {
    pieces: Vec<Piece>,
    places: Boxes,
}

impl Floor {
    fn of(pieces: Vec<Piece>) -> Self {
        let boxes = pieces.iter().enumerate().flat_map(|(i, p)| p.boxes.iter().map(move |(_, b)| (i, *b)));
        Self { places: Boxes::numbered(boxes), pieces }
    }

    /// The piece nearest to a place, the first of equals.
    fn nearest(&self, point_m: [f64; 3]) -> Option<usize> {
        let (at, mut reach_m) = (Aabb { min: point_m, max: point_m }, NEAR_M);
        loop {
            let near = self.places.near(&at, reach_m).into_iter();
            let found = near.map(|i| (self.pieces[i].distance2(point_m), i));
            let nearest = found.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            // whatever is not among them is farther than this along some axis
            match nearest {
                Some((distance2, piece)) if distance2 <= reach_m * reach_m => return Some(piece),
                _ if reach_m > FAR_M => return nearest.map(|(_, piece)| piece),
                _ => reach_m *= 4.0,
            }
        }
    }
}

/// The bodies of a model, and which of them a place belongs to.
#[derive(Debug, Default)]
pub struct Bodies {
    /// The bodies.
    pub list: Vec<Body>,
    /// For each member its body, or the first piece of its floor.
    owner: Vec<Option<usize>>,
    /// Floors in pieces, by their first body.
    floors: BTreeMap<usize, Floor>,
    /// Which bodies are pieces of floors that bend.
    bending: BTreeSet<usize>,
    /// Columns of which charges take a stretch, by member.
    stumps: BTreeMap<usize, Stumps>,
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

    /// Enters the pieces of a floor, or of a column; the number of bodies before.
    pub fn add_pieces(&mut self, members: &[usize], pieces: Vec<Piece>, bodies: Vec<Body>) -> usize {
        let first = self.list.len();
        members.iter().for_each(|m| self.owner[*m] = Some(first));
        self.list.extend(bodies);
        self.floors.insert(first, Floor::of(pieces));
        first
    }

    /// Enters the pieces of a column of which charges take a stretch.
    pub fn add_stumps(&mut self, stumps: Stumps, pieces: Vec<Piece>, bodies: Vec<Body>) {
        self.add_pieces(&[stumps.member], pieces, bodies);
        self.stumps.insert(stumps.member, stumps);
    }

    /// The pieces of a column of which charges take a stretch.
    pub fn stumps_of(&self, member: usize) -> Option<&Stumps> {
        self.stumps.get(&member)
    }

    /// Columns of which charges take a stretch.
    pub fn stumps(&self) -> impl Iterator<Item = &Stumps> {
        self.stumps.values()
    }

    /// Enters bodies that are parts of pieces of floors.
    pub fn add_parts(&mut self, bodies: impl Iterator<Item = Body>) {
        self.list.extend(bodies);
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
        match self.floors.get(&first) {
            Some(floor) => floor.nearest(point_m).map(|i| first + i),
            None => Some(first),
        }
    }

    /// All bodies of a member.
    pub fn all_of(&self, member: usize) -> Vec<usize> {
        let Some(first) = self.owner[member] else { return Vec::new() };
        let pieces = self.floors.get(&first).map_or(1, |floor| floor.pieces.len());
        (first..first + pieces).collect()
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
