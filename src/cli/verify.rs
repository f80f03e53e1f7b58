//! `fallwerk verify`: the verification manual, run live.

use super::progress::Progress;
use super::verify_columns;
use super::{Failure, Outcome, print, thread_pool, write};
use crate::base::output::OutputFolder;
use crate::base::results::Results;
use crate::verify::{Case, Figure, Form, fe, manual, mbs, rc, select, suite};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Verify a solver against closed forms and published results
///
/// Each case is run now; nothing is read from stored results. Exit codes: 0 all figures lie within their tolerances, 1 one does not,
/// 2 bad usage.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    solver: Solver,
}

#[derive(clap::Subcommand)]
enum Solver {
    /// The explicit finite element solver
    Fe(Options),
    /// Reinforced concrete: material point, bar, section, member end
    Rc(Options),
    /// The multibody solver: mechanisms, hinges, fracture, contact
    Mbs(MbsOptions),
    /// Tested columns, each bent by the RC submodel: table and plot (20 to 60 minutes)
    Columns(verify_columns::Arguments),
}

/// What to run and how to show it.
#[derive(clap::Args)]
struct Options {
    /// Print a JSON list of {case, quantity, unit, reference, ours, tolerance, tolerance_kind, pass, source}
    #[arg(long, conflicts_with_all = ["markdown", "list"])]
    json: bool,
    /// Print the manual as Markdown
    #[arg(long, conflicts_with = "list")]
    markdown: bool,
    /// Only the cases that together take less than 30 s of one processor
    #[arg(long, conflicts_with = "complete")]
    short: bool,
    /// Also the cases that take many minutes each
    #[arg(long)]
    complete: bool,
    /// Only cases whose name begins so
    #[arg(long, value_name = "NAME")]
    case: Option<String>,
    /// List the cases
    #[arg(long)]
    list: bool,
    /// Threads [default: all cores]; no figure depends on them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

#[derive(clap::Args)]
struct MbsOptions {
    #[command(flatten)]
    options: Options,
    /// Run nothing; write the cases as model files into this folder, known paths of their tracked points beside them; those of an earlier call in it are replaced
    #[arg(long, value_name = "DIR", conflicts_with_all = ["json", "markdown", "list", "case"])]
    models: Option<PathBuf>,
}

/// What is verified.
struct Manual {
    title: &'static str,
    intro: &'static str,
    cases: fn() -> Vec<Case>,
}

const FE: Manual = Manual {
    title: "Verification of the finite element solver",
    intro: "\
Small models whose answers are known from elsewhere: closed forms, publications, or another program on the same mesh. The page is the
output of `fallwerk verify fe --markdown`, which computes every figure anew; `fallwerk verify fe` prints the same as a table and
ends with exit code 1 if a figure lies outside its tolerance. Tolerances in per cent are relative to the reference; those with ± are
absolute. A tolerance says what the method can be held to on that mesh, not what would look good: where a figure is off by a
known amount the case says why.
",
    cases: fe::cases,
};

const MBS: Manual = Manual {
    title: "Verification of the multibody solver",
    intro: "\
Mechanisms on ideal joints whose motion is known from elsewhere: exact solutions, benchmark collections, other programs. The page is the output of
`fallwerk verify mbs --markdown`, which computes every figure anew; `fallwerk verify mbs` prints the same as a table and ends with exit code 1 if a figure lies
outside its tolerance. Tolerances in per cent are relative to the reference; those with ± are absolute.
",
    cases: mbs::cases,
};

const RC: Manual = Manual {
    title: "Verification of reinforced concrete",
    intro: "\
Laws of concrete and bars at a material point, sections, and member ends, against closed forms, tests and other programs. The page is the output of
`fallwerk verify rc --markdown` (with `--complete` also of the longest cases), which computes every figure anew; `fallwerk verify rc` prints the same as a table and ends with exit
code 1 if a figure lies outside its tolerance. Tolerances in per cent are relative to the reference; those with ± are absolute.
Tension is positive. The law itself is described at the head of `src/material/concrete/mod.rs`.
",
    cases: rc::cases,
};

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let (manual_of, options) = match &arguments.solver {
        Solver::Fe(options) => (FE, options),
        Solver::Rc(options) => (RC, options),
        Solver::Mbs(MbsOptions { models: Some(folder), .. }) => return write_models(folder),
        Solver::Mbs(MbsOptions { options, .. }) => (MBS, options),
        Solver::Columns(columns) => return verify_columns::run(columns),
    };
    let form = match (options.short, options.complete) {
        (true, _) => Form::Short,
        (_, true) => Form::Complete,
        _ => Form::Full,
    };
    // a list leaves nothing out unless asked to
    let form = if options.list && form == Form::Full { Form::Complete } else { form };
    let cases = select((manual_of.cases)(), form, options.case.as_deref()).map_err(Failure::input)?;
    if options.list {
        print(&list(&cases));
        return Ok(Outcome::Done);
    }
    let pool = thread_pool(options.threads)?;
    let results = pool.install(|| run_cases(&cases));
    let mut failed = false;
    let mut figures: Vec<Figure> = Vec::new();
    for result in results {
        match result {
            Ok(of_case) => figures.extend(of_case),
            Err(error) => {
                eprintln!("error: {error}");
                failed = true;
            }
        }
    }
    if options.json {
        print(&manual::json(&figures).map_err(|e| Failure::stopped(e.to_string()))?);
    } else if options.markdown {
        // a page of all cases also names those that were not run
        let all = if options.case.is_none() { (manual_of.cases)() } else { cases };
        let ran = if options.case.is_none() { form } else { Form::Complete };
        print(&manual::markdown(manual_of.title, manual_of.intro, &all, ran, &figures));
    } else {
        print(&(manual::table(&figures) + &manual::verdict(&figures)));
    }
    failed |= figures.iter().any(|f| !f.passes());
    Ok(if failed { Outcome::CheckFailed } else { Outcome::Done })
}

/// Writes the model files of the multibody cases.
fn write_models(folder: &Path) -> Result<Outcome, Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::input(format!("{}: {e}", folder.display()));
    let output = OutputFolder::create(folder, Results::Cases).map_err(|e| Failure::input(e.to_string()))?;
    for named in mbs::models::all() {
        let text = serde_json::to_string_pretty(&named.model).map_err(|e| failed(&e))?;
        write(&output, &format!("{}.json", named.file), &(text + "\n"))?;
    }
    for known in mbs::known() {
        write(&output, &format!("{}.path.csv", known.file), &known.csv())?;
    }
    output.commit().map_err(|e| Failure::input(e.to_string()))?;
    Ok(Outcome::Done)
}

/// Names, forms and subjects.
fn list(cases: &[Case]) -> String {
    let width = cases.iter().map(|c| c.name.len()).max().unwrap_or(0);
    let line = |c: &Case| format!("{:width$}  {:8}  {}\n", c.name, c.form.word(), c.about);
    cases.iter().map(line).collect()
}

/// All cases side by side, with a bar on a terminal and a line now and then in a pipe.
fn run_cases(cases: &[Case]) -> Vec<Result<Vec<Figure>, suite::Failed>> {
    let progress = Progress::on_stderr();
    progress.stage("verify");
    let done = AtomicUsize::new(0);
    let results = suite::run(cases, &|name| {
        let done = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.advance(done as f64 / cases.len() as f64, name);
    });
    progress.finish();
    results
}
