//! `fallwerk study compare`: generated models against the records of FE studies.

use super::knowledge::{CurveArgs, LatentArgs};
use super::progress::Progress;
use super::study::STUDIES;
use super::study_run::{Task, files};
use super::{Failure, Outcome, counted, print};
use crate::generate::generate;
use crate::learn::ablation;
use crate::library::Store;
use crate::rules::RuleBase;
use crate::validate::record::{Agreement, Together};
use crate::validate::{LIMIT_STANDING_M, LIMIT_TO_CONTACT};
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;

/// What is compared.
#[derive(clap::Args)]
pub struct Arguments {
    /// Building files, or folders of them
    #[arg(required = true)]
    buildings: Vec<PathBuf>,
    /// Folder of the records
    #[arg(long, value_name = "DIR", default_value = STUDIES)]
    kb: PathBuf,
    #[command(flatten)]
    curves: CurveArgs,
    #[command(flatten)]
    latent: LatentArgs,
    /// Compare with models of other rules as well: the seed rules alone, hinges everywhere and nowhere, floors rigid and bending; only the figures of all buildings together
    #[arg(long)]
    ablation: bool,
    /// Print as JSON
    #[arg(long)]
    pub(super) json: bool,
}

/// A building without a comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct Missed {
    building: String,
    why: String,
    /// Of several sets of rules those that have none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rules: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Compared {
    together: Together,
    runs: Vec<Agreement>,
    /// Buildings without a comparison.
    missed: Vec<Missed>,
}

/// Several sets of rules, over the buildings that all of them have a comparison of.
#[derive(Debug, Serialize)]
struct Ablation {
    together: Vec<(String, Together)>,
    /// Buildings that are left out of all sets, since some have no comparison of them.
    missed: Vec<Missed>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let files = files(&arguments.buildings)?;
    let (rules, mut store) = arguments.curves.open()?;
    let progress = Progress::on_stderr();
    let sets = if arguments.ablation {
        ablation::sets(&rules).map_err(|problems| Failure::input(problems.to_string()))?
    } else {
        vec![("", rules)]
    };
    let mut results: Vec<(&str, Compared)> = Vec::new();
    for (name, rules) in &sets {
        progress.stage(if name.is_empty() { "models" } else { name });
        results.push((name, compared(arguments, &files, rules, &mut store, &progress)));
    }
    progress.finish();
    let is_whole = results.iter().all(|(_, compared)| compared.missed.is_empty());
    let text = match &results[..] {
        [(_, one)] if arguments.json => json(one)?,
        [(_, one)] => as_text(one),
        many if arguments.json => json(&Ablation { together: common(many), missed: missed(many) })?,
        many => as_table(&common(many)) + &as_words(&missed(many)),
    };
    print(&text);
    Ok(if is_whole { Outcome::Done } else { Outcome::CheckFailed })
}

/// All buildings with one set of rules.
fn compared(
    arguments: &Arguments,
    files: &[PathBuf],
    rules: &RuleBase,
    store: &mut Store,
    progress: &Progress,
) -> Compared {
    let (mut runs, mut missed) = (Vec::new(), Vec::new());
    for (done, file) in files.iter().enumerate() {
        let name = file.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        progress.advance(done as f64 / files.len() as f64, &name);
        match one(arguments, file.clone(), rules, store, progress) {
            Ok(agreement) => runs.push(agreement),
            Err(failure) => missed.push(Missed { building: name, why: failure.message, rules: Vec::new() }),
        }
    }
    Compared { together: Together::of(&runs), runs, missed }
}

/// The buildings that some set of rules has no comparison of, with the names of these sets unless they are all.
fn missed(results: &[(&str, Compared)]) -> Vec<Missed> {
    let mut list: Vec<Missed> = Vec::new();
    for (name, compared) in results {
        for m in &compared.missed {
            match list.iter_mut().find(|own| (&own.building, &own.why) == (&m.building, &m.why)) {
                Some(own) => own.rules.push(name.to_string()),
                None => list.push(Missed { rules: vec![name.to_string()], ..m.clone() }),
            }
        }
    }
    list.iter_mut().filter(|m| m.rules.len() == results.len()).for_each(|m| m.rules.clear());
    list
}

/// Figures of each set of rules over the buildings that all of them have a model of.
fn common(results: &[(&str, Compared)]) -> Vec<(String, Together)> {
    let has = |compared: &Compared, name: &str| compared.runs.iter().any(|r| r.building == name);
    let of = |(name, compared): &(&str, Compared)| {
        let all = |r: &&Agreement| results.iter().all(|(_, c)| has(c, &r.building));
        let runs: Vec<Agreement> = compared.runs.iter().filter(all).cloned().collect();
        ((*name).to_string(), Together::of(&runs))
    };
    results.iter().map(of).collect()
}

fn as_table(sets: &[(String, Together)]) -> String {
    let mut text = String::from(
        "| rules | buildings | e to contact: median, 90 % | of those that fall | e total: median, 90 % | of those that fall | F1 of zones, turning to contact, turning | outcome right | agree |\n\
         |---|---:|---|---|---|---|---|---:|---:|\n",
    );
    for (name, t) in sets {
        let [zones, turning_before, turning] = t.f1;
        let f1 = match t.buildings {
            0 => "none".to_string(),
            _ => format!("{zones:.2}, {turning_before:.2}, {turning:.2}"),
        };
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} | {} | {f1} | {} | {} |",
            t.buildings,
            pair(t.e_to_contact),
            pair(t.e_to_contact_falling),
            pair(t.e_total),
            pair(t.e_total_falling),
            t.collapse_right,
            t.agree
        );
    }
    text
}

