//! One element: gradient, volume, rigid motion, stiffness, frequency bound, instruction sets.

use super::mesh::{Single, bilinear, elastic, grid, hexahedron, in_lanes};
use fallwerk::base::isa::Isa;
use fallwerk::base::random::Random;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::hexahedron::volume_m3;
use fallwerk::fe::kernel::{BlockForce, KernelStep, LANES, update_block, update_block_in};
use nalgebra::DMatrix;

const STATIC: KernelStep = KernelStep { dt_s: 1.0, viscous: false };

/// Volume by 2 x 2 x 2 Gauss points, which are exact for a trilinear map.
fn gauss_volume(nodes: &[[f64; 3]; 8]) -> f64 {
    const SIGNS: [[f64; 3]; 8] = [
        [-1.0, -1.0, -1.0],
        [1.0, -1.0, -1.0],
        [1.0, 1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [1.0, -1.0, 1.0],
        [1.0, 1.0, 1.0],
        [-1.0, 1.0, 1.0],
    ];
    let determinant = |at: [f64; 3]| {
        let mut jacobian = nalgebra::Matrix3::zeros();
        for (node, signs) in nodes.iter().zip(SIGNS) {
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                let slope = 0.125 * signs[a] * (1.0 + signs[b] * at[b]) * (1.0 + signs[c] * at[c]);
                for i in 0..3 {
                    jacobian[(a, i)] += slope * node[i];
                }
            }
        }
        jacobian.determinant()
    };
    SIGNS.map(|s| determinant(s.map(|c| c / 3.0_f64.sqrt()))).iter().sum()
}

#[test]
fn volume_is_exact() {
    for seed in 0..20 {
        let nodes = hexahedron(0.25, seed);
        assert!((volume_m3(&nodes) - gauss_volume(&nodes)).abs() < 1e-15);
    }
    // frustum with plane faces: (A + sqrt(A B) + B) h / 3
    let mut nodes = hexahedron(0.0, 0);
    nodes[4..].iter_mut().for_each(|n| *n = [0.25 + 0.5 * n[0], 0.25 + 0.5 * n[1], n[2]]);
    assert!((volume_m3(&nodes) - (1.0 + 0.5 + 0.25) / 3.0).abs() < 1e-15);
}

/// Under a unit pressure stress the nodal forces are the derivatives of the volume.
#[test]
fn uniform_gradient_is_the_derivative_of_the_volume() {
    for seed in 0..10 {
        let nodes = hexahedron(0.25, seed);
        let mut one = Single::new(&elastic(), 1.0);
        for i in 0..3 {
            one.state.stress[i] = [1.0; LANES];
        }
        let mut force = [[0.0; LANES]; 24];
        update_block(
            &in_lanes(&nodes),
            &[[0.0; LANES]; 24],
            &one.material,
            &one.table,
            &mut one.state,
            &mut force,
            STATIC,
        );
        for row in 0..24 {
            // the volume is linear in each single coordinate
            let (mut above, mut below) = (nodes, nodes);
            above[row / 3][row % 3] += 0.5;
            below[row / 3][row % 3] -= 0.5;
            let slope = gauss_volume(&above) - gauss_volume(&below);
            assert!((force[row][0] - slope).abs() < 1e-14, "{row}: {} {slope}", force[row][0]);
        }
    }
}

