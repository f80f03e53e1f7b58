//! Error measures between two displacement histories.
//!
//! `e(T) = sqrt( Σ_p ∫_0^T |u_a - u_b|² dt / Σ_p ∫_0^T |u_b|² dt )` over tracked points p, with u the displacement from
//! the preloaded state and b the reference (FE). Integrals by the trapezoidal rule over common output times.
//!
//! A reference that never moves by [`LEAST_MOVED_M`] is at rest: what it shows is round-off, nothing to relate a difference to, and `e` is zero.
//!
//! After a time `t_c` alone both integrals run from the last output not after `t_c` to the end: `e_after² Σ∫_c^T |u_b|² = e(T)² Σ∫_0^T |u_b|² - e(t_c)² Σ∫_0^c |u_b|²`.

use std::collections::{BTreeMap, BTreeSet};

/// Displacements of one point: times × 3 \[m\].
pub type Displacement = [[f64; 3]];

/// Displacement that a reference has to reach for an error relative to it: the preload of an FE run leaves less \[m\].
pub const LEAST_MOVED_M: f64 = 1e-6;

/// `e(T)` at every output time; zero where the reference has not moved, at all of them if it never does by [`LEAST_MOVED_M`].
///
/// `pairs` are `(candidate, reference)` histories of the same points on the times `times_s`.
pub fn error_curve(times_s: &[f64], pairs: &[(&Displacement, &Displacement)]) -> Vec<f64> {
    if !moves(pairs) {
        return vec![0.0; times_s.len()];
    }
    integrals(times_s, pairs).into_iter().map(ratio).collect()
}

/// Whether any point of the reference moves at all.
fn moves(pairs: &[(&Displacement, &Displacement)]) -> bool {
    let squares = pairs.iter().flat_map(|(_, b)| b.iter()).map(|u| u.iter().map(|c| c * c).sum::<f64>());
    squares.fold(0.0, f64::max) >= LEAST_MOVED_M * LEAST_MOVED_M
}

/// The error from the last output not after `time_s` to the end; `None` where no output follows it, or the reference has not moved.
///
/// Displacements are those from the preloaded state, not from the pose at that time.
pub fn error_after(times_s: &[f64], pairs: &[(&Displacement, &Displacement)], time_s: f64) -> Option<f64> {
    let sums = integrals(times_s, pairs);
    let [before, end] = [at(times_s, &sums, time_s)?, *sums.last()?];
    let after = [end[0] - before[0], end[1] - before[1]];
    (after[1] > 0.0 && moves(pairs)).then(|| ratio(after))
}

fn ratio([difference, reference]: [f64; 2]) -> f64 {
    if reference > 0.0 { (difference / reference).sqrt() } else { 0.0 }
}

/// Integrals of the squares up to every output time, summed over points: of the difference and of the reference \[m² s\].
fn integrals(times_s: &[f64], pairs: &[(&Displacement, &Displacement)]) -> Vec<[f64; 2]> {
    let mut curve = Vec::with_capacity(times_s.len());
    let (mut difference, mut reference) = (0.0, 0.0);
    let (mut last_difference, mut last_reference) = (0.0, 0.0);
    for (i, time) in times_s.iter().enumerate() {
        let (mut d, mut r) = (0.0, 0.0);
        for (a, b) in pairs {
            d += (0..3).map(|k| (a[i][k] - b[i][k]).powi(2)).sum::<f64>();
            r += (0..3).map(|k| b[i][k].powi(2)).sum::<f64>();
        }
        if i > 0 {
            let dt = time - times_s[i - 1];
            difference += 0.5 * dt * (last_difference + d);
            reference += 0.5 * dt * (last_reference + r);
        }
        (last_difference, last_reference) = (d, r);
        curve.push([difference, reference]);
    }
    curve
}

/// The value of a curve at the last output time not after `time_s`.
pub fn at<T: Copy>(times_s: &[f64], curve: &[T], time_s: f64) -> Option<T> {
    let count = times_s.partition_point(|t| *t <= time_s + 1e-9);
    count.checked_sub(1).and_then(|i| curve.get(i).copied())
}

/// Precision, recall and F1 of found sites against true sites.
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Sites {
    /// Share of the found sites that are true; `None` if nothing was found.
    pub precision: Option<f64>,
    /// Share of the true sites that were found; `None` if there are none.
    pub recall: Option<f64>,
    /// Harmonic mean of both: twice the common ones over all that are true or found; `None` if there are none of either.
    pub f1: Option<f64>,
    /// True sites.
    pub expected: usize,
    /// Found sites.
    pub found: usize,
    /// Both.
    pub common: usize,
}

