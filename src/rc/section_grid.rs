//! Grid files: all combinations of a few lists of numbers, made from one section file.

use super::section_file::{self, RcSection};
use crate::base::diagnostic::{Diagnostic, Diagnostics};
use crate::base::source::Source;
use crate::base::tree::{self, Format};
use crate::base::units::Dimension;
use crate::building::format::{Key, Kind, Quantity, Table};
use crate::building::{Bar, Fields, LEAST_COVER_M, check_against};
use crate::material::concrete::ConcreteLaw;
use crate::material::rebar::Buckling;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// A commented example, as `fallwerk rc --example-grid` prints it.
pub const EXAMPLE: &str = include_str!("example-grid.toml");

const fn quantity(dimension: Dimension, min: f64, max: f64, usual: (f64, f64)) -> Kind {
    Kind::Quantity(Quantity { dimension, min, max, usual })
}

const fn list(name: &'static str, of: &'static Kind, example: &'static str, doc: &'static str) -> Key {
    Key { name, kind: Kind::List(of, 1, 50), required: false, doc, example }
}

const SIDE: Kind = quantity(Dimension::Length, 0.1, 3.0, (0.15, 1.5));
const LENGTH: Kind = quantity(Dimension::Length, 0.1, 20.0, (0.5, 4.0));
const SPACING: Kind = quantity(Dimension::Length, 0.03, 0.6, (0.05, 0.4));
const STRENGTH: Kind = quantity(Dimension::Stress, 5e6, 150e6, (8e6, 120e6));
const RATIO: Kind = quantity(Dimension::Number, 1e-3, 0.1, (0.003, 0.06));

/// The file.
pub const GRID_FILE: Table = Table {
    noun: "a grid file",
    doc: "All combinations of some lists, made from one section file.",
    keys: &[
        Key {
            name: "schema",
            kind: Kind::Version,
            required: true,
            doc: "Version of this format.",
            example: "1",
        },
        Key {
            name: "section",
            kind: Kind::Text(500),
            required: true,
            doc: "The section file, relative to this file.",
            example: "\"column.toml\"",
        },
        list("widths", &SIDE, "[\"300 mm\", \"400 mm\"]", "Widths; the depth in the same ratio."),
        list("depths", &SIDE, "[\"400 mm\"]", "Depths, or thicknesses of a slab; the width stays."),
        list("reinforcement_ratios", &RATIO, "[0.01, 0.02]", "Area of the bars over that of the section."),
        list("tie_spacings", &SPACING, "[\"100 mm\"]", "Spacings of the ties."),
        list("concrete_strengths", &STRENGTH, "[\"30 MPa\"]", "Mean strengths of the concrete."),
        list("lengths", &LENGTH, "[\"1.5 m\"]", "Lengths to the point of zero moment."),
    ],
};

/// The JSON Schema of the file.
pub fn json_schema() -> Value {
    crate::building::schema::schema_of(&GRID_FILE, "Fallwerk grid of sections")
}

/// Lists of a grid; an empty one keeps what the section has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SectionGrid {
    /// Widths \[m\].
    pub widths_m: Vec<f64>,
    /// Depths \[m\].
    pub depths_m: Vec<f64>,
    /// Reinforcement ratios.
    pub ratios: Vec<f64>,
    /// Spacings of ties \[m\].
    pub tie_spacings_m: Vec<f64>,
    /// Strengths of the concrete \[Pa\].
    pub strengths_pa: Vec<f64>,
    /// Lengths \[m\].
    pub lengths_m: Vec<f64>,
}

/// Reads a grid file and the section file that it names: all sections.
///
/// # Errors
/// All errors of the file, or of the section file, or the first section that cannot be made.
pub fn read_file(path: &Path) -> Result<Vec<RcSection>, Vec<Diagnostics>> {
    let source =
        Source::read(path).map_err(|e| vec![Diagnostics::unreadable(&path.display().to_string(), e)])?;
    let all = |source, found| vec![Diagnostics::new(Arc::new(source), found)];
    let root = match tree::parse(&source, Format::Toml) {
        Ok(root) => root,
        Err(found) => return Err(all(source, found)),
    };
    let found = check_against(&root, &GRID_FILE);
    let fields = Fields { node: &root, table: &GRID_FILE };
    let (Some(file), true) = (fields.text("section"), found.is_empty()) else {
        return Err(all(source, found));
    };
    let section =
        section_file::read_file(&path.with_file_name("").join(file)).map_err(|found| vec![found])?;
    let numbers = |name: &str| fields.numbers(name).unwrap_or_default();
    let grid = SectionGrid {
        widths_m: numbers("widths"),
        depths_m: numbers("depths"),
        ratios: numbers("reinforcement_ratios"),
        tie_spacings_m: numbers("tie_spacings"),
        strengths_pa: numbers("concrete_strengths"),
        lengths_m: numbers("lengths"),
    };
    grid.sections(&section).map_err(|what| {
        let error = Diagnostic::error("bad-grid", what).at(fields.span("section"), "made from this section");
        all(source.clone(), vec![error.help("change the list that leads there")])
    })
}

