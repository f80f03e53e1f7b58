//! Explicit time integration: central differences with a bound of the critical time step.
//!
//! `v_{n+1/2} = v_{n-1/2} + Δt a_n`, `x_{n+1} = x_n + Δt v_{n+1/2}` (Belytschko, Liu, Moran, Nonlinear Finite
//! Elements for Continua and Structures, section 6.2). Stable for `Δt <= 2/ω_max`; bulk viscosity of damping
//! ratio ξ lowers the limit by `sqrt(1 + ξ²) - ξ`.

use super::blocks::Blocks;
use super::contact::RigidSurfaces;
use super::kernel::{BULK_LINEAR, KernelStep};
use super::mesh::Mesh;
use rayon::prelude::*;

/// Share of the stability limit that is used. The element bound is rigorous at the current configuration; the rest
/// covers the change of geometry within a step.
pub const STEP_SAFETY: f64 = 0.9;
/// An element whose own critical step falls below this share of the first step is eroded: it has collapsed.
pub const STEP_COLLAPSE: f64 = 0.1;
/// Nodes handed to a thread at a time. Sums over nodes are sums over the sums of chunks, on any number of threads.
const CHUNK: usize = 256;
/// Elements from which threads are used.
const PARALLEL_ELEMENTS: usize = 512;

/// What ended an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Death {
    /// Its plastic strain reached the critical value.
    Eroded,
    /// Its critical time step collapsed or its volume was lost.
    Collapsed,
    /// It was removed by an event.
    Removed,
}

/// The state of an explicit run.
#[derive(Debug, Clone)]
pub struct Dynamics {
    /// Elements.
    pub blocks: Blocks,
    /// Current positions \[m\].
    pub x: Vec<[f64; 3]>,
    /// Velocities at the half step \[m/s\].
    pub v: Vec<[f64; 3]>,
    /// Nodal masses \[kg\]; zero once all elements of a node were removed by events.
    pub mass_kg: Vec<f64>,
    /// Constant applied nodal forces besides gravity \[N\].
    pub applied_n: Vec<[f64; 3]>,
    /// Prescribed velocities: `Some(v)` overrides the motion of that component.
    pub prescribed_m_s: Vec<[Option<f64>; 3]>,
    /// Forces on nodes in this step from all that is not a hexahedron or a rigid surface (bars, contact of the body with itself)
    /// \[N\]; empty if there is nothing of the kind. Whoever adds to it books the work.
    pub other_n: Vec<[f64; 3]>,
    /// Acceleration of all mass \[m/s²\]: gravity.
    pub acceleration_m_s2: [f64; 3],
    /// Mass-proportional damping \[1/s\], zero except for dynamic relaxation and quasi-static loading.
    pub damping_1_s: f64,
    /// Time \[s\].
    pub time_s: f64,
    /// Time step \[s\].
    pub dt_s: f64,
    /// Share of the stability limit that is used.
    pub step_safety: f64,
    /// First time step \[s\].
    pub first_dt_s: f64,
    /// Steps done.
    pub steps: u64,
    /// Rigid ground and obstacles.
    pub surfaces: RigidSurfaces,
    /// Work of contact normal forces and of friction on the body \[J\].
    pub contact_j: [f64; 2],
    /// Work of applied forces, prescribed motion and damping \[J\].
    pub driven_j: f64,
    /// Work of gravity, kept over events that change masses \[J\].
    pub gravity_j: f64,
    /// Elements that died in the last step.
    pub deaths: Vec<(usize, Death)>,
    /// Internal force of the last step \[N\].
    pub internal_n: Vec<[f64; 3]>,
    parallel: bool,
}

