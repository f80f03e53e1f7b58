//! `fallwerk fe`: the FE run of a building alone, or of a keyword deck.

use super::fe_against::{Against, Other};
use super::fe_hybrid;
use super::fe_places::{self as places, failure, unwritable};
use super::knowledge::KnowledgeArgs;
use super::progress::Progress;
use super::verdict::{outcome, outcome_words, percent, seconds, unfired};
use super::{Failure, Outcome, print, read_building, thread_pool};
use crate::base::hash::{ContentHash, readable_json};
use crate::base::isa::Isa;
use crate::base::output::OutputFolder;
use crate::base::results::Results;
use crate::base::units::in_table;
use crate::building::partition::Partition;
use crate::building::{Building, Member};
use crate::fe::deck::is_deck;
use crate::fe::dynamics::Death;
use crate::fe::erosion::{ErosionTable, Fate, Loss};
use crate::fe::law::ElementForm;
use crate::fe::mass_scaling::MassScaling;
use crate::fe::quality::{Quality, sliver_note};
use crate::fe::result::{FeRun, FeSummary};
use crate::fe::run::{Attached, FeOptions, outputs, reaches_an_output, run_with};
use crate::fe::vtu::{FrameSink, VtuSeries};
use crate::study::{facts, fell};
use crate::validate::undecided::moving_note;
use crate::verify::fe::forms::{FORMS, form};
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
/// Writes fe.json and histories as CSV into a result folder, with --vtu also collapse.pvd for ParaView. The same input
/// gives the same files, whatever the number of threads, also if the run was interrupted and gone on with from a checkpoint;
/// run times are printed and not stored. With checkpoints the results gather in OUTPUT.unfinished until the run is done.
/// A file that ends in .k, .key or .dyn, or that begins with a keyword, is read as a deck of LS-DYNA form (docs/decks.md lists
/// the keywords).
/// Exit codes: 0 done, 1 the run stopped, 2 bad input.
#[derive(clap::Args)]
pub struct Arguments {
    /// The building file or the deck
    #[arg(value_name = "BUILDING|DECK")]
    pub(super) building: PathBuf,
    /// Result folder [default: out/NAME-fe]; one of an earlier run is replaced
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    /// Target edge length of the elements in metres, instead of the building's
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    pub(super) mesh_size: Option<f64>,
    /// Simulated time in seconds, instead of the building's
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(super) end_time: Option<f64>,
    /// What becomes of elements that reach their erosion strain
    #[arg(long, value_enum, default_value_t = OnFailure::Erode)]
    on_failure: OnFailure,
    /// Least time step in seconds, kept by adding mass to elements that allow less (at most 5 % of the mass)
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    mass_scaling_step: Option<f64>,
    /// Accept any amount of added mass
    #[arg(long, requires = "mass_scaling_step")]
    force_mass_scaling: bool,
    /// Write the mesh with its fields at every output, for ParaView: collapse.pvd
    #[arg(long)]
    vtu: bool,
    /// The same at every N-th output only
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    vtu_every: Option<u32>,
    /// Write a checkpoint every S simulated seconds, from which an interrupted run can be gone on with
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    checkpoint_every: Option<f64>,
    /// The checkpoint file [default: OUTPUT.unfinished/fe.checkpoint, removed when the run is done]
    #[arg(long, value_name = "FILE", requires = "checkpoint_every")]
    checkpoint: Option<PathBuf>,
    /// Go on from a checkpoint of the same building with the same options; the end time may be another
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Element form: asqbi, ads, asmd, fb-stiffness, fb-viscous or full [default: asqbi]
    #[arg(long, value_name = "FORM")]
    form: Option<String>,
    /// Instruction set: avx512, avx2 or portable, with the same results [default: the fastest that the processor has]
    #[arg(long, value_name = "ISA")]
    isa: Option<String>,
    /// Compute all elements in every step, also those that stand still, and look for contacts in every step; the result is the same
    #[arg(long)]
    compute_all: bool,
    /// Let the parts of the building pass through each other
    #[arg(long)]
    no_body_contact: bool,
    #[command(flatten)]
    hybrid: fe_hybrid::Options,
    #[command(flatten)]
    knowledge: KnowledgeArgs,
    /// Tell the error of the tracked points against another run: the fe.json of an FE run of the same building
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Write the FE model as a keyword deck into this file instead of running it; mesh size, end time, form, mass scaling and
    /// --no-body-contact go into it
    #[arg(long, value_name = "FILE")]
    pub(super) write_deck: Option<PathBuf>,
    /// Leave keywords of a deck that are not known out, with a note, instead of refusing them
    #[arg(long)]
    pub(super) skip_unknown: bool,
    /// Print the summary as JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// Values of `--on-failure`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum OnFailure {
    /// They are deleted
    Erode,
    /// They are detached and live on as blocks of debris
    Split,
}

