//! The explicit finite element solver against closed forms, conservation laws and published results.

mod cantilever;
mod contact;
mod element;
mod elements;
mod mesh;
mod motion;
mod plastic;
mod rate;
mod static_state;
mod truss;
