//! Reading and checking a model file. Every complaint names its place as a JSON path.

mod connection;
mod contact;
mod event;
mod event_rule;
mod latent;
mod shared;

use super::math::{self, M3};
use super::model::{Body, Force, MODEL_SCHEMA, Model};
use super::run::MOST_STEPS;
use crate::base::json::{self, JsonError};
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Why a model file is not accepted.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The file cannot be read.
    #[error("cannot read {path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// The cause.
        source: std::io::Error,
    },
    /// The file is not a model in JSON.
    #[error("{path}: {source}")]
    Parse {
        /// The file.
        path: PathBuf,
        /// The cause, with its place.
        source: JsonError,
    },
    /// The file is something else than a model.
    #[error("{path}: {what}")]
    NoModel {
        /// The file.
        path: PathBuf,
        /// What it is, and what to do.
        what: &'static str,
    },
    /// A value is wrong; all complaints at once.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Invalid(Vec<Complaint>),
}

/// One wrong value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Complaint {
    /// JSON path, such as `bodies[3].mass_kg`.
    pub path: String,
    /// The value and what would be right.
    pub message: String,
}

impl std::fmt::Display for Complaint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.path, self.message)
    }
}

/// The version of a file.
#[derive(serde::Deserialize)]
struct Version {
    schema: Option<String>,
}

/// How far axes and quaternions may be from orthonormal (files carry rounded numbers).
const ORTHONORMAL_TOLERANCE: f64 = 1e-6;

impl Model {
    /// Reads and checks a model file.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ModelError::Read { path: path.to_owned(), source })?;
        if let Some(what) = something_else(&text) {
            return Err(ModelError::NoModel { path: path.to_owned(), what });
        }
        // a file of another version is told so, not that its keys are unknown; what is no JSON at all is told with the keys of a model
        let schema = json::from_text(&text).ok().and_then(|version: Version| version.schema);
        if let Some(found) = schema.filter(|s| s != MODEL_SCHEMA) {
            let mut list = List::default();
            list.add(
                "schema".into(),
                format!("is \"{found}\", expected \"{MODEL_SCHEMA}\" (docs/formats.md says what changed)"),
            );
            return Err(ModelError::Invalid(list.0));
        }
        let model: Self =
            json::from_text(&text).map_err(|source| ModelError::Parse { path: path.to_owned(), source })?;
        model.check()?;
        Ok(model)
    }

    /// Checks every number and reference; returns all complaints at once.
    pub fn check(&self) -> Result<(), ModelError> {
        self.check_with(true)
    }

    /// The same where the curves are known to be right.
    pub(super) fn check_varied(&self) -> Result<(), ModelError> {
        self.check_with(false)
    }

    fn check_with(&self, curves: bool) -> Result<(), ModelError> {
        let mut list = List::default();
        list.require(self.schema == MODEL_SCHEMA, "schema", || {
            format!("is \"{}\", expected \"{MODEL_SCHEMA}\"", self.schema)
        });
        list.finite("gravity_m_s2", &self.gravity_m_s2);
        list.within("gravity_m_s2", &self.gravity_m_s2, MOST_M_S2, "m/s²");
        list.require(!self.bodies.is_empty(), "bodies", || "is empty, expected at least one body".into());
        list.unique("bodies", self.bodies.iter().map(|b| b.id.as_str()));
        one_name_each(self, &mut list);
        list.unique("events", self.events.iter().map(|e| e.id.as_str()));
        list.unique("tracked", self.tracked.iter().map(|t| t.id.as_str()));
        for (i, body) in self.bodies.iter().enumerate() {
            check_body(body, &format!("bodies[{i}]"), &mut list);
        }
        for (id, curve) in self.curves.iter().filter(|_| curves) {
            list.named("curves", id);
            if let Err(error) = curve.check() {
                list.add(format!("curves.{id}"), error.to_string());
            }
        }
        let known: BTreeSet<&str> = self.bodies.iter().map(|b| b.id.as_str()).collect();
        connection::check(self, &known, &mut list);
        contact::check(self, &known, &mut list);
        event::check_events(self, &known, &mut list);
        latent::check(self, &mut list);
        event_rule::check(self, &known, &mut list);
        shared::check(self, &mut list);
        for (i, point) in self.tracked.iter().enumerate() {
            list.known(&known, &point.body, &format!("tracked[{i}].body"));
            list.place(&format!("tracked[{i}].point_m"), &point.point_m);
        }
        check_settings(self, &mut list);
        if list.0.is_empty() { Ok(()) } else { Err(ModelError::Invalid(list.0)) }
    }
}

