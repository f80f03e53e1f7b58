//! Checks of meaning: solids that overlap or hang in the air, plans that remove everything, meshes that
//! cannot work. They run on all members that could be read and report everything they find.

use super::between::Between;
use super::clear::Clear;
use super::connect::unsupported_groups;
use super::fields::Placed;
use super::footings;
use super::gaps;
use super::model::{Charge, Member, MemberKind, Preparation};
use super::overrides;
use super::partition::{COORDINATE_TOLERANCE_M, Partition};
use super::plan::prepared;
use super::read::Draft;
use super::soffits;
use super::structure::list_words;
use super::turned::TurnedBox;
use crate::base::diagnostic::{Diagnostic, Severity, quoted};
use crate::base::source::Span;
use crate::base::tree::Node;
use crate::base::units::{Dimension, round_to_digits, show};
use std::collections::BTreeMap;

/// Most cells of a partition and most elements of a mesh that pass.
const MAX_CELLS: f64 = 1e7;
const MAX_ELEMENTS: f64 = 5e6;
/// Most overlaps and the like that are reported one by one.
pub(super) const MAX_REPORTED: usize = 20;

/// All checks of meaning.
pub fn check(root: &Node, draft: &Draft, found: &mut Vec<Diagnostic>) {
    overlaps(draft, found);
    gaps::check(draft, found);
    turned(draft, found);
    names_of_contacts(draft, found);
    obstacles(draft, found);
    below_ground(draft, found);
    supported_braces(draft, found);
    events_on_removed(draft, found);
    footings::check(draft, found);
    mesh(root, draft, found);
    if draft.members.complete && !draft.members.list.is_empty() {
        removed_wholly(draft, found);
        support(root, draft, found);
        volumes(draft, found);
    }
    overrides::of_removed(draft, found);
    if found.iter().all(|d| d.severity == Severity::Warning) {
        overrides::together(draft, found);
        unused(draft, found);
        soffits::check(&draft.members.list, found);
    }
}

fn overlaps(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let list = &draft.members.list;
    let mut reported = 0;
    for (i, a) in list.iter().enumerate() {
        for b in &list[i + 1..] {
            let Some(problem) = overlap(&a.item, &b.item, list) else { continue };
            reported += 1;
            if reported > MAX_REPORTED {
                return;
            }
            let message = format!(
                "the {} {} and the {} {} {}",
                a.item.kind.name(),
                quoted(&a.item.id),
                b.item.kind.name(),
                quoted(&b.item.id),
                problem.0
            );
            let mut error = Diagnostic::error("overlap", message).at(b.span, problem.1);
            if a.span != b.span {
                error = error.also(a.span, "the other member");
            }
            found.push(error.help_if(problem.2.map(String::from)));
        }
    }
}

/// What is wrong with the common volume of two members: message, label, remedy.
fn overlap(
    a: &Member,
    b: &Member,
    all: &[Placed<Member>],
) -> Option<(&'static str, String, Option<&'static str>)> {
    use MemberKind::{Beam, Column, Footing, Slab, Wall};
    if a.is_skew() || b.is_skew() {
        return turned_pair(a, b, all);
    }
    let common = a.solid.intersection(&b.solid, COORDINATE_TOLERANCE_M)?;
    let volume = format!("{:.4} m3 of common volume", common.volume());
    let plain = Some(("overlap", volume.clone(), None));
    let through = |upright: &Member, flat: &Member| {
        let solid = (upright.solid, flat.solid);
        let above = solid.0.max[2] > solid.1.max[2] + COORDINATE_TOLERANCE_M;
        let below = solid.0.min[2] < solid.1.min[2] - COORDINATE_TOLERANCE_M;
        let remedy = Some("end the lower one at the slab's top and begin another there");
        (above && below).then_some(("cross: one passes through the other", volume.clone(), remedy))
    };
    match (a.kind, b.kind) {
        // those of one floor of a grid may reach over each other at inner corners: what they share belongs to the first
        (Slab, Slab) if a.storey.is_some() && a.storey == b.storey => None,
        (Column, Column) | (Slab, Slab) | (Footing, Footing) | (Slab, Footing) | (Footing, Slab) => plain,
        (Wall, Wall) if a.axis == b.axis => plain,
        // Two beams of one line may meet over a column; crossing beams make a joint anywhere.
        (Beam, Beam) if a.axis == b.axis => {
            let within = |c: &Member| {
                let tolerance = COORDINATE_TOLERANCE_M;
                c.solid.min[a.axis] <= common.min[a.axis] + tolerance
                    && c.solid.max[a.axis] >= common.max[a.axis] - tolerance
                    && super::connect::touch_box(&c.solid, &common)
            };
            let joint = all.iter().any(|c| c.item.kind == Column && within(&c.item));
            if joint { None } else { plain }
        }
        (Column | Wall, Slab) => through(a, b),
        (Slab, Column | Wall) => through(b, a),
        _ => None,
    }
}

