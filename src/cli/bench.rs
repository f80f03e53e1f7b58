//! `fallwerk bench`: measurements of the solvers.

use super::progress::Progress;
use super::{
    Failure, Outcome, bench_buildings, bench_generate, bench_tradeoff, print, read_building, thread_pool,
};
use crate::base::output::write_atomic;
use crate::bench::{fe, fe_error, fe_stability, mbs, mbs_stability};
use crate::report::loglog::{self, Line, Panel};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Measure the solvers: throughput, error over run time, stability
///
/// Exit codes: 0 done, 1 a run went wrong, 2 bad usage.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand)]
enum What {
    /// Element-cycles per second of a block of hexahedra, beside the memory bandwidth
    Fe(Throughput),
    /// Error of a building's run over mesh sizes, against the finest
    FeError(ErrorRuns),
    /// Runs at and beyond the limits of the method; exit code 1 if one goes wrong without a diagnosis
    FeStability(Stability),
    /// Error and run time of mechanisms whose motion is known, by the error tolerance of a step
    Mbs(Mechanisms),
    /// Multibody runs at and beyond the limits, and random hinge structures; exit code 1 if one goes wrong without a diagnosis
    MbsStability(MbsStability),
    /// Generated models of random small buildings, run to rest; exit code 1 if one does not hold
    Buildings(bench_buildings::Arguments),
    /// Time of generation over the number of members, stage by stage
    Generate(bench_generate::Arguments),
    /// Run time against error: MBS at each level of detail, hybrid and FE at several meshes, against the finest FE run of each building
    Tradeoff(bench_tradeoff::Arguments),
}

