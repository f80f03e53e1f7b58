//! The HTML report: how far the generated multibody model (MBS), and a run with rigid parts (hybrid), can be trusted against the FE run.
//!
//! One self-contained page: verdict, plots (inline SVG), tables and a 3D view of both collapses side
//! by side; without an FE run ([`ReportInput::mbs_alone`]) a page of the MBS run alone. Opening it loads nothing from elsewhere. The caller fills a [`ReportInput`]; this module knows no
//! solver and no building model.
//!
//! | file | owns |
//! |---|---|
//! | `input`, `scene_input` | the data a report shows |
//! | `number` | numbers as text: digits, prefixes, axis ticks |
//! | `chart` | one line chart as SVG |
//! | `figure` | charts as an SVG file of their own |
//! | `loglog` | a plot on logarithmic axes as an SVG file |
//! | `scatter` | points of two quantities that should be equal, as an SVG file |
//! | `interaction` | strengths in the plane of two moments, as an SVG file |
//! | `partition` | pictures of rigid and deforming parts, and their share over time |
//! | `plan` | plans of charges and of debris |
//! | `plots` | which charts a report has |
//! | `page` | tables for the template |
//! | `figures` | key figures of the head |
//! | `alone` | tables of a page of the MBS run alone |
//! | `codec`, `scene` | the packed data of the 3D view |
//! | `templates/` | page, style, chart read-out, viewer and its shaders |

mod alone;
mod chart;
mod codec;
pub mod figure;
mod figures;
pub mod input;
pub mod interaction;
pub mod loglog;
mod number;
mod page;
pub mod partition;
pub mod plan;
mod plots;
pub mod scatter;
mod scene;
pub mod scene_input;

pub use input::*;
pub use partition::{Facet, FacetKind, Mark, MarkKind, Moment, PartitionView, Picture};
pub use plan::{BlastingPlan, DebrisOutline, DebrisPlan, PlanKind, PlanPart, PlannedCharge, StoreyPlan};
pub use scene_input::*;

/// Why a report could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// Two lists that belong together differ in length.
    #[error("{what}: expected {expected}, found {found}")]
    Length {
        /// Which list.
        what: String,
        /// Length it should have.
        expected: usize,
        /// Length it has.
        found: usize,
    },
    /// An index points outside its list.
    #[error("{what}: index {index} in a list of {count}")]
    Index {
        /// Which index.
        what: String,
        /// The index.
        index: u32,
        /// Length of the list.
        count: usize,
    },
    /// Times are not finite and increasing.
    #[error("{what}: times must be finite and increase")]
    Times {
        /// Which times.
        what: String,
    },
    /// The page template failed.
    #[error("page template: {0}")]
    Template(#[from] minijinja::Error),
}

/// The report as one HTML file. The same input gives the same bytes.
///
/// # Errors
/// Lists that belong together differ in length, an index points nowhere, or frame times do not increase.
pub fn render(input: &ReportInput) -> Result<String, ReportError> {
    page::render(input)
}
