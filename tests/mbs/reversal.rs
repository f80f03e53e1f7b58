//! Plastic flow that turns back within a step of error control, against closed forms: a mass at rest on an elastic, ideally plastic spring, under a load that is suddenly there.
//!
//! It flows if the load is more than half of the capacity, turns where the work of the load is that of spring and flow, and vibrates about its new rest from then on.

use super::support::*;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::model::*;
use fallwerk::mbs::result::EventKind;
use fallwerk::mbs::simulate;

const MASS: f64 = 2.0;
const CAPACITY: f64 = 10.0;

/// A stiffness and a load.
#[derive(Clone, Copy, Debug)]
struct Case {
    stiffness: f64,
    load: f64,
}

impl Case {
    /// Largest displacement: `P x = C²/2k + C (x - C/k)`.
    fn peak(self) -> f64 {
        CAPACITY * CAPACITY / (2.0 * self.stiffness * (CAPACITY - self.load))
    }

    fn plastic(self) -> f64 {
        self.peak() - CAPACITY / self.stiffness
    }

    /// When it turns.
    fn turns_at(self) -> f64 {
        let fastest = (self.stiffness / MASS).sqrt();
        let yields = (1.0 - CAPACITY / self.load).acos() / fastest;
        let speed = self.load / self.stiffness * fastest * (fastest * yields).sin();
        yields + speed * MASS / (CAPACITY - self.load)
    }

    /// Displacement at a time after that.
    fn at(self, time: f64) -> f64 {
        let rest = self.plastic() + self.load / self.stiffness;
        let turned = (self.stiffness / MASS).sqrt() * (time - self.turns_at());
        rest + (self.peak() - rest) * turned.cos()
    }
}

fn cases() -> impl Iterator<Item = Case> {
    let of = |stiffness: f64| [5.3, 6.2, 6.609, 7.4, 8.3].map(|load| Case { stiffness, load });
    [60.0, 244.9, 700.0, 1_880.0].into_iter().flat_map(of)
}

/// A block of 2 kg, or 2 kg m² about all axes, that a joint lets move along or about an axis.
fn block(end_time_s: f64, kind: JointKind, axis: [f64; 3]) -> Model {
    let mut m = model("reversal", end_time_s, end_time_s / 20.0);
    m.gravity_m_s2 = [0.0; 3];
    let mut body = solid("block", [0.0; 3], [0.1; 3]);
    (body.mass_kg, body.shapes) = (MASS, Vec::new());
    body.inertia_kg_m2 = [[MASS, 0.0, 0.0], [0.0, MASS, 0.0], [0.0, 0.0, MASS]];
    m.bodies.push(body);
    m.joints.push(Joint { axis: Some(axis), ..ideal("pin", kind, None, "block", [0.0; 3]) });
    track(&mut m, "block", [1.0, 0.0, 0.0]);
    m
}

/// Pulled along x on a guide, against a bushing that stretches.
fn pulled(case: Case, end_time_s: f64, elongation_m: f64) -> Model {
    let mut m = block(end_time_s, JointKind::Prismatic, [1.0, 0.0, 0.0]);
    m.forces.push(Force::Force {
        id: "pull".into(),
        body: "block".into(),
        point_m: [0.0; 3],
        force_n: [case.load, 0.0, 0.0],
        from_to_s: None,
    });
    m.bushings.push(Bushing {
        axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        tensile_capacity_n: Some(CAPACITY),
        tensile_elongation_m: Some(elongation_m),
        ..joint("bar", None, "block", [-0.5, 0.0, 0.0], case.stiffness, 1.0, [elastic(1.0), elastic(1.0)])
    });
    m
}

/// Turned about z on a pin, against a hinge or a bushing.
fn turned(case: Case, end_time_s: f64, on_bushing: bool) -> Model {
    let mut m = block(end_time_s, JointKind::Revolute, [0.0, 0.0, 1.0]);
    m.forces.push(Force::Torque {
        id: "turn".into(),
        body: "block".into(),
        torque_nm: [0.0, 0.0, case.load],
        from_to_s: None,
    });
    if on_bushing {
        let level = CapacityLevel {
            axial_force_n: 0.0,
            capacity: vec![[0.0, CAPACITY], [100.0, CAPACITY]],
            fracture_rotation_rad: 100.0,
        };
        m.curves.insert(
            "c".into(),
            ResistanceCurve { stiffness_nm_rad: case.stiffness, levels: vec![level], cyclic: None },
        );
        m.bushings.push(Bushing {
            joint: Some("pin".into()),
            axes: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
            ..joint("knee", None, "block", [0.0; 3], 0.0, 0.0, [hinge("c"), elastic(0.0)])
        });
    } else {
        m.forces.push(Force::Hinge {
            id: "knee".into(),
            body_a: None,
            body_b: "block".into(),
            stiffness_nm_rad: case.stiffness,
            capacity: vec![[0.0, CAPACITY]],
            fracture_rad: None,
            joint: None,
        });
    }
    m
}

/// Largest error of where a body is at the end, in shares of the way to its turn.
fn worst(of: impl Fn(Case, f64) -> (Model, fn([f64; 3]) -> f64)) -> f64 {
    let error = |case: Case| {
        let end = 1.6 * case.turns_at();
        let (m, read) = of(case, end);
        let found = read(*simulate(&m).unwrap().tracked[0].displacement_m.last().unwrap());
        println!("{case:?}: {found:.6} {:.6}", case.at(end));
        ((found - case.at(end)) / case.peak()).abs()
    };
    cases().filter(|c| c.peak() < 1.5).map(error).fold(0.0, f64::max)
}

#[test]
fn a_bar_that_is_pulled_turns_where_energy_says() {
    let error = worst(|case, end| (pulled(case, end, 100.0), |u| u[0]));
    assert!(error < 1e-3, "{error}");
}

#[test]
fn hinges_turn_where_energy_says() {
    for on_bushing in [false, true] {
        let error = worst(|case, end| (turned(case, end, on_bushing), |u| u[1].atan2(1.0 + u[0])));
        assert!(error < 1e-3, "{on_bushing}: {error}");
    }
}

#[test]
fn a_bar_tears_if_it_stretches_that_far() {
    for case in cases() {
        for (share, tears) in [(0.7, true), (0.9, true), (0.99, true), (1.01, false)] {
            let result = simulate(&pulled(case, 1.3 * case.turns_at(), share * case.plastic())).unwrap();
            let torn = result.events.iter().any(|e| matches!(e.kind, EventKind::Fracture { .. }));
            assert_eq!(torn, tears, "{case:?} {share}");
        }
    }
}
