//! From building, model, its run and, if there is one, the comparison with FE to the input of the report.
//!
//! The report knows no solver and no building model; here its plain data are filled.

mod against;
mod alone;
pub mod compared;
mod events;
mod left_out;
mod marks;
mod model;
mod notes;
mod partition;
mod plan;
mod scene;

pub use events::words as event_words;
pub use model::entry_words;

use crate::building::Building;
use crate::fe::result::FeRun;
use crate::generate::Generated;
use crate::mbs::RunResult;
use crate::report::{FirstContact, MbsEnergy, ReportInput, RunCost, Setting};
use crate::review::Review;
use crate::study::{Facts, fell};
use crate::validate::undecided::{Fastest, falling};
use crate::validate::{ACTIVE_ROTATION_RAD, Spread, Validation};

/// Everything that a report is made of.
pub struct Pieces<'a> {
    /// The building.
    pub building: &'a Building,
    /// The generated model with its reasons.
    pub generated: &'a Generated,
    /// Its decisions worth a look.
    pub review: &'a Review,
    /// The MBS run; its `cpu_s` is what the report shows.
    pub mbs: &'a RunResult,
    /// Wall time of the MBS run \[s\].
    pub mbs_wall_s: f64,
    /// Runs of the MBS over which its run time is the median.
    pub mbs_runs: usize,
    /// How far these runs come apart.
    pub spread: Option<&'a Spread>,
    /// What the MBS run is compared with; `None`: the report is of the MBS run alone.
    pub against: Option<Against<'a>>,
}

/// The FE side of a report.
pub struct Against<'a> {
    /// The FE run.
    pub fe: &'a FeRun,
    /// The FE run with rigid parts, if there was one.
    pub hybrid: Option<&'a FeRun>,
    /// The facts of the FE run.
    pub facts: &'a Facts,
    /// The comparison.
    pub validation: &'a Validation,
    /// Threads of the FE run.
    pub threads: usize,
}

impl<'a> Pieces<'a> {
    /// The FE run and the one with rigid parts, as far as there are any.
    fn fe_runs(&self) -> impl Iterator<Item = &'a FeRun> {
        self.against.iter().flat_map(|a| [Some(a.fe), a.hybrid]).flatten()
    }

    /// Number of output times that all runs have.
    fn outputs(&self) -> usize {
        self.fe_runs().map(|run| run.times_s.len()).fold(self.mbs.times_s.len(), usize::min)
    }

    /// Runs in which the building has come down and still moves at the end, and what moves fastest.
    fn falling(&self) -> Vec<(&'static str, Fastest<'a>)> {
        falling(["FE", "hybrid"].into_iter().zip(self.fe_runs()), self.mbs)
    }

    /// Output times of the run that comes first on the page \[s\].
    fn times_s(&self) -> &'a [f64] {
        self.against.as_ref().map_or(&self.mbs.times_s, |a| &a.fe.times_s)
    }

    /// First ground contact in that run \[s\].
    fn first_contact_s(&self) -> Option<f64> {
        self.against.as_ref().map_or(self.mbs.first_ground_contact_s, |a| a.facts.first_contact_s)
    }

    /// Whether the building collapses in the MBS run.
    fn mbs_collapsed(&self) -> bool {
        self.mbs.tracked.iter().any(|t| fell(&t.displacement_m))
    }

    /// Whether the building stands in all runs.
    fn stands(&self) -> bool {
        self.against.as_ref().map_or_else(|| !self.mbs_collapsed(), |a| a.validation.stands())
    }
}

/// The input of the report.
pub fn report_input(p: &Pieces) -> ReportInput {
    match &p.against {
        Some(a) => against::input(p, a),
        None => alone::input(p),
    }
}

/// What a report has whether there was an FE run or not.
fn common(p: &Pieces) -> ReportInput {
    ReportInput {
        building_name: p.building.name.clone(),
        stands: p.stands(),
        building_description: p.building.description.clone(),
        program_version: format!("fallwerk {}", env!("CARGO_PKG_VERSION")),
        settings: settings(p),
        first_contact: FirstContact {
            fe_s: p.against.as_ref().and_then(|a| a.validation.first_contact_s.fe),
            mbs_s: p.mbs.first_ground_contact_s,
        },
        mbs_energy: Some(mbs_energy(p.mbs)),
        mbs_run: Some(mbs_cost(p)),
        review: model::review(p.review),
        model: model::summary(p.generated, p.mbs),
        curves: model::curves(&p.generated.model.curves, &p.generated.entries),
        notes: notes::notes(p),
        events: events::events(p),
        scene: Some(scene::scene(p)),
        partition: Some(partition::partition(p)),
        blasting: plan::blasting(p.building),
        debris: plan::debris(p),
        counted_rotation_rad: Some(ACTIVE_ROTATION_RAD),
        ..ReportInput::default()
    }
}

fn settings(p: &Pieces) -> Vec<Setting> {
    let s = &p.building.settings;
    let line = |name: &str, value: String| Setting { name: name.into(), value };
    let of_building = [
        line("Simulated time", format!("{} s", s.end_time_s)),
        line("Output interval", format!("{} s", s.output_interval_s)),
        line("Time over which the forces of removed members fall", format!("{} s", s.removal_duration_s)),
        line("Gravity", format!("{} m/s²", s.gravity_m_s2)),
    ];
    let of_fe = p.against.iter().flat_map(|a| {
        [
            line("Target edge length of the FE mesh", format!("{} m", s.mesh_size_m)),
            line("Critical strain rate", format!("{} 1/s", a.facts.critical_rate_1_s)),
        ]
    });
    let of_mbs = [
        line(
            "Plastic rotation from which an MBS hinge counts as yielded",
            format!("{ACTIVE_ROTATION_RAD} rad"),
        ),
        line("Run time of the MBS", format!("median of {} runs", p.mbs_runs)),
    ];
    of_building.into_iter().chain(of_fe).chain(of_mbs).collect()
}

/// What separation and removal release counts as plastic, energy stored in contacts as elastic.
fn mbs_energy(run: &RunResult) -> MbsEnergy {
    let e = &run.energies;
    let sum = |lists: &[&Vec<f64>]| -> Vec<f64> {
        (0..run.times_s.len()).map(|i| lists.iter().map(|l| l[i]).sum()).collect()
    };
    MbsEnergy {
        time_s: run.times_s.clone(),
        kinetic_j: e.kinetic_j.clone(),
        potential_j: e.gravity_j.clone(),
        elastic_j: sum(&[&e.joints_elastic_j, &e.contact_elastic_j]),
        plastic_j: sum(&[&e.plastic_j, &e.released_j]),
        contact_j: sum(&[&e.contact_damping_j, &e.friction_j]),
        residual_j: (0..run.times_s.len()).map(|i| e.total_j(i) - e.total_j(0)).collect(),
        error: Some(run.energy_error),
    }
}

fn mean_step_s(times_s: &[f64], steps: u64) -> Option<f64> {
    times_s.last().map(|end| end / steps.max(1) as f64)
}

fn mbs_cost(p: &Pieces) -> RunCost {
    let bodies = p.mbs.bodies.len() as u64;
    RunCost {
        cpu_s: Some(p.mbs.cpu_s),
        wall_s: Some(p.mbs_wall_s),
        steps: Some(p.mbs.steps as u64),
        step_s: mean_step_s(&p.mbs.times_s, p.mbs.steps as u64),
        parts: Some(bodies),
        dofs: Some(6 * bodies),
        threads: Some(1),
    }
}
