//! The run of a complete model: loads over time, given motions, rigid walls, histories of nodes, energies.

use super::contact::RigidSurfaces;
use super::dynamics::{Death, Dynamics};
use super::kernel::{BULK_LINEAR, KernelStep};
use super::law::{ElementForm, Hourglass};
use super::model::{Model, RigidPlane};
use super::result::{ElementDeath, FeSummary};
use super::run::{ENERGY_LIMIT, FeError, Progress};
use crate::base::cpu::Stopwatch;
use serde::{Deserialize, Serialize};

/// Most time steps of a run: more would take weeks.
pub const MOST_STEPS: f64 = 1e9;
/// Most memory of the recorded states \[bytes\].
const MOST_STATE_BYTES: f64 = 8e9;
/// Steps before the energy balance is judged.
const FIRST_JUDGED_STEP: u64 = 50;

/// Options of a run.
#[derive(Debug, Clone, Copy, Default)]
pub struct ModelOptions {
    /// End time other than the model's \[s\].
    pub end_time_s: Option<f64>,
}

/// Why a model does not run to its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The run broke off.
    #[error(transparent)]
    Broken(#[from] FeError),
    /// A rigid plane that the solver does not do.
    #[error(
        "rigid wall {wall}: {what}; only horizontal walls below the body that stop all nodes are computed"
    )]
    Wall {
        /// Number of the wall, from 1.
        wall: usize,
        /// What is not supported.
        what: &'static str,
    },
    /// Nothing to compute.
    #[error("the model has no solid elements")]
    Empty,
    /// No element lets time go on.
    #[error("the first time step is {step_s:e} s; check the units of density, modulus and lengths")]
    NoStep {
        /// The step \[s\].
        step_s: f64,
    },
    /// Too long.
    #[error(
        "{end_s} s in steps of {step_s:e} s are more than {MOST_STEPS:e} steps; check the units, or use a shorter time or mass scaling"
    )]
    TooLong {
        /// Simulated time \[s\].
        end_s: f64,
        /// First step \[s\].
        step_s: f64,
    },
    /// Too many states.
    #[error("{states} states of {nodes} nodes do not fit the memory; use a longer interval of the states")]
    TooManyStates {
        /// Number of states.
        states: f64,
        /// Number of nodes.
        nodes: usize,
    },
}

/// Motion of one node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeHistory {
    /// Node index.
    pub node: usize,
    /// Displacement from the mesh's position at each time \[m\].
    pub displacement_m: Vec<[f64; 3]>,
    /// Velocity in the middle of the step that follows each time \[m/s\].
    pub velocity_m_s: Vec<[f64; 3]>,
}

/// Energies at one time \[J\]; the balance is
/// `kinetic + internal + hourglass + viscous = initial + body_loads + driven + contact + friction + residual`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ModelEnergies {
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// Work of the stresses, eroded elements included.
    pub internal_j: f64,
    /// Share of `internal_j` in elements that have eroded.
    pub eroded_j: f64,
    /// Work against hourglass control.
    pub hourglass_j: f64,
    /// Work against bulk viscosity.
    pub viscous_j: f64,
    /// Work of the accelerations on all mass.
    pub body_loads_j: f64,
    /// Work of nodal forces and given motions.
    pub driven_j: f64,
    /// Work of contact normal forces.
    pub contact_j: f64,
    /// Work of friction.
    pub friction_j: f64,
    /// What is missing.
    pub residual_j: f64,
}

/// Node positions at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Time \[s\].
    pub time_s: f64,
    /// Positions \[m\].
    pub x_m: Vec<[f32; 3]>,
}

/// What a run leaves.
#[derive(Debug, Clone)]
pub struct ModelRun {
    /// Times of histories and energies: the first steps at or after each interval \[s\].
    pub times_s: Vec<f64>,
    /// Motion of the recorded nodes.
    pub histories: Vec<NodeHistory>,
    /// Energies.
    pub energies: Vec<ModelEnergies>,
    /// States of the mesh.
    pub states: Vec<State>,
    /// Element deaths in order.
    pub deaths: Vec<ElementDeath>,
    /// Plastic strain of each element at the end.
    pub plastic_strain: Vec<f64>,
    /// Positions at the end \[m\].
    pub end_m: Vec<[f64; 3]>,
    /// Mass added to keep the least time step \[kg\].
    pub added_mass_kg: f64,
    /// What the model asks for and the solver left out.
    pub notes: Vec<String>,
    /// Statistics; `preload_iterations` and `first_ground_contact_s` are not used.
    pub summary: FeSummary,
}

