//! What a curve of moment over curvature says: cracking, first yield, peak, loss of strength; and the rotation of a cantilever with it.
//!
//! **Chord rotation** (tip displacement over length) of a cantilever loaded at its tip, without shear, slip and second order. The curvature at the base
//! counts over the plastic hinge length `L_p`, the rest of the length is integrated with the points of Scott and Fenves (2006, J. Struct. Eng. 132(2), modified Gauss-Radau):
//! weight `L_p` at the base, `3 L_p` at `8/3 L_p`, two points of Gauss beyond `4 L_p`; exact for a linear curvature. A hinge longer than a quarter of the cantilever leaves
//! four points of Gauss for the rest. Away from the base moments stay on the rising branch, also while the base softens.
//! `L_p = 0.08 L + 0.022 f_y d_b` (MPa, m) after Paulay and Priestley (1992, eq. 3.39).

use super::fibre::{CurvaturePoint, SectionInput};
use serde::Serialize;

/// Strain of the compressed edge that counts as first yield.
const YIELD_STRAIN_C: f64 = 0.002;
/// Strain of the compressed edge at the moment that stands for the ideal strength.
const IDEAL_STRAIN_C: f64 = 0.003;

/// A point of a curve: curvature \[1/m\] or rotation \[rad\], and moment \[N m\].
pub type CurvePoint = [f64; 2];

/// Milestones of moment over curvature.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Milestones {
    /// Opposite edge at the strain `f_t / E_cm`.
    pub cracking: Option<CurvePoint>,
    /// First of: a bar yields in tension, the compressed edge reaches 0.002.
    pub first_yield: Option<CurvePoint>,
    /// Compressed edge at 0.003.
    pub ideal: Option<CurvePoint>,
    /// Curvature at first yield times the ideal moment over that of first yield \[1/m\].
    pub ideal_yield_curvature_1_m: Option<f64>,
    /// Largest moment.
    pub peak: CurvePoint,
    /// First fall to 80 % of it.
    pub at_80: Option<CurvePoint>,
}

impl Milestones {
    /// Milestones of a curve of at least one point.
    pub fn of(input: &SectionInput, points: &[CurvaturePoint]) -> Option<Self> {
        let cracked = input.tensile_strength_pa / input.youngs_modulus_pa;
        let yielded = input.steel.yield_strain();
        let curve = curve_of(points);
        let crossing = |measure: &dyn Fn(&CurvaturePoint) -> f64| {
            let values: Vec<f64> = points.iter().map(measure).collect();
            let k = values.iter().position(|v| *v >= 0.0)?;
            let Some(before) = k.checked_sub(1) else { return Some(curve[0]) };
            let share = values[before] / (values[before] - values[k]);
            Some(between(curve[before], curve[k], share))
        };
        let first_yield = crossing(&|p: &CurvaturePoint| {
            (p.bar_strain / yielded - 1.0).max(p.compressed_strain / YIELD_STRAIN_C - 1.0)
        });
        let ideal = crossing(&|p: &CurvaturePoint| p.compressed_strain - IDEAL_STRAIN_C);
        Some(Self {
            cracking: crossing(&|p: &CurvaturePoint| -p.opposite_strain - cracked),
            first_yield,
            ideal,
            ideal_yield_curvature_1_m: first_yield.zip(ideal).map(|(y, i)| y[0] * i[1] / y[1]),
            peak: largest(&curve)?,
            at_80: fall_to(&curve, 0.8),
        })
    }
}

/// Curvature and moment of points.
pub fn curve_of(points: &[CurvaturePoint]) -> Vec<CurvePoint> {
    points.iter().map(|p| [p.curvature_1_m, p.moment_nm]).collect()
}

/// The first point of the largest ordinate.
pub fn largest(curve: &[CurvePoint]) -> Option<CurvePoint> {
    curve.iter().copied().reduce(|best, p| if p[1] > best[1] { p } else { best })
}