/// Times, steps and tolerances that can be run, and what only some models know.
fn check_settings(model: &Model, list: &mut List) {
    let s = &model.settings;
    list.positive("settings.end_time_s", s.end_time_s);
    list.within("settings.end_time_s", &[s.end_time_s], MOST_S, "s");
    list.positive("settings.output_interval_s", s.output_interval_s);
    let outputs = s.end_time_s / s.output_interval_s;
    list.require(outputs.is_nan() || outputs <= MOST_OUTPUTS, "settings.output_interval_s", || {
        format!(
            "makes {outputs:.1e} outputs until settings.end_time_s = {}, at most {MOST_OUTPUTS:.0e}: outputs farther apart, or an earlier end",
            s.end_time_s
        )
    });
    if let Some(h) = s.time_step_s {
        list.positive("settings.time_step_s", h);
        let (span, until) = match s.end_time_s >= s.output_interval_s {
            true => (s.end_time_s, "settings.end_time_s"),
            false => (s.output_interval_s, "settings.output_interval_s"),
        };
        list.require(h <= 0.0 || (span / h).is_nan() || span / h < MOST_STEPS, "settings.time_step_s", || {
            format!(
                "is {h:e}, with which {until} = {span} takes {:.1e} steps, at most {MOST_STEPS:.0e}: longer steps, or leave it out to have it chosen",
                span / h
            )
        });
    }
    list.positive("settings.tolerance", s.tolerance);
    let is_above = s.tolerance <= 0.0 || s.tolerance.is_nan() || s.tolerance >= LEAST_TOLERANCE;
    list.require(is_above, "settings.tolerance", || {
        format!(
            "is {:e}, expected at least {LEAST_TOLERANCE:e}: numbers have sixteen digits, and no step is nearer than that",
            s.tolerance
        )
    });
    list.require(s.tolerance <= MOST_TOLERANCE || s.tolerance.is_nan(), "settings.tolerance", || {
        format!("is {}, expected at most {MOST_TOLERANCE}: it is the error that a step may have", s.tolerance)
    });
    list.require(!s.preload || !model.is_ideal(), "settings.preload", || {
        "is true, which is for models without ideal joints and forces: set it to false, the run begins in the poses of the file".into()
    });
    if let Some(v) = s.sleep_speed_m_s {
        list.positive("settings.sleep_speed_m_s", v);
        list.without_ideal(model, "settings.sleep_speed_m_s");
    }
    if let Some(v) = s.relative_inertia_rad_s {
        list.require(v >= LEAST_RELATED_RAD_S, "settings.relative_inertia_rad_s", || {
            format!("is {v}, expected at least {LEAST_RELATED_RAD_S} rad/s: what moves at a fifth of it, as floors do, is 2 % too slow already")
        });
        list.without_ideal(model, "settings.relative_inertia_rad_s");
    }
    if let Some(v) = s.soft_after_m {
        list.positive("settings.soft_after_m", v);
        list.without_ideal(model, "settings.soft_after_m");
    }
}

/// What a text is that neither is a model nor fails as one.
fn something_else(text: &str) -> Option<&'static str> {
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'))?;
    let is_name = |word: &str| {
        word.starts_with(|c: char| c.is_ascii_alphabetic())
            && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    let key = first.split_once('=').map(|(key, _)| key.trim());
    let table = first.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    if key.is_some_and(is_name) || table.is_some_and(|name| is_name(name.trim_matches(['[', ']']))) {
        return Some(
            "is TOML, as building files are, expected a model in JSON: `fallwerk generate-mbs` makes the model.json of a building",
        );
    }
    first.starts_with('[').then_some(
        "is a list, expected the keys of a model, {\"schema\": ...}: see \"Multibody model\" in docs/formats.md",
    )
}

