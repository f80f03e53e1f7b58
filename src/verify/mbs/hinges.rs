//! Hinges that flow, soften and fracture: a toppling column with a closed form, and a frame that falls.

use super::Known;
use crate::mbs::ideal::force::Force;
use crate::mbs::ideal::hinge_law::HingeLaw;
use crate::mbs::ideal::joint::{Joint, Kind};
use crate::mbs::ideal::march::{Course, March, march};
use crate::mbs::ideal::{Body, GROUND, Mechanism};
use crate::mbs::math::{V3, mul, qexp, qmat};
use crate::verify::{Case, Figure};

const CLOSED: &str = "energy: I ω²/2 = m g L/2 cos θ_0 - M_p (π/2 - θ_0) + M_p²/2k; its equation to 1e-9";
const VIBRATION: &str = "elastic vibration about the new rest, twice the static rotation, to 1e-9";
const ENGINES: &str = "MuJoCo RK4, Chrono, Rapier, PyBullet and Exudyn, extrapolated to a step of zero";
const LAW: &str = "conservation";

/// Length, side \[m\] and mass \[kg\] of a column.
const COLUMN: [f64; 3] = [3.5, 0.4, 1400.0];
/// Tilt at the start \[rad\].
const TILT: f64 = 0.2;
/// Elastic stiffness of hinges \[N m/rad\].
const STIFFNESS: f64 = 2e7;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "topple-flow",
            "A column of 1400 kg leans by 0.2 rad on a hinge of 20 MN m/rad that flows at 3 kN m: angular velocity and time when it lies level.",
            || {
                let course = topple(3e3, 1.9, 1e-8)?;
                let (time, omega) = level(&course).ok_or("it never lies level")?;
                Ok(vec![
                    Figure::absolute("angular velocity", "rad/s", [2.603874529595, omega], 1e-5, CLOSED),
                    Figure::absolute("time", "s", [1.80975871, time], 1e-5, CLOSED),
                    Figure::absolute("energy error", "J", [0.0, course.energy_change_j], 1.0, LAW),
                ])
            },
        ),
        Case::short("topple-elastic", "The same hinge at 60 kN m holds: largest rotation.", || {
            let course = topple(60e3, 0.2, 1e-8)?;
            let most = course.states.iter().map(|s| tilt(s) - TILT).fold(0.0, f64::max);
            Ok(vec![Figure::relative("rotation", "rad", [4.780548e-4, most], 1e-4, VIBRATION)])
        }),
        Case::short(
            "frame4-fall",
            "Three slabs of 41.6 t on columns with hinges at both ends that yield at 120 kN m, soften from 0.03 to 0.15 rad and fracture at 0.5 rad; four of six ground columns are \
             missing. Roof corner until before the ground is met, 28 loops of joints with dependent conditions.",
            || {
                let known = frame4();
                let course = known.run(1e-7)?;
                let mut figures = known.figures_of(&course, 2e-6, ENGINES, None);
                let first = course.fractures_s.first().copied().unwrap_or(f64::NAN);
                figures.push(Figure::absolute("first fracture", "s", [0.76145, first], 1e-4, ENGINES));
                let share = course.energy_change_j / 9.7717e6;
                figures.push(Figure::absolute("energy error over energy", "-", [0.0, share], 1e-6, LAW));
                Ok(figures)
            },
        ),
    ]
}

/// A column with its principal moments of inertia, the last about its axis.
fn column(position_m: V3) -> Body {
    let [length, side, mass] = COLUMN;
    let across = mass * (length * length + side * side) / 12.0;
    Body::at_rest(mass, [across, across, mass * side * side / 6.0], position_m)
}

fn topple(capacity_nm: f64, end_s: f64, tolerance: f64) -> Result<Course, String> {
    march(&leaning(capacity_nm), &March { end_s, tolerance, output_s: 2e-4, in_space: true })
        .map_err(|e| e.to_string())
}

/// The column on a hinge that flows; where its top is, by its equation in two parts, elastic and flowing, to 1e-10.
pub fn topple_flow() -> Known {
    let track = vec![
        (0.5, [0.85256554993, 0.0, 3.39457390302]),
        (1.0, [1.45017699921, 0.0, 3.18543351382]),
        (1.5, [2.80981964101, 0.0, 2.08684297086]),
        (1.75, [3.46118371972, 0.0, 0.51981463842]),
        (1.9, [3.39134426373, 0.0, -0.86532311009]),
    ];
    let known = Known::of(leaning(3e3), 0, [0.0, 0.0, 0.5 * COLUMN[0]]);
    Known { name: "toppling, flowing", file: "topple-flow", track, end_s: 1.9, output_s: 0.01, ..known }
}

