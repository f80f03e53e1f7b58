//! Sleep: islands of bodies at rest are left alone until something wakes them.
//!
//! An island is what contacts and bushings connect, the ground apart. It falls asleep when the kinetic energy of each of its bodies has been below
//! `½ m v²`, with the speed `v` of [`super::model::RunSettings::sleep_speed_m_s`], for [`REST_S`], and none gathers speed in that time ([`STEADY`]), as one that turns round, tips over or falls does. Its kinetic energy goes
//! into the book of the contacts. Asleep, it keeps its pose, its forces and the impulses of its contacts, and is neither kicked nor moved. It wakes, from rest and with these impulses, when a body that
//! is awake comes so near to one of its own that they may touch within a step; all islands wake with every event and every joint that separates.

use super::contact::ContactSet;
use super::math::{self, Q, V3};
use super::step;
use super::system::{BodyData, BodyState, System};
use petgraph::unionfind::UnionFind;

/// Time for which bodies are at rest before they fall asleep, and between looks at the islands \[s\].
pub const REST_S: f64 = 0.5;
const LOOK_S: f64 = 0.1;
/// Change of the mean velocity in the time at rest up to which a body does not gather speed, over the speed below which it rests.
const STEADY: f64 = 0.05;

/// How much farther a body comes in the second half of that time than in the first one if it gathers speed, and how far it may without that, over the way at the speed below which it rests: one that begins to tip over is slow for long.
const GATHERS: f64 = 1.2;
const NEXT_TO_NOTHING: f64 = 1e-3;

/// Who sleeps in a run.
#[derive(Debug, Clone)]
pub struct Sleep {
    /// Half the square of the speed: kinetic energy over mass up to which a body is at rest \[m²/s²\]; zero: nothing sleeps.
    level: f64,
    /// Each body's rest.
    rest: Vec<Rest>,
    /// The island of each body that sleeps, by its first body.
    island: Vec<Option<usize>>,
    asleep: usize,
    next_look_s: f64,
    /// Kinetic energy of the bodies as they fell asleep, after the impulses of that step, all together \[J\].
    pub taken_j: f64,
}

/// For how long a body has been at rest, and where it was in that time.
#[derive(Debug, Clone, Copy, Default)]
struct Rest {
    /// Time at rest, and that since the start of the last span of [`REST_S`] \[s\].
    time_s: f64,
    span_s: f64,
    /// Poses at the start of that span and in its middle.
    begin: Pose,
    middle: Option<Pose>,
}

type Pose = (V3, Q);

impl Rest {
    /// A step of `h` \[s\] at rest, with the square of half the speed of rest \[m²/s²\].
    fn go_on(&mut self, body: &BodyState, data: &BodyData, h: f64, level: f64) {
        let here = (body.x, body.q);
        if self.span_s == 0.0 {
            self.begin = here;
        }
        self.time_s += h;
        self.span_s += h;
        if self.span_s >= 0.5 * REST_S {
            self.middle.get_or_insert(here);
        }
        if self.span_s >= REST_S {
            // of a motion at one acceleration the middle is off by a T²/8, with a T the change of velocity
            let most = 2.0 * level * data.mass * (STEADY * REST_S / 8.0).powi(2);
            let nothing = (2.0 * level * data.mass).sqrt() * NEXT_TO_NOTHING * 0.5 * REST_S;
            let is_steady = self.middle.is_some_and(|middle| {
                let ways = [way([self.begin, middle], data), way([middle, here], data)];
                bend([self.begin, middle, here], data) <= most && ways[1] <= GATHERS * ways[0] + nothing
            });
            *self = Self { time_s: if is_steady { self.time_s } else { 0.0 }, ..Self::default() };
        }
    }
}

/// How far a pose is off the middle of two others: mass times the square of the distance, and inertia that of the angle \[kg m²\].
fn bend([begin, middle, end]: [Pose; 3], data: &BodyData) -> f64 {
    let off: V3 = std::array::from_fn(|k| middle.0[k] - 0.5 * (begin.0[k] + end.0[k]));
    let turned = |to: Pose| math::qlog(math::qmul(math::qconj(begin.1), to.1));
    let turn = math::axpy(turned(middle), -0.5, turned(end));
    data.mass * math::dot(off, off) + math::dot(turn, math::mul(&data.inertia, turn))
}

/// How far apart two poses are: root of mass times the square of the distance, and inertia that of the angle \[m kg^½\].
fn way([from, to]: [Pose; 2], data: &BodyData) -> f64 {
    let turn = math::qlog(math::qmul(math::qconj(from.1), to.1));
    let off = math::sub(to.0, from.0);
    (data.mass * math::dot(off, off) + math::dot(turn, math::mul(&data.inertia, turn))).sqrt()
}

