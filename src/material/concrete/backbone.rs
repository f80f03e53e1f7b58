//! The uniaxial lines as tables, for one element length.

use super::law::{CompressionCurve, ConcreteLaw, LawError, TensionCurve};
use serde::{Deserialize, Serialize};

/// Points of the compressive line from the elastic limit to the peak, and after it.
const RISING: usize = 40;
const FALLING: usize = 60;
/// Strains `s` of the exponential after which the rest, a thousandth, is cut off.
const LAST: f64 = 7.0;
/// Crack openings of Hordijk's table over the final one.
const OPENINGS: [f64; 13] = [0.0, 0.02, 0.05, 0.09, 0.14, 0.2, 0.27, 0.35, 0.44, 0.55, 0.68, 0.83, 1.0];

/// Tables of a law for elements of one length.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Backbones {
    /// Plastic strain, increasing from zero.
    plastic: Vec<f64>,
    /// Effective stress there \[Pa\].
    effective: Vec<f64>,
    /// Nominal stress there \[Pa\].
    nominal: Vec<f64>,
    /// Crack strain, increasing from zero.
    crack: Vec<f64>,
    /// Stress there \[Pa\].
    tensile: Vec<f64>,
    /// Slopes of the effective strength and of the tensile stress in each segment \[Pa\].
    effective_slope: Vec<f64>,
    tensile_slope: Vec<f64>,
}

/// What cracks remember while they open and close.
#[derive(Debug, Clone, Copy)]
pub struct Memory {
    /// Largest crack strain so far.
    pub largest: f64,
    /// Segment of the tensile line that holds it, and the stress there \[Pa\].
    pub place: usize,
    pub held_pa: f64,
    /// `λ + 2μ` \[Pa\], and one over it.
    pub modulus_pa: f64,
    pub flexibility_1_pa: f64,
    /// Crack strain over stress along the secant \[1/Pa\].
    pub secant_1_pa: f64,
}

/// A surface that falls piecewise linearly with the plastic multiplier.
#[derive(Debug, Clone, Copy)]
pub struct Falling {
    /// Value at zero \[Pa\].
    pub value: f64,
    /// Fall before and beyond the kink \[Pa\].
    pub slopes: [f64; 2],
    /// Multiplier at the kink.
    pub kink: f64,
}

impl Backbones {
    /// Tables for elements of a length \[m\].
    ///
    /// # Errors
    /// If a parameter is out of its range, or elements are so long that their elastic energy exceeds what they may dissipate.
    pub fn new(law: &ConcreteLaw, length_m: f64) -> Result<Self, LawError> {
        law.check()?;
        let line = compressive_line(law, length_m)?;
        let (e, e0) = (law.youngs_modulus_pa, law.peak_strain);
        let (mut plastic, mut effective, mut nominal) = (Vec::new(), Vec::new(), Vec::new());
        for [strain, stress] in line {
            // the residual strain that was measured, as far as damage is not negative
            let residual = (e0 * karsan_jirsa(strain / e0)).min(strain - stress / e).max(0.0);
            if plastic.last().is_none_or(|last| residual > *last) {
                plastic.push(residual);
                effective.push(e * (strain - residual));
                nominal.push(stress);
            }
        }
        plastic[0] = 0.0;
        let (crack, tensile) = tensile_line(law, length_m)?;
        let slopes = |x: &[f64], y: &[f64]| -> Vec<f64> {
            x.windows(2).zip(y.windows(2)).map(|(x, y)| (y[1] - y[0]) / (x[1] - x[0])).collect()
        };
        let (effective_slope, tensile_slope) = (slopes(&plastic, &effective), slopes(&crack, &tensile));
        Ok(Self { plastic, effective, nominal, crack, tensile, effective_slope, tensile_slope })
    }

    /// Effective stress at the elastic limit \[Pa\].
    pub fn elastic_limit_pa(&self) -> f64 {
        self.effective[0]
    }

    /// Segment of the compressive table that holds a plastic strain, sought from a guess.
    #[inline]
    pub fn segment(&self, plastic: f64, guess: usize) -> usize {
        sought(&self.plastic, plastic, guess)
    }

