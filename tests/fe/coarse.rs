//! Meshes of any target size: no member is lost, none has another mass.

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, parse, read};
use fallwerk::fe::contact::RigidSurfaces;
use fallwerk::fe::dynamics::Dynamics;
use fallwerk::fe::hexahedron::volume_m3;
use fallwerk::fe::merge::MOST_CHANGE;
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::run::{FeError, FeOptions, run};
use std::path::Path;

/// Sizes that divide nothing evenly among those that do \[m\].
const SIZES_M: [f64; 12] = [0.1, 0.15, 0.25, 0.4, 0.5, 0.7, 0.9, 1.0, 1.3, 2.0, 3.1, 5.0];

fn building(members: &str) -> Building {
    let text = EXAMPLE.replacen("[[supports]]", &format!("{members}\n[[supports]]"), 1);
    parse(&text, Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// The reference building with a wall with a door, a slender column off the lines of the others, a brace and a turned beam.
fn mixed() -> Building {
    building(
        "[[members]]\nid = \"W1\"\nkind = \"wall\"\nsection = \"slab\"\nfrom = [6.075, 0.2, 0]\nto = [6.075, 4.8, 3]\n\
         openings = [{ from = [1, 0], to = [2, \"2.1 m\"] }]\n\n\
         [[members]]\nid = \"C1-X\"\nkind = \"column\"\nsection = \"column\"\nfrom = [2.9, 2.5, 0]\nto = [2.9, 2.5, 3.5]\n\n\
         [[members]]\nid = \"X1\"\nkind = \"brace\"\nsection = \"beam\"\nfrom = [0, 5, 4.2]\nto = [6, 5, 6.1]\n\n\
         [[members]]\nid = \"C2-T\"\nkind = \"column\"\nsection = \"column\"\nfrom = [2.9, 2.5, 3.5]\nto = [2.9, 2.5, 7]\nrotation_deg = 30\n",
    )
}

/// Every member has elements, its mass is that of the building, and where it lies on mesh planes its volume and lengths changed by no more than the mesher allows.
fn check(building: &Building, size_m: f64) {
    let (mesh, snapped) = Mesh::of(building, size_m);
    assert!(mesh.unmeshed(building).is_empty());
    let volumes = Partition::of(building).volumes(building.members.len());
    let mut mass = vec![0.0; building.members.len()];
    for element in &mesh.elements {
        let volume = volume_m3(&element.nodes.map(|n| mesh.nodes[n]));
        assert!(volume > 0.0);
        mass[element.part] += mesh.laws[element.law].density_kg_m3 * element.smear * volume;
    }
    for (index, member) in building.members.iter().enumerate() {
        let expected = building.law_of(member).density_kg_m3 * volumes[index];
        let words = format!("{} at {size_m} m: {} kg, {expected} kg", member.id, mass[index]);
        assert!((mass[index] / expected - 1.0).abs() < 1e-9, "{words}");
    }
    for one in snapped.iter().filter(|s| building.members.iter().any(|m| m.id == s.member && !m.is_skew())) {
        let change = one.volume_ratio.max(1.0 / one.volume_ratio);
        assert!(change < MOST_CHANGE + 1e-6, "{} at {size_m} m: {change}", one.member);
    }
    let total: f64 =
        volumes.iter().zip(&building.members).map(|(v, m)| v * building.law_of(m).density_kg_m3).sum();
    let body = Dynamics::new(&mesh, 9.81, RigidSurfaces::default(), false);
    assert!((body.mass_kg.iter().sum::<f64>() / total - 1.0).abs() < 1e-9, "at {size_m} m");
}

#[test]
fn the_mass_of_each_member_is_meshed_at_any_size() {
    let shipped = |name: &str| {
        read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings").join(name))
            .unwrap_or_else(|e| panic!("{e}"))
    };
    for name in ["three-storey-frame.toml", "three-storey-frame-wall.toml"] {
        let building = shipped(name);
        SIZES_M.into_iter().for_each(|size_m| check(&building, size_m));
    }
    let tall = shipped("six-storey.toml");
    SIZES_M.into_iter().filter(|s| *s >= 0.5).for_each(|size_m| check(&tall, size_m));
    let mixed = mixed();
    SIZES_M.into_iter().for_each(|size_m| check(&mixed, size_m));
}

/// Faces that a fine mesh merges are merged as before: beams 50 mm narrower on each side than their columns bring no planes of their own.
#[test]
fn only_what_would_be_lost_keeps_its_faces() {
    let building = building("");
    for size_m in [0.4, 1.0, 5.0] {
        let (mesh, _) = Mesh::of(&building, size_m);
        assert!(mesh.nodes.iter().all(|n| (n[1].abs() - 0.15).abs() > 1e-6), "at {size_m} m");
    }
    let (mesh, _) = Mesh::of(&building, 1.0);
    let soffit = |n: &&[f64; 3]| (n[2] - 3.0).abs() < 1e-9;
    assert!(mesh.nodes.iter().any(|n| soffit(&n)), "the beams lie under the slab");
}

/// In elements of 2 m the whole building is there and at rest where nothing is removed.
#[test]
fn a_building_in_huge_elements_stands() {
    let whole = building("");
    let mut still = whole.clone();
    still.events.clear();
    let options = FeOptions { mesh_size_m: Some(2.0), end_time_s: Some(0.05), ..FeOptions::default() };
    let result = run(&still, &options, &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
    assert!((result.summary.mass_kg / 91_900.0 - 1.0).abs() < 0.01, "{}", result.summary.mass_kg);
    let moved =
        result.tracked.iter().flat_map(|t| &t.displacement_m).flatten().fold(0.0_f64, |a, u| a.max(u.abs()));
    assert!(!result.tracked.is_empty() && moved < 1e-6, "{moved:e}");
}

/// A charge on a stretch so short that no element has its centre on it would do nothing.
#[test]
fn a_charge_that_reaches_no_element_is_refused() {
    let mut building = building("");
    building.events[0].stretch_m = Some([1.6, 1.7]);
    let options =
        |size: f64| FeOptions { mesh_size_m: Some(size), end_time_s: Some(0.01), ..FeOptions::default() };
    let error = run(&building, &options(1.0), &mut |_| ()).unwrap_err();
    let words = error.to_string();
    assert!(matches!(error, FeError::NoElements { .. }) && error.is_input(), "{words}");
    for word in ["front-left", "C1-A1", "1.6", "1.7", "mesh size"] {
        assert!(words.contains(word), "{word}: {words}");
    }
    run(&building, &options(0.25), &mut |_| ()).unwrap_or_else(|e| panic!("{e}"));
}
