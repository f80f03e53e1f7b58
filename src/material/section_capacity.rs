//! Bending capacity of a reinforced rectangular section under axial force.
//!
//! Plane sections remain plane, full bond, concrete without tension. Concrete follows the
//! parabola-rectangle of EN 1992-1-1, 3.1.7 (1), eq. 3.17-3.18, without partial factors:
//! `σ = f_c (1 − (1 − ε/ε_c2)^n)` up to `ε_c2`, then `f_c` up to `ε_cu2` ([`ConcreteLimits`]). Steel is elastic with a linear
//! branch after yield. The ultimate state is the strain profile through one of the three pivots of
//! EN 1992-1-1, figure 6.1: bar at its ultimate strain, edge at `ε_cu2`, or (section wholly compressed)
//! `ε_c2` at `(1 − ε_c2/ε_cu2) h` from the compressed edge. Concrete displaced by bars is deducted.
//!
//! The concrete part is integrated in closed form (up to C50/60; beyond it by Gauss's rule in [`PANELS`] panels), bars are points. Axial force and strain are positive
//! in **compression**; moments are about the centre of the gross rectangle. Uniaxial bending; no
//! confinement, no bar buckling. For the homogenised (J2) law see [`HomogenisedCapacity`].

use crate::base::root::{self, Close};
use crate::building::{Bar, Concrete, Homogenised, Section, SectionShape, Steel};
use serde::Serialize;

/// Strength up to which concrete has one parabola, and the largest of EN 1992-1-1 \[Pa\]: beyond it the values at it are used.
const ORDINARY_PA: f64 = 50e6;
const LARGEST_PA: f64 = 90e6;

/// The parabola and rectangle of a concrete, EN 1992-1-1 table 3.1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ConcreteLimits {
    /// Strain `ε_c2` at which the parabola reaches the strength.
    pub strain_c2: f64,
    /// Ultimate strain `ε_cu2` in bending.
    pub strain_cu2: f64,
    /// Exponent `n`.
    pub exponent: f64,
}

impl ConcreteLimits {
    /// Of a characteristic strength \[Pa\].
    pub fn of(strength_pa: f64) -> Self {
        if strength_pa <= ORDINARY_PA {
            return Self { strain_c2: 0.002, strain_cu2: 0.0035, exponent: 2.0 };
        }
        let beyond_mpa = (strength_pa.min(LARGEST_PA) - ORDINARY_PA) / 1e6;
        let short = ((LARGEST_PA - strength_pa).max(0.0) / 1e8).powi(4);
        Self {
            strain_c2: 1e-3 * (2.0 + 0.085 * libm::pow(beyond_mpa, 0.53)).min(2.6 + 35.0 * short),
            strain_cu2: 1e-3 * (2.6 + 35.0 * short),
            exponent: 1.4 + 23.4 * short,
        }
    }

    /// Stress over the strength at a strain; nothing in tension.
    pub fn share(&self, strain: f64) -> f64 {
        if strain <= 0.0 {
            return 0.0;
        }
        let short = 1.0 - strain.min(self.strain_c2) / self.strain_c2;
        if self.exponent == 2.0 { 1.0 - short * short } else { 1.0 - libm::pow(short, self.exponent) }
    }
}

/// Width of the bracket, of the one that it starts with, at which a search over strain profiles ends.
const EXACT: f64 = 1e-15;
/// Panels of each part of a section whose stress is no polynomial.
const PANELS: u32 = 16;

/// Stress-strain line of reinforcing steel, equal in tension and compression.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SteelLaw {
    /// Young's modulus \[Pa\].
    pub youngs_modulus_pa: f64,
    /// Yield strength \[Pa\].
    pub yield_strength_pa: f64,
    /// Tangent after yield \[Pa\]; zero for perfectly plastic steel.
    pub hardening_modulus_pa: f64,
    /// Tensile strain at rupture.
    pub ultimate_strain: f64,
}

impl SteelLaw {
    /// Elastic, perfectly plastic.
    pub fn perfectly_plastic(steel: &Steel) -> Self {
        Self {
            youngs_modulus_pa: steel.youngs_modulus_pa,
            yield_strength_pa: steel.yield_strength_pa,
            hardening_modulus_pa: 0.0,
            ultimate_strain: steel.ultimate_strain,
        }
    }

