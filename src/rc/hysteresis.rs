//! What a history of rotation and moment says: excursions between zero moments, cycles of two of them, envelopes of both senses.
//!
//! Between two zeros of the moment no elastic energy of the hinge is left over, so the area `∮ M dθ` is what was dissipated.

use super::series::Figures;
use crate::curve::{Envelope, LevelBackbone, MeasuredExcursion, ResistanceCurve, cyclic_fit};
use serde::Serialize;
use std::f64::consts::PI;

/// Shares of the moment at the turning point between which the unloading stiffness is a secant.
pub const UNLOADING_SHARES: [f64; 2] = [0.8, 0.3];

/// A history: `[rotation (rad), moment (N m), shortening (m)]` under a constant axial force.
#[derive(Debug, Clone, Copy)]
pub struct History<'a> {
    /// Points in the order of time.
    pub points: &'a [[f64; 3]],
    /// Index of the first point behind each turning point of the rotation, as in [`super::bend::Bent::turned_at`].
    pub turned_at: &'a [usize],
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Length to the point of zero moment \[m\].
    pub length_m: f64,
}

/// The way between two zeros of the moment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Excursion {
    /// Sense of its moment: 1 or -1.
    pub sense: f64,
    /// Rotations at which the moment is zero before and behind it \[rad\]; the last one may end before.
    pub zero_rad: [f64; 2],
    /// `∮ M dθ` over it \[J\].
    pub energy_j: f64,
    /// Work of the axial force on the shortening during it \[J\].
    pub axial_work_j: f64,
    /// Largest moment, with its sense \[N m\], and the rotation there \[rad\].
    pub peak: [f64; 2],
    /// Rotation and moment where it turns: at its extreme rotation \[rad, N m\].
    pub turn: [f64; 2],
    /// Secant between [`UNLOADING_SHARES`] of the moment at the turn, behind it \[N m/rad\]; `None` if it did not get there.
    pub unloading_nm_rad: Option<f64>,
    /// Whether it came back to zero moment.
    pub is_complete: bool,
}

/// A positive excursion and the negative one behind it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cycle {
    /// Extreme rotations, positive and negative \[rad\].
    pub amplitude_rad: [f64; 2],
    /// Largest moments, positive and negative \[N m\].
    pub peak_nm: [f64; 2],
    /// `∮ M dθ` \[J\].
    pub energy_j: f64,
    /// Work of the axial force on the shortening \[J\].
    pub axial_work_j: f64,
    /// Slope between the two turns \[N m/rad\].
    pub secant_nm_rad: f64,
    /// Unloading stiffness behind the positive and the negative turn \[N m/rad\].
    pub unloading_nm_rad: [Option<f64>; 2],
    /// Equivalent viscous damping ratio, `E / (2 π K θ²)` with the secant and the mean amplitude (Jacobsen 1930; Chopra, Dynamics of Structures, 3.9).
    pub damping_ratio: f64,
}

/// All of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hysteresis {
    /// Excursions in the order of time.
    pub excursions: Vec<Excursion>,
    /// Cycles in the order of time.
    pub cycles: Vec<Cycle>,
    /// Points at which the rotation was larger than ever before in its sense, `[rotation (rad), moment (N m), shortening (m)]`, positive and negative.
    pub envelopes: [Vec<[f64; 3]>; 2],
    /// Sum of the excursions' energies \[J\].
    pub energy_j: f64,
}

/// Lateral force `V = (M - N θ L) / L` that goes with a rotation and a moment \[N\].
pub fn lateral_n(rotation_rad: f64, moment_nm: f64, axial_n: f64, length_m: f64) -> f64 {
    moment_nm / length_m - axial_n * rotation_rad
}

impl Hysteresis {
    /// Evaluates a history.
    pub fn of(history: &History) -> Self {
        let excursions: Vec<Excursion> = history.parts().iter().map(|part| history.excursion(part)).collect();
        let cycles =
            excursions.windows(2).filter(|w| w[0].sense > 0.0).map(|w| Cycle::of(&w[0], &w[1])).collect();
        let energy_j = excursions.iter().map(|e| e.energy_j).sum();
        Self { cycles, envelopes: [1.0, -1.0].map(|sense| history.envelope(sense)), energy_j, excursions }
    }
}

