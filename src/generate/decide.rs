//! Asks the rules about every member and member end, and keeps their answers.

use super::analyst::{ANALYST, Answers};
use super::known::Known;
use super::sections::Sections;
use super::webs::web_of;
use super::{Accuracy, GenerateError, is_column};
use crate::building::ends::{self, MemberEnd};
use crate::building::{Building, MemberKind};
use crate::graph::{Connection, End};
use crate::mbs::Model;
use crate::rules::features::MEMBER_KINDS;
use crate::rules::{
    Action, Aspect, Firing, RuleBase, Subject, SubjectError, SubjectKind, Trace, Value, carried,
};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// One reason: a rule that fired for a part of the building, or a decision of the analyst in place of one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// Body or joint of the model.
    pub part: String,
    /// Member or member end that the rule decided about.
    pub subject: String,
    /// Rule id, or [`ANALYST`].
    pub rule: String,
    /// What is decided.
    pub action: String,
    /// The rule in words, or the analyst's reason.
    pub words: String,
    /// Whether the subject lies in the rule's range of evidence.
    pub in_range: bool,
    /// How sure the rule is, if it was learned from studies.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Library entries of the part.
    pub entries: Vec<String>,
    /// What rules would have decided in place of the analyst.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub instead_of: Vec<Superseded>,
}

impl Reason {
    /// Whether the analyst has decided.
    pub fn is_of_analyst(&self) -> bool {
        self.rule == ANALYST
    }

    /// What the rules would have said, in words: `hinge (seed/column-end-hinge)`; nothing where rules have decided.
    pub fn instead_words(&self) -> String {
        let rules: Vec<String> =
            self.instead_of.iter().map(|s| format!("{} ({})", s.action, s.rule)).collect();
        match rules.as_slice() {
            [] if self.is_of_analyst() => "no rule decides".to_string(),
            [] => String::new(),
            _ => format!("the rules would have said {}", rules.join(", ")),
        }
    }
}

/// What a rule would have decided.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Superseded {
    /// Rule id.
    pub rule: String,
    /// What it says.
    pub action: String,
    /// Whether the subject lies in its range of evidence.
    pub in_range: bool,
}

/// A decision of the analyst about a subject.
#[derive(Debug, Clone)]
struct Overruled {
    aspect: Aspect,
    action: Action,
    reason: String,
    /// The target of the override, if it does not just follow from one.
    target: Option<String>,
}

/// What rules and analyst decided.
#[derive(Debug, Clone, Default)]
pub struct Decision {
    /// Members that may be one rigid body with neighbours of which the same is true.
    pub merges: Vec<bool>,
    /// Those of them whose floor bends.
    bends: Vec<bool>,
    /// Hinged member ends with the ids of the rules that put hinge and springs there.
    pub hinges: BTreeMap<String, Vec<String>>,
    /// Those of them that stay elastic.
    pub elastic: BTreeSet<String>,
    /// Beam ends at which floors may fold, with the ids of the rules that say so.
    pub latent: BTreeMap<String, Vec<String>>,
    /// Lines of slabs, and bases and tops of walls, that stay elastic.
    pub elastic_lines: BTreeSet<String>,
    /// Columns that may break between their ends once something has happened to them.
    sections: BTreeMap<usize, Sections>,
    /// Beams that may break away from their slab then.
    webs: BTreeSet<usize>,
    /// Column ends that do not turn in their joints, by member.
    rigid: BTreeSet<(usize, End)>,
    /// What the rules said, by subject.
    traces: BTreeMap<String, Trace>,
    /// What the analyst decided otherwise, by subject.
    overruled: BTreeMap<String, Overruled>,
    /// What an analyst should look at.
    pub notes: Vec<String>,
    /// Rules outside their range of evidence, and whether they decide there: the first subject with what is outside, and how many more.
    beyond: BTreeMap<(String, bool), (String, usize)>,
}

