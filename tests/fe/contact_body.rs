//! Contact of the body with itself: momentum, energy, friction, impact, erosion, debris, search.

use super::mesh::{elastic, ground, nearest, of_hexahedra};
use fallwerk::fe::contact::{BodyContact, RigidSurfaces};
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::law::Law;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::model::ContactSettings;

const GRAVITY: f64 = 9.81;

/// A box by element counts, size, lower corner.
struct Brick([usize; 3], [f64; 3], [f64; 3]);

/// Boxes of one mesh, each a part of its own, and the first node of each.
fn bricks(bricks: &[Brick], law: Law, fixed: impl Fn([f64; 3]) -> bool) -> (Mesh, Vec<usize>) {
    let (mut nodes, mut hexahedra, mut parts, mut first) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (part, Brick(counts, size, corner)) in bricks.iter().enumerate() {
        let one = super::mesh::grid(*counts, *size, law.clone(), |_| false);
        first.push(nodes.len());
        hexahedra.extend(one.elements.iter().map(|e| e.nodes.map(|n| n + nodes.len())));
        parts.extend(one.elements.iter().map(|_| part));
        nodes.extend(one.nodes.iter().map(|p| std::array::from_fn(|i| p[i] + corner[i])));
    }
    first.push(nodes.len());
    let held = (0..nodes.len()).filter(|n| fixed(nodes[*n])).collect();
    let mut mesh = of_hexahedra(nodes, hexahedra, law, held);
    mesh.elements.iter_mut().zip(parts).for_each(|(e, part)| e.part = part);
    mesh.parts = (0..bricks.len()).map(|i| format!("brick {i}")).collect();
    (mesh, first)
}

fn body(mesh: &Mesh, gravity: f64, surfaces: RigidSurfaces, friction: f64) -> Dynamics {
    let mut body = Dynamics::new(mesh, gravity, surfaces, false);
    let settings = ContactSettings { friction };
    body.body_contact = Some(Box::new(BodyContact::new(mesh, settings)));
    body
}

fn momentum(body: &Dynamics) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (v, m) in body.v.iter().zip(&body.mass_kg) {
        (0..3).for_each(|i| sum[i] += m * v[i]);
    }
    sum
}

fn angular(body: &Dynamics) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for ((x, v), m) in body.x.iter().zip(&body.v).zip(&body.mass_kg) {
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sum[i] += m * (x[j] * v[k] - x[k] * v[j]);
        }
    }
    sum
}

/// Mean of a nodal field over the nodes of a brick, by mass.
fn mean(body: &Dynamics, field: &[[f64; 3]], nodes: std::ops::Range<usize>, axis: usize) -> f64 {
    let mass: f64 = nodes.clone().map(|n| body.mass_kg[n]).sum();
    nodes.map(|n| body.mass_kg[n] * field[n][axis]).sum::<f64>() / mass
}

fn balance(body: &Dynamics, kinetic: f64, start: f64) -> f64 {
    let stored: f64 = body.blocks.energies_j().iter().sum();
    kinetic + stored - start - body.gravity_j - body.contact_j[0] - body.contact_j[1] - body.driven_j
}

fn pressed(body: &Dynamics) -> usize {
    body.body_contact.as_ref().unwrap().summary().most_contacts
}

/// Two skew blocks of different meshes hit each other while one turns: no force from outside.
#[test]
fn impact_keeps_both_momenta_and_books_its_energy() {
    let (mesh, first) = bricks(
        &[
            Brick([3, 3, 3], [0.6, 0.6, 0.6], [0.0; 3]),
            Brick([2, 2, 3], [0.5, 0.5, 0.7], [0.13, -0.11, 0.61]),
        ],
        elastic(),
        |_| false,
    );
    let mut body = body(&mesh, 0.0, RigidSurfaces::default(), 0.4);
    for n in first[1]..first[2] {
        let x = mesh.nodes[n];
        body.v[n] = [1.0 + 2.0 * (x[2] - 0.9), -0.5, -5.0 - 2.0 * (x[0] - 0.4)];
    }
    let start = (body.kinetic_j(), momentum(&body), angular(&body));
    let (mut worst, mut last) = (0.0_f64, 0.0);
    while body.time_s < 0.05 {
        last = body.step(true);
        worst = worst.max(balance(&body, last, start.0).abs());
    }
    let (p, l) = (momentum(&body), angular(&body));
    for i in 0..3 {
        assert!((p[i] - start.1[i]).abs() < 1e-10 * start.1[2].abs(), "{:?} {p:?}", start.1);
    }
    // the reaction to friction acts at the foot of the node, off it by the gap; positions are half a step off
    for i in 0..3 {
        assert!((l[i] - start.2[i]).abs() < 2e-4 * start.1[2].abs(), "{:?} {l:?}", start.2);
    }
    assert!(worst < 0.01 * start.0, "energy off by {worst} of {} J", start.0);
    assert!(body.contact_j[0] < 0.0 && body.contact_j[1] < 0.0, "{:?}", body.contact_j);
    assert!(mean(&body, &body.v, first[0]..first[1], 2) < -1.0, "the lower block was hit, {last}");
}

