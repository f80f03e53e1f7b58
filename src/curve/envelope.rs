//! From measured envelopes of moment over rotation to a resistance curve.
//!
//! The elastic stiffness is the secant from the origin to half of the peak moment, the usual choice
//! for reinforced concrete, whose first cracks come long before (cf. EN 1992-1-1 5.8.7: stiffness of the
//! cracked section). One stiffness serves all axial forces: the largest of the secants, because a smaller
//! one would make the plastic rotation `θ_p = θ - M/K` of the stiffest level negative. Levels of
//! smaller stiffness start with a short plateau at half of their peak instead.

use super::{CapacityLevel, CurveError, ResistanceCurve};

/// Fraction of the peak below which the section counts as separated.
pub const FRACTURE_FRACTION: f64 = 0.05;
/// Fraction of the peak moment to which the elastic secant is drawn.
pub const SECANT_FRACTION: f64 = 0.5;

/// A monotonic envelope at one axial force.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[rotation (rad), moment (N m)]` from the origin, rotations increasing.
    pub points: Vec<[f64; 2]>,
}

impl ResistanceCurve {
    /// Splits measured envelopes into elastic stiffness and capacity over plastic rotation.
    ///
    /// The softening branch is kept; the fracture rotation is the plastic rotation at which the moment
    /// has fallen below [`FRACTURE_FRACTION`] of the peak, and the capacity is led to zero there. An envelope that
    /// ends at a higher moment fractures where it ends: nothing is known beyond.
    pub fn from_envelopes(envelopes: &[Envelope]) -> Result<Self, CurveError> {
        if envelopes.is_empty() {
            return Err(CurveError::NoLevel);
        }
        let mut stiffness: f64 = 0.0;
        for (level, envelope) in envelopes.iter().enumerate() {
            stiffness = stiffness.max(envelope.secant(level)?.0);
        }
        let levels = envelopes
            .iter()
            .enumerate()
            .map(|(level, envelope)| envelope.level(level, stiffness))
            .collect::<Result<Vec<_>, _>>()?;
        let curve = Self { stiffness_nm_rad: stiffness, levels, cyclic: None };
        curve.check()?;
        Ok(curve)
    }
}

impl Envelope {
    fn error(level: usize, reason: impl Into<String>) -> CurveError {
        CurveError::Envelope { level, reason: reason.into() }
    }

    /// Secant stiffness to half of the peak, and that moment.
    fn secant(&self, level: usize) -> Result<(f64, f64), CurveError> {
        let mut previous = -1e-300;
        for (i, &[rotation, moment]) in self.points.iter().enumerate() {
            if !(rotation.is_finite() && moment.is_finite() && rotation > previous) {
                return Err(Self::error(
                    level,
                    format!(
                        "point {i} is [{rotation}, {moment}], expected finite, increasing rotations from zero"
                    ),
                ));
            }
            previous = rotation;
        }
        let peak = self.points.iter().map(|p| p[1]).fold(0.0, f64::max);
        if peak <= 0.0 {
            return Err(Self::error(level, "no positive moment"));
        }
        let half = SECANT_FRACTION * peak;
        let mut before = [0.0, 0.0];
        for &point in &self.points {
            if point[1] >= half {
                let share =
                    if point[1] > before[1] { (half - before[1]) / (point[1] - before[1]) } else { 1.0 };
                let rotation = before[0] + share * (point[0] - before[0]);
                if rotation <= 0.0 {
                    return Err(Self::error(level, "half of the peak is reached at zero rotation"));
                }
                return Ok((half / rotation, half));
            }
            before = point;
        }
        Err(Self::error(level, "half of the peak is never reached"))
    }

    /// Capacity over plastic rotation for a given elastic stiffness.
    fn level(&self, level: usize, stiffness: f64) -> Result<CapacityLevel, CurveError> {
        let (_, half) = self.secant(level)?;
        let peak = half / SECANT_FRACTION;
        let floor = FRACTURE_FRACTION * peak;
        let first = self.points.iter().position(|p| p[1] >= half).unwrap_or(0);
        let mut capacity = vec![[0.0, half]];
        let mut peaked = false;
        let mut fracture = None;
        for &[rotation, moment] in &self.points[first..] {
            let moment = moment.max(0.0);
            let plastic = rotation - moment / stiffness;
            let [last_plastic, last_moment] = capacity[capacity.len() - 1];
            if plastic <= last_plastic + 1e-12 {
                // Stiffer than the chosen elastic line: no plastic rotation yet.
                if moment > last_moment
                    && let Some(last) = capacity.last_mut()
                {
                    last[1] = moment;
                }
                continue;
            }
            peaked |= moment >= 0.999 * peak;
            if peaked && moment < floor {
                let share = (last_moment - floor) / (last_moment - moment);
                let at = last_plastic + share * (plastic - last_plastic);
                capacity.push([at, floor]);
                capacity.push([at + 1e-6_f64.max(1e-3 * at), 0.0]);
                fracture = Some(at);
                break;
            }
            capacity.push([plastic, moment]);
        }
        let end = capacity[capacity.len() - 1][0];
        if end <= 0.0 {
            return Err(Self::error(level, "no plastic rotation: the envelope ends on its elastic line"));
        }
        Ok(CapacityLevel {
            axial_force_n: self.axial_force_n,
            capacity,
            fracture_rotation_rad: fracture.unwrap_or(end),
        })
    }
}
