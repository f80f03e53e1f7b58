//! What the report is made of: plain data, filled by the caller.
//!
//! The report computes nothing about the structure. It shows what it is given, derives only
//! differences and extremes for the reader, and says "–" where a figure is missing. All numbers are
//! SI (m, kg, s, N, J, rad); the page chooses readable prefixes. Histories may contain NaN: it is drawn
//! as a gap. Every list may be empty; its section then says so or is left out.

use super::partition::PartitionView;
use super::plan::{BlastingPlan, DebrisPlan};
use super::scene_input::Scene;
use crate::base::vector::norm;

/// Everything one report shows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReportInput {
    /// Title of the page, e.g. "MBS against FE".
    pub title: String,
    /// Name of the building.
    pub building_name: String,
    /// One paragraph about the building and its demolition plan.
    pub building_description: String,
    /// Name and version of the program that made the runs.
    pub program_version: String,
    /// Whether there is the MBS run and nothing that it is compared with: the page then has no place for FE.
    pub mbs_alone: bool,
    /// Whether the building stands in all runs: headings then speak of no collapse.
    pub stands: bool,
    /// The overall verdict.
    pub verdict: Verdict,
    /// The checks behind the verdict, in order of importance.
    pub checks: Vec<Check>,
    /// All runs beside each other.
    pub compared: Vec<ComparedRun>,
    /// What there is to say about them.
    pub compared_notes: Vec<String>,
    /// Settings of the comparison: name, value with unit.
    pub settings: Vec<Setting>,
    /// Times of the first ground contact.
    pub first_contact: FirstContact,
    /// Displacement histories of the tracked points.
    pub histories: Vec<History>,
    /// The error measure e(T).
    pub error: Option<ErrorMeasure>,
    /// How far a structure is apart that stands in both runs; `None`: it falls in one of them, or nobody knows yet.
    pub standing: Option<Standing>,
    /// Member ends and other sections at which a hinge may form.
    pub hinge_sites: Vec<HingeSite>,
    /// Plastic rotation from which a hinge counts as yielded \[rad\]; `None`: any.
    pub counted_rotation_rad: Option<f64>,
    /// Energy balance of the FE run.
    pub fe_energy: Option<FeEnergy>,
    /// Energy balance of the MBS run.
    pub mbs_energy: Option<MbsEnergy>,
    /// Cost of the FE run.
    pub fe_run: Option<RunCost>,
    /// Cost of the hybrid run.
    pub hybrid_run: Option<RunCost>,
    /// Cost of the MBS run.
    pub mbs_run: Option<RunCost>,
    /// What the runs left out.
    pub left_out: Vec<LeftOutRow>,
    /// What is to be said about that.
    pub left_out_note: Option<String>,
    /// Decisions of the model worth a look.
    pub review: ReviewSummary,
    /// The generated model.
    pub model: ModelSummary,
    /// Resistance curves used by the hinges.
    pub curves: Vec<CurveFamily>,
    /// Warnings and notes, worst first.
    pub notes: Vec<Note>,
    /// What happened when.
    pub events: Vec<TimedEvent>,
    /// The 3D scene of the runs.
    pub scene: Option<Scene>,
    /// Rigid and deforming parts over time.
    pub partition: Option<PartitionView>,
    /// The charges with their times.
    pub blasting: Option<BlastingPlan>,
    /// Where the debris lies.
    pub debris: Option<DebrisPlan>,
}

/// One run in the table that compares all with FE; `None`: does not apply, such as the error of FE against itself.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ComparedRun {
    /// Name of the run.
    pub name: String,
    /// Error e up to the first contact.
    pub until_contact: Option<f64>,
    /// Error e from the first contact to the end.
    pub after_contact: Option<f64>,
    /// Error e up to the end.
    pub until_end: Option<f64>,
    /// The same without points that become debris in the FE run.
    pub without_debris: Option<f64>,
    /// First ground contact \[s\].
    pub first_contact_s: Option<f64>,
    /// Processor time over all threads \[s\].
    pub cpu_s: Option<f64>,
    /// Processor time over that of FE.
    pub cpu_share: Option<f64>,
    /// Energy error of the run.
    pub energy_error: Option<f64>,
    /// Area of the debris footprint common with FE over that of the union.
    pub footprint_overlap: Option<f64>,
}