/// Who is asked about what.
struct Questions<'a> {
    building: &'a Building,
    places: &'a [MemberEnd],
    known: &'a Known,
    accuracy: Accuracy,
    rules: &'a RuleBase,
    answers: &'a Answers,
}

/// A subject with what the rules say of it.
type Asked = Result<(Subject, Trace), SubjectError>;

impl Questions<'_> {
    /// With the level of detail that is wished for.
    fn wished(&self, subject: &Subject) -> Subject {
        subject.clone().with("wish.accuracy", self.accuracy.name())
    }

    fn traced(&self, subject: Subject) -> Asked {
        self.rules.trace(&subject).map(|trace| (subject, trace))
    }

    /// What the rules say of a subject depends on it alone: they are asked side by side, and answers are taken in their order.
    fn ask(&self, list: &[Subject]) -> Vec<Asked> {
        list.par_iter().map(|subject| self.traced(self.wished(subject))).collect()
    }

    /// What they say of members that may break away from their slabs after the first contact: those of which any rule may say so, or of which the analyst does.
    fn ask_later(&self) -> Vec<(usize, Asked)> {
        let kinds = parting(self.rules, self.accuracy);
        let may_part = |i: &usize| {
            let member = &self.building.members[*i];
            kinds.contains(&member.kind.name()) || self.answers.about(&web_of(&member.id), None).is_some()
        };
        let later = |i: usize| {
            let subject = &self.known.members[i];
            let later = Subject { id: web_of(&subject.id), ..self.wished(subject) };
            (i, self.traced(later.with("collapse.phase", "after_contact")))
        };
        let members: Vec<usize> = (0..self.known.members.len()).filter(may_part).collect();
        members.into_par_iter().map(later).collect()
    }
}

impl Decision {
    /// Asks the rules. An end of a member that merges with its neighbours needs no decision of its own.
    pub fn of(
        building: &Building,
        places: &[MemberEnd],
        known: &Known,
        accuracy: Accuracy,
        rules: &RuleBase,
        answers: &Answers,
    ) -> Result<Self, GenerateError> {
        let none = vec![false; building.members.len()];
        let mut this = Self { merges: none.clone(), bends: none, ..Self::default() };
        let questions = Questions { building, places, known, accuracy, rules, answers };
        let mut gaps = Vec::new();
        this.of_members(&questions, &mut gaps)?;
        this.of_ends(&questions, &mut gaps)?;
        this.of_lines(&questions, &mut gaps)?;
        for (index, subject) in known.members.iter().enumerate().filter(|(i, _)| is_column(building, *i)) {
            this.divide(rules, index, &questions.wished(subject))?;
        }
        this.of_webs(&questions)?;
        this.notes.extend(this.beyond.iter().map(beyond_words));
        if gaps.is_empty() { Ok(this) } else { Err(GenerateError::Gap(gaps)) }
    }

    /// How members become bodies.
    fn of_members(&mut self, asked: &Questions<'_>, gaps: &mut Vec<String>) -> Result<(), GenerateError> {
        for (index, said) in asked.ask(&asked.known.members).into_iter().enumerate() {
            let (subject, trace) = said?;
            match self.answered(asked.answers, &subject, trace, Aspect::Body) {
                Some(Action::MergeRigid) => self.merges[index] = true,
                Some(Action::MergeElastic) => (self.merges[index], self.bends[index]) = (true, true),
                Some(_) => {}
                None => gaps.push(subject.id.clone()),
            }
            self.carried_out(asked, &subject, Aspect::Body)?;
            self.carried_out(asked, &subject, Aspect::Charge)?;
        }
        Ok(())
    }

