//! One pass of the kernel over all blocks: gather, kernel, search for failed elements, sum of forces, chunk by chunk.

use super::blocks::{Block, Blocks, Failing, Quiet};
use super::concrete;
use super::full;
use super::kernel::{self, BlockForce, KernelStep, LANES};
use super::law::{ElementForm, Hourglass};
use crate::base::isa::{Isa, for_each_isa};
use crate::base::prefetch::prefetch;
use crate::material::concrete::ConcretePoint;
use crate::material::j2::HardeningTable;
use rayon::prelude::*;

/// What a pass does.
#[derive(Debug, Clone, Copy)]
pub struct Sweep {
    /// Displacement increments are this time \[s\] times the velocities.
    pub dt_s: f64,
    /// Options of the kernel.
    pub step: KernelStep,
    /// Elements whose squared frequency bound \[1/s²\] is larger, or that have reached their critical plastic strain or lost
    /// their volume, fail in this pass: their forces are left out; `None`: none fails.
    pub drop_above: Option<f64>,
    /// Whether chunks whose nodes stand still keep their forces.
    pub skip_quiet: bool,
    /// Instruction set of the kernel.
    pub isa: Isa,
}

/// Motion of a chunk's nodes: x, y, z and velocity, on one cache line each.
type LocalNode = [f64; 8];

impl Blocks {
    /// Kernel over all blocks that still act, with nodes at `x` (positions at the end of the increment) and velocities `v`.
    pub fn sweep(&mut self, x: &[[f64; 3]], v: &[[f64; 3]], sweep: &Sweep, parallel: bool) {
        let stride = self.stride;
        let tables = (&self.tables[..], &self.concretes.points[..]);
        let (starts, nodes) = (&self.chunk_starts[..], &self.chunk_nodes[..]);
        let chunk_blocks = self.chunk_blocks;
        let run = |local: &mut Vec<LocalNode>, (c, ((blocks, quiet), forces)): ChunkWork| {
            let nodes = &nodes[starts[c] as usize..starts[c + 1] as usize];
            chunk_in(
                sweep.isa,
                blocks,
                quiet,
                &mut forces[..nodes.len()],
                nodes,
                &mut local[..nodes.len()],
                tables,
                x,
                v,
                sweep,
            );
        };
        let new_buffer = || vec![[0.0; 8]; stride];
        if parallel {
            let chunks = self.blocks.par_chunks_mut(chunk_blocks).zip(&mut self.quiet);
            chunks.zip(self.partial_n.par_chunks_mut(stride)).enumerate().for_each_init(new_buffer, run);
        } else {
            let mut local = new_buffer();
            let chunks = self.blocks.chunks_mut(chunk_blocks).zip(&mut self.quiet);
            chunks
                .zip(self.partial_n.chunks_mut(stride.max(1)))
                .enumerate()
                .for_each(|work| run(&mut local, work));
        }
    }

    /// Element-passes that were skipped because nothing moved, since the blocks were packed last.
    pub fn skipped(&self) -> u64 {
        self.quiet.iter().map(|q| q.skipped).sum()
    }

    /// The same in all.
    pub fn skipped_in_all(&self) -> u64 {
        self.skipped_before + self.skipped()
    }
}

/// Index of a chunk, its blocks, its rest, its forces.
type ChunkWork<'a> = (usize, ((&'a mut [Block], &'a mut Quiet), &'a mut [[f64; 3]]));

/// Whether all nodes of a chunk stand still, to the last bit: its forces are then those of the last pass, if they did so in that one too.
#[inline(always)]
fn is_still(local: &[LocalNode]) -> bool {
    for node in local {
        if node[4] != 0.0 || node[5] != 0.0 || node[6] != 0.0 {
            return false;
        }
    }
    true
}

for_each_isa! {
    /// [`chunk`] in the code of an instruction set.
    fn chunk_in = chunk(
        blocks: &mut [Block],
        quiet: &mut Quiet,
        forces: &mut [[f64; 3]],
        nodes: &[u32],
        local: &mut [LocalNode],
        laws: (&[HardeningTable], &[ConcretePoint]),
        x: &[[f64; 3]],
        v: &[[f64; 3]],
        sweep: &Sweep,
    )
}

