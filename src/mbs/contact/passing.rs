//! Solids that pass each other within a step, and balls that meet within it.
//!
//! A point closes in a step if its gap along the normal at the start of the step does. Solids that pass an edge of each other would be struck by points that have left the other solid by then. Until the first point closes, the plane
//! between both parts them; if another direction parts them at that time, and still does at the end of the step, they have not met in between, since paths are straight and turns within a step small.

use super::collide::{Placed, Solid};
use super::gaps;
use super::look::speed_of;
use super::{ContactSet, Moving};
use crate::mbs::math::{self, V3};

/// How far edges of solids are round for what comes upon them \[m\]: more than the weight of a step sinks (6e-5 m in 2.5 ms) and contacts leave unopened (1e-4 m).
const EDGE_M: f64 = 2e-4;
/// Speed up to which nothing comes upon anything \[m/s\].
const SLOW_M_S: f64 = 1e-3;
/// Steps within which a point closes that an impact may take with it.
const SOON: f64 = 2.0;
/// Cosine up to which a face is another one than that which meets.
const ACROSS: f64 = 0.5;

impl ContactSet {
    /// Whether two solids pass each other in a step of `h` \[s\] in which a first point closes after `closes_s`, with room for `allowed` \[m\] that they may come nearer.
    pub(super) fn pass_by(
        &self,
        solids: [usize; 2],
        bodies: &[Moving],
        (closes_s, h): (f64, f64),
        allowed: f64,
    ) -> bool {
        let room = allowed + solids.iter().map(|i| self.bow_m(self.colliders[*i].body)).sum::<f64>();
        let [a, b] = solids.map(|i| self.placed_after(i, bodies, closes_s));
        let along = gaps::widest_gap((self.solid(solids[0]), &a), (self.solid(solids[1]), &b));
        let gap = |a: &Placed, b: &Placed| {
            gaps::gap_along((self.solid(solids[0]), a), (self.solid(solids[1]), b), along)
        };
        if gap(&a, &b) <= room {
            return false;
        }
        let [a, b] = solids.map(|i| self.placed_after(i, bodies, h));
        gap(&a, &b) > room
    }

    /// Whether two solids of which a first point, with the given arms, closes along a normal in a step of `h` \[s\], after `closes_s`, graze each other: along the normal of another face of one of them they are no deeper in each other then, and at the end
    /// of the step, than the edge of a solid is taken to be round, and come nearer along it at less than half of the speed.
    ///
    /// A block that slides over the joint of two slabs that lie flush comes upon the side of the second one with nothing of it in its way but what rounding, the weight of a step and what contacts leave unopened let it sink.
    pub(super) fn grazes(
        &self,
        solids: [usize; 2],
        bodies: &[Moving],
        (normal, arms): (V3, [V3; 2]),
        (closes_s, h): (f64, f64),
    ) -> bool {
        if closes_s > SOON * h {
            return false;
        }
        let of = solids.map(|i| self.colliders[i].body);
        let kick = |i: usize| {
            bodies.get(of[i]).map_or([0.0; 3], |b| math::add(b.kick_v, math::cross(b.kick_w, arms[i])))
        };
        let velocity = math::sub(speed_of(bodies, of[1], arms[1]), speed_of(bodies, of[0], arms[0]));
        let kicks = math::sub(kick(1), kick(0));
        // what forces add in this step is no motion yet
        let nears_m_s = |n: V3| (-math::dot(velocity, n) - 2.0 * math::dot(kicks, n).abs()).max(0.0);
        let along_normal = nears_m_s(normal);
        if along_normal <= SLOW_M_S {
            return false;
        }
        let [first, last] =
            [closes_s.max(0.0), h.max(closes_s)].map(|t| solids.map(|i| self.placed_after(i, bodies, t)));
        let depth = |at: &[Placed; 2], n: V3| {
            -gaps::gap_along((self.solid(solids[0]), &at[0]), (self.solid(solids[1]), &at[1]), n)
        };
        let mut grazes = false;
        for side in 0..2 {
            let sign = if side == 0 { 1.0 } else { -1.0 };
            self.solid(solids[side]).each_normal(|n| {
                let n = math::scale(sign, math::mul(&first[side].r, n));
                grazes |= math::dot(n, normal).abs() < ACROSS
                    && depth(&first, n) <= EDGE_M
                    && depth(&last, n) <= EDGE_M
                    && 2.0 * nears_m_s(n) < along_normal;
            });
        }
        grazes
    }

