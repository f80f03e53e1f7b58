//! The matrix `S = G M⁻¹ Gᵀ` as a sparse symmetric block matrix, one block row a joint, and its factorisation `S = L D Lᵀ`.
//!
//! Order and pattern are found once: at each step the joint with the fewest neighbours left is eliminated (minimum degree). `S` is positive
//! semidefinite. A row that depends on those before it has a pivot that vanishes beside its own diagonal entry; it is given no force, which is one of the solutions of a
//! consistent system.
//!
//! Blocks are stored by rows. A row of three numbers, the commonest, has room for a fourth, zero, so that it is one vector of four; what has to be multiplied by it
//! is stored turned over.

use super::eliminate::{Store, eliminate_column};
use crate::base::isa::{Isa, for_each_isa};
use std::collections::BTreeSet;

/// Most rows of a joint.
pub(super) const MOST: usize = 6;
/// Right-hand sides that are solved at once: one vector of the processor.
pub const SIDES: usize = 4;

/// Room of a row of a block with so many columns.
pub const fn stride(columns: usize) -> usize {
    if columns == 3 { 4 } else { columns }
}

/// One product `target -= w bᵀ` of the elimination.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Update {
    /// Places of the blocks.
    pub target: u32,
    pub w: u32,
    pub b: u32,
    /// Rows of the target, its columns, and of what they have in common.
    pub sizes: [u8; 3],
}

/// A block row in the order of elimination.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    /// Where its unknowns begin, and how many there are.
    pub first: u32,
    pub size: u8,
    /// Its diagonal block.
    pub diagonal: u32,
    /// Blocks below it: the row's first unknown, its size, the place.
    pub below: Vec<(u32, u8, u32)>,
    /// Products that its elimination makes.
    pub updates: Vec<Update>,
}

/// The factorisation.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockFactor {
    columns: Vec<Column>,
    /// Values: blocks of the matrix and then of what the elimination left; `W = B P`; and blocks of three columns turned over.
    values: Vec<f64>,
    scaled: Vec<f64>,
    turned: Vec<f64>,
    /// Diagonal of the matrix.
    diagonal: Vec<f64>,
    /// Place of the block of a pair of joints, by the joint with the larger place in the order first.
    place: std::collections::BTreeMap<(u32, u32), u32>,
    /// Place of each joint in the order, and first unknown.
    order: Vec<u32>,
    first: Vec<u32>,
    isa: Isa,
    /// Rows found dependent in the last factorisation.
    pub dependent: usize,
}

impl BlockFactor {
    /// For joints of so many rows, and pairs of joints that share a body.
    pub fn new(rows: &[usize], pairs: &BTreeSet<(usize, usize)>) -> Self {
        let (sequence, fill) = eliminated(rows.len(), pairs);
        let mut order = vec![0u32; rows.len()];
        sequence.iter().enumerate().for_each(|(at, joint)| order[*joint] = at as u32);
        let mut first = vec![0u32; rows.len()];
        let mut next = 0;
        for (joint, count) in rows.iter().enumerate() {
            first[joint] = next;
            next += *count as u32;
        }
        let mut place = std::collections::BTreeMap::new();
        let mut length = 0usize;
        for (at, joint) in sequence.iter().enumerate() {
            let mut block = |other: usize| {
                place.insert((other as u32, *joint as u32), length as u32);
                length += rows[other] * stride(rows[*joint]);
            };
            block(*joint);
            fill[at].iter().for_each(|other| block(*other));
        }
        let columns = sequence
            .iter()
            .enumerate()
            .map(|(at, &joint)| Self::column(joint, &fill[at], rows, &first, &order, &place))
            .collect();
        Self {
            columns,
            values: vec![0.0; length],
            scaled: vec![0.0; length],
            turned: vec![0.0; length],
            diagonal: vec![0.0; next as usize],
            place,
            order,
            first,
            // only blocks of three rows gain by wider vectors
            isa: if rows.contains(&3) { Isa::best() } else { Isa::Portable },
            dependent: 0,
        }
    }

