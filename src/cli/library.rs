//! `fallwerk library`: look at the store of subsystems, fill it, check it, mend it, exchange it.
//!
//! Exit codes: 0 done; 1 a check failed (damage found, nothing fits); 2 bad input or usage, or the library cannot be
//! written because another process has it.

use super::library_derive::{self, LibraryDeriveError, Watch, derive_for, derive_sections};
use super::library_look::{self, Filter};
use super::library_springs::{self, makes_hinges};
use super::progress::Progress;
use super::{colour_on_stderr, knowledge, library_add, library_find, library_plot};
use crate::base::diagnostic::Diagnostics;
use crate::base::hash::readable_json;
use crate::library::journal::Happening;
use crate::library::{Opened, Store, StoreError, exchange};
use crate::rc::{RcSection, section_file, section_grid};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Arguments of `fallwerk library`.
#[derive(Debug, Clone, Args)]
pub struct LibraryArgs {
    /// The library folder [default: library, else the program's, which is only read]
    #[arg(long, global = true, value_name = "DIR")]
    pub library: Option<PathBuf>,
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
    /// Compute the entries that a building's column ends need, or those of sections in concrete and steel, and add them; goes on where it
    /// was interrupted
    Derive(library_derive::Arguments),
    /// Add a curve from a test or another program
    Add(library_add::Arguments),
    /// List the entries
    List(Filter),
    /// Show one entry
    Show {
        /// Key, its name without the kind, its hash, or the beginning of one of these
        key: String,
    },
    /// Draw the curves of an entry as SVG
    Plot(library_plot::Arguments),
    /// Compare two entries
    Diff {
        /// Key, its name without the kind, its hash, or the beginning of one of these
        first: String,
        /// As the first
        second: String,
    },
    /// Find the entry that fits best, or one between two
    Find(library_find::Arguments),
    /// Tell what happened to the library, or to one entry
    History {
        /// Key, its name without the kind, its hash, or the beginning of one of these
        key: Option<String>,
    },
    /// Check every text record, the working copy and the journal
    Verify,
    /// Build the working copy from the text records, and mend the journal
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
    /// Mark an entry as no longer to be used; it is kept
    Deprecate {
        /// Key, its name without the kind, its hash, or the beginning of one of these
        key: String,
        /// Entry to use instead
        #[arg(long, value_name = "KEY")]
        successor: Option<String>,
        /// Why [default: replaced, or what is recorded]
        #[arg(long, value_name = "TEXT")]
        reason: Option<String>,
    },
}

/// Runs the command on standard output and error; returns the exit code.
pub fn run(args: &LibraryArgs) -> u8 {
    // not locked: progress is told from other threads
    execute(args, &mut io::stdout(), &mut io::stderr())
}

/// Runs the command; results go to `out`, messages to `err`. Returns the exit code.
pub fn execute(args: &LibraryArgs, out: &mut dyn Write, err: &mut dyn Write) -> u8 {
    let (code, message) = match attempt(args, out, err) {
        Ok(code) => return code,
        // Whoever reads the output has seen enough (`| head`).
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => return 0,
        Err(Failure::Output(error)) => {
            let _ = writeln!(err, "error: cannot write the output: {error}");
            return 2;
        }
        Err(Failure::Files(found)) => {
            for diagnostics in &found {
                let _ = write!(err, "{}", diagnostics.render(colour_on_stderr()));
            }
            if args.json {
                let all: Vec<Value> = found.iter().map(Diagnostics::to_json).collect();
                let _ = report(true, out, json!({ "ok": false, "diagnostics": all }), "");
            }
            return 2;
        }
        Err(Failure::Stopped(message)) => (1, message),
        Err(Failure::Usage(message)) => (2, message),
        Err(Failure::Store(error)) => {
            (if matches!(error, StoreError::Damaged { .. }) { 1 } else { 2 }, error.to_string())
        }
    };
    let _ = writeln!(err, "error: {message}");
    if args.json {
        let failure =
            if code == 1 { super::Failure::stopped(message) } else { super::Failure::input(message) };
        let _ = report(true, out, failure.to_json(), "");
    }
    code
}

/// Sections of section and grid files; all errors of all files at once.
fn sections(what: &library_derive::Arguments) -> Result<Vec<RcSection>, Failure> {
    let (mut sections, mut found) = (Vec::new(), Vec::new());
    for file in &what.section {
        match section_file::read_file(file) {
            Ok(section) => sections.push(section),
            Err(errors) => found.push(errors),
        }
    }
    for file in &what.grid {
        match section_grid::read_file(file) {
            Ok(own) => sections.extend(own),
            Err(errors) => found.extend(errors),
        }
    }
    if found.is_empty() { Ok(sections) } else { Err(Failure::Files(found)) }
}

