//! Models with a decision turned round, and how far their runs are from that of the model as decided.

use super::Change;
use crate::building::{Building, Override};
use crate::generate::{Alternative, GenerateError, Generated, Generator};
use crate::mbs::model::{Bending, Model};
use crate::mbs::{RunResult, simulate_carefully};
use crate::validate::fell;
use rayon::prelude::*;

/// The model with a decision turned round, or why there is none.
pub fn otherwise(
    building: &Building,
    generator: &mut Generator,
    generated: &Generated,
    alternative: &Alternative,
) -> Result<Model, String> {
    let overrides = match alternative {
        Alternative::Nothing => return Err(alternative.words()),
        Alternative::Weaker(entry, factor) => return Ok(weaker(&generated.model, entry, *factor)),
        Alternative::Without(target) => without(building, target),
        Alternative::Decide(target, action) => {
            let reason = "turned round for the review list".to_string();
            let mut overrides = without(building, target);
            overrides.push(Override { target: target.clone(), action: *action, reason });
            overrides
        }
    };
    match generator.model(&overrides, &|_| {}) {
        Ok(mut other) => {
            // a step that was asked for is none of the building's
            other.model.settings.time_step_s = generated.model.settings.time_step_s;
            Ok(other.model)
        }
        Err(GenerateError::Override(_, why)) => Err(why),
        Err(error) => Err(error.to_string()),
    }
}

fn without(building: &Building, target: &str) -> Vec<Override> {
    building.overrides.iter().filter(|o| o.target != target).cloned().collect()
}

/// The model with weaker curves of one entry.
fn weaker(model: &Model, entry: &str, factor: f64) -> Model {
    let mut model = model.clone();
    let prefix = format!("{entry}/");
    for bending in model.bushings.iter_mut().flat_map(|b| &mut b.bending) {
        if let Bending::Curve { curve, strength_factor } = bending
            && curve.starts_with(&prefix)
        {
            *strength_factor *= factor;
        }
    }
    model
}

/// Runs some models side by side; how far each is from a run, or why it stopped.
pub fn changes(models: &[(usize, Model)], run: &RunResult) -> Vec<Result<Change, String>> {
    let one = |(_, model): &(usize, Model)| {
        let other = simulate_carefully(model).map_err(|e| format!("its run stops: {e}"))?;
        Ok(change(run, &other))
    };
    models.par_iter().with_max_len(1).map(one).collect()
}

/// How far two runs are apart.
fn change(run: &RunResult, other: &RunResult) -> Change {
    let first_contact_s = [run, other].map(|r| r.first_ground_contact_s);
    let contact_s = first_contact_s.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let (mut to_contact, mut whole) = (0.0_f64, 0.0_f64);
    for point in &run.tracked {
        let Some(same) = other.tracked.iter().find(|p| p.id == point.id) else { continue };
        let pairs = point.displacement_m.iter().zip(&same.displacement_m);
        for (time_s, (u, v)) in run.times_s.iter().zip(pairs) {
            let apart = (0..3).map(|i| (u[i] - v[i]).powi(2)).sum::<f64>().sqrt();
            whole = whole.max(apart);
            if *time_s <= contact_s {
                to_contact = to_contact.max(apart);
            }
        }
    }
    let collapsed = [run, other].map(|r| r.tracked.iter().any(|p| fell(&p.displacement_m)));
    Change { collapsed, first_contact_s, difference_to_contact_m: to_contact, difference_m: whole }
}
