//! Pairs of solids and their points over time.

use super::collide::{self, Placed};
use super::gaps;
use super::rows::{Block, Inverse, Row};
use super::spread;
use super::{ContactSet, MARGIN_M, Moving, NEVER_M, Partner, Surface};
use crate::mbs::math::{self, V3};

/// Relative motion of a pair until its points are searched again, as a share of the thickness of its solids.
const STALE: f64 = 1e-2;
/// Most points of a pair.
pub(super) const MOST_POINTS: usize = 8;
/// Share of the turn up to which points are kept, of those of which some do not count.
const THINNED: f64 = 0.01;
/// How much higher than the deepest one points may be to be as deep, over the thickness.
const BAND: f64 = 1e-4;
/// Points nearer than this share of the thickness are one.
const SAME_POINT: f64 = 1e-3;
/// How far bounds are entered beyond a solid: time \[s\] at its present speed, and share of its thickness.
const AHEAD: (f64, f64) = (0.02, 0.1);
/// Bounds are entered anew with those of others when no more than this share of their room is left; those that still leave this share of the room that new ones would have stay.
const SOON: f64 = 0.5;

/// A point of a pair.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Point {
    /// On either solid, in its frame.
    pub on: [V3; 2],
    id: u64,
    /// Inverse of the inverse effective masses along and across the normal.
    mass: [f64; 2],
    /// Impulses of the last step, over its length \[N\].
    pub normal: f64,
    pub tangent: V3,
}

/// Where the points of a pair are: the normal, and their places on either solid.
struct Spots {
    normal: V3,
    on: [[V3; 2]; MOST_POINTS],
}

/// What is asked of every pair in every step, in the order of the pairs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Entry {
    /// Paths of both bodies together up to which the pair need not be looked at \[m\]; infinite if it is blocked.
    pub limit: f64,
    /// What its points may close in this step beyond their own approach \[m\]; zero if it was not looked at.
    pub allowed: f64,
    /// Bodies.
    pub bodies: [u32; 2],
    /// Solids, or a solid and a plane.
    key: (u32, u32),
    /// The pair.
    pub slot: u32,
}

/// Which points of a pair take part.
#[derive(Debug, Clone, Copy)]
struct Within {
    /// Largest distance \[m\].
    reach: f64,
    /// What they may close in the step beyond their own approach \[m\]: more than `from`, at most `allowed`.
    from: f64,
    allowed: f64,
}

impl Within {
    /// For a point with a gap that its own motion changes by `change` in the step \[m\].
    #[inline(always)]
    fn holds(&self, gap: f64, change: f64) -> bool {
        let left = gap + change.min(0.0);
        gap <= self.reach && left <= self.allowed && left > self.from
    }
}

/// A pair of solids, or a solid and a plane.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pair {
    pub a: u32,
    pub b: u32,
    pub plane: bool,
    pub blocked: bool,
    /// Able to touch for the first time, or again.
    pub fresh: bool,
    /// Whether it has touched.
    pub seen: bool,
    /// Whether a solid has changed since its points were found.
    pub outdated: bool,
    /// Whether it has more points than count.
    is_thinned: bool,
    /// Whether its points bore something in the last step; and the share of its resistance to crushing in this step and in the next one.
    pub bore: bool,
    pub resistance: [f64; 2],
    /// Moment against rolling of the last step \[N m\].
    pub moment: V3,
    offset: f64,
    pub surface: Surface,
    pub normal: [V3; 2],
    /// A plane's normal in the solid's frame when the effective masses were found.
    weighed: V3,
    count: u8,
    pub points: [Point; MOST_POINTS],
}

impl Pair {
    pub fn new([a, b]: [usize; 2], plane: bool, surface: Surface, fresh: bool) -> Self {
        Self {
            a: a as u32,
            b: b as u32,
            plane,
            blocked: false,
            fresh,
            seen: false,
            outdated: false,
            is_thinned: false,
            bore: false,
            resistance: [1.0; 2],
            moment: [0.0; 3],
            offset: 0.0,
            surface,
            normal: [[0.0; 3]; 2],
            weighed: [0.0; 3],
            count: 0,
            points: [Point::default(); MOST_POINTS],
        }
    }

