//! Nodes tied to faces: what a tie passes on exactly and what it does not, conservation, release.

use super::mesh::{elastic, grid, nearest};
use fallwerk::fe::apart::{Faces, outer_faces};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::law::Law;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::preload::equilibrate;

/// Two blocks along x, each `length_m` by 1 m by 1 m, meshed apart; the second is tied to the first.
fn pair(
    first: [usize; 3],
    second: [usize; 3],
    length_m: f64,
    law: Law,
    held: impl Fn([f64; 3]) -> bool,
) -> Mesh {
    let size = [length_m, 1.0, 1.0];
    let mut mesh = grid(first, size, law.clone(), &held);
    let faces = Faces::of(&mesh, outer_faces(&mesh));
    let other = grid(second, size, law, |_| false);
    let offset = mesh.nodes.len();
    mesh.nodes.extend(other.nodes.iter().map(|p| [p[0] + length_m, p[1], p[2]]));
    mesh.elements.extend(other.elements.iter().map(|e| {
        let mut e = *e;
        e.nodes = e.nodes.map(|n| n + offset);
        e
    }));
    for node in (offset..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == length_m) {
        let tie = faces.nearest(&mesh, node, 1e-6, false).expect("each node lies on a face");
        assert!((tie.masters.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        mesh.ties.push(tie);
    }
    assert_eq!(mesh.ties.len(), (second[1] + 1) * (second[2] + 1));
    mesh
}

/// A law without lateral strain, so that a clamped end leaves the stress uniform.
fn plain() -> Law {
    Law { poisson_ratio: 0.0, ..elastic() }
}

/// Traction of the patch test \[Pa\]: strains of 3e-7, so that the change of geometry does not show.
const TRACTION_PA: f64 = 1e4;

/// The consistent nodal forces of a uniform traction in direction `axis` on the face at the largest x.
fn pull(mesh: &Mesh, body: &mut Dynamics, axis: usize, counts: [usize; 3]) {
    let end = mesh.nodes.iter().map(|p| p[0]).fold(0.0, f64::max);
    for n in (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == end) {
        let share = |i: usize| {
            let edge = mesh.nodes[n][i] < 1e-9 || mesh.nodes[n][i] > 1.0 - 1e-9;
            if edge { 0.5 / counts[i] as f64 } else { 1.0 / counts[i] as f64 }
        };
        body.applied_n[n][axis] = TRACTION_PA * share(1) * share(2);
    }
}

/// A pair under uniform tension in equilibrium.
fn pulled(first: [usize; 3], second: [usize; 3]) -> (Mesh, Dynamics) {
    let mesh = pair(first, second, 2.0, plain(), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    pull(&mesh, &mut body, 0, second);
    equilibrate(&mut body).unwrap();
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[0]).sum();
    assert!((held + TRACTION_PA).abs() < 1e-6 * TRACTION_PA, "the force passed on is exact: {held}");
    (mesh, body)
}

/// Deviation of a node from `σ x / E`, in all directions \[m\].
fn deviation(mesh: &Mesh, body: &Dynamics, n: usize) -> [f64; 3] {
    let exact = [TRACTION_PA / 30e9 * mesh.nodes[n][0], 0.0, 0.0];
    std::array::from_fn(|i| body.x[n][i] - mesh.nodes[n][i] - exact[i])
}

/// Patch test: where the tied side's nodes include the masters' (1:2, 2:4, 1:3) a uniform stress is passed on exactly.
#[test]
fn uniform_stress_across_a_nested_tied_face() {
    for (first, second) in [([4, 1, 1], [8, 2, 2]), ([4, 2, 2], [8, 4, 4]), ([4, 1, 1], [12, 3, 3])] {
        let (mesh, body) = pulled(first, second);
        let off = (0..mesh.nodes.len())
            .flat_map(|n| deviation(&mesh, &body, n))
            .fold(0.0, |a: f64, u| a.max(u.abs()));
        assert!(off < 5e-7 * 4.0 * TRACTION_PA / 30e9, "{first:?} to {second:?}: {off:e}");
    }
}

/// Where they do not (2:3) the forces are exact in sum and moment, but reach the masters as if concentrated in the tied nodes. What that disturbs, in units
/// of the elongation of one element of the masters' side, and how it decays: it belongs to the elements, not to the body. Halving or thirding them all changes nothing, so that the
/// error of the whole falls with their size.
#[test]
fn decay_of_the_disturbance_at_a_tied_face() {
    for n in [1, 2, 3] {
        let (first, second) = ([4 * n, 2 * n, 2 * n], [6 * n, 3 * n, 3 * n]);
        let (mesh, body) = pulled(first, second);
        let nodes_of_first = (first[0] + 1) * (first[1] + 1) * (first[2] + 1);
        let size = 0.5 / n as f64;
        let unit = size * TRACTION_PA / 30e9;
        let at = |x: f64, tied: bool| -> Vec<f64> {
            let there = |n: &usize| (mesh.nodes[*n][0] - x).abs() < 1e-9 && (*n >= nodes_of_first) == tied;
            (0..mesh.nodes.len()).filter(there).map(|n| deviation(&mesh, &body, n)[0] / unit).collect()
        };
        let largest = |x: f64| at(x, false).into_iter().fold(0.0, |a: f64, u| a.max(u.abs()));
        let elements_away = |k: usize| largest(2.0 - k as f64 * size);
        let off = [0, 1, 2, 3].map(elements_away);
        assert!((0.185..0.205).contains(&off[0]), "{n}: {off:?}");
        assert!((0.018..0.024).contains(&off[1]), "{n}: {off:?}");
        assert!((0.006..0.010).contains(&off[2]), "{n}: {off:?}");
        assert!((0.001..0.006).contains(&off[3]), "{n}: {off:?}");
        // Behind the interface all of the tied side stays displaced: the interface gives.
        let far = at(4.0, true);
        assert!(far.iter().all(|u| (0.019..0.022).contains(u)), "{n}: {far:?}");
        let stress = stress_off(&mesh, &body);
        let (masters, tied): (Vec<_>, Vec<_>) = stress.into_iter().partition(|(x, _)| *x < 2.0);
        let tied: Vec<f64> = tied.into_iter().map(|(_, off)| off).collect();
        assert!(masters.iter().all(|(_, off)| *off < 0.008), "{n}: {masters:?}");
        assert!((0.105..0.117).contains(&tied[0]), "{n}: {tied:?}");
        assert!((0.014..0.019).contains(&tied[1]), "{n}: {tied:?}");
        assert!(tied[2] < 0.006 && tied[3] < 0.003, "{n}: {tied:?}");
    }
}

/// Largest deviation of the mean axial stress of an element from the traction, over the traction, for each layer of elements along x.
fn stress_off(mesh: &Mesh, body: &Dynamics) -> Vec<(f64, f64)> {
    let mut layers: Vec<(f64, f64)> = Vec::new();
    for e in 0..mesh.elements.len() {
        let p = mesh.elements[e].nodes.map(|n| mesh.nodes[n]);
        let area = (p[6][1] - p[0][1]) * (p[6][2] - p[0][2]);
        let force = body.blocks.element_force(e, &body.x);
        let pull: f64 = [1, 2, 5, 6].map(|k| force[k][0]).iter().sum();
        let (x, off) = (mesh.center(e)[0], (pull / (area * TRACTION_PA) - 1.0).abs());
        match layers.iter_mut().find(|(at, _)| (at - x).abs() < 1e-9) {
            Some(layer) => layer.1 = layer.1.max(off),
            None => layers.push((x, off)),
        }
    }
    layers.sort_by(|a, b| a.0.total_cmp(&b.0));
    layers
}

/// Weights of both signs would pass a uniform stress on at a 2:3 interface: with 7/24, 3/4 and -1/24 for the inner nodes the masters get the shares of their own shape
/// functions. What keeps the solver from them stands in `fe::tie`.
#[test]
fn weights_of_both_signs_would_be_exact() {
    let mut mesh = pair([4, 2, 2], [6, 3, 3], 2.0, plain(), |p| p[0] == 0.0);
    let masters: Vec<usize> = (0..5 * 3 * 3).filter(|n| mesh.nodes[*n][0] == 2.0).collect();
    let along = |c: f64| match (3.0 * c).round() as usize {
        0 => [1.0, 0.0, 0.0],
        1 => [7.0 / 24.0, 0.75, -1.0 / 24.0],
        2 => [-1.0 / 24.0, 0.75, 7.0 / 24.0],
        _ => [0.0, 0.0, 1.0],
    };
    for tie in &mut mesh.ties {
        let [_, y, z] = mesh.nodes[tie.node];
        let weight = |m: usize| {
            let [_, b, c] = mesh.nodes[m].map(|c| (2.0 * c).round() as usize);
            along(y)[b] * along(z)[c]
        };
        tie.masters = masters.iter().map(|m| (*m, weight(*m))).filter(|(_, w)| *w != 0.0).collect();
    }
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    assert!(masters.iter().all(|m| body.mass_kg[*m] > 0.0));
    pull(&mesh, &mut body, 0, [6, 3, 3]);
    equilibrate(&mut body).unwrap();
    let off =
        (0..mesh.nodes.len()).flat_map(|n| deviation(&mesh, &body, n)).fold(0.0, |a: f64, u| a.max(u.abs()));
    assert!(off < 5e-7 * 4.0 * TRACTION_PA / 30e9, "{off:e}");
}

/// Moment of the forces on the held nodes about an axis through the middle of the interface at x = 0 \[N m\], about y and z.
fn held_moment(mesh: &Mesh, body: &Dynamics) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for n in &mesh.fixed {
        let (p, f) = (body.x[*n], body.internal_n(*n));
        sum[0] += (p[2] - 0.5) * f[0] - p[0] * f[2];
        sum[1] += p[0] * f[1] - (p[1] - 0.5) * f[0];
    }
    sum
}

/// Uniform shear through a nested interface: all nodes move by `γ x` across, `γ = τ / G`, if tractions `τ` act on all faces that
/// a uniform shear stress asks for. The interface is at x = 2, those of the sides are at y = 0 and 1.
#[test]
fn uniform_shear_across_a_tied_face() {
    for (first, second) in [([4, 1, 1], [8, 2, 2]), ([4, 2, 2], [8, 4, 4])] {
        let mesh = pair(first, second, 2.0, plain(), |p| p[0] == 0.0);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        pull(&mesh, &mut body, 1, second);
        for element in &mesh.elements {
            let nodes = element.nodes.map(|n| mesh.nodes[n]);
            let area = (nodes[6][0] - nodes[0][0]) * (nodes[6][2] - nodes[0][2]);
            for (n, p) in element.nodes.iter().zip(nodes) {
                let side = if p[1] > 1.0 - 1e-9 {
                    1.0
                } else if p[1] < 1e-9 {
                    -1.0
                } else {
                    0.0
                };
                body.applied_n[*n][0] += 0.25 * side * TRACTION_PA * area;
            }
        }
        equilibrate(&mut body).unwrap();
        let slope = TRACTION_PA / 15e9;
        for n in 0..mesh.nodes.len() {
            let exact = [0.0, slope * mesh.nodes[n][0], 0.0];
            let off = (0..3).map(|i| (body.x[n][i] - mesh.nodes[n][i] - exact[i]).abs()).fold(0.0, f64::max);
            assert!(off < 5e-6 * 4.0 * slope, "{first:?} to {second:?}: {off:e} at {:?}", mesh.nodes[n]);
        }
        let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[1]).sum();
        assert!((held + TRACTION_PA).abs() < 1e-6 * TRACTION_PA, "{held}");
    }
}

