//! Contact of bodies on ideal joints.
//!
//! While a bound on the bodies' paths says that nothing can meet, steps know nothing of contact; where the bound is used up a glance at what is near renews it. Else steps are those
//! of the leapfrog, each begun by a jump: impulses at the start of the step change the velocities so that no gap closes in it, joints included, and displacements without
//! velocity open what is closed.

use super::march::{MarchError, Marcher};
use super::method::{COARSE, LEAPFROG};
use super::motion::{Motion, STATE, WORKS};
use crate::mbs::contact::{ContactSet, Moving, TooDeep, Touch};
use crate::mbs::math::{self, V3, add, norm, sub};
use std::collections::BTreeSet;

/// Longest step in contact \[s\], and that with a coarse tolerance.
pub(super) const STEP_S: [f64; 2] = [5e-4, 1e-3];
/// Share of the stable step that is taken where steps change between those in contact and others: leapfrog steps that alternate excite vibrations near its limit.
const ALTERNATING: f64 = 0.8;
/// Most steps in a row that are shortened for impacts.
const MOST_STOPS: u32 = 8;
/// Change of a velocity from which accelerations are found anew within a step \[m/s, rad/s\].
const JUMP: f64 = 1e-3;
/// The same over a step of the accelerations that go with the turning of bodies, for a change of their velocities \[m/s\]: those of before it are an error of first order where a contact bears all the time.
const TURNED: f64 = 1e-10;
/// Displacement that opens a gap from which what it does to forces and joints is found \[m, rad\].
const SHIFT: f64 = 1e-5;

/// What can touch, in a march.
#[derive(Debug, Clone)]
pub struct Touching {
    /// The contacts.
    pub set: ContactSet,
    /// Work of the displacements that opened gaps \[J\].
    pub opened_j: f64,
    /// Longest step in contact, and that which the last error allows \[s\].
    longest_s: f64,
    allowed_s: f64,
    /// The last step in contact \[s\].
    pub(super) last_s: f64,
    /// Steps in a row that were shortened for an impact.
    stops: u32,
    /// First contacts with their times \[s\]; for the caller to fetch.
    pub touches: Vec<(f64, Touch)>,
    /// Whether what joints bear of contacts is to be found.
    pub tells_reactions: bool,
    moving: Vec<Moving>,
    /// Longest paths of the bodies in the next step \[m\]: those of the last smooth one at least, if the bound on paths did not hold in it.
    paths_m: Vec<f64>,
    /// Whether it did not.
    missed: bool,
}

impl Touching {
    /// For contacts in a run with a tolerance.
    pub fn new(set: ContactSet, tolerance: f64) -> Self {
        let step_s = STEP_S[usize::from(tolerance >= COARSE)];
        Self {
            set,
            opened_j: 0.0,
            longest_s: step_s,
            allowed_s: step_s,
            last_s: step_s,
            stops: 0,
            touches: Vec::new(),
            tells_reactions: false,
            moving: Vec::new(),
            paths_m: Vec::new(),
            missed: false,
        }
    }

    /// Longest next step \[s\].
    pub fn step_s(&self) -> f64 {
        self.allowed_s
    }

    /// The error of a step allows the next one this length \[s\].
    pub fn advise(&mut self, step_s: f64) {
        self.allowed_s = (0.9 * step_s).min(1.5 * self.allowed_s).min(self.longest_s);
    }

    /// What contacts took along their normals, gaps that were opened included, and by friction \[J\].
    pub fn taken_j(&self) -> [f64; 2] {
        [self.set.energy.normal_j + self.opened_j, self.set.energy.friction_j]
    }

    /// Energy that contacts took so far \[J\].
    pub fn spent_j(&self) -> f64 {
        self.taken_j().iter().sum()
    }
}

/// Velocity and angular velocity of a body in a state, or their rates.
fn six(numbers: &[f64], body: usize) -> [V3; 2] {
    let at = STATE * body + 7;
    [[numbers[at], numbers[at + 1], numbers[at + 2]], [numbers[at + 3], numbers[at + 4], numbers[at + 5]]]
}

impl Marcher {
    /// Whether something may touch within a step of `h` \[s\].
    pub(super) fn is_near(&mut self, h: f64) -> bool {
        let Some(mut touching) = self.touching.take() else { return false };
        let near = !touching.set.is_idle() && self.may_touch(&mut touching, h);
        self.touching = Some(touching);
        near
    }

