//! What an analyst should look at in a generated model, in order of what it could change in the result.
//!
//! A decision is turned round, the model generated again and run: its measure is how far tracked points then are elsewhere before anything touches the ground, and whether the outcome is another one.
//! No FE run is needed. What was not turned round stands in a documented order ([`Doubt::order`]) between what changes the result and what does not: it may still do so.

mod runs;

use crate::base::units::round_to_digits;
use crate::building::Building;
use crate::generate::{Alternative, Doubt, Generated, Generator};
use crate::mbs::RunResult;
use crate::validate::LIMIT_STANDING_M;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Version of `review.json`.
pub const REVIEW_SCHEMA: u32 = 1;
/// Largest distance of tracked points at which a decision counts as one that changes nothing: as far as two runs of a structure that stands may be apart \[m\].
pub const NEGLIGIBLE_M: f64 = LIMIT_STANDING_M;
/// Most work of all runs together, in bodies times steps of the run that is compared with: some ten seconds.
const MOST_WORK: usize = 20_000_000;
/// Runs that are allowed whatever they cost.
const LEAST_RUNS: usize = 4;

/// The list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Review {
    /// Always [`REVIEW_SCHEMA`].
    pub schema: u32,
    /// Name of the building.
    pub building: String,
    /// Runs with a decision turned round.
    pub runs: usize,
    /// Most such runs that were allowed.
    pub most_runs: usize,
    /// What is worth a look, first what changes most.
    pub items: Vec<Item>,
}

/// A decision worth a look.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Item {
    /// Place in the list, from 1.
    pub rank: usize,
    /// What it is about; empty: the model as a whole.
    pub subjects: Vec<String>,
    /// What is decided.
    pub decision: String,
    /// Rule, analyst's override or entry that decides.
    pub by: String,
    /// Kind of the strongest reason for doubt.
    pub kind: String,
    /// Why it is worth a look.
    pub why: Vec<String>,
    /// What could be decided otherwise.
    pub otherwise: String,
    /// What that changes.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub change: Option<Change>,
    /// Why it was not tried.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub untried: Option<String>,
}

/// What a decision the other way changes in the run; pairs are as decided, and otherwise.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// Whether the structure collapses.
    pub collapsed: [bool; 2],
    /// First contact with the ground \[s\].
    pub first_contact_s: [Option<f64>; 2],
    /// Largest distance of a tracked point's displacements up to the first contact of either run \[m\].
    pub difference_to_contact_m: f64,
    /// The same over the whole run \[m\].
    pub difference_m: f64,
}

impl Change {
    /// Whether the outcome is another one.
    pub fn turns_outcome(&self) -> bool {
        self.collapsed[0] != self.collapsed[1]
    }

    /// In words.
    pub fn words(&self) -> String {
        let length = |m: f64| match m {
            m if m < 1.0 => format!("{} mm", round_to_digits(1e3 * m, 2)),
            m => format!("{} m", round_to_digits(m, 2)),
        };
        let outcome = match self.collapsed {
            [true, false] => "stands instead of collapsing; ",
            [false, true] => "collapses instead of standing; ",
            _ => "",
        };
        let to_contact = length(self.difference_to_contact_m);
        format!(
            "{outcome}{to_contact} elsewhere before the first contact, {} in all",
            length(self.difference_m)
        )
    }
}

impl Item {
    fn of(doubt: &Doubt) -> Self {
        Self {
            rank: 0,
            subjects: doubt.subjects.clone(),
            decision: doubt.action.clone(),
            by: doubt.by.clone(),
            kind: doubt.why.first().map_or("", |why| why.kind().1).to_string(),
            why: doubt.why.iter().map(crate::generate::Why::words).collect(),
            otherwise: doubt.alternative.words(),
            change: None,
            untried: None,
        }
    }

    /// What it is about, in a few words.
    pub fn subject_words(&self) -> String {
        match self.subjects.as_slice() {
            [] => "the model".to_string(),
            [one] => one.clone(),
            [one, rest @ ..] => format!("{one} and {} more", rest.len()),
        }
    }

    /// What the decision could change, or why that is not known.
    pub fn change_words(&self) -> String {
        match (&self.change, &self.untried) {
            (Some(change), _) => change.words(),
            (None, Some(why)) => format!("not tried: {why}"),
            (None, None) => "not tried".to_string(),
        }
    }

