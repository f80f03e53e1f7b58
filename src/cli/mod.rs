//! The command line: one file a command, no engineering in it.
//!
//! Exit codes: 0 done, 1 a check failed, 2 bad input or usage.

mod batch;
mod bench;
mod bench_buildings;
mod bench_generate;
mod bench_tradeoff;
mod check;
pub mod compose;
pub mod explain;
mod explain_entry;
mod explain_events;
mod explain_joint;
mod export;
pub mod fe;
mod fe_against;
mod fe_deck;
mod fe_hybrid;
mod fe_places;
pub mod generate_mbs;
pub mod graph;
mod init;
pub mod knowledge;
pub mod library;
mod library_add;
pub mod library_derive;
mod library_diff;
mod library_find;
mod library_look;
mod library_plot;
pub mod library_springs;
pub mod progress;
pub mod rc;
mod rc_cycles;
pub mod rc_springs;
pub mod rules;
pub mod rules_learn;
mod schema;
pub mod simulate;
mod study;
mod study_compare;
mod study_run;
mod summary;
pub mod verdict;
mod verify;
mod verify_columns;

use crate::base::output::OutputFolder;
use crate::building::{Building, inspect_file};
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a command ends with; its number is the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Done,
    /// The command ran, and what it checks does not hold.
    CheckFailed,
    /// Bad input or usage.
    BadInput,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        Self::from(outcome as u8)
    }
}

/// Why a command did not get to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// What is wrong; empty if it has been said already.
    pub message: String,
    /// What the command ends with.
    pub outcome: Outcome,
}

impl Failure {
    /// Bad input, or an output that cannot be written.
    pub fn input(message: String) -> Self {
        Self { message, outcome: Outcome::BadInput }
    }

    /// In the form in which the errors of an input file are told; what is known of a remedy stands apart.
    fn to_json(&self) -> serde_json::Value {
        let (message, help) = match self.message.split_once("\n  = help: ") {
            Some((message, help)) => (message, Some(help)),
            None => (self.message.as_str(), None),
        };
        let code = if self.outcome == Outcome::BadInput { "bad-input" } else { "stopped" };
        let item = serde_json::json!({ "severity": "error", "code": code, "message": message, "help": help });
        serde_json::json!({ "ok": false, "diagnostics": [item] })
    }

    /// A run that stopped.
    pub fn stopped(message: String) -> Self {
        Self { message, outcome: Outcome::CheckFailed }
    }
}

#[derive(Parser)]
#[command(
    name = "fallwerk",
    version,
    about = "Knowledge-based multibody models of building collapse, checked against finite elements",
    after_help = "Exit codes: 0 done, 1 a check failed, 2 bad input or usage.\n\
                  Start with `fallwerk init building.toml` and `fallwerk check building.toml`."
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Batch(batch::Arguments),
    Bench(bench::Arguments),
    Check(check::Arguments),
    Explain(explain::Arguments),
    Export(export::Arguments),
    Fe(fe::Arguments),
    GenerateMbs(generate_mbs::Arguments),
    Init(init::Arguments),
    Schema(schema::Arguments),
    Graph(graph::Arguments),
    /// Run a multibody model file
    Simulate(simulate::SimulateArgs),
    /// The library of subsystems: derive, add, list, show, plot, diff, find, history, deprecate, verify, rebuild, export, import
    Library(library::LibraryArgs),
    Rc(rc::Arguments),
    /// The rules: list, check, show, features, learn, diff
    Rules(rules::RulesArgs),
    Study(study::Arguments),
    Verify(verify::Arguments),
}

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    let code = run_command(Arguments::parse().command);
    if LOST.load(Ordering::Relaxed) { Outcome::BadInput.into() } else { code }
}

