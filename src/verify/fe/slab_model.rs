//! The slab of the blast contest: sizes, strengths, load and mesh.
//!
//! A quarter of the slab: mid-span at x = 0, mid-width at y = 0, unloaded face at z = 0. All sizes are whole inches or fractions in the source.

use crate::fe::law::Law;
use crate::fe::mesh::{Mesh, Truss};
use crate::fe::shapes::grid;
use crate::material::concrete::ConcreteLaw;
use crate::material::rebar::{Hardening, LoopShape, RebarLaw};

const INCH_M: f64 = 0.0254;
/// Length of the slab \[m\].
pub const LENGTH_M: f64 = 64.0 * INCH_M;
/// Width \[m\].
pub const WIDTH_M: f64 = 33.75 * INCH_M;
/// Thickness \[m\].
pub const HEIGHT_M: f64 = 4.0 * INCH_M;
/// Between the supports \[m\].
pub const SPAN_M: f64 = 52.0 * INCH_M;
/// Bars along the span.
pub const BARS: usize = 9;
/// Cross-section of a No. 3 bar \[m²\].
pub const BAR_AREA_M2: f64 = 71e-6;
/// Spacing of the bars along the span, distance of their centre from the unloaded face \[m\].
const BAR_SPACING_M: f64 = 4.0 * INCH_M;
const BAR_HEIGHT_M: f64 = INCH_M;
/// Cross bars of a half: six of them at 12 in in the slab.
const CROSS_BARS_M: [f64; 3] = [6.0 * INCH_M, 18.0 * INCH_M, 30.0 * INCH_M];

/// Effective depth \[m\].
pub fn depth_m() -> f64 {
    HEIGHT_M - BAR_HEIGHT_M
}

/// How the pressure runs in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Load {
    /// The record of the test, in straight lines between its turns.
    Record,
    /// `p (1 - t / T) exp(-b t / T)` with the peak, the impulse and the duration of the record.
    Exponential,
}

/// Impulse \[Pa s\] and duration \[s\] of the load, and its peak \[Pa\].
const IMPULSE_PA_S: f64 = 7.0e3;
const DURATION_S: f64 = 80e-3;
const PEAK_PA: f64 = 345e3;

/// Turns of the record `[ms, kPa]` as read off the plot in the source; scaled to the impulse (by less than 1 %).
const RECORD: [[f64; 2]; 25] = [
    [0.0, 0.0],
    [0.2, 214.0],
    [1.2, 200.0],
    [2.5, 252.0],
    [4.2, 238.0],
    [5.5, 286.0],
    [6.8, 343.0],
    [7.6, 303.0],
    [9.2, 269.0],
    [11.5, 197.0],
    [13.0, 169.0],
    [15.5, 141.0],
    [18.5, 109.0],
    [19.5, 103.0],
    [20.5, 117.0],
    [26.0, 112.0],
    [31.5, 85.0],
    [37.0, 69.0],
    [43.0, 57.0],
    [49.0, 46.0],
    [55.0, 31.0],
    [60.0, 21.0],
    [66.0, 9.0],
    [74.0, 5.5],
    [80.0, 0.0],
];

/// Pressure on the loaded face \[Pa\].
pub fn pressure_pa(load: Load, time_s: f64) -> f64 {
    if !(0.0..DURATION_S).contains(&time_s) {
        return 0.0;
    }
    match load {
        Load::Exponential => {
            let x = time_s / DURATION_S;
            PEAK_PA * (1.0 - x) * libm::exp(-decay() * x)
        }
        Load::Record => {
            let i = RECORD.partition_point(|p| p[0] <= 1e3 * time_s).clamp(1, RECORD.len() - 1);
            let ([t0, p0], [t1, p1]) = (RECORD[i - 1], RECORD[i]);
            let read = p0 + (p1 - p0) * (1e3 * time_s - t0) / (t1 - t0);
            let impulse: f64 =
                RECORD.windows(2).map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0])).sum();
            1e3 * read * IMPULSE_PA_S / impulse
        }
    }
}

/// The decay `b` for the impulse: `1 / b - (1 - exp(-b)) / b² = I / (p T)`.
fn decay() -> f64 {
    let (mut low, mut high) = (0.01_f64, 50.0_f64);
    for _ in 0..60 {
        let b = 0.5 * (low + high);
        let impulse = 1.0 / b - (1.0 - libm::exp(-b)) / (b * b);
        if impulse > IMPULSE_PA_S / (PEAK_PA * DURATION_S) { low = b } else { high = b }
    }
    low
}

/// The concrete at rest.
pub fn concrete() -> ConcreteLaw {
    ConcreteLaw::of_strength(37e6)
}

