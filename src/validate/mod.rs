//! Error measures of an MBS run, and of a hybrid run, against an FE run of the same building, and the verdict.

pub mod heap;
pub mod hybrid;
pub mod left_out;
pub mod measure;
pub mod points;
pub mod record;
pub mod spread;
pub mod undecided;

pub use hybrid::HybridValidation;
pub use left_out::LeftOut;
pub use points::DebrisPoint;
pub use spread::Spread;
pub use undecided::{Doubt, Undecided};

use crate::building::{Building, MemberKind};
use crate::fe::result::FeRun;
use crate::mbs::Model;
use crate::mbs::result::{EventKind, RunResult};
pub use crate::study::fell;
use crate::study::{COLLAPSE_DROP_M, Facts, TURNED_RAD};
use heap::Heap;
use measure::{LEAST_MOVED_M, Sites};
use points::PointErrors;
use serde::{Deserialize, Serialize};

/// Version of `validation.json`.
pub const VALIDATION_SCHEMA: u32 = 1;
/// Plastic rotation from which a hinge counts as a found site \[rad\].
pub const ACTIVE_ROTATION_RAD: f64 = TURNED_RAD;
/// Largest error up to the first contact at which the model counts as agreeing.
pub const LIMIT_TO_CONTACT: f64 = 0.10;
/// Largest distance of both runs' displacements at which the model of a structure that stands in both counts as agreeing whatever its relative error: a twentieth of the fall that
/// counts as a collapse \[m\]. Such a structure deflects by millimetres, and bodies that are rigid by rule leave out the bending of beams and slabs.
pub const LIMIT_STANDING_M: f64 = 0.05 * COLLAPSE_DROP_M;
/// Largest relative difference of the first contact times.
pub const LIMIT_CONTACT_TIME: f64 = 0.05;
/// Largest energy error of either run.
pub const LIMIT_ENERGY: f64 = 0.02;
/// Smallest ratio of FE to MBS processor time.
pub const LIMIT_SPEED: f64 = 300.0;

/// Error over the whole run that an MBS run of a building that falls should keep, contact included, and that where an obstacle is in its way. Told, and not part of the agreement: after contact small differences grow
/// quickly.
pub const LIMIT_TOTAL: [f64; 2] = [0.15, 0.20];
/// Overlap of the debris footprints that it should reach.
pub const LIMIT_FOOTPRINT: f64 = 0.8;
/// Largest error over the whole run of a hybrid run.
pub const LIMIT_HYBRID: f64 = 0.05;
/// Largest share of the FE run's processor time that a hybrid run may take.
pub const LIMIT_HYBRID_TIME: f64 = 0.5;

/// A figure for each run.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Both<T> {
    /// Of the FE run.
    pub fe: T,
    /// Of the MBS run.
    pub mbs: T,
}

/// One member end in both runs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SiteComparison {
    /// Member end id.
    pub id: String,
    /// Whether the FE run shows a zone above the critical strain rate.
    pub fe_zone: bool,
    /// Whether the end turns by more than [`TURNED_RAD`] before the first contact, in FE and in the MBS, each before its own; `None`: FE does not tell.
    pub turns_before_contact: Option<Both<bool>>,
    /// The same over the whole run.
    pub turns: Option<Both<bool>>,
    /// Whether the MBS model has a hinge there, also one that stands in the middle of its beam.
    pub hinge: bool,
    /// Largest plastic rotation of that hinge \[rad\].
    pub plastic_rotation_rad: f64,
    /// First yield of that hinge \[s\].
    pub yield_s: Option<f64>,
    /// Fracture of that hinge \[s\].
    pub fracture_s: Option<f64>,
}

