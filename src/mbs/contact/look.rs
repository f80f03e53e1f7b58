//! A look at a pair in a step: where its points are by now, whether they must be searched anew, and which of them take part in the step.

use super::collide::Placed;
use super::gaps;
use super::pair::{MOST_POINTS, Pair, Point};
use super::rows::{Block, Inverse, Row};
use super::spread;
use super::{ContactSet, MARGIN_M, Moving, Surface};
use crate::mbs::math::{self, V3};

/// Relative motion of a pair until its points are searched again, as a share of the thickness of its solids.
const STALE: f64 = 1e-2;
/// Share of the turn up to which points are kept, of those of which some do not count.
const THINNED: f64 = 0.01;
/// How much higher than the deepest one points may be to be as deep, over the thickness.
const BAND: f64 = 1e-4;
/// Points nearer than this share of the thickness are one.
const SAME_POINT: f64 = 1e-3;

/// Where the points of a pair are: the normal, and their places on either solid.
struct Spots {
    normal: V3,
    on: [[V3; 2]; MOST_POINTS],
}

/// The points of a pair of solids as a step finds them: gaps, places from the centres of the bodies, smallest gap \[m\].
struct Reached {
    gaps: [f64; MOST_POINTS],
    arms: [[V3; 2]; MOST_POINTS],
    least: f64,
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

impl ContactSet {
    /// Places a solid, once a step.
    pub(super) fn place(&mut self, i: usize, bodies: &[Moving]) {
        if std::mem::replace(&mut self.placed_in[i], self.step) == self.step {
            return;
        }
        let collider = &self.colliders[i];
        let body = bodies.get(collider.body).map(|b| Placed { x: b.x, q: b.q, r: b.r });
        self.placed[i] = collider.placed(body);
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
        self.kept.extend_from_slice(&pair.points[..pair.count()]);
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
            thin(&mut self.feet, rise, reach - pair.offset, normal, BAND * collider.thickness);
        }
        for (foot, id) in &self.feet {
            let above = math::mul(&at.r, *foot);
            let gap = math::dot(math::add(at.x, above), plane.normal) - plane.level + pair.offset;
            let to_foot = math::sub(math::add(at.x, above), body.x);
            // the foot of a ball is what will touch
            let down = if round { 0.0 } else { 0.5 * (gap - pair.offset) };
            let arm = math::axpy(to_foot, -down, plane.normal);
            let speed = math::dot(math::add(body.v, math::cross(body.w, arm)), plane.normal);
            if !within.holds(gap, h * speed) || pair.count() == MOST_POINTS {
                continue;
            }
            let point = Point { on: [*foot; 2], id: *id, ..Point::default() };
            let mass = pair.enter(&self.kept, point);
            let k = pair.count() - 1;
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
        let (a, b) = (self.pairs[slot].a as usize, self.pairs[slot].b as usize);
        let [of_a, of_b] = [self.colliders[a].body, self.colliders[b].body];
        let travelled = self.travel[of_a] + self.travel[of_b];
        let spots = match self.renewed(slot, bodies, h, within) {
            Ok(spots) => spots,
            Err(apart) => return (travelled + apart, allowed),
        };
        let points = self.reached(slot, bodies, &spots);
        let depth = if points.least < 0.0 { -points.least } else { 0.0 };
        let pair = &mut self.pairs[slot];
        pair.offset = if pair.fresh { depth } else { pair.offset.min(depth) };
        pair.fresh = false;
        let (offset, surface) = (pair.offset, pair.surface);
        let first = self.rows.rows.len();
        let (closes_s, k) = self.enter_rows(slot, bodies, h, within, (&spots, &points));
        let is_first = within.from == f64::NEG_INFINITY;
        let is_far = points.least > MARGIN_M && offset == 0.0;
        let passes =
            is_first && is_far && closes_s < h && self.pass_by([a, b], bodies, (closes_s, h), allowed);
        let bears = |pair: &Pair| pair.points[..pair.count()].iter().any(|p| p.normal != 0.0);
        let grazes = !passes
            && (is_first && !self.is_round([a, b]) && !bears(&self.pairs[slot]))
            && self.grazes([a, b], bodies, (spots.normal, points.arms[k]), (closes_s, h));
        if passes || grazes {
            self.rows.rows.truncate(first);
            // another face may be what meets next
            self.pairs[slot].outdated |= grazes;
            return (f64::NEG_INFINITY, 0.0);
        }
        self.rows.close_block([of_a, of_b], first as u32, slot, surface, spots.normal);
        if points.least > reach {
            let apart = self.separation([a, b], reach);
            if apart > reach {
                self.pairs[slot].forget();
                return (travelled + apart, allowed);
            }
        }
        (f64::NEG_INFINITY, allowed)
    }