fn run_command(command: Command) -> ExitCode {
    match command {
        Command::Batch(arguments) => finish(batch::run(&arguments)),
        Command::Bench(arguments) => finish(bench::run(&arguments)),
        Command::Check(arguments) => check::run(&arguments),
        Command::Explain(arguments) => finish(explain::run(&arguments)),
        Command::Export(arguments) => finish(export::run(&arguments)),
        Command::Fe(arguments) => finish(failing(arguments.json, fe::run(&arguments))),
        Command::GenerateMbs(arguments) => finish(generate_mbs::run(&arguments)),
        Command::Init(arguments) => init::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Graph(arguments) => finish(show_graph(&arguments)),
        Command::Library(arguments) => return ExitCode::from(library::run(&arguments)),
        Command::Rc(arguments) => finish(rc::run(&arguments)),
        Command::Rules(arguments) => return ExitCode::from(rules::run(&arguments)),
        Command::Study(arguments) => finish(study::run(&arguments)),
        Command::Verify(arguments) => finish(verify::run(&arguments)),
        Command::Simulate(arguments) => match simulate::run(arguments) {
            Ok(()) => Outcome::Done,
            Err(error) => {
                eprintln!("error: {error}");
                return ExitCode::from(error.exit_code());
            }
        },
    }
    .into()
}

/// Reads a building and shows its structure graph.
fn show_graph(arguments: &graph::Arguments) -> Result<Outcome, Failure> {
    let building = read_building(&arguments.file, arguments.json)?;
    building.without_skew("no structure graph can be made").map_err(Failure::input)?;
    print(&graph::run(arguments, &building));
    Ok(Outcome::Done)
}

/// Says why a command failed.
fn finish(result: Result<Outcome, Failure>) -> Outcome {
    result.unwrap_or_else(|failure| {
        if !failure.message.is_empty() {
            eprintln!("error: {}", failure.message);
        }
        failure.outcome
    })
}

/// With `json`, what a command failed of on standard output as well, in the form in which the errors of an input file are told; the message itself goes to standard error.
fn failing<T>(json: bool, result: Result<T, Failure>) -> Result<T, Failure> {
    result.inspect_err(|failure| {
        if json && !failure.message.is_empty() {
            print(&format!("{:#}\n", failure.to_json()));
        }
    })
}

/// Reads a building; says all that is wrong with it, as `check` does (with `json` on standard output).
fn read_building(path: &Path, json: bool) -> Result<Building, Failure> {
    let inspection = inspect_file(path);
    if !inspection.diagnostics.items().is_empty() {
        eprint!("{}", inspection.diagnostics.render(colour_on_stderr()));
    }
    inspection.building.ok_or_else(|| {
        if json {
            let value = serde_json::json!({ "ok": false, "diagnostics": inspection.diagnostics.to_json() });
            print(&format!("{value:#}\n"));
        }
        Failure::input(String::new())
    })
}

/// A number with the word for one or for many.
fn counted(number: usize, one: &str, many: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { many })
}

/// `out/` and the building's name as a file name.
fn default_output(building: &Building, ending: &str) -> PathBuf {
    let plain = |c: char| if c.is_alphanumeric() || c == '_' { c } else { '-' };
    let name: String = building.name.chars().map(plain).collect();
    let name = name.trim_matches('-');
    Path::new("out").join(format!("{}{ending}", if name.is_empty() { "building" } else { name }))
}

/// A pool of this many threads, or of one a core.
fn thread_pool(threads: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.map_or(0, usize::from));
    builder.build().map_err(|e| Failure::stopped(format!("threads cannot be started: {e}")))
}

/// Writes a text file into a result folder.
fn write(output: &OutputFolder, name: &str, text: &str) -> Result<(), Failure> {
    output.write(name, text.as_bytes()).map(|_| ()).map_err(|e| Failure::input(e.to_string()))
}

/// Whether something was not written to standard output.
static LOST: AtomicBool = AtomicBool::new(false);

/// Writes to standard output; a closed pipe (`| head`) is no error, anything else is told once and makes the program end with 2.
pub(crate) fn print(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout();
    let error = match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => error,
        _ => return,
    };
    if !LOST.swap(true, Ordering::Relaxed) {
        eprintln!("error: standard output cannot be written: {error}");
    }
}

/// Whether messages on standard error may have colours.
pub(crate) fn colour_on_stderr() -> bool {
    use std::io::IsTerminal;
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
