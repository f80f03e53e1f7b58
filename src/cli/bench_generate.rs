//! `fallwerk bench generate`: time of generation over the number of members.

use super::bench::save;
use super::knowledge::{KnowledgeArgs, library, rules};
use super::{Failure, Outcome, print, thread_pool};
use crate::bench::generate::{markdown, measure};
use std::path::PathBuf;

/// Which frames.
#[derive(clap::Args)]
pub struct Arguments {
    /// Most members of a frame
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u32).range(27..=20_000))]
    members: u32,
    /// Folder for generation-time.md
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
    let rules = rules(options.knowledge.rules.as_deref())?;
    let mut store = library(options.knowledge.library.as_deref(), false)?;
    let tell = |members: usize| eprintln!("{members} members");
    let most = options.members as usize;
    let pool = thread_pool(options.threads)?;
    let rows = pool.install(|| measure(most, &rules, &mut store, &tell)).map_err(Failure::stopped)?;
    let table = markdown(&rows);
    save(options.output.as_deref(), &[("generation-time.md", &table)])?;
    print(&table);
    Ok(Outcome::Done)
}
