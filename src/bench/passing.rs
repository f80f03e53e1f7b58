//! Whether bodies passed through the ground, obstacles or each other, seen from the frames of a run.
//!
//! The contact solver is not asked: from the poses alone, each output compares all solids by the fifteen axes that tell two boxes apart. What counts is by how much two solids overlap more than they did
//! when they became able to touch: at the start, or when what joined them broke. Bodies that are joined may overlap (a column turns about a hinge inside the floor). Something that passes through another thing is inside it on the way, so nothing can pass unseen as
//! long as no corner moves farther between two outputs than the thinnest solid is thick ([`Passing::is_seen`]).

use crate::mbs::math::{V3, add, cross, dot, mul, norm, qmat, sub, transpose};
use crate::mbs::model::{Model, Shape};
use crate::mbs::result::{CrushedHistory, EventKind, FractureCause, Frame, RunResult};
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// How deep bodies went into what they should not.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Passing {
    /// Into the ground.
    pub ground: Deepest,
    /// Into obstacles.
    pub obstacle: Deepest,
    /// Into each other.
    pub bodies: Deepest,
    /// The largest of the last two over the thickness of the thinner of the two solids.
    pub share: f64,
    /// Longest way of a corner between two outputs \[m\].
    pub travel_m: f64,
    /// Thickness of the thinnest solid \[m\].
    pub thinnest_m: f64,
}

/// Where something was deepest in something else.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deepest {
    /// How deep \[m\].
    pub depth_m: f64,
    /// The body; of two in each other the lighter one.
    pub body: usize,
    /// When \[s\].
    pub time_s: f64,
}

impl Deepest {
    fn note(&mut self, depth_m: f64, body: usize, time_s: f64) {
        if depth_m > self.depth_m {
            *self = Self { depth_m, body, time_s };
        }
    }
}

impl Passing {
    /// Whether no solid can have passed through another one between two outputs.
    pub fn is_seen(&self) -> bool {
        self.travel_m < self.thinnest_m
    }
}

/// A solid at an output.
#[derive(Debug, Clone, Copy)]
struct Placed {
    /// Body; none: an obstacle.
    body: Option<usize>,
    center: V3,
    /// Directions of the edges.
    axes: [V3; 3],
    half: V3,
    /// Half edge lengths of the box along the global axes around it.
    reach: V3,
}

/// Looks at all outputs of a run.
pub fn passing(model: &Model, result: &RunResult) -> Passing {
    let apart = passes_through(model);
    let thin = |shape: &Shape| 2.0 * least(shape.bounds()[1]);
    let mut all = Passing {
        thinnest_m: model.bodies.iter().flat_map(|b| &b.shapes).map(thin).fold(f64::INFINITY, f64::min),
        ..Passing::default()
    };
    let level = model.contact.ground.as_ref().map(|g| g.level_m);
    let mut ties = Ties::of(model, result);
    let mut joined = ties.joined();
    let mut allowed = Allowed::default();
    let mut shapes = Shapes::of(model, result);
    for (output, (frame, time_s)) in result.frames.iter().zip(&result.times_s).enumerate() {
        if ties.at(*time_s) {
            joined = ties.joined();
        }
        shapes.at(model, output);
        let solids = placed((model, &shapes), frame, &ties.alive);
        all.travel_m = all.travel_m.max(allowed.travel(&solids));
        for (i, solid) in solids.iter().enumerate() {
            if let (Some(level), Some(Placed { body: Some(body), .. })) = (level, solid) {
                let deep = level - lowest(&shapes, frame, i, *body);
                let beyond = allowed.beyond((i, GROUND), deep, !joined.ground.contains(body));
                all.ground.note(beyond, *body, *time_s);
            }
        }
        for (i, j) in near(&solids) {
            let (Some(a), Some(b)) = (&solids[i], &solids[j]) else { continue };
            let may = match (a.body, b.body) {
                (Some(x), Some(y)) if [x, y].iter().any(|i| ties.crushed.contains(i)) => false,
                (Some(x), Some(y)) => !apart.contains(&key(x, y)) && !joined.pairs.contains(&key(x, y)),
                _ => true,
            };
            let beyond = allowed.beyond((i, j), a.overlap(b), may);
            let mass = |body: &usize| model.bodies[*body].mass_kg;
            let lighter = [a.body, b.body].into_iter().flatten().min_by(|x, y| mass(x).total_cmp(&mass(y)));
            let of = if b.body.is_some() { &mut all.bodies } else { &mut all.obstacle };
            of.note(beyond, lighter.unwrap_or_default(), *time_s);
            all.share = all.share.max(0.5 * beyond / least(a.half).min(least(b.half)));
        }
        allowed.close(solids);
    }
    all
}

