//! The generated model in tables, and the resistance curves it uses.

use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::generate::{BEAM_CURVES, EventReason, Generated};
use crate::library::Entry;
use crate::library::entry::AxisRecord;
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
                            t.subject, t.action, t.words
                        )
                    }
                    false => format!("{} → {}: {}", t.subject, t.action, t.words),
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

/// The decisions worth a look.
pub fn review(review: &Review) -> ReviewSummary {
    let row = |item: &Item| ReviewRow {
        about: item.subjects.clone(),
        decision: format!("{} ({})", item.decision, item.by),
        why: item.why.join("; "),
        otherwise: item.otherwise.clone(),
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

/// The computed envelopes of the entries used; the curves of those that were made without a run, and of the beams of floors that bend.
pub fn curves(generated: &Generated) -> Vec<CurveFamily> {
    let family = |key: &str, entry: &Entry, axis: usize| {
        let AxisRecord { envelopes, curve, .. } = &entry.axes[axis];
        let computed = envelopes.iter().map(|level| CurveLevel {
            axial_force_n: level.axial_force_n,
            points: level.points.clone(),
            fracture_rotation_rad: level.fracture_rotation_rad,
        });
        CurveFamily {
            id: format!("{key}/axis-{}", axis + 1),
            description: format!("{}, bending about axis {}", entry_words(entry), axis + 1),
            levels: if envelopes.is_empty() { capacities(curve) } else { computed.collect() },
        }
    };
    let of_entry = |(key, entry): (&String, &Entry)| -> Vec<CurveFamily> {
        (0..entry.axes.len()).map(|axis| family(key, entry, axis)).collect()
    };
    let of_beam = |(id, curve): (&String, &ResistanceCurve)| {
        id.starts_with(BEAM_CURVES).then(|| CurveFamily {
            id: id.clone(),
            description: "both ends of a beam or strip of a floor, from its section".into(),
            levels: capacities(curve),
        })
    };
    let beams = generated.model.curves.iter().filter_map(of_beam);
    generated.entries.iter().flat_map(of_entry).chain(beams).collect()
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
