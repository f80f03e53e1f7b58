//! What a report shows of the FE run, of the one with rigid parts, and of the comparison of both with the MBS run.

use super::{Against, Pieces, alone, common, compared, left_out, mean_step_s};
use crate::cli::verdict;
use crate::fe::result::FeRun;
use crate::mbs::latent::live_s;
use crate::report::{ErrorMeasure, FeEnergy, HingeSite, History, ReportInput, RunCost, Standing};
use crate::validate::{ACTIVE_ROTATION_RAD, LIMIT_STANDING_M, LIMIT_TO_CONTACT, SiteComparison, Validation};

/// The input of a report that compares the MBS run with FE.
pub fn input(p: &Pieces, a: &Against) -> ReportInput {
    let v = a.validation;
    ReportInput {
        title: if a.hybrid.is_some() { "FE, hybrid and MBS" } else { "MBS against FE" }.into(),
        verdict: verdict::verdict(v),
        checks: verdict::checks(v),
        compared: compared::runs(v),
        compared_notes: compared::notes(v),
        histories: histories(p, a),
        error: error(v),
        standing: standing(v),
        fe_energy: Some(fe_energy(a.fe)),
        fe_run: Some(fe_cost(a.fe, a.threads)),
        hybrid_run: a.hybrid.map(|run| fe_cost(run, a.threads)),
        left_out: left_out::rows(&v.left_out),
        left_out_note: left_out::note(&v.left_out, v.hybrid.as_ref()),
        hinge_sites: hinge_sites(p, a),
        ..common(p)
    }
}

/// The error over time.
fn error(v: &Validation) -> Option<ErrorMeasure> {
    // The second line of the error is drawn where there is debris only: elsewhere it is the first.
    let without_debris = |curve: &Vec<f64>| if v.debris.is_empty() { Vec::new() } else { curve.clone() };
    v.e_total.map(|_| ErrorMeasure {
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
    })
}

/// How far a structure is apart that stands in both runs to their end.
fn standing(v: &Validation) -> Option<Standing> {
    (v.stands() && v.undecided.is_empty()).then_some(Standing {
        apart_m: v.largest_difference_m,
        limit_m: LIMIT_STANDING_M,
        largest_m: [v.largest_displacement_m.fe, v.largest_displacement_m.mbs],
    })
}

fn histories(p: &Pieces, a: &Against) -> Vec<History> {
    let n = p.outputs();
    let hybrid = |id: &str| {
        let point = a.hybrid?.tracked.iter().find(|h| h.id == id)?;
        Some(point.displacement_m[..n].to_vec())
    };
    let pair = |f: &crate::fe::result::History| {
        let m = p.mbs.tracked.iter().find(|m| m.id == f.id)?;
        Some(History {
            point: f.id.clone(),
            time_s: a.fe.times_s[..n].to_vec(),
            fe_m: f.displacement_m[..n].to_vec(),
            mbs_m: m.displacement_m[..n].to_vec(),
            hybrid_m: hybrid(&f.id).unwrap_or_default(),
            debris_s: f.debris_s,
        })
    };
    a.fe.tracked.iter().filter_map(pair).collect()
}

/// All member ends of the FE facts, then hinges elsewhere (at members that a charge takes away, sections of columns), of which FE tells nothing.
///
/// A hinge below [`ACTIVE_ROTATION_RAD`] is shown as one that yields slightly, so that the page counts as [`Validation`] does.
fn hinge_sites(p: &Pieces, a: &Against) -> Vec<HingeSite> {
    let joints = &p.generated.model.bushings;
    let live_s = live_s(&p.generated.model, p.mbs);
    let latent = |id: &str| live_s.get(id).map(|t| Some(*t).filter(|t| t.is_finite()));
    let counts = |site: &SiteComparison| site.plastic_rotation_rad > ACTIVE_ROTATION_RAD;
    let at_end = a.facts.ends.iter().zip(&a.validation.sites).map(|(zone, site)| HingeSite {
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
    let known = |id: &str| a.facts.ends.iter().any(|z| z.id == id);
    let unknown = joints.iter().filter(|j| !j.names().iter().any(|id| known(id)));
    let elsewhere = unknown.flat_map(|j| {
        let names = j.names().iter().map(String::as_str).enumerate();
        names.map(|hinge| alone::site(p, &live_s, j, hinge)).collect::<Vec<HingeSite>>()
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