/// A block falls by 0.1 m on another, which stands on the ground.
#[test]
fn fallen_block_rests_on_the_other() {
    let (mesh, first) = bricks(
        &[Brick([3, 3, 2], [0.6, 0.6, 0.4], [0.0; 3]), Brick([2, 2, 2], [0.4, 0.4, 0.4], [0.07, 0.11, 0.5])],
        elastic(),
        |_| false,
    );
    let mut body = body(&mesh, GRAVITY, ground(0.0, 0.5), 0.5);
    let upper = first[1]..first[2];
    let lowest = |b: &Dynamics| upper.clone().map(|n| b.x[n][2]).fold(f64::INFINITY, f64::min);
    let fall_j = 2500.0 * 0.4_f64.powi(3) * GRAVITY * 0.1;
    let (mut deepest, mut worst) = (0.0_f64, (0.0_f64, 0.0));
    while body.time_s < 0.8 {
        let kinetic = body.step(true);
        deepest = deepest.max(0.4 - lowest(&body));
        let left = balance(&body, kinetic, 0.0);
        if left.abs() > worst.0.abs() {
            worst = (left, body.time_s);
        }
    }
    assert!(deepest < 5e-4, "penetration {deepest}");
    assert!((lowest(&body) - 0.4).abs() < 1e-4, "rests at {}", lowest(&body));
    assert!(body.kinetic_j() < 1e-3 * fall_j, "it rests: {} of {fall_j} J", body.kinetic_j());
    assert!(worst.0.abs() < 0.01 * fall_j, "energy off by {worst:?} of {fall_j} J");
}

/// Stopping distance `v² / (2 μ g)` of a block on a held plate.
#[test]
fn sliding_block_stops_where_friction_says() {
    let (mesh, first) = bricks(
        &[Brick([8, 4, 1], [1.6, 0.8, 0.2], [0.0; 3]), Brick([3, 2, 2], [0.6, 0.4, 0.2], [0.13, 0.17, 0.2])],
        elastic(),
        |p| p[2] < 0.01,
    );
    let mut body = body(&mesh, GRAVITY, RigidSurfaces::default(), 0.4);
    let upper = first[1]..first[2];
    upper.clone().for_each(|n| body.v[n][0] = 1.0);
    let (start, from) = (body.kinetic_j(), mean(&body, &body.x, upper.clone(), 0));
    let mut kinetic = 0.0;
    while body.time_s < 0.4 {
        kinetic = body.step(true);
    }
    let travelled = mean(&body, &body.x, upper, 0) - from;
    let expected = 1.0 / (2.0 * 0.4 * GRAVITY);
    assert!((travelled / expected - 1.0).abs() < 0.03, "{travelled} against {expected}");
    assert!(kinetic < 1e-3 * start, "it rests: {kinetic} of {start} J");
    assert!((body.contact_j[1] / -start - 1.0).abs() < 0.05, "{:?} of {start} J", body.contact_j);
    assert!(balance(&body, kinetic, start).abs() < 0.01 * start);
}

/// Equal bars exchange their velocities, and part after `2 L / c`.
#[test]
fn equal_bars_exchange_their_velocities() {
    let mut law = elastic();
    law.poisson_ratio = 0.0; // then the bar wave has c = sqrt(E / ρ) without lateral inertia
    let gap = 1e-4;
    let (mesh, first) = bricks(
        &[
            Brick([60, 1, 1], [6.0, 0.1, 0.1], [0.0; 3]),
            Brick([60, 1, 1], [6.0, 0.1, 0.1], [6.0 + gap, 0.0, 0.0]),
        ],
        law,
        |_| false,
    );
    let mut body = body(&mesh, 0.0, RigidSurfaces::default(), 0.3);
    let (left, right) = (first[0]..first[1], first[1]..first[2]);
    left.clone().for_each(|n| body.v[n][0] = 2.0);
    let start = body.kinetic_j();
    let wave = (30e9_f64 / 2500.0).sqrt();
    let ends = [nearest(&mesh, [6.0, 0.0, 0.0]), nearest(&mesh, [6.0 + gap, 0.0, 0.0])];
    let (mut touched, mut parted) = (None, None);
    while body.time_s < 3.0 * 6.0 / wave {
        body.step(false);
        let open = body.x[ends[1]][0] - body.x[ends[0]][0];
        if open < 1e-9 {
            touched.get_or_insert(body.time_s);
            parted = None;
        } else if touched.is_some() && open > 1e-5 {
            parted.get_or_insert(body.time_s);
        }
    }
    let lasted = parted.unwrap() - touched.unwrap();
    assert!((lasted / (12.0 / wave) - 1.0).abs() < 0.03, "contact of {lasted}, 2 L / c = {}", 12.0 / wave);
    let speeds = [left, right].map(|nodes| mean(&body, &body.v, nodes, 0));
    assert!(speeds[0].abs() < 0.04 && (speeds[1] - 2.0).abs() < 0.04, "{speeds:?}");
    let lost = -body.contact_j[0] / start;
    // the two layers of nodes that meet, half an element each, do so plastically
    assert!(lost > 0.0 && lost < 0.01, "lost {lost}");
}

