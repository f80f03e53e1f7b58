//! Up to which rotation a column end bears an axial force: pushes against the strain of the layer that breaks first.

use fallwerk::base::piecewise::interpolate;
use fallwerk::building::Building;
use fallwerk::building::ends::{End, member_ends};
use fallwerk::building::partition::Partition;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::fe::mesh::Mesh;
use fallwerk::rc::{EndModel, PushoverError, push};

/// Forces that entries have no pushes for, over that at which the section flows as a whole, hardened.
const SHARES: [f64; 3] = [0.51, 0.64, 0.77];

#[test]
fn large_forces_are_borne_until_the_first_layer_breaks() {
    let building = super::reference();
    let (mesh, _) = Mesh::of(&building, 0.4);
    let model = EndModel::cut(&building, &mesh, "C1-A2", End::Lower).unwrap();
    let law = &mesh.laws[mesh.elements[model.section_elements[0]].law];
    // the law breaks at the last stress of its table
    let capacity_n = model.area_m2 * law.hardening.last().unwrap().stress_pa;
    let pushed = |share: f64| push(&model, 0, share * capacity_n, 1.0, false).unwrap().0;
    let small = pushed(0.34);
    let level = CapacityLevel {
        axial_force_n: small.axial_force_n,
        fracture_rotation_rad: small.points.last().unwrap()[0],
        capacity: small.points.clone(),
    };
    let curve = ResistanceCurve { stiffness_nm_rad: 1e8, levels: vec![level], cyclic: None };
    let left = curve.left_under_compression(capacity_n);
    println!("0.34: {:?} to {:.3}, {left:.3?}", small.sinks_rad, small.points.last().unwrap()[0]);
    let turned: Vec<[f64; 2]> = left.iter().rev().map(|[rotation, share]| [*share, *rotation]).collect();
    for share in SHARES {
        let wanted = interpolate(&turned, share);
        let found = pushed(share).sinks_rad.expect("it sinks");
        println!("{share}: sinks from {found:.3} rad on, first layer broken at {wanted:.3}");
        // not before a layer has broken, and soon after
        assert!(found > wanted - 0.01 && found < wanted + 0.1, "{share}: {found} {wanted}");
    }
    // half of the section bears a third of what all of it would bear, but not to the end of the push
    let sinks = small.sinks_rad.unwrap();
    assert!(sinks > left[left.len() - 2][0] + 0.1 && sinks < left[left.len() - 1][0], "{sinks}");
}

/// Columns of 300 x 700 mm, slabs of 200 mm, beams of 500 mm.
fn strong_columns_on_thin_floors() -> Building {
    let text = include_str!("../../buildings/varied/var-01.toml");
    fallwerk::building::parse(text, fallwerk::base::tree::Format::Toml, "var-01").expect("it is sound")
}

/// A strong column on a thin floor: its axial force has no equilibrium with the floor alone, and passes into the column below it.
#[test]
fn a_large_force_passes_through_the_floor_into_the_next_column() {
    let building = strong_columns_on_thin_floors();
    let (mesh, _) = Mesh::of(&building, 0.4);
    let model = EndModel::cut(&building, &mesh, "C2-A2", End::Lower).unwrap();
    let law = &mesh.laws[mesh.elements[model.section_elements[0]].law];
    let squash_n = model.area_m2 * law.hardening[0].stress_pa;
    assert!(matches!(
        push(&model, 0, 0.4 * squash_n, 1.0, false),
        Err(PushoverError::Preload { axial_force_n, .. }) if axial_force_n == 0.4 * squash_n
    ));
    let total: f64 = model.opposite_nodes.iter().map(|(_, share)| share).sum();
    assert!((total - 1.0).abs() < 1e-12, "{total}");
    let (borne, _) = push(&model, 0, 0.4 * squash_n, 1.0, true).unwrap();
    let peak = borne.points.iter().map(|p| p[1]).fold(0.0, f64::max);
    // the plastic moment of the section under this force, 1 - n² of that of a rectangle, hardened and in a coarse mesh
    let wanted = 0.25 * squash_n * model.section_m[1] * (1.0 - 0.16);
    println!("{:.0} kN m, {:.0}", peak / 1e3, wanted / 1e3);
    assert!(peak > 0.9 * wanted && peak < 1.9 * wanted, "{peak} {wanted}");
}

#[test]
fn columns_go_on_beyond_floors() {
    let building = strong_columns_on_thin_floors();
    let partition = Partition::of(&building);
    let ends = member_ends(&building, &partition);
    let goes_on = |id: &str| ends.iter().find(|e| e.id == id).unwrap().goes_on(&building, &partition);
    for (id, wanted) in
        [("C1-A2.bottom", false), ("C1-A2.top", true), ("C2-A2.bottom", true), ("C4-A2.top", false)]
    {
        assert_eq!(goes_on(id), wanted, "{id}");
    }
}
