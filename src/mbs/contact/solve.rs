//! A step: which pairs, impulses, rebound, gaps, energies.

use super::groups::Groups;
use super::rows::{Block, DEEP_M, Motion};
use super::{ContactSet, Linked, MARGIN_M, Moving, TooDeep};
use crate::mbs::math::{self, V3};

/// Times that pairs are looked for again because impulses made bodies faster.
const MOST_EXTENSIONS: usize = 4;
/// Share of half the thickness by which solids may be in each other.
const DEPTH_LIMIT: f64 = 1.0;
/// Approach speed from which there is rebound, over the velocity that forces add in half a step.
pub(super) const REBOUND_FROM: f64 = 4.0;
/// Sweeps end when no velocity of a point changes by more than this share of the velocity that forces add in a step.
const TOLERANCE: f64 = 1e-3;
/// Most sweeps of a step in which the impulses of the last one nearly hold.
const SWEEPS: usize = 4;
/// Visits of points in conjugate directions in any other step, unless so many sweeps need more.
const VISITS: usize = 240;
/// Visits in plain sweeps of such a step with an impact, and where there are no conjugate directions: ideal joints, rolling.
const PLAIN_VISITS: usize = 600;
/// Most sweeps of such a step.
const MOST_SWEEPS: usize = 400;
/// Visits of points in conjugate directions where sweeps left velocities far from settled.
const SEARCH_VISITS: usize = 40_000;
/// The same where masses are alike, after an impact that goes through many bodies.
const STRUCK_VISITS: usize = 10_000;
/// Sweeps that open gaps.
const GAP_SWEEPS: usize = 2;
/// The same in steps that leave a gap deeper than [`DEEP_M`].
const DEEP_SWEEPS: usize = 30;
/// Share of a gap opened in a visit.
const GAP_RATE: f64 = 0.2;
/// Penetration that is left alone \[m\].
const SLOP_M: f64 = 1e-4;
/// Change of a velocity in the first sweep, over what forces add in a step, from which a step counts as unsteady.
const UNSTEADY: f64 = 0.45;
/// Change of a velocity after the sweeps, over the same, from which conjugate directions go on, and the fewest of them that are worth it.
const SEARCH_FROM: f64 = 0.1;
const FEWEST_MOVES: usize = 8;
/// The same change where no body is much heavier than one that it presses on: an impact that goes through many bodies. There the directions go on until it is that of `SEARCH_FROM` only.
const STRUCK_FROM: f64 = 4.0;
/// Speed of a body, over the same, below which it rests; and the change from which bodies that do are searched on: what sweeps leave to the next step rocks a stack.
const RESTING: f64 = 4.0;
const ROCKING: f64 = 1e-2;
/// One sweep of so many visits points without impulses as well; so do the last one and the one that shows that velocities hold.
const WHOLE_EVERY: usize = 3;
/// Least velocity that errors are compared with \[m/s\].
const LEAST_SCALE_M_S: f64 = 1e-3;

/// What forces add to the velocity of a body in a step, of the one that has most of it \[m/s\]: errors of velocities are compared with it.
fn scale_m_s(bodies: &[Moving]) -> f64 {
    let kick = bodies.iter().map(|b| math::dot(b.kick_v, b.kick_v)).fold(0.0, f64::max).sqrt();
    (2.0 * kick).max(LEAST_SCALE_M_S)
}

impl ContactSet {
    /// Velocities with contact, and the displacements that open gaps, for a step of `h` \[s\] from the given poses.
    ///
    /// # Errors
    /// If solids are in each other by half their thickness.
    pub fn solve(&mut self, bodies: &mut [Moving], h: f64) -> Result<(), TooDeep> {
        self.solve_linked(bodies, h, Some(h), None).map(|_| ())
    }

