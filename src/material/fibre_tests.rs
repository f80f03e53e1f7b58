use super::*;
use crate::material::fibre_response::{
    Milestones, chord_rotation, curve_of, fall_to, hinge_length_m, largest, secant_yield,
};

const HALF_TURN: f64 = std::f64::consts::PI;
const QUARTER_TURN: f64 = 0.5 * HALF_TURN;

fn near(what: &str, got: f64, expected: f64, relative: f64) {
    assert!((got / expected - 1.0).abs() <= relative, "{what}: {got} for {expected}");
}

/// Points under a share of the concrete's strength over the gross area.
fn points(input: &SectionInput, law: ConcreteLaw, share: f64, limit_1_m: f64) -> Vec<CurvaturePoint> {
    let force = share * input.concrete_strength_pa * input.area_m2();
    FibreSection::of(input, law).moment_curvature(force, 0.0, &FibreSection::curvatures_to(limit_1_m))
}

/// As [`points`], and what the curve says.
fn milestones(input: &SectionInput, law: ConcreteLaw, share: f64, limit_1_m: f64) -> Milestones {
    Milestones::of(input, &points(input, law, share, limit_1_m)).unwrap()
}

/// Curvature and moment at a strain of the compressed edge, from the two points before: behind it concrete may be gone.
fn at_strain(points: &[CurvaturePoint], strain: f64) -> [f64; 2] {
    let k = points.iter().position(|p| p.compressed_strain >= strain).unwrap();
    let (a, b) = (points[k - 2], points[k - 1]);
    let share = (strain - a.compressed_strain) / (b.compressed_strain - a.compressed_strain);
    [
        a.curvature_1_m + share * (b.curvature_1_m - a.curvature_1_m),
        a.moment_nm + share * (b.moment_nm - a.moment_nm),
    ]
}

#[test]
fn confinement_of_three_columns() {
    // k_e, f_l, f_cc, ε_cc, ε_cu, to the digits worked out apart from this program
    let cases = [
        (s1(), [0.326, 0.314e6, 32.13e6, 0.00271, 0.01239]),
        (s2(), [0.199, 0.112e6, 25.77e6, 0.00231, 0.0101]),
        (s4(), [0.727, 2.624e6, 55.78e6, 0.00595, 0.02213]),
    ];
    for (input, expected) in cases {
        let c = Confinement::of(&input).unwrap();
        let got = [c.effectiveness, c.pressure_pa, c.strength_pa, c.strain, c.ultimate_strain];
        for (got, expected) in got.into_iter().zip(expected) {
            near("confinement", got, expected, 4e-3);
        }
    }
    let bare = SectionInput { ties: None, ..s1() };
    assert_eq!(Confinement::of(&bare), None);
    let [core, cover] = ConcreteCurve::pair(ConcreteLaw::Mander, &bare);
    assert_eq!(core, cover);
}

#[test]
fn concrete_curves_have_their_points() {
    let [core, cover] = ConcreteCurve::pair(ConcreteLaw::Mander, &s1());
    near("peak of the core", core.stress_pa(0.0027094), 32.128e6, 1e-4);
    near("peak of the cover", cover.stress_pa(0.002), 30e6, 1e-12);
    near("initial slope", cover.stress_pa(1e-9), 27.386e9 * 1e-9, 1e-4);
    assert_eq!([cover.stress_pa(0.00501), core.stress_pa(0.0124), cover.stress_pa(-1e-5)], [0.0; 3]);
    let [core, cover] = ConcreteCurve::pair(ConcreteLaw::KentPark, &s1());
    near("K f_c", core.stress_pa(0.002 * 1.0642), 1.0642 * 30e6, 1e-4);
    near("fifth of the core", core.stress_pa(0.01135), 0.2 * 1.0642 * 30e6, 2e-3);
    near("fifth of the cover", cover.stress_pa(0.00439), 6e6, 2e-3);
    near("rest", cover.stress_pa(0.02), 6e6, 1e-12);
    // tension: 2.896 MPa at 2.896 / 30000, gone eleven times as far
    near("tension", cover.stress_pa(-2.896 / 30e3), -2.896e6, 1e-9);
    near("softened tension", cover.stress_pa(-6.0 * 2.896 / 30e3), -0.5 * 2.896e6, 1e-9);
    assert_eq!(cover.stress_pa(-11.1 * 2.896 / 30e3), 0.0);
}

