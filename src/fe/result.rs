//! What an FE run of a building leaves behind.

use super::contact::ContactSummary;
use super::dynamics::Death;
use super::erosion::ErosionTable;
use super::hybrid::HybridRecord;
use super::mass_scaling::MassScaling;
use super::mesh::{Mesh, Snapped};
use super::section_force::BrokenSection;
use super::truss::BarRupture;
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
    /// Node positions over time, if the run was to keep them (`FeOptions::keep_frames`); of large runs not at every output.
    /// Nodes copied when elements are detached come last, and stand where the node they were copied from stands until then.
    pub frames: Vec<KeptFrame>,
    /// Node positions at the end \[m\].
    pub last_m: Vec<[f32; 3]>,
    /// Equivalent strain rates of the elements.
    pub strain_rates: StrainRates,
    /// Plastic strain of each element at the end.
    pub plastic_strain: Vec<f64>,
    /// Element deaths in order.
    pub deaths: Vec<ElementDeath>,
    /// Sections of columns, beams and walls of which elements failed, in order, with what they bore before.
    pub broken: Vec<BrokenSection>,
    /// Ruptures of bars in order.
    pub ruptures: Vec<BarRupture>,
    /// First contact of each part with ground or obstacle, in order.
    pub touches: Vec<Touch>,
    /// Energies.
    pub energies: Vec<FeEnergies>,
    /// Rigid parts over time, if the run was to have any.
    pub hybrid: Option<HybridRecord>,
    /// Element-steps that were left out because nothing moved; not in result files.
    pub resting_steps: u64,
    /// Statistics.
    pub summary: FeSummary,
}

/// Node positions at one output, and how the elements deform there: 6 bytes an element beside 12 a node.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct KeptFrame {
    /// Number of the output: its time is `times_s[output]`.
    pub output: usize,
    /// Positions \[m\].
    pub nodes_m: Vec<[f32; 3]>,
    /// Whether each element strained faster than the critical rate over the output interval that ends here.
    pub fast: Vec<bool>,
    /// Whether each element was part of a rigid set; empty in a run without rigid parts.
    pub rigid: Vec<bool>,
    /// Equivalent plastic strain of each element.
    pub plastic_strain: Vec<f32>,
}

/// Extremes of the equivalent strain rates over output intervals, of each element.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StrainRates {
    /// Rate above which an element does not count as rigid \[1/s\].
    pub critical_1_s: f64,
    /// Largest rate \[1/s\].
    pub peak_1_s: Vec<f32>,
    /// End of the first interval with a rate above the critical one \[s\]; `None`: there was none.
    pub first_s: Vec<Option<f64>>,
}

impl StrainRates {
    /// Nothing has strained yet.
    pub fn new(elements: usize, critical_1_s: f64) -> Self {
        Self { critical_1_s, peak_1_s: vec![0.0; elements], first_s: vec![None; elements] }
    }

    /// Takes the rates of all elements over the interval that ends at this time.
    pub fn add(&mut self, time_s: f64, rates_1_s: &[f32]) {
        for (e, rate) in rates_1_s.iter().enumerate() {
            self.peak_1_s[e] = self.peak_1_s[e].max(*rate);
            if f64::from(*rate) > self.critical_1_s {
                self.first_s[e].get_or_insert(time_s);
            }
        }
    }
}

/// Displacement from the preloaded state of one point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct History {
    /// Tracked point id.
    pub id: String,
    /// Displacements \[m\].
    pub displacement_m: Vec<[f64; 3]>,
    /// First output at which the elements that carried the point had failed \[s\]: from then on it is a point mass of debris, or stays where the
    /// last of its member was. `None`: it is part of the structure to the end.
    pub debris_s: Option<f64>,
}

/// The end of an element.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
    /// Largest normal force of the surface on the part, as a mean over an output interval \[N\].
    pub force_n: f64,
}

/// Energies at one time \[J\]; the balance is
/// `kinetic + internal + hourglass + viscous = initial + gravity + contact + friction + removed + released + switched + residual`, where what
/// switches to rigid parts added is in [`HybridRecord::switched_j`].
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
    /// Energy that left the balance with removed members (negative), the work of the forces included that they leave over the duration of a removal.
    pub removed_j: f64,
    /// Work booked for forces of dying elements that no longer acted.
    pub released_j: f64,
    /// Elastic energy lost with eroded elements, part of `eroded_j`.
    pub eroded_elastic_j: f64,
    /// Part of `kinetic_j` in nodes that belong to no acting element.
    pub free_kinetic_j: f64,
    /// What is missing.
    pub residual_j: f64,
}

impl FeEnergies {
    /// All of them by a function.
    #[must_use]
    pub fn map(self, of: impl Fn(f64) -> f64) -> Self {
        Self {
            kinetic_j: of(self.kinetic_j),
            internal_j: of(self.internal_j),
            eroded_j: of(self.eroded_j),
            hourglass_j: of(self.hourglass_j),
            viscous_j: of(self.viscous_j),
            gravity_j: of(self.gravity_j),
            contact_j: of(self.contact_j),
            friction_j: of(self.friction_j),
            removed_j: of(self.removed_j),
            released_j: of(self.released_j),
            eroded_elastic_j: of(self.eroded_elastic_j),
            free_kinetic_j: of(self.free_kinetic_j),
            residual_j: of(self.residual_j),
        }
    }
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
    /// Iterations of the static preload; 0 if it was found by relaxation.
    pub preload_iterations: usize,
    /// Cycles of the relaxation that found the static preload, if the sparse solve did not.
    pub relaxation_cycles: Option<usize>,
    /// Mass added for a longer time step, if that was asked for.
    pub mass_scaling: Option<MassScaling>,
    /// First contact of a part that does not stand on the ground with the ground \[s\].
    pub first_ground_contact_s: Option<f64>,
    /// Eroded elements at the end.
    pub eroded_elements: usize,
    /// Bars that ruptured.
    pub ruptured_bars: usize,
    /// What failed elements took out of the structure, and the debris nodes at the end.
    pub erosion: ErosionTable,
    /// Largest energy residual over the largest of kinetic + internal energy and work of gravity.
    pub energy_error: f64,
    /// Largest hourglass over internal energy, after 1 % of the work of gravity has been done.
    pub hourglass_share: f64,
    /// Share of the element-steps that was left out because nothing moved, since elements were packed last; all of them: [`FeRun::resting_steps`].
    pub quiet_share: f64,
    /// Contact of the building's parts with each other; absent if it was switched off.
    pub body_contact: Option<ContactSummary>,
    /// Time taken.
    pub elapsed: Elapsed,
}
