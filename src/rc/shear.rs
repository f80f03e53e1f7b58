//! A piece of a member sheared between parallel ends: its mesh, and published formulae with the strengths as they are (means, no safety factors).
//!
//! With both ends kept from turning the moment is zero at mid-length and `V l / 2` at the ends. So that the piece fails in shear and not by these moments, its
//! longitudinal bars stay elastic, as a shear test has them strong; the bending of the ends belongs to the hinges beside the spring.

use super::member::{BARS, RcMember};
use super::section_file::RcSection;
use crate::fe::law::Law;
use crate::material::concrete::{ConcreteLaw, LawError};
use crate::material::fibre::SectionInput;
use serde::Serialize;

/// The mesh of a piece of a length \[m\]; `elastic`: its longitudinal bars neither yield nor buckle nor rupture.
///
/// # Errors
/// If the concrete does not suit the elements.
pub fn piece(
    section: &RcSection,
    concrete: &ConcreteLaw,
    length_m: f64,
    mesh_size_m: f64,
    elastic: bool,
) -> Result<RcMember, LawError> {
    let mut member = RcMember::piece(&section.input, concrete, length_m, mesh_size_m)?;
    if elastic {
        let bars = &mut member.mesh.laws[BARS];
        *bars = Law { rebar: None, ..bars.clone() };
    }
    Ok(member)
}

/// What the formulae need of a section sheared along one of its axes.
#[derive(Debug, Clone, Copy)]
struct Sheared {
    width_m: f64,
    effective_m: f64,
    area_m2: f64,
    /// Bars in the half that is in tension \[m²\].
    tension_m2: f64,
    /// Area of tie legs over their spacing \[m\], their spacing \[m\] and strength \[Pa\].
    ties: [f64; 3],
    strength_mpa: f64,
    /// Axial force over area, compression positive \[MPa\].
    pressed_mpa: f64,
}

/// The sides that may be in tension, as signs along the axis of the shear.
const SIDES: [f64; 2] = [1.0, -1.0];

impl Sheared {
    /// Along x (axis 0) or y (axis 1), in concrete of a strength \[Pa\], in tension on a side.
    fn of(input: &SectionInput, strength_pa: f64, axis: usize, side: f64, axial_n: f64) -> Self {
        let place = |b: &crate::building::Bar| side * [b.x_m, b.y_m][axis];
        let area = |b: &crate::building::Bar| 0.25 * std::f64::consts::PI * b.diameter_m * b.diameter_m;
        let reach = input.bars.iter().map(place).fold(0.0, f64::max);
        let ties = input.ties.map_or([0.0, 1.0, 0.0], |t| {
            let leg = 0.25 * std::f64::consts::PI * t.diameter_m * t.diameter_m;
            [t.legs[axis] * leg / t.spacing_m, t.spacing_m, t.yield_strength_pa]
        });
        Self {
            width_m: input.size_m[1 - axis],
            effective_m: 0.5 * input.size_m[axis] + reach,
            area_m2: input.area_m2(),
            tension_m2: input.bars.iter().filter(|b| place(b) > 1e-6).map(area).sum(),
            ties,
            strength_mpa: strength_pa / 1e6,
            pressed_mpa: axial_n / input.area_m2() / 1e6,
        }
    }

    /// The same of a section with its concrete, on either side: a piece between ends that do not turn is in tension on one side at one end and on the other at the other.
    fn of_section(section: &RcSection, axis: usize, axial_n: f64) -> [Self; 2] {
        SIDES.map(|side| {
            Self::of(&section.input, section.concrete.compressive_strength_pa, axis, side, axial_n)
        })
    }
}

/// Axis along which a direction \[deg\] lies, in either sense: 0 along x, 1 along y; `None` for others, for which there are no formulae.
pub fn axis_of(direction_deg: f64) -> Option<usize> {
    let quarter = direction_deg / 90.0;
    (quarter == quarter.round()).then(|| usize::from(quarter % 2.0 != 0.0))
}

/// Shear force \[N\] at which the principal tension at the axis of a rectangle reaches the tensile strength:
/// `2/3 b h f_t sqrt(1 + σ / f_t)`, compression `σ` positive.
pub fn cracking_n(section: &RcSection, axial_n: f64) -> f64 {
    let ft = section.concrete.tensile_strength_pa;
    let area = section.input.area_m2();
    area / 1.5 * ft * (1.0 + axial_n / area / ft).max(0.0).sqrt()
}

/// EN 1992-1-1 6.2.2, eq. 6.2 with `γ_c = 1`: members without shear reinforcement, the weaker end of a piece \[N\].
pub fn en_without_ties_n(section: &RcSection, axis: usize, axial_n: f64) -> f64 {
    Sheared::of_section(section, axis, axial_n)
        .map(|s| without_ties_n(&s))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}