impl Sites {
    /// Compares flags over the same list of places.
    pub fn of(places: impl Iterator<Item = (bool, bool)>) -> Self {
        let (mut expected, mut found, mut common) = (0, 0, 0);
        for (truth, claim) in places {
            expected += usize::from(truth);
            found += usize::from(claim);
            common += usize::from(truth && claim);
        }
        let share = |part: usize, of: usize| (of > 0).then(|| part as f64 / of as f64);
        Self {
            precision: share(common, found),
            recall: share(common, expected),
            f1: share(2 * common, expected + found),
            expected,
            found,
            common,
        }
    }
}

/// Cells of a plan raster covered by debris.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Footprint {
    cells: BTreeSet<(i64, i64)>,
}

impl Footprint {
    /// Raster width \[m\].
    pub const CELL_M: f64 = 0.1;

    /// Adds the plan projection of a convex set of points (its convex hull) \[m\].
    pub fn add(&mut self, points: &[[f64; 2]]) {
        let hull = convex_hull(points);
        if hull.len() < 3 {
            return;
        }
        let cell = |v: f64| (v / Self::CELL_M).floor() as i64;
        let bound = |i: usize, f: fn(f64, f64) -> f64, start: f64| hull.iter().map(|p| p[i]).fold(start, f);
        let (x0, x1) = (bound(0, f64::min, f64::INFINITY), bound(0, f64::max, f64::NEG_INFINITY));
        let (y0, y1) = (bound(1, f64::min, f64::INFINITY), bound(1, f64::max, f64::NEG_INFINITY));
        for i in cell(x0)..=cell(x1) {
            for j in cell(y0)..=cell(y1) {
                let c = [(i as f64 + 0.5) * Self::CELL_M, (j as f64 + 0.5) * Self::CELL_M];
                if inside(&hull, c) {
                    self.cells.insert((i, j));
                }
            }
        }
    }

    /// Covered area \[m²\].
    pub fn area_m2(&self) -> f64 {
        self.cells.len() as f64 * Self::CELL_M * Self::CELL_M
    }

    /// Closed rings along the edges of the covered cells \[m\], what is covered to their left; corners only.
    pub fn outline(&self) -> Vec<Vec<[f64; 2]>> {
        // each edge between a covered cell and one that is not, by where it starts
        let mut edges: BTreeMap<(i64, i64), Vec<(i64, i64)>> = BTreeMap::new();
        for &(i, j) in &self.cells {
            let around = [
                ((i, j - 1), (i, j), (i + 1, j)),
                ((i + 1, j), (i + 1, j), (i + 1, j + 1)),
                ((i, j + 1), (i + 1, j + 1), (i, j + 1)),
                ((i - 1, j), (i, j + 1), (i, j)),
            ];
            for (_, from, to) in around.into_iter().filter(|(beside, ..)| !self.cells.contains(beside)) {
                edges.entry(from).or_default().push(to);
            }
        }
        let mut rings = Vec::new();
        while let Some(start) = edges.keys().next().copied() {
            let (mut ring, mut at) = (Vec::new(), start);
            while let Some(next) = edges.get_mut(&at).and_then(Vec::pop) {
                ring.push(at);
                at = next;
            }
            edges.retain(|_, to| !to.is_empty());
            rings.push(corners(&ring));
        }
        rings
    }

    /// Area of the intersection over area of the union; 1 for two empty footprints.
    pub fn overlap(&self, other: &Self) -> f64 {
        let union = self.cells.union(&other.cells).count();
        if union == 0 { 1.0 } else { self.cells.intersection(&other.cells).count() as f64 / union as f64 }
    }
}

/// The corners of a closed ring of edges of cells \[m\].
fn corners(ring: &[(i64, i64)]) -> Vec<[f64; 2]> {
    let count = ring.len();
    let turns = |k: &usize| {
        let [before, at, next] = [k + count - 1, *k, k + 1].map(|k| ring[k % count]);
        (at.0 - before.0, at.1 - before.1) != (next.0 - at.0, next.1 - at.1)
    };
    let place = |k: usize| [ring[k].0, ring[k].1].map(|c| c as f64 * Footprint::CELL_M);
    (0..count).filter(turns).map(place).collect()
}

