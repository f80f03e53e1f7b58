//! What the rules could not be asked since the elastic demands have no solution, or leave members out.

use super::generator::Basis;
use super::listed;
use crate::graph::demand::StateSummary;
use crate::rules::{Rule, Subject, Value};
use std::collections::BTreeSet;

/// Features that come from the elastic demands before the charges.
const OF_BEFORE: [&str; 3] = ["end.demand_ratio_before", "end.joint_strength", "member.axial_ratio"];
/// Features that come from those after them, or for the building as a whole from those before if there are none.
const OF_AFTER: [&str; 8] = [
    "building.demand_ratio",
    "building.law_demand_ratio",
    "end.column_demand_ratio",
    "end.demand_ratio",
    "end.law_demand_ratio",
    "line.beam_demand_ratio",
    "line.demand_ratio",
    "member.axial_ratio_after",
];
const CONNECT: &str =
    "connect or support what is not meant to be free, or write rules that ask for `building.mechanism`";
const REACH: &str = "let beams reach columns, walls or other beams";
const DECIDE: &str = "look at `fallwerk graph`, and decide with `[[overrides]]` what these rules would have";

/// Notes of what the elastic demands lack, with a remedy each.
pub(super) fn notes(basis: &Basis<'_>) -> Vec<String> {
    let demands = &basis.demands;
    let states = [("before", Some(&demands.before)), ("after", demands.after.as_ref())];
    let (mut notes, mut why, mut remedies) = (Vec::new(), Vec::new(), BTreeSet::new());
    let mut features: Vec<&str> = Vec::new();
    for ((name, state), own) in states.into_iter().zip([&OF_BEFORE[..], &OF_AFTER[..]]) {
        let solved = state.unwrap_or(&demands.before);
        if let StateSummary::Equilibrium { left_out, .. } = solved {
            notes.extend(state.and_then(|_| left_out_words(name, left_out)));
        }
        let lacking = lacking(name, solved);
        if !lacking.is_empty() {
            features.extend(own);
        }
        for (said, remedy) in lacking {
            why.extend(state.map(|_| said));
            remedies.insert(remedy);
        }
    }
    let remedy = remedies.into_iter().collect::<Vec<_>>().join("; ");
    notes.extend(unsolved_words(basis, &features, &why.join(", "), &remedy));
    notes.extend(demands.overloaded(basis.building));
    notes
}

/// Why members have no demands in a state, each with its remedy.
fn lacking(name: &str, state: &StateSummary) -> Vec<(String, &'static str)> {
    let mut found = Vec::new();
    if let Some(members) = state.free() {
        found.push((format!("there is no equilibrium {name} the charges ({})", free(members)), CONNECT));
    }
    match state {
        StateSummary::Equilibrium { by_slab, .. } if !by_slab.is_empty() => {
            found.push((format!("only a slab holds {} {name} the charges", listed(by_slab)), REACH));
        }
        StateSummary::Failed { reason } => {
            found.push((
                format!("the elastic demands {name} the charges have no solution ({reason})"),
                DECIDE,
            ));
        }
        _ => {}
    }
    found
}

/// What can move freely.
fn free(members: &[String]) -> String {
    match members {
        [] => "what no bar connects can move freely".into(),
        some => format!("{} can move freely", listed(some)),
    }
}

/// Columns that the demands leave out.
fn left_out_words(name: &str, left_out: &[String]) -> Option<String> {
    (!left_out.is_empty()).then(|| {
        format!(
            "the elastic demands {name} the charges leave out {}: they touch a slab and bear nothing of it there, so that rules about demands are asked with too little for them and too much for their neighbours; put a beam on them or a column in line with them, or decide with `[[overrides]]`",
            listed(left_out)
        )
    })
}

/// Rules that could not be asked for some members, if there are any.
fn unsolved_words(basis: &Basis<'_>, features: &[&str], why: &str, remedy: &str) -> Option<String> {
    if features.is_empty() {
        return None;
    }
    let (mut rules, mut members) = (BTreeSet::new(), BTreeSet::new());
    let Basis { building, known, ends, plates, .. } = basis;
    let of_members = known.members.iter().enumerate();
    let of_ends = known.ends.iter().zip(ends).map(|(subject, end)| (end.member, subject));
    let of_lines = known.lines.iter().zip(plates).map(|(subject, line)| (line.member, subject));
    for (member, subject) in of_members.chain(of_ends).chain(of_lines) {
        let unasked = unasked(basis, subject, features);
        if !unasked.is_empty() {
            members.insert(member);
        }
        rules.extend(unasked.into_iter().map(|rule| format!("`{}`", rule.id)));
    }
    let ids: Vec<String> = members.into_iter().map(|m: usize| building.members[m].id.clone()).collect();
    let rules: Vec<String> = rules.into_iter().collect();
    (!rules.is_empty()).then(|| {
        format!(
            "{why}: rules that ask about demands could not be asked for {} ({}); {remedy}",
            listed(&ids),
            listed(&rules)
        )
    })
}

/// Rules that some features alone keep from being asked for a subject, at any time.
fn unasked<'a>(basis: &Basis<'a>, subject: &Subject, features: &[&str]) -> Vec<&'a Rule> {
    if subject.features.get("member.charged") == Some(&Value::Flag(true)) {
        return Vec::new();
    }
    let mut subject = subject.clone().with("wish.accuracy", basis.accuracy.name());
    subject.features.remove("collapse.phase");
    let lacks = |rule: &&Rule| {
        let lacking = basis.rules.unknown_to(rule, &subject, &["collapse.phase"]);
        !lacking.is_empty() && lacking.iter().all(|name| features.contains(&name.as_str()))
    };
    basis.rules.possible(&subject).filter(lacks).collect()
}

#[cfg(test)]
mod tests {
    use super::{CONNECT, REACH, StateSummary, lacking, left_out_words};

    #[test]
    fn members_without_demands_beside_others_with_some_are_told() {
        let state = |by_slab: &[&str], not_held: &[&str]| StateSummary::Equilibrium {
            weight_n: 1.0,
            reaction_sum_n: [0.0, 0.0, 1.0],
            reactions: Vec::new(),
            largest_displacement_m: 0.0,
            unknowns: 6,
            unplaced: Vec::new(),
            left_out: Vec::new(),
            by_slab: by_slab.iter().map(ToString::to_string).collect(),
            not_held: not_held.iter().map(ToString::to_string).collect(),
            off_center: 0.0,
        };
        assert!(lacking("before", &state(&[], &[])).is_empty());
        let [(free, connect), (slab, reach)] = &lacking("after", &state(&["BX"], &["K1", "K2"]))[..] else {
            panic!()
        };
        assert_eq!(free, "there is no equilibrium after the charges (K1, K2 can move freely)");
        assert_eq!(slab, "only a slab holds BX after the charges");
        assert_eq!((*connect, *reach), (CONNECT, REACH));
    }

    #[test]
    fn columns_that_are_left_out_are_named_with_a_remedy() {
        assert_eq!(left_out_words("before", &[]), None);
        let note = left_out_words("after", &["K1".into(), "K2".into()]).unwrap();
        assert!(note.starts_with("the elastic demands after the charges leave out K1, K2:"), "{note}");
        assert!(note.contains("put a beam on them"), "{note}");
    }
}
