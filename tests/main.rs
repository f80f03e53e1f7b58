//! Integration tests, one module a subject: `building` reads and refuses building files, `fe` verifies the finite
//! elements, `mbs` the multibody solver, `report` renders pages.

mod building;
mod fe;
mod mbs;
mod report;
