//! The impulse of a single contact point by Coulomb's law, found at once.
//!
//! Sweeps that correct the normal impulse and the tangential one in turn do not settle where an impulse across the normal moves the point along it by more than the normal one does, `μ |K_nt| > K_nn`: rods and
//! mechanisms that lean into their motion. With one point the law has few solutions, which are tried in turn: it sticks, or slips in the direction in which it goes on slipping (Moreau, in: Nonsmooth Mechanics and Applications, CISM 302, 1988).

use crate::mbs::math::{self, M3, V3};
use std::f64::consts::{PI, TAU};

/// Tangential inverse mass, over the larger one of the two, below which joints hold the point in that direction: what is left of it is round-off.
const HELD: f64 = 1e-6;
/// Impulse along the normal, over that without friction, above which friction and joints hold each other up: that is a jam.
const MOST: f64 = 10.0;
/// Smallest eigenvalue of the inverse mass, over the largest one, from which a point that sticks is no jam, whatever its impulse; and the largest difference of its terms across
/// the diagonal, over the smallest one, for the impulse takes energy then: `-(u - free) · K⁻¹ (u - free) / 2` if it is stopped.
const SOUND: [f64; 2] = [1e-3, 0.1];
/// Directions of slip between which a root is looked for, and halvings until it holds.
const DIRECTIONS: usize = 72;
const HALVINGS: usize = 60;

/// A point: `u = free + K p`, along the normal and two directions across it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Single {
    /// What unit impulses along these directions add to its velocity \[1/kg\], by columns.
    pub k: M3,
    /// Its velocity without an impulse \[m/s\].
    pub free: V3,
    /// Velocity along the normal that it has at least \[m/s\].
    pub target: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

impl Single {
    /// The impulse \[N s\]; none if the law has no solution, or one that is a jam.
    pub fn impulse(&self) -> Option<V3> {
        if self.free[0] >= self.target {
            return Some([0.0; 3]);
        }
        let plane = self.plane();
        let stuck = plane.map_or_else(|| self.sticks(), |angle| self.sticks_in(angle));
        if let Some((p, true)) = stuck {
            return Some(p);
        }
        let slips = || match plane {
            Some(angle) => [angle, angle + PI].into_iter().find_map(|a| self.ahead(a)),
            None => self.slips(),
        };
        let alone = (self.target - self.free[0]) / self.k[0][0];
        stuck.map(|(p, _)| p).or_else(slips).filter(|p| p[0] <= MOST * alone)
    }

    /// The only tangential direction in which joints let the point move, if they hold it in the other one.
    fn plane(&self) -> Option<f64> {
        let [p, q, across] = [self.k[1][1], self.k[2][2], 0.5 * (self.k[1][2] + self.k[2][1])];
        let (mean, off) = (0.5 * (p + q), libm::hypot(0.5 * (p - q), across));
        (mean - off < HELD * (mean + off)).then(|| 0.5 * libm::atan2(across, 0.5 * (p - q)))
    }

    /// [`Self::sticks`] where it moves in one direction only.
    fn sticks_in(&self, angle: f64) -> Option<(V3, bool)> {
        let d = [0.0, libm::cos(angle), libm::sin(angle)];
        let (of_n, of_t) = (math::mul(&self.k, [1.0, 0.0, 0.0]), math::mul(&self.k, d));
        let [a, b, c, e] = [of_n[0], of_t[0], math::dot(d, of_n), math::dot(d, of_t)];
        let (n, t) = (self.target - self.free[0], -math::dot(d, self.free));
        let det = a * e - b * c;
        let [normal, across] = [(n * e - b * t) / det, (a * t - c * n) / det];
        let (mean, off) = (0.5 * (a + e), libm::hypot(0.5 * (a - e), 0.5 * (b + c)));
        (det > 0.0 && normal >= 0.0 && across.abs() <= self.friction * normal).then(|| {
            let p = math::axpy(math::scale(across, d), normal, [1.0, 0.0, 0.0]);
            (p, is_sound([mean - off, mean + off], (b - c).abs()))
        })
    }

    /// The impulse with which the point does not slip, if friction holds it; and whether that is no jam, whatever its size.
    fn sticks(&self) -> Option<(V3, bool)> {
        let wanted = math::sub([self.target, 0.0, 0.0], self.free);
        let p = math::mul(&math::inverse(&self.k), wanted);
        let across = libm::hypot(p[1], p[2]);
        (p[0] >= 0.0 && across <= self.friction * p[0]).then(|| {
            let even = |i: usize, j: usize| 0.5 * (self.k[i][j] + self.k[j][i]);
            let values = nalgebra::Matrix3::from_fn(even).symmetric_eigenvalues();
            let odd = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| (self.k[i][j] - self.k[j][i]).abs());
            (p, is_sound([values.min(), values.max()], odd.into_iter().fold(0.0, f64::max)))
        })
    }

    /// The impulse under friction against a direction of slip, and the velocity of slip that it leaves; none if the point is not held by one that pushes.
    fn against(&self, angle: f64) -> Option<(V3, [f64; 2])> {
        let d = [libm::cos(angle), libm::sin(angle)];
        let unit = [1.0, -self.friction * d[0], -self.friction * d[1]];
        let moved = math::mul(&self.k, unit);
        let normal = (self.target - self.free[0]) / moved[0];
        let u = math::axpy(self.free, normal, moved);
        (moved[0] > 0.0).then_some((math::scale(normal, unit), [u[1], u[2]]))
    }

    /// The impulse against a direction, if the point slips on in it.
    fn ahead(&self, angle: f64) -> Option<V3> {
        let (p, u) = self.against(angle)?;
        (libm::cos(angle) * u[0] + libm::sin(angle) * u[1] >= 0.0).then_some(p)
    }

    fn slips(&self) -> Option<V3> {
        let aside = |angle: f64| {
            let (_, u) = self.against(angle)?;
            Some(libm::cos(angle) * u[1] - libm::sin(angle) * u[0])
        };
        // half of a division off the axes, on which the roots of plane motions are
        let angle = |k: usize| TAU * (k as f64 + 0.5) / DIRECTIONS as f64;
        (0..DIRECTIONS).find_map(|k| {
            let (mut low, mut high) = (angle(k), angle(k + 1));
            let (first, last) = (aside(low)?, aside(high)?);
            if first == 0.0 && last == 0.0 || first * last > 0.0 {
                return None;
            }
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if aside(middle)? * first > 0.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            self.ahead(0.5 * (low + high))
        })
    }
}

