//! `fallwerk init`: writes the commented example building.

use super::Outcome;
use crate::base::output::write_atomic;
use crate::building::EXAMPLE;
use std::path::PathBuf;

/// Write a commented example building to start from
///
/// The example is the reference building: a three-storey frame whose two front columns are removed.
/// An existing file is left alone unless --force is given.
/// Exit codes: 0 written, 2 the file exists or cannot be written.
#[derive(clap::Args)]
pub struct Arguments {
    /// Where to write it
    #[arg(default_value = "building.toml")]
    path: PathBuf,
    /// Overwrite an existing file
    #[arg(long)]
    force: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Outcome {
    let path =
        if arguments.path.is_dir() { arguments.path.join("building.toml") } else { arguments.path.clone() };
    let shown = path.display();
    if path.extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml")) {
        eprintln!(
            "error: {shown} does not end in .toml\n  = help: the example is TOML; give a name such as building.toml"
        );
        return Outcome::BadInput;
    }
    if !arguments.force && path.exists() {
        eprintln!("error: {shown} exists\n  = help: --force overwrites it");
        return Outcome::BadInput;
    }
    match write_atomic(&path, EXAMPLE.as_bytes()) {
        Ok(()) => {
            eprintln!("wrote {shown}\nnext: fallwerk check {shown}");
            Outcome::Done
        }
        Err(error) => {
            eprintln!("error: {shown} cannot be written: {error}");
            Outcome::BadInput
        }
    }
}
