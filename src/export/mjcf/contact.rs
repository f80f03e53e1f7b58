//! Shapes, surfaces and who may touch.
//!
//! Surfaces that do not move are bodies of their own without joints; their friction has priority over that of moving bodies.

use super::{Sheet, attribute, vector};
use crate::export::Notes;
use crate::export::number::plain;
use crate::mbs::math::{V3, mat_to_q, norm, scale, transpose};
use crate::mbs::model::{Body, Model, PairRule, Shape};
use std::collections::BTreeSet;

/// Name of the body of a surface.
fn surface(id: &str) -> String {
    format!("surface {id}")
}

/// Name of a shape of a body.
fn shape_name(body: &str, index: usize) -> String {
    format!("{body} {}", index + 1)
}

/// Geoms of a moving body.
pub(super) fn shapes(sheet: &mut Sheet, model: &Model, body: &Body) {
    let bodies = model.contact.bodies.as_ref();
    let kind = u8::from(bodies.is_some());
    let friction = plain(bodies.map_or(0.0, |b| b.friction));
    for (i, shape) in body.shapes.iter().enumerate() {
        let form = match shape {
            Shape::Box { center_m, half_extents_m, orientation } => {
                let turn = orientation.map_or(String::new(), |q| format!(" quat={}", vector(&q)));
                format!("type=\"box\" size={} pos={}{turn}", vector(half_extents_m), vector(center_m))
            }
            Shape::Sphere { center_m, radius_m } => {
                format!("type=\"sphere\" size=\"{}\" pos={}", plain(*radius_m), vector(center_m))
            }
            Shape::Hull { .. } => format!("type=\"mesh\" mesh={}", attribute(&shape_name(&body.id, i))),
        };
        sheet.line(&format!(
            "<geom name={} {form} contype=\"{kind}\" conaffinity=\"1\" friction=\"{friction} 0 0\"/>",
            attribute(&shape_name(&body.id, i))
        ));
    }
}

/// Hulls, as meshes whose points stay where they are.
pub(super) fn meshes(sheet: &mut Sheet, model: &Model) {
    let hulls = |b: &'_ Body| b.shapes.iter().any(|s| matches!(s, Shape::Hull { .. }));
    if !model.bodies.iter().any(hulls) {
        return;
    }
    sheet.open("<asset>");
    for body in &model.bodies {
        for (i, shape) in body.shapes.iter().enumerate() {
            if let Shape::Hull { points_m } = shape {
                let name = attribute(&shape_name(&body.id, i));
                sheet.line(&format!("<mesh name={name} vertex={}/>", vector(&points_m.concat())));
            }
        }
    }
    sheet.close("</asset>");
}

/// Ground, planes and obstacles.
pub(super) fn surfaces(sheet: &mut Sheet, model: &Model) {
    let plane = |sheet: &mut Sheet, id: &str, point: V3, normal: V3, friction: f64| {
        let frame = crate::mbs::ideal::joint::frame_about(normal);
        // columns x, y, z with z along the normal
        let q = mat_to_q(&transpose(&[frame[1], frame[2], scale(1.0 / norm(normal), normal)]));
        let form = format!("type=\"plane\" size=\"0 0 1\" quat={}", vector(&q));
        fixed(sheet, id, point, &form, friction);
    };
    if let Some(ground) = &model.contact.ground {
        plane(sheet, "ground", [0.0, 0.0, ground.level_m], [0.0, 0.0, 1.0], ground.friction);
    }
    for p in &model.contact.planes {
        plane(sheet, &p.id, p.point_m, p.normal, p.friction);
    }
    for o in &model.contact.obstacles {
        let half: V3 = std::array::from_fn(|k| 0.5 * (o.max_m[k] - o.min_m[k]));
        let centre: V3 = std::array::from_fn(|k| 0.5 * (o.max_m[k] + o.min_m[k]));
        fixed(sheet, &o.id, centre, &format!("type=\"box\" size={}", vector(&half)), o.friction);
    }
}