/// Patch test: a linear displacement field on irregular elements gives one stress everywhere and no force inside.
#[test]
fn patch_of_irregular_elements_reproduces_uniform_strain() {
    let mut mesh = grid([3, 3, 3], [1.0; 3], elastic(), |_| false);
    super::mesh::distort(&mut mesh.nodes, 0.08, 7, |p| p.iter().all(|c| *c > 0.01 && *c < 0.99));
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), false);
    let slope = [[2e-8, 1e-8, -3e-8], [0.5e-8, -1e-8, 2e-8], [1e-8, 4e-8, 3e-8]];
    for n in 0..mesh.nodes.len() {
        body.v[n] = std::array::from_fn(|i| (0..3).map(|j| slope[i][j] * mesh.nodes[n][j]).sum());
        body.x[n] = std::array::from_fn(|i| mesh.nodes[n][i] + body.v[n][i]);
    }
    body.update_elements(STATIC, 1.0);
    let (lambda, mu) = (30e9 * 0.2 / (1.2 * 0.6), 12.5e9);
    let trace: f64 = (0..3).map(|i| slope[i][i]).sum();
    let (mut energy, mut normal) = (0.0, 0.0_f64);
    for i in 0..3 {
        for j in 0..3 {
            let strain = 0.5 * (slope[i][j] + slope[j][i]);
            energy += mu * strain * strain;
            normal = normal.max(2.0 * mu * strain.abs() + lambda * trace.abs());
        }
    }
    energy += 0.5 * lambda * trace * trace;
    let [internal, hourglass, _] = body.blocks.energies_j();
    assert!((internal / energy - 1.0).abs() < 1e-6, "{internal} {energy}");
    assert!(hourglass.abs() < 1e-14 * energy, "{hourglass}");
    for n in 0..mesh.nodes.len() {
        if mesh.nodes[n].iter().all(|c| *c > 0.01 && *c < 0.99) {
            for f in body.internal_n(n) {
                assert!(f.abs() < 1e-9 * normal / 9.0, "node {n}: {f} of {normal}");
            }
        }
    }
}

#[test]
fn rigid_rotation_strains_nothing() {
    for steps in [100, 10_000] {
        let start = hexahedron(0.2, 3);
        let mut one = Single::new(&elastic(), 1.0);
        let mut force = [[0.0; LANES]; 24];
        let turned = |angle: f64| {
            let axis = nalgebra::Unit::new_normalize(nalgebra::Vector3::new(1.0, 2.0, -1.5));
            let rotation = nalgebra::Rotation3::from_axis_angle(&axis, angle);
            start.map(|p| <[f64; 3]>::from(rotation * nalgebra::Vector3::from(p)))
        };
        let mut before = start;
        for step in 1..=steps {
            let after = turned(f64::from(step) / f64::from(steps));
            let du: [[f64; 3]; 8] =
                std::array::from_fn(|n| std::array::from_fn(|i| after[n][i] - before[n][i]));
            update_block(
                &in_lanes(&after),
                &in_lanes(&du),
                &one.material,
                &one.table,
                &mut one.state,
                &mut force,
                STATIC,
            );
            before = after;
        }
        let largest = one.state.stress.iter().map(|s| s[0].abs()).fold(0.0, f64::max);
        let forced = force.iter().map(|f| f[0].abs()).fold(0.0, f64::max);
        assert!(largest < 2.0, "{steps} steps: {largest} Pa, a millionth of 2 MPa is 2 Pa");
        assert!(forced < 2.0, "{steps} steps: {forced} N");
    }
}

/// Stiffness by unit displacements, and the kernel's frequency bound \[1/s²\].
fn stiffness(nodes: &[[f64; 3]; 8], one: &Single) -> (DMatrix<f64>, f64) {
    const UNIT_M: f64 = 1e-9;
    let mut matrix = DMatrix::zeros(24, 24);
    let mut bound = 0.0;
    for column in 0..24 {
        let mut du = [[0.0; LANES]; 24];
        du[column] = [UNIT_M; LANES];
        let (mut state, mut force) = (one.state, [[0.0; LANES]; 24]);
        bound =
            update_block(&in_lanes(nodes), &du, &one.material, &one.table, &mut state, &mut force, STATIC)[0];
        for row in 0..24 {
            matrix[(row, column)] = force[row][0] / UNIT_M;
        }
    }
    (matrix, bound)
}

