//! `fallwerk library add`: a curve from a test or another program.

use super::library::{Failure, report};
use crate::library::{Entry, Put, Store, add, meta};
use clap::Args;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;

/// What to add.
#[derive(Debug, Clone, Args)]
pub struct Arguments {
    /// The curve: columns with units in the header, such as `rotation [mrad], moment [kN m], axial force [kN]`
    #[arg(required_unless_present_any = ["example", "example_curve", "schema"])]
    curve: Option<PathBuf>,
    /// What is said of it (TOML)
    #[arg(long, value_name = "FILE", required_unless_present_any = ["example", "example_curve", "schema"])]
    meta: Option<PathBuf>,
    /// Check both files and add nothing; no library is opened
    #[arg(long)]
    check: bool,
    /// Print a commented example of the description
    #[arg(long, exclusive = true)]
    example: bool,
    /// Print the curve that belongs to the example
    #[arg(long, exclusive = true)]
    example_curve: bool,
    /// Print the JSON Schema of the description
    #[arg(long, exclusive = true)]
    schema: bool,
}

impl Arguments {
    /// The text that is asked for instead of adding something.
    pub fn asked_text(&self) -> Option<String> {
        if self.schema {
            return Some(format!("{:#}\n", meta::json_schema()));
        }
        let example = self.example.then(|| meta::EXAMPLE.to_string());
        example.or_else(|| self.example_curve.then(|| meta::EXAMPLE_CURVE.to_string()))
    }

    /// Whether nothing is added.
    pub fn only_checks(&self) -> bool {
        self.check
    }
}

/// The entry of the two files with what is doubtful about it, which is told.
fn entry(arguments: &Arguments, err: &mut dyn Write) -> Result<(Entry, Vec<String>), Failure> {
    let (Some(curve), Some(meta)) = (&arguments.curve, &arguments.meta) else {
        return Err(Failure::Usage("give a curve and --meta FILE".to_string()));
    };
    let entry = add::entry_of_files(curve, meta).map_err(Failure::Files)?;
    let doubts = add::doubts(&entry);
    doubts.iter().try_for_each(|doubt| writeln!(err, "warning: {}: {doubt}", curve.display()))?;
    Ok((entry, doubts))
}

/// Checks the files.
pub(super) fn check(
    arguments: &Arguments,
    json: bool,
    (out, err): (&mut dyn Write, &mut dyn Write),
) -> Result<u8, Failure> {
    let (entry, doubts) = entry(arguments, err)?;
    Store::check(&entry)?;
    let value = json!({ "key": entry.key, "done": "sound", "warnings": doubts });
    report(json, out, value, &format!("sound {}", entry.key))
}

/// Runs the command.
pub(super) fn run(
    arguments: &Arguments,
    store: &mut Store,
    json: bool,
    (out, err): (&mut dyn Write, &mut dyn Write),
) -> Result<u8, Failure> {
    let (entry, doubts) = entry(arguments, err)?;
    let what = match store.put(&entry)? {
        Put::Added => "added",
        Put::Unchanged => "was there already",
        Put::Replaced => "replaced",
    };
    let mut words = match what {
        "was there already" => format!("{} was there already", entry.key),
        what => format!("{what} {}", entry.key),
    };
    let deprecated = store.deprecation(&entry.key)?;
    if let Some(why) = &deprecated {
        words += &format!("; it is deprecated ({}) and stays so", why.reason);
    }
    report(
        json,
        out,
        json!({ "key": entry.key, "done": what, "deprecated": deprecated, "warnings": doubts }),
        &words,
    )
}
