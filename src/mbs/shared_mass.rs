//! Inertial coupling of bodies, as long as they are parts of one elastic body: its consistent mass less the lumped mass that the bodies have.
//!
//! A floor is cut into rigid pieces in the middle of its spans. A span that bends has less inertia than its rigid halves: a clamped beam whose one end is lifted has 13/35 of its mass there, halves have a half. With `M` of
//! the bodies alone and `D` of what is added ([`super::model::SharedMass`]) accelerations are `a = (M + D)⁻¹ f`, as if the forces were `f - D a = f - D (M + D)⁻¹ f`: those are the forces that the integrator gets. The
//! matrix is found once, in the poses at the start, since the bodies turn by little as long as it holds. The kinetic energy has `½ v D v` more.
//!
//! Joints of rigid pieces hold rotations that have nearly no inertia in `M + D`, and would need small steps: `D` has `K / ω²` more, with the stiffness `K` of the joints between the bodies, and of those that turn
//! them, and `ω` the highest frequency without `D` (stiffness-proportional mass scaling; Macek and Aubert, Earthq. Eng. Struct. Dyn. 24 (1995) 1315). A mode of frequency `ω_1` slows down by
//! `ω_1² / 2 ω²`, which is 1e-3 at most for what a floor does as a whole.
//!
//! It ends, for all bodies of a list together, where one of them is touched, leans by more than [`UPRIGHT`], falls asleep or is taken away, where a beam folds, and where a joint between two of them breaks.

use super::joint::{JointData, Row};
use super::lanes::LANES;
use super::math::{self, M3, V3};
use super::model::{Model, SharedMass};
use super::system::{BodyData, BodyState};
use crate::base::isa::{Isa, for_each_isa};
use nalgebra::{Cholesky, DMatrix, DVector, Matrix2, Matrix3, Vector2, Vector3};
use std::collections::BTreeMap;

/// Cosine of the angle by which a body may lean: 0.03 rad.
pub(super) const UPRIGHT: f64 = 0.99955;
/// Plastic rotation at an end of a beam from which it moves as a straight line rather than as a clamped beam \[rad\].
const FOLDED_RAD: f64 = 0.01;
/// Share of a force along z below which a spring turns a body only.
const LEVEL: f64 = 1e-6;

/// The bodies of a list and their matrices, with three rows a body: motion along its z, turns about its x and y. These axes are the global ones at the start and turn with the body, in which its inertia is
/// constant: with fixed axes energy would grow with the lean of the bodies.
#[derive(Debug, Clone)]
pub struct Shared {
    bodies: Vec<usize>,
    /// The joints between them.
    inside: Vec<usize>,
    /// What of `D` is the file's, with its places among the unknowns of all bodies, six each.
    consistent: Vec<(usize, usize, f64)>,
    /// `D`.
    added: DMatrix<f64>,
    /// `-D (M + D)⁻¹`, its columns filled up to whole [`LANES`].
    transfer: Vec<f64>,
    /// Torque about x and y that turns a body as one about z does.
    skew: Vec<[f64; 2]>,
    /// Velocities of all bodies as one rigid body, their momenta, and the inverse of its inertia.
    rigid: DMatrix<f64>,
    momenta: DMatrix<f64>,
    inverse: Matrix3<f64>,
    /// The global axes in each body at the start.
    axes: Vec<M3>,
    /// Memory: the axes of each body, its part, what was found for it.
    turned: Vec<M3>,
    own: DVector<f64>,
    more: DVector<f64>,
}

/// What a compiled model has when sharing begins.
pub struct Start<'a> {
    /// Bodies.
    pub states: &'a [BodyState],
    /// Their constants.
    pub data: &'a [BodyData],
    /// Joints.
    pub joints: &'a [JointData],
    /// The springs of the joints.
    pub rows: &'a [Row],
    /// Highest frequency of the bodies alone \[rad/s\].
    pub highest_rad_s: f64,
}

