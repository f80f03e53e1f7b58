//! By how much what latent bushings bear can have changed since they were looked at last.
//!
//! The share of its resistance that a bushing bears is a norm of its six forces, in which the moments count over the capacity under the axial force; the forces are linear in the loads of the pieces. So
//! a change of the loads by `ΔL_c` changes the share by at most `A = Σ w_c |ΔL_c|`, where `w_c` is the share that a unit of the load takes ([`Bound::weights`], set up once), for capacities that do not
//! depend on the axial force. That changes by at most `A n` (`n`: [`Scale::axial_n`], axial forces weigh at least `1/n`), so that while `A <= A₀` the capacities `C` are at least `C(N₀) - κ A₀ n` (`κ`: their
//! steepest slope), `N₀` being the axial force at the last look. With `s` the reference capacity, `q` the slope `κ n`, both over this bound, the share is at most
//!
//! ```text
//! share <= share₀ (1 + q A) + max(s, 1) A
//! ```
//!
//! A bushing need not be looked at while this is below one, and below the largest share so far: nothing can part, and the largest share stays what it is ([`Bound::allows`]).
//!
//! **Loads in numbers that joints know anyway.** Forces `l` and moments `m` along the axes of a joint, its rotation `θ` and what is plastic of its gap are those of its last evaluation. On its second body they act along axes that
//! are fixed there, on the first one along `R` of them; the moment is `T⁻¹ m`, on the first body `T⁻ᵀ m` ([`crate::mbs::joint`]). For angles up to [`LARGEST_RAD`], `|R - 1| <= |θ|`, `|R - R₀| <= |θ - θ₀|`,
//! `|T⁻¹ - 1| <= 0.7 |θ|` and `|T⁻¹ - T₀⁻¹| <= |θ - θ₀|`, with which
//!
//! ```text
//! |ΔF - Δl| <= |θ| |Δl| + |Δθ| |l₀|   on the first body, none on the second
//! |ΔM - Δm| <= 0.7 |θ| |Δm| + |Δθ| |m₀|, on the second body |Δg| |l| + |g₀| |Δl| more: the force acts at the point of the first one, a gap g away
//! ```
//!
//! The couple of a beam's axial force ([`crate::mbs::stance`]) adds to the moment as it is, on the first body along `R` of the axes like a force.
//!
//! These remainders have no known direction and weigh what the worst direction does. Lengths of vectors are bounded by the sums of their components, which needs no roots.

use super::demand::{Demand, products};
use crate::curve::CapacityTable;
use crate::mbs::joint::{JointData, Latest};
use crate::mbs::math::{self, M3, V3};
use crate::mbs::system::System;

/// Change of the share up to which the bound holds: a larger one means a look.
const FURTHEST: f64 = 0.1;
/// Angle of a joint up to which the bounds of its rotation hold, as a sum over components \[rad\].
const LARGEST_RAD: f64 = 2.0;
/// What round-off may add to a share: forces are sums of some dozens of products with relative errors of 1e-16 each, of terms up to 1e4 times as large as the sum.
const ROUND_OFF: f64 = 1e-9;
/// Load figures of a joint: six components and the remainders of force and moment.
const OF_JOINT: usize = 8;
/// Load figures of the contacts of a piece: force and moment.
const OF_PIECE: usize = 6;

/// A joint that is attached to a body of pieces.
#[derive(Debug, Clone, Copy)]
pub(super) struct Attached {
    /// Which joint of the running model.
    pub joint: usize,
    /// Whether the body is its second one.
    pub is_second: bool,
    /// The piece.
    pub piece: usize,
}

/// What resists in a bushing.
#[derive(Debug, Clone)]
struct Scale {
    /// Axial force that changes the share by at most one \[N\].
    axial_n: f64,
    /// Of each bending axis with a curve: its table, capacity without axial force \[N m\] and steepest slope \[m\].
    bending: [Option<(usize, f64, f64)>; 2],
}

