//! Models built in a few words.

use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::mbs::model::*;

pub const G: f64 = 9.81;
pub const DENSITY: f64 = 2500.0;
/// Member axis up, bending about x (axis 1) and y (axis 2).
pub const UP: [[f64; 3]; 3] = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

pub fn model(name: &str, end_time_s: f64, output_interval_s: f64) -> Model {
    Model::empty(name, [0.0, 0.0, -G], end_time_s, output_interval_s)
}

/// Inertia of a solid box.
pub fn box_inertia(mass: f64, size: [f64; 3]) -> [[f64; 3]; 3] {
    let s = size.map(|v| v * v * mass / 12.0);
    [[s[1] + s[2], 0.0, 0.0], [0.0, s[0] + s[2], 0.0], [0.0, 0.0, s[0] + s[1]]]
}

/// A solid concrete box with its contact shape.
pub fn solid(id: &str, center: [f64; 3], size: [f64; 3]) -> Body {
    let mass = DENSITY * size[0] * size[1] * size[2];
    Body {
        id: id.into(),
        mass_kg: mass,
        inertia_kg_m2: box_inertia(mass, size),
        position_m: center,
        orientation: [1.0, 0.0, 0.0, 0.0],
        velocity_m_s: [0.0; 3],
        angular_velocity_rad_s: [0.0; 3],
        shapes: vec![Shape::cuboid([0.0; 3], size.map(|v| 0.5 * v))],
        origin: Origin::default(),
    }
}

/// A joint with stiff translations and the given bending.
pub fn joint(
    id: &str,
    a: Option<&str>,
    b: &str,
    point: [f64; 3],
    translation: f64,
    torsion: f64,
    bending: [Bending; 2],
) -> Bushing {
    Bushing {
        axial_stiffness_n_m: translation,
        shear_stiffness_n_m: [translation; 2],
        torsional_stiffness_nm_rad: torsion,
        bending,
        ..Bushing::free(id.into(), a.map(Into::into), b.into(), point, UP)
    }
}

/// An ideal joint without an axis.
pub fn ideal(id: &str, kind: JointKind, a: Option<&str>, b: &str, point_m: [f64; 3]) -> Joint {
    Joint {
        id: id.into(),
        kind,
        body_a: a.map(str::to_string),
        body_b: b.into(),
        point_m,
        point_b_m: None,
        axis: None,
        axis_b: None,
        origin: Origin::default(),
    }
}

pub fn elastic(stiffness_nm_rad: f64) -> Bending {
    Bending::Elastic { stiffness_nm_rad }
}

pub fn hinge(curve: &str) -> Bending {
    Bending::Curve { curve: curve.into(), strength_factor: 1.0 }
}

pub fn track(model: &mut Model, body: &str, point: [f64; 3]) {
    model.tracked.push(TrackedPoint {
        id: format!("{body}{}", model.tracked.len()),
        body: body.into(),
        point_m: point,
    });
}

/// Elastic stiffness 2e7 N m/rad and a capacity that does not depend on the axial force.
pub fn curve(capacity: &[[f64; 2]], fracture: f64) -> ResistanceCurve {
    ResistanceCurve {
        stiffness_nm_rad: 2e7,
        levels: vec![CapacityLevel {
            axial_force_n: 0.0,
            capacity: capacity.to_vec(),
            fracture_rotation_rad: fracture,
        }],
        cyclic: None,
    }
}

/// The law of the frame tests: 120 kN m up to a rotation of 0.03, zero at 0.15.
pub fn frame_curve() -> ResistanceCurve {
    curve(&[[0.0, 120e3], [0.024, 120e3], [0.15, 0.0]], 0.5)
}

/// The step that a complaint about a given one tells \[s\].
pub fn step_told(said: &str) -> f64 {
    let (_, told) = said.split_once("give at most ").expect(said);
    told.split(' ').next().unwrap().parse().expect(said)
}

/// Time at which a sampled function first passes `level`, and its slope there (cubic through four points).
pub fn crossing(times: &[f64], values: &[f64], level: f64) -> (f64, f64) {
    let i = (1..values.len()).find(|i| values[*i] >= level).expect("the level is reached");
    let from = i.saturating_sub(2).min(values.len() - 4);
    let (t, v) = (&times[from..from + 4], &values[from..from + 4]);
    let value = |x: f64| -> f64 {
        (0..4)
            .map(|k| v[k] * (0..4).filter(|j| *j != k).map(|j| (x - t[j]) / (t[k] - t[j])).product::<f64>())
            .sum()
    };
    let (mut low, mut high) = (times[i - 1], times[i]);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if value(middle) < level { low = middle } else { high = middle }
    }
    let d = 1e-3 * (t[1] - t[0]);
    (low, (value(low + d) - value(low - d)) / (2.0 * d))
}