/// What is wrong with two members one of which is turned. One such member may run into others ([`turned`] looks at it alone).
fn turned_pair(
    a: &Member,
    b: &Member,
    all: &[Placed<Member>],
) -> Option<(&'static str, String, Option<&'static str>)> {
    let [p, q] = [a, b].map(TurnedBox::of);
    if a.inclined.is_some() || b.inclined.is_some() {
        let near =
            |m: &Member, shape: TurnedBox| shape.longer(m.axis, m.inclined.map_or(0.0, |i| i.slack_m()));
        if !(a.is_skew() && b.is_skew() && near(a, p).overlaps(&near(b, q))) {
            return None;
        }
        let members: Vec<&Member> = all.iter().map(|m| &m.item).collect();
        let place = |m: &Member| members.iter().position(|o| std::ptr::eq(*o, m));
        let (p, q) = (Clear::of(&members, place(a)?), Clear::of(&members, place(b)?));
        let remedy = "a brace meets members along the axes only: move one aside, or let both end at a column, beam or slab";
        return p.overlaps(&q).then(|| ("have a common volume", "outside their joints".into(), Some(remedy)));
    }
    let remedy = "tie each to a member along the axes, such as a slab, and leave a gap between them";
    (a.is_skew() && b.is_skew() && p.touches(&q)).then(|| {
        (
            "touch, and both are turned by `rotation_deg`",
            "a turned member meets members along the axes only".into(),
            Some(remedy),
        )
    })
}

/// Turned members that cannot butt against their neighbours.
fn turned(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let members: Vec<&Member> = draft.members.list.iter().map(|m| &m.item).collect();
    for (index, member) in draft.members.list.iter().enumerate().filter(|(_, m)| m.item.is_skew()) {
        let Some(wrong) = Clear::of(&members, index).problem() else { continue };
        let (noun, id) = (member.item.kind.name(), quoted(&member.item.id));
        let (turned, label) = match member.item.inclined {
            Some(_) => ("", String::new()),
            None => ("turned ", format!("`rotation_deg = {}`", member.item.rotation_deg)),
        };
        let message = format!("the {turned}{noun} {id} {}", wrong.problem);
        found.push(Diagnostic::error("turned-member", message).at(member.span, label).help(wrong.remedy));
    }
}

/// What members and obstacles may not be called: contacts with the ground are told by this name.
const GROUND: &str = "ground";

/// Contacts tell members, obstacles and the ground apart by their names.
fn names_of_contacts(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let members = || draft.members.list.iter().map(|m| (m.item.id.as_str(), m.span));
    let obstacles = || draft.obstacles.iter().map(|o| (o.item.id.as_str(), o.span));
    for (_, span) in members().chain(obstacles()).filter(|(id, _)| *id == GROUND) {
        let error = Diagnostic::error("duplicate-id", "the ground is called `ground` already")
            .at(span, "the same name")
            .help("contacts are told by names: choose another id");
        found.push(error);
    }
    let of_members: BTreeMap<&str, Span> = members().collect();
    for (id, span) in obstacles() {
        if let Some(member) = of_members.get(id) {
            let message = format!("a member and an obstacle have the id {}", quoted(id));
            let error = Diagnostic::error("duplicate-id", message)
                .at(span, "the obstacle")
                .also(*member, "the member")
                .help("contacts are told by names: choose another id for one of them");
            found.push(error);
        }
    }
}

