//! A study as a record in `kb/studies/`: the evidence behind rules.

use super::Facts;
use crate::fe::result::{FeRun, History};
use serde::{Deserialize, Serialize};

/// Version of the record format.
pub const STUDY_SCHEMA: u32 = 2;
/// Interval of the histories \[s\].
const INTERVAL_S: f64 = 0.1;

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
    /// How the tracked points move.
    pub motion: Motion,
}

/// Displacements of the tracked points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Interval, from zero on \[s\].
    pub interval_s: f64,
    /// Points.
    pub points: Vec<PointMotion>,
}

/// Displacements of a point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointMotion {
    /// Its id.
    pub id: String,
    /// When its elements failed, if they did \[s\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub debris_s: Option<f64>,
    /// Displacements, three numbers a time \[mm\].
    pub displacement_mm: Vec<i32>,
}

impl Motion {
    /// Of a run.
    pub fn of(run: &FeRun) -> Self {
        let output_s = run.times_s.get(1).copied().unwrap_or(INTERVAL_S);
        let every = (INTERVAL_S / output_s).round().max(1.0) as usize;
        let point = |h: &History| PointMotion {
            id: h.id.clone(),
            debris_s: h.debris_s,
            displacement_mm: (h.displacement_m.iter().step_by(every))
                .flat_map(|u| u.map(|x| (1e3 * x).round() as i32))
                .collect(),
        };
        Self { interval_s: every as f64 * output_s, points: run.tracked.iter().map(point).collect() }
    }
}

impl Motion {
    /// The times \[s\].
    pub fn times_s(&self) -> Vec<f64> {
        let count = self.points.iter().map(|p| p.displacement_mm.len() / 3).max().unwrap_or(0);
        (0..count).map(|i| i as f64 * self.interval_s).collect()
    }

    /// The displacements, as those of a run.
    pub fn histories(&self) -> Vec<History> {
        let of = |p: &PointMotion| History {
            id: p.id.clone(),
            displacement_m: (p.displacement_mm.chunks_exact(3))
                .map(|u| std::array::from_fn(|i| 1e-3 * f64::from(u[i])))
                .collect(),
            debris_s: p.debris_s,
        };
        self.points.iter().map(of).collect()
    }
}

impl Study {
    /// A record of a run.
    pub fn new(building: &str, building_hash: String, mesh_size_m: f64, run: &FeRun, facts: Facts) -> Self {
        Self {
            schema: STUDY_SCHEMA,
            building: building.to_string(),
            building_hash,
            program_version: env!("CARGO_PKG_VERSION").to_string(),
            mesh_size_m,
            elements: run.summary.elements,
            steps: run.summary.steps,
            energy_error: run.summary.energy_error,
            facts,
            motion: Motion::of(run),
        }
    }
}
