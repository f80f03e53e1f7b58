//! Rules learned from studies: what FE runs show at the places of buildings, against what was known of these places before any run.
//!
//! The features are those that the generator asks its rules about (`generate::known`): what is learned of a place here is found there again. The answers
//! are facts of the records; nothing of the motion that a generated model is later compared with is fitted, but for the one question whether floors move as rigid bodies.
//!
//! | file | owns |
//! |---|---|
//! | this one | studies with the features of their buildings; all questions, one after the other |
//! | [`ablation`] | sets of rules that are compared with each other |
//! | [`questions`] | what is asked, what the record answers, what a rule then decides; what mechanics asks for |
//! | [`tree`] | a decision tree with costs |
//! | [`prune`] | how far it is cut back, and what it is worth in other buildings |
//! | `draft` | rules out of the leaves of a tree, and their text |
//! | [`rate`] | the strain rate that tells ends that turn |
//! | `report` | what was learned, and what was not, in words |

pub mod ablation;
mod draft;
pub mod prune;
pub mod questions;
pub mod rate;
mod report;
pub mod tree;

use crate::building::lines::{Line, lines};
use crate::building::partition::Partition;
use crate::building::{Building, MemberKind};
use crate::generate::known::Known;
use crate::rules::features::{self, FeatureType};
use crate::rules::{Problems, RuleBase, Source, Subject, Value};
use crate::study::Study;
use crate::study::floors::{FloorMotion, floors};
use draft::Draft;
use prune::{Validated, validated};
use questions::{ANY_PHASE, EXPECTED, QUESTIONS, Question};
use rayon::prelude::*;
use std::collections::BTreeMap;
use tree::{Column, Kind, RULE_BUILDINGS, Row, Table, YES_BUILDINGS};

/// A study with what was known of its building before.
#[derive(Debug, Clone)]
pub struct Case {
    /// The record.
    pub study: Study,
    /// Features of the building's members and ends.
    pub known: Known,
    /// Lines of slabs and walls, in the order of their features.
    pub lines: Vec<Line>,
    /// Axes of its beams, by their ids.
    beams: BTreeMap<String, usize>,
    /// How its floors moved.
    pub floors: Vec<FloorMotion>,
}

impl Case {
    /// Of a record and the building that it is of.
    pub fn of(study: Study, building: &Building) -> Self {
        let beams = building.members.iter().filter(|m| m.kind == MemberKind::Beam);
        Self {
            known: Known::of_building(building),
            lines: lines(building, &Partition::of(building)),
            beams: beams.map(|m| (m.id.clone(), m.axis)).collect(),
            floors: floors(&study, building),
            study,
        }
    }

    /// Axis of a beam; none of another member.
    pub fn axis_of_beam(&self, member: &str) -> Option<usize> {
        self.beams.get(member).copied()
    }
}

/// Least confidence of a rule that is used. What costs of misses and false alarms make of a leaf is a place worth a look; a rule that is wrong more often than right is no evidence to decide by.
const LEAST_CONFIDENCE: f64 = 0.5;
const DOUBTFUL: &str = "it says yes because a miss costs more than a false alarm, and is wrong more often than right: places to look at, no rule to decide by";

/// Text files, by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Learned {
    /// Rule files (`*.toml`), the review list and the report.
    pub files: Vec<(String, String)>,
}

/// Names of all files that learning may write.
pub fn file_names() -> Vec<String> {
    let rules = QUESTIONS.iter().map(|q| format!("{}.toml", q.name));
    rules.chain([REVIEW.to_string(), REPORT.to_string()]).collect()
}

/// Name of the file with rules that are not used.
pub const REVIEW: &str = "review.md";
/// Name of the file with what was learned from what.
pub const REPORT: &str = "report.md";

/// What came of a question.
struct Found {
    question: &'static Question,
    table: Table,
    validated: Option<Validated>,
    /// Rules that are used.
    used: Vec<Draft>,
    /// Rules that are not, with the reason.
    review: Vec<(Draft, String)>,
    /// Why there are no rules, if there are none.
    silent: Option<String>,
}

/// Learns from studies, beside rules that stay in place where there are too few.
///
/// # Errors
/// If what was learned does not fit the rules in place (they have changed, and what is learned names them).
pub fn learn(cases: &[Case], held: &RuleBase) -> Result<Learned, Problems> {
    let found: Vec<Found> = QUESTIONS.par_iter().map(|question| answer(question, cases, held)).collect();
    let mut files: Vec<(String, String)> = found
        .iter()
        .filter(|f| !f.used.is_empty())
        .map(|f| (format!("{}.toml", f.question.name), draft::file(f.question, &f.used)))
        .collect();
    let sources = files.iter().map(|(name, text)| Source { name: name.clone(), text: text.clone() });
    held.with(sources.collect())?;
    files.push((REVIEW.to_string(), report::review(&found)));
    files.push((REPORT.to_string(), report::report(&found, cases)));
    Ok(Learned { files })
}