    /// How many points it has.
    pub fn count(&self) -> usize {
        usize::from(self.count)
    }

    pub fn forget(&mut self) {
        self.count = 0;
        self.bore = false;
        self.moment = [0.0; 3];
        self.offset = 0.0;
    }

    /// Enters a point with the impulse that the one with the same features had; returns its effective masses then, zero if there was none.
    fn enter(&mut self, old: &[Point], mut point: Point) -> [f64; 2] {
        let mut mass = [0.0; 2];
        if usize::from(self.count) < MOST_POINTS {
            if let Some(same) = old.iter().find(|p| p.id == point.id) {
                (point.normal, point.tangent) = (same.normal, same.tangent);
                mass = same.mass;
            }
            self.points[usize::from(self.count)] = point;
            self.count += 1;
        }
        mass
    }
}

impl ContactSet {
    /// Places a solid, once a step.
    fn place(&mut self, i: usize, bodies: &[Moving]) {
        if std::mem::replace(&mut self.placed_in[i], self.step) == self.step {
            return;
        }
        let collider = &self.colliders[i];
        let body = bodies.get(collider.body).map(|b| Placed { x: b.x, q: b.q, r: b.r });
        self.placed[i] = collider.placed(body);
    }

    /// Enters new bounds of the solids that may leave theirs in this step, and the pairs that come of it.
    pub(super) fn enter_bounds(&mut self, bodies: &[Moving], h: f64) {
        let left = |set: &Self, i: usize| set.budget[i] - (set.travel[i] + set.path[i] + MARGIN_M);
        if self.alarm == f64::INFINITY || !(0..bodies.len()).any(|i| bodies[i].alive && left(self, i) < 0.0) {
            return;
        }
        // Those that would soon be late go with them: one walk through the tree for all.
        self.due.clear();
        for (i, body) in bodies.iter().enumerate() {
            self.due.push(body.alive && left(self, i) < SOON * self.ahead[i]);
        }
        let mut room = std::mem::take(&mut self.room);
        room.clear();
        room.resize(bodies.len(), f64::INFINITY);
        self.moved.clear();
        self.moved.resize(self.colliders.len(), false);
        let mut any = false;
        for i in 0..self.colliders.len() {
            let body = self.colliders[i].body;
            let obstacle = body == self.ground;
            if !(if obstacle { self.first_look } else { self.due[body] }) {
                continue;
            }
            self.place(i, bodies);
            let collider = &self.colliders[i];
            let more = if obstacle {
                0.0
            } else {
                MARGIN_M
                    + 2.0 * self.path[body]
                    + (AHEAD.0 / h * self.path[body]).max(AHEAD.1 * collider.thickness)
            };
            let [low, high] = collider.solid.bounds(&self.placed[i]);
            let old = self.entered[i];
            // a building that sways comes back to where it was
            let mut left =
                (0..3).map(|k| (low[k] - old[0][k]).min(old[1][k] - high[k])).fold(NEVER_M, f64::min);
            if obstacle || left < SOON * more {
                let bounds = [low.map(|v| v - more), high.map(|v| v + more)];
                self.entered[i] = bounds;
                self.broad.set(i, bounds);
                self.moved[i] = true;
                (any, left) = (true, more);
            }
            if !obstacle {
                room[body] = room[body].min(left);
            }
        }
        for (i, room) in room.iter().enumerate() {
            if self.due[i] {
                (self.budget[i], self.ahead[i]) = (self.travel[i] + room, *room);
            }
        }
        self.room = room;
        if any {
            self.enter_pairs(bodies);
        }
    }

