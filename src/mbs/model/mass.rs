//! Inertial coupling of bodies: consistent minus lumped mass.

use serde::{Deserialize, Serialize};

/// Inertia of bodies that belong to one elastic body: that of its mass as it moves between them, less that of the mass as it moves with one of them each (consistent mass; Archer, J. Struct. Div. ASCE 89 (1963) ST4, 161).
///
/// Each body has three velocities here: that of its centre of mass along z, and its angular velocities about x and y, in the global frame. A body that latent bushings hold to others stands for all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SharedMass {
    /// The bodies.
    pub bodies: Vec<String>,
    /// Blocks of the symmetric matrix, each pair of bodies once, the first one not after the second.
    pub blocks: Vec<MassBlock>,
}

/// What two of the bodies, or one of them, have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MassBlock {
    /// Places in the list of bodies, which the rows and columns belong to.
    pub pair: [usize; 2],
    /// Mass \[kg\], static moments \[kg m\] and moments of inertia \[kg m²\].
    pub added: [[f64; 3]; 3],
}