/// Outcome of a check.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Status {
    /// Within its limit.
    Pass,
    /// Outside its limit.
    Fail,
    /// Could not be decided.
    #[default]
    Unknown,
}

/// The verdict in the head of the page.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Verdict {
    /// One sentence, e.g. "MBS agrees with FE up to first contact: e = 0.04".
    pub headline: String,
    /// Overall status.
    pub status: Status,
    /// One or two sentences of reservation or explanation.
    pub detail: String,
}

/// One check of the verdict.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Check {
    /// What is checked.
    pub label: String,
    /// Measured value with unit, as text.
    pub value: String,
    /// Limit with unit, as text, e.g. "≤ 0.10".
    pub limit: String,
    /// Outcome.
    pub status: Status,
    /// What the figure means and what follows from it.
    pub explanation: String,
}

/// One line of the settings table.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Setting {
    /// Name.
    pub name: String,
    /// Value with unit, as text.
    pub value: String,
}

/// Times of the first contact with the ground \[s\]; `None`: no contact.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct FirstContact {
    /// In the FE run.
    pub fe_s: Option<f64>,
    /// In the MBS run.
    pub mbs_s: Option<f64>,
}

/// Displacement of one tracked point from the preloaded state, global axes, z up.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct History {
    /// Name of the point, e.g. "column C1, storey 3, top".
    pub point: String,
    /// Times \[s\], increasing.
    pub time_s: Vec<f64>,
    /// FE displacement \[m\], as many as times; empty on the page of the MBS alone.
    pub fe_m: Vec<[f64; 3]>,
    /// MBS displacement \[m\], as many as times.
    pub mbs_m: Vec<[f64; 3]>,
    /// Displacement in the hybrid run \[m\], as many as times; empty: no such run.
    pub hybrid_m: Vec<[f64; 3]>,
    /// Time from which the point is free debris in the FE run \[s\].
    pub debris_s: Option<f64>,
}

impl History {
    /// Largest displacement in the MBS run \[m\], and when it was reached first \[s\].
    pub fn largest_of_mbs(&self) -> Option<(f64, f64)> {
        let sizes = self.time_s.iter().zip(&self.mbs_m).map(|(t, u)| (norm(*u), *t));
        sizes.filter(|x| x.0.is_finite()).reduce(|best, x| if best.0 >= x.0 { best } else { x })
    }
}

/// The relative displacement error over all tracked points,
/// `e(T) = sqrt(Σ_p ∫_0^T |u_mbs − u_fe|² dt / Σ_p ∫_0^T |u_fe|² dt)`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ErrorMeasure {
    /// Times T \[s\], increasing.
    pub time_s: Vec<f64>,
    /// e(T) over all T, dimensionless, as many as times.
    pub e: Vec<f64>,
    /// The same without points that become debris in the FE run; empty: there are none.
    pub without_debris: Vec<f64>,
    /// e(T) of the hybrid run; empty: no such run.
    pub hybrid: Vec<f64>,
    /// The same without points that become debris in the FE run; empty: there are none.
    pub hybrid_without_debris: Vec<f64>,
    /// End of the first phase (first ground contact of either run) \[s\].
    pub contact_s: Option<f64>,
    /// e up to the first contact.
    pub until_contact: Option<f64>,
    /// e up to the end.
    pub until_end: Option<f64>,
    /// Largest accepted e up to the first contact.
    pub limit_until_contact: Option<f64>,
    /// Largest accepted e up to the end.
    pub limit_until_end: Option<f64>,
}

/// Displacements of a structure that stands in both runs.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Standing {
    /// Largest distance between both runs' displacements of a tracked point \[m\].
    pub apart_m: f64,
    /// Largest accepted distance \[m\].
    pub limit_m: f64,
    /// Largest displacement of a tracked point in FE and in the MBS \[m\].
    pub largest_m: [f64; 2],
}

