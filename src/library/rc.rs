//! Column hinges from the RC submodel: bends of a section about both axes at several axial forces become one entry.

use super::entry::{
    Adjoining, AxisRecord, Branch, Computed, Entry, EnvelopeLevel, Features, Inputs, Origin, Quality,
    RcFeatures, Stiffness, Validity,
};
use super::key::key_of;
use super::mesh_check::{COARSER, MeshChange, asymmetry};
use super::rc_kinds;
use super::thin::thinned;
use crate::base::hash::ContentHash;
use crate::curve::{CurveError, Envelope, ResistanceCurve};
use crate::rc::bend::{BendError, Bent};
use crate::rc::member::Joint;
use crate::rc::pushover::torsion_constant;
use crate::rc::series::{self, Case, Series, SeriesError, concrete_of};
use crate::rc::{RcSection, SeriesOptions};
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Version of the RC submodel's procedure; part of every key, so that a change of procedure never reuses old curves.
pub const RC_SUBMODEL_VERSION: u32 = 4;
/// Axial forces of an entry over `f_c A`, compression positive.
pub const RC_AXIAL_SHARES: [f64; 5] = [-0.05, 0.0, 0.1, 0.3, 0.6];
/// Rotation at which the bends of an entry stop \[rad\].
pub const RC_UNTIL_RAD: f64 = 0.25;
/// Points that a stored envelope keeps.
const ENVELOPE_POINTS: usize = 40;
/// Share of the time that the bends in coarser elements take, for the progress only.
const CHECK_SHARE: f64 = 0.08;
/// Lengths in which a section counts as symmetric \[m\].
const SAME_M: f64 = 1e-6;

/// A section, described so that its entry can be looked up or computed.
#[derive(Debug, Clone)]
pub struct RcWanted {
    /// The section.
    pub section: RcSection,
    /// How it is bent; the directions are those that its symmetry leaves.
    pub options: SeriesOptions,
    /// Features of the entry.
    pub features: Features,
    /// Everything that it is computed from.
    pub inputs: Inputs,
    /// Whether the bends are run in coarser elements as well, for the entry's quality (not part of its key).
    pub check_mesh: bool,
}

/// Why an entry cannot be computed.
#[derive(Debug, thiserror::Error)]
pub enum RcDeriveError {
    /// The elements do not suit the section or the concrete.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// The bend without axial force is not asked for.
    #[error(
        "the axial shares lack 0, and without a level there an entry has no strength of its own: add it, as in `--axial -0.05 0 0.1`"
    )]
    NoRest,
    /// A bend failed that an entry cannot do without.
    #[error("axial share {share}, direction {direction_deg}°: {source}")]
    Bend {
        /// Axial force over `f_c A`.
        share: f64,
        /// Direction \[deg\].
        direction_deg: f64,
        /// Why.
        source: BendError,
    },
    /// The bend without axial force moves too fast.
    #[error("the bend without axial force in direction {direction_deg}° cannot be used: {why}")]
    NotStatic {
        /// Direction \[deg\].
        direction_deg: f64,
        /// Why.
        why: String,
    },
    /// The envelopes do not make a curve.
    #[error("the envelopes in direction {direction_deg}° make no resistance curve: {source}")]
    Curve {
        /// Direction \[deg\].
        direction_deg: f64,
        /// Why.
        source: CurveError,
    },
    /// The entry cannot be written as text.
    #[error("the entry cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// An entry, and the levels of axial force that it lacks.
#[derive(Debug, Clone)]
pub struct RcDerived {
    /// The entry.
    pub entry: Entry,
    /// Levels that were left out, and a check of the mesh that could not be made, in words.
    pub left_out: Vec<String>,
}

/// Which bends the symmetry of a section leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Symmetry {
    /// Both axes are alike.
    pub axes_alike: bool,
    /// Both senses along x and along y are alike.
    pub senses_alike: [bool; 2],
}

