//! What the history of a bent column says: largest moment, and the drift at which its lateral force has fallen.
//!
//! The lateral force is that of the bend less the second-order moment, `V = (M - N w) / L` with the tip displacement `w`, as the tests' was. The envelope of a
//! sense has the points, on ways in this sense, at which the column was bent further than ever before in it; the last one of a cycle that goes further than
//! the one before it is its peak. A monotonic bend is all envelope.
//!
//! - **Largest moment**: that of the envelope up to the largest drift of the test; of cycles, the mean of both senses. Beyond, bars harden, and no test saw it.
//! - **Fall**: in each sense, the first point behind the largest lateral force of its envelope with less than 80 % of that force; the drift is interpolated
//!   from the point before it. The sense that falls first in time counts.
//! - **Axial failure** ends a bend. Where no sense has fallen before it, the column falls at the drift of the last point of an envelope: where the failure comes, or,
//!   on a way over drifts that were there before, the largest drift before it.

use crate::rc::bend::Ending;
use crate::rc::hysteresis::lateral_n;

/// Share of the largest lateral force whose drift is compared.
pub const FALLEN_SHARE: f64 = 0.8;

/// A computed column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Computed {
    /// Largest moment at the base within the drifts of the test, mean of the senses in which it was bent \[N m\].
    pub peak_nm: f64,
    /// Drift at the larger of them.
    pub peak_drift: f64,
    /// Largest lateral force in any sense \[N\].
    pub lateral_n: f64,
    /// Drift at which it has fallen to 80 %, or the last one.
    pub drift_at_80: f64,
    /// Whether it fell.
    pub fell: bool,
    /// What ended the bend.
    pub ending: Ending,
    /// Largest kinetic over internal energy.
    pub kinetic_share: f64,
    /// Largest residual of the energy balance over internal energy.
    pub energy_error: f64,
}

/// A column as its history is read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Axial force, compression positive \[N\].
    pub axial_n: f64,
    /// Shear span \[m\].
    pub length_m: f64,
    /// Drift up to which moments count.
    pub last_drift: f64,
}

/// A point of the envelope of one sense, all quantities positive in it.
#[derive(Debug, Clone, Copy)]
struct Point {
    /// Its place in the history.
    at: usize,
    drift: f64,
    moment_nm: f64,
    lateral_n: f64,
}

/// The envelope of one sense in the order of time.
struct Envelope(Vec<Point>);

impl Envelope {
    /// Of the ways of a history that go in a sense: the first goes in the positive one, and each turn changes it.
    fn of(points: &[[f64; 3]], turned_at: &[usize], sense: f64, reading: &Reading) -> Self {
        let (mut envelope, mut reached) = (Vec::new(), 0.0);
        for (at, [rotation, moment, _]) in points.iter().enumerate() {
            let turns = turned_at.partition_point(|t| *t <= at);
            let along = if turns.is_multiple_of(2) { 1.0 } else { -1.0 };
            let [drift, moment_nm] = [sense * rotation, sense * moment];
            if along == sense && drift > reached {
                reached = drift;
                let lateral_n = lateral_n(drift, moment_nm, reading.axial_n, reading.length_m);
                envelope.push(Point { at, drift, moment_nm, lateral_n });
            }
        }
        Self(envelope)
    }

    /// Largest positive moment up to a drift, and the drift there.
    fn moment(&self, until: f64) -> Option<[f64; 2]> {
        let within = self.0.iter().filter(|p| p.drift <= until && p.moment_nm > 0.0);
        within.map(|p| [p.moment_nm, p.drift]).reduce(|a, b| if b[0] > a[0] { b } else { a })
    }

    /// Index of the point of the largest lateral force, if that is positive.
    fn strongest(&self) -> Option<usize> {
        let larger = |a: usize, b: usize| if self.0[b].lateral_n > self.0[a].lateral_n { b } else { a };
        (0..self.0.len()).reduce(larger).filter(|i| self.0[*i].lateral_n > 0.0)
    }

    /// Where the lateral force has fallen: the place in the history and the drift.
    fn fall(&self) -> Option<(usize, f64)> {
        let most = self.strongest()?;
        let level = FALLEN_SHARE * self.0[most].lateral_n;
        let low = (most + 1..self.0.len()).find(|i| self.0[*i].lateral_n < level)?;
        let [a, b] = [self.0[low - 1], self.0[low]];
        let share = (a.lateral_n - level) / (a.lateral_n - b.lateral_n);
        Some((b.at, a.drift + share * (b.drift - a.drift)))
    }
}

