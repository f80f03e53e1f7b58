use super::*;
use crate::base::random::Random;

const E: f64 = 200e9;

fn bilinear() -> RebarLaw {
    RebarLaw::bilinear(E, 500e6, 0.01, 0.075)
}

fn plateau() -> RebarLaw {
    let hardening = Hardening::Plateau { start_strain: 0.012, ultimate_strength_pa: 620e6, exponent: 2.0 };
    RebarLaw { hardening, ultimate_strain: 0.10, ..RebarLaw::bilinear(E, 420e6, 0.0, 0.10) }
}

/// Bar buckling over ten diameters.
fn slender() -> RebarLaw {
    plateau().with_buckling(Buckling { slenderness: 10.0, alpha: 0.75 })
}

fn all() -> [RebarLaw; 4] {
    let stout = Buckling::between_ties(0.15, 0.02, &bilinear());
    [bilinear(), plateau(), slender(), bilinear().with_buckling(stout)]
}

fn close(got: f64, expected: f64, relative: f64) {
    assert!((got - expected).abs() <= relative * expected.abs(), "{got} for {expected}");
}

/// Walks through strains in steps of at most `step`; work per volume \[J/m³\] of the way.
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

/// Stress at the end of a way from the virgin bar.
fn end(law: &RebarLaw, strains: &[f64]) -> f64 {
    let mut state = RebarState::default();
    walk(law, &mut state, strains, 1e-5);
    state.stress_pa
}

#[test]
fn monotonic_branches_have_their_closed_forms() {
    for sign in [1.0, -1.0] {
        close(end(&bilinear(), &[sign * 0.002]), sign * 400e6, 1e-12);
        close(end(&bilinear(), &[sign * 0.0425]), sign * 580e6, 1e-12); // 500 + 2 GPa 0.04
        close(end(&plateau(), &[sign * 0.011]), sign * 420e6, 1e-12);
        // half way of the hardening: 620 - 200 / 4
        close(end(&plateau(), &[sign * 0.056]), sign * 570e6, 1e-12);
    }
    let cubic = Hardening::Plateau { start_strain: 0.012, ultimate_strength_pa: 620e6, exponent: 3.0 };
    close(end(&RebarLaw { hardening: cubic, ..plateau() }, &[0.056]), 595e6, 1e-12); // 620 - 200 / 8
}

#[test]
fn monotonic_way_does_not_depend_on_the_steps() {
    for law in all() {
        for goal in [0.001, 0.006, 0.03, -0.001, -0.006, -0.03, -0.09] {
            let mut states = [RebarState::default(); 3];
            let stresses: [f64; 3] = std::array::from_fn(|k| {
                walk(&law, &mut states[k], &[goal], [1.0, 1.3e-3, 1e-6][k]);
                states[k].stress_pa
            });
            assert!(stresses[0] != 0.0);
            close(stresses[1], stresses[0], 1e-12);
            close(stresses[2], stresses[0], 1e-12);
        }
    }
}

#[test]
fn reversal_begins_elastic_and_ends_on_the_asymptote() {
    let law = bilinear();
    let mut state = RebarState::default();
    walk(&law, &mut state, &[0.03], 1e-4);
    let top = state.stress_pa;
    walk(&law, &mut state, &[0.03 - 1e-5], 1e-5);
    close(state.stress_pa, top - E * 1e-5, 1e-3);
    // the bend: elastic line from the reversal and the line of hardening -500 + 2 GPa (ε + 0.0025); half way on the curve of Menegotto and Pinto
    let bend = 0.03 - (top + 500e6 - 2e9 * 0.0325) / (E - 2e9);
    let xi = (bend + 0.0025) / 0.0025;
    let r = 20.0 - 18.5 * xi / (0.15 + xi);
    walk(&law, &mut state, &[bend], 1e-5);
    let expected = top - E * (0.03 - bend) * (0.01 + 0.99 * 2f64.powf(-1.0 / r));
    close(state.stress_pa, expected, 1e-9);
    // Bauschinger: below the yield stress where a bar of isotropic hardening would be elastic
    assert!(state.stress_pa > -500e6 && state.stress_pa > top - E * (0.03 - bend) + 50e6);
    walk(&law, &mut state, &[-0.06], 1e-4);
    let line = -500e6 + 2e9 * (-0.06 + 0.0025);
    close(state.stress_pa, line, 0.01);
    assert!(state.stress_pa > line);
}

