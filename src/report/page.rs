//! Tables and figures of the page, as the template wants them.

use super::ReportError;
use super::chart::{escape, seconds};
use super::codec::base64;
use super::input::{
    ComparedRun, HingeSite, History, LeftOutRow, ReportInput, ReviewRow, ReviewSummary, RunCost, Severity,
    Status, TimedEvent,
};
use super::number::{MISSING, count, duration, fixed, significant};
use super::{alone, figures, partition, plan, plots, scene};
use crate::base::vector::{norm, sub};
use minijinja::{AutoEscape, Environment, syntax::SyntaxConfig};
use serde::Serialize;
use serde_json::json;

const PAGE: &str = include_str!("templates/page.html");
const STYLE: &str = include_str!("templates/style.css");
const CHARTS: &str = include_str!("templates/charts.js");
const VIEWER: &str = concat!(include_str!("templates/shaders.js"), include_str!("templates/viewer.js"));

/// Most subjects of a decision that are shown.
const SUBJECTS_SHOWN: usize = 4;

/// "A, B and 3 more".
fn some_of(list: &[String]) -> String {
    match list.len() {
        n if n > SUBJECTS_SHOWN => {
            format!("{} and {} more", list[..SUBJECTS_SHOWN].join(", "), n - SUBJECTS_SHOWN)
        }
        _ => list.join(", "),
    }
}

/// Decisions worth a look.
fn review(review: &ReviewSummary) -> serde_json::Value {
    let about = |row: &ReviewRow| match row.about.len() {
        0 => "the model".to_string(),
        _ => some_of(&row.about),
    };
    let rows: Vec<_> = review
        .rows
        .iter()
        .map(|r| (about(r), &r.decision, &r.why, &r.otherwise, &r.change, r.counts == Some(true)))
        .collect();
    json!({ "runs": review.runs, "asked": review.most_runs > 0, "rows": rows })
}

/// The page.
pub fn render(input: &ReportInput) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    let syntax =
        SyntaxConfig::builder().trim_blocks(true).lstrip_blocks(true).keep_trailing_newline(true).build()?;
    environment.set_syntax(syntax);
    environment.add_filter("code", |text: minijinja::Value| {
        minijinja::Value::from_safe_string(code(&text.to_string()))
    });
    environment.add_template("page", PAGE)?;
    let packed = input.scene.as_ref().map(|s| scene::pack(s, &input.hinge_sites)).transpose()?;
    let contact_s = input.error.as_ref().and_then(|e| e.contact_s);
    let points = if input.mbs_alone { Vec::new() } else { points(&input.histories, contact_s)? };
    let energy = plots::energy_charts(input)?;
    let text = environment.get_template("page")?.render(template_value(json!({
        "style": STYLE,
        "charts_js": CHARTS,
        "viewer_js": VIEWER,
        "title": if input.title.is_empty() { "MBS against FE" } else { input.title.as_str() },
        "stands": input.stands,
        "building": input.building_name,
        "description": input.building_description,
        "version": input.program_version,
        "verdict": json!({
            "headline": input.verdict.headline, "detail": input.verdict.detail, "status": word(input.verdict.status),
        }),
        "tally": tally(input),
        "checks": input.checks.iter().map(|c| json!({
            "label": c.label, "value": c.value, "limit": c.limit, "status": word(c.status), "explanation": c.explanation,
        })).collect::<Vec<_>>(),
        "figures": if input.mbs_alone { figures::alone(input) } else { figures::compared(input) },
        "alone": input.mbs_alone.then(|| alone::section(input)).transpose()?,
        "compared": input.compared.iter().map(compared).collect::<Vec<_>>(),
        "compared_notes": input.compared_notes,
        "partition": input.partition.as_ref().map(|p| partition::section(p, &input.first_contact)).transpose()?,
        "blasting": input.blasting.as_ref().map(plan::blasting),
        "debris": input.debris.as_ref().map(plan::debris),
        "has_hybrid": input.histories.iter().any(|h| !h.hybrid_m.is_empty()),
        "scene": packed.as_ref().map(|p| json!({
            "head": script_json(&p.head), "data": base64(&p.bytes), "groups": p.groups,
            "step": p.step_m.map(|s| format!("{} mm", significant(1e3 * s, 2))),
            "fixed": input.scene.iter().filter_map(|s| s.mbs.as_ref()).any(|m| !m.fixed.is_empty()),
            "obstacles": input.scene.iter().any(|s| !s.obstacles.is_empty()),
            "strain": p.max_plastic_strain.map(|s| significant(s, 2)),
        })),
        "error_chart": plots::error_chart(input)?,
        "touches": input.error.as_ref().is_some_and(|e| e.contact_s.is_some()),
        "points": points,
        "sites": input.hinge_sites.iter().map(site).collect::<Vec<_>>(),
        "agreement": agreement(&input.hinge_sites),
        "slight": input.hinge_sites.iter().filter(|s| s.mbs_slight_s.is_some()).count(),
        "counted_rad": input.counted_rotation_rad.map(|r| significant(r, 2)),
        "energy": json!({ "fe": energy.fe, "mbs": energy.mbs, "residuals": energy.residuals }),
        "review": review(&input.review),
        "left_out": input.left_out.iter().map(left_out).collect::<Vec<_>>(),
        "left_out_note": input.left_out_note,
        "run_columns": run_columns(input),
        "runs": runs(input),
        "model": model(input),
        "curves": input.curves.iter().map(plots::curve_chart).collect::<Vec<_>>(),
        "warnings": notes(input, Severity::Warning),
        "notes": notes(input, Severity::Note),
        "events": events(input),
        "settings": input.settings.iter().map(|s| (&s.name, &s.value)).collect::<Vec<_>>(),
    })))?;
    Ok(text)
}

