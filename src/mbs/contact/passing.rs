//! Solids that pass each other within a step, and balls that meet within it.
//!
//! A point closes in a step if its gap along the normal at the begin of the step does. Solids that pass an edge of each other would be struck by points that have left the other solid by then. Until the first point closes, the plane
//! between both parts them; if another direction parts them at that time, and still does at the end of the step, they have not met in between, since paths are straight and turns within a step small.

use super::collide::{Placed, Solid};
use super::gaps;
use super::pair::speed_of;
use super::{ContactSet, Moving};
use crate::mbs::math::{self, V3};

impl ContactSet {
    /// Whether two solids pass each other in a step of `h` \[s\] in which a first point closes after `closes_s`, with room for `allowed` \[m\] that they may come nearer.
    pub(super) fn pass_by(
        &self,
        solids: [usize; 2],
        bodies: &[Moving],
        (closes_s, h): (f64, f64),
        allowed: f64,
    ) -> bool {
        if closes_s >= h {
            return false;
        }
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
