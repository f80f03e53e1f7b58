//! `fallwerk library list`, `show`, `history`: entries and events in tables for people.

use super::library::{Failure, report};
use super::library_find::{kind_of, origin_of, quantity};
use crate::base::units::{self, Dimension};
use crate::library::entry::{Direction, EnvelopeLevel, SpringRecord};
use crate::library::features::NUMBERS;
use crate::library::{Entry, EntryKind, Origin, Store};
use crate::rc::shear::CRITICAL_SHARE;
use clap::Args;
use serde_json::{Value, json};
use std::io::{self, Write};

/// Which entries to list.
#[derive(Debug, Clone, Default, Args)]
pub struct Filter {
    /// Only of this kind, such as `column_hinge`
    #[arg(long, value_name = "KIND", value_parser = kind_of)]
    kind: Option<EntryKind>,
    /// Only of this origin: submodel, rc_submodel, test, program
    #[arg(long, value_name = "ORIGIN", value_parser = origin_of)]
    origin: Option<Origin>,
    /// Only of this width, or within `LOW..HIGH`; numbers in metres or with a unit, as in `300mm..0.5`
    #[arg(long, value_name = "RANGE", value_parser = range)]
    width: Option<Range>,
    /// Only of this depth
    #[arg(long, value_name = "RANGE", value_parser = range)]
    depth: Option<Range>,
    /// Leave deprecated entries out
    #[arg(long)]
    current: bool,
}

/// A range of lengths \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range(f64, f64);

fn range(text: &str) -> Result<Range, String> {
    let length = |text: &str| quantity(text, Dimension::Length);
    match text.split_once("..") {
        Some((low, high)) => {
            let low = if low.is_empty() { 0.0 } else { length(low)? };
            let high = if high.is_empty() { f64::INFINITY } else { length(high)? };
            if low <= high { Ok(Range(low, high)) } else { Err("the range is empty".to_string()) }
        }
        None => length(text).map(|x| Range(x, x)),
    }
}

impl Filter {
    fn takes(&self, entry: &Entry) -> bool {
        let within = |range: Option<Range>, x: f64| range.is_none_or(|r| x >= r.0 - 1e-9 && x <= r.1 + 1e-9);
        self.kind.is_none_or(|k| k == entry.kind)
            && self.origin.is_none_or(|o| o == entry.origin)
            && within(self.width, entry.features.width_m)
            && within(self.depth, entry.features.depth_m)
            && !(self.current && entry.deprecated.is_some())
    }
}

/// Lists entries.
pub(super) fn list(store: &Store, filter: &Filter, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    let mut entries = store.list()?;
    let all = entries.len();
    entries.retain(|entry| filter.takes(entry));
    if json {
        let rows: Vec<Value> = entries
            .iter()
            .map(|e| {
                json!({
                    "key": e.key, "kind": e.kind, "origin": e.origin, "features": e.features,
                    "quality": e.quality, "validity": e.validity, "deprecated": e.deprecated,
                })
            })
            .collect();
        report(true, out, json!({ "entries": rows }), "")?;
    } else if all == 0 {
        writeln!(out, "the library in {} is empty", store.folder().display())?;
    } else if entries.is_empty() {
        writeln!(out, "none of the {all} entries")?;
    } else {
        for entry in &entries {
            let line = format!("{}  {}  {}", entry.key, peak_words(entry), remark(entry));
            writeln!(out, "{}", line.trim_end())?;
        }
    }
    Ok(u8::from(!store.damaged().is_empty()))
}

fn peak_words(entry: &Entry) -> String {
    match entry.kind.is_bending() {
        true => format!("M {:7.1} kN m", entry.peak() / 1e3),
        false if entry.kind == EntryKind::TorsionSpring => format!("T {:7.1} kN m", entry.peak() / 1e3),
        false => format!("F {:7.1} kN", entry.peak() / 1e3),
    }
}

fn remark(entry: &Entry) -> String {
    let origin = match entry.origin {
        Origin::Submodel => String::new(),
        other => other.words().to_string(),
    };
    match &entry.deprecated {
        None => origin,
        Some(d) => {
            let successor = d.successor.as_ref().map_or(String::new(), |s| format!(", use {s}"));
            format!("{origin} deprecated ({}{successor})", d.reason).trim_start().to_string()
        }
    }
}

