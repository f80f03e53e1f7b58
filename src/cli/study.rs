//! `fallwerk study`: FE runs as evidence in `kb/studies/`.

use super::progress::Progress;
use super::{Failure, Outcome, print, read_building, thread_pool};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::output::write_atomic;
use crate::fe::run::{FeOptions, run as run_fe};
use crate::study::{Study, facts};
use std::path::{Path, PathBuf};

/// Run FE studies, list and show their records
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(clap::Subcommand)]
enum Verb {
    /// Run a building by FE and keep what it shows: zones, rigid shares, contact, fracture
    Run {
        /// The building file
        building: PathBuf,
        /// Folder of the records
        #[arg(long, value_name = "DIR", default_value = "kb/studies")]
        kb: PathBuf,
        /// Worker threads (default: all cores)
        #[arg(long, value_name = "N")]
        threads: Option<u16>,
    },
    /// List the records
    List {
        /// Folder of the records
        #[arg(long, value_name = "DIR", default_value = "kb/studies")]
        kb: PathBuf,
    },
    /// Show a record: zones at member ends in order of time
    Show {
        /// The record (a JSON file)
        record: PathBuf,
    },
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    match &arguments.verb {
        Verb::Run { building, kb, threads } => run_study(building, kb, *threads)?,
        Verb::List { kb } => list(kb)?,
        Verb::Show { record } => print(&described(&read(record)?)),
    }
    Ok(Outcome::Done)
}

fn run_study(path: &Path, kb: &Path, threads: Option<u16>) -> Result<(), Failure> {
    let building = read_building(path, false)?;
    let progress = Progress::on_stderr();
    progress.stage("FE run");
    let work = || {
        run_fe(&building, &FeOptions::default(), &mut |p| {
            progress.advance(p.time_s / p.end_s, &format!("{:.2} of {:.2} s", p.time_s, p.end_s));
        })
    };
    let run = thread_pool(threads)?.install(work).map_err(|e| Failure::stopped(e.to_string()))?;
    progress.finish();
    let hash = ContentHash::of_value(&building).map_err(|e| Failure::stopped(e.to_string()))?;
    let record = Study::new(
        &building.name,
        hash.to_string(),
        building.settings.mesh_size_m,
        &run.summary,
        facts(&building, &run),
    );
    let text = readable_json(&record).map_err(|e| Failure::stopped(e.to_string()))?;
    std::fs::create_dir_all(kb)
        .map_err(|e| Failure::input(format!("cannot create {}: {e}", kb.display())))?;
    let file = kb.join(format!("{}.json", building.name));
    write_atomic(&file, text.as_bytes())
        .map_err(|e| Failure::input(format!("cannot write {}: {e}", file.display())))?;
    print(&format!("{}wrote {}\n", described(&record), file.display()));
    Ok(())
}

/// A record from its file.
pub(super) fn read(path: &Path) -> Result<Study, Failure> {
    let text = std::fs::read_to_string(path)
        .map_err(|e| Failure::input(format!("cannot read {}: {e}", path.display())))?;
    let study: Study = serde_json::from_str(&text)
        .map_err(|e| Failure::input(format!("{} is no study record: {e}", path.display())))?;
    if study.schema != crate::study::record::STUDY_SCHEMA {
        return Err(Failure::input(format!(
            "{} has schema {}; this program reads {}",
            path.display(),
            study.schema,
            crate::study::record::STUDY_SCHEMA
        )));
    }
    Ok(study)
}

fn list(kb: &Path) -> Result<(), Failure> {
    let entries =
        std::fs::read_dir(kb).map_err(|e| Failure::input(format!("cannot read {}: {e}", kb.display())))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|x| x == "json"))
        .collect();
    files.sort();
    for file in files {
        let study = read(&file)?;
        let zones = study.facts.ends.iter().filter(|e| e.first_s.is_some()).count();
        let collapse = if study.facts.collapsed { "collapses" } else { "stands" };
        print(&format!(
            "{}  {} elements, {zones} zones at member ends, {collapse}\n",
            file.display(),
            study.elements
        ));
    }
    Ok(())
}

/// A record in words.
fn described(study: &Study) -> String {
    use std::fmt::Write;
    let facts = &study.facts;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {} elements, {} steps, energy error {:.2} %",
        study.building,
        study.elements,
        study.steps,
        100.0 * study.energy_error
    );
    let contact = facts.first_contact_s.map_or("none".to_string(), |t| format!("{t:.3} s"));
    let _ = writeln!(
        text,
        "  {}; first ground contact: {contact}",
        if facts.collapsed { "collapses" } else { "does not collapse" }
    );
    let mut zones: Vec<_> = facts.ends.iter().filter_map(|e| e.first_s.map(|t| (t, e))).collect();
    zones.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.id.cmp(&b.1.id)));
    let _ = writeln!(text, "  zones above {} 1/s at member ends:", facts.critical_rate_1_s);
    for (time, end) in zones {
        let fracture = end.fracture_s.map_or(String::new(), |t| format!(", fractured at {t:.3} s"));
        let _ = writeln!(
            text,
            "    {:<16} from {time:.2} s, up to {:.2} 1/s, plastic strain {:.3}{fracture}",
            end.id, end.peak_rate_1_s, end.plastic_strain
        );
    }
    text
}