fn fixed(sheet: &mut Sheet, id: &str, place: V3, form: &str, friction: f64) {
    let name = attribute(&surface(id));
    sheet.open(&format!("<body name={name} pos={}>", vector(&place)));
    sheet.line(&format!(
        "<geom name={name} {form} contype=\"1\" conaffinity=\"0\" priority=\"1\" friction=\"{} 0 0\"/>",
        plain(friction)
    ));
    sheet.close("</body>");
}

/// Pairs that pass through each other, and pairs with a friction of their own.
pub(super) fn pairs(sheet: &mut Sheet, model: &Model, notes: &mut Notes) {
    let mut excluded = joined(model);
    let mut own: Vec<(&PairRule, f64)> = Vec::new();
    for rule in &model.contact.pairs {
        let pair = ordered(&rule.a, &partner(model, &rule.b));
        own.retain(|(r, _)| ordered(&r.a, &partner(model, &r.b)) != pair);
        if rule.ignore {
            excluded.insert(pair);
        } else {
            excluded.remove(&pair);
            own.extend(rule.friction.map(|f| (rule, f)));
        }
    }
    restitution(model, notes);
    if excluded.is_empty() && own.is_empty() {
        return;
    }
    sheet.open("<contact>");
    for (a, b) in &excluded {
        sheet.line(&format!("<exclude body1={} body2={}/>", attribute(a), attribute(b)));
    }
    for (rule, friction) in own {
        for a in geoms(model, &rule.a) {
            for b in geoms(model, &rule.b) {
                let f = plain(friction);
                let ends = format!("geom1={} geom2={}", attribute(&a), attribute(&b));
                sheet.line(&format!("<pair {ends} condim=\"3\" friction=\"{f} {f} 0 0 0\"/>"));
            }
        }
    }
    sheet.close("</contact>");
}

fn ordered(a: &str, b: &str) -> (String, String) {
    let (a, b) = if a <= b { (a, b) } else { (b, a) };
    (a.into(), b.into())
}

/// Name of the body of a partner in a rule.
fn partner(model: &Model, id: &str) -> String {
    if model.bodies.iter().any(|b| b.id == id) { id.into() } else { surface(id) }
}

fn geoms(model: &Model, id: &str) -> Vec<String> {
    match model.bodies.iter().find(|b| b.id == id) {
        Some(body) => (0..body.shapes.len()).map(|i| shape_name(id, i)).collect(),
        None => vec![surface(id)],
    }
}

/// Bodies that a joint or bushing keeps from touching each other or the ground.
fn joined(model: &Model) -> BTreeSet<(String, String)> {
    let joints = model.joints.iter().map(|j| (j.body_a.as_deref(), j.body_b.as_str()));
    let bushings = model.bushings.iter().map(|j| (j.body_a.as_deref(), j.body_b.as_str()));
    let touching = model.contact.bodies.is_some();
    joints
        .chain(bushings)
        .filter_map(|(a, b)| match a {
            Some(a) => touching.then(|| ordered(a, b)),
            None => model.contact.ground.as_ref().map(|_| ordered(b, &surface("ground"))),
        })
        .collect()
}

fn restitution(model: &Model, notes: &mut Notes) {
    let c = &model.contact;
    let mut all: Vec<(&str, f64)> = Vec::new();
    all.extend(c.ground.as_ref().map(|g| ("contact.ground", g.restitution)));
    all.extend(c.planes.iter().map(|p| (p.id.as_str(), p.restitution)));
    all.extend(c.obstacles.iter().map(|o| (o.id.as_str(), o.restitution)));
    all.extend(c.bodies.as_ref().map(|b| ("contact.bodies", b.restitution)));
    all.extend(c.pairs.iter().filter_map(|p| p.restitution.map(|r| (p.a.as_str(), r))));
    for (id, e) in all.into_iter().filter(|(_, e)| *e > 0.0) {
        notes.add(
            id,
            format!("the coefficient of restitution {} is left out: impacts are inelastic", plain(e)),
        );
    }
}
