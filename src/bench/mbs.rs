//! Error over run time of mechanisms whose motion is known.

use crate::base::cpu::ThreadClock;
use crate::verify::mbs::{Known, known};
use serde::Serialize;
use std::fmt::Write;

/// Measurements whose median counts.
const REPEATS: usize = 5;

/// One run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// What was run.
    pub case: String,
    /// Name of its model file.
    pub file: String,
    /// Error tolerance of a step.
    pub tolerance: f64,
    /// Steps, and steps that were tried again.
    pub steps: [u64; 2],
    /// Largest distance from the known path \[m\].
    pub error_m: f64,
    /// Largest change of kinetic and potential energy less the work of forces \[J\].
    pub energy_j: f64,
    /// Simulated time \[s\].
    pub simulated_s: f64,
    /// Median processor time of a run on one thread \[s\].
    pub run_s: f64,
}

impl Row {
    /// Run time a simulated second.
    pub fn pace(&self) -> f64 {
        self.run_s / self.simulated_s
    }
}

/// Runs every known mechanism whose name contains `only` with each tolerance, on one thread.
///
/// # Errors
/// In words, if a run stops.
pub fn measure(tolerances: &[f64], only: &str) -> Result<Vec<Row>, String> {
    let chosen: Vec<Known> = known().into_iter().filter(|k| k.name.contains(only)).collect();
    let pairs = chosen.iter().flat_map(|k| tolerances.iter().map(move |t| (k, *t)));
    pairs.map(|(k, t)| row(k, t).map_err(|e| format!("{}, tolerance {t:e}: {e}", k.name))).collect()
}

fn row(known: &Known, tolerance: f64) -> Result<Row, String> {
    let course = known.run(tolerance)?;
    let mut times = Vec::with_capacity(REPEATS);
    for _ in 0..REPEATS {
        let clock = ThreadClock::start();
        std::hint::black_box(known.run(tolerance)?);
        times.push(clock.elapsed_s());
    }
    times.sort_by(f64::total_cmp);
    Ok(Row {
        case: known.name.to_string(),
        file: known.file.to_string(),
        tolerance,
        steps: course.steps,
        error_m: known.distances_m(&course).into_iter().fold(0.0, f64::max),
        energy_j: course.energy_change_j,
        simulated_s: known.end_s,
        run_s: times[REPEATS / 2],
    })
}

/// A table.
pub fn table(rows: &[Row]) -> String {
    let mut text = String::from(
        "case                    tolerance     steps  repeated    error [m]   energy [J]  run time [s]  a simulated s\n",
    );
    for r in rows {
        let _ = writeln!(
            text,
            "{:<24}{:>9.0e}{:>10}{:>10}{:>13.3e}{:>13.3e}{:>14.4}{:>15.5}",
            r.case,
            r.tolerance,
            r.steps[0],
            r.steps[1],
            r.error_m,
            r.energy_j,
            r.run_s,
            r.pace()
        );
    }
    text
}