/// What the comparison of both runs shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Validation {
    /// Always [`VALIDATION_SCHEMA`].
    pub schema: u32,
    /// Name of the building.
    pub building: String,
    /// Error up to the first ground contact of the FE run, or to the end if there is none; `None`: no tracked point is in both runs.
    pub e_to_contact: Option<f64>,
    /// Error from that contact to the end, of displacements from the preloaded state ([`measure::error_after`]); `None`: nothing touches the ground, or at the end only.
    pub e_after_contact: Option<f64>,
    /// Error over the whole run.
    pub e_total: Option<f64>,
    /// The same over the tracked points that are not in `debris`; `None`: there are none.
    pub e_total_without_debris: Option<f64>,
    /// Tracked points that become debris in the FE run. They count in all other errors.
    pub debris: Vec<DebrisPoint>,
    /// Whether an obstacle stands in the scene.
    pub has_obstacle: bool,
    /// Largest displacement of a tracked point \[m\].
    pub largest_displacement_m: Both<f64>,
    /// Largest distance between both runs' displacements of a tracked point \[m\].
    pub largest_difference_m: f64,
    /// First ground contact \[s\].
    pub first_contact_s: Both<Option<f64>>,
    /// Hinges that turned plastically by more than [`ACTIVE_ROTATION_RAD`] against FE zones, whole run.
    pub hinges: Sites,
    /// Ends that turn by more than [`TURNED_RAD`] before the first contact, MBS against FE.
    pub turning_before_contact: Sites,
    /// The same over the whole run.
    pub turning: Sites,
    /// Column ends with an FE zone where the MBS has no hinge, or one that did not turn plastically.
    pub missed_column_ends: Vec<String>,
    /// Whether the structure collapsed.
    pub collapsed: Both<bool>,
    /// Why the comparison does not tell whether the MBS agrees, if it does not.
    #[serde(default)]
    pub undecided: Vec<Undecided>,
    /// Energy error of each run.
    pub energy_error: Both<f64>,
    /// Energy dissipated by the end: internal, hourglass and contact work in FE, plastic and contact work in the MBS \[J\].
    pub dissipated_j: Both<f64>,
    /// Area of the common debris footprint over that of the union at the end.
    pub footprint_overlap: f64,
    /// Processor time \[s\].
    pub cpu_s: Both<f64>,
    /// Wall time \[s\].
    pub wall_s: Both<f64>,
    /// FE over MBS processor time.
    pub speed_ratio: f64,
    /// `e(T)` at the output times.
    pub e_curve: Vec<f64>,
    /// `e(T)` over the tracked points that are not in `debris`.
    pub e_curve_without_debris: Vec<f64>,
    /// Output times \[s\].
    pub times_s: Vec<f64>,
    /// Member ends.
    pub sites: Vec<SiteComparison>,
    /// The hybrid run against FE, if there was one.
    pub hybrid: Option<HybridValidation>,
    /// What the runs left out.
    #[serde(default)]
    pub left_out: Vec<LeftOut>,
    /// How far MBS runs come apart that differ by next to nothing.
    #[serde(default)]
    pub spread: Option<Spread>,
}

