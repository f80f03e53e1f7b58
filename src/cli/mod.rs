//! cli

pub mod graph;
