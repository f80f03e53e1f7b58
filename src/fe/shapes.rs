//! Small meshes and laws: box grids, a round bar, distorted nodes. Verification, benchmarks and tests build their models from them.

use super::contact::RigidSurfaces;
use super::law::{ElementForm, Erosion, Law};
use super::mesh::{Element, Mesh};
use crate::base::random::Random;
use crate::building::HardeningPoint;

/// A point of a hardening table.
pub fn point(plastic_strain: f64, stress_pa: f64) -> HardeningPoint {
    HardeningPoint { plastic_strain, stress_pa }
}

/// A law with a yield stress and a modulus over total strain (`H = E_t / (1 - E_t / E)` over plastic strain), without erosion.
pub fn bilinear(
    youngs_modulus_pa: f64,
    poisson_ratio: f64,
    density_kg_m3: f64,
    yield_pa: f64,
    tangent_pa: f64,
) -> Law {
    let hardening_pa = tangent_pa / (1.0 - tangent_pa / youngs_modulus_pa);
    let hardening = if hardening_pa == 0.0 {
        vec![point(0.0, yield_pa)]
    } else {
        vec![point(0.0, yield_pa), point(100.0, yield_pa + 100.0 * hardening_pa)]
    };
    Law {
        concrete: None,
        rebar: None,
        density_kg_m3,
        youngs_modulus_pa,
        poisson_ratio,
        hardening,
        rate: None,
        erosion: Erosion::NEVER,
        form: ElementForm::default(),
    }
}

/// Concrete that never yields: 30 GPa, 0.2, 2500 kg/m³.
pub fn elastic() -> Law {
    bilinear(30e9, 0.2, 2500.0, 1e15, 0.0)
}

/// A box of `counts` elements with a corner at the origin; `fixed` chooses clamped nodes by position \[m\].
pub fn grid(counts: [usize; 3], size_m: [f64; 3], law: Law, fixed: impl Fn([f64; 3]) -> bool) -> Mesh {
    let [nx, ny, nz] = counts;
    let id = |i: usize, j: usize, k: usize| (k * (ny + 1) + j) * (nx + 1) + i;
    let mut nodes = Vec::with_capacity((nx + 1) * (ny + 1) * (nz + 1));
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let at = [i, j, k];
                nodes.push(std::array::from_fn(|a| size_m[a] * at[a] as f64 / counts[a] as f64));
            }
        }
    }
    let mut hexahedra = Vec::with_capacity(nx * ny * nz);
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let ring = |k: usize| [id(i, j, k), id(i + 1, j, k), id(i + 1, j + 1, k), id(i, j + 1, k)];
                let (low, top) = (ring(k), ring(k + 1));
                hexahedra.push([low[0], low[1], low[2], low[3], top[0], top[1], top[2], top[3]]);
            }
        }
    }
    let fixed = (0..nodes.len()).filter(|n| fixed(nodes[*n])).collect();
    of_hexahedra(nodes, hexahedra, law, fixed)
}

/// A mesh of one part and one law from nodes \[m\], hexahedra (bottom face counter-clockwise, then top face) and clamped nodes.
pub fn of_hexahedra(nodes: Vec<[f64; 3]>, hexahedra: Vec<[usize; 8]>, law: Law, fixed: Vec<usize>) -> Mesh {
    let element = |nodes| Element { nodes, part: 0, law: 0, smear: 1.0, strength: 1.0 };
    let elements = hexahedra.into_iter().map(element).collect();
    Mesh { nodes, elements, laws: vec![law], fixed, parts: vec!["body".into()], ..Mesh::default() }
}

/// Rigid ground at a height \[m\] with a friction coefficient.
pub fn ground(level_m: f64, friction: f64) -> RigidSurfaces {
    let mut surfaces = RigidSurfaces::default();
    surfaces.ground = Some((level_m, friction));
    surfaces
}

