//! Ideal joints and their constraint rows.
//!
//! A row is a linear condition on the velocities of two bodies, `g · (v_a, ω_a, v_b, ω_b) = 0`, the rate of a residual `c = 0` of the poses; its
//! derivative gives `g · (accelerations) = γ`. Three kinds of rows make all joints: points that coincide (along global axes), points that do not move against each other
//! along an axis of the first body, and axes of two bodies at a right angle.

use super::GROUND;
use crate::mbs::math::{M3, Q, V3, add, axpy, cross, dot, mul, mul_t, norm, scale, sub};

/// What a joint leaves free. Axis 0 is that of its frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Rotation about all axes.
    Spherical,
    /// Rotation about axis 0.
    Revolute,
    /// Rotation about axis 0 of the first and axis 1 of the second body.
    Universal,
    /// Rotation about axis 0 and sliding along it.
    Cylindrical,
    /// Sliding along axis 0.
    Prismatic,
    /// Nothing.
    Fixed,
    /// Sliding across axis 0 and rotation about it.
    Planar,
    /// Sliding of the point along axis 0, all rotations.
    PointOnLine,
    /// All but the distance of the two points: a rod without mass.
    Distance,
}

impl Kind {
    /// Pairs of axes of the two bodies that stay at a right angle.
    fn right_angles(self) -> &'static [[usize; 2]] {
        match self {
            Self::Spherical | Self::PointOnLine | Self::Distance => &[],
            Self::Universal => &[[0, 1]],
            Self::Revolute | Self::Cylindrical | Self::Planar => &[[0, 1], [0, 2]],
            Self::Prismatic | Self::Fixed => &[[0, 1], [0, 2], [1, 2]],
        }
    }

    /// Axes of the first body along which the points do not move against each other.
    fn slides(self) -> &'static [usize] {
        match self {
            Self::Cylindrical | Self::Prismatic | Self::PointOnLine => &[1, 2],
            Self::Planar => &[0],
            _ => &[],
        }
    }

    /// Whether the points coincide.
    fn coincides(self) -> bool {
        matches!(self, Self::Spherical | Self::Revolute | Self::Universal | Self::Fixed)
    }

    /// Number of rows.
    pub fn rows(self) -> usize {
        let point = if self.coincides() { 3 } else { usize::from(self == Self::Distance) };
        point + self.slides().len() + self.right_angles().len()
    }
}

/// A joint between two bodies, given in the pose in which it is assembled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Joint {
    /// What it leaves free.
    pub kind: Kind,
    /// The bodies; [`GROUND`] is the ground.
    pub bodies: [usize; 2],
    /// The point of each body, global \[m\]; the same one but for rods.
    pub points_m: [V3; 2],
    /// Axes of the frame, global: rows of unit length at right angles.
    pub axes: M3,
}

impl Joint {
    /// A joint at a point with an axis 0 (for kinds without an axis any).
    pub fn at(kind: Kind, bodies: [usize; 2], point_m: V3, axis: V3) -> Self {
        Self { kind, bodies, points_m: [point_m; 2], axes: frame_about(axis) }
    }

    /// A rod without mass between two points.
    pub fn rod(bodies: [usize; 2], points_m: [V3; 2]) -> Self {
        Self { kind: Kind::Distance, bodies, points_m, axes: frame_about([1.0, 0.0, 0.0]) }
    }

    /// Whether it holds its point in height: a guide along which bodies slide up and down leaves them to the ground.
    pub fn bears_weight(&self) -> bool {
        let upright = |along: V3| (along[2] / norm(along)).abs();
        match self.kind {
            Kind::Spherical | Kind::Revolute | Kind::Universal | Kind::Fixed => true,
            Kind::Cylindrical | Kind::Prismatic | Kind::PointOnLine => upright(self.axes[0]) < STRAIGHT,
            Kind::Planar => upright(self.axes[0]) > 1.0 - STRAIGHT,
            Kind::Distance => upright(sub(self.points_m[1], self.points_m[0])) > 1.0 - STRAIGHT,
        }
    }
}

