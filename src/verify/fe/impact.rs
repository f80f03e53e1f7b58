//! Rigid surfaces, Taylor's bar, erosion.

use super::body::{missing_j, nodes_where, sound};
use super::forms::{FORMS, Taylor, TestedForm};
use crate::base::geom::Aabb;
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::erosion::STRAIN_CHECK_STEPS;
use crate::fe::law::Erosion;
use crate::fe::law::Law;
use crate::fe::shapes::{bilinear, elastic, grid, ground, nearest, round_bar};
use crate::verify::{Case, Figure};

const GRAVITY_M_S2: f64 = 9.81;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![
        Case::short(
            "sliding-block",
            "A block slides at 0.5 m/s on rough ground (μ 0.4) and stops.",
            sliding_block,
        ),
        Case::short(
            "falling-block",
            "A block falls 0.2 m onto the edge of a rigid box and the ground: nothing sinks in, every joule is booked.",
            falling_block,
        ),
        Case::short(
            "eroding-bar",
            "A perfectly plastic bar of ten elements, the middle one weaker, torn apart at 0.05 m/s; it erodes at a plastic \
             strain of 2 %. Its neighbours neck with it.",
            eroding_bar,
        ),
    ];
    for (name, limit) in [("tearing-tension", true), ("tearing-shear", false)] {
        cases.push(Case::short(
            name,
            "One element torn at a largest principal strain of 2 %: drawn at 4 1/s, and sheared at 4 1/s, where \
             λ_max = (γ + sqrt(γ² + 4)) / 2. Principal strains are looked at every four steps.",
            move || torn(limit),
        ));
    }
    for form in FORMS {
        for (layers, refine, short) in [(24, 1, true), (48, 2, false)] {
            cases.push(Case {
                short,
                ..Case::long(
                    format!("taylor-bar-{}-{}", layers * 48 * refine * refine, form.name),
                    "Taylor's copper bar: L 32.4 mm, R 3.2 mm, 227 m/s, E 117 GPa, ν 0.35, 8930 kg/m³, yield 400 MPa, tangent \
                     100 MPa, frictionless rigid wall, 80 µs; O-grid.",
                    move || taylor_bar([layers, refine], form),
                )
            });
        }
    }
    cases
}

fn sliding_block() -> Result<Vec<Figure>, String> {
    let mesh = grid([3, 2, 2], [0.6, 0.4, 0.2], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, ground(0.0, 0.4), false);
    body.v.iter_mut().for_each(|v| v[0] = 0.5);
    let start = body.kinetic_j();
    let mut kinetic = 0.0;
    while body.time_s < 0.25 {
        kinetic = body.step(true);
    }
    let travelled = body.x.iter().map(|x| x[0]).sum::<f64>() / body.x.len() as f64 - 0.3;
    let expected = 0.25 / (2.0 * 0.4 * GRAVITY_M_S2);
    let missing = missing_j(&body, kinetic, start) / start;
    Ok(vec![
        Figure::relative("sliding distance", "m", [expected, travelled], 0.03, "v² / (2 μ g)"),
        Figure::relative("work of friction", "J", [-start, body.contact_j[1]], 0.05, "kinetic energy"),
        Figure::absolute("energy residual over kinetic energy", "-", [0.0, missing], 0.01, "conservation"),
    ])
}

fn falling_block() -> Result<Vec<Figure>, String> {
    let mesh = grid([4, 3, 3], [0.8, 0.6, 0.6], elastic(), |_| false);
    let step = Aabb { min: [-1.0, -1.0, -2.0], max: [0.3, 2.0, -0.2] };
    let mut surfaces = ground(-0.3, 0.5);
    surfaces.boxes.push((step, 0.3));
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, surfaces, false);
    let scale = body.mass_kg.iter().sum::<f64>() * GRAVITY_M_S2 * 0.2;
    let (mut worst, mut sunk) = (0.0_f64, 0.0_f64);
    while body.time_s < 0.5 {
        let before = body.contact_j;
        let kinetic = body.step(true);
        if body.contact_j == before {
            // a node that is stopped within the step has no mid-step velocity to measure
            worst = worst.max(missing_j(&body, kinetic, 0.0).abs());
        }
        for x in &body.x {
            let level = if x[0] > 0.3 - 1e-9 { -0.3 } else { -0.2 };
            sunk = sunk.max(level - x[2]);
        }
    }
    sound(&body)?;
    Ok(vec![
        Figure::absolute(
            "energy residual over work of the fall",
            "-",
            [0.0, worst / scale],
            0.01,
            "conservation",
        ),
        Figure::absolute("penetration", "m", [0.0, sunk], 1e-9, "rigid surfaces"),
    ])
}