    /// That what a rule decides about a subject can be carried out; the overrides of a building file have been checked with it.
    fn carried_out(
        &self,
        asked: &Questions<'_>,
        subject: &Subject,
        aspect: Aspect,
    ) -> Result<(), GenerateError> {
        let overruled = self.overruled.get(&subject.id).is_some_and(|o| o.aspect == aspect);
        let ruled = self.traces.get(&subject.id).and_then(|trace| trace.decision(aspect));
        let Some(firing) = ruled.filter(|_| !overruled) else { return Ok(()) };
        let kind = match subject.features.get("member.kind") {
            Some(Value::Name(kind)) => kind.as_str(),
            _ => "",
        };
        let charged = subject.features.get("member.charged") == Some(&Value::Flag(true));
        let known = carried::actions(subject.kind, kind, aspect).contains(&firing.action);
        if known && (charged || firing.action != Action::RemoveBody) {
            return Ok(());
        }
        let place = asked.rules.rule(&firing.rule).map(|rule| format!(" ({})", rule.place.short()));
        Err(GenerateError::Unsupported {
            rule: firing.rule.clone(),
            place: place.unwrap_or_default(),
            action: firing.action.spec().name,
            subject: subject.id.clone(),
            remedy: carried::remedy(subject.kind, kind, firing.action),
        })
    }

    /// How the ends of columns and beams resist rotation.
    fn of_ends(&mut self, asked: &Questions<'_>, gaps: &mut Vec<String>) -> Result<(), GenerateError> {
        for (end, said) in asked.places.iter().zip(asked.ask(&asked.known.ends)) {
            let column = is_column(asked.building, end.member);
            let (subject, trace) = said?;
            match self.answered(asked.answers, &subject, trace, Aspect::Rotation) {
                Some(Action::Hinge) if column => {
                    self.hinges.insert(end.id.clone(), self.fired(&end.id));
                }
                Some(Action::ElasticConnection) if column => {
                    self.hinges.insert(end.id.clone(), self.fired(&end.id));
                    self.elastic.insert(end.id.clone());
                }
                Some(Action::LatentHinge) if !column => {
                    self.latent.insert(end.id.clone(), self.fired(&end.id));
                }
                Some(Action::RigidConnection) if column && self.overruled.contains_key(&end.id) => {
                    let upper = end.end == ends::End::Upper;
                    self.rigid.insert((end.member, if upper { End::High } else { End::Low }));
                }
                Some(_) => {}
                None => gaps.push(end.id.clone()),
            }
            self.carried_out(asked, &subject, Aspect::Rotation)?;
            self.carried_out(asked, &subject, Aspect::Translation)?;
        }
        Ok(())
    }

    /// Whether lines of slabs and ends of walls yield.
    fn of_lines(&mut self, asked: &Questions<'_>, gaps: &mut Vec<String>) -> Result<(), GenerateError> {
        for said in asked.ask(&asked.known.lines) {
            let (subject, trace) = said?;
            match self.answered(asked.answers, &subject, trace, Aspect::Rotation) {
                Some(Action::ElasticConnection) => _ = self.elastic_lines.insert(subject.id.clone()),
                Some(_) => {}
                None => gaps.push(subject.id.clone()),
            }
            self.carried_out(asked, &subject, Aspect::Rotation)?;
        }
        Ok(())
    }

    /// Which beams may break away from their slabs.
    fn of_webs(&mut self, asked: &Questions<'_>) -> Result<(), GenerateError> {
        let mut others: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        for (index, said) in asked.ask_later() {
            let member = &asked.building.members[index];
            match self.break_away(asked.answers, said?) {
                Some(_) if member.kind == MemberKind::Beam => _ = self.webs.insert(index),
                Some(rule) => others.entry(rule).or_default().push(&member.id),
                None => {}
            }
        }
        self.notes.extend(others.iter().map(|(rule, members)| {
            let members = members.join(", ");
            format!("rule `{rule}` has {members} break away from a slab, which only beams can: ask for `member.kind == 'beam'` in its condition")
        }));
        Ok(())
    }

