//! Explicit time integration: central differences with a bound of the critical time step.
//!
//! A step takes positions at `t_n` and velocities at `t_{n-1/2}`, finds the forces there and does
//! `v_{n+1/2} = v_{n-1/2} + (Δt_{n-1/2} + Δt_{n+1/2}) / 2 a_n`, `x_{n+1} = x_n + Δt_{n+1/2} v_{n+1/2}` (Belytschko, Liu, Moran,
//! Nonlinear Finite Elements for Continua and Structures, section 6.2). Energies are those of `t_n`. Stable for `Δt <= 2/ω_max`; bulk viscosity of damping
//! ratio ξ lowers the limit by `sqrt(1 + ξ²) - ξ`: its linear part here, its quadratic part, under fast compression, in the elements' frequency bounds.

use super::blocks::Blocks;
use super::contact::body::{Moving, Struck, Surroundings};
use super::contact::{BodyContact, RigidSurfaces, TiedStrikes};
use super::erosion::{self, Failure};
use super::hybrid::Hybrid;
use super::hybrid::parts::NONE;
use super::kernel::KernelStep;
use super::limit::BULK_LINEAR;
use super::mesh::Mesh;
use super::node_field::NodeField;
use super::sweep::Sweep;
use super::tie::Ties;
use super::truss::Trusses;
use crate::base::isa::Isa;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Share of the stability limit that is used. The element bound is rigorous at the current configuration; the rest
/// covers the change of geometry within a step, and the quadratic bulk viscosity up to [`super::limit::VISCOUS_SLACK`].
pub const STEP_SAFETY: f64 = 0.9;
/// Share of that with all damping known which is used at most.
const ROUNDING_SAFETY: f64 = 0.99;
/// Nodes handed to a thread at a time. Sums over nodes are sums over the sums of chunks, on any number of threads.
const CHUNK: usize = 512;
/// Elements from which threads are used.
const PARALLEL_ELEMENTS: usize = 512;
/// Deforming elements from which a step with rigid sets uses threads. With fewer the passes that run side by side are short beside what one thread does alone (sets, contact), in which the others spin: that took 1.3 times the
/// processor time of one thread (docs/hybrid.md).
const PARALLEL_DEFORMING: usize = 1024;

/// The time step for a bound of the largest squared frequency \[1/s²\], with bulk viscosity and a share of the stability limit \[s\].
pub fn allowed_step_s(bound_1_s2: f64, safety: f64) -> f64 {
    safety * under_damping(BULK_LINEAR) * 2.0 / bound_1_s2.sqrt()
}

/// Share of the stability limit of a vibration that its damping ratio leaves, velocities lagging by half a step.
fn under_damping(ratio: f64) -> f64 {
    (1.0 + ratio * ratio).sqrt() - ratio
}

/// Largest share of the stability limit at which the bulk viscosity of all elements of a mesh is stable; bars have none. [`allowed_step_s`] takes the damping ratio [`BULK_LINEAR`] of a plane wave into account. The vibration in which a cube
/// breathes is damped by `3 (1 - ν) / (1 + ν)` of that; a mesh of few elements has no higher one, so that below ν = 0.07 not even [`STEP_SAFETY`] is left.
pub fn most_step_safety(mesh: &Mesh) -> f64 {
    let ratio = |nu: f64| 3.0 * BULK_LINEAR * (1.0 - nu) / (1.0 + nu);
    let share = |nu: f64| ROUNDING_SAFETY * under_damping(ratio(nu)) / under_damping(BULK_LINEAR);
    let ratios = mesh.elements.iter().map(|e| mesh.laws[e.law].poisson_ratio);
    ratios.reduce(f64::min).map_or(1.0, |least| share(least).min(1.0))
}

/// What ended an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Death {
    /// Its plastic strain reached the critical value.
    Eroded,
    /// Its critical time step collapsed or its volume was lost.
    Collapsed,
    /// It was removed by an event.
    Removed,
    /// Its largest principal strain reached the critical value.
    Torn,
    /// It reached a critical strain and was detached from its neighbours; it still acts, as debris.
    Split,
}

