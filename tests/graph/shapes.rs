//! Other shapes of buildings: flat slab, secondary beam, transfer, footing, wall, weakening.

use super::buildings::{add, charge, empty, reference, support};
use fallwerk::building::*;
use fallwerk::graph::demand::StateSummary;
use fallwerk::graph::*;

/// Solves the dead-load state and checks that the supports carry the weight.
fn solved(building: &Building) -> (Structure, Demands) {
    let structure = Structure::of(building);
    let demands = demands(&structure, building);
    match &demands.before {
        StateSummary::Equilibrium { weight_n, reaction_sum_n, unplaced, .. } => {
            assert!(unplaced.is_empty(), "{unplaced:?}");
            assert!((reaction_sum_n[2] / weight_n - 1.0).abs() < 1e-9, "{reaction_sum_n:?} {weight_n}");
        }
        other => panic!("{other:?}"),
    }
    (structure, demands)
}

fn axial(demands: &Demands, id: &str) -> f64 {
    demands.ends.iter().find(|e| e.id == id).unwrap().before.unwrap().forces.axial_n
}

/// Four columns at the corners of 6 x 5 m up to `top`.
fn columns(building: &mut Building, top: f64) {
    for (id, x, y) in [("C-A1", 0.0, 0.0), ("C-A2", 0.0, 5.0), ("C-B1", 6.0, 0.0), ("C-B2", 6.0, 5.0)] {
        add(building, id, MemberKind::Column, [x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, top]);
        support(building, id);
    }
}

#[test]
fn flat_slab_on_strips() {
    let mut building = empty();
    columns(&mut building, 3.5);
    add(&mut building, "S", MemberKind::Slab, [-0.2, -0.2, 3.25], [6.2, 5.2, 3.5]);
    let (structure, demands) = solved(&building);
    assert_eq!(structure.end("C-A1.top").unwrap().connected, ["S"]);
    let weight = structure.mass_of(&[0, 1, 2, 3, 4]).mass_kg * 9.81;
    for id in ["C-A1.bottom", "C-A2.bottom", "C-B1.bottom", "C-B2.bottom"] {
        assert!((axial(&demands, id) / (0.25 * weight) - 1.0).abs() < 1e-9);
    }
    // The strips clamp the column tops: without them there would be no moment.
    let top = demands.ends.iter().find(|e| e.id == "C-A1.top").unwrap().before.unwrap();
    assert!(top.forces.moment_nm.iter().all(|m| m.abs() > 1e3), "{top:?}");
}

/// Four columns, two beams along y on them, a secondary beam between their middles.
#[test]
fn secondary_beam_hangs_on_the_main_beams() {
    let mut building = empty();
    columns(&mut building, 3.5);
    add(&mut building, "B-A", MemberKind::Beam, [-0.15, -0.2, 3.0], [0.15, 5.2, 3.5]);
    add(&mut building, "B-B", MemberKind::Beam, [5.85, -0.2, 3.0], [6.15, 5.2, 3.5]);
    add(&mut building, "B-2", MemberKind::Beam, [0.0, 2.35, 3.0], [6.0, 2.65, 3.5]);
    let (structure, demands) = solved(&building);
    let end = structure.end("B-2.start").unwrap();
    assert!((end.point_m[0] - 0.15).abs() < 1e-12);
    assert_eq!(end.connected, ["B-A"]);
    let feet = ["C-A1.bottom", "C-A2.bottom", "C-B1.bottom", "C-B2.bottom"].map(|id| axial(&demands, id));
    assert!(feet.iter().all(|n| (n / feet[0] - 1.0).abs() < 1e-9), "{feet:?}");
}

