//! Hourglass control of the one-point hexahedron: what the twelve generalised hourglass strains `q_iα` do to their stresses `Q_iα`.
//!
//! **Field.** In a brick with edges along the element's frame and natural coordinates ξ, η, ζ the displacement is
//! `u_i = const + L_ij x_j + Σ_α q_iα h_α` with `h = (ηζ, ξζ, ξη, ξηζ)`. Its hourglass strains are, with `ξ' = ∂ξ/∂x` and so on and
//! the other directions by exchange of letters,
//!
//! * `ε_xx = ζ ξ' q_x2 + η ξ' q_x3 + ηζ ξ' q_x4`,
//! * `2 ε_xy = ζ (η' q_x1 + ξ' q_y2) + ξ η' q_x3 + η ξ' q_y3 + ξζ η' q_x4 + ηζ ξ' q_y4`.
//!
//! An assumed-strain form (Belytschko and Bindeman, Comput. Methods Appl. Mech. Engng 105 (1993) 225-260) keeps a part of it and
//! integrates `σ : δε` exactly: `∫ζ² dV = V/3`, `∫η²ζ² dV = V/9`, mixed products vanish. With `H_ii = (Λ_j x_j)(Λ_k x_k) / (3 Λ_i x_i)`, which
//! is `V ξ_i'²/3`, and `H_ij = Λ_k x_k / 3`, i, j, k a permutation, all forms have the shape
//!
//! * `Q_ii = μ [(H_jj + H_kk) q_ii + H_ij q_jj + H_ik q_kk]`: the shear `ζ (η' q_x1 + ξ' q_y2)`, which all keep: without it the modes `q_ii` have no
//!   resistance at all;
//! * `Q_ij = (a H_ii + s H_kk) q_ij + c H_ij q_ji`: bending. `ζ` stands in `ε_xx` with `q_x2` and in `ε_yy` with `q_y1`;
//! * `Q_i4 = (a' H_ii + s (H_jj + H_kk)/3) q_i4`.
//!
//! | form | normal strains | a | c | a' | s |
//! |---|---|---|---|---|---|
//! | ASQBI | bending strain with `σ_zz = 0`; `q_i4` uniaxial | 2μ/(1-ν) | 2μν/(1-ν) | 2μ(1+ν)/3 | 0 |
//! | ADS | deviator (2/3, -1/3, -1/3) | 4μ/3 | -2μ/3 | 4μ/9 | 0 |
//! | ASMD | deviator (2/3, -1/3, -1/3) | 4μ/3 | -2μ/3 | 4μ/9 | μ |
//!
//! ADS and ASMD make no volume strain, so the volume strain of the element is its mean; they differ in the shear that goes with bending
//! (`ξ η' q_x3` above, parasitic in a beam), which ASMD keeps whole and ADS drops. On a parallelepiped ASMD is the fully integrated element with averaged volume
//! strain ([`super::full`]), mode by mode. ASQBI is exact for a beam of one element across, ADS softer (by `1 - 4(1-ν)/6` in a
//! single element), and ASMD stiff in long thin elements (shear locking).
//!
//! **Flanagan and Belytschko** (Int. J. Numer. Meth. Engng 17 (1981) 679-706): no strain field but twelve equal springs or dashpots.
//! * Stiffness: `Q̇ = (8/3) κ (λ+2μ) (V b_jI b_jI) q̇`. The hourglass modes of a brick then have `ω² = κ ω_low²` with their lower estimate
//!   of the largest frequency, `ω_low² = (8/3)(λ+2μ) V b_jI b_jI / m`. Artificial: it is not counted in the yield condition, but it fades and softens with a
//!   flowing centre like the others, or it would lock plastic bending.
//! * Viscous: `Q = 16 ε sqrt(ρ(λ+2μ)) V^(2/3) q̇`, the nodal forces `(ε/4) ρ c V^(2/3) Γ_αI Γ_αJ v_J` (`Γ = 8γ`) in which explicit codes state their
//!   coefficient; never more than `m q̇ / Δt`, which stops the mode within a step. It has no memory and no plastic limit, and its work counts as
//!   hourglass work. There is nothing that holds a bending moment within an element: two elements deep, a quarter of the
//!   bending stiffness is missing. In a static solve, which has no rates, it acts as the stiffness form of the same coefficient; what that has gathered is
//!   gone after the first step.

