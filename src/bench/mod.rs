//! Measurements of the solvers: how fast, how far off for how much time, and where they stop.
//!
//! | file | owns |
//! |---|---|
//! | `buildings` | generated models of random small buildings, run to rest |
//! | `fe` | throughput of a block of elements beside the machine's memory bandwidth |
//! | `bandwidth` | that bandwidth |
//! | `fe_error` | error of a building's run over mesh size and run time |
//! | `fe_stability` | runs at and beyond the limits of the method |
//! | `generate` | time of generation over the number of members |
//! | `mbs` | error over run time of mechanisms whose motion is known |
//! | `mbs_stability` | multibody runs at and beyond the limits (`mbs_trials`: what they are) |
//! | `passing` | whether bodies passed through each other, from the frames of a run |
//! | `soundness` | what every multibody run is asked: energy, depths |
//! | `trials` | what these runs are; their frame is `mini.toml` |
//! | `tradeoff` | run time against error of MBS, hybrid and FE of the same buildings |

pub mod bandwidth;
pub mod buildings;
pub mod fe;
pub mod fe_error;
pub mod fe_stability;
pub mod generate;
pub mod mbs;
pub mod mbs_stability;
pub mod mbs_trials;
pub mod passing;
pub mod soundness;
pub mod tradeoff;
pub mod trials;
