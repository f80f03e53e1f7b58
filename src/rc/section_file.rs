//! The section file: a reinforced member end in TOML, its table of keys, and its JSON Schema.
//!
//! Read with the field machinery of building files: all errors at once, each with its place, the value found and what would be right.

use super::anchorage::{Anchorage, Ending};
use super::bar_lines::ONE_LINE_M;
use crate::base::diagnostic::{Diagnostic, Diagnostics};
use crate::base::source::Source;
use crate::base::tree::{self, Format, Node};
use crate::base::units::{Dimension, show};
use crate::building::format::{BAR, BAR_LAYER, BARS_AROUND, Key, Kind, Quantity, Table};
use crate::building::{Bar, Fields, MemberKind, check_against, section_bars};
use crate::material::concrete::ConcreteLaw;
use crate::material::fibre::{FibreOptions, SectionInput};
use crate::material::fibre_concrete::TieInput;
use crate::material::rebar::{Buckling, Hardening, LoopShape, RebarLaw};
use serde::Serialize;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

/// A commented example, as `fallwerk rc --example` prints it.
pub const EXAMPLE: &str = include_str!("example.toml");

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

const SIDE: Kind = quantity(Dimension::Length, 0.1, 3.0, (0.15, 1.5));
const LENGTH: Kind = quantity(Dimension::Length, 0.1, 20.0, (0.5, 4.0));
const SPACING: Kind = quantity(Dimension::Length, 0.03, 0.6, (0.05, 0.4));
const DIAMETER: Kind = quantity(Dimension::Length, 0.004, 0.06, (0.006, 0.04));
const STEEL_STRENGTH: Kind = quantity(Dimension::Stress, 100e6, 2.5e9, (200e6, 900e6));
const STEEL_MODULUS: Kind = quantity(Dimension::Stress, 100e9, 300e9, (180e9, 220e9));
const RUPTURE: Kind = quantity(Dimension::Number, 0.005, 0.4, (0.02, 0.2));
const LEGS: Kind = quantity(Dimension::Number, 2.0, 20.0, (2.0, 6.0));
const BOND: Kind = quantity(Dimension::Stress, 0.1e6, 50e6, (1e6, 20e6));
const ANCHORED: Kind = quantity(Dimension::Length, 0.02, 20.0, (0.1, 3.0));
const ENERGY: Kind = quantity(Dimension::Number, 1.0, 1e6, (10.0, 1e5));

/// The file.
pub const SECTION_FILE: Table = Table {
    noun: "a section file",
    doc: "A reinforced rectangular member end in concrete and steel. Plain numbers are SI; a text may carry a unit. Strengths are means.",
    keys: &[
        key("schema", true, Kind::Version, "1", "Version of this format."),
        key("name", true, Kind::Text(100), "\"column-400\"", "Short name, used in titles."),
        key(
            "member",
            false,
            Kind::Choice(&["column", "beam", "slab", "wall"], &[]),
            "\"beam\"",
            "What it is a section of; of a slab: a strip of this width. Default: column.",
        ),
        key("width", true, SIDE, "\"400 mm\"", "Width, along x."),
        key("depth", true, SIDE, "\"400 mm\"", "Depth, along y."),
        key("length", true, LENGTH, "\"1.5 m\"", "From the end section to the point of zero moment."),
        key(
            "bars",
            false,
            Kind::List(&Kind::Table(&BAR), 1, 200),
            "[{ x = 0, y = 0, diameter = \"20 mm\" }]",
            "Single bars.",
        ),
        key(
            "bar_layers",
            false,
            Kind::List(&Kind::Table(&BAR_LAYER), 1, 20),
            "[{ face = \"bottom\", count = 3, … }]",
            "Rows of bars.",
        ),
        key(
            "bars_around",
            false,
            Kind::Table(&BARS_AROUND),
            "{ per_face = 3, … }",
            "Bars along all four faces.",
        ),
        key("concrete", true, Kind::Table(&CONCRETE), "", "Concrete."),
        key("steel", true, Kind::Table(&STEEL), "", "Steel of the longitudinal bars."),
        key("ties", false, Kind::Table(&TIES), "", "Ties; without them bars do not buckle either."),
        key(
            "anchorage",
            false,
            Kind::Table(&ANCHORAGE),
            "",
            "How bars are held in the joint; default: perfectly.",
        ),
    ],
};

