//! `fallwerk rc`: bends a reinforced member end in concrete and steel.

use super::progress::Progress;
use super::rc_cycles::{self, Loading};
use super::{Failure, Outcome, colour_on_stderr, print, read_building, thread_pool, write};
use crate::base::hash::readable_json;
use crate::base::output::OutputFolder;
use crate::base::results::Results;
use crate::base::units::Dimension;
use crate::building::inspect_file;
use crate::library::rc::no_strength;
use crate::rc::events;
use crate::rc::member::Joint;
use crate::rc::section_file::{self, RcSection};
use crate::rc::section_grid;
use crate::rc::series::{self, Case, Series, SeriesOptions};
use crate::report::figure::{self, Line, Panel};
use crate::report::interaction::{self, Group};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::path::PathBuf;

/// Bend a reinforced member end in concrete and steel, and compare it with its fibre section; or crush, pull, shear or twist a piece of it
///
/// One bend for each axial force and direction, each on one thread. The section comes from a section file, or with --end from a
/// building's column end. Exit codes: 0 done, 1 a bend failed or is not quasi-static, 2 bad input.
#[derive(clap::Args)]
pub struct Arguments {
    /// A section file; with --end a building file
    #[arg(required_unless_present_any = ["schema", "example", "example_grid"])]
    file: Option<PathBuf>,
    /// Take section, materials and length (half the clear height) from this column end, such as `C1-A1.bottom`
    #[arg(long, value_name = "ID")]
    end: Option<String>,
    /// Directions in degrees in which the free end is pushed: 0 along the width, 90 along the depth
    #[arg(long, value_name = "DEG", num_args = 1.., value_delimiter = ',', allow_negative_numbers = true, default_values_t = [90.0])]
    pub(super) direction: Vec<f64>,
    #[command(flatten)]
    loading: Loading,
    #[command(flatten)]
    pub(super) piece: super::rc_springs::Loading,
    #[command(flatten)]
    pub(super) bending: Bending,
    /// Write curves.csv, result.json and moment-rotation.svg into this folder, with more than two directions also biaxial.svg; of cyclic bends
    /// history.csv, cycles.csv, envelope.csv, result.json and loops.svg. The results of an earlier call in it are replaced
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    pub(super) json: bool,
    /// Worker threads (default: all cores)
    #[arg(long, value_name = "N")]
    pub(super) threads: Option<u16>,
    /// Print the JSON Schema of the section file
    #[arg(long, exclusive = true)]
    schema: bool,
    /// Print a commented example of a section file
    #[arg(long, exclusive = true)]
    example: bool,
    /// Print a commented example of a grid of sections, for `library derive --grid`
    #[arg(long, exclusive = true)]
    example_grid: bool,
}

/// How members are meshed and bent.
#[derive(Debug, Clone, clap::Args)]
pub struct Bending {
    /// Axial forces over f_c A, compression positive [default: 0 0.1 0.3 0.6; of library entries also -0.05]
    #[arg(long, value_name = "SHARE", num_args = 1.., value_delimiter = ',', allow_negative_numbers = true, value_parser = share)]
    pub axial: Vec<f64>,
    /// Rotation at which a bend stops, such as `100mrad` [default: 0.1 rad; of library entries 0.25 rad]
    #[arg(long, value_name = "ROTATION", value_parser = rotation, allow_hyphen_values = true)]
    pub until: Option<f64>,
    /// Size of the elements [default: 50 mm]
    #[arg(long, value_name = "SIZE", value_parser = size)]
    pub mesh: Option<f64>,
    /// Number of elements over the depth of each section, in the place of --mesh
    #[arg(long, value_name = "N", value_parser = count, conflicts_with = "mesh")]
    pub elements: Option<f64>,
    /// What the member stands on: a plane of symmetry, or a block of uncracked concrete [default: symmetry; of library entries block, with slip of bars out of it]
    #[arg(long, value_name = "KIND", value_parser = joints())]
    pub joint: Option<Joint>,
    /// Bars stay straight
    #[arg(long)]
    pub no_buckling: bool,
    /// The seed's surfaces of the concrete law: no meridians, no gain of ductility under lateral pressure
    #[arg(long)]
    pub seed_law: bool,
    /// Mesh the whole section, also where it is symmetric about the plane in which it is bent and half of it would do
    #[arg(long)]
    pub whole: bool,
}

