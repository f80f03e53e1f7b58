//! Applied forces of smooth motion: springs and dampers between points and about axes, torques, hinges that flow.
//!
//! A force gives the loads on the bodies and its power. What a hinge or torsion spring remembers does not change while a step is computed: each of its stages sees the history
//! up to the step, and the moments that belong to its own rotations, counted from that of the history.

use super::hinge_law::{HingeLaw, History};
use super::joint::{Pose, is_ground, pose_of};
use super::turn::{Turn, Twist};
use crate::mbs::math::{Q, V3, add, cross, dot, mul, mul_t, norm, qconj, qmul, scale, sub};

/// A force, given in the pose in which the mechanism is assembled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Force {
    /// Between two points \[m\]: `k (l - l_0) + d l'`, pulling.
    Spring {
        /// The bodies.
        bodies: [usize; 2],
        /// Their points, global \[m\].
        points_m: [V3; 2],
        /// Length without force \[m\].
        length_m: f64,
        /// Stiffness \[N/m\].
        stiffness_n_m: f64,
        /// Damping \[N s/m\].
        damping_n_s_m: f64,
    },
    /// About an axis that both bodies carry: `k θ + d θ'` against the turn of the second body about it since assembly, revolutions counted.
    Torsion {
        /// The bodies.
        bodies: [usize; 2],
        /// Axis, global.
        axis: V3,
        /// Stiffness \[N m/rad\].
        stiffness_nm_rad: f64,
        /// Damping \[N m s/rad\].
        damping_nm_s_rad: f64,
    },
    /// A constant torque \[N m\] on a body, global.
    Torque {
        /// The body.
        body: usize,
        /// The torque.
        torque_nm: V3,
    },
    /// A constant force at a point of a body, global \[N, m\].
    Force {
        /// The body.
        body: usize,
        /// The point.
        point_m: V3,
        /// The force.
        force_n: V3,
    },
    /// Moments about three axes, each elastic up to a capacity that depends on the largest rotation about its axis so far. Rotations are the components, in the frame of the
    /// first body, of the rotation vector from it to the second one since assembly, revolutions about one axis counted; the torque is the one that is conjugate to it.
    Hinge {
        /// The bodies.
        bodies: [usize; 2],
        /// Its law in [`super::Mechanism::laws`].
        law: usize,
        /// Joint that opens with it when it fractures.
        joint: Option<usize>,
    },
}

/// A hinge at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HingeState {
    /// Rotations about its axes \[rad\].
    pub rotation_rad: V3,
    /// Moments \[N m\].
    pub moment_nm: V3,
    /// Plastic rotations \[rad\].
    pub plastic_rad: V3,
    /// Elastic energy \[J\].
    pub elastic_j: f64,
    /// Work of plastic flow so far \[J\].
    pub dissipated_j: f64,
}

/// What became of a force as a step ended.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Committed {
    /// How far a hinge is beyond its fracture \[rad\], below zero while it holds.
    pub beyond: Option<f64>,
    /// Whether a hinge counts its rotation anew: it came near a full revolution about several axes.
    pub anew: bool,
    /// Whether the axis of a torsion spring points against itself in the two bodies, or nearly.
    pub lost: bool,
}

/// Loads of bodies: force and torque about the centre of mass \[N, N m\].
#[derive(Debug)]
pub struct Exerted<'a> {
    /// All of them.
    pub all: &'a mut [[V3; 2]],
    /// Those of dampers and applied forces.
    pub given: &'a mut [[V3; 2]],
}

impl Exerted<'_> {
    /// Adds force and torque of a spring or hinge to those of a body; nothing to the ground.
    #[inline]
    pub fn add(&mut self, body: usize, load: [V3; 2]) {
        if !is_ground(body) {
            add_to(&mut self.all[body], load);
        }
    }

    /// Adds those of a damper or an applied force.
    #[inline]
    fn give(&mut self, body: usize, load: [V3; 2]) {
        self.add(body, load);
        if !is_ground(body) {
            add_to(&mut self.given[body], load);
        }
    }
}

fn add_to(sum: &mut [V3; 2], load: [V3; 2]) {
    *sum = [add(sum[0], load[0]), add(sum[1], load[1])];
}