/// Runs a model from its initial velocities. `report` is called at every history time.
pub fn run_model(
    model: &Model,
    options: &ModelOptions,
    report: &mut dyn FnMut(Progress),
) -> Result<ModelRun, ModelError> {
    let watch = Stopwatch::start();
    if model.mesh.elements.is_empty() {
        return Err(ModelError::Empty);
    }
    let end_s = options.end_time_s.unwrap_or(model.control.end_time_s);
    let mut body = Dynamics::new(&model.mesh, 0.0, surfaces(model)?, rayon::current_num_threads() > 1);
    let added_mass_kg = begin(model, &mut body);
    check_length(model, &body, end_s)?;
    let mut recorder = Recorder::new(model, &body);
    let drive = |body: &mut Dynamics| apply(model, body);
    start(model, &mut body);
    recorder.initial_j = body.kinetic_j();
    stop_at_surfaces(&mut body);
    let kinetic_j = body.kinetic_j();
    recorder.record(model, &mut body, kinetic_j)?;
    recorder.state(&body);
    let control = &model.control;
    let (mut histories, mut states) = (1.0, 1.0);
    while body.time_s < end_s - 0.5 * body.dt_s {
        drive(&mut body);
        let after = body.time_s + body.dt_s;
        let last = after >= end_s - 0.5 * body.dt_s;
        let due = |count: f64, interval: f64| after >= count * interval - 0.5 * body.dt_s || last;
        let (history, state) =
            (due(histories, control.history_interval_s), due(states, control.state_interval_s));
        let kinetic_j = body.step(history);
        recorder.note_deaths(&body);
        if history {
            recorder.record(model, &mut body, kinetic_j)?;
            histories = next(body.time_s + 0.5 * body.dt_s, control.history_interval_s);
            report(Progress { time_s: body.time_s, end_s });
        }
        if state {
            recorder.state(&body);
            states = next(body.time_s + 0.5 * body.dt_s, control.state_interval_s);
        }
    }
    let mut run = recorder.finish(model, &body);
    run.added_mass_kg = added_mass_kg;
    run.notes = left_out(model);
    run.summary.elapsed = watch.elapsed();
    Ok(run)
}

/// Number of the first multiple of an interval after a time.
fn next(time_s: f64, interval_s: f64) -> f64 {
    (time_s / interval_s).floor() + 1.0
}

/// The rigid planes as surfaces of the time loop. Horizontal planes with the body above become the ground, the
/// highest of several.
fn surfaces(model: &Model) -> Result<RigidSurfaces, ModelError> {
    let mut surfaces = RigidSurfaces::default();
    for (index, plane) in model.walls.iter().enumerate() {
        let wall = index + 1;
        let RigidPlane { point_m, normal, friction, nodes } = plane;
        if *normal != [0.0, 0.0, 1.0] {
            return Err(ModelError::Wall { wall, what: "its normal is not +z" });
        }
        if nodes.as_ref().is_some_and(|list| {
            let mut held = vec![false; model.mesh.nodes.len()];
            list.iter().for_each(|n| held[*n] = true);
            !model.mesh.elements.iter().all(|e| e.nodes.iter().all(|n| held[*n]))
        }) {
            return Err(ModelError::Wall { wall, what: "it stops some of the nodes only" });
        }
        match surfaces.ground {
            Some((level, _)) if level >= point_m[2] => {}
            _ => surfaces.ground = Some((point_m[2], *friction)),
        }
    }
    Ok(surfaces)
}

/// What of a model has no effect in the run.
fn left_out(model: &Model) -> Vec<String> {
    let mut notes = Vec::new();
    if model.body_contact.is_some() {
        notes.push("contact of the body with itself is not computed".to_string());
    }
    if !model.mesh.trusses.is_empty() {
        notes.push("bars are not computed: they have neither mass nor stiffness".into());
    }
    if !model.mesh.ties.is_empty() {
        notes.push("ties are not computed".into());
    }
    let laws = &model.mesh.laws;
    if laws.iter().any(|l| l.form != ElementForm::OnePoint(Hourglass::Asqbi)) {
        notes.push("all solids are computed with one point and ASQBI hourglass control".into());
    }
    if laws.iter().any(|l| l.rate.is_some()) {
        notes.push("the rate effect on the yield stress is not computed".into());
    }
    if laws.iter().any(|l| l.erosion.principal_strain.is_finite()) {
        notes.push("erosion at a principal strain is not computed".into());
    }
    notes
}