/// One chunk.
#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
fn chunk(
    blocks: &mut [Block],
    quiet: &mut Quiet,
    forces: &mut [[f64; 3]],
    nodes: &[u32],
    local: &mut [LocalNode],
    (tables, concretes): (&[HardeningTable], &[ConcretePoint]),
    x: &[[f64; 3]],
    v: &[[f64; 3]],
    sweep: &Sweep,
) {
    quiet.failing.clear();
    if blocks.iter().all(|b| !b.acts) {
        forces.fill([0.0; 3]);
        return;
    }
    for (here, n) in local.iter_mut().zip(nodes) {
        let (p, w) = (x[*n as usize], v[*n as usize]);
        *here = [p[0], p[1], p[2], 0.0, w[0], w[1], w[2], 0.0];
    }
    let still = is_still(local);
    if sweep.skip_quiet && still && quiet.still {
        quiet.skipped += (LANES * blocks.iter().filter(|b| b.acts).count()) as u64;
        return;
    }
    quiet.still = still;
    forces.fill([0.0; 3]);
    let (mut at, mut moved): (BlockForce, BlockForce) = ([[0.0; LANES]; 24], [[0.0; LANES]; 24]);
    let mut force: BlockForce = [[0.0; LANES]; 24];
    for index in 0..blocks.len() {
        if let Some(next) = blocks.get(index + 1) {
            prefetch(next); // its way from memory overlaps with the work on this one
        }
        let block = &mut blocks[index];
        if !block.acts {
            block.largest_bound = 0.0;
            continue;
        }
        for lane in 0..LANES {
            for node in 0..8 {
                let here = &local[block.nodes[lane][node] as usize];
                for i in 0..3 {
                    at[3 * node + i][lane] = here[i];
                    moved[3 * node + i][lane] = here[4 + i];
                }
            }
        }
        let table = &tables[block.material.table];
        let (material, state) = (&block.material.lanes(), &mut block.state);
        let (dt_s, step) = (sweep.dt_s, sweep.step);
        let mut bound = match (&mut block.full, &mut block.concrete, material.form) {
            (_, Some(history), _) => {
                concrete::update(&at, &moved, dt_s, material, concretes, state, history, &mut force, step)
            }
            (None, None, ElementForm::OnePoint(Hourglass::Asqbi)) => {
                kernel::update::<true>(&at, &moved, dt_s, material, table, state, &mut force, step)
            }
            (None, None, _) => kernel::update_other_in(
                sweep.isa, &at, &moved, dt_s, material, table, state, &mut force, step,
            ),
            (Some(points), None, _) => {
                full::update(&at, &moved, dt_s, material, table, state, points, &mut force, step)
            }
        };
        if let Some(limit) = sweep.drop_above {
            let critical = &material.critical_strain;
            drop_failing(
                (index, block),
                critical,
                limit,
                (&moved, dt_s),
                &mut bound,
                &mut force,
                &mut quiet.failing,
            );
        }
        let mut largest = 0.0;
        for l in 0..LANES {
            largest = if bound[l] > largest { bound[l] } else { largest };
        }
        block.largest_bound = largest;
        for lane in 0..LANES {
            for node in 0..8 {
                let sum = &mut forces[block.nodes[lane][node] as usize];
                for i in 0..3 {
                    sum[i] += force[3 * node + i][lane];
                }
            }
        }
    }
}
/// Finds the lanes that have failed and takes their forces away; they are noted for [`super::erosion`].
#[inline(always)]
fn drop_failing(
    (index, block): (usize, &Block),
    critical_strain: &[f64; LANES],
    limit: f64,
    (moved, dt_s): (&BlockForce, f64),
    bound: &mut [f64; LANES],
    force: &mut BlockForce,
    failing: &mut Vec<Failing>,
) {
    let mut failed = [false; LANES];
    let mut count = 0;
    for l in 0..LANES {
        let eroded = block.state.plastic_strain[l] >= critical_strain[l];
        let healthy = bound[l] > 0.0 && bound[l] <= limit;
        failed[l] = block.state.share[l] > 0.0 && (eroded || !healthy);
        count += u32::from(failed[l]);
    }
    if count == 0 {
        return;
    }
    for l in (0..LANES).filter(|l| failed[*l]) {
        let work: f64 = (0..24).map(|c| force[c][l] * moved[c][l] * dt_s).sum();
        let work_j = if work.is_finite() { work } else { 0.0 };
        let finite = |f: f64| if f.is_finite() { f } else { 0.0 };
        let force_n = std::array::from_fn(|n| std::array::from_fn(|i| finite(force[3 * n + i][l])));
        failing.push(Failing { place: (index as u32, l as u8), work_j, force_n });
        bound[l] = 0.0;
        force.iter_mut().for_each(|f| f[l] = 0.0);
    }
}
