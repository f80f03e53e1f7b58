//! `fallwerk library`: look at the store of subsystems, check it, mend it, exchange it.
//!
//! Exit codes: 0 done; 1 a check failed (damage found); 2 bad input or usage.

use super::library_derive::{LibraryDeriveError, derive_for};
use super::progress::Progress;
use crate::base::hash::readable_json;
use crate::library::entry::Entry;
use crate::library::{Opened, Store, StoreError, exchange};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Arguments of `fallwerk library`.
#[derive(Debug, Clone, Args)]
pub struct LibraryArgs {
    /// The library folder
    #[arg(long, global = true, default_value = "library", value_name = "DIR")]
    pub library: PathBuf,
    /// Print JSON
    #[arg(long, global = true)]
    pub json: bool,
    /// What to do
    #[command(subcommand)]
    pub command: LibraryCommand,
}

/// The commands of `fallwerk library`.
#[derive(Debug, Clone, Subcommand)]
pub enum LibraryCommand {
    /// Compute the entries that a building's column ends need and add them
    Derive {
        /// The building file
        building: PathBuf,
        /// Compute entries that are there anew
        #[arg(long)]
        again: bool,
    },
    /// List the entries
    List,
    /// Show one entry
    Show {
        /// Key, its hash, or the beginning of either
        key: String,
    },
    /// Check every text record and the working copy
    Verify,
    /// Build the working copy from the text records
    Rebuild,
    /// Write all entries into one JSON file
    Export {
        /// The file
        file: PathBuf,
    },
    /// Take over the entries of an exported file
    Import {
        /// The file
        file: PathBuf,
    },
    /// Mark an entry as no longer to be used
    Deprecate {
        /// Key, its hash, or the beginning of either
        key: String,
        /// Entry to use instead
        #[arg(long, value_name = "KEY")]
        successor: Option<String>,
        /// Why
        #[arg(long, default_value = "replaced", value_name = "TEXT")]
        reason: String,
    },
}

/// Runs the command on standard output and error; returns the exit code.
pub fn run(args: &LibraryArgs) -> u8 {
    execute(args, &mut io::stdout().lock(), &mut io::stderr().lock())
}

/// Runs the command; results go to `out`, messages to `err`. Returns the exit code.
pub fn execute(args: &LibraryArgs, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    match attempt(args, out, err) {
        Ok(code) => code,
        Err(Failure::Derive(message)) => {
            let _ = writeln!(err, "error: {message}");
            1
        }
        Err(Failure::Store(error)) => {
            let _ = writeln!(err, "error: {error}");
            if matches!(error, StoreError::Damaged { .. }) { 1 } else { 2 }
        }
        // Whoever reads the output has seen enough (`| head`).
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => 0,
        Err(Failure::Output(error)) => {
            let _ = writeln!(err, "error: cannot write the output: {error}");
            2
        }
    }
}

/// Entries for the column ends of a building.
fn derive(
    store: &mut Store,
    building: &Path,
    again: bool,
    json: bool,
    out: &mut dyn Write,
) -> Result<u8, Failure> {
    let Ok(building) = super::read_building(building, json) else { return Ok(2) };
    let progress = Progress::on_stderr();
    progress.stage("curves");
    let done = derive_for(&building, store, again, &|text| progress.note(text));
    progress.finish();
    match done {
        Ok(derived) => {
            let words =
                format!("{} added, {} were there already", derived.added.len(), derived.present.len());
            let value = json!({ "added": derived.added, "present": derived.present });
            report(json, out, value, &words)
        }
        Err(LibraryDeriveError::Skew(message)) => {
            eprintln!("error: {message}");
            Ok(2)
        }
        Err(LibraryDeriveError::Store(error)) => Err(Failure::Store(error)),
        Err(error) => Err(Failure::Derive(error.to_string())),
    }
}

enum Failure {
    Derive(String),
    Store(StoreError),
    Output(io::Error),
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        Self::Store(error)
    }
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

fn attempt(args: &LibraryArgs, out: &mut dyn Write, err: &mut dyn Write) -> Result<u8, Failure> {
    if !args.library.is_dir() && !matches!(args.command, LibraryCommand::Import { .. }) {
        writeln!(err, "error: {}: no such folder; name the library with --library", args.library.display())?;
        return Ok(2);
    }
    let mut store = Store::open(&args.library)?;
    say_how_opened(&store, err)?;
    match &args.command {
        LibraryCommand::Derive { building, again } => derive(&mut store, building, *again, args.json, out),
        LibraryCommand::List => list(&store, args.json, out),
        LibraryCommand::Show { key } => show(&store.get(&store.resolve(key)?)?, args.json, out),
        LibraryCommand::Verify => verify(&store, args.json, out),
        LibraryCommand::Rebuild => {
            let records = store.rebuild()?;
            let damaged = store.damaged().len();
            let words = format!(
                "working copy built from {records} records{}",
                plural(damaged, ", {} damaged left out")
            );
            report(args.json, out, json!({ "records": records, "damaged": damaged }), &words)?;
            Ok(u8::from(damaged > 0))
        }
        LibraryCommand::Export { file } => {
            let entries = exchange::export(&store, file)?;
            report(
                args.json,
                out,
                json!({ "entries": entries }),
                &format!("{entries} entries in {}", file.display()),
            )
        }
        LibraryCommand::Import { file } => {
            let done = exchange::import(&mut store, file)?;
            let words = format!(
                "{} added, {} mended, {} were there already",
                done.added, done.mended, done.unchanged
            );
            report(args.json, out, json!(done), &words)
        }
        LibraryCommand::Deprecate { key, successor, reason } => {
            let key = store.resolve(key)?;
            let successor = successor.as_ref().map(|s| store.resolve(s)).transpose()?;
            store.deprecate(&key, successor.as_deref(), reason)?;
            report(
                args.json,
                out,
                json!({ "deprecated": key, "successor": successor }),
                &format!("{key} is deprecated"),
            )
        }
    }
}

