//! Biaxial bending of the submodel against the fibre section.

use super::sections::{s1, s2};
use crate::material::concrete::ConcreteLaw;
use crate::material::fibre::{FibreOptions, FibreSection, SectionInput};
use crate::material::fibre_concrete;
use crate::rc::bend::{Bend, bend};
use crate::rc::member::{Joint, RcMember};
use crate::verify::{Case, Figure};

/// From the end section to the point of zero moment \[m\].
const LENGTH_M: f64 = 1.75;
/// Rotation by which all of these have passed their peak, or borne all but a few per cent of it \[rad\].
const UNTIL_RAD: f64 = 0.025;
const SOURCE: &str = "fibre section, Mander's concrete; band 0.98 to 1.12";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "member-biaxial-coarse",
            "The submodel of S2 pushed at 45° under n = 0.3, elements of 100 mm: largest moment over that of the fibre section.",
            || figures(&[("S2", s2(), 0.3)], 0.1),
        ),
        Case::long(
            "member-biaxial",
            "The submodel of S1 and S2 pushed at 45°, elements of 75 mm: largest moment over that of the fibre section.",
            || figures(&[("S1", s1(), 0.1), ("S1", s1(), 0.3), ("S2", s2(), 0.1), ("S2", s2(), 0.3)], 0.075),
        ),
    ]
}

fn figures(of: &[(&str, SectionInput, f64)], size_m: f64) -> Result<Vec<Figure>, String> {
    let one = |(name, input, share): &(&str, SectionInput, f64)| {
        let options = FibreOptions { deduct_bars: false, history: true };
        let input = SectionInput { options, ..input.clone() };
        let force = share * input.concrete_strength_pa * input.area_m2();
        let curvatures = FibreSection::curvatures_to(0.15);
        let fibres = FibreSection::of(&input, fibre_concrete::ConcreteLaw::Mander);
        let points = fibres.moment_curvature(force, 45f64.to_radians(), &curvatures);
        let reference = points.iter().map(|p| p.moment_nm).fold(0.0, f64::max);
        let concrete = ConcreteLaw::of_strength(input.concrete_strength_pa);
        let member =
            RcMember::new(&input, &concrete, Joint::Symmetry, LENGTH_M, size_m).map_err(|e| e.to_string())?;
        let load = Bend::monotonic(force, 45.0, UNTIL_RAD);
        let bent = bend(&member, &load, false, &|_| {}).map_err(|e| e.to_string())?;
        let peak = bent.points.iter().map(|p| p[1]).fold(0.0, f64::max);
        let what = format!("{name}, n = {share}: peak over that of the fibre section");
        Ok(Figure::absolute(what, "-", [1.05, peak / reference], 0.07, SOURCE))
    };
    of.iter().map(one).collect()
}