/// Beams wider than a column, over which other ones end: these end at the wide beam's faces, beyond the column's, and hang in its joint all the same. The columns are held the same way as by narrow beams.
#[test]
fn beams_end_at_a_beam_wider_than_its_column() {
    let state = |width_m: f64| {
        let mut building = empty();
        columns(&mut building, 3.5);
        let half = 0.5 * width_m;
        add(&mut building, "B-1", MemberKind::Beam, [-0.2, -half, 3.0], [6.2, half, 3.5]);
        add(&mut building, "B-2", MemberKind::Beam, [-0.2, 5.0 - half, 3.0], [6.2, 5.0 + half, 3.5]);
        add(&mut building, "B-A", MemberKind::Beam, [-0.15, 0.0, 3.0], [0.15, 5.0, 3.5]);
        add(&mut building, "B-B", MemberKind::Beam, [5.85, 0.0, 3.0], [6.15, 5.0, 3.5]);
        let (structure, demands) = solved(&building);
        let start = structure.end("B-A.start").unwrap().point_m[1];
        (start, demands)
    };
    let moment = |demands: &Demands, id: &str| {
        demands.ends.iter().find(|e| e.id == id).unwrap().before.unwrap().forces.moment_nm[0].abs()
    };
    let ((narrow_m, narrow), (wide_m, wide)) = (state(0.38), state(0.6));
    assert!((narrow_m - 0.2).abs() < 1e-9 && (wide_m - 0.3).abs() < 1e-9, "{narrow_m} {wide_m}");
    let feet = ["C-A1.bottom", "C-A2.bottom", "C-B1.bottom", "C-B2.bottom"].map(|id| axial(&wide, id));
    assert!(feet.iter().all(|n| (n / feet[0] - 1.0).abs() < 1e-9), "{feet:?}");
    // the joint clamps B-A either way, over clear lengths of 4.6 and 4.4 m
    let [a, b] = [&narrow, &wide].map(|demands| moment(demands, "B-A.start"));
    assert!((b / a - 1.0).abs() < 0.25 && b > 1e3, "{a} {b}");
}

/// A column that stands on the middle of a beam: half of its weight goes to either side.
#[test]
fn transfer_beam() {
    let mut building = empty();
    for (id, x) in [("C-A", 0.0), ("C-B", 6.0)] {
        add(&mut building, id, MemberKind::Column, [x - 0.2, -0.2, 0.0], [x + 0.2, 0.2, 3.5]);
        support(&mut building, id);
    }
    add(&mut building, "B", MemberKind::Beam, [-0.2, -0.15, 3.0], [6.2, 0.15, 3.5]);
    add(&mut building, "C-top", MemberKind::Column, [2.8, -0.2, 3.5], [3.2, 0.2, 6.5]);
    let (structure, demands) = solved(&building);
    let weight = structure.mass_of(&[0, 1, 2, 3]).mass_kg * 9.81;
    let feet = ["C-A.bottom", "C-B.bottom"].map(|id| axial(&demands, id));
    assert!(feet.iter().all(|n| (n / (0.5 * weight) - 1.0).abs() < 1e-9), "{feet:?} {weight}");
    let paths = structure.load_paths(&building, &Default::default());
    assert_eq!(paths[3].vertical, VerticalPath::Lost, "it stands on a beam, not on a column");
    assert_eq!(paths[3].supports.len(), 2);
}

/// A beam through over three columns in one piece has two clear spans, numbered.
#[test]
fn beam_in_one_piece_over_three_columns() {
    let mut building = empty();
    for (id, x) in [("C-A", 0.0), ("C-B", 5.0), ("C-C", 10.0)] {
        add(&mut building, id, MemberKind::Column, [x - 0.2, -0.2, 0.0], [x + 0.2, 0.2, 3.5]);
        support(&mut building, id);
    }
    add(&mut building, "B", MemberKind::Beam, [-0.2, -0.15, 3.0], [10.2, 0.15, 3.5]);
    let (structure, demands) = solved(&building);
    let ids: Vec<&str> =
        structure.ends.iter().filter(|e| e.member_id == "B").map(|e| e.id.as_str()).collect();
    assert_eq!(ids, ["B.1.start", "B.1.end", "B.2.start", "B.2.end"]);
    let feet = ["C-A.bottom", "C-B.bottom", "C-C.bottom"].map(|id| axial(&demands, id));
    assert!((feet[0] / feet[2] - 1.0).abs() < 1e-9 && feet[1] > 1.5 * feet[0], "{feet:?}");
}

#[test]
fn footing_and_wall() {
    let mut building = empty();
    add(&mut building, "F", MemberKind::Footing, [-1.0, -1.0, -0.5], [1.0, 4.0, 0.0]);
    support(&mut building, "F");
    add(&mut building, "W", MemberKind::Wall, [-0.125, 0.0, 0.0], [0.125, 3.0, 3.0]);
    add(&mut building, "S", MemberKind::Slab, [-1.0, -0.5, 3.0], [3.0, 3.5, 3.25]);
    let (structure, demands) = solved(&building);
    let foot = structure.end("W.bottom").unwrap();
    assert!(foot.supported && foot.connected == ["F"]);
    // The slab's centre is 1 m beside the wall: but a slab on one upright rests at its joint.
    let above = structure.mass_of(&[1, 2]).mass_kg * 9.81;
    assert!((axial(&demands, "W.bottom") / above - 1.0).abs() < 1e-9);
    assert!(
        structure.load_paths(&building, &Default::default()).iter().all(|p| p.vertical == VerticalPath::Kept)
    );
}