/// A force in the frames of its bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Acting {
    /// See [`Force::Spring`].
    Spring {
        /// Bodies and their points in their frames.
        bodies: [usize; 2],
        /// Points.
        points: [V3; 2],
        /// Length, stiffness and damping.
        law: [f64; 3],
    },
    /// See [`Force::Torsion`].
    Torsion {
        /// Bodies.
        bodies: [usize; 2],
        /// Axis of unit length in the frame of the first.
        axis: V3,
        /// Rotation of the second body against the first at assembly.
        start: Q,
        /// Stiffness and damping.
        law: [f64; 2],
        /// Turn at the end of the last step \[rad\].
        held: f64,
        /// When it was applied last.
        last: Twist,
    },
    /// See [`Force::Torque`].
    Torque {
        /// Body.
        body: usize,
        /// Torque.
        torque: V3,
        /// Whether it acts.
        on: bool,
    },
    /// See [`Force::Hinge`].
    Hinge {
        /// Bodies.
        bodies: [usize; 2],
        /// Rotation of the second body against the first at assembly.
        start: Q,
        /// Index of its law.
        law: usize,
        /// Joint that opens with it.
        joint: Option<usize>,
        /// What it remembers.
        history: [History; 3],
        /// Factor on its capacity.
        factor: f64,
        /// Rotation at the end of the last step \[rad\].
        held: V3,
        /// When it was applied last.
        last: Turn,
        /// Moments \[N m\] and histories with that.
        next: [(f64, History); 3],
        /// Axes about which it flowed in the last step.
        flowing: [bool; 3],
        /// Rates of its rotations at the end of it \[rad/s\].
        rate: V3,
    },
    /// See [`Force::Force`].
    Force {
        /// Body.
        body: usize,
        /// Point in its frame.
        point: V3,
        /// Force.
        force: V3,
        /// Whether it acts.
        on: bool,
    },
}

impl Acting {
    /// In the poses in which it is assembled.
    pub fn of(force: &Force, poses: &[Pose]) -> Self {
        match *force {
            Force::Spring { bodies, points_m, length_m, stiffness_n_m, damping_n_s_m } => {
                let local = |side: usize| {
                    let p = pose_of(poses, bodies[side]);
                    mul_t(&p.r, sub(points_m[side], p.x))
                };
                let law = [length_m, stiffness_n_m, damping_n_s_m];
                Self::Spring { bodies, points: [local(0), local(1)], law }
            }
            Force::Torsion { bodies, axis, stiffness_nm_rad, damping_nm_s_rad } => {
                let axis = mul_t(&pose_of(poses, bodies[0]).r, scale(1.0 / norm(axis), axis));
                let (start, law) = (start_of(bodies, poses), [stiffness_nm_rad, damping_nm_s_rad]);
                Self::Torsion { bodies, axis, start, law, held: 0.0, last: Twist::near(NO_TURN, axis, 0.0) }
            }
            Force::Torque { body, torque_nm } => Self::Torque { body, torque: torque_nm, on: true },
            Force::Hinge { bodies, law, joint } => Self::Hinge {
                bodies,
                start: start_of(bodies, poses),
                law,
                joint,
                history: [History::default(); 3],
                factor: 1.0,
                held: [0.0; 3],
                last: Turn::near(NO_TURN, [0.0; 3]),
                next: [(0.0, History::default()); 3],
                flowing: [false; 3],
                rate: [0.0; 3],
            },
            Force::Force { body, point_m, force_n } => {
                let p = pose_of(poses, body);
                Self::Force { body, point: mul_t(&p.r, sub(point_m, p.x)), force: force_n, on: true }
            }
        }
    }

