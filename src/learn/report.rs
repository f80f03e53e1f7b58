//! What was learned from what, and what was not: two pages in words.

use super::prune::Validated;
use super::questions::{EXPECTED, Question};
use super::rate::{Rate, rates};
use super::tree::{Count, MISS_COST, RULE_BUILDINGS, YES_BUILDINGS};
use super::{Case, Found, draft};
use std::fmt::Write;

/// The rules that are not used, with the reasons.
pub fn review(found: &[Found]) -> String {
    let mut text = String::from(
        "# Learned rules for review\n\nWritten by `fallwerk rules learn`. None of these is used: an analyst who finds one right moves it to a rule file of its own.\n",
    );
    let all = found.iter().flat_map(|f| f.review.iter().map(move |(draft, why)| (f.question, draft, why)));
    let mut any = false;
    for (question, draft, why) in all {
        any = true;
        let _ = write!(text, "\n## {}\n\n{why}\n\n```toml\n{}```\n", draft.id, draft::rule(question, draft));
    }
    if !any {
        text += "\nNothing to review.\n";
    }
    text
}

/// What was learned.
pub fn report(found: &[Found], cases: &[Case]) -> String {
    let falls = cases.iter().filter(|c| c.study.facts.collapsed).count();
    let mut text = format!(
        "# What the rules were learned from\n\nWritten by `fallwerk rules learn` from {} studies: {falls} buildings fall, {} stand. A miss costs {MISS_COST}, a false alarm 1; each building weighs the same. A rule needs {RULE_BUILDINGS} buildings, one that says yes {YES_BUILDINGS} with a yes; \
         elsewhere the seed rules stay. Costs are means over buildings, each judged by rules learned without it; \"seed\" are those of the seed rules on the same places.\n\n",
        cases.len(),
        cases.len() - falls
    );
    text += "| question | buildings | with a yes | places | yes | rules used | for review | cost learned | cost seed | misses, false alarms learned | seed | places left to the seed rules | Brier score |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for f in found {
        text += &row(f);
    }
    for f in found {
        text += &section(f);
    }
    text += &falls_or_stands(cases);
    text += &strain_rates(&rates(cases));
    text += "\n## What mechanics asks for\n\nWith a larger value of these features turning, yielding and falling are more or less likely, and a floor that falls moves the more as a rigid body. A split that says the opposite is not made:\n\n";
    for (name, more) in EXPECTED {
        let _ = writeln!(text, "- `{name}`: {} likely", if *more { "more" } else { "less" });
    }
    text
}

fn row(f: &Found) -> String {
    let count = Count::of(f.table.rows.iter());
    let with_yes = count.0.values().filter(|[_, yes]| *yes > 0).count();
    let of = |value: &dyn Fn(&Validated) -> String| f.validated.as_ref().map_or("-".to_string(), value);
    format!(
        "| {} | {} | {with_yes} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
        f.question.name,
        count.0.len(),
        count.places(),
        count.yes(),
        f.used.len(),
        f.review.len(),
        of(&|v| format!("{:.3}", v.cost())),
        of(&|v| format!("{:.3}", v.held_cost())),
        of(&|v| format!("{}, {}", v.errors[0], v.errors[1])),
        of(&|v| format!("{}, {}", v.held_errors[0], v.held_errors[1])),
        of(&|v| v.open.to_string()),
        of(&|v| format!("{:.3}", v.brier())),
    )
}

fn section(f: &Found) -> String {
    let mut text = format!("\n## {}\n\n{}\n\n", f.question.name, f.question.words);
    if let Some(why) = &f.silent {
        let _ = writeln!(text, "No rules: {why}.");
    }
    for draft in &f.used {
        let s = &draft.statistics;
        let _ = writeln!(
            text,
            "- `{}`: `{}`; right at {} of {} places of {} buildings, confidence {:.2}",
            draft.id,
            beside(f.question, &draft.when),
            s.right,
            s.places,
            s.buildings,
            s.confidence
        );
    }
    if let Some(validated) = f.validated.as_ref().filter(|v| !v.predictions.is_empty()) {
        text += &calibration(validated);
    }
    text
}