impl Hysteresis {
    /// The curve of a monotonic bend under the same axial force, with the rule of degradation that fits these cycles.
    ///
    /// # Errors
    /// If the bend makes no curve, or no excursion goes beyond its elastic line.
    pub fn curve(&self, monotonic: &[[f64; 3]], axial_n: f64) -> Result<ResistanceCurve, String> {
        let history = History { points: monotonic, turned_at: &[], axial_n, length_m: 1.0 };
        let points = history.envelope(1.0).iter().map(|p| [p[0], p[1]]).collect();
        let mut curve = ResistanceCurve::from_envelopes(&[Envelope { axial_force_n: axial_n, points }])
            .map_err(|e| e.to_string())?;
        let figures = Figures::of(monotonic).ok_or("the monotonic bend has no peak")?;
        let backbone = LevelBackbone::of(&curve, axial_n);
        let rule = cyclic_fit::fit(&self.measured(), &backbone, figures.yield_rotation_rad, axial_n);
        curve.cyclic = Some(rule.ok_or("no cycle goes beyond the elastic line")?);
        Ok(curve)
    }

    /// The excursions as the fit of a rule takes them.
    pub fn measured(&self) -> Vec<MeasuredExcursion> {
        let one = |e: &Excursion| MeasuredExcursion {
            sense: e.sense,
            rotation_rad: e.turn[0],
            moment_nm: e.turn[1],
            energy_j: e.energy_j,
            unloading_nm_rad: e.unloading_nm_rad,
        };
        self.excursions.iter().filter(|e| e.is_complete).map(one).collect()
    }
}

/// A stretch of points of one sense, with the points of zero moment at its ends.
struct Part {
    sense: f64,
    points: Vec<[f64; 3]>,
    is_complete: bool,
}

impl History<'_> {
    /// The stretches between zeros of the moment. Between two turning points the moment changes its sign once, at the last zero on that way
    /// (shocks of closing cracks make more of them); a way that does not change it belongs to the stretch before.
    fn parts(&self) -> Vec<Part> {
        let points = self.points;
        let mut parts: Vec<Part> = Vec::new();
        let mut begin: (usize, [f64; 3]) = (0, points.first().copied().unwrap_or_default());
        let mut sense = 0.0;
        let ends = self.turned_at.iter().copied().chain([points.len()]);
        let mut from = 0;
        for end in ends {
            let way = from.max(1) - 1..end;
            from = end;
            let along = match (points.get(way.start), points.get(end.max(1) - 1)) {
                (Some(a), Some(b)) if a[0] != b[0] => (b[0] - a[0]).signum(),
                _ => continue,
            };
            if sense == 0.0 {
                sense = along;
                continue;
            }
            let Some(last) = way.rev().find(|i| along * points[*i][1] <= 0.0) else { continue };
            if along == sense || last + 1 >= end {
                continue;
            }
            let zero = zero(points[last], points[last + 1]);
            parts.push(part(sense, begin, &points[begin.0..=last], Some(zero)));
            (begin, sense) = ((last + 1, zero), along);
        }
        if sense != 0.0 {
            parts.push(part(sense, begin, &points[begin.0..], None));
        }
        parts
    }

    fn excursion(&self, part: &Part) -> Excursion {
        let (points, sense) = (&part.points, part.sense);
        let (first, last) = (points[0], points[points.len() - 1]);
        let energy_j = points.windows(2).map(|w| 0.5 * (w[0][1] + w[1][1]) * (w[1][0] - w[0][0])).sum();
        let most = |of: usize| {
            let larger =
                |a: usize, b: usize| if sense * points[b][of] > sense * points[a][of] { b } else { a };
            (0..points.len()).reduce(larger).unwrap_or(0)
        };
        let (peak, turn) = (points[most(1)], most(0));
        Excursion {
            sense,
            zero_rad: [first[0], last[0]],
            energy_j,
            axial_work_j: self.axial_n * (last[2] - first[2]),
            peak: [peak[1], peak[0]],
            turn: [points[turn][0], points[turn][1]],
            unloading_nm_rad: unloading(&points[turn..], sense),
            is_complete: part.is_complete,
        }
    }

    fn envelope(&self, sense: f64) -> Vec<[f64; 3]> {
        let mut reached = 0.0;
        let mut envelope = vec![[0.0; 3]];
        for point in self.points {
            if sense * point[0] > reached {
                reached = sense * point[0];
                envelope.push(*point);
            }
        }
        envelope
    }
}

fn part(sense: f64, begin: (usize, [f64; 3]), own: &[[f64; 3]], end: Option<[f64; 3]>) -> Part {
    let mut points = vec![begin.1];
    points.extend(own);
    points.extend(end);
    Part { sense, points, is_complete: end.is_some() }
}

/// The point of zero moment between two points of different sign.
fn zero(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let share = if a[1] == b[1] { 0.0 } else { a[1] / (a[1] - b[1]) };
    [a[0] + share * (b[0] - a[0]), 0.0, a[2] + share * (b[2] - a[2])]
}