/// Text for HTML in which what stands between backticks is code.
fn code(text: &str) -> String {
    let mut parts = text.split('`').map(escape);
    let mut out = parts.next().unwrap_or_default();
    // a backtick without its second one stays
    while let Some(inner) = parts.next() {
        match parts.next() {
            Some(after) => out += &format!("<code>{inner}</code>{after}"),
            None => out += &format!("`{inner}"),
        }
    }
    out
}

/// JSON as a value of the template engine.
fn template_value(json: serde_json::Value) -> minijinja::Value {
    use serde_json::Value;
    match json {
        Value::Null => ().into(),
        Value::Bool(b) => b.into(),
        Value::Number(n) => n.as_i64().map_or_else(|| n.as_f64().unwrap_or(f64::NAN).into(), Into::into),
        Value::String(s) => s.into(),
        Value::Array(list) => list.into_iter().map(template_value).collect(),
        Value::Object(map) => {
            minijinja::Value::from_pairs(map.into_iter().map(|(k, v)| (k, template_value(v))))
        }
    }
}

/// JSON that cannot end a script element.
fn script_json(value: &serde_json::Value) -> String {
    value
        .to_string()
        .replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

fn word(status: Status) -> &'static str {
    match status {
        Status::Pass => "pass",
        Status::Fail => "fail",
        Status::Unknown => "unknown",
    }
}

/// "5 of 7 checks passed, 1 failed, 1 undecided": counted here, whatever the headline says.
fn tally(input: &ReportInput) -> Option<String> {
    let number = |s: Status| input.checks.iter().filter(|c| c.status == s).count();
    let mut text = format!("{} of {} checks passed", number(Status::Pass), input.checks.len());
    for (n, word) in [(number(Status::Fail), "failed"), (number(Status::Unknown), "undecided")] {
        if n > 0 {
            text.push_str(&format!(", {n} {word}"));
        }
    }
    (!input.checks.is_empty()).then_some(text)
}

pub(super) fn optional(x: Option<f64>, digits: usize) -> String {
    x.map_or(MISSING.into(), |x| significant(x, digits))
}

