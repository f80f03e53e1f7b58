//! Small meshes and laws for the tests.

use fallwerk::building::HardeningPoint;
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::kernel::{BlockForce, BlockMaterial, BlockState, LANES};
use fallwerk::fe::law::{ElementForm, Erosion, Law};
use fallwerk::fe::mesh::{Element, Mesh};
use fallwerk::material::j2::HardeningTable;

pub fn point(plastic_strain: f64, stress_pa: f64) -> HardeningPoint {
    HardeningPoint { plastic_strain, stress_pa }
}

/// A law with a yield stress and a modulus over total strain, without erosion.
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
        density_kg_m3,
        youngs_modulus_pa,
        poisson_ratio,
        hardening,
        rate: None,
        erosion: Erosion::NEVER,
        form: ElementForm::default(),
    }
}

/// Concrete that never yields.
pub fn elastic() -> Law {
    bilinear(30e9, 0.2, 2500.0, 1e15, 0.0)
}

/// A box of `counts` elements with a corner at the origin; `fixed` chooses nodes by position.
pub fn grid(counts: [usize; 3], size_m: [f64; 3], law: Law, fixed: impl Fn([f64; 3]) -> bool) -> Mesh {
    let [nx, ny, nz] = counts;
    let id = |i: usize, j: usize, k: usize| (k * (ny + 1) + j) * (nx + 1) + i;
    let mut nodes = Vec::new();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                let at = [i, j, k];
                nodes.push(std::array::from_fn(|a| size_m[a] * at[a] as f64 / counts[a] as f64));
            }
        }
    }
    let mut hexahedra = Vec::new();
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

pub fn of_hexahedra(nodes: Vec<[f64; 3]>, hexahedra: Vec<[usize; 8]>, law: Law, fixed: Vec<usize>) -> Mesh {
    let element = |nodes| Element { nodes, part: 0, law: 0, smear: 1.0, strength: 1.0 };
    let elements = hexahedra.into_iter().map(element).collect();
    Mesh { nodes, elements, laws: vec![law], fixed, parts: vec!["body".into()], ..Mesh::default() }
}

/// Rigid ground.
pub fn ground(level_m: f64, friction: f64) -> RigidSurfaces {
    let mut surfaces = RigidSurfaces::default();
    surfaces.ground = Some((level_m, friction));
    surfaces
}

/// The node nearest to a point.
pub fn nearest(mesh: &Mesh, to: [f64; 3]) -> usize {
    let distance = |n: &usize| (0..3).map(|i| (mesh.nodes[*n][i] - to[i]).powi(2)).sum::<f64>();
    (0..mesh.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap()
}

/// Moves every node by up to `amount` in each direction where `free` holds, from a small generator.
pub fn distort(nodes: &mut [[f64; 3]], amount: f64, seed: u64, free: impl Fn([f64; 3]) -> bool) {
    let mut random = Random(seed);
    for node in nodes {
        let offset: [f64; 3] = std::array::from_fn(|_| amount * random.symmetric());
        if free(*node) {
            *node = std::array::from_fn(|i| node[i] + offset[i]);
        }
    }
}

/// Linear congruential numbers in -1..1 (constants of Knuth's MMIX).
pub struct Random(pub u64);

impl Random {
    pub fn symmetric(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

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