/// Step safety, mass scaling and constraints; returns the added mass \[kg\].
fn begin(model: &Model, body: &mut Dynamics) -> f64 {
    body.step_safety = model.control.step_safety;
    for constraint in &model.constraints {
        for i in (0..3).filter(|i| constraint.held[*i]) {
            body.prescribed_m_s[constraint.node][i] = Some(0.0);
        }
    }
    let added = model.control.mass_scaling_step_s.map_or(0.0, |step| scale_mass(model, body, step));
    body.dt_s = body.allowed_step_s();
    body.first_dt_s = body.dt_s;
    added
}

/// Adds mass to elements that allow less than a time step \[s\]: frequencies fall with the root of the mass. Done
/// once, before the first step.
fn scale_mass(model: &Model, body: &mut Dynamics, step_s: f64) -> f64 {
    let viscous = (1.0 + BULK_LINEAR * BULK_LINEAR).sqrt() - BULK_LINEAR;
    let most = (2.0 * body.step_safety * viscous / step_s).powi(2);
    let mut added = 0.0;
    for block in &mut body.blocks.blocks {
        for lane in 0..block.elements.len() {
            if block.bound[lane] > most {
                let before = block.material.mass_kg[lane];
                block.material.mass_kg[lane] = before * block.bound[lane] / most;
                added += block.material.mass_kg[lane] - before;
            }
        }
    }
    body.assemble_mass(&model.mesh, |_| true);
    body.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 0.0);
    added
}

fn check_length(model: &Model, body: &Dynamics, end_s: f64) -> Result<(), ModelError> {
    let step_s = body.dt_s;
    if !(step_s > 0.0 && step_s.is_finite()) {
        return Err(ModelError::NoStep { step_s });
    }
    if end_s / step_s > MOST_STEPS {
        return Err(ModelError::TooLong { end_s, step_s });
    }
    let states = (end_s / model.control.state_interval_s.max(step_s)).ceil() + 1.0;
    let nodes = model.mesh.nodes.len();
    if 12.0 * states * nodes as f64 > MOST_STATE_BYTES {
        return Err(ModelError::TooManyStates { states, nodes });
    }
    Ok(())
}

/// Initial velocities. They are those of the middle of the first step.
fn start(model: &Model, body: &mut Dynamics) {
    for (node, velocity) in &model.initial_velocity_m_s {
        body.v[*node] = *velocity;
    }
    for driven in &model.driven {
        body.prescribed_m_s[driven.node][driven.axis] = Some(driven.velocity_m_s.at(0.5 * body.dt_s));
    }
    for (v, given) in body.v.iter_mut().zip(&body.prescribed_m_s) {
        for i in 0..3 {
            v[i] = given[i].unwrap_or(v[i]);
        }
    }
}

/// Nodes that would cross a surface in the first step strike it at once.
fn stop_at_surfaces(body: &mut Dynamics) {
    for n in 0..body.x.len() {
        let (mass, old) = (body.mass_kg[n], body.v[n]);
        if mass == 0.0 || !body.surfaces.reached(body.dt_s, &body.x[n], &old) {
            continue;
        }
        let mut new = old;
        let work = body.surfaces.resolve(n, mass, body.dt_s, body.x[n], &old, &mut new);
        body.contact_j[0] += work[0];
        body.contact_j[1] += work[1];
        for i in 0..3 {
            new[i] = body.prescribed_m_s[n][i].unwrap_or(new[i]);
        }
        body.v[n] = new;
    }
}

/// Loads and motions of the step that begins: forces act at its end, velocities half a step later.
fn apply(model: &Model, body: &mut Dynamics) {
    let at_s = body.time_s + body.dt_s;
    let mut acceleration = [0.0; 3];
    for load in &model.body_loads {
        acceleration[load.axis] += load.acceleration_m_s2.at(at_s);
    }
    body.acceleration_m_s2 = acceleration;
    for load in &model.nodal_loads {
        body.applied_n[load.node] = [0.0; 3];
    }
    for load in &model.nodal_loads {
        body.applied_n[load.node][load.axis] += load.force_n.at(at_s);
    }
    for driven in &model.driven {
        let given = driven.velocity_m_s.at(at_s + 0.5 * body.dt_s);
        body.prescribed_m_s[driven.node][driven.axis] = Some(given);
    }
}

/// Collects what the run shows.
struct Recorder {
    run: ModelRun,
    initial_j: f64,
    largest_j: f64,
}