/// A strip solver of another author in another language (bars without memory, displaced concrete deducted). Moments at cracking, first yield, ε_c = 0.003 and the peak
/// \[kN m\], ideal yield curvature and curvature at 80 % \[1/m\]; interpolated on its curves.
#[test]
fn moment_curvature_of_an_independent_strip_solver() {
    let mander = [
        ("S1", 0.1, [52.45, 236.06, 278.73, 284.96, 0.01296, 0.13264]),
        ("S1", 0.3, [121.64, 292.86, 347.16, 352.80, 0.01245, 0.064595]),
        ("S1", 0.6, [201.50, 262.45, 330.91, 342.44, 0.00791, 0.024633]),
        ("S2", 0.0, [1.47, 48.36, 53.59, 59.71, 0.01376, 0.33022]),
        ("S2", 0.1, [18.29, 72.91, 77.31, 78.57, 0.01522, 0.2254]),
        ("S2", 0.3, [42.53, 99.22, 113.31, 114.78, 0.01654, 0.060493]),
        ("S2", 0.6, [69.12, 89.57, 109.17, 110.16, 0.01015, 0.024838]),
    ];
    for (name, share, expected) in mander {
        let input = if name == "S1" { s1() } else { s2() };
        let m = milestones(&input, ConcreteLaw::Mander, share, 0.4);
        let moments = [m.cracking.unwrap()[1], m.first_yield.unwrap()[1], m.ideal.unwrap()[1], m.peak[1]];
        for (got, kilo) in moments.into_iter().zip(expected) {
            near(&format!("{name} {share} moment"), got / 1e3, kilo, 5e-3);
        }
        near("ideal yield curvature", m.ideal_yield_curvature_1_m.unwrap(), expected[4], 5e-3);
        // both curves go in steps of 1.5 and 1.8 %: the rupture of a bar falls within one
        near(&format!("{name} {share} 80 %"), m.at_80.unwrap()[0], expected[5], 2e-2);
    }
    let kent_park = [
        ("S1", 0.0, [214.57, 235.80]),
        ("S1", 0.1, [276.15, 276.26]),
        ("S1", 0.3, [341.13, 342.28]),
        ("S1", 0.6, [317.93, 318.77]),
        ("S2", 0.1, [76.80, 76.80]),
        ("S2", 0.3, [111.92, 111.93]),
        ("S2", 0.6, [104.26, 104.42]),
    ];
    for (name, share, expected) in kent_park {
        let input = if name == "S1" { s1() } else { s2() };
        let m = milestones(&input, ConcreteLaw::KentPark, share, 0.4);
        near("Kent-Park, 0.003", m.ideal.unwrap()[1] / 1e3, expected[0], 2e-3);
        near("Kent-Park, peak", m.peak[1] / 1e3, expected[1], 2e-3);
    }
}

/// Parabola and rectangle at ε_cu2: moment \[kN m\] of the strip solver and of concreteproperties 0.7.0, curvature \[1/m\].
#[test]
fn ultimate_moments_of_two_other_programs() {
    let cases = [
        ("S1", 0.0, [219.34, 219.17], 0.0567),
        ("S1", 0.1, [282.90, 282.80], 0.0370),
        ("S1", 0.3, [355.73, 355.52], 0.0218),
        ("S1", 0.6, [339.81, 339.59], 0.0132),
        ("S2", 0.0, [54.36, 54.32], 0.0993),
        ("S2", 0.1, [78.08, 78.08], 0.0628),
        ("S2", 0.3, [115.65, 115.63], 0.0307),
        ("S2", 0.6, [112.43, 112.12], 0.0174),
    ];
    for (name, share, moments, curvature) in cases {
        let input = if name == "S1" { s1() } else { s2() };
        let at = at_strain(&points(&input, ConcreteLaw::ParabolaRectangle, share, 0.15), 0.0035);
        near(&format!("{name} {share}"), at[1] / 1e3, moments[0], 4e-3);
        near(&format!("{name} {share}"), at[1] / 1e3, moments[1], 4e-3);
        near("curvature", at[0], curvature, 2e-2);
    }
}

/// Under 45 degrees: concreteproperties 0.7.0, components of 212.926 kN m about both axes at N = 1440 kN.
#[test]
fn skew_bending_of_another_program() {
    let curvatures: Vec<f64> = (0..60).map(|k| 0.0005 * f64::from(k)).collect();
    let section = FibreSection::of(&s1(), ConcreteLaw::ParabolaRectangle);
    let points = section.moment_curvature(1440e3, 0.5 * QUARTER_TURN, &curvatures);
    near("skew", at_strain(&points, 0.0035)[1] / 1e3, 212.926 * 2f64.sqrt(), 5e-3);
}

