//! The product model of a building and of its demolition: what the user gives.

pub mod ends;
pub mod model;
pub mod partition;
pub mod tracked;

pub use model::*;
