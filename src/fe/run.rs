//! The FE run of a building: dead load, charges, collapse, histories, checkpoints.

use super::contact::{BodyContact, LostContact, RigidSurfaces};
use super::dynamics::{Dynamics, most_step_safety};
use super::erosion::Fate;
use super::hybrid::{Hybrid, HybridSettings, Refused};
use super::law::ElementForm;
use super::mass_scaling::{MOST_ADDED, MassScaling, MassScalingError, scale_mass};
use super::mesh::Mesh;
use super::model::ContactSettings;
use super::recorder::Recorder;
use super::relaxation::{self, StaticState};
use super::removal::{Removal, hit};
use super::restart::{self, Head, RestartError};
use super::result::FeRun;
use super::split;
use super::vtu::{FrameSink, WrittenFrame};
use super::watch::{Diagnosis, LOOK_STEPS};
use super::weld::{self, Welds};
use crate::base::cpu::{Elapsed, Stopwatch};
use crate::base::hash::ContentHash;
use crate::base::isa::Isa;
use crate::building::Building;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Options of a run.
#[derive(Debug, Clone)]
pub struct FeOptions {
    /// Element size other than the building's \[m\].
    pub mesh_size_m: Option<f64>,
    /// End time other than the building's \[s\].
    pub end_time_s: Option<f64>,
    /// What becomes of elements that reach their erosion strain.
    pub on_failure: Fate,
    /// Time step to be reached by mass scaling \[s\].
    pub mass_scaling_step_s: Option<f64>,
    /// Accept any amount of added mass.
    pub mass_scaling_forced: bool,
    /// Keep node positions over time in memory, for a report.
    pub keep_frames: bool,
    /// Whether parts of the building touch each other.
    pub body_contact: bool,
    /// Share of the stability limit other than [`super::dynamics::STEP_SAFETY`].
    pub step_safety: Option<f64>,
    /// Also accept a share above 1: to show what the run then comes to.
    pub step_forced: bool,
    /// Element form of all elements, other than the default.
    pub form: Option<ElementForm>,
    /// Whether elements whose nodes stand still keep their forces instead of being computed; the same bytes either way.
    pub skip_quiet: bool,
    /// Instruction set of the kernel.
    pub isa: Isa,
    /// Move parts that do not deform as rigid bodies.
    pub hybrid: Option<HybridSettings>,
}

impl Default for FeOptions {
    fn default() -> Self {
        Self {
            mesh_size_m: None,
            end_time_s: None,
            on_failure: Fate::default(),
            mass_scaling_step_s: None,
            mass_scaling_forced: false,
            keep_frames: false,
            body_contact: true,
            step_safety: None,
            step_forced: false,
            form: None,
            skip_quiet: true,
            isa: Isa::best(),
            hybrid: None,
        }
    }
}

/// What a run reads and writes besides its results.
#[derive(Default)]
pub struct Attached<'a> {
    /// Gets the state at each output.
    pub frames: Option<&'a mut dyn FrameSink>,
    /// Checkpoints to write.
    pub checkpoints: Option<Checkpoints>,
    /// A checkpoint to go on from.
    pub resume: Option<PathBuf>,
}

/// Checkpoints of a run: one file, replaced each time.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoints {
    /// The file.
    pub path: PathBuf,
    /// Simulated time between two of them \[s\]; they are written at outputs, and after the last one.
    pub every_s: f64,
}

impl Checkpoints {
    /// Whether one is due at an output, the one before having been at `before_s`.
    fn due(&self, before_s: f64, now_s: f64) -> bool {
        let count = |t: f64| (t / self.every_s + 1e-9).floor();
        count(now_s) > count(before_s)
    }
}

/// How far a run is.
#[derive(Debug, Clone, Copy)]
pub struct Progress {
    /// Simulated time \[s\].
    pub time_s: f64,
    /// Simulated time at the end \[s\].
    pub end_s: f64,
    /// Checkpoints written.
    pub checkpoints: usize,
}