    /// Segment of the tensile table that holds a crack strain, sought from a guess.
    pub fn crack_segment(&self, crack: f64, guess: usize) -> usize {
        sought(&self.crack, crack, guess)
    }

    /// Effective strength `q` at a plastic strain in its segment \[Pa\].
    pub fn effective_pa(&self, plastic: f64, i: usize) -> f64 {
        self.effective[i] + self.effective_slope[i] * (plastic - self.plastic[i])
    }

    /// The plastic multiplier at which a surface above `share` of the effective strength at `plastic`, in segment `i`, meets that at `plastic + rate Δ`. It exists: the
    /// surface falls without end, and the effective strength rises.
    pub fn meet(&self, surface: Falling, [plastic, rate, share]: [f64; 3], mut i: usize) -> f64 {
        let mut delta = 0.0;
        let mut excess = surface.value - share * self.effective_pa(plastic, i);
        loop {
            let before = delta < surface.kink;
            let closing = surface.slopes[usize::from(!before)] + rate * share * self.effective_slope[i];
            let root = delta + excess / closing;
            let left = if i + 2 < self.plastic.len() { self.plastic[i + 1] - plastic } else { f64::INFINITY };
            if root * rate <= left && (!before || root <= surface.kink) {
                return root;
            }
            let segment_end = left / rate;
            let end = if before { segment_end.min(surface.kink) } else { segment_end };
            excess -= closing * (end - delta);
            delta = end;
            i += usize::from(end >= segment_end);
        }
    }

    /// Share of stress that is left at a plastic strain in its segment, `1 - d`: nominal stress is that times effective stress.
    #[inline]
    pub fn left(&self, plastic: f64, i: usize) -> f64 {
        if plastic <= 0.0 {
            return 1.0;
        }
        let (low, high) = (self.plastic[i], self.plastic[i + 1]);
        if plastic >= high && i + 2 == self.plastic.len() {
            return 0.0;
        }
        let share = (plastic - low) / (high - low);
        let along = |values: &[f64]| values[i] + share * (values[i + 1] - values[i]);
        along(&self.nominal) / along(&self.effective)
    }

    /// Tensile stress at a crack strain that was never larger, in its segment \[Pa\].
    pub fn tensile_pa(&self, crack: f64, i: usize) -> f64 {
        if crack >= self.crack[self.crack.len() - 1] {
            return 0.0;
        }
        self.tensile[i] + self.tensile_slope[i] * (crack - self.crack[i])
    }

    /// Crack strain at which `stress - modulus * c` meets the tensile line times a factor, and how much more the crack opens with more
    /// stress \[1/Pa\]. Below the largest crack strain before, the line is the secant to the origin, cut off at its height. `stress` in Pa.
    #[inline]
    pub fn opening(&self, stress: f64, factor: f64, memory: &Memory) -> [f64; 2] {
        let (known, modulus) = (factor * memory.held_pa, memory.modulus_pa);
        if stress - modulus * memory.largest <= known {
            if memory.largest <= 0.0 || stress <= 0.0 {
                return [0.0; 2];
            }
            let secant = stress * memory.secant_1_pa;
            let cut = (stress - known) * memory.flexibility_1_pa;
            return if secant >= cut { [secant, memory.secant_1_pa] } else { [cut, memory.flexibility_1_pa] };
        }
        let (mut c0, mut t0) = (memory.largest, known);
        if c0 < self.crack[self.crack.len() - 1] {
            for i in memory.place..self.tensile_slope.len() {
                let (c1, t1) = (self.crack[i + 1], factor * self.tensile[i + 1]);
                if stress - modulus * c1 <= t1 {
                    let slope = 1.0 / (modulus + factor * self.tensile_slope[i]);
                    return [c0 + (stress - modulus * c0 - t0) * slope, slope];
                }
                (c0, t0) = (c1, t1);
            }
        }
        [stress * memory.flexibility_1_pa, memory.flexibility_1_pa]
    }
}

