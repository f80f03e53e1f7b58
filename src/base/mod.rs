//! What every module may use and none owns: axis-aligned boxes, and later units, diagnostics,
//! hashes and atomic output.

pub mod geom;
pub mod hash;
pub mod output;