/// Force and moment pass through any interface: a cantilever under a force at its tip has the moment `P L` at its root.
#[test]
fn moments_pass_through_a_tied_face() {
    for (first, second) in [([4, 2, 2], [8, 4, 4]), ([4, 2, 2], [6, 3, 3]), ([4, 3, 3], [6, 2, 2])] {
        let mesh = pair(first, second, 2.0, elastic(), |p| p[0] == 0.0);
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        pull(&mesh, &mut body, 2, second);
        equilibrate(&mut body).unwrap();
        let [about_y, about_z] = held_moment(&mesh, &body);
        let expected = 4.0 * TRACTION_PA;
        assert!((about_y.abs() / expected - 1.0).abs() < 1e-5, "{first:?} to {second:?}: {about_y}");
        assert!(about_z.abs() < 1e-5 * expected, "{about_z}");
    }
}

/// Rigid motion and any linear field that the masters have, the tied nodes have too: `x_s = Σ w x_m`.
#[test]
fn tied_nodes_follow_a_linear_field() {
    let mesh = pair([4, 2, 2], [6, 3, 3], 2.0, plain(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let field =
        |p: [f64; 3]| [0.1 * p[0] - 0.3 * p[1], 2.0 + 0.2 * p[2], 0.5 * p[0] + 0.4 * p[1] - 0.1 * p[2]];
    for n in 0..mesh.nodes.len() {
        body.v[n] = if body.ties.is_tied(n) { [9.0; 3] } else { field(mesh.nodes[n]) };
    }
    body.follow_ties();
    for tie in &mesh.ties {
        for i in 0..3 {
            assert!((body.v[tie.node][i] - field(mesh.nodes[tie.node])[i]).abs() < 1e-12);
        }
    }
}

fn momentum(body: &Dynamics) -> [f64; 3] {
    std::array::from_fn(|i| body.v.iter().zip(&body.mass_kg).map(|(v, m)| m * v[i]).sum())
}

/// A free pair of blocks that rings: mass, momentum and energy stay.
#[test]
fn energy_and_momentum_across_a_tied_face() {
    let mesh = pair([4, 2, 2], [6, 3, 3], 2.0, elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.step_safety = 0.2; // the energy of central differences swings with the square of the step
    body.dt_s *= 0.2;
    assert!((body.mass_kg.iter().sum::<f64>() - 4.0 * 2500.0).abs() < 1e-6);
    for n in 0..mesh.nodes.len() {
        let [x, y, z] = mesh.nodes[n];
        body.v[n] = [(1.5 * x).sin() + 0.3, (2.0 * x).cos() * z, (0.8 * x * y).sin()];
    }
    body.follow_ties();
    let before = momentum(&body);
    let start = body.kinetic_j();
    let mut worst: f64 = 0.0;
    for _ in 0..3000 {
        let kinetic = body.step(true);
        let total = kinetic + body.blocks.energies_j().iter().sum::<f64>();
        worst = worst.max((total / start - 1.0).abs());
    }
    assert!(worst < 1.5e-3, "energy {worst:e}");
    for (a, b) in before.iter().zip(momentum(&body)) {
        assert!((a - b).abs() < 1e-9 * 1e4, "{a} to {b}");
    }
    for tie in &mesh.ties {
        for i in 0..3 {
            let place: f64 = tie.masters.iter().map(|(m, w)| w * body.x[*m][i]).sum();
            assert!((body.x[tie.node][i] - place).abs() < 1e-12, "the node has left its place");
        }
    }
}

/// When the element under a tie goes, its nodes are free, with their own mass; mass and momentum stay.
#[test]
fn a_tie_ends_with_its_element() {
    let mesh = pair([4, 2, 2], [6, 3, 3], 2.0, elastic(), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for n in 0..mesh.nodes.len() {
        body.v[n] = [0.1 * mesh.nodes[n][1], mesh.nodes[n][0], 1.0];
    }
    body.follow_ties();
    let (mass, before, kinetic) = (body.mass_kg.iter().sum::<f64>(), momentum(&body), body.kinetic_j());
    let gone = mesh.ties[0].element;
    let freed: Vec<usize> = mesh.ties.iter().filter(|t| t.element == gone).map(|t| t.node).collect();
    assert!(!freed.is_empty() && freed.len() < mesh.ties.len());
    assert!(freed.iter().all(|n| body.mass_kg[*n] == 0.0));
    body.blocks.set_share(gone, 0.0);
    body.dt_s = 1e-9;
    body.step(false);
    assert_eq!(body.ties.acting(), mesh.ties.len() - freed.len());
    for n in freed {
        assert!(body.mass_kg[n] > 0.0 && !body.ties.is_tied(n));
    }
    assert!((body.mass_kg.iter().sum::<f64>() - mass).abs() < 1e-9 * mass);
    for (a, b) in before.iter().zip(momentum(&body)) {
        assert!((a - b).abs() < 1e-6 * mass, "{a} to {b}");
    }
    assert!(body.ties.released_j < 0.0);
    let lost = body.kinetic_j() - kinetic;
    assert!((lost / body.ties.released_j - 1.0).abs() < 1e-3, "{lost} against {}", body.ties.released_j);
}

/// Cantilever of 10 m whose halves are tied, 2 x 2 and 3 x 3 elements in section: the tip sinks like that of a beam without a joint,
/// `w L⁴ / (8 E I)` and shear `w L² / (2 κ G A)`, and the dead-load state is at rest.
#[test]
fn cantilever_with_a_tied_middle() {
    let mesh = pair([10, 2, 2], [15, 3, 3], 5.0, elastic(), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    equilibrate(&mut body).unwrap();
    let load = 2500.0 * 9.81;
    let expected = load * 1e4 / (8.0 * 30e9 / 12.0) + load * 100.0 / (2.0 * 5.0 / 6.0 * 12.5e9);
    let tip = nearest(&mesh, [10.0, 0.5, 0.5]);
    let sunk = mesh.nodes[tip][2] - body.x[tip][2];
    assert!((sunk / expected - 1.0).abs() < 0.02, "{sunk} against {expected}");
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * 9.81).sum();
    assert!((held / (load * 10.0) - 1.0).abs() < 1e-8, "{held}");
    let before = body.x[tip];
    for _ in 0..300 {
        body.step(false);
    }
    assert!((body.x[tip][2] - before[2]).abs() < 1e-6 * expected, "it moves");
}