    fn may_touch(&self, touching: &mut Touching, h: f64) -> bool {
        let Touching { set, paths_m, missed, .. } = &mut *touching;
        let missed = std::mem::take(missed);
        paths_m.resize(self.motion.bodies(), 0.0);
        for (b, longest_m) in paths_m.iter_mut().enumerate() {
            let ([v, w], [a, alpha]) = (six(&self.state, b), six(&self.rates[0], b));
            let path_m = h * (norm(v) + h * norm(a) + (norm(w) + h * norm(alpha)) * set.radius_m(b));
            *longest_m = if missed { longest_m.max(path_m) } else { path_m };
        }
        let is_clear = set.is_clear_for(paths_m);
        if is_clear && set.may_skip() {
            return false;
        }
        if set.is_meeting() {
            return true;
        }
        self.place(touching, h);
        let Touching { set, paths_m, moving, .. } = touching;
        if is_clear {
            // looked at for nothing, without a trace
            return !set.clone().glance(moving, h, paths_m);
        }
        !set.glance(moving, h, paths_m) || !set.is_clear_for(paths_m)
    }

    /// Largest stable step of the leapfrog \[s\].
    pub(super) fn leap_limit_s(&self) -> f64 {
        let share = if self.touching.is_some() { ALTERNATING } else { 1.0 };
        share * LEAPFROG.reach / self.frequency.max(f64::MIN_POSITIVE)
    }

    /// Counts the paths of a smooth step whose stages are known; false if something may have touched in it.
    pub(super) fn counted(&mut self, h: f64) -> bool {
        let Some(touching) = self.touching.as_mut().filter(|t| !t.set.is_idle()) else { return true };
        let rates = &self.rates;
        let fastest = |b: usize, from: usize| {
            let of = |k: &Vec<f64>| norm([0, 1, 2].map(|i| k[STATE * b + from + i]));
            rates.iter().map(of).fold(0.0, f64::max)
        };
        // the rate of a position is a velocity, half of that of a quaternion's four numbers an angular one
        let spin = |b: usize| {
            let of = |k: &Vec<f64>| 2.0 * (3..7).map(|i| k[STATE * b + i].powi(2)).sum::<f64>().sqrt();
            rates.iter().map(of).fold(0.0, f64::max)
        };
        for b in 0..self.motion.bodies() {
            touching.paths_m[b] = h * (fastest(b, 0) + spin(b) * touching.set.radius_m(b));
        }
        touching.missed = !touching.set.passes(&touching.paths_m);
        !touching.missed
    }

    /// The jump at the start of a step of `h` \[s\], or of a shorter one that ends with the first impact within; its length \[s\].
    ///
    /// # Errors
    /// If bodies are too deep in each other.
    pub(super) fn jump(&mut self, h: f64) -> Result<f64, MarchError> {
        let Some(mut touching) = self.touching.take() else { return Ok(h) };
        // bodies that rattle between others strike again and again: now and then a whole step goes on
        let whole_s = (touching.stops == MOST_STOPS).then_some(h);
        let outcome = match self.impulses(&mut touching, h, whole_s) {
            Ok(Some(hit_s)) => self.impulses(&mut touching, hit_s, Some(h)).map(|_| hit_s),
            whole => whole.map(|_| h),
        };
        let is_short = outcome.as_ref().is_ok_and(|length| *length < h);
        touching.stops = if is_short { touching.stops + 1 } else { 0 };
        let time_s = self.time_s;
        let touches = std::mem::take(&mut touching.set.touches);
        touching.touches.extend(touches.into_iter().map(|t| (time_s + t.after_s, t)));
        self.touching = Some(touching);
        outcome.map_err(|deep| MarchError::Penetration { time_s, deep, step_s: h })
    }

    /// Brings velocities to those at the full step where contacts go on bearing ([`ContactSet::half_borne`]).
    pub fn synchronise(&mut self) {
        let Some(mut touching) = self.touching.take() else { return };
        let h = touching.last_s;
        self.place(&mut touching, h);
        if let Some(halves) = touching.set.half_borne(&touching.moving, h, Some(&mut self.motion)) {
            let before_j = self.motion.total_j(&self.state);
            for (body, added) in self.state.chunks_exact_mut(STATE).zip(&halves) {
                body[7..].iter_mut().zip(added.as_flattened()).for_each(|(v, a)| *v += a);
            }
            touching.set.energy.normal_j += before_j - self.motion.total_j(&self.state);
        }
        self.touching = Some(touching);
    }

    /// Says where the bodies are and how they move, with what forces add to their velocities in half a step.
    fn place(&self, touching: &mut Touching, h: f64) {
        let half = 0.5 * h;
        touching.moving.clear();
        for b in 0..self.motion.bodies() {
            let ([v, w], [a, alpha]) = (six(&self.state, b), six(&self.rates[0], b));
            let [kick_v, kick_w] = [a, alpha].map(|a| math::scale(half, a));
            let body = &self.state[STATE * b..STATE * (b + 1)];
            let q = math::qrenormalise([body[3], body[4], body[5], body[6]]);
            touching.moving.push(Moving {
                x: [body[0], body[1], body[2]],
                q,
                r: math::qmat(q),
                v: add(v, kick_v),
                w: add(w, kick_w),
                kick_v,
                kick_w,
                inverse_mass: self.motion.inverse_mass(b),
                inverse_inertia: *self.motion.inverse_inertia(b),
                alive: !self.motion.is_gone(b),
                shift: [0.0; 3],
                turn: [0.0; 3],
            });
        }
    }

