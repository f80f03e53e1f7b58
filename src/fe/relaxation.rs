//! The static dead-load state by dynamic relaxation: for structures that yield under dead load, where the sparse solve with the elastic
//! stiffness stops, and for meshes too large to factorise.
//!
//! The body moves with pseudo-masses under its load until it rests (Underwood, Dynamic relaxation, in Belytschko and Hughes (eds.),
//! Computational Methods for Transient Analysis, 1983; Barnes, Form-finding and analysis of tension structures by dynamic relaxation,
//! Int. J. Space Structures 14 (1999) 89-104):
//! * **pseudo-masses** make a step of 1 stable for every element: an element whose stiffness has the largest eigenvalue `k` puts
//!   `k / (4 s²)` on each of its nodes, so that `ω_max <= 2 s` by the eigenvalue inequality of Irons and Treharne;
//! * **kinetic damping**: the motion is free until its kinetic energy passes a peak, and starts anew from rest there. At the peak of a mode its
//!   forces balance, so that the motion stops where viscous damping would have to be just critical, and there is no parameter to guess;
//! * **ramp**: the load grows by [`RAMP_STEP`] whenever the forces out of balance have fallen to [`RAMP_RESIDUAL`]. The body never
//!   bears much more than the load reached, and plastic strains follow a rising load.
//!
//! The measure of convergence is `Σ |r| / Σ |f|` over all free components: forces out of balance over full load. It does not depend on the mesh.

use super::dynamics::Dynamics;
use super::kernel::KernelStep;
use super::mesh::Mesh;
use super::preload::{self, PreloadError};
use serde::{Deserialize, Serialize};

/// Forces out of balance over full load at which the state counts as equilibrium.
pub const RESIDUAL: f64 = 1e-6;
/// Step of the load on the ramp.
pub const RAMP_STEP: f64 = 0.05;
/// Forces out of balance over full load at which the load grows.
pub const RAMP_RESIDUAL: f64 = 0.05;
/// Cycles, at most.
pub const CYCLES: usize = 200_000;
/// Displacement over the diagonal of the body at which it counts as collapsing.
pub const COLLAPSE_SHARE: f64 = 0.03;
/// Share of the limit of stability at which the pseudo-masses put the step: room for changes of geometry.
const SAFETY: f64 = 0.9;
/// Cycles between two looks at the displacements.
const LOOK: usize = 50;
/// Unknowns beyond which the sparse factor is not tried (its memory grows with the power 4/3 of the number).
pub const SPARSE_UNKNOWNS: usize = 1_000_000;

/// Limits of a relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Forces out of balance over full load.
    pub residual: f64,
    /// Cycles, at most.
    pub cycles: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { residual: RESIDUAL, cycles: CYCLES }
    }
}

/// A state at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Relaxed {
    /// Cycles done: one kernel call each.
    pub cycles: usize,
    /// Forces out of balance over full load.
    pub residual: f64,
    /// Elements with plastic strain.
    pub yielded: usize,
    /// Largest displacement \[m\].
    pub displacement_m: f64,
}

