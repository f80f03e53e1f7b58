//! `fallwerk study`: FE runs as evidence in `kb/studies/`.

use super::{Failure, Outcome, failing, print, study_compare, study_run};
use crate::base::json::from_text;
use crate::base::output::write_atomic;
use crate::fe::result::FeEnergies;
use crate::study::plan::Scene;
use crate::study::{EndZone, Study};
use crate::validate::undecided::moving_note;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Where the records of studies lie.
pub(super) const STUDIES: &str = "kb/studies";

/// Most scenes of a plan: the length of the sequence.
const MOST_SCENES: u32 = 1 << 16;

/// Run FE studies, list and show their records
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(clap::Subcommand)]
enum Verb {
    /// Write the building files of a plan: scenes that cover spans, storeys, floors, strengths and ways of blasting evenly
    ///
    /// The same seed gives the same scenes, and a longer plan begins with those of a shorter one.
    Plan {
        /// Seed of the plan
        #[arg(long, default_value_t = 1)]
        seed: u32,
        /// Number of scenes
        #[arg(long, default_value_t = 120)]
        count: u32,
        /// Plans like an L, T or U in place of rectangles: a series of its own
        #[arg(long)]
        irregular: bool,
        /// Folder for the building files
        #[arg(short, long, value_name = "DIR")]
        output: PathBuf,
    },
    /// Run buildings by FE and keep what they show: zones, rotations, rigid shares, contact, fracture
    ///
    /// A building whose record is there already, of the same input, is passed over, so that a run that was stopped goes on where it was.
    /// A record of another input in its place is kept, and nothing is run, unless `--again` asks for it.
    ///
    /// Exit codes: 0 done, 1 an FE run went wrong, 2 bad input or usage.
    Run {
        /// Building files, or folders of them
        #[arg(required = true)]
        buildings: Vec<PathBuf>,
        /// Folder of the records
        #[arg(long, value_name = "DIR", default_value = STUDIES)]
        kb: PathBuf,
        /// Threads [default: all cores]; of several buildings so many are run at once
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
        threads: Option<u16>,
        /// Run again what has a record, and replace records of other inputs
        #[arg(long)]
        again: bool,
    },
    /// Generate the models of buildings, run them, and compare them with the records
    ///
    /// No FE is run. Exit codes: 0 done, 1 buildings without a comparison, 2 bad usage.
    Compare(study_compare::Arguments),
    /// List the records
    List {
        /// Folder of the records
        #[arg(long, value_name = "DIR", default_value = STUDIES)]
        kb: PathBuf,
        /// Print JSON
        #[arg(long)]
        json: bool,
    },
    /// Show a record: zones at member ends in order of time
    Show {
        /// The record: a JSON file, or its name in the folder of records, such as s1-001
        record: PathBuf,
        /// Folder of the records
        #[arg(long, value_name = "DIR", default_value = STUDIES)]
        kb: PathBuf,
    },
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    match &arguments.verb {
        Verb::Plan { seed, count, irregular, output } => plan(*seed, *count, *irregular, output)?,
        Verb::Run { buildings, kb, threads, again } => {
            return study_run::run(buildings, kb, *threads, *again);
        }
        Verb::Compare(arguments) => return failing(arguments.json, study_compare::run(arguments)),
        Verb::List { kb, json } => failing(*json, list(kb, *json))?,
        Verb::Show { record, kb } => print(&described(&read(&found(record, kb))?)),
    }
    Ok(Outcome::Done)
}

/// A record by its path, or by its name in a folder.
fn found(record: &Path, kb: &Path) -> PathBuf {
    let named = kb.join(format!("{}.json", record.display()));
    if !record.exists() && named.exists() { named } else { record.to_owned() }
}

fn plan(seed: u32, count: u32, irregular: bool, folder: &Path) -> Result<(), Failure> {
    if !(1..=MOST_SCENES).contains(&count) {
        return Err(Failure::input(format!("--count: {count} is not between 1 and {MOST_SCENES}")));
    }
    let failed =
        |path: &Path, e: std::io::Error| Failure::input(format!("cannot write {}: {e}", path.display()));
    std::fs::create_dir_all(folder).map_err(|e| failed(folder, e))?;
    let scenes = (1..=count).map(|k| if irregular { Scene::irregular(seed, k) } else { Scene::of(seed, k) });
    let files = scenes.map(|scene| (folder.join(format!("{}.toml", scene.name())), scene.toml()));
    let files: Vec<(PathBuf, String)> = files.collect();
    let is_other = |(file, text): &&(PathBuf, String)| {
        file.exists() && std::fs::read_to_string(file).ok().as_ref() != Some(text)
    };
    if let Some((file, _)) = files.iter().find(is_other) {
        return Err(Failure::input(format!(
            "{} is there with another content, which would be lost; remove it, or name another folder with --output",
            file.display()
        )));
    }
    for (file, text) in &files {
        write_atomic(file, text.as_bytes()).map_err(|e| failed(file, e))?;
    }
    print(&format!("wrote {count} building files to {}\n", folder.display()));
    Ok(())
}

