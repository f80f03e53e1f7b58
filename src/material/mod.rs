//! Constitutive laws, and what follows from them for a section.

pub mod section_capacity;
