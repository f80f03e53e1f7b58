//! What a comparison cannot tell: runs that end before the outcome is certain, and runs with nothing to compare.

use super::points::PointErrors;
use crate::base::vector::{norm, sub};
use crate::building::Building;
use crate::fe::result::FeRun;
use crate::mbs::RunResult;
use crate::study::{COLLAPSE_DROP_M, fell};
use serde::{Deserialize, Serialize};

/// Why a comparison does not tell whether the MBS agrees with FE.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Undecided {
    /// What kind of reason it is.
    pub kind: Doubt,
    /// The reason in a sentence, with what helps.
    pub words: String,
}

/// Kinds of reasons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Doubt {
    /// No tracked point is in both runs.
    NothingCompared,
    /// The runs end before the last charge, or soon after it, and the building has not collapsed in both.
    EndsSoon,
    /// The building has not collapsed in a run, and still moves at its end.
    StillMoves,
}

/// Speed of a tracked point from which what has not come down is not at rest either \[m/s\].
const MOVES_M_S: f64 = 1.0;
/// Time over which slow motion is told from swings about rest: its way in two of these, one after the other \[s\].
const PACE_S: f64 = 0.5;
/// Share of its speed that slow motion keeps from one [`PACE_S`] to the next. What slows by no more has another `PACE_S KEEPS / (1 - KEEPS)` of its speed to go, 4.5 s.
const KEEPS: f64 = 0.9;
/// Part of these 4.5 s for which it is taken to go on \[s\].
const AHEAD_S: f64 = 2.0;
/// Way in this time below which it is none \[m\].
const LEAST_M: f64 = 0.1;

/// A tracked point with its displacements \[m\].
type Moved<'a> = (&'a str, &'a [[f64; 3]]);

/// The fastest of some points at the end of a run that has not come to rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fastest<'a> {
    /// Its name.
    pub id: &'a str,
    /// Its speed over the last output interval \[m/s\].
    pub speed_m_s: f64,
    /// The end of the run \[s\].
    pub end_s: f64,
}

impl<'a> Fastest<'a> {
    /// Of points with their displacements at some times; none where all are as good as at rest.
    pub fn of(times_s: &[f64], points: impl Iterator<Item = (&'a str, &'a [[f64; 3]])>) -> Option<Self> {
        let [.., before, end_s] = times_s[..] else { return None };
        let speed = |u: &[[f64; 3]]| match u {
            [.., a, b] => norm(sub(*b, *a)) / (end_s - before),
            _ => 0.0,
        };
        let (id, speed_m_s) = points.map(|(id, u)| (id, speed(u))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        (speed_m_s > MOVES_M_S).then_some(Self { id, speed_m_s, end_s })
    }
}

/// FE runs by name and the MBS run in which the building has come down and still moves at the end, and what moves fastest in each.
pub fn falling<'a>(
    fe: impl Iterator<Item = (&'static str, &'a FeRun)>,
    mbs: &'a RunResult,
) -> Vec<(&'static str, Fastest<'a>)> {
    let of_fe = fe.map(|(name, run)| {
        // what flies freely has left the building
        let points = run.tracked.iter().filter(|h| h.debris_s.is_none());
        (name, &run.times_s[..], points.map(|h| (h.id.as_str(), &h.displacement_m[..])).collect())
    });
    let of_mbs = mbs.tracked.iter().map(|h| (h.id.as_str(), &h.displacement_m[..])).collect();
    let runs: Vec<(&'static str, &'a [f64], Vec<Moved<'a>>)> =
        of_fe.chain([("MBS", &mbs.times_s[..], of_mbs)]).collect();
    let fallen = runs.into_iter().filter(|(_, _, points)| points.iter().any(|(_, u)| fell(u)));
    fallen
        .filter_map(|(name, times_s, points)| Some((name, Fastest::of(times_s, points.into_iter())?)))
        .collect()
}

/// What runs by name show of a building that was still falling at their end, in a sentence; `None` if there is none.
pub fn falling_words(runs: &[(&str, Fastest)]) -> Option<String> {
    let end_s = runs.iter().map(|(_, f)| f.end_s).reduce(f64::max)?;
    let moves: Vec<String> = runs
        .iter()
        .map(|(run, f)| format!("\"{}\" at {:.1} m/s in the {run} run", f.id, f.speed_m_s))
        .collect();
    // sums of output intervals have more digits than anyone gave
    let end_s = (1e4 * end_s).round() / 1e4;
    Some(format!(
        "at the end, {end_s} s, what comes down still moves, {}: debris and displacements are those of that moment, and what comes to rest may reach farther; give a later settings.end_time",
        moves.join(", ")
    ))
}

/// A point that goes away from its place slowly and steadily at the end of a run: `[distance (m), speed (m/s)]`, if at this speed it soon has come as far as counts as collapse.
fn leaving(times_s: &[f64], displacement_m: &[[f64; 3]]) -> Option<[f64; 2]> {
    let end_s = *times_s.last()?;
    let at = |back_s: f64| {
        // outputs are sums of intervals
        let next = times_s.partition_point(|t| *t <= end_s - back_s + 1e-6);
        let i = next.checked_sub(1)?;
        Some((times_s[i], norm(*displacement_m.get(i)?)))
    };
    let [first, middle, last] = [at(2.0 * PACE_S)?, at(PACE_S)?, at(0.0)?];
    let speed = |a: (f64, f64), b: (f64, f64)| (b.1 - a.1) / (b.0 - a.0);
    let [before, now] = [speed(first, middle), speed(middle, last)];
    let (far, way) = (last.1, AHEAD_S * now);
    let goes_on = before > 0.0 && now >= KEEPS * before;
    (goes_on && way > LEAST_M && far + way > COLLAPSE_DROP_M).then_some([far, now])
}

/// That a building which has not collapsed by the end of a run still moves, if one of the points does, for the times of their displacements.
pub fn moving_note<'a>(
    collapsed: bool,
    times_s: &[f64],
    points: impl Iterator<Item = (&'a str, &'a [[f64; 3]])>,
) -> Option<String> {
    let end_s = *times_s.last().filter(|_| !collapsed)?;
    let points: Vec<Moved> = points.collect();
    let moves = match Fastest::of(times_s, points.iter().copied()) {
        Some(Fastest { id, speed_m_s, .. }) => format!("\"{id}\" still moves at {speed_m_s:.1} m/s"),
        None => {
            let steady = points.iter().filter_map(|(id, u)| Some((id, leaving(times_s, u)?)));
            let (id, [far, speed_m_s]) = steady.max_by(|a, b| a.1[0].total_cmp(&b.1[0]))?;
            format!("\"{id}\" is {far:.2} m from its place and goes on at {speed_m_s:.2} m/s")
        }
    };
    Some(format!(
        "at the end, {end_s:.4} s, {moves}: too soon to tell whether it collapses; give a later settings.end_time"
    ))
}