impl Symmetry {
    /// Symmetry of a section's sides, bars and ties.
    pub fn of(section: &RcSection) -> Self {
        let input = &section.input;
        let same_bars = |image: &dyn Fn([f64; 2]) -> [f64; 2]| {
            input.bars.iter().all(|b| {
                let [x, y] = image([b.x_m, b.y_m]);
                let near =
                    |c: &crate::building::Bar| (c.x_m - x).abs() < SAME_M && (c.y_m - y).abs() < SAME_M;
                input.bars.iter().any(|c| near(c) && (c.diameter_m - b.diameter_m).abs() < SAME_M)
            })
        };
        let [width, depth] = input.size_m;
        let legs_alike = input.ties.is_none_or(|t| t.legs[0] == t.legs[1]);
        Self {
            axes_alike: (width - depth).abs() < SAME_M && legs_alike && same_bars(&|[x, y]| [y, x]),
            senses_alike: [same_bars(&|[x, y]| [-x, y]), same_bars(&|[x, y]| [x, -y])],
        }
    }

    /// Directions to bend in \[deg\]: about axis 1 along y, about axis 2 along x.
    pub fn directions_deg(self) -> Vec<f64> {
        let mut directions = vec![90.0];
        if !self.senses_alike[1] {
            directions.push(270.0);
        }
        if !self.axes_alike {
            directions.push(0.0);
            if !self.senses_alike[0] {
                directions.push(180.0);
            }
        }
        directions
    }
}

impl RcWanted {
    /// Describes the entry of a section. The directions in `options` do not count; axial shares are sorted, and each counts once.
    ///
    /// # Errors
    /// If its inputs cannot be written as JSON.
    pub fn of(section: &RcSection, options: &SeriesOptions) -> Result<Self, serde_json::Error> {
        let directions_deg = rc_kinds::directions_deg(section, Symmetry::of(section).directions_deg());
        let mut options = SeriesOptions { directions_deg, ..options.clone() };
        options.axial_shares = in_order(&options.axial_shares);
        let input = &section.input;
        let rc = RcFeatures {
            concrete_strength_pa: Some(section.concrete.compressive_strength_pa),
            reinforcement_ratio: Some(section.steel_m2() / input.area_m2()),
            bar_yield_strength_pa: Some(input.steel.yield_strength_pa),
            tie_spacing_m: input.ties.map(|t| t.spacing_m),
            tie_diameter_m: input.ties.map(|t| t.diameter_m),
            tie_yield_strength_pa: input.ties.map(|t| t.yield_strength_pa),
        };
        let features = Features {
            width_m: input.size_m[0],
            depth_m: input.size_m[1],
            length_to_inflection_m: Some(section.length_m),
            end: None,
            adjoining: (options.joint == Joint::Block).then_some(Adjoining::Ground),
            law: None,
            mesh_size_m: Some(options.mesh_size_m),
            rc: Some(rc),
            further: BTreeMap::new(),
        };
        let features = rc_kinds::features(section, features);
        let mut materials = BTreeMap::from([
            ("concrete".to_string(), serde_json::to_value(concrete_of(section, &options))?),
            ("bars".to_string(), serde_json::to_value(input.steel)?),
        ]);
        if let Some(ties) = &input.ties {
            materials.insert("ties".to_string(), serde_json::to_value(ties)?);
        }
        let bars: Vec<Value> = input.bars.iter().map(|b| json!([b.x_m, b.y_m, b.diameter_m])).collect();
        let geometry = BTreeMap::from([
            ("width_m".to_string(), input.size_m[0]),
            ("depth_m".to_string(), input.size_m[1]),
            ("length_m".to_string(), section.length_m),
        ]);
        let mut settings = BTreeMap::from([
            ("bars_x_y_diameter_m".to_string(), json!(bars)),
            ("series".to_string(), serde_json::to_value(&options)?),
        ]);
        if let Some(anchorage) = &section.anchorage {
            settings.insert("anchorage".to_string(), serde_json::to_value(anchorage)?);
        }
        let inputs = Inputs {
            materials,
            geometry,
            settings,
            submodel_version: Some(RC_SUBMODEL_VERSION),
            ..Inputs::default()
        };
        Ok(Self { section: section.clone(), options, features, inputs, check_mesh: false })
    }

    /// The key that the entry has.
    ///
    /// # Errors
    /// If the inputs cannot be written as JSON.
    pub fn key(&self) -> Result<String, serde_json::Error> {
        Ok(key_of(rc_kinds::kind(&self.section), &self.features, &ContentHash::of_value(&self.inputs)?))
    }

