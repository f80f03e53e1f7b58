//! Bending: elastic and plastic cantilevers in all element forms, beam theory, the plastic hinge.

use super::body::{Crossings, sound};
use super::forms::{FORMS, Swing, TestedForm};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::law::{ElementForm, Law};
use crate::fe::preload::equilibrate;
use crate::fe::shapes::{bilinear, elastic, grid, nearest};
use crate::verify::{Case, Figure, Form};

const GRAVITY_M_S2: f64 = 9.81;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for form in FORMS {
        // the finest mesh takes minutes: the form that is used by default shows its limit
        let default = form.form == ElementForm::default();
        for (along, short) in [(20, true), (40, default)].into_iter().chain(default.then_some((80, false))) {
            cases.push(Case {
                form: Form::short_if(short),
                ..Case::long(
                    format!("elastic-cantilever-{along}-{}", form.name),
                    "Cantilever 10 x 1 x 1 m, E 30 GPa, ν 0.2, 2500 kg/m³, under suddenly applied gravity; two, four or eight \
                     elements deep. The last value stands on a steep flank: 0.07 % of the period is 1.5 % of it.",
                    move || elastic_cantilever(along, form),
                )
            });
            cases.push(Case {
                form: Form::short_if(short),
                ..Case::long(
                    format!("plastic-cantilever-{along}-{}", form.name),
                    "The elastic cantilever with a yield stress of 2 MPa and a tangent modulus of 300 MPa. The converged tip at \
                     0.5 s is 655 to 665 mm (three element forms of OpenRadioss on three meshes).",
                    move || plastic_cantilever(along, form),
                )
            });
        }
    }
    cases.push(Case::short(
        "static-cantilever",
        "The cantilever's static deflection under its own weight, two elements deep.",
        static_cantilever,
    ));
    cases.push(Case::short(
        "cantilever-frequency",
        "The same cantilever let go from its static state: first natural frequency over two periods.",
        frequency,
    ));
    for (deep, tolerance) in [(2, 0.05), (4, 0.03)] {
        cases.push(Case::short(
            format!("plastic-hinge-{deep}"),
            "A bar bent to 20 times its yield curvature, perfectly plastic, two or four elements deep. The floor of the \
             hourglass stiffness in flowing elements adds to the moment.",
            move || plastic_hinge(deep, tolerance),
        ));
    }
    cases
}

/// What a cantilever under sudden gravity shows.
struct Seen {
    /// Tip displacement at 0.1, 0.2, ... 0.5 s \[mm\].
    tenths_mm: Vec<f64>,
    /// First peak \[mm\] and its time \[s\].
    peak: (f64, f64),
    /// Highest point after it \[mm\] and its time \[s\].
    back: (f64, f64),
    /// Energy residual over the largest work of gravity.
    residual: f64,
}