    /// The same for bodies of which joints hold some together; their velocities before fit the joints, and those after do. Impacts are at the start of a step: `whole_s` \[s\] is the length that it had before it was
    /// shortened for them, its own if it was not; with none nothing is done where there is an impact within the step but to find the time of the first \[s\].
    ///
    /// # Errors
    /// If solids are in each other by half their thickness.
    pub fn solve_linked(
        &mut self,
        bodies: &mut [Moving],
        h: f64,
        whole_s: Option<f64>,
        mut mechanism: Option<&mut (dyn Linked + '_)>,
    ) -> Result<Option<f64>, TooDeep> {
        for body in bodies.iter_mut() {
            (body.shift, body.turn) = ([0.0; 3], [0.0; 3]);
        }
        self.begin(bodies, h);
        let points = self.find(bodies, h);
        self.find_touched();
        if !self.touched.is_empty() {
            return Ok(None);
        }
        let hit_s = if whole_s.is_none() { self.first_hit_s(bodies, h) } else { None };
        if hit_s.is_some() {
            return Ok(hit_s);
        }
        let lengths = [h, whole_s.unwrap_or(h)];
        if points > 0 {
            self.cap(bodies, h);
            self.work.steps += 1;
            self.work.most_points = self.work.most_points.max(points);
            self.rows.links.clear();
            self.rows.enter(0, bodies, &self.still);
            if let Some(m) = mechanism.as_deref_mut() {
                // an impulse may move any of them
                (0..bodies.len()).for_each(|i| self.rows.enter_body(i, bodies, &self.still));
                self.rows.links.join(bodies.len(), m);
                let groups = self.groups();
                self.rows.link(0, &groups, m);
            }
            let linked = mechanism.is_some();
            if linked {
                self.tie(bodies, lengths);
            }
            self.rows.warm_start(0);
            self.start_rolls(0, h, true);
            if linked {
                self.temper(bodies, &self.groups());
            }
            let is_settled = self.impulses(bodies, h, mechanism);
            if linked {
                // after them, since they may bring in more points
                let groups = self.groups();
                self.unjam(bodies, &groups);
                if !self.rebound_linked(bodies, &groups, lengths) {
                    self.temper(bodies, &groups);
                }
            } else {
                if !is_settled {
                    self.temper(bodies, &self.groups());
                }
                self.rebound(bodies, h);
            }
            self.close(bodies, lengths)?;
        }
        self.count_paths(bodies, h);
        self.alarm = if points > 0 { f64::NEG_INFINITY } else { self.clock };
        self.count_slack();
        Ok(None)
    }

    /// Looks at what is near before a step with paths of at most these lengths \[m\], that is not solved unless something is: false if there are points.
    pub fn glance(&mut self, bodies: &[Moving], h: f64, paths_m: &[f64]) -> bool {
        self.begin(bodies, h);
        for (path, most) in self.path.iter_mut().zip(paths_m) {
            *path = path.max(*most);
        }
        if self.find(bodies, h) > 0 {
            return false;
        }
        self.alarm = self.clock;
        self.count_slack();
        true
    }

    /// Begins a step of `h` \[s\].
    fn begin(&mut self, bodies: &[Moving], h: f64) {
        for (i, body) in bodies.iter().enumerate() {
            self.spin[i] = h * math::norm(body.w) * self.radius[i];
            self.path[i] = if body.alive { h * math::norm(body.v) + self.spin[i] } else { 0.0 };
            self.growth[i] = 0.0;
        }
        self.step += 1;
    }

    /// Finds the points that may take part in a step of `h` \[s\]; how many there are.
    fn find(&mut self, bodies: &[Moving], h: f64) -> usize {
        self.shorten();
        self.enter_bounds(bodies, h);
        self.rows.begin(bodies.len());
        self.look_at_all(bodies, h);
        self.rows.rows.len()
    }

    /// How far any point of a body moves in a step of `h` \[s\] at most \[m\].
    pub(super) fn path_of(&self, i: usize, v: V3, w: V3, h: f64) -> f64 {
        h * math::norm(v) + h * math::norm(w) * self.radius[i]
    }

    /// Distance that two bodies may close in this step beyond what their velocities at its start do \[m\].
    fn allowed(&self, [a, b]: [usize; 2]) -> f64 {
        (self.growth[a] + self.growth[b]) + MARGIN_M
    }

    /// Looks at the pairs that may touch.
    fn look_at_all(&mut self, bodies: &[Moving], h: f64) {
        self.until.clear();
        self.until.extend(self.travel.iter().zip(&self.path).map(|(travel, path)| travel + path + MARGIN_M));
        for k in 0..self.order.len() {
            self.order[k].allowed = 0.0;
            let entry = self.order[k];
            let [a, b] = entry.bodies.map(|i| i as usize);
            let may_meet = self.until[a] + self.until[b] >= entry.limit;
            let is_asked = may_meet || !self.settings.skip;
            if is_asked && entry.limit < f64::INFINITY && !self.is_still([a, b]) {
                self.work.looks += 1;
                let allowed = self.allowed([a, b]);
                self.look(k, bodies, h, f64::NEG_INFINITY, allowed);
                let found = &mut self.order[k].limit;
                // a look that is made for nothing leaves no better bound: it would be another run
                *found = if may_meet || *found == f64::NEG_INFINITY { *found } else { entry.limit };
            } else {
                self.work.left_alone += u64::from(entry.limit < f64::INFINITY);
            }
        }
    }

    /// Bodies asleep with points that one awake has as well.
    fn find_touched(&mut self) {
        let ground = self.ground;
        let asleep = |i: &usize| *i != ground && self.still[*i];
        let bodies = self.rows.blocks.iter().flat_map(|block| block.bodies.map(|i| i as usize));
        self.touched.clear();
        self.touched.extend(bodies.filter(asleep));
    }

    /// Scales the impulses down where they make energy: `J = p · ((u_0 + u)/2 - target)`, which exact impulses make least, must not exceed zero, its value without any. Those of
    /// the last step may do so as a first guess where joints nearly hold a point, since its effective mass changes from step to step there, and so may sweeps that have
    /// not converged, as friction is cut off with normal impulses that still change.
    fn temper(&mut self, bodies: &[Moving], groups: &Groups) {
        let before = |i: u32| super::roll::before(bodies, i);
        let mut works = vec![[0.0; 2]; groups.count()];
        for (k, block) in self.rows.blocks.iter().enumerate() {
            let [linear, square] = &mut works[groups.of_block(block)];
            let [rolled, rolls] = self.roll_work(k, before);
            (*linear, *square) = (*linear + rolled, *square + (rolls - rolled));
            let first = block.bodies.map(before);
            let now = block.bodies.map(|i| self.rows.motion[i as usize]);
            for row in &self.rows.rows[block.range()] {
                let p = math::axpy(row.tangent, row.normal, block.normal);
                let start = math::dot(p, row.passing(&first[0], &first[1]));
                *linear += start - row.normal * row.target;
                *square += math::dot(p, row.passing(&now[0], &now[1])) - start;
            }
        }
        self.rows.scale_down(groups, &works, 1.0, |i| before(i as u32));
    }

    /// Sweeps until the velocities hold, with the pairs that they bring near; whether they nearly do.
    fn impulses(&mut self, bodies: &[Moving], h: f64, mut mechanism: Option<&mut (dyn Linked + '_)>) -> bool {
        let mut is_settled = self.sweeps(bodies);
        for _ in 0..MOST_EXTENSIONS {
            let first = self.rows.blocks.len();
            if !self.extend(bodies, h) {
                break;
            }
            if self.rows.blocks.len() > first {
                self.cap(bodies, h);
                if let Some(m) = mechanism.as_deref_mut() {
                    let groups = self.groups();
                    self.rows.link(first, &groups, m);
                }
                self.rows.warm_start(first);
                self.start_rolls(first, h, true);
                is_settled = self.sweeps(bodies);
            }
        }
        if self.rows.may_search() && self.rows.sinks_to(h) < -DEEP_M {
            is_settled = self.hold(bodies);
        }
        is_settled
    }

    /// Goes on with conjugate directions where velocities that are left to the next step would let points sink deep; whether they settled.
    #[cold]
    fn hold(&mut self, bodies: &[Moving]) -> bool {
        let count = self.rows.rows.len();
        let tolerance_m_s = SEARCH_FROM * scale_m_s(bodies);
        let most = STRUCK_VISITS / (2 * count);
        self.conjugate(&self.groups(), count, most, tolerance_m_s) <= tolerance_m_s
    }

    /// Sweeps, and conjugate directions after an impact; whether the last ones changed velocities by no more than what leaves them to the next step.
    pub(super) fn sweeps(&mut self, bodies: &[Moving]) -> bool {
        let scale = scale_m_s(bodies);
        let mut change = self.rows.sweep(false, true);
        let mut done = 1;
        let count = self.rows.rows.len();
        let may_search = self.rows.may_search();
        let is_unsteady = change > UNSTEADY * scale;
        if is_unsteady && change <= STRUCK_FROM * scale && may_search {
            let most = (VISITS / (2 * count)).clamp(SWEEPS / 2, MOST_SWEEPS / 2);
            change = self.conjugate(&self.groups(), count, most, TOLERANCE * scale);
        } else {
            let most = if is_unsteady { (PLAIN_VISITS / count).clamp(SWEEPS, MOST_SWEEPS) } else { SWEEPS };
            let mut whole = true;
            while done < most && (change > TOLERANCE * scale || !whole) {
                whole = change <= TOLERANCE * scale || done % WHOLE_EVERY == 0 || done + 1 == most;
                change = self.rows.sweep(done % 2 == 1, whole);
                done += 1;
            }
        }
        let mut is_settled = change <= SEARCH_FROM * scale;
        if !is_settled {
            let (visits, from, until) = if self.rows.are_uneven() {
                (SEARCH_VISITS, SEARCH_FROM, TOLERANCE)
            } else {
                (STRUCK_VISITS, STRUCK_FROM, SEARCH_FROM)
            };
            let moves = visits / (2 * count);
            if change > from * scale && moves >= FEWEST_MOVES && may_search {
                change = self.conjugate(&self.groups(), count, moves, until * scale);
            }
            is_settled = change <= from * scale;
        }
        if change > ROCKING * scale && may_search && self.settle(bodies, scale) {
            is_settled = true;
        }
        if change > TOLERANCE * scale && self.work.last_unfinished != self.work.steps {
            self.work.unfinished += 1;
            self.work.last_unfinished = self.work.steps;
        }
        self.count_sweeps(done, count);
        is_settled
    }

    /// Goes on in the groups of bodies at rest until their velocities hold; whether all do.
    fn settle(&mut self, bodies: &[Moving], scale_m_s: f64) -> bool {
        let radius = &self.radius;
        let rests = |i: usize| {
            let body = &bodies[i];
            math::norm(body.v) + math::norm(body.w) * radius[i] < RESTING * scale_m_s
        };
        let ground = self.ground;
        let is_at_rest =
            |block: &Block| block.bodies.iter().all(|i| *i as usize == ground || rests(*i as usize));
        if !self.rows.blocks.iter().any(is_at_rest) {
            return false;
        }
        let groups = self.groups();
        let mut is_left = vec![false; groups.count()];
        for i in self.rows.acting.iter().map(|i| *i as usize).filter(|i| !rests(*i)) {
            is_left[groups.of(i)] = true;
        }
        let count = self.rows.leave(|block| is_left[groups.of_block(block)]);
        if count == 0 {
            self.rows.leave(|_| false);
            return false;
        }
        let tolerance_m_s = TOLERANCE * scale_m_s;
        let most = SEARCH_VISITS / (2 * count);
        let left = self.conjugate(&groups, count, most, tolerance_m_s);
        let all = self.rows.leave(|_| false) == count;
        all && left <= SEARCH_FROM * scale_m_s
    }

    /// Conjugate directions over so many points until the velocities hold; the largest change of a velocity in the sweep after them \[m/s\].
    fn conjugate(&mut self, groups: &Groups, count: usize, most: usize, tolerance_m_s: f64) -> f64 {
        self.rows.search_anew(groups.count());
        let (mut moves, mut change) = (0, f64::INFINITY);
        while moves < most && change > tolerance_m_s {
            change = self.rows.search(groups);
            moves += 1;
        }
        self.count_sweeps(2 * moves + 1, count);
        // back to where Coulomb's law allows
        self.rows.sweep(false, true)
    }

    /// Counts sweeps over so many points.
    fn count_sweeps(&mut self, sweeps: usize, count: usize) {
        self.work.sweeps += sweeps as u64;
        self.work.visits += (sweeps * count) as u64;
    }

    /// Enters the points that come within reach of the bodies that impulses made faster; false if there is no such body.
    pub(super) fn extend(&mut self, bodies: &[Moving], h: f64) -> bool {
        let allowed = 0.5 * MARGIN_M;
        let mut any = false;
        for k in 0..self.rows.acting.len() {
            let i = self.rows.acting[k] as usize;
            let motion = self.rows.motion[i];
            let (dv, dw) = (math::sub(motion.v, bodies[i].v), math::sub(motion.w, bodies[i].w));
            let growth = self.path_of(i, dv, dw, h);
            if growth > self.growth[i] + allowed {
                self.path[i] += 1.25 * growth - self.growth[i];
                self.growth[i] = 1.25 * growth;
                any = true;
            }
        }
        if !any {
            return false;
        }
        self.enter_bounds(bodies, h);
        let first = self.rows.blocks.len();
        for k in 0..self.order.len() {
            let entry = self.order[k];
            let [a, b] = entry.bodies.map(|i| i as usize);
            let path = self.path[a] + self.path[b] + MARGIN_M;
            if self.is_still([a, b])
                || self.growth[a] + self.growth[b] == 0.0
                || self.travel[a] + self.travel[b] + path < entry.limit
            {
                continue;
            }
            let allowed = self.allowed([a, b]);
            if allowed <= entry.allowed {
                continue;
            }
            let from = if entry.allowed > 0.0 { entry.allowed } else { f64::NEG_INFINITY };
            self.look(k, bodies, h, from, allowed);
        }
        self.rows.enter(first, bodies, &self.still);
        true
    }

    /// Gaps, energies, and what goes back to the bodies and pairs.
    fn close(&mut self, bodies: &mut [Moving], [h, whole_s]: [f64; 2]) -> Result<(), TooDeep> {
        self.check_depth()?;
        // what holds bodies in a blow is none that holds them in the next step
        self.book(bodies, h, h == whole_s);
        self.rows.look_ahead(h);
        self.crush();
        let worst = self.rows.worst();
        if worst < -SLOP_M {
            let sweeps = if worst < -DEEP_M { DEEP_SWEEPS } else { GAP_SWEEPS };
            self.rows.separate(sweeps, GAP_RATE);
        }
        for i in self.rows.acting.iter().map(|i| *i as usize) {
            (bodies[i].v, bodies[i].w) = (self.rows.motion[i].v, self.rows.motion[i].w);
            (bodies[i].shift, bodies[i].turn) = (self.rows.shift[i].v, self.rows.shift[i].w);
        }
        Ok(())
    }

    fn check_depth(&mut self) -> Result<(), TooDeep> {
        for block in &self.rows.blocks {
            let rows = &self.rows.rows[block.range()];
            let depth = rows.iter().map(|r| -r.gap).fold(0.0, f64::max);
            self.work.deepest_m = self.work.deepest_m.max(depth);
            let pair = &self.pairs[block.slot as usize];
            let other = if pair.plane { f64::INFINITY } else { self.colliders[pair.b as usize].thickness };
            if depth > DEPTH_LIMIT * self.colliders[pair.a as usize].thickness.min(other) {
                return Err(TooDeep { a: self.bodies_of(pair)[0], b: self.partner_of(pair), depth_m: depth });
            }
        }
        Ok(())
    }

    /// Books the work of the impulses: each does it on the mean of the velocities before and after the instant of contact. With `keeps` the impulses are kept for
    /// the next step.
    fn book(&mut self, bodies: &[Moving], h: f64, keeps: bool) {
        self.mean.resize(bodies.len() + 1, Motion::default());
        for i in self.rows.acting.iter().map(|i| *i as usize) {
            let (body, after) = (&bodies[i], &self.rows.motion[i]);
            self.mean[i] = Motion {
                v: math::sub(math::scale(0.5, math::add(body.v, after.v)), body.kick_v),
                w: math::sub(math::scale(0.5, math::add(body.w, after.w)), body.kick_w),
            };
        }
        let (mut normal_work, mut friction_work) = (0.0, 0.0);
        for k in 0..self.rows.blocks.len() {
            let block = self.rows.blocks[k];
            let [a, b] = block.bodies.map(|i| self.mean[i as usize]);
            let slot = block.slot as usize;
            let mut first_touch = f64::INFINITY;
            for row in &self.rows.rows[block.range()] {
                let mean = row.relative(&a, &b);
                let work = row.normal * math::dot(mean, block.normal);
                normal_work += work;
                self.faces.book(&block, row.normal, -work);
                friction_work += math::dot(row.tangent, mean);
                if keeps {
                    let point = &mut self.pairs[slot].points[row.point as usize];
                    point.normal = row.normal / h;
                    point.tangent = math::scale(1.0 / h, row.tangent);
                }
                if row.normal > 0.0 && !self.pairs[slot].seen && self.is_news(&self.pairs[slot], row.point) {
                    let [a, b] = block.bodies.map(|i| Motion::before(bodies, i as usize));
                    let closing = -math::dot(row.passing(&a, &b), block.normal);
                    first_touch = first_touch.min(row.touch_s(closing));
                }
            }
            if block.face != super::crush::NONE {
                let rows = &self.rows.rows[block.range()];
                let pair = &mut self.pairs[slot];
                pair.bore = rows.iter().any(|r| r.normal > 0.0);
                pair.resistance = [if pair.bore { pair.resistance[1] } else { 1.0 }, 1.0];
            }
            if first_touch < f64::INFINITY {
                self.note(slot, first_touch.min(h));
            }
        }
        for (block, roll) in self.rows.blocks.iter().zip(&self.rows.rolls).filter(|(b, _)| b.rolling > 0.0) {
            friction_work += math::dot(roll.moment, self.rows.spin(block, &self.mean));
            if keeps {
                self.pairs[block.slot as usize].moment = math::scale(1.0 / h, roll.moment);
            }
        }
        self.energy.normal_j -= normal_work;
        self.energy.friction_j -= friction_work;
    }

    fn count_paths(&mut self, bodies: &[Moving], h: f64) {
        let mut largest = 0.0_f64;
        for (i, body) in bodies.iter().enumerate().filter(|(_, body)| body.alive) {
            let path = if self.rows.acts_on(i) {
                self.path_of(i, body.v, body.w, h)
                    + math::norm(body.shift)
                    + math::norm(body.turn) * self.radius[i]
            } else {
                self.path[i]
            };
            self.travel[i] += path;
            largest = largest.max(path);
        }
        self.clock += 2.0 * largest;
    }
}