/// The bound of a body of pieces.
#[derive(Debug, Clone)]
pub(super) struct Bound {
    scales: Vec<Scale>,
    /// Of each bushing what a unit of each load figure takes of it.
    weights: Vec<Vec<f64>>,
    /// Of each bushing by how much its share may change before it is looked at.
    room: Vec<f64>,
    /// The loads at the last look; none: there was none.
    seen: Option<Seen>,
    /// Load figures: by how much they have changed.
    change: Vec<f64>,
}

#[derive(Debug, Clone, Default)]
struct Seen {
    joints: Vec<Latest>,
    contact: Vec<[V3; 2]>,
    products: [f64; 6],
}

impl Bound {
    /// For a body with its demand, the joints attached to it in the running system, and its latent bushings among the joints of the model with nothing latent.
    pub fn new(
        system: &System,
        demand: &Demand,
        attached: &[Attached],
        (whole, bushings): (&System, &[usize]),
    ) -> Self {
        let scales: Vec<Scale> =
            bushings.iter().map(|b| Scale::of(&whole.joints[*b], &whole.tables)).collect();
        let of = |(l, b): (usize, &usize)| {
            let share = |force: V3, moment: V3| scales[l].share(&whole.joints[*b], force, moment);
            let unit = |piece: usize, force: V3, moment: V3| {
                let [force, moment] = demand.of_load(l, piece, [force, moment]);
                share(force, moment)
            };
            let mut list = Vec::new();
            for a in attached {
                let joint = &system.joints[a.joint];
                let side = usize::from(a.is_second);
                let (axes, point): (M3, V3) =
                    (math::transpose(&math::qmat(joint.frames[side])), joint.points[side]);
                let force = axes.map(|axis| unit(a.piece, axis, math::cross(point, axis)));
                let moment = axes.map(|axis| unit(a.piece, [0.0; 3], axis));
                list.extend(force);
                list.extend(moment);
                list.extend([math::norm(force), math::norm(moment)]);
            }
            for piece in 0..demand.count() {
                let axes = [0, 1, 2].map(|k| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }));
                list.extend(axes.map(|axis| unit(piece, axis, [0.0; 3])));
                list.extend(axes.map(|axis| unit(piece, [0.0; 3], axis)));
            }
            list.extend((0..6).map(|k| {
                let [force, moment] = demand.of_rotation(l, k);
                share(force, moment)
            }));
            list
        };
        let weights: Vec<Vec<f64>> = bushings.iter().enumerate().map(of).collect();
        Self { room: vec![0.0; bushings.len()], weights, scales, seen: None, change: Vec::new() }
    }

    /// Takes in what a look found of a bushing of the body: its axial force (compression positive) \[N\] and the share of its resistance; `most` is the share that it must not exceed unseen.
    pub fn note(&mut self, l: usize, axial_n: f64, share: f64, most: f64, tables: &[CapacityTable]) {
        let scale = &self.scales[l];
        let (mut ease, mut slope) = (1.0_f64, 0.0_f64);
        for (table, reference_nm, steepest_m) in scale.bending.iter().flatten() {
            let now = tables[*table].capacity(0.0, axial_n, &mut Default::default()).moment_nm;
            let fall = if *steepest_m > 0.0 { steepest_m * scale.axial_n } else { 0.0 };
            let least = now - FURTHEST * fall;
            if least <= 0.0 {
                self.room[l] = 0.0;
                return;
            }
            (ease, slope) = (ease.max(reference_nm / least), slope.max(fall / least));
        }
        self.room[l] = ((most.min(1.0) - share - ROUND_OFF) / (slope * share + ease)).min(FURTHEST);
    }

    /// Keeps the loads of a look.
    pub fn keep(&mut self, system: &System, attached: &[Attached], contact: &[[V3; 2]], spin: V3) {
        let seen = self.seen.get_or_insert_default();
        seen.joints.clear();
        seen.joints.extend(attached.iter().map(|a| latest(&system.joints[a.joint])));
        seen.contact.clear();
        seen.contact.extend_from_slice(contact);
        seen.products = products(spin);
    }

    /// Whether the bushings of which `is_asked` holds need not be looked at under these loads.
    pub fn allows(
        &mut self,
        system: &System,
        attached: &[Attached],
        (contact, spin): (&[[V3; 2]], V3),
        is_asked: impl Fn(usize) -> bool,
    ) -> bool {
        let Some(seen) = &self.seen else { return false };
        // the first one without room settles it
        if !(0..self.room.len()).all(|l| !is_asked(l) || self.room[l] > 0.0) {
            return false;
        }
        let change = &mut self.change;
        change.clear();
        for (a, before) in attached.iter().zip(&seen.joints) {
            let joint = &system.joints[a.joint];
            let Some(figures) = changes(before, joint, a.is_second) else { return false };
            change.extend_from_slice(&figures);
        }
        for (now, before) in contact.iter().zip(&seen.contact) {
            let figure = |i: usize| (now[i / 3][i % 3] - before[i / 3][i % 3]).abs();
            change.extend_from_slice(&std::array::from_fn::<f64, OF_PIECE, _>(figure));
        }
        let turned = products(spin);
        change.extend_from_slice(&std::array::from_fn::<f64, 6, _>(|k| (turned[k] - seen.products[k]).abs()));
        let used = |l: usize| self.weights[l].iter().zip(&self.change).map(|(w, c)| w * c).sum::<f64>();
        (0..self.room.len()).all(|l| !is_asked(l) || used(l) <= self.room[l])
    }
}

