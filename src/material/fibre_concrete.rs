//! Concrete of a fibre section: confinement by ties and the curves of stress over strain.
//!
//! Compression is positive. Confinement after Mander, Priestley and Park (1988, J. Struct. Eng. 114(8), eq. 6, 19-29) for rectangular ties: the effective part of the
//! core from the arches between the bars that ties hold and between the ties, `k_e = (1 − Σ w'² / (6 b_c d_c)) (1 − s' / 2 b_c) (1 − s' / 2 d_c) / (1 − ρ_cc)`; the
//! pressure `f_l = k_e f_yh (ρ_x + ρ_y) / 2`, averaged over both directions; `f_cc = f_c (−1.254 + 2.254 sqrt(1 + 7.94 f_l / f_c) − 2 f_l / f_c)`,
//! `ε_cc = ε_co (1 + 5 (f_cc / f_c − 1))` with `ε_co = max(0.002, 1.1 f_c / E_c)`, and the strain at which the first tie ruptures `ε_cu = 0.004 + 1.4 ρ_s f_yh ε_su / f_cc` (Priestley, Seible and Calvi 1996).
//! The core is bounded by the centre line of the ties.

use super::fibre::SectionInput;
use super::rate::power;
use super::section_capacity::ConcreteLimits;
use crate::building::Bar;
use serde::{Deserialize, Serialize};

/// Strain of unconfined concrete at its strength, as long as its modulus allows for it ([`strain_co`]).
const STRAIN_CO: f64 = 0.002;
/// Least initial modulus over the secant modulus at the strength: Popovics' exponent `r = 1 / (1 − E_sec / E_c)` has a pole at 1, which a strain of 0.002 meets at
/// 100 MPa.
const LEAST_MODULUS_RATIO: f64 = 1.1;
/// Strain at which unconfined concrete has spalled.
const STRAIN_SPALLED: f64 = 0.005;

/// Ties of a rectangular section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TieInput {
    /// Diameter \[m\].
    pub diameter_m: f64,
    /// Spacing along the member, centre to centre \[m\].
    pub spacing_m: f64,
    /// Yield strength \[Pa\].
    pub yield_strength_pa: f64,
    /// Strain at rupture.
    pub ultimate_strain: f64,
    /// Legs along the width and along the depth.
    pub legs: [f64; 2],
    /// Concrete outside the ties \[m\].
    pub cover_m: f64,
    /// Whether ties hold each bar of the outer layer; otherwise the corner bars only.
    pub all_bars_held: bool,
}

/// What the ties do for the core.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Confinement {
    /// Core along the width and the depth, to the centre line of the ties \[m\].
    pub core_m: [f64; 2],
    /// Effectiveness k_e.
    pub effectiveness: f64,
    /// Volume of ties over volume of core.
    pub tie_ratio: f64,
    /// Effective pressure f_l \[Pa\].
    pub pressure_pa: f64,
    /// Confined strength f_cc \[Pa\].
    pub strength_pa: f64,
    /// Strain at it.
    pub strain: f64,
    /// Strain at the first rupture of a tie.
    pub ultimate_strain: f64,
}

impl Confinement {
    /// The ties' work on a section's core; `None` without ties.
    pub fn of(input: &SectionInput) -> Option<Self> {
        let ties = input.ties?;
        let centre = ties.cover_m + 0.5 * ties.diameter_m;
        let core_m = input.size_m.map(|side| side - 2.0 * centre);
        let area = 0.25 * std::f64::consts::PI * ties.diameter_m * ties.diameter_m;
        // legs along one direction act on the side of the core normal to it
        let ratios = [0, 1].map(|i| ties.legs[i] * area / (ties.spacing_m * core_m[1 - i]));
        let box_m2 = core_m[0] * core_m[1];
        let clear = ties.spacing_m - ties.diameter_m;
        let arches = 1.0 - sum_of_squared_gaps_m2(&input.bars, core_m, ties.all_bars_held) / (6.0 * box_m2);
        let between = core_m.map(|side| (1.0 - 0.5 * clear / side).max(0.0));
        let steel: f64 = input.bars.iter().map(area_m2).sum();
        let effectiveness = arches.max(0.0) * between[0] * between[1] / (1.0 - steel / box_m2);
        let pressure_pa = effectiveness * ties.yield_strength_pa * 0.5 * (ratios[0] + ratios[1]);
        let fc = input.concrete_strength_pa;
        let p = pressure_pa / fc;
        let gain = -1.254 + 2.254 * (1.0 + 7.94 * p).sqrt() - 2.0 * p;
        let tie_ratio = ratios[0] + ratios[1];
        let tough = 1.4 * tie_ratio * ties.yield_strength_pa * ties.ultimate_strain;
        Some(Self {
            core_m,
            effectiveness,
            tie_ratio,
            pressure_pa,
            strength_pa: gain * fc,
            strain: strain_co(fc) * (1.0 + 5.0 * (gain - 1.0)),
            ultimate_strain: 0.004 + tough / (gain * fc),
        })
    }
}

