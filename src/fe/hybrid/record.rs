//! What switching did: the partition over time, each switch with its reason, and what it did to the energy.

use serde::{Deserialize, Serialize};

/// Why elements switched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// To rigid: they have been quiet for long enough, or the study says so.
    Quiet,
    /// To deformable: one of their nodes is about to meet something.
    Contact,
    /// To deformable: an element beside them flows.
    Flow,
    /// To deformable: the loads on their set would make them flow.
    Overload,
    /// To deformable: what is left of their set is too small.
    Remnant,
    /// To deformable: a charge goes off.
    Charge,
    /// Asked for from outside.
    Asked,
}

/// One switch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Switch {
    /// Time \[s\].
    pub time_s: f64,
    /// Why.
    pub reason: Reason,
    /// Elements that switched.
    pub elements: usize,
    /// Elements that are rigid after it.
    pub rigid: usize,
    /// Rigid sets after it.
    pub sets: usize,
    /// Change of energy by it \[J\]; only hand-overs to rigid motion have one.
    pub energy_j: f64,
}

/// The books of switching.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Books {
    /// Energy that switches added, negative if they took it \[J\].
    pub switched_j: f64,
    /// Element-steps that were not computed because the element was rigid.
    pub skipped: u64,
    /// Checks of loads on rigid sets, and factorisations for them.
    pub checks: [u64; 2],
    /// All switches.
    pub switches: Vec<Switch>,
}

/// The partition over time, one value an output, and the switches.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct HybridRecord {
    /// Whether rigid parts could deform again ([`super::HybridSettings::softens`]).
    pub switching: bool,
    /// Share of the acting elements that are rigid.
    pub rigid_share: Vec<f64>,
    /// Rigid sets.
    pub sets: Vec<usize>,
    /// Energy that switches have added until then \[J\].
    pub switched_j: Vec<f64>,
    /// Mean over time of the share of the element work that was left out.
    pub skipped_share: f64,
    /// Checks of loads on rigid sets.
    pub checks: u64,
    /// Factorisations for them.
    pub factors: u64,
    /// All switches.
    pub switches: Vec<Switch>,
}
