//! Members that bend between two bushings.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::RunResult;
use fallwerk::mbs::simulate;

const LENGTH_M: f64 = 4.0;
const MASS_KG: f64 = 1000.0;
/// Of both bushings.
const SHEAR_N_M: f64 = 2e8;

/// A block on a column clamped at the ground, its centre beside the axis of the column; the axes at the top have the sense of those at the foot or, but for that along x, the opposite one.
fn column(column_kg: f64, bending_nm2: f64, beside_m: f64, same_sense: bool) -> Model {
    let mut m = model("column", 0.01, 0.01);
    let own = solid("column", [0.0, 0.0, 0.5 * LENGTH_M], [0.2, 0.2, LENGTH_M]);
    let scale = column_kg / own.mass_kg;
    m.bodies.push(Body {
        mass_kg: column_kg,
        inertia_kg_m2: own.inertia_kg_m2.map(|r| r.map(|x| scale * x)),
        ..own
    });
    let block = solid("block", [beside_m, 0.0, LENGTH_M], [0.1, 0.1, 0.1]);
    m.bodies.push(Body { mass_kg: MASS_KG, inertia_kg_m2: box_inertia(MASS_KG, [0.1; 3]), ..block });
    let spring = 6.0 * bending_nm2 / LENGTH_M;
    let ends = [elastic(spring), elastic(spring)];
    let stiff = SHEAR_N_M;
    m.bushings.push(joint("foot", None, "column", [0.0; 3], stiff, stiff, ends.clone()));
    let axes = if same_sense { UP } else { [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]] };
    let flexibility = LENGTH_M / (6.0 * bending_nm2);
    m.bushings.push(Bushing {
        axes,
        carry_over: Some(CarryOver { bushing: "foot".into(), flexibility_rad_nm: [flexibility; 2] }),
        ..joint("top", Some("block"), "column", [0.0, 0.0, LENGTH_M], stiff, stiff, ends)
    });
    track(&mut m, "block", [0.0, 0.0, LENGTH_M]);
    m
}

#[test]
fn a_column_bends_as_a_beam_under_moment_and_force() {
    let bending = 1e9;
    for same_sense in [true, false] {
        let mut m = column(1.0, bending, 0.5, same_sense);
        m.settings.preload = true;
        m.gravity_m_s2 = [0.0, 3.0, -G];
        let at = simulate(&m).unwrap().tracked[0].origin_m;
        // about y a moment W e all along, across y a force at the top (Euler and Bernoulli)
        let moment = MASS_KG * G * 0.5 * LENGTH_M.powi(2) / (2.0 * bending);
        let force = MASS_KG * 3.0 * (LENGTH_M.powi(3) / (3.0 * bending) + 2.0 / SHEAR_N_M);
        println!("{:.6e} {moment:.6e}, {:.6e} {force:.6e}", at[0], at[1]);
        assert!((at[0] / moment - 1.0).abs() < 2e-3, "{} {moment}", at[0]);
        assert!((at[1] / force - 1.0).abs() < 2e-3, "{} {force}", at[1]);
    }
}

fn swing(step_s: Option<f64>) -> RunResult {
    let mut m = column(100.0, 1e7, 0.0, false);
    m.settings.time_step_s = step_s;
    (m.settings.end_time_s, m.settings.output_interval_s) = (1.0, 0.001);
    m.bodies[1].velocity_m_s = [0.1, 0.0, 0.0];
    // the slope at the top of a cantilever is 1.5 times that of its chord
    m.bodies[1].angular_velocity_rad_s = [0.0, 0.15 / LENGTH_M, 0.0];
    m.bodies[0].velocity_m_s = [0.05, 0.0, 0.0];
    m.bodies[0].angular_velocity_rad_s = [0.0, 0.1 / LENGTH_M, 0.0];
    simulate(&m).unwrap()
}