impl SectionGrid {
    /// All combinations, the last list running fastest.
    ///
    /// # Errors
    /// In words, the first combination whose bars or concrete do not fit.
    pub fn sections(&self, base: &RcSection) -> Result<Vec<RcSection>, String> {
        let mut all = vec![base.clone()];
        let spread = |all: Vec<RcSection>,
                      values: &[f64],
                      change: &dyn Fn(&RcSection, f64) -> Result<RcSection, String>|
         -> Result<Vec<RcSection>, String> {
            if values.is_empty() {
                return Ok(all);
            }
            all.iter().flat_map(|s| values.iter().map(|v| change(s, *v))).collect()
        };
        all = spread(all, &self.widths_m, &with_width)?;
        all = spread(all, &self.depths_m, &with_depth)?;
        all = spread(all, &self.ratios, &with_ratio)?;
        all = spread(all, &self.tie_spacings_m, &with_tie_spacing)?;
        all = spread(all, &self.strengths_pa, &with_strength)?;
        spread(all, &self.lengths_m, &|s, length_m| {
            Ok(RcSection { name: format!("{} l {length_m} m", s.name), length_m, ..s.clone() })
        })
    }
}

fn with_width(base: &RcSection, width_m: f64) -> Result<RcSection, String> {
    let mut section = base.clone();
    section.name = format!("{} b {:.0} mm", base.name, 1e3 * width_m);
    let from = base.input.size_m;
    with_sides(section, from.map(|side| side * width_m / from[0]))
}

fn with_depth(base: &RcSection, depth_m: f64) -> Result<RcSection, String> {
    let mut section = base.clone();
    section.name = format!("{} h {:.0} mm", base.name, 1e3 * depth_m);
    with_sides(section, [base.input.size_m[0], depth_m])
}

/// Bars stretched with the sides, so that the outermost of each side keep their distance from its face.
fn with_sides(mut section: RcSection, to: [f64; 2]) -> Result<RcSection, String> {
    let base = section.clone();
    let from = base.input.size_m;
    for (axis, side) in to.iter().enumerate() {
        let reach = reaches(&base.input.bars, axis);
        let factor = |reach: f64| {
            let edge = 0.5 * from[axis] - reach;
            if reach > 0.0 { (0.5 * side - edge) / reach } else { 1.0 }
        };
        let factors = reach.map(factor);
        if factors.iter().any(|f| *f <= 0.0) {
            return Err(format!("{}: its bars do not fit into {:.0} mm", section.name, 1e3 * side));
        }
        for bar in &mut section.input.bars {
            let at = if axis == 0 { &mut bar.x_m } else { &mut bar.y_m };
            *at *= factors[usize::from(*at < 0.0)];
        }
    }
    section.input.size_m = to;
    fitting(section)
}

/// How far bars reach from the middle along an axis, on its positive and its negative side \[m\]. A side whose bars all lie in the middle, with less than half of
/// the other's reach, has none of its own: they go with the others.
fn reaches(bars: &[Bar], axis: usize) -> [f64; 2] {
    let own = [1.0, -1.0].map(|side| bars.iter().map(|b| side * [b.x_m, b.y_m][axis]).fold(0.0, f64::max));
    let most = own[0].max(own[1]);
    own.map(|reach| if reach < 0.5 * most { most } else { reach })
}