#[test]
fn flow_in_one_direction_ends_the_plateau_of_the_other() {
    let law = plateau();
    let top = law.monotonic_pa(0.02);
    let origin = 0.02 - top / E;
    // asymptote: the tangent where hardening begins, 2 · 200 MPa / 0.088, from the moved origin
    let slope = 400e6 / 0.088;
    let line = |strain: f64| -420e6 + slope * (strain - (origin - 0.012));
    let reach = (top - line(0.02)) / (E - slope);
    let xi = (0.02 - reach + 0.0021) / 0.0021;
    let r = 20.0 - 18.5 * xi / (0.15 + xi);
    let x = (0.02 - (origin - 0.004)) / reach;
    let ratio = slope / E;
    let shape = ratio * x + (1.0 - ratio) * x / (1.0 + x.powf(r)).powf(1.0 / r);
    close(end(&law, &[0.02, origin - 0.004]), top - E * reach * shape, 1e-9);
    // and the moved monotonic curve is the bound, reached at large strain
    let far = end(&law, &[0.02, origin - 0.07]);
    assert!(far >= -law.monotonic_pa(0.07));
    close(far, -law.monotonic_pa(0.07), 0.03);
}

#[test]
fn short_unloading_leaves_no_trace() {
    for law in [bilinear(), plateau()] {
        for way in [&[0.008][..], &[0.03], &[0.03, -0.01, 0.02], &[-0.02, 0.005]] {
            let last = way[way.len() - 1];
            let mut whole = way.to_vec();
            whole.push(last + 0.01);
            let mut broken = way.to_vec();
            broken.extend([last - 0.001, last - 0.0002, last - 0.0012, last + 0.01]);
            let (a, b) = (end(&law, &whole), end(&law, &broken));
            assert!(b <= a * (1.0 + 1e-12), "{way:?}: {b} above {a}");
            close(b, a, 5e-3);
        }
    }
}

#[test]
fn cycles_take_energy() {
    for law in all() {
        let mut random = Random::after(7);
        for _ in 0..300 {
            let corners: Vec<f64> = (0..6).map(|_| 0.07 * (random.share() - 0.5)).collect();
            let mut state = RebarState::default();
            let start = [0.04, corners[0]];
            let mut work = walk(&law, &mut state, &start, 2e-4);
            assert!(work > 0.0);
            // closed way in strain, repeated: the second round begins and ends alike
            let mut round = corners.clone();
            round.push(corners[0]);
            work += walk(&law, &mut state, &round, 2e-4);
            assert!(work > 0.0);
            let second = walk(&law, &mut state, &round, 2e-4);
            assert!(second > -1e-9 * work, "{corners:?}: {second}");
        }
        // a wide cycle takes most of its box
        let mut state = RebarState::default();
        walk(&law, &mut state, &[0.02, -0.02, 0.02], 1e-5);
        let taken = walk(&law, &mut state, &[-0.02, 0.02], 1e-5);
        let share = if law.buckling.is_some() { 0.35 } else { 0.7 };
        assert!(taken > share * 0.04 * 2.0 * law.yield_strength_pa, "{taken}");
    }
}

#[test]
fn rupture_is_final_in_one_pull_and_in_cycles() {
    for (law, way) in
        all().into_iter().flat_map(|law| [(law, &[0.0][..]), (law, &[0.03, -0.03, 0.02, -0.01])])
    {
        let mut state = RebarState::default();
        walk(&law, &mut state, way, 1e-4);
        walk(&law, &mut state, &[law.ultimate_strain - 1e-6], 1e-4);
        assert!(!state.ruptured && state.stress_pa > law.yield_strength_pa);
        assert_eq!(law.stress(&mut state, law.ultimate_strain), 0.0);
        assert_eq!((law.stress(&mut state, 0.0), law.stress(&mut state, -0.02)), (0.0, 0.0));
        assert!(state.ruptured);
    }
}

/// Points of the curve of Dhakal and Maekawa, worked by hand: f_y = 420 MPa, L / d_b = 10, α = 0.75: λ = 20.4939,
/// ε*/ε_y = 7.8640, σ_l(ε*) = 447.93 MPa, σ* = 0.75 · 0.77210 · 447.93 = 259.38 MPa.
#[test]
fn buckling_has_the_published_points() {
    let law = slender();
    let [strain, average, straight] = law.intermediate_point(law.buckling.unwrap());
    close(strain, 7.864_026 * 0.0021, 1e-5);
    let left: f64 = (0.1 - 7.864_026 * 0.0021) / 0.088;
    close(straight, 620e6 - 200e6 * left * left, 1e-6);
    close(average, 0.75 * 0.772_098 * straight, 1e-5);
    close(end(&law, &[-strain]), -average, 1e-9);
    close(end(&law, &[-0.0021]), -420e6, 1e-9);
    // half way to the intermediate point, on the plateau: 420 (1 - (1 - σ*/σ_l*) / 2)
    let half = 0.5 * (0.0021 + strain);
    close(end(&law, &[-half]), -420e6 * (0.5 + 0.5 * average / straight), 1e-9);
    close(end(&law, &[-strain - 0.02]), -(average - 0.02 * E * 0.02), 1e-9);
    close(end(&law, &[-0.09]), -84e6, 1e-9); // 0.2 f_y
    // limits: not before seven yield strains, not below 0.2 f_y
    let thin = plateau().with_buckling(Buckling { slenderness: 30.0, alpha: 0.75 });
    let [strain, average, _] = thin.intermediate_point(thin.buckling.unwrap());
    close(strain, 7.0 * 0.0021, 1e-12);
    assert!(average >= 0.2 * 420e6);
    let stout = plateau().with_buckling(Buckling { slenderness: 2.0, alpha: 1.0 });
    close(end(&stout, &[-0.03]), end(&plateau(), &[-0.03]), 1e-9); // never above the straight bar
}