fn obstacles(draft: &Draft, found: &mut Vec<Diagnostic>) {
    for obstacle in &draft.obstacles {
        let hits: Vec<&Placed<Member>> = draft
            .members
            .list
            .iter()
            .filter(|m| TurnedBox::of(&m.item).overlaps(&TurnedBox::of_box(&obstacle.item.solid)))
            .collect();
        if let Some(first) = hits.first() {
            let more = if hits.len() > 1 { format!(" and {} more", hits.len() - 1) } else { String::new() };
            let message = format!(
                "the obstacle {} overlaps the {} {}{more}",
                quoted(&obstacle.item.id),
                first.item.kind.name(),
                quoted(&first.item.id)
            );
            found.push(
                Diagnostic::error("overlap", message).at(obstacle.span, "").also(first.span, "the member"),
            );
        }
        if draft.ground.is_some_and(|g| obstacle.item.solid.max[2] <= g.level_m) {
            let warning = Diagnostic::warning(
                "buried-obstacle",
                "this obstacle lies below the ground: nothing can hit it",
            );
            found.push(warning.at(obstacle.span, ""));
        }
    }
}

fn below_ground(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let Some(ground) = draft.ground else { return };
    let mut seen: Vec<Span> = Vec::new();
    let members: Vec<&Member> = draft.members.list.iter().map(|m| &m.item).collect();
    for (index, member) in draft.members.list.iter().enumerate() {
        if member.item.kind == MemberKind::Footing {
            continue;
        }
        let lowest = match member.item.inclined {
            Some(_) if member.item.solid.min[2] < ground.level_m => Clear::of(&members, index).lowest_m(),
            _ => member.item.solid.min[2],
        };
        let depth = ground.level_m - lowest;
        if depth > COORDINATE_TOLERANCE_M && !seen.contains(&member.span) {
            seen.push(member.span);
            let (noun, id) = (member.item.kind.name(), quoted(&member.item.id));
            let message =
                format!("the {noun} {id} reaches {} below the ground", show(depth, Dimension::Length));
            let error = Diagnostic::error("below-ground", message).at(member.span, "").help(format!(
                "the ground is at {}; only footings may lie below it",
                show(ground.level_m, Dimension::Length)
            ));
            found.push(error);
        }
    }
}

fn unused(draft: &Draft, found: &mut Vec<Diagnostic>) {
    for (id, section) in &draft.sections {
        if !draft.members.used_sections.contains(id) {
            let warning = Diagnostic::warning("unused", format!("no member uses the section {}", quoted(id)));
            found.push(warning.at(section.span, ""));
        }
    }
    let used = |id: &String| {
        let mut sections = draft.sections.values();
        sections.any(|s| s.item.1.as_ref().is_none_or(|s| [&s.concrete, &s.steel, &s.law].contains(&id)))
    };
    for (id, material) in draft.materials.iter().filter(|(id, _)| !used(id)) {
        let warning = Diagnostic::warning("unused", format!("no section uses the material {}", quoted(id)));
        found.push(warning.at(material.span, ""));
    }
}

fn is_cut(draft: &Draft, id: &str) -> bool {
    draft.preparation.iter().any(|p| matches!(&p.item, Preparation::Cut { member } if member == id))
}