/// A right-handed frame whose first row is along `axis`.
pub fn frame_about(axis: V3) -> M3 {
    let first = scale(1.0 / norm(axis), axis);
    let least = (0..3).min_by(|i, j| first[*i].abs().total_cmp(&first[*j].abs())).unwrap_or(0);
    let mut other = [0.0; 3];
    other[least] = 1.0;
    let second = cross(first, other);
    let second = scale(1.0 / norm(second), second);
    [first, second, cross(first, second)]
}

/// Position, rotation matrix, velocity and angular velocity of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pose {
    /// Centre of mass \[m\].
    pub x: V3,
    /// Body to global, as a quaternion and as a matrix.
    pub q: Q,
    /// The matrix.
    pub r: M3,
    /// Velocity \[m/s\].
    pub v: V3,
    /// Angular velocity, global \[rad/s\].
    pub w: V3,
}

impl Pose {
    /// The ground.
    pub const GROUND: Self = Self {
        x: [0.0; 3],
        q: [1.0, 0.0, 0.0, 0.0],
        r: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        v: [0.0; 3],
        w: [0.0; 3],
    };
}

/// A row: what it has to do with both bodies' velocity and angular velocity.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Row {
    /// Of the first and the second body: velocity, then angular velocity.
    pub of: [[V3; 2]; 2],
    /// Residual of the position.
    pub residual: f64,
    /// `γ`.
    pub gamma: f64,
}

/// A joint in the frames of its bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Compiled {
    kind: Kind,
    /// Bodies.
    pub bodies: [usize; 2],
    points: [V3; 2],
    /// Axes as rows, in each body's frame.
    frames: [M3; 2],
    length_m: f64,
    /// Global axes along which points coincide, and whether only parts in their plane count.
    along: [V3; 3],
    /// Normal of the plane in which both bodies move, if they do.
    plane: Option<V3>,
    /// Whether its point is held in height where it is assembled.
    bears_weight: bool,
}

/// Cosine of two directions that are across each other, and how much less than one it is where they are along each other.
const STRAIGHT: f64 = 1e-9;

impl Compiled {
    /// In the poses in which it is assembled. With a `plane` only rows in it are made.
    pub fn of(joint: &Joint, poses: [&Pose; 2], plane: Option<V3>) -> Self {
        let local = |side: usize, p: V3| mul_t(&poses[side].r, sub(p, poses[side].x));
        let frame = |side: usize| joint.axes.map(|axis| mul_t(&poses[side].r, axis));
        let along = match plane {
            Some(normal) => {
                let [n, a, b] = frame_about(normal);
                [a, b, n]
            }
            None => Pose::GROUND.r,
        };
        Self {
            kind: joint.kind,
            bodies: joint.bodies,
            points: [local(0, joint.points_m[0]), local(1, joint.points_m[1])],
            frames: [frame(0), frame(1)],
            length_m: norm(sub(joint.points_m[1], joint.points_m[0])),
            along,
            plane,
            bears_weight: joint.bears_weight(),
        }
    }

    /// [`Joint::bears_weight`] where it was assembled.
    pub fn bears_weight(&self) -> bool {
        self.bears_weight
    }

    /// Whether its rows are those of two points that coincide along the global axes.
    #[inline]
    pub fn is_point(&self) -> bool {
        self.kind == Kind::Spherical && self.plane.is_none()
    }

    /// From the centre of mass of a body to its point, global \[m\].
    #[inline]
    pub fn arm(&self, side: usize, pose: &Pose) -> V3 {
        mul(&pose.r, self.points[side])
    }

    /// Number of its rows.
    pub fn rows(&self) -> usize {
        match self.plane {
            Some(_) if self.kind == Kind::Revolute => 2,
            _ => self.kind.rows(),
        }
    }

