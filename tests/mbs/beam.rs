//! Beams with hinges at their ends, as bushings in their middle.

use super::support::*;
use fallwerk::curve::ResistanceCurve;
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::simulate;

const LENGTH_M: f64 = 4.0;
/// Stiff: until the end yields the mass falls freely.
const BENDING_NM2: f64 = 1e11;

/// A mass at the end of a beam without mass that is clamped at the origin, under its weight at once.
fn cantilever(capacity: &[[f64; 2]], fracture_rad: f64) -> Model {
    let mut m = model("cantilever", 0.3, 0.01);
    let stiffness_nm_rad = BENDING_NM2 / LENGTH_M;
    m.curves.insert("end".into(), ResistanceCurve { stiffness_nm_rad, ..curve(capacity, fracture_rad) });
    let mass = solid("mass", [LENGTH_M, 0.0, 0.0], [0.2, 0.2, 10.0]);
    m.bodies.push(Body { inertia_kg_m2: box_inertia(mass.mass_kg, [0.2; 3]), ..mass });
    let shear = 12.0 * BENDING_NM2 / LENGTH_M.powi(3);
    m.bushings.push(Bushing {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        shear_stiffness_n_m: [shear; 2],
        beam: Some(Beam { half_length_m: 0.5 * LENGTH_M, ends: ["clamp".into(), "tip".into()] }),
        ..joint(
            "beam",
            None,
            "mass",
            [0.5 * LENGTH_M, 0.0, 0.0],
            1e11,
            1e9,
            [hinge("end"), elastic(stiffness_nm_rad)],
        )
    });
    track(&mut m, "mass", [LENGTH_M, 0.0, 0.0]);
    m
}

/// A rigid-plastic cantilever falls about its clamped end: `(m L² + I) α = m g L - M_p` (Jones, Structural Impact, 1989, chapter 3).
#[test]
fn a_plastic_cantilever_falls_about_its_clamped_end() {
    let mass: f64 = 1000.0;
    let plastic = 0.5 * mass * G * LENGTH_M;
    let m = cantilever(&[[0.0, plastic], [1.0, plastic]], 2.0);
    assert!((m.bodies[0].mass_kg - mass).abs() < 1e-9);
    let result = simulate(&m).unwrap();
    let inertia = mass * LENGTH_M * LENGTH_M + mass * 0.04 / 6.0;
    let angle = 0.5 * (mass * G * LENGTH_M - plastic) / inertia * 0.3 * 0.3;
    let found = -result.tracked[0].displacement_m.last().unwrap()[2] / LENGTH_M;
    let [clamp, tip] = &result.hinges[..] else { panic!("{} hinges", result.hinges.len()) };
    println!("{found:.6} rad ({angle:.6}), clamp {:?}", clamp.rotation_rad.last());
    assert!((found / angle - 1.0).abs() < 0.01, "{found} {angle}");
    assert_eq!((clamp.joint.as_str(), tip.joint.as_str()), ("clamp", "tip"));
    assert!((clamp.plastic_rotation_rad.last().unwrap() / angle - 1.0).abs() < 0.02);
    assert!(clamp.rotation_rad.last().unwrap()[0] > 0.0 && clamp.rotation_rad.last().unwrap()[1] == 0.0);
    assert_eq!(*tip.plastic_rotation_rad.last().unwrap(), 0.0);
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

#[test]
fn an_end_that_breaks_is_named_and_opens_the_beam() {
    let mut m = cantilever(&[[0.0, 1e4], [0.02, 1e4]], 0.02);
    m.settings.end_time_s = 0.5;
    let result = simulate(&m).unwrap();
    let named = |fracture: bool| {
        result.events.iter().find_map(|e| match &e.kind {
            EventKind::Yield { joint } if !fracture => Some(joint.clone()),
            EventKind::Fracture { joint, .. } if fracture => Some(joint.clone()),
            _ => None,
        })
    };
    assert_eq!((named(false).as_deref(), named(true).as_deref()), (Some("clamp"), Some("clamp")));
    let [.., before, last] = &result.tracked[0].displacement_m[..] else { panic!("no history") };
    // it falls freely after that: 9.81 m/s² over two outputs
    let earlier = result.tracked[0].displacement_m[result.times_s.len() - 3];
    let acceleration = (last[2] - 2.0 * before[2] + earlier[2]) / 1e-4;
    assert!((acceleration + G).abs() < 1e-3, "{acceleration}");
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

#[test]
fn a_beam_needs_one_curve_shear_and_names_of_its_own() {
    let sound = cantilever(&[[0.0, 1e4], [0.02, 1e4]], 0.02);
    assert!(sound.check().is_ok());
    type Fault = fn(&mut Bushing);
    let faults: [(&str, Fault); 4] = [
        ("has 2 bending axes with a curve, expected one", |b| b.bending[1] = b.bending[0].clone()),
        ("needs shear_stiffness_n_m[1] > 0", |b| b.shear_stiffness_n_m[1] = 0.0),
        ("\"tip\" is the name of another hinge or bushing", |b| {
            b.beam.as_mut().unwrap().ends[0] = "tip".into()
        }),
        ("half_length_m", |b| b.beam.as_mut().unwrap().half_length_m = -1.0),
    ];
    for (words, fault) in faults {
        let mut m = sound.clone();
        fault(&mut m.bushings[0]);
        let said = m.check().unwrap_err().to_string();
        assert!(said.contains(words), "{words}: {said}");
    }
}
