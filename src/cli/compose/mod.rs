//! From building, model, both runs and their comparison to the input of the report.
//!
//! The report knows no solver and no building model; here its plain data are filled.

pub mod compared;
mod events;
mod left_out;
mod marks;
mod model;
mod partition;
mod plan;
mod scene;

pub use events::words as event_words;
pub use model::entry_words;

use self::scene::removed_s;
use super::verdict;
use crate::building::Building;
use crate::fe::result::FeRun;
use crate::generate::Generated;
use crate::mbs::RunResult;
use crate::mbs::latent::live_s;
use crate::mbs::result::EventKind;
use crate::mbs::run::OFF_BALANCE;
use crate::report::{
    ErrorMeasure, FeEnergy, FirstContact, HingeSite, History, MbsEnergy, Note, ReportInput, RunCost, Setting,
    Severity, Standing,
};
use crate::review::Review;
use crate::study::Facts;
use crate::validate::{
    ACTIVE_ROTATION_RAD, LIMIT_ENERGY, LIMIT_STANDING_M, LIMIT_TO_CONTACT, SiteComparison, Validation,
};

/// Everything that a report is made of.
pub struct Pieces<'a> {
    /// The building.
    pub building: &'a Building,
    /// The generated model with its reasons.
    pub generated: &'a Generated,
    /// Its decisions worth a look.
    pub review: &'a Review,
    /// The FE run.
    pub fe: &'a FeRun,
    /// The FE run with rigid parts, if there was one.
    pub hybrid: Option<&'a FeRun>,
    /// The facts of the FE run.
    pub facts: &'a Facts,
    /// The MBS run; its `cpu_s` is what the report shows.
    pub mbs: &'a RunResult,
    /// The comparison.
    pub validation: &'a Validation,
    /// Threads of the FE run.
    pub threads: usize,
    /// Runs of the MBS over which its run time is the median.
    pub mbs_runs: usize,
}

impl Pieces<'_> {
    /// Number of output times that all runs have.
    fn outputs(&self) -> usize {
        let hybrid = self.hybrid.map_or(usize::MAX, |run| run.times_s.len());
        self.fe.times_s.len().min(self.mbs.times_s.len()).min(hybrid)
    }
}

/// The input of the report.
pub fn report_input(p: &Pieces) -> ReportInput {
    let v = p.validation;
    let sites = hinge_sites(p);
    // The second line of the error is drawn where there is debris only: elsewhere it is the first.
    let without_debris = |curve: &Vec<f64>| if v.debris.is_empty() { Vec::new() } else { curve.clone() };
    ReportInput {
        title: if p.hybrid.is_some() { "FE, hybrid and MBS" } else { "MBS against FE" }.into(),
        building_name: p.building.name.clone(),
        building_description: p.building.description.clone(),
        program_version: format!("fallwerk {}", env!("CARGO_PKG_VERSION")),
        verdict: verdict::verdict(v),
        checks: verdict::checks(v),
        compared: compared::runs(v),
        compared_notes: compared::notes(v),
        settings: settings(p),
        first_contact: FirstContact { fe_s: v.first_contact_s.fe, mbs_s: v.first_contact_s.mbs },
        histories: histories(p),
        error: v.e_total.map(|_| ErrorMeasure {
            time_s: v.times_s.clone(),
            e: v.e_curve.clone(),
            without_debris: without_debris(&v.e_curve_without_debris),
            hybrid: v.hybrid.as_ref().map_or(Vec::new(), |h| h.e_curve.clone()),
            hybrid_without_debris: v
                .hybrid
                .as_ref()
                .map_or(Vec::new(), |h| without_debris(&h.e_curve_without_debris)),
            contact_s: v.first_contact_s.fe,
            until_contact: v.e_to_contact,
            until_end: v.e_total,
            limit_until_contact: Some(LIMIT_TO_CONTACT),
            limit_until_end: None,
        }),
        standing: standing(v),
        fe_energy: Some(fe_energy(p.fe)),
        mbs_energy: Some(mbs_energy(p.mbs)),
        fe_run: Some(fe_cost(p.fe, p.threads)),
        hybrid_run: p.hybrid.map(|run| fe_cost(run, p.threads)),
        mbs_run: Some(mbs_cost(p)),
        left_out: left_out::rows(v),
        left_out_note: left_out::note(v),
        review: model::review(p.review),
        model: model::summary(p.generated, p.mbs),
        curves: model::curves(&p.generated.model.curves, &p.generated.entries),
        notes: notes(p),
        events: events::events(p),
        scene: Some(scene::scene(p)),
        partition: Some(partition::partition(p)),
        blasting: plan::blasting(p.building),
        debris: plan::debris(p),
        hinge_sites: sites,
        counted_rotation_rad: Some(ACTIVE_ROTATION_RAD),
    }
}

/// How far a structure is apart that stands in both runs to their end.
fn standing(v: &Validation) -> Option<Standing> {
    (v.stands() && v.undecided.is_empty()).then_some(Standing {
        apart_m: v.largest_difference_m,
        limit_m: LIMIT_STANDING_M,
        largest_m: [v.largest_displacement_m.fe, v.largest_displacement_m.mbs],
    })
}

