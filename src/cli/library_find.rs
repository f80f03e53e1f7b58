//! `fallwerk library find`: the entry that fits best, one between two, or none.

use super::library::{Failure, report};
use crate::base::diagnostic::closest;
use crate::base::output::{is_within, may_write, write_atomic};
use crate::base::units::{Dimension, parse_quantity};
use crate::library::entry::{Adjoining, ColumnEnd};
use crate::library::features::{NUMBERS, NumberFeature};
use crate::library::{Answer, Entry, EntryKind, Origin, Query, Store};
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::PathBuf;

/// What to find.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Features as NAME=VALUE, such as `width=400mm concrete_strength=30MPa`
    #[arg(value_name = "NAME=VALUE", value_parser = number)]
    numbers: Vec<(String, f64)>,
    /// Kind of the entry
    #[arg(long, value_name = "KIND", value_parser = kind_of)]
    kind: EntryKind,
    /// Origin of its curves
    #[arg(long, value_name = "ORIGIN", value_parser = origin_of)]
    origin: Option<Origin>,
    /// Which end: top, bottom, lower, upper
    #[arg(long, value_name = "END", value_parser = end_of)]
    end: Option<ColumnEnd>,
    /// What the end is joined to: slab, beam, column, wall, ground
    #[arg(long, value_name = "MEMBER", value_parser = adjoining_of)]
    adjoining: Option<Adjoining>,
    /// Largest distance of an entry that is not exact; about the relative error of its moments
    #[arg(long, value_name = "D", default_value_t = 0.1, value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// Do not interpolate between two entries
    #[arg(long)]
    no_interpolation: bool,
    /// Write the record to a file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

fn of_name<T>(text: &str, found: Option<T>, names: &[&str]) -> Result<T, String> {
    found.ok_or_else(|| match closest(text, names.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("expected one of {}", names.join(", ")),
    })
}

/// A kind by its name.
pub(super) fn kind_of(text: &str) -> Result<EntryKind, String> {
    of_name(text, EntryKind::of_name(text), &EntryKind::ALL.map(EntryKind::name))
}

/// An origin by its name.
pub(super) fn origin_of(text: &str) -> Result<Origin, String> {
    of_name(text, Origin::of_name(text), &Origin::ALL.map(Origin::name))
}

fn end_of(text: &str) -> Result<ColumnEnd, String> {
    of_name(text, ColumnEnd::of_name(text), &["top", "bottom", "lower", "upper"])
}

fn adjoining_of(text: &str) -> Result<Adjoining, String> {
    of_name(text, Adjoining::of_name(text), &["slab", "beam", "column", "wall", "ground"])
}

/// A number in SI, or one with its unit.
pub(super) fn quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => parse_quantity(text, dimension)
            .map_err(|e| format!("{e}; write {} such as {}", dimension.noun(), dimension.example())),
    }
}

fn tolerance(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number >= 0.0 => Ok(number),
        _ => Err("a tolerance is a number from 0, such as 0.1".to_string()),
    }
}

fn number(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as `width=400mm`")?;
    match NumberFeature::meant_by(name.trim()) {
        Some(feature) => {
            let number = quantity(value, feature.dimension)?;
            if number > 0.0 {
                Ok((feature.name.to_string(), number))
            } else {
                Err(format!("`{}` is a positive number", feature.name))
            }
        }
        None => match closest(name, short_names().iter().map(String::as_str)) {
            Some(near) => Err(format!("there is no feature `{name}`; did you mean `{near}`?")),
            None => {
                let further = quantity(value, Dimension::Number).map(|x| (name.trim().to_string(), x));
                further.map_err(|_| no_feature(name))
            }
        },
    }
}

/// The names of the features without their place and unit.
fn short_names() -> Vec<String> {
    let last = NUMBERS.map(|f| f.name.rsplit('.').next().unwrap_or(f.name));
    last.map(|name| name.trim_end_matches("_pa").trim_end_matches("_m").to_string()).to_vec()
}

fn no_feature(name: &str) -> String {
    format!("there is no feature `{name}`; the features are {}", short_names().join(", "))
}

/// The numbers by name; a name twice, or one that no entry has, is an error.
fn named(numbers: &[(String, f64)], store: &Store) -> Result<BTreeMap<String, f64>, Failure> {
    let mut named = BTreeMap::new();
    for (name, value) in numbers {
        if named.insert(name.clone(), *value).is_some() {
            return Err(Failure::Usage(format!("`{name}` is asked for twice")));
        }
    }
    let further =
        |name: &str| store.list().map(|all| all.iter().any(|e| e.features.further.contains_key(name)));
    for name in named.keys().filter(|name| NUMBERS.iter().all(|f| f.name != name.as_str())) {
        if !further(name)? {
            return Err(Failure::Usage(no_feature(name)));
        }
    }
    Ok(named)
}