/// Initial modulus of Mander's concrete, `5000 sqrt(f_c / MPa)` MPa \[Pa\].
fn modulus_pa(strength_pa: f64) -> f64 {
    5000e6 * (strength_pa / 1e6).sqrt()
}

/// Strain of unconfined concrete at its strength \[Pa\], `max(0.002, 1.1 f_c / E_c)`: 0.002 up to 82.6 MPa, 0.0027 at 150 MPa.
fn strain_co(strength_pa: f64) -> f64 {
    STRAIN_CO.max(LEAST_MODULUS_RATIO * strength_pa / modulus_pa(strength_pa))
}

/// Area of a bar \[m²\].
pub(super) fn area_m2(bar: &Bar) -> f64 {
    0.25 * std::f64::consts::PI * bar.diameter_m * bar.diameter_m
}

/// Share of the core within which the bars of a face lie.
const FACE: f64 = 0.25;
/// Bars nearer than this many diameters to each other along a face are one behind the other.
const BEHIND: f64 = 0.75;

/// Σ w'² over the four faces \[m²\]: clear distances between neighbouring bars that are held, and from the last one to the corner of the core where no bar stands in that.
fn sum_of_squared_gaps_m2(bars: &[Bar], core_m: [f64; 2], all_held: bool) -> f64 {
    let faces = [0, 1].into_iter().flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
    let of_face = |(axis, side): (usize, f64)| -> f64 {
        let place = |b: &Bar| side * [b.x_m, b.y_m][axis];
        let mut face: Vec<(f64, f64)> = bars
            .iter()
            .filter(|b| place(b) > (0.5 - FACE) * core_m[axis])
            .map(|b| ([b.y_m, b.x_m][axis], b.diameter_m))
            .collect();
        face.sort_by(|a, b| a.0.total_cmp(&b.0));
        face.dedup_by(|b, a| b.0 - a.0 < BEHIND * a.1);
        if !all_held && face.len() > 2 {
            face = vec![face[0], face[face.len() - 1]];
        }
        let half_m = 0.5 * core_m[1 - axis];
        let (Some(first), Some(last)) = (face.first(), face.last()) else { return 4.0 * half_m * half_m };
        // a bar in a corner lies at the tie
        let ends = [(half_m + first.0, first.1), (half_m - last.0, last.1)];
        let open = ends.into_iter().map(|(way, d)| (way - 0.5 * d, d)).filter(|(gap, d)| gap > d);
        let between = face.windows(2).map(|w| w[1].0 - w[0].0 - 0.5 * (w[0].1 + w[1].1));
        between.chain(open.map(|(gap, _)| gap)).map(|gap| gap.max(0.0).powi(2)).sum()
    };
    faces.map(of_face).sum()
}

/// Which curves core and cover follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConcreteLaw {
    /// Parabola and rectangle of EN 1992-1-1, 3.1.7 ([`ConcreteLimits`]); no confinement, no tension.
    ParabolaRectangle,
    /// Popovics' curve with `E_c = 5000 sqrt(f_c / MPa)` MPa and its peak at `max(0.002, 1.1 f_c / E_c)`: core with the values of [`Confinement`], nothing beyond `ε_cu`; cover nothing beyond
    /// 0.005 (Mander, Priestley and Park 1988, eq. 3-7). No tension.
    Mander,
    /// Modified Kent-Park (Scott, Park and Priestley 1982): core `K f_c`, `K = 1 + ρ_s f_yh / f_c`, at `0.002 K`; falling line; rest 0.2. Tension `f_t`, softening with a
    /// tenth of the initial modulus.
    KentPark,
}

