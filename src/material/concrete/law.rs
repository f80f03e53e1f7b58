//! Parameters of the concrete law.

use serde::{Deserialize, Serialize};

/// Concrete of the detailed models. Strengths are those of the concrete as it is (means), not design values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ConcreteLaw {
    /// Density \[kg/m³\].
    pub density_kg_m3: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Uniaxial compressive strength `f_c` \[Pa\].
    pub compressive_strength_pa: f64,
    /// Uniaxial tensile strength `f_t` \[Pa\].
    pub tensile_strength_pa: f64,
    /// Fracture energy `G_F` \[J/m²\].
    pub fracture_energy_j_m2: f64,
    /// Crushing energy `G_c`: the whole area below the stress-strain line in compression times the length \[J/m²\].
    pub crushing_energy_j_m2: f64,
    /// Strain at the compressive strength.
    pub peak_strain: f64,
    /// Line of uniaxial compression.
    pub compression: CompressionCurve,
    /// Line of uniaxial tension.
    pub tension: TensionCurve,
    /// Surface of multiaxial compression and tension-compression.
    pub surface: Surface,
}

/// Uniaxial compression.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CompressionCurve {
    /// Linear up to this share of the strength, then a power line to the peak, then `exp(-(ε - ε_0) / s)`, whose `s` follows from the crushing
    /// energy.
    Standard {
        /// Share of the strength up to which concrete is elastic.
        elastic_share: f64,
    },
    /// `[strain, stress (Pa)]` from the elastic limit on, as measured; no regularisation.
    Points(Vec<[f64; 2]>),
}

/// Uniaxial tension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TensionCurve {
    /// Hordijk's line with the fracture energy.
    Hordijk,
    /// `[crack strain, stress (Pa)]` from the strength on, as measured; no regularisation.
    Points(Vec<[f64; 2]>),
}

/// Constants of the multiaxial surface and flow.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Surface {
    /// Biaxial over uniaxial compressive strength, `r`.
    pub biaxial_ratio: f64,
    /// Deviator on the tensile over that on the compressive meridian, `K_c`; 1: the seed's cone.
    pub meridian_ratio: f64,
    /// Amplitude `a` of the correction between the meridians.
    pub lode_amplitude: f64,
    /// Dilation `β`: volumetric over equivalent plastic strain, a third of it.
    pub dilation: f64,
    /// Gain `A` of ductility under lateral pressure.
    pub confined_ductility: f64,
    /// Loss of tensile strength when the compressive strength acts across it.
    pub tension_reduction: f64,
    /// Loss of compressive strength by open cracks along it: `1 / (1 + this (ε_cr / ε_c - 0.28)^0.8) <= 1` with the compressive strain `ε_c`; 0: none.
    pub crack_softening: f64,
}

impl Surface {
    /// The surface of this program: Kupfer's biaxial strength, `K_c` for a confined strength of `f_c + 4.2 p`.
    pub const FULL: Self = Self {
        biaxial_ratio: 1.16,
        meridian_ratio: 0.69,
        lode_amplitude: 0.03,
        dilation: 0.2,
        confined_ductility: 70.0,
        tension_reduction: 0.8,
        crack_softening: 0.0,
    };

    /// The seed's pure surfaces, equations 3 and 4.
    pub const SEED: Self = Self {
        meridian_ratio: 1.0,
        lode_amplitude: 0.0,
        confined_ductility: 0.0,
        tension_reduction: 0.0,
        crack_softening: 0.0,
        ..Self::FULL
    };
}

/// A parameter that makes no material.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("concrete law: `{name}` is {value}, expected {expected}")]
pub struct LawError {
    /// Name of the parameter.
    pub name: &'static str,
    /// Value found.
    pub value: f64,
    /// What would be right.
    pub expected: String,
}

/// Least strain at the strength: the secant to it must leave room for the measured residual strain.
fn least_peak_strain(strength_pa: f64, youngs_modulus_pa: f64) -> f64 {
    1.4 * strength_pa / youngs_modulus_pa
}

