//! What a run begins with: its step, its empty result; and words for what goes wrong then.

use super::{LARGEST_STEP_S, MOST_STEPS};
use crate::mbs::contact::ContactSet;
use crate::mbs::error::SolveError;
use crate::mbs::frequency;
use crate::mbs::joint::JointData;
use crate::mbs::latent::Latent;
use crate::mbs::math;
use crate::mbs::model::{Bending, Bushing, Model, RunSettings};
use crate::mbs::preload::PreloadError;
use crate::mbs::result::{CrushedHistory, HingeHistory, LatentRecord, RunResult};
use crate::mbs::system::System;
use petgraph::unionfind::UnionFind;
use std::collections::BTreeSet;

/// Tells the contacts which bodies are there and which a joint connects, and which bodies of the file are `crushed`: what is left of such a member holds nothing up. Pieces of what was one body count as that body as far as intact joints still connect them: a column
/// that did not touch its floor as a whole does not touch the pieces of it either. The ground is another matter: what comes off a foot may fall onto it, and what no joint holds in height stands on it.
pub(super) fn connect(contacts: &mut ContactSet, system: &System, latent: &Latent, crushed: &[bool]) {
    let counts =
        |j: &&JointData| j.alive && (j.a.max(j.b) < system.count() || j.bears_weight(&system.bodies));
    let joined = || system.joints.iter().filter(counts).map(|j| (j.a, j.b));
    let is_crushed = |body: &usize| latent.pieces[*body].iter().any(|piece| crushed[*piece]);
    let crushed = (0..system.count()).filter(is_crushed).collect();
    if !latent.has_parted() {
        contacts.connect(joined(), |i| system.data[i].alive, crushed);
        return;
    }
    let mut sets = UnionFind::<usize>::new(system.bodies.len());
    for (a, b) in joined().filter(|(a, b)| latent.were_one(*a, *b)) {
        sets.union(a, b);
    }
    let labels = sets.into_labeling();
    let mut members = vec![Vec::new(); labels.len()];
    labels.iter().enumerate().for_each(|(i, label)| members[*label].push(i));
    let mut pairs = BTreeSet::new();
    for (a, b) in joined() {
        if a.max(b) >= system.count() {
            pairs.insert((a.min(b), a.max(b)));
            continue;
        }
        for x in &members[labels[a]] {
            pairs.extend(members[labels[b]].iter().filter(|y| x != *y).map(|y| (*x.min(y), *x.max(y))));
        }
    }
    contacts.connect(pairs.into_iter(), |i| system.data[i].alive, crushed);
}

/// A step from which too many of them are the fault of the interval \[s\].
const ORDINARY_STEP_S: f64 = 1e-6;

/// The step given, or a share of the automatic one.
pub(super) fn choose_step(model: &Model, frequency: f64, share: f64) -> Result<f64, SolveError> {
    let limit = if frequency > 0.0 { 2.0 / frequency } else { f64::INFINITY };
    if let Some(given) = model.settings.time_step_s {
        return if given > limit { Err(SolveError::time_step(given, limit, limit)) } else { Ok(given) };
    }
    let interval = model.settings.output_interval_s;
    let automatic = (frequency::STEP_FRACTION * limit).min(LARGEST_STEP_S);
    // steps end at outputs: a share of one that is cut off there anyway would be no shorter
    let step = if share < 1.0 { share * automatic.min(interval) } else { automatic };
    if interval / step >= MOST_STEPS {
        if step >= ORDINARY_STEP_S {
            return Err(SolveError::LongInterval { step_s: step, interval_s: interval });
        }
        let (bushing, highest_rad_s) = stiffest(model);
        return Err(SolveError::TooManySteps { bushing, highest_rad_s, step_s: step, interval_s: interval });
    }
    Ok(step)
}

