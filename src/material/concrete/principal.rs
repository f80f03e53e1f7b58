//! Principal values and directions of a symmetric tensor, without iteration or branch: a loop over tensors becomes vector code.
//!
//! The values of the deviator over its radius `2 sqrt(J₂ / 3)` are `cos(θ + 2πk/3)` with `cos 3θ = 4 det` (Smith, Commun. ACM 4 (1961) 168). With the sign that
//! makes `cos 3θ >= 0` the first, `y >= cos 30°`, is at least 0.86 from the others: `4 y³ - 3 y = cos 3θ` is well conditioned there, and so is its
//! direction, a column of the adjugate of `B - y I`. The other two follow in the plane across it from one rotation after Jacobi, which
//! is exact for equal values too. Errors are some units in the last place of the largest value.

use crate::base::vector::dot;

/// Polynomial for `cos(acos(c) / 3)`, `c` from 0 to 1, within 4.1e-5; two steps of Newton square that twice.
const ROOT: [f64; 4] =
    [0.866_066_329_533_191_7, 0.165_330_350_220_845_4, -0.040_691_197_422_887_7, 0.009_319_683_897_481_92];
/// Second invariants below which a tensor is a pressure.
const SMALLEST: f64 = 1e-200;

/// Principal values in falling order, and their directions. `t`: xx, yy, zz, xy, yz, zx.
#[inline(always)]
pub fn principal(t: &[f64; 6]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mean = (t[0] + t[1] + t[2]) * (1.0 / 3.0);
    let s = [t[0] - mean, t[1] - mean, t[2] - mean, t[3], t[4], t[5]];
    let normal = s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    let j2 = 0.5 * normal + (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]);
    let some = j2 > SMALLEST;
    let radius = if some { 2.0 * (j2 * (1.0 / 3.0)).sqrt() } else { 0.0 };
    let inverse = if some { 1.0 / radius } else { 0.0 };
    let mut b = [0.0; 6];
    for i in 0..6 {
        b[i] = inverse * s[i];
    }
    let det = b[0] * (b[1] * b[2] - b[4] * b[4]) - b[3] * (b[3] * b[2] - b[4] * b[5])
        + b[5] * (b[3] * b[4] - b[1] * b[5]);
    let upward = det >= 0.0;
    let sign = if upward { 1.0 } else { -1.0 };
    for i in 0..6 {
        b[i] *= sign;
    }
    let y = root(4.0 * det * sign);
    let v = direction(&b, y);
    // two directions across it (Duff et al., J. Comput. Graph. Tech. 6 (2017) 1-8)
    let side = if v[2] >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (side + v[2]);
    let ab = v[0] * v[1] * a;
    let u = [1.0 + side * v[0] * v[0] * a, side * ab, -side * v[0]];
    let w = [ab, side + v[1] * v[1] * a, -v[1]];
    let (bu, bw) = (times(&b, &u), times(&b, &w));
    let (p, o, r) = (dot(u, bu), dot(w, bu), dot(w, bw));
    let (middle, half) = (0.5 * (p + r), 0.5 * (p - r));
    let h = (half * half + o * o).sqrt();
    let x = h + half.abs();
    let distinct = x > 1e-100;
    let (x, o) = (if distinct { x } else { 1.0 }, if distinct { o } else { 0.0 });
    let unit = 1.0 / (x * x + o * o).sqrt();
    let (c, d) = (if half >= 0.0 { x } else { o }, if half >= 0.0 { o } else { x });
    let (c, d) = (unit * c, unit * d);
    let (high, low) = (middle + h, middle - h);
    let mut q = [[0.0; 3]; 3];
    for i in 0..3 {
        let (plus, minus) = (c * u[i] + d * w[i], c * w[i] - d * u[i]);
        q[0][i] = if upward { v[i] } else { minus };
        q[1][i] = plus;
        q[2][i] = if upward { minus } else { v[i] };
    }
    let values =
        [if upward { y } else { -low }, if upward { high } else { -high }, if upward { low } else { -y }];
    ([mean + radius * values[0], mean + radius * values[1], mean + radius * values[2]], q)
}

/// The tensor with these principal values and directions.
#[inline(always)]
pub fn assemble(values: &[f64; 3], q: &[[f64; 3]; 3]) -> [f64; 6] {
    const AT: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];
    let mut out = [0.0; 6];
    for (n, [i, j]) in AT.into_iter().enumerate() {
        out[n] =
            values[0] * q[0][i] * q[0][j] + values[1] * q[1][i] * q[1][j] + values[2] * q[2][i] * q[2][j];
    }
    out
}