/// A body that does not come to rest.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RelaxationError {
    /// It moves without resistance.
    #[error(
        "the structure is a mechanism: part `{part}` moves by {displacement_m:.2} m at {percent:.0} % of the dead load and nothing yields; check supports and connections"
    )]
    Mechanism {
        /// Part that moves most.
        part: String,
        /// Its displacement \[m\].
        displacement_m: f64,
        /// Load reached \[%\].
        percent: f64,
    },
    /// It is too weak.
    #[error(
        "collapse under dead load: at {percent:.0} % of it the structure yields and does not come to rest; part `{part}` has moved {displacement_m:.2} m, {yielded} elements yield, most of them in `{weakest}` (plastic strain up to {strain:.3}); check yield stress, weakening and loads"
    )]
    Collapse {
        /// Part that moves most.
        part: String,
        /// Its displacement \[m\].
        displacement_m: f64,
        /// Load reached \[%\].
        percent: f64,
        /// Elements with plastic strain.
        yielded: usize,
        /// Part with the most of them.
        weakest: String,
        /// Largest plastic strain.
        strain: f64,
    },
    /// Too slow.
    #[error(
        "no dead-load state after {cycles} cycles of relaxation: forces out of balance are {residual:.1e} of the load, {yielded} elements yield; the structure is close to its limit, or creeps"
    )]
    Unfinished {
        /// Cycles done.
        cycles: usize,
        /// Forces out of balance over full load.
        residual: f64,
        /// Elements with plastic strain.
        yielded: usize,
    },
    /// Not a number.
    #[error("the relaxation diverges at node {node} of part `{part}`; check the element shapes there")]
    Diverges {
        /// Node index.
        node: usize,
        /// Part of an element at the node.
        part: String,
    },
}

/// How the static state was found.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct StaticState {
    /// Iterations of the sparse solve; 0 if it was not used.
    pub iterations: usize,
    /// The relaxation, if it was needed.
    pub relaxed: Option<Relaxed>,
}

/// Brings a body from rest into static equilibrium: by the sparse solve; from the start again by relaxation where that finds none, or where the
/// body has more than [`SPARSE_UNKNOWNS`] unknowns.
pub fn static_state(mesh: &Mesh, body: &mut Dynamics) -> Result<StaticState, String> {
    if 3 * mesh.nodes.len() <= SPARSE_UNKNOWNS {
        let (start, bars) = (body.x.clone(), body.trusses.clone());
        match preload::solve(body) {
            Ok(iterations) => return Ok(StaticState { iterations, relaxed: None }),
            Err(PreloadError::NoEquilibrium | PreloadError::Diverges) => {
                body.blocks.unload();
                (body.x, body.trusses) = (start, bars);
            }
            Err(other) => return Err(other.to_string()),
        }
    }
    let relaxed = relax(mesh, body, Limits::default()).map_err(|e| e.to_string())?;
    Ok(StaticState { iterations: 0, relaxed: Some(relaxed) })
}

/// Brings a body from rest into static equilibrium under gravity and applied forces by dynamic relaxation. Like in the sparse solve, rigid surfaces and
/// forces besides those of the hexahedra do not act. On error the body is left where it had got.
pub fn relax(mesh: &Mesh, body: &mut Dynamics, limits: Limits) -> Result<Relaxed, RelaxationError> {
    let start = body.x.clone();
    let diagonal = diagonal_m(&start);
    body.v.iter_mut().for_each(|v| *v = [0.0; 3]);
    body.update_elements(STATIC, 0.0);
    let mass = pseudo_mass(body);
    let full = Load::of(body, &mass);
    let (mut load, mut kinetic, mut cycles) = (RAMP_STEP, 0.0, 0);
    let mut fresh = true; // the motion starts from rest: half a step
    loop {
        let inner_n = inner_forces(body);
        let residual = full.residual(&inner_n, load);
        if load < 1.0 && residual <= RAMP_RESIDUAL {
            load = (load + RAMP_STEP).min(1.0);
            continue;
        }
        if load >= 1.0 && residual <= limits.residual {
            body.v.iter_mut().for_each(|v| *v = [0.0; 3]);
            let (displacement_m, _) = largest_move(&start, &body.x);
            return Ok(Relaxed { cycles, residual, yielded: yielded(body).len(), displacement_m });
        }
        if cycles.is_multiple_of(LOOK) {
            still_standing(mesh, body, &start, COLLAPSE_SHARE * diagonal, load)?;
        }
        if cycles >= limits.cycles {
            return Err(RelaxationError::Unfinished { cycles, residual, yielded: yielded(body).len() });
        }
        let now = full.accelerate(body, &inner_n, &mass, load, if fresh { 0.5 } else { 1.0 });
        body.follow_ties();
        if now < kinetic {
            body.v.iter_mut().for_each(|v| *v = [0.0; 3]);
            (kinetic, fresh) = (0.0, true);
            continue;
        }
        (kinetic, fresh) = (now, false);
        for (x, v) in body.x.as_flattened_mut().iter_mut().zip(body.v.as_flattened()) {
            *x += v;
        }
        body.update_elements(STATIC, 1.0);
        cycles += 1;
    }
}

