//! Parts of a mechanism that move in a plane: there the rows of joints across the plane have nothing to hold, and are left out.
//!
//! A part is what joints connect, the ground aside. It moves in a plane if all of its joints are revolutes about one direction (or rods across it), which is a principal axis of each
//! body; gravity, velocities and forces have no part along it, angular velocities and torques none across it; and it is flat: the centres of mass, and the points that rods, springs and
//! forces act at, lie in one plane. A force beside a centre turns the body out of the plane, and the rows that would be left out are what holds it.

use super::force::Force;
use super::joint::{Joint, Kind, is_ground};
use super::{Body, Mechanism};
use crate::mbs::math::{V3, axpy, dot, mul, mul_t, norm, qmat, sub};
use petgraph::unionfind::UnionFind;

/// What counts as nothing, relative.
const NOTHING: f64 = 1e-12;

/// The normal of the plane of each body's part; `None` for those that move in space.
pub fn planes(mechanism: &Mechanism) -> Vec<Option<V3>> {
    let parts = parts(mechanism);
    let count = parts.iter().max().map_or(0, |p| p + 1);
    let normals: Vec<Option<V3>> = (0..count).map(|part| normal(mechanism, &parts, part)).collect();
    parts.iter().map(|part| normals[*part]).collect()
}

/// The part of each body: bodies that joints or forces connect.
fn parts(mechanism: &Mechanism) -> Vec<usize> {
    let bushings = mechanism.bushings.iter().map(|b| b.bodies);
    let links =
        mechanism.joints.iter().map(|j| j.bodies).chain(mechanism.forces.iter().filter_map(|f| match f {
            Force::Spring { bodies, .. } | Force::Torsion { bodies, .. } | Force::Hinge { bodies, .. } => {
                Some(*bodies)
            }
            Force::Torque { .. } | Force::Force { .. } => None,
        }));
    let links = links.chain(bushings);
    let mut parts = UnionFind::new(mechanism.bodies.len());
    for [a, b] in links.filter(|l| !l.iter().any(|b| is_ground(*b))) {
        parts.union(a, b);
    }
    parts.into_labeling()
}

fn normal(mechanism: &Mechanism, parts: &[usize], part: usize) -> Option<V3> {
    let own = |b: &usize| !is_ground(*b) && parts[*b] == part;
    let joints = || mechanism.joints.iter().filter(|j| j.bodies.iter().any(own));
    let n = joints().find(|j| j.kind == Kind::Revolute)?.axes[0];
    let along = |v: V3| dot(v, n).abs() <= NOTHING * norm(v).max(NOTHING);
    let only = |v: V3| norm(axpy(v, -dot(v, n), n)) <= NOTHING * norm(v).max(NOTHING);
    let center = mechanism.bodies[(0..mechanism.bodies.len()).find(own)?].position_m;
    let is_flat = |p: &V3| along(sub(*p, center));
    let of_joint = |j: &Joint| match j.kind {
        Kind::Revolute => only(j.axes[0]),
        Kind::Distance => j.points_m.iter().all(is_flat),
        _ => false,
    };
    let of_body = |b: &Body| {
        let r = qmat(b.orientation);
        let moment = mul(&r, mul(&b.inertia_kg_m2, mul_t(&r, n)));
        is_flat(&b.position_m) && along(b.velocity_m_s) && only(b.angular_velocity_rad_s) && only(moment)
    };
    let of_force = |f: &Force| match f {
        Force::Spring { bodies, points_m, .. } => !bodies.iter().any(own) || points_m.iter().all(is_flat),
        Force::Torsion { bodies, axis, .. } => !bodies.iter().any(own) || only(*axis),
        Force::Torque { body, torque_nm } => !own(body) || only(*torque_nm),
        Force::Force { body, point_m, force_n } => !own(body) || along(*force_n) && is_flat(point_m),
        Force::Hinge { bodies, .. } => !bodies.iter().any(own),
    };
    let bodies = (0..mechanism.bodies.len()).filter(|b| own(b)).map(|b| &mechanism.bodies[b]);
    let holds = along(mechanism.gravity_m_s2)
        && joints().all(of_joint)
        && bodies.into_iter().all(of_body)
        && mechanism.forces.iter().all(of_force);
    let holds = holds && !mechanism.bushings.iter().any(|b| b.bodies.iter().any(own));
    holds.then_some(n)
}

