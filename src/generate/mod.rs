//! The simulation manager: building + rules + library -> MBS model, with a reason for each part.
//!
//! Rigid bodies come from the members by the rules (a column is one body; a slab and its beams are one), joints stand at the
//! member ends for which a rule asks for a hinge, and each hinge carries the curves of the library entry computed from exactly
//! this member end. Where no rule decides or no entry exists, generation stops and says so: there is no default curve.

mod analyst;
mod axes;
mod beam_ends;
mod beam_joints;
pub mod bodies;
mod cells;
mod charges;
mod crossing;
mod crushing;
mod decide;
mod division;
mod doubts;
mod draft;
mod edges;
mod entries;
mod event_reasons;
mod event_rules;
mod floor_mass;
mod floors;
mod generator;
mod grillage;
mod jointless;
mod joints;
mod junction;
pub mod known;
mod known_lines;
mod levers;
mod lines;
mod nearest;
mod panels;
mod piers;
mod rates;
mod rigid;
mod sections;
mod stretch;
mod stumps;
mod through;
mod twist;
mod unasked;
mod undemanded;
mod unmet;
mod walls;
mod webs;
mod wish;
mod withdrawn;

pub use analyst::ANALYST;
pub use beam_ends::BEAM_CURVES;
pub use decide::{Decision, Reason, Superseded};
pub use doubts::{Alternative, Doubt, Why};
pub use event_reasons::EventReason;
pub use generator::Generator;
pub use jointless::Jointless;
pub use joints::is_ground;
pub use rigid::rigid_elements;
pub use unasked::Unasked;
pub use unmet::Unmet;
pub use webs::{StaysWhole, web_of};
pub use wish::{Accuracy, Derive, Wishes};

use crate::base::units::round_to_digits;
use crate::building::between::Between;
use crate::building::{Building, MemberKind};
use crate::fe::weld::Welds;
use crate::library::derive::DeriveError;
use crate::library::{Entry, Store, StoreError};
use crate::mbs::model::Model;
use crate::rules::RuleBase;
use std::collections::{BTreeMap, BTreeSet};