/// The first point behind the peak at which the ordinate has fallen to a share of the peak.
pub fn fall_to(curve: &[CurvePoint], share: f64) -> Option<CurvePoint> {
    let peak = largest(curve)?;
    let level = share * peak[1];
    let start = curve.iter().position(|p| *p == peak)?;
    let tail = &curve[start..];
    tail.windows(2)
        .find(|w| w[1][1] <= level)
        .map(|w| between(w[0], w[1], (w[0][1] - level) / (w[0][1] - w[1][1])))
}

/// The first point at which the ordinate has risen to a share of the peak.
pub fn rise_to(curve: &[CurvePoint], share: f64) -> Option<CurvePoint> {
    let level = share * largest(curve)?[1];
    curve
        .windows(2)
        .find(|w| w[1][1] >= level)
        .map(|w| between(w[0], w[1], (level - w[0][1]) / (w[1][1] - w[0][1])))
}

/// Yield rotation \[rad\] by the secant through three quarters of the peak.
pub fn secant_yield(curve: &[CurvePoint]) -> Option<f64> {
    rise_to(curve, 0.75).map(|p| p[0] / 0.75)
}

/// Plastic hinge length of Paulay and Priestley \[m\] of a cantilever \[m\] with bars of a yield strength \[Pa\] and diameter \[m\].
pub fn hinge_length_m(length_m: f64, yield_strength_pa: f64, bar_diameter_m: f64) -> f64 {
    0.08 * length_m + 0.022 * (yield_strength_pa / 1e6) * bar_diameter_m
}

/// Chord rotation \[rad\] and base moment \[N m\] of a cantilever of a length \[m\] with a plastic hinge length \[m\], point by point of a curve of moment over curvature.
pub fn chord_rotation(curve: &[CurvePoint], length_m: f64, hinge_m: f64) -> Vec<CurvePoint> {
    let rising = rising_part(curve);
    let stations = stations(length_m, hinge_m);
    curve
        .iter()
        .map(|base| {
            let rest: f64 = stations
                .iter()
                .map(|[x, weight]| {
                    let arm = length_m - x;
                    weight * arm * curvature_at(&rising, base[1] * arm / length_m)
                })
                .sum();
            [(hinge_m * length_m * base[0] + rest) / length_m, base[1]]
        })
        .collect()
}

/// Distances from the base and weights \[m\] of the points away from the base.
fn stations(length: f64, hinge: f64) -> Vec<[f64; 2]> {
    let gauss = |from: f64, points: &[[f64; 2]]| {
        let half = 0.5 * (length - from);
        points
            .iter()
            .flat_map(|[at, w]| [[from + half * (1.0 - at), w * half], [from + half * (1.0 + at), w * half]])
            .collect::<Vec<_>>()
    };
    if 4.0 * hinge > length {
        return gauss(
            hinge,
            &[
                [0.339_981_043_584_856_3, 0.652_145_154_862_546_1],
                [0.861_136_311_594_052_6, 0.347_854_845_137_453_9],
            ],
        );
    }
    let mut stations = gauss(4.0 * hinge, &[[1.0 / 3f64.sqrt(), 1.0]]);
    stations.insert(0, [8.0 / 3.0 * hinge, 3.0 * hinge]);
    stations
}

/// The points up to the peak whose moments exceed all before.
fn rising_part(curve: &[CurvePoint]) -> Vec<CurvePoint> {
    let mut rising: Vec<CurvePoint> = Vec::new();
    for point in curve {
        if rising.last().is_none_or(|last| point[1] > last[1]) {
            rising.push(*point);
        }
    }
    rising
}

/// Curvature \[1/m\] on the rising branch at a moment \[N m\]; below its beginning in proportion.
fn curvature_at(rising: &[CurvePoint], moment: f64) -> f64 {
    let k = rising.partition_point(|p| p[1] < moment);
    match (k.checked_sub(1).map(|b| rising[b]), rising.get(k)) {
        (Some(a), Some(b)) => between(a, *b, (moment - a[1]) / (b[1] - a[1]))[0],
        (None, Some(b)) if b[1] > 0.0 => b[0] * moment / b[1],
        (Some(a), None) => a[0],
        _ => 0.0,
    }
}

/// A point between two.
fn between(a: CurvePoint, b: CurvePoint, share: f64) -> CurvePoint {
    [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
}
