//! Contact of nodes with rigid, immovable surfaces: the ground, boxes and planes of any orientation.
//!
//! A node that would cross a surface within the step keeps just the velocity that brings it onto the
//! surface (a perfectly plastic impact of the node's mass, as rigid walls of explicit codes do); Coulomb friction takes at
//! most `μ` times the normal impulse from its tangential velocity. There is no penalty stiffness, hence no penetration
//! and no further limit on the time step. Limits: nodes are tested, not faces, so that an obstacle's edge
//! narrower than an element can slip between nodes.

use crate::base::geom::Aabb;
use crate::base::vector::{V3, add as plus, dot, scale};
use crate::building::Building;
use crate::fe::model::RigidPlane;
use serde::{Deserialize, Serialize};

/// Passes over the planes that stop one node in a step, so that a node in a corner leaves none of them.
const PLANE_PASSES: usize = 4;
/// Up to this height off the ground level a node counts as standing on it at the start \[m\].
const AT_LEVEL_M: f64 = 1e-6;

/// A node about to be stopped.
#[derive(Debug, Clone, Copy)]
pub struct Struck {
    /// Node index.
    pub node: usize,
    /// Components whose velocity is prescribed.
    pub held: [bool; 3],
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Time step \[s\].
    pub dt_s: f64,
    /// Position \[m\].
    pub x: V3,
    /// Velocity before the step \[m/s\].
    pub old: V3,
}

/// A surface close to a node.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub(super) struct Near {
    /// 0 for ground, 1 + i for box i, 1 + boxes + i for plane i.
    pub surface: usize,
    /// Unit normal.
    pub normal: V3,
    /// Height of the node above it \[m\].
    pub gap_m: f64,
    /// Friction coefficient.
    pub friction: f64,
}

/// Rigid ground, boxes and planes.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct RigidSurfaces {
    /// Ground height \[m\] and friction coefficient.
    pub ground: Option<(f64, f64)>,
    /// Boxes with friction coefficient.
    pub boxes: Vec<(Aabb, f64)>,
    /// Planes of any orientation.
    pub planes: Vec<RigidPlane>,
    /// For each plane, whether it stops a node; empty: it stops all.
    stops: Vec<Vec<bool>>,
    /// Whether each node has touched anything yet.
    touched: Vec<bool>,
    /// Whether each node stood on the ground or below it at the start: its touch is no news.
    grounded: Vec<bool>,
    /// Whether each node started below the ground level and has not come up since; empty if none did.
    embedded: Vec<bool>,
    /// Bottom of what is embedded \[m\]: ground to these nodes.
    bottom_m: f64,
    /// Nodes that touched for the first time since the list was last taken, with 0 for ground, 1 + i for box i and
    /// 1 + boxes + i for plane i.
    pub new_touches: Vec<(usize, usize)>,
    /// Normal impulse on each node since they were last taken, and the surface that gave the last of it.
    pushes: Vec<Push>,
}

