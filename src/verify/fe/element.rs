//! Elements: patch test, finite rotation, dead load.

use super::body::{deform, nodes_where};
use super::forms::{FORMS, TestedForm};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::mesh::Mesh;
use crate::fe::preload::equilibrate;
use crate::fe::shapes::{distort, elastic, grid, nearest};
use crate::verify::rotation::rotation;
use crate::verify::{Case, Figure};
use nalgebra::Vector3;

const YOUNG_PA: f64 = 30e9;
const SHEAR_PA: f64 = 12.5e9;
const LAME_PA: f64 = YOUNG_PA * 0.2 / (1.2 * 0.6);
const EXACT: &str = "exact";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    for form in FORMS {
        cases.push(Case::short(
            format!("patch-test-{}", form.name),
            "A linear displacement field (strains about 3e-5) on a cube of 27 distorted elements: uniform stress, no force \
             inside, no hourglass energy (Irons' patch test).",
            || patch_test(form),
        ));
        cases.push(Case::short(
            format!("finite-rotation-{}", form.name),
            "A cube of 8 distorted elements turns once about a skew axis in 36 increments, unstrained and stretched by 0.1 %.",
            || finite_rotation(form),
        ));
    }
    cases.push(Case::short(
        "dead-load-column",
        "A clamped column 0.5 x 0.5 x 6 m (E 30 GPa, ν 0, 2500 kg/m³) under its own weight, static solve, then 500 time steps.",
        dead_load_column,
    ));
    cases
}

fn distorted(counts: usize, form: &TestedForm) -> Mesh {
    let mut mesh = grid([counts; 3], [1.0; 3], form.law(elastic()), |_| false);
    distort(&mut mesh.nodes, 0.24 / counts as f64, 7, inside);
    mesh
}

fn inside(p: [f64; 3]) -> bool {
    p.iter().all(|c| *c > 0.01 && *c < 0.99)
}

fn patch_test(form: &TestedForm) -> Result<Vec<Figure>, String> {
    let mesh = distorted(3, form);
    let inner: Vec<usize> = {
        let regular = grid([3; 3], [1.0; 3], elastic(), |_| false);
        nodes_where(&regular, inside)
    };
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let slope = [[2e-5, 1e-5, -3e-5], [0.5e-5, -1e-5, 2e-5], [1e-5, 4e-5, 3e-5]];
    deform(&mut body, |n| {
        let x = mesh.nodes[n];
        std::array::from_fn(|i| x[i] + (0..3).map(|j| slope[i][j] * x[j]).sum::<f64>())
    });
    let trace: f64 = (0..3).map(|i| slope[i][i]).sum();
    let (mut energy, mut stress) = (0.5 * LAME_PA * trace * trace, 0.0_f64);
    for i in 0..3 {
        for j in 0..3 {
            let strain = 0.5 * (slope[i][j] + slope[j][i]);
            energy += SHEAR_PA * strain * strain;
            stress = stress.max((2.0 * SHEAR_PA * strain).abs() + LAME_PA * trace.abs());
        }
    }
    let [internal, hourglass, _] = body.blocks.energies_j();
    let force = inner.iter().flat_map(|n| body.internal_n(*n)).fold(0.0, |a: f64, f| a.max(f.abs()));
    let per_face = force / (stress / 9.0);
    Ok(vec![
        Figure::relative("elastic energy", "J", [energy, internal], 2e-4, "small strains"),
        Figure::absolute("largest inner force over stress x face", "-", [0.0, per_face], 1e-9, EXACT),
        Figure::absolute("hourglass over elastic energy", "-", [0.0, hourglass / internal], 1e-12, EXACT),
    ])
}

fn finite_rotation(form: &TestedForm) -> Result<Vec<Figure>, String> {
    let mesh = distorted(2, form);
    let axis = Vector3::new(1.0, 2.0, -1.5).normalize();
    let turn = |stretch: f64| {
        let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
        let place = |n: usize, angle: f64| {
            let x = mesh.nodes[n];
            let stretched = Vector3::new(x[0] * (1.0 + stretch), x[1], x[2]);
            <[f64; 3]>::from(rotation(angle * axis) * stretched)
        };
        deform(&mut body, |n| place(n, 0.0));
        let forces = |body: &Dynamics| (0..body.x.len()).map(|n| body.internal_n(n)).collect::<Vec<_>>();
        let before = forces(&body);
        for step in 1..=36 {
            deform(&mut body, |n| place(n, std::f64::consts::TAU * f64::from(step) / 36.0));
        }
        let largest = |f: &mut dyn Iterator<Item = f64>| f.fold(0.0, |a: f64, b| a.max(b.abs()));
        let after = forces(&body);
        let differences = after.iter().zip(&before);
        let change = largest(&mut differences.flat_map(|(a, b)| (0..3).map(|i| a[i] - b[i])));
        (change, largest(&mut before.iter().flatten().copied()))
    };
    let (free, _) = turn(0.0);
    let (changed, stretched) = turn(1e-3);
    let over_stiffness = free / (YOUNG_PA * 0.25);
    Ok(vec![
        Figure::absolute("largest force, unstrained, over E h²", "-", [0.0, over_stiffness], 1e-12, EXACT),
        Figure::absolute("change of forces, stretched", "-", [0.0, changed / stretched], 1e-10, EXACT),
    ])
}

fn dead_load_column() -> Result<Vec<Figure>, String> {
    let law = crate::fe::law::Law { poisson_ratio: 0.0, ..elastic() };
    let mesh = grid([2, 2, 12], [0.5, 0.5, 6.0], law, |p| p[2] == 0.0);
    let mut body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    equilibrate(&mut body)?;
    let weight = 2500.0 * 9.81 * 0.25 * 6.0;
    let top = nearest(&mesh, [0.25, 0.25, 6.0]);
    let sunk = 6.0 - body.x[top][2];
    let reaction: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * 9.81).sum();
    for _ in 0..500 {
        body.step(false);
    }
    let moved = (6.0 - body.x[top][2] - sunk) / sunk;
    let expected = 2500.0 * 9.81 * 36.0 / (2.0 * YOUNG_PA);
    Ok(vec![
        Figure::relative("settlement of the top", "m", [expected, sunk], 1e-3, "ρ g L² / (2 E)"),
        Figure::relative("vertical reaction", "N", [weight, reaction], 1e-8, "weight"),
        Figure::absolute("motion over 500 steps, of the settlement", "-", [0.0, moved], 1e-6, "equilibrium"),
    ])
}
