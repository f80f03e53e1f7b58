//! What every module may use and none owns: axis-aligned boxes, units, source files as trees with
//! places, diagnostics, and later hashes and atomic output.

pub mod cpu;
pub mod diagnostic;
pub mod geom;
pub mod source;
pub mod tree;
pub mod units;
