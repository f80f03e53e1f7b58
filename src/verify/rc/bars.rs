//! The reinforcing bar against closed forms and published points.

use crate::base::random::Random;
use crate::material::rebar::{Buckling, Hardening, RebarLaw, RebarState};
use crate::verify::{Case, Figure};

const E: f64 = 200e9;
const FORM: &str = "closed form";
const DHAKAL: &str = "Dhakal, Maekawa (2002), worked by hand";

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "bar-monotonic",
            "Two bars pulled: 500 MPa with linear hardening of 1 % (rupture at 7.5 %), and 420 MPa with a plateau to 1.2 % and a parabola to 620 MPa at 10 %.",
            monotonic,
        ),
        Case::short(
            "bar-cycles",
            "The same bars in cycles between ± 2 %: slope after a reversal, Menegotto and Pinto's curve at its bend, energy of a cycle over the box around it; and 300 \
             random closed cycles, none of which gives energy.",
            cycles,
        ),
        Case::short(
            "bar-buckling",
            "The bar with a plateau, ties ten diameters apart, α = 0.75: λ = 20.4939, ε*/ε_y = 7.8640, σ_l(ε*) = 440.00 MPa.",
            buckling,
        ),
        Case::short("bar-rate", "A bar of 414 MPa: factors on yield and ultimate strength.", rate),
    ]
}

fn bilinear() -> RebarLaw {
    RebarLaw::bilinear(E, 500e6, 0.01, 0.075)
}

fn plateau() -> RebarLaw {
    let hardening = Hardening::Plateau { start_strain: 0.012, ultimate_strength_pa: 620e6, exponent: 2.0 };
    RebarLaw { hardening, ultimate_strain: 0.10, ..RebarLaw::bilinear(E, 420e6, 0.0, 0.10) }
}

fn slender() -> RebarLaw {
    plateau().with_buckling(Buckling { slenderness: 10.0, alpha: 0.75 })
}

/// Walks through strains; work per volume \[J/m³\].
fn walk(law: &RebarLaw, state: &mut RebarState, strains: &[f64], step: f64) -> f64 {
    let mut work = 0.0;
    for end in strains {
        let begin = state.strain;
        let count = ((end - begin).abs() / step).ceil().max(1.0) as usize;
        for k in 1..=count {
            let (old, from) = (state.stress_pa, state.strain);
            let stress = law.stress(state, begin + (end - begin) * k as f64 / count as f64);
            work += 0.5 * (old + stress) * (state.strain - from);
        }
    }
    work
}

/// Stress \[Pa\] at the end of a way of the virgin bar.
fn end(law: &RebarLaw, strains: &[f64]) -> f64 {
    let mut state = RebarState::default();
    walk(law, &mut state, strains, 1e-5);
    state.stress_pa
}

fn monotonic() -> Result<Vec<Figure>, String> {
    let row = |what: &str, values: [f64; 2]| Figure::relative(what, "Pa", values, 1e-9, FORM);
    let torn = |law: RebarLaw| end(&law, &[law.ultimate_strain - 1e-9, law.ultimate_strain]);
    Ok(vec![
        row("linear hardening, elastic at 0.2 %", [400e6, end(&bilinear(), &[0.002])]),
        row("linear hardening, at 4.25 %", [580e6, end(&bilinear(), &[0.0425])]),
        row("linear hardening, at -4.25 %", [-580e6, end(&bilinear(), &[-0.0425])]),
        row("plateau, at 1.1 %", [420e6, end(&plateau(), &[0.011])]),
        row("parabola, at 5.6 %", [570e6, end(&plateau(), &[0.056])]),
        Figure::absolute("linear hardening, ruptured at 7.5 %", "Pa", [0.0, torn(bilinear())], 0.0, FORM),
        Figure::absolute("parabola, ruptured at 10 %", "Pa", [0.0, torn(plateau())], 0.0, FORM),
    ])
}

/// Least work of a closed cycle of random corners gone round before, over the work so far.
fn least_gain(law: &RebarLaw) -> f64 {
    let mut random = Random::after(7);
    let mut least: f64 = 0.0;
    for _ in 0..300 {
        let corners: Vec<f64> = (0..6).map(|_| 0.07 * (random.share() - 0.5)).collect();
        let mut state = RebarState::default();
        let mut round = corners.clone();
        round.push(corners[0]);
        let work = walk(law, &mut state, &[0.04, corners[0]], 2e-4) + walk(law, &mut state, &round, 2e-4);
        least = least.min(walk(law, &mut state, &round, 2e-4) / work);
    }
    least
}

