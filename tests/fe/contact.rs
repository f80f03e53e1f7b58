//! Rigid ground and boxes: friction and energy booking.

use super::mesh::{elastic, grid, ground};
use fallwerk::base::geom::Aabb;
use fallwerk::fe::dynamics::Dynamics;

const GRAVITY: f64 = 9.81;

fn balance(body: &Dynamics, kinetic: f64, start: f64) -> f64 {
    let stored: f64 = body.blocks.energies_j().iter().sum();
    kinetic + stored - start - body.gravity_j - body.contact_j[0] - body.contact_j[1] - body.driven_j
}

/// Stopping distance `v² / (2 μ g)`.
#[test]
fn sliding_block_stops_where_friction_says() {
    let mesh = grid([3, 2, 2], [0.6, 0.4, 0.2], elastic(), |_| false);
    let surfaces = ground(0.0, 0.4);
    let mut body = Dynamics::new(&mesh, GRAVITY, surfaces, false);
    body.v.iter_mut().for_each(|v| v[0] = 0.5);
    let start = body.kinetic_j();
    let mut kinetic = 0.0;
    while body.time_s < 0.25 {
        kinetic = body.step(true);
    }
    let travelled = body.x.iter().map(|x| x[0]).sum::<f64>() / body.x.len() as f64 - 0.3;
    let expected = 0.25 / (2.0 * 0.4 * GRAVITY);
    assert!((travelled / expected - 1.0).abs() < 0.03, "{travelled} against {expected}");
    assert!(kinetic < 1e-3 * start, "it rests: {kinetic} J");
    assert!(
        (body.contact_j[1] / -start - 1.0).abs() < 0.05,
        "friction took {:?} of {start} J",
        body.contact_j
    );
    assert!(balance(&body, kinetic, start).abs() < 0.01 * start);
}

/// A block dropped by 0.2 m onto the edge of a box and the ground: nothing sinks in, every joule is booked.
#[test]
fn falling_block_books_its_energy() {
    let mesh = grid([4, 3, 3], [0.8, 0.6, 0.6], elastic(), |_| false);
    let step = Aabb { min: [-1.0, -1.0, -2.0], max: [0.3, 2.0, -0.2] };
    let mut surfaces = ground(-0.3, 0.5);
    surfaces.boxes.push((step, 0.3));
    let mut body = Dynamics::new(&mesh, GRAVITY, surfaces, false);
    let scale = body.mass_kg.iter().sum::<f64>() * GRAVITY * 0.2;
    let mut worst: f64 = 0.0;
    while body.time_s < 0.5 {
        let kinetic = body.step(true);
        worst = worst.max(balance(&body, kinetic, 0.0).abs());
        for x in &body.x {
            assert!(x[2] > -0.3 - 1e-9, "below the ground: {x:?}");
            assert!(x[0] > 0.3 - 1e-9 || x[2] > -0.2 - 1e-9, "in the box: {x:?}");
        }
    }
    assert!(worst < 0.01 * scale, "{worst} of {scale} J");
    assert!(body.contact_j[0] < 0.0 && body.contact_j[1] < 0.0, "{:?}", body.contact_j);
    assert!(body.surfaces.new_touches.iter().any(|t| t.1 == 1), "the box was hit");
}
