//! Multibody runs at and beyond the limits: each must hold its energy or say why it stopped.

use super::mbs_trials::{Trial, random, trials};
use super::soundness::{DEPTH_LIMIT_M, Finished, GROWTH_LIMIT};
use crate::mbs::model::Model;
use crate::mbs::simulate;
use rayon::prelude::*;
use std::fmt::Write;

/// One run.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// What was varied.
    pub parameter: &'static str,
    /// Its value with unit.
    pub value: String,
    /// What it shows, or the diagnosis with which it stopped.
    pub outcome: Result<Finished, String>,
}

impl Row {
    /// Whether it held or said why not.
    pub fn holds(&self) -> bool {
        self.outcome.as_ref().map_or(true, Finished::holds)
    }
}

/// Random structures: how many held, stopped with a diagnosis, and did not hold, with the worst.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Sweep {
    /// Runs that held, that stopped, that did not hold, and those that warned.
    pub counts: [usize; 4],
    /// Largest energy error and growth of those that came to their end.
    pub energy_error: f64,
    /// The growth.
    pub growth: f64,
    /// Greatest depth below the ground of those \[m\].
    pub depth_m: f64,
    /// Seeds that did not hold, and seeds that stopped with their diagnosis; some of them.
    pub bad: Vec<u64>,
    /// Diagnoses.
    pub stopped: Vec<(u64, String)>,
    /// Processor time \[s\].
    pub cpu_s: f64,
}

/// Runs the trials in the current rayon pool.
pub fn measure() -> Vec<Row> {
    let row = |Trial { parameter, value, model }: Trial| Row { parameter, value, outcome: outcome(&model) };
    trials().into_par_iter().with_max_len(1).map(row).collect()
}

/// Runs random structures with the seeds from 0 on in the current rayon pool; `done` is told of each.
pub fn sweep(count: u64, done: &(dyn Fn() + Sync)) -> Sweep {
    let one = |seed: u64| {
        let outcome = outcome(&random(seed));
        done();
        (seed, outcome)
    };
    let runs: Vec<(u64, Result<Finished, String>)> = (0..count).into_par_iter().map(one).collect();
    let mut sweep = Sweep::default();
    for (seed, outcome) in runs {
        match outcome {
            Ok(f) => {
                sweep.counts[if f.holds_silently() {
                    0
                } else if f.warned {
                    3
                } else {
                    2
                }] += 1;
                sweep.growth = sweep.growth.max(f.growth);
                sweep.energy_error = sweep.energy_error.max(f.energy_error);
                sweep.depth_m = sweep.depth_m.max(f.passing.ground.depth_m);
                sweep.cpu_s += f.cpu_s;
                if !f.holds() {
                    sweep.bad.push(seed);
                }
            }
            Err(why) => {
                sweep.counts[1] += 1;
                sweep.stopped.push((seed, why));
            }
        }
    }
    sweep
}

fn outcome(model: &Model) -> Result<Finished, String> {
    let result = simulate(model).map_err(|e| e.to_string())?;
    Ok(Finished::of(model, &result))
}

/// The page.
pub fn markdown(rows: &[Row], sweep: &Sweep) -> String {
    let mut text = format!(
        "# Numerical stability of the multibody solver\n\nOutput of `fallwerk bench mbs-stability -o docs`. One number is varied in a small model, one second is simulated. A run holds if the sum of all energies \
         never grows by more than {GROWTH_LIMIT:e} of the energy turned over and nothing sinks into the ground by more than {} mm; else it has to warn of itself or to stop with a diagnosis.\n\n\
         | varied | value | outcome | energy error | depth (mm) | steps |\n|---|---|---|---|---|---|\n",
        1e3 * DEPTH_LIMIT_M
    );
    for row in rows {
        let _ = match &row.outcome {
            Ok(f) => writeln!(
                text,
                "| {} | {} | {} | {:.1e} | {:.3} | {} |",
                row.parameter,
                row.value,
                match f {
                    f if f.warned => "warns",
                    f if f.holds() => "holds",
                    _ => "**does not hold**",
                },
                f.energy_error,
                1e3 * f.passing.ground.depth_m,
                f.steps
            ),
            Err(why) => writeln!(text, "| {} | {} | stops: {why} | | | |", row.parameter, row.value),
        };
    }
    let [held, stopped, bad, warned] = sweep.counts;
    let _ = write!(
        text,
        "\n## Random hinge structures\n\n{} structures of one to eight blocks on spherical, revolute and fixed joints, a quarter with loops, hinges of 1 kN m/rad to 100 MN m/rad that flow, soften and \
         fracture, half of them over ground: {held} hold, {warned} warn of themselves, {stopped} stop with a diagnosis, {bad} do not hold. Largest growth of the energy {:.1e}, largest error of its balance {:.1e}, greatest depth below \
         the ground {:.3} mm.\n",
        held + stopped + bad + warned,
        sweep.growth,
        sweep.energy_error,
        1e3 * sweep.depth_m
    );
    if !sweep.bad.is_empty() {
        let _ =
            writeln!(text, "\nThose that do not hold: seeds {:?}.", &sweep.bad[..sweep.bad.len().min(20)]);
    }
    for (seed, why) in sweep.stopped.iter().take(20) {
        let _ = writeln!(text, "\n- seed {seed}: {why}");
    }
    text
}
