//! The three-storey reference frame.

use super::buildings::{charge, reference};
use fallwerk::building::{Building, MemberKind};
use fallwerk::cli::graph::{Arguments, run};
use fallwerk::graph::demand::StateSummary;
use fallwerk::graph::paths::charged_members;
use fallwerk::graph::*;
use std::collections::BTreeSet;

/// Own weight by hand \[m³\]: 12 columns of 3.0 m, 3 slabs, 6 + 6 beams under the slab, 12 joint blocks.
const VOLUME_M3: f64 =
    12.0 * 0.16 * 3.0 + 3.0 * 6.4 * 5.4 * 0.25 + 6.0 * 5.6 * 0.075 + 6.0 * 4.6 * 0.075 + 12.0 * 0.16 * 0.25;
const WEIGHT_N: f64 = VOLUME_M3 * 2500.0 * 9.81;

/// Weight \[N\], sum of the support forces \[N\] and number of supports of a solved state.
fn equilibrium(summary: &StateSummary) -> (f64, [f64; 3], usize) {
    match summary {
        StateSummary::Equilibrium { weight_n, reaction_sum_n, reactions, unplaced, .. } => {
            assert!(unplaced.is_empty(), "{unplaced:?}");
            (*weight_n, *reaction_sum_n, reactions.len())
        }
        other => panic!("{other:?}"),
    }
}

fn before<'a>(demands: &'a Demands, id: &str) -> &'a EndState {
    demands.ends.iter().find(|e| e.id == id).unwrap_or_else(|| panic!("{id}")).before.as_ref().unwrap()
}

fn after<'a>(demands: &'a Demands, id: &str) -> &'a EndState {
    demands.ends.iter().find(|e| e.id == id).unwrap_or_else(|| panic!("{id}")).after.as_ref().unwrap()
}

#[test]
fn connections_of_the_first_storey() {
    let structure = Structure::of(&reference());
    let ids: BTreeSet<&str> = structure.connections().map(|c| c.id.as_str()).collect();
    let first: Vec<&str> = ids.iter().copied().filter(|id| !id.contains('3') && id.contains("1-")).collect();
    let expected = [
        "B1-A1-A2.end/B1-A2-B2",
        "B1-A1-A2.start/B1-A1-B1",
        "B1-A1-A2.top/S1",
        "B1-A1-B1.top/S1",
        "B1-A2-B2.top/S1",
        "B1-B1-B2.end/B1-A2-B2",
        "B1-B1-B2.start/B1-A1-B1",
        "B1-B1-B2.top/S1",
        "C1-A1.top/B1-A1-B1",
        "C1-A2.top/B1-A2-B2",
        "C1-B1.top/B1-A1-B1",
        "C1-B2.top/B1-A2-B2",
    ];
    let only_first: Vec<&str> =
        first.into_iter().filter(|id| id.starts_with("B1") || id.starts_with("C1")).collect();
    assert_eq!(only_first, expected);
    // 12 a storey, and the feet of the 8 upper columns.
    assert_eq!(structure.connections().count(), 3 * 12 + 8);
    assert_eq!(ids.len(), 44, "ids are unique");
    assert_eq!(structure.supports().count(), 4);
    assert!(structure.near_misses.is_empty() && structure.notes.is_empty());
}

#[test]
fn contact_face_of_a_column_top() {
    let structure = Structure::of(&reference());
    let c = structure.connection("C1-B1.top/B1-A1-B1").unwrap();
    assert_eq!((c.end, c.faces.len(), c.faces[0].axis, c.faces[0].outward), (Some(End::High), 1, 2, 1.0));
    assert!((c.area_m2 - 0.16).abs() < 1e-12);
    assert!((c.centroid_m[0] - 6.0).abs() < 1e-12 && (c.centroid_m[2] - 3.0).abs() < 1e-12);
    for moment in &c.faces[0].second_moments_m4[..2] {
        assert!((moment - 0.4f64.powi(4) / 12.0).abs() < 1e-12);
    }
    assert!(c.eccentricity_m[0].iter().all(|e| e.abs() < 1e-12));
    // The beam's axis is at 3.25 m, its contact with the column's top at 3.0 m.
    assert!((c.eccentricity_m[1][2] + 0.25).abs() < 1e-12);
    let foot = structure.connection("C2-B1.bottom/S1").unwrap();
    assert_eq!((foot.end, foot.faces[0].outward), (Some(End::Low), -1.0));
    let of_top = |c: &&Connection| c.members[0] == foot.members[0] && c.end == Some(End::High);
    assert_eq!(structure.connections().filter(of_top).count(), 1);
}

