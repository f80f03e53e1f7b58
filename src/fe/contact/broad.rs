//! Cells of equal size that hold the nodes near a face ready.

use crate::base::vector::V3;
use serde::{Deserialize, Serialize};

/// Cells for each node, at most.
const CELLS_PER_NODE: f64 = 2.0;

/// Nodes sorted into a grid by their positions at one time. What flies far off (three standard deviations) is kept in the outermost
/// cells, so that a few lost pieces do not make the grid coarse.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Cells {
    low: V3,
    size_m: f64,
    count: [usize; 3],
    starts: Vec<u32>,
    /// Nodes with their positions at that time, cell after cell.
    nodes: Vec<(V3, u32)>,
}

impl Cells {
    /// Sorts the nodes that `counts` into cells of at least `size_m`.
    pub fn rebuild(&mut self, x: &[V3], counts: impl Fn(usize) -> bool, size_m: f64) {
        let chosen: Vec<u32> = (0..x.len() as u32).filter(|n| counts(*n as usize)).collect();
        let total = chosen.len().max(1) as f64;
        let (mut low, mut extent) = ([0.0; 3], [0.0; 3]);
        for i in 0..3 {
            let mean = chosen.iter().map(|n| x[*n as usize][i]).sum::<f64>() / total;
            let spread = chosen.iter().map(|n| (x[*n as usize][i] - mean).powi(2)).sum::<f64>() / total;
            let (least, most) = chosen
                .iter()
                .fold((mean, mean), |(a, b), n| (a.min(x[*n as usize][i]), b.max(x[*n as usize][i])));
            low[i] = least.max(mean - 3.0 * spread.sqrt());
            extent[i] = most.min(mean + 3.0 * spread.sqrt()) - low[i];
        }
        let cells = |size: f64| extent.map(|e| (e / size).floor() + 1.0);
        self.low = low;
        self.size_m = size_m;
        while cells(self.size_m).iter().product::<f64>() > CELLS_PER_NODE * total + 64.0 {
            self.size_m *= 1.25;
        }
        self.count = cells(self.size_m).map(|c| c as usize);
        let place = |n: &u32| self.index(self.cell(&x[*n as usize]));
        let mut starts = vec![0u32; self.count.iter().product::<usize>() + 1];
        chosen.iter().for_each(|n| starts[place(n) + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut nodes = vec![([0.0; 3], 0); chosen.len()];
        for n in &chosen {
            let cell = place(n);
            nodes[next[cell] as usize] = (x[*n as usize], *n);
            next[cell] += 1;
        }
        (self.starts, self.nodes) = (starts, nodes);
    }

    fn cell(&self, p: &V3) -> [usize; 3] {
        std::array::from_fn(|i| {
            let at = ((p[i] - self.low[i]) / self.size_m).floor();
            // beyond the ends and not a number: the outermost cells
            (at.max(0.0) as usize).min(self.count[i] - 1)
        })
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        (k * self.count[1] + j) * self.count[0] + i
    }

    /// Nodes in a box, in a fixed order, by their positions at the time of sorting; all with a coordinate that is not a number.
    pub fn each(&self, low: &V3, high: &V3, mut visit: impl FnMut(u32)) {
        if self.starts.is_empty() {
            return;
        }
        let (first, last) = (self.cell(low), self.cell(high));
        for k in first[2]..=last[2] {
            for j in first[1]..=last[1] {
                let row = self.starts[self.index([first[0], j, k])] as usize
                    ..self.starts[self.index([last[0], j, k]) + 1] as usize;
                for (x, n) in &self.nodes[row] {
                    let outside = (0..3).any(|i| x[i] < low[i] || x[i] > high[i]);
                    if !outside {
                        visit(*n);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_in_a_box_is_found() {
        let mut x: Vec<V3> =
            (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100].map(|c| 0.37 * f64::from(c))).collect();
        x.push([1e6, 0.0, -1e6]);
        let mut cells = Cells::default();
        cells.rebuild(&x, |n| n != 7, 0.5);
        for (low, high) in
            [([0.3, 0.3, 0.3], [1.2, 2.0, 0.8]), ([-5.0; 3], [9.0; 3]), ([1e5, -1.0, -2e6], [2e6, 1.0, 0.0])]
        {
            let inside = |n: &usize| *n != 7 && (0..3).all(|i| x[*n][i] >= low[i] && x[*n][i] <= high[i]);
            let mut found = Vec::new();
            cells.each(&low, &high, |n| found.push(n as usize));
            found.retain(inside);
            found.sort_unstable();
            assert_eq!(found, (0..x.len()).filter(inside).collect::<Vec<_>>());
        }
    }
}