impl Dynamics {
    /// A body at rest in the mesh's positions. `parallel`: use the current rayon pool.
    pub fn new(mesh: &Mesh, gravity_m_s2: f64, surfaces: RigidSurfaces, parallel: bool) -> Self {
        let blocks = Blocks::of(mesh);
        let n = mesh.nodes.len();
        let mut prescribed_m_s = vec![[None; 3]; n];
        for node in &mesh.fixed {
            prescribed_m_s[*node] = [Some(0.0); 3];
        }
        let mut this = Self {
            x: mesh.nodes.clone(),
            v: vec![[0.0; 3]; n],
            mass_kg: vec![0.0; n],
            applied_n: vec![[0.0; 3]; n],
            prescribed_m_s,
            other_n: Vec::new(),
            acceleration_m_s2: [0.0, 0.0, -gravity_m_s2],
            step_safety: STEP_SAFETY,
            damping_1_s: 0.0,
            time_s: 0.0,
            dt_s: 1.0,
            first_dt_s: 0.0,
            steps: 0,
            surfaces,
            contact_j: [0.0; 2],
            driven_j: 0.0,
            gravity_j: 0.0,
            deaths: Vec::new(),
            internal_n: vec![[0.0; 3]; n],
            blocks,
            parallel: parallel && mesh.elements.len() >= PARALLEL_ELEMENTS,
        };
        this.surfaces.resize(n);
        this.assemble_mass(mesh, |_| true);
        this.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 0.0);
        this.dt_s = this.allowed_step_s();
        this.first_dt_s = this.dt_s;
        this
    }

    /// Lumps the masses of the elements that `counts`.
    pub fn assemble_mass(&mut self, mesh: &Mesh, counts: impl Fn(usize) -> bool) {
        self.mass_kg.iter_mut().for_each(|m| *m = 0.0);
        for (index, element) in mesh.elements.iter().enumerate().filter(|(i, _)| counts(*i)) {
            let share = self.blocks.mass_kg(index) / 8.0;
            for n in element.nodes {
                self.mass_kg[n] += share;
            }
        }
    }

    /// Kernel over all blocks that still act; `dt` scales velocities to displacement increments.
    pub fn update_elements(&mut self, step: KernelStep, dt_s: f64) {
        self.blocks.update(&self.x, &self.v, dt_s, step, self.parallel);
    }

    /// The time step that the acting elements allow \[s\].
    pub fn allowed_step_s(&self) -> f64 {
        let largest = self.blocks.blocks.iter().map(|b| b.largest_bound).fold(0.0, f64::max);
        let viscous = (1.0 + BULK_LINEAR * BULK_LINEAR).sqrt() - BULK_LINEAR;
        if largest > 0.0 { self.step_safety * viscous * 2.0 / largest.sqrt() } else { self.dt_s }
    }

    /// One step. Returns the kinetic energy at the full step \[J\] if `measure`.
    ///
    /// Threads: called from outside the rayon pool, every step has to wake a worker and be woken by it (tens of
    /// microseconds); a long run should enter the pool once, with `rayon::scope(|_| ...)` around its loop.
    pub fn step(&mut self, measure: bool) -> f64 {
        if self.parallel && rayon::current_thread_index().is_none() {
            rayon::scope(|_| self.step_here(measure))
        } else {
            self.step_here(measure)
        }
    }

    fn step_here(&mut self, measure: bool) -> f64 {
        let dt = self.dt_s;
        self.move_nodes(dt);
        self.update_elements(KernelStep { dt_s: dt, viscous: true }, dt);
        self.time_s += dt;
        self.steps += 1;
        self.erode();
        let kinetic = self.accelerate(dt, measure);
        let allowed = self.allowed_step_s();
        if allowed < dt {
            self.dt_s = 0.98 * allowed;
        } else if allowed > 1.05 * dt {
            self.dt_s = allowed.min(1.05 * dt).min(1.2 * self.first_dt_s);
        }
        kinetic
    }

    fn move_nodes(&mut self, dt: f64) {
        let drift = |(x, v): (&mut [[f64; 3]], &[[f64; 3]])| {
            for (x, v) in x.as_flattened_mut().iter_mut().zip(v.as_flattened()) {
                *x += dt * v;
            }
        };
        if self.parallel {
            self.x.par_chunks_mut(CHUNK).zip(self.v.par_chunks(CHUNK)).for_each(drift);
        } else {
            drift((&mut self.x, &self.v));
        }
    }

    /// Takes away elements past their critical strain, collapsed ones and ones that went wrong.
    fn erode(&mut self) {
        self.deaths.clear();
        let limit = (2.0 / (STEP_COLLAPSE * self.first_dt_s)).powi(2);
        for index in 0..self.blocks.blocks.len() {
            let block = &self.blocks.blocks[index];
            if !block.alarm && block.largest_bound <= limit {
                continue;
            }
            for lane in 0..block.elements.len() {
                let block = &self.blocks.blocks[index];
                if block.state.share[lane] == 0.0 {
                    continue;
                }
                let healthy = block.bound[lane] > 0.0 && block.bound[lane] <= limit;
                let eroded = block.state.plastic_strain[lane] >= block.material.critical_strain[lane];
                if healthy && !eroded {
                    continue;
                }
                self.deaths
                    .push((block.elements[lane], if eroded { Death::Eroded } else { Death::Collapsed }));
                self.blocks.end(index, lane);
            }
        }
    }

    /// New velocities from all forces, with contact; books the work of gravity, contact and drives.
    fn accelerate(&mut self, dt: f64, measure: bool) -> f64 {
        let common = NodeStep {
            dt,
            measure,
            acceleration_m_s2: self.acceleration_m_s2,
            damping_1_s: self.damping_1_s,
            blocks: &self.blocks,
            surfaces: &self.surfaces,
            x: &self.x,
            mass_kg: &self.mass_kg,
            applied_n: &self.applied_n,
            other_n: &self.other_n,
            prescribed_m_s: &self.prescribed_m_s,
        };
        let (v, internal_n) = (&mut self.v, &mut self.internal_n);
        let parts: Vec<NodeSums> = if self.parallel {
            let chunks = v.par_chunks_mut(CHUNK).zip(internal_n.par_chunks_mut(CHUNK)).enumerate();
            chunks.map(|(c, (v, internal_n))| common.chunk(c * CHUNK, v, internal_n)).collect()
        } else {
            let chunks = v.chunks_mut(CHUNK).zip(internal_n.chunks_mut(CHUNK)).enumerate();
            chunks.map(|(c, (v, internal_n))| common.chunk(c * CHUNK, v, internal_n)).collect()
        };
        let mut kinetic = 0.0;
        for part in parts {
            kinetic += part.kinetic_j;
            self.gravity_j += part.gravity_j;
            self.driven_j += part.driven_j;
            for (n, mut new) in part.touching {
                let (mass, old) = (self.mass_kg[n], self.v[n]);
                let work = self.surfaces.resolve(n, mass, dt, self.x[n], &old, &mut new);
                for (given, new) in self.prescribed_m_s[n].iter().zip(&mut new) {
                    *new = given.unwrap_or(*new);
                }
                self.contact_j[0] += work[0];
                self.contact_j[1] += work[1];
                let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (old[i] + new[i]));
                kinetic +=
                    0.5 * mass * (middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]);
                for i in 0..3 {
                    self.gravity_j += mass * self.acceleration_m_s2[i] * middle[i] * dt;
                    self.driven_j +=
                        (self.applied_n[n][i] - self.damping_1_s * mass * old[i]) * middle[i] * dt;
                }
                self.v[n] = new;
            }
        }
        kinetic
    }

    /// Sums the element forces of the last kernel call at the nodes.
    pub fn refresh_internal_forces(&mut self) {
        for (n, force) in self.internal_n.iter_mut().enumerate() {
            *force = self.blocks.force_on(n);
        }
    }

    /// Forgets the last forces of elements that no longer act (blocks that are skipped keep theirs).
    pub fn clear_forces_of_dead(&mut self) {
        self.blocks.clear_forces_of_dead();
    }

    /// Kinetic energy of the half-step velocities \[J\].
    pub fn kinetic_j(&self) -> f64 {
        self.v
            .iter()
            .zip(&self.mass_kg)
            .map(|(v, m)| 0.5 * m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]))
            .sum()
    }

    /// First node with a position or velocity that is not a number.
    pub fn broken_node(&self) -> Option<usize> {
        (0..self.x.len()).find(|n| self.x[*n].iter().chain(&self.v[*n]).any(|c| !c.is_finite()))
    }
}

