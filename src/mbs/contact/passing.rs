//! Solids that pass each other within a step.
//!
//! A point closes in a step if its gap along the normal at the begin of the step does. Solids that pass an edge of each other would be struck by points that have left the other solid by then. Until the first point closes, the plane
//! between both parts them; if another direction parts them at that time, and still does at the end of the step, they have not met in between, since paths are straight and turns within a step small.

use super::collide::{self, Placed};
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
        let along = collide::widest_gap((self.solid(solids[0]), &a), (self.solid(solids[1]), &b));
        let gap = |a: &Placed, b: &Placed| {
            collide::gap_along((self.solid(solids[0]), a), (self.solid(solids[1]), b), along)
        };
        if gap(&a, &b) <= room {
            return false;
        }
        let [a, b] = solids.map(|i| self.placed_after(i, bodies, h));
        gap(&a, &b) > room
    }

    fn solid(&self, i: usize) -> &collide::Solid {
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
