//! Asks the rules about every member and member end, and keeps their answers.

use super::grillage::on_axes;
use super::{Accuracy, GenerateError, is_column};
use crate::building::ends::{End, MemberEnd};
use crate::building::partition::Partition;
use crate::building::{Building, Member, MemberKind, Preparation};
use crate::graph::{Demands, EndState};
use crate::library::derive::beyond;
use crate::mbs::Model;
use crate::rules::{Action, Aspect, RuleBase, Subject, SubjectKind, Trace};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One reason: a rule that fired for a part of the building.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// Body or joint of the model.
    pub part: String,
    /// Member or member end that the rule decided about.
    pub subject: String,
    /// Rule id.
    pub rule: String,
    /// What the rule decided.
    pub action: String,
    /// The rule in words.
    pub words: String,
    /// Whether the subject lies in the rule's range of evidence.
    pub in_range: bool,
    /// Library entries of the part.
    pub entries: Vec<String>,
}

/// What the rules decided.
#[derive(Debug, Clone, Default)]
pub struct Decision {
    /// Members that may be one rigid body with neighbours of which the same is true.
    pub merges: Vec<bool>,
    /// Those of them whose floor bends.
    bends: Vec<bool>,
    /// Hinged member ends with the ids of the rules that put hinge and springs there.
    pub hinges: BTreeMap<String, Vec<String>>,
    /// Beam ends at which floors may fold, with the ids of the rules that say so.
    pub latent: BTreeMap<String, Vec<String>>,
    /// What the rules said, by subject.
    traces: BTreeMap<String, Trace>,
    /// What an analyst should look at.
    pub notes: Vec<String>,
}

impl Decision {
    /// Asks the rules. An end of a member that merges with its neighbours needs no decision of its own.
    pub fn of(
        building: &Building,
        partition: &Partition,
        ends: &[MemberEnd],
        demands: &Demands,
        accuracy: Accuracy,
        rules: &RuleBase,
    ) -> Result<Self, GenerateError> {
        let none = vec![false; building.members.len()];
        let mut this = Self { merges: none.clone(), bends: none, ..Self::default() };
        let known = Known::of(building, demands);
        let mut gaps = Vec::new();
        for index in 0..building.members.len() {
            let subject = member_subject(building, partition, index);
            let subject = known.added_to(subject, &building.members[index]);
            let subject = subject.with("wish.accuracy", accuracy.name());
            match this.ask(rules, &subject, Aspect::Body)? {
                Some(Action::MergeRigid) => this.merges[index] = true,
                Some(Action::MergeElastic) => (this.merges[index], this.bends[index]) = (true, true),
                Some(Action::RigidBody) => {}
                Some(other) => return Err(unsupported(&subject, other)),
                None => gaps.push(subject.id),
            }
        }
        for end in ends {
            let column = is_column(building, end.member);
            let subject = end_subject(building, partition, end, ends, demands);
            let subject = subject.with("wish.accuracy", accuracy.name());
            let answer = this.ask(rules, &subject, Aspect::Rotation)?;
            match answer {
                Some(Action::Hinge) if column => {
                    this.hinges.insert(end.id.clone(), this.fired(&end.id));
                }
                Some(Action::LatentHinge) if !column => {
                    this.latent.insert(end.id.clone(), this.fired(&end.id));
                }
                Some(Action::RigidConnection) if !column => {}
                Some(other) => return Err(unsupported(&subject, other)),
                None => gaps.push(end.id.clone()),
            }
        }
        if gaps.is_empty() { Ok(this) } else { Err(GenerateError::Gap(gaps)) }
    }

    /// Asks the rules about a subject; the answer to one question.
    fn ask(
        &mut self,
        rules: &RuleBase,
        subject: &Subject,
        aspect: Aspect,
    ) -> Result<Option<Action>, GenerateError> {
        let trace = rules.trace(subject)?;
        for firing in trace.firings.iter().filter(|f| !f.in_range && f.overruled_by.is_none()) {
            let why: Vec<&str> = firing.outside.iter().chain(&firing.missing).map(String::as_str).collect();
            self.notes.push(format!(
                "rule `{}` is used outside its range of evidence for {} ({})",
                firing.rule,
                subject.id,
                why.join(", ")
            ));
        }
        let answer = trace.decision(aspect).map(|f| f.action);
        self.traces.insert(subject.id.clone(), trace);
        Ok(answer)
    }

    /// The rules that decided about a subject.
    fn fired(&self, id: &str) -> Vec<String> {
        let firings = self.traces[id].firings.iter().filter(|f| f.overruled_by.is_none());
        firings.map(|f| f.rule.clone()).collect()
    }

    /// Whether the floor of some members bends: if a rule says so of any of them.
    pub fn bends(&self, members: &[usize]) -> bool {
        members.iter().any(|m| self.bends[*m])
    }

