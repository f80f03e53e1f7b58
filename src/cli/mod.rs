//! (module)

pub mod library;
pub mod rules;
