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
        beam: Some(Beam { half_length_m: 0.5 * LENGTH_M, ends: ["clamp".into(), "tip".into()], span: None }),
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

/// Two spans between clamps under their own weight, with nothing under their middle: a beam of length `2 L` with `w (2 L)² / 12` at its clamps and half of that in its middle (Roark's Formulas for Stress and Strain, 7th ed., table 8.1, case 2d),
/// whichever side the bodies are on and however the beam lies.
#[test]
fn two_spans_under_their_weight_are_a_clamped_beam() {
    let mass_kg_m = 500.0;
    let stiffness_nm_rad = 1e7;
    let shear = 12.0 * stiffness_nm_rad / LENGTH_M.powi(2);
    for (along, across) in [(0, 2), (1, 2)] {
        let mut m = model("two spans", 0.01, 0.01);
        m.settings.preload = true;
        m.curves.insert(
            "end".into(),
            ResistanceCurve { stiffness_nm_rad, ..curve(&[[0.0, 1e9], [1.0, 1e9]], 2.0) },
        );
        let middle = solid("middle", [0.0; 3], [0.2, 0.2, 10.0]);
        m.bodies.push(Body {
            mass_kg: mass_kg_m * LENGTH_M,
            inertia_kg_m2: box_inertia(mass_kg_m * LENGTH_M, [LENGTH_M, LENGTH_M, 0.2]),
            ..middle
        });
        for side in [-1.0, 1.0] {
            let name = |place: &str| format!("{place} {side}");
            let mut point = [0.0; 3];
            point[along] = side * 0.5 * LENGTH_M;
            let mut axes = [[0.0; 3]; 3];
            axes[0][along] = 1.0;
            axes[1][(along + 1) % 3] = 1.0;
            axes[2][(along + 2) % 3] = 1.0;
            let bends_first = (along + 2) % 3 == across;
            let [bent, level] = [hinge("end"), elastic(1e9)];
            m.bushings.push(Bushing {
                axes,
                // no pull along it: as small as the displacements of linear theory
                axial_stiffness_n_m: 1e3,
                shear_stiffness_n_m: [shear; 2],
                beam: Some(Beam {
                    half_length_m: 0.5 * LENGTH_M,
                    ends: if side < 0.0 { ["clamp", "middle"] } else { ["middle", "clamp"] }.map(name),
                    span: Some(Span { length_m: LENGTH_M, mass_kg_m }),
                }),
                ..joint(
                    &name("span"),
                    None,
                    "middle",
                    point,
                    1e9,
                    1e9,
                    if bends_first { [bent, level] } else { [level, bent] },
                )
            });
        }
        let result = simulate(&m).unwrap();
        let clamped = mass_kg_m * G * (2.0 * LENGTH_M).powi(2) / 12.0;
        for hinge in &result.hinges {
            let moment = hinge.moment_nm[0].map(f64::abs).into_iter().fold(0.0, f64::max);
            let wanted = if hinge.joint.starts_with("clamp") { clamped } else { 0.5 * clamped };
            assert!((moment / wanted - 1.0).abs() < 1e-6, "{along} {}: {moment} {wanted}", hinge.joint);
        }
        // hogging at the clamps, sagging in the middle
        let senses: Vec<f64> =
            result.hinges.iter().map(|h| h.moment_nm[0].iter().sum::<f64>().signum()).collect();
        assert_eq!((senses[0], senses[3]), (-senses[1], -senses[2]), "{senses:?}");
        assert!(result.energy_error < 1e-9, "{}", result.energy_error);
    }
}

/// Two halves of a beam that fall freely have no weight to bear: once that is known, no moments are left.
#[test]
fn a_beam_in_free_fall_bears_nothing() {
    let (mass_kg_m, bending) = (500.0, 4e7);
    let mut m = model("free fall", 1.0, 0.01);
    m.curves.insert(
        "end".into(),
        ResistanceCurve { stiffness_nm_rad: bending / LENGTH_M, ..curve(&[[0.0, 1e6], [1.0, 1e6]], 2.0) },
    );
    for side in [-1.0, 1.0] {
        let half =
            solid(&format!("half {side}"), [0.25 * side * LENGTH_M, 0.0, 0.0], [0.5 * LENGTH_M, 0.2, 0.2]);
        let mass_kg = 0.5 * mass_kg_m * LENGTH_M;
        let inertia_kg_m2 = box_inertia(mass_kg, [0.5 * LENGTH_M, 0.2, 0.2]);
        m.bodies.push(Body { mass_kg, inertia_kg_m2, ..half });
    }
    m.bushings.push(Bushing {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        beam: Some(Beam {
            half_length_m: 0.5 * LENGTH_M,
            ends: ["start".into(), "end".into()],
            span: Some(Span { length_m: LENGTH_M, mass_kg_m }),
        }),
        ..joint("middle", Some("half -1"), "half 1", [0.0; 3], 1e9, 1e8, [hinge("end"), elastic(1e8)])
    });
    let result = simulate(&m).unwrap();
    let clamped = mass_kg_m * G * LENGTH_M.powi(2) / 12.0;
    let largest = |from: usize| {
        let moments = result.hinges.iter().flat_map(|h| &h.moment_nm[from..]).flatten();
        moments.fold(0.0_f64, |most, moment| most.max(moment.abs()))
    };
    // it swings about that without damping: as a whole it was bent when it was let go
    let mean: f64 = result.hinges[0].moment_nm[50..].iter().map(|m| m[0]).sum::<f64>() / 51.0;
    assert!(mean.abs() < 0.02 * clamped && largest(0) > clamped, "{mean} of {clamped}");
    assert!(result.energy_error < 1e-3, "{}", result.energy_error);
}

#[test]
fn a_beam_needs_one_curve_shear_and_names_of_its_own() {
    let sound = cantilever(&[[0.0, 1e4], [0.02, 1e4]], 0.02);
    assert!(sound.check().is_ok());
    type Fault = fn(&mut Bushing);
    let faults: [(&str, Fault); 6] = [
        ("has 2 bending axes with a curve, expected one", |b| b.bending[1] = b.bending[0].clone()),
        ("needs shear_stiffness_n_m[1] > 0", |b| b.shear_stiffness_n_m[1] = 0.0),
        ("\"tip\" is the name of another hinge or bushing", |b| {
            b.beam.as_mut().unwrap().ends[0] = "tip".into()
        }),
        ("half_length_m", |b| b.beam.as_mut().unwrap().half_length_m = -1.0),
        ("is 3 m, expected at least 4 m", |b| {
            b.beam.as_mut().unwrap().span = Some(Span { length_m: 3.0, mass_kg_m: 1.0 })
        }),
        ("span.mass_kg_m", |b| b.beam.as_mut().unwrap().span = Some(Span { length_m: 4.0, mass_kg_m: -1.0 })),
    ];
    for (words, fault) in faults {
        let mut m = sound.clone();
        fault(&mut m.bushings[0]);
        let said = m.check().unwrap_err().to_string();
        assert!(said.contains(words), "{words}: {said}");
    }
}
