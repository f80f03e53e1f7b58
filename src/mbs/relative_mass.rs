//! Selective, stiffness-proportional mass scaling: inertia against relative motion, which slows the fastest vibrations down so that steps may be longer, and leaves rigid-body motions their mass.
//!
//! A building that stands or falls, and touches nothing yet, moves at some tens of rad/s, and its stiffest springs vibrate at thousands, which bound the explicit step. With `D = K / ω²` of all springs on top of the mass
//! every mode of frequency `ω_1` has `ω_1 / sqrt(1 + ω_1²/ω²) < ω` (stiffness-proportional mass scaling; Macek and Aubert, Earthq. Eng. Struct. Dyn. 24 (1995) 1315): slow ones are slower by `ω_1² / 2 ω²`, static
//! states and rigid motions are what they were, since `D` has nothing to do with either. It is the same as an implicit (trapezoidal) treatment of the elastic springs in a leapfrog.
//!
//! With `M` of the bodies accelerations are `a = (M + D)⁻¹ f`; the integrator gets the forces `M a`, so that bodies keep their own masses in everything else. `M + D` is factorised once, in the poses of that time and in axes that turn with each body.
//! What bodies of a floor share ([`super::shared_mass`]) is part of `D`.
//!
//! It ends for good, for all bodies together, where one of them is touched, falls asleep, turns by more than [`MOST_TURN_RAD`] in a step or parts at a latent bushing, and where springs that flow have much of its energy (`run/relate.rs`): from then on steps are as short as without. After a charge, a fracture, where sharing in a floor ends and where a body or a beam between two has turned by more than [`NEAR`] it begins anew in the poses of that time
//! (`run/relate.rs`). So a building falls with it up to its first contact: hinges that flow have inertia against their rotation that their springs no longer ask for, `K / ω²` of 100 kg m² where floors have 2e5 about the same hinges, and where bodies have turned against each other by `φ` since, springs between them see a relative
//! velocity of `φ v` that is none, half a per cent of the kinetic energy at most. Where velocities of the file strain stiff springs it never begins: `D` would have `½ v D v` that nothing has paid for (3 % of the energy of a building of which all bodies move along x in proportion to their height at 2 m/s for 10 m).

use super::block_solve::{BlockSolve, SIZE};
use super::ideal::factor::BlockFactor;
use super::joint::{JointData, Row};
use super::lanes::{LANES, Lane, ZERO, put};
use super::math::{self, M3, V3};
use super::shared_mass::Shared;
use super::system::{BodyData, BodyState};
use crate::base::isa::{Isa, for_each_isa};
use std::collections::BTreeSet;

/// Cosine of the angle by which a body may turn until the inertia is found anew: 0.1 rad.
const NEAR: f64 = 0.995;
/// Rotation in a step from which the springs of bodies that turn take energy from them \[rad\]: of two that turn about each other on a stiff one, 1e-5 of it in a second at half as much, 6e-4 at twice as much.
const MOST_TURN_RAD: f64 = 0.02;

/// The bodies, their `D`, and the factors of `M + D`.
#[derive(Debug, Clone)]
pub(super) struct Relative {
    /// The springs between bodies.
    springs: Vec<Together>,
    /// What floors share: places of two motions, and the inertia.
    floors: Vec<(usize, usize, f64)>,
    solve: BlockSolve,
    /// Orientation of each body at the start, and its inertia then.
    start: Vec<M3>,
    inertia: Vec<M3>,
    /// How each body has turned since.
    turned: Vec<M3>,
    /// The beams with the directions of their axial forces at the start, in their joints' axes.
    beams: Vec<(usize, V3)>,
    /// Memory: one node a body, the ground last, and the forces before.
    x: Vec<Lane>,
    plain: Vec<[V3; 2]>,
}

/// A spring: two bodies with their directions, and its inertia \[kg or kg m²\].
#[derive(Debug, Clone, Copy)]
struct Spring {
    ends: [(usize, [f64; SIZE]); 2],
    inertia: f64,
}

/// Up to eight springs between the same two bodies.
#[derive(Debug, Clone)]
struct Together {
    ends: [usize; 2],
    /// What their stretches are of the motions of either.
    of: [[Lane; SIZE]; 2],
    inertia: Lane,
}

