//! Integration tests, one binary.

mod mbs;
