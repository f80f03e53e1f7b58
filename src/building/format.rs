//! The building file as a table of keys: the one place that says what a file may contain.
//!
//! The reader's structure check ([`super::structure`]) and the JSON Schema ([`super::schema`]) both
//! walk these tables, so that they cannot say different things.

use super::grid::MAX_MEMBERS;
use super::overrides::{ACTIONS, ACTIONS_OF_RULES};
use crate::base::units::Dimension;

/// Version of the file format.
pub const SCHEMA_VERSION: f64 = 1.0;

/// A number with its dimension and the range in which it makes sense for a building.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Dimension; plain numbers are SI.
    pub dimension: Dimension,
    /// Smallest value accepted, SI.
    pub min: f64,
    /// Largest value accepted, SI.
    pub max: f64,
    /// Usual values, SI: a unit slip is suggested only if it leads here.
    pub usual: (f64, f64),
}

/// What a key holds.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// Text of at most so many characters.
    Text(usize),
    /// A new id: letters, digits, `-`, `_` and `.`.
    Id,
    /// The id of something defined elsewhere in the file.
    Reference(&'static str),
    /// Ids of members; `*` stands for any characters.
    MemberPattern,
    /// The version of the format.
    Version,
    /// A number.
    Quantity(Quantity),
    /// A whole number in a range.
    Count(u32, u32),
    /// One of some words; the second list is understood but not supported yet.
    Choice(&'static [&'static str], &'static [&'static str]),
    /// A list with its least and largest length.
    List(&'static Kind, usize, usize),
    /// A list of fixed length.
    Tuple(&'static [Kind]),
    /// A table of known keys.
    Table(&'static Table),
    /// A table that names its kind by the key `kind`; the last list is understood but not supported yet.
    Variants(&'static [(&'static str, &'static Table)], &'static [&'static str]),
    /// A table of ids chosen by the user.
    Map(&'static Kind),
}

/// A key of a table.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    /// Its name.
    pub name: &'static str,
    /// What it holds.
    pub kind: Kind,
    /// Whether it must be there.
    pub required: bool,
    /// What it means.
    pub doc: &'static str,
    /// A value as one writes it in TOML.
    pub example: &'static str,
}

/// A table of known keys.
#[derive(Debug, Clone, Copy)]
pub struct Table {
    /// What it is, for messages: "a concrete".
    pub noun: &'static str,
    /// What it describes.
    pub doc: &'static str,
    /// Its keys.
    pub keys: &'static [Key],
}

impl Table {
    /// The key with this name.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }
}

const fn must(name: &'static str, kind: Kind, example: &'static str, doc: &'static str) -> Key {
    Key { name, kind, required: true, doc, example }
}

const fn may(name: &'static str, kind: Kind, example: &'static str, doc: &'static str) -> Key {
    Key { name, kind, required: false, doc, example }
}

const fn quantity(dimension: Dimension, min: f64, max: f64, usual: (f64, f64)) -> Kind {
    Kind::Quantity(Quantity { dimension, min, max, usual })
}

const fn length(min: f64, max: f64, usual: (f64, f64)) -> Kind {
    quantity(Dimension::Length, min, max, usual)
}

const COORDINATE: Kind = length(-1000.0, 1000.0, (-100.0, 100.0));
const POINT: Kind = Kind::Tuple(&[COORDINATE, COORDINATE, COORDINATE]);
const BAR_DIAMETER: Kind = length(0.004, 0.06, (0.006, 0.04));
const EDGE_DISTANCE: Kind = length(0.005, 0.3, (0.02, 0.1));
const BAR_SPACING: Kind = length(0.03, 0.6, (0.05, 0.4));
const DENSITY: Kind = quantity(Dimension::Density, 500.0, 8500.0, (1500.0, 2700.0));
const CONCRETE_MODULUS: Kind = quantity(Dimension::Stress, 1e9, 60e9, (10e9, 45e9));
const POISSON: Kind = quantity(Dimension::Number, 0.0, 0.45, (0.1, 0.3));
const FRICTION: Kind = quantity(Dimension::Number, 0.0, 2.0, (0.2, 0.8));
const STRAIN: Kind = quantity(Dimension::Number, 0.0, 2.0, (0.0, 0.3));
// no concrete yields below 0.1 MPa: what does is written in MPa without its unit
const STRESS: Kind = quantity(Dimension::Stress, 1e5, 1e9, (1e6, 100e6));

const FROM: Key = must("from", POINT, "[0, 0, 0]", "First point [m], in global x, y, z.");
const TO: Key = must("to", POINT, "[0, 0, \"3.5 m\"]", "Second point [m].");

/// Concrete.
pub const CONCRETE: Table = Table {
    noun: "a concrete",
    doc: "Concrete of a strength class (EN 1992-1-1, table 3.1).",
    keys: &[
        must("density", DENSITY, "\"2500 kg/m3\"", "Density including reinforcement."),
        must(
            "strength",
            quantity(Dimension::Stress, 2e6, 150e6, (8e6, 100e6)),
            "\"30 MPa\"",
            "Characteristic cylinder strength f_ck.",
        ),
        must("youngs_modulus", CONCRETE_MODULUS, "\"33 GPa\"", "Secant modulus E_cm, uncracked."),
        must("poisson_ratio", POISSON, "0.2", "Poisson's ratio."),
    ],
};

/// Steel.
pub const STEEL: Table = Table {
    noun: "a steel",
    doc: "Reinforcing steel (EN 1992-1-1, annex C).",
    keys: &[
        must(
            "yield_strength",
            quantity(Dimension::Stress, 100e6, 2e9, (200e6, 700e6)),
            "\"500 MPa\"",
            "Yield strength f_yk.",
        ),
        must(
            "ultimate_strength",
            quantity(Dimension::Stress, 100e6, 2.5e9, (250e6, 900e6)),
            "\"540 MPa\"",
            "Ultimate strength f_tk.",
        ),
        must(
            "ultimate_strain",
            quantity(Dimension::Number, 0.005, 0.4, (0.02, 0.2)),
            "0.05",
            "Strain at maximum force ε_uk.",
        ),
        must(
            "youngs_modulus",
            quantity(Dimension::Stress, 100e9, 300e9, (180e9, 220e9)),
            "\"200 GPa\"",
            "Young's modulus.",
        ),
    ],
};

/// Rate factor.
pub const RATE_FACTOR: Table = Table {
    noun: "a rate factor",
    doc: "Factor 1 + (rate / c)^(1 / p) on the yield stress, with the equivalent plastic strain rate (Cowper and Symonds 1957).",
    keys: &[
        must(
            "c",
            quantity(Dimension::Rate, 1e-2, 1e8, (1.0, 1e5)),
            "\"40 1/s\"",
            "Rate at which the yield stress is doubled.",
        ),
        must("p", quantity(Dimension::Number, 1.0, 20.0, (2.0, 10.0)), "5", "Exponent."),
    ],
};

/// Homogenised reinforced concrete.
pub const HOMOGENISED: Table = Table {
    noun: "a homogenised material",
    doc: "Reinforced concrete smeared into one law, as the global FE model uses it: J2 plasticity with \
          piecewise linear hardening; an element erodes at a critical plastic strain.",
    keys: &[
        must("density", DENSITY, "\"2500 kg/m3\"", "Density."),
        must("youngs_modulus", CONCRETE_MODULUS, "\"16.5 GPa\"", "Young's modulus of the cracked state."),
        must("poisson_ratio", POISSON, "0.2", "Poisson's ratio."),
        must(
            "hardening",
            Kind::List(&Kind::Tuple(&[STRAIN, STRESS]), 1, 100),
            "[[0, \"15 MPa\"], [0.1, \"17.5 MPa\"]]",
            "Pairs of equivalent plastic strain and yield stress; the first strain is 0, strains increase; \
             constant beyond the last.",
        ),
        must(
            "critical_plastic_strain",
            quantity(Dimension::Number, 1e-4, 2.0, (0.01, 0.5)),
            "0.1",
            "Equivalent plastic strain at which an element erodes.",
        ),
        may(
            "critical_principal_strain",
            quantity(Dimension::Number, 1e-4, 2.0, (0.001, 0.5)),
            "0.1",
            "Largest principal strain (tension) at which an element erodes, if that comes first; default: not by this.",
        ),
        may(
            "rate_factor",
            Kind::Table(&RATE_FACTOR),
            "{ c = \"40 1/s\", p = 5 }",
            "Rate factor on the yield stress; default: none.",
        ),
    ],
};

/// Ties or stirrups.
pub const TIES: Table = Table {
    noun: "ties",
    doc: "Ties of a column or stirrups of a beam.",
    keys: &[
        must("diameter", BAR_DIAMETER, "\"8 mm\"", "Diameter."),
        must("spacing", BAR_SPACING, "\"150 mm\"", "Spacing along the member."),
    ],
};

/// One bar.
pub const BAR: Table = Table {
    noun: "a bar",
    doc: "One longitudinal bar; the origin is the section's centre.",
    keys: &[
        must("x", length(-5.0, 5.0, (-1.0, 1.0)), "\"-150 mm\"", "Position along the width."),
        must("y", length(-5.0, 5.0, (-1.0, 1.0)), "\"150 mm\"", "Position along the depth."),
        must("diameter", BAR_DIAMETER, "\"20 mm\"", "Diameter."),
    ],
};

/// A row of bars.
pub const BAR_LAYER: Table = Table {
    noun: "a layer of bars",
    doc: "Bars in one row along the width, evenly spaced.",
    keys: &[
        must(
            "face",
            Kind::Choice(&["bottom", "top"], &["left", "right"]),
            "\"bottom\"",
            "Face of the section.",
        ),
        must("count", Kind::Count(1, 40), "3", "Number of bars."),
        must("diameter", BAR_DIAMETER, "\"20 mm\"", "Diameter."),
        must("edge_distance", EDGE_DISTANCE, "\"50 mm\"", "From the face to the bar centres."),
        may(
            "side_distance",
            EDGE_DISTANCE,
            "\"50 mm\"",
            "From the sides to the outer bars; default: edge_distance.",
        ),
    ],
};

/// Bars along all four faces.
pub const BARS_AROUND: Table = Table {
    noun: "bars along the faces",
    doc: "The same number of bars along each of the four faces, corner bars counted on both of their faces: \
          per_face = 3 makes 8 bars.",
    keys: &[
        must("per_face", Kind::Count(2, 20), "3", "Bars along one face, corners included."),
        must("diameter", BAR_DIAMETER, "\"20 mm\"", "Diameter."),
        must("edge_distance", EDGE_DISTANCE, "\"50 mm\"", "From the face to the bar centres."),
    ],
};

/// Mesh of a plate.
pub const MESH: Table = Table {
    noun: "a reinforcement mesh",
    doc: "Orthogonal mesh, the same both ways and at both faces of a plate.",
    keys: &[
        must("diameter", BAR_DIAMETER, "\"10 mm\"", "Diameter."),
        must("spacing", BAR_SPACING, "\"150 mm\"", "Spacing of the bars."),
        must("edge_distance", EDGE_DISTANCE, "\"30 mm\"", "From the face to the bar centres."),
    ],
};

const CONCRETE_ID: Key = must("concrete", Kind::Reference("material"), "\"C30\"", "Id of the concrete.");
const STEEL_ID: Key =
    must("steel", Kind::Reference("material"), "\"B500\"", "Id of the steel of bars and ties.");
const LAW_ID: Key = must("law", Kind::Reference("material"), "\"RC\"", "Id of the homogenised material.");
const SIDE: Kind = length(0.1, 3.0, (0.15, 1.5));

/// Rectangle.
pub const RECTANGLE: Table = Table {
    noun: "a rectangle section",
    doc: "Reinforced rectangle of columns, beams and braces. Give the bars by `bars_around`, `bar_layers` or one by \
          one by `bars`; what is given adds up.",
    keys: &[
        CONCRETE_ID,
        STEEL_ID,
        LAW_ID,
        must("width", SIDE, "\"400 mm\"", "Width: along x for a column, horizontal for a beam or brace."),
        must(
            "depth",
            SIDE,
            "\"400 mm\"",
            "Depth: along y for a column; for a beam vertical, to the slab's top.",
        ),
        may(
            "bars",
            Kind::List(&Kind::Table(&BAR), 1, 200),
            "[{ x = 0, y = 0, diameter = \"20 mm\" }]",
            "Single bars.",
        ),
        may(
            "bar_layers",
            Kind::List(&Kind::Table(&BAR_LAYER), 1, 20),
            "[{ face = \"bottom\", count = 3, … }]",
            "Rows of bars.",
        ),
        may("bars_around", Kind::Table(&BARS_AROUND), "{ per_face = 3, … }", "Bars along all four faces."),
        may("ties", Kind::Table(&TIES), "{ diameter = \"8 mm\", spacing = \"150 mm\" }", "Ties or stirrups."),
    ],
};

/// Plate.
pub const PLATE: Table = Table {
    noun: "a plate section",
    doc: "Reinforced plate of slabs, walls and footings.",
    keys: &[
        CONCRETE_ID,
        STEEL_ID,
        LAW_ID,
        must("thickness", length(0.05, 3.0, (0.1, 1.0)), "\"250 mm\"", "Thickness."),
        must(
            "mesh",
            Kind::Table(&MESH),
            "{ diameter = \"10 mm\", spacing = \"150 mm\", edge_distance = \"30 mm\" }",
            "Reinforcement.",
        ),
    ],
};

/// Opening.
pub const OPENING: Table = Table {
    noun: "an opening",
    doc: "A rectangle cut out of a plate, between two opposite corners in global coordinates of the plate's plane: x and y in \
          a slab, x and z in a wall along x, y and z in a wall along y.",
    keys: &[
        must("from", Kind::Tuple(&[COORDINATE, COORDINATE]), "[2, 0]", "First corner [m]."),
        must("to", Kind::Tuple(&[COORDINATE, COORDINATE]), "[3, \"2.1 m\"]", "Second corner [m]."),
    ],
};

const OPENINGS: Kind = Kind::List(&Kind::Table(&OPENING), 1, 100);

/// Grid.
pub const GRID: Table = Table {
    noun: "[grid]",
    doc: "A regular frame. It makes columns C<storey>-<x letter><y number>, beams B<storey>-<from>-<to> and \
          slabs S<storey>: C1-A1 stands in storey 1 at the first x axis and the first y axis.",
    keys: &[
        must(
            "x",
            Kind::List(&COORDINATE, 1, 60),
            "[0, \"6 m\"]",
            "Column axes along x, increasing; lettered A, B, ...",
        ),
        must(
            "y",
            Kind::List(&COORDINATE, 1, 60),
            "[0, \"5 m\"]",
            "Column axes along y, increasing; numbered 1, 2, ...",
        ),
        must(
            "storey_heights",
            Kind::List(&length(1.5, 20.0, (2.2, 6.0)), 1, 100),
            "[\"3.5 m\", \"3.5 m\"]",
            "Storey heights from below, slab top to slab top.",
        ),
        may("base", COORDINATE, "0", "Height of the lowest column feet; default: the ground level."),
        must("column_section", Kind::Reference("section"), "\"column\"", "Section of all columns."),
        may(
            "beams",
            Kind::Choice(&["perimeter", "all", "none"], &[]),
            "\"perimeter\"",
            "Axes that carry beams; default: perimeter.",
        ),
        may("beam_section", Kind::Reference("section"), "\"beam\"", "Section of all beams."),
        may(
            "slab_section",
            Kind::Reference("section"),
            "\"slab\"",
            "Section of all slabs; without it there are no slabs.",
        ),
        may(
            "slab_overhang",
            length(0.0, 5.0, (0.0, 2.0)),
            "\"200 mm\"",
            "Slab beyond the outer axes; default 0.",
        ),
        may(
            "slab_openings",
            OPENINGS,
            "[{ from = [2, 2], to = [4, 3] }]",
            "Openings of all slabs, such as a stairwell.",
        ),
        may("without_bays", OPENINGS, "[{ from = [6, 5], to = [12, 10] }]", "Bays left out, between axes."),
    ],
};

/// Member.
pub const MEMBER: Table = Table {
    noun: "a member",
    doc: "A single member. `from` and `to` are: column: bottom and top of its axis; beam: both ends of its axis \
          at the height of its top; slab, footing: two opposite corners of the top face; wall: two opposite \
          corners of its middle plane; brace: both ends of its axis, in any direction.",
    keys: &[
        must("id", Kind::Id, "\"C9\"", "Unique id."),
        must(
            "kind",
            Kind::Choice(
                &["column", "beam", "slab", "wall", "footing", "brace"],
                &["truss", "shell", "stair", "pile"],
            ),
            "\"column\"",
            "Kind.",
        ),
        must("section", Kind::Reference("section"), "\"column\"", "Section id."),
        FROM,
        TO,
        may(
            "openings",
            OPENINGS,
            "[{ from = [2, 0], to = [3, \"2.1 m\"] }]",
            "Openings of a slab, wall or footing: doors, stairwells.",
        ),
        may(
            "rotation_deg",
            quantity(Dimension::Number, -360.0, 360.0, (-180.0, 180.0)),
            "30",
            "Angle in degrees by which a column, beam or wall is turned about the vertical axis through its centre, \
             anticlockwise seen from above; default: 0. Such a member butts against its neighbours and runs in FE only.",
        ),
        may(
            "roll_deg",
            quantity(Dimension::Number, -360.0, 360.0, (-180.0, 180.0)),
            "45",
            "Angle in degrees by which the section of a brace is rolled about its axis, anticlockwise looking from `to` to `from`; \
             default 0: its width is horizontal (along x if the brace is vertical).",
        ),
    ],
};

/// Support.
pub const SUPPORT: Table = Table {
    noun: "a support",
    doc: "Holds a face of members.",
    keys: &[
        must(
            "members",
            Kind::List(&Kind::MemberPattern, 1, 1000),
            "[\"C1-*\"]",
            "Member ids; `*` stands for any characters.",
        ),
        may(
            "face",
            Kind::Choice(&["bottom", "top"], &["left", "right"]),
            "\"bottom\"",
            "Face that is held; default: bottom.",
        ),
        may(
            "kind",
            Kind::Choice(&["clamped"], &["pinned", "roller", "spring", "hinged"]),
            "\"clamped\"",
            "How it is held; default: clamped.",
        ),
    ],
};

/// Ground.
pub const GROUND: Table = Table {
    noun: "[ground]",
    doc: "Rigid horizontal ground.",
    keys: &[
        must("level", COORDINATE, "0", "Height of the surface; a grid without `base` stands on it."),
        must("friction", FRICTION, "0.5", "Coulomb friction coefficient."),
    ],
};

/// Obstacle.
pub const OBSTACLE: Table = Table {
    noun: "an obstacle",
    doc: "A rigid, immovable box.",
    keys: &[
        must("id", Kind::Id, "\"wall\"", "Unique id."),
        FROM,
        TO,
        must("friction", FRICTION, "0.5", "Coulomb friction coefficient."),
    ],
};

const PREPARED: Key = must(
    "members",
    Kind::List(&Kind::MemberPattern, 1, 1000),
    "[\"C1-A2\"]",
    "Member ids; `*` stands for any characters.",
);

/// Weakening.
pub const WEAKEN: Table = Table {
    noun: "a weakening",
    doc: "The strength of members is multiplied by a factor.",
    keys: &[
        PREPARED,
        must(
            "strength_factor",
            quantity(Dimension::Number, 0.01, 0.999, (0.1, 0.9)),
            "0.6",
            "Remaining share of the strength.",
        ),
    ],
};

/// Cutting.
pub const CUT: Table =
    Table { noun: "a cut", doc: "Members are cut away before the dead-load state.", keys: &[PREPARED] };

/// Event.
pub const EVENT: Table = Table {
    noun: "an event",
    doc: "A charge: it removes a member, or a stretch of it, at a time.",
    keys: &[
        must("id", Kind::Id, "\"front-left\"", "Unique id."),
        must("member", Kind::Reference("member"), "\"C1-A1\"", "Member id."),
        must("time", quantity(Dimension::Time, 0.0, 600.0, (0.0, 10.0)), "\"0 ms\"", "Ignition time."),
        may(
            "stretch",
            Kind::Tuple(&[length(0.0, 100.0, (0.0, 10.0)), length(0.0, 100.0, (0.0, 10.0))]),
            "[\"0.5 m\", \"1.5 m\"]",
            "Removed stretch along the axis of a column or beam, from its lower end; default: all of it.",
        ),
    ],
};

/// Override.
pub const OVERRIDE: Table = Table {
    noun: "an override",
    doc: "A decision of the analyst in place of the rules, in the generated multibody model; FE runs know nothing of it.",
    keys: &[
        must(
            "targets",
            Kind::List(&Kind::MemberPattern, 1, 1000),
            "[\"C1-A2.top\"]",
            "Ends of columns and walls (`.bottom`, `.top`) and beams (`.start`, `.end`), strips of slabs (`S1:C1-A1|C1-B1`), walls, beams, \
             or floors, each named by any of its slabs or beams; `*` stands for any characters.",
        ),
        must(
            "action",
            Kind::Choice(&ACTIONS, ACTIONS_OF_RULES),
            "\"elastic_connection\"",
            "Column end: hinge, elastic_connection, rigid_connection. Beam end: latent_hinge (the floor may fold there), \
             rigid_connection. Strip, wall end: latent_hinge (it yields), elastic_connection. Floor: merge_rigid, merge_elastic (it bends). Beam: break_away (from its slab, after a contact or \
             fracture). Wall: rigid_body, merge_rigid (one body with its floors).",
        ),
        must(
            "reason",
            Kind::Text(1000),
            "\"tested joint, see report 12\"",
            "Why; shown wherever the decision is.",
        ),
    ],
};

/// Settings.
pub const SETTINGS: Table = Table {
    noun: "[settings]",
    doc: "How the collapse is simulated.",
    keys: &[
        may(
            "end_time",
            quantity(Dimension::Time, 0.001, 600.0, (0.5, 20.0)),
            "\"2.5 s\"",
            "Time at which the run ends, counted from its start in equilibrium at 0 s as the times of events are; default 2.5 s.",
        ),
        may(
            "output_interval",
            quantity(Dimension::Time, 1e-5, 10.0, (0.001, 0.1)),
            "\"10 ms\"",
            "Interval of histories and frames; default 10 ms.",
        ),
        may(
            "removal_duration",
            quantity(Dimension::Time, 0.0, 10.0, (0.0, 0.1)),
            "\"0 ms\"",
            "Time over which removed members lose their stress; default 0.",
        ),
        may(
            "gravity",
            quantity(Dimension::Acceleration, 0.5, 30.0, (9.7, 9.9)),
            "\"9.81 m/s2\"",
            "Gravity, downwards; default 9.81 m/s2. Less than 0.5 m/s2 is refused: equilibrium under so little weight drowns in rounding.",
        ),
        may(
            "mesh_size",
            length(0.01, 5.0, (0.05, 1.0)),
            "\"400 mm\"",
            "Target edge length of the FE mesh; default 0.4 m.",
        ),
        may(
            "critical_strain_rate",
            quantity(Dimension::Rate, 1e-3, 1e3, (0.05, 5.0)),
            "\"0.25 1/s\"",
            "Strain rate above which a part does not count as rigid; default 0.25 1/s.",
        ),
    ],
};

/// Refinement.
pub const REFINE: Table = Table {
    noun: "a mesh refinement",
    doc: "Smaller elements in members. Mesh planes run through the whole building: they are subdivided by the finest demand \
          between any two of them.",
    keys: &[
        must(
            "members",
            Kind::List(&Kind::MemberPattern, 1, 1000),
            "[\"C1-*\"]",
            "Member ids; `*` stands for any characters.",
        ),
        must("size", length(0.01, 5.0, (0.05, 1.0)), "\"200 mm\"", "Target edge length there."),
        may(
            "ends",
            length(0.05, 50.0, (0.2, 2.0)),
            "\"600 mm\"",
            "Only within this distance of the ends of a column or beam; default: all of it.",
        ),
    ],
};

/// Mesh of the building.
pub const MESHING: Table = Table {
    noun: "[mesh]",
    doc: "Exceptions of the FE mesh; its target size is `settings.mesh_size`.",
    keys: &[
        may("refine", Kind::List(&Kind::Table(&REFINE), 0, 1000), "", "Smaller elements in some members."),
        may(
            "tie_below",
            length(0.0, 1.0, (0.02, 0.3)),
            "\"100 mm\"",
            "A column whose faces would bring mesh planes nearer than this to those of other members has a mesh of its own, tied \
             to its neighbours; default 0: never.",
        ),
    ],
};

const MATERIAL: Kind = Kind::Variants(
    &[("concrete", &CONCRETE), ("steel", &STEEL), ("homogenised", &HOMOGENISED)],
    &["masonry", "timber", "aluminium"],
);
const SECTION: Kind = Kind::Variants(
    &[("rectangle", &RECTANGLE), ("plate", &PLATE)],
    &["circle", "round", "tee", "hollow", "steel_profile"],
);
const PREPARATION: Kind = Kind::Variants(&[("weaken", &WEAKEN), ("cut", &CUT)], &["drill", "notch"]);

/// The whole file.
pub const FILE: Table = Table {
    noun: "a building file",
    doc: "A reinforced-concrete building, its surroundings and its demolition plan. Plain numbers are SI (m, kg, \
          s, N, Pa, rad); a text may carry a unit (\"400 mm\", \"30 MPa\", \"120 ms\").",
    keys: &[
        must("schema", Kind::Version, "1", "Version of this format."),
        must("name", Kind::Text(100), "\"three-storey-frame\"", "Short name, used in titles and file names."),
        may("description", Kind::Text(10_000), "\"…\"", "One paragraph for the reader of the report."),
        must("materials", Kind::Map(&MATERIAL), "", "Materials by id."),
        must("sections", Kind::Map(&SECTION), "", "Reinforced sections by id."),
        may("grid", Kind::Table(&GRID), "", "A regular frame."),
        may("members", Kind::List(&Kind::Table(&MEMBER), 0, MAX_MEMBERS), "", "Single members."),
        may("supports", Kind::List(&Kind::Table(&SUPPORT), 0, 1000), "", "Supports."),
        must("ground", Kind::Table(&GROUND), "", "The rigid ground, with `level` and `friction`."),
        may("obstacles", Kind::List(&Kind::Table(&OBSTACLE), 0, 1000), "", "Obstacles."),
        may("preparation", Kind::List(&PREPARATION, 0, 1000), "", "Work done before ignition."),
        may("events", Kind::List(&Kind::Table(&EVENT), 0, 1000), "", "Charges."),
        may(
            "overrides",
            Kind::List(&Kind::Table(&OVERRIDE), 0, 1000),
            "",
            "Decisions of the analyst in place of the rules.",
        ),
        may("settings", Kind::Table(&SETTINGS), "", "Simulation settings."),
        may("mesh", Kind::Table(&MESHING), "", "Exceptions of the FE mesh."),
    ],
};
