//! The explicit finite element solver against closed forms, publications and another program.
//!
//! | file | cases |
//! |---|---|
//! | `element` | patch test, finite rotation, dead load |
//! | `j2` | plasticity of one element and of a bar |
//! | `beam` | cantilevers, plastic hinge |
//! | `waves` | waves, natural frequencies and impact of bars |
//! | `motion` | free fall, spin, tumbling, falling rod |
//! | `impact` | friction, ground, Taylor's bar, erosion |
//! | `bars` | two-node bars |
//! | `statics` | dynamic relaxation, tied faces |
//! | `control` | rate factor, mass scaling, a keyword deck |
//! | `slab` | a reinforced slab under blast (`slab_model`, `slab_estimate`: its mesh, the strain rate of its strengths) |
//! | `order` | orders of convergence |
//! | `body`, `forms` | what cases do with a body; element forms under test |

mod bars;
mod beam;
pub mod body;
mod control;
mod element;
pub mod forms;
mod impact;
mod j2;
mod motion;
mod order;
pub mod slab;
pub mod slab_estimate;
pub mod slab_model;
mod statics;
mod waves;

use super::suite::Case;

/// All cases, in the order of the manual.
pub fn cases() -> Vec<Case> {
    [
        element::cases(),
        j2::cases(),
        beam::cases(),
        waves::cases(),
        motion::cases(),
        impact::cases(),
        bars::cases(),
        statics::cases(),
        control::cases(),
        slab::cases(),
        order::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
