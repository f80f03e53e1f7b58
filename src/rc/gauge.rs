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
    /// Height of the middle of the gauge of `bar_max`, of `bar_min` and of `face` above the end section \[m\].
    pub heights_m: [f64; 3],
}

impl EndStrains {
    /// Progress to the first yield, 1 when it is reached: a bar at its yield strain in tension or compression, or the compressed face at
    /// [`YIELD_STRAIN_C`].
    pub fn to_yield(&self, yield_strain: f64) -> f64 {
        self.shares(yield_strain).into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// Height of the middle of the gauge that is nearest to the first yield \[m\]: the moment there belongs to its strain.
    pub fn height_m(&self, yield_strain: f64) -> f64 {
        let shares = self.shares(yield_strain);
        let nearest = (0..3).max_by(|a, b| shares[*a].total_cmp(&shares[*b]));
        self.heights_m[nearest.unwrap_or(2)]
    }

    fn shares(&self, yield_strain: f64) -> [f64; 3] {
        [self.bar_max / yield_strain, -self.bar_min / yield_strain, self.face / YIELD_STRAIN_C]
    }
}

/// The gauges of a run. Strains are averaged from one reading to the next, as forces are.
#[derive(Debug, Clone)]
pub struct Gauge {
    bars: Vec<usize>,
    /// Lower and upper node of each line of the compressed face.
    face: Vec<[usize; 2]>,
    face_m: f64,
    /// Height of the middle of each bar's element \[m\].
    middles_m: Vec<f64>,
    sum: [f64; 3],
    /// Gauges of the bars with the extreme strains of the last look.
    extreme: [f64; 2],
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
        let middle = |b: &usize| {
            let [below, above] = member.mesh.trusses[*b].nodes;
            0.5 * (nodes[below][2] + nodes[above][2])
        };
        let (bars, middles_m) = (member.bars.clone(), member.bars.iter().map(middle).collect());
        Self { bars, face, face_m, middles_m, sum: [0.0; 3], extreme: [0.0; 2], count: 0.0 }
    }

    /// Takes the present strains into the mean.
    pub fn take(&mut self, body: &Dynamics) {
        let strain = |b: &usize| {
            let [start, now] = body.trusses.bars[*b].length_m;
            now / start - 1.0
        };
        let (mut low, mut high) = (0.0, 0.0);
        for (bar, middle_m) in self.bars.iter().zip(&self.middles_m) {
            let now = strain(bar);
            if now > high {
                (high, self.extreme[0]) = (now, *middle_m);
            }
            if now < low {
                (low, self.extreme[1]) = (now, *middle_m);
            }
        }
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
        let heights_m = [self.extreme[0], self.extreme[1], 0.5 * self.face_m];
        EndStrains { bar_max, bar_min, face, heights_m }
    }
}

fn same_line(a: [f64; 3], b: [f64; 3]) -> bool {
    (a[0] - b[0]).abs() < SAME_M && (a[1] - b[1]).abs() < SAME_M
}
