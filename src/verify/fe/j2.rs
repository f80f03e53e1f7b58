//! Plasticity: hardening over the kinks of a table, radial return on a turning strain path, a bar in tension.

use super::body::deform;
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::law::Law;
use crate::fe::mesh::Mesh;
use crate::fe::shapes::{bilinear, elastic, grid, point};
use crate::verify::{Case, Figure};

const SHEAR_PA: f64 = 12.5e9;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "uniaxial-strain",
            "One element strained along x to 20 % in 400 increments, with a table that hardens, softens and ends flat: \
             the stress lies on the table across its kinks.",
            uniaxial_strain,
        ),
        Case::short(
            "turning-strain-path",
            "One perfectly plastic element strained in tension to yield, then sheared: the stress turns on the yield surface \
             (exact solution of the J2 rate equations at constant strain rate); 200 increments.",
            turning_path,
        ),
        Case::short(
            "plastic-bar",
            "A bar 4 x 1 x 1 m of four elements drawn slowly to 3 %, hardening table with a kink at 1 %: force and plastic \
             strain at two elongations.",
            plastic_bar,
        ),
    ]
}

fn cube(law: Law) -> (Mesh, Dynamics) {
    let mesh = grid([1; 3], [1.0; 3], law, |_| false);
    let body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    (mesh, body)
}

/// Force along `i` on the face of the cube whose undeformed normal is `+j` \[N\].
fn face_force(mesh: &Mesh, body: &Dynamics, i: usize, j: usize) -> f64 {
    (0..8).filter(|n| mesh.nodes[*n][j] == 1.0).map(|n| body.internal_n(n)[i]).sum()
}

fn uniaxial_strain() -> Result<Vec<Figure>, String> {
    let table = [point(0.0, 15e6), point(0.01, 16.5e6), point(0.1, 12e6)];
    let yield_pa = |p: f64| match p {
        p if p < 0.01 => 15e6 + 150e6 * p,
        p if p < 0.1 => 16.5e6 - 50e6 * (p - 0.01),
        _ => 12e6,
    };
    let (mesh, mut body) = cube(Law { hardening: table.to_vec(), ..elastic() });
    let (mut worst, mut stretch) = (0.0_f64, 1.0);
    for step in 1..=400 {
        stretch = 1.0 + 5e-4 * f64::from(step);
        deform(&mut body, |n| [stretch * mesh.nodes[n][0], mesh.nodes[n][1], mesh.nodes[n][2]]);
        let mises = face_force(&mesh, &body, 0, 0) - face_force(&mesh, &body, 1, 1) / stretch;
        let p = body.blocks.plastic_strain(0);
        if p > 0.0 {
            worst = worst.max((mises / yield_pa(p) - 1.0).abs());
        }
    }
    let p = body.blocks.plastic_strain(0);
    // beyond the last kink: 2 G ε - 3 G p = 12 MPa with the logarithmic strain ε
    let expected = (2.0 * SHEAR_PA * libm::log(stretch) - 12e6) / (3.0 * SHEAR_PA);
    Ok(vec![
        Figure::absolute(
            "largest distance from the table, of the yield stress",
            "-",
            [0.0, worst],
            1e-9,
            "exact",
        ),
        Figure::relative("plastic strain at the end", "-", [expected, p], 1e-6, "2 G ε - 3 G p = σ_y(p)"),
    ])
}

