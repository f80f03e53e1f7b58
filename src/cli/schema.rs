//! `fallwerk schema`: prints the JSON Schema of the building file.

use super::{Outcome, print};
use crate::building::schema::json_schema;

/// Print the JSON Schema of the building file
///
/// For editors that complete and check keys while you type, and for programs that write building files.
/// The schema knows keys, types, ranges and units; `fallwerk check` knows the rest as well.
#[derive(clap::Args)]
pub struct Arguments {}

/// Runs the command.
pub fn run(_: &Arguments) -> Outcome {
    print(&format!("{:#}\n", json_schema()));
    Outcome::Done
}
