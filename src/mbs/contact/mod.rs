//! Contact by impulses: who can meet, where they meet, and the velocities afterwards.
//!
//! | file | owns |
//! |---|---|
//! | this one | the set-up, what can touch when |
//! | `terms` | what goes in and out |
//! | `collider` | solids of bodies and obstacles, and planes, as a model has them |
//! | `collide` | solids, their bounds and contact points (the only file that knows `parry3d`) |
//! | `surface` | friction and restitution of each pair, who passes through whom |
//! | `pair` | pairs of solids, their points, who has met whom |
//! | `near` | which solids are near each other |
//! | `look` | where the points of a pair are in a step, and which of them take part |
//! | `passing` | solids that pass an edge of each other within a step |
//! | `faces` | the points in which two faces lie on each other |
//! | `gaps` | gaps along directions that may part solids |
//! | `groups` | who is connected with whom in a step |
//! | `rows` | the impulses of a step |
//! | `search` | conjugate directions where sweeps settle slowly |
//! | `links` | impulses on bodies that ideal joints hold together |
//! | `impact` | impacts with rebound of bodies that no joint holds: rounds of Moreau's law |
//! | `strike` | impacts of bodies that ideal joints hold together, and jams |
//! | `coulomb` | the impulse of a single point of a mechanism, by Coulomb's law at once |
//! | `crush` | faces that get shorter under more than they bear |
//! | `overlap` | which solids are inside others at the start |
//! | `rest` | velocities at the full step |
//! | `roll` | moments against rolling |
//! | `solve` | a step: which pairs, impulses, gaps, energies |
//! | `spread` | which points count, of more than a pair can have |
//!
//! **Law.** At each contact point `gap + h v_n >= 0` at the end of a step of length `h`, the impulse `p_n >= 0` acts only if this is an
//! equality (Signorini), `|p_t| <= μ p_n` with the greatest dissipation (Coulomb), and rebound by Newton's coefficient of
//! restitution from a small approach speed on. Points are seen before they touch, so that nothing passes through
//! anything: a pair takes part as soon as the paths of its two bodies in this step may close its gap.
//!
//! **Search.** A pair with gap `g` cannot meet until its bodies have travelled `g` together; path lengths are bounded by
//! `∫ (|v| + |ω| r) dt`, and so are the times at which a body may leave the bounds it was entered with. Until the first of all these
//! can happen a step costs one comparison ([`ContactSet::quiet`]).
//!
//! **Initial overlap**: solids that overlap when they become able to touch (at `t = 0`, or as their joint breaks) keep that depth as
//! an offset that shrinks as they part: no force from nothing.
//!
//! **Gaps** below zero, left over by rounding, rotation within a step and unfinished sweeps, are opened by displacements without velocity. Their
//! work against the acting forces is the caller's to book.

mod collide;
mod collider;
mod coulomb;
mod crush;
mod faces;
mod gaps;
mod groups;
mod impact;
mod links;
mod look;
mod near;
mod overlap;
mod pair;
mod passing;
mod rest;
mod roll;
mod rows;
mod search;
mod solve;
mod spread;
mod strike;
mod surface;
mod terms;

pub use crush::Crushed;
pub use links::Linked;
pub use overlap::Overlap;
pub use surface::{AT_GROUND_M, Surface};
pub use terms::{ContactEnergy, Hit, Moving, Partner, Settings, TooDeep, Touch, Work};

use super::math::{self, V3};
use super::model::Model;
use collide::{Broad, Finder, Found, Placed};
use collider::{Collider, Plane};
use crush::Faces;
use impact::Impacts;
use pair::{Entry, Pair, Point};
use rows::{Motion, Rows};
use std::collections::BTreeSet;
use surface::Surfaces;

/// Points that are this near take part without approaching \[m\].
const MARGIN_M: f64 = 2e-4;
/// A path that no body travels \[m\].
const NEVER_M: f64 = 1e300;