/// The node nearest to a point \[m\] in the undeformed mesh.
///
/// # Panics
/// If the mesh has no nodes.
pub fn nearest(mesh: &Mesh, to: [f64; 3]) -> usize {
    let distance = |n: &usize| (0..3).map(|i| (mesh.nodes[*n][i] - to[i]).powi(2)).sum::<f64>();
    (0..mesh.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("a mesh with nodes")
}

/// Moves every node by up to `amount_m` in each direction where `free` holds, from a small generator.
pub fn distort(nodes: &mut [[f64; 3]], amount_m: f64, seed: u64, free: impl Fn([f64; 3]) -> bool) {
    let mut random = Random::after(seed);
    for node in nodes {
        let offset: [f64; 3] = std::array::from_fn(|_| amount_m * random.symmetric());
        if free(*node) {
            *node = std::array::from_fn(|i| node[i] + offset[i]);
        }
    }
}

/// A round bar along z, foot at the origin, as an O-grid: a square core of `4 r` x `4 r` cells and `2 r` rings of `16 r`, that is
/// `48 r²` hexahedra a layer. `[layers, r]` are the divisions.
pub fn round_bar(length_m: f64, radius_m: f64, [layers, refine]: [usize; 2], law: Law) -> Mesh {
    let (plane, quads) = o_grid(radius_m, refine);
    let (mut nodes, mut hexahedra) = (Vec::new(), Vec::new());
    for layer in 0..=layers {
        nodes.extend(plane.iter().map(|p| [p[0], p[1], length_m * layer as f64 / layers as f64]));
    }
    for layer in 0..layers {
        for q in &quads {
            let at = |corner: usize, level: usize| q[corner] + (layer + level) * plane.len();
            hexahedra.push([at(0, 0), at(1, 0), at(2, 0), at(3, 0), at(0, 1), at(1, 1), at(2, 1), at(3, 1)]);
        }
    }
    of_hexahedra(nodes, hexahedra, law, Vec::new())
}

/// Points \[m\] and quadrilaterals of a disc; the core reaches half the radius along its axes.
fn o_grid(radius_m: f64, refine: usize) -> (Vec<[f64; 2]>, Vec<[usize; 4]>) {
    let (side, rings, around) = (4 * refine, 2 * refine, 16 * refine);
    let core = |i: usize, j: usize| [i, j].map(|c| 0.5 * radius_m * (c as f64 / (0.5 * side as f64) - 1.0));
    let rim: Vec<(usize, usize)> = (0..side)
        .map(|i| (i, 0))
        .chain((0..side).map(|j| (side, j)))
        .chain((1..=side).rev().map(|i| (i, side)))
        .chain((1..=side).rev().map(|j| (0, j)))
        .collect();
    let row = side + 1;
    let mut plane: Vec<[f64; 2]> = (0..row * row).map(|n| core(n % row, n / row)).collect();
    for ring in 1..=rings {
        for (k, (i, j)) in rim.iter().enumerate() {
            let (inner, angle) = (core(*i, *j), std::f64::consts::TAU * (k as f64 / around as f64 - 0.375));
            let outer = [radius_m * libm::cos(angle), radius_m * libm::sin(angle)];
            let share = ring as f64 / rings as f64;
            plane.push(std::array::from_fn(|a| inner[a] + share * (outer[a] - inner[a])));
        }
    }
    let on_rim = |ring: usize, k: usize| match ring {
        0 => rim[k % around].1 * row + rim[k % around].0,
        _ => row * row + around * (ring - 1) + k % around,
    };
    let mut quads: Vec<[usize; 4]> = (0..side * side)
        .map(|q| q / side * row + q % side)
        .map(|n| [n, n + 1, n + row + 1, n + row])
        .collect();
    for ring in 0..rings {
        for k in 0..around {
            quads.push([on_rim(ring, k), on_rim(ring + 1, k), on_rim(ring + 1, k + 1), on_rim(ring, k + 1)]);
        }
    }
    (plane, quads)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fe::hexahedron::volume_m3;

    #[test]
    fn round_bar_has_the_counts_and_nearly_the_volume() {
        for (refine, count) in [(1, 48), (2, 192)] {
            let mesh = round_bar(2.0, 0.5, [3, refine], elastic());
            assert_eq!(mesh.elements.len(), 3 * count);
            let volumes = mesh.elements.iter().map(|e| volume_m3(&e.nodes.map(|n| mesh.nodes[n])));
            assert!(volumes.clone().all(|v| v > 0.0));
            // a polygon of 16 r sides: sin(2π/n) / (2π/n) of the circle
            let turn = std::f64::consts::TAU / (16.0 * refine as f64);
            let expected = 2.0 * 0.25 * std::f64::consts::PI * turn.sin() / turn;
            assert!((volumes.sum::<f64>() / expected - 1.0).abs() < 1e-12);
        }
    }
}
