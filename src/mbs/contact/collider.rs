//! Solids of bodies and obstacles, and planes, as a model has them.

use super::collide::{Placed, Solid};
use super::surface::{self, Footing};
use super::terms::Partner;
use crate::mbs::math::{self, V3};
use crate::mbs::model::{Model, ObstacleBox, Shape};

/// A solid that may touch others.
#[derive(Debug, Clone)]
pub struct Collider {
    pub body: usize,
    pub solid: Solid,
    /// Its frame in the body; none if it is the body's.
    pub local: Option<Placed>,
    /// Whether that frame is turned in the body.
    pub turned: bool,
    pub thickness: f64,
    /// What it is to others.
    pub partner: Partner,
    /// How it stands on the ground at the start.
    pub footing: Footing,
}

impl Collider {
    fn of_body(body: usize, shape: &Shape, footing: Footing) -> Self {
        let (solid, local) = Solid::of(shape);
        Self {
            body,
            thickness: solid.thickness(),
            solid,
            local: (local != Placed::HERE).then_some(local),
            turned: local.q != Placed::HERE.q,
            partner: Partner::Body(body),
            footing,
        }
    }

    fn of_obstacle(i: usize, obstacle: &ObstacleBox, ground: usize) -> Self {
        let middle = std::array::from_fn(|k| 0.5 * (obstacle.min_m[k] + obstacle.max_m[k]));
        let half = std::array::from_fn(|k| 0.5 * (obstacle.max_m[k] - obstacle.min_m[k]));
        let (solid, local) = Solid::of(&Shape::cuboid(middle, half));
        Self {
            body: ground,
            thickness: f64::INFINITY,
            solid,
            local: Some(local),
            turned: false,
            partner: Partner::Obstacle(i),
            footing: Footing::default(),
        }
    }

    /// How far it reaches from the centre of its body \[m\].
    pub fn radius(&self) -> f64 {
        let local = self.local.unwrap_or(Placed::HERE);
        self.solid.radius(math::scale(-1.0, math::mul_t(&local.r, local.x)))
    }

    /// Where it is with its body in a pose, or by itself if that never moves.
    #[inline]
    pub fn placed(&self, body: Option<Placed>) -> Placed {
        match (body, &self.local) {
            (Some(body), None) => body,
            (Some(body), Some(local)) if self.turned => body.of(local),
            (Some(body), Some(local)) => Placed { x: math::add(body.x, math::mul(&body.r, local.x)), ..body },
            (None, Some(local)) => *local,
            (None, None) => Placed::HERE,
        }
    }

    /// Takes `depth_m` \[m\] off a box on one side.
    pub fn shorten(&mut self, axis: usize, sign: f64, depth_m: f64) {
        let Solid::Box(half) = &mut self.solid else { return };
        let depth_m = depth_m.min(2.0 * half[axis] * (1.0 - 1e-3));
        half[axis] -= 0.5 * depth_m;
        let local = self.local.get_or_insert(Placed::HERE);
        let along: V3 = std::array::from_fn(|i| local.r[i][axis]);
        local.x = math::axpy(local.x, -0.5 * sign * depth_m, along);
    }
}

/// A half space that never moves: `normal · x <= level`.
#[derive(Debug, Clone, Copy)]
pub struct Plane {
    pub normal: V3,
    pub level: f64,
    pub partner: Partner,
}

/// The solids of a model: those of its bodies in their order, then the obstacles, whose body is the number of bodies.
pub fn of_model(model: &Model) -> Vec<Collider> {
    let bodies = model.bodies.iter().enumerate().flat_map(|(body, entry)| {
        let shapes = entry.shapes.iter().zip(surface::footings(model, entry));
        shapes.map(move |(shape, footing)| Collider::of_body(body, shape, footing))
    });
    let ground = model.bodies.len();
    let obstacles =
        model.contact.obstacles.iter().enumerate().map(|(i, o)| Collider::of_obstacle(i, o, ground));
    bodies.chain(obstacles).collect()
}

/// The ground, if there is one, and the planes of a model.
pub fn planes(model: &Model) -> Vec<Plane> {
    let flat = model.contact.ground.iter().map(|g| Plane {
        normal: [0.0, 0.0, 1.0],
        level: g.level_m,
        partner: Partner::Ground,
    });
    let tilted = model.contact.planes.iter().enumerate().map(|(i, p)| {
        let normal = math::scale(1.0 / math::norm(p.normal), p.normal);
        Plane { normal, level: math::dot(normal, p.point_m), partner: Partner::Plane(i) }
    });
    flat.chain(tilted).collect()
}
