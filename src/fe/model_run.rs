//! The run of a complete model: loads over time, given motions, rigid walls, histories of nodes, energies.

use super::contact::body::PUSH_M_S;
use super::contact::{BodyContact, RigidSurfaces};
use super::dynamics::Dynamics;
use super::erosion::{ErosionTable, STEP_COLLAPSE, free_nodes};
use super::mass_scaling::{MOST_ADDED, MOST_ADDED_IN_DECK, MassScalingError, scale_mass};
use super::mesh::Mesh;
use super::model::Model;
use super::result::{ElementDeath, FeSummary};
use super::run::{FeError, Progress, contact_error, step_share};
use super::strain_rate::StrainWindow;
use super::truss::BarRupture;
use super::unseen;
use super::vtu::{Frame, FrameSink};
use super::watch::{Books, LOOK_STEPS, Watch};
use crate::base::cpu::Stopwatch;
use serde::{Deserialize, Serialize};

/// Most time steps of a run: more would take weeks.
pub const MOST_STEPS: f64 = 1e9;

/// Options of a run.
#[derive(Debug, Clone, Copy, Default)]
pub struct ModelOptions {
    /// End time other than the model's \[s\].
    pub end_time_s: Option<f64>,
    /// Accept a share of the stability limit above 1: to show what the run then comes to.
    pub step_forced: bool,
}

/// Why a model does not run to its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The run broke off.
    #[error(transparent)]
    Broken(#[from] FeError),
    /// Mass scaling refused.
    #[error("mass scaling: {0}")]
    MassScaling(#[from] MassScalingError),
    /// Nothing to compute.
    #[error("the model has no solid elements")]
    Empty,
    /// No element lets time go on.
    #[error("the first time step is {step_s:e} s; check the units of density, modulus and lengths")]
    NoStep {
        /// The step \[s\].
        step_s: f64,
        /// Part of the element that allows the least.
        part: usize,
    },
    /// Over before the first step.
    #[error(
        "the run is to end at {end_s:e} s, within its first step of {step_s:e} s; give a longer time, or check the units"
    )]
    TooShort {
        /// Simulated time \[s\].
        end_s: f64,
        /// First step \[s\].
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
}

impl ModelError {
    /// Whether model or options have to be changed, see [`FeError::is_input`].
    pub fn is_input(&self) -> bool {
        match self {
            Self::Broken(error) => error.is_input(),
            _ => true,
        }
    }
}

/// Motion of one node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeHistory {
    /// Node index.
    pub node: usize,
    /// Displacement from the mesh's position at each time \[m\].
    pub displacement_m: Vec<[f64; 3]>,
    /// Velocity in the middle of the step that ends at each time \[m/s\], half a step before it; the initial one in the first row.
    pub velocity_m_s: Vec<[f64; 3]>,
}

/// Energies \[J\] of the beginning of the step that ends at a time, where forces and strains are known: one step before it. The balance is
/// `kinetic + internal + hourglass + viscous = initial + body_loads + driven + contact + friction + released + residual`.
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
    /// Work booked for forces of dying elements, rupturing bars and ended ties that no longer acted.
    pub released_j: f64,
    /// What is missing.
    pub residual_j: f64,
}

/// What a run leaves.
#[derive(Debug, Clone)]
pub struct ModelRun {
    /// Times of histories and energies: the first steps at or after each interval \[s\].
    pub times_s: Vec<f64>,
    /// Motion of the recorded nodes.
    pub histories: Vec<NodeHistory>,
    /// Energies, one step before the times.
    pub energies: Vec<ModelEnergies>,
    /// Element deaths in order.
    pub deaths: Vec<ElementDeath>,
    /// Ruptures of bars in order.
    pub ruptures: Vec<BarRupture>,
    /// Plastic strain of each element at the end.
    pub plastic_strain: Vec<f64>,
    /// Positions at the end \[m\].
    pub end_m: Vec<[f64; 3]>,
    /// Mass added to keep the least time step \[kg\].
    pub added_mass_kg: f64,
    /// What the reader of the results should know.
    pub notes: Vec<String>,
    /// Statistics; `preload_iterations` and `first_ground_contact_s` are not used.
    pub summary: FeSummary,
}

