//! (module)

pub mod library;
