//! The static dead-load state: sparse solve with the elements' own stiffness, repeated until the
//! residual of the nonlinear equations is negligible.

use super::dynamics::Dynamics;
use super::kernel::KernelStep;
use super::stiffness::{LowerColumns, Unknowns, assemble, for_each_entry, number_unknowns};
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, SparseColMatRef, SymbolicSparseColMatRef, Triplet};
use faer::{Mat, Side};

/// Largest residual force over the total weight at which the state counts as equilibrium.
pub const RESIDUAL: f64 = 1e-9;
/// Iterations of the (modified Newton) solve, at most.
pub const ITERATIONS: usize = 60;
/// Equations from which the factor is kept in single precision and refined by conjugate gradients: half the memory.
pub const SINGLE_PRECISION_FROM: usize = 100_000;
/// Conjugate gradient iterations of one solve, at most, and the residual at which they end.
const REFINEMENTS: (usize, f64) = (300, 1e-6);

/// Why the sparse solve finds no static state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreloadError {
    /// The stiffness matrix could not be built.
    #[error("stiffness matrix: {0}")]
    Stiffness(String),
    /// It is singular.
    #[error("the structure is a mechanism: its stiffness matrix is not positive definite")]
    Mechanism,
    /// It is so nearly singular that the iterations find no solution.
    #[error(
        "the structure is a mechanism, or nearly so: no static solution within {} refinements of the sparse solve",
        REFINEMENTS.0
    )]
    NearMechanism,
    /// Not a number.
    #[error("the static solve diverges")]
    Diverges,
    /// The elastic iterations do not converge.
    #[error(
        "no equilibrium under dead load after {ITERATIONS} iterations: the structure yields under its own weight"
    )]
    NoEquilibrium,
}

/// [`solve`] with the error as text.
pub fn equilibrate(body: &mut Dynamics) -> Result<usize, String> {
    solve(body).map_err(|e| e.to_string())
}

/// Brings a body from rest into static equilibrium under gravity and applied forces. Returns the number
/// of iterations, or what is wrong.
pub fn solve(body: &mut Dynamics) -> Result<usize, PreloadError> {
    let (unknown, count) = number_unknowns(body);
    let solver = Solver::of(body, &unknown, count)?;
    let gravity = body.acceleration_m_s2.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let weight: f64 = body.mass_kg.iter().sum::<f64>() * gravity
        + body.applied_n.iter().flatten().map(|f| f.abs()).sum::<f64>();
    for iteration in 0..ITERATIONS {
        let mut rhs = vec![0.0; count];
        let mut largest: f64 = 0.0;
        for (n, row) in unknown.iter().enumerate() {
            if row.iter().all(Option::is_none) {
                continue;
            }
            let force = residual(body, n);
            for (force, u) in force.into_iter().zip(row) {
                if let Some(u) = u {
                    rhs[*u as usize] = force;
                    largest = if force.is_finite() { largest.max(force.abs()) } else { f64::INFINITY };
                }
            }
        }
        if !largest.is_finite() {
            return Err(PreloadError::Diverges);
        }
        if largest <= RESIDUAL * weight {
            body.v.iter_mut().for_each(|v| *v = [0.0; 3]);
            return Ok(iteration);
        }
        let step = solver.solve(&rhs)?;
        for (v, row) in body.v.iter_mut().zip(&unknown) {
            *v = row.map(|u| u.map_or(0.0, |u| step[u as usize]));
        }
        body.follow_ties();
        for (x, v) in body.x.as_flattened_mut().iter_mut().zip(body.v.as_flattened()) {
            *x += v;
        }
        body.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 1.0);
    }
    Err(PreloadError::NoEquilibrium)
}

/// Force out of balance on a node and on what is tied to it \[N\].
fn residual(body: &Dynamics, n: usize) -> [f64; 3] {
    let own = |n: usize| -> [f64; 3] {
        let internal_n = body.internal_n(n);
        let other = body.other_n.get(n).copied().unwrap_or_default();
        std::array::from_fn(|i| {
            let weight = body.mass_kg[n] * body.acceleration_m_s2[i];
            body.applied_n[n][i] + weight + other[i] - internal_n[i]
        })
    };
    let mut force = own(n);
    for (node, share) in body.ties.carried_by(n) {
        let tied = own(*node as usize);
        force = std::array::from_fn(|i| force[i] + share * tied[i]);
    }
    force
}

/// A factorised stiffness for many right-hand sides, in single precision: half the memory and the time.
#[derive(Debug, Clone)]
pub struct Factor(Llt<u32, f32>);

impl Factor {
    /// Of the lower triangle of a positive definite matrix by columns: starts of the columns, one more than there are, row numbers in order, values.
    pub fn of(starts: &[u32], rows: &[u32], values: &[f32]) -> Option<Self> {
        let count = starts.len() - 1;
        let pattern = SymbolicSparseColMatRef::new_checked(count, count, starts, None, rows);
        SparseColMatRef::new(pattern, values).sp_cholesky(Side::Lower).ok().map(Self)
    }

    /// The solution for a right-hand side.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let scale = rhs.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(b.abs()));
        let solution = self.0.solve(&Mat::from_fn(rhs.len(), 1, |i, _| (rhs[i] / scale) as f32));
        (0..rhs.len()).map(|i| f64::from(solution[(i, 0)]) * scale).collect()
    }
}

