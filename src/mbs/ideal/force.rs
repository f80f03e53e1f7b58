//! Applied forces of smooth motion: springs and dampers between points and about axes, torques.

use super::joint::{Pose, angle_rad, frame_about, is_ground};
use crate::mbs::math::{M3, V3, add, cross, dot, mul, mul_t, norm, scale, sub};

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
    /// About an axis of the first body: `k θ + d θ'` against the turn of the second body since assembly, below half a revolution.
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
        /// Frames whose first row is the axis, in each body's frame.
        frames: [M3; 2],
        /// Stiffness and damping.
        law: [f64; 2],
    },
    /// See [`Force::Torque`].
    Torque {
        /// Body.
        body: usize,
        /// Torque.
        torque: V3,
    },
}

impl Acting {
    /// In the poses in which it is assembled.
    pub fn of(force: &Force, pose: impl Fn(usize) -> Pose) -> Self {
        match *force {
            Force::Spring { bodies, points_m, length_m, stiffness_n_m, damping_n_s_m } => {
                let local = |side: usize| {
                    let p = pose(bodies[side]);
                    mul_t(&p.r, sub(points_m[side], p.x))
                };
                let law = [length_m, stiffness_n_m, damping_n_s_m];
                Self::Spring { bodies, points: [local(0), local(1)], law }
            }
            Force::Torsion { bodies, axis, stiffness_nm_rad, damping_nm_s_rad } => {
                let global = frame_about(axis);
                let frames = bodies.map(|b| global.map(|row| mul_t(&pose(b).r, row)));
                Self::Torsion { bodies, frames, law: [stiffness_nm_rad, damping_nm_s_rad] }
            }
            Force::Torque { body, torque_nm } => Self::Torque { body, torque: torque_nm },
        }
    }

    /// Adds force and torque about the centre of mass to the bodies' loads.
    pub fn apply(&self, pose: impl Fn(usize) -> Pose, loads: &mut [[V3; 2]]) {
        let mut load = |body: usize, force: V3, torque: V3| {
            if !is_ground(body) {
                let [f, t] = &mut loads[body];
                (*f, *t) = (add(*f, force), add(*t, torque));
            }
        };
        match self {
            Self::Spring { bodies, points, law: [length, stiffness, damping] } => {
                let poses = bodies.map(&pose);
                let arms = [0, 1].map(|i| mul(&poses[i].r, points[i]));
                let at = [0, 1].map(|i: usize| add(poses[i].x, arms[i]));
                let speed = [0, 1].map(|i: usize| add(poses[i].v, cross(poses[i].w, arms[i])));
                let gap = sub(at[1], at[0]);
                let now = norm(gap).max(f64::MIN_POSITIVE);
                let along = scale(1.0 / now, gap);
                let pull = stiffness * (now - length) + damping * dot(sub(speed[1], speed[0]), along);
                load(bodies[0], scale(pull, along), scale(pull, cross(arms[0], along)));
                load(bodies[1], scale(-pull, along), scale(-pull, cross(arms[1], along)));
            }
            Self::Torsion { bodies, frames, law: [stiffness, damping] } => {
                let poses = bodies.map(&pose);
                let n = mul(&poses[0].r, frames[0][0]);
                let rate = dot(sub(poses[1].w, poses[0].w), n);
                let torque = stiffness * angle_rad(frames, [&poses[0], &poses[1]]) + damping * rate;
                load(bodies[0], [0.0; 3], scale(torque, n));
                load(bodies[1], [0.0; 3], scale(-torque, n));
            }
            Self::Torque { body, torque } => load(*body, [0.0; 3], *torque),
        }
    }

    /// Energy stored \[J\]; that of a constant torque is left out.
    pub fn stored_j(&self, pose: impl Fn(usize) -> Pose) -> f64 {
        match self {
            Self::Spring { bodies, points, law: [length, stiffness, _] } => {
                let at = [0, 1].map(|i: usize| {
                    let p = pose(bodies[i]);
                    add(p.x, mul(&p.r, points[i]))
                });
                0.5 * stiffness * (norm(sub(at[1], at[0])) - length).powi(2)
            }
            Self::Torsion { bodies, frames, law: [stiffness, _] } => {
                let poses = bodies.map(&pose);
                0.5 * stiffness * angle_rad(frames, [&poses[0], &poses[1]]).powi(2)
            }
            Self::Torque { .. } => 0.0,
        }
    }
}
