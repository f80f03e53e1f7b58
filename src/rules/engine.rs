//! The rule base and its evaluation.
//!
//! A condition is true, false, or unknown (a feature it needs is not known: Kleene's logic, so that `x or
//! true` is true without `x`). Rules fire in the order of priority, highest first, then of id; the first that
//! answers a question decides it, unless a rule that fires within its own range supersedes it.

use super::action::{Action, Aspect};
use super::carried;
use super::check::{self, Gap};
use super::expr::{Expr, Operand, Relation, Test};
use super::features;
use super::file;
use super::problem::{Problem, Problems, Source};
use super::rule::{Rule, least, most};
use super::typing;
use super::value::{Subject, SubjectKind, Value};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Rules that were checked together.
#[derive(Debug, Clone)]
pub struct RuleBase {
    /// In the order of evaluation.
    rules: Vec<Rule>,
}

/// A rule that fired for a subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Firing {
    /// Id of the rule.
    pub rule: String,
    /// Id of the subject.
    pub subject: String,
    /// What it decides.
    pub action: Action,
    /// Parameters of the action.
    pub parameters: BTreeMap<String, Value>,
    /// Whether the subject is known to lie within the rule's range of evidence.
    pub in_range: bool,
    /// Features outside that range, in words.
    pub outside: Vec<String>,
    /// Features of the range that are not known of the subject.
    pub missing: Vec<String>,
    /// How sure the rule is, if it was learned from studies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Id of the rule that decides the same question instead; `None` if this one stands.
    pub overruled_by: Option<String>,
}

/// A rule that did not fire for a subject.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Silent {
    /// Id of the rule.
    pub rule: String,
    /// Features it would have needed; empty: its condition is false.
    pub missing: Vec<String>,
}

/// All that the rules said of one subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Trace {
    /// Id of the subject.
    pub subject: String,
    /// Kind of the subject.
    pub kind: SubjectKind,
    /// Rules that fired, in the order of evaluation.
    pub firings: Vec<Firing>,
    /// Questions that must have an answer and have none.
    pub undecided: Vec<Aspect>,
}

impl Trace {
    /// The firing that decides a question.
    pub fn decision(&self, aspect: Aspect) -> Option<&Firing> {
        self.firings.iter().find(|f| f.action.spec().aspect == aspect && f.overruled_by.is_none())
    }

    /// The firings that count: those that decide, and those that say the same within their range of evidence.
    pub fn standing(&self) -> impl Iterator<Item = &Firing> {
        let decides = |f: &Firing| self.decision(f.action.spec().aspect).is_some_and(|d| d.rule == f.rule);
        self.firings.iter().filter(move |f| f.overruled_by.is_none() && (f.in_range || decides(f)))
    }
}

/// A subject that does not fit the catalogue of features.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("subject `{subject}`: {what}")]
pub struct SubjectError {
    /// Id of the subject.
    pub subject: String,
    /// What is wrong.
    pub what: String,
}

impl RuleBase {
    /// Reads all `*.toml` below a folder (hidden ones aside), in order of their paths.
    ///
    /// # Errors
    /// All problems found in and between the files.
    pub fn load(folder: &Path) -> Result<Self, Problems> {
        Self::from_sources(Self::sources(folder)?)
    }

    /// The texts of all `*.toml` below a folder.
    ///
    /// # Errors
    /// If one cannot be read.
    pub fn sources(folder: &Path) -> Result<Vec<Source>, Problems> {
        let mut paths = Vec::new();
        let mut sources = Vec::new();
        let io = |path: &Path, error: std::io::Error| {
            let message = format!("{}: {error}", path.display());
            Problems(vec![Problem { place: None, message, is_unread: true }])
        };
        collect(folder, &mut paths).map_err(|(path, error)| io(&path, error))?;
        paths.sort();
        for path in paths {
            let text = fs::read_to_string(&path).map_err(|error| io(&path, error))?;
            sources.push(Source { name: path.display().to_string(), text });
        }
        Ok(sources)
    }

    /// These rules without those whose ids begin with a text.
    #[must_use]
    pub fn without(&self, prefix: &str) -> Self {
        Self { rules: self.rules.iter().filter(|rule| !rule.id.starts_with(prefix)).cloned().collect() }
    }

    /// The seed rules that come with the program (`rules/seed/`).
    ///
    /// # Errors
    /// None in a released program: the files are tested.
    pub fn seed() -> Result<Self, Problems> {
        let source =
            |name: &str, text: &str| Source { name: format!("rules/seed/{name}"), text: text.to_string() };
        Self::from_sources(vec![
            source("bodies.toml", include_str!("../../rules/seed/bodies.toml")),
            source("events.toml", include_str!("../../rules/seed/events.toml")),
            source("hinges.toml", include_str!("../../rules/seed/hinges.toml")),
            source("lines.toml", include_str!("../../rules/seed/lines.toml")),
            source("springs.toml", include_str!("../../rules/seed/springs.toml")),
        ])
    }