/// The bushing on which its bodies alone swing fastest, and a bound of how fast \[rad/s\].
fn stiffest(model: &Model) -> (String, f64) {
    let square = |b: &Bushing| {
        let ends = [b.body_a.as_deref(), Some(b.body_b.as_str())];
        let bodies =
            ends.into_iter().flatten().filter_map(|id| model.bodies.iter().find(|body| body.id == id));
        let [across, about] = bodies.fold([0.0; 2], |[across, about], body| {
            let inertia = (0..3).map(|k| body.inertia_kg_m2[k][k]).fold(f64::INFINITY, f64::min);
            let arm = math::sub(b.point_m, body.position_m);
            [across + 1.0 / body.mass_kg + math::dot(arm, arm) / inertia, about + 1.0 / inertia]
        });
        let springs = [b.axial_stiffness_n_m, b.shear_stiffness_n_m[0], b.shear_stiffness_n_m[1]];
        let bending = b.bending.iter().map(|k| match k {
            Bending::Elastic { stiffness_nm_rad } => *stiffness_nm_rad,
            Bending::Curve { curve, strength_factor } => {
                model.curves.get(curve).map_or(0.0, |c| strength_factor * c.stiffness_nm_rad)
            }
        });
        let turning = bending.fold(b.torsional_stiffness_nm_rad, f64::max);
        (across * springs.into_iter().fold(0.0, f64::max)).max(about * turning)
    };
    let all = model.bushings.iter().map(|b| (square(b), &b.id));
    all.max_by(|a, b| a.0.total_cmp(&b.0))
        .map_or_else(Default::default, |(square, id)| (id.clone(), square.sqrt()))
}

/// Where the given step is above a limit: tells one that holds for the whole run, below the limits at frequencies that the bodies have \[rad/s\] and at those that they have once all have parted that may.
pub(super) fn usable_step(error: SolveError, file: &Model, highest_rad_s: f64) -> SolveError {
    let SolveError::TimeStep { given_s, limit_s, .. } = error else { return error };
    let may_part = file.bushings.iter().any(|b| b.latent.is_some());
    let parted = may_part.then(|| System::new(file).ok()).flatten();
    let parted_rad_s = parted.map_or(0.0, |mut system| frequency::highest_rad_s(&mut system));
    SolveError::time_step(given_s, limit_s, 2.0 / highest_rad_s.max(parted_rad_s))
}

pub(super) fn preload_error(model: &Model, error: PreloadError) -> SolveError {
    match error {
        PreloadError::Mechanism { body } => {
            SolveError::Mechanism { body: model.bodies[body].id.clone(), joints: joints_of(model, body) }
        }
        PreloadError::NoConvergence { body, residual } => {
            SolveError::Preload { body: model.bodies[body].id.clone(), residual }
        }
    }
}

pub(super) fn joints_of(model: &Model, body: usize) -> String {
    let id = &model.bodies[body].id;
    let own = model.bushings.iter().filter(|j| j.body_b == *id || j.body_a.as_ref() == Some(id));
    let list: Vec<&str> = own.map(|j| j.id.as_str()).collect();
    if list.is_empty() { "none".into() } else { list.join(", ") }
}

/// How many outputs a run has after that at its start.
pub(super) fn outputs(settings: &RunSettings) -> usize {
    (settings.end_time_s / settings.output_interval_s * (1.0 + 1e-12)).floor() as usize
}

pub(super) fn empty_result(
    model: &Model,
    hinges: &[(usize, usize)],
    frequency: f64,
    preload_iterations: Option<usize>,
) -> RunResult {
    let outputs = outputs(&model.settings) + 1;
    let crushed = model.contact.crushing.iter().map(|f| CrushedHistory {
        body: f.body.clone(),
        shape: f.shape,
        face: f.face,
        depth_m: Vec::new(),
        energy_j: Vec::new(),
    });
    let latent = model.bushings.iter().filter(|b| b.latent.is_some()).map(|b| LatentRecord {
        joint: b.id.clone(),
        largest_share: 0.0,
        live_s: None,
    });
    let hinge_histories = hinges.iter().map(|(i, k)| HingeHistory {
        joint: model.bushings[*i].hinges()[*k].to_string(),
        rotation_rad: Vec::with_capacity(outputs),
        moment_nm: Vec::with_capacity(outputs),
        plastic_rotation_rad: Vec::with_capacity(outputs),
        axial_force_n: Vec::with_capacity(outputs),
    });
    RunResult {
        hinges: hinge_histories.collect(),
        latent: latent.collect(),
        crushed: crushed.collect(),
        highest_frequency_rad_s: frequency,
        preload_iterations,
        ..RunResult::empty(model, outputs)
    }
}
