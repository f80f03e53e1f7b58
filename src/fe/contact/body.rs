//! Contact of the body with itself: its nodes against its outer faces.
//!
//! **Which pairs.** All nodes that have mass or are tied against all outer faces, debris included; not against a face that hangs together with the node
//! by an acting element ([`Faces::mark_joined`]), nor one whose outside the node's own surface does not look at. A node that is behind by more
//! than half an element is not in contact; one that was, and gets there, has been lost: [`LostContact`].
//!
//! **When is searched.** A search lists the pairs closer than the reach `R`. Another pair can only meet after its two sides have moved
//! `R` together, and that takes longer than `∫ 2 max|v - v_ref| dt = R`, with a common velocity that drops out. Until then
//! there is no search. Each listed pair has such a bound of its own, from its distance, and the least of them says when any pair
//! is looked at again. When an element ends, only the faces at its nodes are
//! searched anew.

use super::broad::Cells;
use super::faces::{Faces, looks_away};
use super::narrow::{Over, clearance_m, over};
use super::rigid::RigidSurfaces;
pub use super::rigid::Struck;
use super::solve::{Condition, Rows};
pub use super::solve::{Moving, Work};
use crate::base::vector::{V3, dot, sub};
use crate::fe::dynamics::Death;
use crate::fe::mesh::Mesh;
use crate::fe::model::ContactSettings;
use crate::fe::tie::Ties;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Reach of a search over the median thickness of the elements.
const REACH: f64 = 0.5;
/// Share of the depth behind a face that is taken back in a step, and the largest speed of it \[m/s\]: overlaps at the start and errors
/// of the rotation within a step go away without being thrown out.
const PUSH_SHARE: f64 = 0.02;
/// That speed in buildings \[m/s\].
pub const PUSH_M_S: f64 = 0.05;
/// Share of the depth that counts as lost up to which a contact can begin.
const BEGUN_SHARE: f64 = 0.5;
/// Faces handed to a thread at a time in a search.
const CHUNK: usize = 256;
const NOWHERE: u32 = u32::MAX;

/// A pair worth looking at in every step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
struct Pair {
    node: u32,
    face: u32,
    /// Whether an impulse has acted between the two.
    held: bool,
}

/// A pair close enough to meet in this step.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Meeting {
    pair: usize,
    over: Over,
}

/// A contact that did not hold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LostContact {
    /// The node.
    pub node: usize,
    /// Element whose face it went through.
    pub element: usize,
    /// Depth behind the face \[m\].
    pub depth_m: f64,
    /// Position of the node \[m\].
    pub at_m: [f64; 3],
}

/// What the contact of the body with itself amounted to.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactSummary {
    /// Searches over all faces.
    pub searches: u64,
    /// Searches over the faces around elements that ended.
    pub local_searches: u64,
    /// Distance up to which a search lists pairs \[m\].
    pub reach_m: f64,
    /// Most pairs of a node and a face that were listed at a time.
    pub most_pairs: usize,
    /// Most contacts that pressed in one step.
    pub most_contacts: usize,
    /// Largest depth of a node behind a face that pressed on it \[m\].
    pub deepest_m: f64,
    /// Work of normal impulses \[J\].
    pub normal_j: f64,
    /// Work of friction impulses \[J\].
    pub friction_j: f64,
}

/// The state of the body around a step, as contact sees it.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// Positions \[m\].
    pub x: &'a [V3],
    /// Velocities \[m/s\].
    pub v: &'a [V3],
    /// Masses \[kg\].
    pub mass_kg: &'a [f64],
    /// Nodes that follow others.
    pub ties: &'a Ties,
    /// Step by which the nodes have just been moved \[s\].
    pub dt_s: f64,
    /// Whether to use threads.
    pub parallel: bool,
}

impl Surroundings<'_> {
    /// Whether a node moves something: it has mass, or is tied to what has.
    fn counts(&self, node: usize) -> bool {
        self.mass_kg[node] > 0.0 || self.ties.is_tied(node)
    }
}

