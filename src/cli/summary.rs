//! The summary of `generate-mbs`, for people and for programs.

use super::compose::compared;
use super::counted;
use super::generate_mbs::{Comparison, MBS_RUNS};
use super::verdict::{collapse_words, energy_warning, energy_words, sites_words, told_words, verdict};
use crate::building::Building;
use crate::generate::{Generated, Unasked};
use crate::mbs::RunResult;
use crate::mbs::result::EventKind;
use crate::review::Review;
use crate::study::fell;
use crate::validate::spread::UNDECIDED_M;
use crate::validate::undecided::{Fastest, falling, falling_words, moving_note};
use crate::validate::{ACTIVE_ROTATION_RAD, LIMIT_ENERGY, Spread};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Decisions worth a look that are shown.
const REVIEW_SHOWN: usize = 5;

/// What a summary is made of.
pub struct Summary<'a> {
    /// The building.
    pub building: &'a Building,
    /// Its model.
    pub generated: &'a Generated,
    /// Its decisions worth a look.
    pub review: &'a Review,
    /// The MBS run.
    pub mbs: &'a RunResult,
    /// How far it comes apart with next to no change.
    pub spread: Option<&'a Spread>,
    /// The FE run and the comparison, if there was one.
    pub comparison: Option<&'a Comparison>,
    /// The result folder.
    pub folder: &'a Path,
}

impl Summary<'_> {
    /// Number of firings of each rule.
    fn rules(&self) -> BTreeMap<&str, usize> {
        let mut rules = BTreeMap::new();
        self.generated.trace.iter().for_each(|t| *rules.entry(t.rule.as_str()).or_insert(0) += 1);
        rules
    }

    /// When an obstacle is struck first, and which.
    fn obstacle_contact(&self) -> Option<(f64, &str)> {
        let obstacles = &self.generated.model.contact.obstacles;
        self.mbs.events.iter().find_map(|event| match &event.kind {
            EventKind::Contact { b, .. } if obstacles.iter().any(|o| o.id == *b) => {
                Some((event.time_s, b.as_str()))
            }
            _ => None,
        })
    }

    /// Runs in which the building has come down and still moves at the end.
    fn falling(&self) -> Vec<(&'static str, Fastest<'_>)> {
        let hybrid = self.comparison.and_then(|c| Some(("hybrid", c.hybrid.as_ref()?)));
        let fe = self.comparison.into_iter().map(|c| ("FE", &c.fe)).chain(hybrid);
        falling(fe, self.mbs)
    }

    /// None where no point is tracked.
    fn mbs_collapsed(&self) -> Option<bool> {
        let points = &self.mbs.tracked;
        (!points.is_empty()).then(|| points.iter().any(|t| fell(&t.displacement_m)))
    }
}

