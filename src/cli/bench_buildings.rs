//! `fallwerk bench buildings`: generated models of random small buildings.

use super::bench::save;
use super::knowledge::{KnowledgeArgs, library, rules};
use super::progress::Progress;
use super::{Failure, Outcome, print, thread_pool};
use crate::bench::buildings;
use crate::study::plan::Scene;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Which buildings, and how.
#[derive(clap::Args)]
pub struct Arguments {
    /// Seed of the set
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u32,
    /// Number of buildings
    #[arg(long, value_name = "N", default_value_t = 500, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    count: u32,
    /// Print the building file of the one with this number, and run nothing
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..))]
    show: Option<u32>,
    /// Folder for buildings-stability.md
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    #[command(flatten)]
    knowledge: KnowledgeArgs,
}

/// Runs the command.
pub fn run(options: &Arguments) -> Result<Outcome, Failure> {
    if let Some(number) = options.show {
        print(&Scene::small(options.seed, number).toml());
        return Ok(Outcome::Done);
    }
    let rules = rules(options.knowledge.rules.as_deref())?;
    let mut store = library(options.knowledge.library.as_deref(), false)?;
    let store = Mutex::new(&mut store);
    let pool = thread_pool(options.threads)?;
    let progress = Progress::on_stderr();
    progress.stage("random buildings");
    let through = AtomicU64::new(0);
    let tell = || {
        let done = through.fetch_add(1, Ordering::Relaxed) + 1;
        progress.advance(done as f64 / f64::from(options.count), "");
    };
    let rows = pool.install(|| buildings::measure(options.seed, options.count, &rules, &store, &tell));
    progress.finish();
    let page = buildings::markdown(options.seed, &rows);
    save(options.output.as_deref(), &[("buildings-stability.md", &page)])?;
    print(&page);
    let holds = rows.iter().all(|row| row.faults().is_empty());
    Ok(if holds { Outcome::Done } else { Outcome::CheckFailed })
}
