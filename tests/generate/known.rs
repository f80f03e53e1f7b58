//! Features of members and member ends before any run.

use super::reference;
use fallwerk::base::tree::Format;
use fallwerk::building::parse;
use fallwerk::generate::known::Known;
use fallwerk::rules::{Subject, Value};
use std::path::Path;

fn end<'a>(known: &'a Known, id: &str) -> &'a Subject {
    known.ends.iter().find(|s| s.id == id).unwrap()
}

#[test]
fn the_front_columns_of_the_reference_are_taken_away_below_what_stands_over_them() {
    let known = Known::of_building(&reference(|t| t));
    let over = |id: &str| end(&known, id).features["end.over_charge"] == Value::Flag(true);
    // above the charges, and the beams that frame into these stacks
    for id in ["C2-A1.bottom", "C3-B1.top", "B1-A1-B1.start", "B1-A1-B1.end", "B2-A1-A2.start"] {
        assert!(over(id), "{id}");
    }
    for id in ["C1-A1.bottom", "C1-A2.top", "C3-B2.bottom", "B1-A2-B2.start", "B1-A1-A2.end"] {
        assert!(!over(id), "{id}");
    }
    let number = |id: &str, name: &str| end(&known, id).number(name).unwrap();
    // rear columns stand 5 m behind, the longest span is 6 m
    assert!((number("C1-A2.top", "end.charge_distance") - 5.0 / 6.0).abs() < 1e-9);
    assert!(number("C2-A1.top", "end.charge_distance") < 1e-9);
    assert_eq!(number("C2-A1.top", "building.charged_share"), 0.5);
    assert_eq!(number("C2-A1.top", "building.ignition_span"), 0.0);
    assert_eq!(number("C2-A1.top", "member.storey"), 2.0);
    assert!((number("C2-A1.top", "member.storey_share") - 2.0 / 3.0).abs() < 1e-12);
    assert_eq!(end(&known, "C2-A1.top").features["building.mechanism"], Value::Flag(false));
    // the rear columns take what the front ones bore
    assert!(
        number("C1-A2.top", "member.axial_ratio_after") > 1.5 * number("C1-A2.top", "member.axial_ratio")
    );
    // two beams and the columns above and below meet at a corner
    let strengths: Vec<f64> = ["B1-A1-B1.start", "B1-A1-A2.start", "C2-A1.bottom"]
        .map(|id| number(id, "end.joint_strength"))
        .to_vec();
    assert!(strengths.iter().all(|s| *s == strengths[0] && (0.1..10.0).contains(s)), "{strengths:?}");
    assert_eq!(number("B1-A1-A2.end", "end.column_demand_ratio"), {
        let columns = ["C1-A2.top", "C2-A2.bottom"].map(|id| number(id, "end.demand_ratio"));
        columns[0].max(columns[1])
    });
}

#[test]
fn without_a_charge_nothing_is_known_of_the_distance_to_one() {
    let known = Known::of_building(&super::standing());
    let top = end(&known, "C1-A1.top");
    assert_eq!(top.number("end.charge_distance"), None);
    assert_eq!(top.number("member.axial_ratio_after"), None);
    assert_eq!(top.features["end.over_charge"], Value::Flag(false));
    assert!(top.number("building.demand_ratio").is_some_and(|ratio| ratio < 1.0));
}

#[test]
fn what_may_topple_onto_an_obstacle_is_known() {
    let known = Known::of_building(&reference(|t| t));
    assert_eq!(end(&known, "C1-A1.top").number("member.obstacle_distance"), None, "there is none");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("buildings/three-storey-frame-wall.toml");
    let building = parse(&std::fs::read_to_string(path).unwrap(), Format::Toml, "wall").unwrap();
    let known = Known::of_building(&building);
    let number = |id: &str, name: &str| end(&known, id).number(name).unwrap();
    // the wall begins 2 m in front of the front face; tops of the columns are where the slabs above begin
    for (id, gap_m) in [("C1-A1.top", 2.0), ("C1-A2.top", 2.0 + 5.0), ("C3-A1.top", 2.0)] {
        let member = building.members.iter().find(|m| id.starts_with(&m.id)).unwrap();
        let ratio = gap_m / member.solid.max[2];
        assert!((number(id, "member.obstacle_distance") - ratio).abs() < 1e-9, "{id}");
    }
    let fall_m = number("C3-A1.top", "member.fall_height");
    let speed = number("C3-A1.top", "member.impact_speed");
    assert!(fall_m > 6.0 && (speed * speed - 2.0 * 9.81 * fall_m).abs() < 1e-9, "{speed}");
}