impl Shared {
    /// Those of a model, in the poses at its start. A list whose inertia is not positive with that of its springs is left out.
    pub fn all(model: &Model, start: &Start) -> Vec<Self> {
        let ids: BTreeMap<&str, usize> =
            model.bodies.iter().enumerate().map(|(i, b)| (b.id.as_str(), i)).collect();
        model.shared_masses.iter().filter_map(|s| Self::new(s, &ids, start)).collect()
    }

    fn new(shared: &SharedMass, ids: &BTreeMap<&str, usize>, start: &Start) -> Option<Self> {
        let place = |id: &String| ids.get(id.as_str()).copied();
        let bodies: Vec<usize> = shared.bodies.iter().map(place).collect::<Option<_>>()?;
        let places: BTreeMap<usize, usize> = bodies.iter().enumerate().map(|(k, i)| (*i, k)).collect();
        let mut added = shared.matrix();
        let at = |row: usize| 6 * bodies[row / 3] + 2 + row % 3;
        let pairs = (0..added.nrows()).flat_map(|i| (0..added.ncols()).map(move |j| (i, j)));
        let consistent = pairs
            .filter(|(i, j)| added[(*i, *j)] != 0.0)
            .map(|(i, j)| (at(i), at(j), added[(i, j)]))
            .collect();
        add_springs(&mut added, &places, start);
        let mut all = added.clone();
        let mut skew = Vec::new();
        for (k, i) in bodies.iter().enumerate() {
            let (r, data) = (&start.states[*i].r, &start.data[*i]);
            let inverse = math::turned(r, &data.inverse_inertia);
            // of a body that is free to turn about z
            let own = Matrix2::from_fn(|a, b| inverse[a][b]).try_inverse()?;
            all[(3 * k, 3 * k)] += data.mass;
            let mut turns = all.fixed_view_mut::<2, 2>(3 * k + 1, 3 * k + 1);
            turns += own;
            skew.push((own * Vector2::new(inverse[0][2], inverse[1][2])).into());
        }
        let centres: Vec<V3> = bodies.iter().map(|i| start.states[*i].x).collect();
        let rigid = as_one(&centres);
        let momenta = &all * &rigid;
        let together = rigid.tr_mul(&momenta);
        let inverse = Matrix3::from_fn(|i, j| together[(i, j)]).try_inverse()?;
        let transfer = in_lanes(-(&added * Cholesky::new(all)?.inverse()));
        let is_inside = |j: &JointData| [j.a, j.b].iter().all(|i| places.contains_key(i));
        let inside = (0..start.joints.len()).filter(|j| is_inside(&start.joints[*j])).collect();
        let axes = bodies.iter().map(|i| math::transpose(&start.states[*i].r)).collect();
        let rows = 3 * bodies.len();
        let (own, more) = (DVector::zeros(rows), DVector::zeros(rows.next_multiple_of(LANES)));
        let turned = vec![M3::default(); bodies.len()];
        Some(Self {
            bodies,
            inside,
            consistent,
            added,
            transfer,
            skew,
            rigid,
            momenta,
            inverse,
            axes,
            turned,
            own,
            more,
        })
    }

    /// The inertia that the file gives: rows, columns (six unknowns a body: along and about the axes) and values of a symmetric matrix, all of it.
    pub fn consistent(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        self.consistent.iter().copied()
    }

    /// The bodies.
    pub fn bodies(&self) -> &[usize] {
        &self.bodies
    }

    /// Changes forces to those with which each body has its acceleration by its own inertia alone.
    pub fn act(&mut self, isa: Isa, states: &mut [BodyState]) {
        // what turns momenta against the axes changes velocities in them as well: without it energy would grow where bodies sway and lean at once
        let in_axes = |i: usize| {
            let b = &states[i];
            [math::sub(b.force, math::cross(b.w, b.p)), math::sub(b.torque, math::cross(b.w, b.l))]
        };
        self.transfer_of(isa, states, in_axes);
        for k in 0..self.bodies.len() {
            let body = &mut states[self.bodies[k]];
            let [force, torque] = self.outwards(k);
            body.force = math::add(body.force, force);
            body.torque = math::add(body.torque, torque);
        }
    }