/// A record from its file.
pub(super) fn read(path: &Path) -> Result<Study, Failure> {
    let text = std::fs::read_to_string(path).map_err(|e| {
        Failure::input(format!(
            "cannot read {}: {e}; `fallwerk study list` names the records",
            path.display()
        ))
    })?;
    let study: Study = from_text(&text)
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

fn list(kb: &Path, json: bool) -> Result<(), Failure> {
    let entries =
        std::fs::read_dir(kb).map_err(|e| Failure::input(format!("cannot read {}: {e}", kb.display())))?;
    let mut files: Vec<PathBuf> = entries
        .filter_map(|e| e.ok().map(|e| e.path()))
        .filter(|p| p.extension().is_some_and(|x| x == "json"))
        .collect();
    files.sort();
    let mut records = Vec::new();
    for file in files {
        let study = read(&file)?;
        let zones = study.facts.ends.iter().filter(|e| e.first_s.is_some()).count();
        if json {
            records.push(json!({
                "file": file,
                "building": study.building,
                "elements": study.elements,
                "zones": zones,
                "collapsed": study.facts.collapsed,
                "still_moving": still_moving(&study),
            }));
            continue;
        }
        let collapse = match (study.facts.collapsed, still_moving(&study)) {
            (true, _) => "collapses",
            (false, None) => "stands",
            (false, Some(_)) => "still moves at its end",
        };
        print(&format!(
            "{}  {} elements, {zones} zones at member ends, {collapse}\n",
            file.display(),
            study.elements
        ));
    }
    if json {
        print(&format!("{:#}\n", json!({ "records": records })));
    }
    Ok(())
}

/// [`moving_note`] of a record.
fn still_moving(study: &Study) -> Option<String> {
    let histories = study.motion.histories();
    let points = histories.iter().map(|h| (h.id.as_str(), &h.displacement_m[..]));
    moving_note(study.facts.collapsed, &study.motion.times_s(), points)
}

/// A record in words.
pub(super) fn described(study: &Study) -> String {
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
    if let Some(note) = still_moving(study) {
        let _ = writeln!(text, "  note: {note}");
    }
    if let Some(energies) = &study.energies {
        let words = |e: &FeEnergies| {
            format!(
                "gravity {:.4} MJ, internal {:.4}, kinetic {:.4}, contact {:.4}",
                1e-6 * e.gravity_j,
                1e-6 * e.internal_j,
                1e-6 * e.kinetic_j,
                1e-6 * e.contact_j
            )
        };
        if let Some(first) = &energies.first_contact {
            let _ = writeln!(text, "  energies at the first contact: {}", words(first));
        }
        let _ = writeln!(text, "  energies at the end: {}", words(&energies.end));
    }
    let rate = facts.critical_rate_1_s;
    let _ = writeln!(text, "  zones above {rate} 1/s at member ends:");
    zones(&facts.ends, &mut text);
    if facts.lines.iter().any(|l| l.first_s.is_some()) {
        let _ = writeln!(text, "  zones above {rate} 1/s in strips of slabs and at feet and heads of walls:");
        zones(&facts.lines, &mut text);
    }
    text
}

/// Those zones that exceed the critical rate, in order of time.
fn zones(list: &[EndZone], text: &mut String) {
    use std::fmt::Write;
    let mut zones: Vec<_> = list.iter().filter_map(|e| e.first_s.map(|t| (t, e))).collect();
    zones.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.id.cmp(&b.1.id)));
    for (time, end) in zones {
        let bore = end.fracture_force.map_or(String::new(), |f| {
            let [axial_kn, bending_knm] = [1e-3 * f.axial_n, 1e-3 * f.bending_nm];
            format!(" (it bore {axial_kn:.0} kN and {bending_knm:.0} kN m before)")
        });
        let fracture = end.fracture_s.map_or(String::new(), |t| format!(", fractured at {t:.3} s{bore}"));
        let _ = writeln!(
            text,
            "    {:<16} from {time:.2} s, up to {:.2} 1/s, plastic strain {:.3}{fracture}",
            end.id, end.peak_rate_1_s, end.plastic_strain
        );
    }
}
