//! Constitutive laws and the strength of sections.

pub mod concrete;
pub mod fibre;
pub mod fibre_concrete;
pub mod fibre_response;
pub mod j2;
pub mod rate;
pub mod rebar;
pub mod section_capacity;
