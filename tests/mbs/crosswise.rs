//! Hinges that flow about both axes: order in the step, fracture, what is told within a step.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::model::{Body, Bushing, JointKind, Model};
use fallwerk::mbs::result::{EventKind, RunResult};
use fallwerk::mbs::simulate;

/// A body whose centre is `arm_m` from the point about which it spins on a hinge with such curves about both axes, on a spherical joint or on a bushing that bears nothing else.
fn spinning(arm_m: f64, curves: [ResistanceCurve; 2], held: bool, step_s: f64) -> Model {
    let mut m = Model::empty("spinning", [0.0; 3], 0.4, 0.01);
    m.settings.time_step_s = Some(step_s);
    let spin = [1.5, 0.2, 0.0];
    m.bodies.push(Body {
        inertia_kg_m2: [[2.0, 0.0, 0.0], [0.0, 5.0, 0.0], [0.0, 0.0, 3.0]],
        velocity_m_s: [spin[1] * arm_m, -spin[0] * arm_m, 0.0],
        angular_velocity_rad_s: spin,
        mass_kg: 15.0,
        shapes: Vec::new(),
        ..solid("b", [0.0, 0.0, arm_m], [1.0; 3])
    });
    let bending = ["c", "d"].map(hinge);
    m.curves = ["c", "d"].map(String::from).into_iter().zip(curves).collect();
    m.bushings.push(Bushing {
        joint: held.then(|| "j".into()),
        ..joint("h", None, "b", [0.0; 3], 0.0, 200.0, bending)
    });
    if held {
        m.joints.push(ideal("j", JointKind::Spherical, None, "b", [0.0; 3]));
    }
    m
}

fn law_of(stiffness_nm_rad: f64, capacity: &[[f64; 2]], fracture_rotation_rad: f64) -> ResistanceCurve {
    let level = CapacityLevel { axial_force_n: 0.0, capacity: capacity.to_vec(), fracture_rotation_rad };
    ResistanceCurve { stiffness_nm_rad, levels: vec![level], cyclic: None }
}

fn end(result: &RunResult) -> [f64; 4] {
    result.frames.last().unwrap().orientation[0]
}

/// Softening and unequal axes, where a step is shorter than the yield rotation and where it is longer.
#[test]
fn bushings_are_of_second_order() {
    for stiffness in [2e3, 6e4] {
        let curves = [9.0, 3.0].map(|c| law_of(stiffness, &[[0.0, c], [0.5, 0.3 * c], [9.0, 0.3 * c]], 9.0));
        let found = |step_s| end(&simulate(&spinning(0.0, curves.clone(), false, step_s)).unwrap());
        let fine = found(6.25e-5);
        let off = |step_s| {
            let q = found(step_s);
            (0..4).map(|i| (q[i] - fine[i]).powi(2)).sum::<f64>().sqrt()
        };
        let [coarse, half] = [2e-3, 1e-3].map(off);
        println!("{stiffness}: {coarse:.2e} {half:.2e}");
        assert!(coarse < 1e-5 && half < 0.35 * coarse, "{stiffness}: {coarse} {half}");
    }
}

/// What a hinge that snaps back as it fractures dissipates comes from what it has stored, and is not given back to the motion.
#[test]
fn a_hinge_that_snaps_back_as_it_fractures_keeps_its_energy() {
    let law = || law_of(300.0, &[[0.0, 20.0], [0.02, 20.0], [0.03, 4.0], [3.0, 4.0]], 0.04);
    for (step_s, within) in [(1e-3, 2e-5), (2.5e-4, 2e-6)] {
        let result = simulate(&spinning(0.0, [law(), law()], false, step_s)).unwrap();
        assert!(result.events.iter().any(|e| matches!(e.kind, EventKind::Fracture { .. })));
        assert!(result.energy_error < within, "{step_s}: {}", result.energy_error);
    }
}

/// A hinge that fractures has dissipated its capacity times its plastic rotation, whatever torsion is set free with it.
#[test]
fn a_hinge_that_fractures_sets_torsion_free_and_nothing_that_it_dissipated() {
    let law = || law_of(3e3, &[[0.0, 2.0], [9.0, 2.0]], 0.03);
    let mut m = spinning(0.0, [law(), law()], false, 1e-3);
    m.bodies[0].angular_velocity_rad_s[2] = 3.0;
    m.bushings[0].torsional_stiffness_nm_rad = 4e3;
    let result = simulate(&m).unwrap();
    assert!(result.events.iter().any(|e| matches!(e.kind, EventKind::Fracture { .. })));
    let plastic_j = result.energies.plastic_j.last().unwrap();
    assert!((plastic_j - 0.06).abs() < 2e-4, "{plastic_j}");
    assert!(result.energies.plastic_j.is_sorted() && result.energies.released_j.is_sorted());
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

/// Ellipses whose axes differ by seven orders of magnitude, about which a hinge turns round.
#[test]
fn the_thinnest_ellipse_takes_no_longer() {
    let laws = [3.0, 3e-7].map(|c| law_of(1e3, &[[0.0, c], [9.0, c]], 9.0));
    let result = simulate(&spinning(0.5, laws, true, 1e-3)).unwrap();
    assert!(result.energy_error < 1e-3 && result.steps == 400, "{} {}", result.energy_error, result.steps);
}

/// Outputs between the ends of long steps tell what short ones do.
#[test]
fn moments_and_axial_forces_within_a_step_are_those_of_their_time() {
    let law = || law_of(6e5, &[[0.0, 60.0], [9.0, 60.0]], 9.0);
    let run = |step_s| {
        let mut m = spinning(0.5, [law(), law()], true, step_s);
        (m.settings.end_time_s, m.settings.output_interval_s) = (0.06, 5e-4);
        simulate(&m).unwrap()
    };
    let (long, short) = (run(4e-3), run(2.5e-4));
    let [a, b] = [&long, &short].map(|r| &r.hinges[0]);
    // after the first steps, in which it begins to flow
    for i in 20..100 {
        let off = [0, 1].map(|k| a.moment_nm[i][k] - b.moment_nm[i][k]);
        assert!(off[0].hypot(off[1]) < 1.0, "{}: {:?} {:?}", long.times_s[i], a.moment_nm[i], b.moment_nm[i]);
        let forces = [a, b].map(|h| h.axial_force_n[i]);
        assert!(
            (forces[0] - forces[1]).abs() < 0.02 * forces[1].abs() + 0.02,
            "{} {forces:?}",
            long.times_s[i]
        );
        assert!(a.plastic_rotation_rad[i] >= a.plastic_rotation_rad[i - 1]);
    }
}
