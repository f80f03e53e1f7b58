//! All integration tests, one binary.

mod fe;
