//! Contact of tied nodes and of what starts in the ground; the error of a contact that cannot hold.

use super::mesh::{elastic, grid, ground};
use fallwerk::base::geom::Aabb;
use fallwerk::fe::apart::{Faces, outer_faces};
use fallwerk::fe::contact::{BodyContact, RigidSurfaces};
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::model::{ContactSettings, Control, Curve, DrivenNode, Model};
use fallwerk::fe::model_run::{ModelOptions, run_model};

const GRAVITY: f64 = 9.81;

/// Adds a box of elements as a part of its own; returns its first node.
fn add(mesh: &mut Mesh, counts: [usize; 3], size_m: [f64; 3], corner_m: [f64; 3]) -> usize {
    let one = grid(counts, size_m, elastic(), |_| false);
    let (first, part) = (mesh.nodes.len(), mesh.parts.len());
    mesh.nodes.extend(one.nodes.iter().map(|p| -> [f64; 3] { std::array::from_fn(|i| p[i] + corner_m[i]) }));
    for mut element in one.elements {
        element.nodes = element.nodes.map(|n| n + first);
        element.part = part;
        mesh.elements.push(element);
    }
    mesh.parts.push(format!("brick {part}"));
    first
}

/// Two half blocks along x, the second finer and tied to the first; the tied nodes with a master's part in no corner of the first.
fn tied_block() -> (Mesh, Vec<usize>) {
    let mut mesh = Mesh { laws: vec![elastic()], ..Mesh::default() };
    add(&mut mesh, [2, 1, 1], [0.5, 0.5, 0.5], [0.0; 3]);
    let faces = Faces::of(&mesh, outer_faces(&mesh));
    let first = add(&mut mesh, [2, 2, 2], [0.5, 0.5, 0.5], [0.5, 0.0, 0.0]);
    let tied: Vec<usize> = (first..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == 0.5).collect();
    for node in &tied {
        let tie = faces.nearest(&mesh, *node, 1e-6, false).expect("it lies on a face");
        mesh.ties.push(tie);
    }
    (mesh, tied)
}

fn balance(body: &Dynamics, kinetic: f64, start: f64) -> f64 {
    let stored: f64 = body.blocks.energies_j().iter().sum();
    kinetic + stored - start - body.gravity_j - body.contact_j[0] - body.contact_j[1] - body.driven_j
}

/// The block comes down on a rigid post under one tied node, away from all masters: it is the tied node that must stop it.
#[test]
fn tied_node_strikes_a_rigid_surface_through_its_masters() {
    let (mesh, tied) = tied_block();
    let middle = *tied.iter().find(|n| mesh.nodes[**n][1] == 0.25 && mesh.nodes[**n][2] == 0.0).unwrap();
    let mut surfaces = ground(-0.5, 0.5);
    let post = Aabb { min: [0.4, 0.2, -1.0], max: [0.6, 0.3, -0.01] };
    surfaces.boxes.push((post, 0.3));
    for with_body in [false, true] {
        let mut body = Dynamics::new(&mesh, GRAVITY, surfaces.clone(), false);
        if with_body {
            body.body_contact = Some(Box::new(BodyContact::new(&mesh, ContactSettings::default())));
        }
        body.v.iter_mut().for_each(|v| v[2] = -2.0);
        let start = body.kinetic_j();
        let mut worst = 0.0_f64;
        while body.time_s < 0.05 {
            let kinetic = body.step(true);
            assert!(body.x[middle][2] > -0.01 - 1e-9, "{:?} at {} s", body.x[middle], body.time_s);
            worst = worst.max(balance(&body, kinetic, start).abs());
        }
        assert_eq!(body.surfaces.new_touches, [(middle, 1)]);
        assert!(worst < 0.01 * start, "{worst} of {start} J");
        assert!(body.contact_j[0] < -0.01 * start, "{:?} of {start} J", body.contact_j);
        let speed = body.v.iter().zip(&body.mass_kg).map(|(v, m)| v[2] * m).sum::<f64>();
        assert!(speed > -body.mass_kg.iter().sum::<f64>(), "it was stopped: {speed} kg m/s");
    }
}

/// The block comes down on a post of elements under the face of an element with tied corners; no corner of the block is over the post.
#[test]
fn face_with_tied_corners_meets_another_body() {
    let (mut mesh, _) = tied_block();
    let own = mesh.nodes.len();
    let first = add(&mut mesh, [1, 1, 4], [0.1, 0.1, 0.6], [0.55, 0.05, -0.61]);
    mesh.fixed = (first..mesh.nodes.len()).filter(|n| mesh.nodes[*n][2] < -0.6).collect();
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.body_contact = Some(Box::new(BodyContact::new(&mesh, ContactSettings::default())));
    (0..own).for_each(|n| body.v[n][2] = -2.0);
    let start = body.kinetic_j();
    let (mut worst, mut deepest) = (0.0_f64, 0.0_f64);
    let top: Vec<usize> = (first..mesh.nodes.len()).filter(|n| mesh.nodes[*n][2] > -0.02).collect();
    let corner = |b: &Dynamics, at: [f64; 3]| {
        b.x[(own / 2..own).chain(0..own / 2).find(|n| mesh.nodes[*n] == at).unwrap()][2]
    };
    while body.time_s < 0.02 {
        let kinetic = body.step(true);
        worst = worst.max(balance(&body, kinetic, start).abs());
        // the face of the block over the post, as a plane through three corners
        let [a, b, c] = [[0.5, 0.0, 0.0], [0.75, 0.0, 0.0], [0.5, 0.25, 0.0]].map(|at| corner(&body, at));
        for n in &top {
            let (s, t) = ((mesh.nodes[*n][0] - 0.5) / 0.25, mesh.nodes[*n][1] / 0.25);
            deepest = deepest.max(body.x[*n][2] - (a + s * (b - a) + t * (c - a)));
        }
    }
    let summary = body.body_contact.as_ref().unwrap().summary().clone();
    assert!(summary.most_contacts >= 4, "{summary:?}");
    assert!(deepest < 2e-3, "{deepest} m inside");
    assert!(worst < 0.01 * start, "{worst} of {start} J");
    let momentum: f64 = (0..own).map(|n| body.mass_kg[n] * body.v[n][2]).sum();
    let before = -2.0 * (0..own).map(|n| body.mass_kg[n]).sum::<f64>();
    assert!(momentum > 0.9 * before, "{momentum} of {before} kg m/s");
}

