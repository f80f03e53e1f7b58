//! Asks the rules about every member and member end, and keeps their answers.

use super::known::Known;
use super::{Accuracy, GenerateError, is_column};
use crate::building::Building;
use crate::building::ends::MemberEnd;
use crate::mbs::Model;
use crate::rules::{Action, Aspect, RuleBase, Subject, Trace};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// One reason: a rule that fired for a part of the building.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// Body or joint of the model.
    pub part: String,
    /// Member or member end that the rule decided about.
    pub subject: String,
    /// Rule id.
    pub rule: String,
    /// What the rule decided.
    pub action: String,
    /// The rule in words.
    pub words: String,
    /// Whether the subject lies in the rule's range of evidence.
    pub in_range: bool,
    /// How sure the rule is, if it was learned from studies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Library entries of the part.
    pub entries: Vec<String>,
}

/// What the rules decided.
#[derive(Debug, Clone, Default)]
pub struct Decision {
    /// Members that may be one rigid body with neighbours of which the same is true.
    pub merges: Vec<bool>,
    /// Those of them whose floor bends.
    bends: Vec<bool>,
    /// Hinged member ends with the ids of the rules that put hinge and springs there.
    pub hinges: BTreeMap<String, Vec<String>>,
    /// Those of them that stay elastic.
    pub elastic: BTreeSet<String>,
    /// Beam ends at which floors may fold, with the ids of the rules that say so.
    pub latent: BTreeMap<String, Vec<String>>,
    /// What the rules said, by subject.
    traces: BTreeMap<String, Trace>,
    /// What an analyst should look at.
    pub notes: Vec<String>,
}

impl Decision {
    /// Asks the rules. An end of a member that merges with its neighbours needs no decision of its own.
    pub fn of(
        building: &Building,
        ends: &[MemberEnd],
        known: &Known,
        accuracy: Accuracy,
        rules: &RuleBase,
    ) -> Result<Self, GenerateError> {
        let none = vec![false; building.members.len()];
        let mut this = Self { merges: none.clone(), bends: none, ..Self::default() };
        let mut gaps = Vec::new();
        let wished = |subject: &Subject| subject.clone().with("wish.accuracy", accuracy.name());
        for (index, subject) in known.members.iter().enumerate() {
            match this.ask(rules, &wished(subject), Aspect::Body)? {
                Some(Action::MergeRigid) => this.merges[index] = true,
                Some(Action::MergeElastic) => (this.merges[index], this.bends[index]) = (true, true),
                Some(Action::RigidBody) => {}
                Some(other) => return Err(unsupported(subject, other)),
                None => gaps.push(subject.id.clone()),
            }
        }
        for (end, subject) in ends.iter().zip(&known.ends) {
            let column = is_column(building, end.member);
            let answer = this.ask(rules, &wished(subject), Aspect::Rotation)?;
            match answer {
                Some(Action::Hinge) if column => {
                    this.hinges.insert(end.id.clone(), this.fired(&end.id));
                }
                Some(Action::ElasticConnection) if column => {
                    this.hinges.insert(end.id.clone(), this.fired(&end.id));
                    this.elastic.insert(end.id.clone());
                }
                Some(Action::LatentHinge) if !column => {
                    this.latent.insert(end.id.clone(), this.fired(&end.id));
                }
                Some(Action::RigidConnection) if !column => {}
                Some(other) => return Err(unsupported(subject, other)),
                None => gaps.push(end.id.clone()),
            }
        }
        if gaps.is_empty() { Ok(this) } else { Err(GenerateError::Gap(gaps)) }
    }

    /// Asks the rules about a subject; the answer to one question.
    fn ask(
        &mut self,
        rules: &RuleBase,
        subject: &Subject,
        aspect: Aspect,
    ) -> Result<Option<Action>, GenerateError> {
        let trace = rules.trace(subject)?;
        for firing in trace.standing().filter(|f| !f.in_range) {
            let why: Vec<&str> = firing.outside.iter().chain(&firing.missing).map(String::as_str).collect();
            self.notes.push(format!(
                "rule `{}` is used outside its range of evidence for {} ({})",
                firing.rule,
                subject.id,
                why.join(", ")
            ));
        }
        let answer = trace.decision(aspect).map(|f| f.action);
        self.traces.insert(subject.id.clone(), trace);
        Ok(answer)
    }

    /// The rules that decided about a subject.
    fn fired(&self, id: &str) -> Vec<String> {
        self.traces[id].standing().map(|f| f.rule.clone()).collect()
    }

    /// Whether the floor of some members bends: if a rule says so of any of them.
    pub fn bends(&self, members: &[usize]) -> bool {
        members.iter().any(|m| self.bends[*m])
    }

    /// Rules that made some members one body.
    pub fn rules_of(&self, building: &Building, members: &[usize]) -> Vec<String> {
        let mut rules: Vec<String> = members
            .iter()
            .filter_map(|m| self.traces.get(&building.members[*m].id)?.decision(Aspect::Body))
            .map(|f| f.rule.clone())
            .collect();
        rules.sort();
        rules.dedup();
        rules
    }

    /// The reasons of each part, in the order of the model.
    pub fn reasons(&self, rules: &RuleBase, model: &Model) -> Vec<Reason> {
        let bodies = model.bodies.iter().map(|b| (&b.id, &b.origin));
        let joints = model.bushings.iter().map(|j| (&j.id, &j.origin));
        let mut reasons = Vec::new();
        for (part, origin) in bodies.chain(joints) {
            for trace in origin.members.iter().filter_map(|subject| self.traces.get(subject)) {
                for firing in trace.standing() {
                    reasons.push(Reason {
                        part: part.clone(),
                        subject: trace.subject.clone(),
                        rule: firing.rule.clone(),
                        action: firing.action.spec().name.to_string(),
                        words: rules.rule(&firing.rule).map(|r| r.words.clone()).unwrap_or_default(),
                        in_range: firing.in_range,
                        confidence: firing.confidence,
                        entries: origin.entries.clone(),
                    });
                }
            }
        }
        reasons
    }
}

/// A decision that this version of the generator cannot carry out.
fn unsupported(subject: &Subject, action: Action) -> GenerateError {
    GenerateError::Unsupported(action.spec().name.to_string(), subject.id.clone())
}
