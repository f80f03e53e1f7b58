//! Reading and checking a model file. Every complaint names its place as a JSON path.

use super::math::{self, M3};
use super::model::{Bending, Body, Joint, MODEL_SCHEMA, Model};
use std::collections::BTreeSet;
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
        /// The cause, with line and column.
        source: serde_json::Error,
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

/// How far axes and quaternions may be from orthonormal (files carry rounded numbers).
const ORTHONORMAL_TOLERANCE: f64 = 1e-6;

impl Model {
    /// Reads and checks a model file.
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ModelError::Read { path: path.to_owned(), source })?;
        let model: Self = serde_json::from_str(&text)
            .map_err(|source| ModelError::Parse { path: path.to_owned(), source })?;
        model.check()?;
        Ok(model)
    }

    /// Checks every number and reference; returns all complaints at once.
    pub fn check(&self) -> Result<(), ModelError> {
        let mut list = List::default();
        list.require(self.schema == MODEL_SCHEMA, "schema", || {
            format!("is \"{}\", expected \"{MODEL_SCHEMA}\"", self.schema)
        });
        list.finite("gravity_m_s2", &self.gravity_m_s2);
        list.require(!self.bodies.is_empty(), "bodies", || "is empty, expected at least one body".into());
        list.unique("bodies", self.bodies.iter().map(|b| b.id.as_str()));
        list.unique("joints", self.joints.iter().map(|j| j.id.as_str()));
        list.unique("events", self.events.iter().map(|e| e.id.as_str()));
        list.unique("tracked", self.tracked.iter().map(|t| t.id.as_str()));
        list.unique("contact.obstacles", self.contact.obstacles.iter().map(|o| o.id.as_str()));
        for (i, body) in self.bodies.iter().enumerate() {
            check_body(body, &format!("bodies[{i}]"), &mut list);
        }
        for (id, curve) in &self.curves {
            if let Err(error) = curve.check() {
                list.add(format!("curves.{id}"), error.to_string());
            }
        }
        let known: BTreeSet<&str> = self.bodies.iter().map(|b| b.id.as_str()).collect();
        for (i, joint) in self.joints.iter().enumerate() {
            self.check_joint(joint, &format!("joints[{i}]"), &known, &mut list);
        }
        self.check_contact(&mut list);
        for (i, event) in self.events.iter().enumerate() {
            list.require(
                event.time_s >= 0.0 && event.time_s.is_finite(),
                &format!("events[{i}].time_s"),
                || format!("is {}, expected a finite time of at least zero", event.time_s),
            );
            for (k, id) in event.remove_bodies.iter().enumerate() {
                list.known(&known, id, &format!("events[{i}].remove_bodies[{k}]"));
            }
        }
        for (i, point) in self.tracked.iter().enumerate() {
            list.known(&known, &point.body, &format!("tracked[{i}].body"));
            list.finite(&format!("tracked[{i}].point_m"), &point.point_m);
        }
        let s = &self.settings;
        list.positive("settings.end_time_s", s.end_time_s);
        list.positive("settings.output_interval_s", s.output_interval_s);
        if let Some(h) = s.time_step_s {
            list.positive("settings.time_step_s", h);
        }
        if list.0.is_empty() { Ok(()) } else { Err(ModelError::Invalid(list.0)) }
    }

    fn check_joint(&self, joint: &Joint, path: &str, known: &BTreeSet<&str>, list: &mut List) {
        if let Some(a) = &joint.body_a {
            list.known(known, a, &format!("{path}.body_a"));
            list.require(*a != joint.body_b, &format!("{path}.body_b"), || {
                format!("is \"{a}\", the same as body_a; expected two different bodies")
            });
        }
        list.known(known, &joint.body_b, &format!("{path}.body_b"));
        list.finite(&format!("{path}.point_m"), &joint.point_m);
        let off = orthonormality_error(&joint.axes);
        list.require(off <= ORTHONORMAL_TOLERANCE, &format!("{path}.axes"), || {
            format!("rows are not orthonormal and right-handed (off by {off:.1e}, allowed {ORTHONORMAL_TOLERANCE:.0e})")
        });
        list.not_negative(&format!("{path}.axial_stiffness_n_m"), joint.axial_stiffness_n_m);
        for k in 0..2 {
            list.not_negative(&format!("{path}.shear_stiffness_n_m[{k}]"), joint.shear_stiffness_n_m[k]);
            let at = format!("{path}.bending[{k}]");
            match &joint.bending[k] {
                Bending::Elastic { stiffness_nm_rad } => {
                    list.not_negative(&format!("{at}.stiffness_nm_rad"), *stiffness_nm_rad);
                }
                Bending::Curve { curve, strength_factor } => {
                    list.require(self.curves.contains_key(curve), &format!("{at}.curve"), || {
                        format!(
                            "\"{curve}\" is not in curves{}",
                            closest(curve, self.curves.keys().map(String::as_str))
                        )
                    });
                    list.positive(&format!("{at}.strength_factor"), *strength_factor);
                }
            }
        }
        list.not_negative(&format!("{path}.torsional_stiffness_nm_rad"), joint.torsional_stiffness_nm_rad);
        if let Some(t) = joint.tensile_elongation_m {
            list.not_negative(&format!("{path}.tensile_elongation_m"), t);
        }
        if let Some(t) = joint.tensile_capacity_n {
            list.not_negative(&format!("{path}.tensile_capacity_n"), t);
        }
        if let Some(c) = joint.compressive_capacity_n {
            list.positive(&format!("{path}.compressive_capacity_n"), c);
        }
    }

    fn check_contact(&self, list: &mut List) {
        if let Some(ground) = &self.contact.ground {
            list.finite("contact.ground.level_m", &[ground.level_m]);
            list.not_negative("contact.ground.friction", ground.friction);
        }
        if let Some(bodies) = &self.contact.bodies {
            list.not_negative("contact.bodies.friction", bodies.friction);
        }
        for (i, o) in self.contact.obstacles.iter().enumerate() {
            let path = format!("contact.obstacles[{i}]");
            list.not_negative(&format!("{path}.friction"), o.friction);
            list.finite(&format!("{path}.min_m"), &o.min_m);
            list.finite(&format!("{path}.max_m"), &o.max_m);
            list.require((0..3).all(|k| o.max_m[k] > o.min_m[k]), &format!("{path}.max_m"), || {
                format!("is {:?}, expected above min_m {:?} in every direction", o.max_m, o.min_m)
            });
        }
    }
}

