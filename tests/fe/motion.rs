//! Conservation in free motion, and the same bytes from any number of threads.

use super::mesh::{bilinear, elastic, grid, ground};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::verify::fe::body::momenta;

/// A block set spinning at 180 rad/s about a skew axis for more than a turn, with strong elastic vibration.
#[test]
fn free_spinning_block_conserves_momentum_and_energy() {
    let mut mesh = grid([3, 3, 4], [0.6, 0.6, 1.2], elastic(), |_| false);
    super::mesh::distort(&mut mesh.nodes, 0.03, 5, |_| true);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let (spin, drift) = ([90.0, -120.0, 100.0], [1.0, 2.0, -3.0]);
    for n in 0..body.x.len() {
        let x = body.x[n];
        body.v[n] = std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            drift[i] + spin[j] * x[k] - spin[k] * x[j]
        });
    }
    let start = momenta(&body);
    let kinetic = body.kinetic_j();
    let energy = (0..1500).fold(0.0, |_, _| body.step(true) + body.blocks.energies_j().iter().sum::<f64>());
    assert!((energy / kinetic - 1.0).abs() < 1e-5, "energy {energy} of {kinetic}");
    let end = momenta(&body);
    for kind in 0..2 {
        let size = start[kind].iter().map(|c| c * c).sum::<f64>().sqrt();
        for i in 0..3 {
            assert!((end[kind][i] - start[kind][i]).abs() < 1e-10 * size, "{kind} {i}: {start:?} {end:?}");
        }
    }
    assert!(
        body.blocks.energies_j()[0] > 1e-5 * kinetic,
        "the block vibrates: {:?}",
        body.blocks.energies_j()
    );
}

/// A plastic block falls on rough ground with a run of erosion; bits of all positions after 400 steps.
fn fallen(parallel: bool) -> Vec<[u64; 3]> {
    let mut law = bilinear(30e9, 0.2, 2500.0, 2e6, 0.0);
    law.erosion.plastic_strain = 0.02;
    let mesh = grid([6, 10, 12], [0.6, 1.0, 1.2], law, |_| false);
    let surfaces = ground(-0.001, 0.5);
    let mut body = Dynamics::new(&mesh, 9.81, surfaces, parallel);
    body.v.iter_mut().zip(&mesh.nodes).for_each(|(v, x)| *v = [2.0 + x[2], x[0], -20.0]);
    let mut deaths = 0;
    for _ in 0..400 {
        body.step(false);
        deaths += body.deaths.len();
    }
    assert!(
        deaths > 0 && deaths < mesh.elements.len() && body.contact_j[0] < 0.0,
        "{deaths} {:?}",
        body.contact_j
    );
    let mut bits: Vec<[u64; 3]> = body.x.iter().map(|x| x.map(f64::to_bits)).collect();
    bits.push([body.gravity_j.to_bits(), body.contact_j[0].to_bits(), body.contact_j[1].to_bits()]);
    bits
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let serial = fallen(false);
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        assert!(pool.install(|| fallen(true)) == serial, "{threads} threads");
    }
    assert!(fallen(true) == serial, "from outside the pool");
}
