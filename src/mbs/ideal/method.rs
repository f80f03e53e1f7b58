//! Methods: those of Runge and Kutta of fifth order (Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19-26) or, with hinges, of fourth; with hinges and a
//! large tolerance the leapfrog.

use super::Mechanism;
use super::force::Force;

/// A method whose last stage is the first of the next step.
#[derive(Debug)]
pub(super) struct Method {
    /// Coefficients of the stages; those of the last are the step itself.
    pub(super) stages: &'static [&'static [f64]],
    /// The step less that of the order below.
    pub(super) error: &'static [f64],
    /// What the interpolation within a step has beyond a cubic.
    pub(super) dense: &'static [f64],
    /// Order of the error estimate.
    pub(super) order: f64,
    /// Angle `ω h` of an undamped vibration up to which it is stable, with some room.
    pub(super) reach: f64,
}

/// Dormand and Prince; interpolation after Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, section II.6.
const FIFTH: Method = Method {
    stages: &[
        &[0.2],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0],
        &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0],
        &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
    ],
    error: &[
        71.0 / 57600.0,
        0.0,
        -71.0 / 16695.0,
        71.0 / 1920.0,
        -17253.0 / 339200.0,
        22.0 / 525.0,
        -1.0 / 40.0,
    ],
    dense: &[
        -12715105075.0 / 11282082432.0,
        0.0,
        87487479700.0 / 32700410799.0,
        -10690763975.0 / 1880347072.0,
        701980252875.0 / 199316789632.0,
        -1453857185.0 / 822651844.0,
        69997945.0 / 29380423.0,
    ],
    order: 5.0,
    reach: 1.0,
};

/// The classical method of fourth order. With the next step's first rate in the place of the last stage's the weights 1/6, 1/3, 1/3, 1/6 meet the conditions of third
/// order, hence the error estimate.
const FOURTH: Method = Method {
    stages: &[&[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0], &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0]],
    error: &[0.0, 0.0, 0.0, 1.0 / 6.0, -1.0 / 6.0],
    dense: &[],
    order: 4.0,
    reach: 2.7,
};

/// The leapfrog: positions by the rate at the start, velocities by the mean of both rates; one evaluation a step, stable up to `2 / ω`. Its error is that of the
/// position, `h² (a' - a) / 6`.
pub(super) const LEAPFROG: Method = Method { stages: &[&[]], error: &[], dense: &[], order: 3.0, reach: 1.9 };

/// Tolerance from which the leapfrog is taken.
pub(in crate::mbs) const COARSE: f64 = 1e-4;

impl Method {
    /// Whether it is one of mechanisms with hinges.
    pub(super) fn is_of_stiff(&self) -> bool {
        self.order < FIFTH.order
    }

    /// Whether it is the leapfrog.
    pub(super) fn is_leapfrog(&self) -> bool {
        self.error.is_empty()
    }
}

/// The method for a mechanism. Elastic hinges make fast vibrations that bound the step, and the fourth order bears `2.8 / ω` with four evaluations, the fifth `1.6 / ω`
/// with six; where only the error bounds it, the fifth needs fewer. The leapfrog bears `2 / ω` with one evaluation.
pub(super) fn method_for(mechanism: &Mechanism, tolerance: f64) -> &'static Method {
    let is_stiff =
        !mechanism.bushings.is_empty() || mechanism.forces.iter().any(|f| matches!(f, Force::Hinge { .. }));
    match is_stiff {
        true if tolerance >= COARSE => &LEAPFROG,
        true => &FOURTH,
        false => &FIFTH,
    }
}
