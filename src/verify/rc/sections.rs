//! The fibre section against other programs.

use crate::building::Bar;
use crate::material::fibre::{CurvaturePoint, FibreOptions, FibreSection, SectionInput};
use crate::material::fibre_concrete::{ConcreteLaw, Confinement, TieInput};
use crate::material::fibre_response::{
    Milestones, chord_rotation, curve_of, hinge_length_m, largest, secant_yield,
};
use crate::material::rebar::RebarLaw;
use crate::verify::{Case, Figure};

const STRIPS: &str = "strip solver of another author, displaced concrete deducted";
const PROPERTIES: &str = "concreteproperties 0.7.0";
const OPENSEES: &str = "OpenSees 3.7.1 (Concrete04, Steel01, HingeRadau)";

/// Axial forces over `f_c A`.
const SHARES: [f64; 4] = [0.0, 0.1, 0.3, 0.6];

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "section-confinement",
            "Two columns. S1: 400 mm, 8 bars of 20 mm, ties of 8 mm at 150 mm, 30 MPa. S2: 300 mm, 4 bars of 16 mm, ties of 6 mm at 200 mm, 25 MPa. Bars and ties 500 \
             MPa, bars hardening by 1 %, rupture at 7.5 %. Mander, Priestley and Park's confinement.",
            confinement,
        ),
        Case::short(
            "section-moment-curvature",
            "The same sections with Mander's concrete under n = N / (f_c A): moment at the first yield and at the peak, curvature at 80 %. Curves go in steps of 1.5 and \
             1.8 %, so that the rupture of a bar falls within one.",
            moment_curvature,
        ),
        Case::short(
            "section-ultimate",
            "The same sections with the parabola and rectangle of EN 1992-1-1: moment at an edge strain of 0.35 %.",
            ultimate,
        ),
        Case::short(
            "section-chord-rotation",
            "Cantilevers of 1.75 m of these sections, hinge at the base, bars displace nothing and remember: largest moment, yield rotation (secant through 75 %).",
            rotation,
        ),
    ]
}

fn steel_ties(diameter_m: f64, spacing_m: f64, cover_m: f64) -> TieInput {
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

/// Column of 400 mm: 8 bars of 20 mm, ties of 8 mm at 150 mm, 30 MPa; bars and ties 500 MPa.
pub(super) fn s1() -> SectionInput {
    let places = [-0.16, 0.0, 0.16];
    let grid = places.iter().flat_map(|x| places.iter().map(|y| [*x, *y]));
    let ring = grid.filter(|p| *p != [0.0, 0.0]);
    SectionInput {
        size_m: [0.4, 0.4],
        bars: ring.map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.02 }).collect(),
        concrete_strength_pa: 30e6,
        tensile_strength_pa: 2.896e6,
        youngs_modulus_pa: 30.59e9,
        ties: Some(steel_ties(0.008, 0.15, 0.022)),
        steel: RebarLaw::bilinear(200e9, 500e6, 0.01, 0.075),
        options: FibreOptions { deduct_bars: true, history: false },
    }
}

/// Column of 300 mm: 4 bars of 16 mm, ties of 6 mm at 200 mm, 25 MPa.
pub(super) fn s2() -> SectionInput {
    let corners = [[0.115, 0.115], [0.115, -0.115], [-0.115, 0.115], [-0.115, -0.115]];
    SectionInput {
        size_m: [0.3, 0.3],
        bars: corners.map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.016 }).to_vec(),
        concrete_strength_pa: 25e6,
        tensile_strength_pa: 2.565e6,
        youngs_modulus_pa: 28.96e9,
        ties: Some(steel_ties(0.006, 0.20, 0.021)),
        ..s1()
    }
}

