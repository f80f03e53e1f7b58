//! What `fallwerk explain` tells of events: the rules about them that concern a part, those that are not asked, and what fired in the run beside the model.

use super::Failure;
use super::compose::event_words;
use crate::base::json;
use crate::generate::{EventReason, Unasked};
use crate::mbs::Model;
use crate::mbs::model::{Body, Bushing};
use crate::mbs::result::{EventKind, LatentRecord, RunEvent};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::path::Path;

/// What of a run is told of events.
#[derive(Debug, Deserialize)]
struct Run {
    bodies: Vec<String>,
    events: Vec<RunEvent>,
    #[serde(default)]
    latent: Vec<LatentRecord>,
}

/// What there is to tell of a part.
#[derive(Debug, Serialize)]
pub struct Told {
    /// Rules that may fire for it while the model runs, in the order in which they decide.
    pub event_rules: Vec<EventReason>,
    /// Rules about events that are not asked for it.
    pub unasked: Vec<Unasked>,
    /// Its latent sections.
    pub sections: Vec<String>,
    /// What fired and gave way in the run beside the model.
    pub events: Vec<RunEvent>,
    /// Its latent hinges in that run.
    pub latent: Vec<LatentRecord>,
    /// What kept the run from being told.
    pub remark: Option<String>,
}

/// Of what rules about events say, what concerns a part, with what fired in the run whose `mbs.json` is beside the model.
pub fn told(
    path: &Path,
    model: &Model,
    (asked, origins): (&str, &[String]),
    (rules, unasked): (Vec<EventReason>, Vec<Unasked>),
) -> Result<Told, Failure> {
    let concerned = concerned(asked, origins);
    let is_about = |members: &[String]| members.iter().any(|m| concerned.contains(m.as_str()));
    let sections = sections(model, &concerned);
    let mut told = Told {
        event_rules: rules.into_iter().filter(|r| is_about(&r.members)).collect(),
        unasked: unasked.into_iter().filter(|u| is_about(&u.members)).collect(),
        sections: sections.iter().map(|s| s.to_string()).collect(),
        events: Vec::new(),
        latent: Vec::new(),
        remark: None,
    };
    told.event_rules.iter_mut().for_each(|r| r.members.retain(|m| concerned.contains(m.as_str())));
    told.unasked.iter_mut().for_each(|u| u.members.retain(|m| concerned.contains(m.as_str())));
    let Some(run) = beside(path)? else { return Ok(told) };
    if !model.bodies.iter().map(|b| &b.id).eq(&run.bodies) {
        told.remark = Some(
            "mbs.json beside the model is the run of another model: what fired in it is not told".into(),
        );
        return Ok(told);
    }
    let concerns = |event: &RunEvent| match &event.kind {
        EventKind::Rule { watched, .. } => watched.iter().any(|w| sections.contains(w.as_str())),
        EventKind::Live { joint, .. } | EventKind::Fracture { joint, .. } => {
            sections.contains(joint.as_str())
        }
        _ => false,
    };
    told.events = run.events.into_iter().filter(concerns).collect();
    told.latent = run.latent.into_iter().filter(|l| sections.contains(l.joint.as_str())).collect();
    Ok(told)
}

/// The run beside a model file; `None` if there is no such file.
fn beside(model: &Path) -> Result<Option<Run>, Failure> {
    let path = model.with_file_name("mbs.json");
    let Ok(text) = std::fs::read_to_string(&path) else { return Ok(None) };
    let read = json::from_text(&text);
    read.map(Some).map_err(|e| Failure::input(format!("{}: {e}", path.display())))
}

/// What was asked for and the members that the part stands for if it is asked for itself, with the members of ends and sections.
fn concerned<'a>(asked: &'a str, origins: &'a [String]) -> BTreeSet<&'a str> {
    let ids = origins.iter().map(String::as_str).chain([asked]);
    ids.flat_map(|id| [Some(id), id.rsplit_once('.').map(|(member, _)| member)]).flatten().collect()
}

/// The latent bushings of some members.
fn sections<'a>(model: &'a Model, concerned: &BTreeSet<&str>) -> BTreeSet<&'a str> {
    let own = |b: &&Body| b.origin.members.iter().any(|m| concerned.contains(m.as_str()));
    let bodies: BTreeSet<&String> = model.bodies.iter().filter(own).map(|b| &b.id).collect();
    let joins = |b: &&Bushing| b.body_a.iter().chain([&b.body_b]).all(|id| bodies.contains(id));
    let latent = model.bushings.iter().filter(|b| b.latent.is_some()).filter(joins);
    latent.map(|b| b.id.as_str()).collect()
}

impl Told {
    /// In lines.
    pub fn text(&self) -> String {
        let mut text = String::new();
        if !self.sections.is_empty() && !self.event_rules.is_empty() {
            let are = if self.sections.len() == 1 { "is" } else { "are" };
            text += &format!(
                "  {} {are} latent, and nobody looks there until one of these rules fires\n",
                self.sections.join(", ")
            );
        }
        for r in &self.event_rules {
            let action = if r.action.is_empty() { String::new() } else { format!(" -> {}", r.action) };
            let words = if r.words.is_empty() { "(not in the rule base)" } else { &r.words };
            text += &format!(
                "  in the run, if {}: rule {}{action}\n    {words}\n    then {}\n",
                r.remains, r.id, r.then
            );
            if let Some(done) = &r.done {
                text += &format!("    already: {done}\n");
            }
        }
        if self.event_rules.len() > 1 {
            text +=
                "    of the rules that answer one question the first that is true of what happens decides\n";
        }
        for u in &self.unasked {
            text += &format!("  not asked: {}\n", u.words());
        }
        for e in &self.events {
            text += &format!("  run: {:.3} s: {}\n", e.time_s, event_words(&e.kind));
        }
        for l in &self.latent {
            text += &latent_words(l);
        }
        if let Some(remark) = &self.remark {
            text += &format!("  run: {remark}\n");
        }
        text
    }
}

fn latent_words(l: &LatentRecord) -> String {
    match (l.live_s, l.largest_share) {
        (None, 0.0) => format!("  run: {} stayed latent, and no rule had it looked at under load\n", l.joint),
        (None, share) => {
            format!("  run: {} stayed latent; it bore {share:.2} of its resistance at most\n", l.joint)
        }
        (Some(_), _) => String::new(),
    }
}
