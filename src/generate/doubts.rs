//! Decisions of which an analyst might doubt: why, and what could have been decided otherwise.
//!
//! | kind | when |
//! |---|---|
//! | overloaded | an end stays rigid whose section would yield in linear theory |
//! | conflict | another rule with evidence, within its range, says otherwise |
//! | out of range | the deciding rule is used outside its range of evidence |
//! | unsure | the deciding rule is right in fewer cases than [`SURE`] by its studies |
//! | scaled | curves come from an entry farther away than [`FAR`] |
//! | override | the analyst has decided |
//! | remark | something else about the model is to be known |

use super::decide::Decision;
use super::entries::Entries;
use super::known::Known;
use super::webs::web_of;
use crate::building::ends::MemberEnd;
use crate::building::{Building, MemberKind, OverrideAction};
use crate::graph::{Demands, Structure};
use crate::rules::{Action, Aspect, Firing, Subject, SubjectKind};
use std::collections::{BTreeMap, BTreeSet};

/// Confidence below which a decision is doubtful.
pub const SURE: f64 = 0.9;
/// Distance of similarity above which a scaled curve is doubtful: a tenth of the depth, or twice that of slenderness or strength.
pub const FAR: f64 = 0.1;
/// Strength of a scaled curve over its own with which it is tried: moments of entries left out in turn are within 9 % (docs/library.md).
pub const WEAKER: f64 = 0.91;

/// Why a decision is doubtful.
#[derive(Debug, Clone, PartialEq)]
pub enum Why {
    /// Elastic demand over capacity of a rigid end.
    Overloaded(f64),
    /// The rule that says otherwise, what it says, and how sure it is.
    Conflict(String, String, f64),
    /// What lies outside the range of the rule.
    OutOfRange(String),
    /// How sure the rule is.
    Unsure(f64),
    /// Distance of the entry that is scaled, and which.
    Scaled(f64, String),
    /// What the rules would have said.
    Override(String),
    /// What is to be known.
    Remark(String),
}

impl Why {
    /// Its kind, as a number in the order of the table above and as a name.
    pub fn kind(&self) -> (usize, &'static str) {
        match self {
            Self::Overloaded(_) => (0, "overloaded"),
            Self::Conflict(..) => (1, "conflict"),
            Self::OutOfRange(_) => (2, "out of range"),
            Self::Unsure(_) => (3, "unsure"),
            Self::Scaled(..) => (4, "scaled"),
            Self::Override(_) => (5, "override"),
            Self::Remark(_) => (6, "remark"),
        }
    }

    /// How strong it is among those of its kind.
    pub fn strength(&self) -> f64 {
        match self {
            Self::Overloaded(ratio) => *ratio,
            Self::Conflict(_, _, sure) => *sure,
            Self::Unsure(sure) => 1.0 - sure,
            Self::Scaled(distance, _) => *distance,
            Self::OutOfRange(_) | Self::Override(_) | Self::Remark(_) => 0.0,
        }
    }

    /// In words.
    pub fn words(&self) -> String {
        match self {
            Self::Overloaded(ratio) => {
                format!("its section would yield in linear theory, demand over capacity {ratio:.1}")
            }
            Self::Conflict(rule, action, sure) => {
                format!("rule {rule} says {action}, right in {:.0} % of cases by its studies", 1e2 * sure)
            }
            Self::OutOfRange(what) => format!("outside the rule's range of evidence ({what})"),
            Self::Unsure(sure) => format!("the rule is right in {:.0} % of cases by its studies", 1e2 * sure),
            Self::Scaled(_, words) => format!("curves {words}"),
            Self::Override(instead) => format!("the analyst's override; {instead}"),
            Self::Remark(remark) => remark.clone(),
        }
    }
}

/// What could have been decided otherwise.
#[derive(Debug, Clone, PartialEq)]
pub enum Alternative {
    /// An override.
    Decide(String, OverrideAction),
    /// That of the rules, without the override of this target.
    Without(String),
    /// Curves of an entry with a share of their strength.
    Weaker(String, f64),
    /// The generator knows no other way.
    Nothing,
}

impl Alternative {
    /// In words.
    pub fn words(&self) -> String {
        match self {
            Self::Decide(_, action) => action.name().to_string(),
            Self::Without(_) => "what the rules say".to_string(),
            Self::Weaker(_, factor) => format!("{factor} of their strength"),
            Self::Nothing => "the generator knows no other way".to_string(),
        }
    }
}

