//! The elements of a mesh packed into blocks for the kernel, and the nodes' list of element forces.

use super::full::{self, FullState};
use super::hexahedron::volume_m3;
use super::kernel::{self, BlockForce, BlockMaterial, BlockState, KernelStep, LANES};
use super::law::{ElementForm, Hourglass, Law};
use super::mesh::Mesh;
use crate::material::j2::HardeningTable;
use rayon::prelude::*;

/// Blocks handed to a thread at a time. No result depends on it.
const CHUNK: usize = 16;
/// Values in the forces of a block.
const FORCES: usize = 24 * LANES;

/// Eight elements of one law.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub struct Block {
    /// Constants.
    pub material: BlockMaterial,
    /// History.
    pub state: BlockState,
    /// History of the points of fully integrated elements.
    pub full: Option<Box<FullState>>,
    /// Frequency bounds of the last kernel call \[1/s²\], zero where nothing acts.
    pub bound: [f64; LANES],
    /// Node indices `[lane][node]`; unused lanes repeat the last element.
    pub nodes: [[u32; 8]; LANES],
    /// Element index of each used lane.
    pub elements: Vec<usize>,
    /// Largest of `bound`.
    pub largest_bound: f64,
    /// Whether an acting element has reached its critical strain or has no positive frequency bound.
    pub alarm: bool,
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
    /// Where the x force stands in the flat list of forces, in a fixed order; y and z follow `LANES` and `2 LANES` after.
    contributions: Vec<u32>,
    /// Forces of the last kernel call, one for each block.
    forces: Vec<BlockForce>,
}

impl Blocks {
    /// Packs a mesh.
    pub fn of(mesh: &Mesh) -> Self {
        let tables = mesh.laws.iter().map(Law::table).collect();
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
        let forces = vec![[[0.0; LANES]; 24]; blocks.len()];
        Self { blocks, tables, place, starts, contributions, forces }
    }

    /// Kernel over all blocks that still act, with the displacement increments `dt_s * v`.
    pub fn update(&mut self, x: &[[f64; 3]], v: &[[f64; 3]], dt_s: f64, step: KernelStep, parallel: bool) {
        let tables = &self.tables[..];
        if parallel {
            let chunks = self.blocks.par_chunks_mut(CHUNK).zip(self.forces.par_chunks_mut(CHUNK));
            chunks.for_each(|(blocks, forces)| update_chunk(blocks, forces, tables, x, v, dt_s, step));
        } else {
            update_chunk(&mut self.blocks, &mut self.forces, tables, x, v, dt_s, step);
        }
    }

    /// Internal force on a node \[N\]: the sum over its elements in a fixed order.
    #[inline]
    pub fn force_on(&self, node: usize) -> [f64; 3] {
        let flat = self.forces.as_flattened().as_flattened();
        let mut sum = [0.0; 3];
        for &at in &self.contributions[self.starts[node] as usize..self.starts[node + 1] as usize] {
            let from_here = &flat[at as usize..at as usize + 2 * LANES + 1];
            sum[0] += from_here[0];
            sum[1] += from_here[LANES];
            sum[2] += from_here[2 * LANES];
        }
        sum
    }

    /// Forces of one element on its nodes \[N\].
    pub fn element_force(&self, element: usize) -> [[f64; 3]; 8] {
        let (block, lane) = self.place[element];
        let force = &self.forces[block as usize];
        std::array::from_fn(|node| std::array::from_fn(|i| force[3 * node + i][lane as usize]))
    }

    /// Ends an element: share and forces become zero.
    pub(super) fn end(&mut self, block: usize, lane: usize) {
        self.forces[block].iter_mut().for_each(|f| f[lane] = 0.0);
        let block = &mut self.blocks[block];
        block.state.share[lane] = 0.0;
        block.bound[lane] = 0.0;
        block.largest_bound = block.bound.iter().fold(0.0, |a, b| a.max(*b));
    }