/// The summary as text.
pub fn as_text(s: &Summary) -> String {
    let model = &s.generated.model;
    let fired: Vec<String> = s.rules().iter().map(|(rule, n)| format!("{rule} ({n})")).collect();
    let mut text = format!(
        "{}\n  \
         model      {} bodies, {} joints, {} curves from {} library entries\n  \
         rules      {}\n",
        s.building.name,
        model.bodies.len(),
        model.bushings.len(),
        model.curves.len(),
        s.generated.entries.len(),
        fired.join(", "),
    );
    for decided in s.generated.overrides() {
        text += &format!("  override   {decided}\n");
    }
    if !s.generated.derived.is_empty() {
        text += &format!("  derived    {}\n", s.generated.derived.join("\n             "));
    }
    text += &format!(
        "  MBS run    {} in {} steps, {:.1} ms processor (median of {MBS_RUNS} runs); energy error {}\n",
        told_words(s.mbs_collapsed()),
        s.mbs.steps,
        1e3 * s.mbs.cpu_s,
        energy_words(s.mbs.energy_error),
    );
    let points = s.mbs.tracked.iter().map(|t| (t.id.as_str(), &t.displacement_m[..]));
    if let Some(note) = moving_note(s.mbs_collapsed() == Some(true), &s.mbs.times_s, points) {
        text += &format!("  note       {note}\n");
    }
    if let Some(warning) = falling_words(&s.falling()) {
        text += &format!("  warning    {warning}\n");
    }
    if let Some(warning) = energy_warning(s.mbs.energy_error) {
        text += &format!("  warning    {warning}\n");
    }
    if let Some(spread) = s.spread.filter(|s| s.largest_m >= UNDECIDED_M) {
        text += &format!("  rounding   {}\n", spread.words());
    }
    match s.comparison {
        Some(c) => text += &comparison_text(c),
        None => {
            let ground = match s.mbs.first_ground_contact_s {
                Some(t) => format!("first ground contact at {t:.3} s"),
                None => "nothing reaches the ground".to_string(),
            };
            let obstacle =
                s.obstacle_contact().map(|(t, id)| format!("; obstacle \"{id}\" is struck at {t:.3} s"));
            text += &format!("  contact    {ground}{}\n", obstacle.unwrap_or_default());
        }
    }
    text += &review_text(s.review);
    for note in &s.generated.notes {
        text += &format!("  note       {note}\n");
    }
    text += &unasked_text(s.generated);
    match s.mbs.warnings.as_slice() {
        [] => {}
        [one] => text += &format!("  note       MBS run: {one}\n"),
        [first, rest @ ..] => {
            text += &format!("  note       MBS run: {first} ({} more in mbs.json)\n", rest.len())
        }
    }
    text += &format!("  results    {}\n", s.folder.display());
    text + &format!("  report     {}\n", s.folder.join("report.html").display())
}

/// That rules about events are not asked, if any are not.
fn unasked_text(generated: &Generated) -> String {
    let rules: BTreeSet<&String> = generated.unasked.iter().flat_map(|u| &u.rules).collect();
    let mut about: Vec<&str> = Vec::new();
    generated.unasked.iter().map(|u| u.about.as_str()).for_each(|a| {
        if !about.contains(&a) {
            about.push(a);
        }
    });
    match rules.len() {
        0 => String::new(),
        count => format!(
            "  note       rules about events that are not asked: {count}, for {}; trace.json and explain name them\n",
            about.join("; ")
        ),
    }
}

/// The first of the decisions worth a look.
fn review_text(review: &Review) -> String {
    let count = review.items.len();
    if count == 0 {
        return String::new();
    }
    let tried = match (review.runs, review.most_runs) {
        (0, 0) => "none turned round (--review)".to_string(),
        (0, _) => "none of which can be turned round".to_string(),
        (runs, _) => format!("{runs} turned round, each in a run of its own"),
    };
    let count = counted(count, "decision", "decisions");
    let mut text = format!("  review     {count} worth a look, {tried}; all in review.json\n");
    for item in review.items.iter().take(REVIEW_SHOWN) {
        text += &format!(
            "             {}. {}: {} ({}), {}; otherwise {}: {}\n",
            item.rank,
            item.subject_words(),
            item.decision,
            item.by,
            item.why.join("; "),
            item.otherwise,
            item.change_words()
        );
    }
    text
}

