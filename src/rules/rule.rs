//! One rule.

use super::action::Action;
use super::expr::Expr;
use super::problem::Place;
use super::value::{SubjectKind, Value};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How well a learned rule fits the studies it was learned from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Statistics {
    /// Buildings in which its condition holds somewhere.
    pub buildings: usize,
    /// Places at which it holds.
    pub places: usize,
    /// Of these, places at which what it decides is right.
    pub right: usize,
    /// Share of all places of its kind that it decides about.
    pub coverage: f64,
    /// Probability that it is right in another building: the mean over the buildings, after Laplace.
    pub confidence: f64,
}

impl Statistics {
    /// Share of its places at which it is right.
    pub fn precision(&self) -> f64 {
        self.right as f64 / self.places.max(1) as f64
    }
}

/// By how much a bound of a range may be off: learned ones are written with six digits, so that 1/3 is above 0.333333.
fn slack(bound: f64) -> f64 {
    1e-5 * bound.abs()
}

/// The least number that counts as within a range from `low`, in the unit of its feature.
pub(super) fn least(low: f64) -> f64 {
    low - slack(low)
}

/// The largest number that counts as within a range up to `high`, in the unit of its feature.
pub(super) fn most(high: f64) -> f64 {
    high + slack(high)
}

/// A rule: if its condition holds of a subject, its action is proposed.
#[derive(Debug, Clone, Serialize)]
pub struct Rule {
    /// Unique id, `seed/column-end-hinge`.
    pub id: String,
    /// The rule in plain words.
    pub words: String,
    /// What it is about.
    pub applies_to: SubjectKind,
    /// The condition as written.
    pub when: String,
    /// The condition as read.
    #[serde(skip)]
    pub condition: Expr,
    /// What it decides.
    pub action: Action,
    /// Parameters of the action.
    pub parameters: BTreeMap<String, Value>,
    /// Rules of higher priority decide before those of lower.
    pub priority: i64,
    /// Where the rule comes from.
    pub source: String,
    /// Ids of the studies behind it.
    pub evidence: Vec<String>,
    /// Range of each feature within which the rule is supported, in the unit of the feature.
    pub range: BTreeMap<String, [f64; 2]>,
    /// Ids of rules that it replaces wherever it fires within its range.
    pub supersedes: Vec<String>,
    /// What studies say of it, if it was learned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub statistics: Option<Statistics>,
    /// Places at which it was wrong, `study:place`; the first few.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub counter_examples: Vec<String>,
    /// Where it is written.
    #[serde(skip)]
    pub place: Place,
}
