//! The reference building reads into what the drawing says.

use fallwerk::base::hash::ContentHash;
use fallwerk::base::tree::Format;
use fallwerk::building::partition::Partition;
use fallwerk::building::{
    Building, CowperSymonds, EXAMPLE, MemberKind, Preparation, SectionShape, inspect, parse, read,
};
use fallwerk::fe::mesh::Mesh;
use std::path::Path;

pub fn example_as_json() -> String {
    let value: serde_json::Value = toml::from_str(EXAMPLE).unwrap();
    serde_json::to_string_pretty(&value).unwrap()
}

fn reference() -> Building {
    parse(EXAMPLE, Format::Toml, "three-storey-frame.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn file(name: &str) -> Building {
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap_or_else(|e| panic!("{e}"))
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-9 * b.abs().max(1.0), "{a} is not {b}");
}

#[test]
fn members_of_the_reference() {
    let building = reference();
    let of = |kind| building.members.iter().filter(move |m| m.kind == kind);
    let counts = [MemberKind::Column, MemberKind::Beam, MemberKind::Slab].map(|kind| of(kind).count());
    assert_eq!(counts, [12, 12, 3]);
    let first: Vec<&str> = building.members.iter().take(9).map(|m| m.id.as_str()).collect();
    assert_eq!(
        first,
        ["C1-A1", "C1-A2", "C1-B1", "C1-B2", "B1-A1-B1", "B1-A2-B2", "B1-A1-A2", "B1-B1-B2", "S1"]
    );
    let column = building.member("C2-B2").unwrap();
    assert_eq!((column.solid.min, column.solid.max), ([5.8, 4.8, 3.5], [6.2, 5.2, 7.0]));
    assert_eq!((column.axis, column.storey), (2, Some(2)));
    let along_x = building.member("B3-A1-B1").unwrap();
    assert_eq!((along_x.solid.min, along_x.solid.max), ([-0.2, -0.15, 10.0], [6.2, 0.15, 10.5]));
    let along_y = building.member("B1-B1-B2").unwrap();
    assert_eq!((along_y.solid.min, along_y.solid.max), ([5.85, 0.2, 3.0], [6.15, 4.8, 3.5]));
    let slab = building.member("S1").unwrap();
    assert_eq!((slab.solid.min, slab.solid.max), ([-0.2, -0.2, 3.25], [6.2, 5.2, 3.5]));
    assert_eq!(building.supports.len(), 4);
    assert_eq!(building.settings, fallwerk::building::Settings::default());
    let events: Vec<&str> = building.events.iter().map(|e| e.member.as_str()).collect();
    assert_eq!(events, ["C1-A1", "C1-B1"]);
}

#[test]
fn bars_of_the_reference() {
    let building = reference();
    let SectionShape::Rectangle { bars, ties, .. } = &building.sections["column"].shape else { panic!() };
    assert_eq!((bars.len(), ties.unwrap().diameter_m), (8, 0.008));
    assert!(bars.iter().all(|b| (b.x_m.abs().max(b.y_m.abs()) - 0.15).abs() < 1e-12 && b.diameter_m == 0.02));
    let SectionShape::Rectangle { bars, .. } = &building.sections["beam"].shape else { panic!() };
    let (bottom, top): (Vec<&fallwerk::building::Bar>, Vec<_>) = bars.iter().partition(|b| b.y_m < 0.0);
    assert_eq!((bottom.len(), top.len()), (3, 3));
    close(bottom[0].y_m, -0.2);
    close(bottom[0].x_m, -0.1);
}

/// By hand, for each storey: slab 6.4 x 5.4 x 0.25; columns 4 x 0.4 x 0.4 x 3.0 up to the beams' soffit;
/// below the slab two beams 6.4 x 0.3 x 0.25, the rest of four joints 0.4 x 0.1 x 0.25, and two beams
/// 4.6 x 0.3 x 0.25 between the columns' faces.
#[test]
fn volume_by_hand() {
    let building = reference();
    let volumes = Partition::of(&building).volumes(building.members.len());
    let of = |kind| -> f64 {
        building.members.iter().zip(&volumes).filter(|(m, _)| m.kind == kind).map(|(_, v)| v).sum()
    };
    close(of(MemberKind::Slab), 3.0 * 8.64);
    close(of(MemberKind::Column), 3.0 * 4.0 * 0.16 * 3.0);
    close(of(MemberKind::Beam), 3.0 * (2.0 * 6.4 * 0.075 + 4.0 * 0.4 * 0.1 * 0.25 + 2.0 * 4.6 * 0.075));
    close(volumes.iter().sum(), 36.75);
}

/// The block above a column belongs to one beam, over the column's whole section.
#[test]
fn joint_blocks_belong_to_the_beam_over_the_column() {
    let building = reference();
    let partition = Partition::of(&building);
    let beam = building.members.iter().position(|m| m.id == "B1-A1-B1").unwrap();
    let mut found = 0.0;
    for (cell, owner) in partition.cells() {
        let solid = partition.cell_box(cell);
        let center = solid.center();
        if center[0].abs() < 0.2 && center[1].abs() < 0.2 && center[2] > 3.0 && center[2] < 3.25 {
            assert_eq!(building.members[owner].id, building.members[beam].id);
            found += solid.volume();
        }
    }
    close(found, 0.4 * 0.4 * 0.25);
}

