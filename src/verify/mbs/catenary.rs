//! Beams whose hinges have yielded hold as ropes do.
//!
//! A mass between two beams in a row, each a bushing in its middle with a hinge at either end. As the mass moves across by `v`, both are longer by `s(v) = √(L² + v²) - L`, and each of their four hinges turns by `v / L`.

use super::contact::{energy, run};
use super::models::solid;
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Beam, Bending, Bushing, Model};
use crate::verify::{Case, Figure};

const G: f64 = 9.81;
/// Length of a beam \[m\].
pub const LENGTH_M: f64 = 4.0;
/// Its stiffness along its axis \[N/m\].
pub const AXIAL_N_M: f64 = 1e7;
/// The mass \[kg\].
const MASS_KG: f64 = 2000.0;
/// Velocity of the mass that is struck \[m/s\].
const SPEED_M_S: f64 = 2.0;
/// What the hinges of the beams bear that catch the mass \[N m\].
const PLASTIC_NM: f64 = 3e3;
/// Stiffness across \[N/m\]: next to none where the closed form has none, and such that hinges yield at once.
const LOOSE_N_M: f64 = 1.0;
const SHEAR_N_M: f64 = 1e7;
const STEP_S: f64 = 5e-5;

const SPRINGS: &str = "m v₀²/2 = k s(A)², and the quadrature of dv/v̇ (Nayfeh and Mook, Nonlinear Oscillations, 1979, section 2.1)";
const ROPES: &str = "m g v = k s(v)² + 4 M_p v/L";

/// The case of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::short(
        "catenary",
        "A mass of 2 t between two beams of 4 m with hinges at their ends: struck across beams without resistance to bending (amplitude and half of the period), and falling onto beams whose hinges flow at 3 kN m (lowest point).",
        figures,
    )]
}

fn figures() -> Result<Vec<Figure>, String> {
    let amplitude =
        ((LENGTH_M + SPEED_M_S * (MASS_KG / (2.0 * AXIAL_N_M)).sqrt()).powi(2) - LENGTH_M.powi(2)).sqrt();
    let mut struck = between_two(1e9, LOOSE_N_M);
    struck.gravity_m_s2 = [0.0; 3];
    struck.bodies[0].velocity_m_s[2] = -SPEED_M_S;
    let struck = run(&struck)?;
    let path =
        |r: &crate::mbs::result::RunResult| r.frames.iter().map(|f| f.position_m[0][2]).collect::<Vec<f64>>();
    let heights = path(&struck);
    let lowest = heights.iter().copied().fold(0.0, f64::min);
    let back = (1..heights.len() - 1)
        .find(|i| heights[*i] < 0.0 && heights[*i + 1] >= 0.0)
        .ok_or("the mass does not come back")?;
    let share = heights[back] / (heights[back] - heights[back + 1]);
    let [from, to] = [back, back + 1].map(|i| struck.times_s[i]);
    let fallen = run(&between_two(PLASTIC_NM, SHEAR_N_M))?;
    let depth = path(&fallen).into_iter().fold(0.0, f64::min);
    Ok(vec![
        Figure::relative("amplitude", "m", [-amplitude, lowest], 1e-4, SPRINGS),
        Figure::relative(
            "half of the period",
            "s",
            [half_period(amplitude), from + share * (to - from)],
            1e-4,
            SPRINGS,
        ),
        // the elastic part of the bending, 4 M_p²/2K of 4.5 kJ, and the step of outputs
        Figure::relative("lowest point", "m", [-caught(), depth], 1e-3, ROPES),
        energy(&fallen, 1e-5),
    ])
}

/// The mass between two beams that are clamped at their far ends, with hinges of a capacity \[N m\], and a stiffness across \[N/m\].
pub fn between_two(capacity_nm: f64, shear_n_m: f64) -> Model {
    let mut m = Model::empty("mass between two beams", [0.0, 0.0, -G], 0.8, 0.001);
    m.settings.time_step_s = Some(STEP_S);
    // that of a beam of the same stiffness across
    let stiffness_nm_rad = (shear_n_m * LENGTH_M.powi(2) / 12.0).max(1e4);
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, capacity_nm], [2.0, capacity_nm]],
        fracture_rotation_rad: 3.0,
    };
    let curve = ResistanceCurve { stiffness_nm_rad, levels: vec![level], cyclic: None };
    m.curves.insert("end".into(), curve);
    let side_m = libm::cbrt(MASS_KG / 2500.0);
    m.bodies.push(solid("mass", 2500.0, [side_m; 3], [0.0; 3]));
    for side in [-1.0, 1.0] {
        let ends = ["start", "end"].map(|place| format!("{place} {side}"));
        m.bushings.push(Bushing {
            axial_stiffness_n_m: AXIAL_N_M,
            shear_stiffness_n_m: [shear_n_m; 2],
            torsional_stiffness_nm_rad: 1e6,
            bending: [
                Bending::Curve { curve: "end".into(), strength_factor: 1.0 },
                Bending::Elastic { stiffness_nm_rad },
            ],
            beam: Some(Beam { half_length_m: 0.5 * LENGTH_M, ends, span: None }),
            ..Bushing::free(
                format!("beam {side}"),
                None,
                "mass".into(),
                [side * 0.5 * LENGTH_M, 0.0, 0.0],
                [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            )
        });
    }
    m
}

/// How much longer a beam is \[m\].
fn longer_m(v: f64) -> f64 {
    libm::hypot(v, LENGTH_M) - LENGTH_M
}

/// Half of the period of the struck mass \[s\]; `v = A sin φ` takes the pole at the turning point away.
fn half_period(amplitude: f64) -> f64 {
    const COUNT: u32 = 20_000;
    let width = std::f64::consts::FRAC_PI_2 / f64::from(COUNT);
    let speed = |v: f64| (SPEED_M_S.powi(2) - 2.0 * AXIAL_N_M / MASS_KG * longer_m(v).powi(2)).sqrt();
    let at = |i: u32| {
        let phi = (f64::from(i) + 0.5) * width;
        amplitude * libm::cos(phi) / speed(amplitude * libm::sin(phi))
    };
    2.0 * width * (0..COUNT).map(at).sum::<f64>()
}

/// How deep the mass falls \[m\]: by bisection.
fn caught() -> f64 {
    let left = |v: f64| MASS_KG * G * v - AXIAL_N_M * longer_m(v).powi(2) - 4.0 * PLASTIC_NM * v / LENGTH_M;
    let (mut low, mut high) = (0.1, 3.0);
    while high - low > 1e-12 {
        let middle = 0.5 * (low + high);
        if left(middle) > 0.0 { low = middle } else { high = middle }
    }
    low
}
