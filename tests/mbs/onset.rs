//! What begins to flow within a step, with other speeds, capacities and steps than the case `onset` of `fallwerk verify mbs`.

use fallwerk::mbs::simulate;
use fallwerk::verify::mbs::onset::{lost_j, pulled, turned};

/// The elastic range is crossed in a part of the first step: what is lost is `T e + T² / 2k`, to second order in the step. The mean of start and end alone loses up to half of it at 1 ms.
#[test]
fn a_bushing_that_breaks_at_once_takes_its_work_to_second_order() {
    let exact = 5e4 * 0.002 + 0.5 * 5e4 * 5e4 / 1e8;
    for (step_s, within) in [(None, 1.5e-2), (Some(1e-4), 2e-4), (Some(2e-5), 2e-5)] {
        let result = simulate(&pulled(10.0, 0.002, step_s)).unwrap();
        let error = lost_j(&result) / exact - 1.0;
        assert!(error.abs() < within, "{step_s:?}: {error:e}");
        assert!(result.energy_error < 1e-3, "{:e}", result.energy_error);
    }
}

/// The same of a hinge: `M θ_f + M² / 2K`.
#[test]
fn a_hinge_that_breaks_at_once_takes_its_work() {
    for (rate, fracture, within) in [(2.0, 0.05, 1e-3), (8.0, 0.01, 5e-3)] {
        let result = simulate(&turned(rate, fracture)).unwrap();
        let error = lost_j(&result) / (1e3 * fracture + 0.05) - 1.0;
        assert!(error.abs() < within, "{rate} rad/s, {fracture} rad: {error:e}");
    }
}
