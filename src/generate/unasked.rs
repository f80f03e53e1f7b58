//! Rules about events that are not asked, so that nobody takes them for obeyed.
//!
//! After the first contact only columns are divided further ([`super::sections`]) and beams break away from their slabs ([`super::webs`]), and only what happens to these is asked about while the model runs ([`super::event_rules`]). Whatever else
//! the rules say of that time has no effect; it is named here, as far as it may fire in the building.

use super::decide::Decision;
use super::event_rules::{self, LATER};
use super::known::Known;
use super::{Accuracy, GenerateError, StaysWhole};
use crate::building::{Building, MemberKind};
use crate::rules::features::MEMBER_KINDS;
use crate::rules::{Action, Rule, RuleBase, Subject, SubjectKind, Value};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Rules that are not asked for some members.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unasked {
    /// Their ids.
    pub rules: Vec<String>,
    /// What they are about, e.g. "the time after the first contact".
    pub events: String,
    /// Of which members, e.g. "ends of beams".
    pub about: String,
    /// Why they are not asked.
    pub why: String,
    /// Ids of these members.
    pub members: Vec<String>,
}

impl Unasked {
    /// In a sentence.
    pub fn words(&self) -> String {
        let is = if self.rules.len() == 1 { "rule" } else { "rules" };
        let are = if self.rules.len() == 1 { "is" } else { "are" };
        let rules = self.rules.join(", ");
        format!(
            "{is} {rules} {are} about {} and {are} not asked for {}: {}",
            self.events, self.about, self.why
        )
    }
}

/// What is the same of all members of a kind.
struct Common {
    features: BTreeMap<String, Value>,
    /// Members of each kind that there is, in the order of the catalogue.
    members: Vec<(&'static str, Vec<String>)>,
}

const LATE: &str = "the time after the first contact";
const EVENTS: &str = "contacts and fractures";
const STAYS: &str = "these stay as they are generated";

/// The rules about events that are not asked in a building.
///
/// # Errors
/// If a rule about columns compares what is not known before the run with something else that is not a number.
pub fn of(
    building: &Building,
    rules: &RuleBase,
    (known, accuracy): (&Known, Accuracy),
    (decision, stays): (&Decision, &[StaysWhole]),
) -> Result<Vec<Unasked>, GenerateError> {
    let common = Common::of(building, known, accuracy);
    let late = |kind: SubjectKind, words: &str, all: bool| {
        let kinds = common.kinds().filter(|k| all || *k != "column");
        let of_kind = |k| {
            let subject = common.subject(kind, k);
            let found = rules.possible_with(&subject, "collapse.phase", "after_contact").into_iter();
            found.filter(|r| r.action != Action::BreakAway).map(move |r| (r, k))
        };
        common.grouped(kinds.flat_map(of_kind), words, [LATE, STAYS])
    };
    let mut list = late(SubjectKind::Member, "", false);
    list.extend(late(SubjectKind::MemberEnd, "ends of ", true));
    list.extend(late(SubjectKind::Section, "sections of ", false));
    list.extend(late(SubjectKind::SlabLine, "strips of ", true));
    list.extend(late(SubjectKind::WallEnd, "feet and heads of ", true));
    let never_break = decision.sections().next().is_none();
    let beams = building.members.iter().filter(|m| m.kind == MemberKind::Beam).count();
    let some_part = stays.iter().map(|s| s.beams.len()).sum::<usize>() < beams;
    let events = [SubjectKind::ContactEvent, SubjectKind::FractureEvent];
    let of_others = events.iter().flat_map(|kind| {
        let of_kind = |k| common.rules_about(rules, *kind, k);
        common
            .kinds()
            .filter(|k| *k != "column" && !(*k == "beam" && some_part))
            .flat_map(of_kind)
            .collect::<Vec<_>>()
    });
    list.extend(common.grouped(of_others, "", [EVENTS, STAYS]));
    if some_part {
        let of_beams = events.iter().flat_map(|kind| common.rules_about(rules, *kind, "beam"));
        let mut own = common.grouped(of_beams, "", [EVENTS, "these stay one with their slabs"]);
        for group in &mut own {
            group.members.retain(|m| stays.iter().any(|s| s.beams.contains(m)));
        }
        own.retain(|group| !group.members.is_empty());
        list.extend(own);
    }
    if never_break {
        let of_columns = events.iter().flat_map(|kind| common.rules_about(rules, *kind, "column"));
        list.extend(common.grouped(of_columns, "", [EVENTS, "none of them may break between its ends"]));
    } else {
        list.extend(common.not_evaluated(building, rules, events)?);
    }
    Ok(list)
}

impl Common {
    fn of(building: &Building, known: &Known, accuracy: Accuracy) -> Self {
        let kind_of = |s: &Subject| match s.features.get("member.kind") {
            Some(Value::Name(kind)) => Some(kind.clone()),
            _ => None,
        };
        let of_kind = |kind: &&'static str| {
            let own = building.members.iter().zip(&known.members);
            let own = own.filter(|(_, s)| kind_of(s).as_deref() == Some(*kind));
            (*kind, own.map(|(m, _)| m.id.clone()).collect::<Vec<_>>())
        };
        let is_common = |name: &str| name.starts_with("building.") || !name.contains('.');
        let mut features = known.members.first().map_or(BTreeMap::new(), |s| s.features.clone());
        features.retain(|name, _| is_common(name));
        features.insert("wish.accuracy".into(), Value::Name(accuracy.name().into()));
        let members = MEMBER_KINDS.iter().map(of_kind).filter(|(_, own)| !own.is_empty()).collect();
        Self { features, members }
    }

