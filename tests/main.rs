//! Integration tests; one module a subsystem.

mod library;
mod rules;