fn within(value: f64, low: f64, high: f64, what: &str) -> Result<f64, String> {
    if (low..=high).contains(&value) { Ok(value) } else { Err(format!("{what} is {low} to {high}")) }
}

fn share(text: &str) -> Result<f64, String> {
    within(super::library_find::quantity(text, Dimension::Number)?, -1.0, 1.5, "an axial share")
}

fn rotation(text: &str) -> Result<f64, String> {
    within(super::library_find::quantity(text, Dimension::Angle)?, 0.001, 1.0, "a rotation [rad]")
}

fn count(text: &str) -> Result<f64, String> {
    within(
        super::library_find::quantity(text, Dimension::Number)?,
        2.0,
        40.0,
        "the number of elements over a depth",
    )
}

fn size(text: &str) -> Result<f64, String> {
    super::library_find::quantity(text, Dimension::Length)
}

impl Bending {
    /// The options; `axial_shares` and `until_rad` are used where the command line says nothing.
    pub fn options(&self, axial_shares: &[f64], until_rad: f64) -> SeriesOptions {
        let defaults = SeriesOptions::default();
        SeriesOptions {
            axial_shares: if self.axial.is_empty() { axial_shares.to_vec() } else { self.axial.clone() },
            until_rad: self.until.unwrap_or(until_rad),
            mesh_size_m: self.mesh.unwrap_or(defaults.mesh_size_m),
            joint: self.joint.unwrap_or(Joint::Symmetry),
            seed_law: self.seed_law,
            whole: self.whole,
            ..defaults
        }
    }

    /// The options for a section: with --elements the size goes by its larger side, to a tenth of a millimetre.
    pub fn meshed(&self, options: &SeriesOptions, section: &RcSection) -> SeriesOptions {
        SeriesOptions { mesh_size_m: self.size_m(section, options.mesh_size_m), ..options.clone() }
    }

    /// The size of the elements by --elements; `without` where it is not given \[m\].
    pub fn size_m(&self, section: &RcSection, without: f64) -> f64 {
        let depth_m = section.input.size_m[0].max(section.input.size_m[1]);
        self.elements.map_or(without, |n| (1e4 * depth_m / n).round() / 1e4)
    }

    /// Whether the command line says anything of it.
    pub fn is_given(&self) -> bool {
        let numbers = !self.axial.is_empty() || self.until.is_some() || self.mesh.is_some();
        let laws = self.joint.is_some() || self.no_buckling || self.seed_law;
        numbers || self.elements.is_some() || laws || self.whole
    }

    /// The section with or without buckling.
    pub fn section(&self, section: RcSection) -> RcSection {
        if self.no_buckling { section.without_buckling() } else { section }
    }
}