/// The place of the ground among the solids.
const GROUND: usize = usize::MAX;

/// Pairs of bodies that a model lets pass through each other.
fn passes_through(model: &Model) -> BTreeSet<(usize, usize)> {
    if model.contact.bodies.is_none() {
        return (0..model.bodies.len()).flat_map(|a| (0..a).map(move |b| (b, a))).collect();
    }
    let ignored = model.contact.pairs.iter().filter(|p| p.ignore);
    ignored.filter_map(|p| Some(key(body_of(model, &p.a)?, body_of(model, &p.b)?))).collect()
}

fn least(half: V3) -> f64 {
    half.into_iter().fold(f64::INFINITY, f64::min)
}

/// The shapes of all bodies, boxes as short as they have been crushed.
struct Shapes<'a> {
    of: Vec<Vec<Shape>>,
    /// Faces that are crushed: body, shape.
    crushed: Vec<(usize, &'a CrushedHistory)>,
}

impl<'a> Shapes<'a> {
    fn of(model: &Model, result: &'a RunResult) -> Self {
        let any = |c: &&CrushedHistory| c.depth_m.iter().any(|depth| *depth > 0.0);
        let of = |c: &'a CrushedHistory| Some((body_of(model, &c.body)?, c));
        let crushed = result.crushed.iter().filter(any).filter_map(of).collect();
        Self { of: model.bodies.iter().map(|b| b.shapes.clone()).collect(), crushed }
    }

    /// Those at an output.
    fn at(&mut self, model: &Model, output: usize) {
        for (body, face) in &self.crushed {
            self.of[*body][face.shape].clone_from(&model.bodies[*body].shapes[face.shape]);
        }
        for (body, face) in &self.crushed {
            face.shorten(&mut self.of[*body][face.shape], output);
        }
    }
}

/// Height of the lowest corner of a solid of a body \[m\].
fn lowest(shapes: &Shapes, frame: &Frame, solid: usize, body: usize) -> f64 {
    let before: usize = shapes.of[..body].iter().map(Vec::len).sum();
    let r = qmat(frame.orientation[body]);
    let height = |c: V3| frame.position_m[body][2] + mul(&r, c)[2];
    shapes.of[body][solid - before].corners().into_iter().map(height).fold(f64::INFINITY, f64::min)
}

fn body_of(model: &Model, id: &str) -> Option<usize> {
    model.bodies.iter().position(|b| b.id == id)
}

fn key(a: usize, b: usize) -> (usize, usize) {
    (a.min(b), a.max(b))
}

impl Placed {
    fn new(body: Option<usize>, center: V3, axes: [V3; 3], half: V3) -> Self {
        let reach = std::array::from_fn(|i| (0..3).map(|k| half[k] * axes[k][i].abs()).sum());
        Self { body, center, axes, half, reach }
    }

    /// Half its extent along a direction of length one.
    fn extent(&self, n: V3) -> f64 {
        (0..3).map(|k| self.half[k] * dot(self.axes[k], n).abs()).sum()
    }

    /// The least shift that parts it from another one \[m\]; zero or less: they are apart.
    fn overlap(&self, other: &Self) -> f64 {
        let between = sub(other.center, self.center);
        let along = |n: V3| self.extent(n) + other.extent(n) - dot(between, n).abs();
        let faces = self.axes.iter().chain(&other.axes).map(|n| along(*n));
        let edges = self.axes.iter().flat_map(|a| other.axes.iter().map(|b| cross(*a, *b))).filter_map(|n| {
            // edges that are nearly parallel are told apart by the faces
            let length = norm(n);
            (length > 1e-3).then(|| along(n.map(|v| v / length)))
        });
        faces.chain(edges).fold(f64::INFINITY, f64::min)
    }

