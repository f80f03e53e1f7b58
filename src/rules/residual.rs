//! What is left of a condition once some features are known.

use super::engine::RuleBase;
use super::logic::{self, Atom, Conjunction};
use super::rule::{Rule, least, most};
use super::value::{Subject, Value};
use super::{Action, Aspect};
use std::collections::{BTreeMap, BTreeSet};

/// What a condition asks of features that are not known yet: names by feature, and numbers from a least to a most one.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Case {
    /// One of these names.
    pub names: BTreeMap<String, BTreeSet<String>>,
    /// The least and the most that each number may be, infinite where it is not bounded. Whether the end itself belongs to it is lost.
    pub ranges: BTreeMap<String, [f64; 2]>,
}

/// A rule that may fire, depending on features that are not known yet.
#[derive(Debug, Clone, PartialEq)]
pub struct Pending<'a> {
    /// Its id.
    pub rule: &'a str,
    /// What it decides.
    pub action: Action,
    /// Parameters of the action.
    pub parameters: &'a BTreeMap<String, Value>,
    /// It fires if one of these is true.
    pub cases: Vec<Case>,
}

/// Why what is left of a rule cannot be told.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum PendingError {
    /// A comparison that cannot be told from numbers and names alone.
    #[error(
        "rule `{rule}` compares `{feature}` with another feature, which cannot be done before both are known: compare it with a number"
    )]
    Unbound {
        /// Id of the rule.
        rule: String,
        /// The feature.
        feature: String,
    },
    /// Too many cases.
    #[error(
        "rule `{rule}` falls into too many cases, with those in which another rule supersedes it: more than {most}; split it into several rules, or take `or` out of conditions", most = logic::TERMS_LIMIT
    )]
    Intricate {
        /// Id of the rule.
        rule: String,
    },
}

impl RuleBase {
    /// The rules about a kind of subject that answer a question and may fire for a subject of which some features will be known (`later`), in the order in which they decide. A rule that needs
    /// any other feature that is not known stays silent, as always. One that others supersede is left with the cases in which none of these fires within its range.
    ///
    /// # Errors
    /// If a rule compares such a feature with another one, or falls into too many cases.
    pub fn pending(
        &self,
        subject: &Subject,
        aspect: Aspect,
        later: &[&str],
    ) -> Result<Vec<Pending<'_>>, PendingError> {
        let about = |r: &&Rule| r.applies_to == subject.kind && r.action.spec().aspect == aspect;
        let mut list = Vec::new();
        for rule in self.rules().iter().filter(about) {
            let cases = self.open_cases(rule, subject, later)?;
            if !cases.is_empty() {
                list.push(Pending {
                    rule: &rule.id,
                    action: rule.action,
                    parameters: &rule.parameters,
                    cases,
                });
            }
        }
        Ok(list)
    }

    /// The cases in which a rule fires and none that supersedes it does so within its range.
    fn open_cases(&self, rule: &Rule, subject: &Subject, later: &[&str]) -> Result<Vec<Case>, PendingError> {
        let intricate = || PendingError::Intricate { rule: rule.id.clone() };
        let mut open = logic::cases(&rule.condition, false).ok_or_else(intricate)?;
        for other in self.rules().iter().filter(|other| other.supersedes.contains(&rule.id)) {
            let own = logic::cases(&other.condition, false)
                .ok_or_else(|| PendingError::Intricate { rule: other.id.clone() })?;
            for taken in cases_of(&other.id, &own, subject, later)? {
                if let Some(taken) = taken.within(other, subject, later) {
                    open = logic::both(&open, &taken.complement()).ok_or_else(intricate)?;
                }
            }
        }
        cases_of(&rule.id, &open, subject, later)
    }
}

/// What is left of each of some conjunctions.
fn cases_of(
    rule: &str,
    conjunctions: &[Conjunction],
    subject: &Subject,
    later: &[&str],
) -> Result<Vec<Case>, PendingError> {
    let cases = conjunctions.iter().map(|own| case(rule, own, subject, later));
    cases.filter_map(Result::transpose).collect()
}

impl Case {
    /// The part of it that lies within the range of a rule; none if nothing does, or if a number of the range will never be known.
    fn within(mut self, rule: &Rule, subject: &Subject, later: &[&str]) -> Option<Self> {
        for (name, [low, high]) in &rule.range {
            let [low, high] = [least(*low), most(*high)];
            match subject.number(name) {
                Some(known) if (low..=high).contains(&known) => {}
                None if later.contains(&name.as_str()) => {
                    let held = self.ranges.entry(name.clone()).or_insert([f64::NEG_INFINITY, f64::INFINITY]);
                    *held = [held[0].max(low), held[1].min(high)];
                    if held[0] > held[1] {
                        return None;
                    }
                }
                _ => return None,
            }
        }
        Some(self)
    }

