//! What every module may use and none owns: axis-aligned boxes and which of them are near one, units, source files as trees with
//! places, JSON with paths, diagnostics, disjoint sets, hashes, atomic output, kinds of results, grids for viewers, lines through points, medians, roots, sparse equations, instruction sets, random numbers, time measurement, vectors of three components.

pub mod boxes;
pub mod cpu;
pub mod diagnostic;
pub mod geom;
pub mod hash;
pub mod isa;
pub mod json;
pub mod median;
pub mod output;
pub mod piecewise;
pub mod prefetch;
pub mod random;
pub mod results;
pub mod root;
pub mod sets;
pub mod source;
pub mod sparse;
pub mod tree;
pub mod units;
pub mod vector;
pub mod vtu;
