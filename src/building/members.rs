//! Members of a building file: from the grid and one by one.

use super::fields::{Fields, Placed};
use super::format::{GRID, MEMBER};
use super::grid::{Grid, Shapes, clean};
use super::inclined::Inclined;
use super::materials::Defined;
use super::model::{Member, MemberKind, Section, SectionShape};
use super::openings;
use super::structure::list_words;
use super::turned::TurnedBox;
use crate::base::diagnostic::{Diagnostic, closest, quoted};
use crate::base::geom::Aabb;
use crate::base::source::Span;
use crate::base::tree::Node;
use crate::base::units::{Dimension, round_to_digits, show};

/// Two coordinates nearer than this are the same \[m\].
const SAME_M: f64 = 1e-6;
/// Longest column or beam, and longest side of a plate, that passes \[m\].
const LONGEST_M: (f64, f64) = (60.0, 300.0);

/// The members that could be read.
#[derive(Default)]
pub struct Members {
    /// Members with the place that defines them.
    pub list: Vec<Placed<Member>>,
    /// Whether all members of the file are in the list.
    pub complete: bool,
    /// Ids of sections that members use.
    pub used_sections: Vec<String>,
}

/// Reads `[grid]` and `[[members]]`.
pub fn members(
    root: &Node,
    ground_level: Option<f64>,
    sections: &Defined<Section>,
    found: &mut Vec<Diagnostic>,
) -> Members {
    let mut members = Members { list: Vec::new(), complete: true, used_sections: Vec::new() };
    if let Some(node) = root.get("grid") {
        let made = grid(Fields { node, table: &GRID }, ground_level, sections, &mut members, found);
        members.complete &= made.is_some();
        members.list = made.unwrap_or_default();
    }
    let single = root.get("members").map_or(&[][..], Node::items);
    for node in single {
        let read = member(Fields { node, table: &MEMBER }, sections, &mut members.used_sections, found);
        members.complete &= read.is_some();
        members.list.extend(read);
    }
    if root.get("grid").is_none() && single.is_empty() {
        let error = Diagnostic::error("no-members", "the building has no members")
            .help("add a `[grid]` for a regular frame, or `[[members]]` one by one");
        found.push(error);
    }
    duplicates(&members.list, found);
    members
}

fn duplicates(list: &[Placed<Member>], found: &mut Vec<Diagnostic>) {
    let mut seen = std::collections::BTreeMap::new();
    for member in list {
        if let Some(first) = seen.insert(&member.item.id, member.span) {
            let error = Diagnostic::error(
                "duplicate-id",
                format!("two members have the id {}", quoted(&member.item.id)),
            )
            .at(member.span, "again here")
            .also(first, "first here");
            found.push(error);
        }
    }
}

fn grid(
    fields: Fields<'_>,
    ground_level: Option<f64>,
    sections: &Defined<Section>,
    members: &mut Members,
    found: &mut Vec<Diagnostic>,
) -> Option<Vec<Placed<Member>>> {
    let used = &mut members.used_sections;
    let mut shape = |key, kind| section_shape(fields, key, kind, sections, used, found);
    let shapes = Shapes {
        column: shape("column_section", MemberKind::Column),
        beam: shape("beam_section", MemberKind::Beam),
        slab: shape("slab_section", MemberKind::Slab),
    };
    let grid = Grid::read(fields, ground_level, &shapes, found)?;
    let span = fields.node.span;
    let made = grid.members();
    if let Some(slab) = grid.whole_slab() {
        openings::check(fields, "slab_openings", &slab, found)?;
    }
    Some(made.into_iter().map(|item| Placed { item, span }).collect())
}

/// The shape of the section named by a key, if it exists and suits the kind of member.
fn section_shape(
    fields: Fields<'_>,
    key: &str,
    kind: MemberKind,
    sections: &Defined<Section>,
    used: &mut Vec<String>,
    found: &mut Vec<Diagnostic>,
) -> Option<SectionShape> {
    let id = fields.text(key)?;
    used.push(id.to_string());
    let span = fields.span(key);
    let Some(section) = sections.get(id) else {
        let names: Vec<&str> = sections.keys().map(String::as_str).collect();
        let help = match closest(id, names.iter().copied()) {
            Some(near) => Some(format!("did you mean `{near}`?")),
            None if names.is_empty() => None,
            None => Some(format!("the sections of this file are {}", list_words(&names))),
        };
        let error = Diagnostic::error("unknown-id", format!("there is no section {}", quoted(id)))
            .at(span, "not defined");
        found.push(error.help_if(help));
        return None;
    };
    let bar = matches!(kind, MemberKind::Column | MemberKind::Beam | MemberKind::Brace);
    let wanted = if bar { "rectangle" } else { "plate" };
    let has = section.item.0.as_str();
    if matches!(has, "rectangle" | "plate") && has != wanted {
        let message = format!("a {} needs a {wanted} section, but {} is a {has}", kind.name(), quoted(id));
        found.push(Diagnostic::error("wrong-kind", message).at(span, "").also(section.span, "defined here"));
        return None;
    }
    section.item.1.as_ref().map(|s| s.shape.clone())
}

