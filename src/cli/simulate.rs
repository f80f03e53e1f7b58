//! `fallwerk simulate MODEL`: runs a multibody model file.

use super::knowledge::{LatentArgs, StepArgs};
use crate::base::output::{OutputError, OutputFolder};
use crate::base::results::Results;
use crate::base::units::in_table;
use crate::mbs::result::{EventKind, RunResult};
use crate::mbs::{Model, SolveError, simulate_with};
use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Arguments of `fallwerk simulate`.
#[derive(Debug, Clone, clap::Args)]
pub struct SimulateArgs {
    /// The model file (JSON)
    pub model: PathBuf,
    /// Folder for `result.json` and the histories as CSV; one of an earlier run is replaced
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Latent hinges
    #[command(flatten)]
    pub latent: LatentArgs,
    /// Steps
    #[command(flatten)]
    pub step: StepArgs,
    /// Print the summary as JSON
    #[arg(long)]
    pub json: bool,
    /// Look at all pairs of bodies in every step, also those that cannot meet in it, and let no body fall asleep
    #[arg(long)]
    pub compute_all: bool,
}

/// Why the command failed.
#[derive(Debug, thiserror::Error)]
pub enum SimulateError {
    /// The model is wrong or the run stopped.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The result folder cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The result cannot be put into JSON.
    #[error("cannot write the result as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl SimulateError {
    /// Exit code: 2 for a bad model or an unwritable output, 1 for a run that stopped.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Solve(SolveError::Model(_) | SolveError::Curve(_) | SolveError::TimeStep { .. }) => 2,
            Self::Output(_) => 2,
            Self::Solve(_) | Self::Json(_) => 1,
        }
    }
}

/// Runs the command.
pub fn run(args: SimulateArgs) -> Result<(), SimulateError> {
    let mut model = Model::read(&args.model).map_err(SolveError::from)?;
    args.step.set(&mut model);
    let mut options = args.latent.options();
    if args.compute_all {
        (options.contact.skip, model.settings.sleep_speed_m_s) = (false, None);
        options.look_always = true;
    }
    let folder = args.output.as_deref().map(|target| result_folder(target, &args.model)).transpose()?;
    let result = simulate_with(&model, &options)?;
    if let Some(folder) = folder {
        write_files(folder, &result)?;
    }
    super::print(&if args.json { format!("{}\n", summary_json(&result)) } else { summary(&result) });
    Ok(())
}

/// The folder for the results, checked before the run: what is replaced is never the model itself.
fn result_folder(target: &Path, model: &Path) -> Result<OutputFolder, SimulateError> {
    let bad = |what| SimulateError::Output(OutputError::BadTarget { path: target.into(), what });
    let is_within = |(file, folder): (PathBuf, PathBuf)| file != folder && file.starts_with(folder);
    if model.canonicalize().ok().zip(target.canonicalize().ok()).is_some_and(is_within) {
        return Err(bad("holds the model, which would be replaced with all else in it; name another folder"));
    }
    Ok(OutputFolder::create(target, Results::Simulation)?)
}

fn write_files(folder: OutputFolder, result: &RunResult) -> Result<(), SimulateError> {
    folder.write("result.json", serde_json::to_string(result)?.as_bytes())?;
    folder.write("displacements.csv", displacements_csv(result).as_bytes())?;
    folder.write("hinges.csv", hinges_csv(result).as_bytes())?;
    folder.write("energies.csv", energies_csv(result).as_bytes())?;
    folder.commit()?;
    Ok(())
}

/// Displacements of the tracked points, columns `time_s, <id>_x_m, ...`.
pub fn displacements_csv(result: &RunResult) -> String {
    let of_point = |id: &str| ["x", "y", "z"].map(|axis| format!("{id}_{axis}_m"));
    table(result.tracked.iter().flat_map(|p| of_point(&p.id)), result, |i, row| {
        row.extend(result.tracked.iter().flat_map(|p| p.displacement_m[i]));
    })
}