/// Normal impulse on a node.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub struct Push {
    /// Impulse \[N s\].
    pub impulse_ns: f64,
    /// 0 for ground, 1 + i for box i, 1 + boxes + i for plane i.
    pub surface: usize,
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

    /// Takes in where the nodes are at the start. What is below the ground level then stands in an excavation whose bottom is its own
    /// lowest node; it meets the ground there, and the level only after it has come up.
    pub(in crate::fe) fn begin(&mut self, x: &[V3]) {
        let nodes = x.len();
        self.touched = vec![false; nodes];
        self.pushes = vec![Push::default(); nodes];
        let chosen = |plane: &RigidPlane| {
            plane.nodes.as_ref().map_or(Vec::new(), |list| {
                let mut stops = vec![false; nodes];
                list.iter().for_each(|n| stops[*n] = true);
                stops
            })
        };
        self.stops = self.planes.iter().map(chosen).collect();
        let level = self.ground.map_or(f64::NEG_INFINITY, |(level, _)| level);
        self.grounded = x.iter().map(|p| p[2] < level + AT_LEVEL_M).collect();
        self.embedded = x.iter().map(|p| p[2] < level - AT_LEVEL_M).collect();
        if !self.embedded.contains(&true) {
            self.embedded.clear();
        }
        self.bottom_m = x.iter().map(|p| p[2]).fold(level, f64::min);
    }

    /// Notes which embedded nodes have come up.
    pub(in crate::fe) fn follow(&mut self, x: &[V3]) {
        if let Some((level, _)) = self.ground {
            self.embedded.iter_mut().zip(x).for_each(|(embedded, p)| *embedded &= p[2] < level);
        }
    }

    /// Height of the ground to a node and friction on it.
    #[inline]
    fn ground_of(&self, node: usize) -> Option<(f64, f64)> {
        let (level, friction) = self.ground?;
        let embedded = self.embedded.get(node).copied().unwrap_or(false);
        Some((if embedded { self.bottom_m } else { level }, friction))
    }

    /// Makes room for a copy of a node.
    pub(in crate::fe) fn add_copy_of(&mut self, node: usize) {
        self.touched.push(self.touched[node]);
        self.pushes.push(Push::default());
        self.grounded.push(self.grounded[node]);
        if !self.embedded.is_empty() {
            self.embedded.push(self.embedded[node]);
        }
        for stops in self.stops.iter_mut().filter(|s| !s.is_empty()) {
            stops.push(stops[node]);
        }
    }

    /// Whether a node at `x` with the trial velocity `new` needs [`Self::resolve`].
    #[inline]
    pub fn reached(&self, node: usize, dt: f64, x: &[f64; 3], new: &[f64; 3]) -> bool {
        let below = self.ground.is_some_and(|(level, _)| x[2] + dt * new[2] < level)
            && self.ground_of(node).is_some_and(|(level, _)| x[2] + dt * new[2] < level);
        let inside =
            |solid: &Aabb| (0..3).all(|i| (solid.min[i]..solid.max[i]).contains(&(x[i] + dt * new[i])));
        below
            || self.boxes.iter().any(|(solid, _)| inside(solid))
            || (0..self.planes.len()).any(|i| self.crosses(i, node, dt, x, new))
    }

    /// Whether a node at `x` is not farther than `reach_m` from any of the surfaces, or behind it.
    #[inline]
    pub(in crate::fe) fn is_near(&self, node: usize, x: &V3, reach_m: f64) -> bool {
        let over =
            |solid: &Aabb| (0..3).all(|i| (solid.min[i] - reach_m..solid.max[i] + reach_m).contains(&x[i]));
        self.ground.is_some_and(|(level, _)| x[2] <= level + reach_m)
            && self.ground_of(node).is_some_and(|(level, _)| x[2] <= level + reach_m)
            || self.boxes.iter().any(|(solid, _)| over(solid))
            || self
                .planes
                .iter()
                .enumerate()
                .any(|(i, plane)| self.stops_at(i, node) && height(plane, x) <= reach_m)
    }

    /// The least reach with which [`Self::is_near`] can be true of a node at `x`, embedded or not \[m\].
    pub(in crate::fe) fn gap_m(&self, node: usize, x: &V3) -> f64 {
        let over_ground = self.ground.map_or(f64::INFINITY, |(level, _)| x[2] - level);
        let out = |solid: &Aabb, i: usize| (solid.min[i] - x[i]).max(x[i] - solid.max[i]);
        let beside = |solid: &Aabb| (0..3).map(|i| out(solid, i)).fold(f64::NEG_INFINITY, f64::max);
        let boxes = self.boxes.iter().map(|(solid, _)| beside(solid));
        let planes =
            (0..self.planes.len()).filter(|i| self.stops_at(*i, node)).map(|i| height(&self.planes[i], x));
        boxes.chain(planes).fold(over_ground, f64::min)
    }

    /// Whether a plane stops a node.
    #[inline]
    fn stops_at(&self, plane: usize, node: usize) -> bool {
        self.stops.get(plane).is_none_or(|s| s.get(node).copied().unwrap_or(true))
    }

    fn crosses(&self, plane: usize, node: usize, dt: f64, x: &V3, new: &V3) -> bool {
        self.stops_at(plane, node)
            && height(&self.planes[plane], x) + dt * dot(self.planes[plane].normal, *new) < 0.0
    }

    /// Corrects the trial velocity of one node, leaving the components that are held as they are; returns the
    /// work on the node by normal and by friction impulses \[J\].
    #[inline]
    pub fn resolve(&mut self, at: &Struck, new: &mut V3) -> [f64; 2] {
        let mut work = self.resolve_boxes(at, new);
        add(&mut work, self.resolve_planes(at, new));
        work
    }

    /// Surfaces that a node at `x` is not farther from than `reach_m`, boxes only if it is over one of their faces.
    pub(super) fn near(&self, node: usize, x: &V3, reach_m: f64) -> Vec<Near> {
        let mut found = Vec::new();
        if let Some((level, friction)) = self.ground_of(node) {
            found.push(Near { surface: 0, normal: [0.0, 0.0, 1.0], gap_m: x[2] - level, friction });
        }
        for (index, (solid, friction)) in self.boxes.iter().enumerate() {
            let (axis, face) = entered_face(solid, *x);
            let over = (0..3).all(|i| i == axis || (solid.min[i]..solid.max[i]).contains(&x[i]));
            let sign = if face > solid.center()[axis] { 1.0 } else { -1.0 };
            if over {
                let normal = std::array::from_fn(|i| if i == axis { sign } else { 0.0 });
                let gap_m = sign * (x[axis] - face);
                found.push(Near { surface: 1 + index, normal, gap_m, friction: *friction });
            }
        }
        for (index, plane) in self.planes.iter().enumerate() {
            if self.stops_at(index, node) {
                let (gap_m, surface) = (height(plane, x), 1 + self.boxes.len() + index);
                found.push(Near { surface, normal: plane.normal, gap_m, friction: plane.friction });
            }
        }
        found.retain(|near| near.gap_m <= reach_m);
        found
    }

    /// Planes: impulses along the normal as far as the node can move, and friction in the plane.
    fn resolve_planes(&mut self, at: &Struck, new: &mut V3) -> [f64; 2] {
        let Struck { node, held, mass_kg: mass, dt_s: dt, x, old } = *at;
        let moves = held.map(|h| if h { 0.0 } else { 1.0 });
        let mut changes = [[0.0; 3]; 2];
        let passes = if self.planes.len() > 1 { PLANE_PASSES } else { self.planes.len() };
        for _ in 0..passes {
            for index in 0..self.planes.len() {
                if !self.crosses(index, node, dt, &x, new) {
                    continue;
                }
                let plane = &self.planes[index];
                let along: V3 = std::array::from_fn(|i| moves[i] * plane.normal[i]);
                let (ability, speed) = (dot(along, plane.normal), dot(plane.normal, *new));
                let target = (-height(plane, &x)).min(0.0) / dt;
                let mut impulse_ns = 0.0;
                if ability > 1e-12 && speed < target {
                    let change = (target - speed) / ability;
                    let after = plus(*new, scale(change, along));
                    let slipped = slowed(after, plane, held, plane.friction * change);
                    for i in 0..3 {
                        changes[0][i] += after[i] - new[i];
                        changes[1][i] += slipped[i] - after[i];
                    }
                    *new = slipped;
                    impulse_ns = mass * change;
                }
                self.note(node, 1 + self.boxes.len() + index, impulse_ns);
            }
        }
        let middle: V3 = std::array::from_fn(|i| 0.5 * (old[i] + new[i]));
        changes.map(|c| mass * dot(c, middle))
    }

    fn resolve_boxes(&mut self, at: &Struck, new: &mut V3) -> [f64; 2] {
        let Struck { node, held, dt_s: dt, x, .. } = *at;
        let mut work = [0.0; 2];
        if let Some((level, friction)) = self.ground_of(node)
            && !held[2]
            && x[2] + dt * new[2] < level
        {
            let target = ((level - x[2]) / dt).min(0.0).max(new[2]);
            let bounded = if x[2] < level { 0.0_f64.max(new[2]) } else { target };
            let impulse_ns = at.mass_kg * (bounded - new[2]);
            add(&mut work, stop(at, 2, bounded, friction, new));
            self.note(node, 0, impulse_ns);
        }
        for index in 0..self.boxes.len() {
            let (solid, friction) = self.boxes[index];
            let ahead: [f64; 3] = std::array::from_fn(|i| x[i] + dt * new[i]);
            if (0..3).any(|i| ahead[i] <= solid.min[i] || ahead[i] >= solid.max[i]) {
                continue;
            }
            let (axis, face) = entered_face(&solid, x);
            if held[axis] {
                continue;
            }
            let target = if (face > solid.center()[axis]) == (x[axis] < face) && x[axis] != face {
                0.0 // already inside: stop, do not throw out
            } else {
                (face - x[axis]) / dt
            };
            let impulse_ns = at.mass_kg * (target - new[axis]).abs();
            add(&mut work, stop(at, axis, target, friction, new));
            self.note(node, index + 1, impulse_ns);
        }
        work
    }

    /// The pushes on all nodes since the last call.
    pub(in crate::fe) fn take_pushes(&mut self) -> Vec<Push> {
        let nodes = self.pushes.len();
        std::mem::replace(&mut self.pushes, vec![Push::default(); nodes])
    }

    /// Notes that a surface pushes a node.
    pub(super) fn note(&mut self, node: usize, surface: usize, impulse_ns: f64) {
        let push = &mut self.pushes[node];
        *push = Push { impulse_ns: push.impulse_ns + impulse_ns, surface };
        let counts = surface != 0 || !self.grounded[node];
        if counts && !self.touched[node] {
            self.touched[node] = true;
            self.new_touches.push((node, surface));
        }
    }
}

