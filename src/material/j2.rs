//! J2 plasticity with piecewise linear isotropic hardening.
//!
//! Yield condition `q(σ) <= σ_y(p)` with the von Mises stress `q = sqrt(3/2 s:s)` and the equivalent plastic
//! strain `p`. Radial return (Wilkins 1964; Simo and Hughes 1998, box 3.1): the trial stress deviator is
//! scaled by `σ_y(p + Δp) / q_trial` with `Δp` from the scalar equation
//! `q_trial - 3 G Δp = σ_y(p + Δp)`, solved exactly over the kinks of the table. A table may carry a rate factor ([`super::rate`]).
//!
//! Where a table falls by `3 G` or more per plastic strain its stress goes faster than the elastic relief: there is no equilibrium on that segment, and the
//! stress drops within the step onto the first segment behind it that has one. The last segment is flat, so there always is.
//!
//! A bar is the same law in one direction: there `E` stands in the place of `3 G`.

use super::rate::RateFactor;
use crate::building::HardeningPoint;
use serde::{Deserialize, Serialize};

/// A hardening table as straight segments: `σ_y = stress + slope (p - strain)` from `strain` to the
/// next segment's `strain`; the last segment is flat and has no end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HardeningTable {
    segments: Vec<Segment>,
    rate: Option<RateFactor>,
}

/// One straight piece.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Segment {
    strain: f64,
    stress_pa: f64,
    slope_pa: f64,
}

impl HardeningTable {
    /// Builds the table from checked points (first strain zero, strains increasing, stresses positive); without points
    /// the material never yields.
    pub fn new(points: &[HardeningPoint]) -> Self {
        if points.is_empty() {
            let never = Segment { strain: 0.0, stress_pa: f64::INFINITY, slope_pa: 0.0 };
            return Self { segments: vec![never], rate: None };
        }
        let segments = (0..points.len())
            .map(|i| {
                let here = points[i];
                let slope_pa = points.get(i + 1).map_or(0.0, |next| {
                    (next.stress_pa - here.stress_pa) / (next.plastic_strain - here.plastic_strain)
                });
                Segment { strain: here.plastic_strain, stress_pa: here.stress_pa, slope_pa }
            })
            .collect();
        Self { segments, rate: None }
    }

    /// The table with a rate factor.
    #[must_use]
    pub fn with_rate(self, rate: RateFactor) -> Self {
        Self { rate: Some(rate), ..self }
    }

    /// Whether the yield stress depends on the rate.
    #[inline(always)]
    pub fn has_rate(&self) -> bool {
        self.rate.is_some()
    }

    /// Smallest yield stress of the table \[Pa\].
    pub fn lowest_stress_pa(&self) -> f64 {
        self.segments.iter().map(|s| s.stress_pa).fold(f64::INFINITY, f64::min)
    }

    /// Yield stress \[Pa\] and hardening modulus \[Pa\] at an equivalent plastic strain.
    pub fn at(&self, plastic_strain: f64) -> (f64, f64) {
        let index = self.segments.partition_point(|s| s.strain <= plastic_strain).max(1) - 1;
        let s = self.segments[index];
        (s.stress_pa + s.slope_pa * (plastic_strain - s.strain), s.slope_pa)
    }

    /// Solves `q_trial - 3 G Δp = scale σ_y(p + Δp)`; returns `(Δp, hardening modulus at the end)`, both
    /// already including `scale`. `Δp = 0` where the trial stress is admissible.
    pub fn plastic_increment(
        &self,
        q_trial_pa: f64,
        plastic_strain: f64,
        shear_modulus_pa: f64,
        scale: f64,
    ) -> (f64, f64) {
        let (yield_now, slope_now) = self.at(plastic_strain);
        if q_trial_pa <= scale * yield_now {
            return (0.0, scale * slope_now);
        }
        let first = self.segments.partition_point(|s| s.strain <= plastic_strain).max(1) - 1;
        for (index, s) in self.segments.iter().enumerate().skip(first) {
            let yield_here = scale * (s.stress_pa + s.slope_pa * (plastic_strain - s.strain));
            let stiffness = 3.0 * shear_modulus_pa + scale * s.slope_pa;
            if stiffness <= 0.0 {
                continue;
            }
            let increment = (q_trial_pa - yield_here) / stiffness;
            let end = self.end_of(index);
            if plastic_strain + increment <= end {
                return (increment.max(0.0), scale * s.slope_pa);
            }
        }
        (0.0, 0.0) // not a number
    }