/// OpenSees 3.7.1 (`Concrete04`, `Steel01`, `forceBeamColumn` with `HingeRadau`, cantilever of 1.75 m): bars displace nothing and remember. Peak moment \[kN m\],
/// curvature at 80 % \[1/m\], yield rotation, rotation at 80 %.
#[test]
fn chord_rotation_of_opensees() {
    let cases = [
        ("S1", 0.0, [239.6, 0.2898, 0.0085, 0.1060]),
        ("S1", 0.1, [286.3, 0.1550, 0.0064, 0.0577]),
        ("S1", 0.3, [356.2, 0.0658, 0.0054, 0.0250]),
        ("S1", 0.6, [349.4, 0.0260, 0.0042, 0.0106]),
        ("S2", 0.0, [59.8, 0.3349, 0.0089, 0.1099]),
        ("S2", 0.1, [78.9, 0.2472, 0.0066, 0.0802]),
        ("S2", 0.3, [115.4, 0.0624, 0.0062, 0.0214]),
        ("S2", 0.6, [111.7, 0.0251, 0.0048, 0.0097]),
    ];
    for (name, share, expected) in cases {
        let base = if name == "S1" { s1() } else { s2() };
        let options = FibreOptions { deduct_bars: false, history: true };
        let input = SectionInput { options, ..base };
        let hinge = hinge_length_m(1.75, 500e6, input.bars[0].diameter_m);
        near("hinge", hinge, if name == "S1" { 0.360 } else { 0.316 }, 1e-9);
        let points = points(&input, ConcreteLaw::Mander, share, 0.4);
        let rotation = chord_rotation(&curve_of(&points), 1.75, hinge);
        let say = |what: &str| format!("{name} {share} {what}");
        near(&say("peak"), largest(&rotation).unwrap()[1] / 1e3, expected[0], 6e-3);
        near(&say("curvature"), fall_to(&curve_of(&points), 0.8).unwrap()[0], expected[1], 3e-2);
        near(&say("yield"), secant_yield(&rotation).unwrap(), expected[2], 6e-2);
        near(&say("rotation"), fall_to(&rotation, 0.8).unwrap()[0], expected[3], 3e-2);
    }
}

#[test]
fn elastic_and_hinged_cantilevers_are_exact() {
    for hinge in [0.1, 0.36, 0.437] {
        // straight to 0.01 1/m, then a hinge alone
        let rotation = chord_rotation(&[[0.0, 0.0], [0.01, 1e5], [0.05, 1e5]], 1.75, hinge);
        near("elastic", rotation[1][0], 0.01 * 1.75 / 3.0, 1e-12);
        near("hinged", rotation[2][0], 0.01 * 1.75 / 3.0 + 0.04 * hinge, 1e-12);
    }
    // a long hinge: plastic part exact, elastic part as if the curvature of the base held over the hinge
    let rotation = chord_rotation(&[[0.0, 0.0], [0.01, 1e5], [0.05, 1e5]], 1.0, 0.3);
    near("elastic", rotation[1][0], 0.01 * (0.3 + 0.7f64.powi(3) / 3.0), 1e-12);
    near("plastic", rotation[2][0] - rotation[1][0], 0.04 * 0.3, 1e-12);
}

/// Four corner bars, of which the upper ones stand somewhat further inside, or are not there: Mander's arches by hand.
#[test]
fn arches_span_from_bar_to_bar_on_all_faces() {
    let effectiveness = |upper: &[f64]| {
        let lower = [-0.16, 0.16].map(|x| [x, -0.16]);
        let places = lower.into_iter().chain(upper.iter().map(|x| [*x, 0.16]));
        let bars: Vec<Bar> = places.map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.02 }).collect();
        let steel = bars.len() as f64 * 1e-4 * HALF_TURN;
        let found = Confinement::of(&SectionInput { bars, ..s1() }).unwrap();
        found.effectiveness * (1.0 - steel / (0.348 * 0.348))
    };
    let between = (1.0 - 0.5 * (0.15 - 0.008) / 0.348_f64).powi(2);
    let of =
        |gaps: [f64; 4]| between * (1.0 - gaps.iter().map(|g| g * g).sum::<f64>() / (6.0 * 0.348 * 0.348));
    near("corners", effectiveness(&[-0.16, 0.16]), of([0.3; 4]), 1e-12);
    near("inset", effectiveness(&[-0.145, 0.145]), of([0.3, 0.3, 0.3, 0.27]), 1e-12);
    near(
        "far inset",
        effectiveness(&[-0.12, 0.12]),
        of([0.3, 0.3, 0.3, (0.22_f64.powi(2) + 2.0 * 0.044_f64.powi(2)).sqrt()]),
        1e-12,
    );
    // from the lower bars to the upper end of the core, and all of its upper face
    near("none", effectiveness(&[]), of([0.3, 0.324, 0.324, 0.348]), 1e-12);
}