fn say_how_opened(store: &Store, err: &mut dyn Write) -> io::Result<()> {
    match store.opened() {
        Opened::Checked => {}
        Opened::Rebuilt { why, set_aside: true } => {
            writeln!(err, "note: the working copy was built anew from the text records: {why}")?;
        }
        Opened::Rebuilt { .. } => {}
        Opened::TextOnly { why, writable: false } => {
            writeln!(err, "note: {why}; the text records are read directly, and nothing can be written")?;
        }
        Opened::TextOnly { why, writable: true } => {
            writeln!(err, "note: {why}; the text records are used directly")?
        }
    }
    store
        .damaged()
        .iter()
        .try_for_each(|(path, what)| writeln!(err, "warning: {}: damaged record: {what}", path.display()))
}

fn report(json: bool, out: &mut dyn Write, value: Value, words: &str) -> Result<u8, Failure> {
    if json {
        write!(out, "{}", readable_json(&value).map_err(io::Error::from)?)?;
    } else {
        writeln!(out, "{words}")?;
    }
    Ok(0)
}

fn plural(count: usize, words: &str) -> String {
    if count == 0 { String::new() } else { words.replace("{}", &count.to_string()) }
}

fn list(store: &Store, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    let entries = store.list()?;
    if json {
        let rows: Vec<Value> = entries
            .iter()
            .map(|e| json!({ "key": e.key, "kind": e.kind, "features": e.features, "quality": e.quality, "deprecated": e.deprecated }))
            .collect();
        report(true, out, json!({ "entries": rows }), "")?;
    } else if entries.is_empty() {
        writeln!(out, "the library in {} is empty", store.folder().display())?;
    } else {
        for entry in &entries {
            writeln!(out, "{}  M {:7.1} kN m  {}", entry.key, peak_moment_nm(entry) / 1e3, remark(entry))?;
        }
    }
    Ok(u8::from(!store.damaged().is_empty()))
}

/// Largest moment of any envelope \[N m\].
fn peak_moment_nm(entry: &Entry) -> f64 {
    let points = entry.axes.iter().flat_map(|a| &a.envelopes).flat_map(|l| &l.points);
    points.map(|p| p[1].abs()).fold(0.0, f64::max)
}

fn remark(entry: &Entry) -> String {
    match &entry.deprecated {
        None => String::new(),
        Some(d) => format!(
            "deprecated ({}{})",
            d.reason,
            d.successor.as_ref().map_or(String::new(), |s| format!(", use {s}"))
        ),
    }
}

fn show(entry: &Entry, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    if json {
        write!(out, "{}", entry.to_text().map_err(io::Error::from)?)?;
        return Ok(0);
    }
    let f = &entry.features;
    writeln!(out, "{}", entry.key)?;
    if entry.deprecated.is_some() {
        writeln!(out, "  {}", remark(entry))?;
    }
    writeln!(
        out,
        "  section          {} x {} m, {} m to the point of zero moment",
        f.width_m, f.depth_m, f.length_to_inflection_m
    )?;
    writeln!(out, "  place            {:?} end at {:?}", f.end, f.adjoining)?;
    writeln!(out, "  law              `{}` ({}), mesh {} m", f.law.id, f.law.hash, f.mesh_size_m)?;
    writeln!(
        out,
        "  stiffness        axial {:.4e} N/m, shear {:.4e} and {:.4e} N/m, torsion {:.4e} N m/rad",
        entry.stiffness.axial_n_m,
        entry.stiffness.shear_n_m[0],
        entry.stiffness.shear_n_m[1],
        entry.stiffness.torsion_nm_rad
    )?;
    for (axis, record) in (1..).zip(&entry.axes) {
        writeln!(out, "  axis {axis}           bending {:.4e} N m/rad", record.curve.stiffness_nm_rad)?;
        for level in &record.envelopes {
            let peak = level
                .points
                .iter()
                .fold([0.0, 0.0], |a: [f64; 2], p| if p[1].abs() > a[1].abs() { *p } else { a });
            let fracture =
                level.fracture_rotation_rad.map_or("none".to_string(), |r| format!("at {r:.4} rad"));
            writeln!(
                out,
                "    N {:9.1} kN   M {:8.2} kN m at {:.4} rad, fracture {fracture}",
                level.axial_force_n / 1e3,
                peak[1] / 1e3,
                peak[0]
            )?;
        }
    }
    let q = &entry.quality;
    writeln!(
        out,
        "  quality          {} elements, kinetic/internal energy {:.2e}, asymmetry {:.2e}",
        q.elements, q.kinetic_energy_ratio, q.asymmetry
    )?;
    let p = &entry.provenance;
    writeln!(
        out,
        "  computed         fallwerk {}, submodel version {}",
        p.program_version, p.inputs.submodel_version
    )?;
    writeln!(out, "  inputs           {}", p.inputs_hash)?;
    Ok(0)
}

fn verify(store: &Store, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    let found = exchange::verify(store)?;
    if json {
        report(true, out, json!(found), "")?;
    } else {
        for (path, what) in &found.text {
            writeln!(out, "{}: {what}", path.display())?;
        }
        for what in &found.cache {
            writeln!(out, "working copy: {what}")?;
        }
        let faults = found.text.len() + found.cache.len();
        let verdict = if faults == 0 { "all sound".to_string() } else { format!("{faults} faults") };
        writeln!(out, "{} records: {verdict}", found.records)?;
    }
    Ok(u8::from(!found.is_clean()))
}
