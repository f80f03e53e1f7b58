//! Elastic springs of generated models against closed forms.

use super::knowledge;
use fallwerk::base::geom::Aabb;
use fallwerk::base::tree::Format;
use fallwerk::building::{Building, parse};
use fallwerk::generate::{Derive, Generated, generate};
use fallwerk::mbs::model::Bushing;

/// Two storeys, two by two bays, beams around floors that have none within.
fn scene() -> (Building, Generated) {
    let scene = fallwerk::study::plan::Scene::of(1, 193);
    let building = parse(&scene.toml(), Format::Toml, "scene").expect("a sound building");
    let (rules, mut store, _cache) = knowledge();
    let generated = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    (building, generated)
}

fn solid(building: &Building, id: &str) -> Aabb {
    building.members.iter().find(|m| m.id == id).expect(id).solid
}

fn spring<'a>(generated: &'a Generated, id: &str) -> &'a Bushing {
    generated.model.bushings.iter().find(|b| b.id == id).expect(id)
}

#[test]
fn the_force_of_a_column_goes_on_through_half_of_its_joints() {
    let (building, generated) = scene();
    let flexible = |id: &str| 1.0 / spring(&generated, id).axial_stiffness_n_m;
    let beam_m = solid(&building, "B1-A1-B1").size()[2];
    let slab_m = solid(&building, "S1").size()[2];
    // beams on two sides of a corner, on three of an edge, and the slab on four
    for (column, share, joint_m) in [("A1", 0.78, beam_m), ("A2", 0.65, beam_m), ("B2", 0.49, slab_m)] {
        let [low, high] = [1, 2].map(|storey| format!("C{storey}-{column}"));
        let size = solid(&building, &low).size();
        let column_n =
            building.law_of(building.members.iter().find(|m| m.id == low).unwrap()).youngs_modulus_pa
                * size[0]
                * size[1];
        // the foot stands on the ground, whose half of the column is all that shortens
        let more_m = column_n * (flexible(&format!("{low}.top")) - flexible(&format!("{low}.bottom")));
        assert!((more_m / (0.5 * share * joint_m) - 1.0).abs() < 1e-9, "{column}: {more_m}");
        let [bottom, top] = ["bottom", "top"].map(|end| flexible(&format!("{high}.{end}")));
        assert!((top / bottom - 1.0).abs() < 1e-9, "{column}: {top} {bottom}");
    }
}

#[test]
fn slabs_bend_between_the_beams_that_run_across() {
    let (building, generated) = scene();
    let [across, slab] = ["B1-A1-A2", "S1"].map(|id| solid(&building, id));
    let [first, second] = ["C1-A1", "C1-B1"].map(|id| solid(&building, id).center());
    let [_, next] = ["C1-A1", "C1-A2"].map(|id| solid(&building, id).center());
    let half_bay_m = 0.5 * (second[0] - first[0]);
    let width_m = 0.5 * (next[1] - first[1]);
    // from the beam at the edge to the middle of the bay, and from there to the axis of columns without a beam
    for (id, length_m) in
        [("S1/1-2|S1/2-2", first[0] + half_bay_m - across.max[0]), ("S1/2-2|S1/3-2", half_bay_m)]
    {
        let spring = spring(&generated, id);
        let span = spring.beam.as_ref().and_then(|b| b.span).expect("its slab yields");
        assert!((span.length_m / length_m - 1.0).abs() < 1e-9, "{id}: {}", span.length_m);
        // the plate across takes no part in displacements across
        let bending = 16.5e9 * width_m * slab.size()[2].powi(3) / 12.0;
        let shear = 5.0 / 6.0 * 16.5e9 / 2.4 * width_m * slab.size()[2];
        let across = 1.0 / (length_m.powi(3) / (12.0 * bending) + length_m / shear);
        let stiffness = spring.shear_stiffness_n_m[1];
        assert!((stiffness / across - 1.0).abs() < 1e-6, "{id}: {stiffness} {across}");
    }
}
