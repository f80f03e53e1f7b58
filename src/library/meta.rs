//! What is said of a curve from a test or another program: a TOML file, its table of keys, and its JSON Schema.

use super::entry::{
    Adjoining, ColumnEnd, EntryKind, Features, Loading, Origin, Quality, RcFeatures, Stiffness,
};
use super::parts::Direction;
use crate::base::diagnostic::Diagnostic;
use crate::base::source::{Source, Span};
use crate::base::tree::{self, Format, Node};
use crate::base::units::Dimension;
use crate::building::format::{Key, Kind, Quantity, Table};
use crate::building::{Fields, check_against};
use serde_json::Value;

/// A commented example, as `fallwerk library add --example` prints it.
pub const EXAMPLE: &str = include_str!("example.toml");
/// The curve that belongs to it.
pub const EXAMPLE_CURVE: &str = include_str!("example.csv");

const fn key(
    name: &'static str,
    required: bool,
    kind: Kind,
    example: &'static str,
    doc: &'static str,
) -> Key {
    Key { name, kind, required, doc, example }
}

const fn quantity(dimension: Dimension, min: f64, max: f64, usual: (f64, f64)) -> Kind {
    Kind::Quantity(Quantity { dimension, min, max, usual })
}

const SIZE: Kind = quantity(Dimension::Length, 0.02, 20.0, (0.05, 2.0));
const DIAMETER: Kind = quantity(Dimension::Length, 0.002, 0.06, (0.004, 0.04));
const STEEL: Kind = quantity(Dimension::Stress, 100e6, 2e9, (200e6, 900e6));
const FORCE: Kind = quantity(Dimension::Force, -1e9, 1e9, (-5e7, 5e7));
const POSITIVE: Kind = quantity(Dimension::Number, 1e-300, 1e15, (1.0, 1e12));
const SHARE: Kind = quantity(Dimension::Number, 0.0, 10.0, (0.0, 1.0));
const CAPACITY: Kind = quantity(Dimension::Force, 1.0, 1e9, (1e3, 5e7));

const KINDS: Kind = Kind::Choice(
    &[
        "column_hinge",
        "beam_hinge",
        "wall_hinge",
        "slab_yield_line",
        "axial_spring",
        "shear_spring",
        "contact_crushing",
    ],
    &[],
);

/// The file.
pub const META: Table = Table {
    noun: "the description of a curve",
    doc: "What a library entry says of a curve from a test or another program.",
    keys: &[
        key("schema", true, Kind::Version, "1", "Version of this format."),
        key("kind", true, KINDS, "\"column_hinge\"", "Kind of the entry."),
        key(
            "origin",
            true,
            Kind::Choice(&["test", "program"], &[]),
            "\"test\"",
            "How the curve was obtained.",
        ),
        key("features", true, Kind::Table(&FEATURES), "", "By what the entry is found."),
        key("source", true, Kind::Table(&SOURCE), "", "Where the curve comes from."),
        key("loading", true, Kind::Table(&LOADING), "", "How the member was loaded."),
        key(
            "hinge",
            false,
            Kind::Table(&HINGE),
            "",
            "What a joint of the multibody model needs beside the curve.",
        ),
        key("quality", false, Kind::Table(&QUALITY), "", "How good a computed curve is."),
    ],
};

