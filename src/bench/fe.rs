//! Throughput of the explicit solver on a block of elements.
//!
//! The block is a cube of hexahedra of 0.4 m. Flowing: it is compressed at 1 1/s between its moving end planes, with an isochoric
//! initial velocity field, so that almost all elements flow. Elastic: the same with a yield stress never reached.
//!
//! **Traffic.** The least that one cycle of the current data layout moves between memory and processor if nothing stays in a cache from
//! one chunk, or one pass, to the next: see [`traffic_bytes`].
//!
//! **Operations.** Additions, subtractions, multiplications, divisions and square roots of one element, counted in the AVX-512
//! code of `sweep::chunk_in`, where a vector instruction is one operation of each of the eight elements of a block.

use super::bandwidth::triad_bytes_per_s;
use crate::base::isa::Isa;
use crate::fe::blocks::Block;
use crate::fe::contact::RigidSurfaces;
use crate::fe::dynamics::Dynamics;
use crate::fe::full::FullState;
use crate::fe::kernel::BlockState;
use crate::fe::law::{ElementForm, Law};
use crate::fe::shapes::{elastic, grid, point};
use serde::Serialize;
use std::mem::size_of;
use std::time::Instant;

/// Repetitions after the warm-up; the median counts.
const REPETITIONS: usize = 3;
/// Edge of the elements \[m\].
const EDGE_M: f64 = 0.4;
/// Rate of compression \[1/s\].
const RATE_1_S: f64 = 1.0;

/// What to measure.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Elements, about.
    pub elements: usize,
    /// Time steps a repetition.
    pub cycles: usize,
    /// Threads of the pool in which it runs.
    pub threads: usize,
    /// Element form.
    pub form: ElementForm,
    /// Whether the elements flow.
    pub flowing: bool,
    /// Instruction set of the kernel.
    pub isa: Isa,
}

/// What was measured.
#[derive(Debug, Clone, Serialize)]
pub struct Throughput {
    /// Elements over time steps a second of wall time, median of the repetitions.
    pub element_cycles_per_s: f64,
    /// The same of each repetition, in order.
    pub repetitions: Vec<f64>,
    /// Least memory traffic of an element over a time step \[bytes\].
    pub bytes_per_element_cycle: f64,
    /// Operations of an element over a time step.
    pub flops_per_element_cycle: f64,
    /// Bandwidth of the triad with the same threads \[bytes/s\].
    pub triad_bytes_per_s: f64,
    /// Time of the least traffic at that bandwidth over the measured time.
    pub share_of_floor: f64,
    /// Share of the elements that flowed within the measured cycles.
    pub flowing_share: f64,
    /// Elements.
    pub elements: usize,
    /// Time steps a repetition.
    pub cycles: usize,
    /// Threads.
    pub threads: usize,
    /// Instruction set of the kernel.
    pub isa: Isa,
    /// Processor.
    pub machine: String,
}

/// Measures; `Err` if the block does not stay whole.
pub fn measure(settings: &Settings) -> Result<Throughput, String> {
    let mut body = block(settings);
    let count = body.blocks.elements();
    advance(&mut body, settings.cycles);
    let before: Vec<f64> = (0..count).map(|e| body.blocks.plastic_strain(e)).collect();
    let mut rates = Vec::new();
    for _ in 0..REPETITIONS {
        let start = Instant::now();
        advance(&mut body, settings.cycles);
        rates.push((count * settings.cycles) as f64 / start.elapsed().as_secs_f64());
    }
    if let Some(node) = body.broken_node() {
        return Err(format!("node {node} is nowhere after {} steps", body.steps));
    }
    let flowed = (0..count).filter(|e| body.blocks.plastic_strain(*e) > before[*e]).count();
    let mut sorted = rates.clone();
    sorted.sort_by(f64::total_cmp);
    let rate = sorted[REPETITIONS / 2];
    let bytes = traffic_bytes(&body) as f64 / count as f64;
    let triad = triad_bytes_per_s(settings.threads);
    Ok(Throughput {
        element_cycles_per_s: rate,
        repetitions: rates,
        bytes_per_element_cycle: bytes,
        flops_per_element_cycle: if settings.flowing { FLOPS_FLOWING } else { FLOPS_ELASTIC },
        triad_bytes_per_s: triad,
        share_of_floor: bytes / triad * rate,
        flowing_share: flowed as f64 / count as f64,
        elements: count,
        cycles: settings.cycles,
        threads: settings.threads,
        isa: settings.isa,
        machine: machine(),
    })
}