    /// [`Self::plastic_increment`] of eight points at once, the same bytes: `increment` and `slope` receive the results.
    #[inline(always)]
    pub fn plastic_increments(
        &self,
        q_trial_pa: &[f64; 8],
        plastic_strain: &[f64; 8],
        shear_modulus_pa: &[f64; 8],
        scale: &[f64; 8],
        increment: &mut [f64; 8],
        slope: &mut [f64; 8],
    ) {
        // tables so steep are rare: they are no part of the loop over lanes below
        let steepest = self.segments.iter().map(|s| s.slope_pa).fold(0.0, f64::min);
        if steepest < 0.0 && (0..8).any(|l| 3.0 * shear_modulus_pa[l] + scale[l] * steepest <= 0.0) {
            for l in 0..8 {
                (increment[l], slope[l]) =
                    self.plastic_increment(q_trial_pa[l], plastic_strain[l], shear_modulus_pa[l], scale[l]);
            }
            return;
        }
        let mut open = [1.0; 8];
        for (index, s) in self.segments.iter().enumerate() {
            let end = self.end_of(index);
            if (0..8).all(|l| open[l] == 0.0 || plastic_strain[l] >= end) {
                continue;
            }
            for l in 0..8 {
                let p = plastic_strain[l];
                let here = scale[l] * (s.stress_pa + s.slope_pa * (p - s.strain));
                let stiffness = 3.0 * shear_modulus_pa[l] + scale[l] * s.slope_pa;
                let found = (q_trial_pa[l] - here) / stiffness;
                let hit = open[l] == 1.0 && p < end && p + found <= end;
                increment[l] = if hit { if found > 0.0 { found } else { 0.0 } } else { increment[l] };
                slope[l] = if hit { scale[l] * s.slope_pa } else { slope[l] };
                open[l] = if hit { 0.0 } else { open[l] };
            }
        }
    }

    /// [`Self::plastic_increment`] of a step of `dt_s` \[s\] with the rate factor of its plastic strain rate; the hardening modulus is the derivative of the stress by the plastic strain of the step, which that factor makes steep where little flows.
    pub fn rated_increment(
        &self,
        q_trial_pa: f64,
        plastic_strain: f64,
        shear_modulus_pa: f64,
        scale: f64,
        dt_s: f64,
    ) -> (f64, f64) {
        let (most, slope) = self.plastic_increment(q_trial_pa, plastic_strain, shear_modulus_pa, scale);
        if most > 0.0 {
            self.with_rate_factor([q_trial_pa, plastic_strain], shear_modulus_pa, scale, dt_s, most)
        } else {
            (most, slope)
        }
    }

    /// [`Self::rated_increment`] where the increment `most > 0` without rate factor is already known.
    #[inline(never)]
    pub(crate) fn with_rate_factor(
        &self,
        [q_trial_pa, plastic_strain]: [f64; 2],
        shear_modulus_pa: f64,
        scale: f64,
        dt_s: f64,
        most: f64,
    ) -> (f64, f64) {
        let Some(rate) = self.rate else { return (most, scale * self.at(plastic_strain + most).1) };
        let trial = [q_trial_pa, plastic_strain];
        let (found, factor) = rate.increment(self, trial, shear_modulus_pa, scale, dt_s, most);
        let (stress_pa, slope_pa) = self.at(plastic_strain + found);
        // d/dΔp of σ_y (1 + y) with y = (Δp / (C Δt))^(1/P)
        let grows_pa = if found > 0.0 { stress_pa * (factor - 1.0) / (rate.p * found) } else { 0.0 };
        (found, scale * (slope_pa * factor + grows_pa))
    }

