//! The static dead-load state: sparse solve with the elements' own stiffness, repeated until the
//! residual of the nonlinear equations is negligible.

use super::dynamics::Dynamics;
use super::kernel::{BlockState, KernelStep, LANES, update_block};
use super::mesh::Mesh;
use faer::linalg::solvers::Solve;
use faer::sparse::{SparseColMat, Triplet};

/// Largest residual force over the total weight at which the state counts as equilibrium.
pub const RESIDUAL: f64 = 1e-9;
/// Iterations of the (modified Newton) solve, at most.
pub const ITERATIONS: usize = 60;

/// Why the sparse solve finds no static state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreloadError {
    /// The stiffness matrix could not be built.
    #[error("stiffness matrix: {0}")]
    Stiffness(String),
    /// It is singular.
    #[error("the structure is a mechanism: its stiffness matrix is not positive definite")]
    Mechanism,
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
pub fn equilibrate(mesh: &Mesh, body: &mut Dynamics) -> Result<usize, String> {
    solve(mesh, body).map_err(|e| e.to_string())
}

/// Brings a body from rest into static equilibrium under gravity and applied forces. Returns the number
/// of iterations, or what is wrong.
pub fn solve(mesh: &Mesh, body: &mut Dynamics) -> Result<usize, PreloadError> {
    let unknown = number_unknowns(body);
    let count = unknown.iter().flatten().filter(|u| u.is_some()).count();
    let stiffness = assemble(mesh, body, &unknown, count).map_err(PreloadError::Stiffness)?;
    let factor = stiffness.sp_cholesky(faer::Side::Lower).map_err(|_| PreloadError::Mechanism)?;
    let gravity = body.acceleration_m_s2.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let weight: f64 = body.mass_kg.iter().sum::<f64>() * gravity
        + body.applied_n.iter().flatten().map(|f| f.abs()).sum::<f64>();
    for iteration in 0..ITERATIONS {
        let mut rhs = faer::Mat::<f64>::zeros(count, 1);
        let mut largest: f64 = 0.0;
        for (n, row) in unknown.iter().enumerate() {
            for (i, u) in row.iter().enumerate() {
                if let Some(u) = u {
                    let force = residual(body, n, i);
                    rhs[(*u, 0)] = force;
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
        let step = factor.solve(&rhs);
        for (n, row) in unknown.iter().enumerate() {
            for (i, u) in row.iter().enumerate() {
                body.v[n][i] = u.map_or(0.0, |u| step[(u, 0)]);
                body.x[n][i] += body.v[n][i];
            }
        }
        body.update_elements(KernelStep { dt_s: 1.0, viscous: false }, 1.0);
        body.refresh_internal_forces();
    }
    Err(PreloadError::NoEquilibrium)
}

fn residual(body: &Dynamics, n: usize, i: usize) -> f64 {
    let weight = body.mass_kg[n] * body.acceleration_m_s2[i];
    body.applied_n[n][i] + weight - body.internal_n[n][i]
}

/// Equation number of each free component.
fn number_unknowns(body: &Dynamics) -> Vec<[Option<usize>; 3]> {
    let mut next = 0;
    let mut number = |free: bool| {
        free.then(|| {
            next += 1;
            next - 1
        })
    };
    (0..body.x.len())
        .map(|n| {
            std::array::from_fn(|i| number(body.mass_kg[n] > 0.0 && body.prescribed_m_s[n][i].is_none()))
        })
        .collect()
}

/// The elastic stiffness, lower triangle, from the kernel itself by unit displacements.
fn assemble(
    mesh: &Mesh,
    body: &Dynamics,
    unknown: &[[Option<usize>; 3]],
    count: usize,
) -> Result<SparseColMat<usize, f64>, String> {
    const UNIT_M: f64 = 1e-9;
    let mut triplets = Vec::with_capacity(mesh.elements.len() * 300);
    for block in &body.blocks.blocks {
        let mut x = [[0.0; LANES]; 24];
        for (lane, nodes) in block.nodes.iter().enumerate() {
            for (local, n) in nodes.iter().enumerate() {
                for i in 0..3 {
                    x[3 * local + i][lane] = body.x[*n as usize][i];
                }
            }
        }
        let mut elastic = block.material;
        elastic.yield_scale = [1e12; LANES];
        let table = &body.blocks.tables[block.material.table];
        for column in 0..24 {
            let mut du = [[0.0; LANES]; 24];
            du[column] = [UNIT_M; LANES];
            let mut state = BlockState { share: block.state.share, ..BlockState::default() };
            let mut force = [[0.0; LANES]; 24];
            update_block(
                &x,
                &du,
                &elastic,
                table,
                &mut state,
                &mut force,
                KernelStep { dt_s: 1.0, viscous: false },
            );
            for lane in 0..block.elements.len() {
                let Some(c) = unknown[block.nodes[lane][column / 3] as usize][column % 3] else { continue };
                for (row, values) in force.iter().enumerate() {
                    let Some(r) = unknown[block.nodes[lane][row / 3] as usize][row % 3] else { continue };
                    if r >= c && block.state.share[lane] > 0.0 {
                        triplets.push(Triplet::new(r, c, values[lane] / UNIT_M));
                    }
                }
            }
        }
    }
    SparseColMat::try_new_from_triplets(count, count, &triplets).map_err(|e| format!("{e:?}"))
}
