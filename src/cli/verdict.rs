//! The comparison of both runs in words: checks against the limits of [`crate::validate`], and a verdict.

use crate::building::Building;
use crate::mbs::math;
use crate::report::{Check, Status, Verdict};
use crate::validate::measure::Sites;
use crate::validate::{
    ACTIVE_ROTATION_RAD, HybridValidation, LIMIT_CONTACT_TIME, LIMIT_ENERGY, LIMIT_FOOTPRINT, LIMIT_HYBRID,
    LIMIT_HYBRID_TIME, LIMIT_SPEED, LIMIT_STANDING_M, LIMIT_TO_CONTACT, Validation,
};

/// Number of the checks, from the first, that [`Validation::agrees`] is made of.
const DECISIVE: usize = 5;

fn status(holds: bool) -> Status {
    if holds { Status::Pass } else { Status::Fail }
}

fn check(label: &str, value: String, limit: String, status: Status, explanation: &str) -> Check {
    Check { label: label.into(), value, limit, status, explanation: explanation.into() }
}

/// "collapses" or "does not collapse".
pub fn collapse_words(collapsed: bool) -> &'static str {
    if collapsed { "collapses" } else { "does not collapse" }
}

/// Charges that a run to a time does not get to.
pub fn unfired(building: &Building, end_s: f64) -> Vec<&str> {
    building.events.iter().filter(|charge| charge.time_s >= end_s).map(|charge| charge.id.as_str()).collect()
}

/// Speed of a tracked point from which what has not come down is not at rest either \[m/s\].
const MOVES_M_S: f64 = 1.0;

