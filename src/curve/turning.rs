//! How the elastic rotation of a hinge that flows about two axes turns within a step.
//!
//! Flow goes along the elastic rotation, `e' = θ' - α' e/|e|`, and `e` stays on the yield surface. Its angle `φ` to a constant rate of rotation then falls by `|e| φ' = -|θ'| sin φ`: with `|e| = R`
//! `tan(φ/2)` by `exp(-|Δθ|/R)`, and the flow is `∫ |θ'| cos φ dt = |Δθ| + R ln((1 + t₁²)/(1 + t₀²))` with `t = tan(φ/2)` (Krieg and Krieg, J. Pressure Vessel Technol. 99 (1977) 510-515). The return
//! along the trial moment is the same to first order in the step only.
//!
//! With a rate factor the surface lies where the flow of a piece in its share of the step lets it be, and the elastic rotation goes back to it from as long as it would be without flow; that it turns by does not change.
//!
//! Of a hinge that turns by much more than it yields at, `e` follows the direction of the rate. The rotation of a step tells that of its middle; by how much the rate at the end is different shows
//! against the step before.

use super::onset::{self, Search};

/// Share of the rotation of a step that its change against the step before may have: more is no smooth motion.
const MOST_AHEAD: f64 = 0.5;
/// Least length of the elastic rotation at the end, over that at the start, that the turn is found with.
const SHORTEST: f64 = 0.05;
/// A rotation over which the elastic one turns and changes its length is divided: into so many pieces times the share by which one end is shorter, and times the change of `tan(φ/2)`; at most so many.
const PIECES: f64 = 16.0;
const MOST_PIECES: f64 = 32.0;
/// Accuracy of a return to a surface that depends on the rate, over the length: it decides about the turn only.
const RETURN_TOLERANCE: f64 = 1e-9;
/// Sine of an angle that is none.
const STRAIGHT: f64 = 1e-9;
/// Rotation over yield rotation below which the lag behind the rate is the first term of its series.
const SMALL: f64 = 1e-2;

/// A hinge that flows over a rotation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turning {
    /// Elastic rotation from where on it flows \[rad\].
    pub from: [f64; 2],
    /// Rotation from there \[rad\].
    pub path: [f64; 2],
    /// What it would be more with the rate at its end \[rad\].
    pub ahead: [f64; 2],
    /// Whether the surface depends on the rate of the flow.
    pub is_rated: bool,
}

/// A flow in a part of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flow {
    /// What flowed in the step before that part, and in it \[rad\].
    pub before: f64,
    pub flow: f64,
    /// Its share of the time of the step.
    pub share: f64,
}

impl Flow {
    fn of(before: f64, share: f64) -> Self {
        Self { before, flow: 0.0, share }
    }

    fn and(self, flow: f64) -> Self {
        Self { flow, ..self }
    }
}

/// Length at which the elastic rotation, `whole` without flow, is on a surface that the flow moves.
fn returned(whole: f64, surface: impl FnMut(f64) -> [f64; 2]) -> f64 {
    let from = Search { start: f64::INFINITY, tolerance: RETURN_TOLERANCE * whole };
    whole - onset::flow(whole, 1.0, from, surface)
}

/// What a rotation would be more with the rate at its end, by the rotation of the step before, `pace` times as long as which this one took; zero: nothing is known of that.
pub(super) fn ahead(turn: [f64; 2], before: [f64; 2], pace: f64) -> [f64; 2] {
    if pace <= 0.0 || before == [0.0; 2] {
        return [0.0; 2];
    }
    let share = pace / (1.0 + pace);
    let more = [0, 1].map(|i| share * (turn[i] - pace * before[i]));
    let least = (MOST_AHEAD * length(turn) / length(more)).min(1.0);
    more.map(|m| if least.is_finite() { least * m } else { 0.0 })
}