fn cycles() -> Result<Vec<Figure>, String> {
    let law = bilinear();
    let mut state = RebarState::default();
    walk(&law, &mut state, &[0.03], 1e-4);
    let top = state.stress_pa;
    walk(&law, &mut state, &[0.03 - 1e-5], 1e-5);
    let slope = (top - state.stress_pa) / 1e-5;
    // the bend: the elastic line from the reversal meets -500 MPa + 2 GPa (ε + 0.0025)
    let bend = 0.03 - (top + 500e6 - 2e9 * 0.0325) / (E - 2e9);
    let xi = (bend + 0.0025) / 0.0025;
    let exponent = 20.0 - 18.5 * xi / (0.15 + xi);
    walk(&law, &mut state, &[bend], 1e-5);
    let expected = top - E * (0.03 - bend) * (0.01 + 0.99 * libm::pow(2.0, -1.0 / exponent));
    let mut figures = vec![
        Figure::relative("slope after a reversal at 3 %", "Pa", [E, slope], 1e-3, "E"),
        Figure::relative(
            "stress at the bend",
            "Pa",
            [expected, state.stress_pa],
            1e-9,
            "Menegotto, Pinto (1973); Filippou et al. (1983)",
        ),
    ];
    for (name, law, share) in [
        ("linear hardening", bilinear(), 0.85),
        ("plateau", plateau(), 0.85),
        ("plateau, buckling", slender(), 0.5),
    ] {
        let mut state = RebarState::default();
        walk(&law, &mut state, &[0.02, -0.02, 0.02], 1e-5);
        let taken = walk(&law, &mut state, &[-0.02, 0.02], 1e-5);
        let of_box = taken / (0.04 * 2.0 * law.yield_strength_pa);
        let source = "rough: a rounded parallelogram, or half of it where the bar buckles";
        figures.push(Figure::absolute(
            format!("{name}: energy over 2 f_y Δε"),
            "-",
            [share, of_box],
            0.2,
            source,
        ));
        let gain = format!("{name}: least work of a closed cycle, of the work before");
        figures.push(Figure::absolute(gain, "-", [0.0, least_gain(&law)], 1e-9, "second law"));
    }
    Ok(figures)
}

fn buckling() -> Result<Vec<Figure>, String> {
    let (law, yielded) = (slender(), 0.0021);
    let strain = 7.864_026 * yielded;
    let rest = (0.1 - strain) / 0.088;
    let average = 0.75 * 0.772_098 * (620e6 - 200e6 * rest * rest);
    let half = 0.5 * (yielded + strain);
    let row = |what: &str, values: [f64; 2]| Figure::relative(what, "Pa", values, 1e-4, DHAKAL);
    // a bar pulled to 3 % first, then shortened by 2 % from where it became free of stress
    let origin = 0.03 - law.monotonic_pa(0.03) / E;
    let mut state = RebarState::default();
    walk(&law, &mut state, &[0.03, origin - 0.02], 1e-5);
    let factor = state.stress_pa / state.straight_pa;
    let expected = law.compressed_pa(0.02) / law.monotonic_pa(0.02);
    Ok(vec![
        row("at yield", [-420e6, end(&law, &[-yielded])]),
        row("half way to the intermediate point", [-420e6 * (0.5 + 0.375 * 0.772_098), end(&law, &[-half])]),
        row("at the intermediate point", [-average, end(&law, &[-strain])]),
        row("2 % beyond: down with 0.02 E", [-(average - 80e6), end(&law, &[-strain - 0.02])]),
        row("at 9 %: a fifth of the yield strength", [-84e6, end(&law, &[-0.09])]),
        Figure::relative(
            "pulled to 3 % before: average over straight stress",
            "-",
            [expected, factor],
            1e-9,
            "as from the virgin bar",
        ),
    ])
}

fn rate() -> Result<Vec<Figure>, String> {
    let law = RebarLaw { yield_strength_pa: 414e6, ..plateau() };
    let at = law.rate_factors(1.0);
    let source = "Malvar (1998): 10^(4 · 0.034), 10^(4 · 0.010)";
    Ok(vec![
        Figure::relative("yield strength at 1 1/s", "-", [1.367_729, at.on_yield], 1e-6, source),
        Figure::relative("ultimate strength at 1 1/s", "-", [1.096_478, at.on_ultimate], 1e-6, source),
        Figure::relative(
            "stress at 10 %, 1 1/s",
            "Pa",
            [620e6 * 1.096_478, law.at_rate(1.0).monotonic_pa(0.1)],
            1e-6,
            source,
        ),
    ])
}