use super::hexahedron::{cbrt, frame, gradient, to_patterns};
use super::kernel::{BlockState, Scratch};
use super::law::{ElementForm, Hourglass};
use crate::base::vector::{V3, dot, scale};

/// Share of its volume that the parallelepiped at the centre of an element counts with at least. A brick has 1.
const LEAST_CENTRE: f64 = 0.05;

/// Constants of the forms other than ASQBI, for the blocks of one law.
#[derive(Debug, Clone, Copy)]
pub(super) struct Control {
    /// `1` for assumed-strain forms, whose `Q_ii` and yield condition are those of the module's head.
    assumed: f64,
    /// `a / μ`, `c / μ`, `a' / μ`, `s / μ`.
    bending: f64,
    coupling: f64,
    last: f64,
    shear: f64,
    /// `8 κ / 3`.
    stiffness: f64,
    /// `16 ε`.
    viscosity: f64,
    /// Steps per second, 0 in static solves \[1/s\].
    rate_1_s: f64,
    /// Share of the old stress that a step starts from: 0 or 1.
    pub(super) memory: f64,
    /// Factor on the frequency bound.
    pub(super) bound: f64,
}

impl Control {
    /// Constants of a form. `rate_1_s` is the reciprocal of the time step, 0 in static solves.
    pub(super) fn of(form: ElementForm, rate_1_s: f64) -> Self {
        let none = Self {
            assumed: 0.0,
            bending: 0.0,
            coupling: 0.0,
            last: 0.0,
            shear: 0.0,
            stiffness: 0.0,
            viscosity: 0.0,
            rate_1_s,
            memory: 1.0,
            bound: 1.0,
        };
        let deviator =
            Self { assumed: 1.0, bending: 4.0 / 3.0, coupling: -2.0 / 3.0, last: 4.0 / 9.0, ..none };
        let springs =
            |k: f64| Self { stiffness: 8.0 / 3.0 * k, bound: if k > 1.0 { k } else { 1.0 }, ..none };
        match form {
            ElementForm::OnePoint(Hourglass::Asmd) => Self { shear: 1.0, ..deviator },
            ElementForm::OnePoint(Hourglass::Stiffness { coefficient }) => springs(coefficient),
            ElementForm::OnePoint(Hourglass::Viscous { coefficient }) if rate_1_s == 0.0 => {
                springs(coefficient)
            }
            ElementForm::OnePoint(Hourglass::Viscous { coefficient }) => {
                Self { viscosity: 16.0 * coefficient, memory: 0.0, ..none }
            }
            ElementForm::OnePoint(Hourglass::Ads | Hourglass::Asqbi) | ElementForm::FullyIntegrated => {
                deviator
            }
        }
    }
}

/// Geometry of one lane that the constants need.
#[derive(Clone, Copy)]
pub(super) struct Brick {
    /// `Λ_i x_i`: four times the edges \[m\].
    pub(super) edge: V3,
    /// Volume \[m³\].
    pub(super) volume: f64,
    /// `b_jI b_jI` \[1/m²\].
    pub(super) gradient: f64,
    /// Mass \[kg\].
    pub(super) mass: f64,
    /// Lamé's constants \[Pa\].
    pub(super) lambda: f64,
    pub(super) mu: f64,
}

impl Brick {
    /// `H_ii` and `Λ_i x_i / 3`.
    #[inline(always)]
    fn shape(&self) -> (V3, V3) {
        let edge = self.edge;
        let faces = [edge[1] * edge[2], edge[2] * edge[0], edge[0] * edge[1]];
        let inverse = (1.0 / 3.0) / divisor(edge[0] * faces[0], self.volume);
        let h = [faces[0] * faces[0] * inverse, faces[1] * faces[1] * inverse, faces[2] * faces[2] * inverse];
        (h, scale(1.0 / 3.0, edge))
    }
}

/// What hourglass stiffnesses have as a divisor, for the product `e_0 e_1 e_2` of the edges of a brick in its frame, 64 times the volume of the parallelepiped at its
/// centre. That may vanish or turn inside out in an element that keeps its volume: [`LEAST_CENTRE`] of the volume at least.
#[inline(always)]
pub(super) fn divisor(centre: f64, volume: f64) -> f64 {
    let least = 64.0 * LEAST_CENTRE * volume;
    if centre > least { centre } else { least }
}

