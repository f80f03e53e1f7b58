//! `fallwerk fe DECK`: runs a keyword deck; `--write-deck`: writes one.

use super::fe::Arguments;
use super::fe_places::{self as places, failure, unwritable};
use super::progress::Progress;
use super::verdict::percent;
use super::{Failure, Outcome, colour_on_stderr, print, thread_pool};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::output::{OutputFolder, may_write, write_atomic};
use crate::base::results::Results;
use crate::base::units::in_table;
use crate::building::Building;
use crate::fe::deck::{DECK_ENDINGS, Deck, DeckErrors, DeckOptions, of_building, read, write};
use crate::fe::dynamics::Death;
use crate::fe::model::Model;
use crate::fe::model_run::{ModelError, ModelOptions, ModelRun, run_model};
use crate::fe::run::FeOptions;
use crate::fe::vtu::{FrameSink, VtuSeries};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Version of `fe.json` of a deck.
const SCHEMA: &str = "fallwerk-fe-deck/1";

/// Runs a deck, or writes it again in normal form.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    if arguments.mesh_size.is_some() {
        return Err(Failure::input("--mesh-size is for buildings: a deck brings its mesh".into()));
    }
    if let Some(option) = arguments.for_buildings_only() {
        return Err(Failure::input(format!(
            "{option} is for buildings; a deck has its own keywords, or none"
        )));
    }
    let (path, end_time_s) = (to_write(arguments)?, super::fe::end_time(arguments)?);
    let options = DeckOptions { skip_unknown: arguments.skip_unknown, end_time_s };
    let mut deck = read(&arguments.building, options).map_err(|errors| refused(arguments, &errors))?;
    for note in &deck.notes {
        eprintln!("note: {note}");
    }
    if let Some(path) = path {
        let control = &mut deck.model.control;
        control.end_time_s = end_time_s.unwrap_or(control.end_time_s);
        let notes = deck.notes.iter().map(|n| n.to_string()).collect();
        return save(arguments, path, &deck.model, &[], notes);
    }
    let target = arguments.output.clone().unwrap_or_else(|| default_output(&arguments.building));
    let output = OutputFolder::create(&target, Results::Deck).map_err(|e| unwritable(&e))?;
    let progress = Progress::on_stderr();
    let pool = thread_pool(arguments.threads)?;
    progress.stage("FE run");
    let mut report = |at: crate::fe::run::Progress| {
        progress.advance(at.time_s / at.end_s, &format!("t = {:.4e} of {:.4e} s", at.time_s, at.end_s));
    };
    let every = arguments.frames_every();
    let mut series = every.map(|every| VtuSeries::new(output.path(), every).by_ids(&deck.ids));
    let frames = series.as_mut().map(|s| s as &mut dyn FrameSink);
    let ran = pool.install(|| {
        run_model(&deck.model, &ModelOptions { end_time_s, ..ModelOptions::default() }, frames, &mut report)
    });
    let run = ran.map_err(|error| {
        progress.finish();
        stopped(arguments, &deck, &error)
    })?;
    progress.finish();
    for note in &run.notes {
        eprintln!("note: {note}");
    }
    let text = readable_json(&record(&deck, &run)?).map_err(|e| Failure::input(e.to_string()))?;
    places::write(&output, "fe.json", &text)?;
    places::write(&output, "histories.csv", &histories_csv(&deck, &run))?;
    places::write(&output, "energies.csv", &energies_csv(&run))?;
    let folder = output.commit().map_err(|e| unwritable(&e))?;
    if arguments.json {
        let mut value = json!(run.summary);
        value["title"] = json!(deck.model.title);
        value["notes"] = notes(&deck, &run);
        value["output"] = json!(folder);
        print(&format!("{value:#}\n"));
    } else {
        print(&format!("{}  results: {}\n", summary(&deck, &run), folder.display()));
    }
    Ok(Outcome::Done)
}