fn check_body(body: &Body, path: &str, list: &mut List) {
    list.positive(&format!("{path}.mass_kg"), body.mass_kg);
    list.finite(&format!("{path}.position_m"), &body.position_m);
    list.finite(&format!("{path}.velocity_m_s"), &body.velocity_m_s);
    list.finite(&format!("{path}.angular_velocity_rad_s"), &body.angular_velocity_rad_s);
    let length = body.orientation.iter().map(|v| v * v).sum::<f64>().sqrt();
    list.require((length - 1.0).abs() <= ORTHONORMAL_TOLERANCE, &format!("{path}.orientation"), || {
        format!("has length {length}, expected a unit quaternion [w, x, y, z]")
    });
    if let Some(complaint) = inertia_complaint(&body.inertia_kg_m2) {
        list.add(format!("{path}.inertia_kg_m2"), complaint);
    }
    for (k, shape) in body.shapes.iter().enumerate() {
        list.finite(&format!("{path}.shapes[{k}].center_m"), &shape.center_m);
        for (axis, half) in shape.half_extents_m.iter().enumerate() {
            list.positive(&format!("{path}.shapes[{k}].half_extents_m[{axis}]"), *half);
        }
    }
}

/// What is wrong with an inertia tensor: symmetry, definiteness, triangle inequality.
fn inertia_complaint(m: &M3) -> Option<String> {
    if m.iter().flatten().any(|v| !v.is_finite()) {
        return Some(format!("is {m:?}, expected finite numbers"));
    }
    let size = m.iter().flatten().fold(0.0_f64, |a, v| a.max(v.abs()));
    if (0..3).any(|i| (0..i).any(|j| (m[i][j] - m[j][i]).abs() > 1e-9 * size)) {
        return Some("is not symmetric".into());
    }
    let matrix = nalgebra::Matrix3::from_fn(|i, j| 0.5 * (m[i][j] + m[j][i]));
    let mut p: [f64; 3] = matrix.symmetric_eigenvalues().into();
    p.sort_by(f64::total_cmp);
    if p[0] <= 0.0 {
        return Some(format!("is not positive definite: its smallest principal value is {:.6e} kg m²", p[0]));
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
    fn positive(&mut self, path: &str, value: f64) {
        self.require(value > 0.0 && value.is_finite(), path, || {
            format!("is {value}, expected a positive number")
        });
    }
    fn not_negative(&mut self, path: &str, value: f64) {
        self.require(value >= 0.0 && value.is_finite(), path, || {
            format!("is {value}, expected a finite number of at least zero")
        });
    }
    fn known(&mut self, known: &BTreeSet<&str>, id: &str, path: &str) {
        self.require(known.contains(id), path, || {
            format!("\"{id}\" is not the id of a body{}", closest(id, known.iter().copied()))
        });
    }
    fn unique<'a>(&mut self, path: &str, ids: impl Iterator<Item = &'a str>) {
        let mut seen = BTreeSet::new();
        for (i, id) in ids.enumerate() {
            self.require(seen.insert(id), &format!("{path}[{i}].id"), || format!("\"{id}\" is used twice"));
        }
    }
}
