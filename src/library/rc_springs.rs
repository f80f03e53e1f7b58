//! Springs from the RC submodel: curves of a piece of a member, shortened and pulled, sheared, twisted, or crushed against a rough face, become entries.
//!
//! A spring is that of the piece, whose length is the entry's: what is left of the member stands beside it in series, elastic. Contact is force over penetration of
//! the crushed end, with the energy that it takes.

use super::entry::{Computed, Direction, Entry, EntryKind, Features, Inputs, Origin, Quality};
use super::entry::{SpringLevel, SpringRecord, Validity};
use super::key::key_of;
use super::rc::{RcWanted, Symmetry, in_order};
use super::rc_kinds;
use super::thin::thinned;
use crate::base::hash::ContentHash;
use crate::building::MemberKind;
use crate::material::concrete::LawError;
use crate::rc::axial::piece_length_m;
use crate::rc::piece::Drive;
use crate::rc::springs::{self, SpringCase};
use crate::rc::{RcSection, SeriesOptions, SpringOptions, Springs};
use serde_json::json;

/// Version of the procedure of springs; part of every key.
pub const RC_SPRINGS_VERSION: u32 = 1;
/// Shortening of a crushed end over the length of its piece up to which it is followed.
const CONTACT_UNTIL: f64 = 0.3;
/// Points that a stored curve keeps.
const CURVE_POINTS: usize = 40;

/// A spring of a section, described so that its entry can be looked up or computed.
#[derive(Debug, Clone)]
pub struct RcSpringWanted {
    /// The section.
    pub section: RcSection,
    /// What the entry is.
    pub kind: EntryKind,
    /// The runs it is made of.
    pub runs: Vec<SpringOptions>,
    /// Features of the entry.
    pub features: Features,
    /// Everything that it is computed from.
    pub inputs: Inputs,
}

/// Why a spring cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum RcSpringError {
    /// The concrete does not suit the elements.
    #[error("{0}; use other elements (--mesh)")]
    Law(#[from] LawError),
    /// A run without axial force is not asked for.
    #[error(
        "the axial shares lack 0, and without a level there a spring has no strength of its own: add it, as in `--axial -0.05 0 0.1`"
    )]
    NoRest,
    /// A run failed that the entry cannot do without.
    #[error("{drive:?}, axial share {share}: {fault}")]
    Run {
        /// What was done.
        drive: Drive,
        /// Axial force over `f_c A`.
        share: f64,
        /// Why, in words.
        fault: String,
    },
    /// The entry cannot be written as text.
    #[error("the entry cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

impl RcSpringWanted {
    /// Describes the entry of a kind; `None` for kinds that are no springs, and for shear, torsion and contact of a strip of a slab. Mesh and law are those of
    /// `options`, axial shares as well where `shares` says so.
    ///
    /// # Errors
    /// If its inputs cannot be written as JSON.
    pub fn of(
        section: &RcSection,
        kind: EntryKind,
        options: &SeriesOptions,
        shares: Option<&[f64]>,
    ) -> Result<Option<Self>, serde_json::Error> {
        let is_strip = section.member == MemberKind::Slab;
        let drives: &[Drive] = match kind {
            EntryKind::AxialSpring => &[Drive::Tension, Drive::Crush],
            EntryKind::ShearSpring if !is_strip => &[Drive::Shear],
            EntryKind::TorsionSpring if !is_strip => &[Drive::Torsion],
            EntryKind::ContactCrushing if !is_strip => &[Drive::Crush],
            _ => return Ok(None),
        };
        let alike = Symmetry::of(section).axes_alike;
        let runs = drives.iter().map(|drive| {
            let mut run = SpringOptions {
                mesh_size_m: options.mesh_size_m,
                seed_law: options.seed_law,
                ..SpringOptions::of(*drive)
            };
            if let (Some(shares), Drive::Shear | Drive::Torsion) = (shares, drive) {
                run.axial_shares = shares.to_vec();
            }
            run.axial_shares = in_order(&run.axial_shares);
            if *drive == Drive::Shear {
                run.directions_deg = if alike { vec![90.0] } else { vec![0.0, 90.0] };
            }
            if kind == EntryKind::ContactCrushing {
                (run.rough, run.until) = (true, CONTACT_UNTIL);
            }
            run
        });
        let runs: Vec<SpringOptions> = runs.collect();
        let bending = RcWanted::of(section, options)?;
        let length_m = piece_length_m(section, runs[0].length_depths);
        let features =
            Features { length_to_inflection_m: Some(length_m), adjoining: None, ..bending.features };
        let mut inputs = bending.inputs;
        inputs.geometry.insert("length_m".to_string(), length_m);
        inputs.settings.remove("series");
        inputs.settings.insert("runs".to_string(), json!(runs));
        inputs.submodel_version = Some(RC_SPRINGS_VERSION);
        Ok(Some(Self { section: section.clone(), kind, runs, features, inputs }))
    }