/// A factorised stiffness.
enum Solver {
    /// In double precision.
    Direct(Llt<usize, f64>),
    /// In single precision, beside the matrix.
    Refined(LowerColumns, Factor),
}

impl Solver {
    fn of(body: &Dynamics, unknown: &Unknowns, count: usize) -> Result<Self, PreloadError> {
        if count >= SINGLE_PRECISION_FROM {
            return Self::refined(assemble(body, unknown, count));
        }
        let mut triplets = Vec::with_capacity(body.blocks.elements() * 300);
        for_each_entry(body, unknown, |r, c, v| triplets.push(Triplet::new(r as usize, c as usize, v)));
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(count, count, &triplets)
            .map_err(|e| PreloadError::Stiffness(format!("{e:?}")))?;
        drop(triplets);
        matrix.sp_cholesky(Side::Lower).map(Self::Direct).map_err(|_| PreloadError::Mechanism)
    }

    fn refined(mut matrix: LowerColumns) -> Result<Self, PreloadError> {
        let n = matrix.count;
        let diagonal: Vec<f32> = matrix.starts[..n].iter().map(|s| matrix.values[*s as usize]).collect();
        let mut factor = None;
        // Rounding to single precision may cost a matrix its definiteness; as a preconditioner it may be a little stiffer.
        for stiffer in [1e-6, 1e-4] {
            for (start, value) in matrix.starts.iter().zip(&diagonal) {
                matrix.values[*start as usize] = (f64::from(*value) * (1.0 + stiffer)) as f32;
            }
            factor = Factor::of(&matrix.starts, &matrix.rows, &matrix.values);
            if factor.is_some() {
                break;
            }
        }
        for (start, value) in matrix.starts.iter().zip(&diagonal) {
            matrix.values[*start as usize] = *value;
        }
        factor.map(|factor| Self::Refined(matrix, factor)).ok_or(PreloadError::Mechanism)
    }

    fn solve(&self, rhs: &[f64]) -> Result<Vec<f64>, PreloadError> {
        match self {
            Self::Direct(factor) => {
                let step = factor.solve(&Mat::from_fn(rhs.len(), 1, |i, _| rhs[i]));
                Ok((0..rhs.len()).map(|i| step[(i, 0)]).collect())
            }
            Self::Refined(matrix, factor) => conjugate_gradients(matrix, rhs, |r| factor.solve(r)),
        }
    }
}

/// Preconditioned conjugate gradients (Saad, Iterative Methods for Sparse Linear Systems, algorithm 9.1).
fn conjugate_gradients(
    matrix: &LowerColumns,
    rhs: &[f64],
    precondition: impl Fn(&[f64]) -> Vec<f64>,
) -> Result<Vec<f64>, PreloadError> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut x, mut product, mut r) = (vec![0.0; rhs.len()], vec![0.0; rhs.len()], rhs.to_vec());
    let aim = REFINEMENTS.1 * dot(rhs, rhs).sqrt();
    let mut z = precondition(&r);
    let mut p = z.clone();
    let mut power = dot(&r, &z);
    for _ in 0..REFINEMENTS.0 {
        matrix.times(&p, &mut product);
        let curvature = dot(&p, &product);
        if curvature <= 0.0 || !curvature.is_finite() {
            return Err(PreloadError::Mechanism);
        }
        let length = power / curvature;
        for i in 0..x.len() {
            x[i] += length * p[i];
            r[i] -= length * product[i];
        }
        if dot(&r, &r).sqrt() <= aim {
            return Ok(x);
        }
        z = precondition(&r);
        let next = dot(&r, &z);
        let turn = next / power;
        power = next;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + turn * *p);
    }
    Err(PreloadError::NearMechanism)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs on an elastic bed.
    fn chain(count: usize) -> LowerColumns {
        let mut matrix = LowerColumns { count, starts: vec![0], ..Default::default() };
        for i in 0..count {
            matrix.rows.push(i as u32);
            matrix.values.push(2.0e9 + 1e4);
            if i + 1 < count {
                matrix.rows.push(i as u32 + 1);
                matrix.values.push(-1.0e9);
            }
            matrix.starts.push(matrix.rows.len() as u32);
        }
        matrix
    }

    #[test]
    fn single_precision_is_refined_to_the_residual_asked_for() {
        let matrix = chain(50_000);
        let mut rhs = vec![0.0; matrix.count];
        rhs[40_000] = 1e5;
        let solver = Solver::refined(matrix.clone()).unwrap();
        let x = solver.solve(&rhs).unwrap();
        let mut back = vec![0.0; matrix.count];
        matrix.times(&x, &mut back);
        let off = back.iter().zip(&rhs).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        assert!(off < 2e-6 * 1e5, "{off}");
    }

    #[test]
    fn a_free_chain_is_a_mechanism() {
        let mut matrix = chain(50);
        matrix.values.iter_mut().for_each(|v| *v = if *v > 0.0 { 2.0e9 } else { -1.0e9 });
        let last = matrix.values.len() - 1;
        (matrix.values[0], matrix.values[last]) = (1e9, 1e9);
        let solved = Solver::refined(matrix).and_then(|s| s.solve(&[1.0; 50]));
        assert!(solved.is_err_and(|e| e.to_string().contains("mechanism")));
    }
}
