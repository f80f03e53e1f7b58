//! The explicit finite element solver against closed forms, conservation laws and published results.

mod braces;
mod cantilever;
mod contact;
mod contact_body;
mod contact_planes;
mod contact_ties;
mod deck;
mod element;
mod elements;
mod erosion;
mod isa;
mod mesh;
mod meshing;
mod motion;
mod plastic;
mod rate;
mod relaxation;
mod removal;
mod restart;
mod skipping;
mod stability;
mod static_state;
mod step;
mod ties;
mod truss;
mod vtu;