    /// The key that the entry has.
    ///
    /// # Errors
    /// If the inputs cannot be written as JSON.
    pub fn key(&self) -> Result<String, serde_json::Error> {
        Ok(key_of(self.kind, &self.features, &ContentHash::of_value(&self.inputs)?))
    }

    /// Computes the entry on the threads of the present pool, and says which levels it lacks. `progress` is told the share done and what is under way.
    ///
    /// # Errors
    /// If the concrete does not suit the mesh, or a run without axial force is not asked for or cannot be used.
    pub fn derive(
        &self,
        progress: &(dyn Fn(f64, &str) + Sync),
    ) -> Result<(Entry, Vec<String>), RcSpringError> {
        if self.runs.iter().any(|run| !run.axial_shares.contains(&0.0)) {
            return Err(RcSpringError::NoRest);
        }
        let (mut all, mut left_out) = (Vec::new(), Vec::new());
        for (i, options) in self.runs.iter().enumerate() {
            let tell = |share: f64, text: &str| progress((i as f64 + share) / self.runs.len() as f64, text);
            let springs = springs::run(&self.section, options, &tell)?;
            left_out.extend(faults(&springs)?);
            all.push(springs);
        }
        let computed = rc_kinds::scaled(&self.section, self.computed(&all));
        let (features, inputs) = (self.features.clone(), self.inputs.clone());
        let entry = Entry::new(self.kind, Origin::RcSubmodel, features, inputs, computed)?;
        Ok((entry, left_out))
    }

    fn computed(&self, all: &[Springs]) -> Computed {
        let factor = rc_kinds::factor(&self.section);
        let mut records = match self.kind {
            EntryKind::AxialSpring => axial(&all[0], &all[1]),
            EntryKind::ShearSpring => {
                let along =
                    |direction| if all[0].options.directions_deg.len() > 1 { direction } else { 90.0 };
                vec![
                    record(Direction::Shear1, &all[0], along(0.0)),
                    record(Direction::Shear2, &all[0], along(90.0)),
                ]
            }
            EntryKind::TorsionSpring => vec![record(Direction::Torsion, &all[0], 90.0)],
            _ => vec![record(Direction::Normal, &all[0], 90.0)],
        };
        for level in records.iter_mut().flat_map(|r| &mut r.levels) {
            level.points.iter_mut().for_each(|p| p[1] *= factor);
            level.dissipated_j = level.dissipated_j.map(|j| j * factor);
        }
        records.iter_mut().for_each(|r| r.stiffness_n_m *= factor);
        let peak = |of: &Springs| of.cases[0].figures.map(|f| f.peak);
        let pulled = if self.kind == EntryKind::AxialSpring { all.first() } else { None };
        let pressed = all.last().filter(|s| s.options.drive == Drive::Crush);
        Computed {
            tensile_capacity_n: pulled.and_then(peak),
            tensile_elongation_m: pulled.and_then(|s| s.cases[0].figures).map(|f| f.peak_at),
            compressive_capacity_n: pressed.and_then(peak),
            quality: quality(all),
            validity: validity(all, &records),
            springs: records,
            ..Computed::default()
        }
    }
}

