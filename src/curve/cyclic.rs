//! What cycles do to a resistance: the rule of degradation that a curve may carry, and the backbone on which a hinge with cycles runs.
//!
//! **Strength** decays with the energy that excursions dissipate (Rahnama and Krawinkler 1993, John A. Blume Center report 108; Ibarra, Medina and
//! Krawinkler 2005, Earthq. Eng. Struct. Dyn. 34, 1489-1511, eq. 9): after excursion `i`
//! `β_i = (E_i / (E_ref - Σ_{j<=i} E_j))^c`, and the strength in the sense that is entered next becomes `(1 - β_i)` of what it was; with the energy
//! of the excursion itself in the sum, as in that equation. `E_ref = Λ M_peak`; at `β >= 1` nothing is left.
//!
//! **Unloading stiffness** falls with the largest rotation reached, `K_u = K (θ_y / θ_max)^a` for `θ_max > θ_y` (Otani 1981 after Takeda, Sozen and
//! Nielsen 1970), and, if the rule says so, with the energy like the strength.

use super::{CurveError, ResistanceCurve};
use crate::base::piecewise::interpolate;
use serde::{Deserialize, Serialize};

/// The rule of degradation of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CyclicRule {
    /// Λ of the strength: reference energy over the peak moment at the axial force \[rad\].
    pub strength_reference_rad: f64,
    /// Λ of the unloading stiffness \[rad\]; absent: it does not depend on the energy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unloading_reference_rad: Option<f64>,
    /// Exponent `c` of the energies.
    pub energy_exponent: f64,
    /// Rotation `θ_y` from which on the unloading stiffness falls, elastic part included \[rad\].
    pub yield_rotation_rad: f64,
    /// Exponent `a` of the unloading stiffness, 0 (none) to 1.
    pub unloading_exponent: f64,
    /// How it was fitted; absent: it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fit: Option<CyclicFit>,
}

/// What a rule was fitted to, and how well.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CyclicFit {
    /// Axial force of the cycles, compression positive \[N\].
    pub axial_force_n: f64,
    /// Number of excursions.
    pub excursions: u32,
    /// Root of the mean squared difference of the strengths at the turning points, over the backbone: rule less cycles.
    pub strength_residual: f64,
    /// Root of the mean squared logarithm of the unloading stiffnesses, rule over cycles.
    pub unloading_residual: f64,
    /// Smallest strength at a turning point over the backbone, of the cycles.
    pub lowest_strength: f64,
}

impl CyclicRule {
    /// Checks the numbers.
    ///
    /// # Errors
    /// Names the first number out of its range.
    pub fn check(&self) -> Result<(), CurveError> {
        let wrong = |name: &'static str, value: f64, expected: &'static str| {
            Err(CurveError::Cyclic { name, value, expected })
        };
        let positive = [
            ("strength_reference_rad", self.strength_reference_rad),
            ("unloading_reference_rad", self.unloading_reference_rad.unwrap_or(1.0)),
            ("energy_exponent", self.energy_exponent),
            ("yield_rotation_rad", self.yield_rotation_rad),
        ];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return wrong(name, value, "a positive number");
            }
        }
        if !(0.0..=1.0).contains(&self.unloading_exponent) {
            return wrong("unloading_exponent", self.unloading_exponent, "0 to 1");
        }
        Ok(())
    }

    /// Share that is left after an excursion of this energy, the sum of energies including it \[J\], for a Λ \[rad\] and a peak \[N m\].
    pub fn left(&self, reference_rad: f64, peak_nm: f64, energy_j: f64, sum_j: f64) -> f64 {
        let rest = reference_rad * peak_nm - sum_j;
        if rest <= energy_j {
            return 0.0;
        }
        1.0 - libm::pow(energy_j.max(0.0) / rest, self.energy_exponent)
    }

    /// Unloading stiffness over the elastic one at the largest rotation reached \[rad\], without the part of the energy.
    pub fn unloading_share(&self, reached_rad: f64) -> f64 {
        if reached_rad <= self.yield_rotation_rad {
            return 1.0;
        }
        libm::pow(self.yield_rotation_rad / reached_rad, self.unloading_exponent)
    }

    /// The rule between this one and another, linear in the share of the other in each of its numbers; what was fitted is not said of it.
    #[must_use]
    pub fn between(&self, other: &Self, share: f64) -> Self {
        let mixed = |a: f64, b: f64| a + share * (b - a);
        Self {
            strength_reference_rad: mixed(self.strength_reference_rad, other.strength_reference_rad),
            unloading_reference_rad: self
                .unloading_reference_rad
                .zip(other.unloading_reference_rad)
                .map(|(a, b)| mixed(a, b)),
            energy_exponent: mixed(self.energy_exponent, other.energy_exponent),
            yield_rotation_rad: mixed(self.yield_rotation_rad, other.yield_rotation_rad),
            unloading_exponent: mixed(self.unloading_exponent, other.unloading_exponent),
            fit: None,
        }
    }
}

/// Moment over rotation of a first loading, the elastic part included, the same in both senses.
pub trait Backbone {
    /// Elastic stiffness \[N m/rad\].
    fn stiffness_nm_rad(&self) -> f64;
    /// Moment at a rotation that is not negative \[N m\].
    fn moment_nm(&self, rotation_rad: f64) -> f64;
    /// Largest moment \[N m\].
    fn peak_nm(&self) -> f64;
    /// End of the elastic line \[rad\].
    fn elastic_rad(&self) -> f64;
}

/// The backbone of a curve at one axial force.
#[derive(Debug, Clone, PartialEq)]
pub struct LevelBackbone {
    stiffness_nm_rad: f64,
    /// `[rotation (rad), moment (N m)]`, from the end of the elastic line.
    points: Vec<[f64; 2]>,
    peak_nm: f64,
}

/// Least distance of two rotations of a backbone over the rotation: where the capacity falls faster than the elastic line.
const STEEPEST: f64 = 1e-6;

impl LevelBackbone {
    /// At an axial force, compression positive \[N\].
    pub fn of(curve: &ResistanceCurve, axial_force_n: f64) -> Self {
        let stiffness_nm_rad = curve.stiffness_nm_rad;
        let mut points: Vec<[f64; 2]> = Vec::new();
        for plastic in curve.rotations(axial_force_n) {
            let moment = curve.capacity_nm(plastic, axial_force_n);
            let mut rotation = plastic + moment / stiffness_nm_rad;
            if let Some(last) = points.last() {
                rotation = rotation.max(last[0] * (1.0 + STEEPEST) + 1e-12);
            }
            points.push([rotation, moment]);
        }
        let peak_nm = points.iter().map(|p| p[1]).fold(0.0, f64::max);
        Self { stiffness_nm_rad, points, peak_nm }
    }
}

impl Backbone for LevelBackbone {
    fn stiffness_nm_rad(&self) -> f64 {
        self.stiffness_nm_rad
    }

    fn moment_nm(&self, rotation_rad: f64) -> f64 {
        if rotation_rad < self.elastic_rad() {
            return self.stiffness_nm_rad * rotation_rad;
        }
        interpolate(&self.points, rotation_rad)
    }

    fn peak_nm(&self) -> f64 {
        self.peak_nm
    }

    fn elastic_rad(&self) -> f64 {
        self.points[0][0]
    }
}