const STATIC: KernelStep = KernelStep { dt_s: 1.0, viscous: false };

/// Pseudo-masses for a step of 1 \[N/m\].
fn pseudo_mass(body: &Dynamics) -> Vec<f64> {
    let mut mass = vec![0.0; body.x.len()];
    let bounds = body.blocks.element_bounds_1_s2(&body.x);
    for (e, bound) in bounds.into_iter().enumerate() {
        let stiffness_n_m = bound * body.blocks.mass_kg(e) / 8.0;
        for n in body.blocks.nodes_of(e) {
            mass[n] += body.blocks.share(e) * stiffness_n_m / (4.0 * SAFETY * SAFETY);
        }
    }
    for ([a, b], stiffness) in body.trusses.stiffnesses(&body.x) {
        let stiffness_n_m = 2.0 * (stiffness[0][0] + stiffness[1][1] + stiffness[2][2]);
        mass[a] += stiffness_n_m / (4.0 * SAFETY * SAFETY);
        mass[b] += stiffness_n_m / (4.0 * SAFETY * SAFETY);
    }
    for n in 0..mass.len() {
        if body.ties.is_tied(n) {
            let given = std::mem::take(&mut mass[n]);
            body.ties.carriers(n).into_iter().for_each(|(m, w)| mass[m] += w * given);
        }
    }
    mass
}

/// Forces of all elements on each node, with those on the nodes tied to it \[N\].
fn inner_forces(body: &Dynamics) -> Vec<[f64; 3]> {
    let own = |n: usize| -> [f64; 3] {
        let (inner, bars) = (body.internal_n(n), body.other_n.get(n).copied().unwrap_or_default());
        std::array::from_fn(|i| inner[i] - bars[i])
    };
    let with_tied = |n: usize| {
        body.ties.carried_by(n).iter().fold(own(n), |sum, (tied, share)| {
            let more = own(*tied as usize);
            std::array::from_fn(|i| sum[i] + share * more[i])
        })
    };
    (0..body.x.len()).map(with_tied).collect()
}

/// The full load.
struct Load {
    /// By node, zero where held or without stiffness \[N\].
    force_n: Vec<[f64; 3]>,
    /// Whether a component can move.
    free: Vec<[bool; 3]>,
    /// Sum of absolute values \[N\].
    sum_n: f64,
}

impl Load {
    fn of(body: &Dynamics, mass: &[f64]) -> Self {
        let free: Vec<[bool; 3]> = (0..body.x.len())
            .map(|n| body.prescribed_m_s[n].map(|given| given.is_none() && mass[n] > 0.0))
            .collect();
        let force_n: Vec<[f64; 3]> = (0..body.x.len())
            .map(|n| {
                std::array::from_fn(|i| {
                    let force = body.applied_n[n][i] + body.mass_kg[n] * body.acceleration_m_s2[i];
                    if free[n][i] { force } else { 0.0 }
                })
            })
            .collect();
        let sum_n = force_n.as_flattened().iter().map(|f| f.abs()).sum::<f64>().max(f64::MIN_POSITIVE);
        Self { force_n, free, sum_n }
    }

    /// Forces out of balance under a share of the load, over the full load.
    fn residual(&self, inner_n: &[[f64; 3]], load: f64) -> f64 {
        let mut sum = 0.0;
        for ((force, free), inner) in self.force_n.iter().zip(&self.free).zip(inner_n) {
            for i in 0..3 {
                sum += if free[i] { (load * force[i] - inner[i]).abs() } else { 0.0 };
            }
        }
        sum / self.sum_n
    }

