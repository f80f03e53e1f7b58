//! Pendulums on single joints against MSC Adams' own results, as they lie in the tests of Project Chrono (`data/testing/joints`, BSD licence).

use crate::mbs::ideal::force::Force;
use crate::mbs::ideal::joint::{Joint, Kind};
use crate::mbs::ideal::march::{March, march};
use crate::mbs::ideal::{Body, GROUND, Mechanism};
use crate::verify::{Case, Figure};

const ADAMS: &str = "MSC Adams (Project Chrono, data/testing/joints)";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "adams-revolute",
            "Pendulum of 1 kg, centre of mass at 2 m, inertia (0.04, 0.1, 0.1) kg m², released level on a revolute, 5 s: height of the centre of mass.",
            || {
                heights(
                    Vec::new(),
                    &[
                        (0.5, -1.114320),
                        (1.0, -1.789880),
                        (2.0, -0.439479),
                        (3.0, -0.711481),
                        (5.0, -0.0355587),
                    ],
                )
            },
        ),
        Case::short(
            "adams-rotspring",
            "The same with a spring of 200 N m/rad and a damper of 10 N m s/rad.",
            || {
                let spring = Force::Torsion {
                    bodies: [GROUND, 0],
                    axis: [0.0, 1.0, 0.0],
                    stiffness_nm_rad: 200.0,
                    damping_nm_s_rad: 10.0,
                };
                heights(
                    vec![spring],
                    &[(0.5, -0.3005134), (1.0, -0.1424453), (2.0, -0.1867703), (5.0, -0.1953254)],
                )
            },
        ),
    ]
}

fn heights(forces: Vec<Force>, wanted: &[(f64, f64)]) -> Result<Vec<Figure>, String> {
    let pendulum = Mechanism {
        bodies: vec![Body::at_rest(1.0, [0.04, 0.1, 0.1], [2.0, 0.0, 0.0])],
        joints: vec![Joint::at(Kind::Revolute, [GROUND, 0], [0.0; 3], [0.0, 1.0, 0.0])],
        forces,
        gravity_m_s2: [0.0, 0.0, -9.80665],
        ..Mechanism::default()
    };
    let course = march(&pendulum, &March { end_s: 5.0, tolerance: 1e-9, output_s: 0.5, in_space: true })
        .map_err(|e| e.to_string())?;
    let figure = |(time, height): &(f64, f64)| {
        let ours = course.states[(time * 2.0).round() as usize][2];
        Figure::absolute(format!("height at {time} s"), "m", [*height, ours], 1e-5, ADAMS)
    };
    Ok(wanted.iter().map(figure).collect())
}