    /// Asks the rules where a column may break between its ends after the first contact. Only one with hinges at its ends can: what it bears is known from there.
    fn divide(&mut self, rules: &RuleBase, member: usize, subject: &Subject) -> Result<(), GenerateError> {
        let is_charged = subject.features.get("member.charged") == Some(&Value::Flag(true));
        let hinged = ["bottom", "top"].iter().all(|end| {
            let id = format!("{}.{end}", subject.id);
            self.hinges.contains_key(&id) && !self.elastic.contains(&id)
        });
        if is_charged || !hinged {
            return Ok(());
        }
        let later = Subject { id: format!("{} after contact", subject.id), ..subject.clone() }
            .with("collapse.phase", "after_contact");
        let trace = rules.trace(&later)?;
        let Some(firing) = trace.decision(Aspect::Body).filter(|f| f.action == Action::Subdivide) else {
            return Ok(());
        };
        let number = |name: &str| match firing.parameters.get(name) {
            Some(Value::Number(value)) => Some(*value),
            _ => None,
        };
        let longest =
            number("least_length_m").zip(subject.number("member.length")).map(|(least, all)| all / least);
        let pieces = number("pieces").unwrap_or(2.0).min(longest.unwrap_or(f64::INFINITY)) as usize;
        let sections = Sections::of(&subject.id, pieces.max(1));
        let mut traces = Vec::new();
        for section in sections.subjects(&later) {
            let mut trace = rules.trace(&section)?;
            if trace.decision(Aspect::Rotation).map(|f| f.action) != Some(Action::LatentHinge) {
                return Ok(());
            }
            // the section is there because its member is divided
            trace.firings.insert(0, firing.clone());
            traces.push((section.id, trace));
        }
        if !traces.is_empty() {
            self.traces.extend(traces);
            self.sections.insert(member, sections);
        }
        Ok(())
    }

    /// Whether a member may break away from its slab after the first contact, by the rules or the analyst; the rule that says so.
    fn break_away(&mut self, answers: &Answers, (later, mut trace): (Subject, Trace)) -> Option<String> {
        // what the rules say of its body is asked elsewhere
        trace.firings.retain(|f| f.action == Action::BreakAway);
        if trace.firings.is_empty() && answers.about(&later.id, None).is_none() {
            return None;
        }
        self.answered(answers, &later, trace, Aspect::Parting).and(self.fired(&later.id).into_iter().next())
    }

    /// Whether a beam may break away from its slab.
    pub fn breaks_away(&self, member: usize) -> bool {
        self.webs.contains(&member)
    }

    /// Columns that may break between their ends, by member.
    pub fn sections(&self) -> impl Iterator<Item = (usize, &Sections)> {
        self.sections.iter().map(|(member, sections)| (*member, sections))
    }

    /// The sections of a member.
    pub fn sections_of(&self, member: usize) -> Option<&Sections> {
        self.sections.get(&member)
    }

    /// The answer to a question about a subject, by the analyst or the rules, which have been asked.
    fn answered(
        &mut self,
        answers: &Answers,
        subject: &Subject,
        trace: Trace,
        aspect: Aspect,
    ) -> Option<Action> {
        let ruled = trace.decision(aspect).map(|f| f.action);
        let answer = answers.about(&subject.id, ruled);
        let overruled = |f: &&Firing| answer.is_some() && f.action.spec().aspect == aspect;
        for firing in trace.firings.iter().filter(|f| !f.in_range && !overruled(f)) {
            let decides = trace.standing().any(|f| f.rule == firing.rule);
            // what a rule that was not learned would say outside its range is of no interest where another one decides
            if !decides && firing.confidence.is_none() {
                continue;
            }
            let why: Vec<&str> = firing.outside.iter().chain(&firing.missing).map(String::as_str).collect();
            let first = || (format!("{} ({})", subject.id, why.join(", ")), 0);
            let key = (firing.rule.clone(), decides);
            self.beyond.entry(key).and_modify(|(_, more)| *more += 1).or_insert_with(first);
        }
        self.traces.insert(subject.id.clone(), trace);
        let Some(answer) = answer else { return ruled };
        let target = Some(answer.target.clone()).filter(|_| !answer.follows);
        let overruled = Overruled { aspect, action: answer.action, reason: answer.reason.clone(), target };
        self.overruled.insert(subject.id.clone(), overruled);
        Some(answer.action)
    }

