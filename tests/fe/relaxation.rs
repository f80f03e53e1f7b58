//! The dead-load state by dynamic relaxation.

use super::mesh::{bilinear, elastic, grid};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::preload;
use fallwerk::fe::relaxation::{Limits, RelaxationError, relax, static_state};

fn loaded(mesh: &Mesh) -> Dynamics {
    Dynamics::new(mesh, 9.81, RigidSurfaces::default(), false)
}

/// Vertical reaction over the weight.
fn reaction(mesh: &Mesh, body: &Dynamics) -> f64 {
    let gravity = -body.acceleration_m_s2[2];
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + gravity * body.mass_kg[*n]).sum();
    held / (gravity * body.mass_kg.iter().sum::<f64>())
}

/// Clamped beam of 8 m on both sides with a yield stress of `yield_pa`.
fn beam(yield_pa: f64, tangent_pa: f64) -> Mesh {
    let law = bilinear(30e9, 0.2, 2500.0, yield_pa, tangent_pa);
    grid([16, 2, 2], [8.0, 1.0, 1.0], law, |p| p[0] == 0.0 || p[0] == 8.0)
}

/// The difference that is left is that of the load paths: the incremental law turns its stress with the element, in one step or in twenty.
#[test]
fn matches_the_sparse_solve_of_an_elastic_structure() {
    for mesh in [
        grid([6, 2, 2], [3.0, 1.0, 1.0], elastic(), |p| p[0] == 0.0),
        grid([2, 2, 6], [1.0, 1.0, 3.0], elastic(), |p| p[2] == 0.0),
    ] {
        // a hundredth of the load, as that difference grows with the rotation: 1e-5 at 2.5 mm of a building
        let light = || Dynamics::new(&mesh, 0.0981, RigidSurfaces::default(), false);
        let (mut a, mut b) = (light(), light());
        preload::equilibrate(&mut a).unwrap();
        let limits = Limits { residual: 1e-9, ..Limits::default() };
        let relaxed = relax(&mesh, &mut b, limits).unwrap();
        println!("{relaxed:?}");
        assert_eq!(relaxed.yielded, 0);
        for (p, q) in a.x.iter().zip(&b.x) {
            for i in 0..3 {
                assert!((p[i] - q[i]).abs() < 1e-6 * relaxed.displacement_m, "{p:?} {q:?}");
            }
        }
        assert!((reaction(&mesh, &b) - 1.0).abs() < 1e-7, "{}", reaction(&mesh, &b));
        assert!(b.v.as_flattened().iter().all(|v| *v == 0.0));
    }
}

/// Local yielding: the state is in equilibrium, stays at rest in the dynamic run, and is that of a slowly applied load.
#[test]
fn yields_locally_and_stands() {
    let mesh = beam(0.35e6, 3e8);
    let mut body = loaded(&mesh);
    let relaxed = relax(&mesh, &mut body, Limits::default()).unwrap();
    println!("{relaxed:?}");
    assert!(relaxed.yielded > 0 && relaxed.yielded < mesh.elements.len(), "{relaxed:?}");
    assert!(relaxed.residual <= 1e-6);
    assert!((reaction(&mesh, &body) - 1.0).abs() < 1e-5, "{}", reaction(&mesh, &body));
    let mut slow = loaded(&mesh);
    preload::equilibrate(&mut slow).map_or_else(|e| println!("{e}"), |n| println!("{n} iterations"));
    let at_rest = body.x.clone();
    for _ in 0..1000 {
        body.step(false);
    }
    let moved = body.x.iter().zip(&at_rest).map(|(a, b)| (a[2] - b[2]).abs()).fold(0.0, f64::max);
    assert!(moved < 1e-4 * relaxed.displacement_m, "{moved}");
}

#[test]
fn what_cannot_stand_is_diagnosed() {
    let mesh = beam(0.1e6, 0.0);
    let mut body = loaded(&mesh);
    let error = relax(&mesh, &mut body, Limits::default()).unwrap_err();
    println!("{error}");
    assert!(matches!(&error, RelaxationError::Collapse { yielded, .. } if *yielded > 10), "{error}");
    let free = grid([4, 1, 1], [2.0, 0.5, 0.5], elastic(), |_| false);
    let error = relax(&free, &mut loaded(&free), Limits::default()).unwrap_err();
    println!("{error}");
    assert!(matches!(error, RelaxationError::Mechanism { .. }), "{error}");
    let mesh = beam(1e15, 0.0);
    let limits = Limits { cycles: 10, ..Limits::default() };
    let error = relax(&mesh, &mut loaded(&mesh), limits).unwrap_err();
    assert!(matches!(error, RelaxationError::Unfinished { cycles: 10, .. }), "{error}");
}

/// The relaxation steps in where the sparse solve finds nothing, from the unloaded state.
#[test]
fn static_state_falls_back() {
    let mesh = beam(1e15, 0.0);
    let found = static_state(&mesh, &mut loaded(&mesh)).unwrap();
    assert!(found.iterations > 0 && found.relaxed.is_none());
    let yielding = beam(0.25e6, 3e8);
    let mut body = loaded(&yielding);
    let found = static_state(&yielding, &mut body).unwrap();
    println!("{found:?}");
    assert!(found.iterations == 0 && found.relaxed.is_some_and(|r| r.yielded > 0), "{found:?}");
    assert!((reaction(&yielding, &body) - 1.0).abs() < 1e-5);
    let weak = beam(0.1e6, 0.0);
    let message = static_state(&weak, &mut loaded(&weak)).unwrap_err();
    assert!(message.contains("collapse under dead load"), "{message}");
}
