//! Plasticity: hardening table, plastic moment of a section two elements deep, Taylor's bar.

use super::mesh::{
    Single, bilinear, elastic, grid, ground, hexahedron, in_lanes, nearest, of_hexahedra, point,
};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::kernel::{KernelStep, LANES, update_block};
use fallwerk::fe::law::Law;
use fallwerk::fe::mesh::Mesh;

/// Uniaxial strain: `2 G ε - 3 G p = σ_y(p)` over the kinks of the table, to round-off.
#[test]
fn uniaxial_strain_follows_the_table() {
    let table = [point(0.0, 15e6), point(0.01, 16.5e6), point(0.1, 12e6)];
    let law = Law { hardening: table.to_vec(), ..elastic() };
    let mut one = Single::new(&law, 2500.0);
    let mut force = [[0.0; LANES]; 24];
    let step = KernelStep { dt_s: 1.0, viscous: false };
    let g = one.material.mu_pa[0];
    let mut nodes = hexahedron(0.0, 0);
    let mut strain = 0.0;
    for _ in 0..400 {
        let du = nodes.map(|p| [5e-4 * p[0], 0.0, 0.0]);
        nodes = std::array::from_fn(|n| std::array::from_fn(|i| nodes[n][i] + du[n][i]));
        update_block(
            &in_lanes(&nodes),
            &in_lanes(&du),
            &one.material,
            &one.table,
            &mut one.state,
            &mut force,
            step,
        );
        let gradient = 5e-4 / 1.0005; // of the end configuration, then taken to mid-step
        strain += gradient / (1.0 - 0.5 * gradient);
        let p = one.state.plastic_strain[0];
        let expected = match p {
            p if p < 0.01 => 15e6 + 150e6 * p,
            p if p < 0.1 => 16.5e6 - 50e6 * (p - 0.01),
            _ => 12e6,
        };
        let mises = one.state.stress[0][0] - one.state.stress[1][0];
        assert!(p == 0.0 || (mises / expected - 1.0).abs() < 1e-9, "p {p}: {mises} {expected}");
        assert!((2.0 * g * strain - 3.0 * g * p - mises).abs() < 1e-6 * expected, "p {p}");
    }
    assert!(one.state.plastic_strain[0] > 0.11);
}