fn settings(p: &Pieces) -> Vec<Setting> {
    let s = &p.building.settings;
    let line = |name: &str, value: String| Setting { name: name.into(), value };
    vec![
        line("Simulated time", format!("{} s", s.end_time_s)),
        line("Output interval", format!("{} s", s.output_interval_s)),
        line("Time over which the forces of removed members fall", format!("{} s", s.removal_duration_s)),
        line("Gravity", format!("{} m/s²", s.gravity_m_s2)),
        line("Target edge length of the FE mesh", format!("{} m", s.mesh_size_m)),
        line("Critical strain rate", format!("{} 1/s", p.facts.critical_rate_1_s)),
        line(
            "Plastic rotation from which an MBS hinge counts as yielded",
            format!("{ACTIVE_ROTATION_RAD} rad"),
        ),
        line("Run time of the MBS", format!("median of {} runs", p.mbs_runs)),
    ]
}

fn histories(p: &Pieces) -> Vec<History> {
    let n = p.outputs();
    let hybrid = |id: &str| {
        let point = p.hybrid?.tracked.iter().find(|h| h.id == id)?;
        Some(point.displacement_m[..n].to_vec())
    };
    let pair = |f: &crate::fe::result::History| {
        let m = p.mbs.tracked.iter().find(|m| m.id == f.id)?;
        Some(History {
            point: f.id.clone(),
            time_s: p.fe.times_s[..n].to_vec(),
            fe_m: f.displacement_m[..n].to_vec(),
            mbs_m: m.displacement_m[..n].to_vec(),
            hybrid_m: hybrid(&f.id).unwrap_or_default(),
            debris_s: f.debris_s,
        })
    };
    p.fe.tracked.iter().filter_map(pair).collect()
}

/// All member ends of the FE facts, then hinges elsewhere (at members that a charge takes away).
///
/// A hinge below [`ACTIVE_ROTATION_RAD`] is shown as one that yields slightly, so that the page counts as [`Validation`] does.
fn hinge_sites(p: &Pieces) -> Vec<HingeSite> {
    let joints = &p.generated.model.bushings;
    let live_s = live_s(&p.generated.model, p.mbs);
    let latent = |id: &str| live_s.get(id).map(|t| Some(*t).filter(|t| t.is_finite()));
    let counts = |site: &SiteComparison| site.plastic_rotation_rad > ACTIVE_ROTATION_RAD;
    let at_end = p.facts.ends.iter().zip(&p.validation.sites).map(|(zone, site)| HingeSite {
        member_end: zone.id.clone(),
        point_m: zone.point_m,
        body: joints.iter().find(|j| j.id == zone.id).map(|j| j.body_b.clone()),
        removed_s: None,
        fe_zone: Some(site.fe_zone),
        fe_first_s: zone.first_s,
        fe_peak_strain_rate_1_s: Some(zone.peak_rate_1_s),
        fe_max_plastic_strain: Some(zone.plastic_strain),
        mbs_hinge: site.hinge,
        mbs_latent: latent(&zone.id).is_some(),
        mbs_live_s: latent(&zone.id).flatten(),
        mbs_yielded_s: site.yield_s.filter(|_| counts(site)),
        mbs_slight_s: site.yield_s.filter(|_| !counts(site)),
        mbs_max_plastic_rotation_rad: site.hinge.then_some(site.plastic_rotation_rad),
        mbs_fractured_s: site.fracture_s,
    });
    let broken_s = |id: &str| {
        let is_it = |kind: &EventKind| matches!(kind, EventKind::Fracture { joint, .. } if joint == id);
        p.mbs.events.iter().find(|e| is_it(&e.kind)).map(|e| e.time_s)
    };
    let known = |id: &str| p.facts.ends.iter().any(|z| z.id == id);
    let elsewhere = joints.iter().filter(|j| !j.names().iter().any(|id| known(id))).map(|j| HingeSite {
        member_end: j.id.clone(),
        point_m: j.point_m,
        body: Some(j.body_b.clone()),
        removed_s: removed_s(&p.generated.model, &j.body_b),
        mbs_hinge: true,
        mbs_latent: latent(&j.id).is_some(),
        mbs_live_s: latent(&j.id).flatten(),
        mbs_fractured_s: broken_s(&j.id),
        ..HingeSite::default()
    });
    at_end.chain(elsewhere).collect()
}

/// Bulk viscosity counts as internal energy; what leaves with removed members, and what dying elements release, as external work.
fn fe_energy(run: &FeRun) -> FeEnergy {
    let of = |f: fn(&crate::fe::result::FeEnergies) -> f64| run.energies.iter().map(f).collect::<Vec<f64>>();
    FeEnergy {
        time_s: run.times_s.clone(),
        kinetic_j: of(|e| e.kinetic_j),
        internal_j: of(|e| e.internal_j + e.viscous_j),
        hourglass_j: of(|e| e.hourglass_j),
        contact_j: of(|e| -e.contact_j - e.friction_j),
        external_work_j: of(|e| e.gravity_j + e.removed_j + e.released_j),
        eroded_j: of(|e| e.eroded_j),
        residual_j: of(|e| e.residual_j),
        error: Some(run.summary.energy_error),
    }
}

