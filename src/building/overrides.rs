//! What the analyst decides in place of the rules: `[[overrides]]`, and which of them cannot be.
//!
//! A target is a member end, the strip of a slab between two columns, the foot or head of a wall, a wall, a beam, or any slab or beam for the floor that it belongs to. An action that fits none of them, a target that is taken
//! away, and decisions that exclude each other are errors here, so that the generator can carry out what is left.

use super::connect::{touch, unsupported_groups};
use super::ends::{MemberEnd, end_names, member_ends};
use super::fields::{Fields, Placed};
use super::format::OVERRIDE;
use super::lines::of_slabs;
use super::members::Members;
use super::model::{Building, Member, MemberKind, Override, OverrideAction, Preparation};
use super::partition::Partition;
use super::plan::{matches, prepared};
use super::read::Draft;
use super::structure::list_words;
use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::source::Span;
use crate::base::tree::Node;
use OverrideAction::{
    BreakAway, ElasticConnection, Hinge, LatentHinge, MergeElastic, MergeRigid, RigidBody, RigidConnection,
};
use std::collections::BTreeMap;

/// Names of the actions that an analyst may write.
pub const ACTIONS: [&str; 8] = {
    let mut names = [""; 8];
    let mut i = 0;
    while i < names.len() {
        names[i] = OverrideAction::ALL[i].name();
        i += 1;
    }
    names
};
/// Names of actions that rules may write and analysts not yet.
pub const ACTIONS_OF_RULES: &[&str] =
    &["subdivide", "remove_body", "translational_spring", "rigid_translation", "insert_subsystem"];

/// Something in the building about which an analyst may decide, or might think so.
struct Target<'a> {
    name: String,
    member: &'a Member,
    is_end: bool,
}

impl Target<'_> {
    /// Whether it is a strip of a slab, or the foot or head of a wall.
    fn is_line(&self) -> bool {
        self.is_end && matches!(self.member.kind, MemberKind::Slab | MemberKind::Wall)
    }

    /// What may be decided about it.
    fn actions(&self) -> &'static [OverrideAction] {
        match (self.member.kind, self.is_end) {
            (MemberKind::Column, true) => &[Hinge, ElasticConnection, RigidConnection],
            (MemberKind::Beam, true) => &[LatentHinge, RigidConnection],
            (MemberKind::Slab | MemberKind::Wall, true) => &[LatentHinge, ElasticConnection],
            (MemberKind::Slab, false) => &[MergeRigid, MergeElastic],
            (MemberKind::Beam, false) => &[MergeRigid, MergeElastic, BreakAway],
            (MemberKind::Wall, false) => &[RigidBody, MergeRigid],
            _ => &[],
        }
    }

    fn words(&self) -> String {
        let kind = self.member.kind.name();
        match (self.is_end, self.member.kind) {
            (true, MemberKind::Slab) => "a strip of a slab between two columns".to_string(),
            (true, _) => format!("the end of a {kind}"),
            (false, MemberKind::Slab | MemberKind::Beam) => format!("a {kind}, which stands for its floor"),
            _ => format!("a {kind}"),
        }
    }

    /// What is possible instead of an action that does not fit.
    fn remedy(&self) -> String {
        let names: Vec<&str> = self.actions().iter().map(|a| a.name()).collect();
        match end_names(self.member.kind).filter(|_| !self.is_end) {
            Some([lower, upper]) if names.is_empty() => {
                let id = &self.member.id;
                format!("decide about its ends: `{id}.{lower}` or `{id}.{upper}`")
            }
            _ if names.is_empty() => "leave it out: the rules are asked nothing about it".into(),
            Some([lower, upper]) => {
                let id = &self.member.id;
                format!("{} are possible; its ends are `{id}.{lower}` and `{id}.{upper}`", list_words(&names))
            }
            None => format!("{} are possible", list_words(&names)),
        }
    }
}