/// Shows one entry.
pub(super) fn show(entry: &Entry, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    if json {
        write!(out, "{}", entry.to_text().map_err(io::Error::from)?)?;
        return Ok(0);
    }
    writeln!(out, "{}\n  {}", entry.key, entry.words())?;
    if entry.deprecated.is_some() {
        writeln!(out, "  {}", remark(entry))?;
    }
    features(entry, out)?;
    for (axis, record) in (1..).zip(&entry.axes) {
        let stiffness = record.curve.stiffness_nm_rad;
        writeln!(out, "\n  axis {axis}: moment over rotation, elastic {stiffness:.4e} N m/rad")?;
        levels(&record.envelopes, out)?;
        if let Some(reverse) = &record.reverse {
            let stiffness = reverse.curve.stiffness_nm_rad;
            writeln!(out, "  axis {axis}, other sense of rotation: elastic {stiffness:.4e} N m/rad")?;
            levels(&reverse.envelopes, out)?;
        }
        if record.envelopes.is_empty() {
            capacities(&record.curve.levels, out)?;
        }
    }
    entry.springs.iter().try_for_each(|spring| self::spring(spring, out))?;
    if let Some(s) = &entry.stiffness {
        writeln!(
            out,
            "\n  stiffness   axial {:.4e} N/m, shear {:.4e} and {:.4e} N/m, torsion {:.4e} N m/rad",
            s.axial_n_m, s.shear_n_m[0], s.shear_n_m[1], s.torsion_nm_rad
        )?;
    }
    let kilo = |n: f64| format!("{:.1} kN", n / 1e3);
    let mut along: Vec<String> = Vec::new();
    along.extend(entry.tensile_capacity_n.map(|n| format!("flows in tension at {}", kilo(n))));
    along.extend(entry.tensile_elongation_m.map(|u| format!("separates at {:.1} mm", u * 1e3)));
    along.extend(entry.compressive_capacity_n.map(|n| format!("crushes at {}", kilo(n))));
    along.extend(
        entry
            .bearing_capacity_n
            .map(|n| format!("its floor bears {} where no column goes on beyond it", kilo(n))),
    );
    along.extend(entry.hinge_offset_m.map(|u| format!("hinge {:.1} mm inside the member", u * 1e3)));
    if !along.is_empty() {
        writeln!(out, "  along it    {}", along.join(", "))?;
    }
    provenance(entry, out)?;
    Ok(0)
}

fn features(entry: &Entry, out: &mut dyn Write) -> io::Result<()> {
    let f = &entry.features;
    writeln!(out, "\n  feature                       value")?;
    for feature in &NUMBERS {
        if let Some(value) = feature.of(f) {
            writeln!(out, "  {:<28}  {}", feature.name, units::show(value, feature.dimension))?;
        }
    }
    for (name, value) in &f.further {
        writeln!(out, "  {name:<28}  {value}")?;
    }
    if let Some(law) = &f.law {
        writeln!(out, "  {:<28}  `{}` ({})", "law", law.id, law.hash)?;
    }
    Ok(())
}

/// One line a level: peak, fall to 80 % of it, fracture.
fn levels(levels: &[EnvelopeLevel], out: &mut dyn Write) -> io::Result<()> {
    if levels.is_empty() {
        return Ok(());
    }
    writeln!(
        out,
        "      N [kN]   M_max [kN m]   at [mrad]   80 % of it [mrad]   fracture [mrad]   end [mrad]"
    )?;
    for level in levels {
        let points = &level.points;
        let at =
            (0..points.len()).fold(0, |a, i| if points[i][1].abs() > points[a][1].abs() { i } else { a });
        let peak = points[at];
        let fallen = points[at..].windows(2).find(|w| w[1][1].abs() < 0.8 * peak[1].abs()).map(|w| {
            let (a, b) = (w[0], w[1]);
            a[0] + (b[0] - a[0]) * (a[1] - 0.8 * peak[1]) / (a[1] - b[1])
        });
        let milli = |x: Option<f64>| x.map_or("-".to_string(), |x| format!("{:.2}", x * 1e3));
        writeln!(
            out,
            "  {:>10.1}   {:>12.2}   {:>9}   {:>17}   {:>15}   {:>10}",
            level.axial_force_n / 1e3,
            peak[1] / 1e3,
            milli(Some(peak[0])),
            milli(fallen),
            milli(level.fracture_rotation_rad),
            milli(points.last().map(|p| p[0])),
        )?;
    }
    Ok(())
}

/// The levels of a curve without envelopes.
fn capacities(levels: &[crate::curve::CapacityLevel], out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "      N [kN]   capacity [kN m]   fracture, plastic rotation [mrad]")?;
    levels.iter().try_for_each(|level| {
        let (peak, end) = (level.peak_nm() / 1e3, level.fracture_rotation_rad * 1e3);
        writeln!(out, "  {:>10.1}   {peak:>15.2}   {end:>33.2}", level.axial_force_n / 1e3)
    })
}

fn spring(spring: &SpringRecord, out: &mut dyn Write) -> io::Result<()> {
    let turns = spring.direction == Direction::Torsion;
    let unit = if turns { "N m/rad" } else { "N/m" };
    writeln!(out, "\n  spring {:?}: elastic {:.4e} {unit}", spring.direction, spring.stiffness_n_m)?;
    let head = if turns {
        "      N [kN] T_min [kN m] T_max [kN m] from [mrad] to [mrad]"
    } else {
        "      N [kN]   F_min [kN]   F_max [kN]   from [mm]   to [mm]"
    };
    writeln!(out, "{head}")?;
    spring.levels.iter().try_for_each(|level| {
        let forces = level.points.iter().map(|p| p[1]);
        let ends = [level.points.first(), level.points.last()].map(|p| p.map_or(0.0, |p| p[0] * 1e3));
        writeln!(
            out,
            "  {:>10.1}   {:>10.2}   {:>10.2}   {:>9.3}   {:>7.3}",
            level.axial_force_n / 1e3,
            forces.clone().fold(f64::INFINITY, f64::min) / 1e3,
            forces.fold(f64::NEG_INFINITY, f64::max) / 1e3,
            ends[0],
            ends[1]
        )
    })
}