impl Validation {
    /// Compares an MBS run with an FE run of the same building. `mbs_wall_s` is the wall time of the MBS run \[s\].
    pub fn of(
        building: &Building,
        fe: &FeRun,
        facts: &Facts,
        model: &Model,
        mbs: &RunResult,
        mbs_wall_s: f64,
    ) -> Self {
        let history = |id: &str| mbs.tracked.iter().find(|m| m.id == id).map(|m| &m.displacement_m[..]);
        let errors = PointErrors::of(&fe.times_s, &fe.tracked, mbs.times_s.len(), history);
        let pairs = &errors.pairs;
        let sites = compare_sites(facts, model, mbs);
        let collapsed =
            Both { fe: facts.collapsed, mbs: mbs.tracked.iter().any(|t| fell(&t.displacement_m)) };
        let e = &mbs.energies;
        let last = |v: &[f64]| v.last().copied().unwrap_or(0.0);
        Self {
            schema: VALIDATION_SCHEMA,
            building: building.name.clone(),
            e_to_contact: errors.until(facts.first_contact_s),
            e_after_contact: errors.after(facts.first_contact_s),
            e_total: errors.until(None),
            e_total_without_debris: errors.without_debris(),
            debris: points::debris(fe),
            has_obstacle: !building.obstacles.is_empty(),
            largest_displacement_m: Both {
                fe: largest(pairs.iter().flat_map(|(_, fe)| fe.iter().copied())),
                mbs: largest(pairs.iter().flat_map(|(mbs, _)| mbs.iter().copied())),
            },
            largest_difference_m: largest(pairs.iter().flat_map(|(mbs, fe)| {
                mbs.iter().zip(fe.iter()).map(|(m, f)| std::array::from_fn(|i| m[i] - f[i]))
            })),
            first_contact_s: Both { fe: facts.first_contact_s, mbs: mbs.first_ground_contact_s },
            hinges: Sites::of(
                sites.iter().map(|s| (s.fe_zone, s.plastic_rotation_rad > ACTIVE_ROTATION_RAD)),
            ),
            turning_before_contact: turning(&sites, |s| s.turns_before_contact),
            turning: turning(&sites, |s| s.turns),
            missed_column_ends: missed_column_ends(building, facts, &sites),
            collapsed,
            undecided: undecided::reasons(building, (fe, mbs), &errors, [collapsed.fe, collapsed.mbs]),
            energy_error: Both { fe: fe.summary.energy_error, mbs: mbs.energy_error },
            dissipated_j: Both {
                fe: fe_dissipated_j(fe),
                mbs: last(&e.plastic_j) + last(&e.contact_damping_j) + last(&e.friction_j),
            },
            footprint_overlap: Heap::of_fe(fe).footprint.overlap(&Heap::of_mbs(model, mbs).footprint),
            cpu_s: Both { fe: fe.summary.elapsed.cpu_s, mbs: mbs.cpu_s },
            wall_s: Both { fe: fe.summary.elapsed.wall_s, mbs: mbs_wall_s },
            speed_ratio: fe.summary.elapsed.cpu_s / mbs.cpu_s.max(1e-9),
            e_curve: errors.curve,
            e_curve_without_debris: errors.curve_without_debris,
            times_s: errors.times_s,
            sites,
            hybrid: None,
            left_out: left_out::of_fe(fe).into_iter().chain(left_out::of_mbs(mbs)).collect(),
            spread: None,
        }
    }

    /// Adds the run with rigid parts.
    pub fn add_hybrid(&mut self, fe: &FeRun, run: &FeRun) {
        self.hybrid = Some(HybridValidation::of(fe, run));
        self.left_out.extend(left_out::of_fe(run));
        self.left_out.sort_by_key(|l| l.run);
    }

    /// Difference of the first contact times over that of FE; `None` where only one of them touches or neither does.
    pub fn contact_time_error(&self) -> Option<f64> {
        let (fe, mbs) = (self.first_contact_s.fe?, self.first_contact_s.mbs?);
        Some((mbs - fe).abs() / fe)
    }

    /// The error over the whole run that is aimed at ([`LIMIT_TOTAL`]).
    pub fn limit_total(&self) -> f64 {
        LIMIT_TOTAL[usize::from(self.has_obstacle)]
    }

    /// Whether the structure stands in both runs.
    pub fn stands(&self) -> bool {
        !self.collapsed.fe && !self.collapsed.mbs
    }

    /// Whether the FE run is at rest throughout, so that no error is relative to it.
    pub fn fe_rests(&self) -> bool {
        self.largest_displacement_m.fe < LEAST_MOVED_M
    }

    /// Whether the displacements agree: by their relative error, or where the structure stands in both runs by their distance; by that alone if FE is at rest.
    pub fn displacements_agree(&self) -> bool {
        self.e_to_contact.is_some_and(|e| {
            !self.fe_rests() && e <= LIMIT_TO_CONTACT
                || self.stands() && self.largest_difference_m <= LIMIT_STANDING_M
        })
    }

    /// Whether the runs end before they tell whether the building collapses.
    pub fn ends_early(&self) -> bool {
        self.undecided.iter().any(|u| u.kind != Doubt::NothingCompared)
    }