/// All contacts of a run.
#[derive(Debug, Clone)]
pub struct ContactSet {
    /// How contacts are searched.
    pub settings: Settings,
    /// Energies taken.
    pub energy: ContactEnergy,
    /// First contacts not yet fetched.
    pub touches: Vec<Touch>,
    /// What was done.
    pub work: Work,
    /// Bodies asleep that another one may touch in the step; not empty: nothing was solved.
    pub touched: Vec<usize>,
    /// Who does not move: bodies asleep, and the ground.
    still: Vec<bool>,
    colliders: Vec<Collider>,
    planes: Vec<Plane>,
    surfaces: Surfaces,
    faces: Faces,
    /// Whether any pair resists rolling.
    is_rolling: bool,
    /// Index of what never moves: the number of bodies.
    ground: usize,
    radius: Vec<f64>,
    /// Paths travelled, and of this step at most, the ground last \[m\].
    travel: Vec<f64>,
    path: Vec<f64>,
    /// Sum of both and the margin.
    until: Vec<f64>,
    /// Share of it by rotation, and what impulses may add to it \[m\].
    spin: Vec<f64>,
    growth: Vec<f64>,
    /// Travel up to which a body's solids are within their entered bounds, and how far that was ahead when they were entered.
    budget: Vec<f64>,
    ahead: Vec<f64>,
    entered: Vec<[V3; 2]>,
    broad: Broad,
    finder: Finder,
    /// Pairs, in no order; and what is asked of each, those with planes first, then those of solids by their indices.
    pairs: Vec<Pair>,
    order: Vec<Entry>,
    plane_pairs: usize,
    free: Vec<u32>,
    seen: BTreeSet<(usize, Partner)>,
    connected: Vec<(usize, usize)>,
    /// Bodies that touch no others.
    crushed: BTreeSet<usize>,
    /// Whether pairs that come to overlap now did so before they could be seen.
    first_look: bool,
    /// Sum of twice the largest path, and its value at which something must be looked at.
    clock: f64,
    alarm: f64,
    /// Solids in space, and the step in which they were placed.
    placed: Vec<Placed>,
    placed_in: Vec<u64>,
    step: u64,
    rows: Rows,
    impacts: Impacts,
    mean: Vec<Motion>,
    found: Vec<Found>,
    feet: Vec<(V3, u64)>,
    kept: Vec<Point>,
    met: Vec<(u32, u32)>,
    room: Vec<f64>,
    due: Vec<bool>,
    moved: Vec<bool>,
}