/// A run that cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FeError {
    /// No static state under dead load.
    #[error("no dead-load state: {0}")]
    Preload(String),
    /// Mass scaling refused.
    #[error("mass scaling: {0}")]
    MassScaling(#[from] MassScalingError),
    /// Not a number, energy from nowhere or lost, motion that flips from step to step.
    #[error("{0}")]
    Unsound(Box<Diagnosis>),
    /// A part went through another.
    #[error(
        "at t = {time_s:.6} s a node of part `{part}` is {depth_m:.3} m inside part `{other}` at x = {at_m:.3?} m: their contact did not hold; try a smaller mesh size, or --no-body-contact"
    )]
    Contact {
        /// Time \[s\].
        time_s: f64,
        /// Part of the node.
        part: String,
        /// Part that it is inside of.
        other: String,
        /// Depth \[m\].
        depth_m: f64,
        /// Position \[m\].
        at_m: [f64; 3],
    },
    /// A file of the results cannot be written.
    #[error("{0}")]
    Output(String),
    /// A checkpoint cannot be written or gone on from.
    #[error(transparent)]
    Restart(#[from] RestartError),
    /// There can be no rigid parts.
    #[error(transparent)]
    Hybrid(#[from] Refused),
    /// Members without elements.
    #[error("no elements fit into {members} at a mesh size of {size_m} m; give a smaller mesh size")]
    Unmeshed {
        /// The members.
        members: String,
        /// Mesh size \[m\].
        size_m: f64,
    },
    /// Members joined across a gap.
    #[error(transparent)]
    Welded(#[from] Welds),
    /// All members are cut in preparation.
    #[error("there is nothing to compute: all members are cut in preparation; leave one of them standing")]
    Empty,
    /// The end comes before the first output.
    #[error(
        "the run is to end at {end_s} s, before its first output at {interval_s} s; give at least that, or a shorter `settings.output_interval`"
    )]
    TooShort {
        /// End \[s\].
        end_s: f64,
        /// Output interval \[s\].
        interval_s: f64,
    },
    /// A step beyond the next output.
    #[error(
        "the time step is {step_s:.3e} s, longer than the output interval of {interval_s} s{}; give a smaller step of mass scaling, or a longer `settings.output_interval`",
        added_words(*.added_share)
    )]
    LongStep {
        /// First step \[s\].
        step_s: f64,
        /// Output interval \[s\].
        interval_s: f64,
        /// Mass added for it, over the mass of the building.
        added_share: f64,
    },
    /// A charge that would do nothing.
    #[error(
        "charge `{charge}` reaches no element: none of those of `{member}` has its centre between {from_m} and {to_m} m from the lower end at a mesh size of {size_m} m; give a longer stretch or a smaller mesh size"
    )]
    NoElements {
        /// The charge.
        charge: String,
        /// Its member.
        member: String,
        /// Begin of its stretch \[m\].
        from_m: f64,
        /// End of its stretch \[m\].
        to_m: f64,
        /// Mesh size \[m\].
        size_m: f64,
    },
    /// A time step beyond stability.
    #[error(
        "the time step is to be {share:.3} of the stability limit, expected more than 0 and at most 1: beyond it elements yield and erode by the instability alone"
    )]
    StepShare {
        /// Share of the limit.
        share: f64,
    },
}

impl FeError {
    /// Whether what the run was given has to be changed: building, options, a checkpoint, or a place that cannot be written; otherwise the run itself failed.
    pub fn is_input(&self) -> bool {
        match self {
            Self::MassScaling(_) | Self::StepShare { .. } | Self::Unmeshed { .. } | Self::Empty => true,
            Self::Welded(_) => true,
            Self::NoElements { .. } | Self::TooShort { .. } | Self::LongStep { .. } => true,
            Self::Restart(_) | Self::Output(_) | Self::Hybrid(_) => true,
            Self::Preload(_) | Self::Unsound(_) | Self::Contact { .. } => false,
        }
    }
}

