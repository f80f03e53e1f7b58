//! The elements of a mesh packed into blocks for the kernel, and the nodes' list of element forces.

use super::kernel::{BlockForce, BlockMaterial, BlockState, LANES};
use super::mesh::Mesh;
use crate::material::j2::HardeningTable;

/// Eight elements of one law.
#[derive(Debug, Clone)]
pub struct Block {
    /// Node indices `[lane][node]`; unused lanes repeat the last element.
    pub nodes: [[u32; 8]; LANES],
    /// Element index of each used lane.
    pub elements: Vec<usize>,
    /// Constants.
    pub material: BlockMaterial,
    /// History.
    pub state: BlockState,
    /// Forces of the last kernel call.
    pub force: BlockForce,
    /// Frequency bounds of the last kernel call \[1/s²\].
    pub bound: [f64; LANES],
}

/// All blocks with the scatter map.
#[derive(Debug, Clone)]
pub struct Blocks {
    /// The blocks.
    pub blocks: Vec<Block>,
    /// Hardening tables by law.
    pub tables: Vec<HardeningTable>,
    /// `(block, lane)` of each element.
    pub place: Vec<(u32, u8)>,
    /// Start of each node's contributions in `contributions`, one more than nodes.
    starts: Vec<u32>,
    /// `(block, 3 * local node, lane)` in a fixed order.
    contributions: Vec<(u32, u8, u8)>,
}

impl Blocks {
    /// Packs a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let tables = mesh.laws.iter().map(|l| HardeningTable::new(&l.hardening)).collect();
        let mut blocks: Vec<Block> = Vec::new();
        let mut place = vec![(0, 0); mesh.elements.len()];
        let mut first = 0;
        while first < mesh.elements.len() {
            let law = mesh.elements[first].law;
            let same = mesh.elements[first..].iter().take(LANES).take_while(|e| e.law == law).count();
            let elements: Vec<usize> = (first..first + same).collect();
            for (lane, e) in elements.iter().enumerate() {
                place[*e] = (blocks.len() as u32, lane as u8);
            }
            blocks.push(block(mesh, elements));
            first += same;
        }
        let (starts, contributions) = scatter_map(mesh, &place);
        Self { blocks, tables, place, starts, contributions }
    }

    /// Internal force on a node \[N\]: the sum over its elements in a fixed order.
    pub fn force_on(&self, node: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &(block, local, lane) in &self.contributions[self.starts[node] as usize..self.starts[node + 1] as usize] {
            let force = &self.blocks[block as usize].force;
            for (i, s) in sum.iter_mut().enumerate() {
                *s += force[local as usize + i][lane as usize];
            }
        }
        sum
    }

    /// Forces of one element on its nodes \[N\].
    pub fn element_force(&self, element: usize) -> [[f64; 3]; 8] {
        let (block, lane) = self.place[element];
        let force = &self.blocks[block as usize].force;
        std::array::from_fn(|node| std::array::from_fn(|i| force[3 * node + i][lane as usize]))
    }

    /// Elements that touch a node.
    pub fn elements_at(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        self.contributions[self.starts[node] as usize..self.starts[node + 1] as usize]
            .iter()
            .map(|&(block, _, lane)| self.blocks[block as usize].elements[lane as usize])
    }

    /// Acting share of an element.
    pub fn share(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].state.share[lane as usize]
    }

    /// Sets the acting share of an element.
    pub fn set_share(&mut self, element: usize, share: f64) {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].state.share[lane as usize] = share;
    }

    /// Equivalent plastic strain of an element.
    pub fn plastic_strain(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].state.plastic_strain[lane as usize]
    }

    /// Work done on an element by its stresses \[J\].
    pub fn internal_j(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].state.internal_j[lane as usize]
    }

    /// Mass of an element \[kg\].
    pub fn mass_kg(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].material.mass_kg[lane as usize]
    }

    /// Sums of internal, hourglass and viscous work over all elements, in element order \[J\].
    pub fn energies_j(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for block in &self.blocks {
            for lane in 0..block.elements.len() {
                sum[0] += block.state.internal_j[lane];
                sum[1] += block.state.hourglass_j[lane];
                sum[2] += block.state.viscous_j[lane];
            }
        }
        sum
    }

    /// Equivalent strain rate of each element over the window since the last call: `sqrt(2/3 e:e) / window`
    /// with the net deviatoric strain `e`, so that elastic vibration within the window averages out. Resets the window.
    pub fn take_strain_rates(&mut self, window_s: f64) -> Vec<f32> {
        let mut rates = vec![0.0; self.place.len()];
        for block in &mut self.blocks {
            for (lane, element) in block.elements.iter().enumerate() {
                let e: [f64; 6] = std::array::from_fn(|i| block.state.window_strain[i][lane]);
                let mean = (e[0] + e[1] + e[2]) / 3.0;
                let normal: f64 = e[..3].iter().map(|v| (v - mean) * (v - mean)).sum();
                let shear: f64 = e[3..].iter().map(|v| v * v).sum();
                rates[*element] = ((2.0 / 3.0 * (normal + 2.0 * shear)).sqrt() / window_s) as f32;
            }
            block.state.window_strain = Default::default();
        }
        rates
    }
}