    /// A bound on the way of any of its points from an earlier pose \[m\].
    fn travel(&self, before: &Self) -> f64 {
        let turned = (0..3).map(|k| self.half[k] * norm(sub(self.axes[k], before.axes[k]))).sum::<f64>();
        norm(sub(self.center, before.center)) + turned
    }
}

/// The boxes around all shapes at an output, those of removed bodies left out; then the obstacles.
fn placed((model, shapes): (&Model, &Shapes), frame: &Frame, alive: &[bool]) -> Vec<Option<Placed>> {
    let mut list = Vec::new();
    for (i, own) in shapes.of.iter().enumerate() {
        let r = qmat(frame.orientation[i]);
        for shape in own {
            let (center, half, own) = match shape {
                Shape::Box { center_m, half_extents_m, orientation: Some(q) } => {
                    (*center_m, *half_extents_m, transpose(&qmat(*q)))
                }
                other => {
                    let [center, half] = other.bounds();
                    (center, half, UNIT)
                }
            };
            let at = add(frame.position_m[i], mul(&r, center));
            list.push(alive[i].then(|| Placed::new(Some(i), at, own.map(|e| mul(&r, e)), half)));
        }
    }
    list.extend(model.contact.obstacles.iter().map(|o| {
        let center = std::array::from_fn(|i| 0.5 * (o.min_m[i] + o.max_m[i]));
        Some(Placed::new(None, center, UNIT, sub(o.max_m, center)))
    }));
    list
}

const UNIT: [V3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Pairs of solids of different bodies whose surrounding boxes overlap.
fn near(solids: &[Option<Placed>]) -> Vec<(usize, usize)> {
    let mut all: Vec<(usize, Placed)> =
        solids.iter().enumerate().filter_map(|(i, s)| Some((i, (*s)?))).collect();
    all.sort_by(|a, b| (a.1.center[0] - a.1.reach[0]).total_cmp(&(b.1.center[0] - b.1.reach[0])));
    let mut pairs = Vec::new();
    for (k, (i, a)) in all.iter().enumerate() {
        let end = a.center[0] + a.reach[0];
        for (j, b) in all[k + 1..].iter().take_while(|(_, b)| b.center[0] - b.reach[0] <= end) {
            let overlap = |c: usize| (a.center[c] - b.center[c]).abs() <= a.reach[c] + b.reach[c];
            if a.body != b.body && overlap(1) && overlap(2) {
                pairs.push(key(*i, *j));
            }
        }
    }
    pairs
}

/// How much solids may overlap: what they did when they became able to touch, and less once they did less.
#[derive(Debug, Default)]
struct Allowed {
    /// For pairs of solids that overlapped at the last output: by how much they may, and whether they could touch.
    last: BTreeMap<(usize, usize), (f64, bool)>,
    now: BTreeMap<(usize, usize), (f64, bool)>,
    solids: Option<Vec<Option<Placed>>>,
}

impl Allowed {
    /// By how much an overlap is beyond what two solids may, which can touch or not \[m\].
    fn beyond(&mut self, pair: (usize, usize), overlap: f64, may: bool) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        let (before, could) = self.last.get(&pair).copied().unwrap_or((0.0, self.solids.is_some()));
        // what came apart since the last output did so at some overlap in between
        let allowed = if may && could { before } else { overlap.max(before) };
        self.now.insert(pair, (allowed.min(overlap), may));
        (overlap - allowed).max(0.0)
    }

    /// Longest way of a point since the last output \[m\].
    fn travel(&self, solids: &[Option<Placed>]) -> f64 {
        let before = self.solids.iter().flatten();
        before.zip(solids).filter_map(|(b, a)| Some((*a)?.travel(&(*b)?))).fold(0.0, f64::max)
    }

    /// Ends an output.
    fn close(&mut self, solids: Vec<Option<Placed>>) {
        self.last = std::mem::take(&mut self.now);
        self.solids = Some(solids);
    }
}

