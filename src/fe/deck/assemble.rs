//! From tables by identifier to a model by index. Every reference is looked up, every element measured.

use super::error::{At, Messages};
use super::groups::{EVERYWHERE, Groups, unknown};
use super::laws::{PartLaw, law_of};
use super::raw::{Raw, RawDrive, RawHistory, RawStart, RawWall, Who};
use super::read::Ids;
use crate::base::diagnostic::Diagnostic;
use crate::fe::hexahedron::volume_m3;
use crate::fe::law::Law;
use crate::fe::mesh::{Element, Mesh, Truss};
use crate::fe::model::{BodyLoad, Constraint, Control, Curve, DrivenNode, Model, NodalLoad, RigidPlane};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Histories and states where a deck gives no interval: these shares of the end time.
const HISTORIES: f64 = 100.0;
const STATES: f64 = 20.0;

/// The model of a deck; of use only if there are no errors. `end_time_s`: when its run ends, if not at the time of the deck.
pub(super) fn assemble(raw: &Raw, end_time_s: Option<f64>, messages: &mut Messages) -> Option<(Model, Ids)> {
    let groups = Groups::new(raw, messages);
    let mut ids = Ids { nodes: raw.nodes.iter().map(|n| n.id).collect(), ..Ids::default() };
    let mesh = mesh(raw, &groups, &mut ids, messages);
    let mut model = Model { title: raw.title.clone(), mesh, ..Model::default() };
    model.control = control(raw, messages);
    let end_s = end_time_s.unwrap_or(model.control.end_time_s);
    let mut history = |h: RawHistory, at: At, messages: &mut Messages| curve(raw, h, at, end_s, messages);
    for load in &raw.body_loads {
        let acceleration_m_s2 = history(load.history, load.at, messages);
        model.body_loads.push(BodyLoad { axis: load.axis, acceleration_m_s2 });
    }
    for (node, axis, force_n) in spread(&raw.nodal_loads, &groups, &mut history, messages) {
        model.nodal_loads.push(NodalLoad { node, axis, force_n });
    }
    for (node, axis, velocity_m_s) in spread(&raw.driven, &groups, &mut history, messages) {
        model.driven.push(DrivenNode { node, axis, velocity_m_s });
    }
    hold(raw, &groups, &mut model, messages);
    moved_once(raw, &groups, messages);
    moved_in_vain(raw, &groups, messages);
    model.initial_velocity_m_s = starts(raw, &groups, messages);
    model.walls = raw.walls.iter().map(|w| wall(raw, w, &groups, messages)).collect();
    model.body_contact = raw.contact;
    contact_of_all(raw, messages);
    // a node has one history, however often it is asked for
    let mut recorded = HashSet::new();
    for (who, at) in &raw.history {
        let nodes = groups.nodes(who, *at, messages);
        model.control.history_nodes.extend(nodes.into_iter().filter(|n| recorded.insert(*n)));
    }
    for erosion in raw.erosions.iter().filter(|e| !raw.materials.contains_key(&e.material)) {
        unknown(erosion.at, "material", erosion.material, "one of the *MAT keywords", messages);
    }
    for (id, (_, at)) in &raw.part_sets {
        let members = &raw.part_sets[id].0;
        for part in members.iter().filter(|p| !raw.parts.iter().any(|q| q.id == **p)) {
            unknown(*at, "part", *part, "*PART", messages);
        }
    }
    (!messages.any()).then_some((model, ids))
}

fn control(raw: &Raw, messages: &mut Messages) -> Control {
    let Some(end_time_s) = raw.end_time else {
        let message = "the deck has no end time".to_string();
        messages.error(At::default(), "missing-keyword", message, "", "give it with *CONTROL_TERMINATION");
        return Control::default();
    };
    let histories = [raw.history_interval, raw.energy_interval].into_iter().flatten().reduce(f64::min);
    Control {
        end_time_s,
        step_safety: raw.step_safety.unwrap_or(crate::fe::dynamics::STEP_SAFETY),
        mass_scaling_step_s: raw.mass_scaling,
        state_interval_s: raw
            .state_count
            .map(|n| end_time_s / n as f64)
            .or(raw.state_interval)
            .unwrap_or(end_time_s / STATES),
        history_interval_s: histories.unwrap_or(end_time_s / HISTORIES),
        history_nodes: Vec::new(),
    }
}