/// The state of a run at an output: all that a checkpoint holds.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct RunState {
    body: Dynamics,
    recorder: Recorder,
    removal: Removal,
    preload: StaticState,
    mass_scaling: Option<MassScaling>,
    /// Frames on disk.
    frames: Vec<WrittenFrame>,
    /// Time taken until here.
    elapsed: Elapsed,
}

/// Runs a building. `report` is called at every output time.
///
/// # Errors
/// If there is no dead-load state, or the run loses its balance.
pub fn run(
    building: &Building,
    options: &FeOptions,
    report: &mut dyn FnMut(Progress),
) -> Result<FeRun, FeError> {
    run_with(building, options, Attached::default(), report)
}

/// [`run`] with frames, checkpoints, or from a checkpoint.
///
/// # Errors
/// As [`run`]; also if a file cannot be written or a checkpoint cannot be gone on from.
pub fn run_with(
    building: &Building,
    options: &FeOptions,
    mut attached: Attached<'_>,
    report: &mut dyn FnMut(Progress),
) -> Result<FeRun, FeError> {
    let watch = Stopwatch::start();
    let settings = &building.settings;
    let size_m = options.mesh_size_m.unwrap_or(settings.mesh_size_m);
    let (mut mesh, snapped) = Mesh::of(building, size_m);
    check_mesh(building, &mesh, size_m)?;
    if let Some(form) = options.form {
        mesh.laws.iter_mut().for_each(|law| law.form = form);
    }
    if options.hybrid.is_some() && (attached.checkpoints.is_some() || attached.resume.is_some()) {
        return Err(Refused::Checkpoint.into());
    }
    let end_s = options.end_time_s.unwrap_or(settings.end_time_s);
    let interval = settings.output_interval_s;
    reaches_an_output(end_s, interval)?;
    let outputs = outputs(end_s, interval);
    let mut head = head(building, options, size_m, &attached)?;
    let mut state = match attached.resume.take() {
        Some(path) => RunState::read(&path, &head, &mut mesh, outputs, &mut attached)?,
        None => RunState::begin(building, options, &mesh, outputs, &mut attached)?,
    };
    state.body.isa = options.isa;
    let before = state.elapsed;
    let mut checkpoints = 0;
    for output in state.recorder.count()..=outputs {
        let target = output as f64 * interval;
        state.advance(building, &mut mesh, target)?;
        state.recorder.record(building, &mesh, &mut state.body, attached.frames.as_deref_mut())?;
        state.elapsed = before + watch.elapsed();
        if let Some(to) = &attached.checkpoints
            && (output == outputs || to.due(target - interval, target))
        {
            head.time_s = target;
            state.frames = attached.frames.as_ref().map_or(Vec::new(), |f| f.written().to_vec());
            restart::write(&to.path, &head, &state)?;
            checkpoints += 1;
        }
        report(Progress { time_s: state.body.time_s, end_s, checkpoints });
    }
    let mut result = state.recorder.finish(mesh, snapped, &state.body);
    result.summary.preload_iterations = state.preload.iterations;
    result.summary.relaxation_cycles = state.preload.relaxed.map(|r| r.cycles);
    result.summary.mass_scaling = state.mass_scaling;
    result.summary.elapsed = before + watch.elapsed();
    Ok(result)
}

/// Whether a run is long enough for an output \[s\].
///
/// # Errors
/// If it is not.
pub fn reaches_an_output(end_s: f64, interval_s: f64) -> Result<(), FeError> {
    if end_s < interval_s * (1.0 - 1e-9) { Err(FeError::TooShort { end_s, interval_s }) } else { Ok(()) }
}

/// Number of outputs after the first: the run ends at the one nearest to its end.
pub fn outputs(end_s: f64, interval_s: f64) -> usize {
    (end_s / interval_s).round().max(1.0) as usize
}

