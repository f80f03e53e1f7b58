//! The elimination of a block row of [`super::factor`]: the inverse of its pivot, and what it takes off the blocks below.

use super::factor::{Column, MOST, stride};
use super::pivots::{SMALL, pivoted};

/// Where the elimination writes.
pub(super) struct Store<'a> {
    /// Blocks of the matrix, and then of what the elimination left.
    pub values: &'a mut [f64],
    /// `W = B P`.
    pub scaled: &'a mut [f64],
    /// Blocks of three columns turned over.
    pub turned: &'a mut [f64],
}

/// Eliminates the rows of a joint, whose diagonal entries in the matrix are `start`; how many of them depend on others.
#[inline(always)]
pub(super) fn eliminate_column<const N: usize>(
    column: &Column,
    store: &mut Store<'_>,
    diagonal: &[f64],
) -> usize {
    let (at, first) = (column.diagonal as usize, column.first as usize);
    let block = at..at + N * stride(N);
    let start = &diagonal[first..first + N];
    let Some(inverse) = inverted::<N>(&store.values[block.clone()], start) else {
        let pivots = pivoted::<N>(&store.values[block.clone()], start);
        store.values[block].copy_from_slice(&pivots.inverted()[..N * stride(N)]);
        pivots.turn(column, store);
        take_off(column, store);
        pivots.turn_back(column, store.scaled);
        return pivots.dependent();
    };
    store.values[block].copy_from_slice(&inverse[..N * stride(N)]);
    for (_, size, place) in &column.below {
        let (m, place) = (usize::from(*size), *place as usize);
        let range = place..place + m * stride(N);
        let (block, out) = (&store.values[range.clone()], &mut store.scaled[range]);
        match (m, N) {
            (3, 3) => multiply_3(block, &inverse, out, &mut store.turned[place..place + 12]),
            (2, 2) => multiply::<2, 2>(block, &inverse, out),
            (5, 5) => multiply::<5, 5>(block, &inverse, out),
            _ => multiply_any(block, &inverse, out, [m, N]),
        }
    }
    take_off(column, store);
    0
}

/// Takes `W Bᵀ` off the blocks that come later.
#[inline(always)]
fn take_off(column: &Column, Store { values, scaled, turned }: &mut Store<'_>) {
    for u in &column.updates {
        let (t, w, b) = (u.target as usize, u.w as usize, u.b as usize);
        match u.sizes {
            [3, 3, 3] => subtract_3(&mut values[t..t + 12], &scaled[w..w + 12], &turned[b..b + 12]),
            [2, 2, 2] => subtract::<2, 2, 2>(values, scaled, [t, w, b]),
            [5, 5, 5] => subtract::<5, 5, 5>(values, scaled, [t, w, b]),
            sizes => subtract_any(values, scaled, [t, w, b], sizes.map(usize::from)),
        }
    }
}

/// The inverse of a positive definite block; none if its pivots in the order of its rows are small.
#[inline(always)]
pub(super) fn inverted<const N: usize>(block: &[f64], start: &[f64]) -> Option<[f64; MOST * MOST]> {
    let (block, start) = (&block[..N * stride(N)], &start[..N]);
    let (mut lower, mut pivots) = ([[0.0_f64; N]; N], [0.0_f64; N]);
    for j in 0..N {
        let mut pivot = block[j * stride(N) + j];
        for k in 0..j {
            pivot -= lower[j][k] * lower[j][k] * pivots[k];
        }
        if pivot <= SMALL * start[j] {
            return None;
        }
        for i in j + 1..N {
            let mut rest = block[i * stride(N) + j];
            for k in 0..j {
                rest -= lower[i][k] * lower[j][k] * pivots[k];
            }
            lower[i][j] = rest / pivot;
        }
        pivots[j] = pivot;
    }
    let mut inverse = [0.0; MOST * MOST];
    for c in 0..N {
        let mut x = [0.0; N];
        x[c] = 1.0;
        for i in c + 1..N {
            for k in c..i {
                x[i] -= lower[i][k] * x[k];
            }
        }
        for i in 0..N {
            x[i] /= pivots[i];
        }
        for i in (0..N).rev() {
            for k in i + 1..N {
                x[i] -= lower[k][i] * x[k];
            }
            inverse[i * stride(N) + c] = x[i];
        }
    }
    Some(inverse)
}

/// `out = a b` of three rows and columns, and `a` turned over.
#[inline(always)]
fn multiply_3(a: &[f64], b: &[f64], out: &mut [f64], turned: &mut [f64]) {
    let (a, b, out, turned) = (&a[..12], &b[..12], &mut out[..12], &mut turned[..12]);
    for i in 0..3 {
        let mut sum = [0.0; 4];
        for k in 0..3 {
            for j in 0..4 {
                sum[j] += a[4 * i + k] * b[4 * k + j];
            }
            turned[4 * k + i] = a[4 * i + k];
        }
        out[4 * i..4 * i + 4].copy_from_slice(&sum);
    }
}

/// `out = a b` with `b` square; not for three columns.
#[inline(always)]
fn multiply<const M: usize, const N: usize>(a: &[f64], b: &[f64], out: &mut [f64]) {
    let (a, b, out) = (&a[..M * N], &b[..N * N], &mut out[..M * N]);
    for i in 0..M {
        for j in 0..N {
            let mut sum = 0.0;
            for k in 0..N {
                sum += a[i * N + k] * b[k * N + j];
            }
            out[i * N + j] = sum;
        }
    }
}

#[inline(always)]
fn multiply_any(a: &[f64], b: &[f64], out: &mut [f64], [m, n]: [usize; 2]) {
    let width = stride(n);
    for i in 0..m {
        for j in 0..n {
            out[i * width + j] = (0..n).map(|k| a[i * width + k] * b[k * width + j]).sum();
        }
    }
}

/// `target -= w bᵀ` of three rows and columns, `b` turned over.
#[inline(always)]
fn subtract_3(target: &mut [f64], w: &[f64], turned: &[f64]) {
    let (target, w, turned) = (&mut target[..12], &w[..12], &turned[..12]);
    for i in 0..3 {
        let mut sum = [0.0; 4];
        for k in 0..3 {
            for j in 0..4 {
                sum[j] += w[4 * i + k] * turned[4 * k + j];
            }
        }
        for j in 0..4 {
            target[4 * i + j] -= sum[j];
        }
    }
}

/// `target -= w bᵀ`; not for three rows of `b` or three columns.
#[inline(always)]
fn subtract<const I: usize, const J: usize, const K: usize>(
    values: &mut [f64],
    scaled: &[f64],
    [t, w, b]: [usize; 3],
) {
    let w: &[f64] = &scaled[w..w + I * K];
    let mut products = [[0.0; J]; I];
    {
        let b = &values[b..b + J * K];
        for i in 0..I {
            for j in 0..J {
                for k in 0..K {
                    products[i][j] += w[i * K + k] * b[j * K + k];
                }
            }
        }
    }
    let target = &mut values[t..t + I * J];
    for i in 0..I {
        for j in 0..J {
            target[i * J + j] -= products[i][j];
        }
    }
}

#[inline(always)]
fn subtract_any(values: &mut [f64], scaled: &[f64], [t, w, b]: [usize; 3], [m, n, k]: [usize; 3]) {
    let (of, to) = (stride(k), stride(n));
    for i in 0..m {
        for j in 0..n {
            let product: f64 = (0..k).map(|c| scaled[w + i * of + c] * values[b + j * of + c]).sum();
            values[t + i * to + j] -= product;
        }
    }
}
