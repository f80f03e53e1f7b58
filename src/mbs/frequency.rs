//! The highest natural frequency of the elastic model, which limits the explicit step to `2/ω`.
//!
//! Lanczos iteration on `M⁻¹K` with the inner product of `M`, matrix-free over the springs of the joints (Golub and Van Loan, Matrix Computations, 4th ed., 10.1). It takes a fifth of the iterations of a power iteration, and
//! converges from below as well, so the result carries a margin ([`MARGIN`]); the step then uses [`STEP_FRACTION`] of the limit. What that
//! costs and brings, generated three-storey frame, against steps of 0.05 ms: 0.8 of the limit 1.06 mm before the first contact, e of the whole run 0.008, 72 ms; 0.9: 0.76 mm, 0.005, 61 ms
//! (with inertia against relative motion below 800 and 900 rad/s, which is steps of 2 ms in both; without that 0.43 mm, 0.006, 65 ms and 0.39 mm, 0.006, 60 ms). Against FE the model is off by centimetres.

use super::joint::Row;
use super::math::{self, V3};
use super::system::System;

/// Share of the stability limit `2/ω_max` used by the automatic step.
pub const STEP_FRACTION: f64 = 0.9;
/// Added to the frequency found.
pub const MARGIN: f64 = 0.02;
/// Most iterations.
const ITERATIONS: usize = 120;
/// After how many iterations each the eigenvalue is looked at, and the relative change of it at which they end.
const CHECKED: usize = 8;
const TOLERANCE: f64 = 1e-4;
/// Share of the eigenvalue below which nothing is left to find.
const LEAST: f64 = 1e-10;

/// The springs of all intact joints in the current pose.
pub fn rows(system: &System) -> Vec<Row> {
    system
        .joints
        .iter()
        .filter(|j| j.alive)
        .flat_map(|j| j.rows(&system.bodies))
        .filter(|row| row.stiffness > 0.0)
        .collect()
}

/// Highest natural angular frequency \[rad/s\] with its margin; zero without joints.
pub fn highest_rad_s(system: &mut System) -> f64 {
    let rows = rows(system);
    if rows.is_empty() {
        return 0.0;
    }
    let n = system.bodies.len();
    // forces, the motion that they accelerate to, and both of the iteration before
    let (mut force, mut last) = (start(n), vec![[[0.0; 3]; 2]; n]);
    let (mut motion, mut pull) = (last.clone(), last.clone());
    let mut three = Tridiagonal::default();
    let (mut square, mut alpha) = (0.0, 0.0);
    for i in 1..=ITERATIONS {
        motion.clone_from(&force);
        accelerate(system, &mut motion);
        // below zero by rounding where nothing is left
        let norm = dot(&motion, &force);
        if norm.is_nan() || norm <= (LEAST * alpha).powi(2) {
            break;
        }
        let beta = norm.sqrt();
        scale(&mut motion, 1.0 / beta);
        scale(&mut force, 1.0 / beta);
        apply_stiffness(&rows, &motion, &mut pull);
        alpha = dot(&motion, &pull);
        three.push(alpha, if i > 1 { beta } else { 0.0 });
        for k in 0..n - 1 {
            for c in 0..2 {
                let before = if i > 1 { beta } else { 0.0 };
                let next = math::axpy(math::axpy(pull[k][c], -alpha, force[k][c]), -before, last[k][c]);
                (last[k][c], force[k][c]) = (force[k][c], next);
            }
        }
        if i % CHECKED == 0 || i == ITERATIONS {
            let next = three.largest();
            let change = next - square;
            square = next;
            if change <= TOLERANCE * square {
                break;
            }
        }
    }
    three.largest().sqrt() * (1.0 + MARGIN)
}

/// Accelerations under forces, in their place.
fn accelerate(system: &mut System, forces: &mut [[V3; 2]]) {
    let mut shared = std::mem::take(&mut system.shared);
    shared.iter_mut().for_each(|s| s.act_on(system.isa, &system.bodies, forces));
    system.shared = shared;
    for (own, (data, body)) in forces.iter_mut().zip(system.data.iter().zip(&system.bodies)) {
        own[0] = math::scale(data.inverse_mass, own[0]);
        own[1] = math::mul(&body.r, math::mul(&data.inverse_inertia, math::mul_t(&body.r, own[1])));
    }
}

fn dot(a: &[[V3; 2]], b: &[[V3; 2]]) -> f64 {
    a.iter().zip(b).map(|(a, b)| math::dot(a[0], b[0]) + math::dot(a[1], b[1])).sum()
}

