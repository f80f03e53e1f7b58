//! Beams as bushings in their middle pull along the line between their ends.

use super::support::*;
use fallwerk::curve::ResistanceCurve;
use fallwerk::mbs::model::*;
use fallwerk::mbs::simulate;

const LENGTH_M: f64 = 4.0;
const AXIAL_N_M: f64 = 1e7;
const MASS_KG: f64 = 2000.0;

/// A mass between two beams in a row that are clamped at their far ends, with hinges of a capacity at all ends; the axes point along x or against it.
fn between_two(capacity_nm: f64, shear_n_m: f64, sense: f64) -> Model {
    let mut m = model("mass between two beams", 1.0, 0.001);
    // the elastic part of the bending is that of the shear spring
    let stiffness_nm_rad = (shear_n_m * LENGTH_M * LENGTH_M / 12.0).max(1e4);
    m.curves.insert(
        "end".into(),
        ResistanceCurve { stiffness_nm_rad, ..curve(&[[0.0, capacity_nm], [2.0, capacity_nm]], 3.0) },
    );
    m.bodies.push(Body {
        mass_kg: MASS_KG,
        inertia_kg_m2: box_inertia(MASS_KG, [0.4; 3]),
        ..solid("mass", [0.0; 3], [0.4; 3])
    });
    for side in [-1.0, 1.0] {
        let ends = ["start", "end"].map(|place| format!("{place} {side}"));
        m.bushings.push(Bushing {
            axes: [[sense, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, sense]],
            shear_stiffness_n_m: [shear_n_m; 2],
            beam: Some(Beam { half_length_m: 0.5 * LENGTH_M, ends, span: None }),
            ..joint(
                &format!("beam {side}"),
                None,
                "mass",
                [side * 0.5 * LENGTH_M, 0.0, 0.0],
                AXIAL_N_M,
                1e6,
                [hinge("end"), elastic(stiffness_nm_rad)],
            )
        });
    }
    m.settings.time_step_s = Some(5e-5);
    track(&mut m, "mass", [0.0; 3]);
    m
}

/// Which way the axes point and which of them bends changes nothing (closed form: `fallwerk verify mbs`, case catenary).
#[test]
fn beams_pull_alike_whichever_way_their_axes_point() {
    let lowest = |sense: f64, across: usize| {
        let mut m = between_two(1e9, 1.0, sense);
        m.gravity_m_s2 = [0.0; 3];
        m.bodies[0].velocity_m_s[across] = -2.0;
        let result = simulate(&m).unwrap();
        assert!(result.energy_error < 1e-5, "{}", result.energy_error);
        result.tracked[0].displacement_m.iter().map(|d| d[across]).fold(0.0, f64::min)
    };
    let first = lowest(1.0, 2);
    assert!(first < -0.4, "{first}");
    for (sense, across) in [(-1.0, 2), (1.0, 1), (-1.0, 1)] {
        let other = lowest(sense, across);
        assert!((other / first - 1.0).abs() < 1e-9, "{other} {first}");
    }
}

/// What turns about the hinge at one end of a beam neither stretches nor presses it.
#[test]
fn a_body_that_turns_about_a_hinge_stays_on_its_circle() {
    let mut m = between_two(1e4, 1e8, 1.0);
    m.bushings.remove(0);
    m.settings.end_time_s = 0.5;
    let result = simulate(&m).unwrap();
    let last = result.tracked[0].displacement_m.last().unwrap();
    let far = (LENGTH_M - last[0]).hypot(last[2]);
    println!("{last:?}");
    assert!(last[2] < -0.8 && last[0] > 0.08, "{last:?}");
    // it pulls with some kilonewtons
    assert!((far - LENGTH_M).abs() < 3e4 / AXIAL_N_M, "{far}");
}

/// Momentum is kept, and all of the energy is found again, while two blocks swing about each other on a beam that flows, by half a turn.
#[test]
fn momentum_and_energy_are_kept_far_beyond_small_displacements() {
    let mut m = between_two(2e4, 1e6, 1.0);
    m.gravity_m_s2 = [0.0; 3];
    m.bushings.remove(0);
    let other = Body { id: "other".into(), position_m: [LENGTH_M, 0.0, 0.0], ..m.bodies[0].clone() };
    m.bodies.push(other);
    (m.bushings[0].body_a, m.bushings[0].body_b) = (Some("mass".into()), "other".into());
    m.bodies[0].velocity_m_s = [0.5, 1.0, 4.0];
    m.bodies[1].velocity_m_s = [-0.5, 1.0, -2.0];
    m.bodies[0].angular_velocity_rad_s = [0.3, 0.4, 0.2];
    m.settings.end_time_s = 2.0;
    track(&mut m, "other", [LENGTH_M, 0.0, 0.0]);
    let result = simulate(&m).unwrap();
    let [a, b] = [0, 1].map(|i| *result.tracked[i].displacement_m.last().unwrap());
    for k in 0..3 {
        let drift = m.bodies[0].velocity_m_s[k] + m.bodies[1].velocity_m_s[k];
        assert!((a[k] + b[k] - 2.0 * drift).abs() < 1e-9, "{a:?} {b:?}");
    }
    // they have changed places
    assert!(a[0] > LENGTH_M + b[0], "{a:?} {b:?}");
    assert!(result.energy_error < 1e-5, "{}", result.energy_error);
}
