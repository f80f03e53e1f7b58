//! The submodel of a member end: its resistance curves by FE, from the member end alone.
//!
//! A curve never sees the history of the building it is later used in: the piece of the global mesh around the
//! member end, with the global model's own law and element size, is clamped where it was cut and bent to failure.

pub mod bend;
pub mod cut;
pub mod member;
pub mod pushover;

pub use cut::EndModel;
pub use pushover::{EndCurves, PushoverError, derive};
