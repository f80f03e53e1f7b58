//! The submodel of a member end against beam theory and plastic theory, and that in concrete and steel with its section files.

mod anchorage;
mod around;
mod bearing;
mod crushing;
mod cyclic;
mod layers;
mod section;
mod series;
mod springs;
mod strip;

use fallwerk::building::ends::End;
use fallwerk::building::{Building, EXAMPLE};
use fallwerk::fe::mesh::Mesh;
use fallwerk::rc::pushover::torsion_constant;
use fallwerk::rc::{EndCurves, EndModel, derive};

fn reference() -> Building {
    fallwerk::building::parse(EXAMPLE, fallwerk::base::tree::Format::Toml, "reference")
        .expect("the reference is sound")
}

fn foot(mesh_size_m: f64) -> (EndModel, EndCurves) {
    let building = reference();
    let (mesh, _) = Mesh::of(&building, mesh_size_m);
    let model = EndModel::cut(&building, &mesh, "C1-A2", End::Lower).expect("the column has a volume");
    let curves = derive(&model, &|_, _| {}).expect("the push works");
    (model, curves)
}

/// Envelope about the end section from the one about the hinge: the inverse of the shift by `c`.
fn face_moment(model: &EndModel, curves: &EndCurves, level: usize, rotation: f64) -> f64 {
    let points = &curves.axes[0][level].points;
    let at = points.partition_point(|p| p[0] < rotation).min(points.len() - 1);
    points[at][1] / (1.0 - curves.hinge_offset_m / model.length_m)
}

#[test]
fn elastic_stiffness_of_a_clamped_foot_is_that_of_a_cantilever() {
    // M = 3 E I / l² δ with the chord rotation θ = δ / l (Euler-Bernoulli) less shear deformation 1 / (1 + 3 E I / (G A_s l²)).
    let (model, curves) = foot(0.4);
    let (e, nu, b): (f64, f64, f64) = (16.5e9, 0.2, 0.4);
    let (i, l) = (b.powi(4) / 12.0, model.length_m);
    let bending = 3.0 * e * i / l;
    let shear = 1.0 + 3.0 * e * i / (e / (2.0 * (1.0 + nu)) * 5.0 / 6.0 * b * b * l * l);
    let expected = bending / shear * (1.0 - curves.hinge_offset_m / l).powi(2);
    let early: Vec<[f64; 2]> =
        curves.axes[0][1].points.iter().copied().filter(|p| p[0] > 5e-4 && p[0] < 3e-3).collect();
    let (first, last) = (early[0], early[early.len() - 1]);
    let found = (last[1] - first[1]) / (last[0] - first[0]);
    assert!((found / expected - 1.0).abs() < 0.12, "found {found:.4e}, beam theory {expected:.4e}");
}

#[test]
fn axial_stiffness_of_a_clamped_foot_is_ea_over_l() {
    let (model, curves) = foot(0.4);
    let expected = 16.5e9 * 0.16 / model.length_m;
    assert!(
        (curves.axial_stiffness_n_m / expected - 1.0).abs() < 0.03,
        "{:.4e} {expected:.4e}",
        curves.axial_stiffness_n_m
    );
}

#[test]
fn plastic_moment_approaches_plastic_theory_with_the_mesh() {
    // σ_y b h² / 4 with the yield stress at 1 % plastic strain. A clamped one-point mesh two elements across is too strong: the moment
    // falls along the first element, and its clamped face hinders plastic flow sideways.
    let theory = 11.55e6 * 0.4_f64.powi(3) / 4.0;
    let (coarse_model, coarse) = foot(0.4);
    let (fine_model, fine) = foot(0.15);
    let c = face_moment(&coarse_model, &coarse, 1, 0.03) / theory;
    let f = face_moment(&fine_model, &fine, 1, 0.03) / theory;
    assert!(c > f && f > 0.95 && f < 1.30, "coarse {c:.3}, fine {f:.3} of plastic theory");
}

#[test]
fn axial_force_lowers_the_moment_and_every_push_fails() {
    let (model, curves) = foot(0.4);
    for axis in &curves.axes {
        assert!(axis.iter().all(|p| p.failed), "every push ends in failure");
        let strong = axis[1].points.iter().map(|p| p[1]).fold(0.0, f64::max);
        let weak = axis[4].points.iter().map(|p| p[1]).fold(0.0, f64::max);
        assert!(weak < strong, "{weak} {strong}");
    }
    assert!(curves.hinge_offset_m > 0.0 && curves.hinge_offset_m < 0.5 * model.length_m);
    // a square section, a symmetric support: both axes and both senses alike
    assert!(curves.asymmetry < 0.01, "{}", curves.asymmetry);
    for (p, q) in curves.axes[0].iter().zip(&curves.axes[1]) {
        let peak = |p: &fallwerk::rc::pushover::Push| p.points.iter().map(|p| p[1]).fold(0.0, f64::max);
        assert!((peak(p) / peak(q) - 1.0).abs() < 0.03);
    }
}

#[test]
fn mirror_images_have_one_description() {
    let building = reference();
    let (mesh, _) = Mesh::of(&building, 0.4);
    let shape =
        |member: &str, end| EndModel::cut(&building, &mesh, member, end).unwrap().canonical_geometry();
    for other in ["C2-A2", "C2-B1", "C2-B2"] {
        assert_eq!(shape("C2-A1", End::Upper), shape(other, End::Upper), "{other}");
    }
    assert_ne!(shape("C2-A1", End::Upper), shape("C2-A1", End::Lower));
}

#[test]
fn torsion_constant_of_a_square() {
    // 0.1406 a⁴ (Timoshenko and Goodier, Theory of Elasticity, art. 109); the formula is good to 0.3 %
    assert!((torsion_constant([0.4, 0.4]) / 0.4_f64.powi(4) - 0.1406).abs() < 0.003 * 0.1406);
}