impl Scale {
    fn of(joint: &JointData, tables: &[CapacityTable]) -> Self {
        let bending = [0, 1].map(|k| {
            let table = joint.table_of(k)?;
            let capacity = tables[table].capacity(0.0, 0.0, &mut Default::default()).moment_nm;
            Some((table, capacity, tables[table].steepest_m()))
        });
        let bears = joint.compressive_capacity.min(joint.tensile_capacity);
        // of a section that bears any axial force the moments alone tell how much one changes
        let of_moments = bending.iter().flatten().map(|(_, capacity, slope)| capacity / slope);
        let axial_n = if bears.is_finite() { bears } else { of_moments.fold(f64::INFINITY, f64::min) };
        Self { axial_n, bending }
    }

    /// Share that a force and a moment along the axes of the bushing take of its resistance, with the capacities that it has without axial force; what an axial force takes counts for either sense.
    fn share(&self, joint: &JointData, force: V3, moment: V3) -> f64 {
        let mut bending = 0.0;
        for (k, own) in self.bending.iter().enumerate() {
            if let Some((_, capacity, _)) = own {
                bending += (moment[k + 1] / capacity).powi(2);
            }
        }
        let shear = joint.shear_used2(force).sqrt();
        bending.sqrt().max(shear).max(force[0].abs() / self.axial_n)
    }
}

/// What a joint knows of its last evaluation; nothing is borne by one that has separated.
fn latest(joint: &JointData) -> Latest {
    let now = joint.latest();
    if joint.alive { now } else { Latest { local: [0.0; 3], moment: [0.0; 3], couple: [0.0; 3], ..now } }
}

