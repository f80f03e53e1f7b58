//! The comparison of both runs in words: checks against the limits of [`crate::validate`], and a verdict.

use crate::building::Building;
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

/// The same where no point may tell.
pub fn told_words(collapsed: Option<bool>) -> &'static str {
    collapsed.map_or("gives no verdict, as no point is tracked,", collapse_words)
}

/// Charges that a run to a time does not get to.
pub fn unfired(building: &Building, end_s: f64) -> Vec<&str> {
    building.events.iter().filter(|charge| charge.time_s >= end_s).map(|charge| charge.id.as_str()).collect()
}

/// What became of the building in a run; none where it stands but not all charges were fired, or where nothing is tracked (`collapsed` is none).
pub fn outcome(collapsed: Option<bool>, unfired: &[&str]) -> Option<bool> {
    collapsed.filter(|collapsed| *collapsed || unfired.is_empty())
}

/// [`outcome`] in words.
pub fn outcome_words(collapsed: Option<bool>, unfired: &[&str]) -> String {
    match outcome(collapsed, unfired) {
        Some(collapsed) => collapse_words(collapsed).into(),
        None if collapsed.is_none() => "no verdict (no point is tracked)".into(),
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
        collapse(v),
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

/// An error, or that there is none.
fn error_words(e: Option<f64>) -> String {
    e.map_or("nothing was compared".into(), |e| format!("e = {e:.3}"))
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
            format!("{}{after}", error_words(v.e_total)),
            format!("≤ {limit:.2} ({of})"),
            v.e_total.map_or(Status::Unknown, |e| status(e <= limit)),
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
            error_words(h.e_total),
            format!("≤ {LIMIT_HYBRID:.2}"),
            h.e_total.map_or(Status::Unknown, |_| status(h.is_close())),
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
    let label = "Displacement error up to the first contact";
    let words = "relative error over all tracked points, up to the first ground contact of the FE run (to the end if there is none)";
    let mut limit = format!("≤ {LIMIT_TO_CONTACT:.2}");
    let Some(e) = v.e_to_contact else {
        return check(label, "nothing was compared".into(), limit, Status::Unknown, words);
    };
    let mut value = if v.fe_rests() { "FE at rest".into() } else { format!("e = {e:.3}") };
    if v.stands() {
        value += &format!(", {}", apart(v));
        limit += &format!(", or {:.0} mm apart", 1e3 * LIMIT_STANDING_M);
    }
    check(label, value, limit, status(v.displacements_agree()), words)
}

/// "collapses", "does not collapse", or what is known so far.
fn outcome_of(v: &Validation, collapsed: bool) -> &'static str {
    match (collapsed, v.ends_early()) {
        (false, true) => "has not collapsed so far",
        _ => collapse_words(collapsed),
    }
}

fn collapse(v: &Validation) -> Check {
    let [fe, mbs] = [v.collapsed.fe, v.collapsed.mbs];
    let status = if v.undecided.is_empty() { status(fe == mbs) } else { Status::Unknown };
    check(
        "Collapse",
        format!("FE {}, MBS {}", outcome_of(v, fe), outcome_of(v, mbs)),
        "the same".into(),
        status,
        "a structure has collapsed if a tracked point falls by more than 1 m",
    )
}

/// Distance of the displacements of a structure that stands.
fn apart(v: &Validation) -> String {
    let [apart, fe, mbs] =
        [v.largest_difference_m, v.largest_displacement_m.fe, v.largest_displacement_m.mbs].map(short_length);
    format!("displacements at most {apart} apart (FE {fe}, MBS {mbs})")
}

/// A length in mm, below a tenth of one in µm.
fn short_length(length_m: f64) -> String {
    if length_m < 1e-4 { format!("{:.1} µm", 1e6 * length_m) } else { format!("{:.1} mm", 1e3 * length_m) }
}

fn contact(v: &Validation) -> Check {
    let both = v.first_contact_s;
    let (value, status) = match (both.fe, both.mbs, v.contact_time_error()) {
        (None, None, _) if v.ends_early() => ("none in either run so far".into(), Status::Unknown),
        (None, None, _) => ("none in either run".into(), Status::Pass),
        (_, _, Some(error)) => (
            format!("{} apart (FE {}, MBS {})", percent(error), seconds(both.fe), seconds(both.mbs)),
            status(error <= LIMIT_CONTACT_TIME),
        ),
        _ => {
            let status = if v.ends_early() { Status::Unknown } else { Status::Fail };
            (format!("FE {}, MBS {}", seconds(both.fe), seconds(both.mbs)), status)
        }
    };
    let limit = format!("≤ {:.0} %", 100.0 * LIMIT_CONTACT_TIME);
    check("Time of the first ground contact", value, limit, status, "difference over the time of the FE run")
}

/// The verdict: agreement up to the first contact, what fails, or why it cannot be told.
pub fn verdict(v: &Validation) -> Verdict {
    let phase =
        if v.first_contact_s.fe.is_some() { "up to the first contact" } else { "up to the end of the run" };
    let (headline, status) = match v.agreement() {
        None => (undecided(v), Status::Unknown),
        Some(true) => match v.e_to_contact {
            Some(e) if e <= LIMIT_TO_CONTACT && !v.fe_rests() => {
                (format!("The MBS agrees with FE {phase}: e = {e:.3}"), Status::Pass)
            }
            _ => {
                (format!("The MBS agrees with FE: the structure stands in both, {}", apart(v)), Status::Pass)
            }
        },
        Some(false) => {
            let failed: Vec<String> = checks(v)
                .into_iter()
                .take(DECISIVE)
                .filter(|c| c.status == Status::Fail)
                .map(|c| format!("{}: {} (limit {})", lower(&c.label), c.value, c.limit))
                .collect();
            let failed = failed.join("; ");
            (format!("The MBS does not agree with FE {phase}. Outside its limit: {failed}"), Status::Fail)
        }
    };
    Verdict { headline, status, detail: detail(v) }
}

/// Why the comparison tells nothing.
fn undecided(v: &Validation) -> String {
    let why: Vec<&str> = v.undecided.iter().map(|u| u.words.as_str()).collect();
    format!("Whether the MBS agrees with FE is undecided: {}", why.join("; "))
}

fn detail(v: &Validation) -> String {
    let collapse = match (v.collapsed.fe, v.collapsed.mbs) {
        _ if v.e_to_contact.is_none() => "No point tells whether the structure collapses.".to_string(),
        (true, true) => "The structure collapses in both runs.".to_string(),
        (false, false) if v.ends_early() => "The structure has not collapsed in either run so far.".into(),
        (false, false) => "The structure does not collapse in either run.".to_string(),
        (fe, mbs) => format!(
            "The structure {} in the FE run and {} in the MBS run.",
            outcome_of(v, fe),
            outcome_of(v, mbs)
        ),
    };
    // what stands deflects by millimetres and leaves no debris
    let whole = v.e_total.filter(|_| !v.stands()).map_or(String::new(), |e| {
        format!(
            " Over the whole run e = {e:.3}; the debris footprints overlap by {:.0} %.",
            100.0 * v.footprint_overlap
        )
    });
    format!("{collapse}{whole} {}", zones(v))
}

/// Which FE zones are hinges, and which hinges are zones.
fn zones(v: &Validation) -> String {
    let turning = format!("turns plastically by more than {ACTIVE_ROTATION_RAD} rad");
    let Sites { common, expected, found, .. } = v.hinges;
    match (expected, found) {
        (0, 0) => format!("FE shows no zone of accumulated damage at a member end, and no hinge {turning}."),
        (0, 1) => format!("FE shows no zone of accumulated damage at a member end; one hinge {turning}."),
        (0, _) => format!(
            "FE shows no zone of accumulated damage at a member end; {found} hinges turn plastically by more than {ACTIVE_ROTATION_RAD} rad."
        ),
        (_, 0) => format!("None of {expected} FE zones has a hinge that {turning}."),
        _ => format!(
            "{common} of {expected} FE zones have a hinge that {turning}; {common} of {found} such hinges stand in an FE zone."
        ),
    }
}

/// Precision, recall and F1 of sites that were found; "-" for a share of nothing.
pub fn sites_words(sites: &Sites) -> [String; 3] {
    [sites.precision, sites.recall, sites.f1].map(|share| share.map_or("-".into(), |x| format!("{x:.2}")))
}

/// A share in per cent with two or three digits, down to a millionth of one.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        p if p >= 10.0 => format!("{p:.0} %"),
        p if !(1e-6..0.1).contains(&p) => format!("{p:.2} %"),
        p => format!("{p:.*} %", (1.0 - p.log10()).ceil() as usize),
    }
}

fn lower(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}
