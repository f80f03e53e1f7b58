//! Cyclic bends of a small coarse section: their path, their energies, and what ends them.

use super::series::{coarse, small};
use fallwerk::rc::bend::{Bend, Bent, Ending, bend};
use fallwerk::rc::drive::cycles;
use fallwerk::rc::member::{Joint, RcMember};
use fallwerk::rc::{RcSection, SeriesOptions, series};

fn member(section: &RcSection) -> RcMember {
    RcMember::new(&section.input, &section.concrete, Joint::Symmetry, section.length_m, 0.1).unwrap()
}

fn bent(axial_share: f64, turns_rad: &[f64]) -> Bent {
    let section = small();
    let load = Bend {
        axial_n: section.axial_n(axial_share),
        direction_deg: 90.0,
        turns_rad: turns_rad.to_vec(),
        pace: 1.0,
    };
    bend(&member(&section), &load, false, &|_| {}).unwrap()
}

/// A member of 30 depths first swings about rest: at 1 mrad it is bent back by its own mass, which is no failure.
#[test]
fn a_slender_member_does_not_break_off_while_it_swings() {
    let section = RcSection { length_m: 6.0, ..small() };
    let half =
        RcMember::half(&section.input, &section.concrete, Joint::Symmetry, [section.length_m, 0.1], 90.0)
            .unwrap();
    let found = bend(&half, &Bend::monotonic(0.0, 90.0, 0.02), false, &|_| {}).unwrap();
    assert_eq!(found.ending, Ending::Path);
    assert!(found.points.iter().any(|p| p[0] > 1e-3 && p[0] < 2e-3 && p[1] < 0.0), "it swings");
    assert!(found.points.iter().any(|p| p[1] > 3e3), "it bears");
}

#[test]
fn a_path_that_turns_is_a_monotonic_push_until_it_slows_down() {
    let push = bent(0.2, &[0.008]);
    let turned = bent(0.2, &[0.012, 0.011]);
    // full speed until 0.06 s before the turn: 0.0057 rad
    let common = push.points.iter().take_while(|p| p[0] < 0.006).count();
    assert!(common > 20);
    assert_eq!(push.points[..common], turned.points[..common]);
    assert_eq!(turned.turned_at.len(), 1);
    let turn = turned.points[turned.turned_at[0] - 1][0];
    // the last point is the mean over an interval of 0.5 mrad at most
    assert!((turn - 0.012).abs() < 2.5e-4, "{turn}");
    // slower, the moment is the same but for vibrations
    let at = |points: &[[f64; 3]]| {
        let near: Vec<f64> = points.iter().filter(|p| (p[0] - 0.0105).abs() < 1e-3).map(|p| p[1]).collect();
        near.iter().sum::<f64>() / near.len() as f64
    };
    let long = bent(0.2, &[0.014]);
    let [a, b] = [at(&long.points), at(&turned.points[..turned.turned_at[0]])];
    assert!((a / b - 1.0).abs() < 0.03, "{a} {b}");
}

#[test]
fn cycles_balance_their_energies_and_are_alike_in_both_senses() {
    // half of this coarse mesh has one element across: the senses would differ by 20 %
    let turns_rad = cycles(&[0.005, 0.015], 1);
    let options = SeriesOptions { turns_rad, fit_rule: true, whole: true, ..coarse(&[0.2]) };
    let section = small();
    let series = series::run(&section, &options, &|_, _| {}).unwrap();
    let case = &series.cases[0];
    let (bent, h) = (case.bent.as_ref().unwrap(), case.hysteresis.as_ref().unwrap());
    assert_eq!((bent.ending, h.cycles.len()), (Ending::Path, 2));
    let e = bent.energies;
    assert!(e.residual_share < 0.01 && bent.kinetic_share < 0.01, "{e:?}");
    assert!((e.external_j - e.damped_j - e.internal_j - e.kinetic_j).abs() < 0.01 * e.internal_j, "{e:?}");
    // moment over rotation and axial force over shortening, from the reactions, are the work of the stresses in the bending
    let by_reactions: f64 = h.excursions.iter().map(|x| x.energy_j + x.axial_work_j).sum();
    assert!((by_reactions / e.internal_j - 1.0).abs() < 0.1, "{by_reactions} {e:?}");
    for (cycle, wanted) in h.cycles.iter().zip([0.005, 0.015]) {
        let [plus, minus] = cycle.amplitude_rad;
        assert!((plus / wanted - 1.0).abs() < 0.01 && (minus / wanted + 1.0).abs() < 0.01, "{cycle:?}");
        assert!((cycle.peak_nm[0] / -cycle.peak_nm[1] - 1.0).abs() < 0.12, "{cycle:?}");
        assert!(cycle.energy_j > 0.0 && cycle.secant_nm_rad > 0.0);
        assert!(cycle.unloading_nm_rad.iter().all(|k| k.unwrap() > cycle.secant_nm_rad));
    }
    assert!(h.cycles[1].energy_j > 3.0 * h.cycles[0].energy_j);
    assert!(h.cycles[1].secant_nm_rad < h.cycles[0].secant_nm_rad);
    let curve = case.curve.as_ref().unwrap().as_ref().unwrap();
    let rule = curve.cyclic.unwrap();
    curve.check().unwrap();
    assert!(rule.fit.unwrap().strength_residual < 0.2, "{rule:?}");
}

#[test]
fn loss_of_the_axial_force_is_a_diagnosis() {
    let lost = bent(0.9, &[0.1]);
    assert!(matches!(lost.ending, Ending::Axial { .. }) && lost.failed(), "{:?}", lost.ending);
    let words = lost.ending.to_string();
    assert!(words.starts_with("axial failure at drift") && words.contains("mm"), "{words}");
    assert!(lost.points.last().unwrap()[0] < 0.1);
}
