//! `fallwerk rc --load crush|tension|shear|torsion`: curves of a piece of a member.

use super::progress::Progress;
use super::rc::section_words;
use super::{Failure, Outcome, print, thread_pool, write};
use crate::base::hash::readable_json;
use crate::base::output::OutputFolder;
use crate::base::results::Results;
use crate::rc::piece::Drive;
use crate::rc::springs::{self, Reference, SpringCase};
use crate::rc::{RcSection, SpringOptions, Springs};
use crate::report::figure::{self, Line, Panel};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// What is done to the member, and the piece of it.
#[derive(Debug, Clone, clap::Args)]
pub struct Loading {
    /// Bend the end, or load a piece between two plane sections: crush, pull (tension), shear or twist it
    #[arg(long, value_name = "LOAD", default_value = "bending", value_parser = ["bending", "crush", "tension", "shear", "torsion"])]
    load: String,
    /// Length of the piece in larger sides of the section [default: 1 crushed or pulled, 4 sheared, 2 twisted]
    #[arg(long, value_name = "DEPTHS", value_parser = depths)]
    piece: Option<f64>,
    /// Of shear: longitudinal bars yield, so that the ends may fail by bending
    #[arg(long)]
    yielding_bars: bool,
    /// Of crush: the lower end cannot spread, as at a contact
    #[arg(long)]
    rough_end: bool,
}

fn depths(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| "write a number such as 4".to_string())?;
    if (0.5..=20.0).contains(&value) {
        Ok(value)
    } else {
        Err("a piece is 0.5 to 20 depths long".to_string())
    }
}

impl Loading {
    /// Refuses options that would have no effect under this load.
    pub fn check(&self, axial: bool, turns: bool, whole: bool) -> Result<(), Failure> {
        let drive = self.drive();
        let needs = |given: bool, option: &str, loads: &str, fits: bool| match given && !fits {
            true => Err(Failure::input(format!("{option} is for {loads}, not for --load {}", self.load))),
            false => Ok(()),
        };
        needs(self.piece.is_some(), "--piece", "--load crush, tension, shear or torsion", drive.is_some())?;
        needs(self.yielding_bars, "--yielding-bars", "--load shear", drive == Some(Drive::Shear))?;
        needs(self.rough_end, "--rough-end", "--load crush", drive == Some(Drive::Crush))?;
        needs(turns, "--cycles or --history", "bending", drive.is_none())?;
        needs(whole, "--joint or --whole", "bending", drive.is_none())?;
        let under_axial = !matches!(drive, Some(Drive::Crush | Drive::Tension));
        needs(axial, "--axial", "bending, shear or torsion", under_axial)
    }

    /// What is done to a piece; `None`: bending.
    pub fn drive(&self) -> Option<Drive> {
        match self.load.as_str() {
            "crush" => Some(Drive::Crush),
            "tension" => Some(Drive::Tension),
            "shear" => Some(Drive::Shear),
            "torsion" => Some(Drive::Torsion),
            _ => None,
        }
    }
}

/// Names and units of a load: displacement, its unit and scale, force, its unit.
fn units(drive: Drive) -> (&'static str, &'static str, &'static str, &'static str) {
    match drive {
        Drive::Crush => ("shortening", "mm", "compression", "kN"),
        Drive::Tension => ("elongation", "mm", "tension", "kN"),
        Drive::Shear => ("displacement", "mm", "shear force", "kN"),
        Drive::Torsion => ("rotation", "mrad", "torque", "kN m"),
    }
}