/// A mass at the top of a clamped column: `ω² = 3 E I / (m L³)`, with a third of the column's mass, which turns as its chord does.
#[test]
fn it_swings_as_a_beam_and_keeps_its_energy() {
    let result = swing(None);
    let along: Vec<f64> = result.tracked[0].displacement_m.iter().map(|u| u[0]).collect();
    let zeros: Vec<f64> = (1..along.len())
        .filter(|i| along[i - 1] > 0.0 && along[*i] <= 0.0)
        .map(|i| result.times_s[i - 1] + 1e-3 * along[i - 1] / (along[i - 1] - along[i]))
        .collect();
    let period = (zeros[zeros.len() - 1] - zeros[0]) / (zeros.len() - 1) as f64;
    // gravity on the bent column: its geometric stiffness, m g / L for a straight chord, is half a hundredth
    let flexibility = LENGTH_M.powi(3) / 3e7 + 2.0 / SHEAR_N_M;
    let stiffness = 1.0 / flexibility - 1.05 * MASS_KG * G / LENGTH_M;
    let wanted = std::f64::consts::TAU * ((MASS_KG + 100.0 / 3.0) / stiffness).sqrt();
    println!("{period:.5} {wanted:.5} s, energy {:.1e}", result.energy_error);
    assert!((period / wanted - 1.0).abs() < 3e-3, "{period} {wanted}");
    let errors = [1.0, 0.5, 0.25].map(|share| swing(Some(share * 4e-5)).energy_error);
    println!("{errors:?}");
    assert!(errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0, "{errors:?}");
}

/// A column that vibrates between its ends near the limit of stability: 30,000 steps at the automatic step take nothing from it, since what its ends carry over is solved and not extrapolated.
#[test]
fn a_column_that_vibrates_keeps_its_energy() {
    let mut m = column(100.0, 1e7, 0.0, false);
    (m.settings.end_time_s, m.settings.output_interval_s) = (5.0, 0.001);
    // 0.75 of the limit: leans go on from step to step, which takes the more the nearer vibrations are to it
    m.settings.time_step_s = Some(1e-3 / 6.0);
    m.bodies[0].angular_velocity_rad_s = [0.0, 1.0, 0.0];
    for bushing in &mut m.bushings {
        bushing.axial_stiffness_n_m = 1e8;
        (bushing.shear_stiffness_n_m, bushing.torsional_stiffness_nm_rad) = ([2e7; 2], 2e7);
    }
    let result = simulate(&m).unwrap();
    let e = &result.energies;
    let mean = |from: usize| (from..from + 200).map(|i| e.total_j(i)).sum::<f64>() / 200.0;
    let most = e.kinetic_j.iter().cloned().fold(0.0, f64::max);
    let drift = (mean(1) - mean(e.kinetic_j.len() - 200)) / most;
    println!("{} steps, drift {drift:.1e}", result.steps);
    assert!(drift.abs() < 1e-5, "{drift}");
}

#[test]
fn a_column_that_breaks_at_one_end_keeps_the_balance_of_energy() {
    let mut m = column(500.0, 2e7, 0.6, true);
    m.curves.insert("weak".into(), curve(&[[0.0, 4e3], [0.02, 4e3]], 0.02));
    m.settings.end_time_s = 0.6;
    m.bushings[1].bending = [hinge("weak"), hinge("weak")];
    let result = simulate(&m).unwrap();
    assert!(result.events.iter().any(|e| format!("{e:?}").contains("Fracture")), "{:?}", result.events);
    assert!(result.energy_error < 2e-3, "{}", result.energy_error);
}

#[test]
fn what_cannot_carry_over_is_said() {
    let said = |change: fn(&mut Model)| {
        let mut m = column(100.0, 1e7, 0.0, true);
        change(&mut m);
        m.check().unwrap_err().to_string()
    };
    let text = said(|m| m.bushings[1].carry_over.as_mut().unwrap().bushing = "fot".into());
    assert!(text.contains("bushings[1].carry_over.bushing") && text.contains("foot"), "{text}");
    let text = said(|m| m.bushings[1].carry_over.as_mut().unwrap().bushing = "top".into());
    assert!(text.contains("is not at the other end of \"column\""), "{text}");
    let text = said(|m| m.bushings[1].carry_over.as_mut().unwrap().flexibility_rad_nm[0] = -1.0);
    assert!(text.contains("bushings[1].carry_over.flexibility_rad_nm[0]"), "{text}");
    let text = said(|m| m.bushings[1].axes = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
    assert!(text.contains("is not parallel"), "{text}");
    let text = said(|m| {
        m.bushings[0].carry_over = Some(CarryOver { bushing: "top".into(), flexibility_rad_nm: [0.0; 2] })
    });
    assert!(text.contains("already"), "{text}");
}
