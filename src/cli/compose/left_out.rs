//! What the runs left out, in words for the report.

use crate::report::LeftOutRow;
use crate::validate::left_out::{RunKind, Skipped};
use crate::validate::{HybridValidation, LeftOut};

/// A row for each thing that a run left out.
pub fn rows(list: &[LeftOut]) -> Vec<LeftOutRow> {
    list.iter().map(row).collect()
}

fn row(l: &LeftOut) -> LeftOutRow {
    let run = match l.run {
        RunKind::Fe => "FE",
        RunKind::Hybrid => "hybrid",
        RunKind::Mbs => "MBS",
    };
    let (what, unit) = words(l.what);
    LeftOutRow {
        run: run.into(),
        what: what.into(),
        left_out: l.left_out,
        of: l.of,
        unit: unit.into(),
        computed_by: l.switched_off_by.clone(),
    }
}

/// What is left out, and what of.
fn words(what: Skipped) -> (&'static str, &'static str) {
    match what {
        Skipped::RigidElements => ("elements of rigid parts", "elements × steps"),
        Skipped::RestingElements => {
            ("elements whose nodes stand still: they keep their forces", "elements × steps")
        }
        Skipped::EndedElements => ("elements that have failed or were removed", "elements × steps"),
        Skipped::ContactSearches => {
            ("search for parts that meet: none can have come so near since the last one", "steps")
        }
        Skipped::ContactPairs => ("pairs of solids that cannot have met yet", "pairs × steps"),
        Skipped::QuietSteps => ("contact: no pair at all can meet in the step", "steps"),
        Skipped::SleepingBodies => ("bodies asleep, where the model lets bodies sleep", "bodies × steps"),
        Skipped::HeldBodies => ("bodies that latent sections make a part of another one", "bodies × steps"),
        Skipped::UnwatchedHinges => {
            ("forces in latent hinges: no rule about events has asked for them", "latent hinges × steps")
        }
        Skipped::BoundedLooks => (
            "forces in latent hinges that rules have asked for: their loads have changed by less than what they have left",
            "looks",
        ),
    }
}

/// How far the time of runs tells what that saved.
pub fn note(list: &[LeftOut], hybrid: Option<&HybridValidation>) -> Option<String> {
    let hybrid = hybrid.map(|h| {
        format!("With rigid parts the FE run took {:.0} % of its processor time. ", 100.0 * h.cpu_share)
    });
    (!list.is_empty()).then(|| {
        format!(
            "Counted in the runs of this report. {}What another line saves of the time a run with its option tells; lines without one cannot be switched off.",
            hybrid.unwrap_or_default()
        )
    })
}
