//! Forces that begin to flow within a step dissipate what they do in a small one: closed forms of a mass that a bushing stops or lets go.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::model::*;
use fallwerk::mbs::{RunResult, simulate};

const MASS_KG: f64 = 200.0;
const CAPACITY_N: f64 = 5e4;
const STIFFNESS_N_M: f64 = 1e8;

fn lost_j(result: &RunResult) -> f64 {
    let kinetic = &result.energies.kinetic_j;
    kinetic[0] - kinetic[kinetic.len() - 1]
}

/// A mass that flies away from the ground, held by the axial spring of a bushing that flows and breaks.
fn pulled(speed_m_s: f64, elongation_m: f64, step_s: Option<f64>) -> Model {
    let mut m = model("pulled", 0.1, 0.005);
    m.gravity_m_s2 = [0.0; 3];
    m.settings.time_step_s = step_s;
    let mut body = solid("b", [1.0, 0.0, 0.0], [0.5; 3]);
    (body.mass_kg, body.velocity_m_s) = (MASS_KG, [speed_m_s, 0.0, 0.0]);
    body.shapes.clear();
    m.bodies.push(body);
    m.bushings.push(Bushing {
        axial_stiffness_n_m: STIFFNESS_N_M,
        tensile_capacity_n: Some(CAPACITY_N),
        tensile_elongation_m: Some(elongation_m),
        ..Bushing::free(
            "h".into(),
            None,
            "b".into(),
            [0.0; 3],
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        )
    });
    m
}

/// The elastic range is crossed in a part of the first step: what is lost is `T e + T² / 2k`, to second order in the step. The mean of begin and end alone loses up to half of it at 1 ms.
#[test]
fn a_spring_that_flows_at_once_takes_its_work() {
    for (speed, elongation) in [(3.0, 0.01), (10.0, 0.01), (10.0, 0.002)] {
        let exact = CAPACITY_N * elongation + 0.5 * CAPACITY_N * CAPACITY_N / STIFFNESS_N_M;
        for (step_s, within) in [(None, 1.5e-2), (Some(1e-4), 2e-4), (Some(2e-5), 2e-5)] {
            let result = simulate(&pulled(speed, elongation, step_s)).unwrap();
            let error = lost_j(&result) / exact - 1.0;
            assert!(error.abs() < within, "{speed} m/s, {elongation} m, {step_s:?}: {error:e}");
            assert!(result.energy_error < 1e-3, "{:e}", result.energy_error);
        }
    }
}

/// A body with a hinge that it turns until it has lost its energy, or until the hinge breaks.
fn turned(rate_rad_s: f64, fracture_rad: f64) -> Model {
    let mut m = model("turned", 0.2, 0.005);
    m.gravity_m_s2 = [0.0; 3];
    let mut body = solid("b", [0.0; 3], [0.5; 3]);
    body.shapes.clear();
    body.inertia_kg_m2 = [[50.0, 0.0, 0.0], [0.0, 50.0, 0.0], [0.0, 0.0, 50.0]];
    body.angular_velocity_rad_s = [0.0, rate_rad_s, 0.0];
    m.bodies.push(body);
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, 1e3], [5.0, 1e3]],
        fracture_rotation_rad: fracture_rad,
    };
    m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 1e7, levels: vec![level], cyclic: None });
    m.bushings.push(Bushing {
        bending: [hinge("c"), hinge("c")],
        ..Bushing::free(
            "h".into(),
            None,
            "b".into(),
            [0.0; 3],
            [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
        )
    });
    m
}

/// The same of a hinge: `M θ_f + M² / 2K`; and one that stops it turns by `T / M` less its elastic energy.
#[test]
fn a_hinge_that_flows_at_once_takes_its_work() {
    for (rate, fracture, within) in [(2.0, 0.05, 1e-3), (8.0, 0.05, 1e-3), (8.0, 0.01, 5e-3)] {
        let result = simulate(&turned(rate, fracture)).unwrap();
        let error = lost_j(&result) / (1e3 * fracture + 0.05) - 1.0;
        assert!(error.abs() < within, "{rate} rad/s, {fracture} rad: {error:e}");
    }
    let stopped = simulate(&turned(2.0, 5.0)).unwrap();
    let plastic = *stopped.energies.plastic_j.last().unwrap();
    assert!((plastic / (100.0 - 0.05) - 1.0).abs() < 1e-3, "{plastic}");
}