/// Median and 90th percentile, or that there are none.
fn pair([median, most]: [f64; 2]) -> String {
    if median.is_finite() { format!("{median:.3}, {most:.3}") } else { "none".to_string() }
}

fn one(
    arguments: &Arguments,
    file: PathBuf,
    rules: &RuleBase,
    store: &mut Store,
    progress: &Progress,
) -> Result<Agreement, Failure> {
    let task = Task::told(file, &arguments.kb)?;
    if !task.has_record() {
        let kb = arguments.kb.display();
        return Err(Failure::input(format!("no record in {kb}; `fallwerk study run` makes it")));
    }
    let study = task.study()?.ok_or_else(|| {
        Failure::input("its record is of another input; `fallwerk study run --again` makes it anew".into())
    })?;
    let generated =
        generate(&task.building, rules, store, arguments.curves.wishes(), &|text| progress.note(text))
            .map_err(|e| Failure::input(e.to_string()))?;
    let run = crate::mbs::simulate_with(&generated.model, &arguments.latent.options())
        .map_err(|e| Failure::stopped(format!("the MBS run: {e}")))?;
    Ok(Agreement::of(&study, &generated.model, &run))
}

fn json(value: &impl Serialize) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(value).map_err(|e| Failure::stopped(e.to_string()))?;
    Ok(text + "\n")
}

fn as_text(compared: &Compared) -> String {
    let text = if compared.runs.is_empty() { String::new() } else { figures(compared) };
    text + &as_words(&compared.missed)
}

/// Buildings without a comparison, those of one reason in one line.
fn as_words(missed: &[Missed]) -> String {
    let mut reasons: BTreeMap<(&str, &[String]), Vec<&str>> = BTreeMap::new();
    missed
        .iter()
        .for_each(|m| reasons.entry((m.why.as_str(), m.rules.as_slice())).or_default().push(&m.building));
    let mut text = String::new();
    for ((why, rules), buildings) in reasons {
        let of = if rules.is_empty() { String::new() } else { format!(" with {}", rules.join(", ")) };
        let _ = writeln!(text, "no comparison of {}{of}: {why}", buildings.join(", "));
    }
    text
}

/// Figures of each building, and of all together.
fn figures(compared: &Compared) -> String {
    let mut text = String::from(
        "building              e to contact  e total  without debris  difference [m]  contact FE, MBS [s]  collapse FE, MBS  F1 of zones, turning to contact, turning  bodies   CPU [ms]  energy\n",
    );
    let figure = |x: Option<f64>, digits: usize| x.map_or("-".to_string(), |x| format!("{x:.digits$}"));
    let time = |t: Option<f64>| figure(t, 2);
    let falls = |c: bool| if c { "falls" } else { "stands" };
    for r in &compared.runs {
        let _ = writeln!(
            text,
            "{:<22}{:>12}{:>9}{:>16}{:>16.3}{:>12}{:>9}{:>11}{:>7}{:>13}{:>20}{:>9}{:>8}{:>11.2}{:>8.0e}",
            r.building,
            figure(r.e_to_contact, 3),
            figure(r.e_total, 3),
            figure(r.e_total_without_debris, 3),
            r.largest_difference_m,
            time(r.first_contact_s.fe),
            time(r.first_contact_s.mbs),
            falls(r.collapsed.fe),
            falls(r.collapsed.mbs),
            figure(r.hinges.f1, 2),
            figure(r.turning_before_contact.f1, 2),
            figure(r.turning.f1, 2),
            r.bodies,
            1e3 * r.cpu_s,
            r.energy_error
        );
    }
    text + &all_together(&compared.together)
}

/// Figures of all buildings, in two lines.
fn all_together(t: &Together) -> String {
    let mut text = String::new();
    let [median, most] = t.e_to_contact;
    let to_contact = match median.is_finite() {
        true => format!("median {median:.3}, 90th percentile {most:.3}"),
        false => "none".to_string(),
    };
    let _ = writeln!(
        text,
        "{}: e to contact {}; e total {}; F1 of zones {:.2}, of turning to contact {:.2}, of turning {:.2}; collapse right in {}",
        counted(t.buildings, "building", "buildings"),
        to_contact,
        pair(t.e_total),
        t.f1[0],
        t.f1[1],
        t.f1[2],
        t.collapse_right
    );
    let falling = match t.falling {
        0 => "none of them falls".to_string(),
        count => format!(
            "of them {}: e to contact {}; from there on {}; e total {}",
            counted(count, "falls", "fall"),
            pair(t.e_to_contact_falling),
            pair(t.e_after_contact_falling),
            pair(t.e_total_falling)
        ),
    };
    let _ = writeln!(
        text,
        "{falling}. {}: outcome right, and e to contact at most {LIMIT_TO_CONTACT} or, where the building stands, displacements within {LIMIT_STANDING_M} m",
        counted(t.agree, "agrees", "agree")
    );
    let [low, middle, high] = t.largest_standing;
    if middle.is_finite() {
        let _ = writeln!(
            text,
            "of those that stand the largest displacement is {middle:.2} times that of FE in the median, {low:.2} and {high:.2} at the 10th and 90th percentile"
        );
    }
    text
}
