//! Accelerations of a mechanism at a state, and the nearest state that its joints allow.

mod changes;

use crate::curve::CurveError;
use crate::mbs::ideal::bushing::Held;
use crate::mbs::ideal::factor::{BlockFactor, SIDES, stride};
use crate::mbs::ideal::force::{Acting, Exerted};
use crate::mbs::ideal::hinge_law::HingeLaw;
use crate::mbs::ideal::joint::{Compiled, Pose, Row, is_ground, pose_of};
use crate::mbs::ideal::planar::planes;
use crate::mbs::ideal::solve::{Loads, Sides};
use crate::mbs::ideal::{Mechanism, joint};
use crate::mbs::math::{
    M3, Q, V3, add, axpy, cross, dot, inverse, mul, mul_t, qmat, qmul, qrenormalise, scale, sub, turned,
};
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// Numbers of a body in a state: position, orientation, velocity, angular velocity.
pub const STATE: usize = 13;

/// Numbers behind those of the bodies: the work of all forces without gravity, springs and hinges included, and the part of it that dampers and applied forces do \[J\].
pub const WORKS: usize = 2;

/// What one pair of rows of `S` gets from a body that two joints share.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Part {
    /// Where the block begins.
    place: usize,
    /// Joint of its rows and of its columns, each with the side on which the body is.
    rows: (usize, usize),
    columns: (usize, usize),
}

/// Sign of a joint's rows on its first and second body.
pub(in crate::mbs::ideal) const SENSE: [f64; 2] = [-1.0, 1.0];

/// Adds what a body gives to the block of two joints that hold a point of it each: `s_a s_b (1/m - r_a× I⁻¹ r_b×)`; `turned(j)` is
/// `s_b I⁻¹ (r_b × e_j)`.
fn add_point_block(
    block: &mut [f64],
    [sense_a, sense_b]: [f64; 2],
    arm_a: V3,
    inverse_mass: f64,
    turned: impl Fn(usize) -> V3,
) {
    for j in 0..3 {
        let column = cross(turned(j), arm_a);
        for (i, c) in column.iter().enumerate() {
            block[stride(3) * i + j] += sense_a * c;
        }
        block[(stride(3) + 1) * j] += sense_a * sense_b * inverse_mass;
    }
}

