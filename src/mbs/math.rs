//! Small vector, matrix and quaternion functions of the time loop: plain arrays, no dispatch.
//!
//! Quaternions are `[w, x, y, z]`, matrices are rows.

pub use crate::base::vector::{V3, add, axpy, cross, dot, norm, scale, sub};

/// A matrix by rows.
pub type M3 = [[f64; 3]; 3];
/// A unit quaternion `[w, x, y, z]`.
pub type Q = [f64; 4];

/// `M a`.
#[inline(always)]
pub fn mul(m: &M3, a: V3) -> V3 {
    [dot(m[0], a), dot(m[1], a), dot(m[2], a)]
}

/// `Mᵀ a`.
#[inline(always)]
pub fn mul_t(m: &M3, a: V3) -> V3 {
    [
        m[0][0] * a[0] + m[1][0] * a[1] + m[2][0] * a[2],
        m[0][1] * a[0] + m[1][1] * a[1] + m[2][1] * a[2],
        m[0][2] * a[0] + m[1][2] * a[1] + m[2][2] * a[2],
    ]
}

/// `A B`.
#[inline]
pub fn matmul(a: &M3, b: &M3) -> M3 {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
    })
}

/// `Mᵀ`.
#[inline]
pub fn transpose(m: &M3) -> M3 {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// `R M Rᵀ`: a tensor of a body's frame in the frame that its orientation leads to.
#[inline(always)]
pub fn turned(r: &M3, m: &M3) -> M3 {
    matmul(&matmul(r, m), &transpose(r))
}

/// Inertia tensor of a point mass about a centre from which it has an arm (Steiner) \[kg m²\].
pub fn point_inertia(mass: f64, arm: V3) -> M3 {
    let square = dot(arm, arm);
    std::array::from_fn(|i| {
        std::array::from_fn(|j| mass * (if i == j { square } else { 0.0 } - arm[i] * arm[j]))
    })
}

/// `A + B`.
#[inline]
pub fn matadd(a: &M3, b: &M3) -> M3 {
    std::array::from_fn(|i| add(a[i], b[i]))
}

/// Determinant.
pub fn det(m: &M3) -> f64 {
    dot(m[0], cross(m[1], m[2]))
}

/// Inverse of a regular matrix.
pub fn inverse(m: &M3) -> M3 {
    let d = 1.0 / det(m);
    transpose(&[scale(d, cross(m[1], m[2])), scale(d, cross(m[2], m[0])), scale(d, cross(m[0], m[1]))])
}

/// Quaternion product `a ⊗ b`.
#[inline(always)]
pub fn qmul(a: Q, b: Q) -> Q {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Conjugate.
#[inline(always)]
pub fn qconj(q: Q) -> Q {
    [q[0], -q[1], -q[2], -q[3]]
}

/// Length of a quaternion.
pub fn qnorm(q: Q) -> f64 {
    q.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// The unit quaternion along one that is not zero.
pub fn qunit(q: Q) -> Q {
    let length = qnorm(q);
    q.map(|v| v / length)
}

/// Scales to unit length; one Newton step, for quaternions that are nearly unit.
#[inline(always)]
pub fn qrenormalise(q: Q) -> Q {
    let s = 1.5 - 0.5 * (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    [s * q[0], s * q[1], s * q[2], s * q[3]]
}

/// Rotation matrix (body to global).
#[inline(always)]
pub fn qmat(q: Q) -> M3 {
    let [w, x, y, z] = q;
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (xx, yy, zz) = (x * x2, y * y2, z * z2);
    let (xy, xz, yz) = (x * y2, x * z2, y * z2);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    [[1.0 - yy - zz, xy - wz, xz + wy], [xy + wz, 1.0 - xx - zz, yz - wx], [xz - wy, yz + wx, 1.0 - xx - yy]]
}

/// Quaternion of a rotation matrix (Shepperd's choice of the largest component).
pub fn mat_to_q(m: &M3) -> Q {
    let t = m[0][0] + m[1][1] + m[2][2];
    let c = [t, m[0][0], m[1][1], m[2][2]];
    let mut best = 0;
    for i in 1..4 {
        if c[i] > c[best] {
            best = i;
        }
    }
    let q = match best {
        0 => [1.0 + t, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]],
        1 => [m[2][1] - m[1][2], 1.0 + m[0][0] - m[1][1] - m[2][2], m[0][1] + m[1][0], m[0][2] + m[2][0]],
        2 => [m[0][2] - m[2][0], m[0][1] + m[1][0], 1.0 - m[0][0] + m[1][1] - m[2][2], m[1][2] + m[2][1]],
        _ => [m[1][0] - m[0][1], m[0][2] + m[2][0], m[1][2] + m[2][1], 1.0 - m[0][0] - m[1][1] + m[2][2]],
    };
    let n = (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]).sqrt();
    q.map(|v| v / n)
}

/// Square of half an angle below which [`exp_series`] holds.
pub const EXP_NEAR: f64 = 0.01;

/// `sin(s)/(2 s)` and `cos(s)` from `s²`, half an angle; error below 1e-16 for `s² <` [`EXP_NEAR`].
#[inline(always)]
pub fn exp_series(s2: f64) -> (f64, f64) {
    (
        0.5 - s2 * (1.0 / 12.0 - s2 * (1.0 / 240.0 - s2 * (1.0 / 10080.0 - s2 * (1.0 / 725_760.0)))),
        1.0 - s2
            * (0.5
                - s2 * (1.0 / 24.0 - s2 * (1.0 / 720.0 - s2 * (1.0 / 40320.0 - s2 * (1.0 / 3_628_800.0))))),
    )
}

/// `exp` of a rotation vector as a quaternion; a series for the small angles of a time step.
#[inline(always)]
pub fn qexp(r: V3) -> Q {
    let s2 = 0.25 * dot(r, r);
    let (half_sinc, c) = if s2 < EXP_NEAR {
        exp_series(s2)
    } else {
        let s = s2.sqrt();
        (0.5 * libm::sin(s) / s, libm::cos(s))
    };
    [c, half_sinc * r[0], half_sinc * r[1], half_sinc * r[2]]
}

/// Cosine of half an angle from which [`log_factor`] holds: angles up to 2.3 rad.
pub const LOG_NEAR: f64 = 0.4;

/// `φ / sin(φ/2)` of a rotation by `φ`, from the square of `sin(φ/2)` and from `cos(φ/2) >` [`LOG_NEAR`]: `4 atan(x) / sin(φ/2)` with `x = tan(φ/4)`; the arc tangent is Moshier's rational
/// function for `|x| <= 0.66` (Cephes library, `atan.c`), with a relative error of 2e-16.
#[inline(always)]
pub fn log_factor(sine2: f64, cosine: f64) -> f64 {
    let inverse = 1.0 / (1.0 + cosine);
    let z = sine2 * inverse * inverse;
    let p = -64.85021904942025
        + z * (-122.88666844901361
            + z * (-75.00855792314705 + z * (-16.157537187333652 + z * -0.8750608600031904)));
    let q = 194.5506571482614
        + z * (485.3903996359137
            + z * (432.88106049129027 + z * (165.02700983169885 + z * (24.858464901423062 + z))));
    4.0 * inverse * (1.0 + z * (p / q))
}

/// The vector part of a quaternion times this is its rotation vector, of length up to 2π (the sign of the quaternion chooses the branch).
#[inline(always)]
pub fn qlog_factor(q: Q) -> f64 {
    let v = [q[1], q[2], q[3]];
    let s2 = dot(v, v);
    if q[0] > LOG_NEAR {
        log_factor(s2, q[0])
    } else {
        let s = s2.sqrt();
        if s < 1e-150 { 2.0 } else { 2.0 * libm::atan2(s, q[0]) / s }
    }
}

/// Rotation vector of a quaternion, of length up to 2π.
#[inline(always)]
pub fn qlog(q: Q) -> V3 {
    scale(qlog_factor(q), [q[1], q[2], q[3]])
}

/// `c(φ) = (1 - (φ/2) cot(φ/2))/φ²` of the inverse tangent map of the rotation vector, from `φ²`, `φ / sin(φ/2)` ([`qlog_factor`]) and `cos(φ/2)`.
#[inline(always)]
pub fn tangent_coefficient(phi2: f64, factor: f64, cosine: f64) -> f64 {
    let series = 1.0 / 12.0
        + phi2
            * (1.0 / 720.0 + phi2 * (1.0 / 30240.0 + phi2 * (1.0 / 1209600.0 + phi2 * (1.0 / 47900160.0))));
    let closed = (1.0 - 0.5 * factor * cosine) / phi2;
    if phi2 < 0.04 { series } else { closed }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exp_and_log_are_inverse_on_both_branches() {
        for angle in [0.0, 1e-200, 1e-9, 1e-3, 0.0999, 0.1001, 0.2, 1.0, 2.3, 2.31, 2.32, 3.0, 3.5, 6.0] {
            let axis = [2.0 / 7.0, -3.0 / 7.0, 6.0 / 7.0];
            let back = qlog(qexp(scale(angle, axis)));
            assert!(norm(sub(back, scale(angle, axis))) < 4e-15 * (1.0 + angle), "{angle}: {back:?}");
        }
    }

    #[test]
    fn the_tangent_coefficient_is_that_of_the_angle() {
        for angle in [1e-3, 0.1999, 0.2001, 0.5, 1.0, 2.0, 2.31, 2.33, 3.0, 4.0, 6.0_f64] {
            let (half, q) = (0.5 * angle, qexp([0.0, angle, 0.0]));
            let found = tangent_coefficient(angle * angle, qlog_factor(q), q[0]) * angle * angle;
            let known = 1.0 - half / half.tan();
            assert!((found - known).abs() < 1e-14 * (1.0 + known.abs()), "{angle}: {found} {known}");
        }
    }

    #[test]
    fn matrix_and_quaternion_agree() {
        let q = qexp([2.9, -0.3, 0.4]);
        let m = qmat(q);
        assert!((det(&m) - 1.0).abs() < 1e-14);
        let p = mat_to_q(&m);
        let same: f64 = (0..4).map(|i| p[i] * q[i]).sum();
        assert!((same.abs() - 1.0).abs() < 1e-14);
    }
}