impl ContactSet {
    /// Compiles the contacts of a model; bodies have the order of the model.
    pub fn new(model: &Model, settings: Settings) -> Self {
        let ground = model.bodies.len();
        let (colliders, planes) = (collider::of_model(model), collider::planes(model));
        let mut radius = vec![0.0_f64; ground];
        for collider in &colliders {
            if let Some(radius) = radius.get_mut(collider.body) {
                *radius = radius.max(collider.radius());
            }
        }
        let count = colliders.len();
        let mut set = Self {
            settings,
            energy: ContactEnergy::default(),
            touches: Vec::new(),
            work: Work::default(),
            touched: Vec::new(),
            still: (0..=ground).map(|i| i == ground).collect(),
            surfaces: Surfaces::new(model),
            faces: Faces::new(model, count),
            is_rolling: model.contact.resists_rolling(),
            ground,
            radius,
            travel: vec![0.0; ground + 1],
            path: vec![0.0; ground + 1],
            until: Vec::new(),
            spin: vec![0.0; ground + 1],
            growth: vec![0.0; ground + 1],
            budget: vec![f64::NEG_INFINITY; ground],
            ahead: vec![0.0; ground],
            entered: vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; count],
            broad: Broad::new(count),
            finder: Finder::default(),
            pairs: Vec::new(),
            order: Vec::new(),
            plane_pairs: 0,
            free: Vec::new(),
            seen: Default::default(),
            connected: Vec::new(),
            crushed: BTreeSet::new(),
            first_look: true,
            clock: 0.0,
            alarm: 0.0,
            placed: vec![Placed::HERE; count],
            placed_in: vec![0; count],
            step: 0,
            rows: Rows::default(),
            impacts: Impacts::default(),
            mean: Vec::new(),
            found: Vec::new(),
            feet: Vec::new(),
            kept: Vec::new(),
            met: Vec::new(),
            room: Vec::new(),
            due: Vec::new(),
            moved: Vec::new(),
            colliders,
            planes,
        };
        set.enter_planes();
        set
    }

    fn enter_planes(&mut self) {
        for a in 0..self.colliders.len() {
            let body = self.colliders[a].body;
            for b in 0..self.planes.len() {
                if body != self.ground
                    && let Some(surface) = self.surfaces.between(body, self.planes[b].partner)
                {
                    self.enter_pair(Pair::new([a, b], true, surface, true));
                }
            }
        }
        self.plane_pairs = self.order.len();
        let moving = self.colliders.iter().any(|c| c.body != self.ground);
        let meeting = self.surfaces.bodies_meet() || self.colliders.iter().any(|c| c.body == self.ground);
        if !moving || self.pairs.is_empty() && !meeting {
            self.alarm = f64::INFINITY;
        }
    }

    /// Says which bodies a joint connects (the ground is the number of bodies), which are there, and which are crushed. Connected bodies do not touch, and crushed ones no other bodies.
    pub fn connect(
        &mut self,
        connected: impl Iterator<Item = (usize, usize)>,
        alive: impl Fn(usize) -> bool,
        crushed: BTreeSet<usize>,
    ) {
        self.crushed = crushed;
        self.connected.clear();
        self.connected.extend(connected.map(|(a, b)| (a.min(b), a.max(b))));
        self.connected.sort_unstable();
        for body in (0..self.ground).filter(|i| !alive(*i)) {
            self.budget[body] = f64::INFINITY;
        }
        for i in 0..self.order.len() {
            let slot = self.order[i].slot as usize;
            let blocked = self.is_blocked(&self.pairs[slot], &alive);
            let pair = &mut self.pairs[slot];
            if pair.blocked && !blocked {
                pair.fresh = true;
                self.order[i].limit = f64::NEG_INFINITY;
            }
            if blocked {
                pair.forget();
                self.order[i].limit = f64::INFINITY;
            }
            pair.blocked = blocked;
        }
        if self.alarm < f64::INFINITY {
            self.alarm = self.clock;
        }
    }

    fn is_blocked(&self, pair: &Pair, alive: impl Fn(usize) -> bool) -> bool {
        let [a, b] = self.bodies_of(pair);
        let is_one_crushed = self.crushed.contains(&a) || self.crushed.contains(&b);
        if !alive(a) || b != self.ground && (!alive(b) || is_one_crushed) {
            return true;
        }
        let joined = self.connected.binary_search(&(a.min(b), a.max(b))).is_ok();
        let tied =
            || self.partner_of(pair) == Partner::Ground && self.colliders[pair.a as usize].footing.tied;
        joined && (b != self.ground || tied())
    }

    fn bodies_of(&self, pair: &Pair) -> [usize; 2] {
        let b = if pair.plane { self.ground } else { self.colliders[pair.b as usize].body };
        [self.colliders[pair.a as usize].body, b]
    }

    fn partner_of(&self, pair: &Pair) -> Partner {
        if pair.plane {
            self.planes[pair.b as usize].partner
        } else {
            self.colliders[pair.b as usize].partner
        }
    }

    /// Whether there were points in the last step that was solved.
    pub fn has_points(&self) -> bool {
        !self.rows.blocks.is_empty()
    }

    /// The same, if bodies and joints are still those of that step.
    pub fn is_meeting(&self) -> bool {
        self.has_points() && self.alarm == f64::NEG_INFINITY
    }

    /// Whether there is anything that can touch at all.
    pub fn is_idle(&self) -> bool {
        self.alarm == f64::INFINITY
    }

    /// Whether nothing can touch in a step in which the paths of all bodies, angular velocity times radius included, are no longer than these \[m\].
    pub fn is_clear_for(&mut self, paths_m: &[f64]) -> bool {
        if self.alarm.is_infinite() {
            return self.alarm > 0.0;
        }
        let late = |(i, path): (usize, &f64)| self.travel[i] + path + MARGIN_M > self.budget[i];
        if paths_m.iter().enumerate().any(late) {
            return false;
        }
        let longest = paths_m.iter().copied().fold(0.0, f64::max);
        if self.clock + 2.0 * longest >= self.alarm {
            self.count_slack();
        }
        // the alarm is that of two bodies with the longest path
        let until = |i: u32| self.travel[i as usize] + paths_m.get(i as usize).copied().unwrap_or(0.0);
        let apart = |e: &Entry| {
            let [a, b] = e.bodies;
            self.is_still([a as usize, b as usize]) || until(a) + until(b) + MARGIN_M < e.limit
        };
        self.clock + 2.0 * longest < self.alarm || self.order.iter().all(apart)
    }

    /// Puts a body to sleep, or wakes it. Pairs of bodies asleep are not looked at.
    pub fn set_asleep(&mut self, body: usize, asleep: bool) {
        self.still[body] = asleep;
        if self.alarm < f64::INFINITY {
            self.alarm = self.clock;
        }
    }

    /// Whether neither body of a pair moves.
    fn is_still(&self, [a, b]: [usize; 2]) -> bool {
        self.still[a] && self.still[b]
    }

    /// Pairs of bodies that were near each other in the last step; the ground is the number of bodies.
    pub fn meeting(&self) -> impl Iterator<Item = [usize; 2]> {
        let known = if self.is_meeting() { &self.rows.blocks[..] } else { &[] };
        known.iter().map(|block| block.bodies.map(|i| i as usize))
    }

    /// The impulses \[N s\] of the last step with contacts, each with its solid (in the order of bodies and their shapes) and the arm from the centre of mass of its body \[m\].
    pub fn each_impulse(&self, mut visit: impl FnMut(usize, V3, V3)) {
        for block in &self.rows.blocks {
            let pair = &self.pairs[block.slot as usize];
            for row in &self.rows.rows[block.range()] {
                let p = math::axpy(row.tangent, row.normal, block.normal);
                visit(pair.a as usize, row.arms[0], math::scale(-1.0, p));
                if !pair.plane {
                    visit(pair.b as usize, row.arms[1], p);
                }
            }
        }
    }

    /// The same for each moving body.
    pub fn each_impulse_on(&self, mut visit: impl FnMut(usize, V3, V3)) {
        self.each_impulse(|solid, arm, p| {
            let body = self.colliders[solid].body;
            if body != self.ground {
                visit(body, arm, p);
            }
        });
    }

    /// Calls `visit` for each point of the last step that has an impulse.
    pub fn each_hit(&self, mut visit: impl FnMut(Hit)) {
        for block in &self.rows.blocks {
            let partner = self.partner_of(&self.pairs[block.slot as usize]);
            let bodies = block.bodies.map(|i| i as usize);
            for row in &self.rows.rows[block.range()] {
                if row.normal > 0.0 {
                    visit(Hit { bodies, partner, arms: row.arms, normal: block.normal });
                }
            }
        }
    }

    /// Sets the alarm to the time at which the first pair must be looked at, unless there were points in the last step.
    fn count_slack(&mut self) {
        if self.alarm > f64::NEG_INFINITY {
            let left = |e: &Entry| {
                let [a, b] = e.bodies.map(|i| i as usize);
                e.limit - (self.travel[a] + self.travel[b])
            };
            let moving = self.order.iter().filter(|e| !self.is_still(e.bodies.map(|i| i as usize)));
            let least = moving.map(left).fold(NEVER_M, f64::min);
            self.alarm = self.clock + (least - MARGIN_M);
        }
    }

    /// Distance of a body's farthest point from its centre of mass \[m\].
    pub fn radius_m(&self, body: usize) -> f64 {
        self.radius[body]
    }

    /// Whether work may be skipped.
    pub fn may_skip(&self) -> bool {
        self.settings.skip
    }

    /// [`ContactSet::is_clear_for`] the paths of a step that was made; if so, they are counted.
    pub fn passes(&mut self, paths_m: &[f64]) -> bool {
        let clear = self.is_clear_for(paths_m);
        if clear && self.alarm < f64::INFINITY {
            self.path[..paths_m.len()].copy_from_slice(paths_m);
            self.pass(paths_m.iter().copied().fold(0.0, f64::max));
        }
        clear
    }

    /// Whether nothing can touch in a step of `h` \[s\] with these velocities and angular velocities of all bodies, and this may be made use of; if so, the paths are counted.
    #[inline]
    pub fn quiet(&mut self, h: f64, velocities: impl Iterator<Item = (V3, V3)>) -> bool {
        if self.alarm.is_infinite() || !self.settings.skip {
            return self.alarm == f64::INFINITY;
        }
        let mut largest = 0.0_f64;
        let mut late = false;
        for (i, (v, w)) in velocities.enumerate() {
            let path = self.path_of(i, v, w, h);
            self.path[i] = path;
            largest = largest.max(path);
            late |= self.travel[i] + path + MARGIN_M > self.budget[i];
        }
        if !late && self.clock + 2.0 * largest >= self.alarm {
            self.count_slack();
        }
        let quiet = !late && self.clock + 2.0 * largest < self.alarm;
        if quiet {
            self.pass(largest);
        }
        quiet
    }

    /// Counts the paths of a step in which nothing can touch, the longest of which is given \[m\].
    #[inline]
    fn pass(&mut self, longest_m: f64) {
        self.rows.clear();
        if self.settings.skip {
            self.work.quiet_steps += 1;
            self.work.left_alone += self.order.iter().filter(|e| e.limit < f64::INFINITY).count() as u64;
        }
        self.clock += 2.0 * longest_m;
        for (travel, path) in self.travel.iter_mut().zip(&self.path) {
            *travel += path;
        }
    }
}