    /// The same for forces and torques of all bodies.
    pub fn act_on(&mut self, isa: Isa, states: &[BodyState], forces: &mut [[V3; 2]]) {
        self.transfer_of(isa, states, |i| forces[i]);
        for (k, i) in self.bodies.iter().enumerate() {
            let more = self.outwards(k);
            forces[*i] = [0, 1].map(|c| math::add(forces[*i][c], more[c]));
        }
    }

    fn transfer_of(&mut self, isa: Isa, states: &[BodyState], of: impl Fn(usize) -> [V3; 2]) {
        self.turn(states);
        for (k, i) in self.bodies.iter().enumerate() {
            let [x, y, z] = self.turned[k];
            let ([force, torque], skew) = (of(*i), self.skew[k]);
            let about_z = math::dot(torque, z);
            self.own[3 * k] = math::dot(force, z);
            self.own[3 * k + 1] = math::dot(torque, x) + skew[0] * about_z;
            self.own[3 * k + 2] = math::dot(torque, y) + skew[1] * about_z;
        }
        product(isa, &self.transfer, self.own.as_slice(), self.more.as_mut_slice());
    }

    /// Finds the axes of all bodies.
    fn turn(&mut self, states: &[BodyState]) {
        for ((turned, axes), i) in self.turned.iter_mut().zip(&self.axes).zip(&self.bodies) {
            *turned = math::transpose(&math::matmul(&states[*i].r, axes));
        }
    }

    /// Cosine of the lean of a body.
    fn upright(&self, k: usize, body: &BodyState) -> f64 {
        (0..3).map(|j| body.r[2][j] * self.axes[k][j][2]).sum()
    }

    /// What was found for a body, as force and torque or momentum and angular momentum.
    fn outwards(&self, k: usize) -> [V3; 2] {
        let [x, y, z] = self.turned[k];
        let more = [0, 1, 2].map(|j| self.more[3 * k + j]);
        [math::scale(more[0], z), math::axpy(math::scale(more[1], x), more[2], y)]
    }

    /// What velocities and angular velocities add to the kinetic energy \[J\].
    pub fn energy_j(&mut self, states: &[BodyState], velocity: impl Fn(usize) -> [V3; 2]) -> f64 {
        self.read(states, velocity);
        0.5 * self.own.dot(&(&self.added * &self.own))
    }

    fn read(&mut self, states: &[BodyState], velocity: impl Fn(usize) -> [V3; 2]) {
        self.turn(states);
        for (k, i) in self.bodies.iter().enumerate() {
            let [x, y, z] = self.turned[k];
            let [v, w] = velocity(*i);
            self.own[3 * k] = math::dot(v, z);
            self.own[3 * k + 1] = math::dot(w, x);
            self.own[3 * k + 2] = math::dot(w, y);
        }
    }

    /// Whether the matrices hold no longer: a body has turned, sleeps or is gone, or a beam folds.
    pub fn is_over(&self, states: &[BodyState], data: &[BodyData], joints: &[JointData]) -> bool {
        let folds = |j: &usize| {
            let ends = joints[*j].beam.as_ref().map(|b| &b.ends.ends);
            ends.is_some_and(|ends| ends.iter().any(|e| e.plastic_rad.abs() > FOLDED_RAD))
        };
        let left = |(k, i): (usize, &usize)| {
            !data[*i].alive || data[*i].asleep || self.upright(k, &states[*i]) < UPRIGHT
        };
        self.inside.iter().any(folds) || self.bodies.iter().enumerate().any(left)
    }

    /// Whether it holds both bodies of a joint.
    pub fn joins(&self, [a, b]: [usize; 2]) -> bool {
        self.bodies.contains(&a) && self.bodies.contains(&b)
    }

    /// Whether contacts changed the velocity of a body: they act on its own inertia.
    pub fn is_touched(&self, states: &[BodyState], before: &[BodyState]) -> bool {
        self.bodies.iter().any(|i| states[*i].v != before[*i].v || states[*i].w != before[*i].w)
    }