/// That a building which has not collapsed by the end of a run still moves, if one of the points does, for the times of their displacements.
pub fn moving_note<'a>(
    collapsed: bool,
    times_s: &[f64],
    points: impl Iterator<Item = (&'a str, &'a [math::V3])>,
) -> Option<String> {
    let [.., before, end] = times_s[..] else { return None };
    let speed = |u: &[math::V3]| match u {
        [.., a, b] => math::norm(math::sub(*b, *a)) / (end - before),
        _ => 0.0,
    };
    let (id, fastest) = points.map(|(id, u)| (id, speed(u))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (!collapsed && fastest > MOVES_M_S).then(|| {
        format!("at the end, {end:.4} s, \"{id}\" still moves at {fastest:.1} m/s: too soon to tell whether it collapses; give a later settings.end_time")
    })
}

/// What became of the building in a run, none where it stands but not all charges were fired.
pub fn outcome(collapsed: bool, unfired: &[&str]) -> Option<bool> {
    (collapsed || unfired.is_empty()).then_some(collapsed)
}

/// [`outcome`] in words.
pub fn outcome_words(collapsed: bool, unfired: &[&str]) -> String {
    match outcome(collapsed, unfired) {
        Some(collapsed) => collapse_words(collapsed).into(),
        None => format!("no verdict (the run ends before {})", unfired.join(", ")),
    }
}

/// The energy error of a run, beside its limit where it is above it.
pub fn energy_words(error: f64) -> String {
    let words = percent(error);
    if error <= LIMIT_ENERGY {
        words
    } else {
        format!("{words}, above the limit of {:.0} %", 100.0 * LIMIT_ENERGY)
    }
}

/// What an energy error above its limit means for the MBS run of a generated model.
pub fn energy_warning(error: f64) -> Option<String> {
    (error > LIMIT_ENERGY).then(|| {
        format!(
            "the energy error of the MBS run is {}: what the run shows is in doubt, and --validate counts it as a failed check; run model.json with a smaller settings.time_step_s (fallwerk simulate)",
            energy_words(error)
        )
    })
}

/// A time or "none".
pub fn seconds(time_s: Option<f64>) -> String {
    time_s.map_or("none".into(), |t| format!("{t:.3} s"))
}

/// All checks, those that decide the agreement first.
pub fn checks(v: &Validation) -> Vec<Check> {
    let energy = |label: &str, error: f64| {
        let words = "largest residual of the energy balance over the energy turned over";
        let (value, limit) = (percent(error), format!("≤ {:.0} %", 100.0 * LIMIT_ENERGY));
        check(label, value, limit, status(error <= LIMIT_ENERGY), words)
    };
    let mut checks = vec![
        displacements(v),
        contact(v),
        check(
            "Collapse",
            format!("FE {}, MBS {}", collapse_words(v.collapsed.fe), collapse_words(v.collapsed.mbs)),
            "the same".into(),
            status(v.collapsed.fe == v.collapsed.mbs),
            "a structure has collapsed if a tracked point falls by more than 1 m",
        ),
        energy("Energy error of the FE run", v.energy_error.fe),
        energy("Energy error of the MBS run", v.energy_error.mbs),
        check(
            "FE zones at column ends missed by the MBS",
            if v.missed_column_ends.is_empty() { "none".into() } else { v.missed_column_ends.join(", ") },
            "none".into(),
            status(v.missed_column_ends.is_empty()),
            "column ends above the critical strain rate in FE whose hinge did not turn plastically",
        ),
        check(
            "Speed",
            format!("{:.0} times", v.speed_ratio),
            format!("≥ {LIMIT_SPEED:.0} times"),
            status(v.speed_ratio >= LIMIT_SPEED),
            "processor time of FE over that of the MBS; says nothing about the agreement",
        ),
    ];
    if v.collapsed.fe {
        checks.extend(after_contact(v));
    }
    checks.extend(v.hybrid.iter().flat_map(hybrid));
    checks
}

/// What is aimed at beyond the first contact, of buildings that fall.
fn after_contact(v: &Validation) -> [Check; 2] {
    let after =
        v.e_after_contact.map_or(String::new(), |e| format!(", {e:.3} after the first contact alone"));
    let of = if v.has_obstacle { "with an obstacle in the way" } else { "without an obstacle in the way" };
    let limit = v.limit_total();
    [
        check(
            "Displacement error over the whole run",
            format!("e = {:.3}{after}", v.e_total),
            format!("≤ {limit:.2} ({of})"),
            status(v.e_total <= limit),
            "contact included; says nothing about the agreement up to the first contact",
        ),
        check(
            "Debris footprint",
            format!("{} common", percent(v.footprint_overlap)),
            format!("≥ {:.0} %", 100.0 * LIMIT_FOOTPRINT),
            status(v.footprint_overlap >= LIMIT_FOOTPRINT),
            "area common to the debris of both runs at the end over that of their union; says nothing about the agreement",
        ),
    ]
}

/// What is asked of a hybrid run; the agreement of the MBS is none of its business.
fn hybrid(h: &HybridValidation) -> [Check; 3] {
    [
        check(
            "Hybrid: displacement error over the whole run",
            format!("e = {:.3}", h.e_total),
            format!("≤ {LIMIT_HYBRID:.2}"),
            status(h.is_close()),
            "relative error over all tracked points of the FE run with rigid parts against the full FE run",
        ),
        check(
            "Hybrid: processor time",
            format!("{} of FE's", percent(h.cpu_share)),
            format!("≤ {:.0} %", 100.0 * LIMIT_HYBRID_TIME),
            status(h.is_fast()),
            "rigid parts cost no element work",
        ),
        check(
            "Energy error of the hybrid run",
            percent(h.energy_error),
            format!("≤ {:.0} %", 100.0 * LIMIT_ENERGY),
            status(h.energy_error <= LIMIT_ENERGY),
            "largest residual of the energy balance over the energy turned over; what switches change is in the balance",
        ),
    ]
}

fn displacements(v: &Validation) -> Check {
    let words = "relative error over all tracked points, up to the first ground contact of the FE run (to the end if there is none)";
    let (mut value, mut limit) = (format!("e = {:.3}", v.e_to_contact), format!("≤ {LIMIT_TO_CONTACT:.2}"));
    if v.stands() {
        value += &format!(", {}", apart(v));
        limit += &format!(", or {:.0} mm apart", 1e3 * LIMIT_STANDING_M);
    }
    check("Displacement error up to the first contact", value, limit, status(v.displacements_agree()), words)
}

/// Distance of the displacements of a structure that stands.
fn apart(v: &Validation) -> String {
    let [apart, fe, mbs] =
        [v.largest_difference_m, v.largest_displacement_m.fe, v.largest_displacement_m.mbs].map(|m| 1e3 * m);
    format!("displacements at most {apart:.1} mm apart (FE {fe:.1} mm, MBS {mbs:.1} mm)")
}

fn contact(v: &Validation) -> Check {
    let both = v.first_contact_s;
    let (value, status) = match (both.fe, both.mbs, v.contact_time_error()) {
        (None, None, _) => ("none in either run".into(), Status::Pass),
        (_, _, Some(error)) => (
            format!("{} apart (FE {}, MBS {})", percent(error), seconds(both.fe), seconds(both.mbs)),
            status(error <= LIMIT_CONTACT_TIME),
        ),
        _ => (format!("FE {}, MBS {}", seconds(both.fe), seconds(both.mbs)), Status::Fail),
    };
    let limit = format!("≤ {:.0} %", 100.0 * LIMIT_CONTACT_TIME);
    check("Time of the first ground contact", value, limit, status, "difference over the time of the FE run")
}

/// The verdict: agreement up to the first contact, or what fails.
pub fn verdict(v: &Validation) -> Verdict {
    let phase =
        if v.first_contact_s.fe.is_some() { "up to the first contact" } else { "up to the end of the run" };
    let headline = if v.agrees() && v.e_to_contact > LIMIT_TO_CONTACT {
        format!("The MBS agrees with FE: the structure stands in both, {}", apart(v))
    } else if v.agrees() {
        format!("The MBS agrees with FE {phase}: e = {:.3}", v.e_to_contact)
    } else {
        let failed: Vec<String> = checks(v)
            .into_iter()
            .take(DECISIVE)
            .filter(|c| c.status == Status::Fail)
            .map(|c| format!("{}: {} (limit {})", lower(&c.label), c.value, c.limit))
            .collect();
        format!("The MBS does not agree with FE {phase}. Outside its limit: {}", failed.join("; "))
    };
    Verdict { headline, status: status(v.agrees()), detail: detail(v) }
}

fn detail(v: &Validation) -> String {
    let collapse = match (v.collapsed.fe, v.collapsed.mbs) {
        (true, true) => "The structure collapses in both runs.".to_string(),
        (false, false) => "The structure does not collapse in either run.".to_string(),
        (fe, mbs) => format!(
            "The structure {} in the FE run and {} in the MBS run.",
            collapse_words(fe),
            collapse_words(mbs)
        ),
    };
    format!(
        "{collapse} Over the whole run e = {:.3}; the debris footprints overlap by {:.0} %. {} of {} FE zones have a hinge that turns plastically by more than \
         {ACTIVE_ROTATION_RAD} rad; {} of {} such hinges stand in an FE zone.",
        v.e_total,
        100.0 * v.footprint_overlap,
        v.hinges.common,
        v.hinges.expected,
        v.hinges.common,
        v.hinges.found,
    )
}

/// Precision, recall and F1 of sites that were found; "-" for a share of nothing.
pub fn sites_words(sites: &Sites) -> [String; 3] {
    let share = |x: f64, of: usize| if of == 0 { "-".into() } else { format!("{x:.2}") };
    [
        share(sites.precision, sites.found),
        share(sites.recall, sites.expected),
        share(sites.f1, sites.found + sites.expected),
    ]
}

/// A share in per cent with two or three digits.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    if percent >= 10.0 { format!("{percent:.0} %") } else { format!("{percent:.2} %") }
}

fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}
