//! Integration tests, one module a subject: `building` reads and refuses building files, `mbs` verifies the multibody
//! solver, `pipeline` runs the commands from building to report, `report` renders pages.

mod building;
mod mbs;
mod pipeline;
mod report;
