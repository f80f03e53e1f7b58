//! Constitutive laws and the strength of sections.

pub mod concrete;
pub mod j2;
pub mod rate;
pub mod section_capacity;
