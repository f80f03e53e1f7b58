//! Stress update at a material point.

use super::backbone::{Backbones, Falling, Memory};
use super::lanes::respond_lanes;
use super::law::{ConcreteLaw, LawError};
use super::principal::{assemble, principal};
use crate::material::rate::power;
use serde::{Deserialize, Serialize};

/// Largest strain increment of a sub-step, over the cracking strain.
const SUB_STEP: f64 = 0.25;
/// Most sub-steps of an increment: beyond, each is larger. The return exists for any increment.
const MOST_SUB_STEPS: f64 = 64.0;
/// Steps of Newton's method for the three cracks: they are exact but for kinks of their lines and for the factor of compression across.
const CRACK_STEPS: usize = 8;
/// Opening of a crack by the stress that another one releases beyond which they are found by sweeps; up to here they have one solution.
const COUPLED: f64 = 0.5;
/// Sweeps over the three cracks; they converge by `(λ / (λ + 2μ))²` a sweep.
const CRACK_SWEEPS: usize = 24;
/// Change of cracking stress over the tensile strength at which cracks are found.
const CRACK_CHANGE: f64 = 1e-6;
/// Excess over the surface of compression that is round-off of the return before.
const ROUND_OFF: f64 = 1e-12;
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
    /// Segments of the tables in which `plastic` and `crack` were found last: a guess for the next search.
    pub places: [u16; 2],
}

/// A law for elements of one length, ready for the time loop.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConcretePoint {
    lambda: f64,
    mu: f64,
    /// `λ + 2μ`, and one over it.
    modulus: f64,
    flexibility: f64,
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
    crack_share: f64,
    lines: Backbones,
    /// What tells in a few operations whether a point is elastic.
    pub(super) screen: Screen,
}

/// Constants of [`super::lanes`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(super) struct Screen {
    pub lambda: f64,
    pub two_mu: f64,
    pub tensile: f64,
    /// Loss of tensile strength for a compressive stress \[1/Pa\], and at most.
    pub reduction_1_pa: f64,
    pub reduction: f64,
    /// Factors of the mean and the Mises stress in the surface.
    pub of_mean: f64,
    pub of_mises: f64,
    /// Effective stress at the elastic limit \[Pa\].
    pub elastic_limit: f64,
    /// Square of the longest sub-step.
    pub step_squared: f64,
}

/// Cracks at principal strains.
struct Cracked {
    /// Effective principal stresses \[Pa\].
    effective: [f64; 3],
    /// Crack strains.
    crack: [f64; 3],
    /// Factor on the tensile line.
    factor: f64,
    /// Whether one is open.
    open: bool,
}