const FEATURES: Table = Table {
    noun: "the features",
    doc: "By what the entry is found. What is not known is left out.",
    keys: &[
        key("width", true, SIZE, "\"350 mm\"", "Width of the section; of a yield line: of the strip."),
        key(
            "depth",
            true,
            SIZE,
            "\"350 mm\"",
            "Depth of the section in the plane of bending; thickness of a slab.",
        ),
        key("length_to_inflection", false, SIZE, "\"1 m\"", "From the end to the point of zero moment."),
        key(
            "end",
            false,
            Kind::Choice(&["top", "bottom", "lower", "upper"], &[]),
            "\"bottom\"",
            "Which end.",
        ),
        key(
            "adjoining",
            false,
            Kind::Choice(&["slab", "beam", "column", "wall", "ground"], &[]),
            "\"ground\"",
            "What the end is joined to; a footing or a rigid block is `ground`.",
        ),
        key(
            "concrete_strength",
            false,
            quantity(Dimension::Stress, 2e6, 200e6, (8e6, 120e6)),
            "\"34.8 MPa\"",
            "Cylinder strength of the concrete.",
        ),
        key(
            "reinforcement_ratio",
            false,
            quantity(Dimension::Number, 1e-4, 0.15, (0.002, 0.08)),
            "0.0327",
            "Area of the longitudinal bars over that of the section.",
        ),
        key("bar_yield_strength", false, STEEL, "\"430 MPa\"", "Yield strength of the longitudinal bars."),
        key(
            "tie_spacing",
            false,
            quantity(Dimension::Length, 0.01, 1.0, (0.03, 0.5)),
            "\"75 mm\"",
            "Spacing of the ties along the member.",
        ),
        key("tie_diameter", false, DIAMETER, "\"10 mm\"", "Diameter of the ties."),
        key("tie_yield_strength", false, STEEL, "\"470 MPa\"", "Yield strength of the ties."),
    ],
};

const SOURCE: Table = Table {
    noun: "the source",
    doc: "Where the curve comes from.",
    keys: &[
        key(
            "citation",
            true,
            Kind::Text(600),
            "\"Author, title, year, specimen\"",
            "Publication, report or data set, with the specimen.",
        ),
        key("by", true, Kind::Text(200), "\"laboratory or person\"", "Who measured or computed it."),
        key(
            "program",
            false,
            Kind::Text(100),
            "\"OpenSees 3.7\"",
            "Name and version of the program; needed with `origin = \"program\"`.",
        ),
    ],
};

const LOADING: Table = Table {
    noun: "the loading",
    doc: "How the member was loaded.",
    keys: &[
        key(
            "kind",
            true,
            Kind::Choice(&["monotonic", "cyclic_envelope"], &[]),
            "\"monotonic\"",
            "Once in one sense, or the envelope of cycles.",
        ),
        key(
            "second_order",
            true,
            Kind::Choice(&["not_included", "included"], &[]),
            "\"not_included\"",
            "Whether the moment contains that of the axial force on the displaced member (P-delta).",
        ),
        key(
            "axial_force",
            false,
            FORCE,
            "\"600 kN\"",
            "Constant axial force, compression positive, if the curve has no column for it.",
        ),
        key(
            "direction",
            false,
            Kind::Choice(&["axial", "shear_1", "shear_2", "normal"], &[]),
            "\"axial\"",
            "Direction of a spring.",
        ),
    ],
};

const HINGE: Table = Table {
    noun: "the hinge",
    doc: "What a joint needs beside the curve.",
    keys: &[
        key("axial_stiffness_n_m", true, POSITIVE, "3.1e9", "Axial stiffness [N/m]."),
        key(
            "shear_stiffness_n_m",
            true,
            Kind::Tuple(&[POSITIVE, POSITIVE]),
            "[1.1e8, 1.1e8]",
            "Shear stiffness along axes 1 and 2 [N/m].",
        ),
        key("torsional_stiffness_nm_rad", true, POSITIVE, "4.4e7", "Torsional stiffness [N m/rad]."),
        key(
            "offset",
            true,
            quantity(Dimension::Length, 0.0, 5.0, (0.0, 1.0)),
            "\"0.2 m\"",
            "Distance of the hinge from the end, into the member.",
        ),
        key("tensile_capacity", false, CAPACITY, "\"1200 kN\"", "Tension at which it flows."),
        key(
            "tensile_elongation",
            false,
            quantity(Dimension::Length, 0.0, 2.0, (0.0, 0.5)),
            "\"80 mm\"",
            "Plastic elongation at which it then separates.",
        ),
        key("compressive_capacity", false, CAPACITY, "\"4200 kN\"", "Compression at which it crushes."),
    ],
};

