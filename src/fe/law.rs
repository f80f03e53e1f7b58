//! What a group of elements is made of and how it is integrated: material law, erosion, element form.

pub use crate::building::CowperSymonds;
use crate::building::{HardeningPoint, Homogenised};
use crate::material::concrete::ConcreteLaw;
use crate::material::j2::HardeningTable;
use crate::material::rate::RateFactor;
use crate::material::rebar::RebarLaw;
use serde::{Deserialize, Serialize};

/// Material and element form of a group of elements: what a part's material, section and hourglass control say in keyword decks.
/// Numbers are SI; a deck in other consistent units passes through unchanged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Law {
    /// Density \[kg/m³\].
    pub density_kg_m3: f64,
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Yield stress over equivalent plastic strain, first strain zero, strains increasing, constant beyond the last
    /// point; empty: elastic.
    pub hardening: Vec<HardeningPoint>,
    /// Rate factor on the yield stress ([`crate::material::rate`]).
    pub rate: Option<CowperSymonds>,
    /// When an element dies.
    pub erosion: Erosion,
    /// How the elements are integrated.
    pub form: ElementForm,
    /// Concrete instead of J2 plasticity: one-point elements, their length (cube root of the volume) in the crack band.
    pub concrete: Option<ConcreteLaw>,
    /// Law of bars with cycles, buckling and rupture instead of the hardening table; for trusses only.
    pub rebar: Option<RebarLaw>,
}

impl Law {
    /// Yield stress over plastic strain, with the rate factor.
    pub fn table(&self) -> HardeningTable {
        let table = HardeningTable::new(&self.hardening);
        match self.rate {
            Some(CowperSymonds { c_1_s, p }) => table.with_rate(RateFactor { c_1_s, p }),
            None => table,
        }
    }
}

/// Strains at which an element erodes; infinite: never.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Erosion {
    /// Equivalent plastic strain (seed paper, equation 1).
    pub plastic_strain: f64,
    /// Largest principal strain (tension).
    pub principal_strain: f64,
}

impl Erosion {
    /// No erosion by strain.
    pub const NEVER: Self = Self { plastic_strain: f64::INFINITY, principal_strain: f64::INFINITY };
}

impl Default for Erosion {
    fn default() -> Self {
        Self::NEVER
    }
}

/// How a hexahedron is integrated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ElementForm {
    /// One point with hourglass control.
    OnePoint(Hourglass),
    /// Eight points, volume strain averaged (for comparison; slow).
    FullyIntegrated,
}

/// Hourglass control of the one-point hexahedron.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Hourglass {
    /// Assumed strain, quintessential bending incompressible (Belytschko and Bindeman 1993): exact bending of a beam
    /// of one element across.
    Asqbi,
    /// Assumed deviatoric strain, of the same paper.
    Ads,
    /// Assumed strain, mean dilatation, of the same paper.
    Asmd,
    /// Stiffness form of Flanagan and Belytschko (1981).
    Stiffness {
        /// Dimensionless factor, usually 0.03 to 0.1.
        coefficient: f64,
    },
    /// Viscous form of Flanagan and Belytschko (1981).
    Viscous {
        /// Dimensionless factor, usually 0.05 to 0.15.
        coefficient: f64,
    },
}

impl Default for ElementForm {
    fn default() -> Self {
        Self::OnePoint(Hourglass::Asqbi)
    }
}

/// Density of steel bars \[kg/m³\].
const STEEL_KG_M3: f64 = 7850.0;

impl From<ConcreteLaw> for Law {
    fn from(concrete: ConcreteLaw) -> Self {
        Self {
            density_kg_m3: concrete.density_kg_m3,
            youngs_modulus_pa: concrete.youngs_modulus_pa,
            poisson_ratio: concrete.poisson_ratio,
            hardening: Vec::new(),
            rate: None,
            erosion: Erosion::NEVER,
            form: ElementForm::default(),
            concrete: Some(concrete),
            rebar: None,
        }
    }
}

impl From<RebarLaw> for Law {
    fn from(rebar: RebarLaw) -> Self {
        Self {
            density_kg_m3: STEEL_KG_M3,
            youngs_modulus_pa: rebar.youngs_modulus_pa,
            poisson_ratio: 0.3,
            hardening: Vec::new(),
            rate: None,
            erosion: Erosion::NEVER,
            form: ElementForm::default(),
            concrete: None,
            rebar: Some(rebar),
        }
    }
}

impl From<&Homogenised> for Law {
    fn from(law: &Homogenised) -> Self {
        Self {
            density_kg_m3: law.density_kg_m3,
            youngs_modulus_pa: law.youngs_modulus_pa,
            poisson_ratio: law.poisson_ratio,
            hardening: law.hardening.clone(),
            rate: law.rate_factor,
            erosion: Erosion {
                plastic_strain: law.critical_plastic_strain,
                principal_strain: law.critical_principal_strain.unwrap_or(f64::INFINITY),
            },
            form: ElementForm::default(),
            concrete: None,
            rebar: None,
        }
    }
}
