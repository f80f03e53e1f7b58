//! `fallwerk simulate MODEL`: runs a multibody model file.

use super::knowledge::LatentArgs;
use crate::mbs::result::{EventKind, RunResult};
use crate::mbs::{Model, SolveError, simulate_with};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Arguments of `fallwerk simulate`.
#[derive(Debug, Clone, clap::Args)]
pub struct SimulateArgs {
    /// The model file (JSON)
    pub model: PathBuf,
    /// Folder for `result.json` and the histories as CSV
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Latent hinges
    #[command(flatten)]
    pub latent: LatentArgs,
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
    /// An output file cannot be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The result cannot be put into JSON.
    #[error("cannot write the result as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl SimulateError {
    /// Exit code: 2 for a bad model or an unwritable output, 1 for a run that stopped.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Solve(SolveError::Model(_) | SolveError::Curve(_) | SolveError::TimeStep { .. }) => 2,
            Self::Write { .. } => 2,
            Self::Solve(_) | Self::Json(_) => 1,
        }
    }
}

/// Runs the command.
pub fn run(args: SimulateArgs) -> Result<(), SimulateError> {
    let mut model = Model::read(&args.model).map_err(SolveError::from)?;
    let mut options = args.latent.options();
    if args.compute_all {
        (options.contact.skip, model.settings.sleep_speed_m_s) = (false, None);
        options.look_always = true;
    }
    let result = simulate_with(&model, &options)?;
    if let Some(folder) = &args.output {
        write_files(folder, &result)?;
    }
    if args.json {
        println!("{}", summary_json(&result));
    } else {
        print!("{}", summary(&result));
    }
    Ok(())
}

fn write_files(folder: &Path, result: &RunResult) -> Result<(), SimulateError> {
    std::fs::create_dir_all(folder).map_err(|source| SimulateError::Write { path: folder.into(), source })?;
    let files = [
        ("result.json", serde_json::to_string(result)?),
        ("displacements.csv", displacements_csv(result)),
        ("hinges.csv", hinges_csv(result)),
        ("energies.csv", energies_csv(result)),
    ];
    for (name, text) in files {
        let path = folder.join(name);
        // Written aside and renamed, so that a reader never sees half a file.
        let partial = folder.join(format!(".{name}.partial"));
        std::fs::write(&partial, text)
            .and_then(|()| std::fs::rename(&partial, &path))
            .map_err(|source| SimulateError::Write { path, source })?;
    }
    Ok(())
}

/// Displacements of the tracked points, columns `time_s, <id>_x_m, ...`.
pub fn displacements_csv(result: &RunResult) -> String {
    let mut text = String::from("time_s");
    for point in &result.tracked {
        for axis in ["x", "y", "z"] {
            let _ = write!(text, ",{}_{axis}_m", point.id);
        }
    }
    table(text, result, |i, row| {
        row.extend(result.tracked.iter().flat_map(|p| p.displacement_m[i]));
    })
}

/// Hinge histories, columns `time_s, <joint>_rotation1_rad, ...`.
pub fn hinges_csv(result: &RunResult) -> String {
    let mut text = String::from("time_s");
    for hinge in &result.hinges {
        for column in ["rotation1_rad", "rotation2_rad", "moment1_nm", "moment2_nm", "plastic_rad", "axial_n"]
        {
            let _ = write!(text, ",{}_{column}", hinge.joint);
        }
    }
    table(text, result, |i, row| {
        for hinge in &result.hinges {
            row.extend(hinge.rotation_rad[i]);
            row.extend(hinge.moment_nm[i]);
            row.push(hinge.plastic_rotation_rad[i]);
            row.push(hinge.axial_force_n[i]);
        }
    })
}

/// The energy balance.
pub fn energies_csv(result: &RunResult) -> String {
    let header = "time_s,kinetic_j,gravity_j,joints_elastic_j,plastic_j,contact_elastic_j,contact_damping_j,friction_j,released_j,total_j";
    let e = &result.energies;
    table(header.into(), result, |i, row| {
        row.extend([
            e.kinetic_j[i],
            e.gravity_j[i],
            e.joints_elastic_j[i],
            e.plastic_j[i],
            e.contact_elastic_j[i],
            e.contact_damping_j[i],
            e.friction_j[i],
            e.released_j[i],
            e.total_j(i),
        ]);
    })
}

fn table(mut text: String, result: &RunResult, fill: impl Fn(usize, &mut Vec<f64>)) -> String {
    text.push('\n');
    let mut row = Vec::new();
    for (i, time) in result.times_s.iter().enumerate() {
        row.clear();
        fill(i, &mut row);
        let _ = write!(text, "{time}");
        for value in &row {
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
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