#[test]
fn a_bar_pulled_before_buckles_from_its_new_length() {
    let law = slender();
    // free of stress at 0.03 - σ/E; the same shortening from there as from zero gives the same factor
    let origin = 0.03 - law.monotonic_pa(0.03) / E;
    let mut state = RebarState::default();
    walk(&law, &mut state, &[0.03, origin - 0.02], 1e-5);
    let factor = state.stress_pa / state.straight_pa;
    close(factor, law.compressed_pa(0.02) / law.monotonic_pa(0.02), 1e-9);
    // pulled straight again it has its tension
    walk(&law, &mut state, &[0.03], 1e-5);
    assert_eq!(state.stress_pa, state.straight_pa);
    assert!(state.stress_pa > 0.9 * law.monotonic_pa(0.03));
}

#[test]
fn a_bar_let_go_buckles_from_there_without_a_jump() {
    let law = slender();
    let mut state = RebarState { held: true, ..RebarState::default() };
    walk(&law, &mut state, &[-0.02], 1e-5);
    assert_eq!(state.stress_pa, state.straight_pa);
    let before = state.stress_pa;
    state.held = false;
    walk(&law, &mut state, &[-0.02 - 1e-9], 1e-9);
    assert!((state.stress_pa / before - 1.0).abs() < 1e-6, "{} {before}", state.stress_pa);
    // 0.01 further the factor is that of a bare bar at 0.01 beyond its yield
    walk(&law, &mut state, &[-0.03], 1e-5);
    let bare = 0.01 + law.yield_strain();
    close(state.stress_pa / state.straight_pa, law.compressed_pa(bare) / law.monotonic_pa(bare), 1e-9);
    // pulled far beyond, it is a bare bar of its new length
    walk(&law, &mut state, &[0.03], 1e-5);
    let free = 0.03 - state.straight_pa / E;
    walk(&law, &mut state, &[free - 0.02], 1e-5);
    close(state.stress_pa / state.straight_pa, law.compressed_pa(0.02) / law.monotonic_pa(0.02), 1e-9);
}

#[test]
fn bars_without_hardening_buckle_more() {
    let flat = RebarLaw::bilinear(E, 500e6, 0.0, 0.075);
    assert_eq!(Buckling::between_ties(0.15, 0.02, &flat), Buckling { slenderness: 7.5, alpha: 0.75 });
    assert_eq!(Buckling::between_ties(0.15, 0.02, &bilinear()).alpha, 1.0);
    assert!(plateau().hardens());
}

#[test]
fn rate_factors_of_malvar() {
    // f_y = 414 MPa: exponents 0.034 and 0.010; at 1 1/s 10^(4 · 0.034) = 1.3677 and 10^0.04 = 1.0965
    let law = RebarLaw { yield_strength_pa: 414e6, ..plateau() };
    let at = law.rate_factors(1.0);
    close(at.on_yield, 1.367_729, 1e-6);
    close(at.on_ultimate, 1.096_478, 1e-6);
    close(law.at_rate(1.0).yield_strength_pa, 414e6 * 1.367_729, 1e-6);
    close(law.at_rate(1.0).monotonic_pa(0.1), 620e6 * 1.096_478, 1e-6);
    // a straight line of hardening leads from the raised yield to the raised ultimate strength, 645 MPa at 0.075
    let straight = bilinear().at_rate(1.0);
    let at = bilinear().rate_factors(1.0);
    close(straight.monotonic_pa(straight.yield_strain()), 500e6 * at.on_yield, 1e-12);
    close(straight.monotonic_pa(0.075), 645e6 * at.on_ultimate, 1e-12);
    assert_eq!(bilinear().at_rate(1e-5), bilinear());
    assert_eq!(law.rate_factors(1e-9), RebarRate { on_yield: 1.0, on_ultimate: 1.0 });
    assert_eq!(law.rate_factors(1e6), law.rate_factors(225.0));
}

#[test]
fn state_and_law_survive_the_file() {
    let (law, mut state) = (slender(), RebarState::default());
    walk(&law, &mut state, &[0.03, -0.01, 0.004], 1e-4);
    let text = serde_json::to_string(&(law, state)).unwrap();
    let (law2, mut copy): (RebarLaw, RebarState) = serde_json::from_str(&text).unwrap();
    assert_eq!(law2.stress(&mut copy, -0.005).to_bits(), law.stress(&mut state, -0.005).to_bits());
}
