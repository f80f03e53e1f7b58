//! The model's own JSON, normalised: every key written, quaternions and axes of unit length, inertia tensors symmetric to the last digit.

use crate::mbs::Model;
use crate::mbs::math::{V3, norm, qnorm, qunit, scale};
use crate::mbs::model::{Force, Shape};

/// The text of a model.
///
/// # Errors
/// In words, if a number is not finite.
pub fn write(model: &Model) -> Result<String, String> {
    serde_json::to_string_pretty(&normalised(model)).map(|text| text + "\n").map_err(|e| e.to_string())
}

/// The same model with unit quaternions and axes and symmetric inertia.
pub fn normalised(model: &Model) -> Model {
    let mut m = model.clone();
    for body in &mut m.bodies {
        unit_quaternion(&mut body.orientation);
        let own = body.inertia_kg_m2;
        for i in 0..3 {
            for j in 0..3 {
                body.inertia_kg_m2[i][j] = 0.5 * (own[i][j] + own[j][i]);
            }
        }
        for shape in &mut body.shapes {
            if let Shape::Box { orientation: Some(q), .. } = shape {
                unit_quaternion(q);
            }
        }
    }
    for joint in &mut m.joints {
        joint.axis = joint.axis.map(unit);
        joint.axis_b = joint.axis_b.map(unit);
    }
    for force in &mut m.forces {
        if let Force::Torsion { axis, .. } = force {
            *axis = unit(*axis);
        }
    }
    for plane in &mut m.contact.planes {
        plane.normal = unit(plane.normal);
    }
    m
}

/// Of unit length; a vector that has it but for the last digit stays as it is, so that a second time changes nothing.
fn unit(v: V3) -> V3 {
    let length = norm(v);
    if (length - 1.0).abs() <= 4.0 * f64::EPSILON { v } else { scale(1.0 / length, v) }
}

fn unit_quaternion(q: &mut [f64; 4]) {
    if (qnorm(*q) - 1.0).abs() > 4.0 * f64::EPSILON {
        *q = qunit(*q);
    }
}