/// Entries for the column ends of a building, or for sections.
fn derive(
    store: &mut Store,
    what: &library_derive::Arguments,
    json: bool,
    out: &mut dyn Write,
) -> Result<u8, Failure> {
    let progress = Progress::on_stderr();
    progress.stage("curves");
    let watch = Watch {
        progress: &|share, text| progress.advance(share, text),
        added: &|key| progress.say(&format!("added {key}")),
    };
    let done = match &what.building {
        None => {
            let sections = sections(what)?;
            let hinges = if makes_hinges(&what.make) { sections.as_slice() } else { &[] };
            derive_sections(hinges, what, store, &watch)
                .and_then(|done| library_springs::derive(&sections, what, store, &watch, done))
        }
        Some(_) if what.bending.is_given() || what.check_mesh || !what.make.is_empty() => {
            let message = "--make, --axial, --until, --mesh, --elements, --check-mesh, --joint, --no-buckling, --seed-law and --whole are of --section and --grid; of a building all hinges and crushed ends are made, by its own settings";
            return Err(Failure::Usage(message.to_string()));
        }
        Some(path) => {
            let Ok(building) = super::read_building(path, json) else { return Ok(2) };
            derive_for(&building, store, what.again, &watch)
        }
    };
    progress.finish();
    match done {
        Ok(derived) => {
            let unusable = store.out_of_use(&[&derived.added[..], &derived.present[..]].concat())?;
            let words = format!(
                "{} added, {} were there already{}",
                derived.added.len(),
                derived.present.len(),
                plural(unusable.len(), "; {} of them deprecated, with no successor to use")
            );
            for (key, reason) in &unusable {
                progress.say(&format!(
                    "note: {key} is deprecated ({reason}), and no model uses it; name an entry to use instead by `library deprecate --successor`"
                ));
            }
            derived.left_out.iter().for_each(|level| progress.say(&format!("note: left out: {level}")));
            let unusable: Vec<Value> =
                unusable.iter().map(|(key, reason)| json!({ "key": key, "reason": reason })).collect();
            let value = json!({
                "added": derived.added, "present": derived.present, "left_out": derived.left_out,
                "deprecated": unusable,
            });
            report(json, out, value, &words)
        }
        Err(LibraryDeriveError::Skew(message)) => Err(Failure::Usage(message)),
        Err(LibraryDeriveError::Store(error)) => Err(Failure::Store(error)),
        Err(error) => Err(Failure::Stopped(error.to_string())),
    }
}

/// Why a command of the library stopped.
pub(super) enum Failure {
    /// What it checks or computes did not succeed.
    Stopped(String),
    /// The command line or an input is wrong.
    Usage(String),
    /// Input files are wrong.
    Files(Vec<Diagnostics>),
    /// The store refused.
    Store(StoreError),
    /// The output could not be written.
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
    if let LibraryCommand::Add(add) = &args.command
        && let Some(text) = add.asked_text()
    {
        write!(out, "{text}")?;
        return Ok(0);
    }
    if let LibraryCommand::Add(add) = &args.command
        && add.only_checks()
    {
        return library_add::check(add, args.json, (out, err));
    }
    let (folder, is_own) = args.command.folder(args.library.as_deref())?;
    let mut store =
        if args.command.needs_lock(is_own) { Store::open(&folder)? } else { Store::open_to_read(&folder)? };
    say_how_opened(&store, args.command.names_damage(), err)?;
    if args.command.writes() && store.writable().is_ok() {
        warn_of_gone(&store, err)?;
    }
    let code = dispatch(args, &mut store, out, err)?;
    if let (true, Opened::TextOnly { why, writable: true }) = (args.command.writes(), store.opened()) {
        writeln!(
            err,
            "note: the text records are written; {why}; the next command that writes builds the copy again"
        )?;
    }
    Ok(code)
}

impl LibraryCommand {
    fn writes(&self) -> bool {
        matches!(
            self,
            Self::Derive(_) | Self::Add(_) | Self::Rebuild | Self::Import { .. } | Self::Deprecate { .. }
        )
    }

    /// Whether nobody else may write meanwhile: it writes, or looks at the working copy, which one process may have open. The
    /// library of the program has none that counts.
    fn needs_lock(&self, is_own: bool) -> bool {
        self.writes() || matches!(self, Self::Verify) && is_own
    }

    /// The library folder, and whether it is the user's own: that of the program is for reading only.
    fn folder(&self, given: Option<&Path>) -> Result<(PathBuf, bool), Failure> {
        let folder = knowledge::folder(given, "library");
        let is_own = given.is_some() || folder == Path::new("library");
        if self.writes() && !is_own {
            return Err(Failure::Usage(
                "there is no folder `library` here, and that of the program is only read; name the library to write to with --library".to_string(),
            ));
        }
        let makes_it = matches!(self, Self::Import { .. } | Self::Add(_) | Self::Derive(_));
        if folder.is_dir() || (makes_it && given.is_some()) {
            return Ok((folder, is_own));
        }
        Err(Failure::Usage(format!("{}: no such folder; name the library with --library", folder.display())))
    }