#[test]
fn member_ends() {
    let structure = Structure::of(&reference());
    assert_eq!(structure.ends.len(), 2 * (12 + 12));
    let top = structure.end("C2-A1.top").unwrap();
    assert!((top.point_m[2] - 6.5).abs() < 1e-12 && (top.clear_length_m - 3.0).abs() < 1e-12);
    assert_eq!(top.connected, ["B2-A1-B1"]);
    let start = structure.end("B1-A1-B1.start").unwrap();
    assert!((start.point_m[0] - 0.2).abs() < 1e-12 && (start.clear_length_m - 5.6).abs() < 1e-12);
    assert!((start.point_m[2] - 3.25).abs() < 1e-12);
    assert!(start.connected.contains(&"C1-A1".to_string()), "{:?}", start.connected);
    let end = structure.end("B1-A1-A2.end").unwrap();
    assert!((end.point_m[1] - 4.8).abs() < 1e-12 && end.axes[1][0] == -1.0);
    let foot = structure.end("C1-A1.bottom").unwrap();
    assert!(foot.supported && foot.connected.is_empty());
}

#[test]
fn storey_bodies_have_the_mass_of_the_building() {
    let building = reference();
    let structure = Structure::of(&building);
    let bodies = structure.storey_bodies();
    assert_eq!(bodies.len(), 3 + 12);
    let slabs: Vec<_> = bodies.iter().filter(|b| b.len() == 5).collect();
    assert_eq!(slabs.len(), 3);
    let mass = structure.mass_of(slabs[0]);
    assert!((mass.center_m[0] - 3.0).abs() < 1e-12 && (mass.center_m[1] - 2.5).abs() < 1e-12);
    let all: Vec<usize> = (0..building.members.len()).collect();
    let total = structure.mass_of(&all);
    assert!((total.volume_m3 - VOLUME_M3).abs() < 1e-9);
    assert!((total.mass_kg * 9.81 - WEIGHT_N).abs() < 1e-6);
}

#[test]
fn load_paths_without_the_front_columns() {
    let building = reference();
    let structure = Structure::of(&building);
    let paths = structure.load_paths(&building, &charged_members(&building));
    let vertical = |id: &str| &paths.iter().find(|p| p.member_id == id).unwrap().vertical;
    assert!(paths.iter().all(|p| p.member_id != "C1-A1"));
    assert!(paths.iter().all(|p| p.supports == ["C1-A2.bottom/ground", "C1-B2.bottom/ground"]));
    for id in ["C2-A1", "C3-B1", "B1-A1-B1", "B3-A1-B1"] {
        assert_eq!(*vertical(id), VerticalPath::Lost, "{id}");
    }
    for id in ["C1-A2", "C3-B2", "B2-A2-B2"] {
        assert_eq!(*vertical(id), VerticalPath::Kept, "{id}");
    }
    assert_eq!(*vertical("B2-A1-A2"), VerticalPath::Partial { lost: vec!["C2-A1".into()] });
    assert_eq!(*vertical("S1"), VerticalPath::Partial { lost: vec!["C1-A1".into(), "C1-B1".into()] });
    let intact = structure.load_paths(&building, &BTreeSet::new());
    assert!(intact.iter().all(|p| p.vertical == VerticalPath::Kept && p.supports.len() == 4));
}

#[test]
fn before_removal_the_columns_carry_the_weight_symmetrically() {
    let building = reference();
    let demands = demands(&Structure::of(&building), &building);
    let (weight, sum, _) = equilibrium(&demands.before);
    assert!((weight / WEIGHT_N - 1.0).abs() < 1e-12);
    assert!((sum[2] / WEIGHT_N - 1.0).abs() < 1e-9, "{sum:?}");
    assert!(sum[0].abs().max(sum[1].abs()) < 1e-9 * WEIGHT_N, "{sum:?}");
    let corners = ["A1", "A2", "B1", "B2"];
    let axial = corners.map(|c| before(&demands, &format!("C1-{c}.bottom")).forces.axial_n);
    for n in axial {
        assert!((n / (0.25 * WEIGHT_N) - 1.0).abs() < 1e-9, "{axial:?}");
    }
    for storey in 1..=3 {
        let tops = corners.map(|c| before(&demands, &format!("C{storey}-{c}.top")).forces);
        for axis in 0..2 {
            let reference = tops[0].moment_nm[axis].abs();
            assert!(reference > 1.0);
            for top in tops {
                assert!((top.moment_nm[axis].abs() / reference - 1.0).abs() < 1e-9);
            }
        }
    }
    let worst = demands.ends.iter().map(|e| e.before.as_ref().unwrap().section.ratio).fold(0.0, f64::max);
    assert!(worst > 0.05 && worst < 0.6, "dead load alone is far from failure: {worst}");
}

