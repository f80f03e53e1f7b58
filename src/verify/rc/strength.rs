//! Strengths of a material point in one, two and three directions.

use super::point::{Hold, Path, Peak};
use crate::material::concrete::{ConcreteLaw, Surface};
use crate::verify::{Case, Figure};

/// Compressive strength of the cases \[Pa\].
const FC: f64 = 30e6;
/// Element length of the cases \[m\].
const LENGTH_M: f64 = 0.1;
const FREE: [Hold; 2] = [Hold::Stress(0.0); 2];
const KUPFER: &str = "Kupfer, Gerstle (1973): (1 + 3.65 a) / (1 + a)²";
const KUPFER_MIXED: &str = "Kupfer, Gerstle (1973): 1 - 0.8 σ_c / f_c";
const LAW: &str = "parameter of the law";
const EQUATION_3: &str = "(μ I₁ + √J₂) / (1/√3 - μ) = f_c";

/// The cases of this file. All of them: strength 30 MPa, the rest as the law sets it from the strength, element length 0.1 m.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "point-uniaxial",
            "Concrete of 30 MPa in one direction, its sides free of stress: strengths, strain at the peak, initial slope.",
            || uniaxial(Surface::FULL),
        ),
        Case::short(
            "point-biaxial-compression",
            "Compression along two axes in a fixed ratio a, the third free of stress: largest stress over f_c.",
            biaxial_compression,
        ),
        Case::short(
            "point-tension-compression",
            "Pressure across the tension: held at a share of f_c, then pulled; and in a fixed ratio of tension to pressure. Largest tensile stress over f_t.",
            tension_compression,
        ),
        Case::short(
            "point-biaxial-tension",
            "Tension along two axes in a fixed ratio a: largest stress over f_t. Past the first crack the law goes in sub-steps of a quarter of the cracking strain.",
            biaxial_tension,
        ),
        Case::short(
            "point-confinement",
            "A pressure p all round, then compression along one axis: gain of strength over p, and the strain at the peak.",
            confinement,
        ),
        Case::short(
            "point-seed-surfaces",
            "The surfaces of equations 3 and 4 alone: uniaxial strengths, gain of strength under lateral pressure (far below what tests give), and equation 3 \
             evaluated with the stresses at failure of other paths.",
            seed,
        ),
    ]
}

fn law(surface: Surface) -> ConcreteLaw {
    ConcreteLaw { surface, ..ConcreteLaw::of_strength(FC) }
}

fn path(law: &ConcreteLaw, hold: [Hold; 2]) -> Result<Path, String> {
    Path::new(law, LENGTH_M, hold)
}

fn uniaxial(surface: Surface) -> Result<Vec<Figure>, String> {
    let law = law(surface);
    let mut crushed = path(&law, FREE)?;
    let first = crushed.advance(-1e-5)? / -1e-5;
    let crushed = crushed.peak(-5e-6, 0.97)?;
    let torn = path(&law, FREE)?.peak(2e-7, 0.9)?;
    Ok(vec![
        Figure::relative("compressive strength", "Pa", [-FC, crushed.stress_pa[2]], 1e-3, LAW),
        Figure::relative("strain there", "-", [-law.peak_strain, crushed.strain[2]], 0.03, LAW),
        Figure::relative("tensile strength", "Pa", [law.tensile_strength_pa, torn.stress_pa[2]], 1e-3, LAW),
        Figure::relative("initial slope", "Pa", [law.youngs_modulus_pa, first], 1e-4, LAW),
    ])
}

/// Biaxial compressive strength over the uniaxial one at a ratio of the two stresses.
///
/// # Errors
/// If the path does not exist.
pub fn biaxial_share(ratio: f64) -> Result<f64, String> {
    let peak = path(&law(Surface::FULL), [Hold::Stress(0.0), Hold::Ratio(ratio)])?.peak(-5e-6, 0.97)?;
    Ok(-peak.stress_pa[2] / FC)
}

/// Biaxial compressive strength over the uniaxial one at a ratio of the two stresses, Kupfer and Gerstle (1973).
pub fn kupfer_share(ratio: f64) -> f64 {
    (1.0 + 3.65 * ratio) / ((1.0 + ratio) * (1.0 + ratio))
}

fn biaxial_compression() -> Result<Vec<Figure>, String> {
    let ratios = (1..=10).map(|k| 0.1 * f64::from(k));
    ratios
        .map(|a| {
            let values = [kupfer_share(a), biaxial_share(a)?];
            Ok(Figure::relative(format!("strength, a = {a:.1}"), "-", values, 0.05, KUPFER))
        })
        .collect()
}

