//! Checks across rules: double ids, what a rule supersedes, conflicts, gaps, rules that cannot fire.

use super::action::Aspect;
use super::features::{self, MEMBER_KINDS};
use super::logic::{self, Atom, Conjunction};
use super::problem::Problem;
use super::residual::PendingError;
use super::rule::{Rule, least, most};
use super::typing;
use super::value::SubjectKind;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet, VecDeque};

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

/// All problems between the rules, in order of the rules; `faulty` are ids of further rules, which have errors of their own.
pub fn problems(rules: &[Rule], faulty: &BTreeSet<String>) -> Vec<Problem> {
    let mut found = doubles(rules);
    found.extend(superseding(rules, faulty));
    found.extend(never(rules));
    found.extend(intricate(rules));
    found.extend(conflicts(rules));
    found
}

/// A problem of a rule.
pub(super) fn at(rule: &Rule, message: String) -> Problem {
    Problem { place: Some(rule.place.clone()), message, is_unread: false }
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

fn superseding(rules: &[Rule], faulty: &BTreeSet<String>) -> Vec<Problem> {
    let by_id: BTreeMap<&str, &Rule> = rules.iter().map(|r| (r.id.as_str(), r)).collect();
    let mut found = Vec::new();
    let mut in_cycle = BTreeSet::new();
    for rule in rules {
        for id in &rule.supersedes {
            let what = match by_id.get(id.as_str()) {
                None if faulty.contains(id) => "which has an error of its own",
                None => "which does not exist",
                Some(other) if decide_apart(other, rule) => "which decides something else",
                Some(_) => continue,
            };
            found.push(at(rule, format!("`{}` supersedes `{id}`, {what}", rule.id)));
        }
        // a cycle is told once, at its first rule
        if let Some(path) = cycle(rule, &by_id).filter(|_| !in_cycle.contains(rule.id.as_str())) {
            let words: Vec<String> = path.iter().map(|id| format!("`{id}`")).collect();
            let through =
                if path.len() > 1 { format!(" through {}", words[1..].join(", ")) } else { String::new() };
            found.push(at(rule, format!("`{}` supersedes itself{through}: take one of these out", rule.id)));
            in_cycle.extend(path);
        }
    }
    found
}

/// Whether rules answer different questions.
fn decide_apart(a: &Rule, b: &Rule) -> bool {
    a.applies_to != b.applies_to || a.action.spec().aspect != b.action.spec().aspect
}

/// The shortest way from a rule through what it supersedes back to itself: the ids of the rules on it, this one first.
fn cycle<'a>(rule: &'a Rule, by_id: &BTreeMap<&str, &'a Rule>) -> Option<Vec<&'a str>> {
    let mut open = VecDeque::from([vec![rule.id.as_str()]]);
    let mut seen = BTreeSet::new();
    while let Some(path) = open.pop_front() {
        for id in path.last().and_then(|id| by_id.get(id)).into_iter().flat_map(|r| &r.supersedes) {
            if *id == rule.id {
                return Some(path);
            }
            if seen.insert(id.as_str()) {
                open.push_back([&path[..], &[id.as_str()]].concat());
            }
        }
    }
    None
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

/// Rules about events whose conditions have too many cases to be put into a model.
fn intricate(rules: &[Rule]) -> Vec<Problem> {
    let events = [SubjectKind::ContactEvent, SubjectKind::FractureEvent];
    let asked = rules.iter().filter(|r| events.contains(&r.applies_to));
    let found = asked.filter(|r| logic::cases(&r.condition, false).is_none());
    found.map(|r| at(r, PendingError::Intricate { rule: r.id.clone() }.to_string())).collect()
}

/// Whether a case asks for members of kinds that have no such subjects.
fn is_of_other_kind(case: &Conjunction, subject: SubjectKind) -> bool {
    let kinds = member_kinds(subject);
    let none = |names: &BTreeSet<String>| !names.iter().any(|n| kinds.contains(&n.as_str()));
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

/// Whether two rules answer the same question differently with the same priority.
fn contradict(a: &Rule, b: &Rule) -> bool {
    a.id != b.id
        && a.applies_to == b.applies_to
        && a.priority == b.priority
        && a.action.spec().aspect == b.action.spec().aspect
        && (a.action != b.action || a.parameters != b.parameters)
}

/// The rule of two that supersedes the other one, which it does within its range only.
fn superseder<'a>(a: &'a Rule, b: &'a Rule) -> Option<&'a Rule> {
    [(a, b), (b, a)].into_iter().find(|(rule, other)| rule.supersedes.contains(&other.id)).map(|pair| pair.0)
}

/// One of the cases in which a rule may be outside its range, in words.
fn outside(rule: &Rule, cases: &[Conjunction]) -> Option<String> {
    cases.iter().find_map(|case| {
        rule.range.iter().find_map(|(name, [low, high])| {
            let told = logic::beyond(name, [*low, *high]);
            let meant = logic::beyond(name, [least(*low), most(*high)]);
            let with = |atom: &Atom| [&case[..], std::slice::from_ref(atom)].concat();
            let beyond = meant.iter().zip(&told).find(|(atom, _)| logic::possible(&with(atom)));
            // what no comparison of the case asks for may be unknown, and then the rule is not within its range
            let is_asked = case.iter().any(|atom| atom.features().any(|asked| asked == name));
            match beyond {
                Some((_, atom)) => Some(logic::words(&with(atom))),
                None if !is_asked => Some(format!("{} and {name} is not known", logic::words(case))),
                None => None,
            }
        })
    })
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
            let above = superseder(a, b);
            let case = match (&shared, above) {
                (Some(shared), None) => shared.first().map(|case| logic::words(case)),
                (Some(shared), Some(rule)) => outside(rule, shared),
                (None, Some(rule)) if rule.range.is_empty() => None,
                (None, _) => {
                    Some("their conditions, which are too intricate to tell apart, hold".to_string())
                }
            };
            let Some(case) = case else { continue };
            let remedy = above.map(|rule| {
                format!("; `{}` supersedes the other one within its range only: give it a higher priority, or bounds in `when`", rule.id)
            });
            found.push(at(
                b,
                format!(
                    "conflict: `{}` ({}) and `{}` ({}, {}) both have priority {} and say differently {} when {case}{}",
                    b.id, b.action.spec().name, a.id, a.action.spec().name, a.place.short(), b.priority,
                    b.action.spec().aspect.question(), remedy.unwrap_or_default()
                ),
            ));
        }
    }
    found
}

/// The member kinds that a subject can belong to.
pub(super) fn member_kinds(subject: SubjectKind) -> &'static [&'static str] {
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