/// The state of an explicit run. All of it is in checkpoints.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Dynamics {
    /// Elements.
    pub blocks: Blocks,
    /// Two-node bars.
    pub trusses: Trusses,
    /// Current positions \[m\].
    pub x: Vec<[f64; 3]>,
    /// Velocities at the half step \[m/s\].
    pub v: Vec<[f64; 3]>,
    /// Nodal masses \[kg\]; zero once all elements of a node were removed by events.
    pub mass_kg: Vec<f64>,
    /// Constant applied nodal forces besides gravity \[N\].
    pub applied_n: NodeField<[f64; 3]>,
    /// Nodes that follow others.
    pub ties: Ties,
    /// Prescribed velocities: `Some(v)` overrides the motion of that component.
    pub prescribed_m_s: NodeField<[Option<f64>; 3]>,
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
    /// The step that led to the present positions \[s\], zero at the start: the first kick is half a step.
    pub taken_s: f64,
    /// Whether groups of elements whose nodes stand still keep their forces; the same bytes either way.
    pub skip_quiet: bool,
    /// Instruction set of the kernel; without effect on results.
    pub isa: Isa,
    /// Share of the stability limit that is used.
    pub step_safety: f64,
    /// First time step \[s\].
    pub first_dt_s: f64,
    /// Steps done.
    pub steps: u64,
    /// Rigid ground and obstacles.
    pub surfaces: RigidSurfaces,
    /// Contact of the body with itself, if there is any.
    pub body_contact: Option<Box<BodyContact>>,
    /// Tied nodes that may strike a rigid surface.
    tied_strikes: TiedStrikes,
    /// Work of contact normal forces and of friction on the body \[J\].
    pub contact_j: [f64; 2],
    /// Work of applied forces, prescribed motion and damping \[J\].
    pub driven_j: f64,
    /// Work of gravity, kept over events that change masses \[J\].
    pub gravity_j: f64,
    /// Work of gravity and of drives that belongs to the first half of the coming step \[J\]: not in the books yet.
    ahead_j: [f64; 2],
    /// Elements that died in the last step.
    pub deaths: Vec<(usize, Death)>,
    /// When elements fail, and what has failed.
    pub failure: Failure,
    /// Parts that move as rigid bodies, if there may be any.
    pub hybrid: Option<Box<Hybrid>>,
    parallel: bool,
}