impl Arguments {
    /// Every how many outputs a grid is written.
    pub(super) fn frames_every(&self) -> Option<usize> {
        self.vtu_every.or(self.vtu.then_some(1)).map(|every| every as usize)
    }

    /// The first given option that has no meaning for a deck.
    pub(super) fn for_buildings_only(&self) -> Option<&'static str> {
        let of_the_model = [
            (self.mass_scaling_step.is_some(), "--mass-scaling-step"),
            (self.no_body_contact, "--no-body-contact"),
            (self.form.is_some(), "--form"),
        ];
        first_given(self.of_a_building_run().into_iter().chain(of_the_model))
    }

    /// The first given option that has no meaning where a deck is written in place of a run.
    pub(super) fn for_runs_only(&self) -> Option<&'static str> {
        let of_any_run = [
            (self.output.is_some(), "--output"),
            (self.vtu, "--vtu"),
            (self.vtu_every.is_some(), "--vtu-every"),
            (self.force_mass_scaling, "--force-mass-scaling"),
        ];
        first_given(self.of_a_building_run().into_iter().chain(of_any_run))
    }

    /// Which options of a building's run are given that are in no deck.
    fn of_a_building_run(&self) -> [(bool, &'static str); 9] {
        [
            (self.checkpoint_every.is_some(), "--checkpoint-every"),
            (self.resume.is_some(), "--resume"),
            (self.compute_all, "--compute-all"),
            (self.isa.is_some(), "--isa"),
            (self.hybrid.is_given(), "--hybrid"),
            (self.against.is_some(), "--against"),
            (self.knowledge.rules.is_some(), "--rules"),
            (self.knowledge.library.is_some(), "--library"),
            (!matches!(self.on_failure, OnFailure::Erode), "--on-failure"),
        ]
    }
}

