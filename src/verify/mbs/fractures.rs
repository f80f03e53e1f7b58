//! Bushings that separate within a step: when, and with what energy the body goes on.

use super::contact::{energy, model, run};
use super::models::solid;
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Bending, Bushing, Model};
use crate::mbs::result::{EventKind, RunResult};
use crate::verify::{Case, Figure};

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "fracture-spring",
            "100 kg at 1 m/s on a spring of 1 MN/m that separates at 2345 N, in tension and in shear, with the automatic step of 1 ms, in which the force grows by 1 kN.",
            spring,
        ),
        Case::short(
            "fracture-stretch",
            "100 kg at 1 m/s on a spring of 10 MN/m that flows at 2 kN and separates after 5 mm of it, in tension, in compression (crushed) and in shear at an angle to both axes, with steps of 0.1 ms.",
            stretch,
        ),
        Case::short(
            "fracture-hinge",
            "A body of 1000 kg m² at 2 rad/s about a hinge that flows at 3 kN m and breaks after 0.15 rad of it, with steps of 0.5 ms.",
            hinge,
        ),
    ]
}

/// A cube of 100 kg without gravity on a bushing in its centre, all of whose springs have one stiffness \[N/m, N m/rad\].
pub(super) fn held(stiffness: f64) -> (Model, Bushing) {
    let mut m = model(0.1, 0.01);
    m.gravity_m_s2 = [0.0; 3];
    m.bodies.push(solid("mass", 100.0, [1.0; 3], [0.0; 3]));
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let bushing = Bushing {
        axial_stiffness_n_m: stiffness,
        shear_stiffness_n_m: [stiffness; 2],
        torsional_stiffness_nm_rad: stiffness,
        bending: [
            Bending::Elastic { stiffness_nm_rad: stiffness },
            Bending::Elastic { stiffness_nm_rad: stiffness },
        ],
        ..Bushing::free("link".into(), None, "mass".into(), [0.0; 3], axes)
    };
    (m, bushing)
}

/// When a body of inertia `m` and velocity `v` on a spring `k` that flows from `c` on has gone as far as `flow` beyond, and its velocity then.
fn closed_form([m, v, k, c, flow]: [f64; 5]) -> [f64; 2] {
    let rate = (k / m).sqrt();
    let onset = libm::asin(c / (k * v / rate)) / rate;
    let slower = v * libm::cos(rate * onset);
    let last = (slower * slower - 2.0 * c / m * flow).sqrt();
    [onset + (slower - last) * m / c, last]
}

fn figures(
    result: &RunResult,
    names: [&'static str; 2],
    [time_s, share]: [f64; 2],
    most: [f64; 2],
) -> Vec<Figure> {
    let broke = result.events.iter().find(|e| matches!(e.kind, EventKind::Fracture { .. }));
    let kinetic = &result.energies.kinetic_j;
    let source = "closed form: elastic to the capacity, then a constant force";
    vec![
        Figure::absolute(names[0], "s", [time_s, broke.map_or(f64::NAN, |e| e.time_s)], most[0], source),
        Figure::relative(
            names[1],
            "of that before",
            [share, kinetic[kinetic.len() - 1] / kinetic[0]],
            most[1],
            source,
        ),
    ]
}

fn spring() -> Result<Vec<Figure>, String> {
    let mut all = Vec::new();
    for (axis, names) in [
        (0, ["separates, in tension", "kinetic energy after"]),
        (1, ["separates, in shear", "kinetic energy after"]),
    ] {
        let (mut m, mut link) = held(1e6);
        m.bodies[0].velocity_m_s[axis] = 1.0;
        if axis == 0 {
            link.tensile_capacity_n = Some(2345.0);
        } else {
            link.shear_capacity_n = Some([2345.0; 2]);
        }
        m.bushings.push(link);
        let result = run(&m)?;
        let [time_s, v] = closed_form([100.0, 1.0, 1e6, 2345.0, 0.0]);
        all.extend(figures(&result, names, [time_s, v * v], [2e-6, 1e-5]));
        all.push(energy(&result, 1e-5));
    }
    Ok(all)
}

fn stretch() -> Result<Vec<Figure>, String> {
    let mut all = Vec::new();
    for (velocity_m_s, names) in [
        ([1.0, 0.0, 0.0], ["separates, stretched", "kinetic energy after"]),
        ([-1.0, 0.0, 0.0], ["separates, crushed", "kinetic energy after"]),
        ([0.0, 0.6, -0.8], ["separates, slipping", "kinetic energy after"]),
    ] {
        let (mut m, mut link) = held(1e7);
        m.settings.time_step_s = Some(1e-4);
        m.bodies[0].velocity_m_s = velocity_m_s;
        match velocity_m_s[0] {
            v if v > 0.0 => (link.tensile_capacity_n, link.tensile_elongation_m) = (Some(2e3), Some(5e-3)),
            v if v < 0.0 => {
                (link.compressive_capacity_n, link.crushing_shortening_m) = (Some(2e3), Some(5e-3));
            }
            _ => (link.shear_capacity_n, link.shear_slip_m) = (Some([2e3; 2]), Some(5e-3)),
        }
        m.bushings.push(link);
        let result = run(&m)?;
        let [time_s, v] = closed_form([100.0, 1.0, 1e7, 2e3, 5e-3]);
        all.extend(figures(&result, names, [time_s, v * v], [1e-5, 1e-3]));
        all.push(energy(&result, 1e-5));
    }
    Ok(all)
}

/// A body of 1000 kg m² at 2 rad/s about a hinge that flows at 3 kN m up to a rotation, with steps of 0.5 ms.
pub(super) fn turning(stiffness_nm_rad: f64, breaks_rad: f64) -> (Model, Bushing) {
    let (mut m, mut link) = held(1e5);
    m.settings.time_step_s = Some(5e-4);
    m.bodies[0].inertia_kg_m2 = [[1e3, 0.0, 0.0], [0.0, 1e3, 0.0], [0.0, 0.0, 1e3]];
    m.bodies[0].angular_velocity_rad_s = [0.0, 2.0, 0.0];
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, 3e3], [1.0, 3e3]],
        fracture_rotation_rad: breaks_rad,
    };
    m.curves.insert("curve".into(), ResistanceCurve { stiffness_nm_rad, levels: vec![level], cyclic: None });
    link.bending[0] = Bending::Curve { curve: "curve".into(), strength_factor: 1.0 };
    (m, link)
}

fn hinge() -> Result<Vec<Figure>, String> {
    let (mut m, link) = turning(1e6, 0.15);
    m.settings.end_time_s = 0.2;
    m.bushings.push(link);
    let result = run(&m)?;
    let [time_s, w] = closed_form([1e3, 2.0, 1e6, 3e3, 0.15]);
    let mut all = figures(&result, ["breaks", "kinetic energy after"], [time_s, w * w / 4.0], [5e-6, 1e-4]);
    all.push(energy(&result, 1e-6));
    Ok(all)
}
