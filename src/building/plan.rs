//! What happens to the members: ground, supports, obstacles, preparatory work, charges, settings.

use super::fields::{Fields, Placed};
use super::format::{CUT, EVENT, GROUND, MESHING, OBSTACLE, REFINE, SETTINGS, SUPPORT, WEAKEN};
use super::members::Members;
use super::model::{
    Charge, Face, Ground, Member, MemberKind, Meshing, Obstacle, Preparation, Refinement, Settings, Support,
};
use super::structure::is_id;
use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::geom::Aabb;
use crate::base::source::Span;
use crate::base::tree::{Entry, Node};
use crate::base::units::{Dimension, show};
use std::collections::BTreeMap;

/// Most frames of a run.
const MAX_FRAMES: f64 = 100_000.0;

/// Reads `[ground]`.
pub fn ground(root: &Node) -> Option<Ground> {
    let fields = Fields { node: root.get("ground")?, table: &GROUND };
    Some(Ground { level_m: fields.number("level")?, friction: fields.number("friction")? })
}

/// Reads `[settings]`; keys that are wrong keep their default.
pub fn settings(root: &Node, found: &mut Vec<Diagnostic>) -> Settings {
    let default = Settings::default();
    let Some(node) = root.get("settings") else { return default };
    let fields = Fields { node, table: &SETTINGS };
    let number = |key, value| fields.number_or(key, value).unwrap_or(value);
    let settings = Settings {
        end_time_s: number("end_time", default.end_time_s),
        output_interval_s: number("output_interval", default.output_interval_s),
        removal_duration_s: number("removal_duration", default.removal_duration_s),
        gravity_m_s2: number("gravity", default.gravity_m_s2),
        mesh_size_m: number("mesh_size", default.mesh_size_m),
        critical_strain_rate_1_s: number("critical_strain_rate", default.critical_strain_rate_1_s),
        meshing: default.meshing.clone(),
    };
    let span = fields.span("output_interval");
    if settings.output_interval_s > settings.end_time_s {
        let error =
            Diagnostic::error("out-of-range", "the output interval is longer than the simulated time")
                .at(span, format!("the simulated time is {}", show(settings.end_time_s, Dimension::Time)));
        found.push(error);
    } else if settings.end_time_s / settings.output_interval_s > MAX_FRAMES {
        let frames = settings.end_time_s / settings.output_interval_s;
        let error =
            Diagnostic::error("out-of-range", format!("this output interval makes {frames:.0} frames"))
                .at(span, format!("at most {MAX_FRAMES} are written"));
        found.push(error);
    }
    settings
}

/// Reads `[mesh]`.
pub fn meshing(root: &Node, members: &Members, size_m: f64, found: &mut Vec<Diagnostic>) -> Meshing {
    let Some(node) = root.get("mesh") else { return Meshing::default() };
    let fields = Fields { node, table: &MESHING };
    let mut refine = Vec::new();
    for node in node.get("refine").map_or(&[][..], Node::items) {
        let fields = Fields { node, table: &REFINE };
        let (size, ends_m) =
            (fields.number("size"), fields.child("ends").and_then(|_| fields.number("ends")));
        if size.is_some_and(|s| s >= size_m) {
            let warning = Diagnostic::warning(
                "no-refinement",
                "this element size is not smaller than elsewhere",
            )
            .at(fields.span("size"), format!("`settings.mesh_size` is {}", show(size_m, Dimension::Length)));
            found.push(warning);
        }
        for placed in selected(fields, members, found) {
            let bar = |m: &&super::fields::Placed<Member>| {
                m.item.id == placed.item && matches!(m.item.kind, MemberKind::Column | MemberKind::Beam)
            };
            if ends_m.is_some() && !members.list.iter().any(|m| bar(&m)) {
                let brace =
                    members.list.iter().any(|m| m.item.id == placed.item && m.item.inclined.is_some());
                let why = if brace { "a brace: it has one size" } else { "a plate: it has no ends" };
                let message = format!("{} is {why}", quoted(&placed.item));
                let error = Diagnostic::error("wrong-kind", message)
                    .at(fields.span("ends"), "only for columns and beams")
                    .help("leave `ends` out to refine all of it");
                found.push(error);
            }
            refine.extend(size.map(|size_m| Refinement { member: placed.item, size_m, ends_m }));
        }
    }
    Meshing { refine, tie_below_m: fields.number_or("tie_below", 0.0).unwrap_or(0.0) }
}