    /// Gives the point of two balls that are apart the normal with which they meet in a step of `h` \[s\], or with which they are nearest to each other.
    pub(super) fn meet_balls(&mut self, slot: usize, bodies: &[Moving], h: f64) {
        let pair = &self.pairs[slot];
        let solids = [pair.a as usize, pair.b as usize];
        let (Solid::Ball(of_a), Solid::Ball(of_b)) = (self.solid(solids[0]), self.solid(solids[1])) else {
            return;
        };
        let radii = [*of_a, *of_b];
        let at = solids.map(|i| self.placed[i]);
        let way = math::sub(at[1].x, at[0].x);
        let apart = math::norm(way) - radii[0] - radii[1];
        if pair.count() == 0 || apart <= 0.0 {
            return;
        }
        let speed = |side: usize| {
            let body = self.colliders[solids[side]].body;
            let centre = bodies.get(body).map_or([0.0; 3], |b| b.x);
            speed_of(bodies, body, math::sub(at[side].x, centre))
        };
        let Some(n) = normal_of_meeting(way, math::sub(speed(1), speed(0)), radii[0] + radii[1], h) else {
            return;
        };
        let normal = [math::mul_t(&at[0].r, n), math::scale(-1.0, math::mul_t(&at[1].r, n))];
        let pair = &mut self.pairs[slot];
        pair.normal = normal;
        pair.points[0].on = [0, 1].map(|side: usize| math::scale(radii[side], normal[side]));
    }

    fn solid(&self, i: usize) -> &Solid {
        &self.colliders[i].solid
    }

    /// How far the path of a point of a body in the step is off a straight line at most \[m\]: the height of the arc.
    fn bow_m(&self, body: usize) -> f64 {
        let spin = self.spin[body];
        if spin > 0.0 { spin * spin / (8.0 * self.radius[body]) } else { 0.0 }
    }

    /// Where a solid is after a time without further contact \[s\].
    fn placed_after(&self, i: usize, bodies: &[Moving], time_s: f64) -> Placed {
        let Some(body) = bodies.get(self.colliders[i].body) else { return self.placed[i] };
        let now = &self.placed[i];
        let turn = math::qexp(math::scale(time_s, body.w));
        let arm: V3 = math::sub(now.x, body.x);
        let r = math::qmat(turn);
        Placed {
            x: math::add(math::axpy(body.x, time_s, body.v), math::mul(&r, arm)),
            q: math::qmul(turn, now.q),
            r: math::matmul(&r, &now.r),
        }
    }
}

/// Direction from the first to the second of two balls that are `way` \[m\] from centre to centre when the distance of their centres becomes `reach` \[m\], or is least, in a step of `h` \[s\]; nothing if they do not
/// come nearer.
fn normal_of_meeting(way: V3, velocity: V3, reach: f64, h: f64) -> Option<V3> {
    let (square, along) = (math::dot(velocity, velocity), math::dot(way, velocity));
    if along >= 0.0 {
        return None;
    }
    let root = along * along - square * (math::dot(way, way) - reach * reach);
    let time = if root < 0.0 { -along / square } else { (-along - root.sqrt()) / square };
    let then = math::axpy(way, time.min(h), velocity);
    Some(math::scale(1.0 / math::norm(then), then))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balls_meet_where_their_centres_are_their_radii_apart() {
        let half = 0.5_f64.sqrt();
        // the second one comes along x, a unit times the sine of 45° beside the first one
        let way = [3.0, half, 0.0];
        let n = normal_of_meeting(way, [-1.0, 0.0, 0.0], 1.0, 10.0).unwrap();
        assert!((n[0] - half).abs() < 1e-15 && (n[1] - half).abs() < 1e-15, "{n:?}");
        // passes: nearest where it is beside the first one
        let n = normal_of_meeting([3.0, 1.1, 0.0], [-1.0, 0.0, 0.0], 1.0, 10.0).unwrap();
        assert!(n[0].abs() < 1e-15 && n[1] == 1.0, "{n:?}");
        // still on its way at the end of the step
        let n = normal_of_meeting([3.0, 0.0, 1.0], [-1.0, 0.0, 0.0], 1.0, 1.0).unwrap();
        assert!((n[2] / n[0] - 0.5).abs() < 1e-15, "{n:?}");
        assert_eq!(normal_of_meeting(way, [0.0, 1.0, 0.0], 1.0, 1.0), None);
    }
}