fn scale(vector: &mut [[V3; 2]], by: f64) {
    vector.iter_mut().flatten().flatten().for_each(|v| *v *= by);
}

/// A symmetric matrix with entries on and beside its diagonal.
#[derive(Debug, Default)]
struct Tridiagonal {
    /// On it, and the square of the one before each.
    entries: Vec<[f64; 2]>,
}

impl Tridiagonal {
    fn push(&mut self, on: f64, beside: f64) {
        self.entries.push([on, beside * beside]);
    }

    /// Its largest eigenvalue by bisection: all pivots of what is beyond it are negative (Sturm).
    fn largest(&self) -> f64 {
        let is_beyond = |x: f64| {
            let mut pivot = f64::NEG_INFINITY;
            self.entries.iter().all(|[on, square]| {
                pivot = on - x - square / pivot;
                pivot < 0.0
            })
        };
        let widest = self.entries.iter().map(|[_, square]| square.sqrt()).fold(0.0, f64::max);
        let most = self.entries.iter().map(|[on, _]| *on).fold(0.0, f64::max);
        let (mut low, mut high) = (most, most + 2.0 * widest);
        while high - low > 1e-9 * high {
            let middle = 0.5 * (low + high);
            if is_beyond(middle) { high = middle } else { low = middle }
        }
        high
    }
}

/// A start vector without symmetry, the same on every machine.
fn start(n: usize) -> Vec<[V3; 2]> {
    let mut seed = 12345_u64;
    let mut x = vec![[[0.0; 3]; 2]; n];
    for value in x[..n - 1].iter_mut().flatten().flatten() {
        seed = (1_103_515_245 * seed + 12345) % (1 << 31);
        *value = seed as f64 / f64::from(1 << 30) - 1.0;
    }
    x
}

/// `y = K x`; the ground's entry of `x` must be zero.
fn apply_stiffness(rows: &[Row], x: &[[V3; 2]], y: &mut [[V3; 2]]) {
    y.iter_mut().flatten().flatten().for_each(|v| *v = 0.0);
    for row in rows {
        let stretch = math::dot(row.force, math::sub(x[row.b][0], x[row.a][0]))
            + math::dot(row.turn_b, x[row.b][1])
            - math::dot(row.turn_a, x[row.a][1]);
        let f = row.stiffness * stretch;
        y[row.a][0] = math::axpy(y[row.a][0], -f, row.force);
        y[row.a][1] = math::axpy(y[row.a][1], -f, row.turn_a);
        y[row.b][0] = math::axpy(y[row.b][0], f, row.force);
        y[row.b][1] = math::axpy(y[row.b][1], f, row.turn_b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::model::{Body, Bushing, Model, Origin};

    /// Equal masses in a row on springs along it, the first of them on the ground.
    fn row(count: usize) -> System {
        let mut m = Model::empty("row", [0.0; 3], 1.0, 0.1);
        for i in 0..count {
            m.bodies.push(Body {
                id: format!("b{i}"),
                mass_kg: 250.0,
                inertia_kg_m2: [[40.0, 0.0, 0.0], [0.0, 50.0, 0.0], [0.0, 0.0, 60.0]],
                position_m: [i as f64 + 0.5, 0.0, 0.0],
                orientation: [1.0, 0.0, 0.0, 0.0],
                velocity_m_s: [0.0; 3],
                angular_velocity_rad_s: [0.0; 3],
                shapes: Vec::new(),
                origin: Origin::default(),
            });
            m.bushings.push(Bushing {
                axial_stiffness_n_m: 1e8,
                ..Bushing::free(
                    format!("j{i}"),
                    (i > 0).then(|| format!("b{}", i - 1)),
                    format!("b{i}"),
                    [i as f64, 0.0, 0.0],
                    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                )
            });
        }
        System::new(&m).unwrap()
    }

    #[test]
    fn a_row_of_masses_has_the_highest_frequency_of_the_closed_form() {
        // ω = 2 sqrt(k/m) cos(π / (2n + 1)) (Rayleigh, The Theory of Sound, art. 120)
        for count in [1, 2, 7, 40, 200] {
            let angle = std::f64::consts::PI / (2 * count + 1) as f64;
            let exact = 2.0 * (1e8_f64 / 250.0).sqrt() * angle.cos();
            let found = highest_rad_s(&mut row(count)) / (1.0 + MARGIN);
            assert!(
                (found / exact - 1.0).abs() < 2e-3 && found < exact * (1.0 + 1e-8),
                "{count}: {found} {exact}"
            );
        }
    }
}
