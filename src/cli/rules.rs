//! `fallwerk rules`: list, show and check the rules, learn them from studies, compare two folders of them.
//!
//! Exit codes: 0 done; 1 a check failed (problems or gaps); 2 bad input or usage.

use super::rules_learn::{LearnArgs, difference, learned};
use super::study::STUDIES;
use super::{Failure, knowledge};
use crate::base::hash::readable_json;
use crate::rules::diff::statistics;
use crate::rules::{Problem, Problems, Rule, RuleBase, Source, features};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Arguments of `fallwerk rules`.
#[derive(Debug, Clone, Args)]
pub struct RulesArgs {
    /// The folder of rule files [default: rules, else the program's]
    #[arg(long, global = true, value_name = "DIR")]
    pub rules: Option<PathBuf>,
    /// Print JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// What to do
    #[command(subcommand)]
    pub command: RulesCommand,
}

/// The commands of `fallwerk rules`.
#[derive(Debug, Clone, Subcommand)]
pub enum RulesCommand {
    /// List the rules in the order of evaluation
    List,
    /// Check all rule files: names, types, conflicts, gaps
    Check,
    /// Show one rule
    Show {
        /// Id of the rule
        id: String,
    },
    /// List the features that conditions can name
    Features,
    /// Learn rules from the records of FE studies
    ///
    /// Writes a rule file for each question that the studies can answer, a list of rules for review (which are not used), and a report. The same records give the
    /// same bytes. Rules are compared with the seed rules of the program, which stay where there are too few studies.
    Learn(LearnArgs),
    /// Show what changed between two folders of rules: added, removed, thresholds, evidence
    ///
    /// Exit codes: 0 no change, 1 changes, 2 bad input or usage.
    Diff {
        /// Folder of the rules before
        old: PathBuf,
        /// Folder of the rules after
        new: PathBuf,
    },
}

/// Runs the command on standard output and error; returns the exit code.
pub fn run(args: &RulesArgs) -> u8 {
    // not locked: progress is told from other threads
    execute(args, &mut io::stdout(), &mut io::stderr())
}

/// Runs the command; results go to `out`, messages to `err`. Returns the exit code.
pub fn execute(args: &RulesArgs, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    match attempt(args, out, err) {
        Ok(code) => code,
        // Whoever reads the output has seen enough (`| head`).
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => 0,
        Err(error) => {
            let _ = writeln!(err, "error: cannot write the output: {error}");
            2
        }
    }
}

