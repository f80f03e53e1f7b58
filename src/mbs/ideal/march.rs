//! Steps of Runge and Kutta with error control, of fifth order (Dormand and Prince, J. Comput. Appl. Math. 6 (1980) 19-26) or, with hinges, of fourth, with a projection
//! onto the joints at the end of each.
//!
//! The last of a step's evaluations is the first of the next one; its factorisation serves the projection as well. The evaluation belongs to the state before
//! the projection, which moves it by less than the error of the step.

use super::Mechanism;
use super::force::Force;
use super::motion::{Motion, STATE, quaternion_rate};

/// A method whose last stage is the first of the next step.
struct Method {
    /// Coefficients of the stages; those of the last are the step itself.
    stages: &'static [&'static [f64]],
    /// The step less that of the order below.
    error: &'static [f64],
    /// What the interpolation within a step has beyond a cubic.
    dense: &'static [f64],
    /// Order of the error estimate.
    order: f64,
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
};

/// The classical method of fourth order. With the next step's first rate in the place of the last stage's the weights 1/6, 1/3, 1/3, 1/6 meet the conditions of third
/// order, hence the error estimate.
const FOURTH: Method = Method {
    stages: &[&[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0], &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0]],
    error: &[0.0, 0.0, 0.0, 1.0 / 6.0, -1.0 / 6.0],
    dense: &[],
    order: 4.0,
};

/// The method for a mechanism. Elastic hinges make fast vibrations that bound the step, and the fourth order bears `2.8 / ω` with four evaluations, the fifth `1.6 / ω`
/// with six; where only the error bounds it, the fifth needs fewer.
fn method_for(mechanism: &Mechanism) -> &'static Method {
    let is_stiff = mechanism.forces.iter().any(|f| matches!(f, Force::Hinge { .. }));
    if is_stiff { &FOURTH } else { &FIFTH }
}

/// Limits of the change of a step, and the share of the step that the error would allow.
const CHANGE: [f64; 2] = [0.2, 5.0];
const CAUTION: f64 = 0.9;
/// Step within which a fracture is met \[s\].
const FRACTURE_S: f64 = 1e-5;
/// Powers of the errors of a step and of the one before it (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.2).
const PROPORTIONAL: f64 = 0.7;
const INTEGRAL: f64 = 0.4;
/// Smallest step over the whole time.
const LEAST: f64 = 1e-12;

/// What a run is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct March {
    /// Simulated time \[s\].
    pub end_s: f64,
    /// Error of a step: share of the size of each number, and at least this of 1 m, rad, m/s, rad/s.
    pub tolerance: f64,
    /// Interval of outputs \[s\].
    pub output_s: f64,
    /// Keep all rows of joints, also those across the plane of a plane motion.
    pub in_space: bool,
}

/// A run.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// States at the outputs, the start first; 13 numbers a body.
    pub states: Vec<Vec<f64>>,
    /// Steps taken, and steps that were tried and repeated.
    pub steps: [u64; 2],
    /// Constraint rows, and the most that were found dependent.
    pub rows: [usize; 2],
    /// Largest residual of a joint at the end of a step, before the projection.
    pub residual: f64,
    /// Largest change of kinetic and potential energy less the work of applied forces \[J\].
    pub energy_change_j: f64,
    /// Times at which hinges fractured \[s\], one for each.
    pub fractures_s: Vec<f64>,
}

/// Why a run stopped.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MarchError {
    /// The step would have to be too small.
    #[error(
        "at {time_s:.6} s the step would have to be smaller than {step_s:.1e} s: a singular pose, or a force that jumps; use a larger tolerance"
    )]
    Step {
        /// Time \[s\].
        time_s: f64,
        /// Step \[s\].
        step_s: f64,
    },
    /// Numbers that are not finite.
    #[error("not finite at {time_s:.6} s")]
    NotFinite {
        /// Time \[s\].
        time_s: f64,
    },
}

