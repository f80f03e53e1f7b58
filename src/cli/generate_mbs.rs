//! `fallwerk generate-mbs`: from a building to an MBS model, its run and, with `--validate`, the comparison with FE.

use super::compose::{self, Against, Pieces};
use super::explain::TraceFile;
use super::fe_places::unwritable;
use super::knowledge::{CurveArgs, LatentArgs, StepArgs};
use super::progress::Progress;
use super::summary::{Summary, as_json, as_text};
use super::{Failure, Outcome, fe, fe_hybrid, print, read_building, simulate, thread_pool, write};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::median::median;
use crate::base::output::{OutputError, OutputFolder};
use crate::base::results::{Results, VALIDATION_FILE};
use crate::building::Building;
use crate::fe::hybrid::HybridSettings;
use crate::fe::result::FeRun;
use crate::fe::run::{Attached, FeOptions};
use crate::generate::{GenerateError, Generated, Generator};
use crate::mbs::{RunResult, SolveError, SolverOptions, simulate_with};
use crate::review::{self, Review};
use crate::study::{Facts, Study, facts};
use crate::validate::Validation;
use crate::validate::spread::{Spread, nudged};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs of the MBS over which its run time is the median: one run takes some ten milliseconds, in which the scheduler counts.
pub const MBS_RUNS: usize = 3;

/// Generate the MBS model of a building, run it and compare it with FE
///
/// Rules decide which members become rigid bodies and where hinges stand; the library holds the hinges' resistance curves.
/// Writes model.json, trace.json, review.json (decisions worth a look), mbs.json, histories as CSV and report.html, a page of the MBS run with plots and
/// a 3D view, into a result folder; with --validate also fe.json, study.json and validation.json, and the report compares
/// both runs; with --validate --hybrid the FE run with rigid parts as well, hybrid.json, and the report compares all three.
/// Run times are in validation.json and report.html only: all other files
/// are the same for the same input, whatever the number of threads.
/// Exit codes: 0 done (with --validate: the MBS agrees with FE), 1 it does not, or the runs do not tell, or a run stopped, 2 bad input.
#[derive(clap::Args)]
pub struct Arguments {
    /// The building file
    building: PathBuf,
    /// Result folder [default: out/NAME]; one of an earlier run is replaced
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Run FE as well and compare
    #[arg(long)]
    validate: bool,
    #[command(flatten)]
    hybrid: fe_hybrid::Options,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Turn decisions worth a look round, one in each of at most N further runs, and sort them by what that changes [default: 40]
    #[arg(long, value_name = "N", num_args = 0..=1, require_equals = true, default_missing_value = "40", conflicts_with = "latent", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    review: Option<u32>,
    #[command(flatten)]
    curves: CurveArgs,
    #[command(flatten)]
    latent: LatentArgs,
    #[command(flatten)]
    step: StepArgs,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Replace the results of a run with --validate by those of one without
    #[arg(long)]
    force: bool,
}

/// The FE side of a run with `--validate`.
pub struct Comparison {
    /// The FE run.
    pub fe: FeRun,
    /// The FE run with rigid parts, if it was asked for.
    pub hybrid: Option<FeRun>,
    /// Its facts.
    pub facts: Facts,
    /// Errors of the MBS against it.
    pub validation: Validation,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    super::failing(arguments.json, attempt(arguments))
}

fn attempt(arguments: &Arguments) -> Result<Outcome, Failure> {
    let building = read_building(&arguments.building, arguments.json)?;
    let hybrid = arguments.hybrid.settings(&building, None, arguments.curves.places())?;
    if hybrid.is_some() && !arguments.validate {
        return Err(Failure::input(
            "--hybrid compares the FE run with rigid parts: give --validate as well".into(),
        ));
    }
    let target = arguments.output.clone().unwrap_or_else(|| super::default_output(&building, ""));
    let output = result_folder(arguments, &target)?;
    let pool = thread_pool(arguments.threads)?;
    let progress = Progress::on_stderr();
    let result = pool.install(|| compute(arguments, &building, hybrid, &output, &progress));
    progress.finish();
    let (computed, stopped) = result?;
    // an earlier validation is worth more than a model alone
    if let Some(failure) = stopped.as_ref().filter(|_| target.join(VALIDATION_FILE).exists()) {
        return Err(failure.clone());
    }
    let folder = output.commit().map_err(|e| unwritable(&e))?;
    if let Some(failure) = stopped {
        let message =
            format!("{}\n  = note: the model and its MBS run are in {}", failure.message, folder.display());
        return Err(Failure { message, ..failure });
    }
    let summary = Summary {
        building: &building,
        generated: &computed.generated,
        review: &computed.review,
        mbs: &computed.mbs,
        spread: computed.spread.as_ref(),
        comparison: computed.comparison.as_ref(),
        folder: &folder,
    };
    print(&if arguments.json { format!("{:#}\n", as_json(&summary)) } else { as_text(&summary) });
    let agrees = computed.comparison.as_ref().is_none_or(|c| c.validation.agrees());
    Ok(if agrees { Outcome::Done } else { Outcome::CheckFailed })
}