    fn enter_pairs(&mut self, bodies: &[Moving]) {
        let mut met = std::mem::take(&mut self.met);
        met.clear();
        let colliders = &self.colliders;
        self.broad.changed_pairs(|a, b| {
            if colliders[a].body != colliders[b].body {
                met.push((a.min(b) as u32, a.max(b) as u32));
            }
        });
        met.sort_unstable();
        self.drop_apart();
        let known = self.order.len();
        for &(a, b) in &met {
            let of_a = self.colliders[a as usize].body;
            let partner = self.colliders[b as usize].partner;
            let old = &self.order[self.plane_pairs..known];
            if of_a == self.ground || old.binary_search_by_key(&(a, b), |entry| entry.key).is_ok() {
                continue;
            }
            let Some(surface) = self.surfaces.between(of_a, partner) else { continue };
            let mut pair = Pair::new([a as usize, b as usize], false, surface, self.first_look);
            pair.blocked = self.is_blocked(&pair, |i| bodies[i].alive);
            pair.seen = self.seen.contains(&(of_a, partner));
            self.enter_pair(pair);
        }
        // Both parts are sorted, so that this only merges them.
        self.order[self.plane_pairs..].sort_by_key(|entry| entry.key);
        self.first_look = false;
        self.met = met;
    }

    /// Keeps a pair, at the end of the order.
    pub(super) fn enter_pair(&mut self, pair: Pair) {
        let slot = self.free.pop().unwrap_or(self.pairs.len() as u32);
        self.order.push(Entry {
            limit: if pair.blocked { f64::INFINITY } else { f64::NEG_INFINITY },
            allowed: 0.0,
            bodies: self.bodies_of(&pair).map(|i| i as u32),
            key: (pair.a, pair.b),
            slot,
        });
        if slot as usize == self.pairs.len() {
            self.pairs.push(pair);
        } else {
            self.pairs[slot as usize] = pair;
        }
    }

    /// Drops the pairs whose bounds do not overlap any more.
    fn drop_apart(&mut self) {
        let (entered, moved, free) = (&self.entered, &self.moved, &mut self.free);
        let mut rank = 0;
        let planes = self.plane_pairs;
        self.order.retain(|entry| {
            rank += 1;
            let [a, b] = [entry.key.0 as usize, entry.key.1 as usize];
            if rank <= planes || !moved[a] && !moved[b] {
                return true;
            }
            let overlap = collide::overlap(&entered[a], &entered[b]);
            if !overlap {
                free.push(entry.slot);
            }
            overlap
        });
    }

    /// Enters the points of a pair that close in this step, or would if `allowed` \[m\] came on top of their own approach, into the rows, but those that do
    /// with `from` and are in already. A pair that is left alone from now on forgets its points: whether it is looked at in the meantime must not show when its solids meet again.
    pub(super) fn look(&mut self, entry: usize, bodies: &[Moving], h: f64, from: f64, allowed: f64) {
        let [a, b] = self.order[entry].bodies.map(|i| i as usize);
        let v = bodies.get(b).map_or([0.0; 3], |body| body.v);
        let approach = h * math::norm(math::sub(bodies[a].v, v)) + (self.spin[a] + self.spin[b]);
        let within = Within { reach: approach + allowed, from, allowed };
        let slot = self.order[entry].slot as usize;
        self.place(self.pairs[slot].a as usize, bodies);
        if entry >= self.plane_pairs {
            self.place(self.pairs[slot].b as usize, bodies);
        }
        let (limit, allowed) = if entry < self.plane_pairs {
            (self.look_at_plane(slot, bodies, h, within), allowed)
        } else {
            self.look_at_solids(slot, bodies, h, within)
        };
        // the bound from before holds as well; but one with points is looked at in the next step, that may be shorter, so that it forgets them then if they are too far
        let entry = &mut self.order[entry];
        let limit = if limit == f64::NEG_INFINITY { limit } else { limit.max(entry.limit) };
        (entry.limit, entry.allowed) = (limit, allowed);
    }

