//! Where rules and library lie, and how they are opened. Commands that need them come here.

use super::Failure;
use crate::library::{Opened, Store};
use crate::rules::RuleBase;
use std::path::{Path, PathBuf};

/// Where a command finds its knowledge.
#[derive(Debug, clap::Args)]
pub struct KnowledgeArgs {
    /// Library folder [default: library, else the program's]
    #[arg(long, value_name = "DIR")]
    pub library: Option<PathBuf>,
    /// Rules folder [default: rules, else the program's]
    #[arg(long, value_name = "DIR")]
    pub rules: Option<PathBuf>,
}

/// The folder given; else `name` in the current folder; else the one that came with the program.
pub fn folder(given: Option<&Path>, name: &str) -> PathBuf {
    let here = Path::new(name);
    match given {
        Some(path) => path.to_path_buf(),
        None if here.is_dir() => here.to_path_buf(),
        None => Path::new(env!("CARGO_MANIFEST_DIR")).join(name),
    }
}

/// Reads the rules of a folder.
///
/// # Errors
/// If a rule file is wrong or the folder named by the user does not exist.
pub fn rules(given: Option<&Path>) -> Result<RuleBase, Failure> {
    exists(given, "rules")?;
    let folder = folder(given, "rules");
    let rules = if folder.is_dir() { RuleBase::load(&folder) } else { RuleBase::seed() };
    rules.map_err(|problems| Failure::input(problems.to_string()))
}

/// A rule in words, if the rule base still has it.
pub fn words_of(rules: &RuleBase, rule: &str) -> Option<String> {
    rules.rule(rule).map(|r| r.words.clone())
}

/// Opens the library. With `write` it must be writable, and its folder is made where it does not exist.
///
/// # Errors
/// If the folder named by the user does not exist, cannot be read, or (with `write`) cannot be written.
pub fn library(given: Option<&Path>, write: bool) -> Result<Store, Failure> {
    if !write {
        exists(given, "library")?;
    }
    let folder = folder(given, "library");
    let store = Store::open(&folder).map_err(|e| Failure::input(e.to_string()))?;
    for (path, what) in store.damaged() {
        eprintln!("warning: {}: damaged record, not used: {what}", path.display());
    }
    match store.opened() {
        Opened::TextOnly { why, writable: false } if write => Err(Failure::input(format!(
            "the library {} can only be read ({why}); entries cannot be added to it",
            folder.display()
        ))),
        _ => Ok(store),
    }
}

/// A folder named on the command line must exist; an empty one instead would hide a slip.
fn exists(given: Option<&Path>, option: &str) -> Result<(), Failure> {
    match given {
        Some(path) if !path.is_dir() => {
            Err(Failure::input(format!("--{option}: {} is not a folder", path.display())))
        }
        _ => Ok(()),
    }
}
