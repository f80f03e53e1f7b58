//! The rate factor of Cowper and Symonds at constant strain rates.

use super::elements::{ADS, ASQBI, FULL};
use super::mesh::{bilinear, hexahedron, of_hexahedra};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::kernel::KernelStep;
use fallwerk::fe::law::{CowperSymonds, Law};
use fallwerk::fe::mesh::{Mesh, Truss};

const YIELD_PA: f64 = 235e6;
const RATE: CowperSymonds = CowperSymonds { c_1_s: 40.4, p: 5.0 };

fn law() -> Law {
    Law { rate: Some(RATE), ..bilinear(200e9, 0.3, 7850.0, YIELD_PA, 0.0) }
}

/// Flow stress at a plastic strain rate.
fn expected_pa(rate_1_s: f64) -> f64 {
    YIELD_PA * (1.0 + (rate_1_s / RATE.c_1_s).powf(1.0 / RATE.p))
}

/// Isochoric stretching to 2 % in 400 steps: in steady flow the plastic rate is the whole rate. Von Mises stress at the end.
fn stretched_pa(form: fallwerk::fe::law::ElementForm, rate_1_s: f64, viscous: bool) -> f64 {
    let nodes = hexahedron(0.1, 2).to_vec();
    let mesh = of_hexahedra(nodes, vec![[0, 1, 2, 3, 4, 5, 6, 7]], Law { form, ..law() }, Vec::new());
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let strain = 5e-5;
    for _ in 0..400 {
        for n in 0..8 {
            // mid-step gradient diag(1, -1/2, -1/2) * strain
            let grow = |i: usize| {
                let e: f64 = if i == 0 { strain } else { -0.5 * strain };
                (1.0 + 0.5 * e) / (1.0 - 0.5 * e) - 1.0
            };
            body.v[n] = std::array::from_fn(|i| grow(i) * body.x[n][i]);
            body.x[n] = std::array::from_fn(|i| body.x[n][i] + body.v[n][i]);
        }
        body.update_elements(KernelStep { dt_s: strain / rate_1_s, viscous }, 1.0);
    }
    let s = body.blocks.blocks[0].state.stress.map(|s| s[0]);
    let (a, b, c) = (s[0] - s[1], s[1] - s[2], s[2] - s[0]);
    (0.5 * (a * a + b * b + c * c) + 3.0 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])).sqrt()
}

#[test]
fn flow_stress_at_constant_rate() {
    for form in [ASQBI, ADS, FULL] {
        for rate in [1e-3, 1.0, 40.4, 1e4] {
            let (got, exact) = (stretched_pa(form, rate, true), expected_pa(rate));
            assert!((got / exact - 1.0).abs() < 1e-4, "{form:?} at {rate}/s: {got} {exact}");
        }
        let still = stretched_pa(form, 1e4, false);
        assert!((still / YIELD_PA - 1.0).abs() < 1e-9, "a static step has no rate: {still}");
    }
}

#[test]
fn flow_stress_of_a_bar_at_constant_rate() {
    let mesh = Mesh {
        nodes: vec![[0.0; 3], [1.0, 0.0, 0.0]],
        trusses: vec![Truss { nodes: [0, 1], area_m2: 1e-4, part: 0, law: 0 }],
        laws: vec![law()],
        ..Mesh::default()
    };
    for rate in [1e-3, 1.0, 40.4, 1e4] {
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        for step in 1..=400 {
            body.x[1][0] = (5e-5 * f64::from(step)).exp();
            let step = KernelStep { dt_s: 5e-5 / rate, viscous: true };
            body.trusses.update(&body.x, step, None, &mut [[0.0; 3]; 2]);
        }
        let got = body.trusses.bars[0].stress_pa;
        assert!((got / expected_pa(rate) - 1.0).abs() < 1e-6, "at {rate}/s: {got}");
    }
}
