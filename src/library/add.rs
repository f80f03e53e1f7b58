//! Entries from tests and other programs: a curve and what is said of it become a record.

use super::curve_file::{self, CurveFile, FileLevel};
use super::entry::{
    AxisRecord, Computed, Entry, EnvelopeLevel, Inputs, Source as Origin, SpringLevel, SpringRecord, Validity,
};
use super::meta::{self, HingeMeta, Meta};
use super::parts::Direction;
use crate::base::diagnostic::{Diagnostic, Diagnostics};
use crate::base::hash::ContentHash;
use crate::base::source::Source;
use crate::curve::{CurveError, Envelope, ResistanceCurve};
use std::path::Path;
use std::sync::Arc;

/// Reads a curve and its description; the entry is not stored.
///
/// # Errors
/// All errors of both files at once.
pub fn entry_of_files(curve: &Path, meta: &Path) -> Result<Entry, Vec<Diagnostics>> {
    let read =
        |path: &Path| Source::read(path).map_err(|e| Diagnostics::unreadable(&path.display().to_string(), e));
    match (read(curve), read(meta)) {
        (Ok(curve), Ok(meta)) => entry_of(curve, meta),
        (curve, meta) => Err([curve.err(), meta.err()].into_iter().flatten().collect()),
    }
}

/// As [`entry_of_files`], for texts already read.
///
/// # Errors
/// All errors of both texts at once.
pub fn entry_of(curve_text: Source, meta_text: Source) -> Result<Entry, Vec<Diagnostics>> {
    let (mut in_curve, mut in_meta) = (Vec::new(), Vec::new());
    let curve = curve_file::read(&curve_text).map_err(|e| in_curve = e).ok();
    let meta = meta::read(&meta_text).map_err(|e| in_meta = e).ok();
    let mut entry = None;
    if let (Some(curve), Some(meta)) = (&curve, &meta) {
        fit_together(curve, meta, &mut in_curve, &mut in_meta);
        if in_curve.is_empty() && in_meta.is_empty() {
            entry = made(&curve_text, curve, meta, &mut in_curve);
            plausible(curve, meta, &mut in_curve);
            from_the_origin(curve, meta, &mut in_curve);
        }
    }
    match entry {
        Some(entry) if in_curve.is_empty() => Ok(entry),
        _ => Err([(curve_text, in_curve), (meta_text, in_meta)]
            .into_iter()
            .filter(|(_, found)| !found.is_empty())
            .map(|(source, found)| Diagnostics::new(Arc::new(source), found))
            .collect()),
    }
}

/// What must agree between the two files.
fn fit_together(
    curve: &CurveFile,
    meta: &Meta,
    in_curve: &mut Vec<Diagnostic>,
    in_meta: &mut Vec<Diagnostic>,
) {
    let first = curve.levels.first().map(|l| l.span).unwrap_or_default();
    let kind = meta.kind.name();
    if meta.kind.is_bending() != curve.is_bending {
        let wanted = if meta.kind.is_bending() { "moment over rotation" } else { "force over displacement" };
        in_curve.push(
            Diagnostic::error("wrong-curve", format!("a `{kind}` has a curve of {wanted}"))
                .help("change the columns of the curve, or the `kind` in its description"),
        );
    }
    if !curve.is_bending && curve.levels.iter().any(|l| l.axis != 1) {
        in_curve.push(Diagnostic::error("wrong-axis", "a spring has no second bending axis").at(first, ""));
    }
    match (curve.levels.iter().any(|l| l.axial_force_n.is_some()), meta.axial_force_n) {
        (false, None) if curve.is_bending => in_meta.push(
            Diagnostic::error("missing-key", "the axial force is not known")
                .at(meta.axial_force_span, "`axial_force` is missing")
                .help("add `axial_force = \"0 kN\"` (compression positive), or a column `axial force [kN]` to the curve"),
        ),
        (true, Some(_)) => in_meta.push(
            Diagnostic::error("twice", "the axial force is given twice")
                .at(meta.axial_force_span, "the curve has a column of it")
                .help("take it out here or there"),
        ),
        _ => {}
    }
}

