//! Explicit time integration: central differences with a bound of the critical time step.
//!
//! `v_{n+1/2} = v_{n-1/2} + Δt a_n`, `x_{n+1} = x_n + Δt v_{n+1/2}` (Belytschko, Liu, Moran, Nonlinear Finite
//! Elements for Continua and Structures, section 6.2). Stable for `Δt <= 2/ω_max`; bulk viscosity of damping
//! ratio ξ lowers the limit by `sqrt(1 + ξ²) - ξ`.

use super::blocks::{Block, Blocks};
use super::contact::RigidSurfaces;
use super::kernel::{BULK_LINEAR, BlockForce, KernelStep, LANES, update_block};
use super::mesh::Mesh;
use rayon::prelude::*;

/// Share of the stability limit that is used. The element bound is rigorous at the current configuration; the rest
/// covers the change of geometry within a step.
pub const STEP_SAFETY: f64 = 0.9;
/// An element whose own critical step falls below this share of the first step is eroded: it has collapsed.
pub const STEP_COLLAPSE: f64 = 0.1;
/// Blocks or nodes handed to a thread at a time.
const CHUNK: usize = 64;

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
    /// Gravity \[m/s²\], acting along -z.
    pub gravity_m_s2: f64,
    /// Mass-proportional damping \[1/s\], zero except for dynamic relaxation and quasi-static loading.
    pub damping_1_s: f64,
    /// Time \[s\].
    pub time_s: f64,
    /// Time step \[s\].
    pub dt_s: f64,
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
            gravity_m_s2,
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
            parallel: parallel && mesh.elements.len() > 8 * CHUNK,
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
        let (x, v, tables) = (&self.x, &self.v, &self.blocks.tables);
        let one = |block: &mut Block| {
            if block.state.share.iter().all(|s| *s == 0.0) {
                return;
            }
            let (mut at, mut du): (BlockForce, BlockForce) = ([[0.0; LANES]; 24], [[0.0; LANES]; 24]);
            let acts = |lane: usize| block.state.share[lane] > 0.0;
            let stand_in = (0..LANES).find(|l| acts(*l)).unwrap_or(0);
            for lane in 0..LANES {
                // a dead lane takes the place of a live one, at rest: its own nodes may be anywhere
                let (nodes, dt) = if acts(lane) { (&block.nodes[lane], dt_s) } else { (&block.nodes[stand_in], 0.0) };
                for (local, n) in nodes.iter().enumerate() {
                    let (p, w) = (x[*n as usize], v[*n as usize]);
                    for i in 0..3 {
                        at[3 * local + i][lane] = p[i];
                        du[3 * local + i][lane] = w[i] * dt;
                    }
                }
            }
            let table = &tables[block.material.table];
            block.bound = update_block(&at, &du, &block.material, table, &mut block.state, &mut block.force, step);
        };
        if self.parallel {
            self.blocks.blocks.par_chunks_mut(CHUNK).for_each(|chunk| chunk.iter_mut().for_each(one));
        } else {
            self.blocks.blocks.iter_mut().for_each(one);
        }
    }

    /// The time step that the acting elements allow \[s\].
    pub fn allowed_step_s(&self) -> f64 {
        let mut largest: f64 = 0.0;
        for block in &self.blocks.blocks {
            for lane in 0..block.elements.len() {
                if block.state.share[lane] > 0.0 {
                    largest = largest.max(block.bound[lane]);
                }
            }
        }
        let viscous = (1.0 + BULK_LINEAR * BULK_LINEAR).sqrt() - BULK_LINEAR;
        if largest > 0.0 { STEP_SAFETY * viscous * 2.0 / largest.sqrt() } else { self.dt_s }
    }

    /// One step. Returns the kinetic energy at the full step \[J\] if `measure`.
    pub fn step(&mut self, measure: bool) -> f64 {
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
        for (x, v) in self.x.iter_mut().zip(&self.v) {
            for i in 0..3 {
                x[i] += dt * v[i];
            }
        }
    }

    /// Takes away elements past their critical strain, collapsed ones and ones that went wrong.
    fn erode(&mut self) {
        self.deaths.clear();
        let limit = (2.0 / (STEP_COLLAPSE * self.first_dt_s)).powi(2);
        for block in &mut self.blocks.blocks {
            for lane in 0..block.elements.len() {
                if block.state.share[lane] == 0.0 {
                    continue;
                }
                let healthy = block.bound[lane] > 0.0 && block.bound[lane] <= limit;
                let eroded = block.state.plastic_strain[lane] >= block.material.critical_strain[lane];
                if healthy && !eroded {
                    continue;
                }
                block.state.share[lane] = 0.0;
                block.force.iter_mut().for_each(|f| f[lane] = 0.0);
                self.deaths.push((block.elements[lane], if eroded { Death::Eroded } else { Death::Collapsed }));
            }
        }
    }

    /// New velocities from all forces, with contact; books the work of contact and drives.
    fn accelerate(&mut self, dt: f64, measure: bool) -> f64 {
        self.refresh_internal_forces();
        let mut kinetic = 0.0;
        for n in 0..self.x.len() {
            let mass = self.mass_kg[n];
            if mass == 0.0 {
                self.v[n] = [0.0; 3];
                continue;
            }
            let old = self.v[n];
            let weight = [0.0, 0.0, -mass * self.gravity_m_s2];
            let mut new: [f64; 3] = std::array::from_fn(|i| {
                let force = self.applied_n[n][i] + weight[i] - self.internal_n[n][i] - self.damping_1_s * mass * old[i];
                old[i] + dt * force / mass
            });
            let drive = &self.prescribed_m_s[n];
            if drive.iter().all(Option::is_none) {
                let work = self.surfaces.resolve(n, mass, dt, self.x[n], &old, &mut new);
                self.contact_j[0] += work[0];
                self.contact_j[1] += work[1];
            } else {
                for i in 0..3 {
                    new[i] = drive[i].unwrap_or(new[i]);
                }
            }
            if measure {
                kinetic += (0..3).map(|i| 0.125 * mass * (old[i] + new[i]).powi(2)).sum::<f64>();
            }
            let middle: [f64; 3] = std::array::from_fn(|i| 0.5 * (old[i] + new[i]) * dt);
            self.gravity_j += weight[2] * middle[2];
            self.v[n] = new;
        }
        kinetic
    }

    /// Sums the element forces of the last kernel call at the nodes.
    pub fn refresh_internal_forces(&mut self) {
        let blocks = &self.blocks;
        if self.parallel {
            self.internal_n
                .par_chunks_mut(8 * CHUNK)
                .enumerate()
                .for_each(|(c, chunk)| chunk.iter_mut().enumerate().for_each(|(i, f)| *f = blocks.force_on(8 * CHUNK * c + i)));
        } else {
            self.internal_n.iter_mut().enumerate().for_each(|(n, f)| *f = blocks.force_on(n));
        }
    }

    /// Forgets the last forces of elements that no longer act (blocks that are skipped keep theirs).
    pub fn clear_forces_of_dead(&mut self) {
        for block in &mut self.blocks.blocks {
            for lane in 0..LANES {
                if block.state.share[lane] == 0.0 {
                    block.force.iter_mut().for_each(|f| f[lane] = 0.0);
                }
            }
        }
    }

    /// Kinetic energy of the half-step velocities \[J\].
    pub fn kinetic_j(&self) -> f64 {
        self.v.iter().zip(&self.mass_kg).map(|(v, m)| 0.5 * m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2])).sum()
    }

    /// First node with a position or velocity that is not a number.
    pub fn broken_node(&self) -> Option<usize> {
        (0..self.x.len()).find(|n| self.x[*n].iter().chain(&self.v[*n]).any(|c| !c.is_finite()))
    }
}
