//! Geometry of the trilinear hexahedron in the basis of its nodal patterns.
//!
//! The eight nodal values `v_I` of a field are exchanged for the sums `Λ_k · v` with the patterns
//! `ξ, η, ζ, ηζ, ξζ, ξη, ξηζ` of the node signs (and the constant, which never matters here). The patterns
//! are orthogonal with norm 8, so both ways cost additions only. With `A_1..A_3` the sums of the positions with `ξ, η, ζ` and `C_1..C_3`
//! those with `ηζ, ξζ, ξη`, the position field is
//! `8 x = const + A_1 ξ + A_2 η + A_3 ζ + C_1 ηζ + C_2 ξζ + C_3 ξη + C_4 ξηζ`. Integrating `det ∂x/∂ξ` over the cube, all odd
//! moments and all terms with `C_4` drop out, and
//!
//! `64 V = [A_1 A_2 A_3] + ([A_1 C_3 C_2] + [C_3 A_2 C_1] + [C_2 C_1 A_3]) / 3`
//!
//! with the triple product `[a b c]`. The uniform gradient `B_iI = ∂V/∂x_iI` (Flanagan and Belytschko, Int. J.
//! Numer. Meth. Engng 17 (1981) 679-706) therefore is `B_I = Σ_k Λ_kI E_k / 64` with the six cross-product
//! vectors of [`gradient`], exact for any hexahedron.
//!
//! All functions work on one element; the kernel calls them in a loop over lanes that the compiler vectorises.

use crate::base::vector::{V3, add, cross, dot, scale};

/// Patterns 0..7: `ξ, η, ζ, ηζ, ξζ, ξη, ξηζ`.
pub const PATTERNS: usize = 7;

/// Sums of nodal values with the seven patterns. Nodes: bottom face counter-clockwise seen from +ζ, then top.
#[inline(always)]
pub fn to_patterns(v: [f64; 8]) -> [f64; PATTERNS] {
    let (s01, d01) = (v[1] + v[0], v[1] - v[0]);
    let (s32, d32) = (v[2] + v[3], v[2] - v[3]);
    let (s45, d45) = (v[5] + v[4], v[5] - v[4]);
    let (s76, d76) = (v[6] + v[7], v[6] - v[7]);
    let (low, low_eta, low_xi, low_xi_eta) = (s32 + s01, s32 - s01, d32 + d01, d32 - d01);
    let (top, top_eta, top_xi, top_xi_eta) = (s76 + s45, s76 - s45, d76 + d45, d76 - d45);
    [
        top_xi + low_xi,
        top_eta + low_eta,
        top - low,
        top_eta - low_eta,
        top_xi - low_xi,
        top_xi_eta + low_xi_eta,
        top_xi_eta - low_xi_eta,
    ]
}

/// Nodal values with given pattern coefficients: `v_I = Σ_k Λ_kI c_k`.
#[inline(always)]
pub fn to_nodes(c: [f64; PATTERNS]) -> [f64; 8] {
    let (top_eta, low_eta) = (c[1] + c[3], c[1] - c[3]);
    let (top_xi, low_xi) = (c[0] + c[4], c[0] - c[4]);
    let (top_xi_eta, low_xi_eta) = (c[5] + c[6], c[5] - c[6]);
    let (s32, s01) = (low_eta - c[2], -low_eta - c[2]);
    let (d32, d01) = (low_xi + low_xi_eta, low_xi - low_xi_eta);
    let (s76, s45) = (c[2] + top_eta, c[2] - top_eta);
    let (d76, d45) = (top_xi + top_xi_eta, top_xi - top_xi_eta);
    [s01 - d01, s01 + d01, s32 + d32, s32 - d32, s45 - d45, s45 + d45, s76 + d76, s76 - d76]
}

