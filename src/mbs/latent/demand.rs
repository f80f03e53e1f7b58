//! What latent bushings bear inside a body that moves as one.
//!
//! The pieces of the body are thought of as joined by the elastic springs of its latent bushings (stiffness `K`), loaded by what acts on each piece and by
//! d'Alembert's forces of the rigid motion: `K u = f - M a`, `a = G (GᵀMG)⁻¹ Gᵀ f` with the rigid motions `G`. The forces in the springs follow from `u`. In a chain this is the
//! balance of the part beyond the section; in loops it is the elastic distribution. Gravity falls out, since it accelerates all pieces alike. In the frame of the body everything but the
//! loads is constant, so that the forces of the springs are one matrix times the loads.
//!
//! **Impacts** act with impulses, and an impulse has no force. What an elastic body would feel of one is bounded by its slowest vibration: the loads of contacts go through
//! a low-pass filter with that angular frequency `ω`, so that an impulse `J` counts as the force `ω J` and a steady force as itself, whatever the step.

use crate::mbs::joint::JointData;
use crate::mbs::math::{self, M3, V3};
use crate::mbs::system::{BodyData, BodyState, System};
use nalgebra::{DMatrix, DVector};

/// Force and moment about the centre of mass of the body, in its axes \[N, N m\].
pub(super) type Wrench = [V3; 2];

/// Iterations for the slowest vibration, which has to be known to some per cent only.
const ITERATIONS: usize = 40;

/// A piece of a body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    pub mass: f64,
    /// In the axes of the body \[kg m²\].
    pub inertia: M3,
    /// From the centre of mass of the body \[m\].
    pub arm: V3,
}

/// The forces of the latent bushings of a body.
#[derive(Debug, Clone)]
pub(super) struct Demand {
    pieces: Vec<Piece>,
    /// Forces of the springs, six a bushing, over the loads of the pieces, six each.
    operator: DMatrix<f64>,
    /// Forces of the springs over the products of angular velocities in [`PRODUCTS`].
    rotation: DMatrix<f64>,
    loads: DVector<f64>,
    forces: DVector<f64>,
    /// Slowest vibration of the pieces on their springs \[rad/s\].
    frequency: f64,
}

impl Demand {
    /// For pieces with their states and constants in the initial pose of the model, and the latent bushings between them with the pieces that each joins; the axes of the body are those of space.
    pub fn new(
        states: &[BodyState],
        data: &[BodyData],
        own: &[usize],
        joints: &[&JointData],
        center: V3,
    ) -> Self {
        let pieces: Vec<Piece> = own
            .iter()
            .map(|i| {
                let r = &states[*i].r;
                let inertia = math::turned(r, &data[*i].inertia);
                Piece { mass: data[*i].mass, inertia, arm: math::sub(states[*i].x, center) }
            })
            .collect();
        let place = |body: usize| own.iter().position(|i| *i == body).unwrap_or(0);
        let n = pieces.len();
        let mut stretch = DMatrix::zeros(6 * joints.len(), 6 * n);
        let mut stiffness = DVector::zeros(6 * joints.len());
        for (l, joint) in joints.iter().enumerate() {
            for (r, row) in joint.rows(states).iter().enumerate() {
                stiffness[6 * l + r] = row.stiffness;
                for k in 0..3 {
                    stretch[(6 * l + r, 6 * place(row.a) + k)] -= row.force[k];
                    stretch[(6 * l + r, 6 * place(row.a) + 3 + k)] -= row.turn_a[k];
                    stretch[(6 * l + r, 6 * place(row.b) + k)] += row.force[k];
                    stretch[(6 * l + r, 6 * place(row.b) + 3 + k)] += row.turn_b[k];
                }
            }
        }
        let mass = mass_matrix(&pieces);
        let rigid = rigid_motions(&pieces);
        let (flexibility, balanced) = flexibility(&stretch, &stiffness, &mass, &rigid);
        let operator = DMatrix::from_diagonal(&stiffness) * &stretch * &flexibility;
        let rotation = &operator * rotation_loads(&pieces);
        let frequency = slowest(&(balanced.transpose() * flexibility), &mass);
        Self {
            operator,
            rotation,
            loads: DVector::zeros(6 * n),
            forces: DVector::zeros(6 * joints.len()),
            frequency,
            pieces,
        }
    }