    /// Linear from yield to the ultimate strength at the ultimate strain.
    pub fn bilinear(steel: &Steel) -> Self {
        let span = steel.ultimate_strain - steel.yield_strength_pa / steel.youngs_modulus_pa;
        let rise = (steel.ultimate_strength_pa - steel.yield_strength_pa).max(0.0);
        let hardening_modulus_pa = if span > 0.0 { rise / span } else { 0.0 };
        Self { hardening_modulus_pa, ..Self::perfectly_plastic(steel) }
    }

    /// Stress \[Pa\] at a strain.
    pub fn stress_pa(&self, strain: f64) -> f64 {
        let elastic = self.youngs_modulus_pa * strain;
        if elastic.abs() <= self.yield_strength_pa {
            return elastic;
        }
        let beyond = strain.abs() - self.yield_strength_pa / self.youngs_modulus_pa;
        strain.signum() * (self.yield_strength_pa + self.hardening_modulus_pa * beyond)
    }
}

/// Which edge is compressed. `Width` and `Depth` are the section's own axes ([`SectionShape`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum CompressedEdge {
    /// The edge at the largest width coordinate.
    WidthHigh,
    /// The edge at the smallest width coordinate.
    WidthLow,
    /// The edge at the largest depth coordinate (the top of a beam).
    DepthHigh,
    /// The edge at the smallest depth coordinate (the bottom of a beam).
    DepthLow,
}

/// A plane strain profile, by its compressed edge and its slope.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Profile {
    /// Strain of the compressed edge.
    pub edge_strain: f64,
    /// Curvature \[1/m\].
    pub curvature_1_m: f64,
}

/// A state of the section: the strain profile and its resultants.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SectionState {
    /// Strain profile.
    pub profile: Profile,
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// Moment about the centre, positive when the chosen edge is compressed \[N m\].
    pub moment_nm: f64,
}

/// A rectangular section seen in one bending direction.
#[derive(Debug, Clone, PartialEq)]
pub struct FibreSection {
    /// Breadth normal to the bending direction \[m\].
    breadth_m: f64,
    /// Height in the bending direction \[m\].
    height_m: f64,
    /// `(distance from the compressed edge [m], area [m²])`, nearest first.
    bars: Vec<(f64, f64)>,
    /// Concrete strength \[Pa\].
    strength_pa: f64,
    concrete: ConcreteLimits,
    /// Steel.
    steel: SteelLaw,
}

impl FibreSection {
    /// A rectangle of `width_m` x `depth_m` with bars, bent so that `edge` is compressed.
    pub fn rectangle(
        [width_m, depth_m]: [f64; 2],
        bars: &[Bar],
        strength_pa: f64,
        steel: SteelLaw,
        edge: CompressedEdge,
    ) -> Self {
        let along_width = matches!(edge, CompressedEdge::WidthHigh | CompressedEdge::WidthLow);
        let (height_m, breadth_m) = if along_width { (width_m, depth_m) } else { (depth_m, width_m) };
        let sign =
            if matches!(edge, CompressedEdge::WidthHigh | CompressedEdge::DepthHigh) { 1.0 } else { -1.0 };
        let mut bars: Vec<(f64, f64)> = bars
            .iter()
            .map(|bar| {
                let coordinate = if along_width { bar.x_m } else { bar.y_m };
                let area = 0.25 * std::f64::consts::PI * bar.diameter_m * bar.diameter_m;
                (0.5 * height_m - sign * coordinate, area)
            })
            .collect();
        bars.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self { breadth_m, height_m, bars, strength_pa, concrete: ConcreteLimits::of(strength_pa), steel }
    }