    /// Reads rules from texts.
    ///
    /// # Errors
    /// All problems found in and between the texts.
    pub fn from_sources(sources: Vec<Source>) -> Result<Self, Problems> {
        Self { rules: Vec::new() }.with(sources)
    }

    /// These rules and those of further texts.
    ///
    /// # Errors
    /// As [`RuleBase::from_sources`].
    pub fn with(&self, sources: Vec<Source>) -> Result<Self, Problems> {
        let mut problems = Vec::new();
        let mut rules = self.rules.clone();
        let mut faulty = BTreeSet::new();
        rules.extend(sources.into_iter().flat_map(|source| file::read(source, &mut problems, &mut faulty)));
        problems.extend(check::problems(&rules, &faulty));
        if !problems.is_empty() {
            return Err(Problems(problems));
        }
        rules.sort_by(|a, b| b.priority.cmp(&a.priority).then_with(|| a.id.cmp(&b.id)));
        Ok(Self { rules })
    }

    /// Those of these rules whose ids begin with a word.
    pub fn only(&self, prefix: &str) -> Self {
        Self { rules: self.rules.iter().filter(|rule| rule.id.starts_with(prefix)).cloned().collect() }
    }

    /// The rules in the order of evaluation.
    pub fn rules(&self) -> &[Rule] {
        &self.rules
    }

    /// The rule with this id.
    pub fn rule(&self, id: &str) -> Option<&Rule> {
        self.rules.iter().find(|rule| rule.id == id)
    }

    /// Comparisons in conditions that always or never hold.
    pub fn remarks(&self) -> Vec<Problem> {
        check::remarks(&self.rules)
    }

    /// Rules that may decide what no generated model carries out.
    pub fn not_carried_out(&self) -> Vec<Problem> {
        carried::problems(&self.rules)
    }

    /// Cases in which no rule decides.
    pub fn gaps(&self) -> Vec<Gap> {
        check::gaps(&self.rules)
    }

    /// The rules that fire for a subject, in the order of evaluation.
    ///
    /// # Errors
    /// If the subject has a feature that its kind does not have, or a value of the wrong type.
    pub fn evaluate(&self, subject: &Subject) -> Result<Vec<Firing>, SubjectError> {
        self.trace(subject).map(|trace| trace.firings)
    }

    /// The rules about this kind of subject that do not fire for it, and what is not known that they ask for.
    pub fn silent(&self, subject: &Subject) -> Vec<Silent> {
        let about = self.rules.iter().filter(|rule| rule.applies_to == subject.kind);
        let silent = |rule: &Rule| match holds(&rule.condition, subject) {
            Some(true) => None,
            Some(false) => Some(Silent { rule: rule.id.clone(), missing: Vec::new() }),
            None => Some(Silent { rule: rule.id.clone(), missing: missing(rule, subject) }),
        };
        about.filter_map(silent).collect()
    }

    /// As [`RuleBase::evaluate`], with what stays undecided.
    ///
    /// # Errors
    /// As [`RuleBase::evaluate`].
    pub fn trace(&self, subject: &Subject) -> Result<Trace, SubjectError> {
        check_subject(subject)?;
        let mut trace = Trace {
            subject: subject.id.clone(),
            kind: subject.kind,
            firings: Vec::new(),
            undecided: Vec::new(),
        };
        for rule in self.rules.iter().filter(|rule| rule.applies_to == subject.kind) {
            if holds(&rule.condition, subject) == Some(true) {
                trace.firings.push(firing(rule, subject));
            }
        }
        self.overrule(&mut trace.firings);
        trace.undecided =
            Aspect::required(subject.kind).iter().copied().filter(|a| trace.decision(*a).is_none()).collect();
        Ok(trace)
    }

    /// Says of each firing which other decides its question, if another does.
    fn overrule(&self, firings: &mut [Firing]) {
        let superseded: BTreeMap<String, String> = firings
            .iter()
            .filter(|f| f.in_range)
            .filter_map(|f| self.rule(&f.rule))
            .flat_map(|rule| rule.supersedes.iter().map(|id| (id.clone(), rule.id.clone())))
            .collect();
        let mut deciding: BTreeMap<Aspect, Firing> = BTreeMap::new();
        for firing in firings.iter_mut() {
            let aspect = firing.action.spec().aspect;
            firing.overruled_by = superseded.get(&firing.rule).cloned();
            if firing.overruled_by.is_some() {
                continue;
            }
            match deciding.get(&aspect) {
                None => {
                    deciding.insert(aspect, firing.clone());
                }
                Some(first) if first.action == firing.action && first.parameters == firing.parameters => {}
                Some(first) => firing.overruled_by = Some(first.rule.clone()),
            }
        }
    }
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) -> Result<(), (PathBuf, std::io::Error)> {
    let failed = |error| (folder.to_path_buf(), error);
    for item in fs::read_dir(folder).map_err(failed)? {
        let item = item.map_err(failed)?;
        let path = item.path();
        if item.file_name().to_string_lossy().starts_with('.') {
            continue;
        }
        if path.is_dir() {
            collect(&path, paths)?;
        } else if path.extension().is_some_and(|e| e == "toml") {
            paths.push(path);
        }
    }
    Ok(())
}

