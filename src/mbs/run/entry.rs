//! Runs of a model: with options, and again with smaller steps where one was too coarse.

use super::Run;
use super::remarks::{FINER, closing_remarks, remark_on_levels, remark_on_tolerance, remarks_on_wishes};
use crate::base::cpu::ThreadClock;
use crate::mbs::contact::Settings;
use crate::mbs::error::SolveError;
use crate::mbs::ideal;
use crate::mbs::model::Model;
use crate::mbs::result::RunResult;
use crate::mbs::tables::Tables;

/// Options that are not part of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverOptions {
    /// Relative energy error above which the run stops.
    pub energy_limit: f64,
    /// How contacts are searched.
    pub contact: Settings,
    /// Whether a run with the automatic step is repeated with half and a quarter of it where its energies grow, or where it stops for its energies or a contact that will not hold; one with ideal joints or forces
    /// and steps of the leapfrog for a coarse tolerance once with steps of Runge and Kutta.
    pub repeat: bool,
    /// Whether latent bushings hold whatever they would have to bear, and no event rule is asked: for comparison only.
    pub hold_latent: bool,
    /// Whether latent bushings that are watched are looked at in every step, also where a bound of their loads tells that nothing can part: the same result.
    pub look_always: bool,
    /// Whether histories of poses, hinges and crushed ends may be left out of the result, which is the same otherwise.
    pub brief: bool,
}

impl Default for SolverOptions {
    fn default() -> Self {
        Self {
            energy_limit: 0.1,
            contact: Settings::default(),
            repeat: false,
            hold_latent: false,
            look_always: false,
            brief: false,
        }
    }
}

/// Checks and runs a model.
pub fn simulate(model: &Model) -> Result<RunResult, SolveError> {
    simulate_with(model, &SolverOptions::default())
}

/// Checks and runs a model, and again with smaller steps where its energies do not hold ([`SolverOptions::repeat`]).
pub fn simulate_carefully(model: &Model) -> Result<RunResult, SolveError> {
    simulate_with(model, &SolverOptions { repeat: true, ..SolverOptions::default() })
}

/// Checks and runs a model with options.
pub fn simulate_with(model: &Model, options: &SolverOptions) -> Result<RunResult, SolveError> {
    model.check()?;
    simulate_checked(model, options, &Tables::default())
}

/// Runs a model whose curves are right and partly compiled.
pub(in crate::mbs) fn simulate_varied(
    model: &Model,
    options: &SolverOptions,
    known: &Tables,
) -> Result<RunResult, SolveError> {
    model.check_varied()?;
    simulate_checked(model, options, known)
}

fn simulate_checked(model: &Model, options: &SolverOptions, known: &Tables) -> Result<RunResult, SolveError> {
    let clock = ThreadClock::start();
    let may_repeat = options.repeat && model.settings.time_step_s.is_none();
    let outcome = if model.is_ideal() {
        ideally(model, options, may_repeat)
    } else if model.is_unconnected() && !model.may_touch() {
        ideal::run::simulate(&for_free_flight(model), options)
    } else if model.is_unconnected() && model.bodies.len() <= FEW {
        ideally(model, options, may_repeat)
    } else {
        freely(model, options, may_repeat, known)
    };
    let mut result = outcome?;
    result.cpu_s = clock.elapsed_s();
    Ok(result)
}

/// A result, or why there is none.
type Outcome = Result<RunResult, SolveError>;

/// Smallest share of the automatic step with which a run is repeated.
const LEAST_SHARE: f64 = 0.25;
/// Tolerance with which a run of the leapfrog on ideal joints is repeated.
const FINER_TOLERANCE: f64 = 0.1 * ideal::COARSE;
/// Growth of the energies above which a run with the automatic step is repeated with half of it. Impacts load stiff joints within a step; what that makes falls with the step (random buildings of `bench buildings`: 1.7e-2, 2.7e-3 and
/// 6.9e-4 at 1, 0.4 and 0.2 ms), which nothing tells before the impact. Energy that is lost instead is only told.
pub(super) const GROWTH: f64 = 1e-3;
/// Error of the energies, growth or loss, from which it is repeated as well: as much as a validation allows.
const LOSS: f64 = 0.02;

/// How the remark about a repeated run begins.
pub const REPEATED: &str = "repeated with";

