//! The generated model in tables, and the resistance curves it uses.

use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::generate::{BEAM_CURVES, EventReason, Generated};
use crate::library::Entry;
use crate::mbs::RunResult;
use crate::mbs::model::{Bending, Bushing};
use crate::mbs::result::{EventKind, RunEvent};
use crate::report::{
    BodyRow, CurveFamily, CurveLevel, EntryRow, EventRuleRow, JointRow, ModelSummary, ReviewRow,
    ReviewSummary, RuleRow, TraceRow,
};
use crate::review::{Item, NEGLIGIBLE_M, Review};
use std::collections::BTreeMap;

/// An entry in words, such as `column 0.40 x 0.40 m, top at a beam, 1.71 m to the point of zero moment`.
pub fn entry_words(entry: &Entry) -> String {
    entry.words()
}

/// All tables of the model.
pub fn summary(generated: &Generated, run: &RunResult) -> ModelSummary {
    let model = &generated.model;
    ModelSummary {
        bodies: model
            .bodies
            .iter()
            .map(|b| BodyRow { id: b.id.clone(), mass_kg: b.mass_kg, members: b.origin.members.clone() })
            .collect(),
        joints: model.bushings.iter().map(joint).collect(),
        entries: generated
            .entries
            .iter()
            .map(|(key, entry)| EntryRow {
                key: key.clone(),
                description: entry_words(entry),
                uses: model.bushings.iter().filter(|j| j.origin.entries.contains(key)).count() as u64,
            })
            .collect(),
        rules: rules(generated),
        event_rules: generated.event_rules.iter().map(|r| event_rule(r, run)).collect(),
        trace: generated
            .trace
            .iter()
            .map(|t| TraceRow {
                part: t.part.clone(),
                rule: t.rule.clone(),
                words: match t.is_of_analyst() {
                    true => {
                        let instead = t.instead_words();
                        format!(
                            "{} → {}: the analyst's override, {}; {instead}",
                            t.subject,
                            in_words(&t.action),
                            t.words
                        )
                    }
                    false => format!("{} → {}: {}", t.subject, in_words(&t.action), t.words),
                },
                entries: t.entries.clone(),
            })
            .collect(),
    }
}

fn joint(joint: &Bushing) -> JointRow {
    let curve = |b: &Bending| match b {
        Bending::Curve { curve, .. } => Some(curve.clone()),
        Bending::Elastic { .. } => None,
    };
    let curves: Vec<String> = joint.bending.iter().filter_map(curve).collect();
    JointRow {
        id: joint.id.clone(),
        joins: format!("{} – {}", joint.body_a.as_deref().unwrap_or("ground"), joint.body_b),
        kind: match &joint.beam {
            _ if curves.is_empty() => "elastic",
            Some(_) => "beam",
            None => "hinge",
        }
        .into(),
        curves,
    }
}

fn rules(generated: &Generated) -> Vec<RuleRow> {
    let mut rules: BTreeMap<&str, RuleRow> = BTreeMap::new();
    for t in &generated.trace {
        let row = rules.entry(&t.rule).or_insert_with(|| RuleRow {
            id: t.rule.clone(),
            text: match t.is_of_analyst() {
                true => {
                    "Decisions of the analyst in place of the rules; their reasons stand beside the parts."
                        .into()
                }
                false => t.words.clone(),
            },
            ..RuleRow::default()
        });
        row.fired += 1;
        row.out_of_range |= !t.in_range;
    }
    rules.into_values().collect()
}

/// Firings of a rule that are named.
const FIRINGS_NAMED: usize = 6;

/// A rule about events, and when it fired in the run.
fn event_rule(r: &EventReason, run: &RunResult) -> EventRuleRow {
    let firing = |e: &RunEvent| match &e.kind {
        EventKind::Rule { rule, body, .. } if *rule == r.id => Some(format!("{:.3} s ({body})", e.time_s)),
        _ => None,
    };
    let firings: Vec<String> = run.events.iter().filter_map(firing).collect();
    let mut fired = firings.iter().take(FIRINGS_NAMED).cloned().collect::<Vec<_>>().join(", ");
    if firings.len() > FIRINGS_NAMED {
        fired += &format!(" and {} more", firings.len() - FIRINGS_NAMED);
    }
    let done = r.done.as_ref().map_or(String::new(), |done| format!("; {done}"));
    EventRuleRow {
        id: r.id.clone(),
        text: r.words.clone(),
        about: r.members.clone(),
        remains: format!("if {}", r.remains),
        then: format!("{}{done}", r.then),
        fired: if fired.is_empty() { "never".into() } else { fired },
    }
}

/// What the page says in place of the names of actions, which are those of rule files.
const ACTIONS: [(&str, &str); 8] = [
    ("rigid_body", "one rigid body"),
    ("merge_rigid", "one rigid body with its floor"),
    ("merge_elastic", "part of a floor that bends"),
    ("subdivide", "several bodies"),
    ("break_away", "a beam that may break away"),
    ("latent_hinge", "a latent hinge"),
    ("elastic_connection", "springs that do not yield"),
    ("rigid_connection", "no rotation"),
];

