//! Stress update at a material point.

use super::backbone::{Backbones, Falling};
use super::law::{ConcreteLaw, LawError};
use super::principal::{assemble, principal};
use crate::material::rate::power;
use serde::{Deserialize, Serialize};

/// Largest strain increment of a sub-step, over the cracking strain.
const SUB_STEP: f64 = 0.25;
/// Most sub-steps of an increment: beyond, each is larger. The return exists for any increment.
const MOST_SUB_STEPS: f64 = 64.0;
/// Sweeps over the three cracks; they converge by `(λ / (λ + 2μ))²` a sweep.
const CRACK_SWEEPS: usize = 24;
/// Returns to the surface of compression in a sub-step, while cracks close.
const FLOW_ROUNDS: usize = 8;
/// Ratio of lateral pressure and strength measure beyond which ductility grows no more.
const CONFINED_LIMIT: f64 = 1.0;

/// Distance of cracks over which the strain of Vecchio and Collins is a mean: that of EN 1992-1-1, eq. 7.11, for 40 mm of cover and 20 mm bars, 2 % of the tension zone \[m\].
const CRACK_SPACING_M: f64 = 0.3;

/// What a point of the concrete remembers. Components: xx, yy, zz, xy, yz, zx.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ConcreteState {
    /// Strain less plastic strain, tensor components.
    pub mechanical: [f64; 6],
    /// Hardening variable of compression: plastic strain in uniaxial terms.
    pub plastic: f64,
    /// Largest crack strain so far.
    pub crack: f64,
    /// Share of the secant of cracks that compression across them has taken so far.
    pub crack_loss: f64,
}

/// A law for elements of one length, ready for the time loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConcretePoint {
    lambda: f64,
    mu: f64,
    /// Compressive strength \[Pa\].
    strength: f64,
    tensile: f64,
    alpha: f64,
    gamma: f64,
    lode: f64,
    dilation: f64,
    ductility: f64,
    reduction: f64,
    /// Loss of strength beside cracks, and mean strain over several cracks over the peak strain for a crack strain of one.
    softening: f64,
    crack_ratio: f64,
    lines: Backbones,
}

/// Cracks at principal strains.
struct Cracked {
    /// Effective principal stresses \[Pa\].
    effective: [f64; 3],
    /// Crack strains.
    crack: [f64; 3],
    /// Factor on the tensile line.
    factor: f64,
}

impl ConcretePoint {
    /// A law for elements of a length \[m\].
    ///
    /// # Errors
    /// As [`Backbones::new`].
    pub fn new(law: &ConcreteLaw, length_m: f64) -> Result<Self, LawError> {
        let (e, nu) = (law.youngs_modulus_pa, law.poisson_ratio);
        let (r, k) = (law.surface.biaxial_ratio, law.surface.meridian_ratio);
        let lines = Backbones::new(law, length_m)?;
        Ok(Self {
            lambda: e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
            mu: 0.5 * e / (1.0 + nu),
            strength: law.compressive_strength_pa,
            tensile: lines.tensile_pa(0.0),
            alpha: (r - 1.0) / (2.0 * r - 1.0),
            gamma: 3.0 * (1.0 - k) / (2.0 * k - 1.0),
            lode: law.surface.lode_amplitude,
            dilation: law.surface.dilation,
            ductility: law.surface.confined_ductility,
            reduction: law.surface.tension_reduction,
            softening: law.surface.crack_softening,
            crack_ratio: (length_m / CRACK_SPACING_M).min(1.0) / law.peak_strain,
            lines,
        })
    }

    /// Lamé's constants λ, μ \[Pa\].
    pub fn lame_pa(&self) -> [f64; 2] {
        [self.lambda, self.mu]
    }

    /// Uniaxial compressive and tensile strength \[Pa\].
    pub fn strengths_pa(&self) -> [f64; 2] {
        [self.strength, self.tensile]
    }

    /// Damage by crushing, 0 to 1.
    pub fn damage(&self, state: &ConcreteState) -> f64 {
        self.lines.damage(state.plastic)
    }

