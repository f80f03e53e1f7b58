//! `fallwerk library plot`: the curves of an entry, with those of a test beside them.

use super::library::{Failure, report};
use super::library_find::quantity;
use crate::base::diagnostic::Diagnostics;
use crate::base::output::{may_write, write_atomic};
use crate::base::source::Source;
use crate::base::units::Dimension;
use crate::library::curve_file::{self, CurveFile};
use crate::library::entry::{Deprecation, Direction};
use crate::library::{Entry, Store};
use crate::report::figure::{self, Line, Panel};
use clap::Args;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What to draw.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// Key, its name without the kind, its hash, or the beginning of one of these
    key: String,
    /// The SVG file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Draw up to this rotation or displacement, such as `100mrad` or `5mm`
    #[arg(long, value_name = "X", allow_hyphen_values = true)]
    to: Option<String>,
    /// A curve to draw beside it, in the format of `library add`
    #[arg(long, value_name = "CSV")]
    reference: Option<PathBuf>,
}

/// Runs the command.
pub(super) fn run(
    arguments: &Arguments,
    store: &Store,
    json: bool,
    out: &mut dyn Write,
) -> Result<u8, Failure> {
    if json && arguments.output.is_none() {
        return Err(Failure::Usage(
            "--json: a plot is SVG; name a file for it with -o, or use `library show --json`, which has its numbers"
                .to_string(),
        ));
    }
    if let Some(path) = &arguments.output {
        let reads: Vec<&Path> = arguments.reference.iter().map(|p| p.as_path()).collect();
        may_write(path, &["svg"], &reads).map_err(Failure::Usage)?;
    }
    let entry = store.get(&store.resolve(&arguments.key)?)?;
    let reference = arguments.reference.as_deref().map(reference).transpose()?;
    if let Some(curve) = &reference
        && curve.is_bending != entry.kind.is_bending()
    {
        let wanted = if entry.kind.is_bending() { "moment over rotation" } else { "force over displacement" };
        return Err(Failure::Usage(format!("the reference is no curve of {wanted}")));
    }
    let dimension = if entry.kind.is_bending() { Dimension::Angle } else { Dimension::Length };
    let to = arguments.to.as_deref().map(|text| quantity(text, dimension)).transpose();
    let to = to.map_err(|e| Failure::Usage(format!("--to: {e}")))?;
    if to.is_some_and(|to| to <= 0.0) {
        return Err(Failure::Usage(
            "--to: nothing is left of the curves; give a positive number".to_string(),
        ));
    }
    let mut title = entry.key.clone();
    if let Some(why) = entry.deprecated.as_ref().map(deprecated_words) {
        eprintln!("note: {} is {why}", entry.key);
        title += &format!(" ({why})");
    }
    let svg = figure::svg(&title, &entry.words(), &panels(&entry, reference.as_ref(), to));
    match &arguments.output {
        Some(path) => {
            let shown = path.display();
            write_atomic(path, svg.as_bytes()).map_err(|e| Failure::Usage(format!("{shown}: {e}")))?;
            if json {
                report(true, out, json!({ "key": entry.key, "file": shown.to_string() }), "")?;
            }
        }
        None => write!(out, "{svg}")?,
    }
    Ok(0)
}

fn reference(path: &Path) -> Result<CurveFile, Failure> {
    let source = Source::read(path)
        .map_err(|e| Failure::Files(vec![Diagnostics::unreadable(&path.display().to_string(), e)]))?;
    curve_file::read(&source)
        .map_err(|errors| Failure::Files(vec![Diagnostics::new(Arc::new(source), errors)]))
}

/// "deprecated: wrong bars; use KEY".
fn deprecated_words(why: &Deprecation) -> String {
    let successor = why.successor.as_ref().map_or(String::new(), |s| format!("; use {s}"));
    format!("deprecated: {}{successor}", why.reason)
}

/// Lines in SI with their names.
type Raw = Vec<(String, Vec<[f64; 2]>, bool)>;

fn panels(entry: &Entry, reference: Option<&CurveFile>, to: Option<f64>) -> Vec<Panel> {
    let mut panels = Vec::new();
    let level_name = |force_n: f64| format!("N = {:.0} kN", force_n / 1e3);
    let beside = |axis: u8| -> Raw {
        let levels = reference.iter().flat_map(|r| &r.levels).filter(|l| l.axis == axis);
        let name = |force: Option<f64>| {
            force.map_or("reference".to_string(), |n| format!("reference, {}", level_name(n)))
        };
        levels.map(|l| (name(l.axial_force_n), l.points.clone(), true)).collect()
    };
    for (axis, record) in (1..).zip(&entry.axes) {
        let mut lines: Raw =
            record.envelopes.iter().map(|l| (level_name(l.axial_force_n), l.points.clone(), false)).collect();
        lines.extend(beside(axis));
        panels.push(panel(&format!("Axis {axis}: moment over rotation"), lines, true, to));
        if let Some(reverse) = &record.reverse {
            let lines: Raw = reverse
                .envelopes
                .iter()
                .map(|l| (level_name(l.axial_force_n), l.points.clone(), false))
                .collect();
            panels.push(panel(&format!("Axis {axis}, other sense of rotation"), lines, true, to));
        }
    }
    for spring in &entry.springs {
        // a curve of axial force or of pressure holds at none in particular
        let is_own = matches!(spring.direction, Direction::Axial | Direction::Normal);
        let name = |force_n| if is_own { "entry".to_string() } else { level_name(force_n) };
        let mut lines: Raw =
            spring.levels.iter().map(|l| (name(l.axial_force_n), l.points.clone(), false)).collect();
        lines.extend(beside(1));
        let turns = spring.direction == Direction::Torsion;
        let what = if turns { "torque over rotation" } else { "force over displacement" };
        panels.push(panel(&format!("{:?}: {what}", spring.direction), lines, turns, to));
    }
    panels
}

/// Cuts a line off at `to`.
fn cut(points: &mut Vec<[f64; 2]>, to: f64) {
    let Some(beyond) = points.iter().position(|p| p[0] > to) else { return };
    if beyond > 0 {
        let (a, b) = (points[beyond - 1], points[beyond]);
        points[beyond] = [to, a[1] + (b[1] - a[1]) * (to - a[0]) / (b[0] - a[0])];
    }
    points.truncate(if beyond > 0 { beyond + 1 } else { 0 });
}

fn panel(title: &str, mut lines: Raw, bending: bool, to: Option<f64>) -> Panel {
    if let Some(to) = to {
        lines.iter_mut().for_each(|line| cut(&mut line.1, to));
    }
    let reach = lines.iter().flat_map(|l| &l.1).map(|p| p[0].abs()).fold(0.0, f64::max);
    let (x, y, scale) = match bending {
        true if reach < 0.2 => (("rotation", "mrad"), ("moment", "kN m"), 1e3),
        true => (("rotation", "rad"), ("moment", "kN m"), 1.0),
        false => (("displacement", "mm"), ("force", "kN"), 1e3),
    };
    let owned = |(name, unit): (&str, &str)| (name.to_string(), unit.to_string());
    Panel {
        title: title.to_string(),
        x: owned(x),
        y: owned(y),
        lines: lines
            .into_iter()
            .map(|(label, points, is_reference)| Line {
                label,
                points: points.iter().map(|p| [scale * p[0], p[1] / 1e3]).collect(),
                is_reference,
            })
            .collect(),
        counts: false,
    }
}
