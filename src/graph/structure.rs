//! The graph itself: members and the ground as nodes, contact faces and supports as edges.

use super::contact::{ContactFace, NEAR_MISS_M, NearMiss, Touching, are_near, near_miss, touching_pairs};
use super::ends::{End, MemberEnd, bar_axis, is_upright, member_ends};
use super::mass::MassProperties;
use crate::base::boxes::Boxes;
use crate::base::geom::Aabb;
use crate::building::partition::{COORDINATE_TOLERANCE_M, Partition};
use crate::building::{Building, Face, MemberKind};
use petgraph::graph::{NodeIndex, UnGraph};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A member as a node.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MemberNode {
    /// Index in `Building::members`.
    pub index: usize,
    /// Member id.
    pub id: String,
    /// Kind.
    pub kind: MemberKind,
    /// Mass properties of the member's own cells.
    pub mass: MassProperties,
}

/// A node of the graph.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "node", rename_all = "snake_case")]
pub enum Node {
    /// A member.
    Member(MemberNode),
    /// The ground, once, as the last node.
    Ground,
}

/// Two members that share faces.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Connection {
    /// Id: `first.place/second`, such as `C1-A1.top/B1-A1-B1`.
    pub id: String,
    /// Indices of the two members. The first is the more slender: column, wall, beam, slab, footing.
    pub members: [usize; 2],
    /// Their ids.
    pub member_ids: [String; 2],
    /// The end of the first member at which the contact lies, if it is a bar and the contact is axial.
    pub end: Option<End>,
    /// Contact faces, largest first.
    pub faces: Vec<ContactFace>,
    /// Area of all faces \[m²\].
    pub area_m2: f64,
    /// Centroid of all faces \[m\].
    pub centroid_m: [f64; 3],
    /// Offset of the centroid from the axis of each member (a bar), or from its mid-plane \[m\].
    pub eccentricity_m: [[f64; 3]; 2],
}

/// A face of a member held by the ground.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SupportFace {
    /// Id, such as `C1-A1.bottom/ground`.
    pub id: String,
    /// Index of the member.
    pub member: usize,
    /// Its id.
    pub member_id: String,
    /// Which face.
    pub face: Face,
    /// The held face: cells of the member that reach the face of its gross solid.
    pub contact: ContactFace,
}

/// An edge of the graph.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "link", rename_all = "snake_case")]
pub enum Link {
    /// Between two members.
    Contact(Connection),
    /// Between a member and the ground.
    Support(SupportFace),
}

/// The structure graph of a building.
#[derive(Debug, Clone)]
pub struct Structure {
    /// Node `i` is member `i`; the last node is the ground. Built once, nothing is ever removed.
    pub graph: UnGraph<Node, Link>,
    /// Disjoint cells from which everything follows.
    pub partition: Partition,
    /// Ends of columns, walls and beams, in the order of the building.
    pub ends: Vec<MemberEnd>,
    /// Gaps below [`NEAR_MISS_M`](super::contact::NEAR_MISS_M) between members that do not touch.
    pub near_misses: Vec<NearMiss>,
    /// What the user should look at, in plain words.
    pub notes: Vec<String>,
    /// Own boxes of each member.
    boxes: Vec<Vec<Aabb>>,
    /// Density of each member \[kg/m³\].
    density_kg_m3: Vec<f64>,
}

impl Structure {
    /// Builds the graph of a building.
    pub fn of(building: &Building) -> Self {
        let partition = Partition::of(building);
        let mut boxes = vec![Vec::new(); building.members.len()];
        for (cell, owner) in partition.cells() {
            boxes[owner].push(partition.cell_box(cell));
        }
        let density_kg_m3: Vec<f64> =
            building.members.iter().map(|m| building.law_of(m).density_kg_m3).collect();
        let supports = support_faces(building, &boxes);
        let held = |index: usize, end: End| {
            let face = if end == End::Low { Face::Bottom } else { Face::Top };
            supports.iter().any(|s| s.member == index && s.face == face)
        };
        let ends = member_ends(building, &partition, &held);
        let pairs = touching_pairs(&partition);
        let near_misses = near_misses(building, &boxes, &pairs.keys().copied().collect());

        let mut graph = UnGraph::default();
        for (index, member) in building.members.iter().enumerate() {
            let mass = MassProperties::of_boxes(boxes[index].iter().map(|b| (b, density_kg_m3[index])));
            graph.add_node(Node::Member(MemberNode {
                index,
                id: member.id.clone(),
                kind: member.kind,
                mass,
            }));
        }
        let ground = graph.add_node(Node::Ground);
        for (pair, touching) in &pairs {
            for connection in connections_of_pair(building, *pair, touching) {
                let [a, b] = connection.members.map(NodeIndex::new);
                graph.add_edge(a, b, Link::Contact(connection));
            }
        }
        for support in supports {
            graph.add_edge(NodeIndex::new(support.member), ground, Link::Support(support));
        }
        let notes = notes(building, &boxes, &ends, &graph);
        Self { graph, partition, ends, near_misses, notes, boxes, density_kg_m3 }
    }

