//! `fallwerk export MODEL`: a model file as text of another program.

use super::{Failure, Outcome, print};
use crate::base::output::{may_write, write_atomic};
use crate::export::{Target, export};
use crate::mbs::Model;
use std::path::PathBuf;

/// Write a multibody model file as input of another program
///
/// What the other format cannot hold is named on standard error, by id. Exit codes: 0 done, 2 bad input or usage, or with --strict something
/// is left out.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model file (JSON)
    model: PathBuf,
    /// What to write
    #[arg(long)]
    to: Format,
    /// The file to write [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Joints that may open become equality constraints named by their ids, which a program can switch off; moments about them are left to it (mjcf)
    #[arg(long)]
    loose: bool,
    /// Write nothing if something would be left out or changed
    #[arg(long)]
    strict: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Format {
    /// MuJoCo (4.0 or later)
    Mjcf,
    /// Dataset of Adams Solver
    Adams,
    /// The model file itself, normalised
    Json,
}

impl Format {
    /// How files of it end.
    fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Mjcf => &["xml", "mjcf"],
            Self::Adams => &["adm"],
            Self::Json => &["json"],
        }
    }
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let target = match arguments.to {
        Format::Mjcf => Target::Mjcf { loose: arguments.loose },
        _ if arguments.loose => {
            return Err(Failure::input("--loose: means something with --to mjcf only".into()));
        }
        Format::Adams => Target::Adams,
        Format::Json => Target::Json,
    };
    if let Some(path) = &arguments.output {
        may_write(path, arguments.to.endings(), &[&arguments.model]).map_err(Failure::input)?;
    }
    let model = Model::read(&arguments.model).map_err(|e| Failure::input(e.to_string()))?;
    let exported = export(&model, target).map_err(Failure::input)?;
    for note in &exported.notes {
        eprintln!("left out: {}: {}", note.id, note.text);
    }
    if arguments.strict && !exported.notes.is_empty() {
        let message = format!("--strict: {} parts would be left out or changed", exported.notes.len());
        return Err(Failure::input(message));
    }
    match &arguments.output {
        Some(path) => write_atomic(path, exported.text.as_bytes())
            .map_err(|e| Failure::input(format!("cannot write {}: {e}", path.display())))?,
        None => print(&exported.text),
    }
    Ok(Outcome::Done)
}
