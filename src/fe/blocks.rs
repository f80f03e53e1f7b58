//! The elements of a mesh packed into blocks for the kernel, blocks into chunks, and the nodes' list of forces.
//!
//! Memory traffic decides the speed of a large mesh, so each number is touched once a step. Elements are
//! packed along a space-filling curve; a chunk of up to 32 blocks copies the motion of its nodes
//! into a local buffer that stays in the first-level cache, gathers from it, and sums the forces of its elements
//! on its nodes there ([`super::sweep`]). What leaves a chunk is one force a node; the few chunks that share a
//! node are summed in a fixed order, so that results do not depend on the number of threads.

use super::concrete::{ConcreteBlock, ConcretePoints};
use super::full::{self, FullState};
use super::hexahedron::volume_m3;
use super::incidence::{elements_of_nodes, starts_of};
use super::kernel::{BlockForce, BlockMaterial, BlockState, KernelStep, LANES, update_block};
use super::law::{ElementForm, Law};
use super::mesh::Mesh;
use super::packed::PackedMaterial;
use crate::material::j2::HardeningTable;
use serde::{Deserialize, Serialize};

/// Blocks a chunk holds, at most and at least: small meshes get smaller chunks, so that all threads find work.
const CHUNK_BLOCKS: [usize; 2] = [4, 32];
/// Chunks that a mesh should have before they grow to their largest size.
const CHUNKS_WISHED: usize = 64;
/// Blocks are packed anew when this share of the lanes of acting blocks belongs to elements that have ended.
const DEAD_SHARE: f64 = 0.125;
/// Marks a lane without an element.
const NO_ELEMENT: u32 = u32::MAX;

/// Eight elements of one law.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct Block {
    /// History.
    pub state: BlockState,
    /// Constants.
    pub material: PackedMaterial,
    /// Nodes `[lane][node]` by their place in the chunk; unused lanes repeat the last element.
    pub nodes: [[u16; 8]; LANES],
    /// History of the points of fully integrated elements.
    pub full: Option<Box<FullState>>,
    /// History of concrete elements.
    pub concrete: Option<Box<ConcreteBlock>>,
    /// Largest frequency bound of the last kernel call \[1/s²\], zero where nothing acts.
    pub largest_bound: f64,
    /// Whether any lane acts.
    pub acts: bool,
}

/// All blocks with the scatter map.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Blocks {
    /// The blocks; `chunk_blocks` in a row are a chunk.
    pub blocks: Vec<Block>,
    /// Blocks in a chunk.
    pub(super) chunk_blocks: usize,
    /// Rest of each chunk.
    pub(super) quiet: Vec<Quiet>,
    /// Element-passes that were skipped in earlier packings because nothing moved.
    pub(super) skipped_before: u64,
    /// Nodes of each element.
    element_nodes: Vec<[u32; 8]>,
    /// Place of each element along the curve of the first packing.
    rank: Vec<u32>,
    /// Elements that have ended since the blocks were packed.
    dead: usize,
    /// Whether each element was detached from its neighbours; empty if none was.
    detached: Vec<bool>,
    /// Whether each element is part of a rigid set and not computed; empty if none is.
    resting: Vec<bool>,
    /// Hardening tables by law.
    pub tables: Vec<HardeningTable>,
    /// Laws of concrete elements.
    pub(super) concretes: ConcretePoints,
    /// Element of each lane of each block, [`NO_ELEMENT`] if none.
    lanes: Vec<[u32; LANES]>,
    /// `(block, lane)` of each element.
    place: Vec<(u32, u8)>,
    /// Nodes of the chunks, one list after the other.
    pub(super) chunk_nodes: Vec<u32>,
    /// Start of each chunk's nodes, one more than chunks.
    pub(super) chunk_starts: Vec<u32>,
    /// Forces on the nodes of chunk `c` from its elements, at `c * stride` and on.
    pub(super) partial_n: Vec<[f64; 3]>,
    /// Most nodes in a chunk.
    pub(super) stride: usize,
    /// Start of each node's entries in `contributions`, one more than nodes.
    node_starts: Vec<u32>,
    /// Where the forces on a node stand in `partial_n`, in chunk order.
    contributions: Vec<u32>,
    /// Start of each node's entries in `node_elements`.
    element_starts: Vec<u32>,
    /// Elements at each node, in element order.
    node_elements: Vec<u32>,
}

