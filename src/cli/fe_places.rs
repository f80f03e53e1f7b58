//! Where `fallwerk fe` writes, and what its errors come to.

use super::Failure;
use crate::base::output::{OutputError, OutputFolder, TEMPORARY_PREFIX};
use crate::fe::mass_scaling::MassScalingError;
use crate::fe::restart::MAGIC;
use crate::fe::run::{Checkpoints, FeError};
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Name of the checkpoint among unfinished results.
const CHECKPOINT: &str = "fe.checkpoint";

/// Checkpoints every so many seconds in this file or among the results in `target`, in a place that can be written.
pub(super) fn checkpoints(
    every_s: Option<f64>,
    file: Option<&PathBuf>,
    target: &Path,
) -> Result<Option<Checkpoints>, Failure> {
    let Some(every_s) = every_s else { return Ok(None) };
    if !(every_s > 0.0 && every_s.is_finite()) {
        return Err(Failure::input(format!("--checkpoint-every is {every_s}, expected a positive number")));
    }
    let Some(path) = file else {
        let path = OutputFolder::unfinished_path(target).join(CHECKPOINT);
        return Ok(Some(Checkpoints { path, every_s }));
    };
    let refused = |why: String| {
        let path = path.display();
        let remedy = "name a new file, in a folder that can be written";
        Err(Failure::input(format!("--checkpoint {path} cannot be written: {why}; {remedy}")))
    };
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return refused(format!("there is no folder {}", folder.display()));
    }
    if path.exists() && !path.is_file() {
        return refused("it is no regular file".into());
    }
    if path.is_file() && !is_checkpoint(path) {
        return refused("it exists and is no checkpoint, and would be replaced".into());
    }
    // Checkpoints are written beside their place and renamed into it: that is what is tried.
    let trial = folder.join(format!("{TEMPORARY_PREFIX}{}-trial", std::process::id()));
    if let Err(e) = fs::write(&trial, [0; 64]) {
        let _ = fs::remove_file(&trial);
        return refused(e.to_string());
    }
    let _ = fs::remove_file(&trial);
    Ok(Some(Checkpoints { path: path.clone(), every_s }))
}

/// Whether a file begins as checkpoints do; an empty one counts.
fn is_checkpoint(path: &Path) -> bool {
    let mut begin = Vec::new();
    let read = fs::File::open(path).and_then(|file| file.take(MAGIC.len() as u64).read_to_end(&mut begin));
    read.is_ok() && MAGIC.starts_with(&begin)
}

/// A checkpoint among the results in a folder has served when the run is done.
pub(super) fn remove_checkpoint(folder: &Path) -> Result<(), Failure> {
    let path = folder.join(CHECKPOINT);
    match fs::remove_file(&path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(Failure::input(format!("{}: {e}; {ELSEWHERE}", path.display())))
        }
        _ => Ok(()),
    }
}

/// What to do about a place that cannot be written.
const ELSEWHERE: &str = "make room there, or name a folder that can be written with -o";

/// Results that cannot be written.
pub(super) fn unwritable(error: &OutputError) -> Failure {
    match error {
        OutputError::Io { .. } => Failure::input(format!("{error}; {ELSEWHERE}")),
        OutputError::NotOurs { .. }
        | OutputError::BadTarget { .. }
        | OutputError::OtherResults { .. }
        | OutputError::Foreign { .. } => Failure::input(error.to_string()),
    }
}

/// Writes a text file into a result folder.
pub(super) fn write(output: &OutputFolder, name: &str, text: &str) -> Result<(), Failure> {
    output.write(name, text.as_bytes()).map(|_| ()).map_err(|e| unwritable(&e))
}

/// Bad input, a place that cannot be written, or a run that stopped.
pub(super) fn failure(error: &FeError) -> Failure {
    match error {
        FeError::Output(what) => Failure::input(format!("{what}; {ELSEWHERE}")),
        FeError::MassScaling(MassScalingError::TooMuch { .. }) => Failure::input(format!(
            "{error}; give that as --mass-scaling-step, or --force-mass-scaling to accept more"
        )),
        _ if error.is_input() => Failure::input(error.to_string()),
        _ => Failure::stopped(error.to_string()),
    }
}
