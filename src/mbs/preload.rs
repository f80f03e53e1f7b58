//! Static equilibrium under gravity, from which the run starts.
//!
//! Newton's method on the `6n` equilibrium equations with the elastic stiffness of the joints
//! (their geometric stiffness is left out: it only slows the convergence to a linear rate of the order
//! "load over buckling load", and hinges that flow slow it to one of the order of their hardening; where it is slow the last
//! steps are mixed: Anderson, J. ACM 12 (1965) 547, as in Walker and Ni, SIAM J. Numer. Anal. 49 (2011) 1715). Hinges follow their law from the virgin state, so an
//! equilibrium that needs plastic rotation is found as well, if there is one.

use super::frequency;
use super::joint::{JointData, Row};
use super::math;
use super::system::System;
use crate::base::sparse::{Positive, Unsolvable};
use nalgebra::{DMatrix, DVector};

/// Largest residual force relative to the weight of the model.
const TOLERANCE: f64 = 1e-10;
/// Most Newton iterations.
const ITERATIONS: usize = 200;
/// Iterations after which steps are mixed, and how many of the last ones.
const SLOW: usize = 20;
const MIXED: usize = 6;
/// Rounding of a force over that of the coordinates times the stiffness.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

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
        /// The body with the largest residual of the pass that came nearest.
        body: usize,
        /// That residual relative to the weight.
        residual: f64,
    },
}

/// Standard gravity \[m/s²\].
const STANDARD_GRAVITY: f64 = 9.80665;

/// Moves the system into equilibrium; returns the number of iterations.
pub fn equilibrate(system: &mut System) -> Result<usize, PreloadError> {
    let n = system.count();
    let pull = math::norm(system.gravity);
    // without gravity the weight on earth tells what is small
    let pull = if pull > 0.0 { pull } else { STANDARD_GRAVITY };
    let weight: f64 = system.data.iter().map(|d| d.mass).sum::<f64>() * pull;
    let rows = frequency::rows(system);
    let length = characteristic_length(system, &rows);
    let factor = Positive::of(assemble(system, &rows, length), 6 * n).map_err(|why| match why {
        Unsolvable::Singular(mode) => PreloadError::Mechanism { body: largest(&mode) / 6 },
        Unsolvable::Failed(_) => PreloadError::NoConvergence { body: 0, residual: f64::NAN },
    })?;
    let tolerance = (TOLERANCE * weight).max(rounding_n(system, &rows, length));
    let virgin = system.joints.clone();
    let mut mixing = Mixing::default();
    // the first pass has moved nothing: what it leaves is weight, and says nothing of resistance
    let mut nearest: Option<(usize, f64)> = None;
    for iteration in 0..ITERATIONS {
        // what members carry over follows the moments: their leans are those of the first pass
        evaluate(system, &virgin);
        let carried = system.settle_carries();
        if carried > 0.0 {
            evaluate(system, &virgin);
        }
        let (residual, last) = unbalanced(system, length);
        if last.1 <= tolerance && carried <= tolerance * length {
            return Ok(iteration);
        }
        if !last.1.is_finite() {
            break;
        }
        let open = last.1 + carried / length;
        if iteration > 0 && nearest.is_none_or(|(_, least)| open < least) {
            nearest = Some((last.0, open));
        }
        let step = mixing.step(factor.solve(&residual), iteration >= SLOW);
        for i in 0..n {
            let body = &mut system.bodies[i];
            for k in 0..3 {
                body.x[k] += step[6 * i + k];
            }
            body.rotate(std::array::from_fn(|k| step[6 * i + 3 + k] / length));
        }
    }
    let (body, residual) = nearest.unwrap_or((0, f64::INFINITY));
    Err(PreloadError::NoConvergence { body, residual: residual / weight })
}

/// What rounding of the coordinates leaves of the forces of the stiffest springs \[N\], of moments over `length`.
fn rounding_n(system: &System, rows: &[Row], length: f64) -> f64 {
    let bodies = &system.bodies[..system.count()];
    let farthest = bodies.iter().flat_map(|b| b.x).fold(length, |most, x| x.abs().max(most));
    let stiffest = rows
        .iter()
        .map(|row| if row.force == [0.0; 3] { row.stiffness / length } else { row.stiffness * farthest });
    ROUNDING * stiffest.fold(0.0, f64::max)
}

/// The last steps, and what they would have been by themselves.
#[derive(Debug, Default)]
struct Mixing {
    plain: Vec<Vec<f64>>,
    taken: Vec<Vec<f64>>,
}

