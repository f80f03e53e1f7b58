//! `fallwerk library diff`: in what two entries differ.

use super::library::{Failure, report};
use crate::base::piecewise::interpolate;
use crate::base::units::round_to_digits;
use crate::library::Entry;
use crate::library::entry::EnvelopeLevel;
use serde_json::{Value, json};
use std::io::{self, Write};

/// One difference.
struct Difference {
    path: String,
    first: Value,
    second: Value,
}

/// Runs the command: words and numbers one by one, curves by their peaks and by the largest distance of the lines.
pub(super) fn run(first: &Entry, second: &Entry, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    let value = |entry: &Entry| -> io::Result<Value> {
        let mut value = serde_json::to_value(entry).map_err(io::Error::from)?;
        if let Value::Object(members) = &mut value {
            // Curves are compared below; the rest says the same in other words.
            for name in ["axes", "springs", "key"] {
                members.remove(name);
            }
        }
        Ok(value)
    };
    let mut found = Vec::new();
    walk("", &value(first)?, &value(second)?, &mut found);
    let curves = curves(first, second);
    if json {
        let rows: Vec<Value> =
            found.iter().map(|d| json!({ "path": d.path, "first": d.first, "second": d.second })).collect();
        let value =
            json!({ "first": first.key, "second": second.key, "differences": rows, "curves": curves });
        return report(true, out, value, "");
    }
    writeln!(out, "first   {}\nsecond  {}", first.key, second.key)?;
    if found.is_empty() && curves.iter().all(|c| c.distance == Some(0.0)) {
        writeln!(out, "no difference")?;
        return Ok(0);
    }
    for d in &found {
        writeln!(out, "  {:<44}  {}  ->  {}{}", d.path, short(&d.first), short(&d.second), change(d))?;
    }
    if !curves.is_empty() {
        writeln!(
            out,
            "  axis   N [kN]   M_max first   second [kN m]   change   largest distance of the lines / M_max"
        )?;
    }
    for c in &curves {
        let peak = |m: Option<f64>| m.map_or("-".to_string(), |m| format!("{:.2}", m / 1e3));
        let share = |x: Option<f64>| x.map_or("-".to_string(), |x| format!("{:+.2} %", 100.0 * x));
        let ratio = c.first_peak_nm.zip(c.second_peak_nm).map(|(a, b)| b / a - 1.0);
        writeln!(
            out,
            "  {:>4} {:>8.1} {:>13} {:>15} {:>8}   {}",
            c.axis,
            c.axial_force_n / 1e3,
            peak(c.first_peak_nm),
            peak(c.second_peak_nm),
            share(ratio),
            c.distance.map_or("-".to_string(), |d| format!("{:.2} %", 100.0 * d))
        )?;
    }
    Ok(0)
}

/// Numbers that differ by rounding only.
fn near(a: Option<f64>, b: Option<f64>) -> bool {
    matches!((a, b), (Some(a), Some(b)) if (a - b).abs() <= 1e-9 * a.abs().max(b.abs()))
}

/// The leaves in which two values differ.
fn walk(path: &str, a: &Value, b: &Value, found: &mut Vec<Difference>) {
    match (a, b) {
        (Value::Object(x), Value::Object(y)) => {
            let mut names: Vec<&String> = x.keys().chain(y.keys()).collect();
            names.sort();
            names.dedup();
            for name in names {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                walk(&path, x.get(name).unwrap_or(&Value::Null), y.get(name).unwrap_or(&Value::Null), found);
            }
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            for (i, (a, b)) in x.iter().zip(y).enumerate() {
                walk(&format!("{path}[{i}]"), a, b, found);
            }
        }
        _ if a == b => {}
        (Value::Number(x), Value::Number(y)) if near(x.as_f64(), y.as_f64()) => {}
        _ => found.push(Difference { path: path.to_string(), first: a.clone(), second: b.clone() }),
    }
}

fn short(value: &Value) -> String {
    let text = match value {
        Value::Null => "absent".to_string(),
        Value::String(text) => text.clone(),
        Value::Number(number) => {
            number.as_f64().map_or(number.to_string(), |x| round_to_digits(x, 6).to_string())
        }
        other => other.to_string(),
    };
    if text.chars().count() > 48 { text.chars().take(47).chain(['…']).collect() } else { text }
}

fn change(d: &Difference) -> String {
    match (d.first.as_f64(), d.second.as_f64()) {
        (Some(a), Some(b)) if a != 0.0 && (b / a).abs() < 1e3 => {
            format!("  ({:+.2} %)", 100.0 * (b / a - 1.0))
        }
        _ => String::new(),
    }
}

/// Two envelopes of one axis and axial force.
#[derive(serde::Serialize)]
struct CurvePair {
    axis: usize,
    axial_force_n: f64,
    first_peak_nm: Option<f64>,
    second_peak_nm: Option<f64>,
    /// Largest difference of the moments up to the smaller last rotation, over the larger peak.
    distance: Option<f64>,
}

fn curves(first: &Entry, second: &Entry) -> Vec<CurvePair> {
    let mut pairs = Vec::new();
    let none: Vec<EnvelopeLevel> = Vec::new();
    for axis in 0..first.axes.len().max(second.axes.len()) {
        let levels = |entry: &Entry| entry.axes.get(axis).map_or(none.clone(), |a| a.envelopes.clone());
        let (a, b) = (levels(first), levels(second));
        let mut forces: Vec<f64> = a.iter().chain(&b).map(|l| l.axial_force_n).collect();
        forces.sort_by(f64::total_cmp);
        forces.dedup_by(|x, y| same(*x, *y));
        for force in forces {
            let at = |levels: &[EnvelopeLevel]| levels.iter().find(|l| same(l.axial_force_n, force)).cloned();
            let (x, y) = (at(&a), at(&b));
            let peak = |l: &Option<EnvelopeLevel>| {
                l.as_ref().map(|l| l.points.iter().map(|p| p[1]).fold(0.0, f64::max))
            };
            pairs.push(CurvePair {
                axis: axis + 1,
                axial_force_n: force,
                first_peak_nm: peak(&x),
                second_peak_nm: peak(&y),
                distance: x.zip(y).map(|(x, y)| distance(&x.points, &y.points)),
            });
        }
    }
    pairs
}

/// Axial forces that differ by rounding only.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

fn distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    let end = |points: &[[f64; 2]]| points.last().map_or(0.0, |p| p[0]);
    let reach = end(a).min(end(b));
    let peak = a.iter().chain(b).map(|p| p[1].abs()).fold(f64::MIN_POSITIVE, f64::max);
    let places = a.iter().chain(b).map(|p| p[0]).filter(|x| *x <= reach);
    places.map(|x| (interpolate(a, x) - interpolate(b, x)).abs()).fold(0.0, f64::max) / peak
}
