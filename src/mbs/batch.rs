//! Many runs of one model that differ in some numbers.
//!
//! Runs share the model and nothing else, so that each ends with the same bytes as if it ran alone; they are spread over the threads of the pool.

use super::parameter::{ParameterError, apply, clash};
use super::result::{EventKind, RunResult};
use super::run::{SolverOptions, simulate_varied, simulate_with};
use super::tables::Tables;
use super::{Model, SolveError};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What differs: names of numbers ([`apply`]), and a row of values for each run.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Names.
    pub names: Vec<String>,
    /// Values, one for each name.
    pub rows: Vec<Vec<f64>>,
}

/// Why no batch is run.
#[derive(Debug, thiserror::Error)]
pub enum BatchError {
    /// A name leads nowhere.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// Two names set the same number.
    #[error("\"{later}\" sets what \"{earlier}\" sets as well: leave one of them out")]
    Clash {
        /// The one that comes first.
        earlier: String,
        /// The other.
        later: String,
    },
    /// A row has another number of values.
    #[error("row {row} has {found} values, expected {expected}, one for each name")]
    Row {
        /// The row, from 1.
        row: usize,
        /// Its values.
        found: usize,
        /// The names.
        expected: usize,
    },
}

/// What is kept of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Displacements of the tracked points at the end \[m\].
    pub displacements_m: Vec<[f64; 3]>,
    /// First contact with the ground \[s\].
    pub first_ground_contact_s: Option<f64>,
    /// Hinges that yielded, joints that separated.
    pub counts: [usize; 2],
    /// Largest error of the energy balance relative to the energy turned over.
    pub energy_error: f64,
    /// Warnings, as many as a single run gives.
    pub warnings: usize,
    /// Steps.
    pub steps: usize,
    /// Processor time \[s\].
    pub cpu_s: f64,
}

impl Summary {
    fn of(result: &RunResult) -> Self {
        let count = |f: fn(&EventKind) -> bool| result.events.iter().filter(|e| f(&e.kind)).count();
        let last = |p: &[[f64; 3]]| p.last().copied().unwrap_or_default();
        Self {
            displacements_m: result.tracked.iter().map(|t| last(&t.displacement_m)).collect(),
            first_ground_contact_s: result.first_ground_contact_s,
            counts: [
                count(|k| matches!(k, EventKind::Yield { .. })),
                count(|k| matches!(k, EventKind::Fracture { .. })),
            ],
            energy_error: result.energy_error,
            warnings: result.warnings.len(),
            steps: result.steps,
            cpu_s: result.cpu_s,
        }
    }
}

/// The model of one row.
///
/// # Errors
/// If a name leads nowhere.
pub fn varied(model: &Model, names: &[String], row: &[f64]) -> Result<Model, ParameterError> {
    let mut own = model.clone();
    for (name, value) in names.iter().zip(row) {
        apply(&mut own, name, *value)?;
    }
    follow_masses(&mut own, model);
    Ok(own)
}

/// Scales what stands beside the masses of bodies as these are in a row against those of the `file`: inertia that they have together, and the weight of spans. Of bodies that are scaled differently the smallest factor counts, with which the inertia together stays positive definite.
fn follow_masses(model: &mut Model, file: &Model) {
    let factors: BTreeMap<&str, f64> = model
        .bodies
        .iter()
        .zip(&file.bodies)
        .map(|(own, given)| {
            let of_inertia = (0..3).map(|k| own.inertia_kg_m2[k][k] / given.inertia_kg_m2[k][k]);
            (given.id.as_str(), of_inertia.fold(own.mass_kg / given.mass_kg, f64::min))
        })
        .collect();
    let smallest = |ids: &mut dyn Iterator<Item = &String>| {
        ids.filter_map(|id| factors.get(id.as_str())).copied().reduce(f64::min).unwrap_or(1.0)
    };
    for shared in &mut model.shared_masses {
        let factor = smallest(&mut shared.bodies.iter());
        shared.blocks.iter_mut().flat_map(|b| b.added.as_flattened_mut()).for_each(|v| *v *= factor);
    }
    for bushing in &mut model.bushings {
        let factor = smallest(&mut bushing.body_a.iter().chain([&bushing.body_b]));
        if let Some(span) = bushing.beam.as_mut().and_then(|beam| beam.span.as_mut()) {
            span.mass_kg_m *= factor;
        }
    }
}

/// Runs every row; `done` is told after each run how many are through. A run that goes wrong has its error in the place of its summary.
///
/// # Errors
/// If the table does not fit the model.
pub fn run(
    model: &Model,
    table: &Table,
    options: &SolverOptions,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Result<Summary, SolveError>>, BatchError> {
    let expected = table.names.len();
    for (i, row) in table.rows.iter().enumerate() {
        if row.len() != expected {
            return Err(BatchError::Row { row: i + 1, found: row.len(), expected });
        }
    }
    if let Some(row) = table.rows.first() {
        varied(model, &table.names, row)?;
    }
    if let Some([earlier, later]) = clash(model, &table.names) {
        return Err(BatchError::Clash { earlier: earlier.into(), later: later.into() });
    }
    let options = SolverOptions { brief: true, ..*options };
    // curves are checked and compiled once; what is wrong with them is a complaint of each run
    let known = model.check().ok().and_then(|()| Tables::of(model).ok());
    let one = |row: &Vec<f64>| {
        let own = varied(model, &table.names, row)?;
        let result = match &known {
            Some(known) => simulate_varied(&own, &options, known),
            None => simulate_with(&own, &options),
        };
        let result = result.map(|r| Summary::of(&r));
        done();
        Ok(result)
    };
    table.rows.par_iter().map(one).collect()
}
