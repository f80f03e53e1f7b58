//! How a member end is driven: the path of its rotation over time, means of what is met on the way, and the watch over its energies.
//!
//! A path runs through turning points. Between two of them the speed rises, stays and falls as a sine, so that the acceleration is continuous
//! through a turn; the first rise is linear. Small amplitudes are driven slower, so that the times of rise and fall stay the same.

use crate::fe::dynamics::Dynamics;
use crate::fe::watch::Books;
use std::f64::consts::PI;

/// Speed of the chord at most \[rad/s\].
pub const SPEED_RAD_S: f64 = 0.15;
/// Time over which the first push speeds up \[s\].
pub const RAMP_S: f64 = 0.05;
/// Time of the fall of speed before a turning point, and of the rise behind it \[s\].
pub const TURN_S: f64 = 0.06;
/// Kinetic over internal energy, while 80 % of the peak are borne, beyond which a curve is not quasi-static.
pub const KINETIC_LIMIT: f64 = 0.05;
/// Residual of the energy balance over the internal energy at which a run is refused.
pub const ENERGY_LIMIT: f64 = 0.03;
/// Internal energy over mass from which on the balance counts, in concrete that of an elastic strain of some `3e-5` \[J/kg\].
const JUDGED_FROM_J_KG: f64 = 4e-3;

/// Why a curve with this share of kinetic energy is no static one, in words; nothing below [`KINETIC_LIMIT`].
pub fn moves(kinetic_share: f64) -> Option<String> {
    let share = 100.0 * kinetic_share;
    (kinetic_share > KINETIC_LIMIT)
        .then(|| format!("not quasi-static: kinetic energy is {share:.1} % of the internal energy"))
}

/// One way from a turning point to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Leg {
    begin_s: f64,
    end_s: f64,
    /// Speed between rise and fall, with its sense \[rad/s\].
    speed_rad_s: f64,
    rise_s: f64,
    fall_s: f64,
    is_first: bool,
    /// Where it ends \[rad\].
    to_rad: f64,
}

impl Leg {
    /// Rate at a time \[rad/s\].
    fn rate(&self, time_s: f64) -> f64 {
        let (since, left) = (time_s - self.begin_s, self.end_s - time_s);
        if self.is_first && since < self.rise_s {
            return self.speed_rad_s * (since / self.rise_s);
        }
        let share =
            |part: f64, whole: f64| if part < whole { libm::sin(0.5 * PI * part / whole) } else { 1.0 };
        self.speed_rad_s * share(since, self.rise_s) * share(left.max(0.0), self.fall_s)
    }
}

/// A rotation over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Path {
    legs: Vec<Leg>,
}

/// Where a path is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    /// Rate \[rad/s\].
    pub rate_rad_s: f64,
    /// Index of the turning point that comes next.
    pub next: usize,
}

impl Path {
    /// From zero through turning points \[rad\], each other than the one before it. The last one is passed at full speed: one alone is a
    /// monotonic push. `pace` is the share of the ordinary speed.
    pub fn through(turns_rad: &[f64], pace: f64) -> Self {
        let most_rad_s = pace * SPEED_RAD_S;
        let (mut legs, mut from, mut begin_s): (Vec<Leg>, f64, f64) = (Vec::new(), 0.0, 0.0);
        for (i, to_rad) in turns_rad.iter().copied().enumerate() {
            let (is_first, is_last) = (i == 0, i + 1 == turns_rad.len());
            let rise_s = if is_first { RAMP_S } else { TURN_S };
            let fall_s = if is_last { 0.0 } else { TURN_S };
            // ways of rise and fall over the speed
            let rise = if is_first { 0.5 } else { 2.0 / PI } * rise_s;
            let fall = 2.0 / PI * fall_s;
            let way = to_rad - from;
            let speed =
                if is_first && is_last { most_rad_s } else { most_rad_s.min(way.abs() / (rise + fall)) };
            let steady_s = way.abs() / speed - rise - fall;
            let end_s = if is_first && is_last && steady_s < 0.0 {
                (2.0 * rise_s * way.abs() / speed).sqrt()
            } else {
                begin_s + rise_s + steady_s.max(0.0) + fall_s
            };
            legs.push(Leg {
                begin_s,
                end_s,
                speed_rad_s: speed.copysign(way),
                rise_s,
                fall_s,
                is_first,
                to_rad,
            });
            (from, begin_s) = (to_rad, end_s);
        }
        Self { legs }
    }