const CONCRETE: Table = Table {
    noun: "[concrete]",
    doc: "Concrete. What is not given follows from the strength.",
    keys: &[
        key(
            "strength",
            true,
            quantity(Dimension::Stress, 5e6, 150e6, (8e6, 120e6)),
            "\"38 MPa\"",
            "Mean cylinder strength.",
        ),
        key(
            "density",
            false,
            quantity(Dimension::Density, 500.0, 8500.0, (1500.0, 2700.0)),
            "\"2400 kg/m3\"",
            "Density.",
        ),
        key(
            "youngs_modulus",
            false,
            quantity(Dimension::Stress, 1e9, 80e9, (10e9, 50e9)),
            "\"33 GPa\"",
            "Young's modulus.",
        ),
        key(
            "poisson_ratio",
            false,
            quantity(Dimension::Number, 0.0, 0.45, (0.1, 0.3)),
            "0.2",
            "Poisson's ratio.",
        ),
        key(
            "tensile_strength",
            false,
            quantity(Dimension::Stress, 1e4, 20e6, (0.5e6, 10e6)),
            "\"3.4 MPa\"",
            "Tensile strength.",
        ),
        key("fracture_energy_j_m2", false, ENERGY, "140", "Fracture energy G_F [J/m2]."),
        key("crushing_energy_j_m2", false, ENERGY, "25000", "Crushing energy G_c [J/m2]."),
        key(
            "peak_strain",
            false,
            quantity(Dimension::Number, 5e-4, 0.05, (0.0015, 0.01)),
            "0.002",
            "Strain at the strength.",
        ),
    ],
};

const STEEL: Table = Table {
    noun: "[steel]",
    doc: "Steel of the longitudinal bars.",
    keys: &[
        key("yield_strength", true, STEEL_STRENGTH, "\"550 MPa\"", "Yield strength."),
        key("ultimate_strength", true, STEEL_STRENGTH, "\"620 MPa\"", "Strength at the ultimate strain."),
        key("ultimate_strain", true, RUPTURE, "0.08", "Strain at which a bar ruptures."),
        key("youngs_modulus", false, STEEL_MODULUS, "\"200 GPa\"", "Young's modulus; default 200 GPa."),
        key(
            "hardening_strain",
            false,
            quantity(Dimension::Number, 0.001, 0.1, (0.003, 0.03)),
            "0.015",
            "Strain at the end of the yield plateau, a parabola follows; default: no plateau, a straight line.",
        ),
    ],
};

const TIES: Table = Table {
    noun: "[ties]",
    doc: "Ties on the longitudinal bars.",
    keys: &[
        key("diameter", true, DIAMETER, "\"8 mm\"", "Diameter."),
        key("spacing", true, SPACING, "\"150 mm\"", "Spacing along the member."),
        key("yield_strength", true, STEEL_STRENGTH, "\"550 MPa\"", "Yield strength."),
        key(
            "legs",
            false,
            Kind::Tuple(&[LEGS, LEGS]),
            "[2, 2]",
            "Legs along the width and along the depth; more than two lie on the inner lines of bars, or without these on the outer ones.",
        ),
        key("ultimate_strain", false, RUPTURE, "0.1", "Strain at which a tie ruptures; default 0.1."),
        key(
            "all_bars_held",
            false,
            Kind::Choice(&["no", "yes"], &[]),
            "\"no\"",
            "Whether ties hold each outer bar or the corner bars only; for the fibre section. Default: no.",
        ),
    ],
};

const ANCHORAGE: Table = Table {
    noun: "[anchorage]",
    doc: "How the longitudinal bars are held in the joint or footing.",
    keys: &[
        key(
            "kind",
            true,
            Kind::Choice(&["perfect", "slip"], &[]),
            "\"slip\"",
            "`slip`: bars slip by the strains along their bond, and may be pulled out.",
        ),
        key(
            "length",
            false,
            ANCHORED,
            "\"600 mm\"",
            "Straight length from the end section to the end of a bar or its hook; default: long enough.",
        ),
        key(
            "ending",
            false,
            Kind::Choice(&["straight", "hook"], &[]),
            "\"hook\"",
            "What is at the end; a hook holds what bond leaves. Default: straight.",
        ),
        key(
            "bond_strength",
            false,
            BOND,
            "\"6 MPa\"",
            "Bond along the elastic part of a bar; default sqrt(f_c) in MPa.",
        ),
        key(
            "yielded_bond_strength",
            false,
            BOND,
            "\"3 MPa\"",
            "Bond along the yielded part of a bar; default half of the other.",
        ),
    ],
};

/// The JSON Schema of the file.
pub fn json_schema() -> Value {
    crate::building::schema::schema_of(&SECTION_FILE, "Fallwerk section of a member end")
}

/// A member end of the submodel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RcSection {
    /// Short name.
    pub name: String,
    /// What it is a section of. Beams and slabs bend about x; y points up.
    pub member: MemberKind,
    /// Section with bars, ties and steel; bars displace concrete and remember.
    pub input: SectionInput,
    /// Law of the concrete.
    pub concrete: ConcreteLaw,
    /// From the end section to the point of zero moment \[m\].
    pub length_m: f64,
    /// Slip of the bars out of the joint; `None`: full bond.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub anchorage: Option<Anchorage>,
}