    /// Rules that made some members one body.
    pub fn rules_of(&self, building: &Building, members: &[usize]) -> Vec<String> {
        let mut rules: Vec<String> = members
            .iter()
            .filter_map(|m| self.traces.get(&building.members[*m].id)?.decision(Aspect::Body))
            .map(|f| f.rule.clone())
            .collect();
        rules.sort();
        rules.dedup();
        rules
    }

    /// The reasons of each part, in the order of the model.
    pub fn reasons(&self, rules: &RuleBase, model: &Model) -> Vec<Reason> {
        let bodies = model.bodies.iter().map(|b| (&b.id, &b.origin));
        let joints = model.bushings.iter().map(|j| (&j.id, &j.origin));
        let mut reasons = Vec::new();
        for (part, origin) in bodies.chain(joints) {
            for trace in origin.members.iter().filter_map(|subject| self.traces.get(subject)) {
                for firing in trace.firings.iter().filter(|f| f.overruled_by.is_none()) {
                    reasons.push(Reason {
                        part: part.clone(),
                        subject: trace.subject.clone(),
                        rule: firing.rule.clone(),
                        action: firing.action.spec().name.to_string(),
                        words: rules.rule(&firing.rule).map(|r| r.words.clone()).unwrap_or_default(),
                        in_range: firing.in_range,
                        entries: origin.entries.clone(),
                    });
                }
            }
        }
        reasons
    }
}

/// A decision that this version of the generator cannot carry out.
fn unsupported(subject: &Subject, action: Action) -> GenerateError {
    GenerateError::Unsupported(action.spec().name.to_string(), subject.id.clone())
}

/// What is known of a member before any run.
fn member_subject(building: &Building, partition: &Partition, index: usize) -> Subject {
    let member = &building.members[index];
    let range = crate::building::tracked::clear_range(partition, index, member.axis);
    let size = member.solid.size();
    let bar = matches!(member.kind, MemberKind::Column | MemberKind::Beam);
    let length =
        if bar { range.map_or(0.0, |r| r[1] - r[0]) } else { size.iter().copied().fold(0.0, f64::max) };
    let least = size.iter().copied().fold(f64::INFINITY, f64::min);
    let storeys = building.members.iter().filter_map(|m| m.storey).max().unwrap_or(0);
    Subject::new(SubjectKind::Member, &member.id)
        .with("member.kind", member.kind.name())
        .with("member.charged", building.events.iter().any(|e| e.member == member.id))
        .with("member.weakened", is_weakened(building, &member.id))
        .with("member.length", length)
        .with("member.slenderness", length / least)
        .with("collapse.phase", "before_contact")
        .with("critical_strain_rate", building.settings.critical_strain_rate_1_s)
        .with("storeys", f64::from(storeys))
}

/// What is known of the building as a whole.
struct Known {
    /// Largest demand over capacity of its column ends.
    demand_ratio: Option<f64>,
    /// Longest span between axes of columns \[m\].
    span_m: f64,
    /// Depth of the floor of each storey: that of its deepest beam, or of its slabs where there is none \[m\].
    depth_m: BTreeMap<Option<u32>, f64>,
}

impl Known {
    fn of(building: &Building, demands: &Demands) -> Self {
        let columns = || building.members.iter().filter(|m| m.kind == MemberKind::Column);
        let span = |axis: usize| {
            let axes = on_axes(columns().map(|m| [m.solid.center()[axis], 0.0]).collect());
            axes.windows(2).map(|w| w[1][0] - w[0][0]).fold(0.0, f64::max)
        };
        let depths = |kind: MemberKind| {
            let mut depths = BTreeMap::<Option<u32>, f64>::new();
            for member in building.members.iter().filter(|m| m.kind == kind) {
                let depth = depths.entry(member.storey).or_default();
                *depth = depth.max(member.solid.size()[2]);
            }
            depths
        };
        let mut depth_m = depths(MemberKind::Slab);
        depth_m.extend(depths(MemberKind::Beam));
        Self { demand_ratio: demands.largest_of_columns(building), span_m: span(0).max(span(1)), depth_m }
    }

    /// With what it says of a member.
    fn added_to(&self, subject: Subject, member: &Member) -> Subject {
        let known = |subject: Subject, name: &str, value: Option<f64>| match value {
            Some(value) => subject.with(name, value),
            None => subject,
        };
        let floor = matches!(member.kind, MemberKind::Slab | MemberKind::Beam) && self.span_m > 0.0;
        let depth = self.depth_m.get(&member.storey).filter(|_| floor);
        let subject = known(subject, "building.demand_ratio", self.demand_ratio);
        known(subject, "floor.slenderness", depth.map(|depth| self.span_m / depth))
    }
}

