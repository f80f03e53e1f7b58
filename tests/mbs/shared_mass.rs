//! Bodies that share inertia: a beam of two rigid halves has the frequencies of a finite element.

use super::support::*;
use fallwerk::curve::ResistanceCurve;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::{EventKind, RunResult};
use fallwerk::mbs::{error::SolveError, simulate};
use std::f64::consts::PI;

const LENGTH_M: f64 = 4.0;
const MASS_KG: f64 = 1000.0;
const BENDING_N_M2: f64 = 1e6;

/// Uniform beam in two halves along x that nothing holds, and a block on a stiff spring that sets the step.
pub(super) fn halves() -> Model {
    let mut m = model("halves", 0.4, 2.5e-4);
    m.gravity_m_s2 = [0.0; 3];
    for (id, x) in [("a", 0.25 * LENGTH_M), ("b", 0.75 * LENGTH_M)] {
        let size = [0.5 * LENGTH_M, 0.1, 0.1];
        let mass_kg = 0.5 * MASS_KG;
        // thin
        let mut inertia_kg_m2 = box_inertia(mass_kg, [size[0], 0.0, 0.0]);
        inertia_kg_m2[0][0] = 0.5;
        m.bodies.push(Body { mass_kg, inertia_kg_m2, ..solid(id, [x, 0.0, 0.0], size) });
    }
    m.bodies.push(Body {
        mass_kg: 100.0,
        inertia_kg_m2: box_inertia(100.0, [1.0; 3]),
        ..solid("block", [0.0, 9.0, 0.0], [1.0; 3])
    });
    let shear = 12.0 * BENDING_N_M2 / LENGTH_M.powi(3);
    let turn = BENDING_N_M2 / LENGTH_M;
    let along = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let middle = [0.5 * LENGTH_M, 0.0, 0.0];
    let ends = || [elastic(turn), elastic(turn)];
    m.bushings.push(Bushing { axes: along, ..joint("middle", Some("a"), "b", middle, shear, turn, ends()) });
    m.bushings.push(joint("stiff", None, "block", [0.0, 9.0, 0.0], 1e10, 1e8, [elastic(1e8), elastic(1e8)]));
    for (body, x) in [("a", 0.0), ("a", 0.5), ("b", 0.5), ("b", 1.0)] {
        track(&mut m, body, [x * LENGTH_M, 0.0, 0.0]);
    }
    m
}

/// Cubic shape functions less rigid halves, for displacement and slope of both ends, transformed to the centres of the halves: v + ω_y l/4, -ω_y at one end, v - ω_y l/4, -ω_y at the other.
pub(super) fn shared() -> SharedMass {
    let l = LENGTH_M;
    let consistent = [
        [156.0, 22.0 * l, 54.0, -13.0 * l],
        [22.0 * l, 4.0 * l * l, 13.0 * l, -3.0 * l * l],
        [54.0, 13.0 * l, 156.0, -22.0 * l],
        [-13.0 * l, -3.0 * l * l, -22.0 * l, 4.0 * l * l],
    ];
    let half = [
        [0.5, l / 8.0, 0.0, 0.0],
        [l / 8.0, l * l / 24.0, 0.0, 0.0],
        [0.0, 0.0, 0.5, -l / 8.0],
        [0.0, 0.0, -l / 8.0, l * l / 24.0],
    ];
    let of_end = [[[1.0, 0.0, 0.25 * l], [0.0, 0.0, -1.0]], [[1.0, 0.0, -0.25 * l], [0.0, 0.0, -1.0]]];
    let block = |[p, q]: [usize; 2]| {
        let mut added = [[0.0; 3]; 3];
        for i in 0..3 {
            for j in 0..3 {
                for a in 0..2 {
                    for b in 0..2 {
                        let more = consistent[2 * p + a][2 * q + b] / 420.0 - half[2 * p + a][2 * q + b];
                        added[i][j] += MASS_KG * more * of_end[p][a][i] * of_end[q][b][j];
                    }
                }
            }
        }
        MassBlock { pair: [p, q], added }
    };
    let blocks = [[0, 0], [0, 1], [1, 1]].map(block).to_vec();
    SharedMass { bodies: vec!["a".into(), "b".into()], blocks }
}

/// Angular frequency from the first and the last change of sign of a combination of the heights of the points \[rad/s\].
fn frequency(run: &RunResult, weights: [f64; 4]) -> f64 {
    let at = |i: usize| -> f64 { (0..4).map(|k| weights[k] * run.tracked[k].displacement_m[i][2]).sum() };
    let zeros: Vec<f64> = (2..run.times_s.len())
        .filter(|i| at(i - 1) * at(*i) < 0.0)
        .map(|i| {
            let share = at(i - 1) / (at(i - 1) - at(i));
            run.times_s[i - 1] + share * (run.times_s[i] - run.times_s[i - 1])
        })
        .collect();
    PI * (zeros.len() - 1) as f64 / (zeros[zeros.len() - 1] - zeros[0])
}

