//! The elastic stiffness of a body's hexahedra and bars, assembled straight into the columns of a sparse symmetric matrix.
//!
//! Element matrices come from the kernel itself, by unit displacements. Tied nodes have no equations: what an element does to
//! them goes to their masters, `Tᵀ K T` with the weights of the ties in `T`.

use super::dynamics::Dynamics;
use super::full::{self, FullState};
use super::kernel::{BlockState, KernelStep, LANES, update_block};
use super::law::ElementForm;

/// Equation number of each component of each node; `None`: held, tied or without mass.
pub type Unknowns = Vec<[Option<u32>; 3]>;

/// A sparse symmetric matrix: its lower triangle by columns, rows increasing. Values are in single precision, which halves the memory of a
/// large model; the iterations on the true forces take the difference out.
#[derive(Debug, Clone, Default)]
pub struct LowerColumns {
    /// Number of equations.
    pub count: usize,
    /// Where each column starts in `rows` and `values`, one more than columns.
    pub starts: Vec<u32>,
    /// Row numbers.
    pub rows: Vec<u32>,
    /// Values \[N/m\].
    pub values: Vec<f32>,
}

impl LowerColumns {
    /// The product with a vector, `y = K x`.
    pub fn times(&self, x: &[f64], y: &mut [f64]) {
        y.iter_mut().for_each(|v| *v = 0.0);
        for c in 0..self.count {
            let range = self.starts[c] as usize..self.starts[c + 1] as usize;
            let mut sum = 0.0;
            for (&r, &value) in self.rows[range.clone()].iter().zip(&self.values[range]) {
                let value = f64::from(value);
                let r = r as usize;
                if r > c {
                    y[r] += value * x[c];
                }
                sum += value * x[r];
            }
            y[c] += sum;
        }
    }

    fn add(&mut self, row: u32, column: u32, value: f64) {
        let first = self.starts[column as usize] as usize;
        let rows = &self.rows[first..self.starts[column as usize + 1] as usize];
        if let Ok(at) = rows.binary_search(&row) {
            self.values[first + at] += value as f32;
        }
    }
}

/// Numbers the free components.
pub fn number_unknowns(body: &Dynamics) -> (Unknowns, usize) {
    let mut next = 0;
    let mut number = |free: bool| {
        free.then(|| {
            next += 1;
            next - 1
        })
    };
    let unknowns = (0..body.x.len())
        .map(|n| {
            std::array::from_fn(|i| number(body.mass_kg[n] > 0.0 && body.prescribed_m_s[n][i].is_none()))
        })
        .collect();
    (unknowns, next as usize)
}

/// The elastic stiffness of the acting elements.
pub fn assemble(body: &Dynamics, unknowns: &Unknowns, count: usize) -> LowerColumns {
    let mut matrix = pattern(body, unknowns, count);
    for_each_entry(body, unknowns, |row, column, value| matrix.add(row, column, value));
    matrix
}

/// Hands out what each element contributes to the lower triangle, as `(row, column, value)`.
pub fn for_each_entry(body: &Dynamics, unknowns: &Unknowns, mut sink: impl FnMut(u32, u32, f64)) {
    const UNIT_M: f64 = 1e-9;
    for_each_bar_entry(body, unknowns, &mut sink);
    for (index, block) in body.blocks.blocks.iter().enumerate() {
        let global = body.blocks.global_nodes(index);
        let carried: [[Vec<(usize, f64)>; 8]; LANES] =
            global.map(|nodes| nodes.map(|n| body.ties.carriers(n as usize)));
        let mut x = [[0.0; LANES]; 24];
        for (lane, nodes) in global.iter().enumerate() {
            for (local, n) in nodes.iter().enumerate() {
                for i in 0..3 {
                    x[3 * local + i][lane] = body.x[*n as usize][i];
                }
            }
        }
        let mut elastic = block.material.lanes();
        elastic.yield_scale = [1e12; LANES];
        let table = &body.blocks.tables[block.material.table];
        for column in 0..24 {
            let mut du = [[0.0; LANES]; 24];
            du[column] = [UNIT_M; LANES];
            let mut state = BlockState { share: block.state.share, ..BlockState::default() };
            let mut force = [[0.0; LANES]; 24];
            let step = KernelStep { dt_s: 1.0, viscous: false };
            if elastic.form == ElementForm::FullyIntegrated {
                let mut points = FullState::default();
                full::update(&x, &du, 1.0, &elastic, table, &mut state, &mut points, &mut force, step);
            } else {
                update_block(&x, &du, &elastic, table, &mut state, &mut force, step);
            }
            for lane in (0..LANES).filter(|l| block.state.share[*l] > 0.0) {
                for (row, values) in force.iter().enumerate() {
                    let value = values[lane] / UNIT_M;
                    for (r, c, weight) in pairs(unknowns, &carried[lane], row, column) {
                        sink(r, c, weight * value);
                    }
                }
            }
        }
    }
}