#[test]
fn after_removal_the_rear_columns_take_the_overturning_moment() {
    let building = reference();
    let structure = Structure::of(&building);
    let demands = demands(&structure, &building);
    let (weight, sum, reactions) = equilibrium(demands.after.as_ref().unwrap());
    assert!((sum[2] / weight - 1.0).abs() < 1e-9);
    assert_eq!(reactions, 2);
    let left: Vec<usize> =
        (0..building.members.len()).filter(|m| !charged_members(&building).contains(m)).collect();
    let mass = structure.mass_of(&left);
    assert!((mass.mass_kg * 9.81 / weight - 1.0).abs() < 1e-12);
    let overturning = weight * (5.0 - mass.center_m[1]);
    let feet = ["C1-A2.bottom", "C1-B2.bottom"].map(|id| after(&demands, id));
    let carried: f64 = feet.iter().map(|f| f.forces.moment_nm[0].abs()).sum();
    assert!((carried / overturning - 1.0).abs() < 1e-6, "{carried} {overturning}");
    for foot in feet {
        assert!(foot.section.ratio > 3.0 && foot.homogenised.ratio > 1.0, "{foot:?}");
        assert!((foot.forces.axial_n / (0.5 * weight) - 1.0).abs() < 1e-9);
    }
    assert!(demands.ends.iter().find(|e| e.id == "C1-A1.top").unwrap().after.is_none());
}

#[test]
fn without_ground_floor_columns_the_rest_is_named_as_a_mechanism() {
    let mut building = reference();
    charge(&mut building, "C1-A2");
    charge(&mut building, "C1-B2");
    let demands = demands(&Structure::of(&building), &building);
    let Some(StateSummary::Mechanism(mechanism)) = &demands.after else { panic!("{:?}", demands.after) };
    assert_eq!(mechanism.members.len(), 12 - 4 + 12);
    assert!(mechanism.members.contains(&"C3-B2".to_string()));
    assert!(demands.ends.iter().all(|e| e.after.is_none() && e.before.is_some()));
}

#[test]
fn a_gap_is_a_near_miss_and_a_loose_column_a_note() {
    let mut building = reference();
    let lift = |building: &mut Building, id: &str, by: f64| {
        let member = building.members.iter_mut().find(|m| m.id == id).unwrap();
        member.solid.min[2] += by;
    };
    lift(&mut building, "C2-A1", 0.010);
    let structure = Structure::of(&building);
    assert_eq!(structure.near_misses.len(), 1, "{:?}", structure.near_misses);
    let miss = &structure.near_misses[0];
    assert_eq!(miss.members, ["S1", "C2-A1"]);
    assert!((miss.gap_m - 0.010).abs() < 1e-12 && (miss.facing_area_m2 - 0.16).abs() < 1e-9);
    lift(&mut building, "C2-A1", 0.015);
    assert!(Structure::of(&building).near_misses.is_empty(), "25 mm is a joint");
}

#[test]
fn the_graph_is_the_same_every_time() {
    let building = reference();
    let text = || {
        let structure = Structure::of(&building);
        let connections: Vec<_> = structure.connections().cloned().collect();
        serde_json::to_string(&(connections, &structure.ends, demands(&structure, &building))).unwrap()
    };
    assert_eq!(text(), text());
}

#[test]
fn the_command_prints_both_states_and_json() {
    let building = reference();
    let mut arguments = Arguments { file: "three-storey-frame.toml".into(), json: false };
    let text = run(&arguments, &building);
    let weight = format!("weight {:.3} kN, supports {:.3} kN", WEIGHT_N / 1e3, WEIGHT_N / 1e3);
    assert!(text.contains(&weight), "{text}");
    assert!(text.contains("C2-A1               lost; connected to 2 supports"), "{text}");
    assert!(!text.contains(" -0.0"), "no signed zeros");
    arguments.json = true;
    let json: serde_json::Value = serde_json::from_str(&run(&arguments, &building)).unwrap();
    assert_eq!(json["connections"].as_array().unwrap().len(), 44);
    assert_eq!(json["removed"], serde_json::json!(["C1-A1", "C1-B1"]));
    assert_eq!(json["demands"]["after"]["state"], "equilibrium");
}

/// A heading with nothing below it would leave open whether anything was looked for; a linear state that far off is none.
#[test]
fn what_there_is_not_and_what_means_nothing_is_said() {
    let arguments = Arguments { file: "three-storey-frame.toml".into(), json: false };
    let mut building = reference();
    let text = run(&arguments, &building);
    let after = text.lines().find(|line| line.starts_with("  after")).unwrap();
    assert!(after.contains("linear theory means nothing at such displacements"), "{after}");
    assert_eq!(text.matches("linear theory").count(), 1, "{text}");
    assert!(!text.contains("none: no slab touches a beam"));
    building.members.retain(|m| m.kind != MemberKind::Beam);
    let text = run(&arguments, &building);
    assert!(
        text.contains("(slabs with the beams that they touch)\n  none: no slab touches a beam\n"),
        "{text}"
    );
}