    /// Adds force and torque about the centre of mass to the bodies' loads.
    pub fn apply(&mut self, poses: &[Pose], laws: &[HingeLaw], loads: &mut Exerted<'_>) {
        match self {
            Self::Spring { bodies, points, law: [length, stiffness, damping] } => {
                let poses = bodies.map(|b| pose_of(poses, b));
                let arms = [0, 1].map(|i| mul(&poses[i].r, points[i]));
                let at = [0, 1].map(|i: usize| add(poses[i].x, arms[i]));
                let speed = [0, 1].map(|i: usize| add(poses[i].v, cross(poses[i].w, arms[i])));
                let gap = sub(at[1], at[0]);
                let now = norm(gap).max(f64::MIN_POSITIVE);
                let along = scale(1.0 / now, gap);
                let of = |i: usize, pull: f64| [scale(pull, along), scale(pull, cross(arms[i], along))];
                let pull = *stiffness * (now - *length);
                loads.add(bodies[0], of(0, pull));
                loads.add(bodies[1], of(1, -pull));
                if *damping != 0.0 {
                    let pull = *damping * dot(sub(speed[1], speed[0]), along);
                    loads.give(bodies[0], of(0, pull));
                    loads.give(bodies[1], of(1, -pull));
                }
            }
            Self::Torsion { bodies, axis, start, law: [stiffness, damping], held, last } => {
                let poses = bodies.map(|b| pose_of(poses, b));
                *last = Twist::near(turned(poses, *start), *axis, *held);
                let along = mul(&poses[0].r, last.gradient);
                let rate = dot(sub(poses[1].w, poses[0].w), along);
                let of = |torque: f64| [[0.0; 3], scale(torque, along)];
                let torque = *stiffness * last.angle;
                loads.add(bodies[0], of(torque));
                loads.add(bodies[1], of(-torque));
                if *damping != 0.0 {
                    loads.give(bodies[0], of(*damping * rate));
                    loads.give(bodies[1], of(-*damping * rate));
                }
            }
            Self::Torque { body, torque, on: true } => loads.give(*body, [[0.0; 3], *torque]),
            Self::Force { body, point, force, on: true } => {
                let turn = cross(mul(&pose_of(poses, *body).r, *point), *force);
                loads.give(*body, [*force, turn]);
            }
            Self::Torque { .. } | Self::Force { .. } => {}
            Self::Hinge { bodies, start, law, history, factor, held, last, next, .. } => {
                let poses = bodies.map(|b| pose_of(poses, b));
                *last = Turn::near(turned(poses, *start), *held);
                *next = moments(&laws[*law], history, last, *factor);
                let torque = mul(&poses[0].r, last.torque(next.map(|n| n.0)));
                loads.add(bodies[0], [[0.0; 3], torque]);
                loads.add(bodies[1], [[0.0; 3], scale(-1.0, torque)]);
            }
        }
    }

    /// Whether any of its work is that of a damper or of an applied force.
    pub fn is_given(&self) -> bool {
        match self {
            Self::Spring { law: [.., damping], .. } | Self::Torsion { law: [_, damping], .. } => {
                *damping != 0.0
            }
            Self::Torque { .. } | Self::Force { .. } => true,
            Self::Hinge { .. } => false,
        }
    }

    /// Takes the pose in which it was applied last into the history.
    pub fn commit(&mut self, poses: &[Pose], laws: &[HingeLaw]) -> Committed {
        match self {
            Self::Torsion { held, last, .. } => {
                *held = last.angle;
                Committed { lost: last.is_lost(), ..Committed::default() }
            }
            Self::Hinge { bodies, law, history, factor, held, last, next, flowing, rate, .. } => {
                *rate = last.rate(bodies.map(|b| pose_of(poses, b)));
                let law = &laws[*law];
                *flowing = flows(history, next);
                let anew = last.anew(*held, next.map(|n| n.0));
                let to = anew.unwrap_or(last.theta);
                for (i, own) in history.iter_mut().enumerate() {
                    *own = law.with_work(*own, next[i].1, *factor);
                    // keeps moment and energy
                    own.plastic += to[i] - last.theta[i];
                    next[i].1 = *own;
                }
                let beyond = norm(last.theta) - law.fracture_rad;
                *held = to;
                Committed { beyond: Some(beyond), anew: anew.is_some(), lost: false }
            }
            _ => Committed::default(),
        }
    }

    /// Stiffness \[N/m, N m/rad\], and how far it turns its bodies each: the square of its arm \[m²\], or nothing if it turns them only.
    pub fn stiffness(&self, poses: &[Pose], laws: &[HingeLaw]) -> Option<(f64, [Option<f64>; 2])> {
        match self {
            Self::Spring { points, law: [_, stiffness, _], .. } => {
                Some((*stiffness, points.map(|p| Some(dot(p, p)))))
            }
            Self::Torsion { law: [stiffness, _], .. } => {
                let along = self.twist(poses).map_or([0.0; 3], |t| t.gradient);
                Some((*stiffness * dot(along, along), [None; 2]))
            }
            Self::Hinge { law, .. } => Some((laws[*law].stiffness_nm_rad, [None; 2])),
            Self::Torque { .. } | Self::Force { .. } => None,
        }
    }

