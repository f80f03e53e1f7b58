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
    /// At a bushing that was live from the start.
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

impl EventRule {
    /// What it changes when it fires, in words.
    pub fn effect_words(&self) -> &'static str {
        match (self.watch.is_empty(), self.nearest) {
            (true, _) => "the model stays as it is",
            (false, true) => "the latent section nearest to the event may give way from then on",
            (false, false) => "its latent sections may give way from then on",
        }
    }
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

impl Met {
    fn words(self) -> &'static str {
        match self {
            Self::Ground => "the ground",
            Self::Obstacle => "an obstacle",
            Self::Part => "another part",
        }
    }
}

impl Range {
    /// ", from 2 to 3 m/s", or nothing if it holds every number.
    fn words(&self, unit: &str) -> String {
        match (self.least, self.most) {
            (None, None) => String::new(),
            (Some(least), None) => format!(", {least} {unit} or more"),
            (None, Some(most)) => format!(", {most} {unit} or less"),
            (Some(least), Some(most)) => format!(", from {least} to {most} {unit}"),
        }
    }
}

impl Trigger {
    /// What has to happen, in words: "it meets the ground or an obstacle, 3 m/s or more".
    pub fn words(&self) -> String {
        match self {
            Self::Contact { partners, approach_speed_m_s, time_s } => {
                let with: Vec<&str> = partners.iter().map(|met| met.words()).collect();
                let with = match with.as_slice() {
                    [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
                    one => one.concat(),
                };
                let speed = approach_speed_m_s.words("m/s of approach");
                format!("it meets {with}{speed}{}", time_s.words("s of the run"))
            }
            Self::Fracture { places, after_contact, time_s } => {
                let place = match places.as_slice() {
                    [Broken::End] => " at an end",
                    [Broken::Span] => " between its ends",
                    _ => "",
                };
                let phase = match after_contact {
                    None => "",
                    Some(false) => ", before anything has met",
                    Some(true) => ", after something has met",
                };
                format!("it breaks{place}{phase}{}", time_s.words("s of the run"))
            }
        }
    }

    /// When it may happen \[s\].
    pub fn time_s(&self) -> Range {
        match self {
            Self::Contact { time_s, .. } | Self::Fracture { time_s, .. } => *time_s,
        }
    }
}