    /// Returns the paths up to which it need not be looked at again.
    fn look_at_plane(&mut self, slot: usize, bodies: &[Moving], h: f64, within: Within) -> f64 {
        let reach = within.reach;
        let pair = &mut self.pairs[slot];
        let collider = &self.colliders[pair.a as usize];
        let at = &self.placed[pair.a as usize];
        let plane = self.planes[pair.b as usize];
        let n = math::scale(-1.0, plane.normal);
        let low = math::dot(at.x, plane.normal) - collider.solid.reach(at, n) - plane.level;
        if low > reach {
            pair.forget();
            pair.fresh = false;
            return self.travel[collider.body] + low;
        }
        pair.offset = if pair.fresh { (-low).max(0.0) } else { pair.offset.min((-low).max(0.0)) };
        pair.fresh = false;
        self.kept.clear();
        self.kept.extend_from_slice(&pair.points[..usize::from(pair.count)]);
        if within.from == f64::NEG_INFINITY {
            pair.count = 0;
        }
        let normal = math::mul_t(&at.r, n);
        let turned = math::sub(normal, pair.weighed);
        let round = collider.solid.is_round();
        // one that had no points has none to keep the masses of, however long it was looked at
        let keep = !round && !self.kept.is_empty() && math::dot(turned, turned) <= STALE * STALE;
        if !keep {
            pair.weighed = normal;
        }
        pair.normal = [normal, plane.normal];
        collider.solid.feet(at, plane.normal, reach - low - pair.offset, &mut self.feet);
        let body = &bodies[collider.body];
        let first = self.rows.rows.len() as u32;
        if self.feet.len() > MOST_POINTS {
            let rise = |foot: &V3| math::dot(math::mul(&at.r, *foot), plane.normal);
            let low = self.feet.iter().map(|(foot, _)| rise(foot)).fold(f64::INFINITY, f64::min);
            let farthest = within.reach - pair.offset + low;
            self.feet.retain(|(foot, _)| rise(foot) <= farthest);
            let of = |(foot, _): &(V3, u64)| (*foot, rise(foot) - low);
            spread::thin(&mut self.feet, of, normal, BAND * collider.thickness);
        }
        for (foot, id) in &self.feet {
            let above = math::mul(&at.r, *foot);
            let gap = math::dot(math::add(at.x, above), plane.normal) - plane.level + pair.offset;
            let to_foot = math::sub(math::add(at.x, above), body.x);
            // the foot of a ball is what will touch
            let down = if round { 0.0 } else { 0.5 * (gap - pair.offset) };
            let arm = math::axpy(to_foot, -down, plane.normal);
            let speed = math::dot(math::add(body.v, math::cross(body.w, arm)), plane.normal);
            if !within.holds(gap, h * speed) || usize::from(pair.count) == MOST_POINTS {
                continue;
            }
            let point = Point { on: [*foot; 2], id: *id, ..Point::default() };
            let mass = pair.enter(&self.kept, point);
            let k = usize::from(pair.count) - 1;
            // the point of a ball goes with its centre
            let turning = if round { math::sub(at.x, body.x) } else { to_foot };
            let halfway =
                if pair.points[k].normal > 0.0 { math::add(arm, body.mean_turn(h, turning)) } else { arm };
            pair.points[k].mass = if keep && mass[0] > 0.0 {
                mass
            } else {
                masses(&[Inverse::of(body), Inverse::default()], &[arm, [0.0; 3]], n)
            };
            let arms = [[arm, [0.0; 3]], [halfway, [0.0; 3]]];
            self.rows.rows.push(row(&pair.points[k], arms, gap, n, h, k));
        }
        self.rows.close_block([collider.body, self.ground], first, slot, pair.surface, n);
        f64::NEG_INFINITY
    }