/// Beam of 300 x 500 mm: 3 bars of 20 mm at the bottom (y < 0), 2 of 16 mm at the top, ties of 8 mm at 150 mm, 30 MPa.
pub(super) fn s3() -> SectionInput {
    let bottom = [-0.11, 0.0, 0.11].map(|x_m| Bar { x_m, y_m: -0.21, diameter_m: 0.020 });
    let top = [-0.11, 0.11].map(|x_m| Bar { x_m, y_m: 0.21, diameter_m: 0.016 });
    SectionInput { size_m: [0.3, 0.5], bars: [&bottom[..], &top].concat(), ..s1() }
}

/// Column of 500 mm: 12 bars of 25 mm, ties of 10 mm at 100 mm with four legs each way that hold all bars, 40 MPa.
pub(super) fn s4() -> SectionInput {
    let places = [-0.2, -0.2 / 3.0, 0.2 / 3.0, 0.2];
    let outer = |c: f64| c.abs() > 0.19;
    let grid = places.iter().flat_map(|x| places.iter().map(|y| [*x, *y]));
    let ring = grid.filter(|[x, y]| outer(*x) || outer(*y));
    let concrete = crate::material::concrete::ConcreteLaw::of_strength(40e6);
    SectionInput {
        size_m: [0.5, 0.5],
        bars: ring.map(|[x_m, y_m]| Bar { x_m, y_m, diameter_m: 0.025 }).collect(),
        concrete_strength_pa: 40e6,
        tensile_strength_pa: concrete.tensile_strength_pa,
        youngs_modulus_pa: concrete.youngs_modulus_pa,
        ties: Some(TieInput { legs: [4.0; 2], all_bars_held: true, ..steel_ties(0.010, 0.10, 0.0275) }),
        ..s1()
    }
}