    fn kinds(&self) -> impl Iterator<Item = &'static str> {
        self.members.iter().map(|(kind, _)| *kind)
    }

    fn subject(&self, kind: SubjectKind, member_kind: &str) -> Subject {
        let mut subject = Subject::new(kind, member_kind).with("member.kind", member_kind);
        subject.features.extend(self.features.clone());
        subject
    }

    /// The rules about a kind of event that may fire for a kind of member.
    fn rules_about<'a>(
        &self,
        rules: &'a RuleBase,
        kind: SubjectKind,
        member_kind: &'static str,
    ) -> Vec<(&'a Rule, &'static str)> {
        rules.possible(&self.subject(kind, member_kind)).map(|r| (r, member_kind)).collect()
    }

    /// Rules about columns that ask for what a run does not evaluate, or that others supersede altogether.
    fn not_evaluated(
        &self,
        building: &Building,
        rules: &RuleBase,
        events: [SubjectKind; 2],
    ) -> Result<Vec<Unasked>, GenerateError> {
        let mut by_feature: BTreeMap<Vec<String>, Vec<&Rule>> = BTreeMap::new();
        for kind in events {
            let subject = event_rules::struck(building, kind, "column");
            let asked = event_rules::asked(rules, &subject)?;
            for rule in rules.possible(&subject).filter(|r| !asked.iter().any(|p| p.rule == r.id)) {
                let lacking = rules.unknown_to(rule, &subject, &LATER);
                by_feature.entry(lacking.into_iter().collect()).or_default().push(rule);
            }
        }
        let told = |(features, own): (Vec<String>, Vec<&Rule>)| {
            let why = match features.as_slice() {
                [] => "other rules supersede them wherever they would fire".to_string(),
                lacking => format!("a run does not evaluate {}", lacking.join(", ")),
            };
            self.grouped(own.into_iter().map(|r| (r, "column")), "", [EVENTS, &why])
        };
        Ok(by_feature.into_iter().flat_map(told).collect())
    }

    /// Rules of the same kinds of members together.
    fn grouped<'a>(
        &self,
        found: impl Iterator<Item = (&'a Rule, &'static str)>,
        words: &str,
        [events, why]: [&str; 2],
    ) -> Vec<Unasked> {
        let mut kinds_of: BTreeMap<&str, Vec<&'static str>> = BTreeMap::new();
        for (rule, kind) in found {
            let kinds = kinds_of.entry(&rule.id).or_default();
            if !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        let mut groups: BTreeMap<Vec<&'static str>, Vec<String>> = BTreeMap::new();
        for (rule, kinds) in kinds_of {
            groups.entry(kinds).or_default().push(rule.to_string());
        }
        let group = |(kinds, rules): (Vec<&'static str>, Vec<String>)| Unasked {
            rules,
            events: events.to_string(),
            about: format!("{words}{}", plural(&kinds)),
            why: why.to_string(),
            members: self
                .members
                .iter()
                .filter(|(kind, _)| kinds.contains(kind))
                .flat_map(|(_, own)| own.clone())
                .collect(),
        };
        groups.into_iter().map(group).collect()
    }
}

/// "beams, slabs and walls".
fn plural(kinds: &[&str]) -> String {
    let many: Vec<String> = kinds.iter().map(|kind| format!("{kind}s")).collect();
    match many.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