    /// Adds the elastic loads that follow a small motion `[velocity, angular velocity]` of the bodies.
    pub fn respond(&self, poses: &[Pose], laws: &[HingeLaw], motion: &[[V3; 2]], loads: &mut [[V3; 2]]) {
        let of = |body: usize| if is_ground(body) { [[0.0; 3]; 2] } else { motion[body] };
        let mut load = |body: usize, force: V3, torque: V3| {
            if !is_ground(body) {
                let [f, t] = &mut loads[body];
                (*f, *t) = (add(*f, force), add(*t, torque));
            }
        };
        match self {
            Self::Spring { bodies, points, law: [_, stiffness, _] } => {
                let poses = bodies.map(|b| pose_of(poses, b));
                let arms = [0, 1].map(|i: usize| mul(&poses[i].r, points[i]));
                let gap = sub(add(poses[1].x, arms[1]), add(poses[0].x, arms[0]));
                let along = scale(1.0 / norm(gap).max(f64::MIN_POSITIVE), gap);
                let [a, b] = [0, 1].map(|i: usize| {
                    let [v, w] = of(bodies[i]);
                    add(v, cross(w, arms[i]))
                });
                let pull = scale(stiffness * dot(sub(b, a), along), along);
                load(bodies[0], pull, cross(arms[0], pull));
                load(bodies[1], scale(-1.0, pull), scale(-1.0, cross(arms[1], pull)));
            }
            Self::Torsion { bodies, law: [stiffness, _], .. } => {
                let along = self.twist(poses).map_or([0.0; 3], |t| t.gradient);
                let axis = mul(&pose_of(poses, bodies[0]).r, along);
                let turn = dot(sub(of(bodies[1])[1], of(bodies[0])[1]), axis);
                load(bodies[0], [0.0; 3], scale(stiffness * turn, axis));
                load(bodies[1], [0.0; 3], scale(-stiffness * turn, axis));
            }
            Self::Hinge { bodies, law, .. } => {
                let turn = sub(of(bodies[1])[1], of(bodies[0])[1]);
                let moment = scale(laws[*law].stiffness_nm_rad, turn);
                load(bodies[0], [0.0; 3], moment);
                load(bodies[1], [0.0; 3], scale(-1.0, moment));
            }
            Self::Torque { .. } | Self::Force { .. } => {}
        }
    }

    /// The bodies that it acts on.
    pub fn bodies(&self) -> Vec<usize> {
        match self {
            Self::Spring { bodies, .. } | Self::Torsion { bodies, .. } | Self::Hinge { bodies, .. } => {
                bodies.to_vec()
            }
            Self::Torque { body, .. } | Self::Force { body, .. } => vec![*body],
        }
    }

    /// Switches an applied force or torque.
    pub fn switch(&mut self, to: bool) {
        if let Self::Torque { on, .. } | Self::Force { on, .. } = self {
            *on = to;
        }
    }

    /// Multiplies the capacity of a hinge.
    pub fn weaken(&mut self, by: f64) {
        if let Self::Hinge { factor, .. } = self {
            *factor *= by;
        }
    }

    /// The turn of a torsion spring at poses that follow on what it remembers.
    fn twist(&self, poses: &[Pose]) -> Option<Twist> {
        let Self::Torsion { bodies, axis, start, held, .. } = self else { return None };
        Some(Twist::near(turned(bodies.map(|b| pose_of(poses, b)), *start), *axis, *held))
    }

    /// A hinge, or a torsion spring about its one axis, at poses that follow on what it remembers.
    pub fn turn(&self, poses: &[Pose], laws: &[HingeLaw]) -> Option<HingeState> {
        if let (Self::Torsion { bodies, law: [stiffness, damping], .. }, Some(twist)) =
            (self, self.twist(poses))
        {
            let poses = bodies.map(|b| pose_of(poses, b));
            let rate = dot(sub(poses[1].w, poses[0].w), mul(&poses[0].r, twist.gradient));
            return Some(HingeState {
                rotation_rad: [twist.angle, 0.0, 0.0],
                moment_nm: [stiffness * twist.angle + damping * rate, 0.0, 0.0],
                plastic_rad: [0.0; 3],
                elastic_j: 0.5 * stiffness * twist.angle * twist.angle,
                dissipated_j: 0.0,
            });
        }
        let Self::Hinge { bodies, start, law, history, factor, held, .. } = self else { return None };
        let turn = Turn::near(turned(bodies.map(|b| pose_of(poses, b)), *start), *held);
        let law = &laws[*law];
        let next = moments(law, history, &turn, *factor);
        let moment = next.map(|n| n.0);
        let after = [0, 1, 2].map(|i: usize| law.with_work(history[i], next[i].1, *factor));
        Some(HingeState {
            rotation_rad: turn.theta,
            moment_nm: moment,
            plastic_rad: after.map(|h| h.plastic),
            elastic_j: 0.5 * dot(moment, moment) / law.stiffness_nm_rad,
            dissipated_j: after.iter().map(|h| h.dissipated_j).sum(),
        })
    }