fn events_on_removed(draft: &Draft, found: &mut Vec<Diagnostic>) {
    for (i, event) in draft.events.iter().enumerate() {
        let member = &event.item.member;
        if let Some(cut) =
            draft.preparation.iter().find(|p| is_cut(draft, member) && prepared(&p.item) == member)
        {
            let message = format!(
                "the event {} is on {}, which is cut away before",
                quoted(&event.item.id),
                quoted(member)
            );
            found.push(
                Diagnostic::error("removed-twice", message).at(event.span, "").also(cut.span, "cut here"),
            );
        }
        let earlier = |e: &&Placed<Charge>| e.item.member == *member && remove_both(&e.item, &event.item);
        if let Some(first) = draft.events[..i].iter().find(earlier) {
            found.push(twice(event, first));
        }
    }
}

/// Whether a charge on a member removes what an earlier one has removed; a later one may take the rest away.
fn remove_both(earlier: &Charge, later: &Charge) -> bool {
    match (earlier.stretch_m, later.stretch_m) {
        (None, _) => true,
        (Some(_), None) => later.time_s <= earlier.time_s,
        // ends that are the same place may differ in their last digits: 0.1 + 0.2 and 0.3
        (Some([a, b]), Some([c, d])) => a.max(c) + COORDINATE_TOLERANCE_M < b.min(d),
    }
}

/// That a charge removes what an earlier one has removed already.
fn twice(event: &Placed<Charge>, first: &Placed<Charge>) -> Diagnostic {
    let (id, member) = (quoted(&event.item.id), quoted(&event.item.member));
    let (message, help) = match (event.item.stretch_m, first.item.stretch_m) {
        (_, None) => (format!("the event {id} is on {member}, which is already removed"), ""),
        (None, Some(_)) => (
            format!(
                "the event {id} removes all of {member} at the time at which another removes a part of it"
            ),
            "leave out the one with a `stretch`",
        ),
        (Some([a, b]), Some([c, d])) => (
            format!(
                "the event {id} removes {member} from {a} to {b} m, of which {} to {} m are already removed",
                a.max(c),
                b.min(d)
            ),
            "give stretches that do not overlap",
        ),
    };
    let error =
        Diagnostic::error("removed-twice", message).at(event.span, "").also(first.span, "removed here");
    if help.is_empty() { error } else { error.help(help) }
}

fn removed_wholly(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let gone = |m: &Placed<Member>| {
        let charged = draft.events.iter().any(|e| e.item.member == m.item.id && e.item.stretch_m.is_none());
        charged || is_cut(draft, &m.item.id)
    };
    if draft.members.list.iter().all(gone) {
        let error = Diagnostic::error(
            "all-removed",
            "the events and cuts remove the whole building: nothing is left to fall",
        );
        let place = draft.events.first().map(|e| e.span).or(draft.preparation.first().map(|p| p.span));
        found.push(match place {
            Some(span) => error.at(span, ""),
            None => error,
        });
    }
}

fn support(root: &Node, draft: &Draft, found: &mut Vec<Diagnostic>) {
    let list = &draft.members.list;
    if draft.supports.is_empty() {
        // A support that names nothing that exists has been reported.
        if root.get("supports").is_none_or(|n| n.items().is_empty()) {
            let error = Diagnostic::error("no-supports", "the building has no supports")
                .help("add `[[supports]]` with `members = [\"C1-*\"]`");
            found.push(error);
        }
        return;
    }
    let members: Vec<&Member> = list.iter().map(|m| &m.item).collect();
    let supported: Vec<bool> =
        list.iter().map(|m| draft.supports.iter().any(|s| s.item.member == m.item.id)).collect();
    let all = vec![true; list.len()];
    let loose = unsupported_groups(&members, &all, &supported);
    for group in &loose {
        let ids: Vec<&str> = group.iter().map(|&i| list[i].item.id.as_str()).collect();
        let first = &list[group[0]];
        let (subject, label) = if group.len() == 1 {
            (
                format!("the {} {} touches", first.item.kind.name(), quoted(ids[0])),
                "hangs in the air".to_string(),
            )
        } else {
            (format!("{} members touch", group.len()), some_of(&ids))
        };
        let error = Diagnostic::error("unsupported", format!("{subject} nothing that is supported"))
            .at(first.span, label)
            .help("members touch where their solids share a face; check the coordinates, or add a support");
        found.push(error);
    }
    let present: Vec<bool> = list.iter().map(|m| !is_cut(draft, &m.item.id)).collect();
    if loose.is_empty() && present.contains(&false) {
        for group in unsupported_groups(&members, &present, &supported) {
            let ids: Vec<&str> = group.iter().map(|&i| list[i].item.id.as_str()).collect();
            let Some(cut) = draft.preparation.iter().find(|p| matches!(p.item, Preparation::Cut { .. }))
            else {
                continue;
            };
            let error = Diagnostic::error(
                "unsupported",
                "after the cuts, before ignition, a part hangs in the air",
            )
            .at(cut.span, some_of(&ids))
            .help(
                "a cut is made before the dead-load state; use an event to remove a member in the collapse",
            );
            found.push(error);
        }
    }
    high_supports(draft, found);
    loose_feet(draft, &supported, found);
}

