//! A column that topples on a hinge whose capacity depends on its axial force, which is along the column.
//!
//! With a mass `m`, a length `L`, `I` about the foot and `y = ω²`, the foot bears `N = m (g cos θ - y L / 2)` along the column, its hinge `M = a + b N`, and
//!
//! ```text
//! dy/dθ - κ y = A sin θ - B cos θ - C,    κ = b m L / I,  A = m g L / I,  B = 2 b m g / I,  C = 2 a / I
//! y = p sin θ + q cos θ + C/κ + c exp(κ θ),   q = (κ B - A) / (1 + κ²),  p = κ q - B
//! ```

use super::contact::{energy, last, run};
use super::models::{body, joint};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Bending, Bushing, JointKind, Model};
use crate::verify::{Case, Figure};

const MASS_KG: f64 = 1000.0;
const LENGTH_M: f64 = 4.0;
const GRAVITY_M_S2: f64 = 9.81;
/// Capacity without axial force \[N m\] and its slope \[m\], between these axial forces \[N\].
const PLASTIC_NM: f64 = 10e3;
const SLOPE_M: f64 = 0.25;
const FARTHEST_N: f64 = 30e3;
/// From the vertical \[rad\], and angular velocity \[rad/s\], at first.
const LEAN_RAD: f64 = 0.3;
const RATE_RAD_S: f64 = 3.0;
const SOURCE: &str = "linear equation for ω² over the angle";

/// The case of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::short(
        "leaning",
        "A column of 1 t and 4 m topples from 0.3 rad with 3 rad/s on a hinge that bears 10 kN m and 0.25 m of the axial force along the column, compression positive, by a bushing and on a revolute joint: kinetic energy and axial force at the angle reached in 0.4 s, and the plastic rotation.",
        figures,
    )]
}

fn figures() -> Result<Vec<Figure>, String> {
    let mut figures = Vec::new();
    for (held, name, within) in [(false, "bushing", 2e-3), (true, "revolute joint", 5e-4)] {
        let result = run(&column(held))?;
        let q = last(&result).orientation[0];
        let angle = 2.0 * libm::atan2(q[2], q[0]);
        let [kinetic_j, axial_n] = known(angle);
        let found_j = result.energies.kinetic_j.last().copied().unwrap_or(f64::NAN);
        let hinge = &result.hinges[0];
        let [plastic, found_n] = [&hinge.plastic_rotation_rad, &hinge.axial_force_n]
            .map(|history| history.last().copied().unwrap_or(f64::NAN));
        let of = |what: &str| format!("{what}, {name}");
        figures.push(Figure::relative(of("kinetic energy"), "J", [kinetic_j, found_j], within, SOURCE));
        figures.push(Figure::relative(
            of("plastic rotation"),
            "rad",
            [angle - LEAN_RAD, plastic],
            1e-4,
            SOURCE,
        ));
        // a bushing swings about it, undamped: there was no force in it at first
        if held {
            figures.push(Figure::relative(of("axial force"), "N", [axial_n, found_n], 2e-3, SOURCE));
        }
        figures.push(energy(&result, 1e-3));
    }
    Ok(figures)
}

/// Kinetic energy \[J\] and axial force, compression positive \[N\], at an angle to the vertical \[rad\].
fn known(angle_rad: f64) -> [f64; 2] {
    let inertia = MASS_KG * LENGTH_M * LENGTH_M / 3.0;
    let kappa = SLOPE_M * MASS_KG * LENGTH_M / inertia;
    let a = MASS_KG * GRAVITY_M_S2 * LENGTH_M / inertia;
    let b = 2.0 * SLOPE_M * MASS_KG * GRAVITY_M_S2 / inertia;
    let c = 2.0 * PLASTIC_NM / inertia;
    let q = (kappa * b - a) / (1.0 + kappa * kappa);
    let p = kappa * q - b;
    let particular = |x: f64| p * libm::sin(x) + q * libm::cos(x) + c / kappa;
    let left = RATE_RAD_S * RATE_RAD_S - particular(LEAN_RAD);
    let rate2 = particular(angle_rad) + left * libm::exp(kappa * (angle_rad - LEAN_RAD));
    let axial = MASS_KG * (GRAVITY_M_S2 * libm::cos(angle_rad) - 0.5 * LENGTH_M * rate2);
    [0.5 * inertia * rate2, axial]
}

/// The column on a bushing, or on a revolute joint that holds the point of one.
fn column(held: bool) -> Model {
    let mut m = Model::empty("leaning column", [0.0, 0.0, -GRAVITY_M_S2], 0.4, 0.01);
    let (sine, cosine) = libm::sincos(LEAN_RAD);
    let half = 0.5 * LENGTH_M;
    let across = MASS_KG * LENGTH_M * LENGTH_M / 12.0;
    let mut column = body("column", MASS_KG, [across, across, 10.0], [half * sine, 0.0, half * cosine]);
    let (half_sine, half_cosine) = libm::sincos(0.5 * LEAN_RAD);
    column.orientation = [half_cosine, 0.0, half_sine, 0.0];
    column.angular_velocity_rad_s = [0.0, RATE_RAD_S, 0.0];
    column.velocity_m_s = [RATE_RAD_S * half * cosine, 0.0, -RATE_RAD_S * half * sine];
    m.bodies.push(column);
    let level = |axial_force_n: f64| CapacityLevel {
        axial_force_n,
        capacity: [0.0, 10.0].map(|x| [x, PLASTIC_NM + SLOPE_M * axial_force_n]).to_vec(),
        fracture_rotation_rad: 50.0,
    };
    let levels = [-FARTHEST_N, 0.0, FARTHEST_N].map(level).to_vec();
    m.curves.insert("c".into(), ResistanceCurve { stiffness_nm_rad: 1e9, levels, cyclic: None });
    // steps end at outputs, so that the axial force of the last one is that at its end
    m.settings.reactions = held;
    let stiff = if held { 0.0 } else { 1e10 };
    let hinge = Bending::Curve { curve: "c".into(), strength_factor: 1.0 };
    let axes = [[sine, 0.0, cosine], [0.0, 1.0, 0.0], [-cosine, 0.0, sine]];
    m.bushings.push(Bushing {
        axial_stiffness_n_m: stiff,
        shear_stiffness_n_m: [stiff; 2],
        bending: [hinge, Bending::Elastic { stiffness_nm_rad: 0.0 }],
        joint: held.then(|| "pin".into()),
        ..Bushing::free("foot".into(), None, "column".into(), [0.0; 3], axes)
    });
    if held {
        let axis = Some([0.0, 1.0, 0.0]);
        m.joints.push(joint("pin".into(), JointKind::Revolute, [None, Some("column")], [0.0; 3], axis));
    }
    m
}