/// A mechanism in motion.
#[derive(Debug, Clone)]
pub struct Motion {
    pub(in crate::mbs::ideal) gravity: V3,
    pub(in crate::mbs::ideal) mass: Vec<f64>,
    pub(in crate::mbs::ideal) inertia: Vec<M3>,
    pub(in crate::mbs::ideal) inverse_inertia: Vec<M3>,
    /// The inverse in the global frame at the state that was taken.
    pub(in crate::mbs::ideal) inverse: Vec<M3>,
    pub(in crate::mbs::ideal) joints: Vec<Compiled>,
    /// First row of each joint, and the number of rows.
    pub(in crate::mbs::ideal) first: Vec<usize>,
    /// Place of each joint in the mechanism.
    pub(in crate::mbs::ideal) ids: Vec<usize>,
    pub(in crate::mbs::ideal) forces: Vec<Acting>,
    /// Place of each force in the mechanism.
    pub(in crate::mbs::ideal) force_ids: Vec<usize>,
    pub(in crate::mbs::ideal) laws: Vec<HingeLaw>,
    pub(in crate::mbs::ideal) bushings: Vec<Held>,
    /// Place of each bushing behind the forces of the mechanism.
    pub(in crate::mbs::ideal) bushing_ids: Vec<usize>,
    /// Bushings that tension broke, by their places; for the caller to fetch.
    pub torn: Vec<usize>,
    /// Hinges that flowed for the first time, by their places in the mechanism; for the caller to fetch.
    pub yielded: Vec<usize>,
    /// Hinges that count their rotations anew, and torsion springs whose axis points against itself, by their places in the mechanism; for the caller to fetch.
    pub confused: Vec<usize>,
    /// Rotations, and plastic ones, of hinges and bushings that are gone, as they went, by their places in the mechanism \[rad\].
    pub ended: BTreeMap<usize, [V3; 2]>,
    /// Impulses of joints over the step that contacts asked for in the last one, a multiplier for each row; empty: nothing touched.
    borne: Vec<f64>,
    /// Plastic work of hinges that are gone, and elastic energy of those that fractured \[J\].
    pub(in crate::mbs::ideal) spent_j: f64,
    pub(in crate::mbs::ideal) lost_j: f64,
    /// Bodies that were taken away: they stay where they are.
    pub(in crate::mbs::ideal) gone: Vec<bool>,
    parts: Vec<Part>,
    pub(in crate::mbs::ideal) factor: BlockFactor,
    pub(in crate::mbs::ideal) poses: Vec<Pose>,
    pub(in crate::mbs::ideal) rows: Vec<Row>,
    /// `M⁻¹` times the rows' parts.
    pub(in crate::mbs::ideal) moved: Vec<[[V3; 2]; 2]>,
    /// Arms of the joints that hold a point only \[m\]; their rows need no general products.
    pub(in crate::mbs::ideal) arms: Vec<Option<[V3; 2]>>,
    pub(in crate::mbs::ideal) loads: Vec<[V3; 2]>,
    /// Forces and torques, gravity aside, of the rate that was found last; those of dampers and applied forces, if there are any.
    pub(in crate::mbs::ideal) applied: Vec<[V3; 2]>,
    given: Vec<[V3; 2]>,
    is_given: bool,
    pub(in crate::mbs::ideal) multipliers: Vec<f64>,
    /// Loads and multipliers of several right-hand sides.
    pub(in crate::mbs::ideal) sides: Vec<Loads>,
    pub(in crate::mbs::ideal) wanted: Vec<Sides>,
    /// Bodies that joints hold together, by part; the part of each body that joints hold.
    pub(in crate::mbs::ideal) parts_bodies: Vec<Vec<usize>>,
    pub(in crate::mbs::ideal) part: Vec<Option<usize>>,
}

impl Motion {
    /// Prepares a mechanism; rows across the plane of plane parts are left out unless `in_space`.
    ///
    /// # Errors
    /// If a curve cannot be compiled.
    pub fn of(mechanism: &Mechanism, in_space: bool) -> Result<Self, CurveError> {
        let start: Vec<Pose> = mechanism
            .bodies
            .iter()
            .map(|b| Pose {
                x: b.position_m,
                q: b.orientation,
                r: qmat(b.orientation),
                v: b.velocity_m_s,
                w: b.angular_velocity_rad_s,
            })
            .collect();
        let pose = |body: usize| *pose_of(&start, body);
        let planes = if in_space { vec![None; start.len()] } else { planes(mechanism) };
        let compile = |j: &joint::Joint| {
            let moving = j.bodies.into_iter().find(|b| !is_ground(*b));
            let plane = moving.and_then(|b| planes[b]);
            Compiled::of(j, [&pose(j.bodies[0]), &pose(j.bodies[1])], plane)
        };
        let joints: Vec<Compiled> = mechanism.joints.iter().map(compile).collect();
        let mut motion = Self {
            gravity: mechanism.gravity_m_s2,
            mass: mechanism.bodies.iter().map(|b| b.mass_kg).collect(),
            inertia: mechanism.bodies.iter().map(|b| b.inertia_kg_m2).collect(),
            inverse_inertia: mechanism.bodies.iter().map(|b| inverse(&b.inertia_kg_m2)).collect(),
            inverse: vec![[[0.0; 3]; 3]; start.len()],
            ids: (0..joints.len()).collect(),
            joints,
            first: Vec::new(),
            forces: mechanism.forces.iter().map(|f| Acting::of(f, &start)).collect(),
            force_ids: (0..mechanism.forces.len()).collect(),
            laws: mechanism.laws.clone(),
            bushings: mechanism.bushings.iter().map(|b| Held::of(b, &start)).collect::<Result<_, _>>()?,
            bushing_ids: (0..mechanism.bushings.len()).map(|i| mechanism.forces.len() + i).collect(),
            torn: Vec::new(),
            yielded: Vec::new(),
            confused: Vec::new(),
            ended: BTreeMap::new(),
            borne: Vec::new(),
            spent_j: 0.0,
            lost_j: 0.0,
            gone: vec![false; start.len()],
            parts: Vec::new(),
            factor: BlockFactor::new(&[], &BTreeSet::new()),
            loads: vec![[[0.0; 3]; 2]; start.len()],
            applied: vec![[[0.0; 3]; 2]; start.len()],
            given: vec![[[0.0; 3]; 2]; start.len()],
            is_given: false,
            parts_bodies: Vec::new(),
            part: vec![None; start.len()],
            rows: Vec::new(),
            moved: Vec::new(),
            arms: Vec::new(),
            multipliers: Vec::new(),
            sides: vec![[[[0.0; SIDES]; 3]; 2]; start.len()],
            wanted: Vec::new(),
            poses: start,
        };
        motion.is_given = motion.forces.iter().any(Acting::is_given);
        motion.link();
        Ok(motion)
    }