fn answer(question: &'static Question, cases: &[Case], held: &RuleBase) -> Found {
    let table = table(question, cases, held);
    let mut found =
        Found { question, table, validated: None, used: Vec::new(), review: Vec::new(), silent: None };
    let buildings = found.table.buildings().len();
    if buildings < RULE_BUILDINGS {
        found.silent = Some(format!("{buildings} buildings have such places; a rule needs {RULE_BUILDINGS}"));
        return found;
    }
    let validated = validated(&found.table);
    let worse = validated.cost() > validated.held_cost() + 1e-9;
    let why = format!(
        "in buildings not learned from, the rules of this question cost {:.3} a building, those in place {:.3}",
        validated.cost(),
        validated.held_cost()
    );
    let drafts = draft::drafts(question, &found.table, &validated.tree, cases);
    for draft in drafts {
        let doubtful = draft.statistics.confidence < LEAST_CONFIDENCE;
        match draft.refused {
            Some(reason) => found.review.push((draft, reason.to_string())),
            None if worse => found.review.push((draft, why.clone())),
            None if doubtful => found.review.push((draft, DOUBTFUL.to_string())),
            None => found.used.push(draft),
        }
    }
    let against = draft::refused(question, &found.table, &validated, cases);
    found.review.extend(against);
    if found.used.is_empty() && found.review.is_empty() {
        found.silent = Some(format!(
            "no branch has {RULE_BUILDINGS} buildings, and {YES_BUILDINGS} with a yes if it says yes"
        ));
    }
    found.validated = Some(validated);
    found
}

/// The places of a question with their features.
fn table(question: &Question, cases: &[Case], held: &RuleBase) -> Table {
    let columns: Vec<Column> =
        question.features.iter().flat_map(|name| columns(name, question.turned_round)).collect();
    let mut rows = Vec::new();
    for (building, case) in cases.iter().enumerate() {
        for (subject, yes) in (question.places)(case) {
            let mut subject = subject.clone();
            if question.phase != ANY_PHASE {
                subject = subject.with("collapse.phase", question.phase);
            }
            rows.push(Row {
                building,
                values: columns.iter().map(|column| value(&subject, column)).collect(),
                yes,
                held: says_yes(question, held, &subject),
                place: subject.id,
            });
        }
    }
    Table { columns, rows }
}

/// Whether the rules in place decide as a yes does.
fn says_yes(question: &Question, held: &RuleBase, subject: &Subject) -> bool {
    let action = crate::rules::action::find(question.yes.action);
    let decided = |spec: &crate::rules::action::ActionSpec| {
        let trace = held.trace(subject).ok()?;
        trace.decision(spec.aspect).map(|firing| firing.action == spec.action)
    };
    action.and_then(decided).unwrap_or(false)
}

/// The columns of a feature: one, or one a name.
fn columns(name: &'static str, turned_round: bool) -> Vec<Column> {
    let more = EXPECTED.iter().find(|(known, _)| *known == name).map(|(_, more)| *more != turned_round);
    let of = |kind: Kind| Column { feature: name, kind, more };
    match features::find(name).map(|f| f.kind) {
        Some(FeatureType::Number { .. }) => vec![of(Kind::Number)],
        Some(FeatureType::Flag) => vec![of(Kind::Flag)],
        Some(FeatureType::Names(names)) => names.iter().map(|name| of(Kind::Is(name))).collect(),
        None => Vec::new(),
    }
}

fn value(subject: &Subject, column: &Column) -> Option<f64> {
    let of = |is: bool| f64::from(u8::from(is));
    match (subject.features.get(column.feature)?, column.kind) {
        (Value::Number(x), Kind::Number) => Some(rounded(*x)),
        (Value::Flag(flag), Kind::Flag) => Some(of(*flag)),
        (Value::Name(name), Kind::Is(wanted)) => Some(of(name == wanted)),
        _ => None,
    }
}

/// To six digits: what the last bits of an elastic solution are is no evidence.
fn rounded(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x) + 0.0
}

impl Question {
    /// The condition that all its rules have.
    fn common(&self) -> String {
        if self.phase == ANY_PHASE {
            return self.condition.to_string();
        }
        format!("collapse.phase == '{}' and {}", self.phase, self.condition)
    }

    fn answer(&self, yes: bool) -> &questions::Answer {
        if yes { &self.yes } else { &self.no }
    }
}
