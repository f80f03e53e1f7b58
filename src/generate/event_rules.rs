//! What contacts and fractures change in the model that runs, by the rules about such events.
//!
//! Of what these rules ask, the kind of the member and the building are known beforehand; what is left of their conditions goes into the model: with what, how fast, when.

use super::GenerateError;
use super::bodies::Bodies;
use super::decide::Decision;
use super::webs::Webs;
use crate::building::Building;
use crate::mbs::model::{Broken, Bushing, EventRule, Met, Origin, Range, Trigger};
use crate::rules::residual::{Case, Pending};
use crate::rules::{Action, Aspect, RuleBase, Subject, SubjectKind, Value};
use std::collections::BTreeMap;

/// What will be known of an event when it happens.
pub(super) const LATER: [&str; 5] =
    ["contact.partner", "contact.approach_speed", "event.time", "fracture.place", "collapse.phase"];

/// What rules about events answer.
const QUESTIONS: [(Aspect, &str); 2] = [(Aspect::Change, "change"), (Aspect::Rigidity, "rigidity")];

/// Members of a kind that something may part once a rule about an event has fired for them.
struct Watched {
    kind: &'static str,
    /// Their bodies, and the latent bushings.
    bodies: Vec<String>,
    bushings: Vec<String>,
}

/// The rules for the columns that may break between their ends, at these hinges, and for the beams that may break away from their slabs.
///
/// # Errors
/// If a rule compares what is not known yet with something else that is not a number.
pub fn of(
    building: &Building,
    rules: &RuleBase,
    decision: &Decision,
    (bodies, hinges): (&Bodies, &[Bushing]),
    webs: &Webs,
) -> Result<Vec<EventRule>, GenerateError> {
    let of_column = |(member, _)| bodies.all_of(member).into_iter().map(|i| bodies.list[i].id.clone());
    let ids = |list: &[Bushing]| list.iter().map(|h| h.id.clone()).collect();
    let columns = decision.sections().flat_map(of_column).collect();
    let watched = [
        Watched { kind: "column", bodies: columns, bushings: ids(hinges) },
        Watched { kind: "beam", bodies: webs.parting[0].clone(), bushings: webs.parting[1].clone() },
    ];
    let mut list: Vec<EventRule> = Vec::new();
    for own in watched.iter().filter(|w| !w.bushings.is_empty()) {
        for rule in of_kind(building, rules, own)? {
            let same = |r: &&mut EventRule| {
                (&r.id, &r.question, &r.on, r.nearest) == (&rule.id, &rule.question, &rule.on, rule.nearest)
                    && r.watch.is_empty() == rule.watch.is_empty()
            };
            if let Some(first) = list.iter_mut().find(same) {
                first.bodies.extend(rule.bodies);
                first.watch.extend(rule.watch);
            } else {
                let id = if list.iter().any(|r| r.id == rule.id) {
                    format!("{}/{}", rule.id, own.kind)
                } else {
                    rule.id
                };
                list.push(EventRule { id, ..rule });
            }
        }
    }
    Ok(list)
}

/// The rules for members of a kind.
fn of_kind(building: &Building, rules: &RuleBase, own: &Watched) -> Result<Vec<EventRule>, GenerateError> {
    let first_s = building.events.iter().map(|e| e.time_s).fold(f64::INFINITY, f64::min);
    let first_s = if first_s.is_finite() { first_s } else { 0.0 };
    let mut list = Vec::new();
    for kind in [SubjectKind::ContactEvent, SubjectKind::FractureEvent] {
        let event = struck(building, kind, own.kind);
        for (aspect, question) in QUESTIONS {
            for pending in rules.pending(&event, aspect, &LATER)? {
                for (n, case) in pending.cases.iter().enumerate() {
                    list.extend(trigger(kind, case, first_s).map(|on| EventRule {
                        id: id(&pending, n),
                        question: question.into(),
                        on,
                        bodies: own.bodies.clone(),
                        watch: if has_hinges(&pending) { own.bushings.clone() } else { Vec::new() },
                        nearest: is_local(&pending),
                        origin: Origin { rules: vec![pending.rule.to_string()], ..Origin::default() },
                    }));
                }
            }
        }
    }
    Ok(list)
}