/// A section at which a hinge may form: what FE shows and what the MBS has.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct HingeSite {
    /// Member end, e.g. "C1/2 top".
    pub member_end: String,
    /// Place in the initial state \[m\].
    pub point_m: [f64; 3],
    /// MBS body that carries the marker in the 3D view; without one the nearest body does.
    pub body: Option<String>,
    /// When a charge takes that body away, and the site with it \[s\]; `None`: never.
    pub removed_s: Option<f64>,
    /// Whether FE shows a zone of accumulated damage here; `None`: not evaluated.
    pub fe_zone: Option<bool>,
    /// First time the zone exceeds the critical strain rate \[s\].
    pub fe_first_s: Option<f64>,
    /// Peak strain rate \[1/s\].
    pub fe_peak_strain_rate_1_s: Option<f64>,
    /// Largest equivalent plastic strain.
    pub fe_max_plastic_strain: Option<f64>,
    /// Whether the MBS has a hinge (placed or latent) here.
    pub mbs_hinge: bool,
    /// Whether that is latent: no hinge until it goes live.
    pub mbs_latent: bool,
    /// When it does \[s\]; `None`: never.
    pub mbs_live_s: Option<f64>,
    /// First time the hinge yields \[s\]; `None`: it stayed elastic, or turned too little to count.
    pub mbs_yielded_s: Option<f64>,
    /// First time that a hinge yields which turns too little to count as yielded \[s\].
    pub mbs_slight_s: Option<f64>,
    /// Largest accumulated plastic rotation \[rad\].
    pub mbs_max_plastic_rotation_rad: Option<f64>,
    /// Time at which the hinge separates \[s\].
    pub mbs_fractured_s: Option<f64>,
}

/// Energies of the FE run \[J\]. Each list is empty (not recorded) or as long as `time_s`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct FeEnergy {
    /// Times \[s\], increasing.
    pub time_s: Vec<f64>,
    /// Kinetic energy.
    pub kinetic_j: Vec<f64>,
    /// Internal energy (elastic and plastic work).
    pub internal_j: Vec<f64>,
    /// Work of the hourglass stabilisation.
    pub hourglass_j: Vec<f64>,
    /// Contact penalty energy and friction work.
    pub contact_j: Vec<f64>,
    /// Work of external forces (gravity), and what removed and dying elements add.
    pub external_work_j: Vec<f64>,
    /// Part of `internal_j` in elements that have eroded.
    pub eroded_j: Vec<f64>,
    /// What the balance does not close.
    pub residual_j: Vec<f64>,
    /// Largest residual over the energy turned over, as the checks have it; `None`: not known.
    pub error: Option<f64>,
}

/// Energies of the MBS run \[J\]. Each list is empty (not recorded) or as long as `time_s`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MbsEnergy {
    /// Times \[s\], increasing.
    pub time_s: Vec<f64>,
    /// Kinetic energy.
    pub kinetic_j: Vec<f64>,
    /// Potential energy of gravity.
    pub potential_j: Vec<f64>,
    /// Elastic energy of joints and springs.
    pub elastic_j: Vec<f64>,
    /// Plastic work of hinges.
    pub plastic_j: Vec<f64>,
    /// Contact and friction work.
    pub contact_j: Vec<f64>,
    /// What the balance does not close.
    pub residual_j: Vec<f64>,
    /// Largest residual over the energy turned over, as the checks have it; `None`: not known.
    pub error: Option<f64>,
}

/// What a run cost.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunCost {
    /// CPU time over all threads \[s\].
    pub cpu_s: Option<f64>,
    /// Wall time \[s\].
    pub wall_s: Option<f64>,
    /// Time steps.
    pub steps: Option<u64>,
    /// Mean step size \[s\].
    pub step_s: Option<f64>,
    /// Elements (FE) or bodies (MBS).
    pub parts: Option<u64>,
    /// Degrees of freedom.
    pub dofs: Option<u64>,
    /// Threads used.
    pub threads: Option<u64>,
}

/// Something that a run left out.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LeftOutRow {
    /// Name of the run.
    pub run: String,
    /// What was left out, in words.
    pub what: String,
    /// How much of it.
    pub left_out: u64,
    /// How much there would have been.
    pub of: u64,
    /// In what that is counted, e.g. "elements × steps".
    pub unit: String,
    /// The command and option that computes it after all; `None`: there is none.
    pub computed_by: Option<String>,
}