impl Turning {
    /// Elastic rotation from which the radial return ends where the hinge does. `reach` is asked for a direction and a [`Flow`], and says how long it is on the surface then, and the slope of that.
    /// `None` where all goes one way.
    pub fn trial(&self, mut reach: impl FnMut([f64; 2], Flow) -> [f64; 2]) -> Option<[f64; 2]> {
        let is_straight = |a, b| cross(a, b).abs() <= STRAIGHT * (length(a) * length(b));
        if is_straight(self.from, self.path) && is_straight(self.path, self.ahead) {
            return None;
        }
        let Turn { direction, whole, uneven } = self.once(Flow::of(0.0, 1.0), &mut reach)?;
        let pieces = (PIECES * uneven).ceil().min(MOST_PIECES);
        if pieces <= 1.0 {
            return Some(direction.map(|d| whole * d));
        }
        let piece = |i: u32, from: [f64; 2]| {
            // the rate changes evenly
            let later = (2.0 * f64::from(i) + 1.0) / pieces - 1.0;
            let path = [0, 1].map(|k| (self.path[k] + later * self.ahead[k]) / pieces);
            Self { from, path, ahead: self.ahead.map(|a| a / (pieces * pieces)), ..*self }
        };
        let last = pieces as u32 - 1;
        let (mut from, mut flow) = (self.from, 0.0);
        for i in 0..last {
            let after = Flow::of(flow, 1.0 / pieces);
            let Turn { direction, whole, .. } = piece(i, from).once(after, &mut reach)?;
            let length = if self.is_rated {
                returned(whole, |x| reach(direction, after.and(x)))
            } else {
                let first = (whole - reach(direction, after)[0]).max(0.0);
                reach(direction, after.and(first))[0]
            };
            flow += (whole - length).max(0.0);
            from = direction.map(|d| length * d);
        }
        let after = Flow::of(flow, 1.0 / pieces);
        let Turn { direction, whole, .. } = piece(last, from).once(after, &mut reach)?;
        Some(direction.map(|d| (flow + whole) * d))
    }

    /// All of it at once, after a flow, with the mean of the lengths at start and end.
    fn once(&self, after: Flow, reach: &mut impl FnMut([f64; 2], Flow) -> [f64; 2]) -> Option<Turn> {
        let (begin, path) = (length(self.from), length(self.path));
        let (direction, grown, _) = self.turn(begin, path)?;
        let flow = (path + begin * grown).max(0.0);
        let end = if self.is_rated {
            returned(begin + path + begin * grown, |x| reach(direction, after.and(x)))
        } else {
            reach(direction, after.and(flow))[0]
        };
        let end = end.max(SHORTEST * begin);
        let mean = 0.5 * (begin + end);
        let (direction, grown, turn) = self.turn(mean, path)?;
        let uneven = (1.0 - end.min(begin) / end.max(begin)) * turn.abs();
        Some(Turn { direction, whole: begin + path + mean * grown, uneven })
    }

    /// If the elastic rotation keeps this length: its direction at the end, what the flow is more than the path, over that length, and the change of `tan(φ/2)`.
    fn turn(&self, radius: f64, path: f64) -> Option<([f64; 2], f64, f64)> {
        let ratio = path / radius;
        let lag = lag(ratio);
        let toward = unit([0, 1].map(|i| self.path[i] + lag * self.ahead[i]))?;
        let from = unit(self.from)?;
        let begin = cross(toward, from) / (1.0 + dot(toward, from));
        let end = begin * libm::exp(-ratio);
        let grown = libm::log1p(end * end) - libm::log1p(begin * begin);
        let (c, s) = ((1.0 - end * end) / (1.0 + end * end), 2.0 * end / (1.0 + end * end));
        let direction = [c * toward[0] - s * toward[1], s * toward[0] + c * toward[1]];
        grown.is_finite().then_some((direction, grown, begin - end))
    }
}

/// Where the elastic rotation has turned to.
#[derive(Debug, Clone, Copy)]
struct Turn {
    /// Its direction, and the length from which the return begins \[rad\].
    direction: [f64; 2],
    whole: f64,
    /// The share by which one end is shorter times the change of `tan(φ/2)`.
    uneven: f64,
}

/// Which direction the elastic rotation goes to in a step, between that of the mean rate (0) and that of the rate at its end (1), if the rate turns evenly by a small angle over a rotation of `a` yield rotations: `coth(a/2) - 2/a`, from
/// `2a ∫ exp(-a(1-s)) (s - ½) ds` over `1 - exp(-a)`.
fn lag(a: f64) -> f64 {
    if a < SMALL { a / 6.0 } else { 1.0 / libm::tanh(0.5 * a) - 2.0 / a }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: [f64; 2]) -> f64 {
    dot(a, a).sqrt()
}

