//! The resistance curve of a member end: bending moment against rotation under axial force.
//!
//! A curve is measured (or computed, [`crate::rc`]) as an envelope of moment over chord rotation for
//! several constant axial forces. For use in a hinge it is split into a linear elastic part of
//! stiffness `K` and a capacity `C(α, N)` over accumulated plastic rotation `α`:
//! `θ = M / K + θ_p`, `|M| <= C(α, N)`, `α̇ = |θ̇_p|`. Unloading follows `K`. A curve may say what cycles do to it ([`cyclic`]);
//! [`loops`] is a hinge that follows it.
//!
//! Sign conventions: axial force `N` is positive in **compression**. Units: rad, N m, N.

pub mod beam;
mod bearing;
pub mod between;
pub mod capacity;
pub mod cyclic;
pub mod cyclic_fit;
pub mod envelope;
pub mod hinge;
mod lever;
mod limits;
pub mod loops;
pub mod onset;
pub mod rate;
mod turning;

pub use beam::{BeamEnds, MiddleSprings, SpanLoad};
pub use capacity::{Capacity, CapacityHint, CapacityTable};
pub use cyclic::{Backbone, CyclicFit, CyclicRule, LevelBackbone};
pub use cyclic_fit::MeasuredExcursion;
pub use envelope::Envelope;
pub use hinge::{Hinge2, HingeStep};
pub use loops::CyclicHinge;
pub use rate::Rate;

use serde::{Deserialize, Serialize};

/// Resistance about one bending axis, odd-symmetric in the rotation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResistanceCurve {
    /// Elastic rotational stiffness `K` \[N m/rad\], also the stiffness of unloading.
    pub stiffness_nm_rad: f64,
    /// Capacity at increasing axial force; interpolated linearly in between, held constant outside ([`between`] says
    /// what this keeps).
    pub levels: Vec<CapacityLevel>,
    /// What cycles do to it; absent: nothing is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cyclic: Option<CyclicRule>,
}

/// Capacity at one constant axial force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapacityLevel {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[plastic rotation (rad), capacity (N m)]`, first rotation zero, rotations increasing.
    pub capacity: Vec<[f64; 2]>,
    /// Accumulated plastic rotation at which the section separates \[rad\].
    pub fracture_rotation_rad: f64,
}

/// What is wrong with a curve.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// The stiffness is not a positive number.
    #[error("stiffness_nm_rad is {0}, expected a positive number")]
    Stiffness(f64),
    /// No capacity level.
    #[error("levels is empty, expected at least one axial force")]
    NoLevel,
    /// Axial forces not increasing.
    #[error("levels[{level}].axial_force_n is {value}, expected a finite number above the previous level's")]
    AxialForce {
        /// Index of the level.
        level: usize,
        /// The value found \[N\].
        value: f64,
    },
    /// A point of the capacity is out of order, negative or not a number.
    #[error("levels[{level}].capacity[{point}] is [{rotation}, {moment}], expected {expected}")]
    Point {
        /// Index of the level.
        level: usize,
        /// Index of the point.
        point: usize,
        /// Plastic rotation found \[rad\].
        rotation: f64,
        /// Moment found \[N m\].
        moment: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A level has no capacity at all.
    #[error("levels[{level}].capacity is empty or zero throughout, expected a positive peak")]
    NoCapacity {
        /// Index of the level.
        level: usize,
    },
    /// The fracture rotation is not a positive number.
    #[error("levels[{level}].fracture_rotation_rad is {value}, expected a positive number")]
    Fracture {
        /// Index of the level.
        level: usize,
        /// The value found \[rad\].
        value: f64,
    },
    /// A number of the rule of degradation is out of its range.
    #[error("cyclic.{name} is {value}, expected {expected}")]
    Cyclic {
        /// Name of the number.
        name: &'static str,
        /// The value found.
        value: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A measured envelope cannot be split into an elastic and a plastic part.
    #[error("envelope {level}: {reason}")]
    Envelope {
        /// Index of the envelope.
        level: usize,
        /// What is missing.
        reason: String,
    },
}

impl ResistanceCurve {
    /// Checks order, signs and finiteness of every number.
    pub fn check(&self) -> Result<(), CurveError> {
        if !(self.stiffness_nm_rad > 0.0 && self.stiffness_nm_rad.is_finite()) {
            return Err(CurveError::Stiffness(self.stiffness_nm_rad));
        }
        if self.levels.is_empty() {
            return Err(CurveError::NoLevel);
        }
        let mut previous_force = f64::NEG_INFINITY;
        for (level, entry) in self.levels.iter().enumerate() {
            if !(entry.axial_force_n.is_finite() && entry.axial_force_n > previous_force) {
                return Err(CurveError::AxialForce { level, value: entry.axial_force_n });
            }
            previous_force = entry.axial_force_n;
            entry.check(level)?;
        }
        self.cyclic.as_ref().map_or(Ok(()), CyclicRule::check)
    }

    /// Largest capacity of any level \[N m\].
    pub fn peak_nm(&self) -> f64 {
        self.levels.iter().map(CapacityLevel::peak_nm).fold(0.0, f64::max)
    }
}

impl CapacityLevel {
    /// Multiplies its capacity.
    pub fn scale(&mut self, factor: f64) {
        self.capacity.iter_mut().for_each(|point| point[1] *= factor);
    }

    /// Largest capacity \[N m\].
    pub fn peak_nm(&self) -> f64 {
        self.capacity.iter().map(|point| point[1]).fold(0.0, f64::max)
    }

    /// Energy that a monotonic rotation dissipates up to fracture: the area under the capacity over
    /// plastic rotation \[J\].
    pub fn energy_j(&self) -> f64 {
        let end = self.fracture_rotation_rad;
        let mut energy = 0.0;
        for pair in self.capacity.windows(2) {
            let ([x0, c0], [x1, c1]) = (pair[0], pair[1]);
            if x0 >= end {
                break;
            }
            let stop = x1.min(end);
            let c_stop = c0 + (c1 - c0) * (stop - x0) / (x1 - x0);
            energy += 0.5 * (c0 + c_stop) * (stop - x0);
        }
        let last = self.capacity.last().copied().unwrap_or([0.0; 2]);
        energy + last[1] * (end - last[0]).max(0.0)
    }

    fn check(&self, level: usize) -> Result<(), CurveError> {
        let mut previous = f64::NEG_INFINITY;
        for (point, &[rotation, moment]) in self.capacity.iter().enumerate() {
            let fail = |expected| Err(CurveError::Point { level, point, rotation, moment, expected });
            if point == 0 && rotation != 0.0 {
                return fail("plastic rotation zero in the first point");
            }
            if !(rotation.is_finite() && rotation > previous) {
                return fail("increasing finite plastic rotations");
            }
            if !(moment.is_finite() && moment >= 0.0) {
                return fail("a finite moment of at least zero");
            }
            previous = rotation;
        }
        if self.peak_nm() <= 0.0 {
            return Err(CurveError::NoCapacity { level });
        }
        if !(self.fracture_rotation_rad > 0.0 && self.fracture_rotation_rad.is_finite()) {
            return Err(CurveError::Fracture { level, value: self.fracture_rotation_rad });
        }
        Ok(())
    }
}
