//! Integration tests, one module a subject.

mod mbs;
mod report;
