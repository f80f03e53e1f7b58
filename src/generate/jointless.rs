//! Why member ends have no joint of their own.

use super::Reason;
use super::decide::Decision;
use crate::building::ends::MemberEnd;
use crate::rules::RuleBase;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// What a rule said of ends that no part of the model stands for, once for all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Jointless {
    /// Rule id.
    pub rule: String,
    /// What is decided.
    pub action: String,
    /// The rule in words.
    pub words: String,
    /// How sure the rule is, if it was learned from studies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// The ends.
    pub ends: Vec<String>,
}

impl Jointless {
    /// All of a building, but for the ends of which the reasons of the parts speak.
    pub fn all(decision: &Decision, ends: &[MemberEnd], reasons: &[Reason], rules: &RuleBase) -> Vec<Self> {
        let told: BTreeSet<&str> = reasons.iter().map(|r| r.subject.as_str()).collect();
        let mut groups: BTreeMap<(String, &'static str), Self> = BTreeMap::new();
        for end in ends.iter().filter(|e| !told.contains(e.id.as_str())) {
            for firing in decision.standing(&end.id) {
                let action = firing.action.spec().name;
                let group = groups.entry((firing.rule.clone(), action)).or_insert_with(|| Self {
                    rule: firing.rule.clone(),
                    action: action.to_string(),
                    words: rules.rule(&firing.rule).map(|r| r.words.clone()).unwrap_or_default(),
                    confidence: firing.confidence,
                    ends: Vec::new(),
                });
                group.ends.push(end.id.clone());
            }
        }
        groups.into_values().collect()
    }
}
