//! `fallwerk explain`: why a part of a generated model is there. Also the trace file that holds the reasons.

use super::explain_entry::{self, EntryFacts};
use super::knowledge::KnowledgeArgs;
use super::{Failure, Outcome, counted, explain_events, explain_joint, knowledge, print};
use crate::base::diagnostic::{closest, quoted};
use crate::base::json;
use crate::building::Building;
use crate::generate::{EventReason, Generated, Jointless, Reason, StaysWhole, Unasked, Unmet, web_of};
use crate::mbs::Model;
use crate::mbs::model::{Body, Bushing, Event, Origin};
use crate::review::{Item, REVIEW_SCHEMA, Review};
use serde::{Deserialize, Serialize};
use serde_json::json;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Version of `trace.json`.
pub const TRACE_SCHEMA: u32 = 1;

/// Explain a body or joint of a generated model
///
/// Prints the members that the part stands for, the rules that made it and the library entries it uses, from the trace.json
/// beside the model; without one, from the model, the rule base and the library. A member that is part of a body is
/// found too. Rules about contacts and fractures that may fire for it in a run are told with what is left of their conditions, those that
/// are never asked for it by name, and with the mbs.json of a run beside the model what fired when and which sections gave way.
/// Exit codes: 0 done, 2 bad input.
#[derive(clap::Args)]
pub struct Arguments {
    /// The model file
    model: PathBuf,
    /// Id of a body, joint, member, end of a member (`C1-A1.top`, `W1.bottom`) or strip of a slab (`S1:C1-A1|C1-B1`)
    part: String,
    #[command(flatten)]
    knowledge: KnowledgeArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// `trace.json`: the reasons of each part of a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TraceFile {
    /// Always [`TRACE_SCHEMA`].
    pub schema: u32,
    /// Name of the building.
    pub building: String,
    /// Hash of the resolved building.
    pub building_hash: String,
    /// Version of the program.
    pub program_version: String,
    /// Rules that fired, in the order of the model.
    pub reasons: Vec<Reason>,
    /// The library entries used, by key.
    pub entries: BTreeMap<String, EntryFacts>,
    /// Rules about contacts and fractures that stand in the model, in the order in which they decide.
    #[serde(default)]
    pub event_rules: Vec<EventReason>,
    /// Rules about events that are not asked.
    #[serde(default)]
    pub unasked: Vec<Unasked>,
    /// Why beams stay one with their slabs.
    #[serde(default)]
    pub stays: Vec<StaysWhole>,
    /// Why ends have no joint.
    #[serde(default)]
    pub jointless: Vec<Jointless>,
    /// What rules decide about parts of floors and the floors are not.
    #[serde(default)]
    pub unmet: Vec<Unmet>,
    /// What an analyst should look at.
    pub notes: Vec<String>,
}

impl TraceFile {
    /// The trace of a generated model.
    pub fn of(building: &Building, building_hash: &str, generated: &Generated) -> Self {
        Self {
            schema: TRACE_SCHEMA,
            building: building.name.clone(),
            building_hash: building_hash.to_string(),
            program_version: env!("CARGO_PKG_VERSION").to_string(),
            reasons: generated.trace.clone(),
            entries: generated
                .entries
                .iter()
                .map(|(key, entry)| (key.clone(), EntryFacts::of(entry, generated.scaled.get(key))))
                .collect(),
            event_rules: generated.event_rules.clone(),
            unasked: generated.unasked.clone(),
            stays: generated.stays.clone(),
            jointless: generated.jointless.clone(),
            unmet: generated.unmet.clone(),
            notes: generated.notes.clone(),
        }
    }

    /// What rules say of an end that no part stands for, with that end alone.
    fn jointless_at(&self, end: &str) -> Vec<Jointless> {
        let about = self.jointless.iter().filter(|j| j.ends.iter().any(|e| e == end));
        about.map(|j| Jointless { ends: vec![end.to_string()], ..j.clone() }).collect()
    }

    /// The trace beside a model file; `None` if there is no such file.
    fn beside(model: &Path) -> Result<Option<Self>, Failure> {
        let path = model.with_file_name("trace.json");
        let Ok(text) = std::fs::read_to_string(&path) else { return Ok(None) };
        let wrong = |what: String| Failure::input(format!("{}: {what}", path.display()));
        let trace: Self = json::from_text(&text).map_err(|e| wrong(e.to_string()))?;
        if trace.schema == TRACE_SCHEMA {
            Ok(Some(trace))
        } else {
            Err(wrong(format!("schema {}, this program reads schema {TRACE_SCHEMA}", trace.schema)))
        }
    }
}