    /// Plastic strain at which a segment ends.
    fn end_of(&self, index: usize) -> f64 {
        self.segments.get(index + 1).map_or(f64::INFINITY, |next| next.strain)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> HardeningTable {
        HardeningTable::new(&[
            HardeningPoint { plastic_strain: 0.0, stress_pa: 15e6 },
            HardeningPoint { plastic_strain: 0.01, stress_pa: 16.5e6 },
            HardeningPoint { plastic_strain: 0.1, stress_pa: 12e6 },
        ])
    }

    #[test]
    fn return_lands_on_the_table_across_kinks() {
        let g = 7e9;
        for p in [0.0, 0.004, 0.01, 0.05, 0.3] {
            for q in [15.1e6, 17e6, 60e6, 700e6, 5e9] {
                let (dp, _) = table().plastic_increment(q, p, g, 0.8);
                let (mut eight, mut slopes) = ([0.0; 8], [0.0; 8]);
                table().plastic_increments(&[q; 8], &[p; 8], &[g; 8], &[0.8; 8], &mut eight, &mut slopes);
                assert_eq!((eight[3], slopes[5]), table().plastic_increment(q, p, g, 0.8));
                let residual = q - 3.0 * g * dp - 0.8 * table().at(p + dp).0;
                assert!(dp == 0.0 && residual <= 0.0 || residual.abs() < 1e-3, "p={p} q={q}: {residual}");
            }
        }
    }

    /// A fall from 400 to 100 MPa within 1e-4, with `3 G` of 231 GPa (a bar: `E` of 200 GPa), between segments that rise and fall slowly.
    #[test]
    fn a_fall_steeper_than_elastic_relief_ends_on_the_next_segment() {
        let point = |plastic_strain: f64, stress_pa: f64| HardeningPoint { plastic_strain, stress_pa };
        let table = HardeningTable::new(&[
            point(0.0, 400e6),
            point(0.001, 410e6),
            point(0.0011, 100e6),
            point(0.5, 90e6),
        ]);
        for g in [200e9 / 3.0, 77e9] {
            for p in [0.0, 0.0009, 0.00105, 0.0011, 0.2, 0.6] {
                for scale in [1.0, 0.7] {
                    for over in [-0.1, 1e-6, 0.01, 0.3, 10.0] {
                        let q = scale * table.at(p).0 * (1.0 + over);
                        let (dp, slope) = table.plastic_increment(q, p, g, scale);
                        let (mut eight, mut slopes) = ([0.0; 8], [0.0; 8]);
                        table.plastic_increments(
                            &[q; 8],
                            &[p; 8],
                            &[g; 8],
                            &[scale; 8],
                            &mut eight,
                            &mut slopes,
                        );
                        assert_eq!((eight[2], slopes[7]), (dp, slope));
                        assert_eq!(dp > 0.0, over > 0.0, "p={p} over={over}");
                        let residual = q - 3.0 * g * dp - scale * table.at(p + dp).0;
                        assert!(dp == 0.0 || residual.abs() < 1.0, "p={p} q={q}: {residual}");
                        assert!(dp == 0.0 || 3.0 * g + slope > 0.0, "p={p} q={q}: {slope}");
                    }
                }
            }
        }
        // the whole fall in one step, from the strength
        let (dp, _) = HardeningTable::new(&[point(0.0, 400e6), point(1e-4, 100e6)]).plastic_increment(
            401e6,
            0.0,
            200e9 / 3.0,
            1.0,
        );
        assert!((dp - 301e6 / 200e9).abs() < 1e-12, "{dp}");
    }
}