/// A charge on a footing frees what stands on it; the footing lies where it is.
#[test]
fn a_footing_that_goes_holds_no_longer() {
    let mut building = empty();
    columns(&mut building, 3.5);
    building.supports.clear();
    for (n, (x, y)) in [(0.0, 0.0), (0.0, 5.0), (6.0, 0.0), (6.0, 5.0)].into_iter().enumerate() {
        let id = format!("F{n}");
        add(&mut building, &id, MemberKind::Footing, [x - 0.6, y - 0.6, -0.5], [x + 0.6, y + 0.6, 0.0]);
        support(&mut building, &id);
    }
    for (id, y) in [("B1", 0.0), ("B2", 5.0)] {
        add(&mut building, id, MemberKind::Beam, [-0.2, y - 0.15, 3.0], [6.2, y + 0.15, 3.5]);
    }
    for (id, x) in [("B3", 0.0), ("B4", 6.0)] {
        add(&mut building, id, MemberKind::Beam, [x - 0.15, -0.2, 3.0], [x + 0.15, 5.2, 3.5]);
    }
    let without = |id: &str| {
        let mut building = building.clone();
        charge(&mut building, id);
        let (structure, demands) = solved(&building);
        let Some(StateSummary::Equilibrium { weight_n, reaction_sum_n, unplaced, .. }) =
            demands.after.clone()
        else {
            panic!("{:?}", demands.after)
        };
        assert!(
            unplaced.is_empty() && (reaction_sum_n[2] / weight_n - 1.0).abs() < 1e-9,
            "{id}: {unplaced:?}"
        );
        let feet: Vec<f64> = ["C-A2.bottom", "C-B1.bottom", "C-B2.bottom"]
            .map(|id| structure.ends.iter().position(|e| e.id == id).unwrap())
            .map(|e| demands.ends[e].after.unwrap().forces.axial_n)
            .into();
        (feet, weight_n)
    };
    let ((by_footing, heavy), (by_column, light)) = (without("F0"), without("C-A1"));
    // the column that hangs from the beams in place of standing on its footing is borne by the others
    let hangs = by_footing.iter().sum::<f64>() - by_column.iter().sum::<f64>();
    let column = 0.4 * 0.4 * 3.0 * 2500.0 * 9.81;
    assert!(
        (hangs / column - 1.0).abs() < 1e-6 && heavy != light,
        "{hangs} {column}: {by_footing:?} {by_column:?}"
    );
}

/// A slab between four walls of which two that face each other go: the strip between them crosses the other one, which bears it; and one between walls inside a ring of beams goes with them.
#[test]
fn strips_of_walls_that_go_rest_on_what_they_cross_or_go_too() {
    let after = |building: &Building| {
        let (_, demands) = solved(building);
        assert!(matches!(demands.after, Some(StateSummary::Equilibrium { .. })), "{:?}", demands.after);
    };
    let mut shaft = empty();
    let walls = [
        ("WA", [0.0, 0.2], [0.2, 4.8]),
        ("WB", [5.8, 0.2], [6.0, 4.8]),
        ("WC", [0.0, 0.0], [6.0, 0.2]),
        ("WD", [0.0, 4.8], [6.0, 5.0]),
    ];
    for storey in 0..2 {
        let z = 3.0 * storey as f64;
        for (id, [x0, y0], [x1, y1]) in walls {
            let id = format!("{id}{storey}");
            add(&mut shaft, &id, MemberKind::Wall, [x0, y0, z], [x1, y1, z + 2.75]);
            if storey == 0 {
                support(&mut shaft, &id);
            }
        }
        add(&mut shaft, &format!("S{storey}"), MemberKind::Slab, [0.0, 0.0, z + 2.75], [6.0, 5.0, z + 3.0]);
    }
    charge(&mut shaft, "WA0");
    charge(&mut shaft, "WB0");
    after(&shaft);
    let mut ring = empty();
    columns(&mut ring, 3.5);
    for (id, y) in [("B1", 0.0), ("B2", 5.0)] {
        add(&mut ring, id, MemberKind::Beam, [-0.2, y - 0.15, 3.0], [6.2, y + 0.15, 3.5]);
    }
    for (id, x) in [("B3", 0.0), ("B4", 6.0)] {
        add(&mut ring, id, MemberKind::Beam, [x - 0.15, -0.2, 3.0], [x + 0.15, 5.2, 3.5]);
    }
    for (id, x) in [("W1", 2.0), ("W2", 4.0)] {
        add(&mut ring, id, MemberKind::Wall, [x - 0.1, 1.5, 0.0], [x + 0.1, 3.5, 3.25]);
        support(&mut ring, id);
        charge(&mut ring, id);
    }
    add(&mut ring, "S", MemberKind::Slab, [-0.2, -0.2, 3.25], [6.2, 5.2, 3.5]);
    after(&ring);
}

