//! `fallwerk init`: writes the commented example building.

use super::Outcome;
use crate::base::output::write_atomic;
use crate::building::EXAMPLE;
use std::path::{Path, PathBuf};

/// Write a commented example building to start from
///
/// The example is the reference building: a three-storey frame whose two front columns are removed. It has the name of the file.
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
    match write_atomic(&path, example(&path).as_bytes()) {
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

/// Most characters of a building's name.
const LONGEST: usize = 100;

/// The example under the name of the file: results lie in `out/NAME`, where those of the reference building may be.
fn example(path: &Path) -> String {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let usable = |c: char| if c == '\\' || c.is_control() { '-' } else { c };
    let stem: String = stem.chars().take(LONGEST).map(usable).collect();
    let stem = if stem.trim().is_empty() { "building".into() } else { stem };
    let name = toml::Value::String(stem).to_string();
    EXAMPLE.replacen("name = \"three-storey-frame\"     #", &format!("name = {name:<24} #"), 1)
}
