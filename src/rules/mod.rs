//! Rules: what becomes a body, a hinge, a spring; as data, with source and range of evidence.
//!
//! A rule file is checked when it is loaded: against the catalogues of [`features`] and [`action`]s, and against the
//! other rules (conflicts). [`RuleBase::evaluate`] is deterministic and keeps the full trace.
//!
//! | file | owns |
//! |---|---|
//! | [`features`], [`action`] | the catalogues: what can be asked, what can be decided |
//! | `value` | values of features and of parameters |
//! | [`expr`], `typing` | the language of conditions: grammar, types |
//! | `rule`, `file` | one rule; reading rule files |
//! | `logic`, [`check`] | which conditions can hold together; conflicts and gaps |
//! | [`carried`] | what a generated model carries out of what rules decide |
//! | [`engine`] | the rule base and its evaluation |
//! | [`residual`] | what is left of rules while some features are not known yet |
//! | [`diff`] | what changed between two rule bases |
//! | [`problem`] | messages with a place |

pub mod action;
pub mod carried;
pub mod check;
pub mod diff;
pub mod engine;
pub mod expr;
pub mod features;
mod file;
mod logic;
pub mod problem;
pub mod residual;
mod rule;
mod typing;
mod value;

pub use action::{Action, Aspect};
pub use check::Gap;
pub use engine::{Firing, RuleBase, Silent, SubjectError, Trace};
pub use problem::{Problem, Problems, Source};
pub use rule::{Rule, Statistics};
pub use value::{Subject, SubjectKind, Value};