/// Runs a model from its initial velocities. `frames` gets the states of the mesh, `report` is called at every history time.
pub fn run_model(
    model: &Model,
    options: &ModelOptions,
    mut frames: Option<&mut dyn FrameSink>,
    report: &mut dyn FnMut(Progress),
) -> Result<ModelRun, ModelError> {
    let watch = Stopwatch::start();
    if model.mesh.elements.is_empty() {
        return Err(ModelError::Empty);
    }
    let end_s = options.end_time_s.unwrap_or(model.control.end_time_s);
    let mut surfaces = RigidSurfaces::default();
    surfaces.planes.clone_from(&model.walls);
    let mut body = Dynamics::new(&model.mesh, 0.0, surfaces, rayon::current_num_threads() > 1);
    let (added_mass_kg, notes) = begin(model, &mut body, options.step_forced)?;
    check_length(model, &body, end_s)?;
    let mut recorder = Recorder::new(model, &body);
    recorder.initial_j = body.kinetic_j();
    recorder.record(model, &mut body, recorder.initial_j)?;
    recorder.state(model, &body, &mut frames)?;
    let control = &model.control;
    let (mut histories, mut states) = (1.0, 1.0);
    while body.time_s < end_s - 0.5 * body.dt_s {
        apply(model, &mut body);
        let after = body.time_s + body.dt_s;
        let last = after >= end_s - 0.5 * body.dt_s;
        let due = |count: f64, interval: f64| after >= count * interval - 0.5 * body.dt_s || last;
        let (history, state) =
            (due(histories, control.history_interval_s), due(states, control.state_interval_s));
        let look = !history && (body.steps + 1).is_multiple_of(LOOK_STEPS);
        let kinetic_j = body.step(history || look);
        recorder.note_deaths(model, &body);
        if let Some(lost) = body.body_contact.as_ref().and_then(|c| c.lost) {
            return Err(contact_error(&model.mesh, &body, lost).into());
        }
        if look {
            recorder.look(model, &body, kinetic_j)?;
        }
        if last {
            recorder.watch.end();
        }
        if history {
            recorder.record(model, &mut body, kinetic_j)?;
            histories = next(body.time_s + 0.5 * body.dt_s, control.history_interval_s);
            report(Progress { time_s: body.time_s, end_s, checkpoints: 0 });
        }
        if state {
            recorder.state(model, &body, &mut frames)?;
            states = next(body.time_s + 0.5 * body.dt_s, control.state_interval_s);
        }
    }
    let mut run = recorder.finish(model, &body);
    (run.added_mass_kg, run.notes) = (added_mass_kg, notes);
    run.notes.extend(squeezed(&model.mesh, &run.ruptures));
    run.summary.elapsed = watch.elapsed();
    Ok(run)
}

/// Number of the first multiple of an interval after a time.
fn next(time_s: f64, interval_s: f64) -> f64 {
    (time_s / interval_s).floor() + 1.0
}

/// A note on bars whose ends came together, if there are any: those that ended with their time step were shorter than a tenth of their length.
fn squeezed(mesh: &Mesh, ruptures: &[BarRupture]) -> Option<String> {
    let flat = || ruptures.iter().filter(|r| libm::exp(r.strain) < STEP_COLLAPSE);
    let first = flat().next()?;
    Some(format!(
        "bars that were squeezed to less than a tenth of their length ended with the ruptured ones: {}, the first in part `{}` at {:.6} s; check what holds and loads them",
        flat().count(),
        mesh.parts[first.part],
        first.time_s
    ))
}