/// Runs the command.
pub(super) fn run(
    arguments: &Arguments,
    store: &Store,
    json: bool,
    out: &mut dyn Write,
) -> Result<u8, Failure> {
    let query = Query {
        kind: Some(arguments.kind),
        origin: arguments.origin,
        end: arguments.end,
        adjoining: arguments.adjoining,
        numbers: named(&arguments.numbers, store)?,
    };
    let answer = store.answer(&query, arguments.tolerance, !arguments.no_interpolation)?;
    let (code, mut words, mut value, entry) = told(&answer);
    let rivals = store.rivals(&query, &answer);
    if rivals.count > 0 {
        let names: Vec<&str> = rivals.differ.iter().map(String::as_str).collect();
        let what = match (&answer, rivals.count) {
            (Answer::Between(_), 1) => "another pair encloses".to_string(),
            (Answer::Between(_), count) => format!("{count} other pairs enclose"),
            (_, 1) => "another entry fits".to_string(),
            (_, count) => format!("{count} other entries fit"),
        };
        let (tell_apart, ask) = match names.as_slice() {
            [] => (
                "their features are the same".to_string(),
                "`library diff` compares their curves, `library deprecate` marks those not to be used",
            ),
            names => (format!("they differ in {}", names.join(", ")), "ask for these"),
        };
        match &answer {
            // zero of nothing is no match
            Answer::Entry(found) if asks_for_nothing(&query) => {
                words = format!(
                    "{}\n  one of {} entries of this kind, as nothing was asked for that tells them apart; {tell_apart}: {ask}{}",
                    found.entry.key,
                    rivals.count + 1,
                    if names.is_empty() { "" } else { " (NAME=VALUE)" }
                );
            }
            _ => {
                let too = if names.is_empty() { "" } else { " too" };
                words += &format!("\n  {what} it as well; {tell_apart}: {ask}{too}");
            }
        }
        value["rivals"] = json!({ "count": rivals.count, "differ": names });
    }
    if let (Some(path), Some(entry)) = (&arguments.output, entry) {
        may_write(path, &["json"], &[]).map_err(Failure::Usage)?;
        if is_within(path, store.folder()) {
            let (path, folder) = (path.display(), store.folder().display());
            return Err(Failure::Usage(format!(
                "{path} is in the library {folder}, whose records commands keep; name a file elsewhere"
            )));
        }
        let text = entry.to_text().map_err(io::Error::from)?;
        write_atomic(path, text.as_bytes())
            .map_err(|e| Failure::Usage(format!("{}: {e}", path.display())))?;
    }
    report(json, out, value, &words)?;
    Ok(code)
}

fn asks_for_nothing(query: &Query) -> bool {
    query.numbers.is_empty() && query.origin.is_none() && query.end.is_none() && query.adjoining.is_none()
}

fn told(answer: &Answer) -> (u8, String, Value, Option<&Entry>) {
    match answer {
        Answer::Entry(found) => {
            let (key, fit) = (&found.entry.key, &found.fit);
            let words = format!("{key}\n  distance {:.4}: {}", fit.distance, fit.reason);
            let value =
                json!({ "answer": "entry", "key": key, "distance": fit.distance, "reason": fit.reason });
            (0, words, value, Some(&found.entry))
        }
        Answer::Between(entry) => {
            let between = entry.provenance.inputs.interpolation.as_ref();
            let words = between.map_or(String::new(), |i| {
                format!(
                    "between {}\n    and {}\n  {} = {}, share of the second {:.4}; N {:.1} to {:.1} kN",
                    i.entries[0],
                    i.entries[1],
                    i.feature,
                    i.value,
                    i.share,
                    entry.validity.axial_force_n[0] / 1e3,
                    entry.validity.axial_force_n[1] / 1e3
                )
            });
            (
                0,
                words,
                json!({ "answer": "between", "key": entry.key, "interpolation": between }),
                Some(entry),
            )
        }
        Answer::None(near) => {
            let words = match near {
                Some(n) => format!(
                    "none; the nearest is {}\n  distance {:.4}: {}",
                    n.key, n.fit.distance, n.fit.reason
                ),
                None => "none; the library has no entry of this kind".to_string(),
            };
            let near = near.as_ref().map(|n| {
                let distance = n.fit.distance.is_finite().then_some(n.fit.distance);
                json!({ "key": n.key, "distance": distance, "reason": n.fit.reason })
            });
            (1, words, json!({ "answer": "none", "nearest": near }), None)
        }
    }
}