/// A decision of which an analyst might doubt.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt {
    /// What it is about: a member end, a wall or column, members of one floor, or the ends with one curve.
    pub subjects: Vec<String>,
    /// What is decided.
    pub action: String,
    /// Who decides: a rule, the analyst, or an entry of the library.
    pub by: String,
    /// Why it is doubtful, strongest kind first.
    pub why: Vec<Why>,
    /// What could have been decided otherwise.
    pub alternative: Alternative,
}

/// What doubts are gathered from.
#[derive(Clone, Copy)]
pub(super) struct Sources<'a> {
    pub building: &'a Building,
    pub structure: &'a Structure,
    pub ends: &'a [MemberEnd],
    pub decision: &'a Decision,
    pub overloaded: &'a [(String, f64)],
    pub found: &'a Entries,
    pub known: &'a Known,
}

impl Doubt {
    /// Those of a model: of the members, of the ends, of the curves.
    pub(super) fn all(sources: &Sources, remarks: Vec<String>) -> Vec<Self> {
        let Sources { building, structure, ends, decision, overloaded, found, known } = *sources;
        let site =
            Site { decision, overloaded: overloaded.iter().map(|(id, r)| (id.as_str(), *r)).collect() };
        let mut floor_of = vec![None; building.members.len()];
        for (number, floor) in structure.storey_bodies().iter().enumerate() {
            floor.iter().for_each(|m| floor_of[*m] = Some(number));
        }
        let mut list: Vec<Self> = Vec::new();
        let mut floors: BTreeMap<usize, usize> = BTreeMap::new();
        for (index, subject) in known.members.iter().enumerate() {
            let kind = building.members[index].kind;
            let Some(doubt) = site.doubt(subject, kind) else { continue };
            let floor = floor_of[index].filter(|_| matches!(kind, MemberKind::Slab | MemberKind::Beam));
            match floor.and_then(|f| floors.get(&f)) {
                Some(held) => list[*held].join(doubt),
                None => {
                    floor.map(|f| floors.insert(f, list.len()));
                    list.push(doubt);
                }
            }
        }
        list.extend(known.members.iter().filter_map(|subject| site.break_away(&subject.id)));
        let of_ends = known.ends.iter().zip(ends);
        list.extend(of_ends.filter_map(|(end, place)| site.doubt(end, building.members[place.member].kind)));
        // of lines just what the analyst decides: no rule has them elastic, so that nothing could be otherwise
        let of_lines = known.lines.iter().filter(|line| decision.is_of_analyst(&line.id));
        list.extend(of_lines.filter_map(|line| site.doubt(line, MemberKind::Slab)));
        list.extend(found.scaled.iter().filter(|s| s.distance > FAR).map(|scaled| {
            let ends = found.of_end.iter().filter(|(_, key)| **key == scaled.key);
            Self {
                subjects: ends.map(|(id, _)| id.clone()).collect(),
                action: "scaled curves".to_string(),
                by: scaled.key.clone(),
                why: vec![Why::Scaled(scaled.distance, scaled.words.clone())],
                alternative: Alternative::Weaker(scaled.key.clone(), WEAKER),
            }
        }));
        list.extend(remarks.into_iter().map(|remark| Self {
            subjects: Vec::new(),
            action: "as the generator does it".to_string(),
            by: "generator".to_string(),
            why: vec![Why::Remark(remark)],
            alternative: Alternative::Nothing,
        }));
        list
    }

    /// Takes in a doubt about the same floor.
    fn join(&mut self, other: Self) {
        self.subjects.extend(other.subjects);
        let new = other.why.into_iter().filter(|w| !self.why.contains(w)).collect::<Vec<Why>>();
        self.why.extend(new);
        self.why.sort_by_key(|w| w.kind().0);
    }

    /// Its place in the documented order: the kind, and among those of a kind the stronger first.
    pub fn order(&self) -> (usize, f64) {
        self.why.first().map_or((usize::MAX, 0.0), |why| (why.kind().0, -why.strength()))
    }
}

/// What is decided, and the rigid ends whose sections would yield.
struct Site<'a> {
    decision: &'a Decision,
    overloaded: BTreeMap<&'a str, f64>,
}

