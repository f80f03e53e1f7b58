//! A regular frame from axes and storey heights.
//!
//! Gross solids, as a formwork drawing names them: columns reach from slab top to slab top, beams are
//! measured to the slab's top. Beams along x run over the columns at both ends. A beam along y ends at the
//! column's face where a beam along x runs over that column, and runs over the column itself elsewhere: then
//! the block above a column always belongs to one beam ([`super::partition`]).

use super::bays::{BayRange, Bays};
use super::fields::Fields;
use super::model::{Member, MemberKind, SectionShape};
use super::partition::COORDINATE_TOLERANCE_M;
use crate::base::diagnostic::Diagnostic;
use crate::base::geom::Aabb;
use crate::base::units::{Dimension, show};

/// Most members of a building, and of a grid.
pub const MAX_MEMBERS: usize = 20_000;

/// Distance of axes above which a slip of units is likely \[m\]: as long as a beam may be.
const LONGEST_SPAN_M: f64 = 60.0;

/// A grid in numbers, m.
pub struct Grid<'a> {
    x: Vec<f64>,
    y: Vec<f64>,
    /// Slab tops from the column feet up.
    levels: Vec<f64>,
    column: (&'a str, [f64; 2]),
    beam: Option<(&'a str, [f64; 2])>,
    perimeter_only: bool,
    slab: Option<(&'a str, f64)>,
    overhang: f64,
    slab_openings: Vec<[[f64; 2]; 2]>,
    bays: Bays,
}

/// Shapes of the sections that the grid names; `None` if there is none or it has errors.
pub struct Shapes {
    /// Of the columns.
    pub column: Option<SectionShape>,
    /// Of the beams.
    pub beam: Option<SectionShape>,
    /// Of the slabs.
    pub slab: Option<SectionShape>,
}

impl<'a> Grid<'a> {
    /// Reads `[grid]`; `None` if it has errors.
    pub fn read(
        fields: Fields<'a>,
        ground_level: Option<f64>,
        shapes: &Shapes,
        found: &mut Vec<Diagnostic>,
    ) -> Option<Self> {
        let rectangle = |key, shape: &Option<SectionShape>| match (fields.text(key), shape) {
            (Some(id), Some(SectionShape::Rectangle { width_m, depth_m, .. })) => {
                Some((id, [*width_m, *depth_m]))
            }
            _ => None,
        };
        let column = rectangle("column_section", &shapes.column);
        let beam = rectangle("beam_section", &shapes.beam);
        let beams = if fields.child("beams").is_some() { fields.text("beams") } else { Some("perimeter") };
        if beams.is_some_and(|b| b != "none") && fields.child("beam_section").is_none() {
            let error = Diagnostic::error("missing-key", "[grid] needs the key `beam_section`")
                .at(fields.node.span, "`beam_section` is missing")
                .help("add `beam_section = \"beam\"`, or `beams = \"none\"` for a flat slab");
            found.push(error);
        }
        let slab = match (fields.text("slab_section"), &shapes.slab) {
            (Some(id), Some(SectionShape::Plate { thickness_m, .. })) => Some((id, *thickness_m)),
            _ => None,
        };
        let (x, y) = (fields.numbers("x"), fields.numbers("y"));
        let before = found.len();
        for (key, axes, side) in [("x", &x, 0), ("y", &y, 1)] {
            check_axes(fields, key, axes.as_deref(), column.map(|(_, size)| size[side]), found);
        }
        let heights = fields.numbers("storey_heights");
        let deepest = slab.map_or(0.0, |s| s.1).max(beam.map_or(0.0, |b| b.1[1]));
        check_heights(fields, heights.as_deref(), deepest, found);
        let base = match fields.child("base") {
            Some(_) => fields.number("base"),
            None => ground_level,
        };
        if found.len() > before {
            return None;
        }
        let (x, y, heights, base) = (x?, y?, heights?, base?);
        let bays = Bays::read(fields, [&x, &y], found)?;
        let count = heights.len() * x.len() * y.len() * 3;
        if count > MAX_MEMBERS {
            let message = format!("the grid makes about {count} members");
            found.push(
                Diagnostic::error("too-many", message).at(fields.node.span, format!("at most {MAX_MEMBERS}")),
            );
            return None;
        }
        long_spans(fields, [("x", &x), ("y", &y)], found);
        let (beams, overhang) = (beams?, fields.number_or("slab_overhang", 0.0)?);
        if slab.is_some() && !have_width(fields, [&x, &y], overhang, found) {
            return None;
        }
        let wants_beams = beams != "none";
        if (wants_beams && beam.is_none()) || (fields.child("slab_section").is_some() && slab.is_none()) {
            return None;
        }
        let mut levels = vec![base];
        for (i, height) in heights.iter().enumerate() {
            levels.push(clean(levels[i] + height));
        }
        let beam = beam.filter(|_| wants_beams);
        Some(Self {
            x,
            y,
            levels,
            column: column?,
            beam,
            perimeter_only: beams == "perimeter",
            slab,
            overhang,
            slab_openings: super::openings::rectangles(fields, "slab_openings")?,
            bays,
        })
    }

    /// The members in storey order: columns, beams along x, beams along y, slab.
    pub fn members(&self) -> Vec<Member> {
        let mut members = Vec::new();
        for storey in 1..self.levels.len() {
            self.columns(storey, &mut members);
            self.beams(storey, &mut members);
            self.slabs(storey, &mut members);
        }
        members
    }

    /// The slab over the whole grid, whatever bays are built, in which its openings have to lie.
    pub fn whole_slab(&self) -> Option<Member> {
        let whole = Bays::all([self.x.len(), self.y.len()]);
        self.slab_of(1, &whole, &whole.blocks()[0], "S1".to_string())
    }

    fn columns(&self, storey: usize, members: &mut Vec<Member>) {
        let (section, [width, depth]) = self.column;
        for (i, &x) in self.x.iter().enumerate() {
            for (j, &y) in self.y.iter().enumerate().filter(|(j, _)| self.bays.has_column(i, *j)) {
                let solid = Aabb {
                    min: [clean(x - 0.5 * width), clean(y - 0.5 * depth), self.levels[storey - 1]],
                    max: [clean(x + 0.5 * width), clean(y + 0.5 * depth), self.levels[storey]],
                };
                members.push(member(column_id(storey, i, j), MemberKind::Column, section, solid, 2, storey));
            }
        }
    }

    fn beams(&self, storey: usize, members: &mut Vec<Member>) {
        let Some((section, [width, depth])) = self.beam else { return };
        let top = self.levels[storey];
        let (half_x, half_y) = (0.5 * self.column.1[0], 0.5 * self.column.1[1]);
        let has_beam = |along: usize, from: [usize; 2]| self.bays.has_beam(along, from, self.perimeter_only);
        for j in 0..self.y.len() {
            for i in (1..self.x.len()).filter(|i| has_beam(0, [i - 1, j])) {
                let solid = Aabb {
                    min: [clean(self.x[i - 1] - half_x), clean(self.y[j] - 0.5 * width), clean(top - depth)],
                    max: [clean(self.x[i] + half_x), clean(self.y[j] + 0.5 * width), top],
                };
                let id = format!("B{storey}-{}-{}", axis_point(i - 1, j), axis_point(i, j));
                members.push(member(id, MemberKind::Beam, section, solid, 0, storey));
            }
        }
        // Where a beam along x runs over the column, the beam along y ends at the column's face.
        let crossed = |i: usize, j: usize| has_beam(0, [i, j]) || (i > 0 && has_beam(0, [i - 1, j]));
        let reach = |i: usize, j: usize| if crossed(i, j) { -half_y } else { half_y };
        for i in 0..self.x.len() {
            for j in (1..self.y.len()).filter(|j| has_beam(1, [i, j - 1])) {
                let solid = Aabb {
                    min: [
                        clean(self.x[i] - 0.5 * width),
                        clean(self.y[j - 1] - reach(i, j - 1)),
                        clean(top - depth),
                    ],
                    max: [clean(self.x[i] + 0.5 * width), clean(self.y[j] + reach(i, j)), top],
                };
                let id = format!("B{storey}-{}-{}", axis_point(i, j - 1), axis_point(i, j));
                members.push(member(id, MemberKind::Beam, section, solid, 1, storey));
            }
        }
    }

    /// The slabs: one, or one for each rectangle of bays of a plan that is none.
    fn slabs(&self, storey: usize, members: &mut Vec<Member>) {
        let blocks = self.bays.blocks();
        let id = |[[i0, j0], [i1, j1]]: &BayRange| match blocks.len() {
            1 => format!("S{storey}"),
            _ => format!("S{storey}-{}-{}", axis_point(*i0, *j0), axis_point(*i1, *j1)),
        };
        members.extend(blocks.iter().filter_map(|block| self.slab_of(storey, &self.bays, block, id(block))));
    }

    fn slab_of(&self, storey: usize, bays: &Bays, block: &BayRange, id: String) -> Option<Member> {
        let (section, thickness) = self.slab?;
        let edges = |along: usize, axes: &[f64]| bays.edges(block, along, axes, self.overhang);
        let ([x0, x1], [y0, y1], top) = (edges(0, &self.x), edges(1, &self.y), self.levels[storey]);
        let solid = Aabb { min: [x0, y0, clean(top - thickness)], max: [x1, y1, top] };
        let mut slab = member(id, MemberKind::Slab, section, solid, 2, storey);
        // of an opening each slab has its part
        let own = |r: &[[f64; 2]; 2]| {
            super::openings::through(&slab, *r).intersection(&slab.solid, COORDINATE_TOLERANCE_M)
        };
        slab.openings = self.slab_openings.iter().filter_map(own).collect();
        Some(slab)
    }
}

fn member(id: String, kind: MemberKind, section: &str, solid: Aabb, axis: usize, storey: usize) -> Member {
    let (section, storey) = (section.to_string(), Some(storey as u32));
    Member { id, kind, section, solid, axis, storey, openings: Vec::new(), rotation_deg: 0.0, inclined: None }
}

/// Id of the column of a storey, counted from one, at these axes along x and y, counted from zero.
pub fn column_id(storey: usize, i: usize, j: usize) -> String {
    format!("C{storey}-{}", axis_point(i, j))
}

/// "A1" for the first axes, "AA1" for the 27th x axis.
fn axis_point(i: usize, j: usize) -> String {
    let mut letters = Vec::new();
    let mut rest = i + 1;
    while rest > 0 {
        letters.push(char::from(b'A' + ((rest - 1) % 26) as u8));
        rest = (rest - 1) / 26;
    }
    let letters: String = letters.into_iter().rev().collect();
    format!("{letters}{}", j + 1)
}

/// A coordinate rounded to a nanometre, so that sums of the same lengths give the same plane.
pub fn clean(value: f64) -> f64 {
    let rounded = (value * 1e9).round() / 1e9;
    if rounded == 0.0 { 0.0 } else { rounded }
}

fn check_axes(
    fields: Fields<'_>,
    key: &str,
    axes: Option<&[f64]>,
    column: Option<f64>,
    found: &mut Vec<Diagnostic>,
) {
    let items = fields.node.get(key).map_or(&[][..], |n| n.items());
    for (pair, item) in axes.unwrap_or_default().windows(2).zip(items.iter().skip(1)) {
        let distance = pair[1] - pair[0];
        if distance <= 0.0 {
            let error = Diagnostic::error("not-increasing", format!("the {key} axes do not increase"))
                .at(item.span, format!("not above {}", show(pair[0], Dimension::Length)))
                .help("give coordinates, not distances, in increasing order");
            found.push(error);
        } else if column.is_some_and(|c| distance <= c) {
            let message = format!("the {key} axes are nearer to each other than a column is wide");
            found
                .push(Diagnostic::error("overlap", message).at(item.span, show(distance, Dimension::Length)));
        }
    }
}

/// Warns of the longest span of a direction that no frame has: numbers without a unit are metres.
fn long_spans(fields: Fields<'_>, axes: [(&str, &[f64]); 2], found: &mut Vec<Diagnostic>) {
    for (key, axes) in axes {
        let items = fields.node.get(key).map_or(&[][..], |n| n.items());
        let spans = axes.windows(2).map(|pair| pair[1] - pair[0]).zip(items.iter().skip(1));
        let Some((span_m, item)) = spans.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|s| s.0 > LONGEST_SPAN_M)
        else {
            continue;
        };
        let message = format!("{key} axes are {} apart", show(span_m, Dimension::Length));
        let warning = Diagnostic::warning("long-span", message)
            .at(item.span, format!("usual: up to {LONGEST_SPAN_M} m"))
            .help("plain numbers are metres: write others with their unit, such as \"600 cm\"");
        found.push(warning);
    }
}

/// Whether slabs over axes have a width: one axis has none but for the overhang.
fn have_width(fields: Fields<'_>, axes: [&[f64]; 2], overhang_m: f64, found: &mut Vec<Diagnostic>) -> bool {
    let flat = ["x", "y"].into_iter().zip(axes).find(|(_, axes)| axes.len() == 1 && overhang_m <= 0.0);
    let Some((key, _)) = flat else { return true };
    let error = Diagnostic::error("no-width", format!("the slabs have no width along {key}"))
        .at(fields.span(key), "one axis, and no overhang")
        .help("give `slab_overhang`, half the width of a slab over one axis, or leave out `slab_section`");
    found.push(error);
    false
}

fn check_heights(fields: Fields<'_>, heights: Option<&[f64]>, deepest: f64, found: &mut Vec<Diagnostic>) {
    let items = fields.node.get("storey_heights").map_or(&[][..], |n| n.items());
    for (height, item) in heights.unwrap_or_default().iter().zip(items) {
        if *height <= deepest {
            let error =
                Diagnostic::error("low-storey", "this storey leaves no column below its beams and slab")
                    .at(item.span, show(*height, Dimension::Length))
                    .help(format!("beams and slab are {} deep", show(deepest, Dimension::Length)));
            found.push(error);
        }
    }
}