    /// Whether damaged records are part of its own answer.
    fn names_damage(&self) -> bool {
        matches!(self, Self::Verify)
    }
}

fn dispatch(
    args: &LibraryArgs,
    store: &mut Store,
    out: &mut dyn Write,
    err: &mut dyn Write,
) -> Result<u8, Failure> {
    let json = args.json;
    match &args.command {
        LibraryCommand::Derive(what) => derive(store, what, json, out),
        LibraryCommand::Add(add) => library_add::run(add, store, json, (out, err)),
        LibraryCommand::List(filter) => library_look::list(store, filter, json, out),
        LibraryCommand::Show { key } => library_look::show(&store.get(&store.resolve(key)?)?, json, out),
        LibraryCommand::Plot(plot) => library_plot::run(plot, store, json, out),
        LibraryCommand::Diff { first, second } => {
            let get = |key: &str| store.get(&store.resolve(key)?);
            super::library_diff::run(&get(first)?, &get(second)?, json, out)
        }
        LibraryCommand::Find(find) => library_find::run(find, store, json, out),
        LibraryCommand::History { key } => library_look::history(store, key.as_deref(), json, out, err),
        LibraryCommand::Verify => verify(store, json, out),
        LibraryCommand::Rebuild => {
            let records = store.rebuild()?;
            let damaged = store.damaged().len();
            let words = format!(
                "working copy built from {records} records{}",
                plural(damaged, ", {} damaged left out")
            );
            report(json, out, json!({ "records": records, "damaged": damaged }), &words)?;
            Ok(u8::from(damaged > 0))
        }
        LibraryCommand::Export { file } => {
            let entries = exchange::export(store, file)?;
            let words = format!("{entries} entries in {}", file.display());
            report(json, out, json!({ "entries": entries }), &words)
        }
        LibraryCommand::Import { file } => {
            let done = exchange::import(store, file)?;
            let words = format!(
                "{} added, {} mended, {} were there already{}",
                done.added,
                done.mended,
                done.unchanged,
                plural(done.deprecated, ", {} deprecated")
            );
            report(json, out, json!(done), &words)
        }
        LibraryCommand::Deprecate { key, successor, reason } => {
            let key = store.resolve(key)?;
            let successor = successor.as_ref().map(|s| store.resolve(s)).transpose()?;
            let marked = store.deprecate(&key, successor.as_deref(), reason.as_deref())?;
            let value = json!({ "deprecated": key, "successor": marked.successor, "reason": marked.reason });
            report(json, out, value, &format!("{key} is deprecated"))
        }
    }
}

fn say_how_opened(store: &Store, names_damage: bool, err: &mut dyn Write) -> io::Result<()> {
    match store.opened() {
        Opened::Checked | Opened::ToRead => {}
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
    if names_damage {
        return Ok(());
    }
    store
        .damaged()
        .iter()
        .try_for_each(|(path, what)| writeln!(err, "warning: {}: damaged record: {what}", path.display()))
}

/// The result as JSON or in words.
pub(super) fn report(json: bool, out: &mut dyn Write, value: Value, words: &str) -> Result<u8, Failure> {
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

fn verify(store: &Store, json: bool, out: &mut dyn Write) -> Result<u8, Failure> {
    let found = exchange::verify(store)?;
    let code = u8::from(!found.is_clean());
    if json {
        report(true, out, json!(found), "")?;
        return Ok(code);
    }
    for (path, what) in &found.text {
        writeln!(out, "{}: {what}", path.display())?;
    }
    for what in &found.cache {
        writeln!(out, "working copy: {what}")?;
    }
    for what in &found.journal {
        writeln!(out, "journal: {what}; `library rebuild` takes it out")?;
    }
    for key in &found.gone {
        writeln!(out, "{key}: its record is gone; {GONE_REMEDY}")?;
    }
    for key in &found.missing {
        writeln!(out, "note: {key} is noted as missing")?;
    }
    let verdict = match found.faults() {
        0 => "all sound".to_string(),
        1 => "1 fault".to_string(),
        faults => format!("{faults} faults"),
    };
    let untold =
        plural(found.untold, "; {} came or changed without the journal, which the next change notes");
    let missing = plural(found.missing.len(), "; {} missing");
    writeln!(out, "{} records: {verdict}{untold}{missing}", found.records)?;
    Ok(code)
}

const GONE_REMEDY: &str = "restore the file (version control, `library import`) or derive it again; `library rebuild` notes it as missing";

/// Entries of the journal whose records went without it, which a command that writes is about to note.
fn warn_of_gone(store: &Store, err: &mut dyn Write) -> Result<(), Failure> {
    for event in store.untold()?.iter().filter(|e| e.what == Happening::Missing) {
        writeln!(err, "warning: {}: its record is gone, which the journal notes now", event.key)?;
    }
    Ok(())
}