    /// Statements of which one at least holds where it does not; none if it always holds.
    fn complement(&self) -> Vec<Conjunction> {
        let others = self.names.iter().filter_map(|(name, among)| logic::none_of(name, among));
        let beyond = self.ranges.iter().flat_map(|(name, range)| {
            logic::beyond(name, *range).into_iter().zip(range).filter(|(_, end)| end.is_finite())
        });
        others.chain(beyond.map(|(atom, _)| atom)).map(|atom| vec![atom]).collect()
    }
}

impl RuleBase {
    /// The rules about a kind of subject that may fire for one of which some features are known, whatever the others are.
    pub fn possible(&self, subject: &Subject) -> impl Iterator<Item = &Rule> {
        let about = |r: &&Rule| r.applies_to == subject.kind;
        self.rules().iter().filter(about).filter(|r| !possible_cases(r, subject).is_empty())
    }

    /// Those of them that fire only where a feature has a name.
    pub fn possible_with<'a>(&'a self, subject: &Subject, feature: &str, name: &str) -> Vec<&'a Rule> {
        let asks = |atom: &Atom| matches!(atom, Atom::OneOf(asked, names) if asked == feature && names.iter().eq([name]));
        let only = |r: &&Rule| possible_cases(r, subject).iter().all(|case| case.iter().any(asks));
        self.possible(subject).filter(only).collect()
    }

    /// Features that keep a rule from being asked for a subject, since they are neither known nor among those that will be (`later`): those of its first case that is possible but for them.
    pub fn unknown_to(&self, rule: &Rule, subject: &Subject, later: &[&str]) -> BTreeSet<String> {
        let known = |name: &&String| !subject.features.contains_key(*name) && !later.contains(&name.as_str());
        let first = possible_cases(rule, subject).into_iter().next().unwrap_or_default();
        first.iter().flat_map(Atom::features).filter(known).cloned().collect()
    }
}

/// The cases of a rule's condition that no known feature refutes.
fn possible_cases(rule: &Rule, subject: &Subject) -> Vec<Vec<Atom>> {
    let holds = |atom: &Atom| match atom {
        Atom::OneOf(name, list) => match subject.features.get(name) {
            Some(Value::Name(name)) => list.contains(name),
            Some(known) => list.contains(&known.to_string()),
            None => true,
        },
        Atom::Bound(name, orders, value) => {
            subject.number(name).is_none_or(|known| Atom::admits(*orders, known, *value))
        }
        Atom::Order(a, orders, factor, b) => match (subject.number(a), subject.number(b)) {
            (Some(a), Some(b)) => Atom::admits(*orders, a, factor * b),
            _ => true,
        },
    };
    let cases = logic::cases(&rule.condition, false).unwrap_or_default();
    cases.into_iter().filter(|case| case.iter().all(holds)).collect()
}

/// What is left of statements that hold together; none if one of them is false or asks what nobody will know.
fn case(
    rule: &str,
    conjunction: &[Atom],
    subject: &Subject,
    later: &[&str],
) -> Result<Option<Case>, PendingError> {
    let mut case = Case::default();
    for atom in conjunction {
        let holds = match atom {
            Atom::OneOf(name, list) => match subject.features.get(name) {
                Some(Value::Name(name)) => list.contains(name),
                Some(known) => list.contains(&known.to_string()),
                None if later.contains(&name.as_str()) => {
                    let held = case.names.entry(name.clone()).or_insert_with(|| list.clone());
                    held.retain(|n| list.contains(n));
                    !held.is_empty()
                }
                None => false,
            },
            Atom::Bound(name, orders, value) => match subject.number(name) {
                Some(known) => Atom::admits(*orders, known, *value),
                None if later.contains(&name.as_str()) => {
                    let held = case.ranges.entry(name.clone()).or_insert([f64::NEG_INFINITY, f64::INFINITY]);
                    let [least, most] = Atom::range(*orders, *value);
                    *held = [held[0].max(least), held[1].min(most)];
                    held[0] <= held[1]
                }
                None => false,
            },
            Atom::Order(a, orders, factor, b) => match (subject.number(a), subject.number(b)) {
                (Some(a), Some(b)) => Atom::admits(*orders, a, factor * b),
                _ => match [a, b].into_iter().find(|name| later.contains(&name.as_str())) {
                    Some(feature) => {
                        return Err(PendingError::Unbound { rule: rule.into(), feature: feature.clone() });
                    }
                    None => false,
                },
            },
        };
        if !holds {
            return Ok(None);
        }
    }
    Ok(Some(case))
}