fn member(
    fields: Fields<'_>,
    sections: &Defined<Section>,
    used: &mut Vec<String>,
    found: &mut Vec<Diagnostic>,
) -> Option<Placed<Member>> {
    let kind = match fields.text("kind")? {
        "column" => MemberKind::Column,
        "beam" => MemberKind::Beam,
        "slab" => MemberKind::Slab,
        "wall" => MemberKind::Wall,
        "brace" => MemberKind::Brace,
        _ => MemberKind::Footing,
    };
    let shape = section_shape(fields, "section", kind, sections, used, found);
    let (from, to) = (fields.point("from")?, fields.point("to")?);
    let place = Place { from, to, from_span: fields.span("from"), to_span: fields.span("to") };
    let rotation_deg = rotation(fields, kind, found)?;
    let roll_deg = roll(fields, kind, found)?;
    let (solid, axis, inclined) = if kind == MemberKind::Brace {
        let inclined = place.inclined(roll_deg, shape.as_ref(), found)?;
        (Aabb::from_corners(from, to), 0, Some(inclined))
    } else {
        let (solid, axis) = place.solid(kind, shape.as_ref(), found)?;
        (solid, axis, None)
    };
    let mut item = Member {
        id: fields.text("id")?.to_string(),
        kind,
        section: fields.text("section")?.to_string(),
        solid,
        axis,
        storey: None,
        openings: Vec::new(),
        rotation_deg,
        inclined,
    };
    if inclined.is_some() {
        item.solid = TurnedBox::of(&item).bounds();
    }
    item.openings = openings::check(fields, "openings", &item, found)?;
    Some(Placed { item, span: fields.span("id") })
}

/// The angle by which a member is turned \[deg\]; `None` after an error.
fn rotation(fields: Fields<'_>, kind: MemberKind, found: &mut Vec<Diagnostic>) -> Option<f64> {
    let angle = fields.number_or("rotation_deg", 0.0)?;
    if angle == 0.0 {
        return Some(0.0);
    }
    let plate = matches!(kind, MemberKind::Slab | MemberKind::Footing | MemberKind::Brace);
    let open = fields.child("openings").is_some_and(|o| !o.items().is_empty());
    let (message, remedy) = if plate {
        (
            format!("a {} cannot be turned", kind.name()),
            if kind == MemberKind::Brace {
                "its two points say its direction; `roll_deg` rolls its section about its axis"
            } else {
                "only columns, beams and walls: leave `rotation_deg` out"
            },
        )
    } else if open {
        (
            "a turned wall cannot have openings".into(),
            "divide the wall at its openings, or leave `rotation_deg` out",
        )
    } else {
        return Some(angle);
    };
    found.push(
        Diagnostic::error("not-supported", message)
            .at(fields.span("rotation_deg"), "not supported")
            .help(remedy),
    );
    None
}

/// The angle by which a brace is rolled \[deg\]; `None` after an error.
fn roll(fields: Fields<'_>, kind: MemberKind, found: &mut Vec<Diagnostic>) -> Option<f64> {
    let angle = fields.number_or("roll_deg", 0.0)?;
    if kind == MemberKind::Brace || fields.child("roll_deg").is_none() {
        return Some(angle);
    }
    let error = Diagnostic::error("not-supported", format!("a {} cannot be rolled", kind.name()))
        .at(fields.span("roll_deg"), "only braces")
        .help("leave `roll_deg` out; `rotation_deg` turns columns, beams and walls about the vertical axis");
    found.push(error);
    None
}

/// The two points of a member.
struct Place {
    from: [f64; 3],
    to: [f64; 3],
    from_span: Span,
    to_span: Span,
}

impl Place {
    /// The gross solid and its axis; without a shape only the points are checked.
    fn solid(
        &self,
        kind: MemberKind,
        shape: Option<&SectionShape>,
        found: &mut Vec<Diagnostic>,
    ) -> Option<(Aabb, usize)> {
        let runs: Vec<usize> = (0..3).filter(|&i| (self.to[i] - self.from[i]).abs() > SAME_M).collect();
        let (axis, wanted) = match (kind, runs.as_slice()) {
            (MemberKind::Column, [2]) => (2, ""),
            (MemberKind::Column, _) => (2, "a column is vertical: only z may differ"),
            (MemberKind::Beam, [axis @ (0 | 1)]) => (*axis, ""),
            (MemberKind::Beam, _) => (0, "a beam runs along x or along y: only one of them may differ"),
            (MemberKind::Slab | MemberKind::Footing, [0, 1]) => (2, ""),
            (MemberKind::Slab | MemberKind::Footing, _) => {
                (2, "a horizontal plate: x and y must differ, z must not")
            }
            (MemberKind::Wall, [0, 2]) => (1, ""),
            (MemberKind::Wall, [1, 2]) => (0, ""),
            (MemberKind::Wall, _) => (0, "a wall is vertical along x or y: z and one of them must differ"),
            (MemberKind::Brace, _) => (0, ""), // [`Self::inclined`]
        };
        if !wanted.is_empty() {
            found.push(self.wrong_direction(kind, &runs, wanted));
            return None;
        }
        self.check_length(kind, &runs, found)?;
        let gross = Aabb::from_corners(self.from, self.to);
        Some((thicken(gross, kind, axis, shape?), axis))
    }

