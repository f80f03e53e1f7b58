//! (module)

pub mod simulate;