/// A part of a model.
enum Part<'a> {
    Body(&'a Body),
    Joint(&'a Bushing),
}

impl<'a> Part<'a> {
    /// The body or joint with this id, else the joint of an end, the body that a member is part of, a joint on a line of a slab, or the body of an end without a joint.
    fn find(model: &'a Model, id: &str) -> Option<Self> {
        let body = |f: &dyn Fn(&&Body) -> bool| model.bodies.iter().find(f).map(Self::Body);
        body(&|b| b.id == id)
            .or_else(|| model.bushings.iter().find(|j| j.id == id).map(Self::Joint))
            .or_else(|| model.bushings.iter().find(|j| is_at(j, id)).map(Self::Joint))
            .or_else(|| body(&|b| b.origin.members.iter().any(|m| m == id)))
            .or_else(|| {
                let of_line = |j: &&Bushing| j.origin.members.iter().any(|m| m == id);
                model.bushings.iter().find(of_line).map(Self::Joint)
            })
            .or_else(|| {
                let (member, _) = id.rsplit_once('.').filter(|(_, end)| END_NAMES.contains(end))?;
                body(&|b| b.origin.members.iter().any(|m| m == member))
            })
    }

    /// The body of the slab of a strip (`S1:C1-A1|C1-B1`) without a joint that a trace knows.
    fn of_strip(model: &'a Model, trace: Option<&TraceFile>, id: &str) -> Option<Self> {
        let (slab, _) =
            id.split_once(':').filter(|_| trace.is_some_and(|t| !t.jointless_at(id).is_empty()))?;
        model.bodies.iter().find(|b| b.origin.members.iter().any(|m| m == slab)).map(Self::Body)
    }

    fn id(&self) -> &'a str {
        match self {
            Self::Body(b) => &b.id,
            Self::Joint(j) => &j.id,
        }
    }

    fn origin(&self) -> &'a Origin {
        match self {
            Self::Body(b) => &b.origin,
            Self::Joint(j) => &j.origin,
        }
    }

    fn words(&self) -> String {
        match self {
            Self::Body(b) => format!("rigid body of {:.3} t", b.mass_kg / 1e3),
            Self::Joint(j) => format!(
                "joint between {} and {} at ({:.3}, {:.3}, {:.3}) m",
                j.body_a.as_deref().unwrap_or("the ground"),
                j.body_b,
                j.point_m[0],
                j.point_m[1],
                j.point_m[2]
            ),
        }
    }
}

/// Whether a joint is that of an end: one of the two of a wall, or that of a beam which yields at its ends.
fn is_at(joint: &Bushing, end: &str) -> bool {
    let number = joint.id.strip_prefix(end).and_then(|rest| rest.strip_prefix('-'));
    number.is_some_and(|n| n.parse::<usize>().is_ok()) || joint.hinges().contains(&end)
}

/// Names of the ends of columns and beams.
const END_NAMES: [&str; 4] = ["bottom", "top", "start", "end"];

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    super::failing(arguments.json, attempt(arguments))
}

