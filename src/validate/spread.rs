//! How far runs come apart that differ by next to nothing.
//!
//! Up to the first contact a collapse is as certain as its model. What lies where afterwards is decided by single impacts, and a symmetric tower falls to a side that its rounding chooses. Runs with gravity changed by
//! [`NUDGE`], far below anything that is known of a building, show how much of a result that is.

use super::points::PointErrors;
use crate::fe::result::FeRun;
use crate::mbs::Model;
use crate::mbs::math::{norm, sub};
use crate::mbs::result::RunResult;
use serde::{Deserialize, Serialize};

/// Relative change of gravity from one run to the next.
pub const NUDGE: f64 = 1e-10;
/// Distance from which places at the end count as undecided \[m\].
pub const UNDECIDED_M: f64 = 0.1;

/// How far apart runs end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// How many runs.
    pub runs: usize,
    /// Relative change of gravity from one to the next.
    pub gravity_change: f64,
    /// Largest distance of a tracked point in two of them at the end \[m\], and the point.
    pub largest_m: f64,
    /// The point.
    pub point: String,
    /// Median of these distances over all tracked points \[m\].
    pub median_m: f64,
    /// Least and largest error against FE over the whole run; `None` without an FE run.
    pub e_total: Option<[f64; 2]>,
}

/// A model whose gravity is changed by so many times [`NUDGE`].
pub fn nudged(model: &Model, times: f64) -> Model {
    let mut model = model.clone();
    model.gravity_m_s2 = model.gravity_m_s2.map(|g| g * (1.0 + times * NUDGE));
    model
}

impl Spread {
    /// Of runs of one model; nothing of fewer than two, or without tracked points.
    pub fn of(runs: &[RunResult]) -> Option<Self> {
        let (first, others) = runs.split_first()?;
        let ends = |point: usize| {
            runs.iter().filter_map(move |r| r.tracked.get(point).and_then(|t| t.displacement_m.last()))
        };
        let apart = |point: usize| {
            let pairs = ends(point).flat_map(|a| ends(point).map(move |b| norm(sub(*a, *b))));
            pairs.fold(0.0, f64::max)
        };
        let mut all: Vec<(f64, &str)> =
            first.tracked.iter().enumerate().map(|(i, t)| (apart(i), t.id.as_str())).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (largest_m, point) = all.last().filter(|_| !others.is_empty())?;
        Some(Self {
            runs: runs.len(),
            gravity_change: NUDGE,
            largest_m: *largest_m,
            point: (*point).into(),
            median_m: all[all.len() / 2].0,
            e_total: None,
        })
    }

    /// The same with the errors of the runs against FE.
    pub fn against(mut self, fe: &FeRun, runs: &[RunResult]) -> Self {
        let e = runs.iter().map(|run| {
            let history = |id: &str| run.tracked.iter().find(|t| t.id == id).map(|t| &t.displacement_m[..]);
            PointErrors::of(&fe.times_s, &fe.tracked, run.times_s.len(), history).until(None)
        });
        let [mut least, mut most] = [f64::INFINITY, 0.0_f64];
        e.flatten().for_each(|e| (least, most) = (least.min(e), most.max(e)));
        self.e_total = (least <= most).then_some([least, most]);
        self
    }

    /// In words.
    pub fn words(&self) -> String {
        let runs = format!("{} runs whose gravity differs by {:e}", self.runs, self.gravity_change);
        if self.largest_m < UNDECIDED_M {
            let apart = self.largest_m;
            return format!(
                "{runs} end within {apart:.1e} m of each other: what lies where does not hang on rounding"
            );
        }
        let error = match self.e_total {
            Some([least, most]) => format!(", with e over the whole run from {least:.3} to {most:.3}"),
            None => String::new(),
        };
        format!(
            "{runs} end up to {:.2} m apart (tracked point {}), {:.2} m in the median{error}: what lies where after the first contact is one outcome of several",
            self.largest_m, self.point, self.median_m
        )
    }
}