fn swing(along: usize, law: Law) -> Result<Seen, String> {
    let deep = along / 10;
    let mesh = grid([along, deep, deep], [10.0, 1.0, 1.0], law, |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    let tip = nearest(&mesh, [10.0, 0.5, 0.5]);
    let mut seen =
        Seen { tenths_mm: Vec::new(), peak: (0.0, 0.0), back: (f64::NEG_INFINITY, 0.0), residual: 0.0 };
    let (mut down, mut work) = (0.0, 0.0_f64);
    while seen.tenths_mm.len() < 5 {
        let moved_s = body.dt_s;
        let late = body.time_s + moved_s - 0.1 * (seen.tenths_mm.len() + 1) as f64;
        let kinetic = body.step(late >= 0.0);
        let before = down;
        down = 1e3 * (body.x[tip][2] - 0.5);
        if body.time_s < 0.13 && down < seen.peak.0 {
            seen.peak = (down, body.time_s);
        }
        if (0.15..0.24).contains(&body.time_s) && down > seen.back.0 {
            seen.back = (down, body.time_s);
        }
        if late >= 0.0 {
            sound(&body)?;
            seen.tenths_mm.push(down + (before - down) * late / moved_s);
            work = work.max(body.gravity_j.abs());
            seen.residual = super::body::missing_j(&body, kinetic, 0.0) / work;
        }
    }
    Ok(seen)
}

fn elastic_cantilever(along: usize, form: &TestedForm) -> Result<Vec<Figure>, String> {
    let seen = swing(along, form.law(elastic()))?;
    let Swing { peak_mm, peak_s, back_s, tip_mm, tolerance, source } = form.elastic[usize::from(along > 20)];
    let relative =
        |name: &str, unit, values, tolerance| Figure::relative(name, unit, values, tolerance, source);
    let mut figures = vec![
        relative("first peak", "mm", [peak_mm, seen.peak.0], tolerance),
        relative("time of the first peak", "s", [peak_s, seen.peak.1], tolerance),
        relative("back at the start", "s", [back_s, seen.back.1], tolerance),
    ];
    let tips = tip_mm.iter().flat_map(|tip| tip.iter().zip([(1, 1.0), (3, 1.0), (5, 5.0)]));
    figures.extend(tips.map(|(tip, (tenth, factor))| {
        let name = format!("tip at 0.{tenth} s");
        relative(&name, "mm", [*tip, seen.tenths_mm[tenth - 1]], factor * tolerance)
    }));
    figures.push(Figure::absolute(
        "energy residual over work",
        "-",
        [0.0, seen.residual],
        1e-3,
        "conservation",
    ));
    Ok(figures)
}

fn plastic_cantilever(along: usize, form: &TestedForm) -> Result<Vec<Figure>, String> {
    let seen = swing(along, form.law(bilinear(30e9, 0.2, 2500.0, 2e6, 300e6)))?;
    let tip = form.plastic[usize::from(along > 20)];
    Ok(vec![
        Figure::relative("tip at 0.5 s", "mm", [tip.mm, seen.tenths_mm[4]], tip.tolerance, tip.source),
        Figure::absolute("energy residual over work", "-", [0.0, seen.residual], 5e-3, "conservation"),
    ])
}

/// `w L⁴ / (8 E I)` and `w L² / (2 κ G A)` with κ = 5/6.
fn static_cantilever() -> Result<Vec<Figure>, String> {
    let mesh = grid([20, 2, 2], [10.0, 1.0, 1.0], elastic(), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    equilibrate(&mut body)?;
    let load = 2500.0 * GRAVITY_M_S2;
    let (bending, shear) = (load * 1e4 / (8.0 * 30e9 / 12.0), load * 100.0 / (2.0 * 5.0 / 6.0 * 12.5e9));
    let sunk = 0.5 - body.x[nearest(&mesh, [10.0, 0.5, 0.5])][2];
    let reaction: f64 =
        mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * GRAVITY_M_S2).sum();
    Ok(vec![
        Figure::relative(
            "tip deflection",
            "m",
            [bending + shear, sunk],
            0.01,
            "beam theory with shear, κ = 5/6",
        ),
        Figure::relative("reaction", "N", [10.0 * load, reaction], 1e-8, "weight"),
    ])
}

/// First natural frequency \[1/s\] of a clamped Timoshenko beam from Huang's characteristic equation (J. Appl. Mech. 28 (1961) 579),
/// with `b² = ρ A L⁴ ω² / (E I)`, `r² = I / (A L²)`, `s² = E I / (κ A G L²)`.
fn timoshenko_1_s() -> f64 {
    let (length, area, inertia): (f64, f64, f64) = (10.0, 1.0, 1.0 / 12.0);
    let (young, shear, density) = (30e9, 12.5e9, 2500.0);
    let r2 = inertia / (area * length * length);
    let s2 = young * inertia / (5.0 / 6.0 * area * shear * length * length);
    let characteristic = |b: f64| {
        let root = ((r2 - s2) * (r2 - s2) + 4.0 / (b * b)).sqrt();
        let alpha = ((root - (r2 + s2)) / 2.0).sqrt();
        let beta = ((root + (r2 + s2)) / 2.0).sqrt();
        let first = (b * b * (r2 - s2) * (r2 - s2) + 2.0) * libm::cosh(b * alpha) * libm::cos(b * beta);
        let second =
            b * (r2 + s2) / (1.0 - b * b * r2 * s2).sqrt() * libm::sinh(b * alpha) * libm::sin(b * beta);
        2.0 + first - second
    };
    let (mut low, mut high) = (1.0, 3.6); // Euler: 3.516
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if characteristic(middle) > 0.0 { low = middle } else { high = middle }
    }
    let scale: f64 = young * inertia / (density * area * length.powi(4));
    low * scale.sqrt() / std::f64::consts::TAU
}

fn frequency() -> Result<Vec<Figure>, String> {
    let mesh = grid([20, 2, 2], [10.0, 1.0, 1.0], elastic(), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    equilibrate(&mut body)?;
    body.acceleration_m_s2 = [0.0; 3];
    let tip = nearest(&mesh, [10.0, 0.5, 0.5]);
    let mut zero = Crossings::default();
    while zero.times_s.len() < 5 && body.time_s < 1.0 {
        body.step(false);
        zero.see(body.time_s, body.x[tip][2] - 0.5);
    }
    let source = "Timoshenko beam, Huang, J. Appl. Mech. 28 (1961) 579";
    Ok(vec![Figure::relative(
        "first natural frequency",
        "1/s",
        [timoshenko_1_s(), zero.frequency_1_s()?],
        0.01,
        source,
    )])
}

fn plastic_hinge(deep: usize, tolerance: f64) -> Result<Vec<Figure>, String> {
    let (length, yield_pa, end_s) = (2.0, 2e6, 0.15);
    let law = bilinear(30e9, 0.2, 2500.0, yield_pa, 0.0);
    let mesh = grid([2 * deep, deep, deep], [length, 1.0, 1.0], law, |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.damping_1_s = 200.0;
    let curvature = 20.0 * 2.0 * yield_pa / 30e9;
    let ends: Vec<(usize, f64)> = (0..mesh.nodes.len())
        .filter_map(|n| match mesh.nodes[n][0] {
            0.0 => Some((n, 1.0)),
            x if x == length => Some((n, -1.0)),
            _ => None,
        })
        .collect();
    for (n, side) in &ends {
        let speed = side * (mesh.nodes[*n][2] - 0.5) * 0.5 * curvature * length / end_s;
        body.prescribed_m_s[*n] = [Some(speed), None, None];
    }
    while body.time_s < end_s {
        body.step(false);
    }
    let moment: f64 = ends
        .iter()
        .filter(|(_, side)| *side < 0.0)
        .map(|(n, _)| ((body.x[*n][2] - 0.5) * body.internal_n(*n)[0]).abs())
        .sum();
    let missing = super::body::missing_j(&body, body.kinetic_j(), 0.0) / super::body::stored_j(&body);
    Ok(vec![
        Figure::relative("plastic moment", "N m", [yield_pa / 4.0, moment], tolerance, "σ_y b h² / 4"),
        Figure::absolute("energy residual over work", "-", [0.0, missing], 0.01, "conservation"),
    ])
}