/// What joins bodies, up to a time.
struct Ties {
    /// Connections that are there: id, bodies (none: the ground), and whether both are pieces of one body at the start.
    list: Vec<(String, [Option<usize>; 2], bool)>,
    /// Latent bushings whose pieces are one body yet.
    whole: BTreeSet<String>,
    /// Bodies that are there, and those that are crushed, or were one body with what was: they touch no other bodies.
    alive: Vec<bool>,
    crushed: BTreeSet<usize>,
    /// Ends of connections and bodies in order of time \[s\].
    ends: Vec<(f64, End)>,
}

enum End {
    /// Of a connection; it counts at an output at the same time.
    Of(String),
    /// The same, with the second of its bodies.
    Crushed(String),
    /// Of what made two pieces one body.
    Whole(String),
    /// Of a body; an output at the same time comes first.
    Body(usize),
}

/// Bodies that do not touch each other, or the ground.
struct Joined {
    pairs: BTreeSet<(usize, usize)>,
    ground: BTreeSet<usize>,
}

impl Ties {
    fn of(model: &Model, result: &RunResult) -> Self {
        let at =
            |a: &Option<String>, b: &str| [a.as_ref().and_then(|a| body_of(model, a)), body_of(model, b)];
        let joints = model.joints.iter().map(|j| (j.id.clone(), at(&j.body_a, &j.body_b), false));
        let bushings =
            model.bushings.iter().map(|b| (b.id.clone(), at(&b.body_a, &b.body_b), b.latent.is_some()));
        let mut ends = Vec::new();
        for event in &model.events {
            ends.extend(event.release.iter().map(|id| (event.time_s, End::Of(id.clone()))));
            let bodies = event.remove_bodies.iter().filter_map(|id| body_of(model, id));
            ends.extend(bodies.map(|body| (event.time_s, End::Body(body))));
        }
        ends.extend(result.events.iter().filter_map(|e| match &e.kind {
            EventKind::Fracture { joint, cause: FractureCause::Compression } => {
                Some((e.time_s, End::Crushed(joint.clone())))
            }
            EventKind::Fracture { joint, .. } => Some((e.time_s, End::Of(joint.clone()))),
            EventKind::Live { joint, .. } => Some((e.time_s, End::Whole(joint.clone()))),
            _ => None,
        }));
        ends.sort_by(|a, b| b.0.total_cmp(&a.0));
        let alive = vec![true; model.bodies.len()];
        let latent = model.bushings.iter().filter(|b| b.latent.is_some());
        let whole = latent.map(|b| b.id.clone()).collect();
        Self { list: joints.chain(bushings).collect(), whole, alive, crushed: BTreeSet::new(), ends }
    }

    /// Goes on to an output; whether anything has ended.
    fn at(&mut self, time_s: f64) -> bool {
        let count = self.ends.len();
        while let Some((end_s, end)) = self.ends.last() {
            match end {
                End::Of(id) | End::Crushed(id) if *end_s <= time_s => {
                    if matches!(end, End::Crushed(_)) {
                        self.crushed.extend(self.one_with_second_of(id));
                    }
                    self.list.retain(|(own, ..)| own != id);
                }
                End::Whole(id) if *end_s <= time_s => _ = self.whole.remove(id),
                End::Body(body) if *end_s < time_s - 1e-9 => {
                    self.alive[*body] = false;
                    self.list.retain(|(_, bodies, _)| !bodies.contains(&Some(*body)));
                }
                _ => break,
            }
            self.ends.pop();
        }
        self.ends.len() < count
    }

    /// The set that each body is in, of those that some connections make one.
    fn sets(&self, is_one: impl Fn(&str, bool) -> bool) -> Vec<usize> {
        let mut sets = UnionFind::<usize>::new(self.alive.len());
        for (id, bodies, pieces) in &self.list {
            if let (true, [Some(a), Some(b)]) = (is_one(id, *pieces), bodies) {
                sets.union(*a, *b);
            }
        }
        sets.into_labeling()
    }

    /// The second body of a connection, with what is one body with it yet.
    fn one_with_second_of(&self, id: &str) -> Vec<usize> {
        let labels = self.sets(|latent, _| self.whole.contains(latent));
        let second = self.list.iter().find(|(own, ..)| own == id).and_then(|(_, bodies, _)| bodies[1]);
        (0..labels.len()).filter(|body| second.is_some_and(|own| labels[own] == labels[*body])).collect()
    }

