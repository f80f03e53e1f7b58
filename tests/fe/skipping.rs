//! What the time loop leaves out, and that leaving it out changes nothing.

use super::mesh::{elastic, grid};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;

/// A long bar clamped at one end: a push on the other end travels into parts that have been at rest until then.
fn pushed_bar(skip_quiet: bool) -> Dynamics {
    let mesh = grid([256, 4, 4], [128.0, 2.0, 2.0], elastic(), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    body.skip_quiet = skip_quiet;
    for n in (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] > 112.0) {
        body.v[n] = [-0.5, 0.0, 0.0];
    }
    for _ in 0..150 {
        body.step(false);
    }
    body
}

#[test]
fn chunks_that_stand_still_are_skipped_without_a_trace() {
    let (all, some) = (pushed_bar(false), pushed_bar(true));
    assert_eq!(all.blocks.skipped(), 0);
    let mut packed = some.clone();
    (0..2048).for_each(|e| packed.blocks.set_share(e, 0.0));
    packed.blocks.repack_if_worthwhile(&packed.x);
    assert_eq!((packed.blocks.skipped(), packed.blocks.skipped_in_all()), (0, some.blocks.skipped()));
    let share = some.blocks.skipped() as f64 / (150.0 * 4096.0);
    assert!(share > 0.3, "the wave has reached less than half of the bar, yet only {share:.2} was skipped");
    let moved = (0..all.x.len()).map(|n| all.v[n][0].abs()).fold(0.0, f64::max);
    assert!(moved > 0.1);
    assert_eq!((all.x, all.v), (some.x, some.v));
}

/// Packing acting elements together moves their histories; the forces stay, up to the order of sums.
#[test]
fn packing_anew_changes_no_force() {
    let mesh = grid([12, 6, 6], [6.0, 3.0, 3.0], elastic(), |p| p[0] == 0.0);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    for _ in 0..40 {
        body.step(false);
    }
    for e in (0..mesh.elements.len()).filter(|e| e % 3 == 0) {
        body.blocks.set_share(e, 0.0);
    }
    let mut packed = body.clone();
    packed.blocks.repack_if_worthwhile(&packed.x);
    let acting = |b: &Dynamics| b.blocks.blocks.iter().filter(|b| b.acts).count();
    assert!(acting(&packed) < acting(&body), "{} {}", acting(&packed), acting(&body));
    for _ in 0..3 {
        body.step(false);
        packed.step(false);
    }
    for e in 0..mesh.elements.len() {
        assert_eq!(body.blocks.share(e), packed.blocks.share(e));
        assert!((body.blocks.internal_j(e) - packed.blocks.internal_j(e)).abs() < 1e-9);
    }
    for n in 0..mesh.nodes.len() {
        let (a, b) = (body.internal_n(n), packed.internal_n(n));
        for i in 0..3 {
            assert!((a[i] - b[i]).abs() < 1e-6, "node {n}: {a:?} {b:?}");
        }
    }
}
