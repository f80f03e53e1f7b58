//! Bodies that turn freely.

use super::contact::{energy, last, run};
use super::models::solid;
use crate::mbs::math::{self, V3};
use crate::mbs::model::Model;
use crate::verify::{Case, Figure};

const END_S: f64 = 20.0;
/// Principal moments of inertia of the body that tumbles \[kg m²\], and its angular velocity \[rad/s\]: it turns over about its middle axis.
const INERTIA: V3 = [1.0, 2.0, 3.0];
const RATE: V3 = [30.0, 0.0, 20.0];
/// The same of the body of revolution.
const ROUND: V3 = [1.0, 1.0, 1.8];
const ROUND_RATE: V3 = [12.0, 0.0, 40.0];

const JACOBI: &str =
    "L = I ω with ω₁ ~ cn τ, ω₂ ~ sn τ, ω₃ ~ dn τ (Landau and Lifshitz, Mechanics, 3rd ed., eq. 37.10)";
const PRECESSION: &str = "turn about L by L t/I₁ after that about axis 3 by (1 - I₃/I₁) ω₃ t (Landau and Lifshitz, Mechanics, 3rd ed., section 33)";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "spin-tumbling",
            "A body with moments of inertia of 1, 2 and 3 kg m² tumbles at 36 rad/s: its angular momentum in its own axes after 20 s, in which it turns over 46 times.",
            tumbling,
        ),
        Case::short(
            "spin-precession",
            "A body of revolution with 1, 1 and 1.8 kg m² that turns at 40 rad/s about its axis and 12 across: its attitude after 20 s and 230 turns of precession.",
            precession,
        ),
    ]
}

/// A body that turns in space.
fn free(inertia: V3, rate: V3) -> Model {
    let mut m = Model::empty("free body", [0.0, 0.0, -9.81], END_S, 0.5);
    let mut body = solid("b", 80.0, [0.5; 3], [0.0; 3]);
    body.inertia_kg_m2 = [[inertia[0], 0.0, 0.0], [0.0, inertia[1], 0.0], [0.0, 0.0, inertia[2]]];
    body.angular_velocity_rad_s = rate;
    m.bodies.push(body);
    m
}

fn tumbling() -> Result<Vec<Figure>, String> {
    let result = run(&free(INERTIA, RATE))?;
    let momentum: V3 = std::array::from_fn(|i| INERTIA[i] * RATE[i]);
    let r = math::qmat(last(&result).orientation[0]);
    let ours = math::mul_t(&r, momentum);
    let exact = momentum_at(END_S);
    let mut figures: Vec<Figure> = (0..3)
        .map(|i| {
            let what = format!("angular momentum along axis {}", i + 1);
            Figure::absolute(what, "kg m²/s", [exact[i], ours[i]], 0.1, JACOBI)
        })
        .collect();
    figures.push(energy(&result, 1e-6));
    Ok(figures)
}

/// Angular momentum of the tumbling body in its own axes at a time \[s\].
fn momentum_at(time_s: f64) -> V3 {
    let [i1, i2, i3] = INERTIA;
    let square: f64 = (0..3).map(|i| (INERTIA[i] * RATE[i]).powi(2)).sum();
    let twice_energy: f64 = (0..3).map(|i| INERTIA[i] * RATE[i].powi(2)).sum();
    let (above, below) = (twice_energy * i3 - square, square - twice_energy * i1);
    let m = (i2 - i1) * above / ((i3 - i2) * below);
    let [sn, cn, dn] = jacobi(time_s * ((i3 - i2) * below / (i1 * i2 * i3)).sqrt(), m);
    [
        i1 * (above / (i1 * (i3 - i1))).sqrt() * cn,
        i2 * (above / (i2 * (i3 - i2))).sqrt() * sn,
        i3 * (below / (i3 * (i3 - i1))).sqrt() * dn,
    ]
}

/// `sn`, `cn` and `dn` of `u` for the parameter `m`, by the arithmetic-geometric mean (Abramowitz and Stegun, 16.4).
fn jacobi(u: f64, m: f64) -> [f64; 3] {
    let (mut a, mut b) = (1.0_f64, (1.0 - m).sqrt());
    let mut ratios = Vec::new();
    let mut scale = 1.0;
    while (a - b).abs() > 1e-15 {
        let c = 0.5 * (a - b);
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
        ratios.push(c / a);
        scale *= 2.0;
    }
    let phi = ratios
        .iter()
        .rev()
        .fold(scale * a * u, |phi, ratio| 0.5 * (phi + libm::asin(ratio * libm::sin(phi))));
    [libm::sin(phi), libm::cos(phi), (1.0 - m * libm::sin(phi).powi(2)).sqrt()]
}

fn precession() -> Result<Vec<Figure>, String> {
    let result = run(&free(ROUND, ROUND_RATE))?;
    let momentum: V3 = std::array::from_fn(|i| ROUND[i] * ROUND_RATE[i]);
    let about_momentum = math::qexp(math::scale(END_S / ROUND[0], momentum));
    let about_axis = math::qexp([0.0, 0.0, (1.0 - ROUND[2] / ROUND[0]) * ROUND_RATE[2] * END_S]);
    let [exact, ours] =
        [math::qmul(about_momentum, about_axis), last(&result).orientation[0]].map(math::qmat);
    let off = |k: usize| {
        let column = |m: &math::M3| [m[0][k], m[1][k], m[2][k]];
        math::norm(math::sub(column(&exact), column(&ours)))
    };
    Ok(vec![
        Figure::absolute("axis 3 is off by", "rad", [0.0, off(2)], 1e-3, PRECESSION),
        Figure::absolute("axis 1 is off by", "rad", [0.0, off(0)], 1e-3, PRECESSION),
        energy(&result, 1e-6),
    ])
}
