//! Tied nodes against rigid surfaces.
//!
//! A tied node has no mass of its own and follows its masters, so that it can only be stopped by what stops them: it
//! is a contact of its own in the system of [`super::solve`], its velocity the weighted sum of theirs.

use super::rigid::{Near, RigidSurfaces};
use super::solve::{Condition, Moving, Rows};
use crate::base::vector::{V3, dot};
use crate::fe::tie::Ties;
use serde::{Deserialize, Serialize};

/// Gap up to which a tied node at rest is looked at \[m\]; a moving one at four times its way in a step more.
const REACH_M: f64 = 1e-3;

/// The tied nodes that may strike a surface in a step.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct TiedStrikes {
    near: Vec<(usize, Near)>,
    flags: Vec<bool>,
    flagged: Vec<usize>,
}

impl TiedStrikes {
    /// Finds them, given positions \[m\] and velocities \[m/s\], and flags their masters.
    pub fn prepare(&mut self, ties: &Ties, surfaces: &RigidSurfaces, [x, v]: [&[V3]; 2], dt_s: f64) {
        self.near.clear();
        self.flagged.drain(..).for_each(|n| self.flags[n] = false);
        if ties.is_empty() {
            return;
        }
        self.flags.resize(x.len(), false);
        for (node, masters) in ties.tied() {
            let reach_m = REACH_M + 4.0 * dt_s * dot(v[node], v[node]).sqrt();
            let before = self.near.len();
            self.near.extend(surfaces.near(node, &x[node], reach_m).into_iter().map(|near| (node, near)));
            if self.near.len() > before {
                for (m, _) in masters {
                    self.flags[*m] = true;
                    self.flagged.push(*m);
                }
            }
        }
    }

    /// Whether the velocity of a node in this step is found together with a tied node's contact.
    #[inline]
    pub fn flags(&self, node: usize) -> bool {
        !self.near.is_empty() && self.flags.get(node).copied().unwrap_or(false)
    }

    /// The contacts between the flagged nodes (in the order of their numbers) and the surfaces.
    pub fn rows(&self, dt_s: f64, nodes: &[Moving], ties: &Ties) -> Rows {
        let mut rows = Rows::default();
        for (node, near) in &self.near {
            let place = |(n, w): (usize, f64)| {
                nodes.binary_search_by_key(&n, |m| m.at.node).ok().map(|p| (p as u32, w))
            };
            let Some(parts) = ties.carriers(*node).into_iter().map(place).collect::<Option<Vec<_>>>() else {
                continue; // a master without mass
            };
            let condition = Condition {
                normal: near.normal,
                target_m_s: -near.gap_m.max(0.0) / dt_s,
                friction: near.friction,
                rigid: Some((*node, near.surface)),
            };
            rows.push(parts.into_iter(), condition, nodes);
        }
        rows
    }
}