fn mesh(raw: &Raw, groups: &Groups<'_>, ids: &mut Ids, messages: &mut Messages) -> Mesh {
    let mut mesh = Mesh { nodes: raw.nodes.iter().map(|n| n.x).collect(), ..Mesh::default() };
    let mut part_of: HashMap<u64, usize> = HashMap::new();
    let mut laws: Vec<Option<(usize, Option<f64>)>> = Vec::new();
    for part in &raw.parts {
        if part_of.insert(part.id, mesh.parts.len()).is_some() {
            let message = format!("*PART: {} is defined twice", part.id);
            messages.error(part.at, "duplicate-id", message, "", "give one of them another identifier");
        }
        mesh.parts.push(part.name.clone());
        ids.parts.push(part.id);
        laws.push(law_of(raw, part, messages).map(|law| match law {
            PartLaw::Solid(law) => (enter(&mut mesh.laws, law), None),
            PartLaw::Truss(law, area) => (enter(&mut mesh.laws, law), Some(area)),
        }));
    }
    let mut seen = HashSet::new();
    for solid in &raw.solids {
        let part = element_part(solid.id, solid.part, solid.at, &part_of, &mut seen, messages);
        let nodes = solid_nodes(solid.id, &solid.nodes, solid.at, groups, messages);
        let (Some(part), Some(nodes)) = (part, nodes) else { continue };
        match laws[part] {
            Some((law, None)) => {
                check_shape(solid.id, &nodes.map(|n| mesh.nodes[n]), solid.at, messages);
                mesh.elements.push(Element { nodes, part, law, smear: 1.0, strength: 1.0 });
                ids.elements.push(solid.id);
            }
            Some((_, Some(_))) => {
                wrong_kind(solid.id, solid.part, "solid", "*SECTION_SOLID", solid.at, messages)
            }
            None => {}
        }
    }
    for beam in &raw.beams {
        let part = element_part(beam.id, beam.part, beam.at, &part_of, &mut seen, messages);
        let nodes = beam.nodes.map(|n| groups.node(n, beam.at, messages));
        let (Some(part), [Some(a), Some(b)]) = (part, nodes) else { continue };
        if mesh.nodes[a] == mesh.nodes[b] {
            let message = format!("bar {} has no length", beam.id);
            messages.error(beam.at, "bad-element", message, "", "its nodes stand at two different points");
        }
        match laws[part] {
            Some((law, Some(area_m2))) => {
                mesh.trusses.push(Truss { nodes: [a, b], area_m2, part, law });
                ids.trusses.push(beam.id);
            }
            Some((_, None)) => wrong_kind(beam.id, beam.part, "beam", "*SECTION_BEAM", beam.at, messages),
            None => {}
        }
    }
    if raw.solids.is_empty() && raw.beams.is_empty() {
        let message = "the deck has no elements".to_string();
        messages.error(At::default(), "missing-keyword", message, "", "give them with *ELEMENT_SOLID");
    }
    let mut order: Vec<usize> = (0..mesh.elements.len()).collect();
    order.sort_by_key(|e| mesh.elements[*e].law);
    mesh.elements = order.iter().map(|e| mesh.elements[*e]).collect();
    ids.elements = order.iter().map(|e| ids.elements[*e]).collect();
    mesh
}

/// Contact between named parts has to mean all parts with solid elements.
fn contact_of_all(raw: &Raw, messages: &mut Messages) {
    let Some((who, at)) = &raw.contact_parts else { return };
    let one;
    let named: &[u64] = match who {
        Who::PartSet(id) => match raw.part_sets.get(id) {
            Some((parts, _)) => parts,
            None => return unknown(*at, "set of parts", *id, "*SET_PART_LIST", messages),
        },
        Who::Part(id) => {
            one = [*id];
            &one
        }
        _ => return,
    };
    if let Some(solid) = raw.solids.iter().find(|s| !named.contains(&s.part)) {
        let message = format!("the contact leaves out part {}", solid.part);
        let help = "contact is between all outer faces of the model: SSID = 0";
        messages.error(*at, "unsupported-value", message, "", help);
    }
}

/// Index of a law, which is entered unless it is there.
fn enter(laws: &mut Vec<Law>, law: Law) -> usize {
    laws.iter().position(|l| *l == law).unwrap_or_else(|| {
        laws.push(law);
        laws.len() - 1
    })
}