/// Runs a piece of `section` and writes what it gives.
pub fn run(section: &RcSection, drive: Drive, arguments: &super::rc::Arguments) -> Result<Outcome, Failure> {
    let (loading, bending) = (&arguments.piece, &arguments.bending);
    let defaults = SpringOptions::of(drive);
    let options = SpringOptions {
        axial_shares: if bending.axial.is_empty() {
            defaults.axial_shares.clone()
        } else {
            bending.axial.clone()
        },
        directions_deg: arguments.direction.clone(),
        length_depths: loading.piece.unwrap_or(defaults.length_depths),
        until: bending.until.unwrap_or(defaults.until),
        mesh_size_m: bending.size_m(section, bending.mesh.unwrap_or(defaults.mesh_size_m)),
        rough: loading.rough_end,
        elastic_bars: !loading.yielding_bars,
        seed_law: bending.seed_law,
        ..defaults
    };
    if let Some(odd) = options.directions_deg.iter().find(|d| !d.is_finite()) {
        return Err(Failure::input(format!("--direction {odd} is no angle; give degrees such as 90")));
    }
    let output =
        arguments.output.as_deref().map(|folder| OutputFolder::create(folder, Results::Section)).transpose();
    let output = output.map_err(|e| Failure::input(e.to_string()))?;
    let progress = Progress::on_stderr();
    progress.stage("curves");
    let done = thread_pool(arguments.threads)?
        .install(|| springs::run(section, &options, &|share, text| progress.advance(share, text)));
    progress.finish();
    let found = done.map_err(|e| {
        Failure::input(format!("{e}\n  = help: use other elements (--mesh), or correct the concrete"))
    })?;
    if let Some(output) = output {
        write(&output, "curves.csv", &csv(&found))?;
        write(&output, "result.json", &text_of(&result(section, &found))?)?;
        write(&output, &format!("{}.svg", loading.load), &svg(section, &found))?;
        output.commit().map_err(|e| Failure::input(e.to_string()))?;
    }
    if arguments.json {
        let mut value = result(section, &found);
        for (case, own) in found.cases.iter().enumerate() {
            value["runs"][case]["seconds"] = json!(own.seconds);
        }
        print(&text_of(&value)?);
    } else {
        print(&table(section, &found));
    }
    let failed = found.cases.iter().any(|c| c.fault().is_some());
    Ok(if failed { Outcome::CheckFailed } else { Outcome::Done })
}

fn text_of(value: &Value) -> Result<String, Failure> {
    readable_json(value).map_err(|e| Failure::stopped(e.to_string()))
}

/// The figures as JSON, without run times.
fn result(section: &RcSection, found: &Springs) -> Value {
    let reference =
        |r: &Reference| json!({ "name": r.name, "value": r.value, "found": r.found, "ratio": r.ratio() });
    let case = |c: &SpringCase| {
        let mut value = json!({
            "axial_share": c.axial_share, "axial_force_n": c.axial_n, "direction_deg": c.direction_deg,
            "figures": c.figures, "references": c.references.iter().map(reference).collect::<Vec<_>>(),
            "fault": c.fault(),
        });
        if let Ok(run) = &c.run {
            value["kinetic_share"] = json!(run.kinetic_share);
            value["energy_error"] = json!(run.energy_error);
            value["steps"] = json!(run.steps);
            value["failed"] = json!(run.failed);
        }
        value
    };
    json!({
        "schema": 1,
        "section": section,
        "options": found.options,
        "elements": { "hexahedra": found.elements[0], "bars": found.elements[1] },
        "length_m": found.length_m,
        "runs": found.cases.iter().map(case).collect::<Vec<_>>(),
    })
}

fn csv(found: &Springs) -> String {
    let (x, x_unit, y, y_unit) = units(found.options.drive);
    let mut text = format!(
        "axial force [kN],direction [deg],{x} [{x_unit}],{y} [{y_unit}],shortening [mm],energy of concrete [J],energy of steel [J]\n"
    );
    for case in &found.cases {
        for p in case.run.iter().flat_map(|r| &r.points) {
            let _ = writeln!(
                text,
                "{:.3},{},{:.6e},{:.6e},{:.6e},{:.6e},{:.6e}",
                case.axial_n / 1e3,
                case.direction_deg,
                p.at * 1e3,
                p.force / 1e3,
                p.shortening_m * 1e3,
                p.energy_j[0],
                p.energy_j[1]
            );
        }
    }
    text
}