/// Least bound of all frequencies by inertia against relative motion \[rad/s\].
const LEAST_RELATED_RAD_S: f64 = 200.0;
/// Most outputs of a run: all of them are kept until its end.
const MOST_OUTPUTS: f64 = 1e6;
/// Magnitudes beyond which a number is a slip: an end \[s\], a coordinate \[m\], a speed \[m/s, rad/s\], a mass \[kg\], a principal inertia \[kg m²\], gravity \[m/s²\].
const MOST_S: f64 = 1e9;
const MOST_M: f64 = 1e9;
const MOST_SPEED: f64 = 1e8;
const MOST_KG: f64 = 1e15;
const LEAST_KG: f64 = 1e-12;
const MOST_KG_M2: f64 = 1e24;
const LEAST_KG_M2: f64 = 1e-20;
const MOST_M_S2: f64 = 1e6;
/// Largest error of a step with ideal joints that may be asked for.
const MOST_TOLERANCE: f64 = 0.1;
/// Smallest one: a share of each number, of which round-off is 1.1e-16.
const LEAST_TOLERANCE: f64 = 1e-14;

/// What an event can release or weaken has a name of its own among joints, bushings and forces: events and results tell them apart by nothing else.
fn one_name_each(model: &Model, list: &mut List) {
    let joints = model.joints.iter().map(|j| j.id.as_str()).enumerate().map(|of| ("joints", of));
    let bushings = model.bushings.iter().map(|b| b.id.as_str()).enumerate().map(|of| ("bushings", of));
    let forces = model.forces.iter().map(Force::id).enumerate().map(|of| ("forces", of));
    let mut taken: BTreeMap<&str, (&str, usize)> = BTreeMap::new();
    for (kind, (i, id)) in joints.chain(bushings).chain(forces) {
        list.named(&format!("{kind}[{i}].id"), id);
        match taken.entry(id) {
            Entry::Vacant(place) => {
                place.insert((kind, i));
            }
            Entry::Occupied(first) => {
                let (of, place) = first.get();
                list.add(
                    format!("{kind}[{i}].id"),
                    format!("\"{id}\" is also the id of {of}[{place}]: give one of them another id"),
                );
            }
        }
    }
}

fn check_body(body: &Body, path: &str, list: &mut List) {
    let mass = body.mass_kg;
    list.positive(&format!("{path}.mass_kg"), mass);
    list.within(&format!("{path}.mass_kg"), &[mass], MOST_KG, "kg");
    list.require(mass <= 0.0 || mass.is_nan() || mass >= LEAST_KG, &format!("{path}.mass_kg"), || {
        format!("is {mass:e}, expected at least {LEAST_KG:e} kg: beside it nothing else is left of a sum")
    });
    for (name, values, most, unit) in [
        ("position_m", &body.position_m, MOST_M, "m"),
        ("velocity_m_s", &body.velocity_m_s, MOST_SPEED, "m/s"),
        ("angular_velocity_rad_s", &body.angular_velocity_rad_s, MOST_SPEED, "rad/s"),
    ] {
        list.finite(&format!("{path}.{name}"), values);
        list.within(&format!("{path}.{name}"), values, most, unit);
    }
    let length = math::qnorm(body.orientation);
    list.require((length - 1.0).abs() <= ORTHONORMAL_TOLERANCE, &format!("{path}.orientation"), || {
        format!("has length {length}, expected a unit quaternion [w, x, y, z]")
    });
    if let Some(complaint) = inertia_complaint(&body.inertia_kg_m2) {
        list.add(format!("{path}.inertia_kg_m2"), complaint);
    }
    for (k, shape) in body.shapes.iter().enumerate() {
        contact::check_shape(shape, &format!("{path}.shapes[{k}]"), list);
    }
}

/// How a tensor is not symmetric, beyond the rounding of a program that turned it.
fn asymmetry(m: &M3) -> Option<String> {
    let size = m.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    let mut pairs = [[1, 0], [2, 0], [2, 1]].into_iter();
    let [i, j] = pairs.find(|[i, j]| (m[*i][*j] - m[*j][*i]).abs() > 1e-9 * size)?;
    Some(format!("is not symmetric: [{j}][{i}] is {:e} and [{i}][{j}] is {:e}", m[j][i], m[i][j]))
}