/// The column on a hinge that stays elastic.
pub fn topple_elastic() -> Known {
    let track = vec![
        (0.02, [0.69585050533, 0.0, 3.43013003751]),
        (0.05, [0.69696755164, 0.0, 3.42990323945]),
        (0.08, [0.69615517896, 0.0, 3.43006821606]),
        (0.1, [0.69540158852, 0.0, 3.43022107606]),
        (0.13, [0.69601438312, 0.0, 3.43009678850]),
        (0.16, [0.69698228490, 0.0, 3.42990024557]),
        (0.2, [0.69556990845, 0.0, 3.43018694862]),
    ];
    let known = Known::of(leaning(60e3), 0, [0.0, 0.0, 0.5 * COLUMN[0]]);
    Known { name: "toppling, elastic", file: "topple-elastic", track, end_s: 0.2, output_s: 0.01, ..known }
}

/// A leaning column on a hinge of constant capacity.
fn leaning(capacity_nm: f64) -> Mechanism {
    let turn = qexp([0.0, TILT, 0.0]);
    let centre = mul(&qmat(turn), [0.0, 0.0, 0.5 * COLUMN[0]]);
    let bodies = [GROUND, 0];
    let law = HingeLaw { stiffness_nm_rad: STIFFNESS, capacity: vec![[0.0, capacity_nm]], fracture_rad: 9.0 };
    Mechanism {
        bodies: vec![Body { orientation: turn, ..column(centre) }],
        joints: vec![Joint::at(Kind::Revolute, bodies, [0.0; 3], [0.0, 1.0, 0.0])],
        forces: vec![Force::Hinge { bodies, law: 0, joint: None }],
        laws: vec![law],
        bushings: Vec::new(),
        gravity_m_s2: [0.0, 0.0, -9.81],
    }
}

fn tilt(state: &[f64]) -> f64 {
    libm::atan2(state[0], state[2])
}

/// Time and angular velocity when the column lies level.
fn level(course: &Course) -> Option<(f64, f64)> {
    let quarter = std::f64::consts::FRAC_PI_2;
    let after = course.states.iter().position(|s| tilt(s) >= quarter)?;
    let [before, behind] = [&course.states[after - 1], &course.states[after]];
    let share = (quarter - tilt(before)) / (tilt(behind) - tilt(before));
    let between = |i: usize| before[i] + share * (behind[i] - before[i]);
    Some((2e-4 * ((after - 1) as f64 + share), between(11)))
}

/// The frame of three storeys until before the ground is met.
pub fn frame4() -> Known {
    let track = vec![
        (0.05, [6.2, -0.200532, 10.482472]),
        (0.15, [6.2, -0.230298, 10.361299]),
        (0.25, [6.2, -0.325871, 10.147896]),
        (0.35, [6.2, -0.441193, 9.811406]),
        (0.45, [6.2, -0.587224, 9.357241]),
        (0.5, [6.2, -0.677113, 9.087965]),
        (0.55, [6.2, -0.763934, 8.783063]),
        (0.65, [6.2, -0.921773, 8.065508]),
        (0.75, [6.2, -1.097096, 7.223814]),
    ];
    let known = Known::of(frame(), 2, [3.2, -5.2, 0.0]);
    Known { name: "falling frame (frame4)", file: "frame4", track, end_s: 0.79, output_s: 0.01, ..known }
}

fn frame() -> Mechanism {
    let mut m = Mechanism {
        gravity_m_s2: [0.0, 0.0, -9.81],
        laws: vec![HingeLaw {
            stiffness_nm_rad: STIFFNESS,
            capacity: vec![[0.0, 120e3], [0.03, 120e3], [0.15, 0.0]],
            fracture_rad: 0.5,
        }],
        ..Mechanism::default()
    };
    let height = COLUMN[0];
    let [x, y, z] = [6.4f64, 10.4, 0.25];
    let mass = 2500.0 * x * y * z;
    let moments = [y * y + z * z, x * x + z * z, x * x + y * y].map(|s| mass * s / 12.0);
    for storey in 1..=3 {
        m.bodies.push(Body::at_rest(mass, moments, [3.0, 5.0, height * f64::from(storey)]));
    }
    for storey in 0..3 {
        let below = if storey == 0 { GROUND } else { storey - 1 };
        for (x, y) in [(0.0, 0.0), (6.0, 0.0), (0.0, 5.0), (6.0, 5.0), (0.0, 10.0), (6.0, 10.0)] {
            if storey == 0 && y < 7.0 {
                continue;
            }
            let (own, foot) = (m.bodies.len(), height * storey as f64);
            m.bodies.push(column([x, y, foot + 0.5 * height]));
            for (bodies, z) in [([below, own], foot), ([own, storey], foot + height)] {
                let joint = Some(m.joints.len());
                m.joints.push(Joint::at(Kind::Spherical, bodies, [x, y, z], [0.0, 0.0, 1.0]));
                m.forces.push(Force::Hinge { bodies, law: 0, joint });
            }
        }
    }
    m
}
