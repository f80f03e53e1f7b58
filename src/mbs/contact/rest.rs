//! What contacts that go on bearing add to velocities at the full step.
//!
//! The impulse of a step is given at its start, forces act half before it and half after: between two steps a body at rest on others has the velocity that its weight gives it in half a step. Where the
//! motion is to go on without these contacts, half of the impulse that they would have next is due.

use super::{ContactSet, Linked, Moving};
use crate::mbs::math::{self, V3};

impl ContactSet {
    /// Half of what the impulses of a step of `h` \[s\] from here would add to velocities and angular velocities, by body \[m/s, rad/s\]: nothing in groups that an impact is in; none if nothing touches.
    pub fn half_borne(
        &self,
        bodies: &[Moving],
        h: f64,
        mechanism: Option<&mut (dyn Linked + '_)>,
    ) -> Option<Vec<[V3; 2]>> {
        if !self.has_points() {
            return None;
        }
        let (mut trial, mut after) = (self.clone(), bodies.to_vec());
        // with the impacts within the step, wherever they are
        trial.solve_linked(&mut after, h, Some(h), mechanism).ok()?;
        let groups = trial.groups();
        let strikes = trial.strikes(bodies, &groups);
        let half = |a: V3, b: V3| math::scale(0.5, math::sub(a, b));
        let of = |(i, (b, a)): (usize, (&Moving, &Moving))| {
            if strikes[groups.of(i)] { [[0.0; 3]; 2] } else { [half(a.v, b.v), half(a.w, b.w)] }
        };
        Some(bodies.iter().zip(&after).enumerate().map(of).collect())
    }
}