impl Dynamics {
    /// A body at rest in the mesh's positions. `parallel`: use the current rayon pool.
    pub fn new(mesh: &Mesh, gravity_m_s2: f64, surfaces: RigidSurfaces, parallel: bool) -> Self {
        let blocks = Blocks::of(mesh);
        let n = mesh.nodes.len();
        let mut prescribed_m_s = NodeField::new([None; 3], n);
        for node in &mesh.fixed {
            prescribed_m_s[*node] = [Some(0.0); 3];
        }
        let mut this = Self {
            x: mesh.nodes.clone(),
            v: vec![[0.0; 3]; n],
            mass_kg: vec![0.0; n],
            applied_n: NodeField::new([0.0; 3], n),
            ties: Ties::of(mesh),
            prescribed_m_s,
            other_n: Vec::new(),
            acceleration_m_s2: [0.0, 0.0, -gravity_m_s2],
            step_safety: STEP_SAFETY.min(most_step_safety(mesh)),
            skip_quiet: false,
            isa: Isa::best(),
            damping_1_s: 0.0,
            time_s: 0.0,
            dt_s: 1.0,
            taken_s: 0.0,
            first_dt_s: 0.0,
            steps: 0,
            surfaces,
            body_contact: None,
            tied_strikes: TiedStrikes::default(),
            contact_j: [0.0; 2],
            driven_j: 0.0,
            gravity_j: 0.0,
            ahead_j: [0.0; 2],
            deaths: Vec::new(),
            failure: Failure::of(mesh),
            hybrid: None,
            blocks,
            trusses: Trusses::of(mesh),
            parallel: false,
        };
        this.use_threads(parallel);
        this.surfaces.begin(&this.x);
        this.assemble_mass(mesh, |_| true);
        this.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 0.0);
        this.dt_s = this.allowed_step_s();
        this.first_dt_s = this.dt_s;
        this
    }

    /// Use the current rayon pool or one thread; the results are the same.
    pub fn use_threads(&mut self, parallel: bool) {
        self.parallel = parallel && self.blocks.elements() >= PARALLEL_ELEMENTS;
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
        self.trusses.add_mass(&mut self.mass_kg);
        self.ties.carry_mass(&mut self.mass_kg);
    }

    /// Gives tied nodes the velocity of their place on their masters.
    pub fn follow_ties(&mut self) {
        self.ties.follow(&mut self.v);
    }

    /// Kernel over all blocks that still act; `dt` scales velocities to displacement increments. No element ends.
    pub fn update_elements(&mut self, step: KernelStep, dt_s: f64) {
        self.find_forces(&Sweep { dt_s, step, drop_above: None, skip_quiet: false, isa: self.isa });
    }

    /// All forces that follow from positions and the last increment.
    fn find_forces(&mut self, sweep: &Sweep) {
        self.blocks.sweep(&self.x, &self.v, sweep, self.parallel);
        if !self.trusses.is_empty() {
            self.other_n.resize(self.x.len(), [0.0; 3]);
            self.other_n.fill([0.0; 3]);
            self.trusses.update(&self.x, sweep.step, sweep.drop_above, &mut self.other_n);
        }
    }

    /// The time step that the acting elements allow \[s\].
    pub fn allowed_step_s(&self) -> f64 {
        let largest =
            self.blocks.blocks.iter().map(|b| b.largest_bound).fold(self.trusses.bound_1_s2, f64::max);
        if largest > 0.0 { self.step_under_bound_s(largest) } else { self.dt_s }
    }

    /// The time step for a bound of the largest squared frequency \[1/s²\], with viscosity and safety \[s\].
    pub fn step_under_bound_s(&self, bound_1_s2: f64) -> f64 {
        allowed_step_s(bound_1_s2, self.step_safety)
    }

    /// Uses another share of the stability limit from the next step on; before the first step it is also the reference of collapsed elements.
    pub fn set_step_safety(&mut self, share: f64) {
        let ratio = share / self.step_safety;
        self.step_safety = share;
        self.dt_s *= ratio;
        self.first_dt_s *= ratio;
    }

    /// Whether so many elements deform that threads are worth waking in a step.
    fn is_worth_threads(&self) -> bool {
        let rigid = self.hybrid.as_ref().map_or(0, |h| h.rigid());
        rigid == 0 || self.blocks.elements() - rigid >= PARALLEL_DEFORMING
    }

    /// One step. Returns the kinetic energy at the full step \[J\] if `measure`.
    ///
    /// Threads: called from outside the rayon pool, every step has to wake a worker and be woken by it (tens of
    /// microseconds); a long run should enter the pool once, with `rayon::scope(|_| ...)` around its loop.
    pub fn step(&mut self, measure: bool) -> f64 {
        if self.parallel && rayon::current_thread_index().is_none() {
            return rayon::scope(|_| self.step(measure));
        }
        let threads = self.parallel;
        self.parallel &= self.is_worth_threads();
        let kinetic_j = self.step_here(measure);
        self.parallel = threads;
        kinetic_j
    }

    fn step_here(&mut self, measure: bool) -> f64 {
        let (before, taken) = (self.dt_s, self.taken_s);
        let sweep = Sweep {
            dt_s: taken,
            step: KernelStep { dt_s: taken, viscous: taken > 0.0 },
            drop_above: Some(self.failure.largest_bound_1_s2(self.first_dt_s)),
            skip_quiet: self.skip_quiet,
            isa: self.isa,
        };
        if self.taken_s == 0.0 {
            self.follow_ties();
        }
        self.find_forces(&sweep);
        erosion::fail(self);
        self.ties.release(&self.blocks, &mut self.mass_kg, &mut self.v);
        let allowed = self.allowed_step_s();
        if allowed < before {
            self.dt_s = 0.98 * allowed;
        } else if allowed > 1.05 * before {
            self.dt_s = allowed.min(1.05 * before).min(self.most_growth() * self.first_dt_s);
        }
        let mut hybrid = self.hybrid.take();
        let frozen = hybrid.as_mut().is_some_and(|h| h.freeze(self));
        self.prepare_contact();
        let kinetic = self.accelerate(0.5 * (taken + self.dt_s), measure, hybrid.as_deref_mut());
        if !self.ties.is_empty() {
            self.follow_ties();
            self.ties.drift(self.dt_s, &self.v, &mut self.x);
        }
        self.time_s += self.dt_s;
        self.taken_s = self.dt_s;
        self.steps += 1;
        if !self.deaths.is_empty() {
            self.blocks.repack_if_worthwhile(&self.x);
        }
        if let Some(hybrid) = &mut hybrid {
            if frozen {
                hybrid.rest(self);
            }
            hybrid.decide(self);
        }
        self.hybrid = hybrid;
        kinetic
    }

    /// How far beyond the first step the step may grow: elements that ask for a short one may be rigid.
    fn most_growth(&self) -> f64 {
        if self.hybrid.as_ref().is_some_and(|h| !h.sets.is_empty()) { 3.0 } else { 1.2 }
    }

    /// Books work of gravity \[J\] up to the full step, and from there to the half step.
    pub(super) fn add_gravity(&mut self, to_full_j: f64, ahead_j: f64) {
        self.gravity_j += to_full_j;
        self.ahead_j[0] += ahead_j;
    }

    /// New velocities from all forces that act for `kick` \[s\], with contact, and new positions; books the work of gravity,
    /// contact and drives.
    fn accelerate(&mut self, kick: f64, measure: bool, mut hybrid: Option<&mut Hybrid>) -> f64 {
        let dt = self.dt_s;
        let common = NodeStep {
            kick,
            dt,
            measure,
            acceleration_m_s2: self.acceleration_m_s2,
            damping_1_s: self.damping_1_s,
            blocks: &self.blocks,
            surfaces: &self.surfaces,
            body_contact: self.body_contact.as_deref(),
            tied_strikes: &self.tied_strikes,
            mass_kg: &self.mass_kg,
            applied_n: &self.applied_n,
            other_n: &self.other_n,
            ties: &self.ties,
            prescribed_m_s: &self.prescribed_m_s,
            set_of: hybrid.as_ref().map_or(&[], |h| &h.set_of),
        };
        let (x, v) = (&mut self.x, &mut self.v);
        let parts: Vec<NodeSums> = if self.parallel {
            let chunks = x.par_chunks_mut(CHUNK).zip(v.par_chunks_mut(CHUNK)).enumerate();
            chunks.map(|(c, (x, v))| common.chunk(c * CHUNK, x, v)).collect()
        } else {
            let chunks = x.chunks_mut(CHUNK).zip(v.chunks_mut(CHUNK)).enumerate();
            chunks.map(|(c, (x, v))| common.chunk(c * CHUNK, x, v)).collect()
        };
        let mut kinetic = 0.0;
        let mut meeting: Vec<(Moving, Pushed)> = Vec::new();
        let mut top_speed_squared: f64 = 0.0;
        let [gravity_before, driven_before] = std::mem::take(&mut self.ahead_j);
        self.gravity_j += gravity_before;
        self.driven_j += driven_before;
        let struck = hybrid.as_mut().map_or(Vec::new(), |h| h.push(self, kick, dt));
        let rigid = NodeSums { touching: struck, ..NodeSums::default() };
        let among_rigid = !rigid.touching.is_empty();
        for part in parts.into_iter().chain(std::iter::once(rigid)) {
            kinetic += part.kinetic_j;
            self.gravity_j += part.gravity_j;
            self.driven_j += part.driven_j;
            self.ahead_j = [self.ahead_j[0] + part.ahead_j[0], self.ahead_j[1] + part.ahead_j[1]];
            top_speed_squared = top_speed_squared.max(part.top_speed_squared);
            for (n, pushed) in part.touching {
                let held = self.prescribed_m_s[n].map(|d| d.is_some());
                let (mass_kg, x, old) = (self.mass_kg[n], self.x[n], self.v[n]);
                let at = Struck { node: n, held, mass_kg, dt_s: dt, x, old };
                let mut node = Moving::new(at, pushed.trial);
                if self.body_contact.as_ref().is_some_and(|c| c.flagged[n]) || self.tied_strikes.flags(n) {
                    meeting.push((node, pushed));
                    continue;
                }
                let work = self.surfaces.resolve(&at, &mut node.new);
                if let Some(contact) = &self.body_contact {
                    top_speed_squared = top_speed_squared.max(contact.speed_squared(&node.new));
                }
                self.contact_j[0] += work[0];
                self.contact_j[1] += work[1];
                if !hybrid.as_mut().is_some_and(|h| h.hit(&node, &pushed.trial)) {
                    kinetic += self.settle(&node, &pushed, kick);
                }
            }
        }
        if among_rigid {
            meeting.sort_by_key(|(node, _)| node.at.node);
        }
        let (mut nodes, pushed): (Vec<_>, Vec<_>) = meeting.into_iter().unzip();
        let mut rows = self.tied_strikes.rows(dt, &nodes, &self.ties);
        let work = match &mut self.body_contact {
            Some(contact) => {
                contact.top_speed_m_s = top_speed_squared.sqrt();
                contact.resolve(dt, &mut nodes, &self.ties, &mut rows, &mut self.surfaces)
            }
            None => rows.solve(&mut nodes, &mut self.surfaces),
        };
        for i in 0..2 {
            self.contact_j[i] += work.body_j[i] + work.rigid_j[i];
        }
        self.driven_j += work.held_j;
        let mut rest = 0.0;
        for (node, pushed) in nodes.iter().zip(pushed) {
            if !hybrid.as_mut().is_some_and(|h| h.hit(node, &pushed.trial)) {
                rest += self.settle(node, &pushed, kick);
            }
        }
        kinetic + rest + hybrid.map_or(0.0, |h| h.finish(self, [kick, dt], measure))
    }

    /// Gives a node its final velocity, moves it and books the work of gravity and drives over the time `kick`; returns its kinetic energy
    /// at the full step.
    fn settle(&mut self, node: &Moving, pushed: &Pushed, kick: f64) -> f64 {
        let (n, mass, dt) = (node.at.node, node.at.mass_kg, node.at.dt_s);
        let weight = self.acceleration_m_s2.map(|a| mass * a);
        let works = pushed.works(&weight, [&node.at.old, &node.new], [kick, dt]);
        self.gravity_j += works[0];
        self.driven_j += works[1];
        self.ahead_j = [self.ahead_j[0] + works[2], self.ahead_j[1] + works[3]];
        for i in 0..3 {
            self.x[n][i] += dt * node.new[i];
        }
        self.v[n] = node.new;
        mass * pushed.kinetic_m2_s2([&node.at.old, &node.new], dt / kick)
    }

    /// Finds the nodes that may meet another part of the body, and tied nodes that may meet a rigid surface.
    fn prepare_contact(&mut self) {
        self.surfaces.follow(&self.x);
        self.tied_strikes.prepare(&self.ties, &self.surfaces, [&self.x, &self.v], self.dt_s);
        if let Some(contact) = &mut self.body_contact {
            let now = Surroundings {
                x: &self.x,
                v: &self.v,
                mass_kg: &self.mass_kg,
                ties: &self.ties,
                dt_s: self.taken_s,
                parallel: self.parallel,
            };
            contact.prepare(now, &self.deaths);
        }
    }

    /// Internal force on a node in the last pass of the kernel \[N\].
    pub fn internal_n(&self, node: usize) -> [f64; 3] {
        self.blocks.force_on(node)
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
    /// Time for which the forces act, and the step after it.
    kick: f64,
    dt: f64,
    measure: bool,
    acceleration_m_s2: [f64; 3],
    damping_1_s: f64,
    blocks: &'a Blocks,
    surfaces: &'a RigidSurfaces,
    body_contact: Option<&'a BodyContact>,
    tied_strikes: &'a TiedStrikes,
    mass_kg: &'a [f64],
    applied_n: &'a NodeField<[f64; 3]>,
    other_n: &'a [[f64; 3]],
    ties: &'a Ties,
    prescribed_m_s: &'a NodeField<[Option<f64>; 3]>,
    /// Rigid set of each node; empty if there are none.
    set_of: &'a [u32],
}

