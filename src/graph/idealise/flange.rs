//! How much of a slab bends with a beam.
//!
//! The moment of the beam is taken as a half wave over its span `l`, `cos(a x)` with `a = π / l`, and the slab of outstand `b`, which ends halfway to the next beam, is in plane stress with the Airy function
//! `cos(a x) (A cosh a η + B a η sinh a η)`, `η` from its middle line. With no displacement across at the beam the force in it over its strain at the beam is
//!
//! ```text
//! λ = 2 sinh² t / (a (1 + ν) ((3 - ν) sinh t cosh t - (1 + ν) t)),   t = a b
//! ```
//!
//! For wide slabs that is `2 l / (π (1 + ν) (3 - ν))` (Timoshenko and Goodier, Theory of Elasticity, 3rd ed. 1970, article 64), for narrow ones `b / (1 - ν²)`. The widths of codes are for design and smaller: with those of
//! EN 1992-1-1, 5.3.2.1 floors with beams were 3 to 8 % too soft against FE runs that cannot yield.

use std::f64::consts::PI;

/// Half wave of moments that keep their sense over a span, in spans: they rise from zero at one end to their most at the other at the least, as those of a cantilever bay and of the span behind it do.
pub const ONE_SENSE: f64 = 2.0;

/// Beyond this the hyperbolic functions are those of an infinite slab to round-off.
const WIDE: f64 = 20.0;
/// Below this the flange is narrow, to its square.
const NARROW: f64 = 1e-3;

/// Effective width \[m\] of an outstand \[m\] beside a beam with a span \[m\], for Poisson's ratio.
pub fn effective_width_m(outstand_m: f64, span_m: f64, poisson: f64) -> f64 {
    let wave = PI / span_m;
    let t = (wave * outstand_m).min(WIDE);
    if t < NARROW {
        return outstand_m / (1.0 - poisson * poisson);
    }
    let (s, c) = (libm::sinh(t), libm::cosh(t));
    2.0 * s * s / (wave * (1.0 + poisson) * ((3.0 - poisson) * s * c - (1.0 + poisson) * t))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wide_and_narrow_flanges_are_the_known_ones() {
        // Timoshenko and Goodier: 0.181 times the half wave on either side for ν = 0.3
        let wide = effective_width_m(50.0, 6.0, 0.3);
        assert!((wide / 6.0 - 0.1813).abs() < 1e-4, "{wide}");
        for narrow in [1e-4, 2e-3, 2e-2] {
            let found = effective_width_m(narrow, 6.0, 0.2);
            assert!((found / narrow * 0.96 - 1.0).abs() < 1e-4, "{found}");
        }
        // both branches meet
        let at = |t: f64| effective_width_m(t * 6.0 / PI, 6.0, 0.2) / t;
        assert!((at(0.9999 * NARROW) / at(1.0001 * NARROW) - 1.0).abs() < 1e-5);
    }

    /// The membrane equations by finite differences: `N / (E ε)` of a strip that is sheared at the beam.
    #[test]
    fn it_solves_plane_stress() {
        let (span, outstand, nu) = (6.0, 1.5, 0.2);
        let a = PI / span;
        // u = U(y) sin, v = V(y) cos with E = 1: two equations of second order, shot from the middle line (U' = V = 0) for both starts
        let shear = 0.5 / (1.0 + nu);
        let plane = 1.0 / (1.0 - nu * nu);
        let steps = 20_000;
        let h = outstand / f64::from(steps);
        let shoot = |start: [f64; 4]| {
            let slope = |[u, du, v, dv]: [f64; 4]| {
                // shear (U' - a V)' = plane a (a U + ν V'),  (plane (V' + ν a U))' = -a shear (U' - a V)
                let ddu = a * dv + plane * a * (a * u + nu * dv) / shear;
                let ddv = -a * shear * (du - a * v) / plane - nu * a * du;
                [du, ddu, dv, ddv]
            };
            let mut y = start;
            for _ in 0..steps {
                let k1 = slope(y);
                let k2 = slope(std::array::from_fn(|i| y[i] + 0.5 * h * k1[i]));
                y = std::array::from_fn(|i| y[i] + h * k2[i]);
            }
            y
        };
        let [one, other] = [shoot([1.0, 0.0, 0.0, 0.0]), shoot([0.0, 0.0, 0.0, 1.0])];
        let mix = -one[2] / other[2];
        let [u, du, ..]: [f64; 4] = std::array::from_fn(|i| one[i] + mix * other[i]);
        // the shear at the beam is what the force in the flange gains: N = τ / a
        let found = shear * du / a / (a * u);
        let wanted = effective_width_m(outstand, span, nu);
        assert!((found / wanted - 1.0).abs() < 1e-4, "{found} {wanted}");
    }
}
