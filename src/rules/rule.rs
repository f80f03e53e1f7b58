//! One rule.

use super::action::Action;
use super::expr::Expr;
use super::problem::Place;
use super::value::{SubjectKind, Value};
use serde::Serialize;
use std::collections::BTreeMap;

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
    /// Where it is written.
    #[serde(skip)]
    pub place: Place,
}