/// Step safety, constraints, mass scaling, contact and initial velocities; returns the added mass \[kg\] and notes.
fn begin(model: &Model, body: &mut Dynamics, forced: bool) -> Result<(f64, Vec<String>), ModelError> {
    let mut notes = Vec::new();
    let asked = model.control.step_safety;
    let taken = step_share(asked, &model.mesh, forced)?;
    body.set_step_safety(taken);
    if taken < asked {
        notes.push(format!(
            "the time step is {taken:.3} of the stability limit in place of {asked}: more is unstable with bulk viscosity at this Poisson's ratio"
        ));
    }
    for constraint in &model.constraints {
        for i in (0..3).filter(|i| constraint.held[*i]) {
            body.prescribed_m_s[constraint.node][i] = Some(0.0);
        }
    }
    let mut added_kg = 0.0;
    if let Some(step_s) = model.control.mass_scaling_step_s {
        let scaling = scale_mass(&model.mesh, body, step_s, MOST_ADDED_IN_DECK)?;
        added_kg = scaling.added_kg;
        if scaling.added_share > MOST_ADDED {
            notes.push(format!(
                "mass scaling adds {:.1} % to the mass of the model",
                100.0 * scaling.added_share
            ));
        }
    }
    if let Some(settings) = model.body_contact {
        let mut contact = BodyContact::new(&model.mesh, settings);
        contact.push_m_s = push_m_s(&model.mesh);
        body.body_contact = Some(Box::new(contact));
        notes.extend(unseen::notes(&model.mesh));
    }
    for (node, velocity) in &model.initial_velocity_m_s {
        body.v[*node] = *velocity;
    }
    for node in &model.mesh.fixed {
        body.v[*node] = [0.0; 3];
    }
    for driven in &model.driven {
        body.v[driven.node][driven.axis] = driven.velocity_m_s.at(0.0);
    }
    for constraint in &model.constraints {
        for i in (0..3).filter(|i| constraint.held[*i]) {
            body.v[constraint.node][i] = 0.0;
        }
    }
    Ok((added_kg, notes))
}

/// Speed at which contact takes overlaps back, in the units of the model: the share of the wave speed of the stiffest material that [`PUSH_M_S`] is of that
/// of homogenised concrete.
fn push_m_s(mesh: &Mesh) -> f64 {
    let speed = |youngs: f64, poisson: f64, density: f64| {
        let modulus = youngs * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        (modulus / density).sqrt()
    };
    let laws = mesh.elements.iter().map(|e| &mesh.laws[e.law]);
    let largest = laws
        .map(|law| speed(law.youngs_modulus_pa, law.poisson_ratio, law.density_kg_m3))
        .fold(0.0, f64::max);
    PUSH_M_S * largest / speed(16.5e9, 0.2, 2500.0)
}

fn check_length(model: &Model, body: &Dynamics, end_s: f64) -> Result<(), ModelError> {
    let step_s = body.dt_s;
    if !(step_s > 0.0 && step_s.is_finite()) {
        let bounds = body.blocks.element_bounds_1_s2(&body.x);
        let worst = (0..bounds.len()).max_by(|a, b| bounds[*a].total_cmp(&bounds[*b])).unwrap_or(0);
        return Err(ModelError::NoStep { step_s, part: model.mesh.elements[worst].part });
    }
    if end_s < step_s {
        return Err(ModelError::TooShort { end_s, step_s });
    }
    if end_s / step_s > MOST_STEPS {
        return Err(ModelError::TooLong { end_s, step_s });
    }
    Ok(())
}

/// Loads and motions of the step that begins: forces act at its beginning, velocities in its middle.
fn apply(model: &Model, body: &mut Dynamics) {
    let at_s = body.time_s;
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
    window: StrainWindow,
    outputs: usize,
    state_time_s: f64,
    initial_j: f64,
    watch: Watch,
}

impl Recorder {
    fn new(model: &Model, body: &Dynamics) -> Self {
        let history =
            |node: &usize| NodeHistory { node: *node, displacement_m: Vec::new(), velocity_m_s: Vec::new() };
        let run = ModelRun {
            times_s: Vec::new(),
            histories: model.control.history_nodes.iter().map(history).collect(),
            energies: Vec::new(),
            deaths: Vec::new(),
            ruptures: Vec::new(),
            plastic_strain: Vec::new(),
            end_m: Vec::new(),
            added_mass_kg: 0.0,
            notes: Vec::new(),
            summary: FeSummary {
                elements: model.mesh.elements.len(),
                nodes: model.mesh.nodes.len(),
                mass_kg: (0..model.mesh.elements.len()).map(|e| body.blocks.mass_kg(e)).sum::<f64>()
                    + body.trusses.bars.iter().map(|bar| bar.mass_kg).sum::<f64>(),
                time_step_s: body.dt_s,
                ..FeSummary::default()
            },
        };
        let window = StrainWindow::new(&body.x);
        Self { run, window, outputs: 0, state_time_s: 0.0, initial_j: 0.0, watch: Watch::new(0.0) }
    }

