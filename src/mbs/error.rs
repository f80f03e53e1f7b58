//! Why a run stopped, with time, body and joint.

use super::ModelError;

/// Share of the stability limit that is told as usable: what is below the limit in all poses that a run may come to, and as a number of three digits.
const USABLE: f64 = 0.95;

impl SolveError {
    /// That a given step is above a limit, of which the smallest one of the whole run is known \[s\].
    pub fn time_step(given_s: f64, limit_s: f64, smallest_s: f64) -> Self {
        Self::TimeStep { given_s, limit_s, usable_s: USABLE * smallest_s }
    }
}

/// Why a run stopped.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// The model is wrong.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A curve cannot be compiled.
    #[error(transparent)]
    Curve(#[from] crate::curve::CurveError),
    /// The structure is a mechanism.
    #[error(
        "no static equilibrium: the structure is a mechanism, body \"{body}\" moves most freely (joints: {joints}); a contact holds nothing in a static state: give it a joint or a support, or a run without preload"
    )]
    Mechanism {
        /// The loosest body.
        body: String,
        /// Its joints.
        joints: String,
    },
    /// The preload did not converge.
    #[error(
        "no static equilibrium found: the nearest state leaves {residual:.1e} of the weight at body \"{body}\"; the dead load exceeds what the hinges carry, or the structure buckles"
    )]
    Preload {
        /// Body with the largest residual.
        body: String,
        /// Residual relative to the weight.
        residual: f64,
    },
    /// The given step is unstable.
    #[error(
        "settings.time_step_s (or --step) is {given_s:.3e}, above the stability limit {limit_s:.3e} s of the joints; give at most {usable_s:.2e} s, or leave it out to have it chosen"
    )]
    TimeStep {
        /// The step given \[s\].
        given_s: f64,
        /// The limit \[s\].
        limit_s: f64,
        /// A step that holds for the whole run \[s\].
        usable_s: f64,
    },
    /// The run would take too many steps between two outputs.
    #[error(
        "settings.output_interval_s is {interval_s:.3e} s, more steps of {step_s:.1e} s than a run may have; give a shorter one, in seconds"
    )]
    LongInterval {
        /// The step \[s\].
        step_s: f64,
        /// The interval \[s\].
        interval_s: f64,
    },
    /// The run would take too many steps.
    #[error(
        "the step {step_s:.3e} s is too small for an output interval of {interval_s:.3e} s: bushing \"{bushing}\" is too stiff for its bodies, which swing at {highest_rad_s:.3e} rad/s on it; look at its stiffnesses (N/m, N m/rad), its place and their masses, or hold them by an ideal joint"
    )]
    TooManySteps {
        /// The stiffest bushing, and the frequency of its bodies on it alone \[rad/s\].
        bushing: String,
        /// See above.
        highest_rad_s: f64,
        /// The step \[s\].
        step_s: f64,
        /// The interval \[s\].
        interval_s: f64,
    },
    /// Smooth motion cannot go on.
    #[error("{error} (longest step so far {longest_s:.1e} s)")]
    March {
        /// Why.
        error: super::ideal::march::MarchError,
        /// The longest step \[s\].
        longest_s: f64,
    },
    /// A state is not a number.
    #[error("at t = {time_s:.6} s the state of body \"{body}\" is not a number (joints: {joints})")]
    NotANumber {
        /// When \[s\].
        time_s: f64,
        /// Where.
        body: String,
        /// Its joints.
        joints: String,
    },
    /// Bodies are in each other.
    #[error(
        "at t = {time_s:.6} s body \"{a}\" is {depth_m:.4} m inside \"{b}\", half of the thinner one: the mass ratio of bodies in contact is too large, or the step too long; a smaller settings.time_step_s may help (now {step_s:.3e})"
    )]
    Penetration {
        /// When \[s\].
        time_s: f64,
        /// First body.
        a: String,
        /// What it is in.
        b: String,
        /// How far \[m\].
        depth_m: f64,
        /// The step \[s\].
        step_s: f64,
    },
    /// The energy balance is off.
    #[error(
        "at t = {time_s:.6} s the energy error is {error:.3}, above {limit}; fastest body \"{body}\" at {speed_m_s:.2} m/s, most stressed joint \"{joint}\"; a smaller settings.time_step_s may help (now {step_s:.3e})"
    )]
    Energy {
        /// When \[s\].
        time_s: f64,
        /// Relative error.
        error: f64,
        /// Its limit.
        limit: f64,
        /// The fastest body.
        body: String,
        /// Its speed \[m/s\].
        speed_m_s: f64,
        /// The joint with the most elastic energy.
        joint: String,
        /// The step \[s\].
        step_s: f64,
    },
    /// The energy balance is off where joints stop motions again and again.
    #[error(
        "at t = {time_s:.6} s the energy error is {error:.3}, above {limit}: joints have stopped a motion {times} times, which they allow at first order only in a singular pose (bars in one line between two pins, say); leave a joint out, or move a point of one out of the line (fastest body \"{body}\", joints: {joints})"
    )]
    Locked {
        /// When \[s\].
        time_s: f64,
        /// Relative error.
        error: f64,
        /// Its limit.
        limit: f64,
        /// How often joints have stopped a motion.
        times: usize,
        /// The fastest body.
        body: String,
        /// Its joints.
        joints: String,
    },
    /// Contacts make energy.
    #[error(
        "at t = {time_s:.6} s contacts have made {made_j:.2e} J, {share:.3} of the energy turned over, above {limit}: bodies are jammed between contacts and joints, and the impulses on them do not settle (a smaller settings.tolerance or settings.time_step_s, now {step_s:.3e}, may help, or joints that yield)"
    )]
    ContactEnergy {
        /// When \[s\].
        time_s: f64,
        /// How much \[J\].
        made_j: f64,
        /// As a share of the energy turned over.
        share: f64,
        /// Its limit.
        limit: f64,
        /// The step \[s\].
        step_s: f64,
    },
}