fn check_subject(subject: &Subject) -> Result<(), SubjectError> {
    let wrong = |what: String| SubjectError { subject: subject.id.clone(), what };
    for (name, value) in &subject.features {
        let feature = typing::lookup(name, subject.kind).map_err(wrong)?;
        if !feature.admits(value) {
            return Err(wrong(format!("`{name}` is {}, not {value}", feature.type_words())));
        }
    }
    Ok(())
}

/// Whether a condition holds; `None`: not known.
fn holds(expr: &Expr, subject: &Subject) -> Option<bool> {
    match expr {
        Expr::Always => Some(true),
        Expr::Not(a) => holds(a, subject).map(|held| !held),
        Expr::And(a, b) => match (holds(a, subject), holds(b, subject)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (Some(true), Some(true)) => Some(true),
            _ => None,
        },
        Expr::Or(a, b) => match (holds(a, subject), holds(b, subject)) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (Some(false), Some(false)) => Some(false),
            _ => None,
        },
        Expr::Test(test) => compare(test, subject),
    }
}

/// Whether the feature stands in the relation to any of the operands.
fn compare(test: &Test, subject: &Subject) -> Option<bool> {
    let value = subject.features.get(&test.feature.0)?;
    let mut unknown = false;
    for (operand, _) in &test.operands {
        let other = match operand {
            Operand::Literal(literal) => Some(literal.clone()),
            Operand::Feature(factor, name) => match subject.features.get(name) {
                Some(Value::Number(x)) => Some(Value::Number(factor * x)),
                _ => None,
            },
        };
        match other.map(|other| related(value, test.relation, &other)) {
            Some(true) => return Some(true),
            Some(false) => {}
            None => unknown = true,
        }
    }
    (!unknown).then_some(false)
}

fn related(value: &Value, relation: Relation, other: &Value) -> bool {
    match (value, other) {
        (Value::Number(a), Value::Number(b)) => match relation {
            Relation::Equal => a == b,
            Relation::Less => a < b,
            Relation::AtMost => a <= b,
            Relation::Greater => a > b,
            Relation::AtLeast => a >= b,
        },
        _ => relation == Relation::Equal && value == other,
    }
}

/// The features that a rule's condition names and the subject does not have, sorted.
fn missing(rule: &Rule, subject: &Subject) -> Vec<String> {
    let mut names = BTreeSet::new();
    typing::visit(&rule.condition, &mut |test: &Test| {
        names.insert(test.feature.0.as_str());
        names.extend(test.operands.iter().filter_map(|(operand, _)| match operand {
            Operand::Feature(_, name) => Some(name.as_str()),
            Operand::Literal(_) => None,
        }));
    });
    names.into_iter().filter(|name| !subject.features.contains_key(*name)).map(str::to_string).collect()
}

fn firing(rule: &Rule, subject: &Subject) -> Firing {
    let (mut outside, mut missing) = (Vec::new(), Vec::new());
    for (name, [low, high]) in &rule.range {
        match subject.features.get(name) {
            Some(Value::Number(x)) if (least(*low)..=most(*high)).contains(x) => {}
            Some(value) => {
                let value = match value {
                    Value::Number(x) => ((1e6 * x).round() / 1e6).to_string(),
                    other => other.to_string(),
                };
                let unit = match features::find(name).map(|f| f.kind) {
                    Some(features::FeatureType::Number { unit }) if !["1", "count"].contains(&unit) => {
                        format!(" {unit}")
                    }
                    _ => String::new(),
                };
                outside.push(format!("{name} is {value}{unit}, evidence from {low} to {high}{unit}"));
            }
            None => missing.push(name.clone()),
        }
    }
    Firing {
        rule: rule.id.clone(),
        subject: subject.id.clone(),
        action: rule.action,
        parameters: rule.parameters.clone(),
        in_range: outside.is_empty() && missing.is_empty(),
        outside,
        missing,
        confidence: rule.statistics.as_ref().map(|s| s.confidence),
        overruled_by: None,
    }
}