    /// Finds order and pattern of `S` for the joints that are there.
    fn link(&mut self) {
        let counts: Vec<usize> = self.joints.iter().map(Compiled::rows).collect();
        self.first = vec![0];
        counts.iter().for_each(|c| self.first.push(self.first[self.first.len() - 1] + c));
        let (pairs, shared) = shared(&self.joints, self.poses.len());
        let factor = BlockFactor::new(&counts, &pairs);
        let part = |[a, b, side_a, side_b]: [usize; 4]| {
            let (place, straight) = factor.place(a, b);
            let (rows, columns) =
                if straight { ((a, side_a), (b, side_b)) } else { ((b, side_b), (a, side_a)) };
            Part { place, rows, columns }
        };
        self.parts = shared.into_iter().map(part).collect();
        let total = self.first[self.first.len() - 1];
        self.arms = vec![None; self.joints.len()];
        self.rows = vec![Row::default(); total];
        self.moved = vec![[[[0.0; 3]; 2]; 2]; total];
        self.multipliers = vec![0.0; total];
        self.wanted = vec![[0.0; SIDES]; total];
        self.factor = factor;
        self.borne.clear();
        self.find_parts();
    }

    /// Finds the parts of bodies that joints hold together.
    fn find_parts(&mut self) {
        let mut sets = UnionFind::<usize>::new(self.mass.len());
        self.part.fill(None);
        let moving = |j: &Compiled| j.bodies.into_iter().filter(|b| !is_ground(*b)).collect::<Vec<_>>();
        for ends in self.joints.iter().map(moving) {
            if let [a, b] = ends[..] {
                sets.union(a, b);
            }
            ends.iter().for_each(|b| self.part[*b] = Some(0));
        }
        let labels = sets.into_labeling();
        let mut places: BTreeMap<usize, usize> = BTreeMap::new();
        self.parts_bodies.clear();
        for (body, part) in self.part.iter_mut().enumerate().filter(|(_, p)| p.is_some()) {
            let place = *places.entry(labels[body]).or_insert(self.parts_bodies.len());
            if place == self.parts_bodies.len() {
                self.parts_bodies.push(Vec::new());
            }
            self.parts_bodies[place].push(body);
            *part = Some(place);
        }
    }

    /// The part of a body that joints hold.
    pub fn part_of(&self, body: usize) -> Option<usize> {
        self.part[body]
    }

    /// Mass of the part of a body \[kg\].
    pub fn part_mass_kg(&self, body: usize) -> f64 {
        self.part[body].map_or(self.mass[body], |p| self.parts_bodies[p].iter().map(|b| self.mass[*b]).sum())
    }

    /// What an impulse on a body (linear, angular about its centre of mass \[N s, N m s\]) adds to the velocities of its part, at the state that was taken.
    pub fn response(&mut self, body: usize, impulse: [V3; 2], out: &mut Vec<(usize, [V3; 2])>) {
        self.loads.fill([[0.0; 3]; 2]);
        self.loads[body] = [scale(1.0 / self.mass[body], impulse[0]), mul(&self.inverse[body], impulse[1])];
        self.accept(|_| 0.0);
        let part = self.part[body].map_or(&[][..], |p| &self.parts_bodies[p]);
        out.extend(part.iter().map(|b| (*b, self.loads[*b])));
    }