/// A point at rest in its principal directions.
pub(super) struct Settled {
    /// Nominal principal stresses \[Pa\].
    pub nominal: [f64; 3],
    /// Mechanical strains.
    pub strain: [f64; 3],
    /// Whether it flowed, so that they are not those given.
    pub flowed: bool,
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
        let alpha = (r - 1.0) / (2.0 * r - 1.0);
        let (lambda, mu) = (e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), 0.5 * e / (1.0 + nu));
        let tensile = lines.tensile_pa(0.0, 0);
        let step = SUB_STEP * tensile / (lambda + 2.0 * mu);
        let screen = Screen {
            lambda,
            two_mu: 2.0 * mu,
            tensile,
            reduction_1_pa: law.surface.tension_reduction / law.compressive_strength_pa,
            reduction: law.surface.tension_reduction,
            of_mean: 3.0 * alpha / (1.0 - alpha),
            of_mises: (1.0 + law.surface.lode_amplitude) / (1.0 - alpha),
            elastic_limit: lines.elastic_limit_pa(),
            step_squared: step * step,
        };
        Ok(Self {
            lambda,
            mu,
            modulus: lambda + 2.0 * mu,
            flexibility: 1.0 / (lambda + 2.0 * mu),
            strength: law.compressive_strength_pa,
            tensile,
            alpha,
            gamma: 3.0 * (1.0 - k) / (2.0 * k - 1.0),
            lode: law.surface.lode_amplitude,
            dilation: law.surface.dilation,
            ductility: law.surface.confined_ductility,
            reduction: law.surface.tension_reduction,
            softening: law.surface.crack_softening,
            crack_share: (length_m / CRACK_SPACING_M).min(1.0),
            lines,
            screen,
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
        if state.plastic <= 0.0 {
            return 0.0;
        }
        1.0 - self.lines.left(state.plastic, self.lines.segment(state.plastic, usize::from(state.places[0])))
    }

    /// Share of stress left by crushing, `1 - d`, and effective strength \[Pa\]; notes where it was found.
    pub(super) fn hardened(&self, state: &mut ConcreteState) -> [f64; 2] {
        let i = self.lines.segment(state.plastic, usize::from(state.places[0]));
        state.places[0] = i as u16;
        [self.lines.left(state.plastic, i), self.lines.effective_pa(state.plastic, i)]
    }

    /// Nominal stress after a strain increment (tensor components) \[Pa\].
    pub fn respond(&self, state: &mut ConcreteState, increment: &[f64; 6]) -> [f64; 6] {
        let [mut stress, mut mechanical] = [[[0.0]; 6]; 2];
        let increments = increment.map(|s| [s]);
        respond_lanes(
            &[self],
            std::slice::from_mut(state),
            &increments,
            &[true],
            [&mut stress, &mut mechanical],
        );
        stress.map(|s| s[0])
    }

    /// [`Self::respond`] in sub-steps of `1 / count` of the increment.
    #[inline(never)]
    pub(super) fn respond_in_steps(
        &self,
        state: &mut ConcreteState,
        increment: &[f64; 6],
        count: usize,
    ) -> [f64; 6] {
        let mut stress = [0.0; 6];
        for _ in 0..count {
            for i in 0..6 {
                state.mechanical[i] += increment[i] / count as f64;
            }
            let (strain, q) = principal(&state.mechanical);
            let [left, _] = self.hardened(state);
            let settled = self.settle(strain, state, left);
            if settled.flowed {
                state.mechanical = assemble(&settled.strain, &q);
            }
            stress = assemble(&settled.nominal, &q);
        }
        stress
    }

    /// Sub-steps that an increment needs: its length is the same in all axes.
    pub(super) fn sub_steps(&self, increment: &[f64; 6]) -> usize {
        let square = square_of(increment);
        if square <= self.screen.step_squared {
            return 1;
        }
        (square / self.screen.step_squared).sqrt().ceil().clamp(1.0, MOST_SUB_STEPS) as usize
    }

    /// Share of the tensile strength that is left beside a smallest principal stress \[Pa\].
    fn tension_factor(&self, least: f64) -> f64 {
        let loss = -least * self.screen.reduction_1_pa;
        let loss = if loss > 0.0 { loss } else { 0.0 };
        1.0 - if loss < self.reduction { loss } else { self.reduction }
    }

    /// Stress in the full law at principal strains before plastic flow. `left` is `1 - d` of the state.
    #[inline(never)]
    pub(super) fn settle(&self, mut strain: [f64; 3], state: &mut ConcreteState, mut left: f64) -> Settled {
        let mut cracked = self.cracked(&strain, state, left);
        let mut flowed = false;
        // cracks that close while it flows leave it outside of the surface
        for _ in 0..FLOW_ROUNDS {
            let share = self.beside_cracks(&cracked.crack, state.plastic - strain[2]);
            let Some((plastic, hardened)) = self.compressed(&cracked.effective, state, share) else {
                break;
            };
            for i in 0..3 {
                strain[i] -= plastic[i];
            }
            flowed = true;
            state.plastic = hardened;
            [left, _] = self.hardened(state);
            let open = cracked.open;
            cracked = self.cracked(&strain, state, left);
            if !open && !cracked.open {
                break; // without cracks the return is exact
            }
        }
        if cracked.open {
            let largest = state.crack;
            for c in cracked.crack.into_iter().filter(|c| *c > 0.0) {
                state.crack = state.crack.max(c);
                let over = if c < largest { largest / c } else { 1.0 };
                state.crack_loss = state.crack_loss.max(1.0 - cracked.factor * over);
            }
        }
        Settled { nominal: cracked.effective.map(|s| left * s), strain, flowed }
    }

    /// Share of the compressive strength that is left beside cracks, at a compressive strain (positive).
    fn beside_cracks(&self, crack: &[f64; 3], compressed: f64) -> f64 {
        let widest = crack.iter().fold(0.0, |m: f64, c| m.max(*c));
        if self.softening <= 0.0 || widest <= 0.0 || compressed <= 0.0 {
            return 1.0;
        }
        let excess = self.crack_share * widest / compressed - 0.28;
        if excess > 0.0 { 1.0 / (1.0 + self.softening * power(excess, 0.8)) } else { 1.0 }
    }

    /// Effective principal stresses and cracks at principal mechanical strains. `left` is `1 - d`. Where compression across a crack cuts its secant
    /// off, the secant stays so low: otherwise a crack opened under compression and closed without it would give energy away.
    fn cracked(&self, strain: &[f64; 3], state: &mut ConcreteState, left: f64) -> Cracked {
        let volumetric = self.lambda * (strain[0] + strain[1] + strain[2]);
        let elastic = strain.map(|e| volumetric + 2.0 * self.mu * e);
        let kept = 1.0 - state.crack_loss;
        let factor = self.tension_factor(left * elastic[2]).min(kept);
        let bearable = if state.crack > 0.0 { 0.0 } else { factor * self.tensile };
        if strain[0] <= 0.0 || elastic[0] <= bearable {
            return Cracked { effective: elastic, crack: [0.0; 3], factor, open: false };
        }
        let memory = self.memory(state);
        let (crack, factor) = self
            .single(&elastic, factor, [kept, left], &memory)
            .or_else(|| self.opened(&elastic, factor, [kept, left], &memory))
            .unwrap_or_else(|| self.swept(&elastic, [kept, left], &memory));
        Cracked {
            effective: self.released(&elastic, &crack),
            crack,
            factor,
            open: crack.iter().any(|c| *c > 0.0),
        }
    }

    /// What the cracks of a state remember.
    fn memory(&self, state: &mut ConcreteState) -> Memory {
        let place = self.lines.crack_segment(state.crack, usize::from(state.places[1]));
        state.places[1] = place as u16;
        let (largest, held_pa) = (state.crack, self.lines.tensile_pa(state.crack, place));
        let (modulus_pa, flexibility_1_pa) = (self.modulus, self.flexibility);
        let secant_1_pa = if largest > 0.0 {
            largest / (modulus_pa * largest + (1.0 - state.crack_loss) * held_pa)
        } else {
            flexibility_1_pa
        };
        Memory { largest, place, held_pa, modulus_pa, flexibility_1_pa, secant_1_pa }
    }

    /// The largest principal strain's crack and the factor on its line, if no other opens beside it; `None` otherwise, or if it is not found.
    #[inline]
    fn single(
        &self,
        elastic: &[f64; 3],
        first: f64,
        [kept, left]: [f64; 2],
        memory: &Memory,
    ) -> Option<([f64; 3], f64)> {
        let (mut crack, mut factor) = (0.0, first);
        for _ in 0..CRACK_STEPS {
            let [open, _] = self.lines.opening(elastic[0], factor, memory);
            let bearable = if memory.largest > 0.0 { 0.0 } else { factor * self.tensile };
            if elastic[1] - self.lambda * open > bearable {
                return None;
            }
            let (change, used) = ((open - crack).abs(), factor);
            crack = open;
            let next = self.tension_factor(left * (elastic[2] - self.lambda * open));
            factor = if next < kept { next } else { kept };
            if factor == used || change * memory.modulus_pa <= CRACK_CHANGE * self.tensile {
                return Some(([crack, 0.0, 0.0], used));
            }
        }
        None
    }

    /// Principal stresses that cracks leave of those without cracks \[Pa\].
    fn released(&self, elastic: &[f64; 3], crack: &[f64; 3]) -> [f64; 3] {
        let all = self.lambda * (crack[0] + crack[1] + crack[2]);
        std::array::from_fn(|i| elastic[i] - all - 2.0 * self.mu * crack[i])
    }

    /// Crack strains, and the factor on their line, by Newton's method: with the openings `c_i = o_i(σ_i - λ Σ_{j≠i} c_j)` of slopes `b_i` a
    /// step is `(1 - λ b_i) δ_i + λ b_i Σ δ_j = o_i - c_i`, solved by the sum. `None` if they are coupled too strongly, or not found.
    fn opened(
        &self,
        elastic: &[f64; 3],
        first: f64,
        [kept, left]: [f64; 2],
        memory: &Memory,
    ) -> Option<([f64; 3], f64)> {
        let (mut crack, mut factor, mut sum) = ([0.0; 3], first, 0.0);
        for _ in 0..CRACK_STEPS {
            let (mut own, mut shared) = ([0.0; 3], [0.0; 3]);
            for i in 0..3 {
                let closed = elastic[i] - self.lambda * (sum - crack[i]);
                let [opening, slope] = self.lines.opening(closed, factor, memory);
                let coupled = self.lambda * slope;
                if coupled > COUPLED {
                    return None;
                }
                let scale = if coupled > 0.0 { 1.0 / (1.0 - coupled) } else { 1.0 };
                (own[i], shared[i]) = (scale * (opening - crack[i]), scale * coupled);
            }
            let all = (own[0] + own[1] + own[2]) / (1.0 + shared[0] + shared[1] + shared[2]);
            let mut change = 0.0;
            for i in 0..3 {
                let opened = crack[i] + own[i] - shared[i] * all;
                let opened = if opened > 0.0 { opened } else { 0.0 };
                let moved = (opened - crack[i]).abs();
                change = if moved > change { moved } else { change };
                crack[i] = opened;
            }
            sum = crack[0] + crack[1] + crack[2];
            let used = factor;
            let next =
                self.tension_factor(left * (elastic[2] - self.lambda * sum - 2.0 * self.mu * crack[2]));
            factor = if next < kept { next } else { kept };
            if change * memory.modulus_pa <= CRACK_CHANGE * self.tensile {
                return Some((crack, used));
            }
        }
        None
    }

    /// [`Self::opened`] by sweeps.
    #[cold]
    fn swept(&self, elastic: &[f64; 3], [kept, left]: [f64; 2], memory: &Memory) -> ([f64; 3], f64) {
        let (mut crack, mut factor) = ([0.0; 3], kept);
        for _ in 0..CRACK_SWEEPS {
            let mut change: f64 = 0.0;
            factor = self.tension_factor(left * self.released(elastic, &crack)[2]).min(kept);
            for i in 0..3 {
                let closed = self.released(elastic, &crack)[i] + memory.modulus_pa * crack[i];
                let [open, _] = self.lines.opening(closed, factor, memory);
                change = change.max((open - crack[i]).abs());
                crack[i] = open;
            }
            if change * memory.modulus_pa <= CRACK_CHANGE * self.tensile {
                break;
            }
        }
        (crack, factor)
    }

    /// Principal plastic strains and the hardening variable after the return to the surface of compression, `share` of whose strength is left; `None` inside of it.
    fn compressed(&self, stress: &[f64; 3], state: &ConcreteState, share: f64) -> Option<([f64; 3], f64)> {
        let (plastic, place) = (state.plastic, usize::from(state.places[0]));
        let mean = (stress[0] + stress[1] + stress[2]) / 3.0;
        let s = stress.map(|v| v - mean);
        let j2 = 0.5 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        let mises = (3.0 * j2).sqrt();
        let strength = share * self.lines.effective_pa(plastic, place) * (1.0 + ROUND_OFF);
        if self.screen.of_mean * mean + self.screen.of_mises * mises <= strength {
            return None; // the confined surface lies outside of this one
        }
        let scale = 1.0 / (1.0 - self.alpha);
        let per_mises = 1.0 / mises.max(f64::MIN_POSITIVE);
        let c = 13.5 * (s[0] * per_mises) * (s[1] * per_mises) * (s[2] * per_mises);
        let c = c.clamp(-1.0, 1.0);
        let g = 1.0 + self.lode * 1.5 * 3f64.sqrt() * c * (1.0 - c * c);
        let bulk = self.lambda + 2.0 / 3.0 * self.mu;
        // F falls linearly with the plastic multiplier Δ: the deviator shrinks, the mean falls; steeper once all stresses are pressures
        let most = stress[0];
        let most_falls = 3.0 * bulk * self.dilation + 3.0 * self.mu * s[0] * per_mises;
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
        let delta = self.lines.meet(surface, [plastic, rate, share], place);
        let flow = std::array::from_fn(|i| delta * (1.5 * s[i] * per_mises + self.dilation));
        Some((flow, plastic + rate * delta))
    }
}

/// `e : e`.
#[inline(always)]
fn square_of(e: &[f64; 6]) -> f64 {
    (e[0] * e[0] + e[1] * e[1] + e[2] * e[2]) + 2.0 * (e[3] * e[3] + e[4] * e[4] + e[5] * e[5])
}