impl Sleep {
    /// For bodies that are at rest below a speed \[m/s\]; none: nothing sleeps.
    pub fn new(speed_m_s: Option<f64>, bodies: usize) -> Self {
        Self {
            level: speed_m_s.map_or(0.0, |v| 0.5 * v * v),
            rest: vec![Rest::default(); bodies],
            island: vec![None; bodies],
            asleep: 0,
            next_look_s: LOOK_S,
            taken_j: 0.0,
        }
    }

    /// How many bodies sleep.
    pub fn asleep(&self) -> usize {
        self.asleep
    }

    /// Whether all bodies that are there sleep.
    pub fn is_complete(&self, system: &System) -> bool {
        self.asleep > 0 && system.data[..system.count()].iter().all(|d| !d.alive || d.asleep)
    }

    /// Counts the time at rest in a step of `h` \[s\] that begins at a time \[s\], its kicks and impulses done; islands that have rested fall asleep.
    pub fn count(&mut self, system: &mut System, contacts: &mut ContactSet, time_s: f64, h: f64) {
        if self.level == 0.0 {
            return;
        }
        for (i, rest) in self.rest.iter_mut().enumerate() {
            let (body, data) = (&system.bodies[i], &system.data[i]);
            if data.alive && !data.asleep {
                if step::step_energy_j(body, data) <= self.level * data.mass {
                    rest.go_on(body, data, h, self.level);
                } else {
                    *rest = Rest::default();
                }
            }
        }
        if time_s >= self.next_look_s {
            self.next_look_s = time_s + LOOK_S;
            self.look(system, contacts, h);
        }
    }

    /// Puts the islands to sleep in which all bodies have rested.
    fn look(&mut self, system: &mut System, contacts: &mut ContactSet, h: f64) {
        let n = self.rest.len();
        // what creeps under a load beyond its strength at rest never ends
        for joint in system.joints.iter().filter(|j| j.alive && j.flowing && j.is_rated()) {
            for i in [joint.a, joint.b].into_iter().filter(|i| *i < n) {
                self.rest[i] = Rest::default();
            }
        }
        let awake = |i: usize| system.data[i].alive && !system.data[i].asleep;
        if !(0..n).any(|i| awake(i) && self.rest[i].time_s >= REST_S) {
            return;
        }
        let mut sets = UnionFind::<usize>::new(n);
        let joined = system.joints.iter().filter(|j| j.alive).map(|j| [j.a, j.b]);
        for [a, b] in joined.chain(contacts.meeting()) {
            if a < n && b < n {
                sets.union(a, b);
            }
        }
        let labels = sets.into_labeling();
        let (mut firsts, mut restless) = (vec![None; n], vec![false; n]);
        for (i, label) in labels.iter().enumerate() {
            firsts[*label].get_or_insert(i);
            restless[*label] |= awake(i) && self.rest[i].time_s < REST_S;
        }
        for (i, label) in labels.into_iter().enumerate() {
            if system.data[i].alive && !system.data[i].asleep && !restless[label] {
                self.taken_j += step::kinetic_j(&system.bodies[i], &system.data[i], -0.5 * h);
                self.island[i] = firsts[label];
                self.asleep += 1;
                step::lay_down(system, i);
                contacts.set_asleep(i, true);
            }
        }
    }

    /// Wakes the islands of bodies that were touched in a step of `h` \[s\] whose kicks are done.
    pub fn rouse(&mut self, system: &mut System, contacts: &mut ContactSet, touched: &[usize], h: f64) {
        let islands: Vec<Option<usize>> =
            touched.iter().map(|i| self.island[*i]).filter(Option::is_some).collect();
        for i in 0..self.island.len() {
            if islands.contains(&self.island[i]) {
                self.wake(system, contacts, i);
                step::push(&mut system.bodies[i], 0.5 * h);
                step::find_velocities(&mut system.bodies[i], &system.data[i], h);
            }
        }
    }

    /// Wakes all bodies, momenta being `half_s` \[s\] behind.
    pub fn rouse_all(&mut self, system: &mut System, contacts: &mut ContactSet, half_s: f64) {
        if self.asleep > 0 {
            for i in 0..self.island.len() {
                if self.island[i].is_some() {
                    self.wake(system, contacts, i);
                    step::push(&mut system.bodies[i], -half_s);
                }
            }
        }
    }

    fn wake(&mut self, system: &mut System, contacts: &mut ContactSet, i: usize) {
        self.island[i] = None;
        self.rest[i] = Rest::default();
        self.asleep -= 1;
        system.data[i].asleep = false;
        contacts.set_asleep(i, false);
    }
}
