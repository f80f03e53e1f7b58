//! What charges take out of floors, and what is left of joints that a beam has been cut away from.

use super::*;
use fallwerk::building::{Charge, Preparation};
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::removal::hit;
use fallwerk::mbs::simulate;

const FRONT: &str = "B1-A1-B1";

fn charge(member: &str, time_s: f64) -> Charge {
    Charge { id: format!("at-{member}"), member: member.into(), stretch_m: None, time_s }
}

/// The reference building with other charges.
fn charged(members: &[(&str, f64)]) -> Building {
    Building { events: members.iter().map(|(m, t)| charge(m, *t)).collect(), ..reference(|t| t) }
}

fn removed<'a>(generated: &'a Generated, event: &str) -> Vec<&'a str> {
    let event = generated.model.events.iter().find(|e| e.id == event).unwrap_or_else(|| panic!("{event}"));
    event.remove_bodies.iter().map(String::as_str).collect()
}

/// The web goes, with its share of the springs; slab, joints and the other beams stay, and the frame with them.
#[test]
fn a_charge_on_a_beam_takes_its_web_and_no_more() {
    let (rules, mut store, _cache) = knowledge();
    let mut generate = |accuracy| {
        let wishes = Wishes { derive: Derive::Similar, accuracy };
        generate(&charged(&[(FRONT, 0.0)]), &rules, &mut store, wishes, &|_| {}).unwrap()
    };
    let balanced = generate(Accuracy::Balanced);
    balanced.model.check().expect("a sound model");
    assert_eq!(removed(&balanced, "at-B1-A1-B1"), ["B1-A1-B1/1", "B1-A1-B1/2"]);
    assert!(balanced.model.event_rules.iter().all(|r| r.bodies.iter().all(|b| !b.starts_with(FRONT))));
    let web: f64 = balanced.model.bodies.iter().filter(|b| b.id.starts_with(FRONT)).map(|b| b.mass_kg).sum();
    // 0.3 m by 0.25 m below the slab, 5.6 m between the columns
    assert!((web - 2500.0 * 0.3 * 0.25 * 5.6).abs() < 1e-6, "{web}");
    let mut model = balanced.model;
    model.settings.end_time_s = 0.3;
    let run = simulate(&model).expect("it stands");
    let most = |t: &fallwerk::mbs::result::TrackedHistory| {
        t.displacement_m.iter().flatten().fold(0.0_f64, |most, u| most.max(u.abs()))
    };
    let largest = run.tracked.iter().map(most).fold(0.0, f64::max);
    assert!(largest > 1e-6 && largest < 2e-3, "{largest}");
    assert!(run.energy_error < 1e-3, "{}", run.energy_error);
    let fast = generate(Accuracy::Fast);
    if fast.model.bodies.iter().any(|b| b.id == "S1") {
        assert!(fast.model.events.is_empty());
        assert!(fast.notes.iter().any(|n| n.contains("takes nothing away: `B1-A1-B1` stays a part of S1")));
    }
}

/// A floor goes when the last of its members does; a part of it alone cannot.
#[test]
fn a_floor_goes_as_a_whole_or_not_at_all() {
    let error = generated(&charged(&[("S1", 0.0)])).expect_err("beams would go too");
    let words = error.to_string();
    assert!(words.contains("charge `at-S1` is on `S1`, which is one body with other members"), "{words}");
    let beams = ["B1-A1-B1", "B1-A2-B2", "B1-A1-A2", "B1-B1-B2"];
    let mut all: Vec<(&str, f64)> = beams.iter().map(|b| (*b, 0.1)).collect();
    all.insert(0, ("S1", 0.2));
    let whole = generated(&charged(&all)).unwrap();
    whole.model.check().expect("a sound model");
    assert_eq!(removed(&whole, "at-S1"), ["S1/1-1", "S1/1-2", "S1/2-1", "S1/2-2"]);
    assert_eq!(removed(&whole, "at-B1-B1-B2"), ["B1-B1-B2/1", "B1-B1-B2/2"]);
}

