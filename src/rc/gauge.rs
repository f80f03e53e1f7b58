//! Strains of a bent member end, as gauges on its bars and on the compressed face would show them: what tells the first yield.

use super::member::RcMember;
use crate::fe::dynamics::Dynamics;

/// Least length over which the strain of the compressed face is measured, in sides of the section along the push.
const FACE_DEPTHS: f64 = 0.125;
/// Coordinates closer than this are one \[m\].
const SAME_M: f64 = 1e-6;
/// Strain of the compressed face that counts as first yield of the section (Priestley, Calvi and Kowalsky 2007).
pub const YIELD_STRAIN_C: f64 = 0.002;

/// Strains over lengths at the start, tension positive.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct EndStrains {
    /// Largest of a longitudinal bar's element.
    pub bar_max: f64,
    /// Smallest of one.
    pub bar_min: f64,
    /// Mean shortening of the compressed face beside the end section, compression positive.
    pub face: f64,
}

impl EndStrains {
    /// Progress to the first yield, 1 when it is reached: a bar at its yield strain in tension or compression, or the compressed face at
    /// [`YIELD_STRAIN_C`].
    pub fn to_yield(&self, yield_strain: f64) -> f64 {
        (self.bar_max.max(-self.bar_min) / yield_strain).max(self.face / YIELD_STRAIN_C)
    }
}

/// The gauges of a run. Strains are averaged from one reading to the next, as forces are.
#[derive(Debug, Clone)]
pub struct Gauge {
    bars: Vec<usize>,
    /// Lower and upper node of each line of the compressed face.
    face: Vec<[usize; 2]>,
    face_m: f64,
    sum: [f64; 3],
    count: f64,
}

impl Gauge {
    /// Gauges of a member whose free end is pushed along a unit vector.
    pub fn of(member: &RcMember, direction: [f64; 2]) -> Self {
        let nodes = &member.mesh.nodes;
        let ahead = |n: usize| direction[0] * nodes[n][0] + direction[1] * nodes[n][1];
        let at_end: Vec<usize> = (0..nodes.len()).filter(|n| nodes[*n][2].abs() < SAME_M).collect();
        let inside = |n: &&usize| member.tip.iter().any(|(t, _)| same_line(nodes[*t], nodes[**n]));
        let at_end: Vec<usize> = at_end.iter().filter(inside).copied().collect(); // not the margin of a block
        let reach = at_end.iter().map(|n| ahead(*n)).fold(f64::NEG_INFINITY, f64::max);
        let least = FACE_DEPTHS * 2.0 * reach - SAME_M;
        let heights = nodes.iter().map(|x| x[2]).filter(|z| *z >= least);
        let face_m = heights.fold(f64::INFINITY, f64::min);
        let above = |n: usize| {
            (0..nodes.len())
                .find(|m| (nodes[*m][2] - face_m).abs() < SAME_M && same_line(nodes[*m], nodes[n]))
        };
        let front = at_end.iter().filter(|n| ahead(**n) > reach - SAME_M);
        let face = front.filter_map(|n| Some([*n, above(*n)?])).collect();
        Self { bars: member.bars.clone(), face, face_m, sum: [0.0; 3], count: 0.0 }
    }

    /// Takes the present strains into the mean.
    pub fn take(&mut self, body: &Dynamics) {
        let strain = |b: &usize| {
            let [start, now] = body.trusses.bars[*b].length_m;
            now / start - 1.0
        };
        let widest = |(low, high): (f64, f64), s: f64| (low.min(s), high.max(s));
        let (low, high) = self.bars.iter().map(strain).fold((0.0, 0.0), widest);
        let lines = self.face.iter().map(|[below, above]| body.x[*above][2] - body.x[*below][2]);
        let shortened = self.face_m - lines.sum::<f64>() / self.face.len().max(1) as f64;
        for (sum, value) in self.sum.iter_mut().zip([high, low, shortened / self.face_m]) {
            *sum += value;
        }
        self.count += 1.0;
    }

    /// Mean since the last reading.
    pub fn read(&mut self) -> EndStrains {
        let [bar_max, bar_min, face] = self.sum.map(|s| s / f64::max(self.count, 1.0));
        (self.sum, self.count) = ([0.0; 3], 0.0);
        EndStrains { bar_max, bar_min, face }
    }
}

fn same_line(a: [f64; 3], b: [f64; 3]) -> bool {
    (a[0] - b[0]).abs() < SAME_M && (a[1] - b[1]).abs() < SAME_M
}
