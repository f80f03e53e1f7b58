//! Explicit finite elements for collapse: one-point hexahedra, J2 plasticity, erosion, rigid contact.

pub mod blocks;
pub mod contact;
pub mod deck;
pub mod dynamics;
pub mod grid;
pub mod hexahedron;
pub mod kernel;
pub mod law;
pub mod mesh;
pub mod model;
pub mod model_run;
pub mod preload;
pub mod probe;
pub mod result;
pub mod run;
pub mod strain_rate;