    /// Nominal stress after a strain increment (tensor components) \[Pa\].
    pub fn respond(&self, state: &mut ConcreteState, increment: &[f64; 6]) -> [f64; 6] {
        let old = state.mechanical;
        for (strain, step) in state.mechanical.iter_mut().zip(increment) {
            *strain += step;
        }
        if state.crack == 0.0
            && state.plastic == 0.0
            && let Some(stress) = self.elastic(&state.mechanical)
        {
            return stress;
        }
        let squares: [f64; 6] = increment.map(|s| s * s);
        let normal = squares[0] + squares[1] + squares[2];
        let largest = (normal + 2.0 * (squares[3] + squares[4] + squares[5])).sqrt(); // the same in all axes
        let unit = SUB_STEP * self.tensile / (self.lambda + 2.0 * self.mu);
        let count = (largest / unit).ceil().clamp(1.0, MOST_SUB_STEPS);
        let mut stress = [0.0; 6];
        let whole = state.mechanical;
        state.mechanical = old;
        for _ in 0..count as usize {
            for i in 0..6 {
                state.mechanical[i] += (whole[i] - old[i]) / count;
            }
            stress = self.inelastic(state);
        }
        stress
    }

    /// The elastic stress \[Pa\], if bounds by the invariants show that nothing can crack or flow.
    fn elastic(&self, strain: &[f64; 6]) -> Option<[f64; 6]> {
        let trace = strain[0] + strain[1] + strain[2];
        let stress: [f64; 6] = std::array::from_fn(|i| {
            2.0 * self.mu * strain[i] + if i < 3 { self.lambda * trace } else { 0.0 }
        });
        let mean = (stress[0] + stress[1] + stress[2]) / 3.0;
        let (a, b, c) = (stress[0] - stress[1], stress[1] - stress[2], stress[2] - stress[0]);
        let shear = stress[3] * stress[3] + stress[4] * stress[4] + stress[5] * stress[5];
        let mises = (0.5 * (a * a + b * b + c * c) + 3.0 * shear).sqrt();
        // principal stresses are within 2/3 of the Mises stress of the mean
        let (most, least) = (mean + 2.0 / 3.0 * mises, mean - 2.0 / 3.0 * mises);
        let compressive = (self.alpha * 3.0 * mean + (1.0 + self.lode) * mises) / (1.0 - self.alpha);
        let fits =
            most <= self.tensile * self.tension_factor(least) && compressive <= self.lines.elastic_limit_pa();
        fits.then_some(stress)
    }

    /// Share of the tensile strength that is left beside a smallest principal stress \[Pa\].
    fn tension_factor(&self, least: f64) -> f64 {
        let share = (-least / self.strength).clamp(0.0, 1.0);
        1.0 - self.reduction * share
    }

    /// Stress in the full law; the state has the mechanical strain before cracks and plastic flow.
    fn inelastic(&self, state: &mut ConcreteState) -> [f64; 6] {
        let (mut strain, q) = principal(&state.mechanical);
        let mut left = 1.0 - self.lines.damage(state.plastic);
        let mut cracked = self.cracked(&strain, state, left);
        // cracks that close while it flows leave it outside of the surface
        for _ in 0..FLOW_ROUNDS {
            let share = self.beside_cracks(&cracked.crack);
            let Some((plastic, hardened)) = self.compressed(&cracked.effective, state.plastic, share) else {
                break;
            };
            for i in 0..3 {
                strain[i] -= plastic[i];
            }
            state.plastic = hardened;
            state.mechanical = assemble(strain, &q);
            left = 1.0 - self.lines.damage(hardened);
            cracked = self.cracked(&strain, state, left);
        }
        let largest = state.crack;
        for c in cracked.crack.into_iter().filter(|c| *c > 0.0) {
            state.crack = state.crack.max(c);
            state.crack_loss = state.crack_loss.max(1.0 - cracked.factor * (largest / c).max(1.0));
        }
        assemble(cracked.effective.map(|s| left * s), &q)
    }

