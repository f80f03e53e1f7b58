//! Rigid sets in an FE run: parts of the mesh that move with six degrees of freedom and cost no element work.
//!
//! **What a set is.** Elements that hang together by faces, with all their nodes; two sets share no node ([`parts`]). Elements beside a set are
//! ordinary elements: what they do to its nodes is summed to a force and a moment, and they see nodes that move. Positions and velocities of a set's
//! nodes are those of the rigid body in every step ([`motion`]), so that contact, output and strain rates need to know nothing of sets.
//!
//! **Hand-over.** Nodes that become rigid get the rigid velocities with their momentum and angular momentum. That is the projection on rigid motions in the norm of
//! the kinetic energy, and what it takes from the kinetic energy is booked ([`record::Books`]), with the half of the last increment's work that belongs to forces which no longer act.
//! Stresses stay what they are in the elements' own frames. A release changes no velocity: elements are computed again, from their frozen stress.
//!
//! **Contact** is for deformable nodes: a place that is about to meet something is released first ([`switch`]). If a rigid node strikes all the same, it is
//! stopped like any node, by the impulse of its own mass, which the set gets with its moment; the next step finds the place released.
//!
//! **What never becomes rigid**: elements that a charge will remove, elements at held, driven, loaded or tied nodes and at bars. Elements of concrete laws,
//! the fully integrated form and detached debris are refused ([`Refused`]).

pub mod demand;
pub mod motion;
pub mod parts;
pub mod record;
pub mod sets;
pub mod switch;

pub use record::{HybridRecord, Reason, Switch};
pub use sets::{Hybrid, RigidSet};
pub use switch::HybridSettings;

/// Why a body cannot have rigid sets.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A law whose state is not that of one point in the element's frame.
    #[error(
        "part `{part}` has elements {what}; rigid parts are for one-point hexahedra of homogenised laws: leave --hybrid out, or choose another form"
    )]
    Law {
        /// The part.
        part: String,
        /// What its elements are.
        what: &'static str,
    },
    /// Detached elements get nodes of their own.
    #[error(
        "--hybrid goes with elements that are deleted when they fail, not with debris blocks: leave --on-failure split out"
    )]
    Split,
    /// Factors of rigid parts are in no checkpoint.
    #[error("a run with rigid parts has no checkpoints: leave --checkpoint-every and --resume out")]
    Checkpoint,
    /// A setting out of its range.
    #[error("{name} is {value}, expected {expected}")]
    Setting {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
}