/// Pure bending of a bar two elements deep to 20 times the yield curvature: `M = σ_y b h² / 4`. The stabilisation that is left
/// in flowing elements may add to it: 8.4 % measured with a floor of 0.1, 6.0 % with 0.05, about 3.5 % extrapolated to none.
#[test]
fn plastic_moment_of_two_elements() {
    let (length, yield_pa, end_s) = (2.0, 2e6, 0.15);
    let mesh = grid([4, 2, 2], [length, 1.0, 1.0], bilinear(30e9, 0.2, 2500.0, yield_pa, 0.0), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.damping_1_s = 200.0;
    let curvature = 20.0 * 2.0 * yield_pa / 30e9;
    let ends: Vec<(usize, f64)> = (0..mesh.nodes.len())
        .filter_map(|n| match mesh.nodes[n][0] {
            0.0 => Some((n, 1.0)),
            x if x == length => Some((n, -1.0)),
            _ => None,
        })
        .collect();
    for (n, side) in &ends {
        let speed = side * (mesh.nodes[*n][2] - 0.5) * 0.5 * curvature * length / end_s;
        body.prescribed_m_s[*n] = [Some(speed), None, None];
    }
    let mut moment = 0.0;
    while body.time_s < end_s {
        body.step(false);
        let arm = |n: &usize| body.x[*n][2] - 0.5;
        moment = ends
            .iter()
            .filter(|(_, side)| *side < 0.0)
            .map(|(n, _)| (arm(n) * body.internal_n[*n][0]).abs())
            .sum();
    }
    let expected = yield_pa / 4.0;
    assert!(moment > expected && moment < 1.09 * expected, "{moment} against {expected}");
    let [internal, hourglass, viscous] = body.blocks.energies_j();
    let residual = body.driven_j + body.gravity_j - internal - hourglass - viscous - body.kinetic_j();
    assert!(residual.abs() < 0.01 * internal, "drives are booked: {residual} of {internal}");
}

/// A round bar along z of 48 hexahedra a section: a core of 4 x 4 and two rings of 16.
pub(super) fn round_bar(length: f64, radius: f64, layers: usize, law: Law) -> Mesh {
    let core =
        |i: usize, j: usize| [0.5 * radius * (i as f64 / 2.0 - 1.0), 0.5 * radius * (j as f64 / 2.0 - 1.0)];
    let rim: Vec<(usize, usize)> = (0..4)
        .map(|i| (i, 0))
        .chain((0..4).map(|j| (4, j)))
        .chain((1..5).rev().map(|i| (i, 4)))
        .chain((1..5).rev().map(|j| (0, j)))
        .collect();
    let mut plane: Vec<[f64; 2]> = (0..25).map(|n| core(n % 5, n / 5)).collect();
    for ring in 1..=2 {
        for (k, (i, j)) in rim.iter().enumerate() {
            let (inner, angle) = (core(*i, *j), std::f64::consts::TAU * (k as f64 / 16.0 - 0.375));
            let outer = [radius * angle.cos(), radius * angle.sin()];
            plane.push(std::array::from_fn(|a| inner[a] + 0.5 * f64::from(ring) * (outer[a] - inner[a])));
        }
    }
    let on_rim = |ring: usize, k: usize| match ring {
        0 => rim[k % 16].1 * 5 + rim[k % 16].0,
        _ => 25 + 16 * (ring - 1) + k % 16,
    };
    let mut quads: Vec<[usize; 4]> =
        (0..16).map(|q| q / 4 * 5 + q % 4).map(|n| [n, n + 1, n + 6, n + 5]).collect();
    for ring in 0..2 {
        for k in 0..16 {
            quads.push([on_rim(ring, k), on_rim(ring + 1, k), on_rim(ring + 1, k + 1), on_rim(ring, k + 1)]);
        }
    }
    let (mut nodes, mut hexahedra) = (Vec::new(), Vec::new());
    for layer in 0..=layers {
        nodes.extend(plane.iter().map(|p| [p[0], p[1], length * layer as f64 / layers as f64]));
    }
    for layer in 0..layers {
        for q in &quads {
            let at = |corner: usize, level: usize| q[corner] + (layer + level) * plane.len();
            hexahedra.push([at(0, 0), at(1, 0), at(2, 0), at(3, 0), at(0, 1), at(1, 1), at(2, 1), at(3, 1)]);
        }
    }
    of_hexahedra(nodes, hexahedra, law, Vec::new())
}

/// Taylor's copper bar, 1152 elements. OpenRadioss with the same mesh: length 21.51 to 21.67 mm, foot 6.76 to 7.07 mm,
/// plastic strain 2.34 to 2.68 (elements that do not lock); published codes 21.4 to 21.5, 6.9 to 7.2, 2.5 to 3.2.
#[test]
fn taylor_bar() {
    let law = bilinear(117e9, 0.35, 8930.0, 400e6, 100e6);
    let mesh = round_bar(32.4e-3, 3.2e-3, 24, law);
    assert_eq!(mesh.elements.len(), 1152);
    let surfaces = ground(0.0, 0.0);
    let mut body = Dynamics::new(&mesh, 0.0, surfaces, false);
    body.v.iter_mut().for_each(|v| v[2] = -227.0);
    let kinetic = body.kinetic_j();
    let mut moving = 0.0;
    while body.time_s < 80e-6 {
        moving = body.step(true);
        assert!(body.deaths.is_empty());
    }
    let length = body.x[nearest(&mesh, [0.0, 0.0, 32.4e-3])][2];
    let foot = body.x.iter().map(|x| x[0].hypot(x[1])).fold(0.0, f64::max);
    let strain = (0..1152).map(|e| body.blocks.plastic_strain(e)).fold(0.0, f64::max);
    assert!((21.3e-3..21.75e-3).contains(&length), "length {length}");
    assert!((6.7e-3..7.3e-3).contains(&foot), "foot radius {foot}");
    assert!((2.2..3.2).contains(&strain), "plastic strain {strain}");
    let [internal, hourglass, viscous] = body.blocks.energies_j();
    let residual = moving + internal + hourglass + viscous - kinetic - body.contact_j[0] - body.contact_j[1];
    assert!(residual.abs() < 0.01 * kinetic, "energy {residual} of {kinetic}");
    assert!(hourglass > 0.0 && hourglass < 0.1 * internal, "hourglass {hourglass} of {internal}");
}