    /// Axis and section of a bar in any direction; without a shape only the points are checked.
    fn inclined(
        &self,
        roll_deg: f64,
        shape: Option<&SectionShape>,
        found: &mut Vec<Diagnostic>,
    ) -> Option<Inclined> {
        let length = (0..3).map(|i| (self.to[i] - self.from[i]).powi(2)).sum::<f64>().sqrt();
        if length <= SAME_M {
            found.push(self.wrong_direction(MemberKind::Brace, &[], "the axis has no length"));
            return None;
        }
        if !(0.2..=LONGEST_M.0).contains(&length) {
            let message =
                format!("this brace is {} long", show(round_to_digits(length, 4), Dimension::Length));
            let error = Diagnostic::error("out-of-range", message)
                .at(self.to_span, format!("plausible: 0.2 m to {} m", LONGEST_M.0))
                .also(self.from_span, "");
            found.push(error);
            return None;
        }
        let SectionShape::Rectangle { width_m, depth_m, .. } = shape? else { return None };
        Some(Inclined { from_m: self.from, to_m: self.to, roll_deg, width_m: *width_m, depth_m: *depth_m })
    }

    fn wrong_direction(&self, kind: MemberKind, runs: &[usize], wanted: &str) -> Diagnostic {
        let noun = kind.name();
        if runs.is_empty() {
            return Diagnostic::error("bad-place", format!("both points of this {noun} are the same"))
                .at(self.to_span, wanted)
                .also(self.from_span, "");
        }
        let skew = match kind {
            MemberKind::Column | MemberKind::Beam => runs.len() > 1,
            _ => runs.len() == 3,
        };
        if skew {
            let level = (self.from[2] - self.to[2]).abs() <= SAME_M;
            let bar = matches!(kind, MemberKind::Column | MemberKind::Beam);
            let remedy = if kind == MemberKind::Beam && level || kind == MemberKind::Wall {
                Some("place it along x or y about its middle and turn it with `rotation_deg`")
            } else {
                bar.then_some("a `brace` runs in any direction")
            };
            return Diagnostic::error("not-supported", format!("a skew {noun} is not supported"))
                .at(self.to_span, wanted)
                .also(self.from_span, "")
                .help_if(remedy.map(String::from));
        }
        Diagnostic::error("bad-place", format!("these points do not make a {noun}"))
            .at(self.to_span, wanted)
            .also(self.from_span, "")
    }

    fn check_length(&self, kind: MemberKind, runs: &[usize], found: &mut Vec<Diagnostic>) -> Option<()> {
        let longest =
            if matches!(kind, MemberKind::Column | MemberKind::Beam) { LONGEST_M.0 } else { LONGEST_M.1 };
        for &i in runs {
            let length = (self.to[i] - self.from[i]).abs();
            if !(0.2..=longest).contains(&length) {
                let message = format!(
                    "this {} is {} long in {}",
                    kind.name(),
                    show(length, Dimension::Length),
                    ["x", "y", "z"][i]
                );
                let error = Diagnostic::error("out-of-range", message)
                    .at(self.to_span, format!("plausible: 0.2 m to {longest} m"))
                    .also(self.from_span, "");
                found.push(error);
                return None;
            }
        }
        Some(())
    }
}

/// Gives the box of the two points its section: around the axis of a column, below the top of a beam, slab
/// or footing, on both sides of the middle plane of a wall.
fn thicken(mut solid: Aabb, kind: MemberKind, axis: usize, shape: &SectionShape) -> Aabb {
    let mut around = |i: usize, size: f64| {
        solid.min[i] = clean(solid.min[i] - 0.5 * size);
        solid.max[i] = clean(solid.max[i] + 0.5 * size);
    };
    match (shape, kind) {
        (SectionShape::Rectangle { width_m, depth_m, .. }, MemberKind::Column) => {
            around(0, *width_m);
            around(1, *depth_m);
        }
        (SectionShape::Rectangle { width_m, depth_m, .. }, _) => {
            around(1 - axis, *width_m);
            solid.min[2] = clean(solid.max[2] - depth_m);
        }
        (SectionShape::Plate { thickness_m, .. }, MemberKind::Wall) => around(axis, *thickness_m),
        (SectionShape::Plate { thickness_m, .. }, _) => solid.min[2] = clean(solid.max[2] - thickness_m),
    }
    solid
}
