//! The strain rate that best tells ends that turn from those that do not, against the critical rate of the seed paper.

use super::Case;
use super::tree::MISS_COST;
use crate::study::TURNED_RAD;

/// A threshold of the strain rate at one kind of ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Rate {
    /// Column or beam.
    pub kind: &'static str,
    /// Ends, and those of them that turned.
    pub ends: [usize; 2],
    /// The threshold of least cost \[1/s\].
    pub best_1_s: f64,
    /// The smallest and the largest one when one building at a time is left out \[1/s\].
    pub range_1_s: [f64; 2],
    /// Misses and false alarms at the threshold of least cost.
    pub errors: [usize; 2],
    /// The same at the critical rate of the studies.
    pub errors_at_critical: [usize; 2],
    /// That rate \[1/s\].
    pub critical_1_s: f64,
}

/// An end: its building, the largest strain rate, and whether it turned.
type Point = (usize, f64, bool);

/// Thresholds of column and beam ends of all studies; kinds without an end that turned are left out.
pub fn rates(cases: &[Case]) -> Vec<Rate> {
    ["column", "beam"].into_iter().filter_map(|kind| rate(cases, kind)).collect()
}

fn rate(cases: &[Case], kind: &'static str) -> Option<Rate> {
    let mut points: Vec<Point> = Vec::new();
    for (building, case) in cases.iter().enumerate() {
        for zone in &case.study.facts.ends {
            let subject = case.known.ends.iter().find(|s| s.id == zone.id);
            let of_kind = subject.is_some_and(|s| s.features.get("member.kind") == Some(&kind.into()));
            if let Some(rotation) = zone.rotation_rad.filter(|_| of_kind) {
                points.push((building, zone.peak_rate_1_s, rotation > TURNED_RAD));
            }
        }
    }
    let turned = points.iter().filter(|p| p.2).count();
    if turned == 0 || turned == points.len() {
        return None;
    }
    let best = best(&points, None);
    let without: Vec<f64> = (0..cases.len()).map(|b| self::best(&points, Some(b))).collect();
    let critical = cases.first()?.study.facts.critical_rate_1_s;
    Some(Rate {
        kind,
        ends: [points.len(), turned],
        best_1_s: best,
        range_1_s: [
            without.iter().copied().fold(best, f64::min),
            without.iter().copied().fold(best, f64::max),
        ],
        errors: errors(&points, best),
        errors_at_critical: errors(&points, critical),
        critical_1_s: critical,
    })
}

/// The threshold of least cost, a multiple of 0.01 1/s; each building weighs the same.
fn best(points: &[Point], without: Option<usize>) -> f64 {
    let mut places = std::collections::BTreeMap::<usize, f64>::new();
    let used: Vec<&Point> = points.iter().filter(|p| Some(p.0) != without).collect();
    used.iter().for_each(|p| *places.entry(p.0).or_default() += 1.0);
    let cost = |at: f64| {
        let of = |p: &&Point| match (p.2, p.1 > at) {
            (true, false) => MISS_COST / places[&p.0],
            (false, true) => 1.0 / places[&p.0],
            _ => 0.0,
        };
        used.iter().map(of).sum::<f64>()
    };
    let tries = (1..=100).map(|i| f64::from(i) / 100.0).map(|at| (cost(at), at));
    tries.reduce(|a, b| if b.0 < a.0 - 1e-9 { b } else { a }).map_or(0.0, |(_, at)| at)
}

/// Misses and false alarms.
fn errors(points: &[Point], at: f64) -> [usize; 2] {
    let count = |turned: bool| points.iter().filter(|p| p.2 == turned && (p.1 > at) != turned).count();
    [count(true), count(false)]
}
