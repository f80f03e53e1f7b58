//! What contacts and fractures change while a model runs.

use super::Origin;
use serde::{Deserialize, Serialize};

/// A rule about contacts or fractures: the latent bushings that it names are rigid, and cost nothing, until it fires for the body that they hold together; from then on they may give way.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EventRule {
    /// Unique id.
    pub id: String,
    /// The question that it answers: of the rules of each question that are true of an event and of one of its bodies the first decides.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub question: String,
    /// The events that it is about.
    pub on: Trigger,
    /// The bodies that it is about: those that are struck, or that a bushing breaks away from.
    pub bodies: Vec<String>,
    /// Latent bushings that are watched from then on, those of the body that the event happens to. Empty: the model stays as it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub watch: Vec<String>,
    /// Whether of these only the section nearest to the event is.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub nearest: bool,
    /// Provenance.
    #[serde(default)]
    pub origin: Origin,
}

/// Events, and what has to be true of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case", deny_unknown_fields)]
pub enum Trigger {
    /// A body meets something.
    Contact {
        /// What it meets.
        partners: Vec<Met>,
        /// Speed at which the points that meet approach each other along the normal \[m/s\].
        #[serde(default, skip_serializing_if = "Range::is_any")]
        approach_speed_m_s: Range,
        /// When \[s\].
        #[serde(default, skip_serializing_if = "Range::is_any")]
        time_s: Range,
    },
    /// A bushing breaks.
    Fracture {
        /// Where in the member.
        places: Vec<Broken>,
        /// Whether something has met before; `None`: either.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        after_contact: Option<bool>,
        /// When \[s\].
        #[serde(default, skip_serializing_if = "Range::is_any")]
        time_s: Range,
    },
}

/// What a body meets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Met {
    /// The ground.
    Ground,
    /// An obstacle or a plane.
    Obstacle,
    /// Another body.
    Part,
}

/// Where a member breaks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Broken {
    /// At a bushing that was live from the begin.
    End,
    /// At one that was latent.
    Span,
}

/// Numbers from a least to a most one, both included.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Range {
    /// The least; `None`: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f64>,
    /// The most; `None`: any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most: Option<f64>,
}

impl Range {
    /// Whether it holds every number.
    pub fn is_any(&self) -> bool {
        self.least.is_none() && self.most.is_none()
    }

    /// Whether it holds a number.
    pub fn holds(&self, value: f64) -> bool {
        self.least.is_none_or(|least| value >= least) && self.most.is_none_or(|most| value <= most)
    }
}

impl Trigger {
    /// When it may happen \[s\].
    pub fn time_s(&self) -> Range {
        match self {
            Self::Contact { time_s, .. } | Self::Fracture { time_s, .. } => *time_s,
        }
    }
}
