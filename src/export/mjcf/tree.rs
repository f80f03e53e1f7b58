//! Which joints carry the tree of bodies, and which close loops.
//!
//! MuJoCo moves bodies by joints in a tree, exactly; a loop is closed by a constraint. Springs and hinges sit on joints of the tree only, and
//! constraints exist for coincident points and welded bodies only. A connection that has springs, or a kind without a constraint, is therefore always part
//! of the tree: where it closes a loop its second body gets a copy that has a share of its mass, and the copy is welded to the body.

use crate::export::opening;
use crate::mbs::math::{dot, norm};
use crate::mbs::model::{Force, Joint, JointKind, Model};
use std::collections::{BTreeMap, VecDeque};

/// What connects two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Via {
    /// A joint, by its place in the model.
    Joint(usize),
    /// A bushing.
    Bushing(usize),
}

/// A connection.
#[derive(Debug, Clone)]
pub(super) struct Edge {
    pub via: Via,
    /// First and second body; `None` is the ground.
    pub bodies: [Option<usize>; 2],
    /// Springs and hinges about it, by their place among the forces.
    pub springs: Vec<usize>,
    /// Whether no constraint can stand for it.
    must: bool,
    /// Whether it has to be a constraint.
    pub loose: bool,
}

/// A body or a copy of one.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub body: usize,
    /// Zero is the body itself.
    pub copy: usize,
    /// The edge to its parent, and whether the parent is the edge's second body; `None`: it floats.
    pub by: Option<(usize, bool)>,
    pub children: Vec<usize>,
}

/// Bodies in the order in which they hang on each other.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub edges: Vec<Edge>,
    pub nodes: Vec<Node>,
    /// Nodes on the ground or floating.
    pub roots: Vec<usize>,
    /// Edges that are constraints.
    pub loops: Vec<usize>,
    /// Number of copies of each body.
    pub copies: Vec<usize>,
    /// Springs and hinges about no joint, by their place among the forces.
    pub unplaced: Vec<usize>,
}

/// Finds the tree.
pub(super) fn tree(model: &Model, loose: bool) -> Tree {
    let count = model.bodies.len();
    let mut t = Tree { copies: vec![0; count], ..edges(model, loose) };
    // those that cannot be constraints first
    let mut usable: Vec<usize> = (0..t.edges.len()).filter(|e| !t.edges[*e].loose).collect();
    usable.sort_by_key(|e| !t.edges[*e].must);
    let mut search =
        Search { at: vec![Vec::new(); count + 1], main: vec![None; count], used: vec![false; t.edges.len()] };
    for e in usable {
        for body in t.edges[e].bodies {
            search.at[body.unwrap_or(count)].push(e);
        }
    }
    search.spread(None, &mut t);
    for body in 0..count {
        if search.main[body].is_none() {
            search.main[body] = Some(t.hang(body, 0, None, None));
            search.spread(Some(body), &mut t);
        }
    }
    for e in (0..t.edges.len()).filter(|e| !search.used[*e]) {
        let [a, b] = t.edges[e].bodies;
        match b.filter(|_| t.edges[e].must && !t.edges[e].loose) {
            Some(b) => {
                t.copies[b] += 1;
                let copy = t.copies[b];
                t.hang(b, copy, a.and_then(|a| search.main[a]), Some((e, false)));
            }
            None => t.loops.push(e),
        }
    }
    t
}

/// What has been reached.
struct Search {
    /// Edges at each body, the ground last.
    at: Vec<Vec<usize>>,
    /// The node of each body.
    main: Vec<Option<usize>>,
    /// Whether an edge is part of the tree.
    used: Vec<bool>,
}