/// A generated model with its reasons.
#[derive(Debug, Clone)]
pub struct Generated {
    /// The model.
    pub model: Model,
    /// Why each part is there, in the order of the model.
    pub trace: Vec<Reason>,
    /// Rules about contacts and fractures that stand in the model.
    pub event_rules: Vec<EventReason>,
    /// Rules about events that are not asked.
    pub unasked: Vec<Unasked>,
    /// Why beams stay one with their slabs.
    pub stays: Vec<StaysWhole>,
    /// Why ends have no joint.
    pub jointless: Vec<Jointless>,
    /// What rules decide about parts of floors and the floors are not.
    pub unmet: Vec<Unmet>,
    /// Where curves come from that were made without a run, by the key of the entry.
    pub scaled: BTreeMap<String, String>,
    /// What an analyst should look at.
    pub notes: Vec<String>,
    /// Decisions of which an analyst might doubt.
    pub doubts: Vec<Doubt>,
    /// Keys of entries that were computed on the way.
    pub derived: Vec<String>,
    /// The entries used, by key.
    pub entries: BTreeMap<String, Entry>,
    /// Time of each stage \[s\], in their order; `curves` is what it takes to scale or compute those that the library lacks.
    pub stages: Vec<(&'static str, f64)>,
}

impl Generated {
    /// What the analyst decided in place of the rules, in words; what is the same of many members or ends, once.
    pub fn overrides(&self) -> Vec<String> {
        let mut groups: Vec<(&Reason, BTreeSet<&str>)> = Vec::new();
        for reason in self.trace.iter().filter(|r| r.is_of_analyst()) {
            let same = |g: &Reason| {
                (&g.action, &g.words, &g.instead_of) == (&reason.action, &reason.words, &reason.instead_of)
            };
            match groups.iter_mut().find(|(g, _)| same(g)) {
                Some((_, subjects)) => _ = subjects.insert(&reason.subject),
                None => groups.push((reason, BTreeSet::from([reason.subject.as_str()]))),
            }
        }
        let words = |(reason, subjects): (&Reason, BTreeSet<&str>)| {
            let subjects: Vec<&str> = subjects.into_iter().collect();
            format!(
                "{} -> {}: {} ({})",
                subjects.join(", "),
                reason.action,
                reason.words,
                reason.instead_words()
            )
        };
        groups.into_iter().map(words).collect()
    }
}

/// Most ids that an error lists.
const MOST_LISTED: usize = 8;

/// A model that cannot be generated.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// No rule says what a part becomes.
    #[error("no rule decides about {}: add a rule under rules/ that applies to it (`fallwerk rules check` tells for which kinds of subject there is none), or describe the part otherwise", listed(.0))]
    Gap(Vec<String>),
    /// A rule decides something that is not carried out.
    #[error(
        "rule `{rule}`{place} decides `{action}` for {subject}, which no generated model carries out; {remedy}"
    )]
    Unsupported {
        /// Its id.
        rule: String,
        /// Where it is written, in brackets.
        place: String,
        /// What it decides.
        action: &'static str,
        /// About which member, end or line.
        subject: String,
        /// What to write instead.
        remedy: String,
    },
    /// A subject does not fit the catalogue of features.
    #[error(transparent)]
    Subject(#[from] crate::rules::SubjectError),
    /// The library lacks entries.
    #[error("the library has no entry for {}{}", .ends.join(", "), if *.similar { ", no similar one to scale, and no curves of its section; run with `--derive` to compute what is missing" } else { "; run with `--derive` to compute what is missing, or for columns with `--derive=similar` to scale the curves of similar ones or take those of their sections" })]
    Missing {
        /// Member ends and lines without entries.
        ends: Vec<String>,
        /// Whether similar entries would have done.
        similar: bool,
    },
    /// The entry that fits is no longer to be used, and nothing else fits.
    #[error(
        "the entry for {end}, {key}, {why}; name one with `fallwerk library deprecate {key} --successor KEY`, or run with `--derive=similar` to scale the curves of similar columns"
    )]
    Withdrawn {
        /// The first place that asks for it.
        end: String,
        /// Its key.
        key: String,
        /// Why it is not used, and what stood in its place is not.
        why: String,
    },
    /// A stretch of a beam or brace cannot be removed.
    #[error(
        "charge `{0}` removes a stretch of `{1}`: the MBS model takes stretches out of columns only, other members go whole; give the charge without a stretch, or split the member"
    )]
    BeamStretch(String, String),
    /// A stretch cannot be removed from what is one body with others.
    #[error(
        "a charge removes a stretch of column `{0}`, which is one body with other members in the MBS model: have it be one of its own (rule or override), or give the charge without a stretch"
    )]
    Stretch(String),
    /// A charge on a part of a body.
    #[error(
        "charge `{charge}` is on `{member}`, which is one body with other members in the MBS model ({body}): give charges to all of these members, or to columns, walls and beams with a slab on them only; the FE model can take it away alone"
    )]
    Shared {
        /// The charge.
        charge: String,
        /// Its member.
        member: String,
        /// The body, or the first of those that it is divided into.
        body: String,
    },
    /// A member is turned out of the axes.
    #[error("{0}")]
    Skew(String),
    /// Beams that meet columns between their ends.
    #[error("{}{}; {}", .0[0].problem(), more_of(.0), .0[0].remedy())]
    Between(Vec<Between>),
    /// A decision of the analyst cannot be carried out.
    #[error("the override of {0} cannot be carried out: {1}")]
    Override(String, String),
    /// A column ends in the air.
    #[error(
        "member end {0} touches nothing, or nothing of it is in the mesh (`fallwerk check --mesh` names planes that are too close)"
    )]
    Loose(String),
    /// A member end that the mesh has elsewhere.
    #[error(
        "member end {end} lies at {axis} = {} m, in the mesh at {} m: its face is one plane with that of another member, which is nearer than a quarter of the mesh size; \
         give a `settings.mesh_size` below {} m, or put both faces at the same height",
        round_to_digits(*at_m, 7), round_to_digits(*mesh_m, 7), round_to_digits(4.0 * (.at_m - .mesh_m).abs(), 3)
    )]
    Moved {
        /// The end.
        end: String,
        /// Axis of the member.
        axis: char,
        /// Its place along the axis \[m\].
        at_m: f64,
        /// The place of the nearest nodes of the member \[m\].
        mesh_m: f64,
    },
    /// The mesh joins members that stand apart.
    #[error(transparent)]
    Welded(#[from] Welds),
    /// A rule about events compares what is not known before them.
    #[error(transparent)]
    Event(#[from] crate::rules::residual::PendingError),
    /// A submodel failed.
    #[error(transparent)]
    Derive(#[from] DeriveError),
    /// The store failed.
    #[error(transparent)]
    Store(#[from] StoreError),
}

/// The first of some ids, and how many more there are.
fn listed(ids: &[String]) -> String {
    let more = ids.len().saturating_sub(MOST_LISTED);
    let first = ids[..ids.len() - more].join(", ");
    if more > 0 { format!("{first} and {more} more") } else { first }
}

/// " (and 2 more)" after the first of some.
fn more_of<T>(all: &[T]) -> String {
    if all.len() > 1 { format!(" (and {} more)", all.len() - 1) } else { String::new() }
}

/// Generates the model of a building. `progress` hears what is being derived.
pub fn generate(
    building: &Building,
    rules: &RuleBase,
    store: &mut Store,
    wishes: impl Into<Wishes>,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Generated, GenerateError> {
    Generator::of(building, rules, store, wishes)?.model(&building.overrides, progress)
}

/// Whether a member is a bar that may get hinges of its own.
fn is_column(building: &Building, member: usize) -> bool {
    building.members[member].kind == MemberKind::Column
}
