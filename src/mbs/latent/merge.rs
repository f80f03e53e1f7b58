//! Bodies that latent bushings hold together, as one body.

use crate::base::sets::groups;
use crate::mbs::math::{self, M3, Q, V3};
use crate::mbs::model::{Body, MassBlock, Model, Shape, SharedMass};
use petgraph::unionfind::UnionFind;
use std::collections::BTreeMap;

/// Where a body of the model file is in the model that runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Its body there.
    pub body: usize,
    /// Its pose in that body; none if it is that body.
    pub pose: Option<(V3, Q)>,
}

impl Place {
    /// Position and orientation for those of the body it is in.
    pub fn of(&self, x: V3, q: Q, r: &M3) -> (V3, Q) {
        match &self.pose {
            None => (x, q),
            Some((offset, turn)) => {
                (math::add(x, math::mul(r, *offset)), math::qrenormalise(math::qmul(q, *turn)))
            }
        }
    }
}

/// A model in which latent bushings are rigid, and what became of its parts.
#[derive(Debug, Clone)]
pub struct Merged {
    /// The model.
    pub model: Model,
    /// Each body of the file.
    pub places: Vec<Place>,
    /// Which bodies of the file each body of the model is made of.
    pub pieces: Vec<Vec<usize>>,
    /// The bushing of the model that each one of the file is; none while it is latent.
    pub bushings: Vec<Option<usize>>,
}

fn places(model: &Model) -> BTreeMap<&str, usize> {
    model.bodies.iter().enumerate().map(|(i, b)| (b.id.as_str(), i)).collect()
}

/// A number for each body, the same for those that latent bushings hold together.
pub fn held_together(model: &Model, latent: &[bool]) -> Vec<usize> {
    sets(model, latent).into_labeling()
}

fn sets(model: &Model, latent: &[bool]) -> UnionFind<usize> {
    let index = places(model);
    let at = |id: &str| index.get(id).copied();
    let mut sets = UnionFind::<usize>::new(model.bodies.len());
    for (bushing, _) in model.bushings.iter().zip(latent).filter(|(_, latent)| **latent) {
        if let (Some(a), Some(b)) = (bushing.body_a.as_deref().and_then(at), at(&bushing.body_b)) {
            sets.union(a, b);
        }
    }
    sets
}

/// Joins the bodies between latent bushings; each body takes the id of its first piece.
///
/// Curves, tracked points, events and their rules are left to the model of the file. The mass, centre and momenta of a body are the sums over its pieces, so that pieces that move as one go on as they did.
pub fn merge(model: &Model, latent: &[bool]) -> Merged {
    let index = places(model);
    let at = |id: &str| index.get(id).copied();
    let pieces = groups(&sets(model, latent), 0..model.bodies.len());
    let bodies: Vec<Body> = pieces.iter().map(|own| join(&model.bodies, own)).collect();
    let mut places = vec![Place { body: 0, pose: None }; model.bodies.len()];
    for (body, own) in pieces.iter().enumerate() {
        for i in own {
            let piece = &model.bodies[*i];
            // joined bodies have the axes of space
            let pose = (own.len() > 1).then(|| {
                (math::sub(piece.position_m, bodies[body].position_m), math::qunit(piece.orientation))
            });
            places[*i] = Place { body, pose };
        }
    }
    let renamed = |id: &str| at(id).map_or_else(|| id.to_string(), |i| bodies[places[i].body].id.clone());
    let mut bushings = Vec::with_capacity(latent.len());
    let mut own = Model {
        schema: model.schema.clone(),
        name: model.name.clone(),
        gravity_m_s2: model.gravity_m_s2,
        bodies: Vec::new(),
        shared_masses: Vec::new(),
        curves: BTreeMap::new(),
        joints: model.joints.clone(),
        bushings: Vec::new(),
        forces: model.forces.clone(),
        contact: model.contact.clone(),
        events: Vec::new(),
        event_rules: Vec::new(),
        tracked: Vec::new(),
        settings: model.settings.clone(),
    };
    for (bushing, latent) in model.bushings.iter().zip(latent) {
        bushings.push((!latent).then_some(own.bushings.len()));
        if !latent {
            let mut bushing = bushing.clone();
            bushing.body_a = bushing.body_a.as_deref().map(renamed);
            bushing.body_b = renamed(&bushing.body_b);
            own.bushings.push(bushing);
        }
    }
    if !model.shared_masses.is_empty() {
        let whole =
            held_together(model, &model.bushings.iter().map(|b| b.latent.is_some()).collect::<Vec<_>>());
        // a body that is less than at the start would have taken its share of the inertia with it
        let is_whole = |id: &String| {
            at(id).is_some_and(|i| {
                let count = whole.iter().filter(|label| **label == whole[i]).count();
                pieces[places[i].body].len() == count
            })
        };
        let kept = model.shared_masses.iter().filter(|s| s.bodies.iter().all(is_whole));
        own.shared_masses = kept.filter_map(|s| together(s, model, (&bodies, &places))).collect();
    }
    // shapes of a body are those of its pieces one after the other
    for face in &mut own.contact.crushing {
        let Some(piece) = at(&face.body) else { continue };
        let whole = &pieces[places[piece].body];
        let before = whole.iter().take_while(|i| **i != piece).map(|i| model.bodies[*i].shapes.len());
        (face.body, face.shape) = (renamed(&face.body), face.shape + before.sum::<usize>());
    }
    own.bodies = bodies;
    Merged { model: own, places, pieces, bushings }
}