#[test]
fn element_has_six_rigid_modes_and_a_safe_frequency_bound() {
    for (stretch, amount, seed) in [
        ([1.0, 1.0, 1.0], 0.0, 1),
        ([1.0, 1.0, 1.0], 0.2, 2),
        ([4.0, 1.0, 1.0], 0.15, 3),
        ([0.2, 1.0, 1.0], 0.0, 4),
    ] {
        let nodes = hexahedron(amount, seed).map(|p| std::array::from_fn(|i| p[i] * stretch[i]));
        let mass = 2500.0 * gauss_volume(&nodes);
        let (matrix, bound) = stiffness(&nodes, &Single::new(&elastic(), mass));
        let skew = (&matrix - matrix.transpose()).amax() / matrix.amax();
        assert!(skew < 1e-6, "{skew}");
        let mut values: Vec<f64> =
            (0.5 * (&matrix + matrix.transpose())).symmetric_eigenvalues().iter().copied().collect();
        values.sort_by(f64::total_cmp);
        let largest = values[23];
        let zero = values.iter().filter(|v| v.abs() < 1e-6 * largest).count();
        assert_eq!(zero, 6, "{values:?}");
        assert!(values[0] > -1e-6 * largest && values[6] > 1e-4 * largest, "{values:?}");
        let square = largest / (mass / 8.0);
        assert!(
            bound > square * (1.0 - 1e-6) && bound < 2.0 * square,
            "{stretch:?} {amount}: bound {bound:e} true {square:e}"
        );
    }
}

/// Steps of random elements, some flowing, some without share.
fn random_blocks(mut each: impl FnMut(&BlockForce, &BlockForce, &Single)) {
    let mut random = Random::after(11);
    let mut one = Single::new(&bilinear(30e9, 0.2, 2500.0, 20e6, 300e6), 2500.0);
    for _ in 0..200 {
        let mut x = in_lanes(&hexahedron(0.2, 5));
        let mut du = [[0.0; LANES]; 24];
        for row in 0..24 {
            for l in 0..LANES {
                x[row][l] += 0.1 * random.symmetric();
                du[row][l] = 1e-3 * random.symmetric();
            }
        }
        for l in 0..LANES {
            one.state.share[l] = (1.5 * random.symmetric()).clamp(0.0, 1.0);
            one.state.stress.iter_mut().for_each(|s| s[l] = 2e7 * random.symmetric());
            one.state.hourglass.iter_mut().for_each(|s| s[l] = 1e6 * random.symmetric());
            one.state.plastic_strain[l] = random.symmetric().abs();
        }
        each(&x, &du, &one);
    }
}

#[test]
fn every_instruction_set_gives_the_same_bytes() {
    let step = KernelStep { dt_s: 3e-5, viscous: true };
    random_blocks(|x, du, one| {
        let run = |isa: Isa| {
            let (mut state, mut force) = (one.state, [[0.0; LANES]; 24]);
            let bound = update_block_in(isa, x, du, &one.material, &one.table, &mut state, &mut force, step);
            (force.map(|r| r.map(f64::to_bits)), bound.map(f64::to_bits), format!("{state:?}"))
        };
        let portable = run(Isa::Portable);
        for isa in Isa::available() {
            assert!(run(isa) == portable, "{isa:?}");
        }
    });
}

/// Elements that no longer act exert nothing and cannot spoil the energies, even turned inside out or flat.
#[test]
fn dead_elements_are_inert() {
    let step = KernelStep { dt_s: 3e-5, viscous: true };
    random_blocks(|x, du, one| {
        let (mut state, mut force) = (one.state, [[f64::NAN; LANES]; 24]);
        state.share = [0.0; LANES];
        let before = state;
        let mut bad = *x;
        for row in 0..24 {
            bad[row][0] = 0.0;
            bad[row][1] = -x[row][1];
            bad[row][2] = if row % 3 == 0 { 0.0 } else { x[row][2] };
        }
        let bound = update_block(&bad, du, &one.material, &one.table, &mut state, &mut force, step);
        assert_eq!(format!("{before:?}"), format!("{state:?}"));
        assert_eq!(force, [[0.0; LANES]; 24]);
        assert_eq!(bound, [0.0; LANES]);
    });
}
