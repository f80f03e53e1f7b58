//! Uniaxial curves given by points, and rate factors.

use super::point::{Hold, Path};
use crate::material::concrete::{CompressionCurve, ConcreteLaw, Surface, TensionCurve};
use crate::verify::{Case, Figure};

const FREE: [Hold; 2] = [Hold::Stress(0.0); 2];
const YOUNG_PA: f64 = 31.7e9;
const STRENGTH_PA: f64 = 27.6e6;
const TENSILE_PA: f64 = 3.48e6;

/// The cases of this file.
pub fn cases() -> Vec<Case> {
    vec![
        Case::short(
            "point-lee-fenves-tension",
            "Lee and Fenves' exponential line (E 31.7 GPa, f_t 3.48 MPa, 12.3 kJ/m³, slope factor 0.7, damage 0.51 at f_t/2) given as points: stress at strains, against the \
             formula and against Blackbear's one-element run (band: 5 % of the strength; its own finite steps are off the formula by up to 3 %).",
            tension,
        ),
        Case::short(
            "point-lee-fenves-compression",
            "The same in compression (yield 18.3 MPa, strength 27.6 MPa, 68.9 kJ/m³, damage 0.25 at the peak). Blackbear's 28.45 MPa at 1.8e-3 lie 3 % above the strength \
             that was given to it: its step there was finite.",
            compression,
        ),
        Case::short(
            "point-rates",
            "Strengths and modulus of a point at a strain rate over the static ones: factors of fib Model Code 2010, eq. 5.1-112 to 5.1-115, worked apart from this program.",
            rates,
        ),
    ]
}

/// Lee and Fenves' functions of the plastic strain in one direction.
#[derive(Clone, Copy)]
struct Exponential {
    /// Stress at the start \[Pa\].
    start_pa: f64,
    a: f64,
    b: f64,
    /// Exponent of the remaining stiffness, `1 - D = exp(-d ε_p)`.
    d: f64,
}

impl Exponential {
    /// From the energy over the volume \[J/m³\], and the damage where `exp(-b ε_p)` is `decay`.
    fn new(start_pa: f64, a: f64, energy_j_m3: f64, damage: f64, decay: f64) -> Self {
        let b = start_pa * (1.0 + 0.5 * a) / energy_j_m3;
        Self { start_pa, a, b, d: b * libm::log(1.0 - damage) / libm::log(decay) }
    }

    fn tension() -> Self {
        let a = 1.5 * (1.0 - 0.7f64).sqrt() - 0.5;
        let half = (1.0 + a - (1.0 + a * a).sqrt()) / (2.0 * a);
        Self::new(TENSILE_PA, a, 12.3e3, 0.51, half)
    }

    fn compression() -> Self {
        let r = STRENGTH_PA / 18.3e6;
        let a = 2.0 * r - 1.0 + 2.0 * (r * r - r).sqrt();
        Self::new(18.3e6, a, 68.89e3, 0.25, (1.0 + a) / (2.0 * a))
    }

    /// Strain and stress \[Pa\] at a plastic strain.
    fn at(&self, plastic: f64) -> [f64; 2] {
        let decay = libm::exp(-self.b * plastic);
        let stress = self.start_pa * ((1.0 + self.a) * decay - self.a * decay * decay);
        [plastic + stress / (libm::exp(-self.d * plastic) * YOUNG_PA), stress]
    }

    /// Stress \[Pa\] at a strain.
    fn stress_pa(&self, strain: f64) -> f64 {
        if strain * YOUNG_PA <= self.start_pa {
            return YOUNG_PA * strain;
        }
        let (mut low, mut high) = (0.0, strain);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if self.at(middle)[0] < strain { low = middle } else { high = middle }
        }
        self.at(low)[1]
    }

    /// Points from the start until `end` times the start is left.
    fn points(&self, end: f64) -> Vec<[f64; 2]> {
        let mut points: Vec<[f64; 2]> = Vec::new();
        for k in 0..2000 {
            let next = self.at(f64::from(k) * 0.02 / self.b);
            if points.last().is_some_and(|p| p[1] > next[1]) && next[1] < end * self.start_pa {
                break;
            }
            points.push(next);
        }
        points
    }
}

