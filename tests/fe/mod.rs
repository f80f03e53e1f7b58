//! The explicit finite element solver against closed forms, conservation laws and published results.

mod cantilever;
mod contact;
mod element;
mod mesh;
mod meshing;
mod motion;
mod plastic;
mod skipping;
mod static_state;
mod ties;