pub(super) fn optional_time(t: Option<f64>) -> String {
    t.map_or(MISSING.into(), |t| fixed(t, 3))
}

/// A tracked point with its charts.
#[derive(Serialize)]
struct Point {
    name: String,
    fe_max: String,
    mbs_max: String,
    until_contact: String,
    overall: String,
    hybrid: Option<[String; 2]>,
    debris: Option<String>,
    when: String,
    relative: String,
    charts: [String; 3],
    worst: bool,
}

/// The tracked points; the one with the largest deviation is marked.
fn points(histories: &[History], contact_s: Option<f64>) -> Result<Vec<Point>, ReportError> {
    let mut out = Vec::new();
    let mut worst = (0, f64::NEG_INFINITY);
    for history in histories {
        let charts = plots::history_charts(history)?;
        let largest =
            |u: &[[f64; 3]]| u.iter().copied().map(norm).filter(|x| x.is_finite()).fold(f64::NAN, f64::max);
        let deviation_of = |other: &[[f64; 3]], until: f64| {
            let rows = history.time_s.iter().zip(history.fe_m.iter().zip(other));
            rows.filter(|(t, _)| **t <= until)
                .map(|(t, (a, b))| (*t, norm(sub(*a, *b))))
                .filter(|x| x.1.is_finite())
                .fold((f64::NAN, f64::NAN), |best, x| if best.1 >= x.1 { best } else { x })
        };
        let deviation = |until: f64| deviation_of(&history.mbs_m, until);
        let overall = deviation(f64::INFINITY);
        let contact = |deviation: f64| contact_s.map_or(MISSING.into(), |_| significant(deviation, 3));
        let hybrid = (!history.hybrid_m.is_empty()).then(|| {
            let until = |t: f64| deviation_of(&history.hybrid_m, t).1;
            [contact(until(contact_s.unwrap_or(f64::INFINITY))), significant(until(f64::INFINITY), 3)]
        });
        if overall.1 > worst.1 {
            worst = (out.len(), overall.1);
        }
        let fe_max = largest(&history.fe_m);
        out.push(Point {
            name: history.point.clone(),
            fe_max: significant(fe_max, 3),
            mbs_max: significant(largest(&history.mbs_m), 3),
            until_contact: contact(deviation(contact_s.unwrap_or(f64::INFINITY)).1),
            overall: significant(overall.1, 3),
            hybrid,
            debris: history.debris_s.map(seconds),
            when: fixed(overall.0, 2),
            relative: share_of(overall.1, fe_max),
            charts,
            worst: false,
        });
    }
    if let Some(point) = out.get_mut(worst.0) {
        point.worst = true;
    }
    Ok(out)
}

/// A deviation in per cent of the largest displacement; beyond ten times of it the figure says no more than that.
fn share_of(deviation: f64, largest: f64) -> String {
    let share = deviation / largest;
    match share {
        s if s > 10.0 => "> 1000 %".into(),
        s if s.is_finite() => format!("{} %", significant(100.0 * s, 2)),
        _ => MISSING.into(),
    }
}

/// What FE and MBS say about the sites together.
#[derive(Serialize)]
pub(super) struct Agreement {
    pub(super) both: usize,
    pub(super) fe_only: usize,
    pub(super) mbs_only: usize,
    neither: usize,
    unknown: usize,
    no_hinge: usize,
    precision: String,
    recall: String,
    f1: String,
}

