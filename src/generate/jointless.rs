//! Why member ends, and strips of slabs, have no joint of their own.

use super::Reason;
use super::analyst::ANALYST;
use super::decide::Decision;
use crate::building::Building;
use crate::building::ends::MemberEnd;
use crate::building::lines::Line;
use crate::rules::{Action, Aspect, Firing, RuleBase};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// What a rule said of ends that no part of the model stands for, or of the slab of strips that do not bend, once for all of them.
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
    /// The ends and strips.
    pub ends: Vec<String>,
}

impl Jointless {
    /// Whether the analyst has decided.
    pub fn is_of_analyst(&self) -> bool {
        self.rule == ANALYST
    }

    /// All of a building, but for the ends and strips of which the reasons of the parts speak.
    pub fn all(
        building: &Building,
        (ends, plates): (&[MemberEnd], &[Line]),
        decision: &Decision,
        reasons: &[Reason],
        rules: &RuleBase,
    ) -> Vec<Self> {
        let told: BTreeSet<&str> = reasons.iter().map(|r| r.subject.as_str()).collect();
        let mut groups: BTreeMap<(String, &'static str), Self> = BTreeMap::new();
        let mut enter = |id: &str, firing: &Firing| {
            let action = firing.action.spec().name;
            let group = groups.entry((firing.rule.clone(), action)).or_insert_with(|| Self {
                rule: firing.rule.clone(),
                action: action.to_string(),
                words: rules.rule(&firing.rule).map(|r| r.words.clone()).unwrap_or_default(),
                confidence: firing.confidence,
                ends: Vec::new(),
            });
            group.ends.push(id.to_string());
        };
        for end in ends.iter().filter(|e| !told.contains(e.id.as_str())) {
            decision.standing(&end.id).for_each(|firing| enter(&end.id, firing));
        }
        let strips = plates.iter().filter(|l| l.columns.is_some() && !told.contains(l.id.as_str()));
        let slab_of = |strip: &Line| &building.members[strip.member].id;
        for strip in strips.clone() {
            let is_whole = |f: &&Firing| matches!(f.action, Action::MergeRigid | Action::RigidBody);
            decision.standing(slab_of(strip)).filter(is_whole).for_each(|firing| enter(&strip.id, firing));
        }
        let ruled = groups.into_values();
        let mut of_analyst: BTreeMap<&String, Self> = BTreeMap::new();
        for strip in strips.filter(|l| decision.answer(slab_of(l), Aspect::Body) == Some(Action::MergeRigid))
        {
            let Some(reason) = decision.of_analyst(slab_of(strip), &strip.id, &[]) else { continue };
            let Reason { rule, action, words, confidence, .. } = reason;
            let group = || Self { rule, action, words, confidence, ends: Vec::new() };
            of_analyst.entry(slab_of(strip)).or_insert_with(group).ends.push(strip.id.clone());
        }
        ruled.chain(of_analyst.into_values()).collect()
    }
}