fn attempt(arguments: &Arguments) -> Result<Outcome, Failure> {
    arguments.knowledge.exist()?;
    let model = Model::read(&arguments.model).map_err(|e| Failure::input(e.to_string()))?;
    let trace = TraceFile::beside(&arguments.model)?;
    let part = Part::find(&model, &arguments.part)
        .or_else(|| Part::of_strip(&model, trace.as_ref(), &arguments.part))
        .ok_or_else(|| unknown(&model, &arguments.part))?;
    let (reasons, entries) = match &trace {
        Some(trace) => known(&model, &arguments.part, &part, trace),
        None => looked_up(&part, arguments)?,
    };
    let review = reviewed(&arguments.model, &arguments.part, &part)?;
    let is_asked = |beam: &&String| concerned(&arguments.part, &part).any(|m| m == beam.as_str());
    let whole = trace.iter().flat_map(|t| &t.stays).filter(|s| s.beams.iter().any(|b| is_asked(&b)));
    let whole: Vec<StaysWhole> = whole
        .map(|s| StaysWhole { beams: s.beams.iter().filter(is_asked).cloned().collect(), why: s.why.clone() })
        .collect();
    let about =
        |note: &&String| note.strip_prefix(&arguments.part).is_some_and(|rest| rest.starts_with([' ', ':']));
    let notes: Vec<String> = trace.iter().flat_map(|t| t.notes.iter().filter(about)).cloned().collect();
    let unmet = trace.iter().flat_map(|t| &t.unmet).filter_map(|u| {
        let members: Vec<String> = u.members.iter().filter(is_asked).cloned().collect();
        (!members.is_empty()).then(|| Unmet { members, ..u.clone() })
    });
    let unmet: Vec<Unmet> = unmet.collect();
    let none: Vec<Jointless> = trace.iter().flat_map(|t| t.jointless_at(&arguments.part)).collect();
    let events = events(arguments, &model, &part, trace)?;
    if arguments.json {
        let value = json!({
            "review": review,
            "part": part.id(),
            "parts": parts_of(&model, &arguments.part, &part),
            "what": part.words(),
            "members": part.origin().members,
            "reasons": reasons,
            "entries": entries,
            "stays": whole,
            "without_joint": none,
            "not_carried_out": unmet,
            "notes": notes,
            "events": events,
        });
        print(&format!("{value:#}\n"));
    } else {
        let words = text(&arguments.part, (&model, &part), &reasons, &entries);
        let mut none: String = none.iter().map(none_text).collect();
        none += &taken_text(&model, &arguments.part, &part);
        none.extend(unmet.iter().map(|u| format!("  note: {}\n", u.words())));
        none.extend(notes.iter().map(|note| format!("  note: {note}\n")));
        print(&(words + &none + &whole_text(&whole) + &events.text() + &review_text(&review)));
    }
    Ok(Outcome::Done)
}

/// What rules about events say of a part, by the trace, or by the model and the rule base of today.
fn events(
    arguments: &Arguments,
    model: &Model,
    part: &Part,
    trace: Option<TraceFile>,
) -> Result<explain_events::Told, Failure> {
    let said = match trace {
        Some(trace) if !trace.event_rules.is_empty() || model.event_rules.is_empty() => {
            (trace.event_rules, trace.unasked)
        }
        _ if model.event_rules.is_empty() => (Vec::new(), Vec::new()),
        _ => {
            let rules = knowledge::rules(arguments.knowledge.rules.as_deref())?;
            (EventReason::all(model, &rules), Vec::new())
        }
    };
    let origins = if arguments.part == part.id() { &part.origin().members[..] } else { &[] };
    explain_events::told(&arguments.model, model, (&arguments.part, origins), said)
}

/// The decisions about a part in the review list beside a model, with their number in all.
fn reviewed(model: &Path, asked: &str, part: &Part) -> Result<Vec<(usize, Item)>, Failure> {
    let path = model.with_file_name("review.json");
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(Vec::new()) };
    let wrong = |what: String| Failure::input(format!("{}: {what}", path.display()));
    let review: Review = json::from_text(&text).map_err(|e| wrong(e.to_string()))?;
    if review.schema != REVIEW_SCHEMA {
        return Err(wrong(format!("schema {}, this program reads schema {REVIEW_SCHEMA}", review.schema)));
    }
    let count = review.items.len();
    // asked for a member or end, only what is about it; asked for a body, what is about any of its members
    let about = |id: &String| id == asked || (asked == part.id() && (part.origin().members.contains(id)));
    let own = review.items.into_iter().filter(|item| item.subjects.iter().any(about));
    Ok(own.map(|item| (count, item)).collect())
}

/// What charges on the members of a part take away, or on those at a joint.
fn taken_text(model: &Model, asked: &str, part: &Part) -> String {
    let own: Vec<&str> = match part {
        Part::Body(b) => vec![&b.id],
        Part::Joint(j) => j.body_a.iter().chain([&j.body_b]).map(String::as_str).collect(),
    };
    let about = |e: &&Event| {
        e.origin.members.iter().any(|m| m == asked)
            || e.remove_bodies.iter().any(|b| own.contains(&b.as_str()))
    };
    let line = |e: &Event| {
        let bodies = e.remove_bodies.join(", ");
        format!(
            "  charge {} on {} takes away at {} s: {bodies}\n",
            e.id,
            e.origin.members.join(", "),
            e.time_s
        )
    };
    model.events.iter().filter(about).map(line).collect()
}

fn none_text(none: &Jointless) -> String {
    let sure = sure_words(none.confidence, &none.rule);
    let who =
        if none.is_of_analyst() { "analyst's override".to_string() } else { format!("rule {}", none.rule) };
    format!("  {}: {who} -> {}{sure}\n    {}\n", none.ends.join(", "), none.action, none.words)
}