impl Blocks {
    /// Packs a mesh.
    ///
    /// # Panics
    /// If a law of concrete is out of its range: who makes the mesh checks with [`ConcretePoints::of`].
    #[expect(clippy::expect_used, reason = "documented; checked by who makes the mesh")]
    pub fn of(mesh: &Mesh) -> Self {
        let concretes = ConcretePoints::of(mesh).expect("concrete law");
        let tables = mesh.laws.iter().map(Law::table).collect();
        let order = packing_order(mesh);
        let mut rank = vec![0; order.len()];
        order.iter().enumerate().for_each(|(place, e)| rank[*e] = place as u32);
        let (mut blocks, mut lanes) = (Vec::new(), Vec::new());
        for elements in runs(&order, |e| mesh.elements[*e].law) {
            let mut held = [NO_ELEMENT; LANES];
            for (lane, e) in elements.iter().enumerate() {
                held[lane] = *e as u32;
            }
            blocks.push(block(mesh, &concretes, elements));
            lanes.push(held);
        }
        let mut this = Self {
            chunk_blocks: 0,
            quiet: Vec::new(),
            skipped_before: 0,
            element_nodes: mesh.elements.iter().map(|e| e.nodes.map(|n| n as u32)).collect(),
            rank,
            dead: 0,
            detached: Vec::new(),
            resting: Vec::new(),
            blocks,
            tables,
            concretes,
            lanes,
            place: vec![(0, 0); mesh.elements.len()],
            chunk_nodes: Vec::new(),
            chunk_starts: Vec::new(),
            partial_n: Vec::new(),
            stride: 0,
            node_starts: vec![0; mesh.nodes.len() + 1],
            contributions: Vec::new(),
            element_starts: Vec::new(),
            node_elements: Vec::new(),
        };
        this.connect(&mesh.nodes);
        this
    }

    /// Packs acting elements together when many between them have ended, so that these cost nothing. Positions `x` \[m\].
    pub fn repack_if_worthwhile(&mut self, x: &[[f64; 3]]) {
        let acting = LANES * self.blocks.iter().filter(|b| b.acts).count();
        if self.dead < 2 * LANES || (self.dead as f64) < DEAD_SHARE * acting as f64 {
            return;
        }
        self.repack(x);
    }

    /// Leaves the elements that are `resting` out of all passes, with the stress that they have. Forces are zero until the next pass of the kernel.
    pub(super) fn rest(&mut self, resting: &[bool], x: &[[f64; 3]]) {
        self.resting = resting.to_vec();
        self.repack(x);
    }

    fn repack(&mut self, x: &[[f64; 3]]) {
        let lanes = &self.lanes;
        let all = (0..self.blocks.len())
            .flat_map(|b| (0..LANES).filter(move |l| lanes[b][*l] != NO_ELEMENT).map(move |l| (b, l)));
        let (there, ended): (Vec<_>, Vec<_>) = all.partition(|(b, l)| self.blocks[*b].state.share[*l] > 0.0);
        let rests = |(b, l): &(usize, usize)| self.resting.get(self.lanes[*b][*l] as usize) == Some(&true);
        let (resting, mut acting): (Vec<_>, Vec<_>) = there.into_iter().partition(rests);
        if !self.resting.is_empty() {
            // elements come and go: keep the order along the curve, in which neighbours are close
            let element = |(b, l): &(usize, usize)| self.lanes[*b][*l];
            acting.sort_by_key(|place| self.rank[element(place) as usize]);
        }
        let law = |(b, _): &(usize, usize)| self.blocks[*b].material.table;
        let (mut blocks, mut lanes) = (Vec::new(), Vec::new());
        for places in runs(&acting, law).chain(runs(&resting, law)).chain(runs(&ended, law)) {
            let mut held = [NO_ELEMENT; LANES];
            for (lane, (b, l)) in places.iter().enumerate() {
                held[lane] = self.lanes[*b][*l];
            }
            let mut block = self.collected(places);
            if rests(&places[0]) {
                (block.acts, block.largest_bound) = (false, 0.0);
            }
            blocks.push(block);
            lanes.push(held);
        }
        (self.blocks, self.lanes, self.dead) = (blocks, lanes, 0);
        self.localise(x);
    }