/// Whether an inverse mass has these eigenvalues, smallest and largest, by what is moved and not by what joints leave of it.
fn is_sound([smallest, largest]: [f64; 2], odd: f64) -> bool {
    smallest >= SOUND[0] * largest && odd <= SOUND[1] * smallest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holds(single: &Single) -> V3 {
        let p = single.impulse().expect("a solution");
        let u = math::add(single.free, math::mul(&single.k, p));
        let across = p[1].hypot(p[2]);
        assert!((u[0] - single.target).abs() < 1e-9 && p[0] > 0.0, "{p:?} {u:?}");
        assert!(across <= single.friction * p[0] * (1.0 + 1e-12), "{p:?}");
        if u[1].hypot(u[2]) > 1e-9 {
            assert!(
                (across - single.friction * p[0]).abs() < 1e-9 * p[0],
                "slips with all friction: {p:?} {u:?}"
            );
            assert!(
                p[1] * u[1] + p[2] * u[2] < -0.999_999 * across * u[1].hypot(u[2]),
                "against it: {p:?} {u:?}"
            );
        }
        p
    }

    /// A rod of 2 kg and 1 m at 0.8 rad whose end strikes at 8 m/s across and 2 m/s along the normal, at `μ = 2`: `μ |K_nt| > K_nn`.
    #[test]
    fn a_rod_that_leans_into_its_motion() {
        let (mass, length, lean) = (2.0, 1.0_f64, 0.8_f64);
        let inertia = mass * length * length / 12.0;
        let [across, along] = [0.5 * length * lean.cos(), 0.5 * length * lean.sin()];
        let k = [
            [1.0 / mass + across * across / inertia, across * along / inertia, 0.0],
            [across * along / inertia, 1.0 / mass + along * along / inertia, 0.0],
            [0.0, 0.0, 1.0 / mass],
        ];
        assert!(2.0 * k[0][1] > k[0][0]);
        let p = holds(&Single { k, free: [-2.0, 8.0, 0.0], target: 0.0, friction: 2.0 });
        assert!(p[2].abs() < 1e-12, "{p:?}");
        holds(&Single { k, free: [-2.0, -8.0, 0.0], target: 1.0, friction: 0.3 });
        holds(&Single { k, free: [-2.0, 0.1, 0.3], target: 0.0, friction: 0.7 });
        holds(&Single { k, free: [-2.0, -3.0, 2.0], target: 0.0, friction: 0.5 });
    }

    /// A bar on a rail, another one on a line, `K` with eigenvalues 0.007, 1.7 and 4.0 1/kg: friction at `μ = 3` holds its point, with an impulse of 44 times that without friction, and with
    /// 46 times as it rebounds. Where joints hold it in a direction but for a ten thousandth, that is a jam.
    #[test]
    fn a_point_that_sticks_by_a_large_impulse() {
        let k = [[1.193, -0.151, -0.907], [-0.151, 3.755, 0.845], [-0.907, 0.845, 0.8434]];
        let of = |k: M3, target: f64| Single { k, free: [-0.18, 0.04, 0.043], target, friction: 3.0 };
        for (target, normal) in [(0.0, 6.583_192), (0.033, 8.217_173)] {
            let p = holds(&of(k, target));
            assert!((p[0] - normal).abs() < 1e-5, "{p:?}");
            let u = math::add([-0.18, 0.04, 0.043], math::mul(&k, p));
            assert!(u[1].hypot(u[2]) < 1e-12, "sticks: {u:?}");
            let work_j = 0.5 * math::dot(p, math::add([-0.18, 0.04, 0.043], u));
            assert!(work_j < -0.4, "{work_j}");
        }
        let mut jammed = k;
        jammed[2][2] = 0.833;
        assert_eq!(of(jammed, 0.0).impulse(), None);
    }

    /// In a plane: `K = [1, 0.99; 0.99, 1]`, with a determinant of 0.0199 and eigenvalues 0.01 and 1.99.
    #[test]
    fn a_point_that_sticks_by_a_large_impulse_in_a_plane() {
        let k = [[1.0, 0.99, 0.0], [0.99, 1.0, 0.0], [0.0, 0.0, 0.0]];
        // p = K⁻¹ (0.01, -0.3) = (0.01 + 0.297, -0.3 - 0.0099) / 0.0199
        let p = holds(&Single { k, free: [-0.01, 0.3, 0.0], target: 0.0, friction: 1.5 });
        assert!((p[0] - 0.307 / 0.0199).abs() < 1e-9 && (p[1] + 0.3099 / 0.0199).abs() < 1e-9, "{p:?}");
    }
}
