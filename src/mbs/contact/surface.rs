//! Friction and restitution of each pair, and who passes through whom.

use super::Partner;
use super::collide::{Placed, Solid};
use crate::mbs::math;
use crate::mbs::model::{Body, GROUND, Model, Shape};
use std::collections::BTreeMap;

/// Height up to which a solid stands on the ground \[m\].
pub const AT_GROUND_M: f64 = 1e-3;

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

/// How a shape of a body stands on the ground at the start.
#[derive(Debug, Clone, Default)]
pub(super) struct Footing {
    /// Whether it does not touch the ground while an intact connection joins both: it stands on it or reaches below it, but for what is away from all connections that its body itself has with the ground.
    pub tied: bool,
    /// Points of it that are on the ground then, joined to it: that these meet it once the joint has failed is no news.
    pub feet: Vec<u64>,
}

/// How each shape of a body stands on the ground at the start.
pub(super) fn footings(model: &Model, body: &Body) -> Vec<Footing> {
    let level = model.contact.ground.as_ref().map_or(f64::NEG_INFINITY, |g| g.level_m);
    let turn = math::qmat(body.orientation);
    let height = |c: &math::V3| body.position_m[2] + math::mul(&turn, *c)[2];
    let stands = |shape: &Shape| shape.corners().iter().any(|c| height(c) <= level + AT_GROUND_M);
    let own = model.joined_to_ground().filter(|(_, id, _)| *id == body.id);
    let points: Vec<math::V3> = own.map(|(_, _, point)| point).collect();
    let at = Placed { x: body.position_m, q: body.orientation, r: turn };
    let placed = |shape: &Shape| {
        let (solid, in_body) = Solid::of(shape);
        let here = at.of(&in_body);
        (solid.bounds(&here), solid, here)
    };
    let solids: Vec<([math::V3; 2], Solid, Placed)> = body.shapes.iter().map(placed).collect();
    let corners = solids.iter().flat_map(|(bounds, ..)| bounds).chain(&points);
    let none = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    let [least, most] = corners.fold(none, |[least, most], p| {
        [0, 1].map(|side| {
            std::array::from_fn(|k| if side == 0 { least[k].min(p[k]) } else { most[k].max(p[k]) })
        })
    });
    let size_m = math::norm(math::sub(most, least));
    let beside_m = BESIDE_M.min(BESIDE_SHARE * size_m);
    let is_beside = |[low, high]: &[math::V3; 2], thickness_m: f64| {
        let near = |p: &math::V3| {
            let off: math::V3 = std::array::from_fn(|k| (low[k] - p[k]).max(p[k] - high[k]).max(0.0));
            math::norm(off) <= thickness_m.max(beside_m)
        };
        points.is_empty() || points.iter().any(near)
    };
    let footing = |(shape, (bounds, solid, here)): (&Shape, &([math::V3; 2], Solid, Placed))| {
        let tied = stands(shape) && is_beside(bounds, solid.thickness());
        let is_joined = tied && !points.is_empty();
        Footing { tied, feet: if is_joined { feet(solid, here, level) } else { Vec::new() } }
    };
    body.shapes.iter().zip(&solids).map(footing).collect()
}

/// Points of a solid that are on the ground or below it.
fn feet(solid: &Solid, here: &Placed, level_m: f64) -> Vec<u64> {
    let mut all = Vec::new();
    solid.feet(here, [0.0, 0.0, 1.0], f64::INFINITY, &mut all);
    let height = |foot: math::V3| here.x[2] + math::mul(&here.r, foot)[2];
    all.into_iter().filter(|(foot, _)| height(*foot) <= level_m + AT_GROUND_M).map(|(_, id)| id).collect()
}
