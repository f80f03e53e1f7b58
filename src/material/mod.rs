//! Constitutive laws and the strength of sections.

pub mod j2;
pub mod rate;
pub mod section_capacity;