#[test]
fn directions_turn_with_the_section() {
    let mut bars: Vec<Bar> =
        [-0.11, 0.0, 0.11].iter().map(|x| Bar { x_m: *x, y_m: -0.21, diameter_m: 0.02 }).collect();
    bars.extend([-0.11, 0.11].map(|x_m| Bar { x_m, y_m: 0.21, diameter_m: 0.016 }));
    let beam = SectionInput { size_m: [0.3, 0.5], bars: bars.clone(), ..s1() };
    let turned = bars.iter().map(|b| Bar { x_m: b.y_m, y_m: -b.x_m, diameter_m: b.diameter_m }).collect();
    let turned = SectionInput { size_m: [0.5, 0.3], bars: turned, ..s1() };
    let curvatures: Vec<f64> = (0..80).map(|k| 0.0005 * f64::from(k)).collect();
    let peak = |input: &SectionInput, direction: f64| {
        let section = FibreSection::of(input, ConcreteLaw::Mander);
        let found = section.moment_curvature(200e3, direction, &curvatures);
        largest(&curve_of(&found)).unwrap()[1]
    };
    let (top, bottom) = (peak(&beam, QUARTER_TURN), peak(&beam, -QUARTER_TURN));
    assert!(top > 1.2 * bottom, "{top} {bottom}"); // three thicker bars below, two above
    near("turned", peak(&turned, 0.0), top, 1e-9);
    near("turned", peak(&turned, HALF_TURN), bottom, 1e-9);
    // cells give what strips give
    near("cells", peak(&beam, QUARTER_TURN - 1e-6), top, 2e-3);
}

#[test]
fn limits_of_the_axial_force() {
    let squash = 30e6 * 0.16 + 8.0 * 0.25 * HALF_TURN * 0.02f64.powi(2) * 500e6;
    let section = FibreSection::of(&s1(), ConcreteLaw::Mander);
    assert!(section.moment_curvature(1.2 * squash, 0.0, &[0.0, 0.001]).is_empty());
    let pure = section.moment_curvature(2e6, 0.0, &[0.0]);
    assert!(pure.len() == 1 && pure[0].moment_nm.abs() < 1e-3);
    near("balance", pure[0].axial_force_n, 2e6, 1e-8);
}

#[test]
fn buckling_of_bars_takes_from_the_ductility_only() {
    use crate::material::rebar::Buckling;
    let straight = SectionInput { options: FibreOptions { deduct_bars: false, history: true }, ..s1() };
    let steel = straight.steel.with_buckling(Buckling::between_ties(0.15, 0.02, &straight.steel));
    let buckling = SectionInput { steel, ..straight.clone() };
    let [a, b] = [straight, buckling].map(|i| milestones(&i, ConcreteLaw::Mander, 0.3, 0.2));
    assert_eq!(a.first_yield, b.first_yield);
    assert!(b.peak[1] < a.peak[1] && b.peak[1] > 0.97 * a.peak[1], "{:?} {:?}", a.peak, b.peak);
    let [a, b] = [a, b].map(|m| m.at_80.unwrap()[0]);
    assert!(b < 0.97 * a, "{a} {b}");
}

#[test]
fn section_of_a_building() {
    use crate::building::Ties;
    let ties = Some(Ties { diameter_m: 0.008, spacing_m: 0.15 });
    let shape = SectionShape::Rectangle { width_m: 0.4, depth_m: 0.4, bars: s1().bars, ties };
    let id = String::new;
    let section = Section { id: id(), shape, concrete: id(), steel: id(), law: id() };
    let concrete =
        Concrete { density_kg_m3: 2500.0, strength_pa: 30e6, youngs_modulus_pa: 30.59e9, poisson_ratio: 0.2 };
    let made = SectionInput::of_building(&section, &concrete, s1().steel, 500e6, s1().options).unwrap();
    near("cover", made.ties.unwrap().cover_m, 0.022, 1e-9);
    near("tension", made.tensile_strength_pa, 2.896e6, 1e-3);
    near("strength", Confinement::of(&made).unwrap().strength_pa, 32.128e6, 1e-5);
}