    /// Finds anew which elements act on which of the nodes at `x`. Forces are zero until the next pass of the kernel.
    pub(super) fn connect(&mut self, x: &[[f64; 3]]) {
        (self.element_starts, self.node_elements) = elements_of_nodes(&self.element_nodes, x.len());
        self.localise(x);
    }

    /// A block of elements of other blocks.
    fn collected(&self, places: &[(usize, usize)]) -> Block {
        let mut new = self.blocks[places[0].0].clone();
        let mut material = new.material.lanes();
        for lane in 0..LANES {
            let (b, l) = places[lane.min(places.len() - 1)];
            new.state.copy_lane(lane, &self.blocks[b].state, l);
            material.copy_lane(lane, &self.blocks[b].material.lanes(), l);
            if let (Some(points), Some(theirs)) = (&mut new.full, &self.blocks[b].full) {
                points.copy_lane(lane, theirs, l);
            }
            if let (Some(here), Some(theirs)) = (&mut new.concrete, &self.blocks[b].concrete) {
                here.copy_lane(lane, theirs, l);
            }
            if lane >= places.len() {
                new.state.clear_lane(lane);
            }
        }
        new.material = PackedMaterial::new(&material);
        new.acts = new.state.share.iter().any(|s| *s > 0.0);
        new
    }

    /// Gives each chunk its list of nodes and each node its list of chunks.
    fn localise(&mut self, x: &[[f64; 3]]) {
        self.skipped_before += self.skipped();
        self.chunk_blocks = (self.blocks.len() / CHUNKS_WISHED).clamp(CHUNK_BLOCKS[0], CHUNK_BLOCKS[1]);
        (self.chunk_nodes, self.chunk_starts, self.quiet, self.stride) = (Vec::new(), vec![0], Vec::new(), 0);
        let mut local = vec![u16::MAX; x.len()];
        let chunks = self.blocks.chunks_mut(self.chunk_blocks).zip(self.lanes.chunks(self.chunk_blocks));
        for (c, (blocks, lanes)) in chunks.enumerate() {
            let elements = || lanes.iter().flatten().filter(|e| **e != NO_ELEMENT).map(|e| *e as usize);
            let mut nodes: Vec<u32> = elements().flat_map(|e| self.element_nodes[e]).collect();
            nodes.sort_unstable();
            nodes.dedup();
            for (i, n) in nodes.iter().enumerate() {
                local[*n as usize] = i as u16;
            }
            for (b, (block, held)) in blocks.iter_mut().zip(lanes).enumerate() {
                let used = held.iter().filter(|e| **e != NO_ELEMENT).count();
                for lane in 0..LANES {
                    let element = held[lane.min(used - 1)] as usize;
                    block.nodes[lane] = self.element_nodes[element].map(|n| local[n as usize]);
                    if lane < used {
                        self.place[element] = ((c * self.chunk_blocks + b) as u32, lane as u8);
                    }
                }
            }
            self.quiet.push(Quiet::default());
            self.stride = self.stride.max(nodes.len());
            self.chunk_nodes.extend(nodes);
            self.chunk_starts.push(self.chunk_nodes.len() as u32);
        }
        self.partial_n = vec![[0.0; 3]; self.stride * self.chunks()];
        let mut entries: Vec<(u32, u32)> = Vec::with_capacity(self.chunk_nodes.len());
        for (chunk, range) in self.chunk_starts.windows(2).enumerate() {
            let nodes = &self.chunk_nodes[range[0] as usize..range[1] as usize];
            entries.extend(nodes.iter().enumerate().map(|(i, n)| (*n, (chunk * self.stride + i) as u32)));
        }
        entries.sort_unstable();
        self.node_starts = starts_of(x.len(), entries.iter().map(|e| e.0 as usize));
        self.contributions = entries.iter().map(|e| e.1).collect();
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.place.len()
    }

    /// Takes all stress and history from the elements.
    pub(super) fn unload(&mut self) {
        for block in &mut self.blocks {
            block.state = BlockState { share: block.state.share, ..BlockState::default() };
            if let Some(points) = &mut block.full {
                **points = FullState::default();
            }
            if let Some(concrete) = &mut block.concrete {
                concrete.unload();
            }
        }
    }

    /// Number of chunks.
    pub fn chunks(&self) -> usize {
        self.chunk_starts.len() - 1
    }

