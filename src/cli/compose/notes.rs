//! Warnings and notes of a report.

use super::{Pieces, alone};
use crate::fe::result::FeRun;
use crate::mbs::run::OFF_BALANCE;
use crate::report::{Note, Severity};
use crate::validate::LIMIT_ENERGY;
use crate::validate::spread::UNDECIDED_M;
use crate::validate::undecided::falling_words;

/// What the terms of the energies include, in both runs.
const FE_ENERGIES: &str = "FE internal energy includes bulk viscosity and what was in eroded elements, FE external work what leaves with removed members and what dying elements release; ";
const MBS_ENERGIES: &str = "MBS plastic energy includes what separation of joints and removal of bodies release, MBS elastic energy that stored in contacts.";

/// All of them, warnings first.
pub fn notes(p: &Pieces) -> Vec<Note> {
    let warning = |text: &String| Note { severity: Severity::Warning, text: text.clone() };
    let note = |text: String| Note { severity: Severity::Note, text };
    let doubts: Vec<String> = match &p.against {
        Some(a) => a.validation.undecided.iter().map(|u| u.words.clone()).collect(),
        None => alone::doubts(p),
    };
    let early = doubts.iter().filter(|words| !p.generated.notes.contains(words));
    let falling = falling_words(&p.falling());
    let mut notes: Vec<Note> = early.chain(&falling).chain(&p.generated.notes).map(warning).collect();
    // a balance that is off by no more than its limit is no warning
    let is_minor = |w: &&String| w.starts_with(OFF_BALANCE) && p.mbs.energy_error <= LIMIT_ENERGY;
    let (minor, remarks): (Vec<&String>, Vec<&String>) = p.mbs.warnings.iter().partition(is_minor);
    if let Some(first) = remarks.first() {
        let more = remarks.len() - 1;
        let rest = if more > 0 { format!(" ({more} more of the run under Notes)") } else { String::new() };
        notes.push(warning(&format!("MBS run: {first}{rest}")));
    }
    notes.extend(p.against.as_ref().and_then(|a| snapped(a.fe)).map(note));
    if !p.generated.derived.is_empty() {
        notes.push(note(format!(
            "Computed for this model, as the library had no entry: {}.",
            p.generated.derived.join(", ")
        )));
    }
    notes.extend(p.generated.unasked.iter().map(|u| note(format!("Not asked: {}.", u.words()))));
    let of_fe = if p.against.is_some() { FE_ENERGIES } else { "" };
    notes.push(note(format!("Energies: {of_fe}{MBS_ENERGIES}")));
    // beside FE the table of the runs says so
    let certain = p.spread.filter(|s| p.against.is_none() && s.largest_m < UNDECIDED_M);
    notes.extend(certain.map(|s| note(format!("MBS: {}.", s.words()))));
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
