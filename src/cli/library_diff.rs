//! `fallwerk library diff`: in what two entries differ.

use super::library::{Failure, report};
use crate::base::piecewise::interpolate;
use crate::base::units::round_to_digits;
use crate::curve::ResistanceCurve;
use crate::library::Entry;
use crate::library::entry::{Direction, EnvelopeLevel};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
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
            // Curves and their numbers are compared below; the key says the same in other words.
            for name in ["axes", "springs", "key"] {
                members.remove(name);
            }
        }
        Ok(value)
    };
    let mut found = Vec::new();
    walk("", &value(first)?, &value(second)?, &mut found);
    let pairs = curves(first, second, &mut found);
    if json {
        let rows: Vec<Value> =
            found.iter().map(|d| json!({ "path": d.path, "first": d.first, "second": d.second })).collect();
        let curves: Vec<Value> = pairs.iter().map(Pair::to_json).collect();
        let value =
            json!({ "first": first.key, "second": second.key, "differences": rows, "curves": curves });
        return report(true, out, value, "");
    }
    writeln!(out, "first   {}\nsecond  {}", first.key, second.key)?;
    if found.is_empty() && pairs.iter().all(|pair| pair.distance == Some(0.0)) {
        writeln!(out, "no difference")?;
        return Ok(0);
    }
    for d in &found {
        writeln!(out, "  {:<44}  {}  ->  {}{}", d.path, short(&d.first), short(&d.second), change(d))?;
    }
    if !pairs.is_empty() {
        writeln!(
            out,
            "  {:<19} {:>8} {:>11} {:>11} {:<4} {:>9}   largest distance of the lines / peak",
            "curve", "N [kN]", "peak first", "second", "", "change"
        )?;
    }
    for pair in &pairs {
        let kilo = |peak: Option<f64>| peak.map_or("-".to_string(), |peak| format!("{:.2}", peak / 1e3));
        let [first, second] = pair.peaks;
        let ratio = first.zip(second).map(|(a, b)| b / a - 1.0);
        writeln!(
            out,
            "  {:<19} {:>8.1} {:>11} {:>11} {:<4} {:>9}   {}",
            pair.of.words(),
            pair.axial_force_n / 1e3,
            kilo(first),
            kilo(second),
            if pair.of.turns() { "kN m" } else { "kN" },
            ratio.map_or("-".to_string(), |x| format!("{:+.2} %", 100.0 * x)),
            pair.distance.map_or("-".to_string(), |d| format!("{:.2} %", 100.0 * d))
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

/// Which resistance of an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Of {
    /// Bending about an axis, counted from 0, in the first or in the other sense of rotation.
    Axis { index: usize, other_sense: bool },
    /// A spring.
    Spring(Direction),
}

impl Of {
    fn words(self) -> String {
        match self {
            Self::Axis { index, other_sense: false } => format!("axis {}", index + 1),
            Self::Axis { index, other_sense: true } => format!("axis {}, other sense", index + 1),
            Self::Spring(direction) => format!("{direction:?}").to_lowercase(),
        }
    }

    /// Where it stands in the record.
    fn path(self) -> String {
        match self {
            Self::Axis { index, other_sense: false } => format!("axes[{index}]"),
            Self::Axis { index, other_sense: true } => format!("axes[{index}].reverse"),
            Self::Spring(_) => format!("springs[{}]", self.words()),
        }
    }

    /// Whether it resists rotations.
    fn turns(self) -> bool {
        !matches!(self, Self::Spring(direction) if direction != Direction::Torsion)
    }
}

/// One resistance: its numbers by name, and a line at each axial force.
struct Resistance<'a> {
    numbers: Vec<(&'static str, Value)>,
    levels: Vec<Level<'a>>,
}

/// A line at one axial force, with its numbers by name.
struct Level<'a> {
    axial_force_n: f64,
    points: &'a [[f64; 2]],
    numbers: Vec<(&'static str, Option<f64>)>,
}

/// Two lines of one resistance and axial force.
struct Pair {
    of: Of,
    axial_force_n: f64,
    /// Largest moments or forces; none where an entry has no such line.
    peaks: [Option<f64>; 2],
    /// Largest difference of the lines where both are, over the larger peak.
    distance: Option<f64>,
}

impl Pair {
    fn to_json(&self) -> Value {
        let [first, second] = self.peaks;
        let (force, distance) = (self.axial_force_n, self.distance);
        match self.of {
            Of::Axis { index, other_sense } => json!({
                "axis": index + 1, "other_sense": other_sense, "axial_force_n": force,
                "first_peak_nm": first, "second_peak_nm": second, "distance": distance,
            }),
            Of::Spring(direction @ Direction::Torsion) => json!({
                "direction": direction, "axial_force_n": force,
                "first_peak_nm": first, "second_peak_nm": second, "distance": distance,
            }),
            Of::Spring(direction) => json!({
                "direction": direction, "axial_force_n": force,
                "first_peak_n": first, "second_peak_n": second, "distance": distance,
            }),
        }
    }
}

/// All lines of two entries side by side; the numbers of curves in which they differ are added to `found`.
fn curves(first: &Entry, second: &Entry, found: &mut Vec<Difference>) -> Vec<Pair> {
    let axes = || first.axes.iter().chain(&second.axes);
    // an entry between two others has no envelopes
    let measured = axes().all(|axis| !axis.envelopes.is_empty());
    let two_senses = |index: usize| {
        [first, second].iter().any(|e| e.axes.get(index).is_some_and(|axis| axis.reverse.is_some()))
    };
    let [first, second] = [first, second].map(|entry| resistances(entry, measured, &two_senses));
    let mut pairs = Vec::new();
    for of in first.keys().chain(second.keys()).copied().collect::<BTreeSet<Of>>() {
        let (a, b) = (first.get(&of), second.get(&of));
        let number = |resistance: Option<&Resistance>, name: &str| {
            let mut numbers = resistance.into_iter().flat_map(|r| &r.numbers);
            numbers.find(|(own, _)| *own == name).map_or(Value::Null, |(_, value)| value.clone())
        };
        for (name, _) in a.or(b).into_iter().flat_map(|r| &r.numbers) {
            walk(&format!("{}.{name}", of.path()), &number(a, name), &number(b, name), found);
        }
        pairs.extend(levels(of, [a, b].map(|r| r.map_or(&[][..], |r| r.levels.as_slice())), found));
    }
    pairs
}

/// The lines of one resistance side by side, by their axial forces.
fn levels(of: Of, [a, b]: [&[Level]; 2], found: &mut Vec<Difference>) -> Vec<Pair> {
    let mut forces: Vec<f64> = a.iter().chain(b).map(|level| level.axial_force_n).collect();
    forces.sort_by(f64::total_cmp);
    forces.dedup_by(|x, y| same(*x, *y));
    let mut pairs = Vec::new();
    for force in forces {
        let [x, y] = [a, b].map(|levels| levels.iter().find(|l| same(l.axial_force_n, force)));
        if let (Some(x), Some(y)) = (x, y) {
            let place = format!("{}[{} kN]", of.path(), round_to_digits(force / 1e3, 6));
            for ((name, p), (_, q)) in x.numbers.iter().zip(&y.numbers) {
                walk(&format!("{place}.{name}"), &json!(p), &json!(q), found);
            }
        }
        let peak = |level: &Level| level.points.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
        let distance = x.zip(y).and_then(|(x, y)| distance(x.points, y.points));
        pairs.push(Pair { of, axial_force_n: force, peaks: [x.map(peak), y.map(peak)], distance });
    }
    pairs
}

/// The resistances of an entry: hinges by their envelopes if these are `measured`, else by capacities over plastic rotations; axes of `two_senses`
/// in both senses of rotation, also where these do not differ.
fn resistances<'a>(
    entry: &'a Entry,
    measured: bool,
    two_senses: &impl Fn(usize) -> bool,
) -> BTreeMap<Of, Resistance<'a>> {
    let mut all = BTreeMap::new();
    for (index, axis) in entry.axes.iter().enumerate() {
        let own = bending(&axis.envelopes, &axis.curve, measured);
        all.insert(Of::Axis { index, other_sense: false }, own);
        if two_senses(index) {
            let (envelopes, curve) =
                axis.reverse.as_ref().map_or((&axis.envelopes, &axis.curve), |r| (&r.envelopes, &r.curve));
            all.insert(Of::Axis { index, other_sense: true }, bending(envelopes, curve, measured));
        }
    }
    for spring in &entry.springs {
        let levels = spring.levels.iter().map(|l| Level {
            axial_force_n: l.axial_force_n,
            points: &l.points,
            numbers: vec![
                ("fracture_displacement_m", l.fracture_displacement_m),
                ("dissipated_j", l.dissipated_j),
            ],
        });
        let numbers = vec![("stiffness_n_m", json!(spring.stiffness_n_m))];
        all.insert(Of::Spring(spring.direction), Resistance { numbers, levels: levels.collect() });
    }
    all
}