#[test]
fn weakening_scales_capacity_and_demand_ratio() {
    let mut building = reference();
    let ratio = |b: &Building| {
        let (structure, d) = solved(b);
        let index = structure.ends.iter().position(|e| e.id == "C1-A1.bottom").unwrap();
        let state = d.ends[index].before.unwrap();
        (state.homogenised.ratio, state.homogenised.capacity_nm[0])
    };
    let (full, full_capacity) = ratio(&building);
    let weaken = Preparation::Weaken { member: "C1-A1".into(), strength_factor: 0.5 };
    building.preparation.push(weaken);
    let (weak, capacity) = ratio(&building);
    // moment and axial force over half the strength: half as much of both alike
    assert!((weak / full - 2.0).abs() < 1e-6 && capacity < 0.5 * full_capacity, "{full} {weak}");
}

#[test]
fn cut_members_are_gone_before_the_dead_load_state() {
    let mut building = reference();
    building.events.clear();
    building.preparation.push(Preparation::Cut { member: "C1-A1".into() });
    let (_, demands) = solved(&building);
    assert!(demands.after.is_none());
    assert!(demands.ends.iter().find(|e| e.id == "C1-A1.top").unwrap().before.is_none());
    // Three columns: the diagonal neighbour is relieved, the others take more.
    let [a2, b1, b2] = ["C1-A2.bottom", "C1-B1.bottom", "C1-B2.bottom"].map(|id| axial(&demands, id));
    assert!(b2 < a2 && b2 < b1, "{a2} {b1} {b2}");
}

/// Two beams meet at their ends where no column is: there is one node, and no element without a length between two.
#[test]
fn beams_that_meet_where_no_column_is() {
    let feet = |beyond: f64| {
        let mut building = empty();
        columns(&mut building, 3.5);
        building.members.retain(|m| m.id != "C-B2");
        building.supports.retain(|s| s.member != "C-B2");
        add(&mut building, "B-1", MemberKind::Beam, [0.0, -0.15, 3.0], [6.0, 0.15, 3.5]);
        add(&mut building, "B-A", MemberKind::Beam, [-0.15, 0.0, 3.0], [0.15, 5.0, 3.5]);
        add(&mut building, "B-2", MemberKind::Beam, [0.0, 4.85, 3.0], [6.0 + beyond, 5.15, 3.5]);
        add(&mut building, "B-B", MemberKind::Beam, [5.85, 0.0, 3.0], [6.15, 5.0, 3.5]);
        let (_, demands) = solved(&building);
        ["C-A1.bottom", "C-A2.bottom", "C-B1.bottom"].map(|id| axial(&demands, id))
    };
    let (met, past) = (feet(0.0), feet(0.15));
    for (a, b) in met.iter().zip(past) {
        assert!((a / b - 1.0).abs() < 0.05, "{met:?} {past:?}");
    }
}

/// What the weight of a state is and its supports bear \[N\], who is left out, and the warnings.
fn borne(state: &StateSummary) -> ([f64; 2], Vec<String>, Vec<String>) {
    let StateSummary::Equilibrium { weight_n, reaction_sum_n, left_out, .. } = state else {
        panic!("{state:?}")
    };
    ([*weight_n, reaction_sum_n[2]], left_out.clone(), state.warnings())
}