/// How much mass was added, if it is more than is accepted without being forced.
fn added_words(added_share: f64) -> String {
    if added_share <= MOST_ADDED {
        return String::new();
    }
    format!(", for which mass scaling adds {:.1} % to the mass of the building", 100.0 * added_share)
}

/// Refuses meshes in which a member, a gap, or what a charge is to remove, is missing.
fn check_mesh(building: &Building, mesh: &Mesh, size_m: f64) -> Result<(), FeError> {
    let members = mesh.unmeshed(building);
    if !members.is_empty() {
        return Err(FeError::Unmeshed { members: members.join(", "), size_m });
    }
    if mesh.elements.is_empty() {
        return Err(FeError::Empty);
    }
    weld::check(building, mesh, size_m)?;
    for charge in &building.events {
        if let Some([from_m, to_m]) = charge.stretch_m
            && !building.is_cut(&charge.member)
            && hit(building, mesh, charge).is_empty()
        {
            let (charge, member) = (charge.id.clone(), charge.member.clone());
            return Err(FeError::NoElements { charge, member, from_m, to_m, size_m });
        }
    }
    Ok(())
}

/// What a checkpoint of this run is known by. The end time is left out: a run may be continued beyond its first end.
fn head(
    building: &Building,
    options: &FeOptions,
    mesh_size_m: f64,
    attached: &Attached<'_>,
) -> Result<Head, FeError> {
    let mut endless = building.clone();
    endless.settings.end_time_s = 0.0;
    let hash = ContentHash::of_value(&endless).map_err(|e| FeError::Output(e.to_string()))?;
    Ok(Head {
        program_version: env!("CARGO_PKG_VERSION").to_string(),
        model_hash: *hash.as_bytes(),
        mesh_size_m,
        form: options.form,
        on_failure: options.on_failure,
        body_contact: options.body_contact,
        mass_scaling_step_s: options.mass_scaling_step_s,
        frames_every: attached.frames.as_ref().map(|f| f.every()),
        time_s: 0.0,
    })
}

impl RunState {
    /// The dead-load state, recorded as output 0.
    fn begin(
        building: &Building,
        options: &FeOptions,
        mesh: &Mesh,
        outputs: usize,
        attached: &mut Attached<'_>,
    ) -> Result<Self, FeError> {
        let parallel = rayon::current_num_threads() > 1;
        let gravity = building.settings.gravity_m_s2;
        let mut body = Dynamics::new(mesh, gravity, RigidSurfaces::of(building), parallel);
        if let Some(safety) = options.step_safety {
            body.set_step_safety(step_share(safety, mesh, options.step_forced)?);
        }
        body.failure.fate = options.on_failure;
        body.skip_quiet = options.skip_quiet;
        body.isa = options.isa;
        let most_added = if options.mass_scaling_forced { f64::INFINITY } else { MOST_ADDED };
        let scaled = options.mass_scaling_step_s.map(|s| scale_mass(mesh, &mut body, s, most_added));
        let mass_scaling = scaled.transpose()?;
        let added_share = mass_scaling.as_ref().map_or(0.0, |m| m.added_share);
        let (step_s, interval_s) = (body.dt_s, building.settings.output_interval_s);
        if step_s > interval_s {
            return Err(FeError::LongStep { step_s, interval_s, added_share });
        }
        let preload = relaxation::static_state(mesh, &mut body).map_err(|what| {
            if added_share <= MOST_ADDED {
                return FeError::Preload(what);
            }
            let percent = 100.0 * added_share;
            FeError::Preload(format!("{what}; mass scaling adds {percent:.1} % to the mass of the building, whose weight has to be borne: give a smaller step of mass scaling"))
        })?;
        body.surfaces.new_touches.clear();
        body.surfaces.take_pushes();
        if options.body_contact {
            let settings = ContactSettings { friction: building.ground.friction };
            let mut contact = BodyContact::new(mesh, settings);
            contact.search_every_step = !options.skip_quiet;
            body.body_contact = Some(Box::new(contact));
        }
        let removal = Removal::new(building, mesh);
        if let Some(settings) = &options.hybrid {
            if options.on_failure == Fate::Split {
                return Err(Refused::Split.into());
            }
            let removed = removal.removes(mesh.elements.len());
            body.hybrid = Some(Box::new(Hybrid::new(mesh, &body, &removed, settings.clone())?));
        }
        let mut recorder = Recorder::new(building, mesh, &body, outputs, options.keep_frames);
        recorder.record(building, mesh, &mut body, attached.frames.as_deref_mut())?;
        let (frames, elapsed) = (Vec::new(), Elapsed::default());
        Ok(Self { body, recorder, removal, preload, mass_scaling, frames, elapsed })
    }

