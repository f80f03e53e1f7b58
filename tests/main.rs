//! Integration tests, one module a subject: `architecture` holds the source to its design,
//! `building` reads and refuses building files, `mbs` verifies the multibody
//! solver, `report` renders pages.

mod architecture;
mod building;
mod mbs;
mod report;