    /// The section of a member with perfectly plastic steel; a plate counts as a strip of `strip_m`.
    pub fn of_section(
        section: &Section,
        concrete: &Concrete,
        steel: &Steel,
        strip_m: f64,
        edge: CompressedEdge,
    ) -> Self {
        let law = SteelLaw::perfectly_plastic(steel);
        match &section.shape {
            SectionShape::Rectangle { width_m, depth_m, bars, .. } => {
                Self::rectangle([*width_m, *depth_m], bars, concrete.strength_pa, law, edge)
            }
            SectionShape::Plate { thickness_m, bar_diameter_m, bar_spacing_m, bar_cover_m } => {
                // Bars of a strip, smeared into evenly spread points of the same total area.
                let count = (strip_m / bar_spacing_m).round().max(1.0);
                let share = (strip_m / bar_spacing_m / count).sqrt();
                let bars: Vec<Bar> = (0..count as usize)
                    .flat_map(|i| {
                        let x_m = strip_m * ((i as f64 + 0.5) / count - 0.5);
                        let y_m = 0.5 * thickness_m - bar_cover_m;
                        [y_m, -y_m].map(|y_m| Bar { x_m, y_m, diameter_m: bar_diameter_m * share })
                    })
                    .collect();
                Self::rectangle([strip_m, *thickness_m], &bars, concrete.strength_pa, law, edge)
            }
        }
    }

    /// Resultants of a strain profile.
    pub fn resultants(&self, profile: Profile) -> SectionState {
        let (mut force, mut moment) = self.concrete_resultants(profile);
        let half = 0.5 * self.height_m;
        for &(distance, area) in &self.bars {
            let strain = profile.edge_strain - profile.curvature_1_m * distance;
            let bar = (self.steel.stress_pa(strain) - self.concrete_stress_pa(strain)) * area;
            force += bar;
            moment += bar * (half - distance);
        }
        SectionState { profile, axial_force_n: force, moment_nm: moment }
    }

    /// Concrete stress \[Pa\]: parabola-rectangle, nothing in tension.
    fn concrete_stress_pa(&self, strain: f64) -> f64 {
        self.strength_pa * self.concrete.share(strain)
    }

    /// Force \[N\] and moment about the centre \[N m\] of the concrete.
    ///
    /// With `s` the distance from the compressed edge the strain is linear, so both pieces of the law are
    /// polynomials of degree 2 in `s` (3 with the lever): two Gauss points on each piece are exact. Other exponents have [`PANELS`] such pairs.
    fn concrete_resultants(&self, profile: Profile) -> (f64, f64) {
        let Profile { edge_strain, curvature_1_m: curvature } = profile;
        let h = self.height_m;
        let at = |strain: f64| {
            if curvature > 0.0 { ((edge_strain - strain) / curvature).clamp(0.0, h) } else { h }
        };
        let cuts = if curvature > 0.0 { [0.0, at(self.concrete.strain_c2), at(0.0)] } else { [0.0, 0.0, h] };
        let panels = if self.concrete.exponent == 2.0 { 1 } else { PANELS };
        let (mut force, mut moment) = (0.0, 0.0);
        for piece in cuts.windows(2) {
            let half = 0.5 * (piece[1] - piece[0]) / f64::from(panels);
            for panel in 0..panels {
                let mid = piece[0] + (2.0 * f64::from(panel) + 1.0) * half;
                for s in [mid - half / 3f64.sqrt(), mid + half / 3f64.sqrt()] {
                    let share = self.concrete_stress_pa(edge_strain - curvature * s) * self.breadth_m * half;
                    force += share;
                    moment += share * (0.5 * h - s);
                }
            }
        }
        (force, moment)
    }

    /// Ultimate strain profiles as one path: `t` in 0..1 turns about the far bar at its ultimate strain,
    /// 1..2 about the compressed edge at `ε_cu2` until the section is wholly compressed, 2..3 about the
    /// point `C` until compression is uniform. Axial force grows with `t`.
    fn ultimate_profile(&self, t: f64) -> Profile {
        let h = self.height_m;
        let far = self.bars.last().map_or(h, |bar| bar.0);
        let steel = self.steel.ultimate_strain;
        let ConcreteLimits { strain_c2, strain_cu2, .. } = self.concrete;
        if t <= 1.0 {
            let edge_strain = -steel + t * (strain_cu2 + steel);
            Profile { edge_strain, curvature_1_m: (edge_strain + steel) / far }
        } else if t <= 2.0 {
            let (first, last) = ((strain_cu2 + steel) / far, strain_cu2 / h);
            // Linear in the depth of the neutral axis, which spreads the points evenly.
            let depth = strain_cu2 / first + (t - 1.0) * (strain_cu2 / last - strain_cu2 / first);
            Profile { edge_strain: strain_cu2, curvature_1_m: strain_cu2 / depth }
        } else {
            let pivot = (1.0 - strain_c2 / strain_cu2) * h;
            let curvature_1_m = (3.0 - t) * strain_cu2 / h;
            Profile { edge_strain: strain_c2 + curvature_1_m * pivot, curvature_1_m }
        }
    }