fn svg(section: &RcSection, found: &Springs) -> String {
    let (x, x_unit, y, y_unit) = units(found.options.drive);
    let owned = |name: &str, unit: &str| (name.to_string(), unit.to_string());
    let own = |c: &SpringCase| {
        let run = c.run.as_ref().ok()?;
        let points = run.points.iter().map(|p| [1e3 * p.at, p.force / 1e3]).collect();
        Some(Line { label: format!("n = {}", c.axial_share), points, is_reference: false })
    };
    let mut directions: Vec<f64> = found.cases.iter().map(|c| c.direction_deg).collect();
    directions.dedup();
    let panel = |direction: &f64| {
        let cases = || found.cases.iter().filter(|c| c.direction_deg == *direction);
        let mut lines: Vec<Line> = cases().filter_map(own).collect();
        if !found.fibre.is_empty() {
            let points = found.fibre.iter().map(|p| [1e3 * p[0], p[1] / 1e3]).collect();
            lines.push(Line { label: "fibre section".to_string(), points, is_reference: true });
        }
        let place = if found.options.drive == Drive::Shear {
            format!("Direction {direction}°: ")
        } else {
            String::new()
        };
        Panel {
            title: format!("{place}{y} over {x}"),
            x: owned(x, x_unit),
            y: owned(y, y_unit),
            lines,
            counts: false,
        }
    };
    let panels: Vec<Panel> = directions.iter().map(panel).filter(|p| !p.lines.is_empty()).collect();
    figure::svg(&section.name, &words(section, found), &panels)
}

fn words(section: &RcSection, found: &Springs) -> String {
    section_words(section, &format!("piece of {:.2} m", found.length_m), found.elements)
}

/// The tables on standard output: figures, then what they are compared with.
fn table(section: &RcSection, found: &Springs) -> String {
    let (_, x_unit, _, y_unit) = units(found.options.drive);
    let mut text = format!("{}: {}\n\n", section.name, words(section, found));
    text += "     n      N   dir    crack  tie yield bar yield    peak       at     80 %     20 %  kinetic   energy     s\n";
    let _ = writeln!(
        text,
        "           kN   deg {y_unit:>8} {y_unit:>10} {y_unit:>9} {y_unit:>7} {x_unit:>8} {x_unit:>8} {x_unit:>8}             error"
    );
    let optional = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_string(), |v| format!("{:.digits$}", 1e3 * v))
    };
    let force = |at: Option<[f64; 2]>| optional(at.map(|p| 1e-6 * p[1]), 1);
    for c in &found.cases {
        let _ = write!(text, "{:6.2} {:6.0} {:5.0} ", c.axial_share, c.axial_n / 1e3, c.direction_deg);
        let _ = match (&c.run, c.figures) {
            (Ok(run), Some(f)) => writeln!(
                text,
                "{:>8} {:>10} {:>9} {:>7.1} {:>8} {:>8} {:>8} {:>8.4} {:>8.4} {:>5.0}",
                force(f.first_crack),
                force(f.tie_yield),
                force(f.bar_yield),
                f.peak / 1e3,
                optional(Some(f.peak_at), 3),
                optional(f.at_80, 3),
                optional(f.at_20, 3),
                run.kinetic_share,
                run.energy_error,
                c.seconds
            ),
            (Err(error), _) => writeln!(text, "{error}"),
            _ => writeln!(text, "-"),
        };
        if let (Ok(_), Some(fault)) = (&c.run, c.fault()) {
            let _ = writeln!(text, "       {fault}");
        }
    }
    text += "\n     n   dir  compared with                value       found   ratio\n";
    for c in &found.cases {
        for r in &c.references {
            let number = |v: f64| format!("{v:.4e}");
            let _ = writeln!(
                text,
                "{:6.2} {:5.0}  {:<22} {:>11} {:>11} {:>7}",
                c.axial_share,
                c.direction_deg,
                r.name,
                number(r.value),
                r.found.map_or("-".to_string(), number),
                r.ratio().map_or("-".to_string(), |v| format!("{v:.3}"))
            );
        }
    }
    text += "  (SI: N, N m, J, m, N/m, N m/rad)\n";
    text
}
