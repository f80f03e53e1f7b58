//! The submodel of a member end: its resistance curves by FE, from the member end alone.
//!
//! Two of them: a piece of the global mesh with the homogenised law ([`cut`], [`pushover`]), and a mesh of its own in concrete and steel
//! ([`member`], [`bend`], driven along a path of [`drive`], strains by [`gauge`]; [`piece`] for [`axial`], [`shear`] and [`torsion`]), described by a section
//! file ([`section_file`]) or a building's column end and run as a [`series`]; cyclic histories are evaluated in [`hysteresis`].
//!
//! Bars may slip out of the joint ([`anchorage`]) and buckle once their cover has spalled (`cover`); what happens to single bars and ties is told as [`events`].
//!
//! A curve never sees the history of the building it is later used in: the piece of the global mesh around the
//! member end, with the global model's own law and element size, is clamped where it was cut and bent to failure.

pub mod anchorage;
pub mod around;
pub mod axial;
mod bar_bending;
mod bar_lines;
pub mod bend;
mod column_end;
mod cover;
pub mod crushing;
pub mod cut;
pub mod drive;
pub mod elastic;
pub mod events;
pub mod gauge;
pub mod hysteresis;
pub mod layers;
pub mod member;
pub mod piece;
mod plate;
pub mod pushover;
pub mod section_file;
pub mod section_grid;
pub mod series;
pub mod shear;
pub mod springs;
pub mod strip;
mod symmetry;
pub mod torsion;

pub use cut::EndModel;
pub use pushover::{EndCurves, PushoverError, derive, push};
pub use section_file::RcSection;
pub use series::{Series, SeriesOptions};
pub use springs::{SpringOptions, Springs};
pub use strip::{StripCurves, StripPlace, derive_strip};