    /// The same of two solids, and what their points may close beyond their own approach: zero if none of them takes part since the solids pass each other.
    fn look_at_solids(&mut self, slot: usize, bodies: &[Moving], h: f64, within: Within) -> (f64, f64) {
        let (reach, allowed) = (within.reach, within.allowed);
        let pair = &self.pairs[slot];
        let (a, b) = (pair.a as usize, pair.b as usize);
        let [of_a, of_b] = [self.colliders[a].body, self.colliders[b].body];
        let travelled = self.travel[of_a] + self.travel[of_b];
        let mut spots = self.spots(pair);
        // those that were looked at in this step already have been searched if they had to be
        let is_first = within.from == f64::NEG_INFINITY;
        if pair.count == 0 || pair.outdated || is_first && self.is_stale(pair, &spots) {
            let apart = self.separation([a, b], reach);
            if apart > reach {
                let pair = &mut self.pairs[slot];
                pair.forget();
                pair.fresh = false;
                return (travelled + apart, allowed);
            }
            self.search(slot, reach + self.tilt_m([of_a, of_b]));
            self.meet_balls(slot, bodies, h);
            spots = self.spots(&self.pairs[slot]);
        }
        let round = [a, b].iter().any(|i| self.colliders[*i].solid.is_round());
        let pair = &mut self.pairs[slot];
        let n = spots.normal;
        let centres = [a, b].map(|i| {
            let is_ball = self.colliders[i].solid.is_round();
            is_ball.then(|| self.placed[i].x)
        });
        let mut gaps = [0.0; MOST_POINTS];
        let mut arms = [[[0.0; 3]; 2]; MOST_POINTS];
        let mut least = f64::INFINITY;
        let centre_a = bodies[of_a].x;
        let centre_b = bodies.get(of_b).map_or([0.0; 3], |body| body.x);
        for (k, [on_a, on_b]) in spots.on[..usize::from(pair.count)].iter().copied().enumerate() {
            let gap = math::dot(math::sub(on_b, on_a), n);
            gaps[k] = gap;
            // the point of a ball is what will touch, at the end of its radius, and not yet opposite the other one
            let middle = math::scale(0.5, math::add(on_a, on_b));
            let at = if round { [on_a, on_b] } else { [middle; 2] };
            arms[k] = [math::sub(at[0], centre_a), math::sub(at[1], centre_b)];
            least = least.min(gap);
        }
        let depth = if least < 0.0 { -least } else { 0.0 };
        pair.offset = if pair.fresh { depth } else { pair.offset.min(depth) };
        pair.fresh = false;
        let first = self.rows.rows.len() as u32;
        let mut first_closes = (f64::INFINITY, 0);
        for k in 0..usize::from(pair.count) {
            let gap = gaps[k] + pair.offset;
            let speed = math::dot(
                math::sub(speed_of(bodies, of_b, arms[k][1]), speed_of(bodies, of_a, arms[k][0])),
                n,
            );
            if within.holds(gap, h * speed) {
                let halfway = if pair.points[k].normal > 0.0 {
                    halfway(bodies, [of_a, of_b], centres, (spots.on[k], arms[k]), h)
                } else {
                    arms[k]
                };
                if pair.points[k].mass[0] == 0.0 {
                    let inverse = [of_a, of_b].map(|i| bodies.get(i).map_or(Inverse::default(), Inverse::of));
                    pair.points[k].mass = masses(&inverse, &arms[k], n);
                }
                self.rows.rows.push(row(&pair.points[k], [arms[k], halfway], gap, n, h, k));
                let closes_s = -gap / speed;
                if speed < 0.0 && closes_s < first_closes.0 {
                    first_closes = (closes_s, k);
                }
            }
        }
        let (offset, surface) = (pair.offset, pair.surface);
        let is_far = least > MARGIN_M && offset == 0.0;
        let (closes_s, k) = first_closes;
        let passes =
            is_first && is_far && closes_s < h && self.pass_by([a, b], bodies, (closes_s, h), allowed);
        let bears = |pair: &Pair| pair.points[..usize::from(pair.count)].iter().any(|p| p.normal != 0.0);
        let grazes = !passes
            && (is_first && !round && !bears(&self.pairs[slot]))
            && self.grazes([a, b], bodies, (n, arms[k]), (closes_s, h));
        if passes || grazes {
            self.rows.rows.truncate(first as usize);
            // another face may be what meets next
            self.pairs[slot].outdated |= grazes;
            return (f64::NEG_INFINITY, 0.0);
        }
        self.rows.close_block([of_a, of_b], first, slot, surface, n);
        if least > reach {
            let apart = self.separation([a, b], reach);
            if apart > reach {
                self.pairs[slot].forget();
                return (travelled + apart, allowed);
            }
        }
        (f64::NEG_INFINITY, allowed)
    }

    /// A lower bound of the distance of two solids, a good one if it is not above `reach` \[m\].
    fn separation(&self, pair: [usize; 2], reach: f64) -> f64 {
        let [a, b] = pair.map(|i| (&self.colliders[i].solid, &self.placed[i]));
        let faces = gaps::separation(a, b);
        if faces > reach { faces } else { faces.max(gaps::edge_separation(a, b)) }
    }