/// All reasons of a comparison of two runs of a building, which collapses in FE and in the MBS or not.
pub(super) fn reasons(
    building: &Building,
    (fe, mbs): (&FeRun, &RunResult),
    errors: &PointErrors,
    collapsed: [bool; 2],
) -> Vec<Undecided> {
    let mut reasons = Vec::new();
    let mut tell = |kind, words: String| reasons.push(Undecided { kind, words });
    if errors.pairs.is_empty() {
        let why = if fe.tracked.is_empty() {
            "the building has no column tops, slab corners or floors to track"
        } else {
            "no tracked point is in both runs"
        };
        tell(Doubt::NothingCompared, format!("nothing was compared: {why}"));
    }
    if collapsed != [true; 2] {
        building.ends_soon().into_iter().for_each(|words| tell(Doubt::EndsSoon, words));
    }
    let of_fe = fe.tracked.iter().map(|h| (h.id.as_str(), &h.displacement_m[..]));
    let of_mbs = mbs.tracked.iter().map(|h| (h.id.as_str(), &h.displacement_m[..]));
    let moving = [
        ("FE", moving_note(collapsed[0], &fe.times_s, of_fe)),
        ("MBS", moving_note(collapsed[1], &mbs.times_s, of_mbs)),
    ];
    for (name, note) in moving {
        note.into_iter().for_each(|note| tell(Doubt::StillMoves, format!("{name} run: {note}")));
    }
    reasons
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_still_falls_at_the_end_says_so() {
        let (slow, fast) = ([[0.0; 3], [0.0, 0.0, -0.05]], [[0.0, 0.0, -7.0], [0.0, -0.6, -7.8]]);
        let points = || [("rear", &slow[..]), ("front", &fast[..])].into_iter();
        let times_s = [0.1, 0.1 + 0.2];
        let fastest = Fastest::of(&times_s, points()).unwrap();
        let told = falling_words(&[("FE", fastest), ("MBS", Fastest { speed_m_s: 4.0, ..fastest })]).unwrap();
        let moves = "at the end, 0.3 s, what comes down still moves, \"front\" at 5.0 m/s in the FE run, \"front\" at 4.0 m/s in the MBS run: debris";
        assert!(told.starts_with(moves), "{told}");
        assert_eq!(falling_words(&[]), None);
        assert_eq!(Fastest::of(&times_s, points().take(1)), None, "0.25 m/s is as good as at rest");
        assert_eq!(Fastest::of(&times_s[..1], points()), None, "no interval, no speed");
        assert!(
            moving_note(false, &times_s, points()).is_some()
                && moving_note(true, &times_s, points()).is_none()
        );
    }

    /// A building that falls slowly (a frame under the moon's gravity went at 0.4 m/s for seconds before it came down) is told from one that swings, creeps to rest, or stands where it has slid to.
    #[test]
    fn what_goes_slowly_and_steadily_is_not_at_rest() {
        let times_s: Vec<f64> = (0..=250).map(|i| 0.01 * f64::from(i)).collect();
        let note = |far: &dyn Fn(f64) -> f64| {
            // along (0, -0.8, -0.6)
            let u: Vec<[f64; 3]> = times_s.iter().map(|t| [0.0, -0.8 * far(*t), -0.6 * far(*t)]).collect();
            moving_note(false, &times_s, [("corner", &u[..])].into_iter())
        };
        let falls = note(&|t| 0.36 * t).unwrap();
        assert!(falls.contains("\"corner\" is 0.90 m from its place and goes on at 0.36 m/s"), "{falls}");
        assert!(note(&|t| 0.16 * t).is_none(), "0.72 m in two more seconds");
        assert!(note(&|t| 0.9 * (1.0 - (-2.0 * t).exp())).is_none(), "creeps to rest");
        for phase in 0..20 {
            let swing = |t: f64| 0.6 + 0.1 * (5.0 * t + 0.314 * f64::from(phase)).sin();
            assert!(note(&swing).is_none(), "swings in 1.26 s, {phase}");
        }
        assert!(note(&|t| 1.2 + 0.01 * t).is_none(), "has slid");
        assert!(note(&|_| 0.0).is_none());
    }
}
