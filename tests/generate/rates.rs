//! Members whose law knows the strain rate.

use super::*;
use fallwerk::building::{CowperSymonds, Material};
use fallwerk::mbs::simulate;

const C_1_S: f64 = 40.0;

/// The reference building with a rate factor, whose curves are those without.
fn rated() -> Generated {
    let mut building = reference(|t| t);
    for material in building.materials.values_mut() {
        if let Material::Homogenised(law) = material {
            law.rate_factor = Some(CowperSymonds { c_1_s: C_1_S, p: 5.0 });
        }
    }
    let (rules, mut store, _cache) = knowledge();
    generate(&building, &rules, &mut store, Derive::Never, &|_| {}).unwrap()
}

#[test]
fn what_yields_or_is_crushed_bears_more_the_faster_it_does() {
    let Generated { model, .. } = rated();
    model.check().expect("a sound model");
    let flows = model.bushings.iter().filter(|b| b.has_capacity());
    assert!(flows.clone().count() > 40 && flows.clone().all(|b| b.rate_factor.is_some()));
    let end = model.bushings.iter().find(|b| b.id == "C1-A1.top").unwrap();
    let factor = end.rate_factor.unwrap();
    // two elements of 0.43 m across a column of 0.4 m: strains at a quarter of its depth are about θ (0.1 / 0.43)
    let doubled = C_1_S * 0.43 / 0.1;
    assert!(factor.rotation_rad_s.iter().all(|c| (c / doubled - 1.0).abs() < 0.25), "{factor:?}");
    // up to the middle of the clear length and somewhat further: 1.7 m
    assert!((factor.elongation_m_s.unwrap() / C_1_S - 1.7).abs() < 0.1, "{factor:?}");
    let faces = &model.contact.crushing;
    assert!(!faces.is_empty() && faces.iter().all(|f| f.rate_factor.unwrap().speed_m_s == C_1_S * 1.5));
    let without = generated(&reference(|t| t)).unwrap().model;
    assert!(without.bushings.iter().all(|b| b.rate_factor.is_none()));
}

/// FE with the same law strikes the ground at 1.378 s, without a rate factor at 1.320 s (`kb/rates`).
#[test]
fn a_building_falls_later() {
    let contact_s = |model| simulate(model).unwrap().first_ground_contact_s.unwrap();
    let (with, without) =
        (contact_s(&rated().model), contact_s(&generated(&reference(|t| t)).unwrap().model));
    // half of that at least
    assert!((0.029..=0.058).contains(&(with - without)), "{with} {without}");
}