/// Bodies without connections up to which impacts are located in time: a step of the leapfrog spreads a blow over itself, to first order (a column that rocks loses a third too much in a step of 1 ms). Ten cubes on each other take three times as long with impacts located, 64 that come down five times.
const FEW: usize = 8;
/// What steps of free flight may be off by, as a share of the tolerance: nothing stops what they add up to over thousands of turns. A body that tumbles at 50 rad/s is off by 1.7 degrees after 20 s with all of it and by 0.01 with this, in twice the time in which a leapfrog of 1 ms is off by 0.9; at 3 rad/s by 5e-6 in a third of the time, for 0.003.
const FREE_FLIGHT: f64 = 0.01;
/// No steps are nearer than that.
const LEAST_TOLERANCE: f64 = 1e-12;

/// A model of bodies that turn freely, with the tolerance that they need.
fn for_free_flight(model: &Model) -> Model {
    let mut model = model.clone();
    let given = model.settings.tolerance;
    model.settings.tolerance = given.min((FREE_FLIGHT * given).max(LEAST_TOLERANCE));
    model
}

/// A run of bushings alone.
fn freely(model: &Model, options: &SolverOptions, may_repeat: bool, known: &Tables) -> Outcome {
    let (mut share, mut outcome) = (1.0, once(model, options, (1.0, known)));
    while may_repeat && share > LEAST_SHARE && is_too_coarse(&outcome) {
        share *= 0.5;
        let with = format!("{share} of the automatic step: with a longer one");
        outcome = better(outcome, once(model, options, (share, known)), &with);
    }
    outcome
}

/// A run with ideal joints or forces. Where a coarse tolerance allows steps in which stiff springs are not resolved, and their vibrations are most of the energy, the leapfrog's balance does not hold.
fn ideally(model: &Model, options: &SolverOptions, may_repeat: bool) -> Outcome {
    let outcome = ideal::run::simulate(model, options);
    if !may_repeat || model.settings.tolerance < ideal::COARSE || !is_too_coarse(&outcome) {
        return outcome;
    }
    let mut finer = model.clone();
    finer.settings.tolerance = FINER_TOLERANCE;
    let after = ideal::run::simulate(&finer, options);
    better(outcome, after, &format!("a tolerance of {FINER_TOLERANCE:e}: with a larger one"))
}

/// A run with a share of the automatic step, and tables that are known.
fn once(model: &Model, options: &SolverOptions, (share, known): (f64, &Tables)) -> Outcome {
    let mut run = Run::new(model, options, (share, known))?;
    run.result.warnings.extend(run.remark_on_start());
    run.go()?;
    run.result.contact_work = run.contacts.work.into();
    let remarks = closing_remarks(&run.books, Some(run.contacts.work), FINER);
    run.result.warnings.extend(remarks_on_wishes(model));
    run.result.warnings.extend(remark_on_tolerance(model));
    run.result.warnings.extend(remark_on_levels(&run.beyond_levels));
    run.result.warnings.extend(run.overturned.remark());
    run.result.warnings.extend(remarks);
    run.result.warnings.splice(0..0, run.remark_on_held());
    run.close_latent();
    run.result.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    Ok(run.result)
}

/// How far the energies of a run are off, over what they may be without another one.
fn coarseness(result: &RunResult) -> f64 {
    (result.energy_growth / GROWTH).max(result.energy_error / LOSS)
}

/// Whether a smaller step may help.
fn is_too_coarse(outcome: &Outcome) -> bool {
    match outcome {
        Ok(result) => coarseness(result) > 1.0,
        Err(why) => matches!(
            why,
            SolveError::Energy { .. }
                | SolveError::Locked { .. }
                | SolveError::ContactEnergy { .. }
                | SolveError::Penetration { .. }
        ),
    }
}

/// The one of two runs whose energies are less off, the later one `with` what is told.
fn better(before: Outcome, after: Outcome, with: &str) -> Outcome {
    let told = |was: String| format!("{REPEATED} {with} {was}");
    match (before, after) {
        (Ok(coarse), Ok(mut result)) if coarseness(&result) < coarseness(&coarse) => {
            let how = match (coarse.energy_growth, coarse.energy_error) {
                (grew, _) if grew > GROWTH => format!("energies grew by {grew:.1e} of what is turned over"),
                (_, off) => format!("energies were off by {off:.1e} of what is turned over"),
            };
            result.warnings.push(told(how));
            Ok(result)
        }
        (Err(why), Ok(mut result)) => {
            result.warnings.push(told(format!("it stopped ({why})")));
            Ok(result)
        }
        (before, _) => before,
    }
}