fn element_part(
    id: u64,
    part: u64,
    at: At,
    part_of: &HashMap<u64, usize>,
    seen: &mut HashSet<u64>,
    messages: &mut Messages,
) -> Option<usize> {
    if !seen.insert(id) {
        let message = format!("element {id} is defined twice");
        messages.error(at, "duplicate-id", message, "", "give one of them another identifier");
    }
    let found = part_of.get(&part).copied();
    if found.is_none() {
        unknown(at, "part", part, "*PART", messages);
    }
    found
}

fn wrong_kind(id: u64, part: u64, kind: &str, keyword: &str, at: At, messages: &mut Messages) {
    let message = format!("{kind} element {id} is in part {part}, whose section is of another kind");
    messages.error(at, "bad-element", message, "", &format!("give the part a {keyword}"));
}

/// Eight different nodes.
fn solid_nodes(
    id: u64,
    nodes: &[u64; 8],
    at: At,
    groups: &Groups<'_>,
    messages: &mut Messages,
) -> Option<[usize; 8]> {
    let repeated = (0..8).any(|i| nodes[i] == 0 || nodes[..i].contains(&nodes[i]));
    if repeated {
        let message =
            format!("solid element {id} is a wedge, a pyramid or a tetrahedron: a node is repeated");
        let help = "only hexahedra with eight different nodes are computed; split the body into such";
        messages.error(at, "bad-element", message, "", help);
        return None;
    }
    let mut found = [0; 8];
    for (slot, node) in found.iter_mut().zip(nodes) {
        *slot = groups.node(*node, at, messages)?;
    }
    Some(found)
}

/// A positive volume, and at every corner edges that span a positive one.
fn check_shape(id: u64, x: &[[f64; 3]; 8], at: At, messages: &mut Messages) {
    // the three neighbours of each corner, so that their triple product is positive in a cube
    const EDGES: [[usize; 3]; 8] =
        [[1, 3, 4], [2, 0, 5], [3, 1, 6], [0, 2, 7], [7, 5, 0], [4, 6, 1], [5, 7, 2], [6, 4, 3]];
    let edge = |from: usize, to: usize| -> [f64; 3] { std::array::from_fn(|i| x[to][i] - x[from][i]) };
    let triple = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let corner = |i: usize| {
        let [a, b, c] = EDGES[i];
        triple(edge(i, a), edge(i, b), edge(i, c))
    };
    // nodes that are no numbers have been told
    if x.iter().flatten().any(|v| !v.is_finite()) {
        return;
    }
    let volume = volume_m3(x);
    let good = |v: f64| v > 0.0 && v.is_finite();
    if good(volume) && (0..8).all(|i| good(corner(i))) {
        return;
    }
    let (what, help) = if volume < 0.0 && (0..8).all(|i| corner(i) < 0.0) {
        ("is inside out", "swap its first four nodes with its last four")
    } else {
        (
            "is too distorted",
            "nodes 1 to 4 go round one face and 5 to 8 round the opposite one, with a positive volume at every corner",
        )
    };
    let message = format!("solid element {id} {what}: its volume is {volume:.6e}");
    messages.error(at, "bad-element", message, "", help);
}

/// A curve with its factor.
fn curve(raw: &Raw, history: RawHistory, at: At, end_s: f64, messages: &mut Messages) -> Curve {
    let Some((points, _)) = raw.curves.get(&history.curve) else {
        unknown(at, "curve", history.curve, "*DEFINE_CURVE", messages);
        return Curve::default();
    };
    let short = points.first().is_some_and(|p| p[0] > 0.0) || points.last().is_some_and(|p| p[0] < end_s);
    if short && points.len() > 1 {
        let text = format!(
            "curve {} does not span the run; outside it keeps its last value, elsewhere it may be zero there",
            history.curve
        );
        messages.note(at, text);
    }
    Curve::new(points.iter().map(|p| [p[0], history.factor * p[1]]).collect())
}

/// Loads on sets as loads on nodes.
fn spread(
    drives: &[RawDrive],
    groups: &Groups<'_>,
    history: &mut dyn FnMut(RawHistory, At, &mut Messages) -> Curve,
    messages: &mut Messages,
) -> Vec<(usize, usize, Curve)> {
    let mut list = Vec::new();
    for drive in drives {
        let curve = history(drive.history, drive.at, messages);
        for node in groups.nodes(&drive.who, drive.at, messages) {
            list.push((node, drive.axis, curve.clone()));
        }
    }
    list
}