    /// Number of bodies.
    pub fn bodies(&self) -> usize {
        self.mass.len()
    }

    /// One over the mass of a body \[1/kg\].
    pub fn inverse_mass(&self, body: usize) -> f64 {
        1.0 / self.mass[body]
    }

    /// Inverse inertia of a body, global, at the state that was taken \[1/(kg m²)\].
    pub fn inverse_inertia(&self, body: usize) -> &M3 {
        &self.inverse[body]
    }

    /// What forces, gravity aside, of the rate that was found last do to bodies with velocities or displacements (linear, angular): all, and those of dampers and applied forces
    /// \[W or J\].
    pub fn done(&self, of: impl Fn(usize) -> [V3; 2]) -> [f64; WORKS] {
        let sum = |loads: &[[V3; 2]]| -> f64 {
            let on_body = |(b, [force, torque]): (usize, &[V3; 2])| {
                let [linear, angular] = of(b);
                dot(*force, linear) + dot(*torque, angular)
            };
            loads.iter().enumerate().map(on_body).sum()
        };
        [sum(&self.applied), if self.is_given { sum(&self.given) } else { 0.0 }]
    }

    /// Their power at the velocities of a state \[W\].
    pub fn power(&self, state: &[f64]) -> [f64; WORKS] {
        self.done(|b| {
            let s = &state[STATE * b..STATE * (b + 1)];
            [[s[7], s[8], s[9]], [s[10], s[11], s[12]]]
        })
    }

    /// Notes what joints bear of impulses on bodies, over the mass and inertia (linear, angular) of these, in a step of `h` \[s\], at the state that was taken.
    pub(in crate::mbs::ideal) fn bear(&mut self, impulses: &[[V3; 2]], h: f64) {
        self.loads.copy_from_slice(impulses);
        self.accept(|_| 0.0);
        self.borne.clear();
        self.borne.extend(self.multipliers.iter().map(|m| m / h));
    }

    /// Forgets it.
    pub(in crate::mbs::ideal) fn bear_nothing(&mut self) {
        self.borne.clear();
    }

    /// Multipliers of the rate that was taken last, and of what contacts asked for in the last step.
    pub(in crate::mbs::ideal) fn borne(&self, row: usize) -> [f64; 2] {
        [self.multipliers[row], self.borne.get(row).copied().unwrap_or(0.0)]
    }

    /// Weight of a body \[N\].
    pub fn weight(&self, body: usize) -> V3 {
        scale(self.mass[body], self.gravity)
    }

    /// Pairs of bodies that joints and bushings connect; `ground` stands for the ground, which counts where they bear weight.
    pub fn connected(&self, ground: usize) -> Vec<(usize, usize)> {
        let own = |b: usize| if is_ground(b) { ground } else { b };
        let joints = self.joints.iter().map(|j| (j.bodies, j.bears_weight()));
        let bushings = self.bushings.iter().map(|b| (b.bodies, b.bears_weight(&self.poses)));
        let counts = |(bodies, bears): &([usize; 2], bool)| *bears || !bodies.iter().any(|b| is_ground(*b));
        joints.chain(bushings).filter(counts).map(|([a, b], _)| (own(a), own(b))).collect()
    }

    /// The state of the start.
    pub fn state(mechanism: &Mechanism) -> Vec<f64> {
        let mut state = Vec::with_capacity(STATE * mechanism.bodies.len());
        for b in &mechanism.bodies {
            state.extend(b.position_m);
            state.extend(b.orientation);
            state.extend(b.velocity_m_s);
            state.extend(b.angular_velocity_rad_s);
        }
        state.extend([0.0; WORKS]);
        state
    }

    /// Constraint rows.
    pub fn constraints(&self) -> usize {
        self.rows.len()
    }

    /// Rows that the last factorisation found to depend on others.
    pub fn dependent(&self) -> usize {
        self.factor.dependent
    }