/// Packs elements of one law into a block.
fn block(mesh: &Mesh, elements: Vec<usize>) -> Block {
    let mut material = BlockMaterial { table: mesh.elements[elements[0]].law, ..Default::default() };
    let mut nodes = [[0; 8]; LANES];
    let mut state = BlockState::default();
    for lane in 0..LANES {
        let index = elements[lane.min(elements.len() - 1)];
        let element = &mesh.elements[index];
        let law = &mesh.laws[element.law];
        let e = law.youngs_modulus_pa * element.smear;
        let nu = law.poisson_ratio;
        nodes[lane] = element.nodes.map(|n| n as u32);
        material.lambda_pa[lane] = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        material.mu_pa[lane] = 0.5 * e / (1.0 + nu);
        material.yield_scale[lane] = element.smear * element.strength;
        material.mass_kg[lane] = law.density_kg_m3 * element.smear * volume(mesh, index);
        material.critical_strain[lane] = law.critical_plastic_strain;
        state.share[lane] = if lane < elements.len() { 1.0 } else { 0.0 };
    }
    Block { nodes, elements, material, state, force: [[0.0; LANES]; 24], bound: [0.0; LANES] }
}

/// Volume of an undeformed element \[m³\], by its six tetrahedra around the diagonal 0-6.
fn volume(mesh: &Mesh, element: usize) -> f64 {
    let p = mesh.elements[element].nodes.map(|n| mesh.nodes[n]);
    const RING: [usize; 7] = [1, 2, 3, 7, 4, 5, 1];
    let edge = |a: usize| -> [f64; 3] { std::array::from_fn(|i| p[a][i] - p[0][i]) };
    let axis = edge(6);
    RING.windows(2)
        .map(|w| {
            let (a, b) = (edge(w[0]), edge(w[1]));
            let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
            (0..3).map(|i| cross[i] * axis[i]).sum::<f64>() / 6.0
        })
        .sum()
}

/// For each node, where its element forces stand.
fn scatter_map(mesh: &Mesh, place: &[(u32, u8)]) -> (Vec<u32>, Vec<(u32, u8, u8)>) {
    let mut starts = vec![0u32; mesh.nodes.len() + 1];
    for element in &mesh.elements {
        for n in element.nodes {
            starts[n + 1] += 1;
        }
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut contributions = vec![(0, 0, 0); starts[mesh.nodes.len()] as usize];
    for (index, element) in mesh.elements.iter().enumerate() {
        let (block, lane) = place[index];
        for (local, n) in element.nodes.iter().enumerate() {
            contributions[next[*n] as usize] = (block, 3 * local as u8, lane);
            next[*n] += 1;
        }
    }
    (starts, contributions)
}