/// A node has one motion in each direction.
fn moved_once(raw: &Raw, groups: &Groups<'_>, messages: &mut Messages) {
    let mut first: HashMap<(usize, usize), usize> = HashMap::new();
    let mut told = HashSet::new();
    for (number, drive) in raw.driven.iter().enumerate() {
        // what a set lacks is told where its loads are spread
        for node in groups.nodes(&drive.who, drive.at, &mut Messages::default()) {
            let held = *first.entry((node, drive.axis)).or_insert(number);
            if held != number && told.insert((held, number)) {
                moved_twice(raw.nodes[node].id, [raw.driven[held].at, drive.at], messages);
            }
        }
    }
}

/// Loads and motions belong to nodes of elements: others have no mass and move nothing, as doubled nodes of a mesh that was not merged.
fn moved_in_vain(raw: &Raw, groups: &Groups<'_>, messages: &mut Messages) {
    let solids = raw.solids.iter().flat_map(|s| &s.nodes);
    let used: HashSet<u64> = solids.chain(raw.beams.iter().flat_map(|b| &b.nodes)).copied().collect();
    for (what, drives) in [("loaded", &raw.nodal_loads), ("moved", &raw.driven)] {
        for drive in drives {
            let nodes = groups.nodes(&drive.who, drive.at, &mut Messages::default());
            let mut free = nodes.into_iter().map(|n| raw.nodes[n].id).filter(|id| !used.contains(id));
            let Some(first) = free.next() else { continue };
            let message = match free.count() {
                0 => format!("node {first} is {what}, but belongs to no element"),
                n => format!("node {first} and {n} more are {what}, but belong to no element"),
            };
            let help = "merge it with the node of the mesh that is meant, or take it out";
            messages.error(drive.at, "loose-node", message, "", help);
        }
    }
}

/// Two motions of a node in one direction, each with its place.
fn moved_twice(node: u64, [first, second]: [At; 2], messages: &mut Messages) {
    let message = format!("node {node} is moved twice in the same direction");
    let help = "take one of the two out, or the node out of one of their sets; motions that belong together are one curve";
    if first.file == second.file {
        let item = Diagnostic::error("moved-twice", message)
            .at((second.start..second.end).into(), "again here")
            .also((first.start..first.end).into(), "first here")
            .help(help);
        return messages.push(second.file, item);
    }
    messages.error(first, "moved-twice", message.clone(), "here, and in another file of the deck", help);
    messages.error(second, "moved-twice", message, "here, and in another file of the deck", help);
}

/// Nodes held in all directions go to the mesh, the others to the constraints.
fn hold(raw: &Raw, groups: &Groups<'_>, model: &mut Model, messages: &mut Messages) {
    let mut held: BTreeMap<usize, [bool; 3]> = BTreeMap::new();
    let mut join = |node: usize, more: [bool; 3]| {
        let held = held.entry(node).or_default();
        *held = std::array::from_fn(|i| held[i] || more[i]);
    };
    for (index, node) in raw.nodes.iter().enumerate().filter(|(_, n)| n.held > 0) {
        // 1 x, 2 y, 3 z, 4 xy, 5 yz, 6 zx, 7 all
        let code = node.held;
        join(index, [[1, 4, 6, 7], [2, 4, 5, 7], [3, 5, 6, 7]].map(|codes| codes.contains(&code)));
    }
    for hold in &raw.holds {
        for node in groups.nodes(&hold.who, hold.at, messages) {
            join(node, hold.held);
        }
    }
    for drive in &raw.driven {
        // what a set lacks is told where its motions are spread
        let nodes = groups.nodes(&drive.who, drive.at, &mut Messages::default());
        let both = nodes.iter().find(|n| held.get(n).is_some_and(|h| h[drive.axis]));
        if let Some(node) = both {
            let message = format!("node {} is held and moved in the same direction", raw.nodes[*node].id);
            messages.error(drive.at, "held-and-moved", message, "", "take one of the two out");
        }
    }
    for (node, held) in held {
        match held {
            [true, true, true] => model.mesh.fixed.push(node),
            [false, false, false] => {}
            _ => model.constraints.push(Constraint { node, held }),
        }
    }
}

