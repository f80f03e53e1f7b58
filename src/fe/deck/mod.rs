//! Keyword decks of LS-DYNA form: read into a [`Model`](super::model::Model) and written from one. The subset, field by field, stands in
//! `docs/decks.md`; field meanings follow the LS-DYNA Keyword User's Manual, volumes I and II.
//!
//! Reading goes in three steps: lines into keyword blocks with included files in their place (`lines`), blocks into
//! tables by identifier (`read`, `card`), tables into a model with every reference checked (`assemble`).
//! Errors are collected, not thrown at the first; what has no effect is noted.

mod assemble;
mod blame;
mod building;
mod card;
mod error;
mod groups;
mod laws;
mod lines;
mod normal;
mod number;
mod raw;
mod read;
mod read_control;
mod read_load;
mod read_material;
mod read_mesh;
mod write;

pub use blame::Places;
pub use building::{BuildingDeck, of_building};
pub use error::{DeckErrors, Note};
pub use normal::normalised;
pub use read::{DECK_ENDINGS, Deck, DeckOptions, Ids, is_deck, parse, read};
pub use write::{Written, write};
