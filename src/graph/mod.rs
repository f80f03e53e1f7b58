//! The structure graph: members, contact faces, load paths, elastic demands, capacities.
//!
//! [`Structure::of`] finds the connections of a building from the faces that its disjoint cells share;
//! nothing is typed in by the user. The graph is built once and nothing is ever removed from it: what
//! a charge takes away is a set of member indices handed to the queries. Outside this module everything
//! is keyed by string ids, never by petgraph indices.
//!
//! | file | what it answers |
//! |---|---|
//! | [`structure`] | which members touch, where, and where they stand on the ground |
//! | [`contact`] | area, centroid and second moments of a contact face; near misses |
//! | [`ends`] | the ends of the clear columns and beams |
//! | [`mass`] | mass, centre and inertia of members, exact from cells |
//! | [`paths`] | rigid clusters, supports reached, vertical load paths lost |
//! | [`frame`] | linear frame solver |
//! | [`idealise`] | the building as a frame |
//! | [`shear_lag`] | beams whose slab ends at an edge |
//! | `apart` | the frame of each building by itself |
//! | [`demand`] | end forces before and after the removal, against capacities |

mod apart;
pub mod contact;
pub mod demand;
pub mod ends;
pub mod frame;
pub mod idealise;
pub mod mass;
pub mod paths;
pub mod shear_lag;
pub mod structure;

pub use contact::{ContactFace, NearMiss};
pub use demand::{Demands, EndDemand, EndState, demands};
pub use ends::{End, MemberEnd};
pub use mass::MassProperties;
pub use paths::{LoadPath, VerticalPath};
pub use structure::{Connection, Link, MemberNode, Node, Structure, SupportFace};