    /// Nodes of a chunk.
    pub fn nodes_of_chunk(&self, chunk: usize) -> &[u32] {
        &self.chunk_nodes[self.chunk_starts[chunk] as usize..self.chunk_starts[chunk + 1] as usize]
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.node_starts.len() - 1
    }

    /// Internal force on a node in the last kernel call \[N\]: the sum over its chunks in a fixed order.
    #[inline]
    pub fn force_on(&self, node: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &at in &self.contributions[self.node_starts[node] as usize..self.node_starts[node + 1] as usize] {
            let part = self.partial_n[at as usize];
            for i in 0..3 {
                sum[i] += part[i];
            }
        }
        sum
    }

    /// Global nodes `[lane][node]` of a block.
    pub fn global_nodes(&self, block: usize) -> [[u32; 8]; LANES] {
        let first = self.chunk_starts[block / self.chunk_blocks] as usize;
        self.blocks[block].nodes.map(|lane| lane.map(|n| self.chunk_nodes[first + n as usize]))
    }

    /// Elements of a block, in lane order.
    pub fn elements_of(&self, block: usize) -> impl Iterator<Item = usize> + '_ {
        self.lanes[block].iter().filter(|e| **e != NO_ELEMENT).map(|e| *e as usize)
    }

    /// Elements that touch a node, in element order.
    pub fn elements_at(&self, node: usize) -> impl Iterator<Item = usize> + '_ {
        self.node_elements[self.element_starts[node] as usize..self.element_starts[node + 1] as usize]
            .iter()
            .map(|e| *e as usize)
    }

    /// Forces of one element on its nodes by its stresses and its last bulk viscosity, at the positions `x` \[N\].
    pub fn element_force(&self, element: usize, x: &[[f64; 3]]) -> [[f64; 3]; 8] {
        let (block, lane) = self.place[element];
        let (force, _) = self.still(block as usize, x);
        of_lane(&force, lane)
    }

    /// The same of some elements, block by block.
    pub fn element_forces(&self, elements: &[usize], x: &[[f64; 3]]) -> Vec<(usize, [[f64; 3]; 8])> {
        let mut places: Vec<(u32, u8, usize)> =
            elements.iter().map(|e| (self.place[*e].0, self.place[*e].1, *e)).collect();
        places.sort_unstable();
        let mut list = Vec::with_capacity(places.len());
        for of_block in places.chunk_by(|a, b| a.0 == b.0) {
            let (force, _) = self.still(of_block[0].0 as usize, x);
            list.extend(of_block.iter().map(|(_, lane, e)| (*e, of_lane(&force, *lane))));
        }
        list
    }

    /// Bound of the largest squared frequency of each element at the positions `x` \[1/s²\]; 0 where it does not act.
    pub fn element_bounds_1_s2(&self, x: &[[f64; 3]]) -> Vec<f64> {
        let mut bounds = vec![0.0; self.elements()];
        for block in 0..self.blocks.len() {
            let (_, bound) = self.still(block, x);
            self.elements_of(block).zip(bound).for_each(|(e, b)| bounds[e] = b);
        }
        bounds
    }

    /// Nodal forces and frequency bounds of a block at the positions `x`, without a change of its state.
    fn still(&self, index: usize, x: &[[f64; 3]]) -> (BlockForce, [f64; LANES]) {
        let block = &self.blocks[index];
        let nodes = self.global_nodes(index);
        let at = std::array::from_fn(|c| std::array::from_fn(|l| x[nodes[l][c / 3] as usize][c % 3]));
        let mut elastic = block.material.lanes();
        elastic.yield_scale = [f64::INFINITY; LANES];
        let (mut state, mut force) = (block.state, [[0.0; LANES]; 24]);
        for i in 0..3 {
            for l in 0..LANES {
                state.stress[i][l] += state.viscous_pa[l];
            }
        }
        let (table, increment) = (&self.tables[block.material.table], [[0.0; LANES]; 24]);
        let step = KernelStep { dt_s: 1.0, viscous: false };
        let bound = match &block.full {
            Some(points) => {
                let points = &mut points.clone();
                for stress in &mut points.stress {
                    for i in 0..3 {
                        for l in 0..LANES {
                            stress[i][l] += state.viscous_pa[l];
                        }
                    }
                }
                full::update(&at, &increment, 1.0, &elastic, table, &mut state, points, &mut force, step)
            }
            None => update_block(&at, &increment, &elastic, table, &mut state, &mut force, step),
        };
        (force, bound)
    }

    /// Acting share of an element.
    pub fn share(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].state.share[lane as usize]
    }

    /// Sets the acting share of an element.
    pub fn set_share(&mut self, element: usize, share: f64) {
        let (place, lane) = self.place[element];
        let block = &mut self.blocks[place as usize];
        self.dead += usize::from(share == 0.0 && block.state.share[lane as usize] > 0.0);
        block.state.share[lane as usize] = share;
        block.acts = block.state.share.iter().any(|s| *s > 0.0);
        self.quiet[place as usize / self.chunk_blocks].wake();
    }

    /// Elements that failed in the last pass of the kernel, in the order of the chunks.
    pub(super) fn failing(&self) -> Vec<(usize, Failing)> {
        let mut list = Vec::new();
        for (c, quiet) in self.quiet.iter().enumerate() {
            for failing in &quiet.failing {
                let (block, lane) = failing.place;
                let element = self.lanes[c * self.chunk_blocks + block as usize][lane as usize];
                list.push((element as usize, *failing));
            }
        }
        list
    }

    /// Takes forces of an element on its nodes \[N\] out of the sums of the last pass.
    pub(super) fn take_out(&mut self, element: usize, force_n: &[[f64; 3]; 8]) {
        let (block, lane) = self.place[element];
        let first = block as usize / self.chunk_blocks * self.stride;
        for (local, force) in self.blocks[block as usize].nodes[lane as usize].iter().zip(force_n) {
            for i in 0..3 {
                self.partial_n[first + *local as usize][i] -= force[i];
            }
        }
    }

    /// Puts forces on nodes \[N\] into the sums, after the elements were connected anew.
    pub(super) fn put_in(&mut self, forces: impl Iterator<Item = (usize, [f64; 3])>) {
        for (node, force) in forces {
            if let Some(at) = self.contributions[self.node_starts[node] as usize..].first() {
                for i in 0..3 {
                    self.partial_n[*at as usize][i] += force[i];
                }
            }
        }
    }

    /// History and constants of an element: its block and lane.
    pub(super) fn of_element(&self, element: usize) -> (&Block, usize) {
        let (block, lane) = self.place[element];
        (&self.blocks[block as usize], lane as usize)
    }

    /// Nodes of all elements.
    pub(super) fn element_nodes(&self) -> &[[u32; 8]] {
        &self.element_nodes
    }

    /// Nodes of an element.
    pub fn nodes_of(&self, element: usize) -> [usize; 8] {
        self.element_nodes[element].map(|n| n as usize)
    }

    /// Gives an element other nodes, a share of its yield stress, and a life without erosion by strain.
    pub(super) fn detach(&mut self, element: usize, copies: &[[usize; 2]], strength: f64) {
        for n in &mut self.element_nodes[element] {
            if let Some([_, new]) = copies.iter().find(|[old, _]| *old == *n as usize) {
                *n = *new as u32;
            }
        }
        let (block, lane) = self.place[element];
        self.blocks[block as usize].material.edit(|material| {
            material.yield_scale[lane as usize] *= strength;
            material.critical_strain[lane as usize] = f64::INFINITY;
        });
        self.detached.resize(self.place.len(), false);
        self.detached[element] = true;
    }

    /// Whether an element was detached from its neighbours.
    pub fn is_detached(&self, element: usize) -> bool {
        self.detached.get(element) == Some(&true)
    }

    /// Gives an element another mass.
    pub(super) fn set_mass_kg(&mut self, element: usize, mass_kg: f64) {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].material.edit(|material| material.mass_kg[lane as usize] = mass_kg);
    }

    /// Equivalent plastic strain of an element.
    pub fn plastic_strain(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].state.plastic_strain[lane as usize]
    }

    /// Largest crack strain so far of an element of concrete; 0 for other laws.
    pub fn crack_strain(&self, element: usize) -> f64 {
        let (block, lane) = self.place[element];
        self.blocks[block as usize].concrete.as_ref().map_or(0.0, |c| c.states[lane as usize].crack)
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
            for lane in 0..LANES {
                sum[0] += block.state.internal_j[lane];
                sum[1] += block.state.hourglass_j[lane];
                sum[2] += block.state.viscous_j[lane];
            }
        }
        sum
    }
}