/// Elastic increments of the generalised hourglass stresses of ASQBI, `3 * α + i`; in Lamé's constants
/// `2μ/(1-ν) = 4μ(λ+μ)/(λ+2μ)`, `2μν/(1-ν) = 2μλ/(λ+2μ)`, `2μ(1+ν) = μ(3λ+2μ)/(λ+μ)`.
///
/// Returns the mean square of the von Mises stress that the trial hourglass stresses stand for \[Pa²\]: `6 G U / V` with their
/// elastic energy `U`, the relation of pure shear.
#[inline(always)]
pub(super) fn asqbi(l: usize, brick: &Brick, state: &BlockState, s: &mut Scratch) -> f64 {
    let mut q = [0.0; 12];
    for i in 0..12 {
        q[i] = s.q[i][l];
    }
    let (h, third) = brick.shape();
    let (lambda, mu) = (brick.lambda, brick.mu);
    let (sum, longitudinal) = (lambda + mu, lambda + 2.0 * mu);
    let shared = mu / (sum * longitudinal);
    let bending = 4.0 * sum * sum * shared;
    let coupled = 2.0 * lambda * sum * shared;
    let last = (3.0 * lambda + 2.0 * mu) * longitudinal * shared * (1.0 / 3.0);
    let mut rate = [0.0; 12];
    let mut stiffness = [0.0; 12];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        stiffness[4 * i] = mu * (h[j] + h[k]);
        rate[4 * i] = stiffness[4 * i] * q[4 * i] + mu * (third[k] * q[4 * j] + third[j] * q[4 * k]);
        stiffness[3 * j + i] = bending * h[i];
        rate[3 * j + i] = bending * h[i] * q[3 * j + i] + coupled * third[k] * q[3 * i + j];
        stiffness[3 * k + i] = bending * h[i];
        rate[3 * k + i] = bending * h[i] * q[3 * k + i] + coupled * third[j] * q[3 * i + k];
        stiffness[9 + i] = last * h[i];
        rate[9 + i] = last * h[i] * q[9 + i];
    }
    let mut energy = 0.0;
    for i in 0..12 {
        let trial = state.hourglass[i][l] + rate[i];
        energy += trial * trial / stiffness[i];
        s.rate[i][l] = rate[i];
    }
    3.0 * mu * energy / brick.volume
}

/// [`asqbi`] for all other forms.
#[inline(always)]
pub(super) fn general(
    l: usize,
    control: &Control,
    brick: &Brick,
    state: &BlockState,
    s: &mut Scratch,
) -> f64 {
    let mut q = [0.0; 12];
    for i in 0..12 {
        q[i] = s.q[i][l];
    }
    let (h, third) = brick.shape();
    let mu = control.assumed * brick.mu;
    let spring = springs(control, brick);
    let (bending, coupling) = (control.bending * mu, control.coupling * mu);
    let (last, shear) = (control.last * mu, control.shear * mu);
    let mut rate = [0.0; 12];
    let mut stiffness = [0.0; 12];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        stiffness[4 * i] = mu * (h[j] + h[k]) + spring;
        rate[4 * i] = stiffness[4 * i] * q[4 * i] + mu * (third[k] * q[4 * j] + third[j] * q[4 * k]);
        stiffness[3 * j + i] = bending * h[i] + shear * h[k] + spring;
        rate[3 * j + i] = stiffness[3 * j + i] * q[3 * j + i] + coupling * third[k] * q[3 * i + j];
        stiffness[3 * k + i] = bending * h[i] + shear * h[j] + spring;
        rate[3 * k + i] = stiffness[3 * k + i] * q[3 * k + i] + coupling * third[j] * q[3 * i + k];
        stiffness[9 + i] = last * h[i] + shear * (1.0 / 3.0) * (h[j] + h[k]) + spring;
        rate[9 + i] = stiffness[9 + i] * q[9 + i];
    }
    let mut energy = 0.0;
    for i in 0..12 {
        let trial = state.hourglass[i][l] + rate[i];
        energy += trial * trial / stiffness[i];
        s.rate[i][l] = rate[i];
    }
    if control.assumed == 1.0 { 3.0 * mu * energy / brick.volume } else { 0.0 }
}

