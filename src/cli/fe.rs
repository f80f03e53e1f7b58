//! `fallwerk fe`: the FE run of a building alone, or of a keyword deck.

use super::progress::Progress;
use super::verdict::{collapse_words, percent, seconds};
use super::{Failure, Outcome, print, read_building, thread_pool};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::output::OutputFolder;
use crate::building::Building;
use crate::building::partition::Partition;
use crate::fe::deck::is_deck;
use crate::fe::dynamics::Death;
use crate::fe::result::{FeRun, FeSummary};
use crate::fe::run::{FeOptions, run as run_fe};
use crate::study::{COLLAPSE_DROP_M, facts};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Version of `fe.json`.
pub const FE_SCHEMA: u32 = 1;
/// Most elements that a mesh size from the command line may lead to: beyond it a run takes weeks and the mesh tens of
/// gigabytes.
const MOST_ELEMENTS: f64 = 5e6;
/// Longest simulated time \[s\].
const LONGEST_S: f64 = 60.0;

/// Run the finite element model of a building, or a keyword deck
///
/// Writes fe.json and histories as CSV into a result folder. The same input gives the same files, whatever the number
/// of threads; run times are printed and not stored. A file that ends in .k, .key or .dyn, or that begins with a keyword,
/// is read as a deck of LS-DYNA form (docs/decks.md lists the keywords).
/// Exit codes: 0 done, 1 the run stopped, 2 bad input.
#[derive(clap::Args)]
pub struct Arguments {
    /// The building file or the deck
    #[arg(value_name = "BUILDING|DECK")]
    pub(super) building: PathBuf,
    /// Result folder [default: out/NAME-fe]
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    /// Target edge length of the elements in metres, instead of the building's
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub(super) mesh_size: Option<f64>,
    /// Simulated time in seconds, instead of the building's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) end_time: Option<f64>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Write the FE model as a keyword deck into this file instead of running it
    #[arg(long, value_name = "FILE")]
    pub(super) write_deck: Option<PathBuf>,
    /// Leave keywords of a deck that are not known out, with a note, instead of refusing them
    #[arg(long)]
    pub(super) skip_unknown: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    if is_deck(&arguments.building) {
        return super::fe_deck::run(arguments);
    }
    let building = read_building(&arguments.building, arguments.json)?;
    let options = options(arguments, &building)?;
    if let Some(path) = &arguments.write_deck {
        return super::fe_deck::write_building(&building, options.mesh_size_m, path);
    }
    let target = arguments.output.clone().unwrap_or_else(|| super::default_output(&building, "-fe"));
    let output = OutputFolder::create(&target).map_err(|e| Failure::input(e.to_string()))?;
    let progress = Progress::on_stderr();
    let pool = thread_pool(arguments.threads)?;
    let fe = pool.install(|| run_with_progress(&building, &options, &progress)).map_err(Failure::stopped)?;
    progress.finish();
    let mesh_size_m = options.mesh_size_m.unwrap_or(building.settings.mesh_size_m);
    write(&output, &building, &fe, mesh_size_m)?;
    let folder = output.commit().map_err(|e| Failure::input(e.to_string()))?;
    let collapsed = fe.tracked.iter().any(|h| h.displacement_m.iter().any(|u| -u[2] > COLLAPSE_DROP_M));
    if arguments.json {
        let mut value = json!(fe.summary);
        value["building"] = json!(building.name);
        value["collapsed"] = json!(collapsed);
        value["output"] = json!(folder);
        print(&format!("{value:#}\n"));
        return Ok(Outcome::Done);
    }
    print(&format!(
        "{}: {} in the FE run\n{}  results: {}\n",
        building.name,
        collapse_words(collapsed),
        zones_words(&building, &fe) + &summary(&fe.summary),
        folder.display()
    ));
    Ok(Outcome::Done)
}

fn options(arguments: &Arguments, building: &Building) -> Result<FeOptions, Failure> {
    let mesh_size_m = positive("--mesh-size", arguments.mesh_size)?;
    let end_time_s = end_time(arguments)?;
    let volume: f64 = Partition::of(building).volumes(building.members.len()).iter().sum();
    if let Some(size) = mesh_size_m.filter(|size| volume / size.powi(3) > MOST_ELEMENTS) {
        let least = (volume / MOST_ELEMENTS).cbrt();
        return Err(Failure::input(format!(
            "--mesh-size {size} is too fine for this building; the least is about {least:.3} m"
        )));
    }
    if let Some(end) = end_time_s.filter(|end| *end > LONGEST_S) {
        return Err(Failure::input(format!("--end-time is {end} s, the longest is {LONGEST_S} s")));
    }
    Ok(FeOptions { mesh_size_m, end_time_s })
}

/// The simulated time asked for \[s\].
pub(super) fn end_time(arguments: &Arguments) -> Result<Option<f64>, Failure> {
    positive("--end-time", arguments.end_time)
}

