//! The records in `kb/studies`: what they say of forces and energies is possible.

use fallwerk::base::tree::Format;
use fallwerk::building::{Building, parse};
use fallwerk::study::Study;
use std::fs;
use std::path::Path;

/// The records with their buildings.
fn records() -> Vec<(Study, Building)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut list = Vec::new();
    for item in fs::read_dir(root.join("kb/studies")).unwrap() {
        let text = fs::read_to_string(item.unwrap().path()).unwrap();
        let study: Study = serde_json::from_str(&text).unwrap();
        let name = format!("{}.toml", study.building);
        let files = ["kb/plan", "kb/irregular", "buildings"].map(|folder| root.join(folder).join(&name));
        let file = files.iter().find(|file| file.exists()).expect("every record has its building");
        let building = parse(&fs::read_to_string(file).unwrap(), Format::Toml, &name).unwrap();
        list.push((study, building));
    }
    list
}

/// What sections bore before they broke is about what they can bear: `σ b h² / 4` in bending, of which coarse meshes bear up to 1.3 times (docs/decisions/finite-elements.md), `σ b h` along themselves, with the largest stress of the law.
#[test]
fn sections_break_under_what_they_can_bear() {
    let (mut moments, mut count) = (Vec::new(), 0);
    for (study, building) in records() {
        for end in study.facts.ends.iter().filter(|end| end.fracture_s.is_some()) {
            let member = building.member(&end.member).unwrap();
            count += 1;
            let Some(force) = end.fracture_force else { continue };
            let largest = building.law_of(member).hardening.iter().map(|p| p.stress_pa).fold(0.0, f64::max);
            let size = member.size_m();
            let across: Vec<f64> = (0..3).filter(|i| *i != member.axis).map(|i| size[i]).collect();
            let squash_n = largest * across[0] * across[1];
            let depth_m = across[0].max(across[1]);
            let at = format!("{}: {} {force:?}", study.building, end.id);
            assert!(force.axial_n.abs() < 1.1 * squash_n && force.shear_n < 0.6 * squash_n, "{at}");
            assert!(force.bending_nm < 1.5 * squash_n * depth_m / 4.0, "{at}");
            moments.push(force.bending_nm / (squash_n * depth_m / 4.0));
        }
    }
    assert!(moments.len() > 100 && moments.len() * 10 > count * 9, "{} of {count}", moments.len());
    moments.sort_by(f64::total_cmp);
    let median = moments[moments.len() / 2];
    assert!((0.8..1.3).contains(&median), "{median}");
}

/// Energy balance of the recorded energies, as far as their four digits go.
#[test]
fn energies_balance() {
    for (study, _) in records() {
        let energies = study.energies.expect("every record has energies");
        for e in [Some(energies.end), energies.first_contact].into_iter().flatten() {
            let held = e.kinetic_j + e.internal_j + e.hourglass_j + e.viscous_j;
            let done = e.gravity_j + e.contact_j + e.friction_j + e.removed_j + e.released_j + e.residual_j;
            let largest = [held, e.gravity_j, e.contact_j].into_iter().fold(1.0, |m: f64, x| m.max(x.abs()));
            // what the dead load stores is in `held` alone
            assert!(held - done > -5e-3 * largest, "{}: {held} {done}", study.building);
            assert!(e.residual_j.abs() < 0.05 * largest, "{}", study.building);
        }
    }
}
