//! `fallwerk batch MODEL TABLE`: many runs of one model that differ in some numbers.

use super::progress::Progress;
use super::{Failure, Outcome, print, thread_pool};
use crate::base::output::{may_write, write_atomic};
use crate::mbs::batch::{self, Summary, Table};
use crate::mbs::{Model, SolveError, SolverOptions};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Run a multibody model many times with other numbers
///
/// The table is CSV: names of numbers in the first line, a run in each further one. Names follow the model file, with ids in the place of list places:
/// bodies.slab1.velocity_m_s.2, contact.ground.friction, events.charge1.time_s, settings.time_step_s; `*` is every member of a list. Names that end in _factor multiply:
/// bushings.*.strength_factor, bodies.column3.mass_factor. Runs are spread over all threads; each ends with the same bytes as if it ran alone.
///
/// Exit codes: 0 done, 1 a run went wrong (its row says why), 2 bad input or usage.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model file (JSON)
    model: PathBuf,
    /// The table (CSV)
    table: PathBuf,
    /// File for the results, a row for each run (CSV) [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Threads [default: all cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    let model = Model::read(&arguments.model).map_err(|e| Failure::input(e.to_string()))?;
    let table = read(&arguments.table)?;
    if let Some(path) = &arguments.output {
        may_write(path, &["csv"], &[&arguments.model, &arguments.table]).map_err(Failure::input)?;
    }
    let progress = Progress::on_stderr();
    progress.stage("runs");
    let (done, count) = (AtomicUsize::new(0), table.rows.len());
    let tell = || {
        let through = done.fetch_add(1, Ordering::Relaxed) + 1;
        progress.advance(through as f64 / count as f64, "");
    };
    let began = Instant::now();
    let pool = thread_pool(arguments.threads)?;
    let options = SolverOptions { repeat: true, ..SolverOptions::default() };
    let results = pool
        .install(|| batch::run(&model, &table, &options, &tell))
        .map_err(|e| Failure::input(format!("{}: {e}", arguments.table.display())))?;
    progress.finish();
    let wall_s = began.elapsed().as_secs_f64();
    let text = csv_of(&model, &table, &results).map_err(Failure::stopped)?;
    match &arguments.output {
        Some(path) => write_atomic(path, text.as_bytes())
            .map_err(|e| Failure::input(format!("cannot write {}: {e}", path.display())))?,
        None => print(&text),
    }
    let wrong = results.iter().filter(|r| r.is_err()).count();
    let cpu_s: f64 = results.iter().flatten().map(|s| s.cpu_s).sum();
    eprintln!(
        "{count} runs in {wall_s:.2} s, {:.1} a second of processor time; {wrong} went wrong",
        (count - wrong) as f64 / cpu_s.max(f64::MIN_POSITIVE)
    );
    Ok(if wrong == 0 { Outcome::Done } else { Outcome::CheckFailed })
}

fn read(path: &Path) -> Result<Table, Failure> {
    let fail = |what: String| Failure::input(format!("{}: {what}", path.display()));
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_path(path)
        .map_err(|e| fail(e.to_string()))?;
    let names: Vec<String> =
        reader.headers().map_err(|e| fail(e.to_string()))?.iter().map(str::to_string).collect();
    if let Some(twice) = names.iter().enumerate().find(|(i, n)| names[..*i].contains(n)) {
        return Err(fail(format!("column {} is \"{}\" again: give each name once", twice.0 + 1, twice.1)));
    }
    if names.len() == 1 && names[0].contains([';', '\t']) {
        return Err(fail(format!(
            "its first line, \"{}\", has no comma: separate cells by commas, and write decimal points",
            names[0]
        )));
    }
    let mut rows = Vec::new();
    for (i, record) in reader.records().enumerate() {
        let record = record.map_err(|e| match e.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => fail(format!(
                "row {} has {len} cells, expected {expected_len} as in the line of names: cells are separated by commas, numbers have decimal points",
                i + 1
            )),
            _ => fail(e.to_string()),
        })?;
        let value = |(name, text): (&String, &str)| {
            text.parse::<f64>()
                .ok()
                .filter(|v| v.is_finite())
                .ok_or_else(|| fail(format!("row {}, {name}: \"{text}\" is not a finite number", i + 1)))
        };
        rows.push(names.iter().zip(record.iter()).map(value).collect::<Result<Vec<f64>, Failure>>()?);
    }
    if rows.is_empty() {
        return Err(fail("has no rows: expected a line of names and a line of numbers for each run".into()));
    }
    Ok(Table { names, rows })
}

fn csv_of(model: &Model, table: &Table, results: &[Result<Summary, SolveError>]) -> Result<String, String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut header = table.names.clone();
    for point in &model.tracked {
        header.extend(["x", "y", "z"].map(|axis| format!("{}_{axis}_m", point.id)));
    }
    header.extend(
        [
            "first_ground_contact_s",
            "hinges_yielded",
            "joints_separated",
            "energy_error",
            "steps",
            "warnings",
            "error",
        ]
        .map(str::to_string),
    );
    let put = |writer: &mut csv::Writer<Vec<u8>>, row: &[String]| {
        writer.write_record(row).map_err(|e| e.to_string())
    };
    put(&mut writer, &header)?;
    for (values, result) in table.rows.iter().zip(results) {
        let mut row: Vec<String> = values.iter().map(f64::to_string).collect();
        match result {
            Ok(s) => {
                row.extend(s.displacements_m.iter().flatten().map(f64::to_string));
                row.push(s.first_ground_contact_s.map(|t| t.to_string()).unwrap_or_default());
                row.extend(s.counts.map(|c| c.to_string()));
                row.extend([
                    s.energy_error.to_string(),
                    s.steps.to_string(),
                    s.warnings.to_string(),
                    String::new(),
                ]);
            }
            Err(error) => {
                row.resize(header.len() - 1, String::new());
                row.push(error.to_string());
            }
        }
        put(&mut writer, &row)?;
    }
    let bytes = writer.into_inner().map_err(|e| e.to_string())?;
    String::from_utf8(bytes).map_err(|e| e.to_string())
}
