//! The motion of one rigid set: six degrees of freedom from nodal masses, exact momenta, an exact rotation.
//!
//! The time stepping is that of the nodes (leapfrog), so that a set and the elements around it keep the same discrete laws. The state is
//! the momentum `P` and the angular momentum `L` about the centre, both at the half step. A step kicks them with the force and the moment of
//! the present positions, `r_n` being the nodes from the centre, and turns the set by the Cayley map of `Δt ω`:
//!
//! `r_{n+1} - r_n = Δt ω × r̄`, `r̄ = (r_n + r_{n+1}) / 2 = (1 - Δt/2 ω×)⁻¹ r_n`
//!
//! That is an exact rotation, by `2 atan(Δt |ω| / 2)` (Simo and Wong, Int. J. Numer. Meth. Engng 31 (1991) 19-52). Nodes move with
//! `v = V + ω × r̄`, so `x_{n+1} = x_n + Δt v` holds for them as for any node. As `Σ m r̄ = 0` their momentum is `P`; with `Ī`, the
//! inertia of the `r̄`, their angular momentum `Σ m r_n × v = Σ m r_{n+1} × v = Ī ω` is `L` if ω solves `Ī(ω) ω = L`, which is done by iteration to
//! round-off. Nothing else is needed to keep both momenta: neither at the step nor when nodes come and go.

use crate::base::isa::for_each_isa;
use crate::base::vector::{V3, add, cross, scale};
use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

/// Iterations for the angular velocity at most; each gains a factor `Δt |ω|`.
const ITERATIONS: usize = 30;

/// Velocity of the centre and angular velocity at the half step, with what takes body coordinates to nodal velocities.
#[derive(Debug, Clone, Copy)]
pub struct Twist {
    /// Velocity of the centre \[m/s\].
    pub velocity: V3,
    /// Angular velocity \[1/s\].
    pub spin: V3,
    /// `ω× (1 ∓ Δt/2 ω×)⁻¹ R`: velocity against the centre from the place in the body.
    gradient: Matrix3<f64>,
}

impl Twist {
    /// From places in body coordinates to velocities.
    pub(super) fn map(&self) -> Map {
        map_of(self.velocity, &self.gradient)
    }

    /// Velocity of a place in body coordinates \[m/s\].
    #[inline]
    pub fn at(&self, place: &V3) -> V3 {
        add(self.velocity, times(&self.gradient, place))
    }
}

/// A vector and the columns of a matrix: `c + M r` for places `r` in the body. A fourth number, zero, fills a vector of the processor.
pub(super) type Map = [[f64; 4]; 4];

fn map_of(c: V3, m: &Matrix3<f64>) -> Map {
    let column = |j: usize| [m[(0, j)], m[(1, j)], m[(2, j)], 0.0];
    [[c[0], c[1], c[2], 0.0], column(0), column(1), column(2)]
}

for_each_isa! {
    /// Velocities and positions of nodes from two maps of their places; the squares of the largest speeds, and of those against a reference velocity.
    pub(super) fn carry = carry_any(
        nodes: (&[u32], &[V3]),
        maps: &[Map; 2],
        reference_m_s: &V3,
        moved: (&mut [V3], &mut [V3]),
    ) -> [f64; 2]
}

#[inline(always)]
fn carry_any(
    (nodes, places): (&[u32], &[V3]),
    maps: &[Map; 2],
    reference_m_s: &V3,
    (v, x): (&mut [V3], &mut [V3]),
) -> [f64; 2] {
    let reference = [reference_m_s[0], reference_m_s[1], reference_m_s[2], 0.0];
    let (mut largest, mut against) = (0.0_f64, 0.0_f64);
    for (n, place) in nodes.iter().zip(places) {
        let (new, at) = (mapped(&maps[0], place), mapped(&maps[1], place));
        let (mut own, mut off) = ([0.0; 4], [0.0; 4]);
        // closures would not be compiled for the instruction set
        for i in 0..4 {
            own[i] = new[i] * new[i];
            off[i] = new[i] - reference[i];
            off[i] *= off[i];
        }
        let (own, off) = (own[0] + own[1] + own[2], off[0] + off[1] + off[2]);
        largest = if own > largest { own } else { largest };
        against = if off > against { off } else { against };
        v[*n as usize] = [new[0], new[1], new[2]];
        x[*n as usize] = [at[0], at[1], at[2]];
    }
    [largest, against]
}

#[inline(always)]
fn mapped(map: &Map, r: &V3) -> [f64; 4] {
    let mut out = [0.0; 4];
    for i in 0..4 {
        out[i] = map[0][i] + (map[1][i] * r[0] + map[2][i] * r[1] + map[3][i] * r[2]);
    }
    out
}