/// What separation and removal release counts as plastic, energy stored in contacts as elastic.
fn mbs_energy(run: &RunResult) -> MbsEnergy {
    let e = &run.energies;
    let sum = |lists: &[&Vec<f64>]| -> Vec<f64> {
        (0..run.times_s.len()).map(|i| lists.iter().map(|l| l[i]).sum()).collect()
    };
    MbsEnergy {
        time_s: run.times_s.clone(),
        kinetic_j: e.kinetic_j.clone(),
        potential_j: e.gravity_j.clone(),
        elastic_j: sum(&[&e.joints_elastic_j, &e.contact_elastic_j]),
        plastic_j: sum(&[&e.plastic_j, &e.released_j]),
        contact_j: sum(&[&e.contact_damping_j, &e.friction_j]),
        residual_j: (0..run.times_s.len()).map(|i| e.total_j(i) - e.total_j(0)).collect(),
        error: Some(run.energy_error),
    }
}

fn mean_step_s(times_s: &[f64], steps: u64) -> Option<f64> {
    times_s.last().map(|end| end / steps.max(1) as f64)
}

fn fe_cost(run: &FeRun, threads: usize) -> RunCost {
    let s = &run.summary;
    RunCost {
        cpu_s: Some(s.elapsed.cpu_s),
        wall_s: Some(s.elapsed.wall_s),
        steps: Some(s.steps),
        step_s: mean_step_s(&run.times_s, s.steps),
        parts: Some(s.elements as u64),
        dofs: Some(3 * (s.nodes - run.mesh.fixed.len()) as u64),
        threads: Some(threads as u64),
    }
}

fn mbs_cost(p: &Pieces) -> RunCost {
    let bodies = p.mbs.bodies.len() as u64;
    RunCost {
        cpu_s: Some(p.validation.cpu_s.mbs),
        wall_s: Some(p.validation.wall_s.mbs),
        steps: Some(p.mbs.steps as u64),
        step_s: mean_step_s(&p.mbs.times_s, p.mbs.steps as u64),
        parts: Some(bodies),
        dofs: Some(6 * bodies),
        threads: Some(1),
    }
}

fn notes(p: &Pieces) -> Vec<Note> {
    let warning = |text: &String| Note { severity: Severity::Warning, text: text.clone() };
    let note = |text: String| Note { severity: Severity::Note, text };
    let undecided = p.validation.undecided.iter().map(|u| &u.words);
    let early = undecided.filter(|words| !p.generated.notes.contains(words));
    let mut notes: Vec<Note> = early.chain(&p.generated.notes).map(warning).collect();
    // a balance that is off by no more than its limit is no warning
    let is_minor = |w: &&String| w.starts_with(OFF_BALANCE) && p.mbs.energy_error <= LIMIT_ENERGY;
    let (minor, remarks): (Vec<&String>, Vec<&String>) = p.mbs.warnings.iter().partition(is_minor);
    if let Some(first) = remarks.first() {
        let more = remarks.len() - 1;
        let rest = if more > 0 { format!(" ({more} more of the run under Notes)") } else { String::new() };
        notes.push(warning(&format!("MBS run: {first}{rest}")));
    }
    if let Some(text) = snapped(p.fe) {
        notes.push(note(text));
    }
    if !p.generated.derived.is_empty() {
        notes.push(note(format!(
            "Computed for this model, as the library had no entry: {}.",
            p.generated.derived.join(", ")
        )));
    }
    notes.extend(p.generated.unasked.iter().map(|u| note(format!("Not asked: {}.", u.words()))));
    notes.push(note(
        "Energies: FE internal energy includes bulk viscosity and what was in eroded elements, FE external work what leaves with removed members and what dying elements release; MBS \
         plastic energy includes what separation of joints and removal of bodies release, MBS elastic energy that stored \
         in contacts."
            .into(),
    ));
    notes.extend(remarks.iter().skip(1).chain(&minor).map(|w| note(format!("MBS run: {w}"))));
    notes
}

/// Members whose faces were moved to mesh planes, in a sentence.
fn snapped(run: &FeRun) -> Option<String> {
    let worst = run.snapped.iter().max_by(|a, b| {
        let off = |s: &crate::fe::mesh::Snapped| s.volume_ratio.max(1.0 / s.volume_ratio);
        off(a).total_cmp(&off(b))
    })?;
    let names: Vec<&str> = run.snapped.iter().map(|s| s.member.as_str()).collect();
    Some(format!(
        "FE: the faces of {} members were moved to mesh planes ({}); density, stiffness and strength were scaled by real over \
         meshed volume. The ratio furthest from 1 is {:.3} ({}).",
        names.len(),
        names.join(", "),
        worst.volume_ratio,
        worst.member
    ))
}