impl RcSection {
    /// Area of all bars \[m²\].
    pub fn steel_m2(&self) -> f64 {
        self.input.bars.iter().map(|b| 0.25 * std::f64::consts::PI * b.diameter_m * b.diameter_m).sum()
    }

    /// Axial force \[N\] of a share of `f_c A`, compression positive.
    pub fn axial_n(&self, share: f64) -> f64 {
        share * self.concrete.compressive_strength_pa * self.input.area_m2()
    }

    /// Bars that stay straight.
    #[must_use]
    pub fn without_buckling(mut self) -> Self {
        self.input.steel.buckling = None;
        self
    }
}

/// Reads a section file.
///
/// # Errors
/// All errors at once.
pub fn read_file(path: &Path) -> Result<RcSection, Diagnostics> {
    let source = Source::read(path).map_err(|e| Diagnostics::unreadable(&path.display().to_string(), e))?;
    read(&source).map_err(|errors| Diagnostics::new(Arc::new(source), errors))
}

/// Reads a section.
///
/// # Errors
/// All errors at once, each with its place.
pub fn read(source: &Source) -> Result<RcSection, Vec<Diagnostic>> {
    let root = tree::parse(source, Format::Toml)?;
    let mut errors = check_against(&root, &SECTION_FILE);
    let section = of(&root, &mut errors);
    match section {
        Some(section) if errors.is_empty() => Ok(section),
        _ => Err(errors),
    }
}

fn of(root: &Node, errors: &mut Vec<Diagnostic>) -> Option<RcSection> {
    let top = Fields { node: root, table: &SECTION_FILE };
    let section = |name: &str, table| top.child(name).map(|node| Fields { node, table });
    let concrete = section("concrete", &CONCRETE).and_then(|f| concrete(f, errors));
    let steel = section("steel", &STEEL).and_then(|f| steel(f, errors));
    let ties = section("ties", &TIES);
    let tie_m = ties.and_then(|t| t.number("diameter"));
    let size_m = [top.number("width")?, top.number("depth")?];
    let bars = section_bars(top, size_m, tie_m.unwrap_or(0.0), top.span("width"), errors)?;
    let ties = match ties {
        Some(fields) => {
            check_ties(fields, &bars, errors);
            Some(self::ties(fields, size_m, &bars)?)
        }
        None => None,
    };
    let anchorage = section("anchorage", &ANCHORAGE).and_then(anchorage);
    let thin = bars.iter().map(|b| b.diameter_m).fold(f64::INFINITY, f64::min);
    let steel = steel?;
    let concrete = concrete?;
    Some(RcSection {
        name: top.text("name")?.to_string(),
        member: match top.text("member") {
            Some("beam") => MemberKind::Beam,
            Some("slab") => MemberKind::Slab,
            Some("wall") => MemberKind::Wall,
            _ => MemberKind::Column,
        },
        input: SectionInput {
            size_m,
            concrete_strength_pa: concrete.compressive_strength_pa,
            tensile_strength_pa: concrete.tensile_strength_pa,
            youngs_modulus_pa: concrete.youngs_modulus_pa,
            steel: RebarLaw {
                buckling: ties.map(|t: TieInput| Buckling::between_ties(t.spacing_m, thin, &steel)),
                ..steel
            },
            bars,
            ties,
            options: FibreOptions { deduct_bars: true, history: true },
        },
        concrete,
        length_m: top.number("length")?,
        anchorage,
    })
}

fn concrete(f: Fields, errors: &mut Vec<Diagnostic>) -> Option<ConcreteLaw> {
    let standard = ConcreteLaw::of_strength(f.number("strength")?);
    let law = ConcreteLaw {
        density_kg_m3: f.number_or("density", standard.density_kg_m3)?,
        youngs_modulus_pa: f.number_or("youngs_modulus", standard.youngs_modulus_pa)?,
        poisson_ratio: f.number_or("poisson_ratio", standard.poisson_ratio)?,
        tensile_strength_pa: f.number_or("tensile_strength", standard.tensile_strength_pa)?,
        fracture_energy_j_m2: f.number_or("fracture_energy_j_m2", standard.fracture_energy_j_m2)?,
        crushing_energy_j_m2: f.number_or("crushing_energy_j_m2", standard.crushing_energy_j_m2)?,
        peak_strain: f.number_or("peak_strain", standard.peak_strain)?,
        ..standard
    };
    let Err(error) = law.check() else { return Some(law) };
    let name = error.name.trim_end_matches("_pa").trim_end_matches("_kg_m3");
    let place = if f.table.key(name).is_some() { f.span(name) } else { f.span("strength") };
    errors.push(
        Diagnostic::error("bad-material", format!("these numbers make no concrete: {error}"))
            .at(place, "does not suit the other numbers")
            .help("leave out what is not measured: it then follows from the strength"),
    );
    None
}