/// The two parts of a tied block at rest do not touch each other.
#[test]
fn tied_faces_are_no_contact() {
    let (mesh, _) = tied_block();
    let mut body = Dynamics::new(&mesh, GRAVITY, ground(0.0, 0.5), false);
    body.body_contact = Some(Box::new(BodyContact::new(&mesh, ContactSettings::default())));
    (0..400).for_each(|_| {
        body.step(false);
    });
    let summary = body.body_contact.as_ref().unwrap().summary();
    assert_eq!((summary.most_pairs, summary.most_contacts), (0, 0), "{summary:?}");
    assert!(body.surfaces.new_touches.is_empty(), "what stands on the ground at the start is no news");
}

/// A footing in the ground: it settles under its weight as without ground, and touches nothing; cut loose, it stays on the bottom of its
/// excavation.
#[test]
fn what_starts_below_the_ground_is_not_held_by_it() {
    let run = |level: f64, held: bool| {
        let mut mesh = grid([2, 2, 6], [0.4, 0.4, 1.2], elastic(), |p| held && p[2] < 0.01);
        mesh.nodes.iter_mut().for_each(|p| p[2] -= 0.7);
        let mut body = Dynamics::new(&mesh, GRAVITY, ground(level, 0.5), false);
        body.damping_1_s = 200.0;
        while body.time_s < 0.1 {
            body.step(false);
        }
        (0..mesh.nodes.len())
            .map(|n| (mesh.nodes[n][2] > 0.49, body.x[n][2]))
            .filter(|t| t.0)
            .map(|t| t.1)
            .sum::<f64>()
            / 9.0
            - if body.surfaces.new_touches.is_empty() && (!held || body.contact_j == [0.0; 2]) {
                0.5
            } else {
                f64::NAN
            }
    };
    let weight = 2500.0 * GRAVITY * 1.2 * 1.2 / (2.0 * 30e9);
    for settled in [run(-9.0, true), run(0.0, true), run(0.0, false)] {
        assert!((settled / -weight - 1.0).abs() < 0.1, "{settled} against {}", -weight);
    }
}

/// Friction of the ground on nodes held in one direction is booked as friction.
#[test]
fn friction_on_partly_held_nodes_is_booked_as_such() {
    let mesh = grid([3, 2, 2], [0.6, 0.4, 0.2], elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, GRAVITY, ground(0.0, 0.4), false);
    for n in 0..mesh.nodes.len() {
        body.prescribed_m_s[n][1] = Some(0.0);
        body.v[n][0] = 0.5;
    }
    let start = body.kinetic_j();
    let mut kinetic = 0.0;
    while body.time_s < 0.25 {
        kinetic = body.step(true);
    }
    assert!((body.contact_j[1] / -start - 1.0).abs() < 0.05, "{:?} of {start} J", body.contact_j);
    assert!(body.contact_j[0].abs() < 0.02 * start, "{:?} of {start} J", body.contact_j);
    assert!(balance(&body, kinetic, start).abs() < 0.01 * start);
}

/// A block whose underside is driven through a held one: no impulse can stop it, and the run says where and what.
#[test]
fn contact_that_cannot_hold_is_an_error() {
    let mut mesh = Mesh { laws: vec![elastic()], ..Mesh::default() };
    let lower = add(&mut mesh, [2, 2, 1], [0.4, 0.4, 0.1], [0.0; 3]);
    let upper = add(&mut mesh, [1, 1, 2], [0.2, 0.2, 0.4], [0.1, 0.1, 0.11]);
    mesh.fixed = (lower..upper).collect();
    let under = (upper..mesh.nodes.len()).filter(|n| mesh.nodes[*n][2] < 0.12);
    let driven =
        under.map(|node| DrivenNode { node, axis: 2, velocity_m_s: Curve::constant(-1.0) }).collect();
    let model = Model {
        mesh,
        driven,
        body_contact: Some(ContactSettings::default()),
        control: Control { end_time_s: 0.1, ..Control::default() },
        ..Model::default()
    };
    let error = run_model(&model, &ModelOptions::default(), None, &mut |_| {}).unwrap_err().to_string();
    assert!(error.contains("a node of part `brick 1` is 0.05"), "{error}");
    assert!(error.contains("inside part `brick 0` at x = ["), "{error}");
    assert!(error.contains("their contact did not hold; try a smaller mesh size"), "{error}");
}