    /// Slowest vibration of the pieces on their springs \[rad/s\].
    pub fn frequency_rad_s(&self) -> f64 {
        self.frequency
    }

    /// Sets the forces to those of the rotation of the body \[rad/s, its axes\] and the loads to none.
    pub fn start(&mut self, spin: V3) {
        self.loads.fill(0.0);
        self.forces.fill(0.0);
        for (k, product) in products(spin).into_iter().enumerate() {
            self.forces.axpy(product, &self.rotation.column(k), 1.0);
        }
    }

    /// Adds a load on a piece.
    pub fn add(&mut self, piece: usize, [force, moment]: Wrench) {
        let own = math::sub(moment, math::cross(self.pieces[piece].arm, force));
        for k in 0..3 {
            self.loads[6 * piece + k] += force[k];
            self.loads[6 * piece + 3 + k] += own[k];
        }
    }

    /// Adds the forces of the loads.
    pub fn solve(&mut self) {
        for (column, load) in self.loads.iter().enumerate().filter(|(_, load)| **load != 0.0) {
            self.forces.axpy(*load, &self.operator.column(column), 1.0);
        }
    }

    /// Number of pieces.
    pub fn count(&self) -> usize {
        self.pieces.len()
    }

    /// What [`Self::of`] a bushing becomes under one load on a piece.
    pub fn of_load(&self, l: usize, piece: usize, [force, moment]: Wrench) -> [V3; 2] {
        let own = math::sub(moment, math::cross(self.pieces[piece].arm, force));
        let row = |r: usize| -> f64 {
            let of = |k: usize| self.operator[(6 * l + r, 6 * piece + k)];
            (0..3).map(|k| of(k) * force[k] + of(3 + k) * own[k]).sum()
        };
        [[row(0), row(1), row(2)], [row(3), row(4), row(5)]]
    }

    /// The same under one of the products of angular velocities.
    pub fn of_rotation(&self, l: usize, product: usize) -> [V3; 2] {
        let row = |r: usize| self.rotation[(6 * l + r, product)];
        [[row(0), row(1), row(2)], [row(3), row(4), row(5)]]
    }

    /// Force and moment of a bushing along its axes, as a gap and a rotation of its second piece would make them.
    pub fn of(&self, l: usize) -> [V3; 2] {
        let f = |r: usize| self.forces[6 * l + r];
        [[f(0), f(1), f(2)], [f(3), f(4), f(5)]]
    }
}

/// Products of components of the angular velocity.
const PRODUCTS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];

/// Those of an angular velocity.
pub(super) fn products(w: V3) -> [f64; 6] {
    PRODUCTS.map(|[i, j]| w[i] * w[j])
}

/// d'Alembert's loads of a rotation `w` on the pieces, `-m w×(w×r)` and `-w×(I w)`, over the products of its components.
fn rotation_loads(pieces: &[Piece]) -> DMatrix<f64> {
    let mut loads = DMatrix::zeros(6 * pieces.len(), PRODUCTS.len());
    let unit = |i: usize| std::array::from_fn(|k| if k == i { 1.0 } else { 0.0 });
    for (p, piece) in pieces.iter().enumerate() {
        let of = |a: V3, b: V3| {
            let pull = math::scale(-piece.mass, math::cross(a, math::cross(b, piece.arm)));
            [pull, math::scale(-1.0, math::cross(a, math::mul(&piece.inertia, b)))]
        };
        for (column, [i, j]) in PRODUCTS.into_iter().enumerate() {
            let (a, b): (V3, V3) = (unit(i), unit(j));
            let [mut pull, mut turn] = of(a, b);
            if i != j {
                let [other_pull, other_turn] = of(b, a);
                (pull, turn) = (math::add(pull, other_pull), math::add(turn, other_turn));
            }
            for k in 0..3 {
                loads[(6 * p + k, column)] = pull[k];
                loads[(6 * p + 3 + k, column)] = turn[k];
            }
        }
    }
    loads
}