/// `64 B` in pattern coefficients (the seventh is zero) and the volume, from the pattern sums of the positions.
#[inline(always)]
pub fn gradient(p: &[V3; PATTERNS]) -> ([V3; 6], f64) {
    let [a1, a2, a3, c1, c2, c3, _] = *p;
    const THIRD: f64 = 1.0 / 3.0;
    let e = [
        add(cross(a2, a3), scale(THIRD, cross(c3, c2))),
        add(cross(a3, a1), scale(THIRD, cross(c1, c3))),
        add(cross(a1, a2), scale(THIRD, cross(c2, c1))),
        scale(THIRD, add(cross(c3, a2), cross(a3, c2))),
        scale(THIRD, add(cross(a1, c3), cross(c1, a3))),
        scale(THIRD, add(cross(c2, a1), cross(a2, c1))),
    ];
    let volume = (dot(a1, e[0]) + dot(c1, e[3])) * (1.0 / 64.0);
    (e, volume)
}

/// Exact volume of a trilinear hexahedron \[m³\].
pub fn volume_m3(nodes: &[V3; 8]) -> f64 {
    let mut patterns = [[0.0; 3]; PATTERNS];
    for i in 0..3 {
        let sums = to_patterns(nodes.map(|n| n[i]));
        for (pattern, sum) in patterns.iter_mut().zip(sums) {
            pattern[i] = sum;
        }
    }
    gradient(&patterns).1
}

/// Right-handed orthonormal frame (rows) by Gram-Schmidt from two directions.
#[inline(always)]
pub fn frame(first: V3, second: V3) -> [V3; 3] {
    let e1 = scale(1.0 / dot(first, first).sqrt(), first);
    let rest = add(second, scale(-dot(e1, second), e1));
    let e2 = scale(1.0 / dot(rest, rest).sqrt(), rest);
    [e1, e2, cross(e1, e2)]
}

/// Cube root of a positive normal number, within one unit in the last place: exponent divided by three in integers, a
/// polynomial, one step of Newton (the method of FreeBSD's `s_cbrt.c`). Without a call, so that a loop over it vectorises.
#[inline(always)]
pub fn cbrt(x: f64) -> f64 {
    let high = (x.to_bits() >> 32) & 0x7fff_ffff;
    let third = (high * 0x5555_5556) >> 32;
    let t = f64::from_bits((third + 715_094_163) << 32);
    let r = (t * t) * (t / x);
    let t = t
        * ((1.875_951_824_271_77 + r * (-1.884_979_795_433_771_7 + r * 1.621_429_720_105_354_5))
            + ((r * r) * r) * (-0.758_397_934_778_766 + r * 0.145_996_192_886_612_45));
    let quotient = x / (t * t);
    t + t * ((quotient - t) / (t + t + quotient))
}

/// `a[0] rows[0] + a[1] rows[1] + a[2] rows[2]`: a local vector in global components.
#[inline(always)]
pub fn to_global(rows: &[V3; 3], a: V3) -> V3 {
    add(add(scale(a[0], rows[0]), scale(a[1], rows[1])), scale(a[2], rows[2]))
}

/// Scalar products with three rows: a global vector in local components.
#[inline(always)]
pub fn to_local(rows: &[V3; 3], a: V3) -> V3 {
    [dot(rows[0], a), dot(rows[1], a), dot(rows[2], a)]
}

/// Nodes of a cube of edge 1, for tests.
#[cfg(test)]
pub(super) const UNIT_CUBE: [V3; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_and_nodes_are_inverse() {
        let c = [0.3, -1.0, 2.0, 0.25, 4.0, -0.5, 7.0];
        let back = to_patterns(to_nodes(c));
        for k in 0..PATTERNS {
            assert!((back[k] - 8.0 * c[k]).abs() < 1e-13, "{k}: {back:?}");
        }
    }

    #[test]
    fn cube_root_is_exact_to_the_last_place() {
        let mut x = 1e-12;
        while x < 1e9 {
            assert!((cbrt(x) - x.cbrt()).abs() <= 3e-16 * x.cbrt(), "{x}");
            x *= 1.037;
        }
    }
}