/// What a member stands on, by its name.
pub(super) fn joints() -> impl TypedValueParser<Value = Joint> {
    PossibleValuesParser::new(["symmetry", "block"])
        .map(|name| if name == "block" { Joint::Block } else { Joint::Symmetry })
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<Outcome, Failure> {
    if arguments.schema {
        print(&format!("{:#}\n", section_file::json_schema()));
        return Ok(Outcome::Done);
    }
    if arguments.example_grid {
        print(section_grid::EXAMPLE);
        return Ok(Outcome::Done);
    }
    let Some(file) = arguments.file.as_ref().filter(|_| !arguments.example) else {
        print(section_file::EXAMPLE);
        return Ok(Outcome::Done);
    };
    let section = match &arguments.end {
        Some(end) => {
            let building = read_building(file, arguments.json)?;
            eprintln!("note: strengths are those of the building file; the submodel takes them as means");
            RcSection::of_column_end(&building, end).map_err(Failure::input)?
        }
        None => section_file::read_file(file).map_err(|found| {
            if inspect_file(file).building.is_some() {
                let shown = file.display();
                return Failure::input(format!(
                    "{shown} is a building: name the end of a column with --end, as in --end C1-A1.bottom"
                ));
            }
            eprint!("{}", found.render(colour_on_stderr()));
            if arguments.json {
                print(&format!("{:#}\n", json!({ "ok": false, "diagnostics": found.to_json() })));
            }
            Failure::input(String::new())
        })?,
    };
    let section = arguments.bending.section(section);
    let bending = &arguments.bending;
    arguments.piece.check(
        !bending.axial.is_empty(),
        arguments.loading.is_given(),
        bending.whole || bending.joint.is_some(),
    )?;
    if let Some(drive) = arguments.piece.drive() {
        return super::rc_springs::run(&section, drive, arguments);
    }
    let defaults = SeriesOptions::default();
    let turns_rad = arguments.loading.turns_rad()?;
    let axial_shares =
        if turns_rad.is_empty() { &defaults.axial_shares[..] } else { &rc_cycles::AXIAL_SHARES };
    let options = SeriesOptions {
        directions_deg: arguments.direction.clone(),
        turns_rad,
        fit_rule: arguments.loading.wants_rule()?,
        ..arguments.bending.options(axial_shares, defaults.until_rad)
    };
    let options = arguments.bending.meshed(&options, &section);
    if let Some(odd) = options.directions_deg.iter().find(|d| d.is_nan() || d.abs() > 360.0) {
        return Err(Failure::input(format!(
            "--direction {odd} is not within a turn; give degrees such as 90, at most 360"
        )));
    }
    let output =
        arguments.output.as_deref().map(|folder| OutputFolder::create(folder, Results::Section)).transpose();
    let output = output.map_err(|e| Failure::input(e.to_string()))?;
    let progress = Progress::on_stderr();
    progress.stage("bending:");
    let done = thread_pool(arguments.threads)?
        .install(|| series::run(&section, &options, &|share, text| progress.advance(share, text)));
    progress.finish();
    let series = done.map_err(|e| Failure::input(e.to_string()))?;
    if let Some(output) = output {
        write_files(&output, &section, &series)?;
        output.commit().map_err(|e| Failure::input(e.to_string()))?;
    }
    if arguments.json {
        let mut value = result(&section, &series);
        for (case, own) in series.cases.iter().enumerate() {
            value["bends"][case]["seconds"] = json!(own.seconds);
        }
        print(&text_of(&value)?);
    } else {
        print(&table(&section, &series));
    }
    let failed = series.cases.iter().any(|c| c.bent.is_err() || fault(c).is_some());
    Ok(if failed { Outcome::CheckFailed } else { Outcome::Done })
}

fn write_files(output: &OutputFolder, section: &RcSection, series: &Series) -> Result<(), Failure> {
    if series.options.turns_rad.is_empty() {
        write(output, "curves.csv", &csv(series))?;
        write(output, "moment-rotation.svg", &svg(section, series))?;
        if let Some(text) = biaxial(section, series) {
            write(output, "biaxial.svg", &text)?;
        }
    } else {
        write(output, "history.csv", &rc_cycles::history_csv(series))?;
        write(output, "cycles.csv", &rc_cycles::cycles_csv(series))?;
        write(output, "envelope.csv", &rc_cycles::envelope_csv(series))?;
        let panels = rc_cycles::panels(series);
        write(output, "loops.svg", &figure::svg(&section.name, &words(section, series), &panels))?;
    }
    write(output, "result.json", &text_of(&result(section, series))?)
}

fn text_of(value: &Value) -> Result<String, Failure> {
    readable_json(value).map_err(|e| Failure::stopped(e.to_string()))
}

/// The figures as JSON, without run times.
fn result(section: &RcSection, series: &Series) -> Value {
    let case = |c: &Case| match &c.bent {
        Err(error) => json!({
            "axial_share": c.axial_share, "axial_force_n": c.axial_n, "direction_deg": c.direction_deg,
            "fibre_peak_nm": c.fibre_peak_nm, "error": error.to_string(),
        }),
        Ok(bent) => json!({
            "axial_share": c.axial_share, "axial_force_n": c.axial_n, "direction_deg": c.direction_deg,
            "figures": c.figures, "fibre_peak_nm": c.fibre_peak_nm, "peak_over_fibre": ratio(c),
            "shear": c.shear.map(|s| json!({
                "largest_n": s.largest_n, "strength_n": s.strength_n, "share": s.share(), "critical": s.is_critical(),
            })),
            "kinetic_share": bent.kinetic_share, "pace": c.pace, "energies": bent.energies, "steps": bent.steps, "failed": bent.failed(),
            "ending": bent.ending, "last_rotation_rad": bent.points.last().map(|p| p[0]),
            "cycles": c.hysteresis.as_ref().map(|h| &h.cycles), "excursions": c.hysteresis.as_ref().map(|h| &h.excursions),
            "curve": c.curve.as_ref().and_then(|c| c.as_ref().ok()),
            "largest_slip_m": bent.slips_m.iter().copied().fold(0.0, f64::max), "events": bent.events,
        }),
    };
    json!({
        "schema": 1,
        "section": section,
        "options": series.options,
        "elements": { "hexahedra": series.elements[0], "bars": series.elements[1] },
        "length_m": series.length_m,
        "bends": series.cases.iter().map(case).collect::<Vec<_>>(),
    })
}

/// Why a monotonic push is no curve, in words.
fn fault(case: &Case) -> Option<String> {
    case.fault().or_else(|| no_strength(case))
}

fn ratio(case: &Case) -> Option<f64> {
    Some(case.figures?.peak_nm / case.fibre_peak_nm?)
}

fn csv(series: &Series) -> String {
    let mut text =
        String::from("axial force [kN],direction [deg],rotation [rad],moment [kN m],shortening [mm]\n");
    for case in &series.cases {
        for [rotation, moment, shortening] in case.bent.iter().flat_map(|b| &b.points) {
            let _ = writeln!(
                text,
                "{:.3},{},{:.6e},{:.6e},{:.6e}",
                case.axial_n / 1e3,
                case.direction_deg,
                rotation,
                moment / 1e3,
                shortening * 1e3
            );
        }
    }
    text
}

fn svg(section: &RcSection, series: &Series) -> String {
    let line = |c: &Case| {
        let bent = c.bent.as_ref().ok()?;
        Some(Line {
            label: format!("n = {}", c.axial_share),
            points: bent.points.iter().map(|p| [1e3 * p[0], p[1] / 1e3]).collect(),
            is_reference: false,
        })
    };
    let owned = |name: &str, unit: &str| (name.to_string(), unit.to_string());
    let panel = |direction: &f64| Panel {
        title: format!("Direction {direction}°: moment over rotation of the chord"),
        x: owned("rotation", "mrad"),
        y: owned("moment", "kN m"),
        lines: series.cases.iter().filter(|c| c.direction_deg == *direction).filter_map(line).collect(),
        counts: false,
    };
    let panels: Vec<Panel> =
        series.options.directions_deg.iter().map(panel).filter(|p| !p.lines.is_empty()).collect();
    figure::svg(&section.name, &words(section, series), &panels)
}

/// Strength over direction, if there are more than two: peaks of the bends over those of the fibre section.
fn biaxial(section: &RcSection, series: &Series) -> Option<String> {
    if series.options.directions_deg.len() < 3 {
        return None;
    }
    let at = |deg: f64, moment: f64| {
        let (sin, cos) = deg.to_radians().sin_cos();
        [cos * moment / 1e3, sin * moment / 1e3]
    };
    let group = |share: &f64| {
        let of_share = series.cases.iter().filter(|c| c.axial_share == *share);
        let line = series::fibre_peaks(section, *share, series);
        Group {
            label: format!("n = {share}"),
            line: line.into_iter().map(|[deg, moment]| at(deg, moment)).collect(),
            points: of_share.filter_map(|c| Some(at(c.direction_deg, c.figures?.peak_nm))).collect(),
        }
    };
    let groups: Vec<Group> = series.options.axial_shares.iter().map(group).collect();
    let words = "largest moments of the pushes (points) over those of the fibre section (lines), each in the direction of its push";
    let axes = ["moment of a push along the width [kN m]", "moment of a push along the depth [kN m]"];
    Some(interaction::svg(&section.name, words, axes, &groups))
}

fn words(section: &RcSection, series: &Series) -> String {
    let reach = format!("{:.2} m to the point of zero moment", series.length_m);
    section_words(section, &reach, series.elements)
}

/// A section, what is made of it, and the mesh (hexahedra, bar elements) in words.
pub(super) fn section_words(section: &RcSection, what: &str, elements: [usize; 2]) -> String {
    let input = &section.input;
    let ties = input.ties.map_or("no ties".to_string(), |t| {
        format!("ties {:.0} mm every {:.0} mm", 1e3 * t.diameter_m, 1e3 * t.spacing_m)
    });
    format!(
        "{:.2} x {:.2} m, {what}, {} bars ({:.2} %), {ties}, f_c {:.1} MPa, {} hexahedra, {} bar elements",
        input.size_m[0],
        input.size_m[1],
        input.bars.len(),
        100.0 * section.steel_m2() / input.area_m2(),
        section.concrete.compressive_strength_pa / 1e6,
        elements[0],
        elements[1]
    )
}

/// Share of the push at whose end a largest moment is no peak yet.
const RISES_TO: f64 = 0.99;

/// The table on standard output.
fn table(section: &RcSection, series: &Series) -> String {
    let mut text = format!("{}: {}\n\n", section.name, words(section, series));
    text += "     n      N   dir    peak      at   yield   80 %   20 %  kinetic  balance   fibre  ratio  elements     s\n";
    text += "           kN   deg    kN m    mrad    mrad   mrad   mrad                      kN m                         \n";
    let optional = |value: Option<f64>, scale: f64, digits: usize| {
        value.map_or("-".to_string(), |v| format!("{:.digits$}", scale * v))
    };
    for c in &series.cases {
        let _ = write!(text, "{:6.2} {:6.0} {:5.0} ", c.axial_share, c.axial_n / 1e3, c.direction_deg);
        let f = c.figures;
        let _ = match &c.bent {
            Err(error) => writeln!(text, "{error}"),
            Ok(bent) => writeln!(
                text,
                "{:>7} {:>7} {:>7} {:>6} {:>6} {:>8.4} {:>8.4} {:>7} {:>6} {:>9} {:>5.0}",
                optional(f.map(|f| f.peak_nm), 1e-3, 1),
                optional(f.map(|f| f.peak_rotation_rad), 1e3, 2),
                optional(f.map(|f| f.yield_rotation_rad), 1e3, 2),
                optional(f.and_then(|f| f.rotation_80_rad), 1e3, 1),
                optional(f.and_then(|f| f.rotation_20_rad), 1e3, 1),
                bent.kinetic_share,
                bent.energies.residual_share,
                optional(c.fibre_peak_nm, 1e-3, 1),
                optional(ratio(c), 1.0, 3),
                series.elements[0],
                c.seconds
            ),
        };
    }
    for c in &series.cases {
        for words in c.bent.iter().flat_map(|b| events::in_words(&b.events)) {
            let _ = writeln!(text, "n = {}, direction {}: {words}", c.axial_share, c.direction_deg);
        }
    }
    for (c, fault) in series.cases.iter().filter_map(|c| Some((c, fault(c)?))) {
        let _ = writeln!(text, "n = {}, direction {}: {fault}", c.axial_share, c.direction_deg);
    }
    let is_push = series.options.turns_rad.is_empty();
    let until_rad = series.options.until_rad;
    let rises = |c: &&Case| c.figures.is_some_and(|f| f.peak_rotation_rad > RISES_TO * until_rad);
    for c in series.cases.iter().filter(rises).filter(|_| is_push) {
        let _ = writeln!(
            text,
            "n = {}, direction {}: the moment still rises where the push ends, at {:.1} mrad; a larger --until shows the peak",
            c.axial_share,
            c.direction_deg,
            1e3 * until_rad
        );
    }
    for (c, s) in
        series.cases.iter().filter_map(|c| Some((c, c.shear?))).filter(|(_, s)| s.is_critical() && is_push)
    {
        let _ = writeln!(
            text,
            "n = {}, direction {}: {} its shear strength: {:.0} kN of {:.0} kN (ASCE 41-17, eq. 10-3); cycles take strength that this push leaves (--cycles)",
            c.axial_share,
            c.direction_deg,
            if s.share() > 1.0 { "beyond" } else { "near" },
            s.largest_n / 1e3,
            s.strength_n / 1e3
        );
    }
    series.cases.iter().for_each(|c| text += &rc_cycles::table(c));
    text
}