/// A column in the middle of a panel between beams bears its share, the same from all four sides.
#[test]
fn a_column_in_a_panel_bears() {
    let mut building = empty();
    columns(&mut building, 3.5);
    add(&mut building, "B-1", MemberKind::Beam, [-0.2, -0.15, 3.0], [6.2, 0.15, 3.5]);
    add(&mut building, "B-2", MemberKind::Beam, [-0.2, 4.85, 3.0], [6.2, 5.15, 3.5]);
    add(&mut building, "B-A", MemberKind::Beam, [-0.15, -0.2, 3.0], [0.15, 5.2, 3.5]);
    add(&mut building, "B-B", MemberKind::Beam, [5.85, -0.2, 3.0], [6.15, 5.2, 3.5]);
    add(&mut building, "S", MemberKind::Slab, [-0.2, -0.2, 3.25], [6.2, 5.2, 3.5]);
    add(&mut building, "K", MemberKind::Column, [2.8, 2.3, 0.0], [3.2, 2.7, 3.25]);
    support(&mut building, "K");
    let (structure, demands) = solved(&building);
    let slab = structure.members().find(|m| m.id == "S").unwrap().mass.mass_kg * 9.81;
    let share = axial(&demands, "K.top") / slab;
    assert!((0.15..0.6).contains(&share), "{share}");
    let feet = ["C-A1.bottom", "C-A2.bottom", "C-B1.bottom", "C-B2.bottom"].map(|id| axial(&demands, id));
    assert!(feet.iter().all(|n| (n / feet[0] - 1.0).abs() < 1e-9), "{feet:?}");
    let top = demands.ends.iter().find(|e| e.id == "K.top").unwrap().before.unwrap();
    assert!(top.forces.moment_nm.iter().all(|m| m.abs() < 1.0), "{top:?}");
    assert!(borne(&demands.before).2.is_empty());
}

/// A flat slab on columns off any grid rests on those that are left when one goes.
#[test]
fn columns_out_of_line_bear_a_flat_slab() {
    let mut building = empty();
    let places = [("C0", 0.0, 0.0), ("C1", 5.0, 0.8), ("C2", 0.9, 5.0), ("C3", 5.8, 5.7)];
    for (id, x, y) in places {
        add(&mut building, id, MemberKind::Column, [x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, 3.0]);
        support(&mut building, id);
    }
    for (id, x, y) in places {
        let id = format!("{id}-up");
        add(&mut building, &id, MemberKind::Column, [x - 0.2, y - 0.2, 3.0], [x + 0.2, y + 0.2, 6.0]);
    }
    add(&mut building, "S1", MemberKind::Slab, [-0.2, -0.2, 2.75], [6.2, 6.2, 3.0]);
    add(&mut building, "S2", MemberKind::Slab, [-0.2, -0.2, 5.75], [6.2, 6.2, 6.0]);
    super::buildings::charge(&mut building, "C0");
    let (_, demands) = solved(&building);
    let top = demands.ends.iter().find(|e| e.id == "C3.top").unwrap().before.unwrap();
    assert!(top.section.ratio > 0.0, "the slab clamps it: {top:?}");
    let ([weight, supports], _, warnings) = borne(demands.after.as_ref().unwrap());
    assert!(
        (supports / weight - 1.0).abs() < 1e-9 && warnings.is_empty(),
        "{weight} {supports} {warnings:?}"
    );
}

/// A column under a slab that rests on beams, where no other column is: nothing goes to it, which is told.
#[test]
fn a_column_that_is_left_out_is_told() {
    let mut building = empty();
    columns(&mut building, 3.5);
    add(&mut building, "B-1", MemberKind::Beam, [-0.2, -0.3, 3.0], [6.2, 0.3, 3.5]);
    add(&mut building, "B-2", MemberKind::Beam, [-0.2, 4.7, 3.0], [6.2, 5.3, 3.5]);
    add(&mut building, "S", MemberKind::Slab, [0.25, 0.25, 3.25], [5.75, 4.75, 3.5]);
    add(&mut building, "K", MemberKind::Column, [2.8, 2.3, 0.0], [3.2, 2.7, 3.25]);
    support(&mut building, "K");
    let (_, demands) = solved(&building);
    let (_, left_out, warnings) = borne(&demands.before);
    assert_eq!(left_out, ["K"]);
    assert!(warnings.len() == 1 && warnings[0].starts_with("K touch"), "{warnings:?}");
    assert!(demands.warnings(&building)[0].starts_with("before: K touch"));
}

