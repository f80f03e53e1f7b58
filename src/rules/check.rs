//! Checks across rules: double ids, what a rule supersedes, conflicts, gaps, rules that cannot fire.

use super::action::Aspect;
use super::features::{self, MEMBER_KINDS};
use super::logic::{self, Atom, Conjunction};
use super::problem::Problem;
use super::rule::Rule;
use super::typing;
use super::value::SubjectKind;
use serde::Serialize;
use std::collections::BTreeMap;

/// Subjects for which a question may stay without an answer.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Gap {
    /// Kind of the subject.
    pub subject: SubjectKind,
    /// Kind of the member.
    pub member: String,
    /// The question.
    pub aspect: Aspect,
    /// The case without an answer, as a condition.
    pub case: String,
}

impl std::fmt::Display for Gap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "gap: no rule says {} for a {} of a {} when {}",
            self.aspect.question(),
            self.subject,
            self.member,
            self.case
        )
    }
}

/// All problems between the rules, in order of the rules.
pub fn problems(rules: &[Rule]) -> Vec<Problem> {
    let mut found = doubles(rules);
    found.extend(superseding(rules));
    found.extend(never(rules));
    found.extend(conflicts(rules));
    found
}

fn at(rule: &Rule, message: String) -> Problem {
    Problem { place: Some(rule.place.clone()), message }
}

fn doubles(rules: &[Rule]) -> Vec<Problem> {
    let mut first: BTreeMap<&str, &Rule> = BTreeMap::new();
    let mut found = Vec::new();
    for rule in rules {
        match first.get(rule.id.as_str()) {
            Some(held) => found.push(at(
                rule,
                format!("the id `{}` is taken by the rule in {}", rule.id, held.place.short()),
            )),
            None => {
                first.insert(&rule.id, rule);
            }
        }
    }
    found
}

fn superseding(rules: &[Rule]) -> Vec<Problem> {
    let by_id: BTreeMap<&str, &Rule> = rules.iter().map(|r| (r.id.as_str(), r)).collect();
    let mut found = Vec::new();
    for rule in rules {
        for id in &rule.supersedes {
            match by_id.get(id.as_str()) {
                None => {
                    found.push(at(rule, format!("`{}` supersedes `{id}`, which does not exist", rule.id)))
                }
                Some(other)
                    if other.applies_to != rule.applies_to
                        || other.action.spec().aspect != rule.action.spec().aspect =>
                {
                    found.push(at(
                        rule,
                        format!("`{}` supersedes `{id}`, which decides something else", rule.id),
                    ));
                }
                Some(_) => {}
            }
        }
        if reaches(rule, rule, &by_id) {
            found.push(at(rule, format!("`{}` supersedes itself, directly or through others", rule.id)));
        }
    }
    found
}

/// Whether `goal` is superseded by `start` or by what it supersedes.
fn reaches(start: &Rule, goal: &Rule, by_id: &BTreeMap<&str, &Rule>) -> bool {
    let mut open: Vec<&str> = start.supersedes.iter().map(String::as_str).collect();
    let mut seen = std::collections::BTreeSet::new();
    while let Some(id) = open.pop() {
        if id == goal.id {
            return true;
        }
        if let Some(rule) = by_id.get(id).filter(|_| seen.insert(id)) {
            open.extend(rule.supersedes.iter().map(String::as_str));
        }
    }
    false
}

fn never(rules: &[Rule]) -> Vec<Problem> {
    let mut found = Vec::new();
    for rule in rules {
        let Some(cases) = logic::cases(&rule.condition, false) else { continue };
        if cases.is_empty() {
            let decided = decided(rule).into_iter().find(|(_, holds)| !holds);
            let why = decided.map(|(words, _)| format!("; {words}")).unwrap_or_default();
            found.push(at(rule, format!("the condition of `{}` can never hold{why}", rule.id)));
        } else if cases.iter().all(|case| is_of_other_kind(case, rule.applies_to)) {
            let kinds = member_kinds(rule.applies_to).join(" or a ");
            let (id, subject) = (&rule.id, rule.applies_to);
            found.push(at(
                rule,
                format!("the condition of `{id}` can never hold; a {subject} belongs to a {kinds}"),
            ));
        }
    }
    found
}

/// Whether a case asks for members of kinds that have no such subjects.
fn is_of_other_kind(case: &Conjunction, subject: SubjectKind) -> bool {
    let kinds = member_kinds(subject);
    let none =
        |names: &std::collections::BTreeSet<String>| !names.iter().any(|n| kinds.contains(&n.as_str()));
    case.iter().any(|atom| matches!(atom, Atom::OneOf(name, names) if name == "member.kind" && none(names)))
}

