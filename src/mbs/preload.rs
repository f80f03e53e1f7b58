//! Static equilibrium under gravity, from which the run starts.
//!
//! Newton's method on the `6n` equilibrium equations with the elastic stiffness of the joints
//! (their geometric stiffness is left out: it only slows the convergence to a linear rate of the order
//! "load over buckling load"). Hinges follow their law from the virgin state, so an
//! equilibrium that needs plastic rotation is found as well, if there is one.

use super::frequency;
use super::math;
use super::system::System;
use nalgebra::{DMatrix, DVector};

/// Largest residual force relative to the weight of the model.
const TOLERANCE: f64 = 1e-10;
/// Most Newton iterations.
const ITERATIONS: usize = 200;
/// Ratio of the smallest to the largest scaled pivot below which the stiffness is singular.
const SINGULAR: f64 = 1e-12;

/// Why there is no equilibrium.
#[derive(Debug, Clone, PartialEq)]
pub enum PreloadError {
    /// The structure can move without resistance.
    Mechanism {
        /// The body that moves most.
        body: usize,
    },
    /// Newton's method did not converge (overload or buckling).
    NoConvergence {
        /// The body with the largest residual.
        body: usize,
        /// The residual relative to the weight.
        residual: f64,
    },
}

/// Moves the system into equilibrium; returns the number of iterations.
pub fn equilibrate(system: &mut System) -> Result<usize, PreloadError> {
    let n = system.count();
    let weight: f64 = system.data.iter().map(|d| d.mass).sum::<f64>() * math::norm(system.gravity);
    let length = characteristic_length(system);
    let stiffness = assemble(system, length);
    let factor = match factorise(&stiffness) {
        Ok(factor) => factor,
        Err(loose) => return Err(PreloadError::Mechanism { body: loose }),
    };
    let virgin = system.joints.clone();
    let mut last = (0, f64::INFINITY);
    for iteration in 0..ITERATIONS {
        system.joints.clone_from(&virgin);
        system.pack();
        system.reset_forces();
        system.add_joint_forces();
        let mut residual = DVector::zeros(6 * n);
        last = (0, 0.0);
        for i in 0..n {
            let body = &system.bodies[i];
            for k in 0..3 {
                residual[6 * i + k] = body.force[k];
                residual[6 * i + 3 + k] = body.torque[k] / length;
            }
            let size = residual.rows(6 * i, 6).amax();
            if size > last.1 || size.is_nan() {
                last = (i, size);
            }
        }
        if last.1 <= TOLERANCE * weight {
            return Ok(iteration);
        }
        if !last.1.is_finite() {
            break;
        }
        let step = factor.solve(&residual);
        for i in 0..n {
            let body = &mut system.bodies[i];
            for k in 0..3 {
                body.x[k] += step[6 * i + k];
            }
            body.rotate(std::array::from_fn(|k| step[6 * i + 3 + k] / length));
        }
    }
    Err(PreloadError::NoConvergence { body: last.0, residual: last.1 / weight })
}

/// A length that makes rotations and displacements comparable: the largest lever arm of a joint.
fn characteristic_length(system: &System) -> f64 {
    let arms = frequency::rows(system).into_iter().filter(|r| r.force != [0.0; 3]);
    let largest = arms
        .map(|r| math::norm(r.turn_b).max(if r.a == system.count() { 0.0 } else { math::norm(r.turn_a) }));
    let length = largest.fold(0.0, f64::max);
    if length > 0.0 { length } else { 1.0 }
}

/// Elastic stiffness of the joints, `6n x 6n`, rotations scaled by `length`.
fn assemble(system: &System, length: f64) -> DMatrix<f64> {
    let n = system.count();
    let mut k = DMatrix::zeros(6 * n, 6 * n);
    for row in frequency::rows(system) {
        let side = |force: [f64; 3], turn: [f64; 3], sign: f64| -> [f64; 6] {
            std::array::from_fn(|i| sign * if i < 3 { force[i] } else { turn[i - 3] / length })
        };
        let parts = [(row.a, side(row.force, row.turn_a, -1.0)), (row.b, side(row.force, row.turn_b, 1.0))];
        for (i, u) in &parts {
            for (j, v) in &parts {
                if *i < n && *j < n {
                    for r in 0..6 {
                        for c in 0..6 {
                            k[(6 * i + r, 6 * j + c)] += row.stiffness * u[r] * v[c];
                        }
                    }
                }
            }
        }
    }
    k
}

/// Cholesky factor, or the body that moves most in the softest mode.
fn factorise(k: &DMatrix<f64>) -> Result<nalgebra::Cholesky<f64, nalgebra::Dyn>, usize> {
    let diagonal: Vec<f64> = (0..k.nrows()).map(|i| k[(i, i)]).collect();
    let largest = diagonal.iter().copied().fold(0.0, f64::max);
    if let Some(i) = diagonal.iter().position(|d| *d <= SINGULAR * largest) {
        return Err(i / 6);
    }
    if let Some(factor) = nalgebra::Cholesky::new(k.clone()) {
        let sound = (0..k.nrows()).all(|i| factor.l_dirty()[(i, i)].powi(2) > SINGULAR * diagonal[i]);
        if sound {
            return Ok(factor);
        }
    }
    // Inverse iteration on the slightly stiffened matrix shows the mechanism.
    let soft = k + DMatrix::identity(k.nrows(), k.ncols()) * (1e-9 * largest);
    let mut mode = DVector::from_fn(k.nrows(), |i, _| 1.0 + 0.1 * ((i * 7) % 11) as f64);
    if let Some(factor) = nalgebra::Cholesky::new(soft) {
        for _ in 0..4 {
            mode = factor.solve(&mode);
            mode /= mode.amax();
        }
    }
    Err(mode.iamax() / 6)
}
