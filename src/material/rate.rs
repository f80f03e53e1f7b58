//! The rate factor of Cowper and Symonds (1957) on a yield stress, `1 + (ε̇ / C)^(1/P)`, with the equivalent plastic strain rate.
//!
//! **Implicit.** The factor is that of the plastic strain rate of the step itself, `ε̇ = Δp / Δt`, found together with `Δp`:
//! `q_trial - 3 G Δp = σ_y(p + Δp) [1 + (Δp / (C Δt))^(1/P)]` (viscoplastic, Perzyna's overstress form). With the total strain rate of
//! the trial step instead, every elastic vibration would raise the yield stress. In steady flow both are the same.
//!
//! With `y = (Δp / (C Δt))^(1/P)` as the unknown the residual has finite slopes, falls throughout, and for a table that
//! does not soften is concave: Newton's method from a `Δp` that is too large comes down on the solution without crossing it. Brackets keep
//! it safe in tables that soften.

use super::j2::HardeningTable;
use serde::{Deserialize, Serialize};

/// Constants of the rate factor.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RateFactor {
    /// C \[1/s\].
    pub c_1_s: f64,
    /// P.
    pub p: f64,
}

impl RateFactor {
    /// The factor at an equivalent plastic strain rate \[1/s\].
    pub fn at(&self, rate_1_s: f64) -> f64 {
        1.0 + power(rate_1_s / self.c_1_s, 1.0 / self.p)
    }

    /// Solves for the plastic strain increment of a step of `dt_s` \[s\] from a trial stress above the yield stress, given the increment `most` without
    /// rate factor; also returns the rate factor. `scale` is a factor on the table.
    pub(super) fn increment(
        &self,
        table: &HardeningTable,
        [q_trial_pa, plastic_strain]: [f64; 2],
        shear_modulus_pa: f64,
        scale: f64,
        dt_s: f64,
        most: f64,
    ) -> (f64, f64) {
        let stiffness_pa = 3.0 * shear_modulus_pa;
        let unit = self.c_1_s * dt_s;
        // two upper estimates: without elastic relief, and without rate factor
        let mut y = q_trial_pa / (scale * table.at(plastic_strain).0) - 1.0;
        if unit * self.raised(y) > most {
            y = power(most / unit, 1.0 / self.p);
        }
        let (mut low, mut high) = (0.0, f64::INFINITY);
        for _ in 0..80 {
            let raised = self.raised(y);
            let increment = unit * raised;
            let (yield_pa, slope_pa) = table.at(plastic_strain + increment);
            let residual = q_trial_pa - stiffness_pa * increment - scale * yield_pa * (1.0 + y);
            if residual.abs() <= 1e-13 * q_trial_pa || high - low <= 1e-15 * y {
                break;
            }
            if residual > 0.0 {
                low = y;
            } else {
                high = y;
            }
            let growth = unit * self.p * raised / y;
            let slope = (stiffness_pa + scale * slope_pa * (1.0 + y)) * growth + scale * yield_pa;
            let next = y + residual / slope;
            y = if next > low && next < high { next } else { 0.5 * (low + high.min(2.0 * y)) };
        }
        (unit * self.raised(y), 1.0 + y)
    }

    /// `y^P`.
    fn raised(&self, y: f64) -> f64 {
        let whole = self.p as u32;
        if f64::from(whole) == self.p && whole <= 16 {
            (0..whole).fold(1.0, |product, _| product * y)
        } else {
            power(y, self.p)
        }
    }
}

/// `x^a` of a number that is not negative, within some 1e-15 relative for moderate exponents. Made of additions and multiplications, so that
/// results are the same bytes everywhere; the system's function differs between processors.
pub fn power(x: f64, a: f64) -> f64 {
    if x > 0.0 { exponential(a * logarithm(x)) } else { 0.0 }
}

/// Natural logarithm of a positive number: `ln m + e ln 2` with `m` in `sqrt(1/2)..sqrt(2)` and `ln m = 2 artanh((m-1)/(m+1))`.
fn logarithm(x: f64) -> f64 {
    let (x, shift) = if x < f64::MIN_POSITIVE { (x * 2f64.powi(60), -60.0) } else { (x, 0.0) };
    let bits = x.to_bits();
    let mut exponent = (bits >> 52) as f64 - 1023.0;
    let mut m = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    if m > std::f64::consts::SQRT_2 {
        m *= 0.5;
        exponent += 1.0;
    }
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let mut series = 0.0;
    for k in (0..12).rev() {
        series = series * z + 1.0 / f64::from(2 * k + 1);
    }
    (exponent + shift) * std::f64::consts::LN_2 + 2.0 * s * series
}

/// Exponential: `2^k e^r` with `|r| <= ln(2)/2` and Taylor's series.
fn exponential(x: f64) -> f64 {
    /// ln 2 in two parts, the first with trailing zeros.
    const HIGH: f64 = 0.693_147_180_369_123_8;
    const LOW: f64 = 1.908_214_929_270_587_7e-10;
    let k = (x / std::f64::consts::LN_2).round();
    if k > 1023.0 {
        return f64::INFINITY;
    }
    if k < -1022.0 {
        return 0.0;
    }
    let r = (x - k * HIGH) - k * LOW;
    let mut series = 1.0;
    for i in (1..=14).rev() {
        series = 1.0 + series * r / f64::from(i);
    }
    series * f64::from_bits(((k + 1023.0) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::building::HardeningPoint;

    #[test]
    fn power_is_that_of_the_system() {
        for x in [1e-310, 1e-30, 3.7e-5, 0.5, 1.0, 1.3, 40.4, 1e6, 1e300] {
            for a in [0.2, 0.25, 1.0, 3.91, 5.0] {
                let (got, exact) = (power(x, a), x.powf(a));
                let fine = if exact < 1e-300 { got < 1e-300 } else { got == exact };
                assert!(fine || (got / exact - 1.0).abs() < 2e-13, "{x}^{a}: {got} {exact}");
            }
        }
        assert_eq!(power(0.0, 0.2), 0.0);
    }

    #[test]
    fn increment_solves_the_viscoplastic_return() {
        let point = |plastic_strain: f64, stress_pa: f64| HardeningPoint { plastic_strain, stress_pa };
        let table = HardeningTable::new(&[point(0.0, 15e6), point(0.01, 16.5e6), point(0.1, 12e6)])
            .with_rate(RateFactor { c_1_s: 40.0, p: 5.0 });
        let rate = RateFactor { c_1_s: 40.0, p: 5.0 };
        let g = 7e9;
        for p in [0.0, 0.004, 0.05, 0.3] {
            for q in [15.1e6, 17e6, 60e6, 700e6] {
                for dt in [1e-7, 1e-5, 1e-2] {
                    let most = table.plastic_increment(q, p, g, 0.8).0;
                    let (dp, _) = table.rated_increment(q, p, g, 0.8, dt);
                    assert!(dp < most);
                    let residual = q - 3.0 * g * dp - 0.8 * table.at(p + dp).0 * rate.at(dp / dt);
                    assert!(dp > 0.0 && residual.abs() < 1e-9 * q, "p={p} q={q} dt={dt}: {residual}");
                }
            }
        }
        assert_eq!(table.rated_increment(11e6, 0.0, g, 0.8, 1e-5).0, 0.0);
    }
}