fn eroding_bar() -> Result<Vec<Figure>, String> {
    const YIELD_PA: f64 = 2e6;
    let law = Law {
        erosion: Erosion { plastic_strain: 0.02, ..Erosion::NEVER },
        ..bilinear(30e9, 0.2, 2500.0, YIELD_PA, 0.0)
    };
    let mut mesh = grid([10, 1, 1], [1.0, 0.1, 0.1], law, |_| false);
    mesh.elements[5].strength = 0.8;
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for n in nodes_where(&mesh, |p| p[0] == 0.0) {
        body.prescribed_m_s[n] = [Some(0.0), None, None];
    }
    for n in nodes_where(&mesh, |p| p[0] == 1.0) {
        body.prescribed_m_s[n] = [Some(0.05), None, None];
    }
    let (mut kinetic, mut deaths) = (0.0, Vec::new());
    while body.time_s < 0.1 {
        kinetic = body.step(true);
        deaths.extend(body.deaths.iter().map(|d| d.0));
    }
    let missing = missing_j(&body, kinetic, 0.0) / body.driven_j;
    let eroded: f64 = deaths.iter().map(|e| body.blocks.internal_j(*e)).sum();
    let expected = 0.8 * YIELD_PA * 1e-3 * 0.02;
    Ok(vec![
        Figure::absolute("eroded elements", "-", [1.0, deaths.len() as f64], 0.0, "the weaker one"),
        Figure::relative("energy in it", "J", [expected, eroded], 0.05, "σ_y V p"),
        Figure::absolute("energy residual over work", "-", [0.0, missing], 0.01, "conservation"),
    ])
}

/// An element deformed as given by its prescribed nodes until it tears.
fn torn(drawn: bool) -> Result<Vec<Figure>, String> {
    let (limit, rate): (f64, f64) = (0.02, 4.0);
    let law = Law {
        erosion: Erosion { principal_strain: limit, ..Erosion::NEVER },
        poisson_ratio: 0.0,
        ..elastic()
    };
    let mesh = grid([1; 3], [1.0; 3], law, |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for (n, p) in mesh.nodes.iter().enumerate() {
        let across = rate * if drawn { p[0] } else { p[2] };
        body.prescribed_m_s[n] = [Some(across), Some(0.0), Some(0.0)];
        body.v[n] = [across, 0.0, 0.0];
    }
    while body.deaths.is_empty() && body.time_s < 0.05 {
        body.step(false);
    }
    // tension: λ = 1 + rate t; simple shear: λ - 1/λ = rate t
    let exact = if drawn { limit.exp() - 1.0 } else { limit.exp() - (-limit).exp() } / rate;
    let late = (STRAIN_CHECK_STEPS + 1) as f64 * body.dt_s; // the step in which it is found counts too
    Ok(vec![Figure::absolute(
        "time of death",
        "s",
        [exact, body.time_s],
        late,
        "logarithm of the largest stretch",
    )])
}

fn taylor_bar(divisions: [usize; 2], form: &TestedForm) -> Result<Vec<Figure>, String> {
    let law = form.law(bilinear(117e9, 0.35, 8930.0, 400e6, 100e6));
    let mesh = round_bar(32.4e-3, 3.2e-3, divisions, law);
    let mut body = Dynamics::new(&mesh, 0.0, ground(0.0, 0.0), false);
    body.v.iter_mut().for_each(|v| v[2] = -227.0);
    let start = body.kinetic_j();
    let mut kinetic = 0.0;
    while body.time_s < 80e-6 {
        kinetic = body.step(body.time_s + 2.0 * body.dt_s >= 80e-6);
    }
    sound(&body)?;
    let length = 1e3 * body.x[nearest(&mesh, [0.0, 0.0, 32.4e-3])][2];
    let foot = 1e3 * body.x.iter().map(|x| x[0].hypot(x[1])).fold(0.0, f64::max);
    let strain = (0..mesh.elements.len()).map(|e| body.blocks.plastic_strain(e)).fold(0.0, f64::max);
    let missing = missing_j(&body, kinetic, start) / start;
    let Taylor { length_mm, foot_mm, strain: largest, source } = form.taylor[usize::from(divisions[1] > 1)];
    let published = "published codes, 21.4 to 21.5 mm; OpenRadioss 21.5 to 21.7 mm";
    Ok(vec![
        Figure::relative("final length", "mm", [length_mm[0], length], length_mm[1], published),
        Figure::relative("foot radius", "mm", [foot_mm[0], foot], foot_mm[1], source),
        Figure::absolute("largest plastic strain", "-", [largest[0], strain], largest[1], source),
        Figure::absolute("energy residual over kinetic energy", "-", [0.0, missing], 0.01, "conservation"),
    ])
}
