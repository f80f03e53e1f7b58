//! A run with rigid parts against the full FE run of the same building.

use super::heap::Heap;
use super::points::{DebrisPoint, PointErrors, debris};
use super::{LIMIT_HYBRID, LIMIT_HYBRID_TIME, fe_dissipated_j};
use crate::fe::result::FeRun;
use crate::study::fell;
use serde::{Deserialize, Serialize};

/// What the comparison of a hybrid run with FE shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HybridValidation {
    /// Error up to the first ground contact of the FE run, or to the end if there is none; `None`: no tracked point is in both runs.
    pub e_to_contact: Option<f64>,
    /// Error from that contact to the end ([`super::measure::error_after`]); `None`: nothing touches the ground, or at the end only.
    pub e_after_contact: Option<f64>,
    /// Error over the whole run.
    pub e_total: Option<f64>,
    /// The same over the tracked points that do not become debris in the FE run.
    pub e_total_without_debris: Option<f64>,
    /// Tracked points that become debris in the hybrid run.
    pub debris: Vec<DebrisPoint>,
    /// First ground contact \[s\].
    pub first_contact_s: Option<f64>,
    /// Whether the structure collapsed.
    pub collapsed: bool,
    /// Energy error of the run.
    pub energy_error: f64,
    /// Energy dissipated by the end: internal, hourglass and contact work \[J\].
    pub dissipated_j: f64,
    /// Area of the common debris footprint with FE over that of the union at the end.
    pub footprint_overlap: f64,
    /// Processor time \[s\].
    pub cpu_s: f64,
    /// Wall time \[s\].
    pub wall_s: f64,
    /// Processor time over that of FE.
    pub cpu_share: f64,
    /// Whether rigid parts could deform again.
    pub switching: bool,
    /// Mean over time of the share of the acting elements that are rigid.
    pub mean_rigid_share: f64,
    /// Share of the element work that was left out.
    pub skipped_share: f64,
    /// Energy that switches between rigid and deforming added \[J\].
    pub switched_j: f64,
    /// Switches.
    pub switches: usize,
    /// `e(T)` at the output times.
    pub e_curve: Vec<f64>,
    /// `e(T)` over the tracked points that do not become debris in the FE run.
    pub e_curve_without_debris: Vec<f64>,
    /// Share of the acting elements that are rigid, at the output times.
    pub rigid_share: Vec<f64>,
}

impl HybridValidation {
    /// Compares a run with rigid parts with the full FE run.
    pub fn of(fe: &FeRun, run: &FeRun) -> Self {
        let history = |id: &str| run.tracked.iter().find(|p| p.id == id).map(|p| &p.displacement_m[..]);
        let errors = PointErrors::of(&fe.times_s, &fe.tracked, run.times_s.len(), history);
        let record = run.hybrid.clone().unwrap_or_default();
        let elapsed = run.summary.elapsed;
        Self {
            e_to_contact: errors.until(fe.summary.first_ground_contact_s),
            e_after_contact: errors.after(fe.summary.first_ground_contact_s),
            e_total: errors.until(None),
            e_total_without_debris: errors.without_debris(),
            debris: debris(run),
            first_contact_s: run.summary.first_ground_contact_s,
            collapsed: run.tracked.iter().any(|p| fell(&p.displacement_m)),
            energy_error: run.summary.energy_error,
            dissipated_j: fe_dissipated_j(run),
            footprint_overlap: Heap::of_fe(run).footprint.overlap(&Heap::of_fe(fe).footprint),
            cpu_s: elapsed.cpu_s,
            wall_s: elapsed.wall_s,
            cpu_share: elapsed.cpu_s / fe.summary.elapsed.cpu_s.max(1e-9),
            switching: record.switching,
            mean_rigid_share: record.rigid_share.iter().sum::<f64>() / record.rigid_share.len().max(1) as f64,
            skipped_share: record.skipped_share,
            switched_j: record.switched_j.last().copied().unwrap_or(0.0),
            switches: record.switches.len(),
            e_curve: errors.curve,
            e_curve_without_debris: errors.curve_without_debris,
            rigid_share: record.rigid_share,
        }
    }

    /// Whether the displacements are those of FE to the end of the run.
    pub fn is_close(&self) -> bool {
        self.e_total.is_some_and(|e| e <= LIMIT_HYBRID)
    }

    /// Whether the run is worth it.
    pub fn is_fast(&self) -> bool {
        self.cpu_share <= LIMIT_HYBRID_TIME
    }
}