    /// Who is joined now; pieces of a body that parted do not touch what the others of their set are joined to.
    fn joined(&self) -> Joined {
        let labels = self.sets(|_, pieces| pieces);
        let of = |body: usize| -> Vec<usize> {
            let together = |i: &usize| labels[*i] == labels[body];
            (0..labels.len()).filter(together).collect()
        };
        let mut joined = Joined { pairs: BTreeSet::new(), ground: BTreeSet::new() };
        for (_, bodies, _) in &self.list {
            match *bodies {
                [Some(a), Some(b)] => {
                    let others = of(b);
                    joined.pairs.extend(of(a).iter().flat_map(|x| others.iter().map(|y| key(*x, *y))));
                }
                [None, Some(b)] => joined.ground.extend(of(b)),
                _ => {}
            }
        }
        joined
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(center: V3, half: V3, turn_rad: f64) -> Placed {
        let q = [(0.5 * turn_rad).cos(), 0.0, 0.0, (0.5 * turn_rad).sin()];
        Placed::new(Some(0), center, UNIT.map(|e| mul(&qmat(q), e)), half)
    }

    #[test]
    fn overlap_is_the_least_shift_that_parts_two_boxes() {
        let a = block([0.0; 3], [1.0, 1.0, 0.1], 0.0);
        assert!((a.overlap(&block([0.5, 0.0, 0.15], [1.0, 1.0, 0.1], 0.3)) - 0.05).abs() < 1e-12);
        // a corner of a cube of edge 1 turned by 45 degrees beside a face
        let beside = block([1.0 + 0.5 * 2f64.sqrt() - 0.02, 0.0, 0.0], [0.5; 3], std::f64::consts::FRAC_PI_4);
        assert!((a.overlap(&beside) - 0.02).abs() < 1e-12);
        assert!(a.overlap(&block([0.0, 0.0, 0.21], [1.0, 1.0, 0.1], 1.0)) < 0.0);
    }

    #[test]
    fn an_overlap_at_the_start_may_shrink_and_not_grow_again() {
        let mut allowed = Allowed::default();
        let mut seen = Vec::new();
        for overlap in [0.03, 0.02, 0.025, 0.0, 0.01] {
            seen.push(allowed.beyond((0, 1), overlap, true));
            allowed.close(Vec::new());
        }
        for (beyond, wanted) in seen.iter().zip([0.0, 0.0, 0.005, 0.0, 0.01]) {
            assert!((beyond - wanted).abs() < 1e-12, "{seen:?}");
        }
    }

    #[test]
    fn bodies_that_were_joined_may_overlap_as_they_did_when_they_came_apart() {
        let mut allowed = Allowed::default();
        allowed.close(Vec::new());
        let mut beyond = |overlap: f64, may: bool| {
            let beyond = allowed.beyond((0, 1), overlap, may);
            allowed.close(Vec::new());
            beyond
        };
        assert_eq!(beyond(0.1, false), 0.0);
        assert_eq!(beyond(0.2, true), 0.0);
        assert!((beyond(0.23, true) - 0.03).abs() < 1e-12);
    }

    #[test]
    fn what_was_one_with_a_body_when_it_was_crushed_touches_nothing() {
        let join = |id: &str, a: usize, b: usize, latent: bool| (id.to_string(), [Some(a), Some(b)], latent);
        let mut ties = Ties {
            list: vec![join("foot", 0, 1, false), join("middle", 1, 2, true)],
            whole: BTreeSet::from(["middle".to_string()]),
            alive: vec![true; 3],
            crushed: BTreeSet::new(),
            ends: vec![(2.0, End::Whole("middle".into())), (1.0, End::Crushed("foot".into()))],
        };
        assert!(!ties.at(0.5) && ties.crushed.is_empty());
        assert!(ties.at(1.5));
        assert_eq!(ties.crushed, BTreeSet::from([1, 2]));
        assert!(ties.at(2.5));
        assert_eq!(ties.crushed, BTreeSet::from([1, 2]));
    }
}