/// All that has a name an analyst may write, members before ends.
fn targets(members: &Members) -> Vec<Target<'_>> {
    let all = || members.list.iter().map(|m| &m.item);
    let whole = all().map(|member| Target { name: member.id.clone(), member, is_end: false });
    let ends = all().flat_map(|member| {
        let name = |end: &str| format!("{}.{end}", member.id);
        let names = end_names(member.kind).filter(|_| !member.is_skew());
        names.into_iter().flatten().map(move |end| Target { name: name(end), member, is_end: true })
    });
    let list: Vec<&Member> = all().collect();
    let strips = of_slabs(&list).into_iter();
    let strips = strips.map(|line| Target { name: line.id, member: list[line.member], is_end: true });
    let walls = all().filter(|m| m.kind == MemberKind::Wall && !m.is_skew()).flat_map(|member| {
        let name = |end: &str| format!("{}.{end}", member.id);
        ["bottom", "top"].map(|end| Target { name: name(end), member, is_end: true })
    });
    whole.chain(ends).chain(walls).chain(strips).collect()
}

/// Whether an action is about ends.
fn is_of_ends(action: OverrideAction) -> bool {
    matches!(action, Hinge | ElasticConnection | RigidConnection | LatentHinge)
}

/// Reads `[[overrides]]`, one a target.
pub fn read(root: &Node, members: &Members, found: &mut Vec<Diagnostic>) -> Vec<Placed<Override>> {
    let mut list: Vec<Placed<Override>> = Vec::new();
    let nodes = root.get("overrides").map_or(&[][..], Node::items);
    if nodes.is_empty() {
        return list;
    }
    let known = targets(members);
    for node in nodes {
        let fields = Fields { node, table: &OVERRIDE };
        let word = fields.text("action");
        let action = word.and_then(|word| OverrideAction::ALL.into_iter().find(|a| a.name() == word));
        let reason = fields.text("reason").map(str::trim);
        if reason.is_some_and(str::is_empty) {
            let error = Diagnostic::error("no-reason", "this override has no reason")
                .at(fields.span("reason"), "says nothing")
                .help("say why the rules are wrong here: it is shown wherever the decision is");
            found.push(error);
        }
        let (Some(action), Some(reason)) = (action, reason) else { continue };
        for pattern in node.get("targets").map_or(&[][..], Node::items) {
            let Some(text) = pattern.text() else { continue };
            for target in selected(text, pattern.span, action, &known, members, found) {
                let item = Override { target: target.name.clone(), action, reason: reason.to_string() };
                match list.iter().find(|o| o.item.target == item.target) {
                    Some(first) => found.push(twice(&item.target, pattern.span, first.span)),
                    None => list.push(Placed { item, span: pattern.span }),
                }
            }
        }
    }
    list
}

fn twice(target: &str, span: Span, first: Span) -> Diagnostic {
    Diagnostic::error("decided-twice", format!("two overrides decide about {}", quoted(target)))
        .at(span, "again here")
        .also(first, "first here")
        .help("leave one of them out")
}

/// The targets that a pattern names and an action fits. A pattern with `*` names ends or members, as the action has it, and lines of slabs and walls where it fits them.
fn selected<'a, 'b>(
    pattern: &str,
    span: Span,
    action: OverrideAction,
    known: &'b [Target<'a>],
    members: &Members,
    found: &mut Vec<Diagnostic>,
) -> Vec<&'b Target<'a>> {
    let hits: Vec<&Target> = known.iter().filter(|t| matches(pattern, &t.name)).collect();
    let is_meant = |t: &&Target| {
        let fits_line = !t.is_line() || t.actions().contains(&action);
        !pattern.contains('*') || (t.is_end == is_of_ends(action) && fits_line)
    };
    let of_kind: Vec<&Target> = hits.iter().copied().filter(is_meant).collect();
    let (fitting, unfit): (Vec<&Target>, Vec<&Target>) =
        of_kind.iter().partition(|t| t.actions().contains(&action));
    if let Some(first) = unfit.first().or(hits.first().filter(|_| of_kind.is_empty())) {
        let message =
            format!("`{}` does not fit {}: it is {}", action.name(), quoted(&first.name), first.words());
        let more =
            if unfit.len() > 1 { format!("and {} more targets", unfit.len() - 1) } else { String::new() };
        found.push(Diagnostic::error("wrong-kind", message).at(span, more).help(first.remedy()));
    } else if hits.is_empty() && members.complete && !known.is_empty() {
        let star = pattern.contains('*');
        let message = match star {
            true => format!("no member, member end or strip of a slab matches {}", quoted(pattern)),
            false => format!("there is no member, member end or strip of a slab {}", quoted(pattern)),
        };
        let near = closest(pattern, known.iter().map(|t| t.name.as_str()));
        let help = match near {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!(
                "members are for instance {}; ends are written `COLUMN.bottom`, `COLUMN.top`, `BEAM.start`, `BEAM.end`, strips of slabs `SLAB:COLUMN|COLUMN`",
                quoted(&known[0].name)
            ),
        };
        found.push(Diagnostic::error("unknown-id", message).at(span, "").help(help));
    }
    fitting
}

