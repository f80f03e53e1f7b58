//! Slip of bars out of the joint, and what happens to single bars and ties, on a small coarse section.

use super::series::{SMALL, coarse};
use fallwerk::base::source::Source;
use fallwerk::rc::anchorage::{Anchorage, Ending};
use fallwerk::rc::bend::Bent;
use fallwerk::rc::events::{EventKind, in_words};
use fallwerk::rc::section_file::{EXAMPLE, read};
use fallwerk::rc::series::{self, Case};
use fallwerk::rc::{RcSection, SeriesOptions};

fn section(text: &str) -> RcSection {
    read(&Source::new("small.toml", text)).unwrap()
}

fn bent(section: &RcSection, share: f64, until_rad: f64) -> Case {
    let options = SeriesOptions { until_rad, ..coarse(&[share]) };
    series::run(section, &options, &|_, _| {}).unwrap().cases.remove(0)
}

#[test]
fn the_file_says_how_bars_are_held() {
    assert_eq!(section(EXAMPLE).anchorage, None);
    let slips = EXAMPLE.replace("kind = \"perfect\"", "kind = \"slip\"");
    assert_eq!(section(&slips).anchorage, Some(Anchorage::LONG));
    let hooked = slips
        .replace("# length = \"600 mm\"", "length = \"600 mm\"")
        .replace("# ending = \"straight\"", "ending = \"hook\"");
    let found = section(&hooked.replace("# bond_strength", "bond_strength")).anchorage.unwrap();
    let wanted =
        Anchorage { length_m: Some(0.6), ending: Ending::Hook, bond_pa: Some(6.2e6), ..Anchorage::LONG };
    assert_eq!(found, wanted);
    let wrong = slips.replace("# ending = \"straight\"", "ending = \"nail\"");
    let errors = read(&Source::new("small.toml", &wrong)).unwrap_err();
    assert!(format!("{errors:?}").contains("nail") && errors[0].place.is_some());
}

#[test]
fn bars_that_slip_add_rotation_and_short_ones_are_pulled_out() {
    let held = section(SMALL);
    let with = |length_m| {
        let anchorage = Some(Anchorage { length_m, ..Anchorage::LONG });
        bent(&RcSection { anchorage, ..held.clone() }, 0.0, 0.02)
    };
    let (full, slip, short) = (bent(&held, 0.0, 0.02), with(None), with(Some(0.06)));
    let figures = |c: &Case| c.figures.unwrap();
    let largest = |c: &Case| c.bent.as_ref().unwrap().slips_m.iter().copied().fold(0.0, f64::max);
    assert_eq!(largest(&full), 0.0);
    let at_half = |c: &Case| {
        let half = 0.6 * figures(&full).peak_nm;
        c.bent.as_ref().unwrap().points.iter().find(|p| p[1] > half).unwrap()[0]
    };
    assert!(at_half(&slip) > 1.05 * at_half(&full), "{} {}", at_half(&slip), at_half(&full));
    // forces across the member at the end of a slipping bar, of its elements and of its bending, act on the concrete there
    let balance = slip.bent.as_ref().unwrap().energies.residual_share;
    assert!(balance < 0.01, "{balance}");
    // some way beyond the closed form at yield: u = 5.48 MPa, 0.00125 · 319.5 mm
    assert!((4e-4..6e-3).contains(&largest(&slip)), "{}", largest(&slip));
    let events = &short.bent.as_ref().unwrap().events;
    let out = events.iter().find(|e| e.kind == EventKind::BarPullsOut).expect("60 mm hold 94 MPa");
    assert!(out.place_m[2] == 0.0 && out.rotation_rad > 0.0);
    assert!(figures(&short).peak_nm < 0.7 * figures(&full).peak_nm);
    assert!(in_words(events).iter().any(|w| w.starts_with("bars pull out from")), "{:?}", in_words(events));
    let far = slip.bent.as_ref().unwrap().events.iter().any(|e| e.kind == EventKind::BarPullsOut);
    assert!(!far);
}

#[test]
fn a_core_whose_ties_rupture_loses_strength() {
    // thin ties, yielding at 300 MPa: alike, but for the strain at which they rupture
    let (head, ties) = SMALL.split_once("[ties]").unwrap();
    let thin = ties.replace("8 mm", "4 mm").replace("500 MPa", "300 MPa");
    let options = SeriesOptions { until_rad: 0.015, mesh_size_m: 0.065, ..coarse(&[0.4]) };
    let of = |strain: f64| {
        let section = section(&format!("{head}[ties]{thin}ultimate_strain = {strain}\n"));
        series::run(&section, &options, &|_, _| {}).unwrap().cases.remove(0).bent.unwrap()
    };
    let (tough, brittle) = (of(0.1), of(0.005));
    let ruptures = |b: &Bent| b.events.iter().filter(|e| e.kind == EventKind::TieRuptures).count();
    assert_eq!(ruptures(&tough), 0);
    assert!(ruptures(&brittle) >= 2);
    let first = brittle.events.iter().find(|e| e.kind == EventKind::TieRuptures).unwrap();
    assert!(first.along < 2 && first.place_m[2] < 0.2, "{first:?}");
    let before = brittle.points.iter().take_while(|p| p[0] < first.rotation_rad - 5e-4).count();
    assert_eq!(brittle.points[..before], tough.points[..before]);
    let peak = |b: &Bent| b.points.iter().map(|p| p[1]).fold(0.0, f64::max);
    assert!(peak(&brittle) < 0.95 * peak(&tough), "{} {}", peak(&brittle), peak(&tough));
}