    /// Computes the entry on the threads of the present pool. `progress` is told the share done and what is under way.
    ///
    /// Levels other than those without axial force may be left out: a tension that is not borne or makes no curve, a compression that crushes.
    ///
    /// # Errors
    /// If no bend without axial force is asked for, the concrete does not suit the mesh, or what is left makes no curve.
    pub fn derive(&self, progress: &(dyn Fn(f64, &str) + Sync)) -> Result<RcDerived, RcDeriveError> {
        if !self.options.axial_shares.contains(&0.0) {
            return Err(RcDeriveError::NoRest);
        }
        let own_share = if self.check_mesh { 1.0 - CHECK_SHARE } else { 1.0 };
        let series = series::run(&self.section, &self.options, &|s, text| progress(own_share * s, text))?;
        let (levels, mut left_out) = usable(&series)?;
        let axis = |direction_deg: f64| axis(&series, &levels, direction_deg);
        let first = self.axis_with_reverse(90.0, &axis)?;
        let mut axes = vec![first.clone()];
        if self.options.directions_deg.contains(&0.0) {
            axes.push(self.axis_with_reverse(0.0, &axis)?);
        } else if !rc_kinds::is_flat(&self.section) {
            axes.push(first);
        }
        let computed = Computed {
            axes,
            quality: self.quality(&series, &levels, progress, &mut left_out),
            validity: validity(&series, &levels),
            ..self.elastic_and_axial(&series)
        };
        let (features, inputs) = (self.features.clone(), self.inputs.clone());
        let computed = rc_kinds::scaled(&self.section, computed);
        let kind = rc_kinds::kind(&self.section);
        let entry = Entry::new(kind, Origin::RcSubmodel, features, inputs, computed)?;
        Ok(RcDerived { entry, left_out })
    }

    /// Quality of the curves; with the check of the mesh, if it is wanted and can be made.
    fn quality(
        &self,
        series: &Series,
        levels: &[f64],
        progress: &(dyn Fn(f64, &str) + Sync),
        left_out: &mut Vec<String>,
    ) -> Quality {
        let mut quality = quality(series, levels);
        if !self.check_mesh {
            return quality;
        }
        let mesh_size_m = COARSER * self.options.mesh_size_m;
        let coarse = SeriesOptions { mesh_size_m, ..self.options.clone() };
        let tell = |share: f64, text: &str| {
            progress(1.0 - CHECK_SHARE * (1.0 - share), &format!("in coarser elements, {text}"));
        };
        let other = series::run(&self.section, &coarse, &tell).map_err(|e| e.to_string());
        match other.and_then(|other| MeshChange::between(series, &other)) {
            Ok(change) => {
                quality.mesh_sensitivity = Some(change.peak);
                quality.mesh_sensitivity_rotation = change.rotation_80;
                quality.mesh_compared_m = Some(change.other_size_m);
            }
            Err(why) => left_out.push(format!("check of the mesh: {why}")),
        }
        quality
    }

    fn axis_with_reverse(
        &self,
        direction_deg: f64,
        axis: &impl Fn(f64) -> Result<AxisRecord, RcDeriveError>,
    ) -> Result<AxisRecord, RcDeriveError> {
        let mut record = axis(direction_deg)?;
        let opposite = direction_deg + 180.0;
        if self.options.directions_deg.contains(&opposite) {
            let AxisRecord { envelopes, curve, .. } = axis(opposite)?;
            record.reverse = Some(Branch { envelopes, curve });
        }
        Ok(record)
    }

