//! Impulses of the contacts of one step.
//!
//! The two sides of a contact are weighted sums of nodes, a tied node being that of its masters. Contact `c` of a node with a face asks of the trial velocities, in which all forces of the step already act, that the node
//! comes no nearer than the surface: `n · (v_node - Σ w v_corner) >= -gap / Δt` (0 once it is behind). The
//! impulses come from projected Gauss-Seidel sweeps in a fixed order (Moreau 1988; Jean 1999), each
//! with the exact mass of its nodes; friction is the impulse in the face that stops the slip, at most `μ` times
//! the normal one. Every accepted change lowers the kinetic energy of the trial velocities, or lets it be: the normal one because it
//! minimises that energy over `p >= 0` (the targets are not positive but for the slow push-out), friction because it only
//! brakes. Pairs of opposite impulses keep momentum to round-off.

use super::rigid::{RigidSurfaces, Struck};
use crate::base::vector::{V3, add, dot, scale};
use std::ops::Range;

/// Sweeps over all contacts of a step, at most.
const SWEEPS: usize = 50;
/// Change of velocity in a sweep, over the largest in the first, at which sweeps end.
const TOLERANCE: f64 = 1e-4;

/// A node that takes part.
#[derive(Debug, Clone, Copy)]
pub struct Moving {
    /// What does not change in the step.
    pub at: Struck,
    /// Velocity: trial, in the end final \[m/s\].
    pub new: V3,
    /// `1 / mass` of the components that are not held \[1/kg\].
    pub ability: V3,
}

impl Moving {
    /// A node with its trial velocity.
    pub fn new(at: Struck, new: V3) -> Self {
        let ability = at.held.map(|h| if h || at.mass_kg == 0.0 { 0.0 } else { 1.0 / at.mass_kg });
        Self { at, new, ability }
    }

    /// Velocity at the full step \[m/s\].
    pub fn middle(&self) -> V3 {
        std::array::from_fn(|i| 0.5 * (self.at.old[i] + self.new[i]))
    }
}

/// What a contact asks.
#[derive(Debug, Clone, Copy)]
pub struct Condition {
    /// Unit normal.
    pub normal: V3,
    /// Least velocity along the normal \[m/s\].
    pub target_m_s: f64,
    /// Friction coefficient.
    pub friction: f64,
    /// Node and rigid surface, if it is with one.
    pub rigid: Option<(usize, usize)>,
}

/// One contact.
#[derive(Debug, Clone)]
pub struct Row {
    /// Its stretch of [`Rows::parts`].
    parts: Range<usize>,
    /// What it asks.
    condition: Condition,
    /// Normal impulse \[N s\].
    pub normal_ns: f64,
    /// Friction impulse on the node \[N s\].
    friction_ns: V3,
    /// Change of velocity by a unit impulse, along the normal and in the face \[1/kg\].
    ability: [f64; 2],
}

/// The contacts of a step.
#[derive(Debug, Clone, Default)]
pub struct Rows {
    /// The contacts.
    pub rows: Vec<Row>,
    /// Places among the moving nodes with weights, contact after contact; the sum with the weights is the relative velocity.
    parts: Vec<(u32, f64)>,
}

impl Rows {
    /// Adds a contact between the places with their weights, some of which may come twice; `false` if nothing in it can move.
    pub fn push(
        &mut self,
        parts: impl Iterator<Item = (u32, f64)>,
        condition: Condition,
        nodes: &[Moving],
    ) -> bool {
        let first = self.parts.len();
        for (place, weight) in parts {
            match self.parts[first..].iter_mut().find(|p| p.0 == place) {
                Some(same) => same.1 += weight,
                None => self.parts.push((place, weight)),
            }
        }
        let mut each = [0.0; 3];
        for (p, w) in &self.parts[first..] {
            for i in 0..3 {
                each[i] += w * w * nodes[*p as usize].ability[i];
            }
        }
        let normal = condition.normal;
        let along = (0..3).map(|i| each[i] * normal[i] * normal[i]).sum::<f64>();
        let across = each.iter().fold(0.0, |a: f64, b| a.max(*b));
        let most = self.parts[first..].iter().map(|(p, _)| nodes[*p as usize].ability);
        let most = most.flatten().fold(0.0, f64::max);
        let moves = along > 1e-12 * across && across > 1e-12 * most;
        if !moves {
            self.parts.truncate(first);
            return false;
        }
        self.rows.push(Row {
            parts: first..self.parts.len(),
            condition,
            normal_ns: 0.0,
            friction_ns: [0.0; 3],
            ability: [along, across],
        });
        true
    }

    /// Finds the impulses and the final velocities.
    pub fn solve(&mut self, nodes: &mut [Moving], rigid: &mut RigidSurfaces) -> Work {
        if nodes.is_empty() {
            return Work::default();
        }
        solve(&mut self.rows, &self.parts, nodes, rigid)
    }
}

