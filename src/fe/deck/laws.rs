//! Material, section and hourglass control of a part as a law.

use super::error::{At, Messages};
use super::raw::{Raw, RawMaterial, RawPart, RawPlastic, RawSection};
use super::read_material::DEFAULT_COEFFICIENT;
use crate::building::HardeningPoint;
use crate::fe::law::{ElementForm, Erosion, Hourglass, Law};

/// Plastic strain to which a straight hardening line is drawn.
const FAR_STRAIN: f64 = 100.0;

/// What a part's elements are.
#[derive(Debug, Clone)]
pub(super) enum PartLaw {
    /// Hexahedra.
    Solid(Law),
    /// Bars of a cross-section.
    Truss(Law, f64),
}

/// The law of a part; `None` after errors.
pub(super) fn law_of(raw: &Raw, part: &RawPart, messages: &mut Messages) -> Option<PartLaw> {
    let missing = |what: &str, id: u64, keyword: &str, messages: &mut Messages| {
        let message = format!("part {}: there is no {what} {id}", part.id);
        messages.error(part.at, "unknown-id", message, "", &format!("define it with {keyword}"));
    };
    let section = raw.sections.get(&part.section).map(|s| s.0);
    if section.is_none() {
        missing("section", part.section, "*SECTION_SOLID or *SECTION_BEAM", messages);
    }
    let material = raw.materials.get(&part.material);
    if material.is_none() {
        missing("material", part.material, "one of the *MAT keywords", messages);
    }
    let hourglass = match part.hourglass {
        0 => raw.default_hourglass.or_else(|| {
            if matches!(section, Some(RawSection::Solid { full: false })) {
                let text = "there is no hourglass control in the deck: viscous, coefficient 0.1";
                messages.note(part.at, text);
            }
            Some(Hourglass::Viscous { coefficient: DEFAULT_COEFFICIENT })
        }),
        id => {
            let found = raw.hourglass.get(&id).map(|h| h.0);
            if found.is_none() {
                missing("hourglass control", id, "*HOURGLASS", messages);
            }
            found
        }
    };
    let (section, (material, at), hourglass) = (section?, material?, hourglass?);
    let mut erosion = Erosion { plastic_strain: material.failure_strain, ..Erosion::NEVER };
    for more in raw.erosions.iter().filter(|e| e.material == part.material) {
        erosion.plastic_strain = erosion.plastic_strain.min(more.plastic_strain);
        erosion.principal_strain = erosion.principal_strain.min(more.principal_strain);
    }
    if section == (RawSection::Solid { full: true }) && erosion.plastic_strain.is_finite() {
        let text = "fully integrated elements erode when the mean plastic strain of their points reaches the limit, not at the first point";
        messages.note(part.at, text);
    }
    let form = match section {
        RawSection::Solid { full: false } => ElementForm::OnePoint(hourglass),
        RawSection::Solid { full: true } => ElementForm::FullyIntegrated,
        RawSection::Truss { .. } => ElementForm::default(),
    };
    let law = Law {
        concrete: None,
        rebar: None,
        density_kg_m3: material.density,
        youngs_modulus_pa: material.youngs,
        poisson_ratio: material.poisson,
        hardening: hardening(raw, material, *at, messages)?,
        rate: material.rate,
        erosion,
        form,
    };
    Some(match section {
        RawSection::Truss { area } => PartLaw::Truss(law, area),
        RawSection::Solid { .. } => PartLaw::Solid(law),
    })
}

fn hardening(
    raw: &Raw,
    material: &RawMaterial,
    at: At,
    messages: &mut Messages,
) -> Option<Vec<HardeningPoint>> {
    let point = |plastic_strain: f64, stress_pa: f64| HardeningPoint { plastic_strain, stress_pa };
    let points = |list: &[[f64; 2]]| list.iter().map(|p| point(p[0], p[1])).collect();
    Some(match &material.plastic {
        RawPlastic::Elastic => Vec::new(),
        RawPlastic::Bilinear { yield_stress, tangent } if *tangent == 0.0 => vec![point(0.0, *yield_stress)],
        RawPlastic::Bilinear { yield_stress, tangent } => {
            // over plastic strain: dσ/dp = E E_t / (E - E_t)
            let slope = material.youngs * tangent / (material.youngs - tangent);
            vec![point(0.0, *yield_stress), point(FAR_STRAIN, yield_stress + FAR_STRAIN * slope)]
        }
        RawPlastic::Points(list) => points(list),
        RawPlastic::Curve(id) => {
            let Some((list, place)) = raw.curves.get(id) else {
                let message = format!("the hardening curve {id} does not exist");
                messages.error(at, "unknown-id", message, "in this material", "define it with *DEFINE_CURVE");
                return None;
            };
            let starts = list.first().is_some_and(|p| p[0] == 0.0);
            if !starts || list.iter().any(|p| p[1] <= 0.0) {
                let message = format!("curve {id} is no hardening curve");
                let help = "yield stress over plastic strain, from strain 0, all stresses positive";
                messages.error(*place, "unsupported-value", message, "", help);
                return None;
            }
            points(list)
        }
    })
}
