//! Contact of nodes with rigid, immovable surfaces: the ground plane and boxes.
//!
//! A node that would cross a surface within the step keeps just the velocity that brings it onto the
//! surface (a perfectly plastic impact of the node's mass, as rigid walls of explicit codes do); Coulomb friction takes at
//! most `μ` times the normal impulse from its tangential velocity. There is no penalty stiffness, hence no penetration
//! and no further limit on the time step. Limits: nodes are tested, not faces, so that an obstacle's edge
//! narrower than an element can slip between nodes.

use crate::base::geom::Aabb;
use crate::building::Building;
use serde::{Deserialize, Serialize};

/// Rigid ground and boxes.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RigidSurfaces {
    /// Ground height \[m\] and friction coefficient.
    pub ground: Option<(f64, f64)>,
    /// Boxes with friction coefficient.
    pub boxes: Vec<(Aabb, f64)>,
    /// Whether each node has touched anything yet.
    touched: Vec<bool>,
    /// Nodes that touched for the first time since the list was last taken, with 0 for ground, 1 + i for box i.
    pub new_touches: Vec<(usize, usize)>,
}

impl RigidSurfaces {
    /// Surroundings of a building.
    pub fn of(building: &Building) -> Self {
        Self {
            ground: Some((building.ground.level_m, building.ground.friction)),
            boxes: building.obstacles.iter().map(|o| (o.solid, o.friction)).collect(),
            ..Self::default()
        }
    }

    pub(super) fn resize(&mut self, nodes: usize) {
        self.touched = vec![false; nodes];
    }

    /// Makes room for a copy of a node.
    pub(super) fn add_copy_of(&mut self, node: usize) {
        self.touched.push(self.touched[node]);
    }

    /// Whether a node at `x` with the trial velocity `new` needs [`Self::resolve`].
    #[inline]
    pub fn reached(&self, dt: f64, x: &[f64; 3], new: &[f64; 3]) -> bool {
        let below = self.ground.is_some_and(|(level, _)| x[2] + dt * new[2] < level);
        let inside =
            |solid: &Aabb| (0..3).all(|i| (solid.min[i]..solid.max[i]).contains(&(x[i] + dt * new[i])));
        below || self.boxes.iter().any(|(solid, _)| inside(solid))
    }

    /// Corrects the trial velocity of one node at `x`; returns the work on the node by normal and by
    /// friction impulses \[J\].
    #[inline]
    pub fn resolve(
        &mut self,
        node: usize,
        mass: f64,
        dt: f64,
        x: [f64; 3],
        old: &[f64; 3],
        new: &mut [f64; 3],
    ) -> [f64; 2] {
        let mut work = [0.0; 2];
        if let Some((level, friction)) = self.ground
            && x[2] + dt * new[2] < level
        {
            let target = ((level - x[2]) / dt).min(0.0).max(new[2]);
            let bounded = if x[2] < level { 0.0_f64.max(new[2]) } else { target };
            add(&mut work, stop(mass, 2, bounded, friction, old, new));
            self.note(node, 0);
        }
        for index in 0..self.boxes.len() {
            let (solid, friction) = self.boxes[index];
            let ahead: [f64; 3] = std::array::from_fn(|i| x[i] + dt * new[i]);
            if (0..3).any(|i| ahead[i] <= solid.min[i] || ahead[i] >= solid.max[i]) {
                continue;
            }
            let (axis, face) = entered_face(&solid, x);
            let target = if (face > solid.center()[axis]) == (x[axis] < face) && x[axis] != face {
                0.0 // already inside: stop, do not throw out
            } else {
                (face - x[axis]) / dt
            };
            add(&mut work, stop(mass, axis, target, friction, old, new));
            self.note(node, index + 1);
        }
        work
    }

    fn note(&mut self, node: usize, surface: usize) {
        if !self.touched[node] {
            self.touched[node] = true;
            self.new_touches.push((node, surface));
        }
    }
}

fn add(sum: &mut [f64; 2], more: [f64; 2]) {
    sum[0] += more[0];
    sum[1] += more[1];
}

/// The face of the box that the node is beyond, or the nearest one.
fn entered_face(solid: &Aabb, x: [f64; 3]) -> (usize, f64) {
    let candidates =
        (0..3).flat_map(|i| [(i, solid.min[i], solid.min[i] - x[i]), (i, solid.max[i], x[i] - solid.max[i])]);
    let best = candidates.max_by(|a, b| a.2.total_cmp(&b.2)).expect("six faces");
    (best.0, best.1)
}

/// Sets the normal velocity and takes friction; returns the work of both impulses.
fn stop(
    mass: f64,
    axis: usize,
    normal_velocity: f64,
    friction: f64,
    old: &[f64; 3],
    new: &mut [f64; 3],
) -> [f64; 2] {
    let change = normal_velocity - new[axis];
    let normal = mass * change * 0.5 * (old[axis] + normal_velocity);
    new[axis] = normal_velocity;
    let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
    let slip = (new[p] * new[p] + new[q] * new[q]).sqrt();
    if slip == 0.0 {
        return [normal, 0.0];
    }
    let factor = 1.0 - (friction * change.abs() / slip).min(1.0);
    let mut tangential = 0.0;
    for i in [p, q] {
        let after = new[i] * factor;
        tangential += mass * (after - new[i]) * 0.5 * (old[i] + after);
        new[i] = after;
    }
    [normal, tangential]
}