/// Hinge histories, columns `time_s, <joint>_rotation1_rad, ...`, and those of hinges and torsion springs among the forces, `<id>_rotation1_rad, ...` about three axes.
pub fn hinges_csv(result: &RunResult) -> String {
    let of_hinge = ["rotation1_rad", "rotation2_rad", "moment1_nm", "moment2_nm", "plastic_rad", "axial_n"];
    let of_turn = ["rotation", "moment", "plastic"].iter().zip(["rad", "nm", "rad"]);
    let of_turn: Vec<String> =
        of_turn.flat_map(|(what, unit)| [1, 2, 3].map(|axis| format!("{what}{axis}_{unit}"))).collect();
    let hinges = result.hinges.iter().flat_map(|h| of_hinge.map(|column| format!("{}_{column}", h.joint)));
    let turns = result.turns.iter().flat_map(|t| of_turn.iter().map(|column| format!("{}_{column}", t.id)));
    table(hinges.chain(turns), result, |i, row| {
        for hinge in &result.hinges {
            row.extend(hinge.rotation_rad[i]);
            row.extend(hinge.moment_nm[i]);
            row.push(hinge.plastic_rotation_rad[i]);
            row.push(hinge.axial_force_n[i]);
        }
        for turn in &result.turns {
            row.extend(turn.rotation_rad[i]);
            row.extend(turn.moment_nm[i]);
            row.extend(turn.plastic_rotation_rad[i]);
        }
    })
}

/// The energy balance: its terms, and their sum.
pub fn energies_csv(result: &RunResult) -> String {
    let terms = [
        "kinetic_j",
        "gravity_j",
        "joints_elastic_j",
        "plastic_j",
        "contact_elastic_j",
        "contact_damping_j",
        "friction_j",
        "released_j",
        "applied_j",
        "total_j",
    ];
    let e = &result.energies;
    table(terms.into_iter().map(Into::into), result, |i, row| {
        row.extend([
            e.kinetic_j[i],
            e.gravity_j[i],
            e.joints_elastic_j[i],
            e.plastic_j[i],
            e.contact_elastic_j[i],
            e.contact_damping_j[i],
            e.friction_j[i],
            e.released_j[i],
            e.applied_j.get(i).copied().unwrap_or(0.0),
            e.total_j(i),
        ]);
    })
}

/// Magnitude below which numbers in tables have exponents.
const SMALL: f64 = 1e-5;

/// A column `time_s`, and others with so many values a row.
fn table(
    columns: impl Iterator<Item = String>,
    result: &RunResult,
    fill: impl Fn(usize, &mut Vec<f64>),
) -> String {
    let mut text = String::from("time_s");
    for name in columns {
        text.push(',');
        text.push_str(&field(&name));
    }
    text.push('\n');
    let mut row = Vec::new();
    for (i, time) in result.times_s.iter().enumerate() {
        row.clear();
        fill(i, &mut row);
        let _ = write!(text, "{}", in_table(*time));
        for value in &row {
            // a number of 1e-300 is no line of noughts
            let _ = if *value != 0.0 && value.abs() < SMALL {
                write!(text, ",{value:e}")
            } else {
                write!(text, ",{value}")
            };
        }
        text.push('\n');
    }
    text
}

/// A field of CSV (RFC 4180): in quotes where an id has what parts fields.
fn field(name: &str) -> Cow<'_, str> {
    match name.contains([',', '"', '\n', '\r']) {
        true => Cow::Owned(format!("\"{}\"", name.replace('"', "\"\""))),
        false => Cow::Borrowed(name),
    }
}

fn counts(result: &RunResult) -> (usize, usize) {
    let count = |f: fn(&EventKind) -> bool| result.events.iter().filter(|e| f(&e.kind)).count();
    (count(|k| matches!(k, EventKind::Yield { .. })), count(|k| matches!(k, EventKind::Fracture { .. })))
}

fn largest_displacement(result: &RunResult) -> Option<(&str, f64)> {
    let last = |p: &[[f64; 3]]| p.last().map_or(0.0, |u| (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]).sqrt());
    let all = result.tracked.iter().map(|p| (p.id.as_str(), last(&p.displacement_m)));
    all.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn summary(result: &RunResult) -> String {
    let (yielded, fractured) = counts(result);
    let end = result.times_s.last().copied().unwrap_or(0.0);
    let mut text = format!(
        "{}: {} bodies, {} hinges with a curve\n  simulated {end:.3} s in {} steps of at most {:.4} ms; {:.2} ms processor time\n  energy error {:.2e}\n  {yielded} hinges yielded, {fractured} joints separated\n",
        result.name,
        result.bodies.len(),
        result.hinges.len(),
        result.steps,
        1e3 * result.time_step_s,
        1e3 * result.cpu_s,
        result.energy_error,
    );
    let _ = match result.first_ground_contact_s {
        Some(t) => writeln!(text, "  first ground contact at {t:.4} s"),
        None => writeln!(text, "  no ground contact"),
    };
    if let Some((id, u)) = largest_displacement(result) {
        let _ = writeln!(text, "  largest displacement at the end: {u:.4} m at {id}");
    }
    if let Some(words) = result.contact_work.words(result.steps) {
        let _ = writeln!(text, "  {words}");
    }
    if let Some(words) = result.body_work.words() {
        let _ = writeln!(text, "  {words}");
    }
    for warning in &result.warnings {
        let _ = writeln!(text, "  warning: {warning}");
    }
    text
}

