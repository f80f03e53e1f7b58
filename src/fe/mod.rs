//! Explicit finite elements for collapse: one-point hexahedra, J2 plasticity, erosion, rigid contact.

pub mod apart;
pub mod blocks;
pub mod contact;
pub mod dynamics;
pub mod embed;
pub mod full;
pub mod grid;
pub mod hexahedron;
pub mod hourglass;
pub mod kernel;
pub mod law;
pub mod mesh;
pub mod model;
pub mod node_field;
pub mod preload;
pub mod probe;
pub mod quality;
pub mod result;
pub mod run;
pub mod stiffness;
pub mod strain_rate;
pub mod sweep;
pub mod tie;
pub mod truss;
