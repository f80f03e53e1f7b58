//! Integration tests, one module a subject: `architecture` holds the direction of use between modules, `building` reads
//! and refuses building files, `graph` checks connections, capacities and frame analysis, `fe` verifies the finite
//! elements, `mbs` the multibody solver, `rc` the submodel of a member end, `library` keeps and mends the store, `rules`
//! reads, checks and fires rules, `generate` makes the model of the reference building, `report` renders pages,
//! `pipeline` runs the commands, `verify` the
//! short form of the verification manual, `bench` a few random buildings.

mod architecture;
mod bench;
mod building;
mod fe;
mod generate;
mod graph;
mod library;
mod mbs;
mod pipeline;
mod rc;
mod report;
mod rules;
mod verify;