/// Contact of the body with itself.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct BodyContact {
    /// Searches in every step, to check that none is missed.
    pub search_every_step: bool,
    /// The first contact that was lost.
    pub lost: Option<LostContact>,
    /// Nodes whose velocity in this step is found here.
    pub flagged: Vec<bool>,
    /// Velocity that most of the body has \[m/s\].
    pub reference_m_s: V3,
    /// Largest speed of a node against it in the last step \[m/s\].
    pub top_speed_m_s: f64,
    /// Largest speed at which a depth behind a face is taken back \[m/s\].
    pub push_m_s: f64,
    friction: f64,
    faces: Faces,
    cells: Cells,
    pairs: Vec<Pair>,
    /// For each pair the path length below which it cannot meet \[m\], and the least of them.
    due_m: Vec<f64>,
    first_due_m: f64,
    meetings: Vec<Meeting>,
    flags: Vec<u32>,
    /// Place of each flagged node among those that take part.
    place: Vec<u32>,
    /// Upper bound of the relative path length of any two nodes since the last search \[m\]; infinite before the first one.
    way_m: f64,
    /// Common displacement since the last search \[m\].
    drift_m: V3,
    changed: Vec<u32>,
    /// Working memory: nodes joined to a face.
    #[serde(skip)]
    marks: Vec<u32>,
    /// Number of ties that acted in the last step.
    ties: usize,
    summary: ContactSummary,
}

impl BodyContact {
    /// Contact between all outer faces and nodes of a mesh.
    pub fn new(mesh: &Mesh, settings: ContactSettings) -> Self {
        let faces = Faces::of(mesh);
        let summary = ContactSummary { reach_m: REACH * faces.median_thickness_m(), ..Default::default() };
        Self {
            search_every_step: false,
            lost: None,
            flagged: vec![false; mesh.nodes.len()],
            reference_m_s: [0.0; 3],
            top_speed_m_s: 0.0,
            push_m_s: PUSH_M_S,
            friction: settings.friction,
            faces,
            cells: Cells::default(),
            pairs: Vec::new(),
            due_m: Vec::new(),
            first_due_m: f64::INFINITY,
            meetings: Vec::new(),
            flags: Vec::new(),
            place: vec![NOWHERE; mesh.nodes.len()],
            way_m: f64::INFINITY,
            drift_m: [0.0; 3],
            changed: Vec::new(),
            marks: Vec::new(),
            ties: 0,
            summary,
        }
    }

    /// Numbers of the run so far.
    pub fn summary(&self) -> &ContactSummary {
        &self.summary
    }

    /// Takes an element out: its faces go, those behind it open.
    pub fn end_element(&mut self, element: usize) {
        self.faces.end(element, &mut self.changed);
    }

    /// Takes in that elements have other nodes: some were detached and stand beside their neighbours now.
    pub(in crate::fe) fn follow_splits(&mut self, elements: &[[u32; 8]], nodes: usize) {
        self.faces.reconnect(elements, nodes);
        self.flagged.resize(nodes, false);
        self.place.resize(nodes, NOWHERE);
        self.way_m = f64::INFINITY;
    }

    /// Finds the nodes that can meet a face in the coming step; called after the nodes have moved and elements have died.
    pub fn prepare(&mut self, now: Surroundings, deaths: &[(usize, Death)]) {
        for (element, _) in deaths.iter().filter(|(_, cause)| *cause != Death::Split) {
            self.end_element(*element);
        }
        self.flags.drain(..).for_each(|n| {
            self.flagged[n as usize] = false;
            self.place[n as usize] = NOWHERE;
        });
        self.meetings.clear();
        if now.ties.acting() != self.ties {
            self.ties = now.ties.acting();
            self.faces.link(now.ties);
            self.way_m = f64::INFINITY;
        }
        self.way_m += 2.0 * self.top_speed_m_s * now.dt_s;
        for i in 0..3 {
            self.drift_m[i] += self.reference_m_s[i] * now.dt_s;
        }
        if self.way_m + self.step_reach_m(now.dt_s) >= self.summary.reach_m || self.search_every_step {
            self.search(now);
        } else if !self.changed.is_empty() {
            self.search_changed(now);
        }
        let reach_m = self.step_reach_m(now.dt_s);
        if self.way_m + reach_m >= self.first_due_m {
            self.meet(now, reach_m);
        }
    }