/// What it leaves besides velocities.
#[derive(Default)]
struct NodeSums {
    gravity_j: f64,
    driven_j: f64,
    ahead_j: [f64; 2],
    kinetic_j: f64,
    /// Square of the largest speed as contact of the body with itself counts it \[m²/s²\].
    top_speed_squared: f64,
    /// Nodes that reach a surface: not yet updated, nor in the sums.
    touching: Vec<(usize, Pushed)>,
}

/// What forces do to a node in a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pushed {
    /// Velocity after it without impulses of contact \[m/s\].
    pub trial: [f64; 3],
    /// Applied and driving forces \[N\].
    pub driven: [f64; 3],
}

impl Pushed {
    /// Work of gravity and of drives up to the full step, and what they do from there to the half step \[J\]; forces act
    /// for `kick`, half of `dt` of it after the full step.
    #[inline(always)]
    fn works(&self, weight: &[f64; 3], [old, new]: [&[f64; 3]; 2], [kick, dt]: [f64; 2]) -> [f64; 4] {
        let mut sums = [0.0; 4];
        for i in 0..3 {
            let (all, ahead) = (0.5 * (old[i] + new[i]) * kick, 0.5 * dt * new[i]);
            sums[0] += weight[i] * (all - ahead);
            sums[1] += self.driven[i] * (all - ahead);
            sums[2] += weight[i] * ahead;
            sums[3] += self.driven[i] * ahead;
        }
        sums
    }