/// Reads `[[obstacles]]`.
pub fn obstacles(root: &Node, found: &mut Vec<Diagnostic>) -> Vec<Placed<Obstacle>> {
    let mut list: Vec<Placed<Obstacle>> = Vec::new();
    for node in root.get("obstacles").map_or(&[][..], Node::items) {
        let fields = Fields { node, table: &OBSTACLE };
        let read = || {
            let solid = Aabb::from_corners(fields.point("from")?, fields.point("to")?);
            Some(Obstacle { id: fields.text("id")?.to_string(), solid, friction: fields.number("friction")? })
        };
        let Some(item) = read() else { continue };
        if item.solid.size().iter().any(|s| *s < 0.01) {
            let error =
                Diagnostic::error("bad-place", format!("the obstacle {} has no volume", quoted(&item.id)))
                    .at(fields.span("to"), "must differ from `from` by at least 10 mm in x, y and z")
                    .also(fields.span("from"), "");
            found.push(error);
            continue;
        }
        list.push(Placed { item, span: fields.span("id") });
    }
    unique(list.iter().map(|o| (o.item.id.as_str(), o.span)), "obstacles", found);
    list
}

fn unique<'a>(ids: impl Iterator<Item = (&'a str, Span)>, what: &str, found: &mut Vec<Diagnostic>) {
    let mut seen = BTreeMap::new();
    for (id, span) in ids {
        if let Some(first) = seen.insert(id, span) {
            let error = Diagnostic::error("duplicate-id", format!("two {what} have the id {}", quoted(id)))
                .at(span, "again here")
                .also(first, "first here");
            found.push(error);
        }
    }
}

/// Reads `[[supports]]`.
pub fn supports(root: &Node, members: &Members, found: &mut Vec<Diagnostic>) -> Vec<Placed<Support>> {
    let mut list: Vec<Placed<Support>> = Vec::new();
    for node in root.get("supports").map_or(&[][..], Node::items) {
        let fields = Fields { node, table: &SUPPORT };
        let face = match fields.child("face").map(|_| fields.text("face")) {
            None => Face::Bottom,
            Some(Some("top")) => Face::Top,
            Some(Some(_)) => Face::Bottom,
            Some(None) => continue,
        };
        for member in selected(fields, members, found) {
            if list.iter().all(|s| s.item.member != member.item || s.item.face != face) {
                list.push(Placed { item: Support { member: member.item, face }, span: member.span });
            }
        }
    }
    list
}

/// The ids that the patterns of `members` select, each with the place of its pattern.
fn selected(fields: Fields<'_>, members: &Members, found: &mut Vec<Diagnostic>) -> Vec<Placed<String>> {
    let mut ids = Vec::new();
    for node in fields.node.get("members").map_or(&[][..], Node::items) {
        let Some(pattern) = node.text() else { continue };
        let before = ids.len();
        let hits = members.list.iter().filter(|m| matches(pattern, &m.item.id));
        ids.extend(hits.map(|m| Placed { item: m.item.id.clone(), span: node.span }));
        if ids.len() == before && members.complete && !members.list.is_empty() {
            found.push(unknown_member(pattern, node.span, members));
        }
    }
    ids
}

fn unknown_member(id: &str, span: Span, members: &Members) -> Diagnostic {
    let message = if id.contains('*') {
        format!("no member matches {}", quoted(id))
    } else {
        format!("there is no member {}", quoted(id))
    };
    let near = closest(id, members.list.iter().map(|m| m.item.id.as_str()));
    let help = match (near, members.list.first(), members.list.last()) {
        (Some(near), ..) => Some(format!("did you mean `{near}`?")),
        (None, Some(first), Some(last)) => {
            let count = members.list.len();
            Some(format!(
                "the {count} members of this building are {} to {}",
                quoted(&first.item.id),
                quoted(&last.item.id)
            ))
        }
        _ => None,
    };
    Diagnostic::error("unknown-id", message).at(span, "").help_if(help)
}

/// Whether an id matches a pattern in which `*` stands for any characters.
pub fn matches(pattern: &str, id: &str) -> bool {
    let mut pieces = pattern.split('*');
    let first = pieces.next().unwrap_or_default();
    let Some(mut rest) = id.strip_prefix(first) else { return false };
    let mut pieces: Vec<&str> = pieces.collect();
    let Some(last) = pieces.pop() else { return rest.is_empty() };
    for piece in pieces {
        match rest.find(piece) {
            Some(at) => rest = &rest[at + piece.len()..],
            None => return false,
        }
    }
    rest.ends_with(last)
}