/// Velocity of one side against the other.
#[inline]
fn relative(parts: &[(u32, f64)], velocity: impl Fn(&Moving) -> V3, nodes: &[Moving]) -> V3 {
    let mut u = [0.0; 3];
    for (p, w) in parts {
        let v = velocity(&nodes[*p as usize]);
        for i in 0..3 {
            u[i] += w * v[i];
        }
    }
    u
}

impl Row {
    /// Makes the contact hold by itself; returns the change of velocity.
    #[inline]
    fn relax(&mut self, parts: &[(u32, f64)], nodes: &mut [Moving]) -> f64 {
        let Condition { normal, target_m_s, friction, .. } = self.condition;
        let u = relative(parts, |n| n.new, nodes);
        let speed = dot(u, normal);
        let normal_ns = (self.normal_ns + (target_m_s - speed) / self.ability[0]).max(0.0);
        if normal_ns == 0.0 && self.normal_ns == 0.0 {
            return 0.0;
        }
        let slip = add(u, scale(-speed, normal));
        let mut wanted: V3 = std::array::from_fn(|i| self.friction_ns[i] - slip[i] / self.ability[1]);
        let size = dot(wanted, wanted).sqrt();
        let most = if normal_ns == 0.0 { 0.0 } else { friction * normal_ns };
        if size > most {
            wanted = scale(most / size, wanted);
        }
        let change = normal_ns - self.normal_ns;
        let impulse: V3 = std::array::from_fn(|i| change * normal[i] + wanted[i] - self.friction_ns[i]);
        (self.normal_ns, self.friction_ns) = (normal_ns, wanted);
        for (p, w) in parts {
            let node = &mut nodes[*p as usize];
            for i in 0..3 {
                node.new[i] += w * node.ability[i] * impulse[i];
            }
        }
        dot(impulse, impulse).sqrt() * self.ability[1]
    }
}

/// Work of the impulses of a step \[J\].
#[derive(Debug, Clone, Copy, Default)]
pub struct Work {
    /// Of normal and of friction impulses between parts of the body.
    pub body_j: [f64; 2],
    /// Of rigid surfaces on the nodes that take part.
    pub rigid_j: [f64; 2],
    /// Of what holds the prescribed components against the contacts.
    pub held_j: f64,
}

fn solve(rows: &mut [Row], parts: &[(u32, f64)], nodes: &mut [Moving], rigid: &mut RigidSurfaces) -> Work {
    let mut work = Work::default();
    let mut struck = vec![[0.0; 3]; nodes.len()];
    let mut largest: f64 = 0.0;
    for sweep in 0..SWEEPS {
        let mut change: f64 = 0.0;
        for row in rows.iter_mut() {
            change = change.max(row.relax(&parts[row.parts.clone()], nodes));
        }
        for (node, struck) in nodes.iter_mut().zip(&mut struck) {
            if node.ability == [0.0; 3] || !rigid.reached(node.at.node, node.at.dt_s, &node.at.x, &node.new) {
                continue;
            }
            let before = node.new;
            let taken = rigid.resolve(&node.at, &mut node.new);
            let middle = node.middle();
            for i in 0..3 {
                let impulse = node.at.mass_kg * (node.new[i] - before[i]);
                struck[i] += impulse;
                work.rigid_j[0] -= impulse * middle[i]; // booked below, with the final velocity
                change = change.max((node.new[i] - before[i]).abs());
            }
            work.rigid_j = [work.rigid_j[0] + taken[0], work.rigid_j[1] + taken[1]];
        }
        if sweep == 0 {
            largest = change;
        }
        if rows.is_empty() || change <= TOLERANCE * largest {
            break;
        }
    }
    for (node, impulse) in nodes.iter().zip(&struck) {
        work.rigid_j[0] += dot(*impulse, node.middle());
    }
    for row in rows.iter().filter(|row| row.normal_ns > 0.0) {
        let (parts, normal) = (&parts[row.parts.clone()], row.condition.normal);
        let middle = relative(parts, Moving::middle, nodes);
        let book = if row.condition.rigid.is_some() { &mut work.rigid_j } else { &mut work.body_j };
        book[0] += row.normal_ns * dot(normal, middle);
        book[1] += dot(row.friction_ns, middle);
        for (p, w) in parts {
            let node = &nodes[*p as usize];
            let middle = node.middle();
            for i in (0..3).filter(|i| node.ability[*i] == 0.0) {
                work.held_j -= w * (row.normal_ns * normal[i] + row.friction_ns[i]) * middle[i];
            }
        }
        if let Some((node, surface)) = row.condition.rigid {
            rigid.note(node, surface, row.normal_ns);
        }
    }
    work
}