    /// The points of two solids, searched anew if they must be; how far apart these are if that is out of reach \[m\].
    fn renewed(&mut self, slot: usize, bodies: &[Moving], h: f64, within: Within) -> Result<Spots, f64> {
        let pair = &self.pairs[slot];
        let spots = self.spots(pair);
        // those that were looked at in this step already have been searched if they had to be
        let is_first = within.from == f64::NEG_INFINITY;
        if pair.count > 0 && !pair.outdated && !(is_first && self.is_stale(pair, &spots)) {
            return Ok(spots);
        }
        let solids = [pair.a as usize, pair.b as usize];
        let apart = self.separation(solids, within.reach);
        if apart > within.reach {
            let pair = &mut self.pairs[slot];
            pair.forget();
            pair.fresh = false;
            return Err(apart);
        }
        self.search(slot, within.reach + self.tilt_m(solids.map(|i| self.colliders[i].body)));
        self.meet_balls(slot, bodies, h);
        Ok(self.spots(&self.pairs[slot]))
    }

    fn is_round(&self, solids: [usize; 2]) -> bool {
        solids.iter().any(|i| self.colliders[*i].solid.is_round())
    }

    /// Gaps of the points of two solids, and where these are from the centres of the bodies.
    #[inline]
    fn reached(&self, slot: usize, bodies: &[Moving], spots: &Spots) -> Reached {
        let pair = &self.pairs[slot];
        let solids = [pair.a as usize, pair.b as usize];
        let round = self.is_round(solids);
        let centres = solids.map(|i| bodies.get(self.colliders[i].body).map_or([0.0; 3], |body| body.x));
        let mut points =
            Reached { gaps: [0.0; MOST_POINTS], arms: [[[0.0; 3]; 2]; MOST_POINTS], least: f64::INFINITY };
        for (k, [on_a, on_b]) in spots.on[..pair.count()].iter().copied().enumerate() {
            let gap = math::dot(math::sub(on_b, on_a), spots.normal);
            points.gaps[k] = gap;
            // the point of a ball is what will touch, at the end of its radius, and not yet opposite the other one
            let middle = math::scale(0.5, math::add(on_a, on_b));
            let at = if round { [on_a, on_b] } else { [middle; 2] };
            points.arms[k] = [math::sub(at[0], centres[0]), math::sub(at[1], centres[1])];
            points.least = points.least.min(gap);
        }
        points
    }

    /// Enters the points of two solids that take part; returns when the first of them closes \[s\], and which.
    #[inline]
    fn enter_rows(
        &mut self,
        slot: usize,
        bodies: &[Moving],
        h: f64,
        within: Within,
        (spots, points): (&Spots, &Reached),
    ) -> (f64, usize) {
        let (n, arms) = (spots.normal, &points.arms);
        let pair = &mut self.pairs[slot];
        let solids = [pair.a as usize, pair.b as usize];
        let of = solids.map(|i| self.colliders[i].body);
        let balls = solids.map(|i| self.colliders[i].solid.is_round().then(|| self.placed[i].x));
        let mut first_closes = (f64::INFINITY, 0);
        for k in 0..pair.count() {
            let gap = points.gaps[k] + pair.offset;
            let [speed_a, speed_b] = [0, 1].map(|i| speed_of(bodies, of[i], arms[k][i]));
            let speed = math::dot(math::sub(speed_b, speed_a), n);
            if !within.holds(gap, h * speed) {
                continue;
            }
            let bears = pair.points[k].normal > 0.0;
            let halfway = if bears { halfway(bodies, of, balls, (spots.on[k], arms[k]), h) } else { arms[k] };
            if pair.points[k].mass[0] == 0.0 {
                let inverse = of.map(|i| bodies.get(i).map_or(Inverse::default(), Inverse::of));
                pair.points[k].mass = masses(&inverse, &arms[k], n);
            }
            self.rows.rows.push(row(&pair.points[k], [arms[k], halfway], gap, n, h, k));
            let closes_s = -gap / speed;
            if speed < 0.0 && closes_s < first_closes.0 {
                first_closes = (closes_s, k);
            }
        }
        first_closes
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
        for (on, point) in on.iter_mut().zip(&pair.points[..pair.count()]) {
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
        spots.on[..pair.count()].iter().any(|[on_a, on_b]| {
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
        self.kept.extend_from_slice(&pair.points[..pair.count()]);
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
            if pair.points[..pair.count()].iter().any(near) {
                continue;
            }
            pair.enter(&self.kept, Point { on: [found.on_a, found.on_b], id: found.id, ..Point::default() });
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

/// Leaves of points with their heights \[m\] those that count of the ones within reach of the lowest.
fn thin(feet: &mut Vec<(V3, u64)>, rise: impl Fn(&V3) -> f64, reach: f64, normal: V3, band: f64) {
    let low = feet.iter().map(|(foot, _)| rise(foot)).fold(f64::INFINITY, f64::min);
    feet.retain(|(foot, _)| rise(foot) <= reach + low);
    spread::thin(feet, |(foot, _)| (*foot, rise(foot) - low), normal, band);
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