/// What the update of nodal velocities reads.
struct NodeStep<'a> {
    dt: f64,
    measure: bool,
    acceleration_m_s2: [f64; 3],
    damping_1_s: f64,
    blocks: &'a Blocks,
    surfaces: &'a RigidSurfaces,
    x: &'a [[f64; 3]],
    mass_kg: &'a [f64],
    applied_n: &'a [[f64; 3]],
    other_n: &'a [[f64; 3]],
    prescribed_m_s: &'a [[Option<f64>; 3]],
}

/// What it leaves besides velocities.
#[derive(Default)]
struct NodeSums {
    gravity_j: f64,
    driven_j: f64,
    kinetic_j: f64,
    /// Nodes that reach a surface, with their trial velocities: not yet updated, nor in the sums.
    touching: Vec<(usize, [f64; 3])>,
}

impl NodeStep<'_> {
    /// Nodes `first..`, whose velocities and internal forces are given.
    fn chunk(&self, first: usize, v: &mut [[f64; 3]], internal_n: &mut [[f64; 3]]) -> NodeSums {
        let mut sums = NodeSums::default();
        for (i, (v, internal_n)) in v.iter_mut().zip(internal_n).enumerate() {
            let n = first + i;
            *internal_n = self.blocks.force_on(n);
            let mass = self.mass_kg[n];
            if mass == 0.0 {
                *v = [0.0; 3];
                continue;
            }
            let weight = self.acceleration_m_s2.map(|a| mass * a);
            let per_force = self.dt / mass;
            let (mut driven, mut force, mut new) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for i in 0..3 {
                driven[i] = self.applied_n[n][i] - self.damping_1_s * mass * v[i];
                force[i] = driven[i] + weight[i] - internal_n[i];
                if let Some(other) = self.other_n.get(n) {
                    force[i] += other[i];
                }
                new[i] = v[i] + per_force * force[i];
            }
            let drive = &self.prescribed_m_s[n];
            if drive.iter().any(Option::is_some) {
                for i in 0..3 {
                    if let Some(given) = drive[i] {
                        driven[i] += mass / self.dt * (given - new[i]);
                        new[i] = given;
                    }
                }
            }
            if !drive.iter().all(Option::is_some) && self.surfaces.reached(self.dt, &self.x[n], &new) {
                sums.touching.push((n, new));
                continue;
            }
            let mut middle = [0.0; 3];
            for i in 0..3 {
                middle[i] = 0.5 * (v[i] + new[i]);
                sums.driven_j += driven[i] * middle[i] * self.dt;
                sums.gravity_j += weight[i] * middle[i] * self.dt;
            }
            if self.measure {
                sums.kinetic_j +=
                    0.5 * mass * (middle[0] * middle[0] + middle[1] * middle[1] + middle[2] * middle[2]);
            }
            *v = new;
        }
        sums
    }
}
