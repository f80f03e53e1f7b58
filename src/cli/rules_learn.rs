//! `fallwerk rules learn` and `fallwerk rules diff`: rules out of study records, and what changed between two rule folders.

use super::Failure;
use super::study::{self, STUDIES};
use super::study_run::Task;
use crate::base::output::write_atomic;
use crate::learn::{Case, Learned, file_names, learn};
use crate::rules::diff::{Change, changes};
use crate::rules::{Problems, RuleBase};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Where records and buildings are found, and where the rules go.
#[derive(Debug, Clone, clap::Args)]
pub struct LearnArgs {
    /// Folder of the study records
    #[arg(long, value_name = "DIR", default_value = STUDIES)]
    pub kb: PathBuf,
    /// Folder of the building files of the studies, in the place of those by default; several: once for each
    #[arg(long, value_name = "DIR", default_values = ["kb/plan", "kb/irregular", "buildings"])]
    pub plan: Vec<PathBuf>,
    /// Folder for the rules, the review list and the report [default: learned in the folder of --rules, else rules/learned]
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

/// What was learned, and where it was written.
#[derive(Debug, Serialize)]
pub struct Written {
    /// Number of studies.
    pub studies: usize,
    /// Number of rules.
    pub rules: usize,
    /// The folder.
    pub output: String,
    /// Files whose questions have no rules any more.
    pub removed: Vec<String>,
}

impl Written {
    /// In words.
    pub fn words(&self) -> String {
        let removed = |path: &String| format!("removed {path}: its question has no rules any more\n");
        let removed: String = self.removed.iter().map(removed).collect();
        let studies =
            if self.studies == 1 { "1 study".to_string() } else { format!("{} studies", self.studies) };
        format!("{removed}{studies}, {} rules in {}\n", self.rules, self.output)
    }
}

/// The folder that is written to, with the folder of rules that the command line names.
fn folder(arguments: &LearnArgs, rules: Option<&Path>) -> Result<PathBuf, Failure> {
    match (&arguments.output, rules) {
        (Some(output), _) => Ok(output.clone()),
        (None, None) => Ok(Path::new("rules").join("learned")),
        (None, Some(rules)) if rules.is_dir() => Ok(rules.join("learned")),
        (None, Some(rules)) => {
            Err(Failure::input(format!("--rules: {} is not a folder; make it first", rules.display())))
        }
    }
}

/// Learns and writes; `rules` is the folder of rules that the command line names.
///
/// # Errors
/// If a record cannot be read, its building is not found or has changed, or the files cannot be written.
pub fn learned(arguments: &LearnArgs, rules: Option<&Path>) -> Result<Written, Failure> {
    let output = folder(arguments, rules)?;
    let cases = cases(&arguments.kb, &arguments.plan)?;
    let seed = RuleBase::seed().map_err(told)?;
    let Learned { files } = learn(&cases, &seed).map_err(told)?;
    let failed =
        |path: &Path, e: std::io::Error| Failure::input(format!("cannot write {}: {e}", path.display()));
    fs::create_dir_all(&output).map_err(|e| failed(&output, e))?;
    let paths: Vec<(String, PathBuf)> =
        file_names().into_iter().map(|name| (name.clone(), output.join(name))).collect();
    if let Some((_, path)) = paths.iter().find(|(_, path)| path.exists() && !is_learned(path)) {
        return Err(Failure::input(format!(
            "{} was not written by `fallwerk rules learn` and would be replaced; name another folder with -o, or move it",
            path.display()
        )));
    }
    let mut removed = Vec::new();
    for (name, path) in &paths {
        match files.iter().find(|(file, _)| file == name) {
            Some((_, text)) => write_atomic(path, text.as_bytes()).map_err(|e| failed(path, e))?,
            None if path.is_file() => {
                fs::remove_file(path).map_err(|e| failed(path, e))?;
                removed.push(path.display().to_string());
            }
            None => {}
        }
    }
    let rules = files.iter().filter(|(name, _)| name.ends_with(".toml"));
    let rules = rules.map(|(_, text)| text.matches("[[rule]]").count()).sum();
    Ok(Written { studies: cases.len(), rules, output: output.display().to_string(), removed })
}

/// Whether a file names this command as its author.
fn is_learned(path: &Path) -> bool {
    fs::read_to_string(path).is_ok_and(|text| text.contains("`fallwerk rules learn`"))
}

fn told(problems: Problems) -> Failure {
    Failure::input(problems.to_string())
}

/// The studies of a folder with the features of their buildings, by name.
///
/// # Errors
/// If there is none, a record cannot be read, or its building is not found or has changed.
pub fn cases(kb: &Path, plans: &[PathBuf]) -> Result<Vec<Case>, Failure> {
    let failed = |e: std::io::Error| Failure::input(format!("cannot read {}: {e}", kb.display()));
    let mut records = Vec::new();
    for entry in fs::read_dir(kb).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        if path.extension().is_some_and(|x| x == "json") {
            records.push(path);
        }
    }
    records.sort();
    if records.is_empty() {
        return Err(Failure::input(format!("{} has no study records (*.json)", kb.display())));
    }
    let cases: Vec<Case> =
        records.par_iter().map(|record| case(record, kb, plans)).collect::<Result<_, _>>()?;
    // a building counts once: in what supports a rule, and in which part of a cross-validation it is
    let mut first: BTreeMap<&str, &Path> = BTreeMap::new();
    for (case, record) in cases.iter().zip(&records) {
        if let Some(other) = first.insert(&case.study.building, record) {
            return Err(Failure::input(format!(
                "{} and {} are records of the same building, {}: remove one of them",
                other.display(),
                record.display(),
                case.study.building
            )));
        }
    }
    Ok(cases)
}

