//! Bushings and faces that bear more the faster they flow: how far a body goes until they have stopped it.

use super::contact::{G, energy, ground, model, run, solid};
use super::fractures::{held, turning};
use crate::mbs::model::{Contact, CrushedFace, Face, FaceRate, RateFactor};
use crate::mbs::result::RunResult;
use crate::verify::{Case, Figure};

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "rate-hinge",
            "A body of 1000 kg m² at 2 rad/s about a hinge that flows at 3 kN m times 1 + (ω / 0.5 rad/s)^(1/p), with p of 1 and 5 and steps of 0.5 ms.",
            hinge,
        ),
        Case::short(
            "rate-oblique",
            "The same with p of 5 about an axis between both bending axes, one as stiff as the other: flow, and the swinging on the spring after it, go along one line.",
            oblique,
        ),
        Case::short(
            "rate-stretch",
            "100 kg at 1 m/s on a spring of 1 GN/m that flows at 2 kN times 1 + (v / 0.5 m/s)^(1/5), in tension and in compression, with steps of 0.1 ms.",
            stretch,
        ),
        Case::short(
            "rate-crush",
            "A box of 20 t that strikes the ground at 8 m/s with a face that bears 1.68 MN times 1 + (v / 60 m/s)^(1/5), with steps of 1 ms.",
            crush,
        ),
    ]
}

/// Rate factor `1 + (v / c)^(1 / p)`.
type Rate = [f64; 2];

/// The way `∫ m v / F dv` on which a force `F = f (1 + (v / c)^(1 / p)) - g` stops a mass `m` that comes with `v`, by Simpson's rule over `s = (v / v_0)^(1 / p)`, in which the force is a line.
fn way([m, v, f, g]: [f64; 4], [c, p]: Rate) -> f64 {
    const PANELS: u32 = 2000;
    let along = |s: f64| {
        let speed = v * libm::pow(s, p);
        let force = f * (1.0 + s * libm::pow(v / c, 1.0 / p)) - g;
        m * speed / force * p * v * libm::pow(s, p - 1.0)
    };
    let h = 1.0 / f64::from(PANELS);
    let panel = |i: u32| {
        let s = f64::from(i) * h;
        along(s) + 4.0 * along(s + 0.5 * h) + along(s + h)
    };
    (0..PANELS).map(panel).sum::<f64>() * h / 6.0
}

fn figures(
    name: &'static str,
    unit: &'static str,
    ways: [f64; 2],
    most: f64,
    result: &RunResult,
) -> [Figure; 2] {
    let source = "∫ m v / F(v) dv, by Simpson's rule";
    [Figure::relative(name, unit, ways, most, source), energy(result, 1e-5)]
}

fn hinge() -> Result<Vec<Figure>, String> {
    let mut all = Vec::new();
    for (exponent, name) in [(1.0, "rotation, p = 1"), (5.0, "rotation, p = 5")] {
        let (mut m, mut link) = turning(1e8, 2.0);
        m.settings.end_time_s = 1.0;
        link.rate_factor = Some(RateFactor { rotation_rad_s: [0.5; 2], elongation_m_s: None, exponent });
        m.bushings.push(link);
        let result = run(&m)?;
        let turned = result.hinges[0].plastic_rotation_rad.last().copied().unwrap_or(f64::NAN);
        let exact = way([1e3, 2.0, 3e3, 0.0], [0.5, exponent]);
        all.extend(figures(name, "rad", [exact, turned], 2e-3, &result));
    }
    Ok(all)
}

fn oblique() -> Result<Vec<Figure>, String> {
    let (mut m, mut link) = turning(1e8, 2.0);
    m.settings.end_time_s = 2.0;
    m.bodies[0].angular_velocity_rad_s = [0.0, 1.2, 1.6];
    link.bending[1] = link.bending[0].clone();
    link.rate_factor = Some(RateFactor { rotation_rad_s: [0.5; 2], elongation_m_s: None, exponent: 5.0 });
    m.bushings.push(link);
    let result = run(&m)?;
    let turned = result.hinges[0].plastic_rotation_rad.last().copied().unwrap_or(f64::NAN);
    let exact = way([1e3, 2.0, 3e3, 0.0], [0.5, 5.0]);
    let plastic_j = &result.energies.plastic_j;
    let fallen =
        plastic_j.windows(2).map(|p| (p[0] - p[1]).max(0.0)).sum::<f64>() / plastic_j[plastic_j.len() - 1];
    let mut all: Vec<Figure> = figures("rotation", "rad", [exact, turned], 2e-3, &result).into();
    all.push(Figure::absolute(
        "dissipation that is given back, of all",
        "-",
        [0.0, fallen],
        1e-12,
        "second law",
    ));
    Ok(all)
}

fn stretch() -> Result<Vec<Figure>, String> {
    let mut all = Vec::new();
    for (sense, name) in [(1.0, "way, stretched"), (-1.0, "way, pressed")] {
        let (mut m, mut link) = held(1e9);
        m.settings.time_step_s = Some(1e-4);
        m.bodies[0].velocity_m_s[0] = sense;
        (link.tensile_capacity_n, link.tensile_elongation_m) = (Some(2e3), Some(1.0));
        link.compressive_capacity_n = Some(2e3);
        let factor = RateFactor { rotation_rad_s: [1.0; 2], elongation_m_s: Some(0.5), exponent: 5.0 };
        link.rate_factor = Some(factor);
        m.bushings.push(link);
        let result = run(&m)?;
        let gone = result.frames.last().map_or(f64::NAN, |f| f.position_m[0][0].abs());
        let exact = way([100.0, 1.0, 2e3, 0.0], [0.5, 5.0]);
        all.extend(figures(name, "m", [exact, gone], 2e-3, &result));
    }
    Ok(all)
}

fn crush() -> Result<Vec<Figure>, String> {
    const MASS_KG: f64 = 20e3;
    const FORCE_N: f64 = 1.68e6;
    let mut m = model(0.6, 0.01);
    m.settings.time_step_s = Some(1e-3);
    let body = solid(&mut m, [0.0, 0.0, 1.5], [0.4, 0.4, 3.0]);
    (body.mass_kg, body.velocity_m_s) = (MASS_KG, [0.0, 0.0, -8.0]);
    let id = body.id.clone();
    m.contact = Contact {
        ground: ground(0.5, 0.0),
        crushing: vec![CrushedFace {
            body: id,
            shape: 0,
            face: Face::LowZ,
            force_n: vec![[0.0, FORCE_N]],
            rate_factor: Some(FaceRate { speed_m_s: 60.0, exponent: 5.0 }),
            subsystem: None,
        }],
        ..Contact::default()
    };
    let result = run(&m)?;
    let depth = result.crushed[0].depth_m.last().copied().unwrap_or(f64::NAN);
    let exact = way([MASS_KG, 8.0, FORCE_N, MASS_KG * G], [60.0, 5.0]);
    Ok(figures("shortening", "m", [exact, depth], 2e-3, &result).into())
}
