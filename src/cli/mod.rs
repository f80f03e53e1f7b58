//! The command line: one file a command, no engineering in it.
//!
//! Exit codes: 0 done, 1 a check failed, 2 bad input or usage.

mod check;
pub mod graph;
mod init;
pub mod library;
pub mod rules;
mod schema;
pub mod simulate;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

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
    Check(check::Arguments),
    Init(init::Arguments),
    Schema(schema::Arguments),
    Graph(graph::Arguments),
    /// Run a multibody model file
    Simulate(simulate::SimulateArgs),
    /// The library of subsystems: list, show, verify, rebuild, export, import, deprecate
    Library(library::LibraryArgs),
    /// The rules: list, check, show, features
    Rules(rules::RulesArgs),
}

/// Runs the command line of this process.
pub fn run() -> ExitCode {
    match Arguments::parse().command {
        Command::Check(arguments) => check::run(&arguments),
        Command::Init(arguments) => init::run(&arguments),
        Command::Schema(arguments) => schema::run(&arguments),
        Command::Graph(arguments) => show_graph(&arguments),
        Command::Library(arguments) => return ExitCode::from(library::run(&arguments)),
        Command::Rules(arguments) => return ExitCode::from(rules::run(&arguments)),
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

fn show_graph(arguments: &graph::Arguments) -> Outcome {
    let inspection = crate::building::inspect_file(&arguments.file);
    if !inspection.diagnostics.items().is_empty() {
        eprint!("{}", inspection.diagnostics.render(colour_on_stderr()));
    }
    let Some(building) = inspection.building else { return Outcome::BadInput };
    print(&graph::run(arguments, &building));
    Outcome::Done
}

/// Writes to standard output; a closed pipe (`| head`) is no error.
pub(crate) fn print(text: &str) {
    use std::io::Write;
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// Whether messages on standard error may have colours.
pub(crate) fn colour_on_stderr() -> bool {
    use std::io::IsTerminal;
    std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none()
}