/// Comparisons that the range of their feature decides, which their author has hardly meant.
pub fn remarks(rules: &[Rule]) -> Vec<Problem> {
    let of = |rule| decided(rule).into_iter().map(move |(words, _)| at(rule, words));
    rules.iter().flat_map(of).collect()
}

/// The comparisons of a rule that the range of their feature decides, in words, and whether they hold.
fn decided(rule: &Rule) -> Vec<(String, bool)> {
    let mut found = Vec::new();
    typing::visit(&rule.condition, &mut |test| {
        let feature = &test.feature.0;
        let range = features::find(feature).map(|f| f.range_words()).unwrap_or_default();
        for (comparison, holds) in logic::decided(test) {
            let always = if holds { "holds wherever it is known" } else { "never holds" };
            let words =
                format!("the comparison `{comparison}` of `{}` {always}: `{feature}` is {range}", rule.id);
            found.push((words, holds));
        }
    });
    found
}

/// Whether two rules answer the same question differently with the same right.
fn contradict(a: &Rule, b: &Rule) -> bool {
    a.id != b.id
        && a.applies_to == b.applies_to
        && a.priority == b.priority
        && a.action.spec().aspect == b.action.spec().aspect
        && (a.action != b.action || a.parameters != b.parameters)
        && !a.supersedes.contains(&b.id)
        && !b.supersedes.contains(&a.id)
}

fn conflicts(rules: &[Rule]) -> Vec<Problem> {
    let cases: Vec<Option<Vec<Conjunction>>> =
        rules.iter().map(|r| logic::cases(&r.condition, false)).collect();
    let mut found = Vec::new();
    for (j, b) in rules.iter().enumerate() {
        for (i, a) in rules.iter().enumerate().take(j).filter(|(_, a)| contradict(a, b)) {
            let shared = match (&cases[i], &cases[j]) {
                (Some(x), Some(y)) => logic::both(x, y),
                _ => None,
            };
            let case = match &shared {
                Some(shared) => match shared.first() {
                    Some(case) => logic::words(case),
                    None => continue,
                },
                None => "their conditions, which are too intricate to tell apart, hold".to_string(),
            };
            found.push(at(
                b,
                format!(
                    "conflict: `{}` ({}) and `{}` ({}, {}) both have priority {} and say differently {} when {case}",
                    b.id, b.action.spec().name, a.id, a.action.spec().name, a.place.short(), b.priority,
                    b.action.spec().aspect.question()
                ),
            ));
        }
    }
    found
}

/// The member kinds that a subject can belong to.
fn member_kinds(subject: SubjectKind) -> &'static [&'static str] {
    match subject {
        SubjectKind::MemberEnd => &["column", "beam"],
        SubjectKind::Section => &["column", "beam", "slab", "wall"],
        SubjectKind::SlabLine => &["slab"],
        SubjectKind::WallEnd => &["wall"],
        _ => MEMBER_KINDS,
    }
}

/// For each kind of subject and member and each question that must be answered: a case in which no rule
/// answers, taking all features as known.
pub fn gaps(rules: &[Rule]) -> Vec<Gap> {
    let mut found = Vec::new();
    for subject in SubjectKind::ALL {
        for aspect in Aspect::required(subject) {
            let deciding: Vec<&Rule> = rules
                .iter()
                .filter(|r| r.applies_to == subject && r.action.spec().aspect == *aspect)
                .collect();
            for member in member_kinds(subject) {
                let start = Atom::OneOf("member.kind".to_string(), [member.to_string()].into());
                let Some(case) = uncovered(vec![vec![start.clone()]], &deciding) else { continue };
                let rest: Conjunction = case.into_iter().filter(|atom| !implied(atom, member)).collect();
                let case = logic::words(&rest);
                found.push(Gap { subject, member: member.to_string(), aspect: *aspect, case });
            }
        }
    }
    found
}

/// Whether a statement says only that the member is of a kind that it is.
fn implied(atom: &Atom, member: &str) -> bool {
    matches!(atom, Atom::OneOf(name, values) if name == "member.kind" && values.contains(member))
}

/// A case in which none of the rules holds.
fn uncovered(mut open: Vec<Conjunction>, rules: &[&Rule]) -> Option<Conjunction> {
    for rule in rules {
        let next = logic::cases(&rule.condition, true).and_then(|rest| logic::both(&open, &rest));
        // Too many cases: this rule is taken as silent, which can only report a gap too many.
        open = next.unwrap_or(open);
    }
    open.into_iter().next()
}