    /// The firings of rules about a subject that count.
    pub(super) fn standing(&self, id: &str) -> impl Iterator<Item = &Firing> {
        let overruled = self.overruled.get(id).map(|o| o.aspect);
        let firings = self.traces.get(id).into_iter().flat_map(Trace::standing);
        firings.filter(move |f| Some(f.action.spec().aspect) != overruled)
    }

    /// The rules that decided about a subject, or the analyst.
    pub fn fired(&self, id: &str) -> Vec<String> {
        let analyst = self.overruled.get(id).map(|_| ANALYST.to_string());
        analyst.into_iter().chain(self.standing(id).map(|f| f.rule.clone())).collect()
    }

    /// Whether what two members share makes them one body.
    pub fn joined(&self, connection: &Connection) -> bool {
        let [a, b] = connection.members;
        let rigid = |end: End| {
            let other = if end == End::Low { End::High } else { End::Low };
            // the end is one of the first member; of two columns the second one meets it with its other end
            self.rigid.contains(&(a, end)) || self.rigid.contains(&(b, other))
        };
        (self.merges[a] && self.merges[b]) || connection.end.is_some_and(rigid)
    }

    /// What the rules said about a subject.
    pub fn trace(&self, id: &str) -> Option<&Trace> {
        self.traces.get(id)
    }

    /// The answer to a question about a subject, by the analyst or the rules.
    pub fn answer(&self, id: &str, aspect: Aspect) -> Option<Action> {
        let ruled = || self.traces.get(id)?.decision(aspect).map(|f| f.action);
        self.overruled.get(id).filter(|o| o.aspect == aspect).map(|o| o.action).or_else(ruled)
    }

    /// Where the analyst has decided about a subject: the target of the override, unless it just follows from one, and what the rules would have said.
    pub fn instead(&self, id: &str) -> Option<(Option<&str>, String)> {
        let target = self.overruled.get(id)?.target.as_deref();
        self.of_analyst(id, "", &[]).map(|reason| (target, reason.instead_words()))
    }

    /// Whether the analyst has decided about a subject.
    pub fn is_of_analyst(&self, id: &str) -> bool {
        self.overruled.contains_key(id)
    }