    /// Stiffnesses of the uncracked concrete over the length; tension and compression of the section: bars alone at their ultimate
    /// strength and strain, `f_c (A - A_s) + f_y A_s`.
    fn elastic_and_axial(&self, series: &Series) -> Computed {
        let (concrete, input) = (&self.section.concrete, &self.section.input);
        let (e, steel, area) = (concrete.youngs_modulus_pa, self.section.steel_m2(), input.area_m2());
        let shear = 0.5 * e / (1.0 + concrete.poisson_ratio);
        let length = series.length_m;
        let bars = &input.steel;
        Computed {
            stiffness: Some(Stiffness {
                axial_n_m: e * area / length,
                shear_n_m: [shear * 5.0 / 6.0 * area / length; 2],
                torsion_nm_rad: shear * torsion_constant(input.size_m) / length,
            }),
            tensile_capacity_n: Some(steel * bars.monotonic_pa(bars.ultimate_strain)),
            tensile_elongation_m: Some(bars.ultimate_strain * length),
            compressive_capacity_n: Some(
                concrete.compressive_strength_pa * (area - steel) + bars.yield_strength_pa * steel,
            ),
            hinge_offset_m: Some(0.0),
            ..Computed::default()
        }
    }
}

/// Axial shares from the smallest on, each once; -0 is 0, which as a text of its own would make another key.
pub(super) fn in_order(shares: &[f64]) -> Vec<f64> {
    let mut shares: Vec<f64> = shares.iter().map(|s| s + 0.0).collect();
    shares.sort_by(f64::total_cmp);
    shares.dedup();
    shares
}

/// Points of a bend as an envelope: rotations increase.
fn points(bent: &Bent) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(bent.points.len());
    for [rotation, moment, _] in &bent.points {
        if points.last().is_none_or(|last| *rotation > last[0]) {
            points.push([*rotation, *moment]);
        }
    }
    points
}

/// Cases of a direction.
fn of_direction(series: &Series, direction_deg: f64) -> impl Iterator<Item = &Case> {
    series.cases.iter().filter(move |c| c.direction_deg == direction_deg)
}

/// Share of the fibre section's peak below which a push that broke off has not told the strength of its member.
const LEAST_OF_FIBRE: f64 = 0.5;

/// Why a push that broke off says nothing of the strength, in words.
pub fn no_strength(case: &Case) -> Option<String> {
    let bent = case.bent.as_ref().ok().filter(|b| b.failed() && case.hysteresis.is_none())?;
    let (peak_nm, fibre_nm) = (case.figures.map_or(0.0, |f| f.peak_nm), case.fibre_peak_nm?);
    (peak_nm < LEAST_OF_FIBRE * fibre_nm).then(|| {
        format!(
            "the push broke off at {:.3} mrad with at most {:.1} kN m, where the fibre section bears {:.1} kN m",
            1e3 * bent.points.last().map_or(0.0, |p| p[0]),
            peak_nm / 1e3,
            fibre_nm / 1e3
        )
    })
}

/// Rotation over the estimate of first yield up to which a push is followed at least.
const LEAST_OF_YIELD: f64 = 2.0;

/// Why a push that was stopped on its path tells a stiffness and no resistance, in words.
pub fn stopped_early(case: &Case) -> Option<String> {
    let bent = case.bent.as_ref().ok().filter(|b| !b.failed() && case.hysteresis.is_none())?;
    let (end, first) = (bent.points.last()?[0], case.figures?.yield_rotation_rad);
    (end < LEAST_OF_YIELD * first).then(|| {
        format!(
            "the push stops at {:.3} mrad, and a secant through it yields at {:.3} mrad: bend further (`--until`), to {LEAST_OF_YIELD} times the rotation of first yield at least",
            1e3 * end,
            1e3 * first
        )
    })
}

/// Axial shares that every direction bears and that make curves, and those left out in words.
fn usable(series: &Series) -> Result<(Vec<f64>, Vec<String>), RcDeriveError> {
    let (mut usable, mut left_out) = (Vec::new(), Vec::new());
    for share in &series.options.axial_shares {
        let mut fault = None;
        for case in series.cases.iter().filter(|c| c.axial_share == *share) {
            let direction_deg = case.direction_deg;
            match &case.bent {
                Err(error) if *share == 0.0 => {
                    return Err(RcDeriveError::Bend { share: *share, direction_deg, source: error.clone() });
                }
                Err(error) => fault = Some(error.to_string()),
                Ok(bent) => {
                    if let Some(why) =
                        case.fault().or_else(|| no_strength(case)).or_else(|| stopped_early(case))
                    {
                        if *share == 0.0 {
                            return Err(RcDeriveError::NotStatic { direction_deg, why });
                        }
                        fault = Some(why);
                        continue;
                    }
                    let alone = Envelope { axial_force_n: case.axial_n, points: points(bent) };
                    match ResistanceCurve::from_envelopes(&[alone]) {
                        Err(source) if *share == 0.0 => {
                            return Err(RcDeriveError::Curve { direction_deg, source });
                        }
                        Err(error) => fault = Some(error.to_string()),
                        Ok(_) => {}
                    }
                }
            }
        }
        match fault {
            None => usable.push(*share),
            Some(fault) => left_out.push(format!("axial share {share}: {fault}")),
        }
    }
    Ok((usable, left_out))
}

