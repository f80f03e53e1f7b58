//! Parts of a frame that cannot be held, and what stands beside them.

use super::buildings::{add, charge, empty, reference, support};
use super::equilibrium::states;
use fallwerk::building::{Building, MemberKind};
use fallwerk::graph::demand::StateSummary;
use fallwerk::graph::*;

/// A flat slab of 250 mm on four columns at the corners of 6 x 5 m.
fn flat_slab() -> Building {
    let mut building = empty();
    for (id, x, y) in [("C0", 0.0, 0.0), ("C1", 6.0, 0.0), ("C2", 0.0, 5.0), ("C3", 6.0, 5.0)] {
        add(&mut building, id, MemberKind::Column, [x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, 3.25]);
        support(&mut building, id);
    }
    add(&mut building, "S", MemberKind::Slab, [-0.2, -0.2, 3.25], [6.2, 5.2, 3.5]);
    building
}

/// A beam below it that ends 0.5 m short of the columns, or of their row.
fn with_short_beam(y: f64) -> (Structure, Demands) {
    let mut building = flat_slab();
    add(&mut building, "BX", MemberKind::Beam, [0.7, y - 0.15, 3.0], [5.3, y + 0.15, 3.5]);
    states(&building)
}

fn end<'a>(demands: &'a Demands, id: &str) -> &'a EndDemand {
    demands.ends.iter().find(|e| e.id == id).unwrap()
}

/// Beams that only a slab holds, weight and support force \[N\].
fn borne(state: &StateSummary) -> (&[String], f64, f64) {
    let StateSummary::Equilibrium { by_slab, weight_n, reaction_sum_n, .. } = state else {
        panic!("{state:?}")
    };
    (by_slab, *weight_n, reaction_sum_n[2])
}

/// A beam along the strip between two columns bends with it; the whole had no equilibrium.
#[test]
fn a_beam_along_a_strip_bends_with_it() {
    let (_, demands) = with_short_beam(0.0);
    let (by_slab, weight, supports) = borne(&demands.before);
    assert!(by_slab.is_empty() && (supports / weight - 1.0).abs() < 1e-9, "{by_slab:?} {supports} {weight}");
    assert_eq!(demands.before.warnings(), Vec::<String>::new());
    let [start, end_] = ["BX.start", "BX.end"].map(|id| end(&demands, id).before.unwrap().forces);
    assert!(start.moment_nm[0].abs() > 10.0, "{start:?}");
    assert!((start.moment_nm[0] / end_.moment_nm[0] - 1.0).abs() < 1e-6, "{start:?} {end_:?}");
}

/// The slab bears a beam in the middle of its panel, a quarter of it on each column.
#[test]
fn a_beam_in_a_panel_is_borne_by_the_slab() {
    let (structure, demands) = with_short_beam(2.5);
    let (by_slab, ..) = borne(&demands.before);
    assert_eq!(by_slab, ["BX"]);
    let warnings = demands.before.warnings();
    assert!(warnings.len() == 1 && warnings[0].starts_with("only a slab holds BX"), "{warnings:?}");
    assert!(end(&demands, "BX.start").before.is_none());
    let above: f64 = ["S", "BX"].map(|id| structure.member(id).unwrap().mass.mass_kg * 9.81).iter().sum();
    for id in ["C0.top", "C1.top", "C2.top", "C3.top"] {
        let head = end(&demands, id).before.unwrap().forces.axial_n;
        assert!((head / (0.25 * above) - 1.0).abs() < 1e-9, "{id}: {head} {above}");
    }
}

/// A column beside that loses the one below it leaves a building its demands.
#[test]
fn a_building_beside_one_that_falls_keeps_its_demands() {
    let (_, alone) = states(&flat_slab());
    let mut building = flat_slab();
    add(&mut building, "K0", MemberKind::Column, [19.8, -0.2, 0.0], [20.2, 0.2, 3.0]);
    add(&mut building, "K1", MemberKind::Column, [19.8, -0.2, 3.0], [20.2, 0.2, 6.0]);
    support(&mut building, "K0");
    charge(&mut building, "K0");
    let (_, demands) = states(&building);
    let after = demands.after.as_ref().unwrap();
    assert_eq!(demands.before.free(), None);
    assert_eq!(after.free(), Some(&["K1".to_string()][..]));
    assert_eq!(after.warnings(), Vec::<String>::new());
    let [(_, weight, supports), (_, wanted, _)] = [borne(after), borne(&alone.before)];
    assert!((weight / wanted - 1.0).abs() < 1e-9 && (supports / weight - 1.0).abs() < 1e-9);
    assert!(end(&demands, "K1.bottom").after.is_none() && end(&demands, "K1.bottom").before.is_some());
    for other in &alone.ends {
        let [found, wanted] = [end(&demands, &other.id).after, other.before].map(|s| s.unwrap().forces);
        let off = (0..2).map(|i| (found.moment_nm[i] - wanted.moment_nm[i]).abs()).fold(0.0, f64::max);
        assert!((found.axial_n / wanted.axial_n - 1.0).abs() < 1e-9 && off < 1e-3, "{found:?} {wanted:?}");
    }
}

/// Storeys below those that fall bear them later: without them their forces mean nothing.
#[test]
fn storeys_below_charged_ones_have_no_demands() {
    let mut building = reference();
    building.events.clear();
    for at in ["A1", "A2", "B1", "B2"] {
        charge(&mut building, &format!("C2-{at}"));
    }
    let (_, demands) = states(&building);
    assert!(matches!(demands.after, Some(StateSummary::Mechanism(_))), "{:?}", demands.after);
}
