//! Two-node bars: a truss, a wave, plastic elongation.

use super::body::{Crossings, sound};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::law::{Erosion, Law};
use crate::fe::mesh::{Mesh, Truss};
use crate::fe::preload::equilibrate;
use crate::fe::shapes::{bilinear, point};
use crate::verify::{Case, Figure};

const STEEL_PA: f64 = 200e9;
const DENSITY_KG_M3: f64 = 7850.0;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "two-bar-truss",
            "Two bars of 2 m (200 GPa, 3 cm²) at 30° to the horizontal carry 6 kN at their apex, static solve.",
            two_bars,
        ),
        Case::short(
            "two-bar-frequency",
            "The same truss with 1000 kg at its apex let go from the static state under no load.",
            frequency,
        ),
        Case::short(
            "bar-wave",
            "200 bars of 1 cm in a row, one end moved at once at 1 m/s: speed of the front between the quarter points, stress behind it.",
            wave,
        ),
        Case::short(
            "bar-rupture",
            "A bar drawn slowly (0.5 m/s) until it ruptures at a plastic strain of 8 %, hardening 500 MPa + 1.5 GPa p.",
            rupture,
        ),
    ]
}

fn steel() -> Law {
    bilinear(STEEL_PA, 0.3, DENSITY_KG_M3, 1e15, 0.0)
}

fn bars(nodes: Vec<[f64; 3]>, pairs: &[[usize; 2]], area_m2: f64, law: Law, fixed: Vec<usize>) -> Mesh {
    let trusses = pairs.iter().map(|nodes| Truss { nodes: *nodes, area_m2, part: 0, law: 0 }).collect();
    Mesh { nodes, trusses, laws: vec![law], fixed, parts: vec!["bars".into()], ..Mesh::default() }
}

const LENGTH_M: f64 = 2.0;
const AREA_M2: f64 = 3e-4;
const LOAD_N: f64 = 6e3;

/// The truss; its apex is node 2.
fn truss() -> Dynamics {
    let half = LENGTH_M * 0.75_f64.sqrt();
    let nodes = vec![[-half, 0.0, 0.0], [half, 0.0, 0.0], [0.0, 0.0, 0.5 * LENGTH_M]];
    let mesh = bars(nodes, &[[0, 2], [1, 2]], AREA_M2, steel(), vec![0, 1]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.prescribed_m_s[2][1] = Some(0.0);
    body
}

fn two_bars() -> Result<Vec<Figure>, String> {
    let mut body = truss();
    body.applied_n[2][2] = -LOAD_N;
    equilibrate(&mut body)?;
    let sag = 0.5 * LENGTH_M - body.x[2][2];
    let expected = LOAD_N * LENGTH_M / (2.0 * STEEL_PA * AREA_M2 * 0.25);
    let (work, stored) = (0.5 * LOAD_N * expected, body.trusses.internal_j());
    let second = "first order; the change of the angle adds 0.02 %";
    Ok(vec![
        Figure::relative("sag", "m", [expected, sag], 1e-3, "P l / (2 E A sin² α)"),
        Figure::relative(
            "force in a bar",
            "N",
            [-LOAD_N, body.trusses.bars[0].force_n()],
            1e-3,
            "P / (2 sin α)",
        ),
        Figure::relative("stored energy", "J", [work, stored], 2e-3, second),
    ])
}

fn frequency() -> Result<Vec<Figure>, String> {
    let mut body = truss();
    let mass = 1000.0;
    body.mass_kg[2] = mass;
    body.applied_n[2][2] = -LOAD_N;
    equilibrate(&mut body)?;
    body.applied_n[2] = [0.0; 3];
    let mut zero = Crossings::default();
    while zero.times_s.len() < 9 && body.time_s < 10.0 {
        body.step(false);
        zero.see(body.time_s, body.x[2][2] - 0.5 * LENGTH_M);
    }
    let stiffness = 2.0 * STEEL_PA * AREA_M2 * 0.25 / LENGTH_M;
    let expected = (stiffness / mass).sqrt() / std::f64::consts::TAU;
    Ok(vec![Figure::relative("frequency", "1/s", [expected, zero.frequency_1_s()?], 1e-3, "sqrt(k / m)")])
}

fn wave() -> Result<Vec<Figure>, String> {
    let nodes = (0..=200).map(|i| [0.01 * f64::from(i), 0.0, 0.0]).collect();
    let pairs: Vec<[usize; 2]> = (0..200).map(|i| [i, i + 1]).collect();
    let mesh = bars(nodes, &pairs, 1e-4, steel(), Vec::new());
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.prescribed_m_s[0] = [Some(-1.0), Some(0.0), Some(0.0)];
    let mut passed = [Crossings::default(), Crossings::default()];
    let mut behind = 0.0;
    while passed[1].times_s.is_empty() && body.steps < 10_000 {
        body.step(false);
        // velocities belong to the middle of the step before
        let at_s = body.time_s - 0.5 * body.dt_s;
        for (seen, node) in passed.iter_mut().zip([50, 150]) {
            seen.see(at_s, -0.5 - body.v[node][0]);
        }
        behind = body.trusses.bars[40..100].iter().map(|b| b.stress_pa).sum::<f64>() / 60.0;
    }
    sound(&body)?;
    let c = (STEEL_PA / DENSITY_KG_M3).sqrt();
    let time = |seen: &Crossings| seen.times_s.first().copied().ok_or("the front did not pass");
    let measured = 1.0 / (time(&passed[1])? - time(&passed[0])?);
    Ok(vec![
        Figure::relative("speed of the front", "m/s", [c, measured], 0.005, "sqrt(E / ρ)"),
        Figure::relative("stress behind it", "Pa", [DENSITY_KG_M3 * c, behind], 0.01, "ρ c v"),
    ])
}

fn rupture() -> Result<Vec<Figure>, String> {
    let (yield_pa, modulus, critical) = (500e6, 1.5e9, 0.08);
    let law = Law {
        hardening: vec![point(0.0, yield_pa), point(1.0, yield_pa + modulus)],
        erosion: Erosion { plastic_strain: critical, ..Erosion::NEVER },
        ..steel()
    };
    let mesh = bars(vec![[0.0; 3], [1.0, 0.0, 0.0]], &[[0, 1]], 1e-4, law, vec![0]);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.prescribed_m_s[1] = [Some(0.5), Some(0.0), Some(0.0)];
    while body.trusses.bars[0].acts && body.time_s < 1.0 {
        body.step(false);
    }
    let last = yield_pa + modulus * critical;
    let stretched = libm::log(body.trusses.bars[0].length_m[1]);
    let work =
        1e-4 * (yield_pa * critical + 0.5 * modulus * critical * critical + 0.5 * last * last / STEEL_PA);
    let stored = body.trusses.internal_j();
    Ok(vec![
        Figure::relative(
            "strain at rupture",
            "-",
            [critical + last / STEEL_PA, stretched],
            1e-3,
            "p + σ_y(p) / E",
        ),
        Figure::relative("work to rupture", "J", [work, stored], 2e-3, "A l (∫ σ_y dp + σ² / 2E)"),
        Figure::relative("work of the moving end", "J", [stored, body.driven_j], 2e-3, "conservation"),
    ])
}
