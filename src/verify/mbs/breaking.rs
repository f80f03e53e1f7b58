//! When a hinge yields and breaks, and how fast what it held goes on, in steps that both fall into.
//!
//! A body that turns at `ω_0` about its centre against a rotation spring `K` swings by `ω_0/ω_n sin ω_n t` with `ω_n² = K/I`, until its moment is the capacity `C`; from there on it is slowed down by `C/I` until the plastic rotation is that of
//! fracture, and turns on at `ω² = ω_0² - C²/(K I) - 2 C θ_f / I`. A beam in whose middle the body has its centre bends with the same moment at both ends, each of which yields and breaks: `2 θ_f`.

use super::contact::{energy, last, run};
use super::models::body;
use crate::curve::{CapacityLevel, ResistanceCurve};
use crate::mbs::model::{Beam, Bending, Bushing, Model};
use crate::mbs::result::{EventKind, RunResult};
use crate::verify::{Case, Figure};

const INERTIA_KG_M2: f64 = 50.0;
const STIFFNESS_NM_RAD: f64 = 1e5;
const CAPACITY_NM: f64 = 1e3;
const RATE_RAD_S: f64 = 2.0;
const END_S: f64 = 0.06;
/// Half the length of the beam \[m\]; what its shear spring does has no part in it.
const HALF_M: f64 = 2.0;
/// Rotations at which it breaks: within the step in which it yields, and some steps later \[rad\].
const FRACTURES_RAD: [(f64, &str); 2] = [(2e-4, "at once"), (0.02, "later")];
/// Steps \[s\], and how far off times \[s\] and the rotation at the end \[rad\] may be: of second order.
const STEPS: [(f64, &str, [f64; 2]); 2] = [(2e-3, "2 ms", [4e-5, 8e-5]), (5e-4, "0.5 ms", [2.5e-6, 5e-6])];
const SOURCE: &str = "swing, then C/I";

/// The case of this file.
pub fn cases() -> Vec<Case> {
    vec![Case::short(
        "fracture-times",
        "A body of 50 kg m² that turns at 2 rad/s against a hinge of 100 kN m/rad that bears 1 kN m and breaks after 0.2 or 20 mrad, and against the hinges at both ends of a beam: when they yield and break, and the rotation after 60 ms, in steps of 2 and 0.5 ms.",
        figures,
    )]
}

fn figures() -> Result<Vec<Figure>, String> {
    let mut figures = Vec::new();
    for (is_beam, of) in [(false, "hinge"), (true, "beam")] {
        for (fracture_rad, when) in FRACTURES_RAD {
            let [yields_s, breaks_s, rotation] = known(if is_beam { 2.0 } else { 1.0 } * fracture_rad);
            for (step_s, step, [late_s, off]) in STEPS {
                let result = run(&turned(is_beam, fracture_rad, step_s))?;
                let [found_yields_s, found_breaks_s] = times(&result);
                let name = |what: &str| format!("{of} {what}, breaks {when}, {step}");
                let time = |what, pair: [f64; 2]| Figure::absolute(name(what), "s", pair, late_s, SOURCE);
                figures.push(time("yields", [yields_s, found_yields_s]));
                figures.push(time("breaks", [breaks_s, found_breaks_s]));
                let [w, _, y, _] = last(&result).orientation[0];
                let angle = [rotation, 2.0 * libm::atan2(y, w)];
                figures.push(Figure::absolute(name("rotation"), "rad", angle, off, SOURCE));
                figures.push(energy(&result, 1e-3));
            }
        }
    }
    Ok(figures)
}

/// When it yields and breaks \[s\], and the rotation at the end \[rad\], for the plastic rotation in all.
fn known(fracture_rad: f64) -> [f64; 3] {
    let rate = (STIFFNESS_NM_RAD / INERTIA_KG_M2).sqrt();
    let (yield_rad, slower) = (CAPACITY_NM / STIFFNESS_NM_RAD, CAPACITY_NM / INERTIA_KG_M2);
    let yields_s = libm::asin(yield_rad * rate / RATE_RAD_S) / rate;
    let at_yield = (RATE_RAD_S.powi(2) - (yield_rad * rate).powi(2)).sqrt();
    let left = (at_yield * at_yield - 2.0 * slower * fracture_rad).sqrt();
    let breaks_s = yields_s + (at_yield - left) / slower;
    [yields_s, breaks_s, yield_rad + fracture_rad + left * (END_S - breaks_s)]
}

/// The first yield and the first fracture of a run \[s\].
fn times(result: &RunResult) -> [f64; 2] {
    let first = |of: fn(&EventKind) -> bool| result.events.iter().find(|e| of(&e.kind)).map(|e| e.time_s);
    [
        first(|k| matches!(k, EventKind::Yield { .. })).unwrap_or(f64::NAN),
        first(|k| matches!(k, EventKind::Fracture { .. })).unwrap_or(f64::NAN),
    ]
}

/// A body that turns against a hinge that breaks at a rotation \[rad\], or against those of a beam, in steps \[s\].
pub fn turned(is_beam: bool, fracture_rad: f64, step_s: f64) -> Model {
    let mut m = Model::empty("body that breaks a hinge", [0.0; 3], END_S, END_S);
    m.settings.time_step_s = Some(step_s);
    let mut body = body("b", 200.0, [INERTIA_KG_M2; 3], [0.0; 3]);
    body.angular_velocity_rad_s = [0.0, RATE_RAD_S, 0.0];
    m.bodies.push(body);
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, CAPACITY_NM], [1.0, CAPACITY_NM]],
        fracture_rotation_rad: fracture_rad,
    };
    let curve = ResistanceCurve { stiffness_nm_rad: STIFFNESS_NM_RAD, levels: vec![level], cyclic: None };
    m.curves.insert("c".into(), curve);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    m.bushings.push(Bushing {
        // nearly none: a beam is as long as the chord between its hinges, which a rotation shortens
        axial_stiffness_n_m: 1.0,
        shear_stiffness_n_m: [3.0 * STIFFNESS_NM_RAD / (HALF_M * HALF_M); 2],
        bending: [
            Bending::Curve { curve: "c".into(), strength_factor: 1.0 },
            Bending::Elastic { stiffness_nm_rad: STIFFNESS_NM_RAD },
        ],
        beam: is_beam.then(|| Beam {
            half_length_m: HALF_M,
            ends: ["start".into(), "end".into()],
            span: None,
        }),
        ..Bushing::free("h".into(), None, "b".into(), [0.0; 3], axes)
    });
    m
}
