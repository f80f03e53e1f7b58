//! Rigid planes of any orientation.

use super::mesh::{elastic, grid, ground};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::model::RigidPlane;

const GRAVITY: f64 = 9.81;

fn planes(list: &[RigidPlane]) -> RigidSurfaces {
    let mut surfaces = RigidSurfaces::default();
    surfaces.planes = list.to_vec();
    surfaces
}

fn plane(point_m: [f64; 3], normal: [f64; 3], friction: f64) -> RigidPlane {
    let size = normal.iter().map(|c| c * c).sum::<f64>().sqrt();
    RigidPlane { point_m, normal: normal.map(|c| c / size), friction, nodes: None }
}

fn mean(values: &[[f64; 3]], axis: usize) -> f64 {
    values.iter().map(|v| v[axis]).sum::<f64>() / values.len() as f64
}

/// On a slope of 30 degrees a block slides with `g (sin - μ cos)`; with more friction than the tangent, or with no slip, it stays.
#[test]
fn block_on_a_slope() {
    let (sin, cos) = (0.5, 0.75_f64.sqrt());
    for (friction, expected) in [(0.0, sin), (0.3, sin - 0.3 * cos), (0.7, 0.0), (f64::INFINITY, 0.0)] {
        let mut mesh = grid([3, 2, 2], [0.6, 0.4, 0.2], elastic(), |_| false);
        for p in &mut mesh.nodes {
            *p = [cos * p[0] + sin * p[2], p[1], -sin * p[0] + cos * p[2]];
        }
        let slope = plane([0.0; 3], [sin, 0.0, cos], friction);
        let mut body = Dynamics::new(&mesh, GRAVITY, planes(std::slice::from_ref(&slope)), false);
        let from = mean(&body.x, 0);
        let mut kinetic = 0.0;
        while body.time_s < 0.2 {
            kinetic = body.step(true);
        }
        let way = (mean(&body.x, 0) - from) / cos;
        let wanted = 0.5 * GRAVITY * expected * 0.04;
        assert!((way - wanted).abs() < 0.02 * wanted + 1e-4, "μ {friction}: {way} against {wanted}");
        for x in &body.x {
            let height: f64 = (0..3).map(|i| slope.normal[i] * x[i]).sum();
            assert!(height > -1e-9, "{x:?} is below the slope");
        }
        let stored: f64 = body.blocks.energies_j().iter().sum();
        let left = kinetic + stored - body.gravity_j - body.contact_j[0] - body.contact_j[1];
        assert!(left.abs() < 0.01 * body.gravity_j.max(1.0), "μ {friction}: {left} of {} J", body.gravity_j);
    }
}

/// A level plane does what the ground does, to round-off, and one that stops no node does nothing.
#[test]
fn level_plane_is_ground() {
    let mesh = grid([3, 3, 3], [0.6, 0.6, 0.6], elastic(), |_| false);
    let run = |surfaces: RigidSurfaces| {
        let mut body = Dynamics::new(&mesh, GRAVITY, surfaces, false);
        body.v.iter_mut().for_each(|v| *v = [1.0, 0.0, -3.0]);
        (0..600).for_each(|_| {
            body.step(false);
        });
        body
    };
    let (first, second) =
        (run(ground(-0.01, 0.4)), run(planes(&[plane([0.0, 0.0, -0.01], [0.0, 0.0, 1.0], 0.4)])));
    for (a, b) in first.x.iter().zip(&second.x) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-9), "{a:?} {b:?}");
    }
    assert!(
        (first.contact_j[0] / second.contact_j[0] - 1.0).abs() < 1e-6,
        "{:?} {:?}",
        first.contact_j,
        second.contact_j
    );
    let mut none = plane([0.0, 0.0, -0.01], [0.0, 0.0, 1.0], 0.4);
    none.nodes = Some(Vec::new());
    let through = run(planes(&[none]));
    assert!(through.contact_j == [0.0; 2] && mean(&through.x, 2) < mean(&first.x, 2) - 0.01);
}

/// Nodes held in one direction, as in a plane of symmetry, are stopped in the others.
#[test]
fn plane_of_symmetry_meets_a_wall() {
    let mesh = grid([2, 2, 4], [0.2, 0.2, 0.8], elastic(), |_| false);
    let mut body =
        Dynamics::new(&mesh, 0.0, planes(&[plane([0.0, 0.0, -0.001], [0.0, 0.0, 1.0], 0.0)]), false);
    for n in 0..mesh.nodes.len() {
        if mesh.nodes[n][0] == 0.0 {
            body.prescribed_m_s[n][0] = Some(0.0);
        }
        body.v[n][2] = -2.0;
    }
    let start = body.kinetic_j();
    let mut kinetic = 0.0;
    for _ in 0..200 {
        kinetic = body.step(true);
        for (x, at) in body.x.iter().zip(&mesh.nodes) {
            assert!(x[2] > -0.001 - 1e-12, "{at:?} is at {x:?}");
            assert!(at[0] != 0.0 || x[0] == 0.0);
        }
    }
    let stored: f64 = body.blocks.energies_j().iter().sum();
    let left = kinetic + stored - start - body.contact_j[0] - body.driven_j;
    assert!(body.contact_j[0] < 0.0 && left.abs() < 1e-2 * start, "{left} of {start} J");
}
