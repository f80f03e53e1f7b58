//! Contact: of nodes with rigid, immovable surfaces, and of the body with itself.
//!
//! Both are kinematic: what a contact gives is the impulse that keeps a node from crossing a surface within the
//! step, not the force of a penalty spring. There is no stiffness to choose and no elastic energy to account for, and the time step stays
//! that of the elements: a body with constraints has no higher frequency than the same body without them
//! (Rayleigh's theorem), whatever the materials are.

pub mod body;
mod broad;
mod faces;
mod narrow;
mod rigid;
mod solve;
mod tied;

pub use body::{BodyContact, ContactSummary, LostContact};
pub use faces::Faces;
pub use rigid::RigidSurfaces;
pub use tied::TiedStrikes;