/// In the FE model joint blocks over columns stay, which belong to the beam in the mesh.
#[test]
fn joints_outlive_a_beam_that_is_blasted_or_cut() {
    let building = charged(&[(FRONT, 0.0)]);
    let (mesh, _) = Mesh::of(&building, 0.4);
    let gone = hit(&building, &mesh, &building.events[0]);
    assert!(!gone.is_empty());
    for element in gone {
        let x = mesh.center(element)[0];
        assert!(x > 0.2 && x < 5.8, "{x}");
    }
    let preparation = vec![Preparation::Cut { member: FRONT.into() }];
    let cut = Building { preparation, ..charged(&[("C3-A1", 0.0)]) };
    let partition = Partition::of(&cut);
    let owner = |x: f64| partition.member_at([x, 0.0, 3.2]).map(|m| cut.members[m].id.clone());
    assert_eq!((owner(0.0), owner(6.0)), (Some("C1-A1".into()), Some("C1-B1".into())));
    assert_eq!(owner(3.0).as_deref(), Some(FRONT));
    let (rules, mut store, _cache) = knowledge();
    let model = generate(&cut, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model;
    assert!(model.bushings.iter().any(|b| b.id == "C1-A1.top"));
    let mut still = model;
    (still.events, still.settings.end_time_s) = (Vec::new(), 0.02);
    simulate(&still).expect("it stands before the charges");
}

/// A column on which nothing rests has a joint at its foot alone.
#[test]
fn a_free_end_has_no_joint() {
    let stub = "[[members]]\nid = \"K\"\nkind = \"column\"\nsection = \"column\"\nfrom = [0, 0, 10.5]\nto = [0, 0, 12]\n\n[[supports]]";
    let building = reference(|t| t.replacen("[[supports]]", stub, 1));
    let (rules, mut store, _cache) = knowledge();
    let generated = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    let has = |id: &str| generated.model.bushings.iter().any(|b| b.id == id);
    assert!(has("K.bottom") && !has("K.top"));
    assert!(generated.notes.iter().any(|n| n.starts_with("K.top touches neither a member nor a support")));
}

/// Where a slab ends on the axes of columns their heads are its own: nothing goes on beside it, and the columns are joined to it.
#[test]
fn a_flat_slab_that_ends_over_its_columns_stands_on_them() {
    let edge = |t: String| {
        t.replacen("beams = \"perimeter\"", "beams = \"none\"", 1).replacen(
            "slab_overhang = \"200 mm\"",
            "slab_overhang = 0",
            1,
        )
    };
    let building = Building { events: vec![charge("C1-A1", 0.0)], ..reference(edge) };
    let partition = Partition::of(&building);
    let owner = |p: [f64; 3]| partition.member_at(p).map(|m| building.members[m].id.clone());
    assert_eq!(owner([-0.1, -0.1, 3.4]).as_deref(), Some("S1"));
    assert_eq!(owner([-0.1, -0.1, 3.2]).as_deref(), Some("C1-A1"));
    let (rules, mut store, _cache) = knowledge();
    let mut model = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model;
    assert!(model.bushings.iter().any(|b| b.id == "C1-B1.top"));
    model.settings.end_time_s = 0.1;
    simulate(&model).expect("it stands before the charge");
}

/// A weakened beam has less resistance than its slab: large axial forces leave it no moment in one sense, and are no levels of its curve.
#[test]
fn floors_with_weakened_beams_are_generated() {
    let preparation = vec![Preparation::Weaken { member: "B1-A2-B2".into(), strength_factor: 0.5 }];
    let building = Building { preparation, ..charged(&[(FRONT, 0.0)]) };
    let (rules, mut store, _cache) = knowledge();
    let model = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model;
    model.check().expect("a sound model");
}

/// Of a floor that goes as a whole each charge before the last is told.
#[test]
fn charges_before_the_last_of_a_floor_are_told() {
    let all: Vec<(&str, f64)> = ["S1", "B1-A1-B1", "B1-A2-B2", "B1-A1-A2", "B1-B1-B2"]
        .into_iter()
        .zip([0.1, 0.0, 0.0, 0.0, 0.3])
        .collect();
    let generated = generated(&charged(&all)).unwrap();
    let note = "charge `at-S1` takes nothing away at its time: `S1` goes with its floor, at the last of the charges on it (`at-B1-B1-B2`)";
    assert!(generated.notes.iter().any(|n| n == note), "{:?}", generated.notes);
    assert!(removed(&generated, "at-B1-B1-B2").contains(&"S1/1-1"));
}

/// An opening at the edge of a flat slab, over the axis of a column, leaves a cut less slab than the panels beside it would take.
#[test]
fn openings_leave_stiffnesses_positive() {
    let open = |t: String| {
        t.replacen("beams = \"perimeter\"", "beams = \"none\"", 1)
            .replacen("x = [0, 6] ", "x = [0, 6, 12] ", 1)
            .replacen(
                "slab_section = \"slab\"",
                "slab_section = \"slab\"\nslab_openings = [{ from = [4, 3], to = [8, 5] }]",
                1,
            )
    };
    let building = Building { events: vec![charge("C1-A1", 0.0)], ..reference(open) };
    let (rules, mut store, _cache) = knowledge();
    let model = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model;
    model.check().expect("a sound model");
}

/// Bays as long as half a row of elements is half a column: the section beside a column lies where the floor is divided. It yields all the same, wherever the building stands.
#[test]
fn strips_yield_where_their_sections_lie_on_a_division() {
    for shift_m in [0.0, 0.1, 3.0] {
        let bays = |t: String| {
            t.replacen("beams = \"perimeter\"", "beams = \"none\"", 1)
                .replacen("x = [0, 6]", &format!("x = [{shift_m}, {}, {}]", shift_m + 6.0, shift_m + 12.0), 1)
                .replacen("y = [0, 5]", "y = [0, 6, 12]", 1)
        };
        let building = Building { events: vec![charge("C1-A1", 0.0)], ..reference(bays) };
        let (rules, mut store, _cache) = knowledge();
        let model = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap().model;
        let cuts: Vec<_> = model.bushings.iter().filter(|b| b.id.contains('|')).collect();
        let stays =
            |b: &&&fallwerk::mbs::model::Bushing| b.hinges().is_empty() && b.tensile_capacity_n.is_none();
        assert!(cuts.len() > 20);
        assert_eq!(cuts.iter().filter(stays).count(), 0, "moved by {shift_m} m");
    }
}

/// A footing that is held is ground: a charge on it releases what stands on it, and one on which nothing stands is told.
#[test]
fn a_charge_on_a_held_footing_releases_its_column() {
    let pads = "[[members]]\nid = \"F1\"\nkind = \"footing\"\nsection = \"slab\"\nfrom = [-1, -1, 0]\nto = [1, 1, 0]\n\n[[members]]\nid = \"F2\"\nkind = \"footing\"\nsection = \"slab\"\nfrom = [8, -1, 0]\nto = [10, 1, 0]\n\n[[supports]]";
    let held = "members = [\"C1-A2\", \"C1-B1\", \"C1-B2\", \"F1\", \"F2\"]";
    let text = |t: String| t.replacen("[[supports]]", pads, 1).replacen("members = [\"C1-*\"]", held, 1);
    let building = Building { events: vec![charge("F1", 0.1), charge("F2", 0.0)], ..reference(text) };
    let (rules, mut store, _cache) = knowledge();
    let generated = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    let events: Vec<_> = generated.model.events.iter().map(|e| (e.time_s, e.release.clone())).collect();
    assert_eq!(events, [(0.1, vec!["C1-A1.bottom".to_string()])]);
    assert!(generated.notes.iter().any(|n| n.contains("`F2` bears nothing")), "{:?}", generated.notes);
    generated.model.check().expect("a sound model");
}

/// Where a column stands on another one and nothing else is there, its foot is held by that.
#[test]
fn a_column_on_a_column_has_curves() {
    let stack = "[[members]]\nid = \"K1\"\nkind = \"column\"\nsection = \"column\"\nfrom = [9, 0, 0]\nto = [9, 0, 3]\n\n[[members]]\nid = \"K2\"\nkind = \"column\"\nsection = \"column\"\nfrom = [9, 0, 3]\nto = [9, 0, 6]\n\n[[supports]]";
    let text = |t: String| {
        t.replacen("[[supports]]", stack, 1).replacen(
            "members = [\"C1-*\"]",
            "members = [\"C1-*\", \"K1\"]",
            1,
        )
    };
    let building = Building { events: vec![charge("C1-A1", 0.0)], ..reference(text) };
    let (rules, ..) = knowledge();
    let empty = tempfile::tempdir().unwrap();
    let mut store = fallwerk::library::Store::open(empty.path()).unwrap();
    let generated = generate(&building, &rules, &mut store, Derive::Similar, &|_| {}).unwrap();
    let joint = generated.model.bushings.iter().find(|b| b.id == "K2.bottom").expect("a joint between both");
    assert_eq!(joint.body_a.as_deref(), Some("K1"));
}
