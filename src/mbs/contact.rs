//! Who may touch, and the contact law.
//!
//! The law of a contact point is that of [`super::contact_law`].
//!
//! **Search**: a pair of boxes with gap `g` cannot meet until their bodies have travelled `g` together; the
//! path lengths are bounded by `∫(|v| + |ω| r) dt`. This bound is rigorous and the pair costs one comparison until then.
//!
//! **Initial overlap**: boxes that overlap when they become able to touch (at `t = 0`, or as
//! their joint breaks) keep that depth as an offset that shrinks as they part: no force from nothing.

use super::contact_law::{ContactEnergy, Law, PointState};
use super::math::{self, V3};
use super::model::{Model, Shape};
use super::narrow::{Manifold, OrientedBox, separation};
use super::system::System;

#[derive(Debug, Clone)]
struct Collider {
    body: usize,
    center: V3,
    half: V3,
    /// Corners in the body frame.
    corners: [V3; 8],
    ground: [PointState; 8],
    ground_fresh: bool,
}

#[derive(Debug, Clone)]
struct Pair {
    a: usize,
    b: usize,
    law: Law,
    /// Sum of the bodies' path lengths up to which nothing can happen \[m\].
    limit: f64,
    blocked: bool,
    fresh: bool,
    touching: bool,
    offset: f64,
    seen: bool,
    manifold: Manifold,
}

/// First contact between two bodies, or of a body with the ground or an obstacle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Touch {
    /// First body.
    pub a: usize,
    /// What it met.
    pub b: Partner,
}

/// What a body met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Partner {
    /// Another body.
    Body(usize),
    /// The ground plane.
    Ground,
    /// An obstacle by index.
    Obstacle(usize),
}

/// All contacts of a run.
#[derive(Debug, Clone)]
pub struct ContactSet {
    colliders: Vec<Collider>,
    obstacles: Vec<OrientedBox>,
    pairs: Vec<Pair>,
    ground: Option<(f64, f64, f64)>,
    ground_blocked: Vec<bool>,
    ground_seen: Vec<bool>,
    radius: Vec<f64>,
    inverse_mass: Vec<f64>,
    travel: Vec<f64>,
    /// Sum of twice the largest path, and its value at which some pair must be looked at.
    clock: f64,
    alarm: f64,
    step_s: f64,
    /// Energies.
    pub energy: ContactEnergy,
    /// First contacts not yet fetched.
    pub touches: Vec<Touch>,
}

impl ContactSet {
    /// Compiles the contacts of a model for steps up to `step_s`.
    pub fn new(model: &Model, system: &System, step_s: f64) -> Self {
        let n = system.count();
        let mut colliders = Vec::new();
        for (body, entry) in model.bodies.iter().enumerate() {
            colliders.extend(entry.shapes.iter().filter_map(|s| match s {
                Shape::Box { center_m, half_extents_m, .. } => {
                    Some(Collider::new(body, *center_m, *half_extents_m))
                }
                _ => None,
            }));
        }
        let mut radius = vec![0.0_f64; n];
        let mut inverse_mass = vec![0.0_f64; n + 1];
        for c in &colliders {
            for corner in c.corners {
                radius[c.body] = radius[c.body].max(math::norm(corner));
                inverse_mass[c.body] = inverse_mass[c.body].max(corner_inverse_mass(system, c.body, corner));
            }
        }
        let obstacles = model.contact.obstacles.iter().map(|o| OrientedBox {
            center: std::array::from_fn(|i| 0.5 * (o.min_m[i] + o.max_m[i])),
            q: [1.0, 0.0, 0.0, 0.0],
            r: math::qmat([1.0, 0.0, 0.0, 0.0]),
            half: std::array::from_fn(|i| 0.5 * (o.max_m[i] - o.min_m[i])),
        });
        let mut set = Self {
            obstacles: obstacles.collect(),
            pairs: Vec::new(),
            ground: model.contact.ground.as_ref().map(|g| (g.level_m, g.friction, g.restitution)),
            ground_blocked: vec![false; n],
            ground_seen: vec![false; n],
            radius,
            inverse_mass,
            travel: vec![0.0; n + 1],
            clock: 0.0,
            alarm: 0.0,
            step_s,
            energy: ContactEnergy::default(),
            touches: Vec::new(),
            colliders,
        };
        set.add_pairs(model, n);
        set.update_blocks(system);
        set
    }