fn positive(name: &str, value: Option<f64>) -> Result<Option<f64>, Failure> {
    match value {
        Some(x) if !(x > 0.0 && x.is_finite()) => {
            Err(Failure::input(format!("{name} is {x}, expected a positive number")))
        }
        other => Ok(other),
    }
}

/// Runs the FE model and shows how far it is.
pub fn run_with_progress(
    building: &Building,
    options: &FeOptions,
    progress: &Progress,
) -> Result<FeRun, String> {
    progress.stage("FE run: dead load");
    let mut began = false;
    run_fe(building, options, &mut |at| {
        if !began {
            progress.stage("FE run");
            began = true;
        }
        progress.advance(at.time_s / at.end_s, &format!("t = {:.2} of {:.2} s", at.time_s, at.end_s));
    })
    .map_err(|e| e.to_string())
}

/// `fe.json` and the histories as CSV.
pub fn write(
    output: &OutputFolder,
    building: &Building,
    fe: &FeRun,
    mesh_size_m: f64,
) -> Result<(), Failure> {
    let text = |value: &Value| readable_json(value).map_err(|e| Failure::input(e.to_string()));
    super::write(output, "fe.json", &text(&record(building, fe, mesh_size_m)?)?)?;
    super::write(output, "fe-displacements.csv", &displacements_csv(fe))?;
    super::write(output, "fe-energies.csv", &energies_csv(fe))
}

/// What `fe.json` holds: everything of the run but frames, strain rates and run times.
fn record(building: &Building, fe: &FeRun, mesh_size_m: f64) -> Result<Value, Failure> {
    let hash = ContentHash::of_value(building).map_err(|e| Failure::input(e.to_string()))?;
    let mut summary = json!(fe.summary);
    if let Some(members) = summary.as_object_mut() {
        members.remove("elapsed");
    }
    let deaths = |cause: Death| fe.deaths.iter().filter(|d| d.cause == cause).count();
    let snapped: Vec<Value> =
        fe.snapped.iter().map(|s| json!({ "member": s.member, "volume_ratio": s.volume_ratio })).collect();
    Ok(json!({
        "schema": FE_SCHEMA,
        "building": building.name,
        "building_hash": hash.to_string(),
        "program_version": env!("CARGO_PKG_VERSION"),
        "mesh_size_m": mesh_size_m,
        "summary": summary,
        "snapped": snapped,
        "deaths": {
            "eroded": deaths(Death::Eroded),
            "collapsed": deaths(Death::Collapsed),
            "removed": deaths(Death::Removed),
        },
        "touches": fe.touches,
        "times_s": fe.times_s,
        "tracked": fe.tracked,
        "energies": fe.energies,
    }))
}

/// Displacements of the tracked points, columns `time_s, <id>_x_m, ...`.
pub fn displacements_csv(fe: &FeRun) -> String {
    let mut text = String::from("time_s");
    for point in &fe.tracked {
        let _ = write!(text, ",{0}_x_m,{0}_y_m,{0}_z_m", point.id);
    }
    text.push('\n');
    for (i, time) in fe.times_s.iter().enumerate() {
        let _ = write!(text, "{time}");
        for u in fe.tracked.iter().flat_map(|p| p.displacement_m[i]) {
            let _ = write!(text, ",{u}");
        }
        text.push('\n');
    }
    text
}

/// The energy balance.
pub fn energies_csv(fe: &FeRun) -> String {
    let mut text = String::from(
        "time_s,kinetic_j,internal_j,eroded_j,hourglass_j,viscous_j,gravity_j,contact_j,friction_j,removed_j,residual_j\n",
    );
    for (time, e) in fe.times_s.iter().zip(&fe.energies) {
        let _ = writeln!(
            text,
            "{time},{},{},{},{},{},{},{},{},{},{}",
            e.kinetic_j,
            e.internal_j,
            e.eroded_j,
            e.hourglass_j,
            e.viscous_j,
            e.gravity_j,
            e.contact_j,
            e.friction_j,
            e.removed_j,
            e.residual_j
        );
    }
    text
}

fn zones_words(building: &Building, fe: &FeRun) -> String {
    let facts = facts(building, fe);
    let zones: Vec<&str> = facts.ends.iter().filter(|z| z.first_s.is_some()).map(|z| z.id.as_str()).collect();
    format!("  member ends above the critical strain rate: {} of {}\n", zones.len(), facts.ends.len())
}

fn summary(s: &FeSummary) -> String {
    format!(
        "  {} elements, {} nodes, {:.2} t; {} steps of {:.3} ms\n  \
         first ground contact: {}\n  eroded elements: {}\n  \
         energy error {}, hourglass share {}\n  run time: {:.1} s wall, {:.1} s processor\n",
        s.elements,
        s.nodes,
        s.mass_kg / 1e3,
        s.steps,
        1e3 * s.time_step_s,
        seconds(s.first_ground_contact_s),
        s.eroded_elements,
        percent(s.energy_error),
        percent(s.hourglass_share),
        s.elapsed.wall_s,
        s.elapsed.cpu_s,
    )
}