#[test]
fn halves_with_shared_mass_vibrate_as_a_finite_element() {
    let unit = BENDING_N_M2 / (MASS_KG / LENGTH_M * LENGTH_M.powi(4));
    // bent up and down, and S-shaped: ω² over E I / (m l³) of one free element with consistent mass is 720 and 8400 (Cook, Malkus, Plesha and Witt, 4th ed., section 11.4), of rigid halves 192 for both
    let modes =
        [([0.02, -0.02], [1.0, -1.0, -1.0, 1.0], 720.0), ([0.02, 0.02], [0.0, 1.0, -1.0, 0.0], 8400.0)];
    for (turns, weights, wanted) in modes {
        let mut m = halves();
        for (body, w) in m.bodies.iter_mut().zip(turns) {
            body.angular_velocity_rad_s = [0.0, w, 0.0];
        }
        let alone = frequency(&simulate(&m).unwrap(), weights).powi(2) / unit;
        assert!((alone / 192.0 - 1.0).abs() < 2e-3, "{alone}");
        m.shared_masses.push(shared());
        let run = simulate(&m).unwrap();
        let found = frequency(&run, weights).powi(2) / unit;
        assert!((found / wanted - 1.0).abs() < 3e-3, "{found} {wanted}");
        assert!(run.energy_error < 1e-4, "{}", run.energy_error);
    }
}

/// Consistent inertia resists a uniform acceleration with the moments that the weight of a span has between clamped ends, so that nothing bends in free fall.
#[test]
fn halves_with_shared_mass_fall_without_bending() {
    let mut m = halves();
    m.gravity_m_s2 = [0.0, 0.0, -G];
    m.bodies.pop();
    m.bushings.pop();
    let turn = BENDING_N_M2 / LENGTH_M;
    m.curves.insert(
        "end".into(),
        ResistanceCurve { stiffness_nm_rad: turn, ..curve(&[[0.0, 1e9], [1.0, 1e9]], 2.0) },
    );
    m.bushings[0].bending = [hinge("end"), elastic(turn)];
    m.bushings[0].beam = Some(Beam {
        half_length_m: 0.5 * LENGTH_M,
        ends: ["start".into(), "end".into()],
        span: Some(Span { length_m: LENGTH_M, mass_kg_m: MASS_KG / LENGTH_M }),
    });
    m.shared_masses.push(shared());
    let run = simulate(&m).unwrap();
    let sag_m = MASS_KG / LENGTH_M * G * LENGTH_M.powi(4) / (384.0 * BENDING_N_M2);
    for (i, t) in run.times_s.iter().enumerate() {
        for point in &run.tracked {
            let off = point.displacement_m[i][2] + 0.5 * G * t * t;
            assert!(off.abs() < 1e-6 * sag_m, "{off} m at {t} s");
        }
    }
}

#[test]
fn a_break_keeps_the_momenta_and_books_the_energy() {
    let mut m = halves();
    m.shared_masses.push(shared());
    m.bodies[0].velocity_m_s = [0.0, 0.0, 0.3];
    m.bodies[0].angular_velocity_rad_s = [0.0, 0.2, 0.0];
    m.bodies[1].angular_velocity_rad_s = [0.0, -0.1, 0.0];
    // pulled apart at once
    m.bushings[0].tensile_capacity_n = Some(1e2);
    m.bushings[0].tensile_elongation_m = Some(0.0);
    m.bodies[1].velocity_m_s = [0.1, 0.0, 0.0];
    let run = simulate(&m).unwrap();
    assert!(run.events.iter().any(|e| format!("{:?}", e.kind).contains("Fracture")), "{:?}", run.events);
    assert!(run.energies.released_j.last().unwrap().abs() > 1e-3, "{:?}", run.energies.released_j.last());
    assert!(run.energy_error < 2e-3, "{}", run.energy_error);
    // both halves fly on: momentum about y through the origin and along z, of consistent inertia at the start
    let d = shared();
    let v: [[f64; 3]; 2] = [0, 1].map(|i| {
        [
            m.bodies[i].velocity_m_s[2],
            m.bodies[i].angular_velocity_rad_s[0],
            m.bodies[i].angular_velocity_rad_s[1],
        ]
    });
    let mut along = 0.5 * MASS_KG * (v[0][0] + v[1][0]);
    for block in &d.blocks {
        let [p, q] = block.pair;
        for j in 0..3 {
            along += block.added[0][j] * v[q][j];
            if p != q {
                along += block.added[j][0] * v[p][j];
            }
        }
    }
    let n = run.times_s.len();
    let speed = |k: usize| {
        let f = [&run.frames[n - 2], &run.frames[n - 1]];
        (f[1].position_m[k][2] - f[0].position_m[k][2]) / (run.times_s[n - 1] - run.times_s[n - 2])
    };
    let after = 0.5 * MASS_KG * (speed(0) + speed(1));
    assert!((after / along - 1.0).abs() < 1e-6, "{after} {along}");
}