/// With `u = 2 G |ė| t / R`, `R = sqrt(2/3) σ_y` and the angle ψ between stress deviator and strain rate at first a right one:
/// `cos ψ = tanh u`, `p = sqrt(2/3) R / (2 G) ln cosh u`.
fn turning_path() -> Result<Vec<Figure>, String> {
    const SOURCE: &str = "Krieg and Krieg, J. Pressure Vessel Technol. 99 (1977) 510";
    const YIELD_PA: f64 = 1e6;
    let radius = (2.0_f64 / 3.0).sqrt() * YIELD_PA;
    let (mesh, mut body) = cube(bilinear(30e9, 0.2, 2500.0, YIELD_PA, 0.0));
    let tension = YIELD_PA / (3.0 * SHEAR_PA);
    let along = 2.0_f64;
    // |ė| t of a shear γ is γ / sqrt(2)
    let shear = along * radius / (2.0 * SHEAR_PA) * 2.0_f64.sqrt();
    let place = |n: usize, gamma: f64| {
        let [x, y, z] = mesh.nodes[n];
        let half = 0.5 * gamma;
        [(1.0 + tension) * x + half * y, (1.0 - 0.5 * tension) * y + half * x, (1.0 - 0.5 * tension) * z]
    };
    deform(&mut body, |n| place(n, 0.0));
    for step in 1..=200 {
        deform(&mut body, |n| place(n, shear * f64::from(step) / 200.0));
    }
    let (s11, s22) = (face_force(&mesh, &body, 0, 0), face_force(&mesh, &body, 1, 1));
    let s33 = face_force(&mesh, &body, 2, 2);
    let deviator = s11 - (s11 + s22 + s33) / 3.0;
    let s12 = face_force(&mesh, &body, 0, 1);
    let exact =
        [radius * libm::tanh(along) / 2.0_f64.sqrt(), radius / libm::cosh(along) * (2.0_f64 / 3.0).sqrt()];
    let plastic = (2.0_f64 / 3.0).sqrt() * radius / (2.0 * SHEAR_PA) * libm::log(libm::cosh(along));
    Ok(vec![
        Figure::relative("shear stress", "Pa", [exact[0], s12], 0.005, SOURCE),
        Figure::relative("deviator left of the tension", "Pa", [exact[1], deviator], 0.02, SOURCE),
        Figure::relative("plastic strain", "-", [plastic, body.blocks.plastic_strain(0)], 0.005, SOURCE),
    ])
}

fn plastic_bar() -> Result<Vec<Figure>, String> {
    const YOUNG_PA: f64 = 30e9;
    let hardening = vec![point(0.0, 10e6), point(0.01, 12e6), point(0.05, 14e6)];
    let yield_pa = |p: f64| if p < 0.01 { 10e6 + 200e6 * p } else { 12e6 + 50e6 * (p - 0.01) };
    let mesh = grid([4, 1, 1], [4.0, 1.0, 1.0], Law { hardening, ..elastic() }, |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for n in 0..mesh.nodes.len() {
        // the velocity of uniform elongation at 0.1 1/s, lateral contraction of plastic flow
        let [x, y, z] = mesh.nodes[n];
        body.v[n] = [0.1 * x, -0.05 * (y - 0.5), -0.05 * (z - 0.5)];
        match x {
            0.0 => body.prescribed_m_s[n] = [Some(0.0), None, None],
            4.0 => body.prescribed_m_s[n] = [Some(0.4), None, None],
            _ => (),
        }
    }
    let end = (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == 4.0).collect::<Vec<_>>();
    let mut figures = Vec::new();
    for elongation in [0.005, 0.03] {
        while body.time_s < elongation / 0.1 {
            body.step(false);
        }
        let strain = libm::log(body.x[end[0]][0] / 4.0);
        let force: f64 = end.iter().map(|n| body.internal_n(*n)[0]).sum();
        // p + σ_y(p) / E = ε, and the section of a volume that grows by the elastic part only
        let mut p = strain;
        for _ in 0..50 {
            p = strain - yield_pa(p) / YOUNG_PA;
        }
        let lateral = 0.2 * yield_pa(p) / YOUNG_PA + 0.5 * p;
        let expected = yield_pa(p) * libm::exp(-2.0 * lateral);
        let name = |what: &str| format!("{what} at {:.1} %", 100.0 * elongation);
        figures.push(Figure::relative(name("force"), "N", [expected, force], 0.005, "σ_y(p) A"));
        let got = body.blocks.plastic_strain(1);
        figures.push(Figure::relative(
            name("plastic strain"),
            "-",
            [p, got],
            0.005,
            "p + σ_y(p) / E = ln(L / L0)",
        ));
    }
    Ok(figures)
}
