//! From a building to model, runs and report: the commands `generate-mbs`, `fe` and `explain`, and the parts they are made of.

mod all_three;
mod alone;
mod commands;
mod fe_options;
mod fe_refused;
mod reference;
mod spread;
mod studies;
mod words;