    fn column(
        joint: usize,
        below: &[usize],
        rows: &[usize],
        first: &[u32],
        order: &[u32],
        place: &std::collections::BTreeMap<(u32, u32), u32>,
    ) -> Column {
        let of = |a: usize, b: usize| place[&(a as u32, b as u32)];
        let mut updates = Vec::new();
        for &i in below {
            for &j in below.iter().filter(|j| order[**j] <= order[i]) {
                let sizes = [rows[i] as u8, rows[j] as u8, rows[joint] as u8];
                updates.push(Update { target: of(i, j), w: of(i, joint), b: of(j, joint), sizes });
            }
        }
        Column {
            first: first[joint],
            size: rows[joint] as u8,
            diagonal: of(joint, joint),
            below: below.iter().map(|i| (first[*i], rows[*i] as u8, of(*i, joint))).collect(),
            updates,
        }
    }

    /// The place of the block of two joints, and whether its rows are those of the first.
    pub fn place(&self, a: usize, b: usize) -> (usize, bool) {
        let straight = self.order[a] >= self.order[b];
        let (row, column) = if straight { (a, b) } else { (b, a) };
        (self.place[&(row as u32, column as u32)] as usize, straight)
    }

    /// First unknown of a joint.
    pub fn first(&self, joint: usize) -> usize {
        self.first[joint] as usize
    }

