//! Slip of an anchored bar against closed forms.

use crate::material::rebar::{Hardening, RebarLaw};
use crate::rc::anchorage::{Anchorage, EmbeddedBar, Ending, SlipState};
use crate::verify::{Case, Figure};

const SEZEN: &str = "Sezen, Setzler (2008), worked by hand";
const MODEL_CODE: &str = "fib Model Code 2010, table 6.1-1";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "anchorage-slip",
            "A bar of 20 mm, 500 MPa with linear hardening of 1 %, and one of 25 mm, 430 MPa with a plateau to 0.8 % and a parabola to 602 MPa at 10 %, pulled out of concrete \
             of 36 MPa by the law that the submodel uses: slip at which a stress is reached.",
            slip,
        ),
        Case::short(
            "anchorage-pull-out",
            "The bar of 20 mm with a straight length of 300 mm: largest stress, friction, and what is left half way out; with a hook after 200 mm: slip.",
            pull_out,
        ),
    ]
}

fn bar(length_m: Option<f64>, ending: Ending) -> EmbeddedBar {
    let steel = RebarLaw::bilinear(200e9, 500e6, 0.01, 0.075);
    Anchorage { length_m, ending, ..Anchorage::LONG }.of_bar(steel, 0.02, 36e6)
}

/// Slip \[m\] at which a virgin bar that is pulled reaches a stress.
fn slip_at(bar: &EmbeddedBar, stress_pa: f64) -> Result<f64, String> {
    let (law, mut state) = (bar.law(), SlipState::default());
    let step = 1e-7;
    for k in 1..1_000_000 {
        let before = state.stress_pa;
        let stress = law.stress_pa(&mut state, step * f64::from(k));
        if stress >= stress_pa {
            return Ok(step * (f64::from(k) - (stress - stress_pa) / (stress - before)));
        }
    }
    Err(format!("{stress_pa} Pa are not reached"))
}

fn slip() -> Result<Vec<Figure>, String> {
    let straight = bar(None, Ending::Straight);
    let hardening = Hardening::Plateau { start_strain: 0.008, ultimate_strength_pa: 602e6, exponent: 2.0 };
    let tough = RebarLaw { hardening, ..RebarLaw::bilinear(200e9, 430e6, 0.0, 0.1) };
    let thick = Anchorage::LONG.of_bar(tough, 0.025, 36e6);
    // u = 6 and 3 MPa. 20 mm: l_d = σ / 1.2 MPa mm, l_d' = (σ - 500) / 0.6 MPa mm; 25 mm: σ / 0.96, (σ - 430) / 0.48
    let rows = [
        ("20 mm, 100 MPa", &straight, 100e6, 0.5 * 0.0005 * 0.083_333),
        ("20 mm, 300 MPa", &straight, 300e6, 0.5 * 0.0015 * 0.25),
        ("20 mm, 500 MPa", &straight, 500e6, 0.5 * 0.0025 * 0.416_667),
        ("20 mm, 550 MPa", &straight, 550e6, 0.5 * 0.0025 * 0.416_667 + 0.015 * 0.083_333),
        ("20 mm, 620 MPa", &straight, 620e6, 0.5 * 0.0025 * 0.416_667 + 0.0325 * 0.2),
        ("25 mm, 430 MPa", &thick, 430e6, 0.5 * 0.002_15 * 0.447_917),
        // at 559 MPa half of the parabola is left: 0.1 - 0.092 · 0.5 = 0.054
        ("25 mm, 559 MPa", &thick, 559e6, 0.5 * 0.002_15 * 0.447_917 + 0.5 * (0.002_15 + 0.054) * 0.268_75),
    ];
    let figure = |(what, bar, stress, expected): (&str, &EmbeddedBar, f64, f64)| {
        Ok(Figure::relative(what, "m", [expected, slip_at(bar, stress)?], 1e-2, SEZEN))
    };
    rows.into_iter().map(figure).collect()
}

fn pull_out() -> Result<Vec<Figure>, String> {
    let short = bar(Some(0.3), Ending::Straight);
    let (law, mut state) = (short.law(), SlipState::default());
    let mut stresses = Vec::new();
    for k in 0..=4000 {
        stresses.push(law.stress_pa(&mut state, 1e-4 * f64::from(k)));
    }
    let largest = stresses.iter().fold(0.0, |a: f64, b| a.max(*b));
    // slip at the largest force 0.5 · 0.0018 · 300 = 0.27 mm, friction from 1 + 10 mm further; then with the length that is left
    let from = 0.011_27;
    let half = 0.4 * 360e6 * (0.3 - 0.155) / (0.3 - from);
    Ok(vec![
        Figure::relative("largest stress, 4 u l / d", "Pa", [360e6, largest], 1e-3, SEZEN),
        Figure::relative("friction after the ribs", "Pa", [144e6, stresses[113]], 1e-2, MODEL_CODE),
        Figure::relative("155 mm out", "Pa", [half, stresses[1550]], 1e-2, "friction over the length left"),
        Figure::absolute("350 mm out", "Pa", [0.0, stresses[3500]], 0.0, "the bar is out"),
        Figure::relative(
            "hook after 200 mm: slip at 400 MPa",
            "m",
            [0.5 * (0.002 + 0.0008) * 0.2, slip_at(&bar(Some(0.2), Ending::Hook), 400e6)?],
            1e-2,
            "the hook holds 160 MPa",
        ),
    ])
}
