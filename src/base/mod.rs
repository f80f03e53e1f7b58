//! What every module may use and none owns: axis-aligned boxes, and later units, diagnostics,
//! hashes and atomic output.

pub mod cpu;
pub mod geom;
