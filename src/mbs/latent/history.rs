//! Which bodies moved as one at a time of a run, from what the run tells.

use super::merge::held_together;
use crate::mbs::model::Model;
use crate::mbs::result::{EventKind, RunResult};
use std::collections::{BTreeMap, BTreeSet};

/// Latent bushings of a model and when each went live in a run \[s\]; infinite: it stayed latent.
pub fn live_s<'a>(model: &'a Model, result: &RunResult) -> BTreeMap<&'a str, f64> {
    let latent = model.bushings.iter().filter(|b| b.latent.is_some());
    let mut times: BTreeMap<&str, f64> = latent.map(|b| (b.id.as_str(), f64::INFINITY)).collect();
    for event in &result.events {
        if let EventKind::Live { joint, .. } = &event.kind
            && let Some(time_s) = times.get_mut(joint.as_str())
        {
            *time_s = time_s.min(event.time_s);
        }
    }
    times
}

/// Whether each body of the model file has vanished by a time \[s\].
pub fn is_gone(model: &Model, time_s: f64) -> Vec<bool> {
    let past = model.events.iter().filter(|e| e.time_s <= time_s);
    let gone: BTreeSet<&String> = past.flat_map(|e| &e.remove_bodies).collect();
    model.bodies.iter().map(|b| gone.contains(&b.id)).collect()
}

/// Of each body of the model file the compound that it moves with at a time \[s\], a number that the bodies of one have in common; `None`: the body has vanished.
///
/// Compounds are what latent bushings hold together that have not gone live by then; a body that none holds is one by itself.
pub fn compounds(model: &Model, result: &RunResult, time_s: f64) -> Vec<Option<usize>> {
    let live_s = live_s(model, result);
    let held: Vec<bool> =
        model.bushings.iter().map(|b| live_s.get(b.id.as_str()).is_some_and(|t| *t > time_s)).collect();
    let labels = held_together(model, &held);
    labels.into_iter().zip(is_gone(model, time_s)).map(|(label, gone)| (!gone).then_some(label)).collect()
}