/// The folder for the results. A validation takes long; a quick run without one does not replace it unasked.
fn result_folder(arguments: &Arguments, target: &Path) -> Result<OutputFolder, Failure> {
    let replaces_validation = arguments.validate || arguments.force;
    let results = if replaces_validation { Results::Validation } else { Results::Model };
    OutputFolder::create(target, results).map_err(|error| {
        let Failure { mut message, outcome } = unwritable(&error);
        if matches!(error, OutputError::OtherResults { results: Results::Validation, .. }) {
            message += "\n  = help: --force replaces them, --output names another folder";
        }
        Failure { message, outcome }
    })
}

struct Computed {
    generated: Generated,
    review: Review,
    mbs: RunResult,
    spread: Option<Spread>,
    comparison: Option<Comparison>,
}

/// A model with its runs.
struct Made {
    generated: Generated,
    review: Review,
    /// Of the building.
    hash: String,
    runs: Vec<RunResult>,
    wall_s: f64,
}

/// Generates a model and runs it, and writes each file as soon as it is known. The library is open to others again afterwards.
fn make(
    arguments: &Arguments,
    building: &Building,
    output: &OutputFolder,
    progress: &Progress,
) -> Result<Made, Failure> {
    let (rules, mut store) = arguments.curves.open()?;
    progress.stage("generating the model");
    let failed = |e: GenerateError| Failure::input(e.to_string());
    let mut generator =
        Generator::of(building, &rules, &mut store, arguments.curves.wishes()).map_err(failed)?;
    let mut generated = generator.model(&building.overrides, &|text| progress.note(text)).map_err(failed)?;
    arguments.step.set(&mut generated.model);
    let hash = ContentHash::of_value(building).map_err(|e| Failure::input(e.to_string()))?.to_string();
    write_json(output, "model.json", &generated.model)?;
    write_json(output, "trace.json", &TraceFile::of(building, &hash, &generated))?;
    let (runs, wall_s) = run_mbs(&generated, &arguments.latent.options())
        .map_err(|failure| with_notes(failure, &generated.notes))?;
    let mbs = &runs[0];
    write_mbs(output, mbs)?;
    let review = match arguments.review {
        None => review::listed(building, &generated),
        Some(runs) => {
            progress.stage("turning decisions round");
            review::measured(building, &mut generator, &generated, mbs, runs as usize)
        }
    };
    write_json(output, "review.json", &review)?;
    Ok(Made { generated, review, hash, runs, wall_s })
}

/// Makes a model, and compares it if that is asked for. Where the FE run stops the model stands without a comparison, and why is told.
fn compute(
    arguments: &Arguments,
    building: &Building,
    hybrid: Option<HybridSettings>,
    output: &OutputFolder,
    progress: &Progress,
) -> Result<(Computed, Option<Failure>), Failure> {
    let made = make(arguments, building, output, progress)?;
    let compared = arguments.validate.then(|| compare(building, hybrid, &made, (output, progress)));
    let (comparison, stopped) = match compared {
        None => (None, None),
        Some(Ok(comparison)) => (Some(comparison), None),
        Some(Err(failure)) => (None, Some(failure)),
    };
    let spread = match &comparison {
        Some(comparison) => comparison.validation.spread.clone(),
        None => Spread::of(&made.runs),
    };
    let written = write_report(output, &pieces(building, &made, spread.as_ref(), comparison.as_ref()));
    let stopped = stopped.or(written.err());
    let Made { generated, review, mut runs, .. } = made;
    Ok((Computed { generated, review, mbs: runs.swap_remove(0), spread, comparison }, stopped))
}