    /// [`Compiled::write`] where [`Compiled::is_point`]; the arms of the points \[m\].
    #[inline]
    pub fn write_point(&self, poses: [&Pose; 2], rows: &mut [Row]) -> [V3; 2] {
        let arms = [0, 1].map(|side| self.arm(side, poses[side]));
        let points = Points::of(poses, arms);
        // `arm × e_i`
        let [a, b] = arms.map(|[x, y, z]| [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]);
        for (i, row) in rows.iter_mut().enumerate() {
            let axis = Pose::GROUND.r[i];
            row.of = [[scale(-1.0, axis), scale(-1.0, a[i])], [axis, b[i]]];
            (row.residual, row.gamma) = (points.gap[i], -points.turning[i]);
        }
        arms
    }

    /// Writes its rows at the poses of its bodies.
    pub fn write(&self, poses: [&Pose; 2], rows: &mut [Row]) {
        let arm = |side: usize| {
            let r = mul(&poses[side].r, self.points[side]);
            self.plane.map_or(r, |n| axpy(r, -dot(r, n), n))
        };
        let arms = [arm(0), arm(1)];
        let points = Points::of(poses, arms);
        let mut next = rows.iter_mut();
        let mut push = |row: Row| {
            if let Some(slot) = next.next() {
                *slot = row;
            }
        };
        if self.kind.coincides() {
            let axes = if self.plane.is_some() { &self.along[..2] } else { &self.along[..] };
            axes.iter().for_each(|axis| push(points.together(*axis)));
        }
        if self.kind == Kind::Distance {
            push(points.apart(self.length_m));
        }
        for axis in self.kind.slides() {
            push(points.beside(mul(&poses[0].r, self.frames[0][*axis])));
        }
        if self.plane.is_none() {
            for [i, j] in self.kind.right_angles() {
                let axes = [mul(&poses[0].r, self.frames[0][*i]), mul(&poses[1].r, self.frames[1][*j])];
                push(right_angle(axes, [poses[0].w, poses[1].w]));
            }
        }
    }
}

/// The points of a joint in motion.
struct Points {
    arms: [V3; 2],
    omega: [V3; 2],
    /// From the first to the second point \[m\], and its rate \[m/s\].
    gap: V3,
    rate: V3,
    /// Difference of the centripetal accelerations \[m/s²\].
    turning: V3,
}

impl Points {
    fn of(poses: [&Pose; 2], arms: [V3; 2]) -> Self {
        let omega = [poses[0].w, poses[1].w];
        let at = |i: usize| add(poses[i].x, arms[i]);
        let speed = |i: usize| add(poses[i].v, cross(omega[i], arms[i]));
        let inward = |i: usize| cross(omega[i], cross(omega[i], arms[i]));
        Self {
            arms,
            omega,
            gap: sub(at(1), at(0)),
            rate: sub(speed(1), speed(0)),
            turning: sub(inward(1), inward(0)),
        }
    }

    fn row(&self, axis: V3, [arm, other]: [V3; 2], residual: f64, gamma: f64) -> Row {
        let minus = |v: V3| scale(-1.0, v);
        Row { of: [[minus(axis), minus(cross(arm, axis))], [axis, cross(other, axis)]], residual, gamma }
    }

    /// The points coincide along a global axis.
    fn together(&self, axis: V3) -> Row {
        self.row(axis, self.arms, dot(self.gap, axis), -dot(self.turning, axis))
    }

    /// The second point stays where it is along an axis that turns with the first body.
    fn beside(&self, axis: V3) -> Row {
        let turned = cross(self.omega[0], axis);
        let gamma = -dot(self.turning, axis)
            - 2.0 * dot(self.rate, turned)
            - dot(self.gap, cross(self.omega[0], turned));
        self.row(axis, [add(self.arms[0], self.gap), self.arms[1]], dot(self.gap, axis), gamma)
    }

    /// The points stay so far apart: `(d · d - l²) / 2 l`.
    fn apart(&self, length: f64) -> Row {
        let axis = scale(1.0 / length, self.gap);
        let residual = 0.5 * (dot(self.gap, self.gap) / length - length);
        let gamma = -(dot(self.rate, self.rate) + dot(self.gap, self.turning)) / length;
        self.row(axis, self.arms, residual, gamma)
    }
}