/// The rest of a chunk.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Quiet {
    /// Whether its nodes stood still in the last pass that found its forces.
    pub(super) still: bool,
    /// Passes in which the chunk was skipped, times its lanes.
    pub(super) skipped: u64,
    /// Elements that failed in the last pass.
    pub(super) failing: Vec<Failing>,
}

/// An element that failed in a pass of the kernel.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
pub struct Failing {
    /// Block in the chunk, and lane.
    pub(super) place: (u32, u8),
    /// Work of its forces over the last increment \[J\].
    pub(super) work_j: f64,
    /// Its forces on its nodes \[N\], which are in no sum.
    pub(super) force_n: [[f64; 3]; 8],
}

impl Quiet {
    /// Makes the next pass compute the chunk.
    pub(super) fn wake(&mut self) {
        self.still = false;
    }
}

/// Consecutive groups of at most a block's elements that share a law.
fn runs<'a, T>(order: &'a [T], law: impl Fn(&T) -> usize + 'a) -> impl Iterator<Item = &'a [T]> {
    let mut first = 0;
    std::iter::from_fn(move || {
        let here = law(order.get(first)?);
        let count = order[first..].iter().take(LANES).take_while(|e| law(e) == here).count();
        first += count;
        Some(&order[first - count..first])
    })
}