/// Runs the FE model and compares the runs of a model with it.
fn compare(
    building: &Building,
    hybrid: Option<HybridSettings>,
    made: &Made,
    (output, progress): (&OutputFolder, &Progress),
) -> Result<Comparison, Failure> {
    let Made { generated, hash, runs, wall_s, .. } = made;
    let (mbs, spread) = (&runs[0], Spread::of(runs));
    let fe_run = |hybrid: Option<HybridSettings>, name: &str| {
        let options = FeOptions { keep_frames: true, hybrid, ..FeOptions::default() };
        let run = fe::run_with_progress(building, &options, Attached::default(), &|| (), progress)?;
        fe::write(output, building, &run, building.settings.mesh_size_m, name).map(|()| run)
    };
    let fe = fe_run(None, "fe")?;
    let hybrid = hybrid.map(|settings| fe_run(Some(settings), "hybrid")).transpose()?;
    let facts = facts(building, &fe);
    let mut validation = Validation::of(building, &fe, &facts, &generated.model, mbs, *wall_s);
    validation.spread = spread.map(|s| s.against(&fe, runs));
    if let Some(run) = &hybrid {
        validation.add_hybrid(&fe, run);
    }
    let study = Study::new(&building.name, hash.clone(), building.settings.mesh_size_m, &fe, facts.clone());
    write_json(output, "study.json", &study)?;
    write_json(output, VALIDATION_FILE, &validation)?;
    Ok(Comparison { fe, hybrid, facts, validation })
}

/// What the report is made of.
fn pieces<'a>(
    building: &'a Building,
    made: &'a Made,
    spread: Option<&'a Spread>,
    comparison: Option<&'a Comparison>,
) -> Pieces<'a> {
    Pieces {
        building,
        generated: &made.generated,
        review: &made.review,
        mbs: &made.runs[0],
        mbs_wall_s: made.wall_s,
        mbs_runs: MBS_RUNS,
        spread,
        against: comparison.map(|c| Against {
            fe: &c.fe,
            hybrid: c.hybrid.as_ref(),
            facts: &c.facts,
            validation: &c.validation,
            threads: rayon::current_num_threads(),
        }),
    }
}

fn write_report(output: &OutputFolder, pieces: &Pieces) -> Result<(), Failure> {
    let page =
        crate::report::render(&compose::report_input(pieces)).map_err(|e| Failure::stopped(e.to_string()))?;
    write(output, "report.html", &page)
}

/// A run that stopped, with what an analyst should look at: one of it may be why.
fn with_notes(failure: Failure, notes: &[String]) -> Failure {
    let message = notes.iter().fold(failure.message, |all, note| format!("{all}\n  = note: {note}"));
    Failure { message, ..failure }
}

/// Runs the model and, with gravity changed by next to nothing, some more times; the first result carries the median processor time. Also returns the median wall time \[s\].
fn run_mbs(generated: &Generated, options: &SolverOptions) -> Result<(Vec<RunResult>, f64), Failure> {
    let (mut wall_s, mut runs) = (Vec::new(), Vec::new());
    for k in 0..MBS_RUNS {
        let model = nudged(&generated.model, k as f64);
        let began = Instant::now();
        match simulate_with(&model, options) {
            Ok(run) => runs.push(run),
            // the generator asks for no step: this one is of the command line
            Err(e @ SolveError::TimeStep { .. }) if k == 0 => {
                return Err(Failure::input(format!("the MBS run: {e}")));
            }
            Err(e) if k == 0 => return Err(Failure::stopped(format!("the MBS run: {e}"))),
            // what a change of rounding runs into is no reason to withhold the run
            Err(_) => continue,
        }
        wall_s.push(began.elapsed().as_secs_f64());
    }
    runs[0].cpu_s = median(runs.iter().map(|r| r.cpu_s).collect());
    Ok((runs, median(wall_s)))
}

/// The run without its processor time, which differs from run to run.
fn write_mbs(output: &OutputFolder, mbs: &RunResult) -> Result<(), Failure> {
    write_json(output, "mbs.json", &RunResult { cpu_s: 0.0, ..mbs.clone() })?;
    write(output, "mbs-displacements.csv", &simulate::displacements_csv(mbs))?;
    write(output, "mbs-hinges.csv", &simulate::hinges_csv(mbs))?;
    write(output, "mbs-energies.csv", &simulate::energies_csv(mbs))
}

fn write_json<T: serde::Serialize>(output: &OutputFolder, name: &str, value: &T) -> Result<(), Failure> {
    let text = readable_json(value).map_err(|e| Failure::input(format!("{name}: {e}")))?;
    write(output, name, &text)
}