/// Largest rotation of a chord \[rad\] and displacement \[m\].
const LARGEST_ROTATION_RAD: f64 = 1.0;
const LARGEST_DISPLACEMENT_M: f64 = 10.0;
/// Bounds of the largest moment over `b h max(b, h)`, and largest force over `b h`, of any reinforced section \[Pa\]: its stress is
/// below that of steel, and a moment above that of cracked plain concrete.
const MOMENT_STRESS_PA: [f64; 2] = [1e4, 2e8];
const LARGEST_STRESS_PA: f64 = 1e9;

/// Refuses numbers that no member of this size has; it is the unit of the header that is wrong then.
fn plausible(curve: &CurveFile, meta: &Meta, errors: &mut Vec<Diagnostic>) {
    let (b, h) = (meta.features.width_m, meta.features.depth_m);
    for level in &curve.levels {
        let mut refuse = |what: String| {
            errors.push(
                Diagnostic::error("implausible", what)
                    .at(level.span, "the level that begins here")
                    .help("check the units of the header and the size of the section"),
            );
        };
        let x = level.points.iter().map(|p| p[0].abs()).fold(0.0, f64::max);
        let y = level.points.iter().map(|p| p[1].abs()).fold(0.0, f64::max);
        let section = format!("a section of {b} m x {h} m");
        if curve.is_bending {
            if x > LARGEST_ROTATION_RAD {
                refuse(format!("a rotation of {x} rad"));
            }
            let stress = y / (b * h * b.max(h));
            if y > 0.0 && !(MOMENT_STRESS_PA[0]..=MOMENT_STRESS_PA[1]).contains(&stress) {
                refuse(format!("a largest moment of {y} N m for {section}"));
            }
        } else {
            if x > LARGEST_DISPLACEMENT_M {
                refuse(format!("a displacement of {x} m"));
            }
            if y / (b * h) > LARGEST_STRESS_PA {
                refuse(format!("a force of {y} N for {section}"));
            }
        }
        let axial = level.axial_force_n.or(meta.axial_force_n).unwrap_or(0.0);
        if axial.abs() / (b * h) > LARGEST_STRESS_PA {
            refuse(format!("an axial force of {axial} N for {section}"));
        }
    }
}

/// Refuses curves of bending that do not begin at the origin, and moments that turn with their rotation: a single one of them changes the stiffness of all levels.
fn from_the_origin(curve: &CurveFile, meta: &Meta, errors: &mut Vec<Diagnostic>) {
    for level in curve.levels.iter().filter(|_| curve.is_bending) {
        if level.points[0] != [0.0, 0.0] {
            let [x, y] = level.points[0];
            errors.push(
                Diagnostic::error("no-origin", format!("a curve that begins at {x} rad and {y} N m"))
                    .at(level.span, "the first row of its level")
                    .help("begin each level with a row of rotation 0 and moment 0; take an offset of the measurement off"),
            );
        }
        let peak = (0..level.points.len()).max_by(|a, b| level.points[*a][1].total_cmp(&level.points[*b][1]));
        // past its peak the axial force on the deflected member may turn it further by itself
        let may_fall = |i: usize| meta.second_order_included && peak.is_some_and(|peak| i > peak);
        let wrong = (1..level.points.len()).find(|i| level.points[*i][1] < 0.0 && !may_fall(*i));
        if let Some(i) = wrong {
            let [x, y] = level.points[i];
            errors.push(
                Diagnostic::error("wrong-sign", format!("a moment of {y} N m at a rotation of {x} rad"))
                    .at(level.rows[i], "the moment of a resistance has the sign of its rotation")
                    .help("correct its sign, or leave the row out; moments below zero past the peak are those of the axial force: `second_order = \"included\"`"),
            );
        }
    }
}

/// Share of the squash load of plain concrete below which axial forces are hardly meant.
const LEAST_AXIAL_SHARE: f64 = 1e-3;

/// What may be wrong with an entry that could be made, to be looked at.
pub fn doubts(entry: &Entry) -> Vec<String> {
    let features = &entry.features;
    let strength = features.rc.as_ref().and_then(|rc| rc.concrete_strength_pa);
    let bending = entry.axes.iter().flat_map(|axis| &axis.envelopes).map(|level| level.axial_force_n);
    let springs = entry.springs.iter().flat_map(|spring| &spring.levels).map(|level| level.axial_force_n);
    let largest_n = bending.chain(springs).map(f64::abs).fold(0.0, f64::max);
    let squash_n = strength.map(|pa| pa * features.width_m * features.depth_m);
    let doubt = squash_n.filter(|squash| largest_n > 0.0 && largest_n < LEAST_AXIAL_SHARE * squash);
    let words = |squash: f64| {
        format!(
            "the largest axial force is {largest_n} N, {:.1e} of what the section bears in compression ({:.0} kN): is it N where kN is meant? See the unit in the header of `axial force`, or `axial_force`",
            largest_n / squash,
            squash / 1e3
        )
    };
    doubt.map(words).into_iter().chain(nothing_in_common(entry)).collect()
}

