//! The explicit finite element solver against closed forms, conservation laws and published results.

mod cantilever;
mod contact;
mod deck;
mod element;
mod mesh;
mod motion;
mod plastic;
mod static_state;
