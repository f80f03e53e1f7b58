//! A study as a record in `kb/studies/`: the evidence behind rules.

use super::Facts;
use crate::fe::result::FeSummary;
use serde::{Deserialize, Serialize};

/// Version of the record format.
pub const STUDY_SCHEMA: u32 = 1;

/// One FE study. Times of the computation are left out, so that the same input gives the same bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Always [`STUDY_SCHEMA`].
    pub schema: u32,
    /// Name of the building.
    pub building: String,
    /// Hash of the resolved building.
    pub building_hash: String,
    /// Version of the program.
    pub program_version: String,
    /// Mesh size \[m\].
    pub mesh_size_m: f64,
    /// Elements.
    pub elements: usize,
    /// Time steps.
    pub steps: u64,
    /// Energy error of the run.
    pub energy_error: f64,
    /// Facts.
    pub facts: Facts,
}

impl Study {
    /// A record of a run.
    pub fn new(
        building: &str,
        building_hash: String,
        mesh_size_m: f64,
        summary: &FeSummary,
        facts: Facts,
    ) -> Self {
        Self {
            schema: STUDY_SCHEMA,
            building: building.to_string(),
            building_hash,
            program_version: env!("CARGO_PKG_VERSION").to_string(),
            mesh_size_m,
            elements: summary.elements,
            steps: summary.steps,
            energy_error: summary.energy_error,
            facts,
        }
    }
}
