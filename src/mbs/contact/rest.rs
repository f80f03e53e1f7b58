//! What contacts that go on bearing add to velocities at the full step.
//!
//! The impulse of a step is given at its begin, forces act half before it and half after: between two steps a body at rest on others has the velocity that its weight gives it in half a step. Where the
//! motion is to go on without these contacts, half of the impulse that they would have next is due.

use super::{ContactSet, Linked, Moving};
use crate::mbs::math::{self, V3};

impl ContactSet {
    /// Half of what the impulses of a step of `h` \[s\] from here would add to velocities and angular velocities, by body \[m/s, rad/s\]; none if nothing touches, or one of them would be an impact.
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
        let hit_s = trial.solve_linked(&mut after, [h; 2], mechanism).ok()?;
        if hit_s.is_some() || trial.strikes(bodies, h) {
            return None;
        }
        let half = |a: V3, b: V3| math::scale(0.5, math::sub(a, b));
        Some(bodies.iter().zip(&after).map(|(b, a)| [half(a.v, b.v), half(a.w, b.w)]).collect())
    }
}
