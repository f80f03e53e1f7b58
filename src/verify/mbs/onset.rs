//! What begins to flow within a step dissipates what it does in small ones.
//!
//! A bushing of 100 kN/m a millimetre yields half a millimetre from its rest, which a body at 10 m/s crosses in the twentieth part of a step of a millisecond; leapfrog kicks by the mean force of start and end would take half of what it dissipates in it.

use super::contact::{energy, run};
use super::models::solid;
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Bending, Bushing, Model};
use crate::mbs::result::RunResult;
use crate::verify::{Case, Figure};

/// The body that is held \[kg\], what the bushing bears \[N\], and its stiffness \[N/m\].
const MASS_KG: f64 = 200.0;
const CAPACITY_N: f64 = 5e4;
const STIFFNESS_N_M: f64 = 1e8;
/// Moment of inertia of the body that turns \[kg m²\], what its hinge bears \[N m\], and its stiffness \[N m/rad\].
const INERTIA_KG_M2: f64 = 50.0;
const PLASTIC_NM: f64 = 1e3;
const STIFFNESS_NM_RAD: f64 = 1e7;
/// By how much the bushing lengthens until it breaks \[m\], and the rotation of the hinge \[rad\].
const ELONGATION_M: f64 = 0.01;
const FRACTURE_RAD: f64 = 0.05;
/// Steps \[s\] and how far off the energy may be in them: of second order, from the automatic step on.
const STEPS: [(Option<f64>, &str, f64); 3] =
    [(None, "automatic step", 1.5e-2), (Some(2.5e-4), "0.25 ms", 1e-3), (Some(5e-5), "0.05 ms", 1e-4)];

const TORN: &str = "T e + T²/2k";
const TURNED: &str = "M θ_f + M²/2K";
const HALTED: &str = "I ω²/2 - M²/2K";

/// The case of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::short(
        "onset",
        "A body of 200 kg at 3 and at 10 m/s tears itself off a bushing that bears 50 kN over 10 mm, and a body at 8 rad/s off a hinge that bears 1 kN m over 0.05 rad: the energy that they lose; at 2 rad/s over 5 rad, the hinge stops it: the energy that it dissipates. Elastic ranges are crossed within a step.",
        figures,
    )]
}

fn figures() -> Result<Vec<Figure>, String> {
    let mut figures = Vec::new();
    let torn_j = CAPACITY_N * ELONGATION_M + 0.5 * CAPACITY_N * CAPACITY_N / STIFFNESS_N_M;
    for speed in [3.0, 10.0] {
        for (step_s, name, within) in STEPS {
            let result = run(&pulled(speed, ELONGATION_M, step_s))?;
            let what = format!("lost at {speed} m/s, {name}");
            figures.push(Figure::relative(what, "J", [torn_j, lost_j(&result)], within, TORN));
            figures.extend(step_s.is_none().then(|| energy(&result, 1e-3)));
        }
    }
    let elastic_j = 0.5 * PLASTIC_NM * PLASTIC_NM / STIFFNESS_NM_RAD;
    let turned_j = PLASTIC_NM * FRACTURE_RAD + elastic_j;
    let result = run(&turned(8.0, FRACTURE_RAD))?;
    figures.push(Figure::relative("lost at 8 rad/s", "J", [turned_j, lost_j(&result)], 1e-3, TURNED));
    let result = run(&turned(2.0, 5.0))?;
    let plastic_j = result.energies.plastic_j.last().copied().unwrap_or(f64::NAN);
    let halted_j = 0.5 * INERTIA_KG_M2 * 4.0 - elastic_j;
    figures.push(Figure::relative("dissipated from 2 rad/s", "J", [halted_j, plastic_j], 1e-3, HALTED));
    Ok(figures)
}

/// The kinetic energy that a run takes \[J\].
pub fn lost_j(result: &RunResult) -> f64 {
    let kinetic = &result.energies.kinetic_j;
    kinetic[0] - kinetic[kinetic.len() - 1]
}

/// A body that flies away from the ground at a speed \[m/s\], held by the axial spring of a bushing that breaks after an elongation \[m\], in steps \[s\].
pub fn pulled(speed_m_s: f64, elongation_m: f64, step_s: Option<f64>) -> Model {
    let mut m = Model::empty("body torn off a bushing", [0.0; 3], 0.1, 0.005);
    m.settings.time_step_s = step_s;
    let mut body = solid("b", MASS_KG / 0.125, [0.5; 3], [1.0, 0.0, 0.0]);
    body.velocity_m_s = [speed_m_s, 0.0, 0.0];
    m.bodies.push(body);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    m.bushings.push(Bushing {
        axial_stiffness_n_m: STIFFNESS_N_M,
        tensile_capacity_n: Some(CAPACITY_N),
        tensile_elongation_m: Some(elongation_m),
        ..Bushing::free("h".into(), None, "b".into(), [0.0; 3], axes)
    });
    m
}

/// A body that turns at a rate \[rad/s\] against a hinge that breaks at a rotation \[rad\].
pub fn turned(rate_rad_s: f64, fracture_rad: f64) -> Model {
    let mut m = Model::empty("body turned off a hinge", [0.0; 3], 0.2, 0.005);
    let mut body = solid("b", MASS_KG / 0.125, [0.5; 3], [0.0; 3]);
    body.inertia_kg_m2 = [[INERTIA_KG_M2, 0.0, 0.0], [0.0, INERTIA_KG_M2, 0.0], [0.0, 0.0, INERTIA_KG_M2]];
    body.angular_velocity_rad_s = [0.0, rate_rad_s, 0.0];
    m.bodies.push(body);
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, PLASTIC_NM], [5.0, PLASTIC_NM]],
        fracture_rotation_rad: fracture_rad,
    };
    let curve = ResistanceCurve { stiffness_nm_rad: STIFFNESS_NM_RAD, levels: vec![level], cyclic: None };
    m.curves.insert("c".into(), curve);
    let hinge = || Bending::Curve { curve: "c".into(), strength_factor: 1.0 };
    let axes = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]];
    m.bushings.push(Bushing {
        bending: [hinge(), hinge()],
        ..Bushing::free("h".into(), None, "b".into(), [0.0; 3], axes)
    });
    m
}