    fn note_deaths(&mut self, model: &Model, body: &Dynamics) {
        for (element, cause) in &body.deaths {
            self.run.deaths.push(ElementDeath { element: *element, time_s: body.time_s, cause: *cause });
            self.window.note_end(&model.mesh, *element, &body.x);
        }
        self.run.ruptures.extend(body.trusses.ruptures(&model.mesh, body.time_s));
    }

    /// Hands the state of the mesh on.
    fn state(
        &mut self,
        model: &Model,
        body: &Dynamics,
        frames: &mut Option<&mut dyn FrameSink>,
    ) -> Result<(), ModelError> {
        if let Some(sink) = frames {
            let interval_s = (body.time_s - self.state_time_s).max(f64::MIN_POSITIVE);
            let rates = self.window.finish(&model.mesh, |e| body.blocks.share(e) > 0.0, &body.x, interval_s);
            let frame = Frame {
                output: self.outputs,
                time_s: body.time_s,
                mesh: &model.mesh,
                body,
                start_m: &model.mesh.nodes,
                strain_rates_1_s: &rates,
            };
            sink.frame(&frame).map_err(FeError::Output)?;
        }
        (self.outputs, self.state_time_s) = (self.outputs + 1, body.time_s);
        Ok(())
    }

    /// The books, if the run is sound.
    fn look(&mut self, model: &Model, body: &Dynamics, kinetic_j: f64) -> Result<Books, ModelError> {
        let books = Books::of(body, kinetic_j, self.initial_j, 0.0);
        self.watch.look(&model.mesh, body, &books)?;
        Ok(books)
    }

    fn record(&mut self, model: &Model, body: &mut Dynamics, kinetic_j: f64) -> Result<(), ModelError> {
        let books = self.look(model, body, kinetic_j)?;
        self.run.times_s.push(body.time_s);
        for history in &mut self.run.histories {
            let (from, to) = (model.mesh.nodes[history.node], body.x[history.node]);
            history.displacement_m.push(std::array::from_fn(|i| to[i] - from[i]));
            history.velocity_m_s.push(body.v[history.node]);
        }
        let energies = self.energies(body, &books);
        self.run.energies.push(energies);
        let summary = &mut self.run.summary;
        if self.watch.judges(body) && energies.internal_j > 0.01 * self.watch.largest_j {
            summary.hourglass_share =
                summary.hourglass_share.max((energies.hourglass_j / energies.internal_j).abs());
        }
        Ok(())
    }

    fn energies(&self, body: &Dynamics, books: &Books) -> ModelEnergies {
        let eroded = self.run.deaths.iter().map(|d| body.blocks.internal_j(d.element));
        ModelEnergies {
            kinetic_j: books.kinetic_j,
            internal_j: books.internal_j,
            // the sum of nothing would be -0
            eroded_j: eroded.fold(0.0, |sum, j| sum + j),
            hourglass_j: books.hourglass_j,
            viscous_j: books.viscous_j,
            body_loads_j: books.body_loads_j,
            driven_j: books.driven_j,
            contact_j: books.contact_j,
            friction_j: books.friction_j,
            released_j: books.released_j,
            residual_j: books.residual_j(),
        }
    }

    fn finish(self, model: &Model, body: &Dynamics) -> ModelRun {
        let mut run = self.run;
        run.summary.steps = body.steps;
        let residual_j = run.energies.iter().map(|e| e.residual_j.abs()).fold(0.0, f64::max);
        run.summary.energy_error =
            if self.watch.largest_j > 0.0 { residual_j / self.watch.largest_j } else { 0.0 };
        run.summary.erosion = ErosionTable { free: free_nodes(body), ..body.failure.table };
        run.summary.eroded_elements = run.summary.erosion.eroded();
        run.summary.ruptured_bars = run.ruptures.len();
        run.summary.body_contact = body.body_contact.as_ref().map(|c| c.summary().clone());
        run.plastic_strain = (0..model.mesh.elements.len()).map(|e| body.blocks.plastic_strain(e)).collect();
        run.end_m.clone_from(&body.x);
        run
    }
}
