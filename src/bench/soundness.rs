//! What every multibody run is asked: whether its energy held, and whether anything went into the ground.

use super::passing::{Passing, passing};
use crate::mbs::math::norm;
use crate::mbs::model::Model;
use crate::mbs::result::RunResult;
use crate::mbs::run::REPEATED;

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
    /// That of the energy that the integrator conserves ([`RunResult::energy_growth`]).
    pub conserved_growth: f64,
    /// Energy turned over \[J\].
    pub turned_j: f64,
    /// Whether the run warned of itself.
    pub warned: bool,
    /// How deep bodies went into the ground, obstacles and each other.
    pub passing: Passing,
    /// Steps.
    pub steps: usize,
    /// Processor time \[s\].
    pub cpu_s: f64,
}

impl Finished {
    /// Asks a run of a model.
    pub fn of(model: &Model, result: &RunResult) -> Self {
        // that a run was repeated with a smaller step is no warning of what it is now
        let own = result.warnings.iter().filter(|w| !w.starts_with(REPEATED));
        let warned = own.into_iter().any(|w| w.contains("energy") || w.contains("mm deep"));
        let e = &result.energies;
        let turned = |i: usize| e.kinetic_j[i] + e.gravity_j[i].abs() + e.plastic_j[i] + e.applied_j[i].abs();
        // one millimetre of fall: the scale of a model in which nothing happens
        let mass: f64 = model.bodies.iter().map(|b| b.mass_kg).sum();
        let rest = 1e-3 * mass * norm(model.gravity_m_s2);
        let turned_j = (0..result.times_s.len()).map(turned).fold(rest, f64::max);
        let growth =
            (0..result.times_s.len()).map(|i| (e.total_j(i) - e.total_j(0)) / turned_j).fold(0.0, f64::max);
        Self {
            energy_error: result.energy_error,
            growth,
            conserved_growth: result.energy_growth,
            turned_j,
            warned,
            passing: passing(model, result),
            steps: result.steps,
            cpu_s: result.cpu_s,
        }
    }

    /// Whether energy and ground held.
    pub fn holds_silently(&self) -> bool {
        self.growth <= GROWTH_LIMIT && self.passing.ground.depth_m <= DEPTH_LIMIT_M
    }

    /// Whether they held, or the run says that they did not.
    pub fn holds(&self) -> bool {
        self.warned || self.holds_silently()
    }
}