fn without_ties_n(s: &Sheared) -> f64 {
    let k = (1.0 + (0.2 / s.effective_m).sqrt()).min(2.0);
    let ratio = (s.tension_m2 / (s.width_m * s.effective_m)).min(0.02);
    let least = 0.035 * libm::pow(k, 1.5) * s.strength_mpa.sqrt();
    let own = 0.18 * k * libm::cbrt(100.0 * ratio * s.strength_mpa);
    let pressed = 0.15 * s.pressed_mpa.min(0.2 * s.strength_mpa);
    (own.max(least) + pressed).max(0.0) * s.width_m * s.effective_m * 1e6
}

/// EN 1992-1-1 6.2.3, eq. 6.8 and 6.9 with `γ = 1`, `z = 0.9 d`: the truss of the best inclination, `1 <= cot θ <= 2.5`, of the weaker end of a piece \[N\]; and its `cot θ`.
pub fn en_truss_n(section: &RcSection, axis: usize, axial_n: f64) -> [f64; 2] {
    let [one, other] = Sheared::of_section(section, axis, axial_n).map(|s| truss_n(&s));
    if other[0] < one[0] { other } else { one }
}

fn truss_n(s: &Sheared) -> [f64; 2] {
    let share = s.pressed_mpa / s.strength_mpa;
    let alpha = match share {
        n if n <= 0.0 => 1.0,
        n if n <= 0.25 => 1.0 + n,
        n if n <= 0.5 => 1.25,
        n => (2.5 * (1.0 - n)).max(0.0),
    };
    let arm = 0.9 * s.effective_m;
    let strut = alpha * s.width_m * arm * 0.6 * (1.0 - s.strength_mpa / 250.0) * s.strength_mpa * 1e6;
    let tie = s.ties[0] * s.ties[2] * arm;
    if tie <= 0.0 {
        return [0.0, 2.5];
    }
    let cot = (strut / tie - 1.0).max(1.0).sqrt().clamp(1.0, 2.5);
    [(tie * cot).min(strut / (cot + 1.0 / cot)), cot]
}

/// ASCE 41-17, eq. 10-3 (Sezen and Moehle 2004) without loss by ductility (`k = 1`), sheared along x (axis 0) or y (axis 1), for concrete of a strength
/// of `strength_pa`, an axial force of `axial_n` (compression positive) and a shear span of `span_m`: in tension on the side that bears less \[N\].
pub fn asce_column_n(input: &SectionInput, strength_pa: f64, axis: usize, axial_n: f64, span_m: f64) -> f64 {
    let of = |side: f64| asce_n(&Sheared::of(input, strength_pa, axis, side, axial_n), span_m);
    SIDES.map(of).into_iter().fold(f64::INFINITY, f64::min)
}

fn asce_n(s: &Sheared, span_m: f64) -> f64 {
    let slender = (span_m / s.effective_m).clamp(2.0, 4.0);
    let alpha = (4.0 * (1.0 - s.ties[1] / s.effective_m)).clamp(0.0, 1.0);
    let ties = alpha * s.ties[0] * s.ties[2] * s.effective_m;
    let root = 0.5 * s.strength_mpa.sqrt();
    let concrete = root / slender * (1.0 + s.pressed_mpa / root).max(0.0).sqrt() * 0.8e6 * s.area_m2;
    ties + concrete
}

/// Share of its shear strength from which a member loses strength in cycles that one push leaves: tests that were pushed to and fro fall then as tested columns do
/// (`docs/rc-columns.md`).
pub const CRITICAL_SHARE: f64 = 0.8;

/// Largest shear force of a push beside the shear strength of the undamaged column.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShearDemand {
    /// Largest shear force \[N\].
    pub largest_n: f64,
    /// [`asce_column_n`] \[N\].
    pub strength_n: f64,
}

impl ShearDemand {
    /// Of `[chord rotation (rad), moment (N m), ...]` points of a push along an axis of a member of a length \[m\]: `V = (M - N w) / L`, beside the strength with the side behind it in tension; of a push to and fro the sense in which
    /// it comes nearer to that. `None` for other directions.
    pub fn of(
        section: &RcSection,
        points: &[[f64; 3]],
        axial_n: f64,
        direction_deg: f64,
        length_m: f64,
    ) -> Option<Self> {
        let axis = axis_of(direction_deg)?;
        let strength_pa = section.concrete.compressive_strength_pa;
        // towards + of the axis the side at - of it is in tension
        let ahead = if direction_deg.rem_euclid(360.0) < 180.0 { 1.0 } else { -1.0 };
        let [to, fro] = SIDES.map(|sense| {
            let shear = |p: &[f64; 3]| sense * (p[1] / length_m - axial_n * p[0]);
            let sheared = Sheared::of(&section.input, strength_pa, axis, -sense * ahead, axial_n);
            let largest_n = points.iter().map(shear).fold(0.0, f64::max);
            Self { largest_n, strength_n: asce_n(&sheared, length_m) }
        });
        Some(if fro.share() > to.share() { fro } else { to })
    }

    /// Force over strength.
    pub fn share(&self) -> f64 {
        self.largest_n / self.strength_n
    }

    /// Whether it lies above [`CRITICAL_SHARE`].
    pub fn is_critical(&self) -> bool {
        self.share() > CRITICAL_SHARE
    }
}