    fn add_pairs(&mut self, model: &Model, ground: usize) {
        let count = self.colliders.len();
        for a in 0..count {
            let body = self.colliders[a].body;
            if let Some(contact) = &model.contact.bodies {
                for b in a + 1..count {
                    if self.colliders[b].body != body {
                        self.push_pair(a, b, self.colliders[b].body, [contact.friction, contact.restitution]);
                    }
                }
            }
            for (k, obstacle) in model.contact.obstacles.iter().enumerate() {
                self.push_pair(a, count + k, ground, [obstacle.friction, obstacle.restitution]);
            }
        }
    }

    fn push_pair(&mut self, a: usize, b: usize, body_b: usize, surface: [f64; 2]) {
        let law = self.law(self.inverse_mass[self.colliders[a].body] + self.inverse_mass[body_b], surface);
        self.pairs.push(Pair {
            a,
            b,
            law,
            limit: 0.0,
            blocked: false,
            fresh: true,
            touching: false,
            offset: 0.0,
            seen: false,
            manifold: Manifold::default(),
        });
    }

    fn law(&self, inverse_mass: f64, [friction, restitution]: [f64; 2]) -> Law {
        Law::new(inverse_mass, friction, restitution, self.step_s)
    }

    fn body_of(&self, collider: usize, ground: usize) -> usize {
        self.colliders.get(collider).map_or(ground, |c| c.body)
    }

    /// Works out again which pairs are kept apart by an intact joint. Call after joints or bodies vanish.
    pub fn update_blocks(&mut self, system: &System) {
        let ground = system.count();
        let mut joined = vec![false; (ground + 1) * (ground + 1)];
        for joint in system.joints.iter().filter(|j| j.alive) {
            joined[joint.a * (ground + 1) + joint.b] = true;
            joined[joint.b * (ground + 1) + joint.a] = true;
        }
        for i in 0..self.pairs.len() {
            let (a, b) = (self.pairs[i].a, self.pairs[i].b);
            let (body_a, body_b) = (self.body_of(a, ground), self.body_of(b, ground));
            let gone = !(system.data[body_a].alive && system.data[body_b].alive);
            let blocked = gone || (body_b != ground && joined[body_a * (ground + 1) + body_b]);
            let pair = &mut self.pairs[i];
            if pair.blocked && !blocked {
                (pair.fresh, pair.limit) = (true, 0.0);
            }
            if blocked && pair.touching {
                self.energy.exchange_j += drop_points(&mut pair.manifold);
                pair.touching = false;
            }
            pair.blocked = blocked;
        }
        for collider in &mut self.colliders {
            let body = collider.body;
            let blocked = !system.data[body].alive || joined[body * (ground + 1) + ground];
            collider.ground_fresh |= self.ground_blocked[body] && !blocked;
            if !system.data[body].alive {
                for state in &mut collider.ground {
                    self.energy.exchange_j += state.elastic;
                    *state = PointState::default();
                }
            }
        }
        for body in 0..ground {
            self.ground_blocked[body] = !system.data[body].alive || joined[body * (ground + 1) + ground];
        }
        self.alarm = self.clock;
    }

    /// Adds the contact forces; `h_s` is the step that led to this position (zero when the forces are
    /// evaluated again in the same position).
    pub fn add_forces(&mut self, system: &mut System, h_s: f64) {
        self.energy.elastic_j = 0.0;
        if let Some((level, friction, restitution)) = self.ground {
            self.ground_forces(system, level, [friction, restitution], h_s);
        }
        if !self.pairs.is_empty() {
            self.pair_forces(system, h_s);
        }
    }