fn tension_compression() -> Result<Vec<Figure>, String> {
    let law = law(Surface::FULL);
    let ft = law.tensile_strength_pa;
    let mut figures = Vec::new();
    for share in [0.2, 0.4, 0.6, 0.8] {
        let mut point = path(&law, FREE)?;
        for k in 1..=400 {
            point.hold[0] = Hold::Stress(-share * FC * f64::from(k) / 400.0);
            // the free lateral strain, as long as it is elastic
            point.advance(law.poisson_ratio * share * FC / 400.0 / law.youngs_modulus_pa)?;
        }
        let ours = point.peak(2e-6, 0.9)?.stress_pa[2] / ft;
        let what = format!("tensile strength, pressure {share:.1} f_c");
        figures.push(Figure::relative(what, "-", [1.0 - 0.8 * share, ours], 0.15, KUPFER_MIXED));
    }
    for ratio in [0.05, 0.1, 0.15, 0.2, 0.3] {
        let peak = path(&law, [Hold::Ratio(-1.0 / ratio), Hold::Stress(0.0)])?.peak(1e-6, 0.97)?;
        // where the ray meets the line
        let expected = 1.0 / (1.0 + 0.8 * ft / (ratio * FC));
        let what = format!("tensile strength, tension {ratio:.2} of the pressure");
        figures.push(Figure::relative(what, "-", [expected, peak.stress_pa[2] / ft], 0.15, KUPFER_MIXED));
    }
    Ok(figures)
}

fn biaxial_tension() -> Result<Vec<Figure>, String> {
    let law = law(Surface::FULL);
    let ratios = [0.25, 0.5, 0.75, 1.0];
    ratios
        .iter()
        .map(|a| {
            let peak = path(&law, [Hold::Stress(0.0), Hold::Ratio(*a)])?.peak(1e-6, 0.9)?;
            let values = [1.0, peak.stress_pa[2] / law.tensile_strength_pa];
            Ok(Figure::relative(
                format!("strength, a = {a}"),
                "-",
                values,
                0.01,
                "Kupfer, Gerstle (1973): f_t",
            ))
        })
        .collect()
}

/// The peak under a lateral pressure \[Pa\].
fn confined(law: &ConcreteLaw, pressure_pa: f64) -> Result<Peak, String> {
    let mut point = path(law, FREE)?;
    let bulk = law.youngs_modulus_pa / (1.0 - 2.0 * law.poisson_ratio);
    for k in 1..=100 {
        point.hold = [Hold::Stress(-pressure_pa * f64::from(k) / 100.0); 2];
        point.advance(-pressure_pa / 100.0 / bulk)?;
    }
    point.peak(-1e-5, 0.98)
}

fn confinement() -> Result<Vec<Figure>, String> {
    let law = law(Surface::FULL);
    let mut figures = Vec::new();
    for share in [0.05, 0.1, 0.2] {
        let peak = confined(&law, share * FC)?;
        let strength = -peak.stress_pa[2] / FC;
        figures.push(Figure::absolute(
            format!("(f_cc - f_c) / p, p = {share} f_c"),
            "-",
            [4.25, (strength - 1.0) / share],
            0.75,
            "tests, 3.5 to 5; Richart, Brandtzaeg, Brown (1928): 4.1",
        ));
        let expected = -law.peak_strain * (1.0 + 5.0 * (strength - 1.0));
        figures.push(Figure::relative(
            format!("strain at f_cc, p = {share} f_c"),
            "-",
            [expected, peak.strain[2]],
            0.35,
            "Mander et al. (1988): ε_0 (1 + 5 (f_cc / f_c - 1)) with this f_cc",
        ));
    }
    Ok(figures)
}

/// The seed's equation 3 over `f_c`, for principal stresses \[Pa\].
fn equation_3(stress_pa: [f64; 3]) -> f64 {
    let r = Surface::SEED.biaxial_ratio;
    let root = 3f64.sqrt();
    let mu = (r - 1.0) / (root * (2.0 * r - 1.0));
    let [a, b, c] = stress_pa;
    let j2 = ((a - b) * (a - b) + (b - c) * (b - c) + (c - a) * (c - a)) / 6.0;
    (mu * (a + b + c) + j2.sqrt()) / (1.0 / root - mu) / FC
}

fn seed() -> Result<Vec<Figure>, String> {
    let law = law(Surface::SEED);
    let mut figures = uniaxial(Surface::SEED)?;
    for share in [0.05, 0.1, 0.2] {
        let peak = confined(&law, share * FC)?;
        let slope = (-peak.stress_pa[2] / FC - 1.0) / share;
        let what = format!("(f_cc - f_c) / p, p = {share} f_c");
        // on the compressive meridian: (1 + 2 α) / (1 - α) with α = √3 μ = 0.16 / 1.32
        figures.push(Figure::relative(
            what,
            "-",
            [1.413_793, slope],
            2e-3,
            "(1 + 2 √3 μ) / (1 - √3 μ), r = 1.16",
        ));
        let what = format!("equation 3 over f_c at failure, p = {share} f_c");
        figures.push(Figure::relative(what, "-", [1.0, equation_3(peak.stress_pa)], 1e-3, EQUATION_3));
    }
    for ratio in [0.3, 0.5, 0.8, 1.0] {
        let peak = path(&law, [Hold::Stress(0.0), Hold::Ratio(ratio)])?.peak(-5e-6, 0.97)?;
        let what = format!("equation 3 over f_c at failure, a = {ratio}");
        figures.push(Figure::relative(what, "-", [1.0, equation_3(peak.stress_pa)], 1e-3, EQUATION_3));
    }
    let peak = path(&law, [Hold::Ratio(0.2), Hold::Ratio(0.1)])?.peak(-5e-6, 0.97)?;
    let what = "equation 3 over f_c at failure, stresses 1 : 0.2 : 0.1";
    figures.push(Figure::relative(what, "-", [1.0, equation_3(peak.stress_pa)], 1e-3, EQUATION_3));
    Ok(figures)
}
