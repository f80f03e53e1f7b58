//! Single elements for the tests; meshes and laws come from [`fallwerk::fe::shapes`].

use fallwerk::fe::kernel::{BlockForce, BlockMaterial, BlockState, LANES};
use fallwerk::fe::law::Law;
pub use fallwerk::fe::shapes::{
    bilinear, distort, elastic, grid, ground, nearest, of_hexahedra, point, round_bar,
};
use fallwerk::material::j2::HardeningTable;

/// A unit cube with its corners moved by up to `amount`.
pub fn hexahedron(amount: f64, seed: u64) -> [[f64; 3]; 8] {
    let cube = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let mut nodes = cube.map(|c: [i32; 3]| c.map(f64::from));
    distort(&mut nodes, amount, seed, |_| true);
    nodes
}

/// One element for the kernel, the same in every lane.
pub struct Single {
    pub material: BlockMaterial,
    pub table: HardeningTable,
    pub state: BlockState,
}

impl Single {
    pub fn new(law: &Law, mass_kg: f64) -> Self {
        let (e, nu) = (law.youngs_modulus_pa, law.poisson_ratio);
        let material = BlockMaterial {
            lambda_pa: [e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)); LANES],
            mu_pa: [0.5 * e / (1.0 + nu); LANES],
            yield_scale: [1.0; LANES],
            mass_kg: [mass_kg; LANES],
            critical_strain: [1e9; LANES],
            table: 0,
            form: law.form,
        };
        let state = BlockState { share: [1.0; LANES], ..BlockState::default() };
        Self { material, table: law.table(), state }
    }
}

/// Nodal vectors of one element in every lane.
pub fn in_lanes(nodal: &[[f64; 3]; 8]) -> BlockForce {
    std::array::from_fn(|row| [nodal[row / 3][row % 3]; LANES])
}
