//! One pass of the kernel over all blocks: gather, kernel, end of failed elements, sum of forces, chunk by chunk.

use super::blocks::{Block, Blocks, CHUNK_BLOCKS};
use super::kernel::{self, BlockForce, KernelStep, LANES};
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
    /// their volume, end in this pass, before their forces act; `None`: none ends.
    pub end_above: Option<f64>,
}

/// Motion of a chunk's nodes: x, y, z and velocity, on one cache line each.
type LocalNode = [f64; 8];

impl Blocks {
    /// Kernel over all blocks that still act, with nodes at `x` (positions at the end of the increment) and velocities `v`.
    pub fn sweep(&mut self, x: &[[f64; 3]], v: &[[f64; 3]], sweep: &Sweep, parallel: bool) {
        let (stride, tables) = (self.stride, &self.tables[..]);
        let (starts, nodes) = (&self.chunk_starts[..], &self.chunk_nodes[..]);
        let run = |local: &mut Vec<LocalNode>,
                   (c, (blocks, forces)): (usize, (&mut [Block], &mut [[f64; 3]]))| {
            let nodes = &nodes[starts[c] as usize..starts[c + 1] as usize];
            chunk(blocks, &mut forces[..nodes.len()], nodes, local, tables, x, v, sweep);
        };
        let new_buffer = || vec![[0.0; 8]; stride];
        if parallel {
            let chunks = self.blocks.par_chunks_mut(CHUNK_BLOCKS).zip(self.partial_n.par_chunks_mut(stride));
            chunks.enumerate().for_each_init(new_buffer, run);
        } else {
            let mut local = new_buffer();
            let chunks = self.blocks.chunks_mut(CHUNK_BLOCKS).zip(self.partial_n.chunks_mut(stride.max(1)));
            chunks.enumerate().for_each(|work| run(&mut local, work));
        }
    }
}

/// One chunk. The instruction set is chosen once a call.
#[multiversion::multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[expect(clippy::too_many_arguments, reason = "a hot loop on plain arrays")]
fn chunk(
    blocks: &mut [Block],
    forces: &mut [[f64; 3]],
    nodes: &[u32],
    local: &mut [LocalNode],
    tables: &[HardeningTable],
    x: &[[f64; 3]],
    v: &[[f64; 3]],
    sweep: &Sweep,
) {
    forces.fill([0.0; 3]);
    if blocks.iter().all(|b| !b.acts) {
        return;
    }
    for (here, n) in local.iter_mut().zip(nodes) {
        let (p, w) = (x[*n as usize], v[*n as usize]);
        *here = [p[0], p[1], p[2], 0.0, w[0], w[1], w[2], 0.0];
    }
    let (mut at, mut moved): (BlockForce, BlockForce) = ([[0.0; LANES]; 24], [[0.0; LANES]; 24]);
    let mut force: BlockForce = [[0.0; LANES]; 24];
    for block in blocks {
        if !block.acts {
            block.largest_bound = 0.0;
            block.ended = 0;
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
        let (material, state) = (&block.material, &mut block.state);
        let mut bound =
            kernel::update(&at, &moved, sweep.dt_s, material, table, state, &mut force, sweep.step);
        if let Some(limit) = sweep.end_above {
            end_failed(block, limit, &mut bound, &mut force);
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

/// Ends the lanes that have failed: no share, no force, no bound.
#[inline(always)]
fn end_failed(block: &mut Block, limit: f64, bound: &mut [f64; LANES], force: &mut BlockForce) {
    block.ended = 0;
    let mut failures = 0;
    for l in 0..LANES {
        let eroded = block.state.plastic_strain[l] >= block.material.critical_strain[l];
        let healthy = bound[l] > 0.0 && bound[l] <= limit;
        failures += u32::from(block.state.share[l] > 0.0 && (eroded || !healthy));
    }
    if failures == 0 {
        return;
    }
    for l in 0..LANES {
        let eroded = block.state.plastic_strain[l] >= block.material.critical_strain[l];
        let healthy = bound[l] > 0.0 && bound[l] <= limit;
        if block.state.share[l] > 0.0 && (eroded || !healthy) {
            block.ended |= 1 << l;
            block.state.share[l] = 0.0;
            bound[l] = 0.0;
            force.iter_mut().for_each(|f| f[l] = 0.0);
        }
    }
    block.acts = block.state.share.iter().any(|s| *s > 0.0);
}