fn mass_matrix(pieces: &[Piece]) -> DMatrix<f64> {
    let mut m = DMatrix::zeros(6 * pieces.len(), 6 * pieces.len());
    for (p, piece) in pieces.iter().enumerate() {
        for i in 0..3 {
            m[(6 * p + i, 6 * p + i)] = piece.mass;
            for j in 0..3 {
                m[(6 * p + 3 + i, 6 * p + 3 + j)] = piece.inertia[i][j];
            }
        }
    }
    m
}

/// Displacements and rotations of the pieces in the six rigid motions.
fn rigid_motions(pieces: &[Piece]) -> DMatrix<f64> {
    let mut g = DMatrix::zeros(6 * pieces.len(), 6);
    for (p, piece) in pieces.iter().enumerate() {
        for k in 0..3 {
            let mut axis = [0.0; 3];
            axis[k] = 1.0;
            let path = math::cross(axis, piece.arm);
            g[(6 * p + k, k)] = 1.0;
            g[(6 * p + 3 + k, 3 + k)] = 1.0;
            for i in 0..3 {
                g[(6 * p + i, 3 + k)] = path[i];
            }
        }
    }
    g
}

/// Displacements of the pieces for loads, the first piece held, d'Alembert's forces included; and what those leave of the loads.
fn flexibility(
    stretch: &DMatrix<f64>,
    stiffness: &DVector<f64>,
    mass: &DMatrix<f64>,
    rigid: &DMatrix<f64>,
) -> (DMatrix<f64>, DMatrix<f64>) {
    let size = mass.nrows();
    let carried = mass * rigid;
    let whole = rigid.transpose() * &carried;
    let share = whole.try_inverse().unwrap_or_else(|| DMatrix::zeros(6, 6));
    let balanced = DMatrix::identity(size, size) - &carried * share * rigid.transpose();
    let k = stretch.transpose() * DMatrix::from_diagonal(stiffness) * stretch;
    let free = size - 6;
    let mut u = DMatrix::zeros(size, size);
    // the model was checked: connected pieces on springs without a zero are stiff once one of them is held
    if let Some(factor) = nalgebra::Cholesky::new(k.view((6, 6), (free, free)).into_owned()) {
        u.view_mut((6, 0), (free, size)).copy_from(&factor.solve(&balanced.view((6, 0), (free, size))));
    }
    (u, balanced)
}

/// Slowest vibration of free pieces by iteration of the flexibility without rigid motion \[rad/s\].
fn slowest(flexibility: &DMatrix<f64>, mass: &DMatrix<f64>) -> f64 {
    let size = mass.nrows();
    let mut u = DVector::from_fn(size, |i, _| 1.0 + 0.1 * ((i * 7) % 11) as f64);
    let mut square = 0.0;
    for _ in 0..ITERATIONS {
        let inertia = mass * &u;
        let norm = u.dot(&inertia).sqrt();
        u = flexibility * (inertia / norm);
        square = u.dot(&(mass * &u)).sqrt();
    }
    if square > 0.0 { 1.0 / square.sqrt() } else { 0.0 }
}

/// What the bushings and springs that a body is attached to do to a piece of it.
pub(super) fn pull(system: &System, joint: usize, is_second: bool) -> Wrench {
    let joint = &system.joints[joint];
    let [force, on_a, on_b] = joint.pull(&system.bodies);
    let (body, force, moment) = if is_second {
        (joint.b, math::scale(-1.0, force), math::scale(-1.0, on_b))
    } else {
        (joint.a, force, on_a)
    };
    let r = &system.bodies[body].r;
    [math::mul_t(r, force), math::mul_t(r, moment)]
}