fn comparison_text(c: &Comparison) -> String {
    let (v, fe) = (&c.validation, &c.fe.summary);
    let words = verdict(v);
    let [precision, recall, f1] = sites_words(&v.hinges);
    let [before, in_all] = [&v.turning_before_contact, &v.turning].map(|sites| sites_words(sites)[2].clone());
    format!(
        "  FE run     {} in {} steps of {} elements, {:.1} s wall, {:.1} s processor; energy error {}\n  \
         against FE error e up to the first contact of the FE run, from there to the end, over the whole run, over points that do not become debris\n\
         {}\
         {}  \
         hinges     against FE zones: precision {precision}, recall {recall}, F1 {f1} ({} FE zones, {} hinges that turn plastically by {ACTIVE_ROTATION_RAD} rad, {} common); of ends that turn by {} rad F1 {before} before the first contact, {in_all} in the whole run\n  \
         speed      MBS {:.0} times faster (processor time)\n  \
         verdict    {}\n",
        collapse_words(v.collapsed.fe),
        fe.steps,
        fe.elements,
        v.wall_s.fe,
        v.cpu_s.fe,
        energy_words(v.energy_error.fe),
        compared::table(v),
        compared::notes(v).iter().map(|note| format!("    {note}\n")).collect::<String>(),
        v.hinges.expected,
        v.hinges.found,
        v.hinges.common,
        crate::study::TURNED_RAD,
        v.speed_ratio,
        words.headline,
    )
}

/// The summary as JSON.
pub fn as_json(s: &Summary) -> Value {
    let model = &s.generated.model;
    let validation = s.comparison.map(|c| {
        let v = &c.validation;
        json!({
            "agrees": v.agreement(),
            "undecided": v.undecided,
            "verdict": verdict(v).headline,
            "e_to_contact": v.e_to_contact,
            "e_after_contact": v.e_after_contact,
            "e_total": v.e_total,
            "e_total_without_debris": v.e_total_without_debris,
            "debris": v.debris,
            "first_contact_s": v.first_contact_s,
            "collapsed": v.collapsed,
            "hinges": v.hinges,
            "turning_before_contact": v.turning_before_contact,
            "turning": v.turning,
            "missed_column_ends": v.missed_column_ends,
            "energy_error": v.energy_error,
            "footprint_overlap": v.footprint_overlap,
            "has_obstacle": v.has_obstacle,
            "cpu_s": v.cpu_s,
            "wall_s": v.wall_s,
            "speed_ratio": v.speed_ratio,
            "fe_elements": c.fe.summary.elements,
            "fe_steps": c.fe.summary.steps,
            "hybrid": v.hybrid.as_ref().map(|h| json!({
                "e_to_contact": h.e_to_contact,
                "e_after_contact": h.e_after_contact,
                "e_total": h.e_total,
                "e_total_without_debris": h.e_total_without_debris,
                "debris": h.debris,
                "first_contact_s": h.first_contact_s,
                "collapsed": h.collapsed,
                "energy_error": h.energy_error,
                "footprint_overlap": h.footprint_overlap,
                "cpu_s": h.cpu_s,
                "wall_s": h.wall_s,
                "cpu_share": h.cpu_share,
                "mean_rigid_share": h.mean_rigid_share,
                "skipped_share": h.skipped_share,
                "switched_j": h.switched_j,
                "switches": h.switches,
            })),
        })
    });
    json!({
        "ok": true,
        "building": s.building.name,
        "bodies": model.bodies.len(),
        "joints": model.bushings.len(),
        "curves": model.curves.len(),
        "entries": s.generated.entries.keys().collect::<Vec<_>>(),
        "derived": s.generated.derived,
        "rules": s.rules(),
        "overrides": s.generated.overrides(),
        "review": s.review.items.iter().take(REVIEW_SHOWN).collect::<Vec<_>>(),
        "notes": s.generated.notes,
        "unasked": s.generated.unasked.iter().map(Unasked::words).collect::<Vec<_>>(),
        "still_moves": falling_words(&s.falling()),
        "mbs": {
            "collapsed": s.mbs_collapsed(),
            "steps": s.mbs.steps,
            "cpu_s": s.mbs.cpu_s,
            "energy_error": s.mbs.energy_error,
            "energy_limit": LIMIT_ENERGY,
            "energy_warning": energy_warning(s.mbs.energy_error),
            "first_ground_contact_s": s.mbs.first_ground_contact_s,
            "spread": s.spread,
            "warnings": s.mbs.warnings,
        },
        "validation": validation,
        "output": s.folder,
    })
}
