//! Reinforced concrete against closed forms, tests and other programs: the material point, the bar, the section, the member end.
//!
//! | file | cases |
//! |---|---|
//! | `point` | stress paths of a material point (no cases) |
//! | `strength` | strengths in one, two and three directions |
//! | `softening` | dissipated energy, residual strains, closing of cracks |
//! | `curves` | curves given by points, rate factors |
//! | `paths` | random strain paths, other axes, other steps |
//! | `bars` | the reinforcing bar |
//! | `sections` | the fibre section |
//! | `anchorage` | slip and pull-out of a bar |
//! | `biaxial` | the submodel in skew bending |
//! | `members` | member ends of the RC submodel beside their fibre sections |
//! | `column_envelope` | what the history of a bent column says (no cases) |
//! | `column_shear` | which columns are cycled, and how (no cases) |
//! | `column_runs` | tested columns bent by the RC submodel (no cases) |
//! | `columns` | their figures beside the tests |
//! | `column_page` | every one of them on a page (no cases) |

mod anchorage;
mod bars;
mod biaxial;
pub mod column_envelope;
pub mod column_page;
pub mod column_runs;
pub mod column_shear;
pub mod columns;
mod curves;
mod members;
mod paths;
pub mod point;
mod sections;
mod softening;
pub mod strength;

use super::suite::Case;

/// Groups in the order of the manual: from the material point to the member.
const GROUPS: &[fn() -> Vec<Case>] = &[
    strength::cases,
    softening::cases,
    curves::cases,
    paths::cases,
    bars::cases,
    sections::cases,
    anchorage::cases,
    biaxial::cases,
    members::cases,
    columns::cases,
];

/// All cases, in the order of the manual.
pub fn cases() -> Vec<Case> {
    GROUPS.iter().flat_map(|group| group()).collect()
}
