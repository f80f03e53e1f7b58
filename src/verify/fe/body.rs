//! What the cases do with a body: deform it, set it spinning, watch it.

use crate::fe::dynamics::Dynamics;
use crate::fe::kernel::KernelStep;
use crate::fe::mesh::Mesh;

/// Moves every node to `to(node)` \[m\] in one increment without inertia or viscosity, and sums the element forces.
pub fn deform(body: &mut Dynamics, to: impl Fn(usize) -> [f64; 3]) {
    for n in 0..body.x.len() {
        let new = to(n);
        body.v[n] = std::array::from_fn(|i| new[i] - body.x[n][i]);
        body.x[n] = new;
    }
    body.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 1.0);
}

/// Work stored and dissipated in the elements \[J\].
pub fn stored_j(body: &Dynamics) -> f64 {
    body.blocks.energies_j().iter().sum()
}

/// What is missing in the energy balance \[J\], given the kinetic energies now and at the start.
pub fn missing_j(body: &Dynamics, kinetic_j: f64, start_j: f64) -> f64 {
    let supplied = body.gravity_j + body.contact_j[0] + body.contact_j[1] + body.driven_j;
    kinetic_j + stored_j(body) - start_j - supplied
}

/// Linear momentum \[kg m/s\] and angular momentum about the origin \[kg m²/s\].
pub fn momenta(body: &Dynamics) -> [[f64; 3]; 2] {
    let mut sums = [[0.0; 3]; 2];
    for ((x, v), m) in body.x.iter().zip(&body.v).zip(&body.mass_kg) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sums[0][i] += m * v[i];
            sums[1][i] += m * (x[j] * v[k] - x[k] * v[j]);
        }
    }
    sums
}

/// Adds a rigid motion: a drift \[m/s\] and a spin about the origin \[rad/s\].
pub fn add_motion(body: &mut Dynamics, drift: [f64; 3], spin: [f64; 3]) {
    for (v, x) in body.v.iter_mut().zip(&body.x) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            v[i] += drift[i] + spin[j] * x[k] - spin[k] * x[j];
        }
    }
}

/// Largest norm of a difference over the norm of the first.
pub fn change(from: [f64; 3], to: [f64; 3]) -> f64 {
    let norm = |a: [f64; 3]| a.iter().map(|c| c * c).sum::<f64>().sqrt();
    norm(std::array::from_fn(|i| to[i] - from[i])) / norm(from)
}

/// Fixes the time step \[s\]: the share of the stability limit is set so that the solver has no reason to change it.
pub fn fix_step(body: &mut Dynamics, dt_s: f64) {
    body.step_safety *= 1.02 * dt_s / body.allowed_step_s();
    body.dt_s = dt_s;
}

/// Mass centre \[m\].
pub fn center(body: &Dynamics) -> [f64; 3] {
    let mass: f64 = body.mass_kg.iter().sum();
    std::array::from_fn(|i| body.x.iter().zip(&body.mass_kg).map(|(x, m)| m * x[i]).sum::<f64>() / mass)
}

/// Nodes by their position in the undeformed mesh.
pub fn nodes_where(mesh: &Mesh, chosen: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
    (0..mesh.nodes.len()).filter(|n| chosen(mesh.nodes[*n])).collect()
}

/// Times at which a history crosses a level, by linear interpolation.
#[derive(Debug, Default)]
pub struct Crossings {
    last: Option<(f64, f64)>,
    /// The times \[s\].
    pub times_s: Vec<f64>,
}

impl Crossings {
    /// The next value of the history less the level; a value of exactly zero counts as not yet crossed.
    pub fn see(&mut self, time_s: f64, value: f64) {
        if value == 0.0 {
            return;
        }
        if let Some((t, v)) = self.last
            && v * value < 0.0
        {
            self.times_s.push(t + (time_s - t) * v / (v - value));
        }
        self.last = Some((time_s, value));
    }

    /// Frequency \[1/s\] from the first crossing to the last, two crossings a period.
    pub fn frequency_1_s(&self) -> Result<f64, String> {
        match self.times_s[..] {
            [first, .., last] => Ok(0.5 * (self.times_s.len() - 1) as f64 / (last - first)),
            _ => Err("the motion has no two crossings".into()),
        }
    }
}

/// Keeps a case from running on with a broken state.
pub fn sound(body: &Dynamics) -> Result<(), String> {
    match body.broken_node() {
        Some(node) => Err(format!("node {node} is nowhere at t = {:.6} s", body.time_s)),
        None => Ok(()),
    }
}