    /// Impulses of a step, or the time of an impact within ([`ContactSet::solve_linked`]) \[s\].
    fn impulses(
        &mut self,
        touching: &mut Touching,
        h: f64,
        whole_s: Option<f64>,
    ) -> Result<Option<f64>, TooDeep> {
        self.place(touching, h);
        let hit_s = touching.set.solve_linked(&mut touching.moving, h, whole_s, Some(&mut self.motion))?;
        if hit_s.is_some() {
            return Ok(hit_s);
        }
        if touching.tells_reactions {
            self.bear(touching, h);
        }
        let works = self.state.len() - WORKS;
        let before = self.motion.power(&self.state);
        let (mut largest, mut shift, mut spin) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (b, moving) in touching.moving.iter().enumerate() {
            spin = spin.max(norm(moving.w));
            let [v, w] = six(&self.state, b);
            let change = [sub(sub(moving.v, moving.kick_v), v), sub(sub(moving.w, moving.kick_w), w)];
            largest = change.iter().flatten().fold(largest, |l, c| l.max(c.abs()));
            shift = shift.max(norm(moving.shift)).max(norm(moving.turn));
            let at = STATE * b;
            for i in 0..3 {
                self.state[at + 7 + i] += change[0][i];
                self.state[at + 10 + i] += change[1][i];
                self.rates[0][at + i] += change[0][i];
            }
        }
        for (i, power) in self.motion.power(&self.state).into_iter().enumerate() {
            self.rates[0][works + i] += power - before[i];
        }
        let far = shift > SHIFT;
        if shift > 0.0 {
            self.open(touching, far);
        }
        if largest > JUMP || largest * spin * h > TURNED || far {
            self.refresh();
        } else if largest > 0.0 {
            self.turn_rates();
        }
        Ok(None)
    }

    /// Finds what joints bear of the impulses of the contacts.
    fn bear(&mut self, touching: &Touching, h: f64) {
        let moving = &touching.moving;
        let mut impulses = vec![[[0.0; 3]; 2]; moving.len()];
        touching.set.each_impulse_on(|body, arm, p| {
            let [linear, angular] = &mut impulses[body];
            *linear = math::axpy(*linear, moving[body].inverse_mass, p);
            *angular = add(*angular, math::mul(&moving[body].inverse_inertia, math::cross(arm, p)));
        });
        self.motion.bear(&impulses, h);
    }

    /// Displaces bodies to open gaps and books the work; `far`: with the forces and rates at the end of the displacements.
    fn open(&mut self, touching: &mut Touching, far: bool) {
        let works = self.state.len() - WORKS;
        let [free_j, total_j] = [self.motion.energy_j(&self.state), self.motion.total_j(&self.state)];
        let given =
            |motion: &Motion, moving: &[Moving]| motion.done(|b| [moving[b].shift, moving[b].turn])[1];
        let mut given_j = given(&self.motion, &touching.moving);
        for (b, moving) in touching.moving.iter().enumerate() {
            let at = STATE * b;
            (0..3).for_each(|i| self.state[at + i] += moving.shift[i]);
            let q = &self.state[at + 3..at + 7];
            let q = math::qrenormalise(math::qmul(math::qexp(moving.turn), [q[0], q[1], q[2], q[3]]));
            self.state[at + 3..at + 7].copy_from_slice(&q);
        }
        if far {
            // forces change on the way, joints are left at second order
            self.motion.take(&self.state);
            self.motion.project(&mut self.state);
            self.refresh();
            given_j = 0.5 * (given_j + given(&self.motion, &touching.moving));
        }
        self.state[works + 1] += given_j;
        let opened_j = total_j - self.motion.total_j(&self.state);
        touching.opened_j += opened_j;
        self.state[works] += opened_j - (free_j - self.motion.energy_j(&self.state));
    }

    /// Tells the contacts which bodies are there and which joints and bushings connect.
    pub fn connect(&mut self) {
        if let Some(touching) = &mut self.touching {
            let ground = self.motion.bodies();
            let pairs = self.motion.connected(ground);
            touching.set.connect(pairs.into_iter(), |b| !self.motion.is_gone(b), BTreeSet::new());
        }
    }
}

impl crate::mbs::contact::Linked for Motion {
    fn part(&self, body: usize) -> Option<usize> {
        self.part_of(body)
    }

    fn mass_kg(&self, body: usize) -> f64 {
        self.part_mass_kg(body)
    }

    fn respond(&mut self, body: usize, impulse: [V3; 2], out: &mut Vec<(usize, [V3; 2])>) {
        self.response(body, impulse, out);
    }
}
