//! `fallwerk fe --against`: the error of a run's tracked points against another FE run of the same building.

use super::Failure;
use super::verdict::seconds;
use crate::base::json;
use crate::fe::result::{FeRun, History};
use crate::validate::measure::at;
use crate::validate::points::PointErrors;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// What is read of an `fe.json`.
#[derive(Deserialize)]
struct Reference {
    times_s: Vec<f64>,
    tracked: Vec<History>,
    summary: Contact,
}

#[derive(Deserialize)]
struct Contact {
    first_ground_contact_s: Option<f64>,
}

/// The run to compare with.
pub(super) struct Other {
    path: PathBuf,
    reference: Reference,
}

fn bad(path: &Path, what: &str) -> Failure {
    let path = path.display();
    Failure::input(format!("--against {path}: {what}; give the fe.json of an FE run of the same building"))
}

impl Other {
    /// Reads the `fe.json` at `path`: before a run, which is not to be lost to a wrong name.
    pub(super) fn read(path: &Path) -> Result<Self, Failure> {
        let text = std::fs::read_to_string(path).map_err(|e| bad(path, &format!("cannot be read: {e}")))?;
        let reference =
            json::from_text(&text).map_err(|e| bad(path, &format!("is no result of an FE run: {e}")))?;
        Ok(Self { path: path.to_path_buf(), reference })
    }
}

/// The comparison.
pub(super) struct Against {
    to_contact: Option<f64>,
    after_contact: Option<f64>,
    to_end: Option<f64>,
    /// Points that become debris in the other run, and the error to the end without them.
    without_debris: (usize, Option<f64>),
    contact_s: [Option<f64>; 2],
    end_s: f64,
    curve: Vec<f64>,
}

impl Against {
    /// Compares the tracked points of a run with those of another one.
    pub(super) fn of(other: &Other, run: &FeRun) -> Result<Self, Failure> {
        let Other { path, reference } = other;
        let bad = |what: &str| bad(path, what);
        let times = run.times_s.len().min(reference.times_s.len());
        let same = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9;
        if !run.times_s[..times].iter().zip(&reference.times_s).all(same) {
            return Err(bad("its outputs are at other times"));
        }
        for point in &run.tracked {
            let of = reference.tracked.iter().find(|p| p.id == point.id);
            let of = of.ok_or_else(|| bad(&format!("it has no tracked point `{}`", point.id)))?;
            if of.displacement_m.len() < times {
                return Err(bad(&format!("the history of `{}` is too short", point.id)));
            }
        }
        let history = |id: &str| run.tracked.iter().find(|p| p.id == id).map(|p| &p.displacement_m[..]);
        let errors = PointErrors::of(&reference.times_s, &reference.tracked, run.times_s.len(), history);
        let compared = |p: &&History| p.debris_s.is_some() && history(&p.id).is_some();
        let debris = reference.tracked.iter().filter(compared).count();
        let contact_s = [reference.summary.first_ground_contact_s, run.summary.first_ground_contact_s];
        Ok(Self {
            to_contact: contact_s[0].and_then(|t| at(&errors.times_s, &errors.curve, t)),
            after_contact: errors.after(contact_s[0]),
            to_end: errors.until(None),
            without_debris: (debris, errors.without_debris()),
            contact_s,
            end_s: run.times_s[times - 1],
            curve: errors.curve,
        })
    }

    /// In words.
    pub(super) fn words(&self) -> String {
        let [theirs, own] = self.contact_s.map(seconds);
        let [to_contact, after, to_end, without] =
            [self.to_contact, self.after_contact, self.to_end, self.without_debris.1]
                .map(|e| e.map_or("-".to_string(), |e| format!("{e:.4}")));
        let debris = match self.without_debris.0 {
            0 => String::new(),
            1 => format!(" ({without} without the point that becomes debris there)"),
            points => format!(" ({without} without {points} points that become debris there)"),
        };
        format!(
            "  against the other run: error e = {to_contact} to its first contact, {after} from there on, {to_end} to {:.3} s{debris}; first ground contact {own}, there {theirs}\n",
            self.end_s
        )
    }

    /// As JSON.
    pub(super) fn json(&self) -> serde_json::Value {
        serde_json::json!({
            "e_to_contact": self.to_contact,
            "e_after_contact": self.after_contact,
            "e_to_end": self.to_end,
            "debris_points": self.without_debris.0,
            "e_to_end_without_debris": self.without_debris.1,
            "first_contact_s": { "reference": self.contact_s[0], "run": self.contact_s[1] },
            "e_curve": self.curve,
        })
    }
}
