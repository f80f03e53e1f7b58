//! What stands in a model of the rules about contacts and fractures, for those who ask why.

use crate::mbs::Model;
use crate::mbs::model::{EventRule, Trigger};
use crate::rules::{Action, RuleBase, Value};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// A rule about events: what it says, what was known when the model was generated, and what is left for the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EventReason {
    /// Its id in the model: that of the rule, with a number where a condition with `or` is several.
    pub id: String,
    /// Rule id.
    pub rule: String,
    /// The rule in words; empty: it is not in the rule base.
    pub words: String,
    /// Its condition, as written.
    pub when: String,
    /// What it decides.
    pub action: String,
    /// The question that it answers: of the rules of a question that are true of an event the first one decides.
    pub question: String,
    /// The members that it is about.
    pub members: Vec<String>,
    /// What is left of its condition, to be seen in the run.
    pub remains: String,
    /// What it then changes.
    pub then: String,
    /// What was carried out of it when the model was generated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub done: Option<String>,
}

impl EventReason {
    /// Those of a model, in the order in which they decide.
    pub fn all(model: &Model, rules: &RuleBase) -> Vec<Self> {
        model.event_rules.iter().map(|r| Self::of(model, r, rules)).collect()
    }

    fn of(model: &Model, own: &EventRule, rules: &RuleBase) -> Self {
        let id = own.origin.rules.first().unwrap_or(&own.id);
        let rule = rules.rule(id);
        let named: BTreeSet<&String> = own.bodies.iter().collect();
        let bodies = model.bodies.iter().filter(|b| named.contains(&b.id));
        let mut members: Vec<String> = bodies.flat_map(|b| b.origin.members.clone()).collect();
        members.dedup();
        let puts_contact_in = rule.is_some_and(|r| {
            let subsystem = r.parameters.get("subsystem");
            let name =
                |value: &Value| matches!(value, Value::Name(n) if n == "contact" || n == "contact_and_hinge");
            r.action == Action::InsertSubsystem && subsystem.is_some_and(name)
        });
        let is_contact = matches!(own.on, Trigger::Contact { .. });
        let crushed = puts_contact_in && is_contact && !model.contact.crushing.is_empty();
        Self {
            id: own.id.clone(),
            rule: id.clone(),
            words: rule.map_or(String::new(), |r| r.words.clone()),
            when: rule.map_or(String::new(), |r| r.when.clone()),
            action: rule.map_or(String::new(), |r| r.action.spec().name.to_string()),
            question: own.question.clone(),
            members,
            remains: own.on.words(),
            then: own.effect_words().to_string(),
            done: crushed.then(|| {
                "the ends of these members may be crushed, from the start of the run on".to_string()
            }),
        }
    }
}