    /// Time that it takes \[s\].
    pub fn duration_s(&self) -> f64 {
        self.legs.last().map_or(0.0, |l| l.end_s)
    }

    /// Motion at a time since its start \[s\]; beyond the end that of the end.
    pub fn motion(&self, time_s: f64) -> Motion {
        let next = self.legs.partition_point(|l| l.end_s <= time_s).min(self.legs.len().saturating_sub(1));
        Motion { rate_rad_s: self.legs.get(next).map_or(0.0, |l| l.rate(time_s)), next }
    }

    /// Largest speed on it \[rad/s\].
    pub fn speed_rad_s(&self) -> f64 {
        self.legs.iter().map(|l| l.speed_rad_s.abs()).fold(0.0, f64::max)
    }

    /// Turning point \[rad\].
    pub fn turn_rad(&self, index: usize) -> f64 {
        self.legs[index].to_rad
    }

    /// Sense of the way to a turning point: 1 or -1.
    pub fn sense(&self, index: usize) -> f64 {
        self.legs[index].speed_rad_s.signum()
    }

    /// Number of turning points.
    pub fn turns(&self) -> usize {
        self.legs.len()
    }
}

/// Turning points of symmetric cycles: each amplitude \[rad\] so many times in both senses, the positive one first, and back to zero.
pub fn cycles(amplitudes_rad: &[f64], repeat: usize) -> Vec<f64> {
    let both = |a: &f64| [*a, -*a].repeat(repeat);
    let mut turns: Vec<f64> = amplitudes_rad.iter().flat_map(both).collect();
    turns.push(0.0);
    turns
}

/// Turning points of a record of rotations \[rad\] that begins at zero; reversals smaller than `least_rad` are left out.
pub fn turning_points(record_rad: &[f64], least_rad: f64) -> Vec<f64> {
    let mut turns = vec![0.0];
    for &at in record_rad {
        let last = turns[turns.len() - 1];
        let before = if turns.len() > 1 { turns[turns.len() - 2] } else { last };
        if turns.len() > 1 && (at - last) * (last - before) > 0.0 {
            let end = turns.len() - 1;
            turns[end] = at;
        } else if (at - last).abs() >= least_rad {
            turns.push(at);
        }
    }
    turns.remove(0);
    turns
}

/// Sums of quantities of which means are taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Means<const N: usize> {
    sum: [f64; N],
    count: f64,
}

impl<const N: usize> Default for Means<N> {
    fn default() -> Self {
        Self { sum: [0.0; N], count: 0.0 }
    }
}

impl<const N: usize> Means<N> {
    /// Adds values.
    pub fn add(&mut self, values: [f64; N]) {
        for (s, v) in self.sum.iter_mut().zip(values) {
            *s += v;
        }
        self.count += 1.0;
    }

    /// The means since the last call; `None` if nothing was added.
    pub fn take(&mut self) -> Option<[f64; N]> {
        let Self { sum, count } = std::mem::take(self);
        (count > 0.0).then(|| sum.map(|s| s / count))
    }
}

/// Energies of a driven body \[J\].
#[derive(Debug, Clone, Copy, Default, PartialEq, serde::Serialize)]
pub struct Energies {
    /// Work of forces and given motions from outside.
    pub external_j: f64,
    /// Work of stresses, hourglass stresses and bulk viscosity included: stored and dissipated.
    pub internal_j: f64,
    /// Of this hourglass stresses and bulk viscosity.
    pub artificial_j: f64,
    /// Kinetic energy.
    pub kinetic_j: f64,
    /// What damping took.
    pub damped_j: f64,
    /// Largest residual over the internal energy so far.
    pub residual_share: f64,
}

impl Energies {
    /// Of a whole body, of which these are the share that is meshed.
    #[must_use]
    pub fn of_whole(self, share: f64) -> Self {
        let [external_j, internal_j, artificial_j, kinetic_j, damped_j] =
            [self.external_j, self.internal_j, self.artificial_j, self.kinetic_j, self.damped_j]
                .map(|e| e / share);
        Self {
            external_j,
            internal_j,
            artificial_j,
            kinetic_j,
            damped_j,
            residual_share: self.residual_share,
        }
    }
}