    /// Members in the order of the building.
    pub fn members(&self) -> impl Iterator<Item = &MemberNode> {
        self.graph.node_weights().filter_map(|node| match node {
            Node::Member(member) => Some(member),
            Node::Ground => None,
        })
    }

    /// Connections in a fixed order (by the members' places in the building).
    pub fn connections(&self) -> impl Iterator<Item = &Connection> {
        self.graph.edge_weights().filter_map(|link| match link {
            Link::Contact(connection) => Some(connection),
            Link::Support(_) => None,
        })
    }

    /// Supports in the order of the building file.
    pub fn supports(&self) -> impl Iterator<Item = &SupportFace> {
        self.graph.edge_weights().filter_map(|link| match link {
            Link::Contact(_) => None,
            Link::Support(support) => Some(support),
        })
    }

    /// The member with this id.
    pub fn member(&self, id: &str) -> Option<&MemberNode> {
        self.members().find(|m| m.id == id)
    }

    /// The connection with this id.
    pub fn connection(&self, id: &str) -> Option<&Connection> {
        self.connections().find(|c| c.id == id)
    }

    /// The member end with this id.
    pub fn end(&self, id: &str) -> Option<&MemberEnd> {
        self.ends.iter().find(|e| e.id == id)
    }

    /// The disjoint boxes that a member owns, unmerged.
    pub fn boxes(&self, member: usize) -> &[Aabb] {
        &self.boxes[member]
    }

    /// Mass properties of a set of members as one rigid body, exact from cells.
    pub fn mass_of(&self, members: &[usize]) -> MassProperties {
        MassProperties::of_boxes(
            members.iter().flat_map(|&m| self.boxes[m].iter().map(move |b| (b, self.density_kg_m3[m]))),
        )
    }

    /// Density of a member \[kg/m³\].
    pub fn density_kg_m3(&self, member: usize) -> f64 {
        self.density_kg_m3[member]
    }
}

/// How slender a kind is: the first member of a connection is the most slender one.
fn slenderness(kind: MemberKind) -> u8 {
    match kind {
        MemberKind::Column | MemberKind::Brace => 0,
        MemberKind::Wall => 1,
        MemberKind::Beam => 2,
        MemberKind::Slab => 3,
        MemberKind::Footing => 4,
    }
}

/// One connection for a pair, or one for each place (bottom, top, side) if the first is a column or wall.
fn connections_of_pair(building: &Building, pair: (usize, usize), touching: &Touching) -> Vec<Connection> {
    let (low, high) = pair;
    let largest = touching
        .iter()
        .map(|(key, rectangles)| (key.0, ContactFace::of_rectangles(key.0, 1.0, rectangles).area_m2))
        .fold((0, 0.0), |best, next| if next.1 > best.1 { next } else { best })
        .0;
    let kind = |i: usize| slenderness(building.members[i].kind);
    let axial = |i: usize| bar_axis(&building.members[i]) == Some(largest);
    let swapped = kind(high) < kind(low) || (kind(high) == kind(low) && axial(high) && !axial(low));
    let members = if swapped { [high, low] } else { [low, high] };
    let first = &building.members[members[0]];

    let mut by_place: BTreeMap<(u8, &str), Vec<ContactFace>> = BTreeMap::new();
    for ((axis, _, first_is_low), rectangles) in touching {
        let outward = if *first_is_low != swapped { 1.0 } else { -1.0 };
        let face = ContactFace::of_rectangles(*axis, outward, rectangles);
        let place = if is_upright(first) { place(first, &face) } else { (0, "") };
        by_place.entry(place).or_default().push(face);
    }
    by_place
        .into_values()
        .map(|mut faces| {
            faces.sort_by(|a, b| b.area_m2.total_cmp(&a.area_m2));
            connection(building, members, faces)
        })
        .collect()
}

