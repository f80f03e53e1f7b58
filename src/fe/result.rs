//! What an FE run of a building leaves behind.

use super::contact::ContactSummary;
use super::dynamics::Death;
use super::mesh::{Mesh, Snapped};
use crate::base::cpu::Elapsed;
use serde::{Deserialize, Serialize};

/// Results of an FE run. Everything indexed by time has one value for each of `times_s`.
#[derive(Debug, Clone)]
pub struct FeRun {
    /// The mesh.
    pub mesh: Mesh,
    /// Members whose volume the mesh does not reproduce exactly.
    pub snapped: Vec<Snapped>,
    /// Output times, the first is 0: dead-load equilibrium just before the first event \[s\].
    pub times_s: Vec<f64>,
    /// Displacement histories of the tracked points.
    pub tracked: Vec<History>,
    /// Node positions at each output time \[m\].
    pub frames_m: Vec<Vec<[f32; 3]>>,
    /// Equivalent strain rate of each element over the output interval that ends at each time \[1/s\].
    pub strain_rates_1_s: Vec<Vec<f32>>,
    /// Plastic strain of each element at the end.
    pub plastic_strain: Vec<f64>,
    /// Element deaths in order.
    pub deaths: Vec<ElementDeath>,
    /// First contact of each part with ground or obstacle, in order.
    pub touches: Vec<Touch>,
    /// Energies.
    pub energies: Vec<FeEnergies>,
    /// Statistics.
    pub summary: FeSummary,
}

/// Displacement from the preloaded state of one point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// Tracked point id.
    pub id: String,
    /// Displacements \[m\].
    pub displacement_m: Vec<[f64; 3]>,
}

/// The end of an element.
#[derive(Debug, Clone, Copy)]
pub struct ElementDeath {
    /// Element index.
    pub element: usize,
    /// Time \[s\].
    pub time_s: f64,
    /// Why.
    pub cause: Death,
}

/// First contact of a part with a rigid surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// Time \[s\].
    pub time_s: f64,
    /// Member id.
    pub part: String,
    /// `ground` or the obstacle's id.
    pub surface: String,
}

/// Energies at one time \[J\]; the balance is
/// `kinetic + internal + hourglass + viscous = initial + gravity + contact + friction + removed + residual`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FeEnergies {
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// Work of the stresses: elastic energy and plastic dissipation, eroded elements included.
    pub internal_j: f64,
    /// Share of `internal_j` in elements that have eroded.
    pub eroded_j: f64,
    /// Work against hourglass control.
    pub hourglass_j: f64,
    /// Work against bulk viscosity.
    pub viscous_j: f64,
    /// Work of gravity since the preloaded state.
    pub gravity_j: f64,
    /// Work of contact normal forces on the structure (negative).
    pub contact_j: f64,
    /// Work of friction on the structure (negative).
    pub friction_j: f64,
    /// Energy that left the balance with removed members (negative).
    pub removed_j: f64,
    /// What is missing.
    pub residual_j: f64,
}

/// Statistics of a run.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FeSummary {
    /// Elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Mass of the meshed building \[kg\].
    pub mass_kg: f64,
    /// Time steps.
    pub steps: u64,
    /// First time step \[s\].
    pub time_step_s: f64,
    /// Iterations of the static preload.
    pub preload_iterations: usize,
    /// First contact of a part that does not stand on the ground with the ground \[s\].
    pub first_ground_contact_s: Option<f64>,
    /// Eroded elements at the end.
    pub eroded_elements: usize,
    /// Largest energy residual over the largest of kinetic + internal energy and work of gravity.
    pub energy_error: f64,
    /// Largest hourglass over internal energy, after 1 % of the work of gravity has been done.
    pub hourglass_share: f64,
    /// Contact of the building's parts with each other; absent if it was switched off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub body_contact: Option<ContactSummary>,
    /// Time taken.
    pub elapsed: Elapsed,
}