/// How sure a learned rule is, and where its evidence is told.
fn sure_words(confidence: Option<f64>, rule: &str) -> String {
    let words = |c: f64| {
        format!(" (right in {:.0} % of cases by its studies: `fallwerk rules show {rule}`)", 100.0 * c)
    };
    confidence.map_or(String::new(), words)
}

fn whole_text(beams: &[StaysWhole]) -> String {
    let line = |s: &StaysWhole| {
        format!("  {}: one with the slab whatever happens, since {}\n", s.beams.join(", "), s.why)
    };
    beams.iter().map(line).collect()
}

fn review_text(items: &[(usize, Item)]) -> String {
    let line = |(count, item): &(usize, Item)| {
        let (why, changes) = (item.why.join("; "), item.change_words());
        let count = counted(*count, "decision", "decisions");
        format!(
            "  review: number {} of {count} worth a look: {} of {}\n    {why}\n    otherwise {}: {changes}\n",
            item.rank,
            item.decision,
            item.subject_words(),
            item.otherwise
        )
    };
    items.iter().map(line).collect()
}

fn unknown(model: &Model, id: &str) -> Failure {
    let origins = model.bodies.iter().map(|b| &b.origin).chain(model.bushings.iter().map(|j| &j.origin));
    let members = origins.flat_map(|origin| origin.members.iter().map(String::as_str));
    let ids = model.bodies.iter().map(|b| b.id.as_str()).chain(model.bushings.iter().map(|j| j.id.as_str()));
    let help = match closest(id, ids.chain(members)) {
        Some(near) => format!("did you mean `{near}`?"),
        None => {
            let first = |ids: Vec<&str>| ids.into_iter().take(3).collect::<Vec<_>>().join(", ");
            format!(
                "bodies are for instance {}; joints {}",
                first(model.bodies.iter().map(|b| b.id.as_str()).collect()),
                first(model.bushings.iter().map(|j| j.id.as_str()).collect())
            )
        }
    };
    Failure::input(format!("the model has no body or joint {}\n  = help: {help}", quoted(id)))
}

/// The bodies that a member is part of, or is cut into.
fn bodies_of<'a>(model: &'a Model, member: &'a str) -> impl Iterator<Item = &'a Body> {
    model.bodies.iter().filter(move |b| b.origin.members.iter().any(|m| m == member))
}

/// The parts whose reasons tell why a part that was asked for is as it is: of a member that is cut all its bodies, and the joints between them.
fn parts_of<'a>(model: &'a Model, asked: &'a str, part: &Part<'a>) -> BTreeSet<&'a str> {
    let mut parts = BTreeSet::from([part.id()]);
    if let (Part::Body(_), true) = (part, asked != part.id()) {
        let bodies: BTreeSet<&str> = bodies_of(model, asked).map(|b| b.id.as_str()).collect();
        let both = |j: &&Bushing| {
            j.body_a.as_deref().is_some_and(|a| bodies.contains(a)) && bodies.contains(j.body_b.as_str())
        };
        parts.extend(model.bushings.iter().filter(both).map(|j| j.id.as_str()));
        parts.extend(bodies);
    }
    parts
}

/// Reasons of a part and its entries by key; `None` for an entry of which nothing is known.
type Found = (Vec<Reason>, BTreeMap<String, Option<EntryFacts>>);

/// Reasons and entries of a part by its trace.
fn known(model: &Model, asked: &str, part: &Part, trace: &TraceFile) -> Found {
    // whether a beam may break away is asked about it, whatever part is
    let webs: Vec<String> = concerned(asked, part).map(web_of).collect();
    let parts = parts_of(model, asked, part);
    let is_about = |r: &&Reason| parts.contains(r.part.as_str()) || webs.contains(&r.subject);
    let reasons = trace.reasons.iter().filter(is_about).cloned().collect();
    let entries =
        part.origin().entries.iter().map(|key| (key.clone(), trace.entries.get(key).cloned())).collect();
    (reasons, entries)
}

/// The members that were asked for: one, or those that a part stands for.
fn concerned<'a>(asked: &'a str, part: &'a Part) -> impl Iterator<Item = &'a str> {
    let all = if asked == part.id() { &part.origin().members[..] } else { &[] };
    all.iter().map(String::as_str).chain([asked])
}

