//! Dynamic relaxation beside the sparse solve; faces tied to faces.

use crate::fe::apart::{Faces, outer_faces};
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::law::Law;
use crate::fe::mesh::Mesh;
use crate::fe::preload::equilibrate;
use crate::fe::relaxation::{Limits, relax};
use crate::fe::shapes::{elastic, grid, nearest};
use crate::verify::{Case, Figure};

const GRAVITY_M_S2: f64 = 9.81;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "dynamic-relaxation",
            "A cantilever 4 x 0.5 x 0.5 m under its own weight: state at rest by dynamic relaxation beside that of the sparse solve.",
            relaxation,
        ),
        Case::short(
            "tied-patch-nested",
            "Two blocks 2 x 1 x 1 m drawn at 10 kPa, 4x2x2 and 8x4x4 elements, the finer tied to the coarser: uniform stress.",
            || patch([4, 2, 2], [8, 4, 4], 1e-6),
        ),
        Case::short(
            "tied-patch-2-3",
            "The same with 4x2x2 and 6x3x3 elements, where no node of one side is a node of the other: uniform but for the interface.",
            || patch([4, 2, 2], [6, 3, 3], 0.03),
        ),
        Case::short(
            "tied-cantilever",
            "Cantilever 10 x 1 x 1 m whose halves, two and three elements deep, are tied: deflection under its own weight.",
            tied_cantilever,
        ),
    ]
}

fn relaxation() -> Result<Vec<Figure>, String> {
    let mesh = grid([8, 2, 2], [4.0, 0.5, 0.5], elastic(), |p| p[0] == 0.0);
    let mut solved = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    let mut relaxed = solved.clone();
    equilibrate(&mut solved)?;
    let found = relax(&mesh, &mut relaxed, Limits::default()).map_err(|e| e.to_string())?;
    let sunk =
        |body: &Dynamics| (0..mesh.nodes.len()).map(|n| mesh.nodes[n][2] - body.x[n][2]).fold(0.0, f64::max);
    let apart = |n: usize| (0..3).map(|i| (relaxed.x[n][i] - solved.x[n][i]).abs()).fold(0.0, f64::max);
    let furthest = (0..mesh.nodes.len()).map(apart).fold(0.0, f64::max);
    let stored = |body: &Dynamics| body.blocks.energies_j().iter().sum::<f64>();
    let sparse = "sparse solve";
    Ok(vec![
        Figure::relative("largest deflection", "m", [sunk(&solved), sunk(&relaxed)], 1e-3, sparse),
        Figure::absolute("largest difference over it", "-", [0.0, furthest / sunk(&solved)], 1e-3, sparse),
        Figure::relative("stored energy", "J", [stored(&solved), stored(&relaxed)], 5e-3, sparse),
        Figure::absolute(
            "forces out of balance",
            "-",
            [0.0, found.residual],
            Limits::default().residual,
            "limit",
        ),
    ])
}

/// Two blocks of `length_m` x 1 x 1 m along x, the second tied to the first.
fn pair(counts: [[usize; 3]; 2], length_m: f64, law: &Law) -> Result<Mesh, String> {
    let size = [length_m, 1.0, 1.0];
    let mut mesh = grid(counts[0], size, law.clone(), |p| p[0] == 0.0);
    let faces = Faces::of(&mesh, outer_faces(&mesh));
    let other = grid(counts[1], size, law.clone(), |_| false);
    let offset = mesh.nodes.len();
    mesh.nodes.extend(other.nodes.iter().map(|p| [p[0] + length_m, p[1], p[2]]));
    for mut element in other.elements {
        element.nodes = element.nodes.map(|n| n + offset);
        mesh.elements.push(element);
    }
    for node in (offset..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == length_m) {
        let tie = faces.nearest(&mesh, node, 1e-6, false).ok_or("a node lies on no face")?;
        mesh.ties.push(tie);
    }
    Ok(mesh)
}

fn patch(first: [usize; 3], second: [usize; 3], tolerance: f64) -> Result<Vec<Figure>, String> {
    const TRACTION_PA: f64 = 1e4;
    let law = Law { poisson_ratio: 0.0, ..elastic() };
    let mesh = pair([first, second], 2.0, &law)?;
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    for n in (0..mesh.nodes.len()).filter(|n| mesh.nodes[*n][0] == 4.0) {
        let share = |i: usize| {
            let edge = mesh.nodes[n][i] < 1e-9 || mesh.nodes[n][i] > 1.0 - 1e-9;
            if edge { 0.5 / second[i] as f64 } else { 1.0 / second[i] as f64 }
        };
        body.applied_n[n][0] = TRACTION_PA * share(1) * share(2);
    }
    equilibrate(&mut body)?;
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[0]).sum();
    let per_m = TRACTION_PA / law.youngs_modulus_pa;
    let off = |n: usize| {
        let exact = [per_m * mesh.nodes[n][0], 0.0, 0.0];
        (0..3).map(|i| (body.x[n][i] - mesh.nodes[n][i] - exact[i]).abs()).fold(0.0, f64::max)
    };
    let largest = (0..mesh.nodes.len()).map(off).fold(0.0, f64::max) / (4.0 * per_m);
    Ok(vec![
        Figure::relative("reaction", "N", [-TRACTION_PA, held], 1e-6, "force passed on"),
        Figure::absolute("largest deviation over the elongation", "-", [0.0, largest], tolerance, "σ x / E"),
    ])
}

fn tied_cantilever() -> Result<Vec<Figure>, String> {
    let mesh = pair([[10, 2, 2], [15, 3, 3]], 5.0, &elastic())?;
    let mut body = Dynamics::new(&mesh, GRAVITY_M_S2, RigidSurfaces::default(), false);
    equilibrate(&mut body)?;
    let load = 2500.0 * GRAVITY_M_S2;
    let expected = load * 1e4 / (8.0 * 30e9 / 12.0) + load * 100.0 / (2.0 * 5.0 / 6.0 * 12.5e9);
    let tip = nearest(&mesh, [10.0, 0.5, 0.5]);
    let sunk = mesh.nodes[tip][2] - body.x[tip][2];
    let held: f64 = mesh.fixed.iter().map(|n| body.internal_n(*n)[2] + body.mass_kg[*n] * GRAVITY_M_S2).sum();
    Ok(vec![
        Figure::relative("tip deflection", "m", [expected, sunk], 0.02, "beam theory with shear, κ = 5/6"),
        Figure::relative("reaction", "N", [10.0 * load, held], 1e-8, "weight"),
    ])
}
