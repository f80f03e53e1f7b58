//! Constraints, tendons, actuators and sensors.

use super::body::{Site, local, name};
use super::tree::{Tree, Via};
use super::{Sheet, attribute, vector};
use crate::export::number::plain;
use crate::export::{Notes, opening};
use crate::mbs::math::{V3, axpy, norm, scale, sub};
use crate::mbs::model::{Force, JointKind, Model};

/// The place that forces refer to.
const ORIGIN: &str = "origin";

fn index(model: &Model, id: Option<&str>) -> Option<usize> {
    id.and_then(|id| model.bodies.iter().position(|b| b.id == id))
}

/// All points that something refers to.
pub(super) fn sites(model: &Model) -> Vec<Site> {
    let mut all = Vec::new();
    let mut add = |name: String, body: Option<&str>, point: V3| {
        all.push(Site { name, body: index(model, body), point });
    };
    for joint in model.joints.iter().filter(|j| j.kind == JointKind::Rod) {
        add(format!("{}:a", joint.id), joint.body_a.as_deref(), joint.point_m);
        add(format!("{}:b", joint.id), Some(&joint.body_b), joint.point_b_m.unwrap_or(joint.point_m));
    }
    let mut applied = false;
    for force in &model.forces {
        match force {
            Force::Spring { id, body_a, body_b, point_a_m, point_b_m, .. } => {
                add(format!("{id}:from"), body_a.as_deref(), *point_a_m);
                add(format!("{id}:to"), Some(body_b), *point_b_m);
            }
            Force::Force { id, body, point_m, .. } => {
                applied = true;
                add(format!("{id}:at"), Some(body), *point_m);
            }
            Force::Torque { id, body, .. } => {
                applied = true;
                let centre = index(model, Some(body)).map_or([0.0; 3], |b| model.bodies[b].position_m);
                add(format!("{id}:at"), Some(body), centre);
            }
            _ => {}
        }
    }
    if applied {
        add(ORIGIN.into(), None, [0.0; 3]);
    }
    for point in &model.tracked {
        add(point.id.clone(), Some(&point.body), point.point_m);
    }
    all
}

/// Names what has no joint to sit on, or sits on one that is left to a program.
pub(super) fn note_unplaced(model: &Model, tree: &Tree, notes: &mut Notes) {
    for &f in &tree.unplaced {
        notes.add(model.forces[f].id(), "its bodies share no joint that turns about its axes");
    }
    for edge in tree.edges.iter().filter(|e| e.loose) {
        for &f in &edge.springs {
            notes.add(model.forces[f].id(), "left to the program that opens the joint");
        }
    }
    let opening = opening(model);
    for edge in tree.edges.iter().filter(|e| !e.loose) {
        if let Via::Joint(i) = edge.via
            && edge.springs.is_empty()
            && opening.contains(model.joints[i].id.as_str())
        {
            notes.add(&model.joints[i].id, "it does not open");
        }
    }
}

/// Constraints that close loops, hold copies and keep rods.
pub(super) fn equalities(sheet: &mut Sheet, model: &Model, tree: &Tree) {
    let rods: Vec<_> = model.joints.iter().filter(|j| j.kind == JointKind::Rod).collect();
    let copies: usize = tree.copies.iter().sum();
    if tree.loops.is_empty() && rods.is_empty() && copies == 0 {
        return;
    }
    sheet.open("<equality>");
    for &e in &tree.loops {
        closing(sheet, model, tree, e);
    }
    for (body, copies) in model.bodies.iter().zip(&tree.copies) {
        for copy in 1..=*copies {
            let [a, b] = [0, copy].map(|c| attribute(&name(body, c)));
            sheet.line(&format!("<weld body1={a} body2={b}/>"));
        }
    }
    for rod in rods {
        let id = attribute(&rod.id);
        sheet.line(&format!("<tendon name={id} tendon1={id}/>"));
    }
    sheet.close("</equality>");
}