/// Two axes, one of each body, at a right angle.
fn right_angle([u, s]: [V3; 2], [wa, wb]: [V3; 2]) -> Row {
    let across = cross(u, s);
    let turning = add(cross(cross(wa, u), s), cross(u, cross(wb, s)));
    // d/dt (u · s) = (ω_a - ω_b) · (u × s)
    Row {
        of: [[[0.0; 3], across], [[0.0; 3], scale(-1.0, across)]],
        residual: dot(u, s),
        gamma: -dot(sub(wa, wb), turning),
    }
}

/// The pose of a body, or of the ground.
#[inline]
pub fn pose_of(poses: &[Pose], body: usize) -> &Pose {
    if is_ground(body) { &Pose::GROUND } else { &poses[body] }
}

/// Whether an index is that of the ground.
#[inline]
pub fn is_ground(body: usize) -> bool {
    body == GROUND
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mbs::math::{qexp, qmat, qmul};

    const KINDS: [Kind; 9] = [
        Kind::Spherical,
        Kind::Revolute,
        Kind::Universal,
        Kind::Cylindrical,
        Kind::Prismatic,
        Kind::Fixed,
        Kind::Planar,
        Kind::PointOnLine,
        Kind::Distance,
    ];

    /// Two bodies in free motion with constant velocities; the joint is assembled at time zero.
    fn poses_at(time: f64) -> [Pose; 2] {
        let of = |x: V3, v: V3, w: V3, turn: V3| Pose {
            x: axpy(x, time, v),
            q: qmul(qexp(scale(time, w)), qexp(turn)),
            r: qmat(qmul(qexp(scale(time, w)), qexp(turn))),
            v,
            w,
        };
        [
            of([0.1, 0.2, -0.3], [0.5, -0.4, 0.2], [0.7, -0.3, 0.4], [0.2, 0.1, 0.5]),
            of([1.1, -0.2, 0.3], [-0.2, 0.3, 0.6], [-0.5, 0.8, 0.2], [-0.3, 0.4, 0.1]),
        ]
    }

    #[test]
    fn rows_are_the_rates_of_their_residuals() {
        let start = poses_at(0.0);
        for kind in KINDS {
            let mut joint = Joint::at(kind, [0, 1], [0.5, 0.1, 0.2], [0.3, 0.8, -0.5]);
            if kind == Kind::Distance {
                joint.points_m[1] = [0.9, 0.4, -0.2];
            }
            let joint = Compiled::of(&joint, [&start[0], &start[1]], None);
            let at = |time: f64| {
                let poses = poses_at(time);
                let mut rows = vec![Row::default(); joint.rows()];
                joint.write([&poses[0], &poses[1]], &mut rows);
                if joint.is_point() {
                    let mut same = rows.clone();
                    joint.write_point([&poses[0], &poses[1]], &mut same);
                    assert_eq!(rows, same);
                }
                rows
            };
            assert!(at(0.0).iter().all(|r| r.residual.abs() < 1e-14), "{kind:?}");
            let (time, step) = (0.3, 1e-5);
            let (before, now, after) = (at(time - step), at(time), at(time + step));
            let poses = poses_at(time);
            for ((b, n), a) in before.iter().zip(&now).zip(&after) {
                let rate: f64 =
                    (0..2).map(|i| dot(n.of[i][0], poses[i].v) + dot(n.of[i][1], poses[i].w)).sum();
                let slope = (a.residual - b.residual) / (2.0 * step);
                assert!((rate - slope).abs() < 1e-8, "{kind:?}: {rate} {slope}");
                // no acceleration: the second derivative of the residual is -γ
                let bend = (a.residual - 2.0 * n.residual + b.residual) / (step * step);
                assert!((bend + n.gamma).abs() < 1e-4, "{kind:?}: {bend} {}", n.gamma);
            }
        }
    }

    #[test]
    fn joints_leave_what_their_names_say() {
        let rows: Vec<usize> = KINDS.iter().map(|k| k.rows()).collect();
        assert_eq!(rows, [3, 5, 4, 4, 5, 6, 3, 2, 1]);
    }
}