impl Reading {
    /// Reads a history `[rotation (rad), moment (N m), shortening (m)]`; `turned_at` as in [`crate::rc::bend::Bent`]. Shares of energy are left zero.
    ///
    /// # Errors
    /// If there is no positive moment.
    pub fn read(&self, points: &[[f64; 3]], turned_at: &[usize], ending: Ending) -> Result<Computed, String> {
        let both = [1.0, -1.0].map(|sense| Envelope::of(points, turned_at, sense, self));
        let moments: Vec<[f64; 2]> = both.iter().filter_map(|e| e.moment(self.last_drift)).collect();
        let larger = moments.iter().copied().reduce(|a, b| if b[0] > a[0] { b } else { a });
        let lateral = both.iter().filter_map(|e| e.strongest().map(|i| e.0[i].lateral_n)).reduce(f64::max);
        let (Some([_, peak_drift]), Some(lateral_n)) = (larger, lateral) else {
            return Err(format!("no positive moment up to a drift of {:.2} %", 100.0 * self.last_drift));
        };
        let last = || both.iter().filter_map(|e| e.0.last());
        let fall = both.iter().filter_map(Envelope::fall).min_by_key(|f| f.0).map(|f| f.1);
        let axial = || last().max_by_key(|p| p.at).map(|p| p.drift);
        let fall = fall.or_else(|| matches!(ending, Ending::Axial { .. }).then(axial).flatten());
        Ok(Computed {
            peak_nm: moments.iter().map(|m| m[0]).sum::<f64>() / moments.len() as f64,
            peak_drift,
            lateral_n,
            drift_at_80: fall.unwrap_or_else(|| last().map(|p| p.drift).fold(0.0, f64::max)),
            fell: fall.is_some(),
            ending,
            kinetic_share: 0.0,
            energy_error: 0.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONG: Reading = Reading { axial_n: 0.0, length_m: 1.0, last_drift: 1.0 };

    /// A history of drifts in % and moments in kN m.
    fn history(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        points.iter().map(|[drift, moment]| [1e-2 * drift, 1e3 * moment, 0.0]).collect()
    }

    #[test]
    fn lateral_force_loses_the_second_order_moment() {
        let points = history(&[[0.0, 0.0], [1.0, 100.0], [2.0, 100.0], [3.0, 90.0]]);
        // V = (M - N w) / L with N = 1 MN, L = 2 m: 0, 40, 30, 15 kN; 32 kN between the second and the third
        let reading = Reading { axial_n: 1e6, length_m: 2.0, last_drift: 1.0 };
        let c = reading.read(&points, &[], Ending::Path).unwrap();
        assert!((c.lateral_n - 40e3).abs() < 1e-6 && (c.drift_at_80 - 0.018).abs() < 1e-12 && c.fell);
        let none = Reading { axial_n: 0.0, ..reading }.read(&points, &[], Ending::Path).unwrap();
        assert!(!none.fell && none.drift_at_80 == 0.03 && none.peak_drift == 0.01);
    }

    #[test]
    fn moments_count_within_the_drifts_of_the_test() {
        let points = history(&[[0.0, 0.0], [1.0, 100.0], [2.0, 110.0], [3.0, 120.0]]);
        let until = |last_drift| Reading { last_drift, ..LONG }.read(&points, &[], Ending::Path);
        assert_eq!([0.025, 0.03].map(|d| until(d).unwrap().peak_nm), [110e3, 120e3]);
        // the lateral force is that of the whole bend
        assert_eq!(until(0.01).unwrap().lateral_n, 120e3);
        assert!(until(0.005).unwrap_err().contains("0.50 %"));
    }

    /// Cycles of 1 and 2 %; on the way to 2 % the positive sense is already weaker than it was at 1 %.
    fn cycles(positive: [f64; 2], negative: [f64; 2]) -> (Vec<[f64; 3]>, [usize; 3]) {
        let points = [
            [0.0, 0.0],
            [0.5, 80.0],
            [1.0, 100.0],
            // back: still at a large drift and weak, which is no envelope
            [1.001, 10.0],
            [-0.5, -70.0],
            [-1.0, -90.0],
            [0.5, 20.0],
            [1.5, positive[0]],
            [2.0, positive[1]],
            [-1.0, -10.0],
            [-1.5, negative[0]],
            [-2.0, negative[1]],
        ];
        (history(&points), [3, 6, 9])
    }

    #[test]
    fn the_first_sense_to_fall_counts_and_moments_are_means_of_both() {
        let (points, turns) = cycles([90.0, 60.0], [-60.0, -50.0]);
        let c = LONG.read(&points, &turns, Ending::Path).unwrap();
        assert_eq!((c.peak_nm, c.peak_drift, c.lateral_n), (95e3, 0.01, 100e3));
        // 80 of 100 kN: a third of the way from 1.5 to 2 %; the negative sense falls at 1.3 % (72 of 90 kN), but later
        assert!(c.fell && (c.drift_at_80 - (0.015 + 0.005 / 3.0)).abs() < 1e-12, "{c:?}");
        let (points, turns) = cycles([100.0, 100.0], [-60.0, -50.0]);
        let c = LONG.read(&points, &turns, Ending::Path).unwrap();
        assert!(c.fell && (c.drift_at_80 - 0.013).abs() < 1e-12, "{c:?}");
        let (points, turns) = cycles([100.0, 100.0], [-90.0, -90.0]);
        let c = LONG.read(&points, &turns, Ending::Path).unwrap();
        assert!(!c.fell && c.drift_at_80 == 0.02);
        // moments beyond the test do not count: of the cycle of 1 %
        let (points, turns) = cycles([120.0, 140.0], [-95.0, -99.0]);
        let c = Reading { last_drift: 0.012, ..LONG }.read(&points, &turns, Ending::Path).unwrap();
        assert_eq!((c.peak_nm, c.lateral_n), (95e3, 140e3));
    }

    #[test]
    fn an_axial_failure_is_a_fall() {
        let axial = Ending::Axial { rotation_rad: -0.01, shortening_m: 0.02 };
        let (points, turns) = cycles([100.0, 100.0], [-90.0, -90.0]);
        let at = |count: usize| {
            let turns: Vec<usize> = turns.iter().copied().filter(|t| *t < count).collect();
            let c = LONG.read(&points[..count], &turns, axial).unwrap();
            assert!(c.fell && matches!(c.ending, Ending::Axial { .. }));
            c.drift_at_80
        };
        // on the envelope; on the way back over drifts that were there; in the first push
        assert_eq!([11, 10, 3].map(at), [0.015, 0.02, 0.01]);
        // what fell before counts
        let (points, turns) = cycles([90.0, 60.0], [-90.0, -90.0]);
        let c = LONG.read(&points[..10], &turns, axial).unwrap();
        assert!((c.drift_at_80 - (0.015 + 0.005 / 3.0)).abs() < 1e-12);
    }
}