/// Both sections.
fn both() -> [(&'static str, SectionInput); 2] {
    [("S1", s1()), ("S2", s2())]
}

fn points(input: &SectionInput, law: ConcreteLaw, share: f64, limit_1_m: f64) -> Vec<CurvaturePoint> {
    let force = share * input.concrete_strength_pa * input.area_m2();
    FibreSection::of(input, law).moment_curvature(force, 0.0, &FibreSection::curvatures_to(limit_1_m))
}

fn confinement() -> Result<Vec<Figure>, String> {
    let expected =
        [[0.326, 0.314e6, 32.13e6, 0.002_71, 0.012_39], [0.199, 0.112e6, 25.77e6, 0.002_31, 0.0101]];
    let mut figures = Vec::new();
    for ((name, input), expected) in both().into_iter().zip(expected) {
        let c = Confinement::of(&input).ok_or("no ties")?;
        let rows = [
            ("effectiveness k_e", "-", c.effectiveness),
            ("effective pressure f_l", "Pa", c.pressure_pa),
            ("strength f_cc", "Pa", c.strength_pa),
            ("strain at it", "-", c.strain),
            ("strain at the rupture of a tie", "-", c.ultimate_strain),
        ];
        for ((what, unit, ours), reference) in rows.into_iter().zip(expected) {
            let source = "Mander et al. (1988), worked by hand to three digits";
            figures.push(Figure::relative(format!("{name}: {what}"), unit, [reference, ours], 4e-3, source));
        }
    }
    Ok(figures)
}

fn moment_curvature() -> Result<Vec<Figure>, String> {
    // first yield, peak [kN m], curvature at 80 % [1/m]; at n = 0 bars that remember nothing regain what a ruptured one loses
    let expected: [[Option<[f64; 3]>; 4]; 2] = [
        [
            None,
            Some([236.06, 284.96, 0.132_64]),
            Some([292.86, 352.80, 0.064_595]),
            Some([262.45, 342.44, 0.024_633]),
        ],
        [
            Some([48.36, 59.71, 0.330_22]),
            Some([72.91, 78.57, 0.2254]),
            Some([99.22, 114.78, 0.060_493]),
            Some([89.57, 110.16, 0.024_838]),
        ],
    ];
    let mut figures = Vec::new();
    for ((name, input), of_section) in both().into_iter().zip(expected) {
        for (share, row) in SHARES.into_iter().zip(of_section) {
            let Some([yielded, peak, fallen]) = row else { continue };
            let points = points(&input, ConcreteLaw::Mander, share, 0.4);
            let m = Milestones::of(&input, &points).ok_or("no moment")?;
            let first = m.first_yield.ok_or("no yield")?[1] / 1e3;
            let at_80 = m.at_80.ok_or("no fall to 80 %")?[0];
            let say = |what: &str| format!("{name}, n = {share}: {what}");
            figures.push(Figure::relative(say("first yield"), "kN m", [yielded, first], 5e-3, STRIPS));
            figures.push(Figure::relative(say("peak"), "kN m", [peak, m.peak[1] / 1e3], 5e-3, STRIPS));
            figures.push(Figure::relative(say("curvature at 80 %"), "1/m", [fallen, at_80], 2e-2, STRIPS));
        }
    }
    Ok(figures)
}

/// Moment \[kN m\] at a strain of the compressed edge, from the two points before: behind it concrete may be gone.
fn moment_at(points: &[CurvaturePoint], strain: f64) -> Option<f64> {
    let k = points.iter().position(|p| p.compressed_strain >= strain)?;
    let (a, b) = (points.get(k.checked_sub(2)?)?, &points[k - 1]);
    let share = (strain - a.compressed_strain) / (b.compressed_strain - a.compressed_strain);
    Some((a.moment_nm + share * (b.moment_nm - a.moment_nm)) / 1e3)
}

fn ultimate() -> Result<Vec<Figure>, String> {
    let expected = [
        [[219.34, 219.17], [282.90, 282.80], [355.73, 355.52], [339.81, 339.59]],
        [[54.36, 54.32], [78.08, 78.08], [115.65, 115.63], [112.43, 112.12]],
    ];
    let mut figures = Vec::new();
    for ((name, input), of_section) in both().into_iter().zip(expected) {
        for (share, moments) in SHARES.into_iter().zip(of_section) {
            let points = points(&input, ConcreteLaw::ParabolaRectangle, share, 0.15);
            let ours = moment_at(&points, 0.0035).ok_or("the edge strain is not reached")?;
            for (reference, source) in moments.into_iter().zip([STRIPS, PROPERTIES]) {
                let what = format!("{name}, n = {share}: moment");
                figures.push(Figure::relative(what, "kN m", [reference, ours], 4e-3, source));
            }
        }
    }
    Ok(figures)
}

fn rotation() -> Result<Vec<Figure>, String> {
    let expected = [
        [[239.6, 0.0085], [286.3, 0.0064], [356.2, 0.0054], [349.4, 0.0042]],
        [[59.8, 0.0089], [78.9, 0.0066], [115.4, 0.0062], [111.7, 0.0048]],
    ];
    let mut figures = Vec::new();
    for ((name, input), of_section) in both().into_iter().zip(expected) {
        let options = FibreOptions { deduct_bars: false, history: true };
        let input = SectionInput { options, ..input };
        let hinge = hinge_length_m(1.75, 500e6, input.bars[0].diameter_m);
        for (share, [peak, yielded]) in SHARES.into_iter().zip(of_section) {
            let curve = curve_of(&points(&input, ConcreteLaw::Mander, share, 0.4));
            let rotation = chord_rotation(&curve, 1.75, hinge);
            let largest = largest(&rotation).ok_or("no moment")?[1] / 1e3;
            let at_yield = secant_yield(&rotation).ok_or("no yield")?;
            let say = |what: &str| format!("{name}, n = {share}: {what}");
            figures.push(Figure::relative(say("peak"), "kN m", [peak, largest], 6e-3, OPENSEES));
            figures.push(Figure::relative(say("yield rotation"), "-", [yielded, at_yield], 6e-2, OPENSEES));
        }
    }
    Ok(figures)
}