fn closing(sheet: &mut Sheet, model: &Model, tree: &Tree, e: usize) {
    let edge = &tree.edges[e];
    let (Via::Joint(i), [a, Some(b)]) = (edge.via, edge.bodies) else { return };
    let joint = &model.joints[i];
    let second = a.map_or(String::new(), |a| format!(" body2={}", attribute(&name(&model.bodies[a], 0))));
    let bodies = format!("body1={}{second}", attribute(&name(&model.bodies[b], 0)));
    let mut connect = |id: String, point: V3| {
        let anchor = vector(&local(model, Some(b), point));
        sheet.line(&format!("<connect name={} {bodies} anchor={anchor}/>", attribute(&id)));
    };
    match joint.kind {
        JointKind::Spherical => connect(joint.id.clone(), joint.point_m),
        JointKind::Revolute => {
            // two points of the axis, as far apart as the second body is large
            let body = &model.bodies[b];
            let inertia = &body.inertia_kg_m2;
            let radius = ((inertia[0][0] + inertia[1][1] + inertia[2][2]) / (2.0 * body.mass_kg)).sqrt();
            let axis = joint.axis.unwrap_or([0.0, 0.0, 1.0]);
            let unit = scale(1.0 / norm(axis), axis);
            connect(format!("{}:1", joint.id), axpy(joint.point_m, -radius, unit));
            connect(format!("{}:2", joint.id), axpy(joint.point_m, radius, unit));
        }
        _ => sheet.line(&format!("<weld name={} {bodies}/>", attribute(&joint.id))),
    }
}

/// Rods and springs.
pub(super) fn tendons(sheet: &mut Sheet, model: &Model) {
    let rods = model.joints.iter().filter(|j| j.kind == JointKind::Rod);
    let mut lines: Vec<(String, [String; 2])> =
        rods.map(|r| (attribute(&r.id), ["a", "b"].map(|end| format!("{}:{end}", r.id)))).collect();
    for force in &model.forces {
        if let Force::Spring { id, point_a_m, point_b_m, length_m, stiffness_n_m, damping_n_s_m, .. } = force
        {
            let length = length_m.unwrap_or(norm(sub(*point_b_m, *point_a_m)));
            let law = format!(
                " springlength=\"{}\" stiffness=\"{}\" damping=\"{}\"",
                plain(length),
                plain(*stiffness_n_m),
                plain(*damping_n_s_m)
            );
            let name = attribute(&format!("{id}:spring"));
            lines.push((name + &law, ["from", "to"].map(|end| format!("{id}:{end}"))));
        }
    }
    if lines.is_empty() {
        return;
    }
    sheet.open("<tendon>");
    for (name, ends) in lines {
        sheet.open(&format!("<spatial name={name}>"));
        ends.iter().for_each(|end| sheet.line(&format!("<site site={}/>", attribute(end))));
        sheet.close("</spatial>");
    }
    sheet.close("</tendon>");
}

/// Forces and torques, constant along the axes of the ground.
pub(super) fn actuators(sheet: &mut Sheet, model: &Model, notes: &mut Notes) {
    let mut lines = Vec::new();
    for force in &model.forces {
        let (id, load, span) = match force {
            Force::Force { id, force_n, from_to_s, .. } => (id, [*force_n, [0.0; 3]].concat(), from_to_s),
            Force::Torque { id, torque_nm, from_to_s, .. } => {
                (id, [[0.0; 3], *torque_nm].concat(), from_to_s)
            }
            _ => continue,
        };
        if let Some([from, to]) = span
            && (*from > 0.0 || *to < model.settings.end_time_s)
        {
            notes.add(id, format!("it acts from {} to {} s only", plain(*from), plain(*to)));
            continue;
        }
        lines.push(format!(
            "<general name={} site={} refsite=\"{ORIGIN}\" gear={} gaintype=\"fixed\" gainprm=\"0\" biastype=\"affine\" biasprm=\"1 0 0\"/>",
            attribute(id),
            attribute(&format!("{id}:at")),
            vector(&load)
        ));
    }
    if !lines.is_empty() {
        sheet.open("<actuator>");
        lines.iter().for_each(|l| sheet.line(l));
        sheet.close("</actuator>");
    }
}

/// Positions of the tracked points.
pub(super) fn sensors(sheet: &mut Sheet, model: &Model) {
    if model.tracked.is_empty() {
        return;
    }
    sheet.open("<sensor>");
    for point in &model.tracked {
        let id = attribute(&point.id);
        sheet.line(&format!("<framepos name={id} objtype=\"site\" objname={id}/>"));
    }
    sheet.close("</sensor>");
}
