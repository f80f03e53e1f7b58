//! The resistance curve of a member end: bending moment against rotation under axial force.
//!
//! A curve is measured (or computed, [`crate::rc`]) as an envelope of moment over chord rotation for
//! several constant axial forces. For use in a hinge it is split into a linear elastic part of
//! stiffness `K` and a capacity `C(α, N)` over accumulated plastic rotation `α`:
//! `θ = M / K + θ_p`, `|M| <= C(α, N)`, `α̇ = |θ̇_p|`. Unloading follows `K`.
//!
//! Sign conventions: axial force `N` is positive in **compression**. Units: rad, N m, N.

use serde::{Deserialize, Serialize};

/// Resistance about one bending axis, odd-symmetric in the rotation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ResistanceCurve {
    /// Elastic rotational stiffness `K` \[N m/rad\], also the stiffness of unloading.
    pub stiffness_nm_rad: f64,
    /// Capacity at increasing axial force; interpolated linearly in between, held constant outside.
    pub levels: Vec<CapacityLevel>,
}

/// Capacity at one constant axial force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CapacityLevel {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[plastic rotation (rad), capacity (N m)]`, first rotation zero, rotations increasing.
    pub capacity: Vec<[f64; 2]>,
    /// Accumulated plastic rotation at which the section separates \[rad\].
    pub fracture_rotation_rad: f64,
}