    /// Gap below which a pair may meet in a step \[m\]: twice the way at the speed of the last step, for what accelerates.
    fn step_reach_m(&self, dt_s: f64) -> f64 {
        4.0 * self.top_speed_m_s * dt_s + 1e-4 * self.summary.reach_m
    }

    /// Lists all pairs within reach.
    fn search(&mut self, now: Surroundings) {
        let heavy = |n: &usize| now.counts(*n);
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for n in (0..now.x.len()).filter(heavy) {
            for i in 0..3 {
                low[i] = low[i].min(now.v[n][i]);
                high[i] = high[i].max(now.v[n][i]);
            }
        }
        if low[0] <= high[0] {
            self.reference_m_s = std::array::from_fn(|i| 0.5 * (low[i] + high[i]));
        }
        let squares = (0..now.x.len()).filter(heavy).map(|n| self.speed_squared(&now.v[n]));
        self.top_speed_m_s = squares.fold(0.0, f64::max).sqrt();
        let size_m = 2.0 * self.summary.reach_m.max(1e-9);
        self.cells.rebuild(now.x, |n| now.counts(n), size_m);
        (self.way_m, self.drift_m) = (0.0, [0.0; 3]);
        self.changed.clear();
        let outer: Vec<u32> = self.faces.outer().collect();
        let marks = || vec![NOWHERE; now.x.len()];
        let look = |marks: &mut Vec<u32>, faces: &[u32]| {
            let mut found = Vec::new();
            faces.iter().for_each(|f| self.look_around(*f, now, marks, &mut found));
            found
        };
        let found: Vec<Pair> = if now.parallel {
            outer.par_chunks(CHUNK).map_init(marks, look).flatten_iter().collect()
        } else {
            look(&mut marks(), &outer)
        };
        self.take(found, |_| false);
        self.summary.searches += 1;
    }

    /// Lists the pairs of faces that have changed anew.
    fn search_changed(&mut self, now: Surroundings) {
        let mut changed = std::mem::take(&mut self.changed);
        changed.sort_unstable();
        changed.dedup();
        let mut found = Vec::new();
        self.marks.resize(now.x.len(), NOWHERE);
        let mut marks = std::mem::take(&mut self.marks);
        marks.fill(NOWHERE);
        for face in changed.iter().filter(|f| self.faces.is_outer(**f)) {
            self.look_around(*face, now, &mut marks, &mut found);
        }
        self.marks = marks;
        self.take(found, |face| changed.binary_search(&face).is_err());
        changed.clear();
        self.changed = changed;
        self.summary.local_searches += 1;
    }

    /// Puts newly found pairs beside the old ones with a face that `stays`; the old ones' memory is kept.
    fn take(&mut self, mut found: Vec<Pair>, stays: impl Fn(u32) -> bool) {
        let faces = &self.faces;
        let old = std::mem::take(&mut self.pairs);
        found.extend(old.iter().filter(|p| faces.is_outer(p.face) && stays(p.face)));
        found.sort_unstable();
        for pair in &mut found {
            if let Ok(at) = old.binary_search_by_key(&(pair.node, pair.face), |p| (p.node, p.face)) {
                pair.held = old[at].held;
            }
        }
        self.summary.most_pairs = self.summary.most_pairs.max(found.len());
        self.due_m = vec![0.0; found.len()];
        self.first_due_m = if found.is_empty() { f64::INFINITY } else { 0.0 };
        self.pairs = found;
    }

