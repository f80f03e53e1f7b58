//! The rule of degradation that fits a cyclic test or run.

use super::cyclic::{Backbone, CyclicFit, CyclicRule};

/// What is known of one excursion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredExcursion {
    /// Sense of its moment: 1 or -1.
    pub sense: f64,
    /// Extreme rotation \[rad\], with its sign.
    pub rotation_rad: f64,
    /// Moment there \[N m\], with its sign.
    pub moment_nm: f64,
    /// Energy that it dissipated \[J\].
    pub energy_j: f64,
    /// Unloading stiffness behind it \[N m/rad\].
    pub unloading_nm_rad: Option<f64>,
}

/// Range of Λ that is searched \[rad\]; at its end the rule does next to nothing.
const REFERENCE_RAD: [f64; 2] = [0.02, 200.0];
/// Points of the search, even in the logarithm.
const SEARCH: u32 = 400;
/// Exponent of the energies in a fitted rule.
const ENERGY_EXPONENT: f64 = 1.0;

/// Fits Λ so that the rule has the strengths of the excursions at their turning points, relative to the backbone, with the energies of the
/// excursions themselves; and the exponent of the unloading stiffness. Excursions that stay within the elastic line, or turn on the side of the other sense, say
/// nothing of either. `None` without one that does.
pub fn fit(
    excursions: &[MeasuredExcursion],
    backbone: &impl Backbone,
    yield_rotation_rad: f64,
    axial_force_n: f64,
) -> Option<CyclicRule> {
    let counts = |e: &&MeasuredExcursion| e.sense * e.rotation_rad > backbone.elastic_rad();
    let measured =
        |e: &MeasuredExcursion| e.sense * e.moment_nm / backbone.moment_nm(e.sense * e.rotation_rad);
    let number = excursions.iter().filter(counts).count();
    if number == 0 {
        return None;
    }
    let unloading_exponent = unloading_exponent(excursions, backbone, yield_rotation_rad);
    let mut rule = CyclicRule {
        strength_reference_rad: REFERENCE_RAD[1],
        unloading_reference_rad: None,
        energy_exponent: ENERGY_EXPONENT,
        yield_rotation_rad,
        unloading_exponent,
        fit: None,
    };
    let misfit = |rule: &CyclicRule| -> f64 {
        let strengths = strengths(rule, backbone.peak_nm(), excursions);
        let pairs = excursions.iter().zip(&strengths).filter(|(e, _)| counts(e));
        let sum: f64 = pairs.map(|(e, s)| (s - measured(e)) * (s - measured(e))).sum();
        (sum / number as f64).sqrt()
    };
    let [low, high] = REFERENCE_RAD.map(libm::log);
    let at = |i: u32| libm::exp(low + (high - low) * f64::from(i) / f64::from(SEARCH));
    let mut best = f64::INFINITY;
    for i in 0..=SEARCH {
        let tried = CyclicRule { strength_reference_rad: at(i), ..rule };
        let found = misfit(&tried);
        if found < best {
            (best, rule) = (found, tried);
        }
    }
    let stiffnesses = stiffnesses(excursions, backbone, yield_rotation_rad);
    let squares =
        stiffnesses.iter().map(|[x, y]| (y - unloading_exponent * x) * (y - unloading_exponent * x));
    rule.fit = Some(CyclicFit {
        axial_force_n,
        excursions: number as u32,
        strength_residual: best,
        unloading_residual: (squares.sum::<f64>() / stiffnesses.len().max(1) as f64).sqrt(),
        lowest_strength: excursions.iter().filter(counts).map(measured).fold(f64::INFINITY, f64::min),
    });
    Some(rule)
}

/// Strengths over the backbone that a rule gives each excursion.
pub fn strengths(rule: &CyclicRule, peak_nm: f64, excursions: &[MeasuredExcursion]) -> Vec<f64> {
    let (mut left, mut sum) = ([1.0; 2], 0.0);
    let mut before: Option<f64> = None;
    excursions
        .iter()
        .map(|e| {
            let side = usize::from(e.sense < 0.0);
            if let Some(energy) = before {
                sum += energy;
                left[side] *= rule.left(rule.strength_reference_rad, peak_nm, energy, sum);
            }
            before = Some(e.energy_j.max(0.0));
            left[side]
        })
        .collect()
}

/// `[ln(θ_max / θ_y), ln(K / K_u)]` of the excursions beyond the yield rotation.
fn stiffnesses(
    excursions: &[MeasuredExcursion],
    backbone: &impl Backbone,
    yield_rotation_rad: f64,
) -> Vec<[f64; 2]> {
    let mut reached: f64 = 0.0;
    let mut points = Vec::new();
    for e in excursions {
        reached = reached.max(e.rotation_rad.abs());
        if let Some(unloading) = e.unloading_nm_rad.filter(|_| reached > yield_rotation_rad) {
            points.push([
                libm::log(reached / yield_rotation_rad),
                libm::log(backbone.stiffness_nm_rad() / unloading),
            ]);
        }
    }
    points
}

/// Least squares through the origin, within the range of the rule.
fn unloading_exponent(
    excursions: &[MeasuredExcursion],
    backbone: &impl Backbone,
    yield_rotation_rad: f64,
) -> f64 {
    let points = stiffnesses(excursions, backbone, yield_rotation_rad);
    let products: f64 = points.iter().map(|[x, y]| x * y).sum();
    let squares: f64 = points.iter().map(|[x, _]| x * x).sum();
    if squares > 0.0 { (products / squares).clamp(0.0, 1.0) } else { 0.0 }
}
