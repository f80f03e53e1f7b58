//! Rigid bodies on ideal joints: smooth motion with constraint forces, loops and redundant joints included.
//!
//! Coordinates are those of all bodies. The accelerations follow from the mass matrix `M`, the applied forces `f` and the constraint rows `G`:
//! `M a + Gᵀ λ = f`, `G a = γ`, solved by the Schur complement `S = G M⁻¹ Gᵀ`. Its pattern is that of the joints that share a body; it is
//! positive semidefinite, and rows that depend on others (redundant joints) show as vanishing pivots, whose forces are set to zero. Joint positions and velocities are kept
//! by a projection at the end of each step, with the factorisation that the next step begins with anyway.
//!
//! | file | owns |
//! |---|---|
//! | [`joint`] | kinds of joints and their constraint rows |
//! | [`force`] | springs, dampers, torques, hinges |
//! | [`hinge_law`] | how a hinge flows about one axis |
//! | [`turn`] | by how much bodies are turned against each other, revolutions counted |
//! | [`bushing`] | compliant connections |
//! | [`factor`] | the sparse block factorisation of `S` (`eliminate`: one block row of it, `pivots`: small pivots) |
//! | [`planar`] | which parts move in a plane, so that rows across it can be left out |
//! | [`motion`] | rows and accelerations at a state |
//! | `solve` | what joints add to accelerations; the projection |
//! | [`touch`] | contact |
//! | [`compile`] | from a model file |
//! | [`start`] | velocities at the start |
//! | [`run`] | a whole run of a model file: events, outputs, energy balance |
//! | [`survey`] | energies, reactions, the highest frequency |
//! | [`march`] | steps of Runge and Kutta and of the leapfrog (`method`: their coefficients) |
//! | `control` | lengths of steps: errors, events within them |

pub mod bushing;
pub mod compile;
mod control;
mod eliminate;
pub mod factor;
pub mod force;
pub mod hinge_law;
pub mod joint;
pub mod march;
mod method;
pub mod motion;
mod pivots;
pub mod planar;
pub mod run;
mod solve;
pub mod start;
pub mod survey;
pub mod touch;
pub mod turn;

use super::math::{M3, Q, V3};
use force::Force;
use hinge_law::HingeLaw;
use joint::Joint;
pub(super) use method::COARSE;

/// Index that stands for the ground.
pub const GROUND: usize = usize::MAX;

/// A rigid body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Inertia about the centre of mass in the body frame \[kg m²\].
    pub inertia_kg_m2: M3,
    /// Centre of mass \[m\].
    pub position_m: V3,
    /// Orientation (body to global).
    pub orientation: Q,
    /// Velocity of the centre of mass \[m/s\].
    pub velocity_m_s: V3,
    /// Angular velocity in the global frame \[rad/s\].
    pub angular_velocity_rad_s: V3,
}

impl Body {
    /// A body at rest whose axes are the global ones; principal moments of inertia.
    pub fn at_rest(mass_kg: f64, principal_kg_m2: V3, position_m: V3) -> Self {
        let [a, b, c] = principal_kg_m2;
        Self {
            mass_kg,
            inertia_kg_m2: [[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]],
            position_m,
            orientation: [1.0, 0.0, 0.0, 0.0],
            velocity_m_s: [0.0; 3],
            angular_velocity_rad_s: [0.0; 3],
        }
    }
}

/// Bodies, ideal joints and forces, in the pose in which the joints are assembled.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mechanism {
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Springs, dampers, torques.
    pub forces: Vec<Force>,
    /// Laws of hinges.
    pub laws: Vec<HingeLaw>,
    /// Compliant connections.
    pub bushings: Vec<bushing::Given>,
    /// Gravity \[m/s²\].
    pub gravity_m_s2: V3,
}