#[derive(clap::Args)]
struct MbsStability {
    /// Random structures
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(0..=10_000_000))]
    random: u64,
    /// Print the model file of the random structure with this seed, and run nothing
    #[arg(long, value_name = "SEED")]
    seed: Option<u64>,
    /// Folder for mbs-stability.md
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(clap::Args)]
struct Mechanisms {
    /// Error tolerances of a step
    #[arg(long, value_delimiter = ',', default_value = "1e-4,1e-5,1e-6,1e-7,1e-8")]
    tolerances: Vec<f64>,
    /// Only mechanisms whose name contains this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct Throughput {
    /// Elements, about
    #[arg(long, value_name = "N", default_value_t = 85_000, value_parser = clap::value_parser!(u32).range(1..=20_000_000))]
    elements: u32,
    /// Time steps a repetition
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    cycles: u32,
    /// Threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Element form
    #[arg(long, default_value = "asqbi")]
    form: String,
    /// Whether the elements flow
    #[arg(long, default_value = "flowing", value_parser = ["flowing", "elastic"])]
    state: String,
    /// Instruction set: avx512, avx2 or portable [default: the fastest that the processor has]
    #[arg(long, value_name = "ISA")]
    isa: Option<String>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

#[derive(clap::Args)]
struct ErrorRuns {
    /// The building file
    #[arg(long, default_value = "buildings/three-storey-frame.toml")]
    building: PathBuf,
    /// Mesh sizes in metres
    #[arg(long, value_delimiter = ',', default_value = "0.6,0.5,0.4,0.3,0.25")]
    sizes: Vec<f64>,
    /// Folder for fe-error.md and fe-error.svg
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(clap::Args)]
struct Stability {
    /// Folder for fe-stability.md
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    match &arguments.what {
        What::Fe(options) => throughput(options),
        What::FeError(options) => error_runs(options),
        What::FeStability(options) => stability(options),
        What::Mbs(options) => mechanisms(options),
        What::MbsStability(options) => mbs_stability_runs(options),
        What::Buildings(options) => bench_buildings::run(options),
        What::Generate(options) => bench_generate::run(options),
        What::Tradeoff(options) => bench_tradeoff::run(options),
    }
}

fn mechanisms(options: &Mechanisms) -> Result<Outcome, Failure> {
    if let Some(bad) = options.tolerances.iter().find(|t| !(**t >= 1e-13 && **t <= 0.1)) {
        return Err(Failure::input(format!("--tolerances: {bad:e} is not between 1e-13 and 0.1")));
    }
    let rows = mbs::measure(&options.tolerances, &options.only).map_err(Failure::stopped)?;
    if rows.is_empty() {
        let names: Vec<&str> = crate::verify::mbs::known().iter().map(|k| k.name).collect();
        let message =
            format!("no mechanism's name contains `{}`; there are: {}", options.only, names.join(", "));
        return Err(Failure::input(message));
    }
    if options.json {
        let text = serde_json::to_string_pretty(&rows).map_err(|e| Failure::stopped(e.to_string()))?;
        print(&(text + "\n"));
    } else {
        print(&mbs::table(&rows));
    }
    Ok(Outcome::Done)
}

fn mbs_stability_runs(options: &MbsStability) -> Result<Outcome, Failure> {
    if let Some(seed) = options.seed {
        let model = crate::bench::mbs_trials::random(seed);
        print(&(serde_json::to_string_pretty(&model).map_err(|e| Failure::stopped(e.to_string()))? + "\n"));
        return Ok(Outcome::Done);
    }
    let pool = thread_pool(options.threads)?;
    let progress = Progress::on_stderr();
    progress.stage("runs at the limits");
    let rows = pool.install(mbs_stability::measure);
    progress.stage("random structures");
    let through = AtomicU64::new(0);
    let tell = || {
        let done = through.fetch_add(1, Ordering::Relaxed) + 1;
        progress.advance(done as f64 / options.random as f64, "");
    };
    let sweep = pool.install(|| mbs_stability::sweep(options.random, &tell));
    progress.finish();
    let page = mbs_stability::markdown(&rows, &sweep);
    save(options.output.as_deref(), &[("mbs-stability.md", &page)])?;
    print(&page);
    let holds = rows.iter().all(mbs_stability::Row::holds) && sweep.counts[2] == 0;
    Ok(if holds { Outcome::Done } else { Outcome::CheckFailed })
}

fn throughput(options: &Throughput) -> Result<Outcome, Failure> {
    let settings = fe::Settings {
        elements: options.elements as usize,
        cycles: options.cycles as usize,
        threads: usize::from(options.threads),
        form: super::fe::form_named(&options.form)?,
        flowing: options.state == "flowing",
        isa: super::fe::instruction_set(options.isa.as_deref())?,
    };
    let pool = thread_pool(Some(options.threads))?;
    let t = pool.install(|| fe::measure(&settings)).map_err(Failure::stopped)?;
    if options.json {
        let text = serde_json::to_string_pretty(&t).map_err(|e| Failure::stopped(e.to_string()))?;
        print(&(text + "\n"));
        return Ok(Outcome::Done);
    }
    print(&format!(
        "{:.2} million element-cycles/s: {} elements, {} cycles, {} thread(s), {}, {:.0} % flow\n  \
         {:.0} bytes and {:.0} operations an element-cycle: {:.1} GB/s, {:.2} Gflop/s\n  \
         triad {:.1} GB/s: {:.2} of the floor\n  {}\n",
        1e-6 * t.element_cycles_per_s,
        t.elements,
        t.cycles,
        t.threads,
        t.isa.name(),
        100.0 * t.flowing_share,
        t.bytes_per_element_cycle,
        t.flops_per_element_cycle,
        1e-9 * t.bytes_per_element_cycle * t.element_cycles_per_s,
        1e-9 * t.flops_per_element_cycle * t.element_cycles_per_s,
        1e-9 * t.triad_bytes_per_s,
        t.share_of_floor,
        t.machine,
    ));
    Ok(Outcome::Done)
}

/// Mesh sizes are lengths.
pub(super) fn check_sizes(sizes: &[f64]) -> Result<(), Failure> {
    match sizes.iter().find(|s| !(**s > 0.0 && s.is_finite())) {
        Some(bad) => Err(Failure::input(format!("--sizes: {bad} is not a positive length in metres"))),
        None => Ok(()),
    }
}

fn error_runs(options: &ErrorRuns) -> Result<Outcome, Failure> {
    check_sizes(&options.sizes)?;
    let building = read_building(&options.building, false)?;
    let note = |size: f64| eprintln!("mesh size {size} m");
    let pool = thread_pool(options.threads)?;
    let rows =
        pool.install(|| fe_error::measure(&building, &options.sizes, &note)).map_err(Failure::stopped)?;
    let page = fe_error::markdown(&building.name, &rows, &fe::machine());
    let line = |(colour, dashed): (usize, bool), name: &str, value: fn(&fe_error::Row) -> f64| {
        let points = rows.iter().map(|r| [r.cpu_s, value(r)]).collect();
        let size = |r: &fe_error::Row| if dashed { String::new() } else { format!("{} m", r.size_m) };
        Line { name: name.into(), points, colour, dashed, labels: rows.iter().map(size).collect() }
    };
    let lines = vec![
        line((0, false), "up to the first contact, with mesh sizes", |r| r.e_to_contact),
        line((1, true), "whole run (hollow)", |r| r.e_total),
    ];
    let title = format!("{}: error against the finest mesh", building.name);
    let plot =
        loglog::svg(["processor time [s]", "relative error of displacements"], &[Panel { title, lines }]);
    save(options.output.as_deref(), &[("fe-error.md", &page), ("fe-error.svg", &plot)])?;
    print(&page);
    Ok(Outcome::Done)
}

fn stability(options: &Stability) -> Result<Outcome, Failure> {
    let pool = thread_pool(options.threads)?;
    let note = |what: &str| eprintln!("{what}");
    let rows = pool.install(|| fe_stability::measure(&note)).map_err(Failure::stopped)?;
    let page = fe_stability::markdown(&rows);
    save(options.output.as_deref(), &[("fe-stability.md", &page)])?;
    print(&page);
    let holds = rows.iter().all(fe_stability::Row::holds);
    Ok(if holds { Outcome::Done } else { Outcome::CheckFailed })
}

/// Writes files into a folder, if one was asked for.
pub(super) fn save(folder: Option<&Path>, files: &[(&str, &str)]) -> Result<(), Failure> {
    let Some(folder) = folder else { return Ok(()) };
    let failed = |e: std::io::Error| Failure::input(format!("{}: {e}", folder.display()));
    std::fs::create_dir_all(folder).map_err(failed)?;
    files
        .iter()
        .try_for_each(|(name, text)| write_atomic(&folder.join(name), text.as_bytes()).map_err(failed))
}