    /// Takes a state: poses, rows, and the factorisation.
    pub fn take(&mut self, state: &[f64]) {
        for (pose, s) in self.poses.iter_mut().zip(state.chunks_exact(STATE)) {
            *pose = read(s);
        }
        for ((inverse, pose), own) in self.inverse.iter_mut().zip(&self.poses).zip(&self.inverse_inertia) {
            *inverse = turned(&pose.r, own);
        }
        for (j, joint) in self.joints.iter().enumerate() {
            let range = self.first[j]..self.first[j + 1];
            let pose = |body: usize| pose_of(&self.poses, body);
            let rows = &mut self.rows[range.clone()];
            let poses = joint.bodies.map(pose);
            self.arms[j] = joint.is_point().then(|| joint.write_point(poses, rows));
            if self.arms[j].is_none() {
                joint.write(poses, rows);
            }
            let inverse_mass = joint.bodies.map(|b| if is_ground(b) { 0.0 } else { 1.0 / self.mass[b] });
            for (row, moved) in rows.iter().zip(&mut self.moved[range]) {
                for side in 0..2 {
                    let body = joint.bodies[side];
                    if !is_ground(body) {
                        let [linear, angular] = row.of[side];
                        moved[side] = [scale(inverse_mass[side], linear), mul(&self.inverse[body], angular)];
                    }
                }
            }
        }
        self.fill();
        self.factor.factorise();
    }

    fn fill(&mut self) {
        let values = self.factor.values();
        values.fill(0.0);
        for part in &self.parts {
            let ((a, side_a), (b, side_b)) = (part.rows, part.columns);
            let (rows, columns) = (self.first[a]..self.first[a + 1], self.first[b]..self.first[b + 1]);
            let at = part.place;
            if let (Some(arms), Some(_)) = (self.arms[a], self.arms[b]) {
                let block = &mut values[at..at + 3 * stride(3)];
                let body = self.joints[a].bodies[side_a];
                let moved = &self.moved[columns.start..columns.start + 3];
                add_point_block(
                    block,
                    [SENSE[side_a], SENSE[side_b]],
                    arms[side_a],
                    1.0 / self.mass[body],
                    |j| moved[j][side_b][1],
                );
                continue;
            }
            let moved = &self.moved[columns];
            let width = stride(moved.len());
            for (row, values) in self.rows[rows].iter().zip(values[at..].chunks_mut(width)) {
                let [linear, angular] = row.of[side_a];
                for (value, moved) in values.iter_mut().zip(moved) {
                    let [l, w] = moved[side_b];
                    *value += dot(linear, l) + dot(angular, w);
                }
            }
        }
    }

    /// The rate of the state that was taken.
    pub fn rate(&mut self, rate: &mut [f64]) {
        let power = self.load();
        self.accept(|row| -row.gamma);
        self.write_rate(power, rate);
    }

    /// Loads the bodies with the accelerations that they would have without joints; the power of the forces, gravity aside: all, and those of dampers and applied forces \[W\].
    pub(in crate::mbs::ideal) fn load(&mut self) -> [f64; WORKS] {
        for (load, mass) in self.loads.iter_mut().zip(&self.mass) {
            *load = [scale(*mass, self.gravity), [0.0; 3]];
        }
        for (load, _) in self.loads.iter_mut().zip(&self.gone).filter(|(_, gone)| **gone) {
            *load = [[0.0; 3]; 2];
        }
        if self.is_given {
            self.given.fill([[0.0; 3]; 2]);
        }
        let mut loads = Exerted { all: &mut self.loads, given: &mut self.given };
        for force in &mut self.forces {
            force.apply(&self.poses, &self.laws, &mut loads);
        }
        for bushing in &mut self.bushings {
            bushing.apply(&self.poses, &mut loads);
        }
        for ((applied, load), mass) in self.applied.iter_mut().zip(&self.loads).zip(&self.mass) {
            *applied = [axpy(load[0], -mass, self.gravity), load[1]];
        }
        for (b, load) in self.loads.iter_mut().enumerate() {
            let pose = &self.poses[b];
            let own = mul_t(&pose.r, pose.w);
            let gyroscopic = mul(&pose.r, cross(own, mul(&self.inertia[b], own)));
            let torque = sub(load[1], gyroscopic);
            *load = [scale(1.0 / self.mass[b], load[0]), mul(&self.inverse[b], torque)];
        }
        self.done(|b| [self.poses[b].v, self.poses[b].w])
    }