    /// Its group in the order: another outcome, a change that counts, not tried, nothing to try, a change that does not count.
    fn group(&self) -> usize {
        match &self.change {
            Some(change) if change.turns_outcome() => 0,
            Some(change) if change.difference_to_contact_m > NEGLIGIBLE_M => 1,
            Some(_) => 4,
            None => 2,
        }
    }
}

/// The list without a run: in the documented order.
pub fn listed(building: &Building, generated: &Generated) -> Review {
    let untried = |doubt: &Doubt| match doubt.alternative {
        Alternative::Nothing => None,
        _ => Some("decisions are turned round with `--review`".to_string()),
    };
    let items = generated.doubts.iter().map(|d| Item { untried: untried(d), ..Item::of(d) }).collect();
    sorted(building, generated, items, [0, 0])
}

/// The list with decisions turned round, in no more than some runs; `run` is the run of the model. Kinds of doubt take turns, so that none of them uses up the runs.
pub fn measured(
    building: &Building,
    generator: &mut Generator,
    generated: &Generated,
    run: &RunResult,
    most_runs: usize,
) -> Review {
    let work = (run.steps * generated.model.bodies.len()).max(1);
    let allowed = most_runs.min((MOST_WORK / work).max(LEAST_RUNS));
    let mut items: Vec<Item> = generated.doubts.iter().map(Item::of).collect();
    generator.compute_no_more(&generated.entries);
    let mut models = Vec::new();
    for index in turns(&generated.doubts) {
        let doubt = &generated.doubts[index];
        if models.len() >= allowed {
            items[index].untried = Some(format!("more than {allowed} runs"));
            continue;
        }
        match runs::otherwise(building, generator, generated, &doubt.alternative) {
            Ok(model) => models.push((index, model)),
            Err(why) => items[index].untried = Some(why),
        }
    }
    let changes = runs::changes(&models, run);
    for ((index, _), change) in models.iter().zip(changes) {
        match change {
            Ok(change) => items[*index].change = Some(change),
            Err(why) => items[*index].untried = Some(why),
        }
    }
    sorted(building, generated, items, [models.len(), allowed])
}

/// Doubts that can be turned round: the strongest of each kind, then the second of each, and so on.
fn turns(doubts: &[Doubt]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..doubts.len()).filter(|i| doubts[*i].alternative != Alternative::Nothing).collect();
    order.sort_by(|a, b| by_order(&doubts[*a], &doubts[*b]));
    let mut seen = BTreeMap::<usize, usize>::new();
    let mut turns: Vec<(usize, usize, usize)> = Vec::new();
    for index in order {
        let kind = doubts[index].order().0;
        let turn = seen.entry(kind).or_default();
        turns.push((*turn, kind, index));
        *turn += 1;
    }
    turns.sort_unstable();
    turns.into_iter().map(|(.., index)| index).collect()
}

fn by_order(a: &Doubt, b: &Doubt) -> Ordering {
    let ((kind_a, strength_a), (kind_b, strength_b)) = (a.order(), b.order());
    kind_a.cmp(&kind_b).then(strength_a.total_cmp(&strength_b))
}

fn sorted(
    building: &Building,
    generated: &Generated,
    items: Vec<Item>,
    [runs, most_runs]: [usize; 2],
) -> Review {
    let mut pairs: Vec<(Item, &Doubt)> = items.into_iter().zip(&generated.doubts).collect();
    let group = |(item, doubt): &(Item, &Doubt)| match doubt.alternative {
        Alternative::Nothing => 3,
        _ => item.group(),
    };
    let size = |(item, _): &(Item, &Doubt)| {
        let change = item.change.as_ref();
        change.map_or([0.0; 2], |c| [-c.difference_to_contact_m, -c.difference_m])
    };
    let by_size = |a: [f64; 2], b: [f64; 2]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
    pairs.sort_by(|a, b| {
        group(a).cmp(&group(b)).then_with(|| by_size(size(a), size(b))).then_with(|| by_order(a.1, b.1))
    });
    let ranked = pairs.into_iter().enumerate().map(|(i, (item, _))| Item { rank: i + 1, ..item });
    Review {
        schema: REVIEW_SCHEMA,
        building: building.name.clone(),
        runs,
        most_runs,
        items: ranked.collect(),
    }
}