/// The member that a target belongs to.
fn member_of<'a>(draft: &'a Draft, target: &str) -> Option<&'a Member> {
    let find = |id: &str| draft.members.list.iter().map(|m| &m.item).find(|m| m.id == id);
    find(target).or_else(|| find(target.rsplit_once('.')?.0)).or_else(|| find(target.split_once(':')?.0))
}

/// Overrides of what charges or cuts take away.
pub fn of_removed(draft: &Draft, found: &mut Vec<Diagnostic>) {
    for decided in &draft.overrides {
        let Some(member) = member_of(draft, &decided.item.target) else { continue };
        let charge = draft.events.iter().find(|e| e.item.member == member.id);
        let cut = draft
            .preparation
            .iter()
            .find(|p| matches!(p.item, Preparation::Cut { .. }) && prepared(&p.item) == member.id);
        let (by, place) = match (charge, cut) {
            (_, Some(cut)) => ("is cut away".to_string(), cut.span),
            (Some(charge), None) => (format!("is removed by {}", quoted(&charge.item.id)), charge.span),
            (None, None) => continue,
        };
        let (id, target) = (quoted(&member.id), quoted(&decided.item.target));
        let subject = if target == id { id } else { format!("{id}, the member of {target},") };
        let error =
            Diagnostic::error("removed-target", format!("{subject} {by}: there is nothing to decide"))
                .at(decided.span, "")
                .also(place, "taken away here")
                .help("name targets that stay");
        found.push(error);
    }
}

/// Overrides that exclude each other, or that the building leaves no room for.
pub fn together(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let Some(building) = draft.building().filter(|b| !b.overrides.is_empty()) else { return };
    let partition = Partition::of(&building);
    let ends = member_ends(&building, &partition);
    let site = Site {
        building: &building,
        floors: floors(&building),
        ends: ends.iter().map(|e| (e.id.as_str(), e)).collect(),
        members: building.members.iter().enumerate().map(|(i, m)| (m.id.as_str(), i)).collect(),
    };
    let lines: Vec<bool> = draft.overrides.iter().map(|o| site.of_line(&o.item.target).is_some()).collect();
    for (i, later) in draft.overrides.iter().enumerate() {
        found.extend(site.without_neighbour(&later.item, &partition).map(|e| e.at(later.span, "")));
        // what is decided about one line says nothing about others
        let wrong = |(k, first): &(usize, &Placed<Override>)| {
            !(lines[i] && lines[*k]) && site.excludes(&first.item, &later.item).is_some()
        };
        let mut before = draft.overrides[..i].iter().enumerate();
        let Some((_, first)) = before.find(wrong) else { continue };
        let why = site.excludes(&first.item, &later.item).unwrap_or_default();
        let [a, b] =
            [&first.item, &later.item].map(|o| format!("`{}` of {}", o.action.name(), quoted(&o.target)));
        let error = Diagnostic::error("contradiction", format!("{b} and {a} cannot both be: {why}"))
            .at(later.span, "this one")
            .also(first.span, "and this one")
            .help("leave one of them out");
        found.push(error);
    }
}

/// What overrides are about.
struct Site<'a> {
    building: &'a Building,
    /// For each slab and beam a number of its floor.
    floors: Vec<Option<usize>>,
    ends: BTreeMap<&'a str, &'a MemberEnd>,
    members: BTreeMap<&'a str, usize>,
}

/// Slabs and beams that touch are one floor; `None` for other members.
fn floors(building: &Building) -> Vec<Option<usize>> {
    let members: Vec<&Member> = building.members.iter().collect();
    let in_floor: Vec<bool> =
        members.iter().map(|m| matches!(m.kind, MemberKind::Slab | MemberKind::Beam)).collect();
    let groups = unsupported_groups(&members, &in_floor, &vec![false; members.len()]);
    let mut floors = vec![None; members.len()];
    for (number, group) in groups.iter().enumerate() {
        group.iter().for_each(|m| floors[*m] = Some(number));
    }
    floors
}

