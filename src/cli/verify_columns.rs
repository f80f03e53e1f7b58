//! `fallwerk verify columns`: tested columns, bent live, with a table and a plot of all of them.

use super::progress::Progress;
use super::{Failure, Outcome, print, thread_pool};
use crate::base::units::Dimension;
use crate::rc::member::Joint;
use crate::report::scatter::{self, Panel, Point};
use crate::verify::rc::column_envelope::Computed;
use crate::verify::rc::column_runs::{self, ColumnRun, Options};
use crate::verify::rc::{column_page, column_shear, columns};
use serde_json::{Value, json};
use std::path::PathBuf;

/// What to bend, and where to write it.
#[derive(clap::Args)]
pub struct Arguments {
    /// Only columns whose name contains this
    #[arg(long, value_name = "NAME", default_value = "")]
    only: String,
    /// Elements over the depth of a section
    #[arg(long, value_name = "N", default_value_t = 8.0, value_parser = elements)]
    elements: f64,
    /// Drift at which a bend stops, such as 0.08 or `80mrad`
    #[arg(long, value_name = "DRIFT", default_value = "0.08", value_parser = drift)]
    until: f64,
    /// What the columns stand on
    #[arg(long, value_name = "KIND", default_value = "block", value_parser = super::rc::joints())]
    joint: Joint,
    /// No slip of bars out of the block
    #[arg(long)]
    full_bond: bool,
    /// One push only: columns near their shear strength are not cycled
    #[arg(long)]
    monotonic: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write rc-columns.md and rc-columns.svg into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]; no figure depends on them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

fn elements(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| format!("`{text}` is no number"))?;
    if (2.0..=40.0).contains(&number) { Ok(number) } else { Err("2 to 40 elements over the depth".into()) }
}

fn drift(text: &str) -> Result<f64, String> {
    let value = super::library_find::quantity(text, Dimension::Angle)?;
    if (0.001..=0.5).contains(&value) { Ok(value) } else { Err("a drift is 0.001 to 0.5".into()) }
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let joint = arguments.joint;
    let slip = !arguments.full_bond;
    let cycled = !arguments.monotonic;
    let options = Options { elements: arguments.elements, joint, slip, until_rad: arguments.until, cycled };
    let progress = Progress::on_stderr();
    progress.stage("columns");
    let runs = thread_pool(arguments.threads)?.install(|| {
        column_runs::run(&options, &arguments.only, &|share, text| progress.advance(share, text))
    });
    progress.finish();
    if runs.is_empty() {
        let all: Vec<&str> = crate::verify::columns::SPECIMENS.iter().map(|s| s.name).collect();
        let message =
            format!("no column's name contains `{}`; there are: {}", arguments.only, all.join(", "));
        return Err(Failure::input(message));
    }
    let page = column_page::markdown(&options, &runs);
    if arguments.output.is_some() {
        let files = [("rc-columns.md", page.as_str()), ("rc-columns.svg", &plot(&runs))];
        super::bench::save(arguments.output.as_deref(), &files)?;
    }
    if arguments.json {
        let rows: Vec<Value> = runs.iter().map(row).collect();
        let text = crate::base::hash::readable_json(&json!(rows));
        print(&text.map_err(|e| Failure::stopped(e.to_string()))?);
    } else {
        print(&page);
    }
    // of a few columns the figures of all say nothing
    let whole = arguments.only.is_empty();
    let missed = runs.iter().any(|r| r.computed().is_err())
        || whole && columns::figures(&runs).iter().any(|f| !f.passes());
    Ok(if missed { Outcome::CheckFailed } else { Outcome::Done })
}

/// A column as JSON.
fn row(run: &ColumnRun) -> Value {
    let s = run.specimen;
    let mut value = json!({
        "column": s.name, "source": s.source, "axial_share": s.axial_share,
        "failure": format!("{:?}", s.failure).to_lowercase(),
        "measured": { "peak_nm": run.measured_nm(), "drift_at_80": s.drift_at_80, "fell": s.fell },
        "elements": run.elements,
        "moment_ratio": run.moment_ratio(), "drift_ratio": run.drift_ratio(),
    });
    value["shear"] = json!({
        "strength_n": column_shear::strength_n(s), "lateral_over_strength": run.shear_share(), "cycled": run.cycled.is_some(),
    });
    value["monotonic"] = bend(&run.monotonic);
    if let Some(cycled) = &run.cycled {
        value["cycled"] = bend(cycled);
    }
    value
}

/// A bend as JSON.
fn bend(computed: &Result<Computed, String>) -> Value {
    match computed {
        Ok(c) => json!({
            "peak_nm": c.peak_nm, "peak_drift": c.peak_drift, "lateral_n": c.lateral_n, "drift_at_80": c.drift_at_80,
            "fell": c.fell, "ending": c.ending, "kinetic_share": c.kinetic_share, "energy_error": c.energy_error,
        }),
        Err(error) => json!({ "error": error }),
    }
}

/// Measured and computed moments and drifts.
fn plot(runs: &[ColumnRun]) -> String {
    let groups = ["ended by bending", "by shear", "cycled: first push"].map(String::from).to_vec();
    let point = |run: &ColumnRun, at: [f64; 2], group: usize, is_bound: bool| Point {
        at,
        name: run.specimen.name.to_string(),
        group,
        is_bound,
    };
    let compared = |run: &ColumnRun| usize::from(run.is_shear_critical());
    // the push of cycled columns first, so that what is compared lies above it
    let pushes = || {
        runs.iter().filter(|r| r.cycled.is_some()).filter_map(|r| Some((r, r.monotonic.as_ref().ok()?, 2)))
    };
    let done = || pushes().chain(runs.iter().filter_map(|r| Some((r, r.computed().ok()?, compared(r)))));
    let moments = done()
        .map(|(r, c, group)| point(r, [r.measured_nm() / 1e3, c.peak_nm / 1e3], group, false))
        .collect();
    let drifts = done()
        .map(|(r, c, group)| {
            let at = [r.specimen.drift_at_80, c.drift_at_80].map(|d| 100.0 * d);
            point(r, at, group, !(r.specimen.fell && c.fell))
        })
        .collect();
    let shown = if runs.iter().any(|r| r.cycled.is_some()) { 3 } else { 2 };
    let panel = |title: &str, axes: [&str; 2], points: Vec<Point>, band: f64| Panel {
        title: title.to_string(),
        axes: axes.map(String::from),
        groups: groups[..shown].to_vec(),
        points,
        band,
    };
    let title = "Tested columns and the RC submodel";
    let moments =
        panel("Largest moment (dashed: 10 %)", ["measured [kN m]", "computed [kN m]"], moments, 0.1);
    let drifts = panel(
        "Drift at 80 % of V (dashed: 50 %; hollow: not fallen)",
        ["measured [%]", "computed [%]"],
        drifts,
        0.5,
    );
    scatter::svg(title, &[moments, drifts])
}