impl ConcreteLaw {
    /// Ordinary concrete of a mean compressive strength \[Pa\]: Young's modulus of EN 1992-1-1 table 3.1 (`E_cm`), tensile strength `0.3 f^(2/3)` (MPa), fracture
    /// energy `73 f^0.18` J/m² (fib Model Code 2010, eq. 5.1-9), crushing energy [`CRUSHING_ENERGY_J_M2`], strain at the peak 0.002, from 51 MPa on
    /// the least that the law takes: `1.4 f_c / E`, within 12 % of `ε_c1 = 0.7 f^0.31` ‰ of the same table.
    pub fn of_strength(compressive_strength_pa: f64) -> Self {
        let mpa = compressive_strength_pa * 1e-6;
        let tensile_strength_pa = 0.3e6 * libm::pow(mpa, 2.0 / 3.0);
        let fracture_energy_j_m2 = 73.0 * libm::pow(mpa, 0.18);
        let youngs_modulus_pa = 22e9 * libm::pow(mpa / 10.0, 0.3);
        Self {
            density_kg_m3: 2400.0,
            youngs_modulus_pa,
            poisson_ratio: 0.2,
            compressive_strength_pa,
            tensile_strength_pa,
            fracture_energy_j_m2,
            crushing_energy_j_m2: CRUSHING_ENERGY_J_M2,
            peak_strain: least_peak_strain(compressive_strength_pa, youngs_modulus_pa).max(0.002),
            compression: CompressionCurve::Standard { elastic_share: ELASTIC_SHARE },
            tension: TensionCurve::Hordijk,
            surface: Surface::FULL,
        }
    }

    /// At a strain rate \[1/s\]: strengths by the factors of fib Model Code 2010, 5.1.11.2, eq. 5.1-112 to 5.1-115; energies
    /// with the strengths, so that strains and crack widths stay.
    pub fn at_rate(&self, rate_1_s: f64) -> Self {
        let (compression, tension) = (compression_rate_factor(rate_1_s), tension_rate_factor(rate_1_s));
        Self {
            compressive_strength_pa: compression * self.compressive_strength_pa,
            crushing_energy_j_m2: compression * self.crushing_energy_j_m2,
            tensile_strength_pa: tension * self.tensile_strength_pa,
            fracture_energy_j_m2: tension * self.fracture_energy_j_m2,
            youngs_modulus_pa: libm::pow((rate_1_s.abs() / 30e-6).max(1.0), 0.026) * self.youngs_modulus_pa,
            ..self.clone()
        }
    }

    /// Of a volume of which concrete is only this share, the rest being bars: all stresses and energies by it, strains as they are.
    #[must_use]
    pub fn thinned(&self, share: f64) -> Self {
        let stressed = |line: &[[f64; 2]]| line.iter().map(|p| [p[0], share * p[1]]).collect();
        let compression = match &self.compression {
            CompressionCurve::Points(line) => CompressionCurve::Points(stressed(line)),
            standard => standard.clone(),
        };
        let tension = match &self.tension {
            TensionCurve::Points(line) => TensionCurve::Points(stressed(line)),
            hordijk => hordijk.clone(),
        };
        Self {
            density_kg_m3: share * self.density_kg_m3,
            youngs_modulus_pa: share * self.youngs_modulus_pa,
            compressive_strength_pa: share * self.compressive_strength_pa,
            tensile_strength_pa: share * self.tensile_strength_pa,
            fracture_energy_j_m2: share * self.fracture_energy_j_m2,
            crushing_energy_j_m2: share * self.crushing_energy_j_m2,
            compression,
            tension,
            ..self.clone()
        }
    }

