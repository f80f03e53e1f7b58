//! The slab as a system of one degree of freedom, to find the strain rate at which its strengths are taken.
//!
//! Elastic-plastic, mass `K_LM ρ h` with `K_LM` 0.78 while it is elastic and 0.66 once it yields, stiffness `384 E I / (5 L⁴ b)` with the mean of the gross and the
//! cracked second moment of area, resistance `8 M / (L² b)`: a simple span under uniform load (Biggs, Introduction to Structural Dynamics, 1964, table 5.1;
//! UFC 3-340-02, 4-13). After yield both halves turn about the middle; the curvature there is spread over `l_p = d / 2 + 0.05 L / 2` on each side
//! (Mattock, discussion of Corley, J. Struct. Div. ASCE 93 (1967)). With the mean deflection rate `v` from yield to the peak the curvature rate is
//! `4 v / (L 2 l_p)`, the strain rate in the bars that times their distance from the neutral axis, the one in the compressed face that times the axis' depth.
//! Strengths and rate are found in turn, from static strengths. Nothing in it is taken from the test but its load, sizes and static strengths.

use super::slab_model::Load;
use super::slab_model::{
    BAR_AREA_M2, BARS, HEIGHT_M, SPAN_M, WIDTH_M, concrete, depth_m, pressure_pa, steel,
};

/// What the estimate says.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    /// Strain rate of the yielding bars \[1/s\].
    pub steel_1_s: f64,
    /// Strain rate of the compressed face \[1/s\].
    pub concrete_1_s: f64,
    /// Largest deflection \[m\] and its time \[s\].
    pub peak: [f64; 2],
    /// Resistance over the span \[Pa\].
    pub resistance_pa: f64,
}

/// Rounds of strengths and rate: the rate changes by less than 1e-3 after the third.
const ROUNDS: usize = 6;
const STEP_S: f64 = 1e-5;

/// The estimate for a load.
pub fn estimate(load: Load) -> Estimate {
    let mut found = Estimate { steel_1_s: 0.0, concrete_1_s: 0.0, peak: [0.0; 2], resistance_pa: 0.0 };
    for _ in 0..ROUNDS {
        found = round(load, found);
    }
    found
}

fn round(load: Load, before: Estimate) -> Estimate {
    let (steel, concrete) = (steel().at_rate(before.steel_1_s), concrete().at_rate(before.concrete_1_s));
    let (area, d) = (BARS as f64 * BAR_AREA_M2, depth_m());
    let block = area * steel.yield_strength_pa / (0.85 * concrete.compressive_strength_pa * WIDTH_M);
    let moment = area * steel.yield_strength_pa * (d - 0.5 * block);
    let ratio = steel.youngs_modulus_pa / concrete.youngs_modulus_pa;
    // neutral axis x of the cracked elastic section: b x² / 2 = n A (d - x)
    let q = ratio * area / WIDTH_M;
    let axis = (q * q + 2.0 * q * d).sqrt() - q;
    let cracked = WIDTH_M * axis.powi(3) / 3.0 + ratio * area * (d - axis).powi(2);
    let inertia = 0.5 * (cracked + WIDTH_M * HEIGHT_M.powi(3) / 12.0);
    let stiffness = 384.0 * concrete.youngs_modulus_pa * inertia / (5.0 * SPAN_M.powi(4) * WIDTH_M);
    let resistance_pa = 8.0 * moment / (SPAN_M * SPAN_M * WIDTH_M);
    let mass = concrete.density_kg_m3 * HEIGHT_M;
    let (mut t, mut w, mut v, mut yielded) = (0.0, 0.0, 0.0, None);
    while v >= 0.0 && t < 0.2 {
        if yielded.is_none() && stiffness * w >= resistance_pa {
            yielded = Some([w, t]);
        }
        let held = (stiffness * w).min(resistance_pa);
        let factor = if yielded.is_some() { 0.66 } else { 0.78 };
        v += STEP_S * (pressure_pa(load, t) - held) / (factor * mass);
        w += STEP_S * v;
        t += STEP_S;
    }
    let from = yielded.unwrap_or([0.0; 2]);
    let speed = (w - from[0]) / (t - from[1]);
    let hinge = 2.0 * (0.5 * d + 0.05 * 0.5 * SPAN_M);
    let curvature_rate = 4.0 * speed / (SPAN_M * hinge);
    let depth = block / 0.8;
    Estimate {
        steel_1_s: curvature_rate * (d - depth),
        concrete_1_s: curvature_rate * depth,
        peak: [w, t],
        resistance_pa,
    }
}
