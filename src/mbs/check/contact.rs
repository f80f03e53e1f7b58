//! Checks of shapes and of what may touch.

use super::{List, ORTHONORMAL_TOLERANCE};
use crate::mbs::math;
use crate::mbs::model::{CrushedFace, FaceRate, GROUND, Model, PairRule, Shape};
use std::collections::{BTreeMap, BTreeSet};

pub(super) fn check(model: &Model, known: &BTreeSet<&str>, list: &mut List) {
    let contact = &model.contact;
    let planes = contact.planes.iter().map(|p| p.id.as_str());
    let obstacles = contact.obstacles.iter().map(|o| o.id.as_str());
    one_name_each(model, list);
    if let Some(ground) = &contact.ground {
        list.finite("contact.ground.level_m", &[ground.level_m]);
        surface(ground.friction, ground.restitution, "contact.ground", list);
    }
    if let Some(bodies) = &contact.bodies {
        surface(bodies.friction, bodies.restitution, "contact.bodies", list);
    }
    for (i, plane) in contact.planes.iter().enumerate() {
        let path = format!("contact.planes[{i}]");
        surface(plane.friction, plane.restitution, &path, list);
        list.finite(&format!("{path}.point_m"), &plane.point_m);
        list.direction(&format!("{path}.normal"), plane.normal);
    }
    for (i, o) in contact.obstacles.iter().enumerate() {
        let path = format!("contact.obstacles[{i}]");
        surface(o.friction, o.restitution, &path, list);
        list.finite(&format!("{path}.min_m"), &o.min_m);
        list.finite(&format!("{path}.max_m"), &o.max_m);
        list.require((0..3).all(|k| o.max_m[k] > o.min_m[k]), &format!("{path}.max_m"), || {
            format!("is {:?}, expected above min_m {:?} in every direction", o.max_m, o.min_m)
        });
    }
    let partners: BTreeSet<&str> =
        known.iter().copied().chain(planes).chain(obstacles).chain([GROUND]).collect();
    for (i, pair) in contact.pairs.iter().enumerate() {
        let path = format!("contact.pairs[{i}]");
        list.known(known, &pair.a, &format!("{path}.a"));
        list.among(&partners, &pair.b, &format!("{path}.b"), "a body, plane or obstacle, or \"ground\"");
        list.require(pair.a != pair.b, &format!("{path}.b"), || {
            format!("is \"{}\", the same as a; expected two that can meet", pair.b)
        });
        list.require(pair.b != GROUND || contact.ground.is_some(), &format!("{path}.b"), || {
            "is \"ground\", but there is none: give contact.ground, or leave the rule out".into()
        });
        let is_idle = contact.bodies.is_none() && !pair.ignore && known.contains(pair.b.as_str());
        list.require(!is_idle, &format!("{path}.b"), || {
            format!(
                "is the body \"{}\", but bodies do not touch each other: give contact.bodies, or leave the rule out",
                pair.b
            )
        });
        // a later rule takes the place of an earlier one as a whole
        let again = |p: &PairRule| (&p.a, &p.b) == (&pair.a, &pair.b) || (&p.b, &p.a) == (&pair.a, &pair.b);
        let own = [pair.friction, pair.restitution, pair.rolling_m];
        let says = pair.ignore || own.iter().any(Option::is_some) || contact.pairs[..i].iter().any(again);
        list.require(says, &path, || {
            "changes nothing: give ignore, friction, restitution or rolling_m, or leave the rule out".into()
        });
        surface(pair.friction.unwrap_or(0.0), pair.restitution.unwrap_or(0.0), &path, list);
    }
    list.not_negative("contact.rolling_m", contact.rolling_m);
    for (i, pair) in contact.pairs.iter().enumerate() {
        list.not_negative(&format!("contact.pairs[{i}].rolling_m"), pair.rolling_m.unwrap_or(0.0));
    }
    list.require(!contact.resists_rolling() || !model.is_ideal(), "contact.rolling_m", || {
        "needs a model without ideal joints and forces: leave it out".into()
    });
    for (i, face) in contact.crushing.iter().enumerate() {
        let path = format!("contact.crushing[{i}]");
        list.known(known, &face.body, &format!("{path}.body"));
        list.require(!model.is_ideal(), &path, || {
            "needs a model without ideal joints and forces: leave it out".into()
        });
        crushing(model, face, &path, list);
        let again = contact.crushing[..i]
            .iter()
            .position(|f| (&f.body, f.shape, f.face) == (&face.body, face.shape, face.face));
        list.require(again.is_none(), &path, || {
            format!("names the same face as contact.crushing[{}]: a face has one curve", again.unwrap_or(0))
        });
    }
}