/// Distance of a point from a plane, positive where matter may be \[m\].
fn height(plane: &RigidPlane, x: &V3) -> f64 {
    (0..3).map(|i| plane.normal[i] * (x[i] - plane.point_m[i])).sum()
}

/// A velocity whose part in the plane is lowered by `most` at the most.
fn slowed(v: V3, plane: &RigidPlane, held: [bool; 3], most: f64) -> V3 {
    let slip = plus(v, scale(-dot(plane.normal, v), plane.normal));
    let size = dot(slip, slip).sqrt();
    if size == 0.0 || most.is_nan() {
        return v;
    }
    let taken = (most / size).min(1.0);
    std::array::from_fn(|i| if held[i] { v[i] } else { v[i] - taken * slip[i] })
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

/// Sets the normal velocity and takes friction, leaving held components as they are; returns the work of both impulses.
fn stop(at: &Struck, axis: usize, normal_velocity: f64, friction: f64, new: &mut V3) -> [f64; 2] {
    let (mass, old) = (at.mass_kg, &at.old);
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
    for i in [p, q].into_iter().filter(|i| !at.held[*i]) {
        let after = new[i] * factor;
        tangential += mass * (after - new[i]) * 0.5 * (old[i] + after);
        new[i] = after;
    }
    [normal, tangential]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushes_are_the_normal_impulses_of_a_node() {
        let mut surfaces = RigidSurfaces { ground: Some((0.0, 0.5)), ..RigidSurfaces::default() };
        surfaces.begin(&[[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]);
        let at = Struck {
            node: 1,
            held: [false; 3],
            mass_kg: 2.0,
            dt_s: 1e-3,
            x: [0.0, 0.0, 1e-3],
            old: [3.0, 0.0, -5.0],
        };
        let mut new = at.old;
        surfaces.resolve(&at, &mut new);
        // what brings it onto the ground within the step is left to it
        assert_eq!(new[2], -1.0);
        let pushes = surfaces.take_pushes();
        assert_eq!((pushes[0].impulse_ns, pushes[1].impulse_ns, pushes[1].surface), (0.0, 2.0 * 4.0, 0));
        assert_eq!(surfaces.take_pushes()[1].impulse_ns, 0.0);
    }
}