fn law() -> ConcreteLaw {
    let compressed = Exponential::compression();
    let mut line = compressed.points(1e-3);
    let last = line[line.len() - 1];
    line.push([1.1 * last[0], 0.0]);
    let peak = line.iter().fold([0.0; 2], |m: [f64; 2], p| if p[1] > m[1] { *p } else { m });
    let torn = Exponential::tension().points(1e-3);
    let mut cracks: Vec<[f64; 2]> = torn.iter().map(|p| [p[0] - p[1] / YOUNG_PA, p[1]]).collect();
    let last = cracks[cracks.len() - 1];
    cracks.push([1.1 * last[0], 0.0]);
    ConcreteLaw {
        youngs_modulus_pa: YOUNG_PA,
        poisson_ratio: 0.18,
        tensile_strength_pa: TENSILE_PA,
        peak_strain: peak[0],
        compression: CompressionCurve::Points(line),
        tension: TensionCurve::Points(cracks),
        surface: Surface { biaxial_ratio: 1.14, ..Surface::FULL },
        ..ConcreteLaw::of_strength(STRENGTH_PA)
    }
}

/// Stresses at strains against the formula and the one-element run \[MPa\].
fn compared(curve: Exponential, sign: f64, run: &[[f64; 2]], step: f64) -> Result<Vec<Figure>, String> {
    let mut point = Path::new(&law(), 0.1, FREE)?;
    let band = 0.05 * if sign > 0.0 { TENSILE_PA } else { STRENGTH_PA };
    let mut figures = Vec::new();
    for [strain, mega] in run {
        point.drive(sign * strain, step, |_| ())?;
        let ours = sign * point.stress_pa[2];
        let formula = [curve.stress_pa(*strain), ours];
        let what = format!("stress at {strain:e}");
        figures.push(Figure::relative(
            what.clone(),
            "Pa",
            formula,
            5e-3,
            "Lee, Fenves (1998), exponential line",
        ));
        figures.push(Figure::absolute(what, "Pa", [mega * 1e6, ours], band, "Blackbear, one element"));
    }
    Ok(figures)
}

fn tension() -> Result<Vec<Figure>, String> {
    let run = [[2e-4, 3.495], [5e-4, 3.266], [1e-3, 2.882], [2e-3, 2.196], [4e-3, 1.208]];
    compared(Exponential::tension(), 1.0, &run, 2e-6)
}

fn compression() -> Result<Vec<Figure>, String> {
    let run = [[5e-4, 15.85], [1e-3, 24.20], [1.8e-3, 28.45], [3e-3, 19.95], [4e-3, 8.77], [5e-3, 3.22]];
    compared(Exponential::compression(), -1.0, &run, 5e-6)
}

/// Rate \[1/s\]; factors on compressive strength, tensile strength, modulus.
const FACTORS: [[f64; 4]; 3] = [
    [1e-3, 1.050_317, 1.132_400, 1.095_456],
    [1.0, 1.156_965, 1.282_331, 1.310_976],
    [100.0, 1.792_562, 2.877_785, 1.477_729],
];

fn rates() -> Result<Vec<Figure>, String> {
    let base = ConcreteLaw::of_strength(30e6);
    let mut figures = Vec::new();
    for [rate, compressed, torn, modulus] in FACTORS {
        let law = base.at_rate(rate);
        let mut point = Path::new(&law, 0.1, FREE)?;
        let slope = point.advance(-1e-6)? / -1e-6 / base.youngs_modulus_pa;
        let crushed = -point.peak(-5e-6, 0.97)?.stress_pa[2] / base.compressive_strength_pa;
        let pulled = Path::new(&law, 0.1, FREE)?.peak(2e-7, 0.9)?.stress_pa[2] / base.tensile_strength_pa;
        let mut row = |what: &str, values: [f64; 2], source: &'static str| {
            figures.push(Figure::relative(format!("{what} at {rate} 1/s"), "-", values, 1e-3, source));
        };
        row(
            "compressive strength",
            [compressed, crushed],
            "(ε̇ / 3e-5)^0.014, above 30 1/s 0.012 (ε̇ / 3e-5)^(1/3)",
        );
        row("tensile strength", [torn, pulled], "(ε̇ / 1e-6)^0.018, above 10 1/s 0.0062 (ε̇ / 1e-6)^(1/3)");
        row("modulus", [modulus, slope], "(ε̇ / 3e-5)^0.026");
    }
    Ok(figures)
}