/// Place, turn and momenta of a rigid set.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Motion {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Centre of mass \[m\].
    pub centre_m: V3,
    /// From body to space, `w, x, y, z`.
    turn: [f64; 4],
    /// Momentum at the half step \[kg m/s\].
    pub momentum: V3,
    /// Angular momentum about the centre at the half step \[kg m²/s\].
    pub spin_momentum: V3,
    /// `Σ m r rᵀ` in body coordinates: xx, yy, zz, xy, yz, zx \[kg m²\].
    spread: [f64; 6],
}

/// The product with a vector.
#[inline]
fn times(m: &Matrix3<f64>, r: &V3) -> V3 {
    std::array::from_fn(|i| m[(i, 0)] * r[0] + m[(i, 1)] * r[1] + m[(i, 2)] * r[2])
}

impl Motion {
    /// The motion with the momenta of the nodes given as mass \[kg\], position \[m\] and velocity \[m/s\]; `places` gets their body
    /// coordinates, which are from the centre and along the axes of space now.
    pub fn of(nodes: impl Iterator<Item = (f64, V3, V3)> + Clone, places: &mut Vec<V3>) -> Self {
        let (mut mass_kg, mut sum, mut momentum) = (0.0, [0.0; 3], [0.0; 3]);
        for (m, x, v) in nodes.clone() {
            mass_kg += m;
            sum = add(sum, scale(m, x));
            momentum = add(momentum, scale(m, v));
        }
        let centre_m = scale(1.0 / mass_kg, sum);
        let (mut spin_momentum, mut spread) = ([0.0; 3], [0.0; 6]);
        places.clear();
        for (m, x, v) in nodes {
            let r: V3 = std::array::from_fn(|i| x[i] - centre_m[i]);
            spin_momentum = add(spin_momentum, scale(m, cross(r, v)));
            for i in 0..3 {
                spread[i] += m * r[i] * r[i];
                spread[i + 3] += m * r[i] * r[(i + 1) % 3];
            }
            places.push(r);
        }
        Self { mass_kg, centre_m, turn: [1.0, 0.0, 0.0, 0.0], momentum, spin_momentum, spread }
    }

    fn quaternion(&self) -> Quaternion<f64> {
        let [w, x, y, z] = self.turn;
        Quaternion::new(w, x, y, z)
    }

    /// Rotation from body to space.
    pub fn rotation(&self) -> Matrix3<f64> {
        UnitQuaternion::new_unchecked(self.quaternion()).to_rotation_matrix().into_inner()
    }

    /// `Σ m r rᵀ` along the axes of space, given [`Self::rotation`].
    fn spread_in_space(&self, turn: &Matrix3<f64>) -> Matrix3<f64> {
        let [xx, yy, zz, xy, yz, zx] = self.spread;
        turn * Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz) * turn.transpose()
    }

    /// The velocities that have the momenta, for the step of `dt_s` that begins at the present place, or that ended there (negative).
    pub fn twist(&self, dt_s: f64) -> Twist {
        let turn = self.rotation();
        let here = self.spread_in_space(&turn);
        let momentum = Vector3::from(self.spin_momentum);
        let mut spin = Vector3::zeros();
        let mut half = Matrix3::identity();
        for _ in 0..ITERATIONS {
            half = half_way(0.5 * dt_s * spin);
            let spread = half * here * half.transpose();
            let inertia = Matrix3::identity() * spread.trace() - spread;
            let next = inertia.try_inverse().map_or(Vector3::zeros(), |inverse| inverse * momentum);
            let change = (next - spin).norm();
            spin = next;
            if change.is_nan() || change <= 1e-16 * spin.norm() {
                break;
            }
        }
        let gradient = spin.cross_matrix() * half * turn;
        Twist { velocity: scale(1.0 / self.mass_kg, self.momentum), spin: spin.into(), gradient }
    }

    /// Adds an impulse \[N s\] and its moment about the centre \[N m s\].
    pub fn kick(&mut self, impulse: V3, moment: V3) {
        self.momentum = add(self.momentum, impulse);
        self.spin_momentum = add(self.spin_momentum, moment);
    }

    /// Moves the set by a step with its velocities.
    pub fn drift(&mut self, twist: &Twist, dt_s: f64) {
        self.centre_m = add(self.centre_m, scale(dt_s, twist.velocity));
        let [x, y, z] = scale(0.5 * dt_s, twist.spin);
        let turned = (Quaternion::new(1.0, x, y, z) * self.quaternion()).normalize();
        self.turn = [turned.w, turned.i, turned.j, turned.k];
    }

    /// Position of a place in body coordinates \[m\], given [`Self::rotation`].
    #[inline]
    pub fn position(&self, rotation: &Matrix3<f64>, place: &V3) -> V3 {
        add(self.centre_m, times(rotation, place))
    }

    /// From places in body coordinates to positions.
    pub(super) fn map(&self) -> Map {
        map_of(self.centre_m, &self.rotation())
    }

    /// The acceleration of a place in body coordinates \[m/s²\] under a force \[N\] and a moment about the centre \[N m\].
    pub fn accelerations(&self, force: V3, moment: V3) -> impl Fn(&V3) -> V3 + use<> {
        let turn = self.rotation();
        let here = self.spread_in_space(&turn);
        let inertia = Matrix3::identity() * here.trace() - here;
        let inverse = inertia.try_inverse().unwrap_or_else(Matrix3::zeros);
        let spin = inverse * Vector3::from(self.spin_momentum);
        let turning = inverse * (Vector3::from(moment) - spin.cross(&Vector3::from(self.spin_momentum)));
        let centre = scale(1.0 / self.mass_kg, force);
        move |place| {
            let r = turn * Vector3::from(*place);
            let a = turning.cross(&r) + spin.cross(&spin.cross(&r));
            add(centre, a.into())
        }
    }
}