    /// Axial force of pure tension (negative) and of uniform compression \[N\].
    pub fn axial_limits_n(&self) -> [f64; 2] {
        [0.0, 3.0].map(|t| self.resultants(self.ultimate_profile(t)).axial_force_n)
    }

    /// The ultimate state at an axial force \[N\], compression positive; `None` outside the
    /// [axial limits](Self::axial_limits_n).
    pub fn ultimate(&self, axial_force_n: f64) -> Option<SectionState> {
        let [tension, compression] = self.axial_limits_n();
        if !(tension..=compression).contains(&axial_force_n) {
            return None;
        }
        let t =
            increasing(0.0, 3.0, |t| self.resultants(self.ultimate_profile(t)).axial_force_n - axial_force_n);
        Some(self.resultants(self.ultimate_profile(t)))
    }

    /// The ultimate moment \[N m\] at an axial force \[N\]; zero outside the axial limits.
    pub fn ultimate_moment_nm(&self, axial_force_n: f64) -> f64 {
        self.ultimate(axial_force_n).map_or(0.0, |state| state.moment_nm)
    }

    /// `[N (N), M (N m)]` of the interaction diagram from pure tension to uniform compression.
    pub fn interaction(&self, points: usize) -> Vec<[f64; 2]> {
        let last = points.max(2) - 1;
        (0..=last)
            .map(|i| self.resultants(self.ultimate_profile(3.0 * i as f64 / last as f64)))
            .map(|state| [state.axial_force_n, state.moment_nm])
            .collect()
    }
}

/// The root of an increasing function between two arguments.
fn increasing(low: f64, high: f64, function: impl Fn(f64) -> f64) -> f64 {
    root::increasing([low, high], function, Close { value: 0.0, width: EXACT * (high - low) })
}

/// Plastic capacity of a rectangle made of the homogenised law: `M_p = σ_y b h²/4`, `N_p = σ_y b h` and
/// `M = M_p (1 − (N/N_p)²)` (Lubliner, Plasticity Theory, 1990, sec. 6.1: rectangle, no shear).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HomogenisedCapacity {
    /// Plastic moment without axial force \[N m\].
    pub plastic_moment_nm: f64,
    /// Squash load \[N\].
    pub plastic_force_n: f64,
}

impl HomogenisedCapacity {
    /// Of a rectangle `breadth_m` x `height_m`, `height_m` in the bending direction, at initial yield.
    pub fn of_rectangle(law: &Homogenised, breadth_m: f64, height_m: f64) -> Self {
        let yield_pa = law.hardening.first().map_or(0.0, |point| point.stress_pa);
        Self {
            plastic_moment_nm: 0.25 * yield_pa * breadth_m * height_m * height_m,
            plastic_force_n: yield_pa * breadth_m * height_m,
        }
    }