/// A condition without what all rules of the question have.
fn beside(question: &Question, when: &str) -> String {
    let own = when.strip_prefix(&question.common()).unwrap_or(when);
    let own = own.strip_prefix(" and ").unwrap_or(own);
    if own.is_empty() { "always".to_string() } else { own.to_string() }
}

/// Probabilities that were told of places of buildings not learned from, against how many were a yes there.
fn calibration(validated: &Validated) -> String {
    let mut text = String::from(
        "\nProbabilities told of buildings not learned from:\n\n| told | places | yes |\n|---|---|---|\n",
    );
    for k in 0..5 {
        let (low, high) = (0.2 * f64::from(k), 0.2 * f64::from(k + 1));
        let inside = |p: &&(f64, usize, bool)| low <= p.0 && (p.0 < high || k == 4);
        let own: Vec<_> = validated.predictions.iter().filter(inside).collect();
        if !own.is_empty() {
            let yes = own.iter().filter(|p| p.2).count() as f64 / own.len() as f64;
            let _ = writeln!(text, "| {low:.1} to {high:.1} | {} | {yes:.2} |", own.len());
        }
    }
    text
}

/// Which ratio of demand to capacity separates buildings that stand from those that fall.
fn falls_or_stands(cases: &[Case]) -> String {
    let mut text = String::from(
        "\n## Falls or stands\n\nThe largest elastic demand over capacity among the column ends, of buildings that stand and of those that fall. GSA 2003 takes 2.0 as the limit for the section of reinforced concrete.\n\n\
         | feature | largest that stands | smallest that falls | wrong at 2.0 | falls without an elastic state |\n|---|---|---|---|---|\n",
    );
    for feature in ["building.demand_ratio", "building.law_demand_ratio"] {
        let of =
            |case: &&Case| Some((case.known.members.first()?.number(feature)?, case.study.facts.collapsed));
        let known: Vec<(f64, bool)> = cases.iter().filter_map(|c| of(&c)).collect();
        let stands = known.iter().filter(|k| !k.1).map(|k| k.0).reduce(f64::max);
        let falls = known.iter().filter(|k| k.1).map(|k| k.0).reduce(f64::min);
        let wrong = known.iter().filter(|k| (k.0 > 2.0) != k.1).count();
        let unknown = cases.iter().filter(|c| of(c).is_none() && c.study.facts.collapsed).count();
        let number = |x: Option<f64>| x.map_or("-".to_string(), |x| format!("{x:.3}"));
        let _ = writeln!(
            text,
            "| `{feature}` | {} | {} | {wrong} of {} | {unknown} |",
            number(stands),
            number(falls),
            known.len()
        );
    }
    text
}

fn strain_rates(rates: &[Rate]) -> String {
    let mut text = String::from(
        "\n## Strain rate\n\nThe largest strain rate at an end against whether it turned by more than 0.02 rad in the whole run. The threshold is the one of least cost; its range is that of the thresholds with one building left out at a time. \
         A rate needs an FE run, so that no rule of a generated model can ask for it; the threshold is for those who read records.\n\n\
         | ends | number | turned | threshold [1/s] | range [1/s] | misses, false alarms | at the critical rate | misses, false alarms |\n|---|---|---|---|---|---|---|---|\n",
    );
    for r in rates {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {:.2} | {:.2} to {:.2} | {}, {} | {:.2} | {}, {} |",
            r.kind,
            r.ends[0],
            r.ends[1],
            r.best_1_s,
            r.range_1_s[0],
            r.range_1_s[1],
            r.errors[0],
            r.errors[1],
            r.critical_1_s,
            r.errors_at_critical[0],
            r.errors_at_critical[1]
        );
    }
    text
}