/// Stiffness of the springs, or of the dashpots over a step, of the forms of Flanagan and Belytschko.
#[inline(always)]
fn springs(control: &Control, brick: &Brick) -> f64 {
    let modulus = brick.lambda + 2.0 * brick.mu;
    let safe = if brick.volume > f64::MIN_POSITIVE { brick.volume } else { 1.0 };
    let length = cbrt(safe);
    let impedance = (brick.mass / safe * modulus).sqrt();
    let damping = control.viscosity * impedance * length * length;
    let most = brick.mass * control.rate_1_s;
    let damping = if damping < most { damping } else { most };
    control.stiffness * modulus * safe * brick.gradient + control.rate_1_s * damping
}

/// The stress after the step, and the factor on its elastic part.
#[inline(always)]
pub(super) fn returned(control: &Control, before: f64, rate: f64, ratio: f64, tangent: f64) -> f64 {
    let follows = control.memory;
    let factor = follows * ratio + (1.0 - follows);
    let share = follows * tangent + (1.0 - follows);
    factor * (follows * before + share * rate)
}

/// Energy that hourglass stresses `3 * α + i` store in an element with its nodes at `x` \[m\]: `Q K⁻¹ Q / 2` with the moduli of its form \[J\]; none
/// in the viscous form. Infinite in an element that is turned inside out, where the moduli mean nothing.
pub(super) fn stored_j(form: ElementForm, x: &[V3; 8], [lambda, mu]: [f64; 2], stress: &[f64; 12]) -> f64 {
    let mut at = [[0.0; 3]; 7];
    for i in 0..3 {
        let sums = to_patterns(x.map(|n| n[i]));
        for k in 0..7 {
            at[k][i] = sums[k];
        }
    }
    let (e, volume) = gradient(&at);
    if form == ElementForm::FullyIntegrated {
        return 0.0;
    }
    let rows = frame(at[0], at[1]);
    let edge: V3 = std::array::from_fn(|i| dot(rows[i], at[i]));
    if volume.is_nan() || volume <= 0.0 || edge[0] * edge[1] * edge[2] <= 0.0 {
        return f64::INFINITY;
    }
    let of_gradient = e.iter().map(|b| dot(*b, *b)).sum::<f64>() * 8.0 / (64.0 * volume * 64.0 * volume);
    let brick = Brick { edge, volume, gradient: of_gradient, mass: 1.0, lambda, mu };
    let (h, third) = brick.shape();
    let control = Control::of(form, 0.0);
    let (plain, spring) =
        (control.assumed * mu, control.stiffness * (lambda + 2.0 * mu) * volume * of_gradient);
    let (bending, coupled, last) = if form == ElementForm::OnePoint(Hourglass::Asqbi) {
        let (sum, longitudinal) = (lambda + mu, lambda + 2.0 * mu);
        let of_plate = 4.0 * mu * sum / longitudinal;
        (of_plate, 0.5 * of_plate * lambda / sum, mu * (3.0 * lambda + 2.0 * mu) / sum / 3.0)
    } else {
        (control.bending * mu, control.coupling * mu, control.last * mu)
    };
    let shear = control.shear * mu;
    let mut sum = 0.0;
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        // q_ji and q_ij, bent about the axis k
        let (a, b) = (bending * h[i] + shear * h[k] + spring, bending * h[j] + shear * h[k] + spring);
        let (p, q) = (stress[3 * j + i], stress[3 * i + j]);
        let c = coupled * third[k];
        sum += (b * p * p - 2.0 * c * p * q + a * q * q) / (a * b - c * c);
        let fourth = last * h[i] + shear * (1.0 / 3.0) * (h[j] + h[k]) + spring;
        sum += stress[9 + i] * stress[9 + i] / fourth;
    }
    // the three twists: diagonal h_j + h_k, couplings Λ_k x_k / 3
    let d: V3 = std::array::from_fn(|i| plain * (h[(i + 1) % 3] + h[(i + 2) % 3]) + spring);
    let c: V3 = third.map(|t| plain * t);
    let p: V3 = std::array::from_fn(|i| stress[4 * i]);
    let mut adjugate = 0.0;
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        adjugate +=
            (d[j] * d[k] - c[i] * c[i]) * p[i] * p[i] + 2.0 * (c[i] * c[j] - d[k] * c[k]) * p[i] * p[j];
    }
    let determinant = d[0] * d[1] * d[2] + 2.0 * c[0] * c[1] * c[2]
        - d[0] * c[0] * c[0]
        - d[1] * c[1] * c[1]
        - d[2] * c[2] * c[2];
    0.5 * (sum + adjugate / determinant)
}
