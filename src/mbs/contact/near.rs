//! Which solids are near each other: the bounds with which they are entered into the tree of boxes, and the pairs that come of it.

use super::pair::{Entry, Pair};
use super::{ContactSet, MARGIN_M, Moving, NEVER_M, collide};

/// How far bounds are entered beyond a solid: time \[s\] at its present speed, and share of its thickness.
const AHEAD: (f64, f64) = (0.02, 0.1);
/// Bounds are entered anew with those of others when no more than this share of their room is left; those that still leave this share of the room that new ones would have stay.
const SOON: f64 = 0.5;

impl ContactSet {
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
}