/// What is wrong with an inertia tensor: symmetry, definiteness, triangle inequality.
fn inertia_complaint(m: &M3) -> Option<String> {
    if m.iter().flatten().any(|v| !v.is_finite()) {
        return Some(format!("is {m:?}, expected finite numbers"));
    }
    if let Some(complaint) = asymmetry(m) {
        return Some(complaint);
    }
    let matrix = nalgebra::Matrix3::from_fn(|i, j| 0.5 * (m[i][j] + m[j][i]));
    let mut p: [f64; 3] = matrix.symmetric_eigenvalues().into();
    p.sort_by(f64::total_cmp);
    if p[0] <= 0.0 {
        return Some(format!("is not positive definite: its smallest principal value is {:.6e} kg m²", p[0]));
    }
    if p[0] < LEAST_KG_M2 || p[2] > MOST_KG_M2 {
        return Some(format!(
            "has principal values from {:e} to {:e}, expected {LEAST_KG_M2:e} to {MOST_KG_M2:e} kg m²: a slip of the exponent or the unit?",
            p[0], p[2]
        ));
    }
    (p[2] > (p[0] + p[1]) * (1.0 + 1e-6)).then(|| {
        format!(
            "violates the triangle inequality: principal values {:.6e}, {:.6e}, {:.6e} kg m², and no mass distribution has I3 > I1 + I2",
            p[0], p[1], p[2]
        )
    })
}

fn orthonormality_error(axes: &M3) -> f64 {
    let mut worst = 0.0_f64;
    for i in 0..3 {
        for j in 0..=i {
            let off = (math::dot(axes[i], axes[j]) - f64::from(u8::from(i == j))).abs();
            worst = if off.is_nan() { f64::INFINITY } else { worst.max(off) };
        }
    }
    if worst.is_finite() && math::det(axes) < 0.0 { 2.0 } else { worst }
}

fn closest<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> String {
    known
        .map(|k| (strsim::damerau_levenshtein(word, k), k))
        .filter(|(distance, k)| *distance <= 2.max(k.len() / 4))
        .min()
        .map(|(_, k)| format!(" (did you mean \"{k}\"?)"))
        .unwrap_or_default()
}

#[derive(Default)]
struct List(Vec<Complaint>);

impl List {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn add(&mut self, path: String, message: String) {
        self.0.push(Complaint { path, message });
    }
    fn require(&mut self, ok: bool, path: &str, message: impl FnOnce() -> String) {
        if !ok {
            self.add(path.into(), message());
        }
    }
    fn finite(&mut self, path: &str, values: &[f64]) {
        self.require(values.iter().all(|v| v.is_finite()), path, || {
            format!("is {values:?}, expected finite numbers")
        });
    }
    /// A point in space.
    fn place(&mut self, path: &str, point_m: &[f64; 3]) {
        self.finite(path, point_m);
        self.within(path, point_m, MOST_M, "m");
    }
    fn positive(&mut self, path: &str, value: f64) {
        self.require(value > 0.0 && value.is_finite(), path, || {
            format!("is {value}, expected a positive number")
        });
    }
    /// The exponent `p` of a rate factor.
    fn rate_exponent(&mut self, path: &str, value: f64) {
        self.require((1.0..=20.0).contains(&value), path, || format!("is {value}, expected 1 to 20"));
    }
    /// Finite numbers of a magnitude that can be meant.
    fn within(&mut self, path: &str, values: &[f64], most: f64, unit: &str) {
        let largest = values.iter().map(|v| v.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
        self.require(largest <= most, path, || {
            format!("is {largest:e}, expected at most {most:e} {unit}: a slip of the exponent or the unit?")
        });
    }
    fn not_negative(&mut self, path: &str, value: f64) {
        self.require(value >= 0.0 && value.is_finite(), path, || {
            format!("is {value}, expected a finite number of at least zero")
        });
    }
    fn known(&mut self, known: &BTreeSet<&str>, id: &str, path: &str) {
        self.among(known, id, path, "a body");
    }
    fn among(&mut self, known: &BTreeSet<&str>, id: &str, path: &str, what: &str) {
        self.require(known.contains(id), path, || {
            format!("\"{id}\" is not the id of {what}{}", closest(id, known.iter().copied()))
        });
    }
    fn named(&mut self, path: &str, id: &str) {
        self.require(!id.trim().is_empty(), path, || format!("is \"{id}\", expected a name"));
    }
    fn unique<'a>(&mut self, path: &str, ids: impl Iterator<Item = &'a str>) {
        let mut seen = BTreeSet::new();
        for (i, id) in ids.enumerate() {
            self.named(&format!("{path}[{i}].id"), id);
            self.require(seen.insert(id), &format!("{path}[{i}].id"), || format!("\"{id}\" is used twice"));
        }
    }
}
