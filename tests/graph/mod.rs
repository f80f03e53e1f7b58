//! Structure graph, frame analysis and demands.

mod apart;
mod buildings;
mod equilibrium;
mod frame;
mod overhang;
mod reference;
mod shapes;
