//! Rate factors that a model cannot have, and what they do to members that bend between two hinges. The rest: `verify mbs --case rate`.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::model::*;
use fallwerk::mbs::simulate;

fn hinged() -> Model {
    let mut m = model("rates", 0.1, 0.01);
    m.bodies.push(solid("mass", [0.0, 0.0, 1.0], [1.0; 3]));
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    m.bushings.push(Bushing {
        axial_stiffness_n_m: 1e7,
        shear_stiffness_n_m: [1e7; 2],
        torsional_stiffness_nm_rad: 1e7,
        bending: [0, 1].map(|_| Bending::Elastic { stiffness_nm_rad: 1e7 }),
        compressive_capacity_n: Some(1e5),
        rate_factor: Some(RateFactor { rotation_rad_s: [1.0; 2], elongation_m_s: Some(1.0), exponent: 5.0 }),
        ..Bushing::free("link".into(), None, "mass".into(), [0.0; 3], axes)
    });
    m
}

#[test]
fn wrong_rate_factors_are_said() {
    hinged().check().expect("a sound model");
    let said = |change: &dyn Fn(&mut Model)| {
        let mut m = hinged();
        change(&mut m);
        m.check().unwrap_err().to_string()
    };
    let of = |change: fn(&mut RateFactor)| {
        said(&move |m: &mut Model| change(m.bushings[0].rate_factor.as_mut().unwrap()))
    };
    for (text, place) in [
        (of(|f| f.rotation_rad_s[1] = 0.0), "bushings[0].rate_factor.rotation_rad_s[1]"),
        (of(|f| f.elongation_m_s = Some(f64::NAN)), "bushings[0].rate_factor.elongation_m_s"),
        (of(|f| f.exponent = 0.5), "bushings[0].rate_factor.exponent"),
        (said(&|m| m.bushings[0].compressive_capacity_n = None), "bushings[0].rate_factor.elongation_m_s"),
        (
            said(&|m| {
                let bushing = &mut m.bushings[0];
                (bushing.compressive_capacity_n, bushing.shear_capacity_n) = (None, Some([1e5; 2]));
                bushing.rate_factor.as_mut().unwrap().elongation_m_s = None;
            }),
            "bushings[0].rate_factor",
        ),
    ] {
        assert!(text.contains(place), "{place}: {text}");
    }
}

const HINGE_NM_RAD: f64 = 6e7;
const HINGE_NM: f64 = 2e5;
const RUN_S: f64 = 0.12;

/// A heavy block that turns on the top of a column, with hinges at both ends of it that know rates, and what they carry over to each other.
fn turning_block(c_rad_s: f64) -> Model {
    let mut m = model("carry", RUN_S, 0.01);
    m.gravity_m_s2 = [0.0; 3];
    m.settings.time_step_s = Some(5e-5);
    let body = |id: &str, z: f64, mass_kg: f64, inertia: f64| Body {
        mass_kg,
        inertia_kg_m2: [[inertia, 0.0, 0.0], [0.0, inertia, 0.0], [0.0, 0.0, inertia]],
        shapes: Vec::new(),
        ..solid(id, [0.0, 0.0, z], [1.0; 3])
    };
    m.bodies.push(body("column", 1.5, 1000.0, 800.0));
    m.bodies.push(Body { angular_velocity_rad_s: [0.0, 0.3, 0.0], ..body("block", 3.2, 50e3, 2e5) });
    let level = CapacityLevel {
        axial_force_n: 0.0,
        capacity: vec![[0.0, HINGE_NM], [1.0, HINGE_NM]],
        fracture_rotation_rad: 9.0,
    };
    m.curves.insert(
        "c".into(),
        ResistanceCurve { stiffness_nm_rad: HINGE_NM_RAD, levels: vec![level], cyclic: None },
    );
    let factor = RateFactor { rotation_rad_s: [c_rad_s; 2], elongation_m_s: None, exponent: 5.0 };
    let of = |id: &str, a: Option<&str>, z: f64| Bushing {
        axes: [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]],
        rate_factor: Some(factor),
        ..joint(id, a, "column", [0.0, 0.0, z], 1e9, 1e8, [hinge("c"), elastic(HINGE_NM_RAD)])
    };
    m.bushings.push(of("foot", None, 0.0));
    let flexibility_rad_nm = [1.0 / HINGE_NM_RAD; 2];
    m.bushings.push(Bushing {
        carry_over: Some(CarryOver { bushing: "foot".into(), flexibility_rad_nm }),
        ..of("top", Some("block"), 3.0)
    });
    m
}