/// That the curves about both axes know no axial force in common.
fn nothing_in_common(entry: &Entry) -> Option<String> {
    let [first, second] = entry.axes.as_slice() else { return None };
    let ranges = [first, second].map(|axis| axis.curve.axial_range_n());
    let [[a, b], [c, d]] = ranges.map(|range| range.map(|force_n| force_n / 1e3));
    let apart = a.max(c) > b.min(d);
    apart.then(|| {
        format!(
            "about axis 1 the curves are those of {a} to {b} kN, about axis 2 of {c} to {d} kN: no axial force is known about both; give both axes curves of the same one"
        )
    })
}

fn made(text: &Source, curve: &CurveFile, meta: &Meta, errors: &mut Vec<Diagnostic>) -> Option<Entry> {
    let force = |level: &FileLevel| level.axial_force_n.or(meta.axial_force_n).unwrap_or(0.0);
    let mut computed = Computed { quality: meta.quality.clone(), ..Computed::default() };
    if curve.is_bending {
        for axis in 1..=2 {
            let levels: Vec<&FileLevel> = curve.levels.iter().filter(|l| l.axis == axis).collect();
            if !levels.is_empty() {
                computed.axes.push(bending(&levels, &force, errors)?);
            } else if axis == 1 {
                let error = Diagnostic::error("wrong-axis", "there is an axis 2 and no axis 1");
                errors.push(error.help("a curve about a single axis is one about axis 1"));
                return None;
            }
        }
    } else {
        computed.springs.push(spring(&curve.levels, meta.direction?, &force, errors)?);
    }
    computed.validity = validity(curve, &force);
    if let Some(h) = &meta.hinge {
        apply(h, &mut computed);
    }
    let inputs = inputs(text, meta)?;
    let entry = Entry::new(meta.kind, meta.origin, meta.features.clone(), inputs, computed).ok()?;
    match super::check::entry(&entry) {
        Ok(()) => Some(entry),
        Err(what) => {
            errors.push(Diagnostic::error("unsound", format!("this makes no sound entry: {what}")));
            None
        }
    }
}

fn apply(hinge: &HingeMeta, computed: &mut Computed) {
    computed.stiffness = Some(hinge.stiffness);
    computed.hinge_offset_m = Some(hinge.offset_m);
    computed.tensile_capacity_n = hinge.tensile_capacity_n;
    computed.tensile_elongation_m = hinge.tensile_elongation_m;
    computed.compressive_capacity_n = hinge.compressive_capacity_n;
}

fn bending(
    levels: &[&FileLevel],
    force: &impl Fn(&FileLevel) -> f64,
    errors: &mut Vec<Diagnostic>,
) -> Option<AxisRecord> {
    let envelopes: Vec<Envelope> =
        levels.iter().map(|l| Envelope { axial_force_n: force(l), points: l.points.clone() }).collect();
    match ResistanceCurve::from_envelopes(&envelopes) {
        Ok(curve) => {
            let level = |e: &Envelope| EnvelopeLevel {
                axial_force_n: e.axial_force_n,
                points: e.points.clone(),
                fracture_rotation_rad: None,
            };
            Some(AxisRecord { envelopes: envelopes.iter().map(level).collect(), curve, reverse: None })
        }
        Err(error) => {
            let span = match &error {
                CurveError::Envelope { level, .. } => levels[*level].span,
                _ => levels[0].span,
            };
            errors.push(
                Diagnostic::error("no-curve", format!("this makes no resistance curve: {error}"))
                    .at(span, "the level that begins here")
                    .help("a curve rises from the origin to a peak; rotations are those of the chord, elastic part included"),
            );
            None
        }
    }
}