#[cfg(test)]
mod tests {
    use super::super::GROUND;
    use super::*;

    fn pendulum(axis: V3) -> Mechanism {
        let body = Body::at_rest(1.0, [0.1, 0.2, 0.3], [0.5, 0.0, 0.0]);
        Mechanism {
            bodies: vec![body],
            joints: vec![Joint::at(Kind::Revolute, [GROUND, 0], [0.0; 3], axis)],
            gravity_m_s2: [0.0, 0.0, -9.81],
            ..Mechanism::default()
        }
    }

    #[test]
    fn what_leaves_the_plane_is_seen() {
        let y = [0.0, 1.0, 0.0];
        assert_eq!(planes(&pendulum(y)), [Some(y)]);
        assert_eq!(planes(&pendulum([0.0, 0.6, 0.8])), [None], "gravity");
        let mut moving = pendulum(y);
        moving.bodies[0].velocity_m_s = [0.0, 1e-6, 0.0];
        assert_eq!(planes(&moving), [None]);
        let mut skew = pendulum(y);
        skew.bodies[0].inertia_kg_m2[0][1] = 0.01;
        skew.bodies[0].inertia_kg_m2[1][0] = 0.01;
        assert_eq!(planes(&skew), [None]);
        let mut ball = pendulum(y);
        ball.joints.push(Joint::at(Kind::Spherical, [GROUND, 0], [0.0; 3], y));
        assert_eq!(planes(&ball), [None]);
    }

    /// A pendulum with a second body at a height above its plane, which a joint, rod or spring connects.
    fn pair(second_m: V3, link: impl FnOnce(&mut Mechanism)) -> bool {
        let y = [0.0, 1.0, 0.0];
        let mut pair = pendulum(y);
        pair.bodies.push(Body::at_rest(1.0, [0.1, 0.2, 0.3], second_m));
        link(&mut pair);
        planes(&pair)[0] == Some(y)
    }

    #[test]
    fn what_lies_beside_the_plane_is_seen() {
        let y = [0.0, 1.0, 0.0];
        let hinge = |m: &mut Mechanism| {
            m.joints.push(Joint::at(Kind::Revolute, [0, 1], [1.0, 0.3, 0.0], y));
        };
        // joints hold their bodies wherever their points are along the axis
        assert!(pair([1.5, 0.0, 0.0], hinge));
        assert!(!pair([1.5, 0.1, 0.0], hinge));
        let at = |height: f64| [[0.5, height, 0.0], [1.5, height, 0.0]];
        let rod = |height: f64| move |m: &mut Mechanism| m.joints.push(Joint::rod([0, 1], at(height)));
        assert!(pair([1.5, 0.0, 0.0], rod(0.0)));
        assert!(!pair([1.5, 0.0, 0.0], rod(0.1)));
        assert!(!pair([1.5, 0.1, 0.0], rod(0.1)));
        let spring = |height: f64| {
            move |m: &mut Mechanism| {
                m.forces.push(Force::Spring {
                    bodies: [0, GROUND],
                    points_m: at(height),
                    length_m: 1.0,
                    stiffness_n_m: 1e3,
                    damping_n_s_m: 0.0,
                });
            }
        };
        // the second body is a part of its own here
        assert!(pair([1.5, 0.1, 0.0], spring(0.0)));
        assert!(!pair([1.5, 0.0, 0.0], spring(0.01)));
    }
}
