//! Strips of floors against beam theory and plastic theory.

use super::reference;
use fallwerk::fe::mesh::Mesh;
use fallwerk::rc::{EndModel, StripPlace, derive_strip};

/// A beam of 0.3 x 0.5 m with 0.818 m of the slab of 0.25 m that it carries, from the face of the column on.
#[test]
fn a_strip_of_a_floor_bends_as_a_t_beam() {
    let building = reference();
    let (mesh, _) = Mesh::of(&building, 0.4);
    let floor: Vec<usize> = (0..building.members.len())
        .filter(|m| ["B1-A1-B1", "B1-A1-A2", "S1"].contains(&building.members[*m].id.as_str()))
        .collect();
    let place =
        StripPlace { axis: 0, at_m: 0.2, outward: 1.0, near_m: 0.4, far_m: 2.4, across_m: [-0.2, 0.7] };
    let model = EndModel::strip(&mesh, &floor, &place).expect("a floor on both sides");
    let curves = derive_strip(&model, &|_, _| {}).expect("the pushes work");
    let (width, held, l) = (model.section_m[0], 0.4, model.length_m);
    // rectangles: width, depth, distance of the middle from the top
    let parts = [[width, 0.25, 0.125], [0.3, 0.25, 0.375]];
    let area: f64 = parts.iter().map(|p| p[0] * p[1]).sum();
    // the mesh spreads the volume of the beam over elements of the column's width, evenly along it
    assert!((model.area_m2 / area - 1.0).abs() < 0.02, "{} {area}", model.area_m2);
    let middle = parts.iter().map(|p| p[0] * p[1] * p[2]).sum::<f64>() / area;
    let second = |p: &[f64; 3]| p[0] * p[1].powi(3) / 12.0 + p[0] * p[1] * (p[2] - middle).powi(2);
    let inertia: f64 = parts.iter().map(second).sum();
    let axial = 16.5e9 * area / (l + held);
    assert!((curves.axial_stiffness_n_m / axial - 1.0).abs() < 0.03, "{:.4e}", curves.axial_stiffness_n_m);
    // a cantilever of length l + held: the far side moves by F (l + held)³ / (3 E I), the moment at the line is F l
    let stiffness = 3.0 * 16.5e9 * inertia * l * l / (l + held).powi(3);
    let about_hinge = stiffness * (1.0 - curves.hinge_offset_m / l).powi(2);
    let early = curves.pushes[1].points.iter().find(|p| p[0] > 1e-3).unwrap();
    assert!(
        (early[1] / early[0] / about_hinge - 1.0).abs() < 0.06,
        "{:.4e} {about_hinge:.4e}",
        early[1] / early[0]
    );
    // plastic moment between that of the first yield stress and that of the last one times what a mesh one element deep bears beyond theory (5 / 3)
    let neutral = 0.5 * area / width;
    let lever = |p: &[f64; 3]| {
        let (top, bottom) = (p[2] - 0.5 * p[1], p[2] + 0.5 * p[1]);
        let side = |from: f64, to: f64| p[0] * (to - from).max(0.0) * (0.5 * (from + to) - neutral).abs();
        side(top, neutral.clamp(top, bottom)) + side(neutral.clamp(top, bottom), bottom)
    };
    let plastic: f64 = parts.iter().map(lever).sum();
    let peak =
        curves.pushes[1].points.iter().map(|p| p[1]).fold(0.0, f64::max) / (1.0 - curves.hinge_offset_m / l);
    assert!(peak > 10.5e6 * plastic && peak < 12.25e6 * plastic * 5.0 / 3.0, "{peak} {plastic}");
}