pub(super) fn agreement(sites: &[HingeSite]) -> Option<Agreement> {
    let number = |fe: Option<bool>, yielded: bool| {
        sites.iter().filter(|s| s.fe_zone == fe && s.mbs_yielded_s.is_some() == yielded).count()
    };
    let (both, fe_only) = (number(Some(true), true), number(Some(true), false));
    let (mbs_only, neither) = (number(Some(false), true), number(Some(false), false));
    let share = |a: usize, b: usize| if b > 0 { fixed(a as f64 / b as f64, 2) } else { MISSING.into() };
    (!sites.is_empty()).then(|| Agreement {
        both,
        fe_only,
        mbs_only,
        neither,
        unknown: sites.iter().filter(|s| s.fe_zone.is_none()).count(),
        no_hinge: sites.iter().filter(|s| s.fe_zone == Some(true) && !s.mbs_hinge).count(),
        precision: share(both, both + mbs_only),
        recall: share(both, both + fe_only),
        f1: share(2 * both, 2 * both + fe_only + mbs_only),
    })
}

/// A row of the hinge table.
fn site(s: &HingeSite) -> serde_json::Value {
    let (class, mark, words) = match (s.fe_zone, s.mbs_yielded_s.is_some()) {
        (Some(true), true) => ("pass", "●", "both"),
        (Some(true), false) if !s.mbs_hinge => ("fail", "▲", "FE only, no hinge there"),
        (Some(true), false) if s.mbs_slight_s.is_some() => ("fail", "▲", "FE, MBS slightly"),
        (Some(true), false) => ("fail", "▲", "FE only"),
        (Some(false), true) => ("warn", "■", "MBS only"),
        (Some(false), false) => ("calm", "○", "neither"),
        (None, _) => ("unknown", "?", "FE not evaluated"),
    };
    let zone = match s.fe_zone {
        Some(true) => "yes",
        Some(false) => "no",
        None => MISSING,
    };
    json!({
        "name": s.member_end, "class": class, "mark": mark, "words": words, "zone": zone,
        "fe_first": optional_time(s.fe_first_s),
        "fe_rate": optional(s.fe_peak_strain_rate_1_s, 3),
        "fe_strain": optional(s.fe_max_plastic_strain, 3),
        "hinge": placed(s),
        "mbs_first": s.mbs_slight_s.map_or_else(|| optional_time(s.mbs_yielded_s), |t| format!("{} (slightly)", fixed(t, 3))),
        "mbs_rotation": optional(s.mbs_max_plastic_rotation_rad, 3),
        "mbs_fractured": optional_time(s.mbs_fractured_s),
    })
}

/// Whether the MBS has a hinge at a site, and from when on.
fn placed(s: &HingeSite) -> String {
    match (s.mbs_hinge, s.mbs_latent, s.mbs_live_s) {
        (false, ..) => "no".into(),
        (true, false, _) => "yes".into(),
        (true, true, None) => "latent".into(),
        (true, true, Some(t)) => format!("latent, live from {}", seconds(t)),
    }
}

/// A row of the table that compares all runs.
fn compared(run: &ComparedRun) -> [String; 10] {
    let percent = |share: Option<f64>, digits| {
        share.map_or(MISSING.into(), |s| format!("{} %", significant(100.0 * s, digits)))
    };
    [
        run.name.clone(),
        optional(run.until_contact, 2),
        optional(run.after_contact, 2),
        optional(run.until_end, 2),
        optional(run.without_debris, 2),
        run.first_contact_s.map_or("none".into(), |t| fixed(t, 3)),
        run.cpu_s.map_or(MISSING.into(), duration),
        percent(run.cpu_share, 2),
        percent(run.energy_error, 2),
        percent(run.footprint_overlap, 2),
    ]
}

/// Head of the run time table.
fn run_columns(input: &ReportInput) -> Vec<&'static str> {
    let hybrid = input.hybrid_run.is_some().then_some("hybrid");
    ["", "FE"].into_iter().chain(hybrid).chain(["MBS", "FE over MBS"]).collect()
}