    /// Pairs of one face with nodes within reach.
    fn look_around(&self, face: u32, now: Surroundings, marks: &mut [u32], found: &mut Vec<Pair>) {
        let corners = self.faces.corners(face);
        let reach = self.summary.reach_m;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for c in corners {
            for i in 0..3 {
                low[i] = low[i].min(now.x[c as usize][i] - reach);
                high[i] = high[i].max(now.x[c as usize][i] + reach);
            }
        }
        let points = corners.map(|c| now.x[c as usize]);
        let area = super::narrow::area_normal(&points);
        let size = dot(area, area).sqrt();
        let depth = self.faces.depth_m(face);
        self.faces.mark_joined(face, marks);
        // the cells hold the nodes where they were at the last search
        let back = |p: &V3, way: f64| std::array::from_fn(|i| p[i] - self.drift_m[i] + way);
        self.cells.each(&back(&low, -self.way_m), &back(&high, self.way_m), |node| {
            let x = &now.x[node as usize];
            if marks[node as usize] == face || (0..3).any(|i| x[i] < low[i] || x[i] > high[i]) {
                return;
            }
            let to = |i: usize| dot(area, sub(*x, points[i])) / size;
            let heights: [f64; 4] = std::array::from_fn(to);
            let (least, most) =
                heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(*h), b.max(*h)));
            if least > reach || most < -depth {
                return;
            }
            found.push(Pair { node, face, held: false });
        });
    }

    /// The common velocity against which speeds count \[m/s\].
    pub fn reference_m_s(&self) -> V3 {
        self.reference_m_s
    }

    /// Nodes that may meet another part of the body in this step.
    pub fn flagged_nodes(&self) -> &[u32] {
        &self.flags
    }

    /// Square of the speed against the common velocity \[m²/s²\].
    #[inline]
    pub fn speed_squared(&self, v: &V3) -> f64 {
        (0..3).map(|i| (v[i] - self.reference_m_s[i]).powi(2)).sum()
    }

    /// The pairs that can meet in this step; of the faces that a node is behind, only the nearest counts.
    fn meet(&mut self, now: Surroundings, reach_m: f64) {
        let mut first = 0;
        while first < self.pairs.len() {
            let node = self.pairs[first].node;
            let count = self.pairs[first..].iter().take_while(|p| p.node == node).count();
            if now.counts(node as usize) {
                self.meet_node(first..first + count, now, reach_m);
            }
            first += count;
        }
        self.first_due_m = self.due_m.iter().copied().fold(f64::INFINITY, f64::min);
        for meeting in &self.meetings {
            let pair = self.pairs[meeting.pair];
            for n in [pair.node].into_iter().chain(self.faces.corners(pair.face)) {
                for (n, _) in now.ties.carriers(n as usize) {
                    if !self.flagged[n] {
                        self.flagged[n] = true;
                        self.flags.push(n as u32);
                    }
                }
            }
        }
    }

    fn meet_node(&mut self, pairs: std::ops::Range<usize>, now: Surroundings, reach_m: f64) {
        let node = self.pairs[pairs.start].node;
        let x = now.x[node as usize];
        let mut own = None;
        let mut behind: Option<usize> = None;
        let mut sunk = Vec::new();
        for pair in pairs {
            if self.due_m[pair] > self.way_m + reach_m {
                continue;
            }
            let Pair { face, held, .. } = self.pairs[pair];
            let corners = self.faces.corners(face);
            let points = corners.map(|c| now.x[c as usize]);
            let depth = self.faces.depth_m(face);
            let looked = if held { 2.0 * depth } else { depth };
            let Some(over) = over(&points, x, looked, reach_m) else {
                self.due_m[pair] = self.way_m + clearance_m(&points, x);
                self.pairs[pair].held = false;
                continue;
            };
            if corners.iter().any(|c| !now.counts(*c as usize)) {
                continue;
            }
            let own = *own.get_or_insert_with(|| self.faces.normal_at(node, now.x));
            if own.is_some_and(|own| looks_away(&own, &over.normal))
                && !self.faces.looks_by_a_narrow_side(node, now.x, &over.normal)
            {
                self.pairs[pair].held = false; // what sinks in while it does not look there has not been lost
                continue;
            }
            if over.gap_m < -depth {
                sunk.push((pair, over));
                continue;
            }
            if over.gap_m >= 0.0 {
                self.meetings.push(Meeting { pair, over });
                continue;
            }
            match behind {
                Some(at) if self.meetings[at].over.gap_m >= over.gap_m => {}
                Some(at) => self.meetings[at] = Meeting { pair, over },
                None => {
                    behind = Some(self.meetings.len());
                    self.meetings.push(Meeting { pair, over });
                }
            }
        }
        for (pair, over) in sunk {
            if behind.is_some() {
                self.pairs[pair].held = false; // beside an edge: the nearer face holds it
            } else {
                self.lose(pair, over, x);
            }
        }
    }

    /// A node has gone through a face. Debris may be squeezed out; anything else is an error.
    fn lose(&mut self, pair: usize, over: Over, x: V3) {
        let Pair { node, face, .. } = self.pairs[pair];
        self.pairs[pair].held = false;
        if self.faces.elements_at(node).next().is_some() && self.lost.is_none() {
            self.lost = Some(LostContact {
                node: node as usize,
                element: face as usize / 6,
                depth_m: -over.gap_m,
                at_m: x,
            });
        }
    }

    /// Final velocities of the flagged nodes, which come with their trial velocities in the order of their numbers. `rows` has the contacts of
    /// tied nodes with rigid surfaces, and gets those of the body.
    pub fn resolve(
        &mut self,
        dt_s: f64,
        nodes: &mut [Moving],
        ties: &Ties,
        rows: &mut Rows,
        rigid: &mut RigidSurfaces,
    ) -> Work {
        for (place, node) in nodes.iter().enumerate() {
            self.place[node.at.node] = place as u32;
        }
        let first = rows.rows.len();
        let mut pairs = Vec::with_capacity(self.meetings.len());
        let mut parts = Vec::new();
        for meeting in &self.meetings {
            let pair = self.pairs[meeting.pair];
            let [a, b, c, d] = self.faces.corners(pair.face);
            let [wa, wb, wc, wd] = meeting.over.weights;
            parts.clear();
            for (n, w) in [(pair.node, 1.0), (a, -wa), (b, -wb), (c, -wc), (d, -wd)] {
                if ties.is_tied(n as usize) {
                    parts.extend(ties.carriers(n as usize).iter().map(|(m, s)| (self.place[*m], s * w)));
                } else {
                    parts.push((self.place[n as usize], w));
                }
            }
            if parts.iter().any(|(place, _)| *place == NOWHERE) {
                continue; // a node without mass
            }
            let gap = meeting.over.gap_m;
            let target = if gap > 0.0 { -gap / dt_s } else { (-gap * PUSH_SHARE / dt_s).min(self.push_m_s) };
            let condition = Condition {
                normal: meeting.over.normal,
                target_m_s: target,
                friction: self.friction,
                rigid: None,
            };
            if rows.push(parts.iter().copied(), condition, nodes) {
                pairs.push((meeting.pair, gap));
            } else if gap < 0.0 {
                self.pairs[meeting.pair].held = true; // both sides are driven: if they go on, the contact is lost
            }
        }
        let work = rows.solve(nodes, rigid);
        let mut pressing = 0;
        for (_, (pair, gap)) in rows.rows[first..].iter().zip(pairs).filter(|(row, _)| row.normal_ns > 0.0) {
            pressing += 1;
            // an overlap that was there when the two met, as elements that have collapsed leave it, is pushed out, not lost
            self.pairs[pair].held |= -gap < BEGUN_SHARE * self.faces.depth_m(self.pairs[pair].face);
            self.summary.deepest_m = self.summary.deepest_m.max(-gap);
        }
        self.summary.most_contacts = self.summary.most_contacts.max(pressing);
        self.summary.normal_j += work.body_j[0];
        self.summary.friction_j += work.body_j[1];
        for node in nodes.iter() {
            self.top_speed_m_s = self.top_speed_m_s.max(self.speed_squared(&node.new).sqrt());
        }
        work
    }
}