/// Reads `[[preparation]]`.
pub fn preparation(root: &Node, members: &Members, found: &mut Vec<Diagnostic>) -> Vec<Placed<Preparation>> {
    let mut list: Vec<Placed<Preparation>> = Vec::new();
    for node in root.get("preparation").map_or(&[][..], Node::items) {
        let weaken = node.get("kind").and_then(Node::text) == Some("weaken");
        let fields = Fields { node, table: if weaken { &WEAKEN } else { &CUT } };
        let factor = if weaken { fields.number("strength_factor") } else { None };
        for member in selected(fields, members, found) {
            let item = match factor {
                Some(strength_factor) => Preparation::Weaken { member: member.item, strength_factor },
                None if weaken => continue,
                None => Preparation::Cut { member: member.item },
            };
            if let Some(other) = list.iter().find(|p| prepared(&p.item) == prepared(&item)) {
                let message = format!("the member {} is prepared twice", quoted(prepared(&item)));
                let error = Diagnostic::error("prepared-twice", message)
                    .at(member.span, "again here")
                    .also(other.span, "first here");
                found.push(error);
                continue;
            }
            list.push(Placed { item, span: member.span });
        }
    }
    list
}

/// The member that is prepared.
pub fn prepared(preparation: &Preparation) -> &str {
    match preparation {
        Preparation::Weaken { member, .. } | Preparation::Cut { member } => member,
    }
}

/// Reads `[[events]]`, in order of time (then of the file).
pub fn events(
    root: &Node,
    members: &Members,
    end_time_s: f64,
    found: &mut Vec<Diagnostic>,
) -> Vec<Placed<Charge>> {
    let mut list: Vec<Placed<Charge>> = Vec::new();
    for node in root.get("events").map_or(&[][..], Node::items) {
        list.extend(event(Fields { node, table: &EVENT }, members, found));
    }
    unique(list.iter().map(|e| (e.item.id.as_str(), e.span)), "events", found);
    if list.is_empty() && root.entry("events").is_none_or(|e: &Entry| e.node.items().is_empty()) {
        let warning = Diagnostic::warning("no-events", "there are no events: nothing is removed")
            .help("add `[[events]]` with `id`, `member` and `time`");
        found.push(warning);
    }
    for event in list.iter().filter(|e| e.item.time_s >= end_time_s) {
        let message = format!("the run ends before the event {}", quoted(&event.item.id));
        let error = Diagnostic::error("late-event", message)
            .at(event.span, format!("ignites at {}", show(event.item.time_s, Dimension::Time)))
            .help(format!(
                "`settings.end_time` is {}, counted from the start of the run: give a later one, or an earlier `time`",
                show(end_time_s, Dimension::Time)
            ));
        found.push(error);
    }
    list.sort_by(|a, b| a.item.time_s.total_cmp(&b.item.time_s));
    list
}

fn event(fields: Fields<'_>, members: &Members, found: &mut Vec<Diagnostic>) -> Option<Placed<Charge>> {
    let id = fields.text("member")?;
    let member = members.list.iter().find(|m| m.item.id == id);
    if member.is_none() && is_id(id) && members.complete && !members.list.is_empty() {
        found.push(unknown_member(id, fields.span("member"), members));
    }
    let stretch_m = match fields.child("stretch") {
        None => None,
        Some(_) => Some(<[f64; 2]>::try_from(fields.numbers("stretch")?).ok()?),
    };
    if let (Some(member), Some(stretch)) = (member, stretch_m) {
        check_stretch(&member.item, stretch, fields.span("stretch"), found);
    }
    let item = Charge {
        id: fields.text("id")?.to_string(),
        member: id.to_string(),
        stretch_m,
        time_s: fields.number("time")?,
    };
    member.map(|_| Placed { item, span: fields.span("id") })
}

fn check_stretch(member: &Member, [from, to]: [f64; 2], span: Span, found: &mut Vec<Diagnostic>) {
    let length = member.size_m()[member.axis];
    if !matches!(member.kind, MemberKind::Column | MemberKind::Beam | MemberKind::Brace) {
        let message = format!("a stretch of a {} is not supported", member.kind.name());
        let error = Diagnostic::error("not-supported", message).at(span, "").help("remove the whole member");
        found.push(error);
    } else if from >= to {
        let error = Diagnostic::error(
            "bad-stretch",
            "the stretch does not go upwards from its first to its second end",
        );
        found.push(error.at(span, ""));
    } else if to > length + 1e-9 {
        let message = format!("the stretch ends outside the member {}", quoted(&member.id));
        let label = format!("the member is {} long", show(length, Dimension::Length));
        found.push(Diagnostic::error("bad-stretch", message).at(span, label));
    }
}