fn provenance(entry: &Entry, out: &mut dyn Write) -> io::Result<()> {
    let v = &entry.validity;
    let mut holds = format!("N {}", axial_forces(entry));
    if let Some([_, high]) = v.rotation_rad {
        holds += &format!(", rotation to {:.2} mrad", high * 1e3);
    }
    if let Some([low, high]) = v.displacement_m {
        holds += &format!(", displacement {:.3} to {:.3} mm", low * 1e3, high * 1e3);
    }
    writeln!(out, "  holds for   {holds}")?;
    let q = &entry.quality;
    let mut quality: Vec<String> = Vec::new();
    quality.extend(q.elements.map(|n| format!("{n} elements")));
    quality.extend(q.kinetic_energy_ratio.map(|x| format!("kinetic/internal energy {x:.2e}")));
    quality.extend(q.asymmetry.map(|x| format!("asymmetry {x:.2e}")));
    quality.extend(q.mesh_sensitivity.map(|x| format!("mesh sensitivity {x:.2e}")));
    quality.extend(q.mesh_sensitivity_rotation.map(|x| format!("of the rotation at 80 % {x:.2e}")));
    quality.extend(q.mesh_compared_m.map(|x| format!("against elements of {:.1} mm", 1e3 * x)));
    quality.extend(q.shear_share.map(|x| {
        let warning =
            if x > CRITICAL_SHARE { ": cycles take strength that these curves still have" } else { "" };
        format!("largest shear force {x:.2} of the shear strength{warning}")
    }));
    let quality = if quality.is_empty() { "not stated".to_string() } else { quality.join(", ") };
    writeln!(out, "  quality     {quality}")?;
    let p = &entry.provenance;
    if let Some(s) = &p.inputs.source {
        writeln!(out, "  source      {}", s.citation)?;
        let program = s.program.as_ref().map_or(String::new(), |p| format!(", {p}"));
        writeln!(
            out,
            "  by          {}{program}; file {} ({})",
            s.by,
            s.file,
            s.file_hash.get(..16).unwrap_or("")
        )?;
    }
    if let Some(i) = &p.inputs.interpolation {
        writeln!(out, "  between     {} and {}", i.entries[0], i.entries[1])?;
        writeln!(out, "              {} = {}, share of the second {:.4}", i.feature, i.value, i.share)?;
    }
    let version = p.inputs.submodel_version.map_or(String::new(), |v| format!(", submodel version {v}"));
    writeln!(out, "  made by     fallwerk {}{version}", p.program_version)?;
    writeln!(out, "  inputs      {}", p.inputs_hash)
}

/// The axial forces at which an entry holds, of each axis if they are not the same ones.
fn axial_forces(entry: &Entry) -> String {
    let words = |[low, high]: [f64; 2]| format!("{:.1} to {:.1} kN", low / 1e3, high / 1e3);
    match entry.axes.iter().map(|axis| axis.curve.axial_range_n()).collect::<Vec<_>>().as_slice() {
        [first, second] if first != second => {
            format!("{} about axis 1, {} about axis 2", words(*first), words(*second))
        }
        _ => words(entry.validity.axial_force_n),
    }
}

/// Tells what happened.
pub(super) fn history(
    store: &Store,
    key: Option<&str>,
    json: bool,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<u8, Failure> {
    let mut history = store.history()?;
    if let Some(key) = key {
        let key = store.resolve_told(key)?;
        history.events.retain(|event| event.key == key);
    }
    for line in &history.damaged_lines {
        writeln!(
            err,
            "warning: line {line} of the journal does not match its checksum; `library rebuild` takes it out"
        )?;
    }
    if history.torn_bytes > 0 {
        writeln!(
            err,
            "note: the last line of the journal was cut off; the next change or `library rebuild` mends it"
        )?;
    }
    let code = u8::from(!history.damaged_lines.is_empty());
    if json {
        report(true, out, json!(history), "")?;
        return Ok(code);
    }
    if history.events.is_empty() {
        writeln!(out, "the journal knows nothing of it")?;
    }
    for e in &history.events {
        let line = format!("{}  {:<10}  {}  {}  {}", e.time, e.what.name(), e.key, e.program, e.note);
        writeln!(out, "{}", line.trim_end())?;
    }
    Ok(code)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_take_units_and_open_ends() {
        assert_eq!(range("400mm").unwrap(), Range(0.4, 0.4));
        assert_eq!(range("300 mm..0.5").unwrap(), Range(0.3, 0.5));
        assert_eq!(range("..0.5").unwrap(), Range(0.0, 0.5));
        assert!(range("0.5..0.3").is_err() && range("30 MPa").is_err());
    }
}
