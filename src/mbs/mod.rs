//! The multibody model (a documented file format) and its solver.
//!
//! | file | owns |
//! |---|---|
//! | [`model`] | the types of the model file |
//! | [`check`] | reading and checking a model file |
//! | [`math`] | vectors, quaternions |
//! | [`system`] | the compiled model: compact arrays of bodies and joints |
//! | [`joint`] | forces and energy of a compliant joint with its hinge law |
//! | `stance` | kinematics of a joint: where it is, and what its forces do to its bodies |
//! | `snap` | separation of a bushing within a step: when, and what that changes |
//! | `mid_beam` | a beam with hinges at its ends, as a joint in its middle |
//! | `tables` | capacities that joints use, each compiled once |
//! | `carry` | carry-over of moments between the ends of a member |
//! | `weight` | how much of its weight a span bears as its floor falls |
//! | `shared_mass` | inertial coupling of bodies as parts of one elastic body |
//! | `relative_mass` | selective mass scaling: inertia against relative motion, for longer steps |
//! | `block_solve` | solving with factors in blocks of six unknowns, as vector code |
//! | `joint_lanes`, `lanes` | joints, eight at a time; numbers of eight of a kind |
//! | [`frequency`] | the highest frequency, hence the time step |
//! | [`preload`] | static equilibrium before `t = 0` |
//! | [`contact`] | contact by impulses |
//! | [`step`] | the explicit integrator |
//! | [`latent`] | bodies that are one until a section between them gives way |
//! | [`sleep`] | islands at rest: who sleeps, what wakes |
//! | [`parameter`] | numbers of a model by name |
//! | [`batch`] | many runs of one model |
//! | [`run`] | the whole run: events, outputs |
//! | `balance` | energy balance: whether its sum holds and contacts only take |
//! | [`ideal`] | smooth motion on ideal joints |
//! | [`result`] | what a run returns |
//! | [`error`] | why a run stopped |

mod balance;
pub mod batch;
mod block_solve;
mod carry;
pub mod check;
pub mod contact;
pub mod error;
pub mod frequency;
pub mod ideal;
pub mod joint;
mod joint_lanes;
mod lanes;
pub mod latent;
pub mod math;
mod mid_beam;
pub mod model;
pub mod parameter;
pub mod preload;
mod relative_mass;
pub mod result;
pub mod run;
mod shared_mass;
pub mod sleep;
mod snap;
mod stance;
pub mod step;
pub mod system;
mod tables;
mod weight;

pub use check::ModelError;
pub use error::SolveError;
pub use model::Model;
pub use result::RunResult;
pub use run::{SolverOptions, simulate, simulate_carefully, simulate_with};
