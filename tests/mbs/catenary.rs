//! Beams as bushings in their middle pull along the line between their ends.

use super::support::*;
use fallwerk::mbs::model::*;
use fallwerk::mbs::simulate;
use fallwerk::verify::mbs::catenary::{AXIAL_N_M, LENGTH_M, between_two};

/// Which way the axes point and which of them bends changes nothing (closed form: `fallwerk verify mbs`, case catenary).
#[test]
fn beams_pull_alike_whichever_way_their_axes_point() {
    let lowest = |sense: f64, across: usize| {
        let mut m = between_two(1e9, 1.0);
        track(&mut m, "mass", [0.0; 3]);
        m.bushings.iter_mut().for_each(|b| b.axes = [[sense, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, sense]]);
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
    let mut m = between_two(1e4, 1e8);
    track(&mut m, "mass", [0.0; 3]);
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
    let mut m = between_two(2e4, 1e6);
    track(&mut m, "mass", [0.0; 3]);
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