    fn ground_forces(&mut self, system: &mut System, level: f64, surface: [f64; 2], h: f64) {
        for i in 0..self.colliders.len() {
            let body = self.colliders[i].body;
            let state = &system.bodies[body];
            if self.ground_blocked[body] || state.x[2] - self.radius[body] > level {
                continue;
            }
            let (c, half) = (self.colliders[i].center, self.colliders[i].half);
            let reach: f64 = (0..3).map(|j| state.r[2][j].abs() * half[j]).sum();
            let low = state.x[2] + math::dot(state.r[2], c) - reach;
            let law = self.law(self.inverse_mass[body], surface);
            let collider = &mut self.colliders[i];
            let fresh = std::mem::take(&mut collider.ground_fresh);
            if low > level && !fresh && collider.ground.iter().all(|p| !p.active) {
                continue;
            }
            for corner in 0..8 {
                let arm = math::mul(&system.bodies[body].r, collider.corners[corner]);
                let depth = level - (system.bodies[body].x[2] + arm[2]);
                let point = &mut collider.ground[corner];
                point.offset = if fresh { depth.max(0.0) } else { point.offset.min(depth.max(0.0)) };
                let depth = depth - point.offset;
                if depth <= 0.0 && !point.active {
                    continue;
                }
                let b = &mut system.bodies[body];
                let velocity = math::add(b.v, math::cross(b.w, arm));
                let f = law.force(point, depth, [0.0, 0.0, 1.0], velocity, h, self.step_s, &mut self.energy);
                b.force = math::add(b.force, f);
                b.torque = math::add(b.torque, math::cross(arm, f));
                if depth > 0.0 && !self.ground_seen[body] {
                    self.ground_seen[body] = true;
                    self.touches.push(Touch { a: body, b: Partner::Ground });
                }
            }
        }
    }

    fn pair_forces(&mut self, system: &mut System, h: f64) {
        let ground = system.count();
        let mut largest = 0.0_f64;
        for i in 0..ground {
            let body = &system.bodies[i];
            let step = h * (math::norm(body.v) + math::norm(body.w) * self.radius[i]);
            self.travel[i] += step;
            largest = largest.max(step);
        }
        self.clock += 2.0 * largest;
        if self.clock < self.alarm {
            return;
        }
        let mut slack = f64::INFINITY;
        for i in 0..self.pairs.len() {
            if self.pairs[i].blocked {
                continue;
            }
            let (a, b) = (self.pairs[i].a, self.pairs[i].b);
            let (body_a, body_b) = (self.body_of(a, ground), self.body_of(b, ground));
            let travelled = self.travel[body_a] + self.travel[body_b];
            if travelled >= self.pairs[i].limit {
                let boxes = (self.posed(a, system), self.posed(b, system));
                let gap = separation(&boxes.0, &boxes.1);
                self.pairs[i].limit = travelled + gap.max(0.0);
                self.pair_force(i, gap, &boxes, [body_a, body_b], system, h);
            }
            slack = slack.min(self.pairs[i].limit - travelled);
        }
        self.alarm = self.clock + slack;
    }

    fn posed(&self, collider: usize, system: &System) -> OrientedBox {
        match self.colliders.get(collider) {
            Some(c) => {
                let body = &system.bodies[c.body];
                OrientedBox {
                    center: math::add(body.x, math::mul(&body.r, c.center)),
                    q: body.q,
                    r: body.r,
                    half: c.half,
                }
            }
            None => self.obstacles[collider - self.colliders.len()],
        }
    }