    /// Moment \[N m\] at an axial force \[N\] of either sign; zero beyond the squash load.
    pub fn moment_nm(&self, axial_force_n: f64) -> f64 {
        let ratio = axial_force_n / self.plastic_force_n;
        self.plastic_moment_nm * (1.0 - ratio * ratio).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEEL: SteelLaw = SteelLaw {
        youngs_modulus_pa: 200e9,
        yield_strength_pa: 500e6,
        hardening_modulus_pa: 2e9,
        ultimate_strain: 0.075,
    };

    fn bars(half_m: f64, diameter_m: f64, middle: bool) -> Vec<Bar> {
        let steps: &[f64] = if middle { &[-1.0, 0.0, 1.0] } else { &[-1.0, 1.0] };
        let grid = steps.iter().flat_map(|x| steps.iter().map(move |y| [*x, *y]));
        grid.filter(|p| *p != [0.0, 0.0])
            .map(|[x, y]| Bar { x_m: x * half_m, y_m: y * half_m, diameter_m })
            .collect()
    }

    fn check(section: &FibreSection, reference_kn_knm: &[[f64; 2]]) {
        for [force, moment] in reference_kn_knm {
            let computed = section.ultimate_moment_nm(force * 1e3) / 1e3;
            let error = (computed / moment - 1.0).abs();
            assert!(error < 2e-3, "N = {force} kN: {computed} kNm, reference {moment} kNm");
        }
    }

    /// 400 x 400 mm, f_c 30 MPa, 8 bars of 20 mm at 40 mm: moments of an independent section solver,
    /// steel hardening 1 %.
    #[test]
    fn ultimate_moment_of_a_section_with_eight_bars() {
        for edge in [CompressedEdge::WidthHigh, CompressedEdge::DepthLow] {
            let section = FibreSection::rectangle([0.4; 2], &bars(0.16, 0.020, true), 30e6, STEEL, edge);
            check(&section, &[[0.0, 219.34], [480.0, 282.90], [1440.0, 355.73], [2880.0, 339.81]]);
        }
    }

    /// 300 x 300 mm, f_c 25 MPa, 4 bars of 16 mm at 35 mm. The last row is concreteproperties' value;
    /// the other solver reports 112.43 there, at the first curvature step beyond `ε_cu2`.
    #[test]
    fn ultimate_moment_of_a_section_with_four_bars() {
        let edge = CompressedEdge::DepthHigh;
        let section = FibreSection::rectangle([0.3; 2], &bars(0.115, 0.016, false), 25e6, STEEL, edge);
        check(&section, &[[0.0, 54.36], [225.0, 78.08], [675.0, 115.65], [1350.0, 112.12]]);
    }

    /// The same of 70 and 90 MPa, against strips of 0.1 mm with the values of EN 1992-1-1 table 3.1 (0.2416 %, 0.2656 % and 1.4374; 0.26 % both and 1.4).
    #[test]
    fn strong_concrete_breaks_at_smaller_strains() {
        for (strength_mpa, reference) in [
            (70.0, [[480.0, 303.31], [3360.0, 566.27], [6720.0, 511.92]]),
            (90.0, [[480.0, 309.44], [4320.0, 660.98], [8640.0, 568.11]]),
        ] {
            let (bars, edge) = (bars(0.16, 0.020, true), CompressedEdge::WidthHigh);
            let section = FibreSection::rectangle([0.4; 2], &bars, strength_mpa * 1e6, STEEL, edge);
            check(&section, &reference);
        }
        let [at, beyond] = [50e6, 50.001e6].map(ConcreteLimits::of);
        assert!(
            (at.strain_cu2 - beyond.strain_cu2).abs() < 5e-6 && (at.exponent - beyond.exponent).abs() < 2e-3
        );
    }

    #[test]
    fn axial_limits_are_the_sums_of_the_materials() {
        let plastic = SteelLaw { hardening_modulus_pa: 0.0, ..STEEL };
        let edge = CompressedEdge::DepthHigh;
        let section = FibreSection::rectangle([0.4; 2], &bars(0.16, 0.020, true), 30e6, plastic, edge);
        let steel_area = 8.0 * 0.25 * std::f64::consts::PI * 0.02 * 0.02;
        let [tension, compression] = section.axial_limits_n();
        assert!((tension + 500e6 * steel_area).abs() < 1.0, "{tension}");
        // Steel at ε_c2 = 0.2 % is still elastic: 400 MPa.
        let expected = 30e6 * (0.16 - steel_area) + 400e6 * steel_area;
        assert!((compression - expected).abs() < 1.0, "{compression} {expected}");
        assert!(section.ultimate(1.001 * compression).is_none());
    }

    #[test]
    fn homogenised_rectangle() {
        let law = Homogenised {
            density_kg_m3: 2500.0,
            youngs_modulus_pa: 33e9,
            poisson_ratio: 0.2,
            hardening: vec![crate::building::HardeningPoint { plastic_strain: 0.0, stress_pa: 20e6 }],
            critical_plastic_strain: 0.1,
            rate_factor: None,
            critical_principal_strain: None,
        };
        let capacity = HomogenisedCapacity::of_rectangle(&law, 0.3, 0.5);
        assert!((capacity.plastic_moment_nm - 375e3).abs() < 1e-6);
        assert!((capacity.moment_nm(-1.5e6) - 375e3 * 0.75).abs() < 1e-6);
        assert_eq!(capacity.moment_nm(4e6), 0.0);
    }
}
