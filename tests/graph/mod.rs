//! Structure graph, frame analysis and demands.

mod buildings;
mod frame;
mod reference;
mod shapes;