/// `cos(acos(c) / 3)` for `c` from 0 to 1.
#[inline(always)]
fn root(c: f64) -> f64 {
    let c = if c < 1.0 { c } else { 1.0 };
    let mut y = ROOT[0] + c * (ROOT[1] + c * (ROOT[2] + c * ROOT[3]));
    for _ in 0..2 {
        let square = y * y;
        y -= ((4.0 * square - 3.0) * y - c) / (12.0 * square - 3.0);
    }
    y
}

/// Direction of the principal value `y`, which is far from the others.
#[inline(always)]
fn direction(b: &[f64; 6], y: f64) -> [f64; 3] {
    let d = [b[0] - y, b[1] - y, b[2] - y];
    let (xx, yy, zz) = (d[1] * d[2] - b[4] * b[4], d[2] * d[0] - b[5] * b[5], d[0] * d[1] - b[3] * b[3]);
    let (xy, yz, zx) = (b[5] * b[4] - b[3] * d[2], b[3] * b[5] - b[4] * d[0], b[3] * b[4] - b[5] * d[1]);
    // the column with the largest diagonal, at least a quarter
    let first = xx >= yy;
    let (top, column) = (
        if first { xx } else { yy },
        [if first { xx } else { xy }, if first { xy } else { yy }, if first { zx } else { yz }],
    );
    let last = zz > top;
    let column = [
        if last { zx } else { column[0] },
        if last { yz } else { column[1] },
        if last { zz } else { column[2] },
    ];
    let unit = 1.0 / dot(column, column).sqrt();
    [unit * column[0], unit * column[1], unit * column[2]]
}

#[inline(always)]
fn times(b: &[f64; 6], v: &[f64; 3]) -> [f64; 3] {
    [
        b[0] * v[0] + b[3] * v[1] + b[5] * v[2],
        b[3] * v[0] + b[1] * v[1] + b[4] * v[2],
        b[5] * v[0] + b[4] * v[1] + b[2] * v[2],
    ]
}

#[cfg(test)]
mod tests {
    use super::{assemble, dot, principal};
    use crate::base::random::Random;

    /// Largest error of values, of `Q diag Qᵀ` over the size of the tensor, and of `QᵀQ`.
    fn errors(t: &[f64; 6], exact: Option<[f64; 3]>) -> f64 {
        let size = t.iter().fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
        let (values, q) = principal(t);
        assert!(values[0] >= values[1] && values[1] >= values[2], "{values:?}");
        let again = assemble(&values, &q);
        let mut worst = (0..6).map(|i| (again[i] - t[i]).abs() / size).fold(0.0, f64::max);
        for i in 0..3 {
            for j in 0..3 {
                let unit = if i == j { 1.0 } else { 0.0 };
                worst = worst.max((dot(q[i], q[j]) - unit).abs());
            }
        }
        let off = exact.map_or(0.0, |e| (0..3).map(|i| (e[i] - values[i]).abs() / size).fold(0.0, f64::max));
        if off.is_nan() || worst.is_nan() { f64::NAN } else { worst.max(off) }
    }

    #[test]
    fn values_and_directions_give_the_tensor_back() {
        let mut random = Random::after(1);
        let mut worst: f64 = 0.0;
        for case in 0..20_000 {
            let scale = 10f64.powi(case % 12 - 9);
            let t: [f64; 6] = std::array::from_fn(|_| scale * random.symmetric());
            let error = errors(&t, None);
            assert!(error < 5e-15, "{t:?}: {error}");
            worst = worst.max(error);
        }
        assert!(worst > 0.0);
    }

    #[test]
    fn equal_and_nearly_equal_values_are_no_exception() {
        let mut random = Random::after(2);
        for gap in [0.0, 1e-17, 1e-14, 1e-11, 1e-8, 1e-4] {
            for base in [[1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [0.0; 3], [1.0, 0.0, -1.0]] {
                let values = [base[0] + gap, base[1], base[2] - gap];
                for _ in 0..200 {
                    let t: [f64; 6] = std::array::from_fn(|_| random.symmetric());
                    let (_, q) = principal(&t);
                    assert!(errors(&assemble(&values, &q), Some(values)) < 5e-15, "{values:?}");
                }
                let plain = [values[2], values[0], values[1], 0.0, 0.0, 0.0];
                assert!(errors(&plain, Some(values)) < 2e-15, "{values:?}");
            }
        }
        assert!(errors(&[1e-3, 1e-200, -1e-250, 0.0, 1e-300, 0.0], None) < 2e-15);
        assert!(errors(&[1e-150; 6], None).is_finite());
    }
}