/// Secant stiffness between shares of the first point's moment.
fn unloading(points: &[[f64; 3]], sense: f64) -> Option<f64> {
    let moment = sense * points[0][1];
    let passed = |share: f64| {
        let level = share * moment;
        let pair = points.windows(2).find(|w| sense * w[0][1] >= level && sense * w[1][1] < level)?;
        let part = (level - sense * pair[0][1]) / (sense * (pair[1][1] - pair[0][1]));
        Some(pair[0][0] + part * (pair[1][0] - pair[0][0]))
    };
    let [high, low] = UNLOADING_SHARES;
    let stiffness = (high - low) * moment / (sense * (passed(high)? - passed(low)?));
    (moment > 0.0 && stiffness > 0.0 && stiffness.is_finite()).then_some(stiffness)
}

impl Cycle {
    fn of(positive: &Excursion, negative: &Excursion) -> Self {
        let energy_j = positive.energy_j + negative.energy_j;
        let secant_nm_rad = (positive.turn[1] - negative.turn[1]) / (positive.turn[0] - negative.turn[0]);
        let amplitude = 0.5 * (positive.turn[0] - negative.turn[0]);
        Self {
            amplitude_rad: [positive.turn[0], negative.turn[0]],
            peak_nm: [positive.peak[0], negative.peak[0]],
            energy_j,
            axial_work_j: positive.axial_work_j + negative.axial_work_j,
            secant_nm_rad,
            unloading_nm_rad: [positive.unloading_nm_rad, negative.unloading_nm_rad],
            damping_ratio: energy_j / (2.0 * PI * secant_nm_rad * amplitude * amplitude),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Elastic and perfectly plastic: stiffness 1000, strength 10.
    fn elastic_plastic(turns: &[f64]) -> (Vec<[f64; 3]>, Vec<usize>) {
        let (mut at, mut plastic) = (0.0f64, 0.0f64);
        let (mut points, mut turned_at) = (vec![[0.0; 3]], Vec::new());
        for (i, turn) in turns.iter().enumerate() {
            if i > 0 {
                turned_at.push(points.len());
            }
            let steps = 400;
            let from = at;
            for i in 1..=steps {
                at = from + (turn - from) * f64::from(i) / f64::from(steps);
                let trial: f64 = 1000.0 * (at - plastic);
                let moment = trial.clamp(-10.0, 10.0);
                plastic = at - moment / 1000.0;
                points.push([at, moment, 0.001 * at.abs()]);
            }
        }
        (points, turned_at)
    }

    #[test]
    fn cycles_of_an_elastic_plastic_hinge_are_parallelograms() {
        let (points, turned_at) = elastic_plastic(&[0.03, -0.03, 0.03, -0.03, 0.0]);
        let found = Hysteresis::of(&History {
            points: &points,
            turned_at: &turned_at,
            axial_n: 100.0,
            length_m: 2.0,
        });
        assert_eq!((found.cycles.len(), found.excursions.len()), (2, 5));
        // from +0.03 to -0.03: plastic ways of 0.04 each
        let second = &found.cycles[1];
        assert!((second.energy_j - 2.0 * 0.04 * 10.0).abs() < 1e-3, "{}", second.energy_j);
        assert!((found.cycles[0].energy_j - (0.02 + 0.04) * 10.0).abs() < 1e-3);
        assert_eq!(second.amplitude_rad, [0.03, -0.03]);
        assert_eq!(second.peak_nm, [10.0, -10.0]);
        assert!((second.secant_nm_rad - 10.0 / 0.03).abs() < 1e-9);
        let [a, b] = second.unloading_nm_rad.map(Option::unwrap);
        assert!((a / 1000.0 - 1.0).abs() < 1e-9 && (b / 1000.0 - 1.0).abs() < 1e-9, "{a} {b}");
        assert!((second.damping_ratio - 0.8 / (2.0 * PI * 10.0 * 0.03)).abs() < 1e-4);
        assert!(second.axial_work_j.abs() < 1e-3);
        assert!(!found.excursions[4].is_complete);
        assert!((found.envelopes[0].last().unwrap()[0] - 0.03).abs() < 1e-12);
        assert!((found.envelopes[1].last().unwrap()[1] + 10.0).abs() < 1e-12);
        assert_eq!(lateral_n(0.01, 10.0, 100.0, 2.0), 4.0);
    }

    #[test]
    fn a_push_is_one_excursion_and_nothing_is_none() {
        let (points, turned_at) = elastic_plastic(&[0.03]);
        let found =
            Hysteresis::of(&History { points: &points, turned_at: &turned_at, axial_n: 0.0, length_m: 2.0 });
        assert_eq!((found.cycles.len(), found.excursions.len()), (0, 1));
        assert!((found.energy_j - 10.0 * 0.025).abs() < 1e-5);
        let none =
            Hysteresis::of(&History { points: &[[0.0; 3]], turned_at: &[], axial_n: 0.0, length_m: 2.0 });
        assert_eq!((none.excursions.len(), none.envelopes[0].len()), (0, 1));
    }
}
