//! Multibody runs at and beyond the limits: each must hold its energy or say why it stopped.

use super::mbs_trials::{Trial, random, trials};
use crate::mbs::model::Model;
use crate::mbs::simulate;
use rayon::prelude::*;
use std::fmt::Write;

/// Growth of the energy, as a share of that turned over, above which a finished run does not hold.
pub const GROWTH_LIMIT: f64 = 1e-3;
/// Depth below the ground at which a finished run does not hold \[m\].
pub const DEPTH_LIMIT_M: f64 = 1e-3;

/// A run that came to its end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finished {
    /// Largest error of the energy balance over the energy turned over.
    pub energy_error: f64,
    /// Largest growth of the sum of all energies at any output over the energy turned over.
    pub growth: f64,
    /// Whether the run warned of itself.
    pub warned: bool,
    /// Depth of the deepest corner below the ground at any output, if there is ground \[m\].
    pub depth_m: f64,
    /// Steps.
    pub steps: usize,
    /// Processor time \[s\].
    pub cpu_s: f64,
}

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

impl Finished {
    /// Whether energy and ground held, or the run says that they did not.
    pub fn holds(&self) -> bool {
        self.warned || self.growth <= GROWTH_LIMIT && self.depth_m <= DEPTH_LIMIT_M
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
                let silent = f.growth <= GROWTH_LIMIT && f.depth_m <= DEPTH_LIMIT_M;
                sweep.counts[if silent {
                    0
                } else if f.warned {
                    3
                } else {
                    2
                }] += 1;
                sweep.growth = sweep.growth.max(f.growth);
                sweep.energy_error = sweep.energy_error.max(f.energy_error);
                sweep.depth_m = sweep.depth_m.max(f.depth_m);
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
    let level = model.contact.ground.as_ref().map_or(f64::NEG_INFINITY, |g| g.level_m);
    // bodies that a joint connects with the ground pass through it
    let meets_ground = |id: &str| model.joints.iter().all(|j| j.body_a.is_some() || j.body_b != id);
    let depth = |frame: &crate::mbs::result::Frame| {
        let of_body = |(i, body): (usize, &crate::mbs::model::Body)| {
            let r = crate::mbs::math::qmat(frame.orientation[i]);
            let lowest = |c: [f64; 3]| frame.position_m[i][2] + crate::mbs::math::mul(&r, c)[2];
            let corners = body.shapes.iter().flat_map(|s| s.corners()).map(lowest);
            level - corners.fold(f64::INFINITY, f64::min)
        };
        let meeting = model.bodies.iter().enumerate().filter(|(_, b)| meets_ground(&b.id));
        meeting.map(of_body).fold(0.0, f64::max)
    };
    // what is in the ground at the start stays as deep
    let start = result.frames.first().map_or(0.0, depth);
    let deepest = result.frames.iter().map(depth).fold(0.0, f64::max);
    let warned = result.warnings.iter().any(|w| w.contains("energy") || w.contains("mm deep"));
    let e = &result.energies;
    let total = |i: usize| e.total_j(i);
    let turned = |i: usize| e.kinetic_j[i] + e.gravity_j[i].abs() + e.plastic_j[i] + e.applied_j[i].abs();
    // one millimetre of fall: the scale of a model in which nothing happens
    let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
    let rest = 1e-3 * mass * crate::mbs::math::norm(model.gravity_m_s2);
    let most = (0..result.times_s.len()).map(turned).fold(rest, f64::max);
    let growth = (0..result.times_s.len()).map(|i| (total(i) - total(0)) / most).fold(0.0, f64::max);
    Ok(Finished {
        energy_error: result.energy_error,
        growth,
        warned,
        depth_m: deepest - start,
        steps: result.steps,
        cpu_s: result.cpu_s,
    })
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
                1e3 * f.depth_m,
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