/// A brace has no face that a support could hold.
fn supported_braces(draft: &Draft, found: &mut Vec<Diagnostic>) {
    for support in &draft.supports {
        let member = draft.members.list.iter().find(|m| m.item.id == support.item.member);
        let Some(member) = member.filter(|m| m.item.inclined.is_some()) else { continue };
        let message = format!("the brace {} cannot be supported", quoted(&member.item.id));
        let error = Diagnostic::error("not-supported", message)
            .at(support.span, "")
            .also(member.span, "the brace")
            .help("let it end in a footing, and support that");
        found.push(error);
    }
}

fn high_supports(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let Some(ground) = draft.ground else { return };
    let mut seen: Vec<Span> = Vec::new();
    for support in &draft.supports {
        let Some(member) = draft.members.list.iter().find(|m| m.item.id == support.item.member) else {
            continue;
        };
        let height = member.item.solid.min[2] - ground.level_m;
        if height > COORDINATE_TOLERANCE_M && !seen.contains(&support.span) {
            seen.push(support.span);
            let message = format!(
                "{} is held {} above the ground",
                quoted(&support.item.member),
                show(height, Dimension::Length)
            );
            found.push(Diagnostic::warning("high-support", message).at(support.span, "is this meant?"));
        }
    }
}

/// Warns of members that stand on the ground unheld, beside ones that are supported: a run drops them, and takes their settling for the first contact.
fn loose_feet(draft: &Draft, supported: &[bool], found: &mut Vec<Diagnostic>) {
    let Some(ground) = draft.ground else { return };
    let on_footing = |m: &Member| draft.members.list.iter().any(|other| m.stands_on(&other.item));
    let stands = |m: &Member| {
        let height = m.solid.min[2] - ground.level_m;
        match m.kind {
            MemberKind::Footing => height < COORDINATE_TOLERANCE_M,
            MemberKind::Column | MemberKind::Wall => height.abs() < COORDINATE_TOLERANCE_M && !on_footing(m),
            _ => false,
        }
    };
    let loose = draft
        .members
        .list
        .iter()
        .zip(supported)
        .filter(|(m, held)| !**held && stands(&m.item) && !is_cut(draft, &m.item.id));
    let loose: Vec<_> = loose.map(|(m, _)| m).collect();
    let Some(first) = loose.first() else { return };
    let ids: Vec<&str> = loose.iter().map(|m| m.item.id.as_str()).collect();
    let message = match ids.as_slice() {
        [one] => {
            format!("the {} {} stands on the ground without a support", first.item.kind.name(), quoted(one))
        }
        more => format!("{} members stand on the ground without a support", more.len()),
    };
    let warning = Diagnostic::warning("loose-foot", message).at(first.span, some_of(&ids));
    found.push(warning.help("name them in the `members` of a `[[supports]]`; without it the ground only carries them by contact, once they have sunk onto it"));
}