fn axis(series: &Series, levels: &[f64], direction_deg: f64) -> Result<AxisRecord, RcDeriveError> {
    let bends: Vec<(f64, &Bent)> = of_direction(series, direction_deg)
        .filter(|c| levels.contains(&c.axial_share))
        .filter_map(|c| Some((c.axial_n, c.bent.as_ref().ok()?)))
        .collect();
    let measured: Vec<Envelope> =
        bends.iter().map(|(n, bent)| Envelope { axial_force_n: *n, points: points(bent) }).collect();
    let curve = ResistanceCurve::from_envelopes(&measured)
        .map_err(|source| RcDeriveError::Curve { direction_deg, source })?;
    let level = |(envelope, (_, bent)): (&Envelope, &(f64, &Bent))| EnvelopeLevel {
        axial_force_n: envelope.axial_force_n,
        points: thinned(&envelope.points, ENVELOPE_POINTS),
        fracture_rotation_rad: bent.failed().then(|| envelope.points.last().map_or(0.0, |p| p[0])),
    };
    let envelopes = measured.iter().zip(&bends).map(level).collect();
    Ok(AxisRecord { envelopes, curve, reverse: None })
}

fn quality(series: &Series, levels: &[f64]) -> Quality {
    let used = series.cases.iter().filter(|c| levels.contains(&c.axial_share));
    let kinetic = used.filter_map(|c| c.bent.as_ref().ok()).map(|b| b.kinetic_share);
    Quality {
        kinetic_energy_ratio: Some(kinetic.fold(0.0, f64::max)),
        elements: Some(series.elements[0] as u64),
        asymmetry: asymmetry(series),
        shear_share: series.cases.iter().filter_map(|c| Some(c.shear?.share())).reduce(f64::max),
        ..Quality::default()
    }
}

fn validity(series: &Series, levels: &[f64]) -> Validity {
    let used = || series.cases.iter().filter(|c| levels.contains(&c.axial_share));
    let bends = || used().filter_map(|c| c.bent.as_ref().ok());
    let end = |bent: &Bent| bent.points.last().map(|p| p[0]);
    // behind a failure nothing is borne, which is known; if every bend failed, the last of them is the end
    let unbroken = bends().filter(|b| !b.failed()).filter_map(end).reduce(f64::min);
    let end = unbroken.or_else(|| bends().filter_map(end).reduce(f64::max));
    Validity {
        axial_force_n: [
            used().map(|c| c.axial_n).fold(f64::INFINITY, f64::min),
            used().map(|c| c.axial_n).fold(f64::NEG_INFINITY, f64::max),
        ],
        rotation_rad: end.map(|end| [0.0, end]),
        displacement_m: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rc::section_file::{EXAMPLE, read};

    fn wanted(axial_shares: &[f64]) -> RcWanted {
        let section = read(&crate::base::source::Source::new("section.toml", EXAMPLE)).unwrap();
        let options = SeriesOptions { axial_shares: axial_shares.to_vec(), ..SeriesOptions::default() };
        RcWanted::of(&section, &options).unwrap()
    }

    #[test]
    fn shares_that_are_named_twice_make_no_other_key() {
        let key = |shares: &[f64]| wanted(shares).key().unwrap();
        assert_eq!(key(&[0.0, 0.0, -0.0]), key(&[0.0]));
        assert_eq!(key(&[0.1, -0.0, 0.1, -0.05]), key(&[-0.05, 0.0, 0.1]));
        assert_ne!(key(&[0.0, 0.1]), key(&[0.0]));
    }
}