/// Runs a mechanism.
///
/// # Errors
/// If no step meets the tolerance.
pub fn march(mechanism: &Mechanism, wanted: &March) -> Result<Course, MarchError> {
    let mut motion = Motion::of(mechanism, wanted.in_space);
    let mut state = Motion::state(mechanism);
    let count = state.len();
    let method = method_for(mechanism);
    let last = method.stages.len();
    let mut k = vec![vec![0.0; count]; last + 1];
    // each stage in turn, the last of which is the next state
    let mut next = vec![0.0; count];
    motion.take(&state);
    motion.project(&mut state);
    let start_j = motion.balance_j(&state);
    rate(&mut motion, &state, &mut k[0]);
    let mut course = Course {
        states: vec![state.clone()],
        steps: [0; 2],
        rows: [motion.constraints(), motion.dependent()],
        residual: 0.0,
        energy_change_j: 0.0,
        fractures_s: Vec::new(),
    };
    let (mut time, mut step) = (0.0, first_step(&state, &k[0], wanted));
    let (mut before, mut repeated) = (1.0_f64, false);
    while time < wanted.end_s {
        step = step.min(wanted.end_s - time);
        if step < LEAST * wanted.end_s {
            if wanted.end_s - time <= LEAST * wanted.end_s {
                break;
            }
            return Err(MarchError::Step { time_s: time, step_s: step });
        }
        for (s, weights) in method.stages.iter().enumerate() {
            combine(&state, &k, weights, step, &mut next);
            motion.take(&next);
            rate(&mut motion, &next, &mut k[s + 1]);
        }
        let error = error([&state, &next], &k, step, wanted.tolerance, method);
        if !error.is_finite() {
            // a step too far into a singular pose; a smaller one stays before it
            course.steps[1] += 1;
            step *= CHANGE[0];
            if step < LEAST * wanted.end_s {
                return Err(MarchError::NotFinite { time_s: time });
            }
            continue;
        }
        let sized = error.max(1e-10);
        if error > 1.0 {
            course.steps[1] += 1;
            step *= (CAUTION * sized.powf(-1.0 / method.order)).clamp(CHANGE[0], 1.0);
            repeated = true;
            continue;
        }
        // with the error of the step before, so that steps settle at a bound of stability instead of trying it again and again
        let by_both = sized.powf(-PROPORTIONAL / method.order) * before.powf(INTEGRAL / method.order);
        let change = (CAUTION * by_both).clamp(CHANGE[0], if repeated { 1.0 } else { CHANGE[1] });
        // a fracture is met by halving the step that passes it
        let breaks = motion.beyond().is_some_and(|beyond| beyond >= 0.0);
        if breaks && step > FRACTURE_S {
            course.steps[1] += 1;
            step *= 0.5;
            continue;
        }
        course.steps[0] += 1;
        (before, repeated) = (sized, false);
        course.residual = course.residual.max(motion.residual());
        course.rows[1] = course.rows[1].max(motion.dependent());
        outputs(&mut course, [time, step], [&state, &next], &k, wanted, method);
        course.energy_change_j = course.energy_change_j.max((motion.balance_j(&next) - start_j).abs());
        motion.project(&mut next);
        state.copy_from_slice(&next);
        k.swap(0, last);
        time += step;
        step *= change;
        let opened = motion.commit();
        if opened > 0 {
            course.fractures_s.extend(std::iter::repeat_n(time, opened));
            motion.take(&state);
            rate(&mut motion, &state, &mut k[0]);
        }
    }
    Ok(course)
}

/// The rate of a state that was taken; orientations are those of the state itself, which a stage leaves without unit length.
fn rate(motion: &mut Motion, state: &[f64], rate: &mut [f64]) {
    motion.rate(rate);
    for (r, s) in rate.chunks_exact_mut(STATE).zip(state.chunks_exact(STATE)) {
        let q = quaternion_rate([s[3], s[4], s[5], s[6]], [s[10], s[11], s[12]]);
        r[3..7].copy_from_slice(&q);
    }
}

/// `state + step Σ a_i k_i`.
fn combine(state: &[f64], k: &[Vec<f64>], a: &[f64], step: f64, out: &mut [f64]) {
    out.copy_from_slice(state);
    for (k, a) in k.iter().zip(a).filter(|(_, a)| **a != 0.0) {
        for (o, k) in out.iter_mut().zip(k) {
            *o += step * a * k;
        }
    }
}

/// Largest estimated error of a step over what is allowed.
fn error([state, next]: [&[f64]; 2], k: &[Vec<f64>], step: f64, tolerance: f64, method: &Method) -> f64 {
    let mut largest: f64 = 0.0;
    for (i, (a, b)) in state.iter().zip(next).enumerate() {
        let sum: f64 = k.iter().zip(method.error).map(|(k, e)| e * k[i]).sum();
        let share = (step * sum).abs() / (tolerance * (1.0 + a.abs().max(b.abs())));
        if share.is_nan() {
            return f64::NAN;
        }
        largest = largest.max(share);
    }
    largest
}

/// A first step from the size of the rates.
fn first_step(state: &[f64], rate: &[f64], wanted: &March) -> f64 {
    let size = |v: &f64| 1.0 + v.abs();
    let fastest = state.iter().zip(rate).map(|(s, r)| r.abs() / size(s)).fold(0.0, f64::max);
    let step = 0.1 * wanted.tolerance.powf(0.2) / fastest.max(1e-3);
    step.min(wanted.end_s)
}