/// Popovics' line begins with its modulus, peaks at the strength, and is nowhere above it, whatever the strength: at 100 MPa a peak at 0.002 has a pole.
#[test]
fn lines_of_strong_concrete_have_their_peak_at_the_strength() {
    for mpa in [5.0, 30.0, 60.0, 82.0, 83.0, 95.0, 100.0, 105.0, 150.0] {
        let input = SectionInput { concrete_strength_pa: 1e6 * mpa, ..s1() };
        let [_, cover] = ConcreteCurve::pair(ConcreteLaw::Mander, &input);
        let ConcreteCurve::Popovics { strain, exponent, .. } = cover else { panic!("{cover:?}") };
        assert!(exponent > 1.0 && exponent < 11.0 + 1e-9, "{mpa} MPa: {exponent}");
        assert!(if mpa <= 82.0 { strain == 0.002 } else { strain > 0.002 && strain < 0.0027 }, "{strain}");
        near("modulus", cover.stress_pa(1e-6) / 1e-6, 5000e6 * f64::sqrt(mpa), 1e-3);
        near("peak", cover.stress_pa(strain), 1e6 * mpa, 1e-12);
        let most = (0..=500).map(|i| cover.stress_pa(1e-5 * f64::from(i))).fold(0.0, f64::max);
        assert!(most <= 1e6 * mpa * (1.0 + 1e-12), "{mpa} MPa: {most}");
    }
    // 2513 mm2 of bars below 645 MPa at arms below 0.36 m
    let strong = SectionInput { concrete_strength_pa: 105e6, ..s1() };
    let curve = points(&strong, ConcreteLaw::Mander, 0.0, 0.05);
    let moment = curve.iter().map(|p| p.moment_nm).fold(0.0, f64::max);
    assert!(moment > 1.5e5 && moment < 5.9e5, "{moment}");
}

fn s1() -> SectionInput {
    let places = [-0.16, 0.0, 0.16];
    let bars = places
        .iter()
        .flat_map(|x| places.iter().map(|y| [*x, *y]))
        .filter(|p| *p != [0.0, 0.0])
        .map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.02 })
        .collect();
    SectionInput {
        size_m: [0.4, 0.4],
        bars,
        concrete_strength_pa: 30e6,
        tensile_strength_pa: 2.896e6,
        youngs_modulus_pa: 30.59e9,
        ties: Some(ties(0.008, 0.15, 0.022)),
        steel: RebarLaw::bilinear(200e9, 500e6, 0.01, 0.075),
        options: FibreOptions { deduct_bars: true, history: false },
    }
}

fn s2() -> SectionInput {
    let corners = [[0.115, 0.115], [0.115, -0.115], [-0.115, 0.115], [-0.115, -0.115]];
    SectionInput {
        size_m: [0.3, 0.3],
        bars: corners.map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.016 }).to_vec(),
        concrete_strength_pa: 25e6,
        tensile_strength_pa: 2.565e6,
        youngs_modulus_pa: 28.96e9,
        ties: Some(ties(0.006, 0.20, 0.021)),
        ..s1()
    }
}

/// Perimeter ties that hold the corner bars.
fn ties(diameter_m: f64, spacing_m: f64, cover_m: f64) -> TieInput {
    TieInput {
        diameter_m,
        spacing_m,
        yield_strength_pa: 500e6,
        ultimate_strain: 0.10,
        legs: [2.0; 2],
        cover_m,
        all_bars_held: false,
    }
}

/// 500 mm, twelve bars of 25 mm that four legs each way hold.
fn s4() -> SectionInput {
    let line = [-0.2, -0.2 / 3.0, 0.2 / 3.0, 0.2];
    let bars = line
        .iter()
        .flat_map(|x| line.iter().map(|y| [*x, *y]))
        .filter(|p| p.iter().any(|c: &f64| c.abs() > 0.19))
        .map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.025 })
        .collect();
    let ties = TieInput { legs: [4.0; 2], all_bars_held: true, ..ties(0.010, 0.10, 0.0275) };
    SectionInput {
        size_m: [0.5, 0.5],
        bars,
        concrete_strength_pa: 40e6,
        tensile_strength_pa: 3.509e6,
        youngs_modulus_pa: 33.35e9,
        ties: Some(ties),
        ..s1()
    }
}
