//! Constitutive laws.

pub mod j2;