    /// Forgets the last forces of elements that no longer act (blocks that are skipped keep theirs).
    pub(super) fn clear_forces_of_dead(&mut self) {
        for (block, force) in self.blocks.iter().zip(&mut self.forces) {
            for lane in 0..LANES {
                if block.state.share[lane] == 0.0 {
                    force.iter_mut().for_each(|f| f[lane] = 0.0);
                }
            }
        }
    }

    /// Elements that touch a node.
    pub fn elements_at(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        self.contributions[self.starts[node] as usize..self.starts[node + 1] as usize]
            .iter()
            .map(|&at| self.blocks[at as usize / FORCES].elements[at as usize % LANES])
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
}

/// Gathers, calls the kernel and notes what the time loop needs to know. The instruction set is chosen once a call.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn update_chunk(
    blocks: &mut [Block],
    forces: &mut [BlockForce],
    tables: &[HardeningTable],
    x: &[[f64; 3]],
    v: &[[f64; 3]],
    dt_s: f64,
    step: KernelStep,
) {
    let (mut at, mut moved): (BlockForce, BlockForce) = ([[0.0; LANES]; 24], [[0.0; LANES]; 24]);
    for (block, force) in blocks.iter_mut().zip(forces) {
        if block.state.share.iter().all(|s| *s == 0.0) {
            block.largest_bound = 0.0;
            block.alarm = false;
            continue;
        }
        for (lane, nodes) in block.nodes.iter().enumerate() {
            for (local, n) in nodes.iter().enumerate() {
                let (p, w) = (x[*n as usize], v[*n as usize]);
                for i in 0..3 {
                    at[3 * local + i][lane] = p[i];
                    moved[3 * local + i][lane] = w[i];
                }
            }
        }
        let table = &tables[block.material.table];
        let (material, state) = (&block.material, &mut block.state);
        let bound = match (&mut block.full, material.form) {
            (None, ElementForm::OnePoint(Hourglass::Asqbi)) => {
                kernel::update::<true>(&at, &moved, dt_s, material, table, state, force, step)
            }
            (None, _) => kernel::update_other(&at, &moved, dt_s, material, table, state, force, step),
            (Some(points), _) => full::update(&at, &moved, dt_s, material, table, state, points, force, step),
        };
        let (mut largest, mut alarms) = (0.0, 0);
        for l in 0..LANES {
            let reached = block.state.plastic_strain[l] >= block.material.critical_strain[l];
            let valid = bound[l] > 0.0;
            alarms += u32::from(block.state.share[l] > 0.0 && (reached || !valid));
            largest = if bound[l] > largest { bound[l] } else { largest };
        }
        block.bound = bound;
        block.largest_bound = largest;
        block.alarm = alarms > 0;
    }
}

/// Packs elements of one law into a block.
fn block(mesh: &Mesh, elements: Vec<usize>) -> Block {
    let table = mesh.elements[elements[0]].law;
    let form = mesh.laws[table].form;
    let mut material = BlockMaterial { table, form, ..Default::default() };
    let full = (form == ElementForm::FullyIntegrated).then(Box::default);
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
        material.mass_kg[lane] =
            law.density_kg_m3 * element.smear * volume_m3(&element.nodes.map(|n| mesh.nodes[n]));
        material.critical_strain[lane] = law.erosion.plastic_strain;
        state.share[lane] = if lane < elements.len() { 1.0 } else { 0.0 };
    }
    Block { material, state, full, bound: [0.0; LANES], nodes, elements, largest_bound: 0.0, alarm: false }
}

/// For each node, where its element forces stand.
fn scatter_map(mesh: &Mesh, place: &[(u32, u8)]) -> (Vec<u32>, Vec<u32>) {
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
    let mut contributions = vec![0; starts[mesh.nodes.len()] as usize];
    for (index, element) in mesh.elements.iter().enumerate() {
        let (block, lane) = place[index];
        for (local, n) in element.nodes.iter().enumerate() {
            contributions[next[*n] as usize] =
                block * FORCES as u32 + (3 * LANES * local) as u32 + u32::from(lane);
            next[*n] += 1;
        }
    }
    (starts, contributions)
}