impl Search {
    /// Hangs all that can be reached from a body or the ground, the nearest first.
    fn spread(&mut self, from: Option<usize>, t: &mut Tree) {
        let mut queue = VecDeque::from([from]);
        while let Some(from) = queue.pop_front() {
            for e in std::mem::take(&mut self.at[from.unwrap_or(self.main.len())]) {
                let [a, b] = t.edges[e].bodies;
                let (to, reversed) = if a == from { (b, false) } else { (a, true) };
                if let Some(to) = to.filter(|to| self.main[*to].is_none()) {
                    let parent = from.and_then(|f| self.main[f]);
                    self.main[to] = Some(t.hang(to, 0, parent, Some((e, reversed))));
                    self.used[e] = true;
                    queue.push_back(Some(to));
                }
            }
        }
    }
}

impl Tree {
    fn hang(&mut self, body: usize, copy: usize, parent: Option<usize>, by: Option<(usize, bool)>) -> usize {
        let node = self.nodes.len();
        self.nodes.push(Node { body, copy, by, children: Vec::new() });
        match parent {
            Some(p) => self.nodes[p].children.push(node),
            None => self.roots.push(node),
        }
        node
    }
}

fn edges(model: &Model, loose: bool) -> Tree {
    let index: BTreeMap<&str, usize> =
        model.bodies.iter().enumerate().map(|(i, b)| (b.id.as_str(), i)).collect();
    let of = |id: Option<&str>| id.and_then(|id| index.get(id).copied());
    let opening = opening(model);
    let mut t = Tree::default();
    for (i, joint) in model.joints.iter().enumerate().filter(|(_, j)| j.kind != JointKind::Rod) {
        let constraint = matches!(joint.kind, JointKind::Spherical | JointKind::Revolute | JointKind::Fixed);
        t.edges.push(Edge {
            via: Via::Joint(i),
            bodies: [of(joint.body_a.as_deref()), of(Some(&joint.body_b))],
            springs: Vec::new(),
            must: !constraint,
            loose: loose && constraint && opening.contains(joint.id.as_str()),
        });
    }
    for (i, bushing) in model.bushings.iter().enumerate() {
        let bodies = [of(bushing.body_a.as_deref()), of(Some(&bushing.body_b))];
        t.edges.push(Edge { via: Via::Bushing(i), bodies, springs: Vec::new(), must: true, loose: false });
    }
    for (i, force) in model.forces.iter().enumerate() {
        if !matches!(force, Force::Torsion { .. } | Force::Hinge { .. }) {
            continue;
        }
        match t.edges.iter_mut().find(|e| carries(model, e, force)) {
            Some(edge) if !edge.loose => {
                edge.springs.push(i);
                edge.must = true;
            }
            Some(edge) => edge.springs.push(i),
            None => t.unplaced.push(i),
        }
    }
    t
}

/// Whether a spring or hinge can sit on a connection: the same two bodies, and an axis that is free to turn.
fn carries(model: &Model, edge: &Edge, force: &Force) -> bool {
    let Via::Joint(index) = edge.via else { return false };
    let own: &Joint = &model.joints[index];
    let mut bodies = [own.body_a.as_deref(), Some(own.body_b.as_str())];
    bodies.sort_unstable();
    let mut others = force.bodies();
    others.sort_unstable();
    if bodies[..] != others[..] {
        return false;
    }
    match force {
        Force::Hinge { joint: Some(id), .. } if *id != own.id => false,
        Force::Hinge { .. } => {
            matches!(own.kind, JointKind::Spherical | JointKind::Revolute | JointKind::Cylindrical)
        }
        Force::Torsion { axis, .. } => {
            let turns = match own.kind {
                JointKind::Revolute | JointKind::Cylindrical | JointKind::Planar => [own.axis, None],
                JointKind::Universal => [own.axis, own.axis_b],
                _ => [None, None],
            };
            turns.into_iter().flatten().any(|a| parallel(a, *axis))
        }
        _ => false,
    }
}

/// Whether two directions are one.
pub(super) fn parallel(a: [f64; 3], b: [f64; 3]) -> bool {
    (dot(a, b).abs() / (norm(a) * norm(b)) - 1.0).abs() < 1e-9
}
