//! Rigid surfaces, Taylor's bar, erosion.

use super::body::{missing_j, momenta, nodes_where, sound};
use super::forms::{FORMS, Taylor, TestedForm};
use crate::base::geom::Aabb;
use crate::fe::contact::{BodyContact, RigidSurfaces};
use crate::fe::dynamics::Dynamics;
use crate::fe::erosion::STRAIN_CHECK_STEPS;
use crate::fe::law::Erosion;
use crate::fe::law::Law;
use crate::fe::mesh::{Element, Mesh};
use crate::fe::model::ContactSettings;
use crate::fe::shapes::{bilinear, elastic, grid, ground, nearest, round_bar};
use crate::verify::{Case, Figure, Form};

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
            "two-body-impact",
            "An elastic bar of 6 m by 0.1 m by 0.1 m (60 elements, E 30 GPa, ν 0, 2500 kg/m³) runs at 2 m/s into an equal one at rest.",
            two_body_impact,
        ),
        Case::short(
            "sliding-on-a-body",
            "A block slides at 1 m/s on a held plate with other element lines (μ 0.4) and stops.",
            sliding_on_a_body,
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
                form: Form::short_if(short),
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
        let kinetic = body.step(true);
        worst = worst.max(missing_j(&body, kinetic, 0.0).abs());
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

/// Two boxes of one mesh, each by element counts, size \[m\] and lower corner \[m\], and the first node of the second.
fn two_boxes(law: &Law, boxes: [([usize; 3], [f64; 3], [f64; 3]); 2]) -> (Mesh, usize) {
    let [first, second] = boxes.map(|(counts, size_m, corner_m)| {
        let mut mesh = grid(counts, size_m, law.clone(), |_| false);
        mesh.nodes.iter_mut().for_each(|p| *p = std::array::from_fn(|i| p[i] + corner_m[i]));
        mesh
    });
    let mut mesh = first;
    let offset = mesh.nodes.len();
    mesh.nodes.extend(second.nodes);
    mesh.elements
        .extend(second.elements.iter().map(|e| Element { nodes: e.nodes.map(|n| n + offset), ..*e }));
    (mesh, offset)
}

/// A body that touches itself, without ground.
fn touching(mesh: &Mesh, gravity_m_s2: f64, friction: f64) -> Dynamics {
    let mut body = Dynamics::new(mesh, gravity_m_s2, RigidSurfaces::default(), false);
    let settings = ContactSettings { friction };
    body.body_contact = Some(Box::new(BodyContact::new(mesh, settings)));
    body
}

/// Mean of a nodal field over some nodes, by mass.
fn mean(body: &Dynamics, field: &[[f64; 3]], nodes: std::ops::Range<usize>) -> f64 {
    let mass: f64 = nodes.clone().map(|n| body.mass_kg[n]).sum();
    nodes.map(|n| body.mass_kg[n] * field[n][0]).sum::<f64>() / mass
}

fn two_body_impact() -> Result<Vec<Figure>, String> {
    const GAP_M: f64 = 1e-4;
    let law = Law { poisson_ratio: 0.0, ..elastic() };
    let bar = |x| ([60, 1, 1], [6.0, 0.1, 0.1], [x, 0.0, 0.0]);
    let (mesh, second) = two_boxes(&law, [bar(0.0), bar(6.0 + GAP_M)]);
    let mut body = touching(&mesh, 0.0, 0.3);
    body.v[..second].iter_mut().for_each(|v| v[0] = 2.0);
    let (start, [pushed, _]) = (body.kinetic_j(), momenta(&body));
    let ends = [nearest(&mesh, [6.0, 0.0, 0.0]), nearest(&mesh, [6.0 + GAP_M, 0.0, 0.0])];
    let lasting = 12.0 / (law.youngs_modulus_pa / law.density_kg_m3).sqrt();
    let (mut touched, mut parted, mut worst) = (None, None, 0.0_f64);
    while body.time_s < 1.5 * lasting {
        let kinetic = body.step(true);
        worst = worst.max(missing_j(&body, kinetic, start).abs());
        let open = body.x[ends[1]][0] - body.x[ends[0]][0];
        if open < 1e-9 {
            touched.get_or_insert(body.time_s);
            parted = None;
        } else if touched.is_some() && open > 1e-5 {
            parted.get_or_insert(body.time_s);
        }
    }
    sound(&body)?;
    let (Some(touched), Some(parted)) = (touched, parted) else {
        return Err("the bars do not meet and part".into());
    };
    let speeds = [mean(&body, &body.v, 0..second), mean(&body, &body.v, second..mesh.nodes.len())];
    let [after, _] = momenta(&body);
    Ok(vec![
        Figure::relative(
            "duration of contact",
            "ms",
            [1e3 * lasting, 1e3 * (parted - touched)],
            0.03,
            "2 L / c",
        ),
        Figure::absolute("speed of the first bar", "m/s", [0.0, speeds[0]], 0.04, "exchange of velocities"),
        Figure::relative("speed of the second bar", "m/s", [2.0, speeds[1]], 0.02, "exchange of velocities"),
        Figure::relative("momentum", "kg m/s", [pushed[0], after[0]], 1e-10, "conservation"),
        Figure::absolute(
            "energy residual over kinetic energy",
            "-",
            [0.0, worst / start],
            0.005,
            "conservation",
        ),
    ])
}

fn sliding_on_a_body() -> Result<Vec<Figure>, String> {
    let plate = ([8, 4, 1], [1.6, 0.8, 0.2], [0.0; 3]);
    let (mut mesh, second) = two_boxes(&elastic(), [plate, ([3, 2, 2], [0.6, 0.4, 0.2], [0.13, 0.17, 0.2])]);
    mesh.fixed = nodes_where(&mesh, |p| p[2] == 0.0);
    let mut body = touching(&mesh, GRAVITY_M_S2, 0.4);
    let block = second..mesh.nodes.len();
    body.v[block.clone()].iter_mut().for_each(|v| v[0] = 1.0);
    let (start, from) = (body.kinetic_j(), mean(&body, &body.x, block.clone()));
    let (mut kinetic, mut worst) = (0.0, 0.0_f64);
    while body.time_s < 0.4 {
        kinetic = body.step(true);
        worst = worst.max(missing_j(&body, kinetic, start).abs());
    }
    sound(&body)?;
    let travelled = mean(&body, &body.x, block) - from;
    let expected = 1.0 / (2.0 * 0.4 * GRAVITY_M_S2);
    Ok(vec![
        Figure::relative("sliding distance", "m", [expected, travelled], 0.03, "v² / (2 μ g)"),
        Figure::relative("work of friction", "J", [-start, body.contact_j[1]], 0.05, "kinetic energy"),
        Figure::absolute("kinetic energy left", "-", [0.0, kinetic / start], 1e-3, "rest"),
        Figure::absolute(
            "energy residual over kinetic energy",
            "-",
            [0.0, worst / start],
            0.01,
            "conservation",
        ),
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
    let exact = if drawn { libm::exp(limit) - 1.0 } else { libm::exp(limit) - libm::exp(-limit) } / rate;
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
    let foot = 1e3 * body.x.iter().map(|x| libm::hypot(x[0], x[1])).fold(0.0, f64::max);
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
