//! The dead-load state against closed forms.

use super::mesh::{bilinear, elastic, grid, nearest};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::preload::equilibrate;

fn at_rest(mesh: &Mesh) -> Dynamics {
    let mut body = Dynamics::new(mesh, 9.81, RigidSurfaces::default(), false);
    equilibrate(&mut body).unwrap();
    body
}

/// Vertical reaction: internal force on the fixed nodes and their own weight.
fn reaction(mesh: &Mesh, body: &Dynamics) -> f64 {
    mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * -body.acceleration_m_s2[2]).sum()
}

/// Column of 6 m: the top sinks by `ρ g L² / (2 E)`, the reaction is the weight, and it stays at rest.
#[test]
fn column_under_its_own_weight() {
    let mesh = grid([2, 2, 12], [0.5, 0.5, 6.0], bilinear(30e9, 0.0, 2500.0, 1e15, 0.0), |p| p[2] == 0.0);
    let mut body = at_rest(&mesh);
    let expected = 2500.0 * 9.81 * 36.0 / (2.0 * 30e9);
    let weight = 2500.0 * 9.81 * 0.25 * 6.0;
    let top = nearest(&mesh, [0.25, 0.25, 6.0]);
    let sunk = 6.0 - body.x[top][2];
    assert!((sunk / expected - 1.0).abs() < 1e-4, "{sunk} against {expected}");
    assert!((reaction(&mesh, &body) / weight - 1.0).abs() < 1e-8, "{}", reaction(&mesh, &body));
    let stored = body.blocks.energies_j()[0];
    let energy = weight * weight * 6.0 / (6.0 * 30e9 * 0.25);
    assert!((stored / energy - 1.0).abs() < 0.02, "{stored} against {energy} J");
    let before = body.x[top];
    for _ in 0..500 {
        body.step(false);
    }
    assert!((body.x[top][2] - before[2]).abs() < 1e-6 * expected, "it moves");
}

/// Cantilever of 10 m: `w L⁴ / (8 E I)` and shear `w L² / (2 κ G A)`, κ = 5/6.
#[test]
fn cantilever_under_its_own_weight() {
    for along in [20, 40] {
        let mesh = grid([along, along / 10, along / 10], [10.0, 1.0, 1.0], elastic(), |p| p[0] == 0.0);
        let body = at_rest(&mesh);
        let load = 2500.0 * 9.81;
        let expected = load * 1e4 / (8.0 * 30e9 / 12.0) + load * 100.0 / (2.0 * 5.0 / 6.0 * 12.5e9);
        let tip = nearest(&mesh, [10.0, 0.5, 0.5]);
        let sunk = 0.5 - body.x[tip][2];
        assert!((sunk / expected - 1.0).abs() < 0.01, "{along}: {sunk} against {expected}");
        assert!((reaction(&mesh, &body) / (load * 10.0) - 1.0).abs() < 1e-8);
    }
}

/// What cannot stand is said so.
#[test]
fn mechanism_and_collapse_load_are_errors() {
    let free = grid([2, 1, 1], [2.0, 1.0, 1.0], elastic(), |p| p == [0.0; 3]);
    let mut body = Dynamics::new(&free, 9.81, RigidSurfaces::default(), false);
    assert!(equilibrate(&mut body).is_err());
    let weak = grid([20, 2, 2], [10.0, 1.0, 1.0], bilinear(30e9, 0.2, 2500.0, 1e6, 0.0), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&weak, 9.81, RigidSurfaces::default(), false);
    let message = equilibrate(&mut body).unwrap_err();
    assert!(message.contains("yields"), "{message}");
}