fn unit(a: [f64; 2]) -> Option<[f64; 2]> {
    let length = length(a);
    (length > 0.0).then(|| a.map(|a| a / length))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::hinge::{AxisLaw, Hinge2};
    use crate::curve::{CapacityLevel, CapacityTable, ResistanceCurve};

    fn table(stiffness_nm_rad: f64, capacity: Vec<[f64; 2]>) -> CapacityTable {
        let level = CapacityLevel { axial_force_n: 0.0, capacity, fracture_rotation_rad: 1e9 };
        let curve = ResistanceCurve { stiffness_nm_rad, levels: vec![level], cyclic: None };
        CapacityTable::new(&curve, 1.0).unwrap()
    }

    /// A hinge after `steps` along a path over `0..1`.
    fn after(tables: [&CapacityTable; 2], steps: u32, path: impl Fn(f64) -> [f64; 2]) -> Hinge2 {
        let mut hinge = Hinge2::default();
        hinge.pace = 1.0;
        for i in 1..=steps {
            hinge.step(tables.map(AxisLaw::Plastic), path(f64::from(i) / f64::from(steps)), 0.0);
        }
        hinge
    }

    /// Where the rotation goes round at a rate `Ω` while it grows by `r`, the moment follows with `sin(lag) = Ω R / r` once it has settled.
    #[test]
    fn a_moment_lags_behind_a_rate_that_goes_round() {
        let turns = 3.0;
        for [yield_rad, steps] in [[1e-3, 100.0], [1e-3, 200.0], [0.05, 400.0], [0.05, 800.0]] {
            let own = table(1e6, vec![[0.0, 1e6 * yield_rad], [1e9, 1e6 * yield_rad]]);
            // radius 1: r = Ω, so the lag is that of the yield rotation over the radius
            let path = |s: f64| [(turns * s).sin(), 1.0 - (turns * s).cos()];
            let hinge = after([&own; 2], steps as u32, path);
            let lag = turns - hinge.moment_nm[1].atan2(hinge.moment_nm[0]);
            let bound = 0.4 * (turns / steps).powi(2);
            assert!((lag - f64::asin(yield_rad)).abs() < bound, "{yield_rad} {steps}: {lag}");
            let flow = turns * (1.0 - yield_rad * yield_rad).sqrt() - yield_rad;
            assert!((hinge.alpha_rad - flow).abs() < 0.1 * yield_rad + bound, "{} {flow}", hinge.alpha_rad);
        }
    }

    /// Unequal axes that soften: of second order in the step, whether that is shorter or longer than the rotation at which they yield.
    #[test]
    fn turning_is_of_second_order() {
        for stiffness in [2e4, 1e6] {
            let tables = [9.0, 4.0]
                .map(|c| table(stiffness, vec![[0.0, 100.0 * c], [1.0, 40.0 * c], [9.0, 40.0 * c]]));
            let path = |s: f64| [1.2 * s, 0.8 * s * s - 0.3 * s];
            let found = |steps| after([&tables[0], &tables[1]], steps, path);
            let fine = found(40_000);
            let off = |steps| {
                let hinge = found(steps);
                let moment = [0, 1].map(|i| (hinge.moment_nm[i] - fine.moment_nm[i]) / fine.moment_nm[0]);
                length(moment) + (hinge.alpha_rad - fine.alpha_rad).abs()
            };
            let [coarse, half] = [100, 200].map(off);
            assert!(coarse < 1e-3 && half < 0.35 * coarse, "{stiffness}: {coarse} {half}");
        }
    }

    /// A step that leads across a thin ellipse.
    #[test]
    fn a_long_way_across_a_thin_ellipse_is_divided() {
        let tables = [1.0, 0.05].map(|c| table(1.0, vec![[0.0, c], [1e9, c]]));
        let begin = [0.0123, -0.05 * (1.0_f64 - 0.0123 * 0.0123).sqrt()];
        let path = |s: f64| [begin[0] - 1.08 * s, begin[1] - 0.012 * s];
        let found = |steps: u32| {
            let mut hinge = Hinge2::default();
            for i in 0..=steps {
                let share = f64::from(i) / f64::from(steps);
                hinge.step([AxisLaw::Plastic(&tables[0]), AxisLaw::Plastic(&tables[1])], path(share), 0.0);
            }
            (hinge.moment_nm, hinge.alpha_rad)
        };
        let ((once, of_once), (fine, of_fine)) = (found(1), found(20_000));
        assert!(length([once[0] - fine[0], once[1] - fine[1]]) < 0.1, "{once:?} {fine:?}");
        assert!((of_once - of_fine).abs() < 0.1 * of_fine, "{of_once} {of_fine}");
    }

    /// Steps of two lengths in turn.
    #[test]
    fn the_pace_of_steps_is_taken_into_account() {
        let own = table(1e6, vec![[0.0, 1e3], [1e9, 1e3]]);
        let mut hinge = Hinge2::default();
        let mut place = 0.0;
        for i in 0..150 {
            let long = i % 2 == 1;
            place += if long { 0.03 } else { 0.01 };
            hinge.pace = if long { 3.0 } else { 1.0 / 3.0 };
            hinge.step([AxisLaw::Plastic(&own); 2], [f64::sin(place), 1.0 - f64::cos(place)], 0.0);
        }
        let lag = place - hinge.moment_nm[1].atan2(hinge.moment_nm[0]);
        assert!((lag - 1e-3).abs() < 3e-4, "{lag}");
    }
}