/// What the bars contribute.
fn for_each_bar_entry(body: &Dynamics, unknowns: &Unknowns, sink: &mut impl FnMut(u32, u32, f64)) {
    for ([a, b], stiffness) in body.trusses.stiffnesses(&body.x) {
        let ends = bar_carriers(body, [a, b]);
        for &(n, w) in &ends {
            for &(m, u) in &ends {
                for (i, row) in stiffness.iter().enumerate() {
                    for (j, value) in row.iter().enumerate() {
                        if let (Some(r), Some(c)) = (unknowns[n][i], unknowns[m][j])
                            && r >= c
                        {
                            sink(r, c, w * u * value);
                        }
                    }
                }
            }
        }
    }
}

/// The nodes that the elongation of a bar depends on, with the signs of its ends in their shares.
fn bar_carriers(body: &Dynamics, [a, b]: [usize; 2]) -> Vec<(usize, f64)> {
    let mut ends = body.ties.carriers(a);
    ends.extend(body.ties.carriers(b).into_iter().map(|(n, w)| (n, -w)));
    ends
}

/// Entries `(row, column, weight)` of the lower triangle that an entry of an element matrix contributes to.
fn pairs<'a>(
    unknowns: &'a Unknowns,
    carried: &'a [Vec<(usize, f64)>; 8],
    row: usize,
    column: usize,
) -> impl Iterator<Item = (u32, u32, f64)> + 'a {
    carried[column / 3].iter().flat_map(move |(n, a)| {
        carried[row / 3].iter().filter_map(move |(m, b)| {
            let (c, r) = (unknowns[*n][column % 3]?, unknowns[*m][row % 3]?);
            (r >= c).then_some((r, c, a * b))
        })
    })
}

/// An empty matrix with room for all entries.
fn pattern(body: &Dynamics, unknowns: &Unknowns, count: usize) -> LowerColumns {
    let mut neighbours: Vec<(u32, u32)> = Vec::new();
    let couple = |neighbours: &mut Vec<(u32, u32)>, mut nodes: Vec<u32>| {
        nodes.sort_unstable();
        nodes.dedup();
        for (i, a) in nodes.iter().enumerate() {
            neighbours.extend(nodes[i..].iter().map(|b| (*a, *b)));
        }
    };
    for (ends, _) in body.trusses.stiffnesses(&body.x) {
        couple(&mut neighbours, bar_carriers(body, ends).into_iter().map(|(n, _)| n as u32).collect());
    }
    for (index, block) in body.blocks.blocks.iter().enumerate() {
        let global = body.blocks.global_nodes(index);
        for lane in (0..LANES).filter(|l| block.state.share[*l] > 0.0) {
            let carriers = global[lane].iter().flat_map(|n| body.ties.carriers(*n as usize));
            couple(&mut neighbours, carriers.map(|(n, _)| n as u32).collect());
        }
        if neighbours.len() > 1 << 22 {
            tidy(&mut neighbours);
        }
    }
    tidy(&mut neighbours);
    let mut matrix = LowerColumns { count, starts: Vec::with_capacity(count + 1), ..Default::default() };
    matrix.starts.push(0);
    for of_node in neighbours.chunk_by(|a, b| a.0 == b.0) {
        for column in unknowns[of_node[0].0 as usize].iter().flatten() {
            let rows = of_node.iter().flat_map(|(_, m)| unknowns[*m as usize].iter().flatten());
            matrix.rows.extend(rows.filter(|r| *r >= column));
            matrix.starts.push(matrix.rows.len() as u32);
        }
    }
    matrix.values = vec![0.0; matrix.rows.len()];
    matrix
}

fn tidy(neighbours: &mut Vec<(u32, u32)>) {
    neighbours.sort_unstable();
    neighbours.dedup();
}