    /// Where the points of a pair are in this step.
    fn spots(&self, pair: &Pair) -> Spots {
        let (at_a, at_b) = (&self.placed[pair.a as usize], &self.placed[pair.b as usize]);
        let mut on = [[[0.0; 3]; 2]; MOST_POINTS];
        for (on, point) in on.iter_mut().zip(&pair.points[..usize::from(pair.count)]) {
            let on_a = math::add(at_a.x, math::mul(&at_a.r, point.on[0]));
            *on = [on_a, math::add(at_b.x, math::mul(&at_b.r, point.on[1]))];
        }
        Spots { normal: math::mul(&at_a.r, pair.normal[0]), on }
    }

    /// Whether the points of a pair have moved against each other so far that they must be searched again.
    fn is_stale(&self, pair: &Pair, spots: &Spots) -> bool {
        let (a, b) = (&self.colliders[pair.a as usize], &self.colliders[pair.b as usize]);
        if a.solid.is_round() || b.solid.is_round() {
            return true;
        }
        let n = spots.normal;
        let turned = math::add(n, math::mul(&self.placed[pair.b as usize].r, pair.normal[1]));
        // what turns towards points that do not count needs them at once
        let most = if pair.is_thinned { THINNED * STALE } else { STALE };
        if math::dot(turned, turned) > most * most {
            return true;
        }
        let far = STALE * a.thickness.min(b.thickness);
        spots.on[..usize::from(pair.count)].iter().any(|[on_a, on_b]| {
            let d = math::sub(*on_b, *on_a);
            let slip = math::axpy(d, -math::dot(d, n), n);
            math::dot(slip, slip) > far * far
        })
    }

    /// How far corners of two solids come nearer, or farther apart, by the turn up to which their points are kept \[m\].
    fn tilt_m(&self, [a, b]: [usize; 2]) -> f64 {
        let radius = |i: usize| if i == self.ground { f64::INFINITY } else { self.radius[i] };
        2.0 * STALE * radius(a).min(radius(b))
    }

    fn search(&mut self, slot: usize, reach: f64) {
        self.work.searches += 1;
        let (a, b) = (self.pairs[slot].a as usize, self.pairs[slot].b as usize);
        let (at_a, at_b) = (self.placed[a], self.placed[b]);
        let (solid_a, solid_b) = (&self.colliders[a], &self.colliders[b]);
        let normals =
            self.finder.find((&solid_a.solid, &at_a), (&solid_b.solid, &at_b), reach, &mut self.found);
        let pair = &mut self.pairs[slot];
        self.kept.clear();
        self.kept.extend_from_slice(&pair.points[..usize::from(pair.count)]);
        (pair.count, pair.outdated) = (0, false);
        let Some(normals) = normals else { return };
        pair.normal = normals;
        self.found.sort_by(|p, q| p.gap.total_cmp(&q.gap).then(p.id.cmp(&q.id)));
        let thickness = solid_a.thickness.min(solid_b.thickness);
        pair.is_thinned = self.found.len() > MOST_POINTS;
        if pair.is_thinned {
            let least = self.found[0].gap;
            spread::thin(&mut self.found, |p| (p.on_a, p.gap - least), normals[0], BAND * thickness);
        }
        let same = SAME_POINT * thickness;
        for i in 0..self.found.len() {
            let found = self.found[i];
            let near = |p: &Point| {
                let d = math::sub(p.on[0], found.on_a);
                math::dot(d, d) < same * same
            };
            if pair.points[..usize::from(pair.count)].iter().any(near) {
                continue;
            }
            pair.enter(&self.kept, Point { on: [found.on_a, found.on_b], id: found.id, ..Point::default() });
        }
    }

    /// Notes the first contact of a pair.
    #[cold]
    pub(super) fn note(&mut self, slot: usize, after_s: f64) {
        let pair = &mut self.pairs[slot];
        pair.seen = true;
        let pair = &self.pairs[slot];
        let a = self.bodies_of(pair)[0];
        let b: Partner = self.partner_of(pair);
        if self.seen.insert((a, b)) {
            self.touches.push(super::Touch { a, b, after_s });
        }
    }

