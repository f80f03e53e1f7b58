//! What a material point dissipates, what strain it keeps, and how cracks close.

use super::point::{Hold, Path};
use crate::material::concrete::ConcreteLaw;
use crate::verify::{Case, Figure};

const FREE: [Hold; 2] = [Hold::Stress(0.0); 2];
const LENGTH_M: f64 = 0.1;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "point-energy",
            "Concrete of 30 MPa torn and crushed until it bears nothing, in elements of four lengths: work over volume times the length.",
            energy,
        ),
        Case::short(
            "point-residual-strain",
            "Compression to a strain r ε_0, then unloading: strain free of stress over ε_0.",
            residual,
        ),
        Case::short(
            "point-crack-closing",
            "Tension to a strain of 0.1 %, compression to 0.09 f_c, tension again, and at last compression to failure: unloading along the secant, the \
             full stiffness of the closed crack, the same secant again, the full strength.",
            closing,
        ),
    ]
}

fn law() -> ConcreteLaw {
    ConcreteLaw::of_strength(30e6)
}

/// Work over volume \[J/m³\] until nothing is left.
fn work(law: &ConcreteLaw, length_m: f64, step: f64) -> Result<f64, String> {
    let mut point = Path::new(law, length_m, FREE)?;
    let strength = if step > 0.0 { law.tensile_strength_pa } else { law.compressive_strength_pa };
    let mut largest: f64 = 0.0;
    for _ in 0..50_000 {
        let stress = point.advance(step)? * step.signum();
        largest = largest.max(stress);
        if largest > 0.9 * strength && stress < 2e-5 * strength {
            return Ok(point.work_j_m3);
        }
    }
    Err(format!("stress left at strain {:.4}", point.strain[2]))
}

fn energy() -> Result<Vec<Figure>, String> {
    let law = law();
    let mut figures = Vec::new();
    for length_m in [0.025, 0.05, 0.1, 0.2] {
        let millimetres = 1e3 * length_m;
        let torn = length_m * work(&law, length_m, 5e-6)?;
        let values = [law.fracture_energy_j_m2, torn];
        let what = format!("torn, {millimetres:.0} mm");
        figures.push(Figure::relative(what, "J/m²", values, 0.05, "fracture energy G_F"));
        let crushed = length_m * work(&law, length_m, -1e-5)?;
        let values = [law.crushing_energy_j_m2, crushed];
        let what = format!("crushed, {millimetres:.0} mm");
        figures.push(Figure::relative(what, "J/m²", values, 0.05, "crushing energy G_c"));
    }
    Ok(figures)
}

fn residual() -> Result<Vec<Figure>, String> {
    let law = law();
    // 0.145 r² + 0.13 r up to 2, then 0.707 (r - 2) + 0.834
    let cases = [(0.5, 0.101_25), (1.0, 0.275), (1.5, 0.521_25), (2.0, 0.834), (3.0, 1.541)];
    cases
        .iter()
        .map(|(r, expected)| {
            let mut point = Path::new(&law, LENGTH_M, FREE)?;
            point.drive(-r * law.peak_strain, 5e-6, |_| ())?;
            let left = -point.release(5e-6)? / law.peak_strain;
            let source = "Karsan, Jirsa (1969)";
            Ok(Figure::absolute(format!("residual strain, r = {r}"), "-", [*expected, left], 0.15, source))
        })
        .collect()
}

fn closing() -> Result<Vec<Figure>, String> {
    let law = law();
    let (wide, closed) = (1e-3, -0.09 * law.compressive_strength_pa / law.youngs_modulus_pa);
    let mut point = Path::new(&law, LENGTH_M, FREE)?;
    point.drive(wide, 1e-6, |_| ())?;
    let top = point.stress_pa[2];
    point.drive(0.5 * wide, 1e-6, |_| ())?;
    let half = point.stress_pa[2];
    point.drive(0.5 * closed, 1e-6, |_| ())?;
    let first = point.stress_pa[2];
    point.drive(closed, 1e-6, |_| ())?;
    let slope = (point.stress_pa[2] - first) / (0.5 * closed);
    point.drive(0.5 * wide, 1e-6, |_| ())?;
    let again = point.stress_pa[2];
    point.drive(wide, 1e-6, |_| ())?;
    let full = point.stress_pa[2];
    point.drive(0.0, 1e-6, |_| ())?;
    let strength = point.peak(-5e-6, 0.97)?.stress_pa[2];
    let secant = "line to the origin";
    Ok(vec![
        Figure::relative("stress unloaded to half the strain", "Pa", [0.5 * top, half], 0.01, secant),
        Figure::relative("slope of the closed crack", "Pa", [law.youngs_modulus_pa, slope], 0.01, "E"),
        Figure::relative("stress pulled to half the strain", "Pa", [0.5 * top, again], 0.01, secant),
        Figure::relative("stress pulled to the whole strain", "Pa", [top, full], 0.01, "that before"),
        Figure::relative(
            "compressive strength across the closed crack",
            "Pa",
            [-law.compressive_strength_pa, strength],
            1e-3,
            "f_c",
        ),
    ])
}
