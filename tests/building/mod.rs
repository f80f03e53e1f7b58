//! The building file: reading, messages, the reference building.

mod bad;
mod bays;
mod commands;
mod mutate;
mod reference;
mod schema;
