//! Gaps between two solids along directions that may part them.

use super::collide::{Placed, Solid};
use crate::mbs::math::{self, V3};

/// Square of the sine of the angle between edges up to which they are parallel.
const PARALLEL: f64 = 1e-6;

/// A lower bound of the distance of two solids \[m\]; for boxes the largest gap along their six face normals.
pub fn separation(a: (&Solid, &Placed), b: (&Solid, &Placed)) -> f64 {
    let d = math::sub(b.1.x, a.1.x);
    let (Solid::Box(half_a), Solid::Box(half_b)) = (a.0, b.0) else {
        let distance = math::norm(d);
        if distance == 0.0 {
            return f64::NEG_INFINITY;
        }
        let along = math::scale(1.0 / distance, d);
        return distance - a.0.reach(a.1, along) - b.0.reach(b.1, math::scale(-1.0, along));
    };
    let in_a = math::mul_t(&a.1.r, d);
    let in_b = math::mul_t(&b.1.r, d);
    let c = math::matmul(&math::transpose(&a.1.r), &b.1.r);
    let mut gap = f64::NEG_INFINITY;
    for i in 0..3 {
        let reach_b: f64 = (0..3).map(|j| c[i][j].abs() * half_b[j]).sum();
        let reach_a: f64 = (0..3).map(|j| c[j][i].abs() * half_a[j]).sum();
        gap = gap.max(in_a[i].abs() - half_a[i] - reach_b).max(in_b[i].abs() - half_b[i] - reach_a);
    }
    gap
}

/// The same bound for boxes along the products of their edges: with [`separation`] all axes that can part two boxes. Nothing for others \[m\].
pub fn edge_separation(a: (&Solid, &Placed), b: (&Solid, &Placed)) -> f64 {
    let (Solid::Box(half_a), Solid::Box(half_b)) = (a.0, b.0) else { return f64::NEG_INFINITY };
    let d = math::mul_t(&a.1.r, math::sub(b.1.x, a.1.x));
    let c = math::matmul(&math::transpose(&a.1.r), &b.1.r);
    let mut gap = f64::NEG_INFINITY;
    for i in 0..3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let square = 1.0 - c[i][j] * c[i][j];
            if square < PARALLEL {
                continue;
            }
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let apart = (d[i2] * c[i1][j] - d[i1] * c[i2][j]).abs();
            let reach_a = half_a[i1] * c[i2][j].abs() + half_a[i2] * c[i1][j].abs();
            let reach_b = half_b[j1] * c[i][j2].abs() + half_b[j2] * c[i][j1].abs();
            gap = gap.max((apart - reach_a - reach_b) / square.sqrt());
        }
    }
    gap
}

/// The direction from the first to the second of two solids along which they are farthest apart, or least in each other: one of those that can part boxes, for others the one between their origins.
pub fn widest_gap(a: (&Solid, &Placed), b: (&Solid, &Placed)) -> V3 {
    let d = math::sub(b.1.x, a.1.x);
    let (Solid::Box(_), Solid::Box(_)) = (a.0, b.0) else {
        return math::scale(1.0 / math::norm(d).max(f64::MIN_POSITIVE), d);
    };
    let [of_a, of_b] = [a.1, b.1].map(|at| math::transpose(&at.r));
    let edges = of_a.iter().flat_map(|i| of_b.iter().map(move |j| math::cross(*i, *j)));
    let crossed = edges.filter_map(|n| {
        let square = math::dot(n, n);
        (square >= PARALLEL).then(|| math::scale(1.0 / square.sqrt(), n))
    });
    let outwards = |n: V3| if math::dot(n, d) < 0.0 { math::scale(-1.0, n) } else { n };
    let all = of_a.into_iter().chain(of_b).chain(crossed).map(outwards);
    let (_, along) = all.fold((f64::NEG_INFINITY, [0.0; 3]), |best, n| {
        let gap = gap_along(a, b, n);
        if gap > best.0 { (gap, n) } else { best }
    });
    along
}

/// The gap between two solids along a direction of unit length from the first to the second \[m\].
pub fn gap_along(a: (&Solid, &Placed), b: (&Solid, &Placed), along: V3) -> f64 {
    let d = math::dot(math::sub(b.1.x, a.1.x), along);
    d - a.0.reach(a.1, along) - b.0.reach(b.1, math::scale(-1.0, along))
}
