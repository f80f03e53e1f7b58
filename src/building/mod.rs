//! The product model of a building and of its demolition: what the user gives.
//!
//! [`read`] takes a TOML or JSON file to a checked [`Building`] or to all of its errors at once:
//!
//! ```text
//! text ── base::tree ─▶ values with places ── structure (table of format) ─▶ errors of form
//!                              └── materials, members, plan ─▶ Draft ── check ─▶ errors of meaning
//!                                                                └─▶ Building
//! ```
//!
//! ```
//! use fallwerk::base::tree::Format;
//! let errors = fallwerk::building::parse("schema = 2", Format::Toml, "a.toml").unwrap_err();
//! assert!(errors.to_string().contains("Fallwerk reads version 1"));
//! ```

mod bays;
pub mod between;
mod check;
pub mod clear;
mod connect;
pub mod ends;
mod fields;
mod footings;
pub mod format;
pub mod gaps;
mod grid;
pub mod inclined;
pub mod lines;
mod materials;
mod members;
pub mod model;
mod openings;
mod overrides;
pub mod partition;
mod plan;
mod read;
pub mod rows;
pub mod schema;
mod soffits;
mod storeys;
mod structure;
pub mod tracked;
pub mod turned;

pub use bays::{BayRange, Bays};
pub use fields::Fields;
pub use grid::column_id;
pub use inclined::Inclined;
pub use materials::{LEAST_COVER_M, section_bars};
pub use model::*;
pub use read::{Inspection, inspect, inspect_file, parse, read};
pub use structure::check_against;

/// The commented reference building, as `fallwerk init` writes it.
pub const EXAMPLE: &str = include_str!("../../buildings/three-storey-frame.toml");
