//! A reinforced rectangular section as the detailed submodel needs it.

use crate::building::Bar;
use crate::material::concrete::ConcreteLaw;
use serde::{Deserialize, Serialize};

/// A reinforced rectangle. Axes: x along the width, y along the depth, origin in the centre.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RcSection {
    /// Width along x \[m\].
    pub width_m: f64,
    /// Depth along y \[m\].
    pub depth_m: f64,
    /// Longitudinal bars.
    pub bars: Vec<Bar>,
    /// Ties; `None`: none.
    pub ties: Option<RcTies>,
    /// Concrete.
    pub concrete: ConcreteLaw,
    /// Steel of the bars.
    pub steel: RcSteel,
}

/// Ties of a section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RcTies {
    /// Diameter \[m\].
    pub diameter_m: f64,
    /// Spacing along the member \[m\].
    pub spacing_m: f64,
    /// Legs along x and along y; 2 for a closed hoop alone, more with cross ties.
    pub legs: [f64; 2],
    /// Steel.
    pub steel: RcSteel,
}

/// Steel of bars or ties: elastic, then linear hardening to rupture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RcSteel {
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Yield strength \[Pa\].
    pub yield_pa: f64,
    /// Stress at the ultimate strain \[Pa\].
    pub ultimate_pa: f64,
    /// Strain at which hardening begins.
    pub hardening_strain: f64,
    /// Strain at which a bar ruptures.
    pub ultimate_strain: f64,
}

impl RcSection {
    /// Area of the gross section \[m²\].
    pub fn area_m2(&self) -> f64 {
        self.width_m * self.depth_m
    }

    /// Squash load of the concrete alone, `f_c A_g` \[N\]: axial shares are counted against it.
    pub fn squash_n(&self) -> f64 {
        self.concrete.compressive_strength_pa * self.area_m2()
    }
}

/// Bars evenly along all four faces, `per_face` on each, corner bars on both of theirs.
pub fn bars_around(size_m: [f64; 2], per_face: usize, diameter_m: f64, edge_m: f64) -> Vec<Bar> {
    let at = |axis: usize, i: usize| {
        let half = 0.5 * size_m[axis] - edge_m;
        half * (2.0 * i as f64 / (per_face - 1) as f64 - 1.0)
    };
    let outer = |i: usize| i == 0 || i == per_face - 1;
    let mut bars = Vec::new();
    for i in 0..per_face {
        for j in (0..per_face).filter(|j| outer(i) || outer(*j)) {
            bars.push(Bar { x_m: at(0, i), y_m: at(1, j), diameter_m });
        }
    }
    bars
}