/// The bars at rest: 496 MPa, 814 MPa at 8 %, rupture at 15 %. Hardening begins at 0.8 % (Priestley, Calvi and Kowalsky 2007). The exponent gives the
/// curve that ends at 15 % the initial slope of the parabola through 814 MPa at 8 %; it is 2 % below 814 MPa there.
pub fn steel() -> RebarLaw {
    let (start, ultimate, rupture) = (0.008, 0.08, 0.15);
    RebarLaw {
        youngs_modulus_pa: 200e9,
        yield_strength_pa: 496e6,
        hardening: Hardening::Plateau {
            start_strain: start,
            ultimate_strength_pa: 814e6,
            exponent: 2.0 * (rupture - start) / (ultimate - start),
        },
        ultimate_strain: rupture,
        loops: LoopShape::default(),
        buckling: None,
    }
}

/// How much of the width is modelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Breadth {
    /// From mid-width to the edge.
    Half,
    /// A half of the ninth of the slab that belongs to a bar, its far side free: the load is uniform and the slab spans one way.
    Strip,
}

/// The mesh with what loads and holds it.
#[derive(Debug, Clone)]
pub struct SlabModel {
    /// The mesh.
    pub mesh: Mesh,
    /// Faces under pressure, counter-clockwise seen from outside.
    pub faces: Vec<[usize; 4]>,
    /// Components that are held, by node.
    pub held: Vec<[bool; 3]>,
    /// Middle of the unloaded face.
    pub gauge: usize,
    /// Bars along the span: indices of their trusses from mid-span outward.
    pub bars: Vec<Vec<usize>>,
}

/// Index of the plane at a coordinate.
fn at(planes: &[f64], place_m: f64) -> usize {
    let distance = |i: &usize| (planes[*i] - place_m).abs();
    (0..planes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// Planes from zero through `ends`, not much further apart than `size`.
fn planes(ends: &[f64], size: f64) -> Vec<f64> {
    let mut planes = vec![0.0];
    for end in ends {
        let from = planes[planes.len() - 1];
        let count = ((end - from) / size).round().max(1.0) as usize;
        planes.extend((1..=count).map(|i| from + (end - from) * i as f64 / count as f64));
    }
    planes
}

impl SlabModel {
    /// The slab with `layers` elements through its thickness (a multiple of four: a plane runs through the bars), with strengths at these rates of steel and
    /// concrete \[1/s\].
    pub fn new(layers: usize, breadth: Breadth, [steel_1_s, concrete_1_s]: [f64; 2]) -> Self {
        let size = HEIGHT_M / layers as f64;
        let x = planes(&[0.5 * LENGTH_M], size);
        let y = match breadth {
            Breadth::Half => planes(&[4.0 * BAR_SPACING_M, 0.5 * WIDTH_M], size),
            Breadth::Strip => planes(&[0.5 * WIDTH_M / BARS as f64], size),
        };
        let z = planes(&[HEIGHT_M], size);
        let counts = [x.len() - 1, y.len() - 1, z.len() - 1];
        let law = Law::from(concrete().at_rate(concrete_1_s));
        let mut mesh = grid(counts, counts.map(|c| c as f64), law, |_| false);
        mesh.laws.push(steel().at_rate(steel_1_s).into());
        for node in &mut mesh.nodes {
            let index = node.map(|c| c.round() as usize);
            *node = [x[index[0]], y[index[1]], z[index[2]]];
        }
        let id = |i: usize, j: usize, k: usize| (k * y.len() + j) * x.len() + i;
        let level = at(&z, BAR_HEIGHT_M);
        let mut bars = Vec::new();
        for n in 0..=BARS / 2 {
            let place = BAR_SPACING_M * n as f64;
            if place > y[y.len() - 1] {
                break;
            }
            let (j, share) = (at(&y, place), if n == 0 { 0.5 } else { 1.0 });
            let first = mesh.trusses.len();
            mesh.trusses.extend((1..x.len()).map(|i| bar([id(i - 1, j, level), id(i, j, level)], share)));
            bars.push((first..mesh.trusses.len()).collect());
        }
        for place in CROSS_BARS_M {
            let i = at(&x, place);
            mesh.trusses.extend((1..y.len()).map(|j| bar([id(i, j - 1, level), id(i, j, level)], 1.0)));
        }
        let top = z.len() - 1;
        let face =
            |i: usize, j: usize| [id(i, j, top), id(i + 1, j, top), id(i + 1, j + 1, top), id(i, j + 1, top)];
        let faces = (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| face(i, j))).collect();
        let support = x[at(&x, 0.5 * SPAN_M)];
        let held = mesh.nodes.iter().map(|p| [p[0] == 0.0, p[1] == 0.0, p[2] == 0.0 && p[0] == support]);
        Self { held: held.collect(), faces, gauge: id(0, 0, 0), bars, mesh }
    }
}

fn bar(nodes: [usize; 2], share: f64) -> Truss {
    Truss { nodes, area_m2: share * BAR_AREA_M2, part: 0, law: 1 }
}
