//! What is carried out of what rules decide: the actions that a generated model can have, for each kind of subject and member.
//!
//! This is the only place that says so. The check of rule files names rules that may ask for something else, and the generator refuses
//! one that does in a building.

use super::action::{Action, Aspect};
use super::check::{at, member_kinds};
use super::logic::{self, Atom, Conjunction};
use super::problem::Problem;
use super::rule::Rule;
use super::value::SubjectKind;
use SubjectKind::{Member, MemberEnd, Section, SlabLine, WallEnd};

/// Features that no generated model knows of: a rule that asks for them does not fire there.
const NEVER_KNOWN: [&str; 2] = ["member.strain_rate", "section.strain_rate"];

/// What is carried out for a kind of subject of a kind of member that is asked this question before anything has happened.
pub fn actions(subject: SubjectKind, member: &str, aspect: Aspect) -> &'static [Action] {
    use Action::{
        BreakAway, ElasticConnection, Hinge, LatentHinge, MergeElastic, MergeRigid, RemoveBody, RigidBody,
        RigidConnection, RigidTranslation, TranslationalSpring,
    };
    match (subject, member, aspect) {
        // hinges stand at the ends of columns, so that a column is a body of its own
        (Member, "column", Aspect::Body) => &[RigidBody],
        // nothing but its floor holds a slab or beam
        (Member, "slab" | "beam", Aspect::Body) => &[MergeRigid, MergeElastic],
        (Member, "wall" | "footing", Aspect::Body) => &[RigidBody, MergeRigid],
        (Member, _, Aspect::Charge) => &[RemoveBody],
        (Member, "beam", Aspect::Parting) => &[BreakAway],
        (MemberEnd, "column", Aspect::Rotation) => &[Hinge, ElasticConnection],
        (MemberEnd, "beam", Aspect::Rotation) => &[LatentHinge, RigidConnection],
        (MemberEnd, "column", Aspect::Translation) => &[TranslationalSpring],
        (MemberEnd, "beam", Aspect::Translation) => &[RigidTranslation],
        (Section, _, Aspect::Rotation) => &[LatentHinge, RigidConnection],
        (SlabLine | WallEnd, _, Aspect::Rotation) => &[LatentHinge, ElasticConnection],
        _ => &[],
    }
}

/// What to write in place of an action that is not carried out for such a subject.
pub fn remedy(subject: SubjectKind, member: &str, action: Action) -> String {
    match (action, subject, member) {
        (Action::RemoveBody, ..) => {
            return "a rule takes away what has a charge, at its time: ask for `member.charged` in its condition, and put the charge into the building file (`[[events]]`)".to_string();
        }
        (Action::Subdivide, _, "column") => {
            return "a column is divided from the first contact on: ask for `collapse.phase == 'after_contact'` in its condition".to_string();
        }
        _ => {}
    }
    let known = actions(subject, member, action.spec().aspect);
    let names: Vec<String> = known.iter().map(|a| format!("`{}`", a.spec().name)).collect();
    let instead = match names.as_slice() {
        [] => format!("ask for another `member.kind` than '{member}' in its condition"),
        _ => format!(
            "write {}, or ask for another `member.kind` than '{member}' in its condition",
            names.join(" or ")
        ),
    };
    match (action, subject, member) {
        (Action::RigidConnection, MemberEnd, "column") => {
            format!("{instead}; an override in the building file makes single column ends rigid")
        }
        _ => instead,
    }
}

/// Rules that may decide, before anything has happened, what is not carried out.
pub fn problems(rules: &[Rule]) -> Vec<Problem> {
    rules.iter().filter_map(|rule| fault(rule).map(|message| at(rule, message))).collect()
}

/// What of a rule is not carried out, if its conditions tell so.
fn fault(rule: &Rule) -> Option<String> {
    let (subject, aspect, name) = (rule.applies_to, rule.action.spec().aspect, rule.action.spec().name);
    if matches!(subject, SubjectKind::ContactEvent | SubjectKind::FractureEvent) {
        return None;
    }
    let phase = if aspect == Aspect::Parting { "after_contact" } else { "before_contact" };
    let cases = logic::cases(&rule.condition, false)?;
    let may_fire = |kind: &str| {
        let mut known = vec![is("member.kind", kind), is("collapse.phase", phase)];
        // without a charge there is nothing for it to do
        known.extend((rule.action == Action::RemoveBody).then(|| is("member.charged", "false")));
        cases.iter().any(|case| !asks_for_unknown(case) && logic::possible(&[&known[..], case].concat()))
    };
    let kind = member_kinds(subject).iter().find(|kind| {
        let is_known = actions(subject, kind, aspect).contains(&rule.action);
        (!is_known || rule.action == Action::RemoveBody) && may_fire(kind)
    })?;
    let of_what = if rule.action == Action::RemoveBody { " without a charge" } else { "" };
    let remedy = remedy(subject, kind, rule.action);
    Some(format!(
        "`{}` may decide `{name}` for a {subject} of a {kind}{of_what}, which no generated model carries out; {remedy}",
        rule.id
    ))
}

fn is(feature: &str, value: &str) -> Atom {
    Atom::OneOf(feature.to_string(), [value.to_string()].into())
}

fn asks_for_unknown(case: &Conjunction) -> bool {
    case.iter().flat_map(Atom::features).any(|name| NEVER_KNOWN.contains(&name.as_str()))
}