const QUALITY: Table = Table {
    noun: "the quality",
    doc: "How good a computed curve is.",
    keys: &[
        key("kinetic_energy_ratio", false, SHARE, "0.01", "Largest ratio of kinetic to internal energy."),
        key(
            "mesh_sensitivity",
            false,
            SHARE,
            "0.05",
            "Relative change of the peak from a mesh of half the element size.",
        ),
    ],
};

/// The JSON Schema of the file.
pub fn json_schema() -> Value {
    crate::building::schema::schema_of(&META, "Fallwerk library: description of a curve")
}

/// What the file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Meta {
    /// Kind of the entry.
    pub kind: EntryKind,
    /// [`Origin::Test`] or [`Origin::Program`].
    pub origin: Origin,
    /// By what it is found.
    pub features: Features,
    /// Publication or data set.
    pub citation: String,
    /// Who measured or computed it.
    pub by: String,
    /// The program.
    pub program: Option<String>,
    /// How it was loaded.
    pub loading: Loading,
    /// Whether the moment contains P-Δ.
    pub second_order_included: bool,
    /// Axial force for a curve without a column of it \[N\].
    pub axial_force_n: Option<f64>,
    /// Place of that, or of `[loading]`.
    pub axial_force_span: Span,
    /// Direction of a spring.
    pub direction: Option<Direction>,
    /// What a joint needs.
    pub hinge: Option<HingeMeta>,
    /// Quality of a computed curve.
    pub quality: Quality,
}

/// `[hinge]`.
#[derive(Debug, Clone, PartialEq)]
pub struct HingeMeta {
    /// Elastic stiffnesses.
    pub stiffness: Stiffness,
    /// Distance of the hinge from the end \[m\].
    pub offset_m: f64,
    /// Tension at which it flows \[N\].
    pub tensile_capacity_n: Option<f64>,
    /// Plastic elongation at which it separates \[m\].
    pub tensile_elongation_m: Option<f64>,
    /// Compression at which it crushes \[N\].
    pub compressive_capacity_n: Option<f64>,
}

/// Reads the file.
///
/// # Errors
/// All errors at once, each with its place.
pub fn read(source: &Source) -> Result<Meta, Vec<Diagnostic>> {
    let root = tree::parse(source, Format::Toml)?;
    let mut errors = check_against(&root, &META);
    let meta = of(&root, &mut errors);
    match meta {
        Some(meta) if errors.is_empty() => Ok(meta),
        _ => Err(errors),
    }
}

fn of(root: &Node, errors: &mut Vec<Diagnostic>) -> Option<Meta> {
    let top = Fields { node: root, table: &META };
    let section = |name: &str, table| top.child(name).map(|node| Fields { node, table });
    let source = section("source", &SOURCE);
    if let Some(source) = source {
        named(source, errors);
    }
    let loading = section("loading", &LOADING);
    let kind = top.text("kind").and_then(EntryKind::of_name);
    let origin = top.text("origin").and_then(Origin::of_name);
    let program = source.and_then(|s| s.text("program"));
    if origin == Some(Origin::Program)
        && let (Some(s), None) = (source, program)
    {
        errors.push(
            Diagnostic::error("missing-key", "the source needs the key `program`")
                .at(s.node.span, "`program` is missing")
                .help("a curve of a program names it: add `program = \"NAME VERSION\"`, or write `origin = \"test\"`"),
        );
    }
    let direction = direction(kind?, loading, errors);
    let features = features(kind?, section("features", &FEATURES)?, errors)?;
    let loading = loading?;
    Some(Meta {
        kind: kind?,
        origin: origin?,
        features,
        citation: source?.text("citation")?.trim().to_string(),
        by: source?.text("by")?.trim().to_string(),
        program: program.map(str::to_string),
        loading: if loading.text("kind")? == "monotonic" {
            Loading::Monotonic
        } else {
            Loading::CyclicEnvelope
        },
        second_order_included: loading.text("second_order")? == "included",
        axial_force_n: loading.number("axial_force"),
        axial_force_span: loading.span("axial_force"),
        direction,
        hinge: section("hinge", &HINGE).and_then(hinge),
        quality: quality(section("quality", &QUALITY)),
    })
}

