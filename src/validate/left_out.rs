//! What each run left out because it cannot change the result, or belongs to its model: counted in the run itself.

use crate::fe::dynamics::Death;
use crate::fe::result::FeRun;
use crate::mbs::RunResult;
use serde::{Deserialize, Serialize};

/// A run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RunKind {
    /// The FE run.
    Fe,
    /// The FE run with rigid parts.
    Hybrid,
    /// The MBS run.
    Mbs,
}

/// What is left out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Skipped {
    /// Elements of rigid parts, of the elements times steps.
    RigidElements,
    /// Elements that do not deform and keep their forces, of the elements times steps.
    RestingElements,
    /// Elements that have failed or were removed, of the elements times steps; by the times of their ends, as if all steps were equal.
    EndedElements,
    /// Steps without a search for contacts of the building's parts with each other, of the steps.
    ContactSearches,
    /// Pairs of solids that cannot have met, of the pairs times steps.
    ContactPairs,
    /// Steps in which no pair was looked at at all, of the steps.
    QuietSteps,
    /// Bodies at rest, of the bodies that run times steps.
    SleepingBodies,
    /// Bodies that latent sections made part of another one, of the bodies times steps.
    HeldBodies,
    /// Latent hinges whose forces nobody asked for, as no rule about events had fired, of the latent hinges times steps.
    UnwatchedHinges,
    /// Looks at latent hinges that rules about events had asked for, whose loads have changed by less than what was left of their resistance, of the looks.
    BoundedLooks,
}

impl Skipped {
    /// The option that has it computed after all; `None`: there is none.
    pub fn switched_off_by(self) -> Option<&'static str> {
        match self {
            Self::RigidElements => Some("fe (without --hybrid)"),
            Self::RestingElements | Self::ContactSearches => Some("fe --compute-all"),
            Self::ContactPairs | Self::QuietSteps | Self::SleepingBodies | Self::BoundedLooks => {
                Some("simulate --compute-all")
            }
            Self::EndedElements | Self::HeldBodies | Self::UnwatchedHinges => None,
        }
    }
}

/// How much a run left out of something.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LeftOut {
    /// The run.
    pub run: RunKind,
    /// What.
    pub what: Skipped,
    /// How much of it.
    pub left_out: u64,
    /// How much there would have been, not zero.
    pub of: u64,
    /// The one over the other.
    pub share: f64,
    /// The option that has it computed after all; `None`: there is none.
    pub switched_off_by: Option<String>,
}

impl LeftOut {
    /// `None` if there was nothing to be left out.
    fn new(run: RunKind, what: Skipped, left_out: u64, of: u64) -> Option<Self> {
        (of > 0).then(|| Self {
            run,
            what,
            left_out,
            of,
            share: left_out as f64 / of as f64,
            switched_off_by: what.switched_off_by().map(str::to_string),
        })
    }
}

/// What an FE run left out, with or without rigid parts.
pub fn of_fe(run: &FeRun) -> Vec<LeftOut> {
    let kind = if run.hybrid.is_some() { RunKind::Hybrid } else { RunKind::Fe };
    let s = &run.summary;
    let all = s.steps * s.elements as u64;
    let rigid = run.hybrid.as_ref().map(|h| (h.skipped_share * all as f64).round() as u64);
    let searches = s.body_contact.as_ref().map(|c| s.steps.saturating_sub(c.searches));
    [
        rigid.map(|n| (Skipped::RigidElements, n, all)),
        Some((Skipped::RestingElements, run.resting_steps, all)),
        Some((Skipped::EndedElements, ended(run), all)),
        searches.map(|n| (Skipped::ContactSearches, n, s.steps)),
    ]
    .into_iter()
    .flatten()
    .filter_map(|(what, left_out, of)| LeftOut::new(kind, what, left_out, of))
    .collect()
}

/// Element-steps of elements after their end.
fn ended(run: &FeRun) -> u64 {
    let end_s = run.times_s.last().copied().unwrap_or(0.0);
    let left = |time_s: f64| (1.0 - time_s / end_s.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    let deaths = run.deaths.iter().filter(|d| d.cause != Death::Split);
    (deaths.map(|d| left(d.time_s)).sum::<f64>() * run.summary.steps as f64).round() as u64
}

/// What an MBS run left out.
pub fn of_mbs(run: &RunResult) -> Vec<LeftOut> {
    let (contact, body) = (&run.contact_work, &run.body_work);
    [
        (Skipped::ContactPairs, contact.pairs_left_alone, contact.pairs_left_alone + contact.pairs_looked_at),
        (Skipped::QuietSteps, contact.quiet_steps, run.steps as u64),
        (Skipped::SleepingBodies, body.asleep_steps, body.body_steps - body.held_steps),
        (Skipped::HeldBodies, body.held_steps, body.body_steps),
        (Skipped::UnwatchedHinges, body.unwatched_steps, body.latent_steps),
        (Skipped::BoundedLooks, body.bounded_looks, body.bounded_looks + body.looks),
    ]
    .into_iter()
    .filter_map(|(what, left_out, of)| LeftOut::new(RunKind::Mbs, what, left_out, of))
    .collect()
}