fn attempt(args: &RulesArgs, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<u8> {
    match &args.command {
        RulesCommand::Features => return list_features(args.json, out),
        RulesCommand::Learn(arguments) => {
            return match learned(arguments, args.rules.as_deref()) {
                Ok(written) if args.json => write_json(out, &json!(written)).map(|()| 0),
                Ok(written) => out.write_all(written.words().as_bytes()).map(|()| 0),
                Err(failure) => fail(&failure, args.json, out, err),
            };
        }
        RulesCommand::Diff { old, new } => return diff([old, new], args.json, out, err),
        _ => {}
    }
    let checking = matches!(args.command, RulesCommand::Check);
    let base = match knowledge::rule_base(args.rules.as_deref()) {
        Ok(base) => base,
        Err(problems) => {
            if checking && args.json {
                let list: Vec<String> = problems.0.iter().map(ToString::to_string).collect();
                write_json(out, &json!({ "problems": list, "gaps": [], "remarks": [] }))?;
            } else if checking {
                writeln!(err, "{problems}\n{}", problems.count_words())?;
            } else {
                return refuse(&problems, args.json, out, err);
            }
            return Ok(if checking && !problems.has_unread() { 1 } else { 2 });
        }
    };
    match &args.command {
        RulesCommand::List => list(&base, args.json, out),
        RulesCommand::Check => check(&base, args.json, out),
        RulesCommand::Show { id } => match base.rule(id) {
            Some(rule) => show(rule, args.json, out),
            None => {
                let near = features::suggestion(id, base.rules().iter().map(|r| r.id.as_str()));
                let hint = near.map_or(String::new(), |n| format!("; did you mean `{n}`?"));
                fail(&Failure::input(format!("no rule `{id}`{hint}")), args.json, out, err)
            }
        },
        RulesCommand::Features | RulesCommand::Learn(_) | RulesCommand::Diff { .. } => Ok(0),
    }
}

/// Says why the command failed, with `json` on standard output as well; returns the exit code.
fn fail(failure: &Failure, json: bool, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<u8> {
    writeln!(err, "error: {}", failure.message)?;
    if json {
        write_json(out, &failure.to_json())?;
    }
    Ok(failure.outcome as u8)
}

/// Says why rules cannot be read, with `json` on standard output as well; returns the exit code.
fn refuse(problems: &Problems, json: bool, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<u8> {
    let failures: Vec<Failure> =
        problems.0.iter().map(|problem| Failure::input(problem.to_string())).collect();
    failures.iter().try_for_each(|failure| writeln!(err, "error: {}", failure.message))?;
    if json {
        let all: Vec<Value> =
            failures.iter().map(|failure| failure.to_json()["diagnostics"][0].take()).collect();
        write_json(out, &json!({ "ok": false, "diagnostics": all }))?;
    }
    Ok(2)
}

fn diff(folders: [&PathBuf; 2], json: bool, out: &mut dyn Write, err: &mut dyn Write) -> io::Result<u8> {
    let [old, new] = folders.map(|folder| read_alone(folder));
    let (old, new) = match (old, new) {
        (Ok(old), Ok(new)) => (old, new),
        (Err(problems), _) | (_, Err(problems)) => return refuse(&problems, json, out, err),
    };
    let (list, text) = difference(&old, &new);
    if json {
        write_json(out, &json!({ "changes": list }))?;
    } else {
        out.write_all(text.as_bytes())?;
    }
    Ok(u8::from(!list.is_empty()))
}

/// The rules of a folder; learned ones supersede seed rules, so that a folder of these alone is read beside the seed rules of the program.
fn read_alone(folder: &Path) -> Result<RuleBase, Problems> {
    RuleBase::load(folder).or_else(|problems| {
        let sources: Vec<Source> = RuleBase::sources(folder)?;
        RuleBase::seed()?.with(sources).map(|base| base.without("seed/")).map_err(|_| problems)
    })
}

fn write_json(out: &mut dyn Write, value: &Value) -> io::Result<()> {
    out.write_all(readable_json(value).map_err(io::Error::from)?.as_bytes())
}

fn list(base: &RuleBase, json: bool, out: &mut dyn Write) -> io::Result<u8> {
    if json {
        write_json(out, &json!({ "rules": base.rules() }))?;
    } else {
        for rule in base.rules() {
            writeln!(
                out,
                "{:4}  {:38} {:14} {}",
                rule.priority,
                rule.id,
                rule.applies_to.name(),
                rule.action.spec().name
            )?;
        }
    }
    Ok(0)
}

fn show(rule: &Rule, json: bool, out: &mut dyn Write) -> io::Result<u8> {
    if json {
        write_json(out, &json!(rule))?;
        return Ok(0);
    }
    writeln!(out, "{}  ({})", rule.id, rule.place.short())?;
    writeln!(out, "  {}", rule.words)?;
    writeln!(out, "  about       {}", rule.applies_to)?;
    writeln!(out, "  when        {}", rule.when)?;
    let parameters: Vec<String> =
        rule.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    writeln!(out, "  action      {} {}", rule.action.spec().name, parameters.join(", "))?;
    writeln!(out, "              ({})", rule.action.spec().meaning)?;
    writeln!(out, "  priority    {}", rule.priority)?;
    writeln!(out, "  source      {}", rule.source)?;
    if let Some(s) = &rule.statistics {
        writeln!(out, "  studies say {}", statistics(s))?;
    }
    for id in &rule.evidence {
        writeln!(out, "  study       {id}")?;
    }
    for place in &rule.counter_examples {
        writeln!(out, "  wrong at    {place}")?;
    }
    for (name, [low, high]) in &rule.range {
        writeln!(out, "  range       {name} from {low} to {high}")?;
    }
    for id in &rule.supersedes {
        writeln!(out, "  supersedes  {id}")?;
    }
    Ok(0)
}

fn check(base: &RuleBase, json: bool, out: &mut dyn Write) -> io::Result<u8> {
    let (problems, gaps, remarks) = (base.not_carried_out(), base.gaps(), base.remarks());
    let unknown = unknown_studies(base, Path::new(STUDIES));
    let fails = !(problems.is_empty() && gaps.is_empty() && remarks.is_empty());
    if json {
        let words = |list: &[Problem]| list.iter().map(ToString::to_string).collect::<Vec<_>>();
        let (count, problems, remarks) = (base.rules().len(), words(&problems), words(&remarks));
        let value = json!({ "rules": count, "problems": problems, "gaps": gaps, "remarks": remarks, "unknown_studies": unknown });
        write_json(out, &value)?;
    } else {
        for words in &unknown {
            writeln!(out, "note: {words}")?;
        }
        for problem in problems.iter().chain(&remarks) {
            writeln!(out, "{problem}")?;
        }
        for gap in &gaps {
            writeln!(out, "{gap}")?;
        }
        let found = [
            counted(problems.len(), "rule that cannot be carried out", "rules that cannot be carried out"),
            counted(gaps.len(), "gap", "gaps"),
            counted(remarks.len(), "comparison that decides nothing", "comparisons that decide nothing"),
        ];
        let found: Vec<String> = found.into_iter().flatten().collect();
        let verdict = if found.is_empty() { "no conflict, no gap".to_string() } else { found.join(", ") };
        writeln!(out, "{} rules: {verdict}", base.rules().len())?;
    }
    Ok(u8::from(fails))
}

/// Rules whose evidence names studies of which there is no record, in words; none where there is no folder of records.
fn unknown_studies(base: &RuleBase, folder: &Path) -> Vec<String> {
    if !folder.is_dir() {
        return Vec::new();
    }
    let mut list = Vec::new();
    for rule in base.rules() {
        // `s1-110:W3.top` is a place in `s1-110`
        let named = rule.evidence.iter().chain(&rule.counter_examples);
        let named: BTreeSet<&str> = named.filter_map(|name| name.split(':').next()).collect();
        let unknown = named.into_iter().filter(|study| !folder.join(format!("{study}.json")).is_file());
        list.extend(unknown.map(|study| {
            format!("rule `{}` names the study `{study}`, of which {STUDIES} has no record", rule.id)
        }));
    }
    list
}

/// `1 gap`, `2 gaps`; none of none.
fn counted(count: usize, one: &str, many: &str) -> Option<String> {
    match count {
        0 => None,
        1 => Some(format!("1 {one}")),
        count => Some(format!("{count} {many}")),
    }
}

fn list_features(json: bool, out: &mut dyn Write) -> io::Result<u8> {
    let subjects = |f: &features::Feature| f.subjects.iter().map(|k| k.name()).collect::<Vec<_>>();
    if json {
        let rows: Vec<Value> = features::CATALOGUE
            .iter()
            .map(|f| json!({ "name": f.name, "type": f.type_words(), "subjects": subjects(f), "meaning": f.meaning }))
            .collect();
        write_json(out, &json!({ "features": rows }))?;
    } else {
        for f in features::CATALOGUE {
            writeln!(
                out,
                "{}: {}\n    {}\n    of {}",
                f.name,
                f.meaning,
                f.type_words(),
                subjects(f).join(", ")
            )?;
        }
    }
    Ok(0)
}