/// What bodies of a model have together, as that of the bodies that they are in, which lie at other centres: `Tᵀ D T` with the velocities `T` of the former for those of the latter. None if two of them are in one.
pub fn together(
    shared: &SharedMass,
    model: &Model,
    (bodies, places): (&[Body], &[Place]),
) -> Option<SharedMass> {
    let index = self::places(model);
    let own: Vec<usize> =
        shared.bodies.iter().map(|id| index.get(id.as_str()).copied()).collect::<Option<_>>()?;
    let mut in_bodies: Vec<usize> = own.iter().map(|i| places[*i].body).collect();
    let ids = in_bodies.iter().map(|b| bodies[*b].id.clone()).collect();
    in_bodies.sort_unstable();
    in_bodies.dedup();
    if in_bodies.len() < own.len() {
        return None;
    }
    if own.iter().all(|i| places[*i].pose.is_none()) {
        return Some(shared.clone());
    }
    // v + ω_x y - ω_y x along z, and the same ω
    let motion = |k: usize| -> M3 {
        let [x, y, _] = places[own[k]].pose.map_or([0.0; 3], |(arm, _)| arm);
        [[1.0, y, -x], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    };
    let moved = |block: &MassBlock| {
        let [p, q] = block.pair.map(motion);
        let mut added = math::matmul(&math::matmul(&math::transpose(&p), &block.added), &q);
        if block.pair[0] == block.pair[1] {
            for (i, j) in [(0, 1), (0, 2), (1, 2)] {
                added[j][i] = added[i][j];
            }
        }
        MassBlock { pair: block.pair, added }
    };
    Some(SharedMass { bodies: ids, blocks: shared.blocks.iter().map(moved).collect() })
}

/// One body from pieces.
fn join(bodies: &[Body], own: &[usize]) -> Body {
    let first = &bodies[own[0]];
    if own.len() == 1 {
        return first.clone();
    }
    let pieces = || own.iter().map(|i| &bodies[*i]);
    let mass: f64 = pieces().map(|b| b.mass_kg).sum();
    let mean = |f: fn(&Body) -> V3| pieces().fold([0.0; 3], |sum, b| math::axpy(sum, b.mass_kg / mass, f(b)));
    let (center, velocity) = (mean(|b| b.position_m), mean(|b| b.velocity_m_s));
    let (mut inertia, mut spin) = ([[0.0; 3]; 3], [0.0; 3]);
    for b in pieces() {
        let arm = math::sub(b.position_m, center);
        let own = math::turned(&math::qmat(math::qunit(b.orientation)), &b.inertia_kg_m2);
        inertia = math::matadd(&inertia, &math::matadd(&own, &math::point_inertia(b.mass_kg, arm)));
        let orbit = math::scale(b.mass_kg, math::cross(arm, math::sub(b.velocity_m_s, velocity)));
        spin = math::add(spin, math::add(orbit, math::mul(&own, b.angular_velocity_rad_s)));
    }
    let mut body = first.clone();
    body.mass_kg = mass;
    body.inertia_kg_m2 = inertia;
    body.position_m = center;
    body.orientation = [1.0, 0.0, 0.0, 0.0];
    body.velocity_m_s = velocity;
    body.angular_velocity_rad_s = math::mul(&math::inverse(&inertia), spin);
    body.shapes = pieces()
        .flat_map(|b| {
            let (offset, turn) = (math::sub(b.position_m, center), math::qunit(b.orientation));
            b.shapes.iter().map(move |shape| moved(shape, offset, turn))
        })
        .collect();
    body
}

/// A shape in the frame of the body that its own lies in at a pose.
fn moved(shape: &Shape, offset: V3, turn: Q) -> Shape {
    let r = math::qmat(turn);
    let at = |p: V3| math::add(offset, math::mul(&r, p));
    match shape {
        Shape::Box { center_m, half_extents_m, orientation } => {
            let orientation = match orientation {
                Some(own) => Some(math::qmul(turn, *own)),
                None if turn == [1.0, 0.0, 0.0, 0.0] => None,
                None => Some(turn),
            };
            Shape::Box { center_m: at(*center_m), half_extents_m: *half_extents_m, orientation }
        }
        Shape::Sphere { center_m, radius_m } => {
            Shape::Sphere { center_m: at(*center_m), radius_m: *radius_m }
        }
        Shape::Hull { points_m } => Shape::Hull { points_m: points_m.iter().map(|p| at(*p)).collect() },
    }
}
