//! Impulses of the contacts of one step.
//!
//! Contact `c` of a node with a face asks of the trial velocities, in which all forces of the step already act, that the node
//! comes no nearer than the surface: `n · (v_node - Σ w v_corner) >= -gap / Δt` (0 once it is behind). The
//! impulses come from projected Gauss-Seidel sweeps in a fixed order (Moreau 1988; Jean 1999), each
//! with the exact mass of its five nodes; friction is the impulse in the face that stops the slip, at most `μ` times
//! the normal one. Every accepted change lowers the kinetic energy of the trial velocities, or lets it be: the normal one because it
//! minimises that energy over `p >= 0` (the targets are not positive but for the slow push-out), friction because it only
//! brakes. Pairs of opposite impulses keep momentum to round-off.

use super::rigid::{RigidSurfaces, Struck};
use crate::fe::hexahedron::{Vec3, add, dot, scaled};

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
    pub new: Vec3,
    /// `1 / mass` of the components that are not held \[1/kg\].
    pub ability: Vec3,
}

impl Moving {
    /// A node with its trial velocity.
    pub fn new(at: Struck, new: Vec3) -> Self {
        let ability = at.held.map(|h| if h || at.mass_kg == 0.0 { 0.0 } else { 1.0 / at.mass_kg });
        Self { at, new, ability }
    }

    /// Velocity at the full step \[m/s\].
    pub fn middle(&self) -> Vec3 {
        std::array::from_fn(|i| 0.5 * (self.at.old[i] + self.new[i]))
    }
}

/// One contact.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Places of the node and the four corners among the moving nodes.
    pub place: [u32; 5],
    /// Weights: 1 and minus those of the corners.
    pub weight: [f64; 5],
    /// Unit normal of the face.
    pub normal: Vec3,
    /// Least velocity along the normal \[m/s\].
    pub target_m_s: f64,
    /// Normal impulse \[N s\].
    pub normal_ns: f64,
    /// Friction impulse on the node \[N s\].
    friction_ns: Vec3,
    /// Change of velocity by a unit impulse, along the normal and in the face \[1/kg\].
    ability: [f64; 2],
}

impl Row {
    /// A contact; `None` if nothing in it can move.
    pub fn new(
        place: [u32; 5],
        corners: [f64; 4],
        normal: Vec3,
        target_m_s: f64,
        nodes: &[Moving],
    ) -> Option<Self> {
        let weight = [1.0, -corners[0], -corners[1], -corners[2], -corners[3]];
        let mut each = [0.0; 3];
        for (p, w) in place.iter().zip(weight) {
            for i in 0..3 {
                each[i] += w * w * nodes[*p as usize].ability[i];
            }
        }
        let along = (0..3).map(|i| each[i] * normal[i] * normal[i]).sum::<f64>();
        let across = each.iter().fold(0.0, |a: f64, b| a.max(*b));
        (along > 1e-12 * across && across > 0.0).then_some(Self {
            place,
            weight,
            normal,
            target_m_s,
            normal_ns: 0.0,
            friction_ns: [0.0; 3],
            ability: [along, across],
        })
    }

    /// Velocity of the node against the face.
    #[inline]
    fn relative(&self, velocity: impl Fn(&Moving) -> Vec3, nodes: &[Moving]) -> Vec3 {
        let mut u = [0.0; 3];
        for (p, w) in self.place.iter().zip(self.weight) {
            let v = velocity(&nodes[*p as usize]);
            for i in 0..3 {
                u[i] += w * v[i];
            }
        }
        u
    }

    /// Makes the contact hold by itself; returns the change of velocity.
    #[inline]
    fn relax(&mut self, friction: f64, nodes: &mut [Moving]) -> f64 {
        let u = self.relative(|n| n.new, nodes);
        let speed = dot(u, self.normal);
        let normal_ns = (self.normal_ns + (self.target_m_s - speed) / self.ability[0]).max(0.0);
        if normal_ns == 0.0 && self.normal_ns == 0.0 {
            return 0.0;
        }
        let slip = add(u, scaled(-speed, self.normal));
        let mut wanted: Vec3 = std::array::from_fn(|i| self.friction_ns[i] - slip[i] / self.ability[1]);
        let (size, most) = (dot(wanted, wanted).sqrt(), friction * normal_ns);
        if size > most {
            wanted = scaled(most / size, wanted);
        }
        let change = normal_ns - self.normal_ns;
        let impulse: Vec3 =
            std::array::from_fn(|i| change * self.normal[i] + wanted[i] - self.friction_ns[i]);
        (self.normal_ns, self.friction_ns) = (normal_ns, wanted);
        for (p, w) in self.place.iter().zip(self.weight) {
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

/// Finds the impulses and the final velocities.
pub fn solve(rows: &mut [Row], nodes: &mut [Moving], friction: f64, rigid: &mut RigidSurfaces) -> Work {
    let mut work = Work::default();
    let mut struck = vec![[0.0; 3]; nodes.len()];
    let mut largest: f64 = 0.0;
    for sweep in 0..SWEEPS {
        let mut change: f64 = 0.0;
        for row in rows.iter_mut() {
            change = change.max(row.relax(friction, nodes));
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
    for row in rows.iter() {
        let middle = row.relative(Moving::middle, nodes);
        work.body_j[0] += row.normal_ns * dot(row.normal, middle);
        work.body_j[1] += dot(row.friction_ns, middle);
        for (p, w) in row.place.iter().zip(row.weight) {
            let node = &nodes[*p as usize];
            let middle = node.middle();
            for i in (0..3).filter(|i| node.ability[*i] == 0.0) {
                work.held_j -= w * (row.normal_ns * row.normal[i] + row.friction_ns[i]) * middle[i];
            }
        }
    }
    work
}