/// The generated MBS model in tables.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ModelSummary {
    /// Bodies.
    pub bodies: Vec<BodyRow>,
    /// Joints.
    pub joints: Vec<JointRow>,
    /// Library entries used.
    pub entries: Vec<EntryRow>,
    /// Rules that fired.
    pub rules: Vec<RuleRow>,
    /// Rules about contacts and fractures that the run asks.
    pub event_rules: Vec<EventRuleRow>,
    /// Which rule made which part, and why.
    pub trace: Vec<TraceRow>,
}

/// Decisions worth a look, in their order.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReviewSummary {
    /// Runs with a decision turned round.
    pub runs: usize,
    /// Most such runs that were allowed; zero: none was asked for.
    pub most_runs: usize,
    /// The decisions.
    pub rows: Vec<ReviewRow>,
}

/// A decision worth a look.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReviewRow {
    /// Member ends or members; empty: the model as a whole.
    pub about: Vec<String>,
    /// What is decided, and by what.
    pub decision: String,
    /// Why it is worth a look.
    pub why: String,
    /// What could be decided otherwise.
    pub otherwise: String,
    /// What that changes, or why it was not tried.
    pub change: String,
    /// Whether the change counts; `None`: not tried.
    pub counts: Option<bool>,
}

/// One body.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodyRow {
    /// Body id.
    pub id: String,
    /// Mass \[kg\].
    pub mass_kg: f64,
    /// Members it stands for.
    pub members: Vec<String>,
}

/// One joint.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct JointRow {
    /// Joint id.
    pub id: String,
    /// What it joins, e.g. "C1/2 – S1".
    pub joins: String,
    /// Kind, e.g. "hinge", "elastic", "latent".
    pub kind: String,
    /// Curve ids about its two bending axes.
    pub curves: Vec<String>,
}

/// One library entry.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EntryRow {
    /// Key.
    pub key: String,
    /// What it describes.
    pub description: String,
    /// How often it is used in the model.
    pub uses: u64,
}

/// One rule.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RuleRow {
    /// Rule id.
    pub id: String,
    /// What the rule says.
    pub text: String,
    /// How often it fired.
    pub fired: u64,
    /// Whether it was used outside the range of its evidence.
    pub out_of_range: bool,
}

/// One rule about contacts and fractures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EventRuleRow {
    /// Its id in the model.
    pub id: String,
    /// What the rule says.
    pub text: String,
    /// Members that it is about.
    pub about: Vec<String>,
    /// What is left of its condition for the run.
    pub remains: String,
    /// What it then changes.
    pub then: String,
    /// When it fired in the run, in words.
    pub fired: String,
}

/// Why a part of the model is there.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TraceRow {
    /// Part of the model (body, joint, contact, curve).
    pub part: String,
    /// Rule id.
    pub rule: String,
    /// The reason in words.
    pub words: String,
    /// Library entries used.
    pub entries: Vec<String>,
}

/// A resistance curve: moment over rotation at several axial forces.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CurveFamily {
    /// Curve id.
    pub id: String,
    /// What it describes, e.g. "column 0.40 x 0.40 m, bending about x".
    pub description: String,
    /// One curve an axial force.
    pub levels: Vec<CurveLevel>,
}

/// One curve of a family.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CurveLevel {
    /// Axial force, compression positive \[N\].
    pub axial_force_n: f64,
    /// `[rotation (rad), moment (N m)]`.
    pub points: Vec<[f64; 2]>,
    /// Rotation at which the section separates \[rad\].
    pub fracture_rotation_rad: Option<f64>,
}

/// How much a note matters.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Severity {
    /// For information.
    #[default]
    Note,
    /// To be looked at by the analyst.
    Warning,
}

/// A warning or a note.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Note {
    /// Severity.
    pub severity: Severity,
    /// Text.
    pub text: String,
}

/// Something that happened at a time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TimedEvent {
    /// Time \[s\].
    pub time_s: f64,
    /// In which run, e.g. "FE", "MBS", "both".
    pub run: String,
    /// What happened.
    pub what: String,
}
