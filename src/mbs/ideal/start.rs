//! Velocities at the start of a run, as joints allow them.

use super::march::Marcher;
use super::motion::{Motion, STATE};
use super::{Mechanism, compile};
use crate::curve::CurveError;
use crate::mbs::math::V3;
use crate::mbs::model::{Event, Joint, Model};
use crate::mbs::run::SAME;
use std::collections::BTreeSet;

/// Velocity across joints that is worth a warning, as a share of the largest \[m/s, rad/s\].
const VELOCITY: f64 = 1e-6;

/// Velocities and angular velocities of the bodies of a model at its start \[m/s, rad/s\], as the joints allow them that events at t = 0 leave, if those of the file do not fit these.
///
/// # Errors
/// If a curve cannot be compiled.
pub fn fitting_velocities(model: &Model) -> Result<Option<Vec<[V3; 2]>>, CurveError> {
    if model.joints.is_empty() {
        return Ok(None);
    }
    let mechanism = compile::mechanism(model);
    let state = fitting_state(model, &mechanism)?;
    let misfit = misfit(&Motion::state(&mechanism), &state);
    let of = |s: &[f64]| [[s[7], s[8], s[9]], [s[10], s[11], s[12]]];
    let bodies = state.chunks_exact(STATE).take(model.bodies.len());
    Ok(misfit.map(|_| bodies.map(of).collect()))
}

/// The state of the start, its velocities projected onto the joints that events at t = 0 leave: one that goes at once holds nothing that is given for the time from it on.
///
/// # Errors
/// If a curve cannot be compiled.
pub(super) fn fitting_state(model: &Model, mechanism: &Mechanism) -> Result<Vec<f64>, CurveError> {
    let gone = freed(model);
    let joints = mechanism.joints.iter().enumerate();
    let left = Mechanism {
        bodies: mechanism.bodies.clone(),
        joints: joints.filter(|(place, _)| !gone.contains(place)).map(|(_, joint)| *joint).collect(),
        gravity_m_s2: mechanism.gravity_m_s2,
        ..Mechanism::default()
    };
    let settings = &model.settings;
    Ok(Marcher::of(&left, settings.tolerance, settings.end_time_s, true)?.state)
}

/// Joints that events at t = 0 take away, by their places in the model.
pub(super) fn freed(model: &Model) -> BTreeSet<usize> {
    let at_once = |e: &&Event| e.time_s.abs() <= SAME * model.settings.end_time_s;
    let events: Vec<&Event> = model.events.iter().filter(at_once).collect();
    let is_gone = |id: &str| events.iter().any(|e| e.remove_bodies.iter().any(|body| body == id));
    let goes = |joint: &Joint| {
        let released = events.iter().any(|e| e.release.contains(&joint.id));
        released || is_gone(&joint.body_b) || joint.body_a.as_deref().is_some_and(is_gone)
    };
    model.joints.iter().enumerate().filter(|(_, joint)| goes(joint)).map(|(place, _)| place).collect()
}

/// The body whose velocity or angular velocity a projection onto the joints changed most, and by how much, if that is worth a word \[m/s, rad/s\].
pub(super) fn misfit(given: &[f64], projected: &[f64]) -> Option<(usize, f64)> {
    let six = |s: &[f64]| -> [f64; 6] { std::array::from_fn(|k| s[7 + k]) };
    let change = |(a, b): (&[f64], &[f64])| {
        six(a).into_iter().zip(six(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let largest = given.chunks_exact(STATE).flat_map(six).fold(0.0_f64, |a, v| a.max(v.abs()));
    let changes = given.chunks_exact(STATE).zip(projected.chunks_exact(STATE)).map(change);
    let most = changes.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    most.filter(|(_, change)| *change > VELOCITY * largest)
}
