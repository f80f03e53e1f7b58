//! Eight of a kind side by side: the layout that loops over lanes turn into vector code.

use super::math::M3;

/// How many.
pub(super) const LANES: usize = 8;
/// A number for each of them.
pub(super) type Lane = [f64; LANES];
/// Nothing.
pub(super) const ZERO: Lane = [0.0; LANES];

/// The components of a lane.
#[inline(always)]
pub(super) fn get<const N: usize>(from: &[Lane; N], l: usize) -> [f64; N] {
    let mut v = [0.0; N];
    for i in 0..N {
        v[i] = from[i][l];
    }
    v
}

/// The matrix of a lane.
#[inline(always)]
pub(super) fn get_matrix(from: &[[Lane; 3]; 3], l: usize) -> M3 {
    [get(&from[0], l), get(&from[1], l), get(&from[2], l)]
}

/// Sets the components of a lane.
#[inline(always)]
pub(super) fn put<const N: usize>(to: &mut [Lane; N], l: usize, v: [f64; N]) {
    for i in 0..N {
        to[i][l] = v[i];
    }
}