/// Changes of the load figures of a joint; none if it has turned too far.
#[inline]
fn changes(before: &Latest, joint: &JointData, is_second: bool) -> Option<[f64; OF_JOINT]> {
    let mut now = latest(joint);
    if !joint.alive {
        (now.theta, now.gap) = (before.theta, before.gap);
    }
    let off = |a: &V3, b: &V3| math::sub(*a, *b).map(f64::abs);
    let sum = |v: &V3| v[0].abs() + v[1].abs() + v[2].abs();
    let (force, moment) = (off(&now.local, &before.local), off(&now.moment, &before.moment));
    let couple = off(&now.couple, &before.couple);
    let (angle, turned) = (sum(&now.theta), sum(&off(&now.theta, &before.theta)));
    if !(angle <= LARGEST_RAD && sum(&before.theta) <= LARGEST_RAD) {
        return None;
    }
    let (of_force, of_moment) = (sum(&force), 0.7 * angle * sum(&moment) + turned * sum(&before.moment));
    let [free, turn] = if is_second {
        let of_gap = sum(&off(&now.gap, &before.gap)) * sum(&now.local) + sum(&before.gap) * of_force;
        [0.0, of_moment + of_gap]
    } else {
        let of_couple = angle * sum(&couple) + turned * sum(&before.couple);
        [angle * of_force + turned * sum(&before.local), of_moment + of_couple]
    };
    let moment = math::add(moment, couple);
    Some([force[0], force[1], force[2], moment[0], moment[1], moment[2], free, turn])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `T⁻ᵀ` of a rotation vector, `R` of it, and `T⁻¹`.
    fn maps(theta: V3) -> [M3; 3] {
        let q = math::qexp(theta);
        let factor = math::qlog_factor(q);
        let c = math::tangent_coefficient(math::dot(theta, theta), factor, q[0]);
        let along = |sense: f64| {
            let column = |k: usize| {
                let unit: V3 = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
                let once = math::cross(theta, unit);
                math::axpy(math::axpy(unit, sense * 0.5, once), c, math::cross(theta, once))
            };
            math::transpose(&[column(0), column(1), column(2)])
        };
        [along(1.0), math::qmat(q), along(-1.0)]
    }

    /// Largest stretch of a matrix, from below: over many directions.
    fn stretch(m: &M3) -> f64 {
        let mut most = 0.0_f64;
        for i in 0..40 {
            let (s, c) = (0.16 * f64::from(i)).sin_cos();
            for j in 0..40 {
                let (t, d) = (0.08 * f64::from(j)).sin_cos();
                most = most.max(math::norm(math::mul(m, [t * c, t * s, d])));
            }
        }
        most
    }

    #[test]
    fn rotations_of_joints_change_their_loads_by_no_more_than_the_bound_says() {
        let minus = |a: &M3, b: &M3| -> M3 { std::array::from_fn(|i| math::sub(a[i], b[i])) };
        let identity = math::qmat([1.0, 0.0, 0.0, 0.0]);
        let at = |k: usize, length: f64| -> V3 {
            let f = k as f64;
            let v = [(1.3 * f).sin(), (2.1 * f + 0.4).cos(), (0.7 * f + 1.0).sin()];
            math::scale(length / math::norm(v), v)
        };
        let angles = [1e-3, 0.3, 0.9, 1.5, LARGEST_RAD];
        for k in 0..8 {
            for angle in angles {
                let theta = at(k, angle);
                let [transposed, turn, inverse] = maps(theta);
                // on the first body the moment is turned: T⁻ᵀ = R T⁻¹
                let back = math::matmul(&math::transpose(&turn), &transposed);
                assert!(stretch(&minus(&back, &inverse)) < 1e-12);
                assert!(stretch(&minus(&turn, &identity)) <= angle + 1e-12);
                for map in [&transposed, &inverse] {
                    assert!(stretch(&minus(map, &identity)) <= 0.7 * angle + 1e-12);
                }
                for (l, other) in angles.into_iter().enumerate() {
                    let before = at(k + l, other);
                    let [t0, r0, i0] = maps(before);
                    let off = math::norm(math::sub(theta, before)) + 1e-12;
                    for (now, then) in [(&transposed, &t0), (&turn, &r0), (&inverse, &i0)] {
                        assert!(stretch(&minus(now, then)) <= off, "{theta:?} {before:?}");
                    }
                }
            }
        }
    }
}