    /// Writes the accelerations with which the bodies are loaded, and the velocities.
    pub(in crate::mbs::ideal) fn write_rate(&mut self, power: [f64; WORKS], rate: &mut [f64]) {
        self.feel();
        for ((rate, pose), a) in rate.chunks_exact_mut(STATE).zip(&self.poses).zip(&self.loads) {
            rate[..3].copy_from_slice(&pose.v);
            rate[7..10].copy_from_slice(&a[0]);
            rate[10..].copy_from_slice(&a[1]);
        }
        let behind = rate.len() - WORKS;
        rate[behind..].copy_from_slice(&power);
    }

    /// Largest residual of a joint at the state that was taken: m, or the sine of an angle.
    pub fn residual(&self) -> f64 {
        self.rows.iter().map(|r| r.residual.abs()).fold(0.0, f64::max)
    }

    /// Kinetic and potential energy (zero at the origin) of a body at a pose \[J\].
    fn body_energy_j(&self, body: usize, pose: &Pose) -> f64 {
        let own = mul_t(&pose.r, pose.w);
        let kinetic = self.mass[body] * dot(pose.v, pose.v) + dot(own, mul(&self.inertia[body], own));
        0.5 * kinetic - self.mass[body] * dot(self.gravity, pose.x)
    }

    /// Kinetic and potential energy (zero at the origin) of a state \[J\].
    pub fn energy_j(&self, state: &[f64]) -> f64 {
        let there = state.chunks_exact(STATE).enumerate().filter(|(b, _)| !self.gone[*b]);
        there.map(|(b, s)| self.body_energy_j(b, &read(s))).sum()
    }

    /// Kinetic and potential energy (zero at the origin) at the state that was taken, less the work of the applied forces in it \[J\]: constant, but for errors.
    pub fn balance_j(&self, state: &[f64]) -> f64 {
        let there = self.poses.iter().enumerate().filter(|(b, _)| !self.gone[*b]);
        let bodies: f64 = there.map(|(b, pose)| self.body_energy_j(b, pose)).sum();
        bodies - state[state.len() - WORKS]
    }
}

/// Rate of an orientation: half of the angular velocity times it.
pub fn quaternion_rate(q: Q, w: V3) -> Q {
    qmul([0.0, 0.5 * w[0], 0.5 * w[1], 0.5 * w[2]], q)
}

/// Position of a body's point in a state.
pub fn point_at(state: &[f64], body: usize, point: V3) -> V3 {
    let pose = read(&state[STATE * body..STATE * (body + 1)]);
    add(pose.x, mul(&pose.r, point))
}

pub(in crate::mbs::ideal) fn read(s: &[f64]) -> Pose {
    let q = qrenormalise([s[3], s[4], s[5], s[6]]);
    Pose { x: [s[0], s[1], s[2]], q, r: qmat(q), v: [s[7], s[8], s[9]], w: [s[10], s[11], s[12]] }
}

/// Pairs of joints that share a moving body; and for each shared body `[joint, joint, side, side]`, a joint with itself included.
fn shared(joints: &[Compiled], bodies: usize) -> (BTreeSet<(usize, usize)>, Vec<[usize; 4]>) {
    let mut at: Vec<Vec<[usize; 2]>> = vec![Vec::new(); bodies];
    for (j, joint) in joints.iter().enumerate() {
        for side in 0..2 {
            if !is_ground(joint.bodies[side]) {
                at[joint.bodies[side]].push([j, side]);
            }
        }
    }
    let (mut pairs, mut shared) = (BTreeSet::new(), Vec::new());
    for list in &at {
        for (i, [a, side_a]) in list.iter().enumerate() {
            for [b, side_b] in &list[..=i] {
                if a != b {
                    pairs.insert((*a.min(b), *a.max(b)));
                }
                shared.push([*a, *b, *side_a, *side_b]);
            }
        }
    }
    (pairs, shared)
}