impl Site<'_> {
    fn end(&self, target: &str) -> Option<&MemberEnd> {
        self.ends.get(target).copied()
    }

    /// The floor of a slab, beam or beam end.
    fn floor(&self, target: &str) -> Option<usize> {
        let member = self.end(target).map(|e| e.member);
        self.floors[member.or_else(|| self.members.get(target).copied())?]
    }

    /// The slab or wall of a strip or an end of a wall.
    fn of_line(&self, target: &str) -> Option<usize> {
        if let Some((slab, _)) = target.split_once(':') {
            return self.members.get(slab).copied();
        }
        let wall = self.members.get(target.rsplit_once('.')?.0).copied();
        wall.filter(|m| !self.ends.contains_key(target) && self.building.members[*m].kind == MemberKind::Wall)
    }

    /// Why what is decided about a line and about something else exclude each other.
    fn excludes_line(&self, member: usize, other: &Override) -> Option<&'static str> {
        let is_wall = self.building.members[member].kind == MemberKind::Wall;
        match other.action {
            MergeRigid if is_wall && other.target == self.building.members[member].id => {
                Some("a wall that is one body with its floors has no joint at its ends")
            }
            MergeRigid | LatentHinge if !is_wall && self.floor(&other.target) == self.floors[member] => {
                Some("a floor that is one body or folds at lines does not bend in strips")
            }
            _ => None,
        }
    }

    /// Why two overrides exclude each other.
    fn excludes(&self, a: &Override, b: &Override) -> Option<&'static str> {
        match [a, b].map(|o| self.of_line(&o.target)) {
            [None, None] => {}
            [Some(line), None] => return self.excludes_line(line, b),
            [None, Some(line)] => return self.excludes_line(line, a),
            [Some(_), Some(_)] => return None,
        }
        let of_floor = |o: &Override| self.end(&o.target).is_none();
        match (self.floor(&a.target), self.floor(&b.target)) {
            (Some(p), Some(q)) if p == q => match (of_floor(a), of_floor(b)) {
                (true, true) => match [a.action, b.action] {
                    [BreakAway, BreakAway | MergeElastic] | [MergeElastic, BreakAway] => None,
                    [BreakAway, _] | [_, BreakAway] => {
                        Some("no beam breaks away from a floor that is one body")
                    }
                    _ => Some("both targets belong to one floor"),
                },
                (false, false) if a.action != b.action => {
                    let on_line = self.end(&a.target)?.on_line_of(self.end(&b.target)?);
                    on_line.then_some("both ends lie on one line, at which the floor folds or does not")
                }
                (true, false) | (false, true) if [a.action, b.action].contains(&LatentHinge) => {
                    Some("a floor that is one body or bends does not fold at lines")
                }
                _ => None,
            },
            (Some(floor), None) => self.wall_in_floor(b, a, floor),
            (None, Some(floor)) => self.wall_in_floor(a, b, floor),
            _ => None,
        }
    }

    /// A floor that is one body with a wall neither bends nor folds.
    fn wall_in_floor(&self, wall: &Override, other: &Override, floor: usize) -> Option<&'static str> {
        let merged =
            wall.action == MergeRigid && matches!(other.action, MergeElastic | LatentHinge | BreakAway);
        let wall = self.building.member(&wall.target).filter(|_| merged)?;
        let members = self.building.members.iter().zip(&self.floors);
        let mut own = members.filter(|(_, of)| **of == Some(floor)).map(|(m, _)| m);
        own.any(|m| touch(m, wall)).then_some("a floor that is one body with a wall neither bends nor folds")
    }

    /// A column end without a body beside it cannot be rigid.
    fn without_neighbour(&self, o: &Override, partition: &Partition) -> Option<Diagnostic> {
        let end = self.end(&o.target).filter(|e| e.axis == 2 && o.action == RigidConnection)?;
        if end.beyond(partition).is_some() {
            return None;
        }
        let message = format!("{} has no member beside it that it could be one body with", quoted(&o.target));
        let error = Diagnostic::error("no-neighbour", message);
        Some(error.help("`elastic_connection` keeps it from yielding"))
    }
}