/// A text with the names of actions in words.
fn in_words(text: &str) -> String {
    let is_letter = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut out = String::new();
    let mut rest = text;
    while !rest.is_empty() {
        let first = rest.starts_with(is_letter);
        let end = rest.find(|c| is_letter(c) != first).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        out += ACTIONS.iter().find(|(name, _)| *name == word).map_or(word, |(_, words)| words);
        rest = after;
    }
    out
}

/// The decisions worth a look.
pub fn review(review: &Review) -> ReviewSummary {
    let row = |item: &Item| ReviewRow {
        about: item.subjects.clone(),
        decision: format!("{} ({})", in_words(&item.decision), item.by),
        why: in_words(&item.why.join("; ")),
        otherwise: in_words(&item.otherwise),
        change: if item.change.is_none() && item.untried.is_none() {
            String::new()
        } else {
            item.change_words()
        },
        counts: item.change.as_ref().map(|c| c.turns_outcome() || c.difference_to_contact_m > NEGLIGIBLE_M),
    };
    ReviewSummary {
        runs: review.runs,
        most_runs: review.most_runs,
        rows: review.items.iter().map(row).collect(),
    }
}

/// The curves that the joints of a model have, made from these entries; equal ones share a chart.
pub fn curves(
    of_model: &BTreeMap<String, ResistanceCurve>,
    entries: &BTreeMap<String, Entry>,
) -> Vec<CurveFamily> {
    let mut alike: Vec<(&String, &ResistanceCurve, usize)> = Vec::new();
    for (id, curve) in of_model {
        match alike.iter_mut().find(|(_, other, _)| *other == curve) {
            Some((_, _, others)) => *others += 1,
            None => alike.push((id, curve, 0)),
        }
    }
    let family = |(id, curve, others): (&String, &ResistanceCurve, usize)| {
        let same = match others {
            0 => String::new(),
            1 => "; another curve is the same".into(),
            n => format!("; {n} other curves are the same"),
        };
        CurveFamily {
            id: id.clone(),
            description: format!("{}{same}", curve_words(entries, id)),
            levels: capacities(curve),
        }
    };
    alike.into_iter().map(family).collect()
}

/// What a curve of the model is of.
fn curve_words(entries: &BTreeMap<String, Entry>, id: &str) -> String {
    let of_entry = entries.iter().find_map(|(key, entry)| {
        let of = id.strip_prefix(key.as_str())?.strip_prefix("/axis-")?;
        let latent = if of.contains("/free/") { ", for a latent section away from the joint" } else { "" };
        let axis = of.split('/').next().unwrap_or(of);
        Some(format!("{}, bending about axis {axis}{latent}", entry_words(entry)))
    });
    of_entry.unwrap_or_else(|| {
        let (kind, _) = id.split_once('/').unwrap_or((id, ""));
        match kind {
            _ if id.starts_with(BEAM_CURVES) => "both ends of a beam or strip of a floor, from its section",
            "wall" => "end of a wall, from its section",
            "web" => "web of a beam that breaks away from its slab",
            _ => "",
        }
        .into()
    })
}

/// A curve of capacities over plastic rotation as moments over rotation.
fn capacities(curve: &ResistanceCurve) -> Vec<CurveLevel> {
    let level = |level: &CapacityLevel| {
        let whole = level.capacity.iter().map(|[x, m]| [x + m / curve.stiffness_nm_rad, *m]);
        CurveLevel {
            axial_force_n: level.axial_force_n,
            points: std::iter::once([0.0; 2]).chain(whole).collect(),
            fracture_rotation_rad: Some(level.fracture_rotation_rad),
        }
    };
    curve.levels.iter().map(level).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn actions_are_told_in_words() {
        let text = "rule learned/floors/merge-like says merge_rigid, right in 99 %";
        assert_eq!(
            in_words(text),
            "rule learned/floors/merge-like says one rigid body with its floor, right in 99 %"
        );
        assert_eq!(in_words("hinge"), "hinge");
    }

    /// The page draws what the model has, not what an entry has before the model makes its curve of it.
    #[test]
    fn curves_are_those_of_the_model_and_equal_ones_are_drawn_once() {
        let level = |fracture_rotation_rad: f64| CapacityLevel {
            axial_force_n: 3.36e5,
            capacity: vec![[0.0, 2.0e5], [fracture_rotation_rad, 1.0e5]],
            fracture_rotation_rad,
        };
        let curve = |x: f64| ResistanceCurve { stiffness_nm_rad: 1e7, levels: vec![level(x)], cyclic: None };
        let ids = [("beam/A", 0.5), ("beam/B", 0.5), ("wall/W", 1.356)];
        let drawn = curves(&ids.map(|(id, x)| (id.to_string(), curve(x))).into(), &BTreeMap::new());
        assert_eq!(drawn.iter().map(|c| c.id.as_str()).collect::<Vec<_>>(), ["beam/A", "wall/W"]);
        assert!(drawn[0].description.ends_with("from its section; another curve is the same"));
        assert_eq!(drawn[1].levels[0].fracture_rotation_rad, Some(1.356));
        assert_eq!(drawn[1].levels[0].points, [[0.0, 0.0], [0.02, 2.0e5], [1.356 + 0.01, 1.0e5]]);
    }
}