    /// Share of the compressive strength that is left beside cracks.
    fn beside_cracks(&self, crack: &[f64; 3]) -> f64 {
        let widest = crack.iter().fold(0.0, |m: f64, c| m.max(*c));
        let excess = self.crack_ratio * widest - 0.28;
        if self.softening > 0.0 && excess > 0.0 {
            1.0 / (1.0 + self.softening * power(excess, 0.8))
        } else {
            1.0
        }
    }

    /// Effective principal stresses and cracks at principal mechanical strains. `left` is `1 - d`. Where compression across a crack cuts its secant
    /// off, the secant stays so low: otherwise a crack opened under compression and closed without it would give energy away.
    fn cracked(&self, strain: &[f64; 3], state: &ConcreteState, left: f64) -> Cracked {
        let modulus = self.lambda + 2.0 * self.mu;
        let stress = |crack: &[f64; 3], i: usize| {
            let open: f64 = (0..3).map(|j| strain[j] - crack[j]).sum();
            self.lambda * open + 2.0 * self.mu * (strain[i] - crack[i])
        };
        let kept = 1.0 - state.crack_loss;
        let (mut crack, mut factor) = ([0.0; 3], kept);
        if strain[0] > 0.0 {
            for _ in 0..CRACK_SWEEPS {
                let mut change: f64 = 0.0;
                factor = self.tension_factor(left * stress(&crack, 2)).min(kept);
                for i in 0..3 {
                    let closed = stress(&crack, i) + modulus * crack[i];
                    let open = self.lines.opening(closed, modulus, state.crack, [kept, factor]);
                    change = change.max((open - crack[i]).abs());
                    crack[i] = open;
                }
                if change * modulus <= 1e-6 * self.tensile {
                    break;
                }
            }
        }
        Cracked { effective: std::array::from_fn(|i| stress(&crack, i)), crack, factor }
    }

    /// Principal plastic strains and the hardening variable after the return to the surface of compression, `share` of whose strength is left; `None` inside of it.
    fn compressed(&self, stress: &[f64; 3], plastic: f64, share: f64) -> Option<([f64; 3], f64)> {
        let mean = (stress[0] + stress[1] + stress[2]) / 3.0;
        let s = stress.map(|v| v - mean);
        let j2 = 0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        let mises = (3.0 * j2).sqrt();
        let strength = share * self.lines.effective_pa(plastic);
        let scale = 1.0 / (1.0 - self.alpha);
        if scale * (3.0 * self.alpha * mean + (1.0 + self.lode) * mises) <= strength {
            return None; // the confined surface lies outside of this one
        }
        let c = if mises > 0.0 { 13.5 * s[0] * s[1] * s[2] / (mises * mises * mises) } else { 0.0 };
        let c = c.clamp(-1.0, 1.0);
        let g = 1.0 + self.lode * 1.5 * 3f64.sqrt() * c * (1.0 - c * c);
        let bulk = self.lambda + 2.0 / 3.0 * self.mu;
        // F falls linearly with the plastic multiplier Δ: the deviator shrinks, the mean falls; steeper once all stresses are pressures
        let most = stress[0];
        let most_falls = 3.0 * bulk * self.dilation + 3.0 * self.mu * s[0] / mises.max(f64::MIN_POSITIVE);
        let falls = scale * 3.0 * (3.0 * self.alpha * bulk * self.dilation + g * self.mu);
        let surface = Falling {
            value: scale * (3.0 * self.alpha * mean + g * mises - self.gamma * (-most).max(0.0)),
            slopes: [falls, falls + scale * self.gamma * most_falls],
            kink: if most > 0.0 { most / most_falls } else { 0.0 },
        };
        let trial = surface.value;
        if trial <= strength {
            return None;
        }
        let pressure = ((-stress[0]).max(0.0) / trial).min(CONFINED_LIMIT);
        let rate = (1.0 - self.dilation) / (1.0 + self.ductility * pressure);
        let delta = self.lines.meet(surface, plastic, rate, share);
        let flow = std::array::from_fn(|i| delta * (1.5 * s[i] / mises + self.dilation));
        Some((flow, plastic + rate * delta))
    }
}