impl Site<'_> {
    /// That the analyst has a beam break away from its slab.
    fn break_away(&self, beam: &str) -> Option<Doubt> {
        let (target, instead) = self.decision.instead(&web_of(beam))?;
        Some(Doubt {
            subjects: vec![beam.to_string()],
            action: Action::BreakAway.spec().name.to_string(),
            by: super::ANALYST.to_string(),
            why: vec![Why::Override(instead)],
            alternative: Alternative::Without(target?.to_string()),
        })
    }

    /// The doubt about a subject, if there is any.
    fn doubt(&self, subject: &Subject, kind: MemberKind) -> Option<Doubt> {
        let aspect = if subject.kind == SubjectKind::Member { Aspect::Body } else { Aspect::Rotation };
        let trace = self.decision.trace(&subject.id)?;
        let decided = self.decision.answer(&subject.id, aspect)?;
        let ruled = trace.decision(aspect);
        let mut why: Vec<Why> =
            self.overloaded.get(subject.id.as_str()).map(|r| Why::Overloaded(*r)).into_iter().collect();
        let mut by = ruled.map(|f| f.rule.clone()).unwrap_or_default();
        let instead = self.decision.instead(&subject.id);
        if let Some((target, instead)) = &instead {
            by = super::ANALYST.to_string();
            why.extend(target.map(|_| Why::Override(instead.clone())));
        } else if let Some(firing) = ruled {
            why.extend(trace.firings.iter().filter_map(|f| conflict(firing, f, aspect)));
            if !firing.in_range {
                let what: Vec<&str> =
                    firing.outside.iter().chain(&firing.missing).map(String::as_str).collect();
                why.push(Why::OutOfRange(what.join(", ")));
            }
            why.extend(firing.confidence.filter(|c| *c < SURE).map(Why::Unsure));
        }
        if why.is_empty() {
            return None;
        }
        let alternative = match instead {
            Some((Some(target), _)) => Alternative::Without(target.to_string()),
            _ => alternative(&subject.id, decided, kind),
        };
        let (subjects, action) = (vec![subject.id.clone()], decided.spec().name.to_string());
        Some(Doubt { subjects, action, by, why, alternative })
    }
}

/// Another rule with evidence that says otherwise.
fn conflict(decides: &Firing, other: &Firing, aspect: Aspect) -> Option<Why> {
    let differs = other.action.spec().aspect == aspect && other.action != decides.action && other.in_range;
    let sure = other.confidence.filter(|_| differs)?;
    Some(Why::Conflict(other.rule.clone(), other.action.spec().name.to_string(), sure))
}

/// What could be decided about a member or end instead of an action.
fn alternative(id: &str, action: Action, kind: MemberKind) -> Alternative {
    let other = match (kind, action) {
        (MemberKind::Slab | MemberKind::Beam, Action::MergeRigid) => OverrideAction::MergeElastic,
        (MemberKind::Slab | MemberKind::Beam, Action::MergeElastic) => OverrideAction::MergeRigid,
        (MemberKind::Column, Action::Hinge) => OverrideAction::ElasticConnection,
        (MemberKind::Column, Action::ElasticConnection) => OverrideAction::Hinge,
        (MemberKind::Beam, Action::LatentHinge) => OverrideAction::RigidConnection,
        (MemberKind::Beam, Action::RigidConnection) => OverrideAction::LatentHinge,
        _ => return Alternative::Nothing,
    };
    Alternative::Decide(id.to_string(), other)
}

/// Ends without a hinge in the model whose reinforced section would yield in linear theory after the removal, worst first.
pub fn overloaded(demands: &Demands, live: &BTreeSet<&str>) -> Vec<(String, f64)> {
    let mut ends: Vec<(String, f64)> = demands
        .ends
        .iter()
        .filter(|e| !live.contains(e.id.as_str()))
        .filter_map(|e| Some((e.id.clone(), e.after.as_ref()?.section.ratio)))
        .filter(|(_, ratio)| *ratio > 1.0)
        .collect();
    ends.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    ends
}

/// The note about such an end.
pub fn overloaded_words(id: &str, ratio: f64, decision: &Decision) -> String {
    // an end that the rules have rigid anyway is so by the analyst where its whole floor is
    let floor = id.rsplit_once('.').map_or(id, |(member, _)| member);
    let is_whole = decision.answer(floor, Aspect::Body) == Some(Action::MergeRigid);
    let by = if decision.is_of_analyst(id) || (is_whole && decision.is_of_analyst(floor)) {
        "the analyst's decision"
    } else {
        "rule"
    };
    format!(
        "{id} stays rigid by {by}, though its reinforced section would yield after the removal \
         (elastic demand over capacity {ratio:.1})"
    )
}
