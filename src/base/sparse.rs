//! Sparse symmetric equations by Cholesky's method (faer), scaled to a unit diagonal, so that translations and rotations compare, and the softest mode of what cannot be solved.

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{Mat, Side};

/// Smallest eigenvalue of the scaled stiffness below which a structure counts as a mechanism. Rounding leaves
/// about 1e-15 of a true mechanism; the most slender sensible frame stays above 1e-9.
pub const MECHANISM_EIGENVALUE: f64 = 1e-12;
/// Shift that makes a singular scaled matrix factorable for the inverse iteration.
const SHIFT: f64 = 1e-9;
/// Inverse iterations; each gains the ratio of the two smallest eigenvalues, and one is mostly enough.
const ITERATIONS: usize = 4;

/// A factorised positive definite matrix.
pub struct Positive {
    scaled: Scaled,
    factor: Llt<usize, f64>,
}

/// Why equations have no solution.
#[derive(Debug, Clone, PartialEq)]
pub enum Unsolvable {
    /// The matrix is singular: what moves without resistance, in the unknowns of the equations.
    Singular(Vec<f64>),
    /// The factorisation failed for another reason.
    Failed(String),
}

impl Positive {
    /// Factorises the matrix of some `(row, column, value)` of its lower triangle, which add up.
    ///
    /// # Errors
    /// If it is singular or not finite.
    pub fn of(lower: Vec<(usize, usize, f64)>, unknowns: usize) -> Result<Self, Unsolvable> {
        let scaled = Scaled::of(lower, unknowns)?;
        if let Ok(factor) = scaled.factor(0.0) {
            let (eigenvalue, mode) = scaled.smallest(&factor);
            return if eigenvalue > MECHANISM_EIGENVALUE {
                Ok(Self { scaled, factor })
            } else {
                Err(Unsolvable::Singular(mode))
            };
        }
        let shifted = scaled.factor(SHIFT).map_err(Unsolvable::Failed)?;
        Err(Unsolvable::Singular(scaled.smallest(&shifted).1))
    }

    /// The solution for a right-hand side, with one step of iterative refinement.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let scale = &self.scaled.scale;
        let scaled: Vec<f64> = rhs.iter().zip(scale).map(|(l, s)| l * s).collect();
        let mut x = back_substitute(&self.factor, &scaled);
        let residual: Vec<f64> = scaled.iter().zip(self.scaled.times(&x)).map(|(l, k)| l - k).collect();
        let correction = back_substitute(&self.factor, &residual);
        x.iter_mut().zip(correction).for_each(|(v, c)| *v += c);
        x.iter().zip(scale).map(|(v, s)| v * s).collect()
    }
}

/// A matrix scaled to a unit diagonal.
struct Scaled {
    /// Lower triangle.
    matrix: Vec<(usize, usize, f64)>,
    /// `1/sqrt(diagonal)`.
    scale: Vec<f64>,
}

impl Scaled {
    /// Scales by the diagonal. An unknown without stiffness keeps a zero on its diagonal.
    fn of(mut matrix: Vec<(usize, usize, f64)>, unknowns: usize) -> Result<Self, Unsolvable> {
        let mut diagonal = vec![0.0; unknowns];
        matrix.iter().filter(|(i, j, _)| i == j).for_each(|(i, _, value)| diagonal[*i] += value);
        if let Some(bad) = diagonal.iter().find(|d| !d.is_finite()) {
            return Err(Unsolvable::Failed(format!("a stiffness is {bad}")));
        }
        let scale: Vec<f64> = diagonal.iter().map(|d| if *d > 0.0 { 1.0 / d.sqrt() } else { 1.0 }).collect();
        matrix.iter_mut().for_each(|(i, j, value)| *value *= scale[*i] * scale[*j]);
        Ok(Self { matrix, scale })
    }

    fn factor(&self, shift: f64) -> Result<Llt<usize, f64>, String> {
        let n = self.scale.len();
        let shifts = (0..n).map(|i| Triplet::new(i, i, shift));
        let entries: Vec<_> =
            self.matrix.iter().map(|&(i, j, v)| Triplet::new(i, j, v)).chain(shifts).collect();
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &entries)
            .map_err(|e| format!("{e:?}"))?;
        matrix.sp_cholesky(Side::Lower).map_err(|e| format!("{e:?}"))
    }

    /// Product with the scaled matrix.
    fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for &(i, j, value) in &self.matrix {
            y[i] += value * x[j];
            if i != j {
                y[j] += value * x[i];
            }
        }
        y
    }

    /// The smallest eigenvalue (Rayleigh quotient) and its vector in unscaled unknowns.
    fn smallest(&self, factor: &Llt<usize, f64>) -> (f64, Vec<f64>) {
        // A start without symmetry, so that no mode is missed: fractions of multiples of the golden ratio.
        let mut x: Vec<f64> =
            (0..self.scale.len()).map(|i| (0.618_033_988_75 * (i + 1) as f64).fract() - 0.5).collect();
        for _ in 0..ITERATIONS {
            x = back_substitute(factor, &x);
            let norm = x.iter().map(|v| v * v).sum::<f64>().sqrt();
            if !(norm.is_finite() && norm > 0.0) {
                return (0.0, x);
            }
            x.iter_mut().for_each(|v| *v /= norm);
        }
        let eigenvalue = self.times(&x).iter().zip(&x).map(|(a, b)| a * b).sum();
        (eigenvalue, x.iter().zip(&self.scale).map(|(v, s)| v * s).collect())
    }
}

fn back_substitute(factor: &Llt<usize, f64>, load: &[f64]) -> Vec<f64> {
    let mut x = Mat::from_fn(load.len(), 1, |i, _| load[i]);
    factor.solve_in_place(&mut x);
    (0..load.len()).map(|i| x[(i, 0)]).collect()
}