/// Why a deck does not run to its end: at the line that is to blame, if there is one.
fn stopped(arguments: &Arguments, deck: &Deck, error: &ModelError) -> Failure {
    if let Some(errors) = deck.places.blame(error, arguments.end_time.is_none()) {
        return refused(arguments, &errors);
    }
    match error {
        ModelError::Broken(error) => deck.ids.words(error).map_or_else(|| failure(error), Failure::stopped),
        ModelError::TooLong { .. } | ModelError::TooShort { .. } if arguments.end_time.is_some() => {
            Failure::input(format!("--end-time: {error}"))
        }
        _ => Failure::input(format!("{}: {error}", arguments.building.display())),
    }
}

/// Shows what is wrong with a deck.
fn refused(arguments: &Arguments, errors: &DeckErrors) -> Failure {
    eprint!("{}", errors.render(colour_on_stderr()));
    if arguments.json {
        print(&format!("{:#}\n", json!({ "ok": false, "diagnostics": errors.to_json() })));
    }
    Failure::input(String::new())
}

/// The deck to be written, if there is to be one: options of a run beside it are refused.
pub fn to_write(arguments: &Arguments) -> Result<Option<&Path>, Failure> {
    let Some(path) = arguments.write_deck.as_deref() else { return Ok(None) };
    match arguments.for_runs_only() {
        None => Ok(Some(path)),
        Some(option) => Err(Failure::input(format!(
            "{option} is for runs, and with --write-deck nothing is run; leave one of the two out"
        ))),
    }
}

/// Writes the FE model of a building as a deck.
pub fn write_building(
    arguments: &Arguments,
    building: &Building,
    options: &FeOptions,
    path: &Path,
) -> Result<Outcome, Failure> {
    let deck = of_building(building, options).map_err(|e| Failure::input(e.to_string()))?;
    save(arguments, path, &deck.model, &deck.comments, Vec::new())
}

/// Writes a model with comments at the head of its deck; `notes` are those there are already.
fn save(
    arguments: &Arguments,
    path: &Path,
    model: &Model,
    comments: &[String],
    mut notes: Vec<String>,
) -> Result<Outcome, Failure> {
    may_write(path, &DECK_ENDINGS, &[&arguments.building])
        .map_err(|why| Failure::input(format!("--write-deck: {why}")))?;
    let written = write(model, comments);
    write_atomic(path, written.text.as_bytes()).map_err(|e| {
        let remedy = "make room there, or name a file that can be written";
        Failure::input(format!("--write-deck {}: {e}; {remedy}", path.display()))
    })?;
    for note in &written.notes {
        eprintln!("note: {note}");
    }
    if arguments.json {
        notes.extend(written.notes);
        print(&format!("{:#}\n", json!({ "title": model.title, "notes": notes, "output": path })));
    } else {
        print(&format!("{}\n", path.display()));
    }
    Ok(Outcome::Done)
}

/// `out/` and the deck's name.
fn default_output(deck: &Path) -> PathBuf {
    let name = deck.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    Path::new("out").join(format!("{}-fe", if name.is_empty() { "deck" } else { &name }))
}

fn notes(deck: &Deck, run: &ModelRun) -> Value {
    let all = deck.notes.iter().map(|n| n.to_string()).chain(run.notes.iter().cloned());
    Value::Array(all.map(Value::from).collect())
}

/// What `fe.json` holds: everything of the run but states and run times.
fn record(deck: &Deck, run: &ModelRun) -> Result<Value, Failure> {
    let mut summary = json!(run.summary);
    if let Some(members) = summary.as_object_mut() {
        for unused in ["elapsed", "preload_iterations", "first_ground_contact_s"] {
            members.remove(unused);
        }
    }
    let text = write(&deck.model, &[]).text;
    let hash = ContentHash::of_value(&text).map_err(|e| Failure::input(e.to_string()))?;
    let deaths = |cause: Death| run.deaths.iter().filter(|d| d.cause == cause).count();
    let history = |h: &crate::fe::model_run::NodeHistory| {
        json!({
            "node": deck.ids.nodes[h.node],
            "displacement_m": h.displacement_m,
            "velocity_m_s": h.velocity_m_s,
        })
    };
    let rupture = |r: &crate::fe::truss::BarRupture| {
        json!({
            "bar": deck.ids.trusses[r.bar],
            "part": deck.ids.parts[r.part],
            "time_s": r.time_s,
            "strain": r.strain,
            "plastic_strain": r.plastic_strain,
        })
    };
    Ok(json!({
        "schema": SCHEMA,
        "title": deck.model.title,
        "model_hash": hash.to_string(),
        "program_version": env!("CARGO_PKG_VERSION"),
        "notes": notes(deck, run),
        "summary": summary,
        "added_mass_kg": run.added_mass_kg,
        "largest_plastic_strain": run.plastic_strain.iter().copied().fold(0.0, f64::max),
        "deaths": {
            "eroded": deaths(Death::Eroded),
            "torn": deaths(Death::Torn),
            "collapsed": deaths(Death::Collapsed),
        },
        "ruptures": run.ruptures.iter().map(rupture).collect::<Vec<_>>(),
        "times_s": run.times_s,
        "histories": run.histories.iter().map(history).collect::<Vec<_>>(),
        "energies": run.energies,
    }))
}

