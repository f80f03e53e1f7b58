//! Friction and restitution of each pair, and who passes through whom.

use super::Partner;
use super::collide::{Placed, Solid};
use crate::mbs::math;
use crate::mbs::model::{Body, GROUND, Model, Shape};
use std::collections::BTreeMap;

/// Height up to which a solid stands on the ground \[m\].
const AT_GROUND_M: f64 = 1e-3;

/// How far from a shape a connection with the ground may be to be at its foot: half the thickness of the shape, or this \[m\], but of a small body no more than a share of its size.
const BESIDE_M: f64 = 0.25;
const BESIDE_SHARE: f64 = 0.25;

/// What holds where two solids meet.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Surface {
    /// Coulomb friction coefficient.
    pub friction: f64,
    /// Coefficient of restitution.
    pub restitution: f64,
    /// Rolling-resistance arm \[m\].
    pub rolling: f64,
}

/// Whether a pair passes through each other, and its own friction, restitution and rolling-resistance arm.
type Rule = (bool, [Option<f64>; 3]);

/// Surfaces of a model.
#[derive(Debug, Clone, Default)]
pub(super) struct Surfaces {
    bodies: Option<Surface>,
    ground: Surface,
    planes: Vec<Surface>,
    obstacles: Vec<Surface>,
    rules: BTreeMap<(usize, Partner), Rule>,
}

impl Surfaces {
    pub fn new(model: &Model) -> Self {
        let contact = &model.contact;
        let body = |id: &str| model.bodies.iter().position(|b| b.id == id);
        let partner = |id: &str| {
            let plane = || contact.planes.iter().position(|p| p.id == id).map(Partner::Plane);
            let obstacle = || contact.obstacles.iter().position(|o| o.id == id).map(Partner::Obstacle);
            match id {
                GROUND => Some(Partner::Ground),
                _ => body(id).map(Partner::Body).or_else(plane).or_else(obstacle),
            }
        };
        let mut rules = BTreeMap::new();
        for rule in &contact.pairs {
            if let (Some(a), Some(b)) = (body(&rule.a), partner(&rule.b)) {
                rules.insert(key(a, b), (rule.ignore, [rule.friction, rule.restitution, rule.rolling_m]));
            }
        }
        let rolling = contact.rolling_m;
        let surface = |friction, restitution| Surface { friction, restitution, rolling };
        Self {
            bodies: contact.bodies.as_ref().map(|b| surface(b.friction, b.restitution)),
            ground: contact
                .ground
                .as_ref()
                .map_or(Surface::default(), |g| surface(g.friction, g.restitution)),
            planes: contact.planes.iter().map(|p| surface(p.friction, p.restitution)).collect(),
            obstacles: contact.obstacles.iter().map(|o| surface(o.friction, o.restitution)).collect(),
            rules,
        }
    }

    /// Whether bodies meet bodies.
    pub fn bodies_meet(&self) -> bool {
        self.bodies.is_some()
    }

    /// The surface between a body and what it meets; none if they pass through each other.
    pub fn between(&self, a: usize, b: Partner) -> Option<Surface> {
        let usual = match b {
            Partner::Body(_) => self.bodies?,
            Partner::Ground => self.ground,
            Partner::Plane(i) => self.planes[i],
            Partner::Obstacle(i) => self.obstacles[i],
        };
        match self.rules.get(&key(a, b)) {
            None => Some(usual),
            Some((true, _)) => None,
            Some((false, [friction, restitution, rolling])) => Some(Surface {
                friction: friction.unwrap_or(usual.friction),
                restitution: restitution.unwrap_or(usual.restitution),
                rolling: rolling.unwrap_or(usual.rolling),
            }),
        }
    }
}

/// The same for both orders of two bodies.
fn key(a: usize, b: Partner) -> (usize, Partner) {
    match b {
        Partner::Body(b) if b < a => (b, Partner::Body(a)),
        other => (a, other),
    }
}

/// Where a body is joined to the ground \[m\].
fn ground_points(model: &Model, body: &Body) -> Vec<math::V3> {
    let own = |a: &Option<String>, b: &str| match a {
        None => b == body.id,
        Some(a) => *a == body.id && b == GROUND,
    };
    let bushings = model.bushings.iter().filter(|j| own(&j.body_a, &j.body_b)).map(|j| j.point_m);
    let joints = model.joints.iter().filter(|j| own(&j.body_a, &j.body_b)).map(|j| j.point_m);
    bushings.chain(joints).collect()
}

/// Whether all of a body stands on the ground and is joined to it at the start, as a column on its foot: that it touches the ground once the joint has failed is no news.
pub(super) fn founded(model: &Model, body: &Body) -> bool {
    !ground_points(model, body).is_empty() && tied(model, body).iter().all(|tied| *tied)
}

/// Which shapes of a body do not touch the ground while an intact connection joins both: those that stand on it at the start or reach below it, but for what is away from all connections that the body itself has with the ground.
pub(super) fn tied(model: &Model, body: &Body) -> Vec<bool> {
    let level = model.contact.ground.as_ref().map_or(f64::NEG_INFINITY, |g| g.level_m);
    let turn = math::qmat(body.orientation);
    let height = |c: &[f64; 3]| body.position_m[2] + math::mul(&turn, *c)[2];
    let stands = |shape: &Shape| shape.corners().iter().any(|c| height(c) <= level + AT_GROUND_M);
    let points = ground_points(model, body);
    let at = Placed { x: body.position_m, q: body.orientation, r: turn };
    let placed = |shape: &Shape| {
        let (solid, in_body) = Solid::of(shape);
        (solid.thickness(), solid.bounds(&at.of(&in_body)))
    };
    let solids: Vec<(f64, [math::V3; 2])> = body.shapes.iter().map(placed).collect();
    let corners = solids.iter().flat_map(|(_, bounds)| bounds).chain(&points);
    let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [least, most] = corners.fold(none, |[least, most], p| {
        [0, 1].map(|side| {
            std::array::from_fn(|k| if side == 0 { least[k].min(p[k]) } else { most[k].max(p[k]) })
        })
    });
    let size_m = math::norm(math::sub(most, least));
    let beside_m = BESIDE_M.min(BESIDE_SHARE * size_m);
    let is_beside = |(thickness_m, [low, high]): &(f64, [math::V3; 2])| {
        let near = |p: &math::V3| {
            let off: math::V3 = std::array::from_fn(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0));
            math::norm(off) <= thickness_m.max(beside_m)
        };
        points.is_empty() || points.iter().any(near)
    };
    body.shapes.iter().zip(&solids).map(|(shape, solid)| stands(shape) && is_beside(solid)).collect()
}
