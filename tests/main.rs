//! The one integration-test binary.

mod building;
