//! Decisions of the analyst in place of the rules, spread over the members and ends that rules are asked about.
//!
//! What is decided about one thing may follow for others: a floor that is one rigid body folds at none of its beam ends, a floor that folds at a line does not bend, and a line
//! runs through all beam ends on it. Such a decision is taken only where the rules say otherwise.

use super::webs::web_of;
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind, Override, OverrideAction};
use crate::graph::Structure;
use crate::rules::Action;
use crate::rules::action::find;
use std::collections::BTreeMap;

/// What stands in place of a rule's id where the analyst has decided.
pub const ANALYST: &str = "analyst/override";

/// An answer of the analyst.
#[derive(Debug, Clone)]
pub struct Answer {
    /// What is decided.
    pub action: Action,
    /// Why.
    pub reason: String,
    /// The target of the override.
    pub target: String,
    /// Whether it follows from what is decided about something else.
    pub follows: bool,
}

/// All answers, by the id of the member or end.
#[derive(Debug, Clone, Default)]
pub struct Answers(BTreeMap<String, Answer>);

impl Answers {
    /// Those that some overrides make in a building.
    pub fn of(
        building: &Building,
        overrides: &[Override],
        structure: &Structure,
        ends: &[MemberEnd],
    ) -> Self {
        let mut this = Self::default();
        if overrides.is_empty() {
            return this;
        }
        let spread = Spread { building, floors: structure.storey_bodies(), ends };
        for decided in overrides {
            spread.of(decided, &mut this);
        }
        this
    }

    /// The answer about a member or end, where rules have decided this or that.
    pub fn about(&self, subject: &str, ruled: Option<Action>) -> Option<&Answer> {
        self.0.get(subject).filter(|a| !a.follows || ruled != Some(a.action))
    }

    fn enter(&mut self, subject: &str, decided: &Override, action: OverrideAction, follows: bool) {
        let Some(spec) = find(action.name()) else { return };
        let reason = if follows {
            format!("{} (follows from `{}` of {})", decided.reason, decided.action.name(), decided.target)
        } else {
            decided.reason.clone()
        };
        let answer = Answer { action: spec.action, reason, target: decided.target.clone(), follows };
        if follows {
            self.0.entry(subject.to_string()).or_insert(answer);
        } else {
            self.0.insert(subject.to_string(), answer);
        }
    }
}

/// What decisions are spread over.
struct Spread<'a> {
    building: &'a Building,
    /// Members of each floor; every other member is by itself.
    floors: Vec<Vec<usize>>,
    ends: &'a [MemberEnd],
}

impl Spread<'_> {
    fn of(&self, decided: &Override, answers: &mut Answers) {
        use OverrideAction::{BreakAway, LatentHinge, MergeElastic, MergeRigid, RigidConnection};
        let id = |m: usize| self.building.members[m].id.as_str();
        let end = self.ends.iter().find(|e| e.id == decided.target);
        let member = end
            .map(|e| e.member)
            .or_else(|| self.building.members.iter().position(|m| m.id == decided.target));
        // strips of slabs, bases and tops of walls
        let Some(member) = member else {
            return answers.enter(&decided.target, decided, decided.action, false);
        };
        let bar_or_slab = matches!(self.building.members[member].kind, MemberKind::Slab | MemberKind::Beam);
        let floor: &[usize] =
            self.floors.iter().find(|f| bar_or_slab && f.contains(&member)).map_or(&[], Vec::as_slice);
        let in_floor = || self.ends.iter().filter(|e| floor.contains(&e.member));
        match (end, decided.action) {
            (None, MergeRigid | MergeElastic) if bar_or_slab => {
                floor.iter().for_each(|m| answers.enter(id(*m), decided, decided.action, false));
                if decided.action == MergeRigid {
                    in_floor().for_each(|e| answers.enter(&e.id, decided, RigidConnection, true));
                }
            }
            (Some(end), LatentHinge | RigidConnection) if bar_or_slab => {
                answers.enter(&end.id, decided, decided.action, false);
                if decided.action == LatentHinge {
                    floor.iter().for_each(|m| answers.enter(id(*m), decided, MergeRigid, true));
                } else {
                    let others = in_floor().filter(|e| e.id != end.id && e.on_line_of(end));
                    others.for_each(|e| answers.enter(&e.id, decided, RigidConnection, true));
                }
            }
            (None, BreakAway) => answers.enter(&web_of(id(member)), decided, BreakAway, false),
            _ => answers.enter(&decided.target, decided, decided.action, false),
        }
    }
}