fn steel(f: Fields, errors: &mut Vec<Diagnostic>) -> Option<RebarLaw> {
    let (yielding, ultimate) = (f.number("yield_strength")?, f.number("ultimate_strength")?);
    let youngs_modulus_pa = f.number_or("youngs_modulus", 200e9)?;
    let ultimate_strain = f.number("ultimate_strain")?;
    let yield_strain = yielding / youngs_modulus_pa;
    let mut wrong = |key: &str, what: String, help: &str| {
        errors.push(Diagnostic::error("bad-material", what).at(f.span(key), "").help(help));
    };
    if ultimate < yielding {
        let words = [ultimate, yielding].map(|s| show(s, Dimension::Stress));
        let what = format!("the ultimate strength {} is below the yield strength {}", words[0], words[1]);
        wrong("ultimate_strength", what, "a steel without hardening has both alike");
        return None;
    }
    if ultimate_strain <= 1.01 * yield_strain {
        let what =
            format!("the ultimate strain {ultimate_strain} is not above that at yield, {yield_strain:.4}");
        wrong("ultimate_strain", what, "give the strain at which a bar ruptures, such as 0.08");
        return None;
    }
    let hardening = match f.child("hardening_strain") {
        None => {
            let slope = (ultimate - yielding) / (ultimate_strain - yield_strain);
            Hardening::Bilinear { ratio: slope / youngs_modulus_pa }
        }
        Some(_) => {
            let start_strain = f.number("hardening_strain")?;
            if start_strain <= yield_strain || start_strain >= ultimate_strain {
                let what = format!(
                    "the plateau ends at {start_strain}, outside the strains at yield and rupture, {yield_strain:.4} and {ultimate_strain}"
                );
                wrong("hardening_strain", what, "leave it out for a straight line of hardening");
                return None;
            }
            Hardening::Plateau { start_strain, ultimate_strength_pa: ultimate, exponent: 2.0 }
        }
    };
    Some(RebarLaw {
        youngs_modulus_pa,
        yield_strength_pa: yielding,
        hardening,
        ultimate_strain,
        loops: LoopShape::default(),
        buckling: None,
    })
}

/// `None` for bars that are held perfectly.
fn anchorage(f: Fields) -> Option<Anchorage> {
    if f.text("kind") != Some("slip") {
        return None;
    }
    Some(Anchorage {
        length_m: f.number("length"),
        ending: if f.text("ending") == Some("hook") { Ending::Hook } else { Ending::Straight },
        bond_pa: f.number("bond_strength"),
        yielded_bond_pa: f.number("yielded_bond_strength"),
    })
}

/// Refuses ties that have no second line of bars to go round to: their legs along that side would have no length.
fn check_ties(f: Fields, bars: &[Bar], errors: &mut Vec<Diagnostic>) {
    for (axis, side) in ["width", "depth"].into_iter().enumerate() {
        let at = |b: &Bar| [b.x_m, b.y_m][axis];
        let low = bars.iter().map(at).fold(f64::INFINITY, f64::min);
        let high = bars.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
        if !bars.is_empty() && high - low < ONE_LINE_M {
            let what = format!(
                "all bars stand on one line along the {side}, within {:.1} mm: ties have nothing to go round there",
                1e3 * (high - low)
            );
            errors
                .push(Diagnostic::error("ties-without-bars", what).at(f.span("diameter"), "these ties").help(
                "add the bars that hold the ties on the other side (bar_layers or bars), or leave [ties] out",
            ));
        }
    }
}

/// Ties lie on the bars: the cover is what these leave.
fn ties(f: Fields, size_m: [f64; 2], bars: &[Bar]) -> Option<TieInput> {
    let diameter_m = f.number("diameter")?;
    let legs = match f.child("legs") {
        Some(_) => f.numbers("legs")?.try_into().ok()?,
        None => [2.0; 2],
    };
    let clear =
        |b: &Bar| (0.5 * size_m[0] - b.x_m.abs()).min(0.5 * size_m[1] - b.y_m.abs()) - 0.5 * b.diameter_m;
    let clear = bars.iter().map(clear).fold(f64::INFINITY, f64::min);
    Some(TieInput {
        diameter_m,
        spacing_m: f.number("spacing")?,
        yield_strength_pa: f.number("yield_strength")?,
        ultimate_strain: f.number_or("ultimate_strain", 0.1)?,
        legs,
        cover_m: (clear - diameter_m).max(0.0),
        all_bars_held: f.text("all_bars_held") == Some("yes"),
    })
}