/// Stiffness of an uncracked piece between ends that do not turn: bending `12 E I / l³` and shear `G 5/6 A / l` in series \[N/m\].
pub fn stiffness_n_m(section: &RcSection, axis: usize, length_m: f64) -> f64 {
    let input = &section.input;
    let e = section.concrete.youngs_modulus_pa;
    let g = 0.5 * e / (1.0 + section.concrete.poisson_ratio);
    let inertia = input.size_m[1 - axis] * input.size_m[axis].powi(3) / 12.0;
    let bending = 12.0 * e * inertia / length_m.powi(3);
    let shear = g * 5.0 / 6.0 * input.area_m2() / length_m;
    1.0 / (1.0 / bending + 1.0 / shear)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::source::Source;
    use crate::rc::section_file::{EXAMPLE, read};

    #[test]
    fn formulae_are_those_worked_by_hand() {
        let s = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        // 400 x 400, d = 360, f_c 38, f_t = 0.3 38^(2/3) = 3.391 MPa
        assert!((cracking_n(&s, 0.0) / 361.7e3 - 1.0).abs() < 1e-3, "{}", cracking_n(&s, 0.0));
        // N = 608 kN: 3.8 MPa, sqrt(1 + 1.1206) = 1.4562
        assert!((cracking_n(&s, 608e3) / 526.8e3 - 1.0).abs() < 1e-3);
        // k = 1.7454, 3 bars of 20: rho = 0.006545, (24.87)^(1/3) = 2.919, 0.917 MPa
        assert!((en_without_ties_n(&s, 1, 0.0) / 132.06e3 - 1.0).abs() < 1e-3);
        // 2 d8 / 150: 0.6702 mm2/mm x 550 x 324 x 2.5
        let [truss, cot] = en_truss_n(&s, 1, 0.0);
        assert!((truss / 298.6e3 - 1.0).abs() < 1e-3 && cot == 2.5, "{truss} {cot}");
        // 0.6702 x 550 x 360 + 3.0822 / 2 x 0.8 x 160000
        let asce = |axial_n, span_m| asce_column_n(&s.input, 38e6, 1, axial_n, span_m);
        assert!((asce(0.0, 0.5) / 329.96e3 - 1.0).abs() < 1e-3);
        // N = 608 kN: sqrt(1 + 3.8 / 3.0822) = 1.4943; span 1.08 m: 3 d
        assert!((asce(608e3, 1.08) / (132.70e3 + 131.51e3 * 1.4943) - 1.0).abs() < 1e-3);
        assert_eq!(asce(0.0, 9.0), asce(0.0, 4.0 * 0.36), "a span beyond 4 d counts as 4 d");
    }

    /// Turned over, a section with other bars at its bottom than at its top bears the same, of a piece and of the end of a member.
    #[test]
    fn what_is_turned_over_bears_the_same() {
        let mut s = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        s.input.bars.retain(|b| b.y_m < 0.1);
        let mut over = s.clone();
        over.input.bars.iter_mut().for_each(|b| b.y_m = -b.y_m);
        let asce = |s: &RcSection| asce_column_n(&s.input, 38e6, 1, 2e5, 0.5);
        assert_eq!(asce(&s), asce(&over));
        assert_eq!(en_without_ties_n(&s, 1, 2e5), en_without_ties_n(&over, 1, 2e5));
        assert_eq!(en_truss_n(&s, 1, 2e5), en_truss_n(&over, 1, 2e5));
        let points = [[0.0; 3], [0.01, 200e3, 0.0]];
        let of = |s: &RcSection, degrees: f64| ShearDemand::of(s, &points, 2e5, degrees, 1.08).unwrap();
        assert_eq!(of(&s, 90.0), of(&over, 270.0));
        // bars behind the push, or only those at mid-depth
        assert!(of(&s, 90.0).strength_n > 1.2 * of(&s, 270.0).strength_n);
    }

    #[test]
    fn the_shear_force_is_the_moment_less_that_of_the_leaning_axial_force() {
        let s = read(&Source::new("section.toml", EXAMPLE)).unwrap();
        // 400 kN m / 1.08 m - 608 kN x 0.01, of 329.21 kN (before)
        let points = [[0.0; 3], [0.01, 400e3, 0.0], [0.02, 380e3, 0.0]];
        let of = |direction_deg| ShearDemand::of(&s, &points, 608e3, direction_deg, 1.08);
        let demand = of(90.0).unwrap();
        assert!((demand.largest_n / 364.29e3 - 1.0).abs() < 1e-4 && demand.is_critical(), "{demand:?}");
        assert!((demand.share() / (364.29 / 329.21) - 1.0).abs() < 2e-3);
        assert_eq!(of(270.0), of(90.0));
        assert_eq!(of(45.0), None);
        let axes = [0.0, 90.0, 180.0, 270.0, -90.0, 45.0].map(axis_of);
        assert_eq!(axes, [Some(0), Some(1), Some(0), Some(1), Some(1), None]);
        let light = ShearDemand::of(&s, &[[0.01, 200e3, 0.0]], 0.0, 0.0, 1.08).unwrap();
        assert!(!light.is_critical(), "{light:?}");
    }
}