/// Watches the energies of a driven body without gravity and contact.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EnergyWatch {
    /// Work of constraints outside of the solver \[J\].
    pub held_j: f64,
    damped_j: f64,
    mass_kg: f64,
    worst: f64,
}

impl EnergyWatch {
    /// Of a body of this mass \[kg\].
    pub fn new(mass_kg: f64) -> Self {
        Self { mass_kg, ..Self::default() }
    }

    /// Books what damping took in so many steps that have been like the last one.
    pub fn damped(&mut self, body: &Dynamics, steps: f64) {
        self.damped_j += body.damping_1_s * 2.0 * body.kinetic_j() * steps * body.taken_s;
    }

    /// Energies now. The balance does not count at the very start, where next to nothing is divided by next to nothing.
    pub fn look(&mut self, body: &Dynamics) -> Energies {
        let books = Books::of(body, body.kinetic_j(), 0.0, 0.0);
        let artificial_j = books.hourglass_j + books.viscous_j;
        let internal_j = books.internal_j + artificial_j;
        let residual = (books.residual_j() - self.held_j).abs();
        if internal_j > JUDGED_FROM_J_KG * self.mass_kg || internal_j.is_nan() {
            let share = residual / internal_j;
            self.worst = if share > self.worst || share.is_nan() { share } else { self.worst };
        }
        Energies {
            external_j: books.driven_j + self.damped_j + self.held_j,
            internal_j,
            artificial_j,
            kinetic_j: books.kinetic_j,
            damped_j: self.damped_j,
            residual_share: self.worst,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rotation at the end of each leg by the midpoint rule.
    fn ends(path: &Path) -> Vec<f64> {
        let (mut at, mut time, dt) = (0.0, 0.0, 1e-5);
        let mut ends = vec![f64::NAN; path.turns()];
        while time < path.duration_s() {
            let motion = path.motion(time + 0.5 * dt);
            at += dt * motion.rate_rad_s;
            ends[motion.next] = at;
            time += dt;
        }
        ends
    }

    #[test]
    fn a_path_meets_its_turning_points_and_its_speed_does_not_jump() {
        let turns = cycles(&[0.002, 0.03], 2);
        assert_eq!(turns, [0.002, -0.002, 0.002, -0.002, 0.03, -0.03, 0.03, -0.03, 0.0]);
        let path = Path::through(&turns, 1.0);
        for (found, wanted) in ends(&path).iter().zip(&turns) {
            assert!((found - wanted).abs() < 5e-6, "{found} for {wanted}");
        }
        let (mut before, dt) = (0.0, 1e-5);
        let mut largest: f64 = 0.0;
        let mut time = 0.0;
        while time < path.duration_s() {
            let rate = path.motion(time).rate_rad_s;
            assert!(rate.abs() <= SPEED_RAD_S);
            largest = largest.max(((rate - before) / dt).abs());
            (before, time) = (rate, time + dt);
        }
        let slow = Path::through(&[0.1], 0.25);
        assert!((slow.motion(1.0).rate_rad_s - 0.25 * SPEED_RAD_S).abs() < 1e-15);
        // the sine's steepest slope
        assert!(largest <= 1.001 * 0.5 * PI * SPEED_RAD_S / TURN_S, "{largest}");
    }

    #[test]
    fn one_turning_point_is_a_monotonic_push() {
        for until in [0.001, 0.1] {
            let path = Path::through(&[until], 1.0);
            assert!((ends(&path)[0] - until).abs() < 5e-6);
            for time in [0.0, 0.02, 0.049, 0.06, 0.5, 1.0] {
                let ramp = (time / RAMP_S).min(1.0);
                assert_eq!(path.motion(time).rate_rad_s, SPEED_RAD_S * ramp);
            }
        }
    }

    #[test]
    fn a_record_is_its_turning_points() {
        let record = [0.0, 0.001, 0.004, 0.0039995, 0.005, 0.0, -0.01, -0.01, 0.002];
        assert_eq!(turning_points(&record, 1e-4), [0.005, -0.01, 0.002]);
        assert!(turning_points(&[0.0, 1e-6], 1e-4).is_empty());
    }

    #[test]
    fn means_are_those_since_the_last_call() {
        let mut means = Means::<2>::default();
        means.add([1.0, 2.0]);
        means.add([3.0, 6.0]);
        assert_eq!(means.take(), Some([2.0, 4.0]));
        assert_eq!(means.take(), None);
    }
}