/// Velocities at the start, later ones over earlier ones.
fn starts(raw: &Raw, groups: &Groups<'_>, messages: &mut Messages) -> Vec<(usize, [f64; 3])> {
    let mut found: BTreeMap<usize, [f64; 3]> = BTreeMap::new();
    for start in &raw.starts {
        let nodes = groups.nodes(&start.who, start.at, messages);
        let mut others: Option<(HashSet<usize>, Option<[f64; 3]>)> = None;
        if let Some((set, velocity)) = start.without {
            others = Some((groups.nodes(&Who::Set(set), start.at, messages).into_iter().collect(), velocity));
        }
        let sides = start.inside.map_or(EVERYWHERE, |id| groups.limits(id, start.at, messages));
        let inside = |x: [f64; 3]| (0..3).all(|i| x[i] >= sides[i][0] && x[i] <= sides[i][1]);
        let mut given = 0;
        for node in nodes.iter().copied().filter(|n| inside(raw.nodes[*n].x)) {
            let velocity = match &others {
                Some((set, velocity)) if set.contains(&node) => *velocity,
                _ => Some(velocity_at(start, raw.nodes[node].x)),
            };
            if let Some(velocity) = velocity {
                found.insert(node, velocity);
                given += 1;
            }
        }
        if given == 0 && !nodes.is_empty() {
            let message = "the initial velocity is given to no node".to_string();
            let help = "none of the nodes meant lies in the box BOXID and out of the set NSIDEX: change these, or take the velocity out";
            messages.error(start.at, "no-nodes", message, "", help);
        }
    }
    found.into_iter().filter(|(_, v)| *v != [0.0; 3]).collect()
}

fn velocity_at(start: &RawStart, x: [f64; 3]) -> [f64; 3] {
    let Some((w, center)) = start.spin else { return start.velocity };
    let r: [f64; 3] = std::array::from_fn(|i| x[i] - center[i]);
    let turn = [w[1] * r[2] - w[2] * r[1], w[2] * r[0] - w[0] * r[2], w[0] * r[1] - w[1] * r[0]];
    std::array::from_fn(|i| start.velocity[i] + turn[i])
}

fn wall(raw: &Raw, wall: &RawWall, groups: &Groups<'_>, messages: &mut Messages) -> RigidPlane {
    let along: [f64; 3] = std::array::from_fn(|i| wall.head[i] - wall.tail[i]);
    let length = along.iter().map(|c| c * c).sum::<f64>().sqrt();
    let normal = along.map(|c| c / length);
    let height = |x: [f64; 3]| (0..3).map(|i| (x[i] - wall.tail[i]) * normal[i]).sum::<f64>();
    let before = messages.count();
    let mut nodes = (wall.set > 0).then(|| groups.nodes(&Who::Set(wall.set), wall.at, messages));
    if wall.within > 0.0 {
        let near = (0..raw.nodes.len()).filter(|n| height(raw.nodes[*n].x).abs() <= wall.within);
        let list = nodes.get_or_insert_default();
        list.extend(near);
        list.sort_unstable();
        list.dedup();
    }
    if wall.without > 0 {
        let out: HashSet<usize> =
            groups.nodes(&Who::Set(wall.without), wall.at, messages).into_iter().collect();
        let list = nodes.get_or_insert_with(|| (0..raw.nodes.len()).collect());
        list.retain(|n| !out.contains(n));
    }
    if nodes.as_ref().is_some_and(Vec::is_empty) && messages.count() == before {
        let message = "the wall stops no node".to_string();
        let help = "no node lies within OFFSET of it, or all of its nodes are in the set NSIDEX: change these, or take the wall out";
        messages.error(wall.at, "no-nodes", message, "", help);
    }
    let size = raw.nodes.iter().flat_map(|n| n.x).map(f64::abs).fold(0.0, f64::max);
    let count = match &nodes {
        Some(list) => list.iter().filter(|n| height(raw.nodes[**n].x) < -1e-6 * size).count(),
        None => raw.nodes.iter().filter(|n| height(n.x) < -1e-6 * size).count(),
    };
    if count > 0 {
        messages.note(
            wall.at,
            format!("{count} nodes lie behind this wall at the start; they are kept from going further"),
        );
    }
    RigidPlane { point_m: wall.tail, normal, friction: wall.friction, nodes }
}