/// What is known of a member end before any run.
fn end_subject(
    building: &Building,
    partition: &Partition,
    end: &MemberEnd,
    ends: &[MemberEnd],
    demands: &Demands,
) -> Subject {
    let mut subject = member_subject(building, partition, end.member);
    let adjoining = beyond(partition, end).map(|m| building.members[m].kind.name());
    let column = is_column(building, end.member);
    let position = match (column, end.end) {
        (true, End::Lower) => "bottom",
        (true, End::Upper) => "top",
        (false, End::Lower) => "start",
        (false, End::Upper) => "end",
    };
    let clamped =
        adjoining.is_none() && building.supports.iter().any(|s| s.member == building.members[end.member].id);
    subject.id.clone_from(&end.id);
    subject.kind = SubjectKind::MemberEnd;
    let columns = ends.iter().filter(|e| !column && is_column(building, e.member));
    let at_joint: Vec<&str> = columns.filter(|e| meets(building, end, e)).map(|e| e.id.as_str()).collect();
    let [own, most] = leading_ratios(demands, &end.id, &at_joint);
    if let Some(own) = own {
        subject = subject.with("end.demand_ratio", own);
    }
    if let Some(most) = most {
        subject = subject.with("end.column_demand_ratio", most);
    }
    subject
        .with("end.position", position)
        .with("end.clamped", clamped)
        .with("end.adjoining", adjoining.unwrap_or(if clamped { "ground" } else { "none" }))
}

/// Demand ratios of an end and the largest of the columns at its joint: after the removal, or between two charges if only there, or more there, the end has the larger one of the joint.
fn leading_ratios(demands: &Demands, id: &str, at_joint: &[&str]) -> [Option<f64>; 2] {
    let place = |id: &str| demands.ends.iter().position(|d| d.id == id);
    let (own, columns): (_, Vec<usize>) = (place(id), at_joint.iter().filter_map(|c| place(c)).collect());
    let ratio = |state: Option<EndState>| state.map(|s| s.section.ratio);
    let after = |i: usize| ratio(demands.ends[i].after);
    let pair = |of: &dyn Fn(usize) -> Option<f64>| {
        [own.and_then(of), columns.iter().filter_map(|c| of(*c)).reduce(f64::max)]
    };
    let leads = |[own, most]: &[Option<f64>; 2]| own > most && most.is_some();
    let stages = demands.stages.iter().map(|stage| pair(&|i| ratio(stage[i])));
    let last = pair(&after);
    let rank = |pair: &[Option<f64>; 2]| if leads(pair) { pair[0].unwrap_or(0.0) } else { 0.0 };
    stages.fold(last, |best, next| if rank(&next) > rank(&best) { next } else { best })
}

/// How far apart the ends of a beam and a column at one joint may be beyond their sizes \[m\].
const JOINT_TOLERANCE_M: f64 = 0.05;

/// Whether a column ends at the joint that a beam frames into.
fn meets(building: &Building, beam: &MemberEnd, column: &MemberEnd) -> bool {
    let size = building.members[column.member].solid.size();
    let deep = building.members[beam.member].solid.size()[2];
    let reach = [0.5 * size[0], 0.5 * size[1], deep];
    (0..3).all(|i| (beam.point_m[i] - column.point_m[i]).abs() <= reach[i] + JOINT_TOLERANCE_M)
}

fn is_weakened(building: &Building, member: &str) -> bool {
    building.preparation.iter().any(|p| matches!(p, Preparation::Weaken { member: m, .. } if m == member))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::EndDemand;
    use crate::graph::demand::{StateSummary, Utilisation};
    use crate::graph::frame::SectionForces;

    #[test]
    fn a_beam_that_leads_its_joint_between_two_charges_is_judged_there() {
        let state = |ratio: f64| {
            let own = Utilisation { capacity_nm: [1.0; 2], ratio };
            Some(EndState { forces: SectionForces::default(), section: own, homogenised: own })
        };
        let ends = |beam: f64, column: f64| vec![state(beam), state(column)];
        let demands = |after: [f64; 2], stages: Vec<Vec<Option<EndState>>>| Demands {
            before: StateSummary::Failed { reason: String::new() },
            after: None,
            ends: ["beam", "column"]
                .iter()
                .zip(after)
                .map(|(id, ratio)| EndDemand { id: (*id).into(), before: None, after: state(ratio) })
                .collect(),
            stages,
        };
        let of = |d: &Demands| leading_ratios(d, "beam", &["column"]).map(Option::unwrap_or_default);
        // never ahead of its column: as it is at the end
        assert_eq!(of(&demands([3.0, 19.0], vec![ends(0.2, 0.4)])), [3.0, 19.0]);
        // ahead while some columns are still there
        assert_eq!(of(&demands([3.0, 19.0], vec![ends(0.2, 0.4), ends(2.0, 0.6)])), [2.0, 0.6]);
        // ahead there and, further, at the end
        assert_eq!(of(&demands([3.0, 1.0], vec![ends(2.0, 0.6)])), [3.0, 1.0]);
    }
}
