//! `fallwerk bench tradeoff`: run time against error of all models of some buildings.

use super::bench::{check_sizes, save};
use super::knowledge::CurveArgs;
use super::{Failure, Outcome, print, read_building, thread_pool};
use crate::bench::fe;
use crate::bench::tradeoff::{self, Kind, Row};
use crate::generate::{Wishes, generate};
use crate::report::loglog::{self, Line, Panel};
use std::path::PathBuf;

/// Which buildings, and how.
#[derive(clap::Args)]
pub struct Arguments {
    /// Building files
    #[arg(default_value = "buildings/three-storey-frame.toml")]
    buildings: Vec<PathBuf>,
    /// Mesh sizes of FE runs in metres, beside that of each building's file
    #[arg(long, value_delimiter = ',', default_value = "0.25")]
    sizes: Vec<f64>,
    #[command(flatten)]
    curves: CurveArgs,
    /// Folder for tradeoff.md and tradeoff.svg
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs the command.
pub fn run(options: &Arguments) -> Result<Outcome, Failure> {
    check_sizes(&options.sizes)?;
    let pool = thread_pool(options.threads)?;
    let (rules, mut store) = options.curves.open()?;
    let derive = options.curves.wishes().derive;
    let mut rows = Vec::new();
    for file in &options.buildings {
        let building = read_building(file, false)?;
        let note = |what: &str| eprintln!("{}: {what}", building.name);
        let mut model = |accuracy| {
            generate(&building, &rules, &mut store, Wishes { derive, accuracy }, &|text| eprintln!("{text}"))
        };
        let measured = pool.install(|| tradeoff::measure(&building, &options.sizes, &mut model, &note));
        rows.extend(measured.map_err(|e| Failure::stopped(format!("{}: {e}", building.name)))?);
    }
    let page = tradeoff::markdown(&rows, &fe::machine());
    let plot = plot(&rows);
    save(options.output.as_deref(), &[("tradeoff.md", &page), ("tradeoff.svg", &plot)])?;
    print(&page);
    Ok(Outcome::Done)
}

/// Error over processor time, a plot for each building: up to the first contact, and of the whole run (dashed). The finest FE run has no error and no point.
fn plot(rows: &[Row]) -> String {
    let mut buildings: Vec<&str> = rows.iter().map(|r| r.building.as_str()).collect();
    buildings.dedup();
    let panel = |name: &&str| {
        let kinds = [Kind::Mbs, Kind::Hybrid, Kind::Fe].into_iter().enumerate();
        let lines = kinds.flat_map(|(colour, kind)| {
            [false, true].map(|dashed| {
                let own = rows.iter().filter(|r| r.building == **name && r.kind == kind);
                let error = |r: &Row| if dashed { r.e_total } else { r.e_to_contact };
                let level = |r: &Row| if dashed { String::new() } else { r.level.clone() };
                let mut runs: Vec<([f64; 2], String)> =
                    own.map(|r| ([r.cpu_s, error(r)], level(r))).collect();
                runs.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
                let (points, labels) = runs.into_iter().unzip();
                let name = if dashed { String::new() } else { kind.name().to_string() };
                Line { name, points, colour, dashed, labels }
            })
        });
        Panel { title: name.to_string(), lines: lines.collect() }
    };
    let panels: Vec<Panel> = buildings.iter().map(panel).collect();
    let errors = "error e: filled up to the first contact, hollow over the whole run";
    loglog::svg(["processor time [s]", errors], &panels)
}