    /// The values, to be filled with those of the matrix.
    pub fn values(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// Factorises what the values hold.
    pub fn factorise(&mut self) {
        let Self { columns, values, scaled, turned, diagonal, isa, .. } = self;
        for column in columns.iter() {
            let (first, n, at) = (column.first as usize, usize::from(column.size), column.diagonal as usize);
            for i in 0..n {
                diagonal[first + i] = values[at + i * stride(n) + i];
            }
        }
        self.dependent = eliminate(*isa, columns, &mut Store { values, scaled, turned }, diagonal);
    }

    /// Of a matrix whose nodes all have six unknowns, in the order of elimination: the first unknown, the inverse of the pivot `D`, and below it the first unknowns and blocks of `L`; blocks by rows.
    pub fn columns_of_six(
        &self,
    ) -> impl Iterator<Item = (usize, &[f64], impl Iterator<Item = (usize, &[f64])>)> {
        self.columns.iter().map(move |column| {
            let below = column
                .below
                .iter()
                .map(move |(row, _, at)| (*row as usize, &self.scaled[*at as usize..*at as usize + 36]));
            (
                column.first as usize,
                &self.values[column.diagonal as usize..column.diagonal as usize + 36],
                below,
            )
        })
    }

    /// The instruction set that it runs in.
    pub fn isa(&self) -> Isa {
        self.isa
    }

    /// Solves for one right-hand side, in place.
    pub fn solve(&self, x: &mut [f64]) {
        // no vectors to be had: not worth the call into another instruction set
        solve_any::<1>(&self.columns, &self.values, &self.scaled, x.as_chunks_mut().0);
    }

    /// Solves for several right-hand sides, in place.
    pub fn solve_sides(&self, x: &mut [[f64; SIDES]]) {
        solve_sides(self.isa, &self.columns, &self.values, &self.scaled, x);
    }
}

for_each_isa! {
    fn eliminate = eliminate_any(columns: &[Column], store: &mut Store<'_>, diagonal: &[f64]) -> usize
}

for_each_isa! {
    fn solve_sides = solve_any(columns: &[Column], values: &[f64], scaled: &[f64], x: &mut [[f64; SIDES]])
}

/// The elimination; the number of dependent rows.
#[inline(always)]
fn eliminate_any(columns: &[Column], store: &mut Store<'_>, diagonal: &[f64]) -> usize {
    let mut dependent = 0;
    // a closure would be compiled by itself, for the portable instruction set
    for column in columns {
        dependent += match column.size {
            1 => eliminate_column::<1>(column, store, diagonal),
            2 => eliminate_column::<2>(column, store, diagonal),
            3 => eliminate_column::<3>(column, store, diagonal),
            4 => eliminate_column::<4>(column, store, diagonal),
            5 => eliminate_column::<5>(column, store, diagonal),
            _ => eliminate_column::<6>(column, store, diagonal),
        };
    }
    dependent
}

#[inline(always)]
fn solve_any<const R: usize>(columns: &[Column], values: &[f64], scaled: &[f64], x: &mut [[f64; R]]) {
    for column in columns {
        match column.size {
            1 => forward::<1, R>(column, scaled, x),
            2 => forward::<2, R>(column, scaled, x),
            3 => forward::<3, R>(column, scaled, x),
            4 => forward::<4, R>(column, scaled, x),
            5 => forward::<5, R>(column, scaled, x),
            _ => forward::<6, R>(column, scaled, x),
        }
    }
    for column in columns.iter().rev() {
        match column.size {
            1 => backward::<1, R>(column, values, scaled, x),
            2 => backward::<2, R>(column, values, scaled, x),
            3 => backward::<3, R>(column, values, scaled, x),
            4 => backward::<4, R>(column, values, scaled, x),
            5 => backward::<5, R>(column, values, scaled, x),
            _ => backward::<6, R>(column, values, scaled, x),
        }
    }
}

#[inline(always)]
fn forward<const N: usize, const R: usize>(column: &Column, scaled: &[f64], x: &mut [[f64; R]]) {
    let mut own = [[0.0; R]; N];
    own.copy_from_slice(&x[column.first as usize..][..N]);
    for (row, size, place) in &column.below {
        let rows = &mut x[*row as usize..][..usize::from(*size)];
        let w = &scaled[*place as usize..][..rows.len() * stride(N)];
        for (x, w) in rows.iter_mut().zip(w.chunks_exact(stride(N))) {
            let mut sum = [0.0; R];
            for k in 0..N {
                for r in 0..R {
                    sum[r] += w[k] * own[k][r];
                }
            }
            for r in 0..R {
                x[r] -= sum[r];
            }
        }
    }
}

#[inline(always)]
fn backward<const N: usize, const R: usize>(
    column: &Column,
    values: &[f64],
    scaled: &[f64],
    x: &mut [[f64; R]],
) {
    let first = column.first as usize;
    let inverse = &values[column.diagonal as usize..][..N * stride(N)];
    let mut own = [[0.0; R]; N];
    for i in 0..N {
        for k in 0..N {
            for r in 0..R {
                own[i][r] += inverse[i * stride(N) + k] * x[first + k][r];
            }
        }
    }
    for (row, size, place) in &column.below {
        let rows = &x[*row as usize..][..usize::from(*size)];
        let w = &scaled[*place as usize..][..rows.len() * stride(N)];
        for (force, w) in rows.iter().zip(w.chunks_exact(stride(N))) {
            for k in 0..N {
                for r in 0..R {
                    own[k][r] -= w[k] * force[r];
                }
            }
        }
    }
    x[first..first + N].copy_from_slice(&own);
}

/// The order of elimination, and for each joint in it those that come later and are coupled with it then.
fn eliminated(count: usize, pairs: &BTreeSet<(usize, usize)>) -> (Vec<usize>, Vec<Vec<usize>>) {
    let mut near: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); count];
    for (a, b) in pairs {
        near[*a].insert(*b);
        near[*b].insert(*a);
    }
    let mut left: BTreeSet<(usize, usize)> = (0..count).map(|j| (near[j].len(), j)).collect();
    let (mut sequence, mut fill) = (Vec::with_capacity(count), Vec::with_capacity(count));
    while let Some((_, joint)) = left.pop_first() {
        let later: Vec<usize> = std::mem::take(&mut near[joint]).into_iter().collect();
        for &a in &later {
            left.remove(&(near[a].len(), a));
            near[a].remove(&joint);
            near[a].extend(later.iter().copied().filter(|b| *b != a));
            left.insert((near[a].len(), a));
        }
        sequence.push(joint);
        fill.push(later);
    }
    (sequence, fill)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;

