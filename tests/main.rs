//! Integration tests, one module a subject: `building` reads and refuses building files, `mbs` verifies the multibody
//! solver, `report` renders pages.

mod building;
mod mbs;
mod report;