/// Whatever may be met has a name of its own: pairs, events and results tell bodies, planes, obstacles and the ground apart by nothing else. Bodies of the same name are told of where bodies are checked.
fn one_name_each(model: &Model, list: &mut List) {
    let contact = &model.contact;
    let mut taken: BTreeMap<&str, String> = BTreeMap::new();
    let of_bodies = model.bodies.iter().enumerate().map(|(i, b)| (format!("bodies[{i}]"), b.id.as_str()));
    let of_planes =
        contact.planes.iter().enumerate().map(|(i, p)| (format!("contact.planes[{i}]"), p.id.as_str()));
    let of_obstacles =
        contact.obstacles.iter().enumerate().map(|(i, o)| (format!("contact.obstacles[{i}]"), o.id.as_str()));
    for (path, id) in of_bodies.chain(of_planes).chain(of_obstacles) {
        let own = format!("{path}.id");
        if path.starts_with("contact") {
            list.named(&own, id);
        }
        list.require(id != GROUND, &own, || {
            format!("\"{id}\" is also the name of the ground: give it another id")
        });
        match taken.get(id).filter(|_| path.starts_with("contact")) {
            Some(first) => {
                list.add(own, format!("\"{id}\" is also the id of {first}: give one of them another id"))
            }
            None => {
                taken.insert(id, path);
            }
        }
    }
}

/// A face that is crushed: on a box, with a curve that starts at 0 with a force.
fn crushing(model: &Model, face: &CrushedFace, path: &str, list: &mut List) {
    if let Some(body) = model.bodies.iter().find(|b| b.id == face.body) {
        let shape = body.shapes.get(face.shape);
        list.require(shape.is_some_and(|s| s.half_extents_m().is_some()), &format!("{path}.shape"), || {
            let found = if shape.is_some() { "not a box" } else { "not there" };
            format!(
                "is {}, which is {found}; \"{}\" has {} shapes, numbered from 0, and faces of boxes can be crushed",
                face.shape,
                face.body,
                body.shapes.len()
            )
        });
    }
    if let Some(FaceRate { speed_m_s, exponent }) = &face.rate_factor {
        list.positive(&format!("{path}.rate_factor.speed_m_s"), *speed_m_s);
        list.rate_exponent(&format!("{path}.rate_factor.exponent"), *exponent);
    }
    let curve = &face.force_n;
    let path = format!("{path}.force_n");
    list.require(curve.first().is_some_and(|p| p[0] == 0.0 && p[1] > 0.0), &path, || {
        let found = curve.first().map_or("is empty".into(), |p| format!("starts with {p:?}"));
        format!("{found}, expected [0, a positive force] first: shortening [m], force [N]")
    });
    for (k, p) in curve.iter().enumerate() {
        list.finite(&format!("{path}[{k}]"), p);
        list.not_negative(&format!("{path}[{k}][1]"), p[1]);
        list.require(k == 0 || p[0] > curve[k - 1][0], &format!("{path}[{k}][0]"), || {
            format!("is {}, expected more than the shortening before it, {}", p[0], curve[k.max(1) - 1][0])
        });
    }
}

fn surface(friction: f64, restitution: f64, path: &str, list: &mut List) {
    list.not_negative(&format!("{path}.friction"), friction);
    list.require((0.0..=1.0).contains(&restitution), &format!("{path}.restitution"), || {
        format!("is {restitution}, expected 0 (nothing comes back) to 1 (all of the speed does)")
    });
}

pub(super) fn check_shape(shape: &Shape, path: &str, list: &mut List) {
    match shape {
        Shape::Box { center_m, half_extents_m, orientation } => {
            list.finite(&format!("{path}.center_m"), center_m);
            for (axis, half) in half_extents_m.iter().enumerate() {
                list.positive(&format!("{path}.half_extents_m[{axis}]"), *half);
            }
            if let Some(q) = orientation {
                let length = math::qnorm(*q);
                list.require(
                    (length - 1.0).abs() <= ORTHONORMAL_TOLERANCE,
                    &format!("{path}.orientation"),
                    || format!("has length {length}, expected a unit quaternion [w, x, y, z]"),
                );
            }
        }
        Shape::Sphere { center_m, radius_m } => {
            list.finite(&format!("{path}.center_m"), center_m);
            list.positive(&format!("{path}.radius_m"), *radius_m);
        }
        Shape::Hull { points_m } => {
            let before = list.len();
            for (i, p) in points_m.iter().enumerate() {
                list.finite(&format!("{path}.points_m[{i}]"), p);
            }
            list.require(list.len() > before || is_solid(points_m), &format!("{path}.points_m"), || {
                format!("has {} points that span no volume, expected at least four that do", points_m.len())
            });
        }
    }
}

/// Whether points span a volume: their spread across no direction is nothing beside the largest.
fn is_solid(points: &[[f64; 3]]) -> bool {
    let Some(first) = points.first() else { return false };
    let spread = |along: &dyn Fn([f64; 3]) -> [f64; 3]| {
        let rests = points.iter().map(|p| along(math::sub(*p, *first)));
        rests.fold([0.0; 3], |a: [f64; 3], v| if math::norm(v) > math::norm(a) { v } else { a })
    };
    let without = |v: [f64; 3], axis: [f64; 3]| {
        let square = math::dot(axis, axis).max(f64::MIN_POSITIVE);
        math::axpy(v, -math::dot(v, axis) / square, axis)
    };
    let a = spread(&|v| v);
    let b = spread(&|v| without(v, a));
    let c = spread(&|v| without(without(v, a), b));
    math::norm(c) > 1e-6 * math::norm(a) && math::norm(a) > 0.0
}
