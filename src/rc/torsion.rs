//! A piece of a member twisted: bounds of the cracking torque, and the space truss.

use super::pushover::torsion_constant;
use super::section_file::RcSection;

/// Torque \[N m\] at which Saint-Venant's largest shear stress at the faces gives a principal tension of the tensile strength, with an axial force:
/// `α b² h f_t sqrt(1 + σ / f_t)`; `α = 1 / (3 + 1.8 b / h)` (Timoshenko and Goodier, art. 109: 0.208 for a square).
pub fn elastic_cracking_nm(section: &RcSection, axial_n: f64) -> f64 {
    let [b, h] = sides(section);
    b * b * h / (3.0 + 1.8 * b / h) * strength_pa(section, axial_n)
}

/// As before with the stress redistributed over the section, `b² (3 h - b) / 6 f_t` (sand heap: `b³ f_t / 3` for a square) \[N m\].
pub fn plastic_cracking_nm(section: &RcSection, axial_n: f64) -> f64 {
    let [b, h] = sides(section);
    b * b * (3.0 * h - b) / 6.0 * strength_pa(section, axial_n)
}

fn sides(section: &RcSection) -> [f64; 2] {
    let [x, y] = section.input.size_m;
    [x.min(y), x.max(y)]
}

fn strength_pa(section: &RcSection, axial_n: f64) -> f64 {
    let ft = section.concrete.tensile_strength_pa;
    ft * (1.0 + axial_n / section.input.area_m2() / ft).max(0.0).sqrt()
}

/// Space truss of EN 1992-1-1 6.3.2, eq. 6.26 to 6.30 with `γ = 1` \[N m\]: ties, longitudinal bars and struts at the best inclination, `1 <= cot θ <= 2.5`.
/// The axial force in compression relieves the bars. `None` without ties.
pub fn space_truss_nm(section: &RcSection, axial_n: f64) -> Option<f64> {
    let ties = section.input.ties?;
    let [x, y] = section.input.size_m;
    // wall: area over perimeter, at least twice the distance of the bars' centres from the face
    let edge = ties.cover_m + ties.diameter_m + 0.5 * thickest_m(section);
    let wall = (x * y / (2.0 * (x + y))).max(2.0 * edge);
    let (a, b) = (x - wall, y - wall);
    let (area, around) = (a * b, 2.0 * (a + b));
    let leg = 0.25 * std::f64::consts::PI * ties.diameter_m * ties.diameter_m;
    let tie = 2.0 * area * leg / ties.spacing_m * ties.yield_strength_pa;
    let bars = section.steel_m2() * section.input.steel.yield_strength_pa + axial_n;
    let bars = 2.0 * area * bars.max(0.0) / around;
    let mpa = section.concrete.compressive_strength_pa / 1e6;
    let strut = 2.0 * 0.6e6 * (1.0 - mpa / 250.0) * mpa * area * wall;
    let at = |cot: f64| (tie * cot).min(bars / cot).min(strut / (cot + 1.0 / cot));
    Some((0..=150).map(|i| at(1.0 + 0.01 * f64::from(i))).fold(0.0, f64::max))
}

fn thickest_m(section: &RcSection) -> f64 {
    section.input.bars.iter().map(|b| b.diameter_m).fold(0.0, f64::max)
}

/// Saint-Venant's torsional stiffness of the uncracked piece, `G I_t / l` \[N m/rad\].
pub fn stiffness_nm_rad(section: &RcSection, length_m: f64) -> f64 {
    let g = 0.5 * section.concrete.youngs_modulus_pa / (1.0 + section.concrete.poisson_ratio);
    g * torsion_constant(section.input.size_m) / length_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::source::Source;
    use crate::rc::section_file::{EXAMPLE, read};

    #[test]
    fn a_square_has_the_known_bounds() {
        let s = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        let unit = 0.4f64.powi(3) * s.concrete.tensile_strength_pa;
        assert!((elastic_cracking_nm(&s, 0.0) / unit - 0.2083).abs() < 1e-3);
        assert!((plastic_cracking_nm(&s, 0.0) / unit - 1.0 / 3.0).abs() < 1e-12);
        // wall 100 mm, A_k = 0.09 m2, ties 50.27 mm2 / 150 mm x 550 MPa = 184.3 kN/m: 33.2 kN m at 45°, bars 2513 mm2 x 550 / 1.2 m = 1152 kN/m:
        // 207 kN m; cot = sqrt(1152 / 184.3) = 2.5
        let truss = space_truss_nm(&s, 0.0).unwrap();
        assert!((truss / 82.9e3 - 1.0).abs() < 2e-3, "{truss}");
    }
}
