//! Columns near their shear strength, which are bent to and fro.
//!
//! Tests went back and forth. Bending hardly minds, but shear does: diagonal cracks of both senses cut the concrete up, and a column that bears its shear in one push
//! loses it in cycles. So the columns whose shear force comes near the shear strength are bent again, in cycles; the rule is one for all columns, and nothing in it is fitted:
//!
//! - `V_p`: largest lateral force of the monotonic bend.
//! - `V_o`: shear strength of the undamaged column by ASCE 41-17, eq. 10-3 with `k = 1`, for its axial force and shear span.
//! - Above [`CRITICAL_SHARE`](crate::rc::shear::CRITICAL_SHARE) of `V_p / V_o` a column is cycled, once each in both senses at [`AMPLITUDES_RAD`], and the cycles are compared with the test.

use crate::rc::shear::{ShearDemand, asce_column_n};
use crate::verify::columns::Specimen;

/// Drifts of the cycles.
pub const AMPLITUDES_RAD: [f64; 9] = [0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.04, 0.05, 0.06];
/// Axis along which columns are pushed: y, along the depth.
const AXIS: usize = 1;

/// Shear strength `V_o` of the undamaged column \[N\].
pub fn strength_n(specimen: &Specimen) -> f64 {
    let axial_n = specimen.axial_force_n();
    asce_column_n(&specimen.section(), specimen.fc_pa, AXIS, axial_n, specimen.length_m)
}

/// Whether a column that bears `lateral_n` is cycled.
pub fn is_critical(lateral_n: f64, strength_n: f64) -> bool {
    ShearDemand { largest_n: lateral_n, strength_n }.is_critical()
}

/// Turning points of the cycles up to a drift; of that drift alone if it is smaller than all of them. The last way ends at its drift.
pub fn turns_rad(until_rad: f64) -> Vec<f64> {
    let mut amplitudes: Vec<f64> = AMPLITUDES_RAD.iter().copied().filter(|a| *a <= until_rad).collect();
    if amplitudes.is_empty() {
        amplitudes.push(until_rad);
    }
    amplitudes.iter().flat_map(|a| [*a, -a]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::columns::SPECIMENS;

    fn named(name: &str) -> &'static Specimen {
        SPECIMENS.iter().find(|s| s.name == name).unwrap()
    }

    #[test]
    fn shear_strengths_are_those_worked_by_hand() {
        // ties at 457 mm beyond d = 457.2 - 38.1 - 9.5 - 12.7 = 396.9 mm do not count; span 1473.2 / 396.9 = 3.712 d
        // sqrt(33.1) / 2 = 2.8766, / 3.712 = 0.7750; pressed by 0.0727 x 33.1 = 2.4064: sqrt(1.8365) = 1.3552; 0.8 x 209032 mm2
        let lynn = strength_n(named("Lynn 2CLH18"));
        assert!((lynn / 175.63e3 - 1.0).abs() < 1e-3, "{lynn}");
        // d = 550 - 40 - 10 - 12 = 488 mm, ties 4 x 78.54 / 80 x 297 x 488 = 569.2 kN; span 2.459 d
        // sqrt(23.1) / 2 = 2.4031, / 2.459 = 0.9773; 5.9991: sqrt(3.4964) = 1.8699; 0.8 x 302500 mm2: 442.2 kN
        let gill = strength_n(named("Gill No. 1"));
        assert!((gill / 1011.4e3 - 1.0).abs() < 1e-3, "{gill}");
    }

    #[test]
    fn columns_near_their_shear_strength_are_cycled() {
        let critical = |s: &Specimen, share: f64| is_critical(share * strength_n(s), strength_n(s));
        assert!(critical(named("Lynn 2CLH18"), 0.81) && !critical(named("Lynn 2CLH18"), 0.79));
        // by the largest moments that were measured over the spans: one above, one below
        let measured = |s: &Specimen| s.peak_moment_nm[0] / s.length_m;
        let [above, below] = ["Lynn 2CLH18", "Ohno L1"].map(named);
        assert!(is_critical(measured(above), strength_n(above)));
        assert!(!is_critical(measured(below), strength_n(below)));
    }

    #[test]
    fn cycles_go_up_to_the_drift_that_is_asked_for() {
        assert_eq!(turns_rad(0.08).len(), 18);
        assert_eq!(turns_rad(0.01), [0.005, -0.005, 0.01, -0.01]);
        assert_eq!(turns_rad(0.001), [0.001, -0.001]);
    }
}