/// Reasons and entries of a part whose model has no trace: what rule base and library hold today.
fn looked_up(part: &Part, arguments: &Arguments) -> Result<Found, Failure> {
    let rules = knowledge::rules(arguments.knowledge.rules.as_deref())?;
    let origin = part.origin();
    let reasons = origin
        .rules
        .iter()
        .map(|rule| Reason {
            part: part.id().to_string(),
            subject: origin.members.join(", "),
            rule: rule.clone(),
            action: String::new(),
            words: knowledge::words_of(&rules, rule).unwrap_or_else(|| "(not in the rule base)".into()),
            in_range: true,
            confidence: None,
            entries: origin.entries.clone(),
            instead_of: Vec::new(),
        })
        .collect();
    if origin.entries.is_empty() {
        return Ok((reasons, BTreeMap::new()));
    }
    let store = knowledge::library(arguments.knowledge.library.as_deref(), false)?;
    let facts = |key: &String| (key.clone(), store.get(key).ok().map(|e| EntryFacts::of(&e, None)));
    Ok((reasons, origin.entries.iter().map(facts).collect()))
}

fn text(
    asked: &str,
    (model, part): (&Model, &Part),
    reasons: &[Reason],
    entries: &BTreeMap<String, Option<EntryFacts>>,
) -> String {
    let mut text = String::new();
    if asked != part.id() {
        let members = &part.origin().members;
        let end = !members.iter().any(|m| m == asked);
        let is_here = |j: &&Bushing| is_at(j, asked) || j.origin.members.iter().any(|m| m == asked);
        let here: Vec<&Bushing> = model.bushings.iter().filter(is_here).collect();
        let bodies: Vec<&str> = bodies_of(model, asked).map(|b| b.id.as_str()).collect();
        let joints = || here.iter().map(|j| j.id.as_str()).collect::<Vec<_>>().join(", ");
        let yields = here.iter().any(|j| j.bending.iter().any(|b| b.curve().is_some()));
        let (words, part) = match part {
            Part::Joint(_) if yields => ("yields in", joints()),
            Part::Joint(_) => ("is elastic in", joints()),
            Part::Body(_) if end => ("has no joint; it lies in", part.id().to_string()),
            Part::Body(_) if bodies.len() > 1 => ("is cut into", bodies.join(", ")),
            Part::Body(_) => ("is part of", part.id().to_string()),
        };
        text += &format!("{asked} {words} {part}\n");
    }
    text += &format!("{}: {}\n  stands for {}\n", part.id(), part.words(), part.origin().members.join(", "));
    if let Part::Joint(joint) = part {
        text += &explain_joint::resistance_text(model, joint);
    }
    for (r, subjects) in grouped(reasons) {
        let what = if r.action.is_empty() { String::new() } else { format!(" -> {}", r.action) };
        let outside = if r.in_range { "" } else { " (outside the rule's range of evidence)" };
        let sure = sure_words(r.confidence, &r.rule);
        let who = match r.is_of_analyst() {
            true => format!("analyst's override{what} ({})", r.instead_words()),
            false => format!("rule {}{what}{sure}{outside}", r.rule),
        };
        text += &format!("  {}: {who}\n    {}\n", subjects.join(", "), r.words);
    }
    for (key, facts) in entries {
        text += &format!("  entry {key}\n");
        match facts {
            Some(f) => text += &explain_entry::text(f),
            None => text += "    not in the library\n",
        }
        if let (Part::Joint(joint), Some(f)) = (part, facts) {
            text += &explain_joint::extended_text(model, joint, key, f.validity.axial_force_n)
                .unwrap_or_default();
        }
    }
    text
}

/// Reasons that differ in their subject only, once, with all subjects.
fn grouped(reasons: &[Reason]) -> Vec<(&Reason, Vec<&str>)> {
    let mut groups: Vec<(&Reason, Vec<&str>)> = Vec::new();
    for r in reasons {
        let same = |g: &Reason| {
            (&g.rule, &g.action, g.in_range) == (&r.rule, &r.action, r.in_range)
                && (&g.words, &g.instead_of) == (&r.words, &r.instead_of)
        };
        match groups.iter_mut().find(|(g, _)| same(g)) {
            Some((_, subjects)) if subjects.contains(&r.subject.as_str()) => {}
            Some((_, subjects)) => subjects.push(&r.subject),
            None => groups.push((r, vec![&r.subject])),
        }
    }
    groups
}
