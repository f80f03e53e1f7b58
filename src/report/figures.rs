//! The key figures in the head of the page.

use super::chart::seconds;
use super::input::{HingeSite, ReportInput, RunCost};
use super::number::{MISSING, duration, fixed, significant};
use super::page::{agreement, optional};
use serde::Serialize;

/// A key figure of the head.
#[derive(Serialize)]
pub(super) struct Figure {
    label: &'static str,
    value: String,
    unit: &'static str,
    note: String,
}

/// What is left of rounding is no displacement: figures end here \[m\].
pub(super) const NOISE_M: f64 = 1e-6;

/// How near the MBS run is to FE.
pub(super) fn compared(input: &ReportInput) -> Vec<Figure> {
    let mut out = Vec::new();
    if let Some(s) = &input.standing {
        // all in the unit of the largest
        let (factor, unit) = if s.apart_m < 1e-4 { (1e6, "µm") } else { (1e3, "mm") };
        let figure = |m: f64, digits: usize| match factor * m {
            x if x < 1e-3 => "< 0.001".into(),
            x => significant(x, digits),
        };
        let [fe, mbs] = s.largest_m.map(|m| figure(m, 3));
        let note = format!("FE {fe} {unit}, MBS {mbs} {unit}; limit {} mm", significant(1e3 * s.limit_m, 2));
        let value = figure(s.apart_m, 2);
        out.push(Figure { label: "Largest distance of displacements", value, unit, note });
    } else if let Some(e) = &input.error {
        let limit = |l: Option<f64>| l.map_or(String::new(), |l| format!("limit {}", significant(l, 2)));
        let (label, value) = ("Error e up to first contact", optional(e.until_contact, 2));
        out.push(Figure { label, value, unit: "", note: limit(e.limit_until_contact) });
        let (label, value) = ("Error e up to the end", optional(e.until_end, 2));
        out.push(Figure { label, value, unit: "", note: limit(e.limit_until_end) });
    }
    let contact = &input.first_contact;
    if contact.fe_s.is_some() || contact.mbs_s.is_some() {
        let (value, unit) = match (contact.fe_s, contact.mbs_s) {
            (Some(fe), Some(mbs)) if (mbs - fe).is_finite() => {
                let sign = if mbs > fe { "+" } else { "" };
                (format!("{sign}{}", fixed(1e3 * (mbs - fe), 0)), "ms")
            }
            _ => (MISSING.into(), ""),
        };
        let note = format!("FE {}, MBS {}", contact_text(contact.fe_s), contact_text(contact.mbs_s));
        out.push(Figure { label: "First contact, MBS − FE", value, unit, note });
    }
    if let Some(a) = agreement(&input.hinge_sites).filter(|a| a.both + a.fe_only + a.mbs_only > 0) {
        let value = format!("{} of {}", a.both, a.both + a.fe_only);
        let note = format!("{} yielded in MBS only", a.mbs_only);
        out.push(Figure { label: "FE zones found as hinges", value, unit: "", note });
    }
    if let Some((ratio, basis)) = speed_ratio(input) {
        let note =
            format!("FE {}, MBS {} ({basis})", time_of(&input.fe_run, basis), time_of(&input.mbs_run, basis));
        out.push(Figure { label: "MBS faster than FE by", value: significant(ratio, 2), unit: "×", note });
    }
    out
}

/// What the MBS run comes to.
pub(super) fn alone(input: &ReportInput) -> Vec<Figure> {
    let mut out = Vec::new();
    let (value, unit) = input.first_contact.mbs_s.map_or(("none".into(), ""), |t| (fixed(t, 3), "s"));
    out.push(Figure { label: "First ground contact", value, unit, note: String::new() });
    let largest = input.histories.iter().filter_map(|h| Some((h.largest_of_mbs()?, &h.point)));
    if let Some(((u, t), point)) = largest.reduce(|best, x| if best.0.0 >= x.0.0 { best } else { x }) {
        let (value, unit) = match u {
            u if u < NOISE_M => ("< 0.001".into(), "mm"),
            u if u < 0.1 => (significant(1e3 * u, 3), "mm"),
            u => (significant(u, 3), "m"),
        };
        let note = format!("{point}, {}", seconds(t));
        out.push(Figure { label: "Largest displacement", value, unit, note });
    }
    let sites = &input.hinge_sites;
    let number = |is: fn(&HingeSite) -> bool| sites.iter().filter(|s| is(s)).count();
    if !sites.is_empty() {
        let value = format!("{} of {}", number(|s| s.mbs_yielded_s.is_some()), sites.len());
        let note = format!("{} separate", number(|s| s.mbs_fractured_s.is_some()));
        out.push(Figure { label: "Hinges that yield", value, unit: "", note });
    }
    if let Some(debris) = input.debris.as_ref().and_then(|d| d.runs.first()) {
        let moves = if debris.speed_m_s.is_some() { ", still moving" } else { "" };
        let (value, note) =
            (fixed(debris.area_m2, 0), format!("up to {} m high{moves}", fixed(debris.top_m, 1)));
        out.push(Figure { label: "Area covered at the end", value, unit: "m²", note });
    }
    if let Some(error) = input.mbs_energy.as_ref().and_then(|e| e.error) {
        let (value, note) = (significant(100.0 * error, 2), "of the energy turned over".into());
        out.push(Figure { label: "Energy error", value, unit: "%", note });
    }
    out
}

fn contact_text(t: Option<f64>) -> String {
    t.map_or("none".into(), seconds)
}

fn time_of(run: &Option<RunCost>, basis: &str) -> String {
    let run = run.as_ref();
    let t = run.and_then(|r| if basis == "CPU" { r.cpu_s } else { r.wall_s });
    t.map_or(MISSING.into(), duration)
}

/// FE time over MBS time and what it compares: CPU time if both have it, else wall time.
fn speed_ratio(input: &ReportInput) -> Option<(f64, &'static str)> {
    let (fe, mbs) = (input.fe_run.as_ref()?, input.mbs_run.as_ref()?);
    let ratio =
        |a: Option<f64>, b: Option<f64>| a.zip(b).map(|(a, b)| a / b).filter(|r| r.is_finite() && *r > 0.0);
    ratio(fe.cpu_s, mbs.cpu_s).map(|r| (r, "CPU")).or(ratio(fe.wall_s, mbs.wall_s).map(|r| (r, "wall")))
}