fn advance(body: &mut Dynamics, cycles: usize) {
    rayon::scope(|_| (0..cycles).for_each(|_| _ = body.step(false)));
}

fn block(settings: &Settings) -> Dynamics {
    let n = libm::cbrt(settings.elements as f64).round().max(1.0) as usize;
    let edge = EDGE_M * n as f64;
    let hardening = vec![point(0.0, 10.5e6), point(0.01, 11.55e6), point(0.1, 12.25e6)];
    let mut law = Law { youngs_modulus_pa: 16.5e9, form: settings.form, ..elastic() };
    if settings.flowing {
        law.hardening = hardening;
    }
    let mesh = grid([n; 3], [edge; 3], law, |_| false);
    let mut body = Dynamics::new(&mesh, 0.0, RigidSurfaces::default(), settings.threads > 1);
    body.isa = settings.isa;
    for (node, p) in mesh.nodes.iter().enumerate() {
        let [x, y, z] = p.map(|c| RATE_1_S * (c - 0.5 * edge));
        body.v[node] = [0.5 * x, 0.5 * y, -z];
        if p[2] == 0.0 || p[2] == edge {
            body.prescribed_m_s[node][2] = Some(-z);
        }
    }
    body
}

/// Operations of a cycle of an elastic element (see the head of the file): 1803 vector instructions a block, and 24 scalar sums of forces.
pub const FLOPS_ELASTIC: f64 = 1827.0;
/// Operations of a cycle of a flowing element on a segment of the hardening table: the elastic ones and the radial return.
pub const FLOPS_FLOWING: f64 = 1845.0;

/// Least memory traffic of one cycle of a whole body \[bytes\], from the mesh as it is packed:
/// * a block is read whole (history, constants, local node numbers); its history and the line with its bound are written; fully
///   integrated elements have the history of their points besides, read and written;
/// * a node of a chunk: its number, position and velocity are read, its force is written; in the motion the place of this force and the
///   force are read again. Nodes on the border of chunks count in each of them;
/// * a node in the motion: position and velocity read and written, mass, two flags and the start of its list read; where its motion is
///   given, that too.
pub fn traffic_bytes(body: &Dynamics) -> usize {
    const LINE: usize = 64;
    let blocks = &body.blocks;
    let block = |b: &Block| {
        let points = if b.full.is_some() { 2 * size_of::<FullState>() } else { 0 };
        size_of::<Block>() + size_of::<BlockState>() + LINE + points
    };
    let (vector, index) = (size_of::<[f64; 3]>(), size_of::<u32>());
    let chunk_nodes: usize = (0..blocks.chunks()).map(|c| blocks.nodes_of_chunk(c).len()).sum();
    let chunk_node = index + 2 * vector + vector + index + vector;
    let node = 4 * vector + size_of::<f64>() + 2 * size_of::<bool>() + index;
    let driven = (0..blocks.nodes()).filter(|n| body.prescribed_m_s.is_set(*n)).count();
    blocks.blocks.iter().map(block).sum::<usize>()
        + chunk_nodes * chunk_node
        + blocks.nodes() * node
        + driven * size_of::<[Option<f64>; 3]>()
}

/// The processor as the system names it.
pub fn machine() -> String {
    let names = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = names.lines().find(|l| l.starts_with("model name")).and_then(|l| l.split(": ").nth(1));
    format!("{} ({})", name.unwrap_or("processor unknown"), std::env::consts::ARCH)
}
