//! Grids without some of their bays.

use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{Building, EXAMPLE, MemberKind, parse};
use fallwerk::fe::mesh::Mesh;
use fallwerk::graph::Structure;

/// The example with two bays each way, and an L or all of them.
fn example(without: &str) -> Building {
    let text =
        EXAMPLE.replacen("x = [0, 6] ", "x = [0, 6, 12] ", 1).replacen("y = [0, 5] ", "y = [0, 5, 10] ", 1);
    let text = text.replacen("[grid]\n", &format!("[grid]\n{without}\n"), 1);
    parse(&text, Format::Toml, "angle").unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn an_angle_is_a_frame_whose_slabs_meet() {
    let angle = example("without_bays = [{ from = [6, 5], to = [12, 10] }]");
    let count = |kind| angle.members.iter().filter(|m| m.kind == kind).count();
    assert_eq!([MemberKind::Column, MemberKind::Beam, MemberKind::Slab].map(count), [3 * 8, 3 * 8, 3 * 2]);
    // slabs reach 0.2 m beyond free edges, also at the inner corner
    let partition = Partition::of(&angle);
    let volumes = partition.volumes(angle.members.len());
    let slabs: f64 =
        angle.members.iter().zip(&volumes).filter(|(m, _)| m.kind == MemberKind::Slab).map(|(_, v)| v).sum();
    assert!((slabs - 3.0 * 0.25 * (12.4 * 10.4 - 30.0)).abs() < 1e-9, "{slabs}");
    let floor = Structure::of(&angle).storey_bodies();
    assert_eq!(floor.iter().filter(|f| f.len() > 1).map(Vec::len).collect::<Vec<_>>(), [10, 10, 10]);
    let (mesh, _) = Mesh::of(&angle, 0.4);
    assert!(mesh.unmeshed(&angle).is_empty());
    let none = mesh.elements.iter().enumerate().all(|(e, _)| {
        let [x, y, _] = mesh.center(e);
        x < 6.2 + 1e-9 || y < 5.2 + 1e-9
    });
    assert!(none, "something stands where nothing is built");
}

/// Slabs reach over each other at inner corners: what they share is counted once, and is no overlap.
#[test]
fn steps_and_corners_that_touch_are_buildings() {
    let slabs = |without: &str| -> f64 {
        let building = example(&format!("without_bays = [{without}]"));
        let volumes = Partition::of(&building).volumes(building.members.len());
        let of_slabs = building.members.iter().zip(&volumes).filter(|(m, _)| m.kind == MemberKind::Slab);
        of_slabs.map(|(_, v)| v).sum::<f64>() / (3.0 * 0.25)
    };
    // two bays across a corner, which share the square over its column
    let two = slabs("{ from = [6, 0], to = [12, 5] }, { from = [0, 5], to = [6, 10] }");
    assert!((two - (2.0 * 6.4 * 5.4 - 0.16)).abs() < 1e-9, "{two}");
    let text = EXAMPLE.replacen("x = [0, 6] ", "x = [0, 6, 12, 18] ", 1).replacen(
        "y = [0, 5] ",
        "y = [0, 5, 10] ",
        1,
    );
    let steps =
        "[grid]\nwithout_bays = [{ from = [12, 0], to = [18, 5] }, { from = [0, 5], to = [6, 10] }]\n";
    let building = parse(&text.replacen("[grid]\n", steps, 1), Format::Toml, "steps").unwrap();
    let volumes = Partition::of(&building).volumes(building.members.len());
    let all =
        building.members.iter().zip(&volumes).filter(|(m, _)| m.kind == MemberKind::Slab).map(|(_, v)| v);
    // both rows are 12.4 m by 5.4 m and share a strip of 6.4 m by 0.4 m
    let area = all.sum::<f64>() / (3.0 * 0.25);
    assert!((area - (2.0 * 12.4 * 5.4 - 6.4 * 0.4)).abs() < 1e-9, "{area}");
}

#[test]
fn what_lies_between_all_axes_is_the_whole_grid() {
    // the frame of the key, not of its absence: the last bay of a longer grid is left out
    let longer = EXAMPLE.replacen("x = [0, 6] ", "x = [0, 6, 12] ", 1);
    let out = longer.replacen("[grid]\n", "[grid]\nwithout_bays = [{ from = [12, 5], to = [6, 0] }]\n", 1);
    let [shorter, whole] = [out.as_str(), EXAMPLE].map(|t| parse(t, Format::Toml, "frame").unwrap());
    let parts = |b: &Building| b.members.iter().map(|m| (m.id.clone(), m.solid)).collect::<Vec<_>>();
    assert_eq!(parts(&shorter), parts(&whole));
}