    /// Takes back the first contacts of the last step.
    pub(super) fn forget_touches(&mut self) {
        for touch in std::mem::take(&mut self.touches) {
            self.seen.remove(&(touch.a, touch.b));
            for slot in 0..self.pairs.len() {
                let pair = &self.pairs[slot];
                if self.bodies_of(pair)[0] == touch.a && self.partner_of(pair) == touch.b {
                    self.pairs[slot].seen = false;
                }
            }
        }
    }
}

impl Inverse {
    pub fn of(body: &Moving) -> Self {
        let m = &body.inverse_inertia;
        Self { mass: body.inverse_mass, inertia: [m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]] }
    }
}

impl super::Rows {
    fn close_block(&mut self, bodies: [usize; 2], first: u32, slot: usize, surface: Surface, normal: V3) {
        let count = self.rows.len() as u32 - first;
        if count > 0 {
            self.blocks.push(Block {
                bodies: bodies.map(|b| b as u32),
                first,
                count,
                slot: slot as u32,
                friction: surface.friction,
                restitution: surface.restitution,
                rolling: surface.rolling,
                cap: f64::INFINITY,
                face: super::crush::NONE,
                normal,
                linked: super::links::ALONE,
                idle: false,
                left: false,
            });
        }
    }
}

/// Velocity of a point of a body \[m/s\].
pub(super) fn speed_of(bodies: &[Moving], body: usize, arm: V3) -> V3 {
    bodies.get(body).map_or([0.0; 3], |b| math::add(b.v, math::cross(b.w, arm)))
}

/// The arms of a point that has borne, in the middle of a step of `h` \[s\], in which it goes with its bodies.
fn halfway(
    bodies: &[Moving],
    of: [usize; 2],
    balls: [Option<V3>; 2],
    (on, arms): ([V3; 2], [V3; 2]),
    h: f64,
) -> [V3; 2] {
    let body = |i: usize| bodies.get(of[i]);
    let moved = |i: usize| {
        let Some(body) = body(i) else { return [[0.0; 3]; 2] };
        // the point of a ball goes with its centre
        let turns = body.mean_turn(h, math::sub(balls[i].unwrap_or(on[i]), body.x));
        [math::scale(0.5 * h, body.v), turns]
    };
    let [a, b] = [moved(0), moved(1)];
    let whole = |m: [V3; 2]| math::add(m[0], m[1]);
    match balls.map(|ball| ball.is_some()) {
        [true, false] => [math::add(arms[0], a[1]), math::add(arms[1], math::sub(whole(a), b[0]))],
        [false, true] => [math::add(arms[0], math::sub(whole(b), a[0])), math::add(arms[1], b[1])],
        _ => [math::add(arms[0], a[1]), math::add(arms[1], b[1])],
    }
}

/// Inverses of the inverse effective masses: along the normal, and the largest one across it.
fn masses(inverse: &[Inverse; 2], arms: &[V3; 2], n: V3) -> [f64; 2] {
    let both = |p: V3, q: V3| inverse[0].response(arms[0], p, q) + inverse[1].response(arms[1], p, q);
    let least = (0..3).min_by(|i, j| n[*i].abs().total_cmp(&n[*j].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let s = math::cross(n, axis);
    let s = math::scale(1.0 / math::norm(s), s);
    let t = math::cross(n, s);
    let (ss, tt, st) = (both(s, s), both(t, t), both(s, t));
    let across = 0.5 * (ss + tt) + (0.25 * (ss - tt) * (ss - tt) + st * st).sqrt();
    [1.0 / both(n, n), 1.0 / across]
}

fn row(point: &Point, [arms, halfway]: [[V3; 2]; 2], gap: f64, n: V3, h: f64, k: usize) -> Row {
    let tangent = math::axpy(point.tangent, -math::dot(point.tangent, n), n);
    Row {
        arms,
        halfway,
        mass: point.mass,
        target: -gap.max(0.0) / h,
        gap,
        normal: h * point.normal,
        tangent: math::scale(h, tangent),
        point: k as u32,
        hit_s: f64::INFINITY,
    }
}