/// "`A`, `B`, `C` and 4 more".
pub(super) fn some_of(ids: &[&str]) -> String {
    if ids.len() <= 5 {
        return list_words(ids).replace(" or ", " and ");
    }
    let shown: Vec<String> = ids.iter().take(4).map(|id| format!("`{id}`")).collect();
    format!("{} and {} more", shown.join(", "), ids.len() - 4)
}

/// Members that the precedence of solids leaves without volume, and beams at columns that go on above and below them.
fn volumes(draft: &Draft, found: &mut Vec<Diagnostic>) {
    let Some(building) = draft.building() else { return };
    let planes: f64 = (0..3)
        .map(|i| {
            let mut all: Vec<f64> = building
                .members
                .iter()
                .filter(|m| !m.is_skew())
                .flat_map(|m| [m.solid.min[i], m.solid.max[i]])
                .collect();
            all.sort_by(f64::total_cmp);
            all.dedup();
            all.len() as f64
        })
        .product();
    if planes > MAX_CELLS {
        let error =
            Diagnostic::error("too-many", format!("the faces of all members make {planes:.1e} cells")).help(
                format!(
                    "at most {MAX_CELLS:.0e}: align the members' faces or describe a part of the building"
                ),
            );
        found.push(error);
        return;
    }
    let partition = Partition::of(&building);
    for met in Between::all(&building, &partition).into_iter().take(MAX_REPORTED) {
        let [beam, column] = [met.beam, met.column].map(|i| draft.members.list[i].span);
        let warning =
            Diagnostic::warning("between-ends", met.problem()).at(beam, "in FE only").help(met.remedy());
        found.push(if beam == column { warning } else { warning.also(column, "the column") });
    }
    let volumes = partition.volumes(building.members.len());
    for (member, volume) in draft.members.list.iter().zip(volumes) {
        if volume < 1e-3 * member.item.solid.volume() && !member.item.is_skew() {
            let (noun, id) = (member.item.kind.name(), quoted(&member.item.id));
            let message = format!("the {noun} {id} lies wholly inside other members");
            let error = Diagnostic::error("overlap", message)
                .at(member.span, "no volume of its own is left")
                .help("where solids overlap, a footing comes before a slab, a wall, a beam and a column");
            found.push(error);
        }
    }
}

fn mesh(root: &Node, draft: &Draft, found: &mut Vec<Diagnostic>) {
    let size = draft.settings.mesh_size_m;
    let settings = root.get("settings");
    let place = settings.and_then(|s| s.get("mesh_size")).or(settings).map(|n| n.span);
    let Some(span) = place else { return };
    let volume: f64 = draft.members.list.iter().map(|m| m.item.size_m().iter().product::<f64>()).sum();
    let elements = volume / size.powi(3);
    if elements > MAX_ELEMENTS {
        let error =
            Diagnostic::error("mesh-size", format!("this mesh size makes about {elements:.1e} elements"))
                .at(span, show(size, Dimension::Length))
                .help(format!(
                    "with {} it is below {:.0e}",
                    show(round_to_digits(1.05 * libm::cbrt(volume / MAX_ELEMENTS), 2), Dimension::Length),
                    MAX_ELEMENTS
                ));
        found.push(error);
    }
    let longest = |m: &Placed<Member>| m.item.size_m().into_iter().fold(0.0, f64::max);
    let shortest = draft.members.list.iter().min_by(|a, b| longest(a).total_cmp(&longest(b)));
    if let Some(member) = shortest.filter(|m| size > 0.5 * longest(m)) {
        let (noun, id) = (member.item.kind.name(), quoted(&member.item.id));
        let message = format!(
            "the mesh is too coarse for the {noun} {id}, which is {} long",
            show(longest(member), Dimension::Length)
        );
        let error = Diagnostic::error("mesh-size", message)
            .at(span, "at most half the length of the shortest member");
        found.push(error);
    }
}