/// A source has a name, and whoever it is of.
fn named(source: Fields, errors: &mut Vec<Diagnostic>) {
    for name in ["citation", "by"] {
        if source.text(name).is_some_and(|text| text.trim().is_empty()) {
            errors.push(
                Diagnostic::error("empty", format!("`{name}` is empty"))
                    .at(source.span(name), "")
                    .help("say where the curve comes from, and who measured or computed it"),
            );
        }
    }
}

/// The direction of a spring: as stated, else by its kind.
fn direction(kind: EntryKind, loading: Option<Fields>, errors: &mut Vec<Diagnostic>) -> Option<Direction> {
    let stated = loading.and_then(|l| l.text("direction"));
    if let (true, Some(loading), Some(_)) = (kind.is_bending(), loading, stated) {
        errors.push(
            Diagnostic::error("not-used", format!("a `{}` has no `direction`", kind.name()))
                .at(loading.span("direction"), "of springs only")
                .help("take the key out; axes of bending are told apart by a column `axis` of the curve"),
        );
    }
    match (stated, kind) {
        (_, kind) if kind.is_bending() => None,
        (Some("shear_1"), _) | (None, EntryKind::ShearSpring) => Some(Direction::Shear1),
        (Some("shear_2"), _) => Some(Direction::Shear2),
        (Some("normal"), _) | (None, EntryKind::ContactCrushing) => Some(Direction::Normal),
        _ => Some(Direction::Axial),
    }
}

fn features(kind: EntryKind, f: Fields, errors: &mut Vec<Diagnostic>) -> Option<Features> {
    let end = f.text("end").and_then(ColumnEnd::of_name);
    if let (Some(end), Some(ends)) = (end, kind.ends())
        && !ends.contains(&end)
    {
        let [one, other] = ends.map(ColumnEnd::name);
        errors.push(
            Diagnostic::error("wrong-end", format!("a `{}` has no `{}` end", kind.name(), end.name()))
                .at(f.span("end"), "")
                .help(format!("write `{one}` or `{other}`, or leave the key out")),
        );
    }
    let rc = RcFeatures {
        concrete_strength_pa: f.number("concrete_strength"),
        reinforcement_ratio: f.number("reinforcement_ratio"),
        bar_yield_strength_pa: f.number("bar_yield_strength"),
        tie_spacing_m: f.number("tie_spacing"),
        tie_diameter_m: f.number("tie_diameter"),
        tie_yield_strength_pa: f.number("tie_yield_strength"),
    };
    Some(Features {
        width_m: f.number("width")?,
        depth_m: f.number("depth")?,
        length_to_inflection_m: f.number("length_to_inflection"),
        end,
        adjoining: f.text("adjoining").and_then(Adjoining::of_name),
        law: None,
        mesh_size_m: None,
        rc: (rc != RcFeatures::default()).then_some(rc),
        further: Default::default(),
    })
}

fn hinge(h: Fields) -> Option<HingeMeta> {
    Some(HingeMeta {
        stiffness: Stiffness {
            axial_n_m: h.number("axial_stiffness_n_m")?,
            shear_n_m: h.numbers("shear_stiffness_n_m")?.try_into().ok()?,
            torsion_nm_rad: h.number("torsional_stiffness_nm_rad")?,
        },
        offset_m: h.number("offset")?,
        tensile_capacity_n: h.number("tensile_capacity"),
        tensile_elongation_m: h.number("tensile_elongation"),
        compressive_capacity_n: h.number("compressive_capacity"),
    })
}

fn quality(q: Option<Fields>) -> Quality {
    let number = |name: &str| q.and_then(|q| q.number(name));
    Quality {
        kinetic_energy_ratio: number("kinetic_energy_ratio"),
        mesh_sensitivity: number("mesh_sensitivity"),
        ..Quality::default()
    }
}
