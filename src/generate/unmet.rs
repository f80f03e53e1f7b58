//! What rules decide about parts of a floor and the floor as a whole is not.

use super::decide::Decision;
use crate::building::Building;
use crate::rules::Action;
use serde::{Deserialize, Serialize};

/// Most members that a note lists.
const MOST_LISTED: usize = 8;

/// Decisions of a rule about members of a floor that the model does not have.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Unmet {
    /// Rule id.
    pub rule: String,
    /// What it decides.
    pub action: String,
    /// The members.
    pub members: Vec<String>,
    /// Why it is not carried out.
    pub why: String,
}

impl Unmet {
    /// What rules decide about some members, and is not carried out.
    pub(super) fn of(
        building: &Building,
        decision: &Decision,
        (members, action, why): (&[usize], Action, &str),
    ) -> Vec<Self> {
        let all = decision.ruled(building, members, action).into_iter();
        let of_rule = |(rule, members)| Self {
            rule,
            action: action.spec().name.to_string(),
            members,
            why: why.to_string(),
        };
        all.map(of_rule).collect()
    }

    /// In a sentence.
    pub fn words(&self) -> String {
        let more = self.members.len().saturating_sub(MOST_LISTED);
        let first = self.members[..self.members.len() - more].join(", ");
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!(
            "rule `{}` decides `{}` for {first}{more}, which is not carried out: {}",
            self.rule, self.action, self.why
        )
    }
}
