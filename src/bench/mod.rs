//! Measurements of the solvers.
