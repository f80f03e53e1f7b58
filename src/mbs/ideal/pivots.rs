//! Pivots of [`super::factor`] that are small, or vanish where rows depend on others.

use super::eliminate::Store;
use super::factor::{Column, MOST, stride};

/// Pivot over the row's own diagonal entry below which a row depends on others.
const DEPENDENT: f64 = 1e-10;
/// The same below which the rows of a joint are taken in the order of their pivots.
pub(super) const SMALL: f64 = 1e-3;

/// The elimination of a block whose pivots are small: `T S Tᵀ = D` for the rows that have one, `S⁻¹ = Tᵀ D⁻¹ T`.
pub(super) struct Pivots<const N: usize> {
    rows: [[f64; N]; N],
    /// One over each pivot; zero for a row that depends on others, which has no force.
    inverse: [f64; N],
}

/// The rows of a block in the order of their pivots, the largest beside its row's own diagonal entry first. In the order of the rows a small one would make the rounding of those after it large, and
/// a row that depends on it would seem to be free (a block `s n nᵀ` whose `n` is 1e-3 rad off an axis).
#[inline(never)]
pub(super) fn pivoted<const N: usize>(block: &[f64], start: &[f64]) -> Pivots<N> {
    let mut a: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|j| block[i * stride(N) + j]));
    let mut rows: [[f64; N]; N] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    let (mut done, mut inverse) = ([false; N], [0.0; N]);
    loop {
        let rest = |j: &usize| a[*j][*j] / start[*j];
        let open = (0..N).filter(|j| !done[*j] && a[*j][*j] > DEPENDENT * start[*j]);
        let Some(p) = open.max_by(|i, j| rest(i).total_cmp(&rest(j))) else { break };
        (done[p], inverse[p]) = (true, 1.0 / a[p][p]);
        let (pivot, own) = (a[p], rows[p]);
        for i in (0..N).filter(|i| !done[*i]) {
            let share = a[i][p] * inverse[p];
            for j in 0..N {
                a[i][j] -= share * pivot[j];
                rows[i][j] -= share * own[j];
            }
        }
    }
    Pivots { rows, inverse }
}

impl<const N: usize> Pivots<N> {
    /// How many rows depend on others.
    pub(super) fn dependent(&self) -> usize {
        self.inverse.iter().filter(|d| **d == 0.0).count()
    }

    /// `Tᵀ D⁻¹ T`.
    pub(super) fn inverted(&self) -> [f64; MOST * MOST] {
        let mut inverse = [0.0; MOST * MOST];
        for i in 0..N {
            for j in 0..N {
                inverse[i * stride(N) + j] =
                    (0..N).map(|p| self.rows[p][i] * self.inverse[p] * self.rows[p][j]).sum();
            }
        }
        inverse
    }

    /// Blocks `B` below in the rows that have a pivot, `B Tᵀ`, and `W = B Tᵀ D⁻¹` with it. The products with the inverse itself would have rounding of the size of their terms, which are larger by one over
    /// the pivot than what they add up to: near a singular pose that several loops share, more than the pivots of the others.
    #[inline(always)]
    pub(super) fn turn(&self, column: &Column, Store { values, scaled, turned }: &mut Store<'_>) {
        for (_, size, place) in &column.below {
            for i in 0..usize::from(*size) {
                let at = *place as usize + i * stride(N);
                let own: [f64; N] = std::array::from_fn(|k| values[at + k]);
                for p in 0..N {
                    let along = (0..N).map(|k| own[k] * self.rows[p][k]).sum::<f64>();
                    values[at + p] = if self.inverse[p] == 0.0 { 0.0 } else { along };
                    scaled[at + p] = along * self.inverse[p];
                    if (usize::from(*size), N) == (3, 3) {
                        turned[*place as usize + stride(N) * p + i] = values[at + p];
                    }
                }
            }
        }
    }

    /// `W = B Tᵀ D⁻¹ T`.
    #[inline(always)]
    pub(super) fn turn_back(&self, column: &Column, scaled: &mut [f64]) {
        for (_, size, place) in &column.below {
            for at in (0..usize::from(*size)).map(|i| *place as usize + i * stride(N)) {
                let along: [f64; N] = std::array::from_fn(|p| scaled[at + p]);
                for k in 0..N {
                    scaled[at + k] = (0..N).map(|p| along[p] * self.rows[p][k]).sum();
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::eliminate::inverted;
    use super::*;
    use crate::base::random::Random;

    /// A block of rank one is one whatever its direction, and its inverse is the one in that direction.
    #[test]
    fn the_rank_of_a_block_does_not_depend_on_its_direction() {
        let mut random = Random::after(11);
        for exponent in 0..40 {
            let small = 10f64.powf(-0.2 * f64::from(exponent));
            let normal = [small * random.symmetric(), small * random.symmetric(), 1.0];
            // entries with the rounding of what was taken off them
            let off = |x: f64| (x + 1.0) - 1.0;
            let block: Vec<f64> = (0..3)
                .flat_map(|i| (0..4).map(move |j| if j < 3 { off(normal[i] * normal[j]) } else { 0.0 }))
                .collect();
            assert!(inverted::<3>(&block, &[1.0; 3]).is_none());
            let pivots = pivoted::<3>(&block, &[1.0; 3]);
            assert_eq!(pivots.dependent(), 2, "{small:e}");
            let inverse = pivots.inverted();
            let force: f64 = (0..3)
                .map(|i| {
                    normal[i] * inverse[4 * i..4 * i + 3].iter().zip(normal).map(|(a, n)| a * n).sum::<f64>()
                })
                .sum();
            assert!((force - 1.0).abs() < 1e-9, "{small:e} {force}");
        }
    }
}