#[test]
fn toml_and_json_give_the_same_building() {
    let json = example_as_json();
    assert_eq!(parse(&json, Format::Json, "a.json").unwrap_or_else(|e| panic!("{e}")), reference());
}

#[test]
fn the_wall_variant_differs_by_its_wall() {
    let mut wall = file("buildings/three-storey-frame-wall.toml");
    let plain = file("buildings/three-storey-frame.toml");
    let obstacle = wall.obstacles.pop().unwrap();
    assert_eq!((obstacle.solid.min, obstacle.solid.max), ([-0.2, -2.6, 0.0], [6.2, -2.2, 2.5]));
    wall.name.clone_from(&plain.name);
    wall.description.clone_from(&plain.description);
    assert_eq!(wall, plain);
}

#[test]
fn examples_have_no_warnings() {
    let inspection = inspect(EXAMPLE, Format::Toml, "a.toml");
    assert!(inspection.diagnostics.items().is_empty(), "{}", inspection.diagnostics);
}

#[test]
fn every_key_has_its_effect() {
    let building = file("tests/building/good/everything.toml");
    use MemberKind::{Beam, Brace, Column, Footing, Slab, Wall};
    let counts = [Column, Beam, Slab, Wall, Footing, Brace]
        .map(|kind| building.members.iter().filter(|m| m.kind == kind).count());
    assert_eq!(counts, [13, 15, 3, 1, 1, 1]);
    let brace = building.member("X1").and_then(|m| m.inclined).unwrap();
    assert_eq!((brace.from_m, brace.to_m, brace.roll_deg), ([6.0, 0.0, 0.6], [12.0, 0.0, 2.5], 10.0));
    assert_eq!((brace.width_m, brace.depth_m), (0.3, 0.5));
    let law = building.law_of(&building.members[0]);
    assert_eq!(law.critical_principal_strain, Some(0.12));
    assert_eq!(law.rate_factor, Some(CowperSymonds { c_1_s: 40.0, p: 5.0 }));
    let solid = |id: &str| building.member(id).map(|m| (m.solid.min, m.solid.max, m.axis)).unwrap();
    assert_eq!(solid("F1"), ([-0.6, -0.6, -0.5], [0.6, 0.6, 0.0], 2));
    assert_eq!(solid("W1"), ([0.2, 4.875, 0.0], [5.8, 5.125, 3.0], 1));
    assert_eq!(solid("B9"), ([2.85, 0.15, 3.0], [3.15, 4.85, 3.5], 1));
    assert_eq!(solid("S9"), ([12.2, -0.2, 3.25], [14.0, 5.2, 3.5], 2));
    assert_eq!(solid("C9"), ([13.3, 2.3, 0.0], [13.7, 2.7, 3.5], 2));
    let times: Vec<(f64, &str)> = building.events.iter().map(|e| (e.time_s, e.id.as_str())).collect();
    assert_eq!(times, [(0.0, "first"), (0.12, "second")]);
    assert_eq!(building.events[1].stretch_m, Some([0.5, 1.5]));
    assert_eq!(building.supports.len(), 8);
    assert_eq!(building.preparation.len(), 8);
    assert!(matches!(&building.preparation[7], Preparation::Cut { member } if member == "B9"));
    assert_eq!(building.obstacles[0].solid.max, [7.0, -2.6, 2.5]);
    assert_eq!((building.settings.mesh_size_m, building.settings.gravity_m_s2), (0.25, 9.80665));
    let SectionShape::Rectangle { bars, .. } = &building.sections["column"].shape else { panic!() };
    assert_eq!(bars.len(), 6);
    let SectionShape::Rectangle { bars, .. } = &building.sections["beam"].shape else { panic!() };
    close(bars[0].x_m, -0.09);
}

/// What the file says of rate and tension reaches the solver; a file without these keys makes the law that it made before, with the same hash.
#[test]
fn optional_keys_of_the_law() {
    let plain = reference();
    let law = plain.law_of(&plain.members[0]);
    let text = serde_json::to_string(law).unwrap();
    let keys =
        ["density_kg_m3", "youngs_modulus_pa", "poisson_ratio", "hardening", "critical_plastic_strain"];
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value.as_object().unwrap().len(), keys.len(), "{text}");
    assert!(keys.iter().all(|k| value.get(*k).is_some()), "{text}");
    assert_eq!(&serde_json::from_str::<fallwerk::building::Homogenised>(&text).unwrap(), law);
    let mesh = Mesh::of(&plain, 0.4).0;
    assert!(mesh.laws.iter().all(|l| l.rate.is_none() && l.erosion.principal_strain == f64::INFINITY));
    let changed = EXAMPLE.replacen(
        "critical_plastic_strain = 0.10",
        "critical_principal_strain = 0.08\nrate_factor = { c = \"40 1/s\", p = 5 }\ncritical_plastic_strain = 0.10",
        1,
    );
    let changed = parse(&changed, Format::Toml, "a.toml").unwrap_or_else(|e| panic!("{e}"));
    let hash = |l: &fallwerk::building::Homogenised| ContentHash::of_value(l).unwrap().to_string();
    assert_ne!(hash(changed.law_of(&changed.members[0])), hash(law));
    for law in &Mesh::of(&changed, 0.4).0.laws {
        assert_eq!(law.rate, Some(CowperSymonds { c_1_s: 40.0, p: 5.0 }));
        assert_eq!((law.erosion.plastic_strain, law.erosion.principal_strain), (0.1, 0.08));
        assert!(law.table().has_rate());
    }
}
