//! Tracked points of a run against those of the FE run, and which of them become debris there.
//!
//! A slab corner is the node at that corner. Once its elements have failed the node is a point mass that flies freely, and its path says nothing
//! about the slab. Such points stay in the error over all points, which is how the measure is defined; beside it stands the error without them.

use super::measure::{Displacement, at, error_after, error_curve};
use crate::fe::result::{FeRun, History};
use serde::{Deserialize, Serialize};

/// A tracked point whose elements fail in a run: from then on it is debris, or stays where the last of its member was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct DebrisPoint {
    /// Tracked point id.
    pub point: String,
    /// First output at which it was debris \[s\].
    pub from_s: f64,
}

/// The tracked points of a run that become debris.
pub fn debris(run: &FeRun) -> Vec<DebrisPoint> {
    let point = |h: &History| h.debris_s.map(|from_s| DebrisPoint { point: h.id.clone(), from_s });
    run.tracked.iter().filter_map(point).collect()
}

/// Errors of a run's tracked points against the FE run, over the output times that both have.
pub struct PointErrors<'a> {
    /// Common output times \[s\].
    pub times_s: Vec<f64>,
    /// Histories of the run and of FE, of each point that both have.
    pub pairs: Vec<(&'a Displacement, &'a Displacement)>,
    /// How many of them do not become debris in the FE run.
    pub whole: usize,
    /// `e(T)` over all points.
    pub curve: Vec<f64>,
    /// `e(T)` over the points that do not become debris in the FE run.
    pub curve_without_debris: Vec<f64>,
}

impl<'a> PointErrors<'a> {
    /// Compares the histories `of` a run, at `outputs` times, with those of an FE run at its times \[s\].
    pub fn of(
        fe_times_s: &[f64],
        fe: &'a [History],
        outputs: usize,
        of: impl Fn(&str) -> Option<&'a Displacement>,
    ) -> Self {
        let times = fe_times_s.len().min(outputs);
        let (mut pairs, mut whole) = (Vec::new(), Vec::new());
        for point in fe {
            let Some(history) = of(&point.id) else { continue };
            let pair = (&history[..times], &point.displacement_m[..times]);
            pairs.push(pair);
            if point.debris_s.is_none() {
                whole.push(pair);
            }
        }
        let times_s = fe_times_s[..times].to_vec();
        let (curve, curve_without_debris) = (error_curve(&times_s, &pairs), error_curve(&times_s, &whole));
        Self { times_s, whole: whole.len(), pairs, curve, curve_without_debris }
    }

    /// The error from a time \[s\] to the end ([`error_after`]); `None` if there is no such time.
    pub fn after(&self, time_s: Option<f64>) -> Option<f64> {
        error_after(&self.times_s, &self.pairs, time_s?)
    }

    /// The error up to a time \[s\], or to the end if there is none; `None` where nothing is compared.
    pub fn until(&self, time_s: Option<f64>) -> Option<f64> {
        let error = at(&self.times_s, &self.curve, time_s.unwrap_or(f64::INFINITY));
        error.filter(|_| !self.pairs.is_empty())
    }

    /// The error up to the end over the points that do not become debris; `None` if there are none.
    pub fn without_debris(&self) -> Option<f64> {
        self.curve_without_debris.last().copied().filter(|_| self.whole > 0)
    }
}