    /// The state in a checkpoint.
    fn read(
        path: &std::path::Path,
        head: &Head,
        mesh: &mut Mesh,
        outputs: usize,
        attached: &mut Attached<'_>,
    ) -> Result<Self, FeError> {
        let mut state: Self = restart::read(path, head)?;
        let other = |what: String| RestartError::OtherRun { path: path.to_path_buf(), what };
        split::follow(mesh, &state.recorder.splits);
        let sizes = [state.body.x.len(), state.body.blocks.elements()];
        if sizes != [mesh.nodes.len(), mesh.elements.len()] {
            let [nodes, elements] = sizes;
            return Err(other(format!("it has {nodes} nodes and {elements} elements")).into());
        }
        if state.recorder.count() > outputs + 1 {
            let time_s = state.body.time_s;
            let what =
                format!("it is at t = {time_s:.3} s, behind the end of this run; give a later --end-time");
            return Err(other(what).into());
        }
        if let Some(frames) = &mut attached.frames {
            frames.resume(mesh, std::mem::take(&mut state.frames)).map_err(FeError::Output)?;
        }
        state.body.use_threads(rayon::current_num_threads() > 1);
        Ok(state)
    }

    /// Steps to an output time \[s\].
    fn advance(&mut self, building: &Building, mesh: &mut Mesh, target: f64) -> Result<(), FeError> {
        let Self { body, recorder, removal, .. } = self;
        while body.time_s < target - 0.5 * body.dt_s {
            removal.apply(mesh, body, building.settings.removal_duration_s, recorder);
            let last = body.time_s + 1.5 * body.dt_s >= target;
            let look = !last && (body.steps + 1).is_multiple_of(LOOK_STEPS);
            recorder.kinetic_j = body.step(last || look);
            recorder.note(mesh, body, building);
            if !body.failure.splits.is_empty() {
                split::follow(mesh, &body.failure.splits);
                removal.follow(&body.failure.splits, body);
                recorder.follow(&body.failure.splits);
            }
            if let Some(lost) = body.body_contact.as_ref().and_then(|c| c.lost) {
                return Err(contact_error(mesh, body, lost));
            }
            if look {
                recorder.look(mesh, body)?;
            }
        }
        Ok(())
    }
}

/// The share of the stability limit that is taken where one is asked for: what bulk viscosity leaves stable at most. A share above the limit is refused; one that is `forced` is taken as it is.
pub(super) fn step_share(asked: f64, mesh: &Mesh, forced: bool) -> Result<f64, FeError> {
    match forced {
        true if asked > 0.0 && asked.is_finite() => Ok(asked),
        false if asked > 0.0 && asked <= 1.0 => Ok(asked.min(most_step_safety(mesh))),
        _ => Err(FeError::StepShare { share: asked }),
    }
}

pub(super) fn contact_error(mesh: &Mesh, body: &Dynamics, lost: LostContact) -> FeError {
    let part = |element: usize| mesh.parts[mesh.elements[element].part].clone();
    FeError::Contact {
        time_s: body.time_s,
        part: body.blocks.elements_at(lost.node).next().map_or("?".into(), part),
        other: part(lost.element),
        depth_m: lost.depth_m,
        at_m: lost.at_m,
    }
}