/// Whether rules put a contact subsystem in where a column meets something.
///
/// # Errors
/// If a rule compares what is not known yet with something else that is not a number.
pub fn puts_contact_in(building: &Building, rules: &RuleBase) -> Result<bool, GenerateError> {
    let kind = SubjectKind::ContactEvent;
    let asked = rules.pending(&struck(building, kind, "column"), Aspect::Change, &LATER)?;
    let contact = |p: &Pending| {
        p.action == Action::InsertSubsystem
            && matches!(name(p.parameters, "subsystem"), Some("contact" | "contact_and_hinge"))
    };
    let happens = |p: &Pending| p.cases.iter().any(|case| trigger(kind, case, 0.0).is_some());
    // one that asks for nothing more decides, whatever comes behind it
    let always = |p: &Pending| p.cases.iter().any(|case| case.ranges.is_empty() && case.names.is_empty());
    let first = asked.iter().find(|pending| always(pending) || contact(pending) && happens(pending));
    Ok(first.is_some_and(contact))
}

/// What is known beforehand of an event of a member of a kind.
pub(super) fn struck(building: &Building, kind: SubjectKind, member_kind: &str) -> Subject {
    let storeys = building.members.iter().filter_map(|m| m.storey).max().unwrap_or(0);
    Subject::new(kind, &format!("a {member_kind}"))
        .with("member.kind", member_kind)
        .with("critical_strain_rate", building.settings.critical_strain_rate_1_s)
        .with("storeys", f64::from(storeys))
}

/// The rules about events of a member that are asked while the model runs.
///
/// # Errors
/// If a rule compares what is not known yet with something else that is not a number.
pub(super) fn asked<'a>(rules: &'a RuleBase, event: &Subject) -> Result<Vec<Pending<'a>>, GenerateError> {
    let mut list = Vec::new();
    for (aspect, _) in QUESTIONS {
        list.extend(rules.pending(event, aspect, &LATER)?);
    }
    Ok(list)
}

/// A rule with several cases is several rules.
fn id(pending: &Pending, n: usize) -> String {
    if pending.cases.len() == 1 { pending.rule.to_string() } else { format!("{}/{}", pending.rule, n + 1) }
}

/// Whether sections may break from then on.
fn has_hinges(pending: &Pending) -> bool {
    match pending.action {
        Action::InsertSubsystem => name(pending.parameters, "subsystem") != Some("contact"),
        Action::RecheckRigidity => true,
        _ => false,
    }
}

/// Whether only the section next to the event may.
fn is_local(pending: &Pending) -> bool {
    matches!(name(pending.parameters, "place"), Some("at_event" | "nearest_section"))
}

fn name<'a>(parameters: &'a BTreeMap<String, Value>, key: &str) -> Option<&'a str> {
    match parameters.get(key) {
        Some(Value::Name(name)) => Some(name),
        _ => None,
    }
}

/// The event that a case of a rule is about; none if it cannot happen.
fn trigger(kind: SubjectKind, case: &Case, first_s: f64) -> Option<Trigger> {
    let range = |feature: &str, offset: f64| {
        let [least, most] = case.ranges.get(feature).copied().unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
        let bound = |value: f64| value.is_finite().then_some(value + offset);
        Range { least: bound(least), most: bound(most) }
    };
    let may_be = |feature: &str, name: &str| case.names.get(feature).is_none_or(|names| names.contains(name));
    let time_s = range("event.time", first_s);
    let (before, after) =
        (may_be("collapse.phase", "before_contact"), may_be("collapse.phase", "after_contact"));
    if kind == SubjectKind::ContactEvent {
        let all = [("ground", Met::Ground), ("obstacle", Met::Obstacle), ("part", Met::Part)];
        let partners =
            all.into_iter().filter(|(name, _)| may_be("contact.partner", name)).map(|(_, met)| met).collect();
        // whatever meets something is in the phase after the first contact
        return after.then_some(Trigger::Contact {
            partners,
            approach_speed_m_s: range("contact.approach_speed", 0.0),
            time_s,
        });
    }
    let all = [("end", Broken::End), ("span", Broken::Span)];
    let places = all.into_iter().filter(|(name, _)| may_be("fracture.place", name)).map(|(_, b)| b).collect();
    let after_contact = (before != after).then_some(after);
    (before || after).then_some(Trigger::Fracture { places, after_contact, time_s })
}