fn spring(
    levels: &[FileLevel],
    direction: Direction,
    force: &impl Fn(&FileLevel) -> f64,
    errors: &mut Vec<Diagnostic>,
) -> Option<SpringRecord> {
    let secants: Vec<Option<f64>> = levels.iter().map(|l| secant(&l.points)).collect();
    if let Some(at) = secants.iter().position(Option::is_none) {
        errors.push(
            Diagnostic::error("no-curve", "the force does not grow with the displacement")
                .at(levels[at].span, "the level that begins here")
                .help(
                    "shortening, compression and approach are positive, and tension with elongation negative",
                ),
        );
        return None;
    }
    Some(SpringRecord {
        direction,
        stiffness_n_m: secants.into_iter().flatten().fold(0.0, f64::max),
        levels: levels
            .iter()
            .map(|l| SpringLevel {
                axial_force_n: force(l),
                points: l.points.clone(),
                fracture_displacement_m: None,
                dissipated_j: None,
            })
            .collect(),
    })
}

/// The secant from the origin to half of the largest force, on the side of that force \[N/m\].
fn secant(points: &[[f64; 2]]) -> Option<f64> {
    let peak = points.iter().map(|p| p[1]).fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let side: Vec<[f64; 2]> = {
        let mut side: Vec<[f64; 2]> = points
            .iter()
            .map(|p| [p[0] * peak.signum(), p[1] * peak.signum()])
            .filter(|p| p[0] > 0.0)
            .collect();
        side.sort_by(|a, b| a[0].total_cmp(&b[0]));
        side
    };
    let half = 0.5 * peak.abs();
    let mut before = [0.0, 0.0];
    for point in side {
        if point[1] >= half && half > 0.0 {
            let share = if point[1] > before[1] { (half - before[1]) / (point[1] - before[1]) } else { 1.0 };
            return Some(half / (before[0] + share * (point[0] - before[0])));
        }
        before = point;
    }
    None
}

fn validity(curve: &CurveFile, force: &impl Fn(&FileLevel) -> f64) -> Validity {
    let range = |axis: Option<u8>| {
        let levels = curve.levels.iter().filter(|level| axis.is_none_or(|axis| level.axis == axis));
        let forces = levels.map(force);
        let low = forces.clone().fold(f64::INFINITY, f64::min);
        [low, forces.fold(f64::NEG_INFINITY, f64::max)]
    };
    // what one of two axes knows alone is not known of the entry
    let [a, b] = [1, 2].map(|axis| range(Some(axis)));
    let common = [a[0].max(b[0]), a[1].min(b[1])];
    let has_both = curve.levels.iter().any(|level| level.axis == 2) && common[0] <= common[1];
    let first =
        curve.levels.iter().filter_map(|l| l.points.first()).map(|p| p[0]).fold(f64::NEG_INFINITY, f64::max);
    let last =
        curve.levels.iter().filter_map(|l| l.points.last()).map(|p| p[0]).fold(f64::INFINITY, f64::min);
    Validity {
        axial_force_n: if has_both { common } else { range(None) },
        rotation_rad: curve.is_bending.then_some([0.0, last]),
        displacement_m: (!curve.is_bending).then_some([first.min(last), last]),
    }
}

/// All that the entry is made from: the file by its hash, and what is said of it.
fn inputs(text: &Source, meta: &Meta) -> Option<Inputs> {
    let mut settings = std::collections::BTreeMap::new();
    settings.insert("features".to_string(), serde_json::to_value(&meta.features).ok()?);
    if let Some(h) = &meta.hinge {
        settings.insert("stiffness".to_string(), serde_json::to_value(h.stiffness).ok()?);
        let numbers = serde_json::json!([
            h.offset_m,
            h.tensile_capacity_n,
            h.tensile_elongation_m,
            h.compressive_capacity_n
        ]);
        settings.insert("offset_and_axial_capacities".to_string(), numbers);
    }
    if let Some(force) = meta.axial_force_n {
        settings.insert("axial_force_n".to_string(), force.into());
    }
    let name = Path::new(&text.name).file_name().unwrap_or_default().to_string_lossy().into_owned();
    Some(Inputs {
        settings,
        source: Some(Origin {
            citation: meta.citation.clone(),
            by: meta.by.clone(),
            program: meta.program.clone(),
            loading: meta.loading,
            second_order_included: meta.second_order_included,
            file: name,
            file_hash: ContentHash::of_bytes(text.text.as_bytes()).to_string(),
        }),
        ..Inputs::default()
    })
}