/// An L of three bays on eight columns, with its slab in the rectangles given, and beams on its outline or none.
fn angle(slabs: &[[f64; 4]], with_beams: bool) -> Building {
    let mut building = empty();
    let axes: Vec<[f64; 2]> = [0.0, 6.0, 12.0]
        .into_iter()
        .flat_map(|x| [0.0, 5.0, 10.0].map(|y| [x, y]))
        .filter(|p| *p != [12.0, 10.0])
        .collect();
    for [x, y] in &axes {
        let id = format!("C-{x}-{y}");
        add(&mut building, &id, MemberKind::Column, [x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, 3.5]);
        support(&mut building, &id);
    }
    let outline = [
        [0.0, 0.0, 12.0, 0.0],
        [0.0, 10.0, 6.0, 10.0],
        [6.0, 5.0, 12.0, 5.0],
        [0.0, 0.0, 0.0, 10.0],
        [12.0, 0.0, 12.0, 5.0],
        [6.0, 5.0, 6.0, 10.0],
    ];
    for [x0, y0, x1, y1] in outline.into_iter().filter(|_| with_beams) {
        let id = format!("B-{x0}-{y0}-{x1}-{y1}");
        let wide = |from: f64, to: f64| if from == to { [from - 0.15, to + 0.15] } else { [from, to] };
        let ([x0, x1], [y0, y1]) = (wide(x0, x1), wide(y0, y1));
        add(&mut building, &id, MemberKind::Beam, [x0, y0, 3.0], [x1, y1, 3.5]);
    }
    for (number, [x0, y0, x1, y1]) in slabs.iter().enumerate() {
        let id = format!("S{number}");
        add(&mut building, &id, MemberKind::Slab, [*x0, *y0, 3.25], [*x1, *y1, 3.5]);
    }
    building
}

/// Slabs that meet are one plate: it makes no difference along which lines a plan is cut.
#[test]
fn where_a_plan_is_cut_into_slabs_makes_no_difference() {
    let rows = [[-0.2, -0.2, 12.2, 5.2], [-0.2, 5.2, 6.2, 10.2]];
    let columns = [[-0.2, -0.2, 6.2, 10.2], [6.2, -0.2, 12.2, 5.2]];
    let bays =
        [[-0.2, 5.0, 6.2, 10.2], [-0.2, -0.2, 6.0, 5.0], [6.0, -0.2, 12.2, 5.0], [6.2, 5.0, 12.2, 5.2]];
    for with_beams in [false, true] {
        let moments = |slabs: &[[f64; 4]]| -> Vec<[f64; 3]> {
            let (_, demands) = solved(&angle(slabs, with_beams));
            let columns = demands.ends.iter().filter(|e| e.id.starts_with("C-"));
            columns
                .map(|e| e.before.unwrap().forces)
                .map(|f| [f.axial_n, f.moment_nm[0], f.moment_nm[1]])
                .collect()
        };
        let wanted = moments(&rows);
        let most = |i: usize| wanted.iter().map(|f| f[i].abs()).fold(0.0, f64::max);
        for other in [&columns[..], &bays[..]] {
            for (a, b) in wanted.iter().zip(moments(other)) {
                // sample points of the load lie on a raster of each slab
                (0..3)
                    .for_each(|i| assert!((a[i] - b[i]).abs() < 5e-3 * most(i), "{with_beams}: {a:?} {b:?}"));
            }
        }
    }
}

/// No strip bridges a gap in a plan: both tips of a U bear on their own arms.
#[test]
fn strips_do_not_bridge_what_is_not_built() {
    let slabs = [[-0.2, -0.2, 6.2, 10.2], [6.2, -0.2, 11.8, 5.2], [11.8, -0.2, 18.2, 10.2]];
    let mut building = empty();
    for x in [0.0, 6.0, 12.0, 18.0] {
        for y in [0.0, 5.0, 10.0] {
            let id = format!("C-{x}-{y}");
            add(&mut building, &id, MemberKind::Column, [x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, 3.5]);
            support(&mut building, &id);
        }
    }
    for (number, [x0, y0, x1, y1]) in slabs.iter().enumerate() {
        let id = format!("S{number}");
        add(&mut building, &id, MemberKind::Slab, [*x0, *y0, 3.25], [*x1, *y1, 3.5]);
    }
    let structure = Structure::of(&building);
    let frame = idealise::idealise(&structure, &building, &Default::default()).frame;
    let crosses = |e: &&frame::Element| {
        let [a, b] = e.ends_m;
        a[1].min(b[1]) > 7.0 && a[0].min(b[0]) < 6.5 && a[0].max(b[0]) > 11.5
    };
    assert_eq!(frame.elements.iter().filter(crosses).count(), 0);
    let along = |e: &&frame::Element| e.ends_m.iter().all(|p| (p[1] - 5.0).abs() < 1e-9 && p[2] > 3.2);
    assert_eq!(frame.elements.iter().filter(along).count(), 3, "the base goes on along its edge");
}
