//! What a report shows of an MBS run that is compared with nothing.

use super::marks::{is_active, point_of};
use super::scene::removed_s;
use super::{Pieces, common, left_out};
use crate::cli::verdict::energy_warning;
use crate::mbs::latent::live_s;
use crate::mbs::model::Bushing;
use crate::mbs::result::EventKind;
use crate::report::{HingeSite, History, ReportInput, Status, Verdict};
use crate::study::COLLAPSE_DROP_M;
use crate::validate::left_out::of_mbs;
use crate::validate::spread::UNDECIDED_M;
use crate::validate::undecided::moving_note;
use std::collections::BTreeMap;

/// The input of a report of the MBS run alone.
pub fn input(p: &Pieces) -> ReportInput {
    let left_out = of_mbs(p.mbs);
    ReportInput {
        title: "Run of the generated multibody model".into(),
        mbs_alone: true,
        verdict: verdict(p),
        histories: histories(p),
        hinge_sites: hinges(p),
        left_out: left_out::rows(&left_out),
        left_out_note: left_out::note(&left_out, None),
        ..common(p)
    }
}

/// What the run shows, and that nobody knows yet how near that is to FE.
fn verdict(p: &Pieces) -> Verdict {
    let ground = match p.mbs.first_ground_contact_s {
        Some(t) => format!("first ground contact at {t:.3} s"),
        None => match p.mbs.times_s.last() {
            Some(end_s) => format!("nothing touches the ground up to its end at {end_s:.3} s"),
            None => "nothing touches the ground".into(),
        },
    };
    let is_open = p.building.ends_soon().is_some() || still_moves(p).is_some();
    let headline = match (p.mbs_collapsed(), is_open) {
        _ if p.mbs.tracked.is_empty() => {
            format!("No point is tracked that tells whether the structure collapses in the MBS run: {ground}")
        }
        (true, _) => format!("The structure collapses in the MBS run: {ground}"),
        (false, true) => {
            format!("The MBS run ends too early to tell whether the structure collapses: {ground}")
        }
        (false, false) => format!("The structure does not collapse in the MBS run: {ground}"),
    };
    Verdict {
        headline,
        status: Status::Unknown,
        detail: format!(
            "A structure counts as collapsed where a tracked point falls by more than {COLLAPSE_DROP_M} m. Not compared with FE: how near this is to the detailed model is not known. `fallwerk generate-mbs --validate` runs and compares both."
        ),
    }
}

/// That the building has not come down yet, and still moves.
fn still_moves(p: &Pieces) -> Option<String> {
    let points = p.mbs.tracked.iter().map(|t| (t.id.as_str(), &t.displacement_m[..]));
    moving_note(p.mbs_collapsed(), &p.mbs.times_s, points)
}

/// Why what the run shows is in doubt.
pub fn doubts(p: &Pieces) -> Vec<String> {
    let apart = p.spread.filter(|s| s.largest_m >= UNDECIDED_M);
    let energy = energy_warning(p.mbs.energy_error);
    still_moves(p).into_iter().chain(energy).chain(apart.map(|s| format!("MBS: {}.", s.words()))).collect()
}

fn histories(p: &Pieces) -> Vec<History> {
    let of = |point: &crate::mbs::result::TrackedHistory| History {
        point: point.id.clone(),
        time_s: p.mbs.times_s.clone(),
        mbs_m: point.displacement_m.clone(),
        ..History::default()
    };
    p.mbs.tracked.iter().map(of).collect()
}

/// The hinges and latent sections of the model, with what became of them.
fn hinges(p: &Pieces) -> Vec<HingeSite> {
    let live_s = live_s(&p.generated.model, p.mbs);
    let of = |bushing| {
        let names = Bushing::hinges(bushing).into_iter().enumerate();
        names.map(|hinge| site(p, &live_s, bushing, hinge)).collect::<Vec<HingeSite>>()
    };
    p.generated.model.bushings.iter().flat_map(of).collect()
}

/// What became of the hinge with a number among those of a bushing; `live_s` says when latent ones went live.
pub(super) fn site(
    p: &Pieces,
    live_s: &BTreeMap<&str, f64>,
    bushing: &Bushing,
    (k, name): (usize, &str),
) -> HingeSite {
    let first_s =
        |is: &dyn Fn(&EventKind) -> bool| p.mbs.events.iter().find(|e| is(&e.kind)).map(|e| e.time_s);
    let yielded_s = first_s(&|kind| matches!(kind, EventKind::Yield { joint } if joint == name));
    let counts = is_active(p.mbs, name);
    let history = p.mbs.hinges.iter().find(|h| h.joint == name);
    let latent = live_s.get(bushing.id.as_str());
    HingeSite {
        member_end: name.into(),
        point_m: point_of(bushing, k),
        // the ends of a beam may be at either of its bodies
        body: bushing.beam.is_none().then(|| bushing.body_b.clone()),
        removed_s: removed_s(&p.generated.model, &bushing.body_b),
        mbs_hinge: true,
        mbs_latent: latent.is_some(),
        mbs_live_s: latent.copied().filter(|t| t.is_finite()),
        mbs_yielded_s: yielded_s.filter(|_| counts),
        mbs_slight_s: yielded_s.filter(|_| !counts),
        mbs_max_plastic_rotation_rad: history
            .map(|h| h.plastic_rotation_rad.iter().copied().fold(0.0, f64::max)),
        mbs_fractured_s: first_s(&|kind| matches!(kind, EventKind::Fracture { joint, .. } if joint == name)),
        ..HingeSite::default()
    }
}
