//! Where rules and library lie, and how they are opened. Commands that need them come here.

use super::Failure;
use crate::base::units::Dimension;
use crate::generate::{Accuracy, Derive, Wishes};
use crate::library::{Opened, Store};
use crate::mbs::{Model, SolverOptions};
use crate::rules::{Problems, RuleBase};
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

impl KnowledgeArgs {
    /// That the folders named on the command line exist, for commands that may not open them.
    ///
    /// # Errors
    /// If one of them does not.
    pub fn exist(&self) -> Result<(), Failure> {
        exists(self.rules.as_deref(), "rules")?;
        exists(self.library.as_deref(), "library")
    }
}

/// Where a command that generates models finds its knowledge, and what it does about what is missing there.
#[derive(Debug, clap::Args)]
pub struct CurveArgs {
    /// What to do about hinges that the library has no curves for
    #[arg(long, value_enum, default_value = "never", default_missing_value = "run", num_args = 0..=1, require_equals = true)]
    derive: DeriveArgument,
    /// Level of detail of the model
    #[arg(long, value_enum, default_value = "balanced")]
    accuracy: AccuracyArgument,
    #[command(flatten)]
    knowledge: KnowledgeArgs,
}

/// Values of `--accuracy`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum AccuracyArgument {
    /// As few bodies as can be: floors neither bend nor fold
    Fast,
    /// What the rules think necessary
    Balanced,
    /// The spans and panels of all floors are divided
    Fine,
}

/// Whether latent hinges may give way.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct LatentArgs {
    /// Whether latent hinges may give way, and rules about contacts and fractures fire, while the model runs; off: for comparison only, it stays as it is at the start
    #[arg(long, value_enum, default_value = "on")]
    latent: Switch,
}

impl LatentArgs {
    /// The options of a run, which is repeated where its energy grows.
    pub fn options(self) -> SolverOptions {
        SolverOptions { repeat: true, hold_latent: self.latent == Switch::Off, ..SolverOptions::default() }
    }
}

/// The steps of a multibody run.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct StepArgs {
    /// Steps of this length, such as 0.5ms, in place of those that the model asks for or that are chosen: settings.time_step_s
    #[arg(long, value_name = "TIME", value_parser = time, allow_hyphen_values = true)]
    step: Option<f64>,
}

impl StepArgs {
    /// The model with this step.
    pub fn set(self, model: &mut Model) {
        model.settings.time_step_s = self.step.or(model.settings.time_step_s);
    }
}

fn time(text: &str) -> Result<f64, String> {
    let step_s = super::library_find::quantity(text, Dimension::Time)?;
    if step_s > 0.0 { Ok(step_s) } else { Err(format!("{step_s} s is no step, expected more than nothing")) }
}

/// Values of options that switch a mechanism off, to see what it does.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Switch {
    /// As ever
    #[default]
    On,
    /// Without it, for comparison
    Off,
}

/// Values of `--derive`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum DeriveArgument {
    /// Stop and name them
    Never,
    /// Scale the curves of similar columns by the laws of similarity, or take those of the section where none is similar; a floor without curves for a line at which it may fold stays in one piece
    Similar,
    /// Compute the curves for this run
    Run,
    /// Compute the curves and add them to the library
    Keep,
}

impl CurveArgs {
    /// What the generator is told.
    pub fn wishes(&self) -> Wishes {
        let accuracy = match self.accuracy {
            AccuracyArgument::Fast => Accuracy::Fast,
            AccuracyArgument::Balanced => Accuracy::Balanced,
            AccuracyArgument::Fine => Accuracy::Fine,
        };
        let derive = match self.derive {
            DeriveArgument::Never => Derive::Never,
            DeriveArgument::Similar => Derive::Similar,
            DeriveArgument::Run => Derive::Run,
            DeriveArgument::Keep => Derive::Keep,
        };
        Wishes { derive, accuracy }
    }

    /// Where they lie.
    pub fn places(&self) -> &KnowledgeArgs {
        &self.knowledge
    }

    /// Rules and library, which has to be writable if curves are kept.
    ///
    /// # Errors
    /// As [`rules`] and [`library`].
    pub fn open(&self) -> Result<(RuleBase, Store), Failure> {
        let KnowledgeArgs { library: folder, rules: of } = &self.knowledge;
        Ok((rules(of.as_deref())?, library(folder.as_deref(), self.wishes().derive == Derive::Keep)?))
    }
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
    rule_base(given).map_err(|problems| Failure::input(problems.to_string()))
}

/// The rules of a folder; without one named those of the current folder, else the program's.
///
/// # Errors
/// All problems found in and between the files.
pub fn rule_base(given: Option<&Path>) -> Result<RuleBase, Problems> {
    let folder = folder(given, "rules");
    if given.is_some() || folder.is_dir() { RuleBase::load(&folder) } else { RuleBase::seed() }
}

/// A rule in words, if the rule base still has it.
pub fn words_of(rules: &RuleBase, rule: &str) -> Option<String> {
    rules.rule(rule).map(|r| r.words.clone())
}

/// Opens the library. With `write` it must be writable, and its folder is made where it does not exist; without, others may
/// write to it meanwhile.
///
/// # Errors
/// If the folder named by the user does not exist, cannot be read, or (with `write`) cannot be written.
pub fn library(given: Option<&Path>, write: bool) -> Result<Store, Failure> {
    if !write {
        exists(given, "library")?;
    }
    let folder = folder(given, "library");
    let store = if write { Store::open(&folder) } else { Store::open_to_read(&folder) };
    let store = store.map_err(|e| Failure::input(e.to_string()))?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_reads_keeps_nobody_from_writing() {
        let room = tempfile::tempdir().unwrap();
        let read = library(Some(room.path()), false).unwrap();
        assert!(*read.opened() == Opened::ToRead && !room.path().join(".cache").exists());
        assert!(library(Some(room.path()), true).unwrap().writable().is_ok());
        assert!(read.writable().unwrap_err().to_string().contains("it was opened to be read"));
    }
}