/// Moment of a hinge and its flow in a step, for its elastic rotation without that.
fn law(e: f64, doubled: f64) -> [f64; 2] {
    let trial = e.abs() * HINGE_NM_RAD;
    if trial <= HINGE_NM {
        return [HINGE_NM_RAD * e, 0.0];
    }
    let borne = |x: f64| HINGE_NM * (1.0 + (x / doubled).powf(0.2));
    let (mut low, mut high) = (0.0, (trial - HINGE_NM) / HINGE_NM_RAD);
    for _ in 0..60 {
        let x = 0.5 * (low + high);
        if trial - HINGE_NM_RAD * x > borne(x) { low = x } else { high = x }
    }
    let x = low * e.signum();
    [HINGE_NM_RAD * (e - x), x]
}

/// What the hinge at the top has flowed, by a planar column of its own with small rotations: `q` is found so that it fits the moments of both ends in every step.
fn flowed_at_top(c_rad_s: f64) -> f64 {
    const STEP_S: f64 = 2e-5;
    let masses = [1000.0, 800.0, 50e3, 2e5];
    let (mut x, mut v, mut force) = ([0.0; 4], [0.0, 0.0, 0.0, 0.3], [0.0; 4]);
    let (mut plastic, mut flowed, mut lean) = ([0.0; 2], 0.0, 0.0);
    for _ in 0..(RUN_S / STEP_S).round() as u32 {
        for k in 0..4 {
            v[k] += STEP_S * force[k] / masses[k];
            x[k] += STEP_S * v[k];
        }
        let [column, turn, block, block_turn] = x;
        let gaps = [column - 1.5 * turn, column + 1.5 * turn - (block - 0.2 * block_turn)];
        let at = |q: f64| {
            [turn - plastic[0] - q, turn - block_turn - plastic[1] + q].map(|e| law(e, c_rad_s * STEP_S))
        };
        let (mut low, mut high) = (lean - 2e-4, lean + 2e-4);
        for _ in 0..45 {
            lean = 0.5 * (low + high);
            let [foot, top] = at(lean);
            if lean > (foot[0] - top[0]) / HINGE_NM_RAD { high = lean } else { low = lean }
        }
        let [foot, top] = at(lean);
        plastic = [plastic[0] + foot[1], plastic[1] + top[1]];
        flowed += top[1].abs();
        force = [
            -1e9 * (gaps[0] + gaps[1]),
            1.5e9 * (gaps[0] - gaps[1]) - foot[0] - top[0],
            1e9 * gaps[1],
            -0.2e9 * gaps[1] + top[0],
        ];
    }
    flowed
}

#[test]
fn what_members_carry_over_goes_on_while_an_end_flows_at_a_rate() {
    for c_rad_s in [200.0, 1.0] {
        let result = simulate(&turning_block(c_rad_s)).unwrap();
        let [found, wanted] =
            [*result.hinges[1].plastic_rotation_rad.last().unwrap(), flowed_at_top(c_rad_s)];
        println!("{c_rad_s}: {found:.6} {wanted:.6}, energy {:.1e}", result.energy_error);
        assert!((found / wanted - 1.0).abs() < 2e-3 && result.energy_error < 1e-5, "{found} {wanted}");
    }
}

/// Two faces that crush: at the speed of the blow the one gives that bears less then, not the one that bears less at rest.
#[test]
fn of_two_faces_the_one_gives_that_bears_less_at_the_speed() {
    let mut m = model("faces", 0.02, 0.001);
    m.gravity_m_s2 = [0.0; 3];
    m.contact.bodies = Some(BodyContact { friction: 0.5, restitution: 0.0 });
    m.bodies.push(solid("low", [0.0, 0.0, 0.5], [0.4, 0.4, 1.0]));
    m.bodies.push(Body { velocity_m_s: [0.0, 0.0, -8.0], ..solid("up", [0.0, 0.0, 1.501], [0.4, 0.4, 1.0]) });
    let face = |body: &str, face: Face, force: f64, rate_factor: Option<FaceRate>| CrushedFace {
        body: body.into(),
        shape: 0,
        face,
        force_n: vec![[0.0, force]],
        rate_factor,
        subsystem: None,
    };
    let rate = FaceRate { speed_m_s: 4.0, exponent: 1.0 };
    m.contact.crushing = vec![face("low", Face::HighZ, 1.2e5, None), face("up", Face::LowZ, 1e5, Some(rate))];
    let result = simulate(&m).unwrap();
    let depth = |i: usize| *result.crushed[i].depth_m.last().unwrap();
    println!("{} {}", depth(0), depth(1));
    assert!(depth(0) > 0.01 && depth(1) < 0.3 * depth(0), "{} {}", depth(0), depth(1));
}