/// Stress over strain of one concrete; compression positive.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ConcreteCurve {
    /// Parabola and rectangle.
    ParabolaRectangle {
        /// Strength \[Pa\].
        strength_pa: f64,
    },
    /// `σ = f x r / (r − 1 + x^r)`, `x = ε / ε_peak`, `r = E_c / (E_c − f / ε_peak)` (Popovics 1973).
    Popovics {
        /// Strength \[Pa\].
        strength_pa: f64,
        /// Strain at it.
        strain: f64,
        /// Exponent r.
        exponent: f64,
        /// Strain beyond which there is no stress.
        end_strain: f64,
    },
    /// Parabola, falling line, constant rest.
    KentPark {
        /// Strength \[Pa\].
        strength_pa: f64,
        /// Strain at it.
        strain: f64,
        /// Strain at a fifth of the strength.
        strain_20: f64,
        /// Tensile strength \[Pa\].
        tensile_strength_pa: f64,
    },
}

impl ConcreteCurve {
    /// Curves of core and cover; both unconfined without ties.
    pub fn pair(law: ConcreteLaw, input: &SectionInput) -> [Self; 2] {
        let confined = Confinement::of(input);
        let fc = input.concrete_strength_pa;
        match law {
            ConcreteLaw::ParabolaRectangle => [Self::ParabolaRectangle { strength_pa: fc }; 2],
            ConcreteLaw::Mander => {
                let modulus = modulus_pa(fc);
                let cover = Self::popovics(fc, strain_co(fc), modulus, STRAIN_SPALLED);
                let core = confined
                    .map_or(cover, |c| Self::popovics(c.strength_pa, c.strain, modulus, c.ultimate_strain));
                [core, cover]
            }
            ConcreteLaw::KentPark => {
                let (mpa, tension) = (fc / 1e6, input.tensile_strength_pa);
                let plain = (3.0 + 0.29 * mpa) / (145.0 * mpa - 1000.0);
                let cover = Self::kent_park(fc, 1.0, plain, tension);
                let core = input.ties.zip(confined).map_or(cover, |(ties, c)| {
                    let k = 1.0 + c.tie_ratio * ties.yield_strength_pa / fc;
                    let side = c.core_m[0].min(c.core_m[1]);
                    let tough = 0.75 * c.tie_ratio * (side / ties.spacing_m).sqrt();
                    Self::kent_park(fc, k, plain + tough, tension)
                });
                [core, cover]
            }
        }
    }

    fn popovics(strength_pa: f64, strain: f64, modulus_pa: f64, end_strain: f64) -> Self {
        let exponent = modulus_pa / (modulus_pa - strength_pa / strain);
        Self::Popovics { strength_pa, strain, exponent, end_strain }
    }

    /// `half`: strain at half of the strength.
    fn kent_park(fc: f64, k: f64, half: f64, tensile_strength_pa: f64) -> Self {
        let strain = STRAIN_CO * k;
        let strain_20 = strain + 0.8 * (half - strain) / 0.5;
        Self::KentPark { strength_pa: k * fc, strain, strain_20, tensile_strength_pa }
    }

    /// Strain beyond which there is no stress for ever.
    pub fn end_strain(&self) -> f64 {
        match *self {
            Self::ParabolaRectangle { strength_pa } => ConcreteLimits::of(strength_pa).strain_cu2,
            Self::Popovics { end_strain, .. } => end_strain,
            Self::KentPark { .. } => f64::INFINITY,
        }
    }

    /// Stress \[Pa\] at a strain.
    pub fn stress_pa(&self, strain: f64) -> f64 {
        if strain > self.end_strain() {
            return 0.0;
        }
        match *self {
            Self::ParabolaRectangle { strength_pa } => {
                strength_pa * ConcreteLimits::of(strength_pa).share(strain)
            }
            Self::Popovics { strength_pa, strain: peak, exponent, .. } => {
                let x = strain / peak;
                let bent = exponent - 1.0 + power(x, exponent);
                if strain <= 0.0 { 0.0 } else { strength_pa * x * exponent / bent }
            }
            Self::KentPark { strength_pa, strain: peak, strain_20, tensile_strength_pa } => {
                let modulus = 2.0 * strength_pa / peak;
                if strain < 0.0 {
                    let rise = -modulus * strain;
                    let fall = 1.1 * tensile_strength_pa + 0.1 * modulus * strain;
                    return -rise.min(fall).max(0.0);
                }
                let x = strain / peak;
                if x <= 1.0 {
                    return strength_pa * x * (2.0 - x);
                }
                strength_pa * (1.0 - 0.8 * (strain - peak) / (strain_20 - peak)).max(0.2)
            }
        }
    }
}
