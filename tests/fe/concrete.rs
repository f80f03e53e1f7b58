//! Elements of concrete: what a bar of them bears and dissipates in tension and compression, packing, hourglass work.

use super::mesh::grid;
use fallwerk::fe::concrete::ConcretePoints;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::law::Law;
use fallwerk::fe::mesh::Mesh;
use fallwerk::material::concrete::ConcreteLaw;

fn law(concrete: &ConcreteLaw) -> Law {
    Law::from(concrete.clone())
}

/// A cube on a plane, its top moved at a constant speed, sides free; the force at the base is a mean over steps. Returns the largest stress \[Pa\], the
/// work per area \[J/m²\], and the hourglass work over it.
fn pulled(concrete: &ConcreteLaw, edge_m: f64, speed_m_s: f64, until_m: f64) -> (f64, f64, f64) {
    let mesh = grid([1, 1, 1], [edge_m; 3], law(concrete), |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for (n, x) in mesh.nodes.iter().enumerate() {
        let held = &mut body.prescribed_m_s[n];
        held[2] = Some(if x[2] > 0.0 { speed_m_s } else { 0.0 });
        // no rigid motion across: the planes through the origin are planes of symmetry
        for axis in (0..2).filter(|a| x[*a] == 0.0) {
            held[axis] = Some(0.0);
        }
    }
    body.damping_1_s = 100.0;
    let (mut peak, mut work, mut moved) = (0.0f64, 0.0, 0.0);
    while moved < until_m {
        body.step(false);
        moved += body.dt_s * speed_m_s.abs();
        let top = (0..8).filter(|n| mesh.nodes[*n][2] > 0.0);
        let stress = top.map(|n| body.internal_n(n)[2]).sum::<f64>() / (edge_m * edge_m);
        peak = peak.max(stress.abs());
        work += stress.abs() * body.dt_s * speed_m_s.abs();
    }
    let [internal, hourglass, _] = body.blocks.energies_j();
    assert!(internal > 0.0);
    (peak, work, hourglass.abs() / internal)
}

#[test]
fn a_cube_breaks_at_its_tensile_strength_and_dissipates_the_fracture_energy() {
    let concrete = ConcreteLaw::of_strength(30e6);
    for edge_m in [0.05, 0.1] {
        let (peak, work, hourglass) = pulled(&concrete, edge_m, 0.004, 4.5e-4);
        assert!((peak / concrete.tensile_strength_pa - 1.0).abs() < 0.02, "{edge_m}: {peak}");
        assert!((work / concrete.fracture_energy_j_m2 - 1.0).abs() < 0.04, "{edge_m}: {work}");
        assert!(hourglass < 1e-6, "{hourglass}");
    }
}

#[test]
fn a_cube_crushes_at_its_compressive_strength_and_dissipates_the_crushing_energy() {
    let concrete = ConcreteLaw::of_strength(30e6);
    let (peak, work, hourglass) = pulled(&concrete, 0.1, -0.01, 6.0e-3);
    assert!((peak / concrete.compressive_strength_pa - 1.0).abs() < 0.02, "{peak}");
    assert!((work / concrete.crushing_energy_j_m2 - 1.0).abs() < 0.06, "{work}");
    assert!(hourglass < 1e-6, "{hourglass}");
}

#[test]
fn elements_too_long_for_their_energies_are_refused_with_the_length_that_would_do() {
    let concrete = ConcreteLaw { crushing_energy_j_m2: 5e3, ..ConcreteLaw::of_strength(30e6) };
    let mesh: Mesh = grid([1, 1, 1], [0.4; 3], law(&concrete), |_| false);
    let error = ConcretePoints::of(&mesh).expect_err("0.4 m is too long").to_string();
    assert!(error.contains("0.4") && error.contains("crushing energy"), "{error}");
}
