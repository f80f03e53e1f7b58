//! From a model file to a mechanism.

use super::bushing::Given;
use super::force::Force;
use super::hinge_law::HingeLaw;
use super::joint::{Joint, Kind, frame_about};
use super::{Body, GROUND, Mechanism};
use crate::mbs::math::{V3, axpy, cross, dot, norm, qunit, scale, sub};
use crate::mbs::model::{self, Bending, JointKind, Model};
use std::collections::BTreeMap;

/// The mechanism of a checked model: bodies, joints and forces in the order of the file.
pub fn mechanism(model: &Model) -> Mechanism {
    let index: BTreeMap<&str, usize> =
        model.bodies.iter().enumerate().map(|(i, b)| (b.id.as_str(), i)).collect();
    let place = |id: Option<&str>| id.and_then(|id| index.get(id).copied()).unwrap_or(GROUND);
    let joints: BTreeMap<&str, usize> =
        model.joints.iter().enumerate().map(|(i, j)| (j.id.as_str(), i)).collect();
    let mut laws = Vec::new();
    let forces = model.forces.iter().map(|f| force(f, &place, &joints, &mut laws)).collect();
    Mechanism {
        bodies: model.bodies.iter().map(body).collect(),
        joints: model.joints.iter().map(|j| joint(j, &place)).collect(),
        forces,
        laws,
        bushings: model.bushings.iter().map(|b| bushing(model, b, &place, &joints)).collect(),
        gravity_m_s2: model.gravity_m_s2,
    }
}

fn bushing(
    model: &Model,
    bushing: &model::Bushing,
    place: &dyn Fn(Option<&str>) -> usize,
    joints: &BTreeMap<&str, usize>,
) -> Given {
    let curve = |k: usize| match &bushing.bending[k] {
        Bending::Curve { curve, .. } => model.curves.get(curve).cloned(),
        Bending::Elastic { .. } => None,
    };
    Given {
        bodies: [place(bushing.body_a.as_deref()), place(Some(&bushing.body_b))],
        joint: bushing.joint.as_deref().and_then(|id| joints.get(id).copied()),
        curves: [curve(0), curve(1)],
        bushing: bushing.clone(),
    }
}

fn body(body: &model::Body) -> Body {
    let m = &body.inertia_kg_m2;
    Body {
        mass_kg: body.mass_kg,
        inertia_kg_m2: std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (m[i][j] + m[j][i]))),
        position_m: body.position_m,
        orientation: qunit(body.orientation),
        velocity_m_s: body.velocity_m_s,
        angular_velocity_rad_s: body.angular_velocity_rad_s,
    }
}

fn joint(joint: &model::Joint, place: &dyn Fn(Option<&str>) -> usize) -> Joint {
    let kind = match joint.kind {
        JointKind::Spherical => Kind::Spherical,
        JointKind::Revolute => Kind::Revolute,
        JointKind::Universal => Kind::Universal,
        JointKind::Cylindrical => Kind::Cylindrical,
        JointKind::Prismatic => Kind::Prismatic,
        JointKind::Fixed => Kind::Fixed,
        JointKind::Planar => Kind::Planar,
        JointKind::PointOnLine => Kind::PointOnLine,
        JointKind::Rod => Kind::Distance,
    };
    let axis = joint.axis.unwrap_or([1.0, 0.0, 0.0]);
    let mut axes = frame_about(axis);
    if let Some(second) = joint.axis_b {
        let across = across(second, axes[0]);
        axes = [axes[0], across, cross(axes[0], across)];
    }
    Joint {
        kind,
        bodies: [place(joint.body_a.as_deref()), place(Some(&joint.body_b))],
        points_m: [joint.point_m, joint.point_b_m.unwrap_or(joint.point_m)],
        axes,
    }
}

/// The part of a vector across a unit vector, of unit length.
fn across(v: V3, axis: V3) -> V3 {
    let rest = axpy(v, -dot(v, axis), axis);
    scale(1.0 / norm(rest), rest)
}

fn force(
    force: &model::Force,
    place: &dyn Fn(Option<&str>) -> usize,
    joints: &BTreeMap<&str, usize>,
    laws: &mut Vec<HingeLaw>,
) -> Force {
    match force {
        model::Force::Spring {
            body_a,
            body_b,
            point_a_m,
            point_b_m,
            length_m,
            stiffness_n_m,
            damping_n_s_m,
            ..
        } => Force::Spring {
            bodies: [place(body_a.as_deref()), place(Some(body_b))],
            points_m: [*point_a_m, *point_b_m],
            length_m: length_m.unwrap_or_else(|| norm(sub(*point_b_m, *point_a_m))),
            stiffness_n_m: *stiffness_n_m,
            damping_n_s_m: *damping_n_s_m,
        },
        model::Force::Torsion { body_a, body_b, axis, stiffness_nm_rad, damping_nm_s_rad, .. } => {
            Force::Torsion {
                bodies: [place(body_a.as_deref()), place(Some(body_b))],
                axis: *axis,
                stiffness_nm_rad: *stiffness_nm_rad,
                damping_nm_s_rad: *damping_nm_s_rad,
            }
        }
        model::Force::Hinge { body_a, body_b, stiffness_nm_rad, capacity, fracture_rad, joint, .. } => {
            let law = HingeLaw {
                stiffness_nm_rad: *stiffness_nm_rad,
                capacity: capacity.clone(),
                fracture_rad: fracture_rad.unwrap_or(f64::INFINITY),
            };
            let known = laws.iter().position(|l| *l == law);
            let law = known.unwrap_or_else(|| {
                laws.push(law);
                laws.len() - 1
            });
            Force::Hinge {
                bodies: [place(body_a.as_deref()), place(Some(body_b))],
                law,
                joint: joint.as_deref().and_then(|id| joints.get(id).copied()),
            }
        }
        model::Force::Force { body, point_m, force_n, .. } => {
            Force::Force { body: place(Some(body)), point_m: *point_m, force_n: *force_n }
        }
        model::Force::Torque { body, torque_nm, .. } => {
            Force::Torque { body: place(Some(body)), torque_nm: *torque_nm }
        }
    }
}
