//! A hinge that flows about both of its axes: what turns it goes on about one of them, a constant moment acts about the other.
//!
//! With isotropic inertia `I` and a capacity `C` that is the moment, a small rotation is the path of a block that is pushed across a slope on which it could just stand: with `φ` between its velocity
//! and the moment, `v' = a (cos φ - 1)`, `v φ' = -a sin φ`, `a = C / I`. So `v (1 + cos φ) = v_0`, and with `τ = tan(φ/2)`, which falls from 1,
//!
//! ```text
//! t = v_0/2a [(1 - τ²)/2 - ln τ],   along the moment v_0²/4a [(τ⁴ - 1)/4 - ln τ],   across v_0²/2a [4/3 - τ - τ³/3]
//! ```

use super::contact::{energy, last, run};
use super::models::{body, joint};
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Bending, Bushing, JointKind, Model};
use crate::verify::{Case, Figure};

const MASS_KG: f64 = 1000.0;
const LENGTH_M: f64 = 4.0;
/// Across the column \[m/s²\].
const GRAVITY_M_S2: f64 = 1.0;
const RATE_RAD_S: f64 = 0.05;
const END_S: f64 = 0.2;
const STIFFNESS_NM_RAD: f64 = 1e10;
/// Shear stiffness of the bushing: it yields by 1e-5 m, the column's centre moves by 1e-2 m \[N/m\].
const SHEAR_N_M: f64 = 1e8;
const SOURCE: &str = "block on a slope";

/// The case of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::short(
        "crosswise",
        "A column of 1 t and 4 m that turns about one axis of its hinge while gravity across it just overcomes the hinge about the other, by a bushing and on a spherical joint: rotations about both axes after 0.2 s.",
        figures,
    )]
}

fn figures() -> Result<Vec<Figure>, String> {
    let [along, across] = known(END_S);
    let whole = libm::hypot(along, across);
    let mut figures = Vec::new();
    for (held, name, within) in [(false, "bushing", 1e-3), (true, "spherical joint", 5e-4)] {
        let result = run(&column(held))?;
        let q = last(&result).orientation[0];
        for (what, angle, found) in
            [("along the moment", along, 2.0 * q[2]), ("across it", across, 2.0 * q[1])]
        {
            let of = format!("rotation {what}, {name}");
            figures.push(Figure::absolute(of, "rad", [angle, found], within * whole, SOURCE));
        }
        figures.push(energy(&result, 1e-3));
    }
    Ok(figures)
}

/// Moment of inertia about the foot \[kg m²\].
fn inertia() -> f64 {
    MASS_KG * LENGTH_M * LENGTH_M / 3.0
}

/// The moment, which is the capacity \[N m\].
fn moment_nm() -> f64 {
    0.5 * MASS_KG * GRAVITY_M_S2 * LENGTH_M
}

/// Rotations along the moment and across it after a time \[rad\].
fn known(time_s: f64) -> [f64; 2] {
    let (v, a) = (RATE_RAD_S, moment_nm() / inertia());
    let time = |tau: f64| 0.5 * v / a * (0.5 * (1.0 - tau * tau) - libm::log(tau));
    let (mut low, mut high) = (f64::MIN_POSITIVE, 1.0);
    for _ in 0..2000 {
        let tau = 0.5 * (low + high);
        *(if time(tau) > time_s { &mut low } else { &mut high }) = tau;
    }
    let along = 0.25 * v * v / a * (0.25 * (low.powi(4) - 1.0) - libm::log(low));
    let across = 0.5 * v * v / a * (4.0 / 3.0 - low - low.powi(3) / 3.0);
    [along, across]
}

/// The column on a bushing, or on a spherical joint that holds the point of one.
fn column(held: bool) -> Model {
    let mut m = Model::empty("column that turns crosswise", [GRAVITY_M_S2, 0.0, 0.0], END_S, 0.01);
    let (half, about_centre) = (0.5 * LENGTH_M, 0.25 * inertia());
    let mut column = body("column", MASS_KG, [about_centre, about_centre, 10.0], [0.0, 0.0, half]);
    column.angular_velocity_rad_s = [RATE_RAD_S, 0.0, 0.0];
    column.velocity_m_s = [0.0, -RATE_RAD_S * half, 0.0];
    m.bodies.push(column);
    let capacity = [0.0, 10.0].map(|x| [x, moment_nm()]).to_vec();
    let level = CapacityLevel { axial_force_n: 0.0, capacity, fracture_rotation_rad: 50.0 };
    let curve = ResistanceCurve { stiffness_nm_rad: STIFFNESS_NM_RAD, levels: vec![level], cyclic: None };
    m.curves.insert("c".into(), curve);
    let stiff = if held { 0.0 } else { SHEAR_N_M };
    let axes = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    m.bushings.push(Bushing {
        axial_stiffness_n_m: stiff,
        shear_stiffness_n_m: [stiff; 2],
        torsional_stiffness_nm_rad: 1e5,
        bending: [0, 1].map(|_| Bending::Curve { curve: "c".into(), strength_factor: 1.0 }),
        joint: held.then(|| "pin".into()),
        ..Bushing::free("foot".into(), None, "column".into(), [0.0; 3], axes)
    });
    if held {
        m.joints.push(joint("pin".into(), JointKind::Spherical, [None, Some("column")], [0.0; 3], None));
    }
    m
}