/// Three blocks of different meshes one upon another stay where they are.
#[test]
fn stack_stays_at_rest() {
    let (mesh, first) = bricks(
        &[
            Brick([2, 2, 2], [0.4, 0.4, 0.4], [0.0; 3]),
            Brick([3, 2, 2], [0.4, 0.4, 0.4], [0.0, 0.0, 0.4]),
            Brick([2, 3, 2], [0.4, 0.4, 0.4], [0.05, 0.03, 0.8]),
        ],
        elastic(),
        |_| false,
    );
    let mut body = body(&mesh, GRAVITY, ground(0.0, 0.5), 0.5);
    while body.time_s < 0.5 {
        body.step(false);
    }
    for (x, at) in body.x.iter().zip(&mesh.nodes) {
        assert!((0..3).all(|i| (x[i] - at[i]).abs() < 1e-4), "{at:?} moved to {x:?}");
    }
    assert!(body.kinetic_j() < 1e-4, "{} J", body.kinetic_j());
    assert!(first.len() == 4 && pressed(&body) >= 18, "{} contacts", pressed(&body));
}

/// A block on a plate whose upper layer is taken away falls on the layer below, whose faces did not exist before. The debris has no size: it
/// lies on the layer, and the block on it without a gap. The elements never yield and ring on after the fall, by which the block hops some
/// millimetres for seconds; damping brings it to rest.
#[test]
fn opened_face_and_debris_are_met() {
    let (mut mesh, first) = bricks(
        &[
            Brick([4, 4, 3], [0.8, 0.8, 0.6], [0.0; 3]),
            Brick([2, 2, 2], [0.3, 0.3, 0.3], [0.22, 0.26, 0.601]),
        ],
        elastic(),
        |p| p[2] < 0.01,
    );
    // an upper layer that dies at the first touch of plastic strain
    let mut weak = super::mesh::bilinear(30e9, 0.2, 2500.0, 1e3, 0.0);
    weak.erosion.plastic_strain = 1e-9;
    mesh.laws.push(weak);
    for e in 0..48 {
        if mesh.center(e)[2] > 0.4 {
            mesh.elements[e].law = 1;
        }
    }
    mesh.elements.sort_by_key(|e| e.law);
    let mut body = body(&mesh, GRAVITY, RigidSurfaces::default(), 0.5);
    let upper = first[1]..first[2];
    upper.clone().for_each(|n| body.v[n][2] = -1.0);
    let mut deaths = 0;
    while body.time_s < 1.6 {
        body.damping_1_s = if body.time_s < 0.6 { 0.0 } else { 50.0 };
        body.step(false);
        deaths += body.deaths.len();
    }
    assert_eq!(deaths, 16, "the upper layer is gone");
    let low = upper.map(|n| body.x[n][2]).fold(f64::INFINITY, f64::min);
    let summary = body.body_contact.as_ref().unwrap().summary().clone();
    assert!((low - 0.4).abs() < 1e-4, "the block lies at {low}, {} J, {summary:?}", body.kinetic_j());
    for n in first[0]..first[1] {
        // debris has come down: on the lower layer if it was over it, and never into it
        let over = (0..2).all(|i| body.x[n][i] > 1e-6 && body.x[n][i] < 0.8 - 1e-6);
        if mesh.nodes[n][2] > 0.5 && over {
            assert!((body.x[n][2] - 0.4).abs() < 2e-3, "debris at {:?}", body.x[n]);
        }
    }
    assert!(body.body_contact.as_ref().unwrap().lost.is_none());
}