    /// Lets the bodies go on alone, from their velocities. What moves as one rigid body keeps its velocity, the rest keeps its momentum: so the momenta of all together stay as they are.
    pub fn let_go(&mut self, states: &mut [BodyState], velocity: impl Fn(usize) -> [V3; 2]) {
        self.read(states, velocity);
        let along = self.momenta.tr_mul(&self.own);
        let rigid = self.inverse * Vector3::new(along[0], along[1], along[2]);
        let rigid = DVector::from_column_slice(rigid.as_slice());
        self.own.gemv(-1.0, &self.rigid, &rigid, 1.0);
        self.more.rows_mut(0, self.own.len()).gemv(1.0, &self.added, &self.own, 0.0);
        for (k, i) in self.bodies.iter().enumerate() {
            let [p, l] = self.outwards(k);
            let body = &mut states[*i];
            body.p = math::add(body.p, p);
            body.l = math::add(body.l, l);
        }
    }
}

impl SharedMass {
    /// The whole matrix, with three rows a body.
    pub fn matrix(&self) -> DMatrix<f64> {
        let n = 3 * self.bodies.len();
        let mut matrix = DMatrix::zeros(n, n);
        for block in &self.blocks {
            let [p, q] = block.pair;
            for (i, row) in block.added.iter().enumerate() {
                for (j, value) in row.iter().enumerate() {
                    matrix[(3 * p + i, 3 * q + j)] = *value;
                    matrix[(3 * q + j, 3 * p + i)] = *value;
                }
            }
        }
        matrix
    }
}

/// The columns of a matrix, filled up to whole [`LANES`].
fn in_lanes(matrix: DMatrix<f64>) -> Vec<f64> {
    let rows = matrix.nrows().next_multiple_of(LANES);
    matrix.resize_vertically(rows, 0.0).data.into()
}

for_each_isa! {
    /// `y = A x`, with the columns of `A` one after the other, whole [`LANES`] long.
    fn product = product_any(a: &[f64], x: &[f64], y: &mut [f64])
}

/// Columns that are added up before `y` is written.
const AT_ONCE: usize = 4;

#[inline(always)]
fn product_any(a: &[f64], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for (columns, x) in a.chunks(AT_ONCE * y.len()).zip(x.chunks(AT_ONCE)) {
        for (r, y) in y.chunks_exact_mut(LANES).enumerate() {
            for (column, x) in columns.chunks_exact(columns.len() / x.len()).zip(x) {
                let column = &column[LANES * r..LANES * (r + 1)];
                for l in 0..LANES {
                    y[l] += column[l] * x;
                }
            }
        }
    }
}

/// Velocities of bodies, by their centres of mass, that move as one: along z, and about x and y through the origin.
pub(super) fn as_one(centres_m: &[V3]) -> DMatrix<f64> {
    DMatrix::from_fn(3 * centres_m.len(), 3, |row, motion| {
        let [x, y, _] = centres_m[row / 3];
        [[1.0, y, -x], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]][row % 3][motion]
    })
}

/// Adds the inertia that goes with the stiffness of springs between the bodies, and of those that turn them.
fn add_springs(added: &mut DMatrix<f64>, places: &BTreeMap<usize, usize>, start: &Start) {
    for row in start.rows {
        let ends = [(row.a, row.turn_a, -1.0), (row.b, row.turn_b, 1.0)];
        let rows = ends.map(|(i, ..)| places.get(&i).copied());
        let is_inside = rows.iter().all(Option::is_some);
        if !is_inside && row.force[2].abs() > LEVEL {
            continue;
        }
        let of = |(k, (_, turn, sign)): (Option<usize>, (usize, V3, f64))| {
            let along = if is_inside { row.force[2] } else { 0.0 };
            k.map(|k| [(3 * k, sign * along), (3 * k + 1, sign * turn[0]), (3 * k + 2, sign * turn[1])])
        };
        let stretch: Vec<(usize, f64)> = rows.into_iter().zip(ends).filter_map(of).flatten().collect();
        let inertia = row.stiffness / start.highest_rad_s.powi(2);
        for (i, u) in &stretch {
            for (j, v) in &stretch {
                added[(*i, *j)] += inertia * u * v;
            }
        }
    }
}