    /// Checks the numbers on their own; whether they suit an element's length is checked with the length
    /// ([`super::Backbones::new`]).
    pub fn check(&self) -> Result<(), LawError> {
        let s = &self.surface;
        let (fc, e) = (self.compressive_strength_pa, self.youngs_modulus_pa);
        let positive = "a positive number";
        let least = least_peak_strain(fc, e);
        let ranges: [(&'static str, f64, f64, f64, String); 15] = [
            ("density_kg_m3", self.density_kg_m3, 1.0, 1e5, positive.into()),
            ("youngs_modulus_pa", e, 1e6, 1e12, "1 MPa to 1 TPa".into()),
            ("poisson_ratio", self.poisson_ratio, 0.0, 0.45, "0 to 0.45".into()),
            ("compressive_strength_pa", fc, 1e4, 1e9, "10 kPa to 1 GPa".into()),
            ("tensile_strength_pa", self.tensile_strength_pa, 1e-4 * fc, 0.5 * fc, "up to f_c / 2".into()),
            ("fracture_energy_j_m2", self.fracture_energy_j_m2, 1e-6, 1e9, positive.into()),
            ("crushing_energy_j_m2", self.crushing_energy_j_m2, 1e-6, 1e9, positive.into()),
            (
                "peak_strain",
                self.peak_strain,
                least * (1.0 - 1e-9),
                0.05,
                format!("at least 1.4 f_c / E = {least:.2e}"),
            ),
            ("biaxial_ratio", s.biaxial_ratio, 1.0, 1.5, "1 to 1.5".into()),
            ("meridian_ratio", s.meridian_ratio, 0.6, 1.0, "0.6 to 1".into()),
            ("lode_amplitude", s.lode_amplitude, 0.0, 0.03, "0 to 0.03 (the surface stays convex)".into()),
            ("dilation", s.dilation, 0.0, 0.5, "0 to 0.5".into()),
            ("confined_ductility", s.confined_ductility, 0.0, 1e3, "0 or more".into()),
            ("tension_reduction", s.tension_reduction, 0.0, 0.95, "0 to 0.95".into()),
            ("crack_softening", s.crack_softening, 0.0, 1.0, "0 to 1".into()),
        ];
        for (name, value, low, high, expected) in ranges {
            if !(value >= low && value <= high) {
                return Err(LawError { name, value, expected });
            }
        }
        Ok(())
    }
}

/// Share of the strength up to which ordinary concrete is elastic. With it the line to the peak is that of EN 1992-1-1, eq. 3.14, within 1 % of the strength at 30 MPa and 4 %
/// from 20 to 60 MPa. At half the strain of the peak concrete of 30 MPa bears 0.77 of its strength (Mander's line 0.78, the parabola 0.75); elastic to 0.4 of the strength it would bear 0.84.
const ELASTIC_SHARE: f64 = 0.1;
/// Crushing energy of concrete that nothing confines \[J/m²\] (Coleman and Spacone, J. Struct. Eng. 127 (2001) 1257-1265, after Jansen and Shah's tests).
pub const CRUSHING_ENERGY_J_M2: f64 = 25e3;

/// Compressive strength at a strain rate over the static one, fib Model Code 2010, eq. 5.1-112.
pub fn compression_rate_factor(rate_1_s: f64) -> f64 {
    let ratio = (rate_1_s.abs() / 30e-6).max(1.0);
    if rate_1_s.abs() <= 30.0 { libm::pow(ratio, 0.014) } else { 0.012 * libm::cbrt(ratio) }
}

/// Tensile strength at a strain rate over the static one, fib Model Code 2010, eq. 5.1-114.
pub fn tension_rate_factor(rate_1_s: f64) -> f64 {
    let ratio = (rate_1_s.abs() / 1e-6).max(1.0);
    if rate_1_s.abs() <= 10.0 { libm::pow(ratio, 0.018) } else { 0.0062 * libm::cbrt(ratio) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `ε_c1 = 0.7 f^0.31 <= 2.8` ‰ of EN 1992-1-1, table 3.1.
    #[test]
    fn every_strength_makes_a_law_with_a_strain_at_the_peak_near_that_of_the_code() {
        for mpa in (12..=90).map(f64::from) {
            let law = ConcreteLaw::of_strength(1e6 * mpa);
            law.check().unwrap();
            let code = (0.7e-3 * mpa.powf(0.31)).min(2.8e-3);
            assert!((law.peak_strain / code - 1.0).abs() < 0.35, "{mpa}: {} {code}", law.peak_strain);
            assert!(
                mpa < 40.0 || (law.peak_strain / code - 1.0).abs() < 0.16,
                "{mpa}: {} {code}",
                law.peak_strain
            );
        }
    }
}