/// States at the outputs within a step.
fn outputs(
    course: &mut Course,
    [time, step]: [f64; 2],
    [state, next]: [&[f64]; 2],
    k: &[Vec<f64>],
    wanted: &March,
    method: &Method,
) {
    loop {
        let at = course.states.len() as f64 * wanted.output_s;
        let reached = time + step;
        if at > reached + 1e-12 * wanted.end_s || at > wanted.end_s * (1.0 + 1e-12) {
            return;
        }
        let s = ((at - time) / step).min(1.0);
        let between = (0..state.len()).map(|i| {
            let whole = next[i] - state[i];
            let early = step * k[0][i] - whole;
            let late = whole - step * k[k.len() - 1][i] - early;
            let dense: f64 = k.iter().zip(method.dense).map(|(k, d)| d * k[i]).sum();
            state[i] + s * (whole + (1.0 - s) * (early + s * (late + (1.0 - s) * step * dense)))
        });
        course.states.push(between.collect());
    }
}

#[cfg(test)]
mod tests {
    use super::super::joint::{Joint, Kind};
    use super::super::{Body, GROUND};
    use super::*;
    use crate::mbs::math::V3;

    /// A double pendulum about an axis across gravity, each joint `twice` or once.
    fn pendulum(axis: V3, twice: bool) -> Mechanism {
        let mut joints = Vec::new();
        for _ in 0..=usize::from(twice) {
            joints.push(Joint::at(Kind::Revolute, [GROUND, 0], [0.0; 3], axis));
            joints.push(Joint::at(Kind::Revolute, [0, 1], [1.0, 0.0, 0.0], axis));
        }
        Mechanism {
            bodies: vec![
                Body::at_rest(2.0, [0.1, 0.2, 0.3], [0.5, 0.0, 0.0]),
                Body::at_rest(1.0, [0.1, 0.2, 0.3], [1.3, 0.0, 0.0]),
            ],
            joints,
            gravity_m_s2: [0.0, 0.0, -9.81],
            ..Mechanism::default()
        }
    }

    fn run(mechanism: &Mechanism, tolerance: f64, in_space: bool) -> Course {
        march(mechanism, &March { end_s: 2.0, tolerance, output_s: 0.5, in_space }).unwrap()
    }

    /// Largest distance of the bodies' centres at the end.
    fn apart(a: &Course, b: &Course) -> f64 {
        let (a, b) = (&a.states[4], &b.states[4]);
        let body =
            |i: usize| (0..3).map(|k| (a[STATE * i + k] - b[STATE * i + k]).powi(2)).sum::<f64>().sqrt();
        body(0).max(body(1))
    }

    #[test]
    fn neither_rows_across_the_plane_nor_joints_twice_change_the_motion() {
        let y = [0.0, 1.0, 0.0];
        let plane = run(&pendulum(y, false), 1e-10, false);
        let space = run(&pendulum(y, false), 1e-10, true);
        let twice = run(&pendulum(y, true), 1e-10, true);
        assert_eq!((plane.rows, space.rows, twice.rows), ([4, 0], [10, 0], [20, 10]));
        assert!(apart(&plane, &space) < 1e-8 && apart(&plane, &twice) < 1e-8);
        assert!(plane.energy_change_j < 1e-7, "{}", plane.energy_change_j);
    }

    #[test]
    fn the_error_follows_the_tolerance() {
        let y = [0.0, 1.0, 0.0];
        let best = run(&pendulum(y, false), 1e-12, false);
        let [coarse, fine] = [1e-5, 1e-8].map(|tolerance| run(&pendulum(y, false), tolerance, false));
        let (far, near) = (apart(&coarse, &best), apart(&fine, &best));
        assert!(far < 1e-2 && near < 1e-5 && near < 0.01 * far, "{far} {near}");
        // fifth order: a thousandth of the error for four times the steps
        let ratio = fine.steps[0] as f64 / coarse.steps[0] as f64;
        assert!((3.0..6.0).contains(&ratio), "{:?} {:?}", coarse.steps, fine.steps);
    }

    #[test]
    fn a_force_that_is_not_finite_stops_the_run() {
        let mut mad = pendulum([0.0, 1.0, 0.0], false);
        mad.gravity_m_s2[2] = f64::NAN;
        let wanted = March { end_s: 1.0, tolerance: 1e-6, output_s: 0.5, in_space: true };
        assert!(matches!(march(&mad, &wanted), Err(MarchError::NotFinite { .. })));
    }
}