fn first_given(mut options: impl Iterator<Item = (bool, &'static str)>) -> Option<&'static str> {
    options.find(|(given, _)| *given).map(|(_, name)| name)
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    if is_deck(&arguments.building) {
        return super::fe_deck::run(arguments);
    }
    if arguments.skip_unknown {
        let what =
            "--skip-unknown is for decks: a building file with unknown keys is refused; leave the option out";
        return Err(Failure::input(what.into()));
    }
    let deck = super::fe_deck::to_write(arguments)?;
    let building = read_building(&arguments.building, arguments.json)?;
    let options = options(arguments, &building)?;
    if let Some(path) = deck {
        return super::fe_deck::write_building(arguments, &building, &options, path);
    }
    let other = arguments.against.as_deref().map(Other::read).transpose()?;
    let target = arguments.output.clone().unwrap_or_else(|| super::default_output(&building, "-fe"));
    let end_s = options.end_time_s.unwrap_or(building.settings.end_time_s);
    reaches_an_output(end_s, building.settings.output_interval_s).map_err(|e| failure(&e))?;
    let notes = notes(&building, &options);
    notes.iter().for_each(|note| eprintln!("warning: {note}"));
    let checkpoints =
        places::checkpoints(arguments.checkpoint_every, arguments.checkpoint.as_ref(), &target)?;
    let output = if checkpoints.is_some() || arguments.resume.is_some() {
        OutputFolder::unfinished(&target, Results::Fe, arguments.resume.is_some())
    } else {
        OutputFolder::create(&target, Results::Fe)
    };
    let output = output.map_err(|e| unwritable(&e))?;
    let progress = Progress::on_stderr();
    let pool = thread_pool(arguments.threads)?;
    let every = arguments.frames_every();
    let mut series = every.map(|every| VtuSeries::new(output.path(), every).after(&target));
    let frames = series.as_mut().map(|s| s as &mut dyn FrameSink);
    let attached = Attached { frames, checkpoints, resume: arguments.resume.clone() };
    let kept = || output.keep();
    let fe = pool.install(|| run_with_progress(&building, &options, attached, &kept, &progress))?;
    progress.finish();
    let mesh_size_m = options.mesh_size_m.unwrap_or(building.settings.mesh_size_m);
    write(&output, &building, &fe, mesh_size_m, "fe")?;
    places::remove_checkpoint(output.path())?;
    let folder = output.commit().map_err(|e| unwritable(&e))?;
    // the results are in their place whatever the other run is
    let against = other.map(|other| Against::of(&other, &fe)).transpose()?;
    let fell = fe.tracked.iter().any(|h| fell(&h.displacement_m));
    let collapsed = (!fe.tracked.is_empty()).then_some(fell);
    let unfired = unfired(&building, fe.times_s.last().copied().unwrap_or(0.0));
    let points = fe.tracked.iter().map(|h| (h.id.as_str(), &h.displacement_m[..]));
    let moving = moving_note(fell, &fe.times_s, points);
    if arguments.json {
        let mut value = json!(fe.summary);
        value["building"] = json!(building.name);
        value["form"] = json!(form_of(&fe));
        value["collapsed"] = json!(outcome(collapsed, &unfired));
        value["unfired"] = json!(unfired);
        if let Some(hybrid) = &fe.hybrid {
            value["hybrid"] = fe_hybrid::json(hybrid);
        }
        if let Some(against) = &against {
            value["against"] = against.json();
        }
        value["notes"] = json!(notes.iter().chain(&moving).collect::<Vec<_>>());
        value["output"] = json!(folder);
        print(&format!("{value:#}\n"));
        return Ok(Outcome::Done);
    }
    print(&format!(
        "{}: {} in the FE run\n{}{}  results: {}\n",
        building.name,
        outcome_words(collapsed, &unfired),
        moving.map_or(String::new(), |note| format!("  note: {note}\n")),
        zones_words(&building, &fe)
            + &summary(&fe.summary)
            + &fe.hybrid.as_ref().map_or(String::new(), fe_hybrid::words)
            + &against.as_ref().map_or(String::new(), Against::words)
            + &mesh_words(&building, &fe, mesh_size_m),
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
    let longest = |m: &Member| m.size_m().into_iter().fold(0.0, f64::max);
    let shortest = building.members.iter().min_by(|a, b| longest(a).total_cmp(&longest(b)));
    if let (Some(size), Some(member)) = (mesh_size_m, shortest)
        && size > 0.5 * longest(member)
    {
        let (noun, id, length) = (member.kind.name(), &member.id, longest(member));
        return Err(Failure::input(format!(
            "--mesh-size {size} is too coarse for the {noun} `{id}`, which is {length} m long; the largest is {} m",
            0.5 * length
        )));
    }
    if let Some(end) = end_time_s.filter(|end| *end > LONGEST_S) {
        return Err(Failure::input(format!("--end-time is {end} s, the longest is {LONGEST_S} s")));
    }
    arguments.knowledge.exist()?;
    let mass_scaling_step_s = positive("--mass-scaling-step", arguments.mass_scaling_step)?;
    let on_failure = match arguments.on_failure {
        OnFailure::Erode => Fate::Erode,
        OnFailure::Split => Fate::Split,
    };
    let mass_scaling_forced = arguments.force_mass_scaling;
    Ok(FeOptions {
        mesh_size_m,
        end_time_s,
        on_failure,
        mass_scaling_step_s,
        mass_scaling_forced,
        keep_frames: false,
        body_contact: !arguments.no_body_contact,
        skip_quiet: !arguments.compute_all,
        form: element_form(arguments)?,
        isa: instruction_set(arguments.isa.as_deref())?,
        hybrid: arguments.hybrid.settings(building, mesh_size_m, &arguments.knowledge)?,
        ..FeOptions::default()
    })
}

/// What a run will not do as one might expect: charges after its end, and an end between two outputs.
fn notes(building: &Building, options: &FeOptions) -> Vec<String> {
    let settings = &building.settings;
    let (asked_s, interval_s) =
        (options.end_time_s.unwrap_or(settings.end_time_s), settings.output_interval_s);
    let end_s = outputs(asked_s, interval_s) as f64 * interval_s;
    let mut notes = Vec::new();
    if options.hybrid.as_ref().is_some_and(|h| !h.softens) {
        notes.push(fe_hybrid::STAYS_RIGID.into());
    }
    if (end_s - asked_s).abs() > 1e-6 * interval_s {
        notes.push(format!("the run ends at {end_s} s, the output nearest to {asked_s} s"));
    }
    for charge in &building.events {
        let (id, member, from_s) = (&charge.id, &charge.member, charge.time_s);
        let to_s = from_s + settings.removal_duration_s;
        if from_s >= end_s {
            notes.push(format!(
                "the event `{id}` at {from_s} s comes after the end of the run at {end_s} s: `{member}` is not removed; give a later --end-time"
            ));
        } else if to_s > end_s {
            notes.push(format!(
                "the event `{id}` lasts from {from_s} to {to_s} s, the run to {end_s} s: a part of `{member}` still acts at its end; give a later --end-time"
            ));
        }
    }
    notes
}

/// The element form asked for.
fn element_form(arguments: &Arguments) -> Result<Option<ElementForm>, Failure> {
    arguments.form.as_deref().map(form_named).transpose()
}

/// The form with the name given for `--form`.
pub(super) fn form_named(name: &str) -> Result<ElementForm, Failure> {
    form(name).map(|tested| tested.form).map_err(|e| Failure::input(format!("--form: {e}")))
}

/// Name of the form that the elements of a run had: a run has one for all.
fn form_of(fe: &FeRun) -> Option<&'static str> {
    let law = fe.mesh.laws.first()?;
    FORMS.iter().find(|tested| tested.form == law.form).map(|tested| tested.name)
}

/// The instruction set asked for, or the fastest.
pub(super) fn instruction_set(name: Option<&str>) -> Result<Isa, Failure> {
    let isa = name.map_or(Ok(Isa::best()), Isa::named);
    isa.map_err(|e| Failure::input(format!("--isa: {e}")))
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

/// Runs the FE model, with rigid parts if the options say so, and shows how far it is; `kept` is called once there is a checkpoint.
pub fn run_with_progress(
    building: &Building,
    options: &FeOptions,
    attached: Attached<'_>,
    kept: &dyn Fn(),
    progress: &Progress,
) -> Result<FeRun, Failure> {
    let name = if options.hybrid.is_some() { "hybrid FE run" } else { "FE run" };
    progress.stage(&format!("{name}: dead load"));
    let mut began = false;
    let run = run_with(building, options, attached, &mut |at| {
        if at.checkpoints > 0 {
            kept();
        }
        if !began {
            progress.stage(name);
            began = true;
        }
        progress.advance(at.time_s / at.end_s, &format!("t = {:.2} of {:.2} s", at.time_s, at.end_s));
    });
    run.map_err(|e| failure(&e))
}

/// The record of a run, `NAME.json`, and its histories as CSV.
pub fn write(
    output: &OutputFolder,
    building: &Building,
    fe: &FeRun,
    mesh_size_m: f64,
    name: &str,
) -> Result<(), Failure> {
    let text = |value: &Value| readable_json(value).map_err(|e| Failure::input(e.to_string()));
    places::write(output, &format!("{name}.json"), &text(&record(building, fe, mesh_size_m)?)?)?;
    places::write(output, &format!("{name}-displacements.csv"), &displacements_csv(fe))?;
    places::write(output, &format!("{name}-energies.csv"), &energies_csv(fe))?;
    if let Some(hybrid) = &fe.hybrid {
        places::write(output, "hybrid.csv", &fe_hybrid::partition_csv(&fe.times_s, hybrid))?;
        places::write(output, "hybrid-switches.csv", &fe_hybrid::switches_csv(hybrid))?;
    }
    places::write(output, &format!("{name}-events.csv"), &events_csv(fe))
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
    let mut record = json!({
        "schema": FE_SCHEMA,
        "building": building.name,
        "building_hash": hash.to_string(),
        "program_version": env!("CARGO_PKG_VERSION"),
        "mesh_size_m": mesh_size_m,
        "form": form_of(fe),
        "summary": summary,
        "snapped": snapped,
        "deaths": {
            "eroded": deaths(Death::Eroded),
            "collapsed": deaths(Death::Collapsed),
            "removed": deaths(Death::Removed),
            "torn": deaths(Death::Torn),
            "split": deaths(Death::Split),
        },
        "ruptures": fe.ruptures,
        "touches": fe.touches,
        "times_s": fe.times_s,
        "tracked": fe.tracked,
        "energies": fe.energies,
    });
    if let Some(hybrid) = &fe.hybrid {
        record["hybrid"] = json!(hybrid);
    }
    Ok(record)
}

/// Displacements of the tracked points, columns `time_s, <id>_x_m, ...`.
pub fn displacements_csv(fe: &FeRun) -> String {
    let mut text = String::from("time_s");
    for point in &fe.tracked {
        let _ = write!(text, ",{0}_x_m,{0}_y_m,{0}_z_m", point.id);
    }
    text.push('\n');
    for (i, time) in fe.times_s.iter().enumerate() {
        let _ = write!(text, "{}", in_table(*time));
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
        "time_s,kinetic_j,internal_j,eroded_j,hourglass_j,viscous_j,gravity_j,contact_j,friction_j,removed_j,released_j,residual_j\n",
    );
    for (time, e) in fe.times_s.iter().zip(&fe.energies) {
        let _ = writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{},{},{}",
            in_table(*time),
            e.kinetic_j,
            e.internal_j,
            e.eroded_j,
            e.hourglass_j,
            e.viscous_j,
            e.gravity_j,
            e.contact_j,
            e.friction_j,
            e.removed_j,
            e.released_j,
            e.residual_j
        );
    }
    text
}

/// Ends of elements, ruptures of bars and first contacts of parts, in order of time; positions are centres in the undeformed mesh.
pub fn events_csv(fe: &FeRun) -> String {
    let ends = fe.deaths.iter().map(|d| {
        let word = match d.cause {
            Death::Eroded => "eroded",
            Death::Collapsed => "collapsed",
            Death::Removed => "removed",
            Death::Torn => "torn",
            Death::Split => "split",
        };
        let part = &fe.mesh.parts[fe.mesh.elements[d.element].part];
        let [x, y, z] = fe.mesh.center(d.element);
        (d.time_s, format!("{word},{part},,{},{x},{y},{z},", d.element))
    });
    let ruptures = fe.ruptures.iter().map(|r| {
        let [a, b] = fe.mesh.trusses[r.bar].nodes.map(|n| fe.mesh.nodes[n]);
        let [x, y, z]: [f64; 3] = std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        (r.time_s, format!("ruptured,{},,{},{x},{y},{z},{}", fe.mesh.parts[r.part], r.bar, r.strain))
    });
    let contacts = fe.touches.iter().map(|t| (t.time_s, format!("contact,{},{},,,,,", t.part, t.surface)));
    let mut events: Vec<(f64, String)> = ends.chain(ruptures).chain(contacts).collect();
    events.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut text = String::from("time_s,event,part,surface,element,x_m,y_m,z_m,strain\n");
    for (time_s, event) in events {
        let _ = writeln!(text, "{time_s},{event}");
    }
    text
}

fn zones_words(building: &Building, fe: &FeRun) -> String {
    let facts = facts(building, fe);
    let zones: Vec<&str> = facts.ends.iter().filter(|z| z.first_s.is_some()).map(|z| z.id.as_str()).collect();
    format!("  member ends above the critical strain rate: {} of {}\n", zones.len(), facts.ends.len())
}

/// Form of the elements, the mesh in a line, and what makes its step small.
fn mesh_words(building: &Building, fe: &FeRun, mesh_size_m: f64) -> String {
    let Some(quality) = Quality::of(&fe.mesh, &fe.snapped) else { return String::new() };
    let note =
        sliver_note(building, &quality, mesh_size_m).map_or(String::new(), |n| format!("  note: {n}\n"));
    let form = form_of(fe).map_or(String::new(), |f| format!("  element form: {f}\n"));
    format!("{form}  {}\n{note}", quality.line())
}

fn summary(s: &FeSummary) -> String {
    let contact = s.body_contact.as_ref().map_or("off".to_string(), |c| {
        format!(
            "{} searches and {} local ones, at most {} pairs and {} contacts, {:.1} mm deep; {:.1} kJ",
            c.searches,
            c.local_searches,
            c.most_pairs,
            c.most_contacts,
            1e3 * c.deepest_m,
            1e-3 * (c.normal_j + c.friction_j)
        )
    });
    format!(
        "  {} elements, {} nodes, {:.2} t; {} steps of {:.3} ms\n  \
         first ground contact: {}\n  eroded elements: {}\n  \
         energy error {}, hourglass share {}\n  contact of the parts: {contact}\n  run time: {:.1} s wall, {:.1} s processor\n",
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
    ) + &erosion_words(&s.erosion)
        + &bar_words(s)
        + &s.mass_scaling.as_ref().map_or(String::new(), mass_scaling_words)
}

/// Ruptured bars, if there are any.
fn bar_words(s: &FeSummary) -> String {
    if s.ruptured_bars == 0 { String::new() } else { format!("  ruptured bars: {}\n", s.ruptured_bars) }
}

/// What failed elements took with them, if any did.
fn erosion_words(table: &ErosionTable) -> String {
    let mut text = String::new();
    let causes = [
        ("by plastic strain", &table.plastic_strain),
        ("by principal strain", &table.principal_strain),
        ("by collapse of the step", &table.step_collapse),
        ("detached as debris", &table.split),
    ];
    let failed = causes.iter().filter(|(_, loss)| loss.elements > 0);
    for (cause, Loss { elements, mass_kg, internal_j, elastic_j, .. }) in failed {
        let _ = writeln!(
            text,
            "  {cause}: {elements} elements, {:.2} t, {:.1} kJ of work, {:.1} kJ of it elastic",
            mass_kg / 1e3,
            internal_j / 1e3,
            elastic_j / 1e3
        );
    }
    if table.free.nodes > 0 {
        let _ = writeln!(
            text,
            "  free debris nodes: {}, {:.2} t, kinetic energy {:.1} kJ",
            table.free.nodes,
            table.free.mass_kg / 1e3,
            table.free.kinetic_j / 1e3
        );
    }
    text
}

fn mass_scaling_words(scaling: &MassScaling) -> String {
    let mut text = format!(
        "  mass scaling: {:.1} kg on {} elements, {} of the mass\n",
        scaling.added_kg,
        scaling.elements,
        percent(scaling.added_share)
    );
    for part in &scaling.parts {
        let _ = writeln!(text, "    {}: {:.1} kg, {}", part.part, part.added_kg, percent(part.added_share));
    }
    text
}