    /// Kinetic energy over mass at the full step, after the impulses of contact: half of the product of the velocities before
    /// and after it, the impulse counted in both. For linear elements the sum with the strain energy of the full step does
    /// not change, where the energy of the mean velocity falls short by `Δt² Σ m a² / 8`: by all of it at the stability limit
    /// (Krenk, Comput. Methods Appl. Mech. Engng 195 (2006) 6110-6124: the conserved energy of Newmark's schemes).
    #[inline(always)]
    fn kinetic_m2_s2(&self, [old, new]: [&[f64; 3]; 2], ratio: f64) -> f64 {
        let mut sum = 0.0;
        for i in 0..3 {
            sum += 0.5 * new[i] * (new[i] - ratio * (self.trial[i] - old[i]));
        }
        sum
    }
}

impl NodeStep<'_> {
    /// Whether more than element forces and gravity acts on a node.
    #[inline(always)]
    fn is_special(&self, n: usize) -> bool {
        self.applied_n.is_set(n)
            || self.prescribed_m_s.is_set(n)
            || self.body_contact.is_some_and(|c| c.flagged[n])
    }

    /// Motion of a node without contact and the books of it; returns the works of [`Pushed::works`], of which those of drives
    /// are left to the caller: most nodes have none.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
    fn move_freely(
        &self,
        mass: f64,
        weight: &[f64; 3],
        pushed: &Pushed,
        new: [f64; 3],
        x: &mut [f64; 3],
        v: &mut [f64; 3],
        sums: &mut NodeSums,
    ) -> [f64; 4] {
        if let Some(contact) = self.body_contact {
            sums.top_speed_squared = sums.top_speed_squared.max(contact.speed_squared(&new));
        }
        let works = pushed.works(weight, [v, &new], [self.kick, self.dt]);
        sums.gravity_j += works[0];
        sums.ahead_j[0] += works[2];
        for i in 0..3 {
            x[i] += self.dt * new[i];
        }
        if self.measure {
            sums.kinetic_j += mass * pushed.kinetic_m2_s2([v, &new], self.dt / self.kick);
        }
        *v = new;
        works
    }

    /// What a tied node passes on to its masters \[N\]; its weight is that of the mass they have from it.
    fn force_on_tied(&self, n: usize) -> [f64; 3] {
        let internal_n = self.blocks.force_on(n);
        let other = self.other_n.get(n).copied().unwrap_or_default();
        std::array::from_fn(|i| self.applied_n[n][i] + other[i] - internal_n[i])
    }

    /// Nodes `first..`, whose positions and velocities are given.
    fn chunk(&self, first: usize, x: &mut [[f64; 3]], v: &mut [[f64; 3]]) -> NodeSums {
        let mut sums = NodeSums::default();
        let plain = self.other_n.is_empty() && self.ties.is_empty() && self.damping_1_s == 0.0;
        for (i, (x, v)) in x.iter_mut().zip(v).enumerate() {
            let n = first + i;
            let mass = self.mass_kg[n];
            if mass == 0.0 {
                *v = [0.0; 3];
                continue;
            }
            if self.set_of.get(n).is_some_and(|set| *set != NONE) {
                continue; // moved with its set
            }
            let internal = self.blocks.force_on(n);
            let weight = self.acceleration_m_s2.map(|a| mass * a);
            let per_force = self.kick / mass;
            if plain && !self.is_special(n) {
                let mut new = [0.0; 3];
                for i in 0..3 {
                    new[i] = v[i] + per_force * (weight[i] - internal[i]);
                }
                if !self.surfaces.reached(n, self.dt, x, &new) {
                    let pushed = Pushed { trial: new, driven: [0.0; 3] };
                    self.move_freely(mass, &weight, &pushed, new, x, v, &mut sums);
                    continue;
                }
            }
            let applied = if self.applied_n.is_set(n) { self.applied_n[n] } else { [0.0; 3] };
            let (mut driven, mut force, mut new) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            for i in 0..3 {
                driven[i] = applied[i] - self.damping_1_s * mass * v[i];
                force[i] = driven[i] + weight[i] - internal[i];
                if let Some(other) = self.other_n.get(n) {
                    force[i] += other[i];
                }
            }
            for (tied, share) in self.ties.carried_by(n) {
                let passed = self.force_on_tied(*tied as usize);
                for i in 0..3 {
                    driven[i] += share * self.applied_n[*tied as usize][i];
                    force[i] += share * passed[i];
                }
            }
            for i in 0..3 {
                new[i] = v[i] + per_force * force[i];
            }
            let mut held = false;
            if self.prescribed_m_s.is_set(n) {
                for i in 0..3 {
                    if let Some(given) = self.prescribed_m_s[n][i] {
                        driven[i] += mass / self.kick * (given - new[i]);
                        new[i] = given;
                    }
                }
                held = self.prescribed_m_s[n].iter().all(Option::is_some);
            }
            let contact = self.body_contact;
            let pushed = Pushed { trial: new, driven };
            let flagged = contact.is_some_and(|c| c.flagged[n]) || self.tied_strikes.flags(n);
            if flagged || (!held && self.surfaces.reached(n, self.dt, x, &new)) {
                sums.touching.push((n, pushed));
                continue;
            }
            let works = self.move_freely(mass, &weight, &pushed, new, x, v, &mut sums);
            sums.driven_j += works[1];
            sums.ahead_j[1] += works[3];
        }
        sums
    }
}