impl Recorder {
    fn new(model: &Model, body: &Dynamics) -> Self {
        let history =
            |node: &usize| NodeHistory { node: *node, displacement_m: Vec::new(), velocity_m_s: Vec::new() };
        let run = ModelRun {
            times_s: Vec::new(),
            histories: model.control.history_nodes.iter().map(history).collect(),
            energies: Vec::new(),
            states: Vec::new(),
            deaths: Vec::new(),
            plastic_strain: Vec::new(),
            end_m: Vec::new(),
            added_mass_kg: 0.0,
            notes: Vec::new(),
            summary: FeSummary {
                elements: model.mesh.elements.len(),
                nodes: model.mesh.nodes.len(),
                mass_kg: (0..model.mesh.elements.len()).map(|e| body.blocks.mass_kg(e)).sum(),
                time_step_s: body.dt_s,
                ..FeSummary::default()
            },
        };
        Self { run, initial_j: 0.0, largest_j: 0.0 }
    }

    fn note_deaths(&mut self, body: &Dynamics) {
        let death = |(element, cause): &(usize, Death)| ElementDeath {
            element: *element,
            time_s: body.time_s,
            cause: *cause,
        };
        self.run.deaths.extend(body.deaths.iter().map(death));
    }

    fn state(&mut self, body: &Dynamics) {
        let x_m = body.x.iter().map(|p| p.map(|c| c as f32)).collect();
        self.run.states.push(State { time_s: body.time_s, x_m });
    }

    fn record(&mut self, model: &Model, body: &mut Dynamics, kinetic_j: f64) -> Result<(), ModelError> {
        if let Some(node) = body.broken_node() {
            let part = body.blocks.elements_at(node).next();
            let part = part.map_or("?".into(), |e| model.mesh.parts[model.mesh.elements[e].part].clone());
            return Err(FeError::NotFinite { time_s: body.time_s, node, part }.into());
        }
        self.run.times_s.push(body.time_s);
        for history in &mut self.run.histories {
            let (from, to) = (model.mesh.nodes[history.node], body.x[history.node]);
            history.displacement_m.push(std::array::from_fn(|i| to[i] - from[i]));
            history.velocity_m_s.push(body.v[history.node]);
        }
        let energies = self.balance(body, kinetic_j);
        self.run.energies.push(energies);
        self.largest_j = self.largest_j.max(
            (energies.kinetic_j + energies.internal_j)
                .max(energies.body_loads_j.abs())
                .max(energies.driven_j.abs()),
        );
        if body.steps < FIRST_JUDGED_STEP || self.largest_j == 0.0 {
            return Ok(());
        }
        let summary = &mut self.run.summary;
        if energies.internal_j > 0.01 * self.largest_j {
            summary.hourglass_share = summary.hourglass_share.max(energies.hourglass_j / energies.internal_j);
        }
        let share = energies.residual_j / self.largest_j;
        if share > ENERGY_LIMIT {
            return Err(FeError::Energy { time_s: body.time_s, percent: 100.0 * share }.into());
        }
        Ok(())
    }

    fn balance(&self, body: &Dynamics, kinetic_j: f64) -> ModelEnergies {
        let [internal_j, hourglass_j, viscous_j] = body.blocks.energies_j();
        let eroded_j = self.run.deaths.iter().map(|d| body.blocks.internal_j(d.element)).sum();
        let [contact_j, friction_j] = body.contact_j;
        let supplied = self.initial_j + body.gravity_j + body.driven_j + contact_j + friction_j;
        ModelEnergies {
            kinetic_j,
            internal_j,
            eroded_j,
            hourglass_j,
            viscous_j,
            body_loads_j: body.gravity_j,
            driven_j: body.driven_j,
            contact_j,
            friction_j,
            residual_j: kinetic_j + internal_j + hourglass_j + viscous_j - supplied,
        }
    }

    fn finish(self, model: &Model, body: &Dynamics) -> ModelRun {
        let mut run = self.run;
        run.summary.steps = body.steps;
        let residual_j = run.energies.iter().map(|e| e.residual_j.abs()).fold(0.0, f64::max);
        run.summary.energy_error = if self.largest_j > 0.0 { residual_j / self.largest_j } else { 0.0 };
        run.summary.eroded_elements = run.deaths.len();
        run.plastic_strain = (0..model.mesh.elements.len()).map(|e| body.blocks.plastic_strain(e)).collect();
        run.end_m.clone_from(&body.x);
        run
    }
}