fn bending<'a>(envelopes: &'a [EnvelopeLevel], curve: &'a ResistanceCurve, measured: bool) -> Resistance<'a> {
    let level = |force: f64, points: &'a [[f64; 2]], fracture: Option<f64>| Level {
        axial_force_n: force,
        points,
        numbers: vec![("fracture_rotation_rad", fracture)],
    };
    let levels = if measured {
        envelopes.iter().map(|l| level(l.axial_force_n, &l.points, l.fracture_rotation_rad)).collect()
    } else {
        let levels = curve.levels.iter();
        levels.map(|l| level(l.axial_force_n, &l.capacity, Some(l.fracture_rotation_rad))).collect()
    };
    let numbers = vec![
        ("curve.stiffness_nm_rad", json!(curve.stiffness_nm_rad)),
        ("curve.cyclic", json!(curve.cyclic)),
    ];
    Resistance { numbers, levels }
}

/// Axial forces that differ by rounding only.
fn same(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1.0)
}

/// Largest difference of two lines where both are, over the larger peak; none if they have no place in common.
fn distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> Option<f64> {
    let first = |points: &[[f64; 2]]| points.first().map_or(0.0, |p| p[0]);
    let last = |points: &[[f64; 2]]| points.last().map_or(0.0, |p| p[0]);
    let common = first(a).max(first(b))..=last(a).min(last(b));
    let peak = a.iter().chain(b).map(|p| p[1].abs()).fold(f64::MIN_POSITIVE, f64::max);
    let places = a.iter().chain(b).map(|p| p[0]).filter(|x| common.contains(x));
    places.map(|x| (interpolate(a, x) - interpolate(b, x)).abs()).reduce(f64::max).map(|d| d / peak)
}