    /// Elastic energy \[J\].
    pub fn elastic_j(&self, poses: &[Pose], laws: &[HingeLaw]) -> f64 {
        match self {
            Self::Spring { bodies, points, law: [length, stiffness, _] } => {
                let at = [0, 1].map(|i: usize| {
                    let p = pose_of(poses, bodies[i]);
                    add(p.x, mul(&p.r, points[i]))
                });
                0.5 * stiffness * (norm(sub(at[1], at[0])) - length).powi(2)
            }
            Self::Hinge { .. } | Self::Torsion { .. } => self.turn(poses, laws).map_or(0.0, |h| h.elastic_j),
            Self::Torque { .. } | Self::Force { .. } => 0.0,
        }
    }

    /// Whether a hinge began or ceased to flow about an axis on the way to the pose in which it was applied last.
    pub fn has_turned_over(&self) -> bool {
        let Self::Hinge { history, next, flowing, .. } = self else { return false };
        flows(history, next) != *flowing
    }

    /// Work of flow that a step \[s\] leaves out, as a hinge turns back in it ([`turned_back`]) \[J\].
    pub fn turned_back_j(&self, poses: &[Pose], step: f64) -> f64 {
        let Self::Hinge { bodies, history, last, next, flowing, rate, .. } = self else { return 0.0 };
        let flow = [0, 1, 2].map(|i: usize| next[i].1.plastic - history[i].plastic);
        if flow == [0.0; 3] && *flowing == [false; 3] {
            return 0.0;
        }
        let now = last.rate(bodies.map(|b| pose_of(poses, b)));
        let lost = |i: usize| next[i].0.abs() * turned_back(flow[i], flowing[i], [rate[i], now[i]], step);
        (0..3).map(lost).sum()
    }

    /// Whether a hinge has flowed.
    pub fn has_flowed(&self) -> bool {
        self.dissipated_j() > 0.0
    }

    /// Work of plastic flow so far \[J\].
    pub fn dissipated_j(&self) -> f64 {
        let Self::Hinge { history, .. } = self else { return 0.0 };
        history.iter().map(|h| h.dissipated_j).sum()
    }

    /// Plastic rotations about its axes \[rad\].
    pub fn plastic_rad(&self) -> V3 {
        let Self::Hinge { history, .. } = self else { return [0.0; 3] };
        history.map(|h| h.plastic)
    }

    /// How far a hinge was beyond its fracture when it was applied last \[rad\]; `None` of other forces.
    pub fn beyond(&self, laws: &[HingeLaw]) -> Option<f64> {
        let Self::Hinge { law, last, .. } = self else { return None };
        Some(norm(last.theta) - laws[*law].fracture_rad)
    }
}

/// How far something flowed within a step beyond what its end tells, by its rates at both ends (straight in between): where it turned back in it, from flow in this step or in the one before. Its law, which sees the end alone, takes
/// that for nothing, and a force that does not change has no error that could tell.
pub(super) fn turned_back(flow: f64, flowed: bool, [from, to]: [f64; 2], step: f64) -> f64 {
    let turns = from * to < 0.0;
    let way = |rate: f64| 0.5 * step * rate * rate / (to - from).abs();
    match flow * to {
        beyond if beyond < 0.0 && turns => way(to),
        beyond if beyond < 0.0 => 0.5 * step * to.abs(),
        _ if flow == 0.0 && flowed && turns => way(from),
        _ => 0.0,
    }
}

/// The rotation at assembly.
const NO_TURN: Q = [1.0, 0.0, 0.0, 0.0];

/// Rotation of the second body against the first, in the frame of the first.
fn start_of(bodies: [usize; 2], poses: &[Pose]) -> Q {
    let [a, b] = bodies.map(|b| pose_of(poses, b).q);
    qmul(qconj(a), b)
}

/// Rotation from the first to the second body since assembly, in the frame of the first.
fn turned(poses: [&Pose; 2], start: Q) -> Q {
    qmul(qmul(qconj(poses[0].q), poses[1].q), qconj(start))
}

/// About which axes a hinge flows on its way to a history.
fn flows(history: &[History; 3], next: &[(f64, History); 3]) -> [bool; 3] {
    let about = |i: usize| next[i].1.plastic != history[i].plastic;
    [about(0), about(1), about(2)]
}

/// Moments along the rotation vector of a hinge, and what it remembers with them.
fn moments(law: &HingeLaw, history: &[History; 3], turn: &Turn, factor: f64) -> [(f64, History); 3] {
    let about = |i: usize| law.moment(history[i], turn.theta[i], factor);
    [about(0), about(1), about(2)]
}
