//! What changed between two rule bases.

use super::rule::{Rule, Statistics};
use super::{RuleBase, value::Value};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A change of one rule.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum Change {
    /// The rule is new.
    Added {
        /// Its id.
        rule: String,
        /// Its condition.
        when: String,
        /// What it decides.
        action: String,
    },
    /// The rule is gone.
    Removed {
        /// Its id.
        rule: String,
        /// Its condition.
        when: String,
        /// What it decided.
        action: String,
    },
    /// The rule is another one.
    Changed {
        /// Its id.
        rule: String,
        /// What of it changed.
        fields: Vec<FieldChange>,
    },
}

/// A change of one field of a rule.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FieldChange {
    /// Name of the field.
    pub field: String,
    /// Before; empty if it was not there.
    pub old: String,
    /// After; empty if it is gone.
    pub new: String,
}

/// All changes, by id.
pub fn changes(old: &RuleBase, new: &RuleBase) -> Vec<Change> {
    let by_id = |base: &RuleBase| -> BTreeMap<String, Rule> {
        base.rules().iter().map(|rule| (rule.id.clone(), rule.clone())).collect()
    };
    let (old, new) = (by_id(old), by_id(new));
    let ids: BTreeSet<&String> = old.keys().chain(new.keys()).collect();
    let change = |id: &String| match (old.get(id), new.get(id)) {
        (None, Some(rule)) => {
            Some(Change::Added { rule: id.clone(), when: rule.when.clone(), action: action(rule) })
        }
        (Some(rule), None) => {
            Some(Change::Removed { rule: id.clone(), when: rule.when.clone(), action: action(rule) })
        }
        (Some(old), Some(new)) => {
            let fields = fields(old, new);
            (!fields.is_empty()).then(|| Change::Changed { rule: id.clone(), fields })
        }
        (None, None) => None,
    };
    ids.into_iter().filter_map(change).collect()
}

fn action(rule: &Rule) -> String {
    let parameters: Vec<String> =
        rule.parameters.iter().map(|(name, value): (&String, &Value)| format!("{name} = {value}")).collect();
    let name = rule.action.spec().name;
    if parameters.is_empty() { name.to_string() } else { format!("{name} ({})", parameters.join(", ")) }
}

fn fields(old: &Rule, new: &Rule) -> Vec<FieldChange> {
    let mut found: Vec<FieldChange> = texts(old)
        .into_iter()
        .zip(texts(new))
        .filter(|((_, old), (_, new))| old != new)
        .map(|((field, old), (_, new))| FieldChange { field: field.to_string(), old, new })
        .collect();
    found.extend(lists("evidence", &old.evidence, &new.evidence));
    found.extend(lists("counter_examples", &old.counter_examples, &new.counter_examples));
    found
}

/// The fields of a rule that are told whole.
fn texts(rule: &Rule) -> [(&'static str, String); 9] {
    let range: Vec<String> =
        rule.range.iter().map(|(name, [low, high])| format!("{name} from {low} to {high}")).collect();
    [
        ("applies_to", rule.applies_to.to_string()),
        ("when", rule.when.clone()),
        ("action", action(rule)),
        ("priority", rule.priority.to_string()),
        ("supersedes", rule.supersedes.join(", ")),
        ("range", range.join(", ")),
        ("statistics", rule.statistics.map_or(String::new(), |s| statistics(&s))),
        ("words", rule.words.clone()),
        ("source", rule.source.clone()),
    ]
}

/// Statistics in words.
pub fn statistics(s: &Statistics) -> String {
    format!(
        "right at {} of {} places ({:.1} %) of {} buildings, decides about {:.1} % of such places, confidence {}",
        s.right,
        s.places,
        100.0 * s.precision(),
        s.buildings,
        100.0 * s.coverage,
        s.confidence
    )
}

/// What came to a list and what left it.
fn lists(field: &str, old: &[String], new: &[String]) -> Option<FieldChange> {
    let only = |a: &[String], b: &[String]| {
        let list: Vec<&str> = a.iter().filter(|x| !b.contains(x)).map(String::as_str).collect();
        list.join(", ")
    };
    let (gone, come) = (only(old, new), only(new, old));
    let changed = !gone.is_empty() || !come.is_empty();
    changed.then(|| FieldChange { field: field.to_string(), old: gone, new: come })
}
