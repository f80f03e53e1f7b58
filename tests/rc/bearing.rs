//! Up to which rotation a column end bears an axial force: pushes against the strain of the layer that breaks first.

use fallwerk::base::piecewise::interpolate;
use fallwerk::building::ends::End;
use fallwerk::curve::{CapacityLevel, ResistanceCurve};
use fallwerk::fe::mesh::Mesh;
use fallwerk::rc::{EndModel, push};

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
    let pushed = |share: f64| push(&model, 0, share * capacity_n, 1.0).unwrap().0;
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