/// The segment `i` of increasing places with `x[i] <= at < x[i + 1]`, the first or the last for what lies outside.
fn sought(x: &[f64], at: f64, guess: usize) -> usize {
    let last = x.len() - 2;
    let mut i = guess.min(last);
    while i > 0 && x[i] > at {
        i -= 1;
    }
    while i < last && x[i + 1] <= at {
        i += 1;
    }
    i
}

/// Residual over peak strain after Karsan and Jirsa.
fn karsan_jirsa(r: f64) -> f64 {
    if r <= 2.0 { (0.145 * r + 0.13) * r } else { 0.707 * (r - 2.0) + 0.834 }
}

/// `[strain, stress]` from the elastic limit to zero.
fn compressive_line(law: &ConcreteLaw, length_m: f64) -> Result<Vec<[f64; 2]>, LawError> {
    let share = match &law.compression {
        CompressionCurve::Points(points) => return Ok(points.clone()),
        CompressionCurve::Standard { elastic_share } => *elastic_share,
    };
    let (e, fc, e0) = (law.youngs_modulus_pa, law.compressive_strength_pa, law.peak_strain);
    let limit = share * fc;
    let span = e0 - limit / e;
    // tangent E at the elastic limit, zero at the peak
    let power = e * span / (fc - limit);
    let rising = (0..=RISING).map(|i| {
        let left = 1.0 - i as f64 / RISING as f64;
        [e0 - span * left, fc - (fc - limit) * libm::pow(left, power)]
    });
    let mut line: Vec<[f64; 2]> = rising.collect();
    let before = 0.5 * limit * limit / e + area(&line);
    let allowed = law.crushing_energy_j_m2 / length_m;
    let falling: Vec<[f64; 2]> = (1..=FALLING)
        .map(|i| {
            let x = LAST * i as f64 / FALLING as f64;
            let end = libm::exp(-LAST);
            [x, (libm::exp(-x) - end) / (1.0 - end)]
        })
        .collect();
    let unit = area(&falling) + 0.5 * falling[0][0] * (1.0 + falling[0][1]);
    let width = (allowed - before) / (fc * unit);
    let least = 1.05 * fc / e; // steeper, it would snap back
    if width < least {
        let longest = law.crushing_energy_j_m2 / (before + least * fc * unit);
        return Err(LawError {
            name: "element length (m)",
            value: length_m,
            expected: format!("at most {longest:.3} m for this crushing energy"),
        });
    }
    line.extend(falling.iter().map(|[x, y]| [e0 + width * x, fc * y]));
    Ok(line)
}

/// Crack strains and stresses from the strength to zero.
fn tensile_line(law: &ConcreteLaw, length_m: f64) -> Result<(Vec<f64>, Vec<f64>), LawError> {
    if let TensionCurve::Points(points) = &law.tension {
        return Ok(points.iter().map(|p| (p[0], p[1])).unzip());
    }
    let hordijk = |x: f64| {
        let tail = libm::exp(-6.93);
        (1.0 + 27.0 * x * x * x) * libm::exp(-6.93 * x) - x * 28.0 * tail
    };
    let shape: Vec<[f64; 2]> = OPENINGS.iter().map(|x| [*x, hordijk(*x).max(0.0)]).collect();
    let ft = law.tensile_strength_pa;
    let last = law.fracture_energy_j_m2 / (ft * area(&shape) * length_m);
    let steepest = shape.windows(2).map(|p| (p[0][1] - p[1][1]) / (p[1][0] - p[0][0])).fold(0.0, f64::max);
    if steepest * ft / last > 0.9 * law.youngs_modulus_pa {
        let longest = 0.9 * law.youngs_modulus_pa * last * length_m / (steepest * ft);
        return Err(LawError {
            name: "element length (m)",
            value: length_m,
            expected: format!("at most {longest:.3} m for this fracture energy"),
        });
    }
    Ok(shape.iter().map(|[x, y]| (x * last, y * ft)).unzip())
}

/// Area below a line.
fn area(line: &[[f64; 2]]) -> f64 {
    line.windows(2).map(|p| 0.5 * (p[0][1] + p[1][1]) * (p[1][0] - p[0][0])).sum()
}