impl Relative {
    /// For springs of bodies in the present poses, and a bound of all frequencies \[rad/s\]; none if the inertia is not positive.
    pub fn new(
        rows: &[Row],
        joints: &[JointData],
        (states, data): (&[BodyState], &[BodyData]),
        shared: &[Shared],
        most_rad_s: f64,
    ) -> Option<Self> {
        let n = states.len() - 1;
        let springs: Vec<Spring> = rows.iter().map(|row| spring(row, most_rad_s)).collect();
        let floors: Vec<(usize, usize, f64)> = shared.iter().flat_map(Shared::consistent).collect();
        let mut pairs = BTreeSet::new();
        let mut meet = |a: usize, b: usize| {
            if a != b && a.max(b) < n {
                pairs.insert((a.min(b), a.max(b)));
            }
        };
        springs.iter().for_each(|s| meet(s.ends[0].0, s.ends[1].0));
        floors.iter().for_each(|(i, j, _)| meet(i / SIZE, j / SIZE));
        let mut factor = BlockFactor::new(&vec![SIZE; n], &pairs);
        let inertia: Vec<M3> = (0..n)
            .map(|i| {
                let r = &states[i].r;
                math::turned(r, &data[i].inertia)
            })
            .collect();
        for i in 0..n {
            add(&mut factor, [i, i], |k, l| match (k.checked_sub(3), l.checked_sub(3)) {
                (Some(k), Some(l)) => inertia[i][k][l],
                _ if k == l => data[i].mass,
                _ => 0.0,
            });
        }
        for s in &springs {
            for (e, (a, of_a)) in s.ends.iter().enumerate() {
                // a pair of bodies has one block
                for (b, of_b) in s.ends[e..].iter().filter(|(b, _)| *a < n && *b < n) {
                    add(&mut factor, [*a, *b], |k, l| s.inertia * of_a[k] * of_b[l]);
                }
            }
        }
        for (i, j, value) in floors.iter().filter(|(i, j, _)| i / SIZE == j / SIZE || i < j) {
            let (at, straight) = factor.place(i / SIZE, j / SIZE);
            let (row, column) = if straight { (i % SIZE, j % SIZE) } else { (j % SIZE, i % SIZE) };
            factor.values()[at + SIZE * row + column] += value;
        }
        factor.factorise();
        (factor.dependent == 0).then(|| Self {
            springs: Together::all(&springs),
            floors,
            solve: BlockSolve::new(&factor),
            start: (0..n).map(|i| states[i].r).collect(),
            inertia,
            turned: vec![M3::default(); n],
            beams: lines(joints).collect(),
            x: vec![ZERO; n + 1],
            plain: vec![[[0.0; 3]; 2]; n],
        })
    }

    /// Changes forces to those with which each body has its acceleration by its own inertia alone.
    pub fn act(&mut self, isa: Isa, states: &mut [BodyState], data: &[BodyData]) {
        self.turn(states);
        for (i, body) in states[..self.plain.len()].iter().enumerate() {
            self.plain[i] = [body.force, body.torque];
            // as in `Shared::act`: what turns momenta against the axes
            let t = &self.turned[i];
            let force = math::mul_t(t, math::sub(body.force, math::cross(body.w, body.p)));
            let torque = math::mul_t(t, math::sub(body.torque, math::cross(body.w, body.l)));
            self.x[i] = [force[0], force[1], force[2], torque[0], torque[1], torque[2], 0.0, 0.0];
        }
        self.solve.solve(isa, &mut self.x);
        for (i, body) in states[..self.plain.len()].iter_mut().enumerate() {
            let (t, x) = (&self.turned[i], &self.x[i]);
            let force = math::scale(data[i].mass, math::mul(t, [x[0], x[1], x[2]]));
            let torque = math::mul(t, math::mul(&self.inertia[i], [x[3], x[4], x[5]]));
            body.force = math::add(force, math::cross(body.w, body.p));
            body.torque = math::add(torque, math::cross(body.w, body.l));
        }
    }

    /// Gives the bodies back the forces that they had before the last [`Self::act`].
    pub fn undo(&self, states: &mut [BodyState]) {
        for (body, [force, torque]) in states.iter_mut().zip(&self.plain) {
            (body.force, body.torque) = (*force, *torque);
        }
    }

    fn turn(&mut self, states: &[BodyState]) {
        for ((turned, start), body) in self.turned.iter_mut().zip(&self.start).zip(states) {
            *turned = math::matmul(&body.r, &math::transpose(start));
        }
    }

    /// What velocities and angular velocities add to the kinetic energy \[J\].
    pub fn energy_j(&mut self, isa: Isa, states: &[BodyState], velocity: impl Fn(usize) -> [V3; 2]) -> f64 {
        self.turn(states);
        for (i, turned) in self.turned.iter().enumerate() {
            let [v, w] = velocity(i).map(|v| math::mul_t(turned, v));
            self.x[i] = [v[0], v[1], v[2], w[0], w[1], w[2], 0.0, 0.0];
        }
        let at = |i: usize| self.x[i / SIZE][i % SIZE];
        let floors: f64 = self.floors.iter().map(|(i, j, value)| value * at(*i) * at(*j)).sum();
        0.5 * (squares(isa, &self.springs, &self.x) + floors)
    }

    /// What the forces of a step add to the kinetic energy of a body and of its part of `D` in a time \[s, J\]: with `a = (M + D)⁻¹ f` that of all is `½ t² f a`, and the forces before and after [`Self::act`] tell both.
    pub fn kick_j(&self, i: usize, body: &BodyState, data: &BodyData, time_s: f64) -> f64 {
        let gyroscopic = [math::cross(body.w, body.p), math::cross(body.w, body.l)];
        let [force, torque] = [0, 1].map(|k| math::sub(self.plain[i][k], gyroscopic[k]));
        let own = [math::sub(body.force, gyroscopic[0]), math::sub(body.torque, gyroscopic[1])];
        let turn = math::mul(&data.inverse_inertia, math::mul_t(&body.r, own[1]));
        let along = data.inverse_mass * math::dot(force, own[0]);
        0.5 * time_s * time_s * (along + math::dot(math::mul_t(&body.r, torque), turn))
    }