/// Elements by law, within a law along a Z-order curve through their centres (Morton 1966).
fn packing_order(mesh: &Mesh) -> Vec<usize> {
    let centers: Vec<[f64; 3]> = (0..mesh.elements.len()).map(|e| mesh.center(e)).collect();
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for c in &centers {
        for i in 0..3 {
            low[i] = low[i].min(c[i]);
            high[i] = high[i].max(c[i]);
        }
    }
    let extent = (0..3).map(|i| high[i] - low[i]).fold(f64::MIN_POSITIVE, f64::max);
    let key = |c: &[f64; 3]| {
        let cell: [u64; 3] = std::array::from_fn(|i| ((c[i] - low[i]) / extent * 1_048_575.0) as u64);
        (0..20).fold(0u64, |key, bit| {
            let digit = (0..3).fold(0, |d, i| d | ((cell[i] >> bit) & 1) << i);
            key | digit << (3 * bit)
        })
    };
    let keys: Vec<u64> = centers.iter().map(key).collect();
    let mut order: Vec<usize> = (0..mesh.elements.len()).collect();
    order.sort_by_key(|e| (mesh.elements[*e].law, keys[*e], *e));
    order
}

/// Packs elements of one law into a block; its nodes come later.
fn block(mesh: &Mesh, concretes: &ConcretePoints, elements: &[usize]) -> Block {
    let table = mesh.elements[elements[0]].law;
    let form = mesh.laws[table].form;
    let mut material = BlockMaterial { table, form, ..Default::default() };
    let full = (form == ElementForm::FullyIntegrated).then(Box::default);
    let mut state = BlockState::default();
    for lane in 0..LANES {
        let index = elements[lane.min(elements.len() - 1)];
        let element = &mesh.elements[index];
        let law = &mesh.laws[element.law];
        let e = law.youngs_modulus_pa * element.smear;
        let nu = law.poisson_ratio;
        material.lambda_pa[lane] = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        material.mu_pa[lane] = 0.5 * e / (1.0 + nu);
        material.yield_scale[lane] = element.smear * element.strength;
        material.mass_kg[lane] =
            law.density_kg_m3 * element.smear * volume_m3(&element.nodes.map(|n| mesh.nodes[n]));
        material.critical_strain[lane] = law.erosion.plastic_strain;
        state.share[lane] = if lane < elements.len() { 1.0 } else { 0.0 };
    }
    let material = PackedMaterial::new(&material);
    let concrete = concretes.block(&mesh.laws[table], elements);
    Block { state, material, nodes: [[0; 8]; LANES], full, concrete, largest_bound: 0.0, acts: true }
}

/// Forces on the nodes of one of the elements of a block \[N\].
fn of_lane(force: &BlockForce, lane: u8) -> [[f64; 3]; 8] {
    std::array::from_fn(|node| std::array::from_fn(|i| force[3 * node + i][lane as usize]))
}