/// Levels that cannot be used, in words.
fn faults(springs: &Springs) -> Result<Vec<String>, RcSpringError> {
    let mut left_out = Vec::new();
    for case in &springs.cases {
        let (drive, share) = (springs.options.drive, case.axial_share);
        match case.fault() {
            Some(fault) if share == 0.0 => return Err(RcSpringError::Run { drive, share, fault }),
            Some(fault) => left_out.push(format!("{drive:?}, axial share {share}: {fault}")),
            None => {}
        }
    }
    Ok(left_out)
}

/// Displacements that increase.
fn points(case: &SpringCase) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for p in case.run.iter().flat_map(|r| &r.points) {
        if points.last().is_none_or(|last| p.at > last[0]) {
            points.push([p.at, p.force]);
        }
    }
    thinned(&points, CURVE_POINTS)
}

/// The secant to half of the peak.
fn secant(points: &[[f64; 2]]) -> f64 {
    let half = 0.5 * points.iter().map(|p| p[1]).fold(0.0, f64::max);
    let at = points.iter().position(|p| p[1] >= half && p[0] > 0.0);
    at.map_or(f64::MIN_POSITIVE, |i| points[i][1] / points[i][0])
}

fn level(case: &SpringCase) -> Option<SpringLevel> {
    let run = case.run.as_ref().ok()?;
    let points = points(case);
    let last = run.points.last()?;
    Some(SpringLevel {
        axial_force_n: case.axial_n,
        fracture_displacement_m: run.failed.then_some(points.last()?[0]),
        points,
        dissipated_j: Some(last.energy_j[0] + last.energy_j[1]),
    })
}

fn record(direction: Direction, springs: &Springs, direction_deg: f64) -> SpringRecord {
    let own = |c: &&SpringCase| c.direction_deg == direction_deg && c.fault().is_none();
    let levels: Vec<SpringLevel> = springs.cases.iter().filter(own).filter_map(level).collect();
    let first = levels.iter().find(|l| l.axial_force_n == 0.0).or(levels.first());
    SpringRecord { direction, stiffness_n_m: first.map_or(0.0, |l| secant(&l.points)), levels }
}

/// From the largest elongation to the largest shortening.
fn axial(pulled: &Springs, pressed: &Springs) -> Vec<SpringRecord> {
    let mut record = record(Direction::Axial, pressed, 90.0);
    if let Some(level) = record.levels.first_mut() {
        let mut line: Vec<[f64; 2]> = points(&pulled.cases[0]).iter().map(|p| [-p[0], -p[1]]).collect();
        line.reverse();
        line.pop();
        line.extend(level.points.iter().copied());
        level.points = line;
        level.dissipated_j = None;
    }
    vec![record]
}

fn quality(all: &[Springs]) -> Quality {
    let runs = all.iter().flat_map(|s| &s.cases).filter_map(|c| c.run.as_ref().ok());
    Quality {
        kinetic_energy_ratio: Some(runs.map(|r| r.kinetic_share).fold(0.0, f64::max)),
        elements: all.first().map(|s| s.elements[0] as u64),
        ..Quality::default()
    }
}

fn validity(all: &[Springs], records: &[SpringRecord]) -> Validity {
    let levels = || records.iter().flat_map(|r| &r.levels);
    let ends = |pick: fn(&SpringLevel) -> Option<&[f64; 2]>| levels().filter_map(move |l| Some(pick(l)?[0]));
    let low = ends(|l| l.points.first()).fold(f64::INFINITY, f64::min);
    let high = ends(|l| l.points.last()).fold(f64::INFINITY, f64::min);
    let turns = all.iter().any(|s| s.options.drive == Drive::Torsion);
    Validity {
        axial_force_n: [
            levels().map(|l| l.axial_force_n).fold(f64::INFINITY, f64::min),
            levels().map(|l| l.axial_force_n).fold(f64::NEG_INFINITY, f64::max),
        ],
        rotation_rad: turns.then_some([low, high]),
        displacement_m: (!turns).then_some([low, high]),
    }
}