    /// Whether a body, or a beam between two, has turned by more than [`NEAR`] since it was found.
    pub fn has_turned(&self, states: &[BodyState], data: &[BodyData], joints: &[JointData]) -> bool {
        let turns = |(i, line): &(usize, V3)| {
            let now = joints[*i].beam.as_ref().map_or(*line, |b| b.chord.axis);
            joints[*i].alive && math::dot(now, *line) < NEAR
        };
        have_turned(&self.start, NEAR, states, data) || self.beams.iter().any(turns)
    }

    /// Whether it is over after a step \[s\]: a body sleeps, or turns by more than [`MOST_TURN_RAD`] in one.
    pub fn is_over(&self, step_s: f64, states: &[BodyState], data: &[BodyData]) -> bool {
        let sleeps = |d: &BodyData| d.alive && d.asleep;
        data[..self.start.len()].iter().any(sleeps) || spins(step_s, &states[..self.start.len()], data)
    }
}

/// The directions of the axial forces of beams.
fn lines(joints: &[JointData]) -> impl Iterator<Item = (usize, V3)> + '_ {
    joints.iter().enumerate().filter_map(|(i, j)| Some((i, j.beam.as_ref()?.chord.axis)))
}

/// Whether a body has turned by more than an angle of a cosine from an orientation.
pub(super) fn have_turned(from: &[M3], cosine: f64, states: &[BodyState], data: &[BodyData]) -> bool {
    let turned = |(from, (state, data)): (&M3, (&BodyState, &BodyData))| {
        let trace: f64 = (0..3).map(|k| math::dot(state.r[k], from[k])).sum();
        data.alive && 0.5 * (trace - 1.0) < cosine
    };
    from.iter().zip(states.iter().zip(data)).any(turned)
}

/// Whether a body turns by more than [`MOST_TURN_RAD`] in a step \[s\].
pub(super) fn spins(step_s: f64, states: &[BodyState], data: &[BodyData]) -> bool {
    let fast =
        |(state, data): (&BodyState, &BodyData)| data.alive && math::norm(state.w) * step_s > MOST_TURN_RAD;
    states.iter().zip(data).any(fast)
}

impl Together {
    fn all(springs: &[Spring]) -> Vec<Self> {
        let pair = |s: &Spring| s.ends.map(|(i, _)| i);
        let same = springs.chunk_by(|s, t| pair(s) == pair(t)).flat_map(|own| own.chunks(LANES));
        let of = |own: &[Spring]| {
            let mut all = Self { ends: pair(&own[0]), of: [[ZERO; SIZE]; 2], inertia: ZERO };
            for (l, spring) in own.iter().enumerate() {
                put(&mut all.of[0], l, spring.ends[0].1);
                put(&mut all.of[1], l, spring.ends[1].1);
                all.inertia[l] = spring.inertia;
            }
            all
        };
        same.map(of).collect()
    }
}

for_each_isa! {
    /// Sum of all squares of stretches times inertia.
    fn squares = squares_any(springs: &[Together], x: &[Lane]) -> f64
}

#[inline(always)]
fn squares_any(springs: &[Together], x: &[Lane]) -> f64 {
    let mut sum = ZERO;
    for s in springs {
        let mut stretch = ZERO;
        for (i, of) in s.ends.iter().zip(&s.of) {
            for k in 0..SIZE {
                for l in 0..LANES {
                    stretch[l] += of[k][l] * x[*i][k];
                }
            }
        }
        for l in 0..LANES {
            sum[l] += s.inertia[l] * stretch[l] * stretch[l];
        }
    }
    sum.iter().sum()
}

/// Adds to the block of a pair of bodies what a row and a column of it tell.
fn add(factor: &mut BlockFactor, [a, b]: [usize; 2], value: impl Fn(usize, usize) -> f64) {
    let (at, straight) = factor.place(a, b);
    let block = &mut factor.values()[at..at + SIZE * SIZE];
    for k in 0..SIZE {
        for l in 0..SIZE {
            block[if straight { SIZE * k + l } else { SIZE * l + k }] += value(k, l);
        }
    }
}

fn spring(row: &Row, most_rad_s: f64) -> Spring {
    let of = |turn: V3, sign: f64| {
        let (f, t) = (math::scale(sign, row.force), math::scale(sign, turn));
        [f[0], f[1], f[2], t[0], t[1], t[2]]
    };
    Spring {
        ends: [(row.a, of(row.turn_a, -1.0)), (row.b, of(row.turn_b, 1.0))],
        inertia: row.stiffness / (most_rad_s * most_rad_s),
    }
}