/// The run time table: label, FE, hybrid if there was such a run, MBS, FE over MBS.
fn runs(input: &ReportInput) -> Vec<Vec<String>> {
    if input.fe_run.is_none() && input.mbs_run.is_none() {
        return Vec::new();
    }
    let (fe, mbs) = (input.fe_run.clone().unwrap_or_default(), input.mbs_run.clone().unwrap_or_default());
    let hybrid = input.hybrid_run.as_ref();
    let ratio = |a: Option<f64>, b: Option<f64>| {
        let r = a.zip(b).map(|(a, b)| a / b).filter(|r| r.is_finite());
        r.map_or(MISSING.into(), |r| format!("{} ×", significant(r, 2)))
    };
    let row = |label: &str, texts: [String; 2], between: Option<String>, ratio: String| {
        let [a, b] = texts;
        [label.to_string(), a].into_iter().chain(between).chain([b, ratio]).collect::<Vec<String>>()
    };
    let time = |label, of: fn(&RunCost) -> Option<f64>| {
        let text = |run: &RunCost| of(run).map_or(MISSING.into(), duration);
        row(label, [text(&fe), text(&mbs)], hybrid.map(text), ratio(of(&fe), of(&mbs)))
    };
    let number = |label, of: fn(&RunCost) -> Option<u64>| {
        let text = |run: &RunCost| of(run).map_or(MISSING.into(), count);
        let wide = |run: &RunCost| of(run).map(|n| n as f64);
        row(label, [text(&fe), text(&mbs)], hybrid.map(text), ratio(wide(&fe), wide(&mbs)))
    };
    vec![
        time("CPU time", |r| r.cpu_s),
        time("Wall time", |r| r.wall_s),
        number("Threads", |r| r.threads),
        number("Steps", |r| r.steps),
        time("Mean step", |r| r.step_s),
        number("Elements / bodies", |r| r.parts),
        number("Degrees of freedom", |r| r.dofs),
    ]
}

/// A row of the table of what was left out.
fn left_out(row: &LeftOutRow) -> [String; 6] {
    let share = if row.of > 0 { 100.0 * row.left_out as f64 / row.of as f64 } else { f64::NAN };
    [
        row.run.clone(),
        row.what.clone(),
        format!("{} %", fixed(share, 2)),
        count(row.left_out),
        format!("{} {}", count(row.of), row.unit),
        row.computed_by.clone().unwrap_or(MISSING.into()),
    ]
}

fn model(input: &ReportInput) -> serde_json::Value {
    let m = &input.model;
    let mass: f64 = m.bodies.iter().map(|b| b.mass_kg).sum();
    json!({
        "bodies": m.bodies.iter().map(|b| (&b.id, fixed(b.mass_kg / 1e3, 2), b.members.join(", "))).collect::<Vec<_>>(),
        "mass": format!("{} t", fixed(mass / 1e3, 1)),
        "joints": m.joints.iter().map(|j| (&j.id, &j.joins, &j.kind, j.curves.join(", "))).collect::<Vec<_>>(),
        "entries": m.entries.iter().map(|e| (&e.key, &e.description, count(e.uses))).collect::<Vec<_>>(),
        "rules": m.rules.iter().map(|r| (&r.id, &r.text, count(r.fired), r.out_of_range)).collect::<Vec<_>>(),
        "event_rules": m.event_rules.iter().map(|r| (&r.id, &r.text, some_of(&r.about), &r.remains, &r.then, &r.fired)).collect::<Vec<_>>(),
        "trace": m.trace.iter().map(|t| (&t.part, &t.rule, &t.words, t.entries.join(", "))).collect::<Vec<_>>(),
    })
}

fn notes(input: &ReportInput, severity: Severity) -> Vec<&str> {
    input.notes.iter().filter(|n| n.severity == severity).map(|n| n.text.as_str()).collect()
}

/// Time, run, unless there is one alone, and what happened.
fn events(input: &ReportInput) -> Vec<Vec<String>> {
    let run = |name: &String| (!input.mbs_alone).then(|| name.clone());
    let row = |e: &TimedEvent| [Some(fixed(e.time_s, 3)), run(&e.run), Some(e.what.clone())];
    input.events.iter().map(|e| row(e).into_iter().flatten().collect()).collect()
}