    /// Whether both runs tell the same story up to the first contact within the limits of this module; `None`: they do not tell. What a longer run could still change breaks no limit.
    pub fn agreement(&self) -> Option<bool> {
        let early = self.ends_early();
        let contact = match self.first_contact_s {
            Both { fe: None, mbs: None } => true,
            Both { fe: Some(_), mbs: Some(_) } => {
                self.contact_time_error().is_some_and(|e| e <= LIMIT_CONTACT_TIME)
            }
            _ => early,
        };
        let holds = (self.e_to_contact.is_none() || self.displacements_agree())
            && contact
            && (early || self.collapsed.fe == self.collapsed.mbs)
            && self.energy_error.fe <= LIMIT_ENERGY
            && self.energy_error.mbs <= LIMIT_ENERGY;
        (!holds || self.undecided.is_empty()).then_some(holds)
    }

    /// Whether they do, as far as that can be told.
    pub fn agrees(&self) -> bool {
        self.agreement() == Some(true)
    }
}

/// Length of the largest of vectors \[m\].
fn largest(vectors: impl Iterator<Item = [f64; 3]>) -> f64 {
    vectors.map(|u| u.iter().map(|c| c * c).sum::<f64>().sqrt()).fold(0.0, f64::max)
}

/// FE zones at column ends that no active hinge answers.
fn missed_column_ends(building: &Building, facts: &Facts, sites: &[SiteComparison]) -> Vec<String> {
    let is_column = |member: &str| building.member(member).is_some_and(|m| m.kind == MemberKind::Column);
    let columns = facts.ends.iter().zip(sites).filter(|(zone, _)| is_column(&zone.member));
    columns
        .filter(|(_, site)| site.fe_zone && site.plastic_rotation_rad <= ACTIVE_ROTATION_RAD)
        .map(|(_, site)| site.id.clone())
        .collect()
}

/// Energy that an FE run has dissipated by its end, elastic energy included \[J\].
fn fe_dissipated_j(run: &FeRun) -> f64 {
    let end = run.energies.last().copied().unwrap_or_default();
    end.internal_j + end.hourglass_j + end.viscous_j - end.contact_j - end.friction_j
}

/// Member ends of both runs.
fn compare_sites(facts: &Facts, model: &Model, mbs: &RunResult) -> Vec<SiteComparison> {
    let first = |joint: &str, fracture: bool| {
        mbs.events.iter().find_map(|e| match &e.kind {
            EventKind::Yield { joint: j } if j == joint && !fracture => Some(e.time_s),
            EventKind::Fracture { joint: j, .. } if j == joint && fracture => Some(e.time_s),
            _ => None,
        })
    };
    let contact_s = mbs.first_ground_contact_s.unwrap_or(f64::INFINITY);
    facts
        .ends
        .iter()
        .map(|zone| {
            let turned = mbs.hinges.iter().find(|h| h.joint == zone.id);
            let turns = |until_s: f64| {
                let outputs = mbs.times_s.partition_point(|t| *t <= until_s);
                let rotations = turned.into_iter().flat_map(|h| h.rotation_rad.iter().take(outputs));
                rotations.map(|[a, b]| libm::hypot(*a, *b)).fold(0.0, f64::max) > TURNED_RAD
            };
            let both = |fe: Option<bool>, until_s: f64| Some(Both { fe: fe?, mbs: turns(until_s) });
            SiteComparison {
                turns_before_contact: both(zone.turns_before(facts.first_contact_s), contact_s),
                turns: both(zone.turns(), f64::INFINITY),
                id: zone.id.clone(),
                fe_zone: zone.first_s.is_some(),
                hinge: model.bushings.iter().any(|j| j.names().contains(&zone.id)),
                plastic_rotation_rad: turned
                    .map_or(0.0, |h| h.plastic_rotation_rad.iter().copied().fold(0.0, f64::max)),
                yield_s: first(&zone.id, false),
                fracture_s: first(&zone.id, true),
            }
        })
        .collect()
}

/// Ends that turn in the MBS against those that turn in FE, where FE tells.
fn turning(sites: &[SiteComparison], of: impl Fn(&SiteComparison) -> Option<Both<bool>>) -> Sites {
    Sites::of(sites.iter().filter_map(of).map(|both| (both.fe, both.mbs)))
}