/// A heap of falling blocks; the bits of all positions.
fn heap(parallel: bool, every_step: bool) -> (Vec<[u64; 3]>, u64) {
    let mut list = vec![Brick([8, 8, 2], [1.6, 1.6, 0.2], [0.0; 3])];
    for i in 0..4 {
        let shift = 0.1 * i as f64;
        list.push(Brick(
            [4, 4, 4],
            [0.5, 0.5, 0.5],
            [0.2 + shift, 0.5 - 0.5 * shift, 0.25 + 0.55 * i as f64],
        ));
    }
    let (mesh, first) = bricks(&list, elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, GRAVITY, ground(-0.01, 0.5), parallel);
    let mut contact = BodyContact::new(&mesh, ContactSettings::default());
    contact.search_every_step = every_step;
    body.body_contact = Some(Box::new(contact));
    (first[1]..first[5]).for_each(|n| body.v[n] = [1.0, 0.5 - mesh.nodes[n][0], -4.0]);
    for _ in 0..1500 {
        body.step(false);
    }
    assert!(pressed(&body) > 20, "{}", pressed(&body));
    let searches = body.body_contact.as_ref().unwrap().summary().searches;
    (body.x.iter().map(|x| x.map(f64::to_bits)).collect(), searches)
}

#[test]
fn search_bound_misses_nothing_and_threads_change_nothing() {
    let (serial, few) = heap(false, false);
    let (always, all) = heap(false, true);
    assert!(few < 200 && all == 1500, "{few} of {all} searches");
    assert!(serial == always, "searching in every step gives something else");
    for threads in [1, 3] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(|| heap(true, false)).0 == serial, "{threads} threads");
    }
}

/// Bricks that overlap by 20 mm at the start, and ones that touch: neither is thrown out.
#[test]
fn overlap_at_the_start_is_not_thrown_out() {
    let (mesh, first) = bricks(
        &[Brick([2, 2, 2], [0.4, 0.4, 0.4], [0.0; 3]), Brick([3, 3, 2], [0.4, 0.4, 0.4], [0.0, 0.0, 0.38])],
        elastic(),
        |_| false,
    );
    let mut body = body(&mesh, 0.0, RigidSurfaces::default(), 0.3);
    while body.time_s < 0.2 {
        body.step(false);
        let fastest = body.v.iter().map(|v| v[2].abs()).fold(0.0, f64::max);
        assert!(fastest < 0.2, "{fastest} m/s at {}", body.time_s);
    }
    let speed = mean(&body, &body.v, first[1]..first[2], 2);
    assert!(speed > 0.0 && speed < 0.06, "{speed}");
}

/// A block at 30 m/s, twice the speed after a fall of 11 m, on a plate of two elements of 0.1 m held at its edges: no node gets through.
#[test]
fn nothing_tunnels_at_the_speed_of_a_fall() {
    let (mesh, first) = bricks(
        &[Brick([4, 4, 2], [1.0, 1.0, 0.2], [0.0; 3]), Brick([2, 2, 2], [0.5, 0.5, 0.5], [0.21, 0.23, 0.25])],
        elastic(),
        |p| p[0] < 0.01 || p[0] > 0.99,
    );
    let mut body = body(&mesh, 0.0, RigidSurfaces::default(), 0.5);
    (first[1]..first[2]).for_each(|n| body.v[n] = [3.0, 0.0, -30.0]);
    while body.time_s < 0.03 {
        body.step(false);
    }
    let contact = body.body_contact.as_ref().unwrap();
    assert!(contact.lost.is_none(), "{:?}", contact.lost);
    let summary = contact.summary();
    assert!(summary.most_contacts >= 8 && summary.deepest_m < 0.01, "{summary:?}");
    let rebound = mean(&body, &body.v, first[1]..first[2], 2);
    assert!(rebound > -5.0, "the plate stopped it: {rebound} m/s");
}

/// A plate of one layer that flies with its narrow side against a block, also where elements are four times as wide as it is thick: its nodes look upwards and downwards rather than ahead.
#[test]
fn thin_plates_meet_what_they_fly_against_with_their_narrow_side() {
    for thickness in [0.12, 0.1, 0.05] {
        let plate = Brick([2, 4, 1], [0.8, 1.6, thickness], [0.03, 0.0, 0.41]);
        let (mesh, first) =
            bricks(&[Brick([2, 2, 2], [0.8, 0.8, 0.8], [0.0, 1.65, 0.03]), plate], elastic(), |p| p[1] > 2.4);
        let mut body = body(&mesh, 0.0, RigidSurfaces::default(), 0.0);
        (first[1]..first[2]).for_each(|n| body.v[n] = [0.0, 10.0, 0.0]);
        while body.time_s < 0.03 {
            body.step(false);
        }
        let speed = mean(&body, &body.v, first[1]..first[2], 1);
        assert!(speed < 0.0, "{thickness} m thick: {speed} m/s after the impact");
    }
}