fn case(record: &Path, kb: &Path, plans: &[PathBuf]) -> Result<Case, Failure> {
    let name = study::read(record)?.building;
    let folders = || plans.iter().map(|p| p.display().to_string()).collect::<Vec<_>>().join(", ");
    let file = plans.iter().map(|plan| plan.join(format!("{name}.toml"))).find(|file| file.is_file());
    let file = file.ok_or_else(|| {
        let message = format!("no {name}.toml, of which {} is, in {}", record.display(), folders());
        let all: Vec<String> = plans.iter().map(|plan| format!("--plan {}", plan.display())).collect();
        Failure::input(format!("{message}; name its folder beside these: {} --plan DIR", all.join(" ")))
    })?;
    let task = Task::told(file.clone(), kb)?;
    let study = task.study()?.ok_or_else(|| {
        let message = format!("{} is of another input than {}", record.display(), file.display());
        Failure::input(format!("{message}; run `fallwerk study run --again` or remove the record"))
    })?;
    task.building.without_skew("no features can be computed").map_err(Failure::input)?;
    Ok(Case::of(study, &task.building))
}

/// What changed between the rules of two folders, in words.
pub fn difference(old: &RuleBase, new: &RuleBase) -> (Vec<Change>, String) {
    let list = changes(old, new);
    let mut text = String::new();
    for change in &list {
        text += &match change {
            Change::Added { rule, when, action } => format!("+ {rule}: {action} when {when}\n"),
            Change::Removed { rule, when, action } => format!("- {rule}: {action} when {when}\n"),
            Change::Changed { rule, fields } => {
                let of = |f: &crate::rules::diff::FieldChange| match f.field.as_str() {
                    list @ ("evidence" | "counter_examples") => {
                        format!("    {list}{}{}\n", signed(" without ", &f.old), signed(" with ", &f.new))
                    }
                    field => format!("    {field}\n      - {}\n      + {}\n", f.old, f.new),
                };
                format!("~ {rule}\n{}", fields.iter().map(of).collect::<String>())
            }
        };
    }
    let count = |of: fn(&Change) -> bool| list.iter().filter(|c| of(c)).count();
    text += &format!(
        "{} added, {} removed, {} changed\n",
        count(|c| matches!(c, Change::Added { .. })),
        count(|c| matches!(c, Change::Removed { .. })),
        count(|c| matches!(c, Change::Changed { .. }))
    );
    (list, text)
}

fn signed(word: &str, list: &str) -> String {
    if list.is_empty() { String::new() } else { format!("{word}{list}") }
}
