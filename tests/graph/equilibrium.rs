//! Moments of dead loads and supports about the origin, and ratios of demand to capacity along columns that bear more and more.

use super::buildings::{add, empty, reference, support};
use fallwerk::building::{Building, MemberKind, read};
use fallwerk::graph::demand::{StateSummary, against_law};
use fallwerk::graph::frame::SectionForces;
use fallwerk::graph::paths::{charged_members, cut_members};
use fallwerk::graph::*;
use std::path::Path;

/// How far the supports' forces and moments put the centre of the weight from where it is \[m\].
pub fn off_m(building: &Building, structure: &Structure, state: &StateSummary, is_after: bool) -> f64 {
    let StateSummary::Equilibrium { reactions, .. } = state else { panic!("{state:?}") };
    let mut gone = cut_members(building);
    if is_after {
        gone.extend(charged_members(building));
    }
    let (mut weight, mut of_weight) = (0.0, [0.0; 2]);
    for member in structure.members().filter(|m| !gone.contains(&m.index)) {
        weight += member.mass.mass_kg;
        (0..2).for_each(|k| of_weight[k] += member.mass.mass_kg * member.mass.center_m[k]);
    }
    let (mut borne, mut of_borne) = (0.0, [0.0; 2]);
    for (id, [_, _, force, about_x, about_y, _]) in reactions {
        let [x, y, _] = structure.end(id).unwrap().point_m;
        borne += force;
        of_borne[0] += force * x - about_y;
        of_borne[1] += force * y + about_x;
    }
    (0..2).map(|k| (of_weight[k] / weight - of_borne[k] / borne).powi(2)).sum::<f64>().sqrt()
}

/// A building's structure and demands.
pub fn states(building: &Building) -> (Structure, Demands) {
    let structure = Structure::of(building);
    let demands = demands(&structure, building);
    (structure, demands)
}

/// Four columns under beams of two depths, of which two are removed: what is left hangs on the clamps of the other two. A diaphragm that ties horizontal motions at two heights kept it from tilting.
#[test]
fn floors_with_beams_of_different_depth_keep_their_moments() {
    let mut building = reference();
    let deep: Vec<String> = building
        .members
        .iter()
        .filter(|m| m.kind == MemberKind::Beam && m.axis == 0)
        .map(|m| m.id.clone())
        .collect();
    assert!(!deep.is_empty());
    for member in building.members.iter_mut().filter(|m| deep.contains(&m.id)) {
        member.solid.min[2] -= 0.3;
    }
    let (structure, demands) = states(&building);
    let [before, after] = [(&demands.before, false), (demands.after.as_ref().unwrap(), true)]
        .map(|(state, is_after)| off_m(&building, &structure, state, is_after));
    assert!(before < 0.02 && after < 0.02, "{before} {after}");
}

/// Buildings of the plan whose floors have beams of several depths were off by up to 9 m, plans that are no rectangles, whose slabs end at faces of columns, by up to 1 m. What is left is the torsion that slabs give to beams at their edges.
#[test]
fn buildings_of_the_plan_keep_their_moments() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("kb");
    for (file, within) in [
        ("plan/s1-018", 1e-6),
        ("plan/s1-109", 1e-6),
        ("plan/s1-146", 1e-6),
        ("irregular/i1-007", 0.15),
        ("irregular/i1-018", 0.15),
        ("irregular/i1-033", 0.15),
    ] {
        let building = read(&root.join(format!("{file}.toml"))).unwrap();
        let (structure, demands) = states(&building);
        for (state, is_after) in [(Some(&demands.before), false), (demands.after.as_ref(), true)] {
            if let Some(state @ StateSummary::Equilibrium { .. }) = state {
                let off = off_m(&building, &structure, state, is_after);
                assert!(off < within, "{file}, after: {is_after}: {off}");
            }
        }
    }
}

/// Columns that dead load is too much for are told, whatever is charged.
#[test]
fn columns_that_bear_too_much_before_any_charge_are_told() {
    let mut building = reference();
    let (_, demands) = states(&building);
    assert_eq!(demands.warnings(&building), Vec::<String>::new());
    for law in building.materials.values_mut() {
        if let fallwerk::building::Material::Homogenised(law) = law {
            law.hardening.iter_mut().for_each(|point| point.stress_pa *= 0.02);
        }
    }
    let (_, demands) = states(&building);
    let warnings = demands.warnings(&building);
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(
        warning.contains(" of 12 columns bear more than the homogenised law can under dead load"),
        "{warning}"
    );
}

/// Demands that grow along a ray grow in proportion, through the force at which the section bears no moment any more, and beside it.
#[test]
fn a_ratio_is_by_how_much_a_demand_may_grow() {
    let mut building = empty();
    add(&mut building, "C", MemberKind::Column, [0.0; 3], [0.4, 0.4, 3.5]);
    support(&mut building, "C");
    let structure = Structure::of(&building);
    let end = structure.end("C.bottom").unwrap();
    let law = building.law_of(&building.members[0]);
    let squash_n = 0.16 * law.hardening[0].stress_pa;
    let ratio = |share: f64, moment_nm: [f64; 2]| {
        let forces = SectionForces {
            axial_n: share * squash_n,
            moment_nm: moment_nm.map(|m| share * m),
            ..SectionForces::default()
        };
        against_law(&building, end, &forces).ratio
    };
    for moment_nm in [[0.0, 0.0], [1e3, 0.0], [2e4, 0.0], [3e4, 5e4]] {
        let at_squash = ratio(1.0, moment_nm);
        assert!((1.0..2.0).contains(&at_squash), "{moment_nm:?}: {at_squash}");
        for share in [0.2, 0.9, 0.998, 1.05, 3.0] {
            let found = ratio(share, moment_nm) / (share * at_squash) - 1.0;
            assert!(found.abs() < 1e-6, "{moment_nm:?}, {share}: {found:e}");
        }
    }
    // without axial force the plastic moment of the rectangle
    let plastic = 0.25 * law.hardening[0].stress_pa * 0.4_f64.powi(3);
    let forces = SectionForces { moment_nm: [0.5 * plastic, 0.0], ..SectionForces::default() };
    assert!((against_law(&building, end, &forces).ratio - 0.5).abs() < 1e-6);
}