fn cross(o: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
fn convex_hull(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    sorted.dedup();
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while chain.len() >= 2 && cross(chain[chain.len() - 2], chain[chain.len() - 1], p) <= 0.0 {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    hull
}

fn inside(hull: &[[f64; 2]], p: [f64; 2]) -> bool {
    (0..hull.len()).all(|i| cross(hull[i], hull[(i + 1) % hull.len()], p) >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_of_a_scaled_history_is_the_scale() {
        let times: Vec<f64> = (0..11).map(|i| 0.1 * f64::from(i)).collect();
        let b: Vec<[f64; 3]> = times.iter().map(|t| [0.0, t * t, -3.0 * t]).collect();
        let a: Vec<[f64; 3]> = b.iter().map(|u| u.map(|c| 1.1 * c)).collect();
        let e = error_curve(&times, &[(&a, &b), (&b, &b)]);
        assert!((e[10] - 0.1 / 2.0_f64.sqrt()).abs() < 1e-12);
        assert_eq!(at(&times, &e, 0.55), Some(e[5]));
        assert_eq!(at(&times, &e, -1.0), None);
    }

    #[test]
    fn nothing_is_related_to_the_round_off_of_a_reference_at_rest() {
        let times = [0.0, 0.1, 0.2];
        let a = [[0.0, 0.0, -3e-4]; 3];
        let at_rest = [[0.0; 3], [0.0, 0.0, 1e-13], [0.0, 0.0, -9e-7]];
        assert_eq!(error_curve(&times, &[(&a, &at_rest)]), [0.0; 3]);
        assert_eq!(error_after(&times, &[(&a, &at_rest)], 0.1), None);
        // 1 µm, reached in the end: the whole history counts, as before
        let moves = [[0.0, 0.0, 1e-6]; 3];
        let e = error_curve(&times, &[(&a, &moves)]);
        assert!((e[2] - 301.0).abs() < 1e-9, "{e:?}");
    }

    #[test]
    fn the_error_after_a_time_leaves_out_what_was_before() {
        let times: Vec<f64> = (0..21).map(|i| 0.1 * f64::from(i)).collect();
        let b: Vec<[f64; 3]> = times.iter().map(|t| [0.0, 0.0, -t * t]).collect();
        // right up to 1.0 s, a tenth too far from then on
        let a: Vec<[f64; 3]> = b.iter().map(|u| u.map(|c| if c < -1.001 { 1.1 * c } else { c })).collect();
        let pairs: Vec<(&Displacement, &Displacement)> = vec![(&a, &b)];
        let curve = error_curve(&times, &pairs);
        let (to, after) = (at(&times, &curve, 1.0).unwrap(), error_after(&times, &pairs, 1.0).unwrap());
        assert!(to == 0.0 && (after - 0.1).abs() < 1e-3 && after > curve[20], "{to} {after}");
        // the parts make up the whole
        let square = |from: usize, until: usize| {
            let f = |i: usize| times[i].powi(4);
            (from..until).map(|i| 0.05 * (f(i) + f(i + 1))).sum::<f64>()
        };
        let whole = curve[20].powi(2) * square(0, 20);
        let after = error_after(&times, &pairs, 1.25).unwrap();
        let parts = curve[12].powi(2) * square(0, 12) + after.powi(2) * square(12, 20);
        assert!((whole - parts).abs() < 1e-12 * whole, "from the last output before: {whole} {parts}");
        assert!((error_after(&times, &pairs, 0.0).unwrap() - curve[20]).abs() < 1e-14);
        assert_eq!((error_after(&times, &pairs, 2.0), error_after(&times, &pairs, -1.0)), (None, None));
    }

    #[test]
    fn sites_count_misses_and_false_alarms() {
        let s = Sites::of([(true, true), (true, false), (false, true), (false, false)].into_iter());
        assert_eq!((s.precision, s.recall, s.f1), (Some(0.5), Some(0.5), Some(0.5)));
        assert_eq!((s.expected, s.found, s.common), (2, 2, 1));
        assert_eq!(Sites::of(std::iter::empty()), Sites::default(), "no share of nothing");
        let missed = Sites::of([(true, false)].into_iter());
        assert_eq!((missed.precision, missed.recall, missed.f1), (None, Some(0.0), Some(0.0)));
    }

    #[test]
    fn outlines_go_round_what_is_covered_and_round_its_holes() {
        let mut plan = Footprint::default();
        let mut add = |x: [f64; 2], y: [f64; 2]| {
            plan.add(&[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]);
        };
        // a frame around a hole, and a square beside it
        add([0.0, 3.0], [0.0, 1.0]);
        add([0.0, 3.0], [2.0, 3.0]);
        add([0.0, 1.0], [0.0, 3.0]);
        add([2.0, 3.0], [0.0, 3.0]);
        add([5.0, 6.0], [0.0, 1.0]);
        let rings = plan.outline();
        assert_eq!((rings.len(), rings.iter().all(|r| r.len() == 4)), (3, true));
        // anticlockwise areas are positive, those of holes negative
        let area = |r: &Vec<[f64; 2]>| {
            (0..r.len()).map(|k| cross([0.0; 2], r[k], r[(k + 1) % r.len()]) / 2.0).sum::<f64>()
        };
        assert!((rings.iter().map(area).sum::<f64>() - plan.area_m2()).abs() < 1e-9);
        assert!(Footprint::default().outline().is_empty());
    }

    #[test]
    fn footprint_of_two_shifted_squares() {
        let square = |x: f64| [[x, 0.0], [x + 2.0, 0.0], [x, 2.0], [x + 2.0, 2.0]];
        let (mut a, mut b) = (Footprint::default(), Footprint::default());
        a.add(&square(0.0));
        b.add(&square(1.0));
        assert!((a.area_m2() - 4.0).abs() < 1e-9);
        assert!((a.overlap(&b) - 1.0 / 3.0).abs() < 1e-9);
    }
}