/// `(1 - s×)⁻¹ = (1 + s× + s sᵀ) / (1 + s·s)`.
fn half_way(s: Vector3<f64>) -> Matrix3<f64> {
    (Matrix3::identity() + s.cross_matrix() + s * s.transpose()) / (1.0 + s.norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A brick of eight unequal masses that tumbles about its middle axis, unstable by Euler's equations.
    fn tumbling() -> (Vec<f64>, Vec<V3>, Vec<V3>) {
        let spin = [0.05, 7.0, 0.02];
        let at = |i: usize| [0.3 * (i & 1) as f64, 0.5 * (i >> 1 & 1) as f64, 1.1 * (i >> 2) as f64];
        let x: Vec<V3> = (0..8).map(at).collect();
        let v = x.iter().map(|x| add([2.0, -1.0, 3.0], cross(spin, *x))).collect();
        ((0..8).map(|i| 20.0 + i as f64).collect(), x, v)
    }

    fn momenta(m: &[f64], x: &[V3], v: &[V3]) -> (V3, V3) {
        let (mut p, mut l) = ([0.0; 3], [0.0; 3]);
        for i in 0..m.len() {
            p = add(p, scale(m[i], v[i]));
            l = add(l, scale(m[i], cross(x[i], v[i])));
        }
        (p, l)
    }

    #[test]
    fn free_flight_keeps_momenta_of_the_nodes_shape_and_energy() {
        let (m, mut x, mut v) = tumbling();
        let before = momenta(&m, &x, &v);
        let all = |x: &[V3], v: &[V3]| (0..8).map(|i| (m[i], x[i], v[i])).collect::<Vec<_>>();
        let mut places = Vec::new();
        let mut motion = Motion::of(all(&x, &v).into_iter(), &mut places);
        let energy =
            |v: &[V3]| (0..8).map(|i| 0.5 * m[i] * crate::base::vector::dot(v[i], v[i])).sum::<f64>();
        let first = energy(&v);
        for _ in 0..20_000 {
            let twist = motion.twist(2e-4);
            motion.drift(&twist, 2e-4);
            let turn = motion.rotation();
            for i in 0..8 {
                let old = x[i];
                v[i] = twist.at(&places[i]);
                x[i] = motion.position(&turn, &places[i]);
                let way: V3 = std::array::from_fn(|k| x[i][k] - old[k] - 2e-4 * v[i][k]);
                assert!(way.iter().all(|w| w.abs() < 1e-13), "{way:?}");
            }
        }
        let after = momenta(&m, &x, &v);
        for i in 0..3 {
            assert!((after.0[i] - before.0[i]).abs() < 1e-12 * 800.0, "{before:?} {after:?}");
            assert!((after.1[i] - before.1[i]).abs() < 1e-12 * 1e4, "{before:?} {after:?}");
        }
        assert!((energy(&v) / first - 1.0).abs() < 1e-5, "{}", energy(&v) / first);
        let length = |i: usize, j: usize| (0..3).map(|k| (x[i][k] - x[j][k]).powi(2)).sum::<f64>().sqrt();
        assert!((length(0, 4) - 1.1).abs() < 1e-13);
    }
}