fn summary_json(result: &RunResult) -> serde_json::Value {
    let (yielded, fractured) = counts(result);
    serde_json::json!({
        "name": result.name,
        "bodies": result.bodies.len(),
        "hinges": result.hinges.len(),
        "end_time_s": result.times_s.last(),
        "steps": result.steps,
        "time_step_s": result.time_step_s,
        "cpu_s": result.cpu_s,
        "energy_error": result.energy_error,
        "energy_growth": result.energy_growth,
        "contact_work": result.contact_work,
        "hinges_yielded": yielded,
        "joints_separated": fractured,
        "first_ground_contact_s": result.first_ground_contact_s,
        "largest_final_displacement": largest_displacement(result)
            .map(|(id, u)| serde_json::json!({ "point": id, "displacement_m": u })),
        "warnings": result.warnings,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::result::{EnergyHistory, HingeHistory, TrackedHistory, TurnHistory};

    /// One output of a run with ids that need quotes.
    fn result() -> RunResult {
        let one = |v: f64| vec![v];
        let text = r#"{"schema": "", "name": "", "times_s": [0.5], "tracked": [], "bodies": [], "frames": [],
            "energies": {"kinetic_j": [1], "gravity_j": [2], "joints_elastic_j": [3], "plastic_j": [4],
            "contact_elastic_j": [0], "contact_damping_j": [5], "friction_j": [6], "released_j": [7]},
            "hinges": [], "events": [], "first_ground_contact_s": null, "steps": 1, "time_step_s": 1,
            "highest_frequency_rad_s": 1, "preload_iterations": null, "cpu_s": 0, "energy_error": 0, "warnings": []}"#;
        let result: RunResult = serde_json::from_str(text).unwrap();
        RunResult {
            energies: EnergyHistory { applied_j: one(8.0), ..result.energies.clone() },
            tracked: vec![TrackedHistory {
                id: "p,1".into(),
                origin_m: [0.0; 3],
                displacement_m: vec![[1.0, 2.0, 3.0]],
            }],
            hinges: vec![HingeHistory {
                joint: "h\"2".into(),
                rotation_rad: vec![[1.0, 2.0]],
                moment_nm: vec![[3.0, 4.0]],
                plastic_rotation_rad: one(5.0),
                axial_force_n: one(6.0),
            }],
            turns: vec![TurnHistory {
                id: "t".into(),
                rotation_rad: vec![[7.0, 8.0, 9.0]],
                moment_nm: vec![[10.0, 11.0, 12.0]],
                plastic_rotation_rad: vec![[13.0, 14.0, 15.0]],
            }],
            ..result
        }
    }

    /// Names and values of the one row.
    fn read(text: &str) -> Vec<(String, f64)> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let names = reader.headers().unwrap().clone();
        let row = reader.records().next().unwrap().unwrap();
        names.iter().zip(&row).map(|(n, v)| (n.to_string(), v.parse().unwrap())).collect()
    }

    #[test]
    fn columns_have_the_ids_as_they_are() {
        let point = read(&displacements_csv(&result()));
        let expected = [("time_s", 0.5), ("p,1_x_m", 1.0), ("p,1_y_m", 2.0), ("p,1_z_m", 3.0)];
        assert_eq!(point, expected.map(|(n, v)| (n.to_string(), v)));
        let hinges = read(&hinges_csv(&result()));
        assert_eq!(hinges[1], ("h\"2_rotation1_rad".to_string(), 1.0));
    }

    #[test]
    fn hinges_among_the_forces_have_columns() {
        let hinges = read(&hinges_csv(&result()));
        assert_eq!(hinges.len(), 1 + 6 + 9);
        for (column, value) in [
            ("t_rotation1_rad", 7.0),
            ("t_moment3_nm", 12.0),
            ("t_plastic2_rad", 14.0),
            ("h\"2_axial_n", 6.0),
        ] {
            assert!(hinges.contains(&(column.to_string(), value)), "{column}: {hinges:?}");
        }
    }

    #[test]
    fn the_terms_of_the_energy_balance_make_its_total() {
        let energies = read(&energies_csv(&result()));
        let value = |name: &str| energies.iter().find(|(n, _)| n == name).unwrap().1;
        let terms: f64 = energies[1..energies.len() - 1].iter().map(|(_, v)| v).sum();
        assert_eq!((value("applied_j"), value("total_j"), terms), (8.0, 36.0, 36.0));
    }
}