/// Diameters changed so that the bars have this ratio; ties stay on the bars, whose centres stay.
fn with_ratio(base: &RcSection, ratio: f64) -> Result<RcSection, String> {
    let mut section = base.clone();
    section.name = format!("{} r {:.2} %", base.name, 100.0 * ratio);
    let factor = (ratio * base.input.area_m2() / base.steel_m2()).sqrt();
    let thick = |s: &RcSection| s.input.bars.iter().map(|b| b.diameter_m).fold(0.0, f64::max);
    section.input.bars.iter_mut().for_each(|b| b.diameter_m *= factor);
    let grown = 0.5 * (thick(&section) - thick(base));
    let (what, cover_m) = match &mut section.input.ties {
        Some(ties) => {
            ties.cover_m -= grown;
            ("ties", ties.cover_m)
        }
        None => {
            ("bars", section.input.bars.iter().map(|b| cover_m(b, base.input.size_m)).fold(1.0, f64::min))
        }
    };
    if cover_m < LEAST_COVER_M - 1e-9 {
        return Err(format!(
            "{}: the cover of the {what} is {:.0} mm, at least {:.0} mm is needed",
            section.name,
            1e3 * cover_m,
            1e3 * LEAST_COVER_M
        ));
    }
    section.input.steel.buckling =
        base.input.steel.buckling.map(|b| Buckling { slenderness: b.slenderness / factor, ..b });
    fitting(section)
}

fn with_tie_spacing(base: &RcSection, spacing_m: f64) -> Result<RcSection, String> {
    let mut section = base.clone();
    section.name = format!("{} s {:.0} mm", base.name, 1e3 * spacing_m);
    let Some(ties) = &mut section.input.ties else {
        return Err(format!("{}: the section has no ties", section.name));
    };
    let factor = spacing_m / ties.spacing_m;
    ties.spacing_m = spacing_m;
    section.input.steel.buckling =
        base.input.steel.buckling.map(|b| Buckling { slenderness: b.slenderness * factor, ..b });
    Ok(section)
}

/// Another strength: what still is as [`ConcreteLaw::of_strength`] makes it follows, what the file states stays.
fn with_strength(base: &RcSection, strength_pa: f64) -> Result<RcSection, String> {
    let (old, new) = (
        ConcreteLaw::of_strength(base.concrete.compressive_strength_pa),
        ConcreteLaw::of_strength(strength_pa),
    );
    let follow = |held: f64, old: f64, new: f64| if held == old { new } else { held };
    let held = &base.concrete;
    let concrete = ConcreteLaw {
        compressive_strength_pa: strength_pa,
        youngs_modulus_pa: follow(held.youngs_modulus_pa, old.youngs_modulus_pa, new.youngs_modulus_pa),
        tensile_strength_pa: follow(
            held.tensile_strength_pa,
            old.tensile_strength_pa,
            new.tensile_strength_pa,
        ),
        fracture_energy_j_m2: follow(
            held.fracture_energy_j_m2,
            old.fracture_energy_j_m2,
            new.fracture_energy_j_m2,
        ),
        crushing_energy_j_m2: follow(
            held.crushing_energy_j_m2,
            old.crushing_energy_j_m2,
            new.crushing_energy_j_m2,
        ),
        peak_strain: follow(held.peak_strain, old.peak_strain, new.peak_strain),
        ..held.clone()
    };
    let mut section = base.clone();
    section.name = format!("{} fc {:.0} MPa", base.name, strength_pa / 1e6);
    concrete.check().map_err(|e| format!("{}: {e}", section.name))?;
    section.input.concrete_strength_pa = concrete.compressive_strength_pa;
    section.input.tensile_strength_pa = concrete.tensile_strength_pa;
    section.input.youngs_modulus_pa = concrete.youngs_modulus_pa;
    section.concrete = concrete;
    Ok(section)
}

/// Concrete outside of a bar in a section of a size \[m\].
fn cover_m(bar: &Bar, size_m: [f64; 2]) -> f64 {
    (0.5 * size_m[0] - bar.x_m.abs()).min(0.5 * size_m[1] - bar.y_m.abs()) - 0.5 * bar.diameter_m
}

/// Whether bars lie in the section and not in each other.
fn fitting(section: RcSection) -> Result<RcSection, String> {
    let bars = &section.input.bars;
    if bars.iter().any(|b| cover_m(b, section.input.size_m) < 1e-9) {
        return Err(format!("{}: a bar is not inside the section", section.name));
    }
    for (i, a) in bars.iter().enumerate() {
        if bars[i + 1..]
            .iter()
            .any(|b| libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < 0.5 * (a.diameter_m + b.diameter_m) - 1e-9)
        {
            return Err(format!("{}: two bars overlap", section.name));
        }
    }
    Ok(section)
}
