//! The multibody model (a documented file format) and its solver.

pub mod model;
