//! Conventional mass scaling, local: a longer time step by more lumped mass on the elements that limit it, and on no others.
//!
//! The squared frequency bound of an element falls as its mass grows, so an element that allows the step `Δt_e` gets the mass
//! `m (Δt / Δt_e)²` and then allows the wished step Δt, safety and viscosity included; so does a bar. The mass is real to the run: it falls, bears on supports and takes part in
//! impacts. That is why it is reported by part and refused beyond [`MOST_ADDED`] of the body's mass, in a deck, which asks for it itself, beyond [`MOST_ADDED_IN_DECK`].
//! It is added once, in the reference positions;
//! elements that are compressed later shorten the step as usual.

use super::dynamics::Dynamics;
use super::kernel::KernelStep;
use super::mesh::Mesh;
use serde::{Deserialize, Serialize};

/// Largest added share of the body's mass that is accepted without being forced.
pub const MOST_ADDED: f64 = 0.05;
/// The same for decks, whose DT2MS is a wish of its own: the mass may double. Beyond that more than half of what falls, swings and strikes is not the
/// model's, its motion is slower by more than `sqrt 2`, and the step is rather a mistake in the units or the sign.
pub const MOST_ADDED_IN_DECK: f64 = 1.0;

/// What was added.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MassScaling {
    /// Wished step \[s\].
    pub step_s: f64,
    /// Elements and bars that got mass.
    pub elements: usize,
    /// Added mass \[kg\].
    pub added_kg: f64,
    /// Added over original mass of the body.
    pub added_share: f64,
    /// The same by part, parts without added mass left out.
    pub parts: Vec<AddedMass>,
}

/// Mass added to a part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AddedMass {
    /// Part name.
    pub part: String,
    /// Added mass \[kg\].
    pub added_kg: f64,
    /// Added over original mass of the part.
    pub added_share: f64,
}

/// A wish that is refused.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MassScalingError {
    /// Not a positive number.
    #[error("the time step of mass scaling is {0} s, expected a positive number")]
    Step(f64),
    /// Too much mass.
    #[error(
        "a time step of {step_s:e} s needs {percent:.1} % more mass, most in part `{part}`; up to {limit:.0} % are accepted, which allows {allowed_s:.3e} s"
    )]
    TooMuch {
        /// Wished step \[s\].
        step_s: f64,
        /// Added mass \[%\].
        percent: f64,
        /// Part with the most of it.
        part: String,
        /// Limit \[%\].
        limit: f64,
        /// Largest step within the limit \[s\].
        allowed_s: f64,
    },
}

/// Adds mass to a body at rest in its reference positions so that no element and no bar allows less than `step_s`. More than the share `most_added` of
/// the body's mass is refused. Nothing is changed on error.
pub fn scale_mass(
    mesh: &Mesh,
    body: &mut Dynamics,
    step_s: f64,
    most_added: f64,
) -> Result<MassScaling, MassScalingError> {
    if !(step_s > 0.0 && step_s.is_finite()) {
        return Err(MassScalingError::Step(step_s));
    }
    let bars = &body.trusses.bars;
    let bounds = body.blocks.element_bounds_1_s2(&body.x).into_iter();
    let bounds = bounds.chain(bars.iter().map(|bar| bar.bound_1_s2(bar.length_m[1])));
    let steps: Vec<f64> = bounds.map(|bound| element_step_s(body, bound)).collect();
    let solids = mesh.elements.len();
    let masses: Vec<f64> =
        (0..solids).map(|e| body.blocks.mass_kg(e)).chain(bars.iter().map(|bar| bar.mass_kg)).collect();
    let total: f64 = masses.iter().sum();
    let report = report(mesh, &steps, &masses, step_s);
    if report.added_share > most_added {
        let most = report.parts.iter().max_by(|a, b| a.added_kg.total_cmp(&b.added_kg));
        return Err(MassScalingError::TooMuch {
            step_s,
            percent: 100.0 * report.added_share,
            part: most.map_or(String::new(), |p| p.part.clone()),
            limit: 100.0 * most_added,
            allowed_s: largest_step_s(&steps, &masses, most_added * total, step_s),
        });
    }
    for (e, mass_kg) in masses.iter().enumerate() {
        let new_kg = mass_kg + added_kg(steps[e], *mass_kg, step_s);
        match e.checked_sub(solids) {
            None => body.blocks.set_mass_kg(e, new_kg),
            Some(bar) => body.trusses.bars[bar].mass_kg = new_kg,
        }
    }
    body.assemble_mass(mesh, |_| true);
    body.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 0.0);
    body.dt_s = body.allowed_step_s();
    body.first_dt_s = body.dt_s;
    Ok(report)
}

/// Step that an element with a squared frequency bound \[1/s²\] allows \[s\], with the safety of the body; infinite if nothing of it acts.
fn element_step_s(body: &Dynamics, bound_1_s2: f64) -> f64 {
    if bound_1_s2 > 0.0 { body.step_under_bound_s(bound_1_s2) } else { f64::INFINITY }
}

fn added_kg(allowed_s: f64, mass_kg: f64, step_s: f64) -> f64 {
    if allowed_s < step_s { mass_kg * ((step_s / allowed_s).powi(2) - 1.0) } else { 0.0 }
}

/// What is added to elements and, behind them, bars.
fn report(mesh: &Mesh, steps: &[f64], masses: &[f64], step_s: f64) -> MassScaling {
    let mut of_part = vec![[0.0; 2]; mesh.parts.len()];
    let (mut elements, mut sums) = (0, [0.0; 2]);
    let part_of = mesh.elements.iter().map(|e| e.part).chain(mesh.trusses.iter().map(|t| t.part));
    for (e, part) in part_of.enumerate() {
        let added = added_kg(steps[e], masses[e], step_s);
        elements += usize::from(added > 0.0);
        for (sum, more) in [(&mut sums, [added, masses[e]]), (&mut of_part[part], [added, masses[e]])] {
            sum[0] += more[0];
            sum[1] += more[1];
        }
    }
    let parts = of_part
        .iter()
        .zip(&mesh.parts)
        .filter(|([added, _], _)| *added > 0.0)
        .map(|([added, mass], part)| AddedMass {
            part: part.clone(),
            added_kg: *added,
            added_share: added / mass,
        })
        .collect();
    MassScaling { step_s, elements, added_kg: sums[0], added_share: sums[0] / sums[1], parts }
}

/// Largest step whose added mass stays within `limit_kg` \[s\], by bisection below `beyond_s`.
fn largest_step_s(steps: &[f64], masses: &[f64], limit_kg: f64, beyond_s: f64) -> f64 {
    let added = |step: f64| steps.iter().zip(masses).map(|(s, m)| added_kg(*s, *m, step)).sum::<f64>();
    let (mut low, mut high) = (0.0, beyond_s);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if added(middle) <= limit_kg { low = middle } else { high = middle }
    }
    low
}