    /// Joints between bodies: random rows of six numbers a body, `S` dense and in blocks.
    fn check(bodies: &[[usize; 2]], rows: &[usize], twins: &[[usize; 2]]) -> usize {
        let mut random = Random::after(7);
        let count: usize = rows.iter().sum();
        let unknowns = 6 * (1 + bodies.iter().flatten().max().unwrap());
        let mut first = vec![0];
        rows.iter().for_each(|r| first.push(first[first.len() - 1] + r));
        let mut g = vec![vec![0.0; unknowns]; count];
        for (j, ends) in bodies.iter().enumerate() {
            for row in &mut g[first[j]..first[j + 1]] {
                for body in ends {
                    row[6 * body..6 * body + 6].iter_mut().for_each(|v| *v = random.symmetric());
                }
            }
        }
        // a joint twice: the same rows
        for [of, twin] in twins {
            for k in 0..rows[*of] {
                g[first[*twin] + k] = g[first[*of] + k].clone();
            }
        }
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let shares = |a: usize, b: usize| bodies[a].iter().any(|x| bodies[b].contains(x));
        let mut pairs = BTreeSet::new();
        for a in 0..rows.len() {
            (a + 1..rows.len()).filter(|b| shares(a, *b)).for_each(|b| _ = pairs.insert((a, b)));
        }
        let mut factor = BlockFactor::new(rows, &pairs);
        for a in 0..rows.len() {
            for b in (0..=a).filter(|b| shares(a, *b)) {
                let (place, straight) = factor.place(a, b);
                let (row, column) = if straight { (a, b) } else { (b, a) };
                for i in 0..rows[row] {
                    for j in 0..rows[column] {
                        let value = product(&g[first[row] + i], &g[first[column] + j]);
                        factor.values()[place + i * stride(rows[column]) + j] = value;
                    }
                }
            }
        }
        factor.factorise();
        // a right-hand side within reach
        let some: Vec<f64> = (0..unknowns).map(|_| random.symmetric()).collect();
        let wanted: Vec<f64> = g.iter().map(|row| product(row, &some)).collect();
        let mut x = wanted.clone();
        let mut sides: Vec<[f64; SIDES]> =
            wanted.iter().map(|v| [1.0, 0.0, -2.0, 0.5].map(|s| s * v)).collect();
        factor.solve(&mut x);
        factor.solve_sides(&mut sides);
        // powers of two: the same digits
        assert!(x.iter().zip(&sides).all(|(x, side)| *side == [*x, 0.0, -2.0 * x, 0.5 * x]));
        let back: Vec<f64> = (0..unknowns).map(|c| (0..count).map(|r| g[r][c] * x[r]).sum()).collect();
        for (row, wanted) in g.iter().zip(&wanted) {
            let found = product(row, &back);
            assert!((found - wanted).abs() < 1e-7, "{found} {wanted}");
        }
        factor.dependent
    }

    #[test]
    fn loops_of_any_sizes_are_solved() {
        // a ladder with a loop, mixed sizes
        let bodies = [[0, 1], [1, 2], [2, 3], [3, 0], [1, 3], [4, 0], [4, 2]];
        assert_eq!(check(&bodies, &[3, 3, 2, 2, 3, 1, 4], &[]), 0);
        assert_eq!(check(&bodies, &[3; 7], &[]), 0);
        assert_eq!(check(&bodies, &[2; 7], &[]), 0);
    }

    #[test]
    fn dependent_rows_get_no_force() {
        let bodies = [[0, 1], [1, 2], [0, 1], [2, 3]];
        assert_eq!(check(&bodies, &[3, 2, 3, 5], &[[0, 2]]), 3);
    }
}