    /// The first of some subjects of which the analyst asks that its floor is divided, and whether it is to bend.
    pub fn division_asked<'a>(&self, mut ids: impl Iterator<Item = &'a String>) -> Option<(String, bool)> {
        ids.find_map(|id| match self.overruled.get(id)?.action {
            Action::MergeElastic => Some((id.clone(), true)),
            Action::LatentHinge => Some((id.clone(), false)),
            _ => None,
        })
    }

    /// Whether the floor of some members bends: if that is decided about any of them.
    pub fn bends(&self, members: &[usize]) -> bool {
        members.iter().any(|m| self.bends[*m])
    }

    /// The rules, not the analyst, that decide how some members become bodies by an action, with these members.
    pub fn ruled(
        &self,
        building: &Building,
        members: &[usize],
        action: Action,
    ) -> BTreeMap<String, Vec<String>> {
        let mut rules = BTreeMap::<String, Vec<String>>::new();
        let ids = members.iter().map(|m| &building.members[*m].id);
        for id in ids.filter(|id| !self.overruled.contains_key(*id)) {
            let decides = self.traces.get(id).and_then(|trace| trace.decision(Aspect::Body));
            if let Some(firing) = decides.filter(|f| f.action == action) {
                rules.entry(firing.rule.clone()).or_default().push(id.clone());
            }
        }
        rules
    }

    /// Rules that made some members one body.
    pub fn rules_of(&self, building: &Building, members: &[usize]) -> Vec<String> {
        let by_analyst = |m: &usize| {
            let rigid = [End::Low, End::High].iter().any(|end| self.rigid.contains(&(*m, *end)));
            rigid || self.overruled.contains_key(&building.members[*m].id)
        };
        let ruled = members.iter().filter(|m| !self.overruled.contains_key(&building.members[**m].id));
        let mut rules: Vec<String> = ruled
            .filter_map(|m| self.traces.get(&building.members[*m].id)?.decision(Aspect::Body))
            .map(|f| f.rule.clone())
            .collect();
        rules.extend(members.iter().any(by_analyst).then(|| ANALYST.to_string()));
        rules.sort();
        rules.dedup();
        rules
    }

    /// The reasons of each part, in the order of the model; then decisions of the analyst about ends where there is no joint.
    pub fn reasons(&self, rules: &RuleBase, model: &Model) -> Vec<Reason> {
        let bodies = model.bodies.iter().map(|b| (&b.id, &b.origin));
        let joints = model.bushings.iter().map(|j| (&j.id, &j.origin));
        let (mut reasons, mut told) = (Vec::new(), BTreeSet::new());
        for (part, origin) in bodies.chain(joints) {
            for subject in origin.members.iter().filter(|id| self.traces.contains_key(*id)) {
                told.insert(subject.as_str());
                reasons.extend(self.of_analyst(subject, part, &origin.entries));
                for firing in self.standing(subject) {
                    reasons.push(Reason {
                        part: part.clone(),
                        subject: subject.clone(),
                        rule: firing.rule.clone(),
                        action: firing.action.spec().name.to_string(),
                        words: rules.rule(&firing.rule).map(|r| r.words.clone()).unwrap_or_default(),
                        in_range: firing.in_range,
                        confidence: firing.confidence,
                        entries: origin.entries.clone(),
                        instead_of: Vec::new(),
                    });
                }
            }
        }
        for subject in self.overruled.keys().filter(|id| !told.contains(id.as_str())) {
            let parts = subject.split_once(':').or_else(|| subject.rsplit_once('.'));
            let member = parts.map_or(subject.as_str(), |(member, _)| member);
            let body = model.bodies.iter().find(|b| b.origin.members.iter().any(|m| m == member));
            reasons.extend(body.and_then(|body| self.of_analyst(subject, &body.id, &[])));
        }
        reasons
    }

    /// The analyst's decision about a subject as the reason of a part.
    pub(super) fn of_analyst(&self, subject: &str, part: &str, entries: &[String]) -> Option<Reason> {
        let overruled = self.overruled.get(subject)?;
        let firings = self.traces.get(subject).into_iter().flat_map(Trace::standing);
        let superseded = firings.filter(|f| f.action.spec().aspect == overruled.aspect).map(|f| Superseded {
            rule: f.rule.clone(),
            action: f.action.spec().name.to_string(),
            in_range: f.in_range,
        });
        Some(Reason {
            part: part.to_string(),
            subject: subject.to_string(),
            rule: ANALYST.to_string(),
            action: overruled.action.spec().name.to_string(),
            words: overruled.reason.clone(),
            in_range: true,
            confidence: None,
            entries: entries.to_vec(),
            instead_of: superseded.collect(),
        })
    }
}

/// Kinds of members that a rule may have break away from their slabs.
fn parting(rules: &RuleBase, accuracy: Accuracy) -> Vec<&'static str> {
    let may = |kind: &&&str| {
        let subject = Subject::new(SubjectKind::Member, kind)
            .with("member.kind", **kind)
            .with("collapse.phase", "after_contact")
            .with("wish.accuracy", accuracy.name());
        rules.possible(&subject).any(|rule| rule.action == Action::BreakAway)
    };
    MEMBER_KINDS.iter().filter(may).copied().collect()
}

/// What to know of a rule outside its range of evidence.
fn beyond_words(((rule, decides), (first, more)): (&(String, bool), &(String, usize))) -> String {
    let what = if *decides {
        "is used outside its range of evidence"
    } else {
        "is not used outside its range of evidence"
    };
    let more = if *more > 0 { format!(" and {more} more") } else { String::new() };
    format!("rule `{rule}` {what}: {first}{more}")
}