/// Displacements and velocities of the recorded nodes by their identifiers.
fn histories_csv(deck: &Deck, run: &ModelRun) -> String {
    let mut text = String::from("time_s");
    for history in &run.histories {
        let id = deck.ids.nodes[history.node];
        for (what, unit) in [("u", "m"), ("v", "m_s")] {
            let _ = write!(text, ",n{id}_{what}x_{unit},n{id}_{what}y_{unit},n{id}_{what}z_{unit}");
        }
    }
    text.push('\n');
    for (i, time) in run.times_s.iter().enumerate() {
        let _ = write!(text, "{}", in_table(*time));
        for history in &run.histories {
            for value in history.displacement_m[i].iter().chain(&history.velocity_m_s[i]) {
                let _ = write!(text, ",{value}");
            }
        }
        text.push('\n');
    }
    text
}

fn energies_csv(run: &ModelRun) -> String {
    let mut text = String::from(
        "time_s,kinetic_j,internal_j,eroded_j,hourglass_j,viscous_j,body_loads_j,driven_j,contact_j,friction_j,released_j,residual_j\n",
    );
    for (time, e) in run.times_s.iter().zip(&run.energies) {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{}",
            in_table(*time),
            e.kinetic_j,
            e.internal_j,
            e.eroded_j,
            e.hourglass_j,
            e.viscous_j,
            e.body_loads_j,
            e.driven_j,
            e.contact_j,
            e.friction_j,
            e.released_j,
            e.residual_j
        );
    }
    text
}

fn summary(deck: &Deck, run: &ModelRun) -> String {
    let s = &run.summary;
    let title = if deck.model.title.is_empty() { "deck" } else { &deck.model.title };
    let end_s = run.times_s.last().copied().unwrap_or(0.0);
    let mut text = format!(
        "{title}: run to {end_s:.6} s\n  {} elements, {} nodes, mass {:.6e}; {} steps, the first of {:.4e} s\n  \
         largest plastic strain {:.4}, eroded elements: {}\n  energy error {}, hourglass share {}\n",
        s.elements,
        s.nodes,
        s.mass_kg,
        s.steps,
        s.time_step_s,
        run.plastic_strain.iter().copied().fold(0.0, f64::max),
        s.eroded_elements,
        percent(s.energy_error),
        percent(s.hourglass_share),
    );
    if s.ruptured_bars > 0 {
        let _ = writeln!(text, "  ruptured bars: {} of {}", s.ruptured_bars, deck.model.mesh.trusses.len());
    }
    if run.added_mass_kg > 0.0 {
        let _ =
            writeln!(text, "  added mass: {}", percent(run.added_mass_kg / (s.mass_kg - run.added_mass_kg)));
    }
    for history in &run.histories {
        let largest = |i: usize| {
            let values = history.displacement_m.iter().map(|u| u[i]);
            values.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a })
        };
        let id = deck.ids.nodes[history.node];
        let _ = writeln!(
            text,
            "  node {id}: largest displacements {:.6e} {:.6e} {:.6e}",
            largest(0),
            largest(1),
            largest(2)
        );
    }
    let _ = writeln!(text, "  run time: {:.1} s wall, {:.1} s processor", s.elapsed.wall_s, s.elapsed.cpu_s);
    text
}
