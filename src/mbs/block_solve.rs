//! Solving with a factorisation whose nodes all have six unknowns: six columns of each block, filled up to eight rows, so that a block times the numbers of a node is vector code.

use super::ideal::factor::BlockFactor;
use super::lanes::{LANES, Lane, ZERO};
use crate::base::isa::{Isa, for_each_isa};

/// Unknowns of a node.
pub(super) const SIZE: usize = 6;
/// Columns of a block.
type Columns = [Lane; SIZE];

/// The factors `L D Lᵀ` of a matrix.
#[derive(Debug, Clone)]
pub(super) struct BlockSolve {
    /// In the order of elimination: the node, and its range of [`Self::below`].
    nodes: Vec<(u32, u32, u32)>,
    /// Inverses of the diagonal blocks.
    inverses: Vec<Columns>,
    /// Nodes of the blocks below, the blocks, and these turned over.
    below: Vec<u32>,
    lower: Vec<Columns>,
    upper: Vec<Columns>,
}

impl BlockSolve {
    /// Takes over a factorisation.
    pub fn new(factor: &BlockFactor) -> Self {
        let mut all = Self {
            nodes: Vec::new(),
            inverses: Vec::new(),
            below: Vec::new(),
            lower: Vec::new(),
            upper: Vec::new(),
        };
        for (first, inverse, below) in factor.columns_of_six() {
            let begin = all.below.len() as u32;
            for (row, block) in below {
                all.below.push((row / SIZE) as u32);
                all.lower.push(columns(block, |row, column| SIZE * row + column));
                all.upper.push(columns(block, |row, column| SIZE * column + row));
            }
            all.inverses.push(columns(inverse, |row, column| SIZE * row + column));
            all.nodes.push(((first / SIZE) as u32, begin, all.below.len() as u32));
        }
        all
    }

    /// Solves in place.
    pub fn solve(&self, isa: Isa, x: &mut [Lane]) {
        solve(isa, &self.nodes, &self.inverses, &self.below, &self.lower, &self.upper, x);
    }
}

/// The columns of a block of which `at` tells the place of a row and a column.
fn columns(block: &[f64], at: impl Fn(usize, usize) -> usize) -> Columns {
    std::array::from_fn(|c| std::array::from_fn(|r| if r < SIZE { block[at(r, c)] } else { 0.0 }))
}

for_each_isa! {
    fn solve = solve_any(
        nodes: &[(u32, u32, u32)],
        inverses: &[Columns],
        below: &[u32],
        lower: &[Columns],
        upper: &[Columns],
        x: &mut [Lane],
    )
}

#[inline(always)]
fn solve_any(
    nodes: &[(u32, u32, u32)],
    inverses: &[Columns],
    below: &[u32],
    lower: &[Columns],
    upper: &[Columns],
    x: &mut [Lane],
) {
    for (node, begin, end) in nodes {
        let own = x[*node as usize];
        for k in *begin as usize..*end as usize {
            let row = &mut x[below[k] as usize];
            let product = times(&lower[k], &own);
            for l in 0..LANES {
                row[l] -= product[l];
            }
        }
    }
    for ((node, begin, end), inverse) in nodes.iter().zip(inverses).rev() {
        let mut own = times(inverse, &x[*node as usize]);
        for k in *begin as usize..*end as usize {
            let product = times(&upper[k], &x[below[k] as usize]);
            for l in 0..LANES {
                own[l] -= product[l];
            }
        }
        x[*node as usize] = own;
    }
}

#[inline(always)]
fn times(block: &Columns, x: &Lane) -> Lane {
    let mut sum = ZERO;
    for k in 0..SIZE {
        for l in 0..LANES {
            sum[l] += block[k][l] * x[k];
        }
    }
    sum
}