/// Where other bodies part under their load, sharing ends everywhere, with the momenta and the energy of the full step.
#[test]
fn it_ends_without_loss_where_other_bodies_part() {
    let mut m = halves();
    m.shared_masses.push(shared());
    m.settings.output_interval_s = 5e-3;
    m.bodies[0].angular_velocity_rad_s = [0.0, 0.02, 0.0];
    m.bodies[1].angular_velocity_rad_s = [0.0, 0.02, 0.0];
    // two cubes of 2,500 kg as one on a soft spring: 1 m/s pulls the outer one with 35 kN, half of it too much
    for (id, x) in [("inner", 20.0), ("outer", 21.0)] {
        m.bodies.push(Body { velocity_m_s: [1.0, 0.0, 0.0], ..solid(id, [x, 0.0, 0.0], [1.0; 3]) });
    }
    let along = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let spring = |id: &str, a: Option<&str>, b: &str, x: f64, k: f64| Bushing {
        axes: along,
        ..joint(id, a, b, [x, 0.0, 0.0], k, 1e7, [elastic(1e7), elastic(1e7)])
    };
    m.bushings.push(spring("soft", None, "inner", 19.5, 1e6));
    m.bushings.push(Bushing {
        latent: Some("section".into()),
        tensile_capacity_n: Some(17.5e3),
        ..spring("section", Some("inner"), "outer", 20.5, 1e8)
    });
    // what the sum of all energies gains as the section parts: the energy that its bushing begins with
    let gained_j = |m: &Model| {
        let run = simulate(m).unwrap();
        let live = run.events.iter().find(|e| matches!(e.kind, EventKind::Live { .. })).expect("it parts");
        let n = run.times_s.iter().position(|t| *t > live.time_s).unwrap();
        assert!(n > 4, "{live:?}");
        run.energies.total_j(n) - run.energies.total_j(n - 1)
    };
    let shares_j = gained_j(&m);
    m.shared_masses.clear();
    let alone_j = gained_j(&m);
    let vibrating_j = (0..2).map(|i| 0.5 * m.bodies[i].inertia_kg_m2[1][1] * 0.02_f64.powi(2)).sum::<f64>();
    println!("{shares_j} J with sharing, {alone_j} J without, {vibrating_j} J of the halves");
    assert!((shares_j - alone_j).abs() < 1e-3 * vibrating_j);
}

#[test]
fn wrong_lists_are_named() {
    type Change = fn(&mut SharedMass);
    let cases: [(Change, &str); 5] = [
        (|s| s.bodies[1] = "c".into(), "shared_masses[0].bodies[1]: \"c\" is not the id of a body"),
        (|s| s.bodies[1] = "a".into(), "\"a\" stands in a list already"),
        (|s| s.blocks[1].pair = [1, 0], "shared_masses[0].blocks[1].pair: is [1, 0]"),
        (|s| s.blocks[0].added[0][0] += 10.0, "changes the inertia of the bodies as one rigid body"),
        (
            |s| s.blocks.iter_mut().for_each(|b| b.added = b.added.map(|r| r.map(|x| 9.0 * x))),
            "not positive definite",
        ),
    ];
    for (change, words) in cases {
        let mut m = halves();
        let mut list = shared();
        change(&mut list);
        m.shared_masses.push(list);
        let text = match simulate(&m) {
            Err(SolveError::Model(error)) => error.to_string(),
            Err(error) => error.to_string(),
            Ok(_) => String::new(),
        };
        assert!(text.contains(words), "{words}: {text}");
    }
}

/// The step that is told where one is refused holds with shared inertia and without.
#[test]
fn the_step_told_for_one_refused_holds() {
    let mut m = halves();
    // without the block that sets the step
    m.bodies.pop();
    m.bushings.pop();
    m.shared_masses.push(shared());
    m.settings.end_time_s = 0.02;
    m.settings.time_step_s = Some(1.0);
    let said = simulate(&m).unwrap_err().to_string();
    m.settings.time_step_s = Some(step_told(&said));
    assert!(simulate(&m).is_ok(), "{said}");
    m.shared_masses.clear();
    assert!(simulate(&m).is_ok(), "{said}");
}