/// Where on a member a face lies: `(order, name)`.
fn place(member: &crate::building::Member, face: &ContactFace) -> (u8, &'static str) {
    let low = face.centroid_m[face.axis] < member.solid.center()[face.axis];
    match bar_axis(member) {
        Some(axis) if axis == face.axis => {
            let end = if low { End::Low } else { End::High };
            (end as u8, end.name(member.kind))
        }
        _ if face.axis == 2 => {
            (if face.outward < 0.0 { 2 } else { 3 }, if face.outward < 0.0 { "bottom" } else { "top" })
        }
        _ => (4, "side"),
    }
}

/// A connection from its faces, largest first.
fn connection(building: &Building, members: [usize; 2], faces: Vec<ContactFace>) -> Connection {
    let [first, second] = members.map(|i| &building.members[i]);
    let area_m2 = faces.iter().map(|f| f.area_m2).sum::<f64>();
    let centroid_m: [f64; 3] =
        std::array::from_fn(|i| faces.iter().map(|f| f.area_m2 * f.centroid_m[i]).sum::<f64>() / area_m2);
    let (order, name) = place(first, &faces[0]);
    let end =
        (bar_axis(first) == Some(faces[0].axis)).then_some(if order == 0 { End::Low } else { End::High });
    let eccentricity_m = [first, second].map(|member| {
        let center = member.solid.center();
        std::array::from_fn(|i| match bar_axis(member) {
            Some(axis) if i != axis => centroid_m[i] - center[i],
            None if i == member.axis => centroid_m[i] - center[i],
            _ => 0.0,
        })
    });
    Connection {
        id: format!("{}.{name}/{}", first.id, second.id),
        members,
        member_ids: [first.id.clone(), second.id.clone()],
        end,
        faces,
        area_m2,
        centroid_m,
        eccentricity_m,
    }
}

/// The held faces, in the order of the building file. A face that no cell reaches is left out.
fn support_faces(building: &Building, boxes: &[Vec<Aabb>]) -> Vec<SupportFace> {
    let mut faces = Vec::new();
    for support in &building.supports {
        let Some(member) = building.members.iter().position(|m| m.id == support.member) else { continue };
        let solid = &building.members[member].solid;
        let (level, outward, name) = match support.face {
            Face::Bottom => (solid.min[2], -1.0, "bottom"),
            Face::Top => (solid.max[2], 1.0, "top"),
        };
        let rectangles: Vec<Aabb> = boxes[member]
            .iter()
            .filter(|b| {
                let at = if support.face == Face::Bottom { b.min[2] } else { b.max[2] };
                (at - level).abs() < COORDINATE_TOLERANCE_M
            })
            .map(|b| {
                let mut flat = *b;
                flat.min[2] = level;
                flat.max[2] = level;
                flat
            })
            .collect();
        if !rectangles.is_empty() {
            faces.push(SupportFace {
                id: format!("{}.{name}/ground", support.member),
                member,
                member_id: support.member.clone(),
                face: support.face,
                contact: ContactFace::of_rectangles(2, outward, &rectangles),
            });
        }
    }
    faces
}

/// Near misses among the pairs that do not touch.
fn near_misses(
    building: &Building,
    boxes: &[Vec<Aabb>],
    touching: &BTreeSet<(usize, usize)>,
) -> Vec<NearMiss> {
    let mut misses = Vec::new();
    let solids = Boxes::of(building.members.iter().map(|m| m.solid));
    for (i, a) in building.members.iter().enumerate() {
        for j in solids.near(&a.solid, NEAR_MISS_M).into_iter().filter(|j| *j > i) {
            let b = &building.members[j];
            if touching.contains(&(i, j)) || !are_near(&a.solid, &b.solid) {
                continue;
            }
            if let Some((axis, gap_m, facing_area_m2)) = near_miss(&boxes[i], &boxes[j]) {
                misses.push(NearMiss { members: [a.id.clone(), b.id.clone()], axis, gap_m, facing_area_m2 });
            }
        }
    }
    misses
}

/// What looks wrong about a graph.
fn notes(
    building: &Building,
    boxes: &[Vec<Aabb>],
    ends: &[MemberEnd],
    graph: &UnGraph<Node, Link>,
) -> Vec<String> {
    let mut notes = Vec::new();
    for (index, member) in building.members.iter().enumerate() {
        if boxes[index].is_empty() {
            notes.push(format!("{}: lies wholly inside other members and owns no volume", member.id));
        } else if graph.neighbors(NodeIndex::new(index)).next().is_none() {
            notes.push(format!("{}: touches no other member and no support", member.id));
        } else if bar_axis(member).is_some() && ends.binary_search_by(|e| e.member.cmp(&index)).is_err() {
            notes.push(format!("{}: has no clear length outside the joints", member.id));
        }
    }
    notes
}