    /// New pseudo-velocities; returns twice the kinetic energy.
    fn accelerate(
        &self,
        body: &mut Dynamics,
        inner_n: &[[f64; 3]],
        mass: &[f64],
        load: f64,
        step: f64,
    ) -> f64 {
        let mut kinetic = 0.0;
        for (n, v) in body.v.iter_mut().enumerate() {
            for i in 0..3 {
                if self.free[n][i] {
                    v[i] += step * (load * self.force_n[n][i] - inner_n[n][i]) / mass[n];
                    kinetic += mass[n] * v[i] * v[i];
                }
            }
        }
        kinetic
    }
}

fn diagonal_m(x: &[[f64; 3]]) -> f64 {
    let extent = |i: usize| {
        let (low, high) =
            x.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), p| (l.min(p[i]), h.max(p[i])));
        high - low
    };
    (0..3).map(|i| extent(i).powi(2)).sum::<f64>().sqrt()
}

/// Largest displacement \[m\] with its node.
fn largest_move(start: &[[f64; 3]], x: &[[f64; 3]]) -> (f64, usize) {
    let mut largest = (0.0, 0);
    for (n, (a, b)) in start.iter().zip(x).enumerate() {
        let moved = (0..3).map(|i| (b[i] - a[i]).powi(2)).sum::<f64>().sqrt();
        if moved > largest.0 {
            largest = (moved, n);
        }
    }
    largest
}

/// Elements with plastic strain.
fn yielded(body: &Dynamics) -> Vec<usize> {
    let acts = |e: &usize| body.blocks.share(*e) > 0.0 && body.blocks.plastic_strain(*e) > 0.0;
    (0..body.blocks.elements()).filter(acts).collect()
}

/// Says what is wrong with a body that has moved too far, lost an element or is not a number.
fn still_standing(
    mesh: &Mesh,
    body: &Dynamics,
    start: &[[f64; 3]],
    limit_m: f64,
    load: f64,
) -> Result<(), RelaxationError> {
    let part_at = |n: usize| {
        body.blocks
            .elements_at(n)
            .find(|e| body.blocks.share(*e) > 0.0)
            .map_or("?".to_string(), |e| mesh.parts[mesh.elements[e].part].clone())
    };
    if let Some(node) = body.broken_node() {
        return Err(RelaxationError::Diverges { node, part: part_at(node) });
    }
    let (displacement_m, node) = largest_move(start, &body.x);
    let bounds = body.blocks.element_bounds_1_s2(&body.x);
    let failed = (0..bounds.len()).any(|e| {
        let (block, lane) = body.blocks.of_element(e);
        let strained = block.state.plastic_strain[lane] >= block.material.lanes().critical_strain[lane];
        block.state.share[lane] > 0.0 && (strained || bounds[e].is_nan() || bounds[e] <= 0.0)
    });
    if displacement_m <= limit_m && !failed {
        return Ok(());
    }
    let (part, percent) = (part_at(node), 100.0 * load);
    let yielding = yielded(body);
    if yielding.is_empty() {
        return Err(RelaxationError::Mechanism { part, displacement_m, percent });
    }
    let mut of_part = vec![0; mesh.parts.len()];
    yielding.iter().for_each(|e| of_part[mesh.elements[*e].part] += 1);
    let most = (0..of_part.len()).max_by_key(|p| (of_part[*p], usize::MAX - p)).unwrap_or(0);
    Err(RelaxationError::Collapse {
        part,
        displacement_m,
        percent,
        yielded: yielding.len(),
        weakest: mesh.parts[most].clone(),
        strain: yielding.iter().map(|e| body.blocks.plastic_strain(*e)).fold(0.0, f64::max),
    })
}
