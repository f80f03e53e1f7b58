//! Thinning of curves, so that a record stays below [`RECORD_LIMIT_BYTES`].
//!
//! Points are kept in the order of how much the polygon would change without them (the greedy
//! refinement of Douglas and Peucker, 1973): the ends, the peak, the point at rest of a line that goes both ways, then at each stage the point farthest
//! (in moment) from the polygon of those kept. Kept points keep their coordinates.

use super::entry::{Entry, RECORD_LIMIT_BYTES};

/// Largest number of points of a curve, before the size of the record asks for fewer.
pub const POINTS_LIMIT: usize = 40;

/// At most `limit` points of a curve, chosen as above; at least the ends, the peak and the point at zero, if it has one.
pub fn thinned(points: &[[f64; 2]], limit: usize) -> Vec<[f64; 2]> {
    let limit = limit.max(3);
    if points.len() <= limit {
        return points.to_vec();
    }
    let mut kept = vec![false; points.len()];
    let peak = (0..points.len())
        .fold(0, |best, i| if points[i][1].abs() > points[best][1].abs() { i } else { best });
    // without the point at zero the polygon has a force at rest
    let at_rest = points.iter().position(|p| p[0] == 0.0).unwrap_or(0);
    for index in [0, peak, at_rest, points.len() - 1] {
        kept[index] = true;
    }
    while kept.iter().filter(|k| **k).count() < limit {
        let Some(farthest) = farthest(points, &kept) else { break };
        kept[farthest] = true;
    }
    points.iter().zip(&kept).filter(|(_, k)| **k).map(|(p, _)| *p).collect()
}

/// The dropped point with the largest distance, in moment, from the polygon of the kept ones.
fn farthest(points: &[[f64; 2]], kept: &[bool]) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    let mut left = 0;
    while let Some(right) = (left + 1..points.len()).find(|&i| kept[i]) {
        let (a, b) = (points[left], points[right]);
        for (i, point) in points.iter().enumerate().take(right).skip(left + 1) {
            let share = if b[0] > a[0] { (point[0] - a[0]) / (b[0] - a[0]) } else { 0.0 };
            let distance = (point[1] - (a[1] + share * (b[1] - a[1]))).abs();
            if best.is_none_or(|(_, largest)| distance > largest) {
                best = Some((i, distance));
            }
        }
        left = right;
    }
    best.filter(|(_, distance)| *distance > 0.0).map(|(i, _)| i)
}

/// Rounds and thins the curves of an entry until its text is below the limit (or no further gain is
/// possible; the store then refuses the entry).
pub(super) fn fit(entry: &mut Entry) -> Result<(), serde_json::Error> {
    for line in lines(entry) {
        line.iter_mut().flatten().for_each(|x| *x = rounded(*x));
        line.dedup_by(|a, b| a[0] == b[0]);
    }
    let original: Vec<Vec<[f64; 2]>> = lines(entry).into_iter().map(|line| line.clone()).collect();
    for limit in [POINTS_LIMIT, 32, 26, 20, 16, 12, 9, 7, 5] {
        for (line, full) in lines(entry).into_iter().zip(&original) {
            *line = thinned(full, limit);
        }
        if entry.to_text()?.len() < RECORD_LIMIT_BYTES {
            break;
        }
    }
    Ok(())
}

/// All lists of points of an entry.
fn lines(entry: &mut Entry) -> Vec<&mut Vec<[f64; 2]>> {
    let mut all = Vec::new();
    for axis in &mut entry.axes {
        all.extend(axis.envelopes.iter_mut().map(|l| &mut l.points));
        all.extend(axis.curve.levels.iter_mut().map(|l| &mut l.capacity));
        if let Some(reverse) = &mut axis.reverse {
            all.extend(reverse.envelopes.iter_mut().map(|l| &mut l.points));
            all.extend(reverse.curve.levels.iter_mut().map(|l| &mut l.capacity));
        }
    }
    all.extend(entry.springs.iter_mut().flat_map(|s| &mut s.levels).map(|l| &mut l.points));
    all
}

/// A number with 9 significant digits (a relative change below 5·10⁻⁹, far below what an explicit run resolves).
fn rounded(x: f64) -> f64 {
    if x == 0.0 || !x.is_finite() { x } else { format!("{x:.8e}").parse().unwrap_or(x) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_ends_peak_and_shape() {
        // Elastic to 0.01 rad, plateau, drop at 0.08 rad.
        let moment = |x: f64| {
            if x < 0.01 {
                x * 1e7
            } else if x < 0.08 {
                1e5 + 1e4 * x
            } else {
                2e4
            }
        };
        let points: Vec<[f64; 2]> = (0..=1000).map(|i| f64::from(i) * 1e-4).map(|x| [x, moment(x)]).collect();
        let few = thinned(&points, 6);
        assert!(few.len() <= 6);
        assert_eq!((few[0], few[few.len() - 1]), (points[0], points[1000]));
        let at = |x: f64| {
            let right = few.iter().position(|p| p[0] >= x).unwrap().max(1);
            let (a, b) = (few[right - 1], few[right]);
            a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0])
        };
        let worst = points.iter().map(|p| (at(p[0]) - p[1]).abs()).fold(0.0, f64::max);
        assert!(worst < 1.0, "{worst}");
        assert_eq!(thinned(&points[..5], 6), &points[..5]);
    }

    /// Pulled, a spring cracks at 300 kN and 0.1 mm; pressed, it is as stiff up to 3 MN: the origin lies on a straight line.
    #[test]
    fn what_goes_both_ways_is_at_rest_at_zero() {
        let force = |x: f64| if x < -1e-4 { -3e5 + 2e4 * libm::sin(3e3 * x) } else { 3e9 * x };
        let points: Vec<[f64; 2]> =
            (-40..=40).map(|i| 2.5e-5 * f64::from(i)).map(|x| [x, force(x)]).collect();
        for limit in [5, 12, 40] {
            let few = thinned(&points, limit);
            assert!(few.len() <= limit && few.contains(&[0.0, 0.0]), "{few:?}");
        }
    }

    #[test]
    fn rounding_keeps_nine_digits() {
        assert_eq!(rounded(123_456.789_123_456), 123_456.789);
        assert_eq!(rounded(-1.234_567_894_9e-5), -1.234_567_89e-5);
        assert_eq!(rounded(0.0), 0.0);
    }
}
