//! Slabs that reach beyond what carries them, against statics.

use super::buildings::{add, empty, reference, support};
use super::equilibrium::{off_m, states};
use fallwerk::building::{Building, MemberKind};
use fallwerk::graph::demand::StateSummary;
use fallwerk::graph::paths::{charged_members, cut_members};
use fallwerk::graph::*;

/// Columns of 0.4 m at some places up to a level.
fn columns(building: &mut Building, places: &[[f64; 2]], top: f64) {
    for (number, [x, y]) in places.iter().enumerate() {
        let id = format!("C{number}");
        add(building, &id, MemberKind::Column, [x - 0.2, y - 0.2, 0.0], [x + 0.2, y + 0.2, top]);
        support(building, &id);
    }
}

/// Moments about axes 1 and 2 at a member end \[N m\].
fn moments(demands: &Demands, id: &str) -> [f64; 2] {
    demands.ends.iter().find(|e| e.id == id).unwrap().before.unwrap().forces.moment_nm
}

/// Moment \[N m\] about the origin of a member's weight along an axis.
fn moment_of(structure: &Structure, id: &str, axis: usize) -> f64 {
    let mass = &structure.member(id).unwrap().mass;
    9.81 * mass.mass_kg * mass.center_m[axis]
}

/// Two columns in a row, with a beam on them or none, and a slab that reaches 2.3 m beyond: each column has half of its moment, constant over the height.
#[test]
fn a_slab_on_one_row_bends_its_columns() {
    for with_beam in [false, true] {
        let mut building = empty();
        columns(&mut building, &[[0.0, 0.0], [5.0, 0.0]], if with_beam { 3.0 } else { 3.25 });
        if with_beam {
            add(&mut building, "B", MemberKind::Beam, [-0.2, -0.15, 3.0], [5.2, 0.15, 3.5]);
        }
        add(&mut building, "S", MemberKind::Slab, [-0.2, -0.2, 3.25], [5.2, 2.5, 3.5]);
        let (structure, demands) = states(&building);
        let wanted = 0.5 * moment_of(&structure, "S", 1);
        assert!(wanted > 4e4, "{wanted}");
        for id in ["C0.bottom", "C0.top", "C1.bottom", "C1.top"] {
            let found = moments(&demands, id)[0].abs();
            assert!((found / wanted - 1.0).abs() < 1e-6, "{id}: {found} {wanted}");
        }
        assert!(off_m(&building, &structure, &demands.before, false) < 1e-6);
    }
}

/// A plate on one column beside its middle.
#[test]
fn a_mushroom_bends_its_column() {
    let mut building = empty();
    columns(&mut building, &[[0.0, 0.0]], 3.75);
    add(&mut building, "S", MemberKind::Slab, [-1.0, -1.0, 3.75], [4.0, 1.0, 4.0]);
    let (structure, demands) = states(&building);
    let wanted = moment_of(&structure, "S", 0);
    for id in ["C0.bottom", "C0.top"] {
        let [about_x, about_y] = moments(&demands, id);
        assert!((about_y.abs() / wanted - 1.0).abs() < 1e-6, "{id}: {about_y} {wanted}");
        assert!(about_x.abs() < 1e-6 * wanted, "{id}: {about_x}");
    }
}

/// A flat slab with a balcony: columns and the strips behind take its moment together, so that the supports bear the weight where it is.
#[test]
fn a_balcony_leans_on_the_bay_behind_it() {
    let heads = |front: f64| {
        let mut building = empty();
        columns(&mut building, &[[0.0, 0.0], [5.0, 0.0], [0.0, 5.0], [5.0, 5.0]], 3.25);
        add(&mut building, "S", MemberKind::Slab, [-0.2, front, 3.25], [5.2, 5.2, 3.5]);
        let (structure, demands) = states(&building);
        assert!(off_m(&building, &structure, &demands.before, false) < 1e-6);
        let axial = |id: &str| demands.ends.iter().find(|e| e.id == id).unwrap().before.unwrap();
        let head = |id: &str| axial(id).forces.axial_n;
        let weight = 9.81 * structure.member("S").unwrap().mass.mass_kg;
        assert!(((head("C0.top") + head("C2.top")) / (0.5 * weight) - 1.0).abs() < 1e-9);
        [head("C0.top"), head("C2.top")]
    };
    let ([front, rear], [_, without]) = (heads(-2.5), heads(-0.2));
    // the balcony lifts the rear columns; without its moment they bore what they do without it
    assert!(front > rear && rear < 0.95 * without, "{front} {rear} {without}");
}

/// Slabs that end at the outer faces of columns have no part of this.
#[test]
fn without_an_overhang_no_moment_is_applied() {
    let building = reference();
    let structure = Structure::of(&building);
    let cut = cut_members(&building);
    for removed in [cut.clone(), charged_members(&building).union(&cut).copied().collect()] {
        let frame = idealise::idealise(&structure, &building, &removed).frame;
        assert!(frame.nodes.iter().all(|n| n.load[3..] == [0.0; 3]));
        assert!(frame.elements.iter().flat_map(|e| &e.loads).all(|l| l.torque_nm_m == 0.0));
    }
}

/// A state whose supports bear the weight elsewhere is told.
#[test]
fn what_is_borne_beside_its_centre_is_told() {
    let (_, demands) = states(&reference());
    let mut state = demands.after.unwrap();
    assert_eq!(state.warnings(), Vec::<String>::new());
    let StateSummary::Equilibrium { off_center, .. } = &mut state else { panic!("{state:?}") };
    assert!(*off_center < 1e-3, "{off_center}");
    *off_center = 0.06;
    let warnings = state.warnings();
    assert!(warnings.len() == 1 && warnings[0].contains("beside its centre, by 6 %"), "{warnings:?}");
}