impl Mixing {
    /// The step to take for a plain one: with those before it where it is mixed, so that what is left of the plain steps, linear in between, is least.
    fn step(&mut self, plain: Vec<f64>, is_mixed: bool) -> Vec<f64> {
        let mut step = plain.clone();
        if is_mixed && !self.plain.is_empty() {
            let later = self.plain[1..].iter().chain([&plain]);
            let change = |(before, after): (&Vec<f64>, &Vec<f64>)| {
                before.iter().zip(after).map(|(b, a)| a - b).collect::<Vec<f64>>()
            };
            let changes: Vec<Vec<f64>> = self.plain.iter().zip(later).map(change).collect();
            let matrix = DMatrix::from_fn(plain.len(), changes.len(), |r, c| changes[c][r]);
            let shares = matrix.svd(true, true).solve(&DVector::from_column_slice(&plain), 1e-12);
            if let Ok(shares) = shares {
                for (share, (changed, moved)) in shares.iter().zip(changes.iter().zip(&self.taken)) {
                    for (own, (c, m)) in step.iter_mut().zip(changed.iter().zip(moved)) {
                        *own -= share * (c + m);
                    }
                }
            }
        }
        self.plain.push(plain);
        self.taken.push(step.clone());
        if self.plain.len() > MIXED {
            self.plain.remove(0);
            self.taken.remove(0);
        }
        step
    }
}

/// Forces and moments without a counterpart, moments over `length`, and the body with the largest of them; what is not a number is the largest of all.
fn unbalanced(system: &System, length: f64) -> (Vec<f64>, (usize, f64)) {
    let mut residual = Vec::with_capacity(6 * system.count());
    let mut last = (0, 0.0);
    // the ground is behind the last of them
    for (i, body) in system.bodies.iter().take(system.count()).enumerate() {
        residual.extend(body.force);
        residual.extend(body.torque.map(|t| t / length));
        let own = residual[6 * i..].iter().map(|f| f.abs());
        // unlike `max`, it keeps what is not a number
        let size = own.fold(0.0_f64, |most, f| if most.is_nan() || f <= most { most } else { f });
        if size > last.1 || size.is_nan() {
            last = (i, size);
        }
    }
    (residual, last)
}

/// Forces of virgin joints, which keep their leans.
fn evaluate(system: &mut System, virgin: &[JointData]) {
    for (joint, virgin) in system.joints.iter_mut().zip(virgin) {
        let lean = joint.lean;
        joint.clone_from(virgin);
        joint.lean = lean;
    }
    system.pack();
    system.reset_forces();
    system.add_joint_forces();
}

/// A length that makes rotations and displacements comparable: the largest lever arm of a joint.
fn characteristic_length(system: &System, rows: &[Row]) -> f64 {
    let arms = rows.iter().filter(|r| r.force != [0.0; 3]);
    let largest = arms
        .map(|r| math::norm(r.turn_b).max(if r.a == system.count() { 0.0 } else { math::norm(r.turn_a) }));
    let length = largest.fold(0.0, f64::max);
    if length > 0.0 { length } else { 1.0 }
}

/// Elastic stiffness of the joints: the lower triangle of `6n x 6n`, rotations scaled by `length`; entries of the same place add up.
fn assemble(system: &System, rows: &[Row], length: f64) -> Vec<(usize, usize, f64)> {
    let n = system.count();
    let mut entries = Vec::new();
    let mut add = |one: &Row, other: &Row, stiffness: f64| {
        let parts = [one, other].map(|row| sides(row, length));
        for (i, u) in parts[0].iter().filter(|(i, _)| *i < n) {
            for (j, v) in parts[1].iter().filter(|(j, _)| j <= i) {
                for (r, c) in (0..6).flat_map(|r| (0..6).map(move |c| (6 * i + r, 6 * j + c))) {
                    let value = stiffness * u[r % 6] * v[c % 6];
                    if r >= c && value != 0.0 {
                        entries.push((r, c, value));
                    }
                }
            }
        }
    };
    rows.iter().for_each(|row| add(row, row, row.stiffness));
    for carry in &system.carries {
        let own = carry.joints.map(|i| system.joints[i].rows(&system.bodies));
        for k in 0..2 {
            let change = carry.stiffness_change(&system.joints, k);
            for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                add(&own[i][4 + k], &own[j][4 + k], change[i][j]);
            }
        }
    }
    entries
}

/// Both bodies of a spring, and what a unit of its stretch does to them; rotations scaled by `length`.
fn sides(row: &Row, length: f64) -> [(usize, [f64; 6]); 2] {
    let side = |force: [f64; 3], turn: [f64; 3], sign: f64| -> [f64; 6] {
        std::array::from_fn(|i| sign * if i < 3 { force[i] } else { turn[i - 3] / length })
    };
    [(row.a, side(row.force, row.turn_a, -1.0)), (row.b, side(row.force, row.turn_b, 1.0))]
}

/// Place of the entry of greatest size.
fn largest(mode: &[f64]) -> usize {
    (0..mode.len()).max_by(|a, b| mode[*a].abs().total_cmp(&mode[*b].abs())).unwrap_or(0)
}