    fn pair_force(
        &mut self,
        index: usize,
        gap: f64,
        boxes: &(OrientedBox, OrientedBox),
        bodies: [usize; 2],
        system: &mut System,
        h: f64,
    ) {
        let ground = system.count();
        let pair = &mut self.pairs[index];
        let before: f64 = pair.manifold.points(&boxes.0, &boxes.1).map(|p| p.state.elastic).sum();
        if gap > 0.0 {
            pair.manifold.clear();
        } else {
            pair.manifold.update(&boxes.0, &boxes.1);
        }
        let kept: f64 = pair.manifold.points(&boxes.0, &boxes.1).map(|p| p.state.elastic).sum();
        self.energy.exchange_j += before - kept;
        let deepest = pair.manifold.points(&boxes.0, &boxes.1).map(|p| p.depth).fold(0.0, f64::max);
        pair.offset = if pair.fresh { deepest } else { pair.offset.min(deepest) };
        pair.fresh = false;
        let normal = pair.manifold.normal(&boxes.0);
        let was_touching = std::mem::replace(&mut pair.touching, false);
        for point in pair.manifold.points(&boxes.0, &boxes.1) {
            let depth = point.depth - pair.offset;
            if depth <= 0.0 && !point.state.active {
                continue;
            }
            pair.touching = true;
            let [a, b] = bodies.map(|i| &system.bodies[i]);
            let arms = [math::sub(point.position, a.x), math::sub(point.position, b.x)];
            let velocity = math::sub(
                math::add(b.v, math::cross(b.w, arms[1])),
                math::add(a.v, math::cross(a.w, arms[0])),
            );
            if !point.state.active && was_touching && depth > 0.0 {
                // A new point of an old contact: it appears with the depth it had one step ago.
                let past = (depth + h * math::dot(velocity, normal)).clamp(0.0, depth);
                point.state.depth = past;
                self.energy.exchange_j -= pair.law.elastic(past);
            }
            let f = pair.law.force(point.state, depth, normal, velocity, h, self.step_s, &mut self.energy);
            let b = &mut system.bodies[bodies[1]];
            b.force = math::add(b.force, f);
            b.torque = math::add(b.torque, math::cross(arms[1], f));
            let a = &mut system.bodies[bodies[0]];
            a.force = math::sub(a.force, f);
            a.torque = math::sub(a.torque, math::cross(arms[0], f));
        }
        if pair.touching && !pair.seen {
            let b = if bodies[1] == ground {
                Partner::Obstacle(pair.b - self.colliders.len())
            } else {
                Partner::Body(bodies[1])
            };
            for other in &mut self.pairs {
                let (a2, b2) = (other.a, other.b);
                let same_a = self.colliders[a2].body == bodies[0];
                let same_b = match self.colliders.get(b2) {
                    Some(c) => Partner::Body(c.body) == b,
                    None => Partner::Obstacle(b2 - self.colliders.len()) == b,
                };
                other.seen |= same_a && same_b;
            }
            self.touches.push(Touch { a: bodies[0], b });
        }
    }
}

fn drop_points(manifold: &mut Manifold) -> f64 {
    let unit = OrientedBox {
        center: [0.0; 3],
        q: [1.0, 0.0, 0.0, 0.0],
        r: math::qmat([1.0, 0.0, 0.0, 0.0]),
        half: [1.0; 3],
    };
    let lost = manifold.points(&unit, &unit).map(|p| p.state.elastic).sum();
    manifold.clear();
    lost
}

impl Collider {
    fn new(body: usize, center: V3, half: V3) -> Self {
        let corners = std::array::from_fn(|i| {
            std::array::from_fn(|k| center[k] + if i >> k & 1 == 0 { -half[k] } else { half[k] })
        });
        Self { body, center, half, corners, ground: Default::default(), ground_fresh: true }
    }
}

/// Largest inverse effective mass of a corner over the three body axes as normals \[1/kg\].
fn corner_inverse_mass(system: &System, body: usize, corner: V3) -> f64 {
    let data = &system.data[body];
    let mut largest = 0.0_f64;
    for k in 0..3 {
        let mut normal = [0.0; 3];
        normal[k] = 1.0;
        let arm = math::cross(corner, normal);
        largest = largest.max(math::dot(arm, math::mul(&data.inverse_inertia, arm)));
    }
    data.inverse_mass + largest
}
